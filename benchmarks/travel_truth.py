"""Random rigs with known friction: is what a selection states about a few travels true?

``nice python -m benchmarks.travel_truth --rigs 200 --seed 1``; results are appended to a file, and
a run that was killed goes on where it was. Rigs are a block on a spring that it leaves, one that
stays fastened and swings before it rests, an axis that is pushed and a capsule, in turn; truths are
those of `TRUTHS`, of which the last two are not among the candidates. A rig has three to eight
settings, read with errors of 0.1 to 1 mm, stated or not, or rounded. ``--levels`` judges fastened
blocks with Coulomb friction alone, three travels each. ``--fault 0.05`` gives selection a
stiffness, inertia or drive that is wrong by this share, and with ``--drift 0.1`` friction rises or
falls by this share from the first trial to the last, in the order of the settings.

A verdict is *right* if it names the true law, or says that readings cannot tell it from the one
named, or names none, or names one that predicts as well: its error on noise-free travels at
settings that were not measured, within the measured range and up to 1.5 times beyond it, is at most
one standard error of a reading. Friction that differs by direction is Coulomb friction where the
body never turns back. It is a *false certainty* if the law that it names is not right, or
if a parameter of the law that is named, which the truth has too, lies outside of the stated
interval by more than half its width (four standard errors).

Two intervals are judged: that of the first sentence, which holds what every law that is not ruled
out leaves of a parameter, and that of the named law alone, where it is the true one. The second is
the one of which 95 % should hold the truth; the first may hold it more often. ``--fits`` judges the
intervals of `fit` with the true law instead, and selects nothing.
"""

import argparse
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.rigs import Array, Random, between
from benchmarks.synthetic_truth import judged, run, share
from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    CoulombViscous,
    DirectionDependent,
    FrictionLaw,
    LuGre,
    Measurement,
    Mechanism,
    PowerViscous,
    SpringBlock,
    Stribeck,
    fit,
    select,
    simulate,
)
from stickslip.errors import StickslipError
from stickslip.identify.fits import Estimate
from stickslip.identify.kinds import TravelVerdict
from stickslip.mechanisms import Torque, slip_of
from stickslip.mechanisms.drives import Pulse, Square
from stickslip.quantities import parameters, vary

RESULTS = "travel_truth.jsonl"
ROUTE = "travels"
KINDS = ("free", "attached", "axis", "capsule")
TRUTHS = (
    "coulomb", "coulomb-viscous", "stribeck", "lugre", "power-viscous", "direction-dependent",
)  # fmt: skip
LAWS = ("coulomb", "viscous", "coulomb-viscous", "stribeck", "dahl", "lugre")
FAST = ("coulomb", "viscous", "coulomb-viscous", "stribeck")
"""Those without bristles, whose runs take a hundredth of the time."""
GRAVITY = 9.81
TARGET = 0.95
BEYOND = 1.5
"""Largest setting that is predicted, over the largest that was measured."""
OUTSIDE = 2.0
"""Half widths of an interval from its middle beyond which a true value makes it false."""
SAME = 1e-6
"""Relative difference of travels, which runs are wrong by, up to which two laws do the same."""
STEPS = {"free": "mechanism.stiffness", "attached": "mechanism.stiffness",
         "axis": "mechanism.inertia", "capsule": "mechanism.drive.drive.high"}  # fmt: skip
"""What is wrong where a mechanism is faulty."""


@dataclass(frozen=True, kw_only=True)
class TravelRig:
    """A mechanism, its friction, how it was set and how well its travels were read."""

    kind: str
    """One of `KINDS`."""
    mechanism: Mechanism
    law: FrictionLaw
    path: str
    """Parameter that was set."""
    settings: tuple[float, ...]
    repeats: int
    noise: str
    """``"rounded"`` to 1 mm, ``"normal"`` errors of stated size, or ``"unstated"`` ones."""
    error: float
    """Standard error of a reading [m]."""
    t_end: float
    """Time after which a body counts as stopped [s]."""
    drift: float = 0.0
    """Share by which friction changes from the first trial to the last."""

    def law_at(self, share: float) -> FrictionLaw:
        """Return the law of a trial, from 0 for the first to 1 for the last."""
        factor = 1.0 + self.drift * share
        forces = {
            path: factor * value
            for path, item, value in parameters(self.law, "friction")
            if item.scale.startswith(("level", "slope", "force"))
        }
        return vary(self.law, "friction", forces) if self.drift else self.law

    def travel(self, setting: float, law: FrictionLaw | None = None) -> float:
        """Return the travel [m] at a setting, of the true law if none is given."""
        rig = vary(self.mechanism, "mechanism", {self.path: setting})
        ends = simulate(rig, law or self.law, t_end=self.t_end).at((0.0, self.t_end))
        moved = ends[slip_of(rig)]
        return float(moved[1] - moved[0])


def draw(random: Random, kind: str, truth: str, *, levels: bool = False) -> TravelRig:
    """Return a random rig whose body moves at every setting.

    With `levels` a block has three settings that are near to each other, and swings up to four
    times: the range in which levels of 1, 1/3 and 1/5 give the same travels is among them.
    """
    mass, level = between(random, 0.2, 5.0), between(random, 0.08, 0.6)
    count, t_end = int(random.integers(3, 9)), 10.0
    spread = float(random.uniform(1.6, 3.0))
    shares = np.sort(np.geomspace(1.0 / spread, 1.0, count) * random.uniform(0.96, 1.04, count))
    excess = float(random.uniform(1.5, 4.0)) * spread
    if levels:
        count, excess = 3, float(random.uniform(1.2, 8.0))
        shares = np.sort(random.uniform(0.8, 1.0, count))
    load = mass * GRAVITY
    rig: Mechanism
    if kind == "axis":
        load, level = 1.0, level * mass * GRAVITY  # friction as a force [N]
        largest, duration = excess * level, between(random, 0.05, 0.3)
        rig = Axis(inertia=mass, drive=Pulse(level=largest, duration=duration))
        path, speed = "mechanism.drive.level", (largest - level) / mass * duration
        settings = tuple(float(f"{item * largest:.3g}") for item in shares)
    elif kind == "capsule":
        mass, level, t_end = between(random, 0.5, 1.5), between(random, 0.08, 0.25), 6.0
        load = mass * GRAVITY
        period = between(random, 0.25, 0.5)
        wave = Square(high=excess * level * load, low=-0.3 * level * load, period=period, duty=0.3)
        rig = Capsule(
            capsule_mass=0.8 * mass, inner_mass=0.2 * mass, stiffness=80.0 * mass,
            damping=0.8 * mass, drive=Torque(drive=wave),
        )  # fmt: skip
        path, speed = "mechanism.drive.drive.period", 0.3
        settings = tuple(round(0.7 * item * period + 0.5 * period, 3) for item in shares)
    else:
        largest = float(random.uniform(0.06, 0.25))
        stiffness = excess * level * load / largest
        rig = SpringBlock(
            mass=mass, stiffness=stiffness, compression=largest, attached=kind == "attached"
        )
        path, speed = "mechanism.compression", largest * math.sqrt(stiffness / mass)
        settings = tuple(round(item * largest, 3) for item in shares)
    noise = str(random.choice(("rounded", "normal", "unstated"), p=(0.3, 0.5, 0.2)))
    return TravelRig(
        kind=kind,
        mechanism=rig,
        law=_law(random, truth, level, load, speed),
        path=path,
        settings=settings,
        repeats=int(random.choice((1, 2), p=(0.8, 0.2))),
        noise=noise,
        error=0.001 / math.sqrt(12.0) if noise == "rounded" else between(random, 1e-4, 1e-3),
        t_end=t_end,
    )


def _law(random: Random, truth: str, level: float, load: float, speed: float) -> FrictionLaw:
    if truth == "coulomb":
        return Coulomb(kinetic_coefficient=level)
    viscous = between(random, 0.05, 1.0) * level * load / speed
    if truth == "coulomb-viscous":
        return CoulombViscous(kinetic_coefficient=level, viscous_coefficient=viscous)
    if truth == "power-viscous":
        exponent = float(random.choice((0.5, 2.0)))
        return PowerViscous(
            kinetic_coefficient=level,
            viscous_coefficient=viscous * speed ** (1.0 - exponent),
            viscous_exponent=exponent,
        )
    if truth == "direction-dependent":
        ratio = float(random.uniform(0.6, 0.9)) ** int(random.choice((-1, 1)))
        return DirectionDependent(
            forward_kinetic_coefficient=level, backward_kinetic_coefficient=ratio * level
        )
    stribeck = Stribeck(
        kinetic_coefficient=level,
        static_coefficient=level * float(random.uniform(1.1, 1.6)),
        stribeck_velocity=between(random, 0.01, 0.7) * speed,
        viscous_coefficient=viscous * float(random.choice((0.0, 1.0))),
    )
    if truth == "stribeck":
        return stribeck
    stiffness = level / between(random, 1e-5, 1e-3)
    return LuGre(
        kinetic_coefficient=level,
        static_coefficient=stribeck.static_coefficient,
        stribeck_velocity=stribeck.stribeck_velocity,
        viscous_coefficient=stribeck.viscous_coefficient,
        bristle_stiffness=stiffness,
        bristle_damping=math.sqrt(stiffness / GRAVITY),
    )


def readings(rig: TravelRig, random: Random) -> Measurement:
    """Return the travels of a rig as somebody would have written them down."""
    trials = []
    places = np.linspace(0.0, 1.0, len(rig.settings)).tolist()
    for setting, place in zip(rig.settings, places, strict=True):
        true = rig.travel(setting, rig.law_at(place))
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
    seed: int,
    number: int,
    *,
    candidates: Sequence[str] = LAWS,
    route: str = ROUTE,
    fault: float = 0.0,
    levels: bool = False,
    drift: float = 0.0,
) -> dict[str, Any]:
    """Return what selection makes of the travels of one random rig."""
    random = np.random.default_rng([seed, number])
    kind = "attached" if levels else KINDS[number % len(KINDS)]
    truth = "coulomb" if levels else TRUTHS[number // len(KINDS) % len(TRUTHS)]
    row: dict[str, Any] = {"seed": seed, "rig": number, "truth": truth, "route": route}
    rig = draw(random, kind, truth, levels=levels)
    rig = replace(rig, drift=drift * float(random.choice((-1.0, 1.0)))) if drift else rig
    began = time.process_time()
    try:
        measurement = readings(rig, random)
        given = _wrong(rig, fault)
        began = time.process_time()
        verdict = select(given, candidates, measurement, t_end=rig.t_end)
    except StickslipError as error:
        return row | {"failed": str(error), "seconds": time.process_time() - began}
    seconds = time.process_time() - began
    assert isinstance(verdict, TravelVerdict)
    best = verdict.best
    ties = [c for c in verdict.candidates[1:] if (c.name,) in verdict.set]
    fits = {c.name: c.fit for c in (best, *ties) if c is not None}
    errors = {name: _error(rig, item.law) if item else math.inf for name, item in fits.items()}
    true = _true_names(rig, truth)
    intervals = _intervals(rig, verdict.intervals if best else ())
    alone = best.fit.estimates if best and best.fit and best.name in true else ()
    said = () if best is None else (best.name, *(c.name for c in ties))
    told = best is None or not true.isdisjoint(said)
    right = told or min(errors.values()) <= rig.error
    false = (not right) or any(interval["far"] for interval in intervals)
    return row | {
        "named": best.name if best else None,
        "ties": [c.name for c in ties],
        "verdict": verdict.sentence,
        "kind": rig.kind,
        "noise": rig.noise,
        "error": rig.error,
        "settings": len(rig.settings),
        "repeats": rig.repeats,
        "law": repr(rig.law),
        "errors": errors,
        "intervals": intervals,
        "alone": _intervals(rig, alone),
        "seconds": seconds,
        "right": right,
        "false": false,
    }


def judge_fit(
    seed: int, number: int, *, candidates: Sequence[str] = LAWS, route: str = ROUTE
) -> dict[str, Any]:
    """Return what a fit with the true law makes of the travels of one random rig."""
    random = np.random.default_rng([seed, number])
    truth = TRUTHS[number // len(KINDS) % len(TRUTHS)]
    row: dict[str, Any] = {"seed": seed, "rig": number, "truth": truth, "route": route}
    rig = draw(random, KINDS[number % len(KINDS)], truth)
    began = time.process_time()
    try:
        measurement = readings(rig, random)
        began = time.process_time()
        result = fit(rig.mechanism, type(rig.law), measurement, t_end=rig.t_end)
    except StickslipError as error:
        return row | {"failed": str(error), "seconds": time.process_time() - began}
    return row | {
        "seconds": time.process_time() - began,
        "kind": rig.kind,
        "law": repr(rig.law),
        "error": rig.error,
        "off": _error(rig, result.law),
        "alone": _intervals(rig, result.estimates),
    }


def _true_names(rig: TravelRig, truth: str) -> set[str]:
    """Return the names of the laws that are the true one in every motion of a rig."""
    law = rig.law
    if isinstance(law, DirectionDependent):
        same = Coulomb(kinetic_coefficient=law.forward_kinetic_coefficient)
        settings = (*rig.settings, *unseen(rig))
        if all(math.isclose(rig.travel(s, same), rig.travel(s), rel_tol=SAME) for s in settings):
            return {truth, same.name}
    return {truth}


def _wrong(rig: TravelRig, fault: float) -> Mechanism:
    """Return the mechanism as somebody gives it who is wrong by a share."""

    path = STEPS[rig.kind]
    known = {name: value for name, _, value in parameters(rig.mechanism, "mechanism")}
    return vary(rig.mechanism, "mechanism", {path: (1.0 + fault) * known[path]})


def _error(rig: TravelRig, law: FrictionLaw) -> float:
    """Return the root mean square error of a fitted law on fresh travels [m]."""
    try:
        errors = [rig.travel(item, law) - rig.travel(item) for item in unseen(rig)]
    except StickslipError:
        return math.inf
    return math.sqrt(float(np.mean(np.square(errors))))


def _intervals(rig: TravelRig, estimates: Sequence[Estimate]) -> list[dict[str, Any]]:
    """Return for each bounded estimate that the truth has too whether its interval holds it."""
    rows = []
    for estimate in estimates:
        name = estimate.path.rpartition(".")[2]
        if isinstance(rig.law, DirectionDependent) and name == "kinetic_coefficient":
            ends = rig.law.forward_kinetic_coefficient, rig.law.backward_kinetic_coefficient
        elif rig.drift and getattr(rig.law, name, None) is not None:
            ends = getattr(rig.law, name), getattr(rig.law_at(1.0), name)
        elif isinstance(rig.law, PowerViscous) and name == "viscous_coefficient":
            continue
        else:
            value = getattr(rig.law, name, None)
            if value is None and name == "viscous_coefficient":
                value = 0.0
            if value is None:
                continue
            ends = value, value
        if not estimate.bounded:
            continue
        low, high = min(ends), max(ends)
        middle, half = 0.5 * (estimate.low + estimate.high), estimate.half_width
        room = OUTSIDE * half + 1e-12
        rows.append(
            {
                "path": estimate.path,
                "held": bool(estimate.low <= high and low <= estimate.high),
                "far": bool(low > middle + room or high < middle - room),
                "half": half / max(abs(low), 1e-300),
                "said": [estimate.low, estimate.high],
                "true": [low, high],
            }
        )
    return rows


def summary(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the tables: right verdicts, false certainties and coverage."""
    failed = [row for row in rows if "failed" in row]
    rows = [row for row in rows if "failed" not in row]
    if rows and "right" not in rows[0]:
        yield f"{len(rows)} rigs ({len(failed)} failed)"
        yield from _coverage("nominal 95 %, fits with the true law", rows, "alone")
        worse = [row["off"] / row["error"] for row in rows]
        yield f"error of unseen travels over that of a reading: median {np.median(worse):.2f}"
        yield from (f"rig {row['rig']} failed: {row['failed']}" for row in failed)
        return
    yield f"{len(rows)} rigs ({len(failed)} failed); target {100 * TARGET:.0f} % right, 0 false"
    yield f"right:             {share([row['right'] for row in rows])}"
    yield f"false certainties: {sum(row['false'] for row in rows)}"
    yield f"no law named:      {share([row['named'] is None for row in rows])}"
    for key in ("truth", "kind", "noise", "settings"):
        yield f"by {key}:"
        for value in sorted({row[key] for row in rows}):
            part = [row for row in rows if row[key] == value]
            names = sorted({str(row["named"]) for row in part})
            count = ", ".join(f"{n} {sum(str(r['named']) == n for r in part)}" for n in names)
            yield (
                f"  {value!s:20}{share([row['right'] for row in part])};"
                f" {sum(row['false'] for row in part)} false; named: {count}"
            )
    yield from _coverage("intervals that hold for every law not ruled out", rows, "intervals")
    yield from _coverage("nominal 95 %, the true law named, if it holds", rows, "alone")
    times = [row["seconds"] for row in rows]
    yield f"processor time: median {np.median(times):.1f} s, largest {max(times):.1f} s"
    for row in rows:
        if row["false"] or not row["right"]:
            far = "; ".join(
                f"{i['path']} {i['said'][0]:.4g} to {i['said'][1]:.4g}, true {i['true']}"
                for i in row["intervals"]
                if i["far"]
            )
            yield (
                f"rig {row['rig']}: {row['law']}, {row['kind']}, {row['settings']} settings x"
                f" {row['repeats']}, {row['noise']} {1e3 * row['error']:.2f} mm: named"
                f" {row['named']}, ties {row['ties']} {far}"
            )
    for row in failed:
        yield f"rig {row['rig']} failed: {row['failed']}"


def _coverage(title: str, rows: Sequence[Mapping[str, Any]], key: str) -> Iterator[str]:
    """Yield which share of intervals holds the truth, by parameter and by law."""
    intervals = [{**item, "truth": row["truth"]} for row in rows for item in row[key]]
    yield f"coverage, {title}: {share([interval['held'] for interval in intervals])}"
    for by in ("path", "truth"):
        for value in sorted({interval[by] for interval in intervals}):
            part = [interval for interval in intervals if interval[by] == value]
            width = np.median([item["half"] for item in part])
            held = share([item["held"] for item in part])
            yield f"  {value:40}{held}; median half width {width:.1%}"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.travel_truth")
    parser.add_argument("--rigs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    sets = {"all": LAWS, "fast": FAST}
    parser.add_argument("--laws", choices=sets, default="all", help="fast: those without bristles")
    parser.add_argument("--fault", type=float, default=0.0, help="share by which a rig is wrong")
    parser.add_argument("--drift", type=float, default=0.0, help="share by which friction drifts")
    parser.add_argument("--levels", action="store_true", help="three travels of fastened blocks")
    parser.add_argument("--fits", action="store_true", help="fits with the true law, no selection")
    given = parser.parse_args()
    rated: Callable[..., dict[str, Any]] = partial(
        judge, fault=given.fault, levels=given.levels, drift=given.drift
    )
    route = f"{ROUTE}{'-levels' if given.levels else ''}{given.fault or ''}"
    route += f"-drift{given.drift}" if given.drift else ""
    if given.fits:
        rated, route = judge_fit, f"{ROUTE}-fits"
    for line in run(
        given.results,
        rigs=given.rigs,
        seed=given.seed,
        jobs=given.jobs,
        candidates=sets[given.laws],
        route=route,
        rated=rated,
    ):
        print(line, flush=True)
    print("\n".join(summary(judged(given.results, given.seed, route))))


if __name__ == "__main__":
    main()
