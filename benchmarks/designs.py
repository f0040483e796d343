"""Designs of a vibro-impact capsule: an optimum against the best of random ones.

The box is what a designer may choose, set before anything was measured in it: a decade about the
capsule of the tutorial for each of inner mass, spring, gaps and stiffnesses of stops at both ends,
forces of a square wave either way, and its period; and a duty of 0.1 to 0.9. That is as wide as
springs, magnets and coils of one size come; the known capsule is in the middle of each range.

The optimum is compared with the fastest random design, and may take no more energy per metre than
that design does. Motions that do not repeat themselves count on neither side, since their means
depend on the start. Speeds are means of long runs.

``python -m benchmarks.designs`` prints the target.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchmarks.measuring import Target
from stickslip import Capsule, Coulomb
from stickslip.mechanisms import SoftStop, Torque
from stickslip.mechanisms.drives import Square
from stickslip.study.optimisation import Motion, measure, optimise
from stickslip.study.optimisation.search import with_values
from stickslip.study.sweep import average_velocity

LAW = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)
STOP = SoftStop(place=2e-3, stiffness=3000.0, damping=0.1)
RIG = Capsule(
    capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03,
    drive=Torque(drive=Square(high=0.2, low=-0.2, period=0.125, duty=0.5)),
    upper_soft_stop=STOP, lower_soft_stop=replace(STOP, place=-2e-3),
)  # fmt: skip
"""A force between both: no push from outside is free."""
DECADES = {
    "mechanism.inner_mass": 0.02,
    "mechanism.stiffness": 60.0,
    "mechanism.upper_soft_stop.place": 2e-3,
    "mechanism.upper_soft_stop.stiffness": 3000.0,
    "mechanism.lower_soft_stop.place": -2e-3,
    "mechanism.lower_soft_stop.stiffness": 3000.0,
    "mechanism.drive.drive.high": 0.2,
    "mechanism.drive.drive.low": -0.2,
    "mechanism.drive.drive.period": 0.125,
}
"""Middles of decades."""
RANGES = {
    path: (min(ends), max(ends))
    for path, middle in DECADES.items()
    for ends in [(middle / math.sqrt(10.0), middle * math.sqrt(10.0))]
} | {"mechanism.drive.drive.duty": (0.1, 0.9)}
DESIGNS, EVALUATIONS, SEED, STARTS, GOAL = 2000, 800, 4, 5, 1.2
ROUNDING = 1e-4
"""Share by which a mean over 100 cycles may differ from that of one."""

Design = tuple[dict[str, float], float, float]
"""Parameters of a design that moves forwards and repeats itself, its speed, and its energy."""


def random_designs(count: int = DESIGNS, seed: int = SEED) -> list[Design]:
    """Return designs of the box that move forwards and repeat themselves, the fastest first."""
    shares = np.random.default_rng(seed).uniform(size=(count, len(RANGES)))
    low, high = np.array(list(RANGES.values())).T
    grown = np.abs(low) * np.abs(high / low) ** shares
    values = np.where(low > 0.0, grown, low + (high - low) * shares)
    result = []
    for row in values.tolist():
        parameters = dict(zip(RANGES, row, strict=True))
        cycle = measure(with_values(RIG, LAW, parameters)[0], LAW)
        if cycle.repeats and cycle.travel > 0.0:
            result.append((parameters, cycle.speed, cycle.energy))
    return sorted(result, key=lambda design: -design[1])


def optimum(designs: Sequence[Design], allowed: float, evaluations: int = EVALUATIONS) -> Motion:
    """Return the fastest motion with no more energy per metre than is allowed."""
    near = [parameters for parameters, _, energy in designs if energy <= allowed]
    result = optimise(
        RIG, LAW, RANGES, limits={"energy": allowed, "unsettled": 0.0}, starts=near[:STARTS],
        evaluations=evaluations, seed=SEED,
    )  # fmt: skip
    return result.best


def long_mean(parameters: dict[str, float]) -> tuple[float, float]:
    """Return mean speed and energy per metre of a long run; NaN of a chaotic one."""
    mechanism = with_values(RIG, LAW, parameters)[0]
    mass = {"capsule_mass": [RIG.capsule_mass]}
    swept = average_velocity(mechanism, LAW, mass, cycles=100, settle=400, energy=True)
    energy = float(swept.energies["energy per travel"][0])
    return (math.nan if swept.chaotic[0] else float(swept.velocity[0])), energy


def design() -> Target:
    """Return the speed of an optimum over that of the best of random designs."""
    designs = random_designs()
    parameters, _, allowed = designs[0]
    speed, energy = long_mean(dict(optimum(designs, allowed).parameters))
    other, rival = long_mean(parameters)
    means = f"{1e3 * speed:.1f} at {energy:.3g} J/m over {1e3 * other:.1f} mm/s at {rival:.3g} J/m"
    return Target(
        work=f"capsule optimised in {EVALUATIONS} runs, over the best of {DESIGNS} random ones",
        goal=f"{GOAL:g} times its mean speed at equal energy per metre",
        measured=f"{speed / other:.2f}: {means}",
        met=speed >= GOAL * other and energy <= (1.0 + ROUNDING) * rival,
        reason="the best random design is near the optimum",
    )


if __name__ == "__main__":
    target = design()
    print(f"{target.work}: {target.measured} ({target.goal})")
