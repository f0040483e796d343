"""Exports a mechanism with its law as an FMU."""

import hashlib
import io
import json
import math
import platform
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Literal, NamedTuple, TypeAlias
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from stickslip import mechanisms
from stickslip.data import unit_of_input, unit_on
from stickslip.engine.formulation import PAINLEVE, Model, formulate
from stickslip.engine.kernels import exchange, state_layout
from stickslip.engine.kernels import state_layout as enums
from stickslip.engine.kernels.batch import happened
from stickslip.engine.kernels.contacts.motion import first_contact_guard
from stickslip.engine.kernels.equations import CONSTANTS_OF, WALLS_OF
from stickslip.engine.simulation import check_pair, initial_state
from stickslip.engine.solver import (
    EventDriven,
    column_units,
    gather,
    object_files,
    path_units,
    reasons,
    status_of,
    within_stops,
)
from stickslip.engine.trajectory import Status
from stickslip.errors import CompilationError, InputError, UnknownNameError
from stickslip.exports.program import identifier
from stickslip.friction import Friction, FrictionLaw, Laws, PrintedForm, assigned, law_of
from stickslip.mechanisms import Mechanism, told_fields
from stickslip.mechanisms.drives import Drive, Piece, Profile, Sampled, Straight, Sum, parts_of
from stickslip.quantities import Quantity, parameters, shadow
from stickslip.show.documents import write_file
from stickslip.show.formatting import printable
from stickslip.study.control import drive_places
from stickslip.units import per_second, powers_in

# The model description of an FMU: its inputs, its variables, and the XML of FMI 2.0 and 3.0.

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
    result = list(names)
    for contact, name in _from_outside(mechanism, law, names):
        field = mechanisms.input_field(contact, name)
        before = getattr(mechanism, field, 0.0)
        start = before.value(0.0) if isinstance(before, Drive) else float(before)
        held = {name: Sampled(times=(0.0,), values=(start,))}
        mechanism = mechanisms.given_inputs(mechanism, {contact: held} if contact else held)
        result = [*(key for key in result if key != label_of(contact, name)), field]
    return mechanism, tuple(result)


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
    result: dict[str, Input] = {}
    for given in names:
        mechanism, input_ = _with_input(mechanism, given)
        if given in result or input_.drive in (other.drive for other in result.values()):
            raise InputError(f"the input {given!r} is named twice.")
        result[given] = input_
    return mechanism, result


def _with_input(mechanism: mechanisms.Mechanism, given: str) -> tuple[mechanisms.Mechanism, Input]:
    """Return a mechanism of which one more drive is told."""
    known = []
    for place in drive_places(mechanism):
        driven, names = place.driven(mechanism, Held())
        if names and given in (place.name, *names):
            before = place.drive(mechanism)
            return driven, Input(names[0], 0.0 if before is None else float(before.value(0.0)))
        known += names
    if given in mechanism.drives():
        raise InputError(
            f"the drive {given!r} of {mechanism.title} is a prescribed motion, which cannot be"
            " held over a step as an input: give the mechanism a force or torque instead."
        )
    raise UnknownNameError("drive", given, known)


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
    result = dict.fromkeys(BASES, 0)
    for name, power in powers_in(unit).items():
        if name not in _NAMED:
            raise InputError(f"the unit {unit!r} has {name!r}, which is no SI unit known here.")
        for base, own in _NAMED[name].items():
            result[base] += power * own
    return {base: power for base, power in result.items() if power}


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
    result = [Variable(name="time", role="independent", unit="s", description="Time")]
    for name, (drive, start) in inputs.items():
        result.append(
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
    result += _parameters(mechanism, law, model, len(result))
    first_state = len(result)
    inputs_of = [i for i, variable in enumerate(result) if variable.role == "input"]
    # Forces may depend on all states and inputs.
    every = (*inputs_of, *range(first_state, first_state + len(model.states)))
    for index, (state, value) in enumerate(zip(model.states, y0, strict=True)):
        result.append(
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
        result.append(
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
        result.append(
            Variable(name="mode", role="contact_mode", unit="1", description=MODE.format("Mode"))
        )
    what = "Events so far: changes of mode and impacts"
    result.append(Variable(name="event_count", role="event_count", unit="1", description=what))
    n = len(mechanism.coordinates)
    # rates of slips that are sums are set to 0 where they are held, and so change those of all;
    # in a loop, one rate follows from others
    header = model.sizes.header
    loops = header[state_layout.N_DIRECTIONS] > header[state_layout.N_COORDINATES]
    direct = 0 if header[state_layout.IS_TURNED] or loops else n
    for index, state in enumerate(model.states):
        result.append(
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
        result.append(
            Variable(
                name=f"indicator.{name}",
                role="indicator",
                index=index,
                description=f"Event indicator, above 0 while the mode lasts: {meaning}",
                depends_on=every,
            )
        )
    return tuple(result)


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
    result = {}
    if variable.unit and not variable.whole:
        result["unit"] = variable.unit
    quantity = variable.quantity
    if variable.role in ("parameter", "constant"):
        # There is no attribute for an exclusive bound: the binary refuses the bound itself.
        low = max(quantity.low, -math.inf if quantity.above is None else quantity.above)
        if low > -math.inf:
            result["min"] = repr(float(low))
        if quantity.high < math.inf:
            result["max"] = repr(float(quantity.high))
    if variable.role in ("input", "parameter", "constant", "state"):
        result["start"] = repr(float(variable.start))
    if variable.nominal is not None:
        result["nominal"] = repr(float(variable.nominal))
    return result


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


# Exports a mechanism with its law as an FMU.

SLOTS = (
    "ADDRESS", "BOOKS", "CONSTANTS", "DRIFT", "EVENTS", "MODE", "PIECE", "POINT", "REST_IS_FINAL",
    "SAMPLED", "SEVERAL", "STAGES", "STATUS", "STEPS", "TIME", "VALUES", "Y",
)  # fmt: skip
"""Places in the vectors of a run."""
IN_HEADER = ("CONSTANTS", "DRIFT", "POINT", "SAMPLED", "STAGES", "VALUES", "Y")
"""Those that depend on the model."""
SIZES = (
    "SIZE", "N_STATES", "N_GUARDS", "N_COLUMNS", "N_DRIVES", "MOST_EVENTS", "ROW_COLUMNS",
    "WALL_COLUMNS",
)  # fmt: skip
"""Places of sizes in the whole numbers of a run."""
QUESTIONS = (
    "ENTER", "RATES_AT", "GUARDS_AT", "COLUMNS_AT", "FALLEN", "JUMP", "LOOK", "NOTE", "CUT",
    "RETUNE", "SHOWN", "PLACE", "ALONG",
)  # fmt: skip
"""What the kernels are asked in model exchange."""
ENDS = (Status.LIFT_OFF, Status.LIMIT, Status.PAINLEVE)
"""How a run ends by itself, where it goes on no more but did not fail."""
LEAST_TOLERANCE = 1e-13
TOO_MANY = "The step took too many steps of the solver; results so far are kept."


def model_header(
    model: Model,
    variables: Sequence[Variable],
    *,
    table: Sequence[float],
    nominals: Sequence[float],
    settings: dict[str, float],
    token: str,
) -> str:
    """Return the header with all numbers of a model."""
    header = model.sizes.header
    roles = [variable.role for variable in variables]
    lines = [f"#define AT_{name} {_slot(name, header)}" for name in SLOTS]
    lines += [f"#define {name} {header[getattr(state_layout, name)]}" for name in SIZES]
    lines += [
        f"#define WHOLES {len(header)}",
        f"#define FIRST_TABLE {state_layout.HEADER}",
        f"#define FIRST_NUMBER {state_layout.NUMBERS}",
        *(
            f"#define FIRST_{role.upper()} {roles.index(role)}"
            for role in ("state", "derivative", "indicator")
        ),
        f"enum question {{ {', '.join(f'{q} = {getattr(exchange, q)}' for q in QUESTIONS)} }};",
        f"#define EVENT_COLUMNS {state_layout.EVENT_COLUMNS}",
        f"#define WALLS_OF {WALLS_OF}",
        f"#define CONSTANTS_OF {CONSTANTS_OF}",
        f"#define STATUS_FULL {enums.FULL}",
        f"#define STATUS_END_TIME {enums.END_TIME}",
        # stops are looked at before the coordinates are turned to those of the equations
        f"#define N_STOPS {0 if header[state_layout.IS_TURNED] else header[state_layout.N_WALLS]}",
        f"#define MOST_STEPS {1_000_000}",
        f"#define LEAST_TOLERANCE {_real(LEAST_TOLERANCE)}",
        *(f"#define {name} {_real(value)}" for name, value in settings.items()),
        f"#define TOKEN {_text(token)}",
        f"#define TABLE_SIZE {len(table)}",
        f"#define N_PIECES {len(table) // (1 + 3 * len(model.drives))}",
        f"#define N_INPUTS {sum(variable.role == 'input' for variable in variables)}",
        f"#define N_VARIABLES {len(variables)}",
        _array("int64_t HEADER_NUMBERS", map(str, header)),
        _array("double TABLE", map(_real, table)),
        _array("double NOMINALS", map(_real, nominals)),
        _array("bool IS_EVENT", _are_events(model)),
        _array("struct variable VARIABLES", map(_row, variables)),
    ]
    endings = list(_endings(model))
    lines += [
        f"#define N_ENDINGS {len(endings)}",
        _array("struct ending ENDINGS", endings),
    ]
    return "\n".join(["/* Numbers of a model, written by a program. */", *lines, ""])


def _slot(name: str, header: Sequence[int]) -> int:
    """Return a place in the vectors of a run; those of model-sized slots stand in the header."""
    place: int = getattr(state_layout, name)
    return place if name not in IN_HEADER else header[place]


def _are_events(model: Model) -> Iterable[str]:
    """Yield whether the fall of each guard is an event: switches without a name are none."""
    names, header = reasons(model), list(model.sizes.header)
    for guard in range(model.sizes.guards):
        if model.contacts and guard < first_contact_guard(header):
            yield "1"
        else:
            row = [0.0, 0.0, 0.0, float(guard), 0.0, 0.0, 0.0]
            yield str(int(names[happened(row, 0, header)] is not None))


def _endings(model: Model) -> Iterable[str]:
    """Yield what follows from each status of a run, and of one step of too many."""
    on = (enums.RUNNING, enums.END_TIME, enums.STEP_LIMIT, enums.FULL)
    for code in range(enums.LIMITED + len(model.limits)):
        if code in on:
            yield '{GOES_ON, ""}'
            continue
        status = status_of(code, model)
        name = "" if code < enums.LIMITED else model.limits[code - enums.LIMITED]
        which = f" ({name})" if name and name != PAINLEVE else ""
        outcome = "HAS_ENDED" if status in ENDS else "HAS_FAILED"
        yield f"{{{outcome}, {_text(status.value + which)}}}"
    yield f"{{HAS_FAILED, {_text(TOO_MANY)}}}"


def _row(variable: Variable) -> str:
    quantity = variable.quantity
    is_bound = variable.role == "parameter"
    open_ = is_bound and quantity.above is not None
    low = quantity.above if is_bound and quantity.above is not None else quantity.low
    words = quantity.range if is_bound else "a finite number"
    numbers = (_real(x) for x in (variable.start, low if is_bound else -math.inf))
    high = _real(quantity.high if is_bound else math.inf)
    return (
        f"{{{_text(variable.name)}, {variable.role.upper()}, {int(variable.whole)},"
        f" {int(variable.tunable)}, {variable.index}, {', '.join(numbers)}, {high}, {int(open_)},"
        f" {variable.at_least}, {_text(words)}}}"
    )


def _array(name: str, items: Iterable[str]) -> str:
    rows = ",\n    ".join(items)
    return f"static const {name}[] = {{\n    {rows}\n}};"


def _real(number: float) -> str:
    """Return a number in C without rounding."""
    if math.isinf(number):
        return "HUGE_VAL" if number > 0 else "-HUGE_VAL"
    return float(number).hex()


def _text(words: str) -> str:
    """Return a text in C; letters outside ASCII as bytes of UTF-8."""
    plain = json.dumps(words, ensure_ascii=False)
    # Two quotes end an escape, which C would read on through further hexadecimal digits.
    return "".join(
        c if c.isascii() else '""'.join(f"\\x{b:02x}" for b in c.encode()) + '""' for c in plain
    )


FOLDERS: Mapping[Fmi, str] = {2: "linux64", 3: "x86_64-linux"}
"""Folder of the binaries by version of FMI."""
COMPILERS = ("cc", "gcc", "clang")
# Products are not fused into sums, and nothing but the model is in the binary: the same model gives
# the same file.
FLAGS = (
    "-std=c99", "-O1", "-fPIC", "-shared", "-s", "-ffp-contract=off",
    "-Wl,-z,defs", "-Wl,-Bsymbolic", "-Wl,--version-script=exports.map", "-Wl,--build-id=none",
)  # fmt: skip


def compiler_here() -> str:
    """Return the C compiler; refuse early where no binary can be made."""
    if platform.system() != "Linux" or platform.machine() != "x86_64":
        raise InputError(
            f"an FMU is made on Linux on x86-64, and this is {platform.system()} on"
            f" {platform.machine()}: export the rig on such a machine."
        )
    for name in COMPILERS:
        path = shutil.which(name)
        if path is not None:
            return path
    raise InputError(
        "an FMU is linked by the C compiler of the system, and there is none (cc, gcc or clang):"
        " install one, as with `apt install gcc` (it is not needed to run the FMU)."
    )


def compiled(objects: Mapping[str, bytes], header: str, fmi: Fmi) -> bytes:
    """Return the binary."""
    compiler = compiler_here()
    sources = files("stickslip.exports.fmu").joinpath("c")
    names = ("instance.h", "exchange.h", "calls.h", f"fmi{fmi}.c")
    texts = {name: sources.joinpath(name).read_bytes() for name in names}
    texts["model.h"] = header.encode()
    texts["exports.map"] = f"{{ global: fmi{fmi}*; local: *; }};\n".encode()
    with tempfile.TemporaryDirectory(prefix="stickslip-fmu-") as name:
        folder = Path(name)
        for file, content in (texts | dict(objects)).items():
            (folder / file).write_bytes(content)
        command = [compiler, *FLAGS, "-o", "fmu.so", f"fmi{fmi}.c", *objects, "-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            raise CompilationError(f"{' '.join(command)} failed: {done.stderr.strip()}")
        return (folder / "fmu.so").read_bytes()


EXCHANGE = 1e-9
"""Relative tolerance that is stored for solvers of importers, as CVode does not reach 1e-12 where
stops or links meet bristles. In co-simulation only a finer one counts."""
END = Quantity("t_end", "s", above=0)
MOST_STEPS = 2000
SAMPLES = 400
"""Steps and times of the run that tells how large states are."""
USUAL_BRISTLE = 1e-5
"""Deflection of bristles that never moved [m or rad]: presliding is of micrometres."""
DATE = (1980, 1, 1, 0, 0, 0)
"""Date of all files: the same model gives the same FMU whenever it is made."""


def export_fmu(
    mechanism: Mechanism,
    law: Friction,
    path: str | Path,
    *,
    t_end: float,
    y0: Mapping[str, float] | Sequence[float] | None = None,
    inputs: Sequence[str] = (),
    fmi: Fmi = 3,
    name: str | None = None,
    title: str = "",
    solver: EventDriven | None = None,
    portable: bool = True,
    force: bool = False,
) -> Path:
    r"""Export a mechanism with a friction law as an FMU, for co-simulation and model exchange.

    The FMU needs no Python and runs on Linux. In co-simulation, the event-driven solver is inside.
    Changes of mode are located exactly, however long the communication steps are. Without inputs
    its results are those of `simulate` and do not depend on these steps at all; inputs are held
    over each step. In model exchange, the importer's solver integrates the modes, and the FMU says
    when and how they change.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back, as in `simulate`.
    path : str or Path
        File to write, ``.fmu``.
    t_end : float
        Time at which a simulation ends unless the importer says otherwise [s]. Drives that repeat
        themselves in pieces, such as `Square`, are known up to this time.
    y0 : mapping or sequence, optional
        Initial states, as in `simulate`; the importer can set other ones.
    inputs : sequence of str
        Drives of the mechanism that become inputs, and contact inputs that it was given. The other
        ones run as they are; contact inputs of the law that nothing tells are inputs too.
    fmi : {2, 3}
        Version of the standard, 2.0 or 3.0.
    name : str, optional
        Name of the model; that of the file if not given.
    title : str
        Description of the model; mechanism and law in words if not given.
    solver : EventDriven, optional
        Tolerances of the solver.
    portable : bool
        Whether the FMU runs on all processors of this platform, or else on those like this one.
    force : bool
        Whether a file that exists is replaced.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If an argument cannot be used, this is not Linux on x86-64, or there is no C compiler.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> from stickslip.exports import export_fmu
    >>> block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> law = Coulomb(kinetic_coefficient=0.25)
    >>> export_fmu(block, law, "block.fmu", t_end=1.0)  # doctest: +SKIP
    PosixPath('block.fmu')
    """
    target = Path(path)
    if fmi not in (2, 3):
        raise InputError(f"fmi must be 2 or 3, got {fmi!r}.")
    if target.suffix != ".fmu":
        raise InputError(f"an FMU is a file with the ending .fmu, got {target}.")
    if target.exists() and not force:
        raise InputError(
            f"{target} already exists; give --force (in Python force=True) to replace it."
        )
    compiler_here()
    stop = END.check("export_fmu", "t_end", t_end)
    solver = EventDriven() if solver is None else solver
    mechanism, inputs = told_from_outside(mechanism, law, inputs)
    laws = check_pair(mechanism, law)
    if isinstance(laws, PrintedForm):
        raise InputError(
            f"{type(laws).__name__} has no exact event-driven solution: export the corrected law"
            f" {laws.corrected.__name__}."
        )
    driven, drives = with_inputs(mechanism, inputs)
    labels = {field: label_of(*at) for field, at in told_fields(driven).items()}
    result = {labels.get(name, name): drive for name, drive in drives.items()}
    start = within_stops(driven, initial_state("export_fmu", driven, laws, y0))
    model = formulate(driven, laws)
    numbers = gather(driven, laws, model, stop)
    nominals = _nominals(driven, laws, solver, start, stop)
    variables = variables_of(driven, laws, model, y0=start, nominals=nominals, inputs=result)
    names = [variable.name for variable in variables]
    twice = [key for key in result if names.count(key) > 1]
    if twice:
        raise InputError(
            f"the input {twice[0]!r} has the name of another variable: name the drive by its path."
        )
    settings = {
        "DEFAULT_STOP": stop,
        "LAST_TIME": stop if _ends(driven) else math.inf,
        "STEP_CAP": numbers.time_scale / 6.0,
        "TOLERANCE": solver.tolerance_for(laws),
        "STORED_TOLERANCE": EXCHANGE,
    }
    objects = object_files(model, common=portable)
    table = numbers.table.tolist()
    # The token is a hash of all that the FMU has, itself left out.
    seed = model_header(
        model, variables, table=table, nominals=nominals, settings=settings, token=""
    )
    token = _token(seed, *objects.values(), str(fmi).encode())
    header = model_header(
        model, variables, table=table, nominals=nominals, settings=settings, token=token
    )
    label = name if name is not None else target.stem
    heading = Heading(
        name=printable(label),
        identifier=identifier(label),
        token=token,
        description=printable(title or model.title),
        stop=stop,
        tolerance=EXCHANGE,
    )
    binary = compiled(objects, header, fmi)
    write_file(
        target,
        _zipped(
            {
                "modelDescription.xml": model_description(heading, variables, fmi),
                f"binaries/{FOLDERS[fmi]}/{heading.identifier}.so": binary,
            }
        ),
    )
    return target


def _nominals(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    solver: EventDriven,
    y0: Sequence[float],
    stop: float,
) -> list[float]:
    """Return the size of each state [SI], by which importers scale their absolute tolerances.

    It is the largest in a run, down to a power of ten. A state that does not move in it, because
    an input is to move it, is given one that is usual.
    """
    # A short run: sizes are wanted to a power of ten.
    brief = replace(solver, max_steps=MOST_STEPS, estimate_error=False)
    run = brief.run(mechanism, law, y0=y0, t_end=stop)
    seen = run.at(np.linspace(*run.span, SAMPLES))
    moving = 2 * len(mechanism.coordinates)
    result = []
    for index, state in enumerate(run.states):
        largest = float(np.abs(seen[state]).max(initial=0.0))
        usual = 1.0 if index < moving else USUAL_BRISTLE
        known = math.isfinite(largest) and largest > 0.0
        result.append(10.0 ** math.floor(math.log10(largest)) if known else usual)
    return result


def _ends(mechanism: Mechanism) -> bool:
    """Whether the tables of drives end: a drive repeats itself in pieces."""
    parts = list(mechanism.drives().values())
    while parts:
        drive = parts.pop()
        if isinstance(drive, Sum):
            parts += drive.parts
        elif drive.repeats() is not None and drive.pieces(0.0):
            return True
    return False


def _token(text: str, *contents: bytes) -> str:
    """Return a hash in the form of an identifier that tools know."""
    digest = hashlib.sha256("\n".join([version("stickslip"), text]).encode())
    for content in contents:
        digest.update(content)
    result = digest.hexdigest()
    return (
        "{"
        + "-".join(result[a:b] for a, b in ((0, 8), (8, 12), (12, 16), (16, 20), (20, 32)))
        + "}"
    )


def _zipped(contents: Mapping[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            info = zipfile.ZipInfo(name, DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            archive.writestr(info, content)
    return buffer.getvalue()
