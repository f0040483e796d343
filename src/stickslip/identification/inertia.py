"""The mass of a mechanism by inverse dynamics, with its interval."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.identification.doubts import INTERVAL
from stickslip.identification.inference import infer
from stickslip.identification.inverse_dynamics import inverse_dynamics
from stickslip.identification.problem import Linearised
from stickslip.identification.results import Estimate
from stickslip.mechanisms import Mechanism
from stickslip.quantities import full_path, parameters

__all__ = ["inertia_of"]

Array = NDArray[np.float64]


def inertia_of(
    mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str]
) -> Estimate | None:
    """Return the mass of a mechanism where it is looked for, by robust regression.

    Its interval comes from leaving out blocks of the record, as that of other estimates: filtered
    forces have residuals that are far from independent.

    Raises
    ------
    InputError
        If anything but the mass is looked for, or what is found is no mass.
    """
    names = [name.rpartition(".")[2] for name in unknown]
    for name in names:
        if name not in ("inertia", "mass"):
            raise InputError(f"inverse dynamics finds the mass of a mechanism, not {name!r}.")
    if not names:
        return None
    known = {path: quantity for path, quantity, _ in parameters(mechanism, "mechanism")}
    path = full_path(names[0], list(known))
    found = inverse_dynamics(mechanism, measurement, directional=True, robust=True)
    value, half = found["inertia"], _half_width(found.table, found.residual, found.weights)
    if value <= 0.0:
        raise InputError(
            f"inverse dynamics finds {value:.3g} kg for {path}: is the sign of the force right"
            " (gain -1), and does the motion accelerate?"
        )
    spread = min(half / value, 700.0)
    open_ended = not math.isfinite(half)
    return Estimate(
        path=path,
        quantity=known[path],
        value=value,
        low=-math.inf if open_ended else value * math.exp(-spread),
        high=math.inf if open_ended else value * math.exp(spread),
        interval=INTERVAL,
        reason="the record does not depend on it" if open_ended else "",
    )


def _half_width(table: Array, residual: Array, weights: Array) -> float:
    """Return the half width of the first value's 95 % interval."""
    root = np.sqrt(weights)
    seen = Linearised(
        values=np.zeros(table.shape[1]),
        residual=root * residual,
        slopes=root[:, None] * table,
        segment=np.zeros(len(residual), dtype=np.intp),
    )
    return float(infer(seen, np.eye(table.shape[1])).half_widths[0])
