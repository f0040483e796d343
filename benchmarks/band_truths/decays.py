"""Free decays with a known truth: a pendulum that swings out, a flywheel or a slider that stops.

The motion between changes of the sign of the speed is by the classical Runge-Kutta method, and a
change of sign is found by bisection; at rest the body stays if dry friction can hold it.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from benchmarks.band_truths.rig import (
    DRAG,
    KINETIC,
    VISCOUS,
    Array,
    Curve,
    Points,
    Random,
    Rig,
    asked_over,
    factor,
)
from stickslip import Axis, Measurement
from stickslip.mechanisms import Pendulum

GRAVITY = 9.81
FINEST = 400
"""Steps of the integration to the shortest time in which a motion changes."""
PARTS = ("level", "viscous", "drag")
NAMES = {"level": KINETIC, "viscous": VISCOUS, "drag": DRAG}


@dataclass(frozen=True, kw_only=True)
class Body:
    """What turns or slides: acceleration = (pull(q) - friction(v)) / inertia."""

    inertia: float
    pull: Callable[[float], float]
    level: float
    friction: Callable[[float], float]
    """Friction at speeds above 0."""


def moved(body: Body, q: float, v: float, times: Array, step: float) -> tuple[Array, Array]:
    """Return positions and velocities (n,) at times."""

    def slope(q: float, v: float, side: float) -> float:
        return (body.pull(q) - side * body.friction(max(side * v, 0.0))) / body.inertia

    def stepped(q: float, v: float, h: float, side: float) -> tuple[float, float]:
        a1 = slope(q, v, side)
        v2 = v + 0.5 * h * a1
        a2 = slope(q + 0.5 * h * v, v2, side)
        v3 = v + 0.5 * h * a2
        a3 = slope(q + 0.5 * h * v2, v3, side)
        v4 = v + h * a3
        a4 = slope(q + h * v3, v4, side)
        return q + h * (v + 2 * v2 + 2 * v3 + v4) / 6, v + h * (a1 + 2 * a2 + 2 * a3 + a4) / 6

    result = [(q, v)]
    side = math.copysign(1.0, v) if v else math.copysign(1.0, body.pull(q))
    held = not v and abs(body.pull(q)) <= body.level
    for start, end in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
        left = end - start
        while left > 1e-15 and not held:
            h = min(step, left)
            new = stepped(q, v, h, side)
            if new[1] * side < 0.0:  # it turns within the step
                low, high = 0.0, h
                for _ in range(50):
                    middle = 0.5 * (low + high)
                    turned = stepped(q, v, middle, side)[1] * side < 0.0
                    low, high = (low, middle) if turned else (middle, high)
                q, h = stepped(q, v, high, side)[0], high
                v, side = 0.0, math.copysign(1.0, body.pull(q))
                held = abs(body.pull(q)) <= body.level
            else:
                q, v = new
            left -= h
        result.append((q, v))
    q_, v_ = np.array(result).T
    return q_, v_


TRUTHS: Mapping[str, tuple[frozenset[str] | None, str]] = {
    "level": (frozenset({"level"}), ""),
    "viscous": (frozenset({"viscous"}), ""),
    "level + viscous": (frozenset({"level", "viscous"}), ""),
    "drag": (frozenset({"drag"}), ""),
    "viscous + drag": (frozenset({"viscous", "drag"}), ""),
    "level + drag": (frozenset({"level", "drag"}), ""),
    "level + viscous + drag": (frozenset({"level", "viscous", "drag"}), ""),
}
OUTSIDE: Mapping[str, Callable[[float, float], Callable[[float], float]]] = {
    "eyring": lambda f, top: lambda v: f * math.asinh(v / (0.1 * top)) / math.asinh(10.0),
    "lorentz": lambda f, top: lambda v: f * (0.6 + 0.6 / (1.0 + (v / (0.15 * top)) ** 2)),
    "mixed film": lambda f, top: lambda v: f * (
        1.0 / (1.0 + (v / (0.1 * top)) ** 2) + 0.8 * (v / top) ** 0.6
    ),
    "falls": lambda f, top: lambda v: f * (1.2 - 0.4 * v / top),
}  # fmt: skip
"""Friction over speed of an amount and the largest speed."""


def drawn(number: int, seed: int, *, off: float = 0.0) -> Rig:
    """Return a decay: inside and outside in turn, kinds of truths in turn.

    Its friction waves about that of its law, over the logarithm of the speed, by a share `off`.
    """
    random = np.random.default_rng([62, seed, number])
    half, inside = number // 2, number % 2 == 0
    among = [*TRUTHS] if inside else [*OUTSIDE]
    name = among[half % len(among)]
    pendulum = bool(random.random() < 0.6)
    if pendulum:
        mass, length = factor(0.01, 2.0, random), factor(0.1, 1.0, random)
        inertia, weight = mass * length**2, mass * length * GRAVITY
        start = random.uniform(0.4, 1.2)
        top = 2.0 * math.sqrt(GRAVITY / length) * math.sin(start / 2.0)
        period = 2.0 * math.pi * math.sqrt(length / GRAVITY)
        # a share of the swing is lost in each period
        f = weight * start * factor(0.004, 0.03, random)
        rate = max(factor(15.0, 1000.0, random), 12.0 / period)
        duration = period * random.uniform(12.0, 30.0)
        at, mechanism = (start, 0.0), Pendulum(mass=mass, length=length, gravity=GRAVITY)
    else:
        inertia, top = factor(1e-3, 10.0, random), factor(0.1, 50.0, random)
        duration = factor(3.0, 60.0, random)
        weight, f = 0.0, inertia * top / duration * random.uniform(0.8, 1.3)
        rate = min(max(factor(1.0, 1000.0, random), 60.0 / duration), 20_000.0 / duration)
        at, mechanism = (0.0, top), Axis(inertia=inertia)  # type: ignore[assignment]
    rate = min(rate, 20_000.0 / duration)
    friction, parameters = _friction(random, name, f, top)
    if off:
        friction = _waving(friction, off, top)
    body = Body(
        inertia=inertia, pull=lambda q: -weight * math.sin(q),
        level=friction(0.0), friction=friction,
    )  # fmt: skip
    step = min((period / FINEST) if pendulum else duration / (4 * FINEST), 1.0 / rate)
    quantity = "position" if pendulum or random.random() < 0.5 else "velocity"
    noise = factor(5e-4, 6e-3, random)
    times = np.arange(0.0, duration, 1.0 / rate)

    def motion_of(share: float) -> Array:
        q, v = moved(body, share * at[0], share * at[1], times, step)
        return q if quantity == "position" else v

    # the sensor of a second record is the same: its noise does not shrink with the motion
    size = noise * float(np.ptp(motion_of(1.0))) / (2.0 if pendulum else 1.0)

    def again(share: float, random: Random) -> Measurement:
        y = motion_of(share) + size * random.normal(size=len(times))
        return Measurement(time=times, turning=True, **{quantity: y})

    record = again(1.0, random)

    def fitted(p: Points) -> Array:
        """Return what the true structure says, fitted to the record by least squares."""
        scale = np.array([abs(x) for x in parameters.values()] + [abs(at[0]) + abs(at[1])] * 2)
        y = np.asarray(getattr(record, quantity))
        coarse = max(step, period / 50.0) if pendulum else step

        def motion(x: Array) -> Array:
            friction = _sum(dict(zip(parameters, x.tolist(), strict=False)))
            own = Body(inertia=inertia, pull=body.pull, level=friction(0.0), friction=friction)
            q, v = moved(own, float(x[-2]), float(x[-1]), times, coarse)
            return q if quantity == "position" else v

        x = np.array([*parameters.values(), *at])
        for _ in range(3):
            middle = motion(x)
            slopes = np.array([
                (motion(x + 1e-4 * h) - middle) / 1e-4 for h in np.diag(scale)
            ]).T  # fmt: skip
            least = np.r_[-x[:-2] / scale[:-2] - 1e-12, -np.inf, -np.inf]
            x = x + scale * lsq_linear(slopes, y - middle, (least, np.inf)).x
        friction = _sum(dict(zip(parameters, x.tolist(), strict=False)))
        return np.array([math.copysign(friction(abs(v)), v) for v in p.velocity.tolist()])

    # a wheel that does not stop was not slower than at the end
    last = 0.0 if pendulum else float(moved(body, *at, np.array([0.0, duration]), step)[1][-1])
    asked, beyond = asked_over(max(0.08 * top, last), 0.95 * top, both=pendulum)

    def steady(p: Points) -> Array:
        return np.array([math.copysign(friction(abs(v)), v) for v in p.velocity.tolist()])

    scale = float(np.mean(np.abs(steady(asked))))
    noises: Curve = lambda p: np.full(len(p), 0.03 * scale)  # noqa: E731

    def more(places: Points, number: int) -> Rig:
        """Return the motion with others that start with shares of it."""
        then = np.random.default_rng([62, seed, number])
        others = [again(float(share), then) for share in places.velocity]
        trials = (record, *others)
        return result.with_(measurement=Measurement(trials=trials), second=None, more=None)

    result = Rig(
        kind="decays", truth=name, inside=inside, measurement=record, mechanism=mechanism,
        family=TRUTHS[name][0] if inside else None, curves=(steady,), noise=noises,
        asked=asked, beyond=beyond, parameters=parameters, fitted=fitted if inside else None,
        second=again(float(random.uniform(0.6, 0.9)), random), more=more,
    )  # fmt: skip
    return result


def _friction(
    random: Random, name: str, amount: float, top: float
) -> tuple[Callable[[float], float], dict[str, float]]:
    """Return friction over speeds above 0, and its parameters."""
    if name in OUTSIDE:
        return OUTSIDE[name](amount, top), {}
    parts = name.split(" + ")
    shares = random.dirichlet(np.full(len(parts), 4.0))
    powers = {"level": 0, "viscous": 1, "drag": 2}
    c = {
        part: amount * s / top ** powers[part]
        for part, s in zip(parts, shares.tolist(), strict=True)
    }
    parameters = {NAMES[k]: x for k, x in c.items()}
    return _sum(parameters), parameters


def _waving(friction: Callable[[float], float], off: float, top: float) -> Callable[[float], float]:
    """Return friction that waves about another, down to a thousandth of the top speed."""
    return lambda v: friction(v) * (1.0 + off * math.sin(2.1 * math.log(max(v / top, 1e-3))))


def _sum(parameters: Mapping[str, float]) -> Callable[[float], float]:
    """Return friction over speeds above 0 of parameters."""
    level, viscous, drag = (parameters.get(NAMES[item], 0.0) for item in PARTS)
    return lambda v: level + viscous * v + drag * v * v
