"""Start values for a law of which only the type is given."""

from collections.abc import Mapping
from typing import Any

from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import FrictionLaw
from stickslip.quantities import fields_of, vary

__all__ = ["check_known", "starting_law", "with_known"]

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


def check_known(law: FrictionLaw | type[FrictionLaw], known: Mapping[str, float] | None) -> None:
    """Check that values stand beside a type of law, and are of its parameters."""
    if not known:
        return
    if not isinstance(law, type):
        raise InputError(
            f"known is for a type of law, and this is a {type(law).__name__} with all its values:"
            " give the type, or the values with the law."
        )
    fields = fields_of(law)
    for name in known:
        if name not in fields:
            raise UnknownNameError(f"parameter of {law.__name__} in known", name, fields)


def with_known(law: FrictionLaw, known: Mapping[str, float] | None) -> FrictionLaw:
    """Return a law with the values that are known, by name.

    Examples
    --------
    >>> from stickslip import Viscous
    >>> with_known(Viscous(viscous_coefficient=1.0), {"viscous_coefficient": 30.0})
    Viscous(viscous_coefficient=30.0)
    """
    return vary(law, "friction", {f"friction.{name}": v for name, v in (known or {}).items()})
