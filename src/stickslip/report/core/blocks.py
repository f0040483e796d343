"""The blocks of a report.

Every text may use the small markup of `stickslip.report.core.markup.inline`. A block knows what it
says and which template shows it; it computes nothing.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Literal, Protocol, final, runtime_checkable

from markupsafe import Markup

from stickslip.errors import InputError

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


@final
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


@final
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


@final
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


@final
@dataclass(frozen=True, kw_only=True)
class Figure:
    """A figure with its caption.

    Parameters
    ----------
    svg : str
        What `stickslip.plots.inline_svg` returns. It goes into the page unescaped.
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
    svg: str
    caption: str = ""

    def __post_init__(self) -> None:
        _check_svg(self.svg)

    @property
    def markup(self) -> Markup:
        """The drawing, ready for the page."""
        return Markup(self.svg)


@final
@dataclass(frozen=True, kw_only=True)
class Animation:
    """A moving picture with its caption.

    Parameters
    ----------
    html : str
        What `stickslip.plots.animation_html` returns. It goes into the page unescaped.
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
    html: str
    caption: str = ""

    def __post_init__(self) -> None:
        """Check that it is a figure of its own."""
        whole = self.html.startswith(_BEGIN) and self.html.endswith(_END)
        if not whole or "<script" in self.html:
            raise InputError(
                "Animation.html must be what stickslip.plots.animation_html returns, got"
                f" {self.html[:40]!r}."
            )

    @property
    def markup(self) -> Markup:
        """The picture, ready for the page."""
        return Markup(self.html.removeprefix(_BEGIN).removesuffix(_END))  # checked above


@final
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


@final
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


@final
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


@final
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


@final
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


@final
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


@final
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


@final
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


@final
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


@final
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


@final
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


@final
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


def _check_svg(svg: str) -> None:
    drawings = re.findall(r"<svg\b[^>]*>", svg)
    if not svg.startswith("<svg") or not all("aria-label=" in drawing for drawing in drawings):
        raise InputError(f"a figure is <svg> with an aria-label, got {svg[:60]!r}.")
    if _ACTIVE.search(svg):
        raise InputError("a figure must not carry scripts or load anything.")
