"""Records with a built-in fault: does a fit say so, or do all of its intervals hold?

``python -m benchmarks.faults --seeds 1 2 3 --jobs 1``; results are appended to a file line by
line, and a run that was killed goes on where it was. ``--clean 40`` counts false alarms instead.
``--route explain`` asks the force balance alone, without a fit, which takes seconds a record.

A fault is *named* if a finding has it, alone or in a group, or, where it is an effect of friction,
if the structure of the force balance has its terms; *wrong* if a finding names something else;
and *nothing named* otherwise.

Each record is of a made-up axis with Coulomb + viscous friction, random in mass, level, motion,
sampling, noise and disturbance, pushed by a planned force or moved by a controller. The 26 faults:

backlash, flexible-coupling, unknown-spring, cogging, imbalance, gravity, wrong-mass;
sensor-delay (12 ms), actuator-delay (6 ms), amplifier-lag (8 ms), sensor-low-pass (8 ms),
clock-skew, stale-force; clipped-force, clipped-sensor, force-gain (10 %), swapped-sign,
aliased-ripple; quantisation, dropped-samples, outliers; level-drift, warm-up, place-dependence
(40 %), asymmetry, stribeck-peak.

A gain error of the force scales mass and friction alike: with an unknown mass, no record can show
it. It is built in, as a wrong mass is, where the mass is given.
"""

import argparse
import json
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.finding_kinds import NEUTRAL, parts_of
from benchmarks.machines import Machine
from benchmarks.rigs import TRUTHS, Random, draw, record
from stickslip import Axis, DirectionDependent, FrictionLaw, Measurement, Stribeck, check, fit
from stickslip.errors import StickslipError
from stickslip.identification import ModelError, RecordFit, model_errors
from stickslip.identification.settings import PROMPT, RecordSettings
from stickslip.identification.terms.findings import asked_of

RESULTS = "faults.jsonl"
ROUTES = ("shooting", "inverse-dynamics", "explain")
DRIFTS = ("drift", "drift of the level", "drift of the offset", "drift of the viscous part")
LATE = ("delay", "lag", "late or elastic")
USUAL = ("effective size",)
"""Kinds of findings of `check` that clean records have as well: they state no fault."""
TRIED = 20
"""Machines that are drawn until one reverses often enough."""


@dataclass(frozen=True, kw_only=True)
class Fault:
    """One thing wrong with a machine or with its record, and the kinds of findings that name it."""

    machine: Callable[[Machine, Random], Machine] = lambda machine, _random: machine
    record: Callable[[Measurement, Random], Measurement] = lambda record, _random: record
    named: tuple[str, ...] = ()
    """Kinds of `ModelError` and of findings of `check` that name it."""
    terms: tuple[str, ...] = ()
    """Kinds of terms of the force balance that are it, where it is an effect of friction."""
    parts: tuple[str, ...] = ()
    """Beginnings of the paths of parameters that are then not 0."""
    law: Callable[[Machine], FrictionLaw | None] = lambda machine: machine.rig.law
    """The law that a machine then has; None where there is none."""
    mass: float = math.nan
    """The mass that is given, over the true one; not a number where it is unknown."""
    free: tuple[str, ...] = ()
    """Paths of estimates that have no true value with this fault."""


def _stroke(machine: Machine) -> float:
    """Return about how far a machine moves [m]: its speed for a second."""
    return machine.rig.speed


def _wave(share: float, length: float, phase: float) -> Callable[[float, float, float], float]:
    def wave(x: float, _t: float, _v: float) -> float:
        return share * math.sin(2.0 * math.pi * x / length + phase)

    return wave


def _level(machine: Machine) -> float:
    return float(machine.rig.law.kinetic_coefficient)  # type: ignore[attr-defined]


def _placed(machine: Machine, random: Random) -> Machine:
    wave = _wave(0.4, _stroke(machine) * random.uniform(0.3, 1.0), random.uniform(0.0, 6.0))
    return replace(machine, level=lambda x, t, v: 1.0 + wave(x, t, v))


def _cogging(machine: Machine, random: Random) -> Machine:
    size = _level(machine) * random.uniform(0.3, 0.5)
    return replace(
        machine,
        extra=_wave(size, _stroke(machine) * random.uniform(0.05, 0.2), random.uniform(0.0, 6.0)),
    )


def _imbalance(machine: Machine, random: Random) -> Machine:
    size = 0.5 * _level(machine) / machine.rig.speed**2
    wave = _wave(size, _stroke(machine) * random.uniform(0.1, 0.3), random.uniform(0.0, 6.0))
    return replace(machine, extra=lambda x, t, v: v * v * wave(x, t, v))


def _spring(machine: Machine, random: Random) -> Machine:
    stiffness = _level(machine) * random.uniform(0.3, 0.8) / _stroke(machine)
    return replace(machine, extra=lambda x, _t, _v: stiffness * x)


def _gravity(machine: Machine, random: Random) -> Machine:
    pull = _level(machine) * random.uniform(0.3, 0.8)
    return replace(machine, extra=lambda _x, _t, _v: pull, closed=True)


def _drift(machine: Machine, random: Random) -> Machine:
    share = random.choice((-1.0, 1.0)) * random.uniform(0.25, 0.4)
    return replace(machine, level=lambda _x, t, _v: 1.0 + share * (t - 0.5))


def _warm(machine: Machine, random: Random) -> Machine:
    share, rate = random.uniform(0.6, 1.0), 3.0
    mean = (1.0 - math.exp(-rate)) / rate
    return replace(machine, viscous=lambda _x, t, _v: 1.0 + share * (math.exp(-rate * t) - mean))


def _asymmetric(machine: Machine, random: Random) -> Machine:
    share = random.choice((-1.0, 1.0)) * random.uniform(0.2, 0.4)
    return replace(
        machine,
        level=lambda _x, _t, v: 1.0 + (share if v > 0.0 else -share),
        viscous=lambda _x, _t, v: 1.0 + (share if v > 0.0 else -share),
    )


def _peak(machine: Machine, random: Random) -> Machine:
    share, speed = random.uniform(0.4, 0.8), random.uniform(0.05, 0.2) * machine.rig.speed
    return replace(machine, level=lambda _x, _t, v: 1.0 + share * math.exp(-((v / speed) ** 2)))


def _by_direction(machine: Machine) -> FrictionLaw:
    law = machine.rig.law
    sides = [machine.level(0.0, 0.0, s) for s in (1.0, -1.0)]
    level, viscous = law.kinetic_coefficient, law.viscous_coefficient  # type: ignore[attr-defined]
    return DirectionDependent(
        forward_kinetic_coefficient=sides[0] * level,
        backward_kinetic_coefficient=sides[1] * level,
        forward_viscous_coefficient=sides[0] * viscous,
        backward_viscous_coefficient=sides[1] * viscous,
    )


def _peaked(machine: Machine) -> FrictionLaw:
    law, share = machine.rig.law, machine.level(0.0, 0.0, 0.0) - 1.0
    v = 0.1 * machine.rig.speed
    return Stribeck(
        kinetic_coefficient=law.kinetic_coefficient,  # type: ignore[attr-defined]
        static_coefficient=law.kinetic_coefficient * (1.0 + share),  # type: ignore[attr-defined]
        stribeck_velocity=v / math.sqrt(-math.log((machine.level(0.0, 0.0, v) - 1.0) / share)),
        viscous_coefficient=law.viscous_coefficient,  # type: ignore[attr-defined]
    )


def _late_clock(found: Measurement, random: Random) -> Measurement:
    """Return a record whose force was stamped by a clock that is fast by a thousandth."""
    time_, force = np.asarray(found.time), np.asarray(found.values("force"))
    skew = random.choice((-1.0, 1.0)) * random.uniform(1e-3, 2e-3)
    return replace(found, force=np.interp(time_ * (1.0 + skew), time_, force))


def _stale(found: Measurement, _random: Random) -> Measurement:
    """Return a record whose force was logged at 50 Hz and repeated in between."""
    every = round(1.0 / (50.0 * float(np.median(np.diff(found.time)))))
    force = np.asarray(found.values("force"))
    return replace(found, force=force[np.arange(len(force)) // every * every])


def _sensor_range(found: Measurement, _random: Random) -> Measurement:
    force = np.asarray(found.values("force"))
    most = 0.6 * float(np.max(np.abs(force)))
    return replace(found, force=np.clip(force, -most, most))


def _gained(found: Measurement, random: Random) -> Measurement:
    factor = 1.0 + random.choice((-1.0, 1.0)) * 0.1
    return replace(found, force=factor * np.asarray(found.values("force")))


def _rippled(found: Measurement, random: Random) -> Measurement:
    """Return a record with a ripple of the amplifier that sampling brought down to 2 to 40 Hz."""
    time_, force = np.asarray(found.time), np.asarray(found.values("force"))
    low = 2.0 * math.pi * random.uniform(2.0, 40.0)
    ripple = random.uniform(0.1, 0.3) * float(np.std(force)) * np.sin(low * time_)
    return replace(found, force=force + ripple)


def _coarse(found: Measurement, random: Random) -> Measurement:
    x = np.asarray(found.values("position"))
    step = float(np.ptp(x)) / random.uniform(60.0, 300.0)
    return replace(found, position=step * np.round(x / step))


def _dropped(found: Measurement, random: Random) -> Measurement:
    """Return a record of a logger that lost rows and numbered the rest as if it had not."""
    time_ = np.asarray(found.time)
    count = len(time_)
    kept = np.ones(count, dtype=bool)
    for first in random.integers(0, count - 30, 30):
        kept[first : first + int(random.integers(5, 25))] = False
    left = int(kept.sum())
    return replace(
        found,
        time=time_[:left],
        position=np.asarray(found.position)[kept],
        force=np.asarray(found.force)[kept],
    )


def _outlying(found: Measurement, random: Random) -> Measurement:
    x = np.asarray(found.values("position")).copy()
    where = random.choice(len(x), 20, replace=False)
    x[where] += random.choice((-1.0, 1.0), 20) * random.uniform(0.02, 0.2, 20) * float(np.ptp(x))
    return replace(found, position=x)


FAULTS: Mapping[str, Fault] = {
    "backlash": Fault(
        machine=lambda m, r: replace(
            m, split=0.5, frequency=60.0, gap=_stroke(m) * float(r.uniform(0.01, 0.03))
        ),
        named=("backlash", "late or elastic"),
    ),
    "flexible-coupling": Fault(
        machine=lambda m, r: replace(
            m, split=float(r.uniform(0.4, 0.7)), frequency=float(r.uniform(6.0, 25.0))
        ),
        named=("flexibility", "late or elastic"),
    ),
    "unknown-spring": Fault(machine=_spring, named=("position force", "spring")),
    "cogging": Fault(machine=_cogging, named=("position force",)),
    "imbalance": Fault(machine=_imbalance, named=("imbalance", "position force")),
    "gravity": Fault(
        machine=_gravity,
        terms=("offset",),
        parts=("mechanism.offset",),
        free=("mechanism.offset",),
    ),
    "wrong-mass": Fault(mass=0.85, named=("inertia",)),
    "sensor-delay": Fault(
        machine=lambda m, _r: replace(m, position_delay=0.012), named=LATE
    ),
    "actuator-delay": Fault(machine=lambda m, _r: replace(m, force_delay=0.006), named=LATE),
    "amplifier-lag": Fault(machine=lambda m, _r: replace(m, force_lag=0.008), named=LATE),
    "sensor-low-pass": Fault(
        machine=lambda m, _r: replace(m, position_lag=0.008), named=LATE
    ),
    "clock-skew": Fault(record=_late_clock, named=("clock",)),
    "stale-force": Fault(record=_stale, named=(*LATE, "held samples")),
    "clipped-force": Fault(
        machine=lambda m, r: replace(m, force_limit=float(r.uniform(0.5, 0.7)), closed=False),
        named=("force limit",),
    ),
    "clipped-sensor": Fault(record=_sensor_range, named=("saturation", "force limit")),
    "force-gain": Fault(record=_gained, named=("inertia",), mass=1.0),
    "swapped-sign": Fault(
        record=lambda found, _r: replace(found, force=-np.asarray(found.values("force"))),
        named=("force sign", "units", "drive"),
    ),
    "aliased-ripple": Fault(record=_rippled, named=("ripple in time",)),
    "quantisation": Fault(record=_coarse, named=("quantisation", "reversals")),
    "dropped-samples": Fault(record=_dropped, named=("dropped samples", "jump", "gap")),
    "outliers": Fault(record=_outlying, named=("jump", "outliers")),
    "level-drift": Fault(machine=_drift, named=DRIFTS),
    "warm-up": Fault(machine=_warm, named=DRIFTS),
    "place-dependence": Fault(
        machine=_placed, law=lambda _m: None, named=("law",), terms=("level_ripple", "level_slope"),
        parts=("friction.level_position",),
    ),
    "asymmetry": Fault(
        machine=_asymmetric,
        law=_by_direction,
        named=("law",),
        terms=("viscous_dir", "power_dir"),
        parts=("friction.forward_",),
        free=("mechanism.offset",),
    ),
    "stribeck-peak": Fault(
        machine=_peak,
        law=_peaked,
        named=("law",),
        terms=("stribeck",),
        parts=("friction.stribeck_velocity",),
        free=("friction.kinetic_coefficient",),
    ),
}  # fmt: skip
"""What is built in, by name."""


def machine_of(random: Random) -> Machine:
    """Return a random machine without a fault."""
    rig = draw(random, "coulomb-viscous")
    rig = replace(
        rig,
        rate=float(random.choice((500.0, 1000.0))),
        duration=float(random.uniform(10.0, 20.0)),
        noise=float(10.0 ** random.uniform(-6.0, -5.0)),
        disturbance=float(random.choice((0.0, 0.01, 0.02))),
        axis=replace(rig.axis, offset=0.0),
    )
    return Machine(rig=rig, closed=bool(random.integers(2)))


def moving(machine: Machine, random: Random) -> Measurement:
    """Return a record of a machine that reverses often enough."""
    for _ in range(TRIED):
        found = machine.run(random)
        if found is not None:
            return found
    raise StickslipError("no further record of the machine reverses.")


def faulty(name: str, random: Random) -> tuple[Machine, Measurement]:
    """Return a machine with a fault and its record."""
    fault = FAULTS[name]
    for _ in range(TRIED):
        machine = fault.machine(machine_of(random), random)
        found = machine.run(random)
        if found is not None:
            return machine, fault.record(found, random)
    raise StickslipError(f"no machine with {name} reverses.")


def warnings_of(mechanism: Axis, measurement: Measurement) -> list[str]:
    """Return the kinds of what `check` warns of."""
    return [
        one.kind
        for one in check(measurement, mechanism=mechanism).findings
        if one.severity != "info" and one.kind not in USUAL
    ]


def outside(
    found: RecordFit, law: FrictionLaw, axis: Axis, free: Sequence[str], *, times: float = 1.0
) -> list[str]:
    """Return which true values lie outside so many times the interval, with estimate over truth."""
    wrong = []
    for one in found.estimates:
        room, _, field = one.path.partition(".")
        true = getattr(law if room == "friction" else axis, field)
        low, high = (one.value + times * (end - one.value) for end in (one.low, one.high))
        if one.bounded and one.path not in free and not low <= true <= high:
            wrong.append(f"{field} {one.value / true if true else one.value:.3g}")
    return wrong


def outcome(
    errors: Sequence[ModelError], beside: Sequence[str], right: Sequence[str]
) -> dict[str, Any]:
    """Return what findings are worth where some kinds are right, with with those `beside` them."""
    kinds = [one.kind for one in errors]
    wrong = [k for k in kinds if k not in NEUTRAL and not parts_of(k) & {*right}]
    named = any(parts_of(kind) & {*right} for kind in [*kinds, *beside])
    return {
        "said": [*beside, *kinds],
        "kinds": kinds,
        "named": named,
        "false": wrong,
        "sentences": [one.finding for one in errors],
    }


def explained(
    mechanism: Axis, measurement: Measurement, unknown: Sequence[str], right: Sequence[str]
) -> dict[str, Any]:
    """Return what `check` and the force balance alone say of a record, and for how much time."""
    began = time.process_time()
    warned = warnings_of(mechanism, measurement)
    hold = RecordSettings().holding
    asked = asked_of(mechanism, measurement, hold, unknown, PROMPT)
    if asked is None:
        return {"structure": "", **outcome((), warned, right), "seconds": 0.0}
    found = asked.explanation
    structure = found.best.structure
    errors = model_errors(found, measurement, hold, PROMPT)
    terms = [term.kind for term in structure.free] + ["memory"] * bool(structure.memories)
    return {
        "structure": str(structure),
        "left": found.left,
        "terms": terms,
        **outcome(errors, [*warned, *(term for term in terms if term in right)], right),
        "seconds": time.process_time() - began,
    }


def judge(name: str, seed: int, route: str) -> dict[str, Any]:
    """Return what a fit of the right law says of a record with a fault."""
    fault = FAULTS[name]
    random = np.random.default_rng([seed, list(FAULTS).index(name)])
    row: dict[str, Any] = {"fault": name, "seed": seed, "route": route}
    machine, measurement = faulty(name, random)
    axis, law = machine.rig.axis, machine.rig.law
    row |= {"closed": machine.closed, "disturbance": machine.rig.disturbance}
    given = axis.inertia * (fault.mass if math.isfinite(fault.mass) else 1.0)
    unknown = () if math.isfinite(fault.mass) else ("mechanism.inertia",)
    if route == "explain":
        right = (*fault.named, *fault.terms)
        return row | explained(Axis(inertia=given), measurement, unknown, right)
    began = time.perf_counter()
    try:
        found = fit(
            Axis(inertia=given),
            type(law),
            measurement,
            vary=["friction.*", *unknown],
            route=route,
            settings=RecordSettings(starts=2),
        )
    except StickslipError as error:
        kinds = warnings_of(axis, measurement)
        return row | {
            "refused": str(error),
            "said": kinds,
            "named": bool({*kinds} & {*fault.named}),
            "false": [],
        }
    assert isinstance(found, RecordFit)
    return row | {
        "wrong": outside(found, law, axis, fault.free),
        "far": outside(found, law, axis, fault.free, times=2.0),
        **outcome(found.model_errors, warnings_of(found.mechanism, measurement), fault.named),
        "seconds": time.perf_counter() - began,
    }


def clean(number: int, seed: int, route: str) -> dict[str, Any]:
    """Return what is said of a record without a fault, fitted by the law that made it."""
    random = np.random.default_rng([seed, 1000 + number])
    truth = ("coulomb-viscous", "machine", "stribeck", "dahl")[number % 4]
    row: dict[str, Any] = {"fault": f"clean {number}", "seed": seed, "route": route}
    row |= {"truth": truth}
    if truth == "machine":
        found_machine = None
        while found_machine is None:
            machine = machine_of(random)
            found_machine = machine.run(random)
        law, axis, measurement = machine.rig.law, machine.rig.axis, found_machine
    else:
        assert truth in TRUTHS
        rig = draw(random, truth)
        law, axis, (measurement, _) = rig.law, rig.axis, record(rig, random)
    if route == "explain":
        return row | explained(Axis(inertia=1.0), measurement, ("mechanism.inertia",), ())
    plain = ("kinetic_coefficient", "bristle_stiffness", "viscous_coefficient")
    free = plain if truth == "dahl" else ("friction.*",)
    try:
        found = fit(
            Axis(inertia=1.0), type(law), measurement, vary=[*free, "mechanism.inertia"],
            route=route, settings=RecordSettings(starts=2),
        )  # fmt: skip
    except StickslipError as error:
        return row | {"refused": str(error), **outcome((), (), ())}
    assert isinstance(found, RecordFit)
    return row | {
        "wrong": outside(found, law, axis, ()),
        "far": outside(found, law, axis, (), times=2.0),
        **outcome(found.model_errors, (), ()),
    }


def stored(path: Path) -> list[dict[str, Any]]:
    """Return the results in a file; a last line that was cut off does not count."""
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return rows


def run(
    path: Path,
    tasks: Sequence[tuple[Callable[..., dict[str, Any]], tuple[Any, ...], str]],
    jobs: int,
) -> Iterator[str]:
    """Do what a file does not hold yet, append it, and yield progress.

    A task is a function, its arguments and the name of the fault in its row.
    """
    done = {(row["fault"], row["seed"], row["route"]) for row in stored(path)}
    left = [(call, given) for call, given, key in tasks if (key, *given[1:]) not in done]
    cut = path.exists() and bool(path.stat().st_size) and not path.read_bytes().endswith(b"\n")
    with path.open("a", encoding="utf-8") as file, ProcessPoolExecutor(jobs) as pool:
        file.write("\n" if cut else "")
        for task in as_completed([pool.submit(call, *given) for call, given in left]):
            row = task.result()
            file.write(json.dumps(row) + "\n")
            file.flush()
            said = row.get("refused") or f"said {row['said']}, outside {row.get('wrong', [])}"
            verdict = "WRONG" if row.get("false") else "named" if row.get("named") else "-"
            yield (
                f"{row['fault']}, seed {row['seed']}: {verdict}, {said}"
                f" | {row.get('structure', '')}"
            )


def certain(row: Mapping[str, Any]) -> bool:
    """Whether a parameter is outside its interval and nothing was said."""
    return bool(row.get("wrong")) and not row["said"]


def summary(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the table by fault, and the shares of named faults and of false certainty."""
    lines = [
        f"{'fault':20} {'records':>7} {'named':>5} {'nothing':>7} {'wrong':>5} {'outside':>7}"
        f" {'silent':>6}  said"
    ]
    for name in FAULTS:
        own = [row for row in rows if row["fault"] == name]
        if own:
            kinds = sorted({kind for row in own for kind in row["said"]})
            lines.append(
                f"{name:20} {len(own):7} {sum(row['named'] for row in own):5}"
                f" {sum(not (row['named'] or row['false']) for row in own):7}"
                f" {sum(bool(row['false']) for row in own):5}"
                f" {sum(bool(row.get('wrong')) for row in own):7}"
                f" {sum(map(certain, own)):6}  {', '.join(kinds)}"
            )
    faults = [row for row in rows if row["fault"] in FAULTS]
    if faults:
        named = sum(row["named"] for row in faults)
        lines += [
            f"named, alone or in a group: {named} of {len(faults)};"
            f" wrong: {sum(bool(row['false']) for row in faults)}",
            f"a parameter outside its 95 % interval and nothing said:"
            f" {sum(map(certain, faults))} of {len(faults)}; outside twice its interval:"
            f" {sum(bool(row.get('far')) and not row['said'] for row in faults)}",
        ]
        lines += [
            f"  {row['fault']}, seed {row['seed']}: {row['sentences']}"
            for row in faults
            if row["false"]
        ]
    controls = [row for row in rows if row["fault"].startswith("clean")]
    if controls:
        alarms = [row for row in controls if row["sentences"]]
        lines.append(f"accused: {len(alarms)} of {len(controls)} clean records")
        outer = sum(bool(row.get("wrong")) for row in controls)
        far = sum(bool(row.get("far")) for row in controls)
        lines.append(
            f"of these, {outer} have a parameter outside its interval, {far} outside twice"
        )
        lines += [f"  {row['fault']}, {row['truth']}: {row['sentences']}" for row in alarms]

    return lines


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    parser.add_argument("--faults", nargs="+", choices=FAULTS, default=list(FAULTS))
    parser.add_argument("--clean", type=int, default=0, help="clean records a seed, and no faults")
    parser.add_argument("--route", choices=ROUTES, default="shooting")
    given = parser.parse_args()
    tasks: list[tuple[Callable[..., dict[str, Any]], tuple[Any, ...], str]] = []
    for seed in given.seeds:
        if given.clean:
            tasks += [(clean, (k, seed, given.route), f"clean {k}") for k in range(given.clean)]
        else:
            tasks += [(judge, (name, seed, given.route), name) for name in given.faults]
    for line in run(given.results, tasks, given.jobs):
        print(line, flush=True)
    rows = [
        row for row in stored(given.results)
        if row["seed"] in given.seeds and row["route"] == given.route
    ]  # fmt: skip
    print("\n".join(summary(rows)))


if __name__ == "__main__":
    main()
