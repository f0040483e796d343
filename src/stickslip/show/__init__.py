"""What users see: numbers, tables, documents, figures and pages."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
