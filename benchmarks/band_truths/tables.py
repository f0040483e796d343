"""Tables of friction with a known truth, inside what laws can say and outside.

A truth is a curve with parameters; a table has one or two directions, loads, temperatures, two
days, repeats, and one thing that is wrong with it. The fit of the true structure is by `scipy`.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.optimize import least_squares

from benchmarks.band_truths.rig import (
    DRAG,
    EXPONENT,
    FALL,
    KINETIC,
    STATIC,
    VISCOUS,
    Array,
    Curve,
    Points,
    Random,
    Rig,
    factor,
)
from stickslip import Measurement

Model: TypeAlias = Callable[[Array, Points], Array]
"""Friction [N] of parameters (p,) at points (n,)."""
LOAD = 20.0
"""Geometric mean of loads [N]."""
WARM = 25.0
"""Temperature [degC] about which friction changes."""


@dataclass(frozen=True, kw_only=True)
class Truth:
    """A curve, its parameters, and what names them."""

    model: Model
    values: Array
    names: tuple[str, ...] = ()
    """Parameters that laws have too, in the order of the values; empty: no such one."""
    family: frozenset[str] | None = None


def _sign(p: Points) -> Array:
    return np.where(p.velocity < 0.0, -1.0, 1.0)


def _plain(shape: Callable[[Array, Array], Array]) -> Model:
    """Return friction with the sign of the velocity, whatever the load."""
    return lambda c, p: _sign(p) * shape(c, np.abs(p.velocity))


def _coulomb(random: Random, level: float, top: float) -> Truth:
    model = _plain(lambda c, u: c[0] + 0.0 * u)
    return Truth(model=model, values=np.array([level]), names=(KINETIC,),
                 family=frozenset({"level"}))  # fmt: skip


def _viscous(random: Random, level: float, top: float) -> Truth:
    slope = level / top * factor(0.3, 2.0, random)
    return Truth(model=_plain(lambda c, u: c[0] + c[1] * u), values=np.array([level, slope]),
                 names=(KINETIC, VISCOUS), family=frozenset({"level", "viscous"}))  # fmt: skip


def _viscous_alone(random: Random, level: float, top: float) -> Truth:
    return Truth(model=_plain(lambda c, u: c[0] * u), values=np.array([level / top]),
                 names=(VISCOUS,), family=frozenset({"viscous"}))  # fmt: skip


def _stribeck(power: float) -> Callable[[Random, float, float], Truth]:
    def made(random: Random, level: float, top: float) -> Truth:
        values = np.array([
            level, level * random.uniform(1.3, 2.0), top * factor(0.06, 0.3, random),
            level / top * random.uniform(0.2, 1.0),
        ])  # fmt: skip
        model = _plain(
            lambda c, u: c[0] + (c[1] - c[0]) * np.exp(-((u / abs(c[2])) ** power)) + c[3] * u
        )
        return Truth(model=model, values=values, names=(KINETIC, STATIC, FALL, VISCOUS),
                     family=frozenset({"level", "stribeck", "viscous"}))  # fmt: skip

    return made


def _power(random: Random, level: float, top: float) -> Truth:
    n, share = random.uniform(0.35, 0.65), random.choice([0.0, 0.5, 1.0])
    rise = level / top**n * random.uniform(1.0, 2.5)
    if not share:
        return Truth(model=_plain(lambda c, u: c[0] * u ** c[1]), values=np.array([rise, n]),
                     names=(VISCOUS, EXPONENT), family=frozenset({"power"}))  # fmt: skip
    return Truth(model=_plain(lambda c, u: c[0] + c[1] * u ** c[2]),
                 values=np.array([share * level, rise, n]),
                 names=(KINETIC, VISCOUS, EXPONENT),
                 family=frozenset({"level", "power"}))  # fmt: skip


def _drag(random: Random, level: float, top: float) -> Truth:
    values = np.array([level, level / top**2 * random.uniform(0.5, 2.0)])
    return Truth(model=_plain(lambda c, u: c[0] + c[1] * u**2), values=values,
                 names=(KINETIC, DRAG),
                 family=frozenset({"level", "drag"}))  # fmt: skip


def _saturating(random: Random, level: float, top: float) -> Truth:
    speed = top * factor(0.1, 0.5, random)
    values = np.array([level, level / speed * random.uniform(1.0, 2.0), speed])
    model = _plain(lambda c, u: c[0] + c[1] * abs(c[2]) * np.arctan(u / abs(c[2])))
    return Truth(model=model, values=values, names=(KINETIC, VISCOUS),
                 family=frozenset({"level", "saturating"}))  # fmt: skip


def _tanh(random: Random, level: float, top: float) -> Truth:
    values = np.array([level, top * factor(0.05, 0.2, random), level / top * 0.5])
    return Truth(model=_plain(lambda c, u: c[0] * np.tanh(u / abs(c[1])) + c[2] * u),
                 values=values, family=frozenset({"tanh", "viscous"}))  # fmt: skip


def _two_sided(random: Random, level: float, top: float) -> Truth:
    values = np.array([level, level * random.uniform(1.15, 1.5),
                       *(level / top * random.uniform(0.3, 1.2, 2))])  # fmt: skip

    def model(c: Array, p: Points) -> Array:
        u = np.abs(p.velocity)
        return np.where(p.velocity > 0.0, c[0] + c[2] * u, -c[1] - c[3] * u)

    return Truth(model=model, values=values,
                 family=frozenset({"level", "viscous", "offset", "viscous_direction"}))  # fmt: skip


def _two_falls(random: Random, level: float, top: float) -> Truth:
    one = _stribeck(2.0)(random, level, top)
    values = np.array([*one.values, level * random.uniform(0.05, 0.2),
                       level * random.uniform(0.2, 0.4)])  # fmt: skip

    def model(c: Array, p: Points) -> Array:
        u = np.abs(p.velocity)
        fall = np.exp(-((u / abs(c[2])) ** 2))
        return one.model(c[:4], p) + c[4] + c[5] * fall

    family = {"level", "viscous", "stribeck_sides", "offset"}
    return Truth(model=model, values=values, family=frozenset(family))


def _offset(random: Random, level: float, top: float) -> Truth:
    one = _viscous(random, level, top)
    values = np.array([*one.values, level * random.uniform(0.08, 0.3)])
    family = frozenset({"level", "viscous", "offset"})
    return Truth(model=lambda c, p: one.model(c[:2], p) + c[2], values=values,
                 names=(KINETIC, VISCOUS), family=family)  # fmt: skip


def _loaded(
    one: Callable[[Random, float, float], Truth], exponent: float | None
) -> Callable[[Random, float, float], Truth]:
    """Return a truth under loads: a level that grows with them, or all by a power."""

    def made(random: Random, level: float, top: float) -> Truth:
        base = one(random, level, top)
        if exponent is None:
            # viscous friction of the whole does not ask for the load
            def model(c: Array, p: Points) -> Array:
                own = c.copy()
                own[-1] = 0.0
                dry = base.model(own, p)
                return dry * (p.load / LOAD) + (base.model(c, p) - dry)

            named = base.names
            if named == (KINETIC, VISCOUS):
                values, names = base.values, base.names
            else:
                values, names = base.values, ()
            per_load = {KINETIC: LOAD}
            return Truth(
                model=model, values=values,
                names=tuple(f"{n}/{per_load[n]:g}" if n in per_load else n for n in names),
                family=base.family,
            )  # fmt: skip
        values = np.array([*base.values, exponent])
        return Truth(model=lambda c, p: base.model(c[:-1], p) * (p.load / LOAD) ** c[-1],
                     values=values, family=base.family)  # fmt: skip

    return made


def _warming(part: str) -> Callable[[Random, float, float], Truth]:
    def made(random: Random, level: float, top: float) -> Truth:
        one = _viscous(random, level, top)
        change = float(random.choice([-1.0, 1.0]) * random.uniform(0.008, 0.02))
        values = np.array([*one.values, change * one.values[0 if part == "level" else 1]])

        def model(c: Array, p: Points) -> Array:
            of = p.inputs["temperature"] - WARM
            times = 1.0 if part == "level" else np.abs(p.velocity)
            return one.model(c[:2], p) + _sign(p) * c[2] * of * times

        return Truth(model=model, values=values,
                     family=frozenset({"level", "viscous", f"{part}*temperature"}))  # fmt: skip

    return made


def _outside(curve: Callable[[Random, float, float], Callable[[Array], Array]]):  # type: ignore[no-untyped-def]
    def made(random: Random, level: float, top: float) -> Truth:
        shape = curve(random, level, top)
        return Truth(model=_plain(lambda c, u: c[0] * shape(u)), values=np.array([1.0]))

    return made


def _bowl(random: Random, level: float, top: float) -> Callable[[Array], Array]:
    s, depth = top * factor(0.1, 0.5, random), random.uniform(0.05, 0.25)
    return lambda u: level * (0.5 + depth * np.log(u / s) ** 2)


def _kink(random: Random, level: float, top: float) -> Callable[[Array], Array]:
    s, fall, rise = (
        top * factor(0.1, 0.5, random),
        random.uniform(0.1, 0.25),
        random.uniform(0.3, 1.5),
    )
    return lambda u: (
        level * (0.5 + fall * np.maximum(-np.log(u / s), 0.0) + rise * np.maximum(u - s, 0.0) / top)
    )


def _lorentz(random: Random, level: float, top: float) -> Callable[[Array], Array]:
    s, more, slope = (
        top * factor(0.05, 0.3, random),
        random.uniform(0.3, 1.0),
        random.uniform(0.1, 0.6),
    )
    return lambda u: level * (1.0 + more / (1.0 + (u / s) ** 2) + slope * u / top)


def _eyring(random: Random, level: float, top: float) -> Callable[[Array], Array]:
    s = top * factor(0.01, 0.3, random)
    return lambda u: level * np.arcsinh(u / s) / math.asinh(top / s)


def _rational(random: Random, level: float, top: float) -> Callable[[Array], Array]:
    s = top * factor(0.1, 0.5, random)
    rise = random.uniform(1.0, 2.0)
    return lambda u: level * (1.0 + rise * (u / s) / (1.0 + u / s))


def _mixed(random: Random, level: float, top: float) -> Callable[[Array], Array]:
    s, steep = top * factor(0.05, 0.4, random), random.uniform(1.0, 4.0)
    n, film = random.uniform(0.4, 1.0), random.uniform(0.4, 1.2)

    def curve(u: Array) -> Array:
        dry = 1.0 / (1.0 + (u / s) ** steep)
        return level * (dry + film * (u / top) ** n * (1.0 - dry))

    return curve


def _two_steps(random: Random, level: float, top: float) -> Callable[[Array], Array]:
    first, second = top * factor(0.03, 0.08, random), top * factor(0.3, 0.6, random)
    a, b, slope = random.uniform(0.2, 0.6), random.uniform(0.2, 0.6), random.uniform(0.1, 0.5)
    return lambda u: (
        level
        * (
            1.0
            + a * np.exp(-((u / first) ** 2))
            + b * np.exp(-((u / second) ** 2))
            + slope * u / top
        )
    )


def _jump(random: Random, level: float, top: float) -> Callable[[Array], Array]:
    s, step = (
        top * factor(0.15, 0.6, random),
        random.choice([-1.0, 1.0]) * random.uniform(0.1, 0.3),
    )
    slope = random.uniform(0.0, 0.5)
    return lambda u: level * (1.0 + step * (u > s) + slope * u / top)


def _hersey(random: Random, level: float, top: float) -> Truth:
    """Coefficient of friction over speed / load (Hersey number): Stribeck in one variable."""
    s, more, slope = (
        top * factor(0.1, 0.3, random),
        random.uniform(0.5, 1.5),
        random.uniform(0.2, 0.8),
    )

    def model(c: Array, p: Points) -> Array:
        u = np.abs(p.velocity) * LOAD / p.load
        return c[0] * _sign(p) * p.load / LOAD * level * (
            0.4 + more * np.exp(-((u / s) ** 2)) + slope * u / top
        )  # fmt: skip

    family = frozenset({"hersey", "level", "viscous"})
    return Truth(model=model, values=np.array([1.0]), family=family)


UNKNOWN = {"frictionless", "runs", "sign", "clipped", "drift", "running-in"}
"""Tables whose parameters have no one true value."""
Maker: TypeAlias = Callable[[Random, float, float], Truth]
INSIDE: Mapping[str, tuple[Maker, str]] = {
    "coulomb": (_coulomb, ""),
    "coulomb-viscous": (_viscous, ""),
    "stribeck": (_stribeck(2.0), ""),
    "stribeck, exponent 1": (_stribeck(1.0), ""),
    "power": (_power, ""),
    "drag": (_drag, ""),
    "saturating": (_saturating, ""),
    "tanh": (_tanh, ""),
    "directions": (_two_sided, "both"),
    "directional stribeck": (_two_falls, "both"),
    "loads": (_loaded(_viscous, None), "loads"),
    "load exponent": (_loaded(_viscous, 0.8), "loads"),
    "loads, stribeck": (_loaded(_stribeck(2.0), None), "loads"),
    "level by temperature": (_warming("level"), "temperature"),
    "viscous by temperature": (_warming("viscous"), "temperature"),
    "two days": (_viscous, "runs"),
    "two days, stribeck": (_stribeck(2.0), "runs"),
    "repeats": (_stribeck(2.0), "repeats"),
    "viscous": (_viscous_alone, ""),
    "offset": (_offset, "both"),
    "four decades": (_stribeck(2.0), "decades"),
    "five speeds": (_stribeck(2.0), "few"),
    "frictionless": (_coulomb, "frictionless"),
    "one decade": (_power, "narrow"),
}
OUTSIDE: Mapping[str, tuple[Maker, str]] = {
    "bowl": (_outside(_bowl), ""),
    "kink": (_outside(_kink), ""),
    "lorentz": (_outside(_lorentz), ""),
    "eyring": (_outside(_eyring), ""),
    "mixed film": (_outside(_mixed), ""),
    "rational": (_outside(_rational), ""),
    "hersey": (_hersey, "loads"),
    "running-in": (_viscous, "running-in"),
    "drift": (_viscous, "drift"),
    "outlier": (_viscous, "outlier"),
    "outlier, stribeck": (_stribeck(2.0), "outlier"),
    "noise grows": (_stribeck(2.0), "growing"),
    "clipped": (_viscous, "clipped"),
    "load exponent off the grid": (_loaded(_stribeck(2.0), 0.58), "loads"),
    "jump": (_outside(_jump), ""),
    "two falls": (_outside(_two_steps), ""),
    "at rest": (_viscous, "rest"),
    "sign": (_viscous, "sign"),
}
ALLOWED = {
    "running-in": {"drift", "running-in", "order"},
    "drift": {"drift", "running-in", "order"},
    "outlier": {"outlier"},
    "growing": {"noise"},
    "clipped": {"clipping", "saturation", "outlier"},
    "rest": {"rest"},
    "sign": {"sign"},
    "runs": {"run", "drift", "order"},
}
"""Faults that may be named, by what is wrong with the table."""


def drawn(number: int, seed: int) -> Rig:
    """Return a table: inside and outside in turn, kinds of truths in turn."""
    random = np.random.default_rng([59, seed, number])
    half, inside = number // 2, number % 2 == 0
    among = INSIDE if inside else OUTSIDE
    name = [*among][half % len(among)]
    make, how = among[name]
    level, top = factor(0.5, 200.0, random), factor(0.02, 2.0, random)
    truth = make(random, level, top)
    noise = factor(0.005, 0.04, random)
    return _table(random, name, truth, how, top, noise, inside=inside)


def _places(random: Random, how: str, top: float) -> Points:
    """Return where readings are taken, in the order of the speeds."""
    decades = {"decades": 4.0, "narrow": 1.0}.get(how, float(random.uniform(1.1, 2.3)))
    count = 5 if how == "few" else int(random.integers(8, 23))
    own = count // 2 if how in {"both", "repeats", "runs"} else count
    own = max(own, 5)
    if how in {"loads", "temperature"}:
        own = max(count // 3, 5)
    if random.random() < 0.7 or how == "decades":
        u = np.geomspace(10.0**-decades, 1.0, own) * np.exp(random.normal(0.0, 0.05, own))
    else:
        u = np.linspace(1.0 / own, 1.0, own)
    u = np.sort(u) * top
    if how in {"both", "rest"}:
        return Points(velocity=np.concatenate([-u[::-1], u]))
    if how == "repeats":
        return Points(velocity=np.repeat(u, int(random.integers(2, 4))))
    if how == "loads":
        loads = LOAD * np.geomspace(0.3, 1.0 / 0.3, int(random.integers(3, 5)))
        return Points(velocity=np.tile(u, len(loads)), load=np.repeat(loads, len(u)))
    if how == "temperature":
        warm = WARM + np.linspace(-12.0, 12.0, 3)
        return Points(velocity=np.tile(u, 3), inputs={"temperature": np.repeat(warm, len(u))})
    if how == "runs":
        return Points(velocity=np.tile(u, 2))
    return Points(velocity=u)


def _asked(random: Random, how: str, p: Points) -> tuple[Points, Points]:
    """Return points within the range of what was measured, and beyond it."""
    result = []
    for far in (False, True):
        parts = []
        for side in (-1.0, 1.0):
            u = np.abs(p.velocity[p.velocity * side > 0.0])
            if not len(u):
                continue
            low, high = float(u.min()), float(u.max())
            if how == "rest":
                low = float(np.sort(u)[2])
            inside = np.geomspace(low, high, 40)
            over = np.concatenate([np.geomspace(low / 3.0, low, 8)[:-1],
                                   np.geomspace(high, 2.0 * high, 5)[1:]])  # fmt: skip
            parts.append(side * (over if far else inside))
        v = np.concatenate(parts)
        load, inputs = None, {}
        if p.load is not None:
            ends = float(p.load.min()), float(p.load.max())
            load = np.exp(random.uniform(math.log(ends[0]), math.log(ends[1]), len(v)))
        if p.inputs:
            warm = p.inputs["temperature"]
            inputs = {"temperature": random.uniform(warm.min(), warm.max(), len(v))}
        result.append(Points(velocity=v, load=load, inputs=inputs))
    return result[0], result[1]


def _table(
    random: Random, name: str, truth: Truth, how: str, top: float, noise: float, *, inside: bool
) -> Rig:
    p = _places(random, how, top)
    asked, beyond = _asked(random, how, p)

    def steady(q: Points) -> Array:
        return 0.0 * q.velocity if how == "frictionless" else truth.model(truth.values, q)

    size = float(np.mean(np.abs(truth.model(truth.values, p))))
    relative = bool(random.random() < 0.3) and how != "frictionless"
    growth = float(random.uniform(0.6, 1.2))

    def deviation(q: Points) -> Array:
        if how == "growing":
            return noise * size * (0.3 + (np.abs(q.velocity) / top) ** growth * 3.0)
        return noise * (np.abs(steady(q)) if relative else np.full(len(q), size))

    order = random.permutation(len(p))
    if random.random() < 0.5 and how not in {"drift", "running-in"}:
        order = np.arange(len(p))
    runs = (order >= len(p) // 2).astype(int) if how == "runs" else np.zeros(len(p), dtype=int)
    p = p[order]
    change = size * random.uniform(0.06, 0.25) * random.choice([-1.0, 1.0])
    curves, exact = _spoilt(how, steady, p, runs, change)
    friction = exact + deviation(p) * random.normal(size=len(p))
    wrong = np.zeros(len(p), dtype=bool)
    if how == "outlier":
        wrong[random.integers(len(p))] = True
        friction[wrong] *= random.choice([0.6, 1.4])
    if how == "clipped":  # the load cell shows no more
        limit = float(np.quantile(np.abs(friction), 0.8))
        friction = np.clip(friction, -limit, limit)
        asked, _ = _asked(random, how, p[np.abs(friction) < limit])
    if how == "rest":
        still = top * np.array([-1e-4, 2e-5, 3e-4])
        held = random.uniform(-0.9, 0.9, 3) * abs(float(truth.values[0]))
        p = Points(velocity=np.concatenate([p.velocity, still]))
        friction = np.concatenate([friction, held])
        runs, wrong = (np.concatenate([item, np.zeros(3, item.dtype)]) for item in (runs, wrong))
    family = truth.family
    if how == "runs":
        family = frozenset({*(family or ()), "run"})
    known = how not in {"drift", "running-in", "clipped", "rest", "sign", "frictionless"}
    if how == "frictionless":
        family = frozenset()
    names = truth.names if how not in UNKNOWN else ()
    parameters = dict(_parameters(names, truth.values))
    best = None
    if known and family:
        best = _fitted(truth, p[~wrong], friction[~wrong], deviation, runs[~wrong])
    rig = Rig(
        kind="tables", truth=name, inside=inside, measurement=_measured(p, friction, runs),
        family=family, faults=frozenset(ALLOWED.get(how, ())),
        curves=() if how == "sign" else curves, noise=deviation, asked=asked,
        beyond=None if how in {"rest", "frictionless", "clipped"} else beyond,
        parameters=parameters,
        fitted=best,
    )  # fmt: skip

    def more(q: Points, seed: int) -> Rig:
        draw = np.random.default_rng([60, seed])
        read = curves[0](q) + deviation(q) * draw.normal(size=len(q))
        whole = _measured(p.joined(q), np.concatenate([friction, read]),
                          np.concatenate([runs, np.zeros(len(q), dtype=int)]))  # fmt: skip
        return rig.with_(measurement=whole)

    return rig.with_(more=more)


def _spoilt(
    how: str, steady: Curve, p: Points, runs: Array, change: float
) -> tuple[tuple[Curve, ...], Array]:
    """Return the true curves, and readings without noise (n,) in the order of measuring."""
    exact, place = steady(p), np.linspace(0.0, 1.0, len(p))
    if how == "runs":
        other = change * _sign(p) * runs
        return (steady, lambda q: steady(q) + change * _sign(q)), exact + other
    if how in {"drift", "running-in"}:
        share = 1.2 * change / float(np.mean(np.abs(exact)))
        times = 1.0 + share * (place - 0.5)
        if how == "running-in":
            times = 1.0 + abs(share) * np.exp(-place / 0.25)
        # a reading is taken early, midway or late
        moments = times[0], times[len(times) // 2], times[-1]
        return tuple(lambda q, t=t: t * steady(q) for t in moments), exact * times  # type: ignore[misc]
    return (steady,), -exact if how == "sign" else exact


def _parameters(names: tuple[str, ...], values: Array) -> list[tuple[str, float]]:
    result = []
    for text, value in zip(names, values, strict=False):
        name, _, over = text.partition("/")
        result.append((name, float(value) / (float(over) if over else 1.0)))
    return result


def _measured(p: Points, friction: Array, runs: Array) -> Measurement:
    def part(rows: Array) -> Measurement:
        q = p[rows]
        load = {} if q.load is None else {"load": q.load}
        return Measurement(velocity=q.velocity, friction=friction[rows], inputs=q.inputs, **load)

    if runs.any():
        return Measurement(trials=tuple(part(runs == k) for k in range(int(runs.max()) + 1)))
    return part(np.arange(len(p)))


def _fitted(truth: Truth, p: Points, friction: Array, noise: Curve, runs: Array) -> Curve:
    """Return the true structure with the parameters that fit the readings best."""
    two = bool(runs.any())
    start = np.append(truth.values, 0.0) if two else truth.values
    size = np.where(start == 0.0, float(np.mean(np.abs(friction))), np.abs(start))
    sd = np.maximum(noise(p), 1e-12)

    def left(z: Array) -> Array:
        c = z * size
        own = truth.model(c[:-1], p) + c[-1] * runs * _sign(p) if two else truth.model(c, p)
        return np.asarray((own - friction) / sd)

    c = least_squares(left, start / size).x * size
    return lambda q: truth.model(c[:-1] if two else c, q)
