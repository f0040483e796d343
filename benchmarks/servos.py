"""Servos: do intervals of motor and gear hold, and which gear law does a measured servo ask for?

``python -m benchmarks.servos --rigs 20 --seed 1`` makes up hobby servos: a motor with unknown
resistance and torque constant, a gear with the friction of `BamM4`, an arm of known mass, and a
position loop that samples, with an encoder of 4096 counts and a PWM of 885. The law, R and k_t are
fitted to the angle and the voltage that such a servo reports. Counted is how many nominal 95 %
intervals hold the true value, and whether the pairs that the record does not separate are named.
With ``--current 0.01`` it reports its current too, with so much noise [A], and the mass of the arm
is not known either.

``python -m benchmarks.servos --measured`` fits laws to two measured sets of ``STICKSLIP_DATA`` and
prints the tables of the how-to guide on servos. Of the servo in ``bam_xl330``, each law is fitted
to the records of all gains but one, and its error is that on the gain that was left out; of the
pendulum in ``simple_pendulum_drive``, to all records but one.

Results are appended to a file line by line, and a run that was killed goes on where it was.
"""

import argparse
import json
import math
import os
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.friction.definition import error_of_segments
from benchmarks.friction.records import (
    DROOP,
    DUTIES,
    SUPPLY,
    SWINGS,
    UNKNOWN,
    Log,
    joined,
    logs,
    swing,
)
from benchmarks.rigs import Random, between
from benchmarks.synthetic_truth import judged, run, share
from stickslip import BamM4, FrictionLaw, Measurement, Pendulum, RecordSettings, fit, simulate
from stickslip.errors import StickslipError
from stickslip.friction import LAWS, law
from stickslip.mechanisms import DCMotor, PositionLoop
from stickslip.mechanisms.drives import Sampled
from stickslip.study.control import PID, closed_loop

VARIED = ("mechanism.drive.resistance", "mechanism.drive.torque_constant")
MASS = "mechanism.mass"
COUNT = 2.0 * math.pi / 4096
"""Step of the encoder [rad]."""
PERIOD, DURATION = 4e-3, 16.0
"""Of the loop, and of a record [s]."""
TOGETHER = 0.95
"""Correlation beyond which two estimates are named together."""
RESULTS, MEASURED = "servos.jsonl", "servo_laws.jsonl"
SERVO, SWING = "bam_xl330", "simple_pendulum_drive"
"""The measured sets."""


@dataclass(frozen=True, kw_only=True)
class Servo:
    """A servo with an arm, its friction, and the goal that it follows."""

    rig: Pendulum
    law: BamM4
    gain: float
    """Of the position loop [V/rad]."""
    swings: tuple[tuple[float, float, float], ...]
    """Amplitude [rad], frequency [Hz] and phase of the parts of the goal."""

    def goal(self, t: float) -> float:
        """Return the goal [rad] at a time."""
        return sum(a * math.sin(2.0 * math.pi * f * t + phase) for a, f, phase in self.swings)


def draw(random: Random) -> Servo:
    """Return a random servo; what its gear takes grows with the torque that it transmits."""
    arm, length = between(random, 0.2, 0.6), between(random, 0.08, 0.14)
    weight = arm * 9.81 * length
    k_t = weight / between(random, 0.6, 1.4)
    motor = DCMotor(
        resistance=SUPPLY * k_t / weight / between(random, 2.5, 5.0),
        torque_constant=k_t,
        rotor_inertia=arm * length**2 * between(random, 0.1, 0.6),
        supply=SUPPLY,
    )
    kinetic = weight * between(random, 0.03, 0.1)
    friction = BamM4(
        kinetic_coefficient=kinetic,
        static_coefficient=kinetic * float(random.uniform(1.2, 1.8)),
        transmitted_coefficient=between(random, 0.08, 0.25),
        transmitted_static_surplus=between(random, 0.03, 0.1),
        stribeck_velocity=between(random, 0.2, 0.8),
        fading_exponent=1.0,
        viscous_coefficient=weight * between(random, 0.02, 0.08),
    )
    swings = (
        (float(random.uniform(0.5, 0.9)), between(random, 0.3, 0.6), float(random.uniform(0, 6))),
        (float(random.uniform(0.2, 0.5)), between(random, 0.9, 1.6), float(random.uniform(0, 6))),
    )
    rig = Pendulum(mass=arm, length=length, drive=motor)
    return Servo(rig=rig, law=friction, gain=between(random, 15.0, 40.0), swings=swings)


def recorded(servo: Servo, noise: float | None = None) -> Measurement:
    """Return what a servo reports: angle, voltage and goal at each sample of its loop.

    And, with some noise [A], its current.
    """
    pid = PID(proportional=servo.gain, reference=servo.goal, state="theta", rate=None, limit=SUPPLY)
    loop = closed_loop(
        servo.rig,
        servo.law,
        pid,
        period=PERIOD,
        t_end=DURATION,
        limit=SUPPLY,
        step=SUPPLY / DUTIES,
        quantisation={"theta": COUNT},
        y0={"theta": 0.5 * servo.goal(0.0)},
    )
    record = Measurement(
        time=loop.t,
        position=loop.measured["theta"],
        voltage=loop.commands,
        reference=[servo.goal(t) for t in loop.t],
        turning=True,
    )
    if noise is None:
        return record
    motor = servo.rig.drive
    assert isinstance(motor, DCMotor)
    current = motor.current(loop.commands, 0.0, loop.run.at(loop.t)["omega"])
    scatter = np.random.default_rng(len(loop.t)).standard_normal(len(loop.t))
    return replace(record, current=current + noise * scatter)


def rate(
    seed: int,
    number: int,
    *,
    candidates: Sequence[str],
    route: str,
    current: float | None = None,
) -> dict[str, Any]:
    """Return how the intervals of one servo are."""
    del candidates
    random = np.random.default_rng([seed, number])
    servo = draw(random)
    began = time.process_time()
    row: dict[str, Any] = {"seed": seed, "rig": number, "truth": "bam-m4", "route": route}
    record = recorded(servo, current)
    motor = servo.rig.drive
    assert isinstance(motor, DCMotor)
    off = np.exp(random.uniform(-0.3, 0.3, 2))
    guess = replace(
        motor,
        resistance=motor.resistance * float(off[0]),
        torque_constant=motor.torque_constant * float(off[1]),
    )
    true = {f"friction.{name}": getattr(servo.law, name) for name in servo.law.fit_order}
    true |= dict(zip(VARIED, (motor.resistance, motor.torque_constant), strict=True))
    rig, varied = replace(servo.rig, drive=guess), [*VARIED]
    if current is not None:
        true[MASS] = servo.rig.mass
        rig = replace(rig, mass=rig.mass * float(np.exp(random.uniform(-0.3, 0.3))))
        varied.append(MASS)
    try:
        result: Any = fit(
            rig,
            BamM4,
            record,
            vary=["friction.*", *varied],
            fixed={"fading_exponent": 1.0},
            route=route,
            settings=RecordSettings(hold="zero"),
        )
    except StickslipError as error:
        return row | {"error": str(error), "seconds": time.process_time() - began}
    estimates = {estimate.path: estimate for estimate in result.estimates}
    table, paths = result.correlation, tuple(estimates)
    pairs = [
        (i, j)
        for i in range(len(paths))
        for j in range(i)
        if np.isfinite(table[i, j]) and abs(table[i, j]) > TOGETHER
    ]
    symbols = [estimates[path].quantity.symbol for path in paths if path in estimates]
    said = " ".join(result.sentences)
    return row | {
        "seconds": time.process_time() - began,
        "residual": result.verdict.closest.left,
        "true": {path: true[path] for path in paths if path in true},
        "found": {
            path: [estimate.value, estimate.low, estimate.high, estimate.reason]
            for path, estimate in estimates.items()
        },
        "pairs": [[symbols[j], symbols[i]] for i, j in pairs],
        "named": [f"{symbols[j]} and {symbols[i]} are" in said for i, j in pairs],
        "said": list(result.sentences),
    }


def summary(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the coverage of intervals, of all and by parameter, and what was named."""
    hits: dict[str, list[bool]] = {}
    unbounded: dict[str, int] = {}
    for row in rows:
        for path, true in row.get("true", {}).items():
            _, low, high, reason = row["found"][path]
            name = path.rpartition(".")[2]
            if reason or not math.isfinite(high - low):
                unbounded[name] = unbounded.get(name, 0) + 1
            else:
                hits.setdefault(name, []).append(low <= true <= high)
    every = [hit for own in hits.values() for hit in own]
    failed = [row for row in rows if "error" in row]
    yield f"{len(rows)} servos, {len(failed)} without a fit: {[row['error'] for row in failed]}"
    yield f"coverage of nominal 95 %: {share(every)}"
    for name, own in hits.items():
        yield f"  {name:28} {share(own)}; {unbounded.get(name, 0)} without an interval"
    named = [item for row in rows for item in row.get("named", ())]
    yield f"pairs with a correlation above {TOGETHER}: {len(named)}, named {sum(named)}"
    both = [["R", "k_t"] in row.get("pairs", ()) for row in rows if "error" not in row]
    yield f"R and k_t among them: {share(both)}"
    seconds = [row["seconds"] for row in rows]
    yield f"processor time: median {np.median(seconds):.0f} s, largest {max(seconds):.0f} s"


GAINS = (100, 200, 800)
"""Gains of the measured servo, in its own unit; one in turn is held out."""
MEASURED_LAWS = (
    "bam-m1",
    "bam-m2",
    "bam-m3",
    "level + weight[motor] + weight[external] + viscous",
    "bam-m4",
    "bam-m5",
    "bam-m6",
)
"""The simplest first."""
PUBLISHED = {
    "bam-m1": (0.370052, 3.498350, 1.989815e-3, -0.0017672),
    "bam-m2": (0.380826, 3.607591, 1.914722e-3, 0.0272997),
    "bam-m3": (0.291467, 2.000000, 2.596131e-3, 0.0155472),
    "bam-m4": (0.291545, 2.000000, 2.578254e-3, 0.0154950),
    "bam-m5": (0.285759, 2.000035, 2.568503e-3, 0.0162368),
    "bam-m6": (0.286386, 2.000017, 2.569775e-3, 0.0155359),
}
"""k_t [N m/A], R [ohm], inertia of the rotor [kg m^2] and zero of the encoder [rad] that Rhoban/bam
publishes for a servo of this type, fitted to other records (``bam/params/xl330``, commit 11bb7ecc);
those of the laws are their `typical` values."""
SETTINGS = RecordSettings(hold="first")
"""Records are fitted under the recorded voltage."""


def closed_loop_error(rig: Pendulum, friction: FrictionLaw, log: Log) -> float:
    """Return the mean absolute error [rad] of the angle over a record simulated in closed loop."""
    motor = rig.drive
    assert isinstance(motor, DCMotor)
    loop, goal = PositionLoop(gain=log.volts), Sampled(times=log.time, values=log.goal)
    motor = replace(motor, loop=loop, drive=goal)
    end = float(log.time[-1])
    first = min(log.off, end)
    start = {"theta": float(log.angle[0])}
    run_on = simulate(replace(rig, drive=motor), friction, t_end=first, y0=start)
    wanted = log.time[log.time <= first]
    angles = [run_on.at(wanted)["theta"]]
    if first < end:
        last = {name: float(run_on[name][-1]) for name in ("theta", "omega")}
        opened = replace(rig, drive=replace(motor, drive=None, loop=None, current_limit=0.0))
        rest = log.time[log.time > first]
        drop = simulate(opened, friction, t_end=end - first, y0=last)
        angles.append(drop.at(rest - first)["theta"])
    return float(np.mean(np.abs(np.concatenate(angles) - log.angle)))


def of_servo(folder: Path, name: str) -> dict[str, Any]:
    """Return what a law makes of the servo, with one gain in turn left out."""
    every = logs()
    rig = Pendulum(
        mass=0.49,
        length=0.1,
        gravity=9.80665,
        rest_angle=0.0,
        drive=DCMotor(
            resistance=4.0,
            torque_constant=0.4,
            rotor_inertia=1e-3,
            current_limit=100.0,
        ),
    )
    free = ["mechanism.rest_angle", *(f"mechanism.drive.{item}" for item in UNKNOWN)]

    def fitted(chosen: Sequence[Log]) -> Any:
        kind = LAWS.get(name) or law(name)
        return fit(rig, kind, joined(chosen), vary=["friction.*", *free], settings=SETTINGS)

    results, held_out = fitted(every), {}
    for gain in map(str, GAINS):
        part = fitted([item for item in every if str(item.gain) != gain])
        left_out = [item for item in every if str(item.gain) == gain]
        held_out[gain] = error_of_segments(part, joined(left_out), 1.0, "first").value
    motor = replace(results.mechanism.drive, supply=SUPPLY, supply_resistance=DROOP)
    whole = replace(results.mechanism, drive=motor)
    through = [closed_loop_error(whole, results.law, item) for item in every]
    return {
        **said_of(results),
        "held_out": held_out,
        "loop": through,
        "published": published(name, rig, every),
    }


def published(name: str, rig: Pendulum, every: Sequence[Log]) -> list[float]:
    """Return the errors [rad] over whole records with the parameters that are published."""
    if name not in PUBLISHED:
        return []
    k_t, resistance, rotor, zero = PUBLISHED[name]
    motor = DCMotor(resistance=resistance, torque_constant=k_t, rotor_inertia=rotor, supply=SUPPLY)
    rig = replace(rig, drive=motor, rest_angle=-zero)
    kind = LAWS[name]
    assert kind.typical is not None
    friction = kind(**kind.typical.values)
    return [closed_loop_error(rig, friction, item) for item in every]


def said_of(found: Any) -> dict[str, Any]:
    """Return what a row has of a fit to a whole set."""
    return {
        "title": found.law.title,
        "leaves": found.verdict.closest.left,
        "found": [
            [
                estimate.path,
                estimate.quantity.symbol,
                estimate.value,
                estimate.low,
                estimate.high,
                estimate.reason,
            ]
            for estimate in found.estimates
        ],
        "said": list(found.sentences),
    }


def of_swing(folder: Path, name: str) -> dict[str, Any]:
    """Return what a law makes of the pendulum, with one record in turn left out.

    The torque is in a scale of the drive's own, and so are the mass and the inertia that are found.
    Its laws are few and simple: each search fits those that a law contains.
    """
    every = {item: swing(item) for item in SWINGS}
    rig = Pendulum(mass=0.74, length=0.5, rest_angle=0.0)
    free = ["friction.*", *(f"mechanism.{item}" for item in ("mass", "inertia", "rest_angle"))]

    def fitted(start: Any, friction: Any, chosen: Sequence[str]) -> Any:
        record = Measurement(trials=tuple(every[item] for item in chosen), name="pendulum")
        return fit(start, friction, record, vary=free)

    result = fitted(rig, LAWS.get(name) or law(name), [*every])
    held_out = {}
    for entry, record in every.items():
        part = fitted(result.mechanism, result.law, [other for other in every if other != entry])
        held_out[entry] = error_of_segments(part, record, 0.5).value
    return {**said_of(result), "held_out": held_out}


SETS = {
    SERVO: (of_servo, MEASURED_LAWS),
    SWING: (of_swing, ("viscous", "coulomb", "coulomb-viscous", "stribeck", "bam-m3")),
}
"""What makes the rows of a set, and its laws."""


def measured(file: Path, data: Path, names: Sequence[str]) -> Iterator[str]:
    """Fit laws to the measured sets and append what is found to a file; yield progress."""
    done = {(row["set"], row["law"]) for row in rows_of(file)}
    for place, (rows, usual) in SETS.items():
        for name in names or usual:
            if (place, name) in done:
                continue
            began = time.process_time()
            row: dict[str, Any] = {"set": place, "law": name}
            try:
                row |= rows(data / place, name)
            except StickslipError as error:
                row["error"] = str(error)
            row["seconds"] = time.process_time() - began
            with file.open("a", encoding="utf-8") as out:
                out.write(json.dumps(row) + "\n")
            yield f"{place}, {name}: {row['seconds']:.0f} s {row.get('error', '')}"


def rows_of(file: Path) -> list[dict[str, Any]]:
    """Return the rows of a file; none if there is none."""
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    return [json.loads(line) for line in lines]


PLAIN = {SERVO: ("bam-m1", "bam-m3"), SWING: ("coulomb-viscous",)}
"""A level and a viscous part, and of the servo a share of the torque: with these the other laws are
compared."""
SHARES = ("transmitted", "motor_", "external_")
"""What names of a share of the torque have in them."""


def table(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the lines of the tables of laws, in Markdown."""
    for place in SETS:
        own = [row for row in rows if row["set"] == place]
        if not own:
            continue
        swings = place == SWING
        length = "0.5 s" if swings else "1 s"
        heads = [
            f"held-out error over {length}, mrad",
            *(f"error of {plain} over this" for plain in PLAIN[place]),
            *(["level, N m"] if swings else ["over 6 s in sample, mrad", "as published, mrad"]),
            "share of the torque",
            *(["viscous, N m s/rad"] if swings else ["R, ohm", "k_t, N m/A"]),
        ]
        yield f"{place}:"
        yield f"| law | {' | '.join(heads)} |"
        yield f"|{'---|' * (len(heads) + 1)}"
        known = {row["law"]: row for row in own if "error" not in row}
        plain = [known.get(name) for name in PLAIN[place]]
        for row in own:
            yield f"| {row['law']} | {' | '.join(_cells(row, plain, swings))} |"


def _cells(
    row: Mapping[str, Any], plain: Sequence[Mapping[str, Any] | None], swings: bool
) -> list[str]:
    """Return the cells of a row, behind the name of its law."""
    if "error" in row:
        return [row["error"], *[""] * (len(plain) + (3 if swings else 5))]
    errors = np.array(list(row["held_out"].values()))
    spread = float(np.std(errors, ddof=1)) / math.sqrt(len(errors))
    mean = math.sqrt(float(np.mean(errors**2)))
    digits = 1 if swings else 0
    result = {path.rpartition(".")[2]: rest for path, *rest in row["found"]}
    shares = [
        interval(name, item)
        for name, item in result.items()
        if any(word in name for word in SHARES)
    ]
    other = ("kinetic_coefficient", "viscous_coefficient")
    level, viscous = (interval("", result[item]) if item in result else "-" for item in other)
    through = [
        f"{1e3 * np.mean(row[item]):.0f}" if row.get(item) else "-"
        for item in ("loop", "published")
    ]
    motor = (
        [] if swings else [interval("", result[item]) for item in ("resistance", "torque_constant")]
    )
    gain = [_gain(row, item) if item and item["law"] != row["law"] else "-" for item in plain]
    return [
        f"{1e3 * mean:.{digits}f} ± {1e3 * spread:.{digits}f}",
        *gain,
        *([level] if swings else through),
        ", ".join(shares) or "-",
        *([viscous] if swings else motor),
    ]


def _gain(row: Mapping[str, Any], plain: Mapping[str, Any]) -> str:
    """Return the ratio of two errors, a part that was left out at a time, with a 95 % interval."""
    from scipy.stats import t as student

    ratios = np.log([plain["held_out"][item] / error for item, error in row["held_out"].items()])
    half = float(student.ppf(0.975, len(ratios) - 1) * np.std(ratios, ddof=1) / len(ratios) ** 0.5)
    low, middle, high = np.exp(np.mean(ratios) + np.array([-half, 0.0, half]))
    return f"{middle:.2f} ({low:.2f} to {high:.2f})"


def interval(name: str, found: Sequence[Any]) -> str:
    """Return an estimate with its interval, or without one."""
    symbol, value, low, high, reason = found
    ends = "no interval" if reason else f"{low:.2g} to {high:.2g}"
    return f"{symbol + ' = ' if name else ''}{value:.3g} ({ends})"


def main() -> None:
    """Run the study, or fit the laws to the measured servo, and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rigs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--current", type=float, help="noise of a reported current [A]")
    parser.add_argument("--measured", action="store_true")
    parser.add_argument("--law", action="append", help="of --measured, may be repeated; all if not")
    parser.add_argument("--file", type=Path)
    options = parser.parse_args()
    if options.measured:
        data = os.environ.get("STICKSLIP_DATA", "")
        file = options.file or Path(MEASURED)
        if not data or not all((Path(data) / place).is_dir() for place in SETS):
            parser.error(f"STICKSLIP_DATA must name a folder that has {' and '.join(SETS)}.")
        for line in measured(file, Path(data), options.law or ()):
            print(line, flush=True)
        print(*table(rows_of(file)), sep="\n")
        return
    file = options.file or Path(RESULTS)
    for line in run(
        file,
        rigs=options.rigs,
        seed=options.seed,
        jobs=options.jobs,
        candidates=(),
        rated=partial(rate, current=options.current),
    ):
        print(line, flush=True)
    rows = judged(file, options.seed)
    print(*summary(rows), sep="\n")


if __name__ == "__main__":
    main()
