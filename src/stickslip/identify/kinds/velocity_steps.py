"""Velocity steps of a load point: a slider without inertia behind a spring.

The rows are the coefficient of friction in time (`stickslip.identify.problems.velocity_steps`).
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from stickslip.data import Measurement
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import RATE_STATE_FORMS, RateState, RateStateForm
from stickslip.identify import THRESHOLDS
from stickslip.identify.bands import ENDS, Array
from stickslip.identify.candidates import check_any, check_apart
from stickslip.identify.fits import (
    BLOCKS,
    LAW,
    Estimate,
    Parameters,
    RecordSettings,
    check_given,
    check_varied,
)
from stickslip.identify.judgement import is_asserted
from stickslip.identify.kinds.kind import Column, Request, SeveralLaws
from stickslip.identify.kinds.simulated import (
    AnyFit,
    OtherSetting,
    SimulatedCandidate,
    SimulatedKind,
)
from stickslip.identify.problems.run_laws import UNKNOWN
from stickslip.identify.problems.velocity_step_paths import SHORTEST, STRAIGHT, Path, differ
from stickslip.identify.problems.velocity_steps import (
    DIRECT,
    EVOLVED,
    PRIORS,
    STIFFNESS,
    SteppedLaw,
    VelocitySteps,
    path_of_parameter,
    record_of,
)
from stickslip.identify.propose import width_after
from stickslip.identify.simulated import ENOUGH, WHITE
from stickslip.mechanisms import Mechanism, TowedBlock
from stickslip.show.formatting import (
    fixed,
    joined,
    number,
    quantity,
    ratio,
    significant,
)

Drift: TypeAlias = Literal["auto", "none", "linear"]
RateStateLaw: TypeAlias = RateState | type[RateState] | str

VELOCITY_STEPS = "rate-state"
USUAL = (
    "constant-coefficient", "logarithmic", "rate-and-state", "rate-and-state-slip",
    "rate-and-state-nagata", "rate-and-two-states", "rate-and-two-states-slip",
)  # fmt: skip
"""Forms that are compared where none is named."""
CONVENTION = "friction.reference_velocity"
"""The speed at which mu_0 holds: any will do, and none can be fitted."""
FEWEST = 3 * BLOCKS
"""Samples that a fit needs."""
SEPARATE = 0.3
"""a and b are told apart where the half widths of both intervals are below this share."""
SETTLED = 8.0
"""Way over which friction settles after a step, in critical distances: a change by e^-8 is left."""

STEPS, STIFFER = 10.0, (3.0, 10.0)
"""Speed of a further step beyond those measured, and stiffnesses of other machines, over theirs."""
ROWS = 20
"""Rows after each further step, over its way and from a share 1/ROWS^2 of it."""


def _rate_of(one: SimulatedCandidate) -> Estimate | None:
    return one.fit.derived[0] if one.fit and one.fit.derived else None


class VelocityStepKind(SimulatedKind):
    """A slider without inertia behind a spring, fitted to the coefficient of friction."""

    routes = (VELOCITY_STEPS,)
    measured = "velocity steps"
    content = "velocity steps"
    settings = frozenset({"starts", "seed"})
    fits = RateState
    usual_law = "rate-and-state"
    simulated = False
    levels = "per load"
    drawn = ("coefficient", "1")
    own_columns = (
        Column(
            key="a_minus_b", title="a − b", page="a − b\n95 % interval", phone="label",
            value=lambda item: getattr(_rate_of(item), "value", None),
            text=lambda item: getattr(_rate_of(item), "parts", None),
        ),
    )  # fmt: skip

    def __init__(
        self, *, before: float | None = None, after: float | None = None, drift: Drift = "auto",
        lowest: float = 0.0,
    ) -> None:  # fmt: skip
        """Take how much of a record is used, what friction may do beside a law, and the least b."""
        if drift not in ("auto", "none", "linear"):
            raise InputError(f"drift must be 'auto', 'none' or 'linear', got {drift!r}.")
        self.before, self.after, self.drift, self.lowest = before, after, drift, lowest

    def residual_text(self, error: float, request: Request) -> str:
        return f"coefficient off by {number(error, 2)}"

    # what is measured
    def laws(self, laws: SeveralLaws | None) -> Mapping[str, Any]:
        given = USUAL if laws is None else laws
        names = {form.title: name for name, form in RATE_STATE_FORMS.items()}
        pairs = (
            list(given.items())
            if isinstance(given, Mapping)
            else [(names[form_of(item).title], item) for item in given]
        )
        check_any(pairs)
        check_apart([name for name, _ in pairs])
        for _, law in pairs:
            form_of(law)
        return dict(pairs)

    def problem(
        self, request: Request, laws: Mapping[str, Any], vary: str | Sequence[str] | None
    ) -> VelocitySteps:
        measurement, pulled = request.measurement, _pulled(request.mechanism)
        result, references = dict[str, SteppedLaw](), list[float | None]()
        for name, law in laws.items():
            kind = RateState if isinstance(law, str) else law
            chosen = Parameters.of(pulled, kind, vary, request.fixed, measurement=measurement)
            block, doubt = _pulled(chosen.mechanism), _doubt(chosen, measurement)
            result[name], reference = _stepped(form_of(law), chosen, doubt)
            references.append(reference)
        record = record_of(measurement, block.steady_load).within(self.before, self.after)
        if not len(record.path.steps) or len(record.time) < FEWEST:
            ways = {"before the first": self.before, "after the last": self.after}
            parts = [f"{quantity(x, 'm')} {where}" for where, x in ways.items() if x is not None]
            within = f" within {joined(parts)} step" if parts else ""
            raise InputError(
                f"there are {len(record.time)} samples{within}, and a rate-and-state fit needs at"
                f" least {FEWEST}, on both sides of a step."
            )
        return VelocitySteps(
            record,
            result,
            block=block,
            doubt=doubt,
            reference=record.speed if references[0] is None else references[0],
            drift=self.drift,
            lowest=self.lowest,
        )

    def errors(self, fit: AnyFit, measurement: Measurement) -> Mapping[str, float]:
        record = record_of(measurement, fit.problem.record.load)
        left = record.coefficient - fit.problem.foreseen(fit.family, fit.name, record)
        error = float(np.sqrt(np.mean(left**2)))
        return {"coefficient": error if math.isfinite(error) else math.inf}

    # seven texts
    def called(self, fit: AnyFit) -> str:
        return RATE_STATE_FORMS[fit.law.name].words

    def fault(self, fit: AnyFit) -> str:
        variation = float(fit.problem.measured.std())
        # a constant coefficient predicts no variation, which may be noise alone; so may be most
        constant = fit.law.name == "constant-coefficient"
        if constant or fit.rms <= THRESHOLDS.explained * variation or not misses(fit):
            return ""
        return "leaves more than half of the variation of friction itself"

    def doubt(self, fit: AnyFit) -> str:
        if over_scatter(fit) > THRESHOLDS.misfit:
            return (
                f"its residuals are {ratio(over_scatter(fit))} the scatter of neighbouring samples"
            )
        if misses(fit):
            return (
                "its residuals are not noise of single samples (effective sample size"
                f" {_effective(fit)})"
            )
        return ""

    def about(self, fit: AnyFit) -> str:
        text = (
            "The root mean square of its residuals is"
            f" {number(fit.rms, 2)} in the coefficient of friction."
        )
        if fit.law.name == "constant-coefficient":
            text += " No effect of speed is established."
        for rate in fit.derived:
            sign = "either sign is possible"
            if rate.low > 0.0:
                sign = "friction grows with speed, and steady sliding is stable"
            elif rate.high < 0.0:
                sign = "friction falls with speed, and stick-slip is possible on soft springs"
                if fit.details["separable"]:
                    least = fit.law.critical_stiffness * fit.problem.record.load
                    sign += f", softer than {quantity(least, 'N/m', 2)}"
            text += f" ${rate.quantity.symbol}$ = {rate.plus_minus}: {sign}."
        if fit.law.states and fit.derived and not fit.details["separable"]:
            text += " Only this difference is identified."
        if fit.details["drifts"]:
            ends = fit.problem.along(np.array([0.0, fit.problem.record.path.time[-1]]))
            first, last = ends @ fit.family.usual + (fit.problem.level or 0.0)
            text += (
                " Friction also drifts, whatever the speed: from"
                f" {number(first, 4)} at its beginning to {number(last, 4)} at its end."
            )
        return text

    def untold(self, fit: AnyFit) -> Iterator[str]:
        result, path = {estimate.path for estimate in fit.estimates}, fit.problem.record.path
        if {path_of_parameter(DIRECT), path_of_parameter(EVOLVED)} <= result:
            correlation = fixed(fit.details["correlation_a_b"], 2)
            if not fit.details["separable"]:
                yield (
                    "$a$ and $b$: larger and smaller ones of the same difference fit as well"
                    f" (correlation {correlation})."
                )
        if path_of_parameter(STIFFNESS) in result and fit.family.is_prior(STIFFNESS):
            yield "The stiffness of the machine: its interval is that of what was stated."
        if len(path.steps) == 1:
            yield "How well the law predicts another step: there is only one."
        if misses(fit):
            yield (
                "What else acts: the residuals are autocorrelated, with an effective sample size of"
                f" {_effective(fit)}."
            )
        yield from _of_mass(fit)

    def advice(
        self, fit: AnyFit, others: Sequence[AnyFit], advised: Sequence[Any]
    ) -> Iterator[str]:
        law, path = fit.law, fit.problem.record.path
        tried = {item.form.title for item in fit.problem.laws.values()}
        rest = [name for name, form in RATE_STATE_FORMS.items() if form.title not in tried]
        if rest and misses(fit):
            yield f"First compare the forms that were not tried, {joined(rest)}, by naming them."
        if not advised:
            unknown = "which law holds" if others else "its parameters"
            yield f"Further steps are not expected to determine {unknown} better."
        for item in advised[:1]:
            new = item.name == "stiffness"
            begun, again = stepped_speeds(path)
            speeds = begun, again if new else item.value
            first, last = (quantity(speed, "m/s", 2) for speed in speeds)
            machine = f", with a machine of {quantity(item.value, 'N/m', 2)}" if new else ""
            yield (
                f"{'Make' if new else 'Go on with'} steps from {first} to {last} and back over the"
                f" same ways{machine}: {item.expectation(others)}."
            )
        fastest = float(path.lasting.max())
        interval = float(np.median(np.diff(fit.problem.record.time)))
        shortest = min((distance for _, distance in law.states), default=0.0)
        if law.states and interval * fastest * SHORTEST > shortest:
            wanted = shortest / fastest / SHORTEST
            name = "D_c" if shortest == law.critical_distance else "D_2"
            yield (
                f"Samples every {quantity(wanted, 's', 2)} or less after a step to"
                f" {quantity(fastest, 'm/s')}: {name} is slid in"
                f" {quantity(SHORTEST * wanted, 's', 2)}."
            )
        if fit.details["drifts"]:
            yield "A longer way before the first step, until friction no longer drifts."

    # further numbers and figures
    def advised(self, fits: Sequence[AnyFit]) -> Sequence[OtherSetting]:
        """Return what further steps would tell of laws, the most telling first.

        From the first speed the load point steps to another one and back, over the way between
        steps each time, with as many samples each time as between steps of the record. The level of
        friction, and its change along the way, are those of each record.
        """
        problem: VelocitySteps = fits[0].problem
        path, stiffness = problem.record.path, _pulled(fits[0].mechanism).stiffness
        begun, again = stepped_speeds(path)
        moving = path.lasting[path.lasting > STRAIGHT * path.lasting.max()]
        speeds = {again, STEPS * float(moving.max()), float(moving.min()) / STEPS} - {begun}
        settings = [("speed", speed, speed, 1.0) for speed in sorted(speeds)]
        if again != begun:
            settings += [("stiffness", x * stiffness, again, x) for x in STIFFER]
        rng, result = np.random.default_rng(13), []
        shares = [fit.posterior.shares[fit.name] for fit in fits]
        for name, value, speed, stiffer in settings:
            knots = np.cumsum([0.0, *(problem.way / np.array([begun, speed, begun]))])
            seen, last = list[Array](), dict[str, dict[str, float]]()
            steps = Path(time=knots, position=problem.way * np.arange(4.0))
            slid = np.geomspace(ROWS**-2.0, 1.0, ROWS)
            times = np.concatenate([knots[k] + slid * (knots[k + 1] - knots[k]) for k in (1, 2)])
            trend = np.column_stack(
                [np.ones(len(times)), np.interp(times, steps.time, steps.position)]
            )
            counts = np.tile(np.gradient(slid), 2) * len(problem.record.time) / len(path.lasting)
            noise = fits[0].rms / np.sqrt(fits[0].posterior.kappa * counts)
            beside = np.linalg.svd(trend / noise[:, None])[0][:, 2:]
            for fit in fits:
                chosen = np.linspace(0, len(fit.family.points) - 1, int(ENOUGH)).astype(np.intp)
                runs = problem.stepped(fit.name, fit.family.points[chosen], steps, times, stiffer)
                works = np.isfinite(runs).all(axis=0)
                if np.mean(works) > 0.8:
                    read = runs[:, works] / noise[:, None]
                    seen.append((read + rng.normal(size=read.shape)).T @ beside)
                    last[fit.name] = {"coefficient": float(np.median(runs[ROWS - 1, works]))}
                    points = fit.family.points[chosen][works]
            if len(seen) == len(fits):  # where a slider runs away, there is no record
                result.append(OtherSetting(name, value, last, width_after(points, seen, shares)))
        return tuple(sorted(result, key=lambda item: item.expected_width))

    def details(self, fit: AnyFit) -> Mapping[str, Any]:
        result = {estimate.path: estimate for estimate in fit.estimates}
        both = [
            result[path] for path in map(path_of_parameter, (DIRECT, EVOLVED)) if path in result
        ]
        correlation = 0.0
        if len(both) == 2 and {DIRECT, EVOLVED} <= {*fit.family.unknowns.names}:
            correlation = float(np.corrcoef([fit.draws[item.path] for item in both])[0, 1])
        drifts, way = _drifts(fit), float(fit.problem.record.path.position[-1])
        return {
            "evolution": fit.law.evolution,
            "reference_velocity": fit.law.reference_velocity,
            "a_minus_b": fit.derived[0].to_dict() if fit.derived else None,
            "stiffness_over_load": _stiffness(fit),
            "drifts": drifts,
            "drift": _change(fit)[1] / way if drifts else 0.0,
            "correlation_a_b": correlation,
            "separable": len(both) == 2
            and all(item.half_width < SEPARATE * abs(item.value) for item in both),
            "samples": len(fit.problem.record.time),
        }

    def largest_speed(self, fit: AnyFit) -> float:
        return float(fit.problem.record.path.lasting.max())

    def pieces(
        self, fit: AnyFit, others: Sequence[AnyFit]
    ) -> Sequence[tuple[str, Array, Array, Mapping[str, Array]]]:
        problem, t, path = fit.problem, fit.problem.times, fit.problem.record.path
        jumps = np.abs(np.diff(np.log(np.maximum(path.lasting, 1e-300))))
        step = float(path.steps[int(np.argmax(jumps))])
        way = fit.law.critical_distance or abs(fit.law.direct_effect) / _stiffness(fit)
        place = np.interp(t, path.time, path.position) - np.interp(step, path.time, path.position)
        near = np.abs(place) < SETTLED * way
        near[np.argsort(np.abs(t - step))[: len(t) // 10]] = True  # it may settle in no samples
        every = {"the whole record": np.ones(len(t), dtype=bool)}
        every[f"about the step at {quantity(step, 's')}"] = near
        return [
            (name, t[rows], problem.measured[rows],
             {other.law.title: other.family.band[1][rows] for other in (fit, *others)})
            for name, rows in every.items()
        ]  # fmt: skip


def stepped_speeds(path: Path) -> tuple[float, float]:
    """Return the first speed, and that farthest from it, without holds: itself without another.

    Examples
    --------
    >>> stepped_speeds(Path(time=np.array([0.0, 2, 4, 5]), position=np.array([0.0, 0, 2, 4])))
    (1.0, 2.0)
    """
    begun, *others = path.lasting[path.lasting > STRAIGHT * path.lasting.max()].tolist()
    others = [speed for speed in others if differ(begun, speed)]
    return begun, max(others, key=lambda speed: abs(math.log(speed / begun)), default=begun)


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


def _stepped(
    form: RateStateForm, chosen: "Parameters[Any]", doubt: float
) -> tuple[SteppedLaw, float | None]:
    """Return what is looked for of a law and what is held, and the reference velocity if given."""
    usual = [f"friction.{name}" for name in form.fit_order]
    known = {f"friction.{name}": value for name, value in chosen.known.items()}
    named = (LAW,) if chosen.free is None else chosen.free
    free = {path for path in usual if path not in known} if LAW in named else set()
    free |= set(named) - {LAW}
    others = [path for path in chosen.unknown if path != path_of_parameter(STIFFNESS)]
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
    check_varied(bool(free) or doubt > 0.0)
    law = SteppedLaw(
        form=form,
        held={path.partition(".")[2]: own[path] for path in usual if path not in free},
        given={path.partition(".")[2]: x for path, x in own.items() if path in free},
        regularised=isinstance(chosen.law, RateState) and chosen.law.regularised,
    )
    return law, own.get(CONVENTION)


def _doubt(chosen: "Parameters[Any]", measurement: Measurement) -> float:
    """Return the prior deviation of the logarithm of the stiffness."""
    path = path_of_parameter(STIFFNESS)
    stated = dict(measurement.parameter_uncertainties)
    spread = stated.pop(path, None)
    if stated:
        raise InputError(
            f"the uncertainty of {next(iter(stated))} does not enter rate-and-state fits, only that"
            f" of {path}: leave it out."
        )
    if path in chosen.unknown:
        return UNKNOWN
    if path in chosen.held:
        return 0.0
    stiffness = _pulled(chosen.mechanism).stiffness
    return PRIORS[STIFFNESS][1] if spread is None else math.log1p(spread / stiffness)


def _pulled(mechanism: Mechanism) -> TowedBlock:
    """Return the mechanism if a spring alone pulls it."""
    if isinstance(mechanism, TowedBlock) and not mechanism.damping and mechanism.modulation is None:
        return mechanism
    raise InputError(
        "a rate-and-state fit needs a TowedBlock without damping and modulation, whose stiffness is"
        f" that of spring and machine, got {mechanism!r}."
    )


def over_scatter(fit: AnyFit) -> float:
    """Return residuals over what the scatter of neighbouring samples would leave; 0 without any."""
    record = fit.problem.record
    mode = {fit.name: fit.family.mode[None]}
    alone = fit.problem.at(mode, record.time)[fit.name][:, 0]
    left = record.coefficient - alone - fit.problem.along(record.time) @ fit.family.usual
    scatter = float(np.std(np.diff(record.coefficient)) / math.sqrt(2.0))
    return float(np.sqrt(np.mean(left**2))) / scatter if scatter > 0.0 else 0.0


def misses(fit: AnyFit) -> bool:
    """Return whether what the fit leaves is not noise alone, as far as neighbouring samples tell.

    The law misses something then, or the noise remembers more than a few samples.
    """
    return fit.posterior.kappa < WHITE / 3.0 or over_scatter(fit) > THRESHOLDS.misfit


def _effective(fit: AnyFit) -> str:
    rows = len(fit.problem.measured)
    return f"{significant(fit.posterior.kappa * rows, 2)} of {rows:,}"


def _stiffness(fit: AnyFit) -> float:
    """Return the stiffness of spring and machine over the load [1/m]."""
    return float(_pulled(fit.mechanism).stiffness / fit.problem.record.load)


def _change(fit: AnyFit) -> tuple[float, float, float]:
    """Return by how much friction changes along the way beside the law: interval and median."""
    ends = fit.problem.along(np.array([0.0, fit.problem.record.path.time[-1]]))
    first, last = ends[:, 1:] @ fit.family.coefficients[:, 1:].T
    low, middle, high = np.quantile(last - first, (ENDS[0], 0.5, ENDS[1])).tolist()
    return low, middle, high


def _drifts(fit: AnyFit) -> bool:
    """Return whether friction is told to change along the way beside the law."""
    trending = fit.problem.trending
    if trending.all():  # a drift that was asked for
        low, _, high = _change(fit)
        return not low <= 0.0 <= high
    share = float(trending[fit.family.sets].mean())
    return len(trending) > 1 and is_asserted(share)


def _of_mass(fit: AnyFit) -> Iterator[str]:
    """Yield what the mass does, which no run has."""
    law, fastest = fit.law, float(fit.problem.record.path.lasting.max())
    # without a state, friction follows the load point over the way a/k
    spent = [x for b, x in law.states if b > THRESHOLDS.negligible * law.direct_effect]
    way = min(spent, default=abs(law.direct_effect) / _stiffness(fit))
    swing = math.sqrt(_pulled(fit.mechanism).mass / _pulled(fit.mechanism).stiffness)
    if 2.0 * math.pi * swing * fastest > way > 0.0:  # a period of the block
        yield (
            f"The effect of the mass, which is neglected: sqrt(m/k) = {quantity(swing, 's', 2)} is"
            f" {ratio(swing * fastest / way)} the {quantity(way / fastest, 's', 2)} in which the"
            f" slider moves by {quantity(way, 'm', 2)} at the highest speed."
        )


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
    starts: int = SimulatedKind.starts,
    seed: int = 0,
    progress: Callable[[float], object] | None = None,
) -> AnyFit:
    """Fit rate-and-state friction to velocity steps, as `fit` does, with further arguments.

    The slider has no inertia and slides steadily at first. Intervals are those of the posterior
    (`stickslip.identify.problems.velocity_steps` has the priors): the stiffness of the machine, a
    change of friction along the way and a level are always in it.

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
    AnyFit
        Law, mechanism, estimates with intervals, a - b in ``derived``, and sentences.

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
    >>> fitted.details["separable"], abs(fitted.law.direct_effect - 0.010) < 5e-4
    (True, True)
    """
    check_given("fit_rate_state", mechanism, measurement)
    kind = VelocityStepKind(before=before, after=after, drift=drift, lowest=lowest_evolution_effect)
    request = Request(
        mechanism=mechanism, law=law, measurement=measurement, vary=vary, fixed=fixed,
        settings=RecordSettings(starts=starts, seed=seed), progress=progress,
    )  # fmt: skip
    return kind.fit(request)
