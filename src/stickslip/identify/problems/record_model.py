r"""Records of one coordinate as a model of the posterior.

At the rows :math:`i` of the filtered balance,

.. math::
    y_i = J a_i + \sum_p p\,k_{pi} + \sum_t c_t L[x_t(v)]_i + L[\delta(\log |v|)]_i
          + \delta_d(\log |v|)_i + b_0 + b_1 |v_i| + \ldots + e_i ,

with the inertia and what else is looked for, a law and the curve that lag with the bristle
(`record_columns`), and what every record may have: `SIZES` and `SCALES` are the priors.

1. *Screen*: the bristles whose curve with the inertia leaves least.
2. *Rounds* at the middle cutoff: search; the size of what is left by speed, distance from a turn,
   state of the bristle and piece, with weights of a Student distribution; the share of rows that
   count, which is that of scores by row over scores summed in stretches; and the length of LuGre
   bristles, which follows the level of the round before.
3. Other cutoffs take these, with the size of what is left of their own rows.
"""

import copy
import math
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import chain, product
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, cholesky

from stickslip.identify.own_laws import certain_of, signed_of
from stickslip.identify.posterior import (
    AT_BOUND,
    COEFFICIENT,
    Array,
    Column,
    Family,
    Model,
    Node,
    Places,
    Posterior,
    Scale,
    Structure,
    System,
)
from stickslip.identify.problems.record_columns import (
    FORCE,
    LEVELS,
    LUGRE,
    RESOLVED,
    RIGID,
    Balance,
    Memory,
    RecordFrame,
    law_column,
)
from stickslip.identify.problems.record_rows import (
    CUTOFFS,
    MIDDLE,
    SHORT,
    Acting,
    BalanceRows,
)
from stickslip.identify.problems.record_signals import Record
from stickslip.identify.vocabulary import DRY, FAMILIES, NARROW, SIGNED, Grid, levels_at

Names: TypeAlias = NDArray[np.str_]
Mask: TypeAlias = NDArray[np.bool_]
Solver: TypeAlias = Callable[[Array], tuple[Array, Array]]

FINE = 1.6
"""Shapes of a term for each e-fold of speed."""

NO_CURVE, CURVE = 0.4, 0.1
"""Prior probability that laws say all, and the half-normal size of what they do not, else."""
COMMON = (0.0, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32)
BY_PLACE = (0.002, 0.01, 0.04, 0.15, 0.5)
SCALES: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "common": (
        COMMON,
        (
            NO_CURVE,
            *((1.0 - NO_CURVE) / 7.0 * math.exp(-0.5 * (x / CURVE) ** 2) for x in COMMON[1:]),
        ),
    ),
    "sides": ((0.001, 0.01, 0.03, 0.1, 0.3), (0.5, 0.2, 0.15, 0.1, 0.05)),
    "length": ((0.5, 1.0, 2.0), (1 / 3, 1 / 3, 1 / 3)),
    "drift": (BY_PLACE, (0.65, 0.2, 0.1, 0.045, 0.005)),
    "place": (BY_PLACE, (0.5, 0.2, 0.2, 0.09, 0.01)),
    "force": (BY_PLACE, (0.5, 0.2, 0.2, 0.09, 0.01)),
    "stretch": (
        (0.0005, 0.003, 0.01, 0.03, 0.08, 0.2, 0.5),
        (0.2, 0.25, 0.25, 0.15, 0.1, 0.04, 0.01),
    ),
    "turn": ((0.001, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0), (1 / 7,) * 7),
    "others": ((0.002, 0.03, 0.15, 0.5), (0.5, 0.2, 0.2, 0.1)),
    "delay": ((0.5, 5.0), (0.8, 0.2)),
    "load": ((0.02, 0.1, 0.4), (0.4, 0.4, 0.2)),
    "input": ((0.01, 0.1, 0.6), (0.4, 0.3, 0.3)),
    "push": ((0.003, 0.05, 0.3), (0.7, 0.2, 0.1)),
    "run": ((0.005, 0.02, 0.08), (0.4, 0.5, 0.1)),
    "run of a joint": ((0.005, 0.02, 0.08), (0.2, 0.4, 0.4)),
    "noise": ((0.71, 1.0, 1.41, 2.0, 2.83, 4.0), (1 / 6,) * 6),
    "given": ((0.01, 0.1, 1.0, 10.0), (0.8, 0.15, 0.04, 0.01)),
}
"""Sizes over that of the friction, with their prior probabilities: of the curve that no law says,
common to both directions and of each; of its length in e-folds of speed; of drift, level by place
and force by place; of the level and viscous friction of a twentieth of the record; of the pulse of
a turn; of bristles of other lengths; the delay in samples; the change with an e-fold of the load
that is not in proportion, and with an input by its standard deviation; level and viscous friction
of another run, and of one of a joint, in which is what its rigid body misses (first parts of
records of two arms: .02 to .2 from run to run); noise over what the last round left, which a fit
that follows the noise makes too small; errors of the inertia and of the forces that are given, over
these, of which the last are wrong units. They say what a careful experimenter would expect."""
USUAL: dict[str, int] = {
    "common": 3, "sides": 1, "length": 1, "drift": 2, "place": 2, "force": 2, "stretch": 3,
    "turn": 3, "others": 1, "delay": 0, "load": 1, "input": 1, "push": 0, "run": 1, "noise": 1,
    "given": 1,
}  # fmt: skip
"""Where a search begins."""
SIZES: dict[str, float] = {
    "offset": 0.3,
    "side": 0.003,
    "slow": 0.3,
}
"""Sizes that are no scales: a constant force, the least of the slope by direction, and what levels
change by at speeds below those resolved, which tells no shape of a law."""
STEEP = 3.0
"""Size of the slope by direction over that of the curve by direction, of which it is the line."""
TIMED = 0.1
"""Size of a delay where it is known how forces run between samples, over that where it is not."""
LOOKED_FOR = 3.0
"""Size of what is looked for, over that of the force."""
SETTLED = 0.3
"""The same where forces are not linear in it, and over the value at which a plain balance leaves
least: far from there, forces by place would stand for all others."""
STRETCHES = 20
"""Parts of a record whose level and slope may differ."""

SPEEDS = 8
"""Classes of speed."""
NEAR = (0.6, 1.2, 2.4)
"""Classes of the distance from a turn, over 1/cutoff."""
LACKING = (0.005, 0.02, 0.1)
"""Classes of what a bristle lacks of being stretched."""
PART = 0.9
"""State of a bristle that counts as not stretched."""
TAIL, FAR_OUT = 4.0, 2.5
"""Degrees of freedom of what is left, and from where on its tail counts."""
KAPPA = 0.3
"""Largest share of rows that count: they are 2.2 for each 1/cutoff."""
BLOCKS = (200, 100, 50, 25)
"""Numbers of parts in which scores are summed."""
LENGTHS = 9
"""Lengths of bristles that are looked at first, from twice the noise to a quarter of the range."""
BRISTLE = 1.0 / (2.0 * LENGTHS)
"""Prior odds of the bristle that leaves least of those that are looked at, against none: as likely
as none are all, of which the others count for nothing."""
ABOUT = (0.5, 0.71, 1.41, 2.0)
"""Further lengths about the two best, over them."""
EXPONENTS = (0.5, 2.0)
"""Further exponents about them."""
NEARER = (0.84, 1.19)
"""Lengths about the best, if that has another exponent than Dahl's usual one."""
KEPT = 2
"""Bristles beside which delays are looked for."""
SEEN = 0.03
"""Root mean square of what a bristle lacks of being stretched, from which its length follows."""
FOLLOWING = (0.8, 1.0, 1.3, 1.7)
AGAIN = (0.85, 1.0, 1.18)
"""Lengths that are looked at where the length follows the level, over the one before."""
WIDTHS = (0.005, 0.2)
"""Range of the relative deviation of such a length."""
ASIDE, WITHIN = 1.3, 0.6
"""Deviations by which further lengths are beside it, and what each stands for: of the three nodes
and within them the deviation is 1.05."""
BELOW = 0.06
"""Level by which friction may differ for each e-fold of speed that was not resolved: half of what
shows a bristle is slower than the speed of its length."""
ROUNDS, FOLLOWED, ROUND_NODES = 2, 3, 80
"""Rounds, those with a length that follows the level, and nodes of each."""
NODES, DRAWN = 100, 150
"""Nodes of the posterior that are visited, and that are drawn."""
THIRDS = 5
"""Times that shapes are refined by thirds of a step ..."""
RESOLVING, LEAST_SHARE = 4.0, 0.02
"""... where fewer shapes than that count, in families with that share at least."""
GEARED = (
    "gear level", "gear level viscous", "gear level stribeck", "gear level stribeck viscous",
)  # fmt: skip
"""Families of servo motors, whose level grows with what the gear transmits (duclusaud2025)."""
KEPT_LAWS, BEHIND, LOST = 24, 12.0, 60.0
"""Laws whose shapes are refined; the logarithm of the weight from which laws and bristles are not
kept beside the best, and that of whole families after the first round, half of it later ..."""
ALWAYS: tuple[Family, ...] = ((), ("level", "stribeck", "viscous"))
"""... but for these: the length of bristles follows the level of such a law."""
TINY = 1e-300
ROUNDING = 1e-8
"""Share of the covariance of the curve that keeps its root positive."""
EXACT = 1e-5
"""Noise of rows at least, over the root mean square of the response: filters round, and integrators
of simulated records (with a tenth, steps of .1 ms made a spring 12 likelier, by its logarithm); and
the weight of rows whose force a sensor that clips hides."""
RIDGE = 1e-12
"""Share of its own square that each column has as noise of its own: as much as rounding may make
of columns that are nearly alike, so that factors exist where nothing else is noise."""
SOFT = 1e-7
"""Share of the products of columns that keeps a first fit solvable."""
LEAST = 1e-6
"""Least size over that of the friction."""
DELAYS = np.linspace(-3.0, 3.0, 61)
"""Delays of forces that are looked at, over 1/cutoff."""
ORDERS = (0, 1, 2)
"""Orders of the low pass that makes them late; 0 of none ..."""
ABOUT_IT = np.linspace(0.6, 1.6, 6)
"""... and its delays, over that of none."""
NARROWER = 0.98
"""What is left with the widest band of velocities over that with the usual one, up to which it is
taken: noise moves turns as well."""
FARTHEST = 30.0
"""Medians as which what is left at turns counts at most, where that is what is compared."""
FINER = 5
"""Times that what is looked at is refined by thirds of a step."""
HALVED = 2.0
"""What is left with a linear delay over that with another, from which that is looked at: what a
motion with other joints leaves is no noise, and less than that is gained there by 17 ms."""
OTHERWISE = 0.05
"""Prior probability that a channel is late by more than is linear, and that a sensor of the force
clips: of careful experimenters one in twenty has not seen it."""
FEW, FEWEST = 20, 5
"""Rows that a quantile or a median needs."""
STEPS, DENSEST, PARTS = 0.5, 400.0, 1500
"""Step and largest of the wave numbers that are looked at, over those of the range; their rows."""
BESIDE_LEVELS = ("power", "saturating", "tanh")
"""Flows that fall off, and so may stand for a level, and a level as smooth as with bristles."""
FLOWING = frozenset({"viscous", "power", "saturating"})
"""Flows that are near to viscous friction, not distinguished from a damping that is looked for."""
ALONG = ("drift", "place", "force", "stretch", "run")
"""Scales of what changes along a record."""
BESIDE = ("drift", "place", "force", "others")
"""Scales of what may stand for another: each is compared with the best without it."""
PUSHED = {"push": 2, "input": 2}
"""Where an input moves a constant force and friction by much."""
WRONG = {"given": 3}
"""Where what is given has another unit."""
CURVES = ("common", "sides")
"""Groups that are curves of the speed."""
LOOKED = ("given", "inertia", "offset")


@dataclass(frozen=True, kw_only=True, eq=False)
class Design:
    """Columns at the rows of a cutoff with a bristle."""

    groups: Names
    """Group of each column that is always there (m,)."""
    random: Array
    """These columns (n, m)."""
    law: Array
    """Columns of laws, scaled to the size of the friction (n, p)."""
    sizes: Array
    """Their factors (p,)."""
    least: Array
    """Root mean squares of the columns that are always there (m,)."""

    @cached_property
    def places(self) -> dict[str, slice]:
        """Columns of each group, which stand together."""
        names = self.groups.tolist()
        count = Counter(names)
        return {name: slice(names.index(name), names.index(name) + count[name]) for name in count}


@dataclass(frozen=True, kw_only=True, eq=False)
class Noise:
    """What a fit leaves, by class of rows."""

    edges: Array
    """Speeds between classes."""
    deviations: Array
    """Standard deviation of each class [N]."""
    pieces: Array
    """Factors of the pieces."""
    bristle: Memory | None
    """Bristle whose rows are classes while it is not stretched, as one that lags along its length:
    another may lack more than its exponent says."""


class RecordModel(Model):
    """Records of one coordinate.

    Parameters
    ----------
    records : sequence of Record
        What was measured.
    families : collection of Family, optional
        Families of laws that are compared beside none; those of the vocabulary if not given.
    highest : float
        Largest cutoff [Hz].
    timed : bool
        Whether it is known how forces run between samples.
    """

    signed = SIGNED

    def __init__(
        self,
        records: Sequence[Record],
        *,
        families: Collection[Family] | None = None,
        highest: float = math.inf,
        timed: bool = False,
    ) -> None:
        self.balance, self.timed = Balance(records, highest=highest), timed
        self.frame = self.balance.frame
        known = usual_families(self.frame) if families is None else [*families]
        if self.balance.dampings:  # which viscous friction would be
            known = [item for item in known if not FLOWING & {*item}] or known
        self.families: list[Family] = [*dict.fromkeys(known)]
        """Families of laws that are compared beside none."""
        self.names: tuple[str, ...] = ()
        """Scales of sizes that act in these records."""
        laws = dict(laws_of(self.grid, [*dict.fromkeys([(), *known])]))
        self.structures, self.priors = tuple(laws), np.array([*laws.values()])
        self.columns = tuple(dict.fromkeys(item for law in self.structures for item in law))
        self.memories: list[Memory] = []
        self.actings: list[Acting] = [self.balance.acting]
        """How forces may act: as recorded, or late, or beyond what their sensor shows."""
        self.otherwise: list[Node] = []
        """Nodes at which each of these does best."""
        self.alone: int | None = None
        """Number of that which is searched alone, if one is."""
        self.spread: dict[tuple[int, int], float] = {}
        """Logarithm of the prior of weights that the tail of the noise takes from rows."""
        self.cutoffs: tuple[int, ...] = (MIDDLE,)
        self.noises: dict[int, Noise] = {}
        """What is left of the rows of each cutoff."""
        self.weights: dict[tuple[int, int], Array] = {}
        """Weights of the rows of each cutoff as forces may act (n,): what is left has size 1."""
        self.kappas: dict[int, float] = {}
        """Share of the rows of each cutoff that count."""
        self._designs: dict[tuple[int, int], Design] = {}
        self._plain: dict[tuple[int, int, int], Array] = {}
        self._grams: dict[tuple[int, int, int, int], Array] = {}
        self._fixed: dict[int, dict[str, Array]] = {}
        self._roots: dict[int, Array] = {}
        self._heavy: bool | None = None
        self._choose_band()
        node = self._rounds()
        self.start = self._widen(node)
        """Nodes from which the posterior begins: one of each cutoff."""

    def with_laws(self, own: Sequence[Structure]) -> "RecordModel":
        """Return the model with laws that are no sums of parts beside those compared."""
        result = copy.copy(self)
        result.signed, result.certain = SIGNED | signed_of(own), certain_of(own)
        result.structures = (*self.structures, *own)
        result.priors = np.append(self.priors, np.full(len(own), np.max(self.priors)))
        result.columns = tuple(dict.fromkeys(item for law in result.structures for item in law))
        result._designs, result._plain, result._grams = {}, {}, {}
        return result

    def posterior(self) -> Posterior:
        """Return the posterior of the records."""
        return Posterior(
            self, self.structures, self.priors,
            begin=self.start, most=NODES, drawn=DRAWN, doubted=BESIDE,
        )  # fmt: skip

    # ---- what is compared
    @property
    def grid(self) -> Grid:
        """Shapes of the parts of laws."""
        return Grid(slowest=self.frame.shaped, fastest=self.frame.top, fine=FINE)

    @property
    def scales(self) -> Sequence[Scale]:  # type: ignore[override]
        """The scales: sizes, then how forces act, the bristle and the cutoff."""
        priors = {name: SCALES[name][1] for name in self.names}
        sizes = [Scale(name=name, values=SCALES[name][0], prior=p) for name, p in priors.items()]
        lengths = tuple(item.length for item in self.memories)
        bands = tuple(CUTOFFS[k] * self.balance.pieces[0].cutoff for k in self.cutoffs)
        acts = [odds_of(x) * (self.alone in (None, k)) for k, x in enumerate(self.actings)]
        bristles = tuple(BRISTLE if x else 1.0 for x in lengths)
        even = tuple(1.0 / len(bands) for _ in bands)
        numbers = tuple(float(k) for k in range(len(acts)))
        return [
            *sizes,
            Scale(name="acting", values=numbers, prior=tuple(acts), ordered=False),
            Scale(name="bristle", values=lengths, prior=bristles, ordered=False),
            Scale(name="cutoff", values=bands, prior=even, ordered=False, judged=False),
        ]

    def _acts(self, name: str) -> bool:
        """Return whether a scale changes anything in these records."""
        balance = self.balance
        acts = {
            "sides": len(self.frame.sides) > 1,
            "turn": balance.turned,
            "load": self.frame.load != 1.0,
            "input": bool(self.frame.inputs),
            "push": bool(self.frame.inputs) and len(self.frame.sides) > 1,
            "run": balance.runs > 1,
            "run of a joint": False,
            "given": bool(balance.given),
        }
        return acts.get(name, True)

    def at(self, node: Node, name: str) -> float:
        """Return the value of a size at a node."""
        return SCALES[name][0][node[self.names.index(name)]]

    def memory(self, node: Node) -> Memory:
        """Return the bristle of a node."""
        return self.memories[node[-2]]

    def acting(self, node: Node) -> Acting:
        """Return how forces act at a node."""
        return self.actings[node[-3]]

    def response(self, node: Node) -> Array:
        """Return the response of the rows of a node (n,) [N]."""
        return self.balance.response(self.key(node)[0], self.acting(node))

    def not_below_zero(self, structure: Structure) -> Array:
        return levels_at(structure, self.frame.top)

    # ---- normal equations
    def system(self, node: Node, columns: Sequence[Column]) -> System:
        """Return the normal equations of a node."""
        assert tuple(columns) == self.columns
        which, memory = self.key(node)
        noise = self.at(node, "noise")
        gram = self._gram(which, memory, node[-3], node[self.names.index("length")])
        design, unknown = self.design(which, memory), self.balance.pieces[0].record.unknown
        gram = self.kappas[which] / noise**2 * gram
        inertia: tuple[int, ...] = ()
        if self.balance.finds_inertia:
            inertia = (design.places["inertia"].start,)
            if self._heavy is None:
                self._heavy = is_possible(inertia[0], gram, self.deviations(node))
        return System(
            gram=gram,
            deviations=self.deviations(node),
            volume=self.kappas[which] * self._volume(node),
            sizes=design.sizes,
            positive=inertia * bool(self._heavy),
            links=tuple(design.places[name].start for name, x in unknown.items() if x.link),
        )

    def _volume(self, node: Node) -> float:
        """Return the sum over the rows of the logarithm of the density of what is left none of.

        Of forces that a sensor hides nothing but the excess over what it shows counts, which
        spreads by as much as it is in the mean, at least by the noise.
        """
        acting, which = self.acting(node), self.key(node)[0]
        noise = self.at(node, "noise") / self.weights[which, node[-3]]
        if acting.clipped:
            share = self.hidden(which, node[-3])
            noise = noise * EXACT**share
            noise = noise * np.maximum(self.balance.excess / noise, 1.0) ** share
        return self.spread[which, node[-3]] - float(np.sum(np.log(noise)))

    def hidden(self, which: int, acting: int) -> Array:
        """Return the share of the force that a sensor hides at the rows, as forces act (n,)."""
        return self.balance.rows(which).hidden * self.actings[acting].clipped

    def design(self, which: int, memory: int) -> Design:
        """Return the columns at the rows of a cutoff with a bristle."""
        key = which, memory
        if key not in self._designs:
            self._designs[key] = self._designed(which, self.memories[memory])
        return self._designs[key]

    def _designed(self, which: int, memory: Memory) -> Design:
        rows = self.balance.rows(which)
        groups, x = self.balance.columns(which, memory, self.columns)
        if which not in self._fixed:
            turns = self.balance.pulses(which)
            self._fixed[which] = {**self.balance.fixed(which), "turn": turns}
        every = {**groups, **self._fixed[which]}
        state, slope = every.pop("state"), every.pop("slope")
        stretch = stretches(rows.count)[:, None] == np.arange(STRETCHES)
        every["stretch"] = np.hstack([state * stretch, slope * stretch])
        if self.balance.runs > 1:
            of = self.balance.run[rows.piece][:, None] == np.arange(self.balance.runs)
            every["run"] = np.hstack([state * of, slope * of])
        sizes = self._usual(which, x)
        random = np.hstack([*every.values()])
        names = [name for name, part in every.items() for _ in range(part.shape[1])]
        return Design(
            groups=np.array(names),
            random=random,
            law=x * sizes,
            sizes=sizes,
            least=np.sqrt(np.mean(random * random, axis=0)) + 1e-300,
        )

    def _usual(self, which: int, x: Array) -> Array:
        """Return the coefficients of laws with columns (n, p) that make friction of its usual size.

        Of a dry part that is its friction in steady sliding, at rest or over the rows: a level far
        above all that was measured, at speeds or states that the record never reached, is unusual.
        """
        least, rows = np.sqrt(np.mean(x * x, axis=0)), self.balance.rows(which)
        places = np.append(rows.velocity, 0.0)
        for k, column in enumerate(self.columns):
            if column[0] in DRY:
                *steady, rest = law_column(column, places, np.ones(len(places))).tolist()
                least[k] = max(least[k], math.sqrt(np.mean(np.square(steady))), rest)
        return np.asarray(self.size / (least + TINY))

    def _gram(self, which: int, memory: int, acting: int, length: int) -> Array:
        """Return the products of all columns, with those of the curve of a length."""
        key = which, memory, acting, length
        if key not in self._grams:
            design = self.design(which, memory)
            gram = self._product(which, memory, acting).copy()
            root = self.root(length)
            for name in CURVES:
                at = np.flatnonzero(design.groups == name)
                if len(at):
                    gram[:, at] = gram[:, at] @ root
                    gram[at] = root.T @ gram[at]
            gram[np.diag_indices(len(gram) - 1)] *= 1.0 + RIDGE
            self._grams[key] = gram
        return self._grams[key]

    def _product(self, which: int, memory: int, acting: int) -> Array:
        """Return the products of all columns as they are."""
        key = which, memory, acting
        if key not in self._plain:
            design = self.design(which, memory)
            y = self.balance.response(which, self.actings[acting])
            every = np.hstack([design.random, design.law, y[:, None]])
            every *= self.weights[which, acting][:, None]
            self._plain[key] = every.T @ every
        return self._plain[key]

    def root(self, length: int) -> Array:
        """Return a root of the covariance of the curve at its knots (k, k): Matern 3/2."""
        if length not in self._roots:
            x = self.frame.knots
            d = math.sqrt(3.0) * np.abs(x[:, None] - x) / SCALES["length"][0][length]
            covariance = (1.0 + d) * np.exp(-d) + ROUNDING * np.eye(len(x))
            self._roots[length] = np.asarray(cholesky(covariance, lower=True))
        return self._roots[length]

    def deviations(self, node: Node) -> Array:
        """Return the prior standard deviations of what is always there (m,)."""
        which, memory = self.key(node)
        design, size = self.design(which, memory), self.size
        record, bristle = self.balance.pieces[0], self.memories[memory]
        result = np.empty(len(design.groups))
        of_force = float(np.sqrt(np.mean(self.balance.rows(which).response ** 2)))
        for name in dict.fromkeys(design.groups.tolist()):
            at = design.groups == name
            if name in record.record.unknown or name == "inertia":
                unknown = record.record.unknown.get(name)
                usual = of_force / design.least[at]
                result[at] = (unknown.doubt if unknown else 0.0) or LOOKED_FOR * usual
                if unknown is not None and unknown.along:
                    result[at] = 1.0
                elif unknown is not None and unknown.bent:
                    positive = unknown.given > 0.0 and unknown.given + unknown.limits[0] >= 0.0
                    far = unknown.given if positive else np.maximum(abs(unknown.given), usual)
                    result[at] = SETTLED * far
            elif name == "given":
                result[at] = self.at(node, name)
            elif name == "delay":
                result[at] = self.at(node, name) * record.sample * (TIMED if self.timed else 1.0)
            elif name == "damping":
                longest = max(bristle.length, self.frame.noise)
                result[at] = math.sqrt(self.size * max(self.inertia, 0.0) * longest) + LEAST * size
            elif name == "side":
                result[at] = max(STEEP * self.at(node, "sides"), SIZES["side"]) * size
            elif name in SIZES:
                result[at] = SIZES[name] * size
            else:
                part, times, _ = name.partition("*")
                with_input = "push" if part == FORCE else "input"
                # a force beside friction changes with the place and in time
                scale = with_input if times else "force" if name == "zero" else name
                result[at] = max(self.at(node, scale), LEAST) * size
        return result

    # ---- which bristles
    def _choose_band(self) -> None:
        """Let velocities have the widest band if a balance without bristles then leaves less."""
        narrow, left = self.balance.pieces, self._left_plainly()
        if self.balance.widen() and self._left_plainly() > NARROWER * left:
            self.balance.take(narrow)

    def _left_plainly(self) -> float:
        """Return the mean square that a balance with a curve of the velocity leaves."""
        balance, rows = self.balance, self.balance.rows(MIDDLE)
        plain = balance.fixed(MIDDLE)
        curve = []
        for piece, state in zip(balance.pieces, balance.states(RIGID), strict=True):
            z = (state * balance.load(piece))[:, None]
            curve.append(np.hstack([z, z * self.frame.hats(piece.velocity)[:, ::2]]))
        beside = [x for name, x in plain.items() if name not in ("force", "zero")]
        left = solved_softly(np.hstack([rows.seen(curve), *beside]), rows.response)[1]
        return capped(left, FARTHEST)

    def _screen(self) -> Array:
        """Keep the bristles whose curve leaves least; return what the best leaves (n,)."""
        rows, frame, balance = self.balance.rows(MIDDLE), self.frame, self.balance
        self.names = tuple(name for name in SCALES if self._acts(name))
        plain = balance.fixed(MIDDLE)
        names = [name for name in plain if name in (*LOOKED, "side") or "." in name]
        drag = [p.velocity * np.abs(p.velocity) / frame.top**2 for p in balance.pieces]
        base = [plain["slope"], rows.seen(drag)[:, None]]
        base += [rows.position[:, None]] * balance.is_no_line
        base += [plain[name] for name in names]  # the inertia is the last
        fixed = np.hstack([np.ones((rows.count, len(frame.sides) - 1)), *base])
        hats = [frame.hats(piece.velocity)[:, ::2] for piece in balance.pieces]
        looked: list[tuple[float, Memory, Array, float, float]] = []

        def columns(memory: Memory) -> Array:
            parts = []
            for piece, state, hat in zip(balance.pieces, balance.states(memory), hats, strict=True):
                z = state * balance.load(piece)
                own = [z[:, None], z[:, None] * hat]
                own += [(z * balance.input(piece, name))[:, None] for name in frame.inputs]
                if frame.transmitted:
                    own.append((z * balance.transmitted(piece))[:, None])
                parts.append(np.hstack(own))
            return np.hstack([fixed, rows.seen(parts)])

        def rank(memories: Sequence[Memory], *, damped: bool = False) -> None:
            for memory in memories:
                x = np.hstack([columns(memory), balance.delayed(MIDDLE, memory)[:, None]])
                if damped and memory.lags and memory.length:
                    both = zip(balance.pieces, balance.states(memory), strict=True)
                    damping = [np.gradient(z * balance.load(p), p.step) for p, z in both]
                    x = np.insert(x, -1, rows.seen(damping), axis=1)
                c, e = solved_softly(x, rows.response)
                law = np.arange(x.shape[1]) >= fixed.shape[1]
                law[len(frame.sides) - 1 : len(frame.sides) + 1] = True  # viscous and drag
                law[-1] = False  # the delay
                inertia = abs(c[fixed.shape[1] - 1])
                size = float(np.sqrt(np.mean((x[:, law] @ c[law]) ** 2)))
                looked.append((capped(e), memory, e, size, float(inertia)))
            looked.sort(key=lambda item: item[0])

        beside = np.hstack([columns(RIGID), balance.delayed(MIDDLE, RIGID)[:, None]])
        pushed = force_wave(rows, frame.span, frame.noise, beside)
        # along less, a bristle is nothing but the moment of a turn between samples
        shortest = max(2.0 * frame.noise, *(piece.turned_in for piece in balance.pieces))
        lengths = np.geomspace(shortest, max(frame.span / 4.0, 2.0 * shortest), LENGTHS)
        rank([RIGID, *(Memory(length=x, exponent=n) for n in (0.0, 1.0) for x in lengths)])
        likely = [RIGID, *(item[1] for item in looked[:KEPT])]
        lagging = [balance.states(item[1]) for item in looked if item[1].length and item[1].lags]
        others = rows.seen([np.column_stack(own) for own in zip(*lagging, strict=True)])
        tried = [
            np.hstack([columns(x), others, balance.delayed(MIDDLE, x)[:, None]]) for x in likely
        ]
        self._look_otherwise(tried)
        # with the damping of those that lag, beside which a late force would not be seen
        plainly = [item for item in looked if not (item[1].lags and item[1].length)]
        every = [item[1] for item in looked if item[1].lags and item[1].length]
        looked[:] = plainly
        rank(every, damped=True)
        best = [item[1] for item in looked if item[1].length][:2]
        about = [
            replace(item, length=factor * item.length) for item, factor in product(best, ABOUT)
        ]
        about += [replace(item, exponent=n) for item, n in product([*best, *about], EXPONENTS)]
        rank([replace(x, length=max(x.length, shortest)) for x in about], damped=True)
        nearest = [looked[0][1]] * (not looked[0][1].lags)  # other lengths are refined later
        closer = [x.length * factor for x, factor in product(nearest, NEARER)]
        rank([replace(nearest[0], length=max(x, shortest)) for x in closer])
        bristles = [item[1] for item in looked if item[1].length]
        balance.first = bristles[0].length
        # both kinds, or the rounds refine only that which the coarse curve here prefers
        kinds = [[item for item in bristles if item.lags is lags][:1] for lags in (True, False)]
        self.memories = [RIGID, *chain(*kinds)]
        balance.forget(self.memories)
        _, _, left, self.size, inertia = looked[0]
        self.size = max(self.size, 1e-9 * float(np.sqrt(np.mean(rows.response**2))) + 1e-300)
        balance.waves = pushed, level_wave(rows, frame.span, frame.noise, left)
        self.inertia = inertia if balance.finds_inertia else balance.inertia
        self.first = next((k for k, item in enumerate(self.memories) if item is looked[0][1]), 0)
        return left

    def _look_otherwise(self, columns: Sequence[Array]) -> None:
        """Look for how forces may act otherwise: late, or beyond a sensor's range.

        A delay stands beside the columns of some bristles (n, p), of which the last is for the rest
        of a delay. The posterior compares one that a plain balance makes likelier than its prior,
        and a sensor that clips wherever one may.
        """
        now = self.balance.acting
        shown = self.balance.turned or not self.balance.measured  # only turns show late friction
        result = [self._delayed(columns)] if shown and not now.delay else []
        if self.balance.clips and not now.clipped:  # the posterior tells
            self.balance.reveal()
            result.append((replace(now, clipped=True), math.inf))
        for acting, gain in result:
            likelier = KAPPA * gain + math.log(odds_of(acting) / odds_of(now)) > 0.0
            if likelier and acting not in self.actings:
                self.actings.append(acting)

    def _delayed(self, columns: Sequence[Array]) -> tuple[Acting, float]:
        """Return the likeliest delay, and the logarithm of what it gains over what is linear.

        That is by rows that all count and have the same noise.
        """
        balance, count = self.balance, self.balance.rows(MIDDLE).count

        def likely(delay: float, solvers: Sequence[Solver], order: int = 0) -> float:
            y = balance.response(MIDDLE, replace(balance.acting, delay=delay, order=order))
            return -0.5 * count * math.log(min(capped(of(y)[1]) for of in solvers) + TINY)

        without = [soft_solver(x[:, :-1]) for x in columns]
        best, most = likeliest(lambda x: likely(x, without), DELAYS / balance.pieces[0].cutoff)
        linear = likely(0.0, [soft_solver(x) for x in columns])
        if most - linear <= 0.5 * count * math.log(HALVED):
            return replace(balance.acting, delay=best), 0.0
        every = [(most, best, 0)]
        for order in ORDERS[1:]:
            near = likeliest(partial(likely, solvers=without, order=order), ABOUT_IT * best)
            every.append((near[1], near[0], order))
        most, best, order = max(every)
        return replace(balance.acting, delay=best, order=order), most - linear

    # ---- rounds
    def _rounds(self) -> Node:
        """Search at the middle cutoff, and find noise and bristles anew; return the best node."""
        node = self._begun()
        for turn in range(FOLLOWED):
            if turn >= ROUNDS and self.memory(node).ratio is None:
                break
            if turn > 0:
                node = self._again(self._search(node))
            self._refine(self._here(node), 3.0 ** -(turn + 1))
            node = self._followed(self._here(node), node) or node
        for turn in range(ROUNDS, THIRDS):  # as finely as the records tell shapes
            here = self._here(node)
            if self._resolves(here):
                break
            self._refine(here, 3.0 ** -(turn + 1))
        node = self._pruned(node)
        self._act(node)
        return node

    def _begun(self) -> Node:
        """Screen and search, anew where forces act otherwise; return the best node."""
        tried = list[Acting]()
        while True:
            left = self._screen()
            tried.append(self.balance.acting)
            usual = tuple(USUAL[name] for name in self.names)
            begin: list[Node] = [(*usual, k, self.first, 0) for k in range(len(self.actings))]
            for node in begin:
                self._weigh(node, left, self._noise(MIDDLE, left, None))
            nodes = [self._again(self._search(item)) for item in begin]
            if len(begin) > 1:  # each with its own noise
                nodes = [self._again(self._search(item)) for item in nodes]
            here, self.otherwise = self._here(*nodes), nodes
            best = max(nodes, key=here.value)
            if self.acting(best) in tried:
                return best
            self._act(best)

    def _search(self, node: Node) -> Posterior:
        """Return the posterior at the middle cutoff as forces act at a node, from it and others."""
        begin, self.alone = [node, *self._starts(node[-3])], node[-3]
        result = Posterior(self, self.structures, self.priors, begin=begin, most=ROUND_NODES)
        self.alone = None
        return result

    def _act(self, node: Node) -> None:
        """Take forces to act as at a node in columns and other records."""
        if self.acting(node) != self.balance.acting:
            self.balance.acting = self.acting(node)
            self.balance.take(self.balance.pieces)
            self._designs, self._plain, self._grams, self._fixed = {}, {}, {}, {}

    def _starts(self, acting: int) -> list[Node]:
        """Return nodes from which a search begins, too, by bristle.

        At some nothing changes along a record, whose noise is large: a search that begins only
        where much changes may stay where that follows the noise. At others a unit is wrong, for
        little of that is not better than none.
        """
        most = {name: len(SCALES[name][0]) - 1 for name in self.names}
        result, still = list[Node](), {"noise": most["noise"], **dict.fromkeys(ALONG, 0)}
        for other in (still, WRONG, PUSHED):
            sizes = [min(other.get(name, USUAL[name]), most[name]) for name in self.names]
            result += [(*sizes, acting, k, 0) for k in range(len(self.memories))]
        return result

    def _here(self, *nodes: Node) -> Posterior:
        """Return the posterior of nodes alone."""
        return Posterior(self, self.structures, self.priors, begin=nodes, most=0)

    def _pruned(self, node: Node) -> Node:
        """Keep only bristles that are not far behind the best; return the node."""
        here = self._here(node)
        nodes = [(*node[:-2], k, 0) for k in range(len(self.memories))]
        values = np.array([here.value(item) for item in nodes])
        kept = np.flatnonzero(values > values.max() - BEHIND)
        best = int(np.argmax(values[kept]))
        self._keep([self.memories[k] for k in kept])
        return (*node[:-2], best, 0)

    def _resolves(self, search: Posterior) -> bool:
        """Return whether several shapes of each family with a share count."""
        shares: dict[Family, list[float]] = {}
        for law, share in zip(search.structures, search.shares.tolist(), strict=True):
            if any(name in NARROW or name == "power" for name, _ in law):
                shares.setdefault(tuple(name for name, _ in law), []).append(share)
        result = [np.array(x) for x in shares.values() if sum(x) > LEAST_SHARE]
        return all(x.sum() ** 2 > RESOLVING * np.sum(x**2) for x in result)

    def _refine(self, search: Posterior, part: float) -> None:
        """Take the shapes near the best of each family, and near all that are not far behind."""
        value = np.log(search.shares + TINY)
        order = np.argsort(-value, kind="stable")
        best: dict[Family, int] = {}
        for k in order.tolist():
            best.setdefault(tuple(name for name, _ in search.structures[k]), k)
        near = [k for k in order.tolist()[:KEPT_LAWS] if value[k] > value[order[0]] - BEHIND]
        result: dict[Structure, float] = {}
        far = value[order[0]] - (LOST if part > 0.2 else 0.5 * LOST)
        others = [k for family, k in best.items() if value[k] > far or family in ALWAYS]
        for k in dict.fromkeys([*near, *others]):
            law = search.structures[k]
            family = tuple(name for name, _ in law)
            many = [*self.grid.finer(family, [shape for _, shape in law], part)]
            for shapes in many:
                one = tuple(zip(family, shapes, strict=True))
                result.setdefault(one, float(self.priors[k]) - math.log(len(many)))
        self.structures, self.priors = tuple(result), np.array([*result.values()])
        self.columns = tuple(dict.fromkeys(item for law in self.structures for item in law))
        self._designs, self._plain, self._grams = {}, {}, {}

    def _again(self, search: Posterior) -> Node:
        """Weigh rows by what the best node of a search leaves; return that node."""
        node = search.best
        law = search.law_at(node)
        left, count = self._left(search, node, law)
        which = self.key(node)[0]
        shown = self.hidden(which, node[-3]) < 0.5
        noise = self._noise(which, np.where(shown, left, math.nan), self.memory(node))
        self._weigh(node, left, noise, law, count)
        return node

    def _left(self, search: Posterior, node: Node, law: Structure) -> tuple[Array, float]:
        """Return what a structure leaves of the rows (n,), and the number of its parameters."""
        design = self.design(*self.key(node))
        c, b = search.estimate(node, law)
        at = [self.columns.index(item) for item in law]
        left = self.response(node) - design.random @ self.plain(node, b[:, None])[:, 0]
        return left - design.law[:, at] @ (c / design.sizes[at]), search.effective(node, law)

    def plain(self, node: Node, random: Array) -> Array:
        """Return coefficients of the columns as they are (m, k), the curve's at its knots."""
        design = self.design(*self.key(node))
        result, root = random.copy(), self.root(node[self.names.index("length")])
        for at in (design.places[name] for name in CURVES if name in design.places):
            result[at] = root @ random[at]
        return result

    def split(self, node: Node, random: Array) -> dict[str, Array]:
        """Return coefficients of the columns as they are (p, k), by group."""
        plain, places = self.plain(node, random), self.design(*self.key(node)).places
        return {name: plain[at] for name, at in places.items()}

    def part(self, memory: Memory) -> Array:
        """Return what a bristle lacks of being stretched, at the middle rows (n,)."""
        state = self.balance.rows(MIDDLE).taken(self.balance.states(memory))
        return np.asarray(1.0 - np.minimum(np.abs(state), 1.0))

    def key(self, node: Node) -> tuple[int, int]:
        """Return the cutoff and the bristle of a node."""
        return self.cutoffs[node[-1]], node[-2]

    def classes(self, balance: Balance, which: int, noise: Noise) -> Places:
        """Return the class of what is left of each row (n,): by speed, or distance from a turn."""
        rows = balance.rows(which)
        speed = np.clip(np.searchsorted(noise.edges, np.abs(rows.velocity)) - 1, 0, SPEEDS - 1)
        near = SPEEDS + np.searchsorted(NEAR, np.minimum(rows.far, NEAR[-1]))
        result = np.where(rows.far > NEAR[-1], speed, near)
        if noise.bristle is not None:
            lacks = 1.0 - np.abs(rows.taken(balance.states(noise.bristle)))
            short = (result < SPEEDS) & (lacks > LACKING[0])
            result = np.where(
                short, SPEEDS + len(NEAR) + np.searchsorted(LACKING, lacks) - 1, result
            )
        return np.asarray(result, dtype=np.intp)

    def _noise(self, which: int, left: Array, bristle: Memory | None) -> Noise:
        """Return the sizes of what is left of the rows of a cutoff."""
        rows = self.balance.rows(which)
        speed, away = np.abs(rows.velocity), rows.far > NEAR[-1]
        edges = np.quantile(
            speed[away] if away.sum() > FEW else speed, np.linspace(0.0, 1.0, SPEEDS + 1)
        )
        if bristle is not None and not bristle.lags:
            bristle = replace(bristle, exponent=1.0)
        seen = bristle is not None and bristle.length > SHORT * self.frame.noise
        noise = Noise(
            edges=edges, deviations=np.zeros(0), pieces=np.ones(len(self.balance.pieces)),
            bristle=bristle if seen else None,
        )  # fmt: skip
        of = self.classes(self.balance, which, noise)
        sizes = np.zeros(SPEEDS + len(NEAR) + len(LACKING))
        for k in range(len(sizes)):
            e = np.abs(left[(of == k) & np.isfinite(left)])
            if len(e) >= FEWEST:
                middle = float(np.median(e))
                tail = math.sqrt(float(np.mean(np.minimum(e, 6.0 * middle) ** 2)))
                sizes[k] = 0.5 * (1.48 * middle + tail)
        sizes[sizes == 0.0] = sizes.max(initial=1e-300)
        sizes = np.maximum(sizes, 0.1 * float(np.median(sizes)))
        sizes = np.maximum(sizes, self._rounding(which))
        pieces = np.ones(len(self.balance.pieces))
        if len(pieces) > 1:
            z, shown = np.minimum((left / sizes[of]) ** 2, 9.0), np.isfinite(left)
            of_each = [z[shown & (rows.piece == k)] for k in range(len(pieces))]
            pieces = np.sqrt([float(np.mean(x)) if len(x) else 1.0 for x in of_each])
            pieces = np.clip(pieces / math.sqrt(float(np.mean(pieces**2))), 0.4, 2.5)
        return replace(noise, deviations=sizes, pieces=pieces)

    def _noises(self, which: int, noise: Noise, acting: int) -> Array:
        """Return the noise of the rows of a cutoff as forces act (n,) [N]."""
        size = noise.deviations[self.classes(self.balance, which, noise)]
        size = size * noise.pieces[self.balance.rows(which).piece]
        return np.asarray(size / EXACT ** self.hidden(which, acting))

    def _rounding(self, which: int) -> float:
        """Return the least noise of the rows of a cutoff [N]."""
        y = self.balance.rows(which).response
        return EXACT * max(float(np.sqrt(np.mean(y * y))), self.size) + TINY

    def _weigh(
        self, node: Node, left: Array, noise: Noise, law: Structure = (), count: float = 0.0
    ) -> None:
        """Weigh the rows of the cutoff of a node by what is left of them, as forces act there."""
        which, memory = self.key(node)
        size = self._noises(which, noise, node[-3])
        z = np.abs(left / size)
        tail = math.sqrt((TAIL + 1.0) / (TAIL + FAR_OUT**2))
        kept = np.where(z > FAR_OUT, np.sqrt((TAIL + 1.0) / (TAIL + z**2)) / tail, 1.0)
        odd = TAIL * np.log(kept) + 0.5 * TAIL * (1.0 - kept**2)
        self.spread[which, node[-3]] = float(np.sum(odd))
        weights = kept / size
        scaled = left * weights
        shown = float(np.sum(1.0 - self.hidden(which, node[-3])))
        free = max(shown - count, 0.5 * shown)
        unit = math.sqrt(float(np.sum(scaled**2)) / free) + 1e-300
        self.kappas[which] = self._share(which, memory, law, scaled, weights)
        self.weights[which, node[-3]] = np.minimum(weights / unit, 1.0 / self._rounding(which))
        self.noises[which] = noise
        self._plain = {key: x for key, x in self._plain.items() if key[0] != which}
        self._grams = {key: x for key, x in self._grams.items() if key[0] != which}

    def _share(
        self, which: int, memory: int, law: Structure, scaled: Array, weights: Array
    ) -> float:
        """Return the share of rows that count.

        By the scores of the columns by row, and summed in parts of the record.
        """
        design = self.design(which, memory)
        names = [*LOOKED, "side", *self.balance.pieces[0].record.unknown]
        parts = [design.random[:, np.isin(design.groups, names)]]
        if law:
            parts.append(design.law[:, [self.columns.index(item) for item in law]])
        x = np.hstack(parts) * weights[:, None]
        x = x[:, np.any(x != 0.0, axis=0)]
        if not x.shape[1]:
            return KAPPA
        return share_of(np.linalg.qr(x / np.sqrt(np.mean(x * x, axis=0)))[0] * scaled[:, None])

    # ---- LuGre: a length that follows the level
    def _followed(self, search: Posterior, node: Node) -> Node | None:
        """Look for the length of a bristle as finely as it is known; return the new node, or None.

        It is the same at all speeds, or follows the level: that of the best law with one, and of
        the curve what is not linear in the speed at the top, which is viscous: a length that
        follows it would act as inertia.
        """
        bristle, frame = self.memory(node), self.frame
        if bristle.length <= SHORT * frame.noise:
            return None
        rows, balance = self.balance.rows(MIDDLE), self.balance
        if math.sqrt(float(np.mean(self.part(bristle) ** 2))) < SEEN:
            return None
        old = search.value(node)

        def look(memory: Memory) -> float:
            self.memories.append(memory)
            return search.value((*node[:-2], len(self.memories) - 1, 0))

        state = rows.taken(balance.states(bristle))
        part = (np.abs(state) < PART) & (np.abs(rows.velocity) > frame.low / 3.0)
        speed = float(np.median(np.abs(rows.velocity)[part])) if part.sum() > FEW else 0.0
        speed = max(speed, frame.low)
        forms = [bristle] * (bristle.ratio is None)
        # the other kind is followed, too: the coarse one, of one length, tells little of it
        lagging = next((x for x in (bristle, *self.memories) if x.lags and x.length), None)
        ratios = [*self._ratios(search, node, speed)] if lagging else []
        if lagging and ratios:
            following = [replace(lagging, exponent=LUGRE, ratio=x, speed=speed) for x in ratios]
            forms.append(max(following, key=look))
        slower = max(0.0, 1.0 - math.log(speed / frame.low))
        looked = list[tuple[float, list[Memory]]]()
        for form in forms:
            grows = form.ratio is not None and bristle.ratio is None
            factors = np.array(FOLLOWING if grows else AGAIN)
            values = [look(replace(form, length=form.length * x)) for x in factors]
            k = int(np.clip(np.argmax(values), 1, len(factors) - 2))
            bend, step = _top(np.log(factors[k - 1 : k + 2]), np.array(values[k - 1 : k + 2]))
            length = form.length * math.exp(float(np.clip(step, math.log(0.6), math.log(2.2))))
            if look(replace(form, length=length)) < max(values):
                length = form.length * float(factors[np.argmax(values)])
            width = 0.1 if bend >= 0.0 else float(np.clip(math.sqrt(-0.5 / bend), *WIDTHS))
            unknown = frame.noise / length
            if form.ratio is not None:
                unknown = math.hypot(BELOW * slower, unknown)
            middle = replace(form, length=length, spread=math.hypot(WITHIN * width, unknown))
            beside = [replace(middle, length=length * math.exp(x * width)) for x in (-ASIDE, ASIDE)]
            looked.append((look(middle), [middle, *beside]))
        looked.sort(key=lambda item: -item[0])
        if not looked:
            return None
        new = looked[0][0]
        kept = [self.memories[0], *looked[0][1]]
        kept += [item[1][0] for item in looked[1:] if item[0] > new - 5.0]
        better = bristle.ratio is not None and old > new  # of another level, which was refined
        kept += [bristle] * better
        self._keep(kept)
        node = (*node[:-2], len(kept) - 1 if better else 1, 0)
        return self._again(self._here(node))

    def _keep(self, memories: list[Memory]) -> None:
        """Keep some bristles, and forget what was computed of others."""
        self._designs, self._plain, self._grams = {}, {}, {}
        self.memories = memories
        self.balance.forget(memories)

    def _ratios(self, search: Posterior, node: Node, speed: float) -> Iterator[Array]:
        """Yield levels at the knots over those at a speed (k,): of the law, and with the curve."""
        weights = search.weights[search.nodes.index(node)]
        fits = [
            k
            for k, law in enumerate(search.structures)
            if any(name in LEVELS for name, _ in law)
            and not any(name in BESIDE_LEVELS for name, _ in law)
        ]
        if not fits:
            return
        law = search.structures[max(fits, key=lambda k: weights[k])]
        c, b = search.estimate(node, law)
        design = self.design(*self.key(node))
        speeds, through = np.exp(self.frame.knots), sum(self.frame.transmitted[1:2])
        curve = self.plain(node, b[:, None])[design.groups == "common", 0]
        fast = speeds > 0.2 * speeds[-1]
        curve = curve - np.polyfit(speeds[fast], curve[fast], 1)[0] * speeds
        level, flat = np.zeros_like(speeds), np.ones_like(speeds)
        for item, x in zip(law, c, strict=True):
            if item[0] in LEVELS:
                level += x * law_column(item, speeds, flat, 0.0, through)
        for own in (level, level + curve):
            if np.all(own > 0.2 * np.median(own)) and np.median(own) > 0.0:
                yield own / np.interp(math.log(speed), self.frame.knots, own)

    # ---- other cutoffs
    def _widen(self, node: Node) -> list[Node]:
        """Open all cutoffs; return nodes from which a search of all begins."""
        self.cutoffs = tuple(range(len(CUTOFFS)))
        usual = self.noises[MIDDLE]
        every = [(*item[:-2], *node[-2:]) for item in self.otherwise if item[-3] != node[-3]]
        result = [(*item[:-1], which) for which in self.cutoffs for item in (*every, node)]
        for own in result:
            if (which := own[-1]) != MIDDLE:
                self.weights[which, own[-3]] = 1.0 / self._noises(which, usual, own[-3])
                self.spread[which, own[-3]], self.kappas[which] = 0.0, self.kappas[MIDDLE]
                self._again(self._here(own))
        return result


def stretches(count: int) -> Places:
    """Return the number of the stretch of each of so many rows (n,)."""
    return np.minimum(np.arange(count) * STRETCHES // count, STRETCHES - 1)


def is_possible(at: int, gram: Array, deviations: Array) -> bool:
    """Return whether a coefficient may be above 0; data that have it far below are wrong."""
    sizes = np.append(deviations, np.full(len(gram) - 1 - len(deviations), COEFFICIENT))
    precision = sizes[:, None] * gram[:-1, :-1] * sizes + np.eye(len(sizes))
    unit = np.eye(len(sizes))[at]
    of_it = np.linalg.solve(precision, unit)
    return bool(of_it @ (sizes * gram[:-1, -1]) > AT_BOUND * math.sqrt(of_it[at]))


def share_of(scores: Array) -> float:
    """Return the share of rows that count, by scores (n, p) of orthogonal columns.

    By their squares by row, and summed in parts of the record.
    """
    alone, most = np.sum(scores**2, axis=0) + 1e-300, 1.0
    for count in BLOCKS:
        starts = np.arange(0, len(scores), max(len(scores) // count, 1))
        summed = np.add.reduceat(scores, starts, axis=0)
        most = max(most, float(np.mean(np.sum(summed**2, axis=0) / alone)))
    return min(1.0 / most, KAPPA)


def usual_families(frame: RecordFrame) -> list[Family]:
    """Return the families that are compared: with a gear, also those that grow with its load."""
    geared = [*GEARED] if frame.transmitted else []
    return [tuple(item.split()) for item in (*FAMILIES, *geared)]


def laws_of(grid: Grid, families: Collection[Family]) -> Iterator[tuple[Structure, float]]:
    """Yield laws with their shapes, and the logarithms of their priors."""
    for family, shapes, prior in grid.families([tuple(sorted(item)) for item in families]):
        yield tuple(zip(family, shapes, strict=True)), prior


def _top(x: Array, y: Array) -> tuple[float, float]:
    """Return half the second derivative of a parabola through three points, and where its top is.

    Where it has none, it is the largest of the points.
    """
    bend, tilt, _ = np.polyfit(x, y, 2).tolist()
    return bend, -tilt / (2.0 * bend) if bend < 0.0 else float(x[np.argmax(y)])


def soft_solver(x: Array) -> Solver:
    """Return what gives coefficients of columns (n, p) for values, and what they leave."""
    size = np.sqrt(np.mean(x * x, axis=0)) + TINY
    x = x / size
    factor = cho_factor(x.T @ x + SOFT * len(x) * np.eye(x.shape[1]))

    def solved(y: Array) -> tuple[Array, Array]:
        c = cho_solve(factor, x.T @ y)
        return c / size, y - x @ c

    return solved


def solved_softly(x: Array, y: Array) -> tuple[Array, Array]:
    """Return coefficients (p,) of columns (n, p) for values (n,), and what they leave (n,)."""
    return soft_solver(x)(y)


def capped(left: Array, far: float = 4.0) -> float:
    """Return the mean square of what is left (n,): what is `far` off counts as that many medians.

    Examples
    --------
    >>> capped(np.array([1.0, -1.0, 1.0, 90.0, 1.0]))
    4.0
    """
    size = np.abs(left)
    return float(np.mean(np.minimum(size, far * np.median(size)) ** 2))


def likeliest(likely: Callable[[float], float], grid: Array) -> tuple[float, float]:
    """Return where a function is largest near an even grid (n,), and its value.

    Examples
    --------
    >>> best, _ = likeliest(lambda x: -((x - 0.3) ** 2), np.linspace(-1.0, 1.0, 5))
    >>> round(best, 2)
    0.3
    """
    for _ in range(FINER):
        values = [likely(x) for x in grid.tolist()]
        best, step = float(grid[np.argmax(values)]), float(grid[1] - grid[0])
        grid = best + step * np.array([-2.0, -1.0, 0.0, 1.0, 2.0]) / 3.0
    return best, max(values)


def odds_of(acting: Acting) -> float:
    """Return prior odds of a delay that leaves least of those looked at, and of clipping.

    Together those looked at have that of `OTHERWISE`, of which the others count for nothing.

    Examples
    --------
    >>> odds_of(Acting())
    1
    """
    each = {
        len(DELAYS) * len(ORDERS): acting.delay != 0.0,
        1: acting.clipped,
    }
    return math.prod(OTHERWISE / (1.0 - OTHERWISE) / count for count, acts in each.items() if acts)


def waves_seen(rows: BalanceRows, span: float, noise: float) -> tuple[Array, NDArray[np.int_]]:
    """Return wave numbers over the place (k,), and the rows that show them (n,)."""
    numbers = np.arange(40.0 * STEPS, min(DENSEST, math.pi * span / (8.0 * noise)), STEPS) / span
    resolved = np.flatnonzero(rows.far > RESOLVED)
    return numbers, resolved[:: max(len(resolved) // PARTS, 1)]


def force_wave(rows: BalanceRows, span: float, noise: float, beside: Array) -> tuple[float, ...]:
    """Return the wave number over the place of the force that leaves least beside columns (n, p).

    A force that changes with the place moves the body: what a balance without it leaves has a wave
    of another phase and size.
    """
    numbers, few = waves_seen(rows, span, noise)
    if len(numbers) < 2 or len(few) < max(FEW, 2 * beside.shape[1]):
        return ()
    basis, place = np.linalg.qr(beside[few])[0], rows.position[few]
    e = rows.response[few] - basis @ (basis.T @ rows.response[few])
    e = np.clip(e, *np.quantile(e, [0.02, 0.98]))

    def likely(number: float) -> float:
        wave = np.column_stack([np.cos(number * place), np.sin(number * place)])
        return -float(np.sum(solved_softly(wave - basis @ (basis.T @ wave), e)[1] ** 2))

    return (likeliest(likely, numbers)[0],)


def level_wave(rows: BalanceRows, span: float, noise: float, left: Array) -> tuple[float, ...]:
    """Return the wave number over the place of the level, the largest of what is left (n,)."""
    numbers, few = waves_seen(rows, span, noise)
    if not len(numbers) or len(few) < FEW:
        return ()
    e = np.clip(left[few], *np.quantile(left[few], [0.02, 0.98]))
    turned = (e - np.mean(e)) * np.sign(rows.velocity[few])
    power = np.abs(np.exp(-1j * np.outer(numbers, rows.position[few])) @ turned)
    return (float(numbers[np.argmax(power)]),)
