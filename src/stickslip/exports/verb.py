"""Exports a law to another program."""

import contextlib
import dataclasses
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final, TypeAlias

import numpy as np

from stickslip import data, mechanisms
from stickslip.engine.simulation import simulate
from stickslip.errors import InputError, StickslipError, UnknownNameError
from stickslip.exports.joints import Mjcf, Urdf, steady_force
from stickslip.exports.languages import MATLAB, C, Source, commented, contains
from stickslip.exports.program import Export, Function, Parameter, Subject, Target, identifier
from stickslip.friction import FrictionLaw, Laws, bound
from stickslip.identify import Verdict
from stickslip.identify.fits import Fit
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import Given, Quantity, fields_of, named, turned
from stickslip.show.documents import document, json_text

if TYPE_CHECKING:
    Exported: TypeAlias = FrictionLaw | Fit[Any] | Verdict[Any] | data.Rig


# Targets of laws: C99, MATLAB and Octave, tables and documents.

# C99: a header and a source without memory, state or libraries but ``math.h``.

NOTES = (
    "Functions have no memory and no side effects. Where an argument is not a number, or one that"
    " must be above 0 is not, the results are NaN. Compile without -ffast-math, which ignores NaN.",
)


def _c_safe(text: str) -> str:
    return text.replace("*/", "* /").replace("/*", "/ *")


class CCode(Target):
    """A header and a source in C99."""

    name: ClassVar[str] = "c"
    title: ClassVar[str] = "C99"

    def export(self, subject: Subject) -> Export:
        source = Source(subject=subject, language=C, safe=_c_safe)
        files = {
            f"{subject.name}.h": "\n".join(_header(source)) + "\n",
            f"{subject.name}.c": "\n".join(_source(source)) + "\n",
        }
        return Export(target=self.name, files=files)


def _header(source: Source) -> Iterator[str]:
    guard = f"{source.subject.name.upper()}_H"
    yield from _comment([*source.header(), *NOTES])
    yield from (f"#ifndef {guard}", f"#define {guard}", "")
    yield from ("#ifdef __cplusplus", 'extern "C" {', "#endif", "")
    for function in source.functions:
        if function.inner:
            continue
        if len(function.outputs) > 1:
            yield from _struct(source, function)
        yield from _c_comment_of(function)
        yield f"{_signature(source, function)};"
        yield ""
    yield from ("#ifdef __cplusplus", "}", "#endif", "", f"#endif /* {guard} */")


def _source(source: Source) -> Iterator[str]:
    yield from _comment(source.header())
    yield from (f'#include "{source.subject.name}.h"', "", "#include <math.h>")
    for function in source.functions:
        yield ""
        if function.inner:
            yield f"/* {function.summary} */"
            if len(function.outputs) > 1:
                yield from _struct(source, function)
        yield f"{'static ' if function.inner else ''}{_signature(source, function)}"
        yield "{"
        yield from _body(source, function)
        yield "}"


def _body(source: Source, function: Function) -> Iterator[str]:
    inside = source.inside(function, results=True)
    yield from inside.constants
    yield from inside.declarations
    several = len(function.outputs) > 1
    result = f"{source.name_of(function)}_result"
    if not function.inner:
        yield f"    if ({' || '.join(_invalid(function, '!')).replace('> 0', '> 0.0')}) {{"
        nothing = ", ".join("NAN" for _ in function.outputs)
        if several:
            yield f"        const {result} none = {{{nothing}}};"
            yield "        return none;"
        else:
            yield "        return NAN;"
        yield "    }"
    else:
        lines = inside.statements
        yield from (f"    (void){v.name};" for v in function.inputs if not contains(lines, v.name))
    yield from inside.statements
    if several:
        names = ", ".join(output.name for output in function.outputs)
        yield f"    const {result} all = {{{names}}};"
        yield "    return all;"
    else:
        yield f"    return {function.outputs[0].name};"


def _signature(source: Source, function: Function) -> str:
    name = source.name_of(function)
    kind = f"{name}_result" if len(function.outputs) > 1 else "double"
    return f"{kind} {name}({', '.join(f'double {variable.name}' for variable in function.inputs)})"


def _struct(source: Source, function: Function) -> Iterator[str]:
    yield "typedef struct {"
    for output in function.outputs:
        yield f"    double {output.name}; /* {_words(output.meaning, output.unit)} */"
    yield f"}} {source.name_of(function)}_result;"


def _c_comment_of(function: Function) -> Iterator[str]:
    lines = [function.summary]
    lines += [f"  {value.name}: {_words(value.meaning, value.unit)}" for value in function.inputs]
    if len(function.outputs) == 1:
        (result,) = function.outputs
        lines.append(f"  returns: {_words(result.meaning, result.unit)}")
    yield from _comment(lines)


def _invalid(function: Function, no: str) -> list[str]:
    """Return the conditions under which arguments cannot be used; `no` negates one."""
    return [f"isnan({variable.name})" for variable in function.inputs if not variable.positive] + [
        f"{no}({variable.name} > 0)" for variable in function.inputs if variable.positive
    ]


def _words(meaning: str, unit: str) -> str:
    return f"{meaning} [{unit}]" if unit else meaning


def _comment(lines: list[str]) -> Iterator[str]:
    yield "/*"
    yield from commented(lines, " * ")
    yield " */"


# MATLAB and Octave: a file for each function, and the text of a MATLAB Function block.

BLOCK: Final = "block"


class Matlab(Target):
    """Function files, and text for a MATLAB Function block of Simulink."""

    name: ClassVar[str] = "matlab"
    title: ClassVar[str] = "MATLAB, Simulink and GNU Octave"

    def export(self, subject: Subject) -> Export:
        source = Source(subject=subject, language=MATLAB, safe=str)
        texts = {
            source.name_of(function): list(_matlab_function(source, function))
            for function in source.functions
        }
        block = f"{subject.name}_{BLOCK}"
        whole = [*_block(source, block), *(line for text in texts.values() for line in ["", *text])]
        header = list(commented(source.header(), "% "))
        files = {name: [text[0], *header, *text[1:]] for name, text in texts.items()}
        files[block] = [whole[0], *header, *whole[1:]]
        written = {f"{name}.m": "\n".join(lines) + "\n" for name, lines in files.items()}
        return Export(target=self.name, files=written)


def _matlab_function(source: Source, function: Function) -> Iterator[str]:
    name = source.name_of(function)
    arguments = ", ".join(variable.name for variable in function.inputs)
    yield f"function {_results(function)} = {name}({arguments})"
    yield from _matlab_help(name, function)
    inside = source.inside(function, results=False)
    if not function.inner:
        yield from _by_element(name, function)
    yield from inside.constants
    if not function.inner:
        yield from _guard(function)
    yield from inside.statements
    yield "end"


def _results(function: Function) -> str:
    """Return the results as the left side of a call in MATLAB."""
    names = ", ".join(output.name for output in function.outputs)
    return f"[{names}]" if len(function.outputs) > 1 else names


def _matlab_help(name: str, function: Function) -> Iterator[str]:
    lines = [f"{name.upper()}  {function.summary}"]
    pairs = [("", value) for value in function.inputs]
    pairs += [("returns ", value) for value in function.outputs]
    lines += [f"  {what}{v.name}: {v.meaning} [{v.unit or '1'}]" for what, v in pairs]
    yield from commented(lines, "%")
    yield "%#codegen"


def _by_element(name: str, function: Function) -> Iterator[str]:
    """Yield the call for each element where an argument is an array."""
    names = [variable.name for variable in function.inputs]
    yield f"    if ~({' && '.join(f'isscalar({key})' for key in names)})"
    yield f"        each = zeros(size({' + '.join(names)}));"
    arguments = ", ".join(f"{key} + each" for key in names)
    yield f"        {_results(function)} = arrayfun(@{name}, {arguments});"
    yield from ("        return", "    end")


def _guard(function: Function) -> Iterator[str]:
    yield f"    if {' || '.join(_invalid(function, '~'))}"
    yield from (f"        {output.name} = NaN;" for output in function.outputs)
    yield from ("        return", "    end")


def _block(source: Source, name: str) -> Iterator[str]:
    """Yield a block that keeps velocity and bristles from one period to the next."""
    (step,) = (function for function in source.functions if function.name == "step")
    law = source.subject.equations
    states = ("velocity", *law.bristles, *law.flags)
    inputs = ", ".join(variable.name for variable in step.inputs if variable.name not in states)
    others = [output.name for output in step.outputs[len(states) :]]
    yield f"function [{', '.join((*states, *others))}] = {name}({inputs})"
    about = [
        f"{name.upper()}  Body with friction, one period at a call.",
        "  Text of a MATLAB Function block: copy this file into it and give it the sample time"
        " `period`. The body begins at rest.",
    ]
    yield from commented(about, "%")
    yield "%#codegen"
    kept = [f"kept_{state}" for state in states]
    yield f"    persistent {' '.join(kept)}"
    yield f"    if isempty({kept[0]})"
    yield from (f"        {key} = 0;" for key in kept)
    yield "    end"
    arguments = ", ".join(
        f"kept_{signal.name}" if signal.name in states else signal.name for signal in step.inputs
    )
    yield f"    [{', '.join((*kept, *others))}] = {source.name_of(step)}({arguments});"
    yield from (f"    {state} = kept_{state};" for state in states)
    yield "end"


# CSV and JSON: a table of forces, and the law with all that is known of it.

EVEN_SPEEDS: Final = 200
"""Evenly spaced speeds in each direction."""
DENSE_SPEEDS: Final = 100
"""Speeds in each direction that are spaced by a constant ratio, for what happens near rest."""
LEAST_SPEED: Final = 1e-5
"""Smallest speed over the largest."""


class CsvTable(Target):
    """Friction force by velocity, for lookup tables."""

    name: ClassVar[str] = "csv"
    title: ClassVar[str] = "lookup table (CSV)"
    evaluates: ClassVar[bool] = True

    def export(self, subject: Subject) -> Export:
        law, load, most = subject.law, subject.needed_load(), subject.needed_speed()
        even = np.linspace(0.0, most, EVEN_SPEEDS + 1)[1:]
        speed = np.union1d(even, np.geomspace(LEAST_SPEED * most, most, DENSE_SPEEDS))
        speed[-1] = most  # which geomspace may miss by a rounding
        speed = np.unique(speed)
        velocity = np.concatenate([-speed[::-1], speed])
        force = steady_force(subject, velocity, load)
        unit, speed_unit = turned("N", subject.rotary), turned("m/s", subject.rotary)
        what = "torque" if subject.rotary else "force"
        notes = [
            *subject.header(),
            f"Friction of {'long' if law.states else 'any'} sliding"
            + (f" at a load of {load!r} N." if subject.levels == "per load" else "."),
            *([f"Contact inputs: {subject.at_text}."] if subject.at else []),
            *(
                f"Break-away {words}: {float(law.towards(side).break_away(load))!r} {unit}."
                for words, side in (("forward", 1), ("backward", -1))
            ),
            f"Velocity 0 has no row: there friction is any {what} up to break-away. A table that is"
            " interpolated between the rows beside it does not hold a body at rest.",
        ]
        rows = [f"{v!r},{f!r}" for v, f in zip(velocity.tolist(), force.tolist(), strict=True)]
        lines = [*commented(notes, "# "), f"velocity [{speed_unit}],friction [{unit}]", *rows]
        text = "\n".join(lines) + "\n"
        return Export(target=self.name, files={f"{subject.name}.csv": text})


class JsonDocument(Target):
    """The law with its parameters, units, intervals and covariance."""

    name: ClassVar[str] = "json"
    title: ClassVar[str] = "JSON"

    def export(self, subject: Subject) -> Export:
        text = json_text(document("law", _content(subject)))
        return Export(target=self.name, files={f"{subject.name}.json": text})


def _content(subject: Subject) -> dict[str, Any]:
    law, known = subject.law, subject.estimates
    return {
        "law": law.name,
        "title": law.title,
        "formula": law.formula,
        "sources": list(law.sources),
        "motion": "rotary" if subject.rotary else "linear",
        "levels": subject.levels,
        "load": subject.load,
        "inputs": list(law.inputs),
        "largest_speed": None if known is None else known.largest_speed,
        "static_switch": getattr(law, "static_switch", None),
        "bristles": list(law.states),
        "parameters": [_parameter(subject, field) for field in subject.equations.parameters],
        "shape": dict(_shape(subject)),
        "covariance_of": [] if known is None else list(known.covariance_of),
        "covariance": [] if known is None else [list(row) for row in known.covariance],
        "provenance": subject.source or None,
    }


def _parameter(subject: Subject, field: Parameter) -> dict[str, Any]:
    known, name = subject.estimates, field.name
    low, high = (None, None) if known is None else known.intervals.get(name, (None, None))
    return {
        "parameter": name,
        "symbol": field.quantity.symbol,
        "unit": subject.unit(field.quantity),
        "value": field.value,
        "low": low,
        "high": high,
        "interval": known.interval if known is not None and low is not None else None,
        "known": subject.known(name) or None,
    }


def _shape(subject: Subject) -> list[tuple[str, float]]:
    """Return whole exponents, which shape the equations instead of standing in them."""
    law = subject.law
    return [
        (name, float(getattr(law, name)))
        for name, quantity in fields_of(type(law)).items()
        if quantity.structural and not quantity.stands_in_equations(getattr(law, name))
    ]


# Exports a law to another program.

TARGETS: Final[Mapping[str, Target]] = MappingProxyType(
    {
        target.name: target
        for target in (CCode(), Matlab(), Mjcf(), Urdf(), CsvTable(), JsonDocument())
    }
)
"""What a law can be exported to."""

SPEED = Quantity("v_max", "m/s", above=0)
"""End of a range of speeds along a line; about an axis, in rad/s."""
SAMPLES = 2001
"""Evenly spaced times at which the largest speed of a run is sought, beside the solver's own."""


def export(
    source: "Exported",
    to: str,
    *,
    name: str | None = None,
    law: str | None = None,
    contact: str | None = None,
    load: float | None = None,
    largest_speed: Given | None = None,
    law_load: float | None = None,
    rig: data.Rig | None = None,
    rotary: bool | None = None,
    at: Mapping[str, Given] | None = None,
) -> Export:
    r"""Return a friction law as files of another program.

    Targets are ``"c"`` (C99), ``"matlab"`` (MATLAB, Simulink, GNU Octave), ``"mjcf"``
    (MuJoCo), ``"urdf"``, ``"csv"`` (a lookup table) and ``"json"``. The files are the same for the
    same law, whenever they are made.

    Parameters
    ----------
    source : FrictionLaw, Fit, Verdict or Rig
        The law, or what has it: of a verdict it is the law to use. `load_rig` reads a ``law.toml``.
    to : str
        Name of the target.
    name : str, optional
        What the program is called; the name of the law if not given. Characters that a name of a
        program cannot have become underscores.
    law : str, optional
        Which of the laws of a rig.
    contact : str, optional
        Whose law, where several contacts have their own.
    load : float, optional
        Normal force [N] at which tables and joints have their friction; that of the mechanism at
        rest if not given.
    largest_speed : float or str, optional
        End of the range of speeds, in m/s or rad/s, of tables, and over which the friction of a
        joint is adapted to the law; a number or a text with its unit. If not given: that of a run
        of the rig, or of the fit.
    law_load : float, optional
        Normal force [N] at which the law was fitted, if its levels are forces: they are divided by
        it.
    rig : Rig, optional
        On which the law is used: of joints, the effect of their simplified friction on it is
        computed.
    rotary : bool, optional
        Of a law itself, given without a rig: whether it is of a rotary axis, so that its levels are
        torques [N m] and speeds are in rad/s; linear if not given. All else says what it turns.
    at : mapping of str to float or str, optional
        Contact inputs of the law, such as ``{"temperature": "35 degC"}``, at which tables and
        joints have their friction; what the mechanism was given, or a fit's record had in the
        median, if not given. Programs have arguments for them.

    Returns
    -------
    Export
        The files, to be written by `Export.save`.

    Raises
    ------
    InputError
        If there is no such target or law, or a target needs a load or a speed that is not known.

    Examples
    --------
    >>> from stickslip import CoulombViscous, export
    >>> law = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.4)
    >>> found = export(law, "mjcf", name="slide", load=20.0, largest_speed=0.5)
    >>> found.remarks[0]
    'Least squares over speeds up to 0.5 m/s leave 0 N at most and 0 N rms.'
    """
    if to == "fmu":
        raise InputError(
            "an FMU is of a mechanism with its law:"
            " stickslip.exports.export_fmu(mechanism, law, path, t_end=...)."
        )
    target: Target = named(TARGETS, to, "target")
    given = Usage(
        law=law,
        contact=contact,
        load=load,
        largest_speed=largest_speed,
        law_load=law_load,
        rotary=rotary,
        at=at or {},
    )
    return target.export(
        subject_of(source, target.title, given, evaluates=target.evaluates, name=name, rig=rig)
    )


@dataclasses.dataclass(frozen=True, kw_only=True)
class Usage:
    """Which law of a source, and where it is evaluated: arguments of `export`."""

    law: str | None = None
    contact: str | None = None
    load: float | None = None
    largest_speed: Given | None = None
    law_load: float | None = None
    rotary: bool | None = None
    at: Mapping[str, Given] = dataclasses.field(default_factory=dict)


def subject_of(
    source: "Exported",
    title: str,
    usage: Usage,
    *,
    evaluates: bool,
    name: str | None = None,
    rig: data.Rig | None,
) -> Subject:
    """Return the law of a source as a target takes it, evaluated at its contact inputs or not."""
    rotary, law_load = usage.rotary, usage.law_load
    if rotary is not None and (rig is not None or not isinstance(source, FrictionLaw)):
        raise InputError(
            f"rotary={rotary} is for a law without a mechanism: leave it out, the mechanism says it"
            " (of an Axis, its field rotary)."
        )
    result = _taken(source, usage, rig)
    used = dataclasses.replace(
        result,
        name=identifier(name if name is not None else result.law.name),
        load=_load(result, law_load if usage.load is None and rig is None else usage.load),
        largest_speed=_speed(result, usage.largest_speed),
    )
    if name is not None and not any(character.isalnum() for character in name):
        raise InputError(f"the name of a program needs a letter or a digit, got {name!r}.")
    if evaluates:
        return evaluated(used, title, usage.at)
    _check_inputs(used.law, usage.at)
    if usage.at:
        raise InputError(
            f"{title} has an argument for each contact input ({', '.join(used.law.inputs)}):"
            " leave --at out (in Python at)."
        )
    return used


def evaluated(subject: Subject, title: str, given: Mapping[str, Given]) -> Subject:
    """Return a law at its contact inputs: those that are given, or that its mechanism tells."""
    law, body = subject.law, subject.mechanism
    _check_inputs(law, given)
    known: dict[str, float] = {}
    for name in law.inputs:
        unit = data.unit_of_input(name, turning=subject.rotary)
        quantity = CONTACT_INPUTS[name].quantity(unit)
        fields = [mechanisms.input_field(key, name) for key in (subject.contact, "")]
        own = next((getattr(body, field) for field in fields if hasattr(body, field)), None)
        value = given.get(name, own)
        if value is None or isinstance(value, Drive):
            raise InputError(
                f"{title} has the friction at one value of each contact input, and"
                f" {law.name} depends on {name}: give it, as --at {name}=... in"
                f" {quantity.unit} (in Python at={{{name!r}: ...}})."
            )
        known[name] = quantity.check("export.at", name, value)
    return dataclasses.replace(subject, law=bound(law, known), at=known)


def _check_inputs(law: FrictionLaw, given: Mapping[str, Given]) -> None:
    for name in given:
        if name not in law.inputs:
            raise UnknownNameError(f"contact input of {law.name}", name, law.inputs)


def law_or_rig(source: "Exported") -> FrictionLaw | data.Rig:
    """Return a law as it is, and a rig with its law for all that has one."""
    if isinstance(source, Verdict):
        if source.best is None or source.best.fit is None:
            raise InputError(
                f"this verdict names no law to export: {source.sentence} Export the fit of a"
                " candidate, such as verdict.candidates[0].fit."
            )
        return law_or_rig(source.best.fit)
    if not isinstance(source, Fit):
        return source
    fitted: object = source.law
    if isinstance(fitted, Laws):
        own: dict[str, Any] = {"contacts": {name: _known(law) for name, law in fitted.members}}
    elif isinstance(fitted, FrictionLaw):
        own = {"laws": {fitted.name: fitted}, "named": (fitted.name,)}
    else:
        raise InputError(
            f"{getattr(fitted, 'title', fitted)} cannot be exported: the logarithm of the speed"
            " knows no rest. `to_dict()` of the fit has its numbers."
        )
    return data.Rig(mechanism=source.mechanism, estimates=source.law_estimates(), **own)


def _known(law: FrictionLaw) -> data.KnownLaws:
    return data.KnownLaws(laws={law.name: law}, named=(law.name,))


def laws_by_contact(rig: data.Rig, law: str | None = None) -> dict[str, FrictionLaw]:
    """Return the laws of the contacts that have their own; `law` names one where there are more."""
    return {name: part for name, part in rig.law_by_contact(law).items() if part is not None}


def _taken(given: "Exported", usage: Usage, rig: data.Rig | None) -> Subject:
    """Return the law of what was given."""
    source, contact = law_or_rig(given), usage.contact
    if isinstance(source, data.Rig) and source.contacts:
        return _of_contact(
            laws_by_contact(source, usage.law), source.estimates, source.mechanism, contact
        )
    if not isinstance(source, data.Rig | FrictionLaw):
        raise InputError(f"export takes a friction law, a fit, a verdict or a rig, got {source!r}.")
    if contact is not None:
        raise InputError(
            f"contact={contact!r} chooses between laws by contact, but this is one law: leave it"
            " out."
        )
    if isinstance(source, data.Rig):
        return _carried(source, usage.law, rig, usage.law_load)
    if usage.law is not None or usage.law_load is not None:
        raise InputError(
            "law and law_load choose and divide the law of a rig: leave them out for a law itself."
        )
    if rig is None:
        levels: data.Levels = "torques" if usage.rotary else "per load"
        return Subject(law=source, name="", rotary=bool(usage.rotary), levels=levels)
    return Subject(
        law=source,
        name="",
        rig=rig,
        mechanism=rig.mechanism,
        rotary=mechanisms.slips_by_angle(rig.mechanism),
        levels=data.levels_at(rig.mechanism),
    )


def _carried(
    source: data.Rig, law: str | None, rig: data.Rig | None, law_load: float | None
) -> Subject:
    onto = source.mechanism if rig is None else rig.mechanism
    result = data.carried(source, onto, law=law, load=law_load)
    origin = Path(source.path).name
    if origin and source.digest:
        origin = f"{origin}, SHA-256 {source.digest}"
    known = result.estimates
    levels = data.levels_at(onto) if known is None else known.levels
    return Subject(
        law=result.law,
        name="",
        estimates=known,
        mechanism=onto,
        rotary=mechanisms.slips_by_angle(onto),
        levels=levels if law_load is None else "per load",
        source=origin,
        rig=rig,
        own_rig=source if source.path and len(source.mechanism.contacts()) == 1 else None,
    )


def _of_contact(
    laws: dict[str, FrictionLaw],
    known: data.LawEstimates | None,
    mechanism: mechanisms.Mechanism,
    contact: str | None,
) -> Subject:
    """Return the law of one of several contacts, with what is known of it."""
    if contact is None:
        raise InputError(
            f"{mechanism.title} has laws by contact, {', '.join(laws)}: choose one with --contact"
            f" (in Python contact={next(iter(laws), '')!r})."
        )
    if contact not in laws:
        raise UnknownNameError("contact with a law", contact, laws)
    (place,) = (item for item in mechanism.contacts() if item.name == contact)
    rotary = mechanisms.slips_by_angle(mechanism, place)
    said = data.LawEstimates(law={contact: laws[contact].name}, levels=data.levels_at(mechanism))
    if known is not None and not isinstance(known.law, str) and contact in known.law:
        said = known
    own = said.of_contact(contact, rotary=rotary)
    return Subject(
        law=laws[contact],
        name="",
        estimates=own if said is known else None,
        mechanism=mechanism,
        contact=contact,
        rotary=rotary,
        levels=own.levels,
    )


def _load(subject: Subject, given: float | None) -> float | None:
    if given is not None:
        if subject.levels != "per load":
            forces = subject.levels == "forces"
            cure = ", or divide them by --law-load (in Python law_load)" if forces else ""
            raise InputError(
                f"--load (in Python load): the levels of {subject.law.name} are {subject.levels},"
                f" which have no normal force: leave it out{cure}."
            )
        return data.LOAD.check("export", "load", given)
    if subject.levels != "per load":
        return 1.0
    mechanism = subject.mechanism
    if mechanism is None or len(mechanism.contacts()) != 1:
        return None
    return mechanisms.static_normal_force(mechanism)


def _speed(subject: Subject, given: Given | None) -> float | None:
    if given is not None:
        quantity = dataclasses.replace(SPEED, unit=turned(SPEED.unit, subject.rotary))
        return quantity.check("export", "largest_speed", given)
    if subject.rig is not None and len(subject.rig.mechanism.contacts()) == 1:
        fastest = _fastest(subject, subject.rig)
        if fastest is not None:
            return fastest
    known = None if subject.estimates is None else subject.estimates.largest_speed
    assert not isinstance(known, Mapping)  # that of one contact
    if known is None and subject.own_rig is not None:
        with contextlib.suppress(StickslipError):  # nobody has asked for a run of it
            return _fastest(subject, subject.own_rig)
    return known


def _fastest(subject: Subject, rig: data.Rig) -> float | None:
    """Return the largest slip speed of a rig with a law; None where nothing moves."""
    _, rate = mechanisms.slip_names(rig.mechanism)
    run = simulate(rig.mechanism, subject.law, t_end=rig.t_end, y0=rig.start(subject.law))
    times = np.union1d(np.linspace(0.0, rig.t_end, SAMPLES), run.t)
    return float(np.abs(run.at(times)[rate]).max()) or None
