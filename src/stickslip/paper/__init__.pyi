# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.paper.pages import Beside as Beside
from stickslip.paper.pages import beside as beside
from stickslip.paper.pages import paper_report as paper_report
from stickslip.paper.pages import result_sections as result_sections
from stickslip.paper.paper_audit import PaperAudit as PaperAudit
from stickslip.paper.paper_audit import TableRow as TableRow
from stickslip.paper.paper_audit import TrialTravels as TrialTravels
from stickslip.paper.paper_audit import audit as audit
from stickslip.paper.printed import Consequence as Consequence
from stickslip.paper.printed import Creep as Creep
from stickslip.paper.printed import Outcome as Outcome
from stickslip.paper.printed import Requirement as Requirement
from stickslip.paper.printed import Springback as Springback
from stickslip.paper.printed import consequences as consequences
from stickslip.paper.printed import requirements as requirements
from stickslip.paper.printed import springbacks as springbacks
from stickslip.paper.printed import stribeck_creeps as stribeck_creeps
from stickslip.paper.rigs import CartRun as CartRun
from stickslip.paper.rigs import CartStudy as CartStudy
from stickslip.paper.rigs import Excitation as Excitation
from stickslip.paper.rigs import PaperValues as PaperValues
from stickslip.paper.rigs import RestRule as RestRule
from stickslip.paper.rigs import Share as Share
from stickslip.paper.rigs import StickSlip as StickSlip
from stickslip.paper.rigs import excitations as excitations
from stickslip.paper.rigs import rest_rules as rest_rules
from stickslip.paper.rigs import stick_slip as stick_slip
from stickslip.paper.rigs import study_cart as study_cart

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
    "result_sections",
    "springbacks",
    "stick_slip",
    "stribeck_creeps",
    "study_cart",
]
