"""Several contacts: blocks that come to rest, an arm and clutches, in stickslip and elsewhere."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from benchmarks.measuring import Missing, Section, Target, with_times
from benchmarks.peers import Engine, found, processor_time
from benchmarks.several import by_scipy, by_stickslip
from benchmarks.several.problem import CASES, Case, Run, chain
from benchmarks.tables import milliseconds, ratio_of

GOALS = {2: 0.15, 10: 1.2, 30: 6.0, 100: 45.0}
"""Time of the kernel that a chain of so many blocks was meant to take [ms]."""
ARM_GOAL = 1.5
"""The same of the arm at 1e-9 [ms]."""
OVER_SICONOS = 300
"""Times that ten blocks were meant to be faster than Siconos at its error of 1e-4."""
RUNS = 40
"""Runs of which the least time is taken, or as many as fit into the budget."""
LONGEST = 30
"""Blocks of the longest chain that SciPy runs."""
HEADS = ("case", "engine", "levels", "error", "processor time, ms", "over the kernel's")
WHY = "a step of DOP853 evaluates all laws and factorises the mass matrix some 35 times"
LONG = "decisions, guards and records of all contacts for each event"
NOTES = (
    "- Blocks of 1 kg, 100 N/m between neighbours and 10 N/m to the ground, until rest; an arm of"
    " two links that falls for 6 s; four rotors and three clutches (Modelica's CoupledClutches)."
    " Arm and clutches have static levels above the kinetic ones.",
    "- Error: largest difference of the last places [m, rad] from Taylor series of order 26 in"
    " numbers of 80 bits (10 and 100 blocks: the first and the last), from SciPy at 1e-13 with"
    " bordered matrices (arm), and from a closed form between events (clutches). Of 2 and 30"
    " blocks it is the difference from SciPy by hand.",
    "- SciPy: `solve_ivp` with one terminal event, modes and decisions by hand. MuJoCo:"
    " `frictionloss`, which has one level. Drake: balls on the ground, for its joints have no dry"
    " friction. Siconos: relays, in a process of its own, for it needs the NumPy of its package.",
    "- Least processor time of the runs, which other work on the machine lengthens least. No"
    " Modelica tool is among them: neither Debian nor PyPI has one that runs CoupledClutches.",
)


@dataclass(frozen=True, kw_only=True)
class Timed:
    """One engine on one case."""

    solver: str
    levels: str
    error: float
    """Largest difference of the last places [m, rad]."""
    run: Run = field(repr=False, compare=False)
    times: tuple[float, ...] = ()
    """Times of the runs after the first [s]."""

    @property
    def least(self) -> float:
        return min(self.times)


def timed(case: Case, engine: Engine) -> Timed:
    """Run an engine once."""
    run = engine.build()
    return Timed(solver=engine.name, levels=engine.levels, error=case.error(run()), run=run)


def compared(name: str, repeats: int) -> list[Timed | Missing]:
    """Return all engines on a case, stickslip first."""
    case = CASES[name]()
    engines = [*by_stickslip.engines(name, case), *found("several", name, case)]
    entries = [e if isinstance(e, Missing) else timed(case, e) for e in engines]
    return list(with_times(entries, repeats, processor_time))


def alone(n: int, repeats: int) -> list[Timed]:
    """Return the kernel on a chain, and SciPy where it is not too long for it."""
    case = chain(n)
    own, *_ = by_stickslip.engines("chain", case)
    entries = [timed(case, own)] if case.exact else []
    if n <= LONGEST:
        (peer,) = by_scipy.engines("chain", case, (1e-12,))
        run, other = own.build(), peer.build()
        apart = float(np.abs(run() - other()).max())
        entries = [
            Timed(solver=engine.name, levels=engine.levels, error=apart, run=call)
            for engine, call in ((own, run), (peer, other))
        ]
    return list(with_times(entries, repeats, processor_time))


def rows_of(title: str, entries: Sequence[Timed | Missing]) -> list[tuple[str, ...]]:
    """Return the rows of a case."""
    own, rows = entries[0].least, []
    for entry in entries:
        head = title if entry is entries[0] else ""
        if isinstance(entry, Missing):
            rows.append((head, entry.solver, entry.word, "", "", ""))
        else:
            cells = f"{entry.error:.1e}", milliseconds(entry.least), ratio_of(entry.least / own)
            rows.append((head, entry.solver, entry.levels, *cells))
    return rows


def goal(work: str, most: float, entry: Timed, reason: str) -> Target:
    """Return the target of a time [ms]."""
    ms = 1e3 * entry.least
    return Target(
        work=work, goal=f"<= {most:g} ms", measured=f"{ms:.3g} ms", met=ms <= most, reason=reason
    )


def over_siconos(entries: Sequence[Timed | Missing]) -> list[Target]:
    """Return the target of being faster than Siconos at the larger of its steps, if it is there."""
    times = {e.solver: e.least for e in entries if isinstance(e, Timed)}
    ratios = [time / entries[0].least for name, time in times.items() if name.startswith("Siconos")]
    return [
        Target(
            work="10 coupled blocks", goal=f">= {OVER_SICONOS} x Siconos", measured=f"{x:.0f} x",
            met=x >= OVER_SICONOS, reason=LONG,
        )
        for x in ratios[:1]
    ]  # fmt: skip


def run(repeats: int = RUNS) -> Section:
    """Run the case."""
    peers = {name: compared(name, repeats) for name in CASES}
    chains = {n: peers["chain"] if n == 10 else alone(n, repeats) for n in GOALS}
    rows = [row for n, entries in chains.items() for row in rows_of(f"{n} blocks", entries)]
    for name in ("arm", "clutches"):
        rows += rows_of(name, peers[name])
    targets = [
        goal(f"{n} coupled blocks, kernel", GOALS[n], entries[0], LONG)
        for n, entries in chains.items()
    ]
    targets += [
        *over_siconos(peers["chain"]),
        goal("arm, 6 s, tolerance 1e-9, kernel", ARM_GOAL, peers["arm"][0], WHY),
    ]
    missing = [e for entries in peers.values() for e in entries if isinstance(e, Missing)]
    reasons = dict.fromkeys(f"- {e.solver}: {e.word}: {e.reason}." for e in missing)
    return Section(
        title="Several contacts",
        heads=HEADS,
        rows=tuple(rows),
        notes=(*NOTES, *reasons),
        targets=tuple(targets),
    )
