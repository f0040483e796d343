"""Tasks of the benchmark: what is fitted, what judges, and by which error.

An error is the root mean square over the part of a record that no fit has seen, with a standard
error from the scatter of blocks of it.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from stickslip.data import Measurement
from stickslip.data.catalogue import Dataset, dataset
from stickslip.data.differentiation import rows_of
from stickslip.engine.simulation import simulate
from stickslip.errors import InputError
from stickslip.identify import Foreseen, JointLawFit, LawFit
from stickslip.identify.fits import (
    FreeParameters,
    Hold,
    RecordSettings,
    Shooting,
    measured_quantity,
    segments_of,
)
from stickslip.identify.kinds import SimulatedFit
from stickslip.identify.problems.velocity_steps import record_of
from stickslip.mechanisms import DCMotor, Mechanism, PositionLoop
from stickslip.mechanisms.drives import Sampled
from stickslip.show.described import Described

# By what a fit is judged on a part of a record that it has not seen.


class Error(NamedTuple):
    """An error on the part that judges."""

    value: float
    """Root mean square, or what the metric says, in its unit."""
    doubt: float = math.nan
    """Its standard error by parts of the record; NaN where there are no parts."""


def _of_blocks(squares: Sequence[float]) -> Error:
    """Return the root of mean squares of parts, with its standard error.

    Examples
    --------
    >>> _of_blocks([4.0, 4.0])
    Error(value=2.0, doubt=0.0)
    """
    mean = float(np.mean(squares))
    if len(squares) < 2 or not mean > 0.0:
        return Error(math.sqrt(mean))
    spread = float(np.std(squares, ddof=1)) / math.sqrt(len(squares))
    return Error(math.sqrt(mean), spread / (2.0 * math.sqrt(mean)))


class Metric(ABC, metaclass=Described):
    """What a task is judged by."""

    @property
    @abstractmethod
    def text(self) -> str:
        """What it is, in words."""

    @property
    @abstractmethod
    def unit(self) -> str:
        """SI unit of the error."""

    @abstractmethod
    def of(self, fit: Any, record: Measurement) -> Error:
        """Return the error of a fit on a record.

        Parameters
        ----------
        fit : LawFit or SimulatedFit
            What is judged.
        record : Measurement
            The part that judges.

        Returns
        -------
        Error
            With its standard error, where the record has parts.

        Raises
        ------
        InputError
            If the fit does not predict what is judged.
        """


BLOCKS = 8
"""Parts of a record by which the error of a force has a standard error."""


@dataclass(frozen=True, kw_only=True)
class PositionError(Metric):
    """Root mean square of the position in simulated segments, each from its own fitted state.

    Examples
    --------
    >>> PositionError(horizon=1.0).text
    'rms error of the position, simulated for 1 s'
    """

    horizon: float
    """Length of the segments [s]."""
    unit: str = "m"
    """SI unit of the position."""
    hold: Hold = "zero"
    """How the force runs between its samples."""

    @property
    def text(self) -> str:
        return f"rms error of the position, simulated for {self.horizon:g} s"

    def of(self, fit: Any, record: Measurement) -> Error:
        return error_of_segments(fit, record, self.horizon, self.hold)


def error_of_segments(fit: Any, record: Measurement, length: float, hold: Hold = "zero") -> Error:
    """Return the error of segments of a length [s], each run from the state that fits it best.

    Parameters
    ----------
    fit : Fit
        Its law and mechanism are run.
    record : Measurement
        What is predicted.
    length : float
        Length of the segments [s].
    hold : {"zero", "first"}
        How the force runs between its samples.

    Returns
    -------
    Error
        Root mean square, with its standard error by the segments.

    Raises
    ------
    InputError
        If the law has bristles, whose deflections at the first sample nothing tells, or a run
        fails.
    """
    if fit.law.states:
        raise InputError(f"{fit.law.title} friction does not tell where its bristles begin.")
    segments = segments_of(fit.mechanism, record, length=length, hold=hold)
    nothing = FreeParameters(())
    quantity = measured_quantity(record)
    runs = Shooting(law=fit.law, free_parameters=nothing, segments=segments, quantity=quantity)
    left = runs.linearise(nothing.start).residual
    if not np.isfinite(left).all():
        raise InputError("a run of the law does not reach the end of a segment.")
    ends = np.cumsum([len(segment.times) for segment in segments])[:-1]
    return _of_blocks([float(np.mean(part**2)) for part in np.split(left, ends)])


@dataclass(frozen=True, kw_only=True)
class ForceError(Metric):
    """Relative error of the force along the measured motion; of several joints the mean of squares.

    Residual over spread of the measured force: 1 is what the mean alone leaves.

    Examples
    --------
    >>> ForceError().unit
    '1'
    """

    unit: str = "1"
    """A pure number."""
    text: str = "rms error of the force along the measured motion, over its spread"
    """What it is, in words."""

    def of(self, fit: LawFit | JointLawFit, record: Measurement) -> Error:
        result = fit.predict(record)
        joints = [result] if isinstance(result, Foreseen) else [*result.values()]
        squares = np.zeros(BLOCKS)
        for own in joints:
            left = (own.measured - own.band.median) ** 2 / np.var(own.measured)
            parts = [float(np.mean(x)) for x in np.array_split(left, BLOCKS)]
            squares += np.array(parts) / len(joints)
        return _of_blocks(squares.tolist())


@dataclass(frozen=True, kw_only=True)
class CoefficientError(Metric):
    """Root mean square error of the coefficient of friction from a time on, run from the start.

    Examples
    --------
    >>> CoefficientError(since=10.0).unit
    '1'
    """

    since: float
    """Time from which samples are judged [s]."""
    unit: str = "1"
    """A pure number."""
    text: str = "rms error of the coefficient of friction (0.1 % is 0.001)"
    """What it is, in words."""

    def of(self, fit: SimulatedFit[Any], record: Measurement) -> Error:
        other = record_of(record, fit.problem.record.load)
        late = other.time + other.begins >= self.since
        left = other.coefficient - fit.problem.foreseen(fit.family, fit.name, other)
        return Error(float(np.sqrt(np.mean(left[late] ** 2))))


@dataclass(frozen=True, kw_only=True)
class FeatureError(Metric):
    """Root mean square of the relative errors of frequency, mean and standard deviation.

    Examples
    --------
    >>> FeatureError().unit
    '1'
    """

    unit: str = "1"
    """A pure number."""
    text: str = "rms of the relative errors of frequency, mean and standard deviation of the force"
    """What it is, in words."""

    def of(self, fit: SimulatedFit[Any], record: Measurement) -> Error:
        result = list(fit.judged(record).values())
        return Error(float(np.sqrt(np.mean(np.square(result)))))


@dataclass(frozen=True, kw_only=True)
class ClosedLoop(Metric):
    """Mean absolute error of the angle of a servo, simulated in closed loop over whole records.

    The voltage is that of the position loop, from the goal; a trial with ``current_limit`` 0 is one
    of an open winding, and goes on where the one before it ends.

    Examples
    --------
    >>> ClosedLoop(supply=7.4).unit
    'rad'
    """

    supply: float
    """Voltage of the supply [V]."""
    supply_resistance: float = 0.0
    """Resistance of the supply [ohm]."""
    unit: str = "rad"
    """SI unit of the angle."""
    text: str = "mean absolute error of the angle, simulated in closed loop over whole records"
    """What it is, in words."""

    def of(self, fit: Any, record: Measurement) -> Error:
        errors: list[float] = []
        parts: list[np.ndarray[Any, Any]] = []
        start: dict[str, float] = {}
        for trial in record.records():
            opened = trial.overrides.get("mechanism.drive.current_limit") == 0.0
            if not opened:
                if parts:
                    errors.append(float(np.mean(np.concatenate(parts))))
                parts, start = [], {"theta": float(np.asarray(trial.position)[0])}
            rig: Any = fit.mechanism
            motor = replace(rig.drive, supply=self.supply, supply_resistance=self.supply_resistance)
            motor = (
                replace(motor, drive=None, loop=None, current_limit=0.0)
                if opened
                else _looped(motor, trial)
            )
            run = simulate(
                replace(rig, drive=motor),
                fit.law,
                t_end=float(np.asarray(trial.time)[-1]),
                y0=start,
            )
            angles = np.asarray(run.at(np.asarray(trial.time))["theta"])
            start = {name: float(run[name][-1]) for name in ("theta", "omega")}
            parts.append(np.abs(angles - np.asarray(trial.position)))
        errors.append(float(np.mean(np.concatenate(parts))))
        spread = (
            float(np.std(errors, ddof=1)) / math.sqrt(len(errors)) if len(errors) > 1 else math.nan
        )
        return Error(float(np.mean(errors)), spread)


def _looped(motor: DCMotor, record: Measurement) -> DCMotor:
    """Return a motor whose position loop follows the goal of a record."""
    goal = Sampled(times=np.asarray(record.time), values=np.asarray(record.reference))
    return replace(
        motor, loop=PositionLoop(gain=record.overrides["mechanism.drive.loop.gain"]), drive=goal
    )


# A task: which parts of a record are fitted and which judge, by what, and what was published.


@dataclass(frozen=True, kw_only=True)
class Published(metaclass=Described):
    """A result that others printed, on a split of their own.

    Examples
    --------
    >>> Published(what="IDIM-LS", result="relative error 4.08 %", source="Janot 2019").what
    'IDIM-LS'
    """

    what: str
    """Method or law."""
    result: str
    """What was reached, with what it is of."""
    source: str
    """Where it is printed."""


@dataclass(frozen=True, kw_only=True)
class Task(metaclass=Described):
    """A question to a record: fit on one part, predict the other.

    Examples
    --------
    >>> from benchmarks.friction.runs import task
    >>> axis = task("emps")
    >>> axis.metric.text
    'rms error of the position, simulated for 1 s'
    """

    name: str
    """Name on the command line."""
    title: str
    """What was measured, in a line."""
    record: str
    """Name in the catalogue."""
    fitted: str
    """The part that is fitted, in words."""
    judged: str
    """The part that judges, in words."""
    files: Sequence[str]
    """Files of the record that are read."""
    mechanism: Mechanism
    """What moves, with start values of what is fitted of it."""
    split: Callable[[], tuple[Measurement, Measurement]]
    """Reads both parts."""
    metric: Metric
    """What counts."""
    vary: Sequence[str] = ("friction.*",)
    """What is fitted, as in `fit`."""
    laws: Sequence[Any] | None = None
    """Laws that are compared; None for those that `select` compares by itself."""
    selects: bool = True
    """Whether `select` compares and names a law; else each is fitted, and none is named."""
    route: str | None = None
    """How the record is fitted, as in `fit`."""
    settings: RecordSettings | None = None
    """As in `fit`."""
    cutoff: float = 0.0
    """Frequency [Hz] at which peers of regression filter motion and force; 0 where they need none.

    Of those that were tried, the one with which SciPy errs least on the part that judges: a choice
    with hindsight, in favour of peers, since a wrong one costs them more than the law does."""
    truth: Mapping[str, float] = field(default_factory=dict)
    """Values of a reference simulation by path; nobody knows those of a measurement."""
    published: tuple[Published, ...] = ()
    """What others reached."""
    left_out: Mapping[str, str] = field(default_factory=dict)
    """Peers that cannot be given the task, and why."""

    @property
    def dataset(self) -> Dataset:
        """The record in the catalogue."""
        return dataset(self.record)


def between(record: Measurement, first: float, end: float) -> Measurement:
    """Return the samples of a record from one time on, up to another, in seconds of its clock."""
    time = np.asarray(record.time)
    rows = np.searchsorted(time, [first, end])
    return rows_of(record, int(rows[0]), int(rows[1]))


def together(name: str, files: Sequence[str]) -> Measurement:
    """Return files of a record as trials of one measurement."""
    record = dataset(name)
    return Measurement(trials=tuple(record.measurement(file) for file in files), name=name)
