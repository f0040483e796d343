"""Friction laws: each one a file, each with its source."""

from stickslip.friction.base import BristleLaw, FrictionLaw, SetValuedLaw, bristles_of
from stickslip.friction.coulomb import Coulomb
from stickslip.friction.coulomb_viscous import CoulombViscous
from stickslip.friction.dahl import Dahl
from stickslip.friction.lugre import LuGre
from stickslip.friction.published import PRINTED_FORMS, PrintedForm
from stickslip.friction.registry import LAWS, law_type, laws
from stickslip.friction.sources import SOURCES
from stickslip.friction.stribeck import Stribeck
from stickslip.friction.viscous import Viscous

__all__ = [
    "LAWS",
    "PRINTED_FORMS",
    "SOURCES",
    "BristleLaw",
    "Coulomb",
    "CoulombViscous",
    "Dahl",
    "FrictionLaw",
    "LuGre",
    "PrintedForm",
    "SetValuedLaw",
    "Stribeck",
    "Viscous",
    "bristles_of",
    "law_type",
    "laws",
]
