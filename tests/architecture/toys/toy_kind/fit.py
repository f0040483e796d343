"""What a fit to a steady speed gives."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

from typing_extensions import override

from stickslip.experiments import LawEstimates
from stickslip.friction import Viscous
from stickslip.identification import Fit, estimates_for

if TYPE_CHECKING:
    from stickslip.display import Drawing, Target


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class ToyFit(Fit[Viscous]):
    """Viscous friction that explains a steady speed."""

    @override
    def law_estimates(self) -> LawEstimates:
        return estimates_for(self.law, self.estimates, [[1.0]], levels="forces", largest_speed=None)

    @override
    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.plots.core.axes import on_axes

        draw = lambda figure, _: figure.add_subplot().set_title("Toy.")  # noqa: E731
        return on_axes(draw, ax, (400, 300))

    @override
    def __str__(self) -> str:
        return f"{self.law.title}: {self.estimates[0]}"
