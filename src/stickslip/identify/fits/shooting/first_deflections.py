"""First deflections of bristles: what slip before a segment has built up.

They are not free like the other initial states: what they do in the first micrometres, an initial
velocity does nearly as well, and noise would set both against each other. They are followed along
the measured motion instead, from the first sample of the record on. What was before that nobody
knows: a body at rest has the friction that balances the other forces, one that moves has slipped.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stickslip.friction import FrictionLaw
from stickslip.identify.fits.estimation.bristle_integration import Path, balancing, follow
from stickslip.identify.fits.estimation.parameters import MOVED, FreeParameters, PerturbedLaws

Array = NDArray[np.float64]

BEFORE = 0.02
"""Share of a segment whose length times the first velocity is how far the body slipped before the
first sample of a record."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedMotion:
    """The motion of a record between two gaps, and what it begins with."""

    record: int
    """Which record it is of."""
    path: Path
    """The motion, from the first sample on."""
    held: float = 0.0
    """Friction [N] that would balance all other forces on a body at rest at the first sample."""

    @classmethod
    def unknown(cls, record: int, start: float) -> "RecordedMotion":
        """Return the motion of which nothing is known but when it begins [s], under 1 N."""
        one = np.ones(1)
        path = Path(time=start * one, velocity=0.0 * one, load=one, travel=np.zeros(0))
        return cls(record=record, path=path)

    @property
    def start(self) -> float:
        """Time of the first sample [s]."""
        return float(self.path.time[0])

    def begun(self, velocity: float) -> "RecordedMotion":
        """Return the first sample alone, with another slip velocity [m/s]."""
        one = self.path
        first = replace(
            one,
            time=one.time[:1],
            velocity=np.array([velocity]),
            load=one.load[:1],
            travel=np.zeros(0),
            inputs={name: x[:1] for name, x in one.inputs.items()},
        )
        return replace(self, path=first)

    def covers(self, record: int, time: float) -> bool:
        """Return whether a time of a record is within the motion."""
        return self.record == record and self.path.time[0] <= time <= self.path.time[-1]

    def led_in(self, time: float) -> Path:
        """Return the path after some time [s] of slip at the first velocity."""
        one = self.path
        columns = one.time, one.velocity, one.load, *one.inputs.values()
        times, velocity, load, *inputs = (np.append(column[0], column) for column in columns)
        times[0] -= time
        return Path(
            time=times,
            velocity=velocity,
            load=load,
            travel=np.append(velocity[0] * time, one.travel),
            inputs=dict(zip(one.inputs, inputs, strict=True)),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class FirstDeflections:
    """Deflections with which the segments of a record begin, for a law at some values.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=2.0, bristle_stiffness=1e4)
    >>> first = FirstDeflections(
    ...     law=law,
    ...     free_parameters=FreeParameters(()),
    ...     values=np.zeros(0),
    ...     motion=RecordedMotion.unknown(0, 0.0).begun(0.1),
    ...     starts=np.zeros(1),
    ...     length=1.0,
    ... )
    >>> first.states.round(7)  # of steady slip, in m
    array([[0.0002]])
    """

    law: FrictionLaw
    """Holds the parameters that are not looked for."""
    free_parameters: FreeParameters
    """What is looked for."""
    values: Array
    """Its values (p,) [SI]."""
    motion: RecordedMotion
    """The motion of the record."""
    starts: Array
    """Times (k,) [s] at which segments begin."""
    length: float
    """Length of segments [s], of which a share was slip before the first sample."""

    @cached_property
    def path(self) -> Path:
        """The motion that bristles are followed along."""
        return self.motion.led_in(BEFORE * self.length)

    @property
    def velocity_slopes(self) -> Array:
        """Slopes [s] of the states (k, b) by the first velocity."""
        velocity = float(self.motion.path.velocity[0])
        if velocity == 0.0:
            return np.full_like(self.states, BEFORE * self.length)
        moved = replace(self, motion=self.motion.begun((1.0 + MOVED) * velocity))
        return np.asarray((moved.states - self.states) / (MOVED * velocity))

    @cached_property
    def states(self) -> Array:
        """Deflections [m] at the starts (k, b)."""
        return self._at_starts(self._followed)[..., 0]

    @cached_property
    def slopes(self) -> Array:
        """Their slopes by the unknowns (k, b, p)."""
        own = self._copies(slopes=True)
        found = self._at_starts(self._along(own, self._followed[..., 0]))
        table = np.zeros((*found.shape[:2], own.free_parameters))
        moved = found[..., 1 : 1 + len(own.moved)]
        table[..., list(own.columns)] = (moved - found[..., :1]) / own.moved
        return np.nan_to_num(table)

    @cached_property
    def _followed(self) -> Array:
        """Deflections along the motion (b, n, 1)."""
        return self._along(self._copies(slopes=False))[..., :1]

    def _copies(self, *, slopes: bool) -> PerturbedLaws:
        return PerturbedLaws.of(
            self.law, self.free_parameters, self.values, constant="", slopes=slopes
        )

    def _along(self, own: PerturbedLaws, guess: Array | None = None) -> Array:
        """Return deflections along the motion (b, n, copies); 0 where they cannot be found."""
        first = np.zeros((own.bristles, own.count))
        with np.errstate(all="ignore"):  # a law that fails far out is refused by its runs
            if self.path.velocity[0] == 0.0:  # at rest bristles balance the other forces
                first[:] = balancing(own.law, self.path, self.motion.held, own.bristles)
            return np.nan_to_num(follow(own.law, self.path, first, guess))

    def _at_starts(self, states: Array) -> Array:
        """Return deflections at the starts (k, b, copies), straight between samples."""
        time = self.path.time
        at = np.clip(np.searchsorted(time, self.starts, side="right"), 1, len(time) - 1)
        share = (self.starts - time[at - 1]) / (time[at] - time[at - 1])
        share = np.clip(share, 0.0, 1.0)[:, None]
        found = states[:, at - 1] * (1.0 - share) + states[:, at] * share
        return np.asarray(found.transpose(1, 0, 2))
