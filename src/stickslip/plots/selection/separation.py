"""Travel that each fitted law predicts at other settings of the rig."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.errors import InputError
from stickslip.formatting import scale_of
from stickslip.identification import trials_of
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Target, on_axes
from stickslip.plots.core.helpers import Array, LineStyle, Sizes, grouped, looks, wrapped
from stickslip.plots.core.label_placement import Curve, label_curves, label_ends
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import INK, MUTED, STICK, SURFACE, label_at
from stickslip.quantities import parameters
from stickslip.selection import Separation, TravelVerdict

SEPARATION_SIZES: Final = Sizes(wide=(880, 320), narrow=(358, 300))
ROOM, NARROW_ROOM = 0.06, 0.12
"""Width of the number of a setting over that of all settings, in a wide and a narrow figure."""


def draw_separation(
    separations: Sequence[Separation],
    chosen: str,
    measured: Sequence[tuple[float, float]] = (),
    *,
    proposed: Sequence[float] = (),
    titles: Mapping[str, str] | None = None,
) -> Draw:
    """Return a drawing of the travel that each law predicts against the setting of the rig.

    Parameters
    ----------
    separations : sequence of Separation
        Predictions at several settings of one parameter.
    chosen : str
        Key of the law that stands out.
    measured : sequence of tuple of float
        Setting and travel of what was measured.
    proposed : sequence of float
        Settings to measure next, such as those of a `Proposal`.
    titles : mapping of str to str, optional
        Names of the laws by key.

    Returns
    -------
    callable
        Draws it, with a band at each proposed setting.
    """
    rows = sorted(separations, key=lambda row: row.value)
    names = list(rows[0].predicted)
    names.sort(key=lambda name: name != chosen)
    titles = titles or {}
    what = rows[0].path.rpartition(".")[2].replace("_", " ")
    values = np.array([row.value for row in rows])
    factor, unit = scale_of(values, rows[0].unit)
    settings = factor * values
    look = looks(names, chosen)

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        paths = {name: np.array([row.predicted[name] for row in rows]) for name in names}
        for name in names:
            colour, dashes, width, order = look[name]
            y = paths[name]
            axes.plot(settings, y, color=colour, linestyle=dashes, linewidth=width, zorder=order)
            axes.plot(settings, y, "o", color=colour, markersize=3, zorder=order)
        axes.set_xlabel(f"{what}, {unit}")
        axes.set_ylabel("travel, m")
        axes.grid(axis="y")
        _ticks(axes, settings, [factor * value for value in proposed], narrow)
        axes.margins(x=0.03)
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
        _where_to_measure(axes, [factor * value for value in proposed])
        shown = [(factor * x, y) for x, y in measured]
        _measured(axes, [(x, y) for x, y in shown if settings[0] <= x <= settings[-1]])
        _name_laws(axes, settings, paths, look, titles, narrow)

    return draw


def _ticks(axes: Axes, settings: Array, proposed: Sequence[float], narrow: bool) -> None:
    """Number the settings that have room for it, those to measure next before all others."""
    least = (NARROW_ROOM if narrow else ROOM) * float(np.ptp(settings))
    shown: list[float] = []
    for at in [*proposed, settings[0], settings[-1], *settings]:
        if all(abs(at - other) >= least for other in shown):
            shown.append(float(at))
    axes.set_xticks(sorted(shown))
    axes.set_xticks(settings, minor=True)


def _name_laws(
    axes: Axes,
    settings: Array,
    paths: Mapping[str, Array],
    look: Mapping[str, LineStyle],
    titles: Mapping[str, str],
    narrow: bool,
) -> None:
    """Name each law with its last prediction; laws that end together share a name."""
    ends = {name: float(y[-1]) for name, y in paths.items()}
    groups = grouped(ends, 0.015 * float(np.ptp(axes.get_ylim())))
    if narrow:
        texts = {group[0]: f"{end:.3f} m {_short(group, titles)}" for end, group in groups}
        curves = [Curve(settings, y, texts.get(n, ""), look[n].colour) for n, y in paths.items()]
        label_curves(axes, curves)
        return
    labels = []
    for end, group in groups:
        lines = wrapped([titles.get(name, name) for name in group], 34)
        labels.append((end, [f"{end:.3f} m {lines[0]}", *lines[1:]], look[group[0]].colour))
    label_ends(axes, axes.get_xlim()[1], labels)


def _short(names: Sequence[str], titles: Mapping[str, str]) -> str:
    """Return the names of a group, or the first and how many others."""
    said = [titles.get(name, name) for name in names]
    return ", ".join(said) if len(said) < 3 else f"{said[0]} and {len(said) - 1} others"


def _where_to_measure(axes: Axes, settings: Sequence[float]) -> None:
    low, high = axes.get_xlim()
    half = 0.008 * (high - low)
    for at in settings:
        axes.axvspan(at - half, at + half, facecolor=STICK, edgecolor="none", zorder=0)
    place = axes.get_xaxis_transform()
    notes = ((0.92, "measure here", 8, "left"), (0.06, "and here", -8, "right"))
    for at, (height, text, side, align) in zip(settings, notes, strict=False):
        axes.annotate(
            text, (at, height), xycoords=place, xytext=(side, 0), textcoords="offset points",
            ha=align, color=MUTED, fontsize=11,
        )  # fmt: skip


def _measured(axes: Axes, points: Sequence[tuple[float, float]]) -> None:
    for index, (x, y) in enumerate(points):
        axes.plot([x], [y], "o", color=INK, markersize=6, markeredgecolor=SURFACE, zorder=5)
        if index == 0:
            label_at(axes, x, y, "measured", INK, offset=(-8, 10), align="right")


def draw_proposal(verdict: TravelVerdict) -> Draw:
    """Return a drawing of what the laws of a verdict predict, and where to measure next."""
    proposal = verdict.proposal
    if proposal is None or not verdict.separations:
        raise InputError(
            "the verdict proposes no measurement, so there are no predictions to draw: no law was"
            " chosen, or no other law to distinguish it from."
        )
    names = (proposal.best, *proposal.rivals)
    rows = [
        replace(row, predicted={name: row.predicted[name] for name in names})
        for row in verdict.separations
    ]
    measured = []
    for trial in trials_of(verdict.mechanism, verdict.measurement, verdict.t_end):
        settings = {path: value for path, _, value in parameters(trial.mechanism, "mechanism")}
        if settings.get(rows[0].path) is not None:
            measured.append((float(settings[rows[0].path]), trial.travel))
    return draw_separation(
        rows,
        proposal.best,
        measured,
        proposed=[row.value for row in proposal.settings],
        titles={candidate.name: candidate.title for candidate in verdict.candidates},
    )


def plot_separation(verdict: TravelVerdict, ax: Target = None) -> Axes:
    """Plot the travel that each law of a verdict predicts against the setting of the rig.

    Parameters
    ----------
    verdict : TravelVerdict
        A selection by travels, with a proposal.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.

    Returns
    -------
    matplotlib.axes.Axes
        The panel, with what was measured and a band at each setting to measure next.

    Raises
    ------
    InputError
        If the verdict proposes no measurement.

    Examples
    --------
    >>> from stickslip import Coulomb, Dahl, Measurement, SpringBlock, select
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> laws = [Coulomb(kinetic_coefficient=0.25), "viscous"]
    >>> verdict = select(rig, laws, Measurement(travel=0.20, uncertainty=0.005))
    >>> plot_separation(verdict, Figure()).get_ylabel()
    'travel, m'
    """
    check_type("verdict", verdict, TravelVerdict)
    return on_axes(draw_proposal(verdict), ax, SEPARATION_SIZES["wide"])
