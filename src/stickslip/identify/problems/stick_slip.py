r"""Stick-slip of a block that a spring pulls, as a simulated measurement of its features.

Rows are logarithms of frequency, mean and scatter of the force over the load, for stretches of
whole cycles of each record (`slip_features`), in units of how stretches of that record scatter
together: with the covariance :math:`C = L L^T` of stretches, rows are :math:`L^{-1} \ln y`. A law
predicts the same for all stretches of a record: the features of its limit cycle (`limit_cycles`).

Priors, with the mean force over the load :math:`\mu`, scatter :math:`s` and the speed
:math:`v = V + 2 s N/\sqrt{k m}` of a slip:

    ln level ~ N(ln mu, .5)             ln surplus ~ N(ln s, 1.2)
    ln speed ~ N(ln v, 1.5)             slope = mu N/v max(z, 0), z ~ N(0, .5)
    ln mass ~ N(ln as stated, .05)      ln stiffness ~ N(ln as stated, .1)

A body is weighed, but what holds the spring swings with it; springs are calibrated, but what holds
them gives way: slopes of a public slider between slips are 4 to 9 % off as its springs are given.
What is stated of the machine replaces these deviations. Where several records are given, the
machine is the same in all. A block sticks and slips as friction falls, at once or with the speed:
laws of either kind are together as probable as those of the other.

Of a record of steady sliding the rows are the logarithm of the mean, and the scatter over the mean,
which is 0 to 1 %.

Beside every law there always are, in logarithms of the features (of the scatter twice that),

* what the law lacks, alike in all records: .005, .015 or .05 (.45 .35 .2);
* as much for each e-fold of :math:`V \sqrt{k m}/N`, by which settings differ;
* what differs from run to run of one setting, of the same sizes, of which several records tell the
  one. One record is its own run, and other runs are predicted with it.

Laws of friction are right to some per cent, and never better than half of one.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip.friction import FrictionLaw
from stickslip.identify.bands import Array
from stickslip.identify.fits import Estimate
from stickslip.identify.posterior import Places
from stickslip.identify.problems.limit_cycles import limit_cycles
from stickslip.identify.problems.slip_features import COMPARED, READ, StickSlipFeatures
from stickslip.identify.simulated import (
    UNTOLD,
    Always,
    FamilyPosterior,
    Simulated,
    Unknowns,
)
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import TowedBlock
from stickslip.quantities import Quantity, fields_of, parameters
from stickslip.quantities import vary as with_values

MASS, STIFFNESS = "mechanism.mass", "mechanism.stiffness"
DOUBTS = {MASS: 0.05, STIFFNESS: 0.1}
"""Prior deviations of logarithms of what nobody states an uncertainty of: see above."""
SPREADS = {"level": 0.5, "surplus": 1.2, "speed": 1.5, "slope": 0.5, "other": 1.5}
"""Prior deviations of coordinates of laws: see above."""
LACKS = ((0.005, 0.45), (0.015, 0.35), (0.05, 0.2))
"""Sizes of what laws lack and of what differs from run to run, with their probability."""
ALIKE = "other values give the same features"
"""Why a parameter is not bounded."""
SHARES = np.array([1.0, 1.0, 2.0])
"""Sizes for frequency, mean and scatter over these: scatter is a difference of levels."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Setting:
    """A record: the block as it was set, and the features."""

    block: TowedBlock
    features: StickSlipFeatures

    @property
    def slides(self) -> bool:
        """Whether the block slides steadily: then frequency and scatter have no logarithms."""
        return self.features.regime == "steady sliding"

    @property
    def lacking(self) -> Array:
        """What features change in rows (r, 3) by a unit of what laws lack."""
        every = np.diag(SHARES)
        return np.array([every[1], np.zeros(3)]) if self.slides else every

    def rows(self, features: Array) -> Array:
        """Return features (k, 3) as rows (k, r): logarithms, or those of mean, and the scatter.

        They are NaN for a block that slides steadily, unless that was measured.
        """
        _, mean, scatter = features.T
        if self.slides:
            return np.column_stack([np.log(mean), scatter / mean])
        return np.log(np.where(features > 0.0, features, np.nan))

    @property
    def stretches(self) -> Array:
        """Rows of stretches (s, r)."""
        return self.rows(np.exp(self.features.stretches))

    @property
    def centre(self) -> Array:
        """Means of rows (r,)."""
        return np.asarray(self.stretches.mean(axis=0))

    @property
    def covariance(self) -> Array:
        """Covariance of rows of stretches (r, r), which are read to a share at best."""
        read = [READ, THRESHOLDS.pattern] if self.slides else [READ] * 3
        return np.asarray(np.cov(self.stretches.T) + np.diag(np.square(read)))


@dataclass(frozen=True, kw_only=True, eq=False)
class PulledLaw:
    """A law that is compared: with values of what is held, and what is looked for."""

    law: FrictionLaw
    free: tuple[str, ...]
    """Paths of its parameters that are looked for."""
    given: bool = False
    """Whether its values were given: a search begins there, too."""
    title: str = ""

    @property
    def quantities(self) -> Mapping[str, Quantity]:
        """What its parameters are, by path."""
        return {f"friction.{name}": one for name, one in fields_of(type(self.law)).items()}

    def above(self, path: str) -> str:
        """Return the path of the parameter that one does not fall below; empty without one."""
        base = self.quantities[path].at_least
        return "" if base is None else f"friction.{base}"

    def kind(self, path: str) -> str:
        """Return what the prior of a parameter goes by."""
        one = self.quantities[path]
        if one.at_least is not None:
            return "surplus"
        scale = "level" if one.scale == "force" else one.scale.rstrip("+-")
        return scale if scale in SPREADS else "other"


class StickSlip(Simulated):
    """Features of stretches of records, in units of how they scatter.

    Parameters
    ----------
    block : TowedBlock
        The block as it is stated.
    settings : sequence of Setting
        The records.
    laws : mapping of str to PulledLaw
        What is compared.
    doubts : mapping of str to float
        Prior deviations of logarithms of parameters of the block, by path.
    """

    places, proposed = 150, 1200
    """Three features leave a ridge of values; runs take 30 us."""
    no_run = "no run has a limit cycle: check the mass, stiffness and speed of the block"

    def __init__(
        self,
        block: TowedBlock,
        settings: Sequence[Setting],
        laws: Mapping[str, PulledLaw],
        doubts: Mapping[str, float],
    ) -> None:
        self.block, self.settings, self.laws = block, settings, laws
        self.doubts = {path: doubt for path, doubt in doubts.items() if doubt > 0.0}
        self._stated = {path: value for path, _, value in parameters(block, "mechanism")}
        self._roots = [np.linalg.inv(np.linalg.cholesky(one.covariance)) for one in settings]
        self._counts = [len(one.features.stretches) for one in settings]
        self.measured = np.concatenate([
            (root @ (one.stretches - one.centre).T).ravel()
            for one, root in zip(settings, self._roots, strict=True)
        ])  # fmt: skip
        self.weights = np.ones(len(self.measured))
        logs = [one.features.stretches.mean(axis=0) for one in settings if not one.slides]
        _, self.mean, self.scatter = np.exp(np.mean(logs, axis=0)).tolist()
        self.middle = float(np.mean([_speed_of(one.block) for one in settings]))
        first = self.first.block
        self.slip = first.speed + 2.0 * self.scatter * first.steady_load / math.sqrt(
            first.stiffness * first.mass
        )
        self.always = self._always()
        least = min(len(one.free) for one in laws.values())
        simple = [name for name, one in laws.items() if len(one.free) == least]
        stages = simple, [name for name in laws if name not in simple]
        self.stages = tuple(stage for stage in stages if stage)

    @property
    def first(self) -> Setting:
        """The first record of stick-slip."""
        return next(one for one in self.settings if not one.slides)

    def _always(self) -> Always:
        several = len(self.settings) > 1
        blocks = []
        for k, (one, root) in enumerate(zip(self.settings, self._roots, strict=True)):
            own = np.zeros((len(one.lacking), 3 * len(self.settings)))
            own[:, 3 * k : 3 * k + 3] = one.lacking
            lacks = one.lacking, (_speed_of(one.block) - self.middle) * one.lacking
            rows = root @ np.hstack([*lacks, *([own] if several else [])])
            blocks.append(np.repeat(rows, self._counts[k], axis=0))
        sizes, chances, self.runs = list[list[float]](), list[float](), list[float]()
        for size, chance in LACKS:
            for run, also in LACKS if several else [(0.0, 1.0)]:
                each = [run] * (3 * len(self.settings) * several)
                sizes.append([*[size] * 6, *each])
                chances.append(chance * also)
                self.runs.append(run)
        return Always(
            columns=np.concatenate(blocks), sizes=np.array(sizes), prior=np.array(chances)
        )

    def prior(self, family: str) -> float:
        falls = [self._falls(name) for name in self.laws]
        return -math.log(falls.count(self._falls(family)))

    def _falls(self, family: str) -> bool:
        """Return whether friction of a family falls with the speed."""
        law = self.laws[family]
        return any(law.kind(path) == "speed" for path in law.quantities)

    # ------------------------------------------------------------------ coordinates
    def _coordinate(self, family: str, path: str) -> tuple[float, float]:
        """Return the prior mean and the deviation of a coordinate."""
        if path in self.doubts:
            return math.log(self._stated[path]), self.doubts[path]
        law = self.laws[family]
        kind = law.kind(path)
        scale = law.quantities[path].scale
        unit = self.block.steady_load if scale == "force" else 1.0
        middles = {"level": self.mean, "surplus": self.scatter, "speed": self.slip, "slope": 1.0}
        middle = middles.get(kind, 0.0) * unit
        if kind == "other":
            middle = abs(self._held(family, path))
        return (0.0 if kind == "slope" else math.log(middle)), SPREADS[kind]

    def _held(self, family: str, path: str) -> float:
        name = path.partition(".")[2]
        return float(getattr(self.laws[family].law, name) or 0.0)

    @property
    def _steep(self) -> float:
        return float(self.mean * self.block.steady_load / self.slip)

    def paths(self, family: str) -> tuple[str, ...]:
        """Return the paths of what is unknown of a family: those of the law, then the block's."""
        return (*self.laws[family].free, *self.doubts)

    def vary(self, family: str) -> Unknowns:
        numbers = np.array([self._coordinate(family, path) for path in self.paths(family)])
        numbers = numbers.reshape(-1, 2)
        return Unknowns(names=self.paths(family), mean=numbers[:, 0], deviation=numbers[:, 1])

    def values(self, family: str, points: Array) -> dict[str, Array]:
        """Return values (k,) by path, SI, at points (k, p); of the block those of `block`."""
        law, found = self.laws[family], dict[str, Array]()
        for path, x in zip(self.paths(family), points.T, strict=True):
            slope = path not in self.doubts and law.kind(path) == "slope"
            found[path] = self._steep * np.maximum(x, 0.0) if slope else np.exp(np.minimum(x, 50.0))
        for path in law.free:
            if above := law.above(path):
                found[path] = found[path] + found.get(above, self._held(family, above))
        return found

    def _point(self, family: str, values: Mapping[str, float]) -> Array:
        """Return the point (p,) with some values, and the prior's for the others."""
        law, point = self.laws[family], []
        for path in self.paths(family):
            x = values.get(path)
            kind = "log" if path in self.doubts else law.kind(path)
            if x is not None and kind == "surplus":
                x = x - values.get(law.above(path), self._held(family, law.above(path)))
            if kind == "slope":
                point.append(0.01 if x is None else max(x / self._steep, 0.01))
            elif x is None or x <= 0.0:
                point.append(self._coordinate(family, path)[0])
            else:
                point.append(math.log(x))
        return np.array(point)

    def starts(self, family: str, ends: Mapping[str, Array]) -> Array:
        law, first = self.laws[family], self.first
        swing = first.features.frequency * 2.0 * math.pi
        block = first.block
        rigid = block.speed * math.sqrt(block.stiffness * block.mass) / block.steady_load
        swung = math.sqrt(max(2.0 * self.scatter**2 - rigid**2, 0.01 * self.scatter**2))
        surpluses = {1.7 * self.scatter, 0.3 * self.scatter, swung}
        machines: list[dict[str, float]] = [{}]
        if self.doubts.get(MASS, 0.0) > DOUBTS[MASS]:
            machines.append({MASS: block.stiffness / swing**2})
        tried: list[dict[str, float]] = []
        for machine in machines:
            for surplus in sorted(surpluses):
                levels = {path: self.mean for path in law.free if law.kind(path) == "level"}
                above = {
                    path: self.mean + surplus for path in law.free if law.kind(path) == "surplus"
                }
                for share in (0.3, 3.0):
                    speeds = {
                        path: share * self.slip for path in law.free if law.kind(path) == "speed"
                    }
                    tried.append({**levels, **above, **speeds, **machine})
        for name, end in ends.items():
            values = {path: float(x[0]) for path, x in self.values(name, end[None]).items()}
            tried.append({path: x for path, x in values.items() if path in self.paths(family)})
        if law.given:
            tried.append({path: self._held(family, path) for path in law.free})
        return np.unique([self._point(family, one) for one in tried], axis=0)

    # ------------------------------------------------------------------ runs
    def cycles(self, family: str, points: Array, blocks: Sequence[TowedBlock]) -> Array:
        """Return frequency, mean and scatter (k, b, 3) of limit cycles of blocks as set."""
        values, count, several = self.values(family, points), len(points), len(blocks)
        rows = {path: np.repeat(x, several) for path, x in values.items()}
        for path in ("mass", "stiffness", "speed", "damping"):
            own = f"mechanism.{path}"
            stated = np.tile([float(getattr(one, path)) for one in blocks], count)
            ratio = 1.0 if own not in rows else rows[own] / self._stated[own]
            rows[own] = stated * ratio
        rows["mechanism.load"] = np.tile([one.steady_load for one in blocks], count)
        period = np.tile([self._period(one) for one in blocks], count)
        found = limit_cycles(self.block, self.laws[family].law, rows, period)
        return np.asarray(found.reshape(count, several, 3))

    def _period(self, block: TowedBlock) -> float:
        """Return a guess of the period of a block [s]: that of a swing, and the time it sticks."""
        for one in self.settings:
            if one.block == block and not one.slides:
                return 1.0 / one.features.frequency
        natural = 2.0 * math.pi * math.sqrt(block.mass / block.stiffness)
        sticks = 4.0 * self.scatter * block.steady_load / (block.stiffness * block.speed)
        return float(natural + sticks)

    def simulate(self, asked: Mapping[str, Array]) -> dict[str, Array]:
        blocks, found = [one.block for one in self.settings], dict[str, Array]()
        for family, points in asked.items():
            features = self.cycles(family, points, blocks)
            parts = []
            for k, (one, root) in enumerate(zip(self.settings, self._roots, strict=True)):
                own = root @ (one.rows(features[:, k]) - one.centre).T
                parts.append(np.repeat(own, self._counts[k], axis=0))
            rows = np.concatenate(parts)
            found[family] = np.where(np.isfinite(rows), rows, np.nan)
        return found

    # ------------------------------------------------------------------ results
    def title(self, family: str) -> str:
        return self.laws[family].law.title

    def sought(self, family: str) -> tuple[str, ...]:
        return self.paths(family)

    def quantities(self, family: str) -> Mapping[str, Quantity]:
        own = {path: one for path, one, _ in parameters(self.block, "mechanism")}
        return {**own, **self.laws[family].quantities}

    def read(self, family: str, points: Array, coefficients: Array) -> dict[str, Array]:
        return self.values(family, points)

    def result(self, family: str, values: Mapping[str, float]) -> tuple[FrictionLaw, TowedBlock]:
        own = {path: x for path, x in values.items() if path.startswith("mechanism.")}
        others = {path: x for path, x in values.items() if path not in own}
        block = replace(self.block, load=self.block.steady_load)
        law = with_values(self.laws[family].law, "friction", others)
        return law, with_values(block, "mechanism", own)

    def told(
        self, family: FamilyPosterior, name: str, estimates: Sequence[Estimate]
    ) -> list[Estimate]:
        found = []
        for one in estimates:
            untold = one.path not in self.doubts and self._is_prior(family, name, one.path)
            open_ = {"low": -math.inf, "high": math.inf, "reason": ALIKE} if untold else {}
            found.append(replace(one, **open_))
        return found

    def _is_prior(self, family: FamilyPosterior, name: str, path: str) -> bool:
        """Whether draws are as wide as the prior; of a level above another, as that of levels."""
        if self.laws[name].kind(path) != "surplus":
            return family.is_prior(path)
        draws = np.log(self.values(name, family.points)[path])
        return float(np.std(draws)) > UNTOLD * SPREADS["level"]

    def modes(self, family: FamilyPosterior, name: str) -> Array:
        """Return frequency, mean and scatter (r, 3) of the likeliest limit cycle in each record."""
        blocks = [one.block for one in self.settings]
        return np.asarray(self.cycles(name, family.mode[None], blocks)[0])

    def errors(self, family: FamilyPosterior, name: str) -> dict[str, float]:
        """Return relative errors of the features, root mean squares with the sign of the mean."""
        off = np.array([
            one.rows(features[None])[0] - one.centre
            for one, features in zip(self.settings, self.modes(family, name), strict=True)
            if not one.slides
        ])  # fmt: skip
        errors = np.sqrt(np.mean(np.expm1(off) ** 2, axis=0)) * np.sign(off.sum(axis=0) + 1e-300)
        return dict(zip(COMPARED, errors.tolist(), strict=True))

    def leaves(self, family: FamilyPosterior, name: str) -> float:
        return float(np.sqrt(np.mean(np.square([*self.errors(family, name).values()]))))

    def foreseen(
        self, name: str, family: FamilyPosterior, blocks: Sequence[TowedBlock], which: Places
    ) -> Array:
        """Return some draws of features (k, b, 3) of another run at settings.

        Frequency and scatter are 0 where a block slides steadily.
        """
        rng = np.random.default_rng(0)
        features = self.cycles(name, family.points[which], blocks)
        lacks, slopes = family.coefficients[which, :3], family.coefficients[which, 3:6]
        away = np.array([_speed_of(one) for one in blocks]) - self.middle
        logs = lacks[:, None] + away[None, :, None] * slopes[:, None]
        runs = np.array(self.runs)[family.sets[which]]
        sizes, chances = np.array(LACKS).T
        runs = np.where(runs > 0.0, runs, rng.choice(sizes, len(runs), p=chances))
        logs = logs + runs[:, None, None] * rng.normal(size=logs.shape)
        return np.asarray(features * np.exp(SHARES * logs))


def _speed_of(block: TowedBlock) -> float:
    """Return the logarithm of the speed by which settings differ."""
    return math.log(block.speed * math.sqrt(block.stiffness * block.mass) / block.steady_load)
