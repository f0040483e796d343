"""Which laws a record can say anything of, and the records that can say nothing."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.experiments import (
    Checks,
    Finding,
    Measurement,
    check,
    findings_text,
    motion_of,
    refuse_lack,
    refuse_same,
    refuse_unused,
)
from stickslip.friction import FrictionLaw
from stickslip.identification import TIMELESS, inside
from stickslip.mechanisms import Mechanism

RARE = 0.01
"""Share of samples below which a direction counts as absent."""


def checked(
    mechanism: Mechanism,
    measurement: Measurement,
    validate: Measurement | None = None,
    which: str = "This record",
    *,
    unknown: Sequence[str] = (),
) -> Checks:
    """Return what the record can tell; refuse one that cannot decide.

    Where the mass is looked for, the one given is a start: a force that is not in proportion to it
    is no fault of the record.
    """
    if validate is not None:
        refuse_lack(measurement, validate, which="the second record")
        refuse_unused(validate, inside(mechanism, validate))
        refuse_same(measurement, validate)
        checked(mechanism, validate, which="The second record", unknown=unknown)
    checks = check(measurement, mechanism=mechanism)
    if any(path.endswith((".inertia", ".mass")) for path in unknown):
        told = (one for one in checks.findings if not _of_the_mass(one))
        checks = replace(checks, findings=tuple(told))
    if checks.worst == "error":
        wrong = [one for one in checks.findings if one.severity == "error"]
        raise InputError(f"{which} cannot be used for a selection. {findings_text(wrong)}")
    return checks


def _of_the_mass(one: Finding) -> bool:
    """Whether a warning compares a force with what the mass takes to move, signs aside."""
    return (
        "explained" in one.numbers
        and one.severity == "warning"
        and one.numbers.get("factor", -1.0) > 0.0
    )


def one_way(measurement: Measurement) -> bool:
    """Whether nothing in a record slips backwards, or nothing forwards, beyond its noise.

    Examples
    --------
    >>> v = np.linspace(0.1, 1.0, 20)
    >>> one_way(Measurement(velocity=v, friction=2.0 + v))
    True
    """
    moved = [_directions(record) for record in measurement.records()]
    if any(one is None for one in moved):
        return False
    joined = np.concatenate([one for one in moved if one is not None])
    return min(float(np.mean(joined > 0)), float(np.mean(joined < 0))) < RARE


def _directions(record: Measurement) -> NDArray[np.float64] | None:
    """Return the signs of the velocities of a record, 0 where noise hides them."""
    if record.time is None and "velocity" in record.quantities():
        return np.asarray(np.sign(np.asarray(record.values("velocity"), dtype=float)))
    moving = motion_of(record)
    return None if moving is None else np.asarray(moving.directions, dtype=float)


def unsuited_by(measurement: Measurement, law: FrictionLaw | type[FrictionLaw]) -> str:
    """Return why a law is no candidate on a record; empty if it may be one.

    On friction against velocity alone a bristle law has its steady curve, which is that of a law
    without bristles: it predicts as well, with numbers that nothing tells.

    Examples
    --------
    >>> from stickslip.friction import LuGre
    >>> table = Measurement(velocity=[0.1, 0.2, 0.3], friction=[2.0, 2.1, 2.2])
    >>> unsuited_by(table, LuGre)
    'bristles depend on displacement, which a table without time does not have'
    """
    kind = law if isinstance(law, type) else type(law)
    timeless = all(record.time is None for record in measurement.records())
    return TIMELESS if timeless and kind.states else ""
