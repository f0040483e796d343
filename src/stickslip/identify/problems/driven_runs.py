r"""Driven runs: what runs under a recorded voltage say of friction and of what it acts in.

A force balance is blind where constants of a motor are looked for that a voltage drives: noise of
the velocity, the steps of an encoder and friction that a law lacks all move them. Runs are not.
Parameters :math:`\phi` of the mechanism and friction of speed :math:`u` and of what a gear
transmits, :math:`T`,

.. math::
    \tau(u, T) = \tau_0(u, T) + F \sum_k (w_k + w_{K+k}\, |T| / T_0)\, N_k(\log (1 + u^2/u_1^2)) ,

are unknown: Newton's polynomials through values at `KNOTS` speeds beside a plain law
:math:`\tau_0`, over the size :math:`F` of friction. Each segment of the records starts as it fits
best.

0. Constants that are given of the rig are unknown with a prior about what was given, if runs
   determine them, and so is a delay of what drives.
1. The plain law and :math:`\phi` are found by steps of Levenberg and Marquardt along the
   sensitivities of the engine, :math:`\log\phi` with a prior of deviation `PRIOR` about what was
   given. Steps end where they would raise the logarithm of the posterior by less than `SETTLED`.
2. So are :math:`w` and :math:`\phi`, with the plain law held: whatever friction is, runs follow it.
   The deviation of a reading, and the share of readings that count as independent
   (`problems.free_runs.worth`), are taken again from what is left, `ROUNDS` times.
3. About that, runs are linear: with slopes :math:`S` the column of a term :math:`g` of a law is
   :math:`S_w\, g / F` at the knots, and the problem is one of `stickslip.identify.posterior`.
   Laws and what no law says, normal values at the knots with Matern's correlation, are then judged
   as those of free motions are, for all at once, with :math:`\phi` free.
"""

import copy
import itertools
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, partial
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, cho_factor, cho_solve
from scipy.optimize import least_squares

from stickslip.data import Measurement, interval_of
from stickslip.errors import InputError
from stickslip.friction import CoulombViscous, FrictionLaw, SetValuedLaw, bound
from stickslip.identify.bands import MeasuredPoints
from stickslip.identify.fits import (
    DELAY,
    WIDE,
    FreeParameter,
    FreeParameters,
    Hold,
    ResidualJacobian,
    Shooting,
    drives_itself,
    improve,
    load_of,
    measured_quantity,
    segments_of,
)
from stickslip.identify.forces import TRANSMITTED, with_gear
from stickslip.identify.judgement import DRAWS, Candidates, Finding, Problem, stated
from stickslip.identify.laws import POINTS, Composition, composed_over
from stickslip.identify.own_laws import Slips, certain_of, is_slope, signed_of
from stickslip.identify.posterior import (
    COEFFICIENT,
    Array,
    Column,
    Draws,
    Family,
    Model,
    Node,
    Posterior,
    Scale,
    Structure,
    System,
    family_of,
)
from stickslip.identify.problems.free_runs import (
    ROUNDED,
    RUN_PRIOR,
    RUNS,
    SIZE_PRIOR,
    SIZES,
    STRAIGHT,
    Number,
    alike,
    knots_of,
    leja,
    nested,
    newton,
    place_of,
    refined_shapes,
    through_knots,
    worth,
)
from stickslip.identify.problems.record_checks import LIFTED, plain_columns
from stickslip.identify.problems.record_columns import Balance, through_gear
from stickslip.identify.problems.record_curves import OtherRows, SteadyRows
from stickslip.identify.problems.record_model import (
    BELOW,
    KAPPA,
    OTHERWISE,
    SCALES,
    TIMED,
    laws_of,
)
from stickslip.identify.problems.record_signals import Record, records_of
from stickslip.identify.problems.records import (
    ASKED,
    NEGLIGIBLE,
    PLACES,
    RecordProblem,
    candidates_of,
    parts_of,
)
from stickslip.identify.problems.run_laws import SPREADS
from stickslip.identify.projection import Rung, Shaped
from stickslip.identify.simulated import SETTLED
from stickslip.identify.vocabulary import SIGNED, Grid
from stickslip.maths import Scalar, where
from stickslip.mechanisms import Mechanism, motor_of
from stickslip.quantities import Quantity, fields_of, parameters, vary
from stickslip.show.formatting import joined, parameter_words, quantity

PRIOR = 0.5
"""Standard deviation of the logarithm of a parameter about the value that was given of it."""
OPEN = 10.0
"""That of a parameter that may be 0, over what runs leave of it."""
MOST = 100.0
"""Size of a coefficient at most, over the usual one of a parameter."""
CLOSELY = 5.0
"""What runs leave over the noise of readings, from which more is missing than friction."""
MOST_LEFT = 0.2
"""Deviation after the runs over that before, from which words say that it is assumed."""
ROUNDING = 1e-14
"""Least eigenvalue of what is known over the largest: what is below is rounding."""
ROUNDS = 3
"""Times that the deviation of readings is taken again."""
STEPS = 10
"""Steps of an initial state, each time, and a quarter of those of the search: where a body sticks
and slips there are many, and long."""
KNOTS = 8
"""Speeds at which friction beside a law is free: about one for each e-fold that a servo has."""
AT = leja(KNOTS)
QUICK = 0.995
"""Part of the readings that are slower than the fastest speed."""
DECADES = 100.0
"""Range of speeds at most."""
WRONG = (0.0005, 0.03, 0.1)
"""By how much a constant of the rig may not be as given, as a share: any is with `OTHERWISE`."""
FOLLOWING = 5
"""Size with which runs that follow are looked for."""
LEVELS = tuple(np.geomspace(0.01, 2.0, 108).tolist())
"""Levels over the load that are tried of what drives itself: a twentieth more each, from rolling to
rubber."""
LOWER = (1.0, 0.7, 0.5, 0.35, 0.25)
"""Shares of the level of a balance that are tried under a voltage: a fifth more of the resistance
takes half the torque that is left of a stalled motor."""
SHARES = (0.1, 0.2, 0.35, 0.6, 1.0)
"""Shares of the records that are taken in one after the other, by runs of what drives itself."""
OTHER = 4.0
"""Cost over that of runs that follow, beyond which others have left their valley."""
FAST = 0.5
"""Share of the fastest speed above which slip counts as steady where runs start, and of a level
that a viscous part is there at most."""
LITTLE = 0.01
"""Share of a force that is next to nothing of it, and of samples that are few of them."""
AT_REST = "friction.at_rest"
"""Path of what break-away has above slow sliding ..."""
USUAL_AT_REST = 0.05
"""... and its usual share of friction: runs that begin far above it stick, and tell no slope."""
OFFSET = "mechanism.offset"
"""Path of a constant force: a balance has it as a term, and takes it off."""
UNSEEN = (
    "These runs cannot show whether friction depends on direction, an input, position or time, or"
    " differs between records, nor{} presliding: the intervals hold for friction on average."
)
"""What is not looked for."""


@dataclass(frozen=True, kw_only=True)
class BesideLaw(SetValuedLaw):
    """A law with friction beside it, of the speed and of what a gear transmits."""

    name: ClassVar[str] = "beside"
    title: ClassVar[str] = "Law with friction beside it, of speed and torque"
    formula: ClassVar[str] = r"F = F_0(|v|) + \delta(|v|, T)"
    sources: ClassVar[tuple[str, ...]] = ()

    law: FrictionLaw
    level: tuple[Number, ...]
    """Coefficients of Newton's polynomials [N]."""
    gear: tuple[Number, ...]
    """The same of what multiplies that which a gear transmits."""
    slowest: Annotated[float, Quantity("v", above=0)]
    fastest: Annotated[float, Quantity("v", above=0)]
    at_rest: Annotated[float, Quantity("F_s", "N", low=0)]
    """By how much the level of break-away is above friction of slow sliding."""

    def _beside(self, speed: Scalar) -> Scalar:
        x = place_of(speed, self.slowest, self.fastest)
        result = nested(self.level, x, AT)
        if self.gear:
            result = result + abs(self.contact(TRANSMITTED)) * nested(self.gear, x, AT)
        return result

    @property
    def _bound(self) -> Any:
        return bound(self.law, {name: self.contact(name) for name in self.law.inputs})

    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        return self._bound.sliding(speed, load) + self._beside(speed)

    def break_away(self, load: Scalar) -> Scalar:
        level = self._bound.break_away(load) + self._beside(0.0) + self.at_rest
        return where(level > 0.0, level, 0.0)


@cache
def _kind(inputs: tuple[str, ...]) -> type[BesideLaw]:
    """Return laws with friction beside them that see inputs of the contact."""
    return type("BesideLaw", (BesideLaw,), {"inputs": inputs})


@dataclass(frozen=True, kw_only=True, eq=False)
class Beside:
    """Friction beside a law, as values at knots.

    Attributes
    ----------
    slowest, fastest : float
        Range of the speeds that were seen [m/s].
    size : float
        Root mean square of the friction [N].
    transmitted : float
        What the gear transmits in the middle [N].
    geared : bool
        Whether that changes.
    """

    slowest: float
    fastest: float
    size: float
    transmitted: float = 0.0
    geared: bool = False

    @cached_property
    def speeds(self) -> Array:
        """Speeds of the knots (k,) [m/s]."""
        return np.asarray(np.exp(knots_of(AT, self.slowest, self.fastest)))

    @cached_property
    def waves(self) -> Array:
        """Coefficients of Newton's polynomials for values at the knots (k, k) [N]."""
        return np.asarray(self.size * np.linalg.inv(newton(AT, AT)))

    @cached_property
    def table(self) -> Array:
        """The same with those by what the gear transmits (m, m)."""
        sizes = [1.0, 1.0 / self.transmitted] if self.geared else [1.0]
        return np.asarray(np.kron(np.diag(sizes), self.waves), dtype=float)

    @cached_property
    def root(self) -> Array:
        """Root of the covariance of values at the knots, of a size of 1 (m, m)."""
        return np.kron(np.eye(1 + self.geared), np.linalg.cholesky(alike(np.log(self.speeds))))

    def curves(self, speed: Array, transmitted: Array | float) -> Array:
        """Return friction for values of 1 at each knot alone at speeds (n, m) [N]."""
        seen = np.minimum(speed, self.fastest)
        places = np.asarray(place_of(seen, self.slowest, self.fastest))
        own = newton(places, AT) @ self.waves
        if not self.geared:
            return np.asarray(own)
        share = np.abs(transmitted * np.ones(len(speed))) / self.transmitted
        return np.hstack([own, share[:, None] * own])

    def values(self, friction: Callable[[Array, float], Array]) -> Array:
        """Return friction of speeds and of what a gear transmits as values at the knots (m,)."""
        usual = friction(self.speeds, self.transmitted)
        if not self.geared:
            return np.asarray(usual / self.size)
        still = friction(self.speeds, 0.0)
        return np.concatenate([still, usual - still]) / self.size


def beside_law(law: FrictionLaw, records: Sequence[Record], load: float) -> Beside:
    """Return friction beside a law of speed alone under a load, for the speeds of records."""
    balance = Balance(records)
    speed = np.abs(np.concatenate([piece.velocity for piece in balance.pieces]))
    top = float(np.quantile(speed, QUICK))
    low = max(top / DECADES, float(np.quantile(speed, 1.0 - QUICK)))
    through = [x for x in map(through_gear, records) if x is not None]
    usual = float(np.median(np.abs(np.concatenate(through)))) if through else 0.0
    size = math.sqrt(float(np.mean(np.square(law.steady(np.geomspace(low, top, ASKED), load)))))
    geared = bool(balance.frame.transmitted)
    return Beside(slowest=low, fastest=top, size=size, transmitted=usual, geared=geared)


@dataclass(frozen=True, kw_only=True, eq=False)
class _WithPrior:
    """Residuals of runs, and rows of what is known before."""

    runs: Shooting
    given: Array
    """Values that were given (p,)."""
    sizes: Array
    """Deviations of their logarithms (p,); infinite of those without."""
    rows: Array
    """Unknowns about 0 over their deviations (m, p)."""
    deviation: float
    """Deviation of a reading that would be independent of others."""

    @property
    def free_parameters(self) -> FreeParameters:
        """What is looked for."""
        return self.runs.free_parameters

    def slopes(self, values: Array) -> Array:
        """Return how many deviations a unit of each value is (k, p)."""
        has_prior = np.isfinite(self.sizes)
        deviations = self.sizes[has_prior] * values[has_prior]
        return np.vstack([np.eye(len(values))[has_prior] / deviations[:, None], self.rows])

    def linearise(self, values: Array, near: ResidualJacobian | None = None) -> ResidualJacobian:
        """Return residuals at values (p,), with one row for each that is known before."""
        seen, has_prior = self.runs.linearise(values, near), np.isfinite(self.sizes)
        off = np.log(self.given[has_prior] / values[has_prior]) / self.sizes[has_prior]
        off = np.concatenate([off, -self.rows @ values])
        return ResidualJacobian(
            values=values,
            residual=np.concatenate([seen.residual, self.deviation * off]),
            slopes=lambda: np.vstack([seen.slopes, self.deviation * self.slopes(values)]),
            memory=seen.memory,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenRuns:
    """Runs that follow the readings, linear in what is unknown.

    Attributes
    ----------
    runs : Shooting
        The runs, with what is unknown.
    seen : ResidualJacobian
        They where they follow the readings best.
    given : Mapping of str to float
        Parameters of the mechanism as they were given, by path: what is looked for, then what is
        doubtful.
    share : float
        Share of the readings that count as independent.
    error : float
        Standard deviation of a reading.
    rows : array (m, p)
        Unknowns about 0 over their deviations before the runs.
    beside : Beside, optional
        Friction beside their law.
    doubts : Mapping of str to float
        Standard deviations of logarithms of what is doubtful, by path.
    """

    runs: Shooting
    seen: ResidualJacobian
    given: Mapping[str, float]
    share: float = 1.0
    error: float = 0.0
    rows: Array = field(default_factory=lambda: np.zeros((0, 0)))
    beside: Beside | None = None
    doubts: Mapping[str, float] = field(default_factory=dict)
    constants: tuple[str, ...] = ()
    """Paths of what is given of the rig and may be wrong, which is doubtful, too."""
    late: tuple[float, ...] = ()
    """Sizes of the delay of what drives the runs, which is doubtful, too [s]; none if none is."""

    @property
    def items(self) -> tuple[FreeParameter, ...]:
        """What is unknown."""
        return self.runs.free_parameters.items

    @property
    def sizes(self) -> Array:
        """Deviations of logarithms before the runs (p,); infinite of what has none."""
        known = [x.log and x.path in self.given for x in self.items]
        sizes = [self.doubts.get(x.path, PRIOR) for x in self.items]
        return np.where(known, sizes, math.inf)

    @property
    def sought(self) -> list[str]:
        """Paths of what is looked for of the mechanism."""
        return [path for path in self.given if path not in self.doubts]

    @property
    def values(self) -> dict[str, float]:
        """What was unknown as it fits best, by path."""
        return dict(zip([x.path for x in self.items], self.seen.values.tolist(), strict=True))

    @property
    def law(self) -> FrictionLaw:
        """The law that fits best."""
        of_law = {path: x for path, x in self.values.items() if path not in self.given}
        return vary(self.runs.law, "friction", of_law)

    @property
    def rig(self) -> dict[str, float]:
        """Parameters of the mechanism as they fit best, by path."""
        return {path: x for path, x in self.values.items() if path in self.given}

    def on(self, mechanism: Mechanism) -> Mechanism:
        """Return a mechanism with the values that fit best."""
        return vary(mechanism, "mechanism", {path: self.rig[path] for path in self.sought})

    @property
    def _known(self) -> _WithPrior:
        """The runs with what was given of the mechanism, for a deviation of 1."""
        given = np.array([self.given.get(item.path, 1.0) for item in self.items])
        late = [[(item.path == DELAY) / size for item in self.items] for size in self.late[-1:]]
        rows = np.array(late).reshape(-1, len(given))
        return _WithPrior(runs=self.runs, given=given, sizes=self.sizes, rows=rows, deviation=1.0)

    def begun(self) -> "DrivenRuns":
        """Return runs of what drives itself that start at the level which leaves least.

        A level decides at each rest whether the body breaks away, so that what is left has valleys.
        After some impacts a run depends so much on friction that there is a valley for each
        sequence of impacts, and the way down leads into the nearest. Before them there are few:
        levels are tried on the first part of the records there, and the best is followed while more
        is taken in.
        """
        runs, start = self.runs, self.runs.free_parameters.start
        least = _least_of(runs.shortened(SHARES[0]), (*LEVELS, float(start[0])))
        for share in SHARES:
            part = runs.shortened(share)
            least = part.linearise(least.values, least)
            if not least.finite:
                break
            prior = replace(self._known, runs=part, deviation=least.rms / math.sqrt(KAPPA))
            gain = 2.0 * SETTLED * prior.deviation**2
            end = improve(prior, least.values, rounds=4 * STEPS, least=gain, near=least)
            least = part.linearise(end.values, end)
        if least.finite:
            runs = runs.starting_from(least)
        runs = runs.with_free_parameters(runs.free_parameters.starting_at(least.values))
        return replace(self, runs=runs, seen=runs.linearise(runs.free_parameters.start))

    def moving(self) -> "DrivenRuns":
        """Return runs of a voltage that start at the share of the level which leaves least.

        A constant of a motor that is given too high or too low has a balance tell too high a level,
        at which the body hardly moves: what is left is flat there.
        """
        level = float(self.runs.free_parameters.start[0])
        least = _least_of(self.runs, [share * level for share in LOWER])
        runs = self.runs.with_free_parameters(self.runs.free_parameters.starting_at(least.values))
        return replace(self, runs=runs, seen=least)

    def settled(self, rows: Array | None = None, rounds: int = 1) -> "DrivenRuns":
        """Return the runs where they follow the readings best, with a prior of unknowns about 0."""
        best, share = self.seen, self.share
        known = self._known
        rows = known.rows if rows is None else np.vstack([known.rows, rows])
        known = replace(known, rows=rows)
        for _ in range(rounds):
            if not best.finite or not share:
                break
            deviation = best.rms / math.sqrt(share)
            prior = replace(known, deviation=deviation)
            least = 2.0 * SETTLED * deviation**2
            end = improve(prior, best.values, rounds=4 * STEPS, least=least, near=best)
            best = self.runs.linearise(end.values, end)
            slopes = prior.slopes(end.values)
            share = min(worth(best.slopes / best.rms, best.residual, slopes.T @ slopes), KAPPA)
        freedom = max(len(best.residual) - len(self.items), 1)
        error = math.sqrt(best.cost / freedom)
        return replace(self, seen=best, share=share, error=error, rows=rows)

    def surprise(self, deviation: float) -> float:
        """Return less the logarithm of the posterior, for a deviation of independent readings."""
        known = replace(self._known, rows=self.rows, deviation=deviation)
        return 0.5 * known.linearise(self.seen.values, self.seen).cost / deviation**2

    def moved(self, step: Array, rig: Array) -> "DrivenRuns":
        """Return runs with other values at the knots (m,), whose initial states follow them."""
        beside = self.beside
        assert beside is not None
        curve = self.seen.values[len(rig) :] + beside.table @ step
        return replace(self, seen=self.runs.linearise(np.concatenate([rig, curve]), self.seen))

    def of(self, law: FrictionLaw, x: Array, rig: Array) -> "DrivenRuns":
        """Return runs of a law with values at the knots beside it (m,), near these."""
        beside = self.beside
        assert beside is not None
        waves = (beside.table @ x).tolist()
        level = tuple(Number(value=c) for c in waves[:KNOTS])
        gear = tuple(Number(value=c) for c in waves[KNOTS:])
        inputs = dict.fromkeys((*law.inputs, *([TRANSMITTED] if gear else [])))
        known = zip([item.path for item in self.items], rig.tolist(), strict=False)
        curve = _kind(tuple(inputs))(
            law=law, level=level, gear=gear, slowest=beside.slowest, fastest=beside.fastest,
            at_rest=dict(known)[AT_REST],
        )  # fmt: skip
        of_rig = [item for item in self.items if item.path in self.given]
        own = [replace(item, start=at) for item, at in zip(of_rig, rig.tolist(), strict=True)]
        own += [
            FreeParameter(
                path=f"friction.{part}.{k}.value", quantity=Quantity("c"), start=c.value, size=size
            )
            for part, of_part, size in (
                ("level", level, beside.size),
                ("gear", gear, beside.size / (beside.transmitted or 1.0)),
            )
            for k, c in enumerate(of_part)
        ]
        runs = replace(self.runs.starting_from(self.seen), law=curve)
        runs = runs.with_free_parameters(FreeParameters(tuple(own)))
        return replace(self, runs=runs, seen=runs.linearise(runs.free_parameters.start))

    def beside_nothing(self, law: FrictionLaw, values: Mapping[str, float]) -> "DrivenRuns":
        """Return runs of a law with values of the mechanism by path, and no friction beside it."""
        assert self.beside is not None
        known = {**self.rig, OFFSET: values.get("offset", self.rig.get(OFFSET, 0.0)), **values}
        least = {item.path: item.low for item in self.items if item.path == AT_REST}
        rig = np.array([least.get(path, known[path]) for path in self.rig])
        result = self.of(law, np.zeros(len(self.beside.root)), rig)
        return replace(result, seen=result.runs.linearise(result.seen.values, result.seen))

    @property
    def drive(self) -> str:
        """What drives the runs, in words."""
        is_cut = any(segment.start for segment in self.runs.segments)
        return "the recorded voltage" if is_cut else "its own drive"

    def with_curve(self, beside: Beside) -> "DrivenRuns":
        """Return runs with friction beside the law where they follow the readings."""
        surplus = USUAL_AT_REST * beside.size
        item = FreeParameter(
            path=AT_REST, quantity=Quantity("F_s", "N", low=0), start=surplus, log=True,
            low=surplus / WIDE**2, high=WIDE * surplus,
        )  # fmt: skip
        of_rig = [x for x in self.items if x.path in self.given]
        first = replace(
            self, beside=beside,
            runs=self.runs.with_free_parameters(FreeParameters((*of_rig, item))),
            given={**self.given, AT_REST: surplus},
            doubts={**self.doubts, AT_REST: SPREADS["other"]},
        )  # fmt: skip
        rig = np.array([*self.rig.values(), surplus])
        rows = np.linalg.inv(SIZES[FOLLOWING] * beside.table @ beside.root)
        result = first.of(self.law, np.zeros(len(beside.root)), rig)
        result = result.settled(np.hstack([np.zeros((len(rows), len(rig))), rows]), ROUNDS)
        determined = tuple(path for path in self.constants if result._is_determined(path))
        sizes = {path: WRONG[-1 if path in determined else 0] for path in self.constants}
        result = replace(result, doubts={**result.doubts, **sizes}, constants=determined)
        return result.settled(result.rows[len(result.late) > 0 :], ROUNDS)

    def _is_determined(self, path: str) -> bool:
        """Return whether runs tell more of a constant than its prior, with others as given.

        What they do not is as given: in its units all else counts.
        """
        place = [item.path for item in self.items].index(path)
        left = np.sum(self.root(COEFFICIENT, path)[place] ** 2) / self.seen.values[place] ** 2
        return bool(2.0 * left < WRONG[-1] ** 2)

    def root(self, size: float = SIZES[FOLLOWING], doubted: str = "") -> Array:
        """Return a root of the covariance of what is unknown (p, p), with friction of a size.

        Constants of the rig are as given, but for what is doubted.
        """
        sizes = np.array(
            [
                WRONG[-1 if item.path == doubted else 0] if item.path in self.constants else size
                for item, size in zip(self.items, self.sizes.tolist(), strict=True)
            ]
        )
        has_prior, rows = np.isfinite(sizes), self.rows.copy()
        rows[len(self.late) > 0 :] *= SIZES[FOLLOWING] / size
        slopes = self.seen.slopes / self.error * math.sqrt(self.share)
        precision = slopes.T @ slopes + rows.T @ rows
        deviations = sizes[has_prior] * self.seen.values[has_prior]
        precision[has_prior, has_prior] += deviations**-2.0
        units = np.sqrt(np.diag(precision)) + 1e-300
        values, axes = np.linalg.eigh(precision / units / units[:, None])
        # what no run tells is known least, not exactly
        roots = np.sqrt(np.maximum(values, ROUNDING * values[-1]))
        return np.asarray(axes / roots / units[:, None], dtype=float)

    @property
    def assumed(self) -> list[str]:
        """Paths of what runs hardly tell beside any friction: its interval rests on the prior."""
        left = np.sqrt(np.sum(self.root(COEFFICIENT) ** 2, axis=1))
        before = self.sizes * np.maximum(np.abs(self.seen.values), 1e-300)
        return [path for path, x in zip(self.sought, left / before, strict=False) if x > MOST_LEFT]

    @property
    def alike(self) -> list[str]:
        """Sentences on what runs hardly tell."""
        if not (assumed := self.assumed):
            return []
        names = joined([path.rpartition(".")[2].replace("_", " ") for path in assumed])
        what, cure = "determined by the runs", ""
        if all(path.startswith("mechanism.drive.") for path in assumed):
            what = "distinguished from viscous friction"
            cure = ", or record swings with an open winding"
        return [
            f"The {names}{' together' * (len(assumed) > 1)} cannot be {what}: the intervals rest on"
            f" what is assumed about the values given. Fix one that is known{cure}."
        ]

    @property
    def is_followed(self) -> bool:
        """Whether runs follow the readings as closely as their noise allows.

        Else more than a curve of friction is missing, and the runs are linear about no truth.
        """
        third = np.concatenate([np.diff(item.measured, 3) for item in self.runs.segments])
        return self.error <= CLOSELY * float(np.std(third)) / math.sqrt(20.0)

    @property
    def sentence(self) -> str:
        """What is said of the values."""
        assumed = [*self.assumed, *[OFFSET] * (not self.is_followed)]
        names = [
            "the constant force" if path == OFFSET else f"the {parameter_words(path)}"
            for path in self.sought
            if path not in assumed
        ]
        determined = joined([*names, *["friction"] * (not assumed)])
        if self.is_followed:
            words = f"Runs of the mechanism under {self.drive} determine {determined}."
            return words if determined else ""
        of_gear = " with friction of a gear" * (self.beside is not None and self.beside.geared)
        by_both = (
            f"Runs of the mechanism{of_gear} determine {determined}; the force balance determines"
            " friction with these values."
        )
        return " ".join([*[by_both] * bool(names), *self.alike])

    def known(self, records: Sequence[Record]) -> list[Record]:
        """Return records whose parameters count from the values, with the covariance as prior.

        Of its root :math:`L` each column is what one of them, and others with it, changes by.
        """
        places = [k for k, path in enumerate(self.sought) if path != OFFSET]
        paths = [self.sought[k] for k in places]
        upper = np.linalg.qr(self.root()[places].T)[1]
        root = upper.T * np.sign(np.diag(upper))
        result = []
        for record in records:
            own = dict(record.unknown)
            for j, path in enumerate(paths):
                parts = [(root[i, j], record.unknown[other]) for i, other in enumerate(paths)]
                own[path] = replace(
                    record.unknown[path],
                    force=np.sum([share * item.force for share, item in parts], axis=0),
                    inertia=float(sum(share * item.inertia for share, item in parts)),
                    along=dict(zip(paths, root[:, j].tolist(), strict=True)),
                )
            result.append(replace(record, unknown=own))
        return result


def _least_of(runs: Shooting, levels: Sequence[float]) -> ResidualJacobian:
    """Return runs at the level that leaves least."""
    others = runs.free_parameters.start[1:]
    assert runs.free_parameters.items[0].path == "friction.kinetic_coefficient"
    tried = (runs.linearise(np.array([level, *others])) for level in levels)
    return min(tried, key=lambda seen: seen.cost)


def followed(
    mechanism: Mechanism,
    measurement: Measurement,
    unknown: Sequence[str],
    *,
    doubts: Mapping[str, float],
    offset: bool = True,
    hold: Hold | None = None,
) -> DrivenRuns | None:
    """Return runs that follow the readings; None where a balance tells what is unknown as well.

    That is so where a recorded force drives, or forces are linear in what is looked for, where a
    plain law has no friction, which is the scale of the rest, and where the body sticks. What runs
    do not tell apart, as resistance and torque constant under friction that is the same at any
    torque, is known as it was assumed about what was given. A constant force, with `offset`, is
    unknown beside all else where the body moves both ways: in one direction it is part of the
    level.
    """
    if not _is_run(mechanism, measurement, unknown):
        return None
    known = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    if any(known[path] <= 0.0 for path in doubts):
        return None
    start = _start_of(mechanism, measurement)
    constants = constants_of(mechanism, measurement, (*unknown, *doubts))
    if offset and OFFSET in known and OFFSET not in (*unknown, *doubts) and start.both_ways:
        unknown = (*unknown, OFFSET)
    named = (*unknown, *doubts, *constants)
    runs = _runs_of(mechanism, measurement, start, named, (*doubts, *constants), hold)
    late: tuple[float, ...] = ()
    if all(segment.loop is None for segment in runs.segments):
        step = max(interval_of(np.asarray(record.time)) for record in measurement.records())
        timed = TIMED if hold is not None or drives_itself(mechanism, measurement) else 1.0
        late = tuple(timed * step * x for x in SCALES[DELAY][0])
        item = FreeParameter(path=DELAY, quantity=Quantity("t", "s"), start=0.0)
        free = FreeParameters((*runs.free_parameters.items, item))
        runs = runs.with_free_parameters(free)
    # a plain law would have the rig stand for what it lacks
    own = drives_itself(mechanism, measurement)
    first = DrivenRuns(
        runs=runs,
        seen=runs.linearise(runs.free_parameters.start),
        given={path: known.get(path, 0.0) for path in (*named, DELAY)},
        doubts={path: math.log1p(doubt / known[path]) for path, doubt in doubts.items()}
        | dict.fromkeys(constants, WRONG[-1 if own else 0])
        | {DELAY: 0.0},
        constants=constants,
        late=late,
    )
    first = (first.begun() if own else first.moving()).settled()
    if not first.seen.finite or not first.share:
        return None
    rig = first.on(mechanism)
    records = records_of(rig, with_gear(rig, measurement))
    beside = beside_law(first.law, records, start.load)
    result = first.with_curve(beside) if beside.size > 0.0 else None
    return result if result is not None and result.seen.finite and result.share else None


def constants_of(
    mechanism: Mechanism, measurement: Measurement, known: Collection[str]
) -> tuple[str, ...]:
    """Return paths of what is given of a rig and may be wrong: its own numbers and its motor's.

    Their ranges begin at 0 and have no end, as those of masses, lengths, springs and constants of a
    motor: their logarithm has a prior, which says nothing of places, angles and shares. A load is
    part of the level, and gravity is known.
    """
    motor = None if motor_of(mechanism) is None else "drive"
    anew = {path for record in measurement.records() for path in record.overrides}
    return tuple(
        path
        for path, item, x in parameters(mechanism, "mechanism")
        for _, *within, name in [path.split(".")]
        if x > 0.0 and within in ([], [motor]) and name not in ("gravity", "load")
        and 0.0 in (item.low, item.above) and item.high == math.inf
        and path not in {*known, *anew, OFFSET}
    )  # fmt: skip


def _is_run(mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str]) -> bool:
    """Return whether runs may tell more than a balance: of what drives itself, or by a voltage."""
    if drives_itself(mechanism, measurement):
        return True
    if not unknown or motor_of(mechanism) is None:
        return False
    record = records_of(mechanism, measurement, unknown=unknown)[0]
    return any(column.bent for column in record.unknown.values())


@dataclass(frozen=True, kw_only=True)
class _Start:
    """A plain law as a balance has it."""

    level: float
    viscous: float
    """Viscous friction [N s/m]."""
    offset: float
    """A constant force beside that of the mechanism [N]."""
    size: float
    """Root mean square of what is not the constant force [N]."""
    speed: float
    """The fastest speed [m/s]."""
    load: float
    both_ways: bool
    """Whether the body moves in both directions."""


def _start_of(mechanism: Mechanism, measurement: Measurement) -> _Start:
    """Return a plain law from a balance."""
    records = records_of(mechanism, measurement)
    rows, friction, rig = plain_columns(records)
    back, ahead = (float(np.mean(side * rows.velocity > 0.0)) for side in (-1.0, 1.0))
    both_ways = min(back, ahead) > LITTLE
    table = np.column_stack([*friction, *rig])
    sizes = np.sqrt(np.mean(table**2, axis=0)) + 1e-300
    _, viscous, offset = (np.linalg.lstsq(table / sizes, rows.response, rcond=1e-9)[0] / sizes)[:3]
    load = load_of(mechanism) if records[0].load is None else float(np.median(records[0].load))
    if load <= 0.0:
        raise InputError(LIFTED)
    speed = float(np.quantile(np.abs(rows.velocity), QUICK))
    left = np.abs(rows.response - offset * both_ways)
    # where speeds hardly differ a level passes for a viscous part, and the other way round
    level = float(np.median(left[np.abs(rows.velocity) >= FAST * speed])) / load
    return _Start(
        level=level,
        viscous=min(float(viscous), FAST * level * load / speed),
        offset=float(offset),
        size=float(np.sqrt(np.mean(left**2))),
        speed=speed,
        load=load,
        both_ways=both_ways,
    )


def _runs_of(
    mechanism: Mechanism,
    measurement: Measurement,
    start: _Start,
    paths: Sequence[str],
    doubts: Collection[str],
    hold: Hold | None,
) -> Shooting:
    """Return runs of a plain law with parameters of the mechanism, from a balance."""
    size, load, speed = start.size, start.load, start.speed
    starts = {"kinetic_coefficient": start.level, "viscous_coefficient": start.viscous}
    least = {"kinetic_coefficient": LITTLE * size / load, "viscous_coefficient": 0.0}
    most = {"kinetic_coefficient": WIDE * size / load, "viscous_coefficient": WIDE * size / speed}
    kinds = fields_of(CoulombViscous)
    known = {path: (item, x) for path, item, x in parameters(mechanism, "mechanism")}
    items = [
        FreeParameter(
            path=f"friction.{name}", quantity=kinds[name], low=0.0, high=most[name],
            start=min(max(x, least[name]), most[name]),
        )
        for name, x in starts.items()
    ]  # fmt: skip
    for path in paths:
        item, x = known[path]
        x += start.offset * (path == OFFSET and start.both_ways)
        log, far = item.above is not None or path in doubts, WIDE * (size + abs(x))
        items.append(
            FreeParameter(
                path=path, quantity=item, start=x, log=log,
                low=x / WIDE if log else max(item.low, -far),
                high=WIDE * x if log else min(item.high, far),
            )
        )  # fmt: skip
    return Shooting(
        law=CoulombViscous(**{name: items[k].start for k, name in enumerate(starts)}),
        free_parameters=FreeParameters(tuple(items)),
        segments=segments_of(mechanism, measurement, hold=hold or "zero"),
        quantity=measured_quantity(measurement),
        steps=STEPS,
    )


class DrivenModel(Model):
    """Readings under a voltage, linear about runs that follow them.

    Unknown are friction at the knots, then what is looked for of the mechanism: logarithms of it,
    but where it may be 0.
    """

    signed = SIGNED

    def __init__(self, runs: DrivenRuns, plain: RecordProblem) -> None:
        assert runs.beside is not None
        self.runs, self.plain = runs, plain
        self.beside: Beside = runs.beside
        beside = runs.beside
        self.share, self.size = cache(self._share), cache(self._size)
        items = [item for item in runs.items if item.path in runs.given]
        self.paths = [item.path for item in items]
        self.logs = np.array([item.log for item in items], dtype=bool)
        count, seen = len(items), runs.seen
        rig, given = seen.values[:count], np.array([runs.given[path] for path in self.paths])
        at_given = self.logs | np.array([path == DELAY for path in self.paths])
        self.given: Array = np.where(at_given, given, rig)
        """Values from which what is looked for of the mechanism counts (p,)."""
        of_rig = seen.slopes[:, :count] * np.where(self.logs, rig, 1.0)
        slopes = np.hstack([seen.slopes[:, count:] @ beside.table, of_rig])
        law = runs.runs.law
        assert isinstance(law, BesideLaw)
        knots = np.linalg.solve(beside.table, seen.values[count:]) + self.at_knots(law.law)
        ratio = np.divide(rig, self.given, out=np.ones(count), where=self.logs)
        away = np.where(self.logs, np.log(ratio), rig - self.given)
        self.x: Array = np.concatenate([knots, away])
        """The unknowns about which runs are linear (m,) ..."""
        self.slopes: Array = slopes
        """... and their slopes there (n, m)."""
        table = np.column_stack([slopes, seen.residual + slopes @ self.x])
        self.gram = runs.share / runs.error**2 * table.T @ table
        self._rig_deviations: Array = np.where(self.logs, runs.sizes[:count], self._open(runs))
        wrong = OTHERWISE / max(len(runs.constants), 1)
        prior = (1.0 - wrong, 0.5 * wrong, 0.5 * wrong)
        self.scales = (
            Scale(name="curve", values=SIZES, prior=SIZE_PRIOR),
            *(Scale(name=path, values=WRONG, prior=prior) for path in runs.constants),
            *[Scale(name=DELAY, values=runs.late, prior=SCALES[DELAY][1])] * bool(runs.late),
        )

    def _open(self, runs: DrivenRuns) -> Array:
        """Return deviations (p,) of what may be 0, before the runs: `OPEN` times those after them.

        That is with friction of the largest size, and with what the runs alone tell of it, all
        else known, times `OPEN` cubed: the covariance exists whatever the runs do not tell.
        """
        k, count = len(self.beside.root), len(self.paths)
        alone = 1.0 / np.sqrt(np.maximum(np.diag(self.gram)[k:-1], 1e-300))
        before = np.where(self.logs, runs.sizes[:count], OPEN**3 * alone)
        turn = np.eye(k + count)
        turn[:k, :k] = SIZES[-1] * self.beside.root
        turn[k:, k:] *= before
        precision = turn.T @ self.gram[:-1, :-1] @ turn + np.eye(k + count)
        variances = np.diag(cho_solve(cho_factor(precision), np.eye(k + count)))[k:]
        return np.asarray(OPEN * before * np.sqrt(variances))

    def _deviations(self, node: Node) -> Array:
        """Return deviations of what is unknown of the rig before the runs (p,)."""
        result = self._rig_deviations.copy()
        for scale, k in zip(self.scales[1:], node[1:], strict=True):
            result[self.paths.index(scale.name)] = scale.values[k]
        return result

    def with_laws(self, own: Sequence[Structure]) -> "DrivenModel":
        """Return the same for laws that are no sums of parts."""
        result = copy.copy(self)
        result.signed, result.certain = self.signed | signed_of(own), certain_of(own)
        return result

    def settled(self, structure: Structure, node: Node) -> Structure:
        """Return a law of any form about the values that are likeliest at a node.

        Runs are linear in the curve, but the curve is not in the values.
        """
        law = next(name.own for name, _ in structure if is_slope(name))
        if not law.varied:
            return structure
        # what runs tell of a curve, without what no law says of it and the rig: both have priors
        k, deviations = len(self.beside.root), self._deviations(node)
        others = block_diag(self.root(node), np.diag(deviations))
        across = others.T @ self.gram[:-1]
        known = cho_factor(across[:, :-1] @ others + np.eye(len(others)))
        curve = self.gram[:k] - across[:, :k].T @ cho_solve(known, across)
        values, vectors = np.linalg.eigh(curve[:, :k])
        told = values > ROUNDED * values[-1]
        weights = (vectors[:, told] * np.sqrt(values[told])).T
        middle = vectors[:, told].T @ curve[:, -1] / np.sqrt(values[told])

        def left(x: Array) -> Array:
            return np.asarray(weights @ self.beside.values(partial(friction, x)) - middle)

        def friction(x: Array, speed: Array, transmitted: float) -> Array:
            return law.friction(x.tolist(), self.plain.slips(self._rows(speed, transmitted)))

        low, high = np.array([(max(q.low, q.above or q.low), q.high) for q in law.quantities]).T
        varied = zip(law.varied, law.values, strict=True)
        scale = np.array([law.sizes.get(name, abs(x)) for name, x in varied])
        start = np.clip(law.values, low + 1e-9 * scale, np.maximum(high - 1e-9 * scale, low))
        end = least_squares(left, start, bounds=(low, high), x_scale=np.maximum(scale, 1e-12))
        return law.structure(end.x.tolist())

    def at_knots(self, law: FrictionLaw) -> Array:
        """Return a law at the knots (m,)."""

        def friction(speed: Array, transmitted: float) -> Array:
            slips = self.plain.slips(self._rows(speed, transmitted))
            seen = bound(law, {TRANSMITTED: transmitted, **slips.inputs})
            return np.asarray(seen.steady(speed, slips.load) + 0.0 * speed)

        return self.beside.values(friction)

    def _rows(self, speed: Array, transmitted: float) -> SteadyRows:
        """Return steady sliding at speeds (n,) while a gear transmits."""
        return self.plain.at(speed, inputs={TRANSMITTED: transmitted})

    def _term(self, column: Column, speed: Array, transmitted: float) -> Array:
        """Return a term of a law at speeds (n,) while a gear transmits."""
        return self.plain.columns(column, self._rows(speed, transmitted))[0]

    def _share(self, column: Column) -> Array:
        """Return a term of a law at the knots (m,)."""
        return self.beside.values(partial(self._term, column))

    def _size(self, column: Column) -> float:
        """Return the coefficient with which a term alone would be friction of the usual size."""
        term = self._term(column, self.beside.speeds, self.beside.transmitted)
        most, name = math.inf, column[0]
        if is_slope(name) and name.place >= 0:
            most = MOST * name.own.sizes.get(name.own.varied[name.place], math.inf)
        return min(self.beside.size / (math.sqrt(float(np.mean(term**2))) + 1e-300), most)

    def root(self, node: Node) -> Array:
        """Return a root of the covariance of what no law says at the knots (m, m)."""
        return max(SIZES[node[0]], 1e-6) * self.beside.root

    def rig(self, draws: Sequence[Draws]) -> dict[str, Array]:
        """Return what is looked for of the mechanism (k,) in draws, by path."""
        away = np.hstack([draw.random[len(self.beside.root) :] for draw in draws])
        each = dict(zip(self.paths, self.rig_at(away.T).T, strict=True))
        return {path: each[path] for path in self.runs.sought}

    def rig_at(self, away: Array) -> Array:
        """Return what is looked for of the mechanism at its unknowns (..., p)."""
        return np.where(self.logs, self.given * np.exp(away), self.given + away)

    def system(self, node: Node, columns: Sequence[Column]) -> System:
        sizes = np.array([*map(self.size, columns)])
        deviations = np.concatenate([np.ones(len(self.beside.root)), self._deviations(node)])
        shares = [*map(self.share, columns)]
        return through_knots(self.gram, self.root(node), shares, sizes, deviations)


@dataclass(eq=False)
class DrivenProblem(Problem):
    """Records under a voltage with the posterior of runs.

    What is no curve, such as the noise of a reading of the force, is that of a force balance with
    what the runs say of the mechanism.

    Parameters
    ----------
    plain : RecordProblem
        That balance.
    following : DrivenRuns
        Runs that follow the readings, with friction beside a law.
    """

    plain: RecordProblem
    following: DrivenRuns

    def __post_init__(self) -> None:
        plain, beside = self.plain, self.following.beside
        assert beside is not None
        self.beside = beside
        self.records, self.size, self.load = plain.records, plain.size, plain.load
        self.runs, self.restricted = plain.runs, plain.restricted
        self.grid = Grid(slowest=self.beside.slowest, fastest=self.beside.fastest, fine=2.0)
        self.laws = [item for item in plain.model.families if item]
        self.own: tuple[Structure, ...] = ()
        self.posterior = self._judged(DrivenModel(self.following, plain))

    def _judged(self, model: DrivenModel) -> Posterior:
        laws = dict(laws_of(self.grid, [(), *self.laws]))
        others = range(1, len(model.scales))  # as given, and each alone far from that
        alone = [tuple((len(WRONG) - 1) * (j == k) for j in others) for k in (0, *others)]
        alone = alone[: 1 + len(model.runs.constants)]
        begin = [(k, *node) for k in (FOLLOWING, 0) for node in alone]
        return refined_shapes(model, laws | dict.fromkeys(self.own, 0.0), self.grid, begin)

    def with_laws(self, own: Sequence[Structure], families: Sequence[Family]) -> "DrivenProblem":
        result = copy.copy(self)
        result.restricted = True
        result.laws = [*dict.fromkeys(map(parts_of, families))]
        _, *rig = self.posterior.nodes[int(np.argmax(self.posterior.weights.sum(axis=1)))]
        nodes: list[Node] = [(0, *rig)] * len(own)
        for _ in range(ROUNDS):
            result.own = tuple(map(self.model.settled, own, nodes))
            result.posterior = result._judged(self.model.with_laws(result.own))
            before, nodes = nodes, [*map(result._likeliest, result.own)]
            if nodes == before:
                break
        return result

    def _likeliest(self, structure: Structure) -> Node:
        """Return the likeliest node of a law."""
        own = self.posterior.weights[:, self.posterior.structures.index(structure)]
        result: Node = self.posterior.nodes[int(np.argmax(own))]
        return result

    @property
    def model(self) -> DrivenModel:
        """The readings, linear about runs that follow them."""
        assert isinstance(self.posterior.model, DrivenModel)
        return self.posterior.model

    def straight(self) -> "tuple[float, DrivenRuns | None]":
        """Return what runs of what is likeliest leave, and these; None if what was linear is right.

        Where a line has led out of a valley, the runs are those that follow best from there.
        """
        model, weights = self.model, self.posterior.weights
        k, s = np.unravel_index(int(np.argmax(weights)), weights.shape)
        node, structure = self.posterior.nodes[k], self.posterior.structures[s]
        coefficients, random = self.posterior.estimate(node, structure)
        law = self.composition(structure, coefficients[None]).law()
        if law is None:
            return math.inf, None
        count = len(self.beside.root)
        x, away = model.root(node) @ random[:count], random[count:]
        seen, law_there = self.following.seen, model.at_knots(law)
        step = np.concatenate([x + law_there, away]) - model.x
        runs = self.following.moved(step[:count], model.rig_at(away))
        runs = runs.of(law, x, model.rig_at(away)) if runs.seen.finite else runs
        left = runs.seen.cost if runs.seen.finite else math.inf
        if left > OTHER * seen.cost and runs.seen.finite:
            runs = runs.settled(runs.rows[len(runs.late) > 0 :])
            deviation = self.following.error / math.sqrt(self.following.share)
            before, after = (x.surprise(deviation) for x in (self.following, runs))
            return left, runs if after < before - SETTLED else None
        foreseen = seen.residual - model.slopes @ step
        off = 0.5 * runs.share / runs.error**2 * abs(float(foreseen @ foreseen) - left)
        return left, runs if STRAIGHT <= off < math.inf else None

    # ---- rows -------------------------------------------------------------------------------

    def at(
        self, velocity: Any, load: Any = None, inputs: Mapping[str, Any] | None = None
    ) -> SteadyRows:
        return self.plain.at(velocity, load, inputs)

    def asked(self) -> SteadyRows:
        return self.at(self._speeds(ASKED))

    def places(self) -> SteadyRows:
        speeds, through = self._speeds(PLACES), self.plain.model.frame.transmitted or (0.0,)
        inputs = {TRANSMITTED: np.repeat(through, len(speeds))}
        return self.at(np.tile(speeds, len(through)), inputs=inputs)

    def curve_rows(self) -> SteadyRows:
        return self.at(np.geomspace(self.beside.slowest, self.beside.fastest, POINTS))

    def _speeds(self, count: int) -> Array:
        """Return speeds of both directions (n,): runs pass all of them."""
        speeds = np.geomspace(self.beside.slowest, self.beside.fastest, count)
        return np.concatenate([-speeds[::-1], speeds])

    def slips(self, rows: SteadyRows) -> Slips:
        return self.plain.slips(rows)

    def like(self, records: Sequence[Record]) -> OtherRows:
        """Return the rows of other records, which are another run."""
        return self.plain.like(records)

    def usual(self, rows: OtherRows) -> Array:
        return self.plain.usual(rows)

    @property
    def run_sizes(self) -> tuple[Sequence[float], Sequence[float]]:
        """By how much runs may differ, over friction, with the probabilities: no run tells it."""
        return RUNS, RUN_PRIOR

    # ---- laws -------------------------------------------------------------------------------

    def columns(self, column: tuple[str, Any], rows: SteadyRows) -> list[Array]:
        return self.plain.columns(column, rows)

    def candidates(self) -> list[Candidates]:
        laws: dict[Family, list[Structure]] = {}
        for structure in filter(None, self.posterior.structures):
            laws.setdefault(family_of(structure), []).append(structure)
        return [*itertools.starmap(candidates_of, laws.items())]

    def composition(
        self,
        structure: Shaped,
        coefficients: Array,
        draws: Sequence[Draws] | None = None,
        *,
        offset: bool = False,
    ) -> Composition:
        normal = np.full(len(coefficients), self.load)
        return composed_over(structure, coefficients, normal, self.plain.usual_inputs)

    # ---- weights ----------------------------------------------------------------------------

    def is_small(self, tolerance: float) -> "NDArray[np.bool_]":
        return np.array([SIZES[node[0]] <= tolerance for node in self.posterior.nodes])

    def is_alone(self, draw: Draws) -> bool:
        return not SIZES[draw.node[0]]

    # ---- curves -----------------------------------------------------------------------------

    def steady(self, rows: SteadyRows, draws: Sequence[Draws]) -> Array:
        through = np.asarray(rows.transmitted) * rows.ratio
        beside = self.beside.curves(np.abs(rows.velocity), through)
        beside = np.sign(rows.velocity)[:, None] * beside
        curves = list[Array]()
        for draw in draws:
            random = self.model.root(draw.node) @ draw.random[: beside.shape[1]]
            curves.append((self.design(draw.structure, rows) @ draw.law + beside @ random).T)
        return np.vstack(curves)

    def friction(self, rows: SteadyRows, draws: Sequence[Draws], *, new: bool = False) -> Array:
        curves, low, top = self.steady(rows, draws), self.beside.slowest, self.beside.fastest
        speed = np.maximum(np.abs(rows.velocity), 1e-3 * low)
        apart = np.maximum(np.maximum(np.log(low / speed), np.log(speed / top)), 0.0)
        unseen = np.random.default_rng(5).normal(size=(len(curves), 1)) * BELOW * self.size
        curves += unseen * apart * np.sign(rows.velocity)
        if not new:
            return curves
        rng = np.random.default_rng(7)
        sizes = rng.choice(RUNS, p=RUN_PRIOR, size=(len(curves), 1))
        return np.asarray(curves * (1.0 + sizes * rng.normal(size=(len(curves), 1))))

    def readings(self, rows: SteadyRows | OtherRows, draws: Sequence[Draws]) -> Array:
        if isinstance(rows, OtherRows):  # forces along other records are those of the balance
            return self.plain.readings(rows, self.plain.posterior.draws(DRAWS))
        curves = self.friction(rows, draws, new=True)
        noise = np.random.default_rng(11).normal(size=curves.shape)
        return np.asarray(curves + self.plain.noise(rows) * noise)

    # ---- what leaves ------------------------------------------------------------------------

    def rig(self, draws: Sequence[Draws]) -> dict[str, Array]:
        result = self.model.rig(draws)
        if OFFSET in result:
            result[self.plain.offset or OFFSET] = result.pop(OFFSET)
        return result

    def findings(self, draws: Sequence[Draws]) -> list[Finding]:
        result = []
        away = np.hstack([draw.random[len(self.beside.root) :] for draw in draws])
        for path in self.following.constants:
            factor = np.exp(away[self.model.paths.index(path)])
            ends = [quantity(x, "", 3) for x in np.quantile(factor, (0.5, 0.025, 0.975)).tolist()]
            name = parameter_words(path)
            # another fault of the rig may pass for it
            what = "Runs follow the record with the {} at {} times what was given ({} to {})."
            what = what.format(name, *ends)
            likely = float(np.mean(np.abs(factor - 1.0) > NEGLIGIBLE))
            title = f"{name} larger or smaller than given"
            result.append(stated(f"{name}_given", title, likely, factor - 1.0, what))
        return result

    def points(self, rung: Rung) -> MeasuredPoints:
        return self.plain.points(rung, apart=True)  # a balance has no friction at a turn

    def scatter(self, rung: Rung) -> float:
        rows = self.asked()
        middle = np.mean(self.steady(rows, self.posterior.draws(DRAWS)), axis=0)
        off = middle - self.design(rung.structure, rows) @ rung.coefficients
        return math.hypot(self.plain.noise_of_rows, math.sqrt(float(np.mean(off**2))))

    def untold(self) -> list[str]:
        constant = " a constant force or" * (OFFSET not in self.following.sought)
        return [UNSEEN.format(constant), *self.following.alike]
