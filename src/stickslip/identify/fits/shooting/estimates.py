"""Estimates, and how sure they are where residuals are correlated: what leaving blocks out changes.

With few blocks and four parameters, the estimates follow each block's own error by a good part: a
sandwich of the residuals that are left is a fifth too narrow, and covers 82 to 87 % where 95 % is
said. Leaving a block out shows its error whole. Few of the blocks tell a parameter, and fewer than
their number are the degrees of freedom of its error (`benchmarks.synthetic_truth`).
"""

import math
from collections.abc import Collection, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from statistics import NormalDist

import numpy as np
import scipy
from numpy.typing import NDArray

from stickslip.friction import FrictionLaw, Laws
from stickslip.identify.fits.levenberg_marquardt import ResidualJacobian
from stickslip.identify.fits.parameters import WIDE, FreeParameter, FreeParameters
from stickslip.identify.fits.results import READINGS, Estimate
from stickslip.identify.fits.settings import CHANCE, NEGLIGIBLE, TAKES_PART
from stickslip.mechanisms import Mechanism
from stickslip.show import formatting
from stickslip.show.formatting import fixed, number

Array = NDArray[np.float64]


UNSEEN = "the record does not depend on it"
TIED = "the record depends only on a combination of it and other parameters"
NORMAL_95 = NormalDist().inv_cdf(1.0 - CHANCE / 2.0)
"""Half width of a 95 % interval of a known standard error."""
BLOCKS = 8
"""Blocks of a record between which residuals count as independent."""
ONCE = "only one segment of the record depends on it"


@dataclass(frozen=True, kw_only=True, eq=False)
class Directions:
    """Slopes (n, p) as a product: orthonormal columns times what makes them of coordinates.

    Columns are scaled to one size first, so that units do not matter.
    """

    columns: Array
    """Orthonormal (n, r); of directions that are seen."""
    inverse: Array
    """Coordinates by orthonormal ones (p, r)."""
    size: Array
    """Norms of the slopes (p,); 1 where they are 0."""
    effective: NDArray[np.bool_]
    """Which slopes are not 0 (p,)."""
    cut: Array
    """Directions of scaled coordinates that are not seen (p, k), columns of norm 1."""
    condition: float
    """Largest over smallest singular value of the scaled slopes, those that are 0 left out."""

    @classmethod
    def of(cls, table: Array) -> "Directions":
        """Return the directions of slopes (n, p)."""
        # large and small numbers are squared in a norm
        largest = np.max(np.abs(table), axis=0, initial=0.0)
        effective = largest > 0.0
        size = np.where(effective, largest, 1.0)
        size = size * np.where(effective, np.linalg.norm(table / size, axis=0), 1.0)
        u, singular, v = np.linalg.svd((table / size)[:, effective], full_matrices=False)
        kept = singular > singular.max(initial=0.0) * NEGLIGIBLE
        inverse, cut = (np.zeros((len(size), int(k.sum()))) for k in (kept, ~kept))
        inverse[effective] = v[kept].T / singular[kept] / size[effective, None]
        cut[effective] = v[~kept].T
        condition = singular[0] / max(singular[-1], 1e-300) if len(singular) else 1.0
        return cls(
            columns=u[:, kept],
            inverse=inverse,
            size=size,
            effective=effective,
            cut=cut,
            condition=float(condition),
        )

    def reasons(self, scale: Array) -> list[str]:
        """Return for each value, by coordinates (p, p), why it is not known; empty if it is."""
        by_scaled = scale / self.size
        unseen = takes_part(by_scaled, np.eye(len(self.size))[:, ~self.effective])
        tied = takes_part(by_scaled, self.cut)
        # of a number whose slopes are 0 by a bound there is nothing to say
        held = ~np.any(scale != 0.0, axis=1)
        return [
            UNSEEN if none or own else TIED if both else ""
            for none, own, both in zip(held, unseen, tied, strict=True)
        ]


def takes_part(rows: Array, directions: Array) -> NDArray[np.bool_]:
    """Return which linear functions (m, p) change along any of the directions (p, k) of norm 1."""
    if not directions.shape[1]:
        return np.zeros(len(rows), dtype=bool)
    change = np.linalg.norm(rows @ directions, axis=1)
    return np.asarray(change > TAKES_PART * np.linalg.norm(rows, axis=1))


@dataclass(frozen=True, kw_only=True, eq=False)
class Displaced:
    """How far one standard uncertainty of a mechanism's parameter moves the residuals of a fit."""

    path: str
    """The parameter."""
    rows: Array
    """Change of the residuals (n,); 0 in records with a value of their own."""
    shared: bool = True
    """Whether it is one number of all records, and not that of one record alone."""

    def followed(self, jacobian: ResidualJacobian, scale: Array) -> Array:
        """Return how far estimates (p,) follow: one Gauss-Newton step.

        Examples
        --------
        >>> line = ResidualJacobian(
        ...     values=np.ones(1),
        ...     residual=np.zeros(2),
        ...     slopes=np.array([[1.0], [2.0]]),
        ...     segment=np.zeros(2, dtype=int),
        ... )
        >>> Displaced(path="mechanism.mass", rows=np.array([0.1, 0.2])).followed(line, np.eye(1))
        array([0.1])
        """
        known = Directions.of(jacobian.slopes @ scale)
        return np.asarray(scale @ known.inverse @ (known.columns.T @ self.rows))


@dataclass(frozen=True, kw_only=True, eq=False)
class Inference:
    """Covariances of estimates (p, p), of what the data say and of what white noise would say."""

    covariance: Array
    """Of the record: from leaving out each block in turn (jackknife over blocks)."""
    naive: Array
    """As if every residual were independent."""
    freedom: Array
    """Degrees of freedom of each standard error (p,)."""
    condition: float
    """Of the slopes, their columns scaled to 1."""
    effective: float
    """Effective number of independent residuals."""
    reasons: tuple[str, ...] = ()
    """Why a standard error is infinite, for each of the parameters; empty where it is not."""
    held: Mapping[str, Array] = field(default_factory=dict)
    """By parameter of the mechanism, how far its standard uncertainties move the estimates (k, p):
    one row for what all records share, else one for each record."""

    @property
    def of_held(self) -> Array:
        """Covariance that the uncertainties of the mechanism bring (p, p)."""
        moved = np.concatenate([np.zeros((1, len(self.freedom))), *self.held.values()])
        return np.asarray(moved.T @ moved)

    @property
    def total(self) -> Array:
        """Covariance of the record and of the uncertainties of the mechanism (p, p)."""
        return np.asarray(self.covariance + self.of_held)

    @property
    def errors(self) -> Array:
        """Standard errors (p,)."""
        return np.sqrt(np.maximum(np.diag(self.total), 0.0))

    @property
    def half_widths(self) -> Array:
        """Half widths of 95 % intervals (p,)."""
        return np.array([self.half_width(row) for row in np.eye(len(self.freedom))])

    def half_width(self, row: Array) -> float:
        """Return the half width of the 95 % interval of a sum of estimates, each times a factor.

        What the record tells has the least degrees of freedom of the estimates in it; standard
        uncertainties of the mechanism are known.
        """
        kept = row != 0.0
        own, known = (
            max(float(row[kept] @ table[np.ix_(kept, kept)] @ row[kept]), 0.0)
            for table in (self.covariance, self.of_held)
        )
        quantile = float(quantile_of(np.min(self.freedom[kept])))
        return math.hypot(quantile * math.sqrt(own), NORMAL_95 * math.sqrt(known))

    def including(self, *offsets: Array) -> "Inference":
        """Return the same with half widths that include other values, by how far they are off (p,).

        Each is added to the covariance as if it were a standard error, so that a half width is the
        root of the sum of squares of its own and of these.
        """
        covariance = self.covariance
        for off in offsets:
            scaled = off / quantile_of(self.freedom)
            covariance = covariance + np.outer(scaled, scaled)
        return replace(self, covariance=covariance)

    @property
    def correlation(self) -> Array:
        """Correlation of the estimates (p, p), 0 for what the record does not depend on."""
        known = np.isfinite(self.errors) & (self.errors > 0.0)
        errors = np.where(known, self.errors, 1.0)
        whole = np.where(np.isfinite(self.total), self.total, 0.0)
        table: Array = whole / np.outer(errors, errors)
        np.fill_diagonal(table, 1.0)
        return table


def block_sums(
    jacobian: ResidualJacobian, table: Array, *, blocks: int = BLOCKS
) -> tuple[Array, Array]:
    """Return the Gauss-Newton matrices (b, p, p) and gradients (b, p) of contiguous blocks."""
    squares, slopes = [], []
    for rows in np.array_split(np.arange(len(jacobian.residual)), blocks):
        part = table[rows]
        squares.append(part.T @ part)
        slopes.append(part.T @ jacobian.residual[rows])
    return np.array(squares), np.array(slopes)


def infer(
    jacobian: ResidualJacobian,
    scale: Array,
    *,
    displaced: Sequence[Displaced] = (),
) -> Inference:
    """Return covariances at an optimum.

    One Gauss-Newton step from the optimum for each block that is left out; no run is made. Where a
    bound keeps the optimum from where it wants to go, what all blocks ask for is no error.

    Standard errors are infinite of what the record does not depend on, of what it shows only in a
    sum with others, and of what one block alone shows: without that block nothing is known of it,
    and how far the estimate would go cannot be said.

    Source: J. G. MacKinnon, M. O. Nielsen, M. D. Webb, "Fast and reliable jackknife and bootstrap
    methods for cluster-robust inference", 2023 (CV3).

    Examples
    --------
    >>> v = np.linspace(0.1, 1.0, 10)
    >>> columns = np.column_stack([np.ones(10), 1e9 * v])
    >>> noise = np.random.default_rng(1).normal(size=10)
    >>> noise -= columns @ np.linalg.lstsq(columns, noise)[0]
    >>> line = ResidualJacobian(
    ...     values=np.array([2.0, 1e-9]),
    ...     residual=noise,
    ...     slopes=columns,
    ...     segment=np.zeros(10, dtype=int),
    ... )
    >>> infer(line, np.eye(2)).condition < 10.0
    True
    """
    known = Directions.of(jacobian.slopes @ scale)
    blocks = max(2, min(BLOCKS, len(jacobian.residual) // 2))
    squares, slopes = block_sums(jacobian, known.columns, blocks=blocks)
    changes, alone = _left_out(squares, slopes)
    by_seen = scale @ known.inverse
    moved = math.sqrt((blocks - 1) / blocks) * changes @ by_seen.T
    once = takes_part(by_seen, alone)
    reasons = [
        why or (ONCE if item else "") for why, item in zip(known.reasons(scale), once, strict=True)
    ]
    spare = max(len(jacobian.residual) - known.columns.shape[1], 1)
    naive = by_seen @ by_seen.T * (jacobian.cost / spare)
    return Inference(
        covariance=_unbounded(moved.T @ moved, reasons),
        naive=_unbounded(naive, reasons),
        freedom=np.array([freedom_of(squares, row) for row in by_seen]),
        condition=known.condition,
        effective=effective_size(jacobian.residual),
        reasons=tuple(reasons),
        held={
            path: np.array(
                [item.followed(jacobian, scale) for item in displaced if item.path == path]
            )
            for path in dict.fromkeys(item.path for item in displaced)
        },
    )


def _unbounded(covariance: Array, reasons: Sequence[str]) -> Array:
    """Return a covariance that is infinite where there is a reason."""
    result = covariance.copy()
    for i, reason in enumerate(reasons):
        if reason:
            result[i, i] = np.inf
    return result


def _left_out(squares: Array, slopes: Array) -> tuple[Array, Array]:
    """Return what leaving each block out changes (b, r), and what only one block sees (r, k).

    Coordinates are orthonormal: the matrices of all blocks add up to 1. Along a direction that only
    one block sees, nothing says how far leaving it out would lead; the change is 0 there.
    """
    wanted = slopes.mean(axis=0)
    changes, alone = [], [np.zeros((squares.shape[1], 0))]
    for rest, slope in zip(_rests(squares), slopes, strict=True):
        share, directions = np.linalg.eigh(rest)
        kept = share > NEGLIGIBLE**2
        solved = directions[:, kept].T @ (wanted - slope) / share[kept]
        changes.append(directions[:, kept] @ solved)
        alone.append(directions[:, ~kept])
    return np.array(changes), np.concatenate(alone, axis=1)


def _rests(squares: Array) -> Array:
    """Return the sums of all matrices but each one (b, p, p), without a difference."""
    zero = np.zeros((1, *squares.shape[1:]))
    before = np.concatenate([zero, np.cumsum(squares, axis=0)[:-1]])
    after = np.concatenate([np.cumsum(squares[::-1], axis=0)[::-1][1:], zero])
    return np.asarray(before + after)


def freedom_of(squares: Array, direction: Array) -> float:
    """Return the degrees of freedom of the jackknife's variance along a direction (p,).

    It is a quadratic form in the gradients of the blocks. If these were those of independent
    residuals, its eigenvalues would follow from the blocks' matrices `squares` (b, p, p), and it
    would vary as a chi square of as many degrees as their sum squared over the sum of their squares
    (Satterthwaite). Blocks that tell alike give one less than their number.

    Source: R. M. Bell, D. F. McCaffrey, "Bias reduction in standard errors for linear regression
    with multi-stage samples", 2002; J. E. Pustejovsky, E. Tipton, 2018.

    Examples
    --------
    >>> alike = np.ones((8, 1, 1))
    >>> round(freedom_of(alike, np.ones(1)), 9)
    7.0
    >>> one_tells_most = np.array([[[10.0]], *[[[1.0]]] * 7])
    >>> freedom_of(one_tells_most, np.ones(1)) < 2.0
    True
    """
    size = np.sqrt(np.maximum(np.diagonal(squares.sum(axis=0)), 0.0))
    size = np.where(size > 0.0, size, 1.0)
    squares, direction = squares / np.outer(size, size), direction / size
    known = _solved(squares.sum(axis=0), direction)
    rest = [_solved(item, direction) for item in _rests(squares)]
    others = 1.0 - np.eye(len(squares))
    # how leaving out block g answers to the gradient of block h
    answers = others[:, :, None] * np.array(rest)[:, None, :] - known
    spread = np.einsum("ghp,hpq,khq->gk", answers, squares, answers, optimize=True)
    total = float(np.trace(spread))
    return max(total * total / float(np.sum(spread * spread)), 1.0) if total > 0.0 else 1.0


def _solved(square: Array, wanted: Array) -> Array:
    """Return the least solution (p,) of scaled normal equations."""
    return np.asarray(np.linalg.lstsq(square, wanted, rcond=NEGLIGIBLE**2)[0])


def quantile_of(freedom: Array) -> Array:
    """Return half widths of 95 % intervals in standard errors: of Student's t."""
    return np.asarray(scipy.stats.t.ppf(1.0 - CHANCE / 2.0, freedom))


def effective_size(residual: Array) -> float:
    """Return the number of independent residuals that vary as these (n,) do.

    From the autocorrelation up to its first zero, in the record's order.
    """
    r = residual - residual.mean()
    n = len(r)
    spectrum = np.fft.rfft(r, 2 * n)
    correlation = np.fft.irfft(np.abs(spectrum) ** 2)[:n]
    if correlation[0] <= 0.0:
        return float(n)
    correlation = correlation / correlation[0]
    below = np.flatnonzero(correlation <= 0.0)
    last = int(below[0]) if below.size else n
    return float(n / max(1.0 + 2.0 * correlation[1:last].sum(), 1.0))


INTERVAL = "95 %"
MANY = 30.0
"""An interval that goes so many times the value to either side is none, or as many times
what the record suggests if that is more, nor is one of a logarithm that goes by this factor."""
TOGETHER = 0.95
"""Correlation from which two estimates are one number and a split of it."""
SEPARABLE = 300.0
"""Condition of the scaled slopes beyond which estimates are not separable."""


def bounds_met(free_parameters: FreeParameters, values: Array) -> Mapping[str, str]:
    """Return which unknowns ended at a bound, by path: ``"lower"`` or ``"upper"``."""
    result = {}
    low, high = free_parameters.limits()
    at = free_parameters.coordinates(values)
    for i, item in enumerate(free_parameters.items):
        size = max(abs(item.start), 1e-300) if not item.log else 1.0
        if at[i] <= low[i] + NEGLIGIBLE * size:
            result[item.path] = "lower"
        elif at[i] >= high[i] - NEGLIGIBLE * size:
            result[item.path] = "upper"
    return result


def estimates_of(
    free_parameters: FreeParameters,
    jacobian: ResidualJacobian,
    inference: Inference,
    at_bounds: Mapping[str, str],
) -> tuple[Estimate, ...]:
    """Return the estimates with 95 % intervals, and why an interval is not bounded."""
    result = []
    for i, item in enumerate(free_parameters.items):
        value, half = float(jacobian.values[i]), float(inference.half_widths[i])
        low, high, reason = value - half, value + half, ""
        if item.path in at_bounds:
            low, high = -math.inf, math.inf
            reason = _bound_reason(item, at_bounds[item.path], value)
        elif not math.isfinite(half):
            low, high, reason = -math.inf, math.inf, inference.reasons[i]
        elif item.log:
            spread = half / value
            low, high = value * math.exp(-min(spread, 700.0)), value * math.exp(min(spread, 700.0))
            if spread > math.log(MANY):
                low, high = -math.inf, math.inf
                reason = "the record does not determine its order of magnitude"
        elif half > MANY * max(abs(value), (item.high - item.low) / (2.0 * WIDE)):
            low, high = -math.inf, math.inf
            reason = f"the record does not determine its magnitude, ± {with_unit(half, item, 2)}"
        result.append(
            Estimate(
                path=item.path,
                quantity=item.quantity,
                value=value,
                low=low,
                high=high,
                interval=INTERVAL,
                reason=reason,
                sources={} if reason else _sources(inference, i),
            )
        )
    return tuple(result)


def _sources(inference: Inference, index: int) -> dict[str, float]:
    """Return the standard errors of an estimate by where they come from; none without others."""
    if not inference.held:
        return {}
    own = {READINGS: math.sqrt(max(inference.covariance[index, index], 0.0))}
    return own | {
        path: float(np.linalg.norm(moved[:, index])) for path, moved in inference.held.items()
    }


def _bound_reason(item: FreeParameter, side: str, value: float) -> str:
    if item.above and side == "lower":
        return f"it is not above the {formatting.parameter_words(item.above)}"
    return f"it reached its {side} bound, {with_unit(value, item)}"


def with_unit(value: float, item: FreeParameter, digits: int = 3) -> str:
    """Return a value of an unknown with its unit."""
    return formatting.with_unit(number(value, digits), item.quantity.unit)


def sentences_of(
    free_parameters: FreeParameters,
    jacobian: ResidualJacobian,
    inference: Inference,
    at_bounds: Mapping[str, str],
    estimates: Sequence[Estimate],
) -> tuple[str, ...]:
    """Return what the record cannot tell."""
    lines = [
        f"{formatting.parameter_words(estimate.path)} ({estimate.quantity.symbol}) is not"
        f" identified: {estimate.reason}."
        for estimate in estimates
        if estimate.reason and not estimate.quantity.nuisance
    ]
    paths = list(free_parameters.paths)
    for i, item in enumerate(free_parameters.items):
        if item.above not in paths or item.path in at_bounds:
            continue
        j = paths.index(item.above)
        row = np.zeros(len(paths))
        row[[i, j]] = 1.0, -1.0
        half = inference.half_width(row)
        step = float(jacobian.values[i] - jacobian.values[j])
        if step <= half < math.inf:
            lines.append(
                f"The step from {item.quantity.symbol} to sliding friction is not distinguished"
                f" from 0: {with_unit(step, item)}, interval {number(step - half)} to"
                f" {number(step + half)}."
            )
    known = {
        estimate.path
        for estimate in estimates
        if estimate.bounded and estimate.path not in at_bounds
    }
    lines += _together(free_parameters, inference, known)
    if inference.condition > SEPARABLE:
        symbols = ", ".join(_inseparable(free_parameters, jacobian))
        lines.append(
            f"This record cannot separate {symbols}: the condition number is"
            f" {number(inference.condition, 2)}, above the limit of {number(SEPARABLE)}."
        )
    return tuple(lines)


def _inseparable(free_parameters: FreeParameters, jacobian: ResidualJacobian) -> list[str]:
    """Return the symbols of what the record separates least: what takes part in that direction."""
    quantities = [item.quantity for item in free_parameters.items]
    symbols = ["links" if quantity.nuisance else quantity.symbol for quantity in quantities]
    size = np.linalg.norm(jacobian.slopes, axis=0)
    seen = np.flatnonzero(size > 0.0)
    weakest = np.linalg.svd(jacobian.slopes[:, seen] / size[seen], full_matrices=False)[2][-1]
    result = [*dict.fromkeys(symbols[k] for k in seen[np.abs(weakest) > TAKES_PART])]
    return result if len(result) > 1 else [*dict.fromkeys(symbols)]


def offset_left_out(
    law: FrictionLaw | Laws, mechanism: Mechanism, paths: Collection[str]
) -> tuple[str, ...]:
    """Return a sentence where a level for each direction stands for a constant force as well.

    Of the parameters with `paths` it is none.

    Half the sum of the levels acts against the motion and half their difference always one way, so
    a constant force beside them is the same number twice.
    """
    constants = ("mechanism.offset", "measurement.offset.friction", "offset")
    fitted = any(path in paths for path in constants)
    if fitted or isinstance(law, Laws) or not law.directional:
        return ()
    own = float(getattr(mechanism, "offset", 0.0))
    unit = "N m" if getattr(mechanism, "rotary", False) else "N"
    held = formatting.with_unit(number(own), unit) if own else "0"
    return (
        "A constant force (gravity, a cable, a sensor offset) and different levels in the two"
        f" directions cannot be separated: the offset is fixed at {held} and absorbed"
        " into the two levels.",
    )


def _together(free_parameters: FreeParameters, inference: Inference, known: Set[str]) -> list[str]:
    """Return sentences on pairs of estimates that move together, of those that are identified."""
    lines = []
    # what the mechanism's uncertainty moves together is not for the record to separate
    table = replace(inference, held={}).correlation
    for i, item in enumerate(free_parameters.items):
        for j, other in enumerate(free_parameters.items[:i]):
            free = item.path in known and other.path in known
            told = not (item.quantity.nuisance or other.quantity.nuisance)
            if free and told and np.isfinite(table[i, j]) and abs(table[i, j]) > TOGETHER:
                lines.append(
                    f"{other.quantity.symbol} and {item.quantity.symbol} are strongly correlated"
                    f" ({fixed(table[i, j], 2)}): a combination of them is known better than"
                    " either one."
                )
    return lines
