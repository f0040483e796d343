"""Public names of a package that are loaded when they are first asked for."""

import importlib
import sys
from collections.abc import Callable, Mapping

__all__ = ["attach"]


def attach(
    package: str, homes: Mapping[str, str], moved: Mapping[str, str] | None = None
) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Return the ``__getattr__`` and ``__dir__`` of a package whose names are loaded lazily.

    Type checkers and editors cannot follow them: what they read is the ``__init__.pyi`` that
    ``tools/stubs.py`` writes from the same table.

    Parameters
    ----------
    package : str
        Name of the package.
    homes : mapping of str to str
        By public name, the module of the package that defines it.
    moved : mapping of str to str, optional
        By a name that the package had once, the module where it is now.

    Returns
    -------
    (callable, callable)
        ``__getattr__``, which raises `MovedError` for names that were moved, or `MovedImportError`
        where they are imported, and `AttributeError` for others that are not listed; and
        ``__dir__``.

    Examples
    --------
    >>> load, names = attach("stickslip", {"Coulomb": "friction", "simulate": "simulation"})
    >>> names()
    ['Coulomb', 'simulate']
    >>> load("Coulomb").name
    'coulomb'
    """

    def load(name: str) -> object:
        if moved is not None and name in moved:
            from stickslip.errors import MovedError, MovedImportError  # not with the package

            home = f"{package}.{moved[name]}"
            kind = MovedImportError if _is_import() else MovedError
            error = kind(f"{package}.{name} is {home}.{name} now: from {home} import {name}.")
            error.name = name  # else Python adds "Did you mean" with a like name of the package
            raise error
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f"{package}.{homes[name]}"), name)

    return load, lambda: sorted(homes)


def _is_import() -> bool:
    """Whether ``from package import name`` asks for a name, not an attribute.

    The import system asks by `hasattr`, which swallows an `AttributeError` with its message.
    """
    asking = sys._getframe(2)
    callers = [asking, asking.f_back]  # a package may wrap its `__getattr__`
    return any(frame and frame.f_code.co_name == "_handle_fromlist" for frame in callers)
