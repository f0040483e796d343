"""Feedback: controllers that sample and hold, and what friction makes of them."""

from stickslip.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__)
