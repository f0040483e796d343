"""Where a mechanism takes the command of a controller."""

import dataclasses
import typing
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from stickslip.drives import Drive, PiecewiseAffine, Profile, Sampled
from stickslip.errors import InputError, UnknownNameError
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Parametrised


class Place(NamedTuple):
    """A field, of a mechanism or of a part of it, that holds a drive."""

    path: tuple[str, ...]
    """Names of fields from the mechanism down, and numbers of parts where there are several."""

    @property
    def name(self) -> str:
        """The path as it is written."""
        return ".".join(self.path)

    def commanded(
        self, mechanism: Mechanism, command: Sampled | PiecewiseAffine
    ) -> tuple[Mechanism, str]:
        """Return a mechanism with a command there, and what it calls that drive.

        A drive that is there already stays, and the command is added to it.
        """
        driven = _put(mechanism, self.path, command)
        held = _got(driven, self.path)
        for name, drive in driven.drives().items():
            if drive is held:
                return driven, name
        raise InputError(
            f"{type(mechanism).__name__}.{self.name} is not a drive that can be commanded:"
            f" drives() must list it (it lists {', '.join(driven.drives()) or 'none'})."
        )


def _got(root: Any, path: tuple[str, ...]) -> Any:
    for name in path:
        root = root[int(name)] if isinstance(root, tuple) else getattr(root, name)
    return root


def _put(root: Any, path: tuple[str, ...], command: Drive) -> Any:
    if not path:
        return command if root is None else root + command
    first, rest = path[0], path[1:]
    new = _put(_got(root, (first,)), rest, command)
    if isinstance(root, tuple):  # one of several parts
        return tuple(new if str(i) == first else part for i, part in enumerate(root))
    return dataclasses.replace(root, **{first: new})


def _places(root: Parametrised, path: tuple[str, ...] = ()) -> Iterator[Place]:
    """Yield the fields that hold a drive, or may."""
    hints = typing.get_type_hints(type(root))
    imposed = root.imposed if isinstance(root, Mechanism) else frozenset[str]()
    for field in dataclasses.fields(root):
        value = getattr(root, field.name)
        here = (*path, field.name)
        if isinstance(value, Profile) or (not path and field.name in imposed):
            continue  # what is imposed leaves nothing to command
        if isinstance(value, Drive) or (
            value is None and Drive in typing.get_args(hints[field.name])
        ):
            yield Place(here)
        elif isinstance(value, Parametrised):
            yield from _places(value, here)
        elif isinstance(value, tuple):
            for i, part in enumerate(value):
                if isinstance(part, Parametrised):
                    yield from _places(part, (*here, str(i)))


def place_of(mechanism: Mechanism, drive: str | None) -> Place:
    """Return the place of a drive by its name, or the only one.

    Examples
    --------
    >>> from stickslip import Axis, PendulumCart
    >>> place_of(Axis(inertia=1.0), None).name
    'drive'
    >>> place_of(PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3), "pendulum").name
    'pendulum.drive'
    """
    known = every_place(mechanism)
    kind = type(mechanism).__name__
    if drive is None:
        if len(known) > 1:
            raise InputError(f"{kind} has several drives: name one, drive={' or '.join(known)}.")
        return next(iter(known.values()))
    if drive in known:
        return known[drive]
    short = drive.removeprefix("mechanism.")
    found = [p for p in known.values() if short in (p.name, p.path[0], p.path[-1])]
    if len(found) != 1:
        raise UnknownNameError("drive", drive, known)
    return found[0]


def places_of(mechanism: Mechanism, drives: str | Sequence[str] | None) -> dict[str, Place]:
    """Return the places of drives by the names that were given; by path where none was.

    Examples
    --------
    >>> from stickslip import TwoLinkArm
    >>> arm = TwoLinkArm(
    ...     upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
    ...     lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03,
    ... )  # fmt: skip
    >>> list(places_of(arm, ("shoulder_drive", "elbow_drive")))
    ['shoulder_drive', 'elbow_drive']
    """
    if drives is None or isinstance(drives, str):
        place = place_of(mechanism, drives)
        return {place.name: place}
    found = {name: place_of(mechanism, name) for name in drives}
    if not found or len(set(found.values())) < len(drives):
        raise InputError(f"drive must name different drives, one or more, got {list(drives)!r}.")
    return found


def every_place(mechanism: Mechanism) -> dict[str, Place]:
    """Return all places at which a mechanism can be commanded, by their paths."""
    known = {place.name: place for place in _places(mechanism)}
    if not known:
        raise InputError(
            f"{type(mechanism).__name__} has no drive that a controller can command: give it a"
            " force or a torque (a prescribed motion cannot be commanded)."
        )
    return known
