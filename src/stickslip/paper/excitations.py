"""Two readings of how the rig sets the block in motion, and a control."""

from dataclasses import dataclass, replace

from stickslip.drives import Pulse
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import SpringBlock
from stickslip.selection import Criteria, criteria_of
from stickslip.simulation import simulate
from stickslip.trajectory import Trajectory

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
