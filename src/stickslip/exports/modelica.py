"""Modelica: a package with the functions of a law, and a model of a body that sticks and slips."""

import re
from collections.abc import Iterator, Sequence
from typing import ClassVar, final

from typing_extensions import override

from stickslip.errors import InputError
from stickslip.exports.base import Export, Target
from stickslip.exports.functions import input_variables, rotary_code, turned_variable
from stickslip.exports.identifiers import identifier
from stickslip.exports.languages import MODELICA, Source, commented
from stickslip.exports.program import Function, Variable
from stickslip.exports.subject import Subject

DEPTH = 2
STOPPED = "            reinit(v, 0.0);"


def modelica_unit(unit: str) -> str:
    """Return a unit as Modelica writes it.

    Examples
    --------
    >>> [modelica_unit(unit) for unit in ("N s^2/m^2", "kg m^2", "1/m", "")]
    ['N.s2/m2', 'kg.m2', '1/m', '1']
    """
    above, *below = unit.replace("^", "").replace(" ", ".").split("/")
    divisors = ".".join(below)
    return "/".join(filter(None, (above, f"({divisors})" if "." in divisors else divisors))) or "1"


def _safe(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', "'")


@final
class Modelica(Target):
    """A package with functions and a model."""

    name: ClassVar[str] = "modelica"
    title: ClassVar[str] = "Modelica"

    @override
    def export(self, subject: Subject) -> Export:
        if subject.equations.flags:
            raise InputError(
                f"{subject.name} has latched switches, which models in Modelica do not follow:"
                " export it to C or MATLAB, or an FMU of the rig."
            )
        # tools integrate bristles themselves, and not all of them read the searches of `step`
        held, bristles = subject.equations.holds, bool(subject.equations.bristles)
        source = Source(
            subject=subject,
            language=MODELICA,
            safe=_safe,
            needed=("slip",) if held else (),
            left_out=("step",) if bristles else (),
        )
        text = "\n".join(_package(source)) + "\n"
        return Export(target=self.name, files={f"{_package_name(source)}.mo": text})


def _package_name(source: Source) -> str:
    """Return the name of the package, which begins with a capital in Modelica."""
    words = source.subject.name.split("_")
    return identifier("".join(f"{word[:1].upper()}{word[1:]}" for word in words))


def _package(source: Source) -> Iterator[str]:
    name = _package_name(source)
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


def _declared(one: Variable, *, inside: str = "", value: str = "") -> str:
    unit = f'(unit="{modelica_unit(one.unit)}"{inside})' if one.unit else ""
    return f'Real {one.name}{unit}{value} "{_safe(one.meaning)}";'


def _model(source: Source) -> Iterator[str]:
    """Yield a body with one coordinate, whose friction is the law."""
    law, rotary = source.subject.equations, source.subject.rotary
    told = input_variables(law, rotary=rotary)
    inertia = Variable(name="mass", unit="kg", meaning="mass of the body")
    inputs = (
        Variable(name="applied", unit="N", meaning="force on the body but friction"),
        Variable(name="load", unit="N", meaning="normal force"),
    )
    states = (
        (Variable(name="x", unit="m", meaning="displacement"), "0.0"),
        (Variable(name="v", unit="m/s", meaning="slip velocity"), "v_start"),
        *((Variable(name=z, unit="m", meaning="bristle state"), "0.0") for z in law.bristles),
    )
    start = Variable(name="v_start", unit="m/s", meaning="velocity at the start")
    force = Variable(name="force", unit="N", meaning="friction force")

    def declared(one: Variable, inside: str = "", value: str = "") -> str:
        return _declared(turned_variable(one) if rotary else one, inside=inside, value=value)

    what = "torque" if rotary else "force"
    yield from (
        f'    model Body "Body under an applied {what} and friction, which sticks and slips"',
        f"        parameter {declared(inertia, value=' = 1.0')}",
        f"        parameter {declared(start, value=' = 0.0')}",
        *(f"        input {declared(one)}" for one in inputs),
        *(f"        input {_declared(one)}" for one in told),
        *(f"        {declared(one, inside=f', start={at}, fixed=true')}" for one, at in states),
        f"        {declared(force)}",
    )
    load = ", ".join(("load", *law.inputs))
    for line in _held(law.bristles, load) if law.holds else _free(law.bristles, load):
        yield rotary_code(line) if rotary else line
    yield "    end Body;"


def _free(bristles: tuple[str, ...], load: str) -> Iterator[str]:
    """Yield the equations of a body that bristles alone hold."""
    arguments = ", ".join(("v", *bristles, load))
    rates = [f"{z}_rate" for z in bristles]
    yield from (
        *(f'        Real {rate} "time derivative of a bristle state";' for rate in rates),
        "    equation",
        "        der(x) = v;",
        "        mass*der(v) = applied - force;",
        f"        force = friction({arguments});",
        f"        {_results(rates)} = rates({arguments});",
        *(f"        der({z}) = {rate};" for z, rate in zip(bristles, rates, strict=True)),
    )


def _held(bristles: tuple[str, ...], load: str) -> Iterator[str]:
    """Yield the equations of a body that rests exactly, and the events between rest and slip."""
    rates = [f"{z}_rate" for z in bristles]
    arguments = ", ".join(("direction*v", *(f"direction*{z}" for z in bristles), "sense", load))
    yield from (
        '        Real along "friction force along the direction of slip";',
        *(f'        Real {rate} "rate along the direction of slip";' for rate in rates),
        '        Real sense "1 or -1: the direction of slip, the last one at rest";',
        "        Integer direction(start=if v_start > 0.0 then 1 else if v_start < 0.0 then -1 else"
        " 0,",
        '            fixed=true) "1 forward, -1 backward, 0 at rest";',
        "    equation",
        "        der(x) = v;",
        "        mass*der(v) = if direction == 0 then 0.0 else applied - force;",
        "        force = if direction == 0 then applied else direction*along;",
        "        sense = if direction < 0 then -1.0 else 1.0;",
        f"        {_results(('along', *rates))} = slip({arguments});",
        *(
            f"        der({z}) = if direction == 0 then 0.0 else direction*{z}_rate;"
            for z in bristles
        ),
        f"        when pre(direction) == 0 and applied > break_away(1.0, {load}) then",
        "            direction = 1;",
        f"        elsewhen pre(direction) == 0 and -applied > break_away(-1.0, {load}) then",
        "            direction = -1;",
        "        elsewhen pre(direction) == 1 and v < 0.0 then",
        f"            direction = if -applied > break_away(-1.0, {load}) then -1 else 0;",
        STOPPED,
        "        elsewhen pre(direction) == -1 and v > 0.0 then",
        f"            direction = if applied > break_away(1.0, {load}) then 1 else 0;",
        STOPPED,
        "        end when;",
    )


def _results(names: Sequence[str]) -> str:
    """Return the left side of an equation with the results of a function."""
    return names[0] if len(names) == 1 else f"({', '.join(names)})"
