"""The criteria of the source paper, as numbers."""

from collections.abc import Sequence

from stickslip.friction import BristleLaw
from stickslip.report import numbers
from stickslip.report.blocks import Block, Note, Subheading
from stickslip.report.documents import Section
from stickslip.report.selection.texts import counted, joined
from stickslip.report.tables import Cell, Column, Row, Table
from stickslip.selection import Candidate, Criteria, Verdict

__all__ = ["criteria_section"]


def criteria_section(verdict: Verdict) -> Section:
    """Return the section on velocity, displacement, error and energy."""
    given = [(c, c.given) for c in verdict.candidates]
    fitted = [(c, c.criteria) for c in verdict.explained if c.criteria is not None]
    blocks: list[Block] = [
        Subheading(text="With the values as given"),
        _table(verdict, given, with_error=True),
    ]
    if fitted:
        blocks += [Subheading(text="With the fitted values"), _table(verdict, fitted)]
    springs = _spring_back(given + fitted)
    if springs:
        blocks.append(_note(given + fitted, springs))
    return Section(
        id="criteria",
        nav="Criteria",
        heading=_heading(given + fitted, springs),
        blocks=tuple(blocks),
    )


def _passes(seen: Criteria) -> bool:
    return seen.velocity_never_negative and seen.displacement_never_decreases


def _spring_back(rows: Sequence[tuple[Candidate, Criteria]]) -> list[str]:
    """Return the laws that spring back because their contact is elastic."""
    names = [
        c.title
        for c, seen in rows
        if isinstance(c.law, BristleLaw)
        and not c.law.static_switch
        and not seen.velocity_never_negative
    ]
    return list(dict.fromkeys(names))


def _heading(rows: Sequence[tuple[Candidate, Criteria]], springs: Sequence[str]) -> str:
    failing = list(dict.fromkeys(c.title for c, seen in rows if not _passes(seen)))
    count = len({c.name for c, _ in rows})
    if not failing:
        return (
            "The body only ever moves forward, with every model"
            if count > 1
            else "The body only ever moves forward"
        )
    if set(failing) == set(springs):
        verb = "lets" if len(springs) == 1 else "let"
        rest = "; the others never reverse it" if len(springs) < count else ""
        return f"{joined(springs)} {verb} the body spring back{rest}"
    if len(failing) == count:
        return "The body moves back, with every model" if count > 1 else "The body moves back"
    return f"The body moves back with {counted(len(failing))} of {counted(count)} models"


def _note(rows: Sequence[tuple[Candidate, Criteria]], springs: Sequence[str]) -> Note:
    slowest = {
        name: min(seen.least_velocity for c, seen in rows if c.title == name) for name in springs
    }
    speeds = joined([numbers.with_unit(_mm(v), "mm/s") for v in slowest.values()])
    verb, its = ("lets", "its") if len(springs) == 1 else ("let", "their")
    return Note(
        title="The criterion “velocity never negative” rejects correct models.",
        text=f"{joined(springs)} {verb} the body spring back by the elastic deflection of {its}"
        f" contact when it stops, at up to {speeds}. That is physics, not error. A static switch"
        " would hide it.",
    )


def _table(
    verdict: Verdict,
    rows: Sequence[tuple[Candidate, Criteria]],
    *,
    with_error: bool = False,
) -> Table:
    columns = [
        Column(head="model"),
        Column(head="travel\nm", numeric=True),
        *([Column(head="relative error", numeric=True, phone="label")] if with_error else []),
        Column(head="least velocity\nmm/s", numeric=True, phone="label"),
        Column(head="largest return\nmm", numeric=True, phone="label"),
        Column(head="work in\nJ", numeric=True, phone="label"),
        Column(head="taken by friction\nJ", numeric=True, phone="label"),
        Column(head="left\nJ", numeric=True, phone="label"),
    ]
    out = []
    for candidate, seen in rows:
        error: list[Cell] = []
        if with_error:
            known = seen.relative_error
            error = ["not measured" if known is None else numbers.signed_percent(known)]
        cells: tuple[Cell, ...] = (
            candidate.title,
            numbers.fixed(seen.travel, 3),
            *error,
            _marked(_mm(seen.least_velocity), seen.velocity_never_negative),
            _marked(_mm(seen.largest_return), seen.displacement_never_decreases),
            numbers.fixed(seen.work_in, 4),
            numbers.fixed(seen.work_friction, 4),
            _energy(seen.work_left, seen.work_in),
        )
        out.append(
            Row(cells=cells, chosen=candidate is verdict.best, muted=bool(candidate.dropped))
        )
    caption = (
        "✓ meets and ! fails “velocity never negative” and “displacement never decreases”. The"
        " work put in is taken by friction, or still in the mechanism at the end."
    )
    return Table(columns=tuple(columns), rows=tuple(out), caption=caption)


def _marked(text: str, passes: bool) -> str:
    return f"{text}{numbers.NO_BREAK_SPACE}{'✓' if passes else '!'}"


def _mm(metres: float) -> str:
    """Return metres in millimetres; what is below rounding is 0."""
    return "0" if abs(metres) < 1e-9 else numbers.significant(1e3 * metres, 2)


def _energy(left: float, all_in: float) -> str:
    """Return an energy; 0 below rounding, and a power of ten where it is a remainder."""
    if abs(left) <= 1e-15 * abs(all_in):
        return "0"
    return numbers.fixed(left, 4) if abs(left) >= 5e-5 * abs(all_in) else numbers.residue(left)
