"""Where runs may begin: within hard stops, with masses above 0."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.formatting import number
from stickslip.formulation import PAINLEVE, mass_fault
from stickslip.mechanisms import MatrixMechanism, Mechanism, Stop, stops_of
from stickslip.quantities import parameters, shadow

BEYOND = 1e-12
"""Share of the larger of place and stop that counts as rounding, so that runs can be continued."""

IMAGINARY = 1e-30
"""A part so small that what it does is a derivative, exact but for rounding."""

Array = NDArray[np.float64]


def _told(mechanism: Mechanism, number: Callable[[str, float], Any]) -> Mapping[str, Any]:
    """Return the states that a mechanism begins with, of which some parameters are other ones."""
    values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    return shadow(mechanism, "mechanism", lambda path: number(path, values[path])).start()


def starts_as_told(
    mechanism: Mechanism, columns: Mapping[str, Array], told: Sequence[str]
) -> dict[str, Array]:
    """Return what varies among runs, with the states that begin elsewhere because of it."""
    found = dict(columns)
    values = _told(mechanism, columns.get) if told else {}
    for state in told:
        if np.ndim(values[state]):
            found[f"initial.{state}"] = np.asarray(values[state], dtype=np.float64)
    return found


def start_slopes(
    mechanism: Mechanism, columns: Mapping[str, Array], paths: Sequence[str], told: Sequence[str]
) -> dict[str, Array]:
    """Return how the states that a mechanism begins with change along paths, by state."""
    found = {state: np.zeros(len(paths)) for state in told}
    known = {path for path, _, _ in parameters(mechanism, "mechanism")} if told else set()
    for c, path in enumerate(paths):
        if path not in known:
            continue
        moved = _told(
            mechanism,
            lambda name, value, path=path: (  # type: ignore[misc]
                columns.get(name, value) + (1j * IMAGINARY if name == path else 0.0)
            ),
        )
        for state in told:
            slopes = np.atleast_1d(np.imag(moved[state])) / IMAGINARY
            if np.ptp(slopes) > 1e-12 * np.abs(slopes).max():
                raise InputError(
                    f"the derivative of the initial {state} with respect to {path} differs from"
                    f" run to run: give the initial value as initial.{state}, or compute the"
                    " sensitivities of each run separately."
                )
            found[state][c] = slopes[0]
    return found


def within_stops(mechanism: Mechanism, y0: Sequence[float]) -> list[float]:
    """Return the initial state, put onto a stop where it is beyond it by rounding only."""
    start = [float(value) for value in y0]
    refuse_masses(mechanism, start)
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
                f" {number(place[row], 6)} {unit}, beyond the {stop.side} stop of"
                f" {type(mechanism).__name__} at {number(position[row], 6)} {unit}: move the stop,"
                f" or choose another start with y0={{{stop.coordinate!r}: ...}}."
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


def refuse_limits(mechanism: Mechanism, limits: Sequence[str]) -> None:
    """Raise if a mechanism has limits, or a normal force that depends on friction."""
    if PAINLEVE in limits:
        raise InputError(
            "FixedStep computes the normal force without friction, but that of this"
            f" {type(mechanism).__name__} depends on friction: run it with EventDriven()."
        )
    if limits:
        raise InputError(
            f"FixedStep does not support limits, and this {type(mechanism).__name__} has some"
            f" ({', '.join(limits)}): run it with EventDriven(), or without limits."
        )


def refuse_masses(mechanism: Mechanism, y0: Sequence[float]) -> None:
    """Raise if matrices given for a mechanism are no masses where a run begins.

    Those of energies are symmetric, and their parameters have ranges.
    """
    if isinstance(mechanism, MatrixMechanism):
        fault = mass_fault(mechanism, y0[: len(mechanism.coordinates)])
        if fault:
            raise InputError(fault)
