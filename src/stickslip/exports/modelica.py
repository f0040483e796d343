"""Modelica: a package with the functions of a law, and a model of a body that sticks and slips."""

import re
from collections.abc import Iterator, Mapping
from typing import ClassVar, final

from typing_extensions import override

from stickslip.exports.base import Target
from stickslip.exports.languages import MODELICA
from stickslip.exports.program import Function, Variable
from stickslip.exports.programs import Source, commented
from stickslip.exports.subject import Subject
from stickslip.quantities import turned

__all__ = ["Modelica", "modelica_unit"]

DEPTH = 2


def modelica_unit(unit: str) -> str:
    """Return a unit as Modelica writes it.

    Examples
    --------
    >>> [modelica_unit(unit) for unit in ("N s^2/m^2", "kg m^2", "1/m", "")]
    ['N.s2/m2', 'kg.m2', '1/m', '1']
    """
    return re.sub(r"\^", "", unit).replace(" ", ".") or "1"


def _safe(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', "'")


@final
class Modelica(Target):
    """A package with functions and a model."""

    name: ClassVar[str] = "modelica"
    title: ClassVar[str] = "Modelica"

    @override
    def files(self, subject: Subject) -> Mapping[str, str]:
        source = Source(subject=subject, language=MODELICA, safe=_safe)
        return {f"{subject.name}.mo": "\n".join(_package(source)) + "\n"}


def _package(source: Source) -> Iterator[str]:
    name = source.subject.name
    yield f'package {name} "Friction law of the package stickslip"'
    yield from commented([*source.subject.header()], "  // ")
    for one in source.functions:
        yield ""
        yield from _function(source, one)
    yield ""
    yield from _model(source)
    yield f"end {name};"


def _function(source: Source, function: Function) -> Iterator[str]:
    inside = source.inside(function, results=False, depth=DEPTH)
    yield f'    function {function.name} "{_safe(function.summary)}"'
    for kind, variables in (("input", function.inputs), ("output", function.outputs)):
        yield from (f"        {kind} {_declared(one)}" for one in variables)
    constants = [re.sub(r'unit="([^"]*)"', _as_modelica, line) for line in inside.constants]
    if constants or inside.declarations:
        yield "    protected"
        yield from (*constants, *inside.declarations)
    yield "    algorithm"
    for one in function.inputs:
        if one.positive:
            yield f'        assert({one.name} > 0.0, "{one.name} must be above 0 {one.unit}");'
    yield from inside.statements
    yield f"    end {function.name};"


def _as_modelica(match: re.Match[str]) -> str:
    return f'unit="{modelica_unit(match.group(1))}"'


def _declared(one: Variable) -> str:
    unit = f'(unit="{modelica_unit(one.unit)}")' if one.unit else ""
    return f'Real {one.name}{unit} "{_safe(one.meaning)}";'


def _model(source: Source) -> Iterator[str]:
    """Yield a body with one coordinate, whose friction is the law."""
    turning, law = source.subject.turning, source.subject.equations

    def of(name: str, unit: str, meaning: str, start: str = "") -> str:
        given = f", start={start}, fixed=true" if start else ""
        return f'{name}(unit="{modelica_unit(turned(unit, turning))}"{given}) "{meaning}";'

    yield '    model Body "Body under an applied force and friction, which sticks and slips"'
    yield f"        parameter Real {of('mass', 'kg', 'mass or moment of inertia')[:-1]} = 1.0;"[
        :0
    ] + f'        parameter Real mass(unit="{modelica_unit(turned("kg", turning))}") = 1.0 "inertia";'
    yield f'        parameter Real v_start(unit="{modelica_unit(turned("m/s", turning))}") = 0.0 "velocity at the start";'
    yield f"        input Real {of('applied', 'N', 'force on the body without friction')}"
    yield '        input Real load(unit="N") "normal force";'
    yield f"        Real {of('x', 'm', 'displacement', '0.0')}"
    yield f"        Real {of('v', 'm/s', 'slip velocity', 'v_start')}"
    for z in law.bristles:
        yield f"        Real {of(z, 'm', 'bristle state', '0.0')}"
    yield f"        Real {of('force', 'N', 'friction force')}"
    yield from _held(law.bristles) if law.holds else _free(law.bristles)
    yield "    end Body;"


def _free(bristles: tuple[str, ...]) -> Iterator[str]:
    states = "".join(f"{z}, " for z in bristles)
    rates = ", ".join(f"der({z})" for z in bristles)
    yield "    equation"
    yield "        der(x) = v;"
    yield "        mass*der(v) = applied - force;"
    yield f"        force = friction(v, {states}load);"
    left = rates if len(bristles) == 1 else f"({rates})"
    yield f"        {left} = rates(v, {states}load);"


def _held(bristles: tuple[str, ...]) -> Iterator[str]:
    turned_states = "".join(f"direction*{z}, " for z in bristles)
    yield '        Real along "friction force along the direction of slip";'
    yield from (f'        Real {z}_rate "rate along the direction of slip";' for z in bristles)
    yield '        Integer direction(start=if v_start > 0.0 then 1 else if v_start < 0.0 then -1 else 0, fixed=true) "1 forward, -1 backward, 0 at rest";'
    yield "    equation"
    yield "        der(x) = v;"
    yield "        mass*der(v) = if direction == 0 then 0.0 else applied - force;"
    yield "        force = if direction == 0 then applied else direction*along;"
    results = ", ".join(("along", *(f"{z}_rate" for z in bristles)))
    left = f"({results})" if bristles else results
    yield f"        {left} = slip(direction*v, {turned_states}if direction < 0 then -1.0 else 1.0, load);"
    yield from (
        f"        der({z}) = if direction == 0 then 0.0 else direction*{z}_rate;" for z in bristles
    )
    yield "        when pre(direction) == 0 and applied > break_away(1.0, load) then"
    yield "            direction = 1;"
    yield "        elsewhen pre(direction) == 0 and -applied > break_away(-1.0, load) then"
    yield "            direction = -1;"
    yield "        elsewhen pre(direction) == 1 and v < 0.0 then"
    yield "            direction = if -applied > break_away(-1.0, load) then -1 else 0;"
    yield "            reinit(v, 0.0);"
    yield "        elsewhen pre(direction) == -1 and v > 0.0 then"
    yield "            direction = if applied > break_away(1.0, load) then 1 else 0;"
    yield "            reinit(v, 0.0);"
    yield "        end when;"
