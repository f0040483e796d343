"""A vibro-impact capsule: sweeps of its frequency, and branches against settled runs.

The capsule is that of the tutorial. With a soft stop it is driven from outside; with hard stops the
force acts between both. Settled runs are independent of the branches: random frequencies and
states, and the least number of cycles after which the states of a cycle's start come again. A slow
transient and a motion of a longer period may come again nearly: a run that lies on no branch is run
on, and counts if it closes still, and far better.

Marks of chaos are compared with long runs of random capsules: periodic is what closes to 1e-6 after
thousands of cycles, chaotic what does not and has left a start 1e-6 off by then.
"""

import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.designs import SEED as DESIGN_SEED
from benchmarks.designs import design
from benchmarks.measuring import Section, Target
from stickslip import Capsule, Coulomb, EventDriven, ensemble
from stickslip.engine import Samples
from stickslip.errors import SimulationError
from stickslip.mechanisms import SoftStop, Torque
from stickslip.mechanisms.drives import Sine, Square
from stickslip.study.sweep import (
    EventCurve,
    OrbitChart,
    OrbitDiagram,
    average_velocity,
    continue_orbit,
    lyapunov_exponents,
    orbit_chart,
    orbit_diagram,
    periodic_orbit,
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
GOAL_SWEEP, GOAL_BRANCHES = 1.5, 12.0
BOX = {PATH: (10.0, 18.0), "mechanism.drive.drive.amplitude": (0.15, 0.25)}
CELLS, GOAL_CHART = 40, 60.0
"""Cells of a chart along each parameter, and its processor time [s]."""
STARTS, START_SIZES, OFF = 10, (2e-3, 0.05, 0.5), 1e-5
"""Random states in each cell, their sizes, and how far beside an orbit a run begins."""
CHECKED, GOAL_ERROR = 20, 1e-6
"""Points of each curve that a branch over one parameter meets, and the error over the range."""
BESIDE = 0.01
"""Range of such a branch to each side, over that of the chart."""
NO_CAUSE = ("too short", "not converge", "give more", "led beyond")
"""What ends of curves say that have no cause in the motion."""
CAPSULES, CAPSULE_CYCLES = 720, 200
"""Random capsules, and cycles of each run."""
CHAOTIC, PERIODIC, MARKS_SEED = 40, 200, 2026
"""Motions of each kind with which marks are compared, and the seed of their capsules."""
LONG, STROBED, LEFT = 3000, 128, 1e-2
"""Cycles of long runs, those at their ends that are sampled, and distance of what has left."""
GOAL_MARKED, GOAL_FALSE = 38, 2


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
    periods = [period_of(point, sizes) for point in points]
    rows = zip(frequencies, points, periods, strict=True)
    off = [(f, item, m) for f, item, m in rows if m and not lies_on(diagram, f, item, m, sizes)]
    missed = [(f, m) for f, item, m in off if is_missed(rig, diagram, f, item, sizes)]
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
    result = dict.fromkeys(kinds, 0)
    drawn = 0
    while result != kinds and drawn < 6000:
        stops, frequency, amplitude = noise.integers(len(rigs)), *noise.uniform((3, 0.1), (20, 0.6))
        drive, drawn = Torque(drive=Sine(amplitude=amplitude, frequency=frequency)), drawn + 1
        rig = replace(rigs[stops], drive=drive, damping=float(noise.uniform(0.01, 0.1)))
        kind = truth(rig, frequency)
        if not kind or result[kind] == kinds[kind]:
            continue
        result[kind] += 1
        swept = average_velocity(rig, LAW, {PATH: [frequency]})
        long = lyapunov_exponents(rig, LAW)
        marked[kind] += np.array([bool(swept.chaotic[0]), long.chaotic])
        if sum(result.values()) % 20 == 0:
            report_progress(
                f"{result}, of which marked {marked['chaotic']} and {marked['periodic']}"
            )
    return tuple(
        Target(
            work=f"marks of chaos by {name}",
            goal=f"{GOAL_MARKED} of {CHAOTIC} chaotic motions, {GOAL_FALSE} of {PERIODIC} periodic",
            measured=f"{marked['chaotic'][k]} of {result['chaotic']} chaotic motions,"
            f" {marked['periodic'][k]} of {result['periodic']} periodic",
            met=bool(marked["chaotic"][k] >= GOAL_MARKED and marked["periodic"][k] <= GOAL_FALSE),
            reason="motions that come to rest once in hundreds of cycles have no positive exponent",
        )
        for k, name in enumerate(("average_velocity", "lyapunov_exponents"))
    )


def errors_of(curve: EventCurve) -> list[float]:
    """Return the errors of a curve, over the range, against branches over the first parameter.

    Without its ends, where two events meet. Branches begin beside a point of the curve, or at it.
    Infinite where none of the branches beside a point has the event.
    """
    (low, high), errors = BOX[PATH], list[float]()
    beside = BESIDE * (high - low)
    inside = np.flatnonzero(np.abs(curve.values[:, 0] - 0.5 * (low + high)) < 0.499 * (high - low))
    inside = inside[(inside > 0) & (inside < len(curve.values) - 1)]  # two events meet at an end
    for k in inside[np.linspace(0, len(inside) - 1, min(CHECKED, len(inside))).astype(int)]:
        frequency, amplitude = curve.values[k].tolist()
        start = dict(zip(curve.states, curve.starts[k].tolist(), strict=True))
        ends, off = (frequency - beside, frequency + beside), [np.inf]
        # from an orbit beside it, or from the point: at a fold there is none on one side, and
        # elsewhere the nearest orbit may be one of another branch
        for share in (0.1, -0.1, 0.0):
            drive = Torque(drive=Sine(amplitude=amplitude, frequency=frequency + share * beside))
            rig = replace(RIGS[FOLLOWED[0]], drive=drive)
            with suppress(SimulationError):
                orbit = periodic_orbit(rig, LAW, start=start, cycles=curve.cycles, settle=0)
                events = continue_orbit(orbit, PATH, ends).events
                off += [abs(e.value - frequency) for e in events if e.kind == curve.kind]
            if min(off) < NEAR * beside:
                break
        errors.append(float(min(off)) / (high - low))
    return errors


def regions(found: OrbitChart) -> Target:
    """Return how far numbers and periods of stable motions agree with settled runs in all cells.

    Motions that no run from a random state meets settle from right beside them.
    """
    noise, soft = np.random.default_rng(SEED), RIGS[FOLLOWED[0]]
    low, high = np.array(list(BOX.values())).T
    cell = (high - low) / (CELLS - 1)
    missed, far, alone, left, closing = 0, 0, 0, 0, 0
    for i, j in np.ndindex(CELLS, CELLS):
        if j == 0 and i % 8 == 0:
            report_progress(f"settled runs in cells {i} of {CELLS}")
        frequency, amplitude = float(found.axes[0][i]), float(found.axes[1][j])
        drive = Torque(drive=Sine(amplitude=amplitude, frequency=frequency))
        rig, known = replace(soft, drive=drive), [y for _, y in found.motions.get((i, j), ())]
        columns = {
            f"initial.{name}": size * noise.uniform(-1.0, 1.0, STARTS)
            for name, size in zip(found.states, START_SIZES, strict=True)
        }
        points = settled_from(rig, found.states, frequency, columns)
        size = np.abs(points).max(axis=(0, 1))
        size = np.where(size > CLOSED * size.max(), size, size.max())
        short = [own for own in points if 0 < period_of(own, size) <= 2]
        gaps = np.array([
            [(np.abs(own[:2] - y) / size).max(axis=1).min() for y in known] for own in short
        ]).reshape(len(short), len(known))  # fmt: skip
        closing += len(short)
        if (gaps.min(axis=1, initial=np.inf) > NEAR).any():
            missed += 1
            here = (np.array([frequency, amplitude]) - low) / cell
            far += all(distance((c.values - low) / cell, here) > 1.0 for c in found.curves)
        for k in np.flatnonzero(gaps.min(axis=0, initial=np.inf) > NEAR).tolist():
            beside = {
                f"initial.{name}": np.array([x]) * (1.0 + OFF)
                for name, x in zip(found.states, known[k].tolist(), strict=True)
            }
            ends = settled_from(rig, found.states, frequency, beside)[0]
            alone += 1
            left += bool((np.abs(ends - known[k]) / size).max(axis=1).min() > NEAR)
    return Target(
        work=f"chart against {STARTS} settled runs in each of {CELLS} x {CELLS} cells",
        goal="no cell with an unknown motion farther than a cell from a curve",
        measured=f"{missed} cells with an unknown motion, {far} of them far from curves;"
        f" {closing} runs close; {alone} motions of the chart that no run met, {left} of which are"
        " left from beside",
        met=far == 0 and left == 0,
        reason="sheets that no run has met",
    )  # fmt: skip


def settled_from(
    rig: Capsule, names: Sequence[str], frequency: float, columns: Mapping[str, Array]
) -> Array:
    """Return once-a-cycle states (runs, 2 MOST, k) of runs after some cycles."""
    times = ((SETTLE + np.arange(1, 2 * MOST + 1)) / frequency).tolist()
    count = len(next(iter(columns.values())))
    outputs = {name: Samples(name, times) for name in names}
    run = ensemble(
        rig, LAW, {PATH: [frequency] * count, **columns}, t_end=times[-1], outputs=outputs
    )
    return np.stack([run[name] for name in names], axis=2)


def distance(line: Array, here: Array) -> float:
    """Return how far a place is from a polygon, along either axis."""
    chords = np.diff(line, axis=0)
    squares = np.maximum((chords**2).sum(axis=1), np.finfo(float).tiny)
    along = np.clip(((here - line[:-1]) * chords).sum(axis=1) / squares, 0.0, 1.0)
    off = np.abs(here - line[:-1] - along[:, None] * chords)
    return float(off.max(axis=1).min(initial=np.inf))


def chart() -> tuple[Target, ...]:
    """Return what a chart of the soft capsule takes, and how right it is."""
    soft, begun = RIGS[FOLLOWED[0]], time.process_time()
    result = orbit_chart(soft, LAW, BOX, values=(CELLS, CELLS))
    taken = time.process_time() - begun
    ends = [end for curve in result.curves for end in curve.ends]
    early = sum(" off, " not in end and any(word in end for word in NO_CAUSE) for end in ends)
    smooth = [curve for curve in result.curves if curve.kind != "sticking"]
    errors = {
        kind: np.array([e for curve in smooth if curve.kind == kind for e in errors_of(curve)])
        for kind in dict.fromkeys(curve.kind for curve in smooth)
    }
    met = {kind: own[own < BESIDE / 2.0] for kind, own in errors.items()}
    counts = f"{CELLS} x {CELLS} cells"
    largest = ", ".join(
        f"{kind} {own.max(initial=0.0):.1g} at {len(own)} of {len(errors[kind])} points"
        for kind, own in met.items()
    )
    return (
        Target(
            work=f"chart of {counts}", goal=f"{GOAL_CHART:g} s of processor time",
            measured=f"{taken:.1f} s, {len(result.curves)} curves", met=taken <= GOAL_CHART,
            reason="its runs",
        ),
        Target(
            work="ends of its curves with no cause in the motion", goal="0",
            measured=f"{early} of {len(ends)}", met=early == 0,
            reason="curves that creep along a border of sticking",
        ),
        regions(result),
        Target(
            work="error of its curves, without ends, against branches, over the range",
            goal=f"{GOAL_ERROR:g}",
            measured=largest,
            met=all(own.max() <= GOAL_ERROR for own in errors.values()),
            reason="points beside which no branch has the event",
        ),
    )  # fmt: skip


def random_capsule(noise: np.random.Generator) -> tuple[Capsule, Coulomb, float]:
    """Return a capsule, its law, and the period of its drive."""
    kind, gaps = noise.integers(6), noise.uniform(5e-4, 5e-3, 2)
    below = SoftStop(
        place=-gaps[1], stiffness=10.0 ** noise.uniform(2.7, 4.3), damping=0.1,
        sticks=bool(noise.integers(2)),
    )  # fmt: skip
    stops: Mapping[str, Any] = (
        {},
        {"upper_stop": gaps[0]},
        {"upper_stop": gaps[0], "lower_stop": -gaps[1]},
        {"upper_soft_stop": replace(below, place=gaps[0])},
        {"upper_soft_stop": replace(below, place=gaps[0]), "lower_soft_stop": below},
        {"upper_stop": gaps[0], "lower_soft_stop": below},
    )[kind]
    force, period = 10.0 ** noise.uniform(-1.5, 0.3), 10.0 ** noise.uniform(-1.5, -0.3)
    drives = (
        Sine(amplitude=force, frequency=1.0 / period, phase=noise.uniform(0.0, 6.0)),
        Square(high=force, low=-force, period=period, duty=noise.uniform(0.2, 0.8)),
    )
    capsule = Capsule(
        capsule_mass=noise.uniform(0.02, 0.2), inner_mass=noise.uniform(0.005, 0.1),
        stiffness=10.0 ** noise.uniform(1.0, 2.5), damping=noise.choice([0.0, 0.03, 0.3]),
        drive_on="inner mass" if noise.integers(2) else "both",
        restitution=noise.choice([0.0, 0.5, 0.9]),
        drive=Torque(drive=drives[noise.integers(2)]), **stops,
    )  # fmt: skip
    kinetic = noise.uniform(0.02, 0.4)
    static = kinetic * noise.choice([1.0, 1.3, 2.0])
    return capsule, Coulomb(kinetic_coefficient=kinetic, static_coefficient=static), period


def early_ends() -> Target:
    """Return how many runs of random capsules end early."""
    noise, solver, early = np.random.default_rng(SEED), EventDriven(tier="compiled"), 0
    for _ in range(CAPSULES):
        rig, law, period = random_capsule(noise)
        inside = noise.uniform(-1.0, 1.0) * min(
            abs(x) for x in (rig.upper_stop, rig.lower_stop, 5e-3) if x is not None
        )
        y0 = [0.0, inside, noise.uniform(-0.1, 0.1), noise.uniform(-0.5, 0.5)]
        run_ = solver.bare(rig, law, y0=y0, t_end=CAPSULE_CYCLES * period)
        early += not run_.status.complete
    return Target(
        work=f"early ends of {CAPSULES} random capsules, {CAPSULE_CYCLES} cycles each",
        goal="0", measured=str(early), met=early == 0, reason="see their status",
    )  # fmt: skip


def sweeps() -> tuple[list[tuple[str, ...]], list[Target]]:
    """Return rows of the times of sweeps, and whether that of the first one is short enough."""
    taken = {name: sweep(rig) for name, rig in RIGS.items()}
    first = next(iter(RIGS))
    target = Target(
        work=f"{FREQUENCIES} frequencies, 100 cycles each, {first}",
        goal=f"{GOAL_SWEEP:g} s of processor time", measured=f"{taken[first]:.2f} s",
        met=taken[first] <= GOAL_SWEEP, reason="the machine was busy",
    )  # fmt: skip
    return [(name, "", f"{seconds:.2f}", "", "", "") for name, seconds in taken.items()], [target]


def all_branches() -> tuple[list[tuple[str, ...]], list[Target]]:
    """Return rows and targets of the branches of the capsules that are followed."""
    pairs = [branches(name) for name in FOLLOWED]
    return [row for row, _ in pairs], [target for _, target in pairs]


PARTS: Mapping[str, Callable[[], tuple[list[tuple[str, ...]], list[Target]]]] = {
    "early": lambda: ([], [early_ends()]),
    "sweeps": sweeps,
    "branches": all_branches,
    "chart": lambda: ([], [*chart()]),
    "marks": lambda: ([], [*marks()]),
    "design": lambda: ([], [design()]),
}
"""What `run` prints, each of which can be chosen."""
SEEDS = (
    f"Seeds: {SEED} (random capsules, starts of settled runs and of cells), {MARKS_SEED} (motions"
    f" with which marks of chaos are compared), {DESIGN_SEED} (random designs and the search)."
)


def table(parts: Sequence[str]) -> tuple[list[tuple[str, ...]], list[Target]]:
    """Return rows and targets of parts; each is printed as soon as it is known."""
    rows, targets = list[tuple[str, ...]](), list[Target]()
    for number, part in enumerate(parts, 1):
        report_progress(f"{part}, part {number} of {len(parts)} ...")
        begun = time.process_time()
        more, known = PARTS[part]()
        report_progress(f"{part} took {time.process_time() - begun:.0f} s of processor time.")
        for target in known:
            verdict = "met" if target.met else "NOT MET"
            report_progress(f"{target.work}: {target.measured} ({target.goal}): {verdict}")
        rows, targets = [*rows, *more], [*targets, *known]
    return rows, targets


def report_progress(line: str) -> None:
    """Print what has been done so far beside the page."""
    print(f"capsule: {line}", file=sys.stderr, flush=True)


def run(*parts: str) -> Section:
    """Return times of sweeps and branches, a chart, marks of chaos, and an optimised capsule."""
    rows, targets = table(parts or tuple(PARTS))
    return Section(
        title="A vibro-impact capsule",
        heads=("capsule", "branches", "time, s", "settled runs, s", "closing", "on no branch"),
        rows=tuple(rows),
        notes=(
            f"Rows without branches: sweeps of {FREQUENCIES} frequencies from 3 to 20 Hz, 100 to"
            f" 125 cycles each. Others: all branches from 2 to 20 Hz, and {RUNS} settled runs of"
            f" {SETTLE} cycles from random states, of which those that close within {MOST} cycles"
            f" must lie on a branch; those on none count if they close to {CLOSED:g} after"
            f" {FURTHER:,} cycles more. Processor time of one core.",
            SEEDS,
        ),
        targets=tuple(targets),
    )
