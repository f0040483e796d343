"""What the engine owes every law and mechanism: both tiers bit for bit, and right derivatives."""

import math
from collections.abc import Iterator, Mapping

import numpy as np
from tests.conformance.mechanism_checks import slip_rates

from stickslip import EventDriven, FrictionLaw, Mechanism, simulate
from stickslip.engine import Trajectory
from stickslip.errors import ParameterError
from stickslip.quantities import Parametrised, parameters, vary
from stickslip.show.formatting import number

SHARE = 1e-5
"""Relative step of differences: what they leave out is its square, and rounding 1e-16 over it."""
ALLOWED = 1e-3
"""Of a derivative and its difference: far above what differences err by, far below a mistake."""


def same_in_both_tiers(
    mechanism: Mechanism, law: FrictionLaw, start: Mapping[str, float], t_end: float
) -> Iterator[str]:
    """Yield columns in which plain Python and machine code do not agree to the last bit."""
    plain, compiled = (
        simulate(mechanism, law, t_end=t_end, y0=start, solver=EventDriven(tier=tier), throw=False)
        for tier in ("python", "compiled")
    )
    if plain.status is not compiled.status or len(plain.t) != len(compiled.t):
        yield f"{len(plain.t)} steps interpreted, {len(compiled.t)} steps compiled"
        return
    for name in plain.names:
        if not np.array_equal(plain[name], compiled[name], equal_nan=True):
            difference = np.nanmax(np.abs(plain[name] - compiled[name]))
            yield f"{name} differs by {number(difference, 2)}"


def sensitivities_hold(
    mechanism: Mechanism,
    law: FrictionLaw,
    varied: Parametrised,
    start: Mapping[str, float],
    t_end: float,
) -> Iterator[str]:
    """Yield parameters by which the end of a run changes otherwise than its derivative says.

    Nothing is compared where the run ends early or bounced at a hard stop, where its neighbours
    have other events, or where there is no derivative (at a pulse that ends with the run).
    """
    run = simulate(mechanism, law, t_end=t_end, y0=start, throw=False)
    if not run.status.complete:
        return
    prefix = "friction" if isinstance(varied, FrictionLaw) else "mechanism"
    slip = _first_slip(mechanism)
    size = float(np.abs(run[slip]).max()) or 1.0
    for path, quantity, value in parameters(varied, prefix):
        step = SHARE * abs(value) or SHARE
        below, above = (
            _end(mechanism, law, prefix, path, value + change, start, run)
            for change in (-step, step)
        )
        sides = (run[slip][-1] - below) / step, (above - run[slip][-1]) / step
        # what the solver's tolerance leaves open, over the step
        noise = 1e-9 * size / step
        if not abs(sides[1] - sides[0]) <= ALLOWED * max(map(abs, sides)) + noise:
            continue  # there is no derivative, or nothing to compare
        slope = float(run.sensitivity(slip, path)[-1])
        difference = 0.5 * (sides[0] + sides[1])
        if math.isnan(slope) and _coincided(run):
            continue  # as the solver says of two changes at once
        if not abs(slope - difference) <= ALLOWED * max(abs(slope), abs(difference)) + noise:
            yield (
                f"d {slip} / d {quantity.symbol} = {number(slope, 6)}, but finite"
                f" differences give {number(difference, 6)}"
            )


def _first_slip(mechanism: Mechanism) -> str:
    """Return the first coordinate along which a contact slips."""
    return mechanism.coordinates[mechanism.rates.index(slip_rates(mechanism)[0])]


def _coincided(run: Trajectory) -> bool:
    times = [event.t for event in run.events]
    return len(run.contacts) > 1 and len(set(times)) < len(times)


def _end(
    mechanism: Mechanism,
    law: FrictionLaw,
    prefix: str,
    path: str,
    value: float,
    start: Mapping[str, float],
    run: Trajectory,
) -> float:
    """Return where a run with one parameter changed ends, NaN if it is not comparable."""
    try:
        if prefix == "friction":
            law = vary(law, prefix, {path: value})
        else:
            mechanism = vary(mechanism, prefix, {path: value})
    except ParameterError:
        return math.nan
    other = simulate(mechanism, law, t_end=run.span[1], y0=start, throw=False)
    same = [event.reason for event in other.events] == [event.reason for event in run.events]
    slip = _first_slip(mechanism)
    return float(other[slip][-1]) if same else math.nan
