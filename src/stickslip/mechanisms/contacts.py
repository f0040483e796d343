"""Facts of the only contact of a mechanism: what slips there, and what presses at rest."""

import math
from collections.abc import Mapping

from stickslip.errors import InputError, UnknownNameError
from stickslip.mechanisms.base import PREFIX, Contact, Mechanism
from stickslip.quantities import vary

MOST = 1000
"""Contacts for which equations are derived: the time grows with their square, to half a minute."""
PRESSING = ("load", "mass", "gravity")
"""Parameters of a mechanism that its load may come from."""


def checked_contacts(mechanism: Mechanism) -> tuple[Contact, ...]:
    """Return the contacts of a mechanism, if they can be simulated at its parameters.

    Examples
    --------
    >>> from stickslip import BlockChain
    >>> len(checked_contacts(BlockChain(blocks=100, mass=1.0, coupling=1.0)))
    100
    """
    owner = type(mechanism).__name__
    try:
        found = mechanism.contacts()
    except ArithmeticError as error:
        raise InputError(
            f"{owner}: the contacts cannot be worked out at these values of its parameters"
            f" ({error}). Change the values, or write slips and loads that are finite there."
        ) from error
    if len(found) > MOST:
        raise InputError(
            f"{owner} has {len(found)} contacts, but no more than {MOST} can be simulated: leave"
            " some out."
        )
    for one in found:
        for name, factor in {} if isinstance(one.slip, str) else one.slip.items():
            if isinstance(factor, int | float) and not math.isfinite(factor):
                raise InputError(
                    f"{owner}: the slip of the contact {one.name!r} has the factor {factor} for"
                    f" {name} at these values of its parameters: it must be finite."
                )
    return found


def only_contact(mechanism: Mechanism) -> Contact:
    """Return the contact of a mechanism that has one."""
    contacts = mechanism.contacts()
    if len(contacts) != 1:
        names = ", ".join(contact.name for contact in contacts)
        raise InputError(
            f"{type(mechanism).__name__} has {len(contacts)} contacts ({names}); this takes a"
            " mechanism with one."
        )
    return contacts[0]


def has_one_slip(mechanism: Mechanism) -> bool:
    """Return whether there is one contact, which slips along a coordinate.

    Examples
    --------
    >>> from stickslip import Pendulum, TwoFeet
    >>> has_one_slip(Pendulum(mass=1.0, length=0.5))
    True
    >>> has_one_slip(TwoFeet(mass=1.0, front=0.1, rear=0.1))
    False
    """
    contacts = mechanism.contacts()
    return len(contacts) == 1 and isinstance(contacts[0].slip, str)


def slips_by_angle(mechanism: Mechanism, contact: Contact | None = None) -> bool:
    """Return whether a contact slips by an angle, or by the sum or difference of angles.

    Examples
    --------
    >>> from stickslip import Axis, Pendulum
    >>> [
    ...     slips_by_angle(one)
    ...     for one in (
    ...         Axis(inertia=1.0),
    ...         Axis(inertia=1.0, rotary=True),
    ...         Pendulum(mass=1.0, length=0.5),
    ...     )
    ... ]
    [False, True, True]
    """
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    return all(
        units.get(q) == "rad" and abs(factor) == 1.0
        for one in (mechanism.contacts() if contact is None else (contact,))
        for q, factor in ({one.slip: 1.0} if isinstance(one.slip, str) else one.slip).items()
    )


def slip_of(mechanism: Mechanism) -> str:
    """Return the coordinate that slips at the only contact.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> slip_of(Pendulum(mass=1.0, length=0.5))
    'theta'
    """
    slip = only_contact(mechanism).slip
    if not isinstance(slip, str):
        raise InputError(
            f"{type(mechanism).__name__} slips along a combination of coordinates"
            f" ({', '.join(slip)}); this takes a mechanism that slips along one."
        )
    return slip


def slipping(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the moving coordinates along which contacts slip, in their order.

    Examples
    --------
    >>> from stickslip import PendulumCart, TwoFeet
    >>> slipping(TwoFeet(mass=1.0, front=0.1, rear=0.1))
    ('x',)
    >>> slipping(PendulumCart(cart_mass=0.5, ball_mass=0.2, length=0.3, pivot_load=1.0))
    ('x', 'theta')
    """
    slips = {name for one in mechanism.contacts() for name in one.slips}
    return tuple(name for name in mechanism.coordinates if name in slips)


def slip_among(mechanism: Mechanism, coordinate: str | None, owner: str) -> tuple[str, str]:
    """Return a coordinate and its rate: as asked, or the only one along which contacts slip.

    Examples
    --------
    >>> from stickslip import BlockChain, Pendulum
    >>> slip_among(Pendulum(mass=1.0, length=0.5), None, "basins")
    ('theta', 'omega')
    >>> slip_among(BlockChain(blocks=3, mass=1.0, coupling=1.0), "x2", "basins")
    ('x2', 'v2')
    """
    if coordinate is None:
        among = slipping(mechanism)
        if len(among) != 1:
            raise InputError(
                f"{owner}: the contacts of {type(mechanism).__name__} slip along several"
                f" coordinates ({', '.join(among)}): name one, such as coordinate={among[0]!r}."
            )
        (coordinate,) = among
    if coordinate not in mechanism.coordinates:
        raise UnknownNameError("coordinate", coordinate, mechanism.coordinates)
    return coordinate, mechanism.rates[mechanism.coordinates.index(coordinate)]


def normal_of(mechanism: Mechanism) -> str | None:
    """Return the held coordinate whose reaction is the normal force of the only contact."""
    normal = only_contact(mechanism).normal
    if normal is not None and not isinstance(normal, str):
        raise InputError(
            f"{type(mechanism).__name__} is carried by several held coordinates"
            f" ({', '.join(normal)}); this takes a mechanism that is carried by one."
        )
    return normal


def slip_names(mechanism: Mechanism) -> tuple[str, str]:
    """Return the names of the coordinate that slips at the only contact, and of its rate.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> slip_names(Pendulum(mass=1.0, length=0.5))
    ('theta', 'omega')
    """
    slip = slip_of(mechanism)
    return slip, mechanism.rates[mechanism.coordinates.index(slip)]


def static_normal_force(mechanism: Mechanism) -> float:
    """Return the normal force at the only contact while nothing moves [N].

    That is the weight, on an incline its part along the normal; or the load of a contact for which
    one is prescribed.

    Examples
    --------
    >>> from stickslip import Axis, Capsule
    >>> round(static_normal_force(Capsule(capsule_mass=0.8, inner_mass=0.2)), 9)
    9.81
    >>> static_normal_force(Axis(inertia=1.0, load=20.0))
    20.0
    """
    contact, normal = only_contact(mechanism), normal_of(mechanism)
    if normal is None:
        return float(1.0 if contact.load is None else contact.load)
    places = dict.fromkeys((*mechanism.coordinates, normal), 0.0)
    raised = mechanism.potential_energy(0.0, places | {normal: 1.0})
    return float(raised - mechanism.potential_energy(0.0, places))


def static_normal_forces(mechanism: Mechanism) -> dict[str, float]:
    """Return the normal force at each contact while nothing moves [N], by the contact's name.

    Examples
    --------
    >>> from stickslip import TwoFeet
    >>> body = TwoFeet(mass=2.0, front=0.3, rear=0.2)
    >>> {name: round(force, 9) for name, force in static_normal_forces(body).items()}
    {'front': 7.848, 'rear': 11.772}
    """
    import numpy as np

    contacts = mechanism.contacts()
    if len(contacts) == 1 and not isinstance(contacts[0].normal, Mapping):
        return {contacts[0].name: static_normal_force(mechanism)}
    found = {one.name: float(1.0 if one.load is None else one.load) for one in contacts}
    carried = [one for one in contacts if one.normal is not None]
    held = list(dict.fromkeys(name for one in carried for name in one.normals))
    if not held:
        return found
    still = dict.fromkeys((*mechanism.coordinates, *held, *mechanism.held()), 0.0)

    def weight(name: str) -> float:  # central, since a tilt raises a body by its square, too
        ends = (mechanism.potential_energy(0.0, still | {name: side}) for side in (1e-3, -1e-3))
        up, down = ends
        return float(up - down) / 2e-3

    rows = [[_factor(one, name) for one in carried] for name in held]
    forces, _, rank, _ = np.linalg.lstsq(
        np.array(rows, dtype=float), np.array([weight(name) for name in held]), rcond=None
    )
    if rank < len(carried):
        names = ", ".join(one.name for one in carried)
        raise InputError(
            f"the weight of {type(mechanism).__name__} does not tell what {names} carry."
        )
    return found | dict(zip((one.name for one in carried), forces.tolist(), strict=True))


def load_stated(mechanism: Mechanism | None, overrides: Mapping[str, float]) -> float | None:
    """Return the load that a mechanism states [N], or None where it has one only by default.

    Examples
    --------
    >>> from stickslip import Axis
    >>> load_stated(Axis(inertia=1.0, load=50.0), {}), load_stated(Axis(inertia=1.0), {})
    (50.0, None)
    """
    if mechanism is None:
        return None
    fields = mechanism.__dataclass_fields__
    pressing = {f"{PREFIX}.{name}" for name in PRESSING if name in fields}
    own = {path: value for path, value in overrides.items() if path in pressing}
    varied = vary(mechanism, PREFIX, own)
    loads = [contact.load for contact in varied.contacts()]
    if len(loads) != 1 or not isinstance(loads[0], int | float) or loads[0] <= 0.0:
        return None
    # A default of 1 N stands for levels that are forces, and is no load that anybody stated.
    usual = "load" in fields and fields["load"].default == loads[0]
    return None if usual and f"{PREFIX}.load" not in own else float(loads[0])


def _factor(contact: Contact, name: str) -> float:
    """Return how a unit of normal force acts on a held coordinate."""
    if isinstance(contact.normal, str) or contact.normal is None:
        return 1.0 if contact.normal == name else 0.0
    return float(contact.normal.get(name, 0.0))
