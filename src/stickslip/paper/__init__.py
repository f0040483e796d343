"""The source paper, audited: every table and figure again, beside what was printed."""

from stickslip.paper.audit import PaperAudit, TableRow, TrialTravels, audit
from stickslip.paper.pages import Beside, beside, paper_report
from stickslip.paper.printed import (
    Consequence,
    Creep,
    Outcome,
    Requirement,
    Springback,
    consequences,
    requirements,
    springbacks,
    stribeck_creeps,
)
from stickslip.paper.rigs import (
    CartRun,
    CartStudy,
    Excitation,
    PaperValues,
    RestRule,
    Share,
    StickSlip,
    excitations,
    rest_rules,
    stick_slip,
    study_cart,
)

__all__ = [
    "Beside",
    "CartRun",
    "CartStudy",
    "Consequence",
    "Creep",
    "Excitation",
    "Outcome",
    "PaperAudit",
    "PaperValues",
    "Requirement",
    "RestRule",
    "Share",
    "Springback",
    "StickSlip",
    "TableRow",
    "TrialTravels",
    "audit",
    "beside",
    "consequences",
    "excitations",
    "paper_report",
    "requirements",
    "rest_rules",
    "springbacks",
    "stick_slip",
    "stribeck_creeps",
    "study_cart",
]


def __dir__() -> list[str]:
    return sorted(__all__)
