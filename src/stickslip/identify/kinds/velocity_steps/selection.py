"""Selection on velocity steps: all laws weighed by one posterior, the most probable named."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from stickslip.data import Checks, Measurement
from stickslip.errors import ConvergenceError, InputError
from stickslip.friction import RATE_STATE_FORMS, RateState
from stickslip.identify import THRESHOLDS
from stickslip.identify.candidates import Watch, check_apart
from stickslip.identify.fits import LAW, Parameters, RecordSettings
from stickslip.identify.judgement import RIVAL
from stickslip.identify.kinds.velocity_steps.fit import (
    STARTS,
    RateStateLaw,
    asked_of,
    form_of,
    problem_of,
    used,
)
from stickslip.identify.kinds.velocity_steps.result import result_of
from stickslip.identify.kinds.velocity_steps.verdict import RateStateCandidate, RateStateVerdict
from stickslip.identify.kinds.velocity_steps.wording import outcomes, rate_state_wording
from stickslip.identify.problems.velocity_steps import VelocitySteps
from stickslip.identify.selection import checked
from stickslip.identify.simulated import SimulatedPosterior
from stickslip.mechanisms import Mechanism, TowedBlock

RateStateLaws: TypeAlias = Mapping[str, RateStateLaw] | Sequence[RateStateLaw]

USUAL = (
    "constant-coefficient", "logarithmic", "rate-and-state", "rate-and-state-slip",
    "rate-and-state-nagata", "rate-and-two-states", "rate-and-two-states-slip",
)  # fmt: skip
"""Forms that are compared where none is named."""


def rate_state_laws(laws: RateStateLaws | RateStateLaw | None) -> Mapping[str, RateStateLaw]:
    """Return the candidates by name: those given, or the usual forms of rate-and-state friction.

    Examples
    --------
    >>> [*rate_state_laws(None)][:3]
    ['constant-coefficient', 'logarithmic', 'rate-and-state']
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
    for _, law in pairs:
        form_of(law)
    return dict(pairs)


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
) -> RateStateVerdict:
    """Select a law for friction while a load point is pulled with steps of its speed.

    All laws are weighed by one posterior (`stickslip.identify.simulated`): the probability of the
    record by each, over all values of its parameters, of the stiffness of the machine and of what
    changes along the way. The most probable law is named.

    Parameters
    ----------
    mechanism : TowedBlock
        Stiffness of spring and machine, as in `fit_rate_state`.
    laws : mapping, sequence or a single RateState, type or str, or None
        The candidates; None stands for a constant coefficient, friction logarithmic in speed, and
        rate and state with the ageing and the slip law, each with one and two states, and with the
        law of Nagata. The other forms of `RATE_STATE_FORMS` are tried if they are named.
    measurement : Measurement
        One record with ``time``, ``pull`` and ``friction``.
    vary : str or sequence of str, optional
        ``"friction.*"``, which is all if not given, and ``"mechanism.stiffness"``.
    fixed : mapping of str to float, optional
        Values of parameters of the mechanism that are held.
    validate : Measurement, optional
        A second record, which no fit sees; each law's error on it is reported.
    settings : RecordSettings, optional
        Number of searches that are followed to their end, and the seed of the draws.
    progress : callable, optional
        Called with the name of a law and the least residual so far; False ends the search with the
        best so far.

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
    >>> import numpy as np
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
    checks = checked(mechanism, measurement, validate)
    seed, starts = (0, STARTS) if settings is None else (settings.seed, settings.starts)
    unknown = Parameters.of(mechanism, None, vary, fixed, measurement=measurement).unknown
    # of an instance, all its form has is looked for, from its values
    asked = asked_of(mechanism, chosen, measurement, [LAW, *unknown], fixed)
    block = asked[0].block
    problem = problem_of(dict(zip(chosen, asked, strict=True)), used(measurement, block))
    posterior = SimulatedPosterior(problem, starts=starts, seed=seed, watch=progress)
    return _verdict(mechanism, block, measurement, problem, posterior, validate, checks)


def _candidate(
    name: str,
    block: TowedBlock,
    measurement: Measurement,
    problem: VelocitySteps,
    posterior: SimulatedPosterior,
    validate: Measurement | None,
) -> RateStateCandidate:
    """Return a candidate with its fit; one that cannot be fitted is kept with the reason."""
    title, share = problem.laws[name].form.title, posterior.shares[name]
    try:
        fit = result_of(name, block, measurement, problem, posterior)
    except ConvergenceError as error:
        return RateStateCandidate(name=name, title=title, fit=None, share=0.0, dropped=str(error))
    second = None if validate is None else fit.judged(validate)
    return RateStateCandidate(name=name, title=title, fit=fit, share=share, second=second)


def _verdict(
    mechanism: Mechanism,
    block: TowedBlock,
    measurement: Measurement,
    problem: VelocitySteps,
    posterior: SimulatedPosterior,
    validate: Measurement | None,
    checks: Checks,
) -> RateStateVerdict:
    every = [
        _candidate(name, block, measurement, problem, posterior, validate) for name in problem.laws
    ]
    if all(one.fit is None for one in every):
        raise ConvergenceError(
            "no candidate can be judged on this record: " + "; ".join(one.dropped for one in every)
        )
    ordered = sorted(every, key=lambda one: -one.share)
    closest, rival = ordered[0], _rival(ordered)
    fault = _unexplained(closest)
    told = outcomes(ordered, rival, recommended=not fault)
    return RateStateVerdict(
        mechanism=mechanism,
        measurement=measurement,
        words=rate_state_wording(told, rival, checks, fault=fault),
        candidates=tuple(told),
        best=None if fault else told[0],
        ranked=len(told) > 1 and rival is None,
        checks=checks,
        rival=rival.name if rival else "",
    )


def _rival(ordered: Sequence[RateStateCandidate]) -> RateStateCandidate | None:
    """Return the most probable law that may hold instead of the first, and not just with more."""
    closest = ordered[0]
    for one in ordered[1:]:
        assert closest.fit is not None
        if one.share * RIVAL <= closest.share or one.fit is None:
            return None
        form, own = (each.problem.laws[each.name].form for each in (one.fit, closest.fit))
        if not form.contains(own):
            return one
    return None


def _unexplained(closest: RateStateCandidate) -> str:
    """Return in what the record contradicts even the closest law; empty if it does not."""
    fit = closest.fit
    assert fit is not None
    variation = float(fit.problem.measured.std())
    # a constant coefficient predicts no variation, which may be noise alone; so may be most of it
    constant = fit.law.name == "constant-coefficient"
    if constant or fit.rms <= THRESHOLDS.explained * variation or not fit.misses:
        return ""
    return "what it leaves is more than half of the variation of friction itself"
