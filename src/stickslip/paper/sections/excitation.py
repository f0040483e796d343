"""Three readings of how the block is set in motion."""

from collections.abc import Sequence

from stickslip.formatting import (
    fixed,
    in_words,
    interval,
    number,
    quantity,
    residue,
    signed_percent,
)
from stickslip.paper.audit import PaperAudit
from stickslip.paper.excitations import PUSH_DURATION, Excitation
from stickslip.paper.sections.common import COLOURS, travel_axis
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

SKETCHES = {"A": "push", "B": "released-spring", "C": "fixed-spring"}


def excitation_section(found: PaperAudit) -> Section:
    """Show three readings of one sentence of the paper, with the first law of its table."""
    row = found.table[0]
    mu_k = getattr(row.law, "kinetic_coefficient", 0.0)
    values = found.values
    force = f"{quantity(values.force, 'N')} for {PUSH_DURATION:g} s"
    if found.own:
        how = "stays fastened" if values.own_reading == "C" else "leaves it at its natural length"
        text = (
            f"By the file a spring compressed by {quantity(values.rig.compression, 'm')} is"
            f" released, and the block {how}: reading {values.own_reading}. Reading A is a push"
            f" with the force of this spring for {PUSH_DURATION:g} s, as the paper has it. All with"
            f" $mu_k$ = {number(mu_k)} and {row.law.title} friction:"
        )
    else:
        text = (
            "Section IV has a compressed spring that is released, with $F$ = $K$$x$, and for"
            f" experiment and simulation alike a force of {force}. A released spring does not push"
            f" with a constant force. The compression, {values.rig.compression:g} m, follows from"
            f" {quantity(values.force, 'N')} and $K$. Both readings, and a control, with $mu_k$ ="
            f" {mu_k:g} and {row.law.title} friction:"
        )
    travels = {f"{reading.criteria.travel:.2f}" for reading in row.readings}
    return Section(
        id="excitation",
        nav="Three excitations",
        heading=f"Two readings of the rig and a control, {in_words(len(travels))} travels",
        blocks=(
            Paragraph(text=text),
            *(() if found.own else (_sketches(row.readings),)),
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
    values = found.values
    low, high = (found.measured + side * values.uncertainty for side in (-1.0, 1.0))
    digits = 3 if found.own else 2
    svg = inline_svg(
        draw_excitations(
            {_label(r): r.run for r in readings},
            chosen=next(_label(r) for r in readings if r.key == values.own_reading),
            band=(low, high),
            measured=f"measured, {found.measured:.{digits}f} m",
        ),
        alt="Travel against time in the three readings of the rig",
        prefix="excitations",
        **EXCITATION_SIZES,
    )
    return Figure(
        svg=svg,
        caption=f"**Travel in the two readings and the control.** {_band_text(found, low, high)}",
    )


def _band_text(found: PaperAudit, low: float, high: float) -> str:
    """Say what the band around the measured travel is, where there is one."""
    if not high > low:
        return "Line: the measured travel, whose uncertainty is not stated."
    what = (
        f"the travels that round to {found.measured:.2f} m"
        if found.values.rounded
        else "the measured travel ± its standard uncertainty"
    )
    return f"Blue-grey band: {interval(low, high)} m, {what}."


def _table(found: PaperAudit, readings: Sequence[Excitation]) -> Table:
    columns = (
        Column(head="excitation"),
        Column(head="travel\nm", numeric=True),
        Column(
            head="",
            axis=travel_axis(
                found, (r.criteria.travel for r in readings), "travel, m; line: measured"
            ),
        ),
        Column(head="error", numeric=True, phone="label"),
        Column(head="work put in\nJ", numeric=True, phone="label"),
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
            chosen=reading.key == found.values.own_reading,
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
    farthest = float(reading.run["x"].max())
    return f"turns at {farthest:.3f} m, ends at {seen.stop_time:.3f} s"


def _closed_forms(readings: Sequence[Excitation]) -> Caption:
    """Set the runs against the formulas."""
    known = {r: r.closed_form for r in readings if r.closed_form is not None}
    if not known:
        return Caption(text="No reading has a closed form here: the block stays with its spring.")
    off = max(abs(r.criteria.travel - travel) for r, travel in known.items())
    travels = ", ".join(f"{r.key} {travel:.7f} m" for r, travel in known.items())
    return Caption(
        text=f"Closed forms: {travels}; the simulated travels differ by {residue(off)} m at most."
    )
