"""Inline HTML that is safe: all text is escaped, and a small markup gives it symbols and weight."""

import html
import re
from collections.abc import Iterable
from types import MappingProxyType
from typing import Final
from xml.etree import ElementTree

from markupsafe import Markup, escape

from stickslip.errors import InputError
from stickslip.formatting import unbroken
from stickslip.identification import Estimate

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
    r"\$(?P<symbol>[A-Za-z][A-Za-z0-9_+-]*)\$"
    r"|\*\*(?P<bold>\S(?:.*?\S)?)\*\*"
    r"|`(?P<code>[^`]+)`"
    r"|\^\{(?P<sup>[^{}]*)\}"
    r"|_\{(?P<sub>[^{}]*)\}"
    r"|(?P<raised>[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)",
    re.DOTALL,
)
_FUNCTION: Final = re.compile(r"[A-Za-z]{2,}")
THIN: Final = "0.17em"
"""Space about the name of a function, which some browsers set too wide and some not at all."""
_TAGS: Final = MappingProxyType(
    {"bold": "b", "code": "code", "sup": "sup", "sub": "sub", "raised": "sup"}
)
_RAISED: Final = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "−0123456789")


def symbol(name: str) -> Markup:
    """Return a symbol as HTML: an italic letter with an upright subscript.

    Examples
    --------
    >>> print(symbol("mu_d"), symbol("F_v-"))
    <i class="v">μ</i><sub>d</sub> <i class="v">F</i><sub>v−</sub>
    """
    letter, subscript = _parts(name)
    below = Markup("<sub>{}</sub>").format(subscript) if subscript else ""
    return Markup('<i class="v">{}</i>{}').format(letter, below)


def symbol_text(name: str) -> str:
    """Return a symbol as plain text, for terminals.

    Unicode has only some letters as subscripts, so that all of them follow an underscore.

    Examples
    --------
    >>> symbol_text("sigma_0"), symbol_text("mu_d")
    ('σ₀', 'μ_d')
    """
    letter, subscript = _parts(name)
    return lowered(letter, subscript) if subscript else letter


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
    found = [""]
    for piece in latex.split(r"\quad"):
        last = found[-1]
        if any(last.count(opened) != last.count(closed) for opened, closed in pairs):
            found[-1] += rf"\quad{piece}"
        else:
            found.append(piece)
    return tuple(part.strip() for part in found if part.strip())


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


def typeset(text: str, symbols: Iterable[str]) -> str:
    """Return text whose symbols stand between dollar signs, which the page typesets.

    Minus signs become true ones. A single letter is left alone: it may be a word or a unit.

    Examples
    --------
    >>> typeset("mu_- and sigma_- trade off (-0.98).", ["mu_-", "sigma_-", "J"])
    '$mu_-$ and $sigma_-$ trade off (−0.98).'
    """
    text = re.sub(r"(?<![\w$.])-(?=\d)", "−", text)
    for name in sorted((s for s in symbols if "_" in s), key=len, reverse=True):
        text = re.sub(rf"(?<![\w$]){re.escape(name)}(?![\w$+-])", lambda m: f"${m[0]}$", text)
    return text


def label_of(estimate: Estimate) -> str:
    """Return a parameter in words with its symbol."""
    if estimate.path == "measurement.offset.friction":
        name = "Offset of the force sensor"
    else:
        name = estimate.path.rpartition(".")[2].replace("_", " ").capitalize()
    return f"{name} ${estimate.quantity.symbol}$"
