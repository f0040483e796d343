"""What the posterior says of truths that are known, and of records of which a part is kept.

``python -m benchmarks.posterior tables --seed 1 --count 40`` draws `benchmarks.band_truths`
and prints how often the band holds the true curve (inside the vocabulary and outside, within the
measured speeds and beyond), its half-width over the noise, and whether the law is right, or off by
less than half the noise. ``special`` has tables whose repeats share an error, of several specimens,
rounded, with stated errors, of a real joint, and whose directions differ. ``records`` judges the
later part of measured records (`benchmarks.second_records`) and prints the share of its readings in
their band, the half-width of that over the error, and the error beside Coulomb + viscous.
``swings`` has pendulums whose length is given .1 to .3 % off.
"""

import argparse
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from benchmarks.band_truths import tables as truths
from benchmarks.band_truths.rig import Rig
from benchmarks.second_records import Pair, pairs
from stickslip import Axis, CoulombViscous, Measurement, Pendulum, QuadraticDrag, simulate
from stickslip.identify.fits import goes_straight, load_of
from stickslip.identify.forces import with_gear
from stickslip.identify.judgement import Judgement
from stickslip.identify.posterior import Family
from stickslip.identify.problems.free_motion import FreeMotionProblem
from stickslip.identify.problems.record_signals import Record, records_of
from stickslip.identify.problems.records import RecordProblem
from stickslip.identify.problems.tables import TableProblem
from stickslip.identify.selection import problem_of_records
from stickslip.mechanisms import Mechanism

Array = NDArray[np.float64]
AXIS = Axis(inertia=1.0)
PLAIN: Sequence[Family] = [("level", "offset", "viscous")]
"""Coulomb + viscous."""


def judged_table(mechanism: Mechanism, measurement: Measurement) -> Judgement:
    """Return what the posterior says of a table."""
    return Judgement(TableProblem.of(mechanism, measurement))


def records_for(
    mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str]
) -> list[Record]:
    """Return the records of a measurement, with what is looked for."""
    held = all(not goes_straight(one, "zero") for one in measurement.records())
    return records_of(mechanism, with_gear(mechanism, measurement), unknown=unknown, held=held)


# ---- tables whose truth is known


def rated(rig: Rig) -> dict[str, float] | None:
    """Return what the judgement of a table is worth; None where nothing is asked of it."""
    if not rig.curves or rig.asked is None or rig.noise is None:
        return None
    began = time.process_time()
    judgement = judged_table(rig.mechanism, rig.measurement)
    named = judgement.named
    seconds = time.process_time() - began
    found = {"inside": float(rig.inside), "seconds": seconds}
    for where, points in (("point", rig.asked), ("beyond", rig.beyond)):
        if points is None:
            continue
        rows = judgement.problem.at(points.velocity, points.load, points.inputs or None)
        band = judgement.band(rows)
        true = [curve(points) for curve in rig.curves]
        found[where] = float(np.mean([(band.low <= y) & (y <= band.high) for y in true]))
        if where == "point":
            noise = np.maximum(rig.noise(points), 1e-300)
            found["width"] = float(np.mean((band.high - band.low) / 2.0 / noise))
            law = judgement.curve_of(named, rows)
            errors = [np.sqrt(np.mean(((law - y) / noise) ** 2)) for y in [*true, np.mean(true, 0)]]
            best = 0.0
            if rig.fitted is not None:
                best = float(np.sqrt(np.mean(((rig.fitted(points) - true[0]) / noise) ** 2)))
            found["equal"] = float(min(errors) <= max(1.25 * best, 0.5))
    if rig.family is not None:
        family = {x for x in rig.family if x != "run"}
        found["right"] = float({*named.family} == family)
    return found


def of_tables(seed: int, count: int) -> Iterator[str]:
    """Yield the numbers of drawn tables."""
    rows = [one for k in range(count) if (one := rated(truths.drawn(k, seed))) is not None]
    yield f"{len(rows)} tables, seed {seed}"
    for inside, name in ((1.0, "inside"), (0.0, "outside")):
        own = [one for one in rows if one["inside"] == inside]
        if not own:
            continue

        def mean(key: str, rows: Sequence[Mapping[str, float]] = own) -> float:
            return float(np.mean([one[key] for one in rows if key in one]))

        widths = float(np.median([one["width"] for one in own]))
        equal = [one["equal"] or one.get("right", 0.0) for one in own]
        yield (
            f"{name:8} band {mean('point'):.3f}, beyond {mean('beyond'):.3f}, width over noise"
            f" {widths:.2f}, right {mean('right'):.2f}, right or equal {np.mean(equal):.2f}"
        )
    yield f"processor time {np.median([one['seconds'] for one in rows]):.2f} s"


def repeated(random: np.random.Generator) -> tuple[Measurement, Callable[[Array], Array]]:
    """Return three readings at each speed of a specimen that has its own friction there."""
    v = np.repeat(np.geomspace(0.01, 1.0, 10), 3)
    own = np.repeat(random.normal(1.0, 0.06, 10), 3)
    friction = (5.0 + 3.0 * v) * own * random.normal(1.0, 0.003, 30)
    return Measurement(velocity=v, friction=friction), lambda u: 5.0 + 3.0 * u


def rounded(random: np.random.Generator) -> tuple[Measurement, Callable[[Array], Array]]:
    """Return readings that were rounded to a tenth."""
    v = np.geomspace(0.01, 1.0, 15)
    friction = np.round(3.0 + 2.0 * v + 0.01 * random.normal(size=15), 1)
    return Measurement(velocity=v, friction=friction), lambda u: 3.0 + 2.0 * u


def specimens(
    random: np.random.Generator, *, new: bool
) -> tuple[Measurement, Callable[[Array], Array]]:
    """Return six specimens, and the friction of one of them or of another."""
    v = np.geomspace(0.01, 1.0, 8)
    factors = random.normal(1.0, 0.05, 7)
    shape = 5.0 + 2.0 * np.exp(-((v / 0.05) ** 2)) + 3.0 * v
    trials = tuple(
        Measurement(velocity=v, friction=one * shape * random.normal(1.0, 0.004, 8))
        for one in factors[:6]
    )
    own = factors[6] if new else factors[int(random.integers(6))]
    return (
        Measurement(trials=trials),
        lambda u: own * (5.0 + 2.0 * np.exp(-((u / 0.05) ** 2)) + 3.0 * u),
    )


def of_joint(random: np.random.Generator) -> tuple[Measurement, Callable[[Array], Array]]:
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


def of_special(seed: int, count: int) -> Iterator[str]:
    """Yield how often bands of special tables hold the truth."""
    kinds = {
        "repeats": repeated,
        "rounded": rounded,
        "one of six specimens": partial(specimens, new=False),
        "a new specimen": partial(specimens, new=True),
        "a joint": of_joint,
    }
    for name, made in kinds.items():
        held, widths, laws = [], [], list[str]()
        for k in range(count):
            table, true = made(np.random.default_rng([seed, k]))
            judgement = judged_table(AXIS, table)
            rows = judgement.problem.asked()
            band = judgement.band(rows, new="new" in name)
            y = true(rows.velocity)
            held.append(np.mean((band.low <= y) & (y <= band.high)))
            widths.append(np.median((band.high - band.low) / 2.0 / np.abs(y)))
            laws.append("+".join(judgement.named.family))
        most = max(set(laws), key=laws.count)
        yield (
            f"{name:22} inside {np.mean(held):.3f}, half-width {np.median(widths):.1%},"
            f" {most} in {laws.count(most)} of {count}"
        )


# ---- measured records, of which the later part is kept


def of_pair(pair: Pair) -> Iterator[str]:
    """Yield how another record of a machine lies in the band of its first."""
    first = records_for(pair.mechanism, pair.first, pair.unknown)
    began = time.process_time()
    judgement = Judgement(problem_of_records(pair.mechanism, first, vary=pair.unknown))
    problem = judgement.problem
    assert isinstance(problem, RecordProblem)
    law = "+".join(judgement.named.family)
    seconds = time.process_time() - began
    plain = problem_of_records(pair.mechanism, first, vary=pair.unknown, families=PLAIN)
    yield (
        f"{pair.name}: {law} within {judgement.named.distance:.1%}, steady ±{judgement.known:.1%},"
        f" {seconds:.1f} s"
    )
    for path, x in problem.rig(judgement.draws).items():
        low, high = np.quantile(x, (0.025, 0.975))
        yield f"    {path} {low:.4g} to {high:.4g}"
    for name, other in pair.others.items():
        again = records_for(pair.mechanism, other, pair.unknown)
        rows = problem.like(again)
        band, y = judgement.reading_band(rows), rows.response
        error = float(np.sqrt(np.mean((band.median - y) ** 2)))
        inside = float(np.mean((band.low <= y) & (y <= band.high)))
        ratio = float(np.median(band.high - band.low)) / 2.0 / error
        less = Judgement(plain).reading_band(plain.like(again))
        usual = float(np.sqrt(np.mean((less.median - plain.like(again).response) ** 2)))
        yield (
            f"    {name}: {inside:.3f} inside, half-width over error {ratio:.2f}, error {error:.3g}"
            f" ({usual:.3g} with Coulomb + viscous)"
        )


def of_records(only: str) -> Iterator[str]:
    """Yield the numbers of all measured records whose names begin so."""
    for pair in pairs():
        if pair.name.startswith(only):
            yield from of_pair(pair)


# ---- swings


def of_swings(seed: int, count: int) -> Iterator[str]:
    """Yield how swings are stated whose length is given .1 to .3 % off."""
    laws = (
        CoulombViscous(kinetic_coefficient=0.004, viscous_coefficient=0.003),
        QuadraticDrag(
            kinetic_coefficient=0.002, viscous_coefficient=0.002, quadratic_coefficient=0.002
        ),
    )
    t = np.arange(0.0, 30.0, 0.02)
    for k in range(count):
        random = np.random.default_rng([seed, k])
        length, law = float(random.uniform(0.25, 0.4)), laws[k % 2]
        arm = Pendulum(mass=1.0, length=length)
        begin = {"theta": float(random.uniform(0.6, 1.0))}
        run = simulate(arm, law, t_end=30.0, y0=begin)
        read = run.at(t)["theta"] + 1e-3 * random.normal(size=len(t))
        given = replace(arm, length=length * (1.0 + 0.002 * random.choice([-1.0, 1.0])))
        records = records_of(given, Measurement(time=t, position=read, turning=True))
        began = time.process_time()
        problem = problem_of_records(given, records)
        assert isinstance(problem, FreeMotionProblem)
        judgement = Judgement(problem)
        rows = problem.asked()
        band = judgement.band(rows)
        load = load_of(given)
        y = np.array([float(law.force(v, load)) for v in rows.velocity.tolist()])
        held = float(np.mean((band.low <= y) & (y <= band.high)))
        low, high = np.quantile(problem.rig(judgement.draws)["mechanism.length"], (0.025, 0.975))
        left = problem.followed(judgement.named)
        yield (
            f"{law.title:26} {'+'.join(judgement.named.family):24} band {held:.2f}"
            f" ±{judgement.known:.1%}, length {'in' if low <= length <= high else 'out'}"
            f" ±{(high - low) / 2.0 / length:.1e}, run {1e3 * left.typical:.2f} mrad,"
            f" {time.process_time() - began:.1f} s"
        )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the numbers of what is asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.posterior")
    kinds = ("tables", "special", "records", "swings")
    parser.add_argument("kinds", nargs="*", choices=[[], *kinds], default=[*kinds])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--only", default="", help="beginning of the names of records")
    given = parser.parse_args(arguments)
    every: Mapping[str, Iterator[str]] = {
        "tables": of_tables(given.seed, given.count),
        "special": of_special(given.seed, given.count),
        "records": of_records(given.only),
        "swings": of_swings(given.seed, given.count),
    }
    for kind in given.kinds:
        for line in every[kind]:
            print(line, flush=True)
