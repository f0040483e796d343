"""The source paper, audited: every table and figure again, beside what was printed."""

from stickslip.paper.audit import PaperAudit, TableRow, TrialTravels, audit
from stickslip.paper.cart import CartRun, CartStudy, Share, study_cart
from stickslip.paper.excitations import Excitation, excitations
from stickslip.paper.misprints import Consequence, Outcome, consequences
from stickslip.paper.pages import Beside, beside, paper_report
from stickslip.paper.rest_rules import RestRule, rest_rules
from stickslip.paper.stick_slip import StickSlip, stick_slip
from stickslip.paper.unpublished import (
    Creep,
    Requirement,
    Springback,
    requirements,
    springbacks,
    stribeck_creeps,
)
from stickslip.paper.values import PaperValues

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
