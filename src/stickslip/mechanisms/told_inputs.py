"""Contact inputs that a mechanism is told: a temperature, a pressure, what a sensor recorded."""

import dataclasses
import functools
import re
from collections import defaultdict
from collections.abc import Mapping
from typing import Annotated, Any, TypeAlias, TypeVar

from stickslip.contact_inputs import CONTACT_INPUTS, checked_inputs
from stickslip.drives import Drive
from stickslip.errors import InputError, UnknownNameError
from stickslip.maths import Scalar
from stickslip.mechanisms.base import ContactInputs, Mechanism

M = TypeVar("M", bound=Mechanism)
GivenInputs: TypeAlias = Mapping[str, Drive | float | Mapping[str, Drive | float]]
"""Inputs by name, or by contact and name."""


def input_names(mechanism: Mechanism, contact: str = "") -> tuple[str, ...]:
    """Return the names of the inputs of a contact that a mechanism knows.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> input_names(given_inputs(SpringBlock(mass=1.0), {"temperature": 20.0}))[-1:]
    ('temperature',)
    """
    anywhere: Mapping[str, float] = defaultdict(float)
    return tuple(of_contact(mechanism.contact_inputs(0.0, anywhere, anywhere, anywhere), contact))


def of_contact(told: ContactInputs, contact: str) -> dict[str, Scalar]:
    """Return the inputs of one contact, of all that a mechanism tells.

    Examples
    --------
    >>> of_contact({"temperature": 20.0, "elbow": {"gravity": 3.0}}, "elbow")
    {'temperature': 20.0, 'gravity': 3.0}
    """
    own = told.get(contact, {})
    whole = {name: value for name, value in told.items() if not isinstance(value, Mapping)}
    return {**whole, **(own if isinstance(own, Mapping) else {})}


def given_names(mechanism: Mechanism, contact: str = "") -> tuple[str, ...]:
    """Return the names of the inputs of a contact that a mechanism was given.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> given_names(given_inputs(SpringBlock(mass=1.0), {"temperature": 20.0}))
    ('temperature',)
    """
    return tuple(
        dict.fromkeys(name for at, name in told_fields(mechanism).values() if at in ("", contact))
    )


def given_inputs(mechanism: M, inputs: GivenInputs) -> M:
    """Return a mechanism that tells its laws more contact inputs.

    Each is a number in the unit of its kind (a temperature in degC), a text with a unit, or a
    drive: by its name for all contacts, by contact and name for one, which stands before those for
    all.

    Examples
    --------
    >>> from stickslip.mechanisms import DiscBrake, Lining, SpringBlock
    >>> warm = given_inputs(SpringBlock(mass=1.0), {"temperature": 35.0})
    >>> type(warm).__name__, warm.contact_temperature
    ('SpringBlock', 35.0)
    >>> brake = DiscBrake(inertia=0.5, pads=(Lining(radius=0.1, load=10.0),) * 2)
    >>> given_inputs(brake, {"pad-2": {"temperature": 300.0}}).contact_pad_2_temperature
    300.0
    """
    if not inputs:
        return mechanism
    told = {**_flat(without_given(mechanism)[1]), **_flat(inputs)}
    known = [one.name for one in mechanism.contacts()]
    for contact in known:
        if ("", contact) in told:
            raise InputError(
                f"inputs of the contact {contact!r} are given by name, such as"
                f" {{{contact!r}: {{'temperature': 20.0}}}}, got {told['', contact]!r}."
            )
    checked_inputs(name for _, name in told)
    for contact, _ in told:
        if contact and contact not in known:
            raise UnknownNameError(f"contact of {type(mechanism).__name__}", contact, known)
    key = tuple((*at, isinstance(one, Drive)) for at, one in told.items())
    kind = _told(_bare(type(mechanism)), key)
    fields = {one.name: getattr(mechanism, one.name) for one in dataclasses.fields(mechanism)}
    found: Any = kind(**{**fields, **{input_field(*at): one for at, one in told.items()}})
    return found  # type: ignore[no-any-return]


def without_given(mechanism: Mechanism) -> tuple[Mechanism, dict[str, Any]]:
    """Return a mechanism as it was before it was given contact inputs, and these by name.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> without_given(given_inputs(SpringBlock(mass=1.0), {"temperature": 35.0}))[1]
    {'temperature': 35.0}
    """
    kind = _bare(type(mechanism))
    own = {one.name: getattr(mechanism, one.name) for one in dataclasses.fields(kind)}
    told: dict[str, Any] = {}
    for field, (contact, name) in told_fields(mechanism).items():
        part = told.setdefault(contact, {}) if contact else told
        part[name] = getattr(mechanism, field)
    return kind(**own), told


def _flat(inputs: GivenInputs) -> dict[tuple[str, str], Drive | float]:
    """Return inputs by contact and name; the contact is empty where all are told."""
    found: dict[tuple[str, str], Drive | float] = {}
    for key, value in inputs.items():
        if isinstance(value, Mapping):
            found |= {(key, name): one for name, one in value.items()}
        else:
            found["", key] = value
    return found


def told_fields(mechanism: Mechanism) -> Mapping[str, tuple[str, str]]:
    """Return contact and name of each input that a mechanism was given, by its field.

    Drives have the names of their fields; the contact is empty where all are told.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> told_fields(given_inputs(SpringBlock(mass=1.0), {"temperature": 20.0}))
    {'contact_temperature': ('', 'temperature')}
    """
    return {input_field(*at): at for at in getattr(mechanism, "told_inputs", ())}


def input_field(contact: str, name: str) -> str:
    """Return the field, and the drive, of an input that a mechanism is given.

    Examples
    --------
    >>> input_field("pad-2", "temperature")
    'contact_pad_2_temperature'
    """
    return "_".join(("contact", *re.findall(r"\w+", contact), name))


def _bare(kind: type[Mechanism]) -> type[Mechanism]:
    """Return the type of a mechanism without given inputs."""
    return getattr(kind, "told_of", kind)


@functools.cache
def _told(kind: type[Mechanism], inputs: tuple[tuple[str, str, bool], ...]) -> type[Mechanism]:
    """Return the type of a mechanism with contact inputs: numbers, and drives where it says so."""
    moving = {input_field(contact, name) for contact, name, drive in inputs if drive}

    def drives(self: Any) -> Mapping[str, Drive]:
        return {**kind.drives(self), **{field: getattr(self, field) for field in sorted(moving)}}

    def contact_inputs(
        self: Any,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        found: dict[str, Any] = {**kind.contact_inputs(self, t, q, q_dot, drives)}
        for contact, name, _ in inputs:
            field = input_field(contact, name)
            value = drives[field] if field in moving else getattr(self, field)
            if contact:
                found[contact] = {**found.get(contact, {}), name: value}
            else:
                found[name] = value
        return found

    def reduce(self: Any) -> tuple[Any, ...]:  # a type that no module has
        return given_inputs, without_given(self)

    space = {
        "drives": drives,
        "contact_inputs": contact_inputs,
        "__reduce__": reduce,
        "told_of": kind,
        "told_inputs": tuple((contact, name) for contact, name, _ in inputs),
        "__module__": kind.__module__,
        "__doc__": kind.__doc__,
    }
    fields: list[tuple[str, Any]] = [
        (
            input_field(contact, name),
            Drive if drive else Annotated[float, CONTACT_INPUTS[name].quantity()],
        )
        for contact, name, drive in inputs
    ]
    made = dataclasses.make_dataclass(
        kind.__name__, fields, bases=(kind,), namespace=space, frozen=True, kw_only=True
    )
    made.__qualname__ = kind.__qualname__
    return made
