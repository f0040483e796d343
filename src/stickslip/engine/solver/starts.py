"""What runs start from: parameters, pieces of the drives, their bounds, and first states.

Everything is made for many runs at once, whose parameters are arrays; one run is a case of that.
"""

import itertools
import math
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from threading import RLock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.formulation import PAINLEVE, Model, mass_fault, refuse_singular
from stickslip.engine.kernels.state_layout import ContactSizes
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import MatrixMechanism, Mechanism, Stop, stops_of
from stickslip.mechanisms.drives import BEGINNING, Drive, Piece, is_delayed, parts_of
from stickslip.quantities import parameters, shadow
from stickslip.show.formatting import number

# Where runs may begin: within hard stops, with masses above 0.

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
    result = dict(columns)
    values = _told(mechanism, columns.get) if told else {}
    for state in told:
        if np.ndim(values[state]):
            result[f"initial.{state}"] = np.asarray(values[state], dtype=np.float64)
    return result


def start_slopes(
    mechanism: Mechanism, columns: Mapping[str, Array], paths: Sequence[str], told: Sequence[str]
) -> dict[str, Array]:
    """Return how the states that a mechanism begins with change along paths, by state."""
    result = {state: np.zeros(len(paths)) for state in told}
    known = {path for path, _, _ in parameters(mechanism, "mechanism")} if told else set()
    for c, path in enumerate(paths):
        if path not in known:
            continue
        # A complex step: the imaginary part of the result over the step is the derivative.
        moved = _told(
            mechanism,
            lambda name, value, path=path: (  # type: ignore[misc]
                columns.get(name, value) + (1j * IMAGINARY if name == path else 0.0)
            ),
        )
        for state in told:
            slopes = np.atleast_1d(np.imag(moved[state])) / IMAGINARY
            # Kernels take one column a direction for all runs.
            if np.ptp(slopes) > 1e-12 * np.abs(slopes).max():
                raise InputError(
                    f"the derivative of the initial {state} with respect to {path} differs from"
                    f" run to run: give the initial value as initial.{state}, or compute the"
                    " sensitivities of each run separately."
                )
            result[state][c] = slopes[0]
    return result


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
            # To the last bit, by which kernels know that it is at its stop.
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


# Numbers that runs start from: parameters, pieces of the drives, their bounds.
#
# Everything is made for many runs at once, whose parameters are arrays; one run is a case of that.


SLOPE_TOLERANCE = 1e-9
"""Share of a start's derivative within which another one is the same."""
SHORTEST_PIECE = 8
"""Units in the last place of the time that a piece must last; what a shorter one does is a jump."""

MOST_KEPT, MOST_NUMBERS = 512, 2_000_000
"""Schedules of single runs that are kept, as those of a long record's segments, and the numbers in
all of their tables together. Only tables of more than an even share make room for themselves, as
others, which searches make for each run, have at most as many again."""
_KEPT: OrderedDict[tuple[float, ...], tuple[tuple[Drive, ...], "Schedule"]] = OrderedDict()
_LOCK = RLock()
"""Held while these are looked up or changed: runs may be made on several threads."""


@dataclass(frozen=True)
class Schedule:
    """What the drives of runs do, and when."""

    table: Array
    """A row a run: for each piece start, then value, slope and start of each drive."""
    bounds: Array
    """A row a run: for each piece, least and largest value of each drive from its start on."""
    time_scale: Array
    """Shortest time in which a drive changes much, for each run."""


@dataclass(frozen=True)
class Inputs:
    """The numbers of one run."""

    p: list[float]
    """Parameters."""
    table: Array
    """What drives do (n,), not to be written to: runs share it."""
    bounds: Array
    """(pieces x drives x 2,): least and largest value of each drive from each piece on."""
    time_scale: float
    """Shortest time in which a drive changes much [s]; a step lasts a sixth of it at most."""


def values_of(mechanism: Mechanism, law: FrictionLaw | Laws) -> dict[str, float]:
    """Return the parameters of a mechanism and a law by path."""
    roots = ((mechanism, "mechanism"), (law, "friction"))
    return {path: value for root, prefix in roots for path, _, value in parameters(root, prefix)}


def gather(mechanism: Mechanism, law: FrictionLaw | Laws, model: Model, t_end: float) -> Inputs:
    """Collect the numbers of a mechanism and a law in the order of the model."""
    return inputs_of(mechanism, numbers_of(mechanism, law, model), t_end)


def numbers_of(mechanism: Mechanism, law: FrictionLaw | Laws, model: Model) -> list[float]:
    """Return the parameters of a mechanism and a law in the order of the model."""
    refuse_turned(mechanism, model)
    values = values_of(mechanism, law)
    return [float(values[path]) for path in model.parameter_paths]


def inputs_of(mechanism: Mechanism, p: list[float], t_end: float) -> Inputs:
    """Return the numbers of a run whose parameters are known already."""
    drives = tuple(mechanism.drives().values())
    if not _has_pieces(drives, t_end):
        return Inputs(
            p=p,
            table=np.array(_smooth_row(drives)),
            bounds=np.array([bound for drive in drives for bound in drive.smooth_bound()]),
            time_scale=min((drive.time_scale() for drive in drives), default=math.inf),
        )
    plan = _alone(drives, t_end)
    return Inputs(
        p=p,
        table=plan.table[0],
        bounds=plan.bounds[0],
        time_scale=float(plan.time_scale[0]),
    )


def table_of(drives: Sequence[Drive], t_end: float) -> tuple[Array, float]:
    """Return the table of drives in one run, and the time in which they change much [s]."""
    plan = _scheduled(drives, 1, t_end)
    return plan.table[0], float(plan.time_scale[0])


def refuse_turned(mechanism: Mechanism, model: Model) -> None:
    """Refuse parameters at which the change of coordinates is singular, if it depends on any."""
    if model.turning and isinstance(model.sizes, ContactSizes):
        refuse_singular(mechanism, dict(zip(model.contacts, model.sizes.slips, strict=True)))


def _alone(drives: tuple[Drive, ...], t_end: float) -> Schedule:
    """Return what drives do in one run: kept, since searches run the same drives again.

    The same are the same objects: drives of one's own may be equal that do not do the same.
    """
    key = (*map(id, drives), t_end)
    with _LOCK:
        kept = _KEPT.pop(key, None)  # and put back last, as the one that was used most lately
        if kept is None:
            plan = _scheduled(drives, 1, t_end)
            plan.table.setflags(write=False)
            kept = drives, plan  # as long as they are kept, no other objects have their identities
            size = plan.table.size
            while _KEPT and (
                len(_KEPT) >= MOST_KEPT
                or (size > MOST_NUMBERS // MOST_KEPT and _numbers() + size > MOST_NUMBERS)
            ):
                _KEPT.popitem(last=False)
        # A table larger than all that may be kept is not kept.
        if kept[1].table.size <= MOST_NUMBERS:
            _KEPT[key] = kept
        return kept[1]


def _numbers() -> int:
    """Return the numbers in the tables that are kept."""
    return sum(plan.table.size for _, plan in _KEPT.values())


def schedule(
    mechanism: Mechanism, columns: Mapping[str, Array], count: int, t_end: float
) -> Schedule:
    """Return what the drives do in a number of runs."""
    values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    twin = shadow(mechanism, "mechanism", lambda path: columns.get(path, values[path]))
    return _scheduled(tuple(twin.drives().values()), count, t_end)


def _scheduled(drives: Sequence[Drive], count: int, t_end: float) -> Schedule:
    if not _has_pieces(drives, t_end):
        return Schedule(
            table=np.array([_smooth_row(drives)] * count),
            bounds=_smooth_bounds(drives, count).reshape(count, -1),
            time_scale=_time_scale(drives, count),
        )
    tables = [[_columns(part.pieces(t_end), count) for part in parts_of(drive)] for drive in drives]
    starts = _starts([table[0] for parts in tables for table in parts], count)
    rows = [_merged(parts, starts) for parts in tables]
    return Schedule(
        table=np.concatenate([starts[:, :, None], *rows], axis=2).reshape(count, -1),
        bounds=_bounds(drives, starts, rows),
        time_scale=_time_scale(drives, count),
    )


ROUNDED = 8
"""Units in the last place by which the same start may differ in real and complex arithmetic."""


def schedule_slopes(
    mechanism: Mechanism,
    columns: Mapping[str, Array],
    paths: Sequence[str],
    tables: Array,
    t_end: float,
) -> Array:
    """Return the derivatives of drives' tables (runs, pieces, 1 + 3 drives, paths).

    They are the imaginary parts that the numbers of drives get from those of their parameters.
    `columns` and `tables` are those of a schedule.
    """
    runs, m = len(tables), len(paths)
    for drive in filter(is_delayed, mechanism.drives().values()):
        for part in parts_of(drive):  # among which delayed feedback says why there are none
            part.pieces()
    if m == 0:
        return np.zeros((runs, 0, 0, 0))
    width = 1 + 3 * len(mechanism.drives())
    # One piece without steps: nothing in the table can move.
    if tables.shape[1] == width and not _has_pieces(mechanism.drives().values(), t_end):
        return np.zeros((runs, 1, width, m))
    values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    # No path stands in a drive, whose numbers stay what they are.
    if not columns and not _moved(mechanism, values, paths):
        return np.zeros((runs, tables.shape[1] // width, width, m))
    own: dict[str, NDArray[Any]] = {path: np.repeat(c, m) for path, c in columns.items()}
    for c, path in enumerate(paths):
        if path in values:
            side = np.tile(np.arange(m) == c, runs)
            own[path] = own.get(path, np.full(runs * m, values[path])) + 1j * IMAGINARY * side
    twin = shadow(mechanism, "mechanism", lambda path: own.get(path, values[path]))
    drives = list(twin.drives().values())
    parts = [
        [_columns(part.pieces(t_end), runs * m) for part in parts_of(drive)] for drive in drives
    ]
    if not any(np.iscomplexobj(table) for tables_of in parts for table in tables_of):
        return np.zeros((runs, tables.shape[1] // width, width, m))  # no path moves a drive
    begins = np.repeat(tables.reshape(runs, -1, width)[:, :, 0], m, axis=0)
    for tables_of in parts:
        for table in tables_of:
            table[0] = _met(table[0], begins)
    starts, apart = _moved_starts([table[0] for own in parts for table in own], begins)
    rows = [_merged(tables_of, starts) for tables_of in parts]
    result = np.concatenate([starts[:, :, None], *rows], axis=2).imag / IMAGINARY
    # Where pieces part there is no derivative: kernels carry the NaN on.
    result[apart, 0] = np.nan
    return np.asarray(result.reshape(runs, m, *result.shape[1:]).transpose(0, 2, 3, 1))


def _moved(mechanism: Mechanism, values: Mapping[str, float], paths: Sequence[str]) -> bool:
    """Whether a path stands in a drive."""
    known, no_number = values.keys() & set(paths), math.nan
    if not known:
        return False
    twin = shadow(mechanism, "mechanism", lambda p: no_number if p in known else values[p])
    return twin.drives() != mechanism.drives()


def _met(own: NDArray[Any], begins: Array) -> NDArray[Any]:
    """Return starts whose real parts are those of the schedule.

    Complex arithmetic rounds otherwise than real arithmetic does: a start that is computed from
    parameters may differ in its last digits.
    """
    near = own.astype(np.complex128) if np.iscomplexobj(own) else own.copy()
    for j in range(begins.shape[1]):
        begin = begins[:, j : j + 1]
        here = np.abs(near.real - begin) <= ROUNDED * np.spacing(np.abs(begin))
        near = np.where(here, begin + 1j * near.imag if np.iscomplexobj(near) else begin, near)
    return near


def _moved_starts(
    tables: Sequence[NDArray[Any]], begins: Array
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Return starts with the imaginary parts of their pieces, and where these move apart.

    Pieces that start together but move differently change places: that has no derivative here.
    """
    starts = begins.astype(np.complex128)
    seen = np.zeros(begins.shape, dtype=bool)
    apart = np.zeros(begins.shape, dtype=bool)
    for table in tables:
        for j in range(table.shape[1]):
            own = table[:, j : j + 1]
            here = begins == own.real
            moved = np.abs(starts.imag - own.imag) > SLOPE_TOLERANCE * np.abs(own.imag)
            apart |= here & seen & moved
            starts += np.where(here & ~seen, 1j * own.imag, 0.0)
            seen |= here
    return starts, apart


def _smooth_row(drives: Sequence[Drive]) -> list[float]:
    """Return the table of drives without pieces."""
    return [BEGINNING, *[0.0, 0.0, BEGINNING] * len(drives)]


def _has_pieces(drives: Iterable[Drive], t_end: float) -> bool:
    """Whether a part of a drive has linear pieces, as a sine has not."""
    return any(part.pieces(t_end) for drive in drives for part in parts_of(drive))


def _columns(pieces: Sequence[Piece], count: int) -> NDArray[Any]:
    """Return starts, values and slopes (3, 1 or count, pieces); one row where all are the same."""
    kinds = set(map(type, itertools.chain.from_iterable(pieces)))
    if not any(issubclass(kind, np.ndarray) for kind in kinds):
        return np.array(pieces, dtype=np.float64).reshape(1, -1, 3).transpose(2, 0, 1)
    columns = [[np.broadcast_to(number, count) for number in piece] for piece in pieces]
    return np.array(columns).transpose(1, 2, 0)


def _starts(tables: Sequence[Array], count: int) -> Array:
    """Return the starts of all pieces (count, pieces), sorted; those too short begin later."""
    beginning = np.full((count, 1), BEGINNING)
    if not tables:
        return beginning
    if all(len(table) == 1 for table in tables):
        array = np.unique(np.concatenate([BEGINNING + np.zeros(1), *[t[0] for t in tables]]))
        starts = np.broadcast_to(array, (count, len(array))).copy()
    else:
        each = [np.broadcast_to(table, (count, table.shape[1])) for table in tables]
        starts = np.sort(np.concatenate([beginning, *each], axis=1), axis=1)
    # From the end on: what is too short joins the next piece, and may do so again.
    too_short = np.diff(starts, axis=1) <= SHORTEST_PIECE * np.spacing(np.abs(starts[:, 1:]))
    for i in range(starts.shape[1] - 2, -1, -1) if too_short.any() else ():
        short = starts[:, i + 1] - starts[:, i] <= SHORTEST_PIECE * np.spacing(
            np.abs(starts[:, i + 1])
        )
        starts[short, i] = starts[short, i + 1]
    return starts


def _merged(tables: Sequence[NDArray[Any]], starts: NDArray[Any]) -> NDArray[Any]:
    """Return value, slope and start (count, pieces, 3) of a drive from each of the starts on."""
    value = np.zeros_like(starts)
    slope = np.zeros_like(starts)
    for begins, values, slopes in tables:
        if begins.shape[1] == 0:
            continue
        index = _index(begins, starts)
        held = index >= 0
        index = np.maximum(index, 0)
        own = _taken(slopes, index) * held
        # A slope counts from the start of its own piece; the sum is one straight line from here.
        since = np.where(own != 0.0, starts - _taken(begins, index), 0.0)
        value += _taken(values, index) * held + own * since
        slope += own
    return np.stack([value, slope, starts], axis=2)


def _index(begins: Array, starts: Array) -> NDArray[np.intp]:
    """Return the piece of a table that holds at each of the starts, -1 before the first."""
    if len(begins) == 1:
        return np.searchsorted(begins[0].real, starts.real, side="right") - 1
    rows = zip(begins.real, starts.real, strict=True)
    return np.stack([np.searchsorted(own, all_, side="right") for own, all_ in rows]) - 1


def _taken(table: Array, index: NDArray[np.intp]) -> Array:
    return np.take_along_axis(np.broadcast_to(table, (len(index), table.shape[1])), index, axis=1)


def _bounds(drives: Sequence[Drive], starts: Array, rows: Sequence[Array]) -> Array:
    """Return least and largest value of each drive from each start on (count, all)."""
    count, pieces = starts.shape
    bounds = np.empty((count, pieces, len(drives), 2))
    smooth = _smooth_bounds(drives, count)
    ends = np.concatenate([starts[:, 1:], np.full((count, 1), math.inf)], axis=1)
    for k, row in enumerate(rows):
        value, slope = row[:, :, 0], row[:, :, 1]
        # the last piece never ends: without the inner choice, slope 0 times infinity would be NaN
        last = np.where(slope == 0.0, value, value + slope * np.where(slope == 0, 0, ends - starts))
        for side, best in enumerate((np.minimum, np.maximum)):
            # From each piece on: extremes are gathered from the end backwards.
            reached = best.accumulate(best(value, last)[:, ::-1], axis=1)[:, ::-1]
            bounds[:, :, k, side] = reached + smooth[:, k, side, None]
    return bounds.reshape(count, -1)


def _smooth_bounds(drives: Sequence[Drive], count: int) -> Array:
    """Return least and largest value of the smooth part of each drive (count, drives, 2)."""
    bounds = np.zeros((count, len(drives), 2))
    for k, drive in enumerate(drives):
        for side, value in enumerate(drive.smooth_bound()):
            bounds[:, k, side] = value
    return bounds


def _time_scale(drives: Sequence[Drive], count: int) -> Array:
    scale = np.full(count, math.inf)
    for drive in drives:
        for part in parts_of(drive):
            scale = np.minimum(scale, part.time_scale())
    return scale
