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
from dataclasses import dataclass

import numpy as np

from stickslip.identify.bands import Array
from stickslip.identify.posterior import Places
from stickslip.identify.problems.limit_cycles import limit_cycles
from stickslip.identify.problems.run_laws import LawRuns, RunLaw
from stickslip.identify.problems.slip_features import COMPARED, READ, StickSlipFeatures
from stickslip.identify.simulated import Always, FamilyPosterior
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import TowedBlock

MASS, STIFFNESS = "mechanism.mass", "mechanism.stiffness"
DOUBTS = {MASS: 0.05, STIFFNESS: 0.1}
"""Prior deviations of logarithms of what nobody states an uncertainty of: see above."""
LACKS = ((0.005, 0.45), (0.015, 0.35), (0.05, 0.2))
"""Sizes of what laws lack and of what differs from run to run, with their probability."""
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


class StickSlip(LawRuns):
    """Features of stretches of records, in units of how they scatter.

    Parameters
    ----------
    block : TowedBlock
        The block as it is stated.
    settings : sequence of Setting
        The records.
    laws : mapping of str to RunLaw
        What is compared.
    doubts : mapping of str to float
        Prior deviations of logarithms of parameters of the block, by path.
    """

    places, proposed = 150, 1200
    """Three features leave a ridge of values; runs take 30 us."""
    alike = "other values give the same features"
    no_run = "no run has a limit cycle: check the mass, stiffness and speed of the block"

    def __init__(
        self,
        block: TowedBlock,
        settings: Sequence[Setting],
        laws: Mapping[str, RunLaw],
        doubts: Mapping[str, float],
    ) -> None:
        self.settings = settings
        logs = [
            setting.features.stretches.mean(axis=0) for setting in settings if not setting.slides
        ]
        _, mean, scatter = np.exp(np.mean(logs, axis=0)).tolist()
        first = self.first.block
        slip = first.speed + 2.0 * scatter * first.steady_load / math.sqrt(
            first.stiffness * first.mass
        )
        load = block.steady_load
        super().__init__(
            block,
            laws,
            doubts,
            sizes={"level": mean, "surplus": scatter, "speed": slip, "slope": mean * load / slip},
            load=load,
        )
        self._roots = [
            np.linalg.inv(np.linalg.cholesky(setting.covariance)) for setting in settings
        ]
        self._counts = [len(setting.features.stretches) for setting in settings]
        self.measured = np.concatenate([
            (root @ (setting.stretches - setting.centre).T).ravel()
            for setting, root in zip(settings, self._roots, strict=True)
        ])  # fmt: skip
        self.weights = np.ones(len(self.measured))
        self.middle = float(np.mean([_speed_of(setting.block) for setting in settings]))
        self.always = self._always()

    @property
    def first(self) -> Setting:
        """The first record of stick-slip."""
        return next(setting for setting in self.settings if not setting.slides)

    def _always(self) -> Always:
        several = len(self.settings) > 1
        blocks = []
        for k, (setting, root) in enumerate(zip(self.settings, self._roots, strict=True)):
            own = np.zeros((len(setting.lacking), 3 * len(self.settings)))
            own[:, 3 * k : 3 * k + 3] = setting.lacking
            lacks = setting.lacking, (_speed_of(setting.block) - self.middle) * setting.lacking
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

    def tried(self, family: str) -> list[dict[str, float]]:
        law, first, tried = self.laws[family], self.first, list[dict[str, float]]()
        mean, scatter = self.sizes["level"], self.sizes["surplus"]
        swing = first.features.frequency * 2.0 * math.pi
        block = first.block
        rigid = block.speed * math.sqrt(block.stiffness * block.mass) / block.steady_load
        swung = math.sqrt(max(2.0 * scatter**2 - rigid**2, 0.01 * scatter**2))
        machines: list[dict[str, float]] = [{}]
        if self.doubts.get(MASS, 0.0) > DOUBTS[MASS]:
            machines.append({MASS: block.stiffness / swing**2})
        for machine in machines:
            for surplus in sorted({1.7 * scatter, 0.3 * scatter, swung}):
                levels = {path: mean for path in law.free if law.kind(path) == "level"}
                above = {path: mean + surplus for path in law.free if law.kind(path) == "surplus"}
                for share in (0.3, 3.0):
                    speeds = {
                        path: share * self.sizes["speed"]
                        for path in law.free if law.kind(path) == "speed"
                    }  # fmt: skip
                    tried.append({**levels, **above, **speeds, **machine})
        return tried

    # ------------------------------------------------------------------ runs
    def cycles(self, family: str, points: Array, blocks: Sequence[TowedBlock]) -> Array:
        """Return frequency, mean and scatter (k, b, 3) of limit cycles of blocks as set."""
        values, count, several = self.values(family, points), len(points), len(blocks)
        rows = {path: np.repeat(x, several) for path, x in values.items()}
        for path in ("mass", "stiffness", "speed", "damping"):
            own = f"mechanism.{path}"
            stated = np.tile([float(getattr(block, path)) for block in blocks], count)
            ratio = 1.0 if own not in rows else rows[own] / self.given[own]
            rows[own] = stated * ratio
        rows["mechanism.load"] = np.tile([block.steady_load for block in blocks], count)
        period = np.tile([self._period(block) for block in blocks], count)
        result = limit_cycles(self.mechanism, self.laws[family].law, rows, period)
        return np.asarray(result.reshape(count, several, 3))

    def _period(self, block: TowedBlock) -> float:
        """Return a guess of the period of a block [s]: that of a swing, and the time it sticks."""
        for setting in self.settings:
            if setting.block == block and not setting.slides:
                return 1.0 / setting.features.frequency
        natural = 2.0 * math.pi * math.sqrt(block.mass / block.stiffness)
        sticks = 4.0 * self.sizes["surplus"] * block.steady_load / (block.stiffness * block.speed)
        return float(natural + sticks)

    def simulate(self, asked: Mapping[str, Array]) -> dict[str, Array]:
        blocks, result = [setting.block for setting in self.settings], dict[str, Array]()
        for family, points in asked.items():
            features = self.cycles(family, points, blocks)
            parts = []
            for k, (setting, root) in enumerate(zip(self.settings, self._roots, strict=True)):
                own = root @ (setting.rows(features[:, k]) - setting.centre).T
                parts.append(np.repeat(own, self._counts[k], axis=0))
            rows = np.concatenate(parts)
            result[family] = np.where(np.isfinite(rows), rows, np.nan)
        return result

    # ------------------------------------------------------------------ results
    def modes(self, family: FamilyPosterior, name: str) -> Array:
        """Return frequency, mean and scatter (r, 3) of the likeliest limit cycle in each record."""
        blocks = [setting.block for setting in self.settings]
        return np.asarray(self.cycles(name, family.mode[None], blocks)[0])

    def errors(self, family: FamilyPosterior, name: str) -> dict[str, float]:
        """Return relative errors of the features, root mean squares with the sign of the mean."""
        off = np.array([
            setting.rows(features[None])[0] - setting.centre
            for setting, features in zip(self.settings, self.modes(family, name), strict=True)
            if not setting.slides
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
        away = np.array([_speed_of(block) for block in blocks]) - self.middle
        logs = lacks[:, None] + away[None, :, None] * slopes[:, None]
        runs = np.array(self.runs)[family.sets[which]]
        sizes, chances = np.array(LACKS).T
        runs = np.where(runs > 0.0, runs, rng.choice(sizes, len(runs), p=chances))
        logs = logs + runs[:, None, None] * rng.normal(size=logs.shape)
        return np.asarray(features * np.exp(SHARES * logs))


def _speed_of(block: TowedBlock) -> float:
    """Return the logarithm of the speed by which settings differ."""
    return math.log(block.speed * math.sqrt(block.stiffness * block.mass) / block.steady_load)
