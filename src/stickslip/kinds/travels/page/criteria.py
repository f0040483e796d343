"""The criteria of the source paper, as numbers."""

from collections.abc import Sequence

from stickslip.characterization import presliding_length
from stickslip.formatting import (
    fixed,
    in_words,
    joined,
    residue,
    signed_percent,
    significant,
    with_unit,
)
from stickslip.friction import Coulomb, FrictionLaw
from stickslip.kinds.travels.verdict import TravelCandidate, TravelVerdict
from stickslip.report import Block, Cell, Column, Note, Paragraph, Row, Section, Subheading, Table
from stickslip.selection import Criteria, criteria_of
from stickslip.simulation import simulate


def criteria_section(verdict: TravelVerdict) -> Section:
    """Return the section on velocity, displacement, error and energy."""
    given = [(c, c.given) for c in verdict.candidates]
    fitted = [(c, c.criteria) for c in verdict.explained if c.criteria is not None]
    blocks: list[Block] = [
        Subheading(
            text="With assumed typical values"
            if all(c.ordinary for c in verdict.candidates)
            else "With the given values"
        ),
        _table(verdict, given, with_error=True),
    ]
    if fitted:
        text = _agreement(given, fitted)
        again = Paragraph(text=text) if text else _table(verdict, fitted)
        blocks += [Subheading(text="With the fitted values"), again]
    springs, part = elastic_returns(verdict), verdict.mechanism.moving_part
    if springs:
        blocks.append(_note(given + fitted, springs, part))
    pulled = [name for name in _failing(given + fitted) if name not in springs]
    if pulled:
        blocks.append(_pulled(pulled, part))
    return Section(
        id="criteria",
        nav="Criteria",
        heading=_heading(given + fitted, springs, part),
        blocks=tuple(blocks),
    )


def _passes(seen: Criteria) -> bool:
    return seen.velocity_never_negative and seen.displacement_never_decreases


def _failing(rows: Sequence[tuple[TravelCandidate, Criteria]]) -> list[str]:
    return list(dict.fromkeys(c.title for c, seen in rows if not _passes(seen)))


def _agreement(
    given: Sequence[tuple[TravelCandidate, Criteria]],
    fitted: Sequence[tuple[TravelCandidate, Criteria]],
) -> str:
    """Return the sentence for fitted rows without anything to compare, else nothing."""
    shown = [_cells(seen) for _, seen in fitted]
    if len(shown) < 2 or any(cells != shown[0] for cells in shown):
        return ""
    travel, least, back, put_in, taken, left = shown[0]
    which = "All" if len(fitted) == len(given) > 2 else "The"
    return (
        f"{which} {in_words(len(fitted))} models agree in every column: travel {travel} m, lowest"
        f" velocity {least} mm/s, largest back-slip {back} mm; of {put_in} J supplied, friction"
        f" dissipates {taken} J and {left} J remain."
    )


def _heading(
    rows: Sequence[tuple[TravelCandidate, Criteria]], springs: Sequence[str], part: str
) -> str:
    failing = _failing(rows)
    count = len({c.name for c, _ in rows})
    if not failing:
        return f"The {part} never moves backwards{', with any model' if count > 1 else ''}"
    if set(failing) == set(springs):
        rest = ", but not with the other models" if len(springs) < count else ""
        return f"The {part} springs back with {joined(springs)}{rest}"
    if len(failing) == count:
        return f"The {part} moves backwards{' with every model' if count > 1 else ''}"
    return f"The {part} moves backwards with {in_words(len(failing))} of {in_words(count)} models"


def _note(
    rows: Sequence[tuple[TravelCandidate, Criteria]], springs: Sequence[str], part: str
) -> Note:
    slowest = {
        name: min(seen.least_velocity for c, seen in rows if c.title == name) for name in springs
    }
    speeds = joined([with_unit(_mm(v), "mm/s") for v in slowest.values()])
    return Note(
        title="The criterion “velocity never negative” rejects correct models.",
        text=f"With {joined(springs)}, the {part} springs back when it stops, by the elastic"
        f" deflection of the contact, at up to {speeds}. This is physical and not an error; a"
        " static switch would hide it.",
    )


def _pulled(names: Sequence[str], part: str) -> Note:
    return Note(
        title=f"The mechanism pulls the {part} back.",
        text=f"With {joined(names)} friction the {part} moves back under the force of the"
        " mechanism, its spring or its drive, and not by the elastic deflection of the contact. The"
        " criterion does not distinguish between these models.",
        kind="info",
    )


def _table(
    verdict: TravelVerdict,
    rows: Sequence[tuple[TravelCandidate, Criteria]],
    *,
    with_error: bool = False,
) -> Table:
    columns = [
        Column(head="model"),
        Column(head="travel\nm", numeric=True),
        *([Column(head="relative error", numeric=True, phone="label")] if with_error else []),
        Column(head="lowest velocity\nmm/s", numeric=True, phone="label"),
        Column(head="largest back-slip\nmm", numeric=True, phone="label"),
        Column(head="work supplied\nJ", numeric=True, phone="label"),
        Column(head="dissipated by friction\nJ", numeric=True, phone="label"),
        Column(head="remaining\nJ", numeric=True, phone="label"),
    ]
    out = []
    for candidate, seen in rows:
        error: list[Cell] = []
        if with_error:
            known = seen.relative_error
            error = ["not measured" if known is None else signed_percent(known)]
        travel, least, back, *energies = _cells(seen)
        cells: tuple[Cell, ...] = (
            candidate.title,
            travel,
            *error,
            _marked(least, seen.velocity_never_negative),
            _marked(back, seen.displacement_never_decreases),
            *energies,
        )
        out.append(
            Row(cells=cells, chosen=candidate is verdict.best, muted=bool(candidate.dropped))
        )
    caption = (
        "✓ meets and ! fails “velocity never negative” and “displacement never decreases”. The"
        " work supplied is dissipated by friction or remains in the mechanism at the end."
    )
    return Table(columns=tuple(columns), rows=tuple(out), caption=caption)


def _cells(seen: Criteria) -> tuple[str, str, str, str, str, str]:
    """Return travel, least velocity, largest return, and work put in, taken and left."""
    return (
        fixed(seen.travel, 3),
        _mm(seen.least_velocity),
        _mm(seen.largest_return),
        fixed(seen.work_in, 4),
        fixed(seen.work_friction, 4),
        _energy(seen.work_left, seen.work_in),
    )


def _marked(text: str, passes: bool) -> str:
    return f"{text} {'✓' if passes else '!'}"


def _mm(metres: float) -> str:
    """Return metres in millimetres; what is below rounding is 0."""
    return "0" if abs(metres) < 1e-9 else significant(1e3 * metres, 2)


def _energy(left: float, all_in: float) -> str:
    """Return an energy; 0 below rounding, and a power of ten where it is a remainder."""
    if abs(left) <= 1e-15 * abs(all_in):
        return "0"
    return fixed(left, 4) if abs(left) >= 5e-5 * abs(all_in) else residue(left)


LENGTHS = 3.0
"""Longest elastic return, over the presliding length: undamped bristles swing to twice it."""


def elastic_returns(verdict: TravelVerdict) -> list[str]:
    """Return the titles of the laws whose every return is that of an elastic contact.

    It is of the order of the presliding length, and without deflection, with Coulomb friction of
    the same level, the same mechanism does not move the body back.
    """
    found = {}
    for candidate in verdict.candidates:
        tried: list[tuple[FrictionLaw, Criteria]] = [(candidate.law, candidate.given)]
        if candidate.fit is not None and candidate.criteria is not None:
            tried.append((candidate.fit.law, candidate.criteria))
        returns = [
            _is_elastic(verdict, law, seen)
            for law, seen in tried
            if not seen.velocity_never_negative
        ]
        found[candidate.title] = bool(returns) and all(returns)
    return [title for title, elastic in found.items() if elastic]


def _is_elastic(verdict: TravelVerdict, law: FrictionLaw, seen: Criteria) -> bool:
    if law.holds:
        return False
    trial = verdict.trials[0]
    rigid = Coulomb(kinetic_coefficient=float(law.break_away(1.0)))
    states = (*trial.mechanism.coordinates, *trial.mechanism.rates)
    start = {name: value for name, value in trial.initial.items() if name in states}
    run = simulate(trial.mechanism, rigid, t_end=verdict.t_end, y0=start, throw=False)
    load = float(run["normal_force"].mean())
    elastic = LENGTHS * presliding_length(law, load)
    return (
        seen.largest_return <= elastic and criteria_of(run, trial.mechanism).velocity_never_negative
    )
