"""Targets of laws: C99, MATLAB and Octave, tables and documents."""

from collections.abc import Iterator
from typing import Any, ClassVar, Final

import numpy as np

from stickslip.exports.joints import steady_force
from stickslip.exports.languages import MATLAB, C, Source, commented, contains
from stickslip.exports.program import Export, Function, Subject, Target
from stickslip.quantities import fields_of, turned
from stickslip.show.documents import document, json_text

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
    invalid = [f"isnan({variable.name})" for variable in function.inputs if not variable.positive]
    invalid += [f"!({variable.name} > 0.0)" for variable in function.inputs if variable.positive]
    result = f"{source.name_of(function)}_result"
    if not function.inner:
        yield f"    if ({' || '.join(invalid)}) {{"
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
    results = ", ".join(output.name for output in function.outputs)
    head = f"[{results}]" if len(function.outputs) > 1 else results
    yield f"function {head} = {name}({', '.join(variable.name for variable in function.inputs)})"
    yield from _matlab_help(name, function)
    inside = source.inside(function, results=False)
    if not function.inner:
        yield from _by_element(name, function)
    yield from inside.constants
    if not function.inner:
        yield from _guard(function)
    yield from inside.statements
    yield "end"


def _matlab_help(name: str, function: Function) -> Iterator[str]:
    lines = [f"{name.upper()}  {function.summary}"]
    lines += [f"  {value.name}: {value.meaning} [{value.unit or '1'}]" for value in function.inputs]
    lines += [
        f"  returns {output.name}: {output.meaning} [{output.unit or '1'}]"
        for output in function.outputs
    ]
    yield from commented(lines, "%")
    yield "%#codegen"


def _by_element(name: str, function: Function) -> Iterator[str]:
    """Yield the call for each element where an argument is an array."""
    names = [variable.name for variable in function.inputs]
    results = ", ".join(output.name for output in function.outputs)
    head = f"[{results}]" if len(function.outputs) > 1 else results
    yield f"    if ~({' && '.join(f'isscalar({key})' for key in names)})"
    yield f"        each = zeros(size({' + '.join(names)}));"
    arguments = ", ".join(f"{key} + each" for key in names)
    yield f"        {head} = arrayfun(@{name}, {arguments});"
    yield from ("        return", "    end")


def _guard(function: Function) -> Iterator[str]:
    invalid = [f"isnan({variable.name})" for variable in function.inputs if not variable.positive]
    invalid += [f"~({variable.name} > 0)" for variable in function.inputs if variable.positive]
    yield f"    if {' || '.join(invalid)}"
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
        "parameters": [
            _parameter(subject, parameter.name) for parameter in subject.equations.parameters
        ],
        "shape": dict(_shape(subject)),
        "covariance_of": [] if known is None else list(known.covariance_of),
        "covariance": [] if known is None else [list(row) for row in known.covariance],
        "provenance": subject.source or None,
    }


def _parameter(subject: Subject, name: str) -> dict[str, Any]:
    (field,) = (parameter for parameter in subject.equations.parameters if parameter.name == name)
    known = subject.estimates
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
