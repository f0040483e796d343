"""Text of pages: inline HTML that is safe, symbols, and equations in LaTeX.

All text is escaped; a small markup gives it symbols and weight. Equations become MathML for pages,
cut into branches where they have some, and plain text for terminals.
"""

import html
import re
from types import MappingProxyType
from typing import Any, Final, NamedTuple
from unicodedata import normalize
from xml.etree import ElementTree

from markupsafe import Markup, escape

from stickslip.errors import InputError
from stickslip.friction import PrintedForm, RightEquation
from stickslip.show.formatting import unbroken

# Inline HTML that is safe: all text is escaped, and a small markup gives it symbols and weight.

_GREEK: Final = MappingProxyType(
    {"alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ"}
    | {"eta": "η", "theta": "θ", "iota": "ι", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν"}
    | {"xi": "ξ", "omicron": "ο", "pi": "π", "rho": "ρ", "sigma": "σ", "tau": "τ"}
    | {"upsilon": "υ", "phi": "φ", "chi": "χ", "psi": "ψ", "omega": "ω", "Gamma": "Γ"}
    | {"Delta": "Δ", "Theta": "Θ", "Lambda": "Λ", "Xi": "Ξ", "Pi": "Π", "Sigma": "Σ"}
    | {"Phi": "Φ", "Psi": "Ψ", "Omega": "Ω"}
)
_PLAIN: Final = "0123456789+−"
_SUBSCRIPTS: Final = MappingProxyType(str.maketrans(_PLAIN, "₀₁₂₃₄₅₆₇₈₉₊₋"))
_SUPERSCRIPTS: Final = MappingProxyType(str.maketrans(_PLAIN, "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻"))
_TOKEN: Final = re.compile(
    r"\$(?P<symbol>[A-Za-z][A-Za-z0-9_+-]*(?: - [A-Za-z][A-Za-z0-9_+-]*)*)\$"
    r"|\*\*(?P<bold>\S(?:.*?\S)?)\*\*"
    r"|`(?P<code>[^`]+)`"
    r"|\^\{(?P<sup>[^{}]*)\}"
    r"|_\{(?P<sub>[^{}]*)\}"
    r"|(?P<raised>[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)",
    re.DOTALL,
)
DIFFERENCE: Final = " - "
"""Stands between symbols of which one is taken from another."""
_FUNCTION: Final = re.compile(r"[A-Za-z]{2,}")
THIN: Final = "0.17em"
"""Space about the name of a function, which some browsers set too wide and some not at all."""
_TAGS: Final = MappingProxyType(
    {"bold": "b", "code": "code", "sup": "sup", "sub": "sub", "raised": "sup"}
)
_RAISED: Final = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "−0123456789")


def symbol(name: str) -> Markup:
    """Return a symbol, or a difference of them, as HTML: italic letters, upright subscripts.

    Examples
    --------
    >>> print(symbol("mu_d"), symbol("F_v-"), symbol("a - b"))
    <i class="v">μ</i><sub>d</sub> <i class="v">F</i><sub>v−</sub> <i class="v">a</i> − ...
    """
    result = []
    for letter, subscript in map(_parts, name.split(DIFFERENCE)):
        below = Markup("<sub>{}</sub>").format(subscript) if subscript else ""
        result.append(Markup('<i class="v">{}</i>{}').format(letter, below))
    return Markup(" − ").join(result)


def symbol_text(name: str) -> str:
    """Return a symbol as plain text, for terminals.

    Unicode has only some letters as subscripts, so that all of them follow an underscore.

    Examples
    --------
    >>> symbol_text("sigma_0"), symbol_text("mu_d"), symbol_text("a - b_2")
    ('σ₀', 'μ_d', 'a − b₂')
    """
    parts = map(_parts, name.split(DIFFERENCE))
    return " − ".join(lowered(letter, below) if below else letter for letter, below in parts)


def lowered(text: str, subscript: str) -> str:
    """Return plain text with a subscript."""
    if set(subscript) <= set(_PLAIN):
        return text + subscript.translate(_SUBSCRIPTS)
    return f"{text}_{subscript}"


def raised(text: str, superscript: str) -> str:
    """Return plain text with a superscript."""
    if set(superscript) <= set(_PLAIN):
        return text + superscript.translate(_SUPERSCRIPTS)
    return f"{text}^{superscript if len(superscript) == 1 else f'({superscript})'}"


def inline(text: str) -> Markup:
    r"""Return text as HTML, escaped but for a small markup.

    ``$mu_d$`` is a symbol, ``**bold**`` and backticks are what they look like, ``^{2}`` and
    ``_{2}`` stand above and below the line. A number is not parted from its unit by a line break.

    Examples
    --------
    >>> print(inline("**Rest**: $v$ < 10^{-6} m/s"))
    <b>Rest</b>: <i class="v">v</i> &lt; 10<sup>-6</sup> m/s
    >>> inline("10 N for 0.1 s")
    Markup('10\xa0N for 0.1\xa0s')
    """
    if isinstance(text, Markup):
        return text
    text = unbroken(text)
    out, end = Markup(), 0
    for match in _TOKEN.finditer(text):
        out += escape(text[end : match.start()]) + _token(match)
        end = match.end()
    return out + escape(text[end:])


def plain(text: str) -> str:
    """Return the same text without tags, for titles and labels.

    Examples
    --------
    >>> plain("**Rest**: $mu_d$ < 1")
    'Rest: μ_d < 1'
    """
    if not isinstance(text, Markup):
        text = _TOKEN.sub(_plain_token, text)
        return text
    return text.striptags()


def equation_parts(latex: str) -> tuple[str, ...]:
    r"""Return an equation cut where it may go on in a new line: at wide spaces outside of groups.

    Examples
    --------
    >>> equation_parts(r"F = 0, \quad v < 1")
    ('F = 0,', 'v < 1')
    """
    pairs = (("{", "}"), (r"\begin", r"\end"), (r"\left", r"\right"))
    result = [""]
    for piece in latex.split(r"\quad"):
        last = result[-1]
        if any(last.count(opened) != last.count(closed) for opened, closed in pairs):
            result[-1] += rf"\quad{piece}"
        else:
            result.append(piece)
    return tuple(part.strip() for part in result if part.strip())


def mathml(latex: str, *, display: bool = True) -> Markup:
    r"""Return an equation as MathML.

    Examples
    --------
    >>> print(mathml(r"F = \mu_d N", display=False)[:46])
    <math display="inline"><mrow><mi>F</mi><mo>=</
    """
    root = math_tree(latex, display=display)
    return Markup(ElementTree.tostring(root, encoding="unicode"))


def math_tree(latex: str, *, display: bool = True) -> ElementTree.Element:
    """Return an equation as the tree of its MathML, entities resolved."""
    from latex2mathml.converter import convert_to_element

    try:
        root = convert_to_element(latex, display="block" if display else "inline")
    except Exception as error:  # each of its exceptions stands alone
        raise InputError(f"cannot read the equation {latex!r}: {type(error).__name__}.") from error
    # The converter writes entities as text and lets a caller unescape the whole, tags included.
    for element in root.iter():
        element.text = html.unescape(element.text) if element.text else None
        for key in ("xmlns", "href", "style"):
            element.attrib.pop(key, None)
        if element.tag == "mo" and element.text in {"|", "/"}:
            # Browsers space these like signs of relation, whatever stands beside them.
            element.attrib |= {"lspace": "0", "rspace": "0"}
        if (element.text or "").startswith("\\"):
            raise InputError(f"cannot read the equation {latex!r}: {element.text} is not known.")
    for element in root.iter():
        row = [None, *element, None]
        for before, child, after in zip(row, element, row[2:], strict=False):
            if child.tag in {"mi", "mo"} and _FUNCTION.fullmatch(child.text or ""):
                child.tag = "mo"
                child.set("lspace", "0" if _is_bracket(before) else THIN)
                child.set("rspace", "0" if _is_bracket(after) else THIN)
    return root


def _is_bracket(element: ElementTree.Element | None) -> bool:
    return element is None or element.text == "("


def _parts(name: str) -> tuple[str, str]:
    letter, _, subscript = name.partition("_")
    if not letter:
        raise InputError(f"a symbol begins with a letter, got {name!r}.")
    below = "".join(_GREEK.get(part, part) for part in re.split(r"([^A-Za-z]+)", subscript))
    return _GREEK.get(letter, letter), below.replace("-", "−").replace("_", ",")


def _token(match: re.Match[str]) -> Markup:
    kind, content = match.lastgroup or "", match[match.lastgroup or 0]
    if kind == "symbol":
        return symbol(content)
    if kind == "raised":
        content = content.translate(_RAISED)  # fonts draw the small digits unlike each other
    inner = inline(content) if kind == "bold" else escape(content)
    return Markup("<{0}>{1}</{0}>").format(Markup(_TAGS[kind]), inner)


def _plain_token(match: re.Match[str]) -> str:
    kind, content = match.lastgroup or "", match[match.lastgroup or 0]
    if kind == "symbol":
        return symbol_text(content)
    if kind in ("sub", "sup"):
        return (lowered if kind == "sub" else raised)("", content)
    return plain(content) if kind == "bold" else content


# Equations in LaTeX, cut into branches for the page and set as plain text for terminals.

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
    result = _CASES.fullmatch(latex)
    if result is None:
        return None
    rows = [re.split(r"(?<!\\)&", row) for row in result[2].split(r"\\") if row.strip()]
    width = max(map(len, rows), default=0)
    cells = tuple(tuple(cell.strip() for cell in row + [""] * (width - len(row))) for row in rows)
    return Branches(result[1].strip(), cells, result[3].strip())


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
