"""What the stiffness of the bristles makes of the rows of Table II, under the push of reading A."""

from dataclasses import dataclass

from stickslip.friction import Dahl, LuGre
from stickslip.paper.excitations import rigs
from stickslip.paper.unpublished import dahl_row, lugre_row
from stickslip.paper.values import PaperValues
from stickslip.selection import Criteria, criteria_of
from stickslip.simulation import simulate

__all__ = ["BristleRow", "bristle_rows"]

STIFFNESSES = (1e5, 1e4, 1e3, 1e2)
"""Of the bristles [N/m], from that of LuGre 1995 down to that of rubber."""


@dataclass(frozen=True, kw_only=True)
class BristleRow:
    """One stiffness and what the block does with it."""

    law: str
    """Registry name."""
    stiffness: float
    """Of the bristles [N/m]."""
    held: bool
    """Whether the static switch holds the block at its first stop."""
    criteria: Criteria
    """The paper's criteria of that run."""


def bristle_rows(values: PaperValues, *, t_end: float) -> tuple[BristleRow, ...]:
    """Push the block with Dahl friction, held, and with LuGre friction, not held.

    Parameters
    ----------
    values : PaperValues
        The paper's rig and coefficients.
    t_end : float
        Length of the runs [s].

    Returns
    -------
    tuple of BristleRow
        One row per law and stiffness, Dahl first.
    """
    _, _, push = rigs(values.rig)["A"]
    laws: list[tuple[Dahl | LuGre, float]] = []
    laws += [(dahl_row(values, stiffness), stiffness) for stiffness in STIFFNESSES]
    laws += [(lugre_row(values, stiffness), stiffness) for stiffness in STIFFNESSES]
    return tuple(
        BristleRow(
            law=law.name,
            stiffness=stiffness,
            held=law.static_switch,
            criteria=criteria_of(simulate(push, law, t_end=t_end), push, values.measured),
        )
        for law, stiffness in laws
    )
