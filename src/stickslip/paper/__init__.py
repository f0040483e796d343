"""The source paper, audited: every table and figure again, beside what was printed."""

from stickslip.paper.audit import PaperAudit, audit
from stickslip.paper.excitations import Excitation, excitations
from stickslip.paper.misprints import Consequence, consequences
from stickslip.paper.unpublished import Requirement, requirements

__all__ = [
    "Consequence",
    "Excitation",
    "PaperAudit",
    "Requirement",
    "audit",
    "consequences",
    "excitations",
    "requirements",
]
