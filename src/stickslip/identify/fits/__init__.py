"""Identification: parameters from measurements, with their doubt."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
