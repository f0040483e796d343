r"""Bristle states along a measured motion, for copies of a law at once.

The engine takes one step after the other in machine code (`stickslip.engine.kernels.states`). The
equations of a few laws are written for arrays alone: their states :math:`z_k` take exponential
Euler steps,

.. math:: z_k \leftarrow z_k + \frac{e^{h J_k} - 1}{J_k}\, \dot z_k(z) ,
          \qquad J_k = \partial \dot z_k / \partial z_k ,

which are exact where the rate is linear in the deflection, in `PARTS` parts of each step. Dahl's
bristle with an exponent other than 1 moves by its closed form.

Source: M. Hochbruck, A. Ostermann, "Exponential integrators", Acta Numerica 19, 2010.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.kernels.states import MOST_PARTS as PARTS
from stickslip.engine.kernels.states import NUDGE
from stickslip.engine.solver import states_along
from stickslip.friction import FrictionLaw, bound
from stickslip.identify.fits.settings import ROUNDING

Array = NDArray[np.float64]
TINY = float(np.finfo(float).eps)
"""Share of the way to the limit that is none."""


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

    def steps(self) -> Array:
        """Return durations, velocities, loads and inputs of the steps (3 + inputs, n - 1)."""
        duration, beside = np.diff(self.time), (self.load, *self.inputs.values())
        means = [0.5 * (one[1:] + one[:-1]) for one in beside]
        return np.array([duration, self.travel / duration, *means])


def follow(law: FrictionLaw, path: Path, start: Array) -> Array:
    """Return bristle states (b, samples, copies) along a path from the first ones (b, copies).

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
    steps = replace(path, inputs=inputs).steps().T
    found = None if _power(law) is not None else states_along(law, steps, tuple(inputs), start)
    return _in_arrays(law, steps, tuple(inputs), start) if found is None else np.asarray(found)


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


def _in_arrays(law: FrictionLaw, motion: Array, inputs: tuple[str, ...], start: Array) -> Array:
    """Return states (b, steps + 1, copies) along a motion, of a law in arrays."""
    states = np.empty((len(start), len(motion) + 1, start.shape[1]))
    states[:, 0] = z = start
    closed, size = _power(law) is not None, 0.0
    for i, (h, v, n, *beside) in enumerate(motion):
        at = bound(law, dict(zip(inputs, beside, strict=True)))
        for _ in range(1 if closed else PARTS):
            if closed:
                z = _yielded(at, v, n, z, h)
            else:
                z, size = _stepped(at, v, n, z, h / PARTS, size)
        states[:, i + 1] = z
    return states


def _stepped(
    law: FrictionLaw, v: float, n: float, z: Array, h: float, size: float
) -> tuple[Array, float]:
    """Return states after an exponential Euler step of h, and the largest deflection so far."""
    f = _rates(law, v, n, z)
    size = max(size, float(np.max(np.abs(z) + np.abs(h * f))))
    nudge = NUDGE * size + 1e-300
    slopes = np.empty_like(z)
    for k in range(len(z)):
        moved = z.copy()
        moved[k] += nudge
        slopes[k] = (_rates(law, v, n, moved)[k] - f[k]) / nudge
    x = np.minimum(h * slopes, 50.0)
    safe = np.where(np.abs(x) < NUDGE, 1.0, x)
    return z + h * f * np.where(np.abs(x) < NUDGE, 1.0, np.expm1(safe) / safe), size


def _yielded(law: Any, v: float, n: float, z: Array, h: float) -> Array:
    """Return the state (1, ...) of Dahl's bristle after a step of h by its closed form."""
    power = _power(law)
    assert power is not None
    names = law.made_of.memory.names
    probe = law.break_away(1.0) / getattr(law, names.get("bristle_stiffness", "bristle_stiffness"))
    probe = np.broadcast_to(probe, z.shape)
    moves = v != 0.0
    way, along = np.where(moves, v, 1.0), np.where(v < 0.0, -1.0, 1.0)
    # at a deflection against the way, the spring stands further from its limit than unbent
    curve = ((_rates(law, v, n, -along * probe) / way) ** (1.0 / power) - 1.0) / probe
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


def _rates(law: FrictionLaw, v: float, n: float, z: Array) -> Array:
    """Return the rates of states (b, copies)."""
    return np.stack([np.broadcast_to(one, z.shape[1:]) for one in law.rates(v, n, tuple(z))])
