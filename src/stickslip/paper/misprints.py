"""What each printed equation does in four tests, beside the corrected law."""

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
    Viscous,
)
from stickslip.mechanisms import SpringBlock
from stickslip.paper.excitations import PUSH_DURATION
from stickslip.paper.values import PaperValues
from stickslip.selection import Criteria, criteria_of
from stickslip.simulation import simulate
from stickslip.solver import FixedStep
from stickslip.trajectory import Status

STEP = 5e-4
"""Fine enough that what is seen is the equation and not the step [s]."""
BRISTLE_STEP = 1e-4
"""The same for forms with bristles, whose deflection decays in a fraction of a millisecond [s]."""
BACKWARD = -0.5
"""Initial velocity of the test in which a body coasts backwards [m/s]."""
HELD = 0.5
"""Force against which the block is held, over kinetic friction."""
SECONDS = 1.0
"""How long each test lasts."""
TESTS: Mapping[str, str] = {
    "coast": "coasting forwards",
    "push": "pushed from rest",
    "backward": "coasting backwards",
    "hold": "held at rest",
}
"""The tests by key: what is done to the block."""


@dataclass(frozen=True, kw_only=True)
class PrintedRun:
    """What a printed equation does in a test."""

    criteria: Criteria
    """The paper's criteria of the run."""
    diverged: bool
    """Whether it grew beyond all numbers."""
    lasted: float
    """Time that the run covered [s]."""

    def errs(self, corrected: Criteria) -> bool:
        """Whether the travel differs by more than the step explains: 1 mm and 1 %."""
        gap = abs(self.criteria.travel - corrected.travel)
        return self.diverged or gap > 0.01 * abs(corrected.travel) + 1e-3


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What a printed equation and its corrected law make of a test."""

    test: str
    """Key of `TESTS`."""
    printed: PrintedRun
    """The equation as it stands."""
    with_rule: PrintedRun
    """The same with a stick rule, which none of the equations prints."""
    corrected: Criteria
    """The paper's criteria of the run with the corrected law."""

    @property
    def differs(self) -> bool:
        """Whether the printed equation errs by more than the step explains."""
        return self.printed.errs(self.corrected)


@dataclass(frozen=True, kw_only=True)
class Consequence:
    """One printed equation and what it does in the tests."""

    printed: PrintedForm
    """The printed equation, with its values."""
    corrected: FrictionLaw
    """The corrected law, with its values."""
    outcomes: tuple[Outcome, ...]
    """What came of each test of the equation."""

    @property
    def form(self) -> type[PrintedForm]:
        """The printed equation."""
        return type(self.printed)

    def outcome(self, test: str) -> Outcome | None:
        """Return what came of a test; None if it says nothing about the equation."""
        return next((one for one in self.outcomes if one.test == test), None)

    def differs(self, test: str) -> bool:
        """Whether the misprint acts in a test."""
        found = self.outcome(test)
        return found is not None and found.differs


@dataclass(frozen=True)
class _Test:
    mechanism: SpringBlock
    velocity: float = 0.0


def consequences(values: PaperValues) -> tuple[Consequence, ...]:
    """Run every printed equation and its corrected twin through the tests.

    ``coast`` is the motion of the paper's own rig after its push, ``push`` that push from rest,
    ``backward`` a reversed motion, and ``hold`` a force below kinetic friction, against which laws
    without a level are not tried.
    """
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
        "printed-3": level,
        "printed-4": {**level, "weight": values.load},
        "printed-5": curve,
        "printed-6": {**level, **bristle},
        "printed-7": level,
        "printed-8": viscous,
        "printed-9": {**curve, **bristle, "bristle_damping": values.damping},
        "printed-10": {**level, **viscous},
    }
    twins, tests = _twins(values), _tests(values)
    found = []
    for name, form in PRINTED_FORMS.items():
        printed, twin = form(**arguments[name]), twins[form.corrected.name]
        outcomes = tuple(
            _outcome(printed, twin, key, test)
            for key, test in tests.items()
            if key != "hold" or hasattr(twin, "kinetic_coefficient")
        )
        found.append(Consequence(printed=printed, corrected=twin, outcomes=outcomes))
    return tuple(found)


def _tests(values: PaperValues) -> dict[str, _Test]:
    """Return the tests; the held block is pushed with less than kinetic friction."""
    rig = values.rig

    def block(force: float, duration: float) -> SpringBlock:
        drive = Pulse(level=force, duration=duration) if force else None
        return SpringBlock(mass=rig.mass, gravity=rig.gravity, drive=drive)

    force = rig.stiffness * rig.compression
    pushed = (force - values.mu_k * values.load) * PUSH_DURATION / rig.mass
    below = HELD * values.mu_k * values.load
    return {
        "coast": _Test(block(0.0, 0.0), pushed),
        "push": _Test(block(force, PUSH_DURATION)),
        "backward": _Test(block(0.0, 0.0), BACKWARD),
        "hold": _Test(block(below, SECONDS)),
    }


def _twins(values: PaperValues) -> dict[str, FrictionLaw]:
    """Return the corrected laws with the same numbers."""
    load, mu_k, mu_s, viscous = values.load, values.mu_k, values.mu_s, values.viscous
    return {
        "viscous": Viscous(viscous_coefficient=viscous),
        "coulomb": Coulomb(kinetic_coefficient=mu_k, static_coefficient=mu_s),
        "coulomb-viscous": CoulombViscous(
            kinetic_coefficient=mu_k, static_coefficient=mu_s, viscous_coefficient=viscous
        ),
        "stribeck": Stribeck(
            kinetic_coefficient=mu_k,
            static_coefficient=mu_s,
            stribeck_velocity=values.stribeck_velocity,
            viscous_coefficient=viscous,
            fading_exponent=1,
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


def _outcome(form: PrintedForm, twin: FrictionLaw, key: str, test: _Test) -> Outcome:
    start = {"v": test.velocity}
    dt = BRISTLE_STEP if form.states else STEP

    def printed(*, stick_rule: bool) -> PrintedRun:
        solver = FixedStep(dt=dt, method="heun", stick_rule=stick_rule)
        run = simulate(test.mechanism, form, t_end=SECONDS, y0=start, solver=solver, throw=False)
        return PrintedRun(
            criteria=criteria_of(run, test.mechanism),
            diverged=run.status is Status.NOT_FINITE,
            lasted=run.span[1],
        )

    corrected = simulate(test.mechanism, twin, t_end=SECONDS, y0=start)
    return Outcome(
        test=key,
        printed=printed(stick_rule=False),
        with_rule=printed(stick_rule=True),
        corrected=criteria_of(corrected, test.mechanism),
    )
