"""Reports: self-contained HTML pages, and the sections of which they are made."""

from stickslip.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__)
