"""Contact inputs that a mechanism is told: a temperature, a pressure, what a sensor recorded."""

import dataclasses
import functools
from collections import defaultdict
from collections.abc import Mapping
from typing import Annotated, Any, TypeVar

from stickslip.contact_inputs import CONTACT_INPUTS, checked_inputs
from stickslip.drives import Drive
from stickslip.maths import Scalar
from stickslip.mechanisms.base import ContactInputs, Mechanism

M = TypeVar("M", bound=Mechanism)
PREFIX = "contact_"
"""What fields and drives of given inputs begin with."""


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
    {'gravity': 3.0, 'temperature': 20.0}
    """
    own = told.get(contact, {})
    whole = {name: value for name, value in told.items() if not isinstance(value, Mapping)}
    return {**(own if isinstance(own, Mapping) else {}), **whole}


def given_names(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the names of the contact inputs that a mechanism was given.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> given_names(given_inputs(SpringBlock(mass=1.0), {"temperature": 20.0}))
    ('temperature',)
    """
    return getattr(mechanism, "told_inputs", ())


def given_inputs(mechanism: M, inputs: Mapping[str, Drive | float]) -> M:
    """Return a mechanism that tells its laws more contact inputs.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> warm = given_inputs(SpringBlock(mass=1.0), {"temperature": 35.0})
    >>> type(warm).__name__, warm.contact_temperature
    ('SpringBlock', 35.0)
    """
    if not inputs:
        return mechanism
    before = {name: getattr(mechanism, PREFIX + name) for name in given_names(mechanism)}
    told = {**before, **inputs}
    checked_inputs(told)
    kind = _told(_bare(type(mechanism)), tuple((k, isinstance(x, Drive)) for k, x in told.items()))
    fields = {one.name: getattr(mechanism, one.name) for one in dataclasses.fields(mechanism)}
    found: Any = kind(**{**fields, **{PREFIX + name: one for name, one in told.items()}})
    return found  # type: ignore[no-any-return]


def without_given(mechanism: Mechanism) -> tuple[Mechanism, Mapping[str, Drive | float]]:
    """Return a mechanism as it was before it was given contact inputs, and these by name.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> without_given(given_inputs(SpringBlock(mass=1.0), {"temperature": 35.0}))[1]
    {'temperature': 35.0}
    """
    kind = _bare(type(mechanism))
    own = {one.name: getattr(mechanism, one.name) for one in dataclasses.fields(kind)}
    told = {name: getattr(mechanism, PREFIX + name) for name in given_names(mechanism)}
    return kind(**own), told


def _bare(kind: type[Mechanism]) -> type[Mechanism]:
    """Return the type of a mechanism without given inputs."""
    return getattr(kind, "told_of", kind)


@functools.cache
def _told(kind: type[Mechanism], inputs: tuple[tuple[str, bool], ...]) -> type[Mechanism]:
    """Return the type of a mechanism with contact inputs: numbers, and drives where it says so."""
    names, moving = [name for name, _ in inputs], [name for name, drive in inputs if drive]

    def drives(self: Any) -> Mapping[str, Drive]:
        return {
            **kind.drives(self),
            **{PREFIX + one: getattr(self, PREFIX + one) for one in moving},
        }

    def contact_inputs(
        self: Any,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        own = {
            one: drives[PREFIX + one] if one in moving else getattr(self, PREFIX + one)
            for one in names
        }
        return {**kind.contact_inputs(self, t, q, q_dot, drives), **own}

    def reduce(self: Any) -> tuple[Any, ...]:  # a type that no module has
        return given_inputs, without_given(self)

    space = {
        "drives": drives,
        "contact_inputs": contact_inputs,
        "__reduce__": reduce,
        "told_of": kind,
        "told_inputs": tuple(names),
        "__module__": kind.__module__,
        "__doc__": kind.__doc__,
    }
    fields: list[tuple[str, Any]] = [
        (PREFIX + name, Drive if drive else Annotated[float, CONTACT_INPUTS[name].quantity()])
        for name, drive in inputs
    ]
    made = dataclasses.make_dataclass(
        kind.__name__, fields, bases=(kind,), namespace=space, frozen=True, kw_only=True
    )
    made.__qualname__ = kind.__qualname__
    return made
