"""A measured load in simulated runs: one number, which takes the place of the mechanism's."""

from dataclasses import replace

import numpy as np

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary

__all__ = ["loaded", "with_usual_load"]

PATH = "mechanism.load"


def loaded(mechanism: Mechanism, measurement: Measurement) -> Measurement:
    """Return a measurement with each measured load as an override of the mechanism's.

    Raises
    ------
    InputError
        If a load changes, the mechanism has none to be set, or an override sets it too.

    Examples
    --------
    >>> from stickslip import Axis
    >>> record = Measurement(time=[0.0, 1.0], position=[0.0, 0.1], load=5.0)
    >>> loaded(Axis(inertia=1.0), record).overrides
    {'mechanism.load': 5.0}
    """
    if "load" not in measurement.quantities():
        return measurement
    records = tuple(_loaded(mechanism, record) for record in measurement.records())
    return replace(measurement, trials=records) if measurement.trials else records[0]


def with_usual_load(mechanism: Mechanism, measurement: Measurement) -> Mechanism:
    """Return a mechanism with the load that was measured, the median of those of several trials.

    Examples
    --------
    >>> from stickslip import Axis
    >>> record = Measurement(time=[0.0, 1.0], position=[0.0, 0.1], load=5.0)
    >>> with_usual_load(Axis(inertia=1.0), record).load
    5.0
    """
    found = [one.overrides.get(PATH) for one in loaded(mechanism, measurement).records()]
    loads = [value for value in found if value is not None]
    if "load" not in measurement.quantities() or not loads:
        return mechanism
    return vary(mechanism, "mechanism", {PATH: float(np.median(loads))})


def _loaded(mechanism: Mechanism, record: Measurement) -> Measurement:
    if "load" not in record.quantities():
        return record
    label = f"record {record.name!r}" if record.name else "the record"
    values = np.atleast_1d(np.asarray(record.values("load")))
    low, high = float(values.min()), float(values.max())
    if low != high:
        raise InputError(
            f"the load of {label} changes from {low:.4g} N to {high:.4g} N, and simulated segments"
            ' take one load: fit with route="inverse-dynamics", or "force-map" where friction was'
            " measured, or leave the load out."
        )
    if low <= 0.0:
        raise InputError(f"the load of {label} must be above 0 N, got {low:.4g} N.")
    kind = type(mechanism).__name__
    if "load" not in mechanism.__dataclass_fields__:
        raise InputError(
            f"the load of {label} was measured, {low:.4g} N, and that of {kind} follows from its"
            " own parameters: leave the load out, or use a mechanism with a load, such as Axis."
        )
    if record.overrides.get(PATH, low) != low:
        raise InputError(
            f"the load of {label} is given twice: {low:.4g} N measured, and"
            f" {record.overrides[PATH]:.4g} N in overrides. Leave one out."
        )
    return replace(
        record,
        load=None,
        offset={name: value for name, value in record.offset.items() if name != "load"},
        overrides={**record.overrides, PATH: low},
    )
