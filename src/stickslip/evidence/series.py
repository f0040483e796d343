"""Dense series of one joint: what was measured, and its pieces on even grids."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label, maximum_filter1d, median_filter, minimum_filter1d

from stickslip.errors import InputError

Array = NDArray[np.float64]

GAP = 5.5
"""Steps between two samples, over the usual one, from which a series is cut: what is interpolated
over fewer is below the band of the balance at nearly all rates."""
FAR = 10.0
"""Least distance of an outlier from the median of its neighbours, over that which a tenth exceeds.
"""
APART = 3.0
"""The same over the change from a sample to the next, the usual one and those beside ..."""
BESIDE = 9
"""Samples about it of which the change counts."""
OUT = 1.25
"""Least distance of an outlier beside a step from both of its sides, over its height ..."""
OFTEN = 0.2
"""... at a share of the steps at most: peaks at more of them are those of break-aways."""
SHARES = {"position": 0.005, "force": 0.5}
"""... and over the range. A position is smooth; a force that is commanded may have peaks."""
SELDOM = 0.01
"""Most outliers over the samples: what is more frequent belongs to the signal."""
FEWEST = 64
"""Samples of the shortest piece: filters of fourth order forward and backward need half of them."""


@final
@dataclass(frozen=True, eq=False)
class Series:
    """One joint of one record."""

    t: Array
    """Times (n,) [s], which grow."""
    q: Array
    """Positions (n,) [m] or [rad]."""
    force: Array
    """Forces (n,) [N] or torques [N m] of the drive, in the direction of the position."""
    channel: str = ""
    """Name of the joint: series of one channel share its terms."""
    inertia: bool = True
    """Whether an inertia is to be found; False if the force is friction itself, if `mass` is known
    or if `extra` has the inertia."""
    mass: float | None = None
    """Inertia [kg] or [kg m^2] that is known, whose share of the force is taken off."""
    taken: Array | None = None
    """Further forces (n,) [N] or torques [N m] that the motion of a known mechanism takes, such as
    those by the motion of other joints, which are taken off too."""
    covariates: Mapping[str, Array] = field(default_factory=dict)
    """What friction may depend on (n,), by name: `load` [N], `temperature` [°C], others."""
    extra: Mapping[str, Array] = field(default_factory=dict)
    """Known columns of the mechanism (n,), each with a free coefficient: by name, which series
    of several channels may share."""
    velocity: Array | None = None
    """Measured velocities (n,) [m/s] or [rad/s], if there are any."""
    resolution: float | None = None
    """Standard deviation of what the positions do not resolve; None if they show it, as positions
    on lines between recorded ones do not."""
    hold: bool = False
    """Whether each force holds until the next sample: it then acts half a sample later."""

    def __post_init__(self) -> None:
        if self.mass is not None:
            object.__setattr__(self, "inertia", False)

    @property
    def driven(self) -> bool:
        """Whether the force moves an inertia."""
        return self.inertia or self.mass is not None


def pieces(series: Series) -> Iterator[Series]:
    """Yield the pieces of a series between its gaps, as they were measured.

    Examples
    --------
    >>> t = np.concatenate([np.arange(100.0), 200.0 + np.arange(80.0)])
    >>> [len(one.t) for one in pieces(Series(t, np.sin(t), np.cos(t)))]
    [100, 80]
    """
    checked(series)
    grows = np.concatenate([[True], np.diff(series.t) > 0.0])
    whole = _picked(series, np.flatnonzero(grows))
    far = np.any([*outliers(whole).values()], axis=0)
    whole = _picked(whole, np.flatnonzero(~far)) if far.any() else whole
    steps = np.diff(whole.t)
    step = float(np.median(steps))
    cuts = np.concatenate([[0], np.flatnonzero(steps > GAP * step) + 1, [len(whole.t)]])
    for first, end in pairwise(cuts.tolist()):
        if end - first >= FEWEST:
            yield _picked(whole, np.arange(first, end))


def outliers(series: Series) -> dict[str, NDArray[np.bool_]]:
    """Return which samples (n,) of the position and of the force lie far off those beside them."""
    columns = {"position": series.q, "force": series.force}
    return {name: _far_off(np.asarray(x, float), SHARES[name]) for name, x in columns.items()}


def _far_off(x: Array, share: float) -> NDArray[np.bool_]:
    """Return which single values (n,), or pairs, lie off those beside them by a share of the range.

    A step is none, as the median of five follows it, nor is the turn of a swing, beside which
    samples differ as much; a value beyond both sides of a step is one where other steps have none.

    Examples
    --------
    >>> x = np.sin(0.01 * np.arange(500.0))
    >>> x[[100, 300, 301]] += 3.0
    >>> np.flatnonzero(_far_off(x, 0.05)).tolist()
    [100, 300, 301]
    """
    middle = median_filter(x, 5, mode="nearest")
    apart = np.abs(x - middle)
    low, high = np.quantile(x, [0.01, 0.99])
    steps = np.abs(np.diff(x))
    usual = float(np.median(steps[steps > 0.0])) if steps.any() else 0.0
    beside = maximum_filter1d(np.abs(np.diff(middle, append=middle[-1])), BESIDE)
    least = max(FAR * float(np.quantile(apart, 0.9)), share * float(high - low), APART * usual)
    top, bottom = maximum_filter1d(middle, BESIDE), minimum_filter1d(middle, BESIDE)
    lone = (apart > least) & (np.maximum(x - top, bottom - x) > OUT * beside)
    if lone.any():
        steps = label(beside >= 0.5 * beside[lone].min())[1]
        lone &= label(lone)[1] <= OFTEN * steps
    far: NDArray[np.bool_] = lone | ((apart > least) & (apart > APART * beside))
    return far if far.mean() <= SELDOM else np.zeros(len(x), dtype=bool)


def checked(series: Series) -> None:
    """Refuse a series whose columns differ in length or hold values that are not finite."""
    columns = {
        "q": series.q,
        "force": series.force,
        **series.covariates,
        **series.extra,
        **({} if series.velocity is None else {"velocity": series.velocity}),
        **({} if series.taken is None else {"taken": series.taken}),
    }
    where = f" of {series.channel}" if series.channel else ""
    if np.ndim(series.t) != 1 or not np.isfinite(series.t).all():
        raise InputError(f"the times{where} must be a column of finite numbers [s].")
    for name, column in columns.items():
        if np.shape(column) != np.shape(series.t):
            raise InputError(
                f"the column {name}{where} must have as many values as there are times"
                f" ({len(series.t)}), got shape {np.shape(column)}."
            )
        missing = int((~np.isfinite(column)).sum())
        if missing:
            values = "1 value that is" if missing == 1 else f"{missing} values that are"
            raise InputError(
                f"the column {name}{where} has {values} not finite: leave out such samples."
            )


def _picked(series: Series, rows: NDArray[np.intp]) -> Series:
    """Return some samples of a series."""
    return _mapped(series, np.asarray(series.t, float)[rows], lambda x: np.asarray(x, float)[rows])


def even(series: Series) -> Series:
    """Return a piece on an even grid of its usual step, by straight lines."""
    t = series.t
    step = float(np.median(np.diff(t)))
    grid = t[0] + step * np.arange(round((t[-1] - t[0]) / step) + 1)
    return _mapped(series, grid, lambda x: np.interp(grid, t, x))


def _mapped(series: Series, t: Array, moved: Any) -> Series:
    """Return a series at other times, with what `moved` makes of each column."""
    return replace(
        series,
        t=t,
        q=moved(series.q),
        force=moved(series.force),
        taken=None if series.taken is None else moved(series.taken),
        velocity=None if series.velocity is None else moved(series.velocity),
        covariates={name: moved(x) for name, x in series.covariates.items()},
        extra={name: moved(x) for name, x in series.extra.items()},
    )
