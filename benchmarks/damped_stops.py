"""Random capsules with damped stops: every run reaches its end or names a true cause.

Twelve kinds of capsules, a hundred cycles of the drive each. A damper meets the mass with a jump of
its force, which may break the capsule away at that instant, let it stop, or do both; hard stops,
other stops and slow break-aways come at the same instant or just beside it. ``python -m
benchmarks.damped_stops --each 60`` prints what came of the runs of each kind and every run that
ended early; lift-off of the two-mass capsule is a true cause.
"""

import argparse
import math
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from stickslip import Capsule, Coulomb, CoulombViscous, Stribeck, simulate
from stickslip.engine.trajectory import Status, Trajectory
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import InnerMass, Mechanism, SoftStop, Torque, TwoMassCapsule
from stickslip.mechanisms.drives import Sine, Square

CYCLES = 100
WALL = 1.57
"""Incline of a wall [rad]."""
Random = np.random.Generator
Drawn = tuple[Capsule, Coulomb, float]
"""A capsule, its law, and the period of its drive [s]."""
Kind = tuple[Mechanism, FrictionLaw, float]


def between(random: Random, low: float, high: float) -> float:
    """Return a number between two bounds, evenly by its logarithm."""
    return float(math.exp(random.uniform(math.log(low), math.log(high))))


def bare(random: Random) -> Drawn:
    """Return a capsule without stops, its law, and the period of its drive."""
    mass, frequency = between(random, 0.01, 0.06), between(random, 4.0, 20.0)
    own = 2.0 * math.pi * between(random, 4.0, 12.0)
    kinetic = between(random, 0.05, 0.4)
    law = Coulomb(
        kinetic_coefficient=kinetic, static_coefficient=kinetic * random.choice([1.0, 1.2, 1.6])
    )
    capsule = Capsule(
        capsule_mass=between(random, 0.02, 0.1),
        inner_mass=mass,
        stiffness=mass * own * own,
        damping=2.0 * mass * own * between(random, 0.01, 0.2),
        drive_on=random.choice(["both", "inner mass"]),
    )
    weight = capsule.gravity * (capsule.capsule_mass + mass)
    force = kinetic * weight * between(random, 0.3, 3.0)
    drive = Torque(drive=Sine(amplitude=force, frequency=frequency))
    return replace(capsule, drive=drive), law, 1.0 / frequency


def soft(capsule: Capsule, random: Random, side: int, *, sticks: bool = False) -> SoftStop:
    """Return a damped stop of a capsule's mass, above (side 1) or below it (-1)."""
    stiffness = capsule.stiffness * between(random, 2.0, 60.0)
    critical = 2.0 * math.sqrt(stiffness * capsule.inner_mass)
    return SoftStop(
        place=side * between(random, 1e-4, 3e-3),
        stiffness=stiffness,
        damping=critical * between(random, 0.02, 3.0),
        sticks=sticks,
    )


def above(random: Random) -> Drawn:
    capsule, law, period = bare(random)
    return replace(capsule, upper_soft_stop=soft(capsule, random, 1)), law, period


def on_both_sides(random: Random) -> Drawn:
    capsule, law, period = above(random)
    return replace(capsule, lower_soft_stop=soft(capsule, random, -1)), law, period


def that_stick(random: Random) -> Drawn:
    capsule, law, period = bare(random)
    stop = soft(capsule, random, 1, sticks=True)
    return replace(capsule, upper_soft_stop=stop), law, period


def that_begin_closed(random: Random) -> Drawn:
    """The mass begins on the threshold of its stop, or behind it."""
    capsule, law, period = bare(random)
    stop = replace(soft(capsule, random, 1), place=float(random.choice([0.0, -1e-4])))
    return replace(capsule, upper_soft_stop=stop), law, period


def with_hard_ones_behind(random: Random) -> Drawn:
    capsule, law, period = above(random)
    assert capsule.upper_soft_stop is not None
    place = capsule.upper_soft_stop.place * float(random.choice([1.0, 1.05, 1.5]))
    return replace(capsule, upper_stop=place, restitution=random.choice([0.0, 0.6])), law, period


def with_hard_ones_below(random: Random) -> Drawn:
    capsule, law, period = above(random)
    place, bounce = -between(random, 1e-4, 3e-3), random.uniform(0.0, 0.9)
    return replace(capsule, lower_stop=place, restitution=bounce), law, period


def of_vertical_capsules(random: Random) -> Drawn:
    """A capsule that its squeeze holds on a wall: places are far from 0 beside the motion."""
    capsule, law, period = bare(random)
    weight = capsule.gravity * (capsule.capsule_mass + capsule.inner_mass)
    level = law.kinetic_coefficient
    sag = capsule.inner_mass * capsule.gravity / capsule.stiffness
    stop = soft(capsule, random, 1)
    return (
        replace(
            capsule,
            incline=WALL,
            squeeze=weight * between(random, 1.0, 2.0) / level,
            upper_soft_stop=replace(stop, place=stop.place - sag),
        ),
        law,
        period,
    )


def under_steps(random: Random) -> Drawn:
    capsule, law, period = on_both_sides(random)
    sine = capsule.drive.drives()["motor"]
    assert isinstance(sine, Sine)
    square = Square(high=sine.amplitude, low=-sine.amplitude, period=period)
    return replace(capsule, drive=Torque(drive=square)), law, period


def with_viscous_friction(random: Random) -> Kind:
    capsule, law, period = on_both_sides(random)
    viscous = CoulombViscous(
        kinetic_coefficient=law.kinetic_coefficient,
        static_coefficient=law.static_coefficient,
        viscous_coefficient=between(random, 0.01, 1.0),
    )
    return capsule, viscous, period


def stribeck(law: Coulomb, random: Random) -> Stribeck:
    """Return a law that falls from nearly its kinetic level, or from far above."""
    return Stribeck(
        kinetic_coefficient=law.kinetic_coefficient,
        static_coefficient=law.kinetic_coefficient * (1.0 + between(random, 1e-3, 0.5)),
        stribeck_velocity=between(random, 1e-3, 0.1),
        viscous_coefficient=between(random, 0.01, 1.0),
    )


def with_stribeck_friction(random: Random) -> Kind:
    capsule, law, period = above(random)
    return capsule, stribeck(law, random), period


def that_are_hard_with_stribeck_friction(random: Random) -> Kind:
    capsule, law, period = bare(random)
    place, bounce = between(random, 1e-4, 3e-3), random.uniform(0.0, 0.9)
    return replace(capsule, upper_stop=place, restitution=bounce), stribeck(law, random), period


def of_two_masses(random: Random) -> Kind:
    """Two masses, of which the second may move upwards, each with stops of its own."""
    capsule, law, period = with_hard_ones_below(random)
    first = InnerMass(
        mass=capsule.inner_mass,
        stiffness=capsule.stiffness,
        damping=capsule.damping,
        drive=capsule.drive,
        upper_soft_stop=capsule.upper_soft_stop,
    )
    second = replace(
        first,
        angle=float(random.choice([0.0, 0.3])),
        drive=Torque(),
        lower_soft_stop=soft(capsule, random, -1),
        upper_soft_stop=None,
        upper_stop=float(random.choice([1e-3, 3e-3])),
        restitution=capsule.restitution,
    )
    return (
        TwoMassCapsule(capsule_mass=capsule.capsule_mass, first=first, second=second),
        law,
        period,
    )


KINDS: Mapping[str, Callable[[Random], Kind]] = {
    kind.__name__.replace("_", " "): kind
    for kind in (
        above, on_both_sides, that_stick, that_begin_closed, with_hard_ones_behind,
        with_hard_ones_below, of_vertical_capsules, under_steps, with_viscous_friction,
        with_stribeck_friction, that_are_hard_with_stribeck_friction, of_two_masses,
    )
}  # fmt: skip
TRUE_CAUSES = (Status.LIFT_OFF,)


def run_of(kind: str, seed: int, cycles: int = CYCLES) -> Trajectory:
    """Return the run of one of the capsules."""
    capsule, law, period = KINDS[kind](np.random.default_rng([*kind.encode(), seed]))
    return simulate(capsule, law, t_end=cycles * period, throw=False)


def main(each: int, cycles: int) -> None:
    """Run capsules of each kind; print what came of them, and each that ended early."""
    print(f"{'stops':38}  ends  true cause  without end  not certified  events   s")
    for kind in KINDS:
        begun, result, count = time.process_time(), Counter[str](), 0
        for seed in range(each):
            run = run_of(kind, seed, cycles)
            count += len(run.events)
            if not run.status.complete:
                true = run.status in TRUE_CAUSES
                result["cause" if true else "without end"] += 1
                if not true:
                    print(f"  {seed}: {run.ending}", flush=True)
            elif not run.certificate.certified:
                result["not certified"] += 1
                print(f"  {seed}: {'; '.join(run.certificate.problems)}", flush=True)
            else:
                result["ends"] += 1
        numbers = (result[name] for name in ("ends", "cause", "without end", "not certified"))
        row = "{:6d}{:12d}{:13d}{:15d}".format(*numbers)
        print(f"{kind:38}{row}{count:8d}{time.process_time() - begun:6.0f}", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--each", type=int, default=60, help="capsules of each kind")
    parser.add_argument("--cycles", type=int, default=CYCLES, help="cycles of the drive")
    given = parser.parse_args()
    main(given.each, given.cycles)
