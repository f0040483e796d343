"""Signals that must fit each other: velocity and position, forces and motion, friction and load."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from stickslip.experiments.checking.finding import TURN, Finding, Severity
from stickslip.experiments.checking.motion import Motion
from stickslip.experiments.differentiation import acceleration_of, smooth
from stickslip.experiments.measurement import Measurement
from stickslip.formatting import number, percent, quantity
from stickslip.mechanisms import Mechanism, load_stated
from stickslip.quantities import turned

ALIKE: Final = 0.9
"""Correlation from which two velocities are one and the same but for a factor."""
OFF: Final = 0.1
OPPOSITE: Final = 0.8
"""Share of the moving samples with friction against the sign rule from which the sign is wrong."""
HALF: Final = 0.5
"""Energy given out over all that changes hands, from which the sign is wrong as well."""
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
    factor = float(derived @ measured) / power
    alike = float(derived @ measured) / float(np.sqrt(power * (measured @ measured)))
    numbers = {"factor": factor, "correlation": alike}
    severity: Severity = "info"
    if abs(alike) < ALIKE:
        sentence = (
            "Velocity does not follow the derivative of position (correlation"
            f" {number(alike, 2)}): the two belong to different bodies, are delayed, or have"
            " different time bases."
        )
        severity = "warning"
    elif abs(factor - 1.0) <= OFF:
        sentence = "Velocity agrees with the derivative of position"
        sentence += f" (factor {number(factor)}, correlation {number(alike)})."
    else:
        sentence = f"Velocity is {number(factor)} times the derivative of position"
        sentence += f"{_guess(factor)}: state its unit or a gain."
        severity = "error"
    yield Finding(kind="velocity", severity=severity, sentence=sentence, numbers=numbers)


def _guess(factor: float) -> str:
    """Return what a factor between the two suggests."""
    for known, words in KNOWN:
        if abs(abs(factor) / known - 1.0) < OFF:
            return f" ({words}{', with the opposite sign' if factor < 0 else ''})"
    return " (the signs are opposite)" if abs(factor + 1.0) <= OFF else ""


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
    if against > OPPOSITE or (against > 0.5 and taken < -HALF):
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
    yield Finding(kind="friction sign", severity=severity, sentence=sentence, numbers=numbers)


EXPLAINED: Final = 0.5
"""Share of a force that the motion must explain, for its sign to be told."""
GIVEN_OUT: Final = 0.1
"""Energy that friction would give out, over all that the force exchanges, from which it is told."""
BOTH_WAYS: Final = 0.05
"""Share of the samples in each direction; in one alone, a level cannot be told from an offset."""
ONE_SINE: Final = 0.95
"""Correlation from which acceleration and displacement are one, as those of a single sine."""
LARGEST: Final = 2.0
"""Coefficients of friction hardly exceed this."""
LEAST_LOAD: Final = 10.0
"""Load [N] above which forces and coefficients are of different sizes."""
SMALL: Final = 0.1
"""Friction over load below which a coefficient is the likelier reading."""


def direction(record: Measurement, motion: Motion | None) -> Iterator[Finding]:
    """Doubt the sign of a force that seems to move a negative inertia against negative friction.

    Springs and a constant are left aside; no passive mechanism has both.
    """
    known = {*record.quantities()}
    if motion is None or "force" not in known or known & {"friction", "spring_force", "pull"}:
        return
    ways = motion.directions
    if min(float(np.mean(ways > 0)), float(np.mean(ways < 0))) < BOTH_WAYS:
        return
    force, v, a = np.asarray(record.values("force")), motion.velocity, acceleration_of(record)
    steps = np.diff(motion.time, prepend=motion.time[0])
    columns = np.stack([a, ways, v, np.ones(v.size), np.cumsum(v * steps)], axis=1)
    if abs(float(np.corrcoef(a, columns[:, -1])[0, 1])) > ONE_SINE:
        columns = columns[:, :-1]
    size = np.sqrt(np.mean(columns**2, axis=0))
    if not (size > 0.0).all() or not np.ptp(force):
        return
    found = np.linalg.lstsq(columns / size, force, rcond=None)[0] / size
    left = force - columns @ found
    explained = 1.0 - float(np.var(left) / np.var(force))
    rubbed = found[1] * ways + found[2] * v
    work = float(np.sum(rubbed * v) / np.sum(np.abs(force * v)))
    if found[0] >= 0.0 or work > -GIVEN_OUT or explained < EXPLAINED:
        return
    inertia = f"{number(float(found[0]), 2)} {turned('kg', record.turning)}"
    yield Finding(
        kind="force sign",
        severity="warning",
        sentence=(
            f"Force acts against the motion: {percent(explained)} of it corresponds to an inertia"
            f" of {inertia} and to friction that supplies energy. Check its sign (if it is wrong,"
            f" {TURN}), and which quantity each column holds."
        ),
        numbers={"inertia": float(found[0]), "work": work, "explained": explained},
    )


def coefficient(record: Measurement, mechanism: Mechanism | None) -> Iterator[Finding]:
    """Doubt friction that is a small share of its load and of the size of a coefficient."""
    if record.friction is None:
        return
    if record.load is None:
        load = load_stated(mechanism, record.overrides)
    else:
        load = float(np.median(np.atleast_1d(record.values("load"))))
    largest = float(np.abs(np.atleast_1d(record.values("friction"))).max())
    if load is None or load <= LEAST_LOAD or not 0.0 < largest < min(LARGEST, SMALL * load):
        return
    most, pressed = quantity(largest, record.unit("friction")), quantity(load, "N")
    yield Finding(
        kind="units",
        severity="warning",
        sentence=(
            f"Friction reaches {most} at a load of {pressed}, {percent(largest / load)} of it. If"
            " the values are friction coefficients, state their unit as 1: they are then"
            " multiplied by the load."
        ),
        numbers={"friction": largest, "load": load},
    )
