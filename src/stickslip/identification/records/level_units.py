"""Levels that are forces: coefficients of a law where no normal force is known."""

from collections.abc import Iterable
from dataclasses import replace

from stickslip.experiments import Measurement, levels_at, tells_load
from stickslip.identification.estimation.parameters import FreeParameter, FreeParameters
from stickslip.mechanisms import Mechanism
from stickslip.quantities import turned


def reads_as_forces(mechanism: Mechanism, measurement: Measurement) -> bool:
    """Whether levels read as forces [N]: the mechanism has no load, and none was measured.

    Examples
    --------
    >>> from stickslip import Axis
    >>> table = Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.6])
    >>> (
    ...     reads_as_forces(Axis(inertia=1.0), table),
    ...     reads_as_forces(Axis(inertia=1.0, load=5.0), table),
    ... )
    (True, False)
    """
    unit_load = levels_at(mechanism) != "per load"
    return unit_load and not tells_load(measurement)


def in_forces(
    free_parameters: FreeParameters, mechanism: Mechanism, measurement: Measurement
) -> FreeParameters:
    """Return the unknowns with the units that their values read in.

    A law's levels are pure numbers, times the normal force. Where that is 1 for want of another,
    the number is the force, and is said in N.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.quantities import Quantity
    >>> path = "friction.kinetic_coefficient"
    >>> level = FreeParameters(
    ...     (FreeParameter(path=path, quantity=Quantity("mu_k", per_load=True), start=2.0),)
    ... )
    >>> table = Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.6])
    >>> in_forces(level, Axis(inertia=1.0), table).items[0].quantity.unit
    'N'
    """
    if not reads_as_forces(mechanism, measurement):
        return free_parameters
    return replace(free_parameters, items=tuple(_in_forces(free_parameters.items)))


def turned_as(measurement: Measurement, free_parameters: FreeParameters) -> FreeParameters:
    """Return the unknowns in the units of what was measured: about an axis, forces are torques.

    Examples
    --------
    >>> from stickslip.quantities import Quantity
    >>> offset = FreeParameters(
    ...     (FreeParameter(path="mechanism.offset", quantity=Quantity("o", "N"), start=0.0),)
    ... )
    >>> swing = Measurement(time=[0.0, 1.0], position=[0.0, 0.1], turning=True)
    >>> turned_as(swing, offset).items[0].quantity.unit
    'N m'
    """
    pairs = [
        (item, turned(item.quantity.unit, measurement.turning)) for item in free_parameters.items
    ]
    items = (replace(item, quantity=replace(item.quantity, unit=unit)) for item, unit in pairs)
    return replace(free_parameters, items=tuple(items))


OFFSET = "measurement.offset.force."
"""Path of the constant force of a joint, before its name."""
JOINTS = "mechanism.joints."
"""Path of the parameters of a joint of a robot, before its number."""


def told(
    free_parameters: FreeParameters, mechanism: Mechanism, measurement: Measurement
) -> FreeParameters:
    """Return the unknowns of a record with the units that their values read in."""
    if measurement.joint_names():
        return by_joint(free_parameters, mechanism)
    return turned_as(measurement, in_forces(free_parameters, mechanism, measurement))


def by_joint(free_parameters: FreeParameters, mechanism: Mechanism) -> FreeParameters:
    """Return the unknowns of several joints with the units that their values read in.

    Where the load of a contact is 1, levels are forces, or torques of a joint that turns.
    """
    turns = dict(zip(mechanism.coordinates, (u == "rad" for u in mechanism.units), strict=True))
    contacts = {one.name or one.slips[0]: one for one in mechanism.contacts()}
    items = []
    for item in free_parameters.items:
        quantity, turning = item.quantity, False
        if item.path.startswith("friction."):
            contact = contacts[item.path.split(".")[1]]
            turning = turns[contact.slips[0]]
            if contact.load == 1.0:
                quantity = replace(quantity, unit=quantity.force_unit)
        elif item.path.startswith(OFFSET):
            turning = turns[item.path.removeprefix(OFFSET)]
        elif item.path.startswith(JOINTS) and quantity.or_unit:
            number = int(item.path.removeprefix(JOINTS).partition(".")[0])
            if mechanism.units[number] != "rad":
                quantity = replace(quantity, unit=quantity.or_unit)
        unit = turned(quantity.unit, turning)
        items.append(replace(item, quantity=replace(quantity, unit=unit)))
    return replace(free_parameters, items=tuple(items))


def _in_forces(items: Iterable[FreeParameter]) -> Iterable[FreeParameter]:
    for item in items:
        quantity = item.quantity
        if item.path.startswith("friction."):
            quantity = replace(quantity, unit=quantity.force_unit)
        yield replace(item, quantity=quantity)
