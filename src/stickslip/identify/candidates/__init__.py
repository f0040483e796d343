"""Selection: which law explains a measurement, and what the measurement cannot tell."""

from stickslip.lazy import attach

HOMES = {
    "Candidate": "verdict",
    "Criteria": "criteria",
    "FixedStepRow": "fixed_step_comparison",
    "Verdict": "verdict",
    "compare_fixed_steps": "fixed_step_comparison",
    "criteria_of": "criteria",
}

INSIDE = {
    "CrossValidated": "cross_validation",
    "CrossValidatedVerdict": "cross_validation",
    "CrossValidation": "cross_validation",
    "DIGITS": "cross_validation",
    "LEFT_OUT": "candidates",
    "MOST": "verdict",
    "NOT_DISTINGUISHED": "verdict",
    "ONE_LAW": "verdict",
    "UNMEASURED": "verdict",
    "Watch": "candidates",
    "Wording": "verdict",
    "as_good": "choice",
    "check_any": "candidates",
    "check_apart": "candidates",
    "choose": "choice",
    "corrections": "verdict",
    "effective_aic": "choice",
    "errs_more": "choice",
    "fitted_side_by_side": "candidates",
    "friction_of": "verdict",
    "held_out": "cross_validation",
    "held_out_text": "verdict",
    "in_sentence": "verdict",
    "largest_step": "fixed_step_comparison",
    "limits_of": "criteria",
    "longer": "verdict",
    "not_distinguished": "verdict",
    "on_second_record": "verdict",
    "outcome_beside": "choice",
    "plain": "verdict",
    "score_scale": "verdict",
    "score_text": "verdict",
    "specifications": "candidates",
    "to_predict": "verdict",
    "watched": "candidates",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES, inside=INSIDE)
