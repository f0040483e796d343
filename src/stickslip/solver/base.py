"""What a solver is."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from stickslip.friction import FrictionLaw, Laws, PrintedForm
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Parametrised
from stickslip.trajectory import Trajectory

__all__ = ["Solver", "column_units"]


@dataclass(frozen=True, kw_only=True)
class Solver(Parametrised, ABC):
    """Settings of a method, which knows how to run a mechanism with a law."""

    @abstractmethod
    def run(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws | PrintedForm,
        *,
        y0: Sequence[float],
        t_end: float,
        told: Sequence[str] = (),
    ) -> Trajectory:
        """Integrate from time 0 to `t_end`.

        Parameters
        ----------
        mechanism : Mechanism
            What moves.
        law : FrictionLaw or PrintedForm
            What holds it back.
        y0 : sequence of float
            Coordinates, rates and bristle states at time 0.
        t_end : float
            Last time [s].
        told : sequence of str
            States that begin where the mechanism says, and with its parameters elsewhere.

        Returns
        -------
        Trajectory
            States at the steps, events, status and certificate.
        """


def column_units(mechanism: Mechanism, columns: Sequence[str]) -> dict[str, str]:
    """Return the unit of each column of a trajectory.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    columns : sequence of str
        Names of bristle states, friction, loads and modes.

    Returns
    -------
    dict of str to str
        SI unit by column.
    """
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    units |= {
        rate: f"{unit}/s" for rate, unit in zip(mechanism.rates, mechanism.units, strict=True)
    }
    efforts = {guide.effort: guide.unit for guide in mechanism.guided().values()}
    kinds = {"friction": "N", "normal_force": "N", "mode": "1"}
    own = {name: kinds.get(name.partition(":")[0], "m") for name in columns}
    return units | own | efforts
