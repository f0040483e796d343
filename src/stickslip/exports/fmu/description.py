"""The model description of an FMU, in XML, for FMI 2.0 and 3.0."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Literal, TypeAlias, final
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from stickslip.exports.fmu.variables import ZEROS, Variable, base_units

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


@final
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
    guards = sum(one.role == "indicator" for one in variables)
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
    for unit in dict.fromkeys(one.unit for one in variables if one.unit and not one.whole):
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
    if variable.state is not None:
        typed["derivative"] = str(variable.state + (fmi == 2))
    if fmi == 3:
        kind = "Int32" if variable.whole else "Float64"
        SubElement(place, kind, {**common, **typed})
        return
    one = SubElement(place, "ScalarVariable", common)
    SubElement(one, "Integer" if variable.whole else "Real", typed)


def _add_structure(root: Element, variables: Sequence[Variable], fmi: Fmi) -> None:
    place = SubElement(root, "ModelStructure")
    roles = ("state", "column", "contact_mode", "event_count")
    outputs = [i for i, one in enumerate(variables) if one.role in roles]
    rates = [i for i, one in enumerate(variables) if one.role == "derivative"]
    guards = [i for i, one in enumerate(variables) if one.role == "indicator"]
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
    return {"dependencies": " ".join(str(one + first) for one in variable.depends_on)}
