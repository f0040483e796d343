"""Many runs of the block on a spring, each with its own numbers: 10,000 of them, and a million."""

import functools
import itertools
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks import decay
from benchmarks.measuring import REPEATS, TIERS, TOLERANCES, Section, Target, mean_time
from benchmarks.tables import milliseconds
from stickslip import EventDriven, Stribeck, ensemble
from stickslip.engine import Ensemble, EventTimes, Final
from stickslip.friction import FrictionLaw

ROWS, MANY = 10_000, 1_000_000
PART = 20
"""Runs that SciPy makes; its time is scaled to all of them."""
SEED = 3
V_S, SURPLUS = 0.01, 1.2
"""Stribeck velocity [m/s] and static over kinetic level, where the modes are not linear."""
ERROR = 1e-9
RANGES = {
    "mechanism.stiffness": (90.0, 110.0),
    "mechanism.compression": (0.078, 0.082),
    "friction.kinetic_coefficient": (0.098, 0.102),
}
WHY = (
    "a row costs what the kernel alone costs, some 6.5 us of a core: 16 steps, of which the roots"
    " of guards, the series and their values for the certificate take an eighth each; 5,000 x would"
    " be 1.3 us, and the roots alone take 1.1 us"
)
WHY_MANY = "memory is held until the end of the run"
HEADS = ("runs", "solver", "tolerance", "error", "median, ms", "a run, us", "SciPy's time over it")


def numbers(rows: int) -> dict[str, np.ndarray]:
    """Return the parameters of all runs."""
    noise = np.random.default_rng(SEED)
    return {path: noise.uniform(*span, rows) for path, span in RANGES.items()}


def exact(varied: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return the last stop of each run and where it rests, by the closed form of `decay`."""
    k, x_0, mu = varied.values()
    w, level = np.sqrt(k / decay.M), mu * decay.M * decay.G / k
    swings = np.ceil((x_0 / level - 1.0) / 2.0)
    return swings * np.pi / w, x_0 - (-1.0) ** swings * (x_0 - 2.0 * swings * level)


@functools.cache
def pool(threads: int) -> ThreadPoolExecutor:
    """Return threads that keep to a core each: a busy machine may put all of them on one."""
    cores = itertools.cycle(sorted(os.sched_getaffinity(0)))

    def bind() -> None:
        os.sched_setaffinity(threading.get_native_id(), {next(cores)})

    return ThreadPoolExecutor(threads, initializer=bind)


def law(kind: str) -> FrictionLaw:
    """Return the law of "exact" modes, or of modes that need "steps"."""
    if kind == "exact":
        return decay.LAW
    mu = decay.MU
    return Stribeck(kinetic_coefficient=mu, static_coefficient=SURPLUS * mu, stribeck_velocity=V_S)


def by_stickslip(
    kind: str, varied: dict[str, np.ndarray], threads: int, tolerance: float, tier: str
) -> Ensemble:
    own = dict(varied)
    if kind == "steps":
        own["friction.static_coefficient"] = SURPLUS * own["friction.kinetic_coefficient"]
    return ensemble(
        decay.RIG, law(kind), own, t_end=decay.T_END,
        outputs={"stop": EventTimes("stop"), "x": Final("x")},
        solver=EventDriven(tier=tier, tolerance=tolerance), executor=pool(threads),
    )  # fmt: skip


def fading_by_scipy(tolerance: float, k: float, x_0: float, F: float) -> list[float]:
    """Swing by swing as in `decay`, with a static level that fades."""
    F_S = SURPLUS * F

    def stop(t, y, side):
        return y[1]

    def swing(t, y, side):
        return [y[1], (k * (x_0 - y[0]) - side * (F + (F_S - F) * math.exp(-((y[1] / V_S) ** 2))))]

    stop.terminal = True
    t, x = 0.0, 0.0
    while abs(k * (x_0 - x)) > F_S:
        side = math.copysign(1.0, x_0 - x)
        stop.direction = -side
        run = solve_ivp(
            swing, (t, decay.T_END), [x, 0.0], method="DOP853", rtol=tolerance,
            atol=tolerance * x_0, events=stop, args=(side,),
        )  # fmt: skip
        t, x = float(run.t_events[0][0]), float(run.y_events[0][0][0])
    return [t, x]


def by_scipy(kind: str, varied: dict[str, np.ndarray], tolerance: float) -> np.ndarray:
    """Return stop and place (2, runs) of the first runs, one after the other."""
    rows = np.column_stack(list(varied.values()))[:PART].tolist()
    result = []
    for k, x_0, mu in rows:
        F = mu * decay.M * decay.G
        if kind == "exact":
            result.append(decay.by_scipy("DOP853", tolerance, k, x_0, F)[-2:])
        else:
            result.append(fading_by_scipy(tolerance, k, x_0, F))
    return np.transpose(result)


def off(found: Sequence[np.ndarray], known: Sequence[np.ndarray]) -> float:
    """Return the largest relative error of the runs that are known."""
    pairs = zip(found, known, strict=True)
    return max(float(np.max(np.abs(f[: len(k)] / k - 1.0))) for f, k in pairs)


@dataclass
class Work:
    """A solver on all runs: how it runs, at what tolerance, with what error."""

    solver: str
    run: Callable[[], object]
    tolerance: float
    error: float
    factor: float = 1.0
    median: float = math.nan


def works(kind: str, rows: int, tier: str) -> list[Work]:
    """Return the solvers, each at the loosest tolerance that does, SciPy last."""
    varied = numbers(rows)
    own = {threads: functools.partial(by_stickslip, kind, varied, threads) for threads in (1, 2)}
    scipy = functools.partial(by_scipy, kind, varied)
    known = exact(varied) if kind == "exact" else scipy(1e-13)

    def error_of(runs: Ensemble) -> float:
        assert runs.certified.all()
        return off((runs["stop"][:, 0], runs["x"]), known)

    def loosest(run: Callable[[float], object], of: Callable) -> tuple[float, float]:
        errors = ((tolerance, of(run(tolerance))) for tolerance in TOLERANCES)
        return next(pair for pair in errors if pair[1] <= ERROR)

    tolerance, error = loosest(lambda tolerance: own[2](tolerance, tier), error_of)
    result = [
        Work(f"stickslip, ensemble(...), {threads} thread{'s' * (threads > 1)}",
             functools.partial(run, tolerance, tier), tolerance, error)
        for threads, run in own.items()
    ]  # fmt: skip
    first = [column[:PART] for column in known]
    tolerance, error = loosest(scipy, lambda runs: off(runs, first))
    scale = rows / min(PART, rows)
    return [
        *result,
        Work("SciPy DOP853, events by hand", lambda: scipy(tolerance), tolerance, error, scale),
    ]


def timed(found: list[Work], repeats: int) -> None:
    """Take the times in turns."""
    times: list[list[float]] = [[] for _ in found]
    for _ in range(repeats):
        for own, work in zip(times, found, strict=True):
            own.append(work.factor * mean_time(work.run))
    for own, work in zip(times, found, strict=True):
        work.median = statistics.median(own)


def row_of(title: str, rows: int, work: Work, scipy: Work) -> tuple[str, ...]:
    ratio = scipy.median / work.median
    return (
        title, work.solver, f"{work.tolerance:.1e}", f"{work.error:.0e}",
        milliseconds(work.median), f"{1e6 * work.median / rows:#.3g}".rstrip("."),
        f"{ratio:.0f}" if work is not scipy else "1",
    )  # fmt: skip


def child(rows: int) -> None:
    """Make runs in a process of their own and print what they took."""
    warm, varied = numbers(100), numbers(rows)
    by_stickslip("exact", warm, 2, 1e-9, "compiled")
    start = time.perf_counter()
    runs = by_stickslip("exact", varied, 2, 1e-9, "compiled")
    passed = time.perf_counter() - start
    most = peak()
    error = off((runs["stop"][:, 0], runs["x"]), exact(varied))
    result = {"seconds": passed, "peak": most, "error": error}
    print(json.dumps({**result, "certified": int(runs.certified.sum())}))


def peak() -> int:
    """Return the most memory that this process has had [bytes].

    Linux hands the maximum that `getrusage` knows from a parent to its child; its own table does
    not.
    """
    try:
        lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    (high,) = (line.split()[1] for line in lines if line.startswith("VmHWM"))
    return 1024 * int(high)


def in_child(rows: int) -> dict[str, float]:
    text = f"from benchmarks.ensembles import child; child({rows})"
    run = subprocess.run(
        [sys.executable, "-c", text], check=True, stdout=subprocess.PIPE, text=True
    )
    return json.loads(run.stdout)


def million(repeats: int, rows: int) -> tuple[list[tuple[str, ...]], list[str], list[Target]]:
    """Return row, note and targets of very many runs, against a tenth of them."""
    few, *many = in_child(rows // 10), *(in_child(rows) for _ in range(min(3, repeats)))
    seconds = statistics.median(run["seconds"] for run in many)
    worst = max(run["error"] for run in many)
    growth = (many[0]["peak"] - few["peak"]) / (rows - rows // 10)
    certified = min(run["certified"] for run in many)
    row = (f"{rows:,} with exact modes", "stickslip, ensemble(...), 2 threads", "1.0e-09",
           f"{worst:.0e}", f"{1e3 * seconds:.0f}", f"{1e6 * seconds / rows:#.3g}", "")  # fmt: skip
    note = (
        f"- {rows:,} runs in a process of their own, median of {len(many)}: {certified:,}"
        f" certified, at most {many[0]['peak'] / 1e6:.0f} MB; {rows // 10:,} runs need"
        f" {few['peak'] / 1e6:.0f} MB, so a run costs {growth:.0f} bytes, of which {HELD} are its"
        " numbers, outputs and certificate, which the caller has."
    )
    work = f"{rows:,} spring-block runs, certificate on"
    return [row], [note], [
        Target(work=work, goal="< 10 s", measured=f"{seconds:.2f} s", met=seconds < 10.0,
               reason=WHY_MANY),
        Target(work=work, goal="memory flat but for results",
               measured=f"{many[0]['peak'] / 1e6:.0f} MB, {growth:.0f} bytes a run,"
               f" {HELD} of them results",
               met=growth < 1.25 * HELD, reason=WHY_MANY),
    ]  # fmt: skip


HELD = 8 * (2 * 3 + 2 + 1 + 5 + 1) + 1
"""Bytes a run of what the caller has: parameters given and kept, outputs, status, evidence, steps,
certified."""


def run(
    repeats: int = REPEATS, tiers: Sequence[str] = tuple(TIERS), rows: int = ROWS, many: int = MANY
) -> Section:
    """Run the case; `many` is 0 where the very many runs are left out."""
    tier = "compiled" if "compiled" in tiers else "python"
    lines, targets, notes = [], [], []
    for kind, title, goals in (
        ("exact", f"{rows:,} with exact modes", (600.0, 5000.0)),
        ("steps", f"{rows:,} with Stribeck friction", ()),
    ):
        result = works(kind, rows, tier)
        timed(result, repeats)
        for work in result:
            lines.append(row_of(title if work is result[0] else "", rows, work, result[-1]))
        ratio = result[-1].median / result[1].median
        targets += [
            Target(
                work=f"{rows:,} of them, 2 threads, exact modes",
                goal=f">= {goal:,.0f} x SciPy DOP853", measured=f"{ratio:.0f} x",
                met=ratio >= goal, reason=WHY,
            )
            for goal in goals
        ]  # fmt: skip
    if many:
        rows_of, notes, goals_of = million(repeats, many)
        lines += rows_of
        targets += goals_of
    return Section(
        title="Many runs", heads=HEADS, rows=tuple(lines),
        notes=(*NOTES, *notes), targets=tuple(targets),
    )  # fmt: skip


NOTES = (
    "- The block on a spring with other stiffness, compression and friction in each run; the error"
    " is the largest of all last stops and final places, against the closed form. With Stribeck"
    f" friction it is that of the first {PART} runs, against SciPy at 1e-13. All runs are"
    " certified, which is part of the time.",
    f"- SciPy makes the first {PART} runs one after the other; its time is scaled to all. heyoka"
    " has no ensemble whose events are coded by hand without Python between, hence no entry.",
    "- Each thread keeps to a core.",
)
