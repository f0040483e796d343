"""Logs of messages: MCAP, and bags of ROS 2 and ROS 1.

A frame of a few bytes may stand for gigabytes, and what a file says of its sizes need not be true.
So each compressed piece is expanded here, within bounds, before a library expands it without any.
"""

import bz2
import io
import sqlite3
import struct
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath
from typing import Any, BinaryIO, Final

from typing_extensions import override

from stickslip.data.readers.table import Table, json_of, one_line, parsed_as
from stickslip.data.readers.topics import Log, Topic, table_of
from stickslip.errors import MOST_NUMBERS, InputError, check_size
from stickslip.show.display import require_library
from stickslip.show.documents import open_regular, private_folder
from stickslip.show.formatting import joined, number

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
LARGEST_JSON: Final = 2**24
"""Bytes of a message in JSON at most: as objects they take some twenty times as many."""


def read_mcap(path: Path, names: Collection[str] = ()) -> Table:
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
    if len(data) > LARGEST_JSON:
        raise ValueError(f"it has {len(data)} bytes of JSON, more than {LARGEST_JSON}")
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
LARGEST_METADATA: Final = 2_000_000
"""Bytes of it that are read at most: a file of messages takes some hundred."""


def read_bag(path: Path, names: Collection[str] = ()) -> Table:
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
