"""What each printed equation does where it is wrong, beside the corrected law."""

from collections.abc import Mapping
from dataclasses import dataclass

from stickslip.drives import Pulse
from stickslip.friction import (
    PRINTED_FORMS,
    Coulomb,
    CoulombViscous,
    Dahl,
    FrictionLaw,
    LuGre,
    PrintedForm,
    Stribeck,
)
from stickslip.mechanisms import SpringBlock
from stickslip.paper.values import PaperValues
from stickslip.selection import Criteria, criteria_of
from stickslip.simulation import simulate
from stickslip.solver import FixedStep
from stickslip.trajectory import Status

__all__ = ["Consequence", "consequences"]

STEP = 5e-4
"""Fine enough that what is seen is the equation and not the step [s]."""
BACKWARD = -0.5
"""Initial velocity of the test in which a body coasts backwards [m/s]."""


@dataclass(frozen=True, kw_only=True)
class Consequence:
    """One printed equation, a test that shows its defect, and both outcomes."""

    form: type[PrintedForm]
    test: str
    """What is done to the block."""
    printed: Criteria
    """What the printed equation makes of it."""
    corrected: Criteria
    """What the corrected law makes of it."""
    diverged: bool
    """Whether the printed equation grew beyond all numbers."""
    lasted: float
    """Time that the printed run covered [s]."""


@dataclass(frozen=True)
class _Test:
    text: str
    mechanism: SpringBlock
    velocity: float = 0.0
    t_end: float = 1.0


def consequences(values: PaperValues) -> tuple[Consequence, ...]:
    """Run every printed equation and its corrected twin through the test that tells them apart."""
    level = {"kinetic_coefficient": values.mu_k}
    viscous = {"viscous_coefficient": values.viscous}
    curve = {
        **level,
        **viscous,
        "static_coefficient": values.mu_s,
        "stribeck_velocity": values.stribeck_velocity,
    }
    bristle = {"bristle_stiffness": values.stiffness}
    arguments: dict[str, Mapping[str, float]] = {
        "printed-1": level,
        "printed-3-4": {**level, **viscous},
        "printed-5": curve,
        "printed-6": {**level, **bristle},
        "printed-7": level,
        "printed-8": {**level, **viscous},
        "printed-9": {**curve, **bristle, "bristle_damping": values.damping},
        "printed-10": curve,
    }
    twins, tests = _twins(values), _tests(values)
    return tuple(
        _consequence(form(**arguments[name]), twins[form.corrected.name], tests[TESTED_BY[name]])
        for name, form in PRINTED_FORMS.items()
    )


TESTED_BY = {
    "printed-1": "held",
    "printed-3-4": "backward",
    "printed-5": "backward",
    "printed-6": "push",
    "printed-7": "push",
    "printed-8": "backward",
    "printed-9": "backward",
    "printed-10": "backward",
}
"""The test that shows the defect of each form."""


def _tests(values: PaperValues) -> dict[str, _Test]:
    """Return the tests; the held block is pushed between kinetic and static friction."""
    rig = values.rig

    def block(force: float, duration: float) -> SpringBlock:
        drive = Pulse(level=force, duration=duration) if force else None
        return SpringBlock(mass=rig.mass, gravity=rig.gravity, drive=drive)

    between = 0.5 * (values.mu_k + values.mu_s) * values.load
    force = rig.stiffness * rig.compression
    return {
        "held": _Test(f"at rest, pushed with {between:.3g} N for 1 s", block(between, 1.0)),
        "push": _Test(f"at rest, pushed with {force:.3g} N for 0.1 s", block(force, 0.1)),
        "backward": _Test(
            f"coasting backwards from {-BACKWARD:g} m/s for 1 s", block(0.0, 0.0), BACKWARD
        ),
    }


def _twins(values: PaperValues) -> dict[str, FrictionLaw]:
    """Return the corrected laws with the same numbers."""
    load, mu_k, mu_s, viscous = values.load, values.mu_k, values.mu_s, values.viscous
    return {
        "coulomb": Coulomb(kinetic_coefficient=mu_k, static_coefficient=mu_s),
        "coulomb-viscous": CoulombViscous(
            kinetic_coefficient=mu_k, static_coefficient=mu_s, viscous_coefficient=viscous
        ),
        "stribeck": Stribeck(
            kinetic_coefficient=mu_k,
            static_coefficient=mu_s,
            stribeck_velocity=values.stribeck_velocity,
            viscous_coefficient=viscous,
            exponent=1,
        ),
        "dahl": Dahl.from_forces(
            load=load,
            kinetic_force=mu_k * load,
            bristle_stiffness=values.stiffness,
            static_switch=True,
        ),
        "lugre": LuGre.from_forces(
            load=load,
            kinetic_force=mu_k * load,
            static_force=mu_s * load,
            stribeck_velocity=values.stribeck_velocity,
            bristle_stiffness=values.stiffness,
            bristle_damping=values.damping,
            viscous_coefficient=viscous,
            static_switch=True,
        ),
    }


def _consequence(form: PrintedForm, twin: FrictionLaw, test: _Test) -> Consequence:
    start = {"v": test.velocity}
    solver = FixedStep(dt=STEP, method="heun", stick_rule=True)
    printed = simulate(test.mechanism, form, t_end=test.t_end, y0=start, solver=solver, throw=False)
    corrected = simulate(test.mechanism, twin, t_end=test.t_end, y0=start)
    return Consequence(
        form=type(form),
        test=test.text,
        printed=criteria_of(printed, test.mechanism),
        corrected=criteria_of(corrected, test.mechanism),
        diverged=printed.status is Status.NOT_FINITE,
        lasted=printed.span[1],
    )
