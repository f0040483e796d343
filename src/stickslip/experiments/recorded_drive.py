"""The mechanism of a record: with what was different in it, and driven by what was recorded."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError, check_size
from stickslip.experiments.measurement import ELECTRIC, Measurement
from stickslip.mechanisms import (
    CurrentLoop,
    DCMotor,
    LoopMemory,
    Mechanism,
    PositionLoop,
    SampledLoop,
    motor_of,
)
from stickslip.quantities import vary

Array = NDArray[np.float64]

SAME = 1e-6
"""Share of a period that counts as none: clocks of records are rounded."""

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
    if what == "reference" and not isinstance(motor.loop, PositionLoop | SampledLoop):
        raise InputError(
            "a record with a reference, and neither voltage nor current, is one of a position loop:"
            " give the DCMotor this loop, PositionLoop(gain=...) in V/rad or SampledLoop(...)."
        )
    return motor


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class LoopSamples:
    """What a loop that samples saw in a record: goals and positions at its samples."""

    time: Array
    """Times (n,) [s] of the record at which it samples."""
    goal: Array
    """Goals (n,)."""
    position: Array
    """Measured positions (n,)."""

    @lru_cache(maxsize=8)  # noqa: B019  # a few values of few records, which fits ask for again
    def commands(self, loop: SampledLoop, limit: float) -> tuple[Array, tuple[LoopMemory, ...]]:
        """Return the voltages (n,) [V] of a loop and what it remembers before each sample."""
        memory: LoopMemory = None
        found, memories = [], [memory]
        for goal, position in zip(self.goal.tolist(), self.position.tolist(), strict=True):
            voltage, memory = loop.sampled(goal, position, memory, limit=limit)
            found.append(voltage)
            memories.append(memory)
        return np.array(found), tuple(memories)


def loop_samples(mechanism: Mechanism, record: Measurement, hold: str) -> LoopSamples | None:
    """Return what the loop of a motor saw in a record that it drives; None if none that samples.

    It samples from the first time of the record on. Goals are held between rows unless `hold` says
    ``"first"``, and positions go straight.
    """
    motor = motor_of(mechanism)
    loop = None if motor is None else motor.loop
    if not isinstance(loop, SampledLoop) or command_of(record) != "reference":
        return None
    if "position" not in record.quantities() or len(mechanism.coordinates) != 1:
        raise InputError(
            "a fit through a SampledLoop needs the recorded position, and a mechanism of one"
            f" coordinate: {type(mechanism).__name__} has {len(mechanism.coordinates)}."
        )
    t, goal = np.asarray(record.time), np.asarray(record.values("reference"))
    check_size("samples of a loop", float(np.ptp(t)) / loop.period, "give a longer period")
    times = t[0] + loop.period * np.arange(math.floor(np.ptp(t) / loop.period + SAME) + 1)
    last = np.maximum(np.searchsorted(t, times + SAME * loop.period, side="right") - 1, 0)
    return LoopSamples(
        time=times,
        goal=np.interp(times, t, goal) if hold == "first" else goal[last],
        position=np.interp(times, t, np.asarray(record.values("position"))),
    )


def with_voltage(mechanism: Mechanism, record: Measurement, hold: str) -> Measurement:
    """Return a record with the voltage that a loop which samples made of what it measured.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms import DCMotor
    >>> loop = SampledLoop(gain=10.0, period=0.1)
    >>> servo = Axis(inertia=1.0, drive=DCMotor(resistance=2.0, torque_constant=0.5, loop=loop))
    >>> record = Measurement(time=[0, 0.1, 0.2], position=[0, 0.1, 0.2], reference=[0.3] * 3)
    >>> with_voltage(servo, record, "zero").values("voltage").round(9).tolist()
    [3.0, 2.0, 1.0]
    """
    set_up = as_recorded(mechanism, record)
    seen = loop_samples(set_up, record, hold)
    if seen is None:
        return record
    motor: Any = motor_of(set_up)
    told, _ = seen.commands(motor.loop, motor.largest_voltage)
    acts = seen.time + motor.loop.delay
    last = np.searchsorted(acts, np.asarray(record.time) + SAME * motor.loop.period, side="right")
    return replace(record, voltage=np.where(last > 0, told[np.maximum(last - 1, 0)], 0.0))
