"""What the equations ask of a law: that its friction is affine in the load."""

import symengine as se

from stickslip.errors import TracingError
from stickslip.formulation.trace import collapsed
from stickslip.friction import FrictionLaw

__all__ = ["load_factor"]


def load_factor(law: FrictionLaw, friction: se.Expr, load: se.Symbol) -> se.Expr:
    """Return b of friction a + b N.

    Parameters
    ----------
    law : FrictionLaw
        The law, for the message.
    friction : Expr
        Its friction force or its break-away level.
    load : Symbol
        The load N.

    Returns
    -------
    Expr
        The derivative with respect to the load.

    Raises
    ------
    TracingError
        If it depends on the load itself.
    """
    factor = collapsed(friction.diff(load))
    if se.expand(collapsed(factor.diff(load))) != 0:
        raise TracingError(
            f"{type(law).__name__}: friction must be affine in the load, F = a + b N; its second"
            " derivative with respect to N is not zero"
        )
    return factor
