"""Other speeds of the pull, at which fitted laws would part."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stickslip.identification import COMPARED, STEADY, FeatureFit, cycle_features, towed_load
from stickslip.selection.feature_verdict import FeatureCandidate, OtherSpeed

FACTORS = (0.1, 0.25, 0.5, 2.0, 4.0)
"""Speeds that are tried, over that of the record."""
SHOWN = 3
"""Of these the most telling are kept."""


def other_speeds(
    best: FeatureCandidate, rivals: Sequence[FeatureCandidate]
) -> tuple[OtherSpeed, ...]:
    """Return what the best law and its rivals predict at other speeds, the most telling first.

    A speed at which any of them does not settle within some cycles is left out.
    """
    if best.fit is None or not rivals:
        return ()
    found = []
    for factor in FACTORS:
        predicted = {one.name: _at(one.fit, factor) for one in [best, *rivals] if one.fit}
        if any(math.isnan(value) for row in predicted.values() for value in row.values()):
            continue
        apart = min(_apart(predicted[best.name], predicted[one.name]) for one in rivals)
        found.append(
            OtherSpeed(
                speed=factor * best.fit.mechanism.speed, predicted=predicted, separation=apart
            )
        )
    return tuple(sorted(found, key=lambda one: -one.separation)[:SHOWN])


def _at(fit: FeatureFit, factor: float) -> dict[str, float]:
    """Return the features of the limit cycle at another speed; steady sliding has frequency 0."""
    block = replace(fit.mechanism, speed=factor * fit.mechanism.speed)
    natural = 2.0 * math.pi * math.sqrt(block.mass / block.stiffness)
    # sticking lasts as long as the spring takes to fall by twice its swing: longer if slower
    sticking = 4.0 * fit.observed.standard_deviation * towed_load(block)
    period = natural + sticking / (block.stiffness * block.speed)
    (row,) = cycle_features(
        block,
        fit.law,
        ("mechanism.speed",),
        np.array([[block.speed]]),
        period=period,
        level=fit.observed.mean,
    )
    found = dict(zip(COMPARED, map(float, row), strict=True))
    if found["standard_deviation"] < STEADY * abs(found["mean"]):
        found["frequency"] = 0.0
    return found


def _apart(one: dict[str, float], other: dict[str, float]) -> float:
    """Return the root mean square difference of features, each over the mean of both."""
    gaps = []
    for name in COMPARED:
        size = 0.5 * (abs(one[name]) + abs(other[name]))
        gaps.append((one[name] - other[name]) / size if size > 0.0 else 0.0)
    return float(np.sqrt(np.mean(np.square(gaps))))
