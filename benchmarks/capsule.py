"""A vibro-impact capsule: sweeps of its frequency, and branches against settled runs.

The capsule is that of the tutorial. With a soft stop it is driven from outside; with hard stops the
force acts between both. Settled runs are independent of the branches: random frequencies and
states, and the least number of cycles after which the states of a cycle's start come again. A slow
transient and a motion of a longer period may come again nearly: a run that lies on no branch is run
on, and counts if it closes still, and far better.

Marks of chaos are compared with long runs of random capsules: periodic is what closes to 1e-6 after
thousands of cycles, chaotic what does not and has left a start 1e-6 off by then.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.measuring import Section, Target
from stickslip import Capsule, Coulomb, ensemble
from stickslip.engine import Samples
from stickslip.mechanisms import SoftStop, Torque
from stickslip.mechanisms.drives import Sine, Square
from stickslip.study.optimisation import measure, optimise
from stickslip.study.optimisation.search import with_values
from stickslip.study.sweep import (
    OrbitDiagram,
    average_velocity,
    lyapunov_exponents,
    orbit_diagram,
)
from stickslip.study.sweep.attractors import period_of

Array = NDArray[np.float64]

LAW = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)
BARE = Capsule(
    capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03,
    drive=Torque(drive=Sine(amplitude=0.2, frequency=8.0)),
)  # fmt: skip
SOFT = SoftStop(place=2e-3, stiffness=3000.0, damping=0.1)
RIGS = {
    "soft stop, force from outside": replace(BARE, drive_on="inner mass", upper_soft_stop=SOFT),
    "hard stop, e = 0.6": replace(BARE, upper_stop=2e-3, restitution=0.6),
    "hard stop, e = 0": replace(BARE, upper_stop=2e-3),
    "two hard stops, e = 0.6": replace(BARE, upper_stop=2e-3, lower_stop=-1.5e-3, restitution=0.6),
    "hard stop, e = 0.6, and a soft one below": replace(
        BARE, upper_stop=2e-3, restitution=0.6, lower_soft_stop=replace(SOFT, place=-1.5e-3)
    ),
}
FOLLOWED = ("soft stop, force from outside", "hard stop, e = 0.6", "hard stop, e = 0")
PATH = "mechanism.drive.drive.frequency"
FREQUENCIES = 500
RANGE = (2.0, 20.0)
RUNS, SETTLE, MOST, SEED = 2000, 400, 4, 5
FURTHER, CLOSED = 10_000, 1e-6
"""Cycles for which a run on no branch is run on, and how well it closes then, if it is settled."""
NEAR = 2e-3
"""Distance from an orbit, over the size of the states, of a settled run that lies on it."""
BETWEEN = 0.01
"""The same from a straight line between two orbits of a branch."""
GOAL_SWEEP, GOAL_BRANCHES = 1.5, 20.0
CHAOTIC, PERIODIC, MARKS_SEED = 40, 200, 2026
"""Motions of each kind with which marks are compared, and the seed of their capsules."""
LONG, STROBED, LEFT = 3000, 128, 1e-2
"""Cycles of long runs, those at their ends that are sampled, and distance of what has left."""
GOAL_MARKED, GOAL_FALSE = 38, 2
DESIGNS, EVALUATIONS, DESIGN_SEED, GOAL_RATIO = 2000, 800, 4, 1.2
BOX = {
    "mechanism.stiffness": (20.0, 200.0),
    "mechanism.upper_soft_stop.place": (5e-4, 5e-3),
    "mechanism.upper_soft_stop.stiffness": (300.0, 3e4),
    "mechanism.drive.drive.high": (0.05, 0.5),
    "mechanism.drive.drive.low": (-0.5, -0.05),
    "mechanism.drive.drive.period": (0.04, 0.4),
    "mechanism.drive.drive.duty": (0.1, 0.9),
}
"""Ranges of spring, gap, stop, amplitudes, period and duty of designs."""


def sweep(rig: Capsule) -> float:
    """Return the processor time of a sweep, 100 cycles at each frequency [s]."""
    average_velocity(rig, LAW, {PATH: [6.0, 8.0]}, cycles=20, settle=80)
    frequencies, begun = np.linspace(3.0, 20.0, FREQUENCIES), time.process_time()
    average_velocity(rig, LAW, {PATH: frequencies}, cycles=20, settle=80)
    return time.process_time() - begun


def settled(rig: Capsule, names: Sequence[str], sizes: Array) -> tuple[Array, Array, float]:
    """Return frequencies of settled runs, once-a-cycle states (runs, 2 MOST, k), and the time."""
    noise = np.random.default_rng(SEED)
    frequencies = np.sort(noise.uniform(*RANGE, RUNS))
    starts = {
        f"initial.{name}": 2.0 * size * noise.uniform(-1.0, 1.0, RUNS)
        for name, size in zip(names, sizes, strict=True)
    }
    lower = -np.inf if rig.lower_stop is None else rig.lower_stop
    upper = np.inf if rig.upper_stop is None else rig.upper_stop
    starts["initial.xi"] = np.clip(starts["initial.xi"], lower, upper)
    points, begun = [], time.process_time()
    for i, frequency in enumerate(frequencies):
        start = {path: float(column[i]) for path, column in starts.items()}
        points.append(samples(rig, names, frequency, start, SETTLE))
    return frequencies, np.array(points), time.process_time() - begun


def samples(
    rig: Capsule, names: Sequence[str], frequency: float, start: Mapping[str, float], settle: int
) -> Array:
    """Return once-a-cycle states (2 MOST, k) of a run after some cycles."""
    times = (settle + np.arange(1, 2 * MOST + 1)) / frequency
    columns = {PATH: [frequency], **{path: [value] for path, value in start.items()}}
    outputs = {name: Samples(name, times.tolist()) for name in names}
    run = ensemble(rig, LAW, columns, t_end=float(times[-1]), outputs=outputs)
    return np.stack([run[name][0] for name in names], axis=1)


def is_missed(
    rig: Capsule, diagram: OrbitDiagram, frequency: float, points: Array, sizes: Array
) -> bool:
    """Whether a run on no branch, run on, closes still, and lies on none."""
    names = diagram.states
    start = {f"initial.{name}": float(x) for name, x in zip(names, points[-1], strict=True)}
    later = samples(rig, names, frequency, start, FURTHER)
    period = period_of(later, sizes, CLOSED)
    return period > 0 and not lies_on(diagram, frequency, later, period, sizes)


def lies_on(
    diagram: OrbitDiagram, frequency: float, points: Array, period: int, sizes: Array
) -> bool:
    """Whether a settled run lies on a branch; where points of it are far, by orbits solved for."""

    def gap(starts: Array) -> float:
        off = np.abs(starts[:, None, :] - points[None, :period, :]) / sizes
        return float(off.max(axis=2).min(initial=np.inf))

    own = [branch for branch in diagram.branches if branch.cycles == period]
    if any(gap(branch.crossings(frequency)) <= BETWEEN for branch in own):
        return True
    orbits = [orbit for branch in own for orbit in branch.orbits_at(frequency)]
    starts = [[orbit.start[name] for name in diagram.states] for orbit in orbits]
    return gap(np.reshape(starts, (-1, len(sizes)))) <= NEAR


def branches(name: str) -> tuple[tuple[str, ...], Target]:
    """Return a row of the table of branches, and whether their goal is met."""
    rig, begun = RIGS[name], time.process_time()
    diagram = orbit_diagram(rig, LAW, PATH, RANGE, cycles=MOST)
    taken = time.process_time() - begun
    sizes = np.nanmax(np.abs(diagram.samples), axis=(0, 1))
    frequencies, points, brute = settled(rig, diagram.states, sizes)
    periods = [period_of(one, sizes) for one in points]
    rows = zip(frequencies, points, periods, strict=True)
    off = [(f, one, m) for f, one, m in rows if m and not lies_on(diagram, f, one, m, sizes)]
    missed = [(f, m) for f, one, m in off if is_missed(rig, diagram, f, one, sizes)]
    closing = sum(m > 0 for m in periods) - len(off) + len(missed)
    row = (
        name, str(len(diagram.branches)), f"{taken:.1f}", f"{brute:.1f}", str(closing),
        str(len(missed)) + "".join(f", {f:.3f} Hz of period {m}" for f, m in missed[:4]),
    )  # fmt: skip
    met = taken <= GOAL_BRANCHES and not missed
    goal = f"{GOAL_BRANCHES:g} s of processor time, all stable periods up to {MOST}"
    measured = f"{taken:.1f} s, {len(missed)} of {closing} settled runs on no branch"
    why = "settled runs where branches are short" if missed else "" if met else "its runs"
    return row, Target(work=f"branches, {name}", goal=goal, measured=measured, met=met, reason=why)


def samples_from(
    rig: Capsule, names: Sequence[str], frequency: float, start: Mapping[str, float]
) -> Array:
    """Return once-a-cycle states (STROBED, k) at the end of a long run."""
    times = ((LONG - STROBED + np.arange(1, STROBED + 1)) / frequency).tolist()
    columns = {PATH: [frequency], **{path: [value] for path, value in start.items()}}
    outputs = {name: Samples(name, times) for name in names}
    made = ensemble(rig, LAW, columns, t_end=times[-1], outputs=outputs)
    return np.stack([made[name][0] for name in names], axis=1)


def truth(rig: Capsule, frequency: float) -> str:
    """Return what a motion is by long runs: periodic, chaotic, or empty where they do not tell."""
    names = ("xi", "v", "xi_dot")
    points = samples_from(rig, names, frequency, {"initial.xi_dot": 0.0})
    if not np.isfinite(points).all():
        return ""
    size = np.abs(points).max(axis=0)
    size = np.maximum(size, 1e-3 * size[1:].max() * np.array([1.0 / frequency, 1.0, 1.0]))
    if period_of(points, size, CLOSED):
        return "periodic"
    others = samples_from(rig, names, frequency, {"initial.xi_dot": 1e-6 * float(size[2])})
    return "chaotic" if (np.abs(others - points) / size).max() > LEFT else ""


def marks() -> tuple[Target, Target]:
    """Return how many chaotic and periodic motions sweeps and exponents mark as chaotic."""
    noise, rigs = np.random.default_rng(MARKS_SEED), list(RIGS.values())
    kinds = {"chaotic": CHAOTIC, "periodic": PERIODIC}
    marked = {kind: np.zeros(2, dtype=int) for kind in kinds}
    found = dict.fromkeys(kinds, 0)
    drawn = 0
    while found != kinds and drawn < 6000:
        stops, frequency, amplitude = noise.integers(len(rigs)), *noise.uniform((3, 0.1), (20, 0.6))
        drive, drawn = Torque(drive=Sine(amplitude=amplitude, frequency=frequency)), drawn + 1
        rig = replace(rigs[stops], drive=drive, damping=float(noise.uniform(0.01, 0.1)))
        kind = truth(rig, frequency)
        if not kind or found[kind] == kinds[kind]:
            continue
        found[kind] += 1
        swept = average_velocity(rig, LAW, {PATH: [frequency]})
        long = lyapunov_exponents(rig, LAW)
        marked[kind] += np.array([bool(swept.chaotic[0]), long.chaotic])
    return tuple(
        Target(
            work=f"marks of chaos by {name}",
            goal=f"{GOAL_MARKED} of {CHAOTIC} chaotic motions, {GOAL_FALSE} of {PERIODIC} periodic",
            measured=f"{marked['chaotic'][k]} of {found['chaotic']} chaotic motions,"
            f" {marked['periodic'][k]} of {found['periodic']} periodic",
            met=bool(marked["chaotic"][k] >= GOAL_MARKED and marked["periodic"][k] <= GOAL_FALSE),
            reason="motions that come to rest once in hundreds of cycles have no positive exponent",
        )
        for k, name in enumerate(("average_velocity", "lyapunov_exponents"))
    )


def design() -> Target:
    """Return the speed of an optimised capsule over that of the best of random designs.

    Both are driven by a square wave. The optimised one may take as much energy per metre as the
    fastest random design. Speeds are those of long runs, from which chaotic means are left out.
    """
    square = Torque(drive=Square(high=0.2, low=-0.2, period=0.1, duty=0.5))
    rig = replace(BARE, upper_soft_stop=SOFT, drive=square)  # a force between both: no free push
    noise = np.random.default_rng(DESIGN_SEED)
    shares = noise.uniform(size=(DESIGNS, len(BOX)))
    ends = np.array(list(BOX.values()))
    values = np.where(
        ends[:, 0] > 0.0,
        np.abs(ends[:, 0]) * np.abs(ends[:, 1] / ends[:, 0]) ** shares,
        ends[:, 0] + (ends[:, 1] - ends[:, 0]) * shares,
    )
    random = [dict(zip(BOX, map(float, row), strict=True)) for row in values]
    judged = []
    for parameters in random:
        mechanism = with_values(rig, LAW, parameters)[0]
        judged.append(measure(mechanism, LAW))
    speeds = np.array([cycle.speed if cycle.repeats else -np.inf for cycle in judged])
    best = int(np.argmax(speeds))
    allowed = judged[best].energy
    found = optimise(
        rig, LAW, BOX, limits={"energy": allowed}, starts=[random[best]], evaluations=EVALUATIONS,
        seed=DESIGN_SEED,
    )  # fmt: skip
    means = []
    for parameters in (random[best], found.best.parameters):
        mechanism = with_values(rig, LAW, parameters)[0]
        swept = average_velocity(
            mechanism, LAW, {"inner_mass": [rig.inner_mass]}, cycles=100, settle=400, energy=True
        )
        means.append(float("nan") if swept.chaotic[0] else float(swept.velocity[0]))
    ratio = means[1] / means[0]
    return Target(
        work=f"capsule optimised in {EVALUATIONS} runs, over the best of {DESIGNS} random ones",
        goal=f"{GOAL_RATIO:g} times its mean speed at equal energy per metre",
        measured=f"{ratio:.2f} times {1e3 * means[0]:.1f} mm/s at {allowed:.3g} J/m",
        met=ratio >= GOAL_RATIO,
        reason="the best random design is near the optimum",
    )


def run() -> Section:
    """Return times of sweeps and branches, marks of chaos, and an optimised capsule."""
    sweeps = {name: sweep(rig) for name, rig in RIGS.items()}
    followed = [branches(name) for name in FOLLOWED]
    rows = [(name, "", f"{taken:.2f}", "", "", "") for name, taken in sweeps.items()]
    first = next(iter(RIGS))
    target = Target(
        work=f"{FREQUENCIES} frequencies, 100 cycles each, {first}",
        goal=f"{GOAL_SWEEP:g} s of processor time",
        measured=f"{sweeps[first]:.2f} s",
        met=sweeps[first] <= GOAL_SWEEP,
        reason="the machine was busy",
    )
    return Section(
        title="A vibro-impact capsule",
        heads=("capsule", "branches", "time, s", "settled runs, s", "closing", "on no branch"),
        rows=(*rows, *(row for row, _ in followed)),
        notes=(
            f"Rows without branches: sweeps of {FREQUENCIES} frequencies from 3 to 20 Hz, 100 to"
            f" 125 cycles each. Others: all branches from 2 to 20 Hz, and {RUNS} settled runs of"
            f" {SETTLE} cycles from random states, of which those that close within {MOST} cycles"
            f" must lie on a branch; those on none count if they close to {CLOSED:g} after"
            f" {FURTHER:,} cycles more. Processor time of one core.",
        ),
        targets=(target, *(one for _, one in followed), *marks(), design()),
    )
