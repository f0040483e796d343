"""The generated equations in plain numbers, and checks that laws and mechanisms share."""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from stickslip.errors import ParameterError
from stickslip.formatting import number
from stickslip.formulation import formulate
from stickslip.friction import FrictionLaw, bristle_names
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Parametrised, parameters, vary
from stickslip.simulation import simulate
from stickslip.solver import Equations, EventDriven, gather
from stickslip.trajectory import Trajectory

DERIVED = "its equations can be derived"
BALANCED = "runs satisfy the energy balance"
FINITE = "equations are finite at the end of slip"
DERIVATIVES = "sensitivities agree with finite differences"
TIERS = "compiled and interpreted runs agree bit for bit"
"""The check that compiles."""
NEAR_REST = (0.0, -1e-4)
"""Slip velocities, in the direction of slip: at its end, and where a step overshoots it [m/s]."""
LAWFUL = ("field", "jacobian", "time_slope", "contact", "guards", "guard_slopes", "power")
OF_PARTS = ("masses", "forces", "force_slopes", "loads", "power")
"""The same where there are several contacts, whose laws have equations of their own."""
SHARE = 1e-5
"""Relative step of differences: what they leave out is its square, and rounding 1e-16 over it."""
ALLOWED = 1e-3
"""Of a derivative and its difference: far above what differences err by, far below a mistake."""


def generated(mechanism: Mechanism, law: FrictionLaw) -> Equations:
    """Return the equations of a mechanism with a law, to be called with numbers."""
    model = formulate(mechanism, law)
    return Equations(model, gather(mechanism, law, model, 0.0))


def derived(mechanism: Mechanism, law: FrictionLaw) -> Iterator[str]:
    """Yield nothing; raise what keeps the equations from being derived."""
    formulate(mechanism, law)
    yield from ()


def slip_rates(mechanism: Mechanism) -> list[str]:
    """Return the rates of the coordinates along which contacts slip."""
    rates = dict(zip(mechanism.coordinates, mechanism.rates, strict=True))
    slips = dict.fromkeys(name for one in mechanism.contacts() for name in one.slips)
    return [rates[name] for name in slips if name in rates]


def vector(mechanism: Mechanism, law: FrictionLaw, values: Mapping[str, float]) -> list[float]:
    """Return all states in order; what is not given is 0."""
    contacts = tuple(contact.name for contact in mechanism.contacts())
    names = (*mechanism.coordinates, *mechanism.rates, *bristle_names(contacts, law))
    return [float(values.get(name, 0.0)) for name in names]


def finite_near_rest(
    mechanism: Mechanism, law: FrictionLaw, starts: Sequence[Mapping[str, float]]
) -> Iterator[str]:
    """Yield functions of the equations that are not finite where slip ends."""
    equations = generated(mechanism, law)
    names = OF_PARTS if formulate(mechanism, law).contacts else LAWFUL
    for start in starts:
        for sense in (1, -1):
            for speed in NEAR_REST:
                slow = dict.fromkeys(slip_rates(mechanism), sense * speed)
                y = vector(mechanism, law, {**start, **slow})
                flags = equations.flags(0.0, y)
                for name in names:
                    size = equations(name, sense, flags, 0.0, y)
                    if not np.all(np.isfinite(size)):
                        yield f"{name} is not finite at slip velocity {number(sense * speed)}"


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


def reach(law: FrictionLaw) -> float:
    """Return the deflection [m] that carries the break-away level."""
    return float(law.break_away(1.0) / law.force(0.0, 1.0, (1.0,) * len(law.states)))
