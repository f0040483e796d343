"""An error of the model that the residuals of a fit show."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, final

from typing_extensions import override

from stickslip.formatting import lower_first

UNSAID = "The 95 % intervals do not account for it."
"""What an error means where no more is known of it."""


@final
@dataclass(frozen=True, kw_only=True)
class ModelError:
    """One error of the model, the rig or the record that the residuals of a fit show.

    Examples
    --------
    >>> late = ModelError(
    ...     kind="delay",
    ...     finding="The motion follows the force 12 ms late.",
    ...     consequence="Intervals do not allow for it.",
    ...     effect=0.012,
    ...     interval=(0.011, 0.013),
    ...     share=0.9,
    ... )
    >>> str(late)
    'The motion follows the force 12 ms late. Intervals do not allow for it.'
    """

    kind: str
    """What it is, such as ``"delay"`` or ``"position friction"``."""
    finding: str
    """What it is, with its size, in a sentence."""
    consequence: str
    """How much of the residuals it is, and what it does to the estimates, in sentences."""
    effect: float
    """Its size, SI: a time, a force, a stiffness or a share, as the sentence says."""
    interval: tuple[float, float]
    """95 % confidence interval of the size, from leaving blocks out."""
    share: float
    """Share of the squared residuals that it predicts in blocks left out."""
    moved: tuple[str, ...] | None = None
    """Paths of the estimates that it moves out of their intervals; None where that is not known."""

    @override
    def __str__(self) -> str:
        """Return what it is and what it does."""
        return f"{self.finding} {self.consequence}"

    def at(self, joint: str) -> "ModelError":
        """Return the same with the name of the joint that it is of."""
        return replace(self, finding=f"At the {joint}: {lower_first(self.finding)}")

    def to_dict(self) -> Mapping[str, Any]:
        """Return the error as plain numbers and strings."""
        return {
            "kind": self.kind,
            "sentence": str(self),
            "effect": self.effect,
            "interval": list(self.interval),
            "share": self.share,
            "moved": None if self.moved is None else list(self.moved),
        }
