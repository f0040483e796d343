"""Feedback: controllers that sample and hold, and what friction makes of them."""

from stickslip.lazy import attach

HOMES = {
    "ClosedLoop": "feedback_loop",
    "Controller": "feedback_loop",
    "Dynamics": "equations_of_motion",
    "FrictionCompensation": "controllers",
    "LimitCycle": "feedback_loop",
    "PID": "controllers",
    "PartialLinearisation": "controllers",
    "closed_loop": "feedback_loop",
    "compensation": "controllers",
    "dynamics_at": "equations_of_motion",
    "limit_cycle": "feedback_loop",
}

INSIDE = {
    "DynamicsOfContacts": "equations_of_motion",
    "place_of": "equations_of_motion",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES, inside=INSIDE)
