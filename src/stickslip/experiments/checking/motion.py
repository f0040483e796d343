"""What the motion of a record can tell: directions, rests, slow parts."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from stickslip.experiments.checking.finding import OTHER_WAY, Finding
from stickslip.experiments.differentiation import (
    CUTOFF,
    interval_of,
    noise_of,
    smooth,
    step_of,
    velocity_of,
)
from stickslip.experiments.line import travels
from stickslip.experiments.measurement import Array, Measurement
from stickslip.experiments.readers.steady_readings import are_steady_readings
from stickslip.formatting import count, number, percent, quantities, quantity

SLOW: Final = 0.05
BENT: Final = 0.01
"""Distance from the line of motion over its length up to which a motion counts as straight."""
HYSTERESIS: Final = 0.01
"""Speed over the largest below which a direction is not believed, where there is no noise."""
RESTING: Final = 1e-3
SWING: Final = 0.005
"""Way over the whole stroke that a direction must last to be believed."""
SURE: Final = 5.0
"""Standard deviations of its noise that a speed must have to be one."""
SHORTEST: Final = 10
"""Samples that a rest has at least."""
MOSTLY: Final = 0.9
"""Share of a record at rest from which it shows little of friction in motion."""
LITTLE: Final = "the record shows little of friction in motion"


@dataclass(frozen=True, kw_only=True)
class Motion:
    """The velocity of a record and what of it is noise."""

    time: Array
    """Times (n,) [s]."""
    velocity: Array
    """Filtered [m/s]."""
    noise: float
    """Standard deviation of its noise [m/s]."""
    unit: str = "m/s"
    """``"rad/s"`` about an axis."""
    measured: Array | None = None
    """As it was measured [m/s], if it was."""

    @property
    def fastest(self) -> float:
        """The largest speed [m/s], single samples left out in long records."""
        speed = np.abs(self.velocity)
        return float(np.quantile(speed, 0.999)) if speed.size > 5000 else float(speed.max())

    @property
    def sure(self) -> float:
        """Speed above which a direction is believed [m/s]."""
        return max(HYSTERESIS * self.fastest, SURE * self.noise)

    @cached_property
    def directions(self) -> NDArray[np.int64]:
        """1, -1, or 0 where the speed is too low or the way too short to tell."""
        found = np.sign(np.where(np.abs(self.velocity) > self.sure, self.velocity, 0.0)).astype(int)
        first = np.flatnonzero(np.diff(found, prepend=2))
        steps = np.diff(self.time, append=self.time[-1]) * self.velocity
        ways = np.add.reduceat(steps, first)
        path = np.cumsum(steps)
        # A filter swings about a velocity that jumps, by a little way.
        short = np.abs(ways) < SWING * float(np.ptp(path))
        return np.where(np.repeat(short, np.diff(first, append=found.size)), 0, found)

    @cached_property
    def rests(self) -> Array:
        """Durations (k,) [s] of the periods in which nothing moves."""
        still = np.abs(self.velocity) <= max(RESTING * self.fastest, SURE * self.noise)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(int)))
        first, last = edges[::2], edges[1::2] - 1
        long = last - first + 1 >= SHORTEST
        durations: Array = (self.time[last] - self.time[first])[long]
        return durations

    @property
    def hardly_moves(self) -> bool:
        """Whether the body rests for most of the record: friction is what is applied to it then."""
        return bool(np.sum(self.rests) > MOSTLY * (self.time[-1] - self.time[0]))


def motion_of(record: Measurement) -> Motion | None:
    """Return how a record moves, or None if it says nothing about that."""
    time = record.time
    if time is None or (record.position is None and record.velocity is None):
        return None
    dt, unit = interval_of(time), record.unit("velocity")
    if record.velocity is not None:
        raw = velocity_of(record)
        # A low pass at a share of the sampling leaves that share of both sides of white noise.
        noise = noise_of(raw, step_of(raw)) * np.sqrt(2 * CUTOFF)
        return Motion(
            time=time, velocity=smooth(time, raw), noise=float(noise), unit=unit, measured=raw
        )
    position = np.asarray(record.values("position"))
    # The same for the derivative, whose spectrum grows with the frequency squared.
    share = 2 * np.pi * np.sqrt(2 * CUTOFF**3 / 3)
    noise = noise_of(position, step_of(position)) * share / dt
    return Motion(time=time, velocity=velocity_of(record), noise=float(noise), unit=unit)


def reversals(motion: Motion, *, offset: bool = True) -> Iterator[Finding]:
    """Count the changes of direction, and say what follows from there being none.

    Motion one way tells no friction level from a constant force: one that a fit looks for, or that
    a sensor of force may add. Where there is no such `offset`, nothing is lost.
    """
    seen = motion.directions[motion.directions != 0]
    if not seen.size:
        noise, fastest = quantities([motion.noise, motion.fastest], motion.unit)
        yield Finding(
            kind="reversals",
            severity="warning",
            sentence=(
                f"The largest speed, {fastest}, is not significantly above its noise of {noise}:"
                " directions cannot be determined. Filter the position, or measure it with a finer"
                " resolution."
            ),
            measure="Measure faster or larger motions",
            numbers={"noise": motion.noise, "fastest": motion.fastest},
        )
        return
    changes = int(np.count_nonzero(np.diff(seen)))
    numbers = {"reversals": changes, "forward_share": float(np.mean(seen > 0))}
    if changes:
        yield Finding(
            kind="reversals",
            sentence=(
                f"The direction changes {number(changes, 7) + ' times' if changes > 1 else 'once'};"
                f" {percent(numbers['forward_share'])} of the moving samples go forward."
            ),
            numbers=numbers,
        )
        return
    way = "forward" if seen[0] > 0 else "backward"
    one_number = ", so that friction level and offset cannot be separated" if offset else ""
    yield Finding(
        kind="reversals",
        severity="warning" if offset else "info",
        sentence=f"No reversals: the motion goes {way} only{one_number}.",
        measure=OTHER_WAY if offset else "",
        numbers=numbers,
    )


def beside_other_way(one: Finding) -> Finding:
    """Return that a trial goes one way, as no fault where another goes the other way."""
    way = "forward" if one.numbers["forward_share"] else "backward"
    sentence = f"No reversals: the motion goes {way} only, and that of other trials the other way."
    return replace(one, severity="info", sentence=sentence, measure="")


def straight(record: Measurement) -> Iterator[Finding]:
    """Say on which line positions in a plane were projected, and whether they lie along it."""
    line = record.line
    if line is None:
        return
    bent = line.wander > max(BENT * line.length, line.jitter)
    tilt, across = f"{number(float(np.degrees(line.tilt)))}°", quantity(line.across, "m")
    way = (
        f"Position is the coordinate along a line of {quantity(line.length, 'm')}, tilted by {tilt}"
    )
    ahead = travels(np.asarray(record.values("position")))
    text = f"{way}; the samples deviate from it by {across} (root mean square). Positive is"
    text += " the direction of " + (
        "the net travel." if ahead else "its first move; a gain of −1 reverses it."
    )
    if bent:
        text = (
            f"The motion is not straight: it deviates by {quantity(line.wander, 'm')} (root mean"
            f" square) from its line of {quantity(line.length, 'm')}, tilted by {tilt}. The body"
            " rotated, its track is curved, or the camera was not perpendicular to the plane of"
            " motion."
        )
    yield Finding(
        kind="line",
        severity="warning" if bent else "info",
        sentence=text,
        measure="Record a straight motion, with the camera perpendicular to it" if bent else "",
        numbers={
            "tilt": line.tilt,
            "length": line.length,
            "across": line.across,
            "jitter": line.jitter,
        },
    )


def rests(motion: Motion) -> Iterator[Finding]:
    """Say for how long nothing moves."""
    durations, span = motion.rests, float(motion.time[-1] - motion.time[0])
    if not durations.size:
        text = f"No periods of rest of {SHORTEST} samples or more."
        yield Finding(kind="rests", sentence=text, numbers={"duration": 0.0})
        return
    total, still = float(np.sum(durations)), motion.hardly_moves
    text = f"At rest for {quantity(total, 's')} of {quantity(span, 's')} ({percent(total / span)}),"
    text += f" in {count(int(durations.size), 'period')}"
    yield Finding(
        kind="rests",
        severity="warning" if still else "info",
        sentence=f"{text}: {LITTLE}." if still else f"{text}.",
        measure="Record more of the motion" if still else "",
        numbers={"duration": total, "share": total / span, "stretches": durations.size},
    )


def readings(record: Measurement) -> Iterator[Finding]:
    """Say that rows seem to be steady readings, and no samples of a motion."""
    friction, velocity, time = record.friction, record.velocity, record.time
    if time is None or not (isinstance(friction, np.ndarray) and isinstance(velocity, np.ndarray)):
        return
    if {*record.quantities()} & {"position", "force", "pull", "spring_force"}:
        return
    if not are_steady_readings(time, velocity, friction):
        return
    yield Finding(
        kind="steady readings",
        severity="warning",
        sentence=(
            f"The rows, one every {quantity(interval_of(time), 's')} and each at another speed,"
            " seem to be steady readings of friction, not samples of one motion: filters then mix"
            " what was measured at different speeds. Leave the time out, as in a rig file with"
            ' columns = { time = "" }.'
        ),
        measure="Sample a motion more often, or leave the times of steady readings out",
        numbers={"interval": interval_of(time)},
    )


def slow(motion: Motion) -> Iterator[Finding]:
    """Say how much of the record is slow, where laws differ most."""
    # the filter leaves nothing of single slow samples
    speed = np.abs(motion.velocity if motion.measured is None else motion.measured)
    fastest = motion.fastest
    if fastest == 0.0:
        return
    share, unit = float(np.mean(speed < SLOW * fastest)), motion.unit
    text = f"{percent(share)} of the samples are slower than {quantity(SLOW * fastest, unit)},"
    text += f" 5 % of the largest speed of {quantity(fastest, unit)}"
    text += "." if share else ": this record does not determine friction near zero velocity."
    yield Finding(kind="low speed", sentence=text, numbers={"share": share, "fastest": fastest})
