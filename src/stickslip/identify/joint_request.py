"""What is looked for in records of several joints, and which of their columns may be mistaken."""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, cast

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.friction import CandidateSpec, FrictionLaw, given_to, specification
from stickslip.identify.fits import (
    LAW,
    OFFSET,
    fixed_values,
    law_quantities,
    names_of,
    varied_paths,
)
from stickslip.identify.problems.joint_motions import contacts_along
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, all_paths, vary

JointLaw: TypeAlias = FrictionLaw | type[FrictionLaw] | CandidateSpec | str | None

JOINTS = "joints"
"""The route of records of several joints."""
SIGNALS = {"positions": ("position", "velocity"), "forces": ("force",)}
"""What may be exchanged, and the quantities of a record that it is."""
OTHER_UNITS: Mapping[str, Mapping[str, tuple[str, float]]] = {
    "rad": {"positions": ("degrees", math.pi / 180.0), "forces": ("mN m", 1e-3)},
    "m": {"positions": ("millimetres", 1e-3), "forces": ("mN", 1e-3)},
}
"""Units that columns may be in by mistake, and what they are in SI, by the unit of a joint."""


@dataclass(frozen=True, kw_only=True)
class JointRequest:
    """What is fitted, by contact."""

    mechanism: Mechanism
    """The mechanism with its fixed values."""
    laws: Mapping[str, FrictionLaw | type[FrictionLaw] | None]
    """By contact, in their order."""
    free: Mapping[str, tuple[str, ...]]
    """Parameters of each law that are fitted, called as if there were no other; `LAW` for all."""
    known: Mapping[str, Mapping[str, float]]
    """Values of each law that are held, by name."""
    linear: tuple[str, ...]
    """Paths of the mechanism's parameters that are fitted."""
    zeros: bool
    """Whether positions of each record count from a place that is not known."""
    offsets: Mapping[str, float]
    """Constant forces that are held, by coordinate."""

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        laws: Mapping[str, JointLaw] | type[FrictionLaw] | str,
        vary_: str | Sequence[str] | None,
        fixed: Mapping[str, float] | None,
        measurement: Measurement,
        *,
        zeros: bool,
    ) -> "JointRequest":
        """Resolve names to full paths."""
        contacts = tuple(item.name for item in contacts_along(mechanism).values())
        if isinstance(laws, FrictionLaw):
            raise InputError(
                "a law given alone would be shared by all joints, which fits do not do: give its"
                f" type {type(laws).__name__}, or laws by contact, as"
                f" {{{', '.join(f'{name!r}: ...' for name in contacts)}}}."
            )
        if not isinstance(laws, Mapping):
            laws = dict.fromkeys(contacts, laws)
        usual: dict[str, tuple[str, ...]] = {}
        kinds: dict[str, FrictionLaw | type[FrictionLaw] | None] = {}
        for name, given in given_to(contacts, laws).items():
            law, usual[name] = _law_of(name, given)
            kinds[name] = law
        quantities = {
            path.replace("friction.", f"friction.{name}.", 1): quantity
            for name, law in kinds.items()
            for path, quantity in law_quantities(law).items()
        }
        own = all_paths(mechanism, "mechanism")
        held = [OFFSET + name for name in mechanism.coordinates]
        known: dict[str, Quantity] = {
            **quantities, **own, **dict.fromkeys(held, Quantity("o", "N"))
        }  # fmt: skip
        values = fixed_values(fixed, known, lambda path: path.partition(".")[0])
        names = (LAW,) if vary_ is None else names_of(vary_)
        whole_laws = (LAW, *(f"friction.{name}.*" for name in kinds))
        varied = varied_paths(names, {**quantities, **own}, values, whole_laws)
        linear = tuple(path for path in varied if path in own)
        for record in measurement.records():
            for path in record.overrides:
                if path in linear or path in values:
                    raise InputError(
                        f"trial {record.name or 'without a name'} overrides {path}, which is one"
                        " value for all trials here: leave the override out, or do not name it in"
                        " vary or fixed."
                    )
        held_own = {path: value for path, value in values.items() if path in own}
        free, held_laws = {}, {}
        for name, law in kinds.items():
            prefix = f"friction.{name}."
            mine = {p.removeprefix(prefix): v for p, v in values.items() if p.startswith(prefix)}
            if isinstance(law, FrictionLaw) and mine:
                changes = {f"friction.{field}": value for field, value in mine.items()}
                kinds[name] = vary(law, "friction", changes)
            held_laws[name] = mine
            whole = LAW in varied or f"friction.{name}.*" in varied
            named = [f"friction.{p.removeprefix(prefix)}" for p in varied if p.startswith(prefix)]
            whole |= isinstance(law, type) and not named and not mine  # no values of it were given
            free[name] = (*(usual[name] if whole else ()), *(p for p in named if "*" not in p))
        return cls(
            mechanism=vary(mechanism, "mechanism", held_own) if held_own else mechanism,
            laws=kinds,
            free=free,
            known=held_laws,
            linear=linear,
            zeros=zeros,
            offsets={
                path.removeprefix(OFFSET): values.get(path, 0.0)
                for path in held
                if zeros or path in values  # a zero and a constant force are hardly told apart
            },
        )


def _law_of(
    name: str, given: object
) -> tuple[FrictionLaw | type[FrictionLaw] | None, tuple[str, ...]]:
    """Return a law that was given for a contact, and which of its parameters are fitted."""
    if given is None:
        return None, ()
    if isinstance(given, str | CandidateSpec):
        result = specification(given) if isinstance(given, str) else given
        own = (LAW,) if result.free is None else tuple(f"friction.{item}" for item in result.free)
        return result.law, own
    kind = given if isinstance(given, type) else type(given)
    if not issubclass(kind, FrictionLaw):
        raise InputError(
            f"the law of the contact {name!r} must be a FrictionLaw, its type or its name, got"
            f" {given!r}."
        )
    return cast("FrictionLaw | type[FrictionLaw]", given), (LAW,)


def suspected(measurement: Measurement, mechanism: Mechanism) -> Iterator[tuple[str, Measurement]]:
    """Yield what may be wrong with columns, as a sentence, and the records without it."""
    names, units = mechanism.coordinates, mechanism.units
    for (i, j), what in itertools.product(itertools.combinations(range(len(names)), 2), SIGNALS):
        if units[i] == units[j]:
            yield (
                f"The {what} of {names[i]} and {names[j]} seem to be exchanged: with the one as the"
                " other, {falls}. Check which column is of which joint.",
                _with_exchanged(measurement, names[i], names[j], SIGNALS[what]),
            )
    for name, unit in zip(names, units, strict=True):
        for what, signals in SIGNALS.items():
            yield (
                f"The {what} of {name} seem to have the opposite sign: with the other one,"
                " {falls}. Check the sign of the column.",
                _multiplied(measurement, name, signals, -1.0),
            )
        for what, (scale, factor) in OTHER_UNITS.get(unit, {}).items():
            yield (
                f"The {what} of {name} seem to be in {scale}: as such, {{falls}}. Check the unit of"
                " the column.",
                _multiplied(measurement, name, SIGNALS[what], factor),
            )


def _multiplied(
    measurement: Measurement, name: str, signals: Sequence[str], factor: float
) -> Measurement:
    """Return records in which some signals of a joint are multiplied by a factor."""

    def changed(joints: Mapping[str, Measurement]) -> dict[str, Measurement]:
        own = joints[name]
        known = {s: factor * getattr(own, s) for s in signals if s in own.quantities()}
        offset = {s: factor * size if s in known else size for s, size in own.offset.items()}
        return {name: replace(own, **known, offset=offset)}

    return _with_joints(measurement, changed)


def _with_joints(
    measurement: Measurement,
    changed: Callable[[Mapping[str, Measurement]], Mapping[str, Measurement]],
) -> Measurement:
    """Return records with some of their joints in the place of those they have."""
    records = [
        replace(record, joints={**record.joints, **changed(record.joints)})
        for record in measurement.records()
    ]
    return replace(measurement, trials=tuple(records)) if measurement.trials else records[0]


def _with_exchanged(
    measurement: Measurement, one: str, other: str, names: Sequence[str]
) -> Measurement:
    """Return records in which two joints have each other's signals of some names."""

    def taking(own: Measurement, other: Measurement) -> Measurement:
        signals = {name: getattr(other, name) for name in names}
        kept = {name: size for name, size in own.offset.items() if name not in names}
        moved = {name: size for name, size in other.offset.items() if name in names}
        return replace(own, **signals, offset={**kept, **moved})

    def changed(joints: Mapping[str, Measurement]) -> dict[str, Measurement]:
        first, second = joints[one], joints[other]
        return {one: taking(first, second), other: taking(second, first)}

    return _with_joints(measurement, changed)
