"""Classes whose `help` is readable: their fields with meaning, type, unit and range.

The text after a field is in the source alone, and `Annotated` types fill pages. Both are looked at
when somebody asks for the docstring or the signature of a class, not when it is imported.
"""

import ast
import dataclasses
import functools
import inspect
import operator
import re
import sys
import types
import typing
from abc import ABCMeta
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any

from typing_extensions import Doc

from stickslip.errors import ParameterError, UnknownNameError

SECTION = re.compile(r"\n+ *(?=(Raises|Warns|See Also|Notes|References|Examples)\n *---)")
"""Where a section of a docstring begins that follows the one on parameters."""


class Described(ABCMeta):
    r"""The type of dataclasses whose docstring has a section on their fields.

    Examples
    --------
    >>> from stickslip import Viscous
    >>> import inspect
    >>> inspect.signature(Viscous)
    <Signature (*, viscous_coefficient: float) -> None>
    >>> print(*inspect.getdoc(Viscous).splitlines()[3:6], sep="\n")
    viscous_coefficient : float
        Growth of the friction force with the slip speed.
        sigma_2: at least 0 N s/m.
    """

    if not TYPE_CHECKING:  # type checkers read off the fields what a constructor takes

        def __call__(cls, *args: Any, **values: Any) -> Any:
            """Make an object; what does not fit its fields is refused by their names."""
            try:
                return type.__call__(cls, *args, **values)
            except TypeError:
                _check_names(cls, args, values)
                raise

    @property
    def __signature__(cls) -> inspect.Signature:
        """The signature of the constructor, with types but without what is declared of them."""
        constructor = getattr(cls, "__init__")  # noqa: B009  # of the class itself
        annotations = getattr(constructor, "__annotations__", {})
        hints = _hints(cls)
        for name, hint in annotations.items():  # changed in place: `help` shows `__init__` too
            annotations[name] = _plain(hints.get(name, hint))
        whole = inspect.signature(constructor)
        return whole.replace(parameters=[*whole.parameters.values()][1:])

    @property
    def __doc__(cls) -> str | None:
        """The docstring, with a section on the fields unless it has one."""
        written: str | None = vars(cls).get("__doc__")
        if not written or "__match_args__" not in vars(cls):  # `dataclass` asks before it is done
            return written
        text = inspect.cleandoc(written)
        fields = "\n".join(_entries(cls))
        if not fields or "\nParameters\n" in text:
            return text
        section = f"\n\nParameters\n----------\n{fields}"
        result = SECTION.search(text)
        if not result:
            return text + section
        return f"{text[: result.start()]}{section}\n\n{text[result.end() :]}"

    @__doc__.setter
    def __doc__(cls, text: str | None) -> None:
        type.__dict__["__doc__"].__set__(cls, text)


def _check_names(kind: type, args: Sequence[object], values: Mapping[str, object]) -> None:
    """Refuse arguments of a constructor without a name, of an unknown one, and missing ones."""
    if inspect.isabstract(kind) or not dataclasses.is_dataclass(kind):
        return
    fields = {field.name: field for field in dataclasses.fields(kind) if field.init}
    hints = _hints(kind)
    annotations = {name: [*marks(hints.get(name))] for name in fields}
    symbols = {
        name: mark.symbol
        for name, annotated in annotations.items()
        for mark in annotated
        if hasattr(mark, "symbol")
    }
    for name in values:
        if name not in fields:
            raise UnknownNameError(f"parameter of {kind.__name__}", name, fields, symbols)
    by_place = [name for name, field in fields.items() if not field.kw_only]
    if len(args) > len(by_place):
        first = next((name for name in fields if name not in values), "")
        cure = f"{kind.__name__}({first}=...)" if first else f"{kind.__name__}(...)"
        raise ParameterError(
            f"{kind.__name__} takes parameters by name: write {cure}, got {args[-1]!r} without one."
        )
    missing = dataclasses.MISSING
    for name, field in fields.items():
        given = name in values or name in by_place[: len(args)]
        if field.default is field.default_factory is missing and not given:
            said = next((str(mark) for mark in annotations[name] if hasattr(mark, "symbol")), "")
            raise ParameterError(
                f"{kind.__name__} lacks {name}" + (f" ({said})" if said else "") + ": give it by"
                f" name, {kind.__name__}({name}=...)."
            )


def alternatives(hint: Any) -> tuple[Any, ...]:
    """Return the types of a union, or the one type.

    Examples
    --------
    >>> alternatives(float | None)
    (<class 'float'>, <class 'NoneType'>)
    """
    is_union = typing.get_origin(hint) in (typing.Union, types.UnionType)
    return typing.get_args(hint) if is_union else (hint,)


def marks(hint: Any) -> Iterator[Any]:
    """Yield what a type, or an alternative of it, is annotated with.

    Examples
    --------
    >>> from typing import Annotated
    >>> [*marks(Annotated[float, "N"] | None)]
    ['N']
    """
    for alternative in alternatives(hint):
        yield from getattr(alternative, "__metadata__", ())


def with_marks(hint: Any, change: Callable[[Any], Any]) -> Any:
    """Return a type with each thing that it is annotated with changed.

    Examples
    --------
    >>> from typing import Annotated
    >>> with_marks(Annotated[float, "N"], str.lower).__metadata__
    ('n',)
    """
    result = []
    for alternative in alternatives(hint):
        told = tuple(map(change, getattr(alternative, "__metadata__", ())))
        result.append(Annotated[(alternative.__origin__, *told)] if told else alternative)
    return functools.reduce(operator.or_, result)


def texts_below(kind: type) -> Mapping[str, str]:
    """Return what is written of the fields of a class: below them, in its bases too, or in `Doc`.

    Examples
    --------
    >>> from stickslip import Axis
    >>> texts_below(Axis)["inertia"]
    'Mass [kg] or moment of inertia [kg m^2].'
    """
    result: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        result |= _written(base) if dataclasses.is_dataclass(base) else {}
    for name, hint in _hints(kind).items():
        for mark in marks(hint):
            if isinstance(mark, Doc):
                result.setdefault(name, mark.documentation)
    return result


def _written(kind: type) -> Mapping[str, str]:
    """Return the names in a class body that a text follows; none where there is no source."""
    try:
        return _texts_of(sys.modules[kind.__module__]).get(kind.__qualname__, {})
    except (KeyError, OSError, TypeError, SyntaxError, ValueError):
        return {}


@functools.cache
def _texts_of(module: types.ModuleType) -> Mapping[str, Mapping[str, str]]:
    """Return the fields with a text below, by class; a module is read once for all its classes."""
    result: dict[str, Mapping[str, str]] = {}

    def enter(body: Sequence[ast.stmt], place: str) -> None:
        for node in body:
            if isinstance(node, ast.ClassDef):
                result[place + node.name] = _texts_in(node)
                enter(node.body, f"{place}{node.name}.")
            elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                enter(node.body, f"{place}{node.name}.<locals>.")

    enter(ast.parse(inspect.getsource(module)).body, "")
    return result


def _texts_in(node: ast.ClassDef) -> Mapping[str, str]:
    return {
        before.target.id: inspect.cleandoc(after.value.value)
        for before, after in pairwise(node.body)
        if isinstance(before, ast.AnnAssign)
        and isinstance(before.target, ast.Name)
        and isinstance(after, ast.Expr)
        and isinstance(after.value, ast.Constant)
        and isinstance(after.value.value, str)
    }


def _entries(kind: type) -> Iterator[str]:
    """Yield what a docstring says of each field."""
    texts, hints = texts_below(kind), _hints(kind)
    for field in dataclasses.fields(kind):
        if field.name.startswith("_") or not field.init:
            continue
        hint = hints.get(field.name, field.type)
        ranges = [f"{mark}." for mark in marks(hint) if not isinstance(mark, Doc)]
        # reStructuredText takes mu_+ for a link
        ranges = [re.sub(r"^(\w+_[+-]):", r"``\1``:", name) for name in ranges]
        yield f"{field.name} : {_kind_in_words(field, hint)}"
        lines = [*texts.get(field.name, "").splitlines(), *ranges]
        yield from (f"    {line}" for line in lines)


def _hints(kind: type) -> Mapping[str, Any]:
    """Return the types of fields; none where they need what only type checkers import."""
    try:
        return typing.get_type_hints(kind, include_extras=True)
    except NameError:
        return {}


def _kind_in_words(field: "dataclasses.Field[Any]", hint: Any) -> str:
    plain = _plain(hint)
    named = plain if isinstance(plain, str) else inspect.formatannotation(plain)
    named = re.sub(r"\b(?:\w+\.)+(\w+?)_?\b", r"\1", named).replace("'", "")  # np.object_: object
    if typing.get_origin(plain) is typing.Literal:
        named = f"{{{', '.join(map(repr, typing.get_args(plain)))}}}"
    if field.default not in (dataclasses.MISSING, None, "", ()):
        return f"{named}, default {field.default!r}"
    required = field.default is field.default_factory is dataclasses.MISSING
    return named if required else f"{named.removesuffix(' | None')}, optional"


def _plain(hint: Any) -> Any:
    """Return a type without what `Annotated` says of it."""
    if hasattr(hint, "__metadata__"):
        return hint.__origin__
    parts = alternatives(hint)
    if any(hasattr(part, "__metadata__") for part in parts):
        return functools.reduce(operator.or_, map(_plain, parts))
    return hint
