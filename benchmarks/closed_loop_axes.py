"""Axes under position control with LuGre or Stribeck friction: is the law found, do intervals hold?

``python -m benchmarks.closed_loop_axes --rigs 40 --seed 1 --jobs 2``; results are appended to a
file line by line, and a run that was killed goes on where it was.

An axis follows slow and fast moves under a sampled proportional-derivative controller with
feedforward of the acceleration. Recorded are the position by an encoder and the commanded force,
which is held between samples. Each parameter of the law spans two decades.
"""

import argparse
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.rigs import SOLVER, Array, Random, between
from benchmarks.synthetic_truth import judged, run, share
from stickslip import Axis, FrictionLaw, LuGre, Measurement, Stribeck, select
from stickslip.control import closed_loop
from stickslip.errors import StickslipError
from stickslip.identification import RecordFit

TRUTHS = ("lugre", "stribeck")
CANDIDATES = ("coulomb", "coulomb-viscous", "stribeck", "dahl", "lugre")
MOVED = 100.0
"""Steps of the encoder that a record covers at least."""
SAME = 0.10
"""A law whose friction on a fresh record is off by this share of the noise more is an equal one."""
RIGHT, COVERED = 0.90, (0.90, 0.99)
"""Targets: right or equal laws, and coverage of nominal 95 %."""
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


def draw(random: Random, truth: str) -> ControlledAxis:
    """Return a random axis; each parameter spans two decades."""
    inertia = between(random, 1.0, 100.0)
    level = between(random, 2.0, 200.0)
    fast = between(random, 0.05, 0.5)
    surplus = float(random.uniform(1.2, 1.8))
    v_s = between(random, 1e-3, 1e-1) * math.sqrt(fast / 0.15)
    viscous = level / fast * between(random, 0.03, 1.0)
    encoder = between(random, 1e-6, 1e-5)
    if truth == "stribeck":
        law: FrictionLaw = Stribeck(
            kinetic_coefficient=level,
            static_coefficient=level * surplus,
            stribeck_velocity=v_s,
            viscous_coefficient=viscous,
        )
    else:
        stiffness = level / between(random, 5e-6, 5e-4)  # breaks away after 5 um to .5 mm
        law = LuGre(
            kinetic_coefficient=level,
            static_coefficient=level * surplus,
            stribeck_velocity=v_s,
            bristle_stiffness=stiffness,
            bristle_damping=between(random, 0.1, 1.0) * 2.0 * math.sqrt(stiffness * inertia),
            viscous_coefficient=viscous,
        )
    return ControlledAxis(
        axis=Axis(inertia=inertia, offset=level * float(random.uniform(-0.2, 0.2))),
        law=law,
        speeds=(0.2 * v_s, fast),
        bandwidth=between(random, 20.0, 60.0),
        encoder=encoder,
        force_noise=level * between(random, 1e-3, 1e-2),
        rate=1000.0,
        duration=20.0,
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


def record(rig: ControlledAxis, random: Random) -> Measurement:
    """Return a record of the axis under control."""
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
    force = loop.commands + rig.force_noise * random.standard_normal(len(loop.commands))
    position = rig.encoder * np.round(np.asarray(loop.run.at(loop.t)["x"]) / rig.encoder)
    return Measurement(time=loop.t, position=position, force=force)


def moving(random: Random, truth: str) -> tuple[ControlledAxis, Measurement]:
    """Return a random axis and a record of it: one that its controller does move."""
    while True:
        rig = draw(random, truth)
        measurement = record(rig, random)
        if np.ptp(np.asarray(measurement.position)) > MOVED * rig.encoder:
            return rig, measurement


def judge(seed: int, number: int, *, candidates: Sequence[str], route: str) -> dict[str, Any]:
    """Return what selection makes of one random axis."""
    random = np.random.default_rng([seed, number])
    truth = TRUTHS[number % len(TRUTHS)]
    row: dict[str, Any] = {"seed": seed, "rig": number, "truth": truth, "route": route}
    began = time.perf_counter()
    try:
        rig, measurement = moving(random, truth)
        fresh = record(rig, random)
        began = time.perf_counter()
        verdict = select(
            Axis(inertia=1.5 * rig.axis.inertia),
            candidates,
            measurement,
            vary=["friction.*", "mechanism.inertia"],
            route=None if route == CHOSEN else route,
        )
        row["seconds"] = time.perf_counter() - began
        fits = {c.name: c.fit for c in verdict.candidates if c.fit}  # type: ignore[attr-defined]
        row |= {
            "named": verdict.best.name if verdict.best else "",  # type: ignore[attr-defined]
            "verdict": verdict.sentence,
            "fitted_by": next(iter(fits.values())).route,
            "rms": {name: fit.rms for name, fit in fits.items()},
            "fresh": {name: friction_error(rig, fit, fresh) for name, fit in fits.items()},
            "noise": rig.force_noise,
            "intervals": covered(rig, fits.get(truth)),
        }
    except StickslipError as error:
        row |= {"failed": str(error), "seconds": time.perf_counter() - began}
    return row


def friction_error(rig: ControlledAxis, fit: RecordFit, fresh: Measurement) -> float:
    """Return the root mean square error [N] of friction along a fresh motion, without its noise."""
    from stickslip.identification.estimation.bristle_integration import Path, follow

    t, x = np.asarray(fresh.time), np.asarray(fresh.values("position"))
    v = np.gradient(x, t)
    path = Path(time=t, velocity=v, load=np.ones_like(t), travel=np.diff(x))

    def friction(law: FrictionLaw) -> Array:
        if law.states:
            states = follow(law, path, np.zeros((1, 1)))[..., 0]
            return np.asarray(law.force(v, 1.0, tuple(states)))
        return np.asarray(law.force(v, 1.0))  # type: ignore[attr-defined]

    def total(law: FrictionLaw, offset: float) -> Array:
        return friction(law) + offset

    gap = total(fit.law, float(fit.mechanism.offset)) - total(rig.law, rig.axis.offset)  # type: ignore[attr-defined]
    return float(np.sqrt(np.mean(gap**2)))


def covered(rig: ControlledAxis, fit: RecordFit | None) -> list[dict[str, Any]]:
    """Return which bounded intervals of the true law hold the truth."""
    if fit is None:
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
                "bounded": one.bounded,
                "covered": bool(one.low <= true <= one.high),
            }
        )
    return rows


def right(row: Mapping[str, Any]) -> bool:
    """Whether the named law is the true one, or one that errs no more on a fresh record."""
    errors = row["fresh"]
    if row["named"] == row["truth"]:
        return True
    if row["named"] not in errors:
        return False
    allowed = max(errors.get(row["truth"], 0.0), SAME * row["noise"])
    return bool(errors[row["named"]] <= (1.0 + SAME) * allowed)


def summary(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the table: laws named, coverage by parameter."""
    done = [row for row in rows if "failed" not in row]
    median = float(np.median([row["seconds"] for row in rows]))
    lines = [
        f"{len(done)} axes, {len(rows) - len(done)} failed; {median:.0f} s a selection (median)",
        f"right or equal law (target {100 * RIGHT:.0f} %): {share([right(row) for row in done])}",
        f"true law named: {share([row['named'] == row['truth'] for row in done])}",
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
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--route", default=CHOSEN)
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    given = parser.parse_args()
    for line in run(
        given.results,
        rigs=given.rigs,
        seed=given.seed,
        jobs=given.jobs,
        candidates=CANDIDATES,
        route=given.route,
        rated=judge,
    ):
        print(line, flush=True)
    print("\n".join(summary(judged(given.results, given.seed, given.route))))


if __name__ == "__main__":
    main()
