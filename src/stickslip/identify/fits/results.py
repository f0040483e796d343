"""What a fit gives back, and what it finds wrong with the model."""

import html
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import TypeVar

from stickslip.data import LawEstimates, Levels, levels_at, rig_toml, spread_of
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, Laws, RateState
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, full_path, parameters
from stickslip.show.described import Described
from stickslip.show.display import OnAxes, Summary, Tabular
from stickslip.show.documents import write_file
from stickslip.show.formatting import (
    EstimateText,
    estimate_text,
    interval,
    is_skewed,
    joined,
    number,
    parameter_words,
    printable,
    with_unit,
    within,
)

if TYPE_CHECKING:
    import pandas as pd

    from stickslip.show.display import Drawing, Target

Array: TypeAlias = NDArray[np.float64]

Law_co = TypeVar("Law_co", bound=FrictionLaw, default=FrictionLaw, covariant=True)
"""What type of law was fitted, as far as a type checker can know."""
AnyLaw_co = TypeVar(
    "AnyLaw_co", bound=FrictionLaw | Laws | RateState, default=FrictionLaw, covariant=True
)
"""The same, of laws that are not simulated too."""
READINGS = "readings"
"""What the readings themselves are called among the sources of an estimate's uncertainty."""
FRICTION = "friction."
FORCES = ("N", "N m")
"""Units of levels where no normal force is known."""
DRY = 2.0
"""Coefficient of friction above which hardly any dry contact lies."""


@dataclass(frozen=True, kw_only=True)
class Estimate(metaclass=Described):
    """One fitted parameter with its doubt."""

    path: str
    """Parameter path, such as ``"friction.kinetic_coefficient"``."""
    quantity: Quantity
    """Symbol and unit."""
    value: float
    """Best value."""
    low: float
    """Lower end of the interval; minus infinity where the data do not bound it."""
    high: float
    """Upper end; infinity where the data do not bound it."""
    interval: str
    """What the interval is, such as ``"95 %"``."""
    reason: str = ""
    """Why an end is infinite, in words."""
    sources: Mapping[str, float] = field(default_factory=dict)
    """Standard errors by where they come from: ``"readings"``, and parameters of the mechanism by
    path; empty where no uncertainty of the mechanism was stated."""

    @property
    def words(self) -> str:
        """The name in words: a level is a coefficient only over a normal force."""
        words = parameter_words(self.path)
        if self.quantity.unit not in FORCES:
            return words
        friction = "friction" if self.quantity.unit == "N" else "friction torque"
        return words.replace("kinetic coefficient", f"Coulomb {friction}").replace(
            "coefficient", friction
        )

    @property
    def bounded(self) -> bool:
        """Whether the data bound the parameter on both sides."""
        return math.isfinite(self.low) and math.isfinite(self.high)

    @property
    def known(self) -> bool:
        """Whether the data bound the parameter on any side."""
        return math.isfinite(self.low) or math.isfinite(self.high)

    @property
    def half_width(self) -> float:
        """Half the width of the interval; infinite where an end is open."""
        return 0.5 * (self.high - self.low) if self.bounded else math.inf

    @property
    def parts(self) -> EstimateText:
        """Value and doubt as two texts without the unit; "not bounded" for an open end.

        The doubt is half the width of the interval, or where it is skewed its ends.
        """
        if is_skewed(self.value, self.low, self.high):
            return EstimateText(within(self.value, self.low, self.high), f"({self.range})")
        if self.bounded:
            return estimate_text(self.value, self.half_width)
        return EstimateText(within(self.value, self.low, self.high), "not bounded")

    @property
    def plus_minus(self) -> str:
        """Value, doubt and unit in words, such as ``158 ± 4 N s/m``."""
        value, doubt = self.parts
        if not self.bounded:
            return f"{with_unit(value, self.quantity.unit)}, {doubt}"
        return with_unit(f"{value} {doubt}".strip(), self.quantity.unit)

    @property
    def range(self) -> str:
        """The interval in words."""
        return interval(self.low, self.high)

    def __str__(self) -> str:
        """Return symbol, value and interval, such as ``mu_k = 0.255 (0.249 to 0.261)``."""
        value = with_unit(within(self.value, self.low, self.high), self.quantity.unit)
        return f"{self.quantity.symbol} = {value} ({self.range})"

    def __repr__(self) -> str:
        return f"<Estimate {self}, {self.interval}>"

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(str(self))}, {html.escape(self.interval)}</p>"

    def to_dict(self) -> Mapping[str, Any]:
        """Return the estimate as plain numbers and strings; None where an end is infinite."""
        return {
            "parameter": self.path,
            "symbol": self.quantity.symbol,
            "unit": self.quantity.unit,
            "value": self.value,
            "low": self.low if math.isfinite(self.low) else None,
            "high": self.high if math.isfinite(self.high) else None,
            "interval": self.interval,
            "reason": self.reason,
            **({"standard_error_from": dict(self.sources)} if self.sources else {}),
        }


@dataclass(frozen=True, kw_only=True)
class Fit(OnAxes, Tabular, ABC, Generic[AnyLaw_co]):
    """A law whose free parameters make a mechanism behave as measured."""

    law: AnyLaw_co
    """The law with its fitted parameters."""
    mechanism: Mechanism
    """The mechanism: as measured first, with what was fitted of it."""
    estimates: tuple[Estimate, ...]
    """The free parameters."""
    remarks: tuple[str, ...] = ()
    """What is to be known of the mechanism as it is saved, in sentences."""
    cancelled: bool = False
    """Whether the search was ended before its end."""

    @final
    @property
    def shown(self) -> tuple[Estimate, ...]:
        """The estimates that reports list: all but those of nuisances."""
        return tuple(item for item in self.estimates if not item.quantity.nuisance)

    @final
    def estimate(self, name: str) -> Estimate:
        """Return the estimate of a parameter, by its path or its last name."""
        known = {estimate.path: estimate for estimate in self.estimates}
        return known[full_path(name, {path: item.quantity for path, item in known.items()})]

    @final
    def to_toml(self) -> str:
        """Return mechanism, law and estimates as the text of a rig file, which `load_rig` reads.

        Raises
        ------
        InputError
            If the law is none that a rig file can have: rate-and-state friction.
        """
        if isinstance(self.law, RateState):
            raise InputError(
                f"{self.law.title.lower()} is no law of a rig file: the logarithm of the speed"
                " knows no rest, so `simulate` cannot run it. `to_dict()` has its numbers, and"
                " `simulate_velocity_steps` runs it."
            )
        title = "Laws by contact" if isinstance(self.law, Laws) else self.law.title
        text = rig_toml(
            self.mechanism, self.law, title=f"{title}, fitted", estimates=self.law_estimates()
        )
        said = list(self.remarks)
        if self.settings > 1:
            said.append(f"The mechanism is that of the first of {self.settings} settings.")
        return "".join(f"# {printable(remark)}\n" for remark in said) + text

    @final
    def save(self, path: str | Path) -> None:
        """Write `to_toml` to a file that ``stickslip simulate`` takes."""
        write_file(Path(path), self.to_toml())

    @abstractmethod
    def law_estimates(self) -> LawEstimates:
        """Return how well the law is known: intervals, covariance, and what was not fitted."""

    @property
    def rig_uncertainties(self) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """The mechanism of each trial, and what is stated of it: standard errors by path."""
        return ()

    @property
    def settings(self) -> int:
        """In how many settings the mechanism was measured."""
        return 1

    @property
    def readings(self) -> str:
        """What was measured, as the subject of a sentence."""
        return "the record"

    @property
    def sentences(self) -> tuple[str, ...]:
        """What the measurement does not tell, in sentences."""
        return ()

    def _plot(self, ax: "Target") -> "Drawing":
        """Draw the fit beside what was measured; a class of fits without a plot says so."""
        raise InputError(
            f"there is no plot for a {type(self).__name__}: its class has no method `_plot`."
        )

    def __repr__(self) -> str:
        return f"<Fit: {self}>"

    @final
    def to_dataframe(self) -> "pd.DataFrame":
        """Return the estimates as a pandas DataFrame, a row each.

        Its columns are ``parameter``, ``symbol``, ``unit``, ``value``, ``low``, ``high``,
        ``interval`` and ``reason``; an end that the data do not bound is infinite.
        """
        import pandas as pd

        rows = [{**e.to_dict(), "low": e.low, "high": e.high} for e in self.estimates]
        columns = ["parameter", "symbol", "unit", "value", "low", "high", "interval", "reason"]
        return pd.DataFrame(rows, columns=columns)

    def _over(self) -> str:
        return "parameter"

    @final
    def _summary(self) -> Summary:
        """Return the law with its estimates, and what the data cannot tell."""
        rows = [
            (
                e.words,
                e.quantity.symbol,
                within(e.value, e.low, e.high),
                "" if e.quantity.unit == "1" else e.quantity.unit,
                e.range,
                e.interval,
            )
            for e in self.shown
        ]
        head = ("parameter", "symbol", "value", "unit", "range", "interval")
        return Summary(
            sentence=str(self).partition("\n")[0], head=head, rows=rows, notes=self.sentences
        )

    def to_dict(self) -> Mapping[str, Any]:
        """Return the fit as plain numbers and strings."""
        return {"law": self.law.name, "estimates": [item.to_dict() for item in self.estimates]}


def far_above_dry(fit: Fit) -> tuple[str, ...]:
    """Return that a fitted coefficient of friction is larger than dry contacts have, if it is.

    Examples
    --------
    >>> import stickslip
    >>> rig = stickslip.SpringBlock(mass=0.82e-3, stiffness=145.0, compression=0.06)  # 0.82 g
    >>> far_above_dry(stickslip.fit(rig, "coulomb", stickslip.Measurement(travel=0.105)))
    ('$mu_k$ = 309 is far above what dry contacts have (below about 2): check ...',)
    """
    if levels_at(fit.mechanism) != "per load":
        return ()
    result = [
        e
        for e in fit.estimates
        if e.path.startswith(FRICTION) and e.quantity.symbol.startswith("mu_") and e.value > DRY
    ]
    if not result:
        return ()
    said = joined([f"${e.quantity.symbol}$ = {number(e.value)}" for e in result])
    are = "is" if len(result) == 1 else "are"
    return (
        f"{said} {are} far above what dry contacts have (below about {number(DRY)}): check the"
        " units of mass, stiffness and travels or forces.",
    )


def estimates_for(
    law: FrictionLaw | Laws | RateState,
    estimates: Sequence[Estimate],
    correlation: ArrayLike,
    *,
    levels: Levels,
    largest_speed: float | Mapping[str, float] | None,
) -> LawEstimates:
    """Return what estimates say of a law; those of the mechanism are left out.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> level = Estimate(
    ...     path="friction.kinetic_coefficient",
    ...     quantity=Quantity("mu_k"),
    ...     value=0.25,
    ...     low=0.24,
    ...     high=0.26,
    ...     interval="95 %",
    ... )
    >>> law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.3)
    >>> found = estimates_for(law, [level], [[1.0]], levels="per load", largest_speed=None)
    >>> found.intervals, found.not_fitted
    ({'kinetic_coefficient': (0.24, 0.26)}, ('static_coefficient',))
    """
    own = {e.path: e for e in estimates if e.path.startswith(FRICTION)}
    told = [i for i, e in enumerate(estimates) if e.path in own and e.known]
    names = {i: e.path.removeprefix(FRICTION) for i, e in enumerate(estimates) if i in told}
    shown = [estimates[i] for i in told]
    # of what has one end, that is the spread: it keeps what moves together so
    spreads = np.array([spread_of(e.value, *_both_ends(e)) for e in shown])
    table = np.asarray(correlation)[np.ix_(told, told)] * np.outer(spreads, spreads)
    table = 0.5 * (table + table.T)
    paths = [path for path, _, _ in parameters(law, "friction")]
    return LawEstimates(
        law=law.names if isinstance(law, Laws) else law.name,
        intervals={
            name: _around(estimates[i]) for i, name in names.items() if estimates[i].bounded
        },
        covariance_of=tuple(names.values()),
        covariance=tuple(map(tuple, table.tolist())),
        not_identified={
            path.removeprefix(FRICTION): e.reason or "the data do not bound it"
            for path, e in own.items()
            if not e.bounded and path in paths
        },
        not_fitted=tuple(path.removeprefix(FRICTION) for path in paths if path not in own),
        levels=levels,
        largest_speed=largest_speed,
    )


def _both_ends(one: Estimate) -> tuple[float, float]:
    """Return an interval, the other end as far off as that which it has."""
    low = one.low if math.isfinite(one.low) else 2.0 * one.value - one.high
    high = one.high if math.isfinite(one.high) else 2.0 * one.value - one.low
    return low, high


def _around(one: Estimate) -> tuple[float, float]:
    """Return an interval that has its value inside: an end may be a rounding error off."""
    return float(min(one.low, one.value)), float(max(one.high, one.value))
