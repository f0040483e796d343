"""Rate-and-state parameters from a record of velocity steps, and which of them it can tell."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError, InputError, renamed
from stickslip.experiments import Measurement
from stickslip.identification.estimation.jackknife import effective_size
from stickslip.identification.estimation.levenberg_marquardt import OptimizeResult, Watch, search
from stickslip.identification.estimation.parameters import FreeParameters
from stickslip.identification.estimation.problem import ResidualJacobian
from stickslip.identification.estimation.sandwich import sandwich
from stickslip.identification.rate_state.law import STIFFNESS, Evolution
from stickslip.identification.rate_state.problem import Record, Slider, record_of, unknowns_for
from stickslip.identification.rate_state.result import (
    Profile,
    RateStateFit,
    Window,
    free_of,
    quantile,
    rate_error,
    result_of,
)

__all__ = ["Drift", "fit_rate_state"]

Array: TypeAlias = NDArray[np.float64]
Drift: TypeAlias = Literal["auto", "none", "linear"]

FEWEST = 50
"""Samples that a fit needs."""
WORTH = 0.05
"""A drift is kept if it lowers the root mean square by this share, and its interval leaves 0."""
DISTANCES = (2e-3, 0.05, 0.3)
"""Critical distances that are tried first, over the way after the first step."""
LARGER = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Evolution effects at which everything else is fitted again, over a, beyond the best."""
SMALLER = (0.5, 0.0)
"""The same below the best, over the best."""
FRACTIONS = (0.125, 0.25, 0.5)
"""Shares of the way after the last step to which the fit is repeated."""
MINUTE = 5e-4
"""The same for a critical distance at which the evolution is as good as instantaneous."""


@renamed
def fit_rate_state(
    measurement: Measurement,
    *,
    evolution: Evolution = "ageing",
    stiffness: float | None = None,
    before: float | None = None,
    after: float | None = None,
    drift: Drift = "auto",
    lowest_evolution_effect: float = 0.0,
    starts: int = 6,
    seed: int = 0,
    progress: Watch | None = None,
) -> RateStateFit:
    """Fit rate-and-state friction to a record with steps of the speed of the load point.

    The slider has no inertia and slides steadily at first. Intervals come from ten stretches of
    time within which residuals may be correlated in any way, widened by what a profile over b
    allows. Whether a and b can be told apart is said in words.

    Parameters
    ----------
    measurement : Measurement
        One record with ``time``, ``pull`` (the position of the load point) and ``friction``; a
        coefficient is a friction at load 1.
    evolution : {"ageing", "slip"}
        How the state follows.
    stiffness : float, optional
        Stiffness over the load, d mu / d x [1/m]; fitted if not given.
    before, after : float, optional
        Way of the load point [m] before the first and after the last step that is used; all if not
        given. What a - b comes out as can depend on it, which `RateStateFit.windows` shows.
    drift : {"auto", "none", "linear"}
        Whether friction changes steadily with the way of the load point; ``"auto"`` fits both ways
        and keeps the drift if the data need it.
    lowest_evolution_effect : float
        Lower bound of b. The laws were made for b of at least 0; below, friction goes on rising
        after a step.
    starts, seed : int
        Number of starts of the search, and seed of those that are drawn.
    progress : callable, optional
        Called with the least root mean square so far; False ends the search with the best so far.

    Returns
    -------
    RateStateFit
        Law, stiffness, drift, estimates with intervals, and sentences.

    Raises
    ------
    InputError
        If the record cannot be used.
    ConvergenceError
        If the slider runs away from every start.

    Examples
    --------
    >>> from stickslip.identification import RateState, simulate_velocity_steps
    >>> truth = RateState(
    ...     reference_coefficient=0.6,
    ...     direct_effect=0.010,
    ...     evolution_effect=0.014,
    ...     critical_distance=1e-5,
    ...     reference_velocity=1e-6,
    ... )
    >>> t = np.arange(0.0, 60.0, 0.05)
    >>> pull = 1e-6 * np.where(t < 20.0, t, 20.0 + 10.0 * (t - 20.0))
    >>> run = simulate_velocity_steps(truth, stiffness=2e3, time=t, pull=pull)
    >>> noise = np.random.default_rng(0).normal(0.0, 3e-4, len(t))
    >>> record = Measurement(time=t, pull=pull, friction=run.coefficient + noise, load=1.0)
    >>> fitted = fit_rate_state(record)
    >>> fitted.separable, abs(fitted.law.direct_effect - 0.010) < 5e-4
    (True, True)
    """
    if drift not in ("auto", "none", "linear"):
        raise InputError(f"drift must be 'auto', 'none' or 'linear', got {drift!r}.")
    if stiffness is not None:
        stiffness = STIFFNESS.check("fit_rate_state", "stiffness", stiffness)
    record = _used(measurement, before, after)
    unknowns = [
        unknowns_for(
            record,
            drift=drifts,
            lowest_evolution_effect=lowest_evolution_effect,
            stiffness=stiffness,
        )
        for drifts in ((False,) if drift == "none" else (False, True))
    ]
    slider = Slider.of(record, evolution, unknowns[0])
    found = search(slider, starts=starts, seed=seed, tried=_tried(unknowns[0]), watch=progress)
    if drift != "none" and not found.cancelled:
        slider, found = _drifting(slider, found, unknowns[1], progress, always=drift == "linear")
    return result_of(
        slider,
        found,
        profile=Profile() if found.cancelled else _profile(slider, found.best),
        windows=() if found.cancelled else _windows(slider, found.best),
    )


def _used(measurement: Measurement, before: float | None, after: float | None) -> Record:
    record = record_of(measurement).within(before, after)
    if not len(record.path.steps) or len(record.time) < FEWEST:
        raise InputError(
            f"between {before} m before the first step and {after} m after the last are"
            f" {len(record.time)} samples, and a fit needs at least {FEWEST}, on both sides of a"
            " step."
        )
    return record


def _tried(unknowns: FreeParameters) -> Sequence[Array]:
    """Return starts with other critical distances; the first one has 0.01 of the way."""
    tried = []
    for distance in DISTANCES:
        start = unknowns.start
        start[2] *= distance / 0.01
        tried.append(start)
    return tried


def _drifting(
    slider: Slider,
    found: OptimizeResult,
    unknowns: FreeParameters,
    watch: Watch | None,
    *,
    always: bool,
) -> tuple[Slider, OptimizeResult]:
    """Return problem and end with a drift, or those without if the data do not need it."""
    drifting = slider.with_unknowns(unknowns)
    ends = [search(drifting, starts=1 + len(DISTANCES), tried=_tried(unknowns), watch=watch)]
    carried = unknowns.starting_at([*found.best.values, 0.0])
    ends.append(search(drifting.with_unknowns(carried), starts=1, watch=watch))
    best = min(ends, key=lambda end: end.best.cost)
    if not always:
        error = math.sqrt(sandwich(best.best, free_of(drifting, best.best.values))[-1, -1])
        sure = abs(best.best.values[-1]) > quantile() * error
        if not sure or best.best.rms > (1.0 - WORTH) * found.best.rms:
            return slider, found
    return drifting, best


def _profile(slider: Slider, best: ResidualJacobian) -> Profile:
    """Return fits with other evolution effects held, as far as the record allows them."""
    values = best.values
    a, b = values[:2]
    room = best.cost * (1.0 + 4.0 / max(effective_size(best) - len(values), 4.0))
    lowest = slider.unknowns.items[1].low
    kept: list[ResidualJacobian] = []
    unbounded = True
    for tried in (
        [b + share * a for share in LARGER],
        [max(share * b, lowest) for share in SMALLER if b > max(lowest, 0.0) + 1e-3 * a],
    ):
        for held in tried:
            end = _holding(slider, values, held)
            if end is None or end.cost > room:
                unbounded = unbounded and held < b
                break
            kept.append(end)
    return Profile(ends=tuple(kept), unbounded=unbounded)


def _holding(slider: Slider, values: Array, b: float) -> ResidualJacobian | None:
    """Return the best fit with b held, from a shifted as much and from fast evolution."""
    start = values.copy()
    start[0] = max(values[0] + b - values[1], 1e-2 * values[0])
    start[1] = b
    items = list(slider.unknowns.starting_at(start).items)
    items[1] = replace(items[1], low=b, high=b)
    minute = start.copy()
    minute[2] = MINUTE * slider.record.slid
    held = slider.with_unknowns(replace(slider.unknowns, items=tuple(items)))
    try:
        return search(held, starts=2, tried=[minute]).best
    except ConvergenceError:
        return None


def _windows(slider: Slider, best: ResidualJacobian) -> tuple[Window, ...]:
    """Return a - b with less of the record after the last step, and with all that was given."""
    found = []
    for share in FRACTIONS:
        record = slider.record.within(None, share * slider.record.after)
        if not len(record.path.steps) or len(record.time) < FEWEST:
            continue
        cropped = Slider.of(record, slider.evolution, slider.unknowns.starting_at(best.values))
        found.append(_window(cropped, search(cropped, starts=3).best))
    return (*found, _window(slider, best))


def _window(slider: Slider, end: ResidualJacobian) -> Window:
    error = rate_error(sandwich(end, free_of(slider, end.values)))
    rate = float(end.values[0] - end.values[1])
    return Window(after=slider.record.after, rate=rate, error=error)
