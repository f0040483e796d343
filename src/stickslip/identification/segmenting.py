"""Cuts records into the segments that are simulated."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from stickslip.drives import Drive, Sampled, StraightPieces
from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.identification.shooting import Segment
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary

__all__ = ["RESOLUTION", "measured_quantity", "segments_of", "with_drive"]

Array = NDArray[np.float64]

RESOLUTION = 100
"""Samples a segment is compared at, and pieces its drive has, at most."""
GAP = 3.0
"""Steps of time longer than this many usual ones are gaps, which no segment crosses."""
GUESSED = 20
"""Rows of a segment from whose parabola its first velocity is guessed."""
LEAST = 8
"""Rows that a segment must have to say anything beside its initial state."""


def measured_quantity(measurement: Measurement) -> str:
    """Return what simulated runs are compared with: the position, or else the velocity.

    Raises
    ------
    InputError
        If there is neither, or no time.
    """
    for record in measurement.records():
        if record.time is None:
            raise InputError(
                f"a simulated run is compared in time, and record {record.name!r} has no time."
            )
    for quantity in ("position", "velocity"):
        if all(quantity in record.quantities() for record in measurement.records()):
            return quantity
    raise InputError(
        "a simulated run is compared with position or velocity, and the records have only"
        f" {', '.join(measurement.quantities())}."
    )


def with_drive(mechanism: Mechanism, drive: Drive) -> Mechanism:
    """Return a mechanism driven by what was measured.

    Raises
    ------
    InputError
        If it has no place for a drive.
    """
    if "drive" not in mechanism.__dataclass_fields__:
        raise InputError(
            f"{type(mechanism).__name__} has no drive that a measured force could be; use Axis or"
            " SpringBlock."
        )
    return vary_drive(mechanism, drive)


def vary_drive(mechanism: Mechanism, drive: Drive | None) -> Mechanism:
    """Return a mechanism with another drive."""
    from dataclasses import replace

    return replace(mechanism, drive=drive)  # type: ignore[call-arg]


def segments_of(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    length: float,
    resolution: int = RESOLUTION,
) -> tuple[Segment, ...]:
    """Return segments of about the same length that cover all records.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured; records may override its parameters.
    measurement : Measurement
        Records in time.
    length : float
        Length of a segment [s]; the last one of a record may be down to half as long, and a
        shorter remainder is left out.
    resolution : int
        Rows of a segment at most; what drives it is averaged over each of them.
    """
    quantity = measured_quantity(measurement)
    found: list[Segment] = []
    for index, record in enumerate(measurement.records()):
        set_up = vary(mechanism, "mechanism", record.overrides) if record.overrides else mechanism
        time = np.asarray(record.time)
        for first, last in _stretches(time, length):
            found.append(_segment(index, record, quantity, set_up, first, last, resolution))
    if not found:
        raise InputError(
            f"no record has {LEAST} samples without a gap: there is nothing to compare runs with."
        )
    return tuple(found)


def _stretches(time: Array, length: float) -> Iterator[tuple[int, int]]:
    """Yield first and last index of each segment."""
    steps = np.diff(time)
    breaks = np.flatnonzero(steps > GAP * np.median(steps))
    for first, last in zip([0, *(breaks + 1)], [*breaks, len(time) - 1], strict=True):
        count = max(1, round((time[last] - time[first]) / length))
        edges = time[first] + length * np.arange(count + 1)
        cuts = np.searchsorted(time[first : last + 1], edges - 1e-6 * length) + first
        for one, other in zip(cuts[:-1], np.minimum(cuts[1:], last), strict=True):
            if other - one >= LEAST:
                yield int(one), int(other)


def _segment(
    index: int,
    record: Measurement,
    quantity: str,
    mechanism: Mechanism,
    first: int,
    last: int,
    resolution: int,
) -> Segment:
    assert isinstance(record.time, np.ndarray)
    stride = max(1, (last - first) // resolution)
    rows = np.arange(first, last + 1, stride)
    times = record.time[rows] - record.time[first]
    values = np.asarray(record.values(quantity))
    if "force" in record.quantities():
        force = np.asarray(record.values("force"))
        drive = _drive(record.time[first : rows[-1] + 1], force[first : rows[-1] + 1], stride)
        mechanism = with_drive(mechanism, drive)
    return Segment(
        record=index,
        start=float(record.time[first]),
        mechanism=mechanism,
        times=times,
        measured=values[rows],
        guess=_guess(mechanism, quantity, record.time[first : last + 1], values[first : last + 1]),
    )


def _drive(time: Array, force: Array, stride: int) -> Drive:
    """Return a held force with fewer pieces.

    Where every sample is a piece it is taken as it is. Else each piece is the straight line of the
    same impulse and the same moment: to a free mass it is the same force at the ends of pieces.
    """
    t = time - time[0]
    if stride == 1:
        return Sampled(times=t[:-1].tolist(), values=force[:-1].tolist())
    ends = t[::stride]
    first = np.arange(0, len(t) - 1, stride)
    length, middle = np.diff(ends), 0.5 * (ends[1:] + ends[:-1])
    steps = np.diff(t)
    impulse = np.add.reduceat(force[:-1] * steps, first)
    moment = np.add.reduceat(force[:-1] * steps * 0.5 * (t[1:] + t[:-1]), first)
    slope = 12.0 * (moment - middle * impulse) / length**3
    value = impulse / length - 0.5 * slope * length
    return StraightPieces(
        times=tuple(ends.tolist()),
        values=(*value.tolist(), float(force[-1])),
        slopes=(*slope.tolist(), 0.0),
    )


def _guess(mechanism: Mechanism, quantity: str, time: Array, values: Array) -> Array:
    """Return the first coordinates and rates, from a parabola through the first samples."""
    count = min(len(time), GUESSED + 1)
    t = time[:count] - time[0]
    slope, value = np.polyfit(t, values[:count], 2)[1:]
    slip = mechanism.coordinates.index(mechanism.contacts()[0].slip)
    state = np.zeros(2 * len(mechanism.coordinates))
    if quantity == "position":
        state[slip], state[slip + len(mechanism.coordinates)] = value, slope
    else:
        state[slip + len(mechanism.coordinates)] = value
    return state
