"""Functions for equations: one name for floats, NumPy arrays and traced symbols.

Laws and mechanisms are written once with these. A float gives a float, an array an array, and a
symbol (anything whose class has `__maths__`) an expression.
"""

import math
from typing import Any, Protocol, TypeAlias, TypeGuard, runtime_checkable

__all__ = ["Scalar", "arctan", "cos", "exp", "log", "power", "sign", "sin", "sqrt", "tanh", "where"]

Scalar: TypeAlias = Any
"""A float, an array or a symbol. Equations are generic in it, which the type system cannot say."""


@runtime_checkable
class Symbolic(Protocol):
    """What a symbol offers to the functions of this module."""

    def __maths__(self, name: str, *arguments: Scalar) -> Scalar:
        """Return the expression for a call of `name`."""


def _symbolic(x: object) -> TypeGuard[Symbolic]:
    # what isinstance asks of a protocol, at a tenth of its price: laws ask for each sample
    return hasattr(x, "__maths__")


def _call(name: str, x: Scalar) -> Scalar:
    if isinstance(x, (float, int)):
        return getattr(math, name)(x)
    if _symbolic(x):
        return x.__maths__(name, x)
    import numpy as np

    return getattr(np, {"atan": "arctan"}.get(name, name))(x)


def exp(x: Scalar) -> Scalar:
    """Exponential."""
    return _call("exp", x)


def log(x: Scalar) -> Scalar:
    """Natural logarithm."""
    return _call("log", x)


def sqrt(x: Scalar) -> Scalar:
    """Square root."""
    return _call("sqrt", x)


def sin(x: Scalar) -> Scalar:
    """Sine of an angle in radians."""
    return _call("sin", x)


def cos(x: Scalar) -> Scalar:
    """Cosine of an angle in radians."""
    return _call("cos", x)


def tanh(x: Scalar) -> Scalar:
    """Hyperbolic tangent."""
    return _call("tanh", x)


def arctan(x: Scalar) -> Scalar:
    """Inverse tangent, in radians."""
    return _call("atan", x)


def sign(x: Scalar) -> Scalar:
    """Sign, 0 at 0; of a symbol the sign of its mode, and a switch where the mode does not say.

    Examples
    --------
    >>> sign(-2.0)
    -1.0
    """
    if isinstance(x, (float, int)):
        return math.copysign(1.0, x) if x else 0.0
    if _symbolic(x):
        return x.__maths__("sign", x)
    import numpy as np

    return np.sign(x)


def power(base: Scalar, exponent: Scalar) -> Scalar:
    """Return ``base ** exponent``; for a fractional exponent 0 where the base is not positive.

    Stages of a solver overshoot v = 0 by a little; a fractional power and its derivatives would be
    NaN there, and are 0 instead.

    Parameters
    ----------
    base : float or array
        The base.
    exponent : float or array
        The exponent.

    Returns
    -------
    float or array
        The power.

    Examples
    --------
    >>> power(4.0, 0.5), power(-1e-9, 0.5)
    (2.0, 0.0)
    """
    for argument in (base, exponent):
        if _symbolic(argument):
            return argument.__maths__("power", base, exponent)
    if isinstance(base, (float, int)) and isinstance(exponent, (float, int)):
        whole = float(exponent).is_integer()
        return float(base) ** exponent if whole or base > 0 else 0.0
    import numpy as np

    if np.ndim(exponent) == 0 and float(exponent).is_integer():
        return np.asarray(base) ** int(exponent)

    positive = np.asarray(base) > 0
    return np.where(positive, np.power(np.where(positive, base, 1.0), exponent), 0.0)


def where(condition: Any, yes: Scalar, no: Scalar, events: tuple[str, str] | None = None) -> Scalar:
    """Return `yes` where the condition holds, else `no`; in traced equations a located switch.

    Parameters
    ----------
    condition : bool, array or traced comparison
        What decides.
    yes, no : float, array or symbol
        The two branches.
    events : (str, str), optional
        What to call the switch in the events of a run, when it comes true and when it ceases to
        hold. Without names it stays inside.

    Returns
    -------
    float or array
        The branch that the condition chooses, entry by entry for arrays.

    Examples
    --------
    >>> where(1.0 < 2.0, 3.0, 4.0)
    3.0
    """
    if isinstance(condition, bool):
        return yes if condition else no
    if _symbolic(condition):
        return condition.__maths__("where", yes, no, events)
    import numpy as np

    return np.where(condition, yes, no)
