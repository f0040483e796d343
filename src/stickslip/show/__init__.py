"""What users see: numbers, tables, documents, figures and pages."""

from stickslip.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__)
