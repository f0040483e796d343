"""Made-up tables and swings of the study of the posterior, and what a judgement says of them.

Tables here are special in one thing: repeats that share an error, several specimens, rounding,
errors that are stated, rows in the order of the speed, a joint with a model error of 2 % and two
rows at rest, noise as large as friction, or no friction. Swings have pendulums whose length is
given .1 to .3 % off. `benchmarks.band_truths` has all others.
"""

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from benchmarks.band_truths.decays import GRAVITY, OUTSIDE, Body, moved
from benchmarks.band_truths.rig import factor
from benchmarks.band_verdict import told
from stickslip import Axis, Measurement, Pendulum
from stickslip.identify.judgement import Judgement
from stickslip.identify.problems.free_balance import FreeBalance, before_rest, free_form
from stickslip.identify.problems.free_motion import FreeMotionProblem
from stickslip.identify.problems.free_runs import Candidate, Runs
from stickslip.identify.problems.record_signals import records_of
from stickslip.identify.problems.tables import TableProblem
from stickslip.identify.selection import problem_of_records
from stickslip.mechanisms import Mechanism

Array: TypeAlias = NDArray[np.float64]
Random: TypeAlias = np.random.Generator
AXIS = Axis(inertia=1.0)


def judged_table(mechanism: Mechanism, measurement: Measurement) -> Judgement:
    """Return what the posterior says of a table."""
    return Judgement(TableProblem.of(mechanism, measurement))


# ---- special tables


def repeated(random: Random) -> tuple[Measurement, Callable[[Array], Array]]:
    """Return three readings at each speed of a specimen that has its own friction there."""
    v = np.repeat(np.geomspace(0.01, 1.0, 10), 3)
    own = np.repeat(random.normal(1.0, 0.06, 10), 3)
    friction = (5.0 + 3.0 * v) * own * random.normal(1.0, 0.003, 30)
    return Measurement(velocity=v, friction=friction), lambda u: 5.0 + 3.0 * u


def rounded(random: Random) -> tuple[Measurement, Callable[[Array], Array]]:
    """Return readings that were rounded to a tenth."""
    v = np.geomspace(0.01, 1.0, 15)
    friction = np.round(3.0 + 2.0 * v + 0.01 * random.normal(size=15), 1)
    return Measurement(velocity=v, friction=friction), lambda u: 3.0 + 2.0 * u


def specimens(
    random: Random, *, new: bool, fewest: int = 6, most: int = 6
) -> tuple[Measurement, Callable[[Array], Array]]:
    """Return some specimens, and the friction of one of them or of another."""
    v, count = np.geomspace(0.01, 1.0, 8), fewest
    if most > fewest:
        count = int(random.integers(fewest, most + 1))
    factors = random.normal(1.0, 0.05, count + 1)
    shape = 5.0 + 2.0 * np.exp(-((v / 0.05) ** 2)) + 3.0 * v
    trials = tuple(
        Measurement(velocity=v, friction=item * shape * random.normal(1.0, 0.004, 8))
        for item in factors[:count]
    )
    own = factors[count] if new else factors[int(random.integers(count))]
    return (
        Measurement(trials=trials),
        lambda u: own * (5.0 + 2.0 * np.exp(-((u / 0.05) ** 2)) + 3.0 * u),
    )


def of_joint(random: Random) -> tuple[Measurement, Callable[[Array], Array]]:
    """Return a sorted table of a joint: 2 % of model error, and two rows at rest."""
    u = np.geomspace(0.001, 0.3, 40)
    v = np.concatenate([-u[::-1], u])

    def true(v: Array) -> Array:
        own = 1.0 + 0.02 * np.sin(2.1 * np.log(np.abs(v))) + 0.02 * np.sign(v)
        return np.sign(v) * (16.0 + 9.0 * np.abs(v)) * own

    read = true(v) * (1.0 + 0.001 * random.normal(size=80))
    return (
        Measurement(
            velocity=np.concatenate([v, [7e-6, -5e-4]]),
            friction=np.concatenate([read, [3.0, -7.0]]),
        ),
        true,
    )


def ordered(random: Random) -> tuple[Measurement, Callable[[Array], Array]]:
    """Return a table of both directions in the order of the speed, with 1 % of drift in time."""
    u = np.geomspace(0.01, 1.0, 20)
    v = np.concatenate([-u[::-1], u])

    def true(v: Array) -> Array:
        return np.asarray(np.sign(v) * (5.0 + 3.0 * np.exp(-((v / 0.1) ** 2))) + 4.0 * v)

    # measured in random order, filed by speed
    late = 1.0 + 0.01 * random.permutation(np.linspace(-0.5, 0.5, len(v)))
    return Measurement(velocity=v, friction=true(v) * late * random.normal(1.0, 0.004, 40)), true


def with_errors(random: Random) -> tuple[Measurement, Callable[[Array], Array]]:
    """Return readings of which every second has a stated error ten times that of the others."""
    v = np.geomspace(0.01, 1.0, 20)
    error = np.where(np.arange(20) % 2 == 0, 0.003, 0.03) * (5.0 + 3.0 * v)
    friction = 5.0 + 3.0 * v + error * random.normal(size=20)
    table = Measurement(velocity=v, friction=friction, uncertainty={"friction": error})
    return table, lambda u: 5.0 + 3.0 * u


SPECIAL: Mapping[str, Callable[[Random], tuple[Measurement, Callable[[Array], Array]]]] = {
    "repeats": repeated,
    "one of six specimens": partial(specimens, new=False),
    "a new specimen": partial(specimens, new=True),
    "a new one beside 3 to 8 specimens": partial(specimens, new=True, fewest=3, most=8),
    "rounded": rounded,
    "ordered": ordered,
    "stated errors": with_errors,
    "sorted joint": of_joint,
}


@dataclass(frozen=True, kw_only=True)
class Held:
    """How much of the truth lies in the band, and its half-width over friction."""

    inside: float
    width: float


def of_special(name: str, seed: int, count: int) -> list[Held]:
    """Return what bands of special tables hold of the truth."""
    result = []
    for k in range(count):
        table, true = SPECIAL[name](np.random.default_rng([seed, k]))
        judgement = judged_table(AXIS, table)
        rows = judgement.problem.asked()
        band, y = judgement.band(rows, new="new" in name), true(rows.velocity)
        result.append(
            Held(
                inside=float(np.mean((band.low <= y) & (y <= band.high))),
                width=float(np.median((band.high - band.low) / 2.0 / np.abs(y))),
            )
        )
    return result


# ---- tables with noise as large as friction, and tables of noise

LEAST_NOISE, MOST_NOISE = 0.09, 1.0
"""Noise of weak tables over friction."""


def weak(random: Random) -> Measurement:
    """Return 30 to 60 readings of a law in one direction or both, with much noise."""
    count = int(random.integers(30, 61))
    v = np.geomspace(factor(0.003, 0.05, random), 1.0, count)
    v *= random.choice([-1.0, 1.0], count) if random.random() < 0.5 else 1.0
    u, surplus = np.abs(v), random.uniform(0.3, 1.0) * (random.random() < 0.4)
    curve = 1.0 + surplus * np.exp(-((u / 0.1) ** 2)) + random.uniform(0.0, 1.0) * u
    size = factor(LEAST_NOISE, MOST_NOISE, random) * float(np.sqrt(np.mean(curve**2)))
    level = factor(0.01, 100.0, random)
    return Measurement(
        velocity=v, friction=level * (np.sign(v) * curve + size * random.normal(size=count))
    )


def frictionless(random: Random) -> Measurement:
    """Return as many readings of noise about zero."""
    table = weak(random)
    level = factor(0.01, 100.0, random)
    return replace(table, friction=level * random.normal(size=len(np.asarray(table.velocity))))


def is_told(table: Measurement) -> bool:
    """Return whether a table is said to have friction."""
    return told(judged_table(AXIS, table))


# ---- swings whose length is given off

LASTING, RATE, NOISE = 60.0, 50.0, 1e-3
"""Duration [s], samples a second and error of a reading [rad]."""
KEPT = 0.4
"""Last part of a motion that is not shown."""
INSIDE = (
    "level", "viscous", "level viscous", "viscous drag", "level drag", "level viscous drag",
)  # fmt: skip
POWERS = {"level": 0, "viscous": 1, "drag": 2}


@dataclass(frozen=True, kw_only=True)
class Swing:
    """A pendulum that swings out, as it is and as it is told."""

    truth: str
    inside: bool
    """Whether the vocabulary has its law."""
    length: float
    told: Pendulum
    friction: Callable[[float], float]
    """Friction at speeds above 0 [N m]."""
    time: Array
    position: Array

    def record(self, rows: slice = slice(None)) -> Measurement:
        """Return its record, or a part."""
        return Measurement(time=self.time[rows], position=self.position[rows], turning=True)


def swing(number: int, seed: int) -> Swing:
    """Return a swing: laws of the vocabulary in turn, and every second one of none of them."""
    random = np.random.default_rng([77, seed, number])
    inside, half = number % 2 == 0, number // 2
    length, mass, start = (random.uniform(*item) for item in ((0.25, 0.6), (0.3, 2.0), (0.6, 1.0)))
    weight, inertia = mass * length * GRAVITY, mass * length**2
    top = 2.0 * math.sqrt(GRAVITY / length) * math.sin(0.5 * start)
    swings = LASTING / (2.0 * math.pi * math.sqrt(length / GRAVITY))
    # most of the energy is gone at the end, and it still moves
    amount = 0.5 * weight * start / swings * random.uniform(0.3, 0.6)
    if inside:
        truth = INSIDE[half % len(INSIDE)]
        friction = _parts(random, truth, amount, top)
    else:
        truth = [*OUTSIDE][half % len(OUTSIDE)]
        friction = OUTSIDE[truth](amount, top)
    body = Body(inertia=inertia, pull=lambda q: -weight * math.sin(q), level=friction(0.0),
                friction=friction)  # fmt: skip
    t = np.arange(0.0, LASTING, 1.0 / RATE)
    q, _ = moved(body, start, 0.0, t, 0.25 / RATE)
    off = random.uniform(0.001, 0.003) * random.choice([-1.0, 1.0])
    return Swing(
        truth=truth,
        inside=inside,
        length=length,
        told=Pendulum(mass=mass, length=length * (1.0 + off), gravity=GRAVITY),
        friction=friction,
        time=t,
        position=q + NOISE * random.normal(size=len(t)),
    )


def _parts(random: Random, names: str, amount: float, top: float) -> Callable[[float], float]:
    """Return friction over speeds above 0 of parts that share an amount at the top speed."""
    powers = [POWERS[item] for item in names.split()]
    shares = random.dirichlet(np.full(len(powers), 4.0)).tolist()
    known = [(amount * share / top**n, n) for share, n in zip(shares, powers, strict=True)]
    return lambda v: math.fsum(c * v**n for c, n in known)


@dataclass(frozen=True, kw_only=True)
class Swung:
    """What a judgement says of the first part of a swing."""

    truth: str
    inside: bool
    law: str
    held: float
    """Share of speeds at which the true friction lies in the band."""
    width: float
    length: bool
    """Whether the length lies in its interval."""
    ahead: float
    """Root mean square of what a run of the law leaves of the part not shown, over the error of a
    reading."""
    seconds: float

    def __str__(self) -> str:
        return (
            f"{self.truth:22} {self.law:24} band {self.held:.2f} ±{self.width:.1%}, length"
            f" {'in' if self.length else 'out'}, ahead {self.ahead:.2f}, {self.seconds:.1f} s"
        )


def swung(one: Swing) -> Swung:
    """Judge the first part of a swing."""
    shown = int((1.0 - KEPT) * len(one.time))
    began = time.process_time()
    problem = problem_of_records(one.told, records_of(one.told, one.record(slice(shown))))
    assert isinstance(problem, FreeMotionProblem)
    judgement = Judgement(problem)
    band, rows = judgement.band(problem.asked()), problem.asked()
    law, length = judgement.named, problem.rig(judgement.draws)["mechanism.length"]
    seconds = time.process_time() - began
    y = np.sign(rows.velocity) * [one.friction(v) for v in np.abs(rows.velocity).tolist()]
    low, high = np.quantile(length, (0.025, 0.975))
    return Swung(
        truth=one.truth,
        inside=one.inside,
        law="+".join(law.family),
        held=float(np.mean((band.low <= y) & (y <= band.high))),
        width=judgement.known,
        length=bool(low <= one.length <= high),
        ahead=_ahead(problem, judgement, one, shown) / NOISE,
        seconds=seconds,
    )


def _ahead(problem: FreeMotionProblem, judgement: Judgement, one: Swing, shown: int) -> float:
    """Return the root mean square that a run of the law leaves of the part not shown [rad]."""
    law, model = judgement.named, problem.model
    candidate = Candidate(structure=law.structure, coefficients=law.coefficients)
    x = model.linear.x.copy()
    x[model.runs.knots] = 0.0
    result = Runs(model.motion, candidate, alone=True).beside(x)
    if result is None:
        return math.inf
    own = [before_rest(x) for x in records_of(one.told, one.record())]
    motions = FreeBalance(own, free_form(own)).motions
    whole = Runs(replace(model.motion, motions=motions), candidate, alone=True)
    made = whole.run(result.x)
    if made is None:
        return math.inf
    return float(np.sqrt(np.mean(np.square(made[0][shown:]))))
