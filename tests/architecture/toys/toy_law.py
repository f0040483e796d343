"""A law as a contributor would write it: friction that fades with speed."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.friction.base import SetValuedLaw
from stickslip.maths import Scalar
from stickslip.quantities import Quantity


@final
@dataclass(frozen=True, kw_only=True)
class ToyLaw(SetValuedLaw):
    """A level that falls from half as much again at rest to its value at high speed.

    Examples
    --------
    >>> ToyLaw(level=0.2, knee=0.1).force(0.1, load=10.0)
    2.5
    """

    name: ClassVar[str] = "toy-law"
    title: ClassVar[str] = "Toy law"
    formula: ClassVar[str] = r"F = \mu N (1 + \frac{1}{2} / (1 + |v| / v_t))"
    sources: ClassVar[tuple[str, ...]] = ("reynolds1886",)
    fit_order: ClassVar[tuple[str, ...]] = ("level", "knee")

    level: Annotated[float, Quantity("mu", low=0, scale="level", bounds=(0.0, 100.0), start=1.0)]
    """Friction over load at high speed."""
    knee: Annotated[
        float, Quantity("v_t", "m/s", above=0, scale="speed", bounds=(1e-3, 10.0), start=0.1)
    ]
    """Speed at which half of the surplus is left."""

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        return self.level * load * (1.0 + 0.5 / (1.0 + speed / self.knee))

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return 1.5 * self.level * load
