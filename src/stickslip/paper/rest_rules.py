"""How a block diagram finds rest: the zero-velocity band of the paper's [18] beside others."""

import itertools
from dataclasses import dataclass

from stickslip.friction import Coulomb
from stickslip.mechanisms import PendulumCart
from stickslip.paper.cart import CART, CYCLES, swing_of
from stickslip.paper.values import PaperValues
from stickslip.selection import Criteria, criteria_of
from stickslip.simulation import simulate
from stickslip.solver import FixedStep
from stickslip.sweep import cycles_in

RULES: tuple[tuple[float, bool, float], ...] = (
    (0.01, False, 0.0),
    (0.01, False, 0.001),
    (0.01, False, 0.03),
    (0.01, True, 0.0),
    (0.001, False, 0.0),
    (0.001, False, 0.001),
    (0.001, False, 0.003),
    (0.001, True, 0.0),
)
"""Step [s], whether a change of sign holds the body, half width of the band [m/s]."""
SECONDS = 1.0
"""How long the block is followed; exactly, it stops in half of that."""


@dataclass(frozen=True, kw_only=True)
class RestRule:
    """A rule for rest, and what block and cart do with it; Coulomb friction in each."""

    dt: float | None
    """Step [s]; None where events are located."""
    stick_rule: bool
    """Whether a change of sign holds the body, exactly or within a step."""
    band: float
    """Half width of the zero-velocity band [m/s]."""
    block: Criteria
    """What the released block does."""
    reversals: int
    """Sign changes of its velocity."""
    rests: bool
    """Whether the block is at rest at the end."""
    cart_travel: float
    """Of the cart in all cycles, at the levels of the rig [m]."""
    cart_back_slip: float
    """Of the cart in a cycle, the mean of all [m]."""


def rest_rules(values: PaperValues, cart: PendulumCart = CART) -> tuple[RestRule, ...]:
    """Run the released block and the cart exactly, and in steps with each rule.

    The band is that of Karnopp (1985), the paper's reference [18]: a body slower than it is held
    while the force needed is within break-away. A step changes the velocity by ``F_c dt / m``, and
    can jump over a narrower band. With a rule, friction begins at F_s; without one, sgn 0 = 0.

    Examples
    --------
    >>> from stickslip import load_rig
    >>> from stickslip.paper import PaperValues, rest_rules
    >>> [rule.reversals for rule in rest_rules(PaperValues.of(load_rig()))][:4]
    [0, 50, 49, 0]
    """
    period = float(swing_of(cart).period)
    law = Coulomb(kinetic_coefficient=values.mu_k, static_coefficient=values.mu_s)
    found = []
    for dt, stick_rule, band in ((None, True, 0.0), *RULES):
        solver = None
        if dt is not None:
            solver = FixedStep(
                dt=dt,
                stick_rule=stick_rule,
                zero_velocity_band=band,
                break_away="static" if stick_rule or band else "zero",
            )
        block = simulate(values.rig, law, t_end=SECONDS, solver=solver)
        driven = simulate(cart, law, t_end=CYCLES * period, solver=solver)
        cycles = cycles_in(driven, cart, period)
        signs = [1 if value > 0 else -1 for value in block["v"] if value != 0]
        found.append(
            RestRule(
                dt=dt,
                stick_rule=stick_rule,
                band=band,
                block=criteria_of(block, values.rig),
                reversals=sum(a != b for a, b in itertools.pairwise(signs)),
                rests=bool(block["v"][-1] == 0.0),
                cart_travel=sum(one.travel for one in cycles),
                cart_back_slip=sum(one.backward for one in cycles) / len(cycles),
            )
        )
    return tuple(found)
