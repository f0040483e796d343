"""The verb that looks for the best motion."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, final

import numpy as np
from numpy.typing import NDArray

from stickslip.drives import Profile
from stickslip.errors import ConvergenceError, InputError, ParameterError, not_whole
from stickslip.executors import check_executor
from stickslip.friction import Friction, FrictionLaw, Laws
from stickslip.mechanisms import Mechanism
from stickslip.optimisation.cma_search import Memory, Told, search
from stickslip.optimisation.cycle_metrics import fitted, measure, motor_of, slip_of_body
from stickslip.optimisation.local_refinement import polish
from stickslip.optimisation.parametrisation import KindName, Space, kind_of, space_of
from stickslip.optimisation.problem import FINER, GOALS, GoalName, Limits, Problem, ScoredMotion
from stickslip.optimisation.result import Optimum
from stickslip.optimisation.scenarios import scenarios_of
from stickslip.quantities import named
from stickslip.simulation import event_driven_law, simulate

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
    limits: Limits,
    goal: GoalName = "travel",
    kind: KindName = "three-phase",
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
    >>> from stickslip.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> from stickslip.optimisation import Limits
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
    problem = Problem(
        mechanism=plan.mechanism,
        scenarios=scenarios_of(
            plan.mechanism, law, interval, _each(mechanism, scenarios), quantile, points
        ),
        goal=named(GOALS, goal, "goal"),
        limits=plan.limits,
    )
    known = kind_of(kind)
    space = space_of(known, plan.limits, knots)
    subject = repr((problem, plan, law, space, _versions()))
    memory = Memory(state, subject)  # a file that cannot be used is told before anything runs
    start = problem.judge(plan.profile, samples=FINER)
    work = _Work(problem=problem, plan=plan, memory=memory, watch=progress, executor=executor)
    reference = best = work.best_of(space_of(REFERENCE, plan.limits, knots), start)
    if known != REFERENCE:
        best = work.best_of(space, start, done=reference)
    return _optimum(work, law, known, best, reference.judged, start)


def _each(mechanism: Mechanism, laws: Sequence[Friction] | None) -> list[FrictionLaw | Laws] | None:
    """Return laws of scenarios, checked; what is no sequence of them is told later."""
    if laws is None or len(mechanism.contacts()) < 2:
        return laws  # type: ignore[return-value]  # a sequence of laws
    return [event_driven_law(mechanism, law) for law in laws]


def _versions() -> list[str]:
    """Return the versions that a search depends on."""
    from importlib.metadata import version

    return [version(name) for name in ("cma", "numpy", "stickslip")]


def _optimum(
    work: "_Work",
    law: FrictionLaw | Laws,
    kind: str,
    best: "_Best",
    reference: ScoredMotion | None,
    start: ScoredMotion,
) -> Optimum:
    """Return the result, run once more with a certificate."""
    problem, plan = work.problem, work.plan
    if best.judged is None:
        raise ConvergenceError(
            f"no {kind} motion satisfies the limits among the {best.evaluations} evaluated: widen"
            " the limits, or increase evaluations."
        )
    whole = fitted(plan.mechanism, best.judged.profile, limit=plan.motor_limit)
    return Optimum(
        mechanism=whole,
        law=law,
        searched=kind,
        goal=problem.goal,
        limits=plan.limits,
        scenarios=problem.scenarios,
        best=best.judged,
        three_phase=reference,
        start=start,
        run=simulate(whole, law, t_end=_steady_end(whole, law)),
        polished=best.polished,
        evaluations=best.evaluations,
        seed=plan.seed,
        cancelled=best.cancelled,
    )


def _steady_end(mechanism: Mechanism, law: FrictionLaw | Laws) -> float:
    """Return when the cycles of a motion have come to repeat [s]."""
    return measure(mechanism, law).run.span[1]


@final
@dataclass(frozen=True, kw_only=True)
class _Plan:
    """What was asked for, checked."""

    mechanism: Mechanism
    profile: Profile
    motor_limit: float | None
    limits: Limits
    evaluations: int
    seed: int


def _plan(mechanism: Mechanism, limits: Limits, evaluations: int, seed: int) -> _Plan:
    """Check the arguments; the motor's limit becomes one of the limits."""
    if not isinstance(mechanism, Mechanism):
        raise InputError(f"mechanism must be a Mechanism such as PendulumCart, got {mechanism!r}.")
    if not isinstance(limits, Limits):
        raise InputError(f"limits must be Limits(position=..., rate=...), got {limits!r}.")
    for name, value, least in (("evaluations", evaluations, 1), ("seed", seed, 0)):
        if type(value) is not int or value < least:
            raise ParameterError(not_whole(name, least, value))
    motor = getattr(mechanism, motor_of(mechanism))
    slip_of_body(mechanism)
    given = limits.given()
    if motor.limit is not None:
        given["effort"] = min(given.get("effort", motor.limit), motor.limit)
    return _Plan(
        mechanism=fitted(mechanism, motor.profile),
        profile=motor.profile,
        motor_limit=motor.limit,
        limits=Limits(**given),
        evaluations=evaluations,
        seed=seed,
    )


def _check(progress: object) -> None:
    if progress is not None and not callable(progress):
        raise InputError(
            "progress must be callable with the search, the number of motions evaluated and their"
            f" total, and the best goal, got {progress!r}."
        )


@final
@dataclass(frozen=True, kw_only=True)
class _Best:
    """The best of one kind, and what it took up to here."""

    judged: ScoredMotion | None
    polished: bool = False
    evaluations: int = 0
    cancelled: bool = False


@final
@dataclass(frozen=True, kw_only=True)
class _Work:
    """Searches for one problem."""

    problem: Problem
    plan: _Plan
    memory: Memory
    watch: Told | None
    executor: Executor | None

    def best_of(self, space: Space, start: ScoredMotion, *, done: _Best | None = None) -> _Best:
        """Return the best motion: of those the search may begin from, its own, and the polish.

        It may begin from a motion of another kind, such as a spline from three phases. Whatever a
        search with a small budget meets, it returns no less than a feasible motion it began from.
        """
        before = done or _Best(judged=None)
        begins = [(start, False), *([(before.judged, before.polished)] if before.judged else [])]
        known = [one for one in begins if one[0].feasible and _has_place(space, one[0])]
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
        self, problem: Problem, space: Space, first: Profile
    ) -> tuple[Array | None, int]:
        """Return where a search begins: at a motion, better and within limits if that can be."""
        point = space.place(first)
        if point is None:
            return None, 0
        better, count = polish(problem, space, point, budget=self._polish(space), watch=self.watch)
        return (point if better is None else better), count

    def _polish(self, space: Space) -> int:
        """Return the motions that one polish may try: a round takes differences both ways."""
        return max(POLISH * self.plan.evaluations, LEAST_ROUNDS * (2 * space.size + 2))

    def _finely(self, space: Space, point: Array) -> ScoredMotion:
        return self.problem.judge(space.profile(point), samples=FINER)


def _has_place(space: Space, motion: ScoredMotion) -> bool:
    """Whether a search of a kind may begin from a motion."""
    return space.place(motion.profile) is not None


def _best(
    known: Sequence[tuple[ScoredMotion, bool]], evaluations: int = 0, *, cancelled: bool = False
) -> _Best:
    """Return the best motion within the limits, the first of equals."""
    good = [one for one in known if one[0].feasible]
    judged, polished = max(good, key=lambda one: one[0].value, default=(None, False))
    return _Best(judged=judged, polished=polished, evaluations=evaluations, cancelled=cancelled)
