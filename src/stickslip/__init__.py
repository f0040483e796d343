"""Which friction model fits a mechanism, with which parameters and how surely; and its simulation.

Everything public is importable from here and loaded when first asked for.
"""

import importlib
from typing import Any

_HOME = {
    "Axis": "mechanisms",
    "Certificate": "trajectory",
    "Coulomb": "friction",
    "CoulombViscous": "friction",
    "Dahl": "friction",
    "Event": "trajectory",
    "EventDriven": "solver",
    "FixedStep": "solver",
    "LAWS": "friction",
    "LuGre": "friction",
    "PRINTED_FORMS": "friction",
    "PiecewiseLinear": "drives",
    "Pulse": "drives",
    "Ramp": "drives",
    "Sampled": "drives",
    "Sine": "drives",
    "SpringBlock": "mechanisms",
    "Status": "trajectory",
    "Stribeck": "friction",
    "TowedBlock": "mechanisms",
    "Trajectory": "trajectory",
    "Viscous": "friction",
    "simulate": "simulation",
}

__all__ = sorted([*_HOME, "__version__"])  # noqa: PLE0605  # read off the table above


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("stickslip")
    if name not in _HOME:
        raise AttributeError(f"module 'stickslip' has no attribute {name!r}")
    return getattr(importlib.import_module(f"stickslip.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return __all__
