"""Motion and the forces that go with it: whether signals of a record fit each other.

1. Motion: its directions, rests and slow parts.
2. Signals of one quantity: velocity and position, friction and load.
3. Dynamics: the force that the inertia needs beside those that are known, energy that comes from
   nowhere, and factors that look like units.
"""

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from stickslip.data.checking.finding import OTHER_WAY, TURN, Finding, Severity, remark
from stickslip.data.differentiation import (
    CUTOFF,
    PADDED,
    acceleration_of,
    between_gaps,
    interval_of,
    noise_of,
    smooth,
    step_of,
    velocity_of,
    without_outliers,
)
from stickslip.data.measurement import ELECTRIC, Array, Measurement, travels
from stickslip.data.rig import COMMANDS
from stickslip.data.tolerances import (
    DECADE,
    FEW_SAMPLES,
    FEWEST,
    FEWEST_SAMPLES,
    HALF,
    MOSTLY,
    NEARLY_ALL,
    NEGLIGIBLE,
    PER_MILLE,
    SLIGHT,
    SMALL,
)
from stickslip.mechanisms import Axis, MatrixMechanism, Mechanism, stops_of
from stickslip.quantities import turned, vary
from stickslip.show.formatting import count, number, percent, quantities, quantity

GRAVITY: Final = 9.81
"""Acceleration of weights that are not given otherwise [m/s^2]."""
SWING: Final = 0.005
"""Way over the whole stroke that a direction must last to be believed."""
SURE: Final = 5.0
"""Standard deviations of its noise that a speed must have to be one."""
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
    cutoff: float | None = None
    """Corner of the filter that positions passed [Hz]; None for the usual one."""

    @property
    def fastest(self) -> float:
        """The largest speed [m/s], single samples left out in long records."""
        speed = np.abs(self.velocity)
        return float(np.quantile(speed, 0.999)) if speed.size > 5000 else float(speed.max())

    @property
    def sure(self) -> float:
        """Speed above which a direction is believed [m/s]."""
        return max(NEGLIGIBLE * self.fastest, SURE * self.noise)

    @property
    def is_clear(self) -> bool:
        """Whether its noise is slight beside the largest speed, so that speeds are compared."""
        return self.noise < SLIGHT * self.fastest

    @cached_property
    def directions(self) -> NDArray[np.int64]:
        """1, -1, or 0 where the speed is too low or the way too short to tell."""
        result = np.sign(np.where(np.abs(self.velocity) > self.sure, self.velocity, 0.0)).astype(
            int
        )
        first = np.flatnonzero(np.diff(result, prepend=2))
        # The way in each direction: integrals of the velocity between its changes of sign.
        steps = np.diff(self.time, append=self.time[-1]) * self.velocity
        ways = np.add.reduceat(steps, first)
        path = np.cumsum(steps)
        # A filter swings about a velocity that jumps, by a little way.
        short = np.abs(ways) < SWING * float(np.ptp(path))
        return np.where(np.repeat(short, np.diff(first, append=result.size)), 0, result)

    @cached_property
    def rests(self) -> Array:
        """Durations (k,) [s] of the periods in which nothing moves.

        A body that turns is no slower than twice a speed for twice as long as than the speed, half
        of it on either side; at rest, it is hardly any longer.
        """
        slow = max(PER_MILLE * self.fastest, SURE * self.noise)
        (first, end), (wide, wide_end) = self._slower(slow), self._slower(2.0 * slow)
        at = np.searchsorted(wide, first, side="right") - 1
        speeds = np.pad(self.velocity, 1)  # 0 beyond the ends of the record
        opposite = speeds[wide[at]] * speeds[wide_end[at] + 1] <= 0.0
        beside = 0.25 * (end - first)
        before = (first - wide[at] >= beside) | (first == 0)
        after = (wide_end[at] - end >= beside) | (end == self.time.size)
        turns = opposite & before & after & (end - first < self.time.size)
        rests = (end - first >= FEWEST_SAMPLES) & ~turns
        return np.asarray((self.time[end - 1] - self.time[first])[rests])

    def _slower(self, speed: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return where stretches slower than a speed begin (k,), and where they have ended."""
        still = np.abs(self.velocity) <= speed
        # Padded, so that stretches at the ends of the record count.
        edges = np.flatnonzero(np.diff(np.pad(still.astype(int), 1)))
        return edges[::2], edges[1::2]

    @property
    def hardly_moves(self) -> bool:
        """Whether the body rests for most of the record: friction is what is applied to it then."""
        return bool(np.sum(self.rests) > NEARLY_ALL * (self.time[-1] - self.time[0]))


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
    blur, corner, cutoff = noise_of(position, step_of(position)), CUTOFF, None
    result = velocity_of(record)
    while True:
        # The same for the derivative, whose spectrum grows with the frequency squared.
        noise = blur * 2 * np.pi * np.sqrt(2 * corner**3 / 3) / dt
        moving = Motion(time=time, velocity=result, noise=float(noise), unit=unit, cutoff=cutoff)
        corner, enough = corner / 2, SURE * noise <= SLIGHT * moving.fastest
        if enough or corner * time.size < PADDED:
            return moving
        # A coarse encoder has a filter so low that it takes off no more than its noise.
        cutoff = corner / dt
        smoothed = smooth(time, position, cutoff)
        if float(np.mean((position - smoothed) ** 2)) > blur**2:
            return moving
        result = np.gradient(smoothed, time)


def reversals(motion: Motion, *, offset: bool = True) -> Iterator[Finding]:
    """Count the changes of direction, and say what follows from there being none.

    Motion one way tells no friction level from a constant force: one that a fit looks for, or that
    a sensor of force may add. Where there is no such `offset`, nothing is lost.
    """
    seen = motion.directions[motion.directions != 0]
    if not seen.size:
        noise, fastest = quantities([motion.noise, motion.fastest], motion.unit)
        text = (
            f"The largest speed, {fastest}, is not significantly above its noise of {noise}:"
            " directions cannot be determined. Filter the position, or measure it with a finer"
            " resolution."
        )
        yield remark(
            "reversals",
            "warning",
            text,
            "Measure faster or larger motions",
            noise=motion.noise,
            fastest=motion.fastest,
        )
        return
    changes = int(np.count_nonzero(np.diff(seen)))
    numbers = {"reversals": changes, "forward_share": float(np.mean(seen > 0))}
    times = number(changes, 7) + " times" if changes > 1 else "once"
    share = percent(numbers["forward_share"])
    sentence = f"The direction changes {times}; {share} of the moving samples go forward."
    if not changes:
        sentence = f"No reversals: the motion goes {'forward' if seen[0] > 0 else 'backward'} only"
        sentence += ", so that friction level and offset cannot be separated." * offset or "."
    lost = offset and not changes
    yield remark("reversals", lost, sentence, OTHER_WAY, **numbers)


def beside_other_way(finding: Finding) -> Finding:
    """Return that a trial goes one way, as no fault where another goes the other way."""
    way = "forward" if finding.numbers["forward_share"] else "backward"
    sentence = f"No reversals: the motion goes {way} only, and that of other trials the other way."
    return replace(finding, severity="info", sentence=sentence, measure="")


def straight(record: Measurement) -> Iterator[Finding]:
    """Say on which line positions in a plane were projected, and whether they lie along it."""
    line = record.line
    if line is None:
        return
    bent = line.wander > max(NEGLIGIBLE * line.length, line.jitter)
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
    yield remark(
        "line",
        bent,
        text,
        "Record a straight motion, with the camera perpendicular to it",
        tilt=line.tilt,
        length=line.length,
        across=line.across,
        jitter=line.jitter,
    )


def rests(motion: Motion) -> Iterator[Finding]:
    """Say for how long nothing moves."""
    durations, span = motion.rests, float(motion.time[-1] - motion.time[0])
    if not durations.size:
        text = f"No periods of rest of {FEWEST_SAMPLES} samples or more."
        yield remark("rests", "info", text, duration=0.0)
        return
    total, still = float(np.sum(durations)), motion.hardly_moves
    text = f"At rest for {quantity(total, 's')} of {quantity(span, 's')} ({percent(total / span)}),"
    text += f" in {count(int(durations.size), 'period')}"
    yield remark(
        "rests",
        still,
        f"{text}: {LITTLE}." if still else f"{text}.",
        "Record more of the motion",
        duration=total,
        share=total / span,
        stretches=durations.size,
    )


def readings(time: Array) -> Finding:
    """Return that rows with times are read as steady readings, and no samples of a motion."""
    step = interval_of(time)
    text = (
        f"The rows, one every {quantity(step, 's')}, are taken for steady readings of friction:"
        " a table over the speed, in the order of their times. `--route balance` takes them for"
        " samples of one motion."
    )
    return remark("steady readings", "info", text, interval=step)


def slow(motion: Motion) -> Iterator[Finding]:
    """Say how much of the record is slow, where laws differ most."""
    # the filter leaves nothing of single slow samples
    speed = np.abs(motion.velocity if motion.measured is None else motion.measured)
    fastest = motion.fastest
    if fastest == 0.0:
        return
    share, unit = float(np.mean(speed < SLIGHT * fastest)), motion.unit
    text = f"{percent(share)} of the samples are slower than {quantity(SLIGHT * fastest, unit)},"
    text += f" 5 % of the largest speed of {quantity(fastest, unit)}"
    text += "." if share else ": this record does not determine friction near zero velocity."
    yield remark("low speed", "info", text, share=share, fastest=fastest)


# Signals that must fit each other: velocity and position, forces and motion, friction and load.

KNOWN: Final = (
    (1e3, "velocity looks like mm/s"),
    (1e6, "velocity looks like µm/s"),
    (1e2, "velocity looks like cm/s"),
    (60.0, "velocity looks like m/min"),
    (3.6, "velocity looks like km/h"),
    (1e-3, "position looks like mm"),
    (1e-6, "position looks like µm"),
    (1e-2, "position looks like cm"),
)


def velocity_and_position(record: Measurement) -> Iterator[Finding]:
    """Compare a measured velocity with the derivative of the measured position."""
    time = record.time
    if time is None or record.position is None or record.velocity is None or time.size < 20:
        return
    derived = np.gradient(smooth(time, np.asarray(record.values("position"))), time)
    measured = smooth(time, np.asarray(record.values("velocity")))
    power = float(derived @ derived)
    if power == 0.0 or not measured.any():
        return
    # least squares through 0, either way: noise of the derivative lowers this, that of the velocity
    # raises the other, and the true factor lies between
    factor = float(derived @ measured) / power
    alike = float(derived @ measured) / float(np.sqrt(power * (measured @ measured)))
    numbers = {"factor": factor, "correlation": alike}
    severity: Severity = "info"
    if abs(alike) < NEARLY_ALL:
        sentence = (
            "Velocity does not follow the derivative of position (correlation"
            f" {number(alike, 2)}): the two belong to different bodies, are delayed, or have"
            " different time bases."
        )
        severity = "warning"
    elif factor <= 1.0 + SMALL and factor / alike**2 >= 1.0 - SMALL:
        sentence = "Velocity agrees with the derivative of position"
        sentence += f" (factor {number(factor)}, correlation {number(alike)})."
    else:
        sentence = f"Velocity is {number(factor)} times the derivative of position"
        sentence += f"{_guess(factor)}: state its unit or a gain."
        severity = "error"
    yield remark("velocity", severity, sentence, **numbers)


def _guess(factor: float) -> str:
    """Return what a factor between the two suggests."""
    for known, words in KNOWN:
        if abs(abs(factor) / known - 1.0) < SMALL:
            return f" ({words}{', with the opposite sign' if factor < 0 else ''})"
    return " (the signs are opposite)" if abs(factor + 1.0) <= SMALL else ""


def friction_sign(record: Measurement, motion: Motion | None) -> Iterator[Finding]:
    """Compare the sign of friction with that of the velocity."""
    if motion is None or not isinstance(record.friction, np.ndarray):
        return
    direction = motion.directions
    moving = direction != 0
    if not moving.any():
        return
    friction = np.asarray(record.values("friction"))
    product = friction[moving] * direction[moving]
    against, along = float(np.mean(product < 0)), float(np.mean(product > 0))
    power = friction * motion.velocity
    # Springs of the surface give back what they took, so that only the sum tells.
    taken = float(np.sum(power) / np.sum(np.abs(power))) if power.any() else 0.0
    numbers = {"opposite_share": against, "same_share": along, "work": taken}
    severity: Severity = "info"
    sentence = f"Friction has the sign of the velocity on {percent(along)} of the moving samples."
    if against > MOSTLY or (against > 0.5 and taken < -HALF):
        severity = "error"
        sentence = (
            f"Friction is opposite in sign to the velocity on {percent(against)} of the"
            " moving samples"
        )
        sentence += " and would supply energy. Sign convention: friction has the sign of the"
        sentence += f" slip velocity; {TURN}."
    elif along < 0.5:
        severity = "warning"
        sentence = f"Friction has the sign of the velocity on only {percent(along)} of the moving"
        sentence += " samples: check for an offset, a delay, or opposite sign conventions."
    yield remark("friction sign", severity, sentence, **numbers)


# Forces that must fit the motion: one that is missing, energy from nowhere, factors of units.

OTHERS: Final = ("friction", "spring_force", "pull")
"""With one of these a record says by itself what acts; friction needs no drive."""
IMPOSSIBLE: Final = 300.0
"""Factor between a force and the motion it causes that units make, and no mass known badly."""


def missing(record: Measurement, mechanism: Mechanism | None) -> Iterator[Finding]:
    """Say that nothing was recorded that could drive a motion, nor does the mechanism."""
    known = record.quantities()
    moved = "position" in known or "velocity" in known
    if record.time is None or not moved or {*known} & {*COMMANDS, *OTHERS}:
        return
    if mechanism is not None and mechanism.drives():
        return
    text = (
        "Neither force nor reference is given: a fit treats the motion as undriven, such as a"
        " free decay."
    )
    yield remark("drive", "info", text)


def has_offset(record: Measurement, mechanism: Mechanism | None) -> bool:
    """Whether a constant force may stand beside friction in a record.

    A sensor of force may have one, and so may the mechanism; one that drives itself, and whose
    position alone was recorded, has the forces that its parameters say.
    """
    measured = {*record.quantities()} & {*COMMANDS, *OTHERS}
    return bool(measured) or mechanism is None or "offset" in mechanism.__dataclass_fields__


def energy(record: Measurement, mechanism: Mechanism | None) -> Iterator[Finding]:
    """Doubt a motion that gains energy, or keeps it, where nothing drives it.

    At one position springs hold the same energy every time, so that without a drive no later
    passage can be faster; without a spring no speed can rise and fall again.
    """
    if not _undriven(record) or (mechanism is not None and not _passive(mechanism, record)):
        return
    gained, kept, rose = _sizes(record, mechanism)
    swing = swing_of(record) if mechanism is not None and rose > SMALL >= gained else None
    if swing is not None and mechanism is not None:
        yield _swinging(swing, record, mechanism)
        return
    forced = "force" in record.quantities()
    which = "its force is constant" if forced else "no drive is recorded"
    severity: Severity = "warning" if mechanism is None else "error"
    if gained > SMALL:
        sentence = (
            f"The motion gains energy although {which}: it passes the same positions at a higher"
            f" speed than before and gains {percent(gained)} of its largest energy. Check whether"
            " the force is missing, or whether the record begins before the release."
        )
    elif rose > SMALL:
        sentence = (
            f"The speed rises and falls, by {percent(rose)} of the largest, although {which} and"
            " the mechanism has no spring. Check whether the force is missing, or the stiffness of"
            " the mechanism."
        )
    elif kept > NEARLY_ALL:
        severity = "warning"
        sentence = (
            f"The motion keeps {percent(kept)} of its energy over {FEWEST_SAMPLES} passages or more"
            f" although {which}: check whether the force is missing."
        )
    else:
        return
    yield remark("drive", severity, sentence, gained=gained, turned=rose, kept=kept)


def _swinging(swing: "Swing", record: Measurement, mechanism: Mechanism) -> Finding:
    """Return that a body swings by itself on a mechanism that nothing pulls back."""
    spring = swing.stiffness * _mass(mechanism)
    cure = f'give it stiffness = "{number(spring)} {turned("N/m", record.turning)}"'
    if record.turning:
        cure = f'make it a pendulum, as with length = "{number(swing.length)} m", or {cure}'
    text = (
        f"The body swings by itself, at {quantity(swing.frequency, 'Hz')} in small swings, and"
        f" the mechanism has no spring and no weight: {cure}."
    )
    return remark("mechanism", "error", text, frequency=swing.frequency, stiffness=spring)


def _sizes(record: Measurement, mechanism: Mechanism | None) -> tuple[float, float, float]:
    """Return what energy is gained and kept, and what speed goes both ways, as shares."""
    gained, kept, turned = 0.0, 0.0, 0.0
    for part in between_gaps(record):
        moving = motion_of(part) if np.asarray(part.time).size >= FEW_SAMPLES else None
        if moving is None or not moving.is_clear:
            continue
        position = _positions(part)
        if part.position is not None:
            rise, left = _passages(position, moving)
            gained, kept = max(gained, rise), max(kept, left)
        if mechanism is not None and _is_flat(mechanism, record, position, moving):
            turned = max(turned, _turned(moving))
    return gained, kept, turned


def _undriven(record: Measurement) -> bool:
    known = {*record.quantities()}
    if (
        record.time is None
        or known & {"reference", *ELECTRIC, *OTHERS}
        or not known & {"position", "velocity"}
    ):
        return False
    return "force" not in known or float(np.ptp(record.values("force"))) == 0.0


def _passive(mechanism: Mechanism, record: Measurement) -> bool:
    """Whether a mechanism is one body that nothing but a drive moves, and has none.

    A recorded force takes the place of a drive of its own.
    """
    if len(mechanism.coordinates) != 1 or "drive" not in mechanism.__dataclass_fields__:
        return False
    if mechanism.drives() and "force" not in record.quantities():
        return False
    return bool(_at_rest(mechanism, 0.0) == _at_rest(mechanism, 1.0))  # nor does time


def _at_rest(mechanism: Mechanism, time: float) -> tuple[Any, Any]:
    """Return energy and force at rest at 0."""
    (name,) = mechanism.coordinates
    none: Any = defaultdict(float)
    forces = mechanism.forces(time, none, none, {"drive": 0.0})
    return mechanism.potential_energy(time, none), forces.get(name, 0.0)


def _positions(record: Measurement) -> Array:
    """Return positions (n,) [m], from the velocity where only that was measured."""
    if record.position is not None:
        return np.asarray(record.values("position"))
    v, t = np.asarray(record.values("velocity")), np.asarray(record.time)
    return np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])


def _passages(position: Array, moving: Motion) -> tuple[float, float]:
    """Return what energy is gained at one position, and what is left, over the largest energy.

    Both are medians over positions; what is left counts where a position is passed often. What
    noise makes of as many passages is no gain. Ends of the filter, a period of its corner, are
    left out: it knows no speed before a release.
    """
    ends = slice(round(1 / CUTOFF), -round(1 / CUTOFF))
    position, v, most = position[ends], moving.velocity[ends], moving.fastest**2
    rises, left = [], []
    for level in np.linspace(position.min(), position.max(), FEW_SAMPLES + 2)[1:-1]:
        apart = position - level
        at = np.flatnonzero(apart[:-1] * apart[1:] < 0.0)
        if at.size < 2:
            continue
        # Speeds are compared at the level itself, between samples.
        share = apart[at] / (apart[at] - apart[at + 1])
        squares = (v[at] + share * (v[at + 1] - v[at])) ** 2
        rise = float(np.max(squares - np.minimum.accumulate(squares)))
        # Noise of a square is 2 v dv, and its range that of as many samples.
        noise = 2.0 * float(np.sqrt(np.mean(squares))) * _range_of_noise(moving, at.size)
        rises.append(max(rise - noise, 0.0) / most)
        if at.size >= FEWEST_SAMPLES and squares[0] > SMALL * most:
            left.append(float(squares[-1] / squares[0]))
    gained, kept = (float(np.median(x)) if len(x) >= FEWEST else 0.0 for x in (rises, left))
    return gained, kept


def _turned(moving: Motion) -> float:
    """Return by how much a velocity goes both ways, over the largest.

    With nothing but friction and a constant force its rate depends on itself alone: it can only
    fall, or only rise. What noise makes, the range of as many samples of it, is left out.
    """
    v = moving.velocity
    up = float(np.max(v - np.minimum.accumulate(v)))
    down = float(np.max(np.maximum.accumulate(v) - v))
    return max(min(up, down) - _range_of_noise(moving, v.size), 0.0) / moving.fastest


def _range_of_noise(moving: Motion, count: int) -> float:
    """Return between which velocities [m/s] the noise of as many samples lies."""
    # Extremes of n normal numbers lie near sqrt(2 ln n) standard deviations.
    return 2.0 * math.sqrt(2.0 * math.log(count)) * moving.noise


def _is_flat(mechanism: Mechanism, record: Measurement, x: Array, moving: Motion) -> bool:
    """Whether no force of a mechanism depends on its position, as far as the motion goes."""
    mechanism = vary(mechanism, "mechanism", record.overrides)
    if stops_of(mechanism):
        return False
    pull = _pull(mechanism, np.linspace(x.min(), x.max(), FEW_SAMPLES))
    work = float(np.ptp(pull)) * float(np.ptp(x))
    return work < NEGLIGIBLE * 0.5 * _mass(mechanism) * moving.fastest**2


def _mass(mechanism: Mechanism) -> float:
    (name,) = mechanism.coordinates
    none: Any = defaultdict(float)
    return 2.0 * float(mechanism.kinetic_energy(none, defaultdict(float, {name: 1.0})))


def _pull(mechanism: Mechanism, x: Array) -> Array:
    """Return the force (n,) of a mechanism at rest at positions, without a drive."""
    (name,) = mechanism.coordinates
    at: Any = defaultdict(float, {name: x})
    own: Any = mechanism.forces(0.0, at, defaultdict(float), {"drive": 0.0}).get(name, 0.0)
    if isinstance(mechanism, MatrixMechanism):  # its forces are all of them
        return np.asarray(own + 0.0 * x)
    # Central differences of the potential, by a millionth of the way.
    h = 1e-6 * max(float(np.ptp(x)), 1e-9)
    ahead, back = (
        mechanism.potential_energy(0.0, defaultdict(float, {name: x + side * h})) + 0.0 * x
        for side in (1.0, -1.0)
    )
    return np.asarray(own - (ahead - back) / (2.0 * h) + 0.0 * x)


def inertia_of(record: Measurement) -> float | None:
    """Return the inertia of an axis that moves as it did under the forces of a record.

    Examples
    --------
    >>> t = np.arange(500) / 100
    >>> force = 10.0 * np.cos(4.0 * t) + np.sign(np.sin(4.0 * t))
    >>> record = Measurement(time=t, velocity=1.25 * np.sin(4.0 * t), force=force)
    >>> round(inertia_of(record), 2)
    2.0
    """
    known = record.quantities()
    if "force" not in known or record.time is None or not {"position", "velocity"} & {*known}:
        return None
    moving = motion_of(record)
    if moving is None or not moving.is_clear:
        return None
    factor, share = _factor(Axis(inertia=1.0), record, moving)
    return factor if share >= HALF and factor > 0.0 else None


@dataclass(frozen=True, kw_only=True)
class Swing:
    """How a body swings, or would if nothing drove it."""

    stiffness: float
    """Stiffness over the inertia [1/s^2]; of a pendulum for small swings."""
    rest: float
    """Position where nothing pulls [m] or [rad]."""
    inertia: float | None = None
    """Moment of inertia [kg m^2], where a torque tells it."""

    @property
    def frequency(self) -> float:
        """Of small swings [Hz]."""
        return math.sqrt(self.stiffness) / (2.0 * math.pi)

    @property
    def length(self) -> float:
        """Of a pendulum that swings like this with all of its mass at its end [m]."""
        return GRAVITY / self.stiffness


def swing_of(record: Measurement) -> Swing | None:
    """Return how a free motion swings, or a driven one about an axis that is pulled by its weight.

    The acceleration is regressed on sine and cosine of the angle, or on the place, beside friction
    and a torque. None where the speed of a free motion does not rise and fall, or where that takes
    little off what is left.

    Examples
    --------
    >>> t = np.arange(1000) / 100
    >>> found = swing_of(Measurement(time=t, position=0.2 + np.exp(-0.05 * t) * np.cos(4.0 * t)))
    >>> round(found.stiffness), round(found.rest, 2)
    (16, 0.2)
    """
    from scipy.interpolate import make_interp_spline

    free = _undriven(record)
    driven = record.turning and "force" in record.quantities() and record.time is not None
    if record.trials or record.joints or not (free or driven):
        return None
    record, _ = without_outliers(record)
    moving = motion_of(record)
    if moving is None or not moving.is_clear:
        return None
    if free and _turned(moving) <= SMALL:
        return None
    x, t = _positions(record), moving.time
    # Both sides through one low pass, without the ends, beyond which it guesses the motion.
    corner, low = moving.cutoff, partial(smooth, t, cutoff=moving.cutoff)
    padded = PADDED / (corner * interval_of(t) if corner else CUTOFF)
    inner = slice(*np.array([1, -1]) * min(round(padded), x.size // 4))
    a = make_interp_spline(t, low(x), k=5).derivative(2)(t)[inner]
    pulls = [np.sin(x), np.cos(x)] if record.turning else [x, np.ones_like(x)]
    beside = [moving.velocity / moving.fastest, moving.directions]
    if not free:
        beside += [np.asarray(record.values("force")), np.ones_like(x)]
    table = np.stack([low(pull)[inner] for pull in (*pulls, *beside)], axis=1)
    result, plain = np.linalg.lstsq(table, a, rcond=None)[0], table[:, 2:]
    first, second, *others = result
    left, without = a - table @ result, a - plain @ np.linalg.lstsq(plain, a, rcond=None)[0]
    if float(left @ left) > (1.0 - HALF) * float(without @ without):
        return None
    if not record.turning:
        slope = -float(first)
        return Swing(stiffness=slope, rest=float(second) / slope) if slope > 0.0 else None
    if not free:  # a torque that tells no inertia tells no weight: another joint may use it
        aside = np.delete(table, 4, axis=1)
        both = np.stack([a, table[:, 4]], axis=1)
        both -= aside @ np.linalg.lstsq(aside, both, rcond=None)[0]
        told = float(both[:, 0] @ both[:, 1]) ** 2
        sure = told >= HALF * float(np.prod(np.sum(both**2, axis=0)))
        if others[2] <= 0.0 or not sure:  # or a torque that does not vary, or drives backward
            return None
    given = None if free else 1.0 / float(others[2])
    rest = math.atan2(float(second), -float(first))
    return Swing(stiffness=math.hypot(first, second), rest=rest, inertia=given)


def proportion(record: Measurement, mechanism: Mechanism | None) -> Iterator[Finding]:
    """Compare a force with what a mechanism takes to move as it did, friction left aside.

    A force of the other sign is refused by the judge.
    """
    known = record.quantities()
    if mechanism is None or "force" not in known or record.time is None:
        return
    if len(mechanism.coordinates) != 1 or not {"position", "velocity"} & {*known}:
        return
    if "drive" not in mechanism.__dataclass_fields__ or stops_of(mechanism):
        return
    moving = motion_of(record)
    if moving is None or not moving.is_clear:
        return
    factor, share = _factor(vary(mechanism, "mechanism", record.overrides), record, moving)
    if share < HALF or factor < 0.0 or 1.0 / DECADE < factor < DECADE:
        return
    cure = "check that position is in m (not mm), force in N (not kN)"
    if factor > 1.0:
        cure = "check that time is in s (not ms), position in m, force in N (not mN)"
    severity: Severity = "error" if max(factor, 1.0 / factor) >= IMPOSSIBLE else "warning"
    unit = turned("kg", record.turning)
    text = (
        f"Force is {number(factor, 2)} times the force that this motion of the mechanism"
        f" requires: {cure}, and that {number(_mass(mechanism))} {unit} is correct."
    )
    yield remark("units", severity, text, factor=factor, explained=share)


def _factor(mechanism: Mechanism, record: Measurement, moving: Motion) -> tuple[float, float]:
    """Return a force over what inertia and springs take, and the share of it so explained.

    What speed, direction and a constant explain is left out of both.
    """
    x, v = _positions(record), moving.velocity
    needed = _mass(mechanism) * acceleration_of(record) - _pull(mechanism, x)
    force = np.asarray(record.values("force"))
    others = np.stack([v / moving.fastest, moving.directions, np.ones(x.size)], axis=1)
    both = np.stack([needed, force], axis=1)
    sizes = np.max(np.abs(both), axis=0)
    if not np.all(np.isfinite(sizes)) or not np.all(sizes):
        return 1.0, 0.0
    both = both / sizes  # squares of numbers of any size are finite then
    left = both - others @ np.linalg.lstsq(others, both, rcond=None)[0]
    (a, f), cross = np.sum(left**2, axis=0), float(left[:, 0] @ left[:, 1])
    # What the regression leaves of a force that it explains are the last digits.
    if np.any(np.array([a, f]) <= 1e-12 * np.sum(both**2, axis=0)):
        return 1.0, 0.0
    return cross / float(a) * float(sizes[1] / sizes[0]), cross**2 / float(a * f)
