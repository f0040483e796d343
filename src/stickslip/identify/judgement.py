r"""The judgement: what the posterior of a measurement says, whatever was measured.

A kind of measurement is a `Problem`: rows, columns and draws. All that a verdict states is read
here, from the same draws:

* the **name** and the ladder of laws (`stickslip.identify.projection`);
* the **band** of friction and that of new readings: quantiles of draws;
* **parameters**: draws projected on the named family, each with its own shape;
* **friction from zero**: the odds of all that is against no law and nothing beside it;
* **findings**: what stands beside the law, asserted at odds of `ASSERTED`.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.bands import (
    LEVEL,
    Array,
    Foreseen,
    Interval,
    MeasuredPoints,
    PredictionBand,
    correlation_of,
    quantile_band,
)
from stickslip.identify.fits import CHANCE
from stickslip.identify.laws import LINEAR, Composition, Sliding, drawn_curve, term_title
from stickslip.identify.posterior import Draws, Family, Structure, family_of
from stickslip.identify.projection import (
    EXACT,
    MARGIN,
    PLACES,
    TOLERANCE,
    Free,
    Projection,
    Projector,
    Rung,
    Shaped,
    Target,
    cost_of,
    is_signed,
    names_of,
    shapes_to_draw,
)
from stickslip.identify.vocabulary import PARTS, Grid
from stickslip.show.formatting import joined

SURPLUSES = ("stribeck", "hersey", "stribeck_sides")
"""Terms whose shape ends in the exponent by which they fade."""
DRAWS = 600
"""Draws from which everything is read."""
ASSERTED = 20.0
"""Odds from which something beside the law is asserted."""
RIVAL = 100.0
"""Odds up to which two things cannot be distinguished: another law from the named one, and friction
from zero (48 of 48 right, with noise of 9 to 100 %)."""
SHOWN = 6
"""Laws of the ladder that are shown."""
AT_END = 0.01
"""Part of a shape from the end of its range within which it counts as there."""
ONE_WAY = (
    "All motion is in one direction, in which a constant force (gravity, a cable, the zero of a"
    " sensor) cannot be distinguished from the level of friction: the level holds it, and its"
    " interval does not allow for it."
)
"""What is not distinguished where the posterior has no offset beside a level."""
OF_FRICTION = ("drift", "place", "run", "force")
"""Findings whose sizes are shares of friction, where there is some."""
UNSEEN = 0.5
"""Friction over the scatter about its law below which nothing is seen of it."""
NO_LAW = 0.1
"""Distance above which no law describes friction: real friction is within 3 to 8 % of a law."""


def with_shapes(structure: Structure, other: Structure, *, alone: bool) -> tuple[Structure, bool]:
    """Return a structure with the shapes of another, if that has them all, and whether it has.

    What is not `alone` in a curve has other shapes beside the rest: it fades as the other does.

    Examples
    --------
    >>> law, other = (("level", ()), ("stribeck", (0.1, 2.0))), (("stribeck", (0.3, 1.0)),)
    >>> with_shapes(law, other, alone=True)
    ((('level', ()), ('stribeck', (0.3, 1.0))), True)
    >>> with_shapes(law, other, alone=False)
    ((('level', ()), ('stribeck', (0.1, 1.0))), False)
    """
    shapes, fading = dict(other), [shape[1] for name, shape in other if name in SURPLUSES]
    if alone and all(len(shapes.get(name, ())) == len(shape) for name, shape in structure if shape):
        return tuple((name, shapes[name] if shape else ()) for name, shape in structure), True
    own = [(s[0], fading[0], *s[2:]) if fading and n in SURPLUSES else s for n, s in structure]
    return tuple(zip(family_of(structure), own, strict=True)), False


def is_asserted(probability: float) -> bool:
    """Return whether something of a probability is stated: at odds of `ASSERTED`.

    Examples
    --------
    >>> is_asserted(0.95), is_asserted(0.96)
    (False, True)
    """
    return probability >= ASSERTED * (1.0 - probability)


@dataclass(frozen=True, kw_only=True)
class Finding:
    """What may stand beside the law: a drift, a difference between runs, an effect of an input."""

    term: str
    title: str
    probability: float
    """Posterior probability that it is not negligible."""
    size: float
    """Median of its size, over friction; of a mass on a spring, over the inertia."""
    low: float
    high: float
    """Ends of its 95 % interval."""
    sentence: str = ""
    """What it does, in words of the kind."""
    mistaken: float = 0.0
    """Posterior probability that it is a mistake, such as a wrong unit, and no small error."""

    @property
    def asserted(self) -> bool:
        """Whether it is stated: at `ASSERTED`, and where its interval does not hold zero."""
        return is_asserted(self.probability) and not self.low <= 0.0 <= self.high

    @property
    def is_mistake(self) -> bool:
        """Whether it is a mistake rather than a small error: the more probable is stated."""
        return self.mistaken > 1.0 - self.mistaken


def stated(
    term: str, title: str, probability: float, size: Array, sentence: str, mistaken: float = 0.0
) -> Finding:
    """Return a finding with its size in draws (k,).

    Examples
    --------
    >>> stated("drift", "drift over the record", 0.99, np.array([0.1, 0.2, 0.3]), "").size
    0.2
    """
    low, middle, high = np.quantile(size, (0.025, 0.5, 0.975)).tolist()
    return Finding(
        term=term, title=title, probability=probability, size=middle, low=low, high=high,
        sentence=sentence, mistaken=mistaken,
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidates:
    """The structures of a family, and what it takes."""

    family: Family
    structures: Sequence[Structure]
    parameters: int


class Problem(ABC):
    """One measurement of any kind with its posterior, as the judgement reads it."""

    posterior: Any
    """The weights of structures at nodes, and draws of some of them."""
    size: float
    """Root mean square of the friction [N]."""
    load: float
    """Normal force at which levels are stated [N]."""
    grid: Grid
    """Shapes of the laws on which curves are projected."""
    restricted: bool = False
    """Whether only laws that were asked for are compared."""
    runs: int = 1
    """Number of runs or specimens that were measured."""
    looked_for: frozenset[str] = frozenset()
    """Terms beside every law that a user looks for."""
    fitted: bool = False
    """Whether one law is fitted: it stays of its type, and a constant offset stands beside it."""

    @abstractmethod
    def asked(self) -> Any:
        """Return the rows, with their `velocity`, over which the band is stated."""

    @abstractmethod
    def at(self, velocity: Any, load: Any = None, inputs: Mapping[str, Any] | None = None) -> Any:
        """Return rows of steady sliding at velocities (n,); the rest is usual if not given."""

    @abstractmethod
    def places(self) -> Any:
        """Return the rows at which curves are projected."""

    def scale(self, rows: Any) -> Array:
        """Return how friction grows with the load at rows (n,)."""
        return np.asarray(rows.ratio)

    @abstractmethod
    def columns(self, column: tuple[str, Any], rows: Any) -> list[Array]:
        """Return the columns of a term of a law at rows (n,), or (k, n) for shapes of k draws."""

    def tied(self, structure: Shaped) -> Shaped:
        """Return a structure whose shapes agree where terms share an entry.

        Both directions of a power have one exponent, and all that follow it one power of the load.
        """
        power = dict(structure).get("power", ())[:1]
        of_load = [s[-1] for n, s in structure if n in PARTS and len(s) > len(PARTS[n].shapes)]
        return [
            (n, power) if n == "power_direction"
            else (n, (*s[:-1], of_load[0])) if n in PARTS and len(s) > len(PARTS[n].shapes)
            else (n, s)
            for n, s in structure
        ]  # fmt: skip

    def design(self, structure: Shaped, rows: Any) -> Array:
        """Return the columns of a law at rows (n, p); (k, n, p) for shapes of k draws."""
        if not structure:
            return np.zeros((len(rows.velocity), 0))
        columns = [x for item in self.tied(structure) for x in self.columns(item, rows)]
        return np.stack(np.broadcast_arrays(*columns), axis=-1)

    def designs(
        self, structures: Sequence[Structure], rows: Any, known: dict[Any, list[Array]]
    ) -> Array:
        """Return the columns of structures of one family at rows (s, n, p).

        Those of terms that are known are not made again.
        """
        for column in {item for structure in structures for item in structure} - known.keys():
            known[column] = self.columns(column, rows)
        return np.array(
            [np.column_stack([x for item in s for x in known[item]]) for s in structures]
        )

    @abstractmethod
    def candidates(self) -> Sequence[Candidates]:
        """Return the families on which curves are projected, with their structures."""

    def free(self, rung: Rung) -> tuple[Sequence[Free], Sequence[Structure]]:
        """Return the entries of shapes that draws have of their own, and structures to begin at."""
        return shapes_to_draw(rung.structure, self.grid.slowest, self.grid.fastest)

    def is_small(self, tolerance: float) -> NDArray[np.bool_]:
        """Return at which nodes what no law says is small (k,)."""
        raise NotImplementedError

    def exact(self) -> float:
        """Return the probability that what no law says is small beside any tolerance."""
        return float(self.posterior.weights[self.is_small(TOLERANCE)].sum())

    def title(self, term: str) -> str:
        """Return what a term is called in a sentence."""
        return term_title(term)

    def speed_of(self, place: int) -> float:
        """Return the velocity of a place at which laws are compared [m/s]."""
        return float(self.places().velocity[place])

    @property
    def families_of_structures(self) -> Sequence[Family]:
        """The family of each structure, with what stands beside it."""
        return [family_of(item) for item in self.posterior.structures]

    def masses(self, tolerance: float) -> tuple[Mapping[Family, float], Mapping[Family, float]]:
        """Return the probability of each family, and that with little that no law says."""
        every, adequate = dict[Family, float](), dict[Family, float]()
        small = self.posterior.weights[self.is_small(tolerance)].sum(axis=0)
        shares = zip(self.families_of_structures, self.posterior.shares, small, strict=True)
        for family, share, own in shares:
            every[family] = every.get(family, 0.0) + float(share)
            adequate[family] = adequate.get(family, 0.0) + float(own)
        return every, adequate

    def holds(self, family: Family) -> NDArray[np.bool_]:
        """Return the nodes and structures (k, s) of the posterior at which a family holds."""
        same = np.array([item == family for item in self.families_of_structures])
        return np.broadcast_to(same, self.posterior.weights.shape)

    def nothing(self) -> NDArray[np.bool_]:
        """Return the nodes and structures (k, s) at which there is no friction."""
        return np.asarray(self.is_small(0.0)[:, None] & self.holds(()))

    @abstractmethod
    def steady(self, rows: Any, draws: Sequence[Draws]) -> Array:
        """Return drawn curves alone (k, n): midway, in the mean of the runs."""

    @abstractmethod
    def friction(self, rows: Any, draws: Sequence[Draws], *, new: bool = False) -> Array:
        """Return what friction is in draws (k, n): of what was measured, or of another specimen."""

    @abstractmethod
    def readings(self, rows: Any, draws: Sequence[Draws]) -> Array:
        """Return new readings in draws (k, n)."""

    @abstractmethod
    def composition(
        self,
        structure: Shaped,
        coefficients: Array,
        draws: Sequence[Draws] | None = None,
        *,
        offset: bool = False,
    ) -> Composition:
        """Return the law that a structure with coefficients (k, p) is.

        Entries of shapes may be arrays (k,): each draw has its own. Coefficients are those of
        `draws` in their order; of one law alone what else it needs is that in their middle. With
        `offset` its levels hold the constant offset.
        """

    @abstractmethod
    def points(self, rung: Rung) -> MeasuredPoints:
        """Return what a figure shows of the measurement beside a law."""

    @property
    def over(self) -> tuple[str, Any] | None:
        """What was changed at one speed, "load" or an input, and the rows of the readings (n,)."""
        return None

    @abstractmethod
    def curve_rows(self) -> Any:
        """Return rows through which a curve is drawn as a law: rising speeds of one direction."""

    @abstractmethod
    def scatter(self, rung: Rung) -> float:
        """Return the standard deviation of the readings about a law [N]."""

    def with_laws(self, own: Sequence[Structure], families: Sequence[Family]) -> "Problem":
        """Return the problem with laws that are no sums of parts, where they and some are named."""
        names = joined([item[0][0].partition(".")[0] for item in own])
        raise InputError(
            f"{names} friction cannot be compared on this measurement, as it is no sum of parts:"
            " compare laws that are."
        )

    def slips(self, rows: Any) -> Any:
        """Return velocities, loads and inputs at rows, which are `Slips`."""
        return rows

    def metric(self, places: Any, allowed: Array) -> tuple[Any, Array]:
        """Return rows at which a law is laid through a curve, and by what weights (n,) or (m, n).

        They are the places at which curves are compared, by the deviations allowed there (n,),
        unless the measurement tells sums over speeds better than friction at any.
        """
        return places, 1.0 / allowed

    def is_alone(self, draw: Draws) -> bool:
        """Return whether nothing that no law says is in a draw, as is known of the kind."""
        return False

    def usual(self, rows: Any) -> Array:
        """Return what Coulomb + viscous friction by least squares says of other readings (n,).

        NaN where nothing does: no force was read.
        """
        return np.full(len(rows.velocity), np.nan)

    def rig(self, draws: Sequence[Draws]) -> Mapping[str, Array]:
        """Return what was looked for of the rig (k,) in draws, by path."""
        return {}

    @property
    def outliers(self) -> Mapping[int, float]:
        """Readings that are far from the others, with how many deviations."""
        return {}

    def findings(self, draws: Sequence[Draws]) -> Sequence[Finding]:
        """Return what may stand beside the law."""
        return ()

    def untold(self) -> Sequence[str]:
        """Return sentences on what the design does not tell apart, and what would."""
        return ()


@dataclass(frozen=True, eq=False)
class Judgement:
    """What the posterior of a problem says."""

    problem: Problem
    tolerance: float = TOLERANCE
    seed: int = 0
    offset: bool = False
    """Whether the levels of laws hold a constant offset, as no mechanism does."""

    @cached_property
    def draws(self) -> list[Draws]:
        """Draws from which everything is read."""
        result: list[Draws] = self.problem.posterior.draws(DRAWS, seed=self.seed)
        return result

    @cached_property
    def _places(self) -> Any:
        return self.problem.places()

    @cached_property
    def target(self) -> Target:
        """What friction is at the places."""
        return Target(
            draws=self.problem.steady(self._places, self.draws),
            tolerance=self.tolerance,
            scale=self.problem.scale(self._places),
        )

    @cached_property
    def _projection(self) -> Projection:
        return Projection(self.target)

    @cached_property
    def rungs(self) -> tuple[Rung, ...]:
        """The closest law of each family, by the number of parameters and the distance."""
        masses, adequate = self.problem.masses(self.tolerance)
        result, known = [], dict[Any, list[Array]]()
        for each in self.problem.candidates():
            columns = self.problem.designs(each.structures, self._places, known)
            rung = self._projection.closest(
                each.structures, columns, each.parameters, alone=self.problem.restricted
            )
            if rung is not None:
                share = masses.get(each.family, 0.0)
                rung = replace(rung, share=share, adequate=adequate.get(each.family, 0.0))
                result.append(self._everywhere(rung))
        if not self.is_told or not result:
            none = self._projection.rung((), np.zeros(0), np.zeros((len(self.target.middle), 0)), 0)
            share = float(self.problem.posterior.weights[self.problem.nothing()].sum())
            none = replace(none, share=share, adequate=adequate.get((), 0.0))
            result.append(self._everywhere(none))
        return tuple(sorted(result, key=lambda item: (item.parameters, item.excess)))

    @cached_property
    def named(self) -> Rung:
        """The named law, with shapes between those of the grid."""
        adequate = [rung for rung in self.rungs if rung.adequate > 0.0]
        result = None
        if adequate and self.problem.exact() >= EXACT:
            result = self._shaped(max(adequate, key=lambda rung: rung.adequate))
        if result is None or (result.structure and result.excess > MARGIN):
            result = self._shaped(min(self.rungs, key=lambda rung: cost_of(rung, self.tolerance)))
        if self.is_told and not self._is_explained_by(result):  # the closest leaves least
            result = min(map(self._own, self.rungs), key=self.problem.scatter)
        if not self.is_told and self.problem.size < UNSEEN * self.problem.scatter(result):
            result = next((rung for rung in self.rungs if not rung.structure), result)
        return result

    def _own(self, rung: Rung) -> Rung:
        """Return a law of the ladder as it fits best, with shapes between those of the grid.

        Weights by the size of friction let one that is far off leave several times what it need.
        """
        result = self._shaped(rung)
        if not rung.structure or self._is_near(result):
            return result
        return min(result, self._shaped(rung, evenly=True), key=self.problem.scatter)

    def _shaped(self, rung: Rung, *, evenly: bool = False) -> Rung:
        """Return a law of the ladder with shapes between those of the grid."""
        if not rung.structure:
            return rung
        coefficients, shaped = self._projected(rung, evenly=evenly)
        structure = tuple(
            (name, tuple(float(np.ravel(x)[0]) for x in shape)) for name, shape in shaped
        )
        columns = self.problem.design(structure, self._places)
        own = self._projection.rung(structure, coefficients[0], columns, rung.parameters)
        return self._everywhere(replace(own, share=rung.share, adequate=rung.adequate))

    @cached_property
    def _metric(self) -> tuple[Any, Array]:
        return self.problem.metric(self._places, self.target.allowed)

    @cached_property
    def _middle(self) -> Array:
        """The curve (1, n) through which a law is laid."""
        if self._metric[1].ndim == 1:
            return self.target.middle[None]
        # what is known of sums over the rows is kept by the mean
        return np.asarray(np.mean(self.problem.steady(self._metric[0], self.draws), axis=0))[None]

    def _projected(
        self,
        rung: Rung,
        draws: Sequence[Draws] | None = None,
        *,
        same: bool = False,
        evenly: bool = False,
    ) -> tuple[Array, Shaped]:
        """Return coefficients (k, p) and shapes of draws, or their middle, on a rung's family.

        Draws that have the `same` shapes keep them, and stay near their coefficients. The middle
        may be followed `evenly` at all places.
        """
        (rows, weights), curves = self._metric, self._middle
        if evenly:
            curves = self.target.middle[None]
            rows, weights = self._places, np.full(curves.shape[1], 1.0 / self.problem.size)
        elif draws is not None:
            curves = self.problem.steady(rows, draws)
        free, coarse = ((), ()) if same else self.problem.free(rung)
        names = names_of(rung.structure)
        projector = Projector(
            lambda structure: self.problem.design(structure, rows),
            free,
            weights,
            np.array([not is_signed(name) for name in names]),
        )
        about = None
        if draws is not None and same:
            laws = [dict(zip(family_of(x.structure), x.law, strict=True)) for x in draws]
            none = [np.zeros(x.law.shape[1]) for x in draws]
            each = zip(laws, none, strict=True)
            about = np.hstack([[law.get(name, zero) for name in names] for law, zero in each]).T
        coefficients, shaped = projector(curves, [rung.structure, *coarse], about)
        return coefficients, self.problem.tied(shaped)

    @cached_property
    def ladder(self) -> tuple[Rung, ...]:
        """Laws that a user may weigh, by their parameters: the closest of each number, and rivals.

        A longer law stands only if it is closer, or cannot be distinguished from the named one.
        """
        result: list[Rung] = []
        for rung in self.rungs:
            closer = all(rung.distance < other.distance for other in result)
            if closer or self._is_named(rung) or self._is_rival(rung):
                result.append(rung)
        best = sorted(
            result, key=lambda item: (not self._is_named(item), -item.adequate, item.excess)
        )
        kept = best[:SHOWN]
        return tuple(
            self.named if self._is_named(item) else self._own(item)
            for item in result
            if any(item is other for other in kept)
        )

    @cached_property
    def _asked(self) -> tuple[Any, Target]:
        """The rows over which the band is stated, and what friction is there."""
        rows = self.problem.asked()
        draws = self.problem.steady(rows, self.draws)
        return rows, Target(draws=draws, tolerance=self.tolerance, scale=self.problem.scale(rows))

    def _everywhere(self, rung: Rung) -> Rung:
        """Return a law with its distances over the places and over the rows of the band.

        Rows of the band are counted after the places.
        """
        rows, target = self._asked
        left = np.abs(self.curve_of(rung, rows) - target.middle)
        apart = left / target.size
        rung = replace(
            rung,
            distance=max(rung.distance, float(np.quantile(apart, PLACES))),
            excess=max(rung.excess, float(np.quantile(left / target.allowed, PLACES))),
        )
        where = int(np.argmax(apart))
        if apart[where] <= rung.worst:
            return rung
        return replace(rung, worst=float(apart[where]), where=len(self.target.middle) + where)

    def speed_of(self, rung: Rung) -> float:
        """Return the velocity at which a law is farthest from friction [m/s]."""
        after = rung.where - len(self.target.middle)
        if after < 0:
            return self.problem.speed_of(rung.where)
        return float(self._asked[0].velocity[after])

    def _is_named(self, rung: Rung) -> bool:
        return rung.family == self.named.family

    def _is_rival(self, rung: Rung) -> bool:
        return rung.adequate * RIVAL > self.named.adequate > 0.0

    @cached_property
    def set(self) -> tuple[Rung, ...]:
        """Laws that cannot be distinguished, the named one first."""
        rivals = [rung for rung in self.rungs if self._is_rival(rung) and not self._is_named(rung)]
        return (self.named, *sorted(map(self._own, rivals), key=lambda rival: -rival.adequate))

    @cached_property
    def simpler(self) -> Rung | None:
        """The shortest law whose curve is within the tolerance of the named one's."""
        for rung in self.rungs:
            if rung.parameters >= self.named.parameters:
                return None
            if self.apart(rung) <= self.tolerance:
                return rung
        return None

    def apart(self, rung: Rung) -> float:
        """Return the share of friction within which a law stays of the named one at 95 %."""
        own, other = (self.curve_of(item, self._places) for item in (self.named, rung))
        return float(np.quantile(np.abs(other - own) / self.target.size, PLACES))

    @cached_property
    def odds(self) -> float:
        """Odds that there is friction."""
        weights = self.problem.posterior.weights
        none = float(weights[self.problem.nothing()].sum())
        return (1.0 - none) / none if none > 0.0 else math.inf

    @cached_property
    def is_told(self) -> bool:
        """Whether friction is distinguished from zero, by its odds or by the whole band."""
        rows = self._asked[0]
        return self.odds >= RIVAL or self.band(rows).brakes(rows.velocity)

    @property
    def is_explained(self) -> bool:
        """Whether a law is within `NO_LAW` of friction, or as near as it is known, or may hold.

        One of a probability of `CHANCE` may, however far noise moves the curve from it.
        """
        return self._is_explained_by(self.named)

    def _is_explained_by(self, named: Rung) -> bool:
        return any(map(self._is_near, (named, *self.rungs))) or named.adequate >= CHANCE

    def _is_near(self, rung: Rung) -> bool:
        """Return whether a law is within `NO_LAW` of friction, or as near as it is known."""
        return rung.distance <= max(NO_LAW, self.known) or rung.excess <= MARGIN

    @property
    def beside(self) -> frozenset[str]:
        """What stands beside a law that cannot be distinguished from the named one."""
        return frozenset(name for item in self.set for name in self.beside_of(item))

    def beside_of(self, rung: Rung) -> tuple[str, ...]:
        """Return what stands beside a law and no level of it holds, but for what is sought."""
        held = self.problem.looked_for | {"offset"} if self.offset else self.problem.looked_for
        return tuple(name for name in rung.family if name == "offset" and name not in held)

    @property
    def family(self) -> Family:
        """Names of the terms of the named law."""
        return self.named.family

    @property
    def families(self) -> tuple[Family, ...]:
        """Families that cannot be distinguished, the named one first."""
        return tuple(item.family for item in self.set)

    def measured(self) -> MeasuredPoints:
        """Return what a figure shows of the measurement."""
        return self.problem.points(self.named)

    def acting(self, rows: Any) -> Array:
        """Return friction of the named law and its constant offset (n,) at rows."""
        return self.curve_of(self.named, rows)

    @property
    def outliers(self) -> Mapping[int, float]:
        """Readings that are far from the others, with how many deviations."""
        return self.problem.outliers

    def details(self) -> Mapping[str, Any]:
        """Return what a document has of the judgement beside the band and the parameters."""
        return {
            "tolerance": self.tolerance,
            "odds_of_friction": self.odds if math.isfinite(self.odds) else None,
            "findings": [
                {**asdict(finding), "asserted": finding.asserted} for finding in self.findings
            ],
        }

    def curves(self, rows: Any, *, new: bool = False) -> Array:
        """Return draws of friction at rows (k, n)."""
        return self.problem.friction(rows, self.draws, new=new)

    def band(
        self, rows: Any, level: float = LEVEL, *, new: bool = False, all_along: bool = False
    ) -> PredictionBand:
        """Return the band of friction at rows."""
        return quantile_band(self.curves(rows, new=new), level, all_along=all_along)

    def reading_band(self, rows: Any, level: float = LEVEL) -> PredictionBand:
        """Return the band of new readings at rows."""
        return quantile_band(self.problem.readings(rows, self.draws), level)

    def foreseen(self, rows: Any, measured: Array, unit: str) -> Foreseen:
        """Return readings (n,) of another measurement at rows beside what was foreseen of them."""
        draws = self.problem.readings(rows, self.draws)
        band = quantile_band(draws)
        each, own = (
            np.mean((band.low <= x) & (x <= band.high), axis=-1) for x in (draws, measured)
        )
        return Foreseen(
            measured=measured,
            band=band,
            chance=float(np.mean(each <= own + 1e-9)),
            usual=self.problem.usual(rows),
            velocity=rows.velocity,
            unit=unit,
        )

    @cached_property
    def known(self) -> float:
        """Half the width of the band over friction, in the median of the asked places."""
        rows = self.problem.asked()
        band = self.band(rows)
        size = np.maximum(np.abs(band.median), 0.1 * np.median(np.abs(band.median)) + 1e-300)
        return float(np.median(0.5 * (band.high - band.low) / size))

    def handed_over(self, rung: Rung) -> tuple[Composition, Sliding, FrictionLaw | None]:
        """Return what a law of the ladder is, how it slides, and the law of ours that does so.

        It slides as the ladder says in both directions, beside the offset if no level holds it. The
        law is None where no law of `stickslip.friction` does.
        """
        composed = self._composed(rung)
        sliding = self.sliding(self.curve_of(rung, self._both_ways), rung)
        law = composed.law()
        if law is not None and composed.kind is None and not sliding.brakes(law, composed):
            law = None
        return composed, sliding, law

    @cached_property
    def _both_ways(self) -> Any:
        """Rows of rising velocities in both directions."""
        speeds = np.abs(self.problem.curve_rows().velocity)
        return self.problem.at(np.concatenate([-speeds[::-1], speeds]))

    def sliding(self, curve: Array, rung: Rung) -> Sliding:
        """Return a curve in both directions (n,) as sliding, without an offset beside it."""
        names = names_of(rung.structure)
        if "offset" in names and not self.offset:
            curve = curve - rung.coefficients[names.index("offset")]
        return Sliding(velocity=np.asarray(self._both_ways.velocity), friction=np.asarray(curve))

    def sampled(self, count: int, seed: int) -> list[FrictionLaw]:
        """Return laws of draws: those of the named family where they are near, else curves."""
        draws = self.problem.posterior.draws(DRAWS, seed=seed)
        places = self.problem.steady(self._places, draws)
        coefficients: Array = np.zeros((len(places), 0))
        shaped: Shaped = ()
        if self.named.structure:
            coefficients, shaped = self._projected(self.named, draws)
        columns = self.problem.design(shaped, self._places)
        fitted = np.sum(columns * coefficients[:, None], axis=-1)
        apart = np.quantile(np.abs(fitted - places) / self.target.size, PLACES, axis=1)
        own = [(name, tuple(np.ravel(x) for x in shape)) for name, shape in shaped]
        composed = self.problem.composition(own, coefficients, draws, offset=self.offset)
        curves, load = self.problem.steady(self._both_ways, draws), composed.normal()
        result: list[FrictionLaw] = []
        for k in np.resize(np.random.default_rng(seed).permutation(len(places)), count).tolist():
            law = composed.law(k) if apart[k] <= self.tolerance else None
            rung = replace(self.named, coefficients=coefficients[k])
            result.append(drawn_curve(self.sliding(curves[k], rung), load) if law is None else law)
        return result

    def curve_of(self, rung: Rung, rows: Any) -> Array:
        """Return the friction of a law at rows (n,), with its offset."""
        return np.asarray(self.problem.design(rung.structure, rows) @ rung.coefficients)

    @cached_property
    def composition(self) -> Composition:
        """The named law, with what was looked for of the rig."""
        return self._composed(self.named)

    def _composed(self, rung: Rung) -> Composition:
        """Return the law that a rung is, with what was found of the rig."""
        coefficients = rung.coefficients[None]
        result = self.problem.composition(rung.structure, coefficients, offset=self.offset)
        return replace(result, rig={**result.rig, **self.rig})

    @cached_property
    def rig(self) -> dict[str, Array]:
        """What was looked for of the rig (1,) by path."""
        drawn = self.problem.rig(self.draws)
        return {path: np.median(x, keepdims=True) for path, x in drawn.items()}

    def values_of(self, draws: Sequence[Draws], rung: Rung | None = None) -> dict[str, Array]:
        """Return parameters of a law, else the named one, (k,) by path: each draw's own.

        A draw that has the shapes of the law, and no curve beside it, keeps them and its
        coefficients, which change as little as what else it has allows: where no place shows a
        term, nothing else tells it. Others are projected with their own best shapes; entries that
        are no parameters, such as the exponent by which a surplus fades, are those of their own.
        """
        rung = rung or self.named
        if not rung.structure:
            return dict(self.problem.rig(draws))
        groups: dict[tuple[Structure, bool], list[Draws]] = {}
        for draw in draws:
            key = with_shapes(rung.structure, draw.structure, alone=self.problem.is_alone(draw))
            groups.setdefault(key, []).append(draw)
        every = [
            self._projected(replace(rung, structure=structure), own, same=same)
            for (structure, same), own in groups.items()
        ]
        coefficients = np.vstack([c for c, _ in every])
        ordered = [item for own in groups.values() for item in own]
        entries = [
            [np.broadcast_to(np.ravel(x), len(c)) for _, shape in shaped for x in shape]
            for c, shaped in every
        ]
        each = map(np.concatenate, zip(*entries, strict=True))
        result = [(name, tuple(next(each) for _ in shape)) for name, shape in rung.structure]
        composed = self.problem.composition(result, coefficients, ordered, offset=self.offset)
        return composed.paths() | dict(self.problem.rig(ordered))

    def _values_if(self, rung: Rung, count: int) -> dict[str, Array]:
        """Return parameters (k,) by path of draws in which a law holds; {} if none is."""
        holds = self.problem.holds(rung.family)
        if not float(self.problem.posterior.weights[holds].sum()) > 0.0:
            return {}
        draws = self.problem.posterior.draws(count, seed=self.seed + 1, only=holds)
        return self.values_of(draws, rung)

    @cached_property
    def named_values(self) -> dict[str, Array]:
        """Parameters (k,) by path if the named law holds."""
        return self._values_if(self.named, DRAWS) or self.values

    @cached_property
    def values(self) -> dict[str, Array]:
        """Parameters (k,) by path of the law that is closest to each draw."""
        return self.values_of(self.draws)

    @cached_property
    def intervals(self) -> tuple[Interval, ...]:
        """Intervals of the parameters of the named law.

        Over all laws, those that cannot be distinguished from the named one count by the root of
        their odds: what cannot be distinguished must not be left out.
        """
        tails, result = (0.5 * (1.0 - LEVEL), 0.5 * (1.0 + LEVEL)), []
        flow = self.composition.flow
        others = []
        for rung in self.set[1:]:
            composed = self.problem.composition(rung.structure, rung.coefficients[None])
            odds = min(math.sqrt(rung.adequate / self.named.adequate), 1.0)
            if rung.structure and odds * DRAWS >= 1.0:
                values = self._values_if(rung, math.ceil(odds * DRAWS))
                others.append((composed.flow == flow, values))
        for path, value in self.composition.paths().items():
            if path.startswith("friction.") and not self.named.structure:
                continue  # no law has no parameters
            own = self.named_values.get(path, value)
            same = [x[path] for alike, x in others
                    if path in x and (alike or not path.endswith(LINEAR))]  # fmt: skip
            every = np.concatenate([own, self.values.get(path, own), *same])
            low, high = np.quantile(own, tails).tolist()
            low_any, high_any = np.quantile(every, tails).tolist()
            if path.rpartition(".")[2] in self.composition.untold:
                low = low_any = -math.inf
                high = high_any = math.inf
            below, above = self._open_ends.get(path, (False, False))
            low, low_any = (-math.inf, -math.inf) if below else (low, low_any)
            high, high_any = (math.inf, math.inf) if above else (high, high_any)
            result.append(
                Interval(
                    path=path,
                    value=float(value[0]),
                    low=min(low, float(value[0])),
                    high=max(high, float(value[0])),
                    low_any=min(low, low_any, float(value[0])),
                    high_any=max(high, high_any, float(value[0])),
                )
            )
        return tuple(result)

    @cached_property
    def _open_ends(self) -> dict[str, tuple[bool, bool]]:
        """Whether intervals of the named law have no lower and no upper end, by path.

        Shapes of draws end where no reading is: what lies there would go on. A static surplus that
        fades below the slowest speed may be of any size, and so may the level below one that fades
        above the fastest.
        """
        result, paths = dict[str, tuple[bool, bool]](), self.composition.paths()
        for free in self.problem.free(self.named)[0] if self.named.structure else ():
            term = self.named.structure[free.column][0]
            if (path := self._path_of(free)) not in self.named_values:
                continue
            x, tail = self.named_values[path], 0.5 * (1.0 - LEVEL)
            below, above = x < free.low * (1.0 + AT_END), x > free.high / (1.0 + AT_END)
            ends = float(np.mean(below)) > tail, float(np.mean(above)) > tail
            result[path] = ends
            for level in paths if term in SURPLUSES else ():
                if level.endswith("static_coefficient") and ends[0]:
                    result[level] = False, True
                elif level.endswith("kinetic_coefficient") and ends[1]:
                    result[level] = True, False
        return result

    def _path_of(self, free: Free) -> str:
        """Return the path of the parameter that an entry of a shape is; "" if it is none."""
        structure = self.named.structure
        pair = structure[free.column][1][free.entry] * np.array([1.0, 2.0])
        changed: list[list[Array | float]] = [[*shape] for _, shape in structure]
        changed[free.column][free.entry] = pair
        own = [(name, tuple(x)) for name, x in zip(family_of(structure), changed, strict=True)]
        both = np.tile(self.named.coefficients, (2, 1))
        result = self.problem.composition(self.problem.tied(own), both).paths()
        return next((path for path, x in result.items() if np.array_equal(x, pair)), "")

    @cached_property
    def correlation(self) -> Array:
        """Correlation of the parameters of the named law (p, p), as `intervals` orders them."""
        if not self.intervals:
            return np.zeros((0, 0))
        known, paths = self.named_values, [interval.path for interval in self.intervals]
        none = np.zeros(len(next(iter(known.values()))))  # what no draw tells is alone
        return correlation_of(np.array([known.get(path, none) for path in paths]))

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What may stand beside the law."""
        result = self.problem.findings(self.draws)
        friction = bool(self.named.structure)
        return tuple(item for item in result if friction or item.term not in OF_FRICTION)
