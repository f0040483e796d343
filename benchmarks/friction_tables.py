"""Tables of friction at 8 to 12 speeds: does a selection name the law, and what it cannot tell?

``python -m benchmarks.friction_tables --numbers 0 40 --seed 1 --noise 0.02``; results are appended
to a file line by line. Truths are five of the candidates in turn, or laws that are none of them
(``--truths outside``, ``dips``, ``falls``), or a table that is in some way bad (``--bad few``). A
verdict is *right* if it names the truth, or a law that predicts the true curve within the noise and
is said not to be told from the truth, or says that the truth explains the table with one row in
error or a drift; of a truth that is no candidate, if the prediction is within the noise, or a curve
that is no law is said to come closer. It is a *false certainty* if it
recommends another law, mentions neither the truth nor such a curve, and predicts worse than the
noise. How often such a curve is said to be possible where the law is right, is counted too.
``--fits`` judges the 95 % intervals of fits with the true law instead, and selects nothing.
"""

import argparse
import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from benchmarks.rigs import Array, Random, between
from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    DirectionDependent,
    FrictionLaw,
    Measurement,
    PowerViscous,
    Stribeck,
    fit,
    select,
)
from stickslip.errors import StickslipError
from stickslip.friction import law
from stickslip.kinds.records.verdict import RecordVerdict

RESULTS = "friction_tables.jsonl"
AXIS = Axis(inertia=1.0)
Curve: TypeAlias = Callable[[Array], Array]
BAD = (
    "few", "sparse", "repeats", "decades", "outlier", "understated", "overstated", "falling",
    "frictionless", "drifting", "shuffled",
)  # fmt: skip
"""Tables of five speeds; of 8 to 12 readings in both directions together; of speeds that are
measured once to three times; over four decades; with one reading that is wrong by ten times the
noise; with a stated uncertainty three times too small or too large; of the falling branch of a
Stribeck curve alone; of noise alone; of friction that drifts by 5 to 20 % from the first reading to
the last, in the order of the speeds or in any order; of nothing bad, in any order."""


@dataclass(frozen=True)
class Sliding:
    """The friction of a law over the speed."""

    law: FrictionLaw

    def __call__(self, v: Array) -> Array:
        """Return friction [N] at speeds (n,)."""
        return np.asarray(self.law.force(v, np.ones(len(v))), dtype=float)


def _coulomb(_: Random, level: float, __: float) -> tuple[str, Curve]:
    return "coulomb", Sliding(Coulomb(kinetic_coefficient=level))


def _viscous(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    slope = level / speed * between(random, 0.3, 3.0)
    one = CoulombViscous(kinetic_coefficient=level, viscous_coefficient=slope)
    return "coulomb-viscous", Sliding(one)


def _stribeck(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    one = Stribeck(
        kinetic_coefficient=level,
        static_coefficient=level * float(random.uniform(1.3, 2.0)),
        stribeck_velocity=between(random, 0.08, 0.25) * speed,
        viscous_coefficient=level / speed * float(random.uniform(0.2, 1.0)),
    )
    return "stribeck", Sliding(one)


def _power(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    n = float(random.uniform(0.35, 0.6))
    one = PowerViscous(
        kinetic_coefficient=level * float(random.choice([0.0, 0.3, 1.0])),
        viscous_coefficient=level / speed**n * float(random.uniform(1.0, 3.0)),
        viscous_exponent=n,
    )
    return "power-viscous", Sliding(one)


def _directional(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    sides = [level, level * float(random.uniform(1.2, 1.7))]
    if random.random() < 0.5:
        slopes = [level / speed * between(random, 0.3, 1.5) for _ in sides]
        one: FrictionLaw = DirectionDependent(
            forward_kinetic_coefficient=sides[0],
            backward_kinetic_coefficient=sides[1],
            forward_viscous_coefficient=slopes[0],
            backward_viscous_coefficient=slopes[1],
        )
        return "direction-dependent", Sliding(one)
    parts = [_stribeck(random, one, speed)[1] for one in sides]
    return "directional-stribeck", lambda v: np.where(v > 0.0, parts[0](v), parts[1](v))


def _tanh(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    s, slope = between(random, 0.05, 0.3) * speed, 0.3 * level / speed
    return "", lambda v: level * np.tanh(v / s) + slope * v


def _logarithmic(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    s, share = 0.01 * speed, float(random.uniform(0.05, 0.3))
    return "", lambda v: level * np.sign(v) * (1.0 + share * np.log1p(np.abs(v) / s))


def _eyring(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    s = between(random, 0.01, 0.3) * speed
    return "", lambda v: level * np.arcsinh(v / s)


def _mixed(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    """A film takes over the load from dry contact, and shears as a power of the speed."""
    s, steep = between(random, 0.05, 0.4) * speed, float(random.uniform(1.0, 4.0))
    n, film = float(random.uniform(0.4, 1.0)), level * float(random.uniform(0.4, 1.2))

    def curve(v: Array) -> Array:
        dry = 1.0 / (1.0 + (np.abs(v) / s) ** steep)
        return np.sign(v) * (level * dry + film * (np.abs(v) / speed) ** n * (1.0 - dry))

    return "", curve


def _bowl(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    """A parabola over the logarithm of the speed."""
    s, depth = between(random, 0.1, 0.5) * speed, float(random.uniform(0.05, 0.25))
    return "", lambda v: level * np.sign(v) * (0.5 + depth * np.log(np.abs(v) / s) ** 2)


def _kinked(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    """Friction that falls with the logarithm of the speed, and rises with the speed beyond."""
    s, fall = between(random, 0.1, 0.5) * speed, float(random.uniform(0.1, 0.25))
    rise = float(random.uniform(0.3, 1.5))

    def curve(v: Array) -> Array:
        u = np.abs(v) / s
        beyond = rise * s / speed * np.maximum(u - 1.0, 0.0)
        return level * np.sign(v) * (0.5 + fall * np.maximum(-np.log(u), 0.0) + beyond)

    return "", curve


def _fading(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    s, rest = between(random, 0.03, 0.5) * speed, float(random.uniform(0.2, 0.7))
    return "", lambda v: level * np.sign(v) * (rest + (1.0 - rest) / (1.0 + np.abs(v) / s))


def _weakening(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    s, fall = 0.02 * speed, float(random.uniform(0.05, 0.2))
    return "", lambda v: level * np.sign(v) * (1.0 - fall * np.log1p(np.abs(v) / s))


def _thinning(random: Random, level: float, speed: float) -> tuple[str, Curve]:
    n = float(random.uniform(0.1, 0.5))
    return "", lambda v: level * np.sign(v) * (np.abs(v) / speed) ** -n


TRUTHS = (_coulomb, _viscous, _stribeck, _power, _directional)
BEYOND = {
    "outside": (_tanh, _logarithmic, _eyring),
    "dips": (_mixed, _bowl, _kinked),
    "falls": (_fading, _weakening, _thinning),
}
"""Truths that are no candidates, by what they have in common."""


def _speeds(random: Random, speed: float, count: int, *, sides: int, decades: float) -> Array:
    """Return speeds (count,) [m/s]: evenly spaced, in ratios, or drawn."""
    number = count // sides
    kind = "ratios" if decades > 1.5 else random.choice(["even", "ratios", "drawn"])
    low = 10.0**-decades
    if kind == "even":
        one = np.linspace(1.0 / number, 1.0, number)
    elif kind == "ratios":
        one = np.geomspace(low, 1.0, number)
    else:
        one = np.sort(np.exp(random.uniform(math.log(low), 0.0, number)))
        one[-1] = 1.0
    return speed * (one if sides == 1 else np.concatenate([-one[::-1], one]))


def drawn(
    number: int, seed: int, noise: float, *, truths: str = "candidates", bad: str = ""
) -> tuple[dict[str, Any], Curve, Array, Measurement]:
    """Return what a table is of, the true curve, the noise at its speeds, and the table."""
    random = np.random.default_rng([41, seed, number])
    level, speed = between(random, 0.1, 1000.0), between(random, 0.01, 1.0)
    among = BEYOND.get(truths, TRUTHS)
    make = _stribeck if bad == "falling" else among[number % len(among)]
    truth, curve = make(random, level, speed)
    sides = 2 if make is _directional else int(random.integers(1, 3))
    count = 5 if bad == "few" else int(random.integers(8, 13))
    # of both directions together, or of each
    count = sides * (count // sides if bad == "sparse" else count)
    sides = 1 if bad in {"few", "falling"} and make is not _directional else sides
    v = _speeds(random, speed, count, sides=sides, decades=4.0 if bad == "decades" else 1.3)
    if bad == "repeats":
        v = np.repeat(v, random.integers(1, 4, len(v)))
    if bad == "falling":
        v = 0.25 * v
    if bad == "frictionless":
        truth, curve = "", lambda v: 0.0 * v
    f = curve(v)
    # of each reading, or the same at all speeds
    size = noise * (np.abs(f) if random.random() < 0.5 else np.full(len(f), np.abs(f).mean()))
    size = np.full(len(f), 0.02 * level) if bad == "frictionless" else size
    f = f + size * random.normal(size=len(f))
    if bad == "outlier":
        f[int(random.integers(len(f)))] += 10.0 * size.mean() * random.choice([-1.0, 1.0])
    if bad == "drifting":
        order = np.arange(len(v)) if random.random() < 0.5 else random.permutation(len(v))
        drift = float(random.uniform(0.05, 0.2) * random.choice([-1.0, 1.0]))
        v, f, size = v[order], f[order] * np.linspace(1.0, 1.0 + drift, len(v)), size[order]
    if bad == "shuffled":
        order = random.permutation(len(v))
        v, f, size = v[order], f[order], size[order]
    table = Measurement(velocity=v, friction=f, load=1.0)
    if bad in {"understated", "overstated"}:
        stated = size.mean() * (3.0 if bad == "overstated" else 1.0 / 3.0)
        table = replace(table, uncertainty={"friction": float(stated)})
    return {"number": number, "seed": seed, "noise": noise, "truth": truth,
            "kind": make.__name__.strip("_")}, curve, size, table  # fmt: skip


def _names(truth: str) -> set[str]:
    """Return names that a truth has as a candidate."""
    if truth == "directional-stribeck":
        return {law("both_ways(level + stribeck + viscous)").name, truth}
    return {truth} if truth else set()


def rated(
    verdict: RecordVerdict, row: Mapping[str, Any], curve: Curve, size: Array, table: Measurement
) -> dict[str, Any]:
    """Return whether a verdict is right, or a false certainty."""
    closest = verdict.closest
    assert closest.fit is not None
    named = closest.name in _names(row["truth"])
    tied = bool(_names(row["truth"]) & {*verdict.equals})
    v = np.asarray(table.velocity)
    sides = [one for one in (v[v < 0.0], v[v > 0.0]) if len(one)]
    fine = np.concatenate([np.interp(np.linspace(0, len(one) - 1, 60), np.arange(len(one)), one)
                           for one in map(np.sort, sides)])  # fmt: skip
    predicted = np.asarray(closest.fit.law.force(fine, np.ones(len(fine)))) + closest.fit.offset
    order = np.argsort(v)
    doubt = np.interp(fine, v[order], size[order])
    error = float(np.sqrt(np.mean(((predicted - curve(fine)) / np.maximum(doubt, 1e-300)) ** 2)))
    close = error <= 1.0
    other = tied or not row["truth"]
    if_drift = bool(_names(row["truth"]) & {*closest.otherwise})
    right = named or if_drift or (other and (close or closest.curve is not None))
    return {
        "named": closest.name,
        "error": error,
        "right": right,
        "false": verdict.best is not None and not (named or tied or close or closest.curve),
        "none": verdict.best is None,
        "curve": closest.curve is not None,
        "drift": any("drift" in said for said in closest.otherwise.values())
        or any(one.kind == "drift" for one in verdict.model_errors),
        "verdict": verdict.sentence,
    }


def judged(number: int, seed: int, noise: float, **kind: Any) -> dict[str, Any]:
    """Return what a selection says of a table."""
    row, curve, size, table = drawn(number, seed, noise, **kind)
    began = time.process_time()
    try:
        verdict = select(AXIS, None, table)
    except StickslipError as error:
        return row | {"refused": str(error), "seconds": time.process_time() - began}
    assert isinstance(verdict, RecordVerdict)
    seconds = time.process_time() - began
    return row | rated(verdict, row, curve, size, table) | {"seconds": seconds}


def covered(number: int, seed: int, noise: float, **kind: Any) -> dict[str, Any]:
    """Return which 95 % intervals of a fit with the true law hold the true values."""
    row, curve, _, table = drawn(number, seed, noise, **kind)
    if not isinstance(curve, Sliding):
        return row | {"held": []}
    true = curve.law
    try:
        found = fit(AXIS, type(true), table)
    except StickslipError as error:
        return row | {"refused": str(error)}
    held = [
        (one.path, bool(one.low <= getattr(true, name) <= one.high), bool(one.bounded))
        for one in found.estimates
        if hasattr(true, name := one.path.rpartition(".")[2])
        if getattr(true, name) is not None
    ]
    return row | {"held": held}


def coverage(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return how many bounded intervals hold the true value, by parameter and of all."""
    held = [one for row in rows for one in row.get("held", ()) if one[2]]
    lines = []
    for path in [*sorted({one[0] for one in held}), ""]:
        part = [one[1] for one in held if not path or one[0] == path]
        share = sum(part) / max(len(part), 1)
        lines.append(f"{path or 'all'}: {100.0 * share:.1f} % of {len(part)} hold the truth")
    return [*lines, f"{sum('refused' in row for row in rows)} of {len(rows)} tables not fitted"]


def summary(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return a line for each table that is not right, and the numbers of all."""
    known = [row for row in rows if "refused" not in row]
    lines = [
        f"{row['number']:3} {row['kind']:12} {row['named']:30} error {row['error']:6.2f}"
        f" {'FALSE' if row['false'] else '     '} {row['verdict']}"
        for row in known
        if not row["right"]
    ]
    lines += [f"{row['number']:3} {row['kind']:12} {row['refused']}" for row in rows
              if "refused" in row]  # fmt: skip
    right, false, none = (sum(row[key] for row in known) for key in ("right", "false", "none"))
    drift = sum(row["drift"] for row in known)
    spare = sum(row["curve"] and row["error"] <= 1.0 for row in known)
    error = np.median([row["error"] for row in known])
    return [
        *lines,
        f"{right} of {len(rows)} right, {false} false certainties, {none} without a law,"
        f" another curve said {sum(row['curve'] for row in known)}, {spare} of them of a law within"
        f" the noise, a drift said {drift}, median error over the noise {error:.2f},"
        f" {sum(row['seconds'] for row in rows):.0f} s",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.friction_tables")
    parser.add_argument("--numbers", type=int, nargs=2, default=[0, 40])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--noise", type=float, default=0.02, help="share of the friction")
    parser.add_argument("--truths", choices=("candidates", *BEYOND), default="candidates")
    parser.add_argument("--bad", choices=("", *BAD), default="")
    parser.add_argument("--fits", action="store_true", help="intervals of fits with the true law")
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    given = parser.parse_args()
    judge, rows = covered if given.fits else judged, []
    with given.results.open("a", encoding="utf-8") as file:
        for number in range(*given.numbers):
            rows.append(
                judge(
                    number,
                    given.seed,
                    given.noise,
                    truths=given.truths,
                    bad=given.bad,
                )
            )
            file.write(json.dumps(rows[-1]) + "\n")
            file.flush()
    print("\n".join(coverage(rows) if given.fits else summary(rows)))


if __name__ == "__main__":
    main()
