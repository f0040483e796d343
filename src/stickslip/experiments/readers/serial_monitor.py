"""What a serial monitor shows, with its time stamps: ``12:30:00.250 -> 1.5<TAB>0.8``."""

import re
from collections import Counter
from typing import Final

import pandas as pd

from stickslip.errors import InputError
from stickslip.experiments.readers.layout import cells_of, is_number
from stickslip.experiments.readers.table import TIME, Table, rows_of
from stickslip.experiments.readers.time_stamps import seconds_of
from stickslip.formatting import count

SERIAL: Final = "output of a serial monitor"
_LINE: Final = re.compile(r"(?P<stamp>\d{1,2}:\d\d:\d\d(?:[.,]\d+)?)\s*->\s?(?P<text>.*)")
_LABELLED: Final = re.compile(r"(?P<name>(?=[\s\d]*+[^\s:\d])[^:]*+):\s*+(?P<value>\S+)")
SEPARATORS: Final = ("\t", ";", ",", " ")


def is_serial(text: str) -> bool:
    r"""Whether a text is the output of a serial monitor.

    Examples
    --------
    >>> is_serial("12:30:00.250 -> 1.5\t0.8\n"), is_serial("12:30:00,1.5\n")
    (True, False)
    """
    first = text.lstrip("\ufeff \t\r\n")[:200].partition("\n")[0]
    return _LINE.fullmatch(first.rstrip()) is not None


def read_serial(text: str) -> Table:
    r"""Return the numbers behind the arrows, named as the lines name them, or by their places.

    Examples
    --------
    >>> table = read_serial("23:59:59.500 -> x\tF\n23:59:59.500 -> 1\t2\n00:00:00.000 -> 3\t4\n")
    >>> table.data.to_dict("list")
    {'time [s]': [0.0, 0.5], 'x': [1, 3], 'F': [2, 4]}
    """
    found = [match for line in text.lstrip("\ufeff").splitlines() if (match := _LINE.match(line))]
    texts = [match["text"].strip() for match in found]
    separator = next((mark for mark in SEPARATORS if sum(mark in one for one in texts) > 1), ";")
    cells = [cells_of(one, separator) for one in texts]
    labels = [[_LABELLED.fullmatch(cell) for cell in row] for row in cells]
    values = [
        [match["value"] if match else cell for match, cell in zip(own, row, strict=True)]
        for own, row in zip(labels, cells, strict=True)
    ]
    full = [bool(row) and all(map(is_number, row)) for row in values]
    widths = Counter(len(row) for row, there in zip(values, full, strict=True) if there)
    if not widths:
        raise InputError("has no rows of numbers behind the time stamps of its lines.")
    width = widths.most_common(1)[0][0]
    rows = [i for i, there in enumerate(full) if there and len(values[i]) == width]
    names = [match["name"].strip() if match else "" for match in labels[rows[0]]]
    heads = [cells[i] for i in range(rows[0]) if len(cells[i]) == width]
    if not all(names):
        names = heads[-1] if heads else [f"column {place}" for place in range(1, width + 1)]
    decimal = "," if separator != "," and any("," in texts[i] for i in rows) else "."
    data = rows_of([";".join(values[i]) for i in rows], ";", decimal, width).set_axis(names, axis=1)
    times = seconds_of(pd.Series([found[i]["stamp"] for i in rows]))
    if times is None:
        raise InputError("has time stamps before its lines that are no times of day.")
    data.insert(0, TIME, times - times[0])
    lost = len(found) - len(rows) - bool(heads)
    are = "is" if lost == 1 else "are"
    said = [f"{count(lost, 'line')} without {width} numbers {are} not read."] if lost else []
    return Table(data=data, lost=(*said,))
