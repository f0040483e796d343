"""Names that programs of other languages accept, from symbols and titles of any spelling."""

import re
import unicodedata
from collections.abc import Collection, Sequence
from typing import Final

LONGEST: Final = 40
"""Characters of a name; MATLAB takes 63, of which a function's own suffix needs some."""
TEMPORARY: Final = re.compile(r"[csx]\d+")
"""Names of temporaries and of switches, which no symbol may have."""
RESERVED: Final = frozenset(
    """
    algorithm alignas alignof and annotation asm assert auto block bool boolean break case catch
    char class classdef complex connect connector const constant constexpr constrainedby
    continue decltype default delete der discrete do double each else elseif elsewhen
    encapsulated end enum equation eval expandable explicit export extends extern external false
    final float flow for friend function global goto if import imaginary impure in initial
    inline inner input int integer loop long model mutable namespace new noexcept not nullptr
    operator or otherwise outer output package parallel parfor partial persistent pre private
    protected public pure real record redeclare reinit register replaceable restrict return
    sample short signed sizeof spmd static string struct stream switch template terminal
    terminate then this throw time true try type typedef typeid typename typeof union unsigned
    unwind_protect using virtual void volatile when while within xor abs acos asin atan ceil cos
    cosh erf exp fabs floor fmax fmin gamma hypot isnan isinf j0 j1 jn lgamma log log10 max min
    mod pi pow rem round sign sin sinh sqrt tan tanh tgamma trunc y0 y1 yn ans eps i inf j nan
    nargin nargout NaN Inf NAN INFINITY HUGE_VAL NULL EOF I errno linux unix Boolean Integer
    Real String
    """.split()  # noqa: SIM905  # a list of texts would have a page of quotes
)
"""Words of C, C++, MATLAB and Modelica, and functions and constants that every file of them has."""


def identifier(text: str) -> str:
    """Return a text as a name of letters, digits and underscores that begins with a letter.

    Examples
    --------
    >>> [identifier(text) for text in ("mu_+", "σ_0", "my axis", "2nd joint", "double", "c1")]
    ['mu_plus', 'sigma_0', 'my_axis', 'p_2nd_joint', 'double_', 'c1_']
    """
    spelt = "".join(_spelt(character) for character in text.replace("+", "plus"))
    spelt = re.sub(r"-$", "minus", spelt.strip()).replace("'", "_prime")
    name = re.sub(r"\W+", "_", spelt, flags=re.ASCII).strip("_")[:LONGEST].rstrip("_") or "p"
    name = name if name[0].isalpha() else f"p_{name}"
    return f"{name}_" if name in RESERVED or TEMPORARY.fullmatch(name) else name


def identifiers(texts: Sequence[str], taken: Collection[str] = ()) -> tuple[str, ...]:
    """Return names of texts that differ from one another and from those that are taken.

    Examples
    --------
    >>> identifiers(["v", "mu", "mu'", "mu_prime"], taken=["v"])
    ('v_2', 'mu', 'mu_prime', 'mu_prime_2')
    """
    known = set(taken)
    found = []
    for text in texts:
        first = name = identifier(text)
        count = 1
        while name in known:
            count += 1
            name = f"{first}_{count}"
        known.add(name)
        found.append(name)
    return tuple(found)


def _spelt(character: str) -> str:
    """Return a Greek letter by its name, and others without their accent."""
    if character.isascii():
        return character
    words = unicodedata.name(character, "").split()
    if words[:1] == ["GREEK"] and "LETTER" in words:
        name = words[words.index("LETTER") + 1].lower().replace("lamda", "lambda")
        return name if "SMALL" in words else name.capitalize()
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return plain or "_"
