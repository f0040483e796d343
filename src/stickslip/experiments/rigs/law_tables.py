"""The ``[friction]`` table: shared values, and a table of its own for each law."""

import dataclasses
import functools
import inspect
import typing
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import Field, create_model

from stickslip.experiments.estimates import LOAD
from stickslip.experiments.rigs.rig_models import Number, Table
from stickslip.friction import LAWS, FrictionLaw, laws
from stickslip.quantities import Quantity, fields_of

__all__ = ["FrictionTable", "force_parameters", "friction_table", "python_name"]

_PER_LOAD = {"1/m": "N/m", "s/m": "N s/m"}


class FrictionTable(Table):
    """Values that all laws share, and tables of single laws."""


def python_name(law: str) -> str:
    """Return the attribute under which a law's own table is kept."""
    return "law_" + law.replace("-", "_")


@functools.cache
def force_parameters(law: type[FrictionLaw]) -> Mapping[str, tuple[str, Quantity]]:
    """Return what a law takes in forces: key -> the field it becomes, its quantity.

    What the field has in another unit is divided by the load.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> force_parameters(Dahl)["bristle_stiffness"][1].unit
    'N/m'
    """
    maker = getattr(law, "from_forces", None)
    found = {}
    for key in inspect.signature(maker).parameters if maker else ():
        field = key.replace("_force", "_coefficient")
        quantity = fields_of(law).get(field)
        if quantity is None:
            continue
        if key != field:
            symbol, unit = quantity.symbol.replace("mu_", "F_"), "N"
        elif quantity.unit in _PER_LOAD:
            symbol, unit = quantity.symbol, _PER_LOAD[quantity.unit]
        elif quantity.unit == "N s/m":  # a viscous part does not depend on the load
            symbol, unit = quantity.symbol, quantity.unit
        else:
            continue
        found[key] = field, dataclasses.replace(quantity, symbol=symbol, unit=unit, at_least=None)
    return MappingProxyType(found)


def _forces_table(law: type[FrictionLaw]) -> type[Table]:
    fields: dict[str, Any] = {"load": (Annotated[Any, Number(LOAD)], ...)}
    for key, (_, quantity) in force_parameters(law).items():
        fields[key] = (Annotated[Any, Number(quantity, mark="assumed")], None)
    model = create_model(f"{law.__name__}Forces", __base__=Table, **fields)
    model.__doc__ = f"Values of {law.title} as forces, stiffness and damping at a load."
    return model


def _law_table(law: type[FrictionLaw]) -> type[Table]:
    fields: dict[str, Any] = {}
    for field in dataclasses.fields(law):
        default = None if field.default is dataclasses.MISSING else field.default
        fields[field.name] = (_hint(law, field.name), default)
    if force_parameters(law):
        fields["forces"] = (_forces_table(law) | None, None)
    model = create_model(law.__name__, __base__=Table, **fields)
    model.__doc__ = (law.__doc__ or "").strip().partition("\n")[0]
    return model


def _hint(law: type[FrictionLaw], name: str) -> Any:
    quantity = fields_of(law).get(name)
    if quantity is not None:
        return Annotated[Any, Number(quantity, mark="assumed")]
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
        if law in LAWS.values()
        for field in dataclasses.fields(law)
        if field.name == name and field.default not in (dataclasses.MISSING, None)
    }
    return len(units) == 1 and len(defaults) <= 1


@functools.cache
def friction_table(more: tuple[type[FrictionLaw], ...] = ()) -> type[FrictionTable]:
    """Return the model of ``[friction]`` for all laws that are installed, and more."""
    kinds = {**laws(), **{law.name: law for law in more}}
    fields: dict[str, Any] = {}
    misplaced = {}
    for name, owners in _owners(kinds.values()).items():
        if not _means_one_thing(name, owners):
            where = " or ".join(f"[friction.{law.name}]" for law in owners)
            misplaced[name] = f"it depends on the law: give it under {where}"
            continue
        quantities = [fields_of(law)[name] for law in owners if name in fields_of(law)]
        if quantities:
            number = Number(quantities[0], mark="assumed", alternatives=tuple(quantities[1:]))
            fields[name] = (Annotated[Any, number], None)
        else:
            fields[name] = (_hint(owners[0], name), None)
    for law_name, law in kinds.items():
        own = _law_table(law) | None
        fields[python_name(law_name)] = (own, Field(default=None, alias=law_name))
    model = create_model("Friction", __base__=FrictionTable, **fields)
    model.__doc__ = FrictionTable.__doc__
    model.misplaced = misplaced
    return model
