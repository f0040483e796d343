"""Tests on the residuals of a fit: which error of the model, the rig or the record they show.

They are score tests. Each error that is looked for, such as a delay of the force, changes the
balance of forces by a known column: a force that acts late by tau leaves tau dF/dt. Residuals of
the balance are regressed on that column beside the slopes of all parameters that were fitted, so
that what the parameters can take up does not count.

Residuals are autocorrelated, and with many samples any column is significant by the usual formula.
So a column counts by what it predicts: coefficients come from all blocks of the record but one, and
the squares that they take off on that one are its gain. An error is named if the gains of the
blocks are above 0 by Wilcoxon's signed-rank test, corrected for the number of columns tried, if
they add up to a good part of the residuals, and if it matters: for a parameter, by more than its
interval, or by a share of friction.

All this is done twice. Through the filter of inverse dynamics, whose residuals are what disturbs
the friction, slow errors stand out. Through a wider one, with residuals made white by an
autoregression, fast ones do, such as delays.

Source: C. R. Rao, "Large sample tests of statistical hypotheses", 1948 (score tests); F. Wilcoxon,
"Individual comparisons by ranking methods", 1945; D. Cochrane, G. H. Orcutt, 1949 (whitening).
"""

import itertools
import math
import operator
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from scipy import signal, stats
from scipy.ndimage import median_filter
from typing_extensions import override

from stickslip.errors import StickslipError
from stickslip.experiments import Measurement
from stickslip.experiments.signals import noise_of, step_of
from stickslip.experiments.wording import number, percent, quantities, quantity
from stickslip.friction import FrictionLaw
from stickslip.identification.applied import applied_force
from stickslip.identification.force_balance import (
    balanced,
    mean_force,
    passed_by_balance,
    second_differences,
)
from stickslip.identification.force_map import MECHANISM, SENSOR
from stickslip.identification.inverse_dynamics import known_forces, mass_of, positions_of
from stickslip.identification.map_problem import ForceMap
from stickslip.identification.map_records import Stretch
from stickslip.identification.results import Estimate
from stickslip.identification.segmenting import Hold
from stickslip.identification.unknowns import Unknowns
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary

__all__ = ["ModelError", "has_trend", "ljung_box", "model_errors", "noise_floor"]

Array = NDArray[np.float64]
Rows: TypeAlias = NDArray[np.bool_]

BANDS = ((1.0, 0), (3.0, 4))
"""Factor on what the filter of inverse dynamics passes, and order of the autoregression."""
BLOCKS = 20
"""Blocks of a record that are left out in turn."""
FEWEST = 6
"""Rows that a block has at least."""
LEVEL = 0.05
"""Probability that a record without an error is said to have one, all columns together."""
SHARE = 0.10
"""Share of the residuals' squares that an error must predict in blocks left out."""
MATTERS = 0.02
"""Size of an error over that of friction from which it matters, whatever the intervals say."""
NEGLIGIBLE = 0.002
"""Size of an error over that of friction below which it does not, however narrow they are."""
CLOSE = 0.9
"""Share of the largest gain from which a column with fewer coefficients is preferred."""
MOST = 3
"""Errors that are named at most."""
SAMPLES = 4_000
"""Samples of a record, unless its filter asks for more."""
OVERSAMPLED = (0.25, 0.5)
"""Most that the filter passes over half the frequency of the rows: where residuals are made white,
rows that hardly differ would say nothing."""
TAKEN_UP = 0.01
"""Share of a column beside what was fitted below which the parameters take it up."""
RIDGE = 1e-6
"""Share of the whole record that each coefficient is drawn to 0 by, where a block has it all."""
SPECTRA = 8
"""Parts of a record over which spectra are averaged, which overlap by half."""
PEAK = 6.0
"""Power of the residuals at a frequency over the median near it: by chance, less than 4."""
NEAR = 15
"""Frequencies on either side that this median is taken over."""
OWN = 0.3
"""Power of force or inertia over that of the other at a peak below which it has no part in it."""
CELLS = 12
"""Cells of a quantity in which residuals are averaged to see a trend."""
TREND = 0.01
"""Share of the squared residuals that a trend must predict to be one."""
LAGS = 20
"""Lags of the test for autocorrelation."""
WAVES = 40
"""Waves over the stroke that are looked for at most."""
SPEEDS = (0.05, 0.1, 0.2, 0.4)
"""Speeds over the largest at which a peak of friction near rest is looked for. Slower, rows are few
and see what is at rest through the filter."""
WAYS = (0.003, 0.01, 0.03, 0.1)
"""Ways after a reversal, over the stroke, within which something else is looked for."""
UNSAID = "The 95 % intervals of the estimates do not allow"
HALF = (0.35, 0.65)
"""Delays over the step of time which are those of a wrong setting of hold."""
LIMITS = (0.6, 0.75, 0.9)
"""Quantiles of the force's size from which a limit is looked for."""


@final
@dataclass(frozen=True, kw_only=True)
class ModelError:
    """One error of the model, the rig or the record that the residuals of a fit show.

    Examples
    --------
    >>> late = ModelError(
    ...     kind="delay",
    ...     finding="The motion follows the force 12 ms late.",
    ...     consequence="Intervals do not allow for it.",
    ...     effect=0.012,
    ...     interval=(0.011, 0.013),
    ...     share=0.9,
    ... )
    >>> str(late)
    'The motion follows the force 12 ms late. Intervals do not allow for it.'
    """

    kind: str
    """What it is, such as ``"delay"`` or ``"position friction"``."""
    finding: str
    """What it is, with its size, in a sentence."""
    consequence: str
    """How much of the residuals it is, and what it does to the estimates, in sentences."""
    effect: float
    """Its size, SI: a time, a force, a stiffness or a share, as the sentence says."""
    interval: tuple[float, float]
    """95 % confidence interval of the size, from leaving blocks out."""
    share: float
    """Share of the squared residuals that it predicts in blocks left out."""

    @override
    def __str__(self) -> str:
        """Return what it is and what it does."""
        return f"{self.finding} {self.consequence}"

    def to_dict(self) -> Mapping[str, Any]:
        """Return the error as plain numbers and strings."""
        return {
            "kind": self.kind,
            "sentence": str(self),
            "effect": self.effect,
            "interval": list(self.interval),
            "share": self.share,
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Signals:
    """What errors are made of, all samples of all stretches (n,) end to end."""

    time: Array
    """From the start of each record [s]."""
    position: Array
    velocity: Array
    """Slip velocity [m/s]."""
    level: Array
    """Sign of slip times the load."""
    since: Array
    """Way since the last reversal [m]."""
    force: Array
    """Filtered force that inertia and friction take [N]."""
    acceleration: Array
    """Filtered as well."""
    edges: tuple[int, ...]
    """Where stretches begin, and the end."""

    def each(self, of: Callable[[Array, Array], Array]) -> Array:
        """Return a function of times and forces, stretch by stretch (n,)."""
        spans = [slice(a, b) for a, b in itertools.pairwise(self.edges)]
        return np.concatenate([of(self.time[own], self.force[own]) for own in spans])

    @property
    def rate(self) -> Array:
        """Rate of the force [N/s]."""
        return self.each(lambda t, force: np.gradient(force, t))

    @property
    def bend(self) -> Array:
        """Second rate of the force [N/s^2]."""
        return self.each(lambda t, force: np.gradient(np.gradient(force, t), t))

    @property
    def stroke(self) -> float:
        """Range of the position [m]."""
        return float(np.ptp(self.position))

    @property
    def middle(self) -> Array:
        """Position from the middle of the stroke [m]."""
        return self.position - 0.5 * float(self.position.max() + self.position.min())

    @property
    def pace(self) -> Array:
        """Velocity over the largest speed."""
        return np.asarray(self.velocity / max(float(np.max(np.abs(self.velocity))), 1e-300))

    @property
    def course(self) -> Array:
        """Time over the duration, from -1/2 to 1/2."""
        return np.asarray(self.time / max(float(np.ptp(self.time)), 1e-300) - 0.5)


@dataclass(frozen=True, eq=False)
class Effect:
    """What an error adds to the balance of forces, but for its coefficients."""

    kind: str
    columns: Callable[[Signals], tuple[Array, ...]]
    """Columns (n,) of it."""
    scale: float = 0.0
    """What these are made with: a length, a force, a time, a share of the speed."""
    filtered: bool = False
    """Whether they are made of what came through the filter."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Balance:
    """The balance of forces along a record, through one filter.

    Its rows (m,) are those samples where slip is sure and rows enough come before, made white.
    """

    residual: Array
    """Force less inertia, springs, friction and offset, made white (m,)."""
    slopes: Array
    """Derivatives of the predicted force by what was fitted, made white (m, p)."""
    friction: float
    """Root mean square of friction and offset by the law [N]."""
    passed: float
    """Highest frequency that the filter passes [Hz]."""
    signals: Signals
    stretches: tuple[Stretch, ...]
    picked: NDArray[np.intp]
    """Which samples are looked at."""
    rows: NDArray[np.intp]
    """Which of these are rows (m,)."""
    memory: Array
    """Coefficients of the autoregression (order,)."""

    def seen(self, effects: Sequence[Effect]) -> list[Array]:
        """Return the columns of effects in the picked samples, filtered as residuals are."""
        columns = [np.stack(one.columns(self.signals), axis=1) for one in effects]
        raw = [k for k, one in enumerate(effects) if not one.filtered]
        if raw:
            # all at once: designing a filter takes longer than applying it
            table = np.concatenate([columns[k] for k in raw], axis=1)
            spans = itertools.pairwise(self.signals.edges)
            table = np.concatenate(
                [one.seen(table[a:b]) for one, (a, b) in zip(self.stretches, spans, strict=True)]
            )
            ends = np.cumsum([columns[k].shape[1] for k in raw])
            for k, part in zip(raw, np.split(table, ends[:-1], axis=1), strict=True):
                columns[k] = part
        return [column[self.picked] for column in columns]

    def white(self, columns: Array) -> Array:
        """Return the rows (m, q) of picked samples, less what those before say of them."""
        return whitened(columns, self.rows, self.memory)


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


@dataclass(frozen=True, kw_only=True, eq=False)
class ScoreTest:
    """An effect with what it predicts and its coefficients."""

    effect: Effect
    share: float
    """Squares that it takes off in blocks left out, over those of the residuals."""
    chance: float
    """Probability of such gains without it."""
    values: Array
    """Coefficients (q,)."""
    left_out: Array
    """The same with each block left out (blocks, q)."""
    shift: Array
    """By how much the fitted parameters change with it (p,)."""
    size: float
    """Root mean square of what it adds to the balance, over friction."""

    @property
    def sure(self) -> bool:
        """Whether the interval of some coefficient leaves 0 out: not so where one block has all."""
        ends = [self.interval(operator.itemgetter(k)) for k in range(len(self.values))]
        return any(low > 0.0 or high < 0.0 for low, high in ends)

    def interval(self, of: Callable[[Array], float]) -> tuple[float, float]:
        """Return the 95 % interval of a number that follows from the coefficients."""
        changes = np.array([of(one) for one in self.left_out])
        count = len(changes)
        error = math.sqrt((count - 1) / count * float(np.sum((changes - changes.mean()) ** 2)))
        half = float(stats.t.ppf(0.975, count - 1)) * error
        return of(self.values) - half, of(self.values) + half


def model_errors(
    mechanism: Mechanism,
    law: FrictionLaw,
    measurement: Measurement,
    unknowns: Unknowns,
    estimates: Sequence[Estimate],
    *,
    hold: Hold,
) -> tuple[ModelError, ...]:
    """Return the errors of the model that the residuals of a fit show, the largest first.

    Parameters
    ----------
    mechanism, law : Mechanism, FrictionLaw
        With the fitted values.
    measurement : Measurement
        Records in time with position or velocity, and the force applied.
    unknowns : Unknowns
        What was fitted.
    estimates : sequence of Estimate
        Its intervals, in the same order.
    hold : {"zero", "first"}
        Whether a force keeps its value until the next sample or goes straight to it.

    Returns
    -------
    tuple of ModelError
        None if nothing is shown, or nothing can be: friction that was measured, several
        coordinates, too short a record.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> t = np.arange(0.0, 20.0, 0.005)
    >>> v = np.sin(2.0 * t) + 0.5 * np.sin(5.1 * t)
    >>> a = 2.0 * np.cos(2.0 * t) + 2.55 * np.cos(5.1 * t)
    >>> x = -0.5 * np.cos(2.0 * t) - 0.5 / 5.1 * np.cos(5.1 * t)
    >>> force = 3.0 * a + 2.0 * np.sign(v) + 4.0 * x
    >>> record = Measurement(time=t, position=x, force=force)
    >>> axis, law = Axis(inertia=3.0), Coulomb(kinetic_coefficient=2.0)
    >>> (one,) = model_errors(axis, law, record, Unknowns(()), (), hold="first")
    >>> one.kind, round(one.effect, 1)
    ('spring', 4.0)
    """
    try:
        balances = [
            _balance(mechanism, law, measurement, unknowns, estimates, hold, wider, order)
            for wider, order in BANDS
        ]
    except StickslipError:
        return ()
    if not all(len(b.rows) >= FEWEST * BLOCKS and np.isfinite(b.residual).all() for b in balances):
        return ()
    lines = _peaks(mechanism, law, measurement, balances[0], hold)
    return (*_shown(balances, estimates, measurement), *lines)


def _peaks(
    mechanism: Mechanism,
    law: FrictionLaw,
    measurement: Measurement,
    balance: Balance,
    hold: Hold,
) -> Iterator[ModelError]:
    """Yield what stands out of the spectrum of the unfiltered residuals, at any frequency.

    A vibration is in the motion and not in the force, a ripple of the recorded force is not in the
    motion; what is in both is how the rig was driven.
    """
    stretches = balanced(mechanism, measurement, hold=hold, samples=math.inf)
    longest = max(stretches, key=lambda one: len(one.path.time))
    time = longest.path.time
    rate = 1.0 / float(np.mean(np.diff(time)))
    force, inertial, left = _unfiltered(mechanism, law, measurement, longest, hold)
    length = 2 ** int(math.log2(2.0 * len(time) / (SPECTRA + 1.0)))
    if length < 4 * NEAR:
        return
    at, *powers = _spectra(rate, length, (left, force, inertial))
    floors = [median_filter(one, size=2 * NEAR + 1, mode="nearest") for one in powers]
    inner = slice(NEAR // 2, len(at) - NEAR // 2)
    peak = inner.start + int(np.argmax((powers[0] / np.maximum(floors[0], 1e-300))[inner]))
    near = slice(peak - 1, peak + 2)
    residual, pushed, moved = (
        float(np.sum(np.maximum(one - floor, 0.0)[near]))
        for one, floor in zip(powers, floors, strict=True)
    )
    size = math.sqrt(residual * float(at[1]))
    if powers[0][peak] < PEAK * floors[0][peak] or size < MATTERS * balance.friction:
        return
    ripple = moved < OWN * pushed < residual < pushed / OWN
    if not ripple and not pushed < OWN * moved < residual < moved / OWN:
        return
    unit, where = measurement.unit("force"), quantity(float(at[peak]), "Hz")
    sized = f"at {where}, a root mean square of {quantity(size, unit)}"
    text = (
        f"The recorded force has a peak {sized}, that the motion does not have: a ripple of the"
        " amplifier or sensor, perhaps of a higher frequency that sampling folded."
        if ripple
        else f"The motion vibrates {sized} of inertia, that the recorded force does not have: a"
        " flexible coupling or mount, or a disturbance."
    )
    step = float(at[1])
    yield ModelError(
        kind="ripple" if ripple else "vibration",
        finding=text,
        consequence=f"{UNSAID} for it.",
        effect=float(at[peak]),
        interval=(float(at[peak]) - step, float(at[peak]) + step),
        share=residual / float(np.sum(powers[0])),
    )


def _spectra(rate: float, length: int, signals: Sequence[Array]) -> tuple[Array, ...]:
    """Return frequencies [Hz] and power densities of signals, each averaged over parts."""
    found = [signal.welch(one, rate, nperseg=length, detrend="linear") for one in signals]
    return (found[0][0], *(power for _, power in found))


def _unfiltered(
    mechanism: Mechanism, law: FrictionLaw, measurement: Measurement, one: Stretch, hold: Hold
) -> tuple[Array, Array, Array]:
    """Return known forces, inertia and what both leave of friction (n,) [N], none filtered."""
    record = measurement.records()[one.record]
    time = np.asarray(record.time)
    first = int(np.searchsorted(time, one.path.time[0]))
    rows = slice(first, first + len(one.path.time))
    x, applied = positions_of(record)[rows], applied_force(mechanism, record)
    joined = hold == "first" or "force" not in record.quantities()
    force = np.zeros(len(time)) if applied is None else mean_force(applied, joined=joined)
    mass, rest = known_forces(mechanism, x, one.path.velocity, force[rows])
    problem = ForceMap(
        law=law,
        unknowns_=Unknowns(()),
        stretches=(replace(one, passed=0.0, segment=np.zeros(len(x), dtype=np.intp)),),
        offset=float(getattr(mechanism, "offset", 0.0)),
    )
    inertial = mass * second_differences(x, float(np.mean(np.diff(one.path.time))))
    return rest, inertial, rest - inertial - problem.predicted(np.zeros(0))


def _balance(
    mechanism: Mechanism,
    law: FrictionLaw,
    measurement: Measurement,
    unknowns: Unknowns,
    estimates: Sequence[Estimate],
    hold: Hold,
    wider: float,
    order: int,
) -> Balance:
    def stretched(one: Mechanism) -> tuple[Stretch, ...]:
        return balanced(one, measurement, hold=hold, samples=SAMPLES, wider=wider)

    stretches = stretched(mechanism)
    fitted = {**_numbers(law, "friction"), **_numbers(mechanism, "mechanism")}
    fitted |= {estimate.path: estimate.value for estimate in estimates}
    constant = SENSOR if SENSOR in unknowns.paths else MECHANISM
    along = [
        i
        for i, path in enumerate(unknowns.paths)
        if path.startswith("friction.") or path == constant
    ]
    own = Unknowns(tuple(unknowns.items[i] for i in along), fitted)
    problem = ForceMap(
        law=law,
        unknowns_=own,
        stretches=stretches,
        constant=constant,
        offset=fitted.get(constant, 0.0),
        mass=mass_of(mechanism),
    )
    seen = problem.linearise(np.array([fitted[path] for path in own.paths]))
    slopes = np.zeros((len(seen.residual), len(unknowns)))
    slopes[:, along] = seen.slopes
    for i in set(range(len(unknowns))) - set(along):
        path = unknowns.paths[i]
        step = 1e-4 * max(abs(fitted[path]), 1e-6)
        moved = stretched(vary(mechanism, "mechanism", {path: fitted[path] + step}))
        slopes[:, i] = (_kept(stretches) - _kept(moved)) / step
    widest = max(one.passed for one in stretches)
    every = max(1, int(OVERSAMPLED[bool(order)] / widest))
    edges = (0, *itertools.accumulate(len(one.path.time) for one in stretches))
    kept = np.flatnonzero(np.concatenate([one.rows_of(None) for one in stretches]))
    chosen = kept % every == 0
    picked = kept[chosen]
    rows = _with_rows_before(picked, edges, every, order)
    residual, slopes = seen.residual[chosen], slopes[chosen]
    memory = _autoregression(_beside(residual, slopes), rows, order)
    return Balance(
        residual=whitened(residual, rows, memory),
        slopes=whitened(slopes, rows, memory),
        friction=float(np.sqrt(np.mean((_kept(stretches) - seen.residual) ** 2))),
        passed=0.5 * widest / float(np.mean(np.diff(stretches[0].path.time))),
        signals=_signals(stretches, measurement, mechanism, edges),
        stretches=stretches,
        picked=picked,
        rows=rows,
        memory=memory,
    )


def _numbers(model: Mechanism | FrictionLaw, room: str) -> dict[str, float]:
    return {path: float(value) for path, _, value in parameters(model, room)}


def _kept(stretches: Sequence[Stretch]) -> Array:
    return np.concatenate([one.friction[one.rows_of(None)] for one in stretches])


def _with_rows_before(
    picked: NDArray[np.intp], edges: Sequence[int], every: int, order: int
) -> NDArray[np.intp]:
    """Return which picked samples have `order` picked ones right before them in their stretch."""
    stretch = np.searchsorted(edges, picked, side="right")
    near = (np.diff(picked, prepend=-every - 1) == every) & (np.diff(stretch, prepend=-1) == 0)
    run = np.arange(len(picked)) - np.maximum.accumulate(np.where(near, 0, np.arange(len(picked))))
    return np.flatnonzero(run >= order)


def _autoregression(residual: Array, rows: NDArray[np.intp], order: int) -> Array:
    """Return the coefficients (order,) that predict rows from those before them."""
    if not order or not len(rows):
        return np.zeros(order)
    past = np.stack([residual[rows - k] for k in range(1, order + 1)], axis=1)
    return np.asarray(np.linalg.lstsq(past, residual[rows], rcond=1e-8)[0])


def _signals(
    stretches: Sequence[Stretch],
    measurement: Measurement,
    mechanism: Mechanism,
    edges: tuple[int, ...],
) -> Signals:
    parts = [_part(one, measurement, mechanism) for one in stretches]
    columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return Signals(edges=edges, **columns)


def _part(one: Stretch, measurement: Measurement, mechanism: Mechanism) -> dict[str, Array]:
    """Return the signals of a stretch."""
    record = measurement.records()[one.record]
    t, v = one.path.time, one.path.velocity
    way = np.concatenate([[0.0], np.cumsum(np.abs(one.path.travel))])
    turned = np.concatenate([[0], np.flatnonzero(np.diff(np.sign(v)) != 0) + 1])
    last = turned[np.searchsorted(turned, np.arange(len(t)), side="right") - 1]
    assert one.acceleration is not None
    return {
        "time": t - float(np.asarray(record.time)[0]),
        "position": np.interp(t, np.asarray(record.time), positions_of(record)),
        "velocity": v,
        "level": np.sign(v) * one.path.load,
        "since": way - way[last],
        "force": one.friction + mass_of(mechanism) * one.acceleration,
        "acceleration": one.acceleration,
    }


def _effects(s: Signals, passed: float, *, driven: bool) -> Iterator[Effect]:
    """Yield the errors that are looked for, those with fewer coefficients first."""
    if driven:
        yield _delay(0.0)
        yield Effect("clock", lambda s: (s.time * s.rate,), filtered=True)
        yield Effect("flexibility", lambda s: (s.bend,), filtered=True)
        for limit in np.quantile(np.abs(s.force), LIMITS).tolist():
            yield Effect("force limit", partial(_beyond, limit), limit)
    yield Effect("inertia", lambda s: (s.acceleration,), filtered=True)
    yield Effect("offset", lambda s: (np.ones_like(s.time),))
    yield Effect("drift of the level", lambda s: (s.course * s.level,))
    yield Effect("drift of the offset", lambda s: (s.course,))
    yield Effect("drift of the viscous part", lambda s: (s.course * s.pace,))
    yield Effect("asymmetry", lambda s: (np.abs(s.pace),))
    yield Effect("speed", lambda s: (s.pace * np.abs(s.pace),))
    for share in SPEEDS:
        yield Effect("speed", partial(_peak, share), share)
    yield Effect("spring", lambda s: (s.middle,))
    yield Effect(
        "position friction", lambda s: (2.0 * s.level * s.middle / s.stroke,), 2.0 * s.stroke
    )
    for way in (share * s.stroke for share in WAYS):
        yield Effect("after reversals", partial(_after_reversals, _level, way), way)
        yield Effect("after reversals", partial(_after_reversals, _acceleration, way), way)
    # of finer waves, the filter leaves nothing at the usual speed
    usual = float(np.percentile(np.abs(s.velocity), 75.0))
    finest = max(min(int(passed * s.stroke / usual), WAVES), 1)
    for length in (2.0 * s.stroke / k for k in range(1, 2 * finest + 1)):
        yield Effect("position force", partial(_waves, _one, length), length)
        yield Effect("position friction", partial(_waves, _level, length), length)
        yield Effect("imbalance", partial(_waves, _squared, length), length)


def _one(s: Signals) -> Array:
    return np.ones_like(s.time)


def _level(s: Signals) -> Array:
    return s.level


def _acceleration(s: Signals) -> Array:
    return s.acceleration


def _squared(s: Signals) -> Array:
    return np.asarray(s.pace**2)


def _waves(of: Callable[[Signals], Array], length: float, s: Signals) -> tuple[Array, ...]:
    """Return what goes with cosine and sine of the position at a wavelength [m]."""
    phase = 2.0 * math.pi / length * s.middle
    return of(s) * np.cos(phase), of(s) * np.sin(phase)


def _after_reversals(of: Callable[[Signals], Array], way: float, s: Signals) -> tuple[Array, ...]:
    """Return what fades with the way [m] after each reversal."""
    return (of(s) * np.exp(-s.since / way),)


def _beyond(limit: float, s: Signals) -> tuple[Array, ...]:
    """Return what of the force is beyond a limit [N] to either side."""
    return (np.sign(s.force) * np.maximum(np.abs(s.force) - limit, 0.0),)


def _peak(share: float, s: Signals) -> tuple[Array, ...]:
    """Return friction that falls from rest within a share of the largest speed."""
    return (s.level * np.exp(-np.abs(s.pace) / share),)


def _delay(delay: float) -> Effect:
    """Return what a force that acts late leaves: to first order, or of a known delay [s]."""

    def columns(s: Signals) -> tuple[Array, ...]:
        if not delay:
            return (s.rate,)
        return (s.each(lambda t, force: (force - np.interp(t - delay, t, force)) / delay),)

    return Effect("delay", columns, delay, filtered=True)


def _basis(slopes: Array) -> Array:
    """Return orthonormal columns (m, r) that span those of a table (m, p)."""
    size = np.linalg.norm(slopes, axis=0)
    if not np.any(size > 0.0):
        return np.zeros((len(slopes), 0))
    u, s, _ = np.linalg.svd(slopes[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    return np.asarray(u[:, s > 1e-7 * s[0]])


def _beside(columns: Array, slopes: Array) -> Array:
    """Return columns (m, ...) less what slopes (m, p) can take up."""
    basis = _basis(slopes)
    return np.asarray(columns - basis @ (basis.T @ columns))


def _tested(
    b: Balance, basis: Array, residual: Array, effect: Effect, column: Array, total: float
) -> ScoreTest | None:
    """Return what an effect predicts in blocks left out.

    None if that is little, or parameters can take it up.

    `basis` (m, r) spans what is fitted beside it, `residual` (m,) has nothing of that.
    """
    columns = b.white(column)
    own = columns - basis @ (basis.T @ columns)
    size = np.linalg.norm(columns, axis=0)
    if np.any(np.linalg.norm(own, axis=0) <= TAKEN_UP * size) or not np.all(size > 0.0):
        return None
    directions, triangle = np.linalg.qr(own)
    if abs(triangle[-1, -1]) <= TAKEN_UP * size[-1]:
        return None
    if float(np.sum((directions.T @ residual) ** 2)) < SHARE * total:
        return None  # in blocks left out, it is less
    gains, left_out = _gains(basis, directions, residual)
    share = float(gains.sum()) / total
    back = np.linalg.inv(triangle)
    values = back @ (directions.T @ residual)
    chance = 1.0
    if share >= SHARE:
        chance = float(stats.wilcoxon(gains, alternative="greater").pvalue)
    return ScoreTest(
        effect=effect,
        share=share,
        chance=chance,
        values=values,
        left_out=left_out @ back.T,
        shift=np.asarray(-np.linalg.lstsq(b.slopes, columns @ values, rcond=1e-10)[0]),
        size=float(np.sqrt(np.mean((column @ values) ** 2))) / b.friction,
    )


def _gains(basis: Array, directions: Array, residual: Array) -> tuple[Array, Array]:
    """Return the squares (blocks,) that directions (m, q) take off each block when it is left out.

    And their coefficients without it (blocks, q). What `basis` (m, p) takes off is no gain; all
    columns are orthonormal.
    """
    table = np.column_stack([basis, directions])
    p = basis.shape[1]
    starts = np.linspace(0, len(residual), BLOCKS + 1).astype(int)
    rows = [slice(first, last) for first, last in itertools.pairwise(starts.tolist())]
    squares = np.array([table[own].T @ table[own] for own in rows])
    slopes = np.array([table[own].T @ residual[own] for own in rows])
    # columns are orthonormal over all rows, so that a ridge is a share of them
    rest = squares.sum(axis=0) - squares + RIDGE * np.eye(len(squares[0]))
    wanted = (slopes.sum(axis=0) - slopes)[..., None]
    without = np.linalg.solve(rest[:, :p, :p], wanted[:, :p])[..., 0]
    found = np.linalg.solve(rest, wanted)[..., 0]
    gains = _taken_off(found, squares, slopes) - _taken_off(
        without, squares[:, :p, :p], slopes[:, :p]
    )
    return gains, np.asarray(found[:, p:])


def has_trend(residual: Array, by: Array) -> bool:
    """Whether residuals (n,) in the order of time follow a quantity (n,), such as the velocity.

    Their means in cells of the quantity, from all blocks but one, must take squares off that one:
    in so many blocks that chance would do so in one record of 20.

    Examples
    --------
    >>> random = np.random.default_rng(1)
    >>> noise, v = random.normal(size=2000), np.sin(0.1 * np.arange(2000))
    >>> has_trend(noise, v), has_trend(noise + 0.3 * np.sign(v), v)
    (False, True)
    """
    if len(residual) < FEWEST * BLOCKS or np.ptp(by) == 0.0:
        return False
    u = 2.0 * (by - by.min()) / np.ptp(by) - 1.0
    if np.all(np.diff(by) >= 0.0):  # time: a block left out is a cell by itself
        columns = np.polynomial.legendre.legvander(u, 3)
    else:
        cell = np.minimum((0.5 * (u + 1.0) * CELLS).astype(int), CELLS - 1)
        columns = np.eye(CELLS)[cell]
    gains, _ = _gains(np.zeros((len(u), 0)), _basis(columns), residual)
    share = float(gains.sum()) / max(float(residual @ residual), 1e-300)
    chance = 1.0 if share < TREND else float(stats.wilcoxon(gains, alternative="greater").pvalue)
    return chance < LEVEL


def ljung_box(residual: Array, lags: int = LAGS) -> float:
    """Return the probability of autocorrelations as large as these in white residuals (n,).

    Source: G. M. Ljung, G. E. P. Box, "On a measure of lack of fit in time series models", 1978.

    Examples
    --------
    >>> white = np.random.default_rng(1).normal(size=1000)
    >>> ljung_box(white) > 0.05, ljung_box(white[1:] + white[:-1]) < 1e-6
    (True, True)
    """
    r, n = residual - residual.mean(), len(residual)
    power = float(r @ r)
    if power <= 0.0 or n <= lags:
        return 1.0
    squares = [float(r[k:] @ r[:-k]) ** 2 / (n - k) for k in range(1, lags + 1)]
    return float(stats.chi2.sf(n * (n + 2.0) * sum(squares) / power**2, lags))


def noise_floor(mechanism: Mechanism, measurement: Measurement, compared: str) -> float:
    """Return the residuals that the sensor's noise alone would leave (root mean square, SI).

    Parameters
    ----------
    mechanism : Mechanism
        With its mass: where friction was derived from a force, the noise of positions is one of
        accelerations, after the filter.
    measurement : Measurement
        Records in time.
    compared : str
        What residuals are of: ``"position"``, ``"velocity"`` or ``"friction"``.

    Returns
    -------
    float
        From third differences, which no smooth motion has; not a number where nothing says.

    Examples
    --------
    >>> from stickslip import Axis
    >>> t = np.arange(0.0, 2.0, 1e-3)
    >>> noise = 1e-6 * np.random.default_rng(1).normal(size=len(t))
    >>> record = Measurement(time=t, position=np.sin(t) + noise)
    >>> round(noise_floor(Axis(inertia=1.0), record, "position") * 1e6, 1)
    1.0
    """
    found = []
    for record in measurement.records():
        known = record.quantities()
        if record.time is None or (compared not in known and "position" not in known):
            return math.nan
        values = np.asarray(record.values(compared if compared in known else "position"))
        noise = noise_of(values, step_of(values))
        if compared not in known:  # white noise s has accelerations of variance s^2 w^5 / (5 pi)
            w = math.pi * passed_by_balance(values)
            step = float(np.median(np.diff(record.time)))
            noise *= mass_of(mechanism) * math.sqrt(w**5 / (5.0 * math.pi)) / step**2
        found.append(noise)
    return float(np.sqrt(np.mean(np.square(found))))


def _taken_off(values: Array, squares: Array, slopes: Array) -> Array:
    """Return the squares (b,) that coefficients (b, p) take off each block."""
    found: Array = 2.0 * np.einsum("bp,bp->b", values, slopes) - np.einsum(
        "bp,bpq,bq->b", values, squares, values
    )
    return found


def _shown(
    balances: Sequence[Balance], estimates: Sequence[Estimate], measurement: Measurement
) -> Iterator[ModelError]:
    """Yield the errors that residuals show, each beside those before it."""
    driven = "force" in measurement.quantities()
    widest = max(balances, key=lambda b: b.passed)
    effects = list(_effects(widest.signals, widest.passed, driven=driven))
    columns = [b.seen(effects) for b in balances]
    totals = [float(np.sum(_beside(b.residual, b.slopes) ** 2)) for b in balances]
    fitted = [b.slopes for b in balances]
    kinds = Counter(one.kind for one in effects)
    tried = {kind: len(kinds) * count * len(balances) for kind, count in kinds.items()}
    named: set[str] = set()
    for _ in range(MOST):
        shown: list[ScoreTest] = []
        for b, own, slopes, total in zip(balances, columns, fitted, totals, strict=True):
            basis = _basis(slopes)
            residual = b.residual - basis @ (basis.T @ b.residual)
            tests = (
                _tested(b, basis, residual, one, column, total)
                for one, column in zip(effects, own, strict=True)
                if one.kind not in named
            )
            shown += [
                one
                for one in tests
                if one is not None and _is_shown(one, estimates, tried[one.effect.kind])
            ]
        if not shown:
            return
        most = max(one.share for one in shown)
        best = min(
            (one for one in shown if one.share >= CLOSE * most),
            key=lambda one: (len(one.values), -one.share),
        )
        named.add(best.effect.kind)
        yield _error(best, estimates, measurement)
        known = best.effect
        if known.kind == "delay":  # exactly so much late, beyond first order
            known = _delay(float(best.values[0]))
        fitted = [
            np.column_stack([slopes, b.white(b.seen([known])[0])])
            for b, slopes in zip(balances, fitted, strict=True)
        ]


def _is_shown(one: ScoreTest, estimates: Sequence[Estimate], tried: int) -> bool:
    """Whether an effect is significant, predicts a good part of the residuals, and matters."""
    if one.share < SHARE or one.chance * tried > LEVEL or not one.sure:
        return False
    return one.size > MATTERS or (one.size > NEGLIGIBLE and bool(_moved(one, estimates)))


def _moved(one: ScoreTest, estimates: Sequence[Estimate]) -> list[tuple[Estimate, float]]:
    """Return the estimates that an effect moves out of their intervals, and by how much."""
    return [
        (estimate, float(shift))
        for estimate, shift in zip(estimates, one.shift, strict=True)
        if estimate.bounded and not estimate.low <= estimate.value + float(shift) <= estimate.high
    ]


def _error(one: ScoreTest, estimates: Sequence[Estimate], measurement: Measurement) -> ModelError:
    size = _size_of(one)
    low, high = one.interval(size)
    moved = [
        f"{estimate.quantity.symbol} by {percent(abs(shift / estimate.value))}"
        for estimate, shift in _moved(one, estimates)
        if estimate.value
    ]
    text = (
        f"It predicts {percent(min(one.share, 1.0))} of the squared residuals in blocks of the"
        " record left out."
    )
    if moved:
        text += f" It moves {_joined(moved)}, farther than"
    return ModelError(
        kind=one.effect.kind,
        finding=_said(one, size(one.values), (low, high), measurement),
        consequence=f"{text} the 95 % intervals allow." if moved else f"{text} {UNSAID} for it.",
        effect=size(one.values),
        interval=(low, high),
        share=one.share,
    )


def _joined(items: Sequence[str]) -> str:
    return " and ".join([", ".join(items[:-1]), items[-1]] if len(items) > 1 else items)


def _size_of(one: ScoreTest) -> Callable[[Array], float]:
    """Return what makes one number of the coefficients (q,): the amplitude of a wave."""
    if len(one.values) == 1:
        return lambda values: float(values[0])
    return lambda values: float(np.hypot(*values))


def _half_sample(delay: float, measurement: Measurement) -> str:
    """Return that a delay [s] may be a wrong setting: a held force is half a sample late."""
    step = max(float(np.median(np.diff(np.asarray(r.time)))) for r in measurement.records())
    if not HALF[0] <= abs(delay) / step <= HALF[1]:
        return ""
    hold = "zero, as a command that is held" if delay > 0.0 else "first, as a sensor samples it"
    return f"half a sample, which the setting hold would be ({hold}), or "


def _said(
    one: ScoreTest, value: float, interval: tuple[float, float], measurement: Measurement
) -> str:
    """Return what an error is, with its size and interval."""
    kind, scale = one.effect.kind, one.effect.scale
    force, way = measurement.unit("force"), measurement.unit("position")

    def sized(unit: str, sign: float = 1.0) -> str:
        low, high = sorted(sign * end for end in interval)
        ends = quantities([low, high], unit)
        return f"{quantity(sign * value, unit)} (95 % interval {ends[0]} to {ends[1]})"

    sign, peaked = -1.0 if value < 0.0 else 1.0, scale > 0.0
    half = _half_sample(value, measurement) if kind == "delay" else ""
    wave = f"wavelength {quantity(scale, way)}"
    said = {
        "delay": (
            f"The motion follows the recorded force {sized('s')} late:"
            f" {half}a delay or lag of the amplifier or of the position sensor, or two clocks."
            if value > 0.0
            else f"The recorded force follows the motion {sized('s', -1.0)} late:"
            f" {half}a delay or filter of the force sensor, or two clocks."
        ),
        "clock": (
            f"The delay between motion and force grows by {sized('s')} each second: two clocks that"
            " run apart."
        ),
        "flexibility": (
            "Fast forces do not move one rigid mass: the residuals follow the second rate of the"
            f" force with {number(value)} s² ({number(interval[0])} to {number(interval[1])}), as a"
            " flexible coupling, belt or mount makes them."
        ),
        "force limit": (
            f"Of the recorded force beyond {quantity(scale, force)}, {percent(abs(value))}"
            + (
                " does not act: a limit of the amplifier."
                if value > 0.0
                else " is missing: a limit of the force sensor."
            )
        ),
        "inertia": (
            f"The motion takes {sized('kg', sign)} {'more' if value > 0.0 else 'less'} than the"
            " mass given: a wrong mass, or a wrong gain of the force."
        ),
        "offset": f"A constant force of {sized(force)} acts beside friction, such as gravity.",
        "drift of the level": (
            f"The friction level {'rises' if value > 0.0 else 'falls'} over the record, by"
            f" {sized(force, sign)}."
        ),
        "drift of the offset": (
            f"A force beside friction {'rises' if value > 0.0 else 'falls'} over the record, by"
            f" {sized(force, sign)}."
        ),
        "drift of the viscous part": (
            f"The viscous part {'rises' if value > 0.0 else 'falls'} over the record, at the"
            f" largest speed by {sized(force, sign)}: warm-up, for instance."
        ),
        "asymmetry": (
            "The viscous part differs by direction, at the largest speed by"
            f" {sized(force, sign)} to either side."
        ),
        "speed": (
            f"Friction depends on speed otherwise than this law, by {sized(force, sign)}"
            f" {'near rest' if peaked else 'at the largest speed'}."
        ),
        "spring": (
            f"A force grows with position, by {sized(f'{force}/{way}')}: a spring that the"
            " mechanism lacks."
        ),
        "position friction": f"Friction depends on position, by ± {sized(force, sign)}, {wave}.",
        "position force": (
            f"A force beside friction depends on position, by ± {sized(force, sign)}, {wave}:"
            " cogging, a cable, gravity."
        ),
        "imbalance": (
            f"A force depends on position and grows with speed squared, to {sized(force, sign)} at"
            f" the largest speed, {wave}: imbalance."
        ),
        "after reversals": (
            f"For {quantity(scale, way)} after a reversal the forces differ by"
            f" {sized(force, sign)} at first: backlash, or presliding that the law lacks."
        ),
    }
    return said[kind]
