"""Motion profiles: which motion drives a mechanism best within limits."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
