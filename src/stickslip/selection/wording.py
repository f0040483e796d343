"""Phrases that the verdicts of all routes share, so that one thing is said in one way."""

import itertools
from collections.abc import Collection, Sequence

from stickslip.experiments import Checks
from stickslip.formatting import Scale, joined, number, with_unit
from stickslip.selection.verdict import score_text

MOST = 3
"""Laws named in a sentence at most."""
NAMES = (
    *("Ambrósio", "BAM", "Bengisu", "Bliman", "Bouc", "Brown", "Coulomb", "Dahl", "GMS", "Haessig"),
    *("Hess", "LuGre", "Makkar", "Maxwell", "Popp", "Simscape", "Stribeck", "Threlfall", "Tustin"),
)
"""How titles begin that are names."""
NOT_DISTINGUISHED = "not distinguished"
"""Outcome of a candidate as good as the chosen one."""
ONE_LAW = "No ranking: one law was tried."
"""Where the candidates would be ranked."""
UNMEASURED = "Friction at speeds, loads and temperatures outside those measured is not known."
"""What no verdict can tell."""
TOO_SHORT = "effective size"
"""Kind of a finding that a longer record answers; no correction does."""


def corrections(checks: Checks, *, but: Collection[str] = ()) -> tuple[str, ...]:
    """Return what to correct in a record before anything else is measured, or what to measure.

    Examples
    --------
    >>> from stickslip.experiments import Finding
    >>> gap = Finding(kind="gap", sentence="Gap of 0.3 s after 12.5 s.", severity="warning")
    >>> corrections(Checks(findings=(gap,)))
    ('First correct the record: Gap of 0.3 s after 12.5 s.',)
    >>> short = Finding(
    ...     kind="length",
    ...     sentence="The record has only 15 samples.",
    ...     severity="warning",
    ...     measure="Record more samples",
    ... )
    >>> corrections(Checks(findings=(short,)))
    ('Record more samples: The record has only 15 samples.',)
    """
    warned = [
        one
        for one in checks.findings
        if one.severity == "warning" and one.kind not in (TOO_SHORT, *but)
    ]
    warned.sort(key=lambda one: bool(one.measure))  # what can be corrected comes first
    return tuple(
        f"{one.measure or 'First correct the record'}: {one.sentence}" for one in warned[:1]
    )


def longer(checks: Checks) -> tuple[str, ...]:
    """Return that a longer record is needed, if the samples are too few independent ones.

    Examples
    --------
    >>> from stickslip.experiments import Finding
    >>> numbers = {"samples": 3600, "independent": 17.2}
    >>> few = Finding(kind="effective size", sentence="", severity="warning", numbers=numbers)
    >>> longer(Checks(findings=(few,)))
    ('Record for longer: the effective sample size is 17 of 3,600 samples.',)
    """
    short = (one for one in checks.of(TOO_SHORT) if one.severity == "warning")
    return tuple(
        "Record for longer: the effective sample size"
        f"{f' of {one.record}' if one.record else ''} is {number(one.numbers['independent'], 2)}"
        f" of {number(one.numbers['samples'], 9)} samples."
        for one in itertools.islice(short, 1)
    )


def in_sentence(title: str) -> str:
    """Return a title as it stands within a sentence; names keep their capital.

    Examples
    --------
    >>> in_sentence("Direction-dependent"), in_sentence("Coulomb + viscous")
    ('direction-dependent', 'Coulomb + viscous')
    """
    return title if title.startswith(NAMES) else title[:1].lower() + title[1:]


def friction_of(title: str) -> str:
    """Return the friction of a law as one says it within a sentence.

    Examples
    --------
    >>> friction_of("Direction-dependent"), friction_of("Dahl with exponent")
    ('direction-dependent friction', 'Dahl friction with exponent')
    >>> friction_of("Stribeck by direction")
    'Stribeck friction by direction'
    >>> friction_of("Coulomb by position + viscous with a drag")
    'Coulomb friction by position + viscous with a drag'
    """
    joints = [one for one in (" by ", " with ") if one in title]
    joint = min(joints, key=title.index, default=" with ")
    kind, joint, more = in_sentence(title).partition(joint)
    noun = "" if kind.endswith("friction") else " friction"
    return f"{kind}{noun}{joint}{more}"


def not_distinguished(titles: Sequence[str], source: str, *, most: int = MOST) -> str:
    """Return the clause that laws are as good as the chosen one, `most` of them by name.

    Examples
    --------
    >>> not_distinguished(["Stribeck", "Viscous"], "this record")
    'this record does not distinguish it from Stribeck and viscous'
    >>> not_distinguished(["Dahl", "LuGre", "Stribeck", "Viscous"], "these readings")
    'these readings do not distinguish it from Dahl, LuGre and 2 more'
    """
    names = [in_sentence(title) for title in titles]
    if len(names) > most:
        names = [*names[: most - 1], f"{len(names) - most + 1} more"]
    verb = "do" if source.endswith("s") else "does"
    return f"{source} {verb} not distinguish it from {joined(names)}"


def held_out_text(scale: Scale, score: float | None, error: float | None, scored: str) -> str:
    """Return the sentence of a held-out error, with its standard error and what it is of.

    Examples
    --------
    >>> held_out_text(Scale(1e3, "mm"), 0.00060, 0.00007, "8 blocks, root mean square")
    'Held-out error: 0.60 ± 0.07 mm (8 blocks, root mean square).'
    """
    text = " ".join(score_text(scale, score, error)).strip()
    return f"Held-out error: {with_unit(text, scale.unit)} ({scored})."


def to_predict(name: str, doubt: str) -> str:
    """Return the verdict on a law that predicts, although some of its parameters are open.

    Examples
    --------
    >>> to_predict("LuGre friction", "$sigma_1$ is bounded on one side only")
    'Use LuGre friction to predict, but not all of its parameters are identified: $sigma_1$ ...'
    """
    return f"Use {name} to predict, but not all of its parameters are identified: {doubt}."


def on_second_record(error: str) -> str:
    """Return the clause of the error on a second record."""
    return f"On the second record: {error}"
