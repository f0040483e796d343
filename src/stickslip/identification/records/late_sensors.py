"""Fits to measured friction whose sensor may show it late, or through a filter."""

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy

from stickslip.errors import StickslipError
from stickslip.identification.force_map.model import ForceMap
from stickslip.identification.records.fit import RecordFit
from stickslip.identification.residuals.balance import Fitted, balance_of
from stickslip.identification.residuals.delays import RESPONSES, Profile, profile_of, response_of
from stickslip.identification.residuals.gains import BLOCKS, FEWEST, basis_of, beside
from stickslip.identification.sensor_response import SensorResponse


@final
@dataclass(frozen=True, kw_only=True)
class LateSensor:
    """What a delay or a filter of the force sensor would explain of the residuals of a fit."""

    kind: str
    """``"delay"`` or ``"lag"``."""
    response: SensorResponse
    """The response of the sensor."""
    interval: tuple[float, float]
    """95 % confidence interval of its time [s], from leaving blocks out."""
    share: float
    """Share of the squared residuals that it predicts in blocks left out."""


def late_sensors(fit: RecordFit) -> tuple[LateSensor, ...]:
    """Return how late a sensor of friction would have to be for what a fit leaves."""
    if not isinstance(fit.problem, ForceMap) or not fit.friction_was_measured:
        return ()
    fitted = Fitted(
        mechanism=fit.mechanism,
        law=fit.law,
        measurement=fit.measurement,
        free_parameters=fit.free_parameters,
        estimates=fit.estimates,
        hold="first",
        measured=fit.problem,
    )
    try:
        b = balance_of(fitted, 1.0, 0)
    except StickslipError:
        return ()
    if len(b.rows) < FEWEST * BLOCKS:
        return ()
    residual = beside(b.residual, b.slopes)
    total = float(residual @ residual)
    profiles = ((kind, profile_of(b, basis_of(b.slopes), residual, kind)) for kind in RESPONSES)
    return tuple(_sensor(kind, one, total) for kind, one in profiles if one is not None)


def _sensor(kind: str, found: Profile, total: float) -> LateSensor:
    count = len(found.left_out)
    spread = float(np.sum((found.left_out - found.left_out.mean()) ** 2))
    half = float(scipy.stats.t.ppf(0.975, count - 1)) * float(np.sqrt((count - 1) / count * spread))
    return LateSensor(
        kind=kind,
        response=response_of(kind, found.value),
        interval=(-found.value - half, -found.value + half),
        share=float(found.gains.sum()) / max(total, 1e-300),
    )
