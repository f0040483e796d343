"""Facts of the first contact of a mechanism: what slips there, and what presses at rest."""

from stickslip.mechanisms.base import Mechanism

__all__ = ["slip_names", "static_normal_force"]


def slip_names(mechanism: Mechanism) -> tuple[str, str]:
    """Return the names of the coordinate that slips at the first contact, and of its rate.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> slip_names(Pendulum(mass=1.0, length=0.5))
    ('theta', 'omega')
    """
    slip = mechanism.contacts()[0].slip
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
    (contact,) = mechanism.contacts()
    if contact.normal is None:
        return float(1.0 if contact.load is None else contact.load)
    places = dict.fromkeys((*mechanism.coordinates, contact.normal), 0.0)
    raised = mechanism.potential_energy(0.0, places | {contact.normal: 1.0})
    return float(raised - mechanism.potential_energy(0.0, places))
