"""A law from elsewhere, fitted to a measurement too: its parameters beside those carried."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.data import LawEstimates, spread_of
from stickslip.data import unit_on as unit_of_law
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits import Estimate, Fit, RecordFit
from stickslip.quantities import parameters
from stickslip.show.described import Described
from stickslip.show.formatting import interval, number, quantity
from stickslip.show.formatting import within as value_within
from stickslip.study.sweep.validation import NOISY, Z95, Validation


@dataclass(frozen=True, kw_only=True)
class ParameterAgreement(metaclass=Described):
    """A parameter as it was carried here, and as a fit to the measurement finds it."""

    path: str
    """Path of the parameter, such as ``"friction.kinetic_coefficient"``."""
    symbol: str
    """Its symbol."""
    unit: str
    """Its SI unit on the mechanism."""
    carried: float
    """Value of the law from elsewhere."""
    low: float | None
    """Lower end of the interval of that; None if it has none."""
    high: float | None
    """Upper end."""
    refitted: Estimate
    """The same from the measurement."""
    standard_error: float | None
    """Of the difference; None where one of both has no interval."""

    @property
    def difference(self) -> float:
        """Refitted less carried."""
        return self.refitted.value - self.carried

    @property
    def agrees(self) -> bool | None:
        """Whether the difference is within 1.96 of its standard errors; None if that is unknown."""
        if self.standard_error is None:
            return None
        return abs(self.difference) <= Z95 * self.standard_error

    def __str__(self) -> str:
        """Return both values and whether they agree, in one line."""
        ends = (self.low, self.high)
        low, high = ends if None not in ends else (self.carried, self.carried)
        assert low is not None
        assert high is not None
        here = self.refitted
        unit = "" if self.unit == "1" else f" {self.unit}"
        own = f" ({interval(low, high)})" if self.low is not None else ", no interval"
        value = value_within(self.carried, low, high) if self.low is not None else number(low, 4)
        new = value_within(here.value, here.low, here.high) if here.bounded else number(here.value)
        both = (
            f"{self.symbol}: carried {value}{unit}{own}, refitted {new}{unit}"
            f" ({here.range if here.bounded else 'not bounded'})"
        )
        if self.agrees is None:
            reason = f" ({here.reason})" if here.reason else ""
            why = (
                f"this measurement does not determine it{reason}"
                if not here.bounded
                else "the carried value has no interval"
            )
            return f"{both}: cannot be compared, {why}"
        share = abs(self.difference) / self.standard_error if self.standard_error else math.inf
        apart = f"{number(abs(self.difference), 2)}{unit}, {number(share, 2)} standard errors"
        return f"{both}: {'agree' if self.agrees else 'do not agree'} (difference {apart})"

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers, ready for JSON."""
        return {
            "parameter": self.path,
            "symbol": self.symbol,
            "unit": self.unit,
            "carried": {"value": self.carried, "low": self.low, "high": self.high},
            "refitted": dict(self.refitted.to_dict()),
            "difference": self.difference,
            "standard_error_of_difference": self.standard_error,
            "agrees": self.agrees,
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Refit(metaclass=Described):
    """A law from elsewhere that was fitted to a measurement, too."""

    fit: Fit
    """The fit to the measurement."""
    parameters: tuple[ParameterAgreement, ...]
    """Its parameters beside those that were carried."""

    def explains(self, seen: Validation | None) -> bool | None:
        """Return whether the refitted law leaves no more than noise; None if that is unknown."""
        if seen is None or not isinstance(self.fit, RecordFit) or not seen.records:
            return None
        noise = math.sqrt(float(np.mean([record.noise**2 for record in seen.records])))
        return self.fit.rms <= NOISY * noise

    def sentences(self, seen: Validation | None) -> tuple[str, ...]:
        """Return each parameter beside what was carried, and what limits the comparison.

        Parameters
        ----------
        seen : Validation, optional
            The measurement beside the prediction, which knows the noise.

        Returns
        -------
        tuple of str
            Sentences.
        """
        said = [f"{parameter}." for parameter in self.parameters]
        if self.explains(seen) is False:
            assert isinstance(self.fit, RecordFit)
            left = quantity(self.fit.rms, self.fit.measurement.unit(self.fit.problem.quantity))
            said.append(
                f"The refitted law leaves a residual of {left}, which is more than the noise: it"
                " does not explain the record either, so that its values and intervals may be"
                " biased."
            )
        if seen is not None and any(record.late for record in seen.records):
            said.append(
                "The times of the record may be shifted (see above), which biases the refitted"
                " values."
            )
        if isinstance(self.fit, RecordFit):
            said += map(str, self.fit.model_errors)
        return tuple(said)

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers, ready for JSON."""
        return {
            "parameters": [parameter.to_dict() for parameter in self.parameters],
            "fit": dict(self.fit.to_dict()),
        }


def compare_estimates(
    law: FrictionLaw, estimates: LawEstimates | None, fit: Fit
) -> tuple[ParameterAgreement, ...]:
    """Compare the parameters of a law from elsewhere with those of a fit to a measurement.

    Parameters
    ----------
    law : FrictionLaw
        The law with its values.
    estimates : LawEstimates or None
        How well these are known.
    fit : Fit
        A fit of the same kind of law.

    Returns
    -------
    tuple of ParameterAgreement
        One for each parameter of the law that was fitted. Two values agree if their difference is
        within 1.96 of its standard errors, those of both intervals taken together as independent.

    Raises
    ------
    InputError
        If the laws are of different kinds.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, fit
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> law = Coulomb(kinetic_coefficient=0.30)
    >>> known = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.29, 0.31)})
    >>> here = fit(rig, Coulomb, Measurement(travel=0.20, uncertainty=0.001))
    >>> print(*compare_estimates(law, known, here))
    mu_k: carried 0.300 (0.290 to 0.310), refitted 0.2548 (0.2506 to 0.2605): do not agree (diff...
    """
    if not isinstance(fit.law, type(law)):
        raise InputError(
            f"compare_estimates takes a fit of {law.name}, got one of {fit.law.name}: fit that law."
        )
    values = {path: value for path, _, value in parameters(law, "friction")}
    found = []
    for estimate in fit.estimates:
        if estimate.path not in values:
            continue
        name = estimate.path.removeprefix("friction.")
        low, high = (
            (None, None) if estimates is None else estimates.intervals.get(name, (None, None))
        )
        error = None
        if estimates is not None and low is not None and high is not None and estimate.bounded:
            error = math.hypot(
                spread_of(values[estimate.path], low, high, estimates.interval),
                spread_of(estimate.value, estimate.low, estimate.high, estimate.interval),
            )
        found.append(
            ParameterAgreement(
                path=estimate.path,
                symbol=estimate.quantity.symbol,
                unit=unit_of_law(fit.mechanism, estimate.quantity),
                carried=values[estimate.path],
                low=low,
                high=high,
                refitted=estimate,
                standard_error=error,
            )
        )
    return tuple(found)
