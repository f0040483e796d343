"""Selection: which law explains a measurement, and what the measurement cannot tell."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
