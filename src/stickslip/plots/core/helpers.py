"""What the figures of runs share: sizes, dense samples, a fitting end of time, colours."""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Final, NamedTuple, TypeAlias, TypedDict

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError, UnknownNameError
from stickslip.formatting import unit_text
from stickslip.plots.core.svg import Size
from stickslip.plots.core.theme import C1, C2, C3, C4, INK, MUTED
from stickslip.trajectory import Trajectory

Array: TypeAlias = NDArray[np.float64]

RIVALS: Final = (C2, C3, C4, INK, MUTED)
DASHES: Final = ("-", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)))
SETTLED: Final = 0.01
"""Share of its largest excursion within which a body counts as having arrived."""
SAMPLES: Final = 700
MOST_STEPS: Final = 20_000
"""Steps of a run up to which jumps are looked for at each."""
JUMP: Final = 1e-3
"""Share of its largest size by which a force jumps, or more."""
LINE_POINTS: Final = 1200
"""Points of a line: more cannot be seen in a figure of 880 px."""


def labelled(name: str, unit: str) -> str:
    """Return the label of an axis: what it shows in words, with its unit if it has one.

    Examples
    --------
    >>> labelled("friction.stribeck_velocity", "m/s"), labelled("v", "m/s"), labelled("share", "1")
    ('stribeck velocity, m/s', 'v, m/s', 'share')
    """
    word, shown = name.rpartition(".")[2].replace("_", " "), unit_text(unit)
    return f"{word}, {shown}" if shown else word


class Sizes(TypedDict):
    """The two sizes of a figure, as `stickslip.plots.inline_svg` takes them."""

    wide: Size
    narrow: Size


class LineStyle(NamedTuple):
    """How one series is drawn."""

    colour: str
    """Colour of the line."""
    dashes: str | tuple[int, tuple[float, ...]]
    """Dash pattern, as matplotlib takes it."""
    width: float
    """Line width [CSS px]."""
    order: int
    """Drawing order; the largest is on top."""


def looks(names: Iterable[str], chosen: str | None = None) -> dict[str, LineStyle]:
    """Return how each series is drawn: the chosen one blue and broad, the others thin upon it.

    So curves that coincide are both seen.

    Examples
    --------
    >>> looks(["Dahl", "Coulomb"], "Coulomb")["Coulomb"].width
    3.0
    """
    names = list(names)
    chosen = names[0] if chosen is None and names else chosen
    found = {}
    rivals = [name for name in names if name != chosen]
    for index, name in enumerate(rivals):
        lap, place = divmod(index, len(RIVALS))
        found[name] = LineStyle(RIVALS[place], DASHES[lap % len(DASHES)], 1.4, 3)
    return {name: found.get(name, LineStyle(C1, "-", 3.0, 2)) for name in names}


def dense(run: Trajectory, until: float | None = None, samples: int = SAMPLES) -> Trajectory:
    """Return a run at times close enough for a smooth curve, its events among them."""
    first, last = run.span
    last = last if until is None else min(until, last)
    events = [event.t for event in run.events if event.t <= last]
    # Also just before an event: friction jumps there, and the jump must be upright.
    before = [max(math.nextafter(t, -math.inf), first) for t in events]
    steps = _jumps(run, first, last)
    times = np.union1d(np.linspace(first, last, samples), [*before, *events, *steps])
    return run.at(times)


def _jumps(run: Trajectory, first: float, last: float) -> Array:
    """Return the solver's times at which a contact force jumps, and those just before.

    So it does where a drive or a swing steps, without an event.
    """
    after = run.t[(run.t > first) & (run.t <= last)]
    if not after.size or after.size > MOST_STEPS:
        return np.empty(0)
    before = np.nextafter(after, -np.inf)
    now, then = run.at(after), run.at(before)
    apart = np.zeros(after.size, dtype=np.bool_)
    for force in ("friction", "normal_force"):
        if force in run.names:
            size = max(float(np.abs(now[force]).max()), 1e-300)
            apart |= np.abs(now[force] - then[force]) > JUMP * size
    return np.concatenate([before[apart], after[apart]])


def horizon(run: Trajectory, slip: str = "x") -> float:
    """Return the time [s] up to which a figure shows a run: until it has arrived, and some more."""
    first, last = run.span
    seen = run.at(np.union1d(np.linspace(first, last, 4000), run.t[run.t <= last]))
    x = seen[slip]
    far = np.abs(x - x[-1]) > SETTLED * max(float(np.ptp(x)), 1e-300)
    if not far.any():
        return last
    arrived = float(seen.t[np.flatnonzero(far)[-1]]) - first
    stops = [e.t for e in run.events if abs(e.to_mode) != 1 and e.t >= first + arrived]
    # The stop is shown, unless it is the end of a decay that one cannot see.
    arrived = max([arrived, *[stop - first for stop in stops[:1] if stop < 1.5 * arrived]])
    return min(first + 1.3 * arrived, last)


def thinned(t: Array, y: Array, most: int = LINE_POINTS) -> tuple[Array, Array]:
    """Return a line with fewer points: the least and the largest of each stretch of it.

    Examples
    --------
    >>> t = np.arange(10_000.0)
    >>> len(thinned(t, np.sin(t))[0]) <= 1200
    True
    """
    if len(t) <= most:
        return t, y
    kept = []
    edges = np.linspace(0, len(t), most // 2 + 1).astype(int)
    for first, last in itertools.pairwise(edges.tolist()):
        kept += sorted(
            {first + int(np.argmin(y[first:last])), first + int(np.argmax(y[first:last]))}
        )
    return t[kept], y[kept]


def coordinate_name(run: Trajectory, name: str | None = None) -> str:
    """Return the column that a plot shows: the one given, ``"x"``, or the first of the run."""
    if name is not None and name not in run.names:
        raise UnknownNameError("column", name, run.names)
    known = run.states or run.names
    return name or ("x" if "x" in known else known[0])


def motion_names(run: Trajectory, slip: str | None, rate: str | None) -> tuple[str, str]:
    """Return the names of the coordinate and the rate that a plot shows, those given or the first.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=1.0, y0={"theta": 0.5})
    >>> motion_names(run, None, None)
    ('theta', 'omega')
    """
    slip = coordinate_name(run, slip)
    if rate is not None:
        return slip, coordinate_name(run, rate)
    unit = f"{run.units.get(slip, 'm')}/s"
    rates = [name for name in run.states or run.names if run.units.get(name) == unit]
    if not rates:
        raise InputError(f"no column of the run is the rate of {slip!r}: give its name as rate.")
    return slip, "v" if "v" in rates else rates[0]


def grouped(
    values: Mapping[str, float | Array], apart: float
) -> list[tuple[float, tuple[str, ...]]]:
    """Return the names of series that are nowhere `apart`, with the end of the first of them.

    Examples
    --------
    >>> grouped({"Coulomb": 0.450, "viscous": 0.300, "Dahl": 0.451}, 0.01)
    [(0.45, ('Coulomb', 'Dahl')), (0.3, ('viscous',))]
    """
    groups: list[tuple[Array, list[str]]] = []
    for name, value in values.items():
        series = np.atleast_1d(value)
        gaps = [float(np.max(np.abs(first - series))) for first, _ in groups]
        if gaps and min(gaps) < apart:
            groups[int(np.argmin(gaps))][1].append(name)
        else:
            groups.append((series, [name]))
    ends = [(float(series[-1]), tuple(names)) for series, names in groups]
    return sorted(ends, key=lambda group: -group[0])


def wrapped(names: Sequence[str], width: int) -> list[str]:
    """Return names joined by commas, in lines of at most `width` characters where they allow it.

    Examples
    --------
    >>> wrapped(["Coulomb", "Dahl", "LuGre"], 14)
    ['Coulomb, Dahl,', 'LuGre']
    """
    lines: list[str] = []
    for index, name in enumerate(names):
        part = name + ("," if index < len(names) - 1 else "")
        if lines and len(lines[-1]) + 1 + len(part) <= width:
            lines[-1] += f" {part}"
        else:
            lines.append(part)
    return lines
