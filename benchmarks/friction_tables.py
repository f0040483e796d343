"""Tables of friction at 8 to 12 speeds: do the 95 % intervals of fits hold the true values?

``python -m benchmarks.friction_tables --numbers 0 40 --seed 1 --noise 0.02``; results are appended
to a file line by line. Truths are five laws in turn, or curves that are no law (``--truths
outside``, ``dips``, ``falls``), or a table is in some way bad (``--bad few``). A table is fitted
with its true law, if it has one.
"""

import argparse
import json
import math
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
)
from stickslip.errors import StickslipError

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
    parts = [_stribeck(random, side, speed)[1] for side in sides]
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


def covered(number: int, seed: int, noise: float, **kind: Any) -> dict[str, Any]:
    """Return which 95 % intervals of a fit with the true law hold the true values."""
    row, curve, _, table = drawn(number, seed, noise, **kind)
    if not isinstance(curve, Sliding):
        return row | {"held": []}
    true = curve.law
    try:
        result = fit(AXIS, type(true), table)
    except StickslipError as error:
        return row | {"refused": str(error)}
    held = [
        (
            estimate.path,
            bool(estimate.low <= getattr(true, name) <= estimate.high),
            bool(estimate.bounded),
        )
        for estimate in result.estimates
        if hasattr(true, name := estimate.path.rpartition(".")[2])
        if getattr(true, name) is not None
    ]
    return row | {"held": held}


def coverage(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return how many bounded intervals hold the true value, by parameter and of all."""
    held = [item for row in rows for item in row.get("held", ()) if item[2]]
    lines = []
    for path in [*sorted({item[0] for item in held}), ""]:
        part = [item[1] for item in held if not path or item[0] == path]
        share = sum(part) / max(len(part), 1)
        lines.append(f"{path or 'all'}: {100.0 * share:.1f} % of {len(part)} hold the truth")
    return [*lines, f"{sum('refused' in row for row in rows)} of {len(rows)} tables not fitted"]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.friction_tables")
    parser.add_argument("--numbers", type=int, nargs=2, default=[0, 40])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--noise", type=float, default=0.02, help="share of the friction")
    parser.add_argument("--truths", choices=("candidates", *BEYOND), default="candidates")
    parser.add_argument("--bad", choices=("", *BAD), default="")
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    given = parser.parse_args()
    rows = []
    with given.results.open("a", encoding="utf-8") as file:
        for number in range(*given.numbers):
            rows.append(
                covered(number, given.seed, given.noise, truths=given.truths, bad=given.bad)
            )
            file.write(json.dumps(rows[-1]) + "\n")
            file.flush()
    print("\n".join(coverage(rows)))


if __name__ == "__main__":
    main()
