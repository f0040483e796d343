"""Coulomb and viscous friction that differ between the two directions."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.friction.base import Containment, DirectionalLaw
from stickslip.friction.coulomb_viscous import CoulombViscous
from stickslip.quantities import Quantity, unchecked

__all__ = ["DirectionDependent"]


@final
@dataclass(frozen=True, kw_only=True)
class DirectionDependent(DirectionalLaw):
    """Separate levels and viscous parts for each direction: screws, cable drives, preloaded guides.

    A constant force is not told apart from half the difference of the levels: give the mechanism
    an offset, or let the levels differ, not both, unless something else tells them apart.

    Examples
    --------
    >>> law = DirectionDependent(
    ...     forward_kinetic_coefficient=20.1,
    ...     backward_kinetic_coefficient=20.6,
    ...     forward_viscous_coefficient=166.7,
    ...     backward_viscous_coefficient=240.4,
    ... )
    >>> law.towards(-1)
    CoulombViscous(kinetic_coefficient=20.6, viscous_coefficient=240.4, static_coefficient=None)
    """

    name: ClassVar[str] = "direction-dependent"
    title: ClassVar[str] = "Direction-dependent"
    formula: ClassVar[str] = (
        r"F = \begin{cases} \mu_{+} N + \sigma_{+} v & v > 0 \\"
        r" -\mu_{-} N + \sigma_{-} v & v < 0 \end{cases},"
        r" \quad -\mu_{-} N \le F \le \mu_{+} N \text{ at rest}"
    )
    sources: ClassVar[tuple[str, ...]] = ("armstrong1991", "janot2019")
    fit_order: ClassVar[tuple[str, ...]] = (
        "forward_kinetic_coefficient",
        "backward_kinetic_coefficient",
        "forward_viscous_coefficient",
        "backward_viscous_coefficient",
    )
    contained: ClassVar[tuple[Containment, ...]] = (
        Containment(
            law="coulomb-viscous",
            values={
                "forward_kinetic_coefficient": "kinetic_coefficient",
                "backward_kinetic_coefficient": "kinetic_coefficient",
                "forward_viscous_coefficient": "viscous_coefficient",
                "backward_viscous_coefficient": "viscous_coefficient",
            },
        ),
    )
    on_request: ClassVar[bool] = True

    forward_kinetic_coefficient: Annotated[
        float, Quantity("mu_+", low=0, scale="level+", bounds=(0.0, 100.0), start=1.0)
    ]
    """Friction force over the normal force as a forward speed goes to zero."""
    backward_kinetic_coefficient: Annotated[
        float, Quantity("mu_-", low=0, scale="level-", bounds=(0.0, 100.0), start=1.0)
    ]
    """The same for backward slip."""
    forward_viscous_coefficient: Annotated[
        float, Quantity("sigma_+", "N s/m", low=0, scale="slope+", bounds=(0.0, 100.0), start=1.0)
    ] = 0.0
    """Growth of the friction force with the speed of forward slip."""
    backward_viscous_coefficient: Annotated[
        float, Quantity("sigma_-", "N s/m", low=0, scale="slope-", bounds=(0.0, 100.0), start=1.0)
    ] = 0.0
    """The same for backward slip."""

    @override
    def towards(self, direction: int) -> CoulombViscous:
        if direction > 0:
            mu, sigma = self.forward_kinetic_coefficient, self.forward_viscous_coefficient
        else:
            mu, sigma = self.backward_kinetic_coefficient, self.backward_viscous_coefficient
        return unchecked(
            CoulombViscous,
            kinetic_coefficient=mu,
            viscous_coefficient=sigma,
            static_coefficient=None,
        )
