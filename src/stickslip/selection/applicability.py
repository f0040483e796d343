"""Which laws a record can say anything of."""

import numpy as np
from numpy.typing import NDArray

from stickslip.experiments import Measurement, motion_of
from stickslip.friction import BristleLaw, FrictionLaw
from stickslip.identification import TIMELESS

__all__ = ["one_way", "unsuited_by"]

RARE = 0.01
"""Share of samples below which a direction counts as absent."""


def one_way(measurement: Measurement) -> bool:
    """Whether nothing in a record slips backwards, or nothing forwards, beyond its noise.

    Examples
    --------
    >>> v = np.linspace(0.1, 1.0, 20)
    >>> one_way(Measurement(velocity=v, friction=2.0 + v))
    True
    """
    moved = [_directions(record) for record in measurement.records()]
    if any(one is None for one in moved):
        return False
    joined = np.concatenate([one for one in moved if one is not None])
    return min(float(np.mean(joined > 0)), float(np.mean(joined < 0))) < RARE


def _directions(record: Measurement) -> NDArray[np.float64] | None:
    """Return the signs of the velocities of a record, 0 where noise hides them."""
    if record.time is None and "velocity" in record.quantities():
        return np.asarray(np.sign(np.asarray(record.values("velocity"), dtype=float)))
    moving = motion_of(record)
    return None if moving is None else np.asarray(moving.directions, dtype=float)


def unsuited_by(measurement: Measurement, law: FrictionLaw | type[FrictionLaw]) -> str:
    """Return why a law is no candidate on a record; empty if it may be one.

    On friction against velocity alone a bristle law has its steady curve, which is that of a law
    without bristles: it predicts as well, with numbers that nothing tells.

    Parameters
    ----------
    measurement : Measurement
        The record.
    law : FrictionLaw or type
        The law in question.

    Returns
    -------
    str
        The reason as a clause.

    Examples
    --------
    >>> from stickslip.friction import LuGre
    >>> table = Measurement(velocity=[0.1, 0.2, 0.3], friction=[2.0, 2.1, 2.2])
    >>> unsuited_by(table, LuGre)
    'bristles depend on displacement, which a table without time does not have'
    """
    kind = law if isinstance(law, type) else type(law)
    timeless = all(record.time is None for record in measurement.records())
    return TIMELESS if timeless and issubclass(kind, BristleLaw) else ""
