"""The problems that records become, by route, and where their searches begin."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Generic, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from typing_extensions import TypeVar

from stickslip.data import Measurement
from stickslip.errors import ConvergenceError, InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits.contact_inputs import as_loaded, check_inputs, loaded
from stickslip.identify.fits.estimation.levenberg_marquardt import improve
from stickslip.identify.fits.estimation.parameters import FreeParameter, FreeParameters
from stickslip.identify.fits.estimation.problem import RecordProblem
from stickslip.identify.fits.force_map.data import MotionSegment, stretches_of
from stickslip.identify.fits.force_map.force_balance import (
    BalanceProblemBuilder,
    RederivedBalance,
    balanced,
    positive_noise,
)
from stickslip.identify.fits.force_map.holds import HoldFinding, hold_of
from stickslip.identify.fits.force_map.model import ForceMap
from stickslip.identify.fits.force_map.problem import (
    FEW,
    MECHANISM,
    SAMPLES,
    constant_of,
    map_along,
)
from stickslip.identify.fits.force_map.start_values import StartEstimate
from stickslip.identify.fits.records.fit import ProblemBuilder
from stickslip.identify.fits.records.scanning import (
    least_of,
    lengthened_starts,
    scanned,
    surplus_starts,
)
from stickslip.identify.fits.series.applied_force import drives_itself
from stickslip.identify.fits.series.inverse_dynamics import is_mass, mass_of, positions_of
from stickslip.identify.fits.series.start_values import (
    inertia_of,
    mechanism_unknown,
    regressed,
)
from stickslip.identify.fits.settings import NEGLIGIBLE, Hold, RecordSettings, SensorResponse
from stickslip.identify.fits.shooting.initial_states import RecordedMotion
from stickslip.identify.fits.shooting.multiple_shooting import Shooting
from stickslip.identify.fits.shooting.segments import (
    measured_quantity,
    segments_of,
    usual_segment,
    with_usual_segment,
)
from stickslip.identify.fits.validation import Parameters, check_varied
from stickslip.mechanisms import Mechanism, motor_of, stops_of
from stickslip.quantities import full_path, parameters, vary

Array = NDArray[np.float64]
SOME = 2_500
"""Samples of a record that starts are looked for with, and first bristles are followed along."""
SEEN = 16.0
"""Way along which a bristle yields, over the noise of positions, from which a record shows it."""
ELECTRIC = ("mechanism.drive.resistance", "mechanism.drive.back_emf_constant")
"""Paths of what the winding alone tells of a motor under a recorded current."""
RecordRouteName: TypeAlias = Literal["shooting", "force-map", "inverse-dynamics"]


@dataclass(frozen=True, kw_only=True)
class RouteChoice:
    """How a record is fitted."""

    route: RecordRouteName
    """The route."""
    settings: RecordSettings
    """Settings with the length of segments, and the hold, that serve."""
    hold: HoldFinding | None = None
    """How the recorded force runs between its samples; None if none drives."""

    @classmethod
    def of(
        cls,
        route: RecordRouteName,
        mechanism: Mechanism,
        measurement: Measurement,
        settings: RecordSettings,
    ) -> "RouteChoice":
        """Return a route with the segments, and the hold, of a record."""
        if route == "force-map":
            return cls(route=route, settings=settings)
        if route == "shooting":
            settings = with_usual_segment(settings, measurement)
            if drives_itself(mechanism, measurement):
                settings = _whole(measurement, settings)
        found = hold_of(mechanism, measurement, settings.hold)
        return cls(
            route=route,
            settings=settings if found is None else found.applied(settings),
            hold=found,
        )


def _whole(measurement: Measurement, settings: RecordSettings) -> RecordSettings:
    """Return settings by which records are simulated as a whole, resolved as segments are.

    A mechanism that drives itself runs from its start in any case: short segments would tell less.
    """
    if settings.segment != usual_segment(measurement):
        return settings
    longest = max(float(np.ptp(np.asarray(one.time))) for one in measurement.records())
    rows = math.ceil(settings.resolution * max(longest / settings.segment, 1.0))
    return replace(settings, segment=max(longest, settings.segment), resolution=rows)


Wanted: TypeAlias = Parameters[FrictionLaw | type[FrictionLaw]]
"""What is to be fitted: laws with start values, or types."""
P_co = TypeVar("P_co", bound=RecordProblem, default=RecordProblem, covariant=True)


@dataclass(frozen=True)
class FitSetup(Generic[P_co]):
    """A problem and where its search begins."""

    mechanism: Mechanism
    """Mechanism with the values that are held."""
    start: FrictionLaw
    """Law with start values."""
    problem: P_co
    """Residuals of the record."""
    build: ProblemBuilder
    """Makes problems of other records."""
    tried: tuple[Array, ...] = ()
    """Other values (p,) that a simulation may start from."""
    length: float | None = None
    """Length of its segments [s], if it is not that of the settings."""


# What builds problems is no closure, so that fits can cross processes.


@dataclass(frozen=True)
class _ShootingBuilder:
    """Builds the shooting problem of a record."""

    mechanism: Mechanism
    law: FrictionLaw
    free_parameters: FreeParameters
    settings: RecordSettings
    quantity: str
    """What runs are compared with, in every record alike."""

    def __call__(self, record: Measurement, length: float | None) -> Shooting:
        return Shooting(
            motions=self._motions(record),
            law=self.law,
            free_parameters=self.free_parameters,
            segments=segments_of(
                self.mechanism,
                record,
                length=self.settings.segment if length is None else length,
                resolution=_rows(self.settings, length),
                hold=self.settings.holding,
                quantity=self.quantity,
                zeros=self.settings.position_zeros is not False,
            ),
            quantity_=self.quantity,
        )

    def _motions(self, record: Measurement) -> tuple[RecordedMotion, ...]:
        """Return the motions along which bristles are followed; none where they are not known."""
        if not self.law.states or drives_itself(self.mechanism, record):
            return ()
        try:
            found = balanced(self.mechanism, record, hold=self.settings.holding, samples=SOME)
        except InputError:
            return ()
        return tuple(
            RecordedMotion(
                record=one.record,
                path=one.path,
                held=0.0 if one.held is None else float(one.held[0]),
            )
            for one in found
        )

    def fitted(self, record: Measurement, length: float | None) -> Shooting:
        return self(record, length)

    def at(self, _values: Array) -> "_ShootingBuilder":
        return self


def held_otherwise(build: ProblemBuilder) -> ProblemBuilder | None:
    """Return what takes the other hold of a force between samples; None if it takes none."""
    if isinstance(build, _ShootingBuilder):
        settings = replace(build.settings, hold=_other(build.settings.holding))
        return replace(build, settings=settings)
    if isinstance(build, BalanceProblemBuilder):
        return replace(build, hold=_other(build.hold))
    return None


def _other(hold: Hold) -> Hold:
    return "zero" if hold == "first" else "first"


@dataclass(frozen=True)
class _ForceMapBuilder:
    """Builds the problem of a record of friction."""

    mechanism: Mechanism
    problem: ForceMap
    response: SensorResponse

    def __call__(self, record: Measurement, length: float | None) -> RecordProblem:
        own = stretches_of(self.mechanism, record, segment=length, response=self.response)
        return self.problem.along(own, record)

    def fitted(self, record: Measurement, length: float | None) -> RecordProblem:
        own = stretches_of(
            self.mechanism, record, segment=length, samples=SAMPLES, response=self.response
        )
        return self.problem.along(own, record)

    def at(self, _values: Array) -> "_ForceMapBuilder":
        return self


def _rows(settings: RecordSettings, length: float | None) -> int:
    """Return the rows of a segment, so that longer ones are resolved alike."""
    if length is None:
        return settings.resolution
    return max(settings.resolution, math.ceil(settings.resolution * length / settings.segment))


def prepared(choice: RouteChoice, wanted: Wanted, measurement: Measurement) -> FitSetup:
    """Return the problem of a route."""
    if choice.settings.position_zeros:
        raise InputError(
            "position_zeros=True is for records of several joints; of one body that moves freely"
            " the zero is estimated if it is left out, and of a driven one it is not."
        )
    return PROBLEMS[choice.route](choice, wanted, measurement)


def simulated(choice: RouteChoice, wanted: Wanted, measurement: Measurement) -> FitSetup[Shooting]:
    """Return the problem of simulated segments.

    It starts from the fit to the balance of forces, where there is one, or from the regression of
    forces, whichever leaves less; without a force, from the runs that do.
    """
    quantity = measured_quantity(measurement)
    under_load = loaded(wanted.mechanism, measurement)
    mechanism, _ = as_loaded(wanted.mechanism, measurement)
    alone = drives_itself(mechanism, under_load)
    constant = constant_of(mechanism)
    if alone:
        inertia, rough = mass_of(mechanism), scanned(mechanism, under_load, quantity)
    else:
        inertia = regressed(mechanism, under_load, wanted.unknown)
        derive = partial(balanced, mechanism, measurement, hold=choice.settings.holding)
        stretches = derive(slipping=True, samples=SOME)
        rough = StartEstimate.of(stretches)
    kind = wanted.law if isinstance(wanted.law, type) else type(wanted.law)
    held = {constant.path} & {*wanted.held}
    sought = constant.path == MECHANISM and rough.seeks_constant(kind, held)
    if not (sought or alone):
        rough = StartEstimate.of(stretches, offset=constant.value)
    start, free = rough.unknowns(
        wanted.law,
        free=wanted.free,
        known=wanted.known,
        held=wanted.held,
        constant=constant.path if sought else None,
    )
    own = _mechanism_unknowns(mechanism, wanted.unknown, inertia, rough.force)
    free = replace(free, items=(*free.items, *own))
    check_varied(len(free))
    _refuse_overrides(under_load, free)
    build = _ShootingBuilder(mechanism, start, free, choice.settings, quantity)
    problem = build(measurement, None)
    tried = [free.start]
    if isinstance(wanted.law, type) and alone:
        tried += surplus_starts(free)
    if not alone:
        tried += _by_balance(choice, wanted, measurement, free)
    if stops_of(mechanism):
        problem, near_stops = lengthened_starts(problem)
        tried += near_stops
    problem = problem.with_free_parameters(free.starting_at(least_of(problem, tried)))
    return FitSetup(mechanism, start, problem, build)


def _mechanism_unknowns(
    mechanism: Mechanism, unknown: Sequence[str], inertia: float, level: float
) -> Iterator[FreeParameter]:
    """Yield the unknowns of a mechanism under friction of a level [N]."""
    known = {
        path: (quantity, value) for path, quantity, value in parameters(mechanism, "mechanism")
    }
    quantities = {path: quantity for path, (quantity, _) in known.items()}
    for path in dict.fromkeys(full_path(name, quantities) for name in unknown):
        quantity, value = known[path]
        begin = inertia if is_mass(mechanism, path) and inertia > 0.0 else value
        yield mechanism_unknown(path, quantity, begin, level)


def _by_balance(
    choice: RouteChoice, wanted: Wanted, measurement: Measurement, free: FreeParameters
) -> list[Array]:
    """Return the values (p,) that the balance of forces finds; none if it cannot.

    Simulated segments say nothing of a velocity or a stiffness that is decades away.
    """
    try:
        ready = _derived(choice, wanted, measurement)
        end, _ = improve(ready.problem, ready.problem.free_parameters.start)
    except (ConvergenceError, InputError):
        return []
    found = []
    for one in (end.values, *ready.tried):
        # what friction is derived anew for comes last, and starts as given
        known = dict(zip(ready.problem.free_parameters.paths, one.tolist(), strict=False))
        values = np.array([known.get(item.path, item.start) for item in free.items])
        found.append(free.values(free.coordinates(values)))
    return found


def _refuse_overrides(measurement: Measurement, free_parameters: FreeParameters) -> None:
    """Refuse trials with values of their own for what is one unknown of all of them."""
    for number, record in enumerate(measurement.records(), 1):
        for path in record.overrides:
            if path in free_parameters.paths:
                raise InputError(
                    f"trial {record.name or number} overrides {path}, which is fitted as one value"
                    " for all trials: leave the override out, or do not vary it."
                )


def _mapped(choice: RouteChoice, wanted: Wanted, measurement: Measurement) -> FitSetup[ForceMap]:
    """Return the problem of friction that was measured."""
    if wanted.unknown:
        raise InputError(
            f"measured friction does not depend on {', '.join(wanted.unknown)}: vary parameters of"
            " the law only, or fit another record with motion and force."
        )
    mechanism, response = wanted.mechanism, choice.settings.response
    along = partial(stretches_of, mechanism, measurement, response=response)
    stretches = along(samples=SAMPLES)
    _check_inputs(wanted, measurement, stretches)
    problem, _ = map_along(
        wanted.law,
        stretches,
        along(samples=FEW),
        free=wanted.free,
        known=wanted.known,
        held=[path for path in wanted.held if path == "mechanism.offset"],
        beside=constant_of(mechanism),
    )
    build = _ForceMapBuilder(mechanism, problem, response)
    return FitSetup(mechanism, problem.law, problem, build)


def _derived(choice: RouteChoice, wanted: Wanted, measurement: Measurement) -> FitSetup[ForceMap]:
    """Return the problem of friction that inverse dynamics finds, the mass looked for with it."""
    mechanism, hold = wanted.mechanism, choice.settings.holding
    known = {path: quantity for path, quantity, _ in parameters(mechanism, "mechanism")}
    unknown = [full_path(name, known) for name in wanted.unknown]
    masses = [path for path in unknown if is_mass(mechanism, path)]
    others = [path for path in unknown if path not in masses]
    mass = inertia_of(mechanism, measurement, masses)
    if mass is not None:
        mechanism = vary(mechanism, "mechanism", {mass.path: mass.start})
    slipping = not memory_is_seen(wanted.law, measurement)
    derive = partial(balanced, hold=hold, slipping=slipping, resolved=not slipping)
    own = partial(derive, mechanism, measurement)
    stretches = own()
    _check_inputs(wanted, measurement, stretches)
    if mass is not None:
        _refuse_constant(stretches, mass)
    problem, further = map_along(
        wanted.law,
        stretches,
        own(samples=SOME),
        free=wanted.free,
        known=wanted.known,
        held=[path for path in wanted.held if path == "mechanism.offset"],
        beside=constant_of(mechanism),
        linear=() if mass is None else (mass,),
        derived=(mass_of(mechanism),),
        mass=mass_of(mechanism),
    )
    winding = per_current(mechanism, measurement, others)
    if others:
        derive = partial(derive, winding=winding)
        again = RederivedBalance(tuple(others), mechanism, measurement, derive)
        problem = _with_rederived(problem, again)
    if wanted.unknown:
        _refuse_overrides(measurement, problem.free_parameters)
    build = BalanceProblemBuilder(
        mechanism, problem, hold, slipping, resolved=not slipping, winding=winding
    )
    return FitSetup(mechanism, problem.law, problem, build, tried=further)


def per_current(mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str]) -> float:
    """Return the torque per current by which the balance of a motor's winding counts in a fit.

    It does where resistance or back-EMF are looked for, and a record has current and voltage; 0
    elsewhere.
    """
    motor = motor_of(mechanism)
    both = any({"current", "voltage"} <= {*one.quantities()} for one in measurement.records())
    if motor is None or not both or not {*ELECTRIC} & {*unknown}:
        return 0.0
    return float(motor.gear_ratio * motor.torque_constant)


def _with_rederived(problem: ForceMap, again: RederivedBalance) -> ForceMap:
    """Return a problem with parameters for which friction is derived anew."""
    level = float(np.median(np.abs(problem.measured)))
    items = _mechanism_unknowns(again.mechanism, again.paths, 0.0, level)
    free = problem.free_parameters
    free = replace(free, items=(*free.items, *items))
    whole = replace(problem.with_free_parameters(free), rederived=again)
    return replace(whole, stretches=tuple(again.derive(again.mechanism, again.measurement)))


def memory_is_seen(law: FrictionLaw | type[FrictionLaw], measurement: Measurement) -> bool:
    """Whether the positions resolve the way along which bristles start: then rests count as well.

    Where they do not, the noise of positions times the stiffness is an error of the prediction.
    """
    stiffness = getattr(law, "bristle_stiffness", None)
    if isinstance(law, type) or not law.states or not isinstance(stiffness, float):
        return False
    levels = [getattr(law, name) for name in law.fit_order if "kinetic" in name]
    level = max((abs(float(one)) for one in levels if one is not None), default=0.0)
    records = measurement.records()
    noise = max(positive_noise(positions_of(record)) for record in records)
    return level > SEEN * stiffness * noise


def _check_inputs(
    wanted: Wanted, measurement: Measurement, stretches: Sequence[MotionSegment]
) -> None:
    """Refuse a law that asks for a contact input which some stretch does not have."""
    known = [
        name for name in stretches[0].path.inputs if all(name in s.path.inputs for s in stretches)
    ]
    check_inputs(wanted.law, wanted.mechanism, measurement, known)


def _refuse_constant(stretches: Sequence[MotionSegment], mass: FreeParameter) -> None:
    """Refuse to look for a mass where without it friction would be a constant force.

    A mass of 0 with that friction leaves nothing, whatever the motion was.
    """
    table = [
        (one.friction + mass.start * one.regressors[:, 0])[one.rows_of(None)]
        for one in stretches
        if one.regressors is not None
    ]
    forces = np.concatenate(table)
    if np.ptp(forces) <= NEGLIGIBLE * np.max(np.abs(forces), initial=0.0):
        raise InputError(
            f"inverse dynamics cannot find {mass.path}: the force that moves the body never"
            " changes, and a mass of 0 with a friction of that size would explain it. Give the"
            " mass and do not vary it, or choose the route shooting."
        )


PROBLEMS: Mapping[RecordRouteName, Callable[[RouteChoice, Wanted, Measurement], FitSetup]] = {
    "shooting": simulated,
    "force-map": _mapped,
    "inverse-dynamics": _derived,
}
