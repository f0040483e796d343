"""Results: what the verbs return, for annotations and type tests."""

from stickslip.lazy import attach

HOMES = {
    "BandVerdict": "identify",
    "Certificate": "trajectory",
    "Checks": "experiments",
    "Ensemble": "trajectory",
    "Estimate": "identification",
    "Event": "trajectory",
    "FeatureFit": "kinds",
    "FeatureVerdict": "kinds",
    "Finding": "experiments",
    "Fit": "identification",
    "JointVerdict": "identify",
    "Optimum": "optimisation",
    "Plan": "kinds",
    "PredictionBand": "identify",
    "RateStateFit": "kinds",
    "RateStateVerdict": "kinds",
    "RecordFit": "identification",
    "Sensitivity": "solver",
    "Status": "trajectory",
    "Trajectory": "trajectory",
    "TravelFit": "kinds",
    "TravelVerdict": "kinds",
    "TrialComparison": "identification",
    "Verdict": "selection",
}

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach("stickslip", HOMES)
