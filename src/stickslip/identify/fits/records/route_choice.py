"""Which way records are fitted, by what was measured.

Friction that was measured is fitted along the measured motion. Where motion and driving force were
measured, the balance of forces gives friction along it. Everything else is simulated in segments:
free decays, mechanisms with inner bodies or a drive of their own, parameters of a mechanism that
the balance is not linear in, and records as short as a segment, of which filters leave little.
"""

from collections.abc import Sequence
from typing import Literal, TypeAlias

import numpy as np

from stickslip.data import Measurement, command_of
from stickslip.errors import InputError, UnknownNameError
from stickslip.identify.fits.records.problems import RecordRouteName, per_current
from stickslip.identify.fits.series.applied_force import driven, drives_itself
from stickslip.identify.fits.settings import SEGMENT
from stickslip.identify.fits.validation import Parameters
from stickslip.mechanisms import Mechanism, stops_of

OwnRouteName: TypeAlias = Literal[
    "shooting", "force-map", "inverse-dynamics", "features", "rate-state", "table", "balance"
]
RouteName: TypeAlias = OwnRouteName | str
"""What `fit` and `select` may be asked for; editors complete ours, and other packages add theirs.
"""
ROUTES: tuple[RecordRouteName, ...] = ("shooting", "force-map", "inverse-dynamics")


def route_of(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    asked: str | None = None,
) -> RecordRouteName:
    """Return how a measurement is fitted: as asked, or as its quantities allow.

    Examples
    --------
    >>> from stickslip import Axis
    >>> table = Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.6])
    >>> t = np.arange(300) / 100
    >>> pushed = Measurement(time=t, position=np.sin(t), force=np.cos(t))
    >>> [route_of(Axis(inertia=1.0), one) for one in (table, pushed)]
    ['force-map', 'inverse-dynamics']
    """
    if asked is not None:
        for known in ROUTES:
            if asked == known:
                return known
        if asked == "features":
            raise InputError(
                "the route 'features' has no residuals in time: use fit_features, `fit` or"
                " `select`."
            )
        raise UnknownNameError("route", asked, (*ROUTES, "features"))
    if "friction" in measurement.quantities():
        return "force-map"
    commands = {command_of(one) for one in measurement.records()}
    short = all(float(np.ptp(np.asarray(one.time))) <= SEGMENT for one in measurement.records())
    if drives_itself(mechanism, measurement) or not driven(measurement) or "reference" in commands:
        return "shooting"
    unknown = Parameters.of(mechanism, None, vary).unknown
    linear = all(path.rpartition(".")[2] in ("inertia", "mass") for path in unknown)
    balances = not short and (linear or per_current(mechanism, measurement, unknown))
    return "inverse-dynamics" if balances and _tracked(mechanism, measurement) else "shooting"


def _tracked(mechanism: Mechanism, measurement: Measurement) -> bool:
    """Whether a mechanism has one coordinate without stops, recorded as positions in time."""
    return (
        len(mechanism.coordinates) == 1
        and not stops_of(mechanism)
        and all(
            record.time is not None and "position" in record.quantities()
            for record in measurement.records()
        )
    )
