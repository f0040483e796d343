"""Exports of motion capture by Motive: rigid bodies and markers in five rows of headers.

The first line holds settings of the take in pairs. Above the columns stand what each is of (Rigid
Body), its name, its number, and whether it is of the rotation or of the position; below these, the
axes. See the description of "Data Export: CSV" by OptiTrack.
"""

from typing import Final

import numpy as np
import pandas as pd

from stickslip.errors import InputError
from stickslip.experiments.readers.header_units import STYLES
from stickslip.experiments.readers.layout import cells_of, is_number, unit_in
from stickslip.experiments.readers.table import Table, numbered_twice, rows_of
from stickslip.experiments.readers.video_tracks import SEPARATOR
from stickslip.formatting import quantity
from stickslip.units import factor, is_unit, shown

MOTION_CAPTURE: Final = "bodies of motion capture"
_BEGIN: Final = "format version"
_TAKE: Final = "take name"
POSITION: Final = "Position"
ROWS_OF_HEAD: Final = 40
"""Lines in which the rows of headers are sought."""


def is_capture(text: str) -> bool:
    """Whether a text is an export of Motive.

    Examples
    --------
    >>> is_capture("Format Version,1.23,Take Name,Take 1,Capture Frame Rate,120"), is_capture("t,x")
    (True, False)
    """
    first = text[:2000].lstrip("\ufeff").partition("\n")[0].casefold()
    return first.startswith(_BEGIN) and _TAKE in first


def read_capture(text: str) -> Table:
    """Return the columns called ``body/Position/X``, those first along which a body moves most."""
    lines = text.lstrip("\ufeff").splitlines()
    settings = cells_of(lines[0], ",")
    stated = dict(zip(settings[::2], settings[1::2], strict=False))
    head = [cells_of(line, ",") for line in lines[:ROWS_OF_HEAD]]
    first = next((i for i, cells in enumerate(head) if cells and is_number(cells[0])), 0)
    above = [cells for cells in head[1:first] if any(cells)]
    if len(above) < 2:
        raise InputError(f"has no rows of {MOTION_CAPTURE} below its headers.")
    axes, kinds = above[-1], above[-2]
    names = next((row for row in above if row[1:2] == ["Name"]), [])
    width = max(len(row) for row in above)
    length = unit_in(stated.get("Length Units", ""))
    headers = []
    for place in range(width):
        name, kind, axis = (row[place] if place < len(row) else "" for row in (names, kinds, axes))
        parts = [part for part in (name, kind, axis) if part] if place > 1 else [axis]
        header = SEPARATOR.join(parts)
        match = STYLES[0].fullmatch(header) if place == 1 else None
        if match and is_unit(unit_in(match["unit"])):
            header = f"{match['name']} [{unit_in(match['unit'])}]"
        headers.append(f"{header} [{length}]" if kind == POSITION and is_unit(length) else header)
    rows = [line for line in lines[first:] if line.strip(", ")]
    data = rows_of(rows, ",", ".", width).set_axis(numbered_twice(headers), axis=1)
    data = data[[name for name in data.columns if name and data[name].notna().any()]]
    spans = {name: _span(data[name]) for name in data.columns if f"{SEPARATOR}{POSITION}" in name}
    order = sorted(spans, key=lambda name: spans[name], reverse=True)
    others = [name for name in data.columns if name not in spans]
    remarks = []
    if order and is_unit(length):
        scale = factor(length, "m")
        told = [
            f"{shown(n.partition(' [')[0])} {quantity(spans[n] * scale, 'm')}" for n in order[:3]
        ]
        remarks.append(f"Largest spans of positions: {', '.join(told)}.")
    return Table(
        data=data[[*others[:2], *order, *others[2:]]], first_row=first + 1, remarks=(*remarks,)
    )


def _span(column: "pd.Series[float]") -> float:
    numbers = pd.to_numeric(column, errors="coerce").to_numpy(dtype=float)
    return float(np.nanmax(numbers) - np.nanmin(numbers)) if np.isfinite(numbers).any() else 0.0
