"""An electric motor behind a gear: what it gives of a voltage, and the loop that commands it."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any, ClassVar, TypeAlias

from typing_extensions import override

from stickslip.errors import InputError, ParameterError
from stickslip.maths import Scalar, where
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import Parametrised, Quantity


@dataclass(frozen=True, kw_only=True)
class MotorLoop(Parametrised, ABC):
    """What makes a voltage of the command of a motor."""

    name: ClassVar[str]
    """``type`` in rig files."""
    wanted: ClassVar[str] = (
        "a loop, PositionLoop(...), SampledLoop(...), VelocityLoop(...) or CurrentLoop()"
    )

    @abstractmethod
    def voltage(self, goal: Scalar, position: Scalar, rate: Scalar, motor: "DCMotor") -> Scalar:
        """Return the voltage [V] that is asked for, before limits.

        Parameters
        ----------
        goal : float or array
            What the loop is asked for.
        position : float or array
            Position of the driven coordinate [m or rad].
        rate : float or array
            Its rate [m/s or rad/s].
        motor : DCMotor
            The motor that is commanded.

        Returns
        -------
        float or array
            Voltage [V].
        """


@dataclass(frozen=True, kw_only=True)
class PositionLoop(MotorLoop):
    """A voltage proportional to the position error, less a share of the rate.

    Examples
    --------
    >>> motor = DCMotor(resistance=3.0, torque_constant=0.4)
    >>> PositionLoop(gain=20.0, rate_gain=0.5).voltage(0.5, 0.25, 2.0, motor)
    4.0
    """

    name: ClassVar[str] = "position"

    gain: Annotated[float, Quantity("K_p", "V/m", low=0, or_unit="V/rad")]
    """Voltage per error of the position."""
    rate_gain: Annotated[float, Quantity("K_d", "V s/m", low=0, or_unit="V s/rad")] = 0.0
    """Voltage per rate, against the motion: the derivative part of firmware that takes it of the
    measured position and not of the error."""

    @override
    def voltage(self, goal: Scalar, position: Scalar, rate: Scalar, motor: "DCMotor") -> Scalar:
        return self.gain * (goal - position) - self.rate_gain * rate


LoopMemory: TypeAlias = tuple[float, float] | None
"""Integral part of the command [V] and the position at the sample before; None at the first."""


@dataclass(frozen=True, kw_only=True)
class SampledLoop(MotorLoop):
    """A PID loop of firmware on the position: it samples, and holds the voltage in between.

    At each sample ``u = K_p e + K_i * sum(e) T_s - K_d (x - x_before) / T_s``, where ``e`` is the
    goal less x, in whole steps and within the duty limit. At the limit the integral part does not
    grow further beyond it (conditional integration).

    Fits take it: they simulate motor and loop under the recorded goal, or balance torques under the
    voltage that it makes of the recorded goal and position. A run of its own is one of
    `stickslip.study.control.closed_loop` with a `PID` of the same gains.

    Examples
    --------
    >>> loop = SampledLoop(gain=20.0, integral_gain=10.0, period=0.01)
    >>> voltage, memory = loop.sampled(0.5, 0.25, None, limit=7.4)
    >>> voltage, loop.sampled(0.5, 0.25, memory, limit=7.4)[0]
    (5.0, 5.025)
    """

    name: ClassVar[str] = "sampled-position"

    gain: Annotated[float, Quantity("K_p", "V/m", low=0, or_unit="V/rad")]
    """Voltage per error of the position."""
    integral_gain: Annotated[float, Quantity("K_i", "V/m/s", low=0, or_unit="V/rad/s")] = 0.0
    """Voltage per error and second."""
    rate_gain: Annotated[float, Quantity("K_d", "V s/m", low=0, or_unit="V s/rad")] = 0.0
    """Voltage per rate of the measured position, against the motion."""
    period: Annotated[float, Quantity("T_s", "s", above=0)]
    """Time between samples."""
    delay: Annotated[float, Quantity("tau", "s", low=0)] = 0.0
    """Time from a sample to the moment at which its voltage acts."""
    duty_limit: Annotated[float, Quantity("d_max", above=0, high=1)] = 1.0
    """Largest duty: voltage over that of the supply."""
    step: Annotated[float, Quantity("u_q", "V", above=0)] | None = None
    """Voltage of one count of the PWM; none if commands are not rounded."""
    encoder_step: Annotated[float, Quantity("q", "m", above=0, or_unit="rad")] | None = None
    """Step of the position that it sees; none if that is not rounded. Slopes of fits leave both
    roundings out."""

    @override
    def voltage(self, goal: Scalar, position: Scalar, rate: Scalar, motor: "DCMotor") -> Scalar:
        return self.gain * (goal - position) - self.rate_gain * rate  # what it samples tends to

    def sampled(
        self, goal: float, position: float, memory: LoopMemory, *, limit: float
    ) -> tuple[float, LoopMemory]:
        """Return the voltage [V] that a sample asks for, and what the loop remembers of it.

        Parameters
        ----------
        goal : float
            What the loop is asked for [m or rad].
        position : float
            Measured position [m or rad].
        memory : tuple of float, optional
            What it remembers of the sample before; None at the first.
        limit : float
            Largest voltage [V], infinity if there is none.

        Returns
        -------
        tuple
            Voltage and memory.
        """
        if self.encoder_step is not None:
            position = self.encoder_step * round(position / self.encoder_step)
        error = goal - position
        demand = self.gain * error
        before = grown = 0.0
        if memory is not None:
            before, last = memory
            demand -= self.rate_gain * ((position - last) / self.period)
            grown = before + self.integral_gain * error * self.period
        result, integral = within_limit(demand, before, grown, limit)
        if self.step is not None:
            # Whole counts may lie beyond the limit.
            result = min(max(self.step * round(result / self.step), -limit), limit)
        return result, (integral, position)


def within_limit(demand: float, before: float, grown: float, limit: float) -> tuple[float, float]:
    """Return a command with its integral part within a limit, and the part to remember.

    Where the command is at its limit, the part does not grow further beyond it.

    Examples
    --------
    >>> within_limit(5.0, 1.0, 1.5, 6.0), within_limit(5.0, 1.0, 0.5, 6.0)
    ((6.0, 1.0), (5.5, 0.5))
    """
    whole = demand + grown
    if abs(whole) <= limit:
        return whole, grown
    outwards = (grown - before) * whole > 0.0
    return (limit if whole > 0.0 else -limit), before if outwards else grown


@dataclass(frozen=True, kw_only=True)
class VelocityLoop(MotorLoop):
    """A voltage proportional to the error of the velocity.

    Examples
    --------
    >>> motor = DCMotor(resistance=3.0, torque_constant=0.4)
    >>> VelocityLoop(gain=2.0).voltage(1.0, 0.0, 0.75, motor)
    0.5
    """

    name: ClassVar[str] = "velocity"

    gain: Annotated[float, Quantity("K_v", "V s/m", low=0, or_unit="V s/rad")]
    """Voltage per error of the velocity."""

    @override
    def voltage(self, goal: Scalar, position: Scalar, rate: Scalar, motor: "DCMotor") -> Scalar:
        return self.gain * (goal - rate)


@dataclass(frozen=True, kw_only=True)
class CurrentLoop(MotorLoop):
    """The voltage that gives the current that is asked for, as far as limits allow.

    The loop of industrial servo drives and of current modes of servos, which is faster than
    anything that moves.

    Examples
    --------
    >>> motor = DCMotor(resistance=3.0, torque_constant=0.4, loop=CurrentLoop())
    >>> motor.current(1.5, 0.0, 2.0), motor.voltage(1.5, 0.0, 2.0)
    (1.5, 5.3)
    """

    name: ClassVar[str] = "current"

    @override
    def voltage(self, goal: Scalar, position: Scalar, rate: Scalar, motor: "DCMotor") -> Scalar:
        return motor.resistance * goal + motor.back_emf * motor.gear_ratio * rate


@dataclass(frozen=True, kw_only=True)
class DCMotor(Parametrised):
    """A DC motor, or a brushless one with its inverter, behind a gear, as the drive of a mechanism.

    It turns `gear_ratio` times as far as the driven coordinate x moves:

    * current: i = (u - k_e n x') / R, limited to `current_limit`
    * force or torque along the coordinate: n k_t i
    * inertia of the rotor along the coordinate: n^2 J_r

    The inductance of the winding is left out: its time constant, about a millisecond, is short
    beside that of the motion. The voltage u is limited to the supply. Where a limit is met, runs
    have an event. Losses of the gear that grow with what it transmits belong to the friction law
    (`BamM3` to `BamM6`, or a part with ``[transmitted]``).

    `drive` is the command: a voltage [V], or with a `loop` the position, velocity or current that
    it is asked for.

    Examples
    --------
    A servo with an arm goes to 0.5 rad, and rests where the torque left is below the friction:

    >>> from stickslip import CoulombViscous, Pendulum, simulate
    >>> from stickslip.mechanisms.drives import Sampled
    >>> motor = DCMotor(
    ...     resistance=3.0, torque_constant=0.4, rotor_inertia=2e-3, supply=7.4,
    ...     loop=PositionLoop(gain=40.0), drive=Sampled(times=[0.0], values=[0.5]),
    ... )  # fmt: skip
    >>> servo = Pendulum(mass=0.2, length=0.1, drive=motor)
    >>> law = CoulombViscous(kinetic_coefficient=0.02, viscous_coefficient=0.01)
    >>> run = simulate(servo, law, t_end=2.0)
    >>> [event.reason for event in run.events[:2]], round(float(run["theta"][-1]), 4)
    (['voltage leaves its limit', 'reversal'], 0.4833)
    """

    name: ClassVar[str] = "dc-motor"
    """``type`` in rig files."""
    wanted: ClassVar[str] = "a motor, DCMotor(...)"

    resistance: Annotated[float, Quantity("R", "ohm", above=0)]
    """Resistance of the winding, with that of its leads and transistors."""
    torque_constant: Annotated[float, Quantity("k_t", "N m/A", above=0)]
    """Torque per current: of the motor, or with a gear ratio of 1 of the output shaft."""
    back_emf_constant: Annotated[float, Quantity("k_e", "V s/rad", low=0)] | None = None
    """Voltage per speed; the torque constant, which it equals in SI units, if not given."""
    gear_ratio: Annotated[float, Quantity("n", above=0)] = 1.0
    """Angle of the motor over that of the output; of a linear axis, radians per metre."""
    rotor_inertia: Annotated[float, Quantity("J_r", "kg m^2", low=0)] = 0.0
    """Moment of inertia of the rotor about its own axis."""
    supply: Annotated[float, Quantity("U", "V", above=0)] | None = None
    """Voltage of the supply, which limits that of the motor; no limit if not given."""
    supply_resistance: Annotated[float, Quantity("R_s", "ohm", low=0)] | None = None
    """Resistance of supply and cable, by which the supply droops: its current is that of the motor
    times the duty, u over U. None if not given."""
    current_limit: Annotated[float, Quantity("i_max", "A", low=0)] | None = None
    """Largest current; 0 is an open winding. No limit if not given."""
    loop: MotorLoop | None = None
    """`PositionLoop`, `SampledLoop`, `VelocityLoop` or `CurrentLoop`, to which `drive` is the goal;
    none if that is a voltage."""
    drive: Drive | None = None
    """Voltage [V], or the goal of the loop; 0 if not given."""

    def __post_init__(self) -> None:
        """Check the parameters: a supply droops from its voltage."""
        super().__post_init__()
        if self.supply_resistance and isinstance(self.loop, CurrentLoop):
            raise ParameterError(
                "DCMotor.supply_resistance (R_s) takes no effect on a current that a loop sets:"
                " leave it out, or give another loop."
            )
        if self.supply_resistance is not None and self.supply is None:
            raise ParameterError(
                "DCMotor.supply_resistance (R_s) is that of a supply: give supply, its voltage"
                " without current, too."
            )

    @property
    def largest_voltage(self) -> float:
        """Largest voltage [V] that its loop asks for; infinity if there is no supply."""
        share = self.loop.duty_limit if isinstance(self.loop, SampledLoop) else 1.0
        return math.inf if self.supply is None else share * self.supply

    @property
    def inertia(self) -> Scalar:
        """Inertia of the rotor along the driven coordinate [kg m^2 or kg]."""
        return self.gear_ratio * self.gear_ratio * self.rotor_inertia

    @property
    def back_emf(self) -> Scalar:
        """Voltage per speed of the motor [V s/rad]."""
        return self.torque_constant if self.back_emf_constant is None else self.back_emf_constant

    def voltage(self, command: Scalar, position: Scalar, rate: Scalar) -> Scalar:
        """Return the voltage [V] that is switched to the motor, within the supply's.

        Parameters
        ----------
        command : float or array
            Value of `drive`.
        position : float or array
            Position of the driven coordinate [m or rad].
        rate : float or array
            Its rate [m/s or rad/s].

        Returns
        -------
        float or array
            Voltage [V], without the droop of the supply.
        """
        demand = command if self.loop is None else self.loop.voltage(command, position, rate, self)
        return _within(demand, self.supply, "voltage")

    def current(self, command: Scalar, position: Scalar, rate: Scalar) -> Scalar:
        """Return the current [A].

        Parameters
        ----------
        command : float or array
            Value of `drive`.
        position : float or array
            Position of the driven coordinate [m or rad].
        rate : float or array
            Its rate [m/s or rad/s].

        Returns
        -------
        float or array
            Current of the motor [A].
        """
        voltage = self.voltage(command, position, rate)
        resistance = self.resistance
        if self.supply_resistance is not None:
            # The supply carries the motor's current times the duty, and its droop is switched with
            # the duty again.
            duty = voltage / self.supply
            resistance = resistance + self.supply_resistance * duty * duty
        current = (voltage - self.back_emf * self.gear_ratio * rate) / resistance
        return _within(current, self.current_limit, "current")

    def force(self, command: Scalar, position: Scalar, rate: Scalar) -> Scalar:
        """Return the force [N] or torque [N m] along the driven coordinate.

        Parameters
        ----------
        command : float or array
            Value of `drive`.
        position : float or array
            Position of the driven coordinate [m or rad].
        rate : float or array
            Its rate [m/s or rad/s].

        Returns
        -------
        float or array
            Force or torque, without that of the rotor's inertia.
        """
        return self.gear_ratio * self.torque_constant * self.current(command, position, rate)


def _within(value: Scalar, most: Scalar | None, what: str) -> Scalar:
    """Return a value cut at a limit, if any; runs have an event where that begins and ends."""
    if most is None:
        return value
    named = (f"{what} meets its limit", f"{what} leaves its limit")
    return where(value < -most, -most, where(value > most, most, value, named), named)


LOOPS: Mapping[str, type[MotorLoop]] = {
    loop.name: loop for loop in (PositionLoop, SampledLoop, VelocityLoop, CurrentLoop)
}
"""The loops by the ``type`` they have in rig files."""


def motor_of(mechanism: object) -> DCMotor | None:
    """Return the motor that drives a mechanism; None if there is none.

    Examples
    --------
    >>> motor_of(DCMotor(resistance=2.0, torque_constant=0.5)) is None
    True
    """
    driver = getattr(mechanism, "drive", None)
    return driver if isinstance(driver, DCMotor) else None


def motors_of(mechanism: Any) -> Mapping[str, DCMotor]:
    """Return all motors of a mechanism by the path of their field, those of its joints too.

    Examples
    --------
    >>> from stickslip import Axis
    >>> [*motors_of(Axis(inertia=1.0, drive=DCMotor(resistance=2.0, torque_constant=0.5)))]
    ['drive']
    """
    result: dict[str, DCMotor] = {}
    for field in fields(mechanism):
        value = getattr(mechanism, field.name)
        if isinstance(value, DCMotor):
            result[field.name] = value
        elif isinstance(value, tuple):
            for index, part in enumerate(value):
                if isinstance(part, Parametrised):
                    own = motors_of(part)
                    result |= {f"{field.name}.{index}.{name}": motor for name, motor in own.items()}
    return result


def driven_by_motor(mechanism: Any) -> str:
    """Return the coordinate that a motor drives."""
    return str(getattr(mechanism, "motor_side", mechanism.coordinates[0]))


def refuse_sampling(mechanism: object) -> None:
    """Refuse equations of a motor whose voltage between samples is none of its state."""
    if any(isinstance(motor.loop, SampledLoop) for motor in motors_of(mechanism).values()):
        raise InputError(
            "a SampledLoop has no equations between its samples: simulate it by"
            " control.closed_loop with a PID of its gains and a motor without a loop, or fit."
        )


def driving_force(
    driver: Drive | DCMotor | None,
    drives: Mapping[str, Scalar],
    position: Scalar,
    rate: Scalar,
    name: str = "drive",
) -> Scalar:
    """Return the force or torque of a field of a mechanism, ``drive`` or another.

    Examples
    --------
    >>> motor = DCMotor(resistance=2.0, torque_constant=0.5)
    >>> driving_force(motor, {"drive": 6.0}, 0.0, 4.0), driving_force(None, {"drive": 6.0}, 0, 4)
    (1.0, 6.0)
    """
    command = drives.get(name, 0.0)
    return driver.force(command, position, rate) if isinstance(driver, DCMotor) else command


def driving_inertia(driver: Drive | DCMotor | None) -> Scalar:
    """Return the inertia that a driver adds to what it drives.

    Examples
    --------
    >>> driving_inertia(DCMotor(resistance=2.0, torque_constant=0.5, rotor_inertia=1e-6))
    1e-06
    """
    return driver.inertia if isinstance(driver, DCMotor) else 0.0


def driving(driver: Drive | DCMotor | None, name: str = "drive") -> Mapping[str, Drive]:
    """Return the drives of a field of a mechanism, ``drive`` or another, by name.

    Examples
    --------
    >>> driving(DCMotor(resistance=2.0, torque_constant=0.5))
    {}
    """
    drive = driver.drive if isinstance(driver, DCMotor) else driver
    return {} if drive is None else {name: drive}
