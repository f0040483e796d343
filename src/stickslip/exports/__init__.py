"""Exports: a law as a program, a joint, a table or a document, and a rig with its law as an FMU."""

from stickslip.lazy import attach

HOMES = {
    "Applied": "applying.verb",
    "AppliedJoint": "applying.verb",
    "Drake": "twins",
    "Export": "program",
    "JointMotion": "applying.running",
    "JointReplay": "applying.replay",
    "Karnopp": "twins",
    "MuJoCo": "twins",
    "MuJoCoMotor": "twins",
    "PROGRAMS": "twins",
    "Program": "twins",
    "Replayed": "applying.replay",
    "Simscape": "twins",
    "TARGETS": "verb",
    "Target": "program",
    "Twin": "twins",
    "apply": "applying.verb",
    "export": "verb",
    "export_fmu": "fmu.export",
    "twin": "twins",
}

INSIDE = {
    "check_output": "applying.verb",
    "compiler_here": "fmu.export",
    "identifier": "program",
}
"""Names that other subpackages use, and that are not part of the public interface."""

NAMESPACES = ("adapters",)
"""Public modules, which are attributes without an import of their own."""

__all__ = sorted([*HOMES, *NAMESPACES])  # noqa: PLE0605  # read off the tables above

__getattr__, __dir__ = attach(__name__, HOMES, NAMESPACES, inside=INSIDE)
