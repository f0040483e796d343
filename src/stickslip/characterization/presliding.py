"""Presliding: friction against displacement where the contact deflects but hardly slips."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.display import OnAxes, Summary
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.maths import Latches
from stickslip.tables import Tabular

if TYPE_CHECKING:
    import pandas as pd

Array: TypeAlias = NDArray[np.float64]

SLOW = 1e-6
"""Imposed speed [m/s]: far below any Stribeck velocity, so that only the path matters."""
POINTS = 200
"""Points of each straight piece of the path; each is one Runge-Kutta step or more."""
SHARE_OF_LENGTH = 0.05
"""Longest step, over the presliding length: the bristles relax within that length."""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PreslidingLoop(OnAxes, Tabular):
    """Friction along an imposed displacement that swings ever wider."""

    displacement: Array
    """Imposed displacement (n,) [m]."""
    friction: Array
    """Friction force (n,) [N]."""

    @override
    def to_dataframe(self) -> "pd.DataFrame":
        """Return displacement and friction as a pandas DataFrame."""
        import pandas as pd

        return pd.DataFrame({"displacement": self.displacement, "friction": self.friction})

    @override
    def _column_units(self) -> Mapping[str, str]:
        return {"displacement": "m", "friction": "N"}

    @override
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
        rates = law.rates(SLOW, load, rest)
        moved = tuple(float(rate) / SLOW for rate in rates)  # deflection per displacement
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
    path = [np.zeros(1)]
    for start, end in zip([0.0, *ends], [*ends, amplitude], strict=True):
        path.append(np.linspace(start, end, POINTS + 1)[1:])
    x = np.concatenate(path)
    substeps = int(np.ceil(np.abs(np.diff(x)).max() / (SHARE_OF_LENGTH * presliding_length(law))))
    z, latches = np.zeros(len(law.states)), Latches(off=True)
    friction = np.zeros(len(x))
    for i, step in enumerate(np.diff(x)):
        v = SLOW * float(np.sign(step))
        z = _moved(law, v, z, load, abs(step) / SLOW, max(substeps, 1), latches)
        friction[i + 1] = law.force(v, load, tuple(map(float, z)))
    return PreslidingLoop(displacement=x, friction=friction)


def _moved(
    law: FrictionLaw,
    v: float,
    z: Array,
    load: float,
    time: float,
    substeps: int,
    latches: Latches,
) -> Array:
    """Return the bristles after some time at a constant slip velocity."""
    with latches:
        known = law.moved(v, load, tuple(map(float, z)), time)
    latches.turn()
    if known is not None:
        return np.array(known, dtype=np.float64)

    def rate(state: Array) -> Array:
        return np.asarray(law.rates(v, load, tuple(map(float, state))), dtype=np.float64)

    for _ in range(substeps):
        z = _runge_kutta(rate, z, time / substeps)
    return z


def _runge_kutta(rate: Callable[[Array], Array], z: Array, h: float) -> Array:
    k1 = rate(z)
    k2 = rate(z + h / 2 * k1)
    k3 = rate(z + h / 2 * k2)
    k4 = rate(z + h * k3)
    return z + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
