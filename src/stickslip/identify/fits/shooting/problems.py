"""The problems of runs that records become, the hold of their force, and where searches begin.

A held force acts half a sample later than one along straight lines. How late the recorded force
acts is one of the unknowns of a force balance along the record
(:mod:`stickslip.identify.problems.records`). Intervals of estimates include what is left open.
"""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits.contact_inputs import as_loaded, load_of, loaded
from stickslip.identify.fits.parameters import WIDE, FreeParameter, FreeParameters
from stickslip.identify.fits.record_forces import (
    driven,
    drives_itself,
    is_mass,
    mass_of,
    positions_of,
)
from stickslip.identify.fits.settings import Hold, RecordSettings
from stickslip.identify.fits.shooting.initial_states import RecordedMotion
from stickslip.identify.fits.shooting.measured_motions import PlainBalance, motions_of
from stickslip.identify.fits.shooting.multiple_shooting import Shooting
from stickslip.identify.fits.shooting.segments import (
    measured_quantity,
    segments_of,
    usual_segment,
    with_usual_segment,
)
from stickslip.identify.fits.shooting.start_values import (
    MECHANISM,
    StartEstimate,
    constant_of,
    least_of,
    lengthened_starts,
    scanned,
    surplus_starts,
)
from stickslip.identify.fits.validation import Parameters, check_varied
from stickslip.mechanisms import Mechanism, stops_of
from stickslip.quantities import full_path, parameters
from stickslip.show.formatting import fixed

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class HoldFinding:
    """How the force runs between its samples, and what a record says of that."""

    hold: Hold
    """What fits take."""
    given: bool = False
    """Whether the user gave it."""
    lateness: float = math.nan
    """By how many samples the force acts later than along straight lines: 0 for these, 0.5 if it is
    held; not a number where it was not estimated."""
    half_width: float = math.inf
    """Half width of its 95 % interval."""

    @property
    def told(self) -> bool:
        """Whether the record tells it: closer than the two holds lie."""
        return self.half_width < 0.5

    @property
    def unsure(self) -> float:
        """Half samples by which the force may act earlier or later than fits take; 0 if given."""
        if self.given:
            return 0.0
        taken = 0.5 if self.hold == "zero" else 0.0
        return 2.0 * (abs(self.lateness - taken) + self.half_width) if self.told else 1.0

    @property
    def sentence(self) -> str:
        """What is to be said; nothing where the user gave it."""
        if self.given:
            return ""
        what = f'the force {MEANING[self.hold]} (hold = "{self.hold}")'
        if not self.told:
            return (
                f"Assumed: between samples, {what}. The record does not tell, and intervals include"
                " half a sample. Give the hold if it is known."
            )
        late = f"{fixed(self.lateness, 2)} ± {fixed(self.half_width, 2)}"
        return (
            f"Estimated from the record: between samples, {what}; {late} samples late, where"
            " straight lines have 0 and a held force 0.5."
        )

    def to_dict(self) -> dict[str, Any]:
        """Return all as numbers and texts; None for what is not known."""
        known = math.isfinite(self.half_width)
        return {
            "hold": self.hold,
            "given": self.given,
            "samples_late": self.lateness if known else None,
            "half_width": self.half_width if known else None,
        }


MEANING: Final[dict[Hold, str]] = {
    "zero": "keeps its value until the next one",
    "first": "goes straight to the next value",
}


def hold_of(
    measurement: Measurement, given: Hold | None, late: tuple[float, float] | None = None
) -> HoldFinding | None:
    """Return how the force of a record runs between its samples, by how `late` it acts.

    That is a number of samples with the half width of its interval, if a balance told it.

    Examples
    --------
    >>> record = Measurement(time=[0.0, 0.1, 0.2], position=[0.0, 0.1, 0.3], force=[1.0, 2.0, 0.0])
    >>> hold_of(record, None, (0.02, 0.1)).hold, hold_of(record, None).hold
    ('first', 'zero')
    """
    records = measurement.records()
    known = measurement.quantities()
    if "friction" in known or any(record.time is None for record in records):
        return None
    if not ("force" in known and driven(measurement)):
        return None
    if given is not None:
        return HoldFinding(hold=given, given=True)
    value, half = late or (math.nan, math.inf)
    # commands are usual, where an estimate is worth nothing
    hold: Hold = "first" if value < 0.25 and half < 0.5 else "zero"
    return HoldFinding(hold=hold, lateness=value, half_width=half)


SOME = 2_500
"""Samples of a record that starts are looked for with, and first bristles are followed along."""


def segments_and_hold(
    mechanism: Mechanism,
    measurement: Measurement,
    settings: RecordSettings,
    late: tuple[float, float] | None = None,
) -> tuple[RecordSettings, HoldFinding | None]:
    """Return settings with the segments and the hold of a record, and how the hold is known.

    The force acts `late` by so many samples. There is no hold where no recorded force drives.
    """
    settings = with_usual_segment(settings, measurement)
    if drives_itself(mechanism, measurement):
        settings = _whole(measurement, settings)
    result = hold_of(measurement, settings.hold, late)
    return settings if result is None else replace(settings, hold=result.hold), result


def _whole(measurement: Measurement, settings: RecordSettings) -> RecordSettings:
    """Return settings by which records are simulated as a whole, resolved as segments are.

    A mechanism that drives itself runs from its start in any case: short segments would tell less.
    """
    if settings.segment != usual_segment(measurement):
        return settings
    longest = max(float(np.ptp(np.asarray(record.time))) for record in measurement.records())
    rows = math.ceil(settings.resolution * max(longest / settings.segment, 1.0))
    return replace(settings, segment=max(longest, settings.segment), resolution=rows)


Wanted: TypeAlias = Parameters[FrictionLaw | type[FrictionLaw]]
"""What is to be fitted: laws with start values, or types."""


@dataclass(frozen=True)
class FitSetup:
    """A problem and where its search begins."""

    mechanism: Mechanism
    """Mechanism with the values that are held."""
    start: FrictionLaw
    """Law with start values."""
    problem: Shooting
    """Residuals of the record."""
    build: "ShootingBuilder"
    """Makes problems of other records."""
    length: float | None = None
    """Length of its segments [s], if it is not that of the settings."""


@dataclass(frozen=True)
class ShootingBuilder:
    """Builds the problem of a record; no closure, so that fits can cross processes."""

    mechanism: Mechanism
    law: FrictionLaw
    free_parameters: FreeParameters
    settings: RecordSettings
    quantity: str
    """What runs are compared with, in every record alike."""

    def __call__(self, record: Measurement, length: float | None) -> Shooting:
        """Return the problem of a record, all of it, in segments of a length [s]."""
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
            quantity=self.quantity,
        )

    def _motions(self, record: Measurement) -> tuple[RecordedMotion, ...]:
        """Return the motions along which bristles are followed; none where they are not known."""
        if not self.law.states or drives_itself(self.mechanism, record):
            return ()
        try:
            result = motions_of(self.mechanism, record, hold=self.settings.holding, samples=SOME)
        except InputError:
            return ()
        return tuple(RecordedMotion(record=k, path=path, held=held) for k, path, held in result)

    def held_otherwise(self) -> "ShootingBuilder":
        """Return what takes the other hold of a force between samples."""
        other: Hold = "zero" if self.settings.holding == "first" else "first"
        return replace(self, settings=replace(self.settings, hold=other))


def _rows(settings: RecordSettings, length: float | None) -> int:
    """Return the rows of a segment, so that longer ones are resolved alike."""
    if length is None:
        return settings.resolution
    return max(settings.resolution, math.ceil(settings.resolution * length / settings.segment))


def simulated(
    settings: RecordSettings, wanted: Wanted, measurement: Measurement, begin: Mapping[str, float]
) -> FitSetup:
    """Return the problem of simulated segments.

    It starts from given values, or from a plain balance of forces, whichever leaves less; without a
    force, from the runs that do.
    """
    if settings.position_zeros:
        raise InputError(
            "position_zeros=True is for records of several joints; of one body that moves freely"
            " the zero is estimated if it is left out, and of a driven one it is not."
        )
    quantity = measured_quantity(measurement)
    under_load = loaded(wanted.mechanism, measurement)
    mechanism, _ = as_loaded(wanted.mechanism, measurement)
    alone = drives_itself(mechanism, under_load)
    constant = constant_of(mechanism)
    if alone:
        inertia, rough = mass_of(mechanism), scanned(mechanism, under_load, quantity)
    else:
        weighed = any(path.endswith(("inertia", "mass")) for path in wanted.unknown)
        balance = PlainBalance.of(mechanism, under_load, inertia=weighed)
        balance.refuse_nonsense(driven=driven(measurement))
        inertia = balance.values["inertia"]
        sizes = {"load": load_of(mechanism), "stroke": _stroke(measurement)}
        rough = StartEstimate.of(balance, **sizes)
    kind = wanted.law if isinstance(wanted.law, type) else type(wanted.law)
    held = {constant.path} & {*wanted.held}
    # a record has one number for a constant force and a level with laws that have a level of their
    # own in each direction, and where slip is in one direction only
    apart = rough.two_sided and not kind.directional
    sought = constant.path == MECHANISM and apart and not held
    if not (sought or alone):
        rough = StartEstimate.of(balance, **sizes, offset=constant.value)
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
    refuse_overrides(under_load, free.paths)
    build = ShootingBuilder(mechanism, start, free, settings, quantity)
    problem = build(measurement, None)
    tried = [free.start]
    if isinstance(wanted.law, type) and alone:
        tried += surplus_starts(free)
    if begin:
        values = np.array([begin.get(item.path, item.start) for item in free.items])
        tried.append(free.values(free.coordinates(values)))
    if stops_of(mechanism):
        problem, near_stops = lengthened_starts(problem)
        tried += near_stops
    problem = problem.with_free_parameters(free.starting_at(least_of(problem, tried)))
    return FitSetup(mechanism, start, problem, build)


def _stroke(measurement: Measurement) -> float:
    """Return the range of positions [m], of the record that has the largest."""
    records = [record for record in measurement.records() if record.time is not None]
    return max((float(np.ptp(positions_of(record))) for record in records), default=0.0)


def _mechanism_unknowns(
    mechanism: Mechanism, unknown: Sequence[str], inertia: float, level: float
) -> Iterator[FreeParameter]:
    """Yield the unknowns of a mechanism under friction of a level [N], with wide bounds."""
    known = {
        path: (quantity, value) for path, quantity, value in parameters(mechanism, "mechanism")
    }
    quantities = {path: quantity for path, (quantity, _) in known.items()}
    for path in dict.fromkeys(full_path(name, quantities) for name in unknown):
        quantity, value = known[path]
        begin = inertia if is_mass(mechanism, path) and inertia > 0.0 else value
        log, most = quantity.above is not None, WIDE * (level + abs(begin))
        yield FreeParameter(
            path=path,
            quantity=quantity,
            start=begin,
            low=begin / WIDE if log else max(quantity.low, -most),
            high=WIDE * begin if log else min(quantity.high, most),
            log=log,
        )


def refuse_overrides(measurement: Measurement, paths: Collection[str]) -> None:
    """Refuse trials with values of their own for what is one unknown of all of them."""
    for number, record in enumerate(measurement.records(), 1):
        for path in record.overrides:
            if path in paths:
                raise InputError(
                    f"trial {record.name or number} overrides {path}, which is fitted as one value"
                    " for all trials: leave the override out, or do not vary it."
                )
