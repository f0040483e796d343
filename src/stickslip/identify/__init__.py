"""The judge: which friction law, and what friction is whichever law holds."""

from stickslip.lazy import attach

HOMES = {
    "BandVerdict": "verdict",
    "Estimate": "fits",
    "FeatureFit": "kinds",
    "FeatureVerdict": "kinds",
    "Fit": "fits",
    "Interval": "judge",
    "JointVerdict": "joints",
    "LawCandidate": "verdict",
    "LawFit": "verdict",
    "Plan": "kinds",
    "PredictionBand": "ensemble",
    "RateStateFit": "kinds",
    "RateStateVerdict": "kinds",
    "RecordFit": "fits",
    "TravelFit": "kinds",
    "TravelVerdict": "kinds",
    "TrialComparison": "fits",
    "Verdict": "candidates",
}

INSIDE = {
    "BandDrawing": "figures",
    "CurvePoint": "laws",
    "INSENSITIVE": "problems.travels",
    "MeasuredCurve": "laws",
    "THRESHOLDS": "thresholds",
    "TITLES": "laws",
    "TravelJudgement": "problems.travels",
    "USUAL_LAWS": "problems.travels",
    "band_of": "ensemble",
    "draw_band": "figures",
    "fitted_travels": "problems.travels",
    "importance": "verdict",
    "joint_sections": "joints",
    "judged_travels": "problems.travels",
    "knob_of": "problems.travels",
    "opening_section": "page",
    "parameter_sentence": "wording",
    "parameters_section": "page",
    "plot_band": "figures",
    "propagated": "problems.travels",
    "remarks_section": "page",
    "select_joints": "joints",
    "select_record": "selection",
    "select_table": "selection",
    "verdict_sections": "page",
}
"""Names that other subpackages use, and that are not part of the public interface."""

NAMESPACES = ("candidates", "fits", "kinds")
"""Public modules, which are attributes without an import of their own."""

__all__ = sorted([*HOMES, *NAMESPACES])  # noqa: PLE0605  # read off the tables above

__getattr__, __dir__ = attach(__name__, HOMES, NAMESPACES, inside=INSIDE)
