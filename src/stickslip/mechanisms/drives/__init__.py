"""Drives: forces, torques and motions as functions of time."""

from stickslip.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__)
