"""The best motion, what stands beside it, and trade-offs between goals.

`optimise_profile` searches, polishes, and certifies what it returns; a front of trade-offs is a
row of such results.
"""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import rig_toml
from stickslip.engine.executors import check_executor
from stickslip.engine.simulation import event_driven_law, simulate
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import ConvergenceError, InputError, ParameterError, not_whole
from stickslip.friction import Friction, FrictionLaw, Laws
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.drives import Profile, ThreePhase
from stickslip.quantities import named
from stickslip.show.display import Tabular
from stickslip.show.formatting import number, with_unit
from stickslip.study.optimisation import parametrisation
from stickslip.study.optimisation import problem as problems
from stickslip.study.optimisation.search import Memory, Told, polish, search

if TYPE_CHECKING:
    import pandas as pd


# The best motion that was found, and what stands beside it.

SHOWN_CYCLES = 5
"""Cycles that the rig file runs."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Optimum(Tabular):
    """The best motion within limits, by certified runs.

    `three_phase` is the three-phase motion optimised for the same goal within the same limits and
    in the same scenarios; `start` is the motion that the mechanism came with.
    """

    mechanism: Mechanism
    """With the best motion."""
    law: FrictionLaw | Laws
    """What holds it back."""
    searched: str
    """Kind of motion that was asked for."""
    goal: problems.Goal
    """What is large."""
    limits: problems.Limits
    """What the motion may take."""
    scenarios: problems.Scenarios
    """What it stood."""
    best: problems.ScoredMotion
    """The best motion: its goal, and what is left of each limit."""
    three_phase: problems.ScoredMotion | None
    """The best three-phase motion; None if none keeps the limits."""
    start: problems.ScoredMotion
    """The motion that the mechanism came with, within the limits or not."""
    run: Trajectory
    """Certified run with the law as given, from rest until its cycles repeat."""
    polished: bool
    """Whether the best comes from the quadratic programme and not from the evolution strategy."""
    evaluations: int
    """Motions that were tried, each in every scenario."""
    seed: int
    """What the random numbers came from."""
    cancelled: bool
    """Whether the search was ended early."""

    @property
    def profile(self) -> Profile:
        """The best motion."""
        return self.best.profile

    @property
    def kind(self) -> str:
        """Its kind: another than `searched` where no such motion exceeds the one it began from."""
        if isinstance(self.profile, ThreePhase) and self.profile.last is not None:
            return parametrisation.ThreeAccelerations.kind
        return parametrisation.kind_of(profile_values(self.profile)["type"])

    @property
    def shortfall(self) -> str:
        """Sentence that says so; empty where the best motion is of the kind that was searched."""
        if self.kind == self.searched:
            return ""
        return (
            f"No {self.searched} motion within the limits was found that exceeds this"
            f" {self.kind} motion, from which the search began."
        )

    @property
    def value(self) -> float:
        """Its goal, in SI units."""
        return self.best.value

    @property
    def margins(self) -> tuple[problems.Margin, ...]:
        """What it leaves of each limit."""
        return self.best.margins

    @property
    def cycle(self) -> problems.Cycle:
        """Its steady cycle, in the scenario that does worst."""
        return min(self.best.cycles, key=self.goal.value)

    @property
    def factor(self) -> float | None:
        """Its goal over that of the best three-phase motion; None where that has none above 0."""
        return _over(self.value, self.three_phase)

    @property
    def factor_over_start(self) -> float | None:
        """Its goal over that of the motion it started from, which may break limits."""
        return _over(self.value, self.start)

    def to_dict(self) -> dict[str, Any]:
        """Return numbers and texts, for JSON."""
        return {
            "goal": self.goal.name,
            "unit": self.goal.unit,
            "kind": self.kind,
            "searched": self.searched,
            "value": self.value,
            "profile": profile_values(self.profile),
            "margins": [_margin(margin) for margin in self.margins],
            "limits": self.limits.given(),
            "scenarios": self.scenarios.words,
            "cycle": _cycle(self.cycle),
            "three_phase": _judged(self.three_phase),
            "start": _judged(self.start),
            "factor": self.factor,
            "factor_over_start": self.factor_over_start,
            "polished": self.polished,
            "evaluations": self.evaluations,
            "seed": self.seed,
            "cancelled": self.cancelled,
            "certified": self.run.certificate.certified,
        }

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the motions that were compared as a pandas DataFrame, a row each.

        Columns are the goal, whether all limits are kept, and numbers of the steady cycle in the
        scenario that does worst [SI].
        """
        import pandas as pd

        motions = {"best": self.best, "three-phase": self.three_phase, "start": self.start}
        rows = [
            {
                "motion": name,
                self.goal.name: motion.value,
                "feasible": motion.feasible,
                **(_cycle(motion.shown(self.goal)) if motion.cycles else {}),
                "reason": motion.early_end,
            }
            for name, motion in motions.items()
            if motion is not None
        ]
        return pd.DataFrame(rows)

    def _over(self) -> str:
        return "motion"

    def _column_units(self) -> Mapping[str, str]:
        return {self.goal.name: self.goal.unit}

    def to_toml(self) -> str:
        """Return a rig file with the best motion, which `load_rig` and the command line read."""
        title = f"Best {self.kind} motion for {self.goal.title}"
        t_end = SHOWN_CYCLES * self.cycle.period
        return rig_toml(self.mechanism, self.law, title=title, t_end=t_end)

    def __repr__(self) -> str:
        head = f"{self.goal.title} {with_unit(number(self.value, 6), self.goal.unit)}"
        if self.factor is not None and self.best is not self.three_phase:
            head += f", {number(self.factor, 4)} times the best three-phase motion"
        left = ", ".join(
            f"{m.name} {number(m.reached, 5)} of {with_unit(number(m.allowed, 5), m.unit)}"
            for m in self.margins
        )
        return "\n ".join(filter(None, (f"<{head}", str(self.profile), self.shortfall, left))) + ">"


def _over(value: float, other: problems.ScoredMotion | None) -> float | None:
    return None if other is None or not other.value > 0.0 else value / other.value


def profile_values(profile: Profile) -> dict[str, Any]:
    """Return a profile as its table in a rig file.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import SineSwing
    >>> profile_values(SineSwing(amplitude=0.5, frequency=2.0))
    {'type': 'sine-swing', 'amplitude': 0.5, 'frequency': 2.0}
    """
    from stickslip.mechanisms.drives import PROFILES

    names = {kind: name for name, kind in PROFILES.items()}
    values = {field.name: getattr(profile, field.name) for field in dataclasses.fields(profile)}
    listed = {k: list(v) if isinstance(v, tuple) else v for k, v in values.items()}
    return {"type": names.get(type(profile), type(profile).__name__)} | listed


def _margin(margin: problems.Margin) -> dict[str, Any]:
    return dataclasses.asdict(margin) | {"margin": margin.margin}


def _cycle(cycle: problems.Cycle) -> dict[str, float]:
    motion = ("period", "travel", "work", "energy", "position", "rate", "acceleration")
    names = (*motion, "effort", "load_share", "back_slip")
    return {name: getattr(cycle, name) for name in names}


def _judged(judged: problems.ScoredMotion | None) -> dict[str, Any] | None:
    if judged is None:
        return None
    return {
        "value": judged.value,
        "feasible": judged.feasible,
        "repeats": all(cycle.repeats for cycle in judged.cycles),
        "reason": judged.early_end,
        "profile": profile_values(judged.profile),
        "margins": [_margin(margin) for margin in judged.margins],
    }


Array = NDArray[np.float64]

REFERENCE = "three-phase"
MOST_POLISHED = 2
"""Ends of laps that are polished, the best first."""
POLISH = 6
"""Motions that a polish may try, over those of a search: splines with many knots need that many."""
LEAST_ROUNDS = 40
"""Rounds that a polish may take however few motions a search tries: with fewer it gets nowhere."""


def optimise_profile(
    mechanism: Mechanism,
    law: Friction,
    *,
    limits: problems.Limits,
    goal: problems.GoalName = "travel",
    kind: parametrisation.KindName = "three-phase",
    interval: Mapping[str, tuple[float, float]] | None = None,
    scenarios: Sequence[Friction] | None = None,
    quantile: float | Literal["mean"] = 0.05,
    points: int = 5,
    knots: int = 12,
    evaluations: int = 2000,
    seed: int = 0,
    state: str | Path | None = None,
    executor: Executor | None = None,
    progress: Told | None = None,
) -> Optimum:
    """Find the motion of a kind that drives a mechanism best within limits.

    A search by an evolution strategy (CMA-ES) with restarts, whose best is polished by sequential
    quadratic programming; first for the three-phase motion, from which the search for another kind
    begins. It never returns less than a motion within the limits from which it could begin: where
    nothing better of the kind was found, the result is that motion, and `Optimum.kind` its kind.
    Each motion is run from rest until its cycles repeat, and judged by the last one; the result by
    runs with certificates, its extremes looked for more finely.

    Parameters
    ----------
    mechanism : Mechanism
        With a prescribed motion, such as ``PendulumCart(pendulum=Prescribed(...))`` or
        ``Capsule(drive=Prescribed(...))``; a limit of its motor holds beside `limits`.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back.
    limits : Limits
        What the motion may take.
    goal : {"travel", "speed", "economy"}
        Travel per cycle [m], mean speed [m/s], or travel per positive work of the motor [m/J].
    kind : {"three-phase", "three-accelerations", "seven-step", "sine", "spline"}
        Kind of motion; that of ``"three-accelerations"`` is a three-phase motion whose last phase
        need not be like the first. ``"timed-three-phase"``, ``"sine-swing"`` and
        ``"spline-swing"``, as in rig files, will do too.
    interval : mapping, optional
        Lowest and highest value of parameters by path, such as
        ``{"friction.kinetic_coefficient": (0.15, 0.25)}``: the goal is the worst case, and the
        limits hold in all cases, of `points` even values each, ends included.
    scenarios : sequence of FrictionLaw, optional
        Samples instead, such as the laws that ``verdict.sample`` draws: the goal is a quantile of
        theirs or their mean, and the limits hold for all of them.
    quantile : float or "mean"
        Which quantile of the samples, 0 of which is the worst case; or their mean.
    points : int
        Values of each parameter in `interval`.
    knots : int
        Positions of a spline, 4 to 60.
    evaluations : int
        Motions that the evolution strategy tries, rounded up to whole generations. The polish comes
        on top: of the start, and of the ends of the best two laps, each time by at most six times
        as many motions, or 80 (n + 1) if that is more, for the slopes by the n numbers of a motion
        (3 of a three-phase, 4 of three accelerations, 6 of a seven-step and 2 of a sine
        motion, knots + 1 of a spline).
        Another kind than ``"three-phase"`` takes all this for both kinds. `Optimum.evaluations` is
        the number of all that were tried.
    seed : int
        Of the random numbers: the same seed gives the same result.
    state : path, optional
        File that keeps what was found after each generation. If it is there already, the search
        goes on from it, and ends where it would have ended without an interruption.
    executor : concurrent.futures.Executor, optional
        Where the motions of a generation are evaluated at the same time; here if not given. The
        polish is done here. The result does not depend on it.
    progress : callable, optional
        Called after each generation with the name of the search, the motions tried and in all, and
        the best goal so far, NaN without one. If it returns False, the best so far is the result.

    Returns
    -------
    Optimum
        The best motion, what it leaves of each limit, its certified run, and how it compares.

    Raises
    ------
    InputError
        If an argument cannot be used.
    ConvergenceError
        If no motion was found that keeps the limits.

    References
    ----------
    N. Hansen, The CMA evolution strategy: a tutorial, arXiv:1604.00772.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> from stickslip.study.optimisation import Limits
    >>> stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    >>> limits = Limits(position=0.01, rate=0.8, effort=10.0, back_slip=0.0)
    >>> law = Coulomb(kinetic_coefficient=0.2)
    >>> best = optimise_profile(capsule, law, limits=limits, goal="speed", evaluations=10)
    >>> best.best.feasible, best.value > best.start.value
    (True, True)
    """
    plan = _plan(mechanism, limits, evaluations, seed)
    check_executor(executor)
    law = event_driven_law(mechanism, law)
    _check(progress)
    problem = problems.Problem(
        mechanism=plan.mechanism,
        scenarios=problems.scenarios_of(
            plan.mechanism, law, interval, _each(mechanism, scenarios), quantile, points
        ),
        goal=named(problems.GOALS, goal, "goal"),
        limits=plan.limits,
    )
    known = parametrisation.kind_of(kind)
    space = parametrisation.space_of(known, plan.limits, knots)
    subject = repr((problem, plan, law, space, _versions()))
    memory = Memory(state, subject)  # a file that cannot be used is told before anything runs
    start = problem.judge(plan.profile, samples=problems.FINER)
    work = _Work(problem=problem, plan=plan, memory=memory, watch=progress, executor=executor)
    reference = best = work.best_of(parametrisation.space_of(REFERENCE, plan.limits, knots), start)
    if known != REFERENCE:
        best = work.best_of(space, start, done=reference)
    # The result, run once more with a certificate.
    problem, plan = work.problem, work.plan
    if best.judged is None:
        raise ConvergenceError(
            f"no {known} motion satisfies the limits among the {best.evaluations} evaluated: widen"
            " the limits, or increase evaluations."
        )
    whole = problems.fitted(plan.mechanism, best.judged.profile, limit=plan.motor_limit)
    return Optimum(
        mechanism=whole,
        law=law,
        searched=known,
        goal=problem.goal,
        limits=plan.limits,
        scenarios=problem.scenarios,
        best=best.judged,
        three_phase=reference.judged,
        start=start,
        run=simulate(whole, law, t_end=_steady_end(whole, law)),
        polished=best.polished,
        evaluations=best.evaluations,
        seed=plan.seed,
        cancelled=best.cancelled,
    )


def _each(mechanism: Mechanism, laws: Sequence[Friction] | None) -> list[FrictionLaw | Laws] | None:
    """Return laws of scenarios, checked; what is no sequence of them is told later."""
    if laws is None or len(mechanism.contacts()) < 2:
        return laws  # type: ignore[return-value]  # a sequence of laws
    return [event_driven_law(mechanism, law) for law in laws]


def _versions() -> list[str]:
    """Return the versions that a search depends on."""
    from importlib.metadata import version

    return [version(name) for name in ("cma", "numpy", "stickslip")]


def _steady_end(mechanism: Mechanism, law: FrictionLaw | Laws) -> float:
    """Return when the cycles of a motion have come to repeat [s]."""
    return problems.measure(mechanism, law).run.span[1]


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """What was asked for, checked."""

    mechanism: Mechanism
    profile: Profile
    motor_limit: float | None
    limits: problems.Limits
    evaluations: int
    seed: int


def _plan(mechanism: Mechanism, limits: problems.Limits, evaluations: int, seed: int) -> _Plan:
    """Check the arguments; the motor's limit becomes one of the limits."""
    if not isinstance(mechanism, Mechanism):
        raise InputError(f"mechanism must be a Mechanism such as PendulumCart, got {mechanism!r}.")
    if not isinstance(limits, problems.Limits):
        raise InputError(f"limits must be Limits(position=..., rate=...), got {limits!r}.")
    for name, value, least in (("evaluations", evaluations, 1), ("seed", seed, 0)):
        if type(value) is not int or value < least:
            raise ParameterError(not_whole(name, least, value))
    motor = getattr(mechanism, problems.motor_of(mechanism))
    problems.slip_of_body(mechanism)
    given = limits.given()
    if motor.limit is not None:
        given["effort"] = min(given.get("effort", motor.limit), motor.limit)
    return _Plan(
        mechanism=problems.fitted(mechanism, motor.profile),
        profile=motor.profile,
        motor_limit=motor.limit,
        limits=problems.Limits(**given),
        evaluations=evaluations,
        seed=seed,
    )


def _check(progress: object) -> None:
    if progress is not None and not callable(progress):
        raise InputError(
            "progress must be callable with the search, the number of motions evaluated and their"
            f" total, and the best goal, got {progress!r}."
        )


@dataclass(frozen=True, kw_only=True)
class _Best:
    """The best of one kind, and what it took up to here."""

    judged: problems.ScoredMotion | None
    polished: bool = False
    evaluations: int = 0
    cancelled: bool = False


@dataclass(frozen=True, kw_only=True)
class _Work:
    """Searches for one problem."""

    problem: problems.Problem
    plan: _Plan
    memory: Memory
    watch: Told | None
    executor: Executor | None

    def best_of(
        self,
        space: parametrisation.Space,
        start: problems.ScoredMotion,
        *,
        done: _Best | None = None,
    ) -> _Best:
        """Return the best motion: of those the search may begin from, its own, and the polish.

        It may begin from a motion of another kind, such as a spline from three phases. Whatever a
        search with a small budget meets, it returns no less than a feasible motion it began from.
        """
        before = done or _Best(judged=None)
        begins = [(start, False), *([(before.judged, before.polished)] if before.judged else [])]
        known = [begin for begin in begins if begin[0].feasible and _has_place(space, begin[0])]
        if before.cancelled:
            return _best(known, before.evaluations, cancelled=True)
        inner = self.problem.tighter()
        first = _best(known).judged or begins[-1][0]
        point, more = self._polished_start(inner, space, first.profile)
        found = search(
            inner,
            space,
            point,
            name=space.kind,
            budget=self.plan.evaluations,
            seed=self.plan.seed,
            memory=self.memory,
            watch=self.watch,
            executor=self.executor,
        )
        count = before.evaluations + more + found.evaluations
        for rank, point in enumerate(found.best[:MOST_POLISHED]):
            if rank == 0:
                known.append((self._finely(space, point), False))
            if not found.cancelled:
                finer, more = polish(
                    inner, space, point, budget=self._polish(space), watch=self.watch
                )
                count += more
                if finer is not None:
                    known.append((self._finely(space, finer), True))
        return _best(known, count, cancelled=found.cancelled)

    def _polished_start(
        self, problem: problems.Problem, space: parametrisation.Space, first: Profile
    ) -> tuple[Array | None, int]:
        """Return where a search begins: at a motion, better and within limits if that can be."""
        point = space.place(first)
        if point is None:
            return None, 0
        better, count = polish(problem, space, point, budget=self._polish(space), watch=self.watch)
        return (point if better is None else better), count

    def _polish(self, space: parametrisation.Space) -> int:
        """Return the motions that one polish may try: a round takes differences both ways."""
        return max(POLISH * self.plan.evaluations, LEAST_ROUNDS * (2 * space.size + 2))

    def _finely(self, space: parametrisation.Space, point: Array) -> problems.ScoredMotion:
        return self.problem.judge(space.profile(point), samples=problems.FINER)


def _has_place(space: parametrisation.Space, motion: problems.ScoredMotion) -> bool:
    """Whether a search of a kind may begin from a motion."""
    return space.place(motion.profile) is not None


def _best(
    known: Sequence[tuple[problems.ScoredMotion, bool]],
    evaluations: int = 0,
    *,
    cancelled: bool = False,
) -> _Best:
    """Return the best motion within the limits, the first of equals."""
    good = [pair for pair in known if pair[0].feasible]
    judged, polished = max(good, key=lambda motion: motion[0].value, default=(None, False))
    return _Best(judged=judged, polished=polished, evaluations=evaluations, cancelled=cancelled)


# Trade-offs between goals of a motion: the Pareto front by the method of epsilon-constraints.
#
# Speed is to be large; the energy per travel and the back-slip are to be small. The front is walked
# along one of the two others:
#
# 1. Its ends: the motion that is fastest within the limits, and the one that costs least, which has
#    the largest travel per work, or is the fastest without any back-slip.
# 2. Between their costs, evenly spread bounds: the fastest motion with the cost as a further limit,
#    searched from the motion whose cost is nearest.
# 3. What another motion beats in both speed and cost is dropped.
#
# Each motion is the result of `optimise_profile`: certified, within all limits, in all scenarios.
#
# Source: Y. Y. Haimes, L. S. Lasdon, D. A. Wismer, IEEE Trans. Syst. Man Cybern. 1 (1971) 296-297.

CostName: TypeAlias = Literal["energy", "back_slip"]
COSTS = {"energy": "J/m", "back_slip": "m"}
"""What a front trades speed for, with units: names of `Limits` and of `Cycle`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ParetoFront(Tabular):
    """Motions none of which another beats in both speed and cost, the fastest first."""

    cost: CostName
    """What speed is traded for."""
    motions: tuple[Optimum, ...]
    """Results of `optimise_profile`, the fastest first."""

    @property
    def speeds(self) -> NDArray[np.float64]:
        """Mean speeds (n,) [m/s]."""
        return np.array([speed_of(motion) for motion in self.motions])

    @property
    def costs(self) -> NDArray[np.float64]:
        """Energies per travel [J/m] or back-slips per cycle [m] (n,), the worst scenario's."""
        return np.array([cost_of(motion, self.cost) for motion in self.motions])

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each motion."""
        import pandas as pd

        return pd.DataFrame(
            {
                "speed": self.speeds,
                self.cost: self.costs,
                "profile": [str(motion.profile) for motion in self.motions],
            }
        )


def cost_of(motion: Optimum, cost: CostName) -> float:
    """Return the cost of a motion in the scenario that does worst."""
    return max(float(getattr(cycle, cost)) for cycle in motion.best.cycles)


def pareto_front(
    mechanism: Mechanism,
    law: Friction,
    *,
    limits: problems.Limits,
    cost: CostName = "energy",
    points: int = 7,
    progress: Callable[[int, int], object] | None = None,
    **options: object,
) -> ParetoFront:
    """Find motions that trade mean speed for energy or for back-slip.

    Parameters
    ----------
    mechanism : Mechanism
        With a prescribed motion, see `optimise_profile`.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back.
    limits : Limits
        What the motions may take.
    cost : {"energy", "back_slip"}
        Work of the motor over the travel [J/m], or back-slip per cycle [m].
    points : int
        Motions between the ends of the front.
    progress : callable, optional
        Called with the motions that were optimised and how many there will be; if it returns
        False, the front so far is the result.
    **options : object
        ``kind``, ``scenarios``, ``interval``, ``quantile``, ``evaluations``, ``seed``,
        ``executor`` and the others of `optimise_profile`, for each motion.

    Returns
    -------
    ParetoFront
        The motions, the fastest first.

    Raises
    ------
    InputError
        If an argument cannot be used.
    ParameterError
        If the number of points is no whole number of at least 0.
    ConvergenceError
        If no motion keeps the limits.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> from stickslip.study.optimisation import Limits, pareto_front
    >>> stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    >>> limits = Limits(position=0.01, rate=0.8, acceleration=100.0)
    >>> law = Coulomb(kinetic_coefficient=0.2)
    >>> front = pareto_front(capsule, law, limits=limits, points=1, evaluations=10)
    >>> bool((front.speeds[1:] < front.speeds[:-1]).all())
    True
    """
    if cost not in COSTS:
        raise InputError(f"cost must be {' or '.join(map(repr, COSTS))}, got {cost!r}.")
    if type(points) is not int or points < 0:
        raise ParameterError(not_whole("points", 0, points))
    motions: list[Optimum] = []

    def search(goal: problems.GoalName = "speed", bound: float | None = None) -> bool:
        """Optimise with a bound of the cost; return whether the walk goes on."""
        near = min(motions, key=lambda m: abs(cost_of(m, cost) - (bound or 0.0)), default=None)
        given = limits if bound is None else dataclasses.replace(limits, **{cost: bound})
        start = mechanism if near is None else near.mechanism
        try:
            motions.append(optimise_profile(start, law, limits=given, goal=goal, **options))  # type: ignore[arg-type]  # those of the other function
        except ConvergenceError:
            if not motions:
                raise
        return progress is None or progress(len(motions), 2 + points) is not False

    running = search()
    if running and cost_of(motions[0], cost) > 0.0:
        running = search("economy") if cost == "energy" else search(bound=0.0)
    costs = [cost_of(motion, cost) for motion in motions]
    for bound in np.linspace(max(costs), min(costs), points + 2)[1:-1].tolist():
        if not running or len(set(costs)) < 2:
            break
        running = search(bound=bound)
    return ParetoFront(cost=cost, motions=_not_beaten(motions, cost))


def speed_of(motion: Optimum) -> float:
    """Return the mean speed of a motion in the scenario that does worst [m/s]."""
    return min(cycle.travel / cycle.period for cycle in motion.best.cycles)


def _not_beaten(motions: list[Optimum], cost: CostName) -> tuple[Optimum, ...]:
    """Return the motions that no other beats, the fastest first."""
    ranked = sorted(motions, key=lambda motion: (-speed_of(motion), cost_of(motion, cost)))
    front: list[Optimum] = []
    for motion in ranked:
        if speed_of(motion) > 0.0 and (
            not front or cost_of(motion, cost) < cost_of(front[-1], cost)
        ):
            front.append(motion)
    return tuple(front)
