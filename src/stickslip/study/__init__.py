"""Many runs, and laws, mechanisms and measurements put to the test."""

from stickslip.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__)
