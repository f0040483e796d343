"""The data catalogue: public friction records, where they come from, and their tidy tables."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
