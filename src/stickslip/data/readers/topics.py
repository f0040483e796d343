"""Topics of a robot's log as one table: states of joints by name, and any numbers on request."""

import re
from abc import ABC, abstractmethod
from array import array
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from stickslip.data.measurement import Array
from stickslip.data.readers.table import Table
from stickslip.errors import InputError, check_columns, check_size
from stickslip.mechanisms import coordinate_of
from stickslip.show.formatting import count, joined, number
from stickslip.units import shown

STATES: Final = {
    "JointState": "joint_state",
    "JointStates": "joints",
    "JointTrajectoryControllerState": "controller",
    "DynamicJointState": "interfaces",
}
"""Types of messages with the state of joints, by their last name, and the shape they have."""
COMMANDED: Final = re.compile(
    r"(^|[/_])(cmd|commands?|commanded|desired|targets?|goals?|ref)([/_]|$)"
)
"""Names of topics whose joint states are wanted and not measured."""
CURE: Final = "split the log, or keep fewer topics"
LONGEST: Final = 64
"""Elements up to which an array in a message has a column each."""
HOLE: Final = 3.0
"""Usual steps of a clock beyond which nothing is interpolated between two of its samples."""
MOST_TOPICS: Final = 12
"""Topics that a message lists."""
_STAMP: Final = (("sec", "secs"), ("nanosec", "nanosecs", "nsec", "nsecs"))


@dataclass(frozen=True, kw_only=True)
class Topic:
    """A topic of a log."""

    name: str
    kind: str
    """Type of its messages."""
    messages: int

    @property
    def shape(self) -> str:
        """Return how its messages hold states of joints; empty if they hold none."""
        return STATES.get(re.split(r"[/.]", self.kind)[-1], "")


class Log(ABC):
    """Messages of a file, each a mapping or an object with fields."""

    topics: Sequence[Topic]

    @abstractmethod
    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        """Yield the messages of some topics: topic, time of logging [ns], message."""


@dataclass(kw_only=True)
class _Collected:
    """What the messages of one topic hold, in the order of the log."""

    logged: list[int] = field(default_factory=list)
    stamped: list[int] = field(default_factory=list)
    """Times of headers [ns], 0 where there are none."""
    groups: dict[tuple[str, ...], tuple[list[int], "array[float]"]] = field(default_factory=dict)
    """Columns -> the messages that have them, and their values."""
    names: set[str] = field(default_factory=set)
    """All columns."""
    numbers: int = 0

    def check(self, file: str, topic: str) -> None:
        """Refuse more than memory holds, as of messages each of which has names of its own."""
        check_columns(f"{file}: {topic}", len(self.names))
        check_size(file, max(8.0 * len(self.logged), self.numbers), CURE)
        check_size(file, float(len(self.names)) * len(self.logged), CURE)

    def add(
        self, logged: int, message: Any, columns: Sequence[str], values: Sequence[float]
    ) -> None:
        """Keep one message."""
        self.names.update(columns)
        self.numbers += len(columns)
        rows, cells = self.groups.setdefault(tuple(columns), ([], array("d")))
        rows.append(len(self.logged))
        cells.extend(values)
        self.logged.append(logged)
        self.stamped.append(_stamp(message))

    def columns(self) -> dict[str, tuple[NDArray[np.intp], Array]]:
        """Return by column the messages that have a number there, and these numbers."""
        whole = {name: np.full(len(self.logged), np.nan) for names in self.groups for name in names}
        there = {name: np.zeros(len(self.logged), dtype=bool) for name in whole}
        for names, (rows, cells) in self.groups.items():
            table = np.array(cells).reshape(len(rows), len(names))
            for place, name in enumerate(names):
                whole[name][rows], there[name][rows] = table[:, place], True
        return {name: (np.flatnonzero(there[name]), whole[name][there[name]]) for name in whole}


@dataclass(frozen=True, kw_only=True)
class _Signal:
    """A column with times of its own."""

    topic: str
    column: str
    """Name in the topic: position.elbow, or a path such as data[0]."""
    rows: NDArray[np.intp]
    times: NDArray[np.int64]
    values: Array
    held: bool
    """Whether it keeps its value until the next sample, as a command does."""


def table_of(log: Log, file: str, names: Collection[str] = ()) -> Table:
    """Return the states of joints of a log as columns, and other numbers that are named.

    Columns are called position.elbow, velocity.elbow, force.elbow, and reference.elbow for a
    commanded position; all others by topic and path, as /motor/current/data. Times are those of the
    joints of which there are most samples; other signals are interpolated there.
    """
    states = [topic for topic in log.topics if topic.shape and topic.messages]
    wanted = {name: topic for name in names if (topic := _topic_of(name, log.topics))}
    used = {state.name: state for state in (*states, *wanted.values())}
    if not used:
        raise InputError(f"{file}: {_nothing(log.topics)}")
    total = sum(topic.messages for topic in used.values())
    check_size(file, 8.0 * total, CURE)
    collected = {name: _Collected() for name in used}
    for name, logged, message in log.messages(list(used)):
        columns, values = _numbers(used[name], message, file, len(collected[name].logged))
        collected[name].add(logged, message, columns, values)
        collected[name].check(file, name)
    lost = [*_lost(used, collected)]
    if not any(topic.logged for topic in collected.values()):
        raise InputError(f"{file}: {lost[0]}")
    collected = {name: topic for name, topic in collected.items() if topic.logged}
    stamped = all(all(topic.stamped) for topic in collected.values())
    signals = [
        signal
        for name, topic in collected.items()
        for signal in _signals(used[name], topic, stamped=stamped)
    ]
    return _Joined(file=file, signals=signals, names=names).table(
        _clock_remarks(collected, stamped), lost
    )


def _lost(topics: Mapping[str, Topic], found: Mapping[str, _Collected]) -> Iterator[str]:
    """Yield of which topics a log says that it holds other messages than it does."""
    for name, topic in topics.items():
        there = len(found[name].logged)
        if there != topic.messages:
            yield (
                f"The log says that {name} has {count(topic.messages, 'message')}, and"
                f" {there:,} {'was' if there == 1 else 'were'} read: the log is incomplete, or was"
                " not closed."
            )


def _signals(topic: Topic, found: _Collected, *, stamped: bool) -> Iterator[_Signal]:
    """Yield the columns of a topic that hold numbers."""
    times = np.array(found.stamped if stamped else found.logged, dtype=np.int64)
    wanted = bool(COMMANDED.search(topic.name.casefold()))
    for column, (rows, values) in found.columns().items():
        name = column
        if wanted and topic.shape and column.startswith("position."):
            name = column.replace("position", "reference", 1)
        elif wanted and topic.shape:
            name = f"command.{column}"
        yield _Signal(
            topic=topic.name,
            column=name,
            rows=rows,
            times=times[rows],
            values=values,
            held=wanted or name.startswith("reference."),
        )


@dataclass(frozen=True, kw_only=True)
class _Joined:
    """Signals of several clocks on their way to one table."""

    file: str
    signals: Sequence[_Signal]
    names: Collection[str]
    """Columns that were asked for by name."""

    def table(self, remarks: Sequence[str], lost: Sequence[str]) -> Table:
        """Return the table, its times those of most samples."""
        wanted = {signal.column: signal for signal in self._measured()}
        if not wanted:
            wanted = {
                _full(signal): signal for signal in self.signals if _full(signal) in self.names
            }
        if not wanted:
            listed = joined([shown(_full(signal)) for signal in self.signals[:MOST_TOPICS]])
            raise InputError(
                f"{self.file}: no joint has a position or a velocity; there is {listed}."
            )
        clock = self._clock([*wanted.values()])
        if np.ptp(clock.times) == 0:
            raise InputError(
                f"{self.file}: all samples of {clock.topic} have one time: a record needs several."
            )
        wanted |= self._commands(wanted)
        wanted |= {_full(signal): signal for signal in self.signals if _full(signal) in self.names}
        begin = int(clock.times[0])
        data: dict[str, Any] = {"time [s]": (clock.times - begin) * 1e-9}
        apart: dict[tuple[str, str], list[str]] = {}
        rates: dict[str, str] = {}
        said = []
        for name, one in wanted.items():
            if not np.isfinite(one.values).any():
                continue  # a field that the driver does not fill
            values, how = _at(clock, one)
            if not np.isfinite(values).any():
                said.append(
                    f"{name!r} of {one.topic} has no sample near those of {clock.topic}: it is left"
                    " out."
                )
                continue
            data[name] = values
            if how:
                apart.setdefault((one.topic, how), []).append(name)
                rates.setdefault(one.topic, _rate(one))
        said += [
            _apart(f"{topic}{rates[topic]}", how, found, clock)
            for (topic, how), found in apart.items()
        ]
        return Table(
            data=pd.DataFrame(data),
            remarks=(*remarks, *said, *self._told(data), *self._left(wanted)),
            lost=tuple(lost),
        )

    def _measured(self) -> list[_Signal]:
        """Return what was measured of joints; of one in two topics, that with efforts or more."""
        found: dict[str, _Signal] = {}
        states = [signal for signal in self.signals if _of_joint(signal)]
        efforts = {
            (state.topic, state.column.removeprefix("force."))
            for state in states
            if state.column.startswith("force.") and np.isfinite(state.values).any()
        }

        def order(signal: _Signal) -> tuple[bool, int]:
            return (signal.topic, signal.column.partition(".")[2]) not in efforts, -signal.rows.size

        for channel in sorted(states, key=order):  # stable
            joint = channel.column.partition(".")[2]
            found.setdefault(joint, channel)
        topics = {joint: signal.topic for joint, signal in found.items()}
        return [state for state in states if topics[state.column.partition(".")[2]] == state.topic]

    def _commands(self, measured: Mapping[str, _Signal]) -> dict[str, _Signal]:
        """Return the commanded positions of joints that were measured."""
        found: dict[str, _Signal] = {}
        for entry in sorted(self.signals, key=lambda signal: -signal.rows.size):
            first, _, joint = entry.column.partition(".")
            if first == "reference" and f"position.{joint}" in measured:
                found.setdefault(entry.column, entry)
        return found

    def _clock(self, signals: Sequence[_Signal]) -> _Signal:
        """Return a signal with the times that most samples have."""
        sizes: dict[tuple[str, bytes], int] = {}
        for signal in signals:
            key = (signal.topic, signal.rows.tobytes())
            sizes[key] = sizes.get(key, 0) + signal.rows.size
        return max(signals, key=lambda entry: sizes[entry.topic, entry.rows.tobytes()])

    def _told(self, data: Mapping[str, Any]) -> Iterator[str]:
        """Yield what is said of efforts that are missing or zero."""
        joints = [name.partition(".")[2] for name in data if name.startswith("position.")]
        without = [joint for joint in joints if f"force.{joint}" not in data]
        if without:
            yield (
                f"No effort was recorded of {joined([shown(key) for key in without])}: friction of"
                " such a joint cannot be derived from this log."
            )
        zero = [
            joint
            for joint in joints
            if f"force.{joint}" in data and not np.any(data[f"force.{joint}"])
        ]
        if zero:
            yield (
                f"The effort of {joined([shown(name) for name in zero])} is 0 throughout: many"
                " drivers write 0 where they measure none, and then there is no friction to fit."
            )

    def _left(self, wanted: Mapping[str, _Signal]) -> Iterator[str]:
        """Yield which topics hold the same joints, and are not read."""
        used = {signal.topic for signal in wanted.values()}
        for topic in dict.fromkeys(
            signal.topic for signal in self.signals if signal.topic not in used
        ):
            first = next(signal for signal in self.signals if signal.topic == topic)
            yield (
                f"The topic {topic} has the same joints and is left out; its columns are called as"
                f" {shown(_full(first))}."
            )


def _of_joint(signal: _Signal) -> bool:
    return signal.column.startswith(("position.", "velocity.", "force."))


def _full(signal: _Signal) -> str:
    return f"{signal.topic}/{signal.column}"


def _at(clock: _Signal, signal: _Signal) -> tuple[Array, str]:
    """Return a signal at the times of another, NaN in its holes, and how; not beyond its ends."""
    if signal.topic == clock.topic and np.array_equal(signal.rows, clock.rows):
        return signal.values, ""
    order = np.argsort(signal.times, kind="stable")
    times, values = signal.times[order], signal.values[order]
    times, first = np.unique(times, return_index=True)
    values = values[first]
    after = np.searchsorted(times, clock.times)
    exact = times[np.minimum(after, times.size - 1)] == clock.times
    inside = (after > 0) & (after < times.size) | exact
    before = np.clip(np.where(exact, after, after - 1), 0, times.size - 1)
    if signal.held:
        known = (after > 0) | exact  # the last command holds
        return np.where(known, values[before], np.nan), "held"
    begin = int(times[0])
    found = np.interp(clock.times - begin, times - begin, values)
    steps = np.diff(times)
    if steps.size:
        wide = np.append(steps, 0) > HOLE * np.median(steps)
        inside &= ~wide[before] | exact
    return np.where(inside, found, np.nan), "" if exact.all() else "interpolated"


def _apart(topic: str, how: str, names: Sequence[str], clock: _Signal) -> str:
    """Return what is said of columns that have other times than the rows."""
    listed = joined([shown(name) for name in names[:6]]) + ", ..." * (len(names) > 6)
    verb = "is" if len(names) == 1 else "are"
    what = "the last value before" if how == "held" else "interpolated at"
    return f"{listed} of {topic} {verb} {what} each sample of {clock.topic}."


def _rate(signal: _Signal) -> str:
    """Return the rate of a signal, in brackets."""
    step = float(np.median(np.diff(signal.times))) * 1e-9 if signal.times.size > 1 else 0.0
    return f" ({number(1.0 / step, 3)} Hz)" if step > 0.0 else ""


def _clock_remarks(found: Mapping[str, _Collected], stamped: bool) -> list[str]:
    """Return what is said of the clock: that of headers, unless they have none."""
    if stamped:
        return []
    without = [name for name, collected in found.items() if not all(collected.stamped)]
    some = any(any(found[name].stamped) for name in without)
    have = "has header stamps of 0" if len(without) == 1 else "have header stamps of 0"
    none = "or none" if not some else "in some messages"
    return [
        f"{joined(without)} {have} {none}: times are those at which messages were logged, which"
        " vary more than those at which they were measured."
    ]


def _numbers(topic: Topic, message: Any, file: str, place: int) -> tuple[list[str], list[float]]:
    """Return the columns and numbers of one message."""
    try:
        read = _STATE_READERS.get(topic.shape)
        pairs = [*(_flat(message, "") if read is None else read(message))]
        columns = [name for name, _ in pairs]
        values = [np.nan if value is None else float(value) for _, value in pairs]
    except (KeyError, AttributeError, TypeError, ValueError) as error:
        raise InputError(
            f"{file}: message {place + 1} of {topic.name} is no {topic.kind}: {_reason(error)}."
        ) from None
    if len(set(columns)) < len(columns):
        twice = next(column for column in columns if columns.count(column) > 1)
        raise InputError(f"{file}: message {place + 1} of {topic.name} has {twice!r} twice.")
    return columns, values


def _reason(error: Exception) -> str:
    return f"it has no {error}" if isinstance(error, KeyError) else str(error).rstrip(".")


def _get(message: Any, *names: str) -> Any:
    """Return a field by one of its names, of a mapping or an object."""
    for name in names:
        if isinstance(message, Mapping):
            if name in message:
                return message[name]
        elif hasattr(message, name):
            return getattr(message, name)
    raise KeyError(names[0])


@cache
def joint_name(name: object) -> str:
    """Return the name of a joint as robots made from URDF have it."""
    found = coordinate_of(name) if isinstance(name, str) else ""
    if not found:
        raise ValueError(f"{name!r} is no name of a joint")
    return found


def _by_joint(names: Any, **fields: Any) -> Iterator[tuple[str, Any]]:
    """Yield the values of each joint; a field without values was not measured."""
    joints = [joint_name(name) for name in names]
    for what, values in fields.items():
        if values is None or not len(values):
            continue
        if len(values) != len(joints):
            raise ValueError(
                f"it has {count(len(joints), 'name')} and {len(values)} values of {what}"
            )
        yield from ((f"{what}.{joint}", x) for joint, x in zip(joints, values, strict=True))


def _joint_state(message: Any) -> Iterator[tuple[str, Any]]:
    """Yield what sensor_msgs/JointState holds."""
    parts = {name: _optional(message, name) for name in ("position", "velocity", "effort")}
    yield from _by_joint(
        _get(message, "name", "names"),
        position=parts["position"],
        velocity=parts["velocity"],
        force=parts["effort"],
    )


def _optional(message: Any, *names: str) -> Any:
    try:
        return _get(message, *names)
    except KeyError:
        return None


def _joints(message: Any) -> Iterator[tuple[str, Any]]:
    """Yield what foxglove.JointStates holds: a list with one entry a joint."""
    for part in _get(message, "joints"):
        joint = joint_name(_get(part, "name"))
        for what, name in (("position", "position"), ("velocity", "velocity"), ("force", "effort")):
            value = _optional(part, name)
            if value is not None:
                yield f"{what}.{joint}", value


def _controller(message: Any) -> Iterator[tuple[str, Any]]:
    """Yield what control_msgs/JointTrajectoryControllerState holds, with old and new names."""
    names = _get(message, "joint_names")
    measured, wanted = (
        _optional(message, *pair) for pair in (("feedback", "actual"), ("reference", "desired"))
    )
    for part, fields in ((measured, ("position", "velocity", "force")), (wanted, ("reference",))):
        values = [_optional(part, name) for name in ("positions", "velocities", "effort")]
        yield from _by_joint(names, **dict(zip(fields, values, strict=False)))


def _interfaces(message: Any) -> Iterator[tuple[str, Any]]:
    """Yield what control_msgs/DynamicJointState holds."""
    known = {"position": "position", "velocity": "velocity", "effort": "force"}
    names, values = _get(message, "joint_names"), _get(message, "interface_values")
    for name, entry in zip(names, values, strict=True):
        pairs = zip(_get(entry, "interface_names"), _get(entry, "values"), strict=True)
        for interface, value in pairs:
            if interface in known:
                yield f"{known[interface]}.{joint_name(name)}", value


_STATE_READERS: Final = {
    "joint_state": _joint_state,
    "joints": _joints,
    "controller": _controller,
    "interfaces": _interfaces,
}


def _flat(part: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield the numbers in a message by their paths."""
    if isinstance(part, bool | np.bool_ | str | bytes):
        return
    if isinstance(part, int | float | np.number):
        yield path, part
    elif isinstance(part, Mapping):
        for name, value in part.items():
            yield from _flat(value, f"{path}.{name}" if path else str(name))
    elif isinstance(part, Sequence | np.ndarray):
        if len(part) <= LONGEST:
            for place, value in enumerate(part):
                yield from _flat(value, f"{path}[{place}]")
    elif part is not None:
        slots = getattr(part, "__slots__", None) or getattr(part, "__dict__", {})
        fields = [name for name in slots if not name.startswith("_")]
        yield from _flat({name: getattr(part, name) for name in fields if name != "header"}, path)


def _stamp(message: Any) -> int:
    """Return the time in the header of a message [ns]; 0 if there is none."""
    header = _optional(message, "header")
    stamp = _optional(message if header is None else header, "stamp", "timestamp")
    if stamp is None:
        return 0
    parts = [_optional(stamp, *names) for names in _STAMP]
    try:
        return 0 if None in parts else int(parts[0]) * 1_000_000_000 + int(parts[1])
    except (TypeError, ValueError):
        return 0


def _topic_of(name: str, topics: Sequence[Topic]) -> Topic | None:
    """Return the topic in which a column is, by the beginning of its name."""
    fitting = [topic for topic in topics if name.startswith(f"{topic.name}/")]
    return max(fitting, key=lambda topic: len(topic.name), default=None)


def _nothing(topics: Sequence[Topic]) -> str:
    """Return that a log has no states of joints, and what it has."""
    full = [topic for topic in topics if topic.messages]
    if not full:
        return "contains no messages."
    listed = ", ".join(f"{part.name} ({part.kind}, {part.messages})" for part in full[:MOST_TOPICS])
    more = f" and {len(full) - MOST_TOPICS} more" if len(full) > MOST_TOPICS else ""
    return (
        f"has no topic with states of joints ({', '.join(STATES)}); its topics, with types and"
        f" numbers of messages, are {listed}{more}. Name columns by topic and field, as"
        f' columns={{"position": "{full[0].name}/data"}}.'
    )
