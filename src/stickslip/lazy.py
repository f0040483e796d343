"""Public names of a package that are loaded when they are first asked for."""

import importlib
import itertools
import re
import sys
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from types import MappingProxyType


class Door:
    """The names of a package that loads them lazily, as its `__init__.pyi` says.

    Type checkers and editors read the same file, so that there is one table of them. A class that
    is declared there has the module that it is imported from under its name with an underscore.
    """

    def __init__(self, package: str) -> None:
        path = Path(str(sys.modules[package].__file__)).with_name("__init__.pyi")
        names, _, public = path.read_text(encoding="utf-8").partition("\n__all__ = [")
        declared = {*re.findall(r"^class (\w+)\(", names, re.M)}
        imported = re.findall(r"^from (\S+) import (\w+) as (\w+)$", names, re.M)
        self.namespaces = [name for module, name, _ in imported if module == package]
        """Public modules, which are attributes without an import of their own."""
        self.homes = {
            name: module
            for module, name, alias in imported
            if module != package and (alias == name or name in declared)
        }
        """The module that defines each name."""
        self.public: list[str] = re.findall(r'"(\w+)"', public)
        """The names that users import, namespaces included; other subpackages use the rest."""


def attach(
    package: str, registered: Mapping[str, str] = MappingProxyType({})
) -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a package that loads names lazily.

    The names are those of its stub, and `registered` ones, by the modules below the package.

    Examples
    --------
    >>> load, names, public = attach("stickslip")
    >>> names()[:3]
    ['Ambrosio', 'ArctanCoulomb', 'Axis']
    >>> load("Coulomb").name
    'coulomb'
    """
    door = Door(package)
    homes = {**door.homes, **{name: f"{package}.{home}" for name, home in registered.items()}}
    public = sorted({*door.public, *registered})

    def load(name: str) -> object:
        if name in door.namespaces:
            return importlib.import_module(f"{package}.{name}")
        if name not in homes:
            there = _elsewhere(package, name, door.namespaces)
            raise AttributeError(
                f"module {package!r} has no attribute {name!r}{there}",
                name=name,
                obj=sys.modules[package],
            )
        return getattr(importlib.import_module(homes[name]), name)

    return load, lambda: sorted({*public, *door.namespaces}), public


def _elsewhere(package: str, name: str, namespaces: Collection[str]) -> str:
    """Return which public module has a name that the package has not, to end a message.

    The modules are read and not imported: the import system asks here for every module of the
    package that is imported by name, and swallows the error.
    """
    root = Path(str(sys.modules[package].__file__)).parent
    if name.startswith("_") or (root / name).exists() or (root / f"{name}.py").exists():
        return ""
    for namespace in namespaces:
        doors = ((root / namespace).glob(door) for door in ("__init__.py*", "*/__init__.py*"))
        for file in (*itertools.chain.from_iterable(doors), root / f"{namespace}.py"):
            names = (
                file.read_text(encoding="utf-8").partition("__all__ = [")[2]
                if file.exists()
                else ""
            )
            if f'"{name}"' in names.partition("]")[0]:
                place = file.parent if file.stem == "__init__" else file.with_suffix("")
                return f"; it is {'.'.join((package, *place.relative_to(root).parts, name))}"
    return ""
