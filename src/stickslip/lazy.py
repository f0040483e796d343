"""Public names of a package that are loaded when they are first asked for."""

import importlib
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
        ``__getattr__``, which raises `RenamedError` for names that were moved and
        `AttributeError` for others that are not listed, and ``__dir__``.

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
            from stickslip.errors import RenamedError  # nothing is loaded with the package

            home = f"{package}.{moved[name]}"
            raise RenamedError(f"{package}.{name} is {home}.{name} now: from {home} import {name}.")
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f"{package}.{homes[name]}"), name)

    return load, lambda: sorted(homes)
