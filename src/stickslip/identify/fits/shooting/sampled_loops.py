"""Runs through a loop that samples: what it asks for follows from where the motion has come to."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip.data import LoopSamples
from stickslip.engine.solver import BareRun, EventDriven, IncrementalRun
from stickslip.friction import FrictionLaw
from stickslip.identify.fits.settings import ROUNDING
from stickslip.mechanisms import DCMotor, LoopMemory, Mechanism, SampledLoop, motor_of
from stickslip.mechanisms.drives import Sampled


@dataclass(frozen=True, kw_only=True, eq=False)
class LoopInSegment:
    """The loop of a motor in a segment of a record."""

    samples: LoopSamples
    """What it saw in the record."""
    start: float
    """First time of the segment in the record [s]."""

    def begun(
        self, loop: SampledLoop, limit: float
    ) -> tuple[int, list[tuple[float, float]], LoopMemory]:
        """Return its first sample in the segment, earlier commands (when they act), its memory.

        Before the segment it saw the measured motion.
        """
        times = self.samples.time - self.start
        first = int(np.searchsorted(times, -ROUNDING * loop.period))
        told, memories = self.samples.commands(loop, limit)
        acting = (times[:first] + loop.delay).tolist()
        return first, list(zip(acting, told[:first].tolist(), strict=True)), memories[first]


def run_through(
    solver: EventDriven,
    mechanism: Mechanism,
    law: FrictionLaw,
    seen: LoopInSegment,
    *,
    y0: Sequence[float],
    t_end: float,
) -> tuple[BareRun | None, Mechanism]:
    """Return a run whose loop sees its motion, None if it fails; and the mechanism it commands so.

    Slopes of the run are those under the same commands.
    """
    motor: Any = motor_of(mechanism)
    loop: SampledLoop = motor.loop
    limit = motor.largest_voltage
    first, acting, memory = seen.begun(loop, limit)
    sampled = dict(enumerate((seen.samples.time[first:] - seen.start).tolist(), first))
    sampled = {k: max(t, 0.0) for k, t in sampled.items() if t < t_end - ROUNDING * loop.period}
    later = {t + loop.delay for t in (*sampled.values(), *(t - loop.delay for t, _ in acting))}
    breaks = sorted({0.0, *sampled.values(), *(t for t in later if 0.0 < t < t_end)})
    breaks = [t for t, after in zip(breaks, [*breaks[1:], t_end], strict=True) if after > t]
    at = {t: k for k, t in sampled.items()}
    onward = IncrementalRun(
        _told(mechanism, motor, breaks, [0.0] * len(breaks)),
        law,
        drives=["drive"],
        y0=y0,
        t_end=t_end,
        solver=solver,
    )
    values = []
    for t, end in zip(breaks, [*breaks[1:], t_end], strict=True):
        if t in at:
            goal = float(seen.samples.goal[at[t]])
            voltage, memory = loop.sampled(goal, onward.state()[0], memory, limit=limit)
            acting.append((t + loop.delay, voltage))
        values.append(next((u for when, u in reversed(acting) if when <= t + ROUNDING), 0.0))
        if not onward.advance(end, [(values[-1], 0.0)]):
            return None, mechanism
    told = _told(mechanism, motor, breaks, values)
    run = onward.bare(told)
    return (run if run.status.complete else None), told


def without_steps(mechanism: Mechanism) -> Mechanism:
    """Return a mechanism whose loop rounds nothing, so that its runs have slopes."""
    motor: Any = motor_of(mechanism)
    smooth = replace(motor, loop=replace(motor.loop, step=None, encoder_step=None))
    return replace(mechanism, drive=smooth)  # type: ignore[call-arg]  # it has one


def _told(
    mechanism: Mechanism, motor: DCMotor, times: Sequence[float], values: Sequence[float]
) -> Mechanism:
    """Return a mechanism whose motor is told voltages, which are within limits."""
    droops = motor.supply_resistance is not None
    told = replace(
        motor,
        loop=None,
        supply=motor.supply if droops else None,
        drive=Sampled(times=tuple(times), values=tuple(values)),
    )
    return replace(mechanism, drive=told)  # type: ignore[call-arg]  # it has one
