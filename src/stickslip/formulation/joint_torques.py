"""The forces that a motion takes: the equations of a mechanism, solved for what drives it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Self, final

import numpy as np
import symengine as se
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.formulation.mechanics import lagrange_rows
from stickslip.formulation.trace import Switchboard, Traced, collapsed
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, shadow

Array = NDArray[np.float64]


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class JointTorques:
    """Forces along the coordinates of a mechanism that a motion without friction takes.

    They are ``M q'' - h``, from the same trace of the energies that simulations are made from, and
    their slopes by parameters in which they are linear.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> swing = Pendulum(mass=0.5, length=0.6)
    >>> takes = JointTorques.of(swing, ["mechanism.mass"])
    >>> place, rate, acceleration = np.array([[0.3]]), np.array([[0.0]]), np.array([[2.0]])
    >>> forces, slopes = takes.along(swing, np.zeros(1), place, rate, acceleration)
    >>> round(float(forces[0, 0]), 6), round(float(slopes[0, 0, 0]), 6)
    (1.229716, 2.459432)
    """

    coordinates: tuple[str, ...]
    """Names of the coordinates (m,)."""
    linear: tuple[str, ...]
    """Paths of the parameters that slopes are by (k,)."""
    paths: tuple[str, ...]
    """Paths of all parameters that stand in the equations."""
    bent: bool = False
    """Whether the forces are not linear in these parameters together."""
    by_position: bool = False
    """Whether slopes by the coordinates stand behind those by parameters."""
    _function: Any = field(repr=False)
    """Forces (m,) and their slopes (m, k) from time, motion and parameters."""

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        linear: Sequence[str],
        *,
        by_position: bool = False,
    ) -> Self:
        """Derive the forces, and find whether they are linear in some parameters.

        Where they are not, slopes are those at the values of the mechanism.
        """
        board = Switchboard()
        known = [path for path, _, _ in parameters(mechanism, "mechanism")]
        symbol = {path: se.Symbol(f"p{i}") for i, path in enumerate(known)}
        twin = shadow(mechanism, "mechanism", lambda path: Traced(symbol[path], board))
        t = se.Symbol("t")
        q, rates, accelerations = (
            {name: se.Symbol(f"{letter}{i}") for i, name in enumerate(mechanism.coordinates)}
            for letter in ("q", "u", "a")
        )
        drives = {name: se.Symbol(f"d{i}") for i, name in enumerate(mechanism.drives())}
        rows = lagrange_rows(twin, t, q, rates, drives, mechanism.held(), board)
        undriven = dict.fromkeys(drives.values(), 0)
        if any(one.hold is not None for one in board.switches.values()):
            raise InputError(
                f"{type(mechanism).__name__} has latched switches, which a measured motion does not"
                " tell of: use stickslip.maths.where."
            )
        shown = {one.symbol: one.margin for one in board.switches.values()}
        count = len(q)
        forces = []
        for row, force in zip(rows.mass[:count], rows.forces[:count], strict=True):
            taken = sum(
                (entry * a for entry, a in zip(row, accelerations.values(), strict=True)),
                se.Integer(0),
            )
            forces.append((taken - force).subs(undriven).subs(shown))
        slopes = [[collapsed(force.diff(symbol[path])) for path in linear] for force in forces]
        bent = _are_bent(slopes, [symbol[path] for path in linear])
        if by_position:
            for row, force in zip(slopes, forces, strict=True):
                row += [collapsed(force.diff(place)) for place in q.values()]
        arguments = [
            t, *q.values(), *rates.values(), *accelerations.values(), *symbol.values()
        ]  # fmt: skip
        return cls(
            coordinates=mechanism.coordinates,
            linear=tuple(linear),
            paths=tuple(known),
            bent=bent,
            by_position=by_position,
            _function=se.Lambdify(arguments, [*forces, *(e for row in slopes for e in row)]),
        )

    def along(
        self, mechanism: Mechanism, time: Array, q: Array, q_dot: Array, q_ddot: Array
    ) -> tuple[Array, Array]:
        """Return the forces along a motion, and their slopes."""
        values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
        fixed = np.broadcast_to([values[path] for path in self.paths], (len(time), len(self.paths)))
        table = np.column_stack([time, q, q_dot, q_ddot, fixed])
        found = np.asarray(self._function(table), dtype=float).reshape(len(time), -1)
        count = len(self.coordinates)
        return found[:, :count], found[:, count:].reshape(len(time), count, -1)

    def inertias(self, mechanism: Mechanism, q: Array) -> Array:
        """Return what moves as each coordinate does (m,), all else at rest."""
        count = len(self.coordinates)
        places, none = np.tile(q, (count, 1)), np.zeros((count, count))
        time = np.zeros(count)
        still, _ = self.along(mechanism, time, places, none, none)
        moving, _ = self.along(mechanism, time, places, none, np.eye(count))
        return np.diagonal(moving - still).copy()


def _are_bent(slopes: Sequence[Sequence[se.Expr]], symbols: Sequence[se.Symbol]) -> bool:
    """Whether any slope by a parameter depends on one of them."""
    return any(
        se.expand(collapsed(slope.diff(symbol))) != 0
        for row in slopes
        for slope in row
        for symbol in symbols
    )
