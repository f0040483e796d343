"""Laws of a rig from its ``[friction]`` table: shared values, and a table for each law."""

import dataclasses
import functools
import typing
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Annotated, Any, ClassVar, NamedTuple

from pydantic import BeforeValidator, Field, create_model

from stickslip.data.estimates import LOAD
from stickslip.data.rig import KnownLaws
from stickslip.data.rigs.rig_models import ITS_TABLE, Given, Number, RigFile, TomlTable
from stickslip.errors import InputError, ParameterError
from stickslip.friction import LAWS, FrictionLaw, force_parameters, law_type, laws, listed
from stickslip.quantities import Quantity, fields_of, turned
from stickslip.show.formatting import number

# The ``[friction]`` table: shared values, and a table of its own for each law.

NONE = "none"
"""What stands in place of a contact's table where nothing rubs."""


class FrictionTable(TomlTable):
    """Values that all laws share, and tables of single laws."""

    of_one: ClassVar[type[TomlTable]] = TomlTable
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
        (quantity, {turned(quantity.unit, at.turning), turned(quantity.force_unit, at.turning)})
        if at.in_forces
        else (quantity, {turned(quantity.unit, at.turning)})
        for quantity in quantities
    ]
    others = (
        dataclasses.replace(quantity, unit=unit)
        for quantity, found in units
        for unit in sorted(found - {quantity.unit})
    )
    number = Number(
        quantities[0],
        mark="assumed",
        alternatives=(*quantities[1:], *others),
        measured=True,
        elsewhere=elsewhere,
    )
    return Annotated[Any, number]


def _forces_table(law: type[FrictionLaw]) -> type[TomlTable]:
    fields: dict[str, Any] = {"load": (Annotated[Any, Number(LOAD)], ...)}
    for key, (_, quantity) in force_parameters(law).items():
        fields[key] = (Annotated[Any, Number(quantity, mark="assumed")], None)
    model = create_model(f"{law.__name__}Forces", __base__=TomlTable, **fields)
    model.__doc__ = f"Values of {law.title} as forces, stiffness and damping at a load."
    return model


def _law_table(law: type[FrictionLaw], at: ContactUnits) -> type[TomlTable]:
    fields: dict[str, Any] = {}
    for field in dataclasses.fields(law):
        default = None if field.default is dataclasses.MISSING else field.default
        fields[field.name] = (_hint(law, field.name, at), default)
    if force_parameters(law):
        fields["forces"] = (_forces_table(law) | None, None)
    model = create_model(law.__name__, __base__=TomlTable, **fields)
    model.__doc__ = (vars(law).get("__doc__") or "").strip().partition("\n")[0]
    return model


def _hint(law: type[FrictionLaw], name: str, at: ContactUnits) -> Any:
    quantity = fields_of(law).get(name)
    if quantity is not None:
        found = {field: (key, measured) for key, (field, measured) in force_parameters(law).items()}
        if name not in found or not quantity.per_load or at.in_forces:
            return _number([quantity], at)
        key, known_quantity = found[name]
        where = (
            f"a value in {known_quantity.unit} stands as {key} under [{ITS_TABLE}.forces], with the"
            " load at which it was measured"
        )
        return _number([quantity], at, (known_quantity, where))
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
        turning=bool(contacts) and all(contact.turning for contact in contacts),
        in_forces=bool(contacts) and all(contact.in_forces for contact in contacts),
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


# Builds the laws of a rig from its ``[friction]`` table.


def laws_of(
    friction: object, contacts: Collection[str], more: Mapping[str, type[FrictionLaw]]
) -> dict[str, type[FrictionLaw]]:
    """Return the laws that a table ``[friction]`` may be about, without the others being made.

    These are the laws that are tried unasked, those with a table, and for values that these have
    not, all that have them; all laws where a key is unknown.
    """
    top = friction if isinstance(friction, Mapping) else {}
    tables = [top, *(top[name] for name in contacts if isinstance(top.get(name), Mapping))]
    keys = {key for table in tables for key in table} - {*contacts}
    known = laws()
    usual = [name for name, entry in listed().items() if not entry.on_request or name in keys]
    found = {name: known[name] for name in usual} | {**more}
    lacking = keys - found.keys() - {field for kind in found.values() for field in _fields(kind)}
    if not lacking:
        return found
    having = {name: lacking & _fields(known[name]) for name in known}
    if lacking.difference(*having.values()):
        return {**known, **more}
    wanted = {*found, *(name for name, keys in having.items() if keys)}
    return {name: known[name] for name in known if name in wanted} | {**more}


def _fields(kind: type[FrictionLaw]) -> set[str]:
    return {field.name for field in dataclasses.fields(kind)}


def known_laws(
    friction: TomlTable,
    file: RigFile,
    kinds: Mapping[str, type[FrictionLaw]],
    at: str = "friction",
) -> KnownLaws:
    """Return the laws for which the table gives every required parameter.

    A value in a law's own table comes before a shared one, but not before an override of that.
    """
    found: dict[str, FrictionLaw] = {}
    assumed: dict[str, tuple[str, ...]] = {}
    uncertainties: dict[str, dict[str, float]] = {}
    named, given = [], {}
    shared = friction.given()
    meant = _meant(kinds, shared)
    for name, law in kinds.items():
        own: TomlTable | None = getattr(friction, python_name(name))
        table = file.called.get(f"{at}.{name}", f"{at}.{name}")
        names = [field.name for field in dataclasses.fields(law)]
        values = {key: shared[key] for key in names if key in shared}
        if own is not None:
            named.append(name)
            changed = overridden_fields(law, file.overridden, of_law=False)
            changed -= overridden_fields(law, file.overridden, shared=False)
            kept = {key: value for key, value in values.items() if key in changed}
            values |= _own(own, law, file, table) | kept
        given[name] = {key: _plain(value) for key, value in values.items()}
        stated = {
            key: value.uncertainty
            for key, value in values.items()
            if isinstance(value, Given) and value.uncertainty is not None
        }
        if stated:
            uncertainties[name] = stated
        missing = [key for key in _required(law) if key not in values]
        if missing and own is not None and values:  # a table without any names the law to fit
            raise ParameterError(_missing(law, missing[0], file, at, table))
        if missing or (own is None and law.on_request and name not in meant):
            continue
        found[name] = _build(law, values, file, at, table)
        marked = [key for key in names if isinstance(values.get(key), Given) and values[key].marked]
        if marked:
            assumed[name] = tuple(marked)
    return KnownLaws(
        laws=found,
        named=tuple(named),
        given=_GivenValues(
            {name: values for name, values in given.items() if values},
            {
                key: _plain(value)
                for key, value in shared.items()
                if not isinstance(value, TomlTable)
            },
        ),
        assumed=assumed,
        uncertainties=uncertainties,
        tables={
            table.removeprefix(f"{at}."): law.removeprefix(f"{at}.")
            for law, table in file.called.items()
            if law.removeprefix(f"{at}.") in kinds and law != table
        },
    )


def by_contact(
    friction: FrictionTable,
    contacts: Collection[str],
    file: RigFile,
    kinds: Mapping[str, type[FrictionLaw]],
) -> dict[str, KnownLaws | None]:
    """Return the laws of each of several contacts; nothing if no contact has a table of its own.

    What stands directly in the table ``[friction]`` is shared: it comes before what stands in the
    table of a contact only where an override sets it.
    """
    given = friction.given()
    keys = {python_name(name, "contact"): name for name in contacts}
    if not keys.keys() & given.keys():
        return {}
    tables = {python_name(name): name for name in kinds}
    both = [tables[key] for key in given if key in tables]
    if both:
        raise InputError(
            f"{file}: [friction.{both[0]}] stands beside tables of contacts: give the law to each"
            f" contact, as in [friction.{next(iter(contacts))}.{both[0]}]."
        )
    shared = {key: value for key, value in given.items() if key not in keys}
    found: dict[str, KnownLaws | None] = {}
    for key, name in keys.items():
        own: TomlTable | None = getattr(friction, key)
        if own is None and key in given:
            found[name] = None
            continue
        at = f"friction.{name}"
        paths = {path for path in file.overridden if path.startswith("friction.")}
        of_contact = {
            f"friction{path.removeprefix(at)}" for path in paths if path.startswith(at + ".")
        }
        of_all = {path for path in paths if path.removeprefix("friction.") in shared}
        kept = {} if own is None else own.given()
        values = {
            k: value
            for k, value in shared.items()
            if k not in kept or (f"friction.{k}" in of_all and f"friction.{k}" not in of_contact)
        }
        whole = (friction.of_one() if own is None else own).model_copy(update=values)
        found[name] = known_laws(
            whole, dataclasses.replace(file, overridden=of_contact | of_all), kinds, at
        )
    return found


def overridden_fields(
    law: type[FrictionLaw],
    overridden: Collection[str],
    *,
    shared: bool = True,
    of_law: bool = True,
    at: str = "friction",
) -> set[str]:
    """Return the fields of a law that overrides set: by shared paths, by those of its own table."""
    found = set()
    forces = force_parameters(law)
    for path in overridden:
        table, _, rest = path.removeprefix(f"{at}.").partition(".")
        key = rest.removeprefix("forces.")
        if not path.startswith(f"{at}."):
            continue
        if shared and not rest:
            found.add(table)
        elif of_law and table == law.name:
            found.add(forces[key][0] if key != rest and key in forces else rest)
    return found & {field.name for field in dataclasses.fields(law)}


@dataclasses.dataclass(frozen=True, eq=False)
class _GivenValues(Mapping[str, Mapping[str, float]]):
    """Values by law; of one that is asked for later, those of the shared ones that it has."""

    own: Mapping[str, Mapping[str, float]]
    shared: Mapping[str, Any]

    def __getitem__(self, name: str) -> Mapping[str, float]:
        if name in self.own:
            return self.own[name]
        try:
            names = _fields(law_type(name)) & self.shared.keys()
        except InputError:
            names = set()
        if not names:
            raise KeyError(name)
        return {key: value for key, value in self.shared.items() if key in names}

    def __iter__(self) -> Iterator[str]:
        return iter(self.own)

    def __len__(self) -> int:
        return len(self.own)


def _plain(value: Any) -> Any:
    return value.value if isinstance(value, Given) else value


def _meant(kinds: Mapping[str, type[FrictionLaw]], shared: Collection[str]) -> set[str]:
    """Return the laws on request that shared values bring.

    These are all they require, among them some that no law has that is tried unasked, and that no
    other law on request could be meant by.
    """
    usual = {field for kind in kinds.values() if not kind.on_request for field in _fields(kind)}
    special = {
        name: (_fields(kind) & {*shared}) - usual
        for name, kind in kinds.items()
        if kind.on_request and all(field in shared for field in _required(kind))
    }
    return {
        name
        for name, own in special.items()
        if own and not any(own <= special[other] for other in special if other != name)
    }


def _required(law: type[FrictionLaw]) -> list[str]:
    return [field.name for field in dataclasses.fields(law) if field.default is dataclasses.MISSING]


def _own(own: TomlTable, law: type[FrictionLaw], file: RigFile, table: str) -> dict[str, Any]:
    """Return the values of a law's own table, those given as forces over their load."""
    values = own.given()
    forces: TomlTable | None = values.pop("forces", None)
    if forces is None:
        return values
    given = forces.given()
    load = given.pop("load")
    for key, force in given.items():
        field, quantity = force_parameters(law)[key]
        normalised = f"friction.{law.name}.{field}"
        if field in values and normalised in file.overridden:
            continue
        if field in values and f"friction.{law.name}.forces.{key}" not in file.overridden:
            raise InputError(
                f"{file}: {table}.{field} and {table}.forces.{key} both give the same parameter:"
                " leave one out."
            )
        scale = 1.0 if quantity.unit == fields_of(law)[field].unit else load
        values[field] = Given(force.value / scale, force.marked)
    return values


def _missing(law: type[FrictionLaw], key: str, file: RigFile, at: str, table: str) -> str:
    symbol = f" ({fields_of(law)[key].symbol})" if key in fields_of(law) else ""
    forces = [parameter for parameter, (field, _) in force_parameters(law).items() if field == key]
    other = f", or {forces[0]} under [{table}.forces]" if forces else ""
    return f"{file}: {table}.{key}{symbol} is missing. Add {key} under [{table}] or [{at}]{other}."


def _build(
    law: type[FrictionLaw], values: Mapping[str, Any], file: RigFile, at: str, table: str
) -> FrictionLaw:
    given = {key: _plain(value) for key, value in values.items()}
    _check_order(law, given, file, at, table)
    return file.built(law, given, table, "friction")


def _check_order(
    law: type[FrictionLaw], values: Mapping[str, float], file: RigFile, at: str, table: str
) -> None:
    """Name both parameters where an override has put one above or below another of the file."""
    known = fields_of(law)
    changed = {
        key: f"{where}.{key}"
        for key in values
        for where, path in ((at, "friction"), (table, f"friction.{law.name}"))
        if f"{path}.{key}" in file.overridden
    }
    for upper, quantity in known.items():
        lower = quantity.at_least
        if lower is None or values.get(upper) is None or values.get(lower) is None:
            continue
        if values[upper] >= values[lower] or (upper in changed) is (lower in changed):
            continue
        key, other, relation = (
            (upper, lower, "below") if upper in changed else (lower, upper, "above")
        )
        raise ParameterError(
            f"override of {file}: {changed[key]} ({known[key].symbol}) = {number(values[key], 6)}"
            f" is {relation} {other} ({known[other].symbol}) = {number(values[other], 6)} of the"
            f" file: override both, so that {upper} is at least {lower}."
        )
