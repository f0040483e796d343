"""What the equations ask of a law: that its friction is affine in the load."""

import symengine as se

from stickslip.errors import TracingError
from stickslip.formulation.trace import collapsed
from stickslip.friction import FrictionLaw


def load_factor(law: FrictionLaw, friction: se.Expr, load: se.Symbol) -> se.Expr:
    """Return b of friction a + b N."""
    factor = collapsed(friction.diff(load))
    if se.expand(collapsed(factor.diff(load))) != 0:
        raise TracingError(
            f"{type(law).__name__}: friction must be affine in the load, F = a + b N; its second"
            " derivative with respect to N is not zero"
        )
    return factor
