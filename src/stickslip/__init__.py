"""Which friction model fits a mechanism, with which parameters and how surely; and its simulation.

Functions, laws, mechanisms and measurements are here; the rest is in the room of its subject, such
as `stickslip.mechanisms.drives.Sine`. All are loaded when first asked for. What type checkers and
editors read is `__init__.pyi`, which says where each name is.
"""

from stickslip.lazy import attach

_load, _names, __all__ = attach(__name__)


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version("stickslip")
    return _load(name)


def __dir__() -> list[str]:
    return _names()
