"""Rate-and-state parameters from a record of velocity steps, and which of them it can tell."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from stickslip.data import Measurement
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import RATE_STATE_FORMS, RateState, RateStateForm
from stickslip.identify.fits import (
    BLOCKS,
    LAW,
    Parameters,
    Watch,
    check_given,
    check_varied,
)
from stickslip.identify.kinds.velocity_steps.result import RateStateFit, result_of
from stickslip.identify.problems.velocity_steps import (
    PRIORS,
    STIFFNESS,
    UNKNOWN,
    Record,
    SteppedLaw,
    VelocitySteps,
    record_of,
)
from stickslip.identify.simulated import SimulatedPosterior
from stickslip.mechanisms import Mechanism, TowedBlock
from stickslip.show.formatting import joined, quantity

Drift: TypeAlias = Literal["auto", "none", "linear"]
RateStateLaw: TypeAlias = RateState | type[RateState] | str

MACHINE_STIFFNESS = "mechanism.stiffness"
CONVENTION = "friction.reference_velocity"
"""The speed at which mu_0 holds: any will do, and none can be fitted."""
STARTS = 4
"""Searches of each law that are followed to their end."""
FEWEST = 3 * BLOCKS
"""Samples that a fit needs."""


def fit_rate_state(
    mechanism: Mechanism,
    law: RateStateLaw,
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
    progress: Watch | None = None,
) -> RateStateFit:
    """Fit rate-and-state friction to a record with steps of the speed of the load point.

    The slider has no inertia and slides steadily at first. Intervals are those of the posterior
    (`stickslip.identify.problems.velocity_steps` has the priors): the stiffness of the machine, a
    change of friction along the way and a level are always in it. Whether a and b can be told apart
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
        of the law. The stiffness of the machine is known to 30 %, or to the uncertainty that the
        measurement states of ``"mechanism.stiffness"``; named here, to a factor of ten.
    fixed : mapping of str to float, optional
        Values of parameters that are held, of law and mechanism: ``stiffness`` too, if it is exact.
    before, after : float, optional
        Way of the load point [m] before the first and after the last step that is used; all if not
        given.
    drift : {"auto", "none", "linear"}
        What friction may do along the way beside the law: change linearly and settle, as far as the
        record has it, nothing, or change linearly.
    lowest_evolution_effect : float
        Lower bound of b. The laws were made for b of at least 0; below, friction goes on rising
        after a step.
    starts, seed : int
        Number of searches that are followed to their end, and seed of the draws.
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
    >>> import numpy as np
    >>> t = np.arange(0.0, 60.0, 0.1)
    >>> pull = 1e-6 * np.where(t < 20.0, t, 20.0 + 10.0 * (t - 20.0))
    >>> run = simulate_velocity_steps(truth, stiffness=2e3, time=t, pull=pull)
    >>> noise = np.random.default_rng(0).normal(0.0, 3e-4, len(t))
    >>> record = Measurement(time=t, pull=pull, friction=run.coefficient + noise, load=1.0)
    >>> machine = TowedBlock(mass=1e-3, stiffness=2e3, speed=1e-6, load=1.0)
    >>> fitted = fit_rate_state(machine, "rate-and-state", record)
    >>> fitted.separable, abs(fitted.law.direct_effect - 0.010) < 5e-4
    (True, True)
    """
    check_given("fit_rate_state", mechanism, measurement)
    if drift not in ("auto", "none", "linear"):
        raise InputError(f"drift must be 'auto', 'none' or 'linear', got {drift!r}.")
    form = form_of(law)
    name = next(key for key, one in RATE_STATE_FORMS.items() if one is form)
    (asked,) = asked_of(mechanism, {name: law}, measurement, vary, fixed)
    problem = problem_of(
        {name: asked},
        used(measurement, asked.block, before, after),
        drift=drift,
        lowest=lowest_evolution_effect,
    )
    posterior = SimulatedPosterior(
        problem,
        starts=starts,
        seed=seed,
        watch=None if progress is None else lambda _, rms: progress(rms),
    )
    return result_of(name, asked.block, measurement, problem, posterior)


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
class Asked:
    """What is looked for of a law and what is held."""

    block: TowedBlock
    law: SteppedLaw
    doubt: float
    """Prior deviation of the logarithm of the stiffness; 0 if it is held."""
    reference: float | None
    """Speed at which the reference coefficient holds [m/s]; None for the first of the record."""


def asked_of(
    mechanism: Mechanism,
    laws: Mapping[str, RateStateLaw],
    measurement: Measurement,
    vary: str | Sequence[str] | None,
    fixed: Mapping[str, float] | None,
) -> tuple[Asked, ...]:
    """Return what is looked for of each law."""
    return tuple(_asked(mechanism, law, measurement, vary, fixed) for law in laws.values())


def _asked(
    mechanism: Mechanism,
    law: RateStateLaw,
    measurement: Measurement,
    vary: str | Sequence[str] | None,
    fixed: Mapping[str, float] | None,
) -> Asked:
    form = form_of(law)
    kind = RateState if isinstance(law, str) else law
    chosen = Parameters.of(_pulled(mechanism), kind, vary, fixed, measurement=measurement)
    usual = [f"friction.{name}" for name in form.fit_order]
    known = {f"friction.{name}": value for name, value in chosen.known.items()}
    named = (LAW,) if chosen.free is None else chosen.free
    free = {path for path in usual if path not in known} if LAW in named else set()
    free |= set(named) - {LAW}
    others = [path for path in chosen.unknown if path != MACHINE_STIFFNESS]
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
    block = _pulled(chosen.mechanism)
    doubt = _doubt(block, chosen, measurement)
    check_varied(bool(free) or doubt > 0.0)
    return Asked(
        block=block,
        law=SteppedLaw(
            form=form,
            held={path.partition(".")[2]: own[path] for path in usual if path not in free},
            given={path.partition(".")[2]: x for path, x in own.items() if path in free},
            regularised=isinstance(chosen.law, RateState) and chosen.law.regularised,
        ),
        doubt=doubt,
        reference=own.get(CONVENTION),
    )


def _doubt(block: TowedBlock, chosen: "Parameters[Any]", measurement: Measurement) -> float:
    """Return the prior deviation of the logarithm of the stiffness."""
    stated = dict(measurement.parameter_uncertainties)
    spread = stated.pop(MACHINE_STIFFNESS, None)
    if stated:
        raise InputError(
            f"the uncertainty of {next(iter(stated))} does not enter rate-and-state fits, only that"
            f" of {MACHINE_STIFFNESS}: leave it out."
        )
    if MACHINE_STIFFNESS in chosen.unknown:
        return UNKNOWN
    if MACHINE_STIFFNESS in chosen.held:
        return 0.0
    return PRIORS[STIFFNESS][1] if spread is None else math.log1p(spread / block.stiffness)


def _pulled(mechanism: Mechanism) -> TowedBlock:
    """Return the mechanism if a spring alone pulls it."""
    if isinstance(mechanism, TowedBlock) and not mechanism.damping and mechanism.modulation is None:
        return mechanism
    raise InputError(
        "a rate-and-state fit needs a TowedBlock without damping and modulation, whose stiffness is"
        f" that of spring and machine, got {mechanism!r}."
    )


def problem_of(
    asked: Mapping[str, Asked], record: Record, *, drift: Drift = "auto", lowest: float = 0.0
) -> VelocitySteps:
    """Return a record as rows with the laws that it is compared with, by name."""
    first = next(iter(asked.values()))
    return VelocitySteps(
        record,
        {name: one.law for name, one in asked.items()},
        stiffness=first.block.stiffness / record.load,
        doubt=first.doubt,
        reference=record.speed if first.reference is None else first.reference,
        drift=drift,
        lowest=lowest,
    )


def used(
    measurement: Measurement,
    block: TowedBlock,
    before: float | None = None,
    after: float | None = None,
) -> Record:
    """Return what is used of a record, from before its first to after its last step."""
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
