r"""Bristle states along a measured motion, for copies of a law at once.

The engine takes one step after the other in machine code (`stickslip.engine.kernels.states`). The
equations of a few laws are written for arrays alone: their states :math:`z_k` take exponential
Euler steps,

.. math:: z_k \leftarrow z_k + \frac{e^{h J_k} - 1}{J_k}\, \dot z_k(z) ,
          \qquad J_k = \partial \dot z_k / \partial z_k ,

which are exact where the rate is linear in the deflection, in `PARTS` parts of each step.

Source: M. Hochbruck, A. Ostermann, "Exponential integrators", Acta Numerica 19, 2010.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.kernels.states import MOST_PARTS as PARTS
from stickslip.engine.kernels.states import NUDGE
from stickslip.engine.solver import states_along
from stickslip.friction import FrictionLaw, bound

Array = NDArray[np.float64]


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
    found = states_along(law, steps, tuple(inputs), start)
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
    """Return states (b, steps + 1, copies) along a motion of a law without machine code."""
    states = np.empty((len(start), len(motion) + 1, start.shape[1]))
    states[:, 0] = z = start
    size = 0.0
    for i, (duration, v, n, *beside) in enumerate(motion):
        at, h = bound(law, dict(zip(inputs, beside, strict=True))), duration / PARTS
        for _ in range(PARTS):
            f = _rates(at, v, n, z)
            size = max(size, float(np.max(np.abs(z) + np.abs(h * f))))
            nudge = NUDGE * size + 1e-300
            slopes = np.empty_like(z)
            for k in range(len(z)):
                moved = z.copy()
                moved[k] += nudge
                slopes[k] = (_rates(at, v, n, moved)[k] - f[k]) / nudge
            x = np.minimum(h * slopes, 50.0)
            safe = np.where(np.abs(x) < NUDGE, 1.0, x)
            z = z + h * f * np.where(np.abs(x) < NUDGE, 1.0, np.expm1(safe) / safe)
        states[:, i + 1] = z
    return states


def _rates(law: FrictionLaw, v: float, n: float, z: Array) -> Array:
    """Return the rates of states (b, copies)."""
    return np.stack([np.broadcast_to(one, z.shape[1:]) for one in law.rates(v, n, tuple(z))])
