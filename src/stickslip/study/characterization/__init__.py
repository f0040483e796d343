"""Characteristics of friction laws: what experiments on the contact would record."""

from stickslip.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__)
