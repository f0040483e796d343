"""A fit to travels."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import LawEstimates, Rig, levels_at
from stickslip.engine.simulation import simulate
from stickslip.friction import FrictionLaw
from stickslip.identify.fits import Fit, Law_co, Trial, estimates_for, is_rig
from stickslip.mechanisms import Mechanism, slip_of
from stickslip.show.formatting import number, quantity

if TYPE_CHECKING:
    from stickslip.show.display import Drawing, Target

Array: TypeAlias = NDArray[np.float64]

T_END = Rig.t_end
"""Time after which a body counts as stopped [s]."""
SAMPLES = 2001


def unit_of(unit: str) -> tuple[str, float]:
    """Return the unit that settings are read in, and its numbers over those in SI.

    Examples
    --------
    >>> unit_of("m"), unit_of("N"), unit_of("rad")[0]
    (('mm', 1000.0), ('N', 1.0), '°')
    """
    return {"m": ("mm", 1e3), "rad": ("°", math.degrees(1.0))}.get(unit, (unit, 1.0))


def rounded_setting(value: float, unit: str) -> float:
    """Return a setting [SI] with three digits in the unit that it is read in.

    Examples
    --------
    >>> rounded_setting(0.0123456, "m"), math.degrees(rounded_setting(0.314, "rad"))
    (0.0123, 18.0)
    """
    _, factor = unit_of(unit)
    return float(f"{factor * value:.3g}") / factor


def words_of(path: str) -> str:
    """Return what a parameter of the mechanism is called.

    Examples
    --------
    >>> words_of("mechanism.compression"), words_of("mechanism.drive.drive.frequency")
    ('compression', 'drive frequency')
    """
    words = path.removeprefix("mechanism.").replace(".", " ").replace("_", " ").split()
    return " ".join(dict.fromkeys(words))  # a drive of a motor is its drive


def setting_text(value: float, unit: str) -> str:
    """Return a setting [SI] with its unit, lengths in millimetres and angles in degrees.

    Examples
    --------
    >>> setting_text(0.1, "m"), setting_text(math.radians(5.0), "rad")
    ('100 mm', '5°')
    """
    shown, factor = unit_of(unit)
    return f"{number(factor * value, 6)} {shown}".replace(" °", "°")


def _largest_speed(trial: Trial, law: FrictionLaw) -> float:
    """Return the largest slip speed of a run that a travel was measured of [m/s]."""
    mechanism = trial.mechanism
    slip = slip_of(mechanism)
    run = simulate(mechanism, law, t_end=T_END, y0=trial.start(law), throw=False)
    seen = run.at(np.union1d(np.linspace(*run.span, SAMPLES), run.t))
    return float(np.abs(seen[mechanism.rates[mechanism.coordinates.index(slip)]]).max())


@dataclass(frozen=True, kw_only=True, repr=False)
class TravelFit(Fit[Law_co]):
    """A fit to travels.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, fit
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> result = fit(rig, Coulomb, reading)
    >>> print(result.estimates[0])
    mu_k = 0.255 (0.243 to 0.271)
    """

    measured: tuple[float, ...]
    """Travels [m], one a trial."""
    predicted: tuple[float, ...]
    """Travels of the fitted law [m]."""
    runs: int
    """Simulations spent."""
    standard_errors: tuple[float, ...]
    """Standard errors of the travels [m]: as stated, or as the travels show about the law."""
    stated: bool = True
    """Whether an uncertainty of the travels was stated."""
    misfit: bool = False
    """Whether the travels are far from the law, for what was stated."""
    correlation: tuple[tuple[float, ...], ...] = ((1.0,),)
    """Of the estimates (p, p); 0 with what the travels do not tell."""
    trials: tuple[Trial, ...] = ()
    """What was fitted."""

    @property
    def rig_uncertainties(self) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        return [(one.mechanism, {**one.shared, **one.doubts}) for one in self.trials]

    @property
    def settings(self) -> int:
        return len({trial.mechanism for trial in self.trials})

    @property
    def readings(self) -> str:
        return "the readings" if len(self.trials) > 1 else "the reading"

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.show.plots import INTERVAL_SIZE, Interval, draw_intervals, on_axes

        pairs = enumerate(zip(self.residuals, self.standard_errors, strict=True), 1)
        rows = [Interval(f"trial {i}", 1e3 * value, 1e3 * error) for i, (value, error) in pairs]
        draw = draw_intervals(rows, "measured minus predicted travel", "mm")
        return on_axes(draw, ax, INTERVAL_SIZE)

    def law_estimates(self) -> LawEstimates:
        settings = {trial.setting: trial for trial in self.trials}.values()
        speeds = [_largest_speed(trial, self.law) for trial in settings]
        return estimates_for(
            self.law,
            self.estimates,
            self.correlation,
            levels=levels_at(self.mechanism),
            largest_speed=max(speeds, default=None),
        )

    def __str__(self) -> str:
        """Return the law, its estimates and how far off it is, in one line."""
        count = len(self.measured)
        worst = max(abs(residual) for residual in self.residuals)
        return (
            f"{self.law.title} fitted to {count} travel{'s' if count > 1 else ''}:"
            f" {', '.join(map(str, self.estimates))}; largest residual {quantity(worst, 'm', 2)}"
        )

    def _notes(self) -> Sequence[str]:
        return (*self.remarks, *self.told_apart)

    @property
    def told_apart(self) -> tuple[str, ...]:
        """What the travels cannot tell: parameters without an interval, and a law far off."""
        said = [
            f"{e.quantity.symbol} is not identified: {e.reason}."
            for e in self.estimates
            if e.reason and is_rig(e.path)
        ]
        if self.misfit:
            said.append(
                f"The readings differ from this fit by {quantity(self.scatter, 'm', 2)}, more than"
                " their stated uncertainty: the law or the mechanism is not that of the trials."
            )
        return tuple(said)

    @property
    def scatter(self) -> float:
        """Root mean square of the residuals [m]."""
        return math.sqrt(sum(one**2 for one in self.residuals) / len(self.residuals))

    @property
    def residuals(self) -> tuple[float, ...]:
        """Measured less predicted travel [m], one a trial."""
        return tuple(m - p for m, p in zip(self.measured, self.predicted, strict=True))

    @property
    def freedom(self) -> int:
        """Number of readings less number of fitted parameters."""
        return len(self.measured) - len(self.estimates)

    @property
    def standardised(self) -> tuple[float, ...]:
        """Residuals over the standard errors of the travels, one a trial."""
        return tuple(r / e for r, e in zip(self.residuals, self.standard_errors, strict=True))

    @property
    def chi_square(self) -> float:
        """Sum of the squares of `standardised`."""
        return sum(one**2 for one in self.standardised)

    def to_dict(self) -> Mapping[str, Any]:
        return {
            "law": self.law.name,
            "estimates": [estimate.to_dict() for estimate in self.estimates],
            "measured_travel": list(self.measured),
            "predicted_travel": list(self.predicted),
            "chi_square": self.chi_square if self.stated else None,
            "degrees_of_freedom": self.freedom,
            "runs": self.runs,
        }
