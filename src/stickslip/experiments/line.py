"""The line along which a body moved in a picture, and its way along that line."""

from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from stickslip.described import Described
from stickslip.errors import InputError
from stickslip.formatting import number

SLENDER: Final = 3.0
"""Spread along a line over that across it from which on the points lie along it."""
NET: Final = 0.5
"""Distance of the end from the start over the whole way from which on a body travels."""
MOVED: Final = 0.02
"""Way over the whole way from which on a body has moved, where there is no jitter."""
SURE: Final = 6.0
"""Standard deviations of the jitter that it must have moved as well."""


@final
@dataclass(frozen=True, kw_only=True)
class Line(metaclass=Described):
    """The line on which positions in a plane were projected, and how far they lay beside it.

    Examples
    --------
    >>> Line(tilt=0.05, length=0.2, across=0.4e-3, jitter=0.4e-3).wander
    0.0
    """

    tilt: float
    """Angle from the first axis of the plane to the line [rad], above -pi/2, at most pi/2."""
    length: float
    """Of the part that the body passed [m]."""
    across: float
    """Distance of the samples from the line, root mean square [m]."""
    jitter: float
    """The part of that distance which changes from one sample to the next [m]."""
    reversed: bool = False
    """Whether the way counts against the first axis of the plane."""

    @property
    def wander(self) -> float:
        """The part of the distance that is no jitter, root mean square [m]."""
        return float(np.sqrt(max(self.across**2 - self.jitter**2, 0.0)))

    def scaled(self, factor: float) -> "Line":
        """Return the line with its lengths times a factor."""
        return replace(
            self,
            length=factor * self.length,
            across=factor * self.across,
            jitter=factor * self.jitter,
        )


def travels(way: NDArray[np.float64]) -> bool:
    """Whether a body is in the end a good part of its whole way from where it began.

    Examples
    --------
    >>> travels(np.array([0.0, -0.1, 0.3, 0.8])), travels(np.array([0.0, 1.0, -1.0, 0.2]))
    (True, False)
    """
    return bool(abs(way[-1] - way[0]) > NET * np.ptp(way))


def along(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.float64], Line]:
    """Return the way along the line through points, and that line.

    The line is the principal axis of the points, from which their squared distances are smallest.
    It is positive in the direction of the net travel, since what drives itself may recoil first;
    of a swing, which has none, in that of its first move.

    An error of its angle, about jitter over length and root of n, shortens ways by half its square
    only, so that nothing is gained by measuring the angle.

    Examples
    --------
    >>> position, line = along(np.array([5.0, 1.0, -3.0]), np.array([1.0, 4.0, 7.0]))
    >>> position.tolist(), round(float(np.degrees(line.tilt)), 2)
    ([0.0, 5.0, 10.0], -36.87)
    """
    points = np.stack([x, y], axis=1)
    centred = points - points.mean(axis=0)
    if len(points) < 2:  # which have no axes
        return np.zeros(len(points)), Line(tilt=0.0, length=0.0, across=0.0, jitter=0.0)
    # Rows of `axes` are the unit vectors along and across; `spread` is root of n times the rms.
    _, spread, axes = np.linalg.svd(centred, full_matrices=False)
    long, short = spread / np.sqrt(len(points))
    if not long > SLENDER * short:
        raise InputError(
            "the two columns of position show no motion along a line: their points scatter by"
            f" {number(float(long))} along and {number(float(short))} across the best-fit line"
            " (root mean square). Name a single column, or compute one position or angle from both"
            " first."
        )
    way, beside = centred @ axes.T[:, 0], centred @ axes.T[:, 1]
    way = way - way[0]
    jitter = min(float(np.sqrt(np.mean(np.diff(beside) ** 2) / 2)), float(short))
    length = float(np.ptp(way))
    far = np.abs(way) >= max(MOVED * length, min(SURE * jitter, length / 2))
    net = way[-1] if travels(way) else way[int(np.argmax(far))]
    ahead = axes[0, 0] > 0 or (axes[0, 0] == 0 < axes[0, 1])
    cosine, sine = axes[0] if ahead else -axes[0]
    line = Line(
        tilt=float(np.arctan2(sine, cosine)),
        length=length,
        across=float(short),
        jitter=jitter,
        reversed=bool(ahead != (net > 0.0)),
    )
    return way * np.sign(net), line
