"""What a selection on records gives back."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, final

from typing_extensions import override

from stickslip.experiments import Measurement
from stickslip.formatting import Scale, quantity
from stickslip.friction import FrictionLaw
from stickslip.identification import (
    Estimate,
    FittedLaw,
    ModelError,
    RecordFit,
    RecordSettings,
    Score,
    TrialComparison,
)
from stickslip.selection import (
    CrossValidated,
    CrossValidatedVerdict,
    Plan,
    plain,
    reduces_to,
    score_scale,
    settled_estimates,
)


@final
@dataclass(frozen=True, kw_only=True)
class SecondRecord:
    """What a record that no fit has used says of the choice."""

    error: float
    """Error of the chosen law on it, root mean square over its segments."""
    ratio: float
    """That error over the held-out error of the first record; infinite if that is 0."""
    holds: bool
    """Whether no other law has a smaller error there beyond doubt."""
    rival: str
    """Key of the other law with the least error there; empty if there is none."""
    rival_error: float
    """Its error; not a number if there is none."""
    segments: int
    """Number of segments that errors are compared on; a single one leaves differences in doubt."""

    @property
    def finding(self) -> str:
        """Return what the record says of the choice, as the end of a sentence."""
        if not self.holds:
            return "does not hold"
        if self.segments < 2 or not math.isfinite(self.error):
            why = "only one segment" if math.isfinite(self.error) else "its simulation fails"
            return f"cannot be tested ({why})"
        return "holds"


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class RecordCandidate(CrossValidated[RecordFit]):
    """One law on a record: its fit, its held-out error, and whether it may be taken."""

    second: Score | None = None
    """Error on the record given to validate, if there is one."""
    refuted: str = ""
    """Which value that was given the record contradicts, as a clause; empty if it does not."""
    left_out: tuple[str, ...] = ()
    """Paths of what went to 0 beside the rest of the law, and was left out of the fit."""
    from_balance: tuple[str, ...] = ()
    """Paths of values that the force balance found, and the fit held."""
    aic: float = math.nan
    """Akaike's criterion, residuals counted by their effective number."""
    bic: float = math.nan
    """Schwarz's criterion, residuals counted by their effective number; for information."""
    simpler: Mapping[str, type[FrictionLaw]] = field(default_factory=dict)
    """The candidates that the law contains, with the types of their laws."""

    @property
    @override
    def parameters(self) -> int:
        """Number of unknowns that were fitted, whether or not the record identifies them."""
        return len(self.fit.free_parameters) if self.fit else 0

    @property
    @override
    def is_simpler(self) -> tuple[str, ...]:
        fit = self.fit
        return tuple(name for name, law in self.simpler.items() if fit and reduces_to(fit, law))

    @property
    def law(self) -> FrictionLaw | None:
        """The fitted law."""
        return self.fit.law if self.fit else None

    @property
    @override
    def fitted_law(self) -> FittedLaw | None:
        return self.fit.fitted_law if self.fit else None

    @override
    def to_row(self) -> Mapping[str, Any]:
        return {
            "law": self.name,
            "parameters": self.parameters,
            "score": self.score,
            "score_error": self.validation.error if self.validation else math.nan,
            "last_third": self.validation.extrapolation if self.validation else math.nan,
            "second_record": self.second.rms if self.second else math.nan,
            "outcome": plain(self.outcome),
        }

    @override
    def to_dict(self) -> Mapping[str, Any]:
        validation = self.validation
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.parameters,
            "score": self.score,
            "score_error": validation.error if validation else None,
            "block_errors": [math.sqrt(x) for x in validation.losses] if validation else [],
            "extrapolation": validation.extrapolation if validation else None,
            "second_record": self.second.rms if self.second else None,
            "left_out": list(self.left_out),
            "contains": list(self.simpler),
            "aic": self.aic,
            "bic": self.bic,
            "dropped": plain(self.dropped),
            "doubt": plain(self.doubt),
            "outcome": plain(self.outcome),
            "fit": self.fit.to_dict() if self.fit else None,
        }


@dataclass(frozen=True, kw_only=True, repr=False)
class BlockwiseVerdict(CrossValidatedVerdict[RecordCandidate]):
    """A verdict on records of which blocks are held out: of one law, or of those of all joints."""

    plan: Plan
    """Blocks, gaps and horizon of the held-out errors."""
    picks: Mapping[str, str] = field(default_factory=dict)
    """What other criteria would pick: criterion -> name of the candidate."""
    second: Measurement | None = None
    """The record given to validate, which no fit has seen; None without one."""
    settings: RecordSettings = field(default_factory=RecordSettings)
    """How each law was fitted: segments, starts and their seed."""
    usual: bool = False
    """Whether no laws were named."""
    explained: bool = False
    """Whether the force balance was explained, which tells laws apart too."""

    @property
    @override
    def route(self) -> str:
        assert self.closest.fit is not None  # what was not fitted is not the closest
        return self.closest.fit.route

    @property
    def blocks_scored(self) -> int:
        """Number of held-out blocks that are scored; one beside which nothing is left is not."""
        validation = self.closest.validation
        return len(validation.losses) if validation else 0


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class RecordVerdict(BlockwiseVerdict):
    """A verdict on records in time."""

    reference: RecordCandidate | None
    """Coulomb and viscous friction, whatever the record says."""
    control: RecordCandidate | None
    """No friction at all."""
    scored_on: str
    """What is scored, in words."""
    on_second: SecondRecord | None = None
    """What that record says of the choice; None without one."""
    trials: TrialComparison | None = None
    """Whether several trials share the closest law; None where there is nothing to compare."""
    equals: tuple[str, ...] = ()
    """Names of the laws that the record does not tell from the closest, the best first."""
    half_estimates: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Estimates of the best law from the first and the second half of the record, by path."""
    untried: tuple[str, ...] = ()
    """Names of the usual candidates that were not fitted."""
    why_untried: str = ""
    """Why they were not, in a sentence; empty if all were fitted."""
    shown: Scale | None = None
    """What scores are shown in beside those of other joints; None where they stand alone."""

    @property
    def model_errors(self) -> tuple[ModelError, ...]:
        """What the residuals of the closest law show to be wrong with model, rig or record."""
        return self.closest.fit.model_errors if self.closest.fit else ()

    @property
    def settled(self) -> tuple[Estimate, ...]:
        """The estimates of the closest law that stand each for itself, the surest first."""
        if not self.closest.fit:
            return ()
        equals = [c.fit for c in self.candidates if c.fit and c.name in self.equals]
        return settled_estimates(self.closest.fit, equals)

    @property
    def quantity(self) -> str:
        """What is predicted, as in `QUANTITIES`."""
        fits = [c.fit for c in self.candidates if c.fit]
        return fits[0].problem.quantity if fits else "position"

    @property
    def unit(self) -> str:
        """SI unit of the scores."""
        return self.measurement.unit(self.quantity)

    @property
    @override
    def score_unit(self) -> str:
        return self.unit

    @property
    def scale(self) -> Scale:
        """The multiple of the unit in which scores are shown: one for terminal, text and page."""
        return self.shown or score_scale([c.score for c in self.candidates], self.unit)

    @property
    def missing(self) -> tuple[str, ...]:
        """Why judged candidates lack a number, and others are not there, in sentences.

        What was fitted and not judged says so itself.
        """
        judged = [c for c in self.candidates if c.validation is not None]
        ahead = [c.name for c in judged if c.validation and math.isnan(c.validation.extrapolation)]
        fails = [c.name for c in judged if c.second and not math.isfinite(c.second.rms)]
        why = (
            f"the record is too short: no segment of {quantity(self.plan.horizon, 's', 2)}"
            " lies in the last third, or the data before it do not suffice for a fit"
        )
        found = [f"No error on the last third ({', '.join(ahead)}): {why}."] if ahead else []
        if fails:
            found.append(
                f"No error on the second record ({', '.join(fails)}): the simulation fails."
            )
        return (*found, *([self.why_untried] if self.why_untried else []))

    @override
    def _basis(self) -> str:
        return f"; {self.scored_on}"

    @override
    def _details(self) -> Mapping[str, Any]:
        return {
            "seed": self.settings.seed,
            "scored": self.scored_on,
            "quantity": self.quantity,
            "unit": self.unit,
            "folds": self.plan.folds,
            "blocks_scored": self.blocks_scored,
            "gap": self.plan.gap,
            "horizon": self.plan.horizon,
            "picks_of_other_criteria": dict(self.picks),
            "not_distinguished_from": list(self.equals),
            "not_tried": {"laws": list(self.untried), "why": self.why_untried},
            "second_record": asdict(self.on_second) if self.on_second else None,
            "control": self.control.to_dict() if self.control else None,
            "checks": self.checks.to_dict(),
            "model_errors": [one.to_dict() for one in self.model_errors],
            "trials": self.trials.to_dict() if self.trials else None,
            "halves": {path: list(pair) for path, pair in self.half_estimates.items()},
        }
