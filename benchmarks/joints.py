"""Records of made-up arms with known laws, and with faults: do intervals hold, is something said?

``python -m benchmarks.joints --kinds clean late --numbers 0 40``; ``--select`` compares laws
instead of fitting the true ones. Results are appended to a file line by line.

Each arm has two links with random lengths, masses and inertias, and each joint a random law; both
are moved by sums of sines. Faults: positions or forces of two joints swapped, positions of one
joint in degrees, forces of one joint in mN m, a joint that hardly moves, forces cut off at 60 %
of the largest, a force channel that is late, a force with the wrong sign, a drifting offset of
one force.
"""

import argparse
import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.rigs import TRUTHS, Array, Random, Sizes, between
from stickslip import FrictionLaw, Measurement, RecordSettings, TwoLinkArm, check, fit, select
from stickslip.errors import StickslipError
from stickslip.formulation import JointTorques
from stickslip.identification import RecordFit

RESULTS = "joints.jsonl"
JOINTS = ("shoulder", "elbow")
LINEAR = ("upper_centre", "upper_inertia", "lower_centre", "lower_inertia")
LAWS = ("coulomb-viscous", "direction-dependent", "power-viscous", "quadratic-drag", "stribeck")
SETTINGS = RecordSettings(hold="first", starts=1)


@dataclass(frozen=True, kw_only=True)
class Recorded:
    """What is measured of an arm: all columns (n, 2)."""

    time: Array
    position: Array
    force: Array


def _late(r: Recorded, random: Random) -> Recorded:
    late = between(random, 0.005, 0.02)
    force = np.stack([np.interp(r.time - late, r.time, f) for f in r.force.T], axis=1)
    return replace(r, force=force)


def _column(values: Array, at: int, of: Callable[[Array], Array]) -> Array:
    found = values.copy()
    found[:, at] = of(values[:, at])
    return found


def _one_force(of: Callable[[Array], Array]) -> Callable[[Recorded, Random], Recorded]:
    """Return what changes the force of one joint."""
    return lambda r, x: replace(r, force=_column(r.force, int(x.integers(2)), of))


def _in_degrees(r: Recorded, random: Random) -> Recorded:
    return replace(r, position=_column(r.position, int(random.integers(2)), np.degrees))


def _clipped(force: Array) -> Array:
    most = 0.6 * float(np.abs(force).max())
    return np.clip(force, -most, most)


def _drifting(force: Array) -> Array:
    return np.asarray(force + np.std(force) * np.linspace(0.0, 1.0, len(force)))


FAULTS: Mapping[str, Callable[[Recorded, Random], Recorded]] = {
    "clean": lambda r, _: r,
    "swapped positions": lambda r, _: replace(r, position=r.position[:, ::-1]),
    "swapped forces": lambda r, _: replace(r, force=r.force[:, ::-1]),
    "degrees": _in_degrees,
    "millinewtons": _one_force(lambda force: 1e3 * force),
    "still": lambda r, _: r,
    "clipped": _one_force(_clipped),
    "late": _late,
    "sign": _one_force(np.negative),
    "drift": _one_force(_drifting),
}
"""What is done to a record, by name."""


def _arm(random: Random) -> TwoLinkArm:
    upper, lower = random.uniform(0.1, 0.6, 2)
    masses = between(random, 0.3, 5.0), between(random, 0.3, 5.0)
    centres = upper * random.uniform(0.3, 0.9), lower * random.uniform(0.3, 0.9)
    # about the joint: at least mass times the square of the centre's distance
    inertias = [m * c * c * random.uniform(1.1, 1.6) for m, c in zip(masses, centres, strict=True)]
    return TwoLinkArm(
        upper_mass=masses[0], upper_length=upper, upper_centre=centres[0],
        upper_inertia=inertias[0],
        lower_mass=masses[1], lower_centre=centres[1], lower_inertia=inertias[1],
        rotor_inertia=float(random.uniform(0.0, 2e-4)), gear_ratio=6.0,
    )  # fmt: skip


def _motion(random: Random, t: Array, still: int | None) -> tuple[Array, Array, Array]:
    q, v, a = np.zeros((3, len(t), 2))
    for i in range(2):
        for w in random.uniform(2.0, 12.0, 5):
            size, phase = random.uniform(0.1, 0.3), random.uniform(0.0, 2.0 * np.pi)
            size *= 1e-3 if i == still else 1.0
            q[:, i] += size * np.sin(w * t + phase)
            v[:, i] += size * w * np.cos(w * t + phase)
            a[:, i] -= size * w * w * np.sin(w * t + phase)
    return q, v, a


def drawn(
    kind: str, number: int, seed: int
) -> tuple[TwoLinkArm, dict[str, FrictionLaw], Measurement, dict[str, Any]]:
    """Return an arm, its laws, a record, and what it is of."""
    random = np.random.default_rng([seed, number])
    arm = _arm(random)
    rate = float(random.choice((100.0, 250.0, 500.0, 1000.0)))
    t = np.arange(0.0, 10.0, 1.0 / rate)
    still = int(random.integers(2)) if kind == "still" else None
    q, v, a = _motion(random, t, still)
    forces, _ = JointTorques.of(arm, []).along(arm, t, q, v, a)
    sizes = np.std(forces, axis=0)
    names, laws = {}, {}
    for i, joint in enumerate(JOINTS):
        names[joint] = str(random.choice(LAWS))
        level = float(sizes[i] * random.uniform(0.1, 1.0))
        own = Sizes(level=level, speed=float(np.abs(v[:, i]).max()), stroke=float(np.ptp(q[:, i])))
        laws[joint] = TRUTHS[names[joint]](random, own)
        forces[:, i] += laws[joint].force(v[:, i], 1.0)
    noise, torque = between(random, 2e-5, 5e-4), between(random, 0.002, 0.05)
    found = Recorded(
        time=t,
        position=q + random.normal(0.0, noise, q.shape),
        force=forces + torque * sizes * random.normal(size=q.shape),
    )
    found = FAULTS[kind](found, random)
    record = Measurement(
        time=t,
        position=dict(zip(JOINTS, found.position.T, strict=True)),
        force=dict(zip(JOINTS, found.force.T, strict=True)),
    )
    row = {"kind": kind, "number": number, "seed": seed, "rate": rate, "laws": names}
    return arm, laws, record, row | {"noise": noise, "torque": torque}


def _guess(arm: TwoLinkArm) -> TwoLinkArm:
    return replace(
        arm, upper_centre=0.5 * arm.upper_centre, upper_inertia=2.0 * arm.upper_inertia,
        lower_centre=0.7 * arm.lower_centre, lower_inertia=0.6 * arm.lower_inertia,
    )  # fmt: skip


def _warned(record: Measurement, arm: TwoLinkArm) -> list[str]:
    return [one.kind for one in check(record, mechanism=arm).findings if one.severity != "info"]


def true_value(path: str, arm: TwoLinkArm, laws: Mapping[str, FrictionLaw]) -> float:
    """Return the true value of an estimate."""
    room, _, rest = path.partition(".")
    if room == "mechanism":
        return float(getattr(arm, rest))
    if room == "friction":
        joint, _, field = rest.partition(".")
        return float(getattr(laws[joint], field))
    return 0.0


def fitted(kind: str, number: int, seed: int) -> dict[str, Any]:
    """Return whether a fit of the true laws holds the true values, and what is said."""
    arm, laws, record, row = drawn(kind, number, seed)
    began = time.process_time()
    try:
        found = fit(
            _guess(arm), {name: type(law) for name, law in laws.items()}, record,
            vary=["friction.*", *LINEAR], settings=SETTINGS,
        )  # fmt: skip
    except StickslipError as error:
        return row | {"refused": str(error), "seconds": time.process_time() - began}
    assert isinstance(found, RecordFit)
    held, wrong = 0, []
    for one in found.estimates:
        true = true_value(one.path, arm, laws)
        if not one.bounded:
            continue
        if one.low <= true <= one.high:
            held += 1
        else:
            wrong.append(
                f"{one.path} {one.value:.4g} [{one.low:.4g}, {one.high:.4g}] not {true:.4g}"
            )
    return row | {
        "bounded": held + len(wrong),
        "estimates": len(found.estimates),
        "held": held,
        "wrong": wrong,
        "said": [*found.sentences, *map(str, found.model_errors)],
        "checks": _warned(record, arm),
        "seconds": time.process_time() - began,
    }


def selected(kind: str, number: int, seed: int) -> dict[str, Any]:
    """Return what a selection names for each joint."""
    arm, _, record, row = drawn(kind, number, seed)
    began = time.process_time()
    try:
        verdict = select(_guess(arm), None, record, vary=LINEAR, settings=SETTINGS)
    except StickslipError as error:
        return row | {"refused": str(error), "seconds": time.process_time() - began}
    return row | {
        "named": {name: one.closest.name for name, one in verdict.joints.items()},
        "verdict": verdict.sentence,
        "used": verdict.best is not None,
        "checks": [one.kind for one in verdict.checks.findings if one.severity != "info"],
        "seconds": time.process_time() - began,
    }


def summary(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return a line for each kind."""
    lines = []
    for kind in dict.fromkeys(row["kind"] for row in rows):
        own = [row for row in rows if row["kind"] == kind]
        fits = [row for row in own if "held" in row]
        bounded, held = (sum(row[name] for row in fits) for name in ("bounded", "held"))
        share = held / bounded if bounded else math.nan
        silent = sum(not row["said"] and not row["checks"] for row in fits)
        refused = sum("refused" in row for row in own)
        free = sum(row["estimates"] for row in fits) - bounded
        lines.append(
            f"{kind:18} {len(own):3} records, {refused} refused, {silent} with nothing said;"
            f" intervals hold {held} of {bounded} ({100.0 * share:.1f} %), {free} not bounded"
        )
    return lines


def main() -> None:
    """Run the campaign."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.joints")
    parser.add_argument("--kinds", nargs="+", choices=FAULTS, default=list(FAULTS))
    parser.add_argument("--numbers", type=int, nargs=2, default=[0, 40])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--select", action="store_true")
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    given = parser.parse_args()
    rows = []
    with given.results.open("a", encoding="utf-8") as file:
        for kind in given.kinds:
            for number in range(*given.numbers):
                row = (selected if given.select else fitted)(kind, number, given.seed)
                rows.append(row)
                file.write(json.dumps(row) + "\n")
                file.flush()
                shown = (
                    row.get("refused") or row.get("verdict") or f"{row['held']}/{row['bounded']}"
                )
                more = (row.get(name, "") for name in ("wrong", "said", "checks"))
                print(f"{kind} {number} {row['laws']}: {shown}", *more, flush=True)
    print("\n".join(summary(rows)) if not given.select else "")


if __name__ == "__main__":
    main()
