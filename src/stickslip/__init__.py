"""Which friction model fits a mechanism, with which parameters and how surely; and its simulation.

Everything public is importable from here and loaded when first asked for. What type checkers
and editors read is `__init__.pyi`, which `make stubs` writes from the table below.
"""

from stickslip.lazy import attach

HOMES = {
    "Axis": "mechanisms",
    "BoundedMechanism": "mechanisms",
    "BristleLaw": "friction",
    "Capsule": "mechanisms",
    "Certificate": "trajectory",
    "ClosedLoop": "control",
    "Checks": "experiments",
    "Contact": "mechanisms",
    "Coulomb": "friction",
    "CoulombViscous": "friction",
    "CoulombViscousStatic": "friction",
    "Dahl": "friction",
    "DirectionDependent": "friction",
    "DirectionalLaw": "friction",
    "Ensemble": "trajectory",
    "Estimate": "identification",
    "Event": "trajectory",
    "EventCount": "solver",
    "EventDriven": "solver",
    "EventTimes": "solver",
    "FeatureFit": "identification",
    "FeatureVerdict": "selection",
    "Final": "solver",
    "Fit": "identification",
    "Finding": "experiments",
    "FixedStep": "solver",
    "FrictionLaw": "friction",
    "Guide": "mechanisms",
    "LAWS": "friction",
    "Limits": "optimisation",
    "LimitCycle": "control",
    "LuGre": "friction",
    "MECHANISMS": "mechanisms",
    "MatrixMechanism": "mechanisms",
    "Max": "solver",
    "Mean": "solver",
    "Measurement": "experiments",
    "Mechanism": "mechanisms",
    "Min": "solver",
    "Optimum": "optimisation",
    "PID": "control",
    "PRINTED_FORMS": "friction",
    "PartialLinearisation": "control",
    "Pendulum": "mechanisms",
    "PendulumCart": "mechanisms",
    "PiecewiseLinear": "drives",
    "Plan": "selection",
    "PowerViscous": "friction",
    "Prescribed": "mechanisms",
    "Profile": "drives",
    "Published": "experiments",
    "Pulse": "drives",
    "QuadraticDrag": "friction",
    "Ramp": "drives",
    "RecordFit": "identification",
    "RecordSettings": "identification",
    "RecordVerdict": "selection",
    "Rig": "experiments",
    "Sampled": "drives",
    "Samples": "solver",
    "Sensitivity": "solver",
    "SetValuedLaw": "friction",
    "SevenStep": "drives",
    "Sine": "drives",
    "SineSwing": "drives",
    "SplineSwing": "drives",
    "Square": "drives",
    "SpringBlock": "mechanisms",
    "Status": "trajectory",
    "Stop": "mechanisms",
    "StraightPieces": "drives",
    "Stribeck": "friction",
    "Sum": "drives",
    "TravelFit": "identification",
    "TravelVerdict": "selection",
    "TrialComparison": "identification",
    "ThreePhase": "drives",
    "Torque": "mechanisms",
    "TowedBlock": "mechanisms",
    "Trajectory": "trajectory",
    "TwoMassAxis": "mechanisms",
    "Verdict": "selection",
    "Viscous": "friction",
    "animate": "plots",
    "average_velocity": "sweep",
    "basins": "sweep",
    "bifurcation": "sweep",
    "check": "experiments",
    "closed_loop": "control",
    "compare_trials": "identification",
    "compensation": "control",
    "dynamics_at": "control",
    "ensemble": "simulation",
    "fit": "routes",
    "inverse_dynamics": "identification",
    "limit_cycle": "control",
    "load_measurement": "experiments",
    "load_rig": "experiments",
    "optimise_profile": "optimisation",
    "plan": "selection",
    "rig_schema": "experiments",
    "sample_posterior": "identification",
    "select": "routes",
    "simulate": "simulation",
    "write_report": "routes",
}

__all__ = sorted([*HOMES, "__version__"])  # noqa: PLE0605  # read off the table above

_load, _ = attach(__name__, HOMES)


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version("stickslip")
    return _load(name)


def __dir__() -> list[str]:
    return __all__
