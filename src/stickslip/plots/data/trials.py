"""Parameters and laws of several trials, coloured by a condition."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments import Measurement, condition_name, condition_unit, velocity_of
from stickslip.formatting import scale_of, unit_text
from stickslip.identification import ConditionLine, TrialComparison, load_along
from stickslip.mechanisms import Mechanism
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, on_panels
from stickslip.plots.core.helpers import Sizes
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, C2, C3, C4, DATA, INK, MUTED, symbol_label
from stickslip.plots.laws.curves import characteristic
from stickslip.quantities import vary

TRIAL_SIZES: Final = Sizes(wide=(880, 300), narrow=(358, 640))
MOST: Final = 2
"""Parameters that have a panel: those whose lines are clearest come first."""
WORDS: Final = (C1, C2, C3, C4, INK, MUTED)


def draw_trials(comparison: TrialComparison, *, condition: str | None = None) -> Draw:
    """Return a drawing of what was fitted to each trial, coloured by a condition.

    Parameters
    ----------
    comparison : TrialComparison
        What `compare_trials` returns.
    condition : str, optional
        Name of a condition, with or without its unit; that of the clearest line, or else the first
        one, if not given. Without conditions, trials are numbered.

    Returns
    -------
    callable
        Draws parameters with their 95 % intervals over the condition, and the friction of each
        trial over its velocity.

    Raises
    ------
    InputError
        If no trial could be fitted alone.
    UnknownNameError
        If no trial has that condition.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, Measurement, compare_trials
    >>> from stickslip.plots import standalone_svg
    >>> v = np.linspace(-1.0, 1.0, 40)
    >>> wave = 0.01 * np.cos(50.0 * v)
    >>> trials = tuple(
    ...     Measurement(velocity=v, friction=level * np.sign(v) + wave, conditions={"run": run})
    ...     for run, level in ((1, 2.0), (2, 2.5))
    ... )
    >>> found = compare_trials(Axis(inertia=1.0), Coulomb, Measurement(trials=trials))
    >>> standalone_svg(draw_trials(found)).startswith("<svg")
    True
    """
    name = _condition(comparison, condition)
    trials = comparison.trials
    if not trials:
        raise InputError("there is nothing to draw: no trial could be fitted individually.")
    values = [trial.conditions.get(name) for trial in trials] if name else []
    if not name:
        values = [float(i + 1) for i in range(len(trials))]
    colours = _colours(values)
    order = _order(comparison, name)

    def draw(figure: Figure, narrow: bool) -> None:
        count = len(order) + 1
        grid = figure.subplots(*((count, 1) if narrow else (1, count)), squeeze=False)
        for axes, i in zip(grid.flat, order, strict=False):
            _parameter(axes, comparison, i, name, values, colours)
        _curves(grid.flat[count - 1], comparison, colours)

    return draw


def _condition(comparison: TrialComparison, wanted: str | None) -> str:
    """Return the full name of the condition to colour by; empty if there is none."""
    known = comparison.conditions
    if wanted is not None:
        for name in known:
            if wanted in (name, condition_name(name)):
                return name
        raise UnknownNameError("condition", wanted, known)
    clear = sorted((line for line in comparison.lines if line.clear), key=_width)
    return clear[0].condition if clear else (known[0] if known else "")


def _width(line: ConditionLine) -> float:
    """Return the width of the interval of a slope, over the slope."""
    return (line.high - line.low) / max(abs(line.slope), 1e-300)


def _order(comparison: TrialComparison, condition: str) -> list[int]:
    """Return which parameters are shown: those with the clearest lines first."""
    paths = [one.path for one in comparison.trials[0].estimates]
    width = {line.path: _width(line) for line in comparison.lines if line.condition == condition}
    known = [
        i
        for i in range(len(paths))
        if any(math.isfinite(trial.errors[i]) for trial in comparison.trials)
    ]
    shown = sorted(known, key=lambda i: width.get(paths[i], math.inf))[:MOST]
    return sorted(shown)


def _colours(values: Sequence[float | str | None]) -> list[str]:
    """Return a colour by value: between blue and orange for numbers, grey where there is none."""
    numbers = [value for value in values if isinstance(value, float)]
    words = list(dict.fromkeys(value for value in values if isinstance(value, str)))
    low, span = min(numbers, default=0.0), max(np.ptp(numbers), 1e-300) if numbers else 1.0
    found = []
    for value in values:
        if isinstance(value, float):
            share = (value - low) / span
            mixed = (1.0 - share) * np.array(to_rgb(C1)) + share * np.array(to_rgb(C2))
            found.append(to_hex(mixed.tolist()))
        else:
            found.append(DATA if value is None else WORDS[words.index(value) % len(WORDS)])
    return found


def _parameter(
    axes: Axes,
    comparison: TrialComparison,
    i: int,
    condition: str,
    values: Sequence[float | str | None],
    colours: Sequence[str],
) -> None:
    """Draw a parameter of all trials over the condition, with its line."""
    words = [value for value in dict.fromkeys(values) if isinstance(value, str)]
    for trial, value, colour in zip(comparison.trials, values, colours, strict=True):
        one = trial.estimates[i]
        if value is None or not one.bounded:
            continue
        place = float(words.index(value)) if isinstance(value, str) else value
        axes.plot([place, place], [one.low, one.high], color=colour, linewidth=1.5)
        axes.plot([place], [one.value], "o", color=colour, markersize=5)
    path = comparison.trials[0].estimates[i].path
    for line in comparison.lines:
        if line.path == path and line.condition == condition:
            axes.plot(line.ends, line.values, color=MUTED, linewidth=1.2, zorder=1)
    if words:
        axes.set_xticks(range(len(words)), words)
        axes.margins(x=0.3)
    quantity = comparison.trials[0].estimates[i].quantity
    unit = unit_text(quantity.unit)
    title = symbol_label(quantity.symbol)
    axes.set_title(f"{title}, {unit}" if unit else title, color=MUTED)
    what = condition_name(condition) or "trial"
    in_unit = unit_text(condition_unit(condition))
    axes.set_xlabel(f"{what}, {in_unit}" if in_unit else what)
    axes.grid(axis="y")


def _curves(axes: Axes, comparison: TrialComparison, colours: Sequence[str]) -> None:
    """Draw the friction of each trial over its velocity."""
    records = comparison.fit.measurement.records()
    own = [records[trial.number] for trial in comparison.trials]
    top = max(map(_top, own))
    factor, unit = scale_of([top], comparison.fit.measurement.unit("velocity"))
    for trial, record, colour in zip(comparison.trials, own, colours, strict=True):
        load = _load(comparison.fit.mechanism, record)
        velocity, force = characteristic(trial.law, load, top)
        axes.plot(factor * velocity, force, color=colour, linewidth=1.5)
    axes.set_title(f"friction, {comparison.fit.measurement.unit('friction')}", color=MUTED)
    axes.set_xlabel(f"velocity, {unit}")
    axes.grid(axis="y")


def _top(record: Measurement) -> float:
    """Return the largest speed of a record."""
    velocity = record.values("velocity") if record.time is None else velocity_of(record)
    return float(np.max(np.abs(velocity)))


def _load(mechanism: Mechanism, record: Measurement) -> float:
    """Return the mean normal force of a record [N]."""
    own = vary(mechanism, "mechanism", record.overrides)
    count = 1 if isinstance(record.load, float | None) else len(record.load)
    return float(np.mean(load_along(own, record, count)))


def plot_trials(
    comparison: TrialComparison, ax: PanelTarget = None, *, condition: str | None = None
) -> Panels:
    """Plot what was fitted to each trial, coloured by a condition.

    Parameters
    ----------
    comparison : TrialComparison
        What `compare_trials` returns.
    ax : sequence of Axes, Figure or SubFigure, optional
        One Axes for each of the parameters shown, at most two, and one for the curves; a new
        figure if not given.
    condition : str, optional
        Name of a condition, as in `draw_trials`.

    Returns
    -------
    array of Axes
        The panels.

    Raises
    ------
    InputError
        If no trial could be fitted alone.
    UnknownNameError
        If no trial has that condition.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, Measurement, compare_trials
    >>> v = np.linspace(-1.0, 1.0, 40)
    >>> wave = 0.01 * np.cos(50.0 * v)
    >>> trials = tuple(
    ...     Measurement(velocity=v, friction=level * np.sign(v) + wave, conditions={"run": run})
    ...     for run, level in ((1, 2.0), (2, 2.5))
    ... )
    >>> found = compare_trials(Axis(inertia=1.0), Coulomb, Measurement(trials=trials))
    >>> len(plot_trials(found, Figure()))
    2
    """
    check_type("comparison", comparison, TrialComparison)
    return on_panels(draw_trials(comparison, condition=condition), ax, TRIAL_SIZES["wide"])
