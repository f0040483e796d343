"""The figure of a fit to velocity steps."""

from typing import TypeAlias

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stickslip.show.plots import C1, DATA, Draw, sampled

Array: TypeAlias = NDArray[np.float64]


def draw_coefficient(time: Array, measured: Array, fitted: Array, title: str) -> Draw:
    """Return a drawing of the coefficient of friction over time, measured and fitted.

    Examples
    --------
    >>> figure = Figure()
    >>> draw_coefficient(np.arange(3.0), np.ones(3), np.ones(3), "Ageing law")(figure, False)
    >>> figure.axes[0].get_ylabel()
    'coefficient of friction'
    """
    shown = sampled(len(time))

    def draw(figure: Figure, narrow: bool) -> None:  # noqa: ARG001
        axes = figure.subplots()
        axes.plot(
            time[shown], measured[shown], "o", color=DATA, markersize=2.2, alpha=0.6,
            markeredgewidth=0, label="measured",
        )  # fmt: skip
        axes.plot(time, fitted, color=C1, label=title)
        axes.set_xlabel("time, s")
        axes.set_ylabel("coefficient of friction")
        axes.legend()

    return draw
