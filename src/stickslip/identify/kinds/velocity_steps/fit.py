"""Rate-and-state parameters from a record of velocity steps, and which of them it can tell."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import ConvergenceError, InputError, UnknownNameError
from stickslip.friction import RATE_STATE_FORMS, RateState, RateStateForm
from stickslip.identify import THRESHOLDS
from stickslip.identify.fits import (
    BLOCKS,
    LAW,
    FreeParameters,
    OptimizeResult,
    Parameters,
    RecordSettings,
    ResidualJacobian,
    Watch,
    check_given,
    check_varied,
    effective_size,
    search,
)
from stickslip.identify.kinds.velocity_steps.problem import (
    DRIFT,
    EVOLVED,
    PATHS,
    SECOND,
    STRESS,
    Record,
    Slider,
    record_of,
    unknowns_for,
)
from stickslip.identify.kinds.velocity_steps.result import (
    ROOM,
    Profile,
    RateStateFit,
    Window,
    inference_of,
    rate_of,
    result_of,
)
from stickslip.mechanisms import Mechanism, TowedBlock
from stickslip.show.formatting import joined, quantity

Array: TypeAlias = NDArray[np.float64]
Drift: TypeAlias = Literal["auto", "none", "linear"]

STIFFNESS = "mechanism.stiffness"
CONVENTION = "friction.reference_velocity"
"""The speed at which mu_0 holds: any will do, and none can be fitted."""
STARTS = RecordSettings().starts
FEWEST = round(BLOCKS * ROOM)
"""Samples that a fit needs, of which blocks are left out in turn."""
DISTANCES = (2e-3, 0.05, 0.3)
"""Critical distances that are tried too, over the way after the first step; at the first, evolution
is as good as instantaneous."""
LARGER = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Evolution effects at which everything else is fitted again, over a, beyond the best."""
FRACTIONS = (0.125, 0.25, 0.5)
"""Shares of the way after the last step to which the fit is repeated."""


def fit_rate_state(
    mechanism: Mechanism,
    law: RateState | type[RateState] | str,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    before: float | None = None,
    after: float | None = None,
    drift: Drift = "auto",
    lowest_evolution_effect: float = 0.0,
    starts: int = STARTS,
    seed: int = 0,
    profile: bool = True,
    progress: Watch | None = None,
) -> RateStateFit:
    """Fit rate-and-state friction to a record with steps of the speed of the load point.

    The slider has no inertia and slides steadily at first. Intervals come from leaving out blocks
    of time (jackknife), widened by what a profile over b allows. Whether a and b can be told apart
    is said in words.

    Parameters
    ----------
    mechanism : TowedBlock
        Stiffness of spring and machine, and the load where none was measured. Mass and speed do not
        enter: the slider is quasi-static, and the speed of the load point was measured.
    law : RateState, type or str
        An instance, whose values are the start and, for what is not varied, held; the type, which
        is the ageing law; or a name of `RATE_STATE_FORMS`, such as ``"rate-and-state-slip"``.
    measurement : Measurement
        One record with ``time``, ``pull`` (the position of the load point) and ``friction``; a
        coefficient is a friction at load 1.
    vary : str or sequence of str, optional
        Parameters to fit, as for `fit`: ``"friction.*"``, which is all if not given, stands for all
        of the law. ``"mechanism.stiffness"`` fits the stiffness too.
    fixed : mapping of str to float, optional
        Values of parameters that are held, of law and mechanism.
    before, after : float, optional
        Way of the load point [m] before the first and after the last step that is used; all if not
        given. What a - b comes out as can depend on it, which `RateStateFit.windows` shows.
    drift : {"auto", "none", "linear"}
        Whether friction changes steadily with the way of the load point; ``"auto"`` fits both ways
        and keeps the drift if the data need it.
    lowest_evolution_effect : float
        Lower bound of b and b_2. The laws were made for b of at least 0; below, friction goes on
        rising after a step.
    starts, seed : int
        Number of starts of the search, and seed of those that are drawn.
    profile : bool
        Whether fits at other evolution effects widen the intervals, and fits to less of the way
        give `RateStateFit.windows`. Without, intervals are those of the jackknife alone.
    progress : callable, optional
        Called with the least root mean square so far; False ends the search with the best so far.

    Returns
    -------
    RateStateFit
        Law, mechanism, drift, estimates with intervals, and sentences.

    Raises
    ------
    InputError
        If the record, the mechanism or a name cannot be used.
    ConvergenceError
        If the slider runs away from every start.

    Examples
    --------
    >>> from stickslip.friction import RateState
    >>> from stickslip.identify.kinds import simulate_velocity_steps
    >>> truth = RateState(
    ...     reference_coefficient=0.6,
    ...     direct_effect=0.010,
    ...     evolution_effect=0.014,
    ...     critical_distance=1e-5,
    ...     reference_velocity=1e-6,
    ... )
    >>> t = np.arange(0.0, 60.0, 0.1)
    >>> pull = 1e-6 * np.where(t < 20.0, t, 20.0 + 10.0 * (t - 20.0))
    >>> run = simulate_velocity_steps(truth, stiffness=2e3, time=t, pull=pull)
    >>> noise = np.random.default_rng(0).normal(0.0, 3e-4, len(t))
    >>> record = Measurement(time=t, pull=pull, friction=run.coefficient + noise, load=1.0)
    >>> machine = TowedBlock(mass=1e-3, stiffness=2e3, speed=1e-6, load=1.0)
    >>> fitted = fit_rate_state(machine, "rate-and-state", record, profile=False)
    >>> fitted.separable, abs(fitted.law.direct_effect - 0.010) < 5e-4
    (True, True)
    """
    check_given("fit_rate_state", mechanism, measurement)
    if drift not in ("auto", "none", "linear"):
        raise InputError(f"drift must be 'auto', 'none' or 'linear', got {drift!r}.")
    asked = _asked(mechanism, law, measurement, vary, fixed)
    record = _used(measurement, asked.block, before, after)
    free_parameters = [
        _unknowns(asked, record, drift=drifts, lowest=lowest_evolution_effect)
        for drifts in ((False,) if drift == "none" else (False, True))
    ]
    reference = record.speed if asked.reference is None else asked.reference
    slider = Slider.of(
        record, asked.form, free_parameters[0], reference, regularised=asked.regularised
    )
    found = search(slider, starts=starts, seed=seed, start_values=_tried(slider), watch=progress)
    if drift != "none" and not found.cancelled:
        slider, found = _drifting(
            slider, found, free_parameters[1], progress, always=drift == "linear"
        )
    fit = result_of(asked.block, measurement, slider, _in_order(slider, found))
    return with_profile(fit) if profile else fit


def with_profile(fit: RateStateFit) -> RateStateFit:
    """Return a fit with intervals as wide as a profile over b allows, and a - b by window."""
    if fit.cancelled:
        return fit
    slider, best = fit.problem, fit.best
    return result_of(
        fit.mechanism,
        fit.measurement,
        slider,
        fit.optimum,
        profile=_profile(slider, best),
        windows=_windows(slider, best),
    )


def form_of(law: object) -> RateStateForm:
    """Return the form of a law, its type or its name.

    Examples
    --------
    >>> form_of("rate-and-state-slip").title, form_of(RateState).title
    ('Rate and state (slip)', 'Rate and state (ageing)')
    """
    if isinstance(law, str):
        if law not in RATE_STATE_FORMS:
            raise UnknownNameError("form of rate-and-state friction", law, RATE_STATE_FORMS)
        return RATE_STATE_FORMS[law]
    if law is RateState:
        return RATE_STATE_FORMS["rate-and-state"]
    if not isinstance(law, RateState):
        called = law.__name__ if isinstance(law, type) else type(law).__name__
        raise InputError(
            "friction while a load point is pulled takes RateState or one of"
            f" {', '.join(RATE_STATE_FORMS)}, got {called}: its slip speed was not measured."
        )
    return RATE_STATE_FORMS[law.name]


@dataclass(frozen=True, kw_only=True)
class _Asked:
    """What a fit looks for and what it holds, by path."""

    block: TowedBlock
    form: RateStateForm
    held: Mapping[str, float]
    given: Mapping[str, float]
    reference: float | None
    """Speed at which the reference coefficient holds [m/s]; None for the first of the record."""
    regularised: bool
    """Whether the law that was given is."""


def _asked(
    mechanism: Mechanism,
    law: RateState | type[RateState] | str,
    measurement: Measurement,
    vary: str | Sequence[str] | None,
    fixed: Mapping[str, float] | None,
) -> _Asked:
    form = form_of(law)
    kind = RateState if isinstance(law, str) else law
    chosen = Parameters.of(_pulled(mechanism), kind, vary, fixed, measurement=measurement)
    stated = [
        path for one in (measurement, *measurement.trials) for path in one.parameter_uncertainties
    ]
    if stated:
        raise InputError(
            f"the uncertainty of {stated[0]} is not propagated into intervals of rate-and-state"
            " fits: leave it out."
        )
    usual = [f"friction.{name}" for name in form.fit_order]
    known = {f"friction.{name}": value for name, value in chosen.known.items()}
    named = (LAW,) if chosen.free is None else chosen.free
    free = {path for path in usual if path not in known} if LAW in named else set()
    free |= set(named) - {LAW}
    others = [path for path in chosen.unknown if path != STIFFNESS]
    if others or CONVENTION in free:
        raise InputError(
            f"a rate-and-state fit cannot vary {(*others, CONVENTION)[0]}: of the mechanism only"
            " the stiffness enters, and the reference velocity is a convention, which fixed sets."
        )
    foreign = [path for path in (*free, *known) if path not in (*usual, CONVENTION)]
    if foreign:
        raise InputError(
            f"{form.title.lower()} has no {foreign[0].partition('.')[2]}; its parameters are"
            f" {', '.join(form.fit_order)}."
        )
    own = {} if not isinstance(chosen.law, RateState) else {
        path: getattr(chosen.law, path.partition(".")[2]) for path in (*usual, CONVENTION)
    }  # fmt: skip
    own |= known
    missing = [path for path in usual if path not in free and path not in own]
    if missing:
        raise InputError(f"{missing[0]} is neither varied nor fixed: add it to vary or to fixed.")
    held = {path: own[path] for path in usual if path not in free}
    block = _pulled(chosen.mechanism)
    if STIFFNESS not in chosen.unknown:
        held[STIFFNESS] = block.stiffness
    if form is RATE_STATE_FORMS["constant-coefficient"]:  # the load point drags it along
        held |= {PATHS[0]: 0.0, STIFFNESS: block.stiffness}
    check_varied(bool(free) or STIFFNESS not in held)
    given = {path: value for path, value in own.items() if path in free}
    return _Asked(
        block=block,
        form=form,
        held=held,
        given=given,
        reference=own.get(CONVENTION),
        regularised=isinstance(chosen.law, RateState) and chosen.law.regularised,
    )


def _pulled(mechanism: Mechanism) -> TowedBlock:
    """Return the mechanism if a spring alone pulls it."""
    if isinstance(mechanism, TowedBlock) and not mechanism.damping and mechanism.modulation is None:
        return mechanism
    raise InputError(
        "a rate-and-state fit needs a TowedBlock without damping and modulation, whose stiffness is"
        f" that of spring and machine, got {mechanism!r}."
    )


def _unknowns(asked: _Asked, record: Record, *, drift: bool, lowest: float) -> FreeParameters:
    held = dict(asked.held)
    if STIFFNESS in held:
        held[STIFFNESS] /= record.load
    return unknowns_for(
        record,
        asked.form,
        drift=drift,
        lowest_evolution_effect=lowest,
        held=held,
        given=asked.given,
        reference_velocity=record.speed if asked.reference is None else asked.reference,
    )


def _used(
    measurement: Measurement, block: TowedBlock, before: float | None, after: float | None
) -> Record:
    record = record_of(measurement, block.steady_load).within(before, after)
    if not len(record.path.steps) or len(record.time) < FEWEST:
        ways = {"before the first": before, "after the last": after}
        parts = [f"{quantity(x, 'm')} {where}" for where, x in ways.items() if x is not None]
        within = f" within {joined(parts)} step" if parts else ""
        raise InputError(
            f"there are {len(record.time)} samples{within}, and a rate-and-state fit needs at least"
            f" {FEWEST}, on both sides of a step."
        )
    return record


def _tried(slider: Slider) -> Sequence[Array]:
    """Return starts with other critical distances; the first one has 0.01 of the way.

    Two states have each two of them, as both are alike.
    Those of a law with an effect of stress have none, and are starts of the ageing law.
    """
    items, slid = slider.free_parameters.items, slider.record.slid
    free = [item.low < item.high for item in items]
    tried = []
    pairs = combinations(DISTANCES, 2) if free[7] else ((share, share) for share in DISTANCES)
    for share, second in pairs:
        start = slider.free_parameters.start
        if free[2]:
            start[2] = share * slid
        if free[7]:
            start[7] = second * slid
        if free[STRESS] and all(free[:2]):
            start[:2] /= 1.0 + start[STRESS]
            start[1] = max(start[0] + slider.free_parameters.start[1]
                           - slider.free_parameters.start[0], items[1].low)  # fmt: skip
            start[STRESS] = items[STRESS].low
        if free[2] or free[7]:
            tried.append(start)
    return tried


def _in_order(slider: Slider, found: OptimizeResult) -> OptimizeResult:
    """Return the end of a search with the state of the shorter distance first, if all are free."""
    first, other = [EVOLVED, EVOLVED + 1], [SECOND, SECOND + 1]
    items, values = slider.free_parameters.items, found.best.values.copy()
    free = all(items[i].low < items[i].high for i in (*first, *other))
    if not free or values[first[1]] <= values[other[1]] or not items[1].low <= values[SECOND]:
        return found
    values[[*first, *other]] = values[[*other, *first]]
    return replace(found, best=slider.linearise(values))


def _drifting(
    slider: Slider,
    found: OptimizeResult,
    free_parameters: FreeParameters,
    watch: Watch | None,
    *,
    always: bool,
) -> tuple[Slider, OptimizeResult]:
    """Return problem and end with a drift, or those without if the data do not need it."""
    drifting = slider.with_free_parameters(free_parameters)
    ends = [search(drifting, starts=1 + len(DISTANCES), start_values=_tried(drifting), watch=watch)]
    carried = free_parameters.starting_at([*found.best.values, 0.0])
    ends.append(search(drifting.with_free_parameters(carried), starts=1, watch=watch))
    best = min(ends, key=lambda end: end.best.cost)
    if not always:
        width = inference_of(drifting, best.best).half_widths[
            drifting.free_parameters.paths.index(DRIFT)
        ]
        # a drift is kept if its interval leaves 0, and it saves what a parameter must
        sure = abs(best.best.values[-1]) > width
        if not sure or best.best.rms > (1.0 - THRESHOLDS.material) * found.best.rms:
            return slider, found
    return drifting, best


def _profile(slider: Slider, best: ResidualJacobian) -> Profile:
    """Return fits with other evolution effects held, as far as the record allows them."""
    items = slider.free_parameters.items
    if any(item.low == item.high for item in items[:3]):  # of a and b, one alone has no rival
        return Profile()
    values = best.values
    a, b = values[:2]
    room = best.cost * (1.0 + 4.0 / max(effective_size(best) - len(values), 4.0))
    least = max(items[1].low, 0.0)
    kept: list[ResidualJacobian] = []
    unbounded = True
    for tried in (
        [b + share * a for share in LARGER],
        [0.5 * (b + least), least] if b > least + THRESHOLDS.negligible * a else [],
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
    items = list(slider.free_parameters.starting_at(start).items)
    items[1] = replace(items[1], low=b, high=b)
    minute = start.copy()
    minute[2] = DISTANCES[0] * slider.record.slid
    held = slider.with_free_parameters(replace(slider.free_parameters, items=tuple(items)))
    try:
        return search(held, starts=2, start_values=[minute]).best
    except ConvergenceError:
        return None


def _windows(slider: Slider, best: ResidualJacobian) -> tuple[Window, ...]:
    """Return a - b with less of the record after the last step, and with all that was given."""
    if slider.free_parameters.items[0].low == slider.free_parameters.items[0].high:
        return ()
    whole = rate_of(slider, best)
    wider = whole[1] / whole[2] if whole[2] > 0.0 else math.inf
    found = []
    for share in FRACTIONS:
        record = slider.record.within(None, share * slider.record.after)
        if not len(record.path.steps) or len(record.time) < FEWEST:
            continue
        free_parameters = slider.free_parameters.starting_at(best.values)
        part = Slider.of(
            record,
            slider.form,
            free_parameters,
            slider.reference_velocity,
            regularised=slider.regularised,
        )
        rate, _, naive = rate_of(part, search(part, starts=3).best)
        found.append(Window(after=record.after, rate=rate, half_width=wider * naive))
    return (*found, Window(after=slider.record.after, rate=whole[0], half_width=whole[1]))
