"""The source paper, audited: every table and figure again, beside what was printed."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
