"""Suites that mechanisms and laws of other packages can run on themselves."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
