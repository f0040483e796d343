"""Where runs may begin in view of the hard stops."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.mechanisms import Mechanism, Stop, stops_of
from stickslip.quantities import parameters, shadow

__all__ = ["narrowest", "refuse_stops", "starts_within_stops", "within_stops"]

BEYOND = 1e-12
"""Share of the larger of place and stop that counts as rounding, so that runs can be continued."""

Array = NDArray[np.float64]


def within_stops(mechanism: Mechanism, y0: Sequence[float]) -> list[float]:
    """Return the initial state, put onto a stop where it is beyond it by rounding only."""
    start = [float(value) for value in y0]
    if not stops_of(mechanism):
        return start
    moved = starts_within_stops(mechanism, {}, start)
    for index, coordinate in enumerate(mechanism.coordinates):
        for place in moved.get(f"initial.{coordinate}", ()):
            start[index] = float(place)
    return start


def starts_within_stops(
    mechanism: Mechanism, columns: Mapping[str, Array], y0: Sequence[float]
) -> dict[str, Array]:
    """Return what varies among runs, an array by path, with each start put onto its stop.

    That is a start beyond its stop by rounding; one that is farther beyond it is refused.
    """
    moved = dict(columns)
    for stop in _stops_of_runs(mechanism, columns):
        index = mechanism.coordinates.index(stop.coordinate)
        path = f"initial.{stop.coordinate}"
        place, position = np.broadcast_arrays(
            moved.get(path, np.full(1, y0[index])), _position(stop), *columns.values()
        )[:2]
        excess = place - position if stop.side == "upper" else position - place
        far = excess > BEYOND * np.maximum(np.abs(place), np.abs(position))
        if far.any():
            row = int(np.argmax(far))
            unit = mechanism.units[index]
            raise InputError(
                f"{f'run {row}: it' if columns else 'the run'} begins at {stop.coordinate} ="
                f" {place[row]:g} {unit}, beyond the {stop.side} stop of"
                f" {type(mechanism).__name__} at {position[row]:g} {unit}: move the stop, or begin"
                f" elsewhere with y0={{{stop.coordinate!r}: ...}}."
            )
        if (excess > 0.0).any():
            moved[path] = np.where(excess > 0.0, position, place)
    return moved


def _stops_of_runs(mechanism: Mechanism, columns: Mapping[str, Array]) -> tuple[Stop, ...]:
    """Return the stops, whose positions are arrays where they vary."""
    if not columns:
        return stops_of(mechanism)
    values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    return stops_of(shadow(mechanism, "mechanism", lambda path: columns.get(path, values[path])))


def _position(stop: Stop) -> Array:
    return np.atleast_1d(np.asarray(stop.position, dtype=np.float64))


def narrowest(mechanism: Mechanism, columns: Mapping[str, Array]) -> set[int]:
    """Return the runs whose stops leave the least room between them."""
    stops = _stops_of_runs(mechanism, columns)
    lower, upper = (
        {stop.coordinate: _position(stop) for stop in stops if stop.side == side}
        for side in ("lower", "upper")
    )
    return {int(np.argmin(upper[q] - lower[q])) for q in lower.keys() & upper.keys()}


def refuse_stops(mechanism: Mechanism) -> None:
    """Raise if a mechanism has hard stops."""
    if stops_of(mechanism):
        raise InputError(
            f"FixedStep knows no hard stops, and this {type(mechanism).__name__} has some: run it"
            " with EventDriven(), or without the stops."
        )
