"""Runs cases one after another, each under a time limit, and says what became of each."""

import contextlib
import re
import signal
import time
import traceback
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from random import Random

import numpy as np
from tests.properties.fuzzing.cases import Case, Structure, draw_case, draw_structure, run_case
from tests.properties.fuzzing.checks import (
    CHECKS,
    Evidence,
    agrees_with_a_coarser_run,
    is_the_same_in_the_other_tier,
    violations,
)
from tests.properties.fuzzing.several import LOOPS, draw_joints

from stickslip import EventDriven
from stickslip.errors import InputError

NUMBER = re.compile(r"[-+]?\d[\d.]*(e[-+]?\d+)?")


class HangError(Exception):
    """A case took longer than it may."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What became of a case."""

    index: int
    title: str
    status: str
    reason: str
    """Why it is not certified, empty if it is."""
    violations: tuple[tuple[str, str], ...] = ()
    steps: int = 0
    events: int = 0
    seconds: float = 0.0


@contextlib.contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Interrupt what takes more processor time, so that what else the machine does is nothing.

    Compiled code is interrupted only when it returns.
    """

    def interrupt(number: int, frame: object) -> None:
        raise HangError(f"longer than {seconds:g} s")

    previous = signal.signal(signal.SIGPROF, interrupt)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, previous)


@dataclass(frozen=True, kw_only=True)
class Campaign:
    """A numbered sequence of cases, the same for the same seed and number of structures."""

    seed: int
    structures: int = 0
    """Number of different sets of equations; 0 draws one for each case."""
    solver: EventDriven
    seconds: float = 10.0
    """Most processor time for one case."""
    compare: int = 10
    """Every which case is run again with coarser steps; 0 for none."""
    several: bool = False
    """Whether cases have one to six contacts, each with equations of its own."""
    loops: bool = False
    """Whether their slips close loops."""
    tiers: int = 0
    """Every which case is run in the other tier too; 0 for none."""

    def structure(self, index: int) -> Structure:
        """Return what shapes the equations of a case."""
        if self.structures:
            return draw_structure(Random(f"{self.seed} set {index % self.structures}"))
        return draw_structure(Random(f"{self.seed} shape {index}"))

    def case(self, index: int) -> Case:
        """Return a case by its number."""
        if self.loops:
            return draw_joints(Random(f"{self.seed} loops {index}"), LOOPS)
        if self.several:
            return draw_joints(Random(f"{self.seed} joints {index}"))
        return draw_case(Random(f"{self.seed} numbers {index}"), self.structure(index))

    def order(self, cases: int) -> list[int]:
        """Return the numbers of the cases, those with the same equations one after another."""
        return sorted(range(cases), key=lambda i: i % self.structures if self.structures else i)

    def outcome(self, index: int) -> Outcome:
        """Run a case and judge it."""
        checks = dict(CHECKS)
        if self.compare and index % self.compare == 0:
            checks["agrees with a coarser run"] = agrees_with_a_coarser_run
        if self.tiers and index % self.tiers == 0:
            checks["is the same in the other tier"] = is_the_same_in_the_other_tier
        return outcome_of(index, self.case(index), self.solver, self.seconds, checks)

    def warm_up(self, index: int) -> None:
        """Compile the equations of a case outside its time limit."""
        if self.solver.tier == "compiled":
            with contextlib.suppress(Exception):
                run_case(self.case(index), EventDriven(max_steps=1, tier="compiled"))


def outcome_of(
    index: int, case: Case, solver: EventDriven, seconds: float, checks: dict = CHECKS
) -> Outcome:
    """Run a case under a time limit and judge it."""
    begun = time.perf_counter()

    def outcome(status: str, reason: str = "", found: tuple = (), **more: int) -> Outcome:
        spent = time.perf_counter() - begun
        return Outcome(
            index=index, title=case.title, status=status, reason=reason, violations=found,
            seconds=spent, **more,
        )  # fmt: skip

    try:
        with time_limit(seconds), warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run = run_case(case, solver)
            with np.errstate(all="ignore"):
                found = violations(Evidence(case, run, solver), checks)
    except InputError as error:
        return outcome("refused", NUMBER.sub("#", str(error))[:60])
    except HangError:
        return outcome("hang", "", (("ends in time", _place()),))
    except Exception as error:
        words = f"{type(error).__name__}: {error}, {_place()}"
        return outcome("raised", type(error).__name__, (("raises nothing", words),))
    found += [("warns of nothing", str(w.message)) for w in caught[:1]]
    trust = run.certificate
    problems = trust.problems[not run.status.complete :]  # the status tells the first by itself
    reason = "; ".join(NUMBER.sub("#", problem).partition(":")[0] for problem in problems)
    return outcome(run.status.name, reason, tuple(found), steps=trust.steps, events=len(run.events))


def _place() -> str:
    """Return where the exception at hand comes from, the last calls."""
    import sys

    calls = traceback.extract_tb(sys.exc_info()[2])
    return " < ".join(f"{call.name}:{call.lineno}" for call in reversed(calls[-6:]))
