"""Floquet multipliers of orbits under feedback whose delay is a whole number n of their periods.

The feedback K (x(t - n T) - x(t)) vanishes on the orbit, which therefore is that without it. Near
it a solution that is multiplied by mu in each period T feels K (mu^-n - 1) x:

1. Phi(s) is the monodromy of the orbit with the feedback K s (x - x_o(t)) of its own motion x_o, by
   a run of the event-driven solver with x_o as straight lines (`engine.solver.delays`).
2. It is an entire function of s, whose terms become small fast. Runs at Chebyshev's places of a
   real interval give a polynomial that holds in the disc with the interval as its diameter, too.
   It ends where its terms are no larger than the last ones, which are errors of the runs: in the
   disc these grow by a factor of 1 + sqrt(2) with each degree, up to which they may be.
3. With z = 1 / mu the multipliers of a size of at least 1 / R are the zeros of
   det(z Phi(z^n - 1) - 1) with abs(z) <= R: those of its Taylor polynomial, whose coefficients are
   Fourier's of its values on the circle, then Newton's steps. How often the values wind around 0
   tells that none is missing.

Sources: Pyragas 1992 (the feedback); Just, Bernard, Ostheimer, Reibold and Benner 1997 (Floquet
problem of it); Trefethen 2013, chapter 8 (polynomials beyond the interval).
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from stickslip.engine.solver import Playback, lines_of
from stickslip.errors import InputError, SimulationError
from stickslip.mechanisms import Mechanism, redriven
from stickslip.mechanisms.drives import (
    DelayedFeedback,
    Drive,
    Feedback,
    PiecewiseAffine,
    is_delayed,
    parts_of,
    without_delays,
)
from stickslip.show.formatting import number
from stickslip.study.sweep.parameter_grid import Array
from stickslip.study.tolerances import ROUNDING

Complex = NDArray[np.complex128]

REACH = 2.0
"""Multipliers are known from 1 over this on."""
WHOLE = 1e-6
"""Part of a period by which a delay may be off."""
PAST = 1e-6
"""Largest error of the motion that feedback is taken from, over its size: it moves the orbit by as
little, and multipliers by less."""
RUNS, LAST = 17, 4
"""Runs with different feedback, and terms of their polynomial that are taken for errors."""
FLOOR, UNSURE = 10.0, 1e-3
"""Size of a term over those of errors at least, and largest error in the disc, over the terms."""
CIRCLE = 512
"""Places of the circle at which the determinant is taken."""
SMALL, NEWTON, INNER = 1e-11, 8, 0.97
"""Share of the largest coefficient below which others are left out, Newton's steps, and share of
the radius up to which zeros are kept."""
PLACES = 33
"""Places of an orbit at which the size of a state is looked at."""
STEP = 1e-6
"""Difference of z for the derivative of the determinant."""


def delays_of(mechanism: Mechanism) -> list[DelayedFeedback]:
    """Return the delayed feedback in the drives of a mechanism.

    Examples
    --------
    >>> from stickslip import Axis
    >>> delays_of(Axis(inertia=1.0))
    []
    """
    return [
        part
        for drive in mechanism.drives().values()
        for part in parts_of(drive)
        if isinstance(part, DelayedFeedback)
    ]


@dataclass(frozen=True)
class Undelayed:
    """An orbit of a mechanism without its delayed feedback."""

    playback: Playback
    """Its run over a period."""
    states: tuple[str, ...]
    """Names of all states."""
    period: float
    """Its period [s]."""
    advance: Mapping[str, float]
    """How far coordinates advance in a period."""
    events: tuple[float, ...]
    """When something happens [s]."""
    monodromy: Callable[[Mechanism], Array]
    """Gives that of the orbit for a mechanism that has it, too."""


def delayed_multipliers(orbit: Undelayed, mechanism: Mechanism) -> Complex:
    """Return multipliers of a size above 1/2 of an orbit under delayed feedback, the largest first.

    The mechanism is that with the feedback.
    """
    count = _periods(orbit, mechanism)
    radius, motions = REACH**count, _motions(orbit, mechanism)
    nodes = chebyshev.chebpts1(RUNS)
    runs = (_with_feedback(mechanism, motions, s) for s in radius * nodes - 1.0)
    values = np.array([orbit.monodromy(run) for run in runs])
    coefficients = chebyshev.chebfit(nodes, values.reshape(RUNS, -1), RUNS - 1)
    terms = np.abs(coefficients).max(axis=1)
    degree = int(np.flatnonzero(terms > FLOOR * terms[-LAST:].max())[-1])
    if terms[-LAST:].max() * (1.0 + math.sqrt(2.0)) ** degree > UNSURE * terms.max():
        raise SimulationError(
            "the multipliers under delayed feedback are not known: its gain changes what is near"
            f" the orbit too much for a polynomial of {RUNS} runs. Give a smaller gain."
        )
    coefficients = coefficients[: degree + 1]
    size = values.shape[1]

    def determinant(z: Complex) -> Complex:
        inner = chebyshev.chebval(z**count / radius, coefficients)
        matrices = np.moveaxis(inner, 0, -1).reshape(*z.shape, size, size)
        result: Complex = np.linalg.det(z[..., None, None] * matrices - np.eye(size))
        return result

    circle = REACH * np.exp(2j * np.pi * np.arange(CIRCLE) / CIRCLE)
    taylor = np.fft.fft(determinant(circle)) / CIRCLE
    last = int(np.flatnonzero(np.abs(taylor) > SMALL * np.abs(taylor).max())[-1])
    z = REACH * np.roots(taylor[: last + 1][::-1])
    z = z[np.abs(z) < INNER * REACH].astype(np.complex128)
    for _ in range(NEWTON if len(z) else 0):
        slope = (determinant(z + STEP) - determinant(z - STEP)) / (2.0 * STEP)
        z = z - np.where(slope != 0.0, determinant(z) / np.where(slope != 0.0, slope, 1.0), 0.0)
    ring = INNER * REACH * np.exp(2j * np.pi * np.arange(8 * CIRCLE + 1) / (8 * CIRCLE))
    turns = np.unwrap(np.angle(determinant(ring)))
    if round(float(turns[-1] - turns[0]) / (2.0 * np.pi)) != len(z):
        raise SimulationError(
            "the multipliers under delayed feedback could not be told apart. Change the gain."
        )
    multipliers: Complex = 1.0 / np.where(np.abs(z.imag) > ROUNDING * np.abs(z), z, z.real)
    return multipliers[np.argsort(-np.abs(multipliers), kind="stable")]


def _periods(orbit: Undelayed, mechanism: Mechanism) -> int:
    """Return how many periods the delay lasts; refuse another, in which the feedback remains."""
    counts = set()
    for part in delays_of(mechanism):
        ratio = part.delay / orbit.period
        if round(ratio) < 1 or abs(ratio - round(ratio)) > WHOLE * ratio:
            raise InputError(
                f"the delay of {number(part.delay, 8)} s is {number(ratio, 6)} periods of the orbit"
                f" of {number(orbit.period, 8)} s: the feedback does not vanish on it, and what"
                " repeats itself then is no orbit of finitely many states. Give a delay of a whole"
                " number of periods."
            )
        if orbit.advance.get(part.state, 0.0) != 0.0:
            raise InputError(
                f"{part.state} advances by {number(orbit.advance[part.state], 4)} in a period, so"
                " that its delayed feedback does not vanish: follow a state that comes back."
            )
        counts.add(round(ratio))
    if len(counts) > 1:
        raise InputError("delays of one orbit must be equal for its multipliers to be known.")
    return counts.pop()


def _motions(orbit: Undelayed, mechanism: Mechanism) -> dict[str, Array]:
    """Return lines along each state that is fed back, over one period (lines, 3)."""
    playback, result = orbit.playback, {}
    breaks = np.unique([0.0, *orbit.events, orbit.period]).tolist()
    for part in delays_of(mechanism):
        index = orbit.states.index(part.state)
        x = playback.played(np.linspace(0.0, orbit.period, PLACES))[0][:, index]
        size = float(np.abs(x).max()) or 1.0
        lines = lines_of(playback, index, breaks, PAST * size)
        result[part.state] = np.vstack([lines, [orbit.period, x[-1], 0.0]])
    return result


def _with_feedback(mechanism: Mechanism, motions: Mapping[str, Array], s: float) -> Mechanism:
    """Return a mechanism with feedback of how far it is off a motion in place of a delayed one."""

    def change(drive: Drive) -> Drive:
        if not is_delayed(drive):
            return drive
        instead = list[Drive]()
        for part in (part for part in parts_of(drive) if isinstance(part, DelayedFeedback)):
            gain, (times, values, slopes) = -part.gain * s, motions[part.state].T
            motion = PiecewiseAffine(times=times, values=gain * values, slopes=gain * slopes)
            instead += [Feedback(state=part.state, gain=gain), motion]
        return without_delays(drive, *instead)

    result: Mechanism = redriven(mechanism, change)
    return result
