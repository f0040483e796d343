"""The friction equations of the source paper as printed, runnable, each with what is wrong in it.

They are evaluated literally, as a block diagram would: `stickslip.FixedStep` runs them. The
corrected law that each one stands for is its `corrected`. Where the typesetting leaves a choice,
the docstring says how it is read here.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from math import exp
from types import MappingProxyType
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.friction.base import FrictionLaw
from stickslip.friction.coulomb import Coulomb
from stickslip.friction.coulomb_viscous import CoulombViscous
from stickslip.friction.dahl import Dahl
from stickslip.friction.lugre import LuGre
from stickslip.friction.stribeck import Stribeck
from stickslip.maths import sign
from stickslip.quantities import Parametrised, Quantity

__all__ = ["PRINTED_FORMS", "PrintedForm"]


Mu = Annotated[float, Quantity("mu_k", low=0)]
MuStatic = Annotated[float, Quantity("mu_s", low=0, at_least="kinetic_coefficient")]
Sigma0 = Annotated[float, Quantity("sigma_0", "N/m", above=0)]
Sigma1 = Annotated[float, Quantity("sigma_1", "N s/m", low=0)]
Sigma2 = Annotated[float, Quantity("sigma_2", "N s/m", low=0)]
Vs = Annotated[float, Quantity("v_s", "m/s", above=0)]


@dataclass(frozen=True, kw_only=True)
class PrintedForm(Parametrised, ABC):
    """A published equation, kept with its misprint."""

    name: ClassVar[str]
    title: ClassVar[str]
    equation: ClassVar[str]
    """Number in the paper."""
    formula: ClassVar[str]
    """The equation as printed, in LaTeX."""
    defect: ClassVar[str]
    """What is wrong, in words."""
    cure: ClassVar[str]
    """The corrected form, in words or symbols."""
    corrected: ClassVar[type[FrictionLaw]]
    bristles: ClassVar[tuple[str, ...]] = ()

    @abstractmethod
    def force(
        self, velocity: float, bristles: tuple[float, ...], load: float, applied: float
    ) -> float:
        """Return the friction force [N] that the printed equation gives.

        Parameters
        ----------
        velocity : float
            Slip velocity [m/s].
        bristles : tuple of float
            Bristle deflection [m] of the forms that have one.
        load : float
            Normal force [N].
        applied : float
            Sum of the other forces on the body [N], which some forms return at rest.
        """

    @abstractmethod
    def bristle_rates(
        self, velocity: float, bristles: tuple[float, ...], load: float
    ) -> tuple[float, ...]:
        """Return the rates of the bristle states, empty where there are none."""


@dataclass(frozen=True, kw_only=True)
class _Memoryless(PrintedForm, ABC):
    @final
    @override
    def bristle_rates(
        self, velocity: float, bristles: tuple[float, ...], load: float
    ) -> tuple[float, ...]:
        return ()


@final
@dataclass(frozen=True, kw_only=True)
class PrintedCoulomb(_Memoryless):
    """Eq. (1): sgn(0) = 0, so nothing is held at rest."""

    name: ClassVar[str] = "printed-1"
    title: ClassVar[str] = "Coulomb"
    equation: ClassVar[str] = "(1)"
    formula: ClassVar[str] = r"F = \mu_k N \operatorname{sgn} v, \quad \operatorname{sgn} 0 = 0"
    defect: ClassVar[str] = "no stiction: sgn 0 = 0 lets any small force move a resting body"
    cure: ClassVar[str] = "stick while the needed force is at most mu_s N"
    corrected: ClassVar[type[FrictionLaw]] = Coulomb

    kinetic_coefficient: Mu

    @override
    def force(
        self, velocity: float, bristles: tuple[float, ...], load: float, applied: float
    ) -> float:
        mu_k = self.kinetic_coefficient
        return float(mu_k * load * sign(velocity))


@final
@dataclass(frozen=True, kw_only=True)
class PrintedSigned(_Memoryless):
    """Eqs (3) and (4): the coefficient carries the sign of v and is multiplied by it again.

    Read here as mu = mu_k sgn v (mu_k at rest) in F = mu N sgn v + sigma_2 v.
    """

    name: ClassVar[str] = "printed-3-4"
    title: ClassVar[str] = "Coulomb + viscous + static"
    equation: ClassVar[str] = "(3), (4)"
    formula: ClassVar[str] = (
        r"F = \mu N \operatorname{sgn} v + \sigma_2 v, \quad \mu = \mu_k \operatorname{sgn} v"
    )
    defect: ClassVar[str] = (
        "the two signs cancel: moving backwards, friction pushes the body on; at rest it is mu_k N"
        " whatever is needed"
    )
    cure: ClassVar[str] = "mu_k N sgn v + sigma_2 v, and the inequality at rest"
    corrected: ClassVar[type[FrictionLaw]] = CoulombViscous

    kinetic_coefficient: Mu
    viscous_coefficient: Sigma2 = 0.0

    @override
    def force(
        self, velocity: float, bristles: tuple[float, ...], load: float, applied: float
    ) -> float:
        mu_k, sigma_2 = self.kinetic_coefficient, self.viscous_coefficient
        if velocity == 0:
            return mu_k * load
        mu = mu_k * sign(velocity)
        return float(mu * load * sign(velocity) + sigma_2 * velocity)


@final
@dataclass(frozen=True, kw_only=True)
class PrintedStribeck(_Memoryless):
    """Eq. (5): the exponent has no absolute value and the force no sign."""

    name: ClassVar[str] = "printed-5"
    title: ClassVar[str] = "Stribeck"
    equation: ClassVar[str] = "(5)"
    formula: ClassVar[str] = r"F = F_c + (F_s - F_c) e^{-v/v_s} + \sigma_2 v"
    defect: ClassVar[str] = "grows without limit for v < 0, where it also has the wrong sign"
    cure: ClassVar[str] = "(F_c + (F_s - F_c) exp(-|v/v_s|^n)) sgn v + sigma_2 v"
    corrected: ClassVar[type[FrictionLaw]] = Stribeck

    kinetic_coefficient: Mu
    static_coefficient: MuStatic
    stribeck_velocity: Vs
    viscous_coefficient: Sigma2 = 0.0

    @override
    def force(
        self, velocity: float, bristles: tuple[float, ...], load: float, applied: float
    ) -> float:
        f_c, f_s = self.kinetic_coefficient * load, self.static_coefficient * load
        v_s, sigma_2 = self.stribeck_velocity, self.viscous_coefficient
        return f_c + (f_s - f_c) * exp(-velocity / v_s) + sigma_2 * velocity


@final
@dataclass(frozen=True, kw_only=True)
class PrintedDahl(PrintedForm):
    """Eq. (6): the bristle force is multiplied by sgn v; at rest it equals the applied force."""

    name: ClassVar[str] = "printed-6"
    title: ClassVar[str] = "Dahl"
    equation: ClassVar[str] = "(6)"
    formula: ClassVar[str] = r"F = \sigma_0 z \operatorname{sgn} v, \quad F = F_x \text{ at } v = 0"
    defect: ClassVar[str] = (
        "z already has a sign: after a reversal the bristle pushes the wrong way; at rest friction"
        " equals the applied force without limit, so a resting body never starts"
    )
    cure: ClassVar[str] = "F = sigma_0 z, clipped at break-away if the body is held"
    corrected: ClassVar[type[FrictionLaw]] = Dahl
    bristles: ClassVar[tuple[str, ...]] = ("z",)

    kinetic_coefficient: Mu
    bristle_stiffness: Sigma0

    @override
    def force(
        self, velocity: float, bristles: tuple[float, ...], load: float, applied: float
    ) -> float:
        (z,) = bristles
        sigma_0 = self.bristle_stiffness
        return applied if velocity == 0 else float(sigma_0 * z * sign(velocity))

    @override
    def bristle_rates(
        self, velocity: float, bristles: tuple[float, ...], load: float
    ) -> tuple[float, ...]:
        (z,) = bristles
        f_c = self.kinetic_coefficient * load
        return (velocity - self.bristle_stiffness * abs(velocity) * z / f_c,)


@final
@dataclass(frozen=True, kw_only=True)
class PrintedCoulombSwitch(_Memoryless):
    """Eq. (7): Coulomb with the static switch; at rest friction equals the applied force."""

    name: ClassVar[str] = "printed-7"
    title: ClassVar[str] = "Coulomb, switched"
    equation: ClassVar[str] = "(7)"
    formula: ClassVar[str] = r"F = \mu_k N \operatorname{sgn} v, \quad F = F_x \text{ at } v = 0"
    defect: ClassVar[str] = (
        "no limit at rest: a resting body never starts, however hard it is pushed"
    )
    cure: ClassVar[str] = "F = F_x only while |F_x| <= mu_s N"
    corrected: ClassVar[type[FrictionLaw]] = Coulomb

    kinetic_coefficient: Mu

    @override
    def force(
        self, velocity: float, bristles: tuple[float, ...], load: float, applied: float
    ) -> float:
        mu_k = self.kinetic_coefficient
        return applied if velocity == 0 else float(mu_k * load * sign(velocity))


@final
@dataclass(frozen=True, kw_only=True)
class PrintedCoulombViscousSwitch(_Memoryless):
    """Eq. (8): the viscous part is multiplied by sgn v."""

    name: ClassVar[str] = "printed-8"
    title: ClassVar[str] = "Coulomb + viscous, switched"
    equation: ClassVar[str] = "(8)"
    formula: ClassVar[str] = (
        r"F = \mu_k N \operatorname{sgn} v + \sigma_2 v \operatorname{sgn} v,"
        r" \quad F = F_x \text{ at } v = 0"
    )
    defect: ClassVar[str] = "the viscous part pushes when v < 0; no limit at rest"
    cure: ClassVar[str] = "sigma_2 v without the sign; at most mu_s N at rest"
    corrected: ClassVar[type[FrictionLaw]] = CoulombViscous

    kinetic_coefficient: Mu
    viscous_coefficient: Sigma2

    @override
    def force(
        self, velocity: float, bristles: tuple[float, ...], load: float, applied: float
    ) -> float:
        mu_k, sigma_2 = self.kinetic_coefficient, self.viscous_coefficient
        if velocity == 0:
            return applied
        return float((mu_k * load + sigma_2 * velocity) * sign(velocity))


@final
@dataclass(frozen=True, kw_only=True)
class PrintedLuGre(PrintedForm):
    """Eq. (9): the stiffness, damping and viscous terms with sgn v, the exponent without |v|.

    The paper numbers the sigmas 1 to 3; they are named here as everywhere else.
    """

    name: ClassVar[str] = "printed-9"
    title: ClassVar[str] = "LuGre, switched"
    equation: ClassVar[str] = "(9)"
    formula: ClassVar[str] = (
        r"F = (\sigma_1 z + \sigma_2 \dot z + \sigma_3 v) \operatorname{sgn} v, \quad"
        r" g = F_c + (F_s - F_c) e^{-(v/v_s)}, \quad F = F_x \text{ at } v = 0"
    )
    defect: ClassVar[str] = (
        "for v < 0 all three parts change sign, and g grows without limit, so the bristle never"
        " yields; no limit at rest"
    )
    cure: ClassVar[str] = "sigma_0 z + sigma_1 z' + sigma_2 v with exp(-|v/v_s|^n)"
    corrected: ClassVar[type[FrictionLaw]] = LuGre
    bristles: ClassVar[tuple[str, ...]] = ("z",)

    kinetic_coefficient: Mu
    static_coefficient: MuStatic
    stribeck_velocity: Vs
    bristle_stiffness: Sigma0
    bristle_damping: Sigma1
    viscous_coefficient: Sigma2 = 0.0

    @override
    def force(
        self, velocity: float, bristles: tuple[float, ...], load: float, applied: float
    ) -> float:
        if velocity == 0:
            return applied
        (z,) = bristles
        (z_dot,) = self.bristle_rates(velocity, bristles, load)
        total = self.bristle_stiffness * z + self.bristle_damping * z_dot
        return float((total + self.viscous_coefficient * velocity) * sign(velocity))

    @override
    def bristle_rates(
        self, velocity: float, bristles: tuple[float, ...], load: float
    ) -> tuple[float, ...]:
        (z,) = bristles
        f_c, f_s = self.kinetic_coefficient * load, self.static_coefficient * load
        g = f_c + (f_s - f_c) * exp(-velocity / self.stribeck_velocity)
        return (velocity - self.bristle_stiffness * abs(velocity) * z / g,)


@final
@dataclass(frozen=True, kw_only=True)
class PrintedStribeckSwitch(_Memoryless):
    """Eq. (10): the viscous part is multiplied by sgn v; no limit at rest."""

    name: ClassVar[str] = "printed-10"
    title: ClassVar[str] = "Stribeck, switched"
    equation: ClassVar[str] = "(10)"
    formula: ClassVar[str] = (
        r"F = [F_c + (F_s - F_c) e^{-|v/v_s|}] \operatorname{sgn} v"
        r" + \sigma_2 v \operatorname{sgn} v, \quad F = F_x \text{ at } v = 0"
    )
    defect: ClassVar[str] = "the viscous part pushes when v < 0; no limit at rest"
    cure: ClassVar[str] = "sigma_2 v without the sign; at most F_s at rest"
    corrected: ClassVar[type[FrictionLaw]] = Stribeck

    kinetic_coefficient: Mu
    static_coefficient: MuStatic
    stribeck_velocity: Vs
    viscous_coefficient: Sigma2 = 0.0

    @override
    def force(
        self, velocity: float, bristles: tuple[float, ...], load: float, applied: float
    ) -> float:
        if velocity == 0:
            return applied
        f_c, f_s = self.kinetic_coefficient * load, self.static_coefficient * load
        level = f_c + (f_s - f_c) * exp(-abs(velocity) / self.stribeck_velocity)
        return float((level + self.viscous_coefficient * velocity) * sign(velocity))


PRINTED_FORMS: Mapping[str, type[PrintedForm]] = MappingProxyType(
    {
        form.name: form
        for form in (
            PrintedCoulomb,
            PrintedSigned,
            PrintedStribeck,
            PrintedDahl,
            PrintedCoulombSwitch,
            PrintedCoulombViscousSwitch,
            PrintedLuGre,
            PrintedStribeckSwitch,
        )
    }
)
"""The printed equations by name."""
