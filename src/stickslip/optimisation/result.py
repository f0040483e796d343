"""The best motion that was found, and what stands beside it."""

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, final

from typing_extensions import override

from stickslip.drives import Profile, ThreePhase
from stickslip.experiments import rig_toml
from stickslip.formatting import number, with_unit
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism
from stickslip.optimisation.cycle_metrics import Cycle
from stickslip.optimisation.parametrisation import ThreeAccelerations, kind_of
from stickslip.optimisation.problem import Goal, Limits, Margin, ScoredMotion
from stickslip.optimisation.scenarios import Scenarios
from stickslip.tables import Tabular
from stickslip.trajectory import Trajectory

if TYPE_CHECKING:
    import pandas as pd

SHOWN_CYCLES = 5
"""Cycles that the rig file runs."""


@final
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
    goal: Goal
    """What is large."""
    limits: Limits
    """What the motion may take."""
    scenarios: Scenarios
    """What it stood."""
    best: ScoredMotion
    """The best motion: its goal, and what is left of each limit."""
    three_phase: ScoredMotion | None
    """The best three-phase motion; None if none keeps the limits."""
    start: ScoredMotion
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
            return ThreeAccelerations.kind
        return kind_of(profile_values(self.profile)["type"])

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
    def margins(self) -> tuple[Margin, ...]:
        """What it leaves of each limit."""
        return self.best.margins

    @property
    def cycle(self) -> Cycle:
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

    @override
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

    @override
    def _over(self) -> str:
        return "motion"

    @override
    def _column_units(self) -> Mapping[str, str]:
        return {self.goal.name: self.goal.unit}

    def to_toml(self) -> str:
        """Return a rig file with the best motion, which `load_rig` and the command line read."""
        title = f"Best {self.kind} motion for {self.goal.title}"
        t_end = SHOWN_CYCLES * self.cycle.period
        return rig_toml(self.mechanism, self.law, title=title, t_end=t_end)

    @override
    def __repr__(self) -> str:
        head = f"{self.goal.title} {with_unit(number(self.value, 6), self.goal.unit)}"
        if self.factor is not None and self.best is not self.three_phase:
            head += f", {number(self.factor, 4)} times the best three-phase motion"
        left = ", ".join(
            f"{m.name} {number(m.reached, 5)} of {with_unit(number(m.allowed, 5), m.unit)}"
            for m in self.margins
        )
        return "\n ".join(filter(None, (f"<{head}", str(self.profile), self.shortfall, left))) + ">"


def _over(value: float, other: ScoredMotion | None) -> float | None:
    return None if other is None or not other.value > 0.0 else value / other.value


def profile_values(profile: Profile) -> dict[str, Any]:
    """Return a profile as its table in a rig file.

    Examples
    --------
    >>> from stickslip.drives import SineSwing
    >>> profile_values(SineSwing(amplitude=0.5, frequency=2.0))
    {'type': 'sine-swing', 'amplitude': 0.5, 'frequency': 2.0}
    """
    from stickslip.drives import PROFILES

    names = {kind: name for name, kind in PROFILES.items()}
    values = {field.name: getattr(profile, field.name) for field in dataclasses.fields(profile)}
    listed = {k: list(v) if isinstance(v, tuple) else v for k, v in values.items()}
    return {"type": names.get(type(profile), type(profile).__name__)} | listed


def _margin(margin: Margin) -> dict[str, Any]:
    return dataclasses.asdict(margin) | {"margin": margin.margin}


def _cycle(cycle: Cycle) -> dict[str, float]:
    motion = ("period", "travel", "work", "energy", "position", "rate", "acceleration")
    names = (*motion, "effort", "load_share", "back_slip")
    return {name: getattr(cycle, name) for name in names}


def _judged(judged: ScoredMotion | None) -> dict[str, Any] | None:
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
