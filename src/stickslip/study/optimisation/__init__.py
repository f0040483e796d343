"""Motion profiles: which motion drives a mechanism best within limits."""

from stickslip.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__)
