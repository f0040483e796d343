"""The plot of any result, by its type."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.data import Measurement
from stickslip.engine.trajectory import Ensemble, Trajectory
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify import Verdict
from stickslip.identify.fits import Fit
from stickslip.show.display import InPanels
from stickslip.show.plots import laws
from stickslip.show.plots.axes import Panels, PanelTarget
from stickslip.show.plots.fits import plot_fit, plot_verdict
from stickslip.show.plots.measurements import plot_measurement
from stickslip.show.plots.runs import plot_closed_loop, plot_run
from stickslip.show.plots.studies import plot_band, plot_ensemble, plot_optimum
from stickslip.show.plots.svg import standalone_svg
from stickslip.show.plots.sweep_maps import plot_sweep, plot_velocity_band
from stickslip.study import PreslidingLoop, sweep
from stickslip.study.control import ClosedLoop
from stickslip.study.optimisation import Optimum

PLOTS: Final[Mapping[type, Callable[..., Axes | Panels]]] = MappingProxyType(
    {
        Trajectory: plot_run,
        Ensemble: plot_ensemble,
        sweep.Band: plot_band,
        ClosedLoop: plot_closed_loop,
        Fit: plot_fit,
        Verdict: plot_verdict,
        PreslidingLoop: laws.plot_presliding,
        FrictionLaw: laws.plot_law,
        sweep.VelocityMap: plot_sweep,
        sweep.VelocityBand: plot_velocity_band,
        sweep.Basins: plot_sweep,
        sweep.OrbitDiagram: plot_sweep,
        sweep.Branch: plot_sweep,
        sweep.OrbitChart: plot_sweep,
        sweep.EventCurve: plot_sweep,
        sweep.SensitivityIndices: plot_sweep,
        Optimum: plot_optimum,
        Measurement: plot_measurement,
    }
)
"""The plot of each kind of result."""

SMALL: Final = (560, 300)
SMALL_PANELS: Final = (560, 440)
"""Sizes of a figure below a table, of one panel and of several [CSS px]."""


def plot(result: object, ax: PanelTarget = None) -> Axes | Panels:
    """Plot a result by the function for its type, which has options.

    Parameters
    ----------
    result : Trajectory, Ensemble, Fit, Verdict, FrictionLaw, ...
        What is plotted; the keys of ``stickslip.show.plots.PLOTS``.
    ax : Axes, sequence of Axes, Figure or SubFigure, optional
        Where; a sequence for a plot of several panels. A new figure if not given.

    Returns
    -------
    matplotlib Axes or array of Axes
        The panels.

    Raises
    ------
    InputError
        If there is no plot for the type.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from stickslip import Coulomb
    >>> plot(Coulomb(kinetic_coefficient=0.25), Figure()).get_title("left")
    'Coulomb'
    """
    for kind, draw in PLOTS.items():
        if isinstance(result, kind):
            return draw(result, ax)
    names = ", ".join(kind.__name__ for kind in PLOTS)
    raise InputError(f"there is no plot for a {type(result).__name__}; there is one for {names}.")


def thumbnail(result: object) -> str:
    """Return a small figure of a result as an SVG element.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> thumbnail(Coulomb(kinetic_coefficient=0.25))[:4]
    '<svg'
    """

    def draw(figure: Figure, _narrow: bool) -> None:
        plot(result, figure)

    size = SMALL_PANELS if isinstance(result, InPanels) else SMALL
    return standalone_svg(draw, size=size)
