"""A mechanism and its friction as blocks of a diagram, evaluated literally."""

import bisect
from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Self

from stickslip.formulation import formulate
from stickslip.friction import BristleLaw, Coulomb, FrictionLaw, PrintedForm, SetValuedLaw
from stickslip.mechanisms import Mechanism
from stickslip.solver.modules import load
from stickslip.solver.tables import Inputs, gather

__all__ = ["Diagram"]


@dataclass(frozen=True)
class Diagram:
    """Evaluates forces and rates at a time and a state, as often as asked and nothing else."""

    module: ModuleType
    inputs: Inputs
    law: FrictionLaw | PrintedForm
    bristles: tuple[str, ...]
    slip: int
    """Index of the slip velocity in the state."""

    @classmethod
    def build(cls, mechanism: Mechanism, law: FrictionLaw | PrintedForm) -> Self:
        """Take the mechanism's own equations; any law serves to formulate them."""
        stand_in = Coulomb(kinetic_coefficient=0.0)
        model = formulate(mechanism, stand_in)
        module = load(model)
        bristles = () if isinstance(law, SetValuedLaw) else _bristles(law)
        return cls(module, gather(mechanism, stand_in, model), law, bristles, module.SLIP)

    def _loaded(self, t: float) -> list[float]:
        """Return the parameters with the drives' piece at a time."""
        p, table = self.inputs.p, self.inputs.table
        width = 1 + 3 * self.module.N_DRIVES
        row = bisect.bisect_right(range(len(table) // width), t, key=lambda i: table[i * width]) - 1
        self.module.load_piece(table, max(row, 0), p)
        return p

    def _free(self, t: float, y: Sequence[float], friction: float) -> list[float]:
        """Return accelerations, normal force and needed friction for a friction force."""
        p = self._loaded(t)
        flags = self._flags(t, y, p)
        out = [0.0] * (self.module.N_COORDINATES + 2)
        self.module.diagram(flags, t, y, p, [friction], out)
        return out

    def _flags(self, t: float, y: Sequence[float], p: list[float]) -> int:
        room = [0.0] * (self.module.N_SWITCHES + 1)
        return int(self.module.set_flags(t, y, p, 0, room))

    def _split(self, y: Sequence[float]) -> tuple[float, tuple[float, ...]]:
        return y[self.slip], tuple(y[self.module.N_STATES :][: len(self.bristles)])

    def friction(self, t: float, y: Sequence[float], held: bool) -> tuple[float, float]:
        """Return friction and normal force; the normal force is that without friction."""
        *_, normal, needed = self._free(t, y, 0.0)
        if held:
            return needed, normal
        v, z = self._split(y)
        if isinstance(self.law, PrintedForm):
            return self.law.force(v, z, normal, needed), normal
        if isinstance(self.law, BristleLaw):
            return self.law.force(v, z, normal), normal
        assert isinstance(self.law, SetValuedLaw)
        return self.law.force(v, normal), normal

    def holds(self, t: float, y: Sequence[float]) -> bool:
        """Whether the contact can hold the body, by the law's own rule."""
        *_, normal, needed = self._free(t, y, 0.0)
        if isinstance(self.law, PrintedForm):
            _, z = self._split(y)
            return self.law.force(0.0, z, normal, needed) == needed
        if isinstance(self.law, BristleLaw) and not self.law.static_switch:
            return False
        return bool(abs(needed) <= self.law.break_away(normal))

    def rates(self, t: float, y: Sequence[float], held: bool) -> list[float]:
        """Return the time derivatives of the state."""
        friction, normal = self.friction(t, y, held)
        n = self.module.N_COORDINATES
        *accelerations, _, _ = self._free(t, y, friction)
        v, z = self._split(y)
        if held:
            accelerations[self.slip - n] = 0.0
        bristle_rates: tuple[float, ...] = (0.0,) * len(z)
        if z and not held and not isinstance(self.law, SetValuedLaw):
            bristle_rates = _bristle_rates(self.law, v, z, normal)
        return [*y[n : 2 * n], *accelerations, *bristle_rates]

    def sample(self, t: float, y: Sequence[float], held: bool) -> list[float]:
        """Return time, state, friction force, normal force and mode."""
        friction, normal = self.friction(t, y, held)
        v = y[self.slip]
        return [t, *y, friction, normal, 0.0 if held else float((v > 0) - (v < 0))]

    def energy(self, t: float, y: Sequence[float]) -> float:
        """Return the mechanical energy [J]."""
        p = self._loaded(t)
        out = [0.0]
        self.module.energy(self._flags(t, y, p), t, y, p, out)
        return out[0]

    def power(self, t: float, row: Sequence[float]) -> tuple[float, float]:
        """Return the power supplied and that taken by friction [W], for a state and its forces."""
        p = self._loaded(t)
        out = [0.0] * 2
        self.module.power(1, self._flags(t, row, p), t, row, p, out)
        friction = row[-3]
        return out[0], friction * row[self.slip]


def _bristles(law: FrictionLaw | PrintedForm) -> tuple[str, ...]:
    return law.bristles if isinstance(law, (BristleLaw, PrintedForm)) else ()


def _bristle_rates(
    law: FrictionLaw | PrintedForm, v: float, z: tuple[float, ...], load: float
) -> tuple[float, ...]:
    assert isinstance(law, (BristleLaw, PrintedForm))
    rates: tuple[float, ...] = law.bristle_rates(v, z, load)
    return rates
