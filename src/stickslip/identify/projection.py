r"""Names and parameters: drawn curves of friction projected on families of laws.

The posterior says what friction is at some places, as draws :math:`f_d` of a curve (law and what
no law says). Let :math:`m` be their median, :math:`\sigma` half their range from 16 to 84 %, and
:math:`g = \max(|m|, .3\,\mathrm{rms}\,m)` the size of friction.

1. **Each family** is fitted to :math:`m` over all its shapes, by least squares with weights
   :math:`1/\max(2\sigma, \tau g)`, :math:`\tau` the tolerance. Its *distance* is the 95 % quantile
   of what is left over :math:`g`: "stays within x % of friction at 95 % of the places".
2. **The name**, where what no law says is below the noise, is the family with the most weight
   among nodes at which it is below the tolerance, if that stays within the posterior: a level with
   10 % of something else, such as an effect of the pressure that it lacks, says that a level does
   not describe it. Real friction leaves something to every law, which further terms only follow:
   there it is the law of the least :math:`\log d + \kappa (p + r)`, with the distance
   :math:`d` or a little more than the tolerance, the number of parameters :math:`p`, and the place
   from usual to unusual :math:`r`.
3. **Parameters** are those of all draws, each projected on the named family with its own best
   shape; if the law holds, those of draws of the named family alone. A draw of records that has the
   terms of the family, and no curve beside it, keeps its own shapes and coefficients.

(J. Piironen, M. Paasiniemi, A. Vehtari, Projective inference, 2020.)
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.own_laws import is_slope, known_coefficients, may_be_negative
from stickslip.identify.posterior import Array, Family, Structure
from stickslip.identify.vocabulary import FAMILIES, FLOW_DIRECTIONS, NARROW, PARTS, SIGNED

TOLERANCE = 0.02
"""Share of friction by which a law may be off, if nothing else is asked for."""
PLACES = 0.95
"""Share of the places at which a law stays within its distance."""
DEVIATIONS = 2.0
"""Deviations of the posterior by which a law may be off."""
SMALL = 0.3
"""Least size of friction, over its root mean square, by which distances are taken."""
EXACT = 0.5
"""Probability that what no law says is below the noise, from which the evidence names."""
COST = 0.15
"""Part of its distance that a parameter must save, or a place from usual to unusual, where no law
is exact."""
MARGIN = 1.25
"""Distance over the tolerance up to which a law is within it: rounding decides no name."""
BEGIN = 24
"""Values of a shape at which the projection of draws begins; of two, a quarter each."""
EXPONENTS = (0.05, 3.0)
"""Range of powers of the speed in draws."""
LOADS = (0.2, 1.5)
"""Range of powers of the load in draws."""
POLISHES = 6
"""Rounds in which shapes of draws are refined ..."""
STEP = 1e-4
"""... with slopes over that step of their logarithm."""
EITHER = frozenset({"offset", "level_direction", *FLOW_DIRECTIONS, "stribeck_sides", *SIGNED})
"""Terms whose coefficients may have either sign; of what changes with an input all may."""


def is_signed(name: str) -> bool:
    """Return whether the coefficients of a term may have either sign."""
    return may_be_negative(name) if is_slope(name) else name in EITHER or "*" in name


@dataclass(frozen=True, kw_only=True, eq=False)
class Rung:
    """A law of a family, and how far it is from what friction is."""

    structure: Structure
    coefficients: Array
    """Coefficients (p,) of its columns."""
    distance: float
    """Share of friction by which it is off at most at `PLACES` of the places."""
    worst: float
    """Largest share of friction by which it is off ..."""
    where: int
    """... and the place."""
    excess: float
    """The same as the distance over what is allowed: up to 1 it stays within the posterior."""
    parameters: int
    share: float = 0.0
    """Posterior probability of the family."""
    adequate: float = 0.0
    """That with nodes at which what no law says is below the tolerance."""

    @property
    def family(self) -> Family:
        """Names of the terms."""
        return tuple(name for name, _ in self.structure)


@dataclass(frozen=True, kw_only=True, eq=False)
class Target:
    """What friction is at some places."""

    draws: Array
    """Drawn curves (k, n)."""
    tolerance: float
    scale: Array | float = 1.0
    """How friction grows with the load at the places (n,)."""

    @cached_property
    def middle(self) -> Array:
        """Medians (n,)."""
        return np.asarray(np.median(self.draws, axis=0))

    @cached_property
    def size(self) -> Array:
        """Size of friction (n,) by which distances are taken."""
        middle = self.middle
        typical = SMALL * np.sqrt(np.mean(middle**2)) + 1e-300
        return np.asarray(np.maximum(np.abs(middle), typical * self.scale))

    @cached_property
    def allowed(self) -> Array:
        """How far a law may be off (n,)."""
        low, high = np.quantile(self.draws, (0.16, 0.84), axis=0)
        deviation = 0.5 * (high - low)
        return np.asarray(np.maximum(DEVIATIONS * deviation, self.tolerance * self.size))


class Projection:
    """Laws as they are projected on what friction is."""

    def __init__(self, target: Target) -> None:
        self.middle, self.size, self.allowed = target.middle, target.size, target.allowed

    def closest(
        self, structures: Sequence[Structure], x: Array, parameters: int, *, alone: bool = False
    ) -> Rung | None:
        """Return the law of a family with columns (s, n, p) that is closest.

        None if none has coefficients of the signs that they must have; if it is `alone`, what would
        be negative is 0.
        """
        norm = np.sqrt(np.mean(x * x, axis=1)) + 1e-300
        weighted = x / norm[:, None, :] / self.allowed[:, None]
        y = self.middle / self.allowed
        names = names_of(structures[0])
        positive = np.array([not is_signed(name) for name in names])
        gram = np.einsum("sni,snj->sij", weighted, weighted)
        size = gram.shape[1]
        own = np.einsum("sii->si", gram)
        gram[:, range(size), range(size)] = np.where(own > 0.0, (1.0 + 1e-9) * own, 1.0)
        moment = np.einsum("sni,n->si", weighted, y)
        for k, x_k in known_coefficients(names).items():
            hold(gram, moment, k, x_k * norm[:, k])
        c = np.linalg.solve(gram, moment[..., None])[..., 0]
        if alone:
            c = solved(gram, moment, positive)
        left = -np.sum(c * (2.0 * moment - np.einsum("sij,sj->si", gram, c)), axis=1)
        wrong = np.any((c < 0.0) & positive, axis=1)
        k = int(np.argmin(np.where(wrong, np.inf, left)))
        if wrong[k]:
            return None
        return self.rung(structures[k], c[k] / norm[k], x[k], parameters)

    def rung(
        self, structure: Structure, coefficients: Array, columns: Array, parameters: int
    ) -> Rung:
        """Return how far a law with coefficients (p,) and columns (n, p) is."""
        left = np.abs(columns @ coefficients - self.middle)
        apart = left / self.size
        where = int(np.argmax(apart))
        return Rung(
            structure=structure,
            coefficients=coefficients,
            distance=float(np.quantile(apart, PLACES)),
            worst=float(apart[where]),
            where=where,
            excess=float(np.quantile(left / self.allowed, PLACES)),
            parameters=parameters,
        )


def hold(gram: Array, moment: Array, place: int, value: Array | float) -> None:
    """Hold a coefficient of normal equations (..., p, p) and (..., p) to a value (...)."""
    moment -= gram[..., :, place] * np.asarray(value)[..., None]
    gram[..., place, :] = 0.0
    gram[..., :, place] = 0.0
    gram[..., place, place] = 1.0
    moment[..., place] = value


def solved(gram: Array, moment: Array, positive: "NDArray[np.bool_]") -> Array:
    """Return solutions (k, p) of normal equations (k, p, p), (k, p): some are not negative.

    What is negative is held to 0, and what then is negative as well.
    """
    c = np.linalg.solve(gram, moment[..., None])[..., 0]
    held = np.zeros(c.shape, dtype=bool)
    for _ in range(c.shape[1]):
        wrong = (c < 0.0) & positive
        if not wrong.any():
            break
        held |= wrong
        free = ~held[:, :, None] & ~held[:, None, :]
        own = np.where(free, gram, 0.0) + held[:, :, None] * np.eye(c.shape[1])
        c = np.where(
            held, 0.0, np.linalg.solve(own, np.where(held, 0.0, moment)[..., None])[..., 0]
        )
    return np.asarray(c)


def names_of(structure: Sequence[tuple[str, Any]]) -> list[str]:
    """Return the name of the term of each column of a structure."""
    return [name for name, _ in structure for _ in range(2 if name == "stribeck_sides" else 1)]


def cost_of(rung: Rung, tolerance: float) -> float:
    """Return what a law costs where none is exact: its distance, its parameters, and its place.

    Examples
    --------
    >>> import dataclasses
    >>> law = Rung(
    ...     structure=(("level", ()),),
    ...     coefficients=np.ones(1),
    ...     distance=0.02,
    ...     worst=0.02,
    ...     where=0,
    ...     excess=1.0,
    ...     parameters=1,
    ... )
    >>> cost_of(law, 0.02) == cost_of(dataclasses.replace(law, distance=0.024), 0.02)
    True
    """
    names = [name for name, _ in rung.structure if name in PARTS or name == "stribeck_sides"]
    family = sorted("stribeck" if name == "stribeck_sides" else name for name in names)
    place = FAMILIES.get(" ".join(family), max(FAMILIES.values()))
    distance = max(rung.distance, MARGIN * tolerance)
    return math.log(distance) + COST * (rung.parameters + place)


@dataclass(frozen=True, kw_only=True)
class Free:
    """An entry of a shape that draws have of their own, and its range."""

    column: int
    entry: int
    low: float
    high: float


Shaped = Sequence[tuple[str, tuple[Array | float, ...]]]
"""A structure whose shapes may be arrays (k, 1): those of each draw."""


def shapes_to_draw(
    structure: Structure, slowest: float, fastest: float
) -> tuple[list[Free], list[Structure]]:
    """Return the entries of shapes that draws have of their own, and structures to begin at."""
    free = list[Free]()
    for column, (name, _) in enumerate(structure):
        part = "stribeck" if name in ("hersey", "stribeck_sides") else name
        if part in NARROW:
            low, high = NARROW[part]
            ends = (low * slowest, high * fastest)
            free.append(Free(column=column, entry=0, low=ends[0], high=ends[1]))
        elif part == "power":
            free.append(Free(column=column, entry=0, low=EXPONENTS[0], high=EXPONENTS[1]))
    many = (0, BEGIN, BEGIN // 4)[min(len(free), 2)]
    grids = [np.geomspace(item.low, item.high, many).tolist() for item in free]
    result = []
    for some in itertools.product(*grids) if free else ():
        shapes = [list(shape) for _, shape in structure]
        for member, x in zip(free, some, strict=True):
            shapes[member.column][member.entry] = x
        names = [name for name, _ in structure]
        result.append(tuple((n, tuple(s)) for n, s in zip(names, shapes, strict=True)))
    of_load = [
        (column, len(shape) - 1)
        for column, (name, shape) in enumerate(structure)
        if name in PARTS and len(shape) > len(PARTS[name].shapes) and shape[-1] != 1.0
    ]
    if of_load:  # one power for all terms
        (column, entry), *_ = of_load
        free.append(Free(column=column, entry=entry, low=LOADS[0], high=LOADS[1]))
    return free, result


class Projector:
    """Draws of curves projected on a family: each has its own best shape."""

    def __init__(
        self,
        design: Callable[[Shaped], Array],
        free: Sequence[Free],
        weights: Array,
        positive: "NDArray[np.bool_]",
    ) -> None:
        self.design, self.free = design, free
        self.weights, self.positive = weights, positive

    def _weighted(self, x: Array) -> Array:
        """Return columns (..., n, p) times the weights."""
        return self.weights[:, None] * x if self.weights.ndim == 1 else self.weights @ x

    def _shaped(self, structure: Shaped, shapes: Array) -> Shaped:
        """Return a structure with the free entries (k, f)."""
        result = [(name, list(shape)) for name, shape in structure]
        for place, item in enumerate(self.free):
            result[item.column][1][item.entry] = shapes[:, place, None]
        return [(name, tuple(shape)) for name, shape in result]

    def _solved(
        self, structure: Shaped, shapes: Array, y: Array, about: Array | None = None
    ) -> tuple[Array, Array]:
        """Return coefficients (k, p) for shapes (k, f), and what they leave of draws (k, n).

        They differ from those that are known by about their size where curves do not tell them.
        """
        x = self._weighted(self.design(self._shaped(structure, shapes)))
        x = x.reshape(-1, *x.shape[-2:])  # of all draws, or of each
        norm = np.sqrt(np.mean(x * x, axis=1)) + 1e-300
        norm = np.maximum(norm, 1e-12 * norm.max(axis=1, initial=0.0, keepdims=True))
        scaled = x / norm[:, None, :]
        gram = scaled.swapaxes(1, 2) @ scaled
        size = gram.shape[1]
        norms = np.einsum("kii->ki", gram)  # a part that has faded at all places is 0
        gram[:, range(size), range(size)] = np.where(norms > 0.0, (1.0 + 1e-10) * norms, 1.0)
        gram = np.repeat(gram, len(y) // len(gram), axis=0)
        moment = (y[:, None] @ scaled)[:, 0]
        if about is not None:
            square = np.mean(about**2, axis=0)
            held = np.where(square > 0.0, 1.0 / (square + 1e-300), 0.0) / norm
            gram[:, range(size), range(size)] += held / norm
            moment += about * held
        for k, known_coefficient in known_coefficients(names_of(structure)).items():
            hold(gram, moment, k, known_coefficient * norm[:, k])
        c = solved(gram, moment, self.positive)
        return c / norm, y - (scaled @ c[..., None])[..., 0]

    def __call__(
        self, draws: Array, structures: Sequence[Structure], about: Array | None = None
    ) -> tuple[Array, Shaped]:
        """Return coefficients (k, p) and shapes of draws (k, n), from the best of structures.

        They are `about` some (k, p), if any are known.
        """
        y = self._weighted(draws.T).T
        least = np.full(len(draws), np.inf)
        shapes = np.zeros((len(draws), len(self.free)))
        c = np.zeros((len(draws), len(self.positive)))
        for structure in structures:
            own = np.array([[structure[f.column][1][f.entry] for f in self.free]], dtype=float)
            coefficients, left = self._solved(structure, own, y, about)
            misfit = np.sum(left * left, axis=1)
            better = misfit < least
            least = np.where(better, misfit, least)
            shapes[better], c[better] = own, coefficients[better]
        if self.free:
            c, shapes = self._polished(structures[0], shapes, c, least, y)
        return c, self._shaped(structures[0], shapes)

    def _polished(
        self, structure: Structure, shapes: Array, c: Array, least: Array, y: Array
    ) -> tuple[Array, Array]:
        """Return coefficients and shapes after rounds of Gauss-Newton over the shapes.

        Of the residual only what the columns do not take up counts (variable projection).
        """
        low = np.log([item.low for item in self.free])
        high = np.log([item.high for item in self.free])
        logs, damping = np.log(shapes), np.full(len(y), 1e-3)
        _, base = self._solved(structure, np.exp(logs), y)
        for _ in range(POLISHES):
            slopes = []
            for place in range(len(self.free)):
                step = np.zeros(len(self.free))
                step[place] = STEP
                _, moved = self._solved(structure, np.exp(logs + step), y)
                slopes.append((moved - base) / STEP)
            j = np.stack(slopes, axis=2)
            gram = np.einsum("kni,knj->kij", j, j)
            at = range(len(self.free))
            gram[:, at, at] *= 1.0 + damping[:, None]
            gram[:, at, at] += 1e-300 + 1e-12 * np.sum(y * y, axis=1)[:, None]
            move = -np.linalg.solve(gram, np.einsum("kni,kn->ki", j, base)[..., None])[..., 0]
            new = np.clip(logs + np.clip(move, -0.5, 0.5), low, high)
            coefficients, left = self._solved(structure, np.exp(new), y)
            misfit = np.sum(left * left, axis=1)
            better = misfit < least
            damping = np.where(better, 0.3 * damping, 10.0 * damping)
            least = np.where(better, misfit, least)
            logs[better], c[better], base[better] = new[better], coefficients[better], left[better]
        return c, np.exp(logs)
