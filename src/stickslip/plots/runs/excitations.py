"""Travel of one block under several readings of how it was set in motion."""

from collections.abc import Mapping
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.plots.core.helpers import RIVALS, Sizes, dense, horizon
from stickslip.plots.core.label_placement import Curve, label_curves, label_ends
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, MUTED, SLIP_BACK, label_at, name_size
from stickslip.trajectory import Trajectory

EXCITATION_SIZES: Final = Sizes(wide=(880, 310), narrow=(358, 300))


def excitation_colours(labels: Mapping[str, object], chosen: str | None = None) -> dict[str, str]:
    """Return the colour of each reading: blue for the one that is taken.

    Examples
    --------
    >>> excitation_colours({"push": 0, "spring": 0}, "spring")["spring"] == C1
    True
    """
    chosen = next(iter(labels)) if chosen is None else chosen
    others = iter(RIVALS * len(labels))
    return {label: C1 if label == chosen else next(others) for label in labels}


def draw_excitations(
    runs: Mapping[str, Trajectory],
    *,
    chosen: str | None = None,
    band: tuple[float, float] | None = None,
    measured: str = "measured",
    slip: str = "x",
) -> Draw:
    """Return a drawing of the travel in several readings, named with their values at the end.

    Parameters
    ----------
    runs : mapping of str to Trajectory
        Runs by what they are called.
    chosen : str, optional
        The reading that is taken; the first if not given.
    band : tuple of float, optional
        Range of the measured travel [m]; a line if its ends are equal.
    measured : str
        What the band is called.
    slip : str
        Name of the slipping coordinate.

    Returns
    -------
    callable
        Draws it, with a dot where the block has come to rest.
    """
    last = max(horizon(run, slip) for run in runs.values())
    colours = excitation_colours(runs, chosen)
    chosen = next(iter(runs)) if chosen is None else chosen

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        curves = [
            _reading(axes, label, run, last, slip, colours[label], label == chosen)
            for label, run in runs.items()
        ]
        axes.margins(x=0, y=0.16 if narrow else 0.1)
        if band:
            if band[1] > band[0]:
                axes.axhspan(*band, facecolor=SLIP_BACK, edgecolor="none", zorder=0)
            else:
                axes.axhline(band[0], color=MUTED, linewidth=1.0, zorder=1)
            label_at(axes, 0.0, band[1], measured, MUTED, offset=(6, 8))
        if any(_rest(run, last) for run in runs.values()):
            axes.annotate(
                "dot: block at rest", (0.98, 0.06), xycoords="axes fraction",
                ha="right", color=MUTED, fontsize=name_size(),
            )  # fmt: skip
        axes.set_xlabel("time, s")
        axes.set_ylabel("travel, m")
        axes.grid(axis="y")
        if narrow:
            label_curves(axes, curves)
        else:
            label_ends(axes, last, [(float(c.y[-1]), [c.text], c.colour) for c in curves])

    return draw


def _reading(
    axes: Axes, label: str, run: Trajectory, last: float, slip: str, colour: str, is_chosen: bool
) -> Curve:
    """Draw one reading, and return its curve with its name and value."""
    seen = dense(run, last)
    start = float(run.at(run.span[:1])[slip][0])
    x = seen[slip] - start
    axes.plot(seen.t, x, color=colour, linewidth=2.2 if is_chosen else 1.5, zorder=3)
    stop = _rest(run, last)
    if stop is not None:
        at = run.at([stop])[slip] - start
        axes.plot([stop], at, "o", color=colour, markersize=5, zorder=4)
    value = f"{float(x[-1]):.3f} m".replace("-", "−")
    return Curve(seen.t, x, f"{label}: {value}", colour)


def _rest(run: Trajectory, last: float) -> float | None:
    """Return when the last stop was, if the body stays there and it is shown."""
    if not run.events or abs(run.events[-1].to_mode) == 1 or run.events[-1].t > last:
        return None
    return run.events[-1].t
