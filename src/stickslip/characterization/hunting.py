"""An axis under PID control: whether it hunts about its target."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from typing_extensions import override

from stickslip.characterization.base import Characteristic
from stickslip.characterization.bench import Array, Bench
from stickslip.control import PID, closed_loop, limit_cycle
from stickslip.formatting import quantity
from stickslip.mechanisms import Axis

FASTER = 10.0
"""How much faster the loop is than that of the paper LuGre is from, whose cycles take 25 s."""
GAINS = (3.0 * FASTER**2, 4.0 * FASTER**3, 6.0 * FASTER)
"""Proportional, integral and derivative gain over the mass."""
PERIOD, LONG, SETTLED = 0.002, 30.0, 0.3
"""Time between samples and duration of the run [s]; share of it that is left out."""
FAR = 2.0
"""Distance of the target, over that at which the proportional part equals break-away."""
SAMPLES = 2001
LEAST = 1e-3
"""Amplitude over the distance of the target that counts as none."""
TOLERANCE = 0.1
"""Spread of cycles that are alike: they are long, and few in a run."""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Hunting(Characteristic):
    """The motion of an axis that a PID controller moves to a target."""

    test: ClassVar[str] = "limit-cycle"
    title: ClassVar[str] = "Hunting under PID control"
    columns: ClassVar[Mapping[str, str]] = {"t": "s", "position": "m"}
    over: ClassVar[str] = "t"

    t: Array
    """Times (n,) [s]."""
    position: Array
    """Position (n,) [m]."""
    target: float
    """Where the controller wants it to be [m]."""
    kind: str
    """What `stickslip.control.limit_cycle` says of the run after its beginning."""
    amplitude: float
    """Half of the range of the position in a cycle [m]; NaN without cycles."""
    period: float
    """Time of a cycle [s]; NaN without cycles."""
    error: float
    """Distance from the target at the end [m]."""

    @property
    @override
    def sentence(self) -> str:
        if self.kind in ("limit cycle", "growing", "irregular") and np.isfinite(self.amplitude):
            how = {"growing": ", and more from cycle to cycle", "irregular": " irregularly"}
            return (
                f"It hunts{how.get(self.kind, '')}: {quantity(self.amplitude, 'm')} to either side"
                f" of {quantity(self.target, 'm')} every {quantity(self.period, 's')}."
                " Less integral action, a dead band or compensation of friction ends it."
            )
        left = abs(self.error)
        if left <= LEAST * abs(self.target):
            return "It does not hunt: the integral part brings it to its target."
        ends = f"{quantity(left, 'm')} from its target of {quantity(self.target, 'm')}"
        what = "Its swing dies out" if self.kind == "decaying" else "No limit cycle is seen"
        return f"{what}: after {quantity(float(self.t[-1]), 's')} it is {ends}."


def hunting(bench: Bench, *, t_end: float = LONG) -> Hunting:
    """Move an axis to a target by a PID controller, and look for a limit cycle."""
    proportional, integral, derivative = (bench.mass * one for one in GAINS)
    target = FAR * bench.force / proportional
    loop = closed_loop(
        bench.on(Axis(inertia=bench.mass, load=bench.load)),
        bench.law,
        PID(proportional=proportional, integral=integral, derivative=derivative, reference=target),
        period=PERIOD,
        t_end=t_end,
        y0=bench.deflected(),
    )
    cycle = limit_cycle(loop, since=SETTLED * t_end, tolerance=TOLERANCE, least=LEAST * target)
    t = np.linspace(0.0, t_end, SAMPLES)
    position = loop.run.at(np.minimum(t, loop.run.span[1]))["x"]
    return Hunting(
        t=t,
        position=position,
        target=target,
        kind=cycle.kind,
        amplitude=cycle.amplitude,
        period=cycle.period,
        error=float(position[-1] - target),
        conditions=(
            f"{quantity(bench.mass, 'kg')}, K_p = {proportional:g}, K_i = {integral:g},"
            f" K_d = {derivative:g}, sampled every {quantity(PERIOD, 's')}, for"
            f" {quantity(t_end, 's')}."
        ),
    )
