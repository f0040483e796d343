r"""Leave-block-out regression of thousands of structures from one set of Gram matrices.

With weights :math:`w` and weighted columns :math:`A`, the Gram matrices of all rows,
:math:`G = A^T A`, :math:`h = A^T y`, and those of the rows that are not learned from while block
:math:`b` is left out, :math:`G_b, h_b`, are made once. For a structure with columns :math:`S` the
coefficients without block :math:`b` and its held-out loss are

.. math::
   c_b &= (G - G_b + P)_{SS}^{-1} (h - h_b)_S \\
   L_b &= \frac{1}{n_b} \sum_{i \in b} (w_i (y_i - X_i c_b))^2
        = \frac{1}{n_b} (y_b^T y_b - 2 c_b^T h_{b,S} + c_b^T G_{b,SS} c_b)

and no row is touched again. :math:`P` holds the inverse variances of random effects; elsewhere it
is a ridge of `RIDGE` of the diagonal, which only ends the solution where columns are the same.
Coefficients whose uncertainty is stated (`Term.doubt`) stay at 0; what they move the others by,
:math:`-(G + P)^{-1} g_k \delta_k`, is a part of the covariance, whatever the number of rows.
All structures with the same number of columns are solved together.

The *marginal likelihood* of a structure needs the same matrices. With coefficients of columns of
unit size drawn from :math:`N(0, \bar y^2)`, :math:`\bar y` the root mean square of the response
(random effects from their own spread), :math:`T` their variances, :math:`\lambda, q` the
eigenvalues and vectors of :math:`T^{1/2} G T^{1/2}` and :math:`z = q^T T^{1/2} h`,

.. math::
   \log p(y | S, \sigma) = -\tfrac12 \Big[ (n - k) \log \sigma^2
   + \sum_i \log (\sigma^2 + \lambda_i)
   + \frac{1}{\sigma^2} \Big( y^T y - \sum_i \frac{z_i^2}{\sigma^2 + \lambda_i} \Big) \Big],

averaged over the scale :math:`\sigma` of the noise, even in its logarithm (`SCALES`). What a
structure could have fitted besides counts against it: no price of parameters is needed.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax

from stickslip.errors import InputError
from stickslip.identify.problem import Array, Column, Columns, Fitted, Mask, Problem, Structure
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.show.formatting import count, number

RIDGE = math.sqrt(np.finfo(float).eps)
"""Ridge over the diagonal of a Gram matrix: alike columns share their coefficient."""
NOTHING = 1e-300
"""Added where 0 would be divided by."""
SCALES = np.geomspace(3e-4, 1.0, 30)
"""Scales of the noise over the size of the response, for the marginal likelihood."""
SLOPES = (0.5, 1.0)
"""Powers of the force or the speed with which the scatter may grow."""
MANY = 0.98
"""Part of the rows beyond which others are few."""
FIXED = 1.0 / np.finfo(float).eps
"""Precision of what is not fitted over that of all rows."""
TOGETHER = 256
"""Structures that are solved together, which bounds the memory."""
MOST_MEMORY = 8.0
"""Memory that rows and Gram matrices may take [GB]; copies while they are made count."""
FEWER = (
    "group the loads, as rounded to what was set, where they only scatter; or give fewer rows or"
    " trials"
)


_Parts: TypeAlias = tuple[tuple[Array, Array], tuple[Array, Array]]


class BlockRegression:
    """Columns of a problem, their Gram matrices by block, and losses of structures."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.columns = Columns(problem, problem.rows)
        self.losses_of: dict[Structure, Array] = {}
        self.weights = np.ones(len(problem.response))
        self.price = 0.0
        """What a parameter costs, as a share of the held-out error."""
        self._marginals: dict[Structure, float] = {}
        self._at: dict[Column, NDArray[np.intp]] = {}
        self._size = np.zeros(0)
        self._precision = np.zeros(0)
        self._doubt = np.zeros(0)
        self._matrix = np.zeros((len(problem.response), 0))
        self._weighed = False
        self._parts: _Parts | None = None
        self._count = np.array([block.sum() for block in problem.blocks], dtype=float)

    def add(self, columns: Iterable[Column]) -> None:
        """Add columns to those that structures may have."""
        new = [column for column in dict.fromkeys(columns) if column not in self._at]
        if not new:
            return
        parts, precisions, doubts, j = [], [], [], len(self._size)
        for name, shape in new:
            x = self.columns.of((name, shape))
            self._at[name, shape] = np.arange(j, j + x.shape[1])
            self._check_size(j + x.shape[1], 0)
            parts.append(x)
            precisions.append(self.problem.terms[name].precision(shape) * np.ones(x.shape[1]))
            doubts.append(self.problem.terms[name].doubt * np.ones(x.shape[1]))
            j += x.shape[1]
        blocks = len(self.problem.blocks)
        self._check_size(j, blocks if self.problem.excluded is self.problem.blocks else 2 * blocks)
        matrix = np.hstack(parts)
        size = np.sqrt(np.mean(matrix**2, axis=0))
        size[size == 0.0] = 1.0  # a shape that these rows do not reach, such as a limit
        self._size = np.concatenate([self._size, size])
        self._matrix = np.hstack([self._matrix, matrix / size])
        doubt = np.concatenate(doubts)
        fixed = FIXED * len(matrix) * size**2
        precision = np.where(doubt > 0.0, fixed, np.concatenate(precisions))
        self._precision = np.concatenate([self._precision, precision])
        self._doubt = np.concatenate([self._doubt, doubt])
        if self._weighed:
            self._extend()

    def _check_size(self, columns: int, grams: int) -> None:
        """Refuse rows and Gram matrices that would take more memory than machines have."""
        problem, rows = self.problem, len(self.problem.response)
        # Gram matrices stand beside their larger successors; rows also with their weights.
        memory = 8e-9 * columns * (2.3 * grams * columns + 3.0 * rows)
        if memory > MOST_MEMORY:
            blocks = count(len(problem.blocks), "block")
            raise InputError(
                f"A comparison of laws on {count(rows, 'row')} in {blocks} would take"
                f" {number(memory)} GB of memory, and may take {number(MOST_MEMORY)} GB: {FEWER}."
            )

    def weigh(self, weights: Array) -> None:
        """Set the weights of the rows (n,), which makes the Gram matrices."""
        self.weights, self.losses_of, self._weighed = weights, {}, True
        self._marginals.clear()
        y = self.problem.response * weights
        self.price = self.problem.price(float(np.sqrt(np.mean(y**2))))
        self._squares = np.array([y[rows] @ y[rows] for rows in self.problem.blocks])
        self._weighted = np.zeros((len(y), 0))
        self._total, self._moment = np.zeros((0, 0)), np.zeros(0)
        self._parts = self._grown(self._weighted)
        self._extend()

    def forget(self) -> None:
        """Let go of the Gram matrices by block, most of the memory; few structures make theirs."""
        self._parts = None

    def _grown(self, a: Array, known: _Parts | None = None) -> _Parts:
        """Return Gram matrices and moments in each block, and of what is left out with it."""
        problem, y, count = self.problem, self.problem.response * self.weights, len(self._count)
        first, others = known or ((np.zeros((count, 0, 0)), np.zeros((count, 0))),) * 2
        inside = _extended(first, a, y, problem.blocks)
        same = problem.excluded is problem.blocks
        return inside, inside if same else _extended(others, a, y, problem.excluded)

    def _by_block(self, columns: NDArray[np.intp]) -> tuple[_Parts, NDArray[np.intp]]:
        """Return these for columns of any shape, and where in them the columns are."""
        if self._parts is not None:
            return self._parts, columns
        used, places = np.unique(columns, return_inverse=True)
        return self._grown(self._weighted[:, used]), places.reshape(columns.shape)

    def _extend(self) -> None:
        """Make the parts of the Gram matrices that columns since the last time have."""
        old = self._weighted.shape[1]
        y = self.problem.response * self.weights
        a = np.hstack([self._weighted, self._matrix[:, old:] * self.weights[:, None]])
        self._weighted = a
        self._penalty = self._precision / self._size**2 * float(np.median(self.weights)) ** 2
        everything = [np.ones(len(y), dtype=bool)]
        total, moment = _extended((self._total[None], self._moment[None]), a, y, everything)
        self._total, self._moment = total[0], moment[0]
        if self._parts is not None:
            self._parts = self._grown(a, self._parts)

    def index(self, structure: Structure) -> NDArray[np.intp]:
        """Return the columns of a structure."""
        if not structure:
            return np.zeros(0, dtype=np.intp)
        return np.concatenate([self._at[column] for column in structure])

    def losses(self, structures: Iterable[Structure]) -> None:
        """Find held-out losses by block; infinite where coefficients are no physics."""
        by_size: dict[int, list[Structure]] = {}
        for structure in dict.fromkeys(structures):
            if structure not in self.losses_of:
                by_size.setdefault(len(self.index(structure)), []).append(structure)
        for size, group in by_size.items():
            if size == 0:
                self.losses_of[()] = self._squares / self._count
                continue
            for start in range(0, len(group), TOGETHER):
                self._solve(group[start : start + TOGETHER])

    def _solve(self, group: Sequence[Structure]) -> None:
        columns = np.array([self.index(structure) for structure in group])
        a, b = columns[:, :, None], columns[:, None, :]
        total, moment = self._total[a, b], self._moment[columns]
        diagonal = np.diagonal(total, axis1=1, axis2=2)
        ridge = (
            np.eye(columns.shape[1])
            * (diagonal * RIDGE + self._penalty[columns] + NOTHING)[:, None, :]
        )
        full = np.linalg.solve(total + ridge, moment[..., None])[..., 0]
        ((gram, cross), (near, near_cross)), at = self._by_block(columns)
        a, b = at[:, :, None], at[:, None, :]
        inside = gram[:, a, b]
        left = total[None] - (inside if near is gram else near[:, a, b]) + ridge[None]
        right = moment[None] - near_cross[:, at]
        c = np.linalg.solve(left, right[..., None])[..., 0]
        squares = np.einsum("bsk,bskl,bsl->bs", c, inside, c)
        squares += self._squares[:, None] - 2.0 * np.einsum("bsk,bsk->bs", c, cross[:, at])
        losses = np.maximum(squares, 0.0) / self._count[:, None]
        for i, structure in enumerate(group):
            physical = self.physical(structure, full[i] / self._size[columns[i]])
            self.losses_of[structure] = losses[:, i] if physical else np.full(len(losses), math.inf)

    def marginal(self, structures: Sequence[Structure]) -> Array:
        """Return the logarithms of the marginal likelihoods of structures (s,), each made once."""
        known = self._marginals
        by_size: dict[int, list[Structure]] = {}
        for structure in structures:
            if structure not in known:
                by_size.setdefault(len(self.index(structure)), []).append(structure)
        for size, group in by_size.items():
            for start in range(0, len(group), TOGETHER):
                part = group[start : start + TOGETHER]
                columns = np.array([self.index(structure) for structure in part], dtype=np.intp)
                values = self._marginal(columns.reshape(len(part), size))
                known.update(zip(part, values.tolist(), strict=True))
        return np.array([known[structure] for structure in structures])

    def _marginal(self, columns: NDArray[np.intp]) -> Array:
        """Return the logarithms of the marginal likelihoods of columns (s, k)."""
        problem = self.problem
        count, worth = problem.worth * len(problem.response), problem.worth
        weighted = self.weights * problem.response
        spread = float(np.sqrt(np.mean(problem.response**2))) + NOTHING
        penalty = self._penalty[columns]
        t = np.where(penalty > 0.0, 1.0 / np.sqrt(penalty + NOTHING), spread)
        gram = self._total[columns[:, :, None], columns[:, None, :]]
        values, vectors = np.linalg.eigh(worth * gram * t[:, :, None] * t[:, None, :])
        z = np.einsum("skl,sk->sl", vectors, worth * t * self._moment[columns])
        squared = worth * float(weighted @ weighted)

        def log(scales: Array) -> Array:
            """Return the logarithm of the likelihood at scales of the noise (s, g)."""
            sums = np.maximum(values, 0.0)[..., None] + scales[:, None] ** 2
            squares = squared - np.sum(z[..., None] ** 2 / sums, axis=1)
            return np.asarray(
                -(count - columns.shape[1]) * np.log(scales)
                - 0.5 * np.log(sums).sum(axis=1)
                - 0.5 * np.maximum(squares, 0.0) / scales**2
            )

        coarse = np.tile(SCALES * spread * float(np.median(self.weights)), (len(columns), 1))
        # many rows tell the scale to less than a step of the grid
        peak = np.take_along_axis(coarse, log(coarse).argmax(axis=1)[:, None], axis=1)
        step = SCALES[1] / SCALES[0]
        scales = np.sort(np.hstack([coarse, peak * step ** np.linspace(-0.95, 0.95, 21)]), axis=1)
        each = log(scales)
        most = each.max(axis=1)
        density = np.exp(each - most[:, None])
        return np.asarray(most + np.log(np.trapezoid(density, np.log(scales), axis=1)))

    def physical(self, structure: Structure, coefficients: Array) -> bool:
        """Return whether all coefficients are within their limits; a measured curve has none."""
        if not self.problem.is_law(structure):
            return True
        at = 0
        for name, shape in structure:
            size, term = len(self._at[name, shape]), self.problem.terms[name]
            low, high = term.limits
            low = max(low, 0.0) if term.nonnegative else low
            own = coefficients[at : at + size]
            if np.any((own < low) | (own > high)):
                return False
            at += size
        return True

    def left_between(self, structure: Structure, parts: Sequence[Mask]) -> Array:
        """Return what a structure leaves of parts (n,), each predicted from all other rows."""
        columns, left = self.index(structure), np.array(self.problem.response)
        if not len(columns):
            return left
        a, y = self._weighted[:, columns], self.problem.response * self.weights
        for rows in parts:
            known = a[~rows]
            gram = known.T @ known + np.diag(self._ridge(columns))
            c = np.linalg.solve(gram, known.T @ y[~rows])
            left[rows] -= self._matrix[rows][:, columns] @ c
        return left

    def held_out(self, structure: Structure, response: Array | None = None) -> Array:
        """Return the held-out residual of every row (n,); mean over the blocks that hold it.

        Of other responses (n, m) than the measured one, (n, m).
        """
        y = self.problem.response if response is None else response
        residual, count = np.zeros(y.shape), np.zeros(len(y))
        columns = self.index(structure)
        (_, (near, _)), at = self._by_block(columns)
        a = self._weighted[:, columns]
        weighted = (self.weights * y.T).T
        moment = a.T @ weighted
        for b, rows in enumerate(self.problem.blocks):
            count[rows] += 1.0
            residual[rows] += y[rows]
            if len(columns):
                grid = np.ix_(columns, columns)
                left = self._total[grid] - near[b][np.ix_(at, at)]
                left += np.diag(self._ridge(columns))
                out = self.problem.excluded[b]
                c = np.linalg.solve(left, moment - a[out].T @ weighted[out])
                residual[rows] -= self._matrix[rows][:, columns] @ c
        return np.asarray((residual.T / np.maximum(count, 1.0)).T)

    def _ridge(self, columns: NDArray[np.intp]) -> Array:
        diagonal = np.diag(self._total)[columns]
        return np.asarray(diagonal * RIDGE + self._penalty[columns] + NOTHING)

    def left(self, structure: Structure, weights: Array) -> Array:
        """Return what a fit with weights leaves of the response (n,)."""
        columns, y = self.index(structure), self.problem.response
        if not len(columns):
            return y
        x = self._matrix[:, columns]
        a = x * weights[:, None]
        gram = a.T @ a
        ridge = np.diag(gram) * RIDGE + self._precision[columns] / self._size[columns] ** 2
        return y - x @ np.linalg.solve(gram + np.diag(ridge + NOTHING), a.T @ (y * weights))

    def design(self, structure: Structure) -> tuple[Array, Array]:
        """Return columns of unit size (n, k) and the precisions of their coefficients (k,)."""
        columns = self.index(structure)
        return self._matrix[:, columns], self._precision[columns] / self._size[columns] ** 2

    def fit(self, structure: Structure, weights: Array | None = None) -> Fitted:
        """Fit a structure to all rows; covariance by residuals, or by stretches (sandwich)."""
        problem, w = self.problem, self.weights if weights is None else weights
        columns = self.index(structure)
        y = problem.response * w
        if not len(columns):
            none = np.zeros(0)
            return Fitted(
                fitted=np.zeros(len(y)),
                coefficients=none,
                covariance=np.zeros((0, 0)),
                freedom=float(len(y)),
            )
        x, size = self._matrix[:, columns], self._size[columns]
        a = x * w[:, None]
        gram = a.T @ a
        penalty = self._precision[columns] / self._size[columns] ** 2
        penalty = penalty * float(np.median(w)) ** 2 + np.diag(gram) * 1e-9 + NOTHING
        inverse = _inverse(gram + np.diag(penalty))
        c = inverse @ (a.T @ y)
        e = y - a @ c
        count = int(problem.stretches.max()) + 1
        scores = np.zeros((count, len(columns)))
        np.add.at(scores, problem.stretches, a * e[:, None])
        freedom = count - 1.0
        root = scores @ inverse * math.sqrt(problem.spread * count / freedom)
        prior = np.sqrt(self._precision[columns]) / size * float(np.median(w))
        if np.any(prior):  # where rows tell nothing, the prior does
            root = np.vstack([root, (prior[:, None] * inverse)[prior > 0.0]])
        doubt = self._doubt[columns] * size
        if np.any(doubt):
            moved = np.eye(len(columns)) - gram @ inverse
            root = np.vstack([root, (doubt[:, None] * moved)[doubt > 0.0]])
        covariance, root = root.T @ root, root / size
        return Fitted(
            fitted=x @ c,
            coefficients=c / size,
            covariance=covariance / np.outer(size, size),
            freedom=freedom,
            root=root,
        )


def _extended(
    known: tuple[Array, Array], a: Array, y: Array, masks: Sequence[Mask]
) -> tuple[Array, Array]:
    """Return Gram matrices (b, p, p) and moments (b, p) of rows of masks; first parts are known."""
    old, new = known[0].shape[1], a.shape[1]
    gram, moment = np.empty((len(masks), new, new)), np.empty((len(masks), new))
    gram[:, :old, :old], moment[:, :old] = known
    for k, rows in enumerate(masks):
        own = a[rows]
        gram[k, :, old:] = own.T @ own[:, old:]
        gram[k, old:, :old] = gram[k, :old, old:].T
        moment[k, old:] = own[:, old:].T @ y[rows]
    return gram, moment


def _inverse(matrix: Array) -> Array:
    """Return the inverse of a positive matrix, directions that rounding decides left out."""
    size = np.sqrt(np.diag(matrix)) + NOTHING
    inverse = np.linalg.pinv(matrix / np.outer(size, size), hermitian=True, rcond=1e-12)
    return np.asarray(inverse / np.outer(size, size))


def noise_weights(
    regression: BlockRegression, structure: Structure, *, even: bool = False
) -> Array:
    """Return weights (n,) by the scatter of what a structure leaves.

    The scatter grows with each power of what it may grow with as far as that is likely; of `even`
    rows it is constant. Rows beyond `Thresholds.outlier` standard deviations lose weight. The mean
    square of weighted residuals is about 1.
    """
    problem = regression.problem
    fitted = regression.fit(structure).fitted
    # e / (1 - h) is held out, e is left, and e / sqrt(1 - h) has the variance of the noise
    left = problem.response - fitted
    residual = np.sqrt(np.abs(regression.held_out(structure) * left))
    scales = () if even else problem.scales(fitted)
    # how noise grows is no matter of a few rows, as turns are not
    most = max(THRESHOLDS.outlying * float(np.median(residual)), float(np.quantile(residual, MANY)))
    near = np.minimum(residual, most)
    deviation = np.exp(_growth(near, scales, problem.parameters(structure)))
    u = residual / deviation
    typical = 1.4826 * float(np.median(u)) + 1e-12 * float(np.max(np.abs(problem.response)))
    z = u / (typical + NOTHING)
    robust = np.minimum(1.0, (THRESHOLDS.outlier / np.maximum(z, 1e-9)) ** problem.softness)
    weights = robust / deviation
    e = weights * (problem.response - regression.fit(structure, weights).fitted)
    rank = min(problem.parameters(structure), len(e) - 2)
    count = max(int((robust > 0.3).sum()) - rank, 1)
    # a fit without residuals still has the rounding of its numbers, and of filters
    size = float(np.max(np.abs(weights * problem.response)))
    least = (THRESHOLDS.rounding * size) ** 2
    return weights / math.sqrt(float(e @ e) / count + least + NOTHING)


def _growth(residual: Array, scales: Sequence[Array], parameters: int) -> Array:
    """Return the logarithms (n,) of how noise grows: the mean over powers by their likelihood.

    That is Laplace's, of as many rows as parameters leave.
    """
    trends, gains = [np.zeros(len(residual))], [0.0]
    for scale in scales:
        z = np.log(scale) - np.mean(np.log(scale))
        for slope in SLOPES:
            less = np.mean(residual * np.exp(-slope * z))
            gain = math.log((np.mean(residual) + NOTHING) / (less + NOTHING))
            gains.append(max(len(z) - parameters, 1) * gain - THRESHOLDS.growth)
            trends.append(slope * z)
    return np.asarray(softmax(gains) @ np.array(trends))


def noise_at(regression: BlockRegression, rows: Any) -> Array:
    """Return the standard deviation of a reading at rows (n,): that of the nearest by speed."""
    problem, own = regression.problem, 1.0 / regression.weights
    own = np.minimum(own, 3.0 * float(np.median(own)))
    known = np.log(problem.speeds(problem.rows))
    order = np.argsort(known, kind="stable")
    at = np.log(problem.speeds(rows))
    above = np.clip(np.searchsorted(known[order], at), 1, len(known) - 1)
    near = np.where(at - known[order][above - 1] <= known[order][above] - at, above - 1, above)
    # of rows with the same speed, the first
    return np.asarray(own[order[np.searchsorted(known[order], known[order][near])]])


# Terms that a design does not tell apart: their columns span the same.


@dataclass(frozen=True, kw_only=True)
class Spans:
    """What else the columns of a structure may be."""

    instead: Mapping[str, Sequence[Column]]
    """For each term of the structure, those that could stand in its place, with their shapes."""
    within: Sequence[Column]
    """Terms whose columns lie in the span of all of its columns together."""


def same_span(regression: BlockRegression, structure: Structure) -> Spans:
    r"""Return the terms of a vocabulary that a structure is not told apart from.

    Let :math:`A_\perp` be what is left of the columns of a term beside those of all others, and
    :math:`B_\perp` the same of another term that could stand in its place. No data of this design
    tell the two apart where the largest principal angle between them vanishes. Where
    :math:`B_\perp` itself vanishes beside the whole structure, the term adds nothing to it.

    The angle is judged by the columns alone, weighted as the rows are, not by how well a law fits;
    so names of one group follow from the design, and from no list.
    """
    problem, w = regression.problem, regression.weights[:, None]

    def columns(column: Column) -> Array:
        x = regression.columns.of(column) * w
        return np.asarray(x / (np.linalg.norm(x, axis=0) + 1e-300))

    own = {name: columns((name, shape)) for name, shape in structure}
    everything = _basis(np.hstack([*own.values()]) if own else np.zeros((len(w), 0)))
    beside = {
        name: _basis(np.hstack([np.zeros((len(w), 0)), *(own[k] for k in own if k != name)]))
        for name in own
    }
    instead: dict[str, list[Column]] = {name: [] for name in own}
    within = []
    least = THRESHOLDS.same_span
    for name, term in problem.terms.items():
        if name in own or term.role == "curve":
            continue
        for shape in term.shapes:
            x = columns((name, shape))
            if np.linalg.norm(x) == 0.0:
                continue
            if _left(x, everything) > least:
                continue
            within.append((name, shape))
            for known, others in beside.items():
                new = _basis(np.hstack([others, x]), least)
                if new.shape[1] >= everything.shape[1] and _left(own[known], new) <= least:
                    instead[known].append((name, shape))
            break  # one shape of a term tells
    return Spans(instead={name: found for name, found in instead.items() if found}, within=within)


def _basis(x: Array, least: float = 1e-10) -> Array:
    """Return an orthonormal basis (n, r) of the span of columns (n, p) of size 1."""
    if not x.shape[1]:
        return x
    u, s, _ = np.linalg.svd(x, full_matrices=False)
    return np.asarray(u[:, s > least])


def _left(x: Array, basis: Array) -> float:
    """Return the largest part of columns of size 1 that lies outside a span."""
    return float(np.max(np.linalg.norm(x - basis @ (basis.T @ x), axis=0)))
