"""Friction that depends on the logarithm of the slip speed, and on a state that remembers slip."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, ClassVar, Final, Literal, NamedTuple, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import override

from stickslip.errors import ParameterError
from stickslip.quantities import Parametrised, Quantity

__all__ = ["RATE_STATE_FORMS", "Evolution", "RateState", "RateStateForm"]

Array: TypeAlias = NDArray[np.float64]
Evolution: TypeAlias = Literal["ageing", "slip", "none"]

RATE_ONLY: Final = r"\mu = \mu_0 + a \ln\frac{V}{V_0}"
WITH_STATE: Final = (
    r"\mu = \mu_0 + a \ln\frac{V}{V_0} + b \ln\frac{V_0 \theta}{D_c}, \qquad \dot\theta = "
)
EVOLUTIONS: Final[Mapping[Evolution, str]] = MappingProxyType(
    {
        "ageing": WITH_STATE + r"1 - \frac{V \theta}{D_c}",
        "slip": WITH_STATE + r"-\frac{V \theta}{D_c} \ln\frac{V \theta}{D_c}",
        "none": RATE_ONLY,
    }
)
"""The law in LaTeX by how the state follows."""


class RateStateForm(NamedTuple):
    """A form of the law that fits and selections know by a name."""

    title: str
    """Name in running text."""
    evolution: Evolution
    """How the state follows."""
    fit_order: tuple[str, ...]
    """Parameters that are fitted."""


RATE_STATE_FORMS: Final[Mapping[str, RateStateForm]] = MappingProxyType(
    {
        "constant-coefficient": RateStateForm(
            "Constant coefficient", "none", ("reference_coefficient",)
        ),
        "logarithmic": RateStateForm(
            "Logarithmic in speed", "none", ("reference_coefficient", "direct_effect")
        ),
        "rate-and-state": RateStateForm(
            "Rate and state (ageing)",
            "ageing",
            ("reference_coefficient", "direct_effect", "evolution_effect", "critical_distance"),
        ),
        "rate-and-state-slip": RateStateForm(
            "Rate and state (slip)",
            "slip",
            ("reference_coefficient", "direct_effect", "evolution_effect", "critical_distance"),
        ),
    }
)
"""Forms of the law by name, the simplest first."""


@final
@dataclass(frozen=True, kw_only=True)
class RateState(Parametrised):
    r"""Friction that depends on the slip speed and on a state that remembers past slip.

    mu = mu_0 + a ln(V / V_0) + b ln(V_0 theta / D_c), where theta follows the ageing law
    (Dieterich), d theta/dt = 1 - V theta / D_c, or the slip law (Ruina),
    d theta/dt = -(V theta / D_c) ln(V theta / D_c). Without evolution, mu = mu_0 + a ln(V / V_0),
    where a may have either sign; a = 0 is a constant coefficient.

    It is not a `FrictionLaw`: the speed stands in a logarithm, so nothing is ever at rest, and the
    event-driven solver has no use for it.

    Examples
    --------
    >>> law = RateState(
    ...     reference_coefficient=0.6,
    ...     direct_effect=0.005,
    ...     evolution_effect=0.01,
    ...     critical_distance=1e-5,
    ...     reference_velocity=1e-6,
    ... )
    >>> round(float(law.steady(1e-5)), 8), round(law.critical_stiffness, 9)
    (0.58848707, 500.0)
    """

    sources: ClassVar[tuple[str, ...]] = ("dieterich1979", "ruina1983", "marone1998")

    reference_coefficient: Annotated[float, Quantity("mu_0")]
    """Steady friction coefficient at the reference velocity."""
    direct_effect: Annotated[float, Quantity("a")]
    """What a jump of ln V adds at once; above 0 unless there is no evolution."""
    evolution_effect: Annotated[float, Quantity("b")] = 0.0
    """What it takes away again as the contacts are renewed."""
    critical_distance: Annotated[float, Quantity("D_c", "m", above=0)] | None = None
    """Slip over which contacts are renewed; None without evolution."""
    reference_velocity: Annotated[float, Quantity("V_0", "m/s", above=0)]
    """Speed at which the reference coefficient holds."""
    evolution: Evolution = "ageing"
    """How the state follows: ``"ageing"``, ``"slip"`` or, where there is no state, ``"none"``."""

    @override
    def __post_init__(self) -> None:
        """Check the parameters, and that they are those of the evolution."""
        super().__post_init__()
        if self.evolution not in EVOLUTIONS:
            raise ParameterError(
                "RateState.evolution must be 'ageing' or 'slip', or 'none' without a state, got"
                f" {self.evolution!r}."
            )
        if self.evolution == "none":
            if self.evolution_effect != 0.0 or self.critical_distance is not None:
                raise ParameterError(
                    "RateState.evolution is 'none', which has neither evolution_effect (b) nor"
                    f" critical_distance (D_c): leave them out, got b = {self.evolution_effect:g}"
                    f" and D_c = {self.critical_distance}."
                )
        elif self.critical_distance is None:
            raise ParameterError(
                "RateState.critical_distance (D_c) must be above 0 m, got none; evolution='none'"
                " does without it."
            )
        elif not self.direct_effect > 0.0:
            raise ParameterError(
                f"RateState.direct_effect (a) must be above 0, got {self.direct_effect:g};"
                " evolution='none' takes either sign."
            )

    @property
    def name(self) -> str:
        """Key of the form of the law, as in `RATE_STATE_FORMS`."""
        if self.evolution == "none":
            return "logarithmic" if self.direct_effect else "constant-coefficient"
        return "rate-and-state" if self.evolution == "ageing" else "rate-and-state-slip"

    @property
    def title(self) -> str:
        """Name in running text."""
        return RATE_STATE_FORMS[self.name].title

    @property
    def formula(self) -> str:
        """The law in LaTeX."""
        return r"\mu = \mu_0" if self.name == "constant-coefficient" else EVOLUTIONS[self.evolution]

    @property
    def critical_stiffness(self) -> float:
        """Stiffness (b - a) / D_c [1/m] below which steady sliding is not stable; may be negative.

        It is a change of the coefficient with position: times the load, it is in N/m. Without
        evolution it is infinite where friction falls with speed, and else minus infinity.
        """
        if self.critical_distance is None:
            return math.inf if self.direct_effect < 0.0 else -math.inf
        return (self.evolution_effect - self.direct_effect) / self.critical_distance

    def steady(self, velocity: ArrayLike) -> Array:
        """Return the coefficient after long sliding at speeds above 0 [m/s].

        Examples
        --------
        >>> law = RateState(
        ...     reference_coefficient=0.6,
        ...     direct_effect=0.01,
        ...     evolution_effect=0.01,
        ...     critical_distance=1e-5,
        ...     reference_velocity=1e-6,
        ... )
        >>> law.steady([1e-6, 1e-3])
        array([0.6, 0.6])
        """
        mu_0, a, b, V_0 = (
            self.reference_coefficient,
            self.direct_effect,
            self.evolution_effect,
            self.reference_velocity,
        )
        V = np.asarray(velocity, dtype=float)
        return mu_0 + (a - b) * np.log(V / V_0)
