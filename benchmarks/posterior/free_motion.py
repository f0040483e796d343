"""Free motions as a problem of the judgement: swings, springs that decay, coast-downs."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.posterior.free_balance import FreeBalance
from benchmarks.posterior.record_curves import SteadyRows
from benchmarks.posterior.record_problem import parts_of
from benchmarks.posterior.refinement import SIZES, Candidate, Motion, RunPosterior, Runs
from stickslip.identify.bands import MeasuredPoints
from stickslip.identify.judgement import Candidates, Problem
from stickslip.identify.laws import FLOWS, POINTS, TITLES, Composition, compose
from stickslip.identify.posterior import Array, Draws, Family, Structure
from stickslip.identify.problems.record_frame import before_rest, free_form
from stickslip.identify.problems.record_signals import Record
from stickslip.identify.projection import Free, Rung, Shaped, shapes_to_draw
from stickslip.identify.vocabulary import FAMILIES, PARTS, parameters_of
from stickslip.mechanisms import Mechanism

PLACES, ASKED = 25, 40
"""Speeds at which laws are compared, and at which the band is stated."""
EXACT = 0.02
"""Size of what no law says up to which a law is exact: the usual tolerance."""
FOLLOWED = 100
"""Draws by which another motion is run."""
SHOWN = 40
"""Points of a figure, about."""
MORE_TITLES: Mapping[str, str] = {
    "tanh": "level that is smooth in the velocity (tanh)",
    "logarithmic": "logarithm of the speed",
}
"""What terms are called that records of driven motion lack."""


@dataclass(frozen=True, kw_only=True)
class Followed:
    """How closely a run of a law follows the readings."""

    typical: float
    """Root mean square of what it leaves, in the unit of the readings."""
    largest: float
    error: float
    """Standard deviation of a reading, by the closest run."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OtherMotions:
    """Readings of other records."""

    motions: Sequence[Motion]

    @property
    def response(self) -> Array:
        """Positions [m], or velocities (n,)."""
        return np.concatenate([one.values for one in self.motions])


@dataclass(eq=False)
class FreeMotionProblem(Problem):
    """Free motions of one coordinate with their posterior.

    Parameters
    ----------
    mechanism : Mechanism
        What moves, with what is given of it.
    records : sequence of Record
        What was recorded: `free_form` says whether they are free.
    normal : float
        Normal force at which levels are stated [N].
    deviations : mapping of str to float, optional
        Standard uncertainties of the mechanism's parameters that were stated, by path.
    families : sequence of Family, optional
        Families of laws that are compared.
    """

    mechanism: Mechanism
    records: Sequence[Record]
    normal: float = 1.0
    deviations: Mapping[str, float] | None = None
    families: Sequence[Family] | None = None

    def __post_init__(self) -> None:
        known = None
        if self.families is not None:
            known = [(), *dict.fromkeys(map(parts_of, self.families))]
        own = [before_rest(one) for one in self.records]
        self.balance = FreeBalance(self.mechanism, own, free_form(own))
        motion = self.balance.motion(dict(self.deviations or {}))
        self.posterior = RunPosterior(motion, self.balance.candidates(known))
        self.size, self.load = motion.size, self.normal
        side = float(np.median(np.concatenate([one.velocity for one in self.balance.each])))
        self.side = -1.0 if self.balance.each[0].form == "momentum" and side < 0.0 else 1.0

    # ---- rows -------------------------------------------------------------------------------

    def at(
        self, velocity: Any, load: Any = None, inputs: Mapping[str, Any] | None = None
    ) -> SteadyRows:
        """Return rows of steady sliding at velocities (n,); the rest is usual if not given."""
        v = np.atleast_1d(np.asarray(velocity, dtype=float))
        ratio = np.ones(len(v)) * (1.0 if load is None else load / self.normal)
        return SteadyRows(velocity=v, load=self.normal * ratio, ratio=ratio, inputs={})

    def _speeds(self, count: int) -> SteadyRows:
        own = self.balance
        return self.at(self.side * np.geomspace(own.slowest, own.fastest, count))

    def asked(self) -> SteadyRows:
        """Return the speeds over which the band is stated: those of the motion."""
        return self._speeds(ASKED)

    def places(self) -> SteadyRows:
        """Return the speeds at which curves are projected."""
        return self._speeds(PLACES)

    def curve_rows(self) -> SteadyRows:
        """Return rows through which a curve is drawn as a law."""
        return self._speeds(POINTS)

    def offered(self) -> SteadyRows:
        """Return the readings that may be proposed: none that a free motion could take."""
        return self.at(np.zeros(0))

    def speed_of(self, place: int) -> float:
        """Return the velocity of a place at which laws are compared [m/s]."""
        return float(self.places().velocity[place])

    def scale(self, rows: SteadyRows) -> Array:
        """Return how friction grows with the load at rows (n,)."""
        return rows.ratio

    # ---- laws -------------------------------------------------------------------------------

    def columns(self, column: tuple[str, Any], rows: SteadyRows) -> list[Array]:
        """Return the columns of a term of a law at rows (n,), or (k, n) for shapes of k draws."""
        name, shape = column
        part, side = PARTS[name], np.sign(rows.velocity)
        state = side * rows.ratio if part.dry else side
        return [np.asarray(state * part.curve(np.abs(rows.velocity), shape))]

    def candidates(self) -> list[Candidates]:
        """Return the families on which curves are projected, with their structures."""
        known = [tuple(one.split()) for one in FAMILIES]
        if self.families is not None:
            known = [*dict.fromkeys(map(parts_of, self.families))]
        laws: dict[Family, list[Structure]] = {}
        for family, shapes, _ in self.balance.grid.families([one for one in known if one]):
            laws.setdefault(family, []).append(tuple(zip(family, shapes, strict=True)))
        return [
            Candidates(family=one, structures=structures, parameters=parameters_of(one))
            for one, structures in laws.items()
        ]

    def free(self, rung: Rung) -> tuple[list[Free], list[Structure]]:
        """Return the entries of shapes that draws have of their own, and structures to begin at."""
        return shapes_to_draw(rung.structure, self.balance.slowest, self.balance.fastest)

    def title(self, term: str) -> str:
        """Return what a term is called in a sentence."""
        return MORE_TITLES.get(term) or TITLES[term]

    def composition(
        self, structure: Shaped, coefficients: Array, *, offset: bool = False
    ) -> Composition:
        """Return the law that a structure with coefficients (k, p) is, at the usual load."""
        terms: dict[str, tuple[Any, Array]] = {
            name: (shape, own[:, None] if name in FLOWS else own[:, None] / self.normal)
            for (name, shape), own in zip(structure, coefficients.T, strict=True)
        }
        return replace(compose(terms, {}, len(coefficients)), load=self.normal)

    # ---- weights ----------------------------------------------------------------------------

    def exact(self) -> float:
        """Return the probability that what no law says is small beside any tolerance."""
        small = np.array(SIZES) <= EXACT
        return float(self.posterior.weights[small].sum())

    def masses(self, tolerance: float) -> tuple[dict[Family, float], dict[Family, float]]:
        """Return the probability of each family, and that with little that no law says."""
        small = np.array(SIZES) <= tolerance
        families, weights = self.posterior.families, self.posterior.weights
        every = dict(zip(families, weights.sum(axis=0).tolist(), strict=True))
        return every, dict(zip(families, weights[small].sum(axis=0).tolist(), strict=True))

    def holds(self, family: Family) -> "NDArray[np.bool_]":
        """Return the nodes and structures (k, s) of the posterior at which a family holds."""
        same = np.array([one == family for one in self.posterior.families])
        return np.broadcast_to(same, self.posterior.weights.shape)

    def nothing(self) -> "NDArray[np.bool_]":
        """Return the nodes and structures (k, s) at which there is no friction."""
        return self.holds(())

    # ---- curves -----------------------------------------------------------------------------

    def steady(self, rows: SteadyRows, draws: Sequence[Draws]) -> Array:
        """Return drawn curves (k, n)."""
        speed, side = np.abs(rows.velocity), np.sign(rows.velocity)
        beside = side[:, None] * self.posterior.motion.beside(speed)
        found = np.empty((len(draws), len(speed)))
        for k, one in enumerate(draws):
            law = [self.columns(column, rows)[0] for column in one.structure]
            found[k] = beside @ one.random[: beside.shape[1], 0]
            found[k] += np.sum([c * x for c, x in zip(one.law[:, 0], law, strict=True)], axis=0)
        return found

    def friction(self, rows: SteadyRows, draws: Sequence[Draws], *, new: bool = False) -> Array:
        """Return what friction is in draws (k, n)."""
        return self.steady(rows, draws)

    def like(self, records: Sequence[Record]) -> OtherMotions:
        """Return the readings of other records, which are another run."""
        own = [before_rest(one) for one in records]
        return OtherMotions(motions=FreeBalance(self.mechanism, own, free_form(own)).motions)

    def readings(self, rows: SteadyRows | OtherMotions, draws: Sequence[Draws]) -> Array:
        """Return new readings in draws (k, n): those of a motion, for none reads a force."""
        if isinstance(rows, OtherMotions):
            return self.posterior.another(rows.motions, draws[:: max(len(draws) // FOLLOWED, 1)])
        return self.steady(rows, draws)

    def noise(self, rows: SteadyRows) -> Array:
        """Return the standard deviation of a reading of friction at rows (n,): none is read."""
        return np.full(len(rows.velocity), np.inf)

    # ---- what leaves ------------------------------------------------------------------------

    def rig(self, draws: Sequence[Draws]) -> dict[str, Array]:
        """Return what no balance sees of the mechanism (k,) in draws, by path."""
        unseen = self.posterior.motion.unseen
        if unseen is None:
            return {}
        at = self.posterior.motion.knots.size
        return {unseen.path: unseen.value * np.exp([float(one.random[at, 0]) for one in draws])}

    def followed(self, rung: Rung) -> Followed:
        """Return how closely a run of the law of a rung follows the readings.

        How the motion starts and what no balance sees of the mechanism are free in it.
        """
        posterior, (_, best) = self.posterior, self.posterior.best
        one = Candidate(structure=rung.structure, coefficients=rung.coefficients)
        near = posterior.linear[best].x[posterior.runs[best].ratio.start :]
        left = Runs(posterior.motion, one).followed(near)
        return Followed(
            typical=math.sqrt(float(np.mean(left**2))),
            largest=float(np.max(np.abs(left))),
            error=posterior.sigma,
        )

    @cached_property
    def _between(self) -> tuple[Array, Array]:
        """Speeds and friction (n,) in the mean of stretches, by the balance."""
        speeds, frictions = list[Array](), list[Array]()
        for one in self.balance.each:
            v = np.abs(one.velocity)
            every = max(len(one.response) // SHOWN, 1)
            way, path, lost = (
                np.diff(x[::every])
                for x in (one.taken(np.ones_like(v)), one.taken(v), one.response)
            )
            speeds.append(path / way)
            frictions.append(lost / way)
        return np.concatenate(speeds), np.concatenate(frictions)

    def points(self, rung: Rung) -> MeasuredPoints:
        """Return friction in the mean of stretches of the motion, by its balance."""
        speed, friction = self._between
        ones = np.ones(len(speed))
        return MeasuredPoints(
            velocity=self.side * speed,
            friction=self.side * friction,
            load=self.normal * ones,
            weights=ones,
        )

    def scatter(self, rung: Rung) -> float:
        """Return the standard deviation of friction in the mean of stretches about a law [N]."""
        points = self.points(rung)
        law = self.design(rung.structure, self.at(points.velocity)) @ rung.coefficients
        return float(np.std(points.friction - law))
