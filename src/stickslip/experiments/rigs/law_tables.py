"""The ``[friction]`` table: shared values, and a table of its own for each law."""

import dataclasses
import functools
import typing
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any, ClassVar, NamedTuple

from pydantic import BeforeValidator, Field, create_model

from stickslip.errors import InputError
from stickslip.experiments.estimates import LOAD
from stickslip.experiments.rigs.rig_models import ITS_TABLE, Number, Table
from stickslip.friction import LAWS, FrictionLaw, force_parameters
from stickslip.quantities import Quantity, fields_of, turned

NONE = "none"
"""What stands in place of a contact's table where nothing rubs."""


class FrictionTable(Table):
    """Values that all laws share, and tables of single laws."""

    of_one: ClassVar[type[Table]] = Table
    """Where contacts have tables of their own, the type of these."""


def python_name(name: str, kind: str = "law") -> str:
    """Return the attribute under which the own table of a law, or of a contact, is kept."""
    return f"{kind}_{name.replace('-', '_')}"


class ContactUnits(NamedTuple):
    """What tells the units of laws at a contact."""

    name: str
    """The name of the contact."""
    turning: bool = False
    """Whether it slips by an angle."""
    in_forces: bool = False
    """Whether the load is 1, so that what is over it reads as a force."""


def _number(
    quantities: Sequence[Quantity], at: ContactUnits, elsewhere: tuple[Quantity, str] | None = None
) -> Any:
    """Return the annotation of a value of laws, which may have its unit at a contact."""
    units = [
        (one, {turned(one.unit, at.turning), turned(one.force_unit, at.turning)})
        if at.in_forces
        else (one, {turned(one.unit, at.turning)})
        for one in quantities
    ]
    others = (
        dataclasses.replace(one, unit=unit)
        for one, found in units
        for unit in sorted(found - {one.unit})
    )
    number = Number(
        quantities[0],
        mark="assumed",
        alternatives=(*quantities[1:], *others),
        measured=True,
        elsewhere=elsewhere,
    )
    return Annotated[Any, number]


def _forces_table(law: type[FrictionLaw]) -> type[Table]:
    fields: dict[str, Any] = {"load": (Annotated[Any, Number(LOAD)], ...)}
    for key, (_, quantity) in force_parameters(law).items():
        fields[key] = (Annotated[Any, Number(quantity, mark="assumed")], None)
    model = create_model(f"{law.__name__}Forces", __base__=Table, **fields)
    model.__doc__ = f"Values of {law.title} as forces, stiffness and damping at a load."
    return model


def _law_table(law: type[FrictionLaw], at: ContactUnits) -> type[Table]:
    fields: dict[str, Any] = {}
    for field in dataclasses.fields(law):
        default = None if field.default is dataclasses.MISSING else field.default
        fields[field.name] = (_hint(law, field.name, at), default)
    if force_parameters(law):
        fields["forces"] = (_forces_table(law) | None, None)
    model = create_model(law.__name__, __base__=Table, **fields)
    model.__doc__ = (vars(law).get("__doc__") or "").strip().partition("\n")[0]
    return model


def _hint(law: type[FrictionLaw], name: str, at: ContactUnits) -> Any:
    quantity = fields_of(law).get(name)
    if quantity is not None:
        found = {field: (key, one) for key, (field, one) in force_parameters(law).items()}
        if name not in found or not quantity.per_load or at.in_forces:
            return _number([quantity], at)
        key, one = found[name]
        where = (
            f"a value in {one.unit} stands as {key} under [{ITS_TABLE}.forces], with the"
            " load at which it was measured"
        )
        return _number([quantity], at, (one, where))
    return typing.get_type_hints(law, include_extras=True)[name]


def _owners(kinds: Iterable[type[FrictionLaw]]) -> dict[str, list[type[FrictionLaw]]]:
    owners: dict[str, list[type[FrictionLaw]]] = {}
    for law in kinds:
        for field in dataclasses.fields(law):
            owners.setdefault(field.name, []).append(law)
    return owners


def _means_one_thing(name: str, owners: list[type[FrictionLaw]]) -> bool:
    """Whether a shared value would mean the same in all laws that have it."""
    units = {fields_of(law)[name].unit if name in fields_of(law) else "" for law in owners}
    defaults = {
        field.default
        for law in owners
        if LAWS.get(law.name) is law
        for field in dataclasses.fields(law)
        if field.name == name and field.default not in (dataclasses.MISSING, None)
    }
    return len(units) == 1 and len(defaults) <= 1


@functools.cache
def friction_table(
    kinds: tuple[type[FrictionLaw], ...], contacts: tuple[ContactUnits, ...] = ()
) -> type[FrictionTable]:
    """Return the model of ``[friction]`` for some laws."""
    shared = ContactUnits(
        "",
        turning=bool(contacts) and all(one.turning for one in contacts),
        in_forces=bool(contacts) and all(one.in_forces for one in contacts),
    )
    if len(contacts) > 1:
        alone = {one.name: friction_table(kinds, (one._replace(name=""),)) for one in contacts}
        return _by_contact(friction_table(kinds, (shared,)), alone)
    fields: dict[str, Any] = {}
    misplaced = {}
    for name, owners in _owners(kinds).items():
        if not _means_one_thing(name, owners):
            where = " or ".join(f"[friction.{law.name}]" for law in owners)
            misplaced[name] = f"it depends on the law: give it under {where}"
            continue
        quantities = [fields_of(law)[name] for law in owners if name in fields_of(law)]
        if quantities:
            fields[name] = (_number(quantities, shared), None)
        else:
            fields[name] = (_hint(owners[0], name, shared), None)
    for law in kinds:
        own = _law_table(law, shared) | None
        fields[python_name(law.name)] = (own, Field(default=None, alias=law.name))
    model = create_model("Friction", __base__=FrictionTable, **fields)
    model.__doc__ = FrictionTable.__doc__
    model.misplaced = misplaced
    return model


def _table_or_none(value: object) -> object:
    return None if value == NONE else value


def _by_contact(
    of_one: type[FrictionTable], contacts: Mapping[str, type[FrictionTable]]
) -> type[FrictionTable]:
    """Return the table of one contact with a table of its own for each of several."""
    taken = {field.alias or name for name, field in of_one.model_fields.items()}
    fields: dict[str, Any] = {}
    for name, table in contacts.items():
        if name in (*taken, *of_one.misplaced):
            raise InputError(
                f"the contact {name!r} has the name of a law or of a law's parameter, which"
                " [friction] of a rig file could not tell apart: give the contact another name."
            )
        own: Any = table
        own = Annotated[own | None, BeforeValidator(_table_or_none)]
        fields[python_name(name, "contact")] = (own, Field(default=None, alias=name))
    model = create_model("FrictionByContact", __base__=of_one, **fields)
    model.__doc__ = FrictionTable.__doc__
    model.misplaced, model.of_one = of_one.misplaced, of_one
    return model
