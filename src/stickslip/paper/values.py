"""The numbers of the paper's rig: Table I, and what is assumed where it prints nothing."""

from dataclasses import dataclass
from typing import Self

from stickslip.errors import InputError
from stickslip.experiments import Rig
from stickslip.friction import CoulombViscous, LuGre
from stickslip.mechanisms import SpringBlock

__all__ = ["PaperValues"]


@dataclass(frozen=True, kw_only=True)
class PaperValues:
    """Rig and coefficients in the paper's own terms: forces, not levels."""

    rig: SpringBlock
    """The block, as the rig file gives it."""
    measured: float
    """Measured travel [m]."""
    mu_k: float
    """Kinetic coefficient."""
    mu_s: float
    """Static coefficient."""
    viscous: float
    """Viscous coefficient [N s/m]; assumed."""
    stribeck_velocity: float
    """[m/s]; assumed."""
    stiffness: float
    """Of the bristles [N/m]; assumed."""
    damping: float
    """Of the bristles [N s/m]; assumed."""

    @property
    def load(self) -> float:
        """Weight of the block [N]."""
        return self.rig.mass * self.rig.gravity

    @classmethod
    def of(cls, rig: Rig) -> Self:
        """Read the values off a rig that has the paper's form.

        Raises
        ------
        InputError
            If the rig is no spring-block with a travel and the laws of the paper.
        """
        mechanism, measurement = rig.mechanism, rig.measurement
        viscous, lugre = rig.laws.get("coulomb-viscous"), rig.laws.get("lugre")
        if not isinstance(mechanism, SpringBlock) or measurement is None:
            raise InputError("the audit of the paper needs a spring-block with a measured travel.")
        if not isinstance(viscous, CoulombViscous) or not isinstance(lugre, LuGre):
            raise InputError("the audit of the paper needs its laws coulomb-viscous and lugre.")
        load = mechanism.mass * mechanism.gravity
        return cls(
            rig=mechanism,
            measured=float(measurement.records()[0].travel or 0.0),
            mu_k=lugre.kinetic_coefficient,
            mu_s=lugre.static_coefficient,
            viscous=viscous.viscous_coefficient,
            stribeck_velocity=lugre.stribeck_velocity,
            stiffness=lugre.bristle_stiffness * load,
            damping=lugre.bristle_damping * load,
        )
