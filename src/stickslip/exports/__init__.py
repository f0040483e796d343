"""Exports: a law as a program, a joint, a table or a document, and a rig with its law as an FMU."""

from stickslip.lazy import attach

HOMES = {
    "Export": "base",
    "TARGETS": "registry",
    "Target": "base",
    "export": "verb",
    "export_fmu": "fmu.export",
}

INSIDE = {
    "identifier": "identifiers",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES | INSIDE)
