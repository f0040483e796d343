"""One travel fixes one number: the value that gives exactly that travel, and its range."""

import math
from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np

from stickslip import formatting
from stickslip.errors import ConvergenceError
from stickslip.formatting import number
from stickslip.friction import FrictionLaw
from stickslip.identification.estimation.root_search import NEAR, positive_root, positive_roots
from stickslip.identification.results import Estimate
from stickslip.identification.travels.model import TravelModel, Trial, standard_errors
from stickslip.identification.travels.propagation import covariance_of, propagated
from stickslip.identification.travels.result import TravelFit
from stickslip.quantities import Quantity, fields_of, parameters

INTERVALS = {"rounding": "rounding range", "interval": "stated interval", "standard": "95 %"}
"""What the interval of an estimate is called, by the kind of uncertainty of the reading."""
NORMAL_95 = 1.959963984540054
STEP = 1e-4
"""Step of a finite difference over the value; see `least_squares`."""


def fit_one(model: TravelModel, trial: Trial) -> TravelFit:
    """Find the value of the one free parameter that gives the travel, and those at its ends."""
    (path,) = model.free
    known = {name: (field, value) for name, field, value in parameters(model.law, "friction")}
    field, start = known[path]
    low, high = room_for(model.law, path.rpartition(".")[2])

    def miss(travel: float) -> Callable[[float], float]:
        return lambda value: model.travel(trial, [value]) - travel

    found = positive_roots(miss(trial.travel), start or 1.0, low=low, high=high)
    if not found:
        room = (
            f"above {number(low)}"
            if math.isinf(high)
            else (f"between {number(low)} and {number(high)}")
        )
        said = (
            f"no value of {path} ({field.symbol}) {room} gives a travel of {number(trial.travel)}"
            f" m; with {number(start)} the travel is"
            f" {formatting.quantity(model.travel(trial, [start]), 'm', 4)}."
        )
        try:
            model.check_rest([trial], [start], standard_errors([trial])[0])
        except ConvergenceError as error:
            said += f" With that value {error}"
        raise ConvergenceError(said)
    best, *others = found
    half_width, kind, sources = trial.half_width, trial.kind, {}
    doubts = propagated(model, [trial], [best])
    errors, stated = standard_errors([trial])
    if stated and (doubts.own or doubts.shared):
        # a range that readings cannot leave joins standard errors as one of them
        total = covariance_of(doubts.scatter(errors), doubts.shared)
        half_width, kind = math.sqrt(float(total[0, 0])), "standard"
        slope = model.travel(trial, [best * (1.0 + STEP)]) - model.travel(trial, [best])
        (sources,) = doubts.sources(errors, np.array([[STEP * best / slope]]))
    spread = half_width * (NORMAL_95 if kind == "standard" else 1.0)
    ends = [
        positive_root(miss(trial.travel + side * spread), best, low=low, high=high, reach=NEAR)
        for side in (-1.0, 1.0)
    ]
    one = _estimate(path, field, best, ends if spread else [], kind)
    return TravelFit(
        law=model.with_values([best]),
        mechanism=trial.mechanism,
        estimates=(replace(one, sources=sources),),
        measured=(trial.travel,),
        predicted=(model.travel(trial, [best]),),
        runs=model.runs,
        others=tuple(others),
        trials=(trial,),
    )


def _estimate(
    path: str, quantity: Quantity, best: float, ends: list[float | None], kind: str
) -> Estimate:
    found = sorted(end for end in ends if end is not None)
    low = found[0] if found and found[0] <= best else -math.inf
    high = found[-1] if found and found[-1] >= best else math.inf
    reason = ""
    if not ends:
        reason = "no uncertainty of the reading was stated"
    elif not (math.isfinite(low) and math.isfinite(high)):
        reason = "no value gives the travel at one end of the range of the reading"
    return Estimate(
        path=path,
        quantity=quantity,
        value=best,
        low=low,
        high=high,
        interval=INTERVALS[kind],
        reason=reason,
    )


def room_for(law: FrictionLaw, name: str, free: Collection[str] = ()) -> tuple[float, float]:
    """Return the values a parameter may take while all that are not free stay as they are."""
    quantities = fields_of(type(law))
    quantity = quantities[name]
    low, high = max(quantity.low, quantity.above or 0.0, 0.0), quantity.high
    if quantity.at_least is not None:
        low = max(low, getattr(law, quantity.at_least))
    for other, bound in quantities.items():
        if f"friction.{other}" in free:
            continue
        if bound.at_least == name and getattr(law, other) is not None:
            high = min(high, getattr(law, other))
    return low, high
