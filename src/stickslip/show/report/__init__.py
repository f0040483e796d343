"""Reports: self-contained HTML pages, and the sections of which they are made."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
