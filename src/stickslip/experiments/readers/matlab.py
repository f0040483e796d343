"""Vectors of MATLAB files as columns of a table."""

import io
from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from stickslip.errors import InputError, check_size
from stickslip.experiments.readers.mat5_validator import CURE, check_structure, is_level_5

__all__ = ["read_mat"]

MOST_LISTED: Final = 12
DEEPEST: Final = 5
_HDF5: Final = b"\x89HDF\r\n\x1a\n"


def read_mat(path: Path, names: Collection[str] = ()) -> pd.DataFrame:
    """Return the vectors of one length as columns; fields of structs as ``struct.field``.

    Parameters
    ----------
    path : Path
        A MATLAB file, version 5 to 7.3.
    names : collection of str
        Names that columns should have: where there are vectors of several lengths, those of the
        length with most of these names are taken, else of the length that is most common.

    Returns
    -------
    DataFrame
        Whatever else the file has is left alone.

    Raises
    ------
    InputError
        If it is no MATLAB file or has no vector; the message lists what it has.
    """
    found = dict(_variables(path))
    vectors = {name: value for name, value in found.items() if _is_vector(value)}
    if not vectors:
        listed = [f"{name} {_shape(value)}" for name, value in found.items()]
        more = "" if len(listed) <= MOST_LISTED else f" and {len(listed) - MOST_LISTED} more"
        raise InputError(
            f"{path}: contains no numeric vector; contents:"
            f" {', '.join(listed[:MOST_LISTED]) or 'nothing'}{more}. Save time and signals as"
            " vectors of equal length."
        )
    _check(path, sum(value.size for value in vectors.values()))
    sizes = Counter(value.size for value in vectors.values())
    named = Counter(value.size for name, value in vectors.items() if name in names)
    size = max(sizes, key=lambda size: (named[size], sizes[size], size))
    return pd.DataFrame(
        {
            name: np.asarray(value, dtype=float).ravel()
            for name, value in vectors.items()
            if value.size == size
        }
    )


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
    inner = (
        value.item()
        if isinstance(value, np.ndarray) and value.dtype == object and (value.size == 1)
        else value
    )
    fields = getattr(inner, "_fieldnames", None)
    if fields is None or not depth:
        yield name, value
        return
    for field in fields:
        yield from _unfolded(f"{name}.{field}", getattr(inner, field), depth - 1)


def _newer(path: Path) -> Iterator[tuple[str, Any]]:
    import h5py

    with h5py.File(path, "r") as file:
        found = dict(_group(file, "", DEEPEST, set()))
        vectors = {name: item for name, item in found.items() if _is_vector(item)}
        _check(path, sum(item.size for item in vectors.values()))
        for name, item in vectors.items():
            if item.is_virtual or item.external:
                raise InputError(
                    f"{path}: the values of {name} are in another file: copy them here."
                )
        yield from (found | {name: item[()].T for name, item in vectors.items()}).items()


def _group(group: Any, prefix: str, depth: int, seen: set[int]) -> Iterator[tuple[str, Any]]:
    """Yield the variables of a file, or the fields of a struct, of a version that is HDF5.

    A group may be a member of itself, by a hard or a soft link: each is entered once. Links to
    other files are not followed.
    """
    import h5py

    for key in group:
        name, link = f"{prefix}{key}", group.get(key, getlink=True)
        if key.startswith("#"):  # MATLAB keeps cells and tables there
            continue
        if isinstance(link, h5py.ExternalLink):
            yield name, f"link to {link.filename}"
            continue
        item = group.get(key)
        if isinstance(item, h5py.Group):
            place = h5py.h5o.get_info(item.id).addr
            if depth and place not in seen:
                seen.add(place)
                yield from _group(item, f"{name}.", depth - 1, seen)
            continue
        if not isinstance(item, h5py.Dataset):  # a type, or a link that leads nowhere
            continue
        kind = item.attrs.get("MATLAB_class", b"double")
        kind = kind.decode() if isinstance(kind, bytes) else str(kind)
        numeric = kind in {"double", "single"} or kind.startswith(("int", "uint"))
        if "MATLAB_empty" in item.attrs or not numeric or item.dtype.kind not in "iuf":
            yield name, f"{' × '.join(map(str, item.shape[::-1]))} {kind}"
        else:
            yield name, item if _is_vector(item) else np.broadcast_to(0.0, item.shape[::-1])
