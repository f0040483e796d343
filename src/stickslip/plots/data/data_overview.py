"""A measured record at a glance: signals, speeds, and force against velocity."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec

from stickslip.experiments import GAP, QUANTITIES, Measurement, interval_of, velocity_of
from stickslip.formatting import scale_of
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, on_panels
from stickslip.plots.core.helpers import Array
from stickslip.plots.core.svg import Draw, Size
from stickslip.plots.core.theme import C1, DATA, MUTED, SLIP_BACK, STICK, shade

MOST_SIGNALS: Final = 5
MOST_NAMED: Final = 6
"""Trials at most whose curves have a name each."""
BINS: Final = 1200
"""Stretches of time of which smallest and largest value are drawn."""
SPEEDS: Final = 60
CELLS: Final = (90, 60)
EDGE: Final = 0.0005
"""Share of samples at either end that a histogram leaves out, or one outlier would squeeze it."""
SHORT: Final = {"spring_force": "spring"}


def overview_size(record: Measurement) -> Size:
    """Return the size of the overview of a record, wide enough for a page [CSS px].

    Examples
    --------
    >>> overview_size(Measurement(time=[0, 1, 2], position=[0, 1, 2]))
    (880, 460)
    """
    return (880, 130 * len(_signals(record)) + (330 if _has_velocity(record) else 70))


def draw_overview(record: Measurement) -> Draw:
    """Return a drawing of a record as it was measured.

    Examples
    --------
    >>> time = np.arange(500) / 100
    >>> record = Measurement(time=time, position=np.sin(time), force=np.cos(time))
    >>> figure = Figure()
    >>> draw_overview(record)(figure, False)
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['position, m', 'force, N', 'samples, %', 'force, N']
    """
    names = _signals(record)
    velocity, speeds = _velocity(record), record.unit("velocity")
    forces = [name for name in ("friction", "force", "spring_force") if _sampled(record, name)]

    def draw(figure: Figure, _narrow: bool) -> None:
        below = velocity is not None
        heights = [1.0] * len(names) + [1.8] * below
        grid = GridSpec(len(heights), 2, figure=figure, height_ratios=heights)
        first: Axes | None = None
        for row, name in enumerate(names):
            first = figure.add_subplot(grid[row, :], sharex=first)
            _series(first, record, name)
            first.tick_params(labelbottom=row == len(names) - 1)
        if first is not None:
            first.set_xlabel("time, s")
        if velocity is None:
            return
        left = figure.add_subplot(grid[-1, 0] if forces else grid[-1, :])
        _histogram(left, velocity, speeds)
        if forces:
            right = figure.add_subplot(grid[-1, 1])
            _density(right, (velocity, speeds), record, forces[0])
        figure.align_ylabels()

    return draw


def plot_measurement(measurement: Measurement, ax: PanelTarget = None) -> Panels:
    """Draw a measurement as it was made.

    Parameters
    ----------
    measurement : Measurement
        Records in time, friction maps or travels; all trials are drawn over each other.
    ax : sequence of Axes, Figure or SubFigure, optional
        Where. A new figure if not given.

    Returns
    -------
    array of Axes (n,)
        A panel for each signal against time; friction against velocity; or the travels of the
        trials, with their stated uncertainties.

    Raises
    ------
    InputError
        If `measurement` or `ax` is of another kind.

    Examples
    --------
    >>> time = np.arange(500) / 100
    >>> record = Measurement(time=time, position=np.sin(time), force=np.cos(time))
    >>> [axes.get_ylabel() for axes in plot_measurement(record, Figure())]
    ['position, m', 'force, N']
    """
    check_type("measurement", measurement, Measurement)
    records = measurement.records()
    series = measurement.kind == "series"
    names = [
        name
        for name in measurement.quantities()
        if series and any(np.ndim(one.values(name)) for one in records if name in one.quantities())
    ]

    def draw(figure: Figure, _narrow: bool) -> None:
        if series:
            panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
            for axes, name in zip(panels, names, strict=True):
                _overlay(axes, measurement, name)
            panels[-1].set_xlabel("time, s")
            figure.align_ylabels()
        elif measurement.kind == "friction-map":
            _map(figure.add_subplot(), measurement)
        else:
            _travels(figure.add_subplot(), measurement)

    return on_panels(draw, ax, (880, 110 * len(names) + 60 if series else 320))


def _colour(place: int, records: Sequence[Measurement]) -> str:
    return DATA if len(records) == 1 else f"C{place % 10}"


def _overlay(axes: Axes, measurement: Measurement, name: str) -> None:
    """Draw a signal of all trials that have it."""
    records = measurement.records()
    all_values = np.concatenate([np.ravel(r.values(name)) for r in records if _has(r, name)])
    factor, unit = scale_of(all_values, measurement.unit(name))
    for place, record in enumerate(records):
        if _has(record, name) and record.time is not None:
            time, values = _envelope(
                np.asarray(record.time), factor * np.asarray(record.values(name))
            )
            axes.plot(time, values, color=_colour(place, records), linewidth=1.0)
    quantity, _, joint = name.partition(".")
    axes.set_ylabel((f"{joint}\n" if joint else "") + _label(quantity, unit))
    axes.margins(x=0, y=0.08)
    axes.grid(axis="y")


def _has(record: Measurement, name: str) -> bool:
    return name in record.quantities() and np.ndim(record.values(name)) > 0


def _map(axes: Axes, measurement: Measurement) -> None:
    """Draw friction against velocity, a point for each row."""
    records = measurement.records()
    for place, record in enumerate(records):
        v, f = record.values("velocity"), record.values("friction")
        label = record.name or f"trial {place + 1}"
        axes.plot(v, f, ".", color=_colour(place, records), markersize=4.0, label=label)
    if 1 < len(records) <= MOST_NAMED:
        axes.legend(frameon=False)
    axes.set_xlabel(_label("velocity", measurement.unit("velocity")))
    axes.set_ylabel(_label("friction", measurement.unit("friction")))
    axes.grid(axis="y")


def _travels(axes: Axes, measurement: Measurement) -> None:
    """Draw the numbers of each trial beside each other, with their uncertainties."""
    name = measurement.travelled or measurement.quantities()[0]
    records = [one for one in measurement.records() if name in one.quantities()]
    values = [np.ravel(one.values(name)) for one in records]
    factor, unit = scale_of(np.concatenate(values), measurement.unit(name))
    for place, (record, found) in enumerate(zip(records, values, strict=True), 1):
        doubt = factor * record.uncertainty.get(name, 0.0)
        axes.errorbar(
            np.full(found.size, place),
            factor * found,
            yerr=doubt or None,
            fmt="o",
            color=DATA,
            markersize=5.0,
            capsize=4.0,
        )
    axes.set_xticks(
        range(1, len(records) + 1), [one.name or f"{n}" for n, one in enumerate(records, 1)]
    )
    axes.set_xlim(0.4, len(records) + 0.6)
    axes.set_xlabel("trial")
    axes.set_ylabel(_label(name, unit))
    axes.margins(y=0.15)
    axes.grid(axis="y")


def _sampled(record: Measurement, name: str) -> bool:
    return isinstance(getattr(record, name), np.ndarray)


def _signals(record: Measurement) -> Sequence[str]:
    if record.time is None:
        return ()
    return [name for name in QUANTITIES if _sampled(record, name)][:MOST_SIGNALS]


def _has_velocity(record: Measurement) -> bool:
    return _sampled(record, "velocity") or (
        record.time is not None and _sampled(record, "position")
    )


def _velocity(record: Measurement) -> Array | None:
    if not _has_velocity(record):
        return None
    if record.time is None:
        return np.asarray(record.values("velocity"))
    return velocity_of(record)


def _label(name: str, unit: str) -> str:
    return f"{name.replace('_', ' ')}, {unit}"


def _series(axes: Axes, record: Measurement, name: str) -> None:
    """Draw a signal; where there are more samples than pixels, their extremes."""
    time, values = np.asarray(record.time), np.asarray(record.values(name))
    factor, unit = scale_of(
        values - (values.mean() if name == "position" else 0.0), record.unit(name)
    )
    shown_time, shown = _envelope(time, factor * values)
    axes.plot(shown_time, shown, color=DATA, linewidth=1.0)
    steps = np.diff(time)
    late = np.flatnonzero(steps > GAP * interval_of(time))
    shade(axes, [(time[i], time[i + 1]) for i in late[:200]], colour=STICK)
    axes.set_ylabel(_label(name, unit))
    axes.margins(x=0, y=0.08)
    axes.grid(axis="y")


def _envelope(time: Array, values: Array) -> tuple[Array, Array]:
    if values.size <= 4 * BINS:
        return time, values
    size = values.size // BINS
    cut = size * BINS
    rows = values[:cut].reshape(BINS, size)
    # In the order of time, so that no line runs back.
    at = np.sort(np.stack([rows.argmin(axis=1), rows.argmax(axis=1)], axis=1), axis=1)
    kept = np.append((at + size * np.arange(BINS)[:, None]).ravel(), np.arange(cut, values.size))
    return time[kept], values[kept]


def _middle(values: Array) -> tuple[float, float]:
    """Return the range of nearly all values, and some more."""
    low, high = (float(np.quantile(values, share)) for share in (EDGE, 1 - EDGE))
    edge = 0.03 * (high - low) or 1.0
    return low - edge, high + edge


def _histogram(axes: Axes, velocity: Array, speeds: str) -> None:
    factor, unit = scale_of(velocity, speeds)
    low, high = _middle(factor * velocity)
    counts, edges = np.histogram(factor * velocity, bins=SPEEDS, range=(low, high))
    axes.stairs(100 * counts / velocity.size, edges, fill=True, color=SLIP_BACK)
    axes.stairs(100 * counts / velocity.size, edges, color=DATA, linewidth=1.0)
    axes.set_xlabel(f"velocity, {unit}")
    axes.set_ylabel("samples, %")
    axes.margins(x=0)
    axes.grid(axis="y")


def _density(axes: Axes, moved: tuple[Array, str], record: Measurement, name: str) -> None:
    """Draw how often force and velocity meet, on a scale of powers of ten."""
    velocity, speeds = moved
    force = np.asarray(record.values(name))
    factor, unit = scale_of(velocity, speeds)
    across, up = _middle(factor * velocity), _middle(force)
    counts, _, _ = np.histogram2d(factor * velocity, force, bins=CELLS, range=(across, up))
    seen = np.ma.masked_equal(counts.T, 0)
    axes.imshow(
        np.log1p(seen),
        cmap=_shades(),
        vmin=0.0,
        extent=(*across, *up),
        origin="lower",
        aspect="auto",
        interpolation="nearest",
        zorder=2,
    )
    axes.axvline(0.0, color=MUTED, linewidth=0.8, zorder=1)
    axes.axhline(0.0, color=MUTED, linewidth=0.8, zorder=1)
    axes.set_xlim(*across)
    axes.set_ylim(*up)
    axes.set_xlabel(f"velocity, {unit}")
    axes.set_ylabel(_label(name, record.unit(name)))


def _shades() -> ListedColormap:
    """Return colours from that of a band to that of the darkest data."""
    pale, dark = np.array(to_rgb(SLIP_BACK)), np.array(to_rgb(C1))
    share = np.linspace(0.1, 1.0, 64)[:, None]
    return ListedColormap([*map(tuple, pale + share * (dark - pale))])
