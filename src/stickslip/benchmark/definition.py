"""A task: which parts of a record are fitted and which judge, by what, and what was published."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np

from stickslip.benchmark.metrics import Metric
from stickslip.catalogue import Dataset, dataset
from stickslip.described import Described
from stickslip.experiments import Measurement, rows_of
from stickslip.identification import RecordSettings
from stickslip.mechanisms import Mechanism


@final
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


@final
@dataclass(frozen=True, kw_only=True)
class Task(metaclass=Described):
    """A question to a record: fit on one part, predict the other.

    Examples
    --------
    >>> from stickslip.benchmark import task
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
