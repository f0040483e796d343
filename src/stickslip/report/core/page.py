"""A page as one self-contained HTML file: no script, no network, no web font."""

import re
from collections import Counter
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Final

from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup

from stickslip.documents import write_file
from stickslip.errors import InputError
from stickslip.formatting import printable, unbroken, unit_text
from stickslip.report.core import formulas, markup
from stickslip.report.core.blocks import Block
from stickslip.report.core.documents import Page

_STYLES: Final = ("tokens.css", "report.css")
_IDS: Final = re.compile(r"<[a-zA-Z][^>]* id=\"([^\"]+)\"")


def render(page: Page) -> str:
    """Return a page as one HTML file.

    Examples
    --------
    >>> from stickslip.report import Page, Paragraph, Section
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
    >>> from stickslip.report import Page, Paragraph, Section
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
def _environment() -> Environment:
    environment = Environment(
        loader=FunctionLoader(lambda name: _text(f"templates/{name}")),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "branches": formulas.branches,
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
    return Markup(
        _environment().get_template(f"blocks/{block.template}.html.j2").render(block=block)
    )


def _lines(text: str) -> Markup:
    """Return text with its markup, its line breaks kept."""
    return Markup("<br>").join(markup.inline(line) for line in text.split("\n"))


def _text(name: str) -> str:
    return resources.files("stickslip.report").joinpath(name).read_text(encoding="utf-8")
