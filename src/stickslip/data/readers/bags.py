"""Logs of messages: MCAP, and bags of ROS 2 and ROS 1.

A frame of a few bytes may stand for gigabytes, and what a file says of its sizes need not be true.
So each compressed piece is expanded here, within bounds, before a library expands it without any.
"""

import bz2
import io
import re
import sqlite3
import struct
from abc import ABC, abstractmethod
from array import array
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path, PurePath
from typing import Any, BinaryIO, Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.data.measurement import Array
from stickslip.data.readers.table import FileTable, json_of, one_line, parsed_as
from stickslip.data.tolerances import GAP, LARGEST_TEXT, MOST_LISTED
from stickslip.errors import MOST_NUMBERS, InputError, check_columns, check_size
from stickslip.mechanisms import coordinate_of
from stickslip.show.display import require_library
from stickslip.show.documents import open_regular, private_folder
from stickslip.show.formatting import count, joined, number
from stickslip.units import shown

# Topics of a robot's log as one table: states of joints by name, and any numbers on request.

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
LONGEST: Final = 64
"""Elements up to which an array in a message has a column each."""
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


def table_of(log: Log, file: str, names: Collection[str] = ()) -> FileTable:
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
        return FileTable(
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
        wide = np.append(steps, 0) > GAP * np.median(steps)
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
    listed = ", ".join(f"{part.name} ({part.kind}, {part.messages})" for part in full[:MOST_LISTED])
    more = f" and {len(full) - MOST_LISTED} more" if len(full) > MOST_LISTED else ""
    return (
        f"has no topic with states of joints ({', '.join(STATES)}); its topics, with types and"
        f" numbers of messages, are {listed}{more}. Name columns by topic and field, as"
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
BLOCK: Final = 2**20
MCAP_MAGIC: Final = b"\x89MCAP0\r\n"
FOOTER: Final = 37
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
        while block := opened.read(BLOCK):
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
    found, chunks, indexed = Expansion(path), {}, []
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
                found.check_piece(file.read(piece[2]), piece[1], piece[0])
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
    found, chunks, indexed, begins, index = Expansion(path), set(), set(), set(), 0
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
                found.check_piece(_ros1_block(file, end, end), method, said)
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
    found, place = {}, 0
    while place < len(header):
        (size,) = struct.unpack_from("<I", header, place)
        name, _, value = header[place + 4 : place + 4 + size].partition(b"=")
        found[name] = value
        place += 4 + size
    return found


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


class _Mcap(Log):
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
        found: dict[str, Topic] = {}
        self.encodings: dict[str, str] = {}
        for key, channel in channels.items():
            schema = schemas.get(channel.schema_id)
            before = found[channel.topic].messages if channel.topic in found else 0
            found[channel.topic] = Topic(
                name=channel.topic,
                kind=schema.name if schema is not None else channel.message_encoding,
                messages=before + sizes.get(key, 0),
            )
            self.encodings[channel.topic] = channel.message_encoding
        self.topics: Sequence[Topic] = [*found.values()]

    @override
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


LARGEST_METADATA: Final = 2_000_000
"""Bytes of it that are read at most: a file of messages takes some hundred."""


def _described(path: Path) -> _Described:
    """Return what the metadata of a bag say."""
    from ruamel.yaml import YAML

    with open_regular(path) as file:
        data = file.read(LARGEST_METADATA + 1)
    if len(data) > LARGEST_METADATA:
        raise ValueError(f"{METADATA} has more than {number(LARGEST_METADATA / 1e6)} MB")
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
    found, target = Expansion(path), place / path.stem
    with open_regular(path) as file, target.open("xb") as expanded:
        for block in found.blocks(file, "zstd", largest=found.most):
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


class _Bag(Log):
    """A bag that is open."""

    def __init__(self, reader: Any, said: _Described) -> None:
        self.reader, self.said = reader, said
        found: dict[str, Topic] = {}
        for source in reader.connections:
            before = found[source.topic].messages if source.topic in found else 0
            found[source.topic] = Topic(
                name=source.topic, kind=source.msgtype, messages=before + source.msgcount
            )
        self.topics: Sequence[Topic] = [
            replace(topic, messages=said.counts.get(name, topic.messages))
            for name, topic in found.items()
        ]

    @override
    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        wanted = [source for source in self.reader.connections if source.topic in topics]
        expansion = Expansion(*self.said.files) if self.said.mode == "message" else None
        for connection, logged, data in self.reader.messages(connections=wanted):
            message = data if expansion is None else expansion.expanded(data, "zstd")
            yield connection.topic, logged, self.reader.deserialize(message, connection.msgtype)
