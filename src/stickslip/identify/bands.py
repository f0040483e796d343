"""What verdicts state of draws and runs: bands, intervals of parameters, certificates."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip.show.described import Described
from stickslip.show.display import Tabular
from stickslip.show.formatting import percent, quantity

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
LEVEL = 0.95
"""Probability of a band, and of an interval."""
ENDS = (0.5 * (1.0 - LEVEL), 0.5 * (1.0 + LEVEL))
"""Quantiles of draws between which an interval lies."""
BY_CHANCE = 0.025
"""Probability of so few readings in a band below which a second measurement differs: of 960 second
tables of 6 and 12 readings with the friction of the first, 39 were said to (with .05 63, as the
first has few readings too)."""
ALIKE = 0.02
"""Difference of logarithms up to which speeds, or loads, are the same."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PredictionBand:
    """Limits of curves at rows (n,).

    Parameters
    ----------
    low : array (n,)
        Lower limits [N] or [N m].
    median : array (n,)
        Medians.
    high : array (n,)
        Upper limits.
    """

    low: Array
    median: Array
    high: Array

    def brakes(self, velocity: Array) -> bool:
        """Return whether friction acts against the motion throughout the band."""
        return bool(np.all(np.where(velocity > 0.0, self.low, -self.high) > 0.0))

    def to_dict(self) -> dict[str, list[float]]:
        """Return limits and medians as lists."""
        return {name: x.tolist() for name, x in vars(self).items()}


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Foreseen(Tabular):
    """Readings of another measurement beside their band: what was measured, and what was foreseen.

    Of records these are the rows of the balance: the force that the law, the inertia and all else
    take. Of free motions they are positions or velocities.
    """

    measured: Array
    """Readings (n,), in the unit."""
    band: PredictionBand
    """Their band: 95 % of readings lie in it if the other run differs as runs do."""
    usual: Array
    """What Coulomb + viscous friction by least squares foresees (n,); NaN of free motions."""
    velocity: Array
    """Velocities (n,) [m/s] or [rad/s]; NaN of free motions."""
    unit: str
    """SI unit."""
    chance: float
    """Probability that as few readings lie in the band, or fewer, as errors that readings share
    have it: that of a binomial distribution of the effective number."""

    @property
    def differs(self) -> bool:
        """Whether it differs by more than the first measurement shows: wrong in 1 of 20 at most."""
        return self.chance < BY_CHANCE

    @property
    def inside(self) -> float:
        """Share of the readings in the band."""
        return float(np.mean((self.band.low <= self.measured) & (self.measured <= self.band.high)))

    @property
    def error(self) -> float:
        """Root mean square of the readings less the middle of the band."""
        return math.sqrt(float(np.mean((self.measured - self.band.median) ** 2)))

    @property
    def usual_error(self) -> float:
        """The same of Coulomb + viscous friction by least squares; NaN of free motions."""
        return math.sqrt(float(np.mean((self.measured - self.usual) ** 2)))

    def __repr__(self) -> str:
        return f"<Foreseen: {self}>"

    def __str__(self) -> str:
        """Return how many readings lie in the band, and the error, in words."""
        inside = f"{percent(self.inside)} of the {len(self.measured):,} readings lie in the band"
        error = f"error {quantity(self.error, self.unit, 2)}"
        if math.isfinite(self.usual_error):
            error += f" ({quantity(self.usual_error, self.unit, 2)} with Coulomb + viscous)"
        return f"{inside}; {error}"

    def to_dataframe(self) -> "pd.DataFrame":
        """Return velocity, reading, low, median, high and usual as columns of a DataFrame."""
        import pandas as pd

        own = {"velocity": self.velocity, "measured": self.measured}
        return pd.DataFrame({**own, **vars(self.band), "usual": self.usual})


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredPoints:
    """Friction as it was measured, for a figure."""

    velocity: Array
    """Velocities (n,) [m/s]."""
    friction: Array
    """Friction (n,) [N], less what stands beside it."""
    load: Array
    """Loads (n,) [N]."""
    weights: Array
    """How much each counts (n,)."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """What a measurement says of a parameter."""

    path: str
    """Full path, such as ``"friction.kinetic_coefficient"``; of nuisances their name."""
    value: float
    """Estimate under the named law."""
    low: float
    high: float
    """95 % interval under the named law."""
    low_any: float
    high_any: float
    """95 % interval over the laws of the set that have the parameter."""

    def to_dict(self) -> dict[str, float | str]:
        """Return path and numbers as a verdict writes them."""
        numbers = dict(vars(self))
        return {"parameter": numbers.pop("path"), **numbers}


def quantile_band(
    curves: Array, level: float = LEVEL, *, all_along: bool = False, wider: float = 1.0
) -> PredictionBand:
    """Return quantiles of curves (d, n): point by point, or so that they hold all along.

    Those that hold all along are wider by a factor.

    Examples
    --------
    >>> curves = np.linspace(0.0, 1.0, 101)[:, None] * np.array([1.0, 2.0])
    >>> quantile_band(curves, 0.9).high.round(2).tolist()
    [0.95, 1.9]
    """
    low, median, high = np.quantile(curves, (0.5 - 0.5 * level, 0.5, 0.5 + 0.5 * level), axis=0)
    if all_along:
        above = (curves - median) / (high - median + 1e-300)
        below = (median - curves) / (median - low + 1e-300)
        times = wider * float(np.quantile(np.max(np.maximum(above, below), axis=1), level))
        low, high = median - times * (median - low), median + times * (high - median)
    return PredictionBand(low=low, median=median, high=high)


def correlation_of(values: Array) -> Array:
    """Return the correlation (p, p) of draws of parameters (p, d); 0 of those that are constant."""
    spread = np.std(values, axis=1)
    centred = values - values.mean(axis=1, keepdims=True)
    centred = centred / np.where(spread > 0.0, spread, 1.0)[:, None]
    return np.asarray(centred @ centred.T / values.shape[1])


# A run of what a verdict hands over (`stickslip.identify.certificate`).

FOLLOWED = 0.1
"""Error of a run, over the spread of the motion, up to which it follows."""
MISSING = 3.0
"""Error of the run of a free motion, over that of a reading, from which something is missing."""
BEATEN = 1.25
"""Error over that of plain friction, and over that expected, from which plain is better."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Stretch:
    """A part of the record that was run."""

    time: Array
    """Times (n,) [s]."""
    measured: Array
    """Measured and smoothed positions (n,) [m] or [rad]; velocities where none were measured."""
    simulated: Array
    """The same with the law and mechanism handed over (n,)."""
    plain: Array
    """The same with Coulomb + viscous friction by least squares (n,)."""


@dataclass(frozen=True, kw_only=True)
class RunCertificate(metaclass=Described):
    """How closely a run of the law and mechanism of a verdict follows the measured motion."""

    run_error: float
    """Error of the run, over the spread of the position in a stretch [1]; infinite if it fails."""
    plain_error: float
    """The same of Coulomb + viscous friction by least squares [1]."""
    expected_error: float
    """95 % quantile of the error that the posterior expects [1]; NaN without draws."""
    friction_work: float
    """Share of the work that the named friction takes [1]: 1 where only friction takes energy."""
    duration: float
    """Length of a stretch that was run [s]; of a motion run from its start all of it."""
    stretches: tuple[Stretch, ...] = field(repr=False, compare=False)
    """What was run."""
    motion: tuple[tuple[Array, Array], ...] = field(repr=False, compare=False)
    """Times [s] and smoothed positions [m] or [rad] of each piece of the records."""
    how: str = "Run with the recorded force"
    """How it was run, in words."""
    compared: str = "position"
    """What was compared: position or velocity."""
    reading_error: float = math.nan
    """Error of a reading of a free motion, over the spread of the motion [1]."""

    @property
    def is_whole(self) -> bool:
        """Whether each motion was run from its start to its end."""
        return len(self.stretches) == len(self.motion)

    @property
    def typical(self) -> Stretch:
        """A stretch whose run is neither among the best nor among the worst."""
        squares = [float(np.mean((x.simulated - x.measured) ** 2)) for x in self.stretches]
        return self.stretches[int(np.argsort(squares)[len(squares) // 2])]

    @property
    def is_beaten(self) -> bool:
        """Whether Coulomb + viscous friction follows better, beyond the doubt of the run.

        A doubt of more than `FOLLOWED` excuses no run: what is simulated with it is wrong.
        """
        known = max(self.plain_error, min(np.nan_to_num(self.expected_error), FOLLOWED))
        return bool(self.run_error > BEATEN * known)

    @property
    def is_incomplete(self) -> bool:
        """Whether the run of a free motion leaves more than readings are off."""
        return bool(self.run_error > MISSING * self.reading_error)

    @property
    def warning(self) -> str:
        """What to say first if the run does not follow as it should; empty if it does."""
        own = error_text(self.run_error)
        if not self.is_beaten:
            return self.is_incomplete * (
                f"! {self.how}, this law and mechanism follow the motion to {own}, and a reading"
                f" is off by {error_text(self.reading_error)}: something of the mechanism is"
                " missing, such as a spring or a cable, and the band does not allow for it."
            )
        return (
            f"! {self.how}, Coulomb + viscous friction by least squares follows the motion better"
            f" ({error_text(self.plain_error)} of its spread; this law and mechanism {own}): the"
            " curve holds for the measured force, do not simulate with it."
        )

    def __str__(self) -> str:
        """Return the certificate in a sentence."""
        work = ""
        if math.isfinite(self.friction_work):
            work = f"; friction takes {percent(self.friction_work)} of the work"
        return (
            f"{self.how}, this law and mechanism follow the motion to"
            f" {error_text(self.run_error)} over {quantity(self.duration, 's', 2)} (Coulomb +"
            f" viscous by least squares: {error_text(self.plain_error)}){work}."
        )

    def to_dict(self) -> Mapping[str, Any]:
        """Return the certificate as plain numbers; None for what is not known."""
        names = (
            "run_error", "plain_error", "expected_error", "reading_error", "friction_work",
            "duration",
        )  # fmt: skip
        values = {name: float(getattr(self, name)) for name in names}
        known = {name: x if math.isfinite(x) else None for name, x in values.items()}
        return {**known, "plain_is_better": bool(self.is_beaten)}


def error_text(error: float) -> str:
    """Return the error of a run, over the spread of the motion.

    Examples
    --------
    >>> error_text(0.0142), error_text(2.0), error_text(1e-6)
    ('1.4 %', 'more than 100 %', 'less than 0.1 %')
    """
    if error < 1e-3:
        return "less than 0.1 %"
    return percent(error) if error <= 1.0 else "more than 100 %"
