"""Torques through the gear of one coordinate along its records, for laws that depend on them."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from stickslip.data import Measurement, as_recorded, between_gaps, with_voltage
from stickslip.identify.fits.contact_inputs import VARIES, inputs_along
from stickslip.identify.fits.motions import (
    HIGHEST,
    LEAST,
    PATH,
    filtered_velocity,
    mean_force,
    passed_by_balance,
    second_differences,
    smoothed,
)
from stickslip.identify.fits.record_forces import (
    applied_force,
    driven,
    goes_straight,
    known_forces,
    positions_of,
)
from stickslip.identify.fits.settings import ROUNDS, SETTLED
from stickslip.mechanisms import Mechanism, input_names
from stickslip.quantities import vary

Array = NDArray[np.float64]
AHEAD = 5.0
"""Positions are first filtered at so many times what the common filter passes: it changes nothing
that passes, by 3e-6, and else noise of the first acceleration would be seen for long."""


def transmitted_along(mechanism: Mechanism, measurement: Measurement) -> list[Array] | None:
    """Return what a gear transmits along each record (n,).

    None where nothing drives the motion, where the mechanism does not tell both sides of the gear,
    or where what it transmits does not change.
    """
    if not (driven(measurement) and {"motor", "external"} <= {*input_names(mechanism)}):
        return None
    if "friction" in measurement.quantities() or not varies_load(mechanism, measurement):
        return None
    result = [_transmitted(mechanism, record) for record in measurement.records()]
    size = np.abs(np.concatenate(result))
    return result if np.ptp(size) > VARIES * np.median(size) else None


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


def _transmitted(mechanism: Mechanism, record: Measurement) -> Array:
    """Return what the gear transmits along a record (n,); 0 in what is too short."""
    record = with_voltage(mechanism, record)
    own, times = as_recorded(mechanism, record), np.asarray(record.time, dtype=float)
    weighs = "offset" in own.__dataclass_fields__
    if weighs:  # the constant force of the record is found beside friction
        own = vary(own, "mechanism", {"mechanism.offset": 0.0})
    x, known = positions_of(record), record.quantities()
    v = np.asarray(record.values("velocity")) if "velocity" in known else np.gradient(x, times)
    told = inputs_along(own, record, times, position=x, velocity=v, force=0.0)
    given = as_recorded(mechanism, record)
    applied = applied_force(given, record)
    mass, still = known_forces(given, x, v, 0.0 * x)
    force = still if applied is None else known_forces(given, x, v, applied)[1]
    drives = mean_force(force - still, joined=goes_straight(record, "zero"))
    result = np.zeros_like(x)
    for piece in between_gaps(record):
        time = np.asarray(piece.time, dtype=float)
        if len(time) < LEAST:
            continue
        rows = np.searchsorted(times, time)
        raw, dt = positions_of(piece), float(np.ptp(time)) / (len(time) - 1)
        passed = passed_by_balance(raw)
        a = second_differences(smoothed(raw, min(AHEAD * passed, PATH * HIGHEST)), dt)
        torques = gear_torques(
            filtered_velocity(raw, dt, passed, tracked="position" in piece.quantities()),
            drives[rows],
            mass * a - still[rows],
            told["external"][rows],
            passed,
            within=told["motor"][rows],
            weighs=weighs,
        )
        result[rows] = torques["transmitted"]
    return result


# Torques through a gear along a motion, without the friction that was measured with them.


def gear_torques(
    velocity: Array,
    applied: Array,
    taken: Array,
    external: Array,
    passed: float,
    *,
    within: Array | float = 0.0,
    weighs: bool = False,
) -> dict[str, Array]:
    """Return the torque of a motor (n,), and what its gear transmits of it.

    Velocities (n,) are 0 at rest.

    The motor's is what the motion takes, with friction that grows with either torque or a square:
    of the measured one friction is a part, so that it would explain whatever friction there is.
    What of it the motion itself makes, as back-EMF does, is `within` it and in `taken`. A constant
    force is found beside them. It is of the sensor, or it `weighs`: it is then an external force,
    and the motor works against it.

    Examples
    --------
    >>> t = np.arange(0.0, 20.0, 0.01)
    >>> x, v, weight = np.sin(t), np.cos(t), -2.0 * np.sin(np.sin(t))
    >>> motor = 0.1 * np.sign(v) - weight
    >>> found = gear_torques(v, motor, -weight, weight, 0.1)
    >>> bool(np.quantile(np.abs(found["motor"] - motor), 0.9) < 0.01)
    True
    """
    ways, left = np.sign(velocity), applied - taken
    motor, transmitted = taken + within, taken + within - external
    for _ in range(ROUNDS):  # the torque that a gear transmits has its friction in it
        loads = np.column_stack([np.abs(transmitted), np.abs(motor), transmitted**2])
        rubs = np.column_stack([ways, velocity, ways[:, None] * loads])
        ones = np.ones_like(ways)
        seen = smoothed(np.column_stack([left, rubs, ones, -ones]), passed)
        *friction, more, less = nnls(seen[:, 1:], seen[:, 0])[0].tolist()
        weight = more - less if weighs else 0.0
        before = motor
        motor = taken + within + weight + rubs @ friction
        transmitted = motor - external + weight
        if np.linalg.norm(motor - before) <= SETTLED * np.linalg.norm(motor):
            break
    return {"motor": motor, "transmitted": transmitted}
