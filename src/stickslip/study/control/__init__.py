"""Feedback: controllers that sample and hold, and what friction makes of them."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
