"""Measurements from CSV and Parquet files: a record in time, or a table of trials."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments.measurement import QUANTITIES, SAMPLED, Measurement, Uncertainty
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity

if TYPE_CHECKING:
    from stickslip.experiments.frames import Frame

__all__ = ["load_measurement"]


def load_measurement(
    path: str | Path,
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
) -> Measurement:
    r"""Read a measurement from a CSV or Parquet file.

    A file with a column ``travel`` and without time is a table of trials, one a row. Its other
    columns may be ``uncertainty``, ``uncertainty_kind``, ``name``, ``provenance``, ``initial.x``
    and the like, and parameter paths such as ``mechanism.compression``. Every other file is one
    record, with the columns ``time``, ``position``, ``velocity``, ``force``, ``friction``; what
    else it has is left alone. A header may carry its unit, as ``travel [mm]``; without one, and
    without an entry in `units`, numbers are in SI.

    Parameters
    ----------
    path : str or Path
        A ``.csv``, ``.tsv``, ``.txt`` or ``.parquet`` file.
    columns : mapping of str to str, optional
        Quantity or parameter path -> name of its column, where they differ. A record then has
        these columns and those whose names fit; a column is used once.
    units : mapping of str to str, optional
        Quantity or parameter path -> unit of its column.
    gain : mapping of str to float, optional
        By quantity of a record, the factor that makes SI of its column's numbers: newtons per
        volt of an amplifier and its motor, or -1 for a sensor that counts the other way.
    uncertainty, uncertainty_kind, overrides, initial, offset
        As in `Measurement`, in SI; for a table of trials, of every trial that says nothing else.
    name : str
        What the measurement is called; the file's name if not given.
    mechanism : Mechanism, optional
        Checks parameter paths and the units of their columns at once, and lets the plain last name
        of a parameter stand for its path.

    Returns
    -------
    Measurement
        In SI.

    Raises
    ------
    InputError
        If the file cannot be read or used; the message names file, column and row.

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
    # Imported here so that measurements built in Python do without pandas.
    from stickslip.experiments.frames import read_frame
    from stickslip.experiments.trials import read_trials

    frame = read_frame(path, columns=columns or {}, units=units or {})
    common: dict[str, Any] = {
        "uncertainty_kind": uncertainty_kind,
        "overrides": overrides or {},
        "initial": initial or {},
        "offset": offset or {},
    }
    if uncertainty is not None:
        common["uncertainty"] = uncertainty
    name = name or Path(path).stem
    try:
        if "travel" in frame.names and "time" not in frame.names:
            return read_trials(frame, common, name, mechanism)
        return _record(frame, gain or {}, common, name)
    except UnknownNameError:
        raise
    except InputError as error:
        text = str(error)
        raise type(error)(
            text if text.startswith(frame.file) else f"{frame.file}: {text}"
        ) from None


def _record(
    frame: "Frame", gain: Mapping[str, float], common: Mapping[str, Any], name: str
) -> Measurement:
    """Return the record of a file, all columns that are quantities converted to SI."""
    values: dict[str, Any] = {}
    for quantity, unit in {"time": "s", **{key: QUANTITIES[key].unit for key in SAMPLED}}.items():
        if quantity in frame.names and quantity in gain:
            factor = Quantity("g", "").check("gain", quantity, gain[quantity])
            values[quantity] = factor * frame.raw(quantity)
        elif quantity in frame.names:
            values[quantity] = frame.numbers(quantity, unit)
    for quantity in gain:
        if quantity not in values:
            raise UnknownNameError("quantity in gain", quantity, values)
    if not set(values) - {"time"}:
        listed = ", ".join(map(repr, list(frame.names)[:12]))
        raise InputError(
            f"{frame.file}: no column is called {', '.join(SAMPLED)} or travel; it has {listed}."
            ' Say which is which, as columns={"position": "..."}.'
        )
    return Measurement(**values, **common, name=name, provenance=Path(frame.file).name)
