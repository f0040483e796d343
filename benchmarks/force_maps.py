"""Records of measured friction with a faulty force channel: what does a selection say of them?

``python -m benchmarks.force_maps --numbers 0 30``; results are appended to a file line by line.

Each record is made up: a law, a motion, sampling, noise, and one of these: nothing else, a delay of
5 to 50 ms, a first-order lag of 5 to 20 ms, an offset that drifts by 20 to 60 % of the level, a
level that falls with a temperature that is recorded, 10 forces far off.

A record is *right* if what is wrong with its force channel is found, alone or in a group with
presliding or another late channel, and nothing else; *wrong* if a finding names something else, or
if there is a memory where the truth has none and no finding says that a late channel may be meant.
"""

import argparse
import json
import math
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import lfilter

from benchmarks.faults import explained
from benchmarks.finding_kinds import parts_of
from benchmarks.rigs import Array, Random, between
from stickslip import Axis, CoulombViscous, Dahl, FrictionLaw, Measurement, Stribeck
from stickslip.friction import law as composed
from stickslip.identification.estimation.bristle_integration import Path as Motion
from stickslip.identification.estimation.bristle_integration import follow

RESULTS = "force_maps.jsonl"
FINE = 10
"""Samples of the true motion for each one of the record."""
FAULTS = ("none", "delay", "lag", "drift", "temperature", "outliers")
EITHER = "delay or presliding"
NAMED = {
    "delay": ("delay", "late or elastic", EITHER),
    "lag": ("lag", "delay", "late or elastic", EITHER),
    "drift": ("drift of the offset",),
    "outliers": ("outliers",),
}
"""Kinds of findings that name a fault; nothing else may be named."""
HARMLESS = ("law", "unexplained", "outliers")
"""Kinds of findings that name no fault, or one that is left out."""
TRUTHS = ("coulomb-viscous", "stribeck", "dahl")
MOTIONS = ("sine", "sines", "strokes", "moves")
AXIS = Axis(inertia=1.0)


def _law(name: str, random: Random, level: float, speed: float, stroke: float) -> FrictionLaw:
    viscous = level / speed * float(random.uniform(0.1, 1.0))
    if name == "coulomb-viscous":
        return CoulombViscous(kinetic_coefficient=level, viscous_coefficient=viscous)
    if name == "stribeck":
        return Stribeck(
            kinetic_coefficient=level,
            static_coefficient=level * float(random.uniform(1.2, 1.6)),
            stribeck_velocity=between(random, 0.03, 0.2) * speed,
            viscous_coefficient=viscous,
        )
    return Dahl(
        kinetic_coefficient=level,
        bristle_stiffness=level / (between(random, 2e-3, 2e-2) * stroke),
        viscous_coefficient=viscous,
    )


def _position(kind: str, random: Random, t: Array, speed: float) -> Array:
    """Return positions [m] of a motion whose speed is about the one given."""
    w = 2.0 * math.pi * float(random.uniform(0.3, 1.0))
    if kind == "sine":
        return speed / w * np.sin(w * t + 1.0)
    if kind == "sines":
        rates = w * np.array([1.0, *random.uniform(0.3, 3.0, 2)])
        parts = [np.sin(r * t + p) / r for r, p in zip(rates, random.uniform(0, 6, 3), strict=True)]
        return 0.5 * speed * np.sum(parts, axis=0)
    step = float(t[1] - t[0])
    phase = (w * t / (2.0 * math.pi)) % 1.0
    if kind == "strokes":  # constant speeds with ramps between them
        ramp = float(random.uniform(0.02, 0.1))
        v = np.clip(np.sin(2.0 * math.pi * phase) / (2.0 * math.pi * ramp), -1.0, 1.0)
    else:  # moves with holds between them, of random speeds
        number = np.floor(w * t / math.pi).astype(int)
        speeds = random.uniform(0.2, 1.0, number.max() + 1)
        half = (w * t / math.pi) % 1.0
        v = (
            speeds[number]
            * np.where(number % 2, -1.0, 1.0)
            * np.maximum(np.sin(math.pi * (half * 1.4)), 0.0)
            * (half < 1 / 1.4)
        )
    return speed * np.cumsum(v) * step


def _friction(law: FrictionLaw, t: Array, x: Array, v: Array, random: Random) -> Array:
    load = np.ones(len(t))
    if law.states:
        path = Motion(time=t, velocity=v, load=load, travel=np.diff(x))
        z = follow(law, path, np.zeros((1, 1)))[..., 0]
        return np.asarray(law.force(v, load, tuple(z)))
    sign = np.sign(v) * (np.abs(v) > 1e-9)
    moving = np.asarray(law.force(np.where(sign == 0.0, 1.0, v), load))
    rest = sign == 0.0
    began = np.cumsum(np.diff(rest.astype(int), prepend=0) == 1)
    held = random.uniform(-0.9, 0.9, int(began.max(initial=0)) + 1)
    return np.where(rest, held[began] * float(law.break_away(1.0)), moving)


def drawn(number: int, seed: int) -> tuple[dict[str, Any], FrictionLaw, Measurement, Measurement]:
    """Return what a record is of, the true law, the record, and one of a sound force channel.

    That is of another motion under the same law.
    """
    random = np.random.default_rng([seed, number])
    fault = FAULTS[number % len(FAULTS)]
    truth = TRUTHS[number // len(FAULTS) % 3]
    motion = MOTIONS[int(random.integers(4))]
    level, speed = between(random, 0.1, 1000.0), between(random, 0.005, 0.5)
    rate = float(random.choice((100.0, 250.0, 1000.0)))
    fine = np.arange(0.0, 16.0, 1.0 / (FINE * rate))
    x = _position(motion, random, fine, speed)
    law = _law(truth, random, level, speed, float(np.ptp(x)))
    row = {
        "number": number,
        "seed": seed,
        "fault": fault,
        "truth": truth,
        "motion": motion,
        "rate": rate,
    }
    size, record = _recorded(law, level, fine, x, fault, random)
    other = _position(MOTIONS[int(random.integers(4))], random, fine, speed)
    sound = "temperature" if fault == "temperature" else "none"
    _, fresh = _recorded(law, level, fine, other, sound, random, size)
    return row | {"size": size}, law, record, fresh


def _recorded(
    law: FrictionLaw,
    level: float,
    fine: Array,
    x: Array,
    fault: str,
    random: Random,
    size: float = 0.0,
) -> tuple[float, Measurement]:
    """Return the size of a fault, drawn where none is given, and a record with it."""
    step = float(fine[1] - fine[0])
    f = _friction(law, fine, x, np.gradient(x, step), random)
    if fault == "delay":
        size = between(random, 0.005, 0.05)
        f = np.interp(fine - size, fine, f)
    elif fault == "lag":
        size = between(random, 0.005, 0.02)
        a = math.exp(-step / size)
        f = lfilter([1.0 - a], [1.0, -a], f)
    elif fault == "drift":
        size = float(random.uniform(0.2, 0.6) * random.choice((-1.0, 1.0)))
        f = f + size * level * fine / 16.0
    warm = 20.0 + 15.0 * (1.0 - np.exp(-fine / 5.0))
    if fault == "temperature":
        size = size or float(random.uniform(0.005, 0.015))
        f = f * (1.0 - size * (warm - 20.0))
    t, x, f = fine[::FINE], x[::FINE], f[::FINE]
    f = f + 0.02 * level * random.normal(size=len(t))
    x = x + float(10.0 ** random.uniform(-6.0, -4.5)) * float(np.ptp(x)) * random.normal(
        size=len(t)
    )
    if fault == "outliers":
        size = float(random.uniform(2.0, 10.0))
        rows = random.choice(len(f), 10, replace=False)
        f[rows] += size * level * random.choice((-1.0, 1.0), 10)
    measured = {"temperature": warm[::FINE]} if fault == "temperature" else {}
    return size, Measurement(time=t, position=x, friction=f, load=1.0, inputs=measured)


def verdict_of(row: Mapping[str, Any]) -> str:
    """Return "right", "wrong" or "nothing" for what the force balance says of a record."""
    kinds = [kind for kind in row["kinds"] if kind not in HARMLESS]
    right = {*NAMED.get(row["fault"], ()), *([EITHER] if row["truth"] == "dahl" else [])}
    memory = "memory" in row["terms"] and row["truth"] != "dahl"
    if any(not parts_of(kind) & right for kind in kinds) or (memory and EITHER not in kinds):
        return "wrong"
    if row["fault"] == "temperature":
        return "right" if "temperature" in row["terms"] else "nothing"
    if row["fault"] in ("none", "outliers"):
        return "right"
    return "right" if any(parts_of(k) & {*NAMED[row["fault"]]} for k in kinds) else "nothing"


def explained_of(number: int, seed: int) -> dict[str, Any]:
    """Return what the force balance alone says of a record."""
    row, _, record, _ = drawn(number, seed)
    row |= explained(AXIS, record, (), NAMED.get(row["fault"], ()))
    return row | {"verdict": verdict_of(row)}


def _by_temperature(law: FrictionLaw, size: float) -> FrictionLaw | None:
    """Return a law whose friction falls with the temperature; None where none is composed for it.

    Its values are those at 0 degrees: the records begin at 20.
    """
    if law.states:
        return None
    cold = 1.0 + 20.0 * size
    parts = {"level": "kinetic", "stribeck": "static", "viscous": "viscous"}
    names = {part: f"{name}_coefficient" for part, name in parts.items()}
    has = [part for part in parts if getattr(law, names[part], None) is not None]
    kind = composed(" + ".join(f"{part} * linear[temperature]" for part in has))
    values = {name: getattr(law, name) for name in kind.fit_order if hasattr(law, name)}
    values |= {names[part]: cold * getattr(law, names[part]) for part in has}
    made = kind(**values, **{f"{part}_temperature_slope": -size / cold for part in has})
    assert isinstance(made, FrictionLaw)
    return made


def summary(row: Mapping[str, Any]) -> str:
    """Return a record in a line."""
    title = (
        f"{row['number']:3} {row['fault']:6}{row['size']:7.3f} {row['truth']:15}"
        f" {row['motion']:8} {row['rate']:5.0f}"
    )
    return f"{title} {row['seconds']:5.1f}s {row['verdict']} {row['said']} {row['structure']}"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.force_maps")
    parser.add_argument("--numbers", type=int, nargs=2, default=[0, 30])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    given = parser.parse_args()
    rows = []
    with given.results.open("a", encoding="utf-8") as file:
        for number in range(*given.numbers):
            row = explained_of(number, given.seed)
            rows.append(row)
            file.write(json.dumps(row) + "\n")
            file.flush()
            print(summary(row), flush=True)
    count = Counter(row["verdict"] for row in rows)
    print(", ".join(f"{name} {count[name]}" for name in ("right", "wrong", "nothing")))


if __name__ == "__main__":
    main()
