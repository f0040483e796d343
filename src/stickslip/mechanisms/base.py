"""What a mechanism is: energies, forces, and the contacts at which it rubs."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from stickslip.drives import Drive
from stickslip.maths import Scalar
from stickslip.quantities import Parametrised

__all__ = ["Contact", "Mechanism"]


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Where a body rubs: the coordinate that slips, and what presses.

    Parameters
    ----------
    slip : str
        Coordinate whose rate is the slip velocity.
    normal : str, optional
        A coordinate held at 0 whose reaction is the normal force.
    load : float, optional
        The normal force [N] where it is prescribed instead.
    name : str
        Tells contacts apart where there are several.
    """

    slip: str
    normal: str | None = None
    load: Scalar | None = None
    name: str = ""


@dataclass(frozen=True, kw_only=True)
class Mechanism(Parametrised, ABC):
    """A mechanism without its friction, given by Lagrange's method.

    The equations use `stickslip.maths` and are derived, not typed: mass matrix, forces, normal
    force and all derivatives follow from the energies. Coordinates that a contact holds at 0 stand
    in the energies like any other.
    """

    name: ClassVar[str]
    """Key in the registry and ``type`` in rig files."""
    coordinates: ClassVar[tuple[str, ...]]
    """State names of the moving coordinates."""
    rates: ClassVar[tuple[str, ...]]
    """State names of their time derivatives."""
    units: ClassVar[tuple[str, ...]]
    """SI units of the coordinates."""

    @abstractmethod
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        """Return the kinetic energy [J] at coordinates and rates, both by coordinate name."""

    @abstractmethod
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        """Return the potential energy [J]; time stands in it where a support is moved."""

    @abstractmethod
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        """Return the other generalised forces by coordinate, friction left out.

        Parameters
        ----------
        t : float
            Time [s].
        q, q_dot : mapping
            Coordinates and their rates by coordinate name.
        drives : mapping
            Present values of the drives by name.
        """

    @abstractmethod
    def contacts(self) -> tuple[Contact, ...]:
        """Return the contacts."""

    @abstractmethod
    def drives(self) -> Mapping[str, Drive]:
        """Return the drives that are fitted, by field name."""
