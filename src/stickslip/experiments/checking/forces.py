"""Forces that a record itself makes doubtful: by their sign, or as coefficients of friction."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from stickslip.experiments.checking.finding import TURN, Finding
from stickslip.experiments.checking.motion import Motion
from stickslip.experiments.differentiation import acceleration_of
from stickslip.experiments.measurement import Measurement
from stickslip.experiments.readers.unit_conversion import load_stated
from stickslip.formatting import number, percent, quantity
from stickslip.mechanisms import Mechanism
from stickslip.quantities import turned

EXPLAINED: Final = 0.5
"""Share of a force that the motion must explain, for its sign to be told."""
GIVEN_OUT: Final = 0.1
"""Energy that friction would give out, over all that the force exchanges, from which it is told."""
BOTH_WAYS: Final = 0.05
"""Share of the samples in each direction; in one alone, a level cannot be told from an offset."""
ALIKE: Final = 0.95
"""Correlation from which acceleration and displacement are one, as those of a single sine."""
LARGEST: Final = 2.0
"""Coefficients of friction hardly exceed this."""
LEAST_LOAD: Final = 10.0
"""Load [N] above which forces and coefficients are of different sizes."""
SMALL: Final = 0.1
"""Friction over load below which a coefficient is the likelier reading."""


def direction(record: Measurement, motion: Motion | None) -> Iterator[Finding]:
    """Doubt the sign of a force that seems to move a negative inertia against negative friction.

    Springs and a constant are left aside; no passive mechanism has both.
    """
    known = {*record.quantities()}
    if motion is None or "force" not in known or known & {"friction", "spring_force", "pull"}:
        return
    ways = motion.directions
    if min(float(np.mean(ways > 0)), float(np.mean(ways < 0))) < BOTH_WAYS:
        return
    force, v, a = np.asarray(record.values("force")), motion.velocity, acceleration_of(record)
    steps = np.diff(motion.time, prepend=motion.time[0])
    columns = np.stack([a, ways, v, np.ones(v.size), np.cumsum(v * steps)], axis=1)
    if abs(float(np.corrcoef(a, columns[:, -1])[0, 1])) > ALIKE:
        columns = columns[:, :-1]
    size = np.sqrt(np.mean(columns**2, axis=0))
    if not (size > 0.0).all() or not np.ptp(force):
        return
    found = np.linalg.lstsq(columns / size, force, rcond=None)[0] / size
    left = force - columns @ found
    explained = 1.0 - float(np.var(left) / np.var(force))
    rubbed = found[1] * ways + found[2] * v
    work = float(np.sum(rubbed * v) / np.sum(np.abs(force * v)))
    if found[0] >= 0.0 or work > -GIVEN_OUT or explained < EXPLAINED:
        return
    inertia = f"{number(float(found[0]), 2)} {turned('kg', record.turning)}"
    yield Finding(
        kind="force sign",
        severity="warning",
        sentence=(
            f"Force acts against the motion: {percent(explained)} of it corresponds to an inertia"
            f" of {inertia} and to friction that supplies energy. Check its sign (if it is wrong,"
            f" {TURN}), and which quantity each column holds."
        ),
        numbers={"inertia": float(found[0]), "work": work, "explained": explained},
    )


def coefficient(record: Measurement, mechanism: Mechanism | None) -> Iterator[Finding]:
    """Doubt friction that is a small share of its load and of the size of a coefficient."""
    if record.friction is None:
        return
    if record.load is None:
        load = load_stated(mechanism, record.overrides)
    else:
        load = float(np.median(np.atleast_1d(record.values("load"))))
    largest = float(np.abs(np.atleast_1d(record.values("friction"))).max())
    if load is None or load <= LEAST_LOAD or not 0.0 < largest < min(LARGEST, SMALL * load):
        return
    most, pressed = quantity(largest, record.unit("friction")), quantity(load, "N")
    yield Finding(
        kind="units",
        severity="warning",
        sentence=(
            f"Friction reaches {most} at a load of {pressed}, {percent(largest / load)} of it. If"
            " the values are friction coefficients, state their unit as 1: they are then"
            " multiplied by the load."
        ),
        numbers={"friction": largest, "load": load},
    )
