"""Laws without a part of which a record does not tell a parameter."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from stickslip.friction import containment_of, law, one_step_simpler
from stickslip.identification import RecordFit
from stickslip.kinds.joints.admissibility import unidentified
from stickslip.quantities import fields_of


def untold(fit: RecordFit) -> frozenset[str]:
    """Return the fields of a fitted law that the record does not tell, or not from a simpler law.

    An exponent whose interval has 1 in it is that of no power. Levels of both directions that may
    differ by a constant force alone are one.
    """
    known = {one.path.removeprefix("friction.") for one in fit.estimates}
    found = set(_untold_alone(fit))
    for term, gone in one_step_simpler(type(fit.law)):
        how = containment_of(type(fit.law), law(term))
        same = () if how is None else _sources(how.values, known).values()
        pairs = [sorted(names) for names in same if len(names) == 2 and names <= gone]
        if pairs and _are_one(fit, pairs):
            found |= set().union(*pairs)
    return frozenset(found)


def _untold_alone(fit: RecordFit) -> frozenset[str]:
    """Return those that are not told each by itself: directions are not compared."""
    known = {one.path.removeprefix("friction."): one for one in fit.estimates}
    found = set(unidentified(fit))
    for term, _ in one_step_simpler(type(fit.law)):
        how = containment_of(type(fit.law), law(term))
        for name, value in () if how is None else how.values.items():
            if name in known and not isinstance(value, str):
                found |= {name} if known[name].low <= value <= known[name].high else set()
    return frozenset(found)


def _sources(values: Mapping[str, float | str], known: Collection[str]) -> dict[str, set[str]]:
    """Return by parameter of a simpler law which of those of a richer one become it."""
    found: dict[str, set[str]] = {}
    for name, source in values.items():
        if isinstance(source, str) and name in known:
            found.setdefault(source, set()).add(name)
    return found


def _are_one(fit: RecordFit, pairs: Sequence[Sequence[str]]) -> bool:
    """Whether pairs of parameters may be equal, levels but for one constant force."""
    known, apart = fields_of(type(fit.law)), [{one: 1.0, other: -1.0} for one, other in pairs]
    if _may_be_0(fit, apart):
        return True
    levels = [
        weights for weights in apart if known[next(iter(weights))].scale in ("level+", "level-")
    ]
    others = [weights for weights in apart if weights not in levels]
    shifts = [{**one, **{name: -x for name, x in levels[0].items()}} for one in levels[1:]]
    return len(apart) > 1 and _may_be_0(fit, [*shifts, *others])


def _may_be_0(fit: RecordFit, sums: Sequence[Mapping[str, float]]) -> bool:
    """Whether sums of weighted parameters of the law may all be 0 at once.

    Of one sum by its interval; of several by an ellipsoid that is wider than one of 95 %, as what
    it allows becomes a candidate, and predictions decide.
    """
    known = {one.path.removeprefix("friction."): one for one in fit.estimates}
    names = sorted(set().union(*sums))
    weights = np.array([[one.get(name, 0.0) for name in names] for one in sums])
    half = np.array([0.5 * (known[name].high - known[name].low) for name in names])
    if not np.isfinite(half).all():
        return False
    rows = [fit.free_parameters.paths.index(known[name].path) for name in names]
    shared = half * fit.inference.correlation[np.ix_(rows, rows)] * half[:, None]
    value = weights @ [known[name].value for name in names]
    away = value @ np.linalg.pinv(weights @ shared @ weights.T, hermitian=True) @ value
    return bool(away <= len(sums))
