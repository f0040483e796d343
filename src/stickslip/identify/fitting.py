"""A fit of one law: the selection in which no other law is compared.

What a law shares with the vocabulary is judged as a family of it; a law of any other form, or one
of which some parameters are held, is linear about the values at which it fits best. Numbers,
sentences and model error are those of `select` with that law alone.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.candidates import in_sentence
from stickslip.identify.compared import MAY_BE_HELD, LawToFit, untold_states
from stickslip.identify.fits import LAW, check_varied, refuse_open
from stickslip.identify.own_laws import OwnLaw, starting
from stickslip.identify.verdict import BandVerdict, LawFit
from stickslip.mechanisms import Mechanism
from stickslip.quantities import fields_of
from stickslip.show.formatting import number, with_unit

OPTIONAL = frozenset({"static_coefficient", "break_away_coefficient"})
"""Parameters that sliding does not tell, and that laws may have beside a family."""


class NoLawError(InputError):
    """What was measured shows no friction that the law describes."""


def fitted_law(
    select: Callable[[Sequence[Any]], BandVerdict],
    law: FrictionLaw | type[FrictionLaw],
    *,
    free: Sequence[str] | None,
    known: Mapping[str, float],
    load: float,
    unknown: Sequence[str] = (),
) -> LawFit:
    """Return the fit of one law, by what selects among laws.

    Of the law the parameters `free` are found (paths), its default if None; others have `known`
    values, their own or usual ones under the load [N]. Where parameters of the mechanism are
    `unknown`, all of the law may be held.
    """
    kind = law if isinstance(law, type) else type(law)
    names = names_to_find(kind, free, known)
    check_varied(len(names) + len(unknown))
    if isinstance(law, type):
        refuse_open(law, {*names, *known})
    given = {} if isinstance(law, type) else {name: getattr(law, name) for name in fields_of(kind)}
    held = {**{n: x for n, x in given.items() if x is not None and n not in names}, **known}
    to_fit = LawToFit(kind=kind, varied=names, held=held)
    plain = all(name in OPTIONAL or (name in MAY_BE_HELD and x == 1.0) for name, x in held.items())
    if names and to_fit.is_family and plain:
        verdict = select([to_fit])
        fit = _as(verdict, kind, held)
        if fit is not None:
            return _said(fit, verdict)
    if kind.states:
        usual = names_to_find(kind, None, ())
        needed = {*held} - {*OPTIONAL, *(name for name in MAY_BE_HELD if held.get(name) == 1.0)}
        raise untold_states(kind, needed & {*usual})
    as_it_is = isinstance(law, type) and not known
    own = to_fit if as_it_is else OwnLaw(law=starting(law, known, load), varied=names)
    verdict = select([own])
    result = _as(verdict, kind, {})
    if result is None:
        raise NoLawError(f"{kind.title} friction has no values here: {_why_none(verdict, kind)}.")
    return _said(result, verdict)


def _why_none(verdict: BandVerdict, kind: type[FrictionLaw]) -> str:
    """Return why a verdict has no values of the law that was to be fitted."""
    fit = _named(verdict)
    if fit is None or kind.directional or not fit.law.directional:
        return in_sentence(verdict.words.verdict).rstrip(".")
    return (
        "beside the constant force as it is held, the levels of the two directions differ. Let the"
        f" offset be found instead of holding it, or fit {type(fit.law).name!r}"
    )


def _said(fit: LawFit, verdict: BandVerdict) -> LawFit:
    """Return a fit with what is said of it."""
    left_out = offset_left_out(
        fit.law, fit.mechanism, [estimate.path for estimate in fit.estimates]
    )
    return replace(fit, verdict=verdict, remarks=(*fit.remarks, *left_out))


def offset_left_out(
    law: FrictionLaw, mechanism: Mechanism, paths: Collection[str]
) -> tuple[str, ...]:
    """Return a sentence where a level for each direction stands for a constant force as well.

    Of the parameters with `paths` it is none.

    Half the sum of the levels acts against the motion and half their difference always one way, so
    a constant force beside them is the same number twice.
    """
    fitted = any(path in paths for path in ("mechanism.offset", "offset"))
    if fitted or not law.directional:
        return ()
    own = float(getattr(mechanism, "offset", 0.0))
    unit = "N m" if getattr(mechanism, "rotary", False) else "N"
    held = with_unit(number(own), unit) if own else "0"
    return (
        "A constant force (gravity, a cable, a sensor offset) and different levels in the two"
        f" directions cannot be separated: the offset is fixed at {held} and absorbed"
        " into the two levels.",
    )


def names_to_find(
    kind: type[FrictionLaw], free: Sequence[str] | None, known: Collection[str]
) -> tuple[str, ...]:
    """Return the names of the parameters that are found.

    Examples
    --------
    >>> from stickslip import CoulombViscous
    >>> names_to_find(CoulombViscous, None, {"viscous_coefficient"})
    ('kinetic_coefficient',)
    """
    usual = kind.fit_order or tuple(name for name, item in fields_of(kind).items() if item.scale)
    result = list[str]()
    for path in (LAW,) if free is None else free:
        result += usual if path == LAW else [path.removeprefix("friction.")]
    return tuple(name for name in dict.fromkeys(result) if name not in known)


def _named(verdict: BandVerdict) -> LawFit | None:
    """Return the fit of the law that a verdict names, if it has one."""
    fits = (candidate.fit for candidate in verdict.candidates if candidate.outcome == "named")
    return next(fits, None)


def _as(verdict: BandVerdict, kind: type[FrictionLaw], held: Mapping[str, float]) -> LawFit | None:
    """Return the fit of a verdict as a law of some type; None if it is no such law."""
    fit = _named(verdict)
    if fit is None:
        return None
    names = fields_of(kind)
    values = {name: getattr(fit.law, name) for name in fields_of(type(fit.law)) if name in names}
    with suppress(InputError, TypeError):
        law = kind(**{**held, **{name: x for name, x in values.items() if x is not None}})
        known = {estimate.path.rpartition(".")[2] for estimate in fit.estimates}
        if type(fit.law) is kind or {*values} >= known & {*names}:
            return replace(fit, law=law)
    return None
