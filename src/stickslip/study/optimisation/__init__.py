"""Motion profiles: which motion drives a mechanism best within limits."""

from stickslip.lazy import attach

HOMES = {
    "Cycle": "problem",
    "GOALS": "problem",
    "Goal": "problem",
    "KINDS": "parametrisation",
    "Limits": "problem",
    "Margin": "problem",
    "Optimum": "optimise",
    "ParetoFront": "optimise",
    "Scenarios": "problem",
    "ScoredMotion": "problem",
    "guide_of": "problem",
    "measure": "problem",
    "optimise_profile": "optimise",
    "pareto_front": "optimise",
    "units_of_limits": "problem",
}

INSIDE = {
    "COSTS": "optimise",
    "GoalName": "problem",
    "KindName": "parametrisation",
    "load_shares": "problem",
    "slip_of_body": "problem",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES, inside=INSIDE)
