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

Source: C. R. Rao, "Large sample tests of statistical hypotheses", 1948 (score tests); F. Wilcoxon,
"Individual comparisons by ranking methods", 1945.
"""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from stickslip.errors import StickslipError
from stickslip.experiments import Measurement
from stickslip.experiments.wording import number, percent, quantity
from stickslip.identification.force_balance import balanced
from stickslip.friction import FrictionLaw
from stickslip.identification.inverse_dynamics import mass_of, positions_of
from stickslip.identification.map_problem import ForceMap
from stickslip.identification.map_records import Stretch
from stickslip.identification.results import Estimate
from stickslip.identification.segmenting import Hold
from stickslip.identification.unknowns import Unknowns
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary

__all__ = ["ModelError", "model_errors"]

Array = NDArray[np.float64]

BLOCKS = 20
"""Blocks of a record that are left out in turn."""
FEWEST = 12
"""Rows that a block has at least."""
LEVEL = 0.01
"""Probability that a record without an error is said to have one, all columns together."""
SHARE = 0.10
"""Share of the residuals' squares that an error must predict in blocks left out."""
MATTERS = 0.02
"""Size of an error over that of friction from which it matters, whatever the intervals say."""
NEGLIGIBLE = 0.002
"""Size of an error over that of friction below which it does not, however narrow they are."""
CLOSE = 0.9
"""Gain over the largest from which a column with fewer coefficients is preferred."""
MOST = 3
"""Errors that are named at most."""
ROWS = 4_000
"""Rows of a balance at most, as far as its filter allows: these are enough."""
WAVES = 40
"""Waves over the stroke that are looked for at most."""
SPEEDS = (0.02, 0.05, 0.1, 0.2, 0.4)
"""Speeds over the largest at which a peak of friction near rest is looked for."""
WAYS = (0.003, 0.01, 0.03, 0.1)
"""Ways after a reversal, over the stroke, within which something else is looked for."""
TAKEN_UP = 0.01
"""Share of a column beside what was fitted below which this takes it up."""
RIDGE = 1e-6
OVERSAMPLED = 0.25
"""Most that the filter passes over half the frequency of the rows."""
LIMITS = (0.6, 0.75, 0.9)
"""Quantiles of the force's size from which a limit is looked for."""


@final
@dataclass(frozen=True, kw_only=True)
class ModelError:
    """One error of the model, the rig or the record that the residuals of a fit show."""

    kind: str
    """What it is, such as ``"delay"`` or ``"position friction"``."""
    sentence: str
    """What it is, with its size and what it does to the estimates."""
    effect: float
    """Its size, in the unit of the sentence, SI."""
    interval: tuple[float, float]
    """95 % confidence interval of the size, from leaving blocks out."""
    share: float
    """Share of the squared residuals that it predicts in blocks left out."""

    def to_dict(self) -> Mapping[str, Any]:
        """Return the error as plain numbers and strings."""
        return {
            "kind": self.kind,
            "sentence": self.sentence,
            "effect": self.effect,
            "interval": list(self.interval),
            "share": self.share,
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Balance:
    """The balance of forces along a record: its residuals, and what errors are made of.

    Rows (n,) are those where slip is sure; all forces passed the filter of the balance.
    """

    residual: Array
    """Force less inertia, springs, friction and offset (n,) [N]."""
    slopes: Array
    """Derivatives of the predicted force by what was fitted (n, p)."""
    friction: Array
    """Friction and offset by the law (n,) [N]."""
    time: Array
    """From the start of each record (n,) [s]."""
    position: Array
    velocity: Array
    """Slip velocity (n,) [m/s]."""
    level: Array
    """Sign of slip times the load (n,)."""
    force: Array
    """Force that inertia and friction take (n,) [N]."""
    force_bend: Array
    """Its second rate (n,) [N/s^2]."""
    acceleration: Array
    since: Array
    """Way since the last reversal (n,) [m]."""
    passed: float
    """Highest frequency that the filter passes [Hz]."""
    late: Callable[[float], Array]
    """By time [s]: force less the force so much earlier, over that time (n,) [N/s]."""
    driven: bool
    """Whether a force was recorded."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Effect:
    """Columns that an error adds to the balance."""

    kind: str
    columns: Array
    """Of the balance (n, q)."""
    scale: float = 0.0
    """What the columns were made with: a length, a speed, a force."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Tested:
    """An effect with what it predicts and its coefficients."""

    effect: Effect
    gain: float
    """Squares that it takes off in blocks left out [N^2]."""
    chance: float
    """Probability of such gains without it."""
    values: Array
    """Coefficients (q,)."""
    left_out: Array
    """The same with each block left out (blocks, q)."""
    shift: Array
    """By how much the fitted parameters change with it (p,)."""

    @property
    def size(self) -> float:
        """Root mean square of what it adds to the balance [N]."""
        return float(np.sqrt(np.mean((self.effect.columns @ self.values) ** 2)))

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
        None if nothing is shown, or the motion does not balance a force: friction that was
        measured, several coordinates, too short a record.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> t = np.arange(0.0, 20.0, 0.005)
    >>> v = np.sin(2.0 * t) + 0.5 * np.sin(5.1 * t)
    >>> a = 2.0 * np.cos(2.0 * t) + 2.55 * np.cos(5.1 * t)
    >>> x = -0.5 * np.cos(2.0 * t) - 0.5 / 5.1 * np.cos(5.1 * t)
    >>> force = 3.0 * a + 2.0 * np.sign(v) + 4.0 * x
    >>> record = Measurement(time=t, position=x, force=force)
    >>> none = Unknowns(())
    >>> axis, law = Axis(inertia=3.0), Coulomb(kinetic_coefficient=2.0)
    >>> [one.kind for one in model_errors(axis, law, record, none, (), hold="first")]
    ['spring']
    """
    try:
        balance = _balance(mechanism, law, measurement, unknowns, hold)
    except StickslipError:
        return ()
    if len(balance.residual) < FEWEST * BLOCKS or not np.all(np.isfinite(balance.residual)):
        return ()
    return tuple(_shown(balance, estimates, measurement))


def _balance(
    mechanism: Mechanism,
    law: FrictionLaw,
    measurement: Measurement,
    unknowns: Unknowns,
    hold: Hold,
) -> Balance:
    stretches = balanced(mechanism, measurement, hold=hold)
    fitted = {**_numbers(law, "friction"), **_numbers(mechanism, "mechanism")}
    along = [
        i
        for i, path in enumerate(unknowns.paths)
        if path.startswith("friction.") or path == "mechanism.offset"
    ]
    own = Unknowns(tuple(unknowns.items[i] for i in along), fitted)
    problem = ForceMap(
        law=law,
        unknowns_=own,
        stretches=stretches,
        offset=fitted.get("mechanism.offset", 0.0),
        mass=mass_of(mechanism),
    )
    seen = problem.linearise(np.array([fitted[path] for path in own.paths]))
    slopes = np.zeros((len(seen.residual), len(unknowns)))
    slopes[:, along] = seen.slopes
    for i in set(range(len(unknowns))) - set(along):
        path = unknowns.paths[i]
        step = 1e-4 * max(abs(fitted[path]), 1e-6)
        moved = balanced(
            vary(mechanism, "mechanism", {path: fitted[path] + step}), measurement, hold=hold
        )
        slopes[:, i] = (_kept(stretches, "friction") - _kept(moved, "friction")) / step
    widest = max(one.passed for one in stretches)
    every = max(1, min(len(seen.residual) // ROWS, int(OVERSAMPLED / widest)))
    own_part = [_part(one, measurement, mechanism) for one in stretches]
    columns = {name: np.concatenate([part[name] for part in own_part]) for name in own_part[0]}

    def late(delay: float) -> Array:
        parts = []
        for one in stretches:
            t, force = one.path.time, _force(one, mechanism)
            dt = float(np.mean(np.diff(t)))
            if abs(delay) < 1e-3 * dt:
                rate = np.gradient(force, dt)
            else:
                rate = (force - np.interp(t - delay, t, force)) / delay
            parts.append(rate[one.rows_of(None)])
        return np.asarray(np.concatenate(parts)[::every])

    return Balance(
        residual=seen.residual[::every],
        slopes=slopes[::every],
        friction=(_kept(stretches, "friction") - seen.residual)[::every],
        passed=0.5 * widest / float(np.mean(np.diff(stretches[0].path.time))),
        late=late,
        driven="force" in measurement.quantities(),
        **{name: column[::every] for name, column in columns.items()},
    )


def _numbers(model: Mechanism | FrictionLaw, room: str) -> dict[str, float]:
    return {path: float(value) for path, _, value in parameters(model, room)}


def _kept(stretches: Sequence[Stretch], name: str) -> Array:
    return np.concatenate([getattr(one, name)[one.rows_of(None)] for one in stretches])


def _force(one: Stretch, mechanism: Mechanism) -> Array:
    """Return the filtered force of a stretch (n,) [N] that inertia and friction take."""
    assert one.acceleration is not None
    return np.asarray(one.friction + mass_of(mechanism) * one.acceleration)


def _part(one: Stretch, measurement: Measurement, mechanism: Mechanism) -> dict[str, Array]:
    """Return the columns of a stretch in the rows that are compared."""
    record = measurement.records()[one.record]
    kept, t, v = one.rows_of(None), one.path.time, one.path.velocity
    way = np.concatenate([[0.0], np.cumsum(np.abs(one.path.travel))])
    turned = np.flatnonzero(np.diff(np.sign(v)) != 0) + 1
    last = np.concatenate([[0], turned])[np.searchsorted(turned, np.arange(len(t)), side="right")]
    assert one.acceleration is not None
    force = _force(one, mechanism)
    columns = {
        "time": t - float(np.asarray(record.time)[0]),
        "position": np.interp(t, np.asarray(record.time), positions_of(record)),
        "velocity": v,
        "level": np.sign(v) * one.path.load,
        "force": force,
        "force_bend": np.gradient(np.gradient(force, t), t),
        "acceleration": one.acceleration,
        "since": way - way[last],
    }
    return {name: column[kept] for name, column in columns.items()}


def _effects(b: Balance) -> Iterator[Effect]:
    """Yield the errors that are looked for, those with fewer coefficients first."""

    def one(kind: str, *columns: Array, scale: float = 0.0) -> Effect:
        return Effect(kind=kind, columns=np.stack(columns, axis=1), scale=scale)

    t = b.time / max(float(np.ptp(b.time)), 1e-300) - 0.5
    fastest = float(np.max(np.abs(b.velocity)))
    u = b.velocity / fastest
    stroke = float(np.ptp(b.position))
    middle = b.position - 0.5 * float(b.position.max() + b.position.min())
    if b.driven:
        rate = b.late(0.0)
        yield one("delay", rate)
        yield one("clock", b.time * rate)
        yield one("flexibility", b.force_bend)
        size = np.abs(b.force)
        for limit in np.quantile(size, LIMITS).tolist():
            beyond = np.sign(b.force) * np.maximum(size - limit, 0.0)
            yield one("force limit", beyond, scale=limit)
    yield one("inertia", b.acceleration)
    yield one("offset", np.ones_like(t))
    yield one("drift of the level", t * b.level)
    yield one("drift of the offset", t)
    yield one("drift of the viscous part", t * u)
    yield one("asymmetry", np.abs(u))
    yield one("speed", u * np.abs(u))
    for share in SPEEDS:
        yield one("speed", b.level * np.exp(-np.abs(u) / share), scale=share * fastest)
    yield one("spring", middle)
    yield one("position friction", b.level * middle, scale=stroke)
    for share in WAYS:
        near = np.exp(-b.since / (share * stroke))
        yield one("reversals", b.level * near, scale=share * stroke)
        yield one("reversals", b.acceleration * near, scale=share * stroke)
    # of finer waves, the filter leaves nothing at the usual speed
    usual = float(np.percentile(np.abs(b.velocity), 75.0))
    finest = max(min(int(0.5 * b.passed * stroke / usual), WAVES), 1)
    for k in (0.5, *range(1, finest + 1)):
        phase = 2.0 * math.pi * k * middle / stroke
        waves = np.cos(phase), np.sin(phase)
        yield one("position force", *waves, scale=stroke / k)
        yield one("position friction", *(b.level * wave for wave in waves), scale=stroke / k)
        yield one("imbalance", *(u * u * wave for wave in waves), scale=stroke / k)


def _tested(b: Balance, basis: Array, residual: Array, effect: Effect) -> Tested | None:
    """Return what an effect predicts in blocks left out; None if parameters can take it up.

    `basis` (n, p) has orthonormal columns that span the slopes, `residual` (n,) none of them.
    """
    columns = effect.columns
    own = columns - basis @ (basis.T @ columns)
    size = np.linalg.norm(columns, axis=0)
    if np.any(np.linalg.norm(own, axis=0) <= TAKEN_UP * size) or not np.all(size > 0.0):
        return None
    directions, triangle = np.linalg.qr(own)
    if abs(triangle[-1, -1]) <= TAKEN_UP * size[-1]:
        return None
    table = np.column_stack([basis, directions])
    p, n = basis.shape[1], len(residual)
    edges = np.linspace(0, n, BLOCKS + 1).astype(int)
    rows = [slice(first, last) for first, last in itertools.pairwise(edges.tolist())]
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
    back = np.linalg.inv(triangle)
    values = back @ slopes.sum(axis=0)[p:]
    chance = 1.0
    if gains.sum() > 0.0:
        chance = float(stats.wilcoxon(gains, alternative="greater").pvalue)
    return Tested(
        effect=effect,
        gain=float(gains.sum()),
        chance=chance,
        values=values,
        left_out=found[:, p:] @ back.T,
        shift=-np.linalg.lstsq(b.slopes, columns @ values, rcond=1e-10)[0],
    )


def _taken_off(values: Array, squares: Array, slopes: Array) -> Array:
    """Return the squares (b,) that coefficients (b, p) take off each block."""
    found: Array = 2.0 * np.einsum("bp,bp->b", values, slopes) - np.einsum(
        "bp,bpq,bq->b", values, squares, values
    )
    return found


def _basis(slopes: Array) -> Array:
    """Return orthonormal columns (n, r) that span those of a table (n, p)."""
    size = np.linalg.norm(slopes, axis=0)
    if not np.any(size > 0.0):
        return np.zeros((len(slopes), 0))
    u, s, _ = np.linalg.svd(slopes[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    return np.asarray(u[:, s > 1e-7 * s[0]])


def _shown(
    b: Balance, estimates: Sequence[Estimate], measurement: Measurement
) -> Iterator[ModelError]:
    """Yield the errors that residuals show, each beside those before it."""
    slopes = b.slopes
    effects = list(_effects(b))
    basis = _basis(slopes)
    whole = b.residual - basis @ (basis.T @ b.residual)
    total = float(whole @ whole)
    named: set[str] = set()
    for _ in range(MOST):
        basis = _basis(slopes)
        residual = b.residual - basis @ (basis.T @ b.residual)
        tests = [_tested(b, basis, residual, one) for one in effects if one.kind not in named]
        able = [one for one in tests if one is not None and _is_shown(one, b, total, estimates, len(effects))]
        if not able:
            return
        most = max(one.gain for one in able)
        best = min(
            (one for one in able if one.gain >= CLOSE * most),
            key=lambda one: (len(one.values), -one.gain),
        )
        named.add(best.effect.kind)
        yield _error(best, b, total, estimates, measurement)
        columns = best.effect.columns
        if best.effect.kind == "delay":  # exactly so much late, beyond first order
            columns = b.late(float(best.values[0]))[:, None]
        slopes = np.column_stack([slopes, columns])


def _is_shown(
    one: Tested, b: Balance, total: float, estimates: Sequence[Estimate], tried: int
) -> bool:
    """Whether an effect is significant, predicts a good part of the residuals, and matters."""
    if one.chance * tried > LEVEL or one.gain < SHARE * total:
        return False
    size = one.size / max(float(np.sqrt(np.mean(b.friction**2))), 1e-300)
    return size > MATTERS or (size > NEGLIGIBLE and bool(_moved(one, estimates)))


def _moved(one: Tested, estimates: Sequence[Estimate]) -> list[tuple[Estimate, float]]:
    """Return the estimates that an effect moves out of their intervals, and by how much."""
    return [
        (estimate, float(shift))
        for estimate, shift in zip(estimates, one.shift, strict=True)
        if estimate.bounded
        and not estimate.low <= estimate.value + float(shift) <= estimate.high
    ]


def _error(
    one: Tested, b: Balance, total: float, estimates: Sequence[Estimate], measurement: Measurement
) -> ModelError:
    text, effect, interval = _said(one, b, measurement)
    share = min(one.gain / total, 1.0)
    moved = ", ".join(
        f"{estimate.quantity.symbol} by {percent(abs(shift / estimate.value))}"
        for estimate, shift in _moved(one, estimates)
        if estimate.value
    )
    text += f" That is {percent(share)} of the squared residuals, on blocks of the record left out."
    if moved:
        text += f" It moves {moved}: the 95 % intervals do not allow for it."
    else:
        text += " The 95 % intervals do not allow for it."
    return ModelError(
        kind=one.effect.kind, sentence=text, effect=effect, interval=interval, share=share
    )


def _said(one: Tested, b: Balance, measurement: Measurement):
    e = one.effect
    value = float(one.values[0])
    return f"{e.kind} {one.values} scale {e.scale:.3g} chance {one.chance:.2g} size {one.size:.3g}", value, one.interval(lambda c: float(c[0]))
