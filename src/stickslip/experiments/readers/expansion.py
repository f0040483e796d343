"""Compressed pieces of logs, expanded within bounds before a library expands them without any.

A frame of a few bytes may stand for gigabytes, and what a file says of its sizes need not be true.
So each compressed piece is read once through a decompressor that keeps nothing, and what comes out
is counted. Where an index of a file says where its pieces are, it has to name those that were read.

Sources: MCAP Format Specification; ROS Bag Format Version 2.0.
"""

import bz2
import io
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO, Final, final

from stickslip.documents import open_regular
from stickslip.errors import MOST_NUMBERS, check_size

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


@final
class Expansion:
    """What the compressed pieces of files become together."""

    def __init__(self, *paths: Path) -> None:
        self.file, self.total = str(paths[0]), 0
        self.most = max(8 * MOST_NUMBERS, RATIO * sum(one.stat().st_size for one in paths))

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
