"""The source paper, audited: every table and figure again, beside what was printed."""

from stickslip.paper.audit import PaperAudit, TableRow, audit
from stickslip.paper.cart import CartRun, CartStudy, Share, study_cart
from stickslip.paper.excitations import Excitation, excitations
from stickslip.paper.misprints import Consequence, Outcome, consequences
from stickslip.paper.pages import Beside, beside, paper_report
from stickslip.paper.springback import Springback, springbacks
from stickslip.paper.stick_slip import StickSlip, stick_slip
from stickslip.paper.unpublished import Requirement, requirements
from stickslip.paper.values import PaperValues

__all__ = [
    "Beside",
    "CartRun",
    "CartStudy",
    "Consequence",
    "Excitation",
    "Outcome",
    "PaperAudit",
    "PaperValues",
    "Requirement",
    "Share",
    "Springback",
    "StickSlip",
    "TableRow",
    "audit",
    "beside",
    "consequences",
    "excitations",
    "paper_report",
    "requirements",
    "springbacks",
    "stick_slip",
    "study_cart",
]
