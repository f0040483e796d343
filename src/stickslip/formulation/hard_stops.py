"""Hard stops as expressions: margins, and how the rates respond to an impact."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import symengine as se

from stickslip.formulation.trace import expression
from stickslip.mechanisms import Mechanism, stops_of

SIDES = {"lower": -1, "upper": 1}


@dataclass(frozen=True)
class Wall:
    """A hard stop of one coordinate."""

    coordinate: int
    """Index of the coordinate."""
    side: int
    """1 above, -1 below."""
    position: se.Expr
    """Place of the stop, in the unit of the coordinate."""
    restitution: se.Expr
    """Speed after an impact over that before [1]."""
    margin: se.Expr
    """Distance that is left."""


def derive_walls(mechanism: Mechanism, q: Mapping[str, se.Symbol]) -> tuple[Wall, ...]:
    """Return the stops of a mechanism whose parameters are symbols."""
    names = list(q)
    found = []
    for stop in stops_of(mechanism):
        side = SIDES[stop.side]
        position = expression(stop.position)
        found.append(
            Wall(
                coordinate=names.index(stop.coordinate),
                side=side,
                position=position,
                restitution=expression(stop.restitution),
                margin=side * (position - q[stop.coordinate]),
            )
        )
    return tuple(found)


def impact_events(
    walls: Sequence[Wall], coordinates: Sequence[str], slip: int | None
) -> tuple[str | None, ...]:
    """Return what an impact of each coordinate is called, None where it has no stop."""
    names = ["hits stop" if i == slip else f"{q} hits stop" for i, q in enumerate(coordinates)]
    stopped = {wall.coordinate for wall in walls}
    return tuple(name if i in stopped else None for i, name in enumerate(names))


def wall_guards(walls: Sequence[Wall], slip: int, mode: int) -> list[se.Expr]:
    """Return the margins that a mode watches.

    A body that slips one way meets the stop on that side only, and one that is held meets none.
    """
    watched = [wall.coordinate != slip or wall.side == mode for wall in walls]
    return [wall.margin if yes else se.Integer(0) for wall, yes in zip(walls, watched, strict=True)]
