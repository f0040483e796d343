"""Start values and bounds for laws, from friction that was measured against motion."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError, InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits.estimation.bristle_integration import follow
from stickslip.identify.fits.estimation.levenberg_marquardt import improve
from stickslip.identify.fits.estimation.parameters import (
    WIDE,
    FreeParameter,
    FreeParameters,
    Sizes,
    is_level,
    required_of,
    with_arrays,
    with_ranges,
)
from stickslip.identify.fits.force_map.data import SLOW, MotionSegment
from stickslip.identify.fits.force_map.model import ForceMap
from stickslip.identify.fits.series.inverse_dynamics import HUBER
from stickslip.identify.fits.series.start_values import LITTLE, MOST
from stickslip.identify.fits.validation import LAW
from stickslip.quantities import Quantity, fields_of, full_path, parameters, vary

Array = NDArray[np.float64]

FOLLOWED = 7
"""Starts with different speeds that are followed."""
SPEEDS = tuple(float(f"{share:.3g}") for share in np.geomspace(1e-3, 1.0, 7))
"""Stribeck velocities over the largest speed: half decades."""
STIFFNESSES = tuple(float(10.0 ** (0.5 * power)) for power in range(-6, 3))
"""Stiffness over the one that reversals suggest, which is more often too high than too low."""
EXPONENTS = (0.1, 0.6, 1.5)
"""Exponents; whole ones are another law's."""
FADINGS = (1.01, 1.5, 1.99)
"""Exponents with which a static surplus fades, from Tustin's to Gauss's."""
SURPLUS = 0.2
"""Static surplus to begin with, over the kinetic level; that level itself is tried, too."""
STIFF = "stiffness"
FAST = 0.5
"""Share of the largest speed (its 99th percentile) above which slip counts as steady."""
FARTHER = 10.0
"""How much farther than its range an exponent, a change with an input, and what spans decades is
looked for."""
STEPS = 4
"""Steps downhill from points of the grid, before the best end is followed."""


def screened_starts(problem: ForceMap, coarse: ForceMap) -> tuple[Array, ...]:
    """Return values (p,) from which the search of a force map should begin, the best first.

    Examples
    --------
    >>> from stickslip import Axis, Measurement, Stribeck
    >>> from stickslip.identify.fits.force_map.problem import force_map
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
    known = tuple(one.values for one in ends if np.isfinite(one.cost))
    return known or (problem.free_parameters.start,)


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
    return list(kept.values())[:FOLLOWED]


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
        return [item.start, item.start / SURPLUS]
    if item.quantity.structural:
        return EXPONENTS
    if item.quantity.scale == "speed":
        return [item.high / FARTHER * share for share in SPEEDS]
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
            replace(coarse, law=law, free_parameters=free_parameters), values[free], rounds=STEPS
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
    states = follow(laws[0], one.path, np.zeros((len(base.states), count)))
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
            new[k] = coarse.derived[j] + float(found[len(found) - len(coarse.linear) + j])
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
        end, _ = improve(coarse, rated.values, rounds=STEPS)
    except ConvergenceError:
        return _Rated(rated.values, np.inf)
    return _Rated(end.values, end.cost)


@dataclass(frozen=True, kw_only=True)
class StartEstimate:
    """What friction against motion says at a glance.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, Measurement
    >>> from stickslip.identify.fits.force_map.data import stretches_of
    >>> v = np.linspace(-1.0, 1.0, 100)
    >>> table = Measurement(velocity=v, friction=2.0 * np.sign(v) + 0.5)
    >>> rough = StartEstimate.of(stretches_of(Axis(inertia=1.0), table))
    >>> round(rough.level, 6), round(rough.offset, 6)
    (2.0, 0.5)
    """

    level: float
    """Friction over normal force while sliding, less the viscous part."""
    viscous: float
    """Growth of friction with speed [N s/m]."""
    offset: float
    """Constant force beside friction [N]."""
    force: float
    """Typical friction force [N]."""
    load: float
    """Typical normal force [N]."""
    speed: float
    """Largest speed, the 99th percentile [m/s]."""
    stiffness: float
    """Slope of friction against displacement in presliding, over the normal force [1/m]."""
    two_sided: bool
    """Whether there is slip in both directions."""
    sides: tuple["StartEstimate", ...] = ()
    """The same of backward and of forward slip alone."""

    @property
    def sizes(self) -> Sizes:
        """The sizes that the ranges of a law's parameters are multiples of."""
        back, ahead = self.sides or (self, self)
        level = max(self.force / self.load, 1e-12)
        slope = self.force / self.speed
        typical = {
            "level": self.level,
            "level+": ahead.level,
            "level-": back.level,
            "load": self.load,
            "force": self.level * self.load,
            "slope": self._slope,
            "slope+": ahead._slope,
            "slope-": back._slope,
            "drag": 0.1 * slope / self.speed,
            "speed": self.speed,
            "displacement": self.level / self.stiffness,
            "stiffness": self.stiffness,
            "damping": 0.01 * self.level / self.speed,
        }
        reach = typical | {
            **dict.fromkeys(("level", "level+", "level-"), level),
            "force": self.force,
            **dict.fromkeys(("slope", "slope+", "slope-"), slope),
            "drag": slope / self.speed,
            "displacement": level / self.stiffness,
            "damping": 0.1 * level / self.speed,
        }
        return Sizes(typical=typical, reach=reach)

    @property
    def _slope(self) -> float:
        return max(self.viscous, 1e-3 * self.force / self.speed)

    @classmethod
    def of(
        cls, stretches: Sequence[MotionSegment], *, offset: float | None = None
    ) -> "StartEstimate":
        """Return what some stretches say; the offset is looked for if it is not given."""
        rows = [
            np.stack([one.path.velocity, one.path.load, one.friction])[:, one.rows_of(None)]
            for one in stretches
        ]
        v, n, f = np.concatenate(rows, axis=1)
        speed = float(np.percentile(np.abs(v), 99.0)) or 1.0
        ahead, back = v > SLOW * speed, v < -SLOW * speed
        two_sided = min(np.mean(ahead), np.mean(back)) > LITTLE
        if offset is None:
            offset = _middle(v, f, FAST * speed) if two_sided else 0.0
        own: dict[str, Any] = {
            "offset": offset,
            "load": float(np.median(n)),
            "speed": speed,
            "two_sided": bool(two_sided),
            "force": max(float(np.sqrt(np.mean((f - offset) ** 2))), 1e-12),
        }
        stiffness = _stiffness(stretches, own["force"])
        sides = []
        for side in (back, ahead, ahead | back):
            enough = side if two_sided else np.ones(len(v), dtype=bool)
            level, viscous = _line(
                np.abs(v[enough]), n[enough], np.abs(f - offset)[enough], FAST * speed
            )
            sides.append(cls(level=level, viscous=viscous, stiffness=stiffness, **own))
        return cls(**{**_plain(sides[2]), "sides": (sides[0], sides[1])})

    def law(
        self, kind: type[FrictionLaw], known: Mapping[str, float], named: Collection[str] = ()
    ) -> FrictionLaw:
        """Return a law of a kind: known values by name, else of these sizes where it needs some.

        What it may do without it has if it is named.
        """
        values: dict[str, Any] = {}
        for declared in fields(kind):
            quantity = fields_of(kind).get(declared.name)
            own = declared.name in named
            if quantity is None or (declared.default is None and not own):
                continue
            if declared.name in known:
                values[declared.name] = float(known[declared.name])
                continue
            needed = not isinstance(declared.default, (int, float))
            if needed if quantity.structural else own or declared.name in _wanted(kind):
                value = self.sizes.of(with_ranges(kind, declared.name)).start
                value = min(max(value, quantity.low), quantity.high)
                if quantity.at_least is not None and quantity.at_least in values:
                    value = values[quantity.at_least] * (1.0 + SURPLUS)
                values[declared.name] = value
        return kind(**values)

    def seeks_constant(self, kind: type[FrictionLaw], held: Collection[str]) -> bool:
        """Whether a constant force is looked for beside a law: not if it is held.

        A record has one number for it and a level with laws that have a level of their own in each
        direction, and where slip is in one direction only.
        """
        return self.two_sided and not kind.directional and not held

    def unknowns(
        self,
        law: FrictionLaw | type[FrictionLaw],
        *,
        free: Collection[str] | None = None,
        known: Mapping[str, float] | None = None,
        held: Collection[str] = (),
        constant: str | None = None,
    ) -> tuple[FrictionLaw, FreeParameters]:
        """Return a law to start from, and its unknowns with those of a constant force, if any."""
        known = known or {}
        typed = isinstance(law, type)
        kind = law if isinstance(law, type) else type(law)
        paths_of = {f"friction.{name}": quantity for name, quantity in fields_of(kind).items()}
        alone = [name for name in free or () if name.count(".") < 2 and name != LAW]
        named = {full_path(name, paths_of).partition(".")[2] for name in alone}
        start: FrictionLaw
        if isinstance(law, type):
            start = self.law(kind, known, named)
        else:
            bare = [name for name in named if getattr(law, name) is None]
            start = replace(law, **{n: getattr(self.law(kind, known, bare), n) for n in bare})
        held = [*held, *(f"friction.{name}" for name in known)]
        paths = looked_for(start, whole=typed, free=free, held=held)
        if isinstance(law, type):
            for name in required_of(law):
                if f"friction.{name}" not in paths and not {name, f"friction.{name}"} & {*held}:
                    raise InputError(
                        f"{law.__name__}.{name} ({fields_of(law)[name].symbol}) is neither varied"
                        " nor fixed: add it to vary, or give its value,"
                        f" fixed={{{name!r}: ...}}."
                    )
            start = _with_defaults(start, paths, known)
        return start, self.free_parameters(start, paths, constant)

    def free_parameters(
        self, law: FrictionLaw, paths: Collection[str], constant: str | None
    ) -> FreeParameters:
        """Return the parameters at some paths, and a constant force, to be looked for."""
        known = _values(law)
        items = [
            self._unknown(law, path, quantity, value, known)
            for path, (quantity, value) in known.items()
            if path in paths
        ]
        if constant is not None:
            most = WIDE * self.force
            items.append(
                FreeParameter(
                    path=constant,
                    quantity=Quantity("o", "N", or_unit="N m"),
                    start=self.offset,
                    low=-most,
                    high=most,
                )
            )
        return FreeParameters(tuple(items), {path: value for path, (_, value) in known.items()})

    def _unknown(
        self,
        law: FrictionLaw,
        path: str,
        quantity: Quantity,
        value: float,
        known: Mapping[str, tuple[Quantity, float]],
    ) -> FreeParameter:
        ranged = quantity if quantity.scale else with_ranges(law, path.rpartition(".")[2])
        assert ranged.bounds is not None
        (least, most), reach = ranged.bounds, ranged.scaled_by(self.sizes.reach)
        limit = quantity.low if quantity.above is None else quantity.above
        base = f"{path.rpartition('.')[0]}.{quantity.at_least}" if quantity.at_least else ""
        above = base if base in known else ""
        log = ranged.structural or (ranged.above is not None and least > 0.0)
        # a change with an input: its bounds are numbers over the unit, whatever the input's size
        signed = ranged.scale == "none" and least < 0.0
        if quantity.structural:
            low, high = least / FARTHER, most * FARTHER
        elif ranged.scale == "none":
            wide = FARTHER * abs(value) if signed else 0.0
            low, high = min(least, value - wide), max(most, value + wide)
        elif log:
            size = value if is_level(quantity) else min(reach, value)
            low = least * size * (1.0 / WIDE if is_level(quantity) else 1.0)
            high = FARTHER * most * max(reach, value)
        else:
            size = max(reach, abs(value))
            low = limit + (0.0 if quantity.above is None else 1e-9 * reach)
            low, high = max(low, -WIDE * size), max(most * reach, WIDE * size)
        if above:
            return FreeParameter(
                path=path, quantity=quantity, start=value, low=0.0, high=high, above=above
            )
        return FreeParameter(
            path=path,
            quantity=quantity,
            start=value,
            low=max(low, quantity.low),
            high=min(high, quantity.high),
            log=log,
        )


def _with_defaults(
    law: FrictionLaw, fitted: Collection[str], known: Mapping[str, float]
) -> FrictionLaw:
    """Return a law in which what is not fitted has its known value or its default, if any."""
    names = {path.rpartition(".")[2] for path in fitted}
    plain = {
        field.name: field.default
        for field in fields(law)
        if field.name in fields_of(type(law)) and field.name not in names
        if field.default is not MISSING
    }
    return replace(law, **{**plain, **{n: v for n, v in known.items() if n not in names}})


def looked_for(
    law: FrictionLaw, *, whole: bool, free: Collection[str] | None = None, held: Collection[str]
) -> list[str]:
    """Return the paths of the parameters of a law that a fit looks for.

    Those of its `fit_order` and of laws within it, as far as they are given. A whole exponent is
    among them only if `whole` is true, or if it is named.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=0.5, bristle_stiffness=1e3)
    >>> looked_for(law, whole=False, held=["bristle_stiffness"])
    ['friction.kinetic_coefficient', 'friction.viscous_coefficient']
    >>> looked_for(law, whole=False, free=["yield_exponent"], held=[])
    ['friction.yield_exponent']
    """
    own = {f"friction.{name}" for name in _wanted(type(law))}
    standing = {path for path, _, _ in parameters(law, "friction")}
    within = {path for path in standing if path.count(".") > 1}
    known = {path: quantity for path, (quantity, _) in _values(law).items()}
    named = {full_path(name, known) for name in free or () if name != LAW}
    usual = free is None or LAW in free
    found = [
        path
        for path in known
        if path in named
        or (usual and (path in within or (path in own and (whole or path in standing))))
    ]
    names = {**known, **dict.fromkeys(("mechanism.offset", "measurement.offset.friction"))}
    out = {full_path(name, names) for name in held if name != "offset"}
    return [path for path in found if path not in out]


def _wanted(kind: type[FrictionLaw]) -> set[str]:
    """Return the names of the parameters that a fit of a law pays for, and those it needs."""
    needed = {
        declared.name
        for declared in fields(kind)
        if declared.name in fields_of(kind) and declared.default is declared.default_factory
    }
    return {*kind.fit_order, *needed}


def _values(law: FrictionLaw) -> dict[str, tuple[Quantity, float]]:
    """Return quantity and value of all parameters by path, whole exponents too."""
    found = {
        f"friction.{name}": (quantity, float(getattr(law, name)))
        for name, quantity in fields_of(type(law)).items()
        if getattr(law, name) is not None
    }
    found.update((path, (quantity, value)) for path, quantity, value in parameters(law, "friction"))
    return found


def _plain(rough: StartEstimate) -> dict[str, Any]:
    return {declared.name: getattr(rough, declared.name) for declared in fields(rough)}


def _middle(v: Array, f: Array, fast: float) -> float:
    """Return the middle between the forces of fast slip in the two directions."""
    ahead, back = f[v > fast], f[v < -fast]
    if not len(ahead) or not len(back):
        return float(np.median(f))
    return 0.5 * float(np.median(ahead) + np.median(back))


def _line(speed: Array, load: Array, force: Array, fast: float) -> tuple[float, float]:
    """Return the level of fast slip, and the viscous part by Huber's robust regression."""
    from scipy.optimize import nnls

    table = np.column_stack([load, speed])
    weight = np.ones(len(force))
    found = np.zeros(2)
    for _ in range(10):
        found = nnls(table * weight[:, None], force * weight)[0]
        residual = np.abs(force - table @ found)
        spread = 1.4826 * float(np.median(residual))
        if spread <= 1e-12 * float(np.max(force, initial=1e-300)):
            break
        # root of the weights min(1, c s / |r|)
        weight = np.sqrt(np.minimum(1.0, HUBER * spread / np.maximum(residual, 1e-300)))
    fast_rows = speed >= fast
    level = float(np.median((force / load)[fast_rows if fast_rows.any() else slice(None)]))
    # where speeds hardly differ a level passes for a viscous part, and the other way round
    most = MOST * level * float(np.median(load)) / float(np.max(speed, initial=1e-300))
    viscous = min(float(found[1]), most)
    return max(level, 1e-12), viscous


def _stiffness(stretches: Sequence[MotionSegment], force: float) -> float:
    """Return the slope of friction after reversals over the load [1/m].

    From the way over which friction first changes by its own size after the motion has turned.
    """
    ways, load = [], 1.0
    for one in stretches:
        if not one.timed:
            continue
        load = float(np.median(one.path.load))
        x = np.concatenate([[0.0], np.cumsum(one.path.travel)])
        stroke = float(np.ptp(x))
        for start in _turns(x, 0.01 * stroke):
            change = np.abs(one.friction[start:] - one.friction[start])
            reached = np.flatnonzero(change > force)
            if len(reached):
                ways.append(abs(x[start + reached[0]] - x[start]))
    way = float(np.median(ways)) if ways else 0.0
    if way <= 0.0:
        travelled = [float(np.ptp(np.cumsum(one.path.travel))) for one in stretches if one.timed]
        way = 0.01 * max(travelled, default=1.0) or 1.0
    return force / load / way


def _turns(x: Array, least: float) -> list[int]:
    """Return where a motion turns by more than a least way."""
    found, extreme, direction = [], 0, 0
    for i in range(1, len(x)):
        way = x[i] - x[extreme]
        if direction == 0:
            direction = int(np.sign(way)) if abs(way) > least else 0
            extreme = i if direction else extreme
        elif way * direction > 0.0:
            extreme = i
        elif abs(way) > least:
            found.append(extreme)
            extreme, direction = i, -direction
    return found
