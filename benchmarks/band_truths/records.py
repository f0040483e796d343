"""Records of an axis under control with a known truth: those of `axis_records`, and further ones.

Further ones are made by the same integrator with more in the rig, or by what is wrong with the
record: its scale, its sign, its noise, its clock. Each has a second record of the same rig.
"""

import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from scipy.signal import lfilter

from benchmarks.axis_records import (
    FAULTS,
    FURTHER,
    RATE,
    ROOM,
    TRUTHS,
    AxisRecord,
    Plant,
    Truth,
    record,
)
from benchmarks.band_truths.rig import (
    KINETIC,
    STATIC,
    VISCOUS,
    Array,
    Curve,
    Points,
    Random,
    Rig,
    asked_over,
)
from stickslip import Axis, Measurement

SECONDS = 12.0
SMOOTHED = 21
"""Samples of the mean that counts as the slow part of a force."""
Change: TypeAlias = Callable[[AxisRecord, Random], AxisRecord]


@dataclass(frozen=True, kw_only=True)
class Wrong:
    """A rig or record that has more to it than `axis_records` knows."""

    truth: Truth
    change: Change = lambda item, _random: item
    mechanism: Axis | None = None
    free: bool = True
    """Whether the inertia is looked for."""
    named: frozenset[str] = frozenset()
    steady: bool = True
    """Whether there is a steady curve to compare with."""
    scatter: float = 0.0
    """Relative change of friction from record to record."""
    inside: bool = False


def _truth(kinds: str = "level viscous", **plant: float) -> Truth:
    return Truth("further", kinds, Plant(**({"viscous": 0.3} | plant)))  # type: ignore[arg-type]


def _grown(one: AxisRecord, random: Random) -> AxisRecord:
    speed = np.abs(np.gradient(one.true_position, one.t))
    return replace(one, force=one.force + 0.15 * speed * random.normal(size=len(one.t)))


def _scaled(one: AxisRecord, _random: Random) -> AxisRecord:
    return replace(one, q=1.05 * one.q)


def _amplified(one: AxisRecord, _random: Random) -> AxisRecord:
    return replace(one, force=1.1 * one.force)


def _flipped(one: AxisRecord, _random: Random) -> AxisRecord:
    late = one.t > 0.5 * one.t[-1]
    return replace(one, force=np.where(late, -one.force, one.force))


def _reversed(one: AxisRecord, _random: Random) -> AxisRecord:
    return replace(one, force=-one.force)


def _rung(one: AxisRecord, _random: Random) -> AxisRecord:
    """The holder of the force sensor rings at 82 Hz."""
    w, damping, h = 2.0 * np.pi * 82.0, 0.03, 1.0 / RATE
    # exact for a force that is held between samples
    root = w * np.sqrt(1.0 - damping**2)
    keep, turn = np.exp(-damping * w * h), root * h
    a = np.array([1.0, -2.0 * keep * np.cos(turn), keep**2])
    part = keep * np.sin(turn) * damping * w / root
    b = np.array([0.0, 1.0 - keep * np.cos(turn) - part,
                  keep**2 + part - keep * np.cos(turn)])  # fmt: skip
    return replace(one, force=np.asarray(lfilter(b, a, one.force)))


WRONG: Mapping[str, Wrong] = {
    "load exponent": Wrong(truth=_truth(
        "level load viscous", forward=0.0, backward=0.0, by_load=0.8, load_exponent=0.67)),
    "noise grows": Wrong(truth=_truth(), change=_grown, named=frozenset({"noise"})),
    "stiffness 40 % wrong": Wrong(
        truth=_truth(spring=1.0), mechanism=Axis(inertia=0.026, stiffness=1.4),
        named=frozenset({"spring", "mechanism"})),
    "encoder scale": Wrong(
        truth=_truth(), change=_scaled, mechanism=Axis(inertia=0.02), free=False,
        named=frozenset({"position_scale"}), steady=False),
    "force gain": Wrong(
        truth=_truth(), change=_amplified, mechanism=Axis(inertia=0.02), free=False,
        named=frozenset({"force_gain"}), steady=False),
    "force gain, spring": Wrong(
        truth=_truth(spring=1.0), change=_amplified, mechanism=Axis(inertia=0.02, stiffness=1.0),
        free=False, named=frozenset({"force_gain"}), steady=False),
    "sign flipped midway": Wrong(
        truth=_truth(), change=_flipped, named=frozenset({"sign"}), steady=False),
    "sign": Wrong(truth=_truth(), change=_reversed, named=frozenset({"sign"}), steady=False),
    "time at rest": Wrong(
        truth=_truth("level rest viscous", growth=0.12), named=frozenset({"rest", "static"})),
    "hose": Wrong(
        truth=_truth(hose=4.0, relaxation=0.4), named=frozenset({"hose", "spring", "memory"})),
    "lag of friction": Wrong(truth=_truth(
        "level stribeck viscous", step_forward=0.5, step_backward=0.5, lag=0.03),
        named=frozenset({"memory", "lag"})),
    "dead zone": Wrong(truth=_truth(dead=0.3), named=frozenset({"dead_zone"})),
    "dead zone, heavy": Wrong(
        truth=_truth(dead=0.3, inertia=0.15), named=frozenset({"dead_zone"})),
    "known slope": Wrong(
        truth=_truth(offset=0.4), mechanism=Axis(inertia=0.026, offset=0.4), inside=True),
    "running-in": Wrong(
        truth=_truth(drift=-0.35), named=frozenset({"drift", "running-in"}), steady=False),
    "scatter of runs": Wrong(truth=_truth(), scatter=0.06, inside=True),
    "ringing at 82 Hz": Wrong(
        truth=_truth(), change=_rung, named=frozenset({"holder"})),
    "low inertia": Wrong(truth=_truth(inertia=0.001), inside=True),
    "falls with speed": Wrong(truth=_truth(
        "level stribeck", viscous=0.0, step_forward=0.7, step_backward=0.7,
        stribeck_velocity=1.5)),
    "lorentz": Wrong(truth=_truth(
        "lorentz", step_forward=0.5, step_backward=0.5, lorentz=1.0)),
    "frictionless": Wrong(
        truth=_truth("", forward=0.0, backward=0.0, viscous=0.0), inside=True),
}  # fmt: skip
NAMES = {"level_dir": "level_direction", "viscous_dir": "viscous_direction",
         "stribeck_dir": "stribeck_direction", "quadratic": "drag",
         "temperature": "level*temperature", "load": "adhesion"}  # fmt: skip
"""Terms, where `axis_records` calls them otherwise."""
SOUND = [item for item in (*TRUTHS, *FURTHER) if item.name != "quiet"]
ALLOWED = {
    "delay": {"delay", "lag"}, "saturation": {"limit"}, "backlash": {"backlash"},
    "spring": {"spring"}, "drift": {"drift"}, "flexible": {"flexible", "resonance"},
}  # fmt: skip


def drawn(number: int, seed: int) -> Rig:
    """Return a record: sound rigs, and in turn with them faulty and further ones."""
    half = number // 2
    if number % 2 == 0:
        truth = SOUND[half % len(SOUND)]
        return _rig(truth.name, truth, Wrong(truth=truth, inside=True), seed * 1000 + number)
    faulty = [(item.name, Wrong(truth=item, named=frozenset(ALLOWED[item.fault]),
                               steady=item.fault not in {"drift", "spring"}))
              for item in FAULTS]  # fmt: skip
    name, wrong = [*WRONG.items(), *faulty][half % (len(WRONG) + len(faulty))]
    return _rig(name, wrong.truth, wrong, seed * 1000 + number)


def _rig(name: str, truth: Truth, wrong: Wrong, seed: int) -> Rig:
    random = np.random.default_rng([64, seed, zlib.crc32(name.encode())])
    first = wrong.change(record(truth, 2 * seed, SECONDS), random)
    again = truth
    if wrong.scatter:
        p, by = truth.plant, 1.0 + wrong.scatter * float(random.choice([-1.0, 1.0]))
        scaled = {name: by * getattr(p, name) for name in ("forward", "backward", "viscous")}
        again = replace(truth, plant=replace(p, **scaled))
    second = wrong.change(record(again, 2 * seed + 1, SECONDS), random)
    p = truth.plant
    top = float(np.max(np.abs(np.gradient(first.true_position, first.t))))
    asked, beyond = asked_over(0.02 * top, 0.9 * top, both=True)
    asked, beyond = (_with(random, p, points) for points in (asked, beyond))
    # what changes with the place is on the average over the places that were visited
    places = np.linspace(first.true_position.min(), first.true_position.max(), 1000)
    wave = float(np.mean(np.sin(p.wave * places)))
    p = replace(
        p, forward=p.forward * (1.0 + p.level_ripple * wave),
        backward=p.backward * (1.0 + p.level_ripple * wave),
        step_forward=p.step_forward * (1.0 + p.level_ripple * wave),
        step_backward=p.step_backward * (1.0 + p.level_ripple * wave),
        offset=p.offset + p.ripple * wave,
    )  # fmt: skip
    level = (p.forward + p.backward) / 2.0
    known = wrong.mechanism.offset if wrong.mechanism else 0.0
    parameters = {"inertia": p.inertia} if wrong.steady and wrong.free else {}
    if wrong.inside and p.forward == p.backward and not (p.by_load or p.by_temperature):
        if p.viscous_backward is None and p.exponent == 1.0:
            parameters[VISCOUS] = p.viscous
        if not (p.second or p.length or p.step_forward):
            parameters[KINETIC] = level
        elif p.step_forward and p.step_forward == p.step_backward:
            parameters |= {KINETIC: level, STATIC: level + p.step_forward}
    family = frozenset(NAMES.get(item, item) for item in truth.kinds.split())

    def more(places: Points, number: int) -> Rig:
        """Return the record with others like it, one for each place."""
        then = np.random.default_rng([seed, number])
        others = [record(again, 100 * number + k, SECONDS) for k in range(len(places))]
        trials = (result.measurement, *(_measured(wrong.change(x, then)) for x in others))
        return result.with_(measurement=Measurement(trials=trials), second=None, more=None)

    result = Rig(
        kind="records", truth=name, inside=wrong.inside, measurement=_measured(first),
        mechanism=wrong.mechanism or Axis(inertia=1.3 * p.inertia),
        unknown=("mechanism.inertia",) if wrong.free else (),
        family=family if wrong.inside else None, faults=wrong.named, causes=family | {"offset"},
        curves=(lambda q: steady(p, q) - known,) if wrong.steady else (),
        noise=lambda q: np.full(len(q), p.force_noise), asked=asked, beyond=beyond,
        shown=_shown(second),
        parameters={k: v for k, v in parameters.items() if v}, second=_measured(second),
        more=more if wrong.inside else None,
    )  # fmt: skip
    return result


def _shown(one: AxisRecord) -> Curve:
    """Return the scatter of recorded forces around their slow part, by the speed.

    It is that of the sensor and of the controller, whose command follows the noise of the encoder.
    """
    slow = np.ones(SMOOTHED) / SMOOTHED
    fast = (one.force - np.convolve(one.force, slow, mode="same"))[SMOOTHED:-SMOOTHED]
    fast = np.abs(fast) / np.sqrt(1.0 - 1.0 / SMOOTHED)
    speed = np.abs(np.gradient(one.true_position, one.t))[SMOOTHED:-SMOOTHED]
    order = np.argsort(speed)
    near = len(speed) // 40

    def scatter(q: Points) -> Array:
        at = np.searchsorted(speed[order], np.abs(q.velocity))
        windows = (fast[order][max(k - near, 0) : k + near] for k in np.minimum(at, len(speed)))
        return np.array([1.4826 * float(np.median(window)) for window in windows])

    return scatter


def _with(random: Random, p: Plant, q: Points) -> Points:
    load = random.uniform(0.6, 1.8, len(q)) if p.by_load else None
    inputs = {"temperature": ROOM + random.uniform(2.0, 13.0, len(q))} if p.by_temperature else {}
    return Points(velocity=q.velocity, load=load, inputs=inputs)


def _measured(one: AxisRecord) -> Measurement:
    known = dict(one.covariates)
    load = known.pop("load", 1.0)
    return Measurement(
        time=one.t, position=one.q, force=one.force, load=load, inputs=known, turning=True
    )


def steady(p: Plant, q: Points) -> Array:
    """Return steady friction [N m] of an axis at points (n,), without what its place adds."""
    v = q.velocity
    u, ahead = np.abs(v), v > 0.0
    fall = np.exp(-((u / p.stribeck_velocity) ** p.stribeck_exponent))
    if p.lorentz:
        fall = 1.0 / (1.0 + (u / p.stribeck_velocity) ** 2)
    level = np.where(ahead, p.forward + p.step_forward * fall, p.backward + p.step_backward * fall)
    if p.by_load and q.load is not None:
        level = level + p.by_load * q.load**p.load_exponent
    if p.by_temperature and q.inputs:
        level = level * (1.0 + p.by_temperature * (q.inputs["temperature"] - ROOM))
    if p.second:
        level = level + p.second
    back = p.viscous if p.viscous_backward is None else p.viscous_backward
    viscous = np.where(ahead, p.viscous, back) * u**p.exponent
    return np.where(ahead, 1.0, -1.0) * (level + viscous) + p.offset
