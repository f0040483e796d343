"""Fits a law to records in time."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments import Measurement
from stickslip.friction import FrictionLaw
from stickslip.identification.doubts import bounds_met, estimates_of, sentences_of
from stickslip.identification.inference import infer
from stickslip.identification.optimise import Watch, search
from stickslip.identification.problem import Problem
from stickslip.identification.record_fit import RecordFit, scale_of
from stickslip.identification.record_starts import (
    Scales,
    joined,
    law_unknowns,
    mechanism_unknowns,
    scales_of,
)
from stickslip.identification.segmenting import RESOLUTION, measured_quantity, segments_of
from stickslip.identification.shooting import Shooting
from stickslip.identification.unknowns import Unknowns
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary

__all__ = ["SEGMENT", "STARTS", "RecordSettings", "fit_record"]

Array = NDArray[np.float64]

SEGMENT = 1.0
"""Length of a segment [s] that is simulated from a state of its own."""
STARTS = 4
"""Starts of the search."""


@dataclass(frozen=True, kw_only=True)
class RecordSettings:
    """How a record is fitted."""

    segment: float = SEGMENT
    """Length of a segment [s]."""
    resolution: int = RESOLUTION
    """Rows of a segment at most."""
    starts: int = STARTS
    """Starts of the search."""
    seed: int = 0
    """Of the jitter of further starts."""


def fit_record(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    unknown: Sequence[str] = (),
    free: Sequence[str] | None = None,
    settings: RecordSettings | None = None,
    scales: Scales | None = None,
    watch: Watch | None = None,
) -> RecordFit:
    """Fit a law to records by simulating segments of them.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured.
    law : FrictionLaw or type
        A type, whose start values come from the record; or an instance, whose values they are.
    measurement : Measurement
        Records in time with position or velocity, and the force applied if there is one.
    unknown : sequence of str
        Parameters of the mechanism that are looked for too, such as ``"inertia"``.
    free : sequence of str, optional
        Parameters of the law that are looked for; all of its `fit_order` if not given.
    settings : RecordSettings, optional
        Segments and starts.
    scales : Scales, optional
        Of the record, if they are known already.
    watch : callable, optional
        Called with the least root mean square so far; False ends the search with the best so far.

    Raises
    ------
    InputError
        If the record does not serve, or a name is not known.
    ConvergenceError
        If no start predicts the record.
    """
    settings = RecordSettings() if settings is None else settings
    measured_quantity(measurement)
    scales = scales_of(mechanism, measurement, unknown) if scales is None else scales
    start, items, further = law_unknowns(law, scales)
    if free is not None:
        check_free(start, free, [item.path for item in items])
        items = tuple(item for item in items if _is_free(item.path, free))
    unknowns = joined(start, [*items, *mechanism_unknowns(mechanism, start, unknown, scales)])
    if not len(unknowns):
        raise InputError("there is nothing to fit: name at least one parameter in `free`.")

    def build(record: Measurement, length: float | None) -> Problem:
        return Shooting(
            law=start,
            unknowns_=unknowns,
            segments=segments_of(
                mechanism,
                record,
                length=settings.segment if length is None else length,
                resolution=_rows(settings, length),
            ),
            quantity_=measured_quantity(record),
        )

    problem = build(measurement, None)
    tried = [
        np.array([other.get(p, v) for p, v in zip(unknowns.paths, unknowns.start, strict=True)])
        for other in further
    ]
    found = search(problem, starts=settings.starts, seed=settings.seed, tried=tried, watch=watch)
    return finished(
        "shooting", mechanism, measurement, start, problem=problem, build=build, found=found
    )


def finished(
    route: str,
    mechanism: Mechanism,
    measurement: Measurement,
    start: FrictionLaw,
    **parts: Any,
) -> RecordFit:
    """Return a fit from the end of its search: law, intervals and what is not told."""
    problem, found = parts["problem"], parts["found"]
    unknowns: Unknowns = problem.unknowns
    best = found.best
    at_bounds = bounds_met(unknowns, best.values)
    inference = infer(best, scale_of(unknowns, best.values, at_bounds))
    estimates = estimates_of(unknowns, best, inference, at_bounds)
    values = dict(zip(unknowns.paths, best.values.tolist(), strict=True))
    own = {path: value for path, value in values.items() if path.startswith("mechanism.")}
    fitted = vary(start, "friction", {p: v for p, v in values.items() if p not in own})
    return RecordFit(
        law=fitted,
        mechanism=vary(mechanism, "mechanism", own) if own else mechanism,
        estimates=estimates,
        route=route,
        measurement=measurement,
        inference=inference,
        at_bounds=at_bounds,
        sentences=sentences_of(unknowns, best, inference, at_bounds, estimates),
        **parts,
    )


def _rows(settings: RecordSettings, length: float | None) -> int:
    """Return the rows of a segment, so that longer ones are resolved alike."""
    if length is None:
        return settings.resolution
    return max(settings.resolution, math.ceil(settings.resolution * length / settings.segment))


def _is_free(path: str, free: Sequence[str]) -> bool:
    return path in free or path.rpartition(".")[2] in free


def check_free(law: FrictionLaw, free: Sequence[str], known: Sequence[str]) -> None:
    """Check that names are of parameters of a law."""
    for name in free:
        if not any(_is_free(path, [name]) for path in known):
            raise UnknownNameError(f"parameter of {type(law).__name__}", name, known)
