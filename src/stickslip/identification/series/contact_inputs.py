"""Contact inputs of records: told by the mechanism, a column, or a condition of the trial."""

from collections import defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.drives import Drive, Sampled
from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.formatting import joined
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism, given_inputs, input_names

__all__ = ["check_inputs", "inputs_along", "known_inputs", "with_inputs"]

Array = NDArray[np.float64]


def known_inputs(mechanism: Mechanism, measurement: Measurement) -> tuple[str, ...]:
    """Return the contact inputs that a fit of a measurement can use.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured.
    measurement : Measurement
        Records, perhaps with inputs of their own.

    Returns
    -------
    tuple of str
        Names of what the mechanism or every record tells.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> record = Measurement(time=[0, 1], position=[0, 1], inputs={"temperature": 20.0})
    >>> "temperature" in known_inputs(SpringBlock(mass=1.0), record)
    True
    """
    return tuple(dict.fromkeys((*input_names(mechanism), *measurement.input_names())))


def check_inputs(
    law: FrictionLaw | type[FrictionLaw] | Laws | None,
    mechanism: Mechanism,
    measurement: Measurement,
) -> None:
    """Refuse a law that asks for a contact input which nothing tells.

    Parameters
    ----------
    law : FrictionLaw, type or Laws
        The law, or the law of each contact.
    mechanism : Mechanism
        What was measured.
    measurement : Measurement
        Records, perhaps with inputs of their own.

    Raises
    ------
    InputError
        With the columns that there are.
    """
    known = known_inputs(mechanism, measurement)
    members = dict(law.members).values() if isinstance(law, Laws) else (law,)
    for one in members:
        for name in getattr(one, "inputs", ()):
            if name not in known:
                raise InputError(_missing(one, name, mechanism, measurement, known))


def _missing(
    law: Any, name: str, mechanism: Mechanism, measurement: Measurement, known: tuple[str, ...]
) -> str:
    """Return what a law lacks, and what there is."""
    records = measurement.records()
    some = [one for one in records if name in one.contact_inputs()]
    unused = list(dict.fromkeys(column for one in records for column in one.unused))
    columns = [*measurement.quantities(), *(one for one in unused if one not in known)]
    there = f"Contact inputs that are known: {', '.join(known) or 'none'}"
    where = (
        f"only {len(some)} of {len(records)} trials have it"
        if some
        else f"neither {type(mechanism).__name__} nor the record tells it"
    )
    return (
        f"{law.name} asks for the contact input {name!r}, and {where}. {there}; columns of the"
        f" record: {', '.join(columns)}. Name the column that holds it, as --columns {name}=..."
        f' (in Python columns={{"{name}": "..."}}), state it as a condition of each trial, or give'
        " a law without it."
    )


def inputs_along(
    mechanism: Mechanism,
    record: Measurement,
    time: Array,
    position: Mapping[str, Array],
    velocity: Mapping[str, Array],
    drives: Mapping[str, Array],
) -> dict[str, Array]:
    """Return contact inputs at each sample (n,), of the mechanism before those of the record.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured.
    record : Measurement
        One record.
    time : array (n,)
        Times [s] at which they are wanted; row numbers of a table.
    position, velocity : mapping of str to array (n,)
        Motion by coordinate.
    drives : mapping of str to array (n,)
        Values of the drives, by name.

    Returns
    -------
    dict of str to array (n,)
        By name.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> t = np.array([0.0, 0.5, 1.0])
    >>> record = Measurement(time=[0, 1], position=[0, 1], inputs={"temperature": [20.0, 22.0]})
    >>> found = inputs_along(SpringBlock(mass=1.0), record, t, {"x": t}, {"x": t}, {})
    >>> found["temperature"]
    array([20., 21., 22.])
    """
    own: Mapping[str, Any] = mechanism.contact_inputs(
        time,
        defaultdict(float, position),
        defaultdict(float, velocity),
        defaultdict(float, drives),
    )
    told = {name: _at(record, value, time) for name, value in record.contact_inputs().items()}
    return {name: np.asarray(value + 0.0 * time) for name, value in {**told, **own}.items()}


def _at(record: Measurement, value: Array | float, time: Array) -> Array | float:
    """Return values of a record at other times; those of a table stay as they are."""
    if record.time is None or not isinstance(value, np.ndarray):
        return value
    return np.interp(time, np.asarray(record.time), value)


def with_inputs(mechanism: Mechanism, record: Measurement, start: float = 0.0) -> Mechanism:
    """Return a mechanism that tells its laws what a record has of contact inputs.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured; what it tells itself stays.
    record : Measurement
        One record.
    start : float
        Time of the record [s] that is 0 in a run.

    Returns
    -------
    Mechanism
        A copy with the inputs as drives, which go straight from sample to sample.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> record = Measurement(time=[0, 1], position=[0, 1], inputs={"temperature": [20.0, 22.0]})
    >>> with_inputs(SpringBlock(mass=1.0), record).drives()["contact_temperature"].value(0.5)
    21.0
    """
    own = input_names(mechanism)
    inputs: dict[str, Drive | float] = {}
    for name, value in record.contact_inputs().items():
        if name in own:
            continue
        if isinstance(value, np.ndarray) and np.ptp(value) > 0.0:
            times = np.asarray(record.time) - start
            inputs[name] = Sampled(times=times, values=value, hold="first")
        else:
            inputs[name] = float(np.ravel(value)[0])
    return given_inputs(mechanism, inputs)
