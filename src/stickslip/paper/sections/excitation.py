"""Three readings of how the block is set in motion."""

from collections.abc import Sequence

from stickslip.formatting import fixed, in_words, interval, residue, signed_percent
from stickslip.paper.audit import PaperAudit
from stickslip.paper.excitations import PUSH_DURATION, Excitation
from stickslip.paper.sections.common import COLOURS, travel_axis
from stickslip.paper.unpublished import ROUNDING
from stickslip.plots import EXCITATION_SIZES, draw_excitations, inline_svg, sketch
from stickslip.report import (
    Caption,
    Column,
    Figure,
    Gallery,
    Mark,
    Number,
    Panel,
    Paragraph,
    Row,
    RowPlot,
    Section,
    Table,
)

__all__ = ["excitation_section"]

SKETCHES = {"A": "push", "B": "released-spring", "C": "fixed-spring"}


def excitation_section(found: PaperAudit) -> Section:
    """Show three readings of one sentence of the paper, with the first law of its table."""
    row = found.table[0]
    mu_k = getattr(row.law, "kinetic_coefficient", 0.0)
    rig = found.values.rig
    force = rig.stiffness * rig.compression
    text = (
        "By section IV of the paper a compressed spring is released and drives the block, with the"
        f" applied force $F$ = $K$$x$; for experiment and simulation alike it also states a force"
        f" of {force:g} N that is applied for {PUSH_DURATION:g} s. The compression is not printed;"
        f" {rig.compression:g} m follows from {force:g} N and $K$. A released spring does not push"
        " with a constant force, and lets go when it has reached its natural length. Both readings,"
        f" and a control, with the same block, $mu_k$ = {mu_k:g} and {row.law.title} friction:"
    )
    travels = {f"{reading.criteria.travel:.2f}" for reading in row.readings}
    return Section(
        id="excitation",
        nav="Three excitations",
        heading=f"Two readings of the rig and a control, {in_words(len(travels))} travels",
        blocks=(
            Paragraph(text=text),
            _sketches(row.readings),
            _figure(found, row.readings),
            _table(found, row.readings),
            _closed_forms(row.readings),
        ),
    )


def _sketches(readings: Sequence[Excitation]) -> Gallery:
    return Gallery(
        panels=tuple(
            Panel(
                svg=sketch(
                    SKETCHES[reading.key],
                    alt=f"Sketch of the rig: {reading.title}",
                    prefix=f"sketch-{reading.key.lower()}",
                ),
                title=f"{reading.key}. {reading.title}.",
                text=reading.text,
                colour=COLOURS[reading.key],
            )
            for reading in readings
        )
    )


def _figure(found: PaperAudit, readings: Sequence[Excitation]) -> Figure:
    low, high = found.measured - ROUNDING, found.measured + ROUNDING
    svg = inline_svg(
        draw_excitations(
            {_label(r): r.run for r in readings},
            chosen=next(_label(r) for r in readings if r.key == "B"),
            band=(low, high),
            measured=f"measured, {found.measured:.2f} m",
        ),
        alt="Travel against time in the three readings of the rig",
        prefix="excitations",
        **EXCITATION_SIZES,
    )
    return Figure(
        svg=svg,
        caption=(
            "**Travel in the two readings and the control.** Blue-grey band:"
            f" {interval(low, high)} m, the travels that round to {found.measured:.2f} m."
        ),
    )


def _table(found: PaperAudit, readings: Sequence[Excitation]) -> Table:
    columns = (
        Column(head="excitation"),
        Column(head="travel\nm", numeric=True),
        Column(head="", axis=travel_axis(found, "travel, m; line: measured")),
        Column(head="error", numeric=True, phone="label", label="error"),
        Column(head="work put in\nJ", numeric=True, phone="label", label="work put in, J"),
        Column(head="how it ends"),
    )
    rows = tuple(
        Row(
            cells=(
                f"{reading.key}. {reading.title}",
                Number(value=fixed(reading.criteria.travel, 3)),
                RowPlot(marks=(_dot(reading),)),
                signed_percent(reading.criteria.relative_error or 0.0),
                fixed(reading.criteria.work_in, 3),
                _ending(reading),
            ),
            chosen=reading.key == "B",
        )
        for reading in readings
    )
    return Table(columns=columns, rows=rows)


def _label(reading: Excitation) -> str:
    return f"{reading.key}. {reading.title}"


def _dot(reading: Excitation) -> Mark:
    return Mark(kind="dot", at=reading.criteria.travel, colour=COLOURS[reading.key])


def _ending(reading: Excitation) -> str:
    """Say in words how a run ends."""
    seen = reading.criteria
    if seen.stop_time is None:
        return "still moves at the end"
    if seen.displacement_never_decreases:
        return f"stops at {seen.stop_time:.3f} s, stays"
    farthest = seen.travel + seen.largest_return
    return f"turns at {farthest:.3f} m, ends at {seen.stop_time:.3f} s"


def _closed_forms(readings: Sequence[Excitation]) -> Caption:
    """Set the runs against the formulas."""
    known = {r: r.closed_form for r in readings if r.closed_form is not None}
    off = max(abs(r.criteria.travel - travel) for r, travel in known.items())
    travels = ", ".join(f"{r.key} {travel:.7f} m" for r, travel in known.items())
    return Caption(
        text=f"Closed forms: {travels}; the simulated travels differ by {residue(off)} m at most."
    )
