"""Records of made-up arms with known laws, and with faults: do intervals hold, is something said?

``python -m benchmarks.joints --seed N`` selects laws for 15 arms: twelve sound ones with a law for
each joint, one with a joint that hardly moves, one with a joint whose force is shown late and one
whose lower link is given with a wrong mass. A law is right, or equal if it predicts a second record
as well as the true one does; a false certainty is a law that is neither and recommended without
doubt, or a fault that is not there.

``python -m benchmarks.joints --kinds clean late --numbers 0 40`` fits the true laws to arms with
faults; ``--select`` compares laws instead. Results are appended to a file line by line.

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

from benchmarks.finding_kinds import parts_of
from benchmarks.rigs import TRUTHS as USUAL
from benchmarks.rigs import Array, Random, Sizes, between
from stickslip import Dahl, FrictionLaw, Measurement, RecordSettings, TwoLinkArm, check, fit, select
from stickslip.errors import StickslipError
from stickslip.formulation import JointTorques
from stickslip.friction import bound, law, specification
from stickslip.identification import RecordFit

RESULTS = "joints.jsonl"
JOINTS = ("shoulder", "elbow")
LINEAR = ("upper_centre", "upper_inertia", "lower_centre", "lower_inertia")
LAWS = ("coulomb-viscous", "direction-dependent", "power-viscous", "quadratic-drag", "stribeck")
ALONG = "level * linear[position] + viscous"
TRUE = ("coulomb-viscous", "stribeck", "direction-dependent", "power-viscous", ALONG, "dahl")
"""Laws of the joints of a study."""
ROUNDS = 100
"""Times that friction of a gear is computed from the motor's torque, of which it is a share."""
SETTINGS = RecordSettings(hold="first", starts=1)


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
        if (found := _moved(kind, random, given)) is not None:
            arm, laws, records, row = found
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
        found = Recorded(
            time=t,
            position=q + random.normal(0.0, noise, q.shape),
            force=forces + torque * sizes * random.normal(size=q.shape),
        )
        found = FAULTS[kind](found, random)
        records.append(
            Measurement(
                time=t,
                position=dict(zip(JOINTS, found.position.T, strict=True)),
                force=dict(zip(JOINTS, found.force.T, strict=True)),
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
    arm, laws, (record, _), row = drawn(kind, number, seed)
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
    arm, _, (record, _), row = drawn(kind, number, seed)
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


def judged(kind: str, given: Sequence[str], number: int, seed: int) -> dict[str, Any]:
    """Return how right a selection is about each joint of an arm."""
    arm, laws, (record, second), row = drawn(kind, number, seed, given)
    began = time.process_time()
    wrong = kind == "wrong mass"
    rig = replace(arm, lower_mass=1.4 * arm.lower_mass) if wrong else _guess(arm)
    vary = () if wrong else LINEAR
    verdict = select(rig, None, record, vary=vary, settings=SETTINGS)
    row["seconds"] = time.process_time() - began
    found = {}
    for joint, true in laws.items():
        own = verdict.joints.get(joint)
        if own is None:
            found[joint] = {"outcome": "not fitted", "certain": False, "said": []}
            continue
        fit_ = own.closest.fit
        assert fit_ is not None
        text = row["laws"][joint]
        asked = true.name if text in GEARED else specification(text).name
        right = own.closest.name == asked
        equal = right or (not wrong and _as_good(verdict, joint, laws, rig, record, second))
        held = []
        for one in fit_.estimates:
            field = one.path.rpartition(".")[2]
            if right and one.bounded and one.path.startswith("friction."):
                held.append(one.low <= getattr(true, field) <= one.high)
        found[joint] = {
            "named": own.closest.name,
            "outcome": "right" if right else "equal" if equal else "wrong",
            "certain": own.sentence.startswith("Use") and asked not in own.equals,
            "said": [one.kind for one in own.model_errors if one.share > 0.0],
            "held": sum(held),
            "bounded": len(held),
            "sentence": own.sentence,
        }
    return row | {"joints": found, "verdict": verdict.sentence}


def _as_good(
    verdict: Any,
    joint: str,
    laws: Mapping[str, FrictionLaw],
    rig: TwoLinkArm,
    record: Measurement,
    second: Measurement,
) -> bool:
    """Whether a combination predicts a joint of a second record as well as the true laws do."""
    truth = {name: type(laws[name]) for name in verdict.joints}
    best = fit(rig, truth, record, vary=["friction.*", *LINEAR], settings=SETTINGS)
    own = verdict.closest.fit.score(second).joints[joint].rms
    least = best.score(second).joints[joint].rms
    return bool(own < 1.15 * least)


WRONG = ("parameters", "unexplained")
"""Kinds of findings that tell of a wrong mass."""


def faults_of(row: Mapping[str, Any], joint: str) -> list[str]:
    """Return what is said of a joint that is not so."""
    said = row["joints"][joint]["said"]
    true = {
        ("late elbow", "elbow"): ("delay", "late or elastic"),
        ("wrong mass", "elbow"): WRONG,
        ("wrong mass", "shoulder"): WRONG,
    }.get((row["kind"], joint), ())
    return [one for one in said if one not in true and not parts_of(one) & {*true}]


def totals(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the figures of a study."""
    sound = [row for row in rows if row["kind"] in ("clean", "still")]
    every = [one for row in sound for one in row["joints"].values() if "named" in one]
    right, equal = (sum(one["outcome"] == k for one in every) for k in ("right", "equal"))
    false = [
        (row["number"], joint)
        for row in rows
        for joint, one in row["joints"].items()
        if (one["certain"] and one["outcome"] == "wrong") or faults_of(row, joint)
    ]
    held, bounded = (sum(one[k] for one in every) for k in ("held", "bounded"))
    seconds = [row["seconds"] for row in rows]
    return (
        f"joints of sound arms: {right} right, {equal} equal, of {len(every)};"
        f" false certainties {len(false)} {false};"
        f" intervals hold {held} of {bounded} ({100.0 * held / max(bounded, 1):.0f} %);"
        f" processor time {np.median(seconds):.0f} s, at most {max(seconds):.0f} s"
    )


PLAIN = ("coulomb-viscous", "coulomb-viscous")
CASES = (
    *(("clean", (one, TRUE[(i + k) % 6])) for k in (1, 3) for i, one in enumerate(TRUE)),
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
            for joint, one in rows[-1]["joints"].items():
                text = f"{number:2} {kind:10} {joint:8} {rows[-1]['laws'][joint]:36}"
                text += f" {one['outcome']:10} {one.get('named', ''):28} {one['said']}"
                print(text, faults_of(rows[-1], joint), one.get("sentence", ""), flush=True)
    print(totals(rows))


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
    parser.add_argument("--kinds", nargs="+", choices=FAULTS)
    parser.add_argument("--numbers", type=int, nargs=2, default=[0, 40])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--select", action="store_true")
    parser.add_argument("--gears", action="store_true")
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    given = parser.parse_args()
    if given.kinds is None:
        cases = GEARS if given.gears else CASES
        study(given.seed, given.results, given.numbers, cases)
        return
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
