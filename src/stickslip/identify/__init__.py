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
    "INSENSITIVE": "kinds.travels",
    "Propagated": "kinds.travel_doubts",
    "Start": "kinds.travel_starts",
    "THRESHOLDS": "thresholds",
    "TITLES": "laws",
    "TravelJudgement": "kinds.travels",
    "USUAL_LAWS": "kinds.travels",
    "agreeing_scale": "kinds.travel_doubts",
    "band_of": "ensemble",
    "covariance_of": "kinds.travel_doubts",
    "descended": "kinds.travel_descent",
    "doubling_slope": "kinds.travel_starts",
    "draw_band": "figures",
    "force_and_speed": "kinds.travel_starts",
    "joint_sections": "joints",
    "judged_travels": "kinds.travels",
    "nuisances_of": "kinds.travel_starts",
    "opening_section": "page",
    "parameter_sentence": "wording",
    "parameters_section": "page",
    "plausible": "kinds.travel_starts",
    "plot_band": "figures",
    "propagated": "kinds.travel_doubts",
    "remarks_section": "page",
    "room_for": "kinds.travel_starts",
    "select_joints": "joints",
    "select_record": "selection",
    "select_table": "selection",
    "slopes_of": "kinds.travel_descent",
    "spread_out": "kinds.travel_starts",
    "starting_points": "kinds.travel_starts",
    "verdict_sections": "page",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES, inside=INSIDE)
