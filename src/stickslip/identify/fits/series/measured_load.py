"""A measured load in simulated runs: one number, which takes the place of the mechanism's."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.identify.fits.series.start_values import load_of
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary
from stickslip.show.formatting import number, quantity

Array = NDArray[np.float64]

PATH = "mechanism.load"
VARIES = 0.05
"""Range of a load, its outer twentieths left out, over its median, beyond which it varies."""


def loaded(mechanism: Mechanism, measurement: Measurement) -> Measurement:
    """Return a measurement with each measured load as an override of the mechanism's.

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


def as_loaded(mechanism: Mechanism, measurement: Measurement) -> tuple[Mechanism, str]:
    """Return a mechanism under the load that was measured, and what is to be said of it.

    It is that of simulations to come: coefficients that were found under one load are those of
    another friction under another.

    Examples
    --------
    >>> from stickslip import Axis
    >>> table = Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.4], load=[4.9, 5.1])
    >>> axis, said = as_loaded(Axis(inertia=1.0), table)
    >>> axis.load, said
    (5.0, '')
    """
    loads = _measured(measurement)
    if not len(loads):
        return mechanism, ""
    low, middle, high = np.percentile(loads, [5.0, 50.0, 95.0])
    varies = high - low > VARIES * middle
    usual = float(middle if varies else np.mean(loads))
    span = f"{number(float(loads.min()))} to {number(float(loads.max()))} N"
    if "load" not in mechanism.__dataclass_fields__:
        own = load_of(mechanism)
        if not varies and abs(own - usual) <= VARIES * usual:
            return mechanism, ""
        return mechanism, (
            f"The load was measured, {span if varies else f'{number(usual)} N'}; here it follows"
            f" from the parameters of {type(mechanism).__name__}, {number(own)} N."
        )
    said = f"The load was measured and varies, {span}: here it is the median." if varies else ""
    return vary(mechanism, "mechanism", {PATH: usual}), said


def _measured(measurement: Measurement) -> Array:
    """Return the loads [N] of all records, measured or set, one for each sample of those."""
    found = [np.zeros(0)]
    for one in measurement.records():
        if "load" in one.quantities():
            found.append(np.atleast_1d(np.asarray(one.values("load"), dtype=float)))
        elif PATH in one.overrides:
            found.append(np.array([one.overrides[PATH]]))
    return np.concatenate(found)


def _loaded(mechanism: Mechanism, record: Measurement) -> Measurement:
    if "load" not in record.quantities():
        return record
    label = f"record {record.name!r}" if record.name else "the record"
    values = np.atleast_1d(np.asarray(record.values("load")))
    low, high = float(values.min()), float(values.max())
    if low != high:
        raise InputError(
            f"the load of {label} changes from {quantity(low, 'N', 4)} to"
            f" {quantity(high, 'N', 4)}, and simulated segments"
            ' take one load: fit with route="inverse-dynamics", or "force-map" where friction was'
            " measured, or leave the load out."
        )
    if low <= 0.0:
        raise InputError(f"the load of {label} must be above 0 N, got {quantity(low, 'N', 4)}.")
    kind = type(mechanism).__name__
    if "load" not in mechanism.__dataclass_fields__:
        raise InputError(
            f"the load of {label} was measured, {quantity(low, 'N', 4)}, and that of {kind}"
            " follows from its"
            " own parameters: leave the load out, or use a mechanism with a load, such as Axis."
        )
    if record.overrides.get(PATH, low) != low:
        raise InputError(
            f"the load of {label} is given twice: {quantity(low, 'N', 4)} measured, and"
            f" {quantity(record.overrides[PATH], 'N', 4)} in overrides. Leave one out."
        )
    return replace(
        record,
        load=None,
        offset={name: value for name, value in record.offset.items() if name != "load"},
        overrides={**record.overrides, PATH: low},
    )
