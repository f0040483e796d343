"""The judge: which friction law, and what friction is whichever law holds."""

from stickslip.lazy import attach

HOMES = {
    "BandVerdict": "verdict",
    "Interval": "judge",
    "JointVerdict": "joints",
    "LawCandidate": "verdict",
    "LawFit": "verdict",
    "PredictionBand": "ensemble",
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

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES, inside=INSIDE)
