"""Outputs of ensembles: what is kept of each run, and counts and times of its events."""

from stickslip.lazy import attach

HOMES = {
    "EventCount": "solver",
    "EventTimes": "solver",
    "Final": "solver",
    "Max": "solver",
    "Mean": "solver",
    "Min": "solver",
    "Samples": "solver",
}

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach("stickslip", HOMES)
