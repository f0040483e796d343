"""Why a body moves back: the elastic deflection of its contact, or the mechanism."""

from stickslip.characterization import presliding_length
from stickslip.friction import Coulomb, FrictionLaw
from stickslip.identification import trials_of
from stickslip.selection import Criteria, TravelVerdict, criteria_of
from stickslip.simulation import simulate

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
    trial = trials_of(verdict.mechanism, verdict.measurement, verdict.t_end)[0]
    rigid = Coulomb(kinetic_coefficient=float(law.break_away(1.0)))
    states = (*trial.mechanism.coordinates, *trial.mechanism.rates)
    start = {name: value for name, value in trial.initial.items() if name in states}
    run = simulate(trial.mechanism, rigid, t_end=verdict.t_end, y0=start, throw=False)
    load = float(run["normal_force"].mean())
    elastic = LENGTHS * presliding_length(law, load)
    return (
        seen.largest_return <= elastic and criteria_of(run, trial.mechanism).velocity_never_negative
    )
