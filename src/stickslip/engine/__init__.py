"""Simulation: equations of a mechanism with laws, solvers, runs and what they give."""

from stickslip.lazy import attach

HOMES = {
    "Certificate": "trajectory",
    "Ensemble": "trajectory",
    "Event": "trajectory",
    "EventCount": "solver",
    "EventTimes": "solver",
    "Final": "solver",
    "Max": "solver",
    "Mean": "solver",
    "Min": "solver",
    "Samples": "solver",
    "Sensitivity": "solver",
    "Status": "trajectory",
    "Trajectory": "trajectory",
}

NAMESPACES = ("executors", "formulation", "solver")
"""Public modules, which are attributes without an import of their own."""

__all__ = sorted([*HOMES, *NAMESPACES])  # noqa: PLE0605  # read off the tables above

__getattr__, __dir__ = attach(__name__, HOMES, NAMESPACES)
