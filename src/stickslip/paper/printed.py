"""What the paper prints wrongly, and what the parameters that it does not print would have to be.

Each printed equation is run in four tests beside the corrected law. A parameter without a value is
searched for from the least value on, in steps of a constant factor, until the travel crosses the
printed one; a root in that bracket, and those for travels that round to the printed one, are given.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any, NamedTuple

import scipy

from stickslip.engine.simulation import simulate
from stickslip.engine.solver import BreakAway, FixedStep
from stickslip.engine.trajectory import Status, Trajectory
from stickslip.errors import SimulationError
from stickslip.friction import (
    PRINTED_FORMS,
    Coulomb,
    CoulombViscous,
    Dahl,
    FrictionLaw,
    LuGre,
    PrintedForm,
    PrintedStribeck,
    Stribeck,
    Viscous,
)
from stickslip.identify import Criteria, criteria_of
from stickslip.mechanisms import SpringBlock
from stickslip.mechanisms.drives import Pulse
from stickslip.paper.rigs import PUSH_DURATION, PaperValues, rigs
from stickslip.show.documents import json_value

# What each printed equation does in four tests, beside the corrected law.

FINE_STEP = 5e-4
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
        return next((outcome for outcome in self.outcomes if outcome.test == test), None)

    def differs(self, test: str) -> bool:
        """Whether the misprint acts in a test."""
        result = self.outcome(test)
        return result is not None and result.differs


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
    result = []
    for name, form in PRINTED_FORMS.items():
        printed, twin = form(**arguments[name]), twins[form.corrected.name]
        outcomes = tuple(
            _outcome(printed, twin, key, test)
            for key, test in tests.items()
            if key != "hold" or hasattr(twin, "kinetic_coefficient")
        )
        result.append(Consequence(printed=printed, corrected=twin, outcomes=outcomes))
    return tuple(result)


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
        "dahl": dahl_row(values, values.stiffness),
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
    dt = BRISTLE_STEP if form.states else FINE_STEP

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


# What the parameters that the paper does not print would have to be to give its rows.
#
# Searches use reading A, a push, and reading B, a released spring; the range is that of the travels
# that round to the printed figure. Of the stiffness of the bristles, what it makes of the rows, and
# how far stiff ones move the block back when it stops and nothing holds it.

CART_STEP = 0.01
"""Sample time that the paper states for its cart [s]."""
BREAK_AWAY_RULES: tuple[BreakAway, BreakAway] = ("zero", "static")
"""Friction in the first step out of rest: none, since sgn 0 = 0, and as (5) has it."""
STEP_VISCOUS = 0.1
"""Viscous coefficient that is tried with it [N s/m]."""
STEP_DAHL, STEP_LUGRE = 51.0, 400.0
"""Stiffness of the bristles that is tried with it [N/m]."""
ROUNDING = 0.005
"""Half of the last printed digit of Table II [m]."""
STRIDE = 1.3
"""Ratio of neighbouring points of the search; two roots closer than this are not told apart."""
REACH = 64.0
"""How far the search for a root goes from its start, as a factor."""
STIFFNESS = 1e5
"""Of the bristles [N/m], the classical value of LuGre 1995."""
STIFFNESSES = (STIFFNESS, 1e4, 1e3, 1e2)
"""Of the bristles [N/m], from that of LuGre 1995 down to that of rubber."""


@dataclass(frozen=True, kw_only=True)
class Requirement:
    """The value of one unpublished parameter that gives a published travel."""

    law: str
    """Registry name of the row."""
    reading: str
    """A or B."""
    published: float
    """Printed travel [m]."""
    symbol: str
    """Symbol of the parameter."""
    unit: str
    """Its SI unit."""
    value: float | None
    """What it would have to be; None if no value gives the row."""
    low: float | None
    """Lower end of the range for travels that round to the printed one."""
    high: float | None
    """Upper end of that range."""
    start: float
    """Travel with the least value tried [m]."""
    kept: bool
    """Whether the model and all that is published are kept, so that only unpublished values
    differ."""
    text: str
    """What that means, in words."""
    solution: FrictionLaw | None
    """The law with that value."""
    run: Trajectory | None
    """The block with that law."""
    criteria: Criteria | None
    """What that run does."""

    def to_dict(self) -> dict[str, Any]:
        """Return all but law and run, ready for JSON."""
        names = [field.name for field in fields(self) if field.name not in {"solution", "run"}]
        return dict(json_value({name: getattr(self, name) for name in names}))


def requirements(
    values: PaperValues, published: Mapping[str, float], *, t_end: float
) -> tuple[Requirement, ...]:
    """Find the value behind each published travel, in readings A and B."""
    readings = {key: rigs(values.rig)[key][-1] for key in READINGS}
    return tuple(
        _require(values, case, key, published[case.law], block, t_end)
        for case in _cases(values)
        if case.law in published
        for key, block in readings.items()
    )


READINGS = ("A", "B")
"""Readings in which values are sought; in C the block ends where the spring pulls it back to."""


class Case(NamedTuple):
    """A row of Table II with the parameter that is sought."""

    law: str
    """Registry name of the row."""
    symbol: str
    """Symbol of the parameter."""
    unit: str
    """Its SI unit."""
    first: float
    """Value at which the search begins."""
    made: Callable[[float], FrictionLaw]
    """Returns the law with a value."""
    kept: bool
    """Whether the model and all that is published are kept."""
    text: str
    """What another value means, in words."""


def _cases(values: PaperValues) -> tuple[Case, ...]:
    def viscous(sigma: float) -> FrictionLaw:
        return CoulombViscous(kinetic_coefficient=values.mu_k, viscous_coefficient=sigma)

    return (
        Case(
            "coulomb", "mu_k", "1", values.mu_k, lambda mu: Coulomb(kinetic_coefficient=mu), False,
            "another coefficient than that of Table I",
        ),
        Case(
            "dahl", "sigma_0", "N/m", 50.0, partial(dahl_row, values), True,
            "bristles that yield by centimetres, the block held at its first stop",
        ),
        Case(
            "lugre", "sigma_0", "N/m", 1e3, partial(lugre_row, values), True,
            "with $sigma_1$ the root of $sigma_0$, $sigma_2$ 0.4 N s/m and $v_s$ 1 mm/s, as in"
            " LuGre 1995, and no hold at rest",
        ),
        Case(
            "stribeck", "sigma_2", "N s/m", 2.0, lambda x: Viscous(viscous_coefficient=x), False,
            "for instance another model: purely viscous, without the dry friction of Table I",
        ),
        Case(
            "coulomb-viscous", "sigma_2", "N s/m", 0.1, viscous, True,
            "with $mu_k$ of Table I, whose travel a viscous part can only shorten",
        ),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class StepTravel:
    """What the push in steps of 10 ms makes of a published travel, Table I kept."""

    row: str
    """Registry name of the row."""
    law: FrictionLaw | PrintedForm
    """What was run, with the values that were tried."""
    published: float
    """Printed travel [m]."""
    travel: float
    """Travel where sgn 0 = 0, so that friction misses the first step [m]."""
    static: float
    """Travel where it begins at the break-away level, as (5) has it [m]."""
    scatter: tuple[float, float] | None = None
    """Least and largest travel of runs that differ by rounding, where the motion is chaotic [m]."""

    @property
    def reached(self) -> bool:
        """Whether either rounds to the printed travel, or the printed one is inside the scatter."""
        if self.scatter is not None:
            return self.scatter[0] <= self.published <= self.scatter[1]
        gaps = (abs(travel - self.published) for travel in (self.travel, self.static))
        return min(gaps) <= ROUNDING


def step_travels(
    values: PaperValues,
    published: Mapping[str, float],
    creeps: Sequence["Creep"],
    *,
    t_end: float,
) -> tuple[StepTravel, ...]:
    """Push the block with each row in steps of the paper's 10 ms, by forward Euler.

    The paper states this sample time for its cart.
    """
    level = {"kinetic_coefficient": values.mu_k, "static_coefficient": values.mu_s}
    laws: dict[str, FrictionLaw] = {
        "coulomb": Coulomb(**level),
        "dahl": dahl_row(values, STEP_DAHL),
        "lugre": lugre_row(values, STEP_LUGRE),
        "coulomb-viscous": CoulombViscous(**level, viscous_coefficient=STEP_VISCOUS),
    }
    _, _, push = rigs(values.rig)["A"]

    def travel(law: FrictionLaw, break_away: BreakAway) -> float:
        solver = FixedStep(dt=CART_STEP, break_away=None if law.states else break_away)
        return float(simulate(push, law, t_end=t_end, solver=solver)["x"][-1])

    result = []
    for row, printed in published.items():
        scatter = None
        law: FrictionLaw | PrintedForm
        if row in laws:
            law = laws[row]
            zero, static = (travel(laws[row], rule) for rule in BREAK_AWAY_RULES)
        elif row == "stribeck" and creeps:
            creep = creeps[len(creeps) // 2]
            law, zero, static = creep.form, creep.mean, creep.mean
            scatter = min(creep.travels), max(creep.travels)
        else:
            continue
        result.append(
            StepTravel(
                row=row, law=law, published=printed, travel=zero, static=static, scatter=scatter
            )
        )
    return tuple(result)


CREEPING = (10.0e-3, 11.35e-3, 13.0e-3)
"""Stribeck velocities [m/s] around the one at which (5) in steps creeps to the printed travel."""
NEIGHBOURS = 15
"""Runs at each of them, whose Stribeck velocities differ by less than any measurement tells."""
NUDGE = 1e-9
"""Relative difference of these velocities."""


@dataclass(frozen=True, kw_only=True)
class Creep:
    """What (5) does in steps of 10 ms with the sgn that it lacks, its exponent as printed.

    Without a rule for rest the block steps across zero velocity and back. Backwards the exponent
    makes friction larger than the static level, so that each step back is followed by a larger one
    forwards: it creeps on, chaotically, so that the travel is known as a distribution only.
    """

    form: PrintedStribeck
    """(5) with the sgn that it lacks."""
    travels: tuple[float, ...]
    """Travel at the end [m] of runs whose Stribeck velocities differ by 1e-9 of themselves."""
    run: Trajectory
    """The first of these runs."""
    held: float
    """Travel with the rule for rest, in the same steps [m]."""
    fine: float
    """Travel without it, in a tenth of the step [m]."""

    @property
    def stribeck_velocity(self) -> float:
        """[m/s]."""
        return self.form.stribeck_velocity

    @property
    def mean(self) -> float:
        """Of the travels [m]."""
        return math.fsum(self.travels) / len(self.travels)

    @property
    def least_velocity(self) -> float:
        """Of the first run [m/s]."""
        return float(self.run["v"].min())


def stribeck_creeps(values: PaperValues, *, t_end: float) -> tuple[Creep, ...]:
    """Push the block with (5) as printed but for the missing sgn, in steps of 10 ms."""
    _, _, push = rigs(values.rig)["A"]

    def form(velocity: float) -> PrintedStribeck:
        return PrintedStribeck(
            kinetic_coefficient=values.mu_k,
            static_coefficient=values.mu_s,
            stribeck_velocity=velocity,
            signed=True,
        )

    def ran(velocity: float, dt: float, *, stick_rule: bool) -> Trajectory:
        solver = FixedStep(dt=dt, stick_rule=stick_rule)
        return simulate(push, form(velocity), t_end=t_end, solver=solver)

    result = []
    for velocity in CREEPING:
        runs = [
            ran(velocity * (1.0 + NUDGE * i), CART_STEP, stick_rule=False)
            for i in range(NEIGHBOURS)
        ]
        result.append(
            Creep(
                form=form(velocity),
                travels=tuple(float(run["x"][-1]) for run in runs),
                run=runs[0],
                held=float(ran(velocity, CART_STEP, stick_rule=True)["x"][-1]),
                fine=float(ran(velocity, 0.1 * CART_STEP, stick_rule=False)["x"][-1]),
            )
        )
    return tuple(result)


def dahl_row(values: PaperValues, sigma_0: float) -> Dahl:
    """Return Dahl friction with bristles of a stiffness [N/m], held at the first stop."""
    return Dahl.from_forces(
        load=values.load,
        kinetic_force=values.mu_k * values.load,
        bristle_stiffness=sigma_0,
        static_switch=True,
    )


def lugre_row(values: PaperValues, sigma_0: float) -> LuGre:
    """Return LuGre friction with the damping, viscosity and Stribeck velocity of LuGre 1995."""
    return LuGre.from_forces(
        load=values.load,
        kinetic_force=values.mu_k * values.load,
        static_force=values.mu_s * values.load,
        stribeck_velocity=1e-3,
        bristle_stiffness=sigma_0,
        bristle_damping=math.sqrt(sigma_0),
        viscous_coefficient=0.4,
    )


def _require(
    values: PaperValues,
    case: Case,
    reading: str,
    published: float,
    block: SpringBlock,
    t_end: float,
) -> Requirement:
    """Search for the value, and for those at the ends of the rounding range."""
    law, first = case.made, case.first

    def travel(value: float) -> float:
        return float(simulate(block, law(value), t_end=t_end).at(t_end)["x"][0])

    def root(target: float, start: float) -> float | None:
        least, most = start / REACH, start * REACH
        return positive_root(lambda value: travel(value) - target, start, least, most)

    best = root(published, first)
    sides = (-1.0, 1.0) if best is not None else ()
    ends = [root(published + side * ROUNDING, best or first) for side in sides]
    result = sorted(end for end in ends if end is not None)
    solution = None if best is None else law(best)
    run = None if solution is None else simulate(block, solution, t_end=t_end)
    return Requirement(
        law=case.law,
        reading=reading,
        published=published,
        symbol=case.symbol,
        unit=case.unit,
        value=best,
        low=result[0] if best is not None and result else None,
        high=result[-1] if best is not None and result else None,
        start=travel(first if best is not None else first / REACH),
        kept=case.kept,
        text=case.text,
        solution=solution,
        run=run,
        criteria=None if run is None else criteria_of(run, block, values.measured),
    )


@dataclass(frozen=True, kw_only=True)
class BristleRow:
    """One stiffness and what the block does with it."""

    law: str
    """Registry name."""
    stiffness: float
    """Of the bristles [N/m]."""
    held: bool
    """Whether the static switch holds the block at its first stop."""
    criteria: Criteria
    """The paper's criteria of that run."""


def bristle_rows(values: PaperValues, *, t_end: float) -> tuple[BristleRow, ...]:
    """Push the block with Dahl friction, held, and with LuGre friction, not held."""
    _, _, push = rigs(values.rig)["A"]
    rows: tuple[Callable[..., Dahl | LuGre], ...] = (dahl_row, lugre_row)
    laws = [(row(values, stiffness), stiffness) for row in rows for stiffness in STIFFNESSES]
    return tuple(
        BristleRow(
            law=law.name,
            stiffness=stiffness,
            held=law.static_switch,
            criteria=criteria_of(simulate(push, law, t_end=t_end), push, values.measured),
        )
        for law, stiffness in laws
    )


def positive_root(
    function: Callable[[float], float], start: float, low: float, high: float
) -> float | None:
    """Return the first root that is met outwards from a start, between two values above 0, or None.

    Of roots on both sides of the start, it is the nearer one by its ratio to that.

    Examples
    --------
    >>> round(positive_root(lambda x: x * x - 2.0, 1.0, 0.1, 10.0), 9)
    1.414213562
    """
    value = _value(function, start)
    if value == 0.0:
        return start
    sides = {STRIDE: (start, value), 1.0 / STRIDE: (start, value)}
    result: list[float] = []
    while sides and not result:
        for step, (before, f_before) in list(sides.items()):
            point = min(max(before * step, low), high)
            if point == before:
                del sides[step]
                continue
            f_point = _value(function, point)
            if f_before is not None and f_point is not None and _crosses(f_before, f_point):
                ends = sorted((before, point))
                result.append(
                    float(scipy.optimize.brentq(function, *ends, rtol=1e-10, xtol=1e-300))
                )
            sides[step] = (point, f_point)
    return min(result, key=lambda root: abs(math.log(root / start)), default=None)


def _crosses(before: float, after: float) -> bool:
    """Whether the sign changes, or 0 is reached; the product of tiny values would be 0."""
    return before < 0.0 <= after or after <= 0.0 < before


def _value(function: Callable[[float], float], point: float) -> float | None:
    try:
        return function(point)
    except SimulationError:
        return None


@dataclass(frozen=True, kw_only=True)
class Springback:
    """A stiff bristle law without the static switch, pushed and left to stop."""

    law: FrictionLaw
    """The bristle law."""
    criteria: Criteria
    """The paper's criteria of that run."""


def springbacks(values: PaperValues) -> tuple[Springback, ...]:
    """Push the block with Dahl and LuGre friction, as in Table II but with nothing to hold it."""
    held = dahl_row(values, STIFFNESS)
    laws = replace(held, static_switch=False), lugre_row(values, STIFFNESS)
    _, _, push = rigs(values.rig)["A"]
    return tuple(
        Springback(law=law, criteria=criteria_of(simulate(push, law, t_end=1.0), push))
        for law in laws
    )
