"""MATLAB and Octave: a file for each function, and the text of a MATLAB Function block."""

from collections.abc import Iterator
from typing import ClassVar, Final, final

from typing_extensions import override

from stickslip.exports.base import Export, Target
from stickslip.exports.languages import MATLAB, Source, commented
from stickslip.exports.program import Function
from stickslip.exports.subject import Subject

BLOCK: Final = "block"


@final
class Matlab(Target):
    """Function files, and text for a MATLAB Function block of Simulink."""

    name: ClassVar[str] = "matlab"
    title: ClassVar[str] = "MATLAB, Simulink and GNU Octave"

    @override
    def export(self, subject: Subject) -> Export:
        source = Source(subject=subject, language=MATLAB, safe=str)
        texts = {source.name_of(one): list(_function(source, one)) for one in source.functions}
        block = f"{subject.name}_{BLOCK}"
        whole = [*_block(source, block), *(line for text in texts.values() for line in ["", *text])]
        header = list(commented(source.header(), "% "))
        files = {name: [text[0], *header, *text[1:]] for name, text in texts.items()}
        files[block] = [whole[0], *header, *whole[1:]]
        written = {f"{name}.m": "\n".join(lines) + "\n" for name, lines in files.items()}
        return Export(target=self.name, files=written)


def _function(source: Source, function: Function) -> Iterator[str]:
    name = source.name_of(function)
    results = ", ".join(one.name for one in function.outputs)
    head = f"[{results}]" if len(function.outputs) > 1 else results
    yield f"function {head} = {name}({', '.join(one.name for one in function.inputs)})"
    yield from _about(name, function)
    inside = source.inside(function, results=False)
    if not function.inner:
        yield from _by_element(name, function)
    yield from inside.constants
    if not function.inner:
        yield from _guard(function)
    yield from inside.statements
    yield "end"


def _about(name: str, function: Function) -> Iterator[str]:
    lines = [f"{name.upper()}  {function.summary}"]
    lines += [f"  {one.name}: {one.meaning} [{one.unit or '1'}]" for one in function.inputs]
    lines += [
        f"  returns {one.name}: {one.meaning} [{one.unit or '1'}]" for one in function.outputs
    ]
    yield from commented(lines, "%")
    yield "%#codegen"


def _by_element(name: str, function: Function) -> Iterator[str]:
    """Yield the call for each element where an argument is an array."""
    names = [one.name for one in function.inputs]
    results = ", ".join(one.name for one in function.outputs)
    head = f"[{results}]" if len(function.outputs) > 1 else results
    yield f"    if ~({' && '.join(f'isscalar({one})' for one in names)})"
    yield f"        each = zeros(size({' + '.join(names)}));"
    arguments = ", ".join(f"{one} + each" for one in names)
    yield f"        {head} = arrayfun(@{name}, {arguments});"
    yield from ("        return", "    end")


def _guard(function: Function) -> Iterator[str]:
    invalid = [f"isnan({one.name})" for one in function.inputs if not one.positive]
    invalid += [f"~({one.name} > 0)" for one in function.inputs if one.positive]
    yield f"    if {' || '.join(invalid)}"
    yield from (f"        {one.name} = NaN;" for one in function.outputs)
    yield from ("        return", "    end")


def _block(source: Source, name: str) -> Iterator[str]:
    """Yield a block that keeps velocity and bristles from one period to the next."""
    (step,) = (one for one in source.functions if one.name == "step")
    law = source.subject.equations
    states = ("velocity", *law.bristles, *law.flags)
    inputs = ", ".join(one.name for one in step.inputs if one.name not in states)
    others = [one.name for one in step.outputs[len(states) :]]
    yield f"function [{', '.join((*states, *others))}] = {name}({inputs})"
    about = [
        f"{name.upper()}  Body with friction, one period at a call.",
        "  Text of a MATLAB Function block: copy this file into it and give it the sample time"
        " `period`. The body begins at rest.",
    ]
    yield from commented(about, "%")
    yield "%#codegen"
    kept = [f"kept_{one}" for one in states]
    yield f"    persistent {' '.join(kept)}"
    yield f"    if isempty({kept[0]})"
    yield from (f"        {one} = 0;" for one in kept)
    yield "    end"
    arguments = ", ".join(
        f"kept_{one.name}" if one.name in states else one.name for one in step.inputs
    )
    yield f"    [{', '.join((*kept, *others))}] = {source.name_of(step)}({arguments});"
    yield from (f"    {one} = kept_{one};" for one in states)
    yield "end"
