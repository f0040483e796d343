"""Data: rigs, measurements and trials, from files or arrays, and what is wrong with them."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
