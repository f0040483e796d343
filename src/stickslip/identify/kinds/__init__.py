"""Kinds of measurement, each from its fit to its page; and the verbs that take any."""

from stickslip.lazy import attach

HOMES = {
    "AnyKind": "registry",
    "Column": "kind",
    "Comparison": "kind",
    "FeatureCandidate": "features.verdict",
    "FeatureFit": "features.result",
    "FeatureVerdict": "features.verdict",
    "FitSummary": "kind",
    "Kind": "kind",
    "Law": "kind",
    "OtherSpeed": "features.verdict",
    "OtherStep": "velocity_steps.verdict",
    "Plan": "travels.plan.sheet",
    "RateStateCandidate": "velocity_steps.verdict",
    "RateStateFit": "velocity_steps.result",
    "RateStateVerdict": "velocity_steps.verdict",
    "Request": "kind",
    "SliderHistory": "velocity_steps.slider",
    "StickSlipFeatures": "features.features",
    "TravelCandidate": "travels.verdict",
    "TravelFit": "travels.result",
    "TravelVerdict": "travels.verdict",
    "compare_features": "features.fit",
    "data_row": "kind",
    "features_of": "features.features",
    "fit": "verbs",
    "fit_features": "features.fit",
    "fit_rate_state": "velocity_steps.fit",
    "fit_travels": "travels.fit",
    "kind_of": "registry",
    "kind_of_route": "registry",
    "kinds": "registry",
    "page_table": "kind",
    "plan": "travels.plan.planning",
    "refuse_unused": "registry",
    "select": "verbs",
    "select_features": "features.selection",
    "select_rate_state": "velocity_steps.selection",
    "select_travels": "travels.selection",
    "simulate_velocity_steps": "velocity_steps.slider",
    "terminal_table": "kind",
    "verdict_page": "report",
    "write_report": "report",
}

INSIDE = {
    "DOCUMENT": "report",
    "PAGE": "report",
    "TRAVEL_COLUMN": "travels.plan.sheet",
    "VERDICT_FILES": "report",
    "drawn_laws": "report",
    "known_by": "travels.plan.tables",
    "plan_page": "travels.plan.page",
    "refuse_uninformed": "registry",
    "setting_of": "travels.plan.planning",
    "tables_of": "travels.plan.tables",
    "unused_text": "registry",
    "write_verdict": "report",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES, inside=INSIDE)
