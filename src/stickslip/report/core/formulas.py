"""Equations in LaTeX, cut into branches for the page and set as plain text for terminals."""

import re
from typing import Any, Final, NamedTuple
from unicodedata import normalize
from xml.etree import ElementTree

from stickslip.errors import InputError
from stickslip.friction import PrintedForm, RightEquation
from stickslip.report.core.markup import equation_parts, lowered, math_tree, plain, raised

_CASES: Final = re.compile(r"(.*?)\\begin\{cases\}(.*)\\end\{cases\}(.*)", re.DOTALL)
_DOTS: Final = {"˙": "\N{COMBINING DOT ABOVE}", "¨": "\N{COMBINING DIAERESIS}"}
_OPENING, _CLOSING = "([{", ")]},"
_SPACED: Final = frozenset("=+−<>≤≥≠&")


class Branches(NamedTuple):
    """An equation with a brace: what stands before it, its rows of cells, what stands behind.

    Parameters
    ----------
    before : str
        LaTeX before the brace.
    rows : tuple of tuple of str
        LaTeX of the cells of each row; all rows have the same number.
    after : str
        LaTeX behind the rows.
    """

    before: str
    rows: tuple[tuple[str, ...], ...]
    after: str


def branches(latex: str) -> Branches | None:
    r"""Return the branches of an equation with a brace; None if it has none.

    Examples
    --------
    >>> branches(r"s = \begin{cases} 1 & v > 0 \\ 0 & v = 0 \end{cases}").rows
    (('1', 'v > 0'), ('0', 'v = 0'))
    """
    found = _CASES.fullmatch(latex)
    if found is None:
        return None
    rows = [re.split(r"(?<!\\)&", row) for row in found[2].split(r"\\") if row.strip()]
    width = max(map(len, rows), default=0)
    cells = tuple(tuple(cell.strip() for cell in row + [""] * (width - len(row))) for row in rows)
    return Branches(found[1].strip(), cells, found[3].strip())


def formula_text(latex: str) -> str:
    r"""Return an equation as plain text in Unicode, a line for each of its parts.

    Digits stand below the line, letters behind an underscore, since Unicode has few of them.

    Examples
    --------
    >>> print(
    ...     formula_text(
    ...         r"F = \begin{cases} \sigma_0 z & (\dot x \neq 0) \\ F_x & (\dot x = 0)"
    ...         r" \end{cases}, \quad z \le \frac{F_c}{\sigma_0}"
    ...     )
    ... )
    F = ⎧ σ₀ z  (ẋ ≠ 0)
        ⎩ F_x   (ẋ = 0),
    z ≤ F_c/σ₀
    """
    lines: list[str] = []
    for part in equation_parts(latex):
        cut = branches(part)
        if cut is None:
            text = _linear(part)
            lines.append(f"  {text[0]} {text[1:]}" if part.startswith("{}") else text)
            continue
        cells = [[_linear(cell) for cell in row] for row in cut.rows]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        before = _linear(cut.before)
        for index, row in enumerate(cells):
            middle = len(cells) // 2 if len(cells) % 2 else 0
            lead = before if index == middle else " " * len(before)
            brace = "⎧" if index == 0 else "⎩" if index == len(cells) - 1 else "⎨"
            text = "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip()
            lines.append(f"{lead} {brace} {text}")
        after = _linear(cut.after)
        lines[-1] += f"  {after}" if after[:1].isalpha() else after
    return normalize("NFC", "\n".join(lines))


def published_dict(form: type[PrintedForm] | RightEquation) -> dict[str, Any]:
    """Return what is known of an equation of the paper, ready for JSON; its formula in LaTeX."""
    return {
        "name": form.name,
        "title": form.title,
        "equation": form.equation,
        "as_printed": form.formula,
        "defect": plain(form.defect),
        "right": plain(form.right),
        "cure": plain(form.cure),
        "corrected_law": form.corrected.name if form.corrected else None,
    }


def _linear(latex: str) -> str:
    return normalize("NFC", _row(math_tree(latex))) if latex else ""


def _row(element: ElementTree.Element) -> str:
    """Set a row: signs between two terms have spaces, and so have factors."""
    text, last, bars = "", "", 0
    terms = [(child.tag, token) for child in _flat(element) if (token := _text(child))]
    for index, (tag, token) in enumerate(terms):
        beside = {last.strip(), *(other for _, other in terms[index + 1 : index + 2])}
        alone = tag == "mfrac" and token[0] == "(" and beside <= _SPACED | {""}
        piece = token[1:-1] if alone else token
        # A term begins after an opening bracket, a sign or nothing, and closes before a bracket.
        begins = not text or text[-1] in f" {_OPENING}" or (last == "|" and bars % 2 == 1)
        closes = piece[0] in _CLOSING or "/" in (piece, last)
        if piece in _SPACED:
            piece = piece if begins else f" {piece} "
        elif piece[0] == "|":
            closes |= bars % 2 == 1
            bars += 1
        elif piece == "(":
            closes |= _name(text)
        joined = begins or closes or piece[0] == " " or last == "d" or last in _SPACED
        text += piece if joined else f" {piece}"
        last = piece
    return text.strip()


def _name(text: str) -> bool:
    """Whether a text ends with the name of a function, so that its argument follows at once."""
    return bool(re.search(r"(?:\b[A-Za-z]{2,}|(?:^|[\s=])[FGg])$", text))


def _flat(element: ElementTree.Element) -> list[ElementTree.Element]:
    """Return the terms of a row, inner rows dissolved."""
    if element.tag not in {"math", "mrow", "mstyle"}:
        return [element]
    return [term for child in element for term in _flat(child)]


def _text(element: ElementTree.Element) -> str:
    parts = [_row(child) if child.tag in {"mrow", "mstyle"} else _text(child) for child in element]
    match element.tag:
        case "msub" | "munder" if element.tag == "msub" or element[0].tag == "mo":
            # what a sum is over stands under it
            return lowered(parts[0], parts[1].replace(" ", ""))
        case "msup":
            return raised(parts[0], parts[1])
        case "msubsup" | "munderover":
            return raised(lowered(parts[0], parts[1].replace(" ", "")), parts[2])
        case "msqrt" | "mroot":
            inner, *index = parts if element.tag == "mroot" else [" ".join(parts)]
            of = inner if re.fullmatch(r"\w+", inner) else f"({inner})"
            return f"{''.join(index) and raised('', index[0])}√{of}"
        case "mfrac" if not element.attrib:
            if parts == ["1", "2"]:
                return "½"
            above = f"({parts[0]})" if re.search(r".[+−]", parts[0]) else parts[0]
            below = f"({parts[1]})" if re.search(r"[ +−/]", parts[1]) else parts[1]
            whole = f"{above}/{below}"
            return whole if re.fullmatch(r"d\w/d\w", whole) else f"({whole})"
        case "mover" if parts[1] in _DOTS:
            return parts[0] + _DOTS[parts[1]]
        case "mi" | "mn" | "mo" | "mtext" | "mspace":
            return " ".join((element.text or "").split())  # also its spaces that do not break
    raise InputError(
        f"the formula cannot be set as plain text: of {''.join(element.itertext())!r} the element"
        f" {element.tag} is not known; write it with fractions, roots, powers and indices."
    )
