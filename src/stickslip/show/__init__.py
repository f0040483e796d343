"""What users see: numbers, tables, documents, figures and pages."""

from stickslip.lazy import attach

HOMES: dict[str, str] = {}

NAMESPACES = ("plots", "report")
"""Public modules, which are attributes without an import of their own."""

__all__ = sorted([*HOMES, *NAMESPACES])  # noqa: PLE0605  # read off the tables above

__getattr__, __dir__ = attach(__name__, HOMES, NAMESPACES)
