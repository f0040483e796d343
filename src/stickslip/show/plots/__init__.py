"""Figures: the only subpackage that uses matplotlib, loaded when a name is first asked for."""

from stickslip.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__)
