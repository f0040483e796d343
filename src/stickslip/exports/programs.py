"""What the targets that are programs share: functions in order, notes on the law, guards."""

import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import final

from stickslip.exports.functions import functions_of
from stickslip.exports.languages import Language, Written, written
from stickslip.exports.program import Constant, Function, called
from stickslip.exports.subject import Subject

WIDTH = 96


@final
@dataclass(frozen=True, kw_only=True)
class Source:
    """A law as a program in a language."""

    subject: Subject
    """What is exported."""
    language: Language
    """The language."""
    safe: Callable[[str], str]
    """Makes a text one that a comment of the language can hold."""

    needed: tuple[str, ...] = ()
    """Inner functions that what stands beside the functions calls."""
    left_out: tuple[str, ...] = ()
    """Functions that the language has no use for."""

    @cached_property
    def functions(self) -> tuple[Function, ...]:
        """All functions that are called or may be, each after those that it calls."""
        every = functions_of(self.subject.equations, rotary=self.subject.rotary)
        asked = {one.name for one in every if not one.inner} - set(self.left_out)
        asked |= set(self.needed)
        for one in reversed(every):  # each stands after those that it calls
            if one.name in asked:
                asked |= set(called(one.body))
        return tuple(one for one in every if one.name in asked)

    @cached_property
    def constants(self) -> tuple[Constant, ...]:
        """Parameters of the law, whose words a comment can hold."""
        return tuple(
            Constant(name=c.name, value=c.value, unit=c.unit, meaning=self.safe(c.meaning))
            for c in self.subject.constants()
        )

    def inside(self, function: Function, *, results: bool, depth: int = 1) -> Written:
        """Return what stands inside of a function."""
        return written(
            function,
            self.language,
            self.subject.name,
            self.constants,
            {one.name: one for one in self.functions},
            results=results,
            depth=depth,
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
