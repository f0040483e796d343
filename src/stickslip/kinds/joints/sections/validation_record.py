"""The second record: what laws that never saw it predict of it."""

import math
from typing import Final

import numpy as np

from stickslip.experiments import Measurement
from stickslip.formatting import Scale, joined, ratio, with_unit
from stickslip.identification import Prediction
from stickslip.kinds.joints.joint_verdict import RecordCandidate, RecordVerdict, SecondRecord
from stickslip.kinds.joints.sections.texts import rival_of
from stickslip.plots import Piece, draw_pieces, inline_svg, piece_sizes
from stickslip.report import Block, Column, Figure, Name, Number, Paragraph, Row, Section, Table
from stickslip.selection import in_sentence, score_text

POINTS: Final = 300
"""Points of a piece drawn at most."""
ALIKE: Final = 2.0
"""Standard errors within which the two errors of a law count as alike."""


def second_section(verdict: RecordVerdict) -> Section | None:
    """Return the section on the second record, None without one."""
    best, on_second, record = verdict.closest, verdict.on_second, verdict.second
    if best.fit is None or on_second is None or record is None:
        return None
    names = {on_second.rival, getattr(rival_of(verdict), "name", "")}
    laws = [best, *(c for c in verdict.candidates if c.name in names and c.fit and c.second)]
    scale = verdict.scale
    text = _sentence(record, laws, on_second, scale)
    blocks: list[Block] = [Paragraph(text=text), _table(laws, scale)]
    if all(one.time is not None for one in record.records()):
        blocks.append(_figure(verdict, record, laws))
    return Section(
        id="second",
        nav="Second record",
        heading=_heading(best, scale),
        blocks=tuple(blocks),
    )


def _standard(one: RecordCandidate) -> float:
    """Return by how many standard errors the second record is missed by more than blocks are."""
    assert one.second is not None
    error = one.score_error
    return (one.second.rms - one.score) / error if error > 0.0 else math.inf


def _heading(best: RecordCandidate, scale: Scale) -> str:
    assert best.second is not None
    said = scale.error(best.second.rms)
    far = _standard(best)
    if far > ALIKE:
        return f"Error on the second record: {said}, larger than the held-out error"
    than = "similar to" if far >= -ALIKE else "smaller than"
    return f"Error on the second record: {said}, {than} the held-out error"


def _sentence(
    record: Measurement, laws: list[RecordCandidate], on_second: SecondRecord, scale: Scale
) -> str:
    """Return what the second record is, and how its errors compare with those of blocks."""
    best = laws[0]
    assert best.second is not None
    source = _source(record)
    text = f"The second record{f' ({source})' if source else ''} was not used for any fit."
    held = with_unit(" ".join(score_text(scale, best.score, best.score_error)).strip(), scale.unit)
    times = ratio(best.second.rms / best.score) if best.score > 0.0 else ""
    text += (
        f" {best.title} has an error of {scale.error(best.second.rms)} there, and {held} on"
        f" held-out blocks of the first{f': {times} that' if times else ''}."
    )
    for other in laws[1:]:
        assert other.second is not None
        text += f" {other.title}: {scale.error(other.second.rms)}."
    reasons = {
        "holds": ": no law has a significantly smaller error there",
        "does not hold": ": another law has a significantly smaller error there",
    }
    finding = on_second.finding
    return f"{text} The choice {finding}{reasons.get(finding, '')}."


def _source(record: Measurement) -> str:
    """Return name and source of a record, as far as they are known."""
    parts = [record.name, record.provenance]
    if not any(parts):
        parts = [r.name or r.provenance for r in record.records()][:3]
    return ", ".join(dict.fromkeys(part for part in parts if part))


def _table(laws: list[RecordCandidate], scale: Scale) -> Table:
    columns = (
        Column(head="model"),
        Column(head=f"held-out blocks\n{scale.unit}, ± 1 s.e.", numeric=True),
        Column(head=f"second record\n{scale.unit}", numeric=True, phone="label", label="second:"),
        Column(head="best and\nworst segment", numeric=True, phone="label", label="pieces:"),
    )
    rows = []
    for index, one in enumerate(laws):
        assert one.second is not None
        value, doubt = score_text(scale, one.score, one.score_error)
        known = [size for size in one.second.blocks if math.isfinite(size)]
        ends = (
            " to ".join(score_text(scale, end).value for end in (min(known), max(known)))
            if known
            else "—"
        )
        cells = (
            Name(text=one.title),
            Number(value=value, doubt=doubt),
            score_text(scale, one.second.rms).value,
            ends,
        )
        rows.append(Row(cells=cells, chosen=index == 0))
    return Table(columns=columns, rows=tuple(rows))


def _figure(verdict: RecordVerdict, record: Measurement, laws: list[RecordCandidate]) -> Figure:
    """Return measured and predicted runs: the piece in the middle of the errors, and the worst."""
    horizon = verdict.plan.horizon
    seen = {c.title: c.fit.predict(record, horizon=horizon) for c in laws if c.fit is not None}
    first = seen[laws[0].title]
    pieces = _pieces(first, seen)
    svg = inline_svg(
        draw_pieces(pieces, verdict.quantity, verdict.unit, chosen=laws[0].title),
        alt=f"The second record, measured and predicted by {' and '.join(seen)}",
        prefix="second-figure",
        **piece_sizes(len(pieces)),
    )
    several = len(pieces) > 1
    which = (
        "The segments with the median and the largest error" if several else ("The whole record")
    )
    names = joined([in_sentence(name) for name in seen])
    caption = (
        f"**Predicted and measured on the second record.** {which}; each segment is the law along"
        " the measured motion. Grey:"
        f" measured; other lines: {names}. Below: measured minus predicted."
    )
    return Figure(svg=svg, caption=caption)


def _pieces(first: Prediction, seen: dict[str, Prediction]) -> list[Piece]:
    """Return the pieces drawn, thinned alike for all laws."""
    numbers_ = np.unique(first.segment)
    sizes = [float(np.mean(first.residual[first.segment == k] ** 2)) for k in numbers_]
    order = np.argsort(sizes)
    chosen = {"median error": int(order[(len(order) - 1) // 2]), "largest error": int(order[-1])}
    if len(order) == 1:
        chosen = {"": 0}
    pieces = []
    for name, place in chosen.items():
        own = np.flatnonzero(first.segment == numbers_[place])
        own = own[:: max(1, len(own) // POINTS)]
        predicted = {title: one.predicted[own] for title, one in seen.items()}
        pieces.append(Piece(name, first.t[own], first.measured[own], predicted))
    return pieces
