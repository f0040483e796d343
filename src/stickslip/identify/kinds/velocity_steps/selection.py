"""Selection on velocity steps: every law fitted, judged on steps it has not seen, one named."""

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Checks, Measurement
from stickslip.errors import ConvergenceError, InputError, SimulationError
from stickslip.friction import RATE_STATE_FORMS, RateState, RateStateForm
from stickslip.identify import THRESHOLDS
from stickslip.identify.candidates import (
    LEFT_OUT,
    CrossValidation,
    Watch,
    as_good,
    check_apart,
    choose,
    effective_aic,
    held_out,
    watched,
)
from stickslip.identify.fits import LAW, Parameters, RecordSettings
from stickslip.identify.kinds.velocity_steps.fit import (
    STARTS,
    Drift,
    fit_rate_state,
    form_of,
    with_profile,
)
from stickslip.identify.kinds.velocity_steps.load_point import STRETCHES
from stickslip.identify.kinds.velocity_steps.result import SETTLED, RateStateFit, bounds_met
from stickslip.identify.kinds.velocity_steps.slider import simulate_velocity_steps
from stickslip.identify.kinds.velocity_steps.verdict import (
    OtherStep,
    RateStateCandidate,
    RateStateVerdict,
)
from stickslip.identify.kinds.velocity_steps.wording import outcomes, rate_state_wording
from stickslip.identify.selection import checked
from stickslip.mechanisms import Mechanism

Array: TypeAlias = NDArray[np.float64]
RateStateLaw: TypeAlias = RateState | type[RateState] | str
RateStateLaws: TypeAlias = Mapping[str, RateStateLaw] | Sequence[RateStateLaw]

FACTORS = (100.0, 10.0, 0.1, 0.01)
"""Steps of the speed that are looked at for what to measure next."""
USUAL = ("constant-coefficient", "logarithmic", "rate-and-state", "rate-and-state-slip")
"""Forms that are tried where none is named."""


@dataclass(frozen=True, kw_only=True)
class _Law:
    """A candidate before it is fitted."""

    name: str
    title: str
    law: RateStateLaw
    form: RateStateForm
    """Its form."""


def rate_state_laws(laws: RateStateLaws | RateStateLaw | None) -> tuple[_Law, ...]:
    """Return the candidates: those given, or the usual forms of rate-and-state friction.

    Examples
    --------
    >>> [one.name for one in rate_state_laws(None)]
    ['constant-coefficient', 'logarithmic', 'rate-and-state', 'rate-and-state-slip']
    """
    asked = USUAL if laws is None else laws
    given = (asked,) if isinstance(asked, str | type | RateState) else asked
    names = {form.title: name for name, form in RATE_STATE_FORMS.items()}
    pairs = (
        list(given.items())
        if isinstance(given, Mapping)
        else [(names[form_of(one).title], one) for one in given]
    )
    if not pairs:
        raise InputError("there is no friction law to try: give at least one in `laws`.")
    check_apart([name for name, _ in pairs])
    forms = [form_of(law) for _, law in pairs]
    return tuple(
        _Law(name=name, title=form.title, law=law, form=form)
        for (name, law), form in zip(pairs, forms, strict=True)
    )


def select_rate_state(
    mechanism: Mechanism,
    laws: RateStateLaws | RateStateLaw | None,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    validate: Measurement | None = None,
    settings: RecordSettings | None = None,
    progress: Watch | None = None,
    executor: Executor | None = None,
) -> RateStateVerdict:
    """Select a law for friction while a load point is pulled with steps of its speed.

    Each law is fitted to the whole record, and judged on every step by a fit that has not seen it;
    on parts of the record where there is one step only. Of the laws that predict as well as the
    best, the one with the fewest parameters is named, as for records.

    Parameters
    ----------
    mechanism : TowedBlock
        Stiffness of spring and machine, as in `fit_rate_state`.
    laws : mapping, sequence or a single RateState, type or str, or None
        The candidates; None stands for a constant coefficient, friction logarithmic in speed, and
        rate and state with the ageing and the slip law. The other forms of `RATE_STATE_FORMS` are
        tried if they are named.
    measurement : Measurement
        One record with ``time``, ``pull`` and ``friction``.
    vary : str or sequence of str, optional
        ``"friction.*"``, which is all if not given, and ``"mechanism.stiffness"``.
    fixed : mapping of str to float, optional
        Values of parameters of the mechanism that are held.
    validate : Measurement, optional
        A second record, which no fit sees; each law's error on it is reported.
    settings : RecordSettings, optional
        Number of starts and their seed.
    progress : callable, optional
        Called with the name of a law and the least residual so far; False ends the search with the
        best so far.
    executor : concurrent.futures.Executor, optional
        Fits laws at the same time, with the same result.

    Returns
    -------
    RateStateVerdict
        Candidates, the law to use, what the steps settle and what they cannot tell.

    Raises
    ------
    InputError
        If the record or the mechanism cannot be used.
    ConvergenceError
        If no law can be fitted.

    Examples
    --------
    >>> from stickslip import TowedBlock
    >>> t = np.arange(0.0, 60.0, 0.1)
    >>> pull = 1e-6 * np.interp(t, [0.0, 20.0, 40.0, 60.0], [0.0, 20.0, 220.0, 240.0])
    >>> noise = np.random.default_rng(0).normal(0.0, 1e-3, len(t))
    >>> record = Measurement(time=t, pull=pull, friction=0.6 + noise, load=1.0)
    >>> machine = TowedBlock(mass=1e-3, stiffness=2e3, speed=1e-6, load=1.0)
    >>> verdict = select_rate_state(machine, ["constant-coefficient", "logarithmic"], record)
    >>> verdict.best.name
    'constant-coefficient'
    """
    chosen = rate_state_laws(laws)
    parameters = Parameters.of(mechanism, None, vary, fixed, measurement=measurement)
    checks = checked(mechanism, measurement, validate)
    seed, starts = (0, STARTS) if settings is None else (settings.seed, settings.starts)
    work = partial(
        _candidate,
        mechanism=parameters.mechanism,
        measurement=measurement,
        vary=[LAW, *parameters.unknown],
        validate=validate,
        starts=starts,
        seed=seed,
    )
    # a drift is one of the record: what the richest law needs, all others are given too
    richest = max(chosen, key=lambda one: len(one.form.fit_order))
    first = work(richest, "auto", progress)
    drift: Drift = "linear" if first.fit is not None and first.fit.drift else "none"
    rest = [one for one in chosen if one is not richest]
    by_name = {first.name: first}
    if executor is None:
        by_name |= {one.name: work(one, drift, progress) for one in rest}
    else:
        with watched(executor, progress) as workers:
            for one in rest:
                workers.begin(one.name, work, one, drift)
            while workers.futures:
                by_name |= workers.ended()
    judged = [
        _among(by_name[one.name], [x for x in chosen if one.form.contains(x.form)])
        for one in chosen
    ]
    return _verdict(parameters.mechanism, measurement, judged, checks)


def _among(one: RateStateCandidate, simpler: Sequence[_Law]) -> RateStateCandidate:
    """Return a candidate that knows which of the others it contains, and which ones it is."""
    left = None if one.law is None else _acting(one.law)
    return replace(
        one,
        simpler=tuple(other.name for other in simpler),
        reduces_to=tuple(
            other.name for other in simpler if left is not None and left <= {*other.form.fit_order}
        ),
    )


def _acting(law: RateState) -> frozenset[str]:
    """Return the parameters that have an effect at the values of a law, named as in its forms."""
    if law.evolution == "none":
        return frozenset(RATE_STATE_FORMS[law.name].fit_order)
    acting = [one for one in law.states if abs(one[0]) >= THRESHOLDS.negligible * law.direct_effect]
    distances = [distance for _, distance in acting]
    count = len(acting)
    if count > 1 and max(distances) <= (1.0 + THRESHOLDS.negligible) * min(distances):
        count = 1  # they evolve alike
    effects = (
        ("evolution_effect", "critical_distance"),
        (
            "second_evolution_effect",
            "second_critical_distance",
        ),
    )
    stress = {"stress_effect"} if law.stress_effect >= THRESHOLDS.negligible else set()
    return frozenset({"reference_coefficient", "direct_effect", *stress}.union(*effects[:count]))


def _candidate(
    one: _Law,
    drift: Drift,
    watch: Watch | None,
    *,
    mechanism: Mechanism,
    measurement: Measurement,
    vary: Sequence[str],
    validate: Measurement | None,
    starts: int,
    seed: int,
) -> RateStateCandidate:
    """Fit and judge one candidate; one that cannot be fitted is kept with the reason."""
    found = RateStateCandidate(name=one.name, title=one.title, fit=None)
    if watch is not None and watch(one.name, math.nan) is False:
        return replace(found, dropped=LEFT_OUT)
    report = None if watch is None else (lambda rms: watch(one.name, rms))
    try:
        fit = fit_rate_state(
            mechanism,
            one.law,
            measurement,
            vary=vary,
            drift=drift,
            starts=starts,
            seed=seed,
            profile=False,
            progress=report,
        )
    except (ConvergenceError, SimulationError) as error:
        return replace(found, dropped=str(error))
    found = replace(found, fit=fit, second=None if validate is None else fit.judged(validate))
    try:
        unseen = unseen_of(fit, None if watch is None else partial(_told_of_parts, watch, one.name))
    except ConvergenceError as error:
        return replace(found, dropped=f"not judged: without a held-out part, {error}")
    slider = fit.problem
    validation = CrossValidation.by_segment(unseen, slider.segments, slider.weight)
    if not math.isfinite(validation.score):
        return replace(found, dropped="not judged: the slider runs away in a held-out part")
    symbols = ", ".join(f"${symbol}$" for symbol in bounds_met(fit))
    return replace(
        found,
        validation=validation,
        unseen=unseen,
        dropped=f"{symbols} at the end of the range that was searched" if symbols else "",
    )


def _told_of_parts(watch: Watch, name: str, part: int, parts: int) -> None:
    watch(f"held-out steps: {name}, {part} of {parts}", math.nan)


def unseen_of(fit: RateStateFit, told: Callable[[int, int], object] | None = None) -> Array:
    """Return what fits leave that have not seen it: each velocity step is held out in turn.

    The law runs over the whole record, as the load point was moved; what is held out is not
    compared. Of a record with a single step, parts with equally many samples are held out.
    """
    slider = fit.problem
    held = np.unique(slider.segments).tolist()[1:] if slider.by_steps else None
    return held_out(slider, fit.best, held, told) / slider.weight


def _verdict(
    mechanism: Mechanism,
    measurement: Measurement,
    judged: Sequence[RateStateCandidate],
    checks: Checks,
) -> RateStateVerdict:
    scored = [one for one in judged if one.validation is not None]
    if not scored:
        raise ConvergenceError(
            "no candidate can be judged on this record: "
            + "; ".join(f"{one.title}: {one.dropped}" for one in judged)
        )
    chosen = choose(scored)
    assert chosen.fit is not None
    others = sorted((one for one in judged if one is not chosen), key=lambda one: one.score)
    closest = replace(chosen, fit=with_profile(chosen.fit))
    assert closest.fit is not None
    rival = _rival(closest, [one for one in others if one.validation])
    fault = _unexplained(closest)
    ordered = outcomes([closest, *others], rival, recommended=not fault)
    steps = () if rival is None else _other_steps(closest, rival)
    by_steps = closest.fit.problem.by_steps
    return RateStateVerdict(
        mechanism=mechanism,
        measurement=measurement,
        words=rate_state_wording(ordered, rival, steps, checks, fault=fault, by_steps=by_steps),
        candidates=tuple(ordered),
        best=None if fault else ordered[0],
        not_recommended=ordered[0] if fault else None,
        ranked=len(ordered) > 1 and rival is None,
        checks=checks,
        by_steps=by_steps,
        rival=rival.name if rival else "",
        next_steps=steps,
    )


def _rival(
    closest: RateStateCandidate, others: Sequence[RateStateCandidate]
) -> RateStateCandidate | None:
    """Return the nearest law that neither contains the closest, nor is contained, nor is worse."""
    criteria = effective_aic([closest, *others])
    decisive = 2.0 * math.log(THRESHOLDS.odds)
    for one in others:
        nested = one.name in closest.simpler or closest.name in one.simpler
        worse = criteria[one.name] - criteria[closest.name] > decisive
        if as_good(one, closest) and not (nested or worse or one.dropped):
            return one
    return None


def _unexplained(closest: RateStateCandidate) -> str:
    """Return in what the record contradicts even the closest law; empty if it does not."""
    assert closest.fit is not None
    variation = float(np.std(closest.fit.problem.mean))
    # a constant coefficient predicts no variation, which may be noise alone; so may be most of it
    constant = closest.fit.law.name == "constant-coefficient"
    if constant or closest.score <= THRESHOLDS.explained * variation or not closest.fit.misses:
        return ""
    return "its held-out error is more than half of the variation of friction itself"


def _other_steps(closest: RateStateCandidate, rival: RateStateCandidate) -> tuple[OtherStep, ...]:
    """Return steps after which two fitted laws part, the most telling first."""
    assert closest.fit is not None
    assert rival.fit is not None
    first = closest.fit.problem.record.speed
    distances = [x for one in (closest, rival) if one.law for _, x in one.law.states]
    way = SETTLED * max(distances, default=0.0)
    found = []
    for factor in FACTORS:
        if not way > 0.0:
            break
        after = factor * first
        lead, last = way / first, way / after
        at = np.linspace(lead, lead + last, STRETCHES)
        try:
            one, other = (
                simulate_velocity_steps(
                    c.fit.law,
                    stiffness=c.fit.stiffness,
                    time=[0.0, lead, lead + last],
                    pull=[0.0, way, 2.0 * way],
                    at=at,
                ).coefficient
                for c in (closest, rival)
                if c.fit is not None
            )
        except SimulationError:
            continue
        gap = float(np.sqrt(np.mean((one - other) ** 2)))
        found.append(OtherStep(before=first, after=after, separation=gap))
    return tuple(sorted(found, key=lambda one: -one.separation))
