"""Records as dense series, whose force balance the evidence engine explains by terms."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from stickslip.contact_inputs import DRIVES
from stickslip.errors import InputError
from stickslip.evidence import Series, outliers
from stickslip.experiments import Measurement, as_recorded, between_gaps, with_voltage
from stickslip.formulation import JointTorques
from stickslip.identification.contact_inputs import inputs_along, recorded_inputs
from stickslip.identification.force_map.data import load_along, smoothed
from stickslip.identification.force_map.force_balance import (
    filtered_motion,
    mean_force,
    passed_by_balance,
    second_differences,
)
from stickslip.identification.force_map.gear_torques import gear_torques
from stickslip.identification.force_map.joint_balance import AHEAD, WIDEST, joint_series
from stickslip.identification.series.applied_force import (
    applied_force,
    driven,
    drives_itself,
    goes_straight,
)
from stickslip.identification.series.inverse_dynamics import (
    LEAST,
    known_forces,
    mass_of,
    positions_of,
)
from stickslip.identification.settings import PROMPT, Hold, SensorResponse
from stickslip.mechanisms import Mechanism, input_names, of_contact
from stickslip.quantities import parameters, vary

Array = NDArray[np.float64]

PASSES = 3
"""Times that outliers are looked for: behind large ones there may be smaller ones."""
FOUND = ("inertia", "mass", "offset")
"""Ends of paths of unknowns that have a term of their own."""
LINEAR = 1e-6
"""Share of a slope by which a second step may differ from a first."""
ZERO = "zero of the position"
"""Name of a constant force that stands for where a spring is relaxed."""
VARIES = 0.05
"""Range of a load over its median beyond which it varies."""


def is_dense(mechanism: Mechanism, measurement: Measurement) -> bool:
    """Whether the force balance of a measurement can be written down at every sample.

    One coordinate, in time, with positions or velocities, that no drive of the mechanism's own
    moves. Where neither friction nor a force was recorded, it moves freely.
    """
    if len(mechanism.coordinates) != 1 or drives_itself(mechanism, measurement):
        return False
    records = measurement.records()
    if not all(isinstance(one.time, np.ndarray) and len(one.time) >= LEAST for one in records):
        return False
    return all({"position", "velocity"} & set(one.quantities()) for one in records)


@final
@dataclass(frozen=True, kw_only=True)
class _Forces:
    """Forces on a coordinate along a record."""

    applied: Array
    """By what drives it (n,) [N]."""
    taken: Array
    """What the known motion takes but for inertia and friction (n,) [N]."""
    columns: Mapping[str, Array]
    """What it takes for each unknown by path, per unit of it (n,)."""


def _forces(mechanism: Mechanism, record: Measurement, unknown: Sequence[str]) -> _Forces:
    """Return the forces along a record, split by unknowns that are coefficients of columns.

    An unknown is one if the force balance is linear in it and nothing else depends on it, as for
    a stiffness or a damping; an `InputError` names one that is none.
    """
    record = with_voltage(mechanism, record, "zero")
    known = record.quantities()
    time, x = np.asarray(record.time, dtype=float), positions_of(record)
    v = np.asarray(record.values("velocity")) if "velocity" in known else np.gradient(x, time)

    def on(one: Mechanism) -> tuple[Array, Array]:
        applied = applied_force(one, record)
        mass, still = known_forces(one, x, v, 0.0 * x)
        force = still if applied is None else known_forces(one, x, v, applied)[1]
        return force - still, np.append(still, [mass, load_along(one, record, len(x))[0]])

    given = as_recorded(mechanism, record)
    applied, still = on(given)
    columns = {}
    for path in unknown:
        value = _value(given, path)
        step = abs(value) or 1.0
        others = [vary(given, "mechanism", {path: value + n * step}) for n in (1.0, 2.0)]
        (first, first_still), (second, second_still) = map(on, others)
        slope = (np.append(first - applied, first_still - still)) / step
        twice = (np.append(second - applied, second_still - still)) / step
        bent = np.max(np.abs(twice - 2.0 * slope)) > LINEAR * np.max(np.abs(slope))
        if bent or np.any(np.abs(slope[-2:] * step) > LINEAR * np.abs(still[-2:])):
            raise InputError(f"the force balance is not linear in {path} alone.")
        columns[path] = -(slope[: len(x)] + slope[len(x) : -2])
    taken = -still[:-2]
    # each column has the whole of its unknown, not what the given value lacks
    for path, column in columns.items():
        taken = taken - _value(given, path) * column
    if np.ptp(taken) <= LINEAR * np.ptp(still[:-2]):  # what is left of unknowns is rounding
        taken = np.full_like(taken, np.median(taken))
    return _Forces(applied=applied, taken=taken, columns=columns)


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
    loads = loads_of(mechanism, measurement)
    return _with_what_varies(
        _series(mechanism, record, hold, unknown, load, response)
        for record, load in zip(measurement.records(), loads, strict=True)
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
        found.append(_with_what_varies(own))
        loads.append(float(np.median(np.concatenate([one.covariates["load"] for one in own]))))
    return tuple(found), tuple(loads), passed


def _with_what_varies(series: Iterable[Series]) -> tuple[Series, ...]:
    """Return series with what friction may depend on: what all of them have and what changes."""
    found, names = tuple(series), []
    inputs = [one.covariates for one in found]
    for name in inputs[0]:
        if not all(name in one for one in inputs):
            continue
        low, middle, high = np.percentile(
            np.concatenate([_counted(one, name) for one in inputs]), [0.0, 50.0, 100.0]
        )
        # of several trials, each may have a temperature of its own
        if high - low > (VARIES * middle if name in ("load", *DRIVES) else 0.0):
            names.append(name)
    return tuple(
        replace(one, covariates={name: one.covariates[name] for name in names}) for one in found
    )


def _counted(inputs: Mapping[str, Array], name: str) -> Array:
    """Return what friction may depend on of an input: of a force through a gear its size.

    The motor's force is none where it is that which the gear transmits.
    """
    if name == "motor" and "transmitted" in inputs:
        other = inputs["transmitted"]
        same = np.ptp(other - inputs[name]) <= VARIES * np.ptp(other)
        return np.zeros_like(other) if same else np.abs(inputs[name])
    return np.abs(inputs[name]) if name in DRIVES else inputs[name]


def loads_of(mechanism: Mechanism, measurement: Measurement) -> list[Array]:
    """Return the normal forces [N] at the samples (n,) of each record."""
    return [
        load_along(as_recorded(mechanism, one), one, len(np.asarray(one.time)))
        for one in measurement.records()
    ]


def finds_mass(unknown: Sequence[str]) -> bool:
    """Whether a mass is among what is to be found."""
    return any(path.endswith(("inertia", "mass")) for path in unknown)


def varies_load(mechanism: Mechanism, measurement: Measurement) -> bool:
    """Whether forces other than the drive's change along a record, as weight does.

    Examples
    --------
    >>> from stickslip import Axis, Pendulum
    >>> record = Measurement(time=[0.0, 1.0], position=[0.0, 0.9])
    >>> varies_load(Pendulum(mass=0.5, length=0.1), record), varies_load(Axis(inertia=1.0), record)
    (True, False)
    """
    told = []
    for record in measurement.records():
        own, x = as_recorded(mechanism, record), positions_of(record)
        inputs = inputs_along(own, record, np.asarray(record.time), position=x, velocity=0.0)
        told.append(inputs.get("external", 0.0 * x))
    return bool(np.ptp(np.concatenate(told)) > 0.0)


def _value(mechanism: Mechanism, path: str) -> float:
    return next(value for name, _, value in parameters(mechanism, "mechanism") if name == path)


def _series(
    mechanism: Mechanism,
    record: Measurement,
    hold: Hold,
    unknown: Sequence[str],
    load: Array,
    response: SensorResponse,
) -> Series:
    """Return one record; of a free motion with a spring, with the zero that its fits look for."""
    time, x = np.asarray(record.time, dtype=float), positions_of(record)
    known = record.quantities()
    velocity = np.asarray(record.values("velocity")) if "velocity" in known else None
    covariates = {"load": load, **recorded_inputs(record, time)}
    if "friction" in known:
        friction = response.acted(time, np.asarray(record.values("friction"), dtype=float))
        if {"motor", "external"} <= {*covariates}:
            motor, beside = covariates["motor"], covariates.pop("external")
            covariates |= _gear(record, motor, motor - friction, beside, 0.0 * beside)
        return Series(time, x, friction, inertia=False, covariates=covariates, velocity=velocity)
    forces = _forces(mechanism, record, [one for one in unknown if not one.endswith(FOUND)])
    mass = None if finds_mass(unknown) else mass_of(as_recorded(mechanism, record))
    varies = bool(np.ptp(forces.taken) > 0.0)
    extra = dict(forces.columns)
    if varies or extra:
        if "position" not in known:
            raise InputError("forces depend on positions, which were not recorded.")
        if not driven(record):
            extra[ZERO] = np.ones_like(x)
    return Series(
        time,
        x,
        forces.applied if varies else forces.applied - forces.taken,
        mass=mass,
        taken=forces.taken if varies else None,
        extra=extra,
        covariates={**_told_gear(mechanism, record, hold, unknown, forces, mass), **covariates},
        velocity=velocity if "position" not in known else None,
        hold=not goes_straight(record, hold),
    )


def _told_gear(
    mechanism: Mechanism,
    record: Measurement,
    hold: Hold,
    unknown: Sequence[str],
    forces: _Forces,
    mass: float | None,
) -> dict[str, Array]:
    """Return the torques of a gear along a record (n,), by name.

    None where nothing drives the motion, where the mechanism does not tell both sides of the gear,
    or where what it tells changes with an unknown.
    """
    record = with_voltage(mechanism, record, "zero")
    own, time = as_recorded(mechanism, record), np.asarray(record.time, dtype=float)
    if not (driven(record) and {"motor", "external"} <= {*input_names(own)}):
        return {}
    weighs = "offset" in own.__dataclass_fields__
    if weighs:  # the constant force of the series is found beside friction
        own = vary(own, "mechanism", {"mechanism.offset": 0.0})
    if any(_moves_inputs(own, path) for path in unknown if not path.endswith("offset")):
        return {}
    x, known = positions_of(record), record.quantities()
    v = np.asarray(record.values("velocity")) if "velocity" in known else np.gradient(x, time)
    told = inputs_along(own, record, time, position=x, velocity=v, force=0.0)
    return _gear(
        record,
        mean_force(forces.applied, joined=goes_straight(record, hold)),
        forces.taken,
        told["external"],
        told["motor"],
        mass=mass,
        columns=tuple(forces.columns.values()),
        weighs=weighs,
    )


def _gear(
    record: Measurement,
    applied: Array,
    taken: Array,
    external: Array,
    within: Array,
    *,
    mass: float | None = 0.0,
    columns: Sequence[Array] = (),
    weighs: bool = False,
) -> dict[str, Array]:
    """Return the torques of a gear (n,) from forces along a record; 0 in what is too short."""
    times = np.asarray(record.time, dtype=float)
    found: dict[str, Array] = {}
    for piece in between_gaps(record):
        time = np.asarray(piece.time, dtype=float)
        if len(time) < LEAST:
            continue
        rows = np.searchsorted(times, time)
        raw, dt = positions_of(piece), float(np.ptp(time)) / (len(time) - 1)
        passed = passed_by_balance(raw)
        a = second_differences(smoothed(raw, min(AHEAD * passed, WIDEST)), dt)
        unknown = [one[rows] for one in columns]
        torques = gear_torques(
            filtered_motion(raw, dt, passed, tracked="position" in piece.quantities()),
            applied[rows],
            taken[rows] + (mass or 0.0) * a,
            external[rows],
            passed,
            within=within[rows],
            unknown=unknown if mass is not None else [a, *unknown],
            weighs=weighs,
        )
        for name, torque in torques.items():
            found.setdefault(name, np.zeros_like(applied))[rows] = torque
    return found


def _moves_inputs(mechanism: Mechanism, path: str) -> bool:
    """Whether the forces on either side of a gear change with a parameter."""
    value = _value(mechanism, path)
    other = vary(mechanism, "mechanism", {path: 0.999 * value if value else LINEAR})
    at: Any = defaultdict(lambda: 0.7)
    told, moved = (
        of_contact(one.contact_inputs(0.0, at, at, at), "") for one in (mechanism, other)
    )
    return any(told[name] != moved[name] for name in ("motor", "external"))
