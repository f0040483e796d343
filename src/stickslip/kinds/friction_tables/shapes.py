"""Shapes of friction over the speed that no candidate has, fitted beside the law that is named."""

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.friction import FrictionLaw
from stickslip.identification import interleaved
from stickslip.kinds.records.verdict import RecordCandidate
from stickslip.selection import LEAST, CrossValidation

Array = NDArray[np.float64]
Columns: TypeAlias = Callable[[Array], Sequence[Array]]
"""Columns of a shape beside a level, over speeds as shares of the largest."""
Shape: TypeAlias = Sequence[Columns]
"""A shape at each value of what it is not linear in."""

ENOUGH: Final = 5
"""Speeds of a direction from which curves are drawn through them."""
FADES: Final[tuple[Columns, ...]] = (
    lambda u: [np.exp(-np.sqrt(u))],
    lambda u: [np.exp(-u)],
    lambda u: [np.exp(-u * u)],
    lambda u: [1.0 / (1.0 + u)],
    lambda u: [1.0 / (1.0 + u * u)],
    lambda u: [1.0 / (1.0 + u**4)],
)
"""How a surplus fades, or with a negative one friction saturates, ..."""
RISES: Final[tuple[Columns, ...]] = (
    lambda _: [],
    lambda x: [x],
    lambda x: [np.sqrt(x)],
    lambda x: [x * x],
)
"""... and what rises beside it."""
LOGARITHMS: Final[tuple[Columns, ...]] = (
    lambda x: [np.log(x)],
    lambda x: [np.log(x), np.log(x) ** 2],
    lambda x: [np.log(x), np.log(x) ** 2, np.log(x) ** 3],
)
"""Polynomials of the logarithm of the speed."""
EXPONENTS: Final = (-2.0, -1.0, -0.5, -0.25, 0.25, 0.35, 0.5, 0.65, 0.8, 1.0, 1.25, 1.5, 2.0, 3.0)
"""Those of powers of the speed."""
SCALES: Final = 14
"""Speeds at which shapes bend that are tried, from half of the slowest to beyond the fastest."""
FINE: Final = 60
"""Speeds of each direction at which shapes are compared, alike many between any two readings."""
WEIGHT: Final = 0.5
"""Readings, of each one, that the weight of a shape counts: held-out errors of a dozen scatter."""
FAR: Final = 0.25
"""Mean distance of the shapes from a law, over its held-out error, from which others are possible.

Measured on tables that had been drawn for this: said of 15 % of laws that were right within the
noise, and of 10 of 15 that were not and had been named without a doubt.
"""
CUTOFF: Final = 1e-6
"""Singular values over the largest one below which columns have no effect."""
DECIDES: Final = 1e-9
"""Stands for the share of a reading that others tell where it decides alone."""
LENGTHS: Final = (0.1, 0.2, 0.3, 0.5, 0.85)
"""Lengths over which curves bend, over the range of the logarithm of the speed ..."""
NOISES: Final = (0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5)
"""... and variances of the noise, over that by which they bend."""
STIFF: Final = 100.0
"""Variance of the level of a curve, over that by which it bends."""


@final
@dataclass(frozen=True, eq=False)
class Readings:
    """Friction at steady speeds under one load, and which readings are held out together."""

    velocity: Array
    friction: Array
    load: float
    groups: Sequence[NDArray[np.intp]]
    """Readings (rows) of each held-out block."""

    @classmethod
    def of(cls, candidate: RecordCandidate) -> "Readings | None":
        """Return what a candidate was fitted to.

        None where a direction has too few speeds, or the load varies.
        """
        fit = candidate.fit
        if fit is None or candidate.validation is None or not interleaved(fit.problem.spans):
            return None
        velocity, friction, load = (
            np.concatenate([getattr(one, name) for one in fit.problem.samples])
            for name in ("velocity", "friction", "load")
        )
        segment = fit.optimum.best.segment
        if len(segment) != len(velocity) or np.ptp(load) > 0.0 or not friction.any():
            return None
        counts = [len(np.unique(velocity[side])) for side in (velocity > 0.0, velocity < 0.0)]
        if not velocity.all() or any(0 < count < ENOUGH for count in counts):
            return None
        groups = [np.flatnonzero(segment == k) for k in np.unique(segment)]
        return cls(velocity, friction, float(load[0]), groups)

    @cached_property
    def speed(self) -> Array:
        """Sizes of the velocities [m/s]."""
        return np.abs(self.velocity)

    @cached_property
    def side(self) -> Array:
        """Signs of the velocities."""
        return np.sign(self.velocity)

    @cached_property
    def between(self) -> Array:
        """Velocities [m/s] between the readings, alike many from each to the next."""
        sides = [np.sort(self.velocity[self.side == one]) for one in (-1.0, 1.0)]
        return np.concatenate(
            [
                np.interp(np.linspace(0.0, len(one) - 1.0, FINE), np.arange(len(one)), one)
                for one in sides
                if len(one)
            ]
        )


def smooth_curve(readings: Readings) -> CrossValidation:
    """Return the held-out errors of the smooth curve that predicts a table best.

    The curve is no law: a Gaussian process over the logarithm of the speed, one for each direction.
    """
    x, side, friction = np.log(readings.speed), readings.side, readings.friction
    alike = side[:, None] == side[None, :]
    apart = np.subtract.outer(x, x) / max(float(np.ptp(x)), 1e-9)
    tried = []
    for length, noise in itertools.product(LENGTHS, NOISES):
        covariance = alike * (np.exp(-0.5 * (apart / length) ** 2) + STIFF)
        inverse = np.linalg.inv(covariance + noise * np.eye(len(x)))
        weights = inverse @ friction
        left = [np.linalg.solve(inverse[np.ix_(r, r)], weights[r]) for r in readings.groups]
        tried.append(tuple(float(np.mean(one**2)) for one in left))
    return CrossValidation(losses=min(tried, key=sum), extrapolation=math.nan)


@final
@dataclass(frozen=True, eq=False)
class _Fitted:
    """A shape that was fitted."""

    losses: tuple[float, ...]
    """Mean squares of held-out blocks."""
    predicted: Array
    """Friction [N] between the readings."""


def other_shape(candidate: RecordCandidate, readings: Readings) -> CrossValidation | None:
    """Return the errors of the best other shape if the law may be far from the true one.

    That is the mean square distance of all shapes from the law between the readings. A shape counts
    by its likelihood of held-out readings (pseudo-Bayesian model averaging, Geisser and Eddy 1979),
    all together before that as much as the law.
    """
    fit = candidate.fit
    assert fit is not None
    law = fit.law
    own = np.asarray(law.force(readings.between, np.full(len(readings.between), readings.load)))
    own = own + fit.offset
    free = any(path.endswith("offset") for path in fit.free_parameters.paths)
    scale = candidate.score
    if not scale > 0.0:
        return None
    found = [_fitted(shape, readings, law, free=free) for shape in _shapes(readings)]
    errors = np.array([math.sqrt(float(np.mean(one.losses))) for one in found])
    distances = np.array([float(np.mean((one.predicted - own) ** 2)) for one in found])
    logs = -WEIGHT * len(readings.velocity) * np.log(np.maximum(errors, DECIDES * scale) / scale)
    most = max(float(logs.max()), 0.0)
    weights = np.exp(logs - most) / len(found)
    mean = float(weights @ distances) / (math.exp(-most) + float(weights.sum()))
    if math.sqrt(mean) <= FAR * scale:
        return None
    best = found[int(np.argmin(errors))]
    return CrossValidation(losses=best.losses, extrapolation=math.nan)


def _shapes(readings: Readings) -> Iterator[Shape]:
    """Yield all shapes, at scales that the speeds of a table have."""
    slowest = float(readings.speed.min() / readings.speed.max())
    scales = np.geomspace(slowest / 2.0, 1.5, SCALES).tolist()

    def beside(fade: Columns, rise: Columns, s: float) -> Columns:
        return lambda x: [*fade(x / s), *rise(x)]

    def kink(s: float) -> Columns:
        return lambda x: [np.maximum(-np.log(x / s), 0.0), np.maximum(x / s - 1.0, 0.0)]

    def power(n: float) -> Columns:
        return lambda x: [x**n]

    for fade, rise in itertools.product(FADES, RISES):
        yield [beside(fade, rise, s) for s in scales]
    yield [kink(s) for s in scales]
    yield [power(n) for n in EXPONENTS]
    yield from ([one] for one in LOGARITHMS)


def _fitted(shape: Shape, readings: Readings, law: FrictionLaw, *, free: bool) -> _Fitted:
    """Fit a shape to a table: to each direction where those of the law differ."""
    if not law.directional:
        rows = np.arange(len(readings.velocity))
        return _part(shape, readings, rows, np.ones(len(readings.between), bool), free=free)
    losses = [np.zeros(0) for _ in readings.groups]
    predicted = np.empty(len(readings.between))
    for side in np.unique(readings.side):
        there = np.sign(readings.between) == side
        rows = np.flatnonzero(readings.side == side)
        one = _part(shape, readings, rows, there, free=False)
        predicted[there] = one.predicted
        seen = [k for k, group in enumerate(readings.groups) if np.isin(group, rows).any()]
        for k, loss in zip(seen, one.losses, strict=True):
            losses[k] = np.append(losses[k], loss)
    return _Fitted(tuple(float(one.mean()) for one in losses), predicted)


def _part(
    shape: Shape,
    readings: Readings,
    rows: NDArray[np.intp],
    there: NDArray[np.bool_],
    *,
    free: bool,
) -> _Fitted:
    """Fit a shape to rows; predict the velocities between them that are there."""
    top = float(readings.speed.max())

    def design(columns: Columns, velocity: Array) -> Array:
        x, sign = np.abs(velocity) / top, np.sign(velocity)
        made = [sign, *(sign * one for one in columns(x)), *([np.ones_like(x)] if free else [])]
        return np.column_stack(made)

    y, v = readings.friction[rows], readings.velocity[rows]
    places = [np.flatnonzero(np.isin(rows, group)) for group in readings.groups]
    places = [one for one in places if len(one)]
    designs = [design(columns, v) for columns in shape]
    whole, rest, losses = [], [], []
    for columns in designs:
        sizes = np.maximum(np.linalg.norm(columns, axis=0), LEAST)
        u, s, _ = np.linalg.svd(columns / sizes, full_matrices=False)
        u = u[:, s > CUTOFF * s[0]]
        left, others = y - u @ (u.T @ y), np.eye(len(y)) - u @ u.T
        held = [
            np.linalg.solve(others[np.ix_(r, r)] + DECIDES * np.eye(len(r)), left[r])
            for r in places
        ]
        whole.append(float(left @ left))
        rest.append([whole[-1] - float(left[r] @ h) for r, h in zip(places, held, strict=True)])
        losses.append([float(np.mean(h**2)) for h in held])
    taken = np.argmin(np.array(rest), axis=0)  # the scale is looked for without what is held out
    best = int(np.argmin(whole))
    values = np.linalg.lstsq(designs[best], y, rcond=CUTOFF)[0]
    return _Fitted(
        losses=tuple(losses[int(i)][k] for k, i in enumerate(taken)),
        predicted=design(shape[best], readings.between[there]) @ values,
    )
