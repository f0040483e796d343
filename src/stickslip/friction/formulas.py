"""The formula of a composition in LaTeX, put together from those of its parts."""

import functools
import itertools
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import cast

from stickslip.contact_inputs import CONTACT_INPUTS
from stickslip.friction.composition import Composition, Leaf
from stickslip.friction.parts.base import Extra, Flow, Level, Memory, SmoothLevel

SGN = r"\operatorname{sgn} v"
GREEK = ("mu", "sigma", "alpha", "beta", "gamma", "rho", "theta", "xi")


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
        terms += [_placed(c, c.memory, c.memory.part.tex_where), f"g = {_cases(curves)}"]
        varies = any(leaf.inputs or leaf.factors or leaf.modulated for leaf in c.inside)
        if varies and cast(Memory, c.memory.part).limited:
            # inputs leave the limits of deflections as they are
            base = [leaf for leaf in c.inside if isinstance(leaf.part, Level)][-1:]
            rests = [
                _placed(
                    c,
                    replace(leaf, modulated={}),
                    _tex(STANDARD[cast(Level, leaf.part).rest]),
                    side,
                )
                for leaf in base
                for side in sides
            ]
            where = rf"g_0 = {_cases(rests)}" if base else r"g_0 = g(0) \text{ without inputs}"
            terms = [*(term.replace("g(0)", "g_0") for term in terms), where]
    for leaf in (*c.inside, *c.outside):
        terms += [_placed(c, leaf, leaf.part.tex_where)] if leaf.part.tex_where else []
    terms += _rest(c)
    return r", \quad ".join(terms)


def _cases(curves: Sequence[str]) -> str:
    """Return the LaTeX of both directions, or of one that holds in both."""
    if len(set(curves)) == 1:
        return curves[0]
    return rf"\begin{{cases}} {curves[0]} & v > 0 \\ {curves[-1]} & v < 0 \end{{cases}}"


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
    flows = [_term(c, leaf, side) for leaf in c.outside if isinstance(leaf.part, Flow)]
    return " + ".join([*held, *flows])


def _term(c: Composition, leaf: Leaf, side: int | None, tex: str = "") -> str:
    """Return the LaTeX of a part, or another one in its place, with its factors."""
    placed = _placed(c, leaf, tex or leaf.part.tex, side)
    factors = [_placed(c, one, one.part.tex, side) for one in leaf.factors]
    if factors and " + " in placed and not placed.startswith(BRACKETS):
        placed = rf"\left({placed}\right)"
    return r" \, ".join([placed, *factors])


BRACKETS = ("(", "|", r"\left", r"\frac")


def _levels(c: Composition, leaves: Iterable[Leaf], side: int | None = None) -> list[str]:
    return [
        _term(c, leaf, side)
        for leaf in leaves
        if isinstance(leaf.part, (Level, Extra, SmoothLevel)) and leaf.part.tex
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
    if any(leaf.factors for leaf, _ in chain):
        steps = (f"({one} - {before})" for before, one in itertools.pairwise(symbols))
        levels = zip((leaf for leaf, _ in chain), (symbols[0], *steps), strict=True)
        terms = [_term(c, leaf, None, tex) for leaf, tex in levels]
    else:
        terms = [symbols[-1]]
    extras = [leaf for leaf in c.outside if isinstance(leaf.part, Extra) and leaf.part.holds]
    terms += [_term(c, leaf, None, leaf.part.tex.replace(FADED, "")) for leaf in extras]
    whole = terms[0] if len(terms) == 1 else rf"\left[{' + '.join(terms)}\right]"
    text = rf"|F| \le {whole} N \text{{ at rest}}"
    return (
        [text, rf"{symbols[-1]} \ge {symbols[-2]}"] if chain[-1][0].part.name == "peak" else [text]
    )


FADED = " e^{-|v/v_s|^n}"
"""What parts fade with, which is 1 at rest."""


def _placed(c: Composition, leaf: Leaf, tex: str, side: int | None = None) -> str:
    """Return a part's LaTeX with the symbols and the argument that it has in this law."""
    of_input = leaf.part.argument == "input"
    x = CONTACT_INPUTS[leaf.inputs[0]] if of_input else None
    number = str(getattr(leaf.part, "degree", c.argument))
    text = tex.replace("{0}", x.tex if x else number).replace("{1}", x.index if x else "")
    own = {
        one.name: one.quantity.symbol.replace("{0}", x.index if x else "")
        for one in leaf.part.parameters
    }
    for name in {*own, *leaf.names, *leaf.modulated}:
        field = leaf.names.get(name, name)
        chosen = field if isinstance(field, str) else field[side or 0]
        one = c.fields.get(chosen)
        standard = own.get(name, STANDARD.get(name))
        factors = [_placed(c, leaf, leaf.part.tex, side) for leaf in leaf.modulated.get(name, ())]
        renamed = one is not None and one.quantity.symbol != standard
        if one is not None and standard is not None and (renamed or factors):
            before, after = _tex(standard), _tex(one.quantity.symbol)
            after = rf"({' '.join([after, *factors])})" if factors else after
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
