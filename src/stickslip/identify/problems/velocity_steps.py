"""Friction under velocity steps of a load point, as a simulated measurement.

A row is the coefficient of friction at a time, or its mean over a short stretch of a long record.
A law is one of `RATE_STATE_FORMS`, run on a slider without inertia behind a spring.

Priors are shares of the mean coefficient :math:`m` of the record and of the way between steps:

    ln a ~ N(ln .015 m, 1)           b ~ N(.015 m, .025 m), not below the lowest that is asked for
    ln D_c ~ N(ln .03 way, 1.6)      ln c ~ N(ln 1.3, .7)
    b_2 ~ N(0, .015 m)               ln(D_2/D_c) ~ N(1.5, .7)
    ln k ~ N(ln of what is stated, .3)

An effect of stress c makes a step show a/(1 + c), b - a c/(1 + c) and (1 + c) D_c. These have the
priors of a, b and D_c, which were measured without it, and a record hardly tells c beside them.

Rocks, gouges, metals and paper have a and b of .003 to .03 at m of .6 ([M], [B]), and experiments
slide by tens of critical distances between steps. A frame, grips and a sample give way beside the
spring, so the stiffness of a machine is known to a third unless its uncertainty is stated. Beside
every law friction may change along the way: linearly, and as it settles from an earlier step or a
fresh surface, over .06 to .5 of the way; by .01 %, 1 % or 5 % of m. A second state is prior to
lie within a decade of the first, as one over a longer way is a trend. (A smooth change over a
twentieth of the way as well was refuted: on a rock it took a third of the step for itself.)

.. [M] C. Marone, "Laboratory-derived friction laws and their application to seismic faulting",
   Annual Review of Earth and Planetary Sciences 26 (1998) 643-696.
.. [B] T. Baumberger and C. Caroli, "Solid friction from stick-slip down to pinning and aging",
   Advances in Physics 55 (2006) 279-348.
"""

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.friction import RateState, RateStateForm
from stickslip.identify.bands import ENDS, Array
from stickslip.identify.fits import Estimate
from stickslip.identify.problems.velocity_step_paths import STRETCHES, Path, path_of
from stickslip.identify.problems.velocity_step_runs import Sliders, coefficients_of
from stickslip.identify.simulated import Always, FamilyPosterior, Simulated, Unknowns
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import TowedBlock
from stickslip.quantities import Quantity, fields_of
from stickslip.show.formatting import number, quantity

DIRECT, EVOLVED, DISTANCE = "direct_effect", "evolution_effect", "critical_distance"
SECOND, FURTHER, STRESS = "second_evolution_effect", "second_critical_distance", "stress_effect"
STIFFNESS, LEVEL = "stiffness", "reference_coefficient"
RATE = "friction.rate"
"""Path of a - b, less b_2 of a second state: how friction changes with speed in the long run."""
ORDER = (DIRECT, EVOLVED, DISTANCE, STIFFNESS, LEVEL, STRESS, SECOND, FURTHER)
"""Parameters in the order in which they are told."""
PRIORS = {
    STIFFNESS: (1.0, 0.3),
    LEVEL: (1.0, 0.5),
    DIRECT: (0.015, 1.0),
    EVOLVED: (0.015, 0.025),
    DISTANCE: (0.03, 1.6),
    SECOND: (0.0, 0.015),
    FURTHER: (math.exp(1.5), 0.7),
    STRESS: (1.3, 0.7),
}
"""Medians, and deviations of the logarithm or, of effects of states, of the value: see above."""
TRENDS = {1e-4: 0.4, 0.01: 0.4, 0.05: 0.2}
"""Sizes of what changes along the way, over the mean coefficient, with their probabilities."""
SETTLING = (0.06, 0.12, 0.25, 0.5)
"""Shares of the way over which friction settles: what lies between is a sum of both beside it."""
NONE = 1e-9
"""Size of what is not there."""
PRICES = {"none": 0.0, "ageing": 0.0, "slip": 0.0, "prz": 0.6, "nagata": 0.6, SECOND: 1.2}
"""Logarithm of the prior odds that being unusual costs a law of evolution, and a second state."""
DISTANCES = (0.004, 0.03, 0.2)
"""Critical distances at which searches begin, over the way between steps."""
HELD = 0.01
"""Way of a piece over the longest, up to which it is a hold."""
EXACT = 0.01
"""Error of a step of a run over the scatter of neighbouring rows: many rows tell friction to a
thirtieth of their scatter."""
JUST_AFTER = 10
"""Samples after a step whose median distance is the shortest stretch: two may be nearly one."""
PLAIN = 1500
"""Up to so many samples are taken as they are; else there are a third as many even stretches of
time, and as many that widen from each step."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """Times, friction coefficients and the path of the load point, from time 0 on."""

    time: Array
    """Times (n,) [s]."""
    coefficient: Array
    """Friction over load (n,)."""
    pull: Array
    """Position of the load point (n,) [m], as measured, from 0 on."""
    path: Path
    """Path of the load point: pieces of constant speed, from time 0 and position 0 on."""
    begins: float = 0.0
    """Time 0 on the clock of the measurement [s]."""
    load: float = 1.0
    """Mean load [N]."""

    @property
    def speed(self) -> float:
        """First speed of the load point [m/s]."""
        return float(self.path.lasting[0])

    @property
    def slid(self) -> float:
        """Way of the load point after its first change of speed [m]."""
        return float(self.path.position[-1] - self.path.places[0])

    def within(self, before: float | None, after: float | None) -> "Record":
        """Return what lies within some way before the first step and some after the last."""
        place = np.interp(self.time, self.path.time, self.path.position)
        low = -np.inf if before is None else self.path.places[0] - before
        high = np.inf if after is None else self.path.places[-1] + after
        kept = (place >= low) & (place <= high)
        time = self.time[kept]
        inner = (self.path.time > time[0]) & (self.path.time < time[-1])
        knots = np.array([time[0], *self.path.time[inner], time[-1]])
        position = np.interp(knots, self.path.time, self.path.position)
        return replace(
            self,
            time=time - time[0],
            coefficient=self.coefficient[kept],
            pull=self.pull[kept] - self.pull[kept][0],
            path=Path(time=knots - time[0], position=position - position[0]),
            begins=self.begins + float(time[0]),
        )

    def stretches(self) -> tuple[Array, Array, Array]:
        """Return mean times and coefficients of stretches, and their numbers of samples (n,)."""
        bins = np.arange(len(self.time))
        if len(bins) > PLAIN:
            bins = np.searchsorted(self._edges(), self.time, side="right")
        _, which, count = np.unique(bins, return_inverse=True, return_counts=True)
        times, means = (np.bincount(which, x) / count for x in (self.time, self.coefficient))
        return times, means, count.astype(float)

    def _edges(self) -> Array:
        first, last = self.time[0], self.time[-1]
        edges = [np.linspace(first, last, PLAIN // 3 + 1)]
        # pieces are often sampled at rates of their own: a stretch as long as a sample of a slow
        # piece would hide how friction settles in a fast one
        ends = [*self.path.steps[1:], last]
        for step, end in zip(self.path.steps, ends, strict=True):
            after = np.diff(self.time[self.time >= step][:JUST_AFTER])
            shortest = float(np.median(after)) if len(after) else last - first
            if end - step > 2.0 * shortest:
                edges.append(step + np.geomspace(shortest, end - step, PLAIN // 3))
        return np.unique(np.concatenate([*edges, self.path.steps]))

    def levels(self) -> tuple[float, float]:
        """Return a guess of a - b and of the level at first, from the last third of each piece."""
        knots, speeds = self.path.segments, self.path.lasting
        result = []
        for start, end, speed in zip(knots[:-1], knots[1:], speeds, strict=True):
            late = (self.time > end - (end - start) / 3.0) & (self.time <= end)
            if speed > 1e-3 * self.speed and late.any():
                result.append((np.log(speed / self.speed), self.coefficient[late].mean()))
        logs, levels = np.array(result).T
        change = logs - logs.mean()
        rate = float(change @ levels / (change @ change)) if change.any() else 0.0
        return rate, float(levels[0])

    def steepest(self) -> float:
        """Return a guess of the stiffness: friction rises by no more than that with the pull."""
        edges = np.linspace(self.pull.min(), self.pull.max(), STRETCHES)
        bins = np.searchsorted(edges, self.pull, side="right")
        _, which, count = np.unique(bins, return_inverse=True, return_counts=True)
        mu, x = (np.bincount(which, y) / count for y in (self.coefficient, self.pull))
        way = 2.0 * np.ptp(self.pull) / STRETCHES
        rise = np.interp(self.path.places + way, x, mu) - np.interp(self.path.places, x, mu)
        return 2.0 * float(np.abs(rise).max()) / way + 1e-3 / max(self.slid, 1e-12)


def record_of(measurement: Measurement, load: float = 1.0) -> Record:
    """Return the record of a measurement with friction, load and pull."""
    if measurement.trials:
        raise InputError(
            f"a rate-and-state fit needs one record, got {len(measurement.trials)} trials: give one"
            " of them, and another to validate."
        )
    for name in ("time", "friction", "pull"):
        if getattr(measurement, name) is None:
            raise InputError(
                "a rate-and-state fit needs one record with time, friction and pull (the position"
                f" of the load point); {name} is missing. A coefficient is a friction at load 1."
            )
    assert measurement.time is not None
    loads = np.asarray(load if measurement.load is None else measurement.values("load"))
    if np.any(loads <= 0.0):
        raise InputError("a rate-and-state fit needs loads above 0 N throughout.")
    time = measurement.time - measurement.time[0]
    pull = np.asarray(measurement.values("pull"))
    pull = pull - pull[0]
    path = path_of(time, pull)
    if not len(path.steps):
        raise InputError(
            "a rate-and-state fit needs a step of the speed of the load point, and"
            f" Measurement.pull moves at {quantity(path.lasting[0], 'm/s')} throughout: a and b"
            " say how"
            " friction changes with speed."
        )
    if path.lasting[0] <= 0.0 or np.any(path.lasting < -0.01 * path.lasting.max()):
        raise InputError(
            "a rate-and-state fit needs a load point that moves forwards at first and never back,"
            f" got speeds from {quantity(path.lasting.min(), 'm/s')} to"
            f" {quantity(path.lasting.max(), 'm/s')}."
        )
    coefficient = np.asarray(measurement.values("friction")) / loads
    if np.mean(coefficient) <= 0.0:
        raise InputError(
            f"the mean coefficient of friction is {number(float(np.mean(coefficient)))} and must be"
            " above 0: count friction positive in the direction of the pull, with a gain such as"
            ' gain={"friction": -1}, or correct the offset of the force.'
        )
    return Record(
        time=time,
        coefficient=coefficient,
        pull=pull,
        path=path,
        begins=float(measurement.time[0]),
        load=float(loads.mean()),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class SteppedLaw:
    """A law that is compared: its form, and what is held of it."""

    form: RateStateForm
    held: Mapping[str, float] = field(default_factory=dict)
    """Values that are held, by the name of the parameter."""
    given: Mapping[str, float] = field(default_factory=dict)
    """Values at which a search begins, too."""
    regularised: bool = False
    """Whether it has an arcsinh in place of a logarithm; they agree in forward sliding."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that runs depend on, the stiffness last."""
        own = [name for name in self.form.fit_order if name != LEVEL]
        return (*own, STIFFNESS) if own else ()


def path_of_parameter(name: str) -> str:
    """Return the path of a parameter of a law, or of the stiffness.

    Examples
    --------
    >>> path_of_parameter("stiffness"), path_of_parameter("direct_effect")
    ('mechanism.stiffness', 'friction.direct_effect')
    """
    return f"mechanism.{name}" if name == STIFFNESS else f"friction.{name}"


class VelocitySteps(Simulated):
    """Means of the coefficient over short stretches of a record, weighted by their samples.

    Parameters
    ----------
    record : Record
        The record.
    laws : mapping of str to SteppedLaw
        What is compared.
    block : TowedBlock
        The machine as stated.
    doubt : float
        Prior deviation of the logarithm of its stiffness; 0 if it is held.
    reference : float
        Speed at which the level holds [m/s].
    drift : {"auto", "none", "linear"}
        What friction may do along the way: settle and change, nothing, or change linearly.
    lowest : float
        Lower bound of the evolution effect.
    """

    no_run = (
        "the slider runs away from every start: check the stiffness of the machine and the units of"
        " pull and friction"
    )

    def __init__(
        self,
        record: Record,
        laws: Mapping[str, SteppedLaw],
        *,
        block: TowedBlock,
        doubt: float,
        reference: float,
        drift: str = "auto",
        lowest: float = 0.0,
    ) -> None:
        self.record, self.laws, self.reference, self.lowest = record, laws, reference, lowest
        self.block, self.doubt = block, doubt
        self.stiffness = block.stiffness / record.load
        self.times, self.measured, count = record.stretches()
        self.weights = count / count.mean()
        self.size = float(np.average(self.measured, weights=count))
        path = record.path
        ways = np.abs(np.diff(np.interp(path.segments, path.time, path.position)))
        way = record.slid / len(path.steps)
        # nothing slides in a hold at the end
        self.way = way if way > HELD * ways.max() else float(ways[ways > HELD * ways.max()].mean())
        scatter = float(np.sqrt(0.5 * np.mean(np.diff(self.measured) ** 2)))
        self.tolerance = max(EXACT * scatter, 1e-7)  # of a record without noise
        self._means = np.average(self._along(self.times), axis=0, weights=count)
        levels = {law.held.get(LEVEL) for law in laws.values()}
        self.level = next(iter(levels)) if len(levels) == 1 else None
        self.always = self._always(drift)
        simple = [name for name, law in laws.items()
                  if not law.form.second and law.form.evolution != "nagata"]  # fmt: skip
        self.stages = tuple(
            item for item in (simple, [name for name in laws if name not in simple]) if item
        )

    def _always(self, drift: str) -> Always:
        level = NONE if self.level is not None else PRIORS[LEVEL][1]
        trends = [*TRENDS.items()]
        if drift != "auto":
            trends = [(NONE, 1.0)] if drift == "none" else [(x, 0.5) for x, _ in trends[1:]]
        self.trending = np.array([trend > min(TRENDS) for trend, _ in trends])
        sizes = [
            [level, trend, *(NONE if drift == "linear" else trend for _ in SETTLING)]
            for trend, _ in trends
        ]
        return Always(
            columns=self.along(self.times),
            sizes=self.size * np.array(sizes),
            prior=np.array([chance for _, chance in trends]),
        )

    def along(self, times: Array) -> Array:
        """Return the columns of what is always there at times (n, q): the level is that midway."""
        return np.column_stack([np.ones_like(times), self._along(times) - self._means])

    def _along(self, times: Array) -> Array:
        path = self.record.path
        x = np.interp(times, path.time, path.position) / path.position[-1]
        return np.column_stack([x, *(np.exp(-x / way) for way in SETTLING)])

    def prior(self, family: str) -> float:
        form = self.laws[family].form
        return -PRICES[form.evolution] - PRICES[SECOND] * form.second

    # ------------------------------------------------------------------ coordinates
    def _is_logarithm(self, family: str, name: str) -> bool:
        plain = name in (EVOLVED, SECOND)
        return not (plain or (name == DIRECT and self.laws[family].form.evolution == "none"))

    def _prior(self, family: str, name: str) -> tuple[float, float]:
        """Return the mean and the deviation of a coordinate."""
        if name == STIFFNESS:
            return math.log(self.stiffness), self.doubt
        middle, deviation = PRIORS[name]
        unit = {DISTANCE: self.way, FURTHER: 1.0, STRESS: 1.0}.get(name, self.size)
        if self._is_logarithm(family, name):
            return math.log(middle * unit), deviation
        if name == DIRECT:  # without a state, it is a - b
            return 0.0, PRIORS[EVOLVED][1] * unit
        return middle * unit, deviation * unit

    def _free(self, family: str) -> list[str]:
        law = self.laws[family]
        return [name for name in law.names if name not in law.held
                and not (name == STIFFNESS and self.doubt == 0.0)]  # fmt: skip

    def vary(self, family: str) -> Unknowns:
        names = self._free(family)
        numbers = np.array([self._prior(family, name) for name in names]).reshape(-1, 2)
        return Unknowns(names=tuple(names), mean=numbers[:, 0], deviation=numbers[:, 1])

    def values(self, family: str, points: Array) -> dict[str, Array]:
        """Return the parameters that runs depend on (k,), SI, at points (k, p)."""
        law, names = self.laws[family], self._free(family)
        results = {name: np.full(len(points), value) for name, value in law.held.items()}
        results.setdefault(STIFFNESS, np.full(len(points), self.stiffness))
        for name, x in zip(names, points.T, strict=True):
            results[name] = np.exp(np.minimum(x, 300.0)) if self._is_logarithm(family, name) else x
        if FURTHER in names:
            results[FURTHER] = results[FURTHER] * results[DISTANCE]
        return self._stressed(family, results, 1.0)

    def _stressed(self, family: str, values: Mapping[str, Any], power: float) -> dict[str, Any]:
        """Return values from those that a step shows, or (power -1) the reverse."""
        free, more = self._free(family), (1.0 + values.get(STRESS, 0.0)) ** power
        changed = {**values}
        if STRESS in values:
            a = values[DIRECT] / (more if DIRECT not in free and power > 0.0 else 1.0)
            changed |= {DIRECT: a * more, DISTANCE: values[DISTANCE] / more,
                        EVOLVED: values[EVOLVED] + a * (more - 1.0)}  # fmt: skip
        return {name: changed[name] if name in free else x for name, x in values.items()}

    def _point(self, family: str, values: Mapping[str, float]) -> Array:
        """Return the point (p,) with some values, and the prior's for the others."""
        point, values = [], self._stressed(family, values, -1.0)
        for name in self._free(family):
            x = values.get(name)
            if x is not None and name == FURTHER:
                x = x / values.get(DISTANCE, x)
            if x is None or (self._is_logarithm(family, name) and x <= 0.0):
                point.append(self._prior(family, name)[0])
            else:
                point.append(math.log(x) if self._is_logarithm(family, name) else x)
        return np.array(point)

    def starts(self, family: str, ends: Mapping[str, Array]) -> Array:
        law = self.laws[family]
        rate, _ = self.record.levels()
        tried: list[Mapping[str, float]] = [{STIFFNESS: self.stiffness}]
        if self.doubt > PRIORS[STIFFNESS][1]:
            tried.append({STIFFNESS: self.record.steepest()})
        if law.form.evolution == "none":
            tried = [{DIRECT: rate, **item} for item in tried]
        else:
            floor = max(self.lowest, 0.0) + 1e-3 * self.size
            direct = [max(rate, 0.0) + x * self.size for x in (0.0005, 0.01, 0.03)]
            tried = [
                {DIRECT: a, EVOLVED: max(a - rate, floor), DISTANCE: share * self.way, **item}
                for a in direct for share in DISTANCES for item in tried
            ]  # fmt: skip
            tried += self._from_simpler(family, ends)
        if law.given:
            tried.append(law.given)
        points = [self._point(family, {**item, **law.held}) for item in tried]
        return np.array(points).reshape(len(tried), -1)

    def _from_simpler(self, family: str, ends: Mapping[str, Array]) -> list[dict[str, float]]:
        """Return values of modes of laws that a law contains, with what it has besides."""
        form, results = self.laws[family].form, list[dict[str, float]]()
        for name, end in ends.items():
            other = self.laws[name].form
            if other.evolution == "none" or not form.contains(other):
                continue
            values = {key: float(x[0]) for key, x in self.values(name, end[None]).items()}
            if not form.second or other.second:
                results.append(values)
                continue
            for share, ratio in ((0.3, 4.0), (0.3, 12.0), (-0.2, 6.0)):
                part = share * values[EVOLVED]
                results.append({**values, EVOLVED: values[EVOLVED] - part, SECOND: part,
                              FURTHER: ratio * values[DISTANCE]})  # fmt: skip
        return results

    # ------------------------------------------------------------------ runs
    def simulate(self, asked: Mapping[str, Array]) -> dict[str, Array]:
        return self.at(asked, self.times)

    def at(self, asked: Mapping[str, Array], times: Array) -> dict[str, Array]:
        """Return coefficients (n, k) at times, without what is always there."""
        values = {name: self.values(name, points) for name, points in asked.items()}
        results: dict[str, Array] = {}
        for count in (1, 2):
            names = [name for name in asked if self._states(name) == count]
            names.sort(key=lambda name: self.laws[name].form.evolution)
            if names:
                results |= self._evolving(names, values, times)
        for name in asked:
            if not self._states(name):
                results[name] = self._without_state(values[name], len(asked[name]), times)
            if self.level is not None:
                results[name] = results[name] + self.level
        return results

    def _states(self, family: str) -> int:
        form = self.laws[family].form
        return 0 if form.evolution == "none" else 1 + form.second

    @property
    def _pulled(self) -> tuple[Array, Array]:
        path = self.record.path
        return path.time, np.maximum(path.speeds, 0.0)

    def _evolving(
        self, names: Sequence[str], values: Mapping[str, Mapping[str, Array]], times: Array
    ) -> dict[str, Array]:
        ends = np.cumsum([0, *(len(values[name][STIFFNESS]) for name in names)])
        evolution: dict[str, slice] = {}
        for name, first, last in zip(names, ends[:-1], ends[1:], strict=True):
            follows = self.laws[name].form.evolution
            begun = evolution[follows].start if follows in evolution else int(first)
            evolution[follows] = slice(begun, int(last))

        def joined(key: str) -> Array:
            every = [values[name] for name in names]
            return np.concatenate([own.get(key, np.zeros_like(own[STIFFNESS])) for own in every])

        states = [(EVOLVED, DISTANCE), (SECOND, FURTHER)][: self._states(names[0])]
        effects = [joined(effect) for effect, _ in states]
        stress, evolved = joined(STRESS), np.sum(effects, axis=0)
        fails = (effects[0] < self.lowest) | ((stress > 0.0) & (evolved <= 1e-3 * joined(DIRECT)))
        sliders = Sliders(
            direct=joined(DIRECT),
            effects=effects,
            distances=[joined(distance) for _, distance in states],
            stress=np.where(fails, 0.0, stress),
            stiffness=joined(STIFFNESS),
            evolution=evolution,
        )
        rows = coefficients_of(sliders, *self._pulled, times, reference=self.reference,
                               tolerance=self.tolerance)  # fmt: skip
        rows[:, fails] = np.nan
        return {
            name: rows[:, first:last]
            for name, first, last in zip(names, ends[:-1], ends[1:], strict=True)
        }

    def _without_state(self, values: Mapping[str, Array], count: int, times: Array) -> Array:
        """Return coefficients (n, k): a dw/dt = k (V_l - V) has a closed form.

        1/V relaxes towards 1/V_l over the way a/k of the load point.
        """
        if DIRECT not in values:
            return np.zeros((len(times), count))
        knots, speeds = self._pulled
        a, V = values[DIRECT], np.full(count, speeds[0])
        rate = np.where(a > 0.0, values[STIFFNESS] / np.where(a > 0.0, a, 1.0), np.inf)
        logs = np.full((len(times), count), np.log(speeds[0]))
        for start, end, speed in zip(knots[:-1], knots[1:], speeds, strict=True):
            here = (times > start) & (times <= end)
            t = np.append(times[here], end)[:, None] - start
            if speed > 0.0:
                with np.errstate(under="ignore", over="ignore"):
                    ratio = np.exp(-np.minimum(rate * speed * t, 700.0))
                path = -np.log(ratio / V + (1.0 - ratio) / speed)
            else:  # 1/V grows with time
                path = -np.log(1.0 / V + np.where(np.isfinite(rate), rate, 0.0) * t)
            logs[here], V = path[:-1], np.exp(path[-1])
        return np.asarray(a * (logs - math.log(self.reference)))

    # ------------------------------------------------------------------ results
    def title(self, family: str) -> str:
        return self.laws[family].form.title

    def sought(self, family: str) -> tuple[str, ...]:
        free = (*self._free(family), *([LEVEL] if self.level is None else []))
        return tuple(path_of_parameter(name) for name in ORDER if name in free)

    def derived(self, family: str) -> Mapping[str, Quantity]:
        form = self.laws[family].form
        if not {DIRECT, EVOLVED, SECOND} & {*self._free(family)}:
            return {}
        return {RATE: Quantity("a - b - b_2" if form.second else "a - b")}

    def quantities(self, family: str) -> Mapping[str, Quantity]:
        own = {path_of_parameter(name): item for name, item in fields_of(RateState).items()}
        return {**own, path_of_parameter(STIFFNESS): Quantity("k", "N/m", above=0)}

    def read(self, family: str, points: Array, coefficients: Array) -> dict[str, Array]:
        values = self.values(family, points)
        values.setdefault(LEVEL, coefficients[:, 0])
        values[STIFFNESS] = values[STIFFNESS] * self.record.load
        results = {path_of_parameter(name): x for name, x in values.items()}
        zero = np.zeros_like(values[LEVEL])
        effects = [values.get(name, zero) for name in (DIRECT, EVOLVED, SECOND)]
        return {**results, RATE: effects[0] - effects[1] - effects[2]}

    def result(self, family: str, values: Mapping[str, float]) -> tuple[RateState, TowedBlock]:
        law, form = self.laws[family], self.laws[family].form
        own = {name: values[path_of_parameter(name)] for name in form.fit_order}
        results = RateState(
            reference_velocity=self.reference,
            evolution=form.evolution,
            regularised=law.regularised,
            **{DIRECT: 0.0, **own},
        )
        stiffness = values[path_of_parameter(STIFFNESS)]
        return results, replace(self.block, load=self.record.load, stiffness=stiffness)

    def told(
        self, family: FamilyPosterior, name: str, estimates: Sequence[Estimate]
    ) -> list[Estimate]:
        results = {estimate.path: estimate for estimate in estimates}
        draws = self.values(name, family.points)
        direct = abs(float(self.values(name, family.mode[None]).get(DIRECT, np.zeros(1))[0]))
        for effect, distance in ((EVOLVED, DISTANCE), (SECOND, FURTHER)):
            own, way = path_of_parameter(effect), path_of_parameter(distance)
            if way not in results:
                continue
            spent = float(np.quantile(np.abs(draws[effect]), ENDS[0]))
            if family.is_prior(distance) or spent < THRESHOLDS.material * direct:
                symbols = (fields_of(RateState)[item].symbol for item in (effect, distance))
                why = "{} may be 0, and then {} has no effect".format(*symbols)
                if own in results:  # draws end above 0, where a law has no state
                    results[own] = replace(results[own], low=min(results[own].low, 0.0))
                results[way] = replace(results[way], low=-math.inf, high=math.inf, reason=why)
        return [*results.values()]

    def contains(self, name: str, other: str) -> bool:
        return self.laws[name].form.contains(self.laws[other].form)

    def stepped(
        self, family: str, points: Array, path: Path, times: Array, stiffer: float
    ) -> Array:
        """Return coefficients (n, k) at times of another path, on a machine stiffer by a factor."""
        other = copy.copy(self)
        other.record = replace(self.record, path=path)
        other.stiffness = stiffer * self.stiffness
        moved = np.array([math.log(stiffer) * (name == STIFFNESS) for name in self._free(family)])
        return other.at({family: points + moved}, times)[family]

    def foreseen(self, family: FamilyPosterior, name: str, record: Record) -> Array:
        """Return the coefficient (n,) that a law predicts of another record of the machine.

        What changed along the way of this record is of this record.
        """
        other = copy.copy(self)
        other.record = record
        seen = other.at({name: family.mode[None]}, record.time)[name][:, 0]
        return np.asarray(seen + family.usual[0])
