"""Exports: a law as a program, a joint, a table or a document, and a rig with its law as an FMU."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
