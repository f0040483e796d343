"""How friction lags behind a velocity that swings about a mean."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from typing_extensions import override

from stickslip.characterization.base import Characteristic
from stickslip.characterization.bench import Array, Bench
from stickslip.drives import Sine
from stickslip.formatting import quantity
from stickslip.simulation import simulate

FREQUENCIES = (1.0 / (2.0 * np.pi), 25.0 / (2.0 * np.pi))
"""Frequencies of the velocity [Hz]: those of the paper that LuGre is from."""
MEAN, SWING = 1.5, 1.0
"""Mean and amplitude of the velocity, over the one at which friction changes."""
CYCLES = 5
POINTS = 201
NOTHING = 1e-3
"""Width over the force that counts as none."""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Lag(Characteristic):
    """Loops of friction against a velocity that swings and does not change its sign."""

    test: ClassVar[str] = "lag"
    title: ClassVar[str] = "Frictional lag"
    columns: ClassVar[Mapping[str, str]] = {"frequency": "Hz", "velocity": "m/s", "force": "N"}

    frequency: Array
    """Frequencies (n,) [Hz]."""
    velocity: Array
    """Slip velocity in the last cycle at each frequency (n, m) [m/s]."""
    force: Array
    """Friction force then (n, m) [N]."""
    slowing: Array
    """Force at the speed at which friction changes, while the body slows down (n,) [N]."""
    gaining: Array
    """The same while it becomes faster (n,) [N]."""

    @property
    def width(self) -> Array:
        """Force while gaining speed less force while slowing down (n,) [N]."""
        return self.gaining - self.slowing

    @property
    @override
    def sentence(self) -> str:
        i = int(np.argmax(np.abs(self.width)))
        at = quantity(self.frequency[i], "Hz")
        if abs(self.width[i]) < NOTHING * abs(self.gaining[i]):
            return (
                "Friction follows the velocity without lag: what it does at a speed does not depend"
                " on whether the body becomes faster or slower."
            )
        order = "more" if self.width[i] > 0.0 else "less"
        return (
            f"Friction lags behind the velocity: at {at} it is"
            f" {quantity(abs(self.width[i]), 'N')} {order} while the body becomes faster than while"
            " it slows down, which damps stick-slip."
            if order == "more"
            else f"Friction runs ahead of the velocity: at {at} it is"
            f" {quantity(abs(self.width[i]), 'N')} less while the body becomes faster than while it"
            " slows down."
        )

    @override
    def _values(self) -> Mapping[str, Array]:
        return {
            "frequency": np.repeat(self.frequency, self.velocity.shape[1]),
            "velocity": self.velocity.ravel(),
            "force": self.force.ravel(),
        }


def lag(bench: Bench, *, frequencies: Sequence[float] = FREQUENCIES) -> Lag:
    """Move the contact at a velocity that swings about a mean, and record its friction.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> print(lag(Bench(law=Coulomb(kinetic_coefficient=1.0))).sentence[:46])
    Friction follows the velocity without lag: wha
    """
    velocities, forces, levels = [], [], []
    swing = SWING * bench.speed
    for frequency in frequencies:
        omega = 2.0 * np.pi * frequency
        slowing = np.arccos((1.0 - MEAN) / SWING) / (2.0 * np.pi)
        if not bench.law.states:  # friction is a function of the velocity: no run is needed
            shares = np.concatenate([np.linspace(0.0, 1.0, POINTS), [slowing, 1.0 - slowing]])
            v = bench.speed * (MEAN + SWING * np.cos(2.0 * np.pi * shares))
            force = np.asarray(bench.curve.steady(v, bench.load)) + np.zeros_like(v)
            velocities.append(v[:-2])
            forces.append(force[:-2])
            levels.append(force[-2:])
            continue
        path = Sine(amplitude=swing * omega, frequency=frequency, phase=np.pi)
        start = (MEAN + SWING) * bench.speed
        contact = bench.guided(path, rate=start)
        period = 1.0 / frequency
        run = simulate(contact, bench.law, t_end=CYCLES * period, y0=bench.deflected(0.5))
        seen = run.at(np.linspace((CYCLES - 1) * period, run.span[1], POINTS))
        velocities.append(seen["v"])
        forces.append(seen["friction"])
        times = (CYCLES - 1 + slowing) * period, (CYCLES - slowing) * period
        levels.append(run.at(times)["friction"])
    slow, fast = (quantity(one * bench.speed, "m/s") for one in (MEAN - SWING, MEAN + SWING))
    return Lag(
        frequency=np.array(frequencies, dtype=np.float64),
        velocity=np.array(velocities),
        force=np.array(forces),
        slowing=np.array(levels)[:, 0],
        gaining=np.array(levels)[:, 1],
        conditions=(
            f"Velocity between {slow} and {fast}, compared at {quantity(bench.speed, 'm/s')};"
            f" normal force {quantity(bench.load, 'N')}."
        ),
    )
