"""The forces along a record: of what drives it, and of a mechanism but for friction."""

from collections import defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement, command_of
from stickslip.errors import InputError
from stickslip.mechanisms import Mechanism, motor_of, slip_names, slip_of
from stickslip.quantities import turned, vary

Array = NDArray[np.float64]


def goes_straight(record: Measurement, hold: str) -> bool:
    """Whether what drives a record goes straight from sample to sample: references always do."""
    return hold == "first" or command_of(record) not in {"force", "voltage", "current"}


def driven(measurement: Measurement) -> bool:
    """Whether any record is driven: by a force, or a reference, that is not 0 throughout.

    Examples
    --------
    >>> decay = Measurement(time=[0.0, 1.0], position=[0.0, 0.9], force=[0.0, 0.0])
    >>> driven(decay)
    False
    """
    return any(_drives(record) for record in measurement.records())


def _drives(record: Measurement) -> bool:
    name = command_of(record)
    return bool(name) and bool(np.any(record.values(name)))


def drives_itself(mechanism: Mechanism, measurement: Measurement) -> bool:
    """Whether a drive of the mechanism's own, and nothing that was recorded, makes a record move.

    Times of such a record are those of the drive: 0 is when the mechanism begins as it says.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms.drives import Sine
    >>> shaken = Axis(inertia=1.0, drive=Sine(amplitude=2.0, frequency=4.0))
    >>> record = Measurement(time=[0.0, 1.0], position=[0.0, 0.9])
    >>> drives_itself(shaken, record), drives_itself(Axis(inertia=1.0), record)
    (True, False)
    """
    return bool(mechanism.drives()) and any(
        record.time is not None
        and not record.joints
        and record.friction is None  # which nothing needs to be known of the drive for
        and not command_of(record)
        for record in measurement.records()
    )


def inside(mechanism: Mechanism, measurement: Measurement) -> tuple[str, ...]:
    """Return the states of a mechanism that drives itself which nobody measures.

    They begin as a drive or `Measurement.initial` says, else unknown.

    Examples
    --------
    >>> from stickslip import Capsule
    >>> from stickslip.mechanisms.drives import Sine
    >>> from stickslip.mechanisms import Torque
    >>> shaken = Capsule(
    ...     capsule_mass=0.8, inner_mass=0.2, drive=Torque(drive=Sine(amplitude=2.0, frequency=4.0))
    ... )
    >>> inside(shaken, Measurement(time=[0.0, 1.0], position=[0.0, 0.9]))
    ('xi', 'xi_dot')
    """
    if not drives_itself(mechanism, measurement):
        return ()
    names = slip_names(mechanism)
    return tuple(name for name in (*mechanism.coordinates, *mechanism.rates) if name not in names)


def applied_force(mechanism: Mechanism, record: Measurement) -> Array | None:
    """Return the force (n,) [N] that drives a record; None if it moves by itself.

    Of a motor that is its command, a voltage [V], a current [A] or the goal of its loop.

    A record with a reference and without a force is one in closed loop. Its controller is part of
    the mechanism: its gains are a spring and a damper towards the reference, so the mechanism needs
    ``stiffness`` and ``damping``, and the force is what they pull with from the reference's side.

    Examples
    --------
    >>> from stickslip import Axis
    >>> record = Measurement(time=[0.0, 1.0], position=[0.0, 0.9], reference=[0.0, 1.0])
    >>> applied_force(Axis(inertia=1.0, stiffness=5.0, damping=2.0), record)
    array([2., 7.])
    """
    known = record.quantities()
    if "force" in known:
        return np.asarray(record.values("force"))
    if motor_of(mechanism) is not None:
        return np.asarray(record.values(command_of(record))) if command_of(record) else None
    if "reference" not in known:
        return None
    stiffness = float(getattr(mechanism, "stiffness", 0.0))
    if stiffness <= 0.0:
        turns = record.turning or "rad" in mechanism.units
        units = [turned(unit, turns) for unit in ("N/m", "N s/m")]
        raise InputError(
            "a record with a reference and no force is one of a closed loop: give the controller"
            f" gains as stiffness [{units[0]}] and damping [{units[1]}] of the"
            f" {type(mechanism).__name__}, or give the {'torque' if turns else 'force'}."
        )
    asked, time = np.asarray(record.values("reference")), np.asarray(record.time)
    rate = np.gradient(asked, time)
    return np.asarray(stiffness * asked + float(getattr(mechanism, "damping", 0.0)) * rate)


def positions_of(record: Measurement) -> Array:
    """Return positions (n,) [m] as measured, or from the velocity."""
    if "position" in record.quantities():
        return np.asarray(record.values("position"))
    if "velocity" not in record.quantities():
        raise InputError("a force balance needs the position or the velocity in time.")
    v, t = np.asarray(record.values("velocity")), np.asarray(record.time)
    steps = 0.5 * (v[1:] + v[:-1]) * np.diff(t)
    return np.concatenate([[0.0], np.cumsum(steps)])


def known_forces(mechanism: Mechanism, x: Array, v: Array, applied: Array) -> tuple[float, Array]:
    """Return the mass [kg], and the forces (n,) [N] on it but for friction and a constant."""
    if len(mechanism.coordinates) != 1:
        raise InputError(
            f"a force balance needs a mechanism of one coordinate, and"
            f" {type(mechanism).__name__} has {len(mechanism.coordinates)}: give position and"
            f" force of each of {', '.join(mechanism.coordinates)} by its name, zeros where nothing"
            " drives it."
        )
    if "offset" in mechanism.__dataclass_fields__:
        mechanism = vary(mechanism, "mechanism", {"mechanism.offset": 0.0})
    (name,) = mechanism.coordinates
    q: Mapping[str, Any] = defaultdict(float, {name: x})
    q_dot: Mapping[str, Any] = defaultdict(float, {name: v})
    h = 1e-6 * max(float(np.ptp(x)), 1e-9)
    ahead, back = (
        mechanism.potential_energy(0.0, defaultdict(float, {**q, name: x + side * h})) + 0.0 * x
        for side in (1.0, -1.0)
    )
    forces = mechanism.forces(0.0, q, q_dot, {"drive": applied})[name]
    return mass_of(mechanism), np.asarray(forces - (ahead - back) / (2.0 * h) + 0.0 * x)


def mass_of(mechanism: Mechanism) -> float:
    """Return what moves as the coordinate that slips does, all else being at rest in it [kg]."""
    name = slip_of(mechanism)
    one = mechanism.kinetic_energy(defaultdict(float), defaultdict(float, {name: 1.0}))
    return 2.0 * float(one)
