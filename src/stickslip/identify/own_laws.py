r"""Laws that are no sum of the vocabulary's parts, as terms of the posterior.

A law :math:`F(v; \theta)` of any form is linear about some values :math:`\theta_0`:

.. math::
    F(v; \theta) \approx \underbrace{F(v; \theta_0)
        - \sum_k \theta_{0k} \frac{\partial F}{\partial \theta_k}}_{\text{rest}}
        + \sum_k \theta_k \frac{\partial F}{\partial \theta_k} .

Each parameter that is varied is a term whose coefficient is its value; the *rest*, in which held
parameters are too, is a term whose coefficient is known to be 1. The values are
those at which the law fits the median of the drawn curves best.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any, TypeGuard

import numpy as np
from scipy.linalg import qr
from scipy.optimize import least_squares

from stickslip.errors import StickslipError
from stickslip.friction import FrictionLaw, bound
from stickslip.identify.fits import MOVED, Range, starting_law, with_ranges
from stickslip.identify.posterior import Array, Column, Structure
from stickslip.quantities import Quantity, fields_of, vary

TINY = 1e-12
"""Least size of a parameter that is moved for slopes."""
BEGINNINGS = 3
"""Values of each speed, or other shape, from which a law is first fitted: those of four at most."""
UNTOLD = 1e-2
"""Change of friction over what is allowed, as a parameter changes by its own size, to be told."""
SMALL = 1e-3
"""Share of its range that is the least size of a parameter, which may begin at 0, and of its usual
size up to which it is moved by that instead of by its own."""
PART_OF = 0.1
"""Part of a change that nothing tells, from which it is one of a parameter."""


class Slope(str):
    """Name of a term: how a law changes with one of its parameters."""

    own: "OwnLaw"
    """The law."""
    place: int
    """Number of the parameter among those varied; -1 of the rest."""


def is_slope(name: str) -> TypeGuard[Slope]:
    """Return whether a term is of a law that is no sum of the vocabulary's parts."""
    return isinstance(name, Slope)


def known_coefficients(names: Sequence[str]) -> dict[int, float]:
    """Return the coefficients of columns that are known, by their place."""
    return {k: 1.0 for k, name in enumerate(names) if is_slope(name) and name.place < 0}


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnLaw:
    """A law with what is varied of it."""

    law: FrictionLaw
    """It at the start, with what is held."""
    varied: tuple[str, ...]
    """Names of the parameters that are found."""
    load: float = 1.0
    """Normal force about which that of records changes [N]."""
    untold: tuple[str, ...] = ()
    """Names of parameters that were to be found and nothing tells."""
    sizes: Mapping[str, float] = field(default_factory=dict)
    """Usual sizes of parameters, by which they are moved for slopes."""

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """Symbols, units and ranges of what is varied."""
        return tuple(with_ranges(self.law, name) for name in self.varied)

    def at(self, values: Sequence[float]) -> FrictionLaw:
        """Return the law at values (p,) of what is varied, inside their ranges."""
        own = dict[str, float]()
        for name, quantity, value in zip(self.varied, self.quantities, values, strict=True):
            above = -math.inf if quantity.above is None else quantity.above + 1e-12
            own[name] = min(max(float(value), quantity.low, above), quantity.high)
        for name, quantity in fields_of(type(self.law)).items():
            least, held = quantity.at_least, getattr(self.law, name)
            if least is not None and name in own:
                own[name] = max(own[name], own.get(least, getattr(self.law, least)))
            elif least in own and name in self.untold:
                own[name] = float(self.beside(name, own))
            elif least in own and held is not None:
                own[least] = min(own[least], held)
        return vary(self.law, "friction", {f"friction.{name}": x for name, x in own.items()})

    def beside(self, name: str, found: Mapping[str, Any]) -> Any:
        """Return a parameter that nothing tells, beside those found, which it may not fall below.

        One that is no larger stays so.
        """
        own, base = getattr(self.law, name), fields_of(type(self.law))[name].at_least
        if base is None or base not in found:
            return own
        return found[base] if own == getattr(self.law, base) else np.maximum(own, found[base])

    def friction(self, values: Sequence[float], rows: "Slips") -> Array:
        """Return steady friction at rows (n,)."""
        law = bound(self.at(values), rows.inputs) if self.law.inputs else self.at(values)
        return np.asarray(law.steady(rows.velocity, rows.load) + 0.0 * rows.velocity, dtype=float)

    def columns(self, values: Sequence[float], rows: "Slips") -> Array:
        """Return the rest, then the change with each parameter, at rows (n, 1 + p)."""
        result, middle = [], self.friction(values, rows)
        for k in range(len(self.varied)):
            step = MOVED * max(abs(values[k]), self.sizes.get(self.varied[k], 0.0), TINY)
            ends = [list(values) for _ in range(2)]
            ends[0][k] -= step
            ends[1][k] += step
            before, after = (self.friction(x, rows) for x in ends)
            inside = [getattr(self.at(x), self.varied[k]) for x in ends]  # one side, at a bound
            result.append((after - before) / max(inside[1] - inside[0], 1e-300))
        x = np.column_stack([middle, *result])
        x[:, 0] -= x[:, 1:] @ np.asarray(values)
        return x

    def structure(self, values: Sequence[float]) -> Structure:
        """Return the law about values (p,) as terms."""
        terms = []
        for place, name in [(-1, ""), *enumerate(self.varied)]:
            term = Slope(f"{self.law.name}.{name}")
            term.own, term.place = self, place
            terms.append((term, tuple(map(float, values))))
        return tuple(sorted(terms, key=lambda item: item[0]))

    def fitted(self, target: Array, allowed: Array, rows: "Slips") -> "OwnLaw":
        """Return the law as it fits friction at rows (n,) best, by the deviations allowed (n,).

        A constant offset may stand beside it where both directions were seen. What nothing tells,
        alone or beside others, is held in part: the rest stands for it.
        """
        if not self.varied:
            return self
        both = bool((rows.velocity > 0.0).any() and (rows.velocity < 0.0).any())
        top = float(np.max(np.abs(rows.velocity)))
        size = float(np.sqrt(np.mean(target**2))) + 1e-300
        load = float(np.median(rows.load))
        ranges = [Range.of(item, _sizes(size, load, top)) for item in self.quantities]
        low = np.array([item.low for item in ranges])
        high = np.array([item.high for item in ranges])
        own = [float(x) if x is not None else item.start for x, item in zip(
            (getattr(self.law, name) for name in self.varied), ranges, strict=True)]  # fmt: skip
        wide = (low >= 0.0) & (high > 30.0 * np.maximum(low, 1e-3 * high))
        shapes = [
            k for k, quantity in enumerate(self.quantities) if quantity.scale in ("speed", "none")
        ]
        grids = [
            np.geomspace(max(low[k], 1e-3 * high[k]), high[k], BEGINNINGS + 2)[1:-1]
            if wide[k] else np.linspace(low[k], high[k], BEGINNINGS + 2)[1:-1]
            for k in shapes
        ]  # fmt: skip
        begins = [own]
        for some in itertools.islice(itertools.product(*grids), BEGINNINGS**4):
            begin = list(own)
            for k, x in zip(shapes, some, strict=True):
                begin[k] = float(x)
            begins.append(begin)

        def left(x: Array) -> Array:
            try:
                result = (self.friction(x.tolist(), rows) - target) / allowed
            except StickslipError:
                return np.full(len(target), 1e6)
            if both:
                result = result - np.sum(result / allowed) / np.sum(allowed**-2.0) / allowed
            return np.where(np.isfinite(result), result, 1e6)

        sizes = [
            max(abs(x), abs(item.start), SMALL * max(abs(item.low), abs(item.high)), TINY)
            for x, item in zip(own, ranges, strict=True)
        ]
        scale = np.array(sizes)
        best, cost = own, math.inf
        for begin in sorted(begins, key=lambda x: float(np.sum(left(np.array(x)) ** 2)))[:6]:
            inside = np.clip(begin, low + 1e-9 * scale, np.maximum(high - 1e-9 * scale, low))
            with suppress(ValueError):
                end = least_squares(left, inside, bounds=(low, high), x_scale=scale)
                if end.cost < cost:
                    best, cost = end.x.tolist(), float(end.cost)
        result = replace(self, law=self.at(best), sizes=dict(zip(self.varied, sizes, strict=True)))
        own_sizes = np.where(np.abs(best) > SMALL * scale, np.abs(best), scale)

        def changes(values: Sequence[float]) -> Array:
            return result.columns(values, rows)[:, 1:] * own_sizes / allowed[:, None]

        x = changes(best)
        least = UNTOLD * math.sqrt(len(x))
        _, told, ways = np.linalg.svd(x, full_matrices=True)
        told = np.concatenate([told, np.zeros(len(ways) - len(told))])
        lost = np.any(np.abs(ways[told < least]) > PART_OF, axis=0)
        for k in (k for k in shapes if lost[k]):  # what another value of it hides is not told
            low_end = max(low[k], 1e-3 * high[k])
            hidden = changes([low_end if place == k else z for place, z in enumerate(best)])
            lost |= np.linalg.norm(hidden, axis=0) < least
        given = np.where(lost, own, best)
        if np.sum(left(given) ** 2) <= 2.0 * cost + 1.0:
            result = replace(result, law=self.at(given.tolist()))
        _, order = qr(x, mode="r", pivoting=True)
        kept = {*order[: int(np.sum(told >= least))].tolist()} - {*np.flatnonzero(lost).tolist()}
        return replace(
            result,
            varied=tuple(name for k, name in enumerate(self.varied) if k in kept),
            untold=tuple(name for name, x in zip(self.varied, lost, strict=True) if x),
        )

    def holds_constant(self, rows: "Slips") -> bool:
        """Return whether its parameters can stand for a constant force at rows.

        Levels that differ by direction do under one load: an offset beside them is not told.
        """
        x = self.columns(self.values, rows)[:, 1:]
        ones = np.ones(len(x))
        left = ones - x @ np.linalg.lstsq(x, ones, rcond=None)[0]
        return bool(np.linalg.norm(left) < UNTOLD * np.linalg.norm(ones))

    @property
    def values(self) -> list[float]:
        """Values (p,) of what is varied."""
        return [getattr(self.law, name) for name in self.varied]


@dataclass(frozen=True, kw_only=True, eq=False)
class Slips:
    """Where a law is asked: steady sliding."""

    velocity: Array
    """Velocities (n,) [m/s]."""
    load: Array
    """Normal forces (n,) [N]."""
    inputs: Mapping[str, Array]
    """Temperatures and other inputs of the contact (n,)."""


def is_own(structure: Sequence[tuple[str, Any]]) -> bool:
    """Return whether a structure is a law that is no sum of parts."""
    return any(is_slope(name) for name, _ in structure)


def certain_of(structures: Sequence[Structure]) -> dict[str, float]:
    """Return the terms of laws whose coefficients are known."""
    terms = (name for structure in structures for name, _ in structure)
    return {name: 1.0 for name in terms if is_slope(name) and name.place < 0}


def signed_of(structures: Sequence[Structure]) -> frozenset[str]:
    """Return the terms of laws whose coefficients may be below 0."""
    terms = (name for structure in structures for name, _ in structure)
    return frozenset(name for name in terms if is_slope(name) and may_be_negative(name))


def slope_column(column: Column, rows: Slips) -> Array:
    """Return the column of a term of such a law at rows (n,)."""
    name, shape = column
    assert is_slope(name)
    values = [float(np.ravel(x)[0]) for x in shape]
    return np.asarray(name.own.columns(values, rows)[:, name.place + 1])


def may_be_negative(name: Slope) -> bool:
    """Return whether a coefficient may be below 0."""
    if name.place < 0:
        return True
    one = name.own.quantities[name.place]
    return (one.low if one.above is None else one.above) < 0.0


def is_dry(name: Slope) -> bool:
    """Return whether a term grows with the normal force, so that bristles carry it."""
    if name.place < 0:
        return True
    scale = name.own.quantities[name.place].scale.rstrip("+-")
    return scale not in ("slope", "drag")


def starting(
    law: FrictionLaw | type[FrictionLaw], values: Mapping[str, float], load: float
) -> FrictionLaw:
    """Return a law with values of all it needs: those given, else ordinary ones."""
    start = starting_law(law, load, values) if isinstance(law, type) else law
    return vary(start, "friction", {f"friction.{name}": x for name, x in values.items()})


def _sizes(size: float, load: float, top: float) -> dict[str, float]:
    """Return the sizes that ranges of parameters are multiples of, as friction has them."""
    level = size / load
    return {
        **dict.fromkeys(("level", "level+", "level-"), level),
        "load": load,
        "force": size,
        **dict.fromkeys(("slope", "slope+", "slope-"), size / top),
        "drag": size / top**2,
        "speed": top,
        "displacement": 1e-3,
        "stiffness": 1e3 * level,
        "damping": level / top,
    }
