"""What the uncertainties of a mechanism's parameters make of fits to records, to first order.

A parameter that is held at a wrong value moves the residuals of a record, and least squares follows
with one Gauss-Newton step: the same slopes that the fit ended with, and no further fit.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError, InputError
from stickslip.experiments import Measurement
from stickslip.identification.estimation.jackknife import Displaced
from stickslip.identification.estimation.problem import RecordProblem, ResidualJacobian
from stickslip.identification.rig_uncertainties import span_of, uncertainties_of
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary

Array: TypeAlias = NDArray[np.float64]

LOAD = "mechanism.load"
"""What a measured load takes the place of."""


def displacements(
    again: Callable[[Measurement], RecordProblem],
    best: ResidualJacobian,
    mechanism: Mechanism,
    measurement: Measurement,
) -> tuple[Displaced, ...]:
    """Return how far stated uncertainties of a mechanism move the residuals of a fit.

    A parameter that is looked for, as a constant force is without being asked for, is known from
    the record; what was stated of it is not used.
    """
    uncertainties = uncertainties_of(mechanism, measurement)
    stated = dict.fromkeys(path for pair in uncertainties for one in pair for path in one)
    if not stated:
        return ()
    _refuse_load(stated, measurement)
    problem = again(measurement)
    paths = [path for path in stated if path not in problem.free_parameters.paths]
    record_of = problem.spans[:, 0].astype(int)[best.segment]
    found = []
    for path in paths:
        errors = [{**shared, **own}.get(path, 0.0) for own, shared in uncertainties]
        rows = _moved(again, best, mechanism, measurement, path, errors, record_of)
        common = np.array([path in shared for _, shared in uncertainties])[record_of]
        if common.any():
            found.append(Displaced(path=path, rows=rows * common))
        for own in (~common & (record_of == k) for k, error in enumerate(errors) if error):
            if own.any():
                found.append(Displaced(path=path, rows=rows * own, shared=False))
    return tuple(found)


def _refuse_load(paths: Collection[str], measurement: Measurement) -> None:
    if LOAD in paths and "load" in measurement.quantities():
        raise InputError(
            f"the uncertainty of {LOAD} was stated, but the measured load replaces its value:"
            " leave the uncertainty out."
        )


def _moved(
    again: Callable[[Measurement], RecordProblem],
    best: ResidualJacobian,
    mechanism: Mechanism,
    measurement: Measurement,
    path: str,
    errors: Sequence[float],
    record_of: NDArray[np.intp],
) -> Array:
    """Return by how much the uncertainty of a parameter in each record moves the residuals (n,)."""
    records = measurement.records()
    spans = np.array(
        [
            span_of(vary(mechanism, "mechanism", record.overrides), path, error)
            if error
            else (0.0, 1.0)
            for record, error in zip(records, errors, strict=True)
        ]
    )
    sides = []
    for ends in spans.T.tolist():
        changed = tuple(
            replace(record, overrides={**record.overrides, path: end}) if error else record
            for record, end, error in zip(records, ends, errors, strict=True)
        )
        whole = replace(measurement, trials=changed) if measurement.trials else changed[0]
        sides.append(again(whole).carried(best))
    if not all(np.all(np.isfinite(side)) for side in sides):
        raise ConvergenceError(
            f"the uncertainty of {path} cannot be propagated: the record cannot be simulated with"
            " values close to the stated one. Leave the uncertainty out."
        )
    slopes = np.array(errors) / (spans[:, 1] - spans[:, 0])
    return np.asarray((sides[1] - sides[0]) * slopes[record_of])
