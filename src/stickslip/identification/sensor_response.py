"""The response of a force sensor: how much later, or slower, it shows friction."""

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
@dataclass(frozen=True, kw_only=True)
class SensorResponse:
    """How a force channel shows a force: after a delay, or through a lag of first order.

    Examples
    --------
    >>> t = np.arange(6.0)
    >>> step = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 1.0])
    >>> SensorResponse(delay=2.0).shown(t, step).tolist()
    [0.0, 0.0, 0.0, 0.0, 1.0, 1.0]
    >>> SensorResponse(lag=1.0).shown(t, step).round(2).tolist()
    [0.0, 0.0, 0.37, 0.77, 0.91, 0.97]
    """

    delay: float = 0.0
    """Time [s] after which the channel shows the force; below 0 where the motion is shown late."""
    lag: float = 0.0
    """Time constant [s] of a low-pass filter of first order."""

    @property
    def late(self) -> float:
        """Mean time [s] by which the force is shown late."""
        return self.delay + self.lag

    def __bool__(self) -> bool:
        """Whether the channel changes anything."""
        return self.delay != 0.0 or self.lag != 0.0

    def shown(self, time: Array, force: Array) -> Array:
        """Return what the channel shows of forces."""
        if self.delay:
            force = _at(time - self.delay, time, force)
        return self.filtered(time, force)

    def filtered(self, time: Array, force: Array) -> Array:
        """Return forces as `shown` does, without the delay."""
        if not self.lag:
            return force
        from scipy.signal import lfilter

        step = float(np.mean(np.diff(time)))
        a = float(np.exp(-step / self.lag))
        last = 1.0 - (1.0 - a) * self.lag / step  # between samples the force goes straight
        weights = [last, (1.0 - a) - last]
        return np.asarray(force[:1] + lfilter(weights, [1.0, -a], force - force[:1], axis=0))

    def acted(self, time: Array, force: Array) -> Array:
        """Return the forces that a channel shows, when they acted.

        Examples
        --------
        >>> t = 0.01 * np.arange(100)
        >>> late = SensorResponse(delay=0.02, lag=0.03)
        >>> ramp = late.acted(t, late.shown(t, t))
        >>> bool(np.max(np.abs(ramp - t)[30:90]) < 1e-3)
        True
        """
        if self.lag:
            force = force + self.lag * np.gradient(force, time)
        return _at(time + self.delay, time, force) if self.delay else force

    def known(self, time: Array) -> NDArray[np.bool_]:
        """Return at which samples of a force the motion that came with it was measured."""
        shown = time - self.delay
        return np.asarray((shown >= time[0]) & (shown <= time[-1]))

    def moved(self, time: Array, values: Array) -> Array:
        """Return what was measured of a motion when the force was that which is shown."""
        return np.interp((time - self.delay)[self.known(time)], time, values)


PROMPT = SensorResponse()
"""A channel without delay."""


def _at(when: Array, time: Array, force: Array) -> Array:
    """Return columns at other times, linear between samples."""
    right = np.clip(np.searchsorted(time, when), 1, len(time) - 1)
    share = np.clip((when - time[right - 1]) / (time[right] - time[right - 1]), 0.0, 1.0)
    share = share.reshape(-1, *(1,) * (force.ndim - 1))
    return np.asarray((1.0 - share) * force[right - 1] + share * force[right])
