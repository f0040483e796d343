"""Which laws a measurement is compared with, and how their comparison is watched."""

from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TypeAlias

from stickslip.errors import InputError
from stickslip.friction import (
    CandidateSpec,
    Coulomb,
    FrictionLaw,
    contained_laws,
    containment_of,
    specification,
    usual_specifications,
)

REFERENCE = "coulomb-viscous"
"""What is always used: the row that others are compared with."""
CONTROL = "no-friction"
"""What shows how much friction matters at all."""
LEFT_OUT = "skipped: the search was stopped"
"""Why a candidate has no fit whose turn did not come."""
Watch: TypeAlias = Callable[[str, float], object]
"""Called with a candidate and the least residual so far, not a number before it begins.

False ends the search of a candidate that has begun, and leaves out one that has not. Judging, of
which each candidate is told as ``"held-out blocks: <its name>, 2 of 10"``, is never cut short: what
was compared on other blocks than the rest could not be ranked.
"""


def specifications(
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
) -> tuple[CandidateSpec, ...]:
    """Return the candidates: those given, or all that records may be compared with by default.

    A name stands for the candidate of that name, or for a law with all it can fit.

    Examples
    --------
    >>> [one.name for one in specifications(None)][:3]
    ['viscous', 'coulomb', 'coulomb-viscous']
    >>> [one.title for one in specifications(["coulomb", "dahl-exponent"])]
    ['Coulomb', 'Dahl with exponent']
    """
    if laws is None:
        return usual_specifications()
    if isinstance(laws, Mapping):
        found = [CandidateSpec.of(name, law) for name, law in laws.items()]
    else:
        found = [
            specification(one) if isinstance(one, str) else CandidateSpec.of(one.name, one)
            for one in laws
        ]
    check_any(found)
    check_apart([one.name for one in found])
    return tuple(found)


def check_any(laws: Collection[object]) -> None:
    """Refuse to compare no laws at all."""
    if not laws:
        raise InputError("no friction law was given: name at least one in `laws`.")


def check_apart(names: Sequence[str]) -> None:
    """Refuse candidates of one name, of which results would tell only one.

    Examples
    --------
    >>> check_apart(["coulomb", "viscous"])
    """
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise InputError(
            f"two of `laws` are called {twice[0]!r}: give a mapping with a name for each, such as"
            f' {{"{twice[0]}-a": ..., "{twice[0]}-b": ...}}.'
        )


def contains(rich: CandidateSpec, simple: CandidateSpec) -> bool:
    """Whether a candidate is another one for some values of what is looked for.

    Examples
    --------
    >>> by_name = {one.name: one for one in specifications(None)}
    >>> contains(by_name["dahl-exponent"], by_name["dahl"])
    True
    >>> contains(by_name["lugre"], by_name["dahl-exponent"])
    False
    """
    kinds = [one.law if isinstance(one.law, type) else type(one.law) for one in (rich, simple)]
    free, fewer = (
        set(kind.fit_order if one.free is None else one.free)
        for kind, one in zip(kinds, (rich, simple), strict=True)
    )
    if kinds[0] is kinds[1]:
        return fewer < free
    how = containment_of(kinds[0], kinds[1])
    if how is None:
        return kinds[1].name in contained_laws(kinds[0])
    held = {source for name, source in how.values.items() if name not in free}
    return not (held | set(how.where)) & fewer


def control() -> CandidateSpec:
    """Return the candidate without friction."""
    law = Coulomb(kinetic_coefficient=0.0)
    return CandidateSpec(name=CONTROL, title="No friction", law=law, free=())
