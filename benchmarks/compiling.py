"""What the first run of a pair waits for: compiling in an empty cache, loading in a full one."""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence

from benchmarks import decay, lugre
from benchmarks.measuring import Section
from stickslip import Coulomb, CoulombViscous, Stribeck
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.solver import prepare

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
HEADS = ("pair", "compiled in an empty cache, s", "loaded by the next process, s")


def child(count: int) -> None:
    """Make the first pairs ready, one after the other, and print how long each took."""
    seconds = []
    for _, mechanism, law in PAIRS[:count]:
        start = time.perf_counter()
        prepare(mechanism, law)
        seconds.append(time.perf_counter() - start)
    print(json.dumps(seconds))


def in_child(folder: str, count: int) -> list[float]:
    text = f"from benchmarks.compiling import child; child({count})"
    run = subprocess.run(
        [sys.executable, "-c", text], check=True, capture_output=True, text=True,
        env={**os.environ, "STICKSLIP_CACHE": folder},
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
