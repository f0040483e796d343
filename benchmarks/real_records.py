"""Measured records and tables: the first part is judged, and how well that says the second.

``python -m benchmarks.real_records`` judges every public set of one coordinate, of several joints
and of tables that the folder in ``STICKSLIP_DATA`` or the catalogue has (``--only NAME`` those
whose names begin so). No number of the judge may be chosen on a second part. A line has, in the
unit of the force,

* the named law, within which share of friction it stays, and the half-width of the steady band;
* the share of the readings of the second part in their band of 95 %, half its width over the error
  (medians), and the error: root mean square of reading less the middle of the band;
* the error of Coulomb + viscous friction, by least squares with an offset and the same inertia on
  the rows of the first part, and that of the published law where its numbers are known;
* processor time, and each statement that is false as far as anything is known of the set.

Sets that cannot be judged have a line with the reason.
"""

import argparse
import contextlib
import math
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeAlias
from unittest import mock

import numpy as np

from benchmarks.band_verdict import offset_beside
from benchmarks.friction import records as tasks
from stickslip import Axis, Measurement, Pendulum, select
from stickslip.data import catalogue, guess_data, read_data
from stickslip.data.differentiation import rows_of
from stickslip.data.readers.binary import parquet_data
from stickslip.errors import StickslipError
from stickslip.identify import BandVerdict
from stickslip.identify.bands import Array, Foreseen
from stickslip.identify.fits import RecordSettings
from stickslip.identify.joint_request import JointRequest
from stickslip.identify.judgement import Judgement
from stickslip.identify.problems.driven_runs import DrivenProblem
from stickslip.identify.problems.links import JointBalances, told_links
from stickslip.identify.problems.record_columns import Balance
from stickslip.identify.problems.record_curves import OtherRows
from stickslip.identify.problems.record_rows import MIDDLE
from stickslip.identify.problems.records import RecordProblem
from stickslip.identify.problems.table_model import Rows
from stickslip.mechanisms import LINKS

FIRST = 0.6
"""Part of a record that the rest is predicted from."""
SETTLED = 9.6
"""Time [s] from which the tribometer runs evenly, as its source says."""
UNTOUCHED: Mapping[str, float] = {"sac": 4.0, "ilqr": 2.8, "energy_shaping": 5.0}
"""Seconds of the motions of the pendulum in which nobody pushes it."""
TORQUE = 0.025
"""Torque of the motor of a quadruped over its current [N m/A]."""
MASS = ("mechanism.inertia",)
TX40: Mapping[str, tuple[float, float, float]] = {
    "q1": (7.14, 8.05, 0.392),
    "q2": (8.26, 5.53, 1.37),
    "q3": (6.34, 1.97, 0.326),
    "q4": (2.48, 1.11, -0.102),
}
"""Published level [N m], slope [N m s/rad] and offset of joints that no other motor turns."""
MOTORS = ((7.14, 8.05), (8.26, 5.53), (6.34, 1.97), (2.48, 1.11), (3.03, 1.86), (0.282, 0.65))
"""Published level and slope of all joints ..."""
SIXTH = (1.95, 0.616)
"""... and what the sixth motor adds at the joints 5 and 6, with either sign."""
WITHIN = (0.8, 1.2)
"""How far published friction of a robot may be off: those of other authors differ by as much."""


@dataclass(frozen=True, kw_only=True)
class Law:
    """Coulomb + viscous friction as published."""

    level: float
    viscous: float
    offset: float = 0.0
    inertia: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Level:
    """Friction that is known at a speed, or at all of them, under some inputs of the contact."""

    low: float
    high: float
    speed: float = math.nan
    inputs: Mapping[str, float] = field(default_factory=dict)

    def __str__(self) -> str:
        inputs = "".join(f" at {name} {x:g}" for name, x in self.inputs.items())
        return f"{self.low:.3g} to {self.high:.3g}{inputs}"


@dataclass(frozen=True, kw_only=True)
class Case:
    """A record or table, others of the same machine, and what is known of it."""

    name: str
    mechanism: Any
    first: Measurement
    others: Mapping[str, Measurement]
    unknown: Sequence[str] = ()
    """What is looked for of the mechanism."""
    settings: RecordSettings | None = None
    known: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Range in which a parameter is known to be, by path."""
    levels: Sequence[Level] = ()
    most: float = math.inf
    """Largest force of the set: no band is as wide."""
    may_refuse: bool = False
    """Whether it is known to need more than a balance."""
    published: Mapping[str, Law] = field(default_factory=dict)
    """By contact of a joint; the only one is called ""."""


@dataclass(frozen=True, kw_only=True)
class Line:
    """What a verdict on the first part says of the second."""

    name: str
    law: str = ""
    distance: float = math.nan
    """Share of friction within which the law stays."""
    known: float = math.nan
    """Half-width of the band of steady friction, over friction."""
    inside: float = math.nan
    ratio: float = math.nan
    """Half-width of the band of readings over the error, in the median."""
    error: float = math.nan
    plain: float = math.nan
    """Error of Coulomb + viscous friction."""
    handed: float = math.nan
    """Error of the law handed over."""
    interval: str = ""
    """Interval of the inertia."""
    published: float = math.nan
    spread: float = math.nan
    """Root mean square of the readings."""
    seconds: float = math.nan
    false: Sequence[str] = ()
    beside: Sequence[str] = ()
    """What was stated beside the law, in the words of the verdict."""
    reason: str = ""
    """Why it cannot be judged."""

    @property
    def excess(self) -> float:
        """Error over that of Coulomb + viscous friction."""
        return self.error / self.plain

    def __str__(self) -> str:
        false = [f"    FALSE: {item}" for item in self.false]
        if self.reason:
            return "\n".join([f"{self.name:32} not judged: {self.reason}", *false])
        published = "" if math.isnan(self.published) else f", published {self.published:.3g}"
        published += "" if math.isnan(self.handed) else f", law handed over {self.handed:.3g}"
        published += f", inertia {self.interval}" * bool(self.interval)
        lines = [
            f"{self.name:32} {self.law} within {self.distance:.1%}, steady ±{self.known:.1%},"
            f" inside {self.inside:.3f}, half-width over error {self.ratio:.2f}, error"
            f" {self.error:.3g} (C + V {self.plain:.3g}{published}; readings {self.spread:.3g}),"
            f" {self.seconds:.1f} s"
        ]
        lines += false
        lines += [f"    said: {item}" for item in self.beside]
        return "\n".join(lines)


# ---- the sets


def _folder(name: str) -> Path:
    """Return the folder of a set that the catalogue does not fetch."""
    return Path(os.environ.get("STICKSLIP_DATA", ".")) / name


def _table(name: str, file: str) -> Any:
    return parquet_data(catalogue.dataset(name).path(file))


def _parts(record: Measurement, share: float = FIRST) -> tuple[Measurement, Measurement]:
    rows = len(np.asarray(record.time))
    return rows_of(record, 0, int(share * rows)), rows_of(record, int(share * rows), rows)


def emps() -> Iterator[Case]:
    record = catalogue.dataset("emps").measurement("train")
    halves = _parts(record, 0.5)
    for k, name in enumerate(("EMPS, first half", "EMPS, second half")):
        yield Case(
            name=name,
            mechanism=Axis(inertia=100.0),
            first=halves[k],
            others={"other half": halves[1 - k]},
            unknown=MASS,
            # two published estimates, with three of their standard deviations
            known={"mechanism.inertia": (94.78, 95.48)},
            published={"": Law(level=20.3935, viscous=203.5034, offset=-3.1648, inertia=95.1089)},
        )


def tribometer() -> Iterator[Case]:
    table = _table("reciprocating_tribometer", "train")
    table = table[table["t_s"] > SETTLED]
    record = Measurement(
        time=table["t_s"].to_numpy(),
        position=table["x_m"].to_numpy(),
        friction=-table["friction_N"].to_numpy(),
        load=table["normal_N"].to_numpy(),
    )
    first, rest = _parts(record)
    yield Case(name="tribometer", mechanism=Axis(inertia=1.0), first=first, others={"rest": rest})


def _task(name: str) -> Case:
    """Return a record of several joints as the benchmark of methods has it."""
    task = next(item for item in tasks.ROBOT_TASKS if item.name == name)
    first, second = task.split()
    return Case(
        name=task.title.partition(",")[0],
        mechanism=task.mechanism,
        first=first,
        others={task.judged: second},
        unknown=tuple(item for item in task.vary if item != "friction.*"),
        settings=task.settings,
    )


def two_link_arm() -> Iterator[Case]:
    case = _task("two-link-arm")
    published = {"shoulder": Law(level=0.1675, viscous=0.0), "elbow": Law(level=0.115, viscous=0.0)}
    yield Case(**{**vars(case), "published": published})


def schunk_arm() -> Iterator[Case]:
    yield _task("schunk-arm")


def _published(joint: int, record: Measurement) -> Level:
    """Return friction of a joint as published, at the speed at which verdicts are compared."""
    v = np.gradient(np.asarray(record.position), np.asarray(record.time))
    speed = float(np.median(np.abs(v)))
    level, slope = MOTORS[joint - 1]
    plain = level + slope * speed
    more = (SIXTH[0] + SIXTH[1] * speed) if joint > 4 else 0.0
    return Level(
        speed=speed, low=WITHIN[0] * max(plain - more, 0.0), high=WITHIN[1] * (plain + more)
    )


def staubli() -> Iterator[Case]:
    table = _table("staubli_tx40", "train")
    for joint in range(1, 7):
        first, rest = _parts(
            Measurement(
                time=table["t_s"].to_numpy(),
                position=table[f"q{joint}_rad"].to_numpy(),
                force=table[f"tau{joint}_Nm"].to_numpy(),
                turning=True,
            )
        )
        yield Case(
            name=f"TX40, joint {joint} alone",
            mechanism=Axis(inertia=1.0),
            first=first,
            others={"rest": rest},
            unknown=MASS,
            levels=(_published(joint, first),),
        )
    published = {
        name: Law(level=level, viscous=slope, offset=offset)
        for name, (level, slope, offset) in TX40.items()
    }
    yield Case(**{**vars(_task("tx40")), "published": published})


def _swing(name: str) -> Measurement:
    table = _table("simple_pendulum_drive", name)
    t = table["t_s"].to_numpy()
    grows = np.concatenate([[True], np.diff(t) > 0.0])
    table = table[(t < t[0] + UNTOUCHED.get(name, np.inf)) & grows]
    return Measurement(
        time=table["t_s"].to_numpy(),
        position=table["q_rad"].to_numpy(),
        velocity=table["dq_rad_s"].to_numpy(),
        force=table["tau_Nm"].to_numpy(),
    )


def pendulum() -> Iterator[Case]:
    others = ("sac", "ilqr", "energy_shaping", "identification")
    yield Case(
        name="pendulum, ddp",
        mechanism=Pendulum(mass=0.676, length=0.45),
        first=_swing("ddp"),
        others={name: _swing(name) for name in others},
        unknown=("mechanism.mass", "mechanism.length"),
    )


def servo() -> Iterator[Case]:
    every = tasks.logs()
    own = [log for log in every if log.gain != tasks.HELD_OUT]
    yield Case(
        name="XL330 servo",
        mechanism=tasks.RIG,
        first=tasks.joined(own),
        others={f"gain {tasks.HELD_OUT}": tasks.joined([x for x in every if x not in own])},
        unknown=("mechanism.rest_angle", *(f"mechanism.drive.{key}" for key in tasks.UNKNOWN)),
        may_refuse=True,
    )


def seals() -> Iterator[Case]:
    table = parquet_data(_folder("oring_seals") / "train.parquet")
    parts = list[tuple[Measurement, Measurement]]()
    for _, own in table.groupby("trial"):
        record = Measurement(
            time=own["t_s"].to_numpy(),
            position=1e-3 * own["position_mm"].to_numpy(),
            friction=own["friction_N"].to_numpy(),
            inputs={"pressure": own["pressure_bar"].to_numpy()},
        )
        parts.append(_parts(record))
    known = (
        Level(inputs={"pressure": 1.0}, low=3.5, high=4.3),
        Level(inputs={"pressure": 7.0}, low=7.1, high=8.7),
    )

    def case(name: str, first: Sequence[Measurement], rest: Sequence[Measurement]) -> Case:
        return Case(
            name=name,
            mechanism=Axis(inertia=1.0),
            first=Measurement(trials=tuple(first)),
            others={"rest": Measurement(trials=tuple(rest))},
            levels=known,
            most=float(np.abs(table["friction_N"]).max()),
        )

    yield case("O-rings", [item for item, _ in parts], [item for _, item in parts])
    *three, last = parts
    yield case("O-rings, 7 bar from 1, 3, 5", [item for item, _ in three], last)


def motor() -> Iterator[Case]:
    table = parquet_data(_folder("odri_motor") / "train.parquet")
    record = Measurement(
        time=table["t_s"].to_numpy(),
        position=table["position_rad"].to_numpy(),
        velocity=table["velocity_rad_s"].to_numpy(),
        force=TORQUE * table["iq_A"].to_numpy(),
        turning=True,
    )
    for name, own in (
        ("ODRI motor", record),
        ("ODRI motor, place alone", replace(record, velocity=None)),
    ):
        first, rest = _parts(own)
        yield Case(
            name=name,
            mechanism=Axis(inertia=1e-5),
            first=first,
            others={"rest": rest},
            unknown=MASS,
            # by another fit of a smooth law
            known={"mechanism.inertia": (4.6e-6, 5.2e-6)},
            most=float(np.abs(TORQUE * table["iq_A"]).max()),
            published={"": Law(level=1.36e-3, viscous=1.07e-5, inertia=4.9e-6)},
        )


def traction_machine() -> Iterator[Case]:
    path = _folder("traction_machine") / "first_steps.txt"
    trials = read_data([path], guess_data(path).reading).records()
    cut = int(FIRST * len(trials))
    first, rest = (Measurement(trials=tuple(own)) for own in (trials[:cut], trials[cut:]))
    yield Case(name="traction machine", mechanism=Axis(inertia=1.0), first=first,
               others={"other steps": rest})  # fmt: skip


def not_judged() -> Iterator[Line]:
    """Yield the measured sets that are of another kind, with the reason."""
    for name, reason in (
        ("rock, velocity step", "rate-and-state friction is judged by velocity steps"),
        ("slider over paper", "irregular stick-slip is judged by its features"),
        ("pendulum, 1 kg", "another mass than that of the other records, not stated"),
    ):
        yield Line(name=name, reason=f"{reason}.")


SETS: Sequence[Callable[[], Iterator[Case]]] = (
    emps, tribometer, two_link_arm, pendulum, staubli, schunk_arm, seals, motor, traction_machine,
    servo,
)  # fmt: skip


# ---- judging


Seen: TypeAlias = list[tuple[Any, Any, Foreseen]]
"""Problems with rows of second parts, and what was foreseen of these."""


@contextlib.contextmanager
def watched() -> Iterator[Seen]:
    """Remember which rows selections compare with second parts: a verdict keeps no columns."""
    seen, foreseen = Seen(), Judgement.foreseen

    def noted(own: Judgement, rows: Any, measured: Array, unit: str) -> Foreseen:
        result = foreseen(own, rows, measured, unit)
        seen.append((own.problem, rows, result))
        return result

    with mock.patch.object(Judgement, "foreseen", noted):
        yield seen


def plain_columns(balance: Balance) -> dict[str, Array]:
    """Return the columns of Coulomb + viscous friction (n,) at the rows of a balance, by name."""
    rows, fixed = balance.rows(MIDDLE), balance.fixed(MIDDLE)
    loads = [1.0 if piece.record.load is None else piece.record.load for piece in balance.pieces]
    pieces = zip(balance.pieces, loads, strict=True)
    level = rows.seen([(item.direction * load)[:, None] for item, load in pieces])[:, 0]
    result = {
        "level": level,
        "viscous": rows.seen([piece.velocity[:, None] for piece in balance.pieces])[:, 0],
        "offset": np.ones(rows.count),
    }
    beside = [name for name in fixed if name == "inertia" or name.startswith("mechanism.")]
    return result | {name: fixed[name][:, 0] for name in beside}


def plain_rows(rows: Rows) -> dict[str, Array]:
    """Return the same at the rows of a table."""
    result = {"level": rows.direction * rows.load, "viscous": rows.velocity}
    if np.ptp(rows.direction) > 0.0:
        result["offset"] = np.ones(len(rows.velocity))
    return result


def joint_balances(case: Case, other: Measurement) -> dict[str, tuple[Balance, Balance]]:
    """Return balances of both parts by joint, with the links that those of the first part tell."""
    settings = case.settings or RecordSettings()
    zeros, held = bool(settings.position_zeros), settings.hold != "first"
    mechanism, unknown = case.mechanism, [*case.unknown]
    if LINKS in unknown:
        mechanism, links = told_links(mechanism, case.first, held=held, zeros=zeros)
        unknown = [*(item for item in unknown if item != LINKS), *links]
    request = JointRequest.of(
        mechanism, "viscous", ["friction.*", *unknown], None, case.first, zeros=zeros
    )
    balances = JointBalances.of(
        request.mechanism, case.first, request.linear, held=held, zeros=zeros
    )
    first, second = balances.records, balances.made(other)
    own = first.at(balances.links, held=held)
    rest = second.at(balances.links, held=held, again=True)
    result = {}
    for name in own.keys() & rest.keys():
        balance = Balance(own[name], highest=first.widest)
        result[first.contacts[name]] = balance, Balance(rest[name], like=balance)
    return result


def plain_error(
    problem: Any, other: Any, values: Array, law: Law | None = None,
    balances: tuple[Balance, Balance] | None = None,
) -> float:  # fmt: skip
    """Return the error of Coulomb + viscous friction, or of a law of that form, on other rows.

    Balances of both parts may be given that say nothing of what the judge knows of a mechanism.
    """
    if isinstance(problem, DrivenProblem):
        problem = problem.plain
    if isinstance(problem, RecordProblem):
        assert isinstance(other, OtherRows)
        balance, rest = balances or (problem.model.balance, other.balance)
        own, response = plain_columns(balance), balance.rows(MIDDLE).response
        columns = plain_columns(rest)
        values = values if balances is None else rest.rows(MIDDLE).response
    else:
        table = problem.table
        own, response = plain_rows(table.rows), table.friction
        columns = plain_rows(other)
    fixed = {} if law is None else {k: x for k, x in vars(law).items() if k in own}
    left = response - np.sum([x * own[name] for name, x in fixed.items()], axis=0)
    names = [name for name in own if name in columns and name not in fixed]
    said = np.sum([x * columns[name] for name, x in fixed.items()], axis=0) + 0.0 * values
    if names:
        x = np.column_stack([own[name] for name in names])
        size = np.sqrt(np.mean(x**2, axis=0)) + 1e-300
        best = np.linalg.lstsq(x / size, left, rcond=None)[0] / size
        said = said + np.column_stack([columns[name] for name in names]) @ best
    return float(np.sqrt(np.mean((values - said) ** 2)))


def handed_error(verdict: BandVerdict, other: Any, values: Array) -> float:
    """Return the error of the law handed over and its mechanism, without what lags, on other rows.

    NaN where friction depends on more than the speed and a constant load.
    """
    composed = verdict.judgement.composition
    if composed.inputs or verdict.best is None:
        return math.nan
    law = verdict.law

    def steady(velocity: Array) -> Array:
        return np.asarray([float(law.steady(v, composed.normal())) for v in velocity.tolist()])

    if isinstance(other, Rows):
        said = steady(other.velocity)
    else:
        balance = other.balance
        said = balance.rows(MIDDLE).seen([steady(piece.velocity) for piece in balance.pieces])
        columns = plain_columns(balance)
        if "inertia" in columns:
            said = said + vars(verdict.mechanism)["inertia"] * columns["inertia"]
    return float(np.sqrt(np.mean((values - said - offset_beside(verdict)) ** 2)))


def false_statements(case: Case, verdict: BandVerdict) -> Iterator[str]:
    """Yield what a verdict says that is false as far as anything is known."""
    judgement = verdict.judgement
    if verdict.best is None:
        yield verdict.words.verdict
    for parameter in verdict.parameters:
        low, high = case.known.get(parameter.path, (-math.inf, math.inf))
        miss = max(low - parameter.high_any, parameter.low_any - high)
        if miss > 0.25 * (parameter.high_any - parameter.low_any):
            stated = f"{parameter.low_any:.4g} to {parameter.high_any:.4g}"
            yield f"{parameter.path} {stated}, known {low:g} to {high:g}"
    typical = float(np.median(np.abs(verdict.speeds)))
    for level in case.levels:
        speed = typical if math.isnan(level.speed) else level.speed
        # half the difference of both directions, as an offset is no friction
        rows = judgement.problem.at(speed * np.array([-1.0, 1.0]), inputs=level.inputs or None)
        curves = judgement.curves(rows)
        own = curves[:, 1] if np.all(verdict.speeds > 0.0) else 0.5 * (curves[:, 1] - curves[:, 0])
        low, high = np.quantile(own, (0.025, 0.975)).tolist()
        if max(level.low - high, low - level.high) > 0.25 * (high - low):
            yield f"friction {low:.3g} to {high:.3g} at {speed:.3g}, known {level}"
    width = float(np.max(verdict.friction.high - verdict.friction.low))
    if width > case.most:
        yield f"a band {width:.3g} wide, where no force is above {case.most:.3g}"
    if not judgement.is_explained:
        yield verdict.words.verdict


def inertia_of(verdict: BandVerdict) -> str:
    """Return the interval of an inertia that was looked for."""
    result = [parameter for parameter in verdict.parameters if parameter.path in MASS]
    return "".join(f"{item.low_any:.4g} to {item.high_any:.4g}" for item in result)


def stated_beside(verdict: BandVerdict) -> Iterator[str]:
    """Yield what a verdict states beside the law, to be read."""
    for finding in verdict.findings:
        if finding.asserted:
            yield finding.sentence


def judged(case: Case) -> Iterator[Line]:
    """Yield a line for each other record, and of several joints for each joint."""
    for name, other in case.others.items():
        label, began = f"{case.name}: {name}", time.process_time()
        vary = ["friction.*", *case.unknown] if case.unknown else None
        try:
            with watched() as seen:
                verdict: Any = select(
                    case.mechanism, None, case.first, vary=vary, settings=case.settings,
                    validate=other,
                )  # fmt: skip
        except StickslipError as error:
            false = () if case.may_refuse else ("it is sound",)
            yield Line(name=label, reason=str(error), false=false)
            continue
        seconds = time.process_time() - began
        joints = getattr(verdict, "joints", {"": verdict})
        plain = joint_balances(case, other) if hasattr(verdict, "joints") else {}
        for (joint, own), (problem, at, match) in zip(joints.items(), seen, strict=True):
            band, values = match.band, match.measured
            published = case.published.get(joint)
            yield Line(
                name=f"{label}, {joint}" if joint else label,
                law=own.closest.title,
                distance=own.closest.distance,
                known=own.judgement.known,
                inside=match.inside,
                ratio=float(np.median(band.high - band.low)) / 2.0 / match.error,
                error=match.error,
                plain=plain_error(problem, at, values, balances=plain.get(joint)),
                handed=handed_error(own, at, values) if not joint else math.nan,
                interval=inertia_of(own),
                published=math.nan if published is None
                else plain_error(problem, at, values, published, plain.get(joint)),
                spread=float(np.sqrt(np.mean(values**2))),
                seconds=seconds / len(joints),
                false=(*false_statements(case, own),),
                beside=(*stated_beside(own),),
            )  # fmt: skip


def lines(only: str = "") -> Iterator[Line]:
    """Yield a line for each pair of parts of each set whose name begins so."""
    for made in SETS:
        try:
            cases = [*made()]
        except (StickslipError, OSError) as error:
            yield Line(name=made.__name__, reason=str(error))
            continue
        for case in cases:
            if case.name.startswith(only):
                yield from judged(case)
    for line in not_judged():
        if line.name.startswith(only):
            yield line


def summary(found: Sequence[Line]) -> str:
    """Return the numbers of all lines."""
    own = [item for item in found if not item.reason]
    if not own:
        return "nothing judged"
    inside = [item.inside for item in own]
    ratios = [item.ratio for item in own]
    return (
        f"{len(own)} lines: readings inside {np.median(inside):.3f} in the median, at least .90 on"
        f" {sum(x >= 0.9 for x in inside)}; half-width over error {np.median(ratios):.2f}, at most"
        f" {max(ratios):.2f}; error above Coulomb + viscous by more than 5 % on"
        f" {sum(item.excess > 1.05 for item in own)}, below it on"
        f" {sum(item.excess < 1.0 for item in own)}; false statements on"
        f" {sum(bool(item.false) for item in found)}; not judged {len(found) - len(own)}"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print all lines and their summary."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.real_records")
    parser.add_argument("--only", default="", help="beginning of the names of records")
    given = parser.parse_args(arguments)
    result = []
    for line in lines(given.only):
        result.append(line)
        print(line, flush=True)
    print(summary(result))


if __name__ == "__main__":
    main()
