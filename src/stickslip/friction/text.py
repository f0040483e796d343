"""Equations of a composition as Python text for floats: walking its parts is paid for once."""

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, final

from stickslip.friction.base import bound
from stickslip.maths import Scalar, latched, power, sign
from stickslip.quantities import fields_of, unchecked


@final
class Written:
    """An expression in Python; what is done to it is written down."""

    __slots__ = ("text",)
    __hash__ = None  # type: ignore[assignment]  # an expression is no value

    def __init__(self, text: str) -> None:
        self.text = text

    def __maths__(self, name: str, *arguments: Scalar) -> "Written":
        """Write a function of `stickslip.maths`; of a choice only the branch taken is evaluated."""
        if name == "where":
            yes, no, _ = arguments
            return Written(f"({_text(yes)} if {self.text} else {_text(no)})")
        given = [*map(_text, arguments)]
        match name, arguments:
            case "power", (_, float(exponent)) if exponent.is_integer():
                return Written(f"({given[0]} ** {given[1]})")
            case "sign", _ if given[0].isidentifier():
                return Written(f"(copysign(1.0, {given[0]}) if {given[0]} else 0.0)")
        return Written(f"{name}({', '.join(given)})")

    def __add__(self, other: Scalar) -> "Written":
        return Written(f"({self.text} + {_text(other)})")

    def __radd__(self, other: Scalar) -> "Written":
        return Written(f"({_text(other)} + {self.text})")

    def __sub__(self, other: Scalar) -> "Written":
        return Written(f"({self.text} - {_text(other)})")

    def __rsub__(self, other: Scalar) -> "Written":
        return Written(f"({_text(other)} - {self.text})")

    def __mul__(self, other: Scalar) -> "Written":
        return Written(f"({self.text} * {_text(other)})")

    def __rmul__(self, other: Scalar) -> "Written":
        return Written(f"({_text(other)} * {self.text})")

    def __truediv__(self, other: Scalar) -> "Written":
        return Written(f"({self.text} / {_text(other)})")

    def __rtruediv__(self, other: Scalar) -> "Written":
        return Written(f"({_text(other)} / {self.text})")

    def __neg__(self) -> "Written":
        return Written(f"(-{self.text})")

    def __abs__(self) -> "Written":
        return Written(f"abs({self.text})")

    def __lt__(self, other: Scalar) -> "Written":
        return Written(f"{self.text} < {_text(other)}")

    def __gt__(self, other: Scalar) -> "Written":
        return Written(f"{self.text} > {_text(other)}")

    def __bool__(self) -> bool:
        raise TypeError(
            "a condition in equations of friction is written with stickslip.maths.where"
        )


def _text(value: Scalar) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(map(_text, value))},)"
    return value.text if isinstance(value, Written) else repr(float(value))


NAMES: Mapping[str, Any] = {
    name: getattr(math, name)
    for name in ("atan", "copysign", "cos", "exp", "log", "sin", "sqrt", "tanh")
} | {"latched": latched, "power": power, "sign": sign}


def for_floats(
    kind: type, name: str, equation: Callable[..., Scalar], arguments: Sequence[str]
) -> Callable[..., Scalar]:
    """Return a method that evaluates floats by text of its own, and all else by the equation.

    The text is written at the first call, which puts it in the place of this method.
    """

    @functools.wraps(equation)
    def first(law: Any, *given: Scalar, **named: Scalar) -> Scalar:
        setattr(kind, name, _dispatching(kind, equation, arguments))
        return getattr(law, name)(*given, **named)

    return first


def _dispatching(
    kind: type, equation: Callable[..., Scalar], arguments: Sequence[str]
) -> Callable[..., Scalar]:
    """Return the method by text: a function for each shape of laws, written when it is met."""
    shaping = [name for name, one in fields_of(kind).items() if one.structural]
    shaping += [name for name in fields_of(kind) if getattr(kind, name, 0.0) is None]
    known: dict[tuple[float | None, ...], Callable[..., Scalar]] = {}

    def made(law: Any) -> Callable[..., Scalar]:
        """Return the function for laws that are shaped as this one."""
        values: dict[str, Any] = {}
        lines = []
        for name, quantity in fields_of(kind).items():
            value = getattr(law, name)
            if quantity.stands_in_equations(value):
                value = Written(f"p_{name}")
                lines.append(f"    p_{name} = law.{name}\n")
            values[name] = value
        told = {name: Written(f"x_{name}") for name in law.inputs}
        lines += [f"    x_{name} = law.contact({name!r})\n" for name in law.inputs]
        twin: Any = bound(unchecked(kind, **values), told)
        given = [
            tuple(Written(f"{name}[{i}]") for i in range(len(law.states)))
            if name == "states"
            else Written(name)
            for name in arguments
        ]
        result = _text(equation(twin, *given))
        used = "".join(line for line in lines if line.split()[0] in result)
        text = f"def made(law, {', '.join(arguments)}):\n{used}    return {result}\n"
        space = dict(NAMES)
        exec(text, space)
        function: Callable[..., Scalar] = space["made"]
        return function

    asked = [name for name in arguments if name != "states"]
    asked += [f"law.contact({name!r})" for name in getattr(kind, "inputs", ())]
    floats = " and ".join(f"type({one}) is float" for one in asked)
    # what shapes the equations: a whole exponent, a level that is not given
    shape = "".join(
        f"law.{name} if law.{name}.is_integer() else None, "
        if fields_of(kind)[name].structural
        else f"law.{name} is None, "
        for name in shaping
    )
    given = ", ".join(arguments)
    signature = given.replace("states", "states=()")
    space: dict[str, Any] = {"made": made, "equation": equation, "known": known}
    exec(DISPATCH.format(given=given, signature=signature, floats=floats, shape=shape), space)
    return functools.wraps(equation)(space["evaluated"])


DISPATCH = """
def evaluated(law, {signature}):
    if {floats}:
        try:
            shape = ({shape})
            function = known.get(shape)
            if function is None:
                function = known[shape] = made(law)
            return function(law, {given})
        except (AttributeError, IndexError, TypeError, ValueError):
            pass  # parameters are arrays or symbols
    return equation(law, {given})
"""
