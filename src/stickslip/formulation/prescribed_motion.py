"""Coordinates that do not move freely: those that drives guide, and those held at 0."""

from collections.abc import Mapping, Sequence

import symengine as se

from stickslip.errors import InputError
from stickslip.mechanisms import Guide, Mechanism, normal_of, stops_of

TAKEN = ("t", "friction", "normal_force", "mode")
"""Columns that every run has."""
RESERVED = ("lift-off", "painleve")
"""Limits that the solver knows itself."""


def held_of(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the coordinates held at 0, the contact's normal one first."""
    normal = normal_of(mechanism)
    held = (*(() if normal is None else (normal,)), *mechanism.held())
    for name in held:
        if name in mechanism.coordinates or held.count(name) > 1:
            raise InputError(
                f"{type(mechanism).__name__} holds {name!r} at 0, but that coordinate moves or is"
                " already held: give held coordinates names of their own."
            )
    return held


def guides_of(
    mechanism: Mechanism, slips: Sequence[str], drives: Mapping[str, se.Symbol]
) -> dict[int, se.Expr]:
    """Return the accelerations of guided coordinates by index."""
    found = {}
    for name, guide in mechanism.guided().items():
        wrong = _fault(mechanism, slips, name, guide, list(drives))
        if wrong:
            raise InputError(f"{type(mechanism).__name__}: {wrong}")
        found[mechanism.coordinates.index(name)] = drives[guide.drive]
    return found


def _fault(
    mechanism: Mechanism, slips: Sequence[str], name: str, guide: object, drives: Sequence[str]
) -> str:
    """Return why a coordinate cannot be guided so, or nothing."""
    if name in slips:
        which = "the" if len(set(slips)) == 1 else "a"
        return f"{name} is {which} slip coordinate, whose motion cannot be prescribed."
    others = [one for one in mechanism.coordinates if one not in slips]
    if name not in others or not isinstance(guide, Guide) or guide.drive not in drives:
        return (
            f"{name!r} is guided by {guide!r}; only {', '.join(others) or 'no coordinate'} can be"
            " guided, by a Guide(...) that names one of the drives"
            f" {', '.join(drives) or '(none)'}."
        )
    if name in {stop.coordinate for stop in stops_of(mechanism)}:
        return (
            f"the motion of {name} is prescribed, so it cannot have hard stops. Leave the stops"
            " out, or drive it by a force."
        )
    if guide.effort in (*mechanism.coordinates, *mechanism.rates, *TAKEN):
        return (
            f"the effort on {name} is named {guide.effort!r}, the name of another column of the"
            " run: give it another name."
        )
    return ""


def own_limits(mechanism: Mechanism, forces: Mapping[str, object]) -> Mapping[str, object]:
    """Return the limits that a mechanism has of its own."""
    owner = type(mechanism).__name__
    try:
        limits = mechanism.limits(forces)
    except KeyError as error:
        raise InputError(
            f"{owner}.limits refers to the force {error.args[0]!r}; the forces are"
            f" {', '.join(forces) or 'none'}."
        ) from None
    for name in RESERVED:
        if name in limits:
            raise InputError(
                f"{owner} has a limit {name!r}, a name reserved for the solver: give it another"
                " name."
            )
    return limits
