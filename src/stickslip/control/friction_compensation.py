"""Compensation of friction by the force that an identified law gives."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, TypeAlias, final

from typing_extensions import override

from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.friction import FrictionLaw, bound, is_bound
from stickslip.quantities import Parametrised, Quantity

Load: TypeAlias = float | Callable[[float, Mapping[str, float]], float]
"""A normal force [N] or a contact input, or a function of time and what is measured."""


def sliding_force(law: FrictionLaw, velocity: float, load: float) -> float:
    """Return the friction force of steady sliding [N], 0 at rest.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> sliding_force(Coulomb(kinetic_coefficient=0.25), -0.1, load=4.0)
    -1.0
    """
    if velocity == 0.0:
        return 0.0
    if isinstance(law, FrictionLaw):
        return float(law.steady(velocity, load))
    raise InputError(
        f"{type(law).__name__} is not a friction law that can be compensated: give"
        " one such as Coulomb(...)."
    )


@final
@dataclass(frozen=True, kw_only=True)
class FrictionCompensation(Parametrised):
    """A controller that pushes with a law's friction force, in the direction of motion.

    Within the crossing ``|v| < width`` the force is that of the law times ``s (3 - s^2) / 2`` with
    ``s = |v| / width``: smooth, 0 at rest, and exactly the law's from the width on.
    """

    law: FrictionLaw
    """The identified law."""
    width: Annotated[float, Quantity("w", "m/s", above=0)]
    """Speed below which the force fades to 0, which noise would else turn into chatter."""
    factor: Annotated[float, Quantity("kappa", low=0)] = 1.0
    """Share of friction that is compensated; above 1 it is over-compensated."""
    load: Load = 1.0
    """Normal force."""
    inputs: Mapping[str, Load] = field(default_factory=dict)
    """Contact inputs of the law, by name."""
    velocity: str | Callable[[float], float] = "v"
    """Name of a measured rate, or the desired velocity as a function of time."""

    @override
    def __post_init__(self) -> None:
        """Check the law."""
        super().__post_init__()
        if not isinstance(self.law, FrictionLaw):
            raise ParameterError(
                f"FrictionCompensation.law must be a friction law, got {self.law!r}."
            )
        for name in self.inputs:
            if name not in self.law.inputs:
                raise UnknownNameError(f"contact input of {self.law.name}", name, self.law.inputs)
        for name in () if is_bound(self.law) else self.law.inputs:
            if name not in self.inputs:
                raise InputError(
                    f"compensation: the friction law {self.law.name} depends on {name}: give it,"
                    f" as inputs={{{name!r}: ...}}, a number or a function of time and what is"
                    " measured."
                )

    def __call__(self, t: float, measured: Mapping[str, float]) -> float:
        """Return the force at a sample."""
        if callable(self.velocity):
            speed = float(self.velocity(t))
        elif self.velocity in measured:
            speed = measured[self.velocity]
        else:
            raise InputError(
                f"compensation: {self.velocity!r} is not measured; measured quantities:"
                f" {', '.join(measured) or 'none'}."
            )
        load, *inputs = (
            one(t, measured) if callable(one) else one for one in (self.load, *self.inputs.values())
        )
        law = self.law
        if inputs:
            law = bound(law, dict(zip(self.inputs, inputs, strict=True)))
        share = min(abs(speed) / self.width, 1.0)
        crossing = 0.5 * share * (3.0 - share * share)
        return self.factor * crossing * sliding_force(law, speed, load)


def compensation(
    law: FrictionLaw,
    *,
    width: float,
    factor: float = 1.0,
    load: Load = 1.0,
    inputs: Mapping[str, Load] | None = None,
    velocity: str | Callable[[float], float] = "v",
) -> FrictionCompensation:
    """Return a controller that compensates friction by an identified law.

    Parameters
    ----------
    law : FrictionLaw
        The law; of a law with bristles, its steady sliding.
    width : float
        Speed below which the compensation fades to 0 [m/s].
    factor : float
        Share of friction that is compensated: 1 exactly, less or more.
    load : float or callable
        Normal force [N], or a function of time and what is measured.
    inputs : mapping of str to float or callable, optional
        Contact inputs of the law in the same way, such as ``{"temperature": 35.0}`` [degC].
    velocity : str or callable
        Name of the measured rate, or the desired velocity as a function of time, which has no
        noise and does not feed back.

    Returns
    -------
    FrictionCompensation
        A controller; give it to `PID` as ``feedforward``.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> push = compensation(Coulomb(kinetic_coefficient=2.0), width=0.01, factor=0.9)
    >>> [round(push(0.0, {"v": v}), 9) for v in (-0.1, 0.0, 0.005, 0.01)]
    [-1.8, 0.0, 1.2375, 1.8]
    """
    return FrictionCompensation(
        law=law, width=width, factor=factor, load=load, inputs=inputs or {}, velocity=velocity
    )
