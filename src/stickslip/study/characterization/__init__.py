"""Characteristics of friction laws: what experiments on the contact would record."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
