"""A mechanism of which some drives are inputs."""

import dataclasses
import typing
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, final

from typing_extensions import override

from stickslip.drives import Drive, Piece, Profile, Sampled, Straight
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import Friction, PrintedForm, assigned, law_of
from stickslip.mechanisms import Mechanism, given_inputs, given_names, input_field, input_names
from stickslip.quantities import Parametrised


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
    mechanism: Mechanism, law: Friction | PrintedForm, names: Sequence[str]
) -> tuple[Mechanism, tuple[str, ...]]:
    """Return a mechanism whose contact inputs that are told from outside are drives."""
    found = list(names)
    for contact, name in _from_outside(mechanism, law, names):
        field = input_field(contact, name)
        before = getattr(mechanism, field, 0.0)
        start = before.value(0.0) if isinstance(before, Drive) else float(before)
        held = {name: Sampled(times=(0.0,), values=(start,))}
        mechanism = given_inputs(mechanism, {contact: held} if contact else held)
        found = [*(one for one in found if one != label_of(contact, name)), field]
    return mechanism, tuple(found)


def label_of(contact: str, name: str) -> str:
    """Return what a contact input is called as a variable."""
    return f"{contact}.{name}" if contact else name


def _from_outside(
    mechanism: Mechanism, law: Friction | PrintedForm, names: Sequence[str]
) -> Iterator[tuple[str, str]]:
    """Yield contact and name of what is asked for, or what laws need and nothing tells."""
    if isinstance(law, PrintedForm) or not isinstance(mechanism, Mechanism):
        return  # refused where it is checked with what it is given for
    contacts = tuple(one.name for one in mechanism.contacts())
    laws = assigned(contacts, law)
    asked: dict[str, list[str]] = {}
    for contact in contacts:
        one = law_of(contact, laws)
        for name in () if one is None else one.inputs:
            asked.setdefault(name, []).append(contact)
    for name, those in asked.items():
        untold = [one for one in those if name not in input_names(mechanism, one)]
        apart = [one for one in those if len(contacts) > 1 and label_of(one, name) in names]
        for contact in (*([""] if untold or name in names else []), *apart):
            if not any(
                name in given_names(mechanism, one) or one in untold
                for one in ([contact] if contact else those)
            ):
                raise InputError(
                    f"the contact input {label_of(contact, name)!r} follows from the motion and the"
                    f" drives of {mechanism.title}: leave it out of inputs."
                )
            yield contact, name


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
