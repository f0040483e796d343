"""Measurements from files: a record in time, or a table of trials; their columns in SI.

Values become SI by the unit of their column, or by a gain where it holds volts or counts; a
coefficient becomes a force by the load. What a file seems to hold is guessed where nobody says it.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np

from stickslip.data.measurement import (
    BY_JOINT,
    ELECTRIC,
    SAMPLED,
    STATED,
    TRAVELS,
    Array,
    Measurement,
    Uncertainty,
    along,
    condition_name,
    is_beside,
    quantity_called,
    unit_of_input,
)
from stickslip.data.readers.columns import (
    Column,
    Reading,
    check_columns,
    is_half_width,
    is_voltage,
    motor_constants,
    spelled,
)
from stickslip.data.readers.layout import Layout, Repair, repaired, repairs
from stickslip.data.tolerances import INTERVAL, NEGLIGIBLE
from stickslip.data.units import gain_factor, read_gain, read_number
from stickslip.errors import InputError, ParameterError, UnknownNameError, concerning
from stickslip.mechanisms import Mechanism, load_stated, motor_of
from stickslip.quantities import Numbers, Quantity
from stickslip.show.formatting import number
from stickslip.units import factor, is_of, shown

if TYPE_CHECKING:
    import pandas as pd

    from stickslip.data.readers.table_reader import QuantityTable


# Columns of a record in SI: by their units, by their gains, and coefficients by the load.

RUBBING: Final = ("friction", "spring_force")
"""Forces that are often written as coefficients, over the load."""


def gains_of(given: Mapping[str, float | str], known: Iterable[str]) -> dict[str, float | str]:
    """Return gains as numbers, each of a quantity that is known.

    Examples
    --------
    >>> gains_of({"force": 35}, ["time", "force"])
    {'force': 35.0}
    """
    known = list(known)
    result: dict[str, float | str] = {}
    for name, value in given.items():
        result[name] = _gain(name, value)
        if result[name] == 0.0:
            raise ParameterError(
                f"gain.{name} (g) must be a finite number other than 0, got 0: it would set the"
                " whole column to 0."
            )
    for name in result:
        if name not in known:
            raise UnknownNameError("quantity in gain", name, known)
    return result


def _gain(name: str, value: object) -> float | str:
    """Return a gain, checked; a number is one by which a column is multiplied."""
    if not isinstance(value, str):
        return Quantity("g", "").check("gain", name, value)
    with concerning(f"gain.{name}"):
        return read_gain(value)


def with_motors(
    frame: "QuantityTable", gains: Mapping[str, float | str], constants: Mapping[str, float | str]
) -> tuple["QuantityTable", dict[str, float | str]]:
    """Return a table with currents as forces, and the gains that make forces of them."""
    gains = dict(gains)
    if not constants:
        return frame, gains
    names, units = dict(frame.names), dict(frame.units)
    for current, constant in constants.items():
        force = current.replace("current", "force", 1)
        if current not in names:
            raise InputError(
                f'{frame.file}: motor_constant="{constant}" belongs to a {current}, and there is'
                f' no such column: name it, as columns={{"{current}": "..."}}.'
            )
        if force in names:
            raise InputError(
                f"{frame.file}: {names[force]!r} and {names[current]!r} both give the {force}:"
                " leave out the motor constant, or the column of the force."
            )
        names[force], unit = names.pop(current), units.pop(current) or "A"
        factor_of = _gain(current, gains.pop(current, 1.0))
        if isinstance(factor_of, str):
            raise ParameterError(f"gain.{current} (g) must be a factor without a unit.")
        if isinstance(constant, str):
            number, _, own = constant.strip().partition(" ")
            value = read_number(number, Quantity("K_m")) * factor_of
            gains[force] = f"{value!r} {own.strip()}"
        else:
            gains[force] = constant * factor_of * factor(unit, "A")
        units[force] = unit
    return replace(frame, names=names, units=units), gains


UNIT_LOAD = "coefficients as forces at 1 N, as no load is known"
"""What was done to coefficients of friction that are given without a load."""


@dataclass(frozen=True, kw_only=True)
class Scaling:
    """How the columns of one file become numbers in SI."""

    frame: "QuantityTable"
    """The table of the file."""
    gains: Mapping[str, float | str]
    """Factors by quantity; with its unit where that makes SI of the column's."""
    load: Array | float | None = None
    """Normal force [N] by which coefficients are multiplied where the file has none."""
    load_offset: float = 0.0
    """Offset of a load in the file [N]."""
    rotary: bool | None = None
    """Whether the mechanism turns, as columns without units then do; None if they decide."""
    motors: Mapping[str, float | str] = field(default_factory=dict)
    """Motor constants by current, which became gains of forces."""

    def scaled(self, raw: Mapping[str, Array]) -> tuple[dict[str, Array], bool]:
        """Return columns (n,) in SI, and whether they are of an axis that turns."""
        targets, turning = self._targets(raw)
        # The load first: coefficients are multiplied by it; friction last: that has one without.
        order = sorted(raw, key=lambda name: (name in RUBBING) + (name == "friction"))
        result: dict[str, Array] = {}
        for name in order:
            load = result["load"] - self.load_offset if "load" in result else self.load
            if load is None and name == "friction" and self._per_load(name, targets[name]):
                load = result["load"] = np.ones(len(raw[name]))  # levels over it are coefficients
            result[name] = self._one(name, raw[name], targets[name], load)
        return {name: result[name] for name in dict.fromkeys([*raw, *result])}, turning

    def _per_load(self, name: str, target: str) -> bool:
        """Whether a column is a coefficient, of which no gain makes a force."""
        unit, gain = self.frame.units.get(name), self.gains.get(name, 1.0)
        of_force = target == quantity_called(name).unit
        return of_force and gain in (1.0, -1.0) and unit is not None and is_of(unit, "1")

    def _one(self, name: str, raw: Array, target: str, load: Array | float | None) -> Array:
        unit, gain = self.frame.units.get(name), self.gains.get(name)
        if self._called_volts(name) and gain is None:
            raise InputError(
                f"{self.frame.file}: column {self.frame.names[name]!r} is called a voltage and"
                f" taken for the {name} in {target}: give the factor of the amplifier in {target}/V"
                f" as the gain of {name}; of the voltage at a motor, read the column as voltage and"
                " give the motor as the drive of the mechanism; if it is a"
                f" {name.partition('.')[0]}, give its unit."
            )
        if name in RUBBING and unit is not None and is_of(unit, "1"):
            return self._by_load(name, raw, load, target)
        if gain is None:
            return self.frame.scaled(name, raw, target)
        if isinstance(gain, str):
            return self._in_unit(name, unit, target, gain) * raw
        if unit is None or not is_of(unit, target):  # volts, say: the gain makes SI of them
            return gain * raw
        self._refuse_twice(name, unit, target, gain)
        return gain * self.frame.scaled(name, raw, target)

    def _called_volts(self, name: str) -> bool:
        """Whether a force has no unit, and a name of its column that says volts."""
        is_force = name.partition(".")[0] == "force"
        unit = self.frame.units.get(name)
        return is_force and unit is None and is_voltage(self.frame.names[name])

    def volts(self, names: Iterable[str]) -> tuple[str, ...]:
        """Return the forces that were made of volts."""
        return tuple(
            name
            for name in names
            if name.partition(".")[0] == "force"
            and (self._called_volts(name) or is_of(self.frame.units.get(name) or "N", "V"))
        )

    def _in_unit(self, name: str, unit: str | None, target: str, gain: str) -> float:
        """Return the factor of a gain with a unit, which the column must have too."""
        if unit is None:
            raise ParameterError(
                f"gain.{name} (g) has a unit, {gain}, but the column has none: add units.{name},"
                " or give the gain as a number."
            )
        try:
            return gain_factor(gain, unit, target)
        except ParameterError:
            motor = self.motors.get(name.replace("force", "current", 1))
            if motor is not None:
                raise ParameterError(self._of_motor(motor, gain, unit, target)) from None
            raise ParameterError(
                f"gain.{name} (g) of {gain} times a column in {unit} is not in {target}: correct"
                " the unit of one of them."
            ) from None

    def _of_motor(self, constant: float | str, gain: str, unit: str, target: str) -> str:
        """Return that a motor constant is not in the unit of the axis, and what it would be."""
        said = f'motor_constant="{constant}" times a current in {unit} is not in {target}:'
        whole = f"{gain.partition(' ')[2]} * {unit}"
        if target == "N" and is_of(whole, "N m"):
            return (
                f"{said} the axis moves along a line and takes N/A. With a screw, give the constant"
                " times 2 pi over its lead in m; with a pulley or pinion, over its radius in m; if"
                " the axis turns, give its position in rad or deg."
            )
        if target == "N m" and is_of(whole, "N"):
            return (
                f"{said} the axis turns and takes N m/A. Give the constant times the radius at"
                " which the force acts, in m; if the axis moves along a line, give its position in"
                " m or mm."
            )
        return f"{said} give it in {target}/A."

    def _by_load(self, name: str, raw: Array, load: Array | float | None, target: str) -> Array:
        """Return a coefficient as a force: by a gain, or by the load. A gain of -1 or 1 is a sign.

        About an axis a load makes forces of coefficients, and only a radius makes torques of these.
        """
        gain = self.gains.get(name)
        if isinstance(gain, str):
            return self._in_unit(name, "1", target, gain) * self.frame.scaled(name, raw, "1")
        if gain is not None and abs(gain) != 1.0:
            return gain * self.frame.scaled(name, raw, "1")
        what = f"{self.frame.file}: column {self.frame.names[name]!r} is a coefficient, in"
        what += f" {self.frame.units[name]}, and {name} is"
        if target != quantity_called(name).unit:
            raise ParameterError(
                f"{what} a torque in {target}: give as its gain the load times the contact radius,"
                f" in {target}."
            )
        if load is None:
            raise ParameterError(
                f"{what} a force in N: give the load as a column in N or in the mechanism, or give"
                f" the load in N as the gain of {name}."
            )
        return np.asarray((gain or 1.0) * self.frame.scaled(name, raw, "1") * load)

    def _refuse_twice(self, name: str, unit: str, target: str, gain: float) -> None:
        scale = factor(unit, target)
        if scale == 1.0 or not math.isclose(abs(gain), scale, rel_tol=NEGLIGIBLE):
            return
        cure = "leave the gain out" if gain > 0.0 else "give the gain as -1"
        raise InputError(
            f"{self.frame.file}: column {self.frame.names[name]!r} is in {unit} and converted to"
            f" {target}; a gain of {number(gain, 6)} would apply this conversion a second time:"
            f" {cure}."
        )

    def stated(self, raw: Array, found: Mapping[str, Array], turning: bool) -> Array:
        """Return the uncertainties (n,) of readings of friction in SI, found with other columns.

        Without a unit of their own they are in that of the readings. In that, or in one of its
        kind, the gain of the readings makes SI of them as well; % of another one are shares.
        """
        own, unit = (self.frame.units.get(name) for name in (STATED, "friction"))
        target = "N m" if turning else "N"
        if own == "%" != unit:
            return np.asarray(raw / 100.0 * np.abs(found["friction"]))
        if own is not None and not is_half_width(own):
            if unit is None or not is_of(own, unit):
                return self.frame.scaled(STATED, raw, target)
            raw = raw * factor(own, unit)
        load = found["load"] - self.load_offset if "load" in found else self.load
        return np.copysign(self._one("friction", raw, target, load), raw)

    def _targets(self, names: Iterable[str]) -> tuple[dict[str, str], bool]:
        """Return the SI units of columns: those of an axis that turns, or of a straight one.

        Columns without a gain say which it is; only where they do not, those with one.
        """
        moving = [name for name in names if name != "time"]
        plain = self._kinds(name for name in moving if name not in self.gains)
        kinds = plain or self._kinds(name for name in moving if name in self.gains)
        if len(kinds) == 2:
            raise InputError(
                f"{self.frame.file}: {kinds[True]}, as for a rotary axis, but {kinds[False]}, as"
                " for a linear one: combine angles with torques, such as N m, and lengths with"
                " forces."
            )
        words = {True: "rotary", False: "linear"}
        if self.rotary is not None and (not self.rotary) in kinds:
            raise InputError(
                f"{self.frame.file}: {kinds[not self.rotary]}, as for a {words[not self.rotary]}"
                f" axis, but the mechanism is {words[self.rotary]}: correct the unit of the column"
                " or those of the mechanism."
            )
        turning = True in kinds or bool(self.rotary)
        targets = {"time": "s"}
        for name in moving:
            quantity = quantity_called(name)
            turns = turning and bool(quantity.or_unit)
            targets[name] = quantity.or_unit if turns else quantity.unit
        return targets, turning

    def _kinds(self, names: Iterable[str]) -> dict[bool, str]:
        """Return which column says that the motion turns, and which that it is straight.

        What is of neither kind is no reason to say that kinds differ.
        """
        kinds: dict[bool, str] = {}
        for name in names:
            unit, quantity = self.frame.units.get(name), quantity_called(name)
            gain = self.gains.get(name)
            if unit is not None and isinstance(gain, str):
                unit = f"{gain.partition(' ')[2]} * {unit}"
            if unit is None or not quantity.or_unit:
                continue
            for turns, target in ((True, quantity.or_unit), (False, quantity.unit)):
                if is_of(unit, target):
                    kinds.setdefault(turns, f"{name} is in {unit}")
        return kinds


def load_measurement(
    path: "str | Path | Iterable[str | Path] | pd.DataFrame | Mapping[str, Numbers]",
    *,
    columns: Mapping[str, str | Sequence[str]] | None = None,
    units: Mapping[str, str] | None = None,
    gain: Mapping[str, float | str] | None = None,
    uncertainty: Mapping[str, float] | float | None = None,
    uncertainty_kind: Uncertainty = "standard",
    overrides: Mapping[str, float] | None = None,
    initial: Mapping[str, float] | None = None,
    offset: Mapping[str, float] | None = None,
    name: str = "",
    mechanism: Mechanism | None = None,
    repair: Repair | Sequence[Repair] | None = None,
    conditions: str | Sequence[str] = (),
    motor_constant: float | str | Mapping[str, float | str] | None = None,
    layout: Layout | None = None,
) -> Measurement:
    r"""Read a measurement from a CSV, Parquet, MATLAB or MDF file, or from a table in memory.

    A file with a column ``travel`` and without time is a table of trials, one a row. Its other
    columns may be ``uncertainty``, ``uncertainty_kind``, ``name``, ``provenance``, ``initial.x``
    and the like, and parameter paths such as ``mechanism.compression``. Every other file is one
    record, with the columns ``time``, ``position``, ``velocity``, ``force``, ``friction``,
    ``load``, ``spring_force``, ``pull``, ``reference``, or ``angle``, ``angular velocity`` and
    ``torque``; a ``speed`` is the velocity where no position is beside it. What else it has is left
    alone, and named by `stickslip.check`. A column ``trial`` says which trial each row belongs to.
    Names of what was measured of several joints end with the joint, as ``force.elbow``. A header
    may carry its unit, as ``travel [mm]``, or ``travel (mm)`` if `columns` names it; without one,
    and without an entry in `units`, numbers are in SI. A ``friction`` or ``spring_force`` in ``1``
    or ``%`` is a coefficient, which becomes a force by the load: of the file, or else of the
    mechanism; a friction without any is that of a load of 1 N. The columns of a MATLAB file are its
    vectors of one length; a field of a struct is called ``struct.field``. A text file may have any
    number of lines above the header, a row of units below it, and cells between commas, semicolons,
    tabs, bars or blanks.

    Parameters
    ----------
    path : str, Path, iterable of these, DataFrame or mapping of str to array
        A ``.csv``, ``.tsv``, ``.txt``, ``.lvm``, ``.parquet``, ``.mat``, ``.mf4``, ``.tdms`` or
        ``.xlsx`` file; the last three need packages (``pip install 'stickslip[mdf,tdms,xlsx]'``).
        Several files make a measurement with several trials, each called like its file. A table in
        memory has columns as a file has; times may be its index.
    columns : mapping of str to str, optional
        Quantity or parameter path -> name of its column, where they differ. A record then has
        these columns and those whose names fit; a column is used once. A position in a plane, such
        as a video gives, has two, ``{"position": ["x", "y"]}``: what is read is the way along the
        line through all points, from the first of them, positive where the body went first; a
        negative gain turns it. Its time may also be called ``t``, and of a column
        ``track/x`` the last part is enough where there is one track. Where no column has times,
        ``"time"`` is the rate of the rows, as ``"50 Hz"``, or the time between them, as
        ``"0.5 ms"``. ``"friction_uncertainty"`` is the column with the standard uncertainty of each
        reading of friction, in its unit if it has none of its own, or a constant, as ``"0.1 N"``;
        half-widths are divided by 1.96 where the header says 95 %.
    units : mapping of str to str, optional
        Quantity or parameter path -> unit of its column.
    gain : mapping of str to float or str, optional
        By quantity of a record, a factor other than 0: -1 for a sensor that counts the other way,
        or newtons per volt of an amplifier and its motor. It multiplies what a unit of the
        quantity's kind (mN, mm/s) has made SI of; where the column has another unit (V, A) or
        none, it makes SI of the numbers that stand there.
    uncertainty : float or mapping of str to float, optional
        As in `Measurement`, in SI. This and the next four are those of every trial that says
        nothing else.
    uncertainty_kind : {"standard", "rounding", "interval"}
        As in `Measurement`.
    overrides : mapping of str to float, optional
        As in `Measurement`, in SI.
    initial : mapping of str to float, optional
        As in `Measurement`, in SI.
    offset : mapping of str to float, optional
        As in `Measurement`, in SI.
    name : str
        What the measurement is called; the file's name if not given.
    mechanism : Mechanism, optional
        Checks parameter paths and the units of their columns at once, lets the plain last name
        of a parameter stand for its path, and has the load of coefficients.
    repair : {"sort", "gaps", "hold"} or sequence of these, optional
        ``"sort"``: order the samples of a record by time, drop those that are there twice, and
        average those of one time that differ. ``"gaps"``: drop samples that are not finite in
        every column. ``"hold"``: what drives, or is wanted, keeps its last value in empty cells.
        What was done stands in `Measurement.provenance`. Nothing is repaired unless it is asked
        for.
    conditions : str or sequence of str, optional
        Columns that hold a condition of the trial, such as a temperature or a direction: one value
        in each trial, a number or a text.
    motor_constant : float, str or mapping of str to float or str, optional
        Force or torque over the current of the motor, with its gears [N/A or N m/A], such as
        ``"0.12 N m/A"``: the column ``current`` is then read as the force. By joint where several
        have a current, as ``{"elbow": "0.12 N m/A"}``.
    layout : Layout, optional
        How a text file holds its table, if that is not found from its upper lines: it is refused
        where two lines may be the header, or a comma may be decimal or part thousands. What
        `guess_data` finds has one.

    Returns
    -------
    Measurement
        In SI.

    Raises
    ------
    InputError
        If a file cannot be read or used; the message names file, column and row.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "travels.csv")
    ...     _ = file.write_text("travel [mm],mechanism.compression [mm]\n72,60\n200,100\n")
    ...     trials = load_measurement(file).trials
    >>> [(trial.travel, dict(trial.overrides)) for trial in trials]
    [(0.072, {'mechanism.compression': 0.06}), (0.2, {'mechanism.compression': 0.1})]
    """
    reading = Reading(
        columns=cast("Mapping[str, Column]", columns or {}),
        units=units or {},
        gain=gain or {},
        offset=offset or {},
        repair=repairs(repair),
        conditions=(conditions,) if isinstance(conditions, str) else tuple(conditions),
        motor_constant={} if motor_constant is None else motor_constants(motor_constant),
        layout=layout,
    )
    common: dict[str, Any] = {
        "uncertainty_kind": uncertainty_kind,
        "overrides": overrides or {},
        "initial": initial or {},
    }
    if uncertainty is not None:
        common["uncertainty"] = uncertainty
        given = uncertainty.values() if isinstance(uncertainty, Mapping) else [uncertainty]
        if any(map(np.ndim, given)):  # rows may be sorted or dropped
            cure = f'one for each row stands in a column, as columns={{"{STATED}": "..."}}'
            raise InputError(f"uncertainty must be numbers, the same for all rows: {cure}.")
    return _Files(reading=reading, common=common, mechanism=mechanism).measurement(path, name)


def read_data(
    files: Sequence[Path],
    reading: Reading,
    *,
    mechanism: Mechanism | None = None,
    overrides: Mapping[str, float] | None = None,
    initial: Mapping[str, float] | None = None,
    name: str = "",
) -> Measurement:
    r"""Return the measurement of one file, or of several as trials, read as they are to be.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "record.csv")
    ...     _ = file.write_text("time,q\n0,0.0\n1,2.5\n")
    ...     read_data([file], Reading(columns={"position": "q"})).name
    'record'
    """
    common = {"overrides": overrides or {}, "initial": initial or {}}
    read = _Files(reading=reading, common=common, mechanism=mechanism)
    return read.measurement(files[0] if len(files) == 1 else files, name)


@dataclass(frozen=True, kw_only=True)
class _Files:
    """How files become a measurement."""

    reading: Reading
    common: Mapping[str, Any]
    """What every record has beside its columns."""
    mechanism: Mechanism | None

    def measurement(self, path: Any, name: str) -> Measurement:
        """Return the measurement of one file or table, or of several files as trials."""
        check_columns(self.reading.columns, self.mechanism, self.reading.motor_constant)
        if isinstance(path, str | PathLike):
            return self.one(path if isinstance(path, str) else Path(path), name)
        if _is_table(path):
            return self.one(_table(path), name or "table")
        given: list[Any] = list(path) if isinstance(path, Iterable) else [path]
        if not all(isinstance(item, str | PathLike) or _is_table(item) for item in given):
            raise InputError(_no_file(path))
        return self.several(given, name)

    def several(self, paths: Sequence[Any], name: str) -> Measurement:
        """Return the trials of several files, each called like its file, or of several tables."""
        if not paths:
            raise InputError("load_measurement needs at least one file, got an empty list.")
        if any(map(_is_table, paths)):
            parts = [
                self.one(_table(path), f"table {place}") if _is_table(path) else self.one(path, "")
                for place, path in enumerate(paths, 1)
            ]
            return Measurement(trials=tuple(r for part in parts for r in part.records()), name=name)
        stems = [Path(path).stem for path in paths]
        # Files of one name in several folders are told apart by these.
        names = stems if len(set(stems)) == len(stems) else [str(path) for path in paths]
        read = [self.one(path, own) for path, own in zip(paths, names, strict=True)]
        trials = tuple(record for trial in read for record in trial.records())
        return Measurement(trials=trials, name=name)

    def one(self, path: "str | Path | pd.DataFrame", name: str) -> Measurement:
        """Return the measurement of one file, or of one table, which must have a name."""
        # Imported here so that measurements built in Python do without pandas.
        from stickslip.data.readers.table import FileTable
        from stickslip.data.readers.table_reader import (
            by_trial,
            data_file,
            frame_of,
            log_name,
            read_frame,
        )
        from stickslip.data.trial_tables import read_trials, travelled

        file = path if isinstance(path, str | PathLike) else name
        name = name or log_name(data_file(Path(file)))
        columns, units = self.reading.columns, self.reading.units
        try:
            frame = (
                read_frame(path, columns=columns, units=units, layout=self.reading.layout)
                if isinstance(path, str | PathLike)
                else frame_of(FileTable(data=path), str(file), columns=columns, units=units)
            )
            if travelled(frame):
                self._refuse_for_trials()
                common = {**self.common, "offset": self.reading.offset}
                read = read_trials(frame, common, name, self.mechanism, self.reading.conditions)
                return replace(read, lost=frame.lost)
            parts = list(by_trial(frame))
            if len(parts) == 1:
                return self._record(frame, name)
            trials = (self._record(part, label) for label, part in parts)
            return Measurement(trials=tuple(trials), name=name)
        except UnknownNameError:
            raise
        except InputError as error:
            text = spelled(str(error), self.reading.by)
            named = text.startswith((str(file), repr(str(file))))
            raise type(error)(text if named else f"{file}: {text}") from None

    def _refuse_for_trials(self) -> None:
        for what in ("repair", "gain"):
            if getattr(self.reading, what):
                raise InputError(f"{what} applies to time records, not to tables of trials.")

    def _record(self, frame: "QuantityTable", name: str) -> Measurement:
        """Return the record of a file, all columns that are quantities converted to SI."""
        from stickslip.data.readers.guess import clock_of
        from stickslip.data.readers.table import TRIAL
        from stickslip.data.readers.table_reader import SECOND, conditions_in, unused_in

        reading = self.reading
        frame, stated = with_motors(frame, reading.gain, reading.motor_constant)
        joints = [*self._joint_columns(frame)]
        electric = () if motor_of(self.mechanism) else ELECTRIC
        sampled = (name for name in SAMPLED if name not in electric)
        wanted = ("time", *sampled, STATED, *joints, SECOND)
        for key in reading.columns:  # those of trials, which a record has not
            if key not in (*wanted, TRIAL, *reading.motor_constant) and not is_beside(key):
                raise UnknownNameError("quantity of a record in columns", key, wanted[:-1])
        conditions = conditions_in(frame, reading.conditions)
        holes = bool({"gaps", "hold"} & {*reading.repair})
        raw: dict[str, Array] = {
            quantity: frame.raw(quantity, holes=holes, repairable=True)
            for quantity in self._with_cells(frame, wanted)
        }
        gains = gains_of(stated, {*raw} - {STATED})
        if not set(raw) - {"time", STATED}:
            raise InputError(_nothing_known(frame))
        done: tuple[str, ...] = ()
        beside = self._beside(frame)
        used = {*raw, *(name for name in beside if "." in name)}
        raw |= beside
        self._refuse_twice(raw)
        if {"velocity", "friction"} <= {*raw} and "time" not in raw:
            # rows that somebody sorted by speed, of which a drift would read as its effect
            clock = clock_of(frame, {*used, TRIAL, *map(condition_name, conditions)})
            if clock is not None:
                used.add(clock[0])
                raw = {name: x[np.argsort(clock[1])] for name, x in raw.items()}
        if reading.repair:
            raw, done = repaired(raw, reading.repair)
        line = None
        if SECOND in raw:
            raw["position"], line = along(raw["position"], raw.pop(SECOND))
        scaling = Scaling(
            frame=frame,
            gains=gains,
            load=load_stated(self.mechanism, self.common["overrides"]),
            load_offset=reading.offset.get("load", 0.0),
            rotary=(self.mechanism is not None and set(self.mechanism.units) == {"rad"})
            or reading.rotary,
            motors=reading.motor_constant,
        )
        doubt = raw.pop(STATED, None)
        values, turning = scaling.scaled({k: x for k, x in raw.items() if not is_beside(k)})
        done += (UNIT_LOAD,) * ("load" in values and "load" not in raw)
        if line is not None and turning:
            raise InputError(
                "an angle cannot be given as two coordinates in a plane: name one"
                " column of position."
            )
        if line is not None and line.length:
            line = line.scaled(float(np.ptp(values["position"])) / line.length)
        parts: dict[str, Any] = {**_nested(values), **self.common}
        if doubt is not None and ("friction" in values or STATED in reading.columns):
            half = is_half_width(frame.names[STATED])
            doubt = scaling.stated(doubt, values, turning) / (INTERVAL if half else 1.0)
            done += (f"half-widths of 95 % over {INTERVAL} as uncertainties",) * half
            parts["uncertainty"] = {**parts.get("uncertainty", {}), "friction": doubt}
        return Measurement(
            **parts,
            inputs=self._inputs(frame, raw, turning),
            offset=reading.offset,
            conditions=conditions,
            unused=unused_in(frame, {*used, TRIAL, *map(condition_name, conditions)}),
            lost=frame.lost,
            volts=scaling.volts(values),
            turning=turning,
            line=line,
            name=name,
            provenance="; ".join([Path(frame.file).name, *done]),
        )

    def _with_cells(self, frame: "QuantityTable", wanted: Iterable[str]) -> list[str]:
        """Return the columns of quantities without those of channels that were off."""
        result = [name for name in wanted if name in frame.names]
        named = ("time", *self.reading.columns)
        filled = [name for name in result if name in named or not frame.is_empty(name)]
        return filled if {*filled} - {"time"} else result

    def _joint_columns(self, frame: "QuantityTable") -> Iterator[str]:
        """Yield the columns by joint that are read: those that are named, and those that fit.

        A log of a robot has more joints than a mechanism of some of them, or than one axis.
        """
        result = [name for name in frame.names if _of_joint(name)]
        chosen = self.reading.columns
        own = () if self.mechanism is None else self.mechanism.coordinates
        fitting = [name for name in result if name.partition(".")[2] in own] or result
        single = any(name in chosen for name in BY_JOINT)
        yield from (name for name in result if name in chosen or (name in fitting and not single))

    def _refuse_twice(self, raw: Iterable[str]) -> None:
        """Refuse a named column of a joint beside one of the same quantity that is of none."""
        for name in filter(self.reading.columns.__contains__, raw):
            first, _, joint = name.partition(".")
            if joint and first in raw:
                raise InputError(
                    f"columns has {name} and the table {first}: give it by joint, or once for all."
                )

    def _beside(self, frame: "QuantityTable") -> dict[str, Array]:
        """Return the columns (n,) that are contact inputs, as they stand there."""
        joints = {name.partition(".")[2] for name in self._joint_columns(frame)}
        result: dict[str, Array] = {}
        for name in filter(is_beside, frame.names):
            first, _, joint = name.partition(".")
            if not joint or joint in joints:
                named = name in self.reading.columns
                holes = named and "gaps" in self.reading.repair
                with self._optional(name):
                    result[name] = frame.raw(name, holes=holes, repairable=named)
            elif name in self.reading.columns:
                raise UnknownNameError(f"joint in columns, {first}:", joint, joints)
        return result

    def _inputs(
        self, frame: "QuantityTable", raw: Mapping[str, Array], turning: bool
    ) -> dict[str, Array | dict[str, Array]]:
        """Return contact inputs in their units; those of joints, as a table by joint."""
        result: dict[str, Array] = {}
        for name in filter(is_beside, raw):
            with self._optional(name):
                target = unit_of_input(name.partition(".")[0], turning=turning)
                result[name] = frame.scaled(name, raw[name], target)
        return _nested(result)

    @contextmanager
    def _optional(self, name: str) -> Iterator[None]:
        """Let a column be something else if nobody said what it is."""
        try:
            yield
        except ParameterError:
            if name in self.reading.columns:
                raise


def _of_joint(name: str) -> bool:
    """Whether a column is known by a quantity and the joint it was measured of."""
    quantity, _, joint = name.partition(".")
    return quantity in BY_JOINT and bool(joint)


def _nested(values: Mapping[str, Array]) -> dict[str, Array | dict[str, Array]]:
    """Return columns by quantity; what is of joints, as a table by joint."""
    result: dict[str, Any] = {}
    for name, column in values.items():
        quantity, _, joint = name.partition(".")
        if not joint:
            result[quantity] = column
        elif isinstance(result.setdefault(quantity, {}), dict):
            result[quantity][joint] = column
    return result


def _is_table(given: object) -> bool:
    return isinstance(given, Mapping) or hasattr(given, "columns")


def _table(given: Any) -> "pd.DataFrame":
    """Return a table in memory as one of pandas, with times of its index in a column."""
    import pandas as pd

    table = given.to_pandas() if hasattr(given, "to_pandas") else given
    try:
        table = table if isinstance(table, pd.DataFrame) else pd.DataFrame(dict(table))
    except (TypeError, ValueError) as error:
        raise InputError(f"the columns do not make a table: {error}.") from None
    index = table.index
    named = str(index.name).partition("[")[0].strip().casefold() in ("time", "t")
    if isinstance(index, pd.TimedeltaIndex):
        index = pd.Index(index.total_seconds())
    timed = isinstance(index, pd.DatetimeIndex) or index is not table.index
    if (timed or named) and "time" not in table.columns:
        header = "time" if timed else str(index.name)
        table = table.assign(**{header: index})
    return table.reset_index(drop=True)


def _no_file(given: object) -> str:
    """Return what is wrong with something that names no file."""
    return (
        "load_measurement takes a file name, a list of file names or a table, got"
        f" {type(given).__name__}: for columns in memory use a DataFrame, or"
        " Measurement(time=t, force=u), in SI units."
    )


def _nothing_known(frame: "QuantityTable") -> str:
    listed = ", ".join(map(shown, list(frame.names)[:12]))
    first = [name for name in frame.names if name.rpartition("/")[2].lower() == "x"]
    plane = f'["{first[0]}", "{first[0][:-1]}{chr(ord(first[0][-1]) + 1)}"]' if first else '"..."'
    return (
        f"{frame.file}: no column is named {', '.join((*SAMPLED, *TRAVELS))}; the columns are"
        f' {listed}. Assign them, as columns={{"position": {plane}}}.'
    )
