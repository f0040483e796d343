"""Functions for equations: one name for floats, NumPy arrays and traced symbols.

Laws and mechanisms are written once with these. A float gives a float, an array an array, and a
symbol (anything whose class has `__maths__`) an expression.
"""

import math
from collections.abc import Iterable
from contextvars import ContextVar
from typing import Any, Protocol, TypeAlias, TypeGuard, runtime_checkable

from stickslip.errors import InputError

__all__ = [
    "Latches",
    "Scalar",
    "arctan",
    "cos",
    "exp",
    "latched",
    "log",
    "power",
    "sign",
    "sin",
    "sqrt",
    "tanh",
    "where",
]

NO_COMPARISON = (
    "where chooses by a comparison, and got a value: write where(x > 0.0, yes, no) instead of"
    " where(x, yes, no)."
)

NORMAL_95 = 1.959963984540054
"""Half-width of an interval of 95 % of a normal distribution over its standard deviation."""

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

    Raises
    ------
    InputError
        If the condition is a number, not a comparison.

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

    if np.asarray(condition).dtype != bool:
        raise InputError(NO_COMPARISON)
    return np.where(condition, yes, no)


def latched(margin: Scalar, hold: Scalar, yes: Scalar, no: Scalar) -> Scalar:
    """Return `yes` from where the margin becomes positive for as long as `hold` is, else `no`.

    It is on from where the margin becomes positive, and stays on whatever becomes of the margin. It
    ends where slip turns or stops, if `hold` is negative then; where `hold` is 0 the margin decides
    again. A state that is left by another rule than it is entered by, as an element that slips
    until the velocity turns, is written so.

    Numbers alone do not tell whether it is on: they are evaluated within `Latches`, which know.
    """
    for argument in (margin, hold, yes, no):
        if _symbolic(argument):
            return argument.__maths__("latched", margin, hold, yes, no)
    flags = _AT_HAND.get()
    if flags is None:
        raise InputError(
            "the equation has a latched switch, and numbers alone do not tell whether it is on:"
            " simulate, or evaluate it within stickslip.maths.Latches()."
        )
    return where(flags.on(margin, hold), yes, no)


class Latches:
    """Which latched switches of an equation are on, while it is evaluated with numbers.

    They stay as they are until `turn` is called, as a solver does at the end of a step: within a
    step nothing switches.

    Parameters
    ----------
    flags : iterable of bool or array, optional
        Whether each is on, in the order in which the equation asks.
    off : bool, optional
        Whether those that are not given are off at first; by default their margins tell.

    Examples
    --------
    >>> flags = Latches()
    >>> def slips(z, v):
    ...     with flags:
    ...         return latched(z - 1.0, z * v, yes=True, no=False)
    >>> slips(1.1, 0.5), slips(0.9, 0.5), flags.turn(), slips(0.9, 0.5)
    (True, True, None, True)
    >>> slips(0.9, -0.5), flags.turn(), slips(0.9, -0.5)
    (True, None, False)
    """

    def __init__(self, flags: Iterable[Any] = (), *, off: bool = False) -> None:
        self.flags = list(flags)
        """Whether each is on."""
        self._off = off
        self._asked: list[tuple[Scalar, Scalar]] = []
        self._before: Any = None

    def __enter__(self) -> None:
        self._asked.clear()
        self._before = _AT_HAND.set(self)

    def __exit__(self, *_: object) -> None:
        _AT_HAND.reset(self._before)

    def __bool__(self) -> bool:
        """Whether there are any, as the first evaluation shows."""
        return bool(self.flags)

    def on(self, margin: Scalar, hold: Scalar) -> Any:
        """Return whether a switch is on; equations ask for all of theirs in the same order."""
        self._asked.append((margin, hold))
        if len(self._asked) > len(self.flags):
            self.flags.append(False if self._off else margin > 0.0)
        return self.flags[len(self._asked) - 1]

    def turn(self) -> None:
        """Turn the switches by what was last asked for."""
        for k, (margin, hold) in enumerate(self._asked):
            begins, lasts = margin > 0.0, self.flags[k]
            self.flags[k] = (hold >= 0.0) & (begins | (lasts & (hold > 0.0)))


_AT_HAND: ContextVar[Latches | None] = ContextVar("latches", default=None)
"""The flags by which equations are evaluated."""


def __dir__() -> list[str]:
    return sorted(__all__)
