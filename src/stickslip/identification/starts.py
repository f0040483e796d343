"""Start values for a law of which only the type is given."""

from typing import Any

from stickslip.friction import FrictionLaw
from stickslip.quantities import fields_of

__all__ = ["starting_law"]

START = {
    "kinetic_coefficient": 0.25,
    "forward_kinetic_coefficient": 0.25,
    "backward_kinetic_coefficient": 0.25,
    "static_coefficient": 0.35,
    "viscous_coefficient": 0.5,
    "stribeck_velocity": 0.05,
    "bristle_stiffness": 1e3,
    "bristle_damping": 10.0,
}
"""Dry metal on metal, per unit load; bristles give way by a quarter of a millimetre."""


def starting_law(law: type[FrictionLaw], load: float = 1.0) -> FrictionLaw:
    """Return a law of that type with ordinary values for each parameter it needs.

    Parameters
    ----------
    law : type
        A friction law.
    load : float
        Normal force [N]; start values that are not per unit load scale with it.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> starting_law(Coulomb)
    Coulomb(kinetic_coefficient=0.25, static_coefficient=None)
    """
    values: dict[str, Any] = {}
    for name in fields_of(law):
        required = law.__dataclass_fields__[name].default
        if name in START and not isinstance(required, (float, int)) and required is not None:
            values[name] = START[name] * (load / 9.81 if name == "viscous_coefficient" else 1.0)
    return law(**values)
