"""PID control with a bounded integral part."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, TypeAlias, final

from typing_extensions import override

from stickslip.control.feedback_loop import Controller
from stickslip.errors import InputError, ParameterError
from stickslip.mechanisms import within_limit
from stickslip.quantities import Parametrised, Quantity

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
class _Memory:
    """What a controller remembers from one sample to the next."""

    t: float | None = None
    place: float = 0.0
    speed: float = 0.0
    integral: float = 0.0


@final
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
    _memory: _Memory = field(default_factory=_Memory, init=False, repr=False, compare=False)

    @override
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
        object.__setattr__(self, "_memory", _Memory())
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
        found, integral = self._integrated(command, error, since)
        memory.t, memory.place, memory.speed, memory.integral = t, place, speed, integral
        return found

    def _speed(self, measured: Mapping[str, float], place: float, since: float) -> float:
        """Return the measured rate, or an estimate."""
        if self.rate is not None:
            return _seen(measured, self.rate)
        if since <= 0.0:
            return 0.0
        raw = (place - self._memory.place) / since
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
            return found, grown + share * (found - (command + grown))
        return found, integral


def _seen(measured: Mapping[str, float], name: str) -> float:
    if name not in measured:
        raise InputError(
            f"PID: {name!r} is not measured; measured quantities: {', '.join(measured) or 'none'}."
        )
    return measured[name]
