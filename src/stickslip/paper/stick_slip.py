"""Stick-slip, the first phenomenon of the paper (its III.B.1), on the block of Table I."""

import math
from dataclasses import dataclass

from stickslip.friction import Coulomb
from stickslip.mechanisms import TowedBlock
from stickslip.paper.values import PaperValues
from stickslip.simulation import simulate
from stickslip.trajectory import Trajectory

SPEED = 0.02
"""Of the far end of the spring [m/s]; ours: the paper gives no numbers for its example."""
PERIODS = 4.5
"""How long the block is pulled, after its first break-away."""


@dataclass(frozen=True, kw_only=True)
class StickSlip:
    """The block of Table I, pulled slowly by its spring."""

    mechanism: TowedBlock
    """The block with the spring that pulls it."""
    run: Trajectory
    """The trajectory."""
    stick_time: float
    """Of a period, from the run [s]."""
    slip_time: float
    """Of a period, from the run [s]."""
    stick_formula: float
    """2 D / V with D = (F_s - F_c) / k [s]."""
    slip_formula: float
    """(2 / w)(pi - atan(w D / V)) with w = sqrt(k / m) [s]."""


def stick_slip(values: PaperValues) -> StickSlip:
    """Pull the block of Table I through its spring, and time a period of stick-slip.

    Examples
    --------
    >>> from stickslip import load_rig
    >>> from stickslip.paper import PaperValues, stick_slip
    >>> found = stick_slip(PaperValues.of(load_rig()))
    >>> abs(found.slip_time - found.slip_formula) < 1e-9
    True
    """
    rig = values.rig
    towed = TowedBlock(mass=rig.mass, stiffness=rig.stiffness, speed=SPEED, gravity=rig.gravity)
    law = Coulomb(kinetic_coefficient=values.mu_k, static_coefficient=values.mu_s)
    surplus = (values.mu_s - values.mu_k) * values.load / rig.stiffness
    w = math.sqrt(rig.stiffness / rig.mass)
    stick = 2.0 * surplus / SPEED
    slip = (2.0 / w) * (math.pi - math.atan(w * surplus / SPEED))
    first = values.mu_s * values.load / (rig.stiffness * SPEED)
    run = simulate(towed, law, t_end=first + PERIODS * (stick + slip))
    starts = [event.t for event in run.events if event.from_mode == 0]
    stops = [event.t for event in run.events if event.to_mode == 0]
    return StickSlip(
        mechanism=towed,
        run=run,
        stick_time=starts[2] - stops[1],
        slip_time=stops[1] - starts[1],
        stick_formula=stick,
        slip_formula=slip,
    )
