"""Runs under feedback with a delay, by steps of the delay.

For gain (x(t - tau) - x(t)) the second part belongs to the equations (`DelayedFeedback.fed`), and
the first is a drive that is known a delay ahead:

1. The run goes on by stretches of the shortest delay. What a state was in a stretch becomes pieces
   of the drive one delay later; before time 0 it was what it is at 0.
2. Pieces are straight lines between places of equal distance, so many that the run is off them by
   `PAST` of its size at most in their middles. None crosses an event or a jump of another drive,
   nor what follows of it after one or two delays: there states jump, or their rates.
3. Steps and events of all stretches are one record, and so one trajectory with one certificate, of
   the equations with these pieces.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.formulation import Model
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.solver.backend import Playback, runner_of
from stickslip.engine.solver.run import FIRST_ROWS, Record
from stickslip.engine.solver.starts import Inputs, table_of
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.drives import BEGINNING, DelayedFeedback, parts_of, without_delays

Array = NDArray[np.float64]

PAST = 1e-6
"""Largest error of what a state was, over its size."""
TRIAL, MOST_LINES = 32, 200_000
"""Lines from whose bends the number of lines is taken, and most lines between two events."""
NEAR = 10
"""Times by which lines next to an event are halved."""
INSIDE = 1e-9
"""Share of the time between two events by which states are looked at behind and before them."""


def lines_of(playback: Playback, state: int, breaks: Sequence[float], error: float) -> Array:
    """Return starts, values and slopes (lines, 3) of straight lines along a state of a run.

    They are off it by an error at most; breaks are beginning, end, and events between them.
    """
    result = [np.empty((0, 3))]
    for a, b in itertools.pairwise(breaks):
        if not b - a > 4.0 * np.spacing(abs(b)):
            continue

        def at(shares: Array, a: float = a, b: float = b) -> Array:
            inner = np.clip(shares, INSIDE, 1.0 - INSIDE)
            return playback.played(a + inner * (b - a))[0][:, state]

        bend = np.abs(np.diff(at(np.linspace(0.0, 1.0, TRIAL + 1)), 2)).max() * TRIAL**2
        count = min(max(1, math.ceil(math.sqrt(bend / (8.0 * error)))), MOST_LINES)
        while True:
            shares = np.linspace(0.0, 1.0, 2 * count + 1)
            x = at(shares)
            off = np.abs(x[1::2] - 0.5 * (x[:-2:2] + x[2::2])).max()
            if off <= error or count >= MOST_LINES:
                break
            count *= 2
        # shorter and shorter ones towards events, where slopes count and not values alone
        near = 0.5 ** np.arange(1.0, NEAR + 1.0) / count
        nodes = np.unique(np.concatenate([shares[::2], near, 1.0 - near]))
        x = at(nodes)
        slopes = np.diff(x) / (np.diff(nodes) * (b - a))
        result.append(np.column_stack([a + nodes[:-1] * (b - a), x[:-1], slopes]))
    return np.concatenate(result)


@dataclass
class _Past:
    """What one state was, as lines of the drive that feeds it back."""

    column: int
    """Where the drive's numbers begin in a row of the table."""
    feedback: DelayedFeedback
    """Its gain and delay."""
    state: int
    """Number of the state."""
    size: float
    """Largest value of the state so far."""
    lines: list[Array] = field(default_factory=list)
    """Starts, values and slopes, a delay later."""

    def add(self, lines: Array) -> None:
        """Take lines along the state over."""
        gain, delay = self.feedback.gain, self.feedback.delay
        self.lines.append(lines * [1.0, gain, gain] + [delay, 0.0, 0.0])

    def known(self, since: float) -> Array:
        """Return lines from the one that holds at a time on."""
        at = max(len(self.lines) - 2, 0)
        while at > 0 and self.lines[at][0, 0] > since:
            at -= 1
        return np.concatenate(self.lines[at:])


def _held(lines: Array, at: Array) -> tuple[Array, Array]:
    """Return values and slopes at times (n,) of lines, the first of which holds before it, too."""
    index = np.maximum(np.searchsorted(lines[:, 0], at, side="right") - 1, 0)
    since = np.where(lines[index, 2] != 0.0, at - lines[index, 0], 0.0)
    return lines[index, 1] + lines[index, 2] * since, lines[index, 2]


def run_delayed(
    mechanism: Mechanism,
    model: Model,
    p: list[float],
    y0: Sequence[float],
    t_end: float,
    tolerance: float,
    compiled: bool,
    most: int,
) -> tuple[Inputs, Record]:
    """Run a mechanism with delayed feedback; return its numbers and what was recorded."""
    drives = mechanism.drives()
    own, time_scale = table_of([without_delays(drive) for drive in drives.values()], t_end)
    width = 1 + 3 * len(drives)
    own = own.reshape(-1, width)
    pasts = [
        _Past(1 + 3 * k, part, index, abs(float(y0[index])))
        for k, drive in enumerate(drives.values())
        for part in parts_of(drive)
        if isinstance(part, DelayedFeedback)
        for index in [model.states.index(part.state)]
    ]
    for past in pasts:
        start = np.array([[BEGINNING, float(y0[past.state]), 0.0]])
        past.add(start)
        past.lines[0][0, 0] = BEGINNING
    runner = runner_of(model, compiled=compiled)
    w, iw = runner.working(p), runner.iw()
    for i, value in enumerate(y0, runner.header[layout.Y]):
        w[i] = float(value)
    log = runner.zeros(FIRST_ROWS * runner.header[layout.ROW_COLUMNS])
    events = runner.zeros(2 * runner.header[layout.MOST_EVENTS] * layout.EVENT_COLUMNS)
    rows, table, t = list[Array](), np.empty(0), 0.0
    delays = [past.feedback.delay for past in pasts]
    stretch, seen, sharp = min(delays), 0, np.append(own[1:, 0], 0.0)
    while True:
        until = min(t + stretch, t_end)
        until = t_end if t_end - until <= 4.0 * np.spacing(t_end) else until
        lines = [past.known(t) for past in pasts]
        starts = np.unique(np.concatenate([[t], own[:, 0], *(some[:, 0] for some in lines)]))
        starts = starts[(starts >= t) & (starts < until)]
        starts = starts[np.append(True, np.diff(starts) > 4.0 * np.spacing(starts[1:]))]
        new = np.empty((len(starts), width))
        new[:, 0] = starts
        for k in range(len(drives)):
            base = own[:, [0, 1 + 3 * k, 2 + 3 * k]]
            new[:, 1 + 3 * k], new[:, 2 + 3 * k] = _held(base, starts)
            new[:, 3 + 3 * k] = starts
        for past, some in zip(pasts, lines, strict=True):
            values, slopes = _held(some, starts)
            new[:, past.column] += values
            new[:, past.column + 1] += slopes
        if t == 0.0:
            new[0, 0] = BEGINNING
        rows.append(new)
        table = np.concatenate(rows).ravel()
        rows = [table.reshape(-1, width)]
        # what is not known yet may do anything, so no rest is for good
        bounds = runner.vector([math.inf] * (2 * len(drives) * len(rows[0])))
        log, events = runner.run(
            w, iw, runner.flat(table), bounds, until, tolerance, time_scale / 6.0,
            most, log, events,
        )  # fmt: skip
        reached = float(w[layout.TIME])
        if reached < until or until >= t_end:
            break
        inputs = Inputs(p, table, np.empty(0), time_scale)
        playback = Playback.from_log(model, runner, inputs, log, int(iw[layout.STEPS]))
        count = int(iw[layout.EVENTS])
        happened = np.asarray(events[: layout.EVENT_COLUMNS * count])[:: layout.EVENT_COLUMNS]
        sharp, seen = np.append(sharp, happened[seen:]), count
        late = [sharp + k * delay for delay in delays for k in range(3)]
        inner = np.unique(np.concatenate(late))
        breaks = np.array([t, *inner[(inner > t) & (inner < until)], until])
        for past in pasts:
            reach = playback.played(np.linspace(t, until, TRIAL))[0][:, past.state]
            past.size = max(past.size, float(np.abs(reach).max())) or 1.0
            past.add(lines_of(playback, past.state, breaks.tolist(), PAST * past.size))
        t = until
    inputs = Inputs(p, table, np.full(2 * len(drives) * len(rows[0]), math.inf), time_scale)
    return inputs, Record(runner, log, events, w, [int(x) for x in iw])
