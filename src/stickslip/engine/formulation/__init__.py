"""From a law and a mechanism to the text of a self-contained numeric module."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
