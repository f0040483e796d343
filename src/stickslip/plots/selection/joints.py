"""Forces of the joints of a mechanism, measured and predicted."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.formatting import Scale, scale_of
from stickslip.identification import Prediction, RecordFit
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, on_panels
from stickslip.plots.core.svg import Draw, Size
from stickslip.plots.core.theme import C1, DATA, MUTED
from stickslip.quantities import turned

PANEL = 190
"""Height of a panel [px]."""


def plot_joints(
    fit: RecordFit,
    ax: PanelTarget = None,
    *,
    measurement: Measurement | None = None,
    record: int = 0,
) -> Panels:
    """Plot the measured and the predicted force of each joint of one record against time.

    Parameters
    ----------
    fit : RecordFit
        A fit to records of several joints.
    ax : sequence of Axes, Figure or SubFigure, optional
        An Axes for each joint; a new figure if not given.
    measurement : Measurement, optional
        What is predicted; what was fitted if not given.
    record : int
        Which of its records is shown, from 0.

    Returns
    -------
    array of Axes (m,)
        A panel for each joint.

    Raises
    ------
    InputError
        If the fit is not one of several joints, or there is no such record.
    """
    check_type("fit", fit, RecordFit)
    if fit.problem.joints is None:
        raise InputError("plot_joints takes a fit of several joints: plot_fit draws this one.")
    seen = fit.predict(measurement)
    if record not in seen.record:
        raise InputError(f"record must be from 0 to {int(seen.record.max())}, got {record!r}.")
    draw = joint_figure(fit, measurement=measurement, record=record)
    return on_panels(draw, ax, joint_sizes(fit)["wide"])


def joint_sizes(fit: RecordFit) -> dict[str, Size]:
    """Return the sizes of the figure of all joints of a fit, for screens and phones."""
    assert fit.problem.joints is not None
    height = 60 + PANEL * len(np.unique(fit.problem.joints))
    return {"wide": (880, height), "narrow": (390, height)}


def joint_figure(
    fit: RecordFit, *, measurement: Measurement | None = None, record: int = 0
) -> Draw:
    """Return what draws the forces of the joints, as `plot_joints` does."""
    seen = fit.predict(measurement)
    turning = [unit == "rad" for unit in fit.mechanism.units]
    units = dict(zip(fit.mechanism.coordinates, (turned("N", t) for t in turning), strict=True))
    assert seen.joint is not None
    fitted = np.unique(seen.joint[seen.record == record])  # others rest
    units = {name: unit for name, unit in units.items() if name in fitted}
    shown: dict[str, list[NDArray[np.float64]]] = {}
    for name, unit in units.items():
        own = seen.of(name)
        shown.setdefault(unit, []).append(own.measured[own.record == record])
    scales = {unit: scale_of(np.concatenate(values), unit) for unit, values in shown.items()}

    def draw(figure: Figure, narrow: bool) -> None:
        panels = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
        for axes, (name, unit) in zip(panels, units.items(), strict=True):
            own = seen.of(name)
            _draw_one(axes, own, own.record == record, unit, scales[unit])
            axes.set_title(name, loc="left", fontsize="medium")
        panels[0].legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False,
            fontsize="small" if narrow else "medium",
        )  # fmt: skip
        panels[-1].set_xlabel("time, s")
        figure.align_ylabels()

    return draw


def _draw_one(
    axes: Axes, own: Prediction, rows: NDArray[np.bool_], unit: str, scale: Scale
) -> None:
    """Draw the force of one joint."""
    factor, shown = scale
    order = own.t[rows].argsort()
    t = own.t[rows][order]
    axes.plot(t, factor * own.measured[rows][order], color=DATA, linewidth=2.2, label="measured")
    axes.plot(t, factor * own.predicted[rows][order], color=C1, linewidth=1.4, label="predicted")
    axes.axhline(0.0, color=MUTED, linewidth=0.6, zorder=0)
    axes.set_ylabel(f"{'torque' if unit == 'N m' else 'force'}, {shown}")
    axes.margins(x=0.01, y=0.15)


def refuse_joints(fit: RecordFit, plot: str) -> None:
    """Refuse a fit of several joints, of which `plot_joints` shows the forces."""
    if fit.problem.joints is not None:
        raise InputError(
            f"{plot} takes a fit of one contact: plot_joints draws one of several joints."
        )
