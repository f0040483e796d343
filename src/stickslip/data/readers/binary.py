"""Binary files of tables: MATLAB, MDF, TDMS and Parquet.

The structure of MATLAB files of version 5 to 7 is checked before they are read: SciPy trusts the
sizes in such a file, and one whose bytes have shifted may take the whole process down. See
MathWorks, MAT-File Format, "Level 5 MAT-File Format".
"""

import io
import logging
import math
import re
import struct
import warnings
import zlib
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from stickslip.data.measurement import Array
from stickslip.data.readers.columns import is_barred, parts_of
from stickslip.data.readers.layout import headed, unit_in
from stickslip.data.readers.table import (
    FEWER_CHANNELS,
    TIME,
    TRIAL,
    FileTable,
    left_out,
    merged,
    no_channel,
    numbered_twice,
    parsed_as,
    read_of,
)
from stickslip.data.tolerances import (
    DEEPEST,
    FEWEST_SAMPLES,
    LARGEST_TEXT,
    MOST_CELLS,
    MOST_ENTRIES,
    MOST_LISTED,
    MOST_SIGNALS,
)
from stickslip.errors import MOST_NUMBERS, InputError, check_columns, check_size
from stickslip.show.display import require_library
from stickslip.show.formatting import joined

# The structure of MATLAB files of version 5 to 7, checked before they are read.
#
# SciPy trusts the sizes in such a file, and one whose bytes have shifted may take the whole process
# down. See MathWorks, MAT-File Format, "Level 5 MAT-File Format".

CURE: Final = "split the file, or save fewer variables"
HEADER: Final = 128
MATRIX: Final = 14
COMPRESSED: Final = 15
SIZES: Final = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8}
"""Bytes of a number by the type of its element."""
NAMES: Final = {1, 16}
"""Types of a name: plain bytes, or UTF-8 where other programs write it."""
TEXTS: Final = {1, 2, 4, 16, 17, 18}
"""Types of a text: bytes, 16-bit numbers, or UTF-8, -16 and -32."""
CELL, STRUCT, CHAR = 1, 2, 4
COMPLEX: Final = 0x800
NUMERIC: Final = range(6, 16)


class Element(NamedTuple):
    """One piece of a file."""

    kind: int
    """Number of its data type in the MAT-file format."""
    body: memoryview
    """Its bytes, without the tag."""


def is_level_5(data: bytes) -> bool:
    r"""Whether a file says that it is of version 5 to 7.

    Examples
    --------
    >>> is_level_5(b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"), is_level_5(b"")
    (True, False)
    """
    return data[124:HEADER] in {b"\x00\x01IM", b"\x01\x00MI"}


def check_structure(data: bytes, file: str = "data.mat") -> None:
    """Check that all sizes in a file fit each other, and that it does not grow without bound."""
    order = "<" if data[126:HEADER] == b"IM" else ">"
    numbers, expanded = 0, 0
    for element in _elements(memoryview(data)[HEADER:], order):
        body = element.body
        if element.kind == COMPRESSED:
            stream = zlib.decompressobj()
            head = stream.decompress(body, 8)
            size = struct.unpack(f"{order}II", head.ljust(8, b"\0"))[1]
            expanded += size
            # before anything is expanded
            check_size(file, expanded, CURE, unit="expanded bytes", most=8 * MOST_NUMBERS)
            body = memoryview(head + stream.decompress(stream.unconsumed_tail, size + 8))
            if stream.unconsumed_tail:
                raise ValueError("a compressed variable is larger than it says")
            inner = [*_elements(body, order)]
        else:
            inner = [element]
        numbers += sum(_check_variable(tag, order) for tag in inner)
        check_size(file, numbers, CURE)


def _elements(data: memoryview, order: str) -> Iterator[Element]:
    """Yield the pieces that follow each other."""
    place = 0
    while place < len(data):
        if place + 8 > len(data):
            raise ValueError("it ends within a tag")
        kind, size = struct.unpack_from(f"{order}II", data, place)
        if kind >> 16:  # a small one: its size and up to four bytes share the tag
            kind, size, start, after = kind & 0xFFFF, kind >> 16, place + 4, place + 8
            if size > 4:
                raise ValueError("a small element is too large")
        else:
            start = place + 8
            # All but compressed ones end on a multiple of eight.
            after = start + size + (0 if kind == COMPRESSED else -size % 8)
        if start + size > len(data):
            raise ValueError("it is truncated")
        yield Element(kind, data[start : start + size])
        place = after


def _check_variable(element: Element, order: str, depth: int = DEEPEST) -> int:
    """Check a variable and return how many numbers it has."""
    if element.kind != MATRIX or not depth:
        raise ValueError("an element is not a variable")
    if not len(element.body):
        return 0
    parts = list(_elements(element.body, order))
    if parts[0].kind != 6 or len(parts[0].body) != 8:
        raise ValueError("a variable has no flags")
    flags = struct.unpack(f"{order}II", parts[0].body)[0]
    kind = flags & 0xFF
    if kind > NUMERIC[-1]:  # objects of classes, which are left alone
        return 0
    if (
        len(parts) < 3
        or parts[1].kind not in {5, 6}
        or len(parts[1].body) % 4
        or len(parts[1].body) < 8
    ):
        raise ValueError("a variable has no shape")
    shape = struct.unpack(f"{order}{len(parts[1].body) // 4}i", parts[1].body)
    if min(shape) < 0 or parts[2].kind not in NAMES:
        raise ValueError("a variable has no name")
    return _check_content(flags, math.prod(shape), parts[3:], order, depth)


def _check_content(flags: int, size: int, parts: Sequence[Element], order: str, depth: int) -> int:
    """Check that a variable has as many values as its shape says; return how many numbers."""
    kind = flags & 0xFF
    if kind in NUMERIC:
        for part in parts:
            if SIZES.get(part.kind, 0) * size != len(part.body):
                raise ValueError("the size of a variable differs from its shape")
        if len(parts) != (2 if flags & COMPLEX else 1):  # real, and imaginary if the flag says so
            raise ValueError("a variable has no values")
        return size
    if kind == CHAR:
        if len(parts) != 1 or parts[0].kind not in TEXTS:
            raise ValueError("a text has no characters")
        # Other programs leave out blanks at the end of a text.
        if size > max(LARGEST_TEXT, sum(len(part.body) for part in parts)):
            raise ValueError("a text is shorter than its shape")
    elif kind in {CELL, STRUCT}:
        fields = 1
        if kind == STRUCT:
            fields, parts = _count_fields(parts, order), parts[2:]
        if len(parts) != fields * size:
            raise ValueError("the size of a struct or cell differs from its shape")
        return sum(_check_variable(part, order, depth - 1) for part in parts)
    return 0


def _count_fields(parts: Sequence[Element], order: str) -> int:
    """Return how many fields a struct has."""
    if len(parts) < 2 or parts[0].kind not in {5, 6} or len(parts[0].body) != 4:
        raise ValueError("a struct has no fields")
    width = int(struct.unpack(f"{order}i", parts[0].body)[0])
    if width <= 0 or len(parts[1].body) % width:
        raise ValueError("the field names are inconsistent")
    return len(parts[1].body) // width


# Vectors of MATLAB files as columns of a table.

Found: TypeAlias = tuple[str, Any]
LEAST_SPLIT: Final = 100
"""Rows from which a matrix is one of signals."""
_HDF5: Final = b"\x89HDF\r\n\x1a\n"


@dataclass(frozen=True, kw_only=True)
class _Channel:
    """A struct that is one channel of a recorder."""

    data: str
    names: tuple[str, ...]
    """Fields that hold its name, the first of which it must have."""
    axis: str = ""
    """Name of the struct of the times, which has none of its own."""


CHANNELS: Final = (
    _Channel(data="Data", names=("Name", "Path"), axis="X"),  # dSPACE ControlDesk
    _Channel(data="values", names=("label", "blockName")),  # Simulink, structure with time
)


def read_mat(path: Path, names: Collection[str] = ()) -> FileTable:
    """Return the vectors of one length as columns; fields of structs as ``struct.field``."""
    result = dict(_apart(_variables(path)))
    vectors = {name: value for name, value in result.items() if _is_vector(value)}
    signals = dict(_split(result))
    vectors = vectors or signals or dict(_cells(result))
    if not vectors:
        listed = [f"{name} {_shape(value)}" for name, value in result.items()]
        raise InputError(
            f"{path}: contains no numeric vector; contents:"
            f" {joined(listed, MOST_LISTED) or 'nothing'}. Save time and signals as vectors of"
            " equal length."
        )
    size = _size(vectors | {name: signals[name] for name in names if name in signals}, names)
    vectors |= signals
    check_size(str(path), sum(value.size for value in vectors.values()), CURE)
    columns = {
        name: np.asarray(value, dtype=float).ravel()
        for name, value in vectors.items()
        if value.size == size
    }
    others = [n for n, value in vectors.items() if value.size not in (size, *range(FEWEST_SAMPLES))]
    return FileTable(data=pd.DataFrame(columns), remarks=(*left_out(others),))


def _size(vectors: Mapping[str, Any], names: Collection[str]) -> int:
    """Return the length of the vectors to read: most of those named, then most kinds of signals.

    Each struct may have times of its own, and some may hold the errors of a controller or nothing.
    """
    named = Counter(value.size for name, value in vectors.items() if name in names)
    often = Counter(value.size for value in vectors.values())
    kinds: dict[int, set[str]] = {size: set() for size in often}
    for name, value in vectors.items():
        if not is_barred(parts_of(name), "position") and np.isfinite(value).any():
            kinds[value.size].add(name.rpartition(".")[2])
    return int(max(often, key=lambda size: (named[size], len(kinds[size]), often[size], size)))


def _split(found: Mapping[str, Any]) -> Iterator[Found]:
    """Yield the rows or columns of matrices, whichever are longer, as ``name 1``."""
    for name, value in found.items():
        if isinstance(value, np.ndarray) and _is_signals(value) and not _is_vector(value):
            yield from ((f"{name} {i}", row) for i, row in enumerate(_signals(value), 1))


def _cells(found: Mapping[str, Any]) -> Iterator[Found]:
    """Yield the columns of the matrices in cells, below each other, each cell a trial."""
    for name, value in found.items():
        cells = value.ravel() if isinstance(value, np.ndarray) and value.dtype == object else ()
        arrays = (cell for cell in cells if isinstance(cell, np.ndarray))
        tables = [_signals(cell) for cell in arrays if _is_signals(cell)]
        if len({len(table) for table in tables}) == 1:
            if len(tables) > 1:
                sizes = [table.shape[1] for table in tables]
                yield TRIAL, np.repeat(np.arange(len(tables)) + 1, sizes)
            columns = np.concatenate(tables, axis=1)
            yield from ((f"{name} {i}", column) for i, column in enumerate(columns, 1))
            return


def _signals(value: NDArray[Any]) -> NDArray[Any]:
    """Return rows or columns of a matrix, whichever are longer, as rows."""
    return value.T if value.shape[0] > value.shape[1] else value


def _is_signals(value: Any) -> bool:
    """Whether an array, or a dataset that is not read yet, may hold one signal in each column."""
    if value.ndim != 2 or value.dtype.kind not in "iuf":
        return False
    return bool(max(value.shape) >= LEAST_SPLIT and min(value.shape) <= MOST_SIGNALS)


def _is_vector(value: Any) -> bool:
    kind = getattr(value, "dtype", None)  # of an array, or of a dataset that is not read yet
    return kind is not None and kind.kind in "iuf" and 1 < value.size == max(value.shape)


def _shape(value: Any) -> str:
    if not isinstance(value, np.ndarray):
        return f"({value})"
    kinds = {"U": "text", "S": "text", "O": "cell", "b": "logical", "V": "struct", "c": "complex"}
    kind = kinds.get(value.dtype.kind, str(value.dtype))
    return f"({' × '.join(map(str, value.shape)) or '1'} {kind})"


def _variables(path: Path) -> Iterator[tuple[str, Any]]:
    """Yield names and values of a file of either kind."""
    try:
        with path.open("rb") as file:
            head = file.read(520)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}.") from None
    with parsed_as(path, "a MATLAB file"):
        # Version 7.3 is HDF5, behind a block of MATLAB's own or not.
        if head.startswith(_HDF5) or head[512:] == _HDF5:
            yield from _newer(path)
        else:
            yield from _older(path)


def _older(path: Path) -> Iterator[tuple[str, Any]]:
    from scipy.io import loadmat

    data = path.read_bytes()
    if is_level_5(data):
        check_structure(data, str(path))
    content = loadmat(io.BytesIO(data), struct_as_record=False, squeeze_me=False)
    for name, value in content.items():
        if not name.startswith("__"):
            yield from _unfolded(name, value, DEEPEST)


def _unfolded(name: str, value: Any, depth: int) -> Iterator[tuple[str, Any]]:
    """Yield a value, or the fields of a struct."""
    structs = value if isinstance(value, list) else _structs(value)
    if not depth or not all(structs):
        yield name, value
        return
    yield from _fields(name, structs, depth)


def _structs(value: Any) -> list[dict[str, Any]]:
    """Return the elements of a struct of an older file; empty ones of whatever else."""
    cells = value.ravel() if isinstance(value, np.ndarray) and value.dtype == object else [value]
    return [{f: getattr(cell, f) for f in getattr(cell, "_fieldnames", ())} for cell in cells]


def _fields(name: str, structs: Sequence[Mapping[str, Any]], depth: int) -> Iterator[Found]:
    """Yield the fields of a struct or a struct array; channels by their own names."""
    for i, table in enumerate(structs, 1):
        own = name if len(structs) == 1 else f"{name}({i})"
        kind = next((kind for kind in CHANNELS if {kind.data, *kind.names[:1]} <= {*table}), None)
        if kind is None:
            for field, value in table.items():
                yield from _unfolded(f"{own}.{field}", value, depth - 1)
        else:
            yield from _channel(own, table, kind)


def _channel(own: str, table: Mapping[str, Any], kind: "_Channel") -> Iterator[Found]:
    """Yield the signals of a channel: the columns of its data, with its name and unit."""
    names = (_text(table.get(field)) for field in kind.names)
    name, unit = next(filter(None, names), own), _text(table.get("Unit"))
    if kind.axis and re.fullmatch(rf"(?:.*\.)?{kind.axis}(?:\(\d+\))?", own):
        name, unit = "time", unit or "s"  # it has no name, and counts seconds
    unit = f" [{unit}]" if unit and "[" not in name else ""
    data = table[kind.data]
    if not isinstance(data, np.ndarray) or data.ndim != 2 or 1 in data.shape:
        yield f"{name}{unit}", data
        return
    for column in range(data.shape[1]):
        yield f"{name} {column + 1}{unit}", data[:, column]


def _text(value: Any) -> str:
    """Return text of MATLAB; empty for whatever else."""
    text = value.item() if isinstance(value, np.ndarray) and value.size == 1 else ""
    return text.strip() if isinstance(text, str) else ""


def _apart(found: Iterable[Found]) -> Iterator[Found]:
    """Yield variables, paths cut to their last part where that is a name of its own."""
    pairs = list(found)
    short = [_last_part(name) for name, _ in pairs]
    often = Counter(short)
    seen: Counter[str] = Counter()
    for (name, value), cut in zip(pairs, short, strict=True):
        shown = cut if often[cut] == 1 else name
        seen[shown] += 1
        yield shown if seen[shown] == 1 else f"{shown}({seen[shown]})", value


def _last_part(name: str) -> str:
    """Return the last part of the path of a block, with the unit."""
    path, bracket, unit = name.partition(" [")
    parts = [part for part in re.split(r'"?/"?', path.strip('"')) if part]
    return f"{parts[-1]}{bracket}{unit}" if parts and "/" in path else name


def _newer(path: Path) -> Iterator[tuple[str, Any]]:
    import h5py

    sizes: list[int] = []

    def add(_: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and _is_vector(item):
            sizes.append(item.size)

    with h5py.File(path, "r") as file:
        file.visititems(add)
        check_size(str(path), sum(sizes), CURE)  # before any is read
        result = dict(_Hdf5(path).members(file, "", DEEPEST))
    for name, value in result.items():
        yield from _unfolded(name, value, DEEPEST)


class _Hdf5:
    """Variables of a version that is HDF5, as those of older ones; structs as lists of fields.

    A group may be a member of itself, by a hard or a soft link: each is entered once. Links to
    other files are not followed.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.entered: set[int] = set()
        self.numbers = 0

    def members(self, group: Any, prefix: str, depth: int) -> Iterator[Found]:
        """Yield the variables of a file, or the fields of a struct."""
        import h5py

        for key in group:
            if key.startswith("#"):  # MATLAB keeps cells, tables and structs of arrays there
                continue
            link = group.get(key, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                yield key, f"link to {link.filename}"
                continue
            value = self.value(group.get(key), f"{prefix}{key}", depth)
            if value is not None:
                yield key, value

    def value(self, item: Any, name: str, depth: int) -> Any:
        """Return a value: None of what is none, is empty, or has been entered."""
        import h5py

        if isinstance(item, h5py.Group):
            place = h5py.h5o.get_info(item.id).addr
            if not depth or place in self.entered:
                return None
            self.entered.add(place)
            return self.structs(item, name, depth - 1)
        if not isinstance(item, h5py.Dataset):  # a type, or a link that leads nowhere
            return None
        if "MATLAB_class" not in item.attrs and h5py.check_ref_dtype(item.dtype) is h5py.Reference:
            return _Elements(item) if item.size <= MOST_ENTRIES else f"{item.size} struct"
        kind = item.attrs.get("MATLAB_class", b"double")
        kind = kind.decode() if isinstance(kind, bytes) else str(kind)
        shape = item.shape[::-1]
        if kind == "cell" and depth and item.size <= MOST_ENTRIES:
            cells = np.empty(item.size, dtype=object)
            for i, cell in enumerate(_Elements(item).items):
                cells[i] = self.value(cell, f"{name}{{{i + 1}}}", depth - 1)
            return cells
        filled = "MATLAB_empty" not in item.attrs and item.dtype.kind in "iuf"
        if kind == "char" and filled and item.size <= MOST_ENTRIES:
            return np.array(["".join(map(chr, np.ravel(item[()])))])
        if not filled or not (kind in {"double", "single"} or kind.startswith(("int", "uint"))):
            return f"{' × '.join(map(str, shape))} {kind}"
        if _is_vector(item) or (_is_signals(item) and item.size <= MOST_CELLS):
            return self.read(item, name)
        return f"{' × '.join(map(str, shape)) or '1'} {kind}"

    def structs(self, group: Any, name: str, depth: int) -> Any:
        """Return the elements of a struct; of several, each field refers to its values."""
        fields = dict(self.members(group, f"{name}.", depth))
        sizes = {getattr(value, "size", 0) for value in fields.values()}
        if not all(isinstance(value, _Elements) for value in fields.values()) or len(sizes) != 1:
            return [fields] if fields else None
        columns = {
            field: [self.value(item, f"{name}.{field}", depth) for item in value.items]
            for field, value in fields.items()
        }
        return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]

    def read(self, item: Any, name: str) -> NDArray[Any]:
        """Return an array as MATLAB shows it, unless it is too large or elsewhere."""
        self.numbers += item.size
        check_size(str(self.path), self.numbers, CURE)
        if item.is_virtual or item.external:
            raise InputError(
                f"{self.path}: the values of {name} are in another file: copy them here."
            )
        result: NDArray[Any] = item[()].T
        return result


class _Elements:
    """A field of an array of structs: a reference to the value of each."""

    def __init__(self, item: Any) -> None:
        self.size = item.size
        self.items = [item.file[value] for value in np.ravel(item[()])]


# Channels of MDF files, as loggers of vehicles and test rigs write them.

MDF: Final = (".mf4", ".mdf")
"""Endings of MDF files."""
_COMPRESSED: Final = re.compile(b"##DZ")
_HEAD: Final = 48
"""Bytes of such a block before its data."""
_DEFLATED: Final = {0, 1}
"""Kinds of compression that are zlib's."""


def read_mdf(path: Path, names: Collection[str] = ()) -> FileTable:
    """Return the channels of one group as columns, with their units in brackets."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the package's own imports
        asammdf = require_library("asammdf", "mdf", f"export {path} as CSV")
    with parsed_as(path, "an MDF file"):
        _check_blocks(path)
        with warnings.catch_warnings(), asammdf.MDF(path) as file:
            warnings.simplefilter("ignore")
            numbers = sum(item.channel_group.cycles_nr * len(item.channels) for item in file.groups)
            check_size(str(path), numbers, FEWER_CHANNELS)
            signals = [item for item in file.iter_channels(skip_master=True) if _is_numeric(item)]
    if not signals:
        raise no_channel(path)
    sizes = Counter(signal.group_index for signal in signals)
    named = Counter(signal.group_index for signal in signals if signal.name in names)
    length = {signal.group_index: len(signal.samples) for signal in signals}
    group = max(sizes, key=lambda index: (named[index], sizes[index], length[index]))
    own = [signal for signal in signals if signal.group_index == group]
    columns: dict[str, Any] = {"time [s]": own[0].timestamps}
    for channel in own:
        unit = f" [{unit_in(channel.unit)}]" if channel.unit and channel.unit.strip() else ""
        columns.setdefault(f"{channel.name}{unit}", np.asarray(channel.samples, dtype=float))
    others = [signal.name for signal in signals if signal.group_index != group]
    return FileTable(data=pd.DataFrame(columns), remarks=(*left_out(others, "other times"),))


def _check_blocks(path: Path) -> None:
    """Refuse compressed blocks that grow beyond measure, or beyond what they say.

    See ASAM MDF 4.1, block ``##DZ``: its length, kind of compression and both sizes of its data.
    """
    data, expanded = path.read_bytes(), 0
    for match in _COMPRESSED.finditer(data):
        length, kind, original, size = struct.unpack_from("<Q8xxxBx4xQQ", data, match.start() + 8)
        if length != _HEAD + size:  # bytes that only look like such a block
            continue
        expanded += original
        check_size(
            str(path), expanded, FEWER_CHANNELS, unit="expanded bytes", most=8 * MOST_NUMBERS
        )
        if kind in _DEFLATED:
            stream = zlib.decompressobj()
            begin = match.start() + _HEAD
            if len(stream.decompress(data[begin : begin + size], original + 1)) > original:
                raise ValueError("a compressed block is larger than it says")


def _is_numeric(signal: Any) -> bool:
    values = signal.samples
    return bool(values.ndim == 1 and values.dtype.kind in "iuf" and values.size > 1)


# Channels of TDMS files, which LabVIEW and its relatives write.

TDMS: Final = (".tdms",)
"""Endings of TDMS files."""
CUT: Final = "The last segment of the file is incomplete: what was to follow is missing."
UNIT_PROPERTIES: Final = ("unit_string", "NI_UnitDescription", "Unit")
"""Properties of a channel that hold its unit; the first is LabVIEW's."""


def read_tdms(path: Path, names: Collection[str] = ()) -> FileTable:
    """Return the channels of one group as columns; groups with the same channels are trials.

    Times of channels that state none are those that their waveform states.
    """
    nptdms = require_library("nptdms", "tdms", f"export {path} as text")
    with (
        parsed_as(path, "a TDMS file"),
        _quiet(),
        path.open("rb") as data,
        nptdms.TdmsFile.open(data) as file,
    ):
        groups = {group.name: group.channels() for group in file.groups()}
        values = sum(len(channel) for own in groups.values() for channel in own)
        check_size(str(path), float(values), FEWER_CHANNELS)
        table = _chosen(path, groups, names)
        cut = file.file_status.incomplete_final_segment
        return replace(table, lost=(CUT,) if cut else ())


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep the package from printing that an end is missing, which a remark says."""
    level = logging.root.manager.disable
    logging.disable(logging.WARNING)  # each of its modules has a logger with a level of its own
    try:
        yield
    finally:
        logging.disable(level)


def _chosen(path: Path, groups: dict[str, Sequence[Any]], names: Collection[str]) -> FileTable:
    """Return the group that has the columns that are wanted, or the most channels."""
    full = {name: [item for item in own if _is_signal(item)] for name, own in groups.items()}
    full = {name: own for name, own in full.items() if own}
    if not full:
        raise no_channel(path)
    called = {name: [channel.name for channel in own] for name, own in full.items()}
    wanted = max(full, key=lambda name: (len({*called[name]} & {*names}), len(full[name])))
    alike = [name for name in full if called[name] == called[wanted]]
    tables, remarks = [], []
    for name in alike:
        data, lost = _table(full[name])
        tables.append(data)
        remarks += left_out(lost)
    if len(alike) < len(full):
        others = [name for name in full if name not in alike]
        remarks += read_of("group", wanted, others, ", with other channels")
    if len(tables) == 1:
        return FileTable(data=tables[0], remarks=(*remarks,))
    trials = [table.assign(**{TRIAL: name}) for table, name in zip(tables, alike, strict=True)]
    remarks.append(f"{len(alike)} groups have the same channels: each is a trial.")
    return FileTable(data=pd.concat(trials, ignore_index=True), remarks=(*remarks,))


def _table(channels: Sequence[Any]) -> tuple[pd.DataFrame, list[str]]:
    """Return channels as columns, by the times of their waveforms if all state them, and the rest.

    Without these they go together if they have as many values.
    """
    headers = numbered_twice([_header(channel) for channel in channels])
    timed = [float(channel.properties.get("wf_increment") or 0.0) > 0.0 for channel in channels]
    if all(timed):
        tables = [
            pd.DataFrame({header: channel[:]}, index=pd.Index(_times(channel), name=TIME))
            for header, channel in zip(headers, channels, strict=True)
        ]
        return merged(tables)[0], []
    size = Counter(len(channel) for channel in channels).most_common(1)[0][0]
    kept = {h: _numbers(x) for h, x in zip(headers, channels, strict=True) if len(x) == size}
    lost = [h for h, channel in zip(headers, channels, strict=True) if len(channel) != size]
    return pd.DataFrame(kept), lost


def _times(channel: Any) -> Array:
    """Return the times of a waveform [s]."""
    begin = float(channel.properties.get("wf_start_offset") or 0.0)
    step = float(channel.properties["wf_increment"])
    return begin + step * np.arange(len(channel), dtype=float)


def _numbers(channel: Any) -> Any:
    """Return the values of a channel; moments as seconds from the first."""
    values = channel[:]
    if values.dtype.kind != "M":
        return values
    return (values - values[0]) / np.timedelta64(1, "s")


def _header(channel: Any) -> str:
    """Return the name of a channel with its unit."""
    if channel.dtype.kind == "M":
        return f"{channel.name} [s]"
    stated = (channel.properties.get(name) for name in UNIT_PROPERTIES)
    return headed(channel.name, str(next((text for text in stated if text), "")))


def _is_signal(channel: Any) -> bool:
    return len(channel) > 1 and channel.dtype.kind in "iufM"


# Parquet files.

PARQUET: Final = (".parquet", ".pq")


def read_parquet(path: Path, _names: Collection[str] = ()) -> FileTable:
    """Return the columns of a file."""
    return FileTable(data=parquet_data(path))


def parquet_data(path: Path) -> pd.DataFrame:
    """Return the columns of a file, whatever they hold."""
    pq = require_library("pyarrow.parquet", "parquet", f"export {path} as CSV")
    try:
        with pq.ParquetFile(path) as file:
            check_parquet(str(path), file)
            # Texts stay references to the few that differ: each is written once and repeated.
            texts = [field.name for field in file.schema_arrow if _is_text(field.type)]
        data = pd.read_parquet(path, engine="pyarrow", read_dictionary=texts)
        repeated = [name for name in texts if isinstance(data.get(name), pd.Series)]
        data = data.astype(dict.fromkeys(repeated, object))
        return data.reset_index(drop=True)
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}.") from None
    except Exception as error:
        # pyarrow has an exception tree of its own.
        raise InputError(f"{path}: is not a Parquet file: {error}.") from None


def check_parquet(path: str, file: Any, names: Collection[str] = ()) -> float:
    """Refuse a file whose footer announces too much, in all columns or those of some names.

    A cell may hold lists of any length, and pages that repeat a number take no room in the file.
    Returns how many numbers it announces.
    """
    footer = file.metadata
    check_columns(path, footer.num_columns)
    size, rows = 0.0, 0
    for i in range(footer.num_row_groups):
        group = footer.row_group(i)
        rows += group.num_rows
        for k in range(group.num_columns):
            column = group.column(k)
            flat = file.schema.column(k).max_repetition_level == 0
            if flat and column.num_values != group.num_rows:
                raise _contradicted(path, group.num_rows, column.num_values)
            name = column.path_in_schema  # of lists, and names may have dots: name.list.element
            if not names or any(f"{name}.".startswith(f"{text}.") for text in names):
                size += max(column.num_values, column.total_uncompressed_size / 8)
    if rows != footer.num_rows:
        raise _contradicted(path, footer.num_rows, rows)
    width = len(names) or footer.num_columns
    size = max(size, float(footer.num_rows * width))
    check_size(path, size, "split the file")
    return size


def _contradicted(path: str, rows: int, values: int) -> InputError:
    return InputError(
        f"{path}: is damaged: its footer announces {rows:,} rows, and {values:,} in their place."
    )


def _is_text(kind: Any) -> bool:
    from pyarrow import types

    return bool(types.is_string(kind) or types.is_large_string(kind))
