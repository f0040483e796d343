"""What a law costs a solver: steps of a run, and the fastest rate of its equations."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from typing_extensions import override

from stickslip.characterization.base import Characteristic
from stickslip.characterization.bench import Array, Bench
from stickslip.characterization.stick_slip import slopes_at
from stickslip.drives import Sine
from stickslip.formatting import number, quantity
from stickslip.mechanisms import Axis
from stickslip.simulation import simulate

FORCE, FREQUENCY, LONG = 2.0, 1.0, 5.0
"""Amplitude of the force over break-away, its frequency [Hz] and the time of the run [s]."""
DECADES, SPEEDS = 3, 61
"""Speeds at which rates are looked at: so many decades about the one at which friction changes."""
EXPLICIT = 2.0
"""Rate times step up to which Euler's explicit method is stable."""
EASY = 1e3
"""Rate that fixed steps of milliseconds follow [1/s]."""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Cost(Characteristic):
    """Steps of a run to and fro, and the fastest rates of the equations."""

    test: ClassVar[str] = "cost"
    title: ClassVar[str] = "Stiffness and cost"
    columns: ClassVar[Mapping[str, str]] = {"speed": "m/s", "rate": "1/s"}
    over: ClassVar[str] = "speed"

    steps: int
    """Steps of the event-driven solver."""
    events: int
    """Events that it located."""
    speed: Array
    """Slip speeds (n,) [m/s]."""
    rate: Array
    """Largest rate of the equations at each (n,) [1/s]."""

    @property
    def largest_rate(self) -> float:
        """Largest rate at any speed [1/s]; NaN if none is known."""
        return float(self.rate.max()) if len(self.rate) else np.nan

    @property
    @override
    def sentence(self) -> str:
        fast = self.largest_rate
        run = (
            f"{number(self.steps)} steps and {self.events} events for {quantity(LONG, 's')} to and"
            " fro"
        )
        if np.isnan(fast):
            return f"{run}."
        step = EXPLICIT / fast if fast > 0.0 else np.inf
        if fast < EASY:
            need = "fixed steps of a millisecond follow it between its events"
        else:
            need = f"explicit fixed steps must be shorter than {quantity(step, 's')}"
        rate = f"the fastest rate is {number(fast)} per second" if fast else "no rate is fast"
        return f"{run}; {rate}, so that {need}."


def cost(bench: Bench) -> Cost:
    """Count the steps of a run to and fro, and find the fastest rate of the equations.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> cost(Bench(law=Coulomb(kinetic_coefficient=0.5))).largest_rate
    0.0
    """
    force = FORCE * bench.force
    axis = Axis(
        inertia=bench.mass, drive=Sine(amplitude=force, frequency=FREQUENCY), load=bench.load
    )
    run = simulate(bench.on(axis), bench.law, t_end=LONG, y0=bench.deflected())
    speeds = bench.speed * np.geomspace(10.0**-DECADES, 10.0**DECADES, SPEEDS)
    between = f"from {quantity(speeds[0], 'm/s')} to {quantity(speeds[-1], 'm/s')}"
    if bench.latched:
        speeds = speeds[:0]
    rates = [float(np.abs(np.linalg.eigvals(slopes_at(bench, float(v)))).max()) for v in speeds]
    return Cost(
        steps=run.certificate.steps,
        events=len(run.events),
        speed=speeds,
        rate=np.array(rates),
        conditions=(
            f"{quantity(bench.mass, 'kg')} under a force of {quantity(force, 'N')} at"
            f" {quantity(FREQUENCY, 'Hz')}; rates about steady sliding"
            f" {between if len(speeds) else 'are not known with latched switches'}."
        ),
    )
