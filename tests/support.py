"""Random laws and rigs, made from the declarations of their parameters alone.

A law or a mechanism that is added to a registry is met by every test that draws from here.
"""

import contextlib
import dataclasses
import functools
import importlib.util
import inspect
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pandas as pd
import pytest
from benchmarks.several.brakes import ClutchTrain, DiscBrake, Lining, Rotor
from hypothesis import settings
from hypothesis import strategies as st

from stickslip import (
    Axis,
    BlockChain,
    Capsule,
    Measurement,
    Pendulum,
    PendulumCart,
    PIDAxis,
    SpringBlock,
    TowedBlock,
    TwoFeet,
    TwoLinkArm,
    TwoMassAxis,
    TwoMassCapsule,
    simulate,
)
from stickslip.engine.formulation import Model, formulate
from stickslip.engine.solver.backend import Equations
from stickslip.engine.solver.starts import gather
from stickslip.friction import LAWS, FrictionLaw, SetValuedLaw
from stickslip.mechanisms import (
    InnerMass,
    Link,
    Mechanism,
    Prescribed,
    Robot,
    RobotJoint,
    SerialArm,
    Torque,
    given_inputs,
    input_names,
)
from stickslip.mechanisms.drives import (
    PiecewiseLinear,
    Pulse,
    Ramp,
    Sine,
    SineSwing,
    Square,
    ThreePhase,
)
from stickslip.quantities import Quantity, fields_of, parameters
from stickslip.study.testing import ORDINARY

UNAIDED = {name: law for name, law in LAWS.items() if not law.inputs}
"""Laws that ask the contact for speed and load alone."""
RIGID = [law for law in UNAIDED.values() if not law.states]
"""Laws without bristles, the same in both directions or not."""
SET_VALUED = [law for law in UNAIDED.values() if issubclass(law, SetValuedLaw)]
BRISTLE = [law for law in UNAIDED.values() if law.states]

DECADES: Mapping[str, tuple[float, float]] = {
    "1": (-1.3, 0.0),
    "m/s": (-3.0, -1.0),
    "1/m": (2.0, 4.0),
    "s/m": (-2.0, 0.5),
    "N s/m": (-2.0, 0.5),
    "N s^2/m^2": (-2.0, 0.5),
    "1/s": (0.0, 2.0),
    "1/N": (-3.0, -1.0),
    "1/N^2": (-4.0, -2.0),
}
"""Powers of ten between which a parameter of a law is drawn, by unit: what rigs have."""

FIRST = ("coulomb", "viscous", "coulomb-viscous", "coulomb-viscous-static", "direction-dependent",
         "power-viscous", "quadratic-drag", "stribeck", "dahl", "lugre")  # fmt: skip
"""Laws that quick tests draw many runs of; those of the others are slow."""

BLOCK_RIG = """
[mechanism]
type = "spring-block"
mass = 1.0
stiffness = 100.0
compression = 0.1
[friction.coulomb]
kinetic_coefficient = 0.25
"""
"""A rig file of the least that can be simulated."""


def each_of(kinds: Iterable[type[FrictionLaw]]) -> list[Any]:
    """Return laws for `parametrize`, all but the first ones slow."""
    return [
        pytest.param(kind, id=kind.name, marks=[pytest.mark.slow] * (kind.name not in FIRST))
        for kind in kinds
    ]


SHAPES = st.sampled_from([1.0, 2.0, 0.7, 1.5])
"""Exponents: whole ones, which shape the equations, and others, which stand in them."""


def for_all(values: Iterable[Any]) -> Callable[[Callable[[Any], None]], Callable[[], None]]:
    """Run a test for each value and name all that fail: a rule of style is a single case.

    What pytest does around a case takes longer than such a check.
    """

    kept = [*values]
    assert kept

    def decorate(test: Callable[[Any], None]) -> Callable[[], None]:
        def check() -> None:
            faults = {}
            for value in kept:
                try:
                    test(value)
                except (Exception, pytest.fail.Exception) as error:
                    label = getattr(value, "__name__", None) or getattr(value, "name", None)
                    faults[str(label or value)] = error
            assert not faults, "\n".join(f"{label}: {error}" for label, error in faults.items())

        check.__name__, check.__doc__, check.__module__ = (
            test.__name__,
            test.__doc__,
            test.__module__,
        )
        return check

    return decorate


def exported(path: Any) -> Any:
    """Return the table of a CSV file that a command wrote, units left out of its headers."""
    return pd.read_csv(path).rename(columns=lambda name: name.partition(" [")[0])


def examples(count: int) -> settings:
    """Let hypothesis draw so many examples in `make slow`, and an eighth in quick tests."""
    thorough = settings.get_current_profile_name() == "thorough"
    return settings(max_examples=count if thorough else max(3, count // 8))


def quick(names: Iterable[str], *few: str) -> list[Any]:
    """Return names for `parametrize`, all but a few of them slow."""
    return [pytest.param(name, marks=[pytest.mark.slow] * (name not in few)) for name in names]


def pairs(laws: Mapping[str, Any], rigs: Mapping[str, Any], most: int = 5) -> Iterator[Any]:
    """Yield all pairs of a rig and a law for `parametrize`.

    All but every `most`-th are slow, but each law and each rig meets some.
    """
    nth = min(most, len(laws), len(rigs))
    for (i, name), (j, rig) in itertools.product(enumerate(laws), enumerate(rigs)):
        marks = [pytest.mark.slow] * ((i + j) % nth != 0)
        yield pytest.param(rigs[rig], laws[name], id=f"{name}-{rig}", marks=marks)


def decade(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers spread evenly over powers of ten."""
    return st.floats(low, high).map(lambda power: 10.0**power)


def _value(draw: st.DrawFn, quantity: Quantity, known: Mapping[str, float]) -> float:
    if quantity.structural:
        return draw(SHAPES.filter(lambda n: quantity.low <= n <= quantity.high))
    value = min(draw(decade(*DECADES[quantity.unit])), quantity.high)
    return value if quantity.at_least is None else known[quantity.at_least] + value


@st.composite
def laws(draw: st.DrawFn, kind: type[FrictionLaw], *, plain: bool = False) -> Any:
    """Draw a law of a kind; a `plain` one keeps the defaults of its shape."""
    values: dict[str, float] = {}
    for field in dataclasses.fields(kind):
        quantity = fields_of(kind).get(field.name)
        if quantity is not None and not (plain and quantity.structural):
            values[field.name] = _value(draw, quantity, values)
    return kind(**values)


def mirrored_law(law: FrictionLaw) -> FrictionLaw:
    """Return a law with its directions exchanged; most are the same in both."""
    names = {"forward": "backward", "backward": "forward"}
    changes = {}
    for field in dataclasses.fields(law):
        side, _, rest = field.name.partition("_")
        if side in names:
            changes[field.name] = getattr(law, f"{names[side]}_{rest}")
    return dataclasses.replace(law, **changes)


ROUNDED_ASIDE = ("direction-dependent", "power-viscous", "quadratic-drag")
"""Laws whose terms stand in another order in the equations of the other direction.

Their sums differ by a rounding, so that mirror images do not agree to the last bit.
"""


def mirrors(run: Any, image: Any, kind: type[FrictionLaw], *, sums: bool = False) -> bool:
    """Check a run against its mirror image; return whether both agree to the last bit.

    They need not where friction is one of three forces: their `sums` round by their order, which is
    another in the other direction. So do the sums of most laws but the `FIRST`, of 1 and a share of
    the level, say.
    """
    if kind.name in FIRST and kind.name not in ROUNDED_ASIDE and not sums:
        np.testing.assert_array_equal(image.t, run.t)
        for name in ("x", "v", "friction"):
            np.testing.assert_array_equal(image[name], -run[name])
        assert [event.reason for event in image.events] == [event.reason for event in run.events]
        return True
    assert image.status is run.status
    t = np.linspace(*run.span, 101)
    size = np.abs(run["x"]).max() + np.abs(run["v"]).max() * run.span[1]
    # a stop that is just missed or just met is reached as the square root of a rounding
    np.testing.assert_allclose(image.at(t)["x"], -run.at(t)["x"], rtol=0, atol=1e-6 * size)
    return False


def held_by(law: FrictionLaw, friction: Any, load: Any) -> Any:
    """Return the break-away level of the direction in which friction is overcome."""
    ahead, back = (law.towards(side).break_away(load) for side in (1, -1))
    return np.where(np.asarray(friction) > 0, ahead, back)


def example_of(kind: type[FrictionLaw]) -> Any:
    """Return one law of a kind with everyday parameters, of rare units those of its entry."""
    values: dict[str, float] = {}
    own = {} if kind.typical is None else kind.typical.values
    everyday = {
        "1": 0.25, "m/s": 0.01, "1/m": 1e3, "s/m": 0.5, "N s/m": 0.4, "N s^2/m^2": 0.2,
        "1/N": 0.1, "1/N^2": 0.05, "1/K": 0.01, "1/Pa": 1e-6, "1/s": 10.0,
    }  # fmt: skip
    for name, quantity in fields_of(kind).items():
        if quantity.structural:
            continue
        surplus = 0.0 if quantity.at_least is None else values[quantity.at_least] * 0.4
        value = everyday.get(quantity.unit, own.get(name))
        assert surplus or value, f"{kind.__name__}.{name}: `typical` of the entry has no value"
        values[name] = values[quantity.at_least] + surplus if surplus else value
    return kind(**values)


def informed(rig: Any, law: FrictionLaw | type[FrictionLaw]) -> Any:
    """Return a mechanism that tells a law all that it asks for, ordinary values where it cannot."""
    (contact,) = rig.contacts()
    lacking = set(law.inputs).difference(input_names(rig, contact.name))
    return given_inputs(rig, {name: ORDINARY[name] for name in sorted(lacking)})


def nearly(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers of everyday size: multiples of a millionth, so that no square underflows."""
    return st.integers(round(low * 1e6), round(high * 1e6)).map(lambda whole: whole * 1e-6)


pulses = st.builds(Pulse, level=nearly(-20, 20), duration=nearly(0.01, 0.5), start=nearly(0, 0.5))
broken_lines = st.lists(nearly(-20, 20), min_size=2, max_size=5).map(
    lambda values: PiecewiseLinear(times=[0.2 * i for i in range(len(values))], values=values)
)
squares = st.builds(
    Square, high=nearly(-20, 20), low=nearly(-20, 20), period=nearly(0.1, 0.9), duty=nearly(0, 1),
    start=nearly(-0.5, 0.5),
)  # fmt: skip
inclines = st.just(0.0) | nearly(-0.6, 0.6)
drives = st.one_of(
    pulses, broken_lines, squares, st.builds(lambda a, b: a + b, pulses, broken_lines)
)

spring_blocks = st.builds(
    SpringBlock,
    mass=decade(-1, 1),
    stiffness=decade(1, 3),
    compression=nearly(-0.2, 0.2),
    attached=st.booleans(),
    drive=st.none() | drives,
    incline=inclines,
)
towed_blocks = st.builds(
    TowedBlock,
    mass=decade(-1, 1),
    stiffness=decade(0, 2),
    speed=nearly(-0.5, 0.5),
    damping=st.just(0.0) | nearly(0, 2),
)
axes = st.builds(
    Axis,
    inertia=decade(-1, 1),
    drive=st.none() | drives,
    stiffness=st.just(0.0) | decade(0, 2),
    damping=st.just(0.0) | nearly(0, 2),
    load=decade(0, 1.5),
    offset=st.just(0.0) | nearly(-1, 1),
)
two_mass_axes = st.builds(
    TwoMassAxis,
    motor_inertia=decade(-1, 1),
    load_inertia=decade(-1, 1),
    stiffness=decade(1, 3),
    damping=st.just(0.0) | nearly(0, 2),
    drive=st.none() | drives,
    rubs=st.sampled_from(["load", "motor"]),
    load=decade(0, 1.5),
    offset=st.just(0.0) | nearly(-1, 1),
)
pid_axes = st.builds(
    PIDAxis,
    inertia=decade(-1, 1),
    proportional=decade(0, 2),
    integral=decade(0, 2),
    derivative=st.just(0.0) | nearly(0, 2),
    reference=nearly(-1, 1),
    drive=st.none() | drives,
    load=decade(0, 1.5),
)
swings = st.builds(
    ThreePhase, amplitude=nearly(0.1, 1.0), fast=decade(1, 2), slow=decade(0, 1),
    first=st.sampled_from(["fast", "slow"]),
) | st.builds(SineSwing, amplitude=nearly(0.1, 1.0), frequency=decade(-1, 0.3))  # fmt: skip
motors = st.builds(Prescribed, profile=swings) | st.builds(Torque, drive=st.none() | drives)
pendulums = st.builds(
    Pendulum,
    mass=decade(-1, 1),
    length=decade(-1, 0),
    inertia=st.just(0.0) | decade(-2, 0),
    drive=st.none() | drives,
    damping=st.just(0.0) | nearly(0, 2),
)
pendulum_carts = st.builds(
    PendulumCart,
    cart_mass=decade(-1, 1),
    ball_mass=decade(-1, 1),
    length=decade(-1, 0),
    pendulum=motors,
    wheelbase=st.none() | decade(-1, 0),
    incline=inclines,
    pivot_stiffness=st.just(0.0) | decade(-1, 1),
    pivot_angle=st.just(0.0) | nearly(-0.5, 0.5),
    pivot_damping=st.just(0.0) | nearly(0, 0.2),
)
capsules = st.builds(
    Capsule,
    capsule_mass=decade(-1, 1),
    inner_mass=decade(-1, 1),
    drive=motors,
    stiffness=st.just(0.0) | decade(0, 2),
    damping=st.just(0.0) | nearly(0, 2),
    incline=inclines,
)
inner_masses = st.builds(
    InnerMass,
    mass=decade(-1, 0),
    angle=st.just(0.0) | nearly(-1.0, 1.0),
    drive=motors,
    stiffness=st.just(0.0) | decade(0, 2),
    damping=st.just(0.0) | nearly(0, 2),
)
two_mass_capsules = st.builds(
    TwoMassCapsule,
    capsule_mass=decade(-1, 1),
    first=inner_masses,
    second=inner_masses,
    incline=inclines,
)
block_chains = st.builds(
    BlockChain,
    blocks=st.integers(1, 4),
    mass=decade(-1, 1),
    coupling=decade(0, 2),
    stiffness=st.just(0.0) | decade(0, 2),
    damping=st.just(0.0) | nearly(0, 2),
    speed=st.none() | nearly(-0.5, 0.5),
)
linings = st.builds(
    Lining, radius=decade(-1, 0), load=st.just(0.0) | decade(0, 2), press=st.none() | drives
)
rotors = st.builds(Rotor, inertia=decade(-1, 1), torque=st.none() | drives)
clutch_trains = st.integers(2, 4).flatmap(
    lambda n: st.builds(
        ClutchTrain,
        rotors=st.lists(rotors, min_size=n, max_size=n),
        clutches=st.lists(linings, min_size=n - 1, max_size=n - 1),
        brake=st.none() | linings,
    )
)
disc_brakes = st.builds(
    DiscBrake,
    inertia=decade(-1, 1),
    pads=st.lists(linings, min_size=1, max_size=3),
    stiffness=st.just(0.0) | decade(0, 2),
    drive=st.none() | drives,
)
two_feet = st.builds(
    TwoFeet,
    mass=decade(-1, 1),
    front=decade(-1, 0),
    rear=decade(-1, 0),
    height=nearly(0, 0.1),
    stiffness=st.just(0.0) | decade(0, 2),
    drive=st.none() | drives,
)
two_link_arms = st.builds(
    TwoLinkArm,
    upper_mass=decade(-1, 1),
    upper_length=decade(-1, 0),
    upper_centre=nearly(0.0, 0.5),
    upper_inertia=decade(-2, 0),
    lower_mass=st.just(0.5),
    lower_centre=nearly(0.0, 0.3),
    lower_inertia=nearly(0.05, 0.5),
    rotor_inertia=st.just(0.0) | decade(-5, -3),
    gear_ratio=decade(0, 1.5),
    shoulder_drive=st.none() | drives,
    elbow_drive=st.none() | drives,
)
links = st.builds(
    Link,
    mass=st.just(0.5),
    length=decade(-1, 0),
    centre=nearly(0.0, 0.3),
    inertia=nearly(0.05, 0.5),  # no less than mass times the square of the centre
    rotor_inertia=st.just(0.0) | decade(-5, -3),
    gear_ratio=decade(0, 1.5),
    damping=st.just(0.0) | nearly(0, 0.2),
    torque=st.none() | drives,
)
serial_arms = st.builds(SerialArm, links=st.lists(links, min_size=1, max_size=3))
robots = st.builds(
    lambda mass, inertia, effort: Robot(
        joints=(
            RobotJoint(joint="swing", axis=(0, 1, 0), mass=mass, centre_x=0.1, inertia_yy=1.3),
            RobotJoint(
                joint="slide", kind="prismatic", parent="swing", place=(0.2, 0.0, 0.1), mass=mass,
                axis=(1, 0, 1), inertia_zz=inertia, effort=effort,
            ),
        )
    ),
    mass=decade(-1, 0.5),
    inertia=nearly(0.1, 0.9),
    effort=st.none() | drives,
)  # fmt: skip
SLIDERS: Mapping[str, st.SearchStrategy[Any]] = {
    "spring-block": spring_blocks,
    "towed-block": towed_blocks,
    "axis": axes,
    "two-mass-axis": two_mass_axes,
}
"""Random mechanisms of lengths and forces alone that stay on the ground, by registry name."""
RIGS: Mapping[str, st.SearchStrategy[Any]] = {
    **SLIDERS,
    "pid-axis": pid_axes,
    "pendulum": pendulums,
    "pendulum-cart": pendulum_carts,
    "capsule": capsules,
    "two-mass-capsule": two_mass_capsules,
    "block-chain": block_chains,
    "clutch-train": clutch_trains,
    "disc-brake": disc_brakes,
    "two-feet": two_feet,
    "two-link-arm": two_link_arms,
    "serial-arm": serial_arms,
    "robot": robots,
}
"""Random mechanisms by registry name."""

SWING = ThreePhase(amplitude=0.7, fast=40.0, slow=20.0)
PUSHES = PiecewiseLinear(times=(0.0, 0.4, 0.5, 0.9), values=(0.1, 0.1, -0.1, -0.1))
EXAMPLES: Mapping[str, Mechanism] = {
    "spring-block": SpringBlock(mass=1.0, stiffness=100.0, compression=0.1),
    "towed-block": TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0),
    "axis": Axis(inertia=2.0, drive=Pulse(level=5.0, duration=1.0), stiffness=3.0, damping=0.2),
    "two-mass-axis": TwoMassAxis(
        motor_inertia=0.5, load_inertia=1.5, stiffness=200.0, damping=0.5,
        drive=Pulse(level=5.0, duration=0.7),
    ),
    "pid-axis": PIDAxis(
        inertia=1.0, proportional=100.0, integral=300.0, derivative=20.0, reference=0.1,
        drive=Pulse(level=5.0, duration=0.7),
    ),
    "pendulum": Pendulum(
        mass=0.5, length=0.6, inertia=0.02, damping=0.01, drive=Sine(amplitude=2.0, frequency=0.7)
    ),
    "pendulum-cart": PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Torque(drive=PUSHES)
    ),
    "capsule": Capsule(
        capsule_mass=0.8, inner_mass=0.2, drive=Torque(drive=Sine(amplitude=5.0, frequency=1.5)),
        stiffness=40.0, damping=0.2,
    ),
    "two-mass-capsule": TwoMassCapsule(
        capsule_mass=0.6,
        first=InnerMass(
            mass=0.2, stiffness=40.0, damping=0.2,
            drive=Torque(drive=Sine(amplitude=5.0, frequency=1.5)),
        ),
        second=InnerMass(
            mass=0.1, angle=0.8, stiffness=30.0, damping=0.2,
            drive=Torque(drive=Sine(amplitude=1.0, frequency=1.5, phase=1.0)),
        ),
    ),
}  # fmt: skip
"""One of each mechanism with one contact by registry name."""
SHOWN: Mapping[str, Mechanism] = {
    **EXAMPLES,
    "two-link-arm": TwoLinkArm(
        upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
        lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03, rotor_inertia=6e-5, gear_ratio=6.0,
        shoulder_drive=Sine(amplitude=1.0, frequency=0.7),
        elbow_drive=Pulse(level=0.5, duration=0.7),
    ),
    "two-mass-axis, motor rubs": dataclasses.replace(EXAMPLES["two-mass-axis"], rubs="motor"),
    "capsule, square": Capsule(
        capsule_mass=0.8, inner_mass=0.2, stiffness=40.0, damping=0.2, incline=0.05,
        drive=Torque(drive=Square(high=4.0, low=-1.0, period=0.3, duty=0.3)),
    ),
    "pendulum-cart, prescribed": PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=SWING),
        wheelbase=0.4,
    ),
    "pendulum-cart, spring at the pivot": PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Torque(drive=PUSHES),
        pivot_stiffness=0.8, pivot_angle=0.1, pivot_damping=0.01, incline=-0.1,
    ),
    "capsule, prescribed": Capsule(
        capsule_mass=0.8, inner_mass=0.2,
        drive=Prescribed(profile=ThreePhase(amplitude=0.01, fast=50.0, slow=9.0, first="slow")),
    ),
    "capsule, stops": Capsule(
        capsule_mass=0.8, inner_mass=0.2, drive=Torque(drive=Sine(amplitude=0.6, frequency=1.5)),
        stiffness=20.0, damping=0.2, lower_stop=-0.05, upper_stop=0.04, restitution=0.8,
    ),
    "spring-block, uphill": SpringBlock(
        mass=1.0, stiffness=100.0, compression=0.12, attached=True, incline=0.3
    ),
}  # fmt: skip
"""One of each mechanism, and others where a mechanism has several ways of being driven."""


SEVERAL: Mapping[str, Mechanism] = {
    "two-mass-axis": dataclasses.replace(EXAMPLES["two-mass-axis"], rubs="both"),
    "block-chain": BlockChain(blocks=2, mass=1.0, coupling=4.0, stiffness=1.0, speed=0.1),
    "block-chain, one": BlockChain(blocks=1, mass=1.0, coupling=4.0, stiffness=1.0, damping=0.1),
    "clutch-train": ClutchTrain(
        rotors=(Rotor(inertia=1.0, torque=Sine(amplitude=8.0, frequency=1.0)),
                Rotor(inertia=0.5, damping=0.1)),
        clutches=(Lining(radius=0.2, press=Pulse(level=20.0, duration=10.0, start=0.4)),),
        brake=Lining(radius=0.1, load=10.0),
    ),
    "disc-brake": DiscBrake(
        inertia=0.5, drive=Ramp(rate=1.0), stiffness=2.0, damping=0.1,
        pads=(Lining(radius=0.1, load=10.0), Lining(radius=0.12, press=Sine(amplitude=9.0,
                                                                            frequency=1.0))),
    ),
    "disc-brake, one": DiscBrake(inertia=0.5, pads=(Lining(radius=0.1, load=10.0),)),
    "two-feet": TwoFeet(
        mass=2.0, front=0.3, rear=0.2, height=0.15, stiffness=50.0,
        drive=Sine(amplitude=9.0, frequency=1.0),
    ),
    "pendulum-cart": PendulumCart(
        cart_mass=0.5, ball_mass=0.2, length=0.3, pivot_load=1.0,
        pendulum=Torque(drive=Sine(amplitude=0.3, frequency=1.0)),
    ),
    "serial-arm": SerialArm(
        links=(Link(mass=0.6, length=0.3, centre=0.15, inertia=0.02, damping=0.01),
               Link(mass=0.5, length=0.2, centre=0.1, inertia=0.01, rotor_inertia=1e-5,
                    gear_ratio=9.0, torque=Sine(amplitude=0.5, frequency=1.0)),
               Link(mass=0.2, length=0.1, centre=0.05, inertia=0.001, rotor_inertia=1e-5,
                    gear_ratio=5.0)),
    ),
    "robot": Robot(
        joints=(RobotJoint(joint="turret", mass=1.2, centre_x=0.01, inertia_zz=0.02,
                           effort=Sine(amplitude=1.0, frequency=1.0)),
                RobotJoint(joint="reach", kind="prismatic", parent="turret", axis=(1, 0, 0.5),
                           place=(0.1, 0.02, 0.3), mass=0.8, damping=0.5, centre_x=0.2,
                           inertia_yy=0.05, inertia_zz=0.05, inertia_xz=0.002),
                RobotJoint(joint="wrist", parent="reach", axis=(0.2, 1, 0), armature=0.01,
                           place=(0.3, 0.0, 0.0), mass=0.4, centre_z=-0.06, inertia_xx=0.003,
                           inertia_yy=0.003, inertia_zz=0.001)),
    ),
}  # fmt: skip
"""Mechanisms with several contacts, or with one that slips by a factor."""


class Generated:
    """The equations of a mechanism with a law, called with plain numbers."""

    def __init__(self, mechanism: Mechanism, law: FrictionLaw, model: Model | None = None) -> None:
        model = formulate(mechanism, law) if model is None else model
        self.equations = Equations(model, gather(mechanism, law, model, 0.0))
        self.sizes = model.sizes

    def flags(self, y: list[float], t: float = 0.0) -> int:
        """Return the switches that the state asks for."""
        return self.equations.flags(t, y)

    def moving(
        self, name: str, mode: int, y: list[float], *, t: float = 0.0, flags: int | None = None
    ) -> list[float]:
        """Call a function of one mode, with the switches of the state unless told otherwise."""
        return self.equations(name, mode, self.flags(y, t) if flags is None else flags, t, y)

    def energy(self, y: list[float], *, t: float = 0.0, flags: int | None = None) -> float:
        """Return the mechanical energy [J]."""
        return self.moving("energy", 0, y, t=t, flags=flags)[0]


def values_of(root: Any) -> dict[str, float]:
    """Return the parameters of an object by path."""
    return {path: value for path, _, value in parameters(root, "it")}


EMPTY_FIGURE = b'<svg xmlns="http://www.w3.org/2000/svg"><title> </title></svg>'


@contextlib.contextmanager
def wide_only() -> Iterator[None]:
    """Leave out the figures of pages for narrow screens, a third of what pages take.

    Animations have one picture a second.
    """
    from stickslip.show.plots import svg

    drawn = inspect.unwrap(svg._drawn)

    @functools.wraps(drawn)
    def wide(draw: Any, size: Any, narrow: bool, *style: Any, **more: Any) -> bytes:
        return EMPTY_FIGURE if narrow else drawn(draw, size, narrow, *style, **more)

    with pytest.MonkeyPatch.context() as patch:
        for module in ("show.report.runs", "paper.pages"):
            patch.setattr(f"stickslip.{module}.ANIMATED", 1.0)
        patch.setattr(svg, "_drawn", wide)
        yield


@contextlib.contextmanager
def sketched() -> Iterator[None]:
    """Draw figures of pages, for wide screens, but lay out and write none: most of what they take.

    The functions that draw are called, and pages have empty figures. Animations have one picture a
    second.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    from stickslip.show.plots import svg, theme

    drawn = inspect.unwrap(svg._drawn)

    @functools.wraps(drawn)
    def sketch(draw: Any, size: Any, narrow: bool, *style: Any, **more: Any) -> bytes:
        if style or more:  # a file of its own
            return drawn(draw, size, narrow, *style, **more)
        if not narrow:
            with theme.house_style(), pytest.MonkeyPatch.context() as still:
                figure = Figure(figsize=(size[0] / 72, size[1] / 72), dpi=72, layout="constrained")
                FigureCanvasSVG(figure)
                still.setattr(figure.get_layout_engine(), "execute", lambda _: None)
                draw(figure, narrow)
        return EMPTY_FIGURE

    with pytest.MonkeyPatch.context() as patch:
        for module in ("show.report.runs", "paper.pages"):
            patch.setattr(f"stickslip.{module}.ANIMATED", 1.0)
        patch.setattr(svg, "_drawn", sketch)
        yield


def module_at(path: Path) -> ModuleType:
    """Return the module of a file that no package contains."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def rounded_travels(
    rig: SpringBlock, law: FrictionLaw, compressions: Sequence[float], digits: int
) -> Measurement:
    """Return travels of a law, rounded as a ruler would, for compressions of the spring."""
    readings = []
    for compression in compressions:
        released = dataclasses.replace(rig, compression=compression)
        travel = float(simulate(released, law, t_end=10.0).at(10.0)["x"][0])
        readings.append(
            Measurement(
                travel=round(travel, digits),
                uncertainty=0.5 * 10.0**-digits,
                uncertainty_kind="rounding",
                overrides={"mechanism.compression": compression},
                name=f"{compression:g}",
            )
        )
    return Measurement(trials=tuple(readings))


def acting(verdict: Any, velocity: Any, *at: Any) -> Any:
    """Return friction of the named law of a verdict at velocities (n,), with its offset."""
    judgement = verdict.judgement
    return judgement.acting(judgement.problem.at(velocity, *at))
