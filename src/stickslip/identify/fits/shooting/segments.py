"""Cuts records into the segments that are simulated."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from stickslip.data import LoopSamples, Measurement, as_recorded, interval_of, loop_samples
from stickslip.errors import InputError
from stickslip.identify.fits.contact_inputs import loaded, with_inputs
from stickslip.identify.fits.motions import GAP
from stickslip.identify.fits.record_forces import (
    applied_force,
    drives_itself,
    goes_straight,
    inside,
)
from stickslip.identify.fits.settings import RESOLUTION, Hold
from stickslip.identify.fits.shooting.multiple_shooting import FIRST, Segment
from stickslip.identify.fits.shooting.sampled_loops import LoopInSegment
from stickslip.mechanisms import Mechanism, motor_of, slip_of
from stickslip.mechanisms.drives import Drive, PiecewiseAffine, Sampled
from stickslip.show.formatting import joined, number

Array = NDArray[np.float64]

SEGMENT = 1.0
"""Length of a segment [s] that is simulated from a state of its own."""
LEAST = 8
"""Rows that a segment must have to say anything beside its initial state."""


def measured_quantity(measurement: Measurement) -> str:
    """Return what simulated runs are compared with: the position, or else the velocity."""
    for record in measurement.records():
        if record.time is None:
            raise InputError(
                f"simulations are compared in time, and record {record.name!r} has no time."
            )
    for quantity in ("position", "velocity"):
        if all(quantity in record.quantities() for record in measurement.records()):
            return quantity
    raise InputError(
        "simulations are compared with position or velocity, and the records have only"
        f" {joined(measurement.quantities())}."
    )


def with_drive(mechanism: Mechanism, drive: Drive | None) -> Mechanism:
    """Return a mechanism driven by what was measured."""
    if "drive" not in mechanism.__dataclass_fields__:
        raise InputError(
            f"{type(mechanism).__name__} has no drive that a measured force can replace; use Axis"
            " or SpringBlock."
        )
    motor = motor_of(mechanism)
    return replace(mechanism, drive=drive if motor is None else replace(motor, drive=drive))  # type: ignore[call-arg]  # it has one, as was seen


def segments_of(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    length: float | None = None,
    hold: Hold = "zero",
) -> tuple[Segment, ...]:
    """Return segments that cover all records, of about a length [s] if that is given.

    Usual is a second, or `FIRST` samples if those take longer. What drives itself is one segment,
    with as many rows for each second: it runs from its start in any case.
    """
    quantity, resolution = measured_quantity(measurement), RESOLUTION
    if length is None:
        times = [np.asarray(record.time) for record in measurement.records()]
        length = max([SEGMENT, *(FIRST * interval_of(time) for time in times if time.size > 1)])
        if drives_itself(mechanism, measurement):
            longest = max(float(np.ptp(time)) for time in times)
            resolution = math.ceil(resolution * max(longest / length, 1.0))
            length = max(longest, length)
    result: list[Segment] = []
    for index, record in enumerate(loaded(mechanism, measurement).records()):
        set_up = as_recorded(mechanism, record)
        time, loop = np.asarray(record.time), loop_samples(set_up, record, hold)
        for first, last in _stretches(time, length):
            rows = _rows(first, last, resolution)
            result.append(_segment(index, record, quantity, set_up, rows, hold, loop))
    if not result:
        steps = [interval_of(np.asarray(item.time)) for item in measurement.records()]
        raise InputError(
            f"no segment of {number(length)} s has {LEAST} samples without a gap, with one every"
            f" {number(min(steps))} s: record longer, or check that time is in seconds."
        )
    return tuple(result)


def _stretches(time: Array, length: float) -> Iterator[tuple[int, int]]:
    """Yield first and last index of each segment."""
    steps = np.diff(time)
    breaks = np.flatnonzero(steps > GAP * np.median(steps))
    for first, last in zip([0, *(breaks + 1)], [*breaks, len(time) - 1], strict=True):
        count = max(1, round((time[last] - time[first]) / length))
        edges = time[first] + length * np.arange(count + 1)
        cuts = np.searchsorted(time[first : last + 1], edges - 1e-6 * length) + first
        for cut, other in zip(cuts[:-1], np.minimum(cuts[1:], last), strict=True):
            if other - cut >= LEAST:
                yield int(cut), int(other)


def _segment(
    index: int,
    record: Measurement,
    quantity: str,
    mechanism: Mechanism,
    rows: NDArray[np.intp],
    hold: Hold,
    loop: LoopSamples | None,
) -> Segment:
    assert isinstance(record.time, np.ndarray)
    first, last = int(rows[0]), int(rows[-1])
    stride = int(rows[1] - rows[0])
    times = record.time[rows] - record.time[first]
    values = np.asarray(record.values(quantity))
    if drives_itself(mechanism, record):
        told = with_inputs(mechanism, record, np.append(0.0, record.time[record.time > 0.0]))
        return _from_the_start(index, record, quantity, told, rows)
    force = None if loop else applied_force(mechanism, record)
    if force is not None:
        part = slice(first, last + 1)
        joined = goes_straight(record, hold)
        pushed = bool(np.any(force))  # a force of 0 is no drive, and takes the mechanism's own off
        drive = _drive(record.time[part], force[part], stride, joined=joined) if pushed else None
        mechanism = with_drive(mechanism, drive)
    return Segment(
        record=index,
        start=float(record.time[first]),
        mechanism=with_inputs(mechanism, record, record.time[rows]),
        times=times,
        measured=values[rows],
        guess=_guess(mechanism, quantity, record.time[first : last + 1], values[first : last + 1]),
        known=np.zeros(2 * len(mechanism.coordinates), dtype=bool),
        loop=LoopInSegment(samples=loop, start=float(record.time[first])) if loop else None,
    )


def _from_the_start(
    index: int,
    record: Measurement,
    quantity: str,
    mechanism: Mechanism,
    rows: NDArray[np.intp],
) -> Segment:
    """Return a segment of a mechanism with a drive of its own: it runs from time 0 on.

    Nobody measured what moves inside. It begins as a drive prescribes or the record says, if it
    does, else as fits best, near where the mechanism begins.
    """
    assert isinstance(record.time, np.ndarray)
    if record.time[0] < 0.0:
        raise InputError(
            f"the record begins at {number(float(record.time[0]))} s, but the drive of"
            f" {type(mechanism).__name__} begins at 0 s: shift the times of the record."
        )
    names = (*mechanism.coordinates, *mechanism.rates)
    guess = _guess(mechanism, quantity, record.time, np.asarray(record.values(quantity)))
    stated = {**mechanism.start(), **record.initial}
    hidden = np.isin(names, inside(mechanism, record))
    return Segment(
        record=index,
        start=0.0,
        mechanism=mechanism,
        times=record.time[rows],
        measured=np.asarray(record.values(quantity))[rows],
        guess=np.where(hidden, [stated.get(name, 0.0) for name in names], guess),
        known=hidden & np.isin(names, [*stated]),
    )


def _rows(first: int, last: int, resolution: int) -> NDArray[np.intp]:
    """Return the samples at which a segment is compared."""
    return np.arange(first, last + 1, max(1, (last - first) // resolution))


def _drive(time: Array, force: Array, stride: int, *, joined: bool) -> Drive:
    """Return a sampled force with fewer pieces.

    Where every sample is a piece it is taken as it is. Else each piece is the straight line of the
    same impulse and the same moment: to a free mass it is the same force at the ends of pieces.
    """
    t = time - time[0]
    if stride == 1 and joined:
        return Sampled(times=tuple(t.tolist()), values=tuple(force.tolist()), hold="first")
    if stride == 1:
        return Sampled(times=tuple(t[:-1].tolist()), values=tuple(force[:-1].tolist()))
    rise = np.diff(force) if joined else np.zeros(len(force) - 1)
    held = force[:-1] + 0.5 * rise
    ends = t[::stride]
    first = np.arange(0, len(t) - 1, stride)
    length, middle = np.diff(ends), 0.5 * (ends[1:] + ends[:-1])
    steps = np.diff(t)
    impulse = np.add.reduceat(held * steps, first)
    moments = held * steps * 0.5 * (t[1:] + t[:-1]) + rise * steps**2 / 12.0
    moment = np.add.reduceat(moments, first)
    slope = 12.0 * (moment - middle * impulse) / length**3
    value = impulse / length - 0.5 * slope * length
    return PiecewiseAffine(
        times=tuple(ends.tolist()),
        values=(*value.tolist(), float(force[-1])),
        slopes=(*slope.tolist(), 0.0),
    )


def _guess(mechanism: Mechanism, quantity: str, time: Array, values: Array) -> Array:
    """Return the first coordinates and rates, from a parabola through the first samples."""
    count = min(len(time), FIRST + 1)
    t = time[:count] - time[0]
    slope, value = np.polyfit(t, values[:count], 2)[1:]
    slip = mechanism.coordinates.index(slip_of(mechanism))
    state = np.zeros(2 * len(mechanism.coordinates))
    if quantity == "position":
        state[slip], state[slip + len(mechanism.coordinates)] = value, slope
    else:
        state[slip + len(mechanism.coordinates)] = value
    return state
