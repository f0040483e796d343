"""Forces that must fit the motion: one that is missing, energy from nowhere, factors of units."""

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from stickslip.experiments.checking.finding import TURN, Finding, Severity
from stickslip.experiments.checking.motion import Motion, motion_of
from stickslip.experiments.differentiation import CUTOFF, acceleration_of
from stickslip.experiments.measurement import ELECTRIC, Array, Measurement
from stickslip.experiments.recorded_drive import COMMANDS
from stickslip.experiments.slicing import between_gaps
from stickslip.formatting import number, percent
from stickslip.mechanisms import Axis, MatrixMechanism, Mechanism, stops_of
from stickslip.quantities import turned, vary

OTHERS: Final = ("friction", "spring_force", "pull")
"""With one of these a record says by itself what acts; friction needs no drive."""
LEVELS: Final = 31
"""Positions at which speeds are compared."""
FEWEST: Final = 3
"""... of which so many must be passed twice."""
GAINED: Final = 0.1
"""Energy gained at one position, over the largest there is, that neither noise nor filters make."""
CLEAR: Final = 20.0
"""The largest speed over its noise, from which speeds are compared at all."""
LASTING: Final = 10
"""Passages of one position in which a motion should lose energy."""
KEPT: Final = 0.9
"""Share of the energy left after these that is doubted."""
FLAT: Final = 0.01
"""Work of a mechanism's own forces over the kinetic energy, below which it has none."""
EXPLAINED: Final = 0.5
"""Share of a force that the motion must explain; noise then hides at most half of a factor."""
DOUBTED: Final = 10.0
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
    yield Finding(
        kind="drive",
        sentence=(
            "Neither force nor reference is given: a fit treats the motion as undriven, such as a"
            " free decay."
        ),
    )


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
    gained, kept, turned = _sizes(record, mechanism)
    forced = "force" in record.quantities()
    which = "its force is constant" if forced else "no drive is recorded"
    severity: Severity = "warning" if mechanism is None else "error"
    if gained > GAINED:
        sentence = (
            f"The motion gains energy although {which}: it passes the same positions at a higher"
            f" speed than before and gains {percent(gained)} of its largest energy. Check whether"
            " the force is missing, or whether the record begins before the release."
        )
    elif turned > GAINED:
        sentence = (
            f"The speed rises and falls, by {percent(turned)} of the largest, although {which} and"
            " the mechanism has no spring. Check whether the force is missing, or the stiffness of"
            " the mechanism."
        )
    elif kept > KEPT:
        severity = "warning"
        sentence = (
            f"The motion keeps {percent(kept)} of its energy over {LASTING} passages or more"
            f" although {which}: check whether the force is missing."
        )
    else:
        return
    yield Finding(
        kind="drive",
        severity=severity,
        sentence=sentence,
        numbers={"gained": gained, "turned": turned, "kept": kept},
    )


def _sizes(record: Measurement, mechanism: Mechanism | None) -> tuple[float, float, float]:
    """Return what energy is gained and kept, and what speed goes both ways, as shares."""
    gained, kept, turned = 0.0, 0.0, 0.0
    for part in between_gaps(record):
        moving = motion_of(part) if np.asarray(part.time).size >= LEVELS else None
        if moving is None or moving.fastest <= CLEAR * moving.noise:
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
    for level in np.linspace(position.min(), position.max(), LEVELS + 2)[1:-1]:
        apart = position - level
        at = np.flatnonzero(apart[:-1] * apart[1:] < 0.0)
        if at.size < 2:
            continue
        share = apart[at] / (apart[at] - apart[at + 1])
        squares = (v[at] + share * (v[at + 1] - v[at])) ** 2
        rise = float(np.max(squares - np.minimum.accumulate(squares)))
        noise = 2.0 * float(np.sqrt(np.mean(squares))) * _range_of_noise(moving, at.size)
        rises.append(max(rise - noise, 0.0) / most)
        if at.size >= LASTING and squares[0] > GAINED * most:
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
    return 2.0 * math.sqrt(2.0 * math.log(count)) * moving.noise


def _is_flat(mechanism: Mechanism, record: Measurement, x: Array, moving: Motion) -> bool:
    """Whether no force of a mechanism depends on its position, as far as the motion goes."""
    mechanism = vary(mechanism, "mechanism", record.overrides)
    if stops_of(mechanism):
        return False
    pull = _pull(mechanism, np.linspace(x.min(), x.max(), LEVELS))
    work = float(np.ptp(pull)) * float(np.ptp(x))
    return work < FLAT * 0.5 * _mass(mechanism) * moving.fastest**2


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
    if moving is None or moving.fastest <= CLEAR * moving.noise:
        return None
    factor, share = _factor(Axis(inertia=1.0), record, moving)
    return factor if share >= EXPLAINED and factor > 0.0 else None


def proportion(record: Measurement, mechanism: Mechanism | None) -> Iterator[Finding]:
    """Compare a force with what a mechanism takes to move as it did, friction left aside."""
    known = record.quantities()
    if mechanism is None or "force" not in known or record.time is None:
        return
    if len(mechanism.coordinates) != 1 or not {"position", "velocity"} & {*known}:
        return
    if "drive" not in mechanism.__dataclass_fields__ or stops_of(mechanism):
        return
    moving = motion_of(record)
    if moving is None or moving.fastest <= CLEAR * moving.noise:
        return
    factor, share = _factor(vary(mechanism, "mechanism", record.overrides), record, moving)
    if share < EXPLAINED or 1.0 / DOUBTED < factor < DOUBTED:
        return
    cure = "check that position is in m (not mm), force in N (not kN)"
    severity: Severity = "warning"
    if factor < 0.0:
        cure = f"check its sign (if it is wrong, {TURN})"
    else:
        if factor > 1.0:
            cure = "check that time is in s (not ms), position in m, force in N (not mN)"
        severity = "error" if max(factor, 1.0 / factor) >= IMPOSSIBLE else "warning"
    unit = turned("kg", record.turning)
    yield Finding(
        kind="units",
        severity=severity,
        sentence=(
            f"Force is {number(factor, 2)} times the force that this motion of the mechanism"
            f" requires: {cure}, and that {number(_mass(mechanism))} {unit} is correct."
        ),
        numbers={"factor": factor, "explained": share},
    )


def compares_mass(finding: Finding) -> bool:
    """Whether a finding compares a force with what the mass takes to move, signs aside."""
    return "explained" in finding.numbers and finding.numbers.get("factor", -1.0) > 0.0


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
