"""What a log holds of the joints of a robot whose description is known."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import numpy as np
import pandas as pd
from scipy.signal import correlate, correlation_lags

from stickslip.data.measurement import BESIDE, BY_JOINT, Array
from stickslip.data.readers import guess
from stickslip.data.readers.robots import NO_RADIANS
from stickslip.data.readers.table_reader import QuantityTable, data_file, read_frame
from stickslip.data.readers.toml import check_file, check_path
from stickslip.data.tolerances import DECADE, GAP, NEARLY_ALL
from stickslip.errors import InputError, ParameterError
from stickslip.mechanisms import coordinate_of, urdf_joints
from stickslip.show.formatting import joined, lower_first, number, quantity
from stickslip.units import factor, shown

MOVES: Final = {True: 0.01, False: 0.001}
"""Range from which a joint that turns [rad], or slides [m], is said to move."""
LATEST: Final = 1.0
"""Longest lag behind a command that is looked for [s]."""
WINDOW: Final = 0.05
"""Time over which differences of positions are taken as motions [s]."""
EQUAL: Final = 0.005
"""Difference of correlations that noise makes."""
_WITH_CURRENT: Final = (*BY_JOINT, "current")


@dataclass(frozen=True, kw_only=True)
class _Joint:
    """What a log holds of a joint of the description."""

    name: str
    """Name in the description."""
    turns: bool
    columns: Mapping[str, guess.Found]
    """Quantity -> its column."""
    numbers: Mapping[str, Array] = field(default_factory=dict)
    """Quantity -> its values, NaN where there are none, in SI."""

    @property
    def coordinate(self) -> str:
        """Return what the joint is called in mechanisms and columns."""
        return coordinate_of(self.name)

    @property
    def moves(self) -> bool:
        """Return whether it turns or slides by more than a sensor is wrong."""
        place = self.numbers.get("position")
        if place is None or not np.isfinite(place).any():
            return True
        return bool(np.nanmax(place) - np.nanmin(place) > MOVES[self.turns])

    @property
    def driven(self) -> bool:
        """Return whether its torque or force is known."""
        return bool({"force", "current"} & {*self.columns})


def guess_robot(
    path: str | Path, urdf: str | Path, *, units: Mapping[str, str] | None = None
) -> guess.Guess:
    """Find out what a log holds of the joints of a robot.

    Joints are known by the names of the description. Columns that are numbered instead, such as
    q1 to q6, belong to the joints in their order if there are as many. A joint that stood still is
    locked where it was; so is one whose torque is not known if those of others are, because a force
    balance needs the torques of all joints that move.

    Parameters
    ----------
    path : str or Path
        A log that `load_measurement` reads: a bag of ROS, MCAP, a table.
    urdf : str or Path
        Description of the robot.
    units : mapping of str to str, optional
        Units that are known, by quantity: those of all joints.

    Returns
    -------
    Guess
        What was found, with reasons and doubts.

    Raises
    ------
    InputError
        If the log or the description cannot be read, or no joint is in both.
    """
    check_path(path)
    kinds = urdf_joints(urdf)
    file = data_file(Path(path))
    check_file(file)
    layout, reasons = guess.layout_and_reasons(file)
    frame = read_frame(file, columns={}, units={}, layout=layout).as_headed()
    unknown = next((remark for remark in frame.remarks if NO_RADIANS in remark), "")
    if unknown and "position" not in (units or {}):
        raise InputError(f"{file}: {lower_first(unknown)}")
    times = next((offer for q, offer in guess.assigned(frame, {}, {}).items() if q == "time"), None)
    if times is None:
        raise InputError(f"{file}: no column seems to hold times: is it a log of a robot?")
    result, doubts = _matched(frame, times.name, kinds, units or {}, Path(urdf).name)
    joints = [replace(joint, numbers=dict(_numbers(frame, joint, units or {}))) for joint in result]
    driven = any(joint.driven for joint in joints)
    moving = [joint for joint in joints if joint.moves and (joint.driven or not driven)]
    if not moving:
        raise InputError(
            f"{file}: no joint of {Path(urdf).name} moves in it: their positions change by less"
            f" than {MOVES[True]} rad."
        )
    locked = {joint.name: _mean(joint) for joint in joints if joint not in moving}
    seconds = guess.times_of(frame, times)
    columns = {"time": times, **_columns(moving)}
    trial, why = guess.trial_column(frame, {}, columns, seconds)
    repair = guess.repairs_of(frame, columns, seconds, trial)
    delays = {} if seconds is None else dict(_delays(frame, moving, seconds, trial))
    reasons["time"] = guess.column_text(times) + (
        guess.rate_text(seconds) if seconds is not None else ""
    )
    if trial:
        reasons["trial"] = f"column {trial!r}, {why}"
    reasons |= {joint.coordinate: _joint_text(joint, delays) for joint in joints}
    if repair:
        reasons["repair"] = guess.repair_text(repair)
    current = [joint.coordinate for joint in moving if "current" in joint.columns]
    return guess.Guess(
        file=str(path),
        layout=layout,
        columns={
            **{q: column.name for q, column in columns.items() if q != column.name},
            **({"trial": trial} if trial and trial != "trial" else {}),
        },
        units=dict(_units(columns, units or {})),
        motor_constant={
            joint.coordinate: "1 N m/A" if joint.turns else "1 N/A"
            for joint in moving
            if joint.coordinate in current
        },
        repair=repair,
        turning=all(joint.turns for joint in moving),
        robot=str(urdf),
        moving=tuple(joint.name for joint in moving),
        locked=locked,
        delays=delays,
        reasons=reasons,
        doubts=(
            *frame.lost,
            *frame.remarks,
            *guess.rates_doubt(frame, columns),
            *doubts,
            *_doubts(joints, moving, current),
        ),
    )


def _matched(
    frame: QuantityTable, clock: str, kinds: Mapping[str, str], units: Mapping[str, str], urdf: str
) -> tuple[list[_Joint], list[str]]:
    """Return the joints of a description that a log has, and what is said of the others."""
    logged = dict(_logged(frame, clock, units))
    if not logged:
        listed = ", ".join(map(shown, [name for name in frame.names if name][:12]))
        raise InputError(
            f"{frame.file}: no column belongs to a joint; the columns are {listed}. Name them by"
            " joint in a rig file, as columns = { position.elbow = ... }."
        )
    _refuse_clocks(frame, clock, logged)
    own = {coordinate_of(name): name for name in kinds}
    doubts = []
    pairs = {key: own[key] for key in logged if key in own}
    if not pairs and all(key.isdigit() for key in logged):
        pairs = _numbered(sorted(logged, key=int), [*own.values()])
        pairing = joined([f"{key} is {name!r}" for key, name in pairs.items()])
        doubts += [f"The log numbers its joints, so that it is assumed: {pairing}."] * bool(pairs)
    if not pairs:
        raise InputError(
            f"{frame.file}: has the joints {joined([*logged])}, and {urdf} has"
            f" {joined([*own.values()])}: no name is in both."
        )
    others = [key for key in logged if key not in pairs]
    if others:
        doubts.append(f"{joined(others)} of the log: no such joint in {urdf}, left out.")
    missing = [name for name in own.values() if name not in pairs.values()]
    if missing:
        doubts.append(
            f"{joined(missing)} of {urdf}: not in the log, locked at 0. Correct this in [mechanism]"
            " as locked = { ... } if it stood elsewhere."
        )
    return [
        _Joint(name=name, turns=kinds[name] != "prismatic", columns=logged[key])
        for key, name in pairs.items()
    ], doubts


def _refuse_clocks(frame: QuantityTable, clock: str, joints: Collection[str]) -> None:
    """Refuse joints with times of their own: those of one are not when another was read."""
    stem, own = guess.numbered(clock)
    for name in frame.names if own else ():
        same = frame.data[frame.names[name]].equals(frame.data[frame.names[clock]])
        if guess.numbered(name)[0] == stem and guess.numbered(name)[1] in joints and not same:
            raise InputError(
                f"{frame.file}: joints have times of their own, {shown(clock)} and {shown(name)}:"
                " interpolate all to the times of one of them."
            )


def _numbered(keys: Sequence[str], names: Sequence[str]) -> dict[str, str]:
    """Return the joints that numbers stand for: by the numbers in their names, or in their order.

    Examples
    --------
    >>> _numbered(["0", "1"], ["panda_joint1", "panda_joint2", "finger"])
    {'0': 'panda_joint1', '1': 'panda_joint2'}
    >>> _numbered(["1", "2"], ["pan", "lift"])
    {'1': 'pan', '2': 'lift'}
    """
    own = {guess.numbered(name)[1]: name for name in names if guess.numbered(name)[1]}
    for first in (0, 1):  # counted alike, or from 0 and from 1
        result = {key: own.get(str(int(key) + first), "") for key in keys}
        if all(result.values()) and len(own) == len(keys):
            return result
    return dict(zip(keys, names, strict=True)) if len(keys) == len(names) else {}


def _logged(
    frame: QuantityTable, clock: str, units: Mapping[str, str]
) -> Iterator[tuple[str, dict[str, guess.Found]]]:
    """Yield the columns of each joint by quantity, by its name or number in the log."""
    names = [name for name in frame.names if name]
    named: dict[str, dict[str, guess.Found]] = {}
    inputs = guess.inputs_in(names)
    for name in names:
        what, joint = inputs.get(name) or guess.joint_in(name)
        if joint and not frame.is_empty(name):
            unit = frame.units.get(name)
            named.setdefault(joint, {})[what] = guess.Found(
                score=guess.WHOLE,
                name=name,
                unit=units.get(what, unit),
                stated=True,
                why="by its name",
            )
    if named:
        yield from (
            (key, item) for key, item in named.items() if {"position", "velocity"} & {*item}
        )
        return
    for key in guess.joints_in(names):
        part = {
            name: at
            for name, at in frame.names.items()
            if name == clock or guess.numbered(name)[1] == key
        }
        result = guess.assigned(replace(frame, names=part), {"time": clock}, {})
        own = {what: read for what, read in result.items() if what in (*_WITH_CURRENT, "reference")}
        taken = {column.name for column in result.values()}
        own |= guess.changing_temperature(
            [replace(frame, names=part)], [name for name in part if name not in taken]
        )
        if {"position", "velocity"} & {*own}:
            yield (
                key,
                {
                    what: replace(item, unit=units.get(what, item.unit))
                    for what, item in own.items()
                },
            )


def _numbers(
    frame: QuantityTable, joint: _Joint, units: Mapping[str, str]
) -> Iterator[tuple[str, Array]]:
    """Yield positions, measured and commanded, in SI."""
    for what in ("position", "reference"):
        result = joint.columns.get(what)
        if result is not None:
            cells = pd.to_numeric(frame.data[frame.names[result.name]], errors="coerce")
            unit = units.get("position") if what == "reference" else None
            target = "rad" if joint.turns else "m"
            unit = result.unit or unit
            try:
                scale = factor(unit, target) if unit else 1.0
            except ParameterError as error:
                raise ParameterError(f"{frame.file}: column {result.name!r} {error}.") from None
            yield what, cells.to_numpy(dtype=float) * scale


def _columns(joints: Sequence[_Joint]) -> dict[str, guess.Found]:
    """Return the columns that are read, by quantity and joint."""
    return {
        f"{what}.{joint.coordinate}": column
        for joint in joints
        for what, column in joint.columns.items()
        if what in (*_WITH_CURRENT, *BESIDE)
        and not (what == "current" and "force" in joint.columns)
    }


def _units(
    columns: Mapping[str, guess.Found], given: Mapping[str, str]
) -> Iterator[tuple[str, str]]:
    """Yield units that the reader would not find by itself."""
    for name, column in columns.items():
        said = name.partition(".")[0] in given
        if column.unit and (said or not column.stated):
            yield name, column.unit


def _mean(joint: _Joint) -> float:
    """Return where a joint stood; 0 where its position was not recorded."""
    place = joint.numbers.get("position")
    if place is None or not np.isfinite(place).any():
        return 0.0
    return float(np.round(np.nanmean(place), 6))


def _delays(
    frame: QuantityTable, joints: Sequence[_Joint], times: Array, trial: str
) -> Iterator[tuple[str, float]]:
    """Yield how far joints lag behind their commands [s]."""
    rows = np.ones(times.size, dtype=bool)
    if trial:  # the first one
        numbers = frame.data[frame.names.get(trial, trial)].to_numpy()
        rows = numbers == numbers[0]
    for joint in joints:
        if {"position", "reference"} <= {*joint.numbers}:
            own = [joint.numbers[name][rows] for name in ("reference", "position")]
            lag = lag_of(times[rows], *own)
            if lag is not None:
                yield joint.coordinate, lag


def lag_of(times: Array, wanted: Array, measured: Array) -> float | None:
    """Return how far a motion lags behind the commanded one [s]; None if they are not alike.

    It is where the correlation of both motions is largest: the delay of an exact follower, and of a
    servo the sum of the delay and of what its loop takes. Motions are differences over 50 ms, so
    that noise and the steps of commands count little.

    Examples
    --------
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> round(lag_of(t, np.sin(3.0 * t), np.sin(3.0 * (t - 0.034))), 3)
    0.034
    >>> lag_of(t, np.sin(3.0 * t), np.cos(50.0 * t))
    """
    good = np.isfinite(times) & np.isfinite(wanted) & np.isfinite(measured)
    if np.count_nonzero(good) < 50:
        return None
    times, first = np.unique(times[good], return_index=True)
    step = float(np.median(np.diff(times)))
    if times[-1] - times[0] > DECADE * step * times.size:
        return None  # gaps, or times that cannot be
    even = np.arange(times[0], times[-1], step)
    over = max(1, round(WINDOW / step))
    own = _between_commands(times, wanted[good][first]), (times, measured[good][first])
    places = [np.interp(even, *pair) for pair in own]
    if even.size < 4 * over:
        return None
    u, x = (place[over:] - place[:-over] for place in places)
    sizes = [float(np.max(np.abs(array))) for array in (u, x)]
    if not all(0.0 < size < np.inf for size in sizes):
        return None
    u, x = u / sizes[0], x / sizes[1]
    lags = correlation_lags(x.size, u.size)
    near = np.abs(lags) <= min(int(LATEST / step) + 1, u.size // 2)
    # Of each lag, the energy of both where they overlap.
    energy = [np.append(0.0, np.cumsum(array**2)) for array in (u, x)]
    late, early = np.maximum(lags[near], 0), np.maximum(-lags[near], 0)
    of_u = energy[0][u.size - late] - energy[0][early]
    of_x = energy[1][x.size - early] - energy[1][late]
    result = correlate(x, u)[near] / np.sqrt(np.maximum(of_u * of_x, np.finfo(float).tiny))
    # Periodic motions are alike after each period: of equal peaks, that of the smallest lag.
    high = np.flatnonzero(result >= result.max() - EQUAL)
    peaks = np.split(high, np.flatnonzero(np.diff(high) > 1) + 1)
    tops = [int(peak[np.argmax(result[peak])]) for peak in peaks]
    best = min(tops, key=lambda place: abs(lags[near][place]))
    if result[best] < NEARLY_ALL or best in (0, result.size - 1):
        return None
    left, top, right = result[best - 1 : best + 2]
    bend = left - 2.0 * top + right
    between = 0.5 * (left - right) / bend if bend else 0.0  # vertex of a parabola
    return float((lags[near][best] + between) * step)


def _between_commands(times: Array, wanted: Array) -> tuple[Array, Array]:
    """Return a command at the times when it changed: the path of one that is sent at a lower rate.

    Where it stays for long it does so on purpose, and keeps its value.
    """
    changes = np.flatnonzero(np.diff(wanted, prepend=wanted[0] - 1.0) != 0.0)
    steps = np.diff(changes)
    usual = np.median(steps) if steps.size else 1
    ends = changes[1:][steps > GAP * usual] - 1
    kept = np.union1d(np.union1d(changes, ends), [0, wanted.size - 1])
    return times[kept], wanted[kept]


def _joint_text(joint: _Joint, delays: Mapping[str, float]) -> str:
    """Return what was found of a joint, in words."""
    parts = [f"{what} {column.name!r}" for what, column in joint.columns.items()]
    place = joint.numbers.get("position")
    if place is not None and np.isfinite(place).any():
        unit = "rad" if joint.turns else "m"
        ends = [number(float(end), 3) for end in (np.nanmin(place), np.nanmax(place))]
        parts.append(f"from {ends[0]} to {ends[1]} {unit}" if joint.moves else "at rest")
    if joint.coordinate in delays:
        lag = delays[joint.coordinate]
        way = "behind" if lag >= 0.0 else "ahead of"
        parts.append(f"{quantity(abs(lag), 's')} {way} its command")
    return ", ".join(parts)


def _doubts(
    joints: Sequence[_Joint], moving: Sequence[_Joint], current: Sequence[str]
) -> Iterator[str]:
    """Yield what was assumed, and what cannot be told."""
    still = [joint.name for joint in joints if not joint.moves]
    if still:
        yield f"{joined(still)} did not move: locked where it was, friction there is not fitted."
    blind = [joint.name for joint in joints if joint.moves and not joint.driven]
    if blind and len(blind) < len([joint for joint in joints if joint.moves]):
        yield (
            f"{joined(blind)} moved, and what drove it was not recorded: locked at its mean"
            " position, which neglects how its motion drives the others."
        )
    elif blind:
        yield (
            "The log has no effort and no current: `stickslip check` examines it, but friction"
            " cannot be fitted without what drives the joints."
        )
    if any("position" in part.columns and part.columns["position"].unit is None for part in moving):
        yield (
            "Positions have no unit: rad is assumed, and m of joints that slide, as in messages of"
            " ROS. If they are in degrees: --unit position=deg."
        )
    if current:
        yield (
            f"{joined(current)}: the rig file has a question mark for the motor constant. Give that"
            " of the data sheet, times the gear ratio."
        )
