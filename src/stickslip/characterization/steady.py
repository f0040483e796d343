"""Friction after long sliding at each velocity, and what the contact holds at rest."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from typing_extensions import override

from stickslip.characterization.base import Characteristic
from stickslip.characterization.bench import Array, Bench
from stickslip.formatting import quantity

DECADES = 2
"""Speeds are looked at so many decades below and above the one at which friction changes."""
SEEN = 2.0
"""Friction over the highest level, up to which they are looked at one decade farther."""
SAMPLES = 201
"""Speeds on each side."""
FALL = 0.01
"""Share of the force by which it has to fall for a drive to stick and slip."""
ROUNDING = 1e-9
"""Share of the force by which it has to fall, or to rise, to depend on speed."""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SteadyCurve(Characteristic):
    """The steady curve of a law."""

    test: ClassVar[str] = "steady"
    title: ClassVar[str] = "Steady sliding"
    columns: ClassVar[Mapping[str, str]] = {"velocity": "m/s", "force": "N"}
    over: ClassVar[str] = "velocity"

    velocity: Array
    """Slip velocity (n,) [m/s], from backwards to forwards; 0 is left out."""
    force: Array
    """Friction force (n,) [N]."""
    break_away: tuple[float, float]
    """Largest force at rest, backwards and forwards [N]."""
    holds: bool
    """Whether the body stays at rest under any smaller force."""

    @property
    @override
    def sentence(self) -> str:
        ahead, back = (self._side(side) for side in (1, -1))
        same = ahead == back
        return ahead if same else f"Forwards: {_lower(ahead)} Backwards: {_lower(back)}"

    def _side(self, side: int) -> str:
        """Return what one direction of slip says."""
        chosen = self.velocity * side > 0.0
        speed, force = np.abs(self.velocity[chosen]), np.abs(self.force[chosen])
        order = np.argsort(speed)
        speed, force = speed[order], force[order]
        rest = self.break_away[(side + 1) // 2]
        if rest <= 0.0:
            top = int(np.argmax(force >= 0.9 * force.max()))
            return (
                f"At rest it holds nothing: friction grows from 0 to {quantity(force[top], 'N')} at"
                f" {quantity(speed[top], 'm/s')}, so that a body never sticks."
            )
        low = int(np.argmin(force))
        start = max(rest, float(force[0]))
        if force[low] < (1.0 - FALL) * start:
            falls = force[0] >= (1.0 + FALL) * force[low]
            where = f" at {quantity(speed[low], 'm/s')}" if falls else ""
            what = "A drive that is soft can stick and slip"
            rises = " and rises beyond" if force[-1] > (1.0 + FALL) * force[low] else ""
            return (
                f"Break-away takes {quantity(start, 'N')}, sliding {quantity(force[low], 'N')}"
                f"{where}{rises}. {what}{' below this speed' if falls and rises else ''}."
            )
        begins = f"Break-away and slow sliding take {quantity(rest, 'N')}; friction"
        steps = np.diff(force) / force.max()
        if (steps < -ROUNDING).any():
            most = quantity(speed[-1], "m/s")
            return f"{begins} falls by no more than 1 % at speeds up to {most}."
        how = "grows with" if force[-1] > (1.0 + ROUNDING) * force[0] else "does not depend on"
        return f"{begins} {how} speed, so that steady sliding is stable."


def steady_curve(bench: Bench) -> SteadyCurve:
    """Return the steady curve of a law.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> print(steady_curve(Bench(law=law)).sentence)
    Break-away takes 1.5 N, sliding 1 N. A drive that is soft can stick and slip.
    """
    law, load = bench.curve, bench.load
    reach = 10.0**DECADES
    farther = np.abs(law.steady(bench.speed * 10.0 * reach * np.array([-1.0, 1.0]), load))
    slow = np.max(farther) <= SEEN * bench.levels[1]  # viscous friction is hardly seen before
    speeds = bench.speed * np.geomspace(1.0 / reach, 10.0 * reach if slow else reach, SAMPLES)
    velocity = np.concatenate([-speeds[::-1], speeds])
    force = np.asarray(law.steady(velocity, load), dtype=np.float64) + np.zeros_like(velocity)
    back, ahead = (float(law.towards(side).break_away(load)) for side in (-1, 1))
    least, most = (quantity(one, "m/s") for one in speeds[[0, -1]])
    return SteadyCurve(
        velocity=velocity,
        force=force,
        break_away=(back, ahead),
        holds=law.holds,
        conditions=f"{least} to {most} both ways, normal force {quantity(load, 'N')}.",
    )


def _lower(text: str) -> str:
    return text[0].lower() + text[1:]
