"""Fits a law to records in time or to measured friction, by one of three routes."""

import math
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit

from stickslip.data import (
    Measurement,
    command_of,
    refuse_faults,
    refuse_unused,
    volts_sentence,
    with_doubts,
    without_outliers,
)
from stickslip.errors import ConvergenceError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits.contact_inputs import (
    as_informed,
    as_loaded,
    check_inputs,
    recorded_inputs,
    unvaried,
)
from stickslip.identify.fits.levenberg_marquardt import (
    FIRST_DAMPING,
    OptimizeResult,
    ResidualJacobian,
    Watch,
    search,
    step_of,
)
from stickslip.identify.fits.parameters import FreeParameter, FreeParameters, told
from stickslip.identify.fits.record_forces import driven, drives_itself, inside
from stickslip.identify.fits.rig_uncertainties import refuse_load, uncertainties_of
from stickslip.identify.fits.settings import CHANCE, RecordSettings
from stickslip.identify.fits.shooting.estimates import (
    NORMAL_95,
    Displaced,
    Inference,
    bounds_met,
    estimates_of,
    infer,
    offset_left_out,
    sentences_of,
    with_unit,
)
from stickslip.identify.fits.shooting.fit import RecordFit, scale_of
from stickslip.identify.fits.shooting.multiple_shooting import Shooting
from stickslip.identify.fits.shooting.problems import (
    FitSetup,
    HoldFinding,
    segments_and_hold,
    simulated,
)
from stickslip.identify.fits.validation import Parameters
from stickslip.mechanisms import Mechanism, input_names, slip_of, stops_of
from stickslip.mechanisms.drives import SampledSwing
from stickslip.quantities import parameters, vary
from stickslip.show.formatting import joined, number, percent, quantity

# Which way records are fitted, by what was measured.

OwnRouteName: TypeAlias = Literal["table", "balance", "shooting", "features", "rate-state"]
RouteName: TypeAlias = OwnRouteName | str
"""What `fit` and `select` may be asked for; editors complete ours, and other packages add theirs.
"""
KNOWN_STATES = frozenset({"dahl", "lugre"})
"""Memories that a force balance tells."""


def route_of(
    mechanism: Mechanism,
    measurement: Measurement,
    law: FrictionLaw | type[FrictionLaw] | None = None,
    *,
    asked: str | None = None,
) -> str:
    """Return how a record is fitted: as asked, or as its quantities and the law allow.

    Along a force balance, unless what is recorded moves by itself, follows goals of a loop, has
    stops or several coordinates, or the law has states that no balance tells: then by simulated
    segments.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.friction import ElastoPlastic
    >>> t = np.arange(300) / 100
    >>> pushed = Measurement(time=t, position=np.sin(t), force=np.cos(t))
    >>> route_of(Axis(inertia=1.0), pushed), route_of(Axis(inertia=1.0), pushed, ElastoPlastic)
    ('balance', 'shooting')
    """
    if asked is not None:
        return asked
    if "friction" in measurement.quantities():
        return "balance"
    commands = {command_of(record) for record in measurement.records()}
    if drives_itself(mechanism, measurement) or "reference" in commands:
        return "shooting"
    free = not driven(measurement)
    told = law is None or _is_told(law, {*input_names(mechanism)} - {"transmitted"}, free=free)
    tracked = len(mechanism.coordinates) == 1 and not stops_of(mechanism)
    return "balance" if told and tracked else "shooting"


def _is_told(law: FrictionLaw | type[FrictionLaw], by_motion: Set[str], *, free: bool) -> bool:
    """Return whether a balance tells the states of a law; a free motion tells sums of parts.

    What follows from the motion by the mechanism alone, such as a place, is none of its inputs.
    """
    kind = law if isinstance(law, type) else type(law)
    if by_motion & {*kind.inputs}:
        return False
    if kind.composition is None:
        return not (free or kind.states)
    parts = [part for part in kind.composition.parts() if part.role == "memory"]
    return not parts if free else {part.name for part in parts} <= KNOWN_STATES


Array = NDArray[np.float64]


def displacements(
    problem: Shooting, best: ResidualJacobian, mechanism: Mechanism, measurement: Measurement
) -> tuple[Displaced, ...]:
    """Return how far stated uncertainties of a mechanism move the residuals of a fit.

    A parameter that is looked for, as a constant force is without being asked for, is known from
    the record; what was stated of it is not used.
    """
    uncertainties = uncertainties_of(mechanism, measurement)
    stated = dict.fromkeys(path for pair in uncertainties for item in pair for path in item)
    refuse_load(stated, measurement)
    result = []
    for path in [path for path in stated if path not in problem.free_parameters.paths]:
        every = np.zeros(len(best.residual))
        for k, (record, (own, shared)) in enumerate(
            zip(measurement.records(), uncertainties, strict=True)
        ):
            if error := {**shared, **own}.get(path, 0.0):
                set_up = vary(mechanism, "mechanism", record.overrides)
                rows, slopes = _slopes_by_rig(problem, best, set_up, path, k)
                moved = np.zeros_like(every)
                moved[rows] = -error * slopes
                if path in shared:
                    every += moved
                else:
                    result.append(Displaced(path=path, rows=moved, shared=False))
        if every.any():
            result.append(Displaced(path=path, rows=every))
    return tuple(result)


def _slopes_by_rig(
    problem: Shooting, best: ResidualJacobian, mechanism: Mechanism, path: str, record: int
) -> tuple[NDArray[np.bool_], Array]:
    """Return which rows (n,) are of a record, and their slopes by a parameter of the mechanism."""
    known = {name: (quantity, x) for name, quantity, x in parameters(mechanism, "mechanism")}
    item, value = known[path]
    free = problem.free_parameters
    more = replace(free, items=(*free.items, FreeParameter(path=path, quantity=item, start=value)))
    of_segment = problem.spans[:, 0].astype(int)
    values = np.append(best.values, value)
    near = ResidualJacobian(
        values=values,
        residual=best.residual,
        slopes=np.zeros((0, 0)),
        segment=best.segment,
        memory=best.memory,
    )
    chosen = np.flatnonzero(of_segment == record).tolist()
    seen = problem.with_free_parameters(more).linearise(values, near, only=chosen)
    if not seen.finite:
        raise ConvergenceError(
            f"the uncertainty of {path} cannot be propagated: the record cannot be simulated with"
            " values close to the stated one. Leave the uncertainty out."
        )
    return of_segment[best.segment] == record, seen.slopes[:, -1]


def fit_records(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    settings: RecordSettings | None = None,
    progress: Watch | None = None,
    begin: Mapping[str, float] | None = None,
    late: tuple[float, float] | None = None,
) -> RecordFit:
    """Fit a law to records in time by simulated segments; arguments as in `stickslip.fit`.

    A search may begin at values by path too, as a force balance has them, and it may be known by
    how many samples the force acts `late`, with the half width of its interval.
    """
    wanted = Parameters.of(mechanism, law, vary, fixed, measurement=measurement)
    mechanism = wanted.mechanism
    refuse_faults(measurement, mechanism, wanted.unknown)
    with with_doubts(measurement, mechanism, of=ConvergenceError):
        check_inputs(wanted.law, mechanism, measurement)
        measurement, left_out = without_outliers(measurement)
        settings, hold = segments_and_hold(
            mechanism, measurement, settings or RecordSettings(), late
        )
        refuse_unused(measurement, inside(mechanism, measurement))
        with with_doubts(measurement, mechanism):
            ready = simulated(settings, wanted, measurement, begin or {})
        optimum = first = search(
            ready.problem, starts=settings.starts, seed=settings.seed, watch=progress
        )
        if not driven(measurement):
            ready, optimum = _lengthened(ready, optimum, measurement, settings, progress)
        fit = finished("shooting", measurement, ready, optimum, first, hold=hold)
        return replace(fit, left_out=left_out)


def _lengthened(
    ready: FitSetup,
    found: OptimizeResult,
    measurement: Measurement,
    settings: RecordSettings,
    watch: Watch | None,
) -> tuple[FitSetup, OptimizeResult]:
    """Fit a free decay again in longer segments, at last as a whole.

    The whole tells the most, but only from near the truth: from farther off, a swing more or less
    is as good a fit. What is returned is how the last search ended, whose residuals are those of
    the fit: costs over longer segments cannot be compared with costs over short ones.
    """
    spans = ready.problem.spans
    whole = float(np.max(spans[:, 2]) - np.min(spans[:, 1]))
    for length in (math.sqrt(settings.segment * whole), whole):
        if found.cancelled or length <= settings.segment or length > whole:
            continue
        longer = ready.build(measurement, length)
        near = longer.free_parameters.starting_at(found.best.values)
        problem = longer.with_free_parameters(near)
        try:
            again = search(problem, starts=1, watch=watch)
        except ConvergenceError as error:
            raise ConvergenceError(
                f"segments of {number(settings.segment)} s of this free decay are too short to"
                f" predict {quantity(length, 's')}: {error} Give longer segments."
            ) from None
        ready = replace(ready, problem=problem, length=length)
        found = replace(again, evaluations=found.evaluations + again.evaluations)
    return ready, found


def finished(
    route: str,
    measurement: Measurement,
    ready: FitSetup,
    found: OptimizeResult,
    first: OptimizeResult,
    *,
    hold: HoldFinding | None = None,
) -> RecordFit:
    """Return a fit from the end of its search, which began with a first one."""
    free_parameters, best = ready.problem.free_parameters, found.best
    at_bounds = bounds_met(free_parameters, best.values)
    values = dict(zip(free_parameters.paths, best.values.tolist(), strict=True))
    law, own = (
        {path: value for path, value in values.items() if path.startswith(f"{room}.")}
        for room in ("friction", "mechanism")
    )
    mechanism = vary(ready.mechanism, "mechanism", own) if own else ready.mechanism
    moved = displacements(ready.problem, best, mechanism, measurement)
    inference = infer(best, scale_of(free_parameters, best.values, at_bounds), displaced=moved)
    elsewhere = _elsewhere(found, inference)
    inference = inference.including(*(item.widening for item in elsewhere))
    mechanism, said = as_loaded(mechanism, measurement)
    mechanism, told_inputs = as_informed(ready.start, mechanism, measurement)
    fit = RecordFit(
        law=vary(ready.start, "friction", law),
        mechanism=mechanism,
        estimates=(),
        remarks=(*([said] if said else []), *told_inputs),
        route=route,
        measurement=measurement,
        problem=ready.problem,
        build=ready.build,
        optimum=found,
        first=None if first is found else first,
        inference=inference,
        at_bounds=at_bounds,
        cancelled=found.cancelled,
        sentences=(),
        hold=hold,
    )
    inference = inference.including(*_moved_by_hold(fit))
    records = measurement.records()
    inputs = [recorded_inputs(record, np.asarray(record.time)) for record in records]
    told_by = told(free_parameters, ready.mechanism, measurement)
    estimates = estimates_of(told_by, best, inference, at_bounds)
    return replace(
        fit,
        estimates=estimates,
        inference=inference,
        sentences=(
            *sentences_of(told_by, best, inference, at_bounds, estimates),
            *offset_left_out(ready.start, ready.mechanism, free_parameters.paths),
            *_zeros(ready, best, inference),
            *_of_ends(told_by, elsewhere),
            *unvaried(ready.start, inputs),
            *_of_recorded_swing(mechanism),
            *dict.fromkeys(volts_sentence(name) for x in measurement.records() for name in x.volts),
        ),
    )


@dataclass(frozen=True, kw_only=True)
class _Elsewhere:
    """Where another start of a search ended."""

    values: Array
    """Values (p,)."""
    off: Array
    """How far they are from those of the fit (p,)."""
    chance: float
    """Their probability."""

    @property
    def widening(self) -> Array:
        """Half widths (p,) beside those of one end: to the other end, or as of their mixture."""
        return np.asarray(max(1.0, NORMAL_95 * math.sqrt(self.chance)) * self.off)


def _elsewhere(searched: OptimizeResult, inference: Inference) -> list[_Elsewhere]:
    """Return ends of a search that are about as likely as the best, and not it.

    The probability is that of normal errors of as many independent residuals as there are.
    """
    result, best, least = list[_Elsewhere](), searched.best.values, min(searched.costs)
    for cost, values in zip(searched.costs, searched.ends, strict=True):
        if not math.isfinite(cost):
            continue
        worse = cost / least if least > 0.0 else math.inf
        chance = float(expit(0.5 * inference.effective * (1.0 - worse)))
        off = np.where(np.isfinite(inference.half_widths), values - best, 0.0)
        apart = np.any(np.abs(off) > inference.half_widths)
        seen = any(np.all(np.abs(x.values - values) < inference.half_widths) for x in result)
        if apart and chance >= CHANCE and not seen:
            result.append(_Elsewhere(values=values, off=off, chance=chance))
    return result


def _of_ends(free: FreeParameters, elsewhere: Sequence[_Elsewhere]) -> Iterator[str]:
    """Yield a sentence on each further end of a search."""
    for end in elsewhere:
        values = [
            f"{item.quantity.symbol} = {with_unit(x, item)}"
            for item, x, off in zip(free.items, end.values.tolist(), end.off.tolist(), strict=True)
            if off and not item.quantity.nuisance
        ]
        if values:
            yield (
                f"Another start of the search ends at {joined(values)}, with a probability of"
                f" {percent(end.chance)}: intervals hold both ends."
            )


def _moved_by_hold(fit: RecordFit) -> list[Array]:
    """Return how far estimates (p,) move if the force acts as early, or late, as it may."""
    hold = fit.hold
    if hold is None or hold.unsure == 0.0 or fit.optimum.cancelled:
        return []
    problem = fit.build.held_otherwise()(fit.measurement, None)
    return [hold.unsure * item for item in _moved(fit, problem)]


def _moved(fit: RecordFit, problem: Shooting) -> list[Array]:
    """Return how far one step moves the estimates (p,) in another problem of the same record."""
    free = fit.free_parameters
    here = problem.with_free_parameters(free).linearise(fit.values)
    if not here.finite:
        return []
    at, (low, high) = free.coordinates(fit.values), free.limits()
    table = here.slopes @ free.slopes(at)
    step, _ = step_of(table, here.residual, at, low, high, FIRST_DAMPING)
    return [free.values(at + step) - fit.values]


def _zeros(ready: FitSetup, best: ResidualJacobian, inference: Inference) -> tuple[str, ...]:
    """Return a sentence on the place from which positions of a free motion count."""
    autocorrelation = math.sqrt(max(len(best.residual) / max(inference.effective, 1.0), 1.0))
    result = ready.problem.zeros(best, autocorrelation)
    if not result:
        return ()
    unit = ready.mechanism.units[ready.mechanism.coordinates.index(slip_of(ready.mechanism))]
    shown = [
        f"{quantity(item.value, unit, 2)} ± {quantity(NORMAL_95 * item.error, unit, 2)}"
        for item in result.values()
    ]
    more = "" if len(shown) == 1 else " for each record"
    return (
        f"The zero of the position is not known and is estimated with the fit{more}:"
        f" {joined(shown)}. Levels of friction that differ by direction would look alike. If the"
        " zero is known, set position_zeros to False (--no-position-zeros).",
    )


def _of_recorded_swing(mechanism: Mechanism) -> tuple[str, ...]:
    """Return a sentence where a recorded motion drives, whose error no interval holds."""
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    drives = mechanism.drives()
    guided = ((name, drives[guide.drive]) for name, guide in mechanism.guided().items())
    return tuple(
        f"The motion of {name} is a recorded one, whose acceleration has a standard error of"
        f" {quantity(drive.acceleration_error, f'{units[name]}/s^2')} from noise, beside what its"
        " smoothing flattens: neither is part of the intervals."
        for name, drive in guided
        if isinstance(drive, SampledSwing)
    )
