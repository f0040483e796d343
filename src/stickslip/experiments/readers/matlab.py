"""Vectors of MATLAB files as columns of a table."""

import io
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from stickslip.errors import InputError, check_size
from stickslip.experiments.readers.column_words import is_barred, parts_of
from stickslip.experiments.readers.mat5_validator import CURE, check_structure, is_level_5
from stickslip.experiments.readers.table import Table, left_out

Found: TypeAlias = tuple[str, Any]
MOST_LISTED: Final = 12
FEWEST: Final = 10
"""Values from which a vector is no setting, so that it is said if it is not read."""
LEAST_SPLIT, MOST_SPLIT = 100, 64
"""Rows from which, and columns up to which, a matrix is one of signals."""
DEEPEST: Final = 5
MOST_ELEMENTS: Final = 1_000
"""Elements of an array of structs that are looked at."""
LONGEST_TEXT: Final = 1_000
MOST_IN_MATRIX: Final = 20_000_000
"""Numbers up to which a matrix is read."""
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


def read_mat(path: Path, names: Collection[str] = ()) -> Table:
    """Return the vectors of one length as columns; fields of structs as ``struct.field``."""
    found = dict(_apart(_variables(path)))
    vectors = {name: value for name, value in found.items() if _is_vector(value)}
    vectors = vectors or dict(_split(found))
    if not vectors:
        listed = [f"{name} {_shape(value)}" for name, value in found.items()]
        more = "" if len(listed) <= MOST_LISTED else f" and {len(listed) - MOST_LISTED} more"
        raise InputError(
            f"{path}: contains no numeric vector; contents:"
            f" {', '.join(listed[:MOST_LISTED]) or 'nothing'}{more}. Save time and signals as"
            " vectors of equal length."
        )
    _check(path, sum(value.size for value in vectors.values()))
    size = _size(vectors, names)
    columns = {
        name: np.asarray(value, dtype=float).ravel()
        for name, value in vectors.items()
        if value.size == size
    }
    others = [n for n, value in vectors.items() if value.size not in (size, *range(FEWEST))]
    return Table(data=pd.DataFrame(columns), remarks=(*left_out(others),))


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
    """Yield the rows or columns of matrices, whichever are longer, as ``name(1)``."""
    for name, value in found.items():
        if isinstance(value, np.ndarray) and _is_signals(value):
            longer = value if value.shape[0] > value.shape[1] else value.T
            yield from ((f"{name}({i + 1})", row) for i, row in enumerate(longer.T))


def _is_signals(value: Any) -> bool:
    """Whether an array, or a dataset that is not read yet, may hold one signal in each column."""
    if value.ndim != 2 or value.dtype.kind not in "iuf":
        return False
    return bool(max(value.shape) >= LEAST_SPLIT and min(value.shape) <= MOST_SPLIT)


def _is_vector(value: Any) -> bool:
    kind = getattr(value, "dtype", None)  # of an array, or of a dataset that is not read yet
    return kind is not None and kind.kind in "iuf" and 1 < value.size == max(value.shape)


def _check(path: Path, numbers: int) -> None:
    check_size(str(path), numbers, CURE)


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
    try:
        # Version 7.3 is HDF5, behind a block of MATLAB's own or not.
        if head.startswith(_HDF5) or head[512:] == _HDF5:
            yield from _newer(path)
        else:
            yield from _older(path)
    except InputError:
        raise
    except Exception as error:
        # Either library has whatever error its parser stumbles over.
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise InputError(f"{path}: is not a MATLAB file, or is damaged: {reason}.") from None


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
    return [{f: getattr(one, f) for f in getattr(one, "_fieldnames", ())} for one in cells]


def _fields(name: str, structs: Sequence[Mapping[str, Any]], depth: int) -> Iterator[Found]:
    """Yield the fields of a struct or a struct array; channels by their own names."""
    for i, one in enumerate(structs, 1):
        own = name if len(structs) == 1 else f"{name}({i})"
        kind = next((kind for kind in CHANNELS if {kind.data, *kind.names[:1]} <= {*one}), None)
        if kind is None:
            for field, value in one.items():
                yield from _unfolded(f"{own}.{field}", value, depth - 1)
        else:
            yield from _channel(own, one, kind)


def _channel(own: str, one: Mapping[str, Any], kind: "_Channel") -> Iterator[Found]:
    """Yield the signals of a channel: the columns of its data, with its name and unit."""
    names = (_text(one.get(field)) for field in kind.names)
    name, unit = next(filter(None, names), own), _text(one.get("Unit"))
    if kind.axis and re.fullmatch(rf"(?:.*\.)?{kind.axis}(?:\(\d+\))?", own):
        name, unit = "time", unit or "s"  # it has no name, and counts seconds
    unit = f" [{unit}]" if unit and "[" not in name else ""
    data = one[kind.data]
    if not isinstance(data, np.ndarray) or data.ndim != 2 or 1 in data.shape:
        yield f"{name}{unit}", data
        return
    for column in range(data.shape[1]):
        yield f"{name}({column + 1}){unit}", data[:, column]


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
        _check(path, sum(sizes))  # before any is read
        found = dict(_Hdf5(path).members(file, "", DEEPEST))
    for name, value in found.items():
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
            return _Elements(item) if item.size <= MOST_ELEMENTS else f"{item.size} struct"
        kind = item.attrs.get("MATLAB_class", b"double")
        kind = kind.decode() if isinstance(kind, bytes) else str(kind)
        shape = item.shape[::-1]
        filled = "MATLAB_empty" not in item.attrs and item.dtype.kind in "iuf"
        if kind == "char" and filled and item.size <= LONGEST_TEXT:
            return np.array(["".join(map(chr, np.ravel(item[()])))])
        if not filled or not (kind in {"double", "single"} or kind.startswith(("int", "uint"))):
            return f"{' × '.join(map(str, shape))} {kind}"
        if _is_vector(item) or (_is_signals(item) and item.size <= MOST_IN_MATRIX):
            return self.read(item, name)
        return f"{' × '.join(map(str, shape)) or '1'} {kind}"

    def structs(self, group: Any, name: str, depth: int) -> Any:
        """Return the elements of a struct; of several, each field refers to its values."""
        fields = dict(self.members(group, f"{name}.", depth))
        sizes = {getattr(value, "size", 0) for value in fields.values()}
        if not all(isinstance(value, _Elements) for value in fields.values()) or len(sizes) != 1:
            return [fields] if fields else None
        columns = {
            field: [self.value(one, f"{name}.{field}", depth) for one in value.items]
            for field, value in fields.items()
        }
        return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]

    def read(self, item: Any, name: str) -> NDArray[Any]:
        """Return an array as MATLAB shows it, unless it is too large or elsewhere."""
        self.numbers += item.size
        _check(self.path, self.numbers)
        if item.is_virtual or item.external:
            raise InputError(
                f"{self.path}: the values of {name} are in another file: copy them here."
            )
        found: NDArray[Any] = item[()].T
        return found


class _Elements:
    """A field of an array of structs: a reference to the value of each."""

    def __init__(self, item: Any) -> None:
        self.size = item.size
        self.items = [item.file[one] for one in np.ravel(item[()])]
