"""Exports: a friction law as a program, a joint, a table or a document of something else."""

from stickslip.lazy import attach

HOMES = {
    "Export": "base",
    "TARGETS": "registry",
    "Target": "base",
    "export": "verb",
    "export_fmu": "fmu.export",
}

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES)
