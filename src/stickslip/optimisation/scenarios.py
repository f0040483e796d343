"""The cases that a motion must stand: one, an interval of parameters, or samples of a law."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, final

import numpy as np
from numpy.typing import NDArray

from stickslip.described import Described
from stickslip.errors import InputError, ParameterError, not_whole
from stickslip.formatting import number, percent
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism
from stickslip.optimisation.cycle_metrics import motor_of
from stickslip.quantities import Quantity, full_path, parameters, vary

Array = NDArray[np.float64]

MOST_POINTS = 200
SHARE = Quantity("quantile", low=0, high=1)


@final
@dataclass(frozen=True, kw_only=True)
class Scenarios(metaclass=Described):
    """Laws, with changes to the mechanism, and what counts of them.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> two = tuple(Coulomb(kinetic_coefficient=mu) for mu in (0.2, 0.3))
    >>> cases = Scenarios(laws=two, changes=({}, {}), quantile=0.0, words="the worse of two")
    >>> cases.weights(np.array([3.0, 1.0])).tolist()
    [0.0, 1.0]
    """

    laws: tuple[FrictionLaw | Laws, ...]
    """A law for each scenario."""
    changes: tuple[Mapping[str, float], ...]
    """Values of the mechanism by path, for each scenario."""
    quantile: float | Literal["mean"]
    """Which quantile of the goal counts, 0 of which is the worst case; or that its mean does."""
    words: str
    """What they are, as reports say it."""

    def __len__(self) -> int:
        """Return the number of scenarios."""
        return len(self.laws)

    def weights(self, values: Array) -> Array:
        """Return what each value counts (n,): the quantile, or the mean, is their sum."""
        if self.quantile == "mean":
            return np.full(len(values), 1.0 / len(values))
        place = self.quantile * (len(values) - 1)
        low = int(place)
        found = np.zeros(len(values))
        order = np.argsort(values, kind="stable")
        found[order[low]] = 1.0 - (place - low)
        if place > low:
            found[order[low + 1]] = place - low
        return found


def scenarios_of(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    interval: Mapping[str, tuple[float, float]] | None,
    laws: Sequence[FrictionLaw | Laws] | None,
    quantile: float | Literal["mean"],
    points: int,
) -> Scenarios:
    """Return the scenarios that the arguments of `optimise_profile` stand for."""
    if interval and laws is not None:
        raise InputError("interval and scenarios are both given: leave one out.")
    if laws is not None:
        return _samples(laws, quantile)
    if interval:
        return _grid(mechanism, law, interval, points)
    return Scenarios(laws=(law,), changes=({},), quantile=0.0, words="the given law")


def _samples(laws: Sequence[FrictionLaw | Laws], quantile: float | Literal["mean"]) -> Scenarios:
    if not laws or not all(isinstance(law, FrictionLaw | Laws) for law in laws):
        raise InputError(f"scenarios must be friction laws, at least one, got {laws!r}.")
    share: float | Literal["mean"] = "mean"
    words = "the mean"
    if quantile != "mean":
        share = SHARE.check("optimise_profile", "quantile", quantile)
        words = f"the {percent(share)} quantile" if share else "the worst"
    return Scenarios(
        laws=tuple(laws),
        changes=({},) * len(laws),
        quantile=share,
        words=f"{words} of {len(laws)} laws",
    )


def _grid(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    interval: Mapping[str, tuple[float, float]],
    points: int,
) -> Scenarios:
    """Return evenly spread values of each parameter, ends included, in all combinations."""
    if type(points) is not int or points < 2:
        raise ParameterError(not_whole("points", 2, points))
    known = {
        path: quantity
        for root, prefix in ((mechanism, "mechanism"), (law, "friction"))
        for path, quantity, _ in parameters(root, prefix)
        if not path.startswith(f"mechanism.{motor_of(mechanism)}.")
    }
    axes = {full_path(path, known): _range(path, ends) for path, ends in interval.items()}
    if points ** len(axes) > MOST_POINTS:
        raise InputError(
            f"interval has {points}^{len(axes)} combinations; the limit is {MOST_POINTS}: give"
            " fewer points or fewer parameters."
        )
    rows = [
        dict(zip(axes, values, strict=True))
        for values in itertools.product(
            *(np.linspace(*ends, points).tolist() for ends in axes.values())
        )
    ]
    own = [{p: v for p, v in row.items() if p.startswith("mechanism.")} for row in rows]
    others = [{p: v for p, v in row.items() if p not in mine} for row, mine in zip(rows, own)]  # noqa: B905  # made of each other
    ranges = ", ".join(
        f"{path} {number(low)} to {number(high)}" for path, (low, high) in axes.items()
    )
    return Scenarios(
        laws=tuple(vary(law, "friction", row) if row else law for row in others),
        changes=tuple(own),
        quantile=0.0,
        words=f"the worst of {len(rows)} evenly spaced points of {ranges}",
    )


def _range(path: str, ends: object) -> tuple[float, float]:
    """Return the ends of an interval, checked."""
    try:
        low, high = (float(end) for end in ends)  # type: ignore[attr-defined]  # whatever was given
    except (TypeError, ValueError):
        raise InputError(f"interval[{path!r}] must be (low, high), got {ends!r}.") from None
    if not low < high:
        raise InputError(f"interval[{path!r}] must increase, got {low:g} to {high:g}.")
    return low, high
