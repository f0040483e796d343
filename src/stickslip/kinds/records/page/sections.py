"""Sections of the page of a selection on records."""

from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.formatting import in_words, joined, percent
from stickslip.identification import Prediction, RecordFit
from stickslip.kinds.records.page.appendix import dropped_section, next_section, record_section
from stickslip.kinds.records.page.certificate import certificate_section
from stickslip.kinds.records.page.friction import map_section
from stickslip.kinds.records.page.parameters import parameters_section
from stickslip.kinds.records.page.reproduce import reproduce_section
from stickslip.kinds.records.page.residuals import residuals_section
from stickslip.kinds.records.page.scores import scores_section
from stickslip.kinds.records.page.summary import opening_section
from stickslip.kinds.records.page.texts import rival_of, symbols_of
from stickslip.kinds.records.page.validation_record import second_section
from stickslip.kinds.records.verdict import RecordCandidate, RecordVerdict
from stickslip.plots import Loop, draw_loops, inline_svg, loop_sizes
from stickslip.report import Figure, PageSections, Paragraph, Section, typeset
from stickslip.selection import in_sentence

Array: TypeAlias = NDArray[np.float64]

SHOWN: Final = 3
"""Loops drawn at most."""
POINTS: Final = 150
"""Points of a loop drawn, about."""
REACH: Final = 0.2
"""Way back, over the stroke, that makes a turn: what is less is noise or a small wiggle."""


def loops_section(verdict: RecordVerdict) -> Section | None:
    """Return the section on friction against displacement, None where both were not measured."""
    best, rival = verdict.closest, rival_of(verdict)
    if best.fit is None or not _has_loops(best.fit):
        return None
    laws = [one for one in (best, rival) if one is not None and one.fit is not None]
    loops, count = _loops(laws)
    if not loops:
        return None
    svg = inline_svg(
        draw_loops(
            loops,
            chosen=best.title,
            units=(verdict.measurement.unit("position"), verdict.measurement.unit("friction")),
        ),
        alt=f"Friction against displacement, measured and by {' and '.join(c.title for c in laws)}",
        prefix="loop-figure",
        **loop_sizes(len(laws)),
    )
    figure = Figure(svg=svg, caption=_caption(verdict, len(loops), count))
    return Section(id="loops", nav="Loops", heading=_heading(laws), blocks=(figure,))


def _has_loops(fit: RecordFit) -> bool:
    """Whether friction and position were measured in time."""
    record = fit.measurement.records()[0]
    placed = "position" in record.quantities() and record.time is not None
    return placed and fit.friction_was_measured


def _loops(laws: list[RecordCandidate]) -> tuple[list[Loop], int]:
    """Return a few loops of the first record with what laws predict, and how many there are."""
    seen: dict[str, Prediction] = {c.title: c.fit.predict() for c in laws if c.fit is not None}
    assert laws[0].fit is not None
    record = laws[0].fit.measurement.records()[0]
    first = seen[laws[0].title]
    rows = np.flatnonzero(first.record == first.record[0])
    x = np.interp(first.t[rows], np.asarray(record.time), np.asarray(record.values("position")))
    x = x - 0.5 * (x.min() + x.max())
    ends = turns_of(x)[::2]
    count = len(ends) - 1
    if count < 1:
        return [], 0
    places = (np.arange(min(SHOWN, count)) + 0.5) / min(SHOWN, count) * count
    loops = []
    for k in np.unique(places.astype(int)).tolist():
        own = np.arange(ends[k], ends[k + 1] + 1)
        own = own[:: max(1, len(own) // POINTS)]
        loops.append(
            Loop(
                x[own],
                first.measured[rows][own],
                {name: one.predicted[rows][own] for name, one in seen.items()},
            )
        )
    return loops, count


def turns_of(x: Array) -> list[int]:
    """Return where a motion turns, by rows; wiggles of less than a fifth of the stroke are none.

    Examples
    --------
    >>> turns_of(np.array([0.0, 1.0, 2.0, 1.9, 3.0, 1.0, 0.0, 2.0, 3.0]))
    [4, 6]
    """
    reach = REACH * float(np.ptp(x)) if len(x) else 0.0
    if reach <= 0.0:
        return []
    turns: list[int] = []
    high = low = 0  # rows of the largest and the least since the last turn
    rising: bool | None = None
    for row, at in enumerate(x.tolist()):
        high = row if at > x[high] else high
        low = row if at < x[low] else low
        if rising is not False and x[high] - at > reach:
            turns += [high] if rising else []
            rising, low = False, row
        elif rising is not True and at - x[low] > reach:
            turns += [low] if rising is False else []
            rising, high = True, row
    return turns


def _heading(laws: list[RecordCandidate]) -> str:
    """Return how much of the spread of friction each law leaves along the motion."""
    said = []
    for one in laws:
        assert one.fit is not None
        spread = float(np.std(one.fit.problem.measured))
        if spread <= 0.0:
            return "Friction against displacement"
        said.append(f"{percent(one.fit.rms / spread)} for {in_sentence(one.title)}")
    text = ", ".join(said)
    return f"Residual over the spread of friction: {text}"


def _caption(verdict: RecordVerdict, shown: int, count: int) -> str:
    best, rival = verdict.closest, rival_of(verdict)
    some = "the one" if count == 1 else f"{in_words(shown)} of {count:,}"
    spread = " spread over the record" if 1 < shown < count else ""
    names = [in_sentence(c.title) for c in (best, rival) if c is not None and c.fit]
    text = (
        f"**Loops.** Dots: measured friction against displacement, {some} cycles{spread}. Lines:"
        f" {joined(names)} along the same motion, each fitted to the whole record. Displacement is"
        " measured from mid-stroke."
    )
    if len(verdict.measurement.records()) > 1:
        text += " They are of the first record."
    return text


def trials_section(verdict: RecordVerdict) -> Section | None:
    """Return the section on the trials, None where there was nothing to compare."""
    found = verdict.trials
    if found is None:
        return None
    symbols = symbols_of(verdict.candidates)
    heading = "The trials share one law" if found.shared else "The trials do not share one law"
    return Section(
        id="trials",
        nav="Trials",
        heading=heading,
        blocks=tuple(Paragraph(text=typeset(line, symbols)) for line in found.sentences),
    )


record_sections = PageSections[RecordVerdict](
    opening=opening_section,
    middle=(
        map_section,
        loops_section,
        scores_section,
        second_section,
        trials_section,
        parameters_section,
        residuals_section,
        dropped_section,
        record_section,
        certificate_section,
        next_section,
    ),
    reproduce=reproduce_section,
)
"""Makes the sections of a page, in the order in which a reader decides."""
