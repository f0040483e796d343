"""The formula of a composition in LaTeX, put together from those of its parts."""

import functools
import re
from collections.abc import Iterable, Sequence

from stickslip.friction.composition import Composition, Leaf
from stickslip.friction.parts.base import Flow, Level, SmoothLevel

__all__ = ["formula_of"]

SGN = r"\operatorname{sgn} v"
GREEK = ("mu", "sigma", "alpha", "beta", "gamma", "rho", "theta")


def formula_of(c: Composition) -> str:
    r"""Return the formula of a composition.

    Examples
    --------
    >>> from stickslip.friction import law
    >>> law("level + viscous").formula.partition(",")[0]
    'F = \\mu_k N \\operatorname{sgn} v + \\sigma_2 v'
    """
    if c.directional and c.memory is None:
        ahead, back = (_force(c, side) for side in (0, 1))
        forward = ahead.replace(f" {SGN}", "")
        backward = f"-{back}".replace(f" {SGN}", "") if SGN in back else back
        return rf"F = \begin{{cases}} {forward} & v > 0 \\ {backward} & v < 0 \end{{cases}}"
    terms = [f"F = {_force(c)}"]
    if c.memory is not None:
        sides = (0, 1) if c.directional else (None,)
        curves = [" + ".join(_levels(c, c.inside, side)) for side in sides]
        same = len(set(curves)) == 1
        cases = rf"\begin{{cases}} {curves[0]} & v > 0 \\ {curves[-1]} & v < 0 \end{{cases}}"
        terms += [
            _placed(c, c.memory, c.memory.part.tex_where),
            f"g = {curves[0] if same else cases}",
        ]
    for leaf in (*c.inside, *c.outside):
        terms += [_placed(c, leaf, leaf.part.tex_where)] if leaf.part.tex_where else []
    terms += _rest(c)
    return r", \quad ".join(terms)


def _force(c: Composition, side: int | None = None) -> str:
    held = [] if c.memory is None else [f"{_placed(c, c.memory, c.memory.part.tex)} N"]
    for smooth in dict.fromkeys(leaf.sign and leaf.sign.part.tex for leaf in c.outside):
        own = [leaf for leaf in c.outside if (leaf.sign and leaf.sign.part.tex) == smooth]
        levels = _levels(c, own, side)
        text = levels[0] if len(levels) == 1 else rf"\left[{' + '.join(levels)}\right]"
        sign = (
            SGN
            if smooth is None
            else next(_placed(c, leaf.sign, smooth) for leaf in own if leaf.sign)
        )
        held += [f"{text} N {sign}"] if levels else []
    flows = [
        _placed(c, leaf, leaf.part.tex, side) for leaf in c.outside if isinstance(leaf.part, Flow)
    ]
    return " + ".join([*held, *flows])


def _levels(c: Composition, leaves: Iterable[Leaf], side: int | None = None) -> list[str]:
    return [
        _placed(c, leaf, leaf.part.tex, side)
        for leaf in leaves
        if isinstance(leaf.part, (Level, SmoothLevel)) and leaf.part.tex
    ]


def _rest(c: Composition) -> Sequence[str]:
    """Return what holds at rest, where that is one level."""
    chain = [
        (leaf, leaf.part.rest)
        for leaf in c.outside
        if isinstance(leaf.part, Level) and leaf.sign is None
    ]
    if c.memory is not None or not chain:
        return []
    symbols = [_placed(c, leaf, _tex(STANDARD[rest])) for leaf, rest in chain]
    text = rf"|F| \le {symbols[-1]} N \text{{ at rest}}"
    return (
        [text, rf"{symbols[-1]} \ge {symbols[-2]}"] if chain[-1][0].part.name == "peak" else [text]
    )


def _placed(c: Composition, leaf: Leaf, tex: str, side: int | None = None) -> str:
    """Return a part's LaTeX with the symbols and the argument that it has in this law."""
    text = tex.replace("{0}", c.argument)
    own = {one.name: one.quantity for one in leaf.part.parameters}
    for name in {*own, *leaf.names}:
        field = leaf.names.get(name, name)
        chosen = field if isinstance(field, str) else field[side or 0]
        one = c.fields.get(chosen)
        standard = own[name].symbol if name in own else STANDARD.get(name)
        if one is not None and standard is not None and one.quantity.symbol != standard:
            before, after = _tex(standard), _tex(one.quantity.symbol)
            there = rf"(\^)?(?<![A-Za-z\\]){re.escape(before)}(?![A-Za-z_])"
            text = re.sub(there, functools.partial(_raised, after), text)
    return text


STANDARD = {
    "kinetic_coefficient": "mu_k",
    "static_coefficient": "mu_s",
    "break_away_coefficient": "mu_b",
    "stribeck_velocity": "v_s",
    "fading_exponent": "n",
}
"""Symbols of parameters that parts take from each other."""


def _raised(symbol: str, match: re.Match[str]) -> str:
    return f"^{{{symbol}}}" if match[1] else symbol


def _tex(symbol: str) -> str:
    r"""Return a plain-text symbol in LaTeX.

    Examples
    --------
    >>> _tex("mu_k"), _tex("sigma_+"), _tex("v_s")
    ('\\mu_k', '\\sigma_+', 'v_s')
    """
    stem, underscore, index = symbol.partition("_")
    head = rf"\{stem}" if stem in GREEK else stem
    return f"{head}_{{{index}}}" if len(index) > 1 else head + underscore + index
