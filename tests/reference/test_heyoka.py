"""Every law with every mechanism against Taylor series, whose modes are driven by hand."""

import dataclasses
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from tests.mechanisms.test_pendulum_cart import cart_with
from tests.support import EXAMPLES, FIRST, UNAIDED, each_of, example_of

from stickslip import Axis, Coulomb, EventDriven, LuGre, SpringBlock, TowedBlock, simulate
from stickslip.engine import Trajectory
from stickslip.friction import FrictionLaw, SetValuedLaw
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse, Sine
from stickslip.quantities import fields_of, parameters, vary

pytest.importorskip("heyoka", reason="heyoka is there for Linux only")
from tests.reference.heyoka_oracle import Oracle

SOLVER = EventDriven(tolerance=1e-12, stiff_tolerance=1e-10)
"""The defaults, but a hundredth of the one with bristles, for which 2000 steps are enough."""

SHAKE = 1e-9
"""Share by which every number is changed to see how well it determines a run."""

ALLOWED = 10.0
"""Errors over the tolerance of a step times the condition of the run.

Local errors of some hundred steps, most of them far below their tolerance, add up to this.
"""

ALLOWED_IN_LAYERS = 300.0
"""The same for laws without states that bend within a speed of their own.

Where such a layer begins at rounding and fades in by many orders within one step of DOP853, that
step errs by more than its estimate (by three tolerances for tanh and Stribeck on a towed block),
and its friction by what the layer is steeper. Errors of cases above `ALLOWED` fall with the
tolerance: at 1e-10, 1e-11, 1e-12 and 1e-13 that block's are 58, 11, 215 and 32 times it, and
Simscape's 55, 27, 191 and 61 times.
"""

LOOKS = 199
"""Times at which states are compared; none of them an edge of a drive."""


@dataclass(frozen=True, kw_only=True)
class Setup:
    """A mechanism, where it starts from, and for how long."""

    mechanism: Mechanism
    y0: Mapping[str, float] = dataclasses.field(default_factory=dict)
    t_end: float = 2.0


SETUPS: Mapping[str, Sequence[Setup]] = {
    "spring-block": [
        Setup(mechanism=EXAMPLES["spring-block"], t_end=1.0),
        Setup(
            mechanism=SpringBlock(mass=1.0, stiffness=100.0, compression=0.2, attached=True),
            y0={"x": 0.02, "v": -0.3},
            t_end=1.5,
        ),
        Setup(mechanism=SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))),
        Setup(  # pushed against the spring, which lies ahead of it, and thrown back
            mechanism=SpringBlock(
                mass=2.0,
                stiffness=300.0,
                compression=-0.05,
                drive=PiecewiseLinear(times=(0.0, 0.2, 0.6, 1.0), values=(0.0, 25.0, -30.0, 9.0)),
            ),
            y0={"x": -0.2, "v": 1.0},
            t_end=1.2,
        ),
    ],
    # the pendulum falls: later it lifts the cart off
    "pendulum-cart": [Setup(mechanism=EXAMPLES["pendulum-cart"], y0={"theta": 0.3}, t_end=0.8)],
    "capsule": [Setup(mechanism=EXAMPLES["capsule"], t_end=1.0)],
    "towed-block": [
        Setup(mechanism=EXAMPLES["towed-block"], t_end=12.0),
        Setup(  # sticks and slips again and again
            mechanism=TowedBlock(mass=1.0, stiffness=200.0, speed=0.05, load=4.0)
        ),
        Setup(
            mechanism=TowedBlock(mass=0.5, stiffness=40.0, speed=0.3, damping=0.4),
            y0={"v": 0.5},
            t_end=3.0,
        ),
        Setup(
            mechanism=TowedBlock(mass=2.0, stiffness=15.0, speed=-0.2, load=5.0),
            y0={"x": 0.3, "v": 0.4},
            t_end=3.0,
        ),
    ],
    "axis": [
        Setup(mechanism=EXAMPLES["axis"], t_end=3.0),
        Setup(
            mechanism=Axis(
                inertia=0.5,
                stiffness=20.0,
                drive=Sine(amplitude=3.0, frequency=1.0, phase=0.3),
                load=4.0,
            ),
            t_end=3.0,
        ),
        Setup(
            mechanism=Axis(
                inertia=1.0,
                damping=0.3,
                offset=0.1,
                load=2.0,
                drive=PiecewiseLinear(times=(0.0, 1.0, 2.0, 3.0), values=(0.0, 2.0, -2.0, 1.0)),
            ),
            t_end=4.0,
        ),
        Setup(
            mechanism=Axis(
                inertia=0.2,
                stiffness=5.0,
                drive=Sine(amplitude=1.0, frequency=2.0)
                + Pulse(level=2.0, duration=0.7, start=0.4),
                load=3.0,
            ),
            y0={"x": 0.1, "v": 0.6},
            t_end=1.9,
        ),
    ],
}
"""Setups by the name of their mechanism; of any other its example is run."""


TRACED = [kind for kind in UNAIDED.values() if kind.name != "gms"]
"""Laws that the oracle follows: it has no latched switches."""


def variants(kind: type[FrictionLaw]) -> Iterator[FrictionLaw]:
    """Yield a law with everyday parameters, with others, and in each of its other shapes."""
    law = example_of(kind)
    yield law
    yield vary(law, "law", {path: 0.6 * value for path, _, value in parameters(law, "law")})
    for field in dataclasses.fields(kind):
        quantity = fields_of(kind).get(field.name)
        if quantity is not None and quantity.structural:
            other = 1.0 if field.default == 2.0 else 2.0
            if quantity.low <= other <= quantity.high:
                yield dataclasses.replace(law, **{field.name: other})
        elif quantity is not None and field.default is None:
            yield dataclasses.replace(law, **{field.name: None})
    if kind.states:
        yield dataclasses.replace(law, static_switch=True)


def bent() -> Iterator[Any]:
    """Yield each law that has an exponent with one that is no whole number."""
    for kind in TRACED:
        for name, quantity in fields_of(kind).items():
            if quantity.structural:
                value = min(1.5, 0.8 * quantity.high)
                law = dataclasses.replace(example_of(kind), **{name: value})
                slow = [pytest.mark.slow] * (kind.name not in FIRST)
                yield pytest.param(law, id=f"{kind.name}-{name}", marks=slow)


def cases() -> Iterator[Any]:
    """Yield every law in every setup, and every variant of a law in one setup of each mechanism.

    All but every eighth are slow, others for the next law and the next mechanism.
    """
    for i, name in enumerate(EXAMPLES):
        setups = SETUPS.get(name) or [Setup(mechanism=EXAMPLES[name])]
        for j, kind in enumerate(TRACED):
            first, *others = variants(kind)
            pairs = [(setup, first) for setup in setups]
            pairs += [(setups[i % len(setups)], law) for i, law in enumerate(others, start=1)]
            for count, (setup, law) in enumerate(pairs, start=1):
                marks = [pytest.mark.slow] * (kind.name not in FIRST or (i + j + count) % 8 != 0)
                yield pytest.param(setup, law, id=f"{name}, {kind.name}, {count}", marks=marks)


def transitions(events: Sequence[Any]) -> list[tuple[int, int, str]]:
    return [(event.from_mode, event.to_mode, event.reason) for event in events]


def holds(law: FrictionLaw) -> bool:
    return any(law.towards(side).break_away(1.0) > 0.0 for side in (1, -1))


def determined(events: Sequence[Any], law: FrictionLaw) -> list[Any]:
    """Return the events that the equations determine.

    A law without a level at rest stops no body. One that creeps to rest does so without end, until
    errors of steps take its speed through zero: for arctan 1.01, 0.62 or 0.97 s after the start at
    a tolerance of 1e-12, 1e-10 or 1e-8, and with other laws or tolerances not within the run.
    """
    return [event for event in events if event.to_mode != 0 or holds(law)]


@dataclass(frozen=True)
class Reference:
    """A run of the oracle, and how much of it a share of its numbers moves."""

    times: Any
    rows: Any
    """Columns of the run at these times."""
    moved: Any
    """Largest change of each column over the share, or the size of the column if that is more."""
    events: Sequence[Any]
    late: Any
    """The same of the times of the events."""


def shaken(root: Any, dice: random.Random) -> Any:
    """Return a law or a mechanism with every number changed by a small share."""
    shares = {path: SHAKE * dice.choice((-1, 1)) for path, _, _ in parameters(root, "it")}
    values = {path: value for path, _, value in parameters(root, "it")}
    return vary(root, "it", {path: value * (1.0 + shares[path]) for path, value in values.items()})


def start_of(setup: Setup, law: FrictionLaw) -> list[float]:
    bristles = law.states if law.states else ()
    names = (*setup.mechanism.coordinates, *setup.mechanism.rates, *bristles)
    return [setup.y0.get(name, 0.0) for name in names]


def reference(setup: Setup, law: FrictionLaw) -> Reference:
    """Run the oracle, and again with all numbers shaken."""
    y0, t_end = start_of(setup, law), setup.t_end
    times = [t_end * (i + 0.6180339887) / (LOOKS + 1) for i in range(LOOKS)]
    path = Oracle(setup.mechanism, law).run(y0, times, t_end)
    events = determined(path.events, law)
    rows, at = np.array(path.rows), np.array([event.t for event in events])
    size = np.abs(rows).max(axis=0)
    moved, late = size.copy(), at.copy()
    for seed in range(2):
        dice = random.Random(seed)
        start = [value * (1.0 + SHAKE * dice.choice((-1, 1))) for value in y0]
        other = Oracle(shaken(setup.mechanism, dice), shaken(law, dice)).run(start, times, t_end)
        others = determined(other.events, law)
        assert transitions(others) == transitions(events), "a case on an edge"
        moved = np.maximum(moved, np.abs(np.array(other.rows) - rows).max(axis=0) / SHAKE)
        late = np.maximum(late, np.abs(at - [event.t for event in others]) / SHAKE)
    # the solver judges errors against the largest speed, however slowly zero is crossed
    speed = size[Oracle(setup.mechanism, law).model.slip]
    late += np.array([speed / event.slope for event in events])
    return Reference(times, rows, moved, events, late)


def excess(run: Trajectory, law: FrictionLaw, expected: Reference) -> dict[str, float]:
    """Return errors of events and columns over what a share of 1 of all numbers would change."""
    events = determined(run.events, law)
    assert transitions(events) == transitions(expected.events)
    tiny = np.finfo(float).tiny  # where nothing moves there must be no error
    pairs = zip(events, expected.events, strict=True)
    late = np.array([ours.t - theirs.t for ours, theirs in pairs])
    fine = run.at(expected.times)
    off = {
        name: np.abs(fine[name] - expected.rows[:, i]).max() / (expected.moved[i] + tiny)
        for i, name in enumerate(fine.names)
        if name != "mode" or holds(law)  # what creeps to rest is compared by its speed
    }
    return off | {"events": (np.abs(late) / (expected.late + tiny)).max(initial=0.0)}


def limit(law: FrictionLaw) -> float:
    """Return what `excess` may be."""
    if law.states:
        return ALLOWED * SOLVER.stiff_tolerance
    speeds = [quantity for quantity in fields_of(type(law)).values() if quantity is not None]
    layered = any(quantity.scale == "speed" for quantity in speeds)
    return (ALLOWED_IN_LAYERS if layered else ALLOWED) * SOLVER.tolerance


def agrees(setup: Setup, law: FrictionLaw) -> None:
    run = simulate(setup.mechanism, law, t_end=setup.t_end, y0=setup.y0, solver=SOLVER)
    errors = excess(run, law, reference(setup, law))
    assert max(errors.values()) <= limit(law), errors


@pytest.mark.slow
@pytest.mark.parametrize(("setup", "law"), list(cases())[::3])
def test_a_run_agrees_with_taylor_series(setup, law):
    agrees(setup, law)


@pytest.mark.parametrize("law", list(bent()))
def test_a_run_without_a_stop_agrees_whatever_the_exponent(law):
    # at v = 0 a fractional power has no Taylor series; here 0 < v, in and out of the layer of 0.1
    block = TowedBlock(mass=1.0, stiffness=50.0, speed=0.1, load=1.0)
    agrees(Setup(mechanism=block, y0={"x": -0.005, "v": 0.15}), law)


@pytest.mark.parametrize("kind", [Coulomb, LuGre])
def test_a_mechanism_of_two_coordinates_agrees(kind):
    cart = cart_with(cart_mass=1.0, ball_mass=0.4, length=0.5, torque=0.3)
    agrees(Setup(mechanism=cart, y0={"theta": 0.3}, t_end=1.0), example_of(kind))


@pytest.mark.parametrize("kind", each_of(TRACED))
def test_a_wrong_digit_would_be_noticed(kind):
    setup, law = SETUPS["axis"][1], example_of(kind)
    path, _, value = next(parameters(law, "law"))
    wrong = vary(law, "law", {path: value * (1.0 + 1e-6)})
    run = simulate(setup.mechanism, wrong, t_end=setup.t_end, y0=setup.y0, solver=SOLVER)
    assert max(excess(run, law, reference(setup, law)).values()) > 2.0 * limit(law)


@pytest.mark.slow
def test_the_cases_meet_every_kind_of_event():
    every = {"stop", "reversal", "break-away", "spring touches", "block leaves the spring"}
    met = set()
    for setup, law in (case.values for case in cases() if isinstance(case.values[1], SetValuedLaw)):
        path = Oracle(setup.mechanism, law).run(start_of(setup, law), [], setup.t_end)
        met |= {event.reason for event in path.events}
        if met >= every:
            break
    assert met == every


@pytest.mark.parametrize(
    ("setup", "law"),
    [
        pytest.param(
            Setup(
                mechanism=Axis(
                    inertia=1.0,
                    drive=Pulse(level=1.0, duration=1.0, start=1.0)
                    + PiecewiseLinear(times=(0.0, 1.0, 2.0), values=(0.9, 0.9, 0.0)),
                ),
                t_end=3.0,
            ),
            Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5),
            id="jump that fades",
        ),
        pytest.param(
            Setup(mechanism=EXAMPLES["spring-block"], t_end=0.4823),
            Coulomb(kinetic_coefficient=0.25),
            id="stop just before the end",
        ),
    ],
)
def test_a_run_that_was_once_wrong_agrees(setup, law):
    agrees(setup, law)
