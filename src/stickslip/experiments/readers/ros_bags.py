"""Bags of ROS 2 and ROS 1.

The files of a bag of ROS 2 are read one by one, and not by way of the folder: compressed ones, and
compressed messages, are expanded here, within bounds.
"""

import sqlite3
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath
from typing import Any, Final, final

from typing_extensions import override

from stickslip.documents import open_regular, private_folder
from stickslip.errors import InputError
from stickslip.experiments.readers.expansion import Expansion, check_mcap, check_ros1
from stickslip.experiments.readers.table import Table
from stickslip.experiments.readers.topics import Log, Topic, table_of
from stickslip.formatting import number

BAGS: Final = (".db3", ".bag")
"""Endings of files of bags."""
PARTS: Final = ("*.db3*", "*.mcap*")
"""Files in the folder of a bag of ROS 2 that hold its messages, compressed or not."""
METADATA: Final = "metadata.yaml"
"""File in the folder of a bag of ROS 2 that lists the others."""
LARGEST_METADATA: Final = 2_000_000
"""Bytes of it that are read at most: a file of messages takes some hundred."""


def read_bag(path: Path, names: Collection[str] = ()) -> Table:
    """Return the states of joints in a bag."""
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(
            f"{path}: ROS bags need the package rosbags: pip install 'stickslip[logs]'."
        ) from None
    try:
        said = _described(path) if path.name == METADATA else _Described(files=(path,))
        with ExitStack() as stack:
            files = said.files
            if said.mode == "file":
                place = stack.enter_context(private_folder())
                files = tuple(_expanded(one, place) for one in files)
            for one in files:
                _check(one)
            # Bags of SQLite hold no definitions of messages before ROS 2 Iron.
            store = get_typestore(Stores.LATEST)
            reader = stack.enter_context(AnyReader([*files], default_typestore=store))
            return table_of(_Bag(reader, said), str(path), names)
    except InputError:
        raise
    except Exception as error:
        # The package has whatever error its parsers stumble over.
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise InputError(f"{path}: is not a ROS bag, or is damaged: {reason}.") from None


@final
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
        data = file.read(LARGEST_METADATA + 1)
    if len(data) > LARGEST_METADATA:
        raise ValueError(f"{METADATA} has more than {number(LARGEST_METADATA / 1e6)} MB")
    told = YAML(typ="safe").load(data.decode())["rosbag2_bagfile_information"]
    mode = str(told.get("compression_mode") or "none").casefold()
    method = str(told.get("compression_format") or "").casefold()
    if mode not in ("none", "file", "message") or (mode != "none" and method != "zstd"):
        raise ValueError(f"its compression is {mode!r} by {method!r}, and that by zstd is read")
    files = tuple(path.parent / PurePath(one).name for one in told["relative_file_paths"])
    missing = [one for one in files if not one.is_file()]
    if missing or not files:
        raise InputError(
            f"{path}: lists the file {missing[0].name}, which is not beside it."
            if missing
            else f"{path}: lists no files of messages."
        )
    counts: dict[str, int] = {}
    for one in told["topics_with_message_count"]:
        topic = str(one["topic_metadata"]["name"])
        counts[topic] = counts.get(topic, 0) + int(one["message_count"])
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


@final
class _Bag(Log):
    """A bag that is open."""

    def __init__(self, reader: Any, said: _Described) -> None:
        self.reader, self.said = reader, said
        found: dict[str, Topic] = {}
        for one in reader.connections:
            before = found[one.topic].messages if one.topic in found else 0
            found[one.topic] = Topic(
                name=one.topic, kind=one.msgtype, messages=before + one.msgcount
            )
        self.topics: Sequence[Topic] = [
            replace(one, messages=said.counts.get(name, one.messages))
            for name, one in found.items()
        ]

    @override
    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        wanted = [one for one in self.reader.connections if one.topic in topics]
        expansion = Expansion(*self.said.files) if self.said.mode == "message" else None
        for connection, logged, data in self.reader.messages(connections=wanted):
            message = data if expansion is None else expansion.expanded(data, "zstd")
            yield connection.topic, logged, self.reader.deserialize(message, connection.msgtype)
