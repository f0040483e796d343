"""``python -m benchmarks.one_engine``: mechanisms with one contact on the kernels of several.

`Laws` of one contact choose these. Last states and processor times are compared with
those of the equations of each mode, which mechanisms with one contact have.
"""

import time
from collections.abc import Iterator

import numpy as np

from benchmarks import belt, decay, lugre, sampled
from benchmarks.kernel import Kernel
from benchmarks.measuring import Section, mean_time
from benchmarks.tables import section
from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    CoulombViscous,
    Dahl,
    LuGre,
    PendulumCart,
    SpringBlock,
    Stribeck,
    TowedBlock,
    TwoMassAxis,
)
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism, Prescribed, Torque
from stickslip.mechanisms.drives import Pulse, Sine, Square, ThreePhase

SAMPLES, RUNS = 1000, 25
TIGHT, USUAL = 1e-12, 1e-9
"""Tolerances at which states and times are compared."""
COULOMB = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
VISCOUS = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.4)
STRIBECK = Stribeck(kinetic_coefficient=0.25, static_coefficient=0.35, stribeck_velocity=0.01)
DAHL = Dahl(kinetic_coefficient=0.25, bristle_stiffness=1e4)
BRISTLES = LuGre(
    kinetic_coefficient=1.0, static_coefficient=1.5, stribeck_velocity=0.1, bristle_stiffness=10.0,
    bristle_damping=0.3, viscous_coefficient=0.4,
)  # fmt: skip
PUSH = Sine(amplitude=4.0, frequency=1.0)
TURN = Torque(drive=Sine(amplitude=0.3, frequency=1.3))
CART = {"cart_mass": 0.5, "ball_mass": 0.1, "length": 0.3}
MASSES = {"motor_inertia": 0.5, "load_inertia": 1.5, "stiffness": 1e4, "damping": 20.0}
STROKE = Prescribed(profile=ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow"))
PULSES = Torque(drive=Square(high=2.0, low=-0.5, period=0.5, duty=0.3))
STOPPED = {"lower_stop": -0.05, "upper_stop": 0.05, "restitution": 0.5}
RIGS: tuple[tuple[str, Mechanism, FrictionLaw, float, dict[str, float]], ...] = (
    ("spring block, Coulomb", decay.RIG, decay.LAW, decay.T_END, {}),
    ("block on a belt, Coulomb", belt.BLOCK, belt.LAW, belt.T_END, {}),
    ("held samples, viscous", sampled.axis(SAMPLES), sampled.LAW, SAMPLES * sampled.STEP, {}),
    ("axis, sine, Coulomb", Axis(inertia=1.0, load=9.81, drive=PUSH), COULOMB, 5.0, {}),
    ("axis, sine, Stribeck", Axis(inertia=1.0, load=9.81, drive=PUSH), STRIBECK, 5.0, {}),
    ("axis, sine, Dahl", Axis(inertia=1.0, load=9.81, drive=PUSH), DAHL, 5.0, {}),
    ("towed block, LuGre", lugre.BLOCK, lugre.LAW, lugre.T_END, {}),
    ("towed block, soft LuGre", TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0), BRISTLES,
     20.0, {}),
    ("two-mass axis, Coulomb", TwoMassAxis(**MASSES, drive=Pulse(level=5.0, duration=1.0)), COULOMB,
     5.0, {}),
    ("two-mass axis, Stribeck", TwoMassAxis(**MASSES, drive=Pulse(level=5.0, duration=1.0)),
     STRIBECK, 5.0, {}),
    ("cart, reaction, Coulomb", PendulumCart(**CART, pendulum=TURN), COULOMB, 3.0, {"theta": 0.4}),
    ("cart, reaction, viscous", PendulumCart(**CART, pendulum=TURN), VISCOUS, 3.0, {"theta": 0.4}),
    ("cart, reaction, LuGre", PendulumCart(**CART, pendulum=TURN), BRISTLES, 3.0, {"theta": 0.4}),
    ("capsule, force", Capsule(capsule_mass=0.8, inner_mass=0.2, stiffness=50.0, drive=PULSES),
     COULOMB, 5.0, {}),
    ("capsule, prescribed", Capsule(capsule_mass=0.8, inner_mass=0.2, drive=STROKE), COULOMB, 1.0,
     {}),
    ("spring block, stops",
     SpringBlock(mass=1.0, stiffness=50.0, compression=0.1, attached=True, **STOPPED), COULOMB, 3.0,
     {}),
)  # fmt: skip
HEADS = (
    "mechanism", "changes", "states differ by", "steps", "kernel, ms", "of several, ms", "ratio",
)  # fmt: skip


def least(kernel: Kernel, tolerance: float) -> float:
    """Return the least processor time of a run [s]."""
    return min(mean_time(lambda: kernel.run(tolerance), time.process_time) for _ in range(RUNS))


def row(title: str, rig: Mechanism, law: FrictionLaw, t_end: float, start: dict[str, float]):
    """Return the cells of a mechanism."""
    (contact,) = rig.contacts()
    one = Kernel(rig, law, t_end, start=start)
    try:
        several = Kernel(rig, Laws(members=((contact.name, law),)), t_end, start=start)
    except InputError as refusal:
        return (title, "", f"refused: {str(refusal).partition(',')[0]}", *[""] * 4)
    ends = [np.array(kernel.run(TIGHT).final()) for kernel in (one, several)]
    counts = [len(kernel.changes()) for kernel in (one, several)]
    apart = float(np.max(np.abs(ends[1] - ends[0])) / np.max(np.abs(ends[0])))
    steps = [kernel.run(USUAL).steps() for kernel in (one, several)]
    times = [least(kernel, USUAL) for kernel in (one, several)]
    return (
        title,
        " / ".join(dict.fromkeys(map(str, counts))),
        f"{apart:.1e}",
        f"{steps[0]} / {steps[1]}",
        *(f"{1e3 * seconds:.3g}" for seconds in times),
        f"{times[1] / times[0]:.2f}",
    )


def rows() -> Iterator[tuple[str, ...]]:
    for rig in RIGS:
        yield row(*rig)


def run() -> Section:
    """Compare all mechanisms."""
    return Section(
        title="One contact on the kernels of several",
        heads=HEADS,
        rows=tuple(rows()),
        notes=(
            f"- States after runs at {TIGHT:g}, over the largest; steps and least processor time of"
            f" {RUNS} bursts at {USUAL:g}."
            " Steps: of the one, then of the other. Changes stand once where their numbers agree.",
        ),
    )


if __name__ == "__main__":
    print("\n".join(section(run())))
