"""Drives that follow states: proportional feedback, switching, and feedback with a delay."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, final

from typing_extensions import override

from stickslip.errors import InputError, UnknownNameError
from stickslip.maths import Scalar, where
from stickslip.mechanisms.drives import base
from stickslip.quantities import Quantity


@dataclass(frozen=True, kw_only=True)
class StateFeedback(base.Drive):
    """A drive whose value depends on a state, and not on time: it acts at once, without samples.

    Any drive may be added to it. It has no value outside of a run.
    """

    state: str
    """Name of the coordinate or rate that it follows, such as ``"x"`` or ``"v"``."""

    def seen(self, states: Mapping[str, Scalar]) -> Scalar:
        """Return the state that it follows."""
        if self.state not in states:
            raise UnknownNameError("state of a feedback", self.state, states)
        return states[self.state]

    @final
    @override
    def smooth(self, t: Scalar) -> Scalar:
        return 0.0

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        return ()

    @final
    @override
    def smooth_bound(self) -> tuple[Scalar, Scalar]:
        return -math.inf, math.inf

    @final
    @override
    def time_scale(self) -> float:
        return math.inf

    @property
    @override
    def steady(self) -> bool:
        return True


@dataclass(frozen=True, kw_only=True)
class Feedback(StateFeedback):
    """A force or torque in proportion to an error, ``gain * (reference - state)``.

    Equations that are linear without it are so with it, and are solved as exactly.

    Examples
    --------
    A spring of 100 N/m and a damper of 2 N s/m, made by a controller:

    >>> from stickslip import Axis, Coulomb, simulate
    >>> pull = Feedback(state="x", gain=100.0, reference=0.1) + Feedback(state="v", gain=2.0)
    >>> axis = Axis(inertia=1.0, drive=pull)
    >>> run = simulate(axis, Coulomb(kinetic_coefficient=0.5), t_end=10.0)
    >>> run.status.name, round(float(run["x"][-1]), 4)
    ('END_TIME', 0.0953)
    """

    gain: Annotated[float, Quantity("K")]
    """Force or torque per unit of the state."""
    reference: Annotated[float, Quantity("r")] = 0.0
    """Value of the state at which the drive is 0, in its unit."""

    @override
    def fed(self, states: Mapping[str, Scalar]) -> Scalar:
        return self.gain * (self.reference - self.seen(states))


@dataclass(frozen=True, kw_only=True)
class Relay(StateFeedback):
    """A force or torque that switches between two values as a state passes a level.

    Runs meet the switch exactly, as an event "relay switches up" or "relay switches down". A state
    that begins at the level leaves it as it moves, or as the drive pushes it. Where it begins at
    the level, or reaches it, and both values push it back, it is held there: that run ends with
    `Status.ZENO`, as it would switch without end.

    Examples
    --------
    A mass that is pushed towards 0 from either side stops, with friction, after some turns:

    >>> from stickslip import Axis, Coulomb, simulate
    >>> axis = Axis(inertia=1.0, drive=Relay(state="x", above=-2.0, below=2.0))
    >>> run = simulate(axis, Coulomb(kinetic_coefficient=1.0), t_end=1.0, y0={"x": -1.0})
    >>> round(float(run["x"][-1]), 9)
    -0.5
    """

    above: Annotated[float, Quantity("P_a", "N", or_unit="N m")]
    """Value while the state is above the level."""
    below: Annotated[float, Quantity("P_b", "N", or_unit="N m")]
    """Value while it is not."""
    level: Annotated[float, Quantity("l")] = 0.0
    """Where it switches, in the unit of the state."""

    @override
    def fed(self, states: Mapping[str, Scalar]) -> Scalar:
        names = ("relay switches up", "relay switches down")
        return where(self.seen(states) > self.level, self.above, self.below, names)


@dataclass(frozen=True, kw_only=True)
class DelayedFeedback(StateFeedback):
    """A force or torque ``gain * (x(t - delay) - x(t))`` from a state x now and a while ago.

    Where motions repeat themselves after the delay it vanishes: they are those without it, and it
    changes whether they are stable (Pyragas). Before time 0 the state counts as what it was at 0.
    A run takes the past from its record, as straight lines that are off by 1e-6 of the size of the
    state at most; sensitivities are not known. `periodic_orbit` gives the multipliers of orbits
    whose period goes into the delay.

    References
    ----------
    K. Pyragas, Continuous control of chaos by self-controlling feedback, Physics Letters A 170
    (1992) 421-428.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, simulate
    >>> damper = DelayedFeedback(state="x", gain=100.0, delay=0.01)
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=damper)
    >>> free = Coulomb(kinetic_coefficient=0.0)
    >>> run = simulate(axis, free, t_end=5.0, y0={"x": 1.0})
    >>> bool(abs(run["x"][-1]) < 0.1)
    True
    """

    gain: Annotated[float, Quantity("K")]
    """Force or torque per unit of the state."""
    delay: Annotated[float, Quantity("tau", "s", above=0)]
    """How long ago."""

    @override
    def fed(self, states: Mapping[str, Scalar]) -> Scalar:
        return -self.gain * self.seen(states)  # what was a while ago are the lines of a run

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        raise InputError(
            "DelayedFeedback has a past in runs of `simulate` alone, and multipliers in"
            " `periodic_orbit`: sweeps, sensitivities, controllers, fixed steps and exports know"
            " none. Leave it out, or use Feedback."
        )


def is_delayed(drive: base.Drive) -> bool:
    """Whether a drive, or a part of it, feeds back what a state was a while ago.

    Examples
    --------
    >>> is_delayed(Feedback(state="x", gain=1.0) + DelayedFeedback(state="x", gain=1.0, delay=0.1))
    True
    """
    return any(isinstance(part, DelayedFeedback) for part in base.parts_of(drive))


def without_delays(drive: base.Drive, *instead: base.Drive) -> base.Drive:
    """Return a drive with others in place of its delayed feedback, 0 if there is nothing else.

    Examples
    --------
    >>> without_delays(DelayedFeedback(state="x", gain=1.0, delay=0.1)).parts
    (Feedback(state='x', gain=0.0, reference=0.0),)
    """
    parts = base.parts_of(drive)
    delayed = [part for part in parts if isinstance(part, DelayedFeedback)]
    if not delayed:
        return drive
    others = [part for part in parts if not isinstance(part, DelayedFeedback)]
    nothing = [Feedback(state=part.state, gain=0.0) for part in delayed]
    return base.Sum(parts=(*others, *(instead or nothing)))
