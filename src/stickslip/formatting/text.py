"""Words of sentences: lists, counts, and where a page must not end a line."""

import json
import re
from collections.abc import Sequence
from typing import Final

NO_BREAK_SPACE: Final = "\N{NO-BREAK SPACE}"
_WORDS: Final = [
    "no",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
]
_UNIT: Final = (
    r"(?:1/)?(?:(?:[kmµMG]?(?:m|s|N|J|Pa|rad|Hz|W|V|g)|K|°C)(?![A-Za-z])"
    r"[²³⁴⁻¹]*(?:\^\d)?/?)+(?![A-Za-z\d])"
)
_WITHIN: Final = re.compile(
    rf"(?<=[\d)⁰¹²³⁴⁵⁶⁷⁸⁹])(?: {_UNIT})+"  # a number and its unit
    r"|(?<=[\d)]) (?=[%±×✓!](?![A-Za-z]))"
    r"|(?<=[±×]) (?=\d)"
    r"|(?<=\$) = (?=[\d(−])"  # a symbol and its value
)


_HIDDEN: Final = re.compile(
    "[\x00-\x1f\x7f-\x9f"  # control characters, with which terminals are steered
    "\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"  # turn the direction of what follows
    "\u2028\u2029\ufeff\ufff9-\ufffb\U000e0000-\U000e007f"
    "\ud800-\udfff]"  # halves of characters: bytes of a file name that are no text
)


def printable(text: str, *, lines: bool = False) -> str:
    r"""Return a text of unknown origin as it may go to a terminal or a page.

    Characters that steer a terminal, turn the direction of writing or are no characters are
    replaced by their escapes, which JSON knows too.

    Examples
    --------
    >>> print(printable("\x1b[31mred, \u202edesrever"))
    \u001b[31mred, \u202edesrever
    >>> print(printable("one\ntwo"))
    one\ntwo
    """
    return _HIDDEN.sub(
        lambda found: found[0] if lines and found[0] in "\n\t" else json.dumps(found[0])[1:-1], text
    )


def unbroken(text: str) -> str:
    r"""Return a text whose lines do not end within a number and its unit, as pages want it.

    Examples
    --------
    >>> unbroken("158 ± 4 N s/m at (2.5 ± 0.2) × 10⁻⁷ m")
    '158\xa0±\xa04\xa0N\xa0s/m at (2.5\xa0±\xa00.2)\xa0×\xa010⁻⁷\xa0m'
    >>> unbroken("5 samples in 2 s, in 3 ways")
    '5 samples in 2\xa0s, in 3 ways'
    """
    return _WITHIN.sub(lambda match: match[0].replace(" ", NO_BREAK_SPACE), text)


def count(size: int, word: str, many: str = "") -> str:
    """Return how many of something there are.

    Examples
    --------
    >>> count(1, "sample"), count(24841, "sample"), count(0, "gap")
    ('1 sample', '24,841 samples', 'no gaps')
    """
    return f"1 {word}" if size == 1 else f"{f'{size:,}' if size else 'no'} {many or word + 's'}"


def in_words(size: int) -> str:
    """Return a small whole number in words.

    Examples
    --------
    >>> in_words(5), in_words(25)
    ('five', '25')
    """
    return _WORDS[size] if 0 <= size < len(_WORDS) else f"{size:,}"


def joined(parts: Sequence[str]) -> str:
    """Return a list as it stands in a sentence.

    Examples
    --------
    >>> joined(["Dahl", "LuGre", "Stribeck"]), joined(["Dahl"]), joined([])
    ('Dahl, LuGre and Stribeck', 'Dahl', '')
    """
    return f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else "".join(parts)


def capital(text: str) -> str:
    """Return a text with its first letter in upper case, the others as they are.

    Examples
    --------
    >>> capital("viscous and LuGre")
    'Viscous and LuGre'
    """
    return text[:1].upper() + text[1:]


def lower_first(text: str) -> str:
    """Return a text with its first letter in lower case, the others as they are.

    Examples
    --------
    >>> lower_first("The rig: mass and stiffness.")
    'the rig: mass and stiffness.'
    """
    return text[:1].lower() + text[1:]


def parameter_words(path: str) -> str:
    """Return the name of a parameter in words, as it stands within a sentence.

    Examples
    --------
    >>> parameter_words("friction.kinetic_coefficient"), parameter_words("stribeck_velocity")
    ('kinetic coefficient', 'Stribeck velocity')
    """
    return path.rpartition(".")[2].replace("_", " ").replace("stribeck", "Stribeck")
