"""matplotlib figures as inline SVG that follows the theme of its page, and as plain files.

An inline figure is drawn twice, wide and narrow, because a scaled-down figure has unreadable
text; the style sheet of the page shows one of them. Text stays text: selectable, and small. Write
units in plain Unicode and symbols by `stickslip.show.plots.theme.symbol_label`.
"""

import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, TypeAlias
from xml.etree import ElementTree

from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from stickslip.errors import InputError
from stickslip.show.documents import write_file
from stickslip.show.formatting import printable
from stickslip.show.plots import theme

Draw: TypeAlias = Callable[[Figure, bool], None]
"""Draws into an empty figure; the flag says that it is the narrow one."""
Size: TypeAlias = tuple[float, float]
"""Width and height [CSS px]."""

WIDE: Final[Size] = (880, 300)
NARROW: Final[Size] = (358, 260)
FONTS: Final = (
    "-apple-system,'Segoe UI',Inter,Roboto,'Noto Sans','Liberation Sans',Arial,sans-serif"
)

_NAMESPACE = re.compile(r"\{[^}]*\}")
_PREFIX = re.compile(r"[a-z][a-z0-9-]*")
_COLOUR = re.compile(r"#[0-9a-f]{6}")
_DECIMAL = re.compile(r"-?(?<!\d)\d++\.\d+")
_REFERENCE = re.compile(r"#([A-Za-z][\w.-]*)")
_CIRCLE = re.compile(r"M 0 ([\d.]+) \s*(?:C [^CLQz]*){8}z\s*")
_FILL = re.compile(r"fill:[^;]*;?")
_SUFFIXES: Final = ("png", "svg", "pdf")
_MANY_MARKERS: Final = 30
_LONG_PATH: Final = 400


def inline_svg(
    draw: Draw, *, alt: str, prefix: str, wide: Size = WIDE, narrow: Size | None = NARROW
) -> str:
    """Draw a figure for both widths of a page, coloured by the CSS variables of the page.

    Parameters
    ----------
    draw : callable
        Draws into the figure it is given. The figure has a constrained layout and fills the
        space; ``figure.set_layout_engine("none")`` turns that off.
    alt : str
        What the figure shows, for readers who cannot see it.
    prefix : str
        Start of the ids in this figure, unlike that of any other figure of the page.
    wide : tuple of float
        Width and height where the page is wide, and in print [CSS px].
    narrow : tuple of float, optional
        The same on a phone. None for a small sketch, which is drawn once.

    Returns
    -------
    str
        Two ``<svg>`` elements, of the classes ``fw`` and ``fn``, or one of the class ``one``.

    Raises
    ------
    InputError
        If `alt` is empty or `prefix` is not made of a-z, 0-9 and dashes.

    Examples
    --------
    >>> def line(figure, narrow):
    ...     figure.add_subplot().plot([0, 1], [0, 1], color=theme.C1)
    >>> inline_svg(line, alt="A straight line", prefix="line")[:47]
    '<svg aria-label="A straight line" class="fw" ro'
    """
    if not alt.strip():
        raise InputError("a figure needs an `alt` text that says what it shows, got none.")
    if not _PREFIX.fullmatch(prefix):
        raise InputError(f"`prefix` must be made of a-z, 0-9 and dashes, got {prefix!r}.")
    parts = []
    variants = [("one", wide)] if narrow is None else [("fw", wide), ("fn", narrow)]
    for css_class, size in variants:
        root = _tree(_drawn(draw, size, css_class == "fn"), f"{prefix}-{css_class}-")
        for element in root.iter():
            if "style" in element.attrib:
                element.set("style", _COLOUR.sub(_variable, element.get("style", "")))
        root.attrib |= {"class": css_class, "role": "img", "aria-label": alt}
        parts.append(_text(root))
    return "".join(parts)


def standalone_svg(draw: Draw, *, size: Size = WIDE, narrow: bool = False, title: str = "") -> str:
    """Draw a figure as an SVG file of its own, in the light palette.

    Parameters
    ----------
    draw : callable
        Draws into the figure it is given.
    size : tuple of float
        Width and height [CSS px].
    narrow : bool
        Passed on to `draw`.
    title : str
        What the figure shows, for readers who cannot see it.

    Returns
    -------
    str
        The file's text, the same for the same drawing.

    Examples
    --------
    >>> def line(figure, narrow):
    ...     figure.add_subplot().plot([0, 1], [0, 1], color=theme.C1)
    >>> "#0b62a8" in standalone_svg(line)
    True
    """
    root = _tree(_drawn(draw, size, narrow, background=theme.SURFACE), "")
    root.attrib |= {"xmlns": "http://www.w3.org/2000/svg", "font-family": FONTS, "role": "img"}
    root.attrib |= {"width": f"{size[0]:g}", "height": f"{size[1]:g}"}
    if title:
        root.set("aria-label", printable(title))
    return _text(root) + "\n"


def save(
    draw: Draw,
    path: str | Path,
    *,
    size: Size = WIDE,
    narrow: bool = False,
    title: str = "",
    scale: float = 2.0,
) -> Path:
    """Draw a figure into a PNG, SVG or PDF file, chosen by the ending of its name.

    Parameters
    ----------
    draw : callable
        Draws into the figure it is given.
    path : str or Path
        File to write.
    size : tuple of float
        Width and height [CSS px].
    narrow : bool
        Passed on to `draw`.
    title : str
        What the figure shows; only an SVG file keeps it.
    scale : float
        Pixels of a PNG file per CSS pixel.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If the ending is not png, svg or pdf.

    Examples
    --------
    >>> import tempfile
    >>> def line(figure, narrow):
    ...     figure.add_subplot().plot([0, 1], [0, 1], color=theme.C1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save(line, Path(folder) / "line.png").name
    'line.png'
    """
    path = Path(path)
    kind = path.suffix.lower().removeprefix(".")
    if kind not in _SUFFIXES:
        known = ", ".join(_SUFFIXES)
        raise InputError(f"a figure is saved as one of {known}, got {path.name!r}.")
    if kind == "svg":
        svg = standalone_svg(draw, size=size, narrow=narrow, title=title)
        write_file(path, svg)
    else:
        write_file(path, _drawn(draw, size, narrow, theme.SURFACE, kind, scale))
    return path


def _drawn(
    draw: Draw,
    size: Size,
    narrow: bool,
    background: str = "none",
    kind: str = "svg",
    scale: float = 1.0,
) -> bytes:
    # Each format stamps its files under other names; all of them must go, or no two are equal.
    stamps = {
        "svg": ("Date",),
        "png": ("Software",),
        "pdf": ("CreationDate", "Creator", "Producer"),
    }
    with theme.house_style():
        figure = Figure(figsize=(size[0] / 72, size[1] / 72), dpi=72 * scale, layout="constrained")
        canvas: Any = FigureCanvasSVG(figure)
        figure.set_facecolor(background)
        draw(figure, narrow)
        if all(axes.get_subplotspec() is None for axes in figure.axes):
            figure.set_layout_engine("none")  # it warns if every place was given by hand
        engine = figure.get_layout_engine()
        buffer = io.BytesIO()
        metadata = dict.fromkeys(stamps[kind])
        if kind == "svg":  # `savefig` would go through all once more to lay it out
            if engine is not None:
                engine.execute(figure)
                figure.set_layout_engine("none")
            canvas.print_svg(buffer, metadata=metadata)
        else:
            figure.savefig(buffer, format=kind, dpi=72 * scale, metadata=metadata)
    return buffer.getvalue()


def _tree(svg: bytes, prefix: str) -> ElementTree.Element:
    root = ElementTree.fromstring(printable(svg.decode(), lines=True))  # XML knows no others
    for element in root.iter():
        element.tag = _NAMESPACE.sub("", element.tag)
        element.attrib = {_NAMESPACE.sub("", key): text for key, text in element.attrib.items()}
    _merge_markers(root)
    _prune(root, _used_ids(root))
    for element in root.iter():
        _tidy(element, prefix)
        if element.tag == "text":
            _let_flow(element)
    for key in ("width", "height", "version"):
        root.attrib.pop(key, None)
    root.attrib |= {"stroke-linejoin": "round", "stroke-linecap": "butt"}
    return root


def _text(root: ElementTree.Element) -> str:
    root.attrib = dict(sorted(root.attrib.items()))
    return ElementTree.tostring(root, encoding="unicode")


def _used_ids(root: ElementTree.Element) -> set[str]:
    texts = (element.get(key, "") for element in root.iter() for key in ("href", "clip-path"))
    return {name for text in texts for name in _REFERENCE.findall(text)}


def _prune(parent: ElementTree.Element, used: set[str]) -> None:
    """Drop what nobody sees: metadata, style sheets, unused ids and definitions, empty shapes."""
    for child in list(parent):
        if child.get("id") not in used:
            child.attrib.pop("id", None)
        _prune(child, used)
        unused = parent.tag == "defs" and "id" not in child.attrib
        invisible = child.tag == "path" and child.get("style") == "fill: none"
        empty = child.tag in {"g", "defs"} and len(child) == 0
        if child.tag in {"metadata", "style"} or unused or invisible or empty:
            parent.remove(child)


def _merge_markers(root: ElementTree.Element) -> None:
    """Turn a cloud of round markers into one path: 3,000 points then cost 40 kB, not 300 kB."""
    shapes = {path.get("id"): path.get("d", "") for path in root.iter("path")}
    for group in root.iter("g"):
        uses = group.findall("use")
        looks = {(use.get("href", "")[1:], use.get("style", "")) for use in uses}
        if len(uses) < _MANY_MARKERS or len(uses) != len(group) or len(looks) != 1:
            continue
        shape, look = looks.pop()
        circle = _CIRCLE.fullmatch(shapes.get(shape, ""))
        colour = re.search(r"fill: (#[0-9a-f]{6})", look)
        if not circle or not colour:
            continue
        opacity = re.search(r"(?<![\w-])(?:fill-)?opacity: ([\d.]+)", look)
        for use in uses:
            group.remove(use)
        dots = "".join(f"M{_short(u.get('x', ''), 1)} {_short(u.get('y', ''), 1)}h0" for u in uses)
        style = f"fill: none; stroke: {colour[1]}; stroke-width: {2 * float(circle[1]):g}"
        style += "; stroke-linecap: round"
        style += f"; stroke-opacity: {opacity[1]}" if opacity else ""
        ElementTree.SubElement(group, "path", {"d": dots, "style": style})


def _tidy(element: ElementTree.Element, prefix: str) -> None:
    digits = 1 if len(element.get("d", "")) > _LONG_PATH else 2
    for key, text in list(element.attrib.items()):
        if key in {"d", "x", "y", "width", "height", "transform"}:
            element.set(key, _short(text, digits))
        elif key == "id":
            element.set(key, prefix + text)
        elif key in {"href", "clip-path"}:
            element.set(key, text.replace("#", f"#{prefix}"))
    if "d" in element.attrib:
        element.set("d", re.sub(r"\s*([A-Za-z])\s*", r"\1", element.get("d", "")).strip())
    if element.get("transform", "").startswith("rotate(-0 "):
        del element.attrib["transform"]
    if "style" in element.attrib:
        # The page, or the root of a file, chooses the face.
        rules = re.sub(r"font-family: [^;]*;? ?", "", element.get("style", ""))
        element.set("style", re.sub(r"([:;]) ", r"\1", rules).rstrip("; "))
    if element.tag not in {"text", "tspan"}:
        element.text = None
    element.tail = None


def _let_flow(text: ElementTree.Element) -> None:
    """Join the letters of mathtext, each of which stands where that of another face would.

    What is above or below the line is moved by ``dy``, and the next piece moved back.
    """
    letters = sorted(text.findall("tspan"), key=lambda letter: float(letter.get("x", "0")))
    for letter in letters:
        text.remove(letter)
        text.text = None
    line, last = "", text
    for letter in letters:
        height, look = letter.get("y", "0"), _FILL.sub("", letter.get("style", "")).rstrip(";")
        if height == line and look == last.get("style"):
            last.text = f"{last.text or ''}{letter.text or ''}"
            continue
        move = {"dy": f"{float(height) - float(line):.3f}"} if line else {"x": "0.0", "y": height}
        place = {key: _short(value, 2) for key, value in move.items() if float(value) or not line}
        last = ElementTree.SubElement(text, "tspan", {"style": look, **place})
        last.text, line = letter.text, height


def _short(text: str, digits: int) -> str:
    def rounded(match: re.Match[str]) -> str:
        number = f"{float(match[0]):.{digits}f}".rstrip("0").rstrip(".")
        return "0" if number == "-0" else number

    return _DECIMAL.sub(rounded, text)


def _variable(match: re.Match[str]) -> str:
    # matplotlib leaves some lines black, which a dark page would swallow.
    name = "ink" if match[0] == "#000000" else theme.VARIABLES.get(match[0])
    return f"var(--{name})" if name else match[0]
