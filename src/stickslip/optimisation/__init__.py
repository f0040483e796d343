"""Motion profiles: which motion drives a mechanism best within limits."""

from stickslip.lazy import attach

HOMES = {
    "Cycle": "cycle_metrics",
    "GOALS": "problem",
    "Goal": "problem",
    "KINDS": "parametrisation",
    "Limits": "problem",
    "Margin": "problem",
    "Optimum": "result",
    "ParetoFront": "pareto",
    "Scenarios": "scenarios",
    "ScoredMotion": "problem",
    "guide_of": "cycle_metrics",
    "measure": "cycle_metrics",
    "optimise_profile": "optimise",
    "pareto_front": "pareto",
    "units_of_limits": "cycle_metrics",
}

INSIDE = {
    "COSTS": "pareto",
    "GoalName": "problem",
    "KindName": "parametrisation",
    "load_shares": "cycle_metrics",
    "slip_of_body": "cycle_metrics",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES, inside=INSIDE)
