"""Many runs, and laws, mechanisms and measurements put to the test."""

from stickslip.lazy import attach

HOMES: dict[str, str] = {}

NAMESPACES = ("benchmark", "characterization", "control", "optimisation", "sweep", "testing")
"""Public modules, which are attributes without an import of their own."""

__all__ = sorted([*HOMES, *NAMESPACES])  # noqa: PLE0605  # read off the tables above

__getattr__, __dir__ = attach(__name__, HOMES, NAMESPACES)
