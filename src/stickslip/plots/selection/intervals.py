"""Named values with their doubt, one below the other: scores of laws, residuals of trials."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from stickslip.formatting import scale_of
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, INK, MUTED

INTERVAL_SIZE: Final = (880, 300)


class Interval(NamedTuple):
    """A value and its standard error, NaN where it is not known."""

    name: str
    """Name of the row."""
    value: float
    """The value, in the unit of the axis."""
    error: float = np.nan
    """Its standard error, in the same unit."""
    chosen: bool = False
    """Whether the row stands out."""


def draw_intervals(rows: Sequence[Interval], label: str, unit: str) -> Draw:
    """Return a drawing of values as dots, with bars of one standard error, the first on top."""
    values = np.array([row.value for row in rows])
    errors = np.array([row.error for row in rows])
    factor, shown = (
        (100.0, "%") if unit == "1" else scale_of(np.abs(values) + np.nan_to_num(errors), unit)
    )

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_subplot()
        for place, (row, error) in enumerate(zip(rows, errors, strict=True)):
            bar = [factor * error] if np.isfinite(error) else None
            axes.errorbar(
                [factor * row.value], [place], xerr=bar, fmt="o", markersize=5, elinewidth=1.5,
                color=C1 if row.chosen else INK,
            )  # fmt: skip
        axes.set_yticks(range(len(rows)), [row.name for row in rows])
        axes.set_ylim(len(rows) - 0.5, -0.5)
        if np.any(values < 0.0):
            axes.axvline(0.0, color=MUTED, linewidth=0.8, zorder=0)
        else:
            axes.set_xlim(left=0.0)
        axes.grid(axis="x")
        axes.set_xlabel(f"{label}, {shown}" if shown else label)

    return draw
