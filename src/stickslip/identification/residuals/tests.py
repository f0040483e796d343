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

import operator
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import StickslipError
from stickslip.experiments import Measurement
from stickslip.formatting import joined, percent
from stickslip.friction import FrictionLaw
from stickslip.identification.estimation.model_error import UNSAID, ModelError
from stickslip.identification.estimation.parameters import FreeParameters
from stickslip.identification.force_map.model import ForceMap
from stickslip.identification.residuals.balance import Balance, Fitted, balance_of
from stickslip.identification.residuals.delays import RESPONSES, profile_of, response_of
from stickslip.identification.residuals.effects import Effect, delay_of, effects, shown_by
from stickslip.identification.residuals.gains import (
    BLOCKS,
    FEWEST,
    LEVEL,
    basis_of,
    beside,
    chance_of,
    gains_of,
    half_width_of,
)
from stickslip.identification.residuals.peaks import peaks_of
from stickslip.identification.residuals.wording import cure_of, finding_of
from stickslip.identification.results import Estimate
from stickslip.identification.sensor_response import SensorResponse
from stickslip.identification.settings import Hold
from stickslip.mechanisms import Mechanism

Array = NDArray[np.float64]

BANDS = ((1.0, 0), (3.0, 4))
"""Factor on what the filter of inverse dynamics passes, and order of the autoregression."""
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
LIKE_PRESLIDING = " Presliding, which this law lacks, looks alike."
"""What else may make measured friction seem late."""
TRIALS = 8
"""Independent values of a delay that its profile stands for in corrections for many trials."""
TAKEN_UP = 0.01
"""Share of a column beside what was fitted below which the parameters take it up."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ScoreTest:
    """An effect with what it predicts and its coefficients."""

    effect: Effect
    """The error that was tested for."""
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
        half = half_width_of(np.array([of(one) for one in self.left_out]))
        return of(self.values) - half, of(self.values) + half


def model_errors(
    mechanism: Mechanism,
    law: FrictionLaw,
    measurement: Measurement,
    free_parameters: FreeParameters,
    estimates: Sequence[Estimate],
    *,
    hold: Hold,
    measured: ForceMap | None = None,
) -> tuple[ModelError, ...]:
    """Return the errors of the model that the residuals of a fit show, the largest first.

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
    >>> (one,) = model_errors(axis, law, record, FreeParameters(()), (), hold="first")
    >>> one.kind, round(one.effect, 1)
    ('spring', 4.0)
    """
    fit = Fitted(
        mechanism=mechanism,
        law=law,
        measurement=measurement,
        free_parameters=free_parameters,
        estimates=estimates,
        hold=hold,
        measured=measured,
    )
    try:
        balances = [balance_of(fit, wider, order) for wider, order in BANDS]
    except StickslipError:
        return ()
    if not all(len(b.rows) >= FEWEST * BLOCKS and np.isfinite(b.residual).all() for b in balances):
        return ()
    if balances[0].friction == 0.0:  # no friction, of which an effect would be a share
        return ()
    peaks = () if measured else peaks_of(fit, MATTERS * balances[0].friction)
    return (*_shown(balances, fit), *peaks)


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
    gains, left_out = gains_of(basis, directions, residual)
    share = float(gains.sum()) / total
    back = np.linalg.inv(triangle)
    values = back @ (directions.T @ residual)
    chance = 1.0
    if share >= SHARE:
        chance = chance_of(gains)
    return ScoreTest(
        effect=effect,
        share=share,
        chance=chance,
        values=values,
        left_out=left_out @ back.T,
        shift=np.asarray(-np.linalg.lstsq(b.slopes, columns @ values, rcond=1e-10)[0]),
        size=float(np.sqrt(np.mean((column @ values) ** 2))) / b.friction,
    )


def _shown(balances: Sequence[Balance], fit: Fitted) -> Iterator[ModelError]:
    """Yield the errors that residuals show, each beside those before it."""
    estimates, measurement = fit.estimates, fit.measurement
    widest = max(balances, key=lambda b: b.passed)
    looked_for = tuple(
        effects(widest.signals, widest.passed, driven="force" in measurement.quantities())
    )
    kinds = Counter(one.kind for one in looked_for)
    measured = widest.signals.acceleration is None
    if measured:
        kinds.update(dict.fromkeys(RESPONSES, TRIALS))
    tried = {kind: len(kinds) * count * len(balances) for kind, count in kinds.items()}
    columns = [b.seen(looked_for) for b in balances]
    fitted = [b.slopes for b in balances]
    named: set[str] = set()
    for _ in range(MOST):
        tests = (
            one
            for b, own, slopes in zip(balances, columns, fitted, strict=True)
            for one in _all_tested(b, slopes, looked_for, own, responses=measured and _sees(b, fit))
            if one.effect.kind not in named
        )
        shown = [one for one in tests if _is_shown(one, estimates, tried[one.effect.kind])]
        if not shown:
            return
        most = max(one.share for one in shown)
        best = min(
            (one for one in shown if one.share >= CLOSE * most),
            key=lambda one: (len(one.values), -one.share),
        )
        named.update(RESPONSES if best.effect.kind in RESPONSES else {best.effect.kind})
        yield _error(best, fit)
        known = best.effect
        if known.kind == "delay" and not measured:  # exactly so much late, beyond first order
            known = delay_of(float(best.values[0]))
        fitted = [
            np.column_stack([slopes, b.white(b.seen([known])[0])])
            for b, slopes in zip(balances, fitted, strict=True)
        ]


def _sees(b: Balance, fit: Fitted) -> bool:
    """Whether delays are looked for in residuals of one kind.

    White ones tell most of what is fast. Bristles have a knee of their own there, which no first
    order in its exponent follows: on the tribometer's record, 84 % of the white squares went with a
    lag, which took 2 % off the residuals of a fit with it.
    """
    return not (len(b.memory) and fit.law.states)


def _all_tested(
    b: Balance,
    slopes: Array,
    looked_for: Sequence[Effect],
    columns: Sequence[Array],
    *,
    responses: bool,
) -> Iterator[ScoreTest]:
    """Yield the tests of effects beside what is fitted, slopes (m, p).

    And of `responses` of a force sensor, where friction was measured.
    """
    basis, total = basis_of(slopes), float(np.sum(beside(b.residual, b.slopes) ** 2))
    residual = b.residual - basis @ (basis.T @ b.residual)
    for effect, column in zip(looked_for, columns, strict=True):
        one = _tested(b, basis, residual, effect, column, total)
        if one is not None:
            yield one
    for kind in RESPONSES if responses else ():
        late = _late(b, basis, residual, kind, total)
        if late is not None:
            yield late


def _late(b: Balance, basis: Array, residual: Array, kind: str, total: float) -> ScoreTest | None:
    """Return what a delay or a lag of the force sensor predicts; None if that is little.

    Its column is not proportional to it, so that its size is found by the profile of the squares.
    """
    found = profile_of(b, basis, residual, kind)
    share = 0.0 if found is None else float(found.gains.sum()) / total
    if found is None or share < SHARE:
        return None
    effect = shown_by(response_of(kind, found.value))
    column = b.seen([effect])[0]
    values = np.array([found.value])
    return ScoreTest(
        effect=effect,
        share=share,
        chance=chance_of(found.gains),
        values=values,
        left_out=found.left_out[:, None],
        shift=np.asarray(-np.linalg.lstsq(b.slopes, b.white(column) @ values, rcond=1e-10)[0]),
        size=float(np.sqrt(np.mean((column @ values) ** 2))) / b.friction,
    )


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


def _error(one: ScoreTest, fit: Fitted) -> ModelError:
    estimates, measurement = fit.estimates, fit.measurement
    size = _size_of(one)
    low, high = one.interval(size)
    moved = _moved(one, estimates)
    said = [
        f"{estimate.quantity.symbol} by {percent(abs(shift / estimate.value))}"
        for estimate, shift in moved
        if estimate.value
    ]
    text = (
        f"This effect explains {percent(min(one.share, 1.0))} of the squared residuals on held-out"
        " blocks."
    )
    if said:
        consequence = f"It shifts {joined(said)}, beyond the 95 % intervals."
    elif moved:
        consequence = UNSAID
    else:
        consequence = "To first order, it shifts no identified parameter out of its 95 % interval."
    return ModelError(
        kind=one.effect.kind,
        finding=finding_of(one.effect, size(one.values), (low, high), measurement, fit.hold),
        consequence=f"{text} {consequence}{_of_channel(one, fit)}",
        effect=size(one.values),
        interval=(low, high),
        share=one.share,
        moved=tuple(estimate.path for estimate, _ in moved),
    )


def _of_channel(one: ScoreTest, fit: Fitted) -> str:
    """Return what to do about a force channel that shows measured friction late."""
    if fit.measured is None or one.effect.kind not in RESPONSES:
        return ""
    known = fit.measured.stretches[0].response
    more = response_of(one.effect.kind, float(one.values[0]))
    late = SensorResponse(delay=known.delay + more.delay, lag=known.lag + more.lag)
    presliding = "" if fit.law.states else LIKE_PRESLIDING
    return f"{presliding} {cure_of(late)}"


def _size_of(one: ScoreTest) -> Callable[[Array], float]:
    """Return what makes one number of the coefficients (q,): the amplitude of a wave."""
    if len(one.values) == 1:
        return lambda values: float(values[0])
    return lambda values: float(np.hypot(*values))
