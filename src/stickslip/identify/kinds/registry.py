"""The kinds of measurement there are, and which of them a measurement is of."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache
from typing import Any, TypeAlias

from stickslip.data import Measurement, as_readings
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import law_type
from stickslip.identify.fits import called, check_inputs
from stickslip.identify.kinds.features import FeatureKind
from stickslip.identify.kinds.joints import JointKind
from stickslip.identify.kinds.kind import Kind, Request
from stickslip.identify.kinds.records import FrictionTableKind, RecordKind
from stickslip.identify.kinds.travels import TravelKind
from stickslip.identify.kinds.velocity_steps import VelocityStepKind
from stickslip.mechanisms import Mechanism
from stickslip.quantities import name_taken, plugins
from stickslip.show.formatting import joined

AnyKind: TypeAlias = Kind[Any, Any]

OWN: tuple[AnyKind, ...] = (
    FeatureKind(),
    TravelKind(),
    JointKind(),
    VelocityStepKind(),
    FrictionTableKind(),
    RecordKind(),
)
"""In the order in which they are asked."""


@cache
def kinds() -> tuple[AnyKind, ...]:
    """Return all kinds: those of other packages first, as they are the more special.

    Examples
    --------
    >>> {"travels", "velocity steps", "tables of friction"} <= {one.measured for one in kinds()}
    True
    """
    result: list[AnyKind] = []
    taken = {name for kind in OWN for name in kind.routes}
    base: type[Any] = Kind
    for where, kind in plugins("stickslip.kinds", base):
        if known := sorted(taken.intersection(kind.routes)):
            raise name_taken(where, joined(known))
        taken.update(kind.routes)
        result.append(kind())
    return (*result, *OWN)


def kind_of_route(name: str) -> AnyKind:
    """Return the kind that has a route.

    Examples
    --------
    >>> kind_of_route("balance").measured
    'records of motion or friction'
    """
    known = {each: kind for kind in kinds() for each in kind.routes}
    if name not in known:
        raise UnknownNameError("route", name, known)
    return known[name]


def kind_of(measurement: Measurement, asked: str | None = None) -> AnyKind:
    """Return the kind of a measurement: that of the route asked for, or the first that serves.

    Travels have no other route than their own, which then refuses to be asked for one.

    Examples
    --------
    >>> kind_of(Measurement(travel=0.2)).routes
    ('travel',)
    >>> record = Measurement(time=[0.0, 1.0, 2.0], spring_force=[0.1, 0.2, 0.3])
    >>> kind_of(record).routes, kind_of(record, "balance").routes
    (('features',), ('balance',))
    """
    usual = next(kind for kind in kinds() if kind.serves(measurement))
    if asked is None:
        return usual
    if asked in usual.routes:
        return usual
    result = kind_of_route(asked)
    if result.reads(measurement):
        return result
    if "route" in usual.uses and "route" not in result.uses:
        raise InputError(
            f"route {asked!r} applies to {result.measured}, not to this measurement: leave it out."
        )
    return result if "route" in usual.uses else usual


def as_judged(measurement: Measurement, asked: str | None = None) -> Measurement:
    """Return steady readings that have times as a table, if no route of records is asked for.

    Examples
    --------
    >>> v = [0.1, 0.2, 0.4] * 4
    >>> rows = Measurement(time=range(12), velocity=v, friction=v)
    >>> as_judged(rows).kind, as_judged(rows, "balance").kind
    ('friction-map', 'series')
    """
    timed = measurement.kind == "series" and (asked is None or asked in FrictionTableKind.routes)
    return as_readings(measurement) if timed else measurement


def refuse_unused(kind: AnyKind, given: Mapping[str, str], request: Request) -> None:
    """Refuse options that have no effect on a kind of measurement.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> request = Request(mechanism=SpringBlock(mass=1.0), measurement=Measurement(travel=0.2))
    >>> refuse_unused(kind_of_route("travel"), {"hold": "--hold"}, request)
    Traceback (most recent call last):
    stickslip.errors.InputError: --hold applies to records of several joints and records of ...
    """
    for name, called_ in given.items():
        if name == "route" and kind.reads(request.measurement):
            continue
        why = kind.why_unused(name, request)
        if not why and name not in kind.uses | kind.settings:
            users = [item for item in kinds() if name in item.uses | item.settings]
            why = unused_text(kind, users)
        if why:
            raise InputError(f"{called_} {why}")


def unused_text(kind: AnyKind, users: Iterable[AnyKind]) -> str:
    """Return that an option has no effect on a kind, as the end of a sentence with its name.

    Examples
    --------
    >>> unused_text(kind_of_route("travel"), [kind_of_route("features")])
    'applies to the force of a spring; it has no effect on travels: leave it out.'
    """
    others = joined([*dict.fromkeys(user.measured for user in users)])
    return f"applies to {others}; it has no effect on {kind.measured}: leave it out."


def refuse_foreign(kind: AnyKind, laws: Iterable[object]) -> None:
    """Refuse laws of another type than a kind fits; names are looked up where they are used.

    Examples
    --------
    >>> from stickslip.friction import Coulomb, RateState
    >>> refuse_foreign(kind_of_route("travel"), [Coulomb, RateState])
    Traceback (most recent call last):
    stickslip.errors.InputError: A fit to travels takes a FrictionLaw, its type or its name, got ...
    """
    for law in laws:
        given = law if isinstance(law, type) else type(law)
        if not issubclass(given, (str, kind.fits)):
            fitting = (item.measured for item in kinds() if issubclass(given, item.fits))
            others = joined([*dict.fromkeys(fitting)])
            use = f", which is for {others}" if others else ""
            raise InputError(
                f"A fit to {kind.measured} takes a {kind.fits.__name__}, its type or its name,"
                f" got {called(law)}{use}."
            )


def refuse_uninformed(
    kind: AnyKind, laws: Iterable[object], mechanism: Mechanism, measurement: Measurement
) -> None:
    """Refuse laws that ask for contact inputs which nothing tells, before anything runs."""
    known = kind.known_inputs(mechanism, measurement)
    for item in laws:
        law = item
        if isinstance(item, str):
            with suppress(InputError):
                law = law_type(item)
        check_inputs(law, mechanism, measurement, known)
