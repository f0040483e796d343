"""Other libraries of Python: environments of Gymnasium."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
