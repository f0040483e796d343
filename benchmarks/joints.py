"""Records of made-up arms with known laws, and with faults: does the band of each joint hold?

``python -m benchmarks.joints --seed N`` judges 15 arms: twelve sound ones with a law for each
joint, one with a joint that hardly moves, one with a joint whose force is shown late and one whose
lower link is given with a wrong mass. ``--gears`` judges arms with gears that the torque loads,
``--kinds clean drift --numbers 0 40`` arms with faults. A row has, for each joint, what was named,
whether that is the law, the part of the speeds at which the true friction lies in the band, its
half width over the friction, and what was named beside the law. Results are appended to a file line
by line.

Each arm has two links with random lengths, masses and inertias, and each joint a random law; both
are moved by sums of sines. Faults: positions or forces of two joints swapped, positions of one
joint in degrees, forces of one joint in mN m, a joint that hardly moves, forces cut off at 60 %
of the largest, a force channel that is late, a force with the wrong sign, a drifting offset of
one force.
"""

import argparse
import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.rigs import TRUTHS as USUAL
from benchmarks.rigs import Array, Random, Sizes, between
from stickslip import Dahl, FrictionLaw, Measurement, RecordSettings, TwoLinkArm, select
from stickslip.engine.formulation import JointTorques
from stickslip.errors import StickslipError
from stickslip.friction import bound, law, specification
from stickslip.identify import BandVerdict

RESULTS = "joints.jsonl"
JOINTS = ("shoulder", "elbow")
LINEAR = ("upper_centre", "upper_inertia", "lower_centre", "lower_inertia")
LAWS = ("coulomb-viscous", "direction-dependent", "power-viscous", "quadratic-drag", "stribeck")
ALONG = "level * linear[position] + viscous"
TRUE = ("coulomb-viscous", "stribeck", "direction-dependent", "power-viscous", ALONG, "dahl")
"""Laws of the joints of a study."""
ROUNDS = 100
"""Times that friction of a gear is computed from the motor's torque, of which it is a share."""
SETTINGS = RecordSettings(hold="first")


GEARED = (
    "level + weight[transmitted] + viscous",
    "level + weight[motor] + viscous",
    "level + weight2[transmitted] + viscous",
)
"""Laws of gears whose level grows with the torque that they transmit, with that of the motor alone,
and with the square."""


def _gear(text: str, random: Random, s: Sizes, most: float) -> FrictionLaw:
    """Return a gear that loses 8 to 30 % of the torque, of the largest one if it is squared."""
    share = float(random.uniform(0.08, 0.3))
    kind = law(text)
    _, growth, _ = kind.fit_order
    return kind(
        kinetic_coefficient=0.3 * s.level,
        viscous_coefficient=0.3 * s.level / s.speed * float(random.uniform(0.2, 1.5)),
        **{growth: share / most if "weight2" in text else share},
    )


def _along(random: Random, s: Sizes) -> FrictionLaw:
    """Return a level that changes by 30 % from the middle to either end of the way."""
    return law(ALONG)(
        kinetic_coefficient=s.level,
        level_position_slope=float(random.choice((-0.6, 0.6))) / s.stroke,
        viscous_coefficient=s.level / s.speed * float(random.uniform(0.2, 1.5)),
    )


TRUTHS = {**USUAL, ALONG: _along}


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


def _late_elbow(r: Recorded, random: Random) -> Recorded:
    late = between(random, 0.005, 0.02)
    return replace(r, force=_column(r.force, 1, lambda f: np.interp(r.time - late, r.time, f)))


def _column(values: Array, at: int, of: Callable[[Array], Array]) -> Array:
    result = values.copy()
    result[:, at] = of(values[:, at])
    return result


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
    "late elbow": _late_elbow,
    "wrong mass": lambda r, _: r,
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
    kind: str, number: int, seed: int, given: Sequence[str] = ()
) -> tuple[TwoLinkArm, dict[str, FrictionLaw], list[Measurement], dict[str, Any]]:
    """Return an arm, its laws (drawn unless given by name), two records, and what they are of."""
    random = np.random.default_rng([seed, number])
    while True:
        if (result := _moved(kind, random, given)) is not None:
            arm, laws, records, row = result
            return arm, laws, records, {"kind": kind, "number": number, "seed": seed} | row


def _moved(
    kind: str, random: Random, given: Sequence[str]
) -> tuple[TwoLinkArm, dict[str, FrictionLaw], list[Measurement], dict[str, Any]] | None:
    """Return an arm as it moves, or None if one of its gears locks."""
    arm = _arm(random)
    rate = float(random.choice((100.0, 250.0, 500.0, 1000.0)))
    t = np.arange(0.0, 10.0, 1.0 / rate)
    still = int(random.integers(2)) if kind == "still" else None
    names: dict[str, str] = {}
    laws: dict[str, FrictionLaw] = {}
    records: list[Measurement] = []
    row: dict[str, Any] = {"rate": rate}
    for _ in range(2):
        q, v, a = _motion(random, t, still)
        takes = JointTorques.of(arm, [])
        forces, _ = takes.along(arm, t, q, v, a)
        weights, _ = takes.along(arm, t, q, 0.0 * v, 0.0 * a)
        sizes = np.std(forces, axis=0)
        for i, joint in enumerate(JOINTS):
            if joint not in laws:
                names[joint] = given[i] if given else str(random.choice(LAWS))
                level = float(sizes[i] * random.uniform(0.1, 1.0))
                speed, stroke = float(np.abs(v[:, i]).max()), float(np.ptp(q[:, i]))
                most = 1.5 * float(np.abs(forces[:, i] + weights[:, i]).max())
                own = Sizes(level=level, speed=speed, stroke=stroke)
                laws[joint] = (
                    _gear(names[joint], random, own, most)
                    if names[joint] in GEARED
                    else TRUTHS[names[joint]](random, own)
                )
            if names[joint] in GEARED:
                forces[:, i] += gear_along(laws[joint], v[:, i], forces[:, i], weights[:, i])
            else:
                forces[:, i] += friction_along(laws[joint], q[:, i], v[:, i])
        if not np.all(np.isfinite(forces)):
            return None
        if not records:
            noise, torque = between(random, 2e-5, 5e-4), between(random, 0.002, 0.05)
        result = Recorded(
            time=t,
            position=q + random.normal(0.0, noise, q.shape),
            force=forces + torque * sizes * random.normal(size=q.shape),
        )
        result = FAULTS[kind](result, random)
        records.append(
            Measurement(
                time=t,
                position=dict(zip(JOINTS, result.position.T, strict=True)),
                force=dict(zip(JOINTS, result.force.T, strict=True)),
            )
        )
    return arm, laws, records, row | {"laws": names, "noise": noise, "torque": torque}


def gear_along(law: FrictionLaw, v: Array, taken: Array, weight: Array) -> Array:
    """Return the friction of a gear along a motion (n,): of the motor's torque it is a part.

    The motor holds the weight (n,), too, so that the gear transmits it twice.
    """
    force = np.zeros_like(v)
    for _ in range(ROUNDS):
        motor = taken + force
        told = bound(law, {"motor": motor, "transmitted": motor + weight})
        force = np.asarray(told.force(v, 1.0))
    return force


def friction_along(law: FrictionLaw, q: Array, v: Array) -> Array:
    """Return the friction of a law along a motion (n,) under a load of 1."""
    if isinstance(law, Dahl):
        force, level = np.zeros(len(q)), law.kinetic_coefficient
        for i, step in enumerate(np.diff(q)):
            left = np.exp(-law.bristle_stiffness / level * abs(step))
            force[i + 1] = np.sign(step) * level * (1.0 - left) + force[i] * left
        return force + law.viscous_coefficient * v
    slope = getattr(law, "level_position_slope", None)
    if slope is not None:
        level = law.kinetic_coefficient * (1.0 + slope * q)  # type: ignore[attr-defined]
        return level * np.sign(v) + law.viscous_coefficient * v  # type: ignore[attr-defined]
    return np.asarray(law.force(v, 1.0))


def _guess(arm: TwoLinkArm) -> TwoLinkArm:
    return replace(
        arm, upper_centre=0.5 * arm.upper_centre, upper_inertia=2.0 * arm.upper_inertia,
        lower_centre=0.7 * arm.lower_centre, lower_inertia=0.6 * arm.lower_inertia,
    )  # fmt: skip


def steady(law: FrictionLaw, text: str, v: Array) -> Array | None:
    """Return the friction of a law at speeds (n,); None if it depends on more than the speed."""
    if text in (*GEARED, ALONG):
        return None
    if isinstance(law, Dahl):
        return np.asarray(law.kinetic_coefficient * np.sign(v) + law.viscous_coefficient * v)
    return np.asarray(law.force(v, 1.0))


def judged(kind: str, given: Sequence[str], number: int, seed: int) -> dict[str, Any]:
    """Return how right a selection is about each joint of an arm."""
    arm, laws, (record, second), row = drawn(kind, number, seed, given)
    wrong = kind == "wrong mass"
    rig = replace(arm, lower_mass=1.4 * arm.lower_mass) if wrong else _guess(arm)
    began = time.process_time()
    try:
        verdict = select(
            rig, None, record, vary=() if wrong else LINEAR, settings=SETTINGS, validate=second
        )
    except StickslipError as error:
        return row | {"refused": str(error), "joints": {}, "seconds": time.process_time() - began}
    row["seconds"] = time.process_time() - began
    joints = {
        joint: _of_joint(verdict.joints[joint], laws[joint], row["laws"][joint])
        for joint in laws
        if joint in verdict.joints
    }
    return row | {"joints": joints, "verdict": verdict.sentence, "used": verdict.best is not None}


def _of_joint(verdict: BandVerdict, true: FrictionLaw, text: str) -> dict[str, Any]:
    """Return how right a verdict is about a joint."""
    asked = true.name if text in GEARED else specification(text).name
    v, band = verdict.speeds, verdict.friction
    curve = steady(true, text, v)
    covered = None if curve is None else float(np.mean((band.low <= curve) & (curve <= band.high)))
    return {
        "named": verdict.closest.name,
        "right": verdict.closest.name == asked,
        "in set": asked
        in {candidate.name for candidate in verdict.candidates if candidate.outcome},
        "covered": covered,
        "half": float(np.mean(band.high - band.low) / np.mean(np.abs(band.median)) / 2.0),
        "inside": verdict.inside,
        "said": [finding.term for finding in verdict.findings if finding.asserted],
    }


def totals(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the figures of a study."""
    sound = [row for row in rows if row["kind"] in ("clean", "still")]
    every = [item for row in sound for item in row["joints"].values()]
    covered = [item["covered"] for item in every if item["covered"] is not None]
    said = sum(bool(item["said"]) for item in every)
    return (
        f"joints of sound arms: {sum(item['right'] for item in every)} right, the law in the set of"
        f" {sum(item['in set'] for item in every)}, of {len(every)}; true friction in the band at"
        f" {np.mean(covered):.3f} of the speeds, half width"
        f" {np.median([item['half'] for item in every]):.3f} of the friction; readings of a second"
        f" record inside {np.mean([item['inside'] for item in every]):.3f}; something beside the"
        f" law at {said}; processor time {np.median([row['seconds'] for row in rows]):.1f} s"
    )


PLAIN = ("coulomb-viscous", "coulomb-viscous")
CASES = (
    *(("clean", (item, TRUE[(i + k) % 6])) for k in (1, 3) for i, item in enumerate(TRUE)),
    ("still", PLAIN),
    ("late elbow", PLAIN),
    ("wrong mass", PLAIN),
)
"""What is wrong with each arm of a study, and its laws."""
GEARS = tuple(
    ("clean", names)
    for gear in GEARED
    for names in (
        (gear, "coulomb-viscous"),
        ("coulomb-viscous", gear),
        (gear, gear),
        ("stribeck", gear),
        (gear, "direction-dependent"),
    )
)
"""The same of arms of which at least one joint has a gear that the torque loads."""


def study(
    seed: int,
    results: Path,
    numbers: Sequence[int],
    cases: Sequence[tuple[str, Sequence[str]]] = CASES,
) -> None:
    """Judge selections on all arms of a study."""
    rows = []
    with results.open("a", encoding="utf-8") as file:
        for number, (kind, names) in enumerate(cases):
            if number not in range(*numbers):
                continue
            rows.append(judged(kind, names, number, seed))
            file.write(json.dumps(rows[-1]) + "\n")
            file.flush()
            for joint, item in rows[-1]["joints"].items():
                told = " ".join(f"{key}={value}" for key, value in item.items())
                print(f"{number:2} {kind:10} {joint:8} {rows[-1]['laws'][joint]:36} {told}")
            print(rows[-1].get("refused", ""), flush=True)
    print(totals(rows))


def main() -> None:
    """Run the campaign."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.joints")
    parser.add_argument("--kinds", nargs="+", choices=FAULTS)
    parser.add_argument("--numbers", type=int, nargs=2, default=[0, 40])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--gears", action="store_true")
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    given = parser.parse_args()
    cases: Sequence[tuple[str, Sequence[str]]] = GEARS if given.gears else CASES
    if given.kinds is not None:
        cases = [(kind, ()) for kind in given.kinds for _ in range(given.numbers[1])]
    study(given.seed, given.results, given.numbers, cases)


if __name__ == "__main__":
    main()
