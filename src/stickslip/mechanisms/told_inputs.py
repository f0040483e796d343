"""Contact inputs that a mechanism is told: a temperature, a pressure, what a sensor recorded."""

import dataclasses
import functools
from collections import defaultdict
from collections.abc import Mapping
from typing import Any, TypeVar

from stickslip.contact_inputs import checked_inputs
from stickslip.drives import Drive, Sampled
from stickslip.maths import Scalar
from stickslip.mechanisms.base import Mechanism

__all__ = ["given_inputs", "input_names"]

M = TypeVar("M", bound=Mechanism)
PREFIX = "contact_"
"""What fields and drives of given inputs begin with."""


def input_names(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the names of the contact inputs that a mechanism knows.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> input_names(given_inputs(SpringBlock(mass=1.0), {"temperature": 20.0}))[-1:]
    ('temperature',)
    """
    anywhere: Mapping[str, float] = defaultdict(float)
    return tuple(mechanism.contact_inputs(0.0, anywhere, anywhere, anywhere))


def given_inputs(mechanism: M, inputs: Mapping[str, Drive | float]) -> M:
    """Return a mechanism that tells its laws more contact inputs.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    inputs : mapping of str to Drive or float
        By name, a number or a function of time; those that the mechanism was given before are
        replaced.

    Returns
    -------
    Mechanism
        A copy, of a type of its own, with these inputs among its drives.

    Raises
    ------
    UnknownNameError
        If there is no such contact input.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> warm = given_inputs(SpringBlock(mass=1.0), {"temperature": 35.0})
    >>> type(warm).__name__, warm.drives()["contact_temperature"].value(0.0)
    ('SpringBlock', 35.0)
    """
    if not inputs:
        return mechanism
    told = {
        name: one if isinstance(one, Drive) else Sampled(times=(0.0,), values=(float(one),))
        for name, one in inputs.items()
    }
    before = getattr(mechanism, "told_inputs", ())
    names = checked_inputs(dict.fromkeys((*before, *told)))
    kind = _told(_bare(type(mechanism)), names)
    fields = {one.name: getattr(mechanism, one.name) for one in dataclasses.fields(mechanism)}
    found: Any = kind(**{**fields, **{PREFIX + name: one for name, one in told.items()}})
    return found  # type: ignore[no-any-return]


def _bare(kind: type[Mechanism]) -> type[Mechanism]:
    """Return the type of a mechanism without given inputs."""
    return getattr(kind, "told_of", kind)


@functools.cache
def _told(kind: type[Mechanism], names: tuple[str, ...]) -> type[Mechanism]:
    """Return the type of a mechanism with drives that are contact inputs."""

    def drives(self: Any) -> Mapping[str, Drive]:
        own = {PREFIX + name: getattr(self, PREFIX + name) for name in names}
        return {**kind.drives(self), **own}

    def contact_inputs(
        self: Any,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        own = {name: drives[PREFIX + name] for name in names}
        return {**kind.contact_inputs(self, t, q, q_dot, drives), **own}

    def reduce(self: Any) -> tuple[Any, ...]:  # a type that no module has
        bare = {one.name: getattr(self, one.name) for one in dataclasses.fields(kind)}
        return given_inputs, (
            kind(**bare),
            {name: getattr(self, PREFIX + name) for name in names},
        )

    space = {
        "drives": drives,
        "contact_inputs": contact_inputs,
        "__reduce__": reduce,
        "told_of": kind,
        "told_inputs": names,
        "__module__": kind.__module__,
        "__doc__": kind.__doc__,
    }
    fields = [(PREFIX + name, Drive) for name in names]
    made = dataclasses.make_dataclass(
        kind.__name__, fields, bases=(kind,), namespace=space, frozen=True, kw_only=True
    )
    made.__qualname__ = kind.__qualname__
    return made
