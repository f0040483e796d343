"""Whether a recorded force was held between its samples or went straight to the next.

A held force acts half a sample later than one along straight lines. How late the recorded force
acts is estimated once for a record, before any law is fitted: by regression of the balance of
forces on mass, on friction as a free function of speed, and on the difference between both holds.
Intervals of estimates include what is left open.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement, usual_top_speed
from stickslip.engine.formulation import JointTorques
from stickslip.errors import InputError
from stickslip.identify.fits.estimation.jackknife import infer
from stickslip.identify.fits.estimation.problem import ResidualJacobian
from stickslip.identify.fits.force_map.data import MotionSegment
from stickslip.identify.fits.force_map.force_balance import balanced
from stickslip.identify.fits.force_map.joint_balance import joint_stretches
from stickslip.identify.fits.series.applied_force import driven
from stickslip.identify.fits.settings import Hold, RecordSettings
from stickslip.mechanisms import Mechanism
from stickslip.show.formatting import fixed

Array = NDArray[np.float64]

WIDTHS: Final = (0.0316, 0.1, 0.316)
"""Widths of peaks of friction at rest that a nuisance may have, over the largest speed."""
WIDER: Final = 3.0
"""Factor on what the filter of inverse dynamics passes: half a sample is a fast effect."""


@dataclass(frozen=True, kw_only=True)
class HoldFinding:
    """How the force runs between its samples, and what a record says of that."""

    hold: Hold
    """What fits take."""
    given: bool = False
    """Whether the user gave it."""
    lateness: float = math.nan
    """By how many samples the force acts later than along straight lines: 0 for these, 0.5 if it is
    held; not a number where it was not estimated."""
    half_width: float = math.inf
    """Half width of its 95 % interval."""

    @property
    def told(self) -> bool:
        """Whether the record tells it: closer than the two holds lie."""
        return self.half_width < 0.5

    @property
    def unsure(self) -> float:
        """Half samples by which the force may act earlier or later than fits take; 0 if given."""
        if self.given:
            return 0.0
        taken = 0.5 if self.hold == "zero" else 0.0
        return 2.0 * (abs(self.lateness - taken) + self.half_width) if self.told else 1.0

    @property
    def sentence(self) -> str:
        """What is to be said; nothing where the user gave it."""
        if self.given:
            return ""
        what = f'the force {MEANING[self.hold]} (hold = "{self.hold}")'
        if not self.told:
            return (
                f"Assumed: between samples, {what}. The record does not tell, and intervals include"
                " half a sample. Give the hold if it is known."
            )
        late = f"{fixed(self.lateness, 2)} ± {fixed(self.half_width, 2)}"
        return (
            f"Estimated from the record: between samples, {what}; {late} samples late, where"
            " straight lines have 0 and a held force 0.5."
        )

    def applied(self, settings: RecordSettings) -> RecordSettings:
        """Return settings with this hold."""
        return replace(settings, hold=self.hold)

    def to_dict(self) -> dict[str, Any]:
        """Return all as numbers and texts; None for what is not known."""
        known = math.isfinite(self.half_width)
        return {
            "hold": self.hold,
            "given": self.given,
            "samples_late": self.lateness if known else None,
            "half_width": self.half_width if known else None,
        }


MEANING: Final[dict[Hold, str]] = {
    "zero": "keeps its value until the next one",
    "first": "goes straight to the next value",
}


def hold_of(
    mechanism: Mechanism, measurement: Measurement, given: Hold | None, vary: Sequence[str] = ()
) -> HoldFinding | None:
    """Return how the force of a record runs between its samples, from the record if not given.

    Examples
    --------
    >>> from stickslip import Axis
    >>> t = np.arange(0.0, 20.0, 0.02)
    >>> v = np.cos(2.0 * t) + 0.5 * np.cos(5.1 * t)
    >>> x = np.sin(2.0 * t) / 2.0 + 0.5 * np.sin(5.1 * t) / 5.1
    >>> force = -6.0 * np.sin(2.0 * t) - 7.65 * np.sin(5.1 * t) + 5.0 * np.sign(v)
    >>> record = Measurement(time=t, position=x, force=force)
    >>> hold_of(Axis(inertia=3.0), record, None).hold
    'first'
    """
    records = measurement.records()
    known = measurement.quantities()
    by_joint = bool(measurement.joint_names())
    if "friction" in known or any(record.time is None for record in records):
        return None
    if not by_joint and not ("force" in known and driven(measurement)):
        return None
    if given is not None:
        return HoldFinding(hold=given, given=True)
    try:
        pairs = _joints(mechanism, measurement, vary) if by_joint else _axis(mechanism, measurement)
        value, half = _joined([_late(*pair) for pair in pairs])
    except InputError:  # what is wrong with the record is said where it is fitted
        value, half = math.nan, math.inf
    # commands are usual, where an estimate is worth nothing
    hold: Hold = "first" if value < 0.5 and half < 1.0 else "zero"
    return HoldFinding(hold=hold, lateness=0.5 * value, half_width=0.5 * half)


Pair = tuple[Sequence[MotionSegment], Sequence[MotionSegment]]


def _axis(mechanism: Mechanism, measurement: Measurement) -> list[Pair]:
    """Return stretches with either hold, straight lines first."""
    zero, first = (
        balanced(mechanism, measurement, slipping=True, wider=WIDER, hold=hold) for hold in MEANING
    )
    return [(first, zero)]


def _joints(mechanism: Mechanism, measurement: Measurement, vary: Sequence[str]) -> list[Pair]:
    """Return those of each joint."""
    torques = JointTorques.of(mechanism, vary)
    (zero,), (first,) = (
        joint_stretches(torques, mechanism, measurement, slipping=True, wider=WIDER, hold=hold)
        for hold in MEANING
    )
    return list(zip(first, zero, strict=True))


def _late(first: Sequence[MotionSegment], zero: Sequence[MotionSegment]) -> tuple[float, float]:
    """Return by how many half samples a force acts late, and the half width of its interval.

    The interval is infinite where friction and mass can take all up.
    """
    top = max(usual_top_speed(one.path.velocity) for one in first)
    tables, forces = [], []
    for one, other in zip(first, zero, strict=True):
        kept, late = one.rows_of(None), one.friction - other.friction
        tables.append(np.column_stack([_nuisance(one, top), late])[kept])
        forces.append(one.friction[kept])
    table, force = np.concatenate(tables), np.concatenate(forces)
    size = np.linalg.norm(table, axis=0)
    if len(force) <= 2 * len(size) or not size[-1] > 0.0:
        return math.nan, math.inf
    table = table[:, size > 0.0] / size[size > 0.0]
    values = np.linalg.lstsq(table, force, rcond=1e-8)[0]
    seen = ResidualJacobian(
        values=values,
        residual=force - table @ values,
        slopes=table,
        segment=np.zeros(len(force), dtype=np.intp),
    )
    half = infer(seen, np.eye(len(values))).half_widths[-1]
    return float(values[-1] / size[-1]), float(half / size[-1])


def _nuisance(one: MotionSegment, top: float) -> Array:
    """Return what friction and parameters may be (n, p): both free beside the hold."""
    v, load = one.path.velocity, one.path.load
    sign = np.sign(v)
    peaks = [sign * np.exp(-np.square(v / (width * max(top, 1e-300)))) for width in WIDTHS]
    shapes = [shape * load for shape in (sign, *peaks)]
    own = np.column_stack([np.ones_like(v), np.abs(v), v, v * np.abs(v), *shapes])
    linear = np.zeros((len(v), 0)) if one.regressors is None else one.regressors
    return np.column_stack([one.seen(own), linear])


def _joined(found: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Return the weighted mean of estimates with half widths; nothing known if none is."""
    weights = np.array([half**-2.0 if 0.0 < half < math.inf else 0.0 for _, half in found])
    if not weights.any():
        return math.nan, math.inf
    values = np.array([value if math.isfinite(value) else 0.0 for value, _ in found])
    return float(weights @ values / weights.sum()), float(weights.sum()) ** -0.5
