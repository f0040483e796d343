"""Exports of tribometers: steps below each other, with a header each or a recipe above the table.

Programs of universal tribometers write ``Step No. 1``, some settings, a header and a row of units,
and the rows. Those of traction machines write ``Step 1 started at``, settings and a header, in
which names may come twice. Those of rotary modules write a recipe, then one table with a column
Step, and further lines below it. A step is a trial.
"""

import math
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd

from stickslip.errors import InputError
from stickslip.experiments.readers.column_words import parts_of
from stickslip.experiments.readers.layout import are_units, cells_of, is_number, unit_in
from stickslip.experiments.readers.table import TRIAL, Table, numbered_twice, rows_of
from stickslip.formatting import count, joined
from stickslip.units import factor, is_of, is_unit, shown

TRIBOMETER: Final = "steps of a tribometer"
LONGEST_HEAD: Final = 20_000
"""Characters at the top among which a step is sought."""
_STEP: Final = re.compile(
    r"""^[ \t"]*+step[ \t]*+(?:
        (?:no\.?|nr\.?|number|\#)[ \t]*+[:=]?[ \t]*+(?P<number>\d++)\b
        |(?P<started>\d++)[ \t]+started\b
        |[:=]?[ \t]*+(?P<alone>\d++)[ \t";,]*$)""",
    re.IGNORECASE | re.MULTILINE | re.VERBOSE,
)
_RECIPE: Final = re.compile(r"^\"?recipe\b[^\r\n]*[\r\n]", re.I)
_DIGITS: Final = re.compile(r"(?=[^\d\n]*+\d)[\s\d.,;+\-eE\"]++")
SEPARATORS: Final = "\t;,"
STEP: Final = "step"
RADIUS: Final = "radius"
FORCES: Final = {"g": "gf", "kg": "kgf", "mg": "mgf"}
"""Units of masses in which forces are given there, and what is meant."""
_FORCE: Final = re.compile(r"F[xyzntf]?|F_?[xyznt]|load|force", re.I)
FEWEST: Final = 2
"""Numbers in a row of a table, and rows in a step."""


@dataclass(frozen=True, kw_only=True)
class _Section:
    """Rows below one header."""

    label: str
    """Number of the step; empty if none stands above the header."""
    names: tuple[str, ...]
    """Empty if the lines above name not all columns."""
    units: tuple[str, ...]
    rows: Sequence[str]


def is_tribometer(text: str) -> bool:
    r"""Whether a text has steps of a tribometer.

    Examples
    --------
    >>> (
    ...     is_tribometer("Run # 1\nStep No. 1\n\nFx,Fz,T\ng,g,sec\n1,2,3\n"),
    ...     is_tribometer("step,x\n1,2\n"),
    ... )
    (True, False)
    """
    head = text[:LONGEST_HEAD].lstrip("\ufeff")
    recipe = _RECIPE.match(head) is not None and STEP in head.casefold()
    return recipe or _STEP.search(head) is not None


def read_tribometer(text: str) -> Table:
    r"""Return the rows of all steps, with the number of their step as the trial.

    Examples
    --------
    >>> table = read_tribometer(
    ...     "Step No. 1\nRadius = 4\nFx,T\ng,sec\n\n1,0\n2,1\n\n"
    ...     "Step No. 2\nRadius = 4\nFx,T\ng,sec\n\n3,0\n4,1\n"
    ... )
    >>> table.data.to_dict("list")
    {'Fx [gf]': [1, 2, 3, 4], 'T [sec]': [0, 1, 0, 1], 'trial': [1, 1, 2, 2]}
    """
    lines = text.lstrip("\ufeff").splitlines()
    separator = max(SEPARATORS, key=lambda mark: sum(line.count(mark) for line in lines[:500]))
    found = [*_sections(lines, separator)]
    sections = [one for one in found if one.names]
    if not sections:
        raise InputError(
            f"has no rows of {TRIBOMETER}: names of columns, perhaps a row of units, then numbers."
        )
    often = Counter(one.names for one in sections).most_common(1)[0][0]
    kept = [one for one in sections if one.names == often]
    decimal = "," if separator != "," and any("," in row for row in kept[0].rows) else "."
    units = [_units(one) for one in kept]
    alike = [_are_alike(own, units[0]) for own in units]
    tables = [
        _table(one, own, units[0], separator, decimal)
        for one, own, fits in zip(kept, units, alike, strict=True)
        if fits
    ]
    others = [one for one, fits in zip(kept, alike, strict=True) if not fits]
    kept = [one for one in kept if one not in others]
    lost = _without_rows(lines, sections)
    others = [one for one in sections if one.names != often or one in others]
    if others:
        labels = [one.label or str(sections.index(one) + 1) for one in others]
        lost.append(f"Steps with other columns, or units of another kind: {joined(labels)}.")
    remarks = []
    labels = [one.label or str(number) for number, one in enumerate(kept, 1)]
    if len(set(labels)) < len(labels):  # each run counts its steps anew
        labels = [str(number) for number in range(1, len(kept) + 1)]
    if len(tables) > 1:
        tables = [t.assign(**{TRIAL: int(n)}) for t, n in zip(tables, labels, strict=True)]
    data = _once(pd.concat(tables, ignore_index=True))
    data, own = _of_column(data)
    steps = own or (labels if len(tables) > 1 else [])
    if steps:
        remarks.append(f"Each of the {count(len(steps), 'step')} is a trial: {joined(steps)}.")
    data, told = _with_sliding_speed(data, lines, separator)
    data, said = _from_slip(data)
    if nameless := sum(len(one.rows) for one in found if not one.names):
        lost.append(f"{count(nameless, 'row')} below no names of columns: not read.")
    return Table(data=data, remarks=(*remarks, *told, *said), lost=tuple(lost))


def _is_row(cells: Sequence[str]) -> bool:
    """Whether all cells that hold anything are numbers, and several do."""
    full = [cell for cell in cells if cell]
    return len(full) >= FEWEST and all(map(is_number, full))


def _sections(lines: Sequence[str], separator: str) -> Iterator[_Section]:
    """Yield the tables: rows of numbers, and the header above them."""
    above: list[str] = []
    rows: list[str] = []
    for line in [*lines, "end"]:
        # of a long table, only the first row is looked at cell by cell
        if _DIGITS.fullmatch(line) and (rows or _is_row(cells_of(line, separator))):
            rows.append(line)
            continue
        if not line.strip(f"{separator} "):
            continue
        if len(rows) >= FEWEST:
            yield _section(above, rows, separator)
        above = [line] if rows else [*above, line]
        rows = []


def _section(above: Sequence[str], rows: Sequence[str], separator: str) -> _Section:
    """Return rows with what the lines above them say of them."""
    heads = [cells_of(line, separator) for line in above[-2:]]
    units = heads.pop() if len(heads) == 2 and are_units(heads[-1]) else []
    names = heads[-1] if heads else []
    width = max(place for place, cell in enumerate(cells_of(rows[0], separator), 1) if cell)
    if len(names) < width or sum(map(bool, names)) < FEWEST:
        names = []
    found = [match[match.lastgroup or 0] for line in above if (match := _STEP.match(line))]
    return _Section(
        label=found[-1] if found else "",
        names=tuple(name.removesuffix("()").strip() for name in names),
        units=tuple(units),
        rows=rows,
    )


def _without_rows(lines: Sequence[str], sections: Sequence[_Section]) -> list[str]:
    """Return what is said of steps below whose number there are no two rows."""
    found = [match for line in lines if (match := _STEP.match(line))]
    kinds = {
        one.lastgroup for one in found if one[one.lastgroup or 0] in {s.label for s in sections}
    }
    missed = Counter(one[one.lastgroup or 0] for one in found if one.lastgroup in kinds)
    missed -= Counter(one.label for one in sections)
    return [
        f"Step {label} has no table of {FEWEST} rows or more and is left out." for label in missed
    ]


def _units(section: _Section) -> list[str]:
    """Return the unit of each name; empty where there is none."""
    units = [unit_in(cell) for cell in section.units]
    units += [""] * (len(section.names) - len(units))
    found = [
        FORCES.get(unit, unit) if _FORCE.fullmatch(name) else unit
        for name, unit in zip(section.names, units, strict=False)
    ]
    return [unit if unit and is_unit(unit) else "" for unit in found]


def _are_alike(units: Sequence[str], first: Sequence[str]) -> bool:
    """Whether units are those of another step, or of their kinds."""
    pairs = zip(units, first, strict=True)
    return all(own == one or (bool(own and one) and is_of(own, one)) for own, one in pairs)


def _table(
    section: _Section, units: Sequence[str], first: Sequence[str], separator: str, decimal: str
) -> pd.DataFrame:
    """Return the rows of a section in the units of the first, columns without a name left out."""
    width = max(len(section.names), len(cells_of(section.rows[0], separator)))
    data = rows_of(section.rows, separator, decimal, width)
    named = [place for place, name in enumerate(section.names) if name]
    for place in named:
        if units[place] != first[place]:
            data[place] = data[place].astype(float) * factor(units[place], first[place])
    headers = [section.names[i] + (f" [{first[i]}]" if first[i] else "") for i in named]
    return data[named].set_axis(numbered_twice(headers), axis=1)


def _once(data: pd.DataFrame) -> pd.DataFrame:
    """Return a table without columns that repeat another one under the same name."""
    again = [
        name
        for name in data.columns
        if (match := re.fullmatch(r"(.*) \(\d+\)", name))
        and match[1] in data.columns
        and data[name].equals(data[match[1]])
    ]
    return data.drop(columns=again)


def _of_column(data: pd.DataFrame) -> tuple[pd.DataFrame, list[str]]:
    """Return a table whose column Step, if it has one, numbers the trials, and their numbers."""
    column = next((name for name in data.columns if name.casefold() == STEP), None)
    if column is None or TRIAL in data.columns or data[column].isna().any():
        return data, []
    steps = [str(step) for step in data[column].unique()]
    if len(steps) < 2:
        return data, []
    again = [n for n in data.columns if n != column and data[n].equals(data[column])]
    return data.drop(columns=again).rename(columns={column: TRIAL}), steps


def _with_sliding_speed(
    data: pd.DataFrame, lines: Sequence[str], separator: str
) -> tuple[pd.DataFrame, list[str]]:
    """Return a table with the speed at the radius of a recipe, where it has one of rotation."""
    heads = [[cell.casefold() for cell in cells_of(line, separator)] for line in lines[:2]]
    values = cells_of(lines[1], separator) if len(lines) > 1 else []
    place = heads[0].index(RADIUS) if RADIUS in heads[0] else len(values)
    speeds = [name for name in data.columns if re.search(r"[\[(]rpm[\])]", name, re.I)]
    if not speeds or place >= len(values) or not is_number(values[place]):
        return data, []
    radius = float(values[place])
    speed = pd.to_numeric(data[speeds[0]], errors="coerce") * (2.0 * math.pi / 60.0 * radius)
    return data.assign(**{"Sliding Speed [mm/s]": np.asarray(speed, dtype=float)}), [
        f"The sliding speed is {shown(speeds[0])} at the radius of the recipe, {radius:g} mm."
    ]


def _from_slip(data: pd.DataFrame) -> tuple[pd.DataFrame, list[str]]:
    """Return a table with the sliding speed, from a slide-roll ratio and the rolling speed."""
    headers = list(map(str, data.columns))
    names = {one: " ".join(parts_of(re.split(r"[\[(]", one)[0])) for one in headers}
    if any("sliding" in name or "slip" in name for name in names.values()):
        return data, []
    ratio = next((n for n, bare in names.items() if bare in ("srr", "slide roll ratio")), None)
    rolling = [n for n, bare in names.items() if bare in ("rolling speed", "entrainment speed")]
    if ratio is None or not rolling:
        return data, []
    bracket = re.search(r"[\[(]([^\[\]()]++)[\])]", rolling[0])
    unit = bracket[1] if bracket else ""
    share = 100.0 if "%" in ratio else 1.0
    speed = pd.to_numeric(data[ratio], errors="coerce") / share
    speed *= pd.to_numeric(data[rolling[0]], errors="coerce")
    name = f"Sliding Speed [{unit}]" if unit and is_unit(unit) else "Sliding Speed"
    return data.assign(**{name: np.asarray(speed, dtype=float)}), [
        f"The sliding speed is {shown(ratio)} times {shown(rolling[0])}: the ratio is taken for the"
        " difference of both surfaces' speeds over their mean."
    ]
