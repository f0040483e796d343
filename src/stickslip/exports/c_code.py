"""C99: a header and a source without memory, state or libraries but ``math.h``."""

from collections.abc import Iterator
from typing import ClassVar, final

from typing_extensions import override

from stickslip.exports.base import Export, Target
from stickslip.exports.languages import C, Source, commented, contains
from stickslip.exports.program import Function
from stickslip.exports.subject import Subject

NOTES = (
    "Functions have no memory and no side effects. Where an argument is not a number, or one that"
    " must be above 0 is not, the results are NaN. Compile without -ffast-math, which ignores NaN.",
)


def _safe(text: str) -> str:
    return text.replace("*/", "* /").replace("/*", "/ *")


@final
class CCode(Target):
    """A header and a source in C99."""

    name: ClassVar[str] = "c"
    title: ClassVar[str] = "C99"

    @override
    def export(self, subject: Subject) -> Export:
        source = Source(subject=subject, language=C, safe=_safe)
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
    for one in source.functions:
        if one.inner:
            continue
        if len(one.outputs) > 1:
            yield from _struct(source, one)
        yield from _about(one)
        yield f"{_signature(source, one)};"
        yield ""
    yield from ("#ifdef __cplusplus", "}", "#endif", "", f"#endif /* {guard} */")


def _source(source: Source) -> Iterator[str]:
    yield from _comment(source.header())
    yield from (f'#include "{source.subject.name}.h"', "", "#include <math.h>")
    for one in source.functions:
        yield ""
        if one.inner:
            yield f"/* {one.summary} */"
            if len(one.outputs) > 1:
                yield from _struct(source, one)
        yield f"{'static ' if one.inner else ''}{_signature(source, one)}"
        yield "{"
        yield from _body(source, one)
        yield "}"


def _body(source: Source, function: Function) -> Iterator[str]:
    inside = source.inside(function, results=True)
    yield from inside.constants
    yield from inside.declarations
    several = len(function.outputs) > 1
    invalid = [f"isnan({one.name})" for one in function.inputs if not one.positive]
    invalid += [f"!({one.name} > 0.0)" for one in function.inputs if one.positive]
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
        yield f"    const {result} all = {{{', '.join(one.name for one in function.outputs)}}};"
        yield "    return all;"
    else:
        yield f"    return {function.outputs[0].name};"


def _signature(source: Source, function: Function) -> str:
    name = source.name_of(function)
    kind = f"{name}_result" if len(function.outputs) > 1 else "double"
    return f"{kind} {name}({', '.join(f'double {one.name}' for one in function.inputs)})"


def _struct(source: Source, function: Function) -> Iterator[str]:
    yield "typedef struct {"
    for one in function.outputs:
        yield f"    double {one.name}; /* {_words(one.meaning, one.unit)} */"
    yield f"}} {source.name_of(function)}_result;"


def _about(function: Function) -> Iterator[str]:
    lines = [function.summary]
    lines += [f"  {one.name}: {_words(one.meaning, one.unit)}" for one in function.inputs]
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
