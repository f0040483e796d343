"""The mass of a mechanism as an unknown, with its start value by inverse dynamics."""

from collections.abc import Sequence

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.formatting import quantity
from stickslip.identification.estimation.parameters import FreeParameter
from stickslip.identification.series.inverse_dynamics import (
    check_is_mass,
    inverse_dynamics,
    mass_of,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import full_path, parameters

REVERSED = 0.01
"""Inertial share of a negative mass from which the force acts against the motion."""
WIDE = 30.0
"""How far bounds lie from what regression found."""


def inertia_of(
    mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str]
) -> FreeParameter | None:
    """Return the mass of a mechanism where it is looked for, to start from by robust regression."""
    check_is_mass(unknown)
    names = [name.rpartition(".")[2] for name in unknown]
    if not names:
        return None
    known = {path: quantity for path, quantity, _ in parameters(mechanism, "mechanism")}
    path = full_path(names[0], list(known))
    found = inverse_dynamics(mechanism, measurement, directional=True, robust=True)
    value = found["inertia"]
    if -REVERSED < found.inertial_share <= 0.0:
        value = mass_of(mechanism)  # the motion was slow: it says little of the mass
    if value <= 0.0:
        raise InputError(
            f"inverse dynamics gives {quantity(value, 'kg')} for {path}: check the sign of the"
            " force (gain -1) and that the motion accelerates."
        )
    return FreeParameter(
        path=path,
        quantity=known[path],
        start=value,
        low=value / WIDE,
        high=value * WIDE,
        log=True,
        guessed=True,
    )
