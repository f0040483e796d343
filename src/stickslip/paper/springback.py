"""How far bristle laws move the block back when it stops and nothing holds it."""

from dataclasses import dataclass, replace

from stickslip.friction import FrictionLaw
from stickslip.paper.excitations import rigs
from stickslip.paper.unpublished import dahl_row, lugre_row
from stickslip.paper.values import PaperValues
from stickslip.selection import Criteria, criteria_of
from stickslip.simulation import simulate

STIFFNESS = 1e5
"""Of the bristles [N/m], the classical value of LuGre 1995."""


@dataclass(frozen=True, kw_only=True)
class Springback:
    """A stiff bristle law without the static switch, pushed and left to stop."""

    law: FrictionLaw
    """The bristle law."""
    criteria: Criteria
    """The paper's criteria of that run."""


def springbacks(values: PaperValues) -> tuple[Springback, ...]:
    """Push the block with Dahl and LuGre friction, as in Table II but with nothing to hold it."""
    held = dahl_row(values, STIFFNESS)
    laws = replace(held, static_switch=False), lugre_row(values, STIFFNESS)
    _, _, push = rigs(values.rig)["A"]
    return tuple(
        Springback(law=law, criteria=criteria_of(simulate(push, law, t_end=1.0), push))
        for law in laws
    )
