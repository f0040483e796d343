"""Solvers: the event-driven one, and the fixed step of a block diagram."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
