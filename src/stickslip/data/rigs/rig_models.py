"""The tables of a rig file as pydantic models, and what they refuse in the words of the file.

Mechanisms, drives and laws are read from their declared quantities, so a new one can be written in
files, and stands in the schema, without a line here. Robots have a description in URDF, and what
the file adds to its joints.
"""

import contextlib
import dataclasses
import functools
import math
import re
import types
import typing
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, TypeVar, Union

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    ValidationError,
    WithJsonSchema,
    create_model,
    model_validator,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from stickslip import mechanisms
from stickslip.data.readers.toml import paths_of
from stickslip.data.units import check_uncertainty, read_number
from stickslip.errors import InputError, ParameterError, UnknownNameError, concerning, nearest
from stickslip.mechanisms.drives import DRIVES, PROFILES, Drive, Profile, SampledSwing
from stickslip.quantities import Parametrised, Quantity, fields_of
from stickslip.units import LONGEST_TEXT, shown, split_number

T = TypeVar("T")


@dataclasses.dataclass(frozen=True)
class RigFile:
    """A rig file as messages call it, with what overrides set of it."""

    name: str
    """The file."""
    overridden: Collection[str] = ()
    """Paths that overrides set."""
    called: Mapping[str, str] = dataclasses.field(default_factory=dict)
    """What the file calls the tables of laws, by their paths."""

    def __str__(self) -> str:
        return self.name

    def beside(self, name: str) -> Path:
        """Return a file that is named relative to this one."""
        return Path(self.name).parent / name

    def place(self, key: str) -> str:
        """Return where a key was given: the file, or an override of it."""
        own = any(key == path or key.startswith(path + ".") for path in self.overridden)
        return f"override of {self}" if own else self.name

    @contextlib.contextmanager
    def concerning(self, key: str = "") -> Iterator[None]:
        """Say of an error that it is about this file, or about a table of it."""
        at = f"{self}: {key}:" if key else f"{self}:"
        try:
            yield
        except UnknownNameError as error:
            raise UnknownNameError(f"{error.kind} in {at}", error.name, error.known) from None
        except InputError as error:
            raise type(error)(f"{at} {error}") from None

    def built(self, kind: Callable[..., T], values: Mapping[str, Any], key: str, root: str) -> T:
        """Return an object of the values of a table; what it refuses is said with its place.

        That is an override where one has set a value below the table `root`.
        """
        touched = [path for path in self.overridden if path.startswith(root + ".")]
        with concerning(f"{self.place(touched[0]) if touched else self}: {key}:"):
            return kind(**values)


ITS_TABLE = "{table}"
"""Stands in messages for the table of a value, as the file calls it."""
UNCERTAINTY = "uncertainty"
"""Key of the standard uncertainty of a number."""
PLUS_MINUS = re.compile(r"\s*(?P<value>\S.*?)\s*(?:\+/?-|±)\s*(?P<doubt>\S.*?)\s*")
"""A number with its standard uncertainty, such as ``0.25 +- 0.01`` or ``100 +- 2 g``."""


@dataclasses.dataclass(frozen=True)
class Given:
    """A number from a file, and whether it bears the mark that it may have there."""

    value: float
    """The number [SI]."""
    marked: bool
    """Whether it bears the mark."""
    uncertainty: float | None = None
    """Its standard uncertainty, in the unit of the number."""


@dataclasses.dataclass(frozen=True)
class Number:
    """Annotation of a field that holds a quantity."""

    quantity: Quantity
    """Symbol, unit and range of the number."""
    mark: str = ""
    """What may be said of it, such as ``"assumed"``: ``{ value = ..., assumed = true }``."""
    alternatives: tuple[Quantity, ...] = ()
    """Other ranges that would do, where several owners share the field."""
    measured: bool = False
    """Whether it may have an uncertainty, ``{ value = ..., uncertainty = "2 %" }`` or
    ``"0.25 +- 0.01"``."""
    elsewhere: tuple[Quantity, str] | None = None
    """What the same is in another unit, and the sentence that says where that stands."""

    def read(self, value: Any) -> float | Given:
        """Return the number in SI, with its mark and its uncertainty where it may have them."""
        keys = (*([self.mark] if self.mark else []), *([UNCERTAINTY] if self.measured else []))
        if not keys:
            return self._number(value)
        marked: object = False
        doubt: object = None
        read = self.measured and isinstance(value, str) and len(value) <= 2 * LONGEST_TEXT
        pair = PLUS_MINUS.fullmatch(value) if read else None
        if pair is not None:
            value = _with_one_unit(pair["value"], pair["doubt"])
        if isinstance(value, dict):
            if "value" not in value or set(value) - {"value", *keys}:
                raise ParameterError(
                    f"({self.quantity.symbol}) as a table must have the keys value and"
                    f" {' or '.join(keys)}, got {', '.join(map(repr, value)) or 'none'}."
                )
            marked, doubt = value.get(self.mark, False), value.get(UNCERTAINTY)
            value = value["value"]
        if not isinstance(marked, bool):
            raise ParameterError(
                f"({self.quantity.symbol}) has {self.mark} = {shown(marked)}: write true or false."
            )
        if marked and doubt is not None:
            why = (
                "fits hold an assumed value and would leave its uncertainty out"
                if self.mark == "assumed"
                else "a fitted parameter has no prior uncertainty"
            )
            raise ParameterError(
                f"({self.quantity.symbol}) has {self.mark} = true and an uncertainty, but {why}."
                " Leave one of them out."
            )
        number = self._number(value)
        return Given(number, marked, None if doubt is None else self._doubt(doubt, number))

    def _doubt(self, given: object, value: float) -> float:
        """Return a standard uncertainty in the unit of the value, of which it may be a share."""
        symbol, unit = f"u_{self.quantity.symbol}", self.quantity.unit
        if isinstance(given, str) and given.rstrip().endswith("%"):
            share = read_number(given, Quantity(symbol))
            if value == 0.0:
                raise ParameterError(
                    f"({symbol}) is {given.strip()} of a value of 0: give an absolute uncertainty"
                    f" in {unit}."
                )
            doubt = share * abs(value)
        else:
            units = (unit, *(alternative.unit for alternative in self.alternatives))
            doubt = Number(
                Quantity(symbol, unit),
                alternatives=tuple(Quantity(symbol, other) for other in units[1:]),
            )._number(given)  # of its own class
        return check_uncertainty(doubt, value, self.quantity, given)

    def _number(self, value: object) -> float:
        try:
            return read_number(value, self.quantity)
        except ParameterError:
            for quantity in self.alternatives:
                with contextlib.suppress(ParameterError):
                    return read_number(value, quantity)
            if self.elsewhere is not None and _reads(value, self.elsewhere[0]):
                symbol, where = self.quantity.symbol, self.elsewhere[1]
                raise ParameterError(
                    f"({symbol}) is over the normal force, got {shown(value)}: {where}."
                ) from None
            raise

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        quantity = self.quantity
        number: dict[str, Any] = {"type": "number"}
        bounds = {"minimum": quantity.low, "maximum": quantity.high}
        number |= {key: bound for key, bound in bounds.items() if math.isfinite(bound)}
        if quantity.above is not None:
            number["exclusiveMinimum"] = quantity.above
        plain = [number, {"type": "string", "description": "number with a unit"}]
        kinds: list[dict[str, Any]] = list(plain)
        members: dict[str, Any] = {"value": {"anyOf": plain}}
        if self.mark:
            members[self.mark] = {"type": "boolean", "default": False}
        if self.measured:
            members[UNCERTAINTY] = {
                "anyOf": [{"type": "number", "exclusiveMinimum": 0}, plain[1]],
                "description": "standard uncertainty, with its unit or in % of the value",
            }
        if len(members) > 1:
            kinds.append(
                {
                    "type": "object",
                    "properties": members,
                    "required": ["value"],
                    "additionalProperties": False,
                }
            )
        text = f"{quantity.symbol} [{quantity.unit}], {quantity.range}"
        return {"anyOf": kinds, "description": text, "x-unit": quantity.unit}


def _reads(value: object, quantity: Quantity) -> bool:
    try:
        read_number(value, quantity)
    except ParameterError:
        return False
    return True


def _with_one_unit(value: str, doubt: str) -> dict[str, str | float]:
    """Return the two numbers of ``100 +- 2 g``; one without a unit has that of the other."""
    texts = {"value": value, UNCERTAINTY: doubt}
    result = {key: split_number(text) for key, text in texts.items()}
    units = {key: hit["unit"] if hit else None for key, hit in result.items()}
    shared = units["value"] or units[UNCERTAINTY]
    if not shared and all(result.values()):
        return {key: float(text) for key, text in texts.items()}  # in SI, as plain numbers are
    if shared and "%" not in shared:
        texts = {
            key: text if units[key] or not result[key] else f"{text} {shared}"
            for key, text in texts.items()
        }
    return {**texts}


class TomlTable(BaseModel):
    """Base of all tables: no key that is not known, none missing that is needed."""

    model_config = ConfigDict(
        extra="forbid",
        strict=True,
        frozen=True,
        protected_namespaces=(),
        arbitrary_types_allowed=True,
    )

    target: ClassVar[type[Parametrised] | None] = None
    """The class whose parameters stand in this table."""
    moved: ClassVar[str] = ""
    """Unit of the coordinate that a recorded motion moves; empty if both will do."""
    misplaced: ClassVar[Mapping[str, str]] = {}
    """Keys one might expect here, and what to do instead, with a place for their value."""

    @model_validator(mode="before")
    @classmethod
    def check_keys(cls, data: Any) -> Any:
        """Refuse unknown keys before missing ones: a misspelt key is both."""
        if not isinstance(data, dict):
            return data
        known = {field.alias or name: field for name, field in cls.model_fields.items()}
        for key in data:
            if key in cls.misplaced:
                cure = cls.misplaced[key].format(data[key])
                raise PydanticCustomError("misplaced", "", {"key": key, "cure": cure})
            if key not in known:
                context = {"key": key, "known": list(known), "value": data[key]}
                raise PydanticCustomError("unknown_key", "", context)
        for key, field in known.items():
            if field.is_required() and key not in data:
                marks = [mark for mark in field.metadata if isinstance(mark, Number)]
                quantity = marks[0].quantity if marks else None
                raise PydanticCustomError("missing_key", "", {"key": key, "quantity": quantity})
        return data

    def given(self) -> dict[str, Any]:
        """Return what stands in the table by Python name, its ``type`` left out."""
        names = self.model_fields_set - {"type"}
        return {name: getattr(self, name) for name in type(self).model_fields if name in names}


class _OrSingle:
    """Says in the schema that a single table stands for a list of one."""

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        several = handler(schema)
        return {"anyOf": [several["items"], several], "description": "a list is a sum"}


def _numbers(value: object) -> tuple[float, ...]:
    if not isinstance(value, list):
        raise ParameterError(f"must be a list of numbers in SI units, got {shown(value)}.")
    for index, item in enumerate(value):
        if isinstance(item, bool) or not isinstance(item, int | float):
            raise ParameterError(
                f"must be a list of numbers in SI units, got {shown(item)} at index {index}."
            )
    return tuple(value)


Numbers = Annotated[
    Any,
    PlainValidator(_numbers),
    WithJsonSchema({"type": "array", "items": {"type": "number"}}),
]
"""A list of plain numbers in SI."""


@functools.cache  # Registries do not change while a program runs.
def table_of(
    cls: type,
    kind: str,
    mark: str = "",
    moved: str = "",
    measured: bool = False,
    alone: bool = False,
    only: tuple[str, ...] = (),
) -> type[TomlTable]:
    """Return the table of a mechanism or drive; `kind` is what its ``type`` must say.

    With a `mark`, that may be said of its own numbers, and where they are `measured` they may have
    an uncertainty. What is `moved`, in m or in rad, decides
    between the units of a motor or a profile; without it both will do.
    """
    fields: dict[str, Any] = {} if only else {"type": (Literal[kind], kind if alone else ...)}
    for field in dataclasses.fields(cls):
        if only and field.name not in only:
            continue
        default = None if only else field.default
        default = ... if default is dataclasses.MISSING else default
        fields[field.name] = (_hint(cls, field.name, mark, moved, measured), default)
    model = create_model(f"{cls.__name__}_{moved}".rstrip("_"), __base__=TomlTable, **fields)
    model.__doc__ = (vars(cls).get("__doc__") or "").strip().partition("\n")[0]
    model.target = cls
    return model


def choice(tables: Mapping[str, type[TomlTable]]) -> Any:
    """Return the type of a table that is one of several, told apart by its key ``type``."""
    options = tuple(tables.values())
    if len(options) == 1:
        return options[0]
    return Annotated[Union[options], Field(discriminator="type")]  # noqa: UP007  # the options are found at run time


def _hint(cls: type[Parametrised], name: str, mark: str, moved: str, measured: bool) -> Any:
    quantity = fields_of(cls).get(name)
    if quantity is not None:
        straight = dataclasses.replace(quantity, unit=quantity.or_unit or quantity.unit)
        if moved:
            of_motion = straight if moved == "m" else quantity
            return Annotated[Any, Number(of_motion, mark=mark, measured=measured)]
        others = (straight,) if quantity.or_unit else ()
        return Annotated[Any, Number(quantity, mark=mark, alternatives=others, measured=measured)]
    hint = typing.get_type_hints(cls, include_extras=True)[name]
    if hint == tuple[float, ...]:
        return Numbers
    if typing.get_origin(hint) is tuple and issubclass(typing.get_args(hint)[0], Parametrised):
        table: Any = _alone(typing.get_args(hint)[0])
        return Annotated[list[table], Field(min_length=1)]
    if Mapping[str, float] in typing.get_args(hint):
        return dict[str, float]
    is_union = typing.get_origin(hint) in (Union, types.UnionType)
    parts: list[type] = [
        part
        for part in (typing.get_args(hint) if is_union else (hint,))
        if isinstance(part, type) and issubclass(part, Parametrised)
    ]
    if Drive in parts:
        motor = mechanisms.DCMotor in parts and table_of(
            mechanisms.DCMotor, mechanisms.DCMotor.name, mark, "", measured
        )
        return drive_tables(motor or None)
    for part in parts:
        if part in MEMBERS:
            inner = moved or _inner_unit(cls)
            members = MEMBERS[part].items()
            marks = (mark, inner, measured) if part is mechanisms.MotorLoop else ("", inner, False)
            tables = {kind: table_of(member, kind, *marks) for kind, member in members}
            return choice({kind: _or_in_file(table, inner) for kind, table in tables.items()})
    if len(parts) == 1:
        return _alone(parts[0])
    if parts:
        return choice({_kebab(part): table_of(part, _kebab(part)) for part in parts})
    return hint


def _or_in_file(table: type[TomlTable], moved: str) -> type[TomlTable]:
    """Return a table in which a file may stand in place of the samples of a motion."""
    if table.target is not SampledSwing:
        return table
    samples = dict.fromkeys(SampledSwing.data_fields, (Numbers, ()))
    of_file = {
        name: (str, Field(default="", description=text))
        for name, text in (
            ("file", "data file with the recorded motion, relative to the rig file"),
            ("column", "name of its column with the position or angle; `position` if empty"),
            ("unit", "unit of that column, where its header has none"),
        )
    }
    fields: dict[str, Any] = {**samples, **of_file}
    model = create_model(table.__name__, __base__=table, **fields)
    model.__doc__, model.target, model.moved = table.__doc__, table.target, moved
    return model


MEMBERS: Mapping[type, Mapping[str, type]] = {
    Profile: PROFILES,
    mechanisms.Motor: mechanisms.MOTORS,
    mechanisms.MotorLoop: mechanisms.LOOPS,
}
"""What parts of mechanisms are chosen from, by their ``type``."""


def _inner_unit(cls: type) -> str:
    """Return the unit of the coordinate that a motor moves: the last of several."""
    units: object = cls.units if issubclass(cls, mechanisms.Mechanism) else ()
    if not isinstance(units, tuple):  # a property: how many there are depends on the object
        return ""
    return str(units[-1]) if len(units) > 1 and units[-1] in {"m", "rad"} else ""


def drive_tables(motor: type[TomlTable] | None = None) -> Any:
    """Return the type of a table of a drive, or of several that are summed, or of a motor."""
    tables = {kind: table_of(drive, kind) for kind, drive in DRIVES.items()}
    drives: Any = choice(tables if motor is None else {**tables, mechanisms.DCMotor.name: motor})
    return Annotated[list[drives], Field(min_length=1), BeforeValidator(_listed), _OrSingle()]


def _listed(value: object) -> object:
    return [value] if isinstance(value, dict) else value


def _alone(part: type) -> type[TomlTable]:
    """Return the table of a part where no other kind could stand."""
    return table_of(part, _kebab(part), alone=True)


def _kebab(cls: type) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", cls.__name__).lower()


# Robots in rig files: a description in URDF and what the file adds to its joints.

URDF = "urdf"
"""``type`` of a mechanism that a robot description gives."""
ADDED = (
    "damping", "armature", "coupling", "effort", "mass", "lower_stop", "upper_stop", "restitution",
)  # fmt: skip
"""What a rig file may say of a joint beside its description."""
ANGLE, DISTANCE = Quantity("q", "rad"), Quantity("q", "m")
Added = table_of(mechanisms.RobotJoint, "joint", only=ADDED)


class UrdfTable(TomlTable):
    """A robot from a description in URDF."""

    type: Literal["urdf"]
    """Kind of the mechanism."""
    file: str = Field(description="robot description (URDF), relative to the rig file")
    moving: list[str] = Field(
        default=[], min_length=1, description="joints that move; the others are locked at 0"
    )
    locked: dict[str, Annotated[Any, Number(ANGLE, alternatives=(DISTANCE,))]] = Field(
        default={}, description="joint that is locked: where, an angle or a distance"
    )
    gravity: Annotated[Any, Number(fields_of(mechanisms.Robot)["gravity"])] = 9.81
    """Acceleration of free fall [m/s^2]."""
    joints: dict[str, Added] = Field(  # type: ignore[valid-type]  # made at run time
        default={},
        description="joint: damping, armature, mass, coupling, effort or stops of its own",
    )
    links: Literal["known", "unknown"] = Field(
        default="known",
        description="unknown: fits find what motion tells of masses and inertias of the links",
    )


def _described(table: UrdfTable, file: RigFile) -> mechanisms.RobotDescription:
    """Read the description that a table names."""
    gravity = table.gravity.value if isinstance(table.gravity, Given) else table.gravity
    path, moving = file.beside(table.file), table.moving or None
    with file.concerning("mechanism"):
        return mechanisms.read_urdf(path, joints=moving, locked=table.locked, gravity=gravity)


def robot_of(
    table: UrdfTable, added: Mapping[str, Mapping[str, Any]], file: RigFile
) -> mechanisms.Robot:
    """Return the robot of a table."""
    described = _described(table, file)
    for remark in described.remarks:
        warnings.warn(f"{file}: {remark}", stacklevel=2)
    robot = described.robot
    known = [joint.joint for joint in robot.joints]
    for name in added:
        if name not in known:
            raise UnknownNameError(f"moving joint in mechanism.joints of {file}:", name, known)
    with concerning(f"{file}: mechanism.joints:"):
        joints = tuple(_with(joint, added.get(joint.joint, {})) for joint in robot.joints)
        return replace(robot, joints=joints)


def _with(joint: mechanisms.RobotJoint, added: Mapping[str, Any]) -> mechanisms.RobotJoint:
    """Return a joint with what a rig file adds; limits are of its angle, not of a motor's."""
    if added.get("coupling"):
        joint = replace(joint, lower_stop=None, upper_stop=None)
    return replace(joint, **added)


def fill_friction(
    raw: dict[str, Any], table: UrdfTable, contacts: Collection[str], file: RigFile
) -> None:
    """Put the friction levels of a description in where a rig file gives nothing else."""
    friction = raw.setdefault("friction", {})
    if not isinstance(friction, dict) or not set(friction) <= set(contacts):
        return  # one law for all contacts, or what is refused elsewhere
    for name, level in _described(table, file).levels.items():
        own = {"coulomb": {"kinetic_coefficient": level}}
        if len(contacts) > 1:
            friction.setdefault(name, own)
        elif not friction:
            friction.update(own)


# Turns what pydantic finds into one message in the words of the file.

_WANTED = {
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "dict_type": "must be a table",
    "list_type": "must be a list of tables",
    "string_type": "must be text in quotes",
    "bool_type": "must be true or false",
    "too_short": "must not be an empty list: leave it out or fill it",
}


def complaint(error: ValidationError, raw: Mapping[str, Any], file: RigFile) -> InputError:
    """Return the error to raise: the first that was found, unknown keys before all others."""
    result = error.errors(include_url=False)
    result.sort(key=lambda fault: fault["type"] not in {"unknown_key", "misplaced"})
    first: Mapping[str, Any] = result[0]
    key, value = _as_called(_key(first["loc"], raw), file.called), first["input"]
    overridden = [_as_called(path, file.called) for path in file.overridden]
    file = replace(file, overridden=overridden)
    context = first.get("ctx", {})
    kind = first["type"]
    where = file.place(key)
    if kind == "unknown_key":
        full = _join(key, context["key"])
        # An override may have made a whole table that is not known.
        made = any(path.startswith(full + ".") for path in overridden)
        where = replace(file, overridden=[*overridden, *([full] if made else [])]).place(full)
        table = f" in {_heading(key)}" if key else ""
        known = context["known"]
        of_law = key.partition(".")[0] == "friction" and isinstance(context["value"], dict)
        if of_law and not nearest(context["key"], known):
            return InputError(
                f"{where}: [{full}] has the name of no law or contact: add law = "
                f'"level + viscous", or another one, under [{full}].'
            )
        if not key and context["key"] in overridden:  # the end of a path, perhaps
            ends = {path.rpartition(".")[2] for path in paths_of(raw)} - {context["key"]}
            known = ends if nearest(context["key"], ends) else known
        return UnknownNameError(f"key{table} of {where}:", context["key"], known)
    if kind == "unknown_name":
        owner = f"{context['kind']} in {key} of {where}:"
        return UnknownNameError(owner, context["key"], context["known"])
    if kind == "union_tag_invalid":
        known = [tag.strip(" '") for tag in context["expected_tags"].split(",")]
        return UnknownNameError(f"{key}.type in {where}:", context["tag"], known)
    if kind == "union_tag_not_found":
        return ParameterError(f'{where}: {key}.type is missing. Add type = "..." under [{key}].')
    if kind == "missing_key":
        return ParameterError(_missing(where, key, context))
    if kind == "misplaced":
        return ParameterError(f"{where}: {_join(key, context['key'])}: {context['cure']}.")
    if kind == "value_error":
        text = str(context["error"]).replace(ITS_TABLE, key.rpartition(".")[0])
        return ParameterError(f"{where}: {key} {text}")
    wanted = _WANTED.get(kind)
    if kind == "literal_error":
        wanted = f"must be {context['expected']}"
    if wanted is None:
        wanted = first["msg"]
    return ParameterError(f"{where}: {key or 'the file'} {wanted}, got {shown(value)}.")


def _as_called(key: str, called: Mapping[str, str]) -> str:
    """Return a key with the name that the file gives its table."""
    own = next((path for path in called if f"{key}.".startswith(f"{path}.")), None)
    return key if own is None else called[own] + key.removeprefix(own)


def _missing(where: str, key: str, context: Mapping[str, Any]) -> str:
    name, quantity = context["key"], context["quantity"]
    under = f"under {_heading(key)}" if key else "at the top of the file"
    full = _join(key, name)
    if quantity is None:
        table = name in {"mechanism", "run", "friction"}
        return f"{where}: {full} is missing. Add {f'[{name}]' if table else f'{name} {under}'}."
    return f"{where}: {full} ({quantity.symbol}) is missing. Add {name} {under}, {quantity.range}."


def _heading(key: str) -> str:
    """Return how a table is written in the file; entries of a list are counted from 1."""
    table, _, last = key.rpartition(".")
    return f"[[{table}]] number {int(last) + 1}" if last.isdecimal() else f"[{key}]"


def _join(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name


def _has(node: Any, step: int | str) -> bool:
    if isinstance(node, list):
        return isinstance(step, int) and step < len(node)
    return isinstance(node, dict) and step in node


def _key(loc: tuple[int | str, ...], raw: Any) -> str:
    """Return the dotted key in the file; pydantic adds type names and indices of its own."""
    parts: list[str] = []
    node = raw
    for step in loc:
        if _has(node, step):
            node = node[step]
        elif " " in str(step) or (  # which of several kinds, in words
            isinstance(node, dict) and (isinstance(step, int) or node.get("type") == step)
        ):
            continue
        parts.append(str(step))
    return ".".join(parts)
