"""Axes under position control: is the law found, is anything said falsely, do intervals hold?

``python -m benchmarks.closed_loop_axes --rigs 40 --seed 1 --jobs 2``; results are appended to a
file line by line, and a run that was killed goes on where it was.

An axis follows slow and fast moves under a sampled proportional-derivative controller with
feedforward of the acceleration. Recorded are the position by an encoder of 0.1 to 10 um and the
commanded force, which is held between samples. Each parameter of a law spans two decades. Truths
in turn: LuGre, Stribeck, elasto-plastic, GMS with four elements, levels and slopes by direction,
and Coulomb + viscous friction of a motor that drives half of the mass through backlash.

Right is the true law, or one whose friction along a fresh motion errs no more than that of the true
law fitted to the same record (`SAME`); with backlash, that it is named, alone or in its group. A
false certainty is a law that is recommended without a doubt, an equal or a finding beside it, and
is not right; or a sound rig of which a fault is said. What is neither right nor falsely certain is
counted where it is in doubt, or no law is named.
"""

import argparse
import math
import resource
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.machines import Machine
from benchmarks.rigs import SOLVER, Array, Random, Rig, between
from benchmarks.synthetic_truth import judged, run, share
from benchmarks.whole_verdicts import parts_of
from stickslip import (
    GMS,
    Axis,
    CoulombViscous,
    DirectionDependent,
    ElastoPlastic,
    FrictionLaw,
    LuGre,
    Measurement,
    Stribeck,
    select,
)
from stickslip.control import closed_loop
from stickslip.errors import StickslipError
from stickslip.friction import bound
from stickslip.identification import RecordFit, RecordSettings, fit_record
from stickslip.kinds import RecordVerdict

TRUTHS = ("lugre", "stribeck", "elasto-plastic", "gms", "direction-dependent", "backlash")
ENCODERS = (1e-7, 1e-5)
"""Smallest and largest step of an encoder [m] in the study."""
NO_FAULT = ("law", "unexplained")
"""Kinds of findings that say nothing of the rig."""
BACKLASH = ("backlash", "late or elastic")
"""Kinds of findings that name backlash."""
MOVED = 100.0
"""Steps of the encoder that a record, and the fresh motion beside it, cover at least."""
SAME = 0.10
"""A law whose friction on a fresh record is off by this share of the noise more is an equal one."""
RIGHT, COVERED = 0.95, (0.90, 0.99)
"""Targets: right or equal laws, and coverage of nominal 95 %."""
SLIPS = 1e-4
"""Share of the largest speed above which an axis slips."""
RESULTS = "closed_loop_axes.jsonl"
CHOSEN = "chosen"
"""Stands for the route that selection takes by itself."""


@dataclass(frozen=True, kw_only=True)
class ControlledAxis:
    """An axis, its friction, its controller and its sensor."""

    axis: Axis
    law: FrictionLaw
    speeds: tuple[float, float]
    """Slowest and fastest speed of the moves [m/s]."""
    bandwidth: float
    """Of the controller [rad/s]."""
    encoder: float
    """Step of the encoder [m]."""
    force_noise: float
    """Standard deviation of the recorded force [N]."""
    rate: float
    """Samples per second [Hz]."""
    duration: float
    """Of a record [s]."""
    gap: float = 0.0
    """Play [m] through which the motor drives half of the mass."""


def draw(
    random: Random, truth: str, encoders: tuple[float, float] = (1e-6, 1e-5)
) -> ControlledAxis:
    """Return a random axis; each parameter spans two decades."""
    inertia = between(random, 1.0, 100.0)
    level = between(random, 2.0, 200.0)
    fast = between(random, 0.05, 0.5)
    surplus = float(random.uniform(1.2, 1.8))
    v_s = between(random, 1e-3, 1e-1) * math.sqrt(fast / 0.15)
    viscous = level / fast * between(random, 0.03, 1.0)
    encoder = between(random, *encoders)
    gap = 0.0
    if truth == "stribeck":
        law: FrictionLaw = Stribeck(
            kinetic_coefficient=level,
            static_coefficient=level * surplus,
            stribeck_velocity=v_s,
            viscous_coefficient=viscous,
        )
    elif truth == "direction-dependent":
        levels, slopes = random.uniform(0.05, 0.3, 2) * random.choice((-1.0, 1.0), 2)
        law = DirectionDependent(
            forward_kinetic_coefficient=level * (1.0 + levels),
            backward_kinetic_coefficient=level * (1.0 - levels),
            forward_viscous_coefficient=viscous * (1.0 + slopes),
            backward_viscous_coefficient=viscous * (1.0 - slopes),
        )
    elif truth == "backlash":
        law = CoulombViscous(kinetic_coefficient=level, viscous_coefficient=viscous)
        gap = fast * between(random, 0.005, 0.05)
    else:
        # breaks away after 5 um to .5 mm
        stiffness = level / between(random, 5e-6, 5e-4)
        common = {
            "kinetic_coefficient": level,
            "static_coefficient": level * surplus,
            "stribeck_velocity": v_s,
            "bristle_stiffness": stiffness,
            "viscous_coefficient": viscous,
        }
        damping = between(random, 0.1, 1.0) * 2.0 * math.sqrt(stiffness * inertia)
        if truth == "lugre":
            law = LuGre(**common, bristle_damping=damping)
        elif truth == "elasto-plastic":
            share = float(random.uniform(0.3, 0.8))
            law = ElastoPlastic(**common, bristle_damping=damping, elastic_share=share)
        else:
            law = GMS(**common, attraction=level * between(random, 10.0, 1000.0))
    offset = level * float(random.uniform(-0.2, 0.2))
    return ControlledAxis(
        # a law with a level for each direction has no constant force beside them
        axis=Axis(inertia=inertia, offset=0.0 if truth == "direction-dependent" else offset),
        law=law,
        speeds=(0.2 * v_s, fast),
        bandwidth=between(random, 20.0, 60.0),
        encoder=encoder,
        force_noise=level * between(random, 1e-3, 1e-2),
        rate=1000.0,
        duration=20.0,
        gap=gap,
    )


def reference(rig: ControlledAxis, random: Random) -> tuple[Array, Array, Array, Array]:
    """Return times, positions, velocities and accelerations (n,) of moves at many speeds."""
    t = np.arange(0.0, rig.duration, 1.0 / rig.rate)
    corners, speeds, side = [0.0], [0.0], 1.0
    while corners[-1] < t[-1]:
        peak = side * between(random, *rig.speeds)
        rise, hold = random.uniform(0.1, 0.3), random.uniform(0.2, 0.8)
        for stretch, speed in ((rise, peak), (hold, peak), (rise, 0.0), (0.05, 0.0)):
            corners.append(corners[-1] + float(stretch))
            speeds.append(speed)
        side = -side
    v = np.interp(t, corners, speeds)
    x = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) / rig.rate)])
    return t, x, v, np.gradient(v, t)


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """An axis as it moved: what no sensor shows."""

    time: Array
    position: Array
    velocity: Array
    command: Array


def moved(rig: ControlledAxis, random: Random) -> Motion:
    """Return a motion of the axis under control."""
    if rig.gap:
        return _through_gap(rig, random)
    t, x, v, a = reference(rig, random)
    inertia, w = rig.axis.inertia, rig.bandwidth

    def controller(now: float, seen: Mapping[str, float]) -> float:
        k = min(round(now * rig.rate), len(t) - 1)
        error, slip = x[k] - seen["x"], v[k] - seen["v"]
        return float(inertia * (a[k] + w * w * error + 1.4 * w * slip))

    loop = closed_loop(
        rig.axis,
        rig.law,
        controller,
        period=1.0 / rig.rate,
        t_end=float(t[-1]),
        quantisation={"x": rig.encoder},
        solver=SOLVER,
    )
    states = loop.run.at(loop.t)
    return Motion(
        time=loop.t,
        position=np.asarray(states["x"]),
        velocity=np.asarray(states["v"]),
        command=loop.commands,
    )


def _through_gap(rig: ControlledAxis, random: Random) -> Motion:
    """Return a motion of a motor that drives half of the mass through a gap."""
    machine = Machine(
        rig=Rig(
            axis=rig.axis,
            law=rig.law,
            speed=rig.speeds[1],
            rate=rig.rate,
            duration=rig.duration,
            noise=0.0,
            disturbance=0.0,
            correlation_time=1.0,
            ramps=True,
        ),
        closed=True,
        split=0.5,
        frequency=60.0,
        gap=rig.gap,
    )
    found = machine.run(random)
    if found is None:
        return _through_gap(rig, random)
    t, x = np.asarray(found.time), np.asarray(found.position)
    return Motion(
        time=t, position=x, velocity=np.gradient(x, t), command=np.asarray(found.values("force"))
    )


def record(rig: ControlledAxis, random: Random) -> Measurement:
    """Return a record of the axis under control."""
    return sensed(rig, moved(rig, random), random)


def sensed(rig: ControlledAxis, motion: Motion, random: Random) -> Measurement:
    """Return what sensors make of a motion."""
    force = motion.command + rig.force_noise * random.standard_normal(len(motion.command))
    position = rig.encoder * np.round(motion.position / rig.encoder)
    return Measurement(time=motion.time, position=position, force=force)


def moving(random: Random, truth: str) -> tuple[ControlledAxis, Measurement, Motion]:
    """Return a random axis, a record and a fresh motion: its controller does move it in both."""
    while True:
        rig = draw(random, truth, ENCODERS)
        measurement = record(rig, random)
        if np.ptp(np.asarray(measurement.position)) <= MOVED * rig.encoder:
            continue
        fresh = moved(rig, random)
        if np.ptp(fresh.position) > MOVED * rig.encoder:
            return rig, measurement, fresh


def judge(seed: int, number: int, *, candidates: Sequence[str], route: str) -> dict[str, Any]:
    """Return what selection makes of one random axis."""
    random = np.random.default_rng([seed, number])
    truth = TRUTHS[number % len(TRUTHS)]
    row: dict[str, Any] = {"seed": seed, "rig": number, "truth": truth, "route": route}
    began, used = time.perf_counter(), _processor()
    try:
        rig, measurement, fresh = moving(random, truth)
        given, free = Axis(inertia=1.5 * rig.axis.inertia), ["friction.*", "mechanism.inertia"]
        began, used = time.perf_counter(), _processor()
        verdict = select(
            given,
            candidates or None,
            measurement,
            vary=free,
            route=None if route == CHOSEN else route,
        )
        row |= {"seconds": time.perf_counter() - began, "processor": _processor() - used}
        assert isinstance(verdict, RecordVerdict)
        fits = {c.name: c.fit for c in verdict.candidates if c.fit}
        fitted_by = verdict.route
        errors = {name: friction_error(rig, one, fresh) for name, one in fits.items()}
        true = fits.get(rig.law.name)
        if true is None:
            true = fit_record(
                given,
                rig.law,  # begins at the truth
                measurement,
                unknown=free[1:],
                route=fitted_by,
                settings=RecordSettings(starts=1),
                contained=(),
            )
            errors[rig.law.name] = friction_error(rig, true, fresh)
        named = verdict.best.name if verdict.best else ""
        row |= {
            "law": rig.law.name,
            "named": named,
            "closest": verdict.closest.name,
            "equals": list(verdict.equals),
            "doubt": verdict.best.doubt if verdict.best else "",
            "findings": [one.kind for one in verdict.model_errors],
            "verdict": str(verdict.sentence),
            "fitted_by": fitted_by,
            "rms": {name: one.rms for name, one in fits.items()},
            "fresh": errors,
            "level": float(np.std(_friction(rig.law, rig, fresh))),
            "noise": rig.force_noise,
            "encoder": rig.encoder,
            "intervals": covered(rig, true),
        }
    except StickslipError as error:
        spent = {"seconds": time.perf_counter() - began, "processor": _processor() - used}
        row |= {"failed": str(error), **spent}
    return row


def _processor() -> float:
    """Return the processor time [s] of this process and of those that it waited for."""
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    used = [resource.getrusage(kind) for kind in kinds]
    return sum(one.ru_utime + one.ru_stime for one in used)


ROUNDS = 100
"""Times that the force of a motor is computed from the friction that grows with it."""


def _friction(law: FrictionLaw, rig: ControlledAxis, motion: Motion) -> Array:
    """Return the friction (n,) of a law along a motion, whose motor overcomes just that."""
    from stickslip.identification.estimation.bristle_integration import Path, follow

    t, v = motion.time, motion.velocity
    loaded = {*law.inputs} & {"motor", "external", "transmitted"}
    taken = motion.command - _friction(rig.law, rig, motion) if loaded else 0.0 * v
    path = Path(time=t, velocity=v, load=np.ones_like(t), travel=np.diff(motion.position))
    external, force = np.full_like(v, -rig.axis.offset), np.zeros_like(v)
    for _ in range(ROUNDS if loaded else 1):
        motor = taken + force
        gear = {"motor": motor, "external": external, "transmitted": motor - external}
        inputs = gear | {"position": motion.position}
        path = replace(path, inputs={name: inputs[name] for name in law.inputs})
        states: tuple[Array, ...] = ()
        if law.states:
            states = tuple(follow(law, path, np.zeros((len(law.states), 1)))[..., 0])
        told = bound(law, path.inputs) if path.inputs else law
        force = np.asarray(told.force(v, 1.0, states) if law.states else told.force(v, 1.0))
    return force


def friction_error(rig: ControlledAxis, fit: RecordFit, fresh: Motion) -> float:
    """Return the root mean square error [N] of friction along a fresh motion.

    Where the true law has no memory, friction of a body at rest has no one value: rows that slip.
    """
    found = _friction(fit.law, rig, fresh) + float(fit.mechanism.offset)  # type: ignore[attr-defined]
    gap = found - _friction(rig.law, rig, fresh) - rig.axis.offset
    slips = np.abs(fresh.velocity) > SLIPS * rig.speeds[1]
    return float(np.sqrt(np.mean(gap[slips | bool(rig.law.states)] ** 2)))


def covered(rig: ControlledAxis, fit: RecordFit | None) -> list[dict[str, Any]]:
    """Return which bounded intervals of the true law hold the truth."""
    if fit is None or rig.gap:
        return []
    rows = []
    for one in fit.estimates:
        room, _, name = one.path.partition(".")
        true = float(getattr(rig.law if room == "friction" else rig.axis, name))
        rows.append(
            {
                "path": one.path,
                "true": true,
                "value": one.value,
                "low": one.low,
                "high": one.high,
                "bounded": one.bounded,
                "covered": bool(one.low <= true <= one.high),
            }
        )
    return rows


def _accused(row: Mapping[str, Any]) -> list[str]:
    """Return the kinds of findings that say something of the rig."""
    return [kind for kind in row["findings"] if kind not in NO_FAULT]


def _predicts(row: Mapping[str, Any], name: str) -> bool:
    """Whether a law is the true one, or errs no more on a fresh record."""
    errors, true = row["fresh"], row["law"]
    if name == true:
        return True
    allowed = max(errors[true], SAME * row["noise"])
    return name in errors and bool(errors[name] <= (1.0 + SAME) * allowed)


def right(row: Mapping[str, Any]) -> bool:
    """Whether the named law is the true one or an equal one, and a fault is named if there is."""
    if row["truth"] == "backlash":
        return any(parts_of(kind) & {*BACKLASH} for kind in row["findings"])
    return bool(row["named"]) and _predicts(row, row["named"])


def falsely_certain(row: Mapping[str, Any]) -> bool:
    """Whether a law that is not right is recommended without doubt, or a sound rig accused."""
    if row["truth"] == "backlash":
        wrong = [kind for kind in _accused(row) if not parts_of(kind) & {*BACKLASH}]
        return bool(wrong) or (
            bool(row["named"]) and not row["findings"] and not _predicts(row, row["named"])
        )
    if _accused(row):
        return True
    hedged = row["doubt"] or row["findings"] or any(_predicts(row, one) for one in row["equals"])
    return bool(row["named"]) and not right(row) and not hedged


def unsure(row: Mapping[str, Any]) -> bool:
    """Whether what is said is not right, but is said to be in doubt, or not said at all."""
    hedged = not row["named"] or row["doubt"] or row["findings"] or row["equals"]
    return bool(hedged) and not right(row) and not falsely_certain(row)


def summary(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the table: laws named, what was false, coverage by parameter."""
    done = [row for row in rows if "failed" not in row]
    median, processor = (
        float(np.median([row[key] for row in rows])) for key in ("seconds", "processor")
    )
    most = max(row["processor"] for row in rows)
    lines = [
        f"{len(done)} axes, {len(rows) - len(done)} failed; {median:.0f} s a selection (median),"
        f" processor time {processor:.0f} s (median), {most:.0f} s at most",
        f"right or equal law (target {100 * RIGHT:.0f} %): {share([right(row) for row in done])}",
        f"true law named: {share([row['named'] == row['law'] for row in done])}",
        f"not right, and no law named or in doubt: {sum(map(unsure, done))}",
        f"false certainties (target 0): {sum(map(falsely_certain, done))}",
        *(
            f"  axis {row['rig']}, {row['truth']}: {row['named'] or 'no law'}"
            f"{' FALSE' if falsely_certain(row) else ''}; {', '.join(row['findings'])}"
            f"; fresh {row['fresh']}, noise {row['noise']:.3g}"
            for row in done
            if falsely_certain(row) or not right(row)
        ),
    ]
    low, high = COVERED
    intervals = [one for row in done for one in row["intervals"]]
    bounded = [one for one in intervals if one["bounded"]]
    lines.append(
        f"intervals of the true law (target {100 * low:.0f} to {100 * high:.0f} %):"
        f" {share([one['covered'] for one in bounded])}; {len(intervals) - len(bounded)} of"
        f" {len(intervals)} not identified"
    )
    for path in dict.fromkeys(one["path"] for one in bounded):
        own = [one["covered"] for one in bounded if one["path"] == path]
        lines.append(f"  {path:32}{share(own)}")
    return [
        *lines,
        *(f"axis {row['rig']} failed: {row['failed']}" for row in rows if "failed" in row),
    ]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.closed_loop_axes")
    parser.add_argument("--rigs", type=int, default=40)
    parser.add_argument(
        "--numbers", type=int, nargs="+", help="rigs to judge, instead of the first"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--route", default=CHOSEN)
    parser.add_argument("--laws", nargs="*", default=(), help="candidates; the usual ones if none")
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    given = parser.parse_args()
    for line in run(
        given.results,
        rigs=given.numbers or given.rigs,
        seed=given.seed,
        jobs=given.jobs,
        candidates=given.laws,
        route=given.route,
        rated=judge,
    ):
        print(line, flush=True)
    print("\n".join(summary(judged(given.results, given.seed, given.route))))


if __name__ == "__main__":
    main()
