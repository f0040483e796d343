"""The exceptions of stickslip: each is ours and also the built-in a caller would expect."""

import difflib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

__all__ = [
    "CompilationError",
    "ConformanceError",
    "ConvergenceError",
    "InputError",
    "ParameterError",
    "SimulationError",
    "StickslipError",
    "TracingError",
    "UndeclaredError",
    "UnknownNameError",
    "check_columns",
    "check_even_times",
    "check_size",
    "concerning",
    "nearest",
    "not_whole",
]

LONGEST = 60
"""Longest name that a message repeats in full."""
MOST = 50
"""Most known names that a message lists."""
MOST_NUMBERS = 100_000_000
"""Most numbers that a table, a grid or an ensemble may have: 800 MB, before any is copied."""
MOST_COLUMNS = 4096
"""Most columns that a table of measured data may have."""
COMPARED = 200
"""Longest names that are compared; what that takes grows with the square of their length."""


class StickslipError(Exception):
    """Base of all errors raised on purpose."""


class InputError(StickslipError, ValueError):
    """Something the user gave cannot be used; the message says what, why and the cure."""


class ParameterError(InputError):
    """A parameter is missing, of the wrong kind or outside its range."""


class UndeclaredError(InputError, AttributeError):
    """A class does not say of itself what every class of its kind has to."""


class UnknownNameError(InputError, LookupError):
    """A name that is not known; the message lists the nearest known ones.

    Parameters
    ----------
    kind : str
        What the name stands for, such as ``"law"``.
    name : str
        The unknown name.
    known : iterable of str
        The known ones.
    symbols : mapping of str to str, optional
        Symbols by known name, to which the name may be close as well.
    """

    def __init__(
        self, kind: str, name: str, known: Iterable[str], symbols: Mapping[str, str] | None = None
    ) -> None:
        name, known, symbols = str(name), tuple(sorted(known)), dict(symbols or {})
        self.kind, self.name, self.known, self.symbols = kind, name, known, symbols

        def shown(key: str) -> str:
            return f" ({symbols[key]})" if key in symbols else ""

        named = [key for key in known if symbols.get(key) == name]
        close = " or ".join(f"{key!r}{shown(key)}" for key in named or _near(name, known, symbols))
        more = f" and {len(known) - MOST} more" if len(known) > MOST else ""
        listed = ", ".join(_shortened(key) + shown(key) for key in known[:MOST]) + more
        hint = f"Did you mean {close}?" if close else f"Known: {listed or 'none'}."
        super().__init__(f"unknown {kind} {_shortened(name)!r}. {hint}")

    def __reduce__(
        self,
    ) -> tuple[type["UnknownNameError"], tuple[str, str, tuple[str, ...], dict[str, str]]]:
        """Rebuild from what it was made of, so that it crosses processes."""
        return type(self), (self.kind, self.name, self.known, self.symbols)


class TracingError(StickslipError, TypeError):
    """A law or a mechanism does something with a symbol that only works with numbers."""


class SimulationError(StickslipError, RuntimeError):
    """A run ended before its time or could not be certified."""


class CompilationError(StickslipError, RuntimeError):
    """Equations could not be compiled."""


class ConformanceError(StickslipError, AssertionError):
    """A law or a mechanism is not what the solver takes it for; the message lists the findings."""


class ConvergenceError(StickslipError, RuntimeError):
    """A fit or a search found no answer."""


def _shortened(name: str) -> str:
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 3]}..."


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the known names closest to `name`, ready to print, or an empty string.

    Examples
    --------
    >>> nearest("frction", ["friction", "mechanism"])
    "'friction'"
    """
    return " or ".join(map(repr, _near(name, known, {})))


def _near(name: str, known: Iterable[str], symbols: Mapping[str, str]) -> list[str]:
    """Return the known names that are closest to a name, or whose symbols are; two at most."""
    if len(name) > COMPARED:
        return []
    words = {symbols[key]: key for key in known if key in symbols} | {key: key for key in known}
    near = [word for word in words if len(word) <= COMPARED]
    return [*dict.fromkeys(words[key] for key in difflib.get_close_matches(name, near, n=2))]


@contextmanager
def concerning(what: str, kind: type[InputError] = ParameterError) -> Iterator[None]:
    """Put what something is of before the message of an error that refuses it, once.

    Examples
    --------
    >>> with concerning("--load"):
    ...     raise ParameterError("(N) must be above 0 N, got -1.")
    Traceback (most recent call last):
    stickslip.errors.ParameterError: --load (N) must be above 0 N, got -1.
    """
    try:
        yield
    except kind as error:
        raised = ParameterError if isinstance(error, ParameterError) else InputError
        text = str(error)
        raise raised(text if text.startswith(what) else f"{what} {text}") from None


def check_size(
    what: str, count: float, cure: str, *, unit: str = "numbers", most: float = MOST_NUMBERS
) -> None:
    """Refuse what would hold too many numbers, before memory is taken for it.

    A few bytes of a file or of an argument may stand for any amount of memory: whatever makes
    arrays of a size that somebody else chose asks here first.

    Examples
    --------
    >>> check_size("ensemble", 1e9 * 3, "make several smaller ones")
    Traceback (most recent call last):
    stickslip.errors.InputError: ensemble: 3e+09 numbers exceed the limit of 1e+08: make several ...
    """
    if not count <= most:
        raise InputError(f"{what}: {count:.4g} {unit} exceed the limit of {most:.4g}: {cure}.")


def check_columns(what: str, number: int) -> None:
    """Refuse a table of so many columns that to look at each of them would take minutes."""
    check_size(
        what, number, "leave out those that are no signals", unit="columns", most=MOST_COLUMNS
    )


def check_even_times(count: float) -> None:
    """Refuse to interpolate a record at even times where one of them is far from all others."""
    check_size("record at even times", count, "cut the record where its times leap")


def not_finite(value: object) -> str:
    """Return that a number of an equation is none that can be computed with.

    Examples
    --------
    >>> not_finite(float("inf"))
    'an equation contains inf, which is no finite number'
    """
    return f"an equation contains {value!r}, which is no finite number"


def not_whole(name: str, least: int, value: object) -> str:
    """Return the sentence that refuses what is no whole number, or too small a one.

    Examples
    --------
    >>> not_whole("steps", 1, 2.5)
    'steps must be a whole number of at least 1, got 2.5.'
    """
    return f"{name} must be a whole number of at least {least}, got {value!r}."


def __dir__() -> list[str]:
    return sorted(__all__)
