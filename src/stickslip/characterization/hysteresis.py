"""Small displacements to and fro: what deflects before it slips, and what it remembers."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal, final

import numpy as np
from typing_extensions import override

from stickslip.characterization.base import Characteristic
from stickslip.characterization.bench import Array, Bench, there_and_back
from stickslip.formatting import quantity
from stickslip.simulation import simulate

SLOW, SLOW_ENOUGH = 1e-4, 1e-2
"""Highest speed on the path over the one at which friction changes, so that only the path matters:
wanted, and allowed."""
LONG = 100.0
"""Time of a way as long as the amplitude for which the allowed speed is taken rather [s]."""
BRIEF = 1.0
"""The same of a contact that neither deflects nor holds, whose friction follows the speed alone:
small smoothing velocities ask for so many steps that a longer way ends a run early [s]."""
TURNS = (1.0, -1.0, 0.5, -0.25, 0.5, -1.0, 1.0)
"""Where the path turns, over its amplitude; the inner loop goes from the third and back to it."""
INNER = (0.8, 0.4, 0.8)
"""The same on first loading, where the memory is tested, over the presliding length."""
POINTS = 120
"""Points on each way."""
KEPT = 1e-3
"""Change of the force after a closed inner loop, over break-away, from which it is one."""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Presliding(Characteristic):
    """Friction along a slow path to and fro, with a closed inner loop."""

    test: ClassVar[str] = "presliding"
    title: ClassVar[str] = "Presliding and memory"
    columns: ClassVar[Mapping[str, str]] = {"displacement": "m", "force": "N"}

    displacement: Array
    """Displacement (n,) [m]."""
    force: Array
    """Friction force (n,) [N]."""
    reversals: Array
    """Displacements at which the path turns (m,) [m]."""
    length: float
    """Displacement at which the first stiffness reaches break-away [m]; 0 if nothing deflects."""
    change: float
    """Force after a closed inner loop less the force before, on first loading [N]."""
    memory: Literal["local", "non-local", "none"]
    """Whether the force returns after a closed inner loop; none if nothing deflects."""
    sticks: bool
    """Whether some force leaves the body at rest."""

    @property
    @override
    def sentence(self) -> str:
        if not self.sticks:
            return (
                "It neither deflects nor holds: at small velocities there is next to no friction,"
                " so that reversals are smoother than measured ones."
            )
        if self.memory == "none":
            return (
                "It does not deflect: below break-away the contact is rigid, so that no force"
                " springs back when a motion turns."
            )
        deflects = f"It deflects by some {quantity(self.length, 'm')} before it slides"
        if self.memory == "non-local":
            return (
                f"{deflects}. After a closed inner loop the force is the one before: its memory is"
                " non-local, as that of measured contacts is."
            )
        way = "less" if self.change < 0.0 else "more"
        return (
            f"{deflects}. After a closed inner loop the force is"
            f" {quantity(abs(self.change), 'N')} {way} than before: its memory is local, so that"
            " small swings on top of a motion are predicted wrongly."
        )


def presliding(
    bench: Bench, *, amplitude: float | None = None, inner: tuple[float, float] | None = None
) -> Presliding:
    """Move the contact slowly along a path that turns, and test its memory.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=1.5, bristle_stiffness=1e5, viscous_coefficient=0.4)
    >>> found = presliding(Bench(law=law), inner=(1.2e-5, 0.6e-5))
    >>> found.memory, round(found.change, 3)
    ('local', -0.292)
    """
    reach = 2.0 * bench.reach if amplitude is None else amplitude
    wanted, allowed = SLOW * bench.speed, SLOW_ENOUGH * bench.speed
    if amplitude is None and not (bench.law.states or bench.sticks):
        reach = min(reach, BRIEF * allowed)
    speed = min(max(wanted, reach / LONG), allowed) if bench.law.states else allowed
    turns = reach * np.array(TURNS)
    x, force = _followed(bench, turns, speed)
    change = 0.0
    memory: Literal["local", "non-local", "none"] = "none"
    if bench.length > 0.0:
        begins, to = inner or (INNER[0] * bench.length, INNER[1] * bench.length)
        change = _changed(bench, begins, to, speed)
        local = abs(change) > KEPT * bench.levels[1]
        memory = "local" if local else "non-local"
    return Presliding(
        displacement=x,
        force=force,
        reversals=turns,
        length=bench.length,
        change=change,
        memory=memory,
        sticks=bench.sticks,
        conditions=(
            f"{quantity(reach, 'm')} to and fro at no more than {quantity(speed, 'm/s')}, normal"
            f" force {quantity(bench.load, 'N')}."
        ),
    )


def _followed(bench: Bench, turns: Array, speed: float) -> tuple[Array, Array]:
    """Return displacement and friction along a path."""
    path, arrivals = there_and_back([*turns], speed)
    run = simulate(bench.guided(path), bench.law, t_end=arrivals[-1], y0=bench.deflected())
    share = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, POINTS))  # even steps of displacement
    starts = np.concatenate([[0.0], arrivals[:-1]])
    times = np.concatenate([a + (b - a) * share[1:] for a, b in zip(starts, arrivals, strict=True)])
    times = np.union1d(times, run.t)  # steps end where a contact gives way
    seen = run.at(np.minimum(times, run.span[1]))
    return seen["x"], seen["friction"]


def _changed(bench: Bench, begins: float, to: float, speed: float) -> float:
    """Return by how much a closed inner loop changes the force."""
    path, arrivals = there_and_back([begins, to, begins], speed)
    run = simulate(bench.guided(path), bench.law, t_end=arrivals[-1], y0=bench.deflected())
    before, after = run.at(np.minimum(arrivals[[0, 2]], run.span[1]))["friction"]
    return float(after - before)
