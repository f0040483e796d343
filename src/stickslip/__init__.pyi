# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip import data as data
from stickslip import engine as engine
from stickslip import errors as errors
from stickslip import exports as exports
from stickslip import friction as friction
from stickslip import identify as identify
from stickslip import maths as maths
from stickslip import mechanisms as mechanisms
from stickslip import paper as paper
from stickslip import quantities as quantities
from stickslip import show as show
from stickslip import study as study
from stickslip.data import Measurement as Measurement
from stickslip.data import Rig as Rig
from stickslip.data import check as check
from stickslip.data import load_measurement as load_measurement
from stickslip.data import load_rig as load_rig
from stickslip.engine.simulation import ensemble as ensemble
from stickslip.engine.simulation import simulate as simulate
from stickslip.engine.solver import EventDriven as EventDriven
from stickslip.engine.solver import FixedStep as FixedStep
from stickslip.exports import export as export
from stickslip.friction import Ambrosio as Ambrosio
from stickslip.friction import ArctanCoulomb as ArctanCoulomb
from stickslip.friction import BamM1 as BamM1
from stickslip.friction import BamM2 as BamM2
from stickslip.friction import BamM3 as BamM3
from stickslip.friction import BamM4 as BamM4
from stickslip.friction import BamM5 as BamM5
from stickslip.friction import BamM6 as BamM6
from stickslip.friction import BlimanSorine as BlimanSorine
from stickslip.friction import BoucWen as BoucWen
from stickslip.friction import BrownMcPhee as BrownMcPhee
from stickslip.friction import Cogging as Cogging
from stickslip.friction import Coulomb as Coulomb
from stickslip.friction import CoulombViscous as CoulombViscous
from stickslip.friction import CoulombViscousStatic as CoulombViscousStatic
from stickslip.friction import Dahl as Dahl
from stickslip.friction import DahlStribeck as DahlStribeck
from stickslip.friction import DirectionDependent as DirectionDependent
from stickslip.friction import DirectionalDahl as DirectionalDahl
from stickslip.friction import DirectionalLuGre as DirectionalLuGre
from stickslip.friction import DirectionalStribeck as DirectionalStribeck
from stickslip.friction import ElastoPlastic as ElastoPlastic
from stickslip.friction import FrictionLaw as FrictionLaw
from stickslip.friction import GMS as GMS
from stickslip.friction import HaessigFriedland as HaessigFriedland
from stickslip.friction import HessSoom as HessSoom
from stickslip.friction import JointLoadTemperature as JointLoadTemperature
from stickslip.friction import LuGre as LuGre
from stickslip.friction import LuGreFading as LuGreFading
from stickslip.friction import LuGreGear as LuGreGear
from stickslip.friction import MaxwellSlip as MaxwellSlip
from stickslip.friction import PoppStelter as PoppStelter
from stickslip.friction import PowerViscous as PowerViscous
from stickslip.friction import QuadraticDrag as QuadraticDrag
from stickslip.friction import RootCoulomb as RootCoulomb
from stickslip.friction import SaturatingViscous as SaturatingViscous
from stickslip.friction import Simscape as Simscape
from stickslip.friction import Stribeck as Stribeck
from stickslip.friction import StribeckPower as StribeckPower
from stickslip.friction import TanhCoulomb as TanhCoulomb
from stickslip.friction import TanhStribeck as TanhStribeck
from stickslip.friction import Threlfall as Threlfall
from stickslip.friction import Tustin as Tustin
from stickslip.friction import Viscous as Viscous
from stickslip.friction import WarmViscous as WarmViscous
from stickslip.identify.fits import RecordSettings as RecordSettings
from stickslip.identify.kinds import fit as fit
from stickslip.identify.kinds import plan as plan
from stickslip.identify.kinds import select as select
from stickslip.identify.kinds import write_report as write_report
from stickslip.mechanisms import Axis as Axis
from stickslip.mechanisms import BlockChain as BlockChain
from stickslip.mechanisms import Capsule as Capsule
from stickslip.mechanisms import MatrixMechanism as MatrixMechanism
from stickslip.mechanisms import Mechanism as Mechanism
from stickslip.mechanisms import PIDAxis as PIDAxis
from stickslip.mechanisms import Pendulum as Pendulum
from stickslip.mechanisms import PendulumCart as PendulumCart
from stickslip.mechanisms import Robot as Robot
from stickslip.mechanisms import SerialArm as SerialArm
from stickslip.mechanisms import SpringBlock as SpringBlock
from stickslip.mechanisms import TowedBlock as TowedBlock
from stickslip.mechanisms import TwoFeet as TwoFeet
from stickslip.mechanisms import TwoLinkArm as TwoLinkArm
from stickslip.mechanisms import TwoMassAxis as TwoMassAxis
from stickslip.mechanisms import TwoMassCapsule as TwoMassCapsule
from stickslip.show.plots import animate as animate
from stickslip.study.optimisation import optimise as optimise

__version__: str

__all__ = [
    "Ambrosio",
    "ArctanCoulomb",
    "Axis",
    "BamM1",
    "BamM2",
    "BamM3",
    "BamM4",
    "BamM5",
    "BamM6",
    "BlimanSorine",
    "BlockChain",
    "BoucWen",
    "BrownMcPhee",
    "Capsule",
    "Cogging",
    "Coulomb",
    "CoulombViscous",
    "CoulombViscousStatic",
    "Dahl",
    "DahlStribeck",
    "DirectionDependent",
    "DirectionalDahl",
    "DirectionalLuGre",
    "DirectionalStribeck",
    "ElastoPlastic",
    "EventDriven",
    "FixedStep",
    "FrictionLaw",
    "GMS",
    "HaessigFriedland",
    "HessSoom",
    "JointLoadTemperature",
    "LuGre",
    "LuGreFading",
    "LuGreGear",
    "MatrixMechanism",
    "MaxwellSlip",
    "Measurement",
    "Mechanism",
    "PIDAxis",
    "Pendulum",
    "PendulumCart",
    "PoppStelter",
    "PowerViscous",
    "QuadraticDrag",
    "RecordSettings",
    "Rig",
    "Robot",
    "RootCoulomb",
    "SaturatingViscous",
    "SerialArm",
    "Simscape",
    "SpringBlock",
    "Stribeck",
    "StribeckPower",
    "TanhCoulomb",
    "TanhStribeck",
    "Threlfall",
    "TowedBlock",
    "Tustin",
    "TwoFeet",
    "TwoLinkArm",
    "TwoMassAxis",
    "TwoMassCapsule",
    "Viscous",
    "WarmViscous",
    "__version__",
    "animate",
    "check",
    "ensemble",
    "export",
    "fit",
    "load_measurement",
    "load_rig",
    "optimise",
    "plan",
    "select",
    "simulate",
    "write_report",
]
