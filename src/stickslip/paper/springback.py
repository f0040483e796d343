"""How far bristle laws move the block back when it stops and nothing holds it."""

import math
from dataclasses import dataclass

from stickslip.friction import Dahl, FrictionLaw, LuGre
from stickslip.paper.excitations import rigs
from stickslip.paper.values import PaperValues
from stickslip.selection import Criteria, criteria_of
from stickslip.simulation import simulate

__all__ = ["STIFFNESS", "Springback", "springbacks"]

STIFFNESS = 1e5
"""Of the bristles [N/m], the classical value of LuGre 1995."""


@dataclass(frozen=True, kw_only=True)
class Springback:
    """A stiff bristle law without the static switch, pushed and left to stop."""

    law: FrictionLaw
    criteria: Criteria


def springbacks(values: PaperValues) -> tuple[Springback, ...]:
    """Push the block with Dahl and LuGre friction, without a hold at zero velocity."""
    load = values.load
    dahl = Dahl.from_forces(
        load=load, kinetic_force=values.mu_k * load, bristle_stiffness=STIFFNESS
    )
    lugre = LuGre.from_forces(
        load=load,
        kinetic_force=values.mu_k * load,
        static_force=values.mu_s * load,
        stribeck_velocity=values.stribeck_velocity,
        bristle_stiffness=STIFFNESS,
        bristle_damping=math.sqrt(STIFFNESS),
    )
    _, _, push = rigs(values.rig)["A"]
    return tuple(
        Springback(law=law, criteria=criteria_of(simulate(push, law, t_end=1.0), push))
        for law in (dahl, lugre)
    )
