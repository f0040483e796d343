"""Load and contact inputs of records: of the mechanism, a column, or a condition of the trial."""

import math
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from stickslip.data import (
    UNIT_LOAD,
    Measurement,
    as_recorded,
    command_of,
    unit_of_input,
    with_voltage,
)
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, Laws
from stickslip.identify.fits.settings import ROUNDING
from stickslip.mechanisms import (
    ContactInputs,
    Mechanism,
    gear_inputs,
    given_inputs,
    given_names,
    input_names,
    normal_of,
    of_contact,
    only_contact,
    slip_of,
    told_fields,
)
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS, DRIVES
from stickslip.mechanisms.drives import Drive, Sampled
from stickslip.quantities import vary
from stickslip.show.formatting import joined, number, quantity, span

Array = NDArray[np.float64]

LOAD = "mechanism.load"
VARIES = 0.05
"""Range of a load, its outer twentieths left out, over its median, beyond which it varies."""


def known_inputs(mechanism: Mechanism, measurement: Measurement) -> tuple[str, ...]:
    """Return the contact inputs that a fit of a measurement can use.

    Where friction was measured without the force of the drive, a mechanism tells none that has it.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> record = Measurement(time=[0, 1], position=[0, 1], inputs={"temperature": 20.0})
    >>> "temperature" in known_inputs(SpringBlock(mass=1.0), record)
    True
    """
    told, recorded = input_names(mechanism), measurement.input_names()
    measured = measurement.quantities()
    if "friction" in measured and "force" not in measured:
        given = given_names(mechanism)
        told = tuple(name for name in told if name in given or name not in DRIVES)
    if {"motor", "external"} <= {*recorded}:
        recorded = (*recorded, *gear_inputs(0.0, 0.0))
    return tuple(dict.fromkeys((*told, *recorded)))


def check_inputs(
    law: object,
    mechanism: Mechanism,
    measurement: Measurement,
    known: Collection[str] | None = None,
    *,
    contact: str = "",
    fitted: Sequence[str] = (),
) -> None:
    """Refuse a law that asks for a contact input which nothing tells.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> check_inputs(Coulomb, SpringBlock(mass=1.0), Measurement(travel=0.2))
    """
    known = known_inputs(mechanism, measurement) if known is None else known
    for name in getattr(law, "inputs", ()):
        if name not in known:
            why = _why(name, mechanism, measurement, contact, fitted)
            raise InputError(_missing(law, name, why, measurement, known))


def _why(
    name: str, mechanism: Mechanism, measurement: Measurement, contact: str, fitted: Sequence[str]
) -> str:
    """Return why a contact input is not known."""
    records = measurement.records()
    some = sum(name in record.contact_inputs() for record in records)
    if name in input_names(mechanism, contact):
        why = f"{type(mechanism).__name__} tells it by a force or motion that was not measured"
        return f"{why}, or by what is fitted, {joined(fitted)}" if fitted else why
    if some:
        return f"only {some} of {len(records)} trials have it"
    return f"neither {type(mechanism).__name__} nor the record tells it"


def _missing(
    law: Any, name: str, why: str, measurement: Measurement, known: Collection[str]
) -> str:
    """Return what a law lacks, and what there is."""
    records = measurement.records()
    unused = dict.fromkeys(column for record in records for column in record.unused)
    columns = [*measurement.quantities(), *(item for item in unused if item not in known)]
    return (
        f"{law.name} depends on the contact input {name!r}, and {why}. Known inputs:"
        f" {', '.join(known) or 'none'}; columns of the record: {', '.join(columns)}. Name the"
        f" column that holds it, as --columns {name}=... (in Python columns={{{name!r}: ...}}),"
        " state it as a condition of each trial, or give a law without it."
    )


def inputs_along(
    mechanism: Mechanism,
    record: Measurement,
    time: Array,
    *,
    position: Array | float = math.nan,
    velocity: Array | float = math.nan,
    force: Array | float = math.nan,
) -> dict[str, Array]:
    """Return contact inputs at each sample (n,): the mechanism's, then the record's, then given.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> t = np.array([0.0, 0.5, 1.0])
    >>> record = Measurement(time=[0, 1], position=[0, 1], inputs={"temperature": [20.0, 22.0]})
    >>> inputs_along(SpringBlock(mass=1.0), record, t)["temperature"]
    array([20., 21., 22.])
    """
    slip = slip_of(mechanism)

    def unknown(known: Mapping[str, Any]) -> Mapping[str, Any]:
        return defaultdict(lambda: math.nan, known)

    drives: dict[str, Array | float] = {
        name: np.array([drive.value(float(t)) for t in time])
        for name, drive in mechanism.drives().items()
        if name != "drive"
    }
    told = mechanism.contact_inputs(
        time,
        unknown({slip: position}),
        unknown({slip: velocity}),
        unknown(drives | {"drive": force}),
    )
    contact, recorded = only_contact(mechanism).name, recorded_inputs(record, time)
    measured = "friction" in record.quantities()
    return _known(mechanism, contact, told, recorded, time, measured=measured)


def _known(
    mechanism: Mechanism,
    contact: str,
    told: ContactInputs,
    recorded: Mapping[str, Array],
    time: Array,
    *,
    measured: bool = False,
) -> dict[str, Array]:
    """Return inputs of a contact (n,): what the mechanism computes, the record's, given ones.

    Where friction was `measured`, forces beside it are those of the record, if it has them.
    """
    own: Mapping[str, Any] = of_contact(told, contact)
    if {"motor", "external"} <= recorded.keys():
        recorded = gear_inputs(recorded["motor"], recorded["external"]) | {**recorded}
    later = {*given_names(mechanism, contact), *(recorded if measured else ())}
    first = {name: own[name] for name in own if name not in later}
    result = {**own, **recorded, **first}
    columns = {name: np.asarray(x + 0.0 * time) for name, x in result.items()}
    return {name: x for name, x in columns.items() if np.all(np.isfinite(x))}


def joint_inputs(
    mechanism: Mechanism,
    contacts: Mapping[str, str],
    record: Measurement,
    time: Array,
    places: Array,
    rates: Array,
    applied: Array,
) -> list[dict[str, Array]]:
    """Return contact inputs of each joint at each sample (n,), the motor's force as measured."""
    names = mechanism.coordinates
    given = {
        name: np.array([drive.value(float(now)) for now in time])
        for name, drive in mechanism.drives().items()
        if name in told_fields(mechanism)
    }
    drives = defaultdict(lambda: np.zeros_like(time), given)
    q, q_dot = (dict(zip(names, rows.T, strict=True)) for rows in (places, rates))
    told = mechanism.contact_inputs(time, q, q_dot, drives)
    result = []
    for name, force in zip(names, applied.T, strict=True):
        contact = contacts.get(name, "")
        own = _known(mechanism, contact, told, recorded_inputs(record, time, name), time)
        computed = own.keys() - given_names(mechanism, contact)
        own |= gear_inputs(force, own["external"]) if {"motor", "external"} <= computed else {}
        result.append(own)
    return result


def recorded_inputs(record: Measurement, time: Array, joint: str = "") -> dict[str, Array]:
    """Return the contact inputs that a record has, of a joint where it has its own, at times.

    Examples
    --------
    >>> record = Measurement(time=[0, 1], position=[0, 1], inputs={"temperature": [20.0, 22.0]})
    >>> recorded_inputs(record, np.array([0.5]))
    {'temperature': array([21.])}
    """
    times = time if record.time is None else np.asarray(record.time)
    return {
        name: np.interp(time, times, np.broadcast_to(value, times.shape))
        for name, value in record.contact_inputs(joint).items()
    }


def with_inputs(mechanism: Mechanism, record: Measurement, times: Array) -> Mechanism:
    """Return a mechanism that tells its laws what a record has of contact inputs.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> record = Measurement(time=[0, 1], position=[0, 1], inputs={"temperature": [20.0, 22.0]})
    >>> warm = with_inputs(SpringBlock(mass=1.0), record, record.time)
    >>> warm.drives()["contact_temperature"].value(0.5)
    21.0
    """
    inputs: dict[str, dict[str, Drive | float]] = {"": {}}
    for joint, contact in _contacts_of(mechanism, [record]):
        own = set(input_names(mechanism, contact)).difference(given_names(mechanism, contact))
        for name, seen in recorded_inputs(record, times, joint).items():
            if name not in own and (not joint or name in record.joints[joint].inputs):
                inputs.setdefault(contact, {})[name] = (
                    Sampled(times=times - times[0], values=seen, hold="first")
                    if np.ptp(seen) > 0.0
                    else float(seen[0])
                )
    return given_inputs(mechanism, {**inputs.pop(""), **inputs})


def _contacts_of(
    mechanism: Mechanism, records: Sequence[Measurement]
) -> tuple[tuple[str, str], ...]:
    """Return joints that have inputs of their own in all records, with the contacts along them.

    And the contact of no joint, both empty: what is told to it, all are told.
    """
    having = [
        joint
        for joint in (records[0].joints if records else ())
        if all(joint in record.joints and record.joints[joint].inputs for record in records)
    ]
    contacts = [
        (contact.slip, contact.name)
        for contact in mechanism.contacts()
        if isinstance(contact.slip, str)
    ]
    return (("", ""), *(contact for contact in contacts if contact[0] in having))


def _asked(law: FrictionLaw | Laws) -> Sequence[str]:
    """Return the contact inputs of a law, or of those of several contacts."""
    if isinstance(law, FrictionLaw):
        return law.inputs
    return tuple(dict.fromkeys(name for _, item in law.members for name in item.inputs))


def as_informed(
    law: FrictionLaw | Laws, mechanism: Mechanism, measurement: Measurement
) -> tuple[Mechanism, tuple[str, ...]]:
    """Return a mechanism with what was measured of a law's inputs, and what is to be said of it.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> law = Coulomb(kinetic_coefficient=0.2)
    >>> as_informed(law, SpringBlock(mass=1.0), Measurement(travel=0.2))[1]
    ()
    """
    result: dict[str, dict[str, float]] = {"": {}}
    said = []
    records = measurement.records()
    for joint, contact in _contacts_of(mechanism, records):
        own = set(input_names(mechanism, contact)).difference(given_names(mechanism, contact))
        for name in _asked(law):
            held = [
                (record.joints[joint] if joint else record).contact_inputs() for record in records
            ]
            parts = [item.get(name) for item in held]
            if name in own or any(part is None for part in parts):
                continue
            values = np.concatenate([np.atleast_1d(np.asarray(x, dtype=float)) for x in parts])
            middle, low, high = (float(of(values)) for of in (np.median, np.min, np.max))
            result.setdefault(contact, {})[name] = middle
            if high > low:
                unit = unit_of_input(name, turning=measurement.turning)
                what = f"The {name} of the {joint}" if joint else f"The {name}"
                said.append(
                    f"{what} was measured and varies, {span(low, high, unit)}: in runs of this fit"
                    f" it is the median, {quantity(middle, unit)}."
                )
    return given_inputs(mechanism, {**result.pop(""), **result}), tuple(dict.fromkeys(said))


def unvaried(law: FrictionLaw | Laws, inputs: Sequence[Mapping[str, Array]]) -> tuple[str, ...]:
    """Return sentences on inputs of a law that never change.

    Examples
    --------
    >>> from stickslip.friction import law
    >>> kind = law("level * linear[temperature]")
    >>> warm = kind(kinetic_coefficient=0.2, level_temperature_slope=0.01)
    >>> unvaried(warm, [{"temperature": np.array([20.0, 20.0])}])
    ('The temperature is constant in this record: its effect cannot be told.',)
    """
    result = []
    for name in _asked(law):
        values = np.concatenate([item[name] for item in inputs if name in item] or [np.zeros(0)])
        if len(values) and np.ptp(values) <= ROUNDING * float(np.max(np.abs(values))):
            result.append(f"The {name} is constant in this record: its effect cannot be told.")
    return tuple(result)


def typical_inputs(
    law: FrictionLaw, mechanism: Mechanism, measurement: Measurement
) -> dict[str, float]:
    """Return what a law's inputs usually were, at which curves are drawn: medians.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> law = Coulomb(kinetic_coefficient=0.2)
    >>> typical_inputs(law, SpringBlock(mass=1.0), Measurement(travel=0.2))
    {}
    """
    if not law.inputs:
        return {}
    every: dict[str, list[Array]] = {name: [] for name in law.inputs}
    for given in measurement.records():
        record = with_voltage(mechanism, given)
        set_up = as_recorded(mechanism, record)
        names = {"position": "position", "velocity": "velocity", "force": command_of(record)}
        signals: dict[str, Any] = {
            name: record.values(column)
            for name, column in names.items()
            if column in record.quantities()
        }
        if record.time is None:
            time = np.arange(max(map(np.size, signals.values()), default=1), dtype=float)
        else:
            time = np.asarray(record.time)
            x, v = signals.get("position"), signals.get("velocity")
            signals |= {"velocity": np.gradient(x, time)} if v is None and x is not None else {}
            signals.setdefault("force", 0.0)
        for name, values in inputs_along(set_up, record, time, **signals).items():
            if name in every:
                every[name].append(values)
    result = usual_values({name: values for name, values in every.items() if values})
    return {name: result.get(name, CONTACT_INPUTS[name].size) for name in every}


def usual_values(inputs: Mapping[str, Sequence[Array]]) -> dict[str, float]:
    """Return medians of contact inputs over the stretches of a record, of forces of their sizes.

    Both torques of a gear are those where it transmits the median: of their sizes alone, a gear
    that holds a weight would transmit nothing.

    Examples
    --------
    >>> usual_values({"motor": [np.array([5.0, 1.0, 4.0])], "external": [np.array([-5, 0, -4])]})
    {'motor': 4.0, 'external': -4.0}
    """
    whole = {name: np.concatenate(values) for name, values in inputs.items()}
    result = {
        name: float(np.median(np.abs(x) if CONTACT_INPUTS[name].scale else x))
        for name, x in whole.items()
    }
    motor, external = whole.get("motor"), whole.get("external")
    if motor is not None and external is not None and len(motor) == len(external):
        through = np.abs(motor - external)
        middle = np.argsort(through)[len(through) // 2]
        result |= {"motor": float(motor[middle]), "external": float(external[middle])}
    return result


def inputs_text(inputs: Mapping[str, float], *, turning: bool = False) -> str:
    """Return values of contact inputs in words.

    Examples
    --------
    >>> inputs_text({"temperature": 35.0, "transmitted": 2.0}, turning=True)
    'temperature 35 °C and transmitted 2 N m'
    """
    return joined(
        [
            f"{name} {quantity(value, unit_of_input(name, turning=turning))}"
            for name, value in inputs.items()
        ]
    )


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
    records = tuple(_with_load(mechanism, record) for record in measurement.records())
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
    loads = measured_loads(measurement)
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
    return vary(mechanism, "mechanism", {LOAD: usual}), said


def measured_loads(measurement: Measurement) -> Array:
    """Return the loads [N] of all records, measured or set, one for each sample of those.

    Examples
    --------
    >>> measured_loads(Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.4], load=[4.9, 5.1]))
    array([4.9, 5.1])
    """
    result = [np.zeros(0)]
    for record in measurement.records():
        if "load" in record.quantities():
            result.append(np.atleast_1d(np.asarray(record.values("load"), dtype=float)))
        elif LOAD in record.overrides:
            result.append(np.array([record.overrides[LOAD]]))
    return np.concatenate(result)


def _with_load(mechanism: Mechanism, record: Measurement) -> Measurement:
    if "load" not in record.quantities():
        return record
    label = f"record {record.name!r}" if record.name else "the record"
    values = np.atleast_1d(np.asarray(record.values("load")))
    low, high = float(values.min()), float(values.max())
    if low != high:
        raise InputError(
            f"the load of {label} changes from {quantity(low, 'N', 4)} to"
            f" {quantity(high, 'N', 4)}, and runs take one load: give their mean, or leave the load"
            " out."
        )
    if low <= 0.0:
        raise InputError(f"the load of {label} must be above 0 N, got {quantity(low, 'N', 4)}.")
    _refuse_own_load(mechanism, label, low)
    return replace(
        record,
        load=None,
        offset={name: value for name, value in record.offset.items() if name != "load"},
        overrides={**record.overrides, LOAD: low},
    )


def _refuse_own_load(mechanism: Mechanism, label: str, load: float) -> None:
    """Refuse a measured load [N] of a mechanism whose load follows from other parameters."""
    if "load" in mechanism.__dataclass_fields__:
        return
    own, kind = load_of(mechanism), type(mechanism).__name__
    if abs(own - load) > VARIES * load:
        raise InputError(
            f"the load of {label} was measured, {quantity(load, 'N', 4)}, and that of {kind}"
            f" follows from its own parameters, {quantity(own, 'N', 4)}: give parameters that agree"
            " with it, leave the load out, or use a mechanism with a load, such as Axis."
        )


def refuse_other_loads(mechanism: Mechanism, measurement: Measurement) -> None:
    """Refuse measured loads beside others that the mechanism or an override gives.

    Examples
    --------
    >>> from stickslip import Axis
    >>> record = Measurement(time=[0.0, 1.0], position=[0.0, 0.1], load=5.0)
    >>> refuse_other_loads(Axis(inertia=1.0), record)
    """
    for record in measurement.records():
        if "load" not in record.quantities():
            continue
        label = f"record {record.name!r}" if record.name else "the record"
        usual = float(np.median(np.asarray(record.values("load"), dtype=float)))
        if LOAD in record.overrides:
            raise InputError(
                f"the load of {label} is given twice: {quantity(usual, 'N', 4)} measured, and"
                f" {quantity(record.overrides[LOAD], 'N', 4)} in overrides. Leave one out."
            )
        if usual > 0.0:
            _refuse_own_load(mechanism, label, usual)


def load_of(mechanism: Mechanism) -> float:
    """Return the normal force at the contact [N] where that is a constant."""
    load = _load_of(mechanism)
    if load is None or load <= 0.0:
        raise InputError(
            f"start values need a constant normal force above 0 N, and"
            f" {type(mechanism).__name__} has {load!r}."
        )
    return load


def check_loads(measurement: Measurement) -> None:
    """Refuse trials of which some only have a measured load."""
    loads = {("load" in x.quantities(), UNIT_LOAD in x.provenance) for x in measurement.records()}
    if len(loads) > 1:
        raise InputError(
            "load (N) was measured in only some of the trials: give Measurement.load [N] for each"
            " trial, or for none to use that of the mechanism; coefficients of friction need it."
        )


def load_along(mechanism: Mechanism, record: Measurement, count: int) -> Array:
    """Return the normal force at each sample (n,) [N]: measured, else the mechanism's."""
    label = f"record {record.name!r}" if record.name else "the record"
    if "load" in record.quantities():
        load = np.broadcast_to(np.asarray(record.values("load"), dtype=float), count)
        where = "Measurement.load (N)"
    else:
        load = np.full(count, _load_of(mechanism) or 0.0)
        where = f"the load of {type(mechanism).__name__} (N)"
    if not np.all(load > 0.0):
        raise InputError(
            f"{where} of {label} must be above 0 N, got {number(float(np.min(load)))}: give the"
            " normal force in Measurement.load, one number or one for each sample."
        )
    return load


def _load_of(mechanism: Mechanism) -> float | None:
    """Return the normal force of a mechanism: prescribed, or the weight on a held coordinate."""
    contact, normal = only_contact(mechanism), normal_of(mechanism)
    if normal is None:
        return None if contact.load is None else float(cast("float", contact.load))
    at = dict.fromkeys((*mechanism.coordinates, normal), 0.0)
    # weight is linear in the height, so that the difference over 1 m is exact
    above = mechanism.potential_energy(0.0, {**at, normal: 0.5})
    below = mechanism.potential_energy(0.0, {**at, normal: -0.5})
    return float(above - below)
