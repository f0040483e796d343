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

__getattr__, __dir__, __all__ = attach(__name__, LAW_MODULES)
