"""One piece of a series in the band of the balance, and the states of bristles along it."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import final

import numpy as np
from numpy.typing import NDArray

from stickslip.evidence.bristles import SIGN, Shape, bristle_states, lugre_states, play
from stickslip.evidence.motion import (
    RINGING,
    LowPass,
    derivative,
    directions,
    low_pass,
    near_rest,
    open_rows,
    resolution_of,
)
from stickslip.evidence.series import Series, even

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

RESOLVED = 4.0
"""Displacement that the sensor resolves, over its noise."""
CHATTER = 0.5
"""Reach of the play that frees the path of chatter, over the noise that the filter leaves."""


@final
@dataclass(eq=False, kw_only=True)
class Part:
    """One piece of a series, filtered."""

    channel: str
    """Name of the joint."""
    inertia: bool
    """Whether an inertia is to be found."""
    mass: float | None
    """Inertia that is known, whose share is not among the forces."""
    h: float
    """Step [s] of its samples."""
    every: int
    """Samples to a row: rows are not denser than the band asks for."""
    filter: LowPass | None
    """The filter that force and columns pass; None in a table, which needs none."""
    t: Array
    """Times (n,) [s] of the samples."""
    clock: Array
    """Times (n,) from -1/2 to 1/2 over all series of the channel."""
    since: Array
    """Times (n,) [s] since the start of these."""
    q: Array
    """Positions (n,) in twice the band."""
    centre: float
    """Position from which terms along the way count."""
    path: Array
    """Positions (n,) in the band, without chatter, along which bristles move."""
    v: Array
    """Velocities (n,) in twice the band."""
    a: Array
    """Accelerations (n,) in the band."""
    raw: Array
    """Measured forces (n,)."""
    force: Array
    """Forces (n,) in the band, at the times at which they act, without those that are taken."""
    taken: Array
    """Forces (n,) in the band that known motion takes, which no channel shows late."""
    covariates: Mapping[str, Array]
    """Covariates (n,) in the band."""
    extra: Mapping[str, Array]
    """Known columns (n,) in the band."""
    references: Mapping[str, float]
    """Values of covariates from which terms count."""
    start: float
    """State of bristles at the first sample: force over level."""
    noise: float
    """Standard deviation of what the positions do not resolve."""
    open: Flags
    """Rows (m,) at which a law without memory leaves a force open."""
    clear: Flags
    """Rows (m,) in which the filter mixes nothing of a rest."""
    rows: slice
    """Its rows among those of all parts."""
    states: dict[Shape, Array] = field(default_factory=dict)
    """States (n,) of bristles by shape, as they are asked for."""

    @property
    def driven(self) -> bool:
        """Return whether the force moves an inertia."""
        return self.inertia or self.mass is not None

    @property
    def resolved(self) -> float:
        """Return the displacement that the sensor resolves."""
        return RESOLVED * self.noise

    @property
    def count(self) -> int:
        """Return the number of rows."""
        return len(self.open)

    def state(self, shape: Shape) -> Array:
        """Return the state (n,) of a bristle along the path."""
        if shape not in self.states:
            self.make_states([shape])
        return self.states[shape]

    def make_states(self, shapes: Iterable[Shape]) -> None:
        """Make the states of many bristles at once, which costs little more than those of one."""
        missing = [shape for shape in shapes if shape not in self.states]
        dahl = [shape for shape in missing if len(shape) == 2]
        lugre = [shape for shape in missing if len(shape) != 2]
        if dahl:
            found = bristle_states(self.path, dahl, self.start)
            self.states.update(zip(dahl, np.ascontiguousarray(found.T), strict=True))
        if lugre:
            found = lugre_states(self.path, self.v, lugre, self.start)
            self.states.update(zip(lugre, np.ascontiguousarray(found.T), strict=True))


def part_of(
    piece: Series,
    fc: float,
    first_row: int,
    span: tuple[float, float],
    centre: float,
    references: Mapping[str, float],
) -> Part:
    """Return a piece in a band [Hz], whose rows begin at a number.

    Columns are made of motion in twice the band and pass the filter then; a bristle follows the
    position in the band itself, freed of chatter. `span` has the first time and the length of all
    series of the channel.
    """
    s = even(piece)
    h = float(s.t[1] - s.t[0])
    every = max(int(0.5 / (h * 3.0 * fc)), 1)
    own, wide = low_pass(h, fc), low_pass(h, 2.0 * fc, 0.95)
    q, slow = wide.passed(s.q), own.passed(s.q)
    v = derivative(q, h) if s.velocity is None else wide.passed(s.velocity)
    speed = derivative(slow, h) if s.velocity is None else own.passed(s.velocity)
    sigma = max(resolution_of(piece), 1e-6 * float(np.ptp(q)))
    direction = directions(s, v, sigma, fc)
    rest = open_rows(q, direction, RESOLVED * sigma, fc, h)[::every]
    acting = np.interp(s.t - 0.5 * h, s.t, s.force) if s.hold else s.force
    a = derivative(speed, h)
    taken = (s.mass or 0.0) * a
    if s.taken is not None:
        taken = taken + own.passed(s.taken)
    beside = near_rest(q, RESOLVED * sigma, fc, h, math.ceil(RINGING / fc / h))[::every]
    return Part(
        channel=s.channel,
        inertia=s.inertia,
        mass=s.mass,
        h=h,
        every=every,
        filter=own,
        t=s.t,
        clock=(s.t - span[0]) / span[1] - 0.5,
        since=s.t - span[0],
        q=q,
        centre=centre,
        path=play(slow, CHATTER * sigma * math.sqrt(min(2.0 * h * fc, 1.0))),
        v=v,
        a=a,
        raw=s.force,
        force=own.passed(acting) - taken,
        taken=taken,
        covariates={name: own.passed(x) for name, x in s.covariates.items()},
        extra={name: own.passed(x) for name, x in s.extra.items()},
        references=references,
        start=_first_state(s, max(int(0.5 / fc / h), 2)),
        noise=sigma,
        open=rest,
        clear=~beside,
        rows=slice(first_row, first_row + len(rest)),
        states={SIGN: direction},
    )


def _first_state(series: Series, half: int) -> float:
    """Return the state of a bristle that the first forces ask for, if they are friction alone."""
    force = series.force if series.taken is None else series.force - series.taken
    level = float(np.quantile(np.abs(force), 0.8))
    if series.extra or level <= 0.0:
        return 0.0
    return float(np.clip(np.median(force[: max(half // 2, 1)]) / level, -1.0, 1.0))
