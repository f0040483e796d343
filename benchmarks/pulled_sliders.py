"""Sliders that a spring pulls: what is said of stick-slip and of steps with known friction.

``python -m benchmarks.studies --only features "velocity steps" --seed 1`` judges 20 of each.

*Features*: a block sticks and slips, or swings, under Coulomb, Stribeck or LuGre friction, or
under friction that no candidate has: that of Hess and Soom, and Coulomb friction with a level that
varies along the track. *Velocity steps*: records of the four usual forms of rate-and-state
friction, and of two states and Nagata's form, with a machine that is 20 to 40 % off as given.

A verdict is *right* if it names the true law or does not tell it from the one named, or if the law
that it names predicts what was not measured as well: features at half and twice the speed, or
friction at a step that was not made, within `NEAR` or the stated error. It is a *false certainty*
if a law is recommended without an equal or a doubt and errs there by more than `FAR` times that, or
if a bounded interval of the true law misses the truth by more than half its width.
"""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from benchmarks.rigs import Array, Random, between
from stickslip import (
    Coulomb,
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
from stickslip.identify.kinds import FeatureVerdict, RateStateVerdict, simulate_velocity_steps
from stickslip.identify.kinds.features.problem import cycle_features
from stickslip.identify.kinds.features.result import as_good

NEAR = 0.05
"""Root mean square error of features at other speeds, or share of the variation of friction at
another step, up to which a prediction is good."""
FAR = 2.0
"""Error over the larger of that and the stated one from which the statement was false."""
SPEEDS = (0.5, 2.0)
"""Speeds of the pull at which features are predicted, over that of the record."""
CYCLES = 60
"""Slips or swings of a record, about."""
PULLED = ("coulomb", "stribeck", "lugre", "hess-soom", "track")
STEPPED = ("constant-coefficient", "logarithmic", "rate-and-state", "rate-and-state-slip",
           "rate-and-two-states", "rate-and-state-nagata")  # fmt: skip


def _missed(estimates: Sequence[Estimate], truth: object) -> Iterator[dict[str, Any]]:
    """Yield for each bounded estimate that the truth has too whether its interval holds it."""
    for one in estimates:
        true = getattr(truth, one.path.rpartition(".")[2], None)
        if true is None or not one.bounded or not one.path.startswith("friction."):
            continue
        middle, half = 0.5 * (one.low + one.high), 0.5 * (one.high - one.low)
        yield {
            "path": one.path,
            "true": float(true),
            "said": [one.low, one.high],
            "held": bool(one.low <= true <= one.high),
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
        or any(one["far"] for one in intervals),
    }


def _pulled_law(random: Random, truth: str, level: float, speed: float) -> FrictionLaw:
    static = level * float(random.uniform(1.1, 1.6))
    slow = speed * between(random, 0.3, 10.0)
    if truth == "stribeck":
        return Stribeck(
            kinetic_coefficient=level, static_coefficient=static, stribeck_velocity=slow
        )
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


def pulled(seed: int, number: int) -> dict[str, Any]:
    """Return what a selection says of the force of a spring that pulls a block."""
    random = np.random.default_rng([53, seed, number])
    truth = PULLED[number % len(PULLED)]
    level, mass = between(random, 0.1, 0.6), between(random, 0.02, 2.0)
    natural = between(random, 2.0, 30.0)
    stiffness = mass * (2.0 * math.pi * natural) ** 2
    # falls of the force take 0.1 to 3 of a natural period to build up again
    rise = 0.3 * level * mass * 9.81 / stiffness * natural
    block = TowedBlock(mass=mass, stiffness=stiffness, speed=rise / between(random, 0.1, 3.0))
    law = _pulled_law(random, truth, level, block.speed)
    row: dict[str, Any] = {"seed": seed, "number": number, "truth": truth, "law": repr(law)}
    period = 1.0 / natural + 0.6 * level * mass * 9.81 / (stiffness * block.speed)
    began, end = 10.0 * period, (10.0 + CYCLES) * period
    t = np.arange(began, end, min(0.02 / natural, period / 40.0))
    begun = time.process_time()
    try:
        force = stiffness * (block.speed * t - simulate(block, law, t_end=float(t[-1])).at(t)["x"])
        if truth == "track":  # the level rises and falls by a few per cent as the block goes on
            way = block.speed * (end - began) / float(random.uniform(2.0, 5.0))
            force *= 1.0 + 0.05 * np.sin(2.0 * math.pi * block.speed * t / way)
        force += 0.01 * float(np.std(force)) * random.normal(size=len(t))
        record = Measurement(time=t, spring_force=force)
        begun = time.process_time()
        verdict = select(block, None, record)
    except StickslipError as error:
        return row | {"refused": str(error), "seconds": time.process_time() - begun}
    assert isinstance(verdict, FeatureVerdict)
    seconds = time.process_time() - begun
    best = verdict.best
    assert best is not None
    assert best.fit is not None
    ties = [
        c.name for c in verdict.candidates
        if c is not best and c.fit and not c.dropped and as_good(c.fit, best.fit)
    ]  # fmt: skip
    error = 0.0
    if truth != "track":
        error = math.sqrt(
            np.mean([_apart(block, law, best.fit.law, v, 1.0 / period) ** 2 for v in SPEEDS])
        )
    return _rated(
        row, best.name, ties, hedged=bool(best.doubt or best.dropped), error=error,
        stated=best.score, intervals=[*_missed(() if best.dropped else best.fit.estimates, law)],
    ) | {"verdict": verdict.sentence, "seconds": seconds}  # fmt: skip


def _apart(
    block: TowedBlock, truth: FrictionLaw, law: FrictionLaw, factor: float, frequency: float
) -> float:
    """Return how far features of two laws lie apart at another speed, over those of the first."""
    other = replace(block, speed=factor * block.speed)
    period = max(1.0, 1.0 / factor) / frequency
    one, two = (
        cycle_features(
            other, each, ("mechanism.speed",), np.array([[other.speed]]), period=period, level=0.5
        )[0, 1:]
        for each in (truth, law)
    )
    # mean and spread, which a slider that slides on has too; of the spread what counts of the mean
    return float(np.sqrt(np.mean(((one - two) / abs(one[0])) ** 2)))


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


def stepped(seed: int, number: int) -> dict[str, Any]:
    """Return what a selection says of friction at steps of the speed of a load point."""
    random = np.random.default_rng([59, seed, number])
    truth = STEPPED[number % len(STEPPED)]
    law = _stepped_law(random, truth)
    row: dict[str, Any] = {"seed": seed, "number": number, "truth": truth, "law": repr(law)}
    # well above the stiffness below which the slider runs away
    distance = law.critical_distance or 1e-5
    spare = max(law.evolution_effect + max(law.second_evolution_effect, 0.0), 0.005)
    stiffness = spare / distance * between(random, 2.0, 10.0)
    knots, places = _path(random, int(random.choice((1, 2, 3, 4))))
    t = np.unique(np.concatenate([
        np.linspace(a, b, 250, endpoint=False) for a, b in pairwise(knots.tolist())
    ]))  # fmt: skip
    begun = time.process_time()
    try:
        true = simulate_velocity_steps(law, stiffness=stiffness, time=knots, pull=places, at=t)
        noise = between(random, 1e-4, 1e-3)
        friction = true.coefficient + noise * random.normal(size=len(t))
        record = Measurement(time=t, pull=np.interp(t, knots, places), friction=friction, load=1.0)
        off = between(random, 1.2, 1.4) ** float(random.choice((-1.0, 1.0)))
        machine = TowedBlock(mass=1e-3, stiffness=off * stiffness, speed=1e-6, load=1.0)
        begun = time.process_time()
        verdict = select(machine, None, record)
        assert isinstance(verdict, RateStateVerdict)
        seconds = time.process_time() - begun
        closest = verdict.closest
        assert closest.fit is not None
        fresh = _fresh(knots, places)
        other, own = (
            simulate_velocity_steps(each, stiffness=k, time=fresh[0], pull=fresh[1], at=fresh[2])
            for each, k in ((law, stiffness), (closest.fit.law, closest.fit.stiffness))
        )
    except StickslipError as error:
        return row | {"refused": str(error), "seconds": time.process_time() - begun}
    variation = max(float(np.std(other.coefficient)), noise)
    error = float(np.sqrt(np.mean((other.coefficient - own.coefficient) ** 2))) / variation
    same = closest.name == truth
    rival = [verdict.rival] if verdict.rival else []
    return _rated(
        row, verdict.best.name if verdict.best else "", rival,
        hedged="is closest, but" in verdict.sentence, error=error,
        stated=closest.score / variation,
        intervals=[*_missed(closest.fit.estimates if same else (), _at(law, closest.fit.law))],
    ) | {"verdict": verdict.sentence, "seconds": seconds, "noise": noise}  # fmt: skip


def _at(law: RateState, fitted: RateState) -> RateState:
    """Return a law with the coefficient that it has at the reference speed of another one."""
    slope = law.direct_effect - law.evolution_effect - law.second_evolution_effect
    ratio = math.log(fitted.reference_velocity / law.reference_velocity)
    return replace(
        law,
        reference_coefficient=law.reference_coefficient + slope * ratio,
        reference_velocity=fitted.reference_velocity,
    )


def _fresh(knots: Array, places: Array) -> tuple[Array, Array, Array]:
    """Return times, places and times to look at of a step up that was not made, as large as one."""
    speeds = np.diff(places) / np.diff(knots)
    first, last = float(speeds.min()), float(speeds.max())
    middle = math.sqrt(first * last)
    times = np.concatenate([[0.0], np.cumsum(4e-4 / np.array([middle, last, first]))])
    way = 4e-4 * np.arange(4.0)
    return times, way, np.interp(np.linspace(1.0, 3.0, 400), np.arange(4.0), times)
