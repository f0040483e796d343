"""A program as data: functions of assignments, branches and calls, which languages print."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias, final

import symengine as se


@final
@dataclass(frozen=True, kw_only=True)
class Variable:
    """An argument or a result of a function."""

    name: str
    """Its name, which all languages accept."""
    unit: str
    """SI unit; empty for a sense or a truth value."""
    meaning: str
    """What it is, in words."""
    positive: bool = False
    """Whether nothing but a number above 0 makes sense."""


@final
@dataclass(frozen=True, kw_only=True)
class Constant:
    """A parameter of a law in a program."""

    name: str
    """Its name, which all languages accept."""
    value: float
    """Value [SI]."""
    unit: str
    """SI unit."""
    meaning: str
    """Name of the field, and how well the value is known."""


@final
@dataclass(frozen=True)
class Assign:
    """Gives names the values of expressions, which share what they have in common."""

    names: tuple[str, ...]
    """Names, in the order of the values."""
    values: tuple[se.Expr, ...]
    """Their values, none of which contains one of the names after the first."""


@final
@dataclass(frozen=True)
class Call:
    """Gives names the results of another function of the program."""

    names: tuple[str, ...]
    """Names, in the order of the results."""
    function: str
    """Name of the function."""
    arguments: tuple[se.Expr, ...]
    """What it is called with."""


@final
@dataclass(frozen=True)
class Branch:
    """Statements for where one value is below another, and for elsewhere."""

    left: se.Expr
    """The smaller value."""
    right: se.Expr
    """The larger value."""
    yes: tuple["Statement", ...]
    """Where `left` is below `right`."""
    no: tuple["Statement", ...] = ()
    """Elsewhere."""


@final
@dataclass(frozen=True)
class Repeat:
    """Statements that are repeated so many times, or until `Leave`."""

    times: int
    """Most repetitions."""
    body: tuple["Statement", ...]
    """The statements."""


@final
@dataclass(frozen=True)
class Leave:
    """Ends the innermost `Repeat`."""


Statement: TypeAlias = Assign | Branch | Call | Repeat | Leave


@final
@dataclass(frozen=True, kw_only=True)
class Function:
    """A function of a program."""

    name: str
    """Its name without that of the program."""
    summary: str
    """What it returns, in a sentence."""
    inputs: tuple[Variable, ...]
    """Its arguments."""
    outputs: tuple[Variable, ...]
    """Its results."""
    body: tuple[Statement, ...]
    """What it does."""
    inner: bool = False
    """Whether other functions of the program alone call it, with arguments that they checked."""


def floored(name: str, value: se.Expr) -> tuple[Statement, ...]:
    """Return the assignment of a value, or of 0 where it is negative."""
    zero = se.Integer(0)
    below = Branch(se.Symbol(name), zero, (Assign((name,), (zero,)),))
    return Assign((name,), (value,)), below


def renamed(body: tuple[Statement, ...], names: Mapping[str, str]) -> tuple[Statement, ...]:
    """Return statements with other names of variables."""
    symbols = {se.Symbol(old): se.Symbol(new) for old, new in names.items()}

    def called_by(old: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(names.get(one, one) for one in old)

    def in_new(values: tuple[se.Expr, ...]) -> tuple[se.Expr, ...]:
        return tuple(se.sympify(one).subs(symbols) for one in values)

    def of(one: Statement) -> Statement:
        match one:
            case Assign():
                return Assign(called_by(one.names), in_new(one.values))
            case Call():
                return Call(called_by(one.names), one.function, in_new(one.arguments))
            case Branch():
                left, right = in_new((one.left, one.right))
                return Branch(left, right, renamed(one.yes, names), renamed(one.no, names))
            case Repeat():
                return Repeat(one.times, renamed(one.body, names))
            case Leave():
                return one

    return tuple(map(of, body))


def _inside(one: Statement) -> tuple[Statement, ...]:
    """Return the statements that a statement holds."""
    if isinstance(one, Branch):
        return (*one.yes, *one.no)
    return one.body if isinstance(one, Repeat) else ()


def assigned(body: tuple[Statement, ...]) -> Iterator[str]:
    """Yield the names that statements assign, in order; one may come twice."""
    for one in body:
        yield from assigned(_inside(one))
        if isinstance(one, Assign | Call):
            yield from one.names


def called(body: tuple[Statement, ...]) -> Iterator[str]:
    """Yield the names of the functions that statements call."""
    for one in body:
        yield from called(_inside(one))
        if isinstance(one, Call):
            yield one.function


def used(body: tuple[Statement, ...]) -> set[str]:
    """Return the names that occur in the values, conditions and arguments of statements."""
    names: set[str] = set()
    for one in body:
        names |= used(_inside(one))
        values: tuple[se.Expr, ...] = ()
        if isinstance(one, Assign):
            values = one.values
        elif isinstance(one, Branch):
            values = (one.left, one.right)
        elif isinstance(one, Call):
            values = one.arguments
        names |= {str(symbol) for value in values for symbol in value.free_symbols}
    return names
