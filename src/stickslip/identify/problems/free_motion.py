"""Free motions as a problem of the judgement: swings, springs that decay, coast-downs."""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import starmap
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.identify.bands import MeasuredPoints
from stickslip.identify.judgement import DRAWS, Candidates, Problem
from stickslip.identify.laws import POINTS, Composition, composed_over
from stickslip.identify.own_laws import is_slope, slope_column
from stickslip.identify.posterior import Array, Draws, Family, Structure, family_of
from stickslip.identify.problems.free_balance import (
    SEEN,
    FreeBalance,
    balanced,
    before_rest,
    free_form,
    unseen_of,
)
from stickslip.identify.problems.free_runs import (
    KNOTS,
    NOT_FREE,
    RUN_PRIOR,
    RUNS,
    SIZES,
    Motion,
    RunModel,
    followed,
    judged,
)
from stickslip.identify.problems.record_curves import SteadyRows
from stickslip.identify.problems.record_signals import Record
from stickslip.identify.problems.records import ASKED, PLACES, candidates_of, parts_of
from stickslip.identify.projection import Rung, Shaped
from stickslip.identify.propose import AGAIN, propose
from stickslip.identify.vocabulary import FAMILIES, PARTS
from stickslip.quantities import vary

FOLLOWED = 100
"""Draws by which another motion is run."""
STARTS = (1.0, 0.5, 0.25)
"""Shares of a start from which a further motion may begin: slower ones tell slower speeds."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OtherMotions:
    """Readings of other records."""

    motions: Sequence[Motion]

    @property
    def velocity(self) -> Array:
        """NaN (n,): none is told beside a reading."""
        return np.full(len(self.response), np.nan)

    @property
    def response(self) -> Array:
        """Positions [m], or velocities (n,)."""
        return np.concatenate([motion.values for motion in self.motions])


@dataclass(eq=False)
class FreeMotionProblem(Problem):
    """Free motions of one coordinate with their posterior.

    Parameters
    ----------
    records : sequence of Record
        What was recorded: `free_form` says whether they are free.
    normal : float
        Normal force at which levels are stated [N].
    sought : sequence of str
        Paths of parameters of the mechanism that are looked for.
    load_slopes : mapping of str to pair of float
        By how much parameters change the normal force, and their values.
    deviations : mapping of str to float, optional
        Standard uncertainties of the mechanism's parameters that were stated, by path.
    families : sequence of Family, optional
        Families of laws that are compared.
    """

    records: Sequence[Record]
    normal: float = 1.0
    sought: Sequence[str] = ()
    load_slopes: Mapping[str, tuple[float, float]] | None = None
    deviations: Mapping[str, float] | None = None
    families: Sequence[Family] | None = None

    def __post_init__(self) -> None:
        known = None
        if self.families is not None:
            known = [(), *dict.fromkeys(map(parts_of, self.families))]
        self.restricted = known is not None
        self.runs = len(self.records)
        own = [before_rest(record) for record in self.records]
        form = free_form(own)
        if self.sought:
            inertia = next((x for x in self.sought if x not in own[0].unknown), "")
            result = balanced(own, form, inertia)
            try:
                own = [replace(x, rig=vary(x.rig, "mechanism", result)) for x in own if x.rig]
            except InputError as error:
                raise InputError(f"{NOT_FREE} The closest balance says: {error}") from None
        self.balance = FreeBalance(own, form)
        self.grid = self.balance.grid
        assert own[0].rig is not None
        unseen = unseen_of(own[0].rig, self.sought, self.deviations or {})
        motion = self.balance.motion(unseen, self.normal)
        self.laws = [tuple(item.split()) for item in FAMILIES] if known is None else known
        near = followed(motion)
        self.posterior = judged(near, self.grid, self.laws)
        self.size, self.load = motion.size, self.normal
        self.side = self.balance.side

    def with_laws(
        self, own: Sequence[Structure], families: Sequence[Family]
    ) -> "FreeMotionProblem":
        result = copy.copy(self)
        result.families, result.restricted = (*families, *map(family_of, own)), True
        result.laws, model = [*dict.fromkeys(map(parts_of, families))], self.model
        model = RunModel(model.runs, model.linear, model, own)
        result.posterior = judged(model, self.grid, result.laws)
        return result

    @property
    def model(self) -> RunModel:
        """The readings, linear about a run that follows them."""
        assert isinstance(self.posterior.model, RunModel)
        return self.posterior.model

    # ---- rows -------------------------------------------------------------------------------

    def at(
        self, velocity: Any, load: Any = None, inputs: Mapping[str, Any] | None = None
    ) -> SteadyRows:
        """Return rows of steady sliding at velocities (n,); the rest is usual if not given."""
        v = np.atleast_1d(np.asarray(velocity, dtype=float))
        over = 1.0 if load is None else np.asarray(load, dtype=float) / self.normal
        ratio = np.ones(len(v)) * over
        return SteadyRows(velocity=v, load=self.normal * ratio, ratio=ratio, inputs={})

    def _speeds(self, count: int) -> SteadyRows:
        own = self.balance
        return self.at(self.side * np.geomspace(own.slowest, own.fastest, count))

    def asked(self) -> SteadyRows:
        """Return the speeds over which the band is stated: those of the motion."""
        return self._speeds(ASKED)

    def places(self) -> SteadyRows:
        """Return the speeds at which curves are projected: as many at each as friction works."""
        return self.at(self.side * self.balance.passed(np.linspace(*SEEN, PLACES)))

    def curve_rows(self) -> SteadyRows:
        """Return rows through which a curve is drawn as a law."""
        return self._speeds(POINTS)

    def start_of(self, draws: Sequence[Draws]) -> float:
        """Return the share of the start from which a further motion narrows the band most."""
        return min(STARTS, key=lambda share: self.further(draws, share)[0])

    def further(self, draws: Sequence[Draws], share: float = 1.0) -> tuple[float, ...]:
        """Return the expected width of the band after one, two ... further motions, over today's.

        They are like the first from a `share` of its start.

        A motion reads the values at the knots and what is unseen, with the precision that its rows
        give them. A further motion also tells laws apart, which no draw shows: the width that comes
        may be smaller. A length is not proposed, as runs tell it to some parts in 1e5.
        """
        motion = self.model.motion
        knots = self.at(self.side * np.exp(motion.knots))
        fixed = np.sum([item.at(np.abs(knots.velocity)) for item in motion.fixed], axis=0)
        unseen = self.model.beside(draws)[self.model.runs.ratio].T
        told = np.hstack([self.side * self.steady(knots, draws) / fixed, unseen])
        values, vectors = np.linalg.eigh(self.model.told_by_another(share))
        read = told @ (vectors * np.sqrt(np.maximum(values, 0.0)))
        curves = self.steady(self.asked(), draws)
        return propose(curves, read[:, None], 1.0, taken=AGAIN, enough=0.0).widths

    def metric(self, places: SteadyRows, allowed: Array) -> tuple[SteadyRows, Array]:
        """Return the knots with a root of the precision that the readings give friction there.

        What friction takes along the way is known far better than friction at any speed.
        """
        motion = self.model.motion
        order = np.argsort(motion.knots)
        speed = np.exp(motion.knots[order])
        fixed = np.sum([item.at(speed) for item in motion.fixed], axis=0)
        values, vectors = np.linalg.eigh(self.model.told[np.ix_(order, order)])
        told = np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T / fixed
        there = np.abs(places.velocity)
        known = np.diag(1.0 / np.interp(speed, np.sort(there), allowed[np.argsort(there)]))
        return self.at(self.side * speed), np.vstack([told, known])

    # ---- laws -------------------------------------------------------------------------------

    def columns(self, column: tuple[str, Any], rows: SteadyRows) -> list[Array]:
        """Return the columns of a term of a law at rows (n,), or (k, n) for shapes of k draws."""
        name, shape = column
        if is_slope(name):
            return [slope_column(column, rows)]
        part, side = PARTS[name], np.sign(rows.velocity)
        state = side * rows.ratio if part.dry else side
        return [np.asarray(state * part.curve(np.abs(rows.velocity), shape))]

    def candidates(self) -> list[Candidates]:
        """Return the families on which curves are projected, with their structures."""
        laws: dict[Family, list[Structure]] = {}
        for family, shapes, _ in self.grid.families([item for item in self.laws if item]):
            laws.setdefault(family, []).append(tuple(zip(family, shapes, strict=True)))
        laws |= {family_of(item): [item] for item in self.model.own}
        return [*starmap(candidates_of, laws.items())]

    def composition(
        self,
        structure: Shaped,
        coefficients: Array,
        draws: Sequence[Draws] | None = None,
        *,
        offset: bool = False,
    ) -> Composition:
        """Return the law that a structure with coefficients (k, p) is, at the usual load."""
        return composed_over(structure, coefficients, self._normals(draws), {})

    def _normals(self, draws: Sequence[Draws] | None) -> Array:
        """Return the normal forces (k,) of draws, or that in the middle of all."""
        own = self.posterior.draws(DRAWS, seed=13) if draws is None else draws
        normal = np.full(sum(item.random.shape[1] for item in own), self.normal)
        rig = self.rig(own)
        for path, (slope, given) in (self.load_slopes or {}).items():
            normal = normal + slope * (rig.get(path, given) - given)
        normal = np.maximum(normal, 1e-9 * self.normal)
        return np.full(1, np.median(normal)) if draws is None else normal

    # ---- weights ----------------------------------------------------------------------------

    def is_small(self, tolerance: float) -> "NDArray[np.bool_]":
        """Return at which nodes what no law says is small (k,)."""
        return np.array([SIZES[node[0]] <= tolerance for node in self.posterior.nodes])

    def nothing(self) -> "NDArray[np.bool_]":
        """Return the nodes and structures (k, s) at which there is no friction."""
        still = np.array([node == (0, 0) for node in self.posterior.nodes])
        return np.asarray(still[:, None] & self.holds(()))

    # ---- curves -----------------------------------------------------------------------------

    def steady(self, rows: SteadyRows, draws: Sequence[Draws]) -> Array:
        """Return drawn curves (k, n)."""
        speed, side = np.abs(rows.velocity), np.sign(rows.velocity)
        random = self.model.beside(draws)[:KNOTS]
        curves = (side[:, None] * self.model.motion.beside(speed) @ random).T
        laws = []
        for draw in draws:
            own = np.zeros((draw.random.shape[1], len(speed)))
            for column, c in zip(draw.structure, draw.law, strict=True):
                own += np.outer(c, self.columns(column, rows)[0])
            laws.append(own)
        return np.asarray(side * np.maximum(side * (curves + np.vstack(laws)), 0.0))

    def friction(self, rows: SteadyRows, draws: Sequence[Draws], *, new: bool = False) -> Array:
        """Return what friction is in draws (k, n): in the motion, or in another run."""
        curves = self.steady(rows, draws)
        if not new:
            return curves
        rng = np.random.default_rng(7)
        sizes = rng.choice(RUNS, p=RUN_PRIOR, size=len(curves))
        return np.asarray(curves * (1.0 + sizes * rng.normal(size=len(curves)))[:, None])

    def like(self, records: Sequence[Record]) -> OtherMotions:
        """Return the readings of other records, which are another run."""
        own = [before_rest(record) for record in records]
        return OtherMotions(motions=FreeBalance(own, free_form(own)).motions)

    def readings(self, rows: SteadyRows | OtherMotions, draws: Sequence[Draws]) -> Array:
        """Return new readings in draws (k, n): those of a motion, for none reads a force."""
        if isinstance(rows, OtherMotions):
            few = self.posterior.draws(FOLLOWED, seed=17)
            return np.asarray(self.model.another(rows.motions, few))
        return self.steady(rows, draws)

    # ---- what leaves ------------------------------------------------------------------------

    def rig(self, draws: Sequence[Draws]) -> dict[str, Array]:
        """Return what no balance sees of the mechanism (k,) in draws, by path."""
        motion = self.model.motion
        result = motion.values(self.model.beside(draws)[self.model.runs.ratio].T)
        return dict(zip(motion.paths, result.T, strict=True))

    @cached_property
    def _between(self) -> tuple[Array, Array]:
        """Speeds and friction (n,) in the mean of stretches, by the balance."""
        speeds, frictions = list[Array](), list[Array]()
        for item in self.balance.each:
            v = np.abs(item.velocity)
            every = max(len(item.response) // ASKED, 1)
            way, path, lost = (
                np.diff(x[::every])
                for x in (item.taken(np.ones_like(v)), item.taken(v), item.response)
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
