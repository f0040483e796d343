"""Which friction model fits a mechanism, with which parameters and how surely; and its simulation.

Functions, laws, mechanisms and measurements are here; the rest is in the modules of its subject,
such as `stickslip.drives.Sine`. All are loaded when first asked for. What type checkers and editors
read is `__init__.pyi`, which `make stubs` writes from the tables below.
"""

from stickslip.friction import LAW_MODULES
from stickslip.lazy import attach
from stickslip.mechanisms import MECHANISM_MODULES

HOMES = {
    **dict.fromkeys(LAW_MODULES, "friction"),
    **dict.fromkeys(MECHANISM_MODULES, "mechanisms"),
    "EventDriven": "solver",
    "FixedStep": "solver",
    "FrictionLaw": "friction",
    "MatrixMechanism": "mechanisms",
    "Measurement": "experiments",
    "Mechanism": "mechanisms",
    "RecordSettings": "identification",
    "Rig": "experiments",
    "animate": "plots",
    "characterize": "characterization",
    "check": "experiments",
    "compare_trials": "identification",
    "ensemble": "simulation",
    "export": "exports",
    "fit": "kinds",
    "inverse_dynamics": "identification",
    "load_measurement": "experiments",
    "load_rig": "experiments",
    "optimise_profile": "optimisation",
    "plan": "kinds",
    "select": "kinds",
    "simulate": "simulation",
    "write_report": "kinds",
}

NAMESPACES = (
    "adapters",
    "catalogue",
    "characterization",
    "control",
    "drives",
    "errors",
    "experiments",
    "exports",
    "friction",
    "identification",
    "kinds",
    "maths",
    "mechanisms",
    "optimisation",
    "outputs",
    "paper",
    "plots",
    "quantities",
    "report",
    "results",
    "selection",
    "solver",
    "sweep",
    "testing",
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
