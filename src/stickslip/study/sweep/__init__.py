"""Many runs: campaigns, sensitivity indices, mean motion, periodic orbits, basins."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
