"""Searches from the fits of simpler laws, and what to say where a richer law ends above one."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import final

import numpy as np
from numpy.typing import NDArray

from stickslip.formatting import number
from stickslip.friction import FrictionLaw, containment_of
from stickslip.identification.estimation.parameters import FreeParameter, FreeParameters
from stickslip.identification.estimation.problem import LeastSquaresProblem
from stickslip.quantities import fields_of

Array = NDArray[np.float64]

STIFFER = 30.0
"""Factor on the start value of what goes to infinity in the simpler law, such as a stiffness."""
DECADES = tuple(float(f"{10.0 ** (0.5 * power):.3g}") for power in range(-4, 5))
"""Factors on the start value of what has no effect in the simpler law: half decades."""
SURPLUS = 0.3
"""Static surplus over the kinetic level that is tried as well where the simpler law has none: the
closest fit may lie beyond a ridge."""
OFF = 10.0
"""Factor by which an unknown is moved off a bound, at least."""
SHARES = (0.1, 0.5, 0.9)
"""Where in its range such a parameter is tried that does not span decades."""
WORSE = 0.02
"""Share by which a sum of squares may be above that of a contained law: as far as starts agree."""
NOT_WHOLE = 1e-6
"""Share by which a whole exponent is moved: residuals change by less than any search resolves."""
CONSTANTS = ("mechanism.offset", "measurement.offset.friction")
"""Paths of a constant force beside friction."""


@final
@dataclass(frozen=True, kw_only=True)
class FittedLaw:
    """A fit of a law, as far as fits of richer laws need it."""

    law: FrictionLaw
    """The law with its fitted values."""
    values: Mapping[str, float]
    """Best values of all that was fitted, by path."""
    cost: float
    """Sum of squares that it leaves."""
    rows: int
    """Number of residuals."""


def reachable(
    start: FrictionLaw, free_parameters: FreeParameters, fitted: Sequence[FittedLaw]
) -> tuple[FittedLaw, ...]:
    """Return those of fitted simpler laws that a richer law can become with what it has free.

    Examples
    --------
    >>> from stickslip import CoulombViscous, Stribeck
    >>> simple = FittedLaw(
    ...     law=CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=1.0),
    ...     values={},
    ...     cost=1.0,
    ...     rows=10,
    ... )
    >>> fixed = Stribeck(kinetic_coefficient=0.3, static_coefficient=0.4, stribeck_velocity=0.1)
    >>> reachable(fixed, FreeParameters(()), [simple])
    ()
    """
    return tuple(one for one in fitted if _reaches(start, free_parameters, one))


def _reaches(start: FrictionLaw, free_parameters: FreeParameters, one: FittedLaw) -> bool:
    names = {
        path.partition(".")[2] for path in free_parameters.paths if path.startswith("friction.")
    }
    beside = {path for path in one.values if not path.startswith("friction.")}
    if not beside <= {*free_parameters.paths, *CONSTANTS}:
        return False
    if type(one.law) is type(start):
        return {*one.values} <= {*free_parameters.paths, *CONSTANTS}
    how = containment_of(type(start), type(one.law))
    values = None if how is None else how.embed(one.law)
    if how is None or values is None or not names.issuperset(how.limits):
        return False
    return all(name in names or getattr(start, name) == value for name, value in values.items())


def starts_from(
    kind: type[FrictionLaw],
    free_parameters: FreeParameters,
    fitted: Sequence[FittedLaw],
    load: float,
    problem: LeastSquaresProblem | None = None,
) -> tuple[Array, ...]:
    """Return values (p,) of a richer law that make it a fitted simpler one.

    There, some parameters have no effect, such as a Stribeck velocity without a static surplus, and
    hence no slope that would lead a search to them. Of values over decades that is taken whose
    neighbourhood promises the closest fit.

    Examples
    --------
    >>> from stickslip import CoulombViscous, QuadraticDrag
    >>> from stickslip.identification.estimation.parameters import FreeParameter
    >>> from stickslip.quantities import Quantity
    >>> drag = FreeParameter(
    ...     path="friction.quadratic_coefficient", quantity=Quantity("c", low=0), start=3.0, low=0.0
    ... )
    >>> simple = FittedLaw(
    ...     law=CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=1.0),
    ...     values={},
    ...     cost=1.0,
    ...     rows=10,
    ... )
    >>> starts_from(QuadraticDrag, FreeParameters((drag,)), [simple], 1.0)
    (array([0.]),)
    """
    found = []
    for one in _nearest(kind, fitted):
        for point in _embedded(kind, free_parameters, one, fitted, load):
            found.append(_placed(free_parameters, point, problem))
            risen = _risen(free_parameters, point)
            if problem is not None and _open(free_parameters, point) and risen != point:
                found.append(_placed(free_parameters, risen, problem))
    return tuple(found)


def elsewhere(
    problem: LeastSquaresProblem, values: Array, met: Mapping[str, str]
) -> Iterator[Array]:
    """Yield values (p,) with an unknown of the law off the bound that it met, where it promises.

    Where it has no effect no slope leads back from there, and the other unknowns would be told
    apart as if it were known to be at the bound.
    """
    unknowns = problem.free_parameters
    for item in unknowns.items:
        if item.path not in met or not (item.log and item.low > 0.0 and item.high < math.inf):
            continue
        up, down = (OFF, 1.0) if met[item.path] == "lower" else (1.0, OFF)
        low, high = item.low * up, item.high / down
        inside = replace(item, low=low, high=high, start=math.sqrt(low * high))
        near = dict(zip(unknowns.paths, values.tolist(), strict=True))
        for other in unknowns.items:  # a surplus fades with it
            near[other.path] = near.get(other.above, near[other.path])
        del near[item.path]
        items = tuple(inside if one is item else one for one in unknowns.items)
        own = replace(unknowns, items=items)
        if _open(own, near):
            yield _placed(own, _risen(own, near), problem)


def _open(free_parameters: FreeParameters, point: Mapping[str, float]) -> list[tuple[str, float]]:
    """Return values over the ranges of what a point, by path, leaves open."""
    silent = [item for item in free_parameters.items if item.path not in point]
    return [(item.path, value) for item in silent for value in _spread(item)]


def _risen(free_parameters: FreeParameters, point: Mapping[str, float]) -> dict[str, float]:
    """Return a point with a static surplus where it has none."""
    return {
        **point,
        **{
            item.path: (1.0 + SURPLUS) * point[item.above]
            for item in free_parameters.items
            if item.path in point and point.get(item.above) == point[item.path]
        },
    }


def _placed(
    free_parameters: FreeParameters,
    point: Mapping[str, float],
    problem: LeastSquaresProblem | None,
) -> Array:
    """Return the values (p,) of a point, by path, with what it leaves open where it promises."""

    def placed(point: Mapping[str, float]) -> Array:
        given = [(item, point.get(item.path, item.start)) for item in free_parameters.items]
        values = np.array([not_whole(item, value) for item, value in given])
        return free_parameters.values(free_parameters.coordinates(values))

    tried = [placed({**point, path: value}) for path, value in _open(free_parameters, point)]
    if problem is None or not tried:
        return placed(point)
    return min([placed(point), *tried], key=partial(_promised, problem))


def _spread(item: FreeParameter) -> Sequence[float]:
    """Return values over the range of a parameter."""
    if not item.path.startswith("friction."):
        return ()
    if item.log:
        values = [item.start * factor for factor in DECADES]
    elif np.isfinite(item.low) and np.isfinite(item.high):
        values = [item.low + share * (item.high - item.low) for share in SHARES]
    else:
        values = []
    return [value for value in values if item.low <= value <= item.high]


def _promised(problem: LeastSquaresProblem, values: Array) -> float:
    """Return the sum of squares that a step from some values leaves to first order."""
    here = problem.linearise(values)
    if not here.finite:
        return np.inf
    low, high = problem.free_parameters.limits()
    at = problem.free_parameters.coordinates(values)
    slopes = here.slopes @ problem.free_parameters.slopes(at)
    size = np.linalg.norm(slopes, axis=0)
    free = size > 0.0
    for _ in range(len(values)):
        step = np.zeros(len(values))
        step[free] = np.linalg.lstsq(slopes[:, free] / size[free], here.residual)[0] / size[free]
        out = free & (((at <= low) & (step < 0.0)) | ((at >= high) & (step > 0.0)))
        if not out.any():
            break
        free &= ~out
    left = here.residual - slopes @ step
    return float(left @ left)


def _nearest(kind: type[FrictionLaw], fitted: Sequence[FittedLaw]) -> Iterator[FittedLaw]:
    """Yield the fits that are not those of laws within other fitted ones alone."""
    first = {one.law for one in kind.contained}
    kinds = {type(one.law) for one in fitted} - {kind}
    for one in fitted:
        within = any(containment_of(other, type(one.law)) for other in kinds)
        if one.law.name in first or not within:
            yield one


def not_whole(item: FreeParameter, value: float) -> float:
    """Return a value; next to it if it is a whole exponent, which has no slope.

    Whole exponents shape the equations.
    """
    whole = item.quantity.structural and value.is_integer()
    return value * (1.0 + NOT_WHOLE) if whole else value


def _embedded(
    kind: type[FrictionLaw],
    free_parameters: FreeParameters,
    one: FittedLaw,
    fitted: Sequence[FittedLaw],
    load: float,
) -> Iterator[dict[str, float]]:
    """Yield points, by path, at which the richer law is the simpler one or near it."""
    beside = {p: v for p, v in one.values.items() if not p.startswith("friction.")}
    if type(one.law) is kind:
        fields = (item.path for item in free_parameters.items if item.path.startswith("friction."))
        own = {path: float(getattr(one.law, path.partition(".")[2])) for path in fields}
        yield {**beside, **own}
        return
    containment = containment_of(kind, type(one.law))
    values = None if containment is None else containment.embed(one.law)
    if containment is None or values is None:
        return
    if kind.directional:
        constant = sum(one.values.get(path, 0.0) for path in CONSTANTS)
        for name in values:
            scale = fields_of(kind)[name].scale
            if scale in ("level+", "level-"):
                values[name] += float(f"{scale[-1]}1") * constant / load
    point = {**beside, **{f"friction.{name}": value for name, value in values.items()}}
    stiff = [
        item for item in free_parameters.items if item.path.partition(".")[2] in containment.limits
    ]
    if not stiff:
        yield point
    for item in stiff:
        # what goes to infinity in this law has a size in others: LuGre's stiffness is near Dahl's
        known = [other.values[item.path] for other in fitted if item.path in other.values]
        for value in (item.start, *known, STIFFER * item.start):
            yield {**point, item.path: min(value, item.high)}


def search_failure(
    kind: type[FrictionLaw], cost: float, rows: int, fitted: Sequence[FittedLaw]
) -> str:
    """Return a sentence if a contained law fits more closely than the richer one; empty if none.

    A law that is another one in a limit only, such as that of infinite stiffness, may leave more.

    Examples
    --------
    >>> from stickslip import Coulomb, CoulombViscous
    >>> simple = FittedLaw(law=Coulomb(kinetic_coefficient=0.2), values={}, cost=4.0, rows=100)
    >>> search_failure(CoulombViscous, 9.0, 100, [simple]).partition(": ")[2]
    'Coulomb friction, a special case of this law, has a residual 33 % smaller.'
    >>> search_failure(CoulombViscous, 4.0, 100, [simple])
    ''
    """
    for one in fitted:
        how = containment_of(kind, type(one.law))
        exact = type(one.law) is kind or (how is not None and not how.limits)
        if exact and one.rows == rows and cost > (1.0 + WORSE) * one.cost:
            less = 100.0 * (1.0 - (one.cost / cost) ** 0.5)
            return (
                f"The search did not converge: {one.law.title} friction, a special case of this"
                f" law, has a residual {number(less, 2)} % smaller."
            )
    return ""
