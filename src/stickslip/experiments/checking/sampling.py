"""Times of the samples: how many, how evenly spaced, where some are missing."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from stickslip.experiments.checking.finding import Finding
from stickslip.experiments.differentiation import GAP, interval_of
from stickslip.experiments.measurement import Array, Measurement
from stickslip.formatting import count, number, percent, quantity

FEWEST: Final = 10
FEW: Final = 50
EVEN: Final = 0.01
"""Deviation of a step of time from the usual one, over it, that still counts as even."""
UNEVEN: Final = 0.2
SEEN: Final = 1e-5
"""Deviation below which only the last digits of the times differ."""
SHOWN: Final = 3
MILLISECONDS = " If they are in milliseconds, give --unit time=ms."
SLOWEST, FASTEST = 5.0, 1e6
"""Sampling frequencies [Hz] of forces and motions between which nobody wonders."""


def length(time: Array) -> Iterator[Finding]:
    """Say whether a record is too short for anything."""
    n = time.size
    if n >= FEW:
        return
    sentence = "estimates from so few samples are unreliable."
    if n < FEWEST:
        sentence = f"a fit needs at least {FEWEST}."
    yield Finding(
        kind="length",
        severity="error" if n < FEWEST else "warning",
        sentence=f"The record has only {count(n, 'sample')}: {sentence}",
        measure="Record more samples",
        numbers={"samples": n},
    )


def sampling(time: Array) -> Iterator[Finding]:
    """Say how many samples there are, at which rate, and how evenly spaced."""
    steps, dt = np.diff(time), interval_of(time)
    regular = steps[steps <= GAP * dt]
    off = np.abs(regular - dt) / dt
    worst, typical = float(off.max()), float(np.sqrt(np.mean(off**2)))
    odd = float(np.mean(off > 0.5))
    rate, span = 1.0 / dt, float(time[-1] - time[0])
    text = f"{count(time.size, 'sample')} at {quantity(rate, 'Hz')} over {quantity(span, 's')}"
    if worst <= EVEN:
        least = "below 0.001 %" if worst < SEEN else percent(worst)
        between = " between gaps" if regular.size < steps.size else ""
        text += f", evenly spaced{between} (largest deviation {least})."
    elif odd and odd < EVEN:
        missing = int(np.sum(np.rint(regular / dt) - 1))
        text += (
            f", evenly spaced except for {count(int(np.sum(off > 0.5)), 'step')}"
            f" ({count(missing, 'single sample')} missing)."
        )
    else:
        text += (
            f", with intervals that scatter by {percent(typical)} (largest deviation"
            f" {percent(worst)})."
        )
        if typical > UNEVEN:
            text += " Velocities derived from positions are unreliable."
    yield Finding(
        kind="sampling",
        severity="warning" if typical > UNEVEN else "info",
        sentence=text,
        measure="Record at even intervals" if typical > UNEVEN else "",
        numbers={
            "samples": time.size,
            "rate": rate,
            "duration": span,
            "largest_deviation": worst,
            "scatter": typical,
        },
    )


def gaps(time: Array) -> Iterator[Finding]:
    """Say where samples are missing: steps over three times the usual one."""
    steps, dt = np.diff(time), interval_of(time)
    at = np.flatnonzero(steps > GAP * dt)
    if not at.size:
        return
    largest = at[np.argsort(steps[at], kind="stable")[::-1]][:SHOWN]
    for i in np.sort(largest):
        missing = round(float(steps[i]) / dt) - 1
        yield Finding(
            kind="gap",
            severity="warning",
            sentence=(
                f"Gap of {quantity(float(steps[i]), 's')} after {quantity(float(time[i]), 's', 6)}"
                f" ({count(missing, 'sample')} missing)."
            ),
            numbers={"time": float(time[i]), "duration": float(steps[i]), "samples": missing},
        )
    if at.size > SHOWN:
        total = float(np.sum(steps[at]))
        yield Finding(
            kind="gap",
            severity="warning",
            sentence=(
                f"{number(at.size, 6)} gaps longer than {number(GAP)} sampling intervals in total,"
                f" {percent(total / float(time[-1] - time[0]))} of the time; the longest are"
                " listed."
            ),
            numbers={"gaps": at.size, "duration": total},
        )


def usual(record: Measurement) -> Iterator[Finding]:
    """Ask for the unit of times at which no controller or camera takes forces and positions.

    Friction itself may be slow: rock is sampled once a second.
    """
    known = {*record.quantities()}
    driven = "force" in known and bool(known & {"position", "velocity"})
    if record.time is None or not (driven or record.line is not None):
        return
    dt = interval_of(record.time)
    if known & {"friction", "spring_force", "pull"} or SLOWEST <= 1.0 / dt <= FASTEST:
        return
    yield Finding(
        kind="units",
        severity="warning",
        sentence=(
            f"{'Force and motion' if driven else 'Positions'} were sampled every"
            f" {quantity(dt, 's')}, {quantity(1.0 / dt, 'Hz')}: check that times are in"
            f" seconds.{MILLISECONDS if 1.0 / dt < SLOWEST else ''}"
        ),
        numbers={"interval": dt},
    )
