"""What first calls wait for: compiling in an empty cache, loading in a full one; later calls."""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from benchmarks import decay, lugre
from benchmarks.measuring import Section
from stickslip import Coulomb, CoulombViscous, EventDriven, Stribeck, simulate
from stickslip.engine.solver import prepare
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism

MU = decay.MU
PAIRS: tuple[tuple[str, Mechanism, FrictionLaw], ...] = (
    ("SpringBlock, Coulomb: the first pair", decay.RIG, Coulomb(kinetic_coefficient=MU)),
    (
        "SpringBlock, Coulomb and viscous: a further law",
        decay.RIG,
        CoulombViscous(kinetic_coefficient=MU, viscous_coefficient=0.1),
    ),
    (
        "SpringBlock, Stribeck: a further law with switches",
        decay.RIG,
        Stribeck(kinetic_coefficient=MU, static_coefficient=1.2 * MU, stribeck_velocity=0.01),
    ),
    ("SpringBlock, LuGre: a further law with bristles", decay.RIG, lugre.LAW),
    ("TowedBlock, LuGre: a further mechanism", lugre.BLOCK, lugre.LAW),
)
LONG, CALLS = 60.0, 3
"""Length of a run [s], and calls of it."""
TIMES = np.linspace(0.0, LONG, 1201)
TOLERANCES = (1e-8, 1e-9, 1e-10)
EXACT = EventDriven(tier="compiled", stiff_tolerance=1e-13)
HEADS = ("pair", "compiled in an empty cache, s", "loaded by the next process, s")


def child(count: int) -> None:
    """Make the first pairs ready, one after the other, and print how long each took."""
    seconds = []
    for _, mechanism, law in PAIRS[:count]:
        start = time.perf_counter()
        prepare(mechanism, law)
        seconds.append(time.perf_counter() - start)
    print(json.dumps(seconds))


def calls(count: int) -> None:
    """Run a towed block as users do, again and again, and print how long each call took."""
    seconds = []
    for _ in range(count):
        start = time.process_time()
        result = simulate(lugre.BLOCK, lugre.LAW, t_end=LONG)
        seconds.append(time.process_time() - start)
    exact = simulate(lugre.BLOCK, lugre.LAW, t_end=LONG, solver=EXACT).at(TIMES)["x"]
    errors = [float(np.abs(result.at(TIMES)["x"] - exact).max())]
    for tolerance in TOLERANCES:
        start = time.process_time()
        lugre.by_scipy("LSODA", tolerance, t_end=LONG)
        seconds.append(time.process_time() - start)
        x = lugre.by_scipy("LSODA", tolerance, TIMES, t_end=LONG).y[0]
        errors.append(float(np.abs(x - exact).max()))
    print(json.dumps([seconds, errors]))


def in_child(folder: str, count: int) -> list[float]:
    return told_by_child(f"from benchmarks.compiling import child; child({count})", folder)


def calls_in_child(folder: str, count: int) -> list[list[float]]:
    return told_by_child(f"from benchmarks.compiling import calls; calls({count})", folder)


def told_by_child(text: str, folder: str | None = None) -> Any:
    """Return what a process prints, whose machine code is in a folder if one is given."""
    place = {} if folder is None else {"STICKSLIP_CACHE": folder}
    run = subprocess.run(
        [sys.executable, "-c", text], check=True, capture_output=True, text=True,
        env={**os.environ, **place},
    )  # fmt: skip
    return json.loads(run.stdout)


def run(
    count: int = len(PAIRS), timed: Callable[[str, int], Sequence[float]] = in_child
) -> Section:
    """Run the case, or the first pairs of it."""
    with tempfile.TemporaryDirectory() as folder:
        cold, warm = timed(folder, count), timed(folder, count)
    names = [name for name, _, _ in PAIRS[:count]]
    return Section(
        title="Compiling",
        heads=HEADS,
        rows=tuple(
            (name, f"{a:#.3g}", f"{b:#.3g}") for name, a, b in zip(names, cold, warm, strict=True)
        ),
        notes=("- One process after the other; the first begins with an empty cache.",),
    )


def default_calls(timed: Callable[[str, int], list[list[float]]] = calls_in_child) -> Section:
    """Time calls without any setting in a process that finds machine code, beside SciPy's LSODA."""
    with tempfile.TemporaryDirectory() as folder:
        in_child(folder, len(PAIRS))
        seconds, (own, *others) = timed(folder, CALLS)
    rows = [
        (f"call {i + 1}", f"{1e3 * s:.3g}", f"{own:.1e}") for i, s in enumerate(seconds[:CALLS])
    ]
    third = seconds[CALLS - 1]
    for tolerance, s, error in zip(TOLERANCES, seconds[CALLS:], others, strict=True):
        name = f"LSODA by hand, tolerance {tolerance:.0e}: {s / third:.1f} x the third call"
        rows.append((name, f"{1e3 * s:.3g}", f"{error:.1e}"))
    return Section(
        title=f"simulate(...) of a towed block with LuGre friction, {LONG:g} s, default settings",
        heads=("call", "processor time, ms", "error of the position, m"),
        rows=tuple(rows),
        notes=("- The first call loads machine code that an earlier process has left.",),
    )
