"""A law fitted to one of several trials."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

from stickslip.friction import FrictionLaw
from stickslip.identification.results import Estimate


@final
@dataclass(frozen=True, kw_only=True)
class TrialEstimates:
    """A law fitted to one of several trials."""

    name: str
    """Of the trial."""
    number: int
    """Its place among the records of the joint fit, from 0."""
    conditions: Mapping[str, float | str]
    """What was different in it."""
    law: FrictionLaw
    """The law with the parameters of this trial."""
    estimates: tuple[Estimate, ...]
    """Parameters of the law, in the order of the joint fit."""
    errors: tuple[float, ...]
    """Standard errors of these; infinite where the trial alone does not tell."""
    freedom: tuple[float, ...]
    """Degrees of freedom of these."""
    rms: float
    """Root mean square of the residuals."""
