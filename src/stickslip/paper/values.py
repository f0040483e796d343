"""The paper's rig: its numbers, how it is set in motion, and its first phenomenon, stick-slip."""

import math
from dataclasses import dataclass, replace
from typing import Self

from stickslip.drives import Pulse
from stickslip.errors import InputError
from stickslip.experiments import Measurement, Rig, load_rig
from stickslip.friction import Coulomb, CoulombViscous, FrictionLaw, LuGre
from stickslip.identification import Estimate
from stickslip.kinds import TravelVerdict
from stickslip.mechanisms import SpringBlock, TowedBlock
from stickslip.quantities import vary
from stickslip.selection import Criteria, criteria_of
from stickslip.simulation import simulate
from stickslip.trajectory import Trajectory

# The numbers of the paper's rig: Table I, and what is assumed where it prints nothing.

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


# Two readings of how the rig sets the block in motion, and a control.

PUSH_DURATION = 0.1
"""The paper: "applied time 0.1 s"."""


@dataclass(frozen=True, kw_only=True)
class Excitation:
    """One reading and what a law makes of it."""

    key: str
    """A, B or C."""
    title: str
    """Words that name the reading."""
    text: str
    """What the reading assumes, in one sentence."""
    mechanism: SpringBlock
    """The block in that reading."""
    run: Trajectory
    """The trajectory."""
    criteria: Criteria
    """The paper's criteria of that run."""
    closed_form: float | None
    """Travel of Coulomb friction by formula [m], where there is one."""


def rigs(rig: SpringBlock) -> dict[str, tuple[str, str, SpringBlock]]:
    """Return title, description and mechanism of the three readings of a released spring."""
    force = rig.stiffness * rig.compression
    push = SpringBlock(
        mass=rig.mass,
        gravity=rig.gravity,
        drive=Pulse(level=force, duration=PUSH_DURATION),
    )
    return {
        "A": (
            "Push",
            f"{force:g} N for {PUSH_DURATION:g} s, then coasting.",
            push,
        ),
        "B": (
            "Released spring",
            f"Compressed {rig.compression:g} m; the block leaves it at its natural length.",
            replace(rig, attached=False),
        ),
        "C": (
            "Fixed spring",
            "A control, not in the paper: as B, but the block stays fastened.",
            replace(rig, attached=True),
        ),
    }


def excitations(
    rig: SpringBlock, law: FrictionLaw, *, measured: float, t_end: float
) -> tuple[Excitation, ...]:
    """Run a law in the three readings of the rig.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
    >>> [f"{e.criteria.travel:.4f}" for e in excitations(rig, law, measured=0.2, t_end=10.0)]
    ['0.1539', '0.2039', '0.0981']
    """
    found = []
    for key, (title, text, mechanism) in rigs(rig).items():
        run = simulate(mechanism, law, t_end=t_end)
        found.append(
            Excitation(
                key=key,
                title=title,
                text=text,
                mechanism=mechanism,
                run=run,
                criteria=criteria_of(run, mechanism, measured),
                closed_form=_closed_form(key, rig, law),
            )
        )
    return tuple(found)


def _closed_form(key: str, rig: SpringBlock, law: FrictionLaw) -> float | None:
    """Return the travel of Coulomb friction: A by momentum, B by energy.

    A holds if the push starts the block, B if the block gets as far as to leave the spring.
    """
    mu_k = getattr(law, "kinetic_coefficient", None)
    if law.name != "coulomb" or mu_k is None:
        return None
    f = mu_k * rig.mass * rig.gravity
    force = rig.stiffness * rig.compression
    held = law.break_away(rig.mass * rig.gravity)
    if f == 0.0 or held >= force:
        return None
    if key == "A":
        return float((force - f) * PUSH_DURATION**2 * force / (2.0 * rig.mass * f))
    energy = 0.5 * force * rig.compression
    if key == "B" and f * rig.compression < energy:
        return float(energy / f)
    return None


# Stick-slip, the first phenomenon of the paper (its III.B.1), on the block of Table I.

SPEED = 0.02
"""Of the far end of the spring [m/s]; ours: the paper gives no numbers for its example."""
PERIODS = 4.5
"""How long the block is pulled, after its first break-away."""


@dataclass(frozen=True, kw_only=True)
class StickSlip:
    """The block of Table I, pulled slowly by its spring."""

    mechanism: TowedBlock
    """The block with the spring that pulls it."""
    run: Trajectory
    """The trajectory."""
    stick_time: float
    """Of a period, from the run [s]."""
    slip_time: float
    """Of a period, from the run [s]."""
    stick_formula: float
    """2 D / V with D = (F_s - F_c) / k [s]."""
    slip_formula: float
    """(2 / w)(pi - atan(w D / V)) with w = sqrt(k / m) [s]."""


def stick_slip(values: PaperValues) -> StickSlip:
    """Pull the block of Table I through its spring, and time a period of stick-slip.

    Examples
    --------
    >>> from stickslip import load_rig
    >>> from stickslip.paper import PaperValues, stick_slip
    >>> found = stick_slip(PaperValues.of(load_rig()))
    >>> abs(found.slip_time - found.slip_formula) < 1e-9
    True
    """
    rig = values.rig
    towed = TowedBlock(mass=rig.mass, stiffness=rig.stiffness, speed=SPEED, gravity=rig.gravity)
    law = Coulomb(kinetic_coefficient=values.mu_k, static_coefficient=values.mu_s)
    surplus = (values.mu_s - values.mu_k) * values.load / rig.stiffness
    w = math.sqrt(rig.stiffness / rig.mass)
    stick = 2.0 * surplus / SPEED
    slip = (2.0 / w) * (math.pi - math.atan(w * surplus / SPEED))
    first = values.mu_s * values.load / (rig.stiffness * SPEED)
    run = simulate(towed, law, t_end=first + PERIODS * (stick + slip))
    starts = [event.t for event in run.events if event.from_mode == 0]
    stops = [event.t for event in run.events if event.to_mode == 0]
    return StickSlip(
        mechanism=towed,
        run=run,
        stick_time=starts[2] - stops[1],
        slip_time=stops[1] - starts[1],
        stick_formula=stick,
        slip_formula=slip,
    )
