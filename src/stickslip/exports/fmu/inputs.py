"""A mechanism of which some drives are inputs."""

import dataclasses
import typing
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple, final

from typing_extensions import override

from stickslip.drives import Drive, Piece, Profile, Sampled, Straight
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import Friction, FrictionLaw
from stickslip.mechanisms import Mechanism, given_inputs, given_names, input_names
from stickslip.quantities import Parametrised

TOLD: Final = "contact_"
"""What drives that are contact inputs begin with."""


@final
@dataclass(frozen=True, kw_only=True)
class Held(Straight):
    """A drive whose value is told from outside while the run goes on; 0 until then."""

    @override
    def pieces(self, until: float = 0.0) -> tuple[Piece, ...]:
        return ()


class Input(NamedTuple):
    """A drive that is told from outside."""

    drive: str
    """Name under which the mechanism's `drives` list it."""
    start: float
    """Value at time 0 of the drive that was there before, 0 if there was none."""


def told_from_outside(
    mechanism: Mechanism, law: Friction, names: Sequence[str]
) -> tuple[Mechanism, tuple[str, ...]]:
    """Return a mechanism whose contact inputs that are told from outside are drives."""
    found = list(names)
    for name in law.inputs if isinstance(law, FrictionLaw) else ():
        told = name in input_names(mechanism)
        if told and name not in names:
            continue
        if told and name not in given_names(mechanism):
            raise InputError(
                f"the contact input {name!r} follows from the motion and the drives of"
                f" {mechanism.title}: leave it out of inputs."
            )
        before = getattr(mechanism, TOLD + name, 0.0)
        start = before.value(0.0) if isinstance(before, Drive) else float(before)
        mechanism = given_inputs(mechanism, {name: Sampled(times=(0.0,), values=(start,))})
        found = [*(one for one in found if one != name), TOLD + name]
    return mechanism, tuple(found)


def with_inputs(mechanism: Mechanism, names: Sequence[str]) -> tuple[Mechanism, dict[str, Input]]:
    """Return a mechanism whose drives of some names are told from outside."""
    found: dict[str, Input] = {}
    for given in names:
        mechanism, one = _with_input(mechanism, given)
        if given in found or one.drive in (other.drive for other in found.values()):
            raise InputError(f"the input {given!r} is named twice.")
        found[given] = one
    return mechanism, found


def _with_input(mechanism: Mechanism, given: str) -> tuple[Mechanism, Input]:
    """Return a mechanism of which one more drive is told."""
    known = []
    for path, before, held, driven in _places(mechanism):
        names = [name for name, drive in driven.drives().items() if drive is held]
        if names and given in (path, *names):
            start = 0.0 if before is None else float(before.value(0.0))
            return driven, Input(names[0], start)
        known += names
    if given in mechanism.drives():
        raise InputError(
            f"the drive {given!r} of {mechanism.title} is a prescribed motion, which cannot be"
            " held over a step as an input: give the mechanism a force or torque instead."
        )
    raise UnknownNameError("drive", given, known)


def _places(root: Any) -> Iterator[tuple[str, Drive | None, Held, Any]]:
    """Yield the path of each place of a force, the drive there, one that is told, a copy with it.

    Places of prescribed motions are left out: what is held jumps.
    """
    if isinstance(root, tuple):
        for index, item in enumerate(root):
            for path, before, held, copy in _places(item):
                yield f"{index}.{path}", before, held, (*root[:index], copy, *root[index + 1 :])
    if not isinstance(root, Parametrised):
        return
    hints = typing.get_type_hints(type(root))
    for field in dataclasses.fields(root):
        own = getattr(root, field.name)
        is_free = own is None and Drive in typing.get_args(hints[field.name])
        if is_free or (isinstance(own, Drive) and not isinstance(own, Profile)):
            held = Held()
            yield field.name, own, held, dataclasses.replace(root, **{field.name: held})
        elif isinstance(own, Parametrised | tuple):
            for path, before, held, copy in _places(own):
                changed = dataclasses.replace(root, **{field.name: copy})
                yield f"{field.name}.{path}", before, held, changed
