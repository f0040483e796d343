"""An axis driven by a sampled force of 25,000 samples, one a millisecond, each held."""

import functools
import itertools
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

from benchmarks.kernel import Kernel
from benchmarks.measuring import (
    MANY,
    TIERS,
    Entry,
    Result,
    at_error,
    faster,
    if_installed,
    largest_error,
    own_entries,
    with_times,
    within,
)
from stickslip import Axis, CoulombViscous
from stickslip.engine import Trajectory
from stickslip.mechanisms.drives import Sampled

J, F_K, F_S, SIGMA_2 = 1.0, 1.0, 1.2, 0.5
SAMPLES, STEP = 25_000, 1e-3
FORCE, MEMORY, SEED = 1.2, 1.0, 2
"""Standard deviation [N] and correlation time [s] of the force, and the seed of its noise."""
PART = 500
"""Slipping samples that SciPy integrates; its time is scaled to all of them."""
ERROR = 1e-9
WORK = "25,000 sampled inputs, Coulomb + viscous"
WHY = (
    "a step a sample, some 0.12 us: series, guards, books and record are made anew for each, and no"
    " part of them is above a fifth"
)

LAW = CoulombViscous(
    kinetic_coefficient=F_K, static_coefficient=F_S, viscous_coefficient=SIGMA_2
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What a run by hand found."""

    changes: list[float]
    """Times of stops, reversals and releases [s]."""
    places: list[float]
    """Place at the end of each sample [m]."""
    slipping: int
    """Samples with motion."""


def forces(samples: int) -> list[float]:
    """Return a random walk that is drawn back to 0."""
    noise = np.random.default_rng(SEED).standard_normal(SAMPLES)[:samples]
    keep = math.exp(-STEP / MEMORY)
    gain = FORCE * math.sqrt(1 - keep**2)
    walk = itertools.accumulate(noise, lambda u, e: keep * u + gain * float(e), initial=0.0)
    return list(walk)[1:]


def axis(samples: int) -> Axis:
    times = [i * STEP for i in range(samples)]
    return Axis(inertia=J, drive=Sampled(times=times, values=forces(samples)))


Slip: TypeAlias = Callable[
    [float, float, float, float, int, float], tuple[float | None, float, float]
]
"""Goes from t to an end, from x and v, to a side, with a push [N] that friction is taken from;
returns the time of a stop or None, place and velocity."""


def by_hand(slip: Slip, u: Sequence[float], most: int = SAMPLES) -> Motion:
    """Go from sample to sample; `slip` moves the axis until it stops or the sample ends."""
    x, v, side, slipping = 0.0, 0.0, 0, 0
    changes, places = [], []
    for i, force in enumerate(u):
        t, end = i * STEP, (i + 1) * STEP
        if not side and abs(force) > F_S:
            side = 1 if force > 0 else -1
            changes.append(t)
        slipping += side != 0
        while side:
            stop, x, v = slip(t, end, x, v, side, force - side * F_K)
            if stop is None:
                break
            t, v = stop, 0.0
            changes.append(t)
            side = -side if force * -side > F_S else 0
        places.append(x)
        if slipping == most:
            break
    return Motion(changes=changes, places=places, slipping=slipping)


def reference_slip() -> Slip:
    """Return steps by the exponential of the matrix that moves place, velocity and push."""
    A = np.array([[0.0, 1.0, 0.0], [0.0, -SIGMA_2 / J, 1.0 / J], [0.0, 0.0, 0.0]])

    def rows(h: float) -> list[list[float]]:
        return expm(A * h)[:2].tolist()

    whole = rows(STEP)

    def moved(E: list[list[float]], x: float, v: float, push: float) -> tuple[float, float]:
        (_, b, c), (_, e, f) = E
        return x + b * v + c * push, e * v + f * push

    def slip(t, end, x, v, side, push):
        full = abs(end - t - STEP) < 1e-12
        x_1, v_1 = moved(whole if full else rows(end - t), x, v, push)
        if v_1 * side > 0:
            return None, x_1, v_1
        h = brentq(lambda h: moved(rows(h), x, v, push)[1], 0.0, end - t, xtol=1e-18, rtol=1e-15)
        return t + h, *moved(rows(h), x, v, push)

    return slip


def closed_slip(t, end, x, v, side, push):
    """Move by the closed form of a linear equation of first order."""
    a, rate = push / J, SIGMA_2 / J
    stop = None

    def moved(h):
        phi = -math.expm1(-rate * h) / rate
        return x + v * phi + a * (h - phi) / rate, v - rate * v * phi + a * phi

    x_1, v_1 = moved(end - t)
    if v_1 * side <= 0:
        h = math.log1p(-rate * v / a) / rate
        stop = t + h
        x_1, v_1 = moved(h)
    return stop, x_1, v_1


def scipy_slip(tolerance: float) -> Slip:
    """Return one sample in DOP853, with the stop as an event."""

    def stop(t, y, push):
        return y[1]

    def rates(t, y, push):
        return [y[1], (push - SIGMA_2 * y[1]) / J]

    stop.terminal = True

    def slip(t, end, x, v, side, push):
        stop.direction = -side
        run = solve_ivp(
            rates, (t, end), [x, v], method="DOP853", rtol=tolerance, atol=tolerance,
            events=stop, args=(push,),
        )  # fmt: skip
        y = run.y[:, -1]
        return float(run.t[-1]) if run.status else None, float(y[0]), float(y[1])

    return slip


@functools.cache
def heyoka_slip(tolerance: float) -> Slip:
    """Return one sample in heyoka, with the stop as an event; compiled once."""
    import heyoka as hy

    x, v = hy.make_vars("x", "v")
    ends = {1: hy.event_direction.negative, -1: hy.event_direction.positive}
    modes = {
        side: hy.taylor_adaptive(
            [(x, v), (v, (hy.par[0] - SIGMA_2 * v) / J)], [0.0, 0.0], tol=tolerance,
            t_events=[hy.t_event(v, direction=ends[side])],
        )
        for side in ends
    }  # fmt: skip
    ran_on = hy.taylor_outcome.time_limit

    def slip(t, end, x, v, side, push):
        mode = modes[side]
        mode.time, mode.state[:], mode.pars[0] = t, (x, v), push
        mode.reset_cooldowns()
        stop = None if mode.propagate_until(end)[0] == ran_on else mode.time
        return stop, *mode.state.tolist()

    return slip


def error_of(found: Motion, known: Motion) -> float:
    """Return the error of a run by hand, which may have ended early."""
    changes = [t for t in known.changes if t < len(found.places) * STEP]
    off = max(abs(a - b) for a, b in zip(found.places, known.places, strict=False))
    return max(largest_error(found.changes, changes), off / max(map(abs, known.places)))


def error_of_own(changes: list[float], places: np.ndarray, known: Motion) -> float:
    """Return the error of a run of stickslip, in places at every hundredth sample."""
    off = np.abs(places - known.places[99::100]).max()
    return max(largest_error(changes, known.changes), off / max(map(abs, known.places)))


def by_own(rig: Axis, samples: int, known: Motion, tiers: Sequence[str]) -> tuple[Entry, ...]:
    """Return stickslip's entries."""
    ends = [i * STEP for i in range(100, len(known.places) + 1, 100)]

    def of_run(found: Trajectory) -> float:
        changes = [event.t for event in found.events]
        return error_of_own(changes, found.at(ends)["x"], known)

    def of_kernel(kernel: Kernel) -> float:
        return error_of_own(kernel.changes(), kernel.states(ends)[0], known)

    return own_entries(rig, LAW, samples * STEP, of_run, of_kernel, ERROR, tiers)


def run(repeats: int = MANY, tiers: Sequence[str] = tuple(TIERS), samples: int = SAMPLES) -> Result:
    """Run the case, or the beginning of it."""
    u, rig = forces(samples), axis(samples)
    known = by_hand(reference_slip(), u)
    part = min(PART, known.slipping)

    def entry(method: str, slip: Callable[[float], Slip], most: int = SAMPLES) -> Entry:
        return at_error(
            f"{method} sample by sample, by hand",
            lambda tolerance: by_hand(slip(tolerance), u, most),
            lambda item: error_of(item, known),
            ERROR,
        )

    name = "heyoka sample by sample, by hand"
    timed = with_times(
        (
            *by_own(rig, samples, known, tiers),
            if_installed("heyoka", name, lambda: entry("heyoka", heyoka_slip)),
            entry("closed form", lambda tolerance: closed_slip),
            entry("SciPy DOP853", scipy_slip, part),
        ),
        repeats,
        time.process_time,
    )
    entries = (*timed[:-1], scaled(timed[-1], known.slipping / part))
    return Result(
        title=f"Axis with {samples} held samples of force",
        what=f"times of all {len(known.changes)} changes, and places, against exact steps"
        f" by the matrix exponential; SciPy's time is that of its first {part} slipping samples,"
        f" scaled to all {known.slipping}",
        error=ERROR,
        entries=entries,
        targets=(
            *within(WORK, 3.0, entries, "ms", WHY),
            *faster(WORK, 400.0, entries, "SciPy DOP853", WHY),
        ),
    )


def scaled(entry: Entry, factor: float) -> Entry:
    """Return an entry that ran a part only with the times of the whole."""
    times = tuple(factor * time for time in entry.times)
    return replace(entry, first=factor * entry.first, times=times)
