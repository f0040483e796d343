"""Parameters that several laws share: symbol, unit, allowed range, and where fits look for them."""

from typing import Annotated

from stickslip.quantities import Quantity

__all__ = [
    "BristleStiffness",
    "FadingExponent",
    "KineticCoefficient",
    "PositiveKineticCoefficient",
    "StaticCoefficient",
    "StribeckVelocity",
    "ViscousCoefficient",
    "ViscousExponent",
]

KineticCoefficient = Annotated[
    float, Quantity("mu_k", low=0, scale="level", bounds=(0.0, 100.0), start=1.0)
]
PositiveKineticCoefficient = Annotated[
    float, Quantity("mu_k", above=0, scale="level", bounds=(0.0, 100.0), start=1.0)
]
StaticCoefficient = Annotated[
    float,
    Quantity(
        "mu_s", low=0, at_least="kinetic_coefficient", scale="level", bounds=(0.0, 10.0), start=1.1
    ),
]
StribeckVelocity = Annotated[
    float, Quantity("v_s", "m/s", above=0, scale="speed", bounds=(1e-3, 1.0), start=0.1)
]
FadingExponent = Annotated[
    float, Quantity("n", above=0, structural=True, scale="none", bounds=(0.3, 5.0), start=1.5)
]
"""Exponent by which a static surplus fades: 1 Tustin, 2 Gaussian."""
ViscousCoefficient = Annotated[
    float, Quantity("sigma_2", "N s/m", low=0, scale="slope", bounds=(0.0, 100.0), start=1.0)
]
ViscousExponent = Annotated[
    float,
    Quantity("p", low=0.2, high=1.5, structural=True, scale="none", bounds=(0.2, 1.5), start=0.6),
]
BristleStiffness = Annotated[
    float, Quantity("sigma_0", "1/m", above=0, scale="stiffness", bounds=(1e-2, 1e3), start=1.0)
]
