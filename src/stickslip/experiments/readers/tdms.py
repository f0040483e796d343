"""Channels of TDMS files, which LabVIEW and its relatives write."""

import logging
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from stickslip.errors import InputError, check_size
from stickslip.experiments.measurement import Array
from stickslip.experiments.readers.layout import unit_in
from stickslip.experiments.readers.table import (
    FEWER_CHANNELS,
    TIME,
    TRIAL,
    Table,
    left_out,
    merged,
    no_channel,
    numbered_twice,
    read_of,
)
from stickslip.units import is_unit

TDMS: Final = (".tdms",)
"""Endings of TDMS files."""
CUT: Final = "The last segment of the file is incomplete: what was to follow is missing."
UNIT_PROPERTIES: Final = ("unit_string", "NI_UnitDescription", "Unit")
"""Properties of a channel that hold its unit; the first is LabVIEW's."""


def read_tdms(path: Path, names: Collection[str] = ()) -> Table:
    """Return the channels of one group as columns; groups with the same channels are trials.

    Times of channels that state none are those that their waveform states.
    """
    try:
        import nptdms
    except ImportError:
        raise InputError(
            f"{path}: TDMS files need the package npTDMS: pip install 'stickslip[tdms]', or export"
            " the file as text."
        ) from None
    try:
        with _quiet(), path.open("rb") as data, nptdms.TdmsFile.open(data) as file:
            groups = {group.name: group.channels() for group in file.groups()}
            values = sum(len(channel) for own in groups.values() for channel in own)
            check_size(str(path), float(values), FEWER_CHANNELS)
            table = _chosen(path, groups, names)
            cut = file.file_status.incomplete_final_segment
            return replace(table, lost=(CUT,) if cut else ())
    except InputError:
        raise
    except Exception as error:
        # The package has whatever error its parser stumbles over.
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise InputError(f"{path}: is not a TDMS file, or is damaged: {reason}.") from None


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep the package from printing that an end is missing, which a remark says."""
    level = logging.root.manager.disable
    logging.disable(logging.WARNING)  # each of its modules has a logger with a level of its own
    try:
        yield
    finally:
        logging.disable(level)


def _chosen(path: Path, groups: dict[str, Sequence[Any]], names: Collection[str]) -> Table:
    """Return the group that has the columns that are wanted, or the most channels."""
    full = {name: [one for one in own if _is_signal(one)] for name, own in groups.items()}
    full = {name: own for name, own in full.items() if own}
    if not full:
        raise no_channel(path)
    called = {name: [one.name for one in own] for name, own in full.items()}
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
        return Table(data=tables[0], remarks=(*remarks,))
    trials = [table.assign(**{TRIAL: name}) for table, name in zip(tables, alike, strict=True)]
    remarks.append(f"{len(alike)} groups have the same channels: each is a trial.")
    return Table(data=pd.concat(trials, ignore_index=True), remarks=(*remarks,))


def _table(channels: Sequence[Any]) -> tuple[pd.DataFrame, list[str]]:
    """Return channels as columns, by the times of their waveforms if all state them, and the rest.

    Without these they go together if they have as many values.
    """
    headers = numbered_twice([_header(one) for one in channels])
    timed = [float(one.properties.get("wf_increment") or 0.0) > 0.0 for one in channels]
    if all(timed):
        tables = [
            pd.DataFrame({header: one[:]}, index=pd.Index(_times(one), name=TIME))
            for header, one in zip(headers, channels, strict=True)
        ]
        return merged(tables)[0], []
    size = Counter(len(one) for one in channels).most_common(1)[0][0]
    kept = {h: _numbers(one) for h, one in zip(headers, channels, strict=True) if len(one) == size}
    lost = [h for h, one in zip(headers, channels, strict=True) if len(one) != size]
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
    unit = unit_in(str(next((one for one in stated if one), "")))
    return f"{channel.name} [{unit}]" if unit and is_unit(unit) else channel.name


def _is_signal(channel: Any) -> bool:
    return len(channel) > 1 and channel.dtype.kind in "iufM"
