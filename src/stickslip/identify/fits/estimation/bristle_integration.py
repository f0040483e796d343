"""Bristle states along a measured motion, for many copies of a law at once.

Machine code takes one step after the other. For laws that have none, the motion is cut into chunks
that are integrated side by side, so that one NumPy step serves all chunks and all copies. Each
chunk begins where the one before ended: the states at the joints are found by Newton's method, so
that what bristles remember passes through the whole record.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.kernels.states import (
    MARGIN,
    MOST_PARTS,
    NUDGE,
    REACH,
    SERIES,
    STILL,
    TOLERANCE,
)
from stickslip.engine.solver import states_along
from stickslip.friction import FrictionLaw, bound
from stickslip.identify.fits.estimation.parameters import MOVED
from stickslip.identify.fits.settings import ROUNDING, ROUNDS
from stickslip.maths import Latches

Array = NDArray[np.float64]
Rates = Callable[[Array], Array]

TINY = float(np.finfo(float).eps)
"""Share of the way to the limit that is none."""
CREEP = 1e-9
"""Speed [m/s] at which bristles follow displacement alone."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Path:
    """A measured motion: at samples, and in the steps between them."""

    time: Array
    """Times of the samples (n,) [s]."""
    velocity: Array
    """Slip velocity at the samples (n,) [m/s]."""
    load: Array
    """Normal force at the samples (n,) [N]."""
    travel: Array
    """Displacement in each step (n - 1,) [m]."""
    inputs: Mapping[str, Array] = field(default_factory=dict)
    """Contact inputs at the samples (n,), by name."""
    input_slopes: Mapping[str, Array] = field(default_factory=dict)
    """Slopes (n, k) of those that change with parameters of the mechanism that are looked for."""

    def moved(self, change: Array) -> "Path":
        """Return the same motion with parameters of the mechanism changed by (k,)."""
        if not self.input_slopes:
            return self
        new = {name: self.inputs[name] + x @ change for name, x in self.input_slopes.items()}
        return replace(self, inputs={**self.inputs, **new})

    def told(self, law: Any, rows: "NDArray[np.intp] | slice" = slice(None)) -> Any:
        """Return a law that sees the contact inputs of some samples (k, 1)."""
        return bound(law, {name: self.inputs[name][rows, None] for name in law.inputs})

    def steps(self) -> Array:
        """Return durations, velocities, loads and inputs of the steps (3 + inputs, n - 1)."""
        duration, beside = np.diff(self.time), (self.load, *self.inputs.values())
        means = [0.5 * (one[1:] + one[:-1]) for one in beside]
        return np.array([duration, self.travel / duration, *means])

    def chunks(self) -> tuple[Array, ...]:
        """Return durations, velocities, loads and inputs of the steps (steps, chunks, 1).

        A step costs much the same for one chunk and for a hundred, so that many short chunks are
        quick. The last one is filled up with steps of no duration.
        """
        found = self.steps()
        count = found.shape[1]
        steps = max(1, round(count**0.5))
        chunks = -(-count // steps)
        padded = np.zeros((len(found), steps * chunks))
        padded[:, :count] = found
        padded[2:, count:] = padded[2:, count - 1 : count]
        return tuple(padded.reshape(len(padded), chunks, steps).transpose(0, 2, 1)[..., None])


def follow(law: FrictionLaw, path: Path, start: Array, guess: Array | None = None) -> Array:
    """Return bristle states along a path.

    Within a step the velocity is constant, so that laws which know displacement only see the
    measured one exactly.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> x = np.linspace(0.0, 1e-3, 11)
    >>> there = Path(time=x, velocity=np.ones(11), load=np.ones(11), travel=np.diff(x))
    >>> law = Dahl(kinetic_coefficient=0.5, bristle_stiffness=1e3)
    >>> z = follow(law, there, np.zeros((1, 1)))
    >>> round(float(z[0, -1, 0] / (0.5e-3 * (1 - np.exp(-2.0)))), 9)
    1.0
    """
    inputs = {name: path.inputs[name] for name in law.inputs}
    path = replace(path, inputs=inputs)
    known = None if _power(law) is not None else _stepwise(law, path, start)
    if known is not None:
        return known
    motion = path.chunks()
    bristles, copies = start.shape
    steps, chunks = motion[0].shape[:2]
    starts = np.repeat(start[:, None, :], chunks, axis=1)
    if guess is not None:
        starts[:, 1:] = guess[:, steps : steps * (chunks - 1) + 1 : steps, None]
    # each sweep settles one more joint, whatever the slopes; what is left is beside the second
    # order of the step by which copies of a law differ
    flags: Array = np.zeros((0, chunks, copies), dtype=bool)
    for _ in range(min(chunks, ROUNDS)):
        states, slopes, after = _swept(law, motion, starts, tuple(inputs), flags)
        gap = np.max(np.abs(states[-1][:, :-1] - starts[:, 1:]), axis=(0, 1), initial=0.0)
        size = np.max(np.abs(states), axis=(0, 1, 2))
        passed = np.concatenate([np.zeros_like(after[:, :1]), after[:, :-1]], axis=1)
        apart = ~(gap <= MOVED**2 * size)
        apart |= (passed != (flags if len(flags) else False)).any(axis=(0, 1))
        if not (apart & np.isfinite(size)).any():
            break
        starts, flags = _joined(starts, states[-1], slopes), passed
    states[..., apart] = np.nan
    inside = states[1:].transpose(1, 2, 0, 3).reshape(bristles, -1, copies)
    return np.concatenate([start[:, None, :], inside], axis=1)[:, : len(path.time)]


def displaced(law: FrictionLaw, states: Array, load: Array, way: float) -> Array:
    """Return bristle states after a small displacement, made so slowly that only its way counts.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=0.5, bristle_stiffness=1e3)
    >>> z = displaced(law, np.zeros((1, 1, 1)), np.ones((1, 1)), 1e-3)
    >>> round(float(z[0, 0, 0] / (0.5e-3 * (1 - np.exp(-2.0)))), 9)
    1.0
    """
    v = np.full_like(load, math.copysign(CREEP, way))
    size = float(np.max(np.abs(states), initial=0.0))
    known = _moved(law, v, load, states, way / v, Latches(off=True))
    if known is not None:
        return known
    found, _, _ = _stepped(_rates(law, v, load), way / v, states, 1, size)
    return found


def balancing(law: FrictionLaw, path: Path, force: float, bristles: int) -> Array:
    """Return the least bristle states at the first sample of a path that a force can come from.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> at_rest = Path(time=np.zeros(1), velocity=np.zeros(1), load=np.ones(1), travel=np.zeros(0))
    >>> law = Dahl(kinetic_coefficient=0.5, bristle_stiffness=1e3)
    >>> balancing(law, at_rest, 0.25, 1), balancing(law, at_rest, 4.0, 1)
    (array([[0.00025]]), array([[0.0005]]))
    """
    law = bound(law, {name: float(path.inputs[name][0]) for name in law.inputs})
    v, n, size = float(path.velocity[0]), float(path.load[0]), 1e-6
    unbent = law.force(v, n, (0.0,) * bristles)
    moved = [
        law.force(v, n, tuple(size * (k == i) for i in range(bristles))) for k in range(bristles)
    ]
    slope = np.array([np.atleast_1d((one - unbent) / size) for one in moved])
    level = law.break_away(n)
    wanted = np.clip(force, -level, level) - unbent
    found: Array = slope * wanted / np.maximum(np.sum(slope**2, axis=0), 1e-300)
    return found


def _joined(starts: Array, ends: Array, slopes: Array) -> Array:
    """Return starts that meet the ends of the chunks before them, to first order."""
    found = starts.copy()
    for k in range(starts.shape[1] - 1):
        found[:, k + 1] = ends[:, k] + slopes[:, k] * (found[:, k] - starts[:, k])
    return found


def _swept(
    law: FrictionLaw,
    motion: tuple[Array, ...],
    starts: Array,
    inputs: tuple[str, ...],
    flags: Array,
) -> tuple[Array, Array, Array]:
    """Integrate all chunks from their starts (bristles, chunks, copies).

    Returns states (steps + 1, bristles, chunks, copies), slopes of the ends by the starts, each
    bristle by itself (bristles, chunks, copies), and the flags of latched switches at the ends.
    """
    states = np.empty((len(motion[0]) + 1, *starts.shape))
    states[0] = starts
    slopes = np.ones_like(starts)
    if (known := _by_formula(law, motion, starts, inputs, flags)) is not None:
        return known
    size, parts = float(np.max(np.abs(starts), initial=0.0)), 1
    for i, (one, h, v, n) in enumerate(_informed(law, motion, inputs)):
        rates = _rates(one, v, n)
        parts = max(1, parts - 1)
        while True:
            z, slope, error = _stepped(rates, h, states[i], parts, size)
            size = max(size, float(np.max(np.abs(z))))
            if not error > TOLERANCE * size or parts >= MOST_PARTS:
                break
            more = 1.1 * parts * (error / (TOLERANCE * size)) ** (1.0 / 3.0)
            parts = min(max(math.ceil(min(more, MOST_PARTS)), parts + 1), MOST_PARTS)
        states[i + 1] = z
        slopes *= slope
    return states, slopes, np.zeros((0, *starts.shape[1:]), dtype=bool)


def _informed(
    law: FrictionLaw, motion: tuple[Array, ...], inputs: tuple[str, ...]
) -> Iterator[tuple[FrictionLaw, Array, Array, Array]]:
    """Yield each step with the law that sees the contact inputs there."""
    for h, v, n, *beside in zip(*motion, strict=True):
        yield bound(law, dict(zip(inputs, beside, strict=True))), h, v, n


def _by_formula(
    law: FrictionLaw,
    motion: tuple[Array, ...],
    starts: Array,
    inputs: tuple[str, ...],
    flags: Array,
) -> tuple[Array, Array, Array] | None:
    """Return what `_swept` does by the law's own formula; None if it has none."""
    states = np.empty((len(motion[0]) + 1, *starts.shape))
    states[0], slopes, latches = starts, np.ones_like(starts), Latches(flags, off=True)
    size = float(np.max(np.abs(starts), initial=0.0))
    for i, (one, h, v, n) in enumerate(_informed(law, motion, inputs)):
        nudge = NUDGE * size + 1e-300
        beside = _moved(one, v, n, states[i] + nudge, h, latches)
        found = _moved(one, v, n, states[i], h, latches)
        if found is None or beside is None:
            return None
        latches.turn()
        states[i + 1], slopes = found, slopes * (beside - found) / nudge
        size = max(size, float(np.max(np.abs(found))))
    ends = [np.broadcast_to(one, starts.shape[1:]) for one in latches.flags]
    return states, slopes, np.array(ends, dtype=bool).reshape(-1, *starts.shape[1:])


def _moved(
    law: FrictionLaw, v: Array, n: Array, z: Array, h: Array, latches: Latches
) -> Array | None:
    """Return states (bristles, ...) after a step of h by the law's own formula, if it has one."""
    with latches:
        found = law.moved(v, n, tuple(z), h)
    if found is None:
        return _yielded(law, v, n, z, h)
    return np.stack([np.broadcast_to(one, z.shape[1:]) for one in found])


def _yielded(law: Any, v: Array, n: Array, z: Array, h: Array) -> Array | None:
    """Return the state (1, ...) of Dahl's bristle after a step of h by a formula; None of others.

    With the exponent 1 its rates are linear in the deflection, and a step is exact without.
    """
    power = _power(law)
    if power is None:
        return None
    rates, names = _rates(law, v, n), law.made_of.memory.names
    probe = law.break_away(1.0) / getattr(law, names.get("bristle_stiffness", "bristle_stiffness"))
    probe = np.broadcast_to(probe, z.shape)
    moves = v != 0.0
    way, along = np.where(moves, v, 1.0), np.where(v < 0.0, -1.0, 1.0)
    # at a deflection against the way, the spring stands further from its limit than unbent
    curve = ((rates(-along * probe) / way) ** (1.0 / power) - 1.0) / probe
    left = 1.0 - curve * along * z
    size = np.abs(left)
    bend = 1.0 - power
    worn = curve * np.abs(v) * h * np.maximum(size, TINY) ** -bend
    plain = np.abs(bend) < ROUNDING
    spent = np.where(plain, 0.0, bend * worn)
    kept = np.log1p(-np.minimum(spent, 1.0 - TINY)) / np.where(plain, 1.0, bend)
    size = np.where(spent >= 1.0, 0.0, size * np.exp(np.where(plain, -worn, kept)))
    return np.where(moves, along * (1.0 - np.copysign(size, left)) / curve, z)


def _power(law: Any) -> Array | None:
    """Return the exponents with which a Dahl bristle yields, if any is not 1; None of others."""
    made = getattr(law, "made_of", None)
    leaf = None if made is None else made.memory
    if leaf is None or leaf.part.name != "dahl":
        return None
    power = np.asarray(getattr(law, leaf.names.get("yield_exponent", "yield_exponent")))
    return None if np.all(power == 1.0) else power


def _stepwise(law: FrictionLaw, path: Path, start: Array) -> Array | None:
    """Return bristle states along a path by machine code; None of a law that has none."""
    found = states_along(law, path.steps().T, tuple(path.inputs), start)
    return None if found is None else np.asarray(found)


def _rates(law: FrictionLaw, v: Array, n: Array) -> Rates:
    def rates(z: Array) -> Array:
        found = law.rates(v, n, tuple(z))
        if len(found) == 1 and np.shape(found[0]) == z.shape[1:]:
            return np.asarray(found[0])[np.newaxis]
        return np.stack([np.broadcast_to(part, z.shape[1:]) for part in found])

    return rates


def _stepped(
    rates: Rates, h: Array, z: Array, parts: int, size: float
) -> tuple[Array, Array, float]:
    """Return states after a step of h in equal parts, their slopes by z, and the largest error.

    Exponential Rosenbrock steps of order 3 (exprb32, doi:10.1017/S0962492910000048) with the slopes
    of each bristle by itself: exact for laws that are linear in the deflection, such as LuGre's and
    Dahl's, and stable however many presliding lengths a step crosses.
    """
    h = h / parts
    slopes, worst = np.ones_like(z), 0.0
    for _ in range(parts):
        f = rates(z)
        nudge = NUDGE * np.maximum(np.abs(z), max(size, float(np.max(np.abs(h * f)))) + 1e-300)
        jacobian = _jacobian(rates, z, f, nudge)
        x = np.minimum(h * jacobian, 50.0)
        phi_1, phi_3 = _phi(x)
        there = z + h * phi_1 * f
        rest = rates(there) - f - jacobian * (there - z)
        correction = 2.0 * h * phi_3 * rest
        new, slope, error = there + correction, np.exp(x), np.abs(correction)
        if len(z) == 1:
            yielding = (rest + f + jacobian * (there - z)) * f <= 0.0
            error = np.where(yielding, _reached(h * f, size), error)
            # ten times the way that is left: arrived, whatever the slopes promise
            far = yielding & (np.abs(h * f) > 10.0 * size)
            # what yields goes forwards, and no farther than at its first rate
            share = (new - z) / np.where(f == 0.0, 1.0, h * f)
            far |= yielding & ~((share >= -MARGIN) & (share <= 1.0 + MARGIN))
            new, slope = _held_back(rates, z, f, np.where(far, there, new), slope)
        z, slopes = new, slopes * slope
        worst = max(worst, float(np.max(error)))
    return z, slopes, worst


def _reached(way: Array, size: float) -> Array:
    """Return an error that asks for as many parts as keep each of them within reach."""
    limit = REACH * max(size, 1e-3 * float(np.max(np.abs(way))), 1e-300)
    found: Array = TOLERANCE * size * (np.abs(way) / limit) ** 3
    return found


def _jacobian(rates: Rates, z: Array, f: Array, nudge: Array) -> Array:
    """Return the slope of each bristle's rate by its own deflection."""
    if len(z) == 1:
        return (rates(z + nudge) - f) / nudge
    own = np.empty_like(z)
    for k in range(len(z)):
        moved = z.copy()
        moved[k] += nudge[k]
        own[k] = (rates(moved)[k] - f[k]) / nudge[k]
    return own


def _phi(x: Array) -> tuple[Array, Array]:
    """Return phi_1 = (e^x - 1) / x and phi_3 = (e^x - 1 - x - x^2 / 2) / x^3."""
    small = np.abs(x) < SERIES
    safe = np.where(small, 1.0, x)
    direct = ((np.expm1(safe) / safe - 1.0) / safe - 0.5) / safe
    y = np.where(small, x, 0.0)
    series = (1.0 + y / 4.0 * (1.0 + y / 5.0 * (1.0 + y / 6.0 * (1.0 + y / 7.0)))) / 6.0
    phi_3 = np.where(small, series, direct)
    return 1.0 + x * (0.5 + x * phi_3), phi_3


def _held_back(rates: Rates, z: Array, f: Array, new: Array, slope: Array) -> tuple[Array, Array]:
    """Return a step that does not cross the deflection at which the rate is zero.

    At constant velocity no solution does, but a step may where the law yields all of a sudden, as
    Dahl's does with an exponent below 1.
    """
    f_high = rates(new)
    over = f_high * f < 0.0
    over &= np.abs(new - z) > 1e-9 * np.abs(z)
    if not over.any():
        return new, slope
    low, high = z.copy(), new.copy()
    f_low = f.copy()
    for _ in range(40):
        spread = np.where(over, f_high - f_low, 1.0)
        middle = np.where(over, high - f_high * (high - low) / np.where(spread == 0, 1, spread), z)
        f_middle = rates(middle)
        before = f_middle * f > 0.0
        # Illinois: the end that stays counts half
        f_high = np.where(before, 0.5 * f_high, f_middle)
        f_low = np.where(before, f_middle, 0.5 * f_low)
        # the rate of a law that is linear in the deflection is 0 after one step, but for rounding
        found = np.abs(f_middle) <= STILL * np.abs(f)
        low, high = np.where(before | found, middle, low), np.where(before & ~found, high, middle)
        if np.max(np.where(over, np.abs(high - low) - 1e-10 * np.abs(new), 0.0)) <= 0.0:
            break
    return np.where(over, middle, new), np.where(over, 0.0, slope)
