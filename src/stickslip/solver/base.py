"""What a solver is."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from stickslip.friction import FrictionLaw, Laws, PrintedForm
from stickslip.mechanisms import Mechanism, slips_by_angle
from stickslip.quantities import Parametrised, parameters, turned
from stickslip.trajectory import Trajectory

KINDS = {"friction": "N", "mode": "1"}
"""Units of columns of a contact that slips along a line; others are bristles [m]."""


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

    Friction of a contact that slips along an angle is a torque, and its bristles are angles.
    """
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    units |= {
        rate: f"{unit}/s" for rate, unit in zip(mechanism.rates, mechanism.units, strict=True)
    }
    efforts = {guide.effort: guide.unit for guide in mechanism.guided().values()}
    turning = {one.name: slips_by_angle(mechanism, one) for one in mechanism.contacts()}
    several = len(turning) > 1
    own = {}
    for column in columns:
        kind, _, contact = column.partition(":")
        turns = turning.get(contact, False) if several else any(turning.values())
        own[column] = "N" if kind == "normal_force" else turned(KINDS.get(kind, "m"), turns)
    return units | own | efforts


def path_units(
    mechanism: Mechanism, law: FrictionLaw | Laws, bristles: Sequence[str] = ()
) -> dict[str, str]:
    """Return the unit of each initial state and parameter.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> units = path_units(Axis(inertia=1.0), Coulomb(kinetic_coefficient=1.0))
    >>> units["mechanism.stiffness"], units["initial.v"]
    ('N/m', 'm/s')
    """
    own = column_units(mechanism, bristles)
    states = (*mechanism.coordinates, *mechanism.rates, *bristles)
    units = {f"initial.{state}": own[state] for state in states}
    angular = set(mechanism.units) == {"rad"}
    for path, quantity, _ in parameters(mechanism, "mechanism"):
        units[path] = turned(quantity.unit, angular and bool(quantity.or_unit))
    turning = {one.name: slips_by_angle(mechanism, one) for one in mechanism.contacts()}
    everywhere = all(turning.values())  # a law of all contacts
    for path, quantity, _ in parameters(law, "friction"):
        units[path] = turned(quantity.unit, turning.get(path.split(".")[1], everywhere))
    return units


def name_of_only_contact(mechanism: Mechanism) -> str:
    """Return the name of the contact where there is one; empty if there are several."""
    contacts = mechanism.contacts()
    return contacts[0].name if len(contacts) == 1 else ""
