"""Start values of force maps: a grid over decades of what least squares cannot see from afar.

A Stribeck velocity or a bristle stiffness that is off by a decade has no slope that would lead a
search back: the residual does not change where the speeds, or the ways, that it acts on are left.
So every half decade is looked at, with the rest of the law fitted linearly. The best point of each
speed goes downhill for a few steps, and the ends that differ are where searches begin.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError
from stickslip.friction import FrictionLaw
from stickslip.identification.estimation.bristle_integration import follow
from stickslip.identification.estimation.levenberg_marquardt import improve
from stickslip.identification.estimation.parameters import FreeParameter, FreeParameters
from stickslip.identification.estimation.perturbed_laws import with_arrays
from stickslip.identification.estimation.ranges import is_level
from stickslip.identification.force_map.data import MotionSegment
from stickslip.identification.force_map.model import ForceMap
from stickslip.quantities import vary

Array = NDArray[np.float64]

SPEEDS = tuple(float(f"{share:.3g}") for share in np.geomspace(1e-3, 1.0, 7))
"""Stribeck velocities over the largest speed: half decades."""
STIFFNESSES = tuple(float(10.0 ** (0.5 * power)) for power in range(-6, 3))
"""Stiffness over the one that reversals suggest, which is more often too high than too low."""
EXPONENTS = (0.1, 0.6, 1.5)
"""Exponents; whole ones are another law's."""
FADINGS = (1.01, 1.5, 1.99)
"""Exponents with which a static surplus fades, from Tustin's to Gauss's."""
SURPLUSES = (1.0, 5.0)
"""Static surplus over its start value."""
MISMATCH = 1e-2
"""Mismatch of bristles between chunks over the largest deflection: points are only rated."""
POLISHED = 7
"""Points of the grid from which a search goes downhill."""
ROUNDS = 4
"""Steps downhill."""
STIFF = "stiffness"
FIRST = 4
"""First column of the regressors of parameters of the mechanism."""
KEPT = 3
"""Starts that are returned at most."""
WORSE = 4.0
"""Sum of squares over the least, above which an end of these is no start."""
APART = 0.7
"""Distance of logarithms (a factor of two) from which two ends are two starts."""


def screened_starts(problem: ForceMap, coarse: ForceMap) -> tuple[Array, ...]:
    """Return values (p,) from which the search of a force map should begin, the best first.

    Examples
    --------
    >>> from stickslip import Axis, Measurement, Stribeck
    >>> from stickslip.identification.force_map.problem import force_map
    >>> truth = Stribeck(kinetic_coefficient=18.0, static_coefficient=26.0, stribeck_velocity=3e-3)
    >>> v = np.linspace(-1.0, 1.0, 2001)
    >>> table = Measurement(velocity=v, friction=truth.force(v, 1.0))
    >>> problem = force_map(Stribeck, Axis(inertia=1.0), table)
    >>> best = dict(
    ...     zip(problem.free_parameters.paths, screened_starts(problem, problem)[0], strict=True)
    ... )
    >>> bool(abs(best["friction.stribeck_velocity"] / 3e-3 - 1.0) < 0.2)
    True
    """
    memory = _has_memory(problem)
    points = _grid_points(problem.free_parameters, memory=memory)
    if len(points) < 2:
        return (problem.free_parameters.start,)
    seen, compare = (problem, _rated_with_memory) if memory else (coarse, _rated_without)
    rated = _best_of_each(compare(seen, points), points, problem.free_parameters)
    ends = sorted((_polished(seen, one) for one in rated), key=lambda one: one.cost)
    return _distinct(problem.free_parameters, ends)


@dataclass(frozen=True, eq=False)
class _Rated:
    """Values of the unknowns and the sum of squares that they leave."""

    values: Array
    cost: float


def _best_of_each(
    rated: Sequence[_Rated], points: Sequence[dict[str, float]], free_parameters: FreeParameters
) -> list[_Rated]:
    """Return the best points, one of each speed where there is one.

    Where a surplus goes to 0, its speed has no effect, and all of the best points may be such.
    """
    speeds = [item.path for item in free_parameters.items if item.quantity.scale == "speed"]
    order = sorted(range(len(rated)), key=lambda k: rated[k].cost)
    kept: dict[tuple[float, ...], _Rated] = {}
    for k in order:
        key = tuple(points[k][path] for path in speeds if path in points[k]) or (float(k),)
        kept.setdefault(key, rated[k])
    return list(kept.values())[:POLISHED]


def _has_memory(problem: ForceMap) -> bool:
    return bool(problem.law.states) and any(one.timed for one in problem.stretches)


def _grid_points(free_parameters: FreeParameters, *, memory: bool) -> list[dict[str, float]]:
    """Return the points of the grid, by path of what is looked at in decades."""
    fades = any(item.quantity.scale == "speed" for item in free_parameters.items)
    axes = {
        item.path: FADINGS if fades and item.quantity.structural else _axis(item)
        for item in free_parameters.items
        if item.path.startswith("friction.") and (item.log or (memory and item.above))
    }
    return [dict(zip(axes, point, strict=True)) for point in product(*axes.values())]


def _axis(item: FreeParameter) -> Sequence[float]:
    """Return the values of one unknown on the grid."""
    if item.above:
        return [item.start * factor for factor in SURPLUSES]
    if item.quantity.structural:
        return EXPONENTS
    if item.quantity.scale == "speed":
        return [item.high / 10.0 * share for share in SPEEDS]
    inside = [item.start * factor for factor in STIFFNESSES]
    return [value for value in inside if item.low <= value <= item.high]


def _placed(free_parameters: FreeParameters, point: dict[str, float]) -> Array:
    values = np.array([point.get(item.path, item.start) for item in free_parameters.items])
    return free_parameters.values(free_parameters.coordinates(values))


def _rated_without(coarse: ForceMap, points: Sequence[dict[str, float]]) -> list[_Rated]:
    """Rate points of a law that knows no history: all other parameters are fitted at each."""
    return [_fitted_at(coarse, point) for point in points]


def _fitted_at(coarse: ForceMap, point: dict[str, float]) -> _Rated:
    """Fit what is not on the grid at one of its points."""
    items = coarse.free_parameters.items
    values = _placed(coarse.free_parameters, point)
    free = [k for k, item in enumerate(items) if item.path not in point]
    if not free:
        return _Rated(values, coarse.linearise(values, slopes=False).cost)
    # those that are fitted too: one parameter may have to be at least another
    start = {
        item.path: float(value)
        for item, value in zip(items, values, strict=True)
        if item.path.startswith("friction.")
    }
    law = vary(coarse.law, "friction", start)
    free_parameters = FreeParameters(tuple(items[k] for k in free), coarse.free_parameters.known)
    try:
        end, _ = improve(
            replace(coarse, law=law, free_parameters_=free_parameters), values[free], rounds=4
        )
    except ConvergenceError:
        return _Rated(values, np.inf)
    values[free] = end.values
    return _Rated(values, end.cost)


def _rated_with_memory(coarse: ForceMap, points: Sequence[dict[str, float]]) -> list[_Rated]:
    """Rate points of a law of bristles, all at once along the motion.

    At each point one factor on levels and stiffness, one on the damping of bristles, a viscous
    part, a constant force and, where friction was derived from accelerations, a mass are fitted
    linearly.
    """
    free_parameters = coarse.free_parameters
    values = np.array([_placed(free_parameters, point) for point in points])
    paths = [(k, p) for k, p in enumerate(free_parameters.paths) if p.startswith("friction.")]
    base = vary(coarse.law, "friction", {p: float(values[0, k]) for k, p in paths})
    columns = {p: values[:, k] for k, p in paths}
    damping = [item.path for item in free_parameters.items if item.quantity.scale == "damping"]
    law = with_arrays(base, columns)
    bare = with_arrays(base, columns | {path: 0.0 * columns[path] for path in damping})
    with np.errstate(all="ignore"):  # points that fail far out are rated infinite
        pairs = [
            (one, one.rows_of(None), *_forces((bare, law), base, one, len(points)))
            for one in coarse.stretches
        ]
    elastic, whole = (
        np.concatenate([both[side][mask] for _, mask, *both in pairs]) for side in (0, 1)
    )
    measured = np.concatenate([one.friction[mask] for one, mask, *_ in pairs])
    beside = [
        np.ones(len(measured)),
        np.concatenate([one.path.velocity[mask] for one, mask, *_ in pairs]),
    ]
    if coarse.linear:
        beside += [
            np.concatenate([one.regressors[mask, j] for one, mask, *_ in pairs])  # type: ignore[index]
            for j in range(len(coarse.linear))
        ]
    return [
        _scaled(
            coarse,
            values[k],
            np.column_stack([elastic[:, k], whole[:, k] - elastic[:, k], *beside]),
            measured,
        )
        for k in range(len(points))
    ]


def _forces(
    laws: tuple[FrictionLaw, FrictionLaw], base: FrictionLaw, one: MotionSegment, count: int
) -> tuple[Array, Array]:
    """Return the friction (n, count) of copies of two laws whose bristles move alike."""
    states = follow(laws[0], one.path, np.zeros((len(base.states), count)), mismatch=MISMATCH)
    v, n = one.path.velocity[:, None], one.path.load[:, None]
    first, second = (
        one.seen(np.asarray(one.path.told(law).force(v, n, tuple(states)))) for law in laws
    )
    return first, second


def _scaled(coarse: ForceMap, values: Array, table: Array, measured: Array) -> _Rated:
    """Return values whose levels and stiffness are scaled to fit, and what that leaves.

    Columns (n, 4 + k) are friction without the damping of bristles, this damping, a constant
    force, the velocity, and what friction was derived from: of a mass, the acceleration. Where no
    damping fits best, half of the critical one stands for it: from 0, which is a bound, searches
    seldom come away.
    """
    constant = coarse.free_parameters.paths.index(coarse.constant) if _seeks(coarse) else None
    if not np.all(np.isfinite(table)):
        return _Rated(values, np.inf)
    found = np.linalg.lstsq(table, measured, rcond=None)[0]
    factor, damping = float(np.clip(found[0], 0.1, 10.0)), max(float(found[1]), 0.0)
    residual = measured - table @ [factor, damping, *found[2:]]
    new, undamped = values.copy(), None
    for k, item in enumerate(coarse.free_parameters.items):
        if is_level(item.quantity):
            new[k] = factor * values[k]
        elif item.quantity.scale == "damping":
            new[k] = damping * values[k]
            undamped = k if damping == 0.0 else undamped
        elif item.quantity.scale == "slope":
            new[k] = max(factor * values[k] + float(found[3]), 0.0)
        elif k == constant:
            new[k] = float(found[2])
        elif item.path in coarse.linear:
            j = coarse.linear.index(item.path)
            new[k] = coarse.derived[j] + float(found[FIRST + j])
    stiffness = next(
        (
            v
            for v, i in zip(new, coarse.free_parameters.items, strict=True)
            if i.quantity.scale == STIFF
        ),
        0.0,
    )
    if undamped is not None and stiffness > 0.0 and coarse.mass > 0.0:
        load = float(np.median(np.concatenate([one.path.load for one in coarse.stretches])))
        new[undamped] = math.sqrt(stiffness * coarse.mass / load)
    free_parameters = coarse.free_parameters
    return _Rated(
        free_parameters.values(free_parameters.coordinates(new)), float(residual @ residual)
    )


def _seeks(coarse: ForceMap) -> bool:
    return coarse.constant in coarse.free_parameters.paths


def _polished(coarse: ForceMap, rated: _Rated) -> _Rated:
    """Return where a few steps downhill lead."""
    if not np.isfinite(rated.cost):
        return rated
    try:
        end, _ = improve(coarse, rated.values, rounds=ROUNDS)
    except ConvergenceError:
        return _Rated(rated.values, np.inf)
    return _Rated(end.values, end.cost)


def _distinct(free_parameters: FreeParameters, ends: Sequence[_Rated]) -> tuple[Array, ...]:
    """Return the values of ends that are not much worse than the best and not the same as one."""
    log = [k for k, item in enumerate(free_parameters.items) if item.log]
    kept: list[Array] = []
    for one in ends:
        if not np.isfinite(one.cost) or one.cost > WORSE * ends[0].cost or len(kept) == KEPT:
            break
        near = [np.abs(np.log(one.values[log] / other[log])) for other in kept]
        if all(np.max(gap, initial=0.0) > APART for gap in near):
            kept.append(one.values)
    return tuple(kept) or (free_parameters.start,)
