"""Write the `__init__.pyi` of packages whose names are loaded lazily: python tools/stubs.py.

Type checkers and editors do not run `__getattr__`. They read these stubs, which name the same
modules as the table HOMES that the packages load from.
"""

import importlib
from collections import defaultdict
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent / "src"
PACKAGES = (
    "stickslip",
    "stickslip.adapters",
    "stickslip.control",
    "stickslip.drives",
    "stickslip.experiments",
    "stickslip.exports",
    "stickslip.friction",
    "stickslip.identification",
    "stickslip.mechanisms",
    "stickslip.optimisation",
    "stickslip.outputs",
    "stickslip.plots",
    "stickslip.report",
    "stickslip.results",
    "stickslip.routes",
    "stickslip.selection",
    "stickslip.solver",
)
EXTRA = {
    "stickslip": {"__version__": "str", "MOVED": "dict[str, str]"},
    "stickslip.friction": {"LAW_MODULES": "dict[str, str]"},
    "stickslip.mechanisms": {"MECHANISM_MODULES": "dict[str, str]"},
}
"""Further names, which no module defines, with their types."""


def folder(package: str) -> Path:
    """Return the folder of a package."""
    return SOURCE.joinpath(*package.split("."))


def homes(package: str) -> dict[str, str]:
    """Return the module that defines each public name."""
    module = importlib.import_module(package)
    return {**module.HOMES, **getattr(module, "INSIDE", {})}


def root(package: str) -> str:
    """Return the package below which the table names modules: its own, or the whole."""
    text = (folder(package) / "__init__.py").read_text(encoding="utf-8")
    return package if "attach(__name__" in text else "stickslip"


def stub(package: str) -> str:
    """Return the text of the `__init__.pyi` of a package."""
    modules = defaultdict(list)
    for name, module in homes(package).items():
        modules[f"{root(package)}.{module}"].append(name)
    extra = EXTRA.get(package, {})
    lines = [
        "# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.",
    ]
    lines += [
        f"from {module} import {name} as {name}"
        for module in sorted(modules)
        for name in sorted(modules[module])
    ]
    lines += ["", *(f"{name}: {kind}\n" for name, kind in extra.items())]
    names = importlib.import_module(package).__all__
    lines += ["__all__ = [", *(f'    "{name}",' for name in names), "]", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    for package in PACKAGES:
        (folder(package) / "__init__.pyi").write_text(stub(package), encoding="utf-8")
