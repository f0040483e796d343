"""Simulation: equations of a mechanism with laws, solvers, runs and what they give."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
