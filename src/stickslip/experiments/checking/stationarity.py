"""Levels of forces: whether they stay, and how many independent values there are."""

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from stickslip.experiments.checking.finding import Finding
from stickslip.experiments.checking.motion import Motion
from stickslip.experiments.differentiation import acceleration_of, smooth
from stickslip.experiments.measurement import Array, Measurement
from stickslip.formatting import number, percent, quantities

FORCES: Final = ("force", "friction", "spring_force", "load")
BLOCKS: Final = 10
"""Blocks in each half, whose scatter is the doubt of its mean."""
SURE: Final = 2.0
"""Standard errors by which the means of two halves differ, not to be chance in most cases."""
MATTERS: Final = 0.05
"""Change over the level that a fit would notice."""
FEWEST: Final = 200
FEW: Final = 30


class Level(NamedTuple):
    """A signal without what the motion explains of it."""

    name: str
    """Name of the quantity."""
    what: str
    """Where it comes from, in words."""
    values: Array
    """What remains of the signal (n,)."""
    size: float
    """Root mean square of the whole signal."""
    unit: str = "N"
    """SI unit of the signal."""


def levels(record: Measurement, motion: Motion | None) -> Iterator[Level]:
    """Yield forces less what acceleration, velocity and direction explain of them."""
    for name in FORCES:
        if not isinstance(getattr(record, name), np.ndarray):
            continue
        values = np.asarray(record.values(name))
        size = float(np.sqrt(np.mean(values**2)))
        words = name.replace("_", " ")
        if motion is None or name == "load":
            yield Level(name, words, values, size, record.unit(name))
            continue
        columns = [acceleration_of(record), motion.velocity, motion.directions]
        matrix = np.stack([*columns, np.ones(values.size)], axis=1)
        scale = np.sqrt(np.mean(matrix**2, axis=0))
        matrix = matrix / np.where(scale > 0, scale, 1.0)
        found = np.linalg.lstsq(matrix, values, rcond=None)[0]
        left = values - matrix[:, :3] @ found[:3]
        what = (
            f"{words} after subtraction of its dependence on acceleration, velocity and direction"
        )
        yield Level(name, what, left, size, record.unit(name))


def independent(values: Array) -> float:
    """Return how many independent values have a mean as sure as these, from how long they agree.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> white = rng.normal(size=10_000)
    >>> bool(independent(white) > 9_000), bool(independent(np.repeat(white, 10)) < 11_000)
    (True, True)
    """
    from scipy.fft import irfft, next_fast_len, rfft

    n = values.size
    centred = values - values.mean()
    power = float(centred @ centred)
    if power <= 1e-24 * float(values @ values):
        return float(n)
    padded = next_fast_len(2 * n, real=True)
    seen = irfft(np.abs(rfft(centred, padded)) ** 2, padded)[:n] / power
    below = np.flatnonzero(seen <= 0)
    last = int(below[0]) if below.size else n
    return float(min(n, n / (1.0 + 2.0 * float(np.sum(seen[1:last])))))


def drift(found: list[Level]) -> Iterator[Finding]:
    """Say which forces change their mean from the first half to the second."""
    for level in found:
        if level.values.size < FEWEST or level.size == 0.0 or np.ptp(level.values) == 0.0:
            continue
        halves = np.array_split(level.values, 2)
        means = [float(half.mean()) for half in halves]
        change, doubt = means[1] - means[0], math.hypot(*map(_doubt, halves))
        sure = abs(change) / doubt if doubt else np.inf
        if sure < SURE or abs(change) < 0.01 * level.size:
            continue
        matters = abs(change) >= MATTERS * level.size
        first, second = quantities(means, level.unit)
        word = "rises" if change > 0 else "falls"
        text = f"Mean {level.what} {word} from {first} in the first half to {second} in the second"
        text += f" ({percent(abs(change) / level.size)} of its level,"
        text += f" {number(float(sure), 2)} standard errors)"
        text += ": fit the halves separately, or fit the drifting parameter." if matters else "."
        yield Finding(
            kind="drift",
            severity="warning" if matters else "info",
            sentence=text,
            measure=(
                "Repeat this record after an hour of running, to separate warm-up effects from the"
                " friction law"
            ),
            numbers={
                "first": means[0],
                "second": means[1],
                "standard_error": doubt,
                "relative": change / level.size,
            },
        )


def _doubt(values: Array) -> float:
    """Return the standard error of a mean from the scatter of the means of blocks."""
    means = [float(block.mean()) for block in np.array_split(values, BLOCKS)]
    return float(np.std(means, ddof=1)) / float(np.sqrt(BLOCKS))


def effective(record: Measurement, levels: list[Level]) -> Iterator[Finding]:
    """Say how many independent values the record has, and of what."""
    chosen = next((level for level in levels if level.name != "load"), None)
    time = record.time
    if chosen is not None:
        what, values = chosen.what, chosen.values
    elif time is not None and (record.position is not None or record.velocity is not None):
        name = "position" if record.position is not None else "velocity"
        own = np.asarray(record.values(name))
        what, values = f"{name} minus its smooth component", own - smooth(time, own)
    else:
        return
    if values.size < FEW or np.ptp(values) == 0.0:
        return
    size = independent(values)
    few = size < 0.9 * values.size  # two digits of nearly all would be more than all
    shown = number(size, 2) if few else number(math.floor(size), 9)
    yield Finding(
        kind="effective size",
        severity="warning" if size < FEW else "info",
        sentence=(
            f"Effective sample size before any fit: {shown} of {number(values.size, 9)}"
            f" samples (from the autocorrelation of the {what})."
        ),
        numbers={"samples": values.size, "independent": size},
    )
