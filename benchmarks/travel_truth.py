"""Random spring-block rigs with known friction: does selection on a few travels name the right law?

``python -m benchmarks.travel_truth --rigs 200 --seed 1 --jobs 2``; results are appended to a file
line by line, and a run that was killed goes on where it was. Of five rigs two have Coulomb, two
Coulomb + viscous, and one Stribeck or Dahl friction.

A verdict is right if it names the true law, or a law with fewer parameters that predicts as well:
its error on noise-free travels at settings that were not measured, within the measured range and up
to 1.5 times beyond it, is at most one standard error of a reading above that of the best candidate.
A law with parameters that were neither measured, given nor fitted is never right.
"""

import argparse
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.rigs import Array, Random, between
from benchmarks.synthetic_truth import judged, run, share
from stickslip import (
    Coulomb,
    CoulombViscous,
    Dahl,
    FrictionLaw,
    Measurement,
    SpringBlock,
    Stribeck,
    select,
    simulate,
)
from stickslip.drives import Pulse
from stickslip.errors import StickslipError
from stickslip.quantities import vary
from stickslip.selection import TravelCandidate, TravelVerdict

RESULTS = "travel_truth.jsonl"
ROUTE = "travels"
TRUTHS = ("coulomb", "coulomb-viscous", "coulomb", "coulomb-viscous", "stribeck")
"""Truths of five rigs in turn; every other Stribeck law is a Dahl law instead."""
MAIN = ("coulomb", "coulomb-viscous")
PARAMETERS = {
    "coulomb": 1, "viscous": 1, "coulomb-viscous": 2, "dahl": 2, "stribeck": 3, "lugre": 5,
}  # fmt: skip
"""What a law has to be given or fitted before it predicts."""
LAWS = tuple(PARAMETERS)
FAST = ("coulomb", "viscous", "coulomb-viscous", "stribeck")
"""Those without bristles, whose runs take a hundredth of the time."""
PLAIN = ("coulomb", "coulomb-viscous")
"""Those that are in question for most rigs, in a fifth of the time of the four."""
GRAVITY = 9.81
T_END = 10.0
TARGET = 0.95
BEYOND = 1.5
"""Largest setting that is predicted, over the largest that was measured."""


@dataclass(frozen=True, kw_only=True)
class TravelRig:
    """A block, its friction, how it was set and how well its travels were read."""

    block: SpringBlock
    law: FrictionLaw
    path: str
    """Parameter that was set."""
    settings: tuple[float, ...]
    repeats: int
    noise: str
    """``"rounded"`` to 1 mm, ``"normal"`` errors of stated size, or ``"unstated"`` ones."""
    error: float
    """Standard error of a reading [m]."""

    def travel(self, setting: float, law: FrictionLaw | None = None) -> float:
        """Return the travel [m] at a setting, of the true law if none is given."""
        block = vary(self.block, "mechanism", {self.path: setting})
        ends = simulate(block, law or self.law, t_end=T_END).at((0.0, T_END))["x"]
        return float(ends[1] - ends[0])


def truth_of(number: int) -> str:
    """Return the name of the law of a rig."""
    name = TRUTHS[number % len(TRUTHS)]
    return "dahl" if name == "stribeck" and number % (2 * len(TRUTHS)) >= len(TRUTHS) else name


def draw(random: Random, truth: str) -> TravelRig:
    """Return a random rig whose block moves at every setting."""
    mass, level = between(random, 0.2, 5.0), between(random, 0.08, 0.6)
    weight = mass * GRAVITY
    count = int(random.integers(3, 7))
    spread = float(random.uniform(1.6, 3.0))
    shares = np.sort(np.geomspace(1.0 / spread, 1.0, count) * random.uniform(0.96, 1.04, count))
    pulled = random.uniform() < 1.0 / 3.0
    excess = float(random.uniform(1.5, 4.0)) * spread
    if pulled:
        largest, duration = excess * level * weight, between(random, 0.05, 0.3)
        block = SpringBlock(mass=mass, drive=Pulse(level=largest, duration=duration))
        path, speed = "mechanism.drive.level", (largest / mass - level * GRAVITY) * duration
    else:
        largest = float(random.uniform(0.06, 0.25))
        stiffness = excess * level * weight / largest
        attached = bool(random.uniform() < 1.0 / 3.0)
        block = SpringBlock(mass=mass, stiffness=stiffness, compression=largest, attached=attached)
        path, speed = "mechanism.compression", largest * math.sqrt(stiffness / mass)
    rounding = 0.001
    settings = tuple(
        float(f"{share * largest:.3g}") if pulled else round(share * largest / rounding) * rounding
        for share in shares
    )
    noise = str(random.choice(("rounded", "normal", "unstated"), p=(0.45, 0.4, 0.15)))
    error = rounding / math.sqrt(12.0) if noise == "rounded" else between(random, 0.0005, 0.002)
    return TravelRig(
        block=block,
        law=_law(random, truth, level, weight, speed),
        path=path,
        settings=settings,
        repeats=int(random.choice((1, 2, 3), p=(0.7, 0.2, 0.1))),
        noise=noise,
        error=error,
    )


def _law(random: Random, truth: str, level: float, weight: float, speed: float) -> FrictionLaw:
    if truth == "coulomb":
        return Coulomb(kinetic_coefficient=level)
    if truth == "coulomb-viscous":
        viscous = between(random, 0.05, 1.0) * level * weight / speed
        return CoulombViscous(kinetic_coefficient=level, viscous_coefficient=viscous)
    if truth == "stribeck":
        return Stribeck(
            kinetic_coefficient=level,
            static_coefficient=level * float(random.uniform(1.1, 1.4)),
            stribeck_velocity=between(random, 0.01, 0.5) * speed,
        )
    return Dahl(kinetic_coefficient=level, bristle_stiffness=level / between(random, 1e-5, 1e-2))


def readings(rig: TravelRig, random: Random) -> Measurement:
    """Return the travels of a rig as somebody would have written them down."""
    trials = []
    for setting in rig.settings:
        true = rig.travel(setting)
        for _ in range(rig.repeats):
            read = round(true, 3) if rig.noise == "rounded" else random.normal(true, rig.error)
            stated = {"rounded": {"travel": 0.0005}, "normal": {"travel": rig.error}}
            trials.append(
                Measurement(
                    travel=float(read),
                    uncertainty=stated.get(rig.noise, {}),
                    uncertainty_kind="rounding" if rig.noise == "rounded" else "standard",
                    overrides={rig.path: setting},
                )
            )
    return Measurement(trials=tuple(trials))


def unseen(rig: TravelRig) -> Array:
    """Return settings that were not measured: between those measured, and beyond them."""
    high = max(rig.settings)
    inside = 0.5 * (np.array(rig.settings[1:]) + np.array(rig.settings[:-1]))
    return np.concatenate([inside, np.linspace(high, BEYOND * high, 4)[1:]])


def judge(
    seed: int, number: int, *, candidates: Sequence[str] = LAWS, route: str = ROUTE
) -> dict[str, Any]:
    """Return what selection makes of the travels of one random rig."""
    random = np.random.default_rng([seed, number])
    truth = truth_of(number)
    row: dict[str, Any] = {"seed": seed, "rig": number, "truth": truth, "route": route}
    rig = draw(random, truth)
    began = time.perf_counter()
    try:
        measurement = readings(rig, random)
        began = time.perf_counter()
        verdict = select(rig.block, candidates, measurement, t_end=T_END)
    except StickslipError as error:
        return row | {"failed": str(error), "seconds": time.perf_counter() - began}
    seconds = time.perf_counter() - began
    assert isinstance(verdict, TravelVerdict)
    best = verdict.best
    row |= {
        "named": best.name if best else None,
        "verdict": verdict.sentence,
        "kind": "pulse" if rig.block.drive else "attached" if rig.block.attached else "free",
        "noise": rig.noise,
        "error": rig.error,
        "settings": len(rig.settings),
        "repeats": rig.repeats,
        "law": repr(rig.law),
        "errors": {c.name: _error(rig, c) for c in verdict.candidates},
        "parameters": {c.name: len(c.fit.estimates) for c in verdict.candidates if c.fit},
        "invented": [c.name for c in verdict.candidates if _invented(c)],
        "intervals": _covered(rig, best) if best and best.name == truth else [],
        "seconds": seconds,
    }
    return row | {"right": _right(row)}


def _error(rig: TravelRig, candidate: TravelCandidate) -> float:
    """Return the root mean square error of a fit on fresh travels [m]."""
    if candidate.fit is None:
        return math.inf
    law = candidate.fit.law
    try:
        errors = [rig.travel(one, law) - rig.travel(one) for one in unseen(rig)]
    except StickslipError:
        return math.inf
    return math.sqrt(float(np.mean(np.square(errors))))


def _invented(candidate: TravelCandidate) -> bool:
    """Whether a law has parameters that must be known and that nobody measured, gave or fitted."""
    fitted = 0 if candidate.fit is None else len(candidate.fit.estimates)
    return fitted < PARAMETERS[candidate.name]


def _right(row: Mapping[str, Any]) -> bool:
    named, errors = row["named"], row["errors"]
    if named is None or named in row["invented"]:
        return False
    best = min(error for name, error in errors.items() if name not in row["invented"])
    simpler = PARAMETERS[named] < PARAMETERS[row["truth"]]
    return named == row["truth"] or (simpler and errors[named] <= best + row["error"])


def _covered(rig: TravelRig, candidate: TravelCandidate) -> list[dict[str, Any]]:
    """Return for each bounded estimate whether its interval holds the true value."""
    rows = []
    for estimate in candidate.fit.estimates if candidate.fit else ():
        true = getattr(rig.law, estimate.path.rpartition(".")[2])
        if estimate.bounded:
            held = estimate.low <= true <= estimate.high
            half = 0.5 * (estimate.high - estimate.low) / max(true, 1e-300)
            rows.append({"path": estimate.path, "held": bool(held), "half": half})
    return rows


def summary(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the tables: right verdicts and coverage by truth, mechanism, readings and settings."""
    failed = [row for row in rows if "failed" in row]
    rows = [row for row in rows if "failed" not in row]
    main = [row for row in rows if row["truth"] in MAIN]
    yield f"{len(rows)} rigs ({len(failed)} failed); target {100 * TARGET:.0f} % right"
    yield f"truth Coulomb or Coulomb + viscous: {share([row['right'] for row in main])}"
    yield f"  the true law itself:      {share([row['named'] == row['truth'] for row in main])}"
    yield f"  no law named:             {share([row['named'] is None for row in main])}"
    wild = [row["named"] in row["invented"] for row in rows]
    yield f"a law with invented parameters is named: {share(wild)}"
    for key, of in (("truth", rows), ("kind", main), ("noise", main), ("settings", main)):
        yield f"right by {key}:"
        for value in sorted({row[key] for row in of}):
            part = [row for row in of if row[key] == value]
            names = sorted({str(row["named"]) for row in part})
            count = ", ".join(f"{n} {sum(str(r['named']) == n for r in part)}" for n in names)
            yield f"  {value!s:18}{share([row['right'] for row in part])}; named: {count}"
    intervals = [one | {"noise": row["noise"]} for row in main for one in row["intervals"]]
    yield f"coverage of nominal 95 %, named law true: {share([one['held'] for one in intervals])}"
    for key in ("path", "noise"):
        for value in sorted({one[key] for one in intervals}):
            held = [one["held"] for one in intervals if one[key] == value]
            yield f"  {value:40}{share(held)}"
    yield f"median time of a selection: {np.median([row['seconds'] for row in rows]):.1f} s"
    for row in main:
        if not row["right"]:
            yield (
                f"rig {row['rig']}: {row['law']}, {row['kind']}, {row['settings']} settings x"
                f" {row['repeats']}, {row['noise']}: named {row['named']}"
            )
    for row in failed:
        yield f"rig {row['rig']} failed: {row['failed']}"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.travel_truth")
    parser.add_argument("--rigs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    sets = {"all": LAWS, "fast": FAST, "plain": PLAIN}
    parser.add_argument("--laws", choices=sets, default="all", help="fast: those without bristles")
    given = parser.parse_args()
    candidates = sets[given.laws]
    for line in run(
        given.results,
        rigs=given.rigs,
        seed=given.seed,
        jobs=given.jobs,
        candidates=candidates,
        route=ROUTE,
        rated=judge,
    ):
        print(line, flush=True)
    print("\n".join(summary(judged(given.results, given.seed, ROUTE))))


if __name__ == "__main__":
    main()
