"""What a motion may take: limits, and how far a motion stays from them."""

from dataclasses import dataclass, fields
from typing import Annotated, final

from stickslip.described import Described
from stickslip.quantities import Parametrised, Quantity

UNIT_OF_BACK_SLIP = 1e-3
"""What counts as one unit of violation where no back-slip at all is allowed [m]."""
ROUNDING = 1e-9
"""Share of a limit by which it may be exceeded: a motion that just reaches it is rounded."""


@final
@dataclass(frozen=True, kw_only=True)
class Limits(Parametrised):
    """What a motion may take; a limit that is not given does not hold.

    Parameters
    ----------
    position : float
        Largest distance of the inner body from its middle: angle [rad] or half a stroke [m].
    rate : float
        Largest speed of it [rad/s] or [m/s].
    effort : float, optional
        Largest torque [N m] or force [N].
    load_share : float
        Least normal force over the weight. At 0 the run itself ends where the body lifts off.
    back_slip : float, optional
        Longest way that the body slips back in a cycle [m].

    Examples
    --------
    >>> import math
    >>> Limits(position=math.radians(60.0), rate=12.0, effort=0.6).load_share
    0.0
    """

    position: Annotated[float, Quantity("q_max", above=0)]
    rate: Annotated[float, Quantity("w_max", above=0)]
    effort: Annotated[float, Quantity("tau_max", above=0)] | None = None
    load_share: Annotated[float, Quantity("n_min", low=0, high=1)] = 0.0
    back_slip: Annotated[float, Quantity("s_back", "m", low=0)] | None = None

    def given(self) -> dict[str, float]:
        """Return the limits that hold by name.

        Examples
        --------
        >>> Limits(position=0.5, rate=2.0).given()
        {'position': 0.5, 'rate': 2.0, 'load_share': 0.0}
        """
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in values.items() if value is not None}


@final
@dataclass(frozen=True, kw_only=True)
class Margin(metaclass=Described):
    """How far a motion stays from one limit.

    Examples
    --------
    >>> Margin(name="rate", allowed=12.0, reached=11.5, unit="rad/s").margin
    0.5
    >>> Margin(name="position", allowed=0.01, reached=0.010000000000000231, unit="m").margin
    0.0
    """

    name: str
    """Which limit."""
    allowed: float
    """The limit."""
    reached: float
    """The extreme over the cycle, of all scenarios."""
    unit: str
    """Unit of both."""

    @property
    def margin(self) -> float:
        """What is left [unit]; below 0 where the limit is broken, by more than rounding."""
        left = self.allowed - self.reached
        if self.name == "load_share":
            left = -left
        allowance = ROUNDING * (self.allowed or UNIT_OF_BACK_SLIP)
        return 0.0 if -allowance <= left < 0.0 else left

    @property
    def share(self) -> float:
        """What is left over the limit itself; for loads and where nothing is allowed, as it is."""
        if self.name == "load_share":
            return self.margin
        return self.margin / (self.allowed or UNIT_OF_BACK_SLIP)
