"""Measurements from CSV, Parquet and MATLAB files: a record in time, or a table of trials."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments.columns import check_columns
from stickslip.experiments.measurement import QUANTITIES, SAMPLED, Measurement, Uncertainty
from stickslip.experiments.reading import Reading
from stickslip.experiments.repair import Repair, repaired, repairs
from stickslip.experiments.units import is_of, shown
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity

if TYPE_CHECKING:
    from stickslip.experiments.frames import Frame

__all__ = ["load_measurement", "read_data"]


def load_measurement(
    path: str | Path | Iterable[str | Path],
    *,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    gain: Mapping[str, float] | None = None,
    uncertainty: Mapping[str, float] | float | None = None,
    uncertainty_kind: Uncertainty = "standard",
    overrides: Mapping[str, float] | None = None,
    initial: Mapping[str, float] | None = None,
    offset: Mapping[str, float] | None = None,
    name: str = "",
    mechanism: Mechanism | None = None,
    repair: Repair | Sequence[Repair] | None = None,
) -> Measurement:
    r"""Read a measurement from a CSV, Parquet or MATLAB file, or its trials from several.

    A file with a column ``travel`` and without time is a table of trials, one a row. Its other
    columns may be ``uncertainty``, ``uncertainty_kind``, ``name``, ``provenance``, ``initial.x``
    and the like, and parameter paths such as ``mechanism.compression``. Every other file is one
    record, with the columns ``time``, ``position``, ``velocity``, ``force``, ``friction``,
    ``load``, ``spring_force``, ``pull``, ``reference``; what else it has is left alone. A header
    may carry its unit, as ``travel [mm]``; without one, and without an entry in `units`, numbers
    are in SI. The columns of a MATLAB file are its vectors of one length; a field of a struct is
    called ``struct.field``.

    Parameters
    ----------
    path : str, Path or iterable of these
        A ``.csv``, ``.tsv``, ``.txt``, ``.parquet`` or ``.mat`` file. Several files make a
        measurement with several trials, each called like its file.
    columns : mapping of str to str, optional
        Quantity or parameter path -> name of its column, where they differ. A record then has
        these columns and those whose names fit; a column is used once.
    units : mapping of str to str, optional
        Quantity or parameter path -> unit of its column.
    gain : mapping of str to float, optional
        By quantity of a record, the factor that makes SI of its column's numbers: newtons per
        volt of an amplifier and its motor, or -1 for a sensor that counts the other way.
    uncertainty, uncertainty_kind, overrides, initial, offset
        As in `Measurement`, in SI; for several trials, of every one that says nothing else.
    name : str
        What the measurement is called; the file's name if not given.
    mechanism : Mechanism, optional
        Checks parameter paths and the units of their columns at once, and lets the plain last name
        of a parameter stand for its path.
    repair : {"sort", "gaps"} or sequence of these, optional
        ``"sort"``: order the samples of a record by time, drop those that are there twice, and
        average those of one time that differ. ``"gaps"``: drop samples that are not finite in
        every column. What was done stands in `Measurement.provenance`. Nothing is repaired unless
        it is asked for.

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
    common: dict[str, Any] = {
        "uncertainty_kind": uncertainty_kind,
        "overrides": overrides or {},
        "initial": initial or {},
        "offset": offset or {},
    }
    if uncertainty is not None:
        common["uncertainty"] = uncertainty
    check_columns(columns or {}, mechanism)
    reading = _Reading(
        columns=columns or {},
        units=units or {},
        gain=gain or {},
        common=common,
        mechanism=mechanism,
        repair=repairs(repair),
    )
    if isinstance(path, str | Path) or not isinstance(path, Iterable):
        return reading.one(path, name)
    return reading.several(list(path), name)


def read_data(
    files: Sequence[Path], reading: Reading, *, mechanism: Mechanism | None = None
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
    return load_measurement(
        files[0] if len(files) == 1 else files,
        columns=reading.columns,
        units=reading.units,
        gain=reading.gain,
        offset=reading.offset,
        mechanism=mechanism,
        repair=reading.repair,
    )


@dataclass(frozen=True, kw_only=True)
class _Reading:
    """How files are read."""

    columns: Mapping[str, str]
    units: Mapping[str, str]
    gain: Mapping[str, float]
    common: Mapping[str, Any]
    mechanism: Mechanism | None
    repair: tuple[Repair, ...]

    def several(self, paths: Sequence[str | Path], name: str) -> Measurement:
        """Return the trials of several files, each called like its file."""
        if not paths:
            raise InputError("load_measurement needs at least one file, got an empty list.")
        stems = [Path(path).stem for path in paths]
        # Files of one name in several folders are told apart by these.
        names = stems if len(set(stems)) == len(stems) else [str(path) for path in paths]
        read = [self.one(path, own) for path, own in zip(paths, names, strict=True)]
        trials = tuple(record for one in read for record in one.records())
        return Measurement(trials=trials, name=name)

    def one(self, path: str | Path, name: str) -> Measurement:
        """Return the measurement of one file."""
        # Imported here so that measurements built in Python do without pandas.
        from stickslip.experiments.frames import read_frame
        from stickslip.experiments.trials import read_trials

        frame = read_frame(path, columns=self.columns, units=self.units)
        name = name or Path(path).stem
        try:
            if "travel" in frame.names and "time" not in frame.names:
                if self.repair:
                    raise InputError("repair is for records in time, not for tables of trials.")
                return read_trials(frame, self.common, name, self.mechanism)
            return self._record(frame, name)
        except UnknownNameError:
            raise
        except InputError as error:
            text = str(error)
            raise type(error)(
                text if text.startswith(frame.file) else f"{frame.file}: {text}"
            ) from None

    def _record(self, frame: "Frame", name: str) -> Measurement:
        """Return the record of a file, all columns that are quantities converted to SI."""
        wanted = ("time", *SAMPLED)
        for key in self.columns:  # those of trials, which a record has not
            if key not in wanted:
                raise UnknownNameError("quantity of a record in columns", key, wanted)
        factors = {
            quantity: Quantity("g", "").check("gain", quantity, factor)
            for quantity, factor in self.gain.items()
        }
        values: dict[str, Any] = {}
        for quantity in wanted:
            if quantity in frame.names:
                holes = "gaps" in self.repair
                values[quantity] = frame.raw(quantity, holes=holes, repairable=True)
        for quantity in factors:
            if quantity not in values:
                raise UnknownNameError("quantity in gain", quantity, values)
        if not set(values) - {"time"}:
            raise InputError(_nothing_known(frame))
        done: tuple[str, ...] = ()
        if self.repair:
            values, done = repaired(values, self.repair)
        scaled = [quantity for quantity in values if quantity not in factors]
        units = _units(frame, scaled)
        for quantity, numbers in values.items():
            if quantity in factors:
                values[quantity] = factors[quantity] * numbers
            else:
                values[quantity] = frame.scaled(quantity, numbers, units[quantity])
        origin = "; ".join([Path(frame.file).name, *done])
        turning = any(units[name] == QUANTITIES[name].or_unit for name in scaled if name != "time")
        return Measurement(**values, **self.common, turning=turning, name=name, provenance=origin)


def _units(frame: "Frame", quantities: Sequence[str]) -> dict[str, str]:
    """Return the SI units of columns: those of an axis that turns, or those of a straight one.

    Raises
    ------
    InputError
        If some columns turn and others do not.
    """
    found, kinds = {"time": "s"}, dict[bool, str]()
    for name in quantities:
        unit = frame.units.get(name)
        if name == "time":
            continue
        quantity = QUANTITIES[name]
        turns = unit is not None and bool(quantity.or_unit) and is_of(unit, quantity.or_unit)
        found[name] = quantity.or_unit if turns else quantity.unit
        # What is of neither kind is no reason to say that kinds differ.
        if unit is not None and quantity.or_unit and (turns or is_of(unit, quantity.unit)):
            kinds.setdefault(turns, f"{name} is in {unit}")
    if len(kinds) == 2:
        raise InputError(
            f"{frame.file}: {kinds[True]}, as of an axis that turns, and {kinds[False]}, as of one"
            " that moves straight: angles go with torques, such as N m, and lengths with forces."
        )
    return found


def _nothing_known(frame: "Frame") -> str:
    listed = ", ".join(map(shown, list(frame.names)[:12]))
    return (
        f"{frame.file}: no column is called {', '.join(SAMPLED)} or travel; it has {listed}."
        ' Say which is which, as columns={"position": "..."}.'
    )
