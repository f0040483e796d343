"""The route of measured friction: a law is fitted to the force along the measured motion."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits.estimation.parameters import FreeParameter, FreeParameters
from stickslip.identify.fits.force_map.data import MotionSegment, refuse_timeless, stretches_of
from stickslip.identify.fits.force_map.model import ForceMap
from stickslip.identify.fits.force_map.start_values import (
    StartEstimate,
    screened_starts,
)
from stickslip.mechanisms import Mechanism

Array = NDArray[np.float64]

MECHANISM, SENSOR = "mechanism.offset", "measurement.offset.friction"
"""Paths of the constant force: of the mechanism if it has one, else of the force sensor."""
FEW = 1_000
"""Samples of a record that start values are looked for with."""


class ConstantForce(NamedTuple):
    """A constant force beside friction."""

    path: str = SENSOR
    """Its path."""
    value: float = 0.0
    """Its value where it is not looked for [N]."""


SAMPLES = 4_000
"""Samples of a record that a fit uses at most: bristles see the noise of positions at each."""
NO_FORCE = ConstantForce()


def force_map(
    law: FrictionLaw | type[FrictionLaw],
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    segment: float | None = None,
    samples: float = SAMPLES,
    free: Collection[str] | None = None,
    held: Collection[str] = (),
    known: Mapping[str, float] | None = None,
) -> ForceMap:
    """Return the problem of fitting a law to measured friction, with start values from the data.

    Examples
    --------
    >>> from stickslip import Axis, Dahl, Measurement
    >>> from stickslip.identify.fits.estimation.levenberg_marquardt import search
    >>> t = np.linspace(0.0, 2.0, 401)
    >>> x = 1e-3 * np.sin(2.0 * np.pi * t)
    >>> friction = np.sign(np.cos(2.0 * np.pi * t)) * 3.0
    >>> record = Measurement(time=t, position=x, friction=friction, load=6.0)
    >>> problem = force_map(Dahl, Axis(inertia=1.0), record, held=["yield_exponent"])
    >>> found = search(problem, starts=1)
    >>> round(float(found.best.values[0]), 2)
    0.5
    """
    stretches = stretches_of(mechanism, measurement, segment=segment, samples=samples)
    few = stretches_of(mechanism, measurement, samples=min(FEW, samples))
    problem, _ = map_along(
        law, stretches, few, free=free, held=held, known=known, beside=constant_of(mechanism)
    )
    return problem


def constant_of(mechanism: Mechanism) -> ConstantForce:
    """Return the constant force of a mechanism, or that of the force sensor if it has none.

    Examples
    --------
    >>> from stickslip import Axis
    >>> constant_of(Axis(inertia=1.0, offset=0.5))
    ConstantForce(path='mechanism.offset', value=0.5)
    """
    own = getattr(mechanism, "offset", None)
    return ConstantForce() if own is None else ConstantForce(MECHANISM, own or 0.0)


def map_along(
    law: FrictionLaw | type[FrictionLaw],
    stretches: Sequence[MotionSegment],
    few: Sequence[MotionSegment],
    *,
    free: Collection[str] | None = None,
    held: Collection[str] = (),
    known: Mapping[str, float] | None = None,
    beside: ConstantForce = NO_FORCE,
    linear: Sequence[FreeParameter] = (),
    derived: Sequence[float] = (),
    mass: float = 0.0,
) -> tuple[ForceMap, tuple[Array, ...]]:
    """Return the problem as `force_map` does, along stretches, and other values to start from.

    Start values of a law that knows no history come from stretches of fewer samples.
    """
    kind = law if isinstance(law, type) else type(law)
    if not issubclass(kind, FrictionLaw):
        raise InputError(f"a force map needs a friction law such as Coulomb, got {kind.__name__}.")
    refuse_timeless(law, stretches)
    rough = StartEstimate.of(stretches, offset=None)
    given = bool({beside.path, "offset"} & set(held)) or beside.value != 0.0
    sought = rough.seeks_constant(kind, {beside.path, "offset"} & set(held))
    if not sought:
        rough = StartEstimate.of(stretches, offset=beside.value)
    start, free_parameters = rough.unknowns(
        law, free=free, known=known, held=held, constant=beside.path if sought else None
    )
    whole = ForceMap(
        law=start,
        free_parameters=free_parameters,
        stretches=tuple(stretches),
        constant=beside.path,
        offset=beside.value,
        derived=tuple(derived),
        mass=mass,
        one_way=bool(derived) and not (rough.two_sided or given),
    )
    coarse = replace(whole, stretches=tuple(few))
    free_parameters, unidentified = _effective(coarse if isinstance(law, type) else whole)
    if isinstance(law, type):
        unidentified = tuple(
            replace(one, start=math.nan) if one.above else one for one in unidentified
        )
    whole, coarse = (replace(one, unidentified=unidentified) for one in (whole, coarse))
    if not len(free_parameters) and not linear:
        raise InputError(
            f"there is nothing to fit: all parameters of {start.title} are fixed or have no effect"
            " on the record."
        )
    if linear:
        free_parameters = replace(free_parameters, items=(*free_parameters.items, *linear))
        own = tuple(item.path for item in linear)
        whole, coarse = (replace(one, linear=own) for one in (whole, coarse))
    problem = replace(whole, free_parameters=free_parameters)
    if not isinstance(law, type):
        return problem, ()
    first, *others = screened_starts(problem, replace(coarse, free_parameters=free_parameters))
    return replace(problem, free_parameters=free_parameters.starting_at(first)), tuple(others)


def _effective(problem: ForceMap) -> tuple[FreeParameters, tuple[FreeParameter, ...]]:
    """Return the unknowns without those that nothing in the record depends on, and these."""
    here = problem.linearise(problem.free_parameters.start)
    dead = np.all(here.slopes == 0.0, axis=0) & here.finite
    items = problem.free_parameters.items
    left = tuple(item for item, gone in zip(items, dead, strict=True) if not gone)
    unidentified = tuple(item for item, gone in zip(items, dead, strict=True) if gone)
    return replace(problem.free_parameters, items=left), unidentified
