"""Blocks, sections and pages of a report, and the page as one self-contained HTML file.

Every text may use the small markup of `stickslip.show.report.markup.inline`. A block knows what it
says and which template shows it; it computes nothing.
"""

import platform
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from importlib import resources
from importlib.metadata import version
from pathlib import Path
from typing import (
    TYPE_CHECKING,
    ClassVar,
    Final,
    Literal,
    Protocol,
    TypeAlias,
    TypeVar,
    runtime_checkable,
)

from markupsafe import Markup

from stickslip.errors import InputError
from stickslip.show.documents import write_file
from stickslip.show.formatting import printable, unbroken, unit_text
from stickslip.show.report import markup

if TYPE_CHECKING:
    from jinja2 import Environment

MOST: Final = 3
"""Items of a list that a reader reads to its end."""
_ACTIVE: Final = re.compile(
    r"<(?:script|foreignObject|style|image)\b|<[^>]*\s(?:on[a-z]+\s*=|(?:[a-z]+:)?href=[\"'](?!#))",
    re.IGNORECASE,
)

_BEGIN, _END = '<figure class="animation">', "</figure>"


@runtime_checkable
class Block(Protocol):
    """Anything that names the template in ``templates/blocks`` that shows it."""

    template: ClassVar[str]


@dataclass(frozen=True, kw_only=True)
class Paragraph:
    """A paragraph of text.

    Parameters
    ----------
    text : str
        The text; equations stand between dollar signs.

    Examples
    --------
    >>> Paragraph(text="One travel fixes one number: $mu_d$.").template
    'paragraph'
    """

    template: ClassVar[str] = "paragraph"
    text: str


@dataclass(frozen=True, kw_only=True)
class Caption:
    """A remark in small print below a table or a matrix.

    Parameters
    ----------
    text : str
        The remark; equations stand between dollar signs.

    Examples
    --------
    >>> Caption(text="Dot: held-out error. Bar: ± 1 standard error.").template
    'caption'
    """

    template: ClassVar[str] = "caption"
    text: str


@dataclass(frozen=True, kw_only=True)
class Subheading:
    """A heading inside a section.

    Parameters
    ----------
    text : str
        The heading.

    Examples
    --------
    >>> Subheading(text="What moves together").template
    'subheading'
    """

    template: ClassVar[str] = "subheading"
    text: str


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A figure with its caption.

    Parameters
    ----------
    svg : str or callable
        What `stickslip.show.plots.inline_svg` returns, or what returns it where the figure is
        shown. It goes into the page unescaped.
    caption : str
        Begins with a bold name and says what to see.

    Raises
    ------
    InputError
        If it is no SVG, has no aria-label, or carries a script.

    Examples
    --------
    >>> Figure(svg='<svg aria-label="Travel"></svg>', caption="**Travel** of the block.").template
    'figure'
    """

    template: ClassVar[str] = "figure"
    svg: str | Callable[[], str]
    caption: str = ""

    def __post_init__(self) -> None:
        if isinstance(self.svg, str):
            _check_svg(self.svg)

    @property
    def markup(self) -> Markup:
        """The drawing, ready for the page."""
        return Markup(_check_svg(self.svg if isinstance(self.svg, str) else self.svg()))


@dataclass(frozen=True, kw_only=True)
class Animation:
    """A moving picture with its caption.

    Parameters
    ----------
    html : str or callable
        What `stickslip.show.plots.animation_html` returns, or what returns it where it is shown. It
        goes into the page unescaped.
    caption : str
        Begins with a bold name and says what to see.

    Raises
    ------
    InputError
        If it is something else, or carries a script.

    Examples
    --------
    >>> html = '<figure class="animation"><picture></picture></figure>'
    >>> Animation(html=html, caption="**The cart** in two cycles.").template
    'figure'
    """

    template: ClassVar[str] = "figure"
    html: str | Callable[[], str]
    caption: str = ""

    def __post_init__(self) -> None:
        if isinstance(self.html, str):
            _inside_figure(self.html)

    @property
    def markup(self) -> Markup:
        """The picture, ready for the page."""
        return Markup(_inside_figure(self.html if isinstance(self.html, str) else self.html()))


@dataclass(frozen=True, kw_only=True)
class Panel:
    """A small drawing with a name and a sentence, part of a `Gallery`.

    Parameters
    ----------
    svg : str
        The drawing, an ``<svg>`` element with an ``aria-label``.
    title : str
        Its name.
    text : str
        A sentence below the name.
    colour : {"ink", "c1", "c2", "c3", "c4"}
        Colour of the title, by its name in the style sheet.

    Examples
    --------
    >>> Panel(svg='<svg aria-label="Push"></svg>', title="A. Push.", text="10 N for 0.1 s.").colour
    'ink'
    """

    svg: str
    title: str
    text: str
    colour: Literal["ink", "c1", "c2", "c3", "c4"] = "ink"

    def __post_init__(self) -> None:
        _check_svg(self.svg)

    @property
    def markup(self) -> Markup:
        """The drawing, ready for the page."""
        return Markup(self.svg)


@dataclass(frozen=True, kw_only=True)
class Gallery:
    """Up to three small drawings side by side.

    Parameters
    ----------
    panels : tuple of Panel
        At most three drawings.

    Examples
    --------
    >>> panel = Panel(svg='<svg aria-label="Push"></svg>', title="A. Push.", text="10 N.")
    >>> Gallery(panels=(panel,)).template
    'gallery'
    """

    template: ClassVar[str] = "gallery"
    panels: tuple[Panel, ...]

    def __post_init__(self) -> None:
        at_most_three("Gallery.panels", self.panels)


@dataclass(frozen=True, kw_only=True)
class Fact:
    """A number one would quote, its doubt, and below it what it is.

    Parameters
    ----------
    value : str
        The number with its unit.
    what : str
        What the number is.
    aside : str
        Its interval or another qualification.

    Examples
    --------
    >>> Fact(value="0.255", aside="0.249 to 0.261", what="$mu_d$ for Coulomb").value
    '0.255'
    """

    value: str
    what: str
    aside: str = ""


@dataclass(frozen=True, kw_only=True)
class Facts:
    """Up to three facts side by side.

    Parameters
    ----------
    facts : tuple of Fact
        At most three facts.

    Examples
    --------
    >>> Facts(facts=(Fact(value="+47 %", what="more friction in reverse"),)).template
    'facts'
    """

    template: ClassVar[str] = "facts"
    facts: tuple[Fact, ...]

    def __post_init__(self) -> None:
        at_most_three("Facts.facts", self.facts)


@dataclass(frozen=True, kw_only=True)
class Note:
    """A warning or remark that must not be missed.

    Parameters
    ----------
    title : str
        First sentence, in bold.
    text : str
        The rest of it.
    kind : {"warn", "info"}
        Whether it warns or informs.

    Examples
    --------
    >>> Note(title="The record is short.", text="24.8 s.").kind
    'warn'
    """

    template: ClassVar[str] = "note"
    title: str
    text: str
    kind: Literal["warn", "info"] = "warn"


@dataclass(frozen=True, kw_only=True)
class KeyValue:
    """A named value, perhaps with the outcome of a check.

    Parameters
    ----------
    key : str
        Name of the value or the check.
    value : str
        The value as text, with its unit.
    mark : {"none", "ok", "warn", "bad"}
        Outcome of the check; ``"none"`` if it is not a check.

    Examples
    --------
    >>> KeyValue(key="Drift at rest", value="exactly 0", mark="ok").mark
    'ok'
    """

    key: str
    value: str
    mark: Literal["none", "ok", "warn", "bad"] = "none"


@dataclass(frozen=True, kw_only=True)
class KeyValues:
    """A list of named values or checks.

    Parameters
    ----------
    items : tuple of KeyValue
        The entries, in order.

    Examples
    --------
    >>> KeyValues(items=(KeyValue(key="Sampling", value="1 kHz", mark="ok"),)).template
    'key_values'
    """

    template: ClassVar[str] = "key_values"
    items: tuple[KeyValue, ...]


@dataclass(frozen=True, kw_only=True)
class Code:
    """Commands or code, shown as they are.

    Parameters
    ----------
    text : str
        The lines, joined by newlines.

    Examples
    --------
    >>> Code(text="$ stickslip select").template
    'code'
    """

    template: ClassVar[str] = "code"
    text: str


@dataclass(frozen=True, kw_only=True)
class Math:
    r"""An equation on a line of its own.

    Parameters
    ----------
    latex : str
        The equation.
    tag : str
        Its number in the source, such as "(5)".

    Examples
    --------
    >>> Math(latex=r"F = \mu_d N").template
    'math'
    """

    template: ClassVar[str] = "math"
    latex: str
    tag: str = ""


@dataclass(frozen=True, kw_only=True)
class Reference:
    """A cited work.

    Parameters
    ----------
    authors, title, where : str
        Who, what (set in italics), and journal and year.
    note : str
        What it was used for.
    url : str
        Its address; the page links to it and loads nothing from it.

    Raises
    ------
    InputError
        If the address is not https or http.

    Examples
    --------
    >>> Reference(authors="P. R. Dahl", title="A solid friction model", where="1968").url
    ''
    """

    title: str
    authors: str = ""
    where: str = ""
    note: str = ""
    url: str = ""

    def __post_init__(self) -> None:
        if self.url and not re.match(r"https?://", self.url):
            raise InputError(f"Reference.url must begin with https://, got {self.url!r}.")


@dataclass(frozen=True, kw_only=True)
class References:
    """A numbered list of cited works.

    Parameters
    ----------
    items : tuple of Reference
        The works, in the order of their numbers.

    Examples
    --------
    >>> References(items=(Reference(title="A solid friction model"),)).template
    'references'
    """

    template: ClassVar[str] = "references"
    items: tuple[Reference, ...]


@dataclass(frozen=True, kw_only=True)
class Columns:
    """Blocks side by side, below each other on a phone.

    Parameters
    ----------
    left : tuple of Block
        Blocks of the left column.
    right : tuple of Block
        Blocks of the right column.

    Examples
    --------
    >>> Columns(left=(Paragraph(text="Left."),), right=(Paragraph(text="Right."),)).template
    'columns'
    """

    template: ClassVar[str] = "columns"
    left: tuple[Block, ...]
    right: tuple[Block, ...]


def at_most_three(name: str, items: Sequence[object]) -> None:
    """Refuse a list that a reader would not read to its end.

    Examples
    --------
    >>> at_most_three("Facts.facts", ())
    """
    if len(items) > MOST:
        raise InputError(f"{name}: at most {MOST} items, got {len(items)}.")


def _inside_figure(html: str) -> str:
    """Return what is inside a figure of its own, which carries no script."""
    whole = html.startswith(_BEGIN) and html.endswith(_END)
    if not whole or "<script" in html:
        raise InputError(
            "Animation.html must be what stickslip.show.plots.animation_html returns, got"
            f" {html[:40]!r}."
        )
    return html.removeprefix(_BEGIN).removesuffix(_END)


def _check_svg(svg: str) -> str:
    drawings = re.findall(r"<svg\b[^>]*>", svg)
    if not svg.startswith("<svg") or not all("aria-label=" in drawing for drawing in drawings):
        raise InputError(f"a figure is <svg> with an aria-label, got {svg[:60]!r}.")
    if _ACTIVE.search(svg):
        raise InputError("a figure must not carry scripts or load anything.")
    return svg


# The frame of a report: a page, its sections, and the opening with the verdict.

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
    figure : Figure, optional
        What a reader has to see beside the verdict.
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
    figure: Figure | None = None
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
    >>> from stickslip.show.report import Paragraph
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
    >>> from stickslip.show.report import Paragraph
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
    result = []
    for part in parts:
        if isinstance(part, Section):
            result.append(part)
            continue
        try:
            section = part()
        except CAUGHT as error:
            section = failed_section(part.func.__name__.removesuffix("_section"), error)
        if section is not None:
            result.append(section)
    return tuple(result)


def failed_section(name: str, error: Exception) -> Section:
    """Return the line that stands where a section could not be made.

    Examples
    --------
    >>> failed_section("fixed_steps", ValueError("no steps")).id
    'fixed-steps'
    """
    title = name.replace("_", " ").capitalize()
    note = failed_note("section", error)
    return Section(id=name.replace("_", "-"), nav=title, heading=title, blocks=(note,))


def failed_note(what: str, error: Exception) -> Note:
    """Return the note that stands where a section or a figure could not be made.

    Examples
    --------
    >>> failed_note("figure", ValueError("no steps")).title
    'This figure could not be produced.'
    """
    text = f"{type(error).__name__}: {str(error).rstrip('.')}. The other {what}s are not affected."
    return Note(title=f"This {what} could not be produced.", text=text)


# A page as one self-contained HTML file: no script, no network, no web font.

_STYLES: Final = ("tokens.css", "report.css")
_IDS: Final = re.compile(r"<[a-zA-Z][^>]* id=\"([^\"]+)\"")


def render(page: Page) -> str:
    """Return a page as one HTML file.

    Examples
    --------
    >>> from stickslip.show.report import Page, Paragraph, Section
    >>> text = Paragraph(text="The block stops at $x$ = 0.204 m.")
    >>> section = Section(id="travel", nav="Travel", heading="One travel", blocks=(text,))
    >>> page = Page(title="Rig", subject="rig.toml", sections=(section,), footer="stickslip")
    >>> render(page).startswith("<!doctype html>")
    True
    """
    style = Markup("\n".join(_text(f"styles/{name}").strip() for name in _STYLES))
    text = _environment().get_template("page.html.j2").render(page=page, style=style)
    shared = [name for name, count in Counter(_IDS.findall(text)).items() if count > 1]
    if shared:
        raise InputError(
            f"the id {shared[0]!r} occurs twice on the page: give each figure a prefix of its own, "
            "unlike the id of any section."
        )
    return printable(text, lines=True)


def write(page: Page, path: str | Path) -> Path:
    """Write a page to a file, whole or not at all.

    Examples
    --------
    >>> import tempfile
    >>> from stickslip.show.report import Page, Paragraph, Section
    >>> section = Section(id="a", nav="A", heading="A", blocks=(Paragraph(text="A."),))
    >>> page = Page(title="Rig", subject="rig.toml", sections=(section,), footer="stickslip")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write(page, Path(folder) / "report.html").name
    'report.html'
    """
    path = Path(path)
    write_file(path, render(page))
    return path


@cache
def _environment() -> "Environment":
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    environment = Environment(
        loader=FunctionLoader(lambda name: _text(f"templates/{name}")),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "branches": markup.branches,
        "inline": markup.inline,
        "lines": _lines,
        "equation_parts": markup.equation_parts,
        "mathml": markup.mathml,
        "plain": markup.plain,
        "show": _show,
        "unbroken": unbroken,
        "unit_text": unit_text,
    }
    return environment


def _show(block: Block) -> Markup:
    template = _environment().get_template(f"blocks/{block.template}.html.j2")
    if not isinstance(block, Figure | Animation):
        return Markup(template.render(block=block))
    try:
        return Markup(template.render(block=block))
    except CAUGHT as error:  # a figure is drawn here, and must not cost what stands beside it
        return _show(failed_note("figure", error))


def _lines(text: str) -> Markup:
    """Return text with its markup, its line breaks kept."""
    return Markup("<br>").join(markup.inline(line) for line in text.split("\n"))


def _text(name: str) -> str:
    return resources.files("stickslip.show.report").joinpath(name).read_text(encoding="utf-8")
