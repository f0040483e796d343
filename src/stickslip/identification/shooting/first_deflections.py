"""First deflections of bristles: what slip before a segment has built up.

They are not free like the other initial states: what they do in the first micrometres, an initial
velocity does nearly as well, and noise would set both against each other.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip.friction import FrictionLaw
from stickslip.quantities import parameters, shadow

Array = NDArray[np.float64]

BEFORE = 0.02
"""Share of a segment whose length times its first velocity is how far the body slipped before."""
NUDGE = 1e-6
"""Share by which a parameter is changed to see what that does."""


def first_deflection(law: FrictionLaw, velocity: float, end: float) -> float:
    """Return the deflection with which a bristle begins [m]: 0 if there is not one bristle.

    That of steady slip, or where this is slow, as much as the slip before can have built up. It
    changes smoothly with the law and with the velocity, so that searches can follow.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=2.0, bristle_stiffness=1e4)
    >>> round(1e6 * first_deflection(law, 0.1, 1.0), 1), first_deflection(law, 0.0, 1.0)
    (200.0, 0.0)
    """
    if len(law.states) != 1 or velocity == 0.0:
        return 0.0
    return float(_deflections(law, np.array([velocity]), end)[0])


def deflection_slopes(
    law: FrictionLaw, velocity: float, end: float, paths: Sequence[str]
) -> tuple[Array, float]:
    """Return how a first deflection changes with parameters (n,) and with the velocity [s]."""
    if velocity == 0.0:
        return np.zeros(len(paths)), BEFORE * end
    values = {path: value for path, _, value in parameters(law, "friction")}
    own = [path for path in paths if path in values]
    steps = {path: NUDGE * (abs(values[path]) or 1.0) for path in own}
    first, last = np.arange(len(own) + 2) == 0, np.arange(len(own) + 2) == len(own) + 1
    changed = {
        path: values[path] + steps[path] * (np.arange(len(own) + 2) == i)
        for i, path in enumerate(own, 1)
    }
    near = shadow(law, "friction", lambda path: changed.get(path, values[path]))
    z = _deflections(near, velocity * (1.0 + NUDGE * last), end)
    by_own = dict(zip(own, z[1:-1] - z[first], strict=True))
    slopes = np.array([by_own[path] / steps[path] if path in by_own else 0.0 for path in paths])
    return slopes, float((z[-1] - z[0]) / (NUDGE * velocity))


def _deflections(law: FrictionLaw, velocity: Array, end: float) -> Array:
    """Return first deflections at velocities other than 0, of a law with one value or as many."""
    one = 1e-6  # force is linear in the deflection: any will do
    at_rest, moved = (
        law.force(velocity, 1.0, (z,)) for z in (0.0 * velocity, one + 0.0 * velocity)
    )
    steady = one * (law.steady(velocity, 1.0) - at_rest) / (moved - at_rest)
    # at the speed where damping outdoes stiffness both are 0: no deflection is told
    steady = np.where(np.isfinite(steady), steady, 0.0)
    size = np.maximum(np.abs(steady), 1e-300)
    return np.asarray(-steady * np.expm1(-BEFORE * np.abs(velocity) * end / size))
