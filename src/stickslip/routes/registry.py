"""The routes there are, and which of them serves a measurement."""

from collections.abc import Iterable
from functools import cache
from importlib.metadata import entry_points
from typing import Any, TypeAlias

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments import Measurement
from stickslip.formatting import joined
from stickslip.identification.records.route_choice import RouteChoice
from stickslip.routes.features import FeatureRoute
from stickslip.routes.records import RecordRoute
from stickslip.routes.route import Options, Route
from stickslip.routes.travels import TravelRoute

__all__ = ["AnyRoute", "refuse_unused", "route_named", "route_of", "routes"]

AnyRoute: TypeAlias = Route[Any, Any]

OWN: tuple[AnyRoute, ...] = (FeatureRoute(), TravelRoute(), RecordRoute())
"""In the order in which they are asked."""


@cache
def routes() -> tuple[AnyRoute, ...]:
    """Return all routes: those of other packages first, as they are the more special.

    Examples
    --------
    >>> [route.measured for route in routes()][-3:]
    ['the force of a spring', 'travels', 'records of motion or friction']
    """
    found = [entry.load()() for entry in entry_points(group="stickslip.routes")]
    return (*found, *OWN)


def route_named(name: str) -> AnyRoute:
    """Return a route by one of its names.

    Raises
    ------
    UnknownNameError
        If there is none.

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

    Parameters
    ----------
    measurement : Measurement
        What was measured.
    asked : str or RouteChoice, optional
        A name of a route, or what `choose_route` returned.

    Raises
    ------
    UnknownNameError
        If no route has that name.

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
    found = route_named(asked.route if isinstance(asked, RouteChoice) else asked)
    return found if "route" in usual.uses else usual


def refuse_unused(
    route: AnyRoute, given: Iterable[str], options: Options, *, mark: str = ""
) -> None:
    """Refuse options that have no effect on a route.

    Parameters
    ----------
    route : Route
        That of the measurement.
    given : iterable of str
        Names of options, and of fields of `RecordSettings`, that were given.
    options : Options
        With what was chosen for the measurement.
    mark : str
        What stands before names in messages, such as ``"--"``.

    Raises
    ------
    InputError
        With the option and what it is for.

    Examples
    --------
    >>> refuse_unused(route_named("travel"), ["horizon"], Options(horizon=1.0))
    Traceback (most recent call last):
    stickslip.errors.InputError: horizon applies to records of motion or friction; it has ...
    """
    for name in given:
        why = route.why_unused(name, options)
        if not why and name not in route.uses:
            others = joined([one.measured for one in routes() if name in one.uses])
            why = f"applies to {others}; it has no effect on {route.measured}: leave it out."
        if why:
            raise InputError(f"{mark}{name} {why}")
