"""Signals that must fit each other: velocity and position, friction and the direction of slip."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from stickslip.experiments.checking.finding import TURN, Finding, Severity
from stickslip.experiments.checking.motion import Motion
from stickslip.experiments.differentiation import smooth
from stickslip.experiments.measurement import Measurement
from stickslip.formatting import number, percent

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
