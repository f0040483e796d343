"""Figures: the only subpackage that uses matplotlib, loaded when a name is first asked for."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
