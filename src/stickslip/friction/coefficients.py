"""Parameters that several laws share: symbol, unit, range, where fits look for them, meaning."""

from typing import Annotated

from typing_extensions import Doc

from stickslip.quantities import Quantity

KineticCoefficient = Annotated[
    float,
    Quantity("mu_k", low=0, scale="level", bounds=(0.0, 100.0), start=1.0),
    Doc("Friction force of sliding over the normal force, without what depends on the speed."),
]
StaticCoefficient = Annotated[
    float,
    Quantity(
        "mu_s", low=0, at_least="kinetic_coefficient", scale="level", bounds=(0.0, 10.0), start=1.1
    ),
    Doc("Friction force over the normal force at vanishing speed and, up to it, at rest."),
]
StribeckVelocity = Annotated[
    float,
    Quantity("v_s", "m/s", above=0, scale="speed", bounds=(1e-3, 1.0), start=0.1),
    Doc("Speed at which the static surplus has faded: to 1/e of it where it fades exponentially."),
]
FadingExponent = Annotated[
    float,
    Quantity("n", above=0, structural=True, scale="none", bounds=(0.3, 5.0), start=1.5),
    Doc("Shape of the fading of the static surplus: 1 Tustin, 2 Gaussian."),
]
ViscousCoefficient = Annotated[
    float,
    Quantity("sigma_2", "N s/m", low=0, scale="slope", bounds=(0.0, 100.0), start=1.0),
    Doc("Growth of the friction force with the slip speed."),
]
ViscousExponent = Annotated[
    float,
    Quantity("p", low=0.2, high=1.5, structural=True, scale="none", bounds=(0.2, 1.5), start=0.6),
    Doc("Power of the speed in the viscous part: 1 is linear, below 1 the lubricant thins."),
]
BristleStiffness = Annotated[
    float,
    Quantity("sigma_0", "1/m", above=0, scale="stiffness", bounds=(1e-2, 1e3), start=1.0),
    Doc("Slope of friction against displacement at the start, over the normal force."),
]
BristleDamping = Annotated[
    float,
    Quantity("sigma_1", "s/m", low=0, scale="damping", bounds=(1e-3, 1e3), start=1.0),
    Doc("Damping of the bristles over the normal force."),
]
