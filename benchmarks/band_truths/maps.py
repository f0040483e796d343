"""Friction measured in time, with loads, temperatures and bristles, and channels that are late.

The motion has closed forms; a bristle is that of Dahl, exact between samples. The force that is
measured may be late, lag, drift, or be wrong in ten samples.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from benchmarks.band_truths.rig import (
    FALL,
    KINETIC,
    STATIC,
    VISCOUS,
    Array,
    Curve,
    Points,
    Random,
    Rig,
    asked_over,
    factor,
)
from stickslip import Measurement

LOAD, WARM = 20.0, 25.0


@dataclass(frozen=True, kw_only=True)
class Map:
    """What a map is of."""

    terms: str
    """Terms of the truth; empty if the vocabulary has it not."""
    loads: float = 0.0
    """Exponent of the load; 0 if the load does not change."""
    warm: float = 0.0
    """Change of the level for each degree."""
    fall: str = ""
    """Form of the surplus that fades: exponential, lorentz."""
    film: bool = False
    bristle: float = 0.0
    """Length of the bristle over the amplitude."""
    fault: str = ""


TRUTHS: Mapping[str, Map] = {
    "coulomb-viscous": Map(terms="level viscous"),
    "stribeck": Map(terms="level stribeck viscous", fall="exponential"),
    "loads": Map(terms="level viscous", loads=1.0),
    "load exponent": Map(terms="level viscous", loads=0.67),
    "temperature": Map(terms="level viscous level*temperature", warm=-0.015),
    "dahl": Map(terms="level memory viscous", bristle=0.02),
    "dahl, loads": Map(terms="level memory viscous", bristle=0.01, loads=1.0),
}
OUTSIDE: Mapping[str, Map] = {
    "lorentz": Map(terms="", fall="lorentz"),
    "mixed film": Map(terms="", film=True),
    "delay": Map(terms="level viscous", fault="delay"),
    "lag": Map(terms="level viscous", fault="lag"),
    "drift": Map(terms="level viscous", fault="drift"),
    "outliers": Map(terms="level viscous", fault="outliers"),
    "noise grows": Map(terms="level viscous", fault="noise"),
    "frictional memory": Map(terms="", fall="exponential", fault="memory"),
}
ALLOWED = {
    "delay": {"delay", "lag", "memory"},
    "lag": {"lag", "delay", "memory"},
    "drift": {"drift", "run", "order"},
    "outliers": {"outlier", "outliers"},
    "noise": {"noise"},
    "memory": {"delay", "lag", "memory"},
}


def drawn(number: int, seed: int) -> Rig:
    """Return a map: inside and outside in turn, kinds of truths in turn."""
    random = np.random.default_rng([63, seed, number])
    half, inside = number // 2, number % 2 == 0
    among = TRUTHS if inside else OUTSIDE
    name = [*among][half % len(among)]
    one = among[name]
    level, top = factor(0.5, 200.0, random), factor(0.02, 1.0, random)
    surplus, fall = random.uniform(0.3, 0.8), top * factor(0.05, 0.2, random)
    rise = random.uniform(0.2, 1.0)
    noise = factor(0.005, 0.04, random)
    rate, duration = factor(50.0, 1000.0, random), random.uniform(10.0, 30.0)

    def steady(p: Points) -> Array:
        u = np.abs(p.velocity)
        dry = np.ones(len(u))
        if one.fall == "exponential":
            dry += surplus * np.exp(-((u / fall) ** 2))
        elif one.fall == "lorentz":
            dry += surplus / (1.0 + (u / fall) ** 2)
        elif one.film:
            dry = 1.0 / (1.0 + (u / fall) ** 2)
        if one.warm and p.inputs:
            dry = dry * (1.0 + one.warm * (p.inputs["temperature"] - WARM))
        wet = (u / top) ** 0.6 if one.film else rise * u / top
        loads = 1.0
        if one.loads and p.load is not None:
            loads = (p.load / LOAD) ** one.loads
        return np.sign(p.velocity) * level * (dry * loads + wet)

    def record(source: Random) -> Measurement:
        t = np.arange(0.0, duration, 1.0 / rate)
        rates = 2.0 * np.pi * source.uniform(0.1, 0.8, 3)
        phases = source.uniform(0.0, 2.0 * np.pi, 3)
        waves = rates[:, None] * t + phases[:, None]
        v = np.sum(np.cos(waves), axis=0)
        amplitude = top / float(np.max(np.abs(v)))
        x = amplitude * np.sum(np.sin(waves) / rates[:, None], axis=0)
        v = amplitude * v
        load = inputs = None
        if one.loads:
            load = LOAD * np.exp(0.9 * np.sin(2.0 * np.pi * source.uniform(0.05, 0.3) * t))
        if one.warm:
            inputs = {"temperature": WARM + 15.0 * (0.5 - np.exp(-2.0 * t / duration))}
        p = Points(velocity=v, load=load, inputs=inputs or {})
        f = steady(p)
        f = _remembered(one, steady, p, t, x, level * rise / top)
        f = _faulty(one.fault, f, t, level, rate, source)
        size = noise * float(np.mean(np.abs(f)))
        spread = size * (0.3 + 2.0 * np.abs(v) / top) if one.fault == "noise" else size
        f = f + spread * source.normal(size=len(t))
        loads = {} if load is None else {"load": load}
        return Measurement(time=t, position=x, velocity=v, friction=f, inputs=inputs or {}, **loads)

    asked, beyond = asked_over(0.02 * top, 0.95 * top, both=True)
    asked, beyond = (_with(random, one, p) for p in (asked, beyond))
    known = not one.loads and not one.warm and one.terms
    parameters = {KINETIC: level, VISCOUS: level * rise / top} if known else {}
    if known and one.fall:
        parameters |= {STATIC: level * (1.0 + surplus), FALL: fall}
    scale = noise * float(np.mean(np.abs(steady(asked))))
    first = record(random)

    def more(places: Points, number: int) -> Rig:
        """Return the record with others like it, one for each place."""
        then = np.random.default_rng([63, seed, number])
        trials = (first, *(record(then) for _ in range(len(places))))
        return result.with_(measurement=Measurement(trials=trials), second=None, more=None)

    result = Rig(
        kind="maps", truth=name, inside=inside, measurement=first,
        family=frozenset(one.terms.split()) if one.terms else None,
        faults=frozenset(ALLOWED.get(one.fault, ())), curves=(steady,),
        noise=lambda p: np.full(len(p), scale), asked=asked, beyond=beyond,
        parameters=parameters, second=record(random), more=more,
    )  # fmt: skip
    return result


def _with(random: Random, one: Map, p: Points) -> Points:
    """Return points with loads and temperatures of the record."""
    load = LOAD * np.exp(random.uniform(-0.8, 0.8, len(p))) if one.loads else None
    inputs = {"temperature": WARM + random.uniform(-6.0, 5.0, len(p))} if one.warm else {}
    return Points(velocity=p.velocity, load=load, inputs=inputs)


def _remembered(one: Map, steady: Curve, p: Points, t: Array, x: Array, viscous: float) -> Array:
    """Return friction (n,) along a motion: steady, late behind the speed, or of bristles."""
    f, v = steady(p), p.velocity
    if one.fault == "memory":
        return np.sign(v) * np.abs(steady(Points(velocity=np.interp(t - 0.03, t, v))))
    if one.bristle:
        wet = viscous * v
        return np.abs(f - wet) * _bristles(np.diff(x), one.bristle * float(np.ptp(x))) + wet
    return f


def _bristles(ways: Array, length: float) -> Array:
    """Return deflections (n,) of a bristle, -1 to 1: exact for steps of the way."""
    z, result = 0.0, [0.0]
    for way in ways.tolist():
        side = 1.0 if way > 0.0 else -1.0
        z = side * (1.0 - (1.0 - side * z) * float(np.exp(-abs(way) / length)))
        result.append(z)
    return np.array(result)


def _faulty(fault: str, f: Array, t: Array, level: float, rate: float, random: Random) -> Array:
    """Return the force (n,) as a faulty channel shows it."""
    if fault == "delay":
        return np.interp(t - random.uniform(0.01, 0.05), t, f)
    if fault == "lag":
        keep = float(np.exp(-1.0 / (rate * random.uniform(0.008, 0.03))))
        return np.asarray(lfilter([1.0 - keep], [1.0, -keep], f))
    if fault == "drift":
        return f + level * random.uniform(0.2, 0.6) * (t / t[-1] - 0.5)
    if fault == "outliers":
        f = f.copy()
        f[random.integers(len(f), size=10)] += 5.0 * level * random.choice([-1.0, 1.0], 10)
    return f
