"""Sliders that a spring pulls: what is said of stick-slip and of steps with known friction.

``python -m benchmarks.studies --only features "velocity steps" --seed 1`` judges 20 of each, and
``python -m benchmarks posterior features --seed 1`` prints what 24 rigs of the first are worth.

*Features*: a block sticks and slips, or swings, under Coulomb, Coulomb + viscous or Stribeck
friction, or under friction that no candidate has: that of LuGre, of Hess and Soom, and Coulomb
friction with a level that varies along the track. Rigs are as rigs are: springs are 8 % and masses
4 % off as given (one standard deviation), friction differs by 2 % from run to run and drifts by 1 %
along each. *Velocity steps*: records of the four usual forms of rate-and-state friction, and of two
states and Nagata's form, with a machine that is 20 to 40 % off as given.

A verdict is *right* if it names the true law, or cannot distinguish it, or if the law
that it names predicts what was not measured as well: features at half and twice the speed, or
friction at a step that was not made, within `NEAR` or the stated error. It is a *false certainty*
if a law is recommended without an equal or a doubt and errs there by more than `FAR` times that, or
if a bounded interval of the true law misses the truth by more than half its width.
"""

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from benchmarks.rigs import Array, Random, between
from stickslip import (
    Coulomb,
    CoulombViscous,
    FrictionLaw,
    LuGre,
    Measurement,
    Stribeck,
    TowedBlock,
    select,
    simulate,
)
from stickslip.errors import StickslipError
from stickslip.friction import RATE_STATE_FORMS, HessSoom, RateState
from stickslip.identify.fits import Estimate
from stickslip.identify.kinds import SimulatedVerdict, simulate_velocity_steps
from stickslip.identify.kinds.simulated import pooled
from stickslip.identify.problems.limit_cycles import limit_cycles
from stickslip.quantities import fields_of

NEAR = 0.05
"""Root mean square error of features at other speeds, or share of the variation of friction at
another step, up to which a prediction is good."""
FAR = 2.0
"""Error over the larger of that and the stated one from which the statement was false."""
OTHERS = ({"speed": 0.5}, {"speed": 2.0}, {"stiffness": 2.0}, {"load": 2.0})
"""Settings at which features are predicted, over those of the record."""
WAY = 3e-5
"""Way [m] over which friction waves by a radian, where a law is not quite right."""
CYCLES = 60
"""Slips or swings of a record, about."""
OFF = {"stiffness": 0.08, "mass": 0.04}
"""Standard deviations of logarithms of what a machine is, over what is given."""
RUN, DRIFT, WAVE = 0.02, 0.01, 0.05
"""Standard deviation of friction from run to run, its change along a record, and of a track."""
TRIES, LEAST = 50, 0.02
"""Laws that are drawn for a rig until one sticks and slips, by the scatter over the mean."""
INSIDE = ("coulomb", "stribeck", "coulomb-viscous")
PULLED = ("coulomb", "lugre", "stribeck", "hess-soom", "coulomb-viscous", "track")
STEPPED = ("constant-coefficient", "logarithmic", "rate-and-state", "rate-and-state-slip",
           "rate-and-two-states", "rate-and-state-nagata")  # fmt: skip


def _missed(estimates: Sequence[Estimate], truth: Mapping[str, float]) -> Iterator[dict[str, Any]]:
    """Yield for each bounded estimate that the truth has too whether its interval holds it."""
    for estimate in estimates:
        true = truth.get(estimate.path)
        if true is None or not estimate.bounded:
            continue
        middle, half = 0.5 * (estimate.low + estimate.high), 0.5 * (estimate.high - estimate.low)
        yield {
            "path": estimate.path,
            "true": float(true),
            "said": [estimate.low, estimate.high],
            "held": bool(estimate.low <= true <= estimate.high),
            "far": bool(abs(true - middle) > 2.0 * half),
        }


def _rated(
    row: dict[str, Any], named: str, ties: Sequence[str], *, hedged: bool, error: float,
    stated: float, intervals: Sequence[dict[str, Any]],
) -> dict[str, Any]:  # fmt: skip
    """Return a row with what a verdict is worth."""
    told = row["truth"] in (named, *ties)
    good = error <= max(NEAR, stated)
    certain = bool(named) and not hedged and not ties and not told
    return row | {
        "named": named,
        "ties": list(ties),
        "error": error,
        "stated": stated,
        "intervals": list(intervals),
        "right": told or good or not named,
        "false": (certain and error > FAR * max(NEAR, stated))
        or any(interval["far"] for interval in intervals),
    }


def _pulled_law(random: Random, truth: str, level: float, speed: float, load: float) -> FrictionLaw:
    static = level * float(random.uniform(1.1, 1.6))
    slow = speed * between(random, 0.3, 10.0)
    if truth == "stribeck":
        return Stribeck(
            kinetic_coefficient=level, static_coefficient=static, stribeck_velocity=slow
        )
    if truth == "coulomb-viscous":
        return CoulombViscous(
            kinetic_coefficient=level, static_coefficient=static,
            viscous_coefficient=float(random.uniform(0.01, 0.05)) * level * load / speed,
        )  # fmt: skip
    if truth == "hess-soom":
        return HessSoom(
            kinetic_coefficient=level, static_coefficient=static, stribeck_velocity=slow,
            viscous_coefficient=0.0,
        )  # fmt: skip
    if truth == "lugre":
        stiffness = level / between(random, 1e-6, 3e-5)
        return LuGre(
            kinetic_coefficient=level, static_coefficient=static, stribeck_velocity=slow,
            bristle_stiffness=stiffness, bristle_damping=0.3 * math.sqrt(stiffness),
        )  # fmt: skip
    return Coulomb(kinetic_coefficient=level, static_coefficient=static)


class Rig:
    """A block that a spring pulls, as it is and as it is told, with its friction."""

    def __init__(self, seed: int, number: int) -> None:
        self.random = np.random.default_rng([53, seed, number])
        random = self.random
        self.truth = PULLED[number % len(PULLED)]
        level, mass = between(random, 0.1, 0.6), between(random, 0.02, 2.0)
        natural = between(random, 2.0, 30.0)
        stiffness = mass * (2.0 * math.pi * natural) ** 2
        # falls of the force take 0.1 to 3 of a natural period to build up again
        rise = 0.3 * level * mass * 9.81 / stiffness * natural
        self.block = TowedBlock(
            mass=mass, stiffness=stiffness, speed=rise / between(random, 0.1, 3.0),
            load=9.81 * mass,
        )  # fmt: skip
        speed, load = self.block.speed, self.block.steady_load
        for _ in range(TRIES):  # what slides steadily has no features
            self.law = _pulled_law(random, self.truth, level, speed, load)
            _, mean, scatter = self.features(self.law, self.block)
            if scatter > LEAST * mean:
                break
        off = {name: math.exp(size * random.normal()) for name, size in OFF.items()}
        self.told = self.at(off, self.block)

    @staticmethod
    def at(factors: Mapping[str, float], block: TowedBlock) -> TowedBlock:
        """Return a block with other parameters, over its own."""
        values = {name: factor * getattr(block, name) for name, factor in factors.items()}
        return replace(block, load=values.pop("load", block.load), **values)

    def run(self) -> FrictionLaw:
        """Return the friction of another run."""
        return self.scaled(1.0 + RUN * self.random.normal())

    def scaled(self, factor: float) -> FrictionLaw:
        """Return the friction times a factor."""
        names = ("kinetic_coefficient", "static_coefficient", "viscous_coefficient")
        known = {name: getattr(self.law, name, None) for name in names}
        own: Any = self.law
        return replace(own, **{name: factor * x for name, x in known.items() if x})

    def period(self, block: TowedBlock) -> float:
        """Return about how long a cycle takes [s]."""
        natural = 2.0 * math.pi * math.sqrt(block.mass / block.stiffness)
        force = 0.6 * self.law.kinetic_coefficient * block.steady_load  # type: ignore[attr-defined]
        return natural + force / (block.stiffness * block.speed)

    def features(self, law: FrictionLaw, block: TowedBlock) -> Array:
        """Return frequency, mean and scatter of a limit cycle (3,)."""
        speed = {"mechanism.speed": np.array([block.speed])}
        return np.asarray(limit_cycles(block, law, speed, np.array([self.period(block)]))[0])

    def record(self, law: FrictionLaw, block: TowedBlock) -> Measurement:
        """Return a record of the force of the spring [N]."""
        random, period = self.random, self.period(block)
        natural = math.sqrt(block.stiffness / block.mass) / (2.0 * math.pi)
        began, end = 10.0 * period, (10.0 + CYCLES) * period
        t = np.arange(began, end, min(0.02 / natural, period / 40.0))
        run = simulate(block, law, t_end=float(t[-1])).at(t)
        force = block.stiffness * (block.speed * t - run["x"])
        if self.truth == "track":  # the level rises and falls by a few per cent on the way
            way = block.speed * (end - began) / float(random.uniform(2.0, 5.0))
            force *= 1.0 + WAVE * np.sin(2.0 * math.pi * block.speed * t / way)
        force *= 1.0 + DRIFT * (t - t.mean()) / np.ptp(t)
        force += 0.01 * float(np.std(force)) * random.normal(size=len(t))
        return Measurement(time=t, spring_force=force)


def pulled(seed: int, number: int, *, rehearsed: bool = False) -> dict[str, Any]:
    """Return what a selection says of the force of a spring that pulls a block.

    If it is `rehearsed`, the record that a verdict in doubt advises is made too.
    """
    rig = Rig(seed, number)
    law = rig.run()
    row: dict[str, Any] = {"seed": seed, "number": number, "truth": rig.truth, "law": repr(law),
                           "inside": rig.truth in INSIDE}  # fmt: skip
    begun = time.process_time()
    try:
        record = rig.record(law, rig.block)
        begun = time.process_time()
        verdict = select(rig.told, None, record)
    except StickslipError as error:
        return row | {"refused": str(error), "seconds": time.process_time() - begun}
    assert isinstance(verdict, SimulatedVerdict)
    row["seconds"] = time.process_time() - begun
    closest = verdict.closest
    assert closest.fit is not None
    true = _truths(law, rig.block)
    known = [*_missed(verdict.intervals, true)] if verdict.best and rig.truth in INSIDE else []
    own = [
        candidate.fit
        for candidate in verdict.candidates
        if candidate.name == rig.truth and candidate.fit
    ]
    inside = list[list[bool]]()
    for factors in OTHERS if rig.truth != "track" and verdict.best else ():
        seen = rig.features(rig.run(), rig.at(factors, rig.block))
        band = verdict.predict(rig.at(factors, rig.told))
        held = (band.low <= seen) & (seen <= band.high)
        inside.append(held.tolist())
    row = _rated(
        row, verdict.best.name if verdict.best else "", verdict.rivals,
        hedged=verdict.best is None, error=_off(rig, law, verdict),
        stated=closest.score, intervals=known,
    )  # fmt: skip
    row |= {
        "verdict": verdict.sentence,
        "predicted": inside,
        "lawful": [*_missed(own[0].estimates, true)] if own and rig.truth in INSIDE else [],
        "effective": closest.fit.family.effective,
        "doubt": bool(verdict.rivals),
        "advised": bool(verdict.advised),
    }
    if rehearsed and verdict.rivals and verdict.advised:
        row |= _rehearsal(rig, law, record, verdict)
    return row


def _truths(law: FrictionLaw, block: TowedBlock) -> dict[str, float]:
    names = ("kinetic_coefficient", "static_coefficient", "stribeck_velocity")
    result = {name: getattr(law, name) for name in names if getattr(law, name, None) is not None}
    if not isinstance(law, LuGre):
        result["viscous_coefficient"] = getattr(law, "viscous_coefficient", 0.0)
    return {f"friction.{name}": x for name, x in result.items()} | {
        "mechanism.mass": block.mass, "mechanism.stiffness": block.stiffness,
    }  # fmt: skip


def _off(rig: Rig, law: FrictionLaw, verdict: SimulatedVerdict) -> float:
    """Return how far off features are foreseen in the same run at other settings.

    That is of mean and scatter, over the mean: a slider that slides on has these too.
    """
    errors = [0.0]
    for factors in OTHERS if rig.truth != "track" else ():
        same = rig.features(law, rig.at(factors, rig.block))
        result = verdict.predict(rig.at(factors, rig.told)).median
        errors.append(float(np.sqrt(np.mean(((result - same)[1:] / same[1]) ** 2))))
    return max(errors)


LEVELS = ("friction.kinetic_coefficient", "friction.static_coefficient")
"""Parameters whose widths a further pull is to halve."""


def _widths(verdict: SimulatedVerdict, paths: Sequence[str]) -> float:
    """Return the mean logarithm of the widths of parameters, over all candidate laws."""
    return float(np.mean([math.log(np.ptp(pooled(verdict.fits, path))) for path in paths]))


def _rehearsal(
    rig: Rig, law: FrictionLaw, record: Measurement, verdict: SimulatedVerdict
) -> dict[str, Any]:
    """Return what the record that is advised first comes to."""
    first = verdict.advised[0]
    factor = first.value / getattr(rig.told, first.name)
    try:
        another = rig.record(rig.run(), rig.at({first.name: factor}, rig.block))
        overrides = {f"mechanism.{first.name}": first.value}
        trials = (record, replace(another, overrides=overrides))
        after = select(rig.told, None, Measurement(trials=trials))
    except StickslipError as error:
        return {"advice": False, "followed": False, "after": str(error)}
    assert isinstance(after, SimulatedVerdict)
    kept = rig.truth in (after.closest.name, *after.rivals) or rig.truth not in INSIDE
    lost = not kept and after.best is not None and _off(rig, law, after) > NEAR
    return _came_to(verdict, after, LEVELS, first.expected_width, kept=kept) | {"lost": lost}


def _came_to(
    verdict: SimulatedVerdict, after: SimulatedVerdict, paths: Sequence[str], expected: float, *,
    kept: bool, used: float = 1.0,
) -> dict[str, Any]:  # fmt: skip
    """Return what a further record that was advised came to, if the true law is `kept`.

    It is `used` times as long as those that were made.
    """
    shrink = math.exp(_widths(after, paths) - _widths(verdict, paths)) if paths else math.inf
    fewer = len(after.rivals) < len(verdict.rivals)
    return {
        "advice": shrink <= 0.5 or (fewer and kept),
        "followed": shrink <= 0.5 or (fewer and kept),
        "used": used,
        "shrink": shrink,
        "expected": expected,
        "asked": 1,
        "after": after.sentence,
    }


def _stepped_law(random: Random, truth: str) -> RateState:
    form = RATE_STATE_FORMS[truth]
    a = float(random.uniform(0.004, 0.015))
    evolving = form.evolution != "none"
    return RateState(
        reference_coefficient=float(random.uniform(0.3, 0.8)),
        direct_effect=0.0 if truth == "constant-coefficient" else a,
        evolution_effect=a * float(random.uniform(0.4, 1.5)) if evolving else 0.0,
        critical_distance=between(random, 3e-6, 5e-5) if evolving else None,
        second_evolution_effect=a * float(random.uniform(-0.5, 0.5)) if form.second else 0.0,
        second_critical_distance=between(random, 1e-4, 3e-4) if form.second else None,
        stress_effect=float(random.uniform(0.5, 3.0)) if truth.endswith("nagata") else 0.0,
        reference_velocity=1e-6,
        evolution=form.evolution,
    )


def _path(random: Random, count: int) -> tuple[Array, Array]:
    """Return times [s] and places [m] between which a load point moves steadily, after steps."""
    speed = between(random, 3e-7, 3e-6)
    speeds, ways = [speed], [2e-4]
    for number in range(count):
        factor = between(random, 3.0, 30.0)
        speeds.append(speeds[-1] * (factor if number % 2 == 0 else 1.0 / factor))
        ways.append(4e-4)
    times = np.concatenate([[0.0], np.cumsum(np.array(ways) / speeds)])
    return times, np.concatenate([[0.0], np.cumsum(ways)])


def _stepped_record(
    law: RateState, stiffness: float, knots: Array, places: Array, noise: float, random: Random,
    wave: float = 0.0,
) -> Measurement:  # fmt: skip
    """Return the coefficient of friction while a load point moves steadily between knots.

    It waves along the way by a share of its variation.
    """
    t = np.unique(np.concatenate([
        np.linspace(a, b, 250, endpoint=False) for a, b in pairwise(knots.tolist())
    ]))  # fmt: skip
    true = simulate_velocity_steps(law, stiffness=stiffness, time=knots, pull=places, at=t)
    pull = np.interp(t, knots, places)
    friction = true.coefficient + noise * random.normal(size=len(t))
    friction += wave * np.ptp(true.coefficient) * np.sin(pull / WAY)
    return Measurement(time=t, pull=pull, friction=friction, load=1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Steps:
    """Friction at steps of the speed of a load point, and what is true of it."""

    law: RateState
    stiffness: float
    """Of the machine, over the load [1/m]."""
    given: TowedBlock
    """The machine as it is given."""
    record: Measurement
    knots: Array
    """Times (n,) [s] between which the load point moves steadily."""
    places: Array
    """Its places (n,) [m] then."""
    noise: float
    """Standard deviation of a reading of the coefficient."""


def steps(random: Random, truth: str, wave: float = 0.0) -> Steps:
    """Return a record of random steps; friction waves along the way by a share of its variation."""
    law = _stepped_law(random, truth)
    # well above the stiffness below which the slider runs away
    distance = law.critical_distance or 1e-5
    spare = max(law.evolution_effect + max(law.second_evolution_effect, 0.0), 0.005)
    stiffness = spare / distance * between(random, 2.0, 10.0)
    knots, places = _path(random, int(random.choice((1, 2, 3, 4))))
    noise = between(random, 1e-4, 1e-3)
    record = _stepped_record(law, stiffness, knots, places, noise, random, wave)
    off = between(random, 1.2, 1.4) ** float(random.choice((-1.0, 1.0)))
    return Steps(
        law=law, stiffness=stiffness, knots=knots, places=places, noise=noise,
        given=TowedBlock(mass=1e-3, stiffness=off * stiffness, speed=1e-6, load=1.0),
        record=record,
    )  # fmt: skip


def stepped(seed: int, number: int, *, rehearsed: bool = False) -> dict[str, Any]:
    """Return what a selection says of friction at steps of the speed of a load point.

    If it is `rehearsed`, the steps that a verdict in doubt advises are made too.
    """
    random = np.random.default_rng([59, seed, number])
    truth = STEPPED[number % len(STEPPED)]
    row: dict[str, Any] = {"seed": seed, "number": number, "truth": truth}
    begun = time.process_time()
    try:
        made = steps(random, truth)
        law, noise, knots, places = made.law, made.noise, made.knots, made.places
        row["law"] = repr(law)
        begun = time.process_time()
        verdict = select(made.given, None, made.record)
        assert isinstance(verdict, SimulatedVerdict)
        seconds = time.process_time() - begun
        closest = verdict.closest
        assert closest.fit is not None
        fresh = _fresh(knots, places)
        fitted = closest.fit.law, closest.fit.details["stiffness_over_load"]
        true, predicted = (
            simulate_velocity_steps(each, stiffness=k, time=fresh[0], pull=fresh[1], at=fresh[2])
            for each, k in ((law, made.stiffness), fitted)
        )
    except StickslipError as error:
        return row | {"refused": str(error), "seconds": time.process_time() - begun}
    variation = max(float(np.std(true.coefficient)), noise)
    error = float(np.sqrt(np.mean((true.coefficient - predicted.coefficient) ** 2))) / variation
    same = closest.name == truth
    rival = verdict.rivals[:1]
    evolves = closest.fit.law.critical_distance is not None
    open_ = evolves and not closest.fit.details["separable"]  # a and b are not told apart
    row |= {"doubt": bool(verdict.rivals) or open_, "advised": bool(verdict.advised)}
    speeds = [item for item in verdict.advised if item.name == "speed"]
    if rehearsed and row["doubt"] and speeds:
        ways = np.array([2e-4, 4e-4, 4e-4])
        first = places[1] / knots[1]
        lasts = ways / np.array([first, speeds[0].value, first])
        longer = np.append(knots, knots[-1] + np.cumsum(lasts))
        further = np.append(places, places[-1] + np.cumsum(ways))
        try:
            record = _stepped_record(law, made.stiffness, longer, further, noise, random)
            after = select(made.given, None, record)
        except StickslipError as error:
            row |= {"advice": False, "followed": False, "after": str(error)}
        else:
            assert isinstance(after, SimulatedVerdict)
            kept = truth in (after.closest.name, *after.rivals)
            drawn = [{path for fit in x.fits for path in fit.draws} for x in (verdict, after)]
            paths = [x.path for x in closest.fit.estimates if x.path in drawn[0] & drawn[1]]
            used = float(np.sum(ways) / (places[-1] - places[0]))
            row |= _came_to(verdict, after, paths, speeds[0].expected_width, kept=kept, used=used)
    return _rated(
        row, verdict.best.name if verdict.best else "", rival,
        hedged="is closest, but" in verdict.sentence, error=error,
        stated=closest.score / variation,
        intervals=[*_missed(closest.fit.estimates if same else (), at(law, closest.fit.law))],
    ) | {"verdict": verdict.sentence, "seconds": seconds, "noise": noise}  # fmt: skip


def at(law: RateState, fitted: RateState) -> dict[str, float]:
    """Return parameters of a law with the coefficient that it has at the speed of another one."""
    slope = law.direct_effect - law.evolution_effect - law.second_evolution_effect
    ratio = math.log(fitted.reference_velocity / law.reference_velocity)
    values = {name: getattr(law, name) for name in fields_of(RateState)}
    values["reference_coefficient"] += slope * ratio
    return {f"friction.{name}": x for name, x in values.items() if x is not None}


def _fresh(knots: Array, places: Array) -> tuple[Array, Array, Array]:
    """Return times, places and times to look at of a step up that was not made, as large as one."""
    speeds = np.diff(places) / np.diff(knots)
    first, last = float(speeds.min()), float(speeds.max())
    middle = math.sqrt(first * last)
    times = np.concatenate([[0.0], np.cumsum(4e-4 / np.array([middle, last, first]))])
    way = 4e-4 * np.arange(4.0)
    return times, way, np.interp(np.linspace(1.0, 3.0, 400), np.arange(4.0), times)
