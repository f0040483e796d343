r"""The posterior: one model of a measurement, from which every statement is read.

A measurement of any kind is

.. math::
    y_i = \sum_t c_t\, x_t(i; \theta_t) + \sum_k b_k\, z_k(i) + e_i ,

a law, whose terms :math:`x_t` have shapes :math:`\theta_t` on a grid; what every experiment may
have (an offset, drift, runs) and what no law says (a Gaussian process of the logarithm of speed,
after Kennedy and O'Hagan, 2001), which are always there with the sizes that their priors give; and
noise with what repeats share, of covariance :math:`V`. Given some *scales*, all is linear and
Gaussian. With the columns :math:`Z` of prior deviations :math:`q`, :math:`Q = \mathrm{diag}(q^2)`,
and those of all laws :math:`X`,

.. math::
    K &= Z^T V^{-1} Z + Q^{-1} , \\
    S &= [X\ y]^T (V^{-1} - V^{-1} Z K^{-1} Z^T V^{-1}) [X\ y] , \\
    \log p(y \mid \text{node})
      &= -\tfrac12 (\log|V| + \log|K| + \log|Q| + S_{yy}) , \\
    \log p(y \mid \text{law, node})
      &= \log p(y \mid \text{node})
       + \tfrac12 (S_{yX}\, c - \log|M|) - d \log s + \sum_t \log 2\Phi(c_t / \sigma_t) ,

where :math:`M = S_{XX} + s^{-2}`, :math:`c = M^{-1} S_{Xy}`, columns are scaled to the size of the
friction, :math:`s` is `COEFFICIENT`, and the last sum is over coefficients that are not negative,
and sums of them such as a level at the fastest speed, over their share of the prior, the least
likely first and each given those before it (Mendell and Elston, 1974): of two that fit
together only, one of them negative, no margin shows it. Random columns whose coefficients cannot
be negative, such as a dead zone, are treated like columns of laws, scaled by their prior deviation.
One Cholesky factor serves all laws of a node.

1. A *node* is a value of each scale. Nodes are visited from where the problem begins, first those
   that are expected to be best by what the same step along a scale gained elsewhere, from nodes
   within `DEPTH` of the best that was met, until `most` were visited.
2. What the best node has of a doubted scale is compared with the best node without it.
3. Of many scales of which the measurement says little, the likeliest nodes are a small part of all,
   and have the least sizes. Others are drawn about the best nodes: each scale in proportion to its
   weights where the others are as there, as many of each value as that says (Latin hypercube). They
   count by their weight over the probability of the draw (importance sampling, the largest bounded
   as by Ionides, 2008); nodes that were visited count as they are.
4. The weights :math:`p(\text{law, node} \mid y)` follow by normalising, and are the only ones:
   shares of laws are sums of them, bands and intervals are quantiles of draws by them.
5. Draws take a node and a structure by weight, and coefficients from their normal distribution,
   those that are physics first.
"""

import heapq
import math
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack
from scipy.special import log_ndtr

Array: TypeAlias = NDArray[np.float64]
Places: TypeAlias = NDArray[np.intp]
Node: TypeAlias = tuple[int, ...]
"""Index of the value of each scale."""
Step: TypeAlias = tuple[int, int, int]
"""Number of a scale, and the indices of the values from and to which it is changed."""
Column: TypeAlias = tuple[str, tuple[float, ...]]
"""Name of a term of a law and its shape."""
Structure: TypeAlias = tuple[Column, ...]
"""A law with its shapes: its columns, in the order of their names."""
Family: TypeAlias = tuple[str, ...]
"""Names of the terms of a structure."""
Known: TypeAlias = dict[int, float]
"""Coefficients that are known, by the number of their column."""
Batch: TypeAlias = tuple[Places, Places, NDArray[np.bool_], Array, Known]
"""Structures with as many columns: places, columns, signs, sums and what is known."""

COEFFICIENT = 1.5
"""Prior standard deviation of a coefficient, over the size of the friction: a law may be larger
than what it leaves after another part is taken off."""
DEPTH = 4.5
"""Logarithm of the weight below the best from which nodes are not opened: 1 % of it."""
SURELY = 1e-3
"""Part of an expected loss that counts where a step is tried from the best node: whether that is a
maximum is seen before others are opened."""
TINY = 1e-300
AT_BOUND = -6.0
"""Deviations below 0 from which a coefficient is at 0: what is left of its variance, a thirtieth,
would hide how badly others fit then."""
ROUNDING = 1e-9
"""Part of its deviation by which a coefficient that is held to 0 may be off."""
SPARE = 4
"""Draws of coefficients for each that is kept, so that those that are physics suffice."""
UNSHOWN = 2.0
"""Errors of the parameters of links over those that rows show: a filter or a delay is the same in
all, and rows by which a joint is judged were among them."""


@dataclass(frozen=True, kw_only=True)
class Scale:
    """A scale of the model: the values that are summed over, and their prior."""

    name: str
    values: tuple[float, ...]
    prior: tuple[float, ...]
    """Prior probabilities of the values, in sum 1 where no other part of the prior has them."""
    ordered: bool = True
    """Whether only neighbouring values are visited from a value, or all others."""
    judged: bool = True
    """Whether the measurement says which values hold. Else each makes other data of it, as the
    cutoff of a filter does, whose evidence does not compare: its weight is its prior."""

    @cached_property
    def logarithms(self) -> tuple[float, ...]:
        """Logarithms of the prior."""
        return tuple(math.log(p) if p > 0.0 else -math.inf for p in self.prior)


@dataclass(frozen=True, kw_only=True, eq=False)
class System:
    """Normal equations of a node."""

    gram: Array
    """:math:`[Z\\ X\\ y]^T V^{-1} [Z\\ X\\ y]` (m + p + 1, m + p + 1), columns of laws scaled."""
    deviations: Array
    """Prior standard deviations of the random coefficients (m,)."""
    volume: float
    """Minus half the logarithm of the determinant of :math:`V`, and what of the squared response
    is in no column, such as the scatter within cells."""
    sizes: Array
    """Factors (p,) by which columns of laws were scaled: coefficients are those of the scaled
    columns times these."""
    positive: tuple[int, ...] = ()
    """Random columns whose coefficients are not negative."""
    links: tuple[int, ...] = ()
    """Random columns of links, whose errors are `UNSHOWN` times those that rows show."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Draws:
    """Draws of one structure at one node."""

    node: Node
    structure: Structure
    law: Array
    """Coefficients of the law (d, k)."""
    random: Array
    """Coefficients of the random columns (m, k)."""


class Model(ABC):
    """A measurement as the posterior takes it: scales, structures, normal equations."""

    scales: Sequence[Scale]
    """The scales, in the order of the entries of a node."""
    signed: frozenset[str] = frozenset()
    """Terms whose coefficients may have either sign."""
    certain: Mapping[str, float] = MappingProxyType({})
    """Terms whose coefficients are known."""

    @abstractmethod
    def system(self, node: Node, columns: Sequence[Column]) -> System:
        """Return the normal equations of a node with the columns of laws."""

    def not_below_zero(self, structure: Structure) -> Array:
        """Return sums of coefficients (k, d) that are not negative, beside coefficients: none.

        Friction brakes, also where a term with either sign takes off from a level.
        """
        return np.zeros((0, len(structure)))

    def prior(self, node: Node) -> float:
        """Return the logarithm of the prior of a node."""
        return sum(scale.logarithms[k] for scale, k in zip(self.scales, node, strict=True))


def family_of(structure: Structure) -> Family:
    """Return the names of the terms of a structure."""
    return tuple(name for name, _ in structure)


def neighbours(scales: Sequence[Scale], node: Node) -> Iterator[tuple[Step, Node]]:
    """Yield steps to nodes that differ in one scale, with these.

    They are the next where values of the scale are ordered.
    """
    for at, (scale, own) in enumerate(zip(scales, node, strict=True)):
        steps = (own - 1, own + 1) if scale.ordered else range(len(scale.values))
        for other in steps:
            if 0 <= other < len(scale.values) and other != own:
                yield (at, own, other), (*node[:at], other, *node[at + 1 :])


class Gains:
    """What steps along scales gained where they were last made."""

    def __init__(self, scales: Sequence[Scale]) -> None:
        self._ordered = [scale.ordered for scale in scales]
        self._gains: dict[Step, float] = {}

    def learn(self, step: Step, gain: float) -> None:
        """Take what a step gained: its reverse loses it, and the next may gain as much."""
        at, first, last = step
        self._gains[step], self._gains[at, last, first] = gain, -gain
        if self._ordered[at]:
            self._gains.setdefault((at, last, 2 * last - first), gain)

    def loss(self, step: Step, lacking: float) -> float:
        """Return how far below the best a step is expected to end from a node that lacks so much.

        Examples
        --------
        >>> gains = Gains([Scale(name="a", values=(1.0, 2.0, 3.0), prior=(1 / 3,) * 3)])
        >>> gains.learn((0, 0, 1), 2.0)
        >>> gains.loss((0, 1, 2), 0.5), gains.loss((0, 1, 0), 0.5)
        (-1.5, 2.5)
        """
        loss = lacking - self._gains.get(step, 0.0)
        return loss if lacking > 0.0 or loss < 0.0 else SURELY * loss


def not_negative(mean: Array, covariance: Array, positive: "NDArray[np.bool_]") -> Array:
    """Return logarithms of the probability (s,) that coefficients (s, d) are not negative.

    In turn, the least likely first: each given those before, whose moments are those of a truncated
    normal distribution.

    Examples
    --------
    >>> both = np.array([[[1.0, -0.5], [-0.5, 1.0]]])
    >>> found = not_negative(np.zeros((1, 2)), both, np.ones((1, 2), dtype=bool))
    >>> round(float(np.exp(found[0])), 2)  # 1/4 + arcsin(-1/2) / 2 pi = 1/6
    0.17
    """
    least = ROUNDING**4  # a smaller variance is one of rounding, which may be negative
    total, variances = np.zeros(len(mean)), np.diagonal(covariance, axis1=1, axis2=2)
    near = np.any(positive & (mean < -AT_BOUND * np.sqrt(np.maximum(variances, least))), axis=1)
    if not near.all():
        total[near] = not_negative(mean[near], covariance[near], positive[near])
        return total
    mean, covariance, every = mean.copy(), covariance.copy(), np.arange(len(mean))
    left = positive.copy()
    for _ in range(mean.shape[1]):
        size = np.sqrt(np.maximum(np.diagonal(covariance, axis1=1, axis2=2), least))
        at = np.argmin(np.where(left, mean / size, np.inf), axis=1)
        counts = left[every, at]
        left[every, at] = False
        z = np.where(counts, mean[every, at] / size[every, at], 0.0)
        inside = log_ndtr(z)
        total += counts * inside
        if not left.any():
            break
        mills = np.exp(np.where(z < AT_BOUND, 0.0, -0.5 * z * z - inside)) / math.sqrt(math.tau)
        mills = counts * np.where(z < AT_BOUND, -z, mills)
        slope = covariance[every, at] / size[every, at, None]
        mean += slope * mills[:, None]
        less = np.where(z < AT_BOUND, counts, np.clip(mills * (mills + z), 0.0, 1.0))[:, None, None]
        covariance -= less * slope[:, :, None] * slope[:, None, :]
    return np.asarray(total)


def brakes(mean: Array, covariance: Array, positive: "NDArray[np.bool_]", sums: Array) -> Array:
    """Return by how much likelier than before coefficients (s, d) and sums are not negative.

    Logarithms (s,); before, coefficients are about 0 and none goes with another.

    Examples
    --------
    >>> sums = np.array([[[1.0, 1.0]]])  # of two that are either sign alone
    >>> found = brakes(np.ones((1, 2)), np.eye(2)[None], np.zeros((1, 2), dtype=bool), sums)
    >>> round(float(np.exp(found[0])), 2)  # Phi(2 / sqrt(2)) over a half
    1.84
    """
    if not sums.shape[1]:
        before = positive.sum(axis=1) * math.log(0.5)
        return np.asarray(not_negative(mean, covariance, positive) - before)
    both = np.concatenate([np.broadcast_to(np.eye(mean.shape[1]), covariance.shape), sums], axis=1)
    positive = np.concatenate([positive, np.ones(sums.shape[:2], dtype=bool)], axis=1)
    ends, across = np.einsum("skd,sd->sk", both, mean), both.swapaxes(1, 2)
    before = not_negative(0.0 * ends, both @ across, positive)
    return np.asarray(not_negative(ends, both @ covariance @ across, positive) - before)


def held_to_zero(x: Array, root: Array, bounded: Places) -> None:
    """Hold what is negative of the bounded coefficients of draws (n, k) to 0; the others follow.

    What is negative then is held as well, so that draws stay on the fit.
    """
    held = np.zeros((len(bounded), x.shape[1]), dtype=bool)
    least = -ROUNDING * np.sqrt(np.sum(root[bounded] ** 2, axis=1))[:, None]
    for _ in range(len(bounded)):
        more = x[bounded] < least
        if not more.any():
            return
        held, covariance = held | more, root @ root[bounded].T
        for kept in np.unique(held[:, more.any(axis=0)], axis=1).T:
            at = np.flatnonzero(np.all(held == kept[:, None], axis=0))
            own = bounded[kept]
            gain = covariance[:, kept] @ np.linalg.pinv(covariance[np.ix_(own, kept)])
            x[:, at] -= gain @ x[np.ix_(own, at)]


class Posterior:
    """The weights of structures at nodes.

    Parameters
    ----------
    model : Model
        The measurement.
    structures : sequence of Structure
        The laws with their shapes.
    priors : array (s,)
        Logarithms of their prior probabilities.
    begin : sequence of Node
        Nodes from which the visit begins.
    most : int
        Nodes that are visited at most; half as many more from rivals.
    drawn : int
        Draws of nodes beside these.
    doubted : collection of str
        Scales whose first value is none: what the best node has of one is compared with the best
        without it, which a search that changes one scale at a time may miss.
    """

    def __init__(
        self,
        model: Model,
        structures: Sequence[Structure],
        priors: Array,
        *,
        begin: Sequence[Node],
        most: int,
        drawn: int = 0,
        doubted: Collection[str] = (),
    ) -> None:
        self.model, self.structures = model, tuple(structures)
        self.priors = np.asarray(priors, dtype=float)
        self.columns = tuple(dict.fromkeys(item for law in self.structures for item in law))
        self._batches: dict[int, tuple[Batch, ...]] = {}
        self._given = [k for k, item in enumerate(model.scales) if not item.judged]
        self._seen: dict[Node, Array] = {}
        self._values: dict[Node, float] = {}
        self._best: dict[Node, float] = {}
        self._importance: dict[Node, float] = {}
        self._visit(begin, most)
        rivals = self._rivals([k for k, x in enumerate(model.scales) if x.name in doubted])
        if rivals:
            self._visit(rivals, most // 2)
        if drawn:
            self._draw_nodes(drawn, [min(self._seen, key=self._lacking), *rivals])
        self.nodes = tuple(self._seen)
        more = np.array([self._importance.get(node, 0.0) for node in self.nodes])
        table = np.array([self._seen[node] for node in self.nodes]) + more[:, None]
        of = [self._data(node) for node in self.nodes]
        total = {
            item: np.logaddexp.reduce(table[[own == item for own in of]].ravel())
            for item in set(of)
        }
        self.evidence = float(np.logaddexp.reduce(list(total.values())) - math.log(len(total)))
        """Logarithm of the probability of the measurement, over all laws and nodes."""
        given = [model.scales[k].prior for k in self._given]
        shares = {
            item: math.prod(prior[k] for prior, k in zip(given, item, strict=True))
            for item in total
        }
        less = np.array(
            [total[item] - math.log(shares[item] / sum(shares.values())) for item in of]
        )
        self.weights: Array = np.exp(table - less[:, None])
        """Posterior probabilities of nodes and structures (k, s), in sum 1."""

    def _batched(self, before: int) -> Iterator[Batch]:
        """Yield structures with as many sums, after random ones that are not negative.

        Of each: places, columns, signs, sums, what is known. Those with fewer columns than others
        have the one after the response in place of more, which is 0.
        """
        number = {column: k for k, column in enumerate(self.columns, before)}
        free = [
            tuple(x for x in structure if x not in self.known_of(structure))
            for structure in self.structures
        ]
        sums = [self.model.not_below_zero(item) for item in free]
        groups: dict[tuple[int, tuple[tuple[Column, float], ...]], list[int]] = {}
        for k, item in enumerate(self.structures):
            groups.setdefault((len(sums[k]), tuple(self.known_of(item).items())), []).append(k)
        for (more, known), places in groups.items():
            longest = before + max(len(free[k]) for k in places)
            of = np.full((len(places), longest), before + len(self.columns) + 1, dtype=np.intp)
            of[:, :before] = np.arange(before)
            positive = of < before
            totals = np.zeros((len(places), more, longest))
            for row, k in enumerate(places):
                end = before + len(free[k])
                of[row, before:end] = [number[column] for column in free[k]]
                positive[row, before:end] = self._is_positive(free[k])
                totals[row, :, before:end] = sums[k]
            of_known = {number[column]: x for column, x in known}
            yield np.array(places, dtype=np.intp), of, positive, totals, of_known

    def known_of(self, structure: Structure) -> Mapping[Column, float]:
        """Return the columns of a structure whose coefficients are known, with these."""
        known = self.model.certain
        return {item: known[item[0]] for item in structure if item[0] in known}

    def _visit(self, begin: Sequence[Node], most: int) -> None:
        """Visit nodes best first: each is compared with the best of the same data.

        A step is expected to gain what it gained elsewhere; of the best node all are tried.
        """
        gains, queue = Gains(self.model.scales), list[tuple[float, Node, Step, Node]]()
        opened = list(dict.fromkeys(begin))
        for node in opened:
            self._compare(node)
        done, most = {*opened}, most + len(self._seen)
        while len(self._seen) < most:
            for parent in opened:
                if (lacking := self._lacking(parent)) <= DEPTH:
                    for step, node in neighbours(self.model.scales, parent):
                        heapq.heappush(queue, (gains.loss(step, lacking), node, step, parent))
            if not queue:
                return
            before, node, step, parent = heapq.heappop(queue)
            opened, loss = [], gains.loss(step, self._lacking(parent))
            # what a step gained elsewhere orders the queue; where scales are correlated, it may
            # gain here
            if node in done or self._lacking(parent) > DEPTH:
                continue
            if loss > before:
                heapq.heappush(queue, (loss, node, step, parent))
                continue
            self._compare(node)
            done.add(node)
            opened = [node]
            if step[0] not in self._given:
                gains.learn(step, self.value(node) - self.value(parent))

    def _rivals(self, doubted: Sequence[int]) -> list[Node]:
        """Return rivals of the best node, without what it has of each doubted scale.

        Each is led to the best that other doubted scales make of it; none is far behind.
        """
        result = list[Node]()
        for at in doubted:
            best = min(self._seen, key=self._lacking)
            data = self._data(best)
            near = [x for x in self._seen if self._data(x) == data and not x[at]]
            if not best[at] or any(self._lacking(x) <= DEPTH for x in near):
                continue
            node, after = best, (*best[:at], 0, *best[at + 1 :])
            self._compare(after)
            while after != node:
                node = after
                near = [
                    other
                    for (scale, _, _), other in neighbours(self.model.scales, node)
                    if scale in doubted and scale != at
                ]
                for other in near:
                    self._compare(other)
                after = min([node, *near], key=self._lacking)
            result.append(node)
        return [node for node in result if self._lacking(node) <= DEPTH]

    def _draw_nodes(self, count: int, centres: Sequence[Node]) -> None:
        """Draw nodes about some beside those visited; find the importance of each."""
        centres = [*dict.fromkeys(x for x in centres if self._lacking(x) <= DEPTH)]
        each = count // len(centres)
        proposals = [[self._slice(x, at, each) for at in range(len(x))] for x in centres]
        visited, rng, drawn = {*self._seen}, np.random.default_rng(count), Counter[Node]()
        for numbers in proposals:
            parts = [np.repeat(np.arange(len(n)), n) for n in numbers]
            drawn.update(zip(*(rng.permutation(x).tolist() for x in parts), strict=True))
        groups = dict[Node, list[Node]]()
        for node in drawn:
            groups.setdefault(self._data(node), []).append(node)
        for same in groups.values():
            outside = [node for node in same if node not in visited]
            for node in outside:
                self._compare(node)
                likely = np.logaddexp.reduce([
                    sum(math.log(n[k] / each + TINY) for n, k in zip(numbers, node, strict=True))
                    for numbers in proposals
                ])  # fmt: skip
                self._importance[node] = math.log(drawn[node] / each) - float(likely)
            values = [self.value(node) + self._importance[node] for node in outside]
            if values:
                most = np.logaddexp.reduce(values) - 0.5 * math.log(
                    sum(drawn[node] for node in same)
                )
                for node, value in zip(outside, values, strict=True):
                    self._importance[node] -= max(value - float(most), 0.0)

    def _slice(self, centre: Node, at: int, count: int) -> Places:
        """Return how many of draws take each value of a scale, by weights about a node.

        Of ordered values those beyond a value of little weight are not taken, any other is.
        """
        scale = self.model.scales[at]
        values = np.full(len(scale.values), -math.inf)
        if at in self._given:
            return allotted(np.ones(len(values)), count)
        ways = [range(centre[at], len(values)), range(centre[at] - 1, -1, -1)]
        for way in ways if scale.ordered else [range(len(values))]:
            for k in way:
                self._compare((*centre[:at], k, *centre[at + 1 :]))
                values[k] = self.value((*centre[:at], k, *centre[at + 1 :]))
                if scale.ordered and values[k] < self.value(centre) - DEPTH:
                    break
        weights = np.exp(values - np.logaddexp.reduce(values))
        return allotted(np.where(weights > 0.0, np.maximum(weights, 1.5 / count), 0.0), count)

    def _compare(self, node: Node) -> None:
        """Compare a node with the best of the same data."""
        data = self._data(node)
        self._best[data] = max(self.value(node), self._best.get(data, -math.inf))

    def _lacking(self, node: Node) -> float:
        """Return by how much a node that was visited is below the best of the same data."""
        best = self._best[self._data(node)]
        return 0.0 if self.value(node) == best else best - self.value(node)

    def _data(self, node: Node) -> Node:
        """Return the values of the scales that make other data."""
        return tuple(node[k] for k in self._given)

    def value(self, node: Node) -> float:
        """Return the logarithm of the weight of a node, which is not normalised."""
        if node not in self._seen:
            self._seen[node] = self._structures_at(node)
            self._values[node] = float(np.logaddexp.reduce(self._seen[node]))
        return self._values[node]

    def _structures_at(self, node: Node) -> Array:
        """Return the logarithms of the weights of structures at a node (s,)."""
        system = self.model.system(node, self.columns)
        base, left = eliminated(system)
        result, prior = np.empty(len(self.structures)), self.priors + self.model.prior(node)
        most = self._best.get(self._data(node), -math.inf)
        every, nothing, before = left, base, len(system.positive)
        if before not in self._batches:
            self._batches[before] = tuple(self._batched(before))
        sizes = np.concatenate([np.ones(before), system.sizes, np.ones(2)])
        for at, of, positive, rows, known in self._batches[before]:
            left, base = every, nothing
            if known:
                left = without(every, {k: x / sizes[k] for k, x in known.items()})
                base += 0.5 * float(every[-1, -1] - left[-1, -1])
            size = of.shape[1]
            wider = np.zeros((len(left) + 1, len(left) + 1))
            wider[:-1, :-1] = left
            m = wider[of[:, :, None], of[:, None, :]]
            m[:, range(size), range(size)] += COEFFICIENT**-2
            moment = wider[of, -2]
            inverse, logarithm = inverted(m)
            c = np.einsum("sij,sj->si", inverse, moment)
            c += np.einsum("sij,sj->si", inverse, moment - np.einsum("sij,sj->si", m, c))
            # about a maximum, so that what is off in c is so by its square
            quadratic = 0.5 * np.einsum("si,sij,sj->s", c, m, c)
            gain = np.sum(moment * c, axis=1) - quadratic
            gain -= 0.5 * logarithm + size * math.log(COEFFICIENT)
            sums = rows * sizes[of][:, None, :]
            # at most, as if nothing could be negative
            result[at] = base + gain + (positive.sum(axis=1) + sums.shape[1]) * math.log(2.0)
            near = result[at] + prior[at] > most + 2.0 * math.log(ROUNDING)
            if near.any():
                inside = brakes(c[near], inverse[near], positive[near], sums[near])
                result[at[near]] = base + gain[near] + inside
        return np.asarray(result + prior)

    @property
    def shares(self) -> Array:
        """Posterior probabilities of the structures (s,)."""
        return np.asarray(self.weights.sum(axis=0))

    @property
    def best(self) -> Node:
        """The node with the largest weight of its own."""
        more = np.array([self._importance.get(node, 0.0) for node in self.nodes])
        return self.nodes[int(np.argmax(self.weights.sum(axis=1) * np.exp(-more)))]

    def law_at(self, node: Node) -> Structure:
        """Return the law with the largest weight at a node."""
        return self.structures[int(np.argmax(self.weights[self.nodes.index(node)]))]

    def scale(self, name: str) -> Array:
        """Return the posterior probabilities of the values of a scale."""
        at = [item.name for item in self.model.scales].index(name)
        result = np.zeros(len(self.model.scales[at].values))
        np.add.at(result, [node[at] for node in self.nodes], self.weights.sum(axis=1))
        return result

    def draws(
        self, count: int, *, seed: int = 0, only: "NDArray[np.bool_] | None" = None
    ) -> list[Draws]:
        """Return `count` draws, in the order of nodes and structures, of those in `only` (k, s)."""
        weights = self.weights if only is None else np.where(only, self.weights, 0.0)
        numbers = allotted(weights.ravel(), count)
        numbers, result = numbers.reshape(weights.shape), []
        for a in np.flatnonzero(numbers.any(axis=1)).tolist():
            node = self.nodes[a]
            system = self.model.system(node, self.columns)
            inverse = inverse_root(system)
            for k in np.flatnonzero(numbers[a]).tolist():
                structure, rng = self.structures[k], np.random.default_rng([seed, *node, k])
                mean, root = self._moments(system, inverse, structure)
                size = len(mean), SPARE * int(numbers[a, k])
                x = mean[:, None] + root @ rng.normal(size=size)
                law, random = self._kept(x, root, system, structure)
                result.append(Draws(node=node, structure=structure, law=law, random=random))
        return result

    def _kept(
        self, x: Array, root: Array, system: System, structure: Structure
    ) -> tuple[Array, Array]:
        """Return law (d, k) and random (m, k) coefficients, of `SPARE` draws for each kept.

        Draws are rows of `_moments`, kept in the order of how many are physics.
        """
        certain, m = self.known_of(structure), len(system.deviations)
        is_free = np.array([item not in certain for item in structure], dtype=bool)
        free = tuple(item for item in structure if item not in certain)
        positive, of_random = self._is_positive(free), np.array(system.positive, dtype=np.intp)
        bounded = np.concatenate([of_random, m + np.flatnonzero(positive)])
        sizes = system.sizes[[self.columns.index(item) for item in free]]
        of_law = np.all(x[bounded[len(of_random) :]] > 0.0, axis=0)
        of_law &= np.all((self.model.not_below_zero(free) * sizes) @ x[m:] >= 0.0, axis=0)
        others = np.all(x[of_random] > 0.0, axis=0)
        x = x[:, np.lexsort((~others, ~of_law))[: x.shape[1] // SPARE]]
        held_to_zero(x, root, bounded)
        law = np.empty((len(structure), x.shape[1]))
        law[is_free] = np.maximum(x[m:], np.where(positive, 0.0, -np.inf)[:, None]) * sizes[:, None]
        law[~is_free] = np.reshape(list(certain.values()), (-1, 1))
        return law, x[:m]

    def _is_positive(self, structure: Structure) -> NDArray[np.bool_]:
        return np.array([name not in self.model.signed for name, _ in structure], dtype=bool)

    def _moments(self, system: System, inverse: Array, structure: Structure) -> tuple[Array, Array]:
        """Return mean (m + d,) and a root of the covariance (m + d, m + d) of coefficients.

        Rows are those of the m random columns, whose `inverse_root` is given, then those of the d
        columns of the law whose coefficients are free.
        """
        known, m = self.known_of(structure), len(system.deviations)
        free = [m + self.columns.index(item) for item in structure if item not in known]
        d, q, gram = len(free), system.deviations, system.gram
        across = COEFFICIENT * inverse @ (q[:, None] * gram[:m, free])
        precision = COEFFICIENT**2 * gram[np.ix_(free, free)] - across.T @ across + np.eye(d)
        last = np.linalg.inv(np.linalg.cholesky(precision)) if d else precision
        root = np.zeros((m + d, m + d))
        root[:m, :m], root[:m, m:] = inverse.T, -inverse.T @ across @ last.T
        root[m:, m:] = last.T
        root *= np.r_[q, np.full(d, COEFFICIENT)][:, None]
        at = np.r_[np.arange(m), free].astype(int)
        moment = gram[at, -1]
        for column, x in known.items():
            place = self.columns.index(column)
            moment = moment - gram[at, m + place] * (x / system.sizes[place])
        mean, links = root @ (root.T @ moment), [*system.links]
        # rows tell 1 / UNSHOWN^2 as much of links; all other coefficients follow them
        _, size, axes = np.linalg.svd(root[links] / q[links, None], full_matrices=False)
        more = 1.0 / np.sqrt(size**2 + (1.0 - size**2) / UNSHOWN**2)
        return mean, root + (root @ axes.T) * (more - 1.0) @ axes

    def effective(self, node: Node, structure: Structure) -> float:
        """Return the number of coefficients that the measurement tells at a node."""
        system = self.model.system(node, self.columns)
        _, root = self._moments(system, inverse_root(system), structure)
        unit = np.full(len(root), COEFFICIENT)
        unit[: len(system.deviations)] = system.deviations
        return float(len(unit) - np.sum((root / unit[:, None]) ** 2))

    def estimate(self, node: Node, structure: Structure) -> tuple[Array, Array]:
        """Return the mean coefficients of a law (d,) and of the random columns (m,) at a node.

        Random coefficients that cannot be negative are held to 0.
        """
        system, known = self.model.system(node, self.columns), self.known_of(structure)
        free = tuple(item for item in structure if item not in known)
        mean, root = self._moments(system, inverse_root(system), structure)
        held_to_zero(mean[:, None], root, np.array(system.positive, dtype=np.intp))
        m = len(system.deviations)
        law = dict(known)
        for entry, x in zip(free, mean[m:].tolist(), strict=True):
            law[entry] = x * system.sizes[self.columns.index(entry)]
        return np.array([law[item] for item in structure]), mean[:m]


def inverse_root(system: System) -> Array:
    """Return the inverse of a root of the precision of random coefficients (m, m), scaled to 1."""
    m, q = len(system.deviations), system.deviations
    k = q[:, None] * system.gram[:m, :m] * q
    k[np.diag_indices(m)] += 1.0
    inverse, _ = lapack.dtrtri(np.linalg.cholesky(k), lower=1)
    return np.asarray(inverse)


def allotted(weights: Array, count: int) -> Places:
    """Return how many of `count` draws each weight (n,) gets, without chance.

    By systematic sampling: a weight that differs by rounding moves one draw, and no other.
    """
    ends = np.floor(np.cumsum(weights) / weights.sum() * count + 0.5 - 1e-9)
    return np.asarray(np.diff(ends, prepend=0.0), dtype=np.intp)


def eliminated(system: System) -> tuple[float, Array]:
    """Return an evidence of a node, and products of what random columns leave (k + p + 1, ...).

    The k random columns whose coefficients cannot be negative are left before those of the laws,
    scaled by their prior deviation over `COEFFICIENT`. The evidence is that without a law and
    without these columns.

    Examples
    --------
    >>> one = System(
    ...     gram=np.diag([3.0, 2.0, 5.0]), deviations=np.ones(1), volume=0.0, sizes=np.ones(1)
    ... )
    >>> base, left = eliminated(one)
    >>> round(base, 3), left.tolist()
    (-3.193, [[2.0, 0.0], [0.0, 5.0]])
    """
    kept = list(system.positive)
    order = [k for k in range(len(system.deviations)) if k not in kept]
    m, q, gram = len(order), system.deviations[order], system.gram
    if kept:
        order += [*kept, *range(len(system.deviations), len(gram))]
        units = np.ones(len(order))
        units[m : m + len(kept)] = system.deviations[kept] / COEFFICIENT
        gram = units[:, None] * gram[np.ix_(order, order)] * units
    k = q[:, None] * gram[:m, :m] * q
    k[np.diag_indices(m)] += 1.0
    factor = np.linalg.cholesky(k)
    h = q[:, None] * gram[:m, m:]
    h = lapack.dtrtrs(factor, h, lower=1)[0] if m else h
    left = gram[m:, m:] - h.T @ h
    base = system.volume - float(np.sum(np.log(np.diag(factor)))) - 0.5 * float(left[-1, -1])
    return base, left


def without(left: Array, known: Mapping[int, float]) -> Array:
    """Return products of columns and values (p + 1, p + 1) with known coefficients taken off."""
    result = left.copy()
    for column, scaled in known.items():
        result[-1] -= scaled * result[column]
        result[:, -1] -= scaled * result[:, column]
    return result


def inverted(matrices: Array) -> tuple[Array, Array]:
    """Return the inverses of small positive matrices (s, d, d), and logarithms of determinants.

    By sweeps over all matrices at once, which takes a tenth of the time of a loop over them.
    """
    result = matrices.copy()
    logarithms = np.zeros(len(result))
    for k in range(result.shape[1]):
        pivot = result[:, k, k].copy()
        logarithms += np.log(np.maximum(pivot, TINY))
        row = result[:, k, :] / pivot[:, None]
        result[:, k, :] = row
        column = result[:, :, k].copy()
        column[:, k] = 0.0
        result -= column[:, :, None] * row[:, None, :]
        result[:, :, k] = -column / pivot[:, None]
        result[:, k, k] = 1.0 / pivot
    return result, logarithms
