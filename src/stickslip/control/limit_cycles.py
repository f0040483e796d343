"""Limit cycles: whether a run repeats itself, how far it swings and how often."""

import itertools
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from stickslip.control.feedback_loop import ClosedLoop
from stickslip.described import Described
from stickslip.errors import InputError, UnknownNameError
from stickslip.formatting import number
from stickslip.quantities import Quantity
from stickslip.trajectory import Trajectory

Kind: TypeAlias = Literal["limit cycle", "growing", "decaying", "irregular", "none"]

SAMPLES = 20_000
"""Evenly spaced times at which a run is looked at, beside the ends of its steps."""
HYSTERESIS = 0.2
"""Share of the range that a crossing must pass on either side of the middle."""
FEWEST = 3
"""Cycles that tell whether they are alike."""
TOLERANCE = Quantity("eps", above=0, high=1)


@dataclass(frozen=True, kw_only=True)
class LimitCycle(metaclass=Described):
    """What a run does after its beginning.

    Numbers are those of the median cycle, and NaN where there are too few cycles.
    """

    kind: Kind
    """Whether cycles are alike, grow, decay, or differ without order; ``"none"`` if there are less
    than three."""
    amplitude: float
    """Half of the distance of the extremes, in the state's unit."""
    period: float
    """Time of a cycle [s]."""
    centre: float
    """Mean of the extremes."""
    amplitude_spread: float
    """Largest less smallest amplitude of a cycle, over the median."""
    period_spread: float
    """The same of periods."""
    cycles: int
    """Whole cycles seen."""
    stuck: float
    """Share of time in which friction or a stop holds the body."""

    @property
    def is_limit_cycle(self) -> bool:
        """Whether it is a limit cycle."""
        return self.kind == "limit cycle"


def limit_cycle(
    run: Trajectory | ClosedLoop,
    state: str = "x",
    *,
    since: float | None = None,
    tolerance: float = 0.02,
    least: float = 0.0,
) -> LimitCycle:
    """Look for a limit cycle in a run.

    A cycle is from one upward crossing of the middle to the next; a crossing counts if the state
    goes on by a tenth of its range on either side.

    Parameters
    ----------
    run : Trajectory or ClosedLoop
        The run; of several contacts, as one of them sees it (`Trajectory.contact`).
    state : str
        A column of the run.
    since : float, optional
        When to begin to look [s]; half-way if not given.
    tolerance : float
        Spread of amplitudes and periods, over their medians, up to which cycles are alike.
    least : float
        Amplitude below which a motion counts as none, in the state's unit.

    Returns
    -------
    LimitCycle
        Kind, amplitude, period.

    Raises
    ------
    InputError
        If `since` or `tolerance` is out of its range, or the run has several contacts.
    UnknownNameError
        If the run has no column of that name.

    Examples
    --------
    >>> from stickslip import Coulomb, TowedBlock, simulate
    >>> block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> cycle = limit_cycle(simulate(block, law, t_end=80.0), "v")
    >>> cycle.kind, round(cycle.period, 4), round(cycle.stuck, 3)
    ('limit cycle', 7.6113, 0.657)
    """
    import numpy as np

    run = run.run if isinstance(run, ClosedLoop) else run
    if run.contacts:
        raise InputError(
            f"limit_cycle: this run has several contacts ({', '.join(run.contacts)}): give it as"
            f" one of them sees it, such as run.contact({run.contacts[0]!r})."
        )
    tolerance = TOLERANCE.check("limit_cycle", "tolerance", tolerance)
    if state not in run.names:
        raise UnknownNameError("column", state, run.names)
    first, last = run.span
    begin = 0.5 * (first + last) if since is None else float(since)
    if not first <= begin < last:
        raise InputError(
            f"limit_cycle: since must lie between {number(first, 6)} and {number(last, 6)} s, got"
            f" {number(begin, 6)}."
        )
    times = np.union1d(np.linspace(begin, last, SAMPLES), run.t[(run.t >= begin) & (run.t <= last)])
    values = run.at(times)[state]
    starts = _crossings(times, values)
    if len(starts) <= FEWEST or 0.5 * float(np.ptp(values)) < least:
        return _described("none", np.empty((0, 3)), run, (begin, last))
    edges = np.searchsorted(times, starts)
    parts = [values[a:b] for a, b in itertools.pairwise(edges)]
    rows = [
        (0.5 * (part.max() - part.min()), period, 0.5 * (part.max() + part.min()))
        for part, period in zip(parts, np.diff(starts), strict=True)
    ]
    cycles = np.array(rows)
    return _described(_kind(cycles, tolerance), cycles, run, (starts[0], starts[-1]))


def _crossings(t: Any, x: Any) -> Any:
    """Return the times of upward crossings of the middle, small ones left out."""
    import numpy as np

    middle, reach = 0.5 * (x.max() + x.min()), 0.5 * HYSTERESIS * np.ptp(x)
    side = np.where(x > middle + reach, 1, np.where(x < middle - reach, -1, 0))
    told = np.flatnonzero(side)
    ups = [k for k in range(1, len(told)) if side[told[k]] > 0 > side[told[k - 1]]]
    found = []
    for k in ups:
        a, b = told[k - 1], told[k]
        i = a + int(np.flatnonzero(x[a + 1 : b + 1] > middle)[0])
        found.append(t[i] + (t[i + 1] - t[i]) * (middle - x[i]) / (x[i + 1] - x[i]))
    return np.array(found)


def _spread(values: Any) -> float:
    import numpy as np

    return float(np.ptp(values) / np.median(values))


def _kind(cycles: Any, tolerance: float) -> Kind:
    """Return what a series of cycles (n, 3) is."""
    import numpy as np

    amplitudes = cycles[:, 0]
    if max(_spread(amplitudes), _spread(cycles[:, 1])) <= tolerance:
        return "limit cycle"
    changes = np.diff(amplitudes)
    if _spread(amplitudes) > tolerance and (changes > 0.0).all():
        return "growing"
    if _spread(amplitudes) > tolerance and (changes < 0.0).all():
        return "decaying"
    return "irregular"


def _described(kind: Kind, cycles: Any, run: Trajectory, span: tuple[float, float]) -> LimitCycle:
    """Put the numbers of cycles (n, 3) together."""
    import numpy as np

    first, last = span
    held = [max(min(b, last) - max(a, first), 0.0) for a, b in run.stick_spans()]
    amplitude, period, centre = np.median(cycles, axis=0) if len(cycles) else (np.nan,) * 3
    return LimitCycle(
        kind=kind,
        amplitude=float(amplitude),
        period=float(period),
        centre=float(centre),
        amplitude_spread=_spread(cycles[:, 0]) if len(cycles) else np.nan,
        period_spread=_spread(cycles[:, 1]) if len(cycles) else np.nan,
        cycles=len(cycles),
        stuck=float(sum(held) / (last - first)),
    )
