"""How late a force sensor shows friction, by the profile of what that leaves."""

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from stickslip.identification.residuals.balance import Balance
from stickslip.identification.residuals.effects import Signals, shown_by
from stickslip.identification.residuals.gains import BLOCKS
from stickslip.identification.sensor_response import SensorResponse

Array = NDArray[np.float64]

RESPONSES = ("delay", "lag")
"""What a force sensor may do: show friction later, or through a filter of first order."""
SHORTEST = 0.25
"""Shortest time that is looked at, over the sampling interval."""
LONGEST = 0.5
"""Longest one, over the median time between reversals."""
POINTS = 16
"""Times that are looked at between these, and then between the neighbours of the best one."""
PASSES = 3
"""How often: the last points are 1 % apart or less."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Profile:
    """A time by which friction is shown late, and what this predicts in blocks left out."""

    value: float
    """Time [s] by which the motion is shown later than the force; below 0 if earlier."""
    left_out: Array
    """The same with each block left out (blocks,)."""
    gains: Array
    """Squares that the time found without it takes off each block (blocks,)."""


def response_of(kind: str, value: float) -> SensorResponse:
    """Return the response of a sensor that leaves the motion later than the force."""
    return SensorResponse(lag=-value) if kind == "lag" else SensorResponse(delay=-value)


def profile_of(b: Balance, basis: Array, residual: Array, kind: str) -> Profile | None:
    """Return the time by which a sensor shows friction late; None if nothing speaks for one."""
    times = _times(b.signals)
    signs = (-1.0,) if kind == "lag" else (-1.0, 1.0)
    best: Profile | None = None
    for sign in signs if len(times) else ():
        found = _refined(b, basis, residual, kind, sign * times)
        if best is None or found.gains.sum() > best.gains.sum():
            best = found
    return best if best is not None and best.gains.sum() > 0.0 else None


def _times(s: Signals) -> Array:
    """Return times (k,) that are looked at; none where the motion reverses less than twice."""
    turns = s.time[1:][(np.diff(np.sign(s.velocity)) != 0) & (np.diff(s.time) > 0.0)]
    step = float(np.median(np.diff(s.time)))
    apart = np.diff(turns)
    apart = apart[apart > 2.0 * step]
    if not len(apart):
        return np.zeros(0)
    longest = LONGEST * float(np.median(apart))
    return np.geomspace(SHORTEST * step, max(longest, step), POINTS)


def _refined(b: Balance, basis: Array, residual: Array, kind: str, times: Array) -> Profile:
    """Return the best of some times (k,), looked for ever closer."""
    starts = np.linspace(0, len(residual), BLOCKS + 1).astype(int)[:-1]
    before = np.add.reduceat(residual**2, starts)
    for number in range(PASSES):
        effects = [shown_by(response_of(kind, one)) for one in times.tolist()]
        columns = np.concatenate(b.seen(effects), axis=1) * times
        white = b.white(columns)
        rest = residual[:, None] - (white - basis @ (basis.T @ white))
        squares = np.add.reduceat(rest**2, starts, axis=0)
        if number < PASSES - 1:
            at = int(np.argmin(squares.sum(axis=0)))
            near = times[[max(at - 1, 0), min(at + 1, len(times) - 1)]]
            times = np.linspace(near[0], near[1], POINTS)
    total = squares.sum(axis=0)
    left = np.argmin(total - squares, axis=1)
    return Profile(
        value=float(_lowest(times, total[None])[0]),
        left_out=_lowest(times, total - squares),
        gains=before - squares[np.arange(BLOCKS), left],
    )


def _lowest(times: Array, squares: Array) -> Array:
    """Return where rows (b, k) are least, between times (k,) by parabolas."""
    at = np.clip(np.argmin(squares, axis=1), 1, len(times) - 2)
    rows = np.arange(len(squares))
    low, middle, high = (squares[rows, at + k] for k in (-1, 0, 1))
    bend = low - 2.0 * middle + high
    shift = np.where(bend > 0.0, 0.5 * (low - high) / np.where(bend > 0.0, bend, 1.0), 0.0)
    return np.asarray(times[at] + np.clip(shift, -1.0, 1.0) * (times[1] - times[0]))
