"""Partial feedback linearisation: one coordinate follows, friction and all else being known."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, final

from typing_extensions import override

from stickslip.control.equations_of_motion import Evaluator
from stickslip.control.friction_compensation import sliding_force
from stickslip.control.pid import Signal, value_at
from stickslip.errors import InputError, ParameterError
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Parametrised, Quantity

ROUNDING = 1e-12
"""Share of its parts at which an acceleration per command is none."""


@dataclass
class _Memory:
    """What is kept from sample to sample."""

    evaluator: Evaluator | None = None
    command: float = 0.0
    singular: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class _Line:
    """Friction at the contact as a line over the normal force, ``constant + slope * N``."""

    constant: float
    slope: float


@final
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
    _memory: _Memory = field(default_factory=_Memory, init=False, repr=False, compare=False)

    @override
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
        object.__setattr__(self, "_memory", _Memory(evaluator=self._memory.evaluator))

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
            return self._sliding(table, row, target, self._line(speed))
        if row == slip:  # it must break away, to where it is asked to go
            side = 1.0 if target > 0.0 else -1.0
            return self._sliding(table, row, target, self._holding(side))
        held, friction, normal = self._stuck(table, row, slip, target)
        if held is None or abs(friction) <= float(self.law.break_away(normal)):
            return held
        side = 1.0 if friction > 0.0 else -1.0
        return self._sliding(table, row, target, self._line(side * 1e-300))

    def _line(self, speed: float) -> _Line:
        none, one = (sliding_force(self.law, speed, load) for load in (0.0, 1.0))
        return _Line(none, one - none)

    def _holding(self, side: float) -> _Line:
        none, one = (side * float(self.law.break_away(load)) for load in (0.0, 1.0))
        return _Line(none, one - none)

    def _sliding(self, table: Any, row: int, target: float, friction: _Line) -> float | None:
        """Solve acceleration, normal force and friction for the command."""
        (free, by_friction, by_command), (n_0, n_f, n_u) = table[:, row], table[:, -1]
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
        (a_0, a_f, a_u), (s_0, s_f, s_u), (n_0, n_f, n_u) = (table[:, i] for i in (row, slip, -1))
        gain = a_u - a_f * s_u / s_f
        if self._is_singular(gain, abs(a_u) + abs(a_f * s_u / s_f)):
            return None, 0.0, 0.0
        command = (target - a_0 + a_f * s_0 / s_f) / gain
        friction = -(s_0 + s_u * command) / s_f
        normal = n_0 + n_f * friction + n_u * command
        return (float(command) if normal > 0.0 else None), float(friction), float(normal)
