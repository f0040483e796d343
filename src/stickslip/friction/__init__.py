"""Friction laws: each one a file, each with its source."""

from stickslip.friction.base import (
    BristleLaw,
    Containment,
    DirectionalLaw,
    FrictionLaw,
    SetValuedLaw,
    bristles_of,
    containment_of,
    towards,
)
from stickslip.friction.coulomb import Coulomb
from stickslip.friction.coulomb_viscous import CoulombViscous
from stickslip.friction.coulomb_viscous_static import CoulombViscousStatic
from stickslip.friction.dahl import Dahl
from stickslip.friction.direction_dependent import DirectionDependent
from stickslip.friction.lugre import LuGre
from stickslip.friction.power_viscous import PowerViscous
from stickslip.friction.published import (
    PRINTED_EQUATIONS,
    PRINTED_FORMS,
    PrintedForm,
    RightEquation,
)
from stickslip.friction.quadratic_drag import QuadraticDrag
from stickslip.friction.rate_state import RATE_STATE_FORMS, Evolution, RateState, RateStateForm
from stickslip.friction.registry import LAWS, contained_laws, law_type, laws
from stickslip.friction.sources import SOURCES
from stickslip.friction.stribeck import Stribeck
from stickslip.friction.viscous import Viscous

__all__ = [
    "LAWS",
    "PRINTED_EQUATIONS",
    "PRINTED_FORMS",
    "RATE_STATE_FORMS",
    "SOURCES",
    "BristleLaw",
    "Containment",
    "Coulomb",
    "CoulombViscous",
    "CoulombViscousStatic",
    "Dahl",
    "DirectionDependent",
    "DirectionalLaw",
    "Evolution",
    "FrictionLaw",
    "LuGre",
    "PowerViscous",
    "PrintedForm",
    "QuadraticDrag",
    "RateState",
    "RateStateForm",
    "RightEquation",
    "SetValuedLaw",
    "Stribeck",
    "Viscous",
    "bristles_of",
    "contained_laws",
    "containment_of",
    "law_type",
    "laws",
    "towards",
]
