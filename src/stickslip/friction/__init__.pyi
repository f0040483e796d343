# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.friction.base import BristleLaw as BristleLaw
from stickslip.friction.base import Containment as Containment
from stickslip.friction.base import DirectionalLaw as DirectionalLaw
from stickslip.friction.base import FrictionLaw as FrictionLaw
from stickslip.friction.base import SetValuedLaw as SetValuedLaw
from stickslip.friction.base import bristles_of as bristles_of
from stickslip.friction.base import containment_of as containment_of
from stickslip.friction.base import towards as towards
from stickslip.friction.by_contact import Friction as Friction
from stickslip.friction.by_contact import Laws as Laws
from stickslip.friction.by_contact import assigned as assigned
from stickslip.friction.by_contact import bristle_names as bristle_names
from stickslip.friction.by_contact import given_to as given_to
from stickslip.friction.coulomb import Coulomb as Coulomb
from stickslip.friction.coulomb_viscous import CoulombViscous as CoulombViscous
from stickslip.friction.coulomb_viscous_static import CoulombViscousStatic as CoulombViscousStatic
from stickslip.friction.dahl import Dahl as Dahl
from stickslip.friction.direction_dependent import DirectionDependent as DirectionDependent
from stickslip.friction.lugre import LuGre as LuGre
from stickslip.friction.power_viscous import PowerViscous as PowerViscous
from stickslip.friction.published import PRINTED_EQUATIONS as PRINTED_EQUATIONS
from stickslip.friction.published import PRINTED_FORMS as PRINTED_FORMS
from stickslip.friction.published import PrintedCartDynamics as PrintedCartDynamics
from stickslip.friction.published import PrintedCoulomb as PrintedCoulomb
from stickslip.friction.published import PrintedForm as PrintedForm
from stickslip.friction.published import RightEquation as RightEquation
from stickslip.friction.quadratic_drag import QuadraticDrag as QuadraticDrag
from stickslip.friction.rate_state import Evolution as Evolution
from stickslip.friction.rate_state import RATE_STATE_FORMS as RATE_STATE_FORMS
from stickslip.friction.rate_state import RateState as RateState
from stickslip.friction.rate_state import RateStateForm as RateStateForm
from stickslip.friction.registry import CandidateSpec as CandidateSpec
from stickslip.friction.registry import LAWS as LAWS
from stickslip.friction.registry import contained_laws as contained_laws
from stickslip.friction.registry import law_type as law_type
from stickslip.friction.registry import laws as laws
from stickslip.friction.registry import specification as specification
from stickslip.friction.registry import usual_specifications as usual_specifications
from stickslip.friction.sources import SOURCES as SOURCES
from stickslip.friction.stribeck import Stribeck as Stribeck
from stickslip.friction.viscous import Viscous as Viscous

LAW_MODULES: dict[str, str]

__all__ = [
    "BristleLaw",
    "CandidateSpec",
    "Containment",
    "Coulomb",
    "CoulombViscous",
    "CoulombViscousStatic",
    "Dahl",
    "DirectionDependent",
    "DirectionalLaw",
    "Evolution",
    "Friction",
    "FrictionLaw",
    "LAWS",
    "Laws",
    "LuGre",
    "PRINTED_EQUATIONS",
    "PRINTED_FORMS",
    "PowerViscous",
    "PrintedForm",
    "QuadraticDrag",
    "RATE_STATE_FORMS",
    "RateState",
    "RateStateForm",
    "RightEquation",
    "SOURCES",
    "SetValuedLaw",
    "Stribeck",
    "Viscous",
    "bristles_of",
    "contained_laws",
    "containment_of",
    "law_type",
    "laws",
    "specification",
    "towards",
    "usual_specifications",
]
