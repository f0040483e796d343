"""A second record must be one that the fit has not seen."""

import numpy as np

from stickslip.errors import InputError
from stickslip.experiments.measurement import QUANTITIES, Measurement

__all__ = ["refuse_same"]


def refuse_same(first: Measurement, second: Measurement) -> None:
    """Refuse a second record that holds what the fit is made to, number by number.

    Parameters
    ----------
    first : Measurement
        What the fit is made to.
    second : Measurement
        What it is judged on.

    Raises
    ------
    InputError
        If any of its records has the same samples as one of the first.

    Examples
    --------
    >>> run = {"time": [0.0, 1.0], "position": [0.0, 0.1]}
    >>> refuse_same(Measurement(**run, name="run 1"), Measurement(**run))
    Traceback (most recent call last):
    stickslip.errors.InputError: the second record is identical to the fitted one ('run 1'), ...
    """
    for one in second.records():
        for other in first.records():
            if not _same(one, other):
                continue
            name = one.name or other.name
            told = f" ({name!r})" if name else ""
            raise InputError(
                f"the second record is identical to the fitted one{told}, sample by sample, so its"
                " error would not be a held-out error. Give another record, or none: held-out"
                " blocks then compare the laws on one record."
            )


def _same(one: Measurement, other: Measurement) -> bool:
    """Whether what both records have is the same, sample by sample."""
    pairs = [
        (getattr(one, name), getattr(other, name))
        for name in ("time", *QUANTITIES)
        if getattr(one, name) is not None and getattr(other, name) is not None
    ]
    if sum(np.ndim(mine) > 0 for mine, _ in pairs) < 2:
        return False  # times, and single numbers, may well be alike
    return all(np.array_equal(mine, yours) for mine, yours in pairs)
