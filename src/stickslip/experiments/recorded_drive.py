"""The mechanism of a record: with what was different in it, and driven by what was recorded."""

from dataclasses import replace
from typing import Any

from stickslip.errors import InputError
from stickslip.experiments.measurement import ELECTRIC, Measurement
from stickslip.mechanisms import CurrentLoop, DCMotor, Mechanism, PositionLoop, motor_of
from stickslip.quantities import vary

COMMANDS = ("force", *ELECTRIC, "reference")
"""What may have driven a record; the first of those that it has is what acts."""


def command_of(record: Measurement) -> str:
    """Return the name of what drives a record; empty if it moves by itself.

    Examples
    --------
    >>> command_of(Measurement(time=[0, 1], position=[0, 1], voltage=[6, 6], reference=[1, 1]))
    'voltage'
    """
    known = record.quantities()
    return next((name for name in COMMANDS if name in known), "")


def as_recorded(mechanism: Mechanism, record: Measurement) -> Mechanism:
    """Return a mechanism as it was in a record; its motor takes what was recorded as its command.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms import DCMotor
    >>> servo = Axis(inertia=1.0, drive=DCMotor(resistance=2.0, torque_constant=0.5, supply=7.4))
    >>> record = Measurement(
    ...     time=[0, 1], position=[0, 1], voltage=[6, 6], overrides={"mechanism.inertia": 2.0}
    ... )
    >>> one = as_recorded(servo, record)
    >>> one.inertia, one.drive.supply
    (2.0, None)
    """
    what = command_of(record)
    if record.overrides:
        mechanism = vary(mechanism, "mechanism", record.overrides)
    motor: Any = motor_of(mechanism)
    if motor is None:
        if what in ELECTRIC:
            raise InputError(
                f"a record of the {what} of a motor needs that motor: give"
                f" {type(mechanism).__name__} a DCMotor as its drive"
                ' (in a rig file, drive = { type = "dc-motor", ... }), or the force.'
            )
        return mechanism
    if what == "force":
        raise InputError(
            f"the record has a force, and {type(mechanism).__name__} a motor, which takes a"
            " current, a voltage or a reference: leave out the force, or the motor, whose rotor is"
            " then part of the inertia."
        )
    return replace(mechanism, drive=_taking(motor, what))  # type: ignore[call-arg]  # it has one


def _taking(motor: DCMotor, what: str) -> DCMotor:
    """Return a motor whose command is what was recorded."""
    if what == "current":
        return replace(motor, loop=CurrentLoop(), supply=None, supply_resistance=None)
    if what == "voltage":  # limited already, but by no droop
        limited = motor.supply_resistance is not None
        return replace(motor, loop=None, supply=motor.supply if limited else None)
    if what == "reference" and not isinstance(motor.loop, PositionLoop):
        raise InputError(
            "a record with a reference, and neither voltage nor current, is one of a position loop:"
            " give the DCMotor this loop, PositionLoop(gain=...) in V/rad."
        )
    return motor
