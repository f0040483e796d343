"""The routes there are, and which of them serves a measurement."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache
from typing import Any, TypeAlias

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments import Measurement
from stickslip.formatting import joined
from stickslip.friction import law_type
from stickslip.identification import RouteChoice, called, check_inputs
from stickslip.mechanisms import Mechanism
from stickslip.quantities import name_taken, plugins
from stickslip.routes.features import FeatureRoute
from stickslip.routes.joints import JointRoute
from stickslip.routes.rate_state import RateStateRoute
from stickslip.routes.records import RecordRoute
from stickslip.routes.route import Options, Route
from stickslip.routes.travels import TravelRoute

AnyRoute: TypeAlias = Route[Any, Any]

OWN: tuple[AnyRoute, ...] = (
    FeatureRoute(),
    TravelRoute(),
    JointRoute(),
    RateStateRoute(),
    RecordRoute(),
)
"""In the order in which they are asked."""


@cache
def routes() -> tuple[AnyRoute, ...]:
    """Return all routes: those of other packages first, as they are the more special.

    Examples
    --------
    >>> [route.measured for route in routes()][-3:]
    ['records of several joints', 'velocity steps', 'records of motion or friction']
    """
    found: list[AnyRoute] = []
    taken = {name for route in OWN for name in route.names}
    base: type[Any] = Route
    for where, kind in plugins("stickslip.routes", base):
        if known := sorted(taken.intersection(kind.names)):
            raise name_taken(where, joined(known))
        taken.update(kind.names)
        found.append(kind())
    return (*found, *OWN)


def route_named(name: str) -> AnyRoute:
    """Return a route by one of its names.

    Examples
    --------
    >>> route_named("force-map").measured
    'records of motion or friction'
    """
    known = {each: route for route in routes() for each in route.names}
    if name not in known:
        raise UnknownNameError("route", name, known)
    return known[name]


def route_of(measurement: Measurement, asked: str | RouteChoice | None = None) -> AnyRoute:
    """Return the route of a measurement: the one that was asked for, or the first that serves.

    Travels have no other route than their own, which then refuses to be asked for one.

    Examples
    --------
    >>> route_of(Measurement(travel=0.2)).names
    ('travel',)
    >>> record = Measurement(time=[0.0, 1.0, 2.0], spring_force=[0.1, 0.2, 0.3])
    >>> route_of(record).names, route_of(record, "shooting").names[0]
    (('features',), 'shooting')
    """
    usual = next(route for route in routes() if route.serves(measurement))
    if asked is None:
        return usual
    name = asked.route if isinstance(asked, RouteChoice) else asked
    found = route_named(name)
    if "route" in usual.uses and "route" not in found.uses:
        raise InputError(
            f"route {name!r} applies to {found.measured}, not to this measurement: leave it out."
        )
    return found if "route" in usual.uses else usual


def refuse_unused(route: AnyRoute, given: Mapping[str, str], options: Options) -> None:
    """Refuse options that have no effect on a route.

    Examples
    --------
    >>> refuse_unused(route_named("travel"), {"horizon": "--horizon"}, Options())
    Traceback (most recent call last):
    stickslip.errors.InputError: --horizon applies to records of motion or friction; it has ...
    """
    for name, called_ in given.items():
        why = route.why_unused(name, options)
        if not why and name not in route.uses | route.settings:
            users = [one for one in routes() if name in one.uses | one.settings]
            why = unused_text(route, users)
        if why:
            raise InputError(f"{called_} {why}")


def unused_text(route: AnyRoute, users: Iterable[AnyRoute]) -> str:
    """Return that an option has no effect on a route, as the end of a sentence with its name.

    Examples
    --------
    >>> unused_text(route_named("travel"), [route_named("features")])
    'applies to the force of a spring; it has no effect on travels: leave it out.'
    """
    others = joined([one.measured for one in users])
    return f"applies to {others}; it has no effect on {route.measured}: leave it out."


def refuse_foreign(route: AnyRoute, laws: Iterable[object]) -> None:
    """Refuse laws of another kind than a route fits; names are looked up where they are used.

    Examples
    --------
    >>> from stickslip.friction import Coulomb, RateState
    >>> refuse_foreign(route_named("travel"), [Coulomb, RateState])
    Traceback (most recent call last):
    stickslip.errors.InputError: A fit to travels takes a FrictionLaw, its type or its name, got ...
    """
    for law in laws:
        kind = law if isinstance(law, type) else type(law)
        if not issubclass(kind, (str, route.fits)):
            others = joined([one.measured for one in routes() if issubclass(kind, one.fits)])
            use = f", which is for {others}" if others else ""
            raise InputError(
                f"A fit to {route.measured} takes a {route.fits.__name__}, its type or its name,"
                f" got {called(law)}{use}."
            )


def refuse_uninformed(
    route: AnyRoute, laws: Iterable[object], mechanism: Mechanism, measurement: Measurement
) -> None:
    """Refuse laws that ask for contact inputs which nothing tells, before anything runs."""
    known = route.known_inputs(mechanism, measurement)
    for one in laws:
        law = one
        if isinstance(one, str):
            with suppress(InputError):
                law = law_type(one)
        check_inputs(law, mechanism, measurement, known)
