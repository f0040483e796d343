"""The schema of rig files."""

import dataclasses
import functools
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, TypeVar

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    WithJsonSchema,
    create_model,
)
from pydantic_core import PydanticCustomError

from stickslip.data.measurement import BESIDE, BY_JOINT, QUANTITIES
from stickslip.data.readers.columns import MOTORS
from stickslip.data.rigs import rig_models
from stickslip.data.rigs.laws import (
    NONE,
    ContactUnits,
    FrictionTable,
    friction_table,
    python_name,
)
from stickslip.data.units import read_gain
from stickslip.friction import FrictionLaw
from stickslip.friction import laws as known_laws
from stickslip.mechanisms import Mechanism, mechanisms
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.quantities import Quantity

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


class RunTable(rig_models.Table):
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
    found: dict[Any, Any] = {}
    for key, value in table.items():
        joints = key in (*BY_JOINT, *BESIDE, *MOTORS) and isinstance(value, dict)
        found |= {f"{key}.{joint}": own for joint, own in value.items()} if joints else {key: value}
    return found


J = TypeVar("J")
ByJoint = Annotated[dict[str, J], BeforeValidator(_by_joint)]


class LayoutTable(rig_models.Table):
    """How a text file holds its table; `stickslip init` finds it out."""

    encoding: str = "utf-8-sig"
    """Code page, such as cp1252."""
    separator: Literal[",", ";", "\t", "|", " "] = ","
    """Mark between cells."""
    decimal: Literal[".", ","] = "."
    """Decimal mark."""
    thousands: str = ""
    """Mark between thousands; none if empty."""
    preface: int = 0
    """Lines above the header, comments and empty lines included."""
    units_row: bool = False
    """Whether the row below the header holds the units."""


class ReadTable(rig_models.Table):
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
    repair: list[Literal["sort", "gaps"]] = Field(
        default=[], min_length=1, description="`sort` the rows by time, drop rows with `gaps`"
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
    if name not in known_laws():
        known = {"kind": "friction law", "key": name, "known": list(known_laws())}
        raise PydanticCustomError("unknown_name", "", known)
    return name


class PublishedTable(rig_models.Table):
    """What a publication reports for one law."""

    law: Annotated[str, AfterValidator(_known_law)] = Field(
        json_schema_extra=lambda schema: schema.update(enum=list(known_laws()))
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


class EstimatesTable(rig_models.Table):
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


class ContactTable(rig_models.Table):
    """What friction laws may ask of the contact, and the mechanism does not tell."""


@functools.cache
def contact_table(contacts: tuple[str, ...] = ()) -> type[ContactTable]:
    """Return the table of the contact with its inputs, and a table of each of several contacts."""
    fields: dict[str, Any] = {
        name: (_contact_input(name), Field(default=None, description=known.meaning))
        for name, known in CONTACT_INPUTS.items()
    }
    found = create_model("Contact", __base__=ContactTable, **fields)
    if len(contacts) < 2:
        return found
    own: dict[str, Any] = {
        python_name(name, "contact"): (found | None, Field(default=None, alias=name))
        for name in contacts
        if name not in CONTACT_INPUTS
    }
    return create_model("Contacts", __base__=found, **own)


class RigTable(rig_models.Table):
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


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of rig files."""
    schema = rig_table(laws=tuple(known_laws().values())).model_json_schema(by_alias=True)
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
