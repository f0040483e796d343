r"""Laws of a record refined by simulation: each runs as an observer of the record.

The force balance of a record is biased where its law is not linear in the motion, and its shapes
stand on a grid. Here each law of a small set runs along the record: the force goes in, between
samples the law moves the inertia (`stickslip.engine.kernels.observer`), and at each sample place
and speed are corrected by fixed gains,

.. math:: e_k = q_k - \hat x_k, \qquad \hat x_k \mathrel{+}= \alpha e_k, \qquad
          \hat v_k \mathrel{+}= \beta e_k / h ,

those of a steady Kalman filter with a bandwidth :math:`w` (P. R. Kalata, 1984). The innovations
:math:`e` are the residuals of a Gauss-Newton fit (Huber weights, slopes by differences) that starts
from the balance, whose wide covariance is the prior; lengths of bristles, Stribeck velocities and
exponents are continuous. Their covariance is a sandwich over stretches; held-out losses are
linearised, and shares follow from them as in `stickslip.identify.comparison`.

**Rule.** The bandwidth is that of the smallest innovations. Where noise of the force explains it,

.. math:: w \le 0.9\, w_0, \quad w_0 = \sqrt{\sigma_F / (J \sigma_q)},

the law holds as simulated, and the refined laws stand, their covariance times `INFLATION`. Else
what drives the innovations is no noise but a law that is wrong: refining harms, the balance stays.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.kernels import observer
from stickslip.engine.solver import observe
from stickslip.identify.comparison import Comparison, stacked_shares, with_curve
from stickslip.identify.ensemble import Ensemble, root_of, stream_of
from stickslip.identify.problem import Array, Column, Fitted, Mask, Shape, Structure
from stickslip.identify.problems.record_signals import Record, noise_of
from stickslip.identify.problems.records import RecordsProblem
from stickslip.identify.search import block_scores
from stickslip.identify.thresholds import THRESHOLDS

BANDWIDTHS = (0.4, 0.65, 1.0, 1.4, 2.0)
"""Bandwidths of the observer that are tried, over the largest at which a law holds ..."""
HOLDS = 0.9
"""... which is over that of the noise of the force (study: records)."""
INFLATION = 4.0
"""Factor on the covariance: shapes that no refined law has (study: records)."""
PARTS = 4
"""Steps between samples, at least."""
MOST_PARTS = 24
ITERATIONS = 8
"""Rounds of Gauss-Newton at most."""
SINGLE = 1e-3
"""Part of the range of known forces by which they are those of the place alone."""
SPEEDS, PLACES = 801, 201
"""Entries of tables over speed and place."""
SHAPES = 8
"""Draws of shapes of a refined law, each with its own coefficients."""
LOOSE = 0.7
"""Prior standard deviation of the logarithm of a shape: within a step of the grid. A law whose
shape is an outlier by it is left out."""
LEAST_GAIN = 0.1
"""Standard deviations by which estimates move in the last round."""
UNSEEN = frozenset(
    {"backlash", "flexible", "hose", "latency", "dead_zone", "force_gain", "position_scale",
     "gear_direction"}
)  # fmt: skip
"""Terms that no observer of one inertia has."""
OF_TIME = frozenset({"drift", "adhesion", "offset_drift", "mechanism", "viscous_drift"})
"""Terms whose coefficients act at samples."""
CONTINUOUS: Mapping[str, tuple[int, ...]] = {
    "stribeck": (2,), "stribeck_direction": (0,), "power": (0,), "second": (0,),
}  # fmt: skip
"""Entries of shapes that are refined, beside the length of the memory."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Probe:
    """Rows at which terms are read off: bristles stretched forward, no filter."""

    velocity: Array
    place: Array
    stretch: Array
    clock: Array
    load: Array
    inputs: Mapping[str, Array]
    problem: RecordsProblem
    mechanism: Array

    def seen(self, x: Array) -> Array:
        return x

    acting = seen

    @property
    def acceleration(self) -> Array:
        return np.zeros(len(self.velocity))

    inertial = acceleration

    def state(self, *_: float) -> Array:
        return np.ones(len(self.velocity))

    def wave(self, number: float) -> Array:
        angle = number * self.place
        return np.column_stack([np.sin(angle), np.cos(angle)])

    def input(self, name: str) -> Array:
        return self.inputs[name]

    def knotted(self) -> Array:
        low = math.exp(self.problem.frame.knots[0])
        return np.asarray(np.log(np.maximum(np.abs(self.velocity), low)))


@dataclass(eq=False)
class _Run:
    """What the simulation needs of a record, and the probes of its tables."""

    problem: RecordsProblem
    record: Record
    start_speed: float
    clock: Array
    load: Array
    inputs: Mapping[str, Array]

    @cached_property
    def step(self) -> float:
        return float(self.record.time[1] - self.record.time[0])

    @cached_property
    def place(self) -> Array:
        return np.ascontiguousarray(self.record.position)

    @cached_property
    def known(self) -> Array:
        """Known forces of the mechanism (n,)."""
        none = np.zeros(len(self.record.time))
        return none if self.record.mechanism is None else np.asarray(self.record.mechanism)

    @cached_property
    def field(self) -> Array | None:
        """Known forces over the place; None where they change by more than that."""
        if self.record.mechanism is None:
            return None
        order = np.argsort(self.place, kind="stable")
        found = np.interp(self.places, self.place[order], self.known[order])
        apart = np.abs(np.interp(self.place, self.places, found) - self.known)
        return found if apart.max() < SINGLE * np.ptp(self.known) else None

    def _probe(self, velocity: Array, place: Array, **at_samples: Array) -> _Probe:
        frame, count = self.problem.frame, max(len(velocity), len(place))
        none = np.zeros(count)
        return _Probe(
            velocity=velocity + none,
            place=place - frame.middle + none,
            stretch=place - frame.relaxed + none,
            clock=at_samples.get("clock", none),
            load=at_samples.get("load", none + 1.0),
            inputs=self.inputs if at_samples else dict.fromkeys(self.inputs, none),
            problem=self.problem,
            mechanism=at_samples.get("mechanism", none),
        )

    @cached_property
    def speeds(self) -> Array:
        half = (SPEEDS - 1) // 2
        top = 3.0 * max(self.problem.frame.top, 1e-300)
        k = np.arange(SPEEDS) - half
        return np.asarray(np.sign(k) * top * (k / half) ** 2.0)

    @cached_property
    def places(self) -> Array:
        low, high, beyond = self.place.min(), self.place.max(), 0.05 * np.ptp(self.place)
        return np.linspace(low - beyond, high + beyond, PLACES)

    @cached_property
    def over_speed(self) -> _Probe:
        return self._probe(self.speeds, np.full(1, self.problem.frame.middle))

    @cached_property
    def over_place(self) -> _Probe:
        return self._probe(np.ones(1), self.places)

    @cached_property
    def over_time(self) -> _Probe:
        return self._probe(
            np.ones(1), self.place, clock=self.clock, load=self.load, mechanism=self.known
        )


class ObservedLaw:
    """A structure as an observer: coefficients, then logarithms of its continuous shapes."""

    def __init__(self, runs: Sequence[_Run], structure: Structure, widths: Sequence[int]) -> None:
        self.runs, self.structure, self.widths = runs, structure, widths
        self.count = sum(widths)
        self.problem = runs[0].problem
        self.free: list[tuple[int, int]] = []
        memory = self._memory(structure)
        if memory[0] > 0.0:
            self.free.append((-1, 0))
        for i, (name, shape) in enumerate(structure):
            self.free += [(i, k) for k in CONTINUOUS.get(name, ()) if shape[k] > 0.0]
        self.shapes = np.array(
            [math.log(memory[0] if i < 0 else structure[i][1][k]) for i, k in self.free]
        )

    def _memory(self, structure: Structure) -> Shape:
        terms = self.problem.terms
        return next((shape[:2] for name, shape in structure if terms[name].shared), (0.0, 0.0))

    def at(self, shapes: Array) -> Structure:
        """Return the structure with logarithms of its shapes (s,)."""
        found = [[*shape] for _, shape in self.structure]
        for (i, k), value in zip(self.free, np.exp(shapes), strict=True):
            for j, (name, _) in enumerate(self.structure):
                if i == j or (i < 0 and self.problem.terms[name].shared):
                    found[j][k] = float(value)
        names = [name for name, _ in self.structure]
        return tuple((name, tuple(shape)) for name, shape in zip(names, found, strict=True))

    def innovations(self, theta: Array, gains: tuple[float, float]) -> list[Array]:
        """Return the innovations (n,) of each record."""
        structure = self.at(theta[self.count :])
        parts, at = [], 0
        for width in self.widths:
            parts.append(theta[at : at + width])
            at += width
        return [self._run(run, structure, parts, gains) for run in self.runs]

    def _run(  # noqa: C901  # one branch for each kind of term
        self, run: _Run, structure: Structure, parts: Sequence[Array], gains: tuple[float, float]
    ) -> Array:
        count = len(run.place)
        none = np.zeros(1)
        a, v = np.zeros(SPEEDS), np.zeros(SPEEDS)
        b = p = w = none
        d1, d2, d3 = np.zeros((3, count))
        force = np.array(run.record.force)
        memory = self._memory(structure)
        inertia = run.record.inertia or 0.0
        second = (0.0, 0.0, 0.0)
        for (name, shape), c in zip(structure, parts, strict=True):
            columns = self.problem.terms[name].columns
            if name == "inertia":
                inertia = float(c[0])
            elif name == "inertia_error":
                inertia += float(c[0])
            elif name == "second":
                second = (float(c[0]), shape[0], shape[1])
            elif name in ("delay", "lag"):
                late = float(c[0]) * (shape[0] if name == "delay" else -1.0)
                force = np.interp(run.record.time + late, run.record.time, force)
            elif name == "clip":
                over = np.sign(force) * np.maximum(np.abs(force) - shape[0], 0.0)
                force = force - float(c[0]) * over
            elif name == "mechanism" and run.field is not None:
                w = w + float(c[0]) * run.field
            elif name in OF_TIME or "*" in name:
                x = np.reshape(columns(run.over_time, shape), (count, -1)) @ c
                if name.startswith("viscous"):
                    d2 = d2 + x
                elif name in ("offset_drift", "mechanism"):
                    d3 = d3 + x
                else:
                    d1 = d1 + x
            elif name in ("place", "level_ripple"):
                p = p + columns(run.over_place, shape) @ c
            elif name in ("offset", "spring", "bow", "ripple"):
                w = w + np.reshape(columns(run.over_place, shape), (PLACES, -1)) @ c
            elif name == "curve":
                x = columns(run.over_speed, shape)
                m = x.shape[1] // 2 if shape[2] else x.shape[1]
                a, b = a + x[:, :m] @ c[:m], b + x[:, m:] @ c[m:] if shape[2] else b
            else:
                x = np.reshape(columns(run.over_speed, shape), (SPEEDS, -1)) @ c
                if name in ("level", "stribeck"):
                    a = a + x
                elif name in ("stribeck_direction", "level_direction"):
                    b = b + x
                elif name == "power" and memory[0] == 0.0:
                    a = a + np.sign(run.speeds) * x
                else:
                    v = v + x
        out = np.full(count, observer.LOST)
        if run.field is None:
            force = force + run.known
        else:
            w = w - run.field
        if inertia > 0.0:
            numbers = self._numbers(run, inertia, gains, memory, second)
            stiff = max(float(np.abs(a).max()) / memory[0] if memory[0] > 0.0 else 0.0,
                        abs(second[0]) / second[1] if second[1] > 0.0 else 0.0)  # fmt: skip
            most = math.ceil(2.0 * run.step * math.sqrt(stiff / inertia))
            tables = (np.ascontiguousarray(one) for one in (a, b, v, p, w))
            observe()(
                count, int(np.clip(most, PARTS, MOST_PARTS)), int(run.record.held), numbers,
                np.ascontiguousarray(force), run.place, *tables, run.load, d1, d2, d3,
                out,
            )  # fmt: skip
        return out

    @staticmethod
    def _numbers(
        run: _Run,
        inertia: float,
        gains: tuple[float, float],
        memory: Shape,
        second: tuple[float, float, float],
    ) -> Array:
        """Return the numbers that the compiled run reads."""
        p = np.zeros(observer.COUNT)
        p[observer.STEP], p[observer.INERTIA] = run.step, inertia
        p[observer.GAIN], p[observer.RATE_GAIN] = gains[0], gains[1] / run.step
        p[observer.LENGTH : observer.EXPONENT + 1] = memory
        p[observer.SECOND : observer.SECOND_EXPONENT + 1] = second
        p[observer.SPEED_UNIT] = run.speeds[-1] / ((SPEEDS - 1) // 2) ** 2
        p[observer.PLACE_START] = run.places[0]
        p[observer.PLACE_STEP] = run.places[1] - run.places[0]
        p[observer.START_SPEED] = run.start_speed
        p[observer.START_STATE] = float(np.sign(run.start_speed))
        return p


@dataclass(eq=False)
class RefinedLaw:
    """A law fitted to innovations."""

    law: ObservedLaw
    theta: Array
    """Coefficients and logarithms of shapes (p,)."""
    innovations: Array
    """Innovations (n,), less the first ones of each record."""
    slopes: Array
    """Their slopes by theta, with the other sign (n, p)."""
    precision: Array
    """Inverse covariance of the prior (p, p)."""
    stretches: NDArray[np.intp]
    """Number of the stretch of each innovation (n,)."""
    scale: float
    """Robust standard deviation of the innovations."""

    @cached_property
    def weights(self) -> Array:
        """Huber weights (n,)."""
        z = np.abs(self.innovations) / self.scale
        return np.minimum(1.0, THRESHOLDS.outlier / np.maximum(z, 1e-9))

    @cached_property
    def _normal(self) -> tuple[Array, Array]:
        """Scores of the stretches (m, p), and the matrix of the normal equations."""
        a = self.slopes * (self.weights / self.scale**2)[:, None]
        scores = np.zeros((int(self.stretches.max()) + 1, len(self.theta)))
        np.add.at(scores, self.stretches, a * self.innovations[:, None])
        return scores, a.T @ self.slopes + self.precision

    @cached_property
    def root(self) -> Array:
        """Root of the covariance (k, p): of the sandwich over stretches, and of the prior."""
        scores, normal = self._normal
        inverse = _inverse(normal)
        m = len(scores)
        prior = np.linalg.eigh(self.precision)
        half = (prior[1] * np.sqrt(np.maximum(prior[0], 0.0))).T
        own = scores @ inverse * math.sqrt(INFLATION * m / (m - 1.0))
        return np.vstack([own, half @ inverse])

    def losses(self, scale: float) -> Array:
        """Return held-out losses of the stretches (m,), linearised."""
        scores, normal = self._normal
        a = self.slopes * (self.weights / self.scale**2)[:, None]
        found, total = [], scores.sum(axis=0)
        for k in range(len(scores)):
            rows = self.stretches == k
            without = normal - a[rows].T @ self.slopes[rows]
            without = without + np.diag(np.diag(normal)) * 1e-7
            moved = np.linalg.lstsq(without, total - scores[k], rcond=None)[0]
            e = (self.innovations[rows] - self.slopes[rows] @ moved) / scale
            found.append(float(np.mean(self.weights[rows] * e * e)))
        return np.array(found)

    def drawn(
        self, share: float, rng: np.random.Generator
    ) -> Iterator[tuple[Structure, float, Fitted]]:
        """Yield structures with drawn shapes, their shares, and coefficients given these."""
        n, root = self.law.count, self.root
        covariance = root.T @ root
        freedom = float(int(self.stretches.max()))
        if not self.law.free:
            yield self.law.structure, share, _fitted(self.theta, covariance, freedom)
            return
        shaped = covariance[n:, n:]
        gain = np.linalg.lstsq(shaped, covariance[n:, :n], rcond=1e-12)[0].T
        left = covariance[:n, :n] - gain @ covariance[n:, :n]
        moves = rng.normal(size=(SHAPES, len(root))) @ root[:, n:]
        moves = np.clip(moves - moves.mean(axis=0), -1.0, 1.0)
        for move in moves:
            structure = self.law.at(self.theta[n:] + move)
            yield structure, share / SHAPES, _fitted(self.theta[:n] + gain @ move, left, freedom)


def _fitted(coefficients: Array, covariance: Array, freedom: float) -> Fitted:
    # signs of eigenvectors are a matter of rounding, a root by Cholesky is not
    return Fitted(
        fitted=np.zeros(0), coefficients=coefficients, covariance=covariance, freedom=freedom,
        root=root_of(covariance),
    )  # fmt: skip


def _with_doubts(fit: Fitted, plain: Mask, moved: Array) -> Fitted:
    """Return a fit with further coefficients, which are 0 and move those of plain places (p,)."""
    assert fit.root is not None
    root = np.zeros((len(fit.root), len(plain)))
    root[:, plain] = fit.root
    root = np.vstack([root, moved])
    coefficients = np.zeros(len(plain))
    coefficients[plain] = fit.coefficients
    return replace(fit, coefficients=coefficients, covariance=root.T @ root, root=root)


def _inverse(matrix: Array) -> Array:
    size = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    inverse = np.linalg.pinv(matrix / np.outer(size, size), hermitian=True, rcond=1e-13)
    return np.asarray(inverse / np.outer(size, size))


class Observer:
    """The laws of an ensemble of records, refined by simulation."""

    def __init__(self, ensemble: Ensemble) -> None:
        problem = ensemble.problem
        assert isinstance(problem, RecordsProblem)
        self.ensemble, self.problem = ensemble, problem
        self.runs = _runs(problem)
        self.noise_bandwidth = 0.0
        """Bandwidth that the noise of the force explains [rad/s]."""
        self.bandwidth = 0.0
        """Bandwidth of the smallest innovations [rad/s]."""
        step = self.runs[0].step
        band = problem.rows.band
        skip = 3 * max(int(1.0 / band / step), 5)
        self._kept = [
            np.arange(len(run.place)) >= min(skip, len(run.place) // 4) for run in self.runs
        ]
        count = sum(int(kept.sum()) for kept in self._kept)
        blocks = int(problem.stretches.max()) + 1
        self._stretches = (np.arange(count) * blocks // count).astype(np.intp)

    @property
    def possible(self) -> bool:
        """Whether a force drives an inertia alone to places."""
        first = self.problem.records[0]
        driven = not self.problem.free and not first.friction
        return driven and first.located and all(one.doubt for one in first.unknown.values())

    def refined(self) -> Ensemble:
        """Return the ensemble of refined laws; that of the balance where these do not hold."""
        if not self.possible:
            return self.ensemble
        candidates = self._candidates()
        if not candidates or not self._has_inertia(candidates[0]):
            return self.ensemble
        step = self.runs[0].step
        self.noise_bandwidth = self._explained(candidates[0])
        first = HOLDS * self.noise_bandwidth
        laws = self._fits(candidates, _gains(step, first), {})
        if not laws:
            return self.ensemble
        found = {}
        for share in BANDWIDTHS:
            e = self._innovations(laws[0].law, laws[0].theta, _gains(step, share * first))
            found[share * first] = _bounded(e, _scale(e))
        self.bandwidth = min(found, key=lambda w: found[w])
        if self.bandwidth > first * (1.0 + 1e-9):
            return self.ensemble
        if self.bandwidth < first * (1.0 - 1e-9):
            known = {one.law.structure: one.theta for one in laws}
            laws = self._fits([*known], _gains(step, self.bandwidth), known)
        return self._compared(laws) if laws else self.ensemble

    def _fits(
        self,
        candidates: Sequence[Structure],
        gains: tuple[float, float],
        known: Mapping[Structure, Array],
    ) -> list[RefinedLaw]:
        """Return the laws that a fit ends at, the best first."""
        found = [self._fit(one, gains, known.get(one)) for one in candidates]
        return self._different([one for one in found if one is not None])

    # ---- which laws
    def _candidates(self) -> list[Structure]:
        """Return the named law and its kin, the best ones by share, and the measured curve."""
        comparison, problem = self.ensemble.comparison, self.problem
        named = comparison.named
        memories = list(dict.fromkeys(shape[:2] for shape in problem.terms["level"].shapes))
        kin = [named, comparison.best]
        plain = tuple(one for one in named if one[0] != "second")
        for one in dict.fromkeys([named, plain]):
            kin += [_with_memory(problem, one, memory) for memory in memories[:2]]
        kin += [
            tuple((name, (*shape[:3], 3.0 - shape[3])) if name == "stribeck" else (name, shape)
                  for name, shape in named)
        ]  # fmt: skip
        order = np.argsort(-comparison.shares)[: THRESHOLDS.beam]
        kin += [comparison.structures[i] for i in order]
        # where the curve has a term that no observer has, it goes without: the band needs a curve
        kin += [tuple(one for one in comparison.curve if one[0] not in UNSEEN)]
        allowed = (one for one in dict.fromkeys(kin) if not UNSEEN & {name for name, _ in one})
        found = [self._plain(one) for one in allowed if one and problem.allowed(one)]
        self.ensemble.regression.add(column for one in found for column in one)
        return found

    def _plain(self, structure: Structure) -> Structure:
        """Return a structure without what is doubtful of the mechanism, which stays as given."""
        return tuple(one for one in structure if not self.problem.terms[one[0]].doubt)

    def _doubtful(self, law: Structure) -> tuple[Sequence[Column], Array]:
        """Return columns of what is doubtful, and coefficients (k, p) that each moves a law by.

        They are those of the balance: the column of what is doubtful is in its structures.
        """
        terms = self.problem.terms
        columns = [(name, ()) for name, term in terms.items() if term.doubt]
        if not columns:
            return (), np.zeros((0, 0))
        root = self.ensemble.regression.fit(tuple(sorted([*law, *columns]))).root
        assert root is not None
        return columns, root[-len(columns) :]

    def _law(self, structure: Structure) -> ObservedLaw:
        columns = self.ensemble.regression.columns
        return ObservedLaw(self.runs, structure, [columns.of(one).shape[1] for one in structure])

    def _different(self, laws: Sequence[RefinedLaw]) -> list[RefinedLaw]:
        """Return the best of laws that differ only in what was fitted."""
        scale = min(one.scale for one in laws) if laws else 1.0
        best: dict[object, RefinedLaw] = {}
        for one in sorted(laws, key=lambda x: _bounded(x.innovations, scale)):
            fixed = one.law.at(np.zeros(len(one.law.free)))
            best.setdefault(fixed, one)
        return [*best.values()]

    # ---- fits
    def _has_inertia(self, structure: Structure) -> bool:
        known = self.problem.records[0].inertia is not None
        return known or any(name == "inertia" for name, _ in structure)

    def _explained(self, structure: Structure) -> float:
        """Return the bandwidth that the noise of the force explains [rad/s]."""
        inertia = self.problem.records[0].inertia
        if inertia is None:
            law, fit = self._law(structure), self.ensemble.fit(structure)
            names = [name for name, _ in structure]
            inertia = float(fit.coefficients[sum(law.widths[: names.index("inertia")])])
        force = max(noise_of(one.force) for one in self.problem.rows.records)
        place = max(noise_of(run.place) for run in self.runs)
        return math.sqrt(force / (abs(inertia) * place + 1e-300))

    def _innovations(self, law: ObservedLaw, theta: Array, gains: tuple[float, float]) -> Array:
        every = zip(law.innovations(theta, gains), self._kept, strict=True)
        return np.concatenate([e[kept] for e, kept in every])

    def _fit(
        self, structure: Structure, gains: tuple[float, float], known: Array | None
    ) -> RefinedLaw | None:
        """Return a law after Gauss-Newton from the balance; None where it goes astray."""
        balance = self.ensemble.regression.fit(structure)
        law = self._law(structure)
        n, start = law.count, np.concatenate([balance.coefficients, law.shapes])
        assert balance.root is not None
        size = np.linalg.norm(balance.root, axis=0) + 1e-300
        steps = np.concatenate(
            [
                np.maximum(0.5 * size / math.sqrt(self.problem.spread), 1e-6 * np.abs(start[:n])),
                np.full(len(law.shapes), 0.1),
            ]
        )
        precision = np.diag(np.concatenate([np.zeros(n), np.full(len(law.shapes), LOOSE**-2)]))
        values, vectors = np.linalg.eigh(balance.covariance / np.outer(size, size))
        precision[:n, :n] = (vectors / np.maximum(values, 1e-6)) @ vectors.T / np.outer(size, size)
        theta = start.copy() if known is None else known.copy()
        e = self._innovations(law, theta, gains)
        for _ in range(ITERATIONS):
            scale = _scale(e)
            x = self._slopes(law, theta, steps, gains, e)
            far_out = THRESHOLDS.outlier * scale
            a = x * np.minimum(1.0, far_out / np.maximum(np.abs(e), 1e-300))[:, None]
            normal = a.T @ x / scale**2 + precision
            gradient = a.T @ e / scale**2 - precision @ (theta - start)
            inverse = _inverse(normal)
            whole = inverse @ gradient
            far = float(np.max(np.abs(whole[n:]), initial=0.0))
            old = _cost(e, scale) + _prior(theta - start, precision)
            for share in (1.0, 0.5, 0.2, 0.05):
                move = share * whole / max(share * far, 1.0)
                tried = self._innovations(law, theta + move, gains)
                if _cost(tried, scale) + _prior(theta + move - start, precision) < old:
                    break
            else:
                break
            theta, e = theta + move, tried
            if np.max(np.abs((theta - start)[n:]), initial=0.0) > THRESHOLDS.outlier * LOOSE:
                return None  # its shape says another law
            if np.max(np.abs(move) / np.sqrt(np.maximum(np.diag(inverse), 1e-300))) < LEAST_GAIN:
                break
        lost = not np.all(np.isfinite(theta)) or np.abs(e).max() >= observer.LOST
        if lost or not self.ensemble.regression.physical(structure, theta[:n]):
            return None
        return RefinedLaw(
            law=law, theta=theta, innovations=e, precision=precision, scale=_scale(e),
            slopes=self._slopes(law, theta, steps, gains, None), stretches=self._stretches,
        )  # fmt: skip

    def _slopes(
        self,
        law: ObservedLaw,
        theta: Array,
        steps: Array,
        gains: tuple[float, float],
        e: Array | None,
    ) -> Array:
        """Return slopes with the other sign (n, p): by central differences where e is not given."""
        columns = []
        for i, step in enumerate(steps):
            move = np.zeros(len(theta))
            move[i] = step
            ahead = self._innovations(law, theta + move, gains)
            back = self._innovations(law, theta - move, gains) if e is None else e
            columns.append((back - ahead) / (step * (2.0 if e is None else 1.0)))
        return np.column_stack(columns)

    # ---- what they say together
    def _compared(self, laws: Sequence[RefinedLaw]) -> Ensemble:
        comparison, problem = self.ensemble.comparison, self.problem
        scale = min(one.scale for one in laws)
        losses = np.nan_to_num([one.losses(scale) for one in laws], nan=observer.LOST)
        scores = block_scores(losses)
        is_law = np.array([problem.is_law(one.law.structure) for one in laws])
        order = np.argsort(scores.mean(axis=1))
        laws, scores, is_law = [laws[i] for i in order], scores[order], is_law[order]
        count = np.array([problem.parameters(one.law.structure) for one in laws])
        price = self.ensemble.regression.price * scores.shape[1]
        shares = stacked_shares(scores, np.exp(-price * (count - count.min())))
        shares = with_curve(shares, is_law) if not is_law.all() and is_law.any() else shares
        structures: list[Structure] = []
        fits: dict[Structure, Fitted] = {}
        own: list[float] = []
        rows: list[int] = []
        first: dict[int, Structure] = {}
        for i, (one, share) in enumerate(zip(laws, shares, strict=True)):
            doubtful, moved = self._doubtful(one.law.structure)
            rng = stream_of(one.law.structure, self.ensemble.seed + 5)
            for plain, part, plain_fit in one.drawn(float(share), rng):
                structure, fit = plain, plain_fit
                if doubtful:
                    structure = tuple(sorted([*plain, *doubtful]))
                    plain_at = [
                        not problem.terms[name].doubt
                        for name, shape in structure
                        for _ in range(problem.width(name, shape))
                    ]
                    fit = _with_doubts(fit, np.array(plain_at), moved)
                structures.append(structure)
                fits[structure] = fit
                own.append(part)
                rows.append(i)
                first.setdefault(i, structure)
        families = [problem.family(one) for one in structures]
        best = first[int(np.flatnonzero(is_law)[0])] if is_law.any() else structures[0]
        same = [
            one for one in structures if problem.family(one) == problem.family(comparison.named)
        ]
        curve = [one for one in structures if not problem.is_law(one)]
        found: Comparison = replace(
            comparison,
            structures=structures,
            families=families,
            scores=scores[rows],
            shares=np.array(own),
            best=best,
            named=same[0] if same else best,
            curve=curve[0] if curve else comparison.curve,
        )
        refined = Ensemble(self.ensemble.regression, found, seed=self.ensemble.seed, twinned=False)
        refined._fits.update(fits)
        return refined


def _with_memory(problem: RecordsProblem, structure: Structure, memory: Shape) -> Structure:
    """Return a structure with another memory."""
    return tuple(
        (name, (*memory, *shape[2:]) if problem.terms[name].shared else shape)
        for name, shape in structure
    )


def _runs(problem: RecordsProblem) -> list[_Run]:
    rows = problem.rows
    cuts = np.cumsum([len(one.time) for one in rows.records])[:-1]
    split = [np.split(x, cuts) for x in (rows.velocity, rows.clock, rows.load)]
    inputs = {name: np.split(rows.input(name), cuts) for name in problem.frame.inputs}
    return [
        _Run(
            problem=problem, record=one, start_speed=float(split[0][k][0]), clock=split[1][k],
            load=np.ascontiguousarray(split[2][k]),
            inputs={name: x[k] for name, x in inputs.items()},
        )
        for k, one in enumerate(rows.records)
    ]  # fmt: skip


def _gains(step: float, bandwidth: float) -> tuple[float, float]:
    """Return the gains of place and speed of a steady Kalman filter (Kalata 1984).

    Examples
    --------
    >>> alpha, beta = _gains(0.001, 100.0)
    >>> round(alpha, 3), round(beta, 4)
    (0.132, 0.0093)
    """
    index = (bandwidth * step) ** 2
    r = (4.0 + index - math.sqrt(8.0 * index + index**2)) / 4.0
    alpha = 1.0 - r * r
    return alpha, 2.0 * (2.0 - alpha) - 4.0 * math.sqrt(1.0 - alpha)


def _scale(e: Array) -> float:
    """Return a robust standard deviation of innovations."""
    return float(max(1.4826 * np.median(np.abs(e)), 0.3 * np.sqrt(np.mean(e * e)), 1e-300))


def _bounded(e: Array, scale: float) -> float:
    return float(np.mean(np.minimum(np.abs(e), THRESHOLDS.outlier * scale) ** 2))


def _cost(e: Array, scale: float) -> float:
    """Return Huber's cost of innovations."""
    z, far = np.abs(e) / scale, THRESHOLDS.outlier
    return float(np.sum(np.where(z < far, z * z, far * (2.0 * z - far))))


def _prior(move: Array, precision: Array) -> float:
    return float(move @ precision @ move)
