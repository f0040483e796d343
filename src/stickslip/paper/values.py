"""The numbers of the paper's rig: Table I, and what is assumed where it prints nothing."""

from dataclasses import dataclass, replace
from typing import Self

from stickslip.errors import InputError
from stickslip.experiments import Measurement, Rig, load_rig
from stickslip.friction import Coulomb, CoulombViscous, FrictionLaw, LuGre
from stickslip.identification import Estimate
from stickslip.kinds import TravelVerdict
from stickslip.mechanisms import SpringBlock
from stickslip.quantities import vary

OWN = (
    "give a rig file with a spring-block on the level that a compressed spring sets in motion, and"
    " its travel."
)
"""What another rig than the bundled one has to be."""


@dataclass(frozen=True, kw_only=True)
class PaperValues:
    """Rig and coefficients in the paper's own terms: forces, not levels."""

    rig: SpringBlock
    """The block, as the rig file gives it, in the first trial."""
    measured: float
    """Measured travel [m], of the first trial."""
    uncertainty: float
    """Of that travel [m]: half a digit where it is rounded, else standard; 0 if not stated."""
    rounded: bool
    """Whether the uncertainty is that of rounding."""
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

    @property
    def force(self) -> float:
        """Force of the compressed spring [N]."""
        return self.rig.stiffness * self.rig.compression

    @property
    def own_reading(self) -> str:
        """B if the block leaves its spring, C if it stays fastened."""
        return "C" if self.rig.attached else "B"

    @classmethod
    def of(cls, rig: Rig) -> Self:
        """Read the values off a rig that has the paper's form."""
        mechanism, first = check_form(rig)
        viscous, lugre = rig.laws.get("coulomb-viscous"), rig.laws.get("lugre")
        if not isinstance(viscous, CoulombViscous) or not isinstance(lugre, LuGre):
            raise InputError("the audit of the paper needs its laws coulomb-viscous and lugre.")
        load = mechanism.mass * mechanism.gravity
        return cls(
            rig=mechanism,
            measured=float(first.travel or 0.0),
            uncertainty=float(first.uncertainty.get("travel", 0.0)),
            rounded=first.uncertainty_kind == "rounding",
            mu_k=lugre.kinetic_coefficient,
            mu_s=lugre.static_coefficient,
            viscous=viscous.viscous_coefficient,
            stribeck_velocity=lugre.stribeck_velocity,
            stiffness=lugre.bristle_stiffness * load,
            damping=lugre.bristle_damping * load,
        )


def check_form(rig: Rig) -> tuple[SpringBlock, Measurement]:
    """Return the block and the first of its trials."""
    mechanism, measurement = rig.mechanism, rig.measurement
    if not isinstance(mechanism, SpringBlock) or measurement is None:
        raise InputError(f"the audit of the paper needs a spring-block with its travel: {OWN}")
    first = measurement.records()[0]
    mechanism = vary(mechanism, "mechanism", first.overrides)
    released = mechanism.stiffness > 0.0 and mechanism.compression > 0.0
    stops = mechanism.lower_stop is not None or mechanism.upper_stop is not None
    if not released or mechanism.drive is not None or mechanism.incline or stops:
        raise InputError(
            "the audit of the paper needs a compressed spring as the only drive, and neither an"
            f" incline nor stops: {OWN}"
        )
    if not all(one.travel is not None and one.travel > 0.0 for one in measurement.records()):
        raise InputError(f"the audit of the paper needs travels above 0 m: {OWN}")
    return mechanism, first


def adopted(rig: Rig, verdict: TravelVerdict) -> Rig:
    """Return a rig with the laws of the paper at its own levels.

    What its file gives stays. Levels that it does not give are those of Coulomb friction as fitted
    to its travels, and Coulomb + viscous is as fitted where they bound its viscous part; what the
    paper does not print either is assumed as for the bundled rig, with the bristles in proportion
    to the load.
    """
    coulomb = rig.laws.get("coulomb")
    if coulomb is None:
        named = [one for one in verdict.candidates if one.name == "coulomb"]
        if not named or named[0].fit is None:
            raise InputError(
                "the audit of the paper needs a kinetic coefficient, and Coulomb friction does not"
                f" reproduce the travels of {rig.heading}: give kinetic_coefficient under"
                " [friction]."
            )
        coulomb = named[0].fit.law
    assert isinstance(coulomb, Coulomb)
    levels = {
        "kinetic_coefficient": coulomb.kinetic_coefficient,
        "static_coefficient": coulomb.break_away(1.0),
    }
    viscous = {one.path: one.value for one in viscous_fit(verdict)}
    laws: dict[str, FrictionLaw] = {}
    for name, law in load_rig().laws.items():
        own = {
            f"friction.{field}": value
            for field, value in levels.items()
            if getattr(law, field, None) is not None
        }
        own |= viscous if name.startswith("coulomb-viscous") else {}
        laws[name] = rig.laws.get(name) or vary(law, "friction", own)
    return replace(rig, laws=laws, published=())


def viscous_fit(verdict: TravelVerdict) -> tuple[Estimate, ...]:
    """Return the estimates of Coulomb + viscous friction if several travels bound its viscous part.

    One travel is reproduced with any viscous part, so that it bounds none.
    """
    for one in verdict.candidates:
        if one.name == "coulomb-viscous" and one.fit is not None and one.fit.settings > 1:
            estimates = one.fit.estimates
            paths = {each.path for each in estimates if each.bounded}
            return estimates if "friction.viscous_coefficient" in paths else ()
    return ()
