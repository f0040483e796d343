"""Controllers: PID, compensation of friction, and partial feedback linearisation."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, TypeAlias

from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.friction import FrictionLaw, bound, is_bound
from stickslip.mechanisms import Mechanism, within_limit
from stickslip.quantities import Parametrised, Quantity
from stickslip.study.control.equations_of_motion import Evaluator
from stickslip.study.control.feedback_loop import Controller

# PID control with a bounded integral part.

Signal: TypeAlias = float | Callable[[float], float]
"""A number, or a function of time."""


def value_at(signal: Signal, t: float) -> float:
    """Return the value of a number or a function of time.

    Examples
    --------
    >>> value_at(2.0, 0.5), value_at(lambda t: 2.0 * t, 0.5)
    (2.0, 1.0)
    """
    return float(signal(t)) if callable(signal) else float(signal)


@dataclass
class _PidMemory:
    """What a controller remembers from one sample to the next."""

    t: float | None = None
    place: float = 0.0
    speed: float = 0.0
    integral: float = 0.0


@dataclass(frozen=True, kw_only=True)
class PID(Parametrised):
    """Proportional, integral and derivative action on a measured coordinate.

    ``u = K_p e + K_i * integral(e) + K_d (r' - v) + feedforward``, with ``e = r - x``. The integral
    is the sum of the errors at the samples, times the time since the sample before. Where the
    command is at its limit, the integral does not grow further beyond it (conditional integration),
    or is led back with a time constant (back-calculation).

    Settings are frozen as everywhere; what changes from sample to sample is kept beside them, and
    forgotten by `reset`.

    Examples
    --------
    >>> pid = PID(proportional=10.0, integral=2.0, reference=0.5)
    >>> pid(0.0, {"x": 0.1, "v": 0.0}), round(pid(0.1, {"x": 0.1, "v": 0.0}), 12)
    (4.0, 4.08)
    """

    proportional: Annotated[float, Quantity("K_p")]
    """Command per error."""
    integral: Annotated[float, Quantity("K_i")] = 0.0
    """Command per error and second."""
    derivative: Annotated[float, Quantity("K_d")] = 0.0
    """Command per error's rate."""
    reference: Signal = 0.0
    """Where to be, a number or a function of time."""
    reference_rate: Signal = 0.0
    """Its rate."""
    state: str = "x"
    """The coordinate that is controlled."""
    rate: str | None = "v"
    """Its measured rate; None if it is not measured but estimated from the coordinate."""
    filter_time: Annotated[float, Quantity("T_f", "s", low=0)] = 0.0
    """Time constant that smooths an estimated rate."""
    limit: Annotated[float, Quantity("u_max", above=0)] | None = None
    """Largest command; the integral part knows it, unlike that of `closed_loop`."""
    tracking_time: Annotated[float, Quantity("T_t", "s", above=0)] | None = None
    """Time constant of back-calculation; conditional integration if not given."""
    feedforward: Controller | None = None
    """What is added before the limit, such as a compensation of friction."""
    _memory: _PidMemory = field(default_factory=_PidMemory, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.tracking_time is not None and self.limit is None:
            raise ParameterError(
                "PID.tracking_time (T_t) sets the anti-windup at a limit: give limit too."
            )
        if self.feedforward is not None and not callable(self.feedforward):
            raise ParameterError(
                f"PID.feedforward must be callable like a controller, got {self.feedforward!r}."
            )

    def reset(self) -> None:
        """Forget all samples."""
        object.__setattr__(self, "_memory", _PidMemory())
        getattr(self.feedforward, "reset", lambda: None)()

    def __call__(self, t: float, measured: Mapping[str, float]) -> float:
        """Return the command at a sample."""
        memory = self._memory
        since = 0.0 if memory.t is None else t - memory.t
        place = _seen(measured, self.state)
        speed = self._speed(measured, place, since)
        error = value_at(self.reference, t) - place
        command = self.proportional * error
        command += self.derivative * (value_at(self.reference_rate, t) - speed)
        if self.feedforward is not None:
            command += self.feedforward(t, measured)
        # The integral part is added within the limit, so that it does not wind up there.
        found, integral = self._integrated(command, error, since)
        memory.t, memory.place, memory.speed, memory.integral = t, place, speed, integral
        return found

    def _speed(self, measured: Mapping[str, float], place: float, since: float) -> float:
        """Return the measured rate, or an estimate."""
        if self.rate is not None:
            return _seen(measured, self.rate)
        # One sample tells no rate.
        if since <= 0.0:
            return 0.0
        raw = (place - self._memory.place) / since
        # A first-order low pass, discretised backwards: stable whatever the interval is.
        share = since / (self.filter_time + since)
        return self._memory.speed + share * (raw - self._memory.speed)

    def _integrated(self, command: float, error: float, since: float) -> tuple[float, float]:
        """Return the whole command within the limit, and the integral part to remember."""
        before = self._memory.integral
        grown = before + self.integral * error * since
        limit = math.inf if self.limit is None else self.limit
        found, integral = within_limit(command, before, grown, limit)
        if self.tracking_time is not None:
            share = min(since / self.tracking_time, 1.0)
            # Back-calculation: what the limit took off is led back within the tracking time.
            return found, grown + share * (found - (command + grown))
        return found, integral


def _seen(measured: Mapping[str, float], name: str) -> float:
    if name not in measured:
        raise InputError(
            f"PID: {name!r} is not measured; measured quantities: {', '.join(measured) or 'none'}."
        )
    return measured[name]


# Compensation of friction by the force that an identified law gives.

Load: TypeAlias = float | Callable[[float, Mapping[str, float]], float]
"""A normal force [N] or a contact input, or a function of time and what is measured."""


def sliding_force(law: FrictionLaw, velocity: float, load: float) -> float:
    """Return the friction force of steady sliding [N], 0 at rest.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> sliding_force(Coulomb(kinetic_coefficient=0.25), -0.1, load=4.0)
    -1.0
    """
    # The sign of rest is open; a push of break-away would chatter.
    if velocity == 0.0:
        return 0.0
    if isinstance(law, FrictionLaw):
        return float(law.steady(velocity, load))
    raise InputError(
        f"{type(law).__name__} is not a friction law that can be compensated: give"
        " one such as Coulomb(...)."
    )


@dataclass(frozen=True, kw_only=True)
class FrictionCompensation(Parametrised):
    """A controller that pushes with a law's friction force, in the direction of motion.

    Within the crossing ``|v| < width`` the force is that of the law times ``s (3 - s^2) / 2`` with
    ``s = |v| / width``: smooth, 0 at rest, and exactly the law's from the width on.
    """

    law: FrictionLaw
    """The identified law."""
    width: Annotated[float, Quantity("w", "m/s", above=0)]
    """Speed below which the force fades to 0, which noise would else turn into chatter."""
    factor: Annotated[float, Quantity("kappa", low=0)] = 1.0
    """Share of friction that is compensated; above 1 it is over-compensated."""
    load: Load = 1.0
    """Normal force."""
    inputs: Mapping[str, Load] = field(default_factory=dict)
    """Contact inputs of the law, by name."""
    velocity: str | Callable[[float], float] = "v"
    """Name of a measured rate, or the desired velocity as a function of time."""

    def __post_init__(self) -> None:
        """Check the law."""
        super().__post_init__()
        if not isinstance(self.law, FrictionLaw):
            raise ParameterError(
                f"FrictionCompensation.law must be a friction law, got {self.law!r}."
            )
        for name in self.inputs:
            if name not in self.law.inputs:
                raise UnknownNameError(f"contact input of {self.law.name}", name, self.law.inputs)
        for name in () if is_bound(self.law) else self.law.inputs:
            if name not in self.inputs:
                raise InputError(
                    f"compensation: the friction law {self.law.name} depends on {name}: give it,"
                    f" as inputs={{{name!r}: ...}}, a number or a function of time and what is"
                    " measured."
                )

    def __call__(self, t: float, measured: Mapping[str, float]) -> float:
        """Return the force at a sample."""
        if callable(self.velocity):
            speed = float(self.velocity(t))
        elif self.velocity in measured:
            speed = measured[self.velocity]
        else:
            raise InputError(
                f"compensation: {self.velocity!r} is not measured; measured quantities:"
                f" {', '.join(measured) or 'none'}."
            )
        load, *inputs = (
            value(t, measured) if callable(value) else value
            for value in (self.load, *self.inputs.values())
        )
        law = self.law
        if inputs:
            law = bound(law, dict(zip(self.inputs, inputs, strict=True)))
        share = min(abs(speed) / self.width, 1.0)
        # 0 at rest with a slope, 1 at the width without one: no kink in either place.
        crossing = 0.5 * share * (3.0 - share * share)
        return self.factor * crossing * sliding_force(law, speed, load)


def compensation(
    law: FrictionLaw,
    *,
    width: float,
    factor: float = 1.0,
    load: Load = 1.0,
    inputs: Mapping[str, Load] | None = None,
    velocity: str | Callable[[float], float] = "v",
) -> FrictionCompensation:
    """Return a controller that compensates friction by an identified law.

    Parameters
    ----------
    law : FrictionLaw
        The law; of a law with bristles, its steady sliding.
    width : float
        Speed below which the compensation fades to 0 [m/s].
    factor : float
        Share of friction that is compensated: 1 exactly, less or more.
    load : float or callable
        Normal force [N], or a function of time and what is measured.
    inputs : mapping of str to float or callable, optional
        Contact inputs of the law in the same way, such as ``{"temperature": 35.0}`` [degC].
    velocity : str or callable
        Name of the measured rate, or the desired velocity as a function of time, which has no
        noise and does not feed back.

    Returns
    -------
    FrictionCompensation
        A controller; give it to `PID` as ``feedforward``.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> push = compensation(Coulomb(kinetic_coefficient=2.0), width=0.01, factor=0.9)
    >>> [round(push(0.0, {"v": v}), 9) for v in (-0.1, 0.0, 0.005, 0.01)]
    [-1.8, 0.0, 1.2375, 1.8]
    """
    return FrictionCompensation(
        law=law, width=width, factor=factor, load=load, inputs=inputs or {}, velocity=velocity
    )


# Partial feedback linearisation: one coordinate follows, friction and all else being known.

ROUNDING = 1e-12
"""Share of its parts at which an acceleration per command is none."""


@dataclass
class _LinearisationMemory:
    """What is kept from sample to sample."""

    evaluator: Evaluator | None = None
    command: float = 0.0
    singular: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class _Line:
    """Friction at the contact as a line over the normal force, ``constant + slope * N``."""

    constant: float
    slope: float


@dataclass(frozen=True, kw_only=True)
class PartialLinearisation(Parametrised):
    """A controller that lets one coordinate of a mechanism follow a reference.

    At each sample it computes the command under which the tracked coordinate accelerates by
    ``r'' + K_d (r' - q') + K_p (r - q)``, from the mechanism's equations with the friction of a law
    in them. The normal force depends on the command and friction on the normal force; the three are
    solved together. A body at rest stays (the friction is then what holds it) as long as the law
    can hold it.

    *Collocated*: the tracked coordinate is the one the drive acts on, such as ``theta`` of
    `PendulumCart`. *Non-collocated*: it is another, such as ``x``, which the drive moves through
    the pendulum; what the pendulum does meanwhile is what is left, and it need not be bounded.

    The law is singular where the command does not accelerate the tracked coordinate: for ``x`` of
    the cart at ``cos(theta) = 0`` without friction, and with it where the rod lies on the cone of
    friction, ``tan(theta) = -1 / mu`` at slip forwards and ``1 / mu`` backwards; and where the
    command would lift the cart, N <= 0. It then repeats its last command, and `singular` has the
    times. Near such a place commands are large: give `closed_loop` a limit.

    Examples
    --------
    >>> from stickslip import Coulomb, PendulumCart
    >>> cart = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3)
    >>> steer = PartialLinearisation(
    ...     mechanism=cart,
    ...     law=Coulomb(kinetic_coefficient=0.2),
    ...     track="theta",
    ...     stiffness=100.0,
    ...     damping=20.0,
    ...     reference=0.1,
    ... )
    >>> round(steer(0.0, {"x": 0.0, "theta": 0.0, "v": 0.0, "omega": 0.0}), 9)
    0.09
    """

    mechanism: Mechanism
    """What moves, as it is modelled."""
    law: FrictionLaw
    """What holds it back, as it is modelled."""
    track: str
    """The coordinate that follows."""
    stiffness: Annotated[float, Quantity("K_p", "1/s^2", low=0)]
    """Acceleration per error."""
    damping: Annotated[float, Quantity("K_d", "1/s", low=0)]
    """Acceleration per error's rate."""
    reference: Signal = 0.0
    """Where to be, a number or a function of time."""
    reference_rate: Signal = 0.0
    """Its rate."""
    reference_acceleration: Signal = 0.0
    """The rate of that."""
    drive: str | None = None
    """What is commanded, as in `closed_loop`."""
    rest_speed: Annotated[float, Quantity("v_0", "m/s", low=0)] = 0.0
    """Slip speed up to which the body counts as being at rest; noise needs some."""
    least: Annotated[float, Quantity("E", low=0)] = 0.0
    """Acceleration per command below which the law counts as singular; where there is none at all
    it is, whatever is given here."""
    _memory: _LinearisationMemory = field(
        default_factory=_LinearisationMemory, init=False, repr=False, compare=False
    )

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.track not in self.mechanism.coordinates:
            raise ParameterError(
                "PartialLinearisation.track must be one of the coordinates"
                f" {', '.join(self.mechanism.coordinates)}, got {self.track!r}."
            )

    @property
    def singular(self) -> tuple[float, ...]:
        """Times of the samples at which the law was singular since the last `reset` [s]."""
        return tuple(self._memory.singular)

    def reset(self) -> None:
        """Forget the last command and the singular times."""
        object.__setattr__(self, "_memory", _LinearisationMemory(evaluator=self._memory.evaluator))

    def __call__(self, t: float, measured: Mapping[str, float]) -> float:
        """Return the command at a sample."""
        memory = self._memory
        if memory.evaluator is None:
            memory.evaluator = Evaluator(self.mechanism, self.drive)
        names = (*self.mechanism.coordinates, *self.mechanism.rates)
        missing = [name for name in names if name not in measured]
        if missing:
            raise InputError(f"PartialLinearisation needs measurements of {', '.join(missing)}.")
        table = memory.evaluator(t, [measured[name] for name in names])
        speed = measured[self.mechanism.rates[memory.evaluator.slip]]
        command = self._command(table, memory.evaluator.slip, speed, self._target(t, measured))
        if command is None:
            memory.singular.append(t)
        else:
            memory.command = command
        return memory.command

    def _target(self, t: float, measured: Mapping[str, float]) -> float:
        """Return the acceleration that the tracked coordinate shall have."""
        rate = self.mechanism.rates[self.mechanism.coordinates.index(self.track)]
        return (
            value_at(self.reference_acceleration, t)
            + self.damping * (value_at(self.reference_rate, t) - measured[rate])
            + self.stiffness * (value_at(self.reference, t) - measured[self.track])
        )

    def _command(self, table: Any, slip: int, speed: float, target: float) -> float | None:
        """Return the command, None where there is none."""
        row = self.mechanism.coordinates.index(self.track)
        if abs(speed) > self.rest_speed:
            # Slip tells the direction of friction.
            return self._sliding(table, row, target, self._line(speed))
        if row == slip:  # it must break away, to where it is asked to go
            side = 1.0 if target > 0.0 else -1.0
            return self._sliding(table, row, target, self._holding(side))
        held, friction, normal = self._stuck(table, row, slip, target)
        # What holds is within the cone of friction: the body stays.
        if held is None or abs(friction) <= float(self.law.break_away(normal)):
            return held
        side = 1.0 if friction > 0.0 else -1.0
        # The limit of slip from rest: no speed yet, and already a direction.
        return self._sliding(table, row, target, self._line(side * 1e-300))

    def _line(self, speed: float) -> _Line:
        # Laws are affine in the load: two loads tell the line.
        none, loaded = (sliding_force(self.law, speed, load) for load in (0.0, 1.0))
        return _Line(none, loaded - none)

    def _holding(self, side: float) -> _Line:
        none, loaded = (side * float(self.law.break_away(load)) for load in (0.0, 1.0))
        return _Line(none, loaded - none)

    def _sliding(self, table: Any, row: int, target: float, friction: _Line) -> float | None:
        """Solve acceleration, normal force and friction for the command."""
        (free, by_friction, by_command), (n_0, n_f, n_u) = table[:, row], table[:, -1]
        # N = n_0 + n_f F + n_u u and F = c + s N, solved for N.
        pivot = 1.0 - friction.slope * n_f
        if pivot <= 0.0:
            return None  # Painleve's paradox
        constant = (friction.constant + friction.slope * n_0) / pivot
        slope = friction.slope * n_u / pivot
        gain = by_command + by_friction * slope
        if self._is_singular(gain, abs(by_command) + abs(by_friction * slope)):
            return None
        command = (target - free - by_friction * constant) / gain
        normal = n_0 + n_f * (constant + slope * command) + n_u * command
        return float(command) if normal > 0.0 else None

    def _is_singular(self, gain: float, size: float) -> bool:
        return abs(gain) <= max(self.least, ROUNDING * size)

    def _stuck(
        self, table: Any, row: int, slip: int, target: float
    ) -> tuple[float | None, float, float]:
        """Return command, friction and normal force while the contact holds."""
        # Friction that holds makes the acceleration of the slip 0: F = -(s_0 + s_u u) / s_f.
        (a_0, a_f, a_u), (s_0, s_f, s_u), (n_0, n_f, n_u) = (table[:, i] for i in (row, slip, -1))
        gain = a_u - a_f * s_u / s_f
        if self._is_singular(gain, abs(a_u) + abs(a_f * s_u / s_f)):
            return None, 0.0, 0.0
        command = (target - a_0 + a_f * s_0 / s_f) / gain
        friction = -(s_0 + s_u * command) / s_f
        normal = n_0 + n_f * friction + n_u * command
        return (float(command) if normal > 0.0 else None), float(friction), float(normal)
