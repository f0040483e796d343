"""Trials at rest throughout: no row of them slips, so that a fit of sliding friction has none."""

from stickslip.data import Measurement, faults


def rests(record: Measurement) -> bool:
    """Whether a record is one of a single body that rests throughout, as `check` says.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(50.0)
    >>> [rests(Measurement(time=t, position=x, force=t)) for x in (0.0 * t, np.sin(t))]
    [True, False]
    """
    if record.time is None or record.joints:
        return False
    return any(one.kind == "constant" for one in faults(record))
