"""Many runs, and laws, mechanisms and measurements put to the test."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
