"""Records as dense series, whose force balance the evidence engine explains by terms."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.evidence import Series, outliers
from stickslip.experiments import Measurement
from stickslip.formulation import JointTorques
from stickslip.identification.contact_inputs import recorded_inputs
from stickslip.identification.force_map.data import load_along
from stickslip.identification.force_map.joint_balance import joint_series
from stickslip.identification.sensor_response import PROMPT, SensorResponse
from stickslip.identification.series.applied_force import applied_force, driven, drives_itself
from stickslip.identification.series.inverse_dynamics import (
    LEAST,
    known_forces,
    positions_of,
)
from stickslip.identification.settings import Hold
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary

Array = NDArray[np.float64]

PASSES = 3
"""Times that outliers are looked for: behind large ones there may be smaller ones."""
VARIES = 0.05
"""Range of a load over its median beyond which it varies."""


def is_dense(mechanism: Mechanism, measurement: Measurement) -> bool:
    """Whether the force balance of a measurement can be written down at every sample.

    One coordinate, in time, with positions or velocities, and either the friction itself or a force
    that drives.
    """
    if len(mechanism.coordinates) != 1 or drives_itself(mechanism, measurement):
        return False
    records = measurement.records()
    if not all(isinstance(one.time, np.ndarray) and len(one.time) >= LEAST for one in records):
        return False
    moves = all({"position", "velocity"} & set(one.quantities()) for one in records)
    return moves and ("friction" in measurement.quantities() or driven(measurement))


def dense_series(
    mechanism: Mechanism,
    measurement: Measurement,
    hold: Hold,
    unknown: Sequence[str],
    response: SensorResponse = PROMPT,
) -> tuple[Series, ...]:
    """Return the records of a mechanism as series: forces but for inertia and friction.

    The mass is a known one unless it is among what is to be found. A load that changes is a
    covariate; one that does not is left to the coefficients.
    """
    records = measurement.records()
    loads = loads_of(mechanism, measurement)
    inputs = [
        {"load": load, **recorded_inputs(one, np.asarray(one.time, dtype=float))}
        for one, load in zip(records, loads, strict=True)
    ]
    return tuple(
        _series(mechanism, record, hold, unknown, own, response)
        for record, own in zip(records, _that_vary(inputs), strict=True)
    )


def without_outliers(
    mechanism: Mechanism, measurement: Measurement
) -> tuple[Measurement, Mapping[str, int]]:
    """Return a measurement with single samples far off those beside on lines between these.

    And how many they are, by column; none where no force balance can be written down.
    """
    if not is_dense(mechanism, measurement):
        return measurement, {}
    counts: dict[str, int] = {}
    force = "friction" if "friction" in measurement.quantities() else "force"
    for _ in range(PASSES):
        records, before = [], sum(counts.values())
        every = dense_series(mechanism, measurement, "zero", ())
        for record, series in zip(measurement.records(), every, strict=True):
            columns: dict[str, Any] = {}
            for name, far in outliers(series).items():
                column = force if name == "force" else name
                if far.any() and column in record.quantities():
                    x = np.asarray(record.values(column), dtype=float)
                    columns[column] = np.where(far, np.interp(series.t, series.t[~far], x[~far]), x)
                    counts[column] = counts.get(column, 0) + int(far.sum())
            records.append(replace(record, **columns) if columns else record)
        if sum(counts.values()) == before:
            break
        if measurement.trials:
            measurement = replace(measurement, trials=tuple(records))
        else:
            (measurement,) = records
    return measurement, counts


def joints_series(
    torques: JointTorques, mechanism: Mechanism, measurement: Measurement, hold: Hold
) -> tuple[tuple[tuple[Series, ...], ...], tuple[float, ...], float]:
    """Return the series of each joint (m,), its usual load [N], and their least band [Hz].

    The mechanism has the values of its parameters nearly: a regression of each joint corrects them.
    """
    found, loads = [], []
    every, passed = joint_series(torques, mechanism, measurement, hold)
    for own in every:
        inputs = [one.covariates for one in own]
        varying = zip(own, _that_vary(inputs), strict=True)
        found.append(tuple(replace(one, covariates=columns) for one, columns in varying))
        loads.append(float(np.median(np.concatenate([one["load"] for one in inputs]))))
    return tuple(found), tuple(loads), passed


def _that_vary(inputs: Sequence[Mapping[str, Array]]) -> list[dict[str, Array]]:
    """Return what friction may depend on in each record: what all have and what changes."""
    names = []
    for name in inputs[0]:
        if not all(name in one for one in inputs):
            continue
        low, middle, high = np.percentile(
            np.concatenate([one[name] for one in inputs]), [0.0, 50.0, 100.0]
        )
        # of several trials, each may have a temperature of its own
        if high - low > (VARIES * middle if name == "load" else 0.0):
            names.append(name)
    return [{name: one[name] for name in names} for one in inputs]


def loads_of(mechanism: Mechanism, measurement: Measurement) -> list[Array]:
    """Return the normal forces [N] at the samples (n,) of each record."""
    return [
        load_along(_set_up(mechanism, one), one, len(np.asarray(one.time)))
        for one in measurement.records()
    ]


def _set_up(mechanism: Mechanism, record: Measurement) -> Mechanism:
    return vary(mechanism, "mechanism", record.overrides) if record.overrides else mechanism


def _series(
    mechanism: Mechanism,
    record: Measurement,
    hold: Hold,
    unknown: Sequence[str],
    covariates: Mapping[str, Array],
    response: SensorResponse,
) -> Series:
    time, x = np.asarray(record.time, dtype=float), positions_of(record)
    known = record.quantities()
    velocity = np.asarray(record.values("velocity")) if "velocity" in known else None
    if "friction" in known:
        friction = response.acted(time, np.asarray(record.values("friction"), dtype=float))
        return Series(time, x, friction, inertia=False, covariates=covariates, velocity=velocity)
    mechanism = _set_up(mechanism, record)
    v = np.gradient(x, time) if velocity is None else velocity
    applied = applied_force(mechanism, record)
    mass, force = known_forces(mechanism, x, v, 0.0 * x if applied is None else applied)
    return Series(
        time,
        x,
        force,
        mass=None if any(path.endswith(("inertia", "mass")) for path in unknown) else mass,
        covariates=covariates,
        velocity=velocity if "position" not in known else None,
        hold=hold == "zero" and "force" in known,
    )
