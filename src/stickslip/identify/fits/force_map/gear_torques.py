"""Torques through a gear along a motion, without the friction that was measured with them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from stickslip.identify.fits.force_map.data import smoothed
from stickslip.identify.fits.force_map.force_balance import FilteredMotion
from stickslip.identify.fits.settings import ROUNDS, SETTLED

Array = NDArray[np.float64]


def gear_torques(
    motion: FilteredMotion,
    applied: Array,
    taken: Array,
    external: Array,
    passed: float,
    *,
    within: Array | float = 0.0,
    unknown: Sequence[Array] = (),
    weighs: bool = False,
) -> dict[str, Array]:
    """Return the torque of a motor (n,), and what its gear transmits of it.

    The motor's is what the motion takes, with friction that grows with either torque or a square:
    of the measured one friction is a part, so that it would explain whatever friction there is.
    What of it the motion itself makes, as back-EMF does, is `within` it and in `taken`. Of each of
    the `unknown` forces of the motion a coefficient is found, and of a constant one. That is of the
    sensor, or it `weighs`: it is then an external force, and the motor works against it.

    Examples
    --------
    >>> from stickslip.identify.fits.force_map.force_balance import filtered_motion
    >>> t = np.arange(0.0, 20.0, 0.01)
    >>> x, v, weight = np.sin(t), np.cos(t), -2.0 * np.sin(np.sin(t))
    >>> motor = 0.1 * np.sign(v) - weight
    >>> motion = filtered_motion(x, 0.01, 0.1, tracked=True)
    >>> found = gear_torques(motion, motor, -weight, weight, 0.1)
    >>> bool(np.quantile(np.abs(found["motor"] - motor), 0.9) < 0.01)
    True
    """
    ways = np.where(motion.resting, 0.0, np.sign(motion.velocity))
    left = applied - taken
    motor, transmitted = taken + within, taken + within - external
    for _ in range(ROUNDS):  # the torque that a gear transmits has its friction in it
        loads = np.column_stack([np.abs(transmitted), np.abs(motor), transmitted**2])
        rubs = np.column_stack([ways, motion.velocity, ways[:, None] * loads])
        others = np.column_stack([np.ones_like(ways), *unknown])
        seen = smoothed(np.column_stack([left, rubs, others]), passed)
        signed = seen[:, -others.shape[1] :]
        values, _ = nnls(np.column_stack([seen[:, 1:], -signed]), seen[:, 0])
        friction, rest = np.split(values, [rubs.shape[1]])
        constant, *forces = np.subtract(*np.split(rest, 2)).tolist()
        weight = constant if weighs else 0.0
        before = motor
        motor = taken + within + weight + rubs @ friction + others[:, 1:] @ np.array(forces)
        transmitted = motor - external + weight
        if np.linalg.norm(motor - before) <= SETTLED * np.linalg.norm(motor):
            break
    return {"motor": motor, "transmitted": transmitted}
