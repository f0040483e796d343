"""Which friction model fits a mechanism, with which parameters and how surely; and its simulation.

Verbs, laws, mechanisms and measurements are importable from here and loaded when first asked for;
the rest from `stickslip.drives`, `.outputs`, `.results`, `.control`, `.sweep` and `.plots`. What
type checkers and editors read is `__init__.pyi`, which `make stubs` writes from the table below.
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
    "check": "experiments",
    "compare_trials": "identification",
    "ensemble": "simulation",
    "export": "exports",
    "fit": "routes",
    "inverse_dynamics": "identification",
    "load_measurement": "experiments",
    "load_rig": "experiments",
    "optimise_profile": "optimisation",
    "plan": "selection",
    "sample_posterior": "identification",
    "select": "routes",
    "simulate": "simulation",
    "write_report": "routes",
}

MOVED = {
    "BoundedMechanism": "mechanisms",
    "BristleLaw": "friction",
    "Certificate": "results",
    "Checks": "results",
    "ClosedLoop": "control",
    "Contact": "mechanisms",
    "DirectionalLaw": "friction",
    "Ensemble": "results",
    "Estimate": "results",
    "Event": "results",
    "EventCount": "outputs",
    "EventTimes": "outputs",
    "FeatureFit": "results",
    "FeatureVerdict": "results",
    "Final": "outputs",
    "Finding": "results",
    "Fit": "results",
    "Guide": "mechanisms",
    "LAWS": "friction",
    "LimitCycle": "control",
    "Limits": "optimisation",
    "MECHANISMS": "mechanisms",
    "Max": "outputs",
    "Mean": "outputs",
    "Min": "outputs",
    "Optimum": "results",
    "PID": "control",
    "PRINTED_FORMS": "friction",
    "PartialLinearisation": "control",
    "PiecewiseLinear": "drives",
    "Plan": "results",
    "Prescribed": "mechanisms",
    "Profile": "drives",
    "Published": "experiments",
    "Pulse": "drives",
    "Ramp": "drives",
    "RecordFit": "results",
    "RecordVerdict": "results",
    "Sampled": "drives",
    "Samples": "outputs",
    "Sensitivity": "results",
    "SetValuedLaw": "friction",
    "SevenStep": "drives",
    "Sine": "drives",
    "SineSwing": "drives",
    "SplineSwing": "drives",
    "Square": "drives",
    "Status": "results",
    "Stop": "mechanisms",
    "Sum": "drives",
    "ThreePhase": "drives",
    "Torque": "mechanisms",
    "Trajectory": "results",
    "TravelFit": "results",
    "TravelVerdict": "results",
    "TrialComparison": "results",
    "Verdict": "results",
    "average_velocity": "sweep",
    "basins": "sweep",
    "bifurcation": "sweep",
    "closed_loop": "control",
    "compensation": "control",
    "dynamics_at": "control",
    "limit_cycle": "control",
    "rig_schema": "experiments",
}
"""Names that were importable from here, and the namespace where they are now."""

__all__ = sorted([*HOMES, "__version__"])  # noqa: PLE0605  # read off the table above

_load, _ = attach(__name__, HOMES, MOVED)


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version("stickslip")
    return _load(name)


def __dir__() -> list[str]:
    return __all__
