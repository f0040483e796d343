# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.identify.kinds.kind import Column as Column
from stickslip.identify.kinds.kind import Comparison as Comparison
from stickslip.identify.kinds.kind import FitSummary as FitSummary
from stickslip.identify.kinds.kind import Kind as Kind
from stickslip.identify.kinds.kind import Law as Law
from stickslip.identify.kinds.kind import Request as Request
from stickslip.identify.kinds.kind import data_row as data_row
from stickslip.identify.kinds.kind import page_table as page_table
from stickslip.identify.kinds.kind import terminal_table as terminal_table
from stickslip.identify.kinds.plans import Plan as Plan
from stickslip.identify.kinds.plans import UNMEASURED as UNMEASURED
from stickslip.identify.kinds.plans import plan as plan
from stickslip.identify.kinds.plans import plan_of as plan_of
from stickslip.identify.kinds.registry import AnyKind as AnyKind
from stickslip.identify.kinds.registry import as_judged as as_judged
from stickslip.identify.kinds.registry import kind_of as kind_of
from stickslip.identify.kinds.registry import kind_of_route as kind_of_route
from stickslip.identify.kinds.registry import kinds as kinds
from stickslip.identify.kinds.registry import refuse_uninformed as refuse_uninformed
from stickslip.identify.kinds.registry import refuse_unused as refuse_unused
from stickslip.identify.kinds.registry import unused_text as unused_text
from stickslip.identify.kinds.report import DOCUMENT as DOCUMENT
from stickslip.identify.kinds.report import PAGE as PAGE
from stickslip.identify.kinds.report import VERDICT_FILES as VERDICT_FILES
from stickslip.identify.kinds.report import drawn_laws as drawn_laws
from stickslip.identify.kinds.report import verdict_page as verdict_page
from stickslip.identify.kinds.report import write_report as write_report
from stickslip.identify.kinds.report import write_verdict as write_verdict
from stickslip.identify.kinds.simulated import SimulatedCandidate as SimulatedCandidate
from stickslip.identify.kinds.simulated import SimulatedFit as SimulatedFit
from stickslip.identify.kinds.simulated import SimulatedKind as SimulatedKind
from stickslip.identify.kinds.simulated import SimulatedVerdict as SimulatedVerdict
from stickslip.identify.kinds.travels import TravelCandidate as TravelCandidate
from stickslip.identify.kinds.travels import TravelFit as TravelFit
from stickslip.identify.kinds.travels import TravelVerdict as TravelVerdict
from stickslip.identify.kinds.velocity_steps import fit_rate_state as fit_rate_state
from stickslip.identify.kinds.verbs import fit as fit
from stickslip.identify.kinds.verbs import select as select
from stickslip.identify.problems.rate_state_slider import SliderHistory as SliderHistory
from stickslip.identify.problems.rate_state_slider import simulate_velocity_steps as simulate_velocity_steps
from stickslip.identify.problems.slip_features import StickSlipFeatures as StickSlipFeatures
from stickslip.identify.problems.slip_features import features_of as features_of

__all__ = [
    "AnyKind",
    "Column",
    "Comparison",
    "FitSummary",
    "Kind",
    "Law",
    "Plan",
    "Request",
    "SimulatedCandidate",
    "SimulatedFit",
    "SimulatedKind",
    "SimulatedVerdict",
    "SliderHistory",
    "StickSlipFeatures",
    "TravelCandidate",
    "TravelFit",
    "TravelVerdict",
    "data_row",
    "features_of",
    "fit",
    "fit_rate_state",
    "kind_of",
    "kind_of_route",
    "kinds",
    "page_table",
    "plan",
    "refuse_unused",
    "select",
    "simulate_velocity_steps",
    "terminal_table",
    "verdict_page",
    "write_report",
]
