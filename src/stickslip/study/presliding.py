"""Presliding: friction against displacement where the contact deflects but hardly slips."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.maths import Latches
from stickslip.show.display import OnAxes, Summary, Tabular

if TYPE_CHECKING:
    import pandas as pd

Array: TypeAlias = NDArray[np.float64]

LOOP_SPEED = 1e-6
"""Imposed speed of a loop [m/s]: far below any Stribeck velocity."""
POINTS = 200
"""Points of each way of a path."""
ACCURATE = 1e-11
"""Error of a step of deflections, over their own size and over the presliding length."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PreslidingLoop(OnAxes, Tabular):
    """Friction along an imposed displacement that swings ever wider."""

    displacement: Array
    """Imposed displacement (n,) [m]."""
    friction: Array
    """Friction force (n,) [N]."""

    def to_dataframe(self) -> "pd.DataFrame":
        """Return displacement and friction as a pandas DataFrame."""
        import pandas as pd

        return pd.DataFrame({"displacement": self.displacement, "friction": self.friction})

    def _column_units(self) -> Mapping[str, str]:
        return {"displacement": "m", "friction": "N"}

    def _summary(self) -> Summary:
        rows = (
            ("largest displacement", f"{np.abs(self.displacement).max():.4g} m"),
            ("largest friction", f"{np.abs(self.friction).max():.4g} N"),
        )
        return Summary(sentence=f"Presliding loop of {len(self.friction)} points.", rows=rows)


def presliding_length(law: FrictionLaw, load: float = 1.0) -> float:
    """Return the displacement [m] at which the first stiffness would reach break-away.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> presliding_length(Dahl(kinetic_coefficient=0.25, bristle_stiffness=1000.0))
    0.00025
    """
    rest = tuple(0.0 for _ in law.states)
    with Latches(off=True):  # where nothing has slipped yet
        rates = law.rates(LOOP_SPEED, load, rest)
        moved = tuple(float(rate) / LOOP_SPEED for rate in rates)  # deflection per displacement
        # The laws are affine in their deflection at a given speed, so any step gives the slope.
        stiffness = float(law.force(0.0, load, moved)) - float(law.force(0.0, load, rest))
    return float(law.break_away(load)) / stiffness


def presliding_loop(
    law: FrictionLaw, amplitude: float, load: float = 1.0, *, swings: int = 3
) -> PreslidingLoop:
    """Move a contact slowly to and fro, each time farther, and record its friction.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=0.25, bristle_stiffness=1000.0)
    >>> loop = presliding_loop(law, 0.001, load=10.0)
    >>> bool(abs(loop.friction).max() < 2.5)
    True
    """
    if not amplitude > 0 or swings < 1:
        raise InputError(
            "a presliding loop needs an amplitude above 0 m and at least one swing,"
            f" got {amplitude:g} m and {swings}."
        )
    ends = [sign * amplitude * (n + 1) / swings for n in range(swings) for sign in (1.0, -1.0)]
    x, friction = [np.zeros(1)], [np.zeros(1)]
    z, latches = np.zeros(len(law.states)), Latches(off=True)
    # The last piece goes back to where the widest swing began, which closes its loop.
    for start, end in zip([0.0, *ends], [*ends, amplitude], strict=True):
        x.append(np.linspace(start, end, POINTS + 1)[1:])
        v = LOOP_SPEED if end > start else -LOOP_SPEED
        states = moved_at(law, v, z, load, np.abs(x[-1] - start) / LOOP_SPEED, latches)
        friction.append(
            np.array([law.force(v, load, tuple(map(float, state))) for state in states])
        )
        z = states[-1]
    return PreslidingLoop(displacement=np.concatenate(x), friction=np.concatenate(friction))


def moved_at(
    law: FrictionLaw, v: float, z: Array, load: float, times: Array, latches: Latches
) -> Array:
    """Return the states (n, states) at increasing times of a motion at a constant slip velocity."""
    result = []
    for time in times:
        # Flags of latches stay as they were at the beginning of the piece.
        with latches:
            result.append(law.moved(v, load, tuple(map(float, z)), float(time)))
    latches.turn()
    if result[0] is not None:
        return np.array(result, dtype=np.float64)

    def rates(_time: float, state: Array) -> Array:
        return np.asarray(law.rates(v, load, tuple(map(float, state))), dtype=np.float64)

    from scipy.integrate import solve_ivp

    # Absolute errors count where deflections go through 0.
    nothing = ACCURATE * presliding_length(law, load)
    span = (0.0, times[-1])
    run = solve_ivp(rates, span, z, "DOP853", times, rtol=ACCURATE, atol=nothing)
    return np.asarray(run.y.T)
