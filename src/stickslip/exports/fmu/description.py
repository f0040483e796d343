"""The model description of an FMU: its inputs, its variables, and the XML of FMI 2.0 and 3.0."""

import dataclasses
import math
import re
import typing
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from types import MappingProxyType
from typing import Any, Final, Literal, NamedTuple, TypeAlias
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from stickslip import mechanisms
from stickslip.data import unit_of_input, unit_on
from stickslip.engine.formulation import Model
from stickslip.engine.kernels import state_layout
from stickslip.engine.solver import column_units, path_units
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import Friction, FrictionLaw, Laws, PrintedForm, assigned, law_of
from stickslip.mechanisms.drives import Drive, Piece, Profile, Sampled, Straight, parts_of
from stickslip.quantities import Parametrised, Quantity, parameters, shadow

# A mechanism of which some drives are inputs.


@dataclass(frozen=True, kw_only=True)
class Held(Straight):
    """A drive whose value is told from outside while the run goes on; 0 until then."""

    def pieces(self, until: float = 0.0) -> tuple[Piece, ...]:
        return ()


class Input(NamedTuple):
    """A drive that is told from outside."""

    drive: str
    """Name under which the mechanism's `drives` list it."""
    start: float
    """Value at time 0 of the drive that was there before, 0 if there was none."""


def told_from_outside(
    mechanism: mechanisms.Mechanism, law: Friction | PrintedForm, names: Sequence[str]
) -> tuple[mechanisms.Mechanism, tuple[str, ...]]:
    """Return a mechanism whose contact inputs that are told from outside are drives."""
    found = list(names)
    for contact, name in _from_outside(mechanism, law, names):
        field = mechanisms.input_field(contact, name)
        before = getattr(mechanism, field, 0.0)
        start = before.value(0.0) if isinstance(before, Drive) else float(before)
        held = {name: Sampled(times=(0.0,), values=(start,))}
        mechanism = mechanisms.given_inputs(mechanism, {contact: held} if contact else held)
        found = [*(key for key in found if key != label_of(contact, name)), field]
    return mechanism, tuple(found)


def label_of(contact: str, name: str) -> str:
    """Return what a contact input is called as a variable."""
    return f"{contact}.{name}" if contact else name


def _from_outside(
    mechanism: mechanisms.Mechanism, law: Friction | PrintedForm, names: Sequence[str]
) -> Iterator[tuple[str, str]]:
    """Yield contact and name of what is asked for, or what laws need and nothing tells."""
    if isinstance(law, PrintedForm) or not isinstance(mechanism, mechanisms.Mechanism):
        return  # refused where it is checked with what it is given for
    contacts = tuple(place.name for place in mechanism.contacts())
    laws = assigned(contacts, law)
    inputs: dict[str, list[str]] = {}
    for contact in contacts:
        friction = law_of(contact, laws)
        for name in () if friction is None else friction.inputs:
            inputs.setdefault(name, []).append(contact)
    for name, those in inputs.items():
        untold = [key for key in those if name not in mechanisms.input_names(mechanism, key)]
        apart = [key for key in those if len(contacts) > 1 and label_of(key, name) in names]
        for contact in (*([""] if untold or name in names else []), *apart):
            if not any(
                name in mechanisms.given_names(mechanism, key) or key in untold
                for key in ([contact] if contact else those)
            ):
                raise InputError(
                    f"the contact input {label_of(contact, name)!r} follows from the motion and the"
                    f" drives of {mechanism.title}: leave it out of inputs."
                )
            yield contact, name


def with_inputs(
    mechanism: mechanisms.Mechanism, names: Sequence[str]
) -> tuple[mechanisms.Mechanism, dict[str, Input]]:
    """Return a mechanism whose drives of some names are told from outside."""
    found: dict[str, Input] = {}
    for given in names:
        mechanism, input_ = _with_input(mechanism, given)
        if given in found or input_.drive in (other.drive for other in found.values()):
            raise InputError(f"the input {given!r} is named twice.")
        found[given] = input_
    return mechanism, found


def _with_input(mechanism: mechanisms.Mechanism, given: str) -> tuple[mechanisms.Mechanism, Input]:
    """Return a mechanism of which one more drive is told."""
    known = []
    for path, before, held, driven in _places(mechanism):
        names = [name for name, drive in driven.drives().items() if drive is held]
        if names and given in (path, *names):
            start = 0.0 if before is None else float(before.value(0.0))
            return driven, Input(names[0], start)
        known += names
    if given in mechanism.drives():
        raise InputError(
            f"the drive {given!r} of {mechanism.title} is a prescribed motion, which cannot be"
            " held over a step as an input: give the mechanism a force or torque instead."
        )
    raise UnknownNameError("drive", given, known)


def _places(root: Any) -> Iterator[tuple[str, Drive | None, Held, Any]]:
    """Yield the path of each place of a force, the drive there, one that is told, a copy with it.

    Places of prescribed motions are left out: what is held jumps.
    """
    if isinstance(root, tuple):
        for index, item in enumerate(root):
            for path, before, held, copy in _places(item):
                yield f"{index}.{path}", before, held, (*root[:index], copy, *root[index + 1 :])
    if not isinstance(root, Parametrised):
        return
    hints = typing.get_type_hints(type(root))
    for member in dataclasses.fields(root):
        own = getattr(root, member.name)
        is_free = own is None and Drive in typing.get_args(hints[member.name])
        if is_free or (isinstance(own, Drive) and not isinstance(own, Profile)):
            held = Held()
            yield member.name, own, held, dataclasses.replace(root, **{member.name: held})
        elif isinstance(own, Parametrised | tuple):
            for path, before, held, copy in _places(own):
                changed = dataclasses.replace(root, **{member.name: copy})
                yield f"{member.name}.{path}", before, held, changed


# The variables of an FMU: time, inputs, parameters, states and what a run records.

BASES: Final = ("kg", "m", "s", "A", "K", "rad")
ZEROS: Final = {"degC": "273.15"}
"""Zeros of units that do not count from that of their base units."""
_NAMED: Final[Mapping[str, Mapping[str, int]]] = MappingProxyType(
    {
        **{base: {base: 1} for base in BASES},
        "N": {"kg": 1, "m": 1, "s": -2},
        "Pa": {"kg": 1, "m": -1, "s": -2},
        "J": {"kg": 1, "m": 2, "s": -2},
        "W": {"kg": 1, "m": 2, "s": -3},
        "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
        "Hz": {"s": -1},
        "degC": {"K": 1},
        "1": {},
    }
)
_FACTOR: Final = re.compile(r"(?P<name>[A-Za-z]+|1)(?:\^(?P<power>\d+))?")
Role: TypeAlias = Literal[
    "independent",
    "input",
    "parameter",
    "constant",
    "state",
    "column",
    "contact_mode",
    "event_count",
    "derivative",
    "indicator",
]
MODE = "{}: 0 stick, 1 and -1 slip, 2 and -2 at a hard stop, 3 without load"
SHIFT = 1.01
"""Factor by which a parameter is moved to see what depends on it."""


def base_units(unit: str) -> dict[str, int]:
    """Return the powers of the base units of an SI unit.

    Examples
    --------
    >>> base_units("N m s/rad")
    {'kg': 1, 'm': 2, 's': -1, 'rad': -1}
    """
    found = dict.fromkeys(BASES, 0)
    for name, power in _factors(unit).items():
        for base, own in _NAMED[name].items():
            found[base] += power * own
    return {base: power for base, power in found.items() if power}


def per_second(unit: str) -> str:
    """Return the unit of a time derivative.

    Examples
    --------
    >>> per_second("m"), per_second("rad/s"), per_second("N m/rad"), per_second("N m s/rad")
    ('m/s', 'rad/s^2', 'N m/(rad s)', 'N m/rad')
    """
    if not unit:
        return ""
    powers = _factors(unit)
    powers["s"] = powers.get("s", 0) - 1
    above, below = (
        [
            name if abs(power) == 1 else f"{name}^{abs(power)}"
            for name, power in powers.items()
            if power * side > 0 and name != "1"
        ]
        for side in (1, -1)
    )
    divisors = f"({' '.join(below)})" if len(below) > 1 else "".join(below)
    return "/".join(filter(None, (" ".join(above) or "1", divisors)))


def _factors(unit: str) -> dict[str, int]:
    """Return the powers of the units that stand in a unit, in their order."""
    found: dict[str, int] = {}
    above, *below = unit.split("/")
    sides = [(above, 1), *((key.removeprefix("(").removesuffix(")"), -1) for key in below)]
    for side, sign in sides:
        for factor in side.split():
            parsed = _FACTOR.fullmatch(factor)
            if parsed is None or parsed["name"] not in _NAMED:
                raise InputError(
                    f"the unit {unit!r} has {factor!r}, which is no SI unit known here."
                )
            name = parsed["name"]
            found[name] = found.get(name, 0) + sign * int(parsed["power"] or 1)
    return found


@dataclass(frozen=True, kw_only=True)
class Variable:
    """A variable of an FMU; its value reference is its place in the list."""

    name: str
    """Name, flat: as columns and parameters are called."""
    role: Role
    """What it is to the engine."""
    index: int = 0
    """Place of the input in a row of the drives' table, place of the parameter in the vector of a
    run, or index of the state, of the column, or of the guard."""
    start: float = 0.0
    """Value before the simulation [SI]."""
    unit: str = ""
    """SI unit; empty where it is not known, ``"1"`` for a pure number."""
    description: str = ""
    """What it is, in words."""
    quantity: Quantity = field(default_factory=lambda: Quantity(""))
    """Allowed range."""
    at_least: int = -1
    """Reference of a variable that it must not fall below; -1 if there is none."""
    tunable: bool = False
    """Whether it may be set while a simulation runs."""
    nominal: float | None = None
    """Size that a state has; None of what is no state."""
    state: int | None = None
    """Reference of the state of which it is the derivative."""
    depends_on: tuple[int, ...] | None = None
    """References of all states and inputs that it depends on; None where they are not known."""

    @property
    def whole(self) -> bool:
        """Whether it is a whole number."""
        return self.role in ("contact_mode", "event_count") or (
            self.role == "column" and self.name.partition(":")[0] == "mode"
        )


def variables_of(
    mechanism: mechanisms.Mechanism,
    law: FrictionLaw | Laws,
    model: Model,
    *,
    y0: Sequence[float],
    nominals: Sequence[float],
    inputs: Mapping[str, Input],
) -> tuple[Variable, ...]:
    """Return the variables of an FMU."""
    found = [Variable(name="time", role="independent", unit="s", description="Time")]
    for name, (drive, start) in inputs.items():
        found.append(
            Variable(
                name=name,
                role="input",
                index=1 + 3 * model.drives.index(drive),
                start=start,
                unit=_drive_unit(mechanism, drive),
                description=f"{_called(mechanism, drive)}, held over each communication step",
            )
        )
    units: dict[str, str] = column_units(
        mechanism, [*model.states[2 * len(mechanism.coordinates) :], *model.columns]
    )
    found += _parameters(mechanism, law, model, len(found))
    first_state = len(found)
    inputs_of = [i for i, variable in enumerate(found) if variable.role == "input"]
    # Forces may depend on all states and inputs.
    every = (*inputs_of, *range(first_state, first_state + len(model.states)))
    for index, (state, value) in enumerate(zip(model.states, y0, strict=True)):
        found.append(
            Variable(
                name=state,
                role="state",
                index=index,
                start=float(value),
                nominal=nominals[index],
                unit=units[state],
                description=_state_words(mechanism, state),
                depends_on=(first_state + index,),
            )
        )
    for index, column in enumerate(model.columns):
        kind, _, contact = column.partition(":")
        where = f" at the contact {contact}" if contact else ""
        words = {
            "friction": f"Friction{where}, against its slip",
            "normal_force": f"Normal force{where}",
            "mode": MODE.format(f"Mode{where}"),
        }
        found.append(
            Variable(
                name=column,
                role="column",
                index=index,
                unit=units[column],
                description=words.get(kind, f"Effort of the guided coordinate: {column}"),
                depends_on=None if kind == "mode" else every,
            )
        )
    if not model.contacts:
        found.append(
            Variable(name="mode", role="contact_mode", unit="1", description=MODE.format("Mode"))
        )
    what = "Events so far: changes of mode and impacts"
    found.append(Variable(name="event_count", role="event_count", unit="1", description=what))
    n = len(mechanism.coordinates)
    # rates of slips that are sums are set to 0 where they are held, and so change those of all;
    # in a loop, one rate follows from others
    header = model.sizes.header
    loops = header[state_layout.N_DIRECTIONS] > header[state_layout.N_COORDINATES]
    direct = 0 if header[state_layout.IS_TURNED] or loops else n
    for index, state in enumerate(model.states):
        found.append(
            Variable(
                name=f"der({state})",
                role="derivative",
                index=index,
                state=first_state + index,
                unit=per_second(units[state]),
                description=f"Time derivative of {state}",
                depends_on=(first_state + n + index,) if index < direct else every,
            )
        )
    guards = list(_guards(mechanism, model))
    assert len(guards) == model.sizes.guards
    for index, (name, meaning) in enumerate(guards):
        found.append(
            Variable(
                name=f"indicator.{name}",
                role="indicator",
                index=index,
                description=f"Event indicator, above 0 while the mode lasts: {meaning}",
                depends_on=every,
            )
        )
    return tuple(found)


def _guards(mechanism: mechanisms.Mechanism, model: Model) -> Iterator[tuple[str, str]]:
    """Yield a name and words for each guard, in their order."""
    header = model.sizes.header
    names: Sequence[str] = mechanism.coordinates
    if header[state_layout.IS_TURNED]:
        names = [f"slip_{i + 1}" for i in range(len(names))]
    if model.contacts:
        held = "margin to the static level where it is held"
        directions = header[state_layout.N_DIRECTIONS]
        closing = [f"slip_{i + 1}" for i in range(len(names), directions)]
        for name in (*names, *closing):
            yield f"{name}.forward", f"speed of {name} where it slips, {held}, forward"
            yield f"{name}.backward", f"{held}, backward"
        for i in range(header[state_layout.N_PAIRS] - directions):
            margin = "margin to the levels of all contacts that are held along the cut"
            yield f"cut_{i + 1}.forward", f"{margin}, forward"
            yield f"cut_{i + 1}.backward", f"{margin}, backward"
        for contact in (name or "contact" for name in model.contacts):
            for j in range(header[state_layout.LAW_SWITCHES]):
                yield f"{contact}.switch_{j + 1}", f"a switch of the law of {contact}"
            yield f"{contact}.load", f"load of {contact}, less it where it is open"
    else:
        yield "slip", "slip velocity while the contact slips"
        yield "break_forward", "margin of the held contact to its static level, forward"
        yield "break_backward", "margin of the held contact to its static level, backward"
        yield "load", "normal force"
    for j in range(header[state_layout.N_SWITCHES]):
        yield f"switch_{j + 1}", "a switch of the equations"
    for j in range(header[state_layout.N_LIMITS]):
        yield f"limit_{j + 1}", f"{model.limits[j]}, which ends the simulation"
    first = state_layout.HEADER
    for j in range(header[state_layout.N_WALLS]):
        coordinate, side = header[first + 2 * j : first + 2 * j + 2]
        where = "upper" if side > 0 else "lower"
        yield f"{names[coordinate]}.{where}_stop", f"distance to its {where} stop"


def _state_words(mechanism: mechanisms.Mechanism, state: str) -> str:
    if state in mechanism.coordinates:
        return f"Coordinate {state}"
    if state in mechanism.rates:
        coordinate = mechanism.coordinates[mechanism.rates.index(state)]
        return f"Rate of {coordinate}"
    return f"Bristle deflection {state}"


def _parameters(
    mechanism: mechanisms.Mechanism,
    law: FrictionLaw | Laws,
    model: Model,
    first: int,
) -> Iterator[Variable]:
    """Yield the parameters of the equations; those that tables were made with are constants."""
    known = {
        path: (quantity, value)
        for root, prefix in ((mechanism, "mechanism"), (law, "friction"))
        for path, quantity, value in parameters(root, prefix)
    }
    units = path_units(mechanism, law)
    paths = dict(zip(model.parameter_paths, model.places, strict=True))
    references = {path: first + i for i, path in enumerate(paths)}
    for path, place in paths.items():
        quantity, value = known[path]
        parent, _, last = path.rpartition(".")
        symbol = f" ({quantity.symbol})" if quantity.symbol else ""
        weighed = path.startswith("friction.") and mechanisms.has_one_slip(mechanism)
        owner = "of the mechanism" if path.startswith("mechanism.") else "of the friction law"
        fixed = path.startswith("mechanism.") and _shapes_tables(mechanism, path, value)
        least = "" if quantity.at_least is None else f"{parent}.{quantity.at_least}"
        yield Variable(
            name=path,
            role="constant" if fixed else "parameter",
            index=place,
            start=float(value),
            unit=unit_on(mechanism, quantity) if weighed else units[path],
            description=f"{last.replace('_', ' ')}{symbol} {owner}",
            quantity=quantity,
            at_least=references.get(least, -1),
            tunable=not fixed and not _moves_a_guide(mechanism, path),
        )


def _moves_a_guide(mechanism: mechanisms.Mechanism, path: str) -> bool:
    """Whether a parameter belongs to a prescribed motion, which would jump with it."""
    root, *steps = path.split(".")
    owner: Any = mechanism if root == "mechanism" else None
    for step in steps:
        if owner is None or isinstance(owner, Profile):
            break
        owner = owner[int(step)] if step.isdecimal() else getattr(owner, step, None)
    return isinstance(owner, Profile)


def _shapes_tables(mechanism: mechanisms.Mechanism, path: str, value: float) -> bool:
    """Whether a parameter stands in what is made before a run: tables, starts, largest steps."""
    # Another value, and NaN, which spreads to all that is made of it.
    other = value * SHIFT if value else SHIFT - 1.0
    before = _made_before(mechanism, path, value)
    return any(_made_before(mechanism, path, number) != before for number in (other, math.nan))


def _made_before(mechanism: mechanisms.Mechanism, path: str, value: float) -> Any:
    """Return what is made before a run with one parameter of another value."""
    own = {name: number for name, _, number in parameters(mechanism, "mechanism")}
    own[path] = value
    twin = shadow(mechanism, "mechanism", own.__getitem__)
    try:
        return (
            [[(part.time_scale(), list(part.pieces(1.0))) for part in parts_of(drive)]
             for drive in twin.drives().values()],
            dict(twin.start()),
        )  # fmt: skip
    except (ArithmeticError, ValueError, TypeError) as error:
        return repr(error)


def _called(mechanism: mechanisms.Mechanism, drive: str) -> str:
    """Return what a drive is, in words."""
    told = mechanisms.told_fields(mechanism).get(drive)
    return f"Contact input {label_of(*told)}" if told else f"Drive {drive}"


def _drive_unit(mechanism: mechanisms.Mechanism, name: str) -> str:
    """Return the unit of a contact input, of a force, torque or load; empty for other drives."""
    if name in mechanisms.told_fields(mechanism):
        turning = set(mechanism.units) == {"rad"}
        return unit_of_input(mechanisms.told_fields(mechanism)[name][1], turning=turning)
    # A unit of the drive shows on which coordinates it acts, and so its unit.
    q = dict.fromkeys(mechanism.coordinates, 0.0)
    still = dict.fromkeys(mechanism.drives(), 0.0)
    pushed = {**still, name: 1.0}
    before, after = (mechanism.forces(0.0, q, q, drives) for drives in (still, pushed))
    moved = {
        coordinate: float(after.get(coordinate, 0.0)) - float(before.get(coordinate, 0.0))
        for coordinate in mechanism.coordinates
    }
    unit = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    kinds = {unit[key] for key, change in moved.items() if abs(abs(change) - 1.0) < 1e-9}
    if len(kinds) == 1:
        return "N m" if kinds == {"rad"} else "N"
    loads = (mechanism.loads(0.0, q, q, drives) for drives in (still, pushed))
    first, second = loads
    return "N" if not any(moved.values()) and dict(first) != dict(second) else ""


# The model description of an FMU, in XML, for FMI 2.0 and 3.0.

Fmi: TypeAlias = Literal[2, 3]
CAUSALITIES = {
    "independent": ("independent", "continuous", None),
    "input": ("input", "continuous", None),
    "parameter": ("parameter", "fixed", "exact"),
    "constant": ("local", "constant", "exact"),
    "state": ("output", "continuous", "exact"),
    "column": ("output", "continuous", "calculated"),
    "contact_mode": ("output", "discrete", "calculated"),
    "event_count": ("output", "discrete", "calculated"),
    "derivative": ("local", "continuous", "calculated"),
    "indicator": ("local", "continuous", "calculated"),
}
"""Causality, variability and kind of start value of each role."""
CATEGORIES = {
    "logStatusWarning": "How a run ended that did not reach the end",
    "logStatusError": "What cannot be done, and why",
}


@dataclass(frozen=True, kw_only=True)
class Heading:
    """What a model description says of the model as a whole."""

    name: str
    """Model name."""
    identifier: str
    """Name of the binary."""
    token: str
    """What ties description and binary together."""
    description: str
    """What it is, in words."""
    stop: float
    """End of a simulation unless the importer says otherwise [s]."""
    tolerance: float
    """Relative tolerance for solvers of importers."""


def model_description(heading: Heading, variables: Sequence[Variable], fmi: Fmi) -> bytes:
    """Return the model description."""
    guards = sum(signal.role == "indicator" for signal in variables)
    token = "guid" if fmi == 2 else "instantiationToken"
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": f"{fmi}.0",
            "modelName": heading.name,
            token: heading.token,
            "description": heading.description,
            "generationTool": f"stickslip {version('stickslip')}",
            "variableNamingConvention": "flat",
            **({"numberOfEventIndicators": str(guards)} if fmi == 2 else {}),
        },
    )
    state = "FMUstate" if fmi == 2 else "FMUState"
    common = {
        "modelIdentifier": heading.identifier,
        f"providesDirectionalDerivative{'s' * (fmi == 3)}": "true",
        f"canGetAndSet{state}": "true",
        f"canSerialize{state}": "true",
    }
    steps = {"needsCompletedIntegratorStep": "true"} if fmi == 3 else {}
    SubElement(root, "ModelExchange", {**common, **steps})
    sizes = {"canHandleVariableCommunicationStepSize": "true"}
    SubElement(root, "CoSimulation", {**common, **sizes})
    _add_units(root, variables)
    categories = SubElement(root, "LogCategories")
    for name, words in CATEGORIES.items():
        SubElement(categories, "Category", {"name": name, "description": words})
    SubElement(
        root,
        "DefaultExperiment",
        {
            "startTime": "0.0",
            "stopTime": repr(heading.stop),
            "tolerance": repr(heading.tolerance),
        },
    )
    place = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(variables):
        _add_variable(place, reference, variable, fmi)
    _add_structure(root, variables, fmi)
    indent(root)
    return bytes(tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _add_units(root: Element, variables: Sequence[Variable]) -> None:
    place = SubElement(root, "UnitDefinitions")
    for unit in dict.fromkeys(
        variable.unit for variable in variables if variable.unit and not variable.whole
    ):
        powers = {base: str(power) for base, power in base_units(unit).items()}
        powers |= {"offset": ZEROS[unit]} if unit in ZEROS else {}
        SubElement(SubElement(place, "Unit", {"name": unit}), "BaseUnit", powers)


def _typed(variable: Variable) -> dict[str, str]:
    """Return what belongs to the type: unit, range, start value."""
    found = {}
    if variable.unit and not variable.whole:
        found["unit"] = variable.unit
    quantity = variable.quantity
    if variable.role in ("parameter", "constant"):
        # There is no attribute for an exclusive bound: the binary refuses the bound itself.
        low = max(quantity.low, -math.inf if quantity.above is None else quantity.above)
        if low > -math.inf:
            found["min"] = repr(float(low))
        if quantity.high < math.inf:
            found["max"] = repr(float(quantity.high))
    if variable.role in ("input", "parameter", "constant", "state"):
        found["start"] = repr(float(variable.start))
    if variable.nominal is not None:
        found["nominal"] = repr(float(variable.nominal))
    return found


def _add_variable(place: Element, reference: int, variable: Variable, fmi: Fmi) -> None:
    causality, variability, initial = CAUSALITIES[variable.role]
    if variable.whole:
        variability = "discrete"
    if variable.tunable:
        variability = "tunable"
    common = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": causality,
        "variability": variability,
    }
    if initial is not None and causality != "independent":
        common["initial"] = initial
    typed = _typed(variable)
    # A reference in FMI 3, an index from 1 in FMI 2.
    if variable.state is not None:
        typed["derivative"] = str(variable.state + (fmi == 2))
    if fmi == 3:
        kind = "Int32" if variable.whole else "Float64"
        SubElement(place, kind, {**common, **typed})
        return
    element = SubElement(place, "ScalarVariable", common)
    SubElement(element, "Integer" if variable.whole else "Real", typed)


def _add_structure(root: Element, variables: Sequence[Variable], fmi: Fmi) -> None:
    place = SubElement(root, "ModelStructure")
    roles = ("state", "column", "contact_mode", "event_count")
    outputs = [i for i, variable in enumerate(variables) if variable.role in roles]
    rates = [i for i, variable in enumerate(variables) if variable.role == "derivative"]
    guards = [i for i, variable in enumerate(variables) if variable.role == "indicator"]
    unknown = [*(i for i in outputs if variables[i].role != "state"), *rates]
    if fmi == 3:
        for tag, references in (
            ("Output", outputs),
            ("ContinuousStateDerivative", rates),
            ("InitialUnknown", unknown),
            ("EventIndicator", guards),
        ):
            for reference in references:
                known = {} if tag == "InitialUnknown" else _known(variables[reference], 0)
                SubElement(place, tag, {"valueReference": str(reference), **known})
        return
    for tag, references in (
        ("Outputs", outputs),
        ("Derivatives", rates),
        ("InitialUnknowns", unknown),
    ):
        inside = SubElement(place, tag)
        for reference in references:
            known = {} if tag == "InitialUnknowns" else _known(variables[reference], 1)
            SubElement(inside, "Unknown", {"index": str(reference + 1), **known})


def _known(variable: Variable, first: int) -> dict[str, str]:
    """Return the states and inputs that a variable depends on, counted from `first`."""
    if variable.depends_on is None:
        return {}
    return {"dependencies": " ".join(str(index + first) for index in variable.depends_on)}
