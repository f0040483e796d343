# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip import adapters as adapters
from stickslip import catalogue as catalogue
from stickslip import characterization as characterization
from stickslip import control as control
from stickslip import drives as drives
from stickslip import errors as errors
from stickslip import experiments as experiments
from stickslip import exports as exports
from stickslip import friction as friction
from stickslip import identification as identification
from stickslip import maths as maths
from stickslip import mechanisms as mechanisms
from stickslip import optimisation as optimisation
from stickslip import outputs as outputs
from stickslip import paper as paper
from stickslip import plots as plots
from stickslip import quantities as quantities
from stickslip import report as report
from stickslip import results as results
from stickslip import routes as routes
from stickslip import selection as selection
from stickslip import solver as solver
from stickslip import sweep as sweep
from stickslip import testing as testing
from stickslip.characterization import characterize as characterize
from stickslip.experiments import Measurement as Measurement
from stickslip.experiments import Rig as Rig
from stickslip.experiments import check as check
from stickslip.experiments import load_measurement as load_measurement
from stickslip.experiments import load_rig as load_rig
from stickslip.exports import export as export
from stickslip.friction import Coulomb as Coulomb
from stickslip.friction import CoulombViscous as CoulombViscous
from stickslip.friction import CoulombViscousStatic as CoulombViscousStatic
from stickslip.friction import Dahl as Dahl
from stickslip.friction import DirectionDependent as DirectionDependent
from stickslip.friction import FrictionLaw as FrictionLaw
from stickslip.friction import LuGre as LuGre
from stickslip.friction import PowerViscous as PowerViscous
from stickslip.friction import QuadraticDrag as QuadraticDrag
from stickslip.friction import Stribeck as Stribeck
from stickslip.friction import Viscous as Viscous
from stickslip.identification import RecordSettings as RecordSettings
from stickslip.identification import compare_trials as compare_trials
from stickslip.identification import inverse_dynamics as inverse_dynamics
from stickslip.identification import sample_posterior as sample_posterior
from stickslip.mechanisms import Axis as Axis
from stickslip.mechanisms import BlockChain as BlockChain
from stickslip.mechanisms import Capsule as Capsule
from stickslip.mechanisms import ClutchTrain as ClutchTrain
from stickslip.mechanisms import DiscBrake as DiscBrake
from stickslip.mechanisms import MatrixMechanism as MatrixMechanism
from stickslip.mechanisms import Mechanism as Mechanism
from stickslip.mechanisms import Pendulum as Pendulum
from stickslip.mechanisms import PendulumCart as PendulumCart
from stickslip.mechanisms import Robot as Robot
from stickslip.mechanisms import SerialArm as SerialArm
from stickslip.mechanisms import SpringBlock as SpringBlock
from stickslip.mechanisms import TowedBlock as TowedBlock
from stickslip.mechanisms import TwoFeet as TwoFeet
from stickslip.mechanisms import TwoLinkArm as TwoLinkArm
from stickslip.mechanisms import TwoMassAxis as TwoMassAxis
from stickslip.optimisation import optimise_profile as optimise_profile
from stickslip.plots import animate as animate
from stickslip.routes import fit as fit
from stickslip.routes import select as select
from stickslip.routes import write_report as write_report
from stickslip.selection import plan as plan
from stickslip.simulation import ensemble as ensemble
from stickslip.simulation import simulate as simulate
from stickslip.solver import EventDriven as EventDriven
from stickslip.solver import FixedStep as FixedStep

__version__: str

__all__ = [
    "Axis",
    "BlockChain",
    "Capsule",
    "ClutchTrain",
    "Coulomb",
    "CoulombViscous",
    "CoulombViscousStatic",
    "Dahl",
    "DirectionDependent",
    "DiscBrake",
    "EventDriven",
    "FixedStep",
    "FrictionLaw",
    "LuGre",
    "MatrixMechanism",
    "Measurement",
    "Mechanism",
    "Pendulum",
    "PendulumCart",
    "PowerViscous",
    "QuadraticDrag",
    "RecordSettings",
    "Rig",
    "Robot",
    "SerialArm",
    "SpringBlock",
    "Stribeck",
    "TowedBlock",
    "TwoFeet",
    "TwoLinkArm",
    "TwoMassAxis",
    "Viscous",
    "__version__",
    "animate",
    "characterize",
    "check",
    "compare_trials",
    "ensemble",
    "export",
    "fit",
    "inverse_dynamics",
    "load_measurement",
    "load_rig",
    "optimise_profile",
    "plan",
    "sample_posterior",
    "select",
    "simulate",
    "write_report",
]
