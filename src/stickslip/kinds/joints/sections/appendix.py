"""Towards the end of the report: dropped laws, the record, and what to measure next."""

from collections.abc import Mapping

import numpy as np

from stickslip.formatting import Scale, in_words, with_unit
from stickslip.identification import RecordFit
from stickslip.kinds.joints.joint_verdict import RecordCandidate, RecordVerdict
from stickslip.kinds.joints.sections.scores import error_column
from stickslip.kinds.joints.sections.texts import symbols_of
from stickslip.plots import Channel, draw_record, inline_svg, record_sizes, speeds_of, thinned
from stickslip.report import Column, Figure, Number, Row, Section, Table, typeset
from stickslip.selection import score_text

LINES = 700
"""Points of a line of the record."""
MOST_SPANS = 60
"""More spans of reverse travel than this are not shaded: they would be stripes."""


def dropped_section(verdict: RecordVerdict) -> Section | None:
    """Return the section on laws that may not be taken, None if there is none."""
    everyone = [*verdict.candidates, *([verdict.control] if verdict.control else [])]
    dropped = [c for c in everyone if c.dropped]
    if not dropped:
        return None
    scale = verdict.scale
    rows = []
    for c in dropped:
        value, doubt = score_text(scale, c.score, c.score_error)
        symbols = symbols_of([c])
        score = Number(value=value, doubt=doubt)
        cells = (c.title, score, _said(c, symbols), typeset(c.dropped, symbols))
        rows.append(Row(cells=cells, muted=True))
    columns = (
        Column(head="candidate"),
        error_column(scale),
        Column(head="estimates"),
        Column(head="reason", phone="label", label="rule:"),
    )
    count = in_words(len(dropped)).capitalize()
    noun = "candidate" if len(dropped) == 1 else "candidates"
    return Section(
        id="dropped",
        nav="Dropped",
        heading=f"{count} {noun} dropped",
        blocks=(Table(columns=columns, rows=tuple(rows)),),
    )


def _said(c: RecordCandidate, symbols: frozenset[str]) -> str:
    """Return the estimates of a dropped law that speak against it, else all of them."""
    if c.fit is None:
        return "no fit"
    doubtful = [e for e in c.fit.estimates if not e.bounded or e.low <= 0.0 <= e.high]
    parts = []
    for estimate in (doubtful or c.fit.estimates)[:4]:
        value, doubt = estimate.parts
        text = f"{value} {doubt}" if estimate.bounded else value
        side = c.fit.at_bounds.get(estimate.path)
        tail = f", at its {side} bound" if side else "" if estimate.bounded else ", not identified"
        shown = with_unit(text, estimate.quantity.unit)
        parts.append(f"${estimate.quantity.symbol}$ = {shown}{tail}")
    if not parts:
        return " ".join(typeset(line, symbols) for line in c.fit.sentences) or "no free parameters"
    return "; ".join(parts)


def record_figure(
    verdict: RecordVerdict, fit: RecordFit, *, scales: Mapping[str, Scale] | None = None
) -> Figure | None:
    """Return the first record against time, None where it has no times."""
    record = verdict.measurement.records()[0]
    if record.time is None:
        return None
    names = {"force": "force applied", "friction": "friction"}
    moving = speeds_of(fit, record)
    channels = []
    for name in ("position", "velocity", "force", "friction"):
        if name == "velocity" and moving is not None:
            t, values = moving
        elif name in record.quantities() and np.ndim(record.values(name)):
            t, values = record.time, np.asarray(record.values(name), dtype=float)
        else:
            continue
        unit = record.unit(name)
        scale = None if scales is None else scales.get(unit)
        channels.append(Channel(names.get(name, name), unit, *thinned(t, values, LINES), scale))
    if not channels:
        return None
    spans = _reverse(*moving) if moving is not None else []
    svg = inline_svg(
        draw_record(channels, spans),
        alt=f"The record against time: {', '.join(channel.name for channel in channels)}",
        prefix="record-figure",
        **record_sizes(len(channels)),
    )
    several = len(verdict.measurement.records())
    caption = "**The record.**" if several == 1 else f"**The first of {several} records.**"
    if moving is not None and "velocity" not in record.quantities():
        caption += " The velocity is computed from filtered positions."
    caption += " Blue-grey: reverse travel." if spans else ""
    return Figure(svg=svg, caption=caption)


def _reverse(t: np.ndarray, velocity: np.ndarray) -> list[tuple[float, float]]:
    """Return the spans of reverse travel [s]; none if they are too many to be seen."""
    back = velocity < -0.02 * float(np.max(np.abs(velocity)))
    turns = np.flatnonzero(np.diff(np.concatenate([[False], back, [False]]).astype(int)))
    spans = [
        (float(t[a]), float(t[min(b, len(t) - 1)]))
        for a, b in zip(turns[::2], turns[1::2], strict=True)
    ]
    return spans if len(spans) <= MOST_SPANS else []
