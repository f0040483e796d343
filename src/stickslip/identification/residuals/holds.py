"""Whether a recorded force was held between its samples or went straight to the next.

A held force acts half a sample later than one along straight lines. How late the recorded force
acts is estimated once for a record, before any law is fitted: by regression of the balance of
forces on mass, on friction as a free function of speed, and on the difference between both holds.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.experiments import Measurement, usual_top_speed
from stickslip.formatting import fixed
from stickslip.formulation import JointTorques
from stickslip.identification.estimation.problem import ResidualJacobian
from stickslip.identification.force_map.data import MotionSegment
from stickslip.identification.force_map.force_balance import balanced
from stickslip.identification.force_map.joint_balance import joint_stretches
from stickslip.identification.residuals.trends import (
    BLOCKS,
    FEWEST,
    basis_of,
    beside,
    gains_of,
    half_width_of,
)
from stickslip.identification.series.applied_force import driven
from stickslip.identification.settings import Hold, RecordSettings
from stickslip.mechanisms import Mechanism

Array = NDArray[np.float64]

WIDER: Final = (3.0, 6.0)
"""Factors on what the filter of inverse dynamics passes: half a sample is a fast effect."""
ORDERS: Final = (0, 4)
"""Orders of the autoregressions that make residuals white. Through either filter, both have to find
the same."""
TELLS: Final = 0.4
"""Largest half width of an interval, in half samples, from which the record tells the hold."""
VAGUE: Final = 2.0
"""Half width, in half samples, beyond which an estimate is no reason to assume or say anything."""
BEYOND: Final = 0.5
"""Samples before straight lines, or after a held force, from which no hold is the reason: what is
estimated is then another lateness, or what the free function of speed lacks."""
PEAKS: Final = (0.03, 0.1, 0.3)
"""Widths of peaks of friction about rest, over the largest speed."""


@final
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
    shown: Hold | None = None
    """What the record shows; None where it does not tell."""
    simulated: bool = False
    """Whether runs under either hold were compared, as the balance of forces did not tell."""
    apart: float = 1.0
    """Half samples from what fits take to the farthest that these runs leave open; the other hold,
    at least. A force that is later, or earlier, than either moves estimates by as much more."""

    @property
    def is_open(self) -> bool:
        """Whether fits may take the wrong one: nobody gave it, and nothing tells it."""
        return not self.given and self.shown is None

    @property
    def unsure(self) -> float:
        """Half samples by which the force may act earlier or later than fits take; 0 if given."""
        if self.given:
            return 0.0
        if self.is_open:
            return self.apart
        taken = 0.5 if self.hold == "zero" else 0.0
        return 2.0 * (abs(self.lateness - taken) + self.half_width)

    @property
    def contradicted(self) -> bool:
        """Whether the record shows another hold than was given."""
        return self.shown not in {None, self.hold}

    @property
    def sentence(self) -> str:
        """What is to be said: nothing where the user gave a hold that the record may have."""
        late = (
            f"it acts {fixed(self.lateness, 2)} ± {fixed(self.half_width, 2)} samples later than"
            " along straight lines (0.5 if held)"
        )
        if self.contradicted:
            return (
                f'The record does not agree with the given hold = "{self.hold}": between samples,'
                f" the force {MEANING[self.shown or self.hold]}, or there is a delay of half a"
                f" sample; {late}. Parameters may lie outside their intervals: fit again without a"
                " hold, and compare."
            )
        if self.given:
            return ""
        what = f'{MEANING[self.hold]} (hold = "{self.hold}")'
        if self.shown:
            short = f"{fixed(self.lateness, 2)} ± {fixed(self.half_width, 2)} samples late"
            also = "" if self.shown == "first" else "; a delay of half a sample would look the same"
            by = "by simulation under both holds" if self.simulated else "from the record"
            return f"Estimated {by}: between samples, the force {what}; {short}{also}."
        ends = (self.lateness - self.half_width, self.lateness + self.half_width)
        tells = 2.0 * self.half_width <= VAGUE and not _beyond(*ends)
        told = f"; as estimated, {late}" if tells else ""
        if self.simulated:
            allowed = "intervals allow for either"
            if self.apart > 1.0:
                most = fixed(0.5 * self.apart, 1)
                allowed = (
                    f"by simulation it may act up to {most} samples earlier or later, and the"
                    " intervals include that"
                )
            return (
                "Neither the balance of forces nor simulation under both holds tells whether the"
                " force is held between samples or goes straight to the next value. Assumed: it"
                f" {what}{told}; {allowed}. Give the hold if it is known."
            )
        return (
            "The balance of forces does not tell whether the force is held between samples or goes"
            f" straight to the next value. Assumed: it {what}{told}. Give the hold if it is known,"
            " or fit with both and compare the residuals."
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
            "shown": self.shown,
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
    try:
        along = _joints(mechanism, measurement, vary) if by_joint else _axis(mechanism, measurement)
        found = [
            _joined([_late(*pair, order) for pair in pairs])
            for pairs in map(along, WIDER)
            for order in ORDERS
        ]
    except InputError:  # what is wrong with the record is said where it is fitted
        found = [(math.nan, math.inf)]
    sides = {_side(*one) for one in found}
    shown = sides.pop() if len(sides) == 1 else None
    value, half = found[0]
    # commands are usual, where an estimate is worth nothing
    likely: Hold = "first" if value < 0.5 and half <= VAGUE else "zero"
    if shown is None:
        half = max(width for _, width in found)
    return HoldFinding(
        hold=given or shown or likely,
        given=given is not None,
        lateness=0.5 * value,
        half_width=0.5 * half,
        shown=shown,
    )


def of_simulation(
    finding: HoldFinding, here: ResidualJacobian, other: ResidualJacobian
) -> HoldFinding:
    """Return what runs tell of a hold: `here` under that of a finding, and under the other one.

    Both are of the same values, from which the unknowns may move: how late the force acts is one
    unknown more, whose column is the difference between the runs. Simulation needs no acceleration,
    so that noise of the position hides nothing of half a sample.
    """
    finding = replace(finding, simulated=True)

    def apart(hold: Hold) -> float:
        told = half <= VAGUE or value + half < 0.0 or value - half > 1.0
        off = abs(value - (1.0 if hold == "zero" else 0.0)) + half
        return max(off, 1.0) if told else 1.0

    late = here.residual - other.residual
    if not (here.finite and other.finite):
        return finding
    value, half = _gain_and_half_width(here.slopes, late, here.residual)
    if finding.hold == "zero":  # counted from straight lines
        value = 1.0 - value
    shown = _side(value, half)
    if shown is None and not half < 2.0 * finding.half_width:
        return replace(finding, apart=apart(finding.hold))
    likely: Hold = "first" if value < 0.5 else "zero"
    hold = shown or (likely if half <= VAGUE else finding.hold)
    return replace(
        finding,
        hold=hold,
        apart=apart(hold),
        lateness=0.5 * value,
        half_width=0.5 * half,
        shown=shown,
    )


def _gain_and_half_width(beside: Array, column: Array, residual: Array) -> tuple[float, float]:
    """Return the coefficient of a column beside others (n, p), and the half width of its interval.

    The interval is infinite where the others can take all of the column up.
    """
    basis = basis_of(beside)
    own = column - basis @ (basis.T @ column)
    size = float(np.linalg.norm(own))
    if len(residual) < FEWEST * BLOCKS or not size > 1e-6 * float(np.linalg.norm(column)):
        return math.nan, math.inf
    residual = residual - basis @ (basis.T @ residual)
    _, left_out = gains_of(basis, own[:, None] / size, residual)
    return float(own @ residual) / size**2, half_width_of(left_out[:, 0] / size)


def _beyond(least: float, most: float) -> bool:
    """Whether a force surely acts so many samples early or late that no hold is the reason."""
    return least > 0.5 + BEYOND or most < -BEYOND


def _side(value: float, half: float) -> Hold | None:
    """Return the hold that a number of half samples is nearer to, if it surely is."""
    if not half <= TELLS or _beyond(0.5 * (value - half), 0.5 * (value + half)):
        return None
    if value + half < 0.5:
        return "first"
    return "zero" if value - half > 0.5 else None


Pair = tuple[Sequence[MotionSegment], Sequence[MotionSegment]]


def _axis(mechanism: Mechanism, measurement: Measurement) -> Callable[[float], list[Pair]]:
    """Return what derives stretches with either hold, straight lines first, by `WIDER`."""

    def along(wider: float) -> list[Pair]:
        own = partial(balanced, mechanism, measurement, slipping=True, wider=wider)
        return [(own(hold="first"), own(hold="zero"))]

    return along


def _joints(
    mechanism: Mechanism, measurement: Measurement, vary: Sequence[str]
) -> Callable[[float], list[Pair]]:
    """Return what derives those of each joint."""
    torques = JointTorques.of(mechanism, vary)

    def along(wider: float) -> list[Pair]:
        own = partial(joint_stretches, torques, mechanism, measurement, slipping=True, wider=wider)
        (first,), (zero,) = own(hold="first"), own(hold="zero")
        return list(zip(first, zero, strict=True))

    return along


def _late(
    first: Sequence[MotionSegment], zero: Sequence[MotionSegment], order: int
) -> tuple[float, float]:
    """Return by how many half samples a force acts late, and the half width of its interval.

    The interval is infinite where too few rows slip, or friction and mass can take all up.
    """
    top = max(usual_top_speed(one.path.velocity) for one in first)
    tables, residuals, kept, edges = [], [], [], [0]
    every = max(1, int(0.5 / max(one.passed for one in first))) if order else 1
    for one, other in zip(first, zero, strict=True):
        late = one.friction - other.friction
        tables.append(np.column_stack([_nuisance(one, top), late]))
        residuals.append(one.friction)
        kept.append(one.rows_of(None))
        edges.append(edges[-1] + len(late))
    picked = np.flatnonzero(np.concatenate(kept))
    picked = picked[picked % every == 0]
    rows = with_rows_before(picked, edges, every, order)
    table, residual = np.concatenate(tables)[picked], np.concatenate(residuals)[picked]
    if len(rows) < FEWEST * BLOCKS:
        return math.nan, math.inf
    memory = autoregression(beside(residual, table), rows, order)
    table, residual = whitened(table, rows, memory), whitened(residual, rows, memory)
    return _gain_and_half_width(table[:, :-1], table[:, -1], residual)


def _nuisance(one: MotionSegment, top: float) -> Array:
    """Return what friction and parameters may be (n, p): both free beside the hold."""
    v, load = one.path.velocity, one.path.load
    sign = np.sign(v)
    peaks = [sign * np.exp(-np.square(v / (width * max(top, 1e-300)))) for width in PEAKS]
    shapes = [shape * load for shape in (sign, *peaks)]
    own = np.column_stack([np.ones_like(v), np.abs(v), v, v * np.abs(v), *shapes, *_warmed(one)])
    linear = np.zeros((len(v), 0)) if one.regressors is None else one.regressors
    return np.column_stack([one.seen(own), linear])


def _warmed(one: MotionSegment) -> Iterator[Array]:
    """Yield what levels and viscous friction do along a temperature or pressure that changes."""
    v = one.path.velocity
    for name, values in one.path.inputs.items():
        low, high = float(values.min()), float(values.max())
        if name in ("temperature", "pressure") and high > low:
            share = (2.0 * values - low - high) / (high - low)
            for power in (1, 2, 3):
                yield share**power * v
                yield share**power * np.sign(v) * one.path.load


def _joined(found: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Return the weighted mean of estimates with half widths; nothing known if none is."""
    weights = np.array([half**-2.0 if 0.0 < half < math.inf else 0.0 for _, half in found])
    if not weights.any():
        return math.nan, math.inf
    values = np.array([value if math.isfinite(value) else 0.0 for value, _ in found])
    return float(weights @ values / weights.sum()), float(weights.sum()) ** -0.5


def whitened(columns: Array, rows: NDArray[np.intp], memory: Array) -> Array:
    """Return rows (m, ...) less what an autoregression (order,) says of them from rows before.

    Examples
    --------
    >>> whitened(np.array([1.0, 0.5, 0.25, 1.0]), np.array([1, 2, 3]), np.array([0.5]))
    array([0.   , 0.   , 0.875])
    """
    found = columns[rows].copy()
    for k, coefficient in enumerate(memory.tolist(), 1):
        found -= coefficient * columns[rows - k]
    return np.asarray(found)


def with_rows_before(
    picked: NDArray[np.intp], edges: Sequence[int], every: int, order: int
) -> NDArray[np.intp]:
    """Return which picked samples have `order` picked ones right before them in their stretch."""
    stretch = np.searchsorted(edges, picked, side="right")
    near = (np.diff(picked, prepend=-every - 1) == every) & (np.diff(stretch, prepend=-1) == 0)
    run = np.arange(len(picked)) - np.maximum.accumulate(np.where(near, 0, np.arange(len(picked))))
    return np.flatnonzero(run >= order)


def autoregression(residual: Array, rows: NDArray[np.intp], order: int) -> Array:
    """Return the coefficients (order,) that predict rows from those before them."""
    if not order or not len(rows):
        return np.zeros(order)
    past = np.stack([residual[rows - k] for k in range(1, order + 1)], axis=1)
    return np.asarray(np.linalg.lstsq(past, residual[rows], rcond=1e-8)[0])
