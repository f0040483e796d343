"""Friction laws: compositions of parts, each with its source."""

from stickslip.lazy import attach

NAMED = (
    "Coulomb",
    "Viscous",
    "CoulombViscous",
    "CoulombViscousStatic",
    "DirectionDependent",
    "PowerViscous",
    "QuadraticDrag",
    "Stribeck",
    "Dahl",
    "LuGre",
    "Tustin",
    "HessSoom",
    "PoppStelter",
    "StribeckPower",
    "DirectionalStribeck",
    "SaturatingViscous",
    "TanhCoulomb",
    "ArctanCoulomb",
    "RootCoulomb",
    "Ambrosio",
    "Threlfall",
    "TanhStribeck",
    "BrownMcPhee",
    "Simscape",
    "DahlStribeck",
    "DirectionalDahl",
    "LuGreFading",
    "DirectionalLuGre",
    "ElastoPlastic",
    "BoucWen",
    "MaxwellSlip",
    "WarmViscous",
    "JointLoadTemperature",
    "Cogging",
    "BamM1",
    "BamM2",
    "BamM3",
    "BamM4",
    "BamM5",
    "BamM6",
    "LuGreGear",
    "GMS",
    "HaessigFriedland",
    "BlimanSorine",
)
"""Classes of the laws that have an entry in `named`; tools/stubs.py writes this list."""
LAW_MODULES = {
    **dict.fromkeys(NAMED, "registry"),
}
"""The laws of the package in the order of listings, with what their classes are asked of."""

HOMES = {
    **LAW_MODULES,
    "BristleLaw": "base",
    "CandidateSpec": "registry",
    "Containment": "base",
    "Evolution": "rate_state",
    "Friction": "by_contact",
    "FrictionLaw": "base",
    "LAWS": "registry",
    "Laws": "by_contact",
    "PRINTED_EQUATIONS": "published",
    "PRINTED_FORMS": "published",
    "Passivity": "base",
    "PrintedForm": "published",
    "RATE_STATE_FORMS": "rate_state",
    "RateState": "rate_state",
    "RateStateForm": "rate_state",
    "RightEquation": "published",
    "SOURCES": "sources",
    "SetValuedLaw": "base",
    "Typical": "base",
    "bound": "base",
    "contained_laws": "registry",
    "containment_of": "containment",
    "law": "registry",
    "law_type": "registry",
    "laws": "registry",
    "specification": "registry",
    "usual_specifications": "ladder",
}

INSIDE = {
    "PrintedCartDynamics": "published",
    "PrintedCoulomb": "published",
    "PrintedStribeck": "published",
    "Rung": "ladder",
    "anywhere": "base",
    "assigned": "by_contact",
    "bristle_names": "by_contact",
    "force_parameters": "base",
    "given_to": "by_contact",
    "is_bound": "base",
    "is_composition": "registry",
    "listed": "registry",
    "rungs": "ladder",
    "said_of": "classes",
    "simpler_laws": "registry",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES | INSIDE)
