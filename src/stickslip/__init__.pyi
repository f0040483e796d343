# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
# ruff: noqa: I001, RUF022
from stickslip.control import ClosedLoop as ClosedLoop
from stickslip.control import LimitCycle as LimitCycle
from stickslip.control import PID as PID
from stickslip.control import PartialLinearisation as PartialLinearisation
from stickslip.control import closed_loop as closed_loop
from stickslip.control import compensation as compensation
from stickslip.control import dynamics_at as dynamics_at
from stickslip.control import limit_cycle as limit_cycle
from stickslip.drives import PiecewiseLinear as PiecewiseLinear
from stickslip.drives import Profile as Profile
from stickslip.drives import Pulse as Pulse
from stickslip.drives import Ramp as Ramp
from stickslip.drives import Sampled as Sampled
from stickslip.drives import SevenStep as SevenStep
from stickslip.drives import Sine as Sine
from stickslip.drives import SineSwing as SineSwing
from stickslip.drives import SplineSwing as SplineSwing
from stickslip.drives import Square as Square
from stickslip.drives import StraightPieces as StraightPieces
from stickslip.drives import Sum as Sum
from stickslip.drives import ThreePhase as ThreePhase
from stickslip.experiments import Checks as Checks
from stickslip.experiments import Finding as Finding
from stickslip.experiments import Measurement as Measurement
from stickslip.experiments import Published as Published
from stickslip.experiments import Rig as Rig
from stickslip.experiments import check as check
from stickslip.experiments import load_measurement as load_measurement
from stickslip.experiments import load_rig as load_rig
from stickslip.experiments import rig_schema as rig_schema
from stickslip.friction import BristleLaw as BristleLaw
from stickslip.friction import Coulomb as Coulomb
from stickslip.friction import CoulombViscous as CoulombViscous
from stickslip.friction import CoulombViscousStatic as CoulombViscousStatic
from stickslip.friction import Dahl as Dahl
from stickslip.friction import DirectionDependent as DirectionDependent
from stickslip.friction import DirectionalLaw as DirectionalLaw
from stickslip.friction import FrictionLaw as FrictionLaw
from stickslip.friction import LAWS as LAWS
from stickslip.friction import LuGre as LuGre
from stickslip.friction import PRINTED_FORMS as PRINTED_FORMS
from stickslip.friction import PowerViscous as PowerViscous
from stickslip.friction import QuadraticDrag as QuadraticDrag
from stickslip.friction import SetValuedLaw as SetValuedLaw
from stickslip.friction import Stribeck as Stribeck
from stickslip.friction import Viscous as Viscous
from stickslip.identification import Estimate as Estimate
from stickslip.identification import FeatureFit as FeatureFit
from stickslip.identification import Fit as Fit
from stickslip.identification import RecordFit as RecordFit
from stickslip.identification import RecordSettings as RecordSettings
from stickslip.identification import TravelFit as TravelFit
from stickslip.identification import TrialComparison as TrialComparison
from stickslip.identification import compare_trials as compare_trials
from stickslip.identification import inverse_dynamics as inverse_dynamics
from stickslip.identification import sample_posterior as sample_posterior
from stickslip.mechanisms import Axis as Axis
from stickslip.mechanisms import BoundedMechanism as BoundedMechanism
from stickslip.mechanisms import Capsule as Capsule
from stickslip.mechanisms import Contact as Contact
from stickslip.mechanisms import Guide as Guide
from stickslip.mechanisms import MECHANISMS as MECHANISMS
from stickslip.mechanisms import MatrixMechanism as MatrixMechanism
from stickslip.mechanisms import Mechanism as Mechanism
from stickslip.mechanisms import Pendulum as Pendulum
from stickslip.mechanisms import PendulumCart as PendulumCart
from stickslip.mechanisms import Prescribed as Prescribed
from stickslip.mechanisms import SpringBlock as SpringBlock
from stickslip.mechanisms import Stop as Stop
from stickslip.mechanisms import Torque as Torque
from stickslip.mechanisms import TowedBlock as TowedBlock
from stickslip.mechanisms import TwoMassAxis as TwoMassAxis
from stickslip.optimisation import Limits as Limits
from stickslip.optimisation import Optimum as Optimum
from stickslip.optimisation import optimise_profile as optimise_profile
from stickslip.plots import animate as animate
from stickslip.routes import fit as fit
from stickslip.routes import select as select
from stickslip.routes import write_report as write_report
from stickslip.selection import FeatureVerdict as FeatureVerdict
from stickslip.selection import Plan as Plan
from stickslip.selection import RecordVerdict as RecordVerdict
from stickslip.selection import TravelVerdict as TravelVerdict
from stickslip.selection import Verdict as Verdict
from stickslip.selection import plan as plan
from stickslip.simulation import ensemble as ensemble
from stickslip.simulation import simulate as simulate
from stickslip.solver import EventCount as EventCount
from stickslip.solver import EventDriven as EventDriven
from stickslip.solver import EventTimes as EventTimes
from stickslip.solver import Final as Final
from stickslip.solver import FixedStep as FixedStep
from stickslip.solver import Max as Max
from stickslip.solver import Mean as Mean
from stickslip.solver import Min as Min
from stickslip.solver import Samples as Samples
from stickslip.solver import Sensitivity as Sensitivity
from stickslip.sweep import average_velocity as average_velocity
from stickslip.sweep import basins as basins
from stickslip.sweep import bifurcation as bifurcation
from stickslip.trajectory import Certificate as Certificate
from stickslip.trajectory import Ensemble as Ensemble
from stickslip.trajectory import Event as Event
from stickslip.trajectory import Status as Status
from stickslip.trajectory import Trajectory as Trajectory

__version__: str

__all__ = [
    "Axis",
    "BoundedMechanism",
    "BristleLaw",
    "Capsule",
    "Certificate",
    "Checks",
    "ClosedLoop",
    "Contact",
    "Coulomb",
    "CoulombViscous",
    "CoulombViscousStatic",
    "Dahl",
    "DirectionDependent",
    "DirectionalLaw",
    "Ensemble",
    "Estimate",
    "Event",
    "EventCount",
    "EventDriven",
    "EventTimes",
    "FeatureFit",
    "FeatureVerdict",
    "Final",
    "Finding",
    "Fit",
    "FixedStep",
    "FrictionLaw",
    "Guide",
    "LAWS",
    "LimitCycle",
    "Limits",
    "LuGre",
    "MECHANISMS",
    "MatrixMechanism",
    "Max",
    "Mean",
    "Measurement",
    "Mechanism",
    "Min",
    "Optimum",
    "PID",
    "PRINTED_FORMS",
    "PartialLinearisation",
    "Pendulum",
    "PendulumCart",
    "PiecewiseLinear",
    "Plan",
    "PowerViscous",
    "Prescribed",
    "Profile",
    "Published",
    "Pulse",
    "QuadraticDrag",
    "Ramp",
    "RecordFit",
    "RecordSettings",
    "RecordVerdict",
    "Rig",
    "Sampled",
    "Samples",
    "Sensitivity",
    "SetValuedLaw",
    "SevenStep",
    "Sine",
    "SineSwing",
    "SplineSwing",
    "SpringBlock",
    "Square",
    "Status",
    "Stop",
    "StraightPieces",
    "Stribeck",
    "Sum",
    "ThreePhase",
    "Torque",
    "TowedBlock",
    "Trajectory",
    "TravelFit",
    "TravelVerdict",
    "TrialComparison",
    "TwoMassAxis",
    "Verdict",
    "Viscous",
    "__version__",
    "animate",
    "average_velocity",
    "basins",
    "bifurcation",
    "check",
    "closed_loop",
    "compare_trials",
    "compensation",
    "dynamics_at",
    "ensemble",
    "fit",
    "inverse_dynamics",
    "limit_cycle",
    "load_measurement",
    "load_rig",
    "optimise_profile",
    "plan",
    "rig_schema",
    "sample_posterior",
    "select",
    "simulate",
    "write_report",
]
