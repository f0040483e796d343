"""The band of records, the sensors that are used of them, and what columns are scaled by."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stickslip.errors import InputError
from stickslip.identify.problem import BEYOND, STRETCHES, bending_of
from stickslip.identify.problems.record_signals import Along, Frame, Record, noise_of

APART = 3.0
"""Distance over 1/fc from which rows are independent."""
SHARE = 0.01
"""Share of the force that noise of the acceleration may have."""
WIDEST, NARROWEST = 130.0, 1.5
"""Limits of the band over the mean frequency of the motion."""
FREE = 4.0
"""Band of a free motion over its mean frequency: its energy is that of all harmonics."""
RESTED = 5.0
"""Noise of the place by which a body moves that has not come to rest."""
RESTING = 50
"""Parts of a record, of which a body rests in one at least."""
TURNED = 0.1
"""Way back over the range up to which a motion goes on in one direction."""
FREE_SAMPLED = 0.35
"""Its largest band over the sampling rate."""
SAMPLED = 0.15
"""Largest band over the sampling rate."""
BEND = 0.5
"""Logarithm of speeds over which the curve bends by its prior, and between knots beyond them."""
SLOW, SLOW_FREE = 0.02, 0.1
"""Part of the rows that is slower than friction is stated for: little work is done there."""
KNOTS = 10
"""Knots of the measured curve over speed."""


def mean_frequency(records: Sequence[Record]) -> float:
    """Return the mean frequency of the motion [Hz]: of positions, or of velocities if higher."""
    found = []
    for one in records:
        h = float(np.median(np.diff(one.time)))
        width = max(len(one.time) // 400, 1)
        kernel = np.ones(width) / width
        q = np.convolve(one.position, kernel, mode="valid")
        v = np.gradient(q, h)[2:-2]
        if one.velocity is not None:
            v = np.convolve(one.velocity, kernel, mode="valid")[2:-2]
        v = np.convolve(v, kernel, mode="valid")
        a = np.gradient(v, h)
        of_position = float(np.std(v)) / max(float(np.std(q)), 1e-300)
        of_velocity = float(np.std(a)) / max(float(np.sqrt(np.mean(v * v))), 1e-300)
        found.append(max(of_position, of_velocity) / (2.0 * math.pi))
    return float(np.median(found))


def _allowed_band(records: Sequence[Record], noise: float) -> float:
    """Return the band [Hz] in which noise of the sensor is an acceleration of a size [m/s^2]."""
    h = max(float(np.median(np.diff(one.time))) for one in records)
    if records[0].velocity is None:
        ratio = noise / max(noise_of(one.position) for one in records)
        return float((5.0 * ratio**2 / (2.0 * h * (2.0 * math.pi) ** 4)) ** 0.2)
    ratio = noise / max(noise_of(one.velocity) for one in records if one.velocity is not None)
    return float((3.0 * ratio**2 / (2.0 * h * (2.0 * math.pi) ** 2)) ** (1.0 / 3.0))


def by_best_sensor(records: Sequence[Record]) -> list[Record]:
    """Return records without velocities where positions tell accelerations better."""
    both = all(one.velocity is not None and one.located for one in records)
    if not both:
        return list(records)
    bare = [replace(one, velocity=None) for one in records]
    f = mean_frequency(bare)
    typical = (2.0 * math.pi * f) * float(np.std(np.asarray(records[0].velocity)))
    by_position = _allowed_band(bare, SHARE * typical)
    return bare if by_position > _allowed_band(records, SHARE * typical) else list(records)


def alike(records: Sequence[Record], first: Record) -> list[Record]:
    """Return records with the sensors that were used of others."""
    if first.velocity is None:
        return [replace(one, velocity=None) for one in records]
    return list(records)


def free_form(records: Sequence[Record]) -> str:
    """Return how a free motion is integrated: its momentum where it goes on, else its work.

    It goes on where it turns back by little of its way.
    """
    if any(np.ptp(one.force) > 0.0 or one.friction or one.driven for one in records):
        return ""
    ways = [(one.position, float(np.ptp(one.position)) + 1e-300) for one in records]
    back = [
        min(float(np.max(np.maximum.accumulate(q) - q)) for q in (x, -x)) / size for x, size in ways
    ]
    return "momentum" if max(back) < TURNED else "work"


def before_rest(record: Record) -> Record:
    """Return a free motion until the body rests for good, which tells nothing of sliding.

    The level of a law would act on, by the time or by the noise of the place.
    """
    x, least = record.velocity, max(len(record.time) // RESTING, 3)
    if record.located:
        x = record.position - np.median(record.position[-least:])
    assert x is not None
    # the quietest parts of a short record have less noise than it has
    last = float(np.std(np.diff(x[-max(len(x) // 4, 8) :], 3))) / math.sqrt(20.0)
    moving = np.flatnonzero(np.abs(x) > RESTED * max(noise_of(x), last))
    end = int(moving[-1]) + 1 if len(moving) else len(x)
    return record if len(x) - end < least else record.on(record.time[:end])


def balanced_band(records: Sequence[Record], inertia: float) -> float:
    """Return the band [Hz] in which the force balance of a free motion shows its friction."""
    h = max(float(np.median(np.diff(one.time))) for one in records)
    low = min(NARROWEST * mean_frequency(records), SAMPLED / h)
    left = Along(records, None, low)
    allowed = 0.1 * float(np.std(left.force - inertia * left.acceleration))
    return float(np.clip(_allowed_band(records, allowed / inertia), low, SAMPLED / h))


def band_for(records: Sequence[Record]) -> float:
    """Return the band [Hz] in which noise of the motion costs little of the force."""
    h = max(float(np.median(np.diff(one.time))) for one in records)
    mean = mean_frequency(records)
    longest = max(float(one.time[-1] - one.time[0]) for one in records)
    top = min(SAMPLED / h, WIDEST * mean)
    low = min(max(NARROWEST * mean, STRETCHES / longest), SAMPLED / h)
    top = max(top, low)
    first = records[0]
    if first.friction:
        return top
    free = free_form(records)
    if free:
        least = STRETCHES / longest
        return float(min(max(FREE * mean if free == "work" else 0.0, least), FREE_SAMPLED / h))
    trial = Along(records, None, min(20.0 * mean + low, top))
    if not trial.count:
        raise InputError(
            "the body rests throughout the record, or moves by no more than the noise of its"
            " position: nothing tells friction. Move it farther."
        )
    sought = {path: one for path, one in first.unknown.items() if not one.doubt}
    if first.inertia is None or any(one.inertia for one in sought.values()):
        v = trial.seen(trial.velocity)
        slow = 0.02 * float(np.quantile(np.abs(v), 0.98)) + 1e-300
        x = np.column_stack([
            trial.acceleration, np.tanh(v / slow), v, np.ones_like(v),
            *(trial.taken(path) for path, one in sought.items() if not one.inertia),
        ])  # fmt: skip
        inertia = abs(float(np.linalg.lstsq(x, trial.force, rcond=None)[0][0]))
    else:
        inertia = first.inertia
    allowed = SHARE * float(np.std(trial.force))
    band = _allowed_band(records, allowed / max(first.gain * inertia, 1e-300))
    return float(np.clip(band, low, top))


def _unit(rows: Along) -> float:
    """Return the standard deviation of what a force of 1 N does in a record."""
    found = 0.0
    for q, filt in zip(rows.ways, rows.filters, strict=True):
        lasts = filt.step * (len(q) - 1)
        done = float(np.sum(np.abs(np.diff(q)))) if rows.free == "work" else lasts
        spread = done / math.sqrt(12.0)
        # what is left of a parabola beside a line
        found += lasts**2 / math.sqrt(720.0) if rows.moves and rows.free == "momentum" else spread
    return found / len(rows.records) or 1.0


def frame_of(rows: Along, band: float) -> Frame:
    """Return what the columns of records are scaled by."""
    speed = np.abs(rows.seen(rows.velocity))
    top = float(np.quantile(speed, 0.99))
    low = max(top / 200.0, float(np.quantile(speed, SLOW_FREE if rows.free else SLOW)))
    if rows.free:
        knots = np.linspace(math.log(low), math.log(top), math.ceil(math.log(top / low) / BEND) + 1)
    else:
        quantiles = np.quantile(speed, np.linspace(0.02, 1.0, KNOTS))
        knots = np.unique(np.log(np.maximum(quantiles, low)))
    beyond = BEND * np.arange(1, BEYOND + 1)
    knots = np.concatenate([knots[0] - beyond[::-1], knots, knots[-1] + beyond])
    values, basis = bending_of(knots)
    low_x, high_x = float(rows.position.min()), float(rows.position.max())
    loads = [one.load for one in rows.records if one.load is not None]
    varies = bool(loads) and float(np.ptp(np.concatenate(loads))) > 0.05 * float(
        np.median(loads[0])
    )
    names = set.intersection(*({*one.inputs} for one in rows.records))
    inputs = {name: np.concatenate([one.inputs[name] for one in rows.records]) for name in names}
    return Frame(
        band=band,
        noise=rows.noise,
        top=top,
        low=low,
        middle=0.5 * (low_x + high_x),
        relaxed=0.0 if low_x <= 0.0 <= high_x else 0.5 * (low_x + high_x),
        span=high_x - low_x,
        start=float(rows.records[0].time[0]),
        duration=max(float(one.time[-1] - one.time[0]) for one in rows.records),
        load=float(np.exp(np.mean(np.log(np.concatenate(loads))))) if varies else 1.0,
        inputs={name: float(np.mean(x)) for name, x in sorted(inputs.items()) if np.ptp(x) > 0.0},
        knots=knots,
        basis=basis,
        bending=BEND**3 * values,
        unit=_unit(rows),
    )
