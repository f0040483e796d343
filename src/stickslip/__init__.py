"""Which friction model fits a mechanism, with which parameters and how surely; and its simulation.

Functions, laws, mechanisms and measurements are here; the rest is in the room of its subject, such
as `stickslip.mechanisms.drives.Sine`. All are loaded when first asked for. What type checkers and
editors read is `__init__.pyi`, which `make stubs` writes from the tables below.
"""

from stickslip.friction import LAW_MODULES
from stickslip.lazy import attach
from stickslip.mechanisms import MECHANISM_MODULES

HOMES = {
    **dict.fromkeys(LAW_MODULES, "friction"),
    **dict.fromkeys(MECHANISM_MODULES, "mechanisms"),
    "EventDriven": "engine.solver",
    "FixedStep": "engine.solver",
    "FrictionLaw": "friction",
    "MatrixMechanism": "mechanisms",
    "Measurement": "data",
    "Mechanism": "mechanisms",
    "RecordSettings": "identify.fits",
    "Rig": "data",
    "animate": "show.plots",
    "characterize": "study.characterization",
    "check": "data",
    "compare_trials": "identify.fits",
    "ensemble": "engine.simulation",
    "export": "exports",
    "fit": "identify.kinds",
    "inverse_dynamics": "identify.fits",
    "load_measurement": "data",
    "load_rig": "data",
    "optimise_profile": "study.optimisation",
    "plan": "identify.kinds",
    "select": "identify.kinds",
    "simulate": "engine.simulation",
    "write_report": "identify.kinds",
}

NAMESPACES = (
    "data",
    "engine",
    "errors",
    "exports",
    "friction",
    "identify",
    "maths",
    "mechanisms",
    "paper",
    "quantities",
    "show",
    "study",
)
"""Public modules, which are attributes without an import of their own."""

__all__ = sorted([*HOMES, "__version__"])  # noqa: PLE0605  # read off the table above

_load, _names = attach(__name__, HOMES, NAMESPACES)


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version("stickslip")
    return _load(name)


def __dir__() -> list[str]:
    return sorted([*_names(), "__version__"])
