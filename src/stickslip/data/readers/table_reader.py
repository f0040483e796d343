"""Files of any format as columns by the quantity they hold, and conditions of trials in them."""

import bz2
import io
import re
import sqlite3
import struct
from array import array
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path, PurePath
from typing import Any, BinaryIO, Final, Protocol

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from typing_extensions import override

from stickslip import errors
from stickslip.data.measurement import STATED, TRAVELS, Array
from stickslip.data.readers import binary, csv_reader, robots
from stickslip.data.readers.columns import (
    VOCABULARY,
    Column,
    is_half_width,
    stated_unit,
    without_unit,
)
from stickslip.data.readers.layout import NO_UNIT, Layout, regular_times, seconds_of, unit_in
from stickslip.data.readers.table import TRIAL, FileTable, json_of, one_line, parsed_as
from stickslip.data.readers.toml import check_file, check_path
from stickslip.data.readers.tracks import SEPARATOR, seconds
from stickslip.data.tolerances import (
    GAP,
    LARGEST_TEXT,
    LONGEST_LINE,
    LONGEST_NAME,
    MOST_LISTED,
    MOST_SIGNALS,
    SLIGHT,
)
from stickslip.errors import MOST_NUMBERS, InputError, check_columns, check_size
from stickslip.mechanisms import coordinate_of
from stickslip.show.display import require_library
from stickslip.show.documents import open_regular, private_folder
from stickslip.show.formatting import count, joined, number
from stickslip.units import CELSIUS, converted, factor, is_pixel, shown, split_number

# Logs of messages: MCAP, and bags of ROS 2 and ROS 1.
#
# A frame of a few bytes may stand for gigabytes, and what a file says of its sizes need not be
# true. So each compressed piece is expanded here, within bounds, before a library expands it
# without any.

# Topics of a robot's log as one table: states of joints by name, and any numbers on request.

COMMANDED: Final = re.compile(
    r"(^|[/_])(cmd|commands?|commanded|desired|targets?|goals?|ref)([/_]|$)"
)
"""Names of topics whose joint states are wanted and not measured."""
_FIELDS: Final = (("position", "position"), ("velocity", "velocity"), ("force", "effort"))
"""What was measured of a joint, and the field of a message that holds it."""
_STAMP: Final = (("sec", "secs"), ("nanosec", "nanosecs", "nsec", "nsecs"))


@dataclass(frozen=True, kw_only=True)
class Topic:
    """A topic of a log."""

    name: str
    kind: str
    """Type of its messages."""
    messages: int

    @property
    def read(self) -> "Callable[[Any], Iterator[tuple[str, Any]]] | None":
        """What reads the states of joints in its messages; None if they hold none."""
        return JOINT_MESSAGES.get(re.split(r"[/.]", self.kind)[-1])


def topics_of(channels: Iterable[tuple[str, str, int]]) -> tuple[Topic, ...]:
    """Return the topics of channels, given as topic, type and number of messages.

    Examples
    --------
    >>> topics_of([("/arm", "JointState", 2), ("/arm", "JointState", 3)])[0].messages
    5
    """
    result: dict[str, Topic] = {}
    for name, kind, messages in channels:
        before = result[name].messages if name in result else 0
        result[name] = Topic(name=name, kind=kind, messages=before + messages)
    return (*result.values(),)


class Log(Protocol):
    """Messages of a file, each a mapping or an object with fields."""

    topics: Sequence[Topic]

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


def table_of(log: Log, file: str, names: Collection[str] = ()) -> FileTable:
    """Return the states of joints of a log as columns, and other numbers that are named.

    Columns are called position.elbow, velocity.elbow, force.elbow, and reference.elbow for a
    commanded position; all others by topic and path, as /motor/current/data. Times are those of the
    joints of which there are most samples; other signals are interpolated there.
    """
    states = [topic for topic in log.topics if topic.read and topic.messages]
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
        if wanted and topic.read and column.startswith("position."):
            name = column.replace("position", "reference", 1)
        elif wanted and topic.read:
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

    def table(self, remarks: Sequence[str], lost: Sequence[str]) -> FileTable:
        """Return the table, its times those of most samples."""
        wanted = {signal.column: signal for signal in self._measured()}
        if not wanted:
            wanted = {
                _full(signal): signal for signal in self.signals if _full(signal) in self.names
            }
        if not wanted:
            listed = joined([shown(_full(signal)) for signal in self.signals[:MOST_LISTED]])
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
        for name, item in wanted.items():
            if not np.isfinite(item.values).any():
                continue  # a field that the driver does not fill
            values, how = _at(clock, item)
            if not np.isfinite(values).any():
                said.append(
                    f"{name!r} of {item.topic} has no sample near those of {clock.topic}: it is"
                    " left out."
                )
                continue
            data[name] = values
            if how:
                apart.setdefault((item.topic, how), []).append(name)
                rates.setdefault(item.topic, _rate(item))
        said += [
            _apart(f"{topic}{rates[topic]}", how, names, clock)
            for (topic, how), names in apart.items()
        ]
        return FileTable(
            data=pd.DataFrame(data),
            remarks=(*remarks, *said, *self._told(data), *self._left(wanted)),
            lost=tuple(lost),
        )

    def _measured(self) -> list[_Signal]:
        """Return what was measured of joints; of one in two topics, that with efforts or more."""
        result: dict[str, _Signal] = {}
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
            result.setdefault(joint, channel)
        topics = {joint: signal.topic for joint, signal in result.items()}
        return [state for state in states if topics[state.column.partition(".")[2]] == state.topic]

    def _commands(self, measured: Mapping[str, _Signal]) -> dict[str, _Signal]:
        """Return the commanded positions of joints that were measured."""
        result: dict[str, _Signal] = {}
        for entry in sorted(self.signals, key=lambda signal: -signal.rows.size):
            first, _, joint = entry.column.partition(".")
            if first == "reference" and f"position.{joint}" in measured:
                result.setdefault(entry.column, entry)
        return result

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
    result = np.interp(clock.times - begin, times - begin, values)
    steps = np.diff(times)
    if steps.size:
        wide = np.append(steps, 0) > GAP * np.median(steps)
        inside &= ~wide[before] | exact
    return np.where(inside, result, np.nan), "" if exact.all() else "interpolated"


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
        pairs = [*(_flat(message, "") if topic.read is None else topic.read(message))]
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
    result = coordinate_of(name) if isinstance(name, str) else ""
    if not result:
        raise ValueError(f"{name!r} is no name of a joint")
    return result


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
    parts = {what: _optional(message, name) for what, name in _FIELDS}
    yield from _by_joint(_get(message, "name", "names"), **parts)


def _optional(message: Any, *names: str) -> Any:
    try:
        return _get(message, *names)
    except KeyError:
        return None


def _joints(message: Any) -> Iterator[tuple[str, Any]]:
    """Yield what foxglove.JointStates holds: a list with one entry a joint."""
    for part in _get(message, "joints"):
        joint = joint_name(_get(part, "name"))
        for what, name in _FIELDS:
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


JOINT_MESSAGES: Final = {
    "JointState": _joint_state,
    "JointStates": _joints,
    "JointTrajectoryControllerState": _controller,
    "DynamicJointState": _interfaces,
}
"""What reads messages with the state of joints, by the last name of their type."""


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
        if len(part) <= MOST_SIGNALS:
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
    listed = ", ".join(f"{part.name} ({part.kind}, {part.messages})" for part in full[:MOST_LISTED])
    more = f" and {len(full) - MOST_LISTED} more" if len(full) > MOST_LISTED else ""
    return (
        f"has no topic with states of joints ({', '.join(JOINT_MESSAGES)}); its topics, with types"
        f" and numbers of messages, are {listed}{more}. Name columns by topic and field, as"
        f' columns={{"position": "{full[0].name}/data"}}.'
    )


# Logs of messages: MCAP, and bags of ROS 2 and ROS 1.

# Compressed pieces of logs, expanded within bounds before a library expands them without any.
#
# A frame of a few bytes may stand for gigabytes, and what a file says of its sizes need not be
# true. So each compressed piece is read once through a decompressor that keeps nothing, and what
# comes out is counted. Where an index of a file says where its pieces are, it has to name those
# that were read.
#
# Sources: MCAP Format Specification; ROS Bag Format Version 2.0.

CURE: Final = "split it, or keep fewer topics"
IN_A_PIECE: Final = "expanded bytes in a piece"
WRONG_INDEX: Final = "its index does not fit its chunks"
CUT: Final = "a record is longer than the file"
LARGEST: Final = 2**28
"""Bytes that one piece becomes at most, which is then in memory; writers make some megabytes."""
RATIO: Final = 100
"""Bytes that a large file becomes at most over its own, which joints at rest do not reach."""
MCAP_MAGIC: Final = b"\x89MCAP0\r\n"
FOOTER: Final = struct.calcsize("<BQQQI") + len(MCAP_MAGIC)
"""Bytes of the last record of an MCAP file, with the magic behind it."""
ROS1_MAGIC: Final = b"#ROSBAG V2.0\n"


def _zstd(stream: BinaryIO) -> Any:
    import zstandard

    decompressor = zstandard.ZstdDecompressor(max_window_size=2**27)
    return decompressor.stream_reader(stream, read_across_frames=True, closefd=False)


def _lz4(stream: BinaryIO) -> Any:
    import lz4.frame  # type: ignore[import-untyped]

    return lz4.frame.LZ4FrameFile(stream)


METHODS: Final[dict[str, Callable[[BinaryIO], Any]]] = {
    "zstd": _zstd,
    "lz4": _lz4,
    "bz2": bz2.BZ2File,
}


class Expansion:
    """What the compressed pieces of files become together."""

    def __init__(self, *paths: Path) -> None:
        self.file, self.total = str(paths[0]), 0
        self.most = max(8 * MOST_NUMBERS, RATIO * sum(path.stat().st_size for path in paths))

    def blocks(self, stream: BinaryIO, method: str, largest: float = LARGEST) -> Iterator[bytes]:
        """Yield what a piece becomes, a block at a time; end where it becomes too large."""
        own, opened = 0, METHODS[method](stream)
        while block := opened.read(LONGEST_LINE):
            own, self.total = own + len(block), self.total + len(block)
            check_size(self.file, own, CURE, unit=IN_A_PIECE, most=largest)
            check_size(self.file, self.total, CURE, unit="expanded bytes", most=self.most)
            yield block

    def size(self, data: bytes, method: str) -> int:
        """Return how many bytes a piece becomes."""
        return sum(map(len, self.blocks(io.BytesIO(data), method)))

    def expanded(self, data: bytes, method: str) -> bytes:
        """Return what a piece becomes."""
        return b"".join(self.blocks(io.BytesIO(data), method))

    def check_piece(self, data: bytes, method: str, said: int) -> None:
        """Refuse a piece that becomes too large, or of another size than the file says."""
        check_size(self.file, said, CURE, unit=IN_A_PIECE, most=LARGEST)
        if method in METHODS and self.size(data, method) != said:
            raise ValueError("a compressed chunk has another size than it says")


def check_mcap(path: Path) -> None:
    """Refuse an MCAP file whose chunks become too large, or whose index names other ones."""
    result, chunks, indexed = Expansion(path), {}, []
    with open_regular(path) as file:
        end = file.seek(0, io.SEEK_END) - len(MCAP_MAGIC)
        file.seek(max(0, end + len(MCAP_MAGIC) - FOOTER))
        footer = file.read()
        if len(footer) < FOOTER or footer[-8:] != MCAP_MAGIC or footer[0] != 2:
            return  # the library says what it misses
        summary = struct.unpack_from("<Q", footer, 9)[0]
        begins = {0, end - FOOTER + 8}
        for place, kind, size in _records(file, len(MCAP_MAGIC), end):
            if place == summary:
                begins.add(place)
            if kind == 6:  # chunk
                chunks[place] = piece = _sizes(file.read(min(size, 100)), "<16xQ4x", "<Q")
                check_size(str(path), piece[0], CURE, unit=IN_A_PIECE, most=LARGEST)
                file.seek(place + 9 + 40 + len(piece[1].encode()))
                result.check_piece(file.read(piece[2]), piece[1], piece[0])
            elif kind == 8:  # index of a chunk
                data = file.read(size)
                offsets = struct.unpack_from("<16xQ8xI", data)
                skipped = 32 + 4 + offsets[1] + 8
                method, rest = _text(data[skipped:])
                compressed, original = struct.unpack_from("<QQ", rest)
                indexed.append((offsets[0], (original, method, compressed)))
    if summary not in begins or any(chunks.get(place) != piece for place, piece in indexed):
        raise ValueError(WRONG_INDEX)


def _records(file: BinaryIO, place: int, end: int) -> Iterator[tuple[int, int, int]]:
    """Yield place, kind and size of the records of an MCAP file, which fill it."""
    while place < end:
        file.seek(place)
        kind, size = struct.unpack("<BQ", file.read(9))
        if place + 9 + size > end:
            raise ValueError(CUT)
        yield place, kind, size
        place += 9 + size


def _sizes(data: bytes, before: str, after: str) -> tuple[int, str, int]:
    """Return size, compression and compressed size of a chunk."""
    (original,) = struct.unpack_from(before, data)
    method, rest = _text(data[struct.calcsize(before) :])
    return original, method, struct.unpack_from(after, rest)[0]


def _text(data: bytes) -> tuple[str, bytes]:
    """Return a text behind its length, and what follows it."""
    end = 4 + struct.unpack_from("<I", data)[0]
    return data[4:end].decode(), data[end:]


def check_ros1(path: Path) -> None:
    """Refuse a bag of ROS 1 whose chunks become too large, or whose index names other ones."""
    result, chunks, indexed, begins, index = Expansion(path), set(), set(), set(), 0
    with open_regular(path) as file:
        end = file.seek(0, io.SEEK_END)
        file.seek(0)
        if file.read(len(ROS1_MAGIC)) != ROS1_MAGIC:
            return  # the library says what it misses
        while (place := file.tell()) < end:
            fields = _ros1_fields(_ros1_block(file, end, LARGEST))
            kind = fields[b"op"][0]
            if kind == 5:
                chunks.add(place)
                method = fields[b"compression"].decode()
                said = struct.unpack("<I", fields[b"size"])[0]
                result.check_piece(_ros1_block(file, end, end), method, said)
                continue
            if kind == 3:
                index = struct.unpack("<Q", fields[b"index_pos"])[0]
            elif kind == 6:
                begins.add(place)
                indexed.add(struct.unpack("<Q", fields[b"chunk_pos"])[0])
            elif kind == 7:
                begins.add(place)
            _ros1_block(file, end, end)
    if not indexed <= chunks or (index and chunks and index not in begins):
        raise ValueError(WRONG_INDEX)


def _ros1_block(file: BinaryIO, end: int, most: int) -> bytes:
    """Return the bytes behind their length."""
    (size,) = struct.unpack("<I", file.read(4))
    if size > most or file.tell() + size > end:
        raise ValueError(CUT)
    return file.read(size)


def _ros1_fields(header: bytes) -> dict[bytes, bytes]:
    result, place = {}, 0
    while place < len(header):
        (size,) = struct.unpack_from("<I", header, place)
        name, _, value = header[place + 4 : place + 4 + size].partition(b"=")
        result[name] = value
        place += 4 + size
    return result


# Logs in MCAP: messages of ROS 2, or in JSON.

MCAP: Final = (".mcap",)


def read_mcap(path: Path, names: Collection[str] = ()) -> FileTable:
    """Return the states of joints in a log."""
    for name in ("mcap.reader", "mcap_ros2.decoder"):
        require_library(name, "logs", f"convert {path} to CSV")
    from mcap.decoder import DecoderFactory
    from mcap.exceptions import DecoderNotFoundError, McapError
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory as Ros2

    class Json(DecoderFactory):
        @override
        def decoder_for(self, message_encoding: str, schema: Any) -> Callable[[bytes], Any] | None:
            return _from_json if message_encoding == "json" else None

    try:
        check_mcap(path)
        with path.open("rb") as file:
            reader = make_reader(file, decoder_factories=[Ros2(), Json()], validate_crcs=True)
            return table_of(_Mcap(str(path), reader), str(path), names)
    except InputError:
        raise
    except DecoderNotFoundError:
        raise InputError(
            f"{path}: its messages of ROS 2 are described in IDL, which is not decoded: convert it"
            " with `ros2 bag convert`."
        ) from None
    except McapError as error:
        reason = one_line(error)
        raise InputError(
            f"{path}: is not an MCAP file, or is damaged ({reason}): `mcap recover` of the MCAP"
            " command line saves what can be read."
        ) from None
    except Exception as error:
        # Decompression and decoding have whatever error their parsers stumble over.
        reason = one_line(error)
        raise InputError(f"{path}: is damaged, or has a message that is: {reason}.") from None


def _from_json(data: bytes) -> Any:
    if len(data) > LARGEST_TEXT:
        raise ValueError(f"it has {len(data)} bytes of JSON, more than {LARGEST_TEXT}")
    return json_of(data)


class _Mcap:
    """A file that is open."""

    def __init__(self, file: str, reader: Any) -> None:
        self.reader, self.file = reader, file
        summary = reader.get_summary()
        sizes: dict[int, int] = {}
        if summary is None or summary.statistics is None:
            channels, schemas = {}, {}
            for schema, channel, _ in reader.iter_messages():
                channels[channel.id] = channel
                schemas[channel.schema_id] = schema
                sizes[channel.id] = sizes.get(channel.id, 0) + 1
        else:
            channels, schemas = summary.channels, summary.schemas
            sizes = summary.statistics.channel_message_counts
        self.encodings = {chan.topic: chan.message_encoding for chan in channels.values()}
        kinds = {key: schema.name for key, schema in schemas.items() if schema is not None}
        self.topics: Sequence[Topic] = topics_of(
            (chan.topic, kinds.get(chan.schema_id, chan.message_encoding), sizes.get(key, 0))
            for key, chan in channels.items()
        )

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        other = [
            f"{topic} ({self.encodings[topic]})"
            for topic in topics
            if self.encodings[topic] not in ("cdr", "json")
        ]
        if other:
            raise InputError(
                f"{self.file}: messages of {joined(other)} cannot be decoded: those of ROS 2"
                " (cdr) and in JSON can."
            )
        for _, channel, message, decoded in self.reader.iter_decoded_messages(topics=topics):
            yield channel.topic, message.log_time, decoded


# Bags of ROS 2 and ROS 1.
#
# The files of a bag of ROS 2 are read one by one, and not by way of the folder: compressed ones,
# and compressed messages, are expanded here, within bounds.

BAGS: Final = (".db3", ".bag")
"""Endings of files of bags."""
PARTS: Final = ("*.db3*", "*.mcap*")
"""Files in the folder of a bag of ROS 2 that hold its messages, compressed or not."""
METADATA: Final = "metadata.yaml"
"""File in the folder of a bag of ROS 2 that lists the others."""


def read_bag(path: Path, names: Collection[str] = ()) -> FileTable:
    """Return the states of joints in a bag."""
    require_library("rosbags.highlevel", "logs", f"convert {path} to CSV")
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with parsed_as(path, "a ROS bag"):
        said = _described(path) if path.name == METADATA else _Described(files=(path,))
        with ExitStack() as stack:
            files = said.files
            if said.mode == "file":
                place = stack.enter_context(private_folder())
                files = tuple(_expanded(part, place) for part in files)
            for file in files:
                _check(file)
            # Bags of SQLite hold no definitions of messages before ROS 2 Iron.
            store = get_typestore(Stores.LATEST)
            reader = stack.enter_context(AnyReader([*files], default_typestore=store))
            return table_of(_Bag(reader, said), str(path), names)


@dataclass(frozen=True, kw_only=True)
class _Described:
    """What the metadata of a bag say."""

    files: tuple[Path, ...]
    mode: str = ""
    """What is compressed: "file", "message", or nothing."""
    counts: Mapping[str, int] = field(default_factory=dict)
    """Messages by topic."""


def _described(path: Path) -> _Described:
    """Return what the metadata of a bag say."""
    from ruamel.yaml import YAML

    with open_regular(path) as file:
        data = file.read(LARGEST_TEXT + 1)
    if len(data) > LARGEST_TEXT:
        raise ValueError(f"{METADATA} has more than {number(LARGEST_TEXT / 1e6)} MB")
    information = YAML(typ="safe").load(data.decode())["rosbag2_bagfile_information"]
    mode = str(information.get("compression_mode") or "none").casefold()
    method = str(information.get("compression_format") or "").casefold()
    if mode not in ("none", "file", "message") or (mode != "none" and method != "zstd"):
        raise ValueError(f"its compression is {mode!r} by {method!r}, and that by zstd is read")
    files = tuple(path.parent / PurePath(name).name for name in information["relative_file_paths"])
    missing = [place for place in files if not place.is_file()]
    if missing or not files:
        raise InputError(
            f"{path}: lists the file {missing[0].name}, which is not beside it."
            if missing
            else f"{path}: lists no files of messages."
        )
    counts: dict[str, int] = {}
    for counted in information["topics_with_message_count"]:
        topic = str(counted["topic_metadata"]["name"])
        counts[topic] = counts.get(topic, 0) + int(counted["message_count"])
    return _Described(files=files, mode="" if mode == "none" else mode, counts=counts)


def _expanded(path: Path, place: Path) -> Path:
    """Write what a compressed file becomes into a folder, and return where."""
    result, target = Expansion(path), place / path.stem
    with open_regular(path) as file, target.open("xb") as expanded:
        for block in result.blocks(file, "zstd", largest=result.most):
            expanded.write(block)
    return target


def _check(path: Path) -> None:
    """Refuse a file with messages that are not in it, but would be made when it is read."""
    if path.suffix == ".mcap":
        check_mcap(path)
    elif path.suffix == ".bag":
        check_ros1(path)
    else:
        with closing(sqlite3.connect(f"{path.absolute().as_uri()}?immutable=1", uri=True)) as file:
            if any(row[6] for row in file.execute("PRAGMA table_xinfo(messages)")):
                raise ValueError("its messages are computed and not stored")


class _Bag:
    """A bag that is open."""

    def __init__(self, reader: Any, said: _Described) -> None:
        self.reader, self.said = reader, said
        topics = topics_of(
            (connection.topic, connection.msgtype, connection.msgcount)
            for connection in reader.connections
        )
        self.topics: Sequence[Topic] = [
            replace(topic, messages=said.counts.get(topic.name, topic.messages)) for topic in topics
        ]

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        wanted = [source for source in self.reader.connections if source.topic in topics]
        expansion = Expansion(*self.said.files) if self.said.mode == "message" else None
        for connection, logged, data in self.reader.messages(connections=wanted):
            message = data if expansion is None else expansion.expanded(data, "zstd")
            yield connection.topic, logged, self.reader.deserialize(message, connection.msgtype)


# Files of any format as columns by the quantity they hold, and conditions of trials in them.

# The file formats that are read, each by one function: a new one is a file and an entry here.

TEXT: Final = (".csv", ".tsv", ".txt", ".dat", ".asc", ".lvm", ".log", ".prn")
"""Endings of text files, beside those that have none."""


@dataclass(frozen=True, kw_only=True)
class Format:
    """A format of data files."""

    endings: tuple[str, ...]
    """Endings of its files, in lower case, or the ends of their names."""
    read: Callable[[Path, Collection[str]], FileTable]
    """Reads a file; what it is told are the columns that are wanted by name."""
    streamed: bool = False
    """Whether a file may be of any size, because only parts of it are kept."""
    within: str = ""
    """Path of such a file in a folder that may be given instead."""
    beside: tuple[str, ...] = ()
    """Patterns of the files in that folder that hold the data."""


FORMATS: Final = (
    Format(endings=TEXT, read=lambda path, _: csv_reader.read_text(path)),
    Format(endings=binary.PARQUET, read=binary.read_parquet),
    Format(endings=(".mat",), read=binary.read_mat),
    Format(endings=binary.MDF, read=binary.read_mdf),
    Format(endings=binary.TDMS, read=binary.read_tdms),
    Format(endings=csv_reader.SPREADSHEET, read=csv_reader.read_spreadsheet),
    Format(endings=MCAP, read=read_mcap, streamed=True),
    Format(endings=BAGS, read=read_bag, streamed=True),
    Format(endings=(METADATA,), read=read_bag, within=METADATA, beside=PARTS),
    Format(
        endings=("info.json",),
        read=robots.read_lerobot,
        within=robots.INFO,
        beside=(robots.EPISODES,),
    ),
    Format(endings=(".json",), read=robots.read_servo),
)
"""Formats by the ends of the names of their files."""


def format_of(path: Path) -> Format | None:
    """Return the format of a file by its name; None if it is read by no function.

    Examples
    --------
    >>> format_of(Path("run.CSV")) is FORMATS[0], format_of(Path("rig.toml"))
    (True, None)
    """
    if is_text(path):
        return FORMATS[0]
    name = path.name.lower()
    return next((form for form in FORMATS if name.endswith(form.endings)), None)


def is_text(path: Path) -> bool:
    """Whether a file is read as text: by its ending, or as it has none.

    Examples
    --------
    >>> [is_text(Path(name)) for name in ("run.CSV", "log", "run_0.5mm", "run.mat", "info.json")]
    [True, True, True, False, False]
    """
    ending = path.suffix.lower()
    return ending in TEXT or not ending[1:2].isalpha()


def data_file(path: Path) -> Path:
    """Return the file to read of a folder that holds a log; a file as it is."""
    inside = (path / form.within for form in FORMATS if form.within)
    return next((file for file in inside if file.is_file()), path)


def log_name(path: Path) -> str:
    """Return what a file is called without its ending; a log in a folder is called like that.

    Examples
    --------
    >>> log_name(Path("run.csv")), log_name(Path("run_0.5mm")), log_name(Path("a/metadata.yaml"))
    ('run', 'run_0.5mm', 'a')
    """
    known = format_of(path)
    if known is None or not known.within:
        return path.stem if path.suffix[1:2].isalpha() else path.name
    return path.absolute().parents[len(Path(known.within).parts) - 1].name


def log_files(path: Path) -> list[Path]:
    """Return the files that hold what one stands for: several of a log in a folder."""
    file = data_file(path)
    known = format_of(file)
    if known is None or not known.within:
        return [file]
    folder = file.parents[len(Path(known.within).parts) - 1]
    return [file, *(place for pattern in known.beside for place in sorted(folder.glob(pattern)))]


# Columns of CSV, Parquet and MATLAB files, by the quantity they hold.

SECOND: Final = "position, second coordinate"
"""What the second column of a position in a plane is known by."""
TIMES: Final = ("t", "time")
"""Names of a column of times, in either case, where a position has none other."""
RUN: Final = frozenset({"t", "friction", "normal_force", "mode"})
"""Columns by which a file shows that a run of this package wrote it."""
STATES: Final = ({"x": "position", "v": "velocity"}, {"theta": "position", "omega": "velocity"})
"""What the states of one body are called there, on a line and about an axis."""
_HEADER = re.compile(r"(?P<name>[^\[\]]*+)(?:\[(?P<unit>[^\[\]]*+)\])?+")


_PART_OF_STAMP = re.compile(
    r"(?:(?P<stamp>.*?)[._/ ])?(?P<nano>n|nano)?(?:secs?|seconds?)", re.IGNORECASE
)
"""header.stamp.secs and header.stamp.nsecs, stamp_sec and stamp_nanosec."""


@dataclass(frozen=True, kw_only=True)
class QuantityTable(FileTable):
    """A table whose columns are known by the quantities they hold."""

    file: str
    """Name of the file, for messages."""
    names: Mapping[str, str]
    """Quantity, parameter path, or the column's own name -> column in the data."""
    units: Mapping[str, str | None]
    """Unit by the same names; None where numbers are in SI."""

    def is_empty(self, name: str) -> bool:
        """Return whether no cell of a column holds anything, as of a channel that was off."""
        return bool(self.data[self.names[name]].isna().all())

    def as_headed(self) -> "QuantityTable":
        """Return the table with all columns known by their headers, as who names them does."""
        known = {header: name for name, header in _headers(self.file, self.data)[0].items()}
        own = {key: known[header] for key, header in self.names.items()}
        return replace(
            self,
            names={own[key]: header for key, header in self.names.items()},
            units={own[key]: unit for key, unit in self.units.items()},
        )

    def at_rate(self, rate: str) -> "QuantityTable":
        """Return the table with a column, called like a rate, of the times of its rows."""
        times = regular_times(rate, len(self.data))
        if times is None or rate in self.names:
            return self
        return replace(
            self,
            data=self.data.assign(**{rate: times}),
            names={**self.names, rate: rate},
            units={**self.units, rate: "s"},
        )

    def column(self, given: Column) -> Column:
        """Return the column, or the two of a position, that a name stands for."""
        if isinstance(given, str):
            return _known_column(self.file, given, self.names)
        first, second = (_known_column(self.file, name, self.names) for name in given)
        return first, second

    def line(self, row: int) -> str:
        """Return where a row stands in the file."""
        kind = "line" if self.first_row > 1 else "row"
        return f"{kind} {self.first_row + int(self.data.index[row])}"

    def place(self, name: str, row: int) -> str:
        """Return where a cell stands, for messages."""
        return f"{self.file}: column {self.names[name]!r}, {self.line(row)}"

    def numbers(self, name: str, target: str | None) -> NDArray[np.float64]:
        """Return a column (n,) as numbers in the target unit, or in SI."""
        return self.scaled(name, self.raw(name), target)

    def raw(
        self, name: str, *, holes: bool = False, repairable: bool = False
    ) -> NDArray[np.float64]:
        """Return a column (n,) as the numbers that stand there.

        All are finite, unless `holes` lets cells be empty, NaN or infinite. `repairable` says that
        the caller has an option that would.
        """
        column = self.data[self.names[name]]
        if name == "time" and not pd.api.types.is_numeric_dtype(column.dtype):
            column = _times(column)
        cells = pd.Series(np.nan, column.index) if _is_other(column) else column
        if self.doubted and not pd.api.types.is_numeric_dtype(column.dtype):
            cells = cells[~cells.map(csv_reader.is_doubted)].reindex(column.index)
        values = pd.to_numeric(cells, errors="coerce").to_numpy(dtype=float, na_value=np.nan)
        wrong = ~np.isfinite(values)
        if holes:  # what is a number or nothing at all may stay
            wrong &= column.notna().to_numpy() & np.isnan(values)
        bad = np.flatnonzero(wrong)
        if bad.size:
            first = csv_reader.culprit(column.iloc[bad].tolist())
            row, cell = int(bad[first]), column.iloc[bad].tolist()[first]
            got = "nothing" if pd.isna(cell) else shown(cell)
            hole = pd.isna(cell) or np.isinf(values[row])
            cure = ' To drop such samples, give repair="gaps".' if repairable and hole else ""
            raise errors.ParameterError(
                f"{self.place(name, row)}: must be a finite number, got {got}."
                f"{cure or csv_reader.grouped(cell)}"
            )
        return values

    def scaled(
        self, name: str, values: NDArray[np.float64], target: str | None
    ) -> NDArray[np.float64]:
        """Convert values of a column from its unit to the target unit, or to SI."""
        unit = self.units.get(name)
        if unit is None:
            return values
        try:
            if target == CELSIUS:
                return np.asarray(converted(values, unit, target))
            scale = factor(unit, target)
        except errors.ParameterError as error:
            cure = f'; give metres per pixel as gain={{"{name}": ...}}' if is_pixel(unit) else ""
            raise errors.ParameterError(
                f"{self.file}: column {self.names[name]!r} {error}{cure}."
            ) from None
        # Division by a whole number rounds once, so that 35 mm is the float 0.035.
        whole = round(1.0 / scale) if scale < 1.0 else 0
        return values / whole if whole and 1.0 / whole == scale else values * scale


def _times(column: "pd.Series[Any]") -> "pd.Series[Any]":
    """Return time stamps as seconds, and everything else as it is."""
    stamps = seconds_of(column)
    if stamps is not None:
        return pd.Series(stamps, index=column.index)
    # h:mm:ss:cc, as well as numbers
    return column.map(lambda cell: cell if seconds(cell) is None else seconds(cell))


def _is_other(column: "pd.Series[Any]") -> bool:
    """Whether a column holds neither real numbers nor text: others would convert to some."""
    kinds = pd.api.types
    if kinds.is_bool_dtype(column.dtype) or kinds.is_complex_dtype(column.dtype):
        return True
    return not any(
        check(column.dtype)
        for check in (kinds.is_numeric_dtype, kinds.is_string_dtype, kinds.is_object_dtype)
    )


def is_data_file(path: Path) -> bool:
    """Whether the ending of a file is one that is read as a measurement.

    Examples
    --------
    >>> is_data_file(Path("run.CSV")), is_data_file(Path("rig.toml"))
    (True, False)
    """
    file = data_file(path)
    return format_of(file) is not None and (bool(file.suffix) or file.is_file())


def read_frame(
    path: str | Path,
    *,
    columns: Mapping[str, Column],
    units: Mapping[str, str],
    layout: Layout | None = None,
    also: Collection[str] = (),
) -> QuantityTable:
    """Read a file and find out what its columns hold.

    `also` names columns that are wanted whatever they hold, of files that have more than a table.
    """
    check_path(path)
    path = data_file(Path(path))
    check_file(path)
    file = str(path)
    known = format_of(path)
    if known is None or not known.streamed:
        errors.check_size(
            file, path.stat().st_size, "split it", unit="bytes", most=16 * errors.MOST_NUMBERS
        )
    single = dict(_single(columns))
    if layout is not None and not is_text(path):
        raise errors.InputError(
            f"{file}: a layout is that of a text file, such as .csv: leave it out."
        )
    if known is None:
        *endings, last = (ending for form in FORMATS for ending in form.endings)
        raise errors.InputError(
            f"{file}: must be a {', '.join(endings)} or {last} file, got {path.suffix}. Save other"
            " spreadsheets as CSV."
        )
    named = dict.fromkeys((*single.values(), *also))
    wanted = [name for name in named if regular_times(name, 1) is None]
    table = known.read(path, wanted) if layout is None else csv_reader.read_text(path, layout)
    data, signs = robots.with_signs(table.data)
    table = replace(table, data=data, remarks=(*table.remarks, *signs))
    return frame_of(table, file, columns=single, units=units)


def frame_of(
    table: FileTable, file: str, *, columns: Mapping[str, Column], units: Mapping[str, str]
) -> QuantityTable:
    """Find out what the columns of a table hold; times may be a rate instead of a column."""
    data = table.data
    if data.empty:
        raise errors.InputError(f"{file}: has no rows.")
    errors.check_columns(file, len(data.columns))
    longest = max(map(str, data.columns), key=len, default="")
    if len(longest) > LONGEST_NAME:
        raise errors.InputError(
            f"{file}: the name of a column, {shown(longest)}, has {len(longest):,} characters; it"
            f" may have {LONGEST_NAME}."
        )
    single = dict(_single(columns))
    times = regular_times(single.get("time"), len(data))
    if times is not None and single["time"] not in data.columns:
        data = data.assign(**{single["time"]: times})
    stated = single.get(STATED, "")
    constant = split_number(stated)
    if constant is not None and not is_half_width(stated) and stated not in data.columns:
        header = f"{stated} [{constant['unit'] or ''}]"
        data = data.assign(**{header: float(constant["number"])})
    return _named(file, replace(table, data=data), single, units)


def _single(columns: Mapping[str, Column]) -> Iterator[tuple[str, str]]:
    """Yield each column with what it is known by."""
    for quantity, column in columns.items():
        if isinstance(column, str):
            yield quantity, column
        else:
            yield from zip((quantity, SECOND), column, strict=True)


def _named(
    file: str, table: FileTable, columns: Mapping[str, str], units: Mapping[str, str]
) -> QuantityTable:
    names, found_units = _headers(file, table.data)
    data = table.data.set_axis(list(map(str, table.data.columns)), axis=1)
    own, own_units = dict(names), dict(found_units)
    for name, (parts, stamp) in _joined_stamps(data, names).items():
        for part in parts:  # still known to whoever names them
            del names[part], found_units[part]
        names[name] = own[name] = name
        found_units[name] = own_units[name] = "s"
        data = data.assign(**{name: stamp})
    unread = [name for name, column in columns.items() if not column]
    for quantity in unread:
        names.pop(quantity, None)
        found_units.pop(quantity, None)
    columns = {name: column for name, column in columns.items() if column}
    # A mapped column is known by its quantity alone, so none is used twice.
    for column in columns.values():
        key = _known_column(file, column, own)
        names.pop(key, None)
        found_units.pop(key, None)
    for quantity, column in columns.items():
        key = _known_column(file, column, own)
        names[quantity] = own[key]
        of = "position" if quantity == SECOND else quantity
        found_units[quantity] = own_units[key] or stated_unit(own[key], of)
    _recognise(names, found_units, of_run=not columns and names.keys() >= RUN)
    for name, unit in units.items():
        if name not in names:
            known = [label for label in names if label != SECOND]
            raise errors.UnknownNameError(f"column in units of {file}:", name, known)
        found_units[name] = "1" if unit in NO_UNIT else unit
    _called_plainly(names, found_units, unread)
    if SECOND in names:
        _check_plane(file, names, found_units, "position" in units)
    known_table = {**vars(table), "data": data}
    return QuantityTable(file=file, names=names, units=found_units, **known_table)


def _called_plainly(
    names: dict[str, str], units: dict[str, str | None], unread: Collection[str]
) -> None:
    """Call what a record in time, or a table of friction, has under other plain names.

    A speed has no sign: beside positions it is no velocity.
    """
    if not {"time", "friction"} & names.keys() or {*TRAVELS} & names.keys():
        return
    for quantity, meaning in VOCABULARY.items():
        word = next((word for word in meaning.plain if word in names), "")
        signed = word != "speed" or "position" not in names
        if word and signed and quantity not in (*names, *unread):
            names[quantity], units[quantity] = names.pop(word), units.pop(word)


def _recognise(names: dict[str, str], units: dict[str, str | None], *, of_run: bool) -> None:
    """Call the states of a run, and what stands beside others, by their quantities."""
    beside = f"{without_unit(names.get('friction', ''))}_uncertainty"
    if beside in names:  # of cells such as 3.51 ± 0.1
        names.setdefault(STATED, names.pop(beside))
        units.setdefault(STATED, units.pop(beside))
    states = next((state for state in STATES if of_run and state.keys() <= names.keys()), {})
    for word, quantity in states.items():
        names[quantity], units[quantity] = names.pop(word), units.pop(word)
    key = next((name for name in names if name.casefold() in TIMES), "")
    if key and "position" in names and "time" not in names:
        names["time"], units["time"] = names.pop(key), units.pop(key)


def _headers(file: str, data: pd.DataFrame) -> tuple[dict[str, str], dict[str, str | None]]:
    """Return the header of each column by its name, and its unit if brackets hold one."""
    names: dict[str, str] = {}
    found_units: dict[str, str | None] = {}
    for header in map(str, data.columns):
        match = _HEADER.fullmatch(header.strip())
        name, unit = (match["name"].rstrip(), match["unit"]) if match else (header, None)
        if unit and unit.isdigit() and f"{name}[{unit}]" in header:  # position[0]: an index
            name, unit = header, None
        if name in names:
            raise csv_reader.ambiguous(file, name)
        names[name] = header
        found_units[name] = "1" if unit in NO_UNIT else unit and (unit_in(unit) or None)
    return names, found_units


def _joined_stamps(
    data: pd.DataFrame, names: Mapping[str, str]
) -> dict[str, tuple[Sequence[str], NDArray[np.float64]]]:
    """Return times [s] of which two columns hold seconds and nanoseconds, as in ROS, and these two.

    Times count from the first whole second, so that no digit is lost.
    """
    result: dict[str, tuple[Sequence[str], NDArray[np.float64]]] = {}
    parts = {name: match for name in names if (match := _PART_OF_STAMP.fullmatch(name))}
    for fine, match in parts.items():
        both = [name for name, other in parts.items() if other["stamp"] == match["stamp"]]
        stamp = match["stamp"] or "stamp"
        if not match["nano"] or len(both) != 2 or stamp in names:
            continue
        both.sort(key=fine.__eq__)
        whole, rest = (data[names[name]] for name in both)
        if all(pd.api.types.is_numeric_dtype(column.dtype) for column in (whole, rest)):
            whole = whole.astype(float)  # differences of unsigned numbers would be none
            begin = next(iter(whole.dropna()), 0.0)
            result[stamp] = both, (whole - begin + 1e-9 * rest).to_numpy(dtype=float)
    return result


def _check_plane(
    file: str, names: Mapping[str, str], units: dict[str, str | None], said: bool
) -> None:
    """Give both coordinates of a position one unit, or say that they have two."""
    if said:
        units[SECOND] = units["position"]
    if units[SECOND] != units["position"]:
        raise errors.InputError(
            f"{file}: the columns {names['position']!r} and {names[SECOND]!r} of the position have"
            ' different units: give one unit for both, as units={"position": "..."}.'
        )


def _known_column(file: str, column: Any, own: Mapping[str, str]) -> str:
    for name, header in own.items():
        if column in (name, header):
            return name
    of_run = next((state for state in STATES if own.keys() >= RUN | state.keys()), {})
    for word, quantity in {"t": "time", **of_run}.items():
        if of_run and column == quantity:
            return word
    bare = [name for name in own if without_unit(name).casefold() == str(column).casefold()]
    if len(bare) == 1:
        return bare[0]
    # The coordinate of the only track has a short name too.
    short = [name for name in own if name.rpartition(SEPARATOR)[2].lower() == str(column).lower()]
    if len(short) == 1:
        return short[0]
    if short:
        pair = [name for name in own if name.startswith(short[0].rpartition(SEPARATOR)[0])][:2]
        raise errors.InputError(
            f"{file}: {len(short)} tracks have a column {column!r}: {', '.join(map(repr, short))}."
            f' Choose one, as columns={{"position": ["{pair[0]}", "{pair[-1]}"]}}.'
        )
    raise errors.UnknownNameError(f"column of {file}:", str(column), own)


# Conditions of trials from the columns of files, and the columns that nothing was read from.

KELVINS = ("K", "°C", "degC", "°F", "degF")
"""Units of temperatures."""


def by_trial(frame: QuantityTable) -> Iterator[tuple[str, QuantityTable]]:
    """Yield the rows of each trial with its name, in the order in which they come.

    A table without a column of trials, or with one trial only, is yielded as it is.
    """
    if TRIAL not in frame.names:
        yield "", frame
        return
    cells = frame.data[frame.names[TRIAL]]
    if cells.isna().any():
        row = int(np.flatnonzero(cells.isna())[0])
        raise errors.InputError(
            f"{frame.place(TRIAL, row)}: the trial of this row is missing: fill the cell."
        )
    if cells.nunique() == 1:
        yield "", frame
        return
    for value in cells.unique():
        name = f"{TRIAL} {value:g}" if isinstance(value, float) else f"{TRIAL} {value}"
        yield name, replace(frame, data=frame.data[cells == value])


def condition_keys(frame: QuantityTable, columns: Sequence[str]) -> dict[str, str]:
    """Return the column of each condition, by name, with its unit if the column has one."""
    result = {}
    for name in columns:
        own = next(
            (
                key
                for key, header in frame.names.items()
                if name in (key, header, header.partition("[")[0].strip())
            ),
            None,
        )
        if own is None:
            raise errors.UnknownNameError(
                f"column in conditions of {frame.file}:", name, frame.names
            )
        unit = frame.units.get(own)
        result[f"{own} [{unit}]" if unit not in (None, "1") else own] = own
    return result


def condition_cells(frame: QuantityTable, name: str) -> list[float | str | None]:
    """Return the cells of a column as numbers, or as texts if one is none; None where empty."""
    column = frame.data[frame.names[name]]
    numbers = pd.to_numeric(column, errors="coerce")
    if numbers.notna().sum() == column.notna().sum() and column.dtype != bool:
        return [float(cell) if np.isfinite(cell) else None for cell in numbers.astype(float)]
    return [None if pd.isna(cell) else str(cell).strip() or None for cell in column]


def conditions_in(frame: QuantityTable, columns: Sequence[str]) -> dict[str, float | str]:
    """Return the conditions of a record, whose columns have one value each.

    A condition without any value is left out.
    """
    result: dict[str, float | str] = {}
    for key, name in condition_keys(frame, columns).items():
        cells = [cell for cell in condition_cells(frame, name) if cell is not None]
        values = set(cells)
        if not values:
            continue
        known = [cell for cell in cells if isinstance(cell, float)]
        if len(values) == 1:
            result[key] = cells[0]
        elif len(known) == len(cells) and (
            np.ptp(known) <= SLIGHT * abs(float(np.mean(known)))
            or _is_temperature(name, frame.units.get(name))
        ):
            result[key] = float(np.mean(known))
        else:
            shown = (
                f"from {number(min(known))} to {number(max(known))}"
                if len(known) == len(cells)
                else f"{len(values)} texts"
            )
            raise errors.InputError(
                f"{frame.file}: column {frame.names[name]!r} changes within the trial ({shown}),"
                " but a condition has one value per trial. Split the record, or leave the"
                " condition out."
            )
    return result


def _is_temperature(name: str, unit: str | None) -> bool:
    """Whether a column is one of temperatures, which no experimenter can hold."""
    words = re.split(r"[\W\d_]+", name.casefold())
    named = any(
        w == "temp" or w.startswith("temperatur") or w.endswith("temperatur") for w in words
    )
    return named or unit in KELVINS


def unused_in(frame: QuantityTable, used: Collection[str]) -> dict[str, float | str | None]:
    """Return the columns that nothing was read from, with their value if they have one."""
    result: dict[str, float | str | None] = {}
    for name in frame.names:
        if name in used or not name:
            continue
        column = frame.data[frame.names[name]]
        alike = len(column) > 0 and bool((column == column.iloc[0]).all())
        result[name] = (
            condition_cells(replace(frame, data=frame.data[:1]), name)[0] if alike else None
        )
    return result
