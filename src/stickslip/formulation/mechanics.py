"""Lagrange's equations of a mechanism, with the force of one contact left open."""

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import symengine as se

from stickslip.errors import InputError
from stickslip.formulation.stops import Wall, derive_walls
from stickslip.formulation.trace import Switchboard, Traced, collapsed, expression
from stickslip.mechanisms import Contact, Mechanism

__all__ = ["Mechanics", "derive_mechanics"]


@dataclass(frozen=True)
class Mechanics:
    """Equations of motion ``M q'' = h - W F``, and the contact's normal force."""

    coordinates: tuple[str, ...]
    contact: Contact
    slip: int
    """Index of the slip coordinate."""
    mass: se.DenseMatrix
    """Mass matrix of the moving coordinates."""
    forces: se.DenseMatrix
    """Their forces h, friction left out."""
    normal_row: se.DenseMatrix | None
    """Row of the mass matrix that belongs to the held normal coordinate."""
    normal_force: se.Expr
    """Force on the held coordinate, or the prescribed load."""
    energy: se.Expr
    supplied: se.Expr
    """Power that drives, dampers and moved supports put in, friction left out."""
    walls: tuple[Wall, ...]
    """Hard stops."""

    def slipping(self, constant: se.Expr, factor: se.Expr) -> tuple[list[se.Expr], se.Expr]:
        """Return accelerations and normal force for friction ``constant + factor * N``.

        The mass matrix is solved first; what remains is one scalar equation for N, whose pivot
        1 + (row M^-1 W) factor vanishes only where the physics does (Painleve).
        """
        n = len(self.coordinates)
        w = se.DenseMatrix(n, 1, [int(i == self.slip) for i in range(n)])
        free = self.mass.LUsolve(self.forces - w * constant)
        if self.normal_row is None:
            normal = self.normal_force
        else:
            reaction = self.mass.LUsolve(w * factor)
            pivot = 1 + _dot(self.normal_row, reaction)
            normal = (_dot(self.normal_row, free) - self.normal_force) / pivot
        push = self.mass.LUsolve(w * (factor * normal))
        return [free[i, 0] - push[i, 0] for i in range(n)], normal

    def sticking(self) -> tuple[list[se.Expr], se.Expr, se.Expr]:
        """Return accelerations with the slip coordinate held, normal force and needed friction."""
        n = len(self.coordinates)
        others = [i for i in range(n) if i != self.slip]
        acceleration = [se.Integer(0)] * n
        if others:
            size = len(others)
            m = se.DenseMatrix(size, size, [self.mass[i, j] for i in others for j in others])
            solved = m.LUsolve(se.DenseMatrix(size, 1, [self.forces[i, 0] for i in others]))
            for k, i in enumerate(others):
                acceleration[i] = solved[k, 0]
        vector = se.DenseMatrix(n, 1, acceleration)
        normal = self.normal_force
        if self.normal_row is not None:
            normal = _dot(self.normal_row, vector) - self.normal_force
        row = se.DenseMatrix(1, n, [self.mass[self.slip, j] for j in range(n)])
        return acceleration, normal, self.forces[self.slip, 0] - _dot(row, vector)


def _dot(row: se.DenseMatrix, column: se.DenseMatrix) -> se.Expr:
    return (row * column)[0, 0]


def _only_contact(mechanism: Mechanism) -> Contact:
    contacts = mechanism.contacts()
    if len(contacts) != 1:
        raise InputError(
            f"{type(mechanism).__name__} has {len(contacts)} contacts; this version solves one."
        )
    return contacts[0]


def _traced(symbols: Mapping[str, se.Expr], board: Switchboard) -> dict[str, Traced]:
    return {name: Traced(symbol, board) for name, symbol in symbols.items()}


def _work_rate(forces: Mapping[str, Any], speeds: Mapping[str, se.Symbol]) -> se.Expr:
    """Return the power of generalised forces."""
    return sum((expression(force) * speeds[i] for i, force in forces.items()), se.Integer(0))


def derive_mechanics(
    mechanism: Mechanism,
    t: se.Symbol,
    q: Mapping[str, se.Symbol],
    q_dot: Mapping[str, se.Symbol],
    drives: Mapping[str, se.Symbol],
    board: Switchboard,
) -> Mechanics:
    """Trace the energies and forces of a mechanism whose parameters are symbols."""
    contact = _only_contact(mechanism)
    held = () if contact.normal is None else (contact.normal,)
    places = {**q, **{name: se.Symbol(f"h_{name}") for name in held}}
    speeds = {**q_dot, **{name: se.Symbol(f"hd_{name}") for name in held}}
    traced = functools.partial(_traced, board=board)
    kinetic = expression(mechanism.kinetic_energy(traced(places), traced(speeds)))
    potential = expression(mechanism.potential_energy(Traced(t, board), traced(places)))
    other = mechanism.forces(Traced(t, board), traced(places), traced(speeds), traced(drives))
    at_rest = {symbols[name]: 0 for symbols in (places, speeds) for name in held}
    names = [*q, *held]
    momentum = [kinetic.diff(speeds[i]) for i in names]
    mass = [[p.diff(speeds[j]).subs(at_rest) for j in names] for p in momentum]
    force = []
    for name, p in zip(names, momentum, strict=True):
        drift = sum((p.diff(places[j]) * speeds[j] for j in names), se.Integer(0))
        own = (kinetic - potential).diff(places[name]) + expression(other.get(name, 0.0))
        force.append(collapsed((own - drift).subs(at_rest)))
    n = len(q)
    return Mechanics(
        coordinates=tuple(q),
        contact=contact,
        slip=list(q).index(contact.slip),
        mass=se.DenseMatrix(n, n, [mass[i][j] for i in range(n) for j in range(n)]),
        forces=se.DenseMatrix(n, 1, force[:n]),
        normal_row=se.DenseMatrix(1, n, mass[n][:n]) if held else None,
        normal_force=force[n] if held else expression(contact.load),
        energy=(kinetic + potential).subs(at_rest),
        supplied=collapsed((potential.diff(t) + _work_rate(other, speeds)).subs(at_rest)),
        walls=derive_walls(mechanism, q),
    )
