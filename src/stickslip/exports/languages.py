"""How C and MATLAB write a law as a program: what differs is data, the printer is one."""

import re
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from stickslip.engine.formulation import Block, Syntax
from stickslip.exports.functions import functions_of
from stickslip.exports.program import (
    Assign,
    Branch,
    Call,
    Constant,
    Function,
    Leave,
    Repeat,
    Statement,
    Subject,
    assigned,
    called,
)

WIDTH: Final = 96
INDENT: Final = "    "
SAME_NAMES: Final = {name: name for name in ("exp", "sqrt", "sin", "cos", "tanh", "atan", "log")}


@dataclass(frozen=True, kw_only=True)
class Language:
    """What differs between languages below the heads of functions."""

    syntax: Syntax
    """Expressions, assignments and branches."""
    chained: str
    """Head of a branch that stands elsewhere in another, with its ``{condition}``."""
    joined: str
    """What stands between the name of the program and that of a function."""
    single: str
    """A call with one result: ``{name}``, ``{function}``, ``{arguments}``."""
    several: tuple[str, ...]
    """Lines of a call with several results, which are ``{names}``; a line with ``{name}`` stands
    for each of them."""
    repeat: tuple[str, str]
    """Head and end of what is repeated so many ``{times}``."""
    leave: str
    """What ends it before."""
    constant: str
    """Definition of a constant: ``{name}``, ``{value}``, ``{unit}``, ``{text}``."""
    declaration: str
    """Declaration of ``{names}``; none if empty."""


C: Final = Language(
    syntax=Syntax(
        functions=SAME_NAMES,
        power="pow({base}, {exponent})",
        assign="{name} = {value};",
        branch="if ({condition}) {{",
        otherwise="} else {",
        end="}",
    ),
    chained="}} else if ({condition}) {{",
    joined="{program}_{function}",
    single="{name} = {function}({arguments});",
    several=(
        "{{",
        "    const {function}_result result = {function}({arguments});",
        "    {name} = result.{output};",
        "}}",
    ),
    repeat=("for (int turn = 0; turn < {times}; turn++) {{", "}"),
    leave="break;",
    constant="const double {name} = {value}; /* [{unit}] {text} */",
    declaration="double {names};",
)
MATLAB: Final = Language(
    syntax=Syntax(
        functions=SAME_NAMES,
        power="power({base}, {exponent})",
        assign="{name} = {value};",
        branch="if {condition}",
        otherwise="else",
        end="end",
    ),
    chained="elseif {condition}",
    joined="{program}_{function}",
    single="{name} = {function}({arguments});",
    several=("[{names}] = {function}({arguments});",),
    repeat=("for turn = 1:{times}", "end"),
    leave="break",
    constant="{name} = {value}; % [{unit}] {text}",
    declaration="",
)


@dataclass(frozen=True, kw_only=True)
class Written:
    """A function's inside in a language."""

    constants: tuple[str, ...]
    """Definitions of the parameters that it uses."""
    declarations: tuple[str, ...]
    """Declarations of its variables, results excluded where the language declares them."""
    statements: tuple[str, ...]
    """What it does."""


def written(
    function: Function,
    language: Language,
    program: str,
    constants: Sequence[Constant],
    functions: Mapping[str, Function],
    *,
    results: bool,
) -> Written:
    """Return what stands inside of a function."""
    block = Block(language.syntax, 1)
    _Writer(block=block, language=language, program=program, functions=functions).write(
        function.body
    )
    lines = tuple(block.lines)
    own = {output.name for output in function.outputs}
    kept = [name for name in dict.fromkeys(assigned(function.body)) if results or name not in own]
    names = [*kept, *block.temporaries]
    used = [constant for constant in constants if contains(lines, constant.name)]
    return Written(
        constants=tuple(
            INDENT
            + language.constant.format(
                name=value.name, value=repr(value.value), unit=value.unit, text=value.meaning
            )
            for value in used
        ),
        declarations=_declared(names, language),
        statements=lines,
    )


def contains(lines: Sequence[str], name: str) -> bool:
    """Return whether a line contains a name as a word."""
    word = re.compile(rf"\b{name}\b")
    return any(word.search(line) for line in lines)


def _declared(names: Sequence[str], language: Language) -> tuple[str, ...]:
    if not language.declaration or not names:
        return ()
    rows = textwrap.wrap(", ".join(names), WIDTH)
    return tuple(INDENT + language.declaration.format(names=row.rstrip(",")) for row in rows)


@dataclass(frozen=True, kw_only=True)
class _Writer:
    """Writes statements into a block."""

    block: Block
    language: Language
    program: str
    functions: Mapping[str, Function]

    def write(self, body: Sequence[Statement]) -> None:
        for statement in body:
            if isinstance(statement, Assign):
                texts = self.block.scope(list(statement.values))
                for name, text in zip(statement.names, texts, strict=True):
                    self.block.assign(name, text)
            elif isinstance(statement, Branch):
                self._branch(statement)
            elif isinstance(statement, Repeat):
                self._repeat(statement)
            elif isinstance(statement, Leave):
                self.block.line(self.language.leave)
            else:
                self._call(statement)

    def _repeat(self, loop: Repeat) -> None:
        head, end = self.language.repeat
        self.block.line(head.format(times=loop.times))
        self._indented(loop.body)
        self.block.line(end)

    def _branch(self, branch: Branch, *, chained: bool = False) -> None:
        """Write a branch; one that alone stands elsewhere in another goes on as its chain."""
        left, right = self.block.scope([branch.left, branch.right])
        syntax = self.language.syntax
        head = self.language.chained if chained else syntax.branch
        self.block.line(head.format(condition=f"{left} < {right}"))
        self._indented(branch.yes)
        if len(branch.no) == 1 and isinstance(branch.no[0], Branch) and _is_plain(branch.no[0]):
            self._branch(branch.no[0], chained=True)
        elif branch.no:
            self.block.line(syntax.otherwise)
            self._indented(branch.no)
        if not chained:
            self.block.line(syntax.end)

    def _indented(self, body: Sequence[Statement]) -> None:
        self.block.depth += 1
        self.write(body)
        self.block.depth -= 1

    def _call(self, call: Call) -> None:
        arguments = ", ".join(self.block.scope(list(call.arguments)))
        called = self.language.joined.format(program=self.program, function=call.function)
        pairs = list(zip(call.names, self.functions[call.function].outputs, strict=True))
        for form in self.language.several if len(pairs) > 1 else (self.language.single,):
            for name, output in pairs if "{name}" in form else pairs[:1]:
                self.block.line(
                    form.format(
                        name=name,
                        output=output.name,
                        names=", ".join(call.names),
                        function=called,
                        arguments=arguments,
                    )
                )


def _is_plain(branch: Branch) -> bool:
    """Whether the condition of a branch needs no temporaries."""
    return all(e.is_Symbol or e.is_Number or (-e).is_Symbol for e in (branch.left, branch.right))


@dataclass(frozen=True, kw_only=True)
class Source:
    """A law as a program in a language."""

    subject: Subject
    """What is exported."""
    language: Language
    """The language."""
    safe: Callable[[str], str]
    """Makes a text one that a comment of the language can hold."""

    @cached_property
    def functions(self) -> tuple[Function, ...]:
        """All functions that are called or may be, each after those that it calls."""
        every = functions_of(self.subject.equations, rotary=self.subject.rotary)
        wanted = {part.name for part in every if not part.inner}
        for function in reversed(every):  # each stands after those that it calls
            if function.name in wanted:
                wanted |= set(called(function.body))
        return tuple(part for part in every if part.name in wanted)

    @cached_property
    def constants(self) -> tuple[Constant, ...]:
        """Parameters of the law, whose words a comment can hold."""
        return tuple(
            Constant(name=c.name, value=c.value, unit=c.unit, meaning=self.safe(c.meaning))
            for c in self.subject.constants()
        )

    def inside(self, function: Function, *, results: bool) -> Written:
        """Return what stands inside of a function."""
        return written(
            function,
            self.language,
            self.subject.name,
            self.constants,
            {part.name: part for part in self.functions},
            results=results,
        )

    def name_of(self, function: Function) -> str:
        """Return the name of a function with that of the program."""
        return self.language.joined.format(program=self.subject.name, function=function.name)

    def header(self) -> list[str]:
        """Return the lines that say what the program is."""
        return [self.safe(line) for line in self.subject.header()]


def commented(lines: Sequence[str], before: str) -> Iterator[str]:
    """Yield lines as comments, long ones folded."""
    for line in lines:
        indent = line[: len(line) - len(line.lstrip())]
        folded = textwrap.wrap(
            line, WIDTH - len(before), subsequent_indent=indent + "  ", break_long_words=False
        )
        yield from (f"{before}{part}".rstrip() for part in folded or [""])
