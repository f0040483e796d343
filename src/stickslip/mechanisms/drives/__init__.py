"""Drives: forces, torques and motions as functions of time."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
