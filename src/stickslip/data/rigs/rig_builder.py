"""Builds a rig from its file."""

import dataclasses
import functools
import hashlib
import importlib
import json
import numbers
import re
import sys
import typing
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from importlib.resources import files
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, TypeVar

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    ValidationError,
    WithJsonSchema,
    create_model,
)
from pydantic_core import PydanticCustomError

from stickslip.data import measurement as measurements
from stickslip.data import rig
from stickslip.data.estimates import LOAD, LawEstimates
from stickslip.data.measurement import BESIDE, BY_JOINT, QUANTITIES
from stickslip.data.readers import toml
from stickslip.data.readers.columns import MOTORS, Reading, column_of, motor_constants
from stickslip.data.readers.layout import Decimal, Layout, Repair, Separator
from stickslip.data.records import read_data
from stickslip.data.rig import KnownLaws
from stickslip.data.rigs import rig_models
from stickslip.data.rigs.rig_models import (
    ITS_TABLE,
    Given,
    Number,
    RigFile,
    TomlTable,
    UrdfTable,
    complaint,
    fill_friction,
    robot_of,
)
from stickslip.data.tolerances import LARGEST_TEXT
from stickslip.data.travels import scale_of
from stickslip.data.units import read_gain, read_number
from stickslip.errors import InputError, ParameterError, UnknownNameError, concerning
from stickslip.friction import (
    LAWS,
    PARTS,
    FrictionLaw,
    Laws,
    curves_beside,
    force_parameters,
    is_composition,
    law_type,
    laws,
    listed,
)
from stickslip.mechanisms import (
    LINKS,
    PREFIX,
    DCMotor,
    LinearOrRotary,
    Mechanism,
    as_rotary,
    canonical_path,
    checked_contacts,
    given_inputs,
    input_names,
    mechanisms,
    quantity_at,
)
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.mechanisms.drives import DRIVES, Drive, SampledSwing, Sum
from stickslip.quantities import Quantity, fields_of, is_rotary, motion_kinds, turned
from stickslip.show.documents import with_files
from stickslip.show.formatting import joined, number

# Laws of a rig from its ``[friction]`` table: shared values, and a table for each law.

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
    per_load, turning = not at.in_forces, at.turning
    others = (
        dataclasses.replace(item, unit=unit)
        for item in quantities
        for unit in sorted(
            {turned(item.unit, turning), item.unit_at(per_load=per_load, turning=turning)}
            - {item.unit}
        )
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
        result = {
            field: (key, measured) for key, (field, measured) in force_parameters(law).items()
        }
        if name not in result or not quantity.per_load or at.in_forces:
            return _number([quantity], at)
        key, known_quantity = result[name]
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
        alone = {
            contact.name: friction_table(kinds, (contact._replace(name=""),))
            for contact in contacts
        }
        return _by_contact(friction_table(kinds, (shared,)), alone)
    fields: dict[str, Any] = {}
    misplaced = {"type": "a law is named by its table: give its values under [friction.{}]"}
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
        own = Annotated[own | None, BeforeValidator(lambda value: None if value == NONE else value)]
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
    result = {name: known[name] for name in usual} | {**more}
    lacking = keys - result.keys() - {field for kind in result.values() for field in _fields(kind)}
    if not lacking:
        return result
    having = {name: lacking & _fields(known[name]) for name in known}
    if lacking.difference(*having.values()):
        return {**known, **more}
    wanted = {*result, *(name for name, keys in having.items() if keys)}
    return {name: known[name] for name in known if name in wanted} | {**more}


def _fields(kind: type[FrictionLaw]) -> set[str]:
    return {field.name for field in dataclasses.fields(kind)}


def law_values(
    friction: TomlTable,
    file: RigFile,
    kinds: Mapping[str, type[FrictionLaw]],
    at: str = "friction",
) -> KnownLaws:
    """Return the laws for which the table gives every required parameter.

    A value in a law's own table comes before a shared one, but not before an override of that.
    """
    result: dict[str, FrictionLaw] = {}
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
            raise ParameterError(_missing_parameter(law, missing[0], file, at, table))
        if missing or (own is None and law.on_request and name not in meant):
            continue
        bare = {key: _plain(value) for key, value in values.items()}
        _check_order(law, bare, file, at, table)
        result[name] = file.built(law, bare, table, "friction")
        marked = [key for key in names if isinstance(values.get(key), Given) and values[key].marked]
        if marked:
            assumed[name] = tuple(marked)
    return KnownLaws(
        laws=result,
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
    result: dict[str, KnownLaws | None] = {}
    for key, name in keys.items():
        own: TomlTable | None = getattr(friction, key)
        if own is None and key in given:
            result[name] = None
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
        result[name] = law_values(
            whole, dataclasses.replace(file, overridden=of_contact | of_all), kinds, at
        )
    return result


def overridden_fields(
    law: type[FrictionLaw],
    overridden: Collection[str],
    *,
    shared: bool = True,
    of_law: bool = True,
    at: str = "friction",
) -> set[str]:
    """Return the fields of a law that overrides set: by shared paths, by those of its own table."""
    result = set()
    forces = force_parameters(law)
    for path in overridden:
        table, _, rest = path.removeprefix(f"{at}.").partition(".")
        key = rest.removeprefix("forces.")
        if not path.startswith(f"{at}."):
            continue
        if shared and not rest:
            result.add(table)
        elif of_law and table == law.name:
            result.add(forces[key][0] if key != rest and key in forces else rest)
    return result & {field.name for field in dataclasses.fields(law)}


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


def _missing_parameter(law: type[FrictionLaw], key: str, file: RigFile, at: str, table: str) -> str:
    symbol = f" ({fields_of(law)[key].symbol})" if key in fields_of(law) else ""
    forces = [parameter for parameter, (field, _) in force_parameters(law).items() if field == key]
    other = f", or {forces[0]} under [{table}.forces]" if forces else ""
    return f"{file}: {table}.{key}{symbol} is missing. Add {key} under [{table}] or [{at}]{other}."


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


# Builds a rig from its file.

# The schema of rig files.

TRAVEL = QUANTITIES["travel"]
VARY = "vary"
"""Says of a mechanism's parameter that it is to be fitted."""


TEXT = {"type": "string"}
NUMBER = [{"type": "number"}, {**TEXT, "description": "number with a unit"}]
"""What a number may be: in SI, or a text."""


def _table_of(kind: Mapping[str, Any]) -> dict[str, Any]:
    return {"type": "object", "additionalProperties": kind}


Gain = Annotated[Any, PlainValidator(read_gain), WithJsonSchema({"anyOf": NUMBER})]
"""A scale factor, perhaps with the unit that makes SI of that of a column."""
PAIR = {"type": "array", "items": TEXT, "minItems": 2, "maxItems": 2}
Columns = Annotated[Any, WithJsonSchema({"anyOf": [TEXT, PAIR, _table_of(TEXT), NUMBER[0]]})]
"""A column, or the two with a position in a plane; a number in place of uncertainties; `Reading`,
which knows the quantity, checks."""
MotorConstant = Annotated[Any, WithJsonSchema({"anyOf": [*NUMBER, _table_of({"anyOf": NUMBER})]})]
"""A motor constant, or one for each joint; `Reading` checks them."""
NameOrNames = Annotated[Any, WithJsonSchema({"anyOf": [TEXT, _table_of(TEXT)]})]
"""A name, or names by contact; `LawEstimates` checks them."""
Doubt = Annotated[Any, WithJsonSchema({"anyOf": [{**NUMBER[0], "exclusiveMinimum": 0}, NUMBER[1]]})]
"""An uncertainty in the unit of what it belongs to, with which it is read."""


class RunTable(rig_models.TomlTable):
    """How long runs last."""

    t_end: Annotated[Any, rig_models.Number(Quantity("t_end", "s", above=0))] = 10.0
    """Last time of the runs [s]."""
    initial: dict[str, Any] = Field(
        default={}, description="state: value from which simulated runs begin; trials have theirs"
    )


def _by_joint(table: Any) -> Any:
    """Return a table in which ``force.elbow`` is one key: in TOML, a dot makes a table of it."""
    if not isinstance(table, dict):
        return table
    result: dict[Any, Any] = {}
    for key, value in table.items():
        joints = key in (*BY_JOINT, *BESIDE, *MOTORS) and isinstance(value, dict)
        result |= (
            {f"{key}.{joint}": own for joint, own in value.items()} if joints else {key: value}
        )
    return result


J = TypeVar("J")
ByJoint = Annotated[dict[str, J], BeforeValidator(_by_joint)]


class LayoutTable(rig_models.TomlTable):
    """How a text file holds its table; `stickslip init` finds it out."""

    encoding: str = Layout.encoding
    separator: Separator = Layout.separator
    decimal: Decimal = Layout.decimal
    thousands: str = Layout.thousands
    preface: int = Layout.preface
    units_row: bool = Layout.units_row


class ReadTable(rig_models.TomlTable):
    """How the columns of a file are read."""

    columns: ByJoint[Columns] = Field(
        default={},
        description="quantity: name of its column, of a joint as `force.elbow`; `position`: two"
        ' names for motion in a plane; `time`: a rate such as "50 Hz" if no column has times;'
        ' `friction_uncertainty`: that of each reading of friction, or a number such as "0.1 N"',
    )
    units: ByJoint[str] = Field(default={}, description="quantity: unit of its column")
    gain: ByJoint[Gain] = Field(
        default={},
        description="quantity: scale factor, applied after unit conversion if the unit is of the"
        " right kind; otherwise it converts the column to SI, and may have a unit such as N m/A",
    )
    offset: ByJoint[Any] = Field(default={}, description="quantity: zero offset of its sensor")
    repair: list[Repair] = Field(
        default=[],
        min_length=1,
        description="`sort` the rows by time, drop rows with `gaps`, `hold` commands to the next",
    )
    motor_constant: MotorConstant = Field(
        default=None,
        description="force or torque per current of the motor with its gears, such as"
        ' `"0.12 N m/A"`: the column `current` is read as the force; `joint`: one each',
    )
    layout: LayoutTable | None = Field(default=None, description="how a text file holds its table")


class TrialTable(ReadTable):
    """One measured run; several are several trials.

    It has one of `travel`, `mean_velocity`, `travel_per_cycle`, or the `file` of a record.
    """

    travel: Annotated[Any, rig_models.Number(TRAVEL)] = None
    """Measured travel [m]."""
    mean_velocity: Annotated[Any, rig_models.Number(QUANTITIES["mean_velocity"])] = None
    """Measured mean velocity of a driven rig [m/s]."""
    travel_per_cycle: Annotated[Any, rig_models.Number(QUANTITIES["travel_per_cycle"])] = None
    """Measured travel per cycle of the drive [m]."""
    file: str = Field(default="", description="file of a record, relative to the rig file")
    uncertainty: Doubt = Field(
        default=None, description="above 0, in the unit of the measured quantity"
    )
    uncertainty_kind: Literal["rounding", "standard", "interval"] = "standard"
    """What the uncertainty is, as in `Measurement`."""
    name: str = ""
    """Name of the trial."""
    provenance: str = ""
    """Where the trial is from."""
    set: dict[str, Any] = Field(
        default={},
        description="parameter path: value in this trial, optionally with its uncertainty",
    )
    initial: dict[str, Any] = Field(default={}, description="state: initial value")
    conditions: dict[str, float | str] = Field(
        default={}, description="further conditions of the trial, by name: a number or a text"
    )


class DataTable(ReadTable):
    """Files with what was measured, and how they are read; several files are several trials."""

    file: str = Field(default="", description="relative to the rig file")
    files: list[str] = Field(default=[], min_length=1, description="several files, one per trial")
    hold: Literal["zero", "first"] | None = Field(
        default=None,
        description="interpolation of the force: `zero`-order hold (a command) or `first`-order,"
        " linear (a sensor); estimated from the record if not given",
    )
    tolerance: float | str | None = Field(
        default=None,
        description='share of friction by which the law that is named may be off, such as "5 %";'
        " 2 % if not given",
    )
    conditions: list[str] = Field(
        default=[], min_length=1, description="columns with a condition, one value per trial"
    )
    second: str = Field(
        default="",
        alias="validate",
        description="second record for validation, not used in any fit",
    )


def _known_law(name: str) -> str:
    if name not in laws():
        known = {"kind": "friction law", "key": name, "known": list(laws())}
        raise PydanticCustomError("unknown_name", "", known)
    return name


class PublishedTable(rig_models.TomlTable):
    """What a publication reports for one law."""

    law: Annotated[str, AfterValidator(_known_law)] = Field(
        json_schema_extra=lambda schema: schema.update(enum=list(laws()))
    )
    """Registry name of the law."""
    travel: Annotated[Any, rig_models.Number(TRAVEL)] = None
    """Printed travel [m]."""
    velocity_positive: bool | None = None
    """Whether the velocity never becomes negative, as printed."""
    displacement_monotone: bool | None = None
    """Whether the displacement never decreases, as printed."""
    relative_error: Annotated[Any, rig_models.Number(Quantity("e", "1", low=0))] = None
    """Printed error of the travel over the measured travel."""
    note: str = ""
    """A remark."""


def flat(given: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield dotted paths: TOML makes tables of a dotted key that is not in quotes.

    Examples
    --------
    >>> dict(flat({"elbow": {"static_coefficient": 0.2}, "x.y": 1}))
    {'elbow.static_coefficient': 0.2, 'x.y': 1}
    """
    for name, value in given.items():
        if isinstance(value, dict) and "value" not in value:
            yield from flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _flattened(table: Any) -> Any:
    return dict(flat(table)) if isinstance(table, dict) else table


def _nested(schema: dict[str, Any]) -> None:
    """Let a table stand for the parameters of a contact, which a dot in a key makes."""
    inner = schema["additionalProperties"]
    table = {"type": "object", "additionalProperties": inner}
    schema["additionalProperties"] = {"anyOf": [inner, table]}


ByParameter = Annotated[dict[str, J], BeforeValidator(_flattened), Field(json_schema_extra=_nested)]


class EstimatesTable(rig_models.TomlTable):
    """How well the values of a law, or of laws by contact, are known, as fits write it; in SI."""

    law: NameOrNames = Field(
        description="law to which the values belong; `contact: law` where contacts have laws of"
        " their own, whose parameters are then called as `elbow.kinetic_coefficient`"
    )
    interval: Literal["95 %", "rounding range", "stated interval"] = "95 %"
    """Kind of the intervals."""
    levels: Literal["per load", "forces", "torques"] = Field(
        default="per load",
        description="unit of levels and bristle stiffness: coefficients per normal force, or"
        " forces or torques",
    )
    largest_speed: float | dict[str, float] | None = Field(
        default=None,
        description="largest slip speed in the fitted data; by contact where contacts have laws of"
        " their own",
    )
    not_fitted: list[str] = Field(
        default=[], description="parameters that were given or assumed, not fitted"
    )
    not_identified: ByParameter[str] = Field(
        default={}, description="parameter: reason why the data do not identify it"
    )
    intervals: ByParameter[list[float]] = Field(
        default={}, description="parameter: lower and upper end of its interval"
    )
    covariance_of: list[str] = Field(
        default=[], description="parameters in the rows and columns of the covariance"
    )
    covariance: list[list[float]] = Field(
        default=[], description="covariance of the normal distribution with these intervals"
    )


A_NUMBER, A_DRIVE = "a number", "a drive"
"""What may stand for an input of the contact."""


def _number_or_drive(value: object) -> str:
    return A_DRIVE if isinstance(value, dict | list) else A_NUMBER


def _contact_input(name: str) -> Any:
    """Return the type of a contact input: a number with its unit, or a drive."""
    quantity = CONTACT_INPUTS[name].quantity()
    other = (dataclasses.replace(quantity, unit=quantity.or_unit),) if quantity.or_unit else ()
    number: Any = Annotated[Any, rig_models.Number(quantity, alternatives=other), Tag(A_NUMBER)]
    drive: Any = Annotated[rig_models.drive_tables(), Tag(A_DRIVE)]
    return Annotated[number | drive, Discriminator(_number_or_drive)]


class ContactTable(rig_models.TomlTable):
    """What friction laws may ask of the contact, and the mechanism does not tell."""


@functools.cache
def contact_table(contacts: tuple[str, ...] = ()) -> type[ContactTable]:
    """Return the table of the contact with its inputs, and a table of each of several contacts."""
    fields: dict[str, Any] = {
        name: (_contact_input(name), Field(default=None, description=known.meaning))
        for name, known in CONTACT_INPUTS.items()
    }
    result = create_model("Contact", __base__=ContactTable, **fields)
    if len(contacts) < 2:
        return result
    own: dict[str, Any] = {
        python_name(name, "contact"): (result | None, Field(default=None, alias=name))
        for name in contacts
        if name not in CONTACT_INPUTS
    }
    return create_model("Contacts", __base__=result, **own)


class RigTable(rig_models.TomlTable):
    """A rig: what moves, which friction values are known, and what was measured."""

    title: str = ""
    """Title of the rig; the name of the file if empty."""
    subject: str = ""
    """What moves, in words."""
    source: str = ""
    """Where the rig is from."""
    run: RunTable = RunTable()
    """Length of the runs."""
    trial: list[TrialTable] = Field(default=[], min_length=1)
    """Measured runs."""
    data: DataTable = DataTable()
    """Data files."""
    published: list[PublishedTable] = Field(default=[], min_length=1)
    """What a publication reports, by law."""
    estimates: EstimatesTable | None = None
    """How well the values of one law are known."""
    mechanism: Any
    """The mechanism; `rig_table` sets its type."""
    contact: ContactTable = ContactTable()
    """Inputs of the contact; `rig_table` sets its type."""
    friction: FrictionTable
    """Parameters of friction laws."""


@functools.cache
def rig_table(
    mechanism: tuple[str, type[Mechanism]] | None = None,
    laws: tuple[type[FrictionLaw], ...] = (),
    contacts: tuple[ContactUnits, ...] = (),
) -> type[RigTable]:
    """Return the model of a rig file with all mechanisms and drives that are installed.

    A mechanism of the user's, with its ``type``, may come to them.
    """
    known = {**mechanisms(), **({} if mechanism is None else dict([mechanism]))}
    tables = {
        name: rig_models.table_of(cls, name, VARY, measured=True) for name, cls in known.items()
    }
    options = rig_models.choice({**tables, rig_models.URDF: rig_models.UrdfTable})
    friction = friction_table(laws, contacts)
    contact = contact_table(tuple(units.name for units in contacts))
    return create_model(
        "Rig",
        __base__=RigTable,
        mechanism=(options, ...),
        contact=(contact, contact()),
        friction=(friction, friction()),
    )


def _drop_nulls(node: Any) -> None:
    """Remove defaults and types that TOML cannot write."""
    if isinstance(node, Mapping):
        assert isinstance(node, dict)
        default = node.get("default", 0)
        if default is None:
            del node["default"]
        elif isinstance(default, dict):
            node["default"] = {key: value for key, value in default.items() if value is not None}
        if "anyOf" in node:
            node["anyOf"] = [option for option in node["anyOf"] if option != {"type": "null"}]
    for inner in (
        node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    ):
        _drop_nulls(inner)


# Classes that a rig file names by import path; nothing is imported unless the user allows it.

_PATH = re.compile(r"(?P<module>[^\W\d]\w*(\.[^\W\d]\w*)*):(?P<name>[^\W\d]\w*)")


@dataclass(frozen=True)
class Imported:
    """What was imported for one file."""

    mechanism: tuple[str, type[Mechanism]] | None = None
    """Its import path and the class."""
    laws: Mapping[str, type[FrictionLaw]] = dataclasses.field(default_factory=dict)
    """By name."""
    tables: Mapping[str, str] = dataclasses.field(default_factory=dict)
    """Paths of tables of laws by those that the file calls them."""


def imported(raw: dict[str, Any], file: RigFile, *, beside: Path | None, allow: bool) -> Imported:
    """Import what the tables name by import path, and take those names of laws out of them."""
    wanted = dict(_wanted(raw))
    for key, path in wanted.items():
        where = f"{file.place(key)}: {key}"
        match = _PATH.fullmatch(path)
        if match is None:
            raise InputError(
                f"{where} must be a name, or module:Class such as my_module:MyClass, got {path!r}."
            )
        if not allow:
            raise InputError(
                f"{where} requests the import of {match['name']} from the Python module"
                f" {match['module']}, which runs its code. Nothing was imported. If you trust it,"
                " give --allow-import on the command line or load_rig(..., allow_import=True)."
            )
    result = {
        key: _class(path, f"{file.place(key)}: {key}", beside) for key, path in wanted.items()
    }
    mechanism = result.pop("mechanism.type", None)
    own: dict[str, type[FrictionLaw]] = {}
    tables: dict[str, str] = {}
    for where, table, law in _composed(raw, file, beside):
        tables[f"{where}.{table}"] = f"{where}.{law.name}"
        if law.name not in laws():
            own[law.name] = law
    for key, kind in result.items():
        *above, table, _ = key.split(".")
        _check_name(kind, table, f"{file.place(key)}: {key}")
        holder = raw
        for step in above:
            holder = holder[step]
        del holder[table]["type"]
        own[table] = kind
    given = None if mechanism is None else (wanted["mechanism.type"], mechanism)
    return Imported(given, own, tables)


def _composed(
    raw: dict[str, Any], file: RigFile, beside: Path | None
) -> Iterator[tuple[str, str, type[FrictionLaw]]]:
    """Put tables of composed laws under the names of these; yield where, both names and law."""
    friction = raw.get("friction")
    if not isinstance(friction, dict):
        return
    inner = {f"friction.{key}": item for key, item in friction.items() if isinstance(item, dict)}
    if "law" in friction:  # its values are shared ones
        kind = _law(friction.pop("law"), f"{file}: friction", beside)
        friction.setdefault(kind.name, {})
        yield "friction", kind.name, kind
    for above, tables in {"friction": friction, **inner}.items():  # one contact, or several
        for name, table in list(tables.items()):
            if not isinstance(table, dict):
                continue
            named_by = is_composition(name) and not name.isidentifier()  # not a contact "ramp"
            text = table.pop("law", name if named_by else None)
            if text is None:
                continue
            where = f"{file}: {above}.{name}"
            kind = _law(text, where, beside)
            if laws().get(name, kind) is not kind:
                raise InputError(
                    f"{where} has the name of another law than its law = {text!r}: rename the"
                    f" table, such as [{above}.own], or leave law out."
                )
            other = tables.pop(kind.name, {}) if kind.name != name else {}
            if any(f"{above}.{kind.name}.{key}" not in file.overridden for key in other):
                raise InputError(
                    f"{where} is the law {kind.name}, which has a table already: leave one out."
                )
            tables[kind.name] = tables.pop(name) | other
            yield above, name, kind


def _law(text: object, where: str, beside: Path | None) -> type[FrictionLaw]:
    """Return the law of a table."""
    if not isinstance(text, str):
        raise InputError(f"{where}.law must be a text such as 'level + viscous', got {text!r}.")
    with concerning(f"{where}:", InputError):
        return law_type(text if beside is None else curves_beside(text, beside))


def _wanted(raw: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the keys under which import paths stand."""
    mechanism, friction = raw.get("mechanism"), raw.get("friction")
    tables = {"mechanism": mechanism}
    if isinstance(friction, dict):
        tables |= {f"friction.{name}": table for name, table in friction.items()}
        tables |= {  # the laws of one of several contacts
            f"friction.{contact}.{name}": table
            for contact, inner in friction.items()
            if isinstance(inner, dict)
            for name, table in inner.items()
        }
    for name, table in tables.items():
        path = table.get("type") if isinstance(table, dict) else None
        if isinstance(path, str) and ":" in path:
            yield f"{name}.type", path


def _class(path: str, where: str, beside: Path | None) -> Any:
    """Import a class and check that it is one of which objects can be made."""
    module, _, name = path.partition(":")
    result = getattr(_module(module, where, beside), name, None)
    if result is None:
        raise InputError(f"{where}: the module {module} has no {name}.")
    base: type = Mechanism if where.endswith("mechanism.type") else FrictionLaw
    if not (isinstance(result, type) and issubclass(result, base)):
        raise InputError(
            f"{where}: {path} must be a class derived from stickslip.{base.__name__},"
            f" got {result!r}."
        )
    missing = ", ".join(_missing(result, base))
    if missing:
        raise InputError(f"{where}: {path} is abstract: implement {missing}.")
    return result


def _missing(kind: type, base: type) -> list[str]:
    """Return what a class has yet to define or to say of itself."""
    required: tuple[str, ...] = ("name", "coordinates", "rates", "units")
    if base is FrictionLaw:
        required = ("name", "title", "formula", "sources")
    abstract: Collection[str] = getattr(kind, "__abstractmethods__", ())
    return [*sorted(abstract), *(name for name in required if not hasattr(kind, name))]


def _module(name: str, where: str, beside: Path | None) -> ModuleType:
    """Import a module, from beside the rig file too."""
    folder = None if beside is None else str(beside.resolve())
    if folder is not None and folder not in sys.path:
        # at the end, so that no file there hides another module; it stays for worker processes
        sys.path.append(folder)
        importlib.invalidate_caches()
    try:
        module = importlib.import_module(name)
    except (Exception, SystemExit) as error:  # a module of somebody else may raise anything
        raise InputError(
            f"{where}: the module {name} cannot be imported: {type(error).__name__}: {error}."
            " Modules are searched for on Python's path and in the folder of the rig file."
        ) from error
    _check_is_the_one_beside(module, where, folder)
    return module


def _check_is_the_one_beside(module: ModuleType, where: str, folder: str | None) -> None:
    """Check that another module does not hide the one in the folder of the rig file."""
    if folder is None:
        return
    stem = Path(folder, *module.__name__.split("."))
    for own in (stem.with_suffix(".py"), stem / "__init__.py"):
        actual = getattr(module, "__file__", None) or "none"
        if own.exists() and Path(actual).resolve() != own.resolve():
            raise InputError(
                f"{where}: {own} is shadowed by a module of the same name, {actual}. Rename it."
            )


def _check_name(law: type[FrictionLaw], table: str, where: str) -> None:
    """Check that a law stands under its name, which no other law has."""
    if law.name != table:
        raise InputError(
            f"{where}: the law {law.__name__} is named {law.name!r}: write [friction.{law.name}]."
        )
    if laws().get(table, law) is not law:
        raise InputError(
            f"{where}: {table!r} is already the name of another law; give {law.__name__}.name"
            " another value."
        )


# Builds a rig from its file.

BUNDLED = "paper_rig.toml"
SWING_FILE = ("file", "column", "unit")
"""What a table says of the data file with a recorded motion."""


def read_rig(
    path: str | Path | None, overrides: Mapping[str, Any], *, allow_import: bool = False
) -> rig.Rig:
    """Return the rig of a file, or the bundled one, with overrides put in."""
    if path is None:
        name, data = BUNDLED, files("stickslip.data").joinpath(BUNDLED).read_bytes()
    else:
        name, data = str(path), toml.read_bytes(path, largest=LARGEST_TEXT)
    raw = toml.parse(data, name)
    settable = [*toml.paths_of(raw), *_settable(raw)]
    overrides = {_in_words(path, raw, settable): value for path, value in overrides.items()}
    overrides = toml.resolved(raw, overrides, settable)
    toml.apply(raw, overrides)
    file = RigFile(name, overrides)
    _refuse_open(raw, name)
    stated = _kind_of_motion(raw, file)
    beside = None if path is None else Path(path).parent
    friction = raw.get("friction")
    tables = friction.items() if isinstance(friction, dict) else ()
    of_one_law = {name for name, table in tables if isinstance(table, dict) and "law" in table}
    own = imported(raw, file, beside=beside, allow=allow_import)
    overrides = {_of_law(path, own.tables): value for path, value in overrides.items()}
    file = RigFile(name, overrides, {law: given for given, law in own.tables.items()})
    contacts = _contacts(raw, own, file)
    for name in [contact.name for contact in contacts]:
        if len(contacts) > 1 and name in of_one_law:
            raise InputError(
                f"{file}: friction.{name} is a contact: its law needs a table below it, such as"
                f" [friction.{name}.own]."
            )
    kinds = laws_of(friction, [contact.name for contact in contacts], own.laws)
    with concerning(f"{file}:", InputError):
        kind = rig_table(own.mechanism, tuple(kinds.values()), contacts)
    table = _validated(kind, raw, file)
    mechanism = _mechanism(table, file)
    conditions = tuple(table.data.conditions)
    reading = replace(_reading(table.data, file), conditions=conditions, rotary=stated)
    measurement = _measured(table, mechanism, reading, file)
    measurement = measurement and measurements.as_turning(measurement, mechanism.units)
    if measurement is not None and measurement.turning:
        mechanism = as_rotary(mechanism)
    if measurement is not None and measurements.tells_load(
        measurement
    ):  # so that levels are over it
        over_load = tuple(contact._replace(in_forces=False) for contact in contacts)
        _validated(rig_table(own.mechanism, tuple(kinds.values()), over_load), raw, file)
    mechanism = given_inputs(mechanism, _contact_inputs(table.contact, mechanism, file))
    names = tuple(contact.name for contact in contacts) if len(contacts) > 1 else ()
    of_contacts = by_contact(table.friction, names, file, kinds)
    known = rig.KnownLaws()
    if not of_contacts:
        known = law_values(table.friction, file, kinds)
    named = _paths(table, file)
    return rig.Rig(
        title=table.title or Path(file.name).stem,
        subject=table.subject,
        source=table.source,
        mechanism=mechanism,
        laws=known.laws,
        named=known.named,
        given=known.given,
        assumed=known.assumed,
        law_uncertainties=known.uncertainties,
        tables=known.tables,
        contacts=of_contacts,
        vary=_varied(table.mechanism),
        parameter_uncertainties=_doubts(table.mechanism),
        measurement=measurement,
        validate=_files([table.data.second], mechanism, replace(reading, conditions=()), file),
        reading=reading,
        hold=table.data.hold,
        tolerance=None
        if table.data.tolerance is None
        else rig.as_tolerance(table.data.tolerance, f"{file}: data.tolerance"),
        t_end=table.run.t_end,
        initial=_initial(table.run.initial, mechanism, f"{file}: run.initial"),
        estimates=_estimates(table.estimates, known, of_contacts, file),
        published=tuple(rig.Published(**row.given()) for row in table.published),
        digest=with_files(_digest(data, overrides), named),
        path=file.name,
        files=tuple(named),
        overridden=tuple(overrides),
    )


def _validated(kind: type[RigTable], raw: Mapping[str, Any], file: RigFile) -> RigTable:
    try:
        return kind.model_validate(raw)
    except ValidationError as error:
        raise complaint(error, raw, file) from None


def _refuse_open(raw: Mapping[str, Any], file: str) -> None:
    """Refuse a file with question marks in place of numbers, all of them at once."""
    left = [f"{path} = {value!r}" for path, value in _open(raw)]
    if left:
        raise ParameterError(
            f"{file} has a question mark in place of {len(left)} value{'s' * (len(left) > 1)}:"
            f" {', '.join(left)}. Replace each; --set gives those of the mechanism."
        )


def _open(table: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, str]]:
    """Yield paths and texts of what a table leaves open, such as "? g"."""
    for key, value in table.items():
        full = f"{path}.{key}" if path else str(key)
        if isinstance(value, Mapping):
            yield from _open(value, full)
        elif isinstance(value, str) and value.startswith("?") and value[1:2] in {"", " "}:
            yield full, value


def _of_law(path: str, tables: Mapping[str, str]) -> str:
    """Return a path of a law's table under the name of the law."""
    table, dot, key = path.rpartition(".")
    return f"{tables.get(table, table)}{dot}{key}"


def _contact_inputs(table: TomlTable, mechanism: Mechanism, file: RigFile) -> dict[str, Any]:
    """Return what a file tells of the contact; what the mechanism computes is refused."""
    names = [contact.name for contact in mechanism.contacts()]
    result = _values(table, "contact", file)
    _refuse_computed(result, "contact", names, mechanism, file)
    for name in names:
        own = getattr(table, python_name(name, "contact"), None)
        if own is not None:
            result[name] = _values(own, f"contact.{name}", file)
            _refuse_computed(result[name], f"contact.{name}", [name], mechanism, file)
    return result


def _refuse_computed(
    given: Iterable[str], key: str, contacts: Sequence[str], mechanism: Mechanism, file: RigFile
) -> None:
    """Refuse inputs that the mechanism computes at each of some contacts."""
    for name in given:
        if all(name in input_names(mechanism, contact) for contact in contacts):
            raise InputError(
                f"{file.place(f'{key}.{name}')}: {mechanism.name} computes"
                f" {key}.{name} from its motion and forces: leave it out."
            )


def _type_of(raw: Mapping[str, Any]) -> tuple[type[Mechanism] | None, dict[str, Any]]:
    """Return the type of a file's mechanism, None of one that is not known, and its table."""
    table = raw.get("mechanism")
    if not isinstance(table, dict):
        return None, {}
    return mechanisms().get(str(table.get("type"))), table


def _kind_of_motion(raw: Mapping[str, Any], file: RigFile) -> bool | None:
    """Put in that an axis is rotary where units say so; return what the file says of it."""
    kind, table = _type_of(raw)
    if kind is None or not issubclass(kind, LinearOrRotary):
        return None
    drives = table.get("drive", [])
    parts: list[tuple[str, type, dict[str, Any]]] = [("mechanism", kind, table)]
    for drive in drives if isinstance(drives, list) else [drives]:
        if isinstance(drive, dict) and drive.get("type") in DRIVES:
            parts.append(("mechanism.drive", DRIVES[drive["type"]], drive))
    kinds: dict[bool, str] = {}
    for where, owner, part in parts:
        given = {
            name: value.get("value") if isinstance(value, dict) else value
            for name, value in part.items()
        }
        for rotary, words in motion_kinds(owner, given).items():
            kinds.setdefault(rotary, f"{where}.{words}")
    said = table.get("rotary")
    with concerning(f"{file}:"):
        rotary = is_rotary(kinds, said if isinstance(said, bool) else None)
    if rotary:
        table["rotary"] = True
    return rotary if kinds or said is not None else None


def _settable(raw: Mapping[str, Any]) -> Iterator[str]:
    """Yield paths that may be set though a file need not have them."""
    yield from ("run.t_end", "data.hold", "data.tolerance", "data.file")
    known = [raw.get("friction"), raw.get("contact")]  # some of their keys are contacts
    tables = {name for item in known if isinstance(item, dict) for name in item}
    for at in ("contact", *(f"contact.{name}" for name in sorted(tables))):
        yield from (f"{at}.{name}" for name in CONTACT_INPUTS)
    kind, _ = _type_of(raw)
    if kind is not None:
        yield from (f"{PREFIX}.{field.name}" for field in fields(kind))


def _in_words(path: Any, raw: Mapping[str, Any], known: Collection[str]) -> Any:
    """Return a path that ends with a symbol with the name of the parameter there that has it."""
    place, dot, symbol = str(path).rpartition(".")
    if any(f".{full}".endswith(f".{path}") for full in known):
        return path
    kind, _ = _type_of(raw)
    declared = [] if kind is None else [*fields_of(kind).items()]
    declared += [
        (parameter.name, parameter.quantity)
        for part in PARTS.values()
        for parameter in part.parameters
    ]
    ends = {f"{place}{dot}{name}" for name, quantity in declared if quantity.symbol == symbol}
    there = [end for end in ends if any(f".{full}".endswith(f".{end}") for full in known)]
    return there[0] if len(there) == 1 else path


def _contacts(raw: dict[str, Any], own: Imported, file: RigFile) -> tuple[ContactUnits, ...]:
    """Return the names of the contacts, and what units their laws have.

    How many there are may depend on numbers of the mechanism, which is therefore built first.
    Friction levels that a robot description gives are put in where the file says nothing else.
    """
    try:
        table = rig_table(own.mechanism).model_validate(
            {key: value for key, value in raw.items() if key == "mechanism"}
        )
    except ValidationError as error:
        friction = raw.get("friction")
        if "mechanism" not in raw or not isinstance(friction, dict):
            return ()
        raise complaint(error, raw, file) from None
    mechanism = _mechanism(table, file)
    with concerning(f"{file}:", InputError):
        result = checked_contacts(mechanism)
    if isinstance(table.mechanism, UrdfTable):
        fill_friction(raw, table.mechanism, [contact.name for contact in result], file)
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    in_forces = measurements.levels_at(mechanism) != "per load"
    return tuple(
        ContactUnits(
            place.name, isinstance(place.slip, str) and units.get(place.slip) == "rad", in_forces
        )
        for place in result
    )


def _digest(data: bytes, overrides: Mapping[str, Any]) -> str:
    """Return the SHA-256 of the file; with overrides, of both."""
    digest = hashlib.sha256(data)
    if overrides:
        text = json.dumps({key: str(value) for key, value in overrides.items()}, sort_keys=True)
        digest.update(b"\0" + text.encode())
    return digest.hexdigest()


def _mechanism(table: RigTable, file: RigFile) -> Mechanism:
    built = _build(table.mechanism, "mechanism", file)
    assert isinstance(built, Mechanism)
    return built


def _varied(mechanism: TomlTable) -> tuple[str, ...]:
    """Return the paths of the parameters that are marked to be fitted."""
    if isinstance(mechanism, UrdfTable) and mechanism.links == "unknown":
        return (LINKS,)
    return tuple(path for path, value in _numbers(mechanism, PREFIX) if value.marked)


def _doubts(mechanism: TomlTable) -> dict[str, float]:
    """Return the uncertainties of the mechanism's parameters by path."""
    return {
        path: value.uncertainty
        for path, value in _numbers(mechanism, PREFIX)
        if value.uncertainty is not None
    }


def _numbers(table: TomlTable, key: str) -> Iterator[tuple[str, Given]]:
    """Yield the numbers of a table, and of those below it that may be marked, by path."""
    for name, value in table.given().items():
        if isinstance(value, Given):
            yield f"{key}.{name}", value
        for part in value if isinstance(value, list) else [value]:
            if isinstance(part, TomlTable):  # of several, none may be marked
                yield from _numbers(part, f"{key}.{name}")


def _build(table: TomlTable, key: str, file: RigFile) -> Any:
    """Return the object whose parameters stand in a table, and in the tables below it."""
    if isinstance(table, UrdfTable):
        joints = table.joints.items()
        added = {name: _values(joint, f"{key}.joints", file) for name, joint in joints}
        return robot_of(table, added, file)
    values = _values(table, key, file)
    assert table.target is not None
    if table.target is SampledSwing:
        values = _recorded(values, table.moved, key, file)
    return file.built(table.target, values, key, key)


def _recorded(values: Mapping[str, Any], moved: str, key: str, file: RigFile) -> dict[str, Any]:
    """Return the values of a recorded motion, its samples from a data file where it names one."""
    from stickslip.data.readers.table_reader import read_frame

    result = {name: value for name, value in values.items() if name not in SWING_FILE}
    samples = [name for name in SampledSwing.data_fields if name in result]
    given = {name: values.get(name, "") for name in SWING_FILE}
    if bool(given["file"]) is bool(samples):
        got = joined([*samples, *filter(given.get, SWING_FILE)]) or "neither"
        raise InputError(
            f"{file}: {key} must have either file, the data file of the recorded motion, or times"
            f" and positions, got {got}."
        )
    if samples:
        return result
    columns = {"position": given["column"]} if given["column"] else {}
    units = {"position": given["unit"]} if given["unit"] else {}
    with file.concerning(key):
        frame = read_frame(file.beside(given["file"]), columns=columns, units=units)
        for name in ("time", "position"):
            if name not in frame.names:
                cure = "name its column as column" if name == "position" else "it needs one"
                raise InputError(f"{frame.file}: has no column {name}: {cure}.")
        if frame.units.get("position") is None:
            raise InputError(
                f"{frame.file}: column {frame.names['position']!r} has no unit: add unit ="
                f' "{"deg" if moved == "rad" else "mm"}" or another one.'
            )
        result["times"] = tuple(frame.numbers("time", "s").tolist())
        result["positions"] = tuple(frame.numbers("position", moved or None).tolist())
    return result


def _values(table: TomlTable, key: str, file: RigFile) -> dict[str, Any]:
    """Return what stands in a table by Python name, with the objects of the tables below it."""
    values = {}
    for name, value in table.given().items():
        path = f"{key}.{name}"
        if isinstance(value, ContactTable):
            continue  # of one of several contacts
        if isinstance(value, TomlTable):
            values[name] = _build(value, path, file)
        elif isinstance(value, list):
            made = [_build(part, path, file) for part in value]
            if any(isinstance(part, DCMotor) for part in made):
                values[name] = _alone(made, path, file)
                continue
            drive = all(isinstance(part, Drive) for part in made)
            values[name] = _sum(made) if drive else tuple(made)
        else:
            values[name] = value.value if isinstance(value, Given) else value
    return values


def _alone(made: list[Any], path: str, file: RigFile) -> DCMotor:
    """Return a motor; nothing can be added to it."""
    if len(made) > 1:
        raise InputError(
            f"{file}: {path}: a {DCMotor.name} stands alone: add drives to the command of the"
            " motor, its own drive."
        )
    (motor,) = made
    assert isinstance(motor, DCMotor)
    return motor


def _sum(drives: list[Drive]) -> Drive:
    """Return the sum of several drives, or the only one as it is."""
    return drives[0] if len(drives) == 1 else Sum(parts=tuple(drives))


def _measured(
    table: RigTable, mechanism: Mechanism, reading: Reading, file: RigFile
) -> measurements.Measurement | None:
    """Return what the trials say, or what stands in files; not both."""
    data = table.data
    if data.file and data.files:
        raise InputError(f"{file}: data.file and data.files are both given: leave one out.")
    names = [data.file] if data.file else data.files
    if names and table.trial:
        raise InputError(f"{file}: [data] and [[trial]] both give measurements: leave one out.")
    return _files(names, mechanism, reading, file) or _trials(table, mechanism, reading, file)


def _estimates(
    table: EstimatesTable | None,
    known: rig.KnownLaws,
    of_contacts: Mapping[str, rig.KnownLaws | None],
    file: RigFile,
) -> LawEstimates | None:
    """Return how well a law, or laws by contact, are known; of what was overridden nothing is."""
    if table is None:
        return None
    given = table.given()
    for name, ends in table.intervals.items():
        if len(ends) != 2:
            raise ParameterError(
                f"{file}: estimates.intervals.{name} must be a lower and an upper bound, got"
                f" {ends}."
            )
    given["intervals"] = {name: (low, high) for name, (low, high) in table.intervals.items()}
    given["covariance"] = tuple(map(tuple, table.covariance))
    given |= {name: tuple(given[name]) for name in ("not_fitted", "covariance_of") if name in given}
    with file.concerning():
        result = LawEstimates(**given)
        law = rig.estimated_law(result.law, known.laws, of_contacts)
        return result.without(_changed(law, file.overridden)).checked(law)


def _changed(law: FrictionLaw | Laws, overridden: Collection[str]) -> list[str]:
    """Return the parameters of a law, or by contact of laws, that overrides set."""
    if isinstance(law, FrictionLaw):
        return sorted(overridden_fields(type(law), overridden))
    return [
        f"{contact}.{name}"
        for contact, member in law.members
        for name in sorted(
            overridden_fields(type(member), overridden)
            | overridden_fields(type(member), overridden, at=f"friction.{contact}")
        )
    ]


def _reading(table: ReadTable, file: RigFile, key: str = "data") -> Reading:
    """Return how a table says that files are read."""
    offset = {}
    for name, value in table.offset.items():
        try:
            quantity = measurements.quantity_called(name)
        except KeyError:
            raise UnknownNameError(
                f"quantity in {key}.offset of {file}:", name, measurements.QUANTITIES
            ) from None
        turning = (replace(quantity, unit=quantity.or_unit),) if quantity.or_unit else ()
        with concerning(f"{file}: {key}.offset.{name}"):
            result = Number(quantity, alternatives=turning).read(value)
        offset[name] = result.value if isinstance(result, Given) else result
    try:
        columns = {name: column_of(name, given) for name, given in table.columns.items()}
        constants = {} if table.motor_constant is None else motor_constants(table.motor_constant)
        layout = None if table.layout is None else Layout(**table.layout.given())
    except InputError as error:
        raise ParameterError(f"{file}: {key}.{error}") from None
    return Reading(
        motor_constant=constants,
        layout=layout,
        columns=columns,
        units=table.units,
        gain=table.gain,
        offset=offset,
        repair=tuple(table.repair),
        by="rig",
    )


def _paths(table: RigTable, file: RigFile) -> list[Path]:
    """Return the files that a rig file names, which lie beside it."""
    data = table.data
    own = table.mechanism.file if isinstance(table.mechanism, UrdfTable) else ""
    swings = (node.file for node in _tables(table.mechanism) if node.target is SampledSwing)
    measured = (data.file, *data.files, *(trial.file for trial in table.trial), data.second)
    paths = [file.beside(name) for name in (own, *swings) if name]
    logs = [file.beside(name) for name in measured if name]
    if logs:  # imported here so that rigs without data do without pandas
        from stickslip.data.readers.table_reader import log_files

        paths += [log_file for log in logs for log_file in log_files(log)]
    return paths


def _tables(table: TomlTable) -> Iterator[Any]:
    """Yield a table and those below it."""
    yield table
    for value in table.given().values():
        for part in value if isinstance(value, list) else [value]:
            if isinstance(part, TomlTable):
                yield from _tables(part)


def _files(
    names: list[str], mechanism: Mechanism, reading: Reading, file: RigFile
) -> measurements.Measurement | None:
    """Return the measurement of files that are named as they stand beside the rig file."""
    paths = [file.beside(name) for name in names if name]
    if not paths:
        return None
    with concerning(f"{file}: [data]:", InputError):
        return read_data(paths, reading, mechanism=mechanism)


def _trials(
    table: RigTable, mechanism: Mechanism, reading: Reading, file: RigFile
) -> measurements.Measurement | None:
    """Return the trials; files are read as `[data]` and then the trial itself say."""
    if not table.trial:
        return None
    records: list[measurements.Measurement] = []
    for index, trial in enumerate(table.trial):
        if trial.file:
            records += _filed(trial, mechanism, reading, file, index)
        else:
            records.append(_record(trial, mechanism, file, index, table.run.t_end))
    if len(records) == 1:
        return records[0]
    with concerning(f"{file}: trial:", InputError):
        return measurements.Measurement(trials=tuple(records), name=table.title)


TRAVEL_ONLY = (*measurements.TRAVELS, "uncertainty", "uncertainty_kind", "provenance")
"""Keys of a trial that the file of a record has no use for."""
FILE_ONLY = ("columns", "units", "gain", "offset", "repair")


def _filed(
    trial: TrialTable, mechanism: Mechanism, reading: Reading, file: RigFile, index: int
) -> tuple[measurements.Measurement, ...]:
    """Return what stands in the file of a trial, with the settings of that trial."""
    key = f"trial.{index}"
    label, given = f"{file}: {key}", trial.given()
    _check_keys(given, TRAVEL_ONLY, f"{label}: {{}} applies to a travel, but file names a record")
    own = reading.with_changes(_reading(trial, file, key))
    settings, doubts = _overrides(trial.set, mechanism, f"{label}.set")
    initial = _initial(trial.initial, mechanism, f"{label}.initial")
    with concerning(f"{label}:", InputError):
        result = read_data(
            [file.beside(trial.file)],
            own,
            overrides=settings,
            initial=initial,
            name=trial.name,
            mechanism=mechanism,
        )
    for record in result.records():
        rig.check_record(mechanism, record, label)
    return tuple(
        replace(
            record,
            conditions={**record.conditions, **trial.conditions},
            parameter_uncertainties=doubts,
        )
        for record in result.records()
    )


def _check_keys(given: Mapping[str, Any], refused: tuple[str, ...], said: str) -> None:
    for name in refused:
        if name in given:
            raise InputError(f"{said.format(name)}: leave one of them out.")


def _record(
    trial: TrialTable, mechanism: Mechanism, file: RigFile, index: int, t_end: float
) -> measurements.Measurement:
    label, given = f"{file}: trial.{index}", trial.given()
    names = [name for name in measurements.TRAVELS if name in given]
    if not names:
        raise ParameterError(
            f"{label} contains no measurement. Add travel under [[trial]] number {index + 1}, a"
            ' distance such as "72 mm", or mean_velocity, travel_per_cycle, or file (a record).'
        )
    if len(names) > 1:
        raise InputError(
            f"{label}: {names[0]} and {names[1]} both give the distance travelled: give only one"
            f" of {', '.join(measurements.TRAVELS)}."
        )
    _check_keys(
        given,
        FILE_ONLY,
        f"{label}: {{}} applies to the file of a record, but {names[0]} is a number",
    )
    if "uncertainty" in given:
        measured = measurements.QUANTITIES[names[0]]
        quantity = Quantity(f"u_{measured.symbol}", measured.unit, above=0)
        with concerning(f"{label}.uncertainty"):
            given["uncertainty"] = read_number(given["uncertainty"], quantity)
    overrides, initial = given.pop("set", {}), given.pop("initial", {})
    if "uncertainty_kind" in given and "uncertainty" not in given:
        raise ParameterError(
            f"{label}.uncertainty is missing, but uncertainty_kind is given. Add"
            " the uncertainty, or leave its kind out."
        )
    settings, doubts = _overrides(overrides, mechanism, f"{label}.set")
    record = measurements.Measurement(
        **given,
        overrides=settings,
        parameter_uncertainties=doubts,
        initial=_initial(initial, mechanism, f"{label}.initial"),
    )
    rig.check_record(mechanism, record, label)
    scale_of(mechanism, record, t_end, label)
    return record


def _overrides(
    given: Mapping[str, Any], mechanism: Mechanism, label: str
) -> tuple[dict[str, float], dict[str, float]]:
    """Return what a trial sets, by path, and the uncertainties of that."""
    result: dict[str, float] = {}
    doubts: dict[str, float] = {}
    for name, value in flat(given):
        try:
            path = canonical_path(mechanism, name)
            number = Number(quantity_at(mechanism, path), measured=True).read(value)
        except UnknownNameError as error:
            raise InputError(f"{label}: {error}") from None
        except ParameterError as error:
            raise ParameterError(f"{label}: {name} {error}") from None
        if path in result:
            raise InputError(f"{label}: {path} is given twice.")
        assert isinstance(number, Given)
        result[path] = number.value
        if number.uncertainty is not None:
            doubts[path] = number.uncertainty
    return result, doubts


def _initial(given: Mapping[str, Any], mechanism: Mechanism, label: str) -> dict[str, float]:
    units = rig.state_units(mechanism)
    result = {}
    for name, value in given.items():
        if name not in units:
            raise UnknownNameError(f"state in {label}:", name, units)
        with concerning(f"{label}: {name}"):
            result[name] = read_number(value, Quantity(name, units[name]))
    return result


# Reads rig files; the libraries for it are imported only when one is read.


def load_rig(
    path: str | Path | None = None,
    *,
    overrides: Mapping[str, str | float | bool] | None = None,
    allow_import: bool = False,
) -> rig.Rig:
    """Read a rig file.

    Parameters
    ----------
    path : str or Path, optional
        A TOML file; the rig of the source paper, which comes with the package, if not given.
    overrides : mapping, optional
        Values by dotted path, as on the command line: ``{"run.t_end": "5 s"}``. A shared value
        under ``friction`` does not replace one in a law's own table.
    allow_import : bool
        Whether a file may name a mechanism or a law by import path (``type = "module:Class"``),
        which runs the code of that module. Allow it for files you trust only.

    Returns
    -------
    Rig
        With everything in SI.

    Raises
    ------
    InputError
        If the file cannot be read or used; one message with file, key, range, unit and cure.

    Examples
    --------
    >>> rig = load_rig(overrides={"mechanism.compression": "60 mm"})
    >>> rig.mechanism.compression, sorted(rig.laws)[:3]
    (0.06, ['coulomb', 'coulomb-viscous', 'coulomb-viscous-static'])
    """
    given: Any = {} if overrides is None else overrides
    if not isinstance(given, Mapping):
        raise InputError(f"overrides must be a mapping by dotted path, got {given!r}.")
    for key, value in given.items():
        if not isinstance(value, str | bool | numbers.Real):
            raise InputError(f"override {key!r}: must be text, a number or a bool, got {value!r}.")
    return read_rig(path, given, allow_import=allow_import)


def rig_schema() -> dict[str, Any]:
    """Return the JSON schema of rig files: tables, types, units and ranges.

    Examples
    --------
    >>> sorted(rig_schema()["properties"])[:3]
    ['contact', 'data', 'estimates']
    """
    schema = rig_table(laws=tuple(laws().values())).model_json_schema(by_alias=True)
    # contacts depend on the mechanism: what is no key of [friction] may be the name of one
    friction = schema["$defs"]["Friction"]
    text = "name or composition of a law, such as dahl(level + lorentz) + power"
    friction["properties"]["law"] = {"type": "string", "description": text}
    friction["additionalProperties"] = {"anyOf": [{"$ref": "#/$defs/Friction"}, {"const": NONE}]}
    contact = schema["$defs"]["Contact"]
    contact["additionalProperties"] = {"$ref": "#/$defs/Contact"}
    _drop_nulls(schema)
    dialect = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return {**dialect, **schema, "title": "stickslip rig file"}
