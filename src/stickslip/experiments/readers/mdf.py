"""Channels of MDF files, as loggers of vehicles and test rigs write them."""

import re
import struct
import warnings
import zlib
from collections import Counter
from collections.abc import Collection
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from stickslip.errors import MOST_NUMBERS, InputError, check_size
from stickslip.experiments.readers.layout import unit_in
from stickslip.experiments.readers.table import FEWER_CHANNELS, Table, left_out, no_channel

MDF: Final = (".mf4", ".mdf")
"""Endings of MDF files."""
_COMPRESSED: Final = re.compile(b"##DZ")
_HEAD: Final = 48
"""Bytes of such a block before its data."""
_DEFLATED: Final = {0, 1}
"""Kinds of compression that are zlib's."""


def read_mdf(path: Path, names: Collection[str] = ()) -> Table:
    """Return the channels of one group as columns, with their units in brackets."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the package's own imports
            import asammdf
    except ImportError:
        raise InputError(
            f"{path}: MDF files need the package asammdf: pip install 'stickslip[mdf]', or export"
            " the file as CSV."
        ) from None
    try:
        _check_blocks(path)
        with warnings.catch_warnings(), asammdf.MDF(path) as file:
            warnings.simplefilter("ignore")
            numbers = sum(one.channel_group.cycles_nr * len(one.channels) for one in file.groups)
            check_size(str(path), numbers, FEWER_CHANNELS)
            signals = [one for one in file.iter_channels(skip_master=True) if _is_numeric(one)]
    except InputError:
        raise
    except Exception as error:
        # The package has whatever error its parser stumbles over.
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise InputError(f"{path}: is not an MDF file, or is damaged: {reason}.") from None
    if not signals:
        raise no_channel(path)
    sizes = Counter(one.group_index for one in signals)
    named = Counter(one.group_index for one in signals if one.name in names)
    length = {one.group_index: len(one.samples) for one in signals}
    group = max(sizes, key=lambda index: (named[index], sizes[index], length[index]))
    own = [one for one in signals if one.group_index == group]
    columns: dict[str, Any] = {"time [s]": own[0].timestamps}
    for one in own:
        unit = f" [{unit_in(one.unit)}]" if one.unit and one.unit.strip() else ""
        columns.setdefault(f"{one.name}{unit}", np.asarray(one.samples, dtype=float))
    others = [one.name for one in signals if one.group_index != group]
    return Table(data=pd.DataFrame(columns), remarks=(*left_out(others, "other times"),))


def _check_blocks(path: Path) -> None:
    """Refuse compressed blocks that grow beyond measure, or beyond what they say.

    See ASAM MDF 4.1, block ``##DZ``: its length, kind of compression and both sizes of its data.
    """
    data, expanded = path.read_bytes(), 0
    for found in _COMPRESSED.finditer(data):
        length, kind, original, size = struct.unpack_from("<Q8xxxBx4xQQ", data, found.start() + 8)
        if length != _HEAD + size:  # bytes that only look like such a block
            continue
        expanded += original
        check_size(
            str(path), expanded, FEWER_CHANNELS, unit="expanded bytes", most=8 * MOST_NUMBERS
        )
        if kind in _DEFLATED:
            stream = zlib.decompressobj()
            begin = found.start() + _HEAD
            if len(stream.decompress(data[begin : begin + size], original + 1)) > original:
                raise ValueError("a compressed block is larger than it says")


def _is_numeric(signal: Any) -> bool:
    values = signal.samples
    return bool(values.ndim == 1 and values.dtype.kind in "iuf" and values.size > 1)
