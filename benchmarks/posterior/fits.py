"""Coverage of the intervals of `fit` where the law that is fitted is right, or nearly so.

Axes, free motions, servos, velocity steps and travels are those of `benchmarks.rigs`,
`benchmarks.band_truths.decays`, `benchmarks.servos`, `benchmarks.pulled_sliders` and
`benchmarks.travel_truth`. Every second rig has friction that differs from its law by up to `OFF`:
levels of an axis grow along its record, those of travels from the first trial to the last, friction
of a free motion and of velocity steps waves with the speed or along the way, and what a servo's
gear takes fades otherwise with the speed. A bounded interval is to hold the true value of each
parameter; those without a bound are counted apart. For some rigs `select` is asked the same with
this law alone: its values and ends are to be those of the fit.
"""

import math
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from benchmarks import pulled_sliders, rigs, servos, travel_truth
from benchmarks.band_truths import decays
from benchmarks.band_truths.rig import DRAG, KINETIC, VISCOUS, Array
from stickslip import Axis, BamM4, FrictionLaw, Measurement, fit, select
from stickslip.errors import ConvergenceError, StickslipError
from stickslip.friction import law
from stickslip.mechanisms import Mechanism

OFF = 0.02
"""Model error of every second rig, over friction, or over its variation in velocity steps."""
FADING = 1.15
"""Exponent by which friction of a gear fades there: 1 to 2 % of it beside an exponent of 1."""
LAWS = ("rate-and-state", "rate-and-state-slip", "logarithmic", "rate-and-state",
        "rate-and-state-slip", "constant-coefficient")  # fmt: skip
"""True laws of velocity steps."""
POWERS = {KINETIC: 0, VISCOUS: 1, DRAG: 2}
"""Powers of the speed in what slows a free motion down."""
DRAWS = 20
"""Rigs of velocity steps that are drawn until a slider does not run away."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A measurement of a rig, what is fitted to it, and what is true."""

    truth: str
    mechanism: Mechanism
    law: type[FrictionLaw] | FrictionLaw | str
    measurement: Measurement
    true: Mapping[str, tuple[float, float]]
    """Least and largest true value by path; of one that does not change both are the same."""
    options: Mapping[str, Any] = field(default_factory=dict)
    at: Callable[[Any], Mapping[str, tuple[float, float]]] | None = None
    """True values for a fit, where they depend on what it counts from."""


@dataclass(frozen=True, kw_only=True)
class Fitted:
    """What the intervals of one fit hold."""

    kind: str
    truth: str
    number: int
    exact: bool
    """Whether friction is that of the law."""
    held: Mapping[str, bool]
    """By path, of bounded intervals whether they hold the true value."""
    missed: Mapping[str, float]
    """By path of those that do not, how many half-widths the truth lies from the middle."""
    unbounded: int
    apart: float | None
    """Largest relative difference of values and ends from those of `select`, where compared."""
    seconds: float
    """Processor time of the fit."""
    refused: str = ""

    def __str__(self) -> str:
        missed = ", ".join(f"{path} {x:.2f}" for path, x in self.missed.items())
        same = "" if self.apart is None else f", select differs by {self.apart:.1e}"
        return (
            f"{self.kind} {self.number} {self.truth}{'' if self.exact else ' (off)'}:"
            f" {sum(self.held.values())} of {len(self.held)}, {self.unbounded} not bounded"
            f"{same}, {self.seconds:.1f} s {missed} {self.refused}"
        )


def fitted(kind: str, seed: int, number: int) -> Fitted:
    """Return what the intervals of a fit to a rig of a kind hold."""
    exact = number % 2 == 0
    random = np.random.default_rng([78, seed, number])
    case = KINDS[kind].made(random, seed, number, 0.0 if exact else OFF)
    options = dict(case.options)
    begun = time.process_time()
    row = partial(Fitted, kind=kind, truth=case.truth, number=number, exact=exact)
    try:
        result: Any = fit(case.mechanism, case.law, case.measurement, **options)
    except StickslipError as error:
        seconds = time.process_time() - begun
        return row(held={}, missed={}, unbounded=0, apart=None, seconds=seconds,
                   refused=str(error))  # fmt: skip
    seconds = time.process_time() - begun
    true = case.true if case.at is None else case.at(result.law)
    held, missed, unbounded = dict[str, bool](), dict[str, float](), 0
    for estimate in result.estimates:
        if estimate.path not in true:
            continue
        if not estimate.bounded:
            unbounded += 1
            continue
        low, high = true[estimate.path]
        held[estimate.path] = estimate.low <= high and low <= estimate.high
        if not held[estimate.path]:
            middle, half = 0.5 * (estimate.low + estimate.high), max(estimate.half_width, 1e-300)
            missed[estimate.path] = (low - middle if low > middle else high - middle) / half
    compared = number // 2 < KINDS[kind].compared and exact
    return row(held=held, missed=missed, unbounded=unbounded, seconds=seconds,
               apart=_apart(case, result, options) if compared else None)  # fmt: skip


def _apart(case: Case, result: Any, options: Mapping[str, Any]) -> float:
    """Return how far values and ends of `select` with one law are from those of its fit."""
    given = {name: x for name, x in options.items() if name != "settings"}
    try:
        verdict: Any = select(case.mechanism, [case.law], case.measurement, **given)
    except StickslipError:
        return math.inf
    other = verdict.closest.fit
    if other is None or len(other.estimates) != len(result.estimates):
        return math.inf
    worst = 0.0
    for own, its in zip(result.estimates, other.estimates, strict=True):
        if own.path != its.path:
            return math.inf
        for a, b in ((own.value, its.value), (own.low, its.low), (own.high, its.high)):
            if a != b:
                worst = max(worst, abs(a - b) / max(abs(a), abs(b)) if np.isfinite(a - b) else 9e9)
    return worst


def _values(prefix: str, law: FrictionLaw) -> dict[str, tuple[float, float]]:
    return {
        f"{prefix}.{name}": (float(x), float(x))
        for name, x in vars(law).items()
        if isinstance(x, float)
    }


def axis(random: rigs.Random, seed: int, number: int, off: float) -> Case:
    """Return a record of an axis whose inertia is looked for."""
    truth = [*rigs.TRUTHS][number // 2 % len(rigs.TRUTHS)]
    rig = rigs.draw(random, truth)
    rig = replace(rig, drift=2.0 * off)
    record, _ = rigs.record(rig, random)
    free = rigs.FREE.get(truth, ("friction.*",))
    true = _values("friction", rig.law)
    true |= {f"mechanism.{x}": (getattr(rig.axis, x),) * 2 for x in ("inertia", "offset")}
    if off:  # a level has all values that it had
        for name in rigs.LEVELS:
            if (path := f"friction.{name}") in true:
                x = true[path][0]
                true[path] = (1.0 - off) * x, (1.0 + off) * x
    return Case(
        truth=truth, mechanism=Axis(inertia=1.0), law=type(rig.law), measurement=record,
        true=true, options={"vary": [*free, "mechanism.inertia"]},
    )  # fmt: skip


def decay(random: rigs.Random, seed: int, number: int, off: float) -> Case:
    """Return a free motion of a pendulum, a wheel or a slider."""
    rig = decays.drawn(2 * (number // 2), int(random.integers(1 << 31)), off=off)
    true = {f"friction.{name}": (x, x) for name, x in rig.parameters.items()}
    if off:
        true = _closest(rig, off)
    return Case(
        truth=rig.truth, mechanism=rig.mechanism, law=law(rig.truth), measurement=rig.measurement,
        true=true,
    )  # fmt: skip


def _closest(rig: decays.Rig, off: float) -> dict[str, tuple[float, float]]:
    """Return the values with which a law is closest to friction that waves about it.

    They depend on how much each speed counts: evenly, by its logarithm, or any single one.
    """
    assert rig.asked is not None
    v = np.abs(rig.asked.velocity)
    curve = np.abs(rig.curves[0](rig.asked))
    columns = np.array([v ** POWERS[name] for name in rig.parameters]).T
    values = [np.array([*rig.parameters.values()]) * (1.0 + x) for x in (-off, off)]
    for weight in (np.ones_like(v), np.sqrt(v)):
        values.append(np.linalg.lstsq(columns * weight[:, None], curve * weight, rcond=None)[0])
    low, high = np.min(values, axis=0).tolist(), np.max(values, axis=0).tolist()
    return {f"friction.{n}": (a, b) for n, a, b in zip(rig.parameters, low, high, strict=True)}


def servo(random: rigs.Random, seed: int, number: int, off: float) -> Case:
    """Return a record of a servo whose resistance and torque constant are given 30 % off."""
    own = servos.draw(random)
    made = replace(own, law=replace(own.law, fading_exponent=FADING)) if off else own
    motor: Any = own.rig.drive
    record = servos.recorded(made)
    factors = np.exp(random.uniform(-0.3, 0.3, 2)).tolist()
    names = ("resistance", "torque_constant")
    guess = replace(
        motor, **{n: getattr(motor, n) * x for n, x in zip(names, factors, strict=True)}
    )
    laws = [own.law, *_closest_gears(made.law)] if off else [own.law]
    true = {
        f"friction.{name}": (min(x), max(x))
        for name in own.law.fit_order
        for x in [[getattr(item, name) for item in laws]]
    }
    true |= {f"mechanism.drive.{name}": (getattr(motor, name),) * 2 for name in names}
    return Case(
        truth="bam-m4", mechanism=replace(own.rig, drive=guess), law=BamM4, measurement=record,
        true=true,
        options={"vary": ["friction.*", *servos.VARIED], "fixed": {"fading_exponent": 1.0}},
    )  # fmt: skip


def _closest_gears(law: BamM4) -> Iterator[BamM4]:
    """Yield the laws that fade with the exponent 1 and are closest to one that fades otherwise.

    Speeds count by their logarithm, or evenly.
    """
    u = np.geomspace(0.05, 10.0, 200)  # over the Stribeck speed
    curve = np.exp(-(u**law.fading_exponent))
    for weight in (np.ones_like(u), np.sqrt(u)):

        def split(c: float, weight: Array = weight) -> tuple[float, Array]:
            columns = weight[:, None] * np.array([np.ones_like(u), np.exp(-u / c), u]).T
            parts, left, *_ = np.linalg.lstsq(columns, weight * curve, rcond=None)
            return float(left[0]), parts

        c = min(np.linspace(0.7, 1.3, 121).tolist(), key=lambda c: split(c)[0])
        level, surplus, slope = split(c)[1].tolist()
        step = law.static_coefficient - law.kinetic_coefficient
        kinetic = law.kinetic_coefficient + level * step
        yield replace(
            law,
            kinetic_coefficient=kinetic,
            static_coefficient=kinetic + surplus * step,
            transmitted_coefficient=law.transmitted_coefficient
            + level * law.transmitted_static_surplus,
            transmitted_static_surplus=surplus * law.transmitted_static_surplus,
            stribeck_velocity=c * law.stribeck_velocity,
            viscous_coefficient=law.viscous_coefficient + slope * step / law.stribeck_velocity,
            fading_exponent=1.0,
        )


def steps(random: rigs.Random, seed: int, number: int, off: float) -> Case:
    """Return friction at steps of the speed, on a machine whose stiffness is 20 to 40 % off."""
    truth = LAWS[number // 2 % len(LAWS)]
    for _ in range(DRAWS):
        try:
            made = pulled_sliders.steps(random, truth, wave=off)
        except StickslipError:
            continue
        break
    else:
        raise ConvergenceError(f"the slider runs away in all {DRAWS} rigs of {truth}.")
    stiffness = made.stiffness
    true = {"mechanism.stiffness": (stiffness, stiffness)}

    def at(fitted: Any) -> dict[str, tuple[float, float]]:
        return true | {path: (x, x) for path, x in pulled_sliders.at(made.law, fitted).items()}

    return Case(
        truth=truth, mechanism=made.given, law=truth, measurement=made.record, true=true, at=at,
    )  # fmt: skip


def travel(random: rigs.Random, seed: int, number: int, off: float) -> Case:
    """Return travels of a block, an axis or a capsule."""
    half = number // 2
    kinds, truths = travel_truth.KINDS, travel_truth.TRUTHS
    truth = (
        truths[half // len(kinds) % len(truths)]
        if half >= len(kinds) * len(truths)
        else (truths[half % len(truths)])
    )
    rig = travel_truth.draw(random, kinds[half % len(kinds)], truth)
    rig = replace(rig, drift=off * float(random.choice((-1.0, 1.0))))
    first, last = _values("friction", rig.law), _values("friction", rig.law_at(1.0))
    true = {path: (min(x, last[path][0]), max(x, last[path][0])) for path, (x, _) in first.items()}
    return Case(
        truth=f"{truth}, {rig.kind}", mechanism=rig.mechanism, law=type(rig.law),
        measurement=travel_truth.readings(rig, random), true=true, options={"t_end": rig.t_end},
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Kind:
    """Rigs of a kind, and how many are asked for."""

    made: Callable[[rigs.Random, int, int, float], Case]
    count: int
    compared: int
    """Rigs for which `select` is asked the same; none of servos, which runs fit."""
    seconds: float
    """Processor time that a fit may take [s]."""


KINDS: Mapping[str, Kind] = {
    "axes": Kind(made=axis, count=36, compared=6, seconds=6.0),
    "decays": Kind(made=decay, count=48, compared=7, seconds=5.0),
    "servos": Kind(made=servo, count=24, compared=0, seconds=20.0),
    "steps": Kind(made=steps, count=24, compared=3, seconds=5.0),
    "travels": Kind(made=travel, count=24, compared=3, seconds=3.0),
}
