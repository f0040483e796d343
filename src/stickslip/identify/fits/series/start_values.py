"""Where fits to records begin: values and bounds of every unknown, from the record itself."""

from collections.abc import Sequence

import numpy as np

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.identify.fits.estimation.parameters import WIDE, FreeParameter
from stickslip.identify.fits.series.applied_force import driven
from stickslip.identify.fits.series.inverse_dynamics import (
    InverseDynamics,
    inverse_dynamics,
    mass_of,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity
from stickslip.show.formatting import number

LITTLE = 0.01
"""Share of a force that is next to nothing of it, and of samples that are few of them."""
MOST = 0.5
"""Share of a force that explains it: where a regression leaves more, its signs accuse no channel,
and a level of less brakes nothing. A force recorded with the wrong sign fits as well as with the
right one."""


def _regressed(
    mechanism: Mechanism, measurement: Measurement, vary: Sequence[str], *, directional: bool
) -> InverseDynamics:
    return inverse_dynamics(mechanism, measurement, vary=vary, directional=directional, robust=True)


def regressed(mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str] = ()) -> float:
    """Return the mass that regression of forces finds, or the given one if it is not looked for.

    A force against the motion that it should cause is refused.
    """
    free = ["inertia"] if any(path.endswith(("inertia", "mass")) for path in unknown) else []
    found = _regressed(mechanism, measurement, free, directional=False)
    check_signs(found, driven=driven(measurement))
    return found["inertia"] if free else mass_of(mechanism)


def check_signs(found: InverseDynamics, *, driven: bool) -> None:
    """Refuse a force that acts against the motion it should cause."""
    if _says_little(found) and not (found["level"] < 0.0 and found["viscous"] < 0.0):
        return
    said = ", ".join(f"{n} {number(v)}" for n, v in zip(found.names, found.values, strict=True))
    if not driven:
        raise InputError(
            "no drive was given, and friction alone cannot cause this motion: linear regression"
            f" gives {said}. Give the force if there was one; only a free decay needs none."
        )
    if found.relative_error > MOST:
        raise InputError(
            f"inertia and sliding friction leave {100.0 * found.relative_error:.0f} % of the force:"
            f" linear regression gives {said}, which therefore says nothing. Friction may hold the"
            " body for most of the record, so that it moves by deflection only, or another force"
            " acts. Record moves in which the body slides; check the meaning of each column."
        )
    raise InputError(
        f"the force acts against the motion that it should cause: linear regression gives {said}."
        " Check its sign (gain -1) and the meaning of each column."
    )


def _says_little(found: InverseDynamics) -> bool:
    """Whether an inertia that came out negative says nothing of the sign of the force.

    The motion was slow, and it takes a small share of the force; or slip in both directions has a
    level that brakes: a force that bends bristles goes with the acceleration too. In one direction
    a level is not told from a weight.
    """
    if found.inertial_share > -LITTLE:
        return True
    ahead = float(np.mean(found.velocity > 0.0))
    if not LITTLE < ahead < 1.0 - LITTLE or found.relative_error > MOST:
        return False
    level = min(found[name] for name in found.names if name.startswith("level"))
    return level > MOST * float(np.std(found.friction))


def mechanism_unknown(path: str, quantity: Quantity, start: float, level: float) -> FreeParameter:
    """Return an unknown of a mechanism under friction of a level [N], with wide bounds."""
    log = quantity.above is not None
    most = WIDE * (level + abs(start))
    return FreeParameter(
        path=path,
        quantity=quantity,
        start=start,
        low=start / WIDE if log else max(quantity.low, -most),
        high=WIDE * start if log else min(quantity.high, most),
        log=log,
    )
