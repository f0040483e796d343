"""Drives: forces, torques and motions as functions of time."""

from stickslip.lazy import attach

HOMES = {
    "Drive": "base",
    "HalfSine": "elementary",
    "Piece": "base",
    "PiecewiseAffine": "elementary",
    "PiecewiseLinear": "elementary",
    "Profile": "motion_profiles",
    "Pulse": "elementary",
    "Ramp": "elementary",
    "Rotation": "motion_profiles",
    "Sampled": "elementary",
    "SampledSwing": "motion_profiles",
    "SevenStep": "motion_profiles",
    "Sine": "elementary",
    "SineSwing": "motion_profiles",
    "SplineSwing": "motion_profiles",
    "Square": "elementary",
    "Sum": "base",
    "ThreePhase": "motion_profiles",
    "TimedThreePhase": "motion_profiles",
}

INSIDE = {
    "BEGINNING": "base",
    "DRIVES": "registry",
    "PROFILES": "registry",
    "Straight": "base",
    "parts_of": "base",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES, inside=INSIDE)
