"""Values that are tried one by one before a search, as no regression or slope leads to them.

Without a force there is nothing for a regression to start from, but the drive is known, and a run
takes milliseconds.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import ConvergenceError
from stickslip.friction import Coulomb
from stickslip.identify.fits.contact_inputs import load_of
from stickslip.identify.fits.levenberg_marquardt import ResidualJacobian, improve
from stickslip.identify.fits.parameters import FreeParameter, FreeParameters
from stickslip.identify.fits.settings import RESOLUTION, ROUNDS
from stickslip.identify.fits.shooting.multiple_shooting import Shooting
from stickslip.identify.fits.shooting.segments import segments_of
from stickslip.identify.fits.shooting.start_values import LITTLE, StartEstimate
from stickslip.mechanisms import Mechanism, slip_of
from stickslip.quantities import fields_of
from stickslip.show.formatting import number

Array = NDArray[np.float64]

LEVELS: Final = tuple(np.geomspace(0.01, 2.0, 16).tolist())
"""Levels over the load that are tried: a third more each, from rolling to rubber."""
SURPLUSES: Final = (1.02, 1.1, 1.2, 1.35, 1.6, 2.0)
"""Levels at rest over those of sliding that are tried."""
SPREAD: Final = tuple(np.geomspace(0.4, 2.5, 38).tolist())
"""Levels over the one to start from that are tried where there are stops: a twentieth more each."""
SHARES: Final = (0.1, 0.2, 0.35, 0.6, 1.0)
"""Shares of a segment that are taken in one after the other there."""
KEPT, STEPS = 8, 15
"""Starts of least residual that are followed downhill, and for how many steps: of 30 bristle laws
three and five leave five in another valley, eight and fifteen one; eight and eight one of ten."""
PRESLIDING: Final = 1e-3
"""Length over which bristles give way, over the stroke."""


def scanned(mechanism: Mechanism, measurement: Measurement, quantity: str) -> StartEstimate:
    """Return the sizes of friction that simulated runs with Coulomb friction suggest.

    Examples
    --------
    >>> from stickslip import Capsule, simulate
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    >>> run = simulate(capsule, Coulomb(kinetic_coefficient=0.2), t_end=0.5).sampled(100)
    >>> record = Measurement(time=run.t, position=run["x"])
    >>> 0.14 < scanned(capsule, record, "position").level < 0.28
    True
    """
    load = load_of(mechanism)
    path, bounds = "friction.kinetic_coefficient", fields_of(Coulomb)["kinetic_coefficient"]
    longest = 2.0 * max(float(np.max(np.asarray(one.time))) for one in measurement.records())
    level = FreeParameter(path=path, quantity=bounds, start=LEVELS[0], low=0.0, high=LEVELS[-1])
    problem = Shooting(
        law=Coulomb(kinetic_coefficient=LEVELS[0]),
        free_parameters=FreeParameters((level,), {}),
        segments=segments_of(
            mechanism, measurement, length=longest, resolution=RESOLUTION, quantity=quantity
        ),
        quantity=quantity,
    )
    seen = [problem.linearise(np.array([mu]), slopes=False) for mu in LEVELS]
    best = min(seen, key=lambda one: one.cost)
    runs = problem.runs(best) if np.isfinite(best.cost) else ()
    if not runs:
        raise ConvergenceError(
            f"no simulation of the {type(mechanism).__name__} reaches the end of the record with"
            f" Coulomb friction of {number(LEVELS[0])} to {number(LEVELS[-1])} times the load:"
            " check masses, lengths and the drive (in SI), and whether the body lifts off or tips"
            " over."
        )
    slip = mechanism.coordinates.index(slip_of(mechanism))
    place, rate = mechanism.coordinates[slip], mechanism.rates[slip]
    sampled = [run.sampled(10 * RESOLUTION) for run in runs]
    v = np.concatenate([one[rate] for one in sampled])
    moving = v[np.abs(v) > 0.0]
    ahead = float(np.mean(moving > 0.0)) if moving.size else 1.0
    found = float(best.values[0])
    stroke = max(*(float(np.ptp(one[place])) for one in sampled), 1e-12)
    return StartEstimate(
        load=load,
        level=found,
        viscous=0.0,
        offset=0.0,
        force=found * load,
        speed=max(float(np.percentile(np.abs(v), 98.0)), 1e-12),
        stiffness=found / (PRESLIDING * stroke),
        two_sided=LITTLE < ahead < 1.0 - LITTLE,
    )


def least_of(problem: Shooting, tried: Sequence[Array]) -> Array:
    """Return which of several start values (p,) leads to the least, a few steps downhill."""
    if len(tried) == 1:
        return tried[0]
    seen = [problem.linearise(values, slopes=False) for values in tried]
    best = sorted(seen, key=lambda one: one.cost)[:KEPT]
    ends = [_end(problem, one, rounds=STEPS) for one in best]
    return min(ends, key=lambda one: one.cost).values


def surplus_starts(free: FreeParameters) -> list[Array]:
    """Return starts (p,) with several levels at rest.

    Such a level decides at each rest whether the body breaks away or not, so that residuals jump
    with it, and no slope leads from one side to the other.
    """
    above = [item.path for item in free.items if item.above]
    if not above:
        return []
    rest = free.paths.index(above[0])
    level = free.paths.index(free.items[rest].above)
    found = []
    for surplus in SURPLUSES:
        values = free.start.copy()
        values[rest] = surplus * values[level]
        found.append(values)
    return found


def lengthened_starts(problem: Shooting) -> tuple[Shooting, list[Array]]:
    """Return a problem with better initial states, and a start (p,), from its first part on.

    After some impacts a run depends so much on friction and on its initial state that the sum of
    squares has a valley for each sequence of impacts, and the way down leads into the nearest.
    Before them it has few: levels are tried one by one there, and the best end is followed while
    ever more of the record is taken in.
    """
    free = problem.free_parameters
    levels = [item.quantity.scale == "level" for item in free.items]
    if not any(levels):
        return problem, []
    part = problem.shortened(SHARES[0])
    tried = [
        part.linearise(
            free.values(free.coordinates(np.where(levels, factor, 1.0) * free.start)), slopes=False
        )
        for factor in SPREAD
    ]
    end = min(tried, key=lambda one: one.cost)
    for share in SHARES:
        end = _end(problem.shortened(share), end)
    if not np.isfinite(end.cost):
        return problem, []
    return problem.starting_from(end), [end.values]


def _end(problem: Shooting, near: ResidualJacobian, rounds: int = ROUNDS) -> ResidualJacobian:
    """Return where a descent on more of a record ends that begins where one on less has ended."""
    here = problem.linearise(near.values, near)
    try:
        return improve(problem, near.values, near=here, rounds=rounds)[0]
    except ConvergenceError:
        return here
