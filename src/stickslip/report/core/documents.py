"""The frame of a report: a page, its sections, and the opening with the verdict."""

import platform
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from importlib.metadata import version
from typing import ClassVar, Final, Generic, TypeAlias, TypeVar, final

from stickslip.errors import InputError
from stickslip.report.core.blocks import Block, Fact, Note, at_most_three

LIBRARIES = ("stickslip", "numpy", "scipy", "symengine")


def versions() -> Mapping[str, str]:
    """Return the versions that a result may depend on."""
    return {"python": platform.python_version(), **{name: version(name) for name in LIBRARIES}}


def colophon(versions: Mapping[str, str]) -> str:
    """Return the last line of a page: what wrote it, and that it needs nothing else.

    Examples
    --------
    >>> colophon({"stickslip": "1.0"})
    'Written by stickslip 1.0. This file is self-contained: it loads nothing and runs no scripts.'
    """
    writer = f"stickslip {versions.get('stickslip', '')}".strip()
    return (
        f"Written by {writer}. This file is self-contained: it loads nothing and runs no scripts."
    )


_ID: Final = re.compile(r"[a-z][a-z0-9-]*")
CAUGHT: tuple[type[Exception], ...] = (Exception,)
"""What a section may fail with and become one line; tests catch nothing."""


@final
@dataclass(frozen=True, kw_only=True)
class LawLine:
    """A line of the law with its numbers, ready to copy.

    Parameters
    ----------
    label : str
        What the line is of, such as a direction or a parameter.
    formula : str
        The formula; equations stand between dollar signs.

    Examples
    --------
    >>> LawLine(label="forward", formula="$F$ = 21.1 N + 158 N s/m × $v$").label
    'forward'
    """

    label: str
    formula: str


@final
@dataclass(frozen=True, kw_only=True)
class Opening:
    """The verdict: a reader may stop after it and leave with the right decision.

    Parameters
    ----------
    kicker : str
        The data in one line.
    verdict : str
        One sentence that says what to do.
    lede : str
        Two or three sentences why.
    cannot_tell : tuple of str
        What the record leaves open, one to three items. Never empty.
    law : tuple of LawLine
        The law with its numbers.
    facts : tuple of Fact
        Up to three numbers one would quote.
    settles, measure_next : tuple of str
        What the record decides, and what to measure; up to three items each.
    record : str
        What the headings call the data: "record", "travel", ...

    Raises
    ------
    InputError
        If `cannot_tell` is empty, a list has more than three items, or the verdict is missing.

    Examples
    --------
    >>> Opening(
    ...     kicker="One travel",
    ...     verdict="Use Coulomb.",
    ...     lede="It is enough.",
    ...     cannot_tell=("$mu_s$",),
    ... ).template
    'opening'
    """

    template: ClassVar[str] = "opening"
    kicker: str
    verdict: str
    lede: str
    cannot_tell: tuple[str, ...]
    law: tuple[LawLine, ...] = ()
    facts: tuple[Fact, ...] = ()
    settles: tuple[str, ...] = ()
    measure_next: tuple[str, ...] = ()
    record: str = "record"

    def __post_init__(self) -> None:
        if not self.verdict.strip():
            raise InputError("Opening.verdict must be a sentence, got none.")
        if not any(item.strip() for item in self.cannot_tell):
            raise InputError(
                "Opening.cannot_tell must not be empty: no record determines everything."
            )
        for name in ("facts", "settles", "cannot_tell", "measure_next"):
            at_most_three(f"Opening.{name}", getattr(self, name))


@final
@dataclass(frozen=True, kw_only=True)
class Section:
    """A section of a page.

    Parameters
    ----------
    id : str
        Its address on the page: a-z, 0-9 and dashes.
    nav : str
        Its name in the list of contents.
    heading : str
        The finding, not the topic; nothing where an `Opening` follows.
    blocks : tuple of Block
        What it shows, at least one.
    collapsed : bool
        Whether it shows its heading only, until a reader opens it.

    Raises
    ------
    InputError
        If the id is not a plain word, there is nothing to show, or no heading to open it by.

    Examples
    --------
    >>> from stickslip.report import Paragraph
    >>> text = Paragraph(text="Coulomb friction predicts all of it.")
    >>> Section(id="scores", nav="Scores", heading="One wins", blocks=(text,)).id
    'scores'
    """

    id: str
    nav: str
    heading: str
    blocks: tuple[Block, ...]
    collapsed: bool = False

    def __post_init__(self) -> None:
        if not _ID.fullmatch(self.id):
            raise InputError(f"Section.id must be made of a-z, 0-9 and dashes, got {self.id!r}.")
        if not self.blocks:
            raise InputError(f"Section {self.id!r} has no content; leave it out.")
        if self.collapsed and not self.heading:
            raise InputError(f"Section {self.id!r} is collapsed: it needs a heading to open it by.")


@final
@dataclass(frozen=True, kw_only=True)
class Page:
    """A whole report.

    Parameters
    ----------
    title : str
        Title of the document.
    subject : str
        The data, at the right of the top line.
    sections : tuple of Section
        In reading order.
    footer : str
        Who wrote it, with the version.
    kicker : str
        What kind of page it is, beside the name of the project.

    Raises
    ------
    InputError
        If there is no section or two share an id.

    Examples
    --------
    >>> from stickslip.report import Paragraph
    >>> section = Section(id="a", nav="A", heading="A", blocks=(Paragraph(text="A."),))
    >>> Page(title="Rig", subject="rig.toml", sections=(section,), footer="stickslip 0.1.0").kicker
    'model selection report'
    """

    title: str
    subject: str
    sections: tuple[Section, ...]
    footer: str
    kicker: str = "model selection report"

    def __post_init__(self) -> None:
        ids = [section.id for section in self.sections]
        if not ids or len(set(ids)) < len(ids):
            raise InputError(f"Page.sections: at least one and each id once, got {ids}.")

    @property
    def has_opening(self) -> bool:
        """Whether a verdict is the main heading of the page."""
        return any(isinstance(block, Opening) for part in self.sections for block in part.blocks)


@final
@dataclass(frozen=True, kw_only=True)
class Origin:
    """Where the numbers of a page are from, and how to get them again.

    Examples
    --------
    >>> Origin(title="Slider", data="slider.csv, 6 s").title
    'Slider'
    """

    title: str
    """What was measured."""
    data: str
    """The data in one line."""
    file: str = ""
    """Name of the file, at the right of the top line; the title if not given."""
    digest: str = ""
    """SHA-256 of the inputs."""
    files: Mapping[str, str] = field(default_factory=dict)
    """SHA-256 of each file of data by its name."""
    commands: tuple[str, ...] = ()
    """Commands that give this page again."""
    versions: Mapping[str, str] = field(default_factory=versions)
    """Versions by name of the software."""


SectionMaker: TypeAlias = partial[Section] | partial[Section | None]
"""A function ``..._section`` with its arguments."""
V = TypeVar("V")


@final
@dataclass(frozen=True, kw_only=True)
class PageSections(Generic[V]):
    """The sections of the page of one kind of verdict, in the order in which a reader decides."""

    opening: Callable[[V, str, str], Section]
    """Made of the verdict, the data in one line, and a remark."""
    middle: Sequence[Callable[[V], Section | None]]
    """Made of the verdict alone; None where there is nothing to show."""
    reproduce: Callable[[V, Origin], Section]
    """How to make the verdict again."""

    def __call__(self, verdict: V, origin: Origin, remark: str = "") -> tuple[SectionMaker, ...]:
        """Return what makes the sections of a page."""
        return (
            partial(self.opening, verdict, origin.data, remark),
            *(partial(one, verdict) for one in self.middle),
            partial(self.reproduce, verdict, origin),
        )


def made_sections(*parts: Section | SectionMaker) -> tuple[Section, ...]:
    """Return the sections of a page; one that fails becomes one line that says so.

    What a page shows beside the verdict must not cost the verdict.

    Examples
    --------
    >>> from functools import partial
    >>> def energy_section(work):
    ...     return 1 / work
    >>> (section,) = made_sections(partial(energy_section, 0.0))
    >>> section.id, section.heading, section.blocks[0].text.partition(".")[0]
    ('energy', 'Energy', 'ZeroDivisionError: float division by zero')
    """
    found = []
    for part in parts:
        if isinstance(part, Section):
            found.append(part)
            continue
        try:
            section = part()
        except CAUGHT as error:
            section = failed_section(part.func.__name__.removesuffix("_section"), error)
        if section is not None:
            found.append(section)
    return tuple(found)


def failed_section(name: str, error: Exception) -> Section:
    """Return the line that stands where a section could not be made.

    Examples
    --------
    >>> failed_section("fixed_steps", ValueError("no steps")).id
    'fixed-steps'
    """
    text = f"{type(error).__name__}: {str(error).rstrip('.')}. The other sections are not affected."
    title = name.replace("_", " ").capitalize()
    note = Note(title="This section could not be produced.", text=text)
    return Section(id=name.replace("_", "-"), nav=title, heading=title, blocks=(note,))
