"""The equations of motion of a mechanism, with the force of its contacts left open.

M q'' = h - W F, from the energies of a mechanism by Lagrange,

    d/dt (dT/dq') - dT/dq + dV/dq = Q - W F,

with the kinetic energy T, the potential V and the other forces Q; or read off the matrices that a
mechanism gives. W has a 1 at the coordinate that slips.

1. Energies and forces are evaluated with symbols. M is the second derivative of T along the rates,
   of coordinates that move, and below them of those that are held at 0.
2. Guided coordinates move as they are told: their accelerations are known and go to the right-hand
   side. What they take, and what holds the others, is what their own rows lack.
3. The mass matrix of the free ones is solved by symbols. With friction a + b N the normal force N
   is the row of the held normal coordinate, one scalar equation.
4. An impulse P at a hard stop of coordinate i changes all rates by P M^-1 e_i, and rate i so that
   it is reversed, times the restitution; friction has no share.

Solved for what drives the mechanism, the same equations give the driving forces of a motion.
"""

import functools
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
import symengine as se
from numpy.typing import NDArray

from stickslip import mechanisms
from stickslip.engine.formulation import trace
from stickslip.engine.formulation.slip_directions import SlipDirections
from stickslip.errors import InputError, UnknownNameError
from stickslip.quantities import parameters, shadow
from stickslip.show.formatting import number

# Reads the equations of a mechanism that gives matrices.

MOST_ELIMINATED = 3
"""Coordinates that are eliminated by symbols, at most."""
ENTRY_TOLERANCE = 1e-9
"""Difference of two entries, over their size, that is the rounding of two ways to write them."""
VANISHED = 1e-6
"""Share of the mass of a motion that is next to nothing: it is a thousand times as fast then."""
LINKS = (
    "For a link, the moment of inertia about its joint is at least its mass times the square of the"
    " distance of its centre."
)
"""What is often wrong with a mass matrix that is not positive definite."""
SINGULAR = 1e-13
"""What is left of a mass, over the mass itself, where rounding cannot tell it from 0."""


def matrix_rows(
    mechanism: mechanisms.MatrixMechanism, places: Mapping[str, Any], held: Sequence[str]
) -> list[se.Expr]:
    """Return the mass matrix row by row, those of held coordinates last."""
    n = len(mechanism.coordinates)
    rows = [list(row) for row in mechanism.mass_matrix(places)]
    if len(rows) != n + len(held) or any(len(row) != n for row in rows):
        got = f"{len(rows)} rows of {' or '.join(sorted({str(len(row)) for row in rows}))}"
        names = ", ".join((*mechanism.coordinates, *held))
        raise InputError(
            f"{type(mechanism).__name__}.mass_matrix must return {n + len(held)} rows ({names})"
            f" of {n} ({', '.join(mechanism.coordinates)}), got {got}."
        )
    result = [[trace.expression(entry) for entry in row] for row in rows]
    for i, j in itertools.combinations(range(n), 2):
        upper, other = result[i][j], result[j][i]
        if not trace.is_zero(upper - other) and _differ(upper, other):
            row, column = mechanism.coordinates[i], mechanism.coordinates[j]
            raise InputError(_asymmetry(mechanism, row, column, _shown(upper), _shown(other)))
    free = [i for i in range(n) if mechanism.coordinates[i] not in mechanism.guided()]
    # Leading minors up to a size that symbols can take; numbers are checked where a run begins.
    for k in range(1, min(len(free), MOST_ELIMINATED) + 1):
        part = free[:k]
        minor = se.DenseMatrix(k, k, [result[i][j] for i in part for j in part])
        if trace.is_zero(minor.det()):
            names = ", ".join(repr(mechanism.coordinates[i]) for i in part)
            raise InputError(
                f"{type(mechanism).__name__}.mass_matrix must be positive definite, but some motion"
                f" of {names} has no mass wherever it is: the rows and columns of these coordinates"
                " depend on each other."
            )
    return [entry for row in result for entry in row]


def _differ(first: se.Expr, other: se.Expr) -> bool:
    """Whether two expressions have other values than each other at some numbers for all symbols.

    Forms such as that of a sum of angles need not cancel by symbols.
    """
    # With a fixed seed: the same model is refused or taken each time.
    random = np.random.default_rng(0)
    names = sorted(first.free_symbols | other.free_symbols, key=str)
    # Away from 0 and from right angles, at which forms that differ may agree.
    for _ in range(3):
        numbers = dict(zip(names, random.uniform(0.2, 1.2, len(names)).tolist(), strict=True))
        try:
            a, b = (float(e.subs(numbers)) for e in (first, other))
        except (RuntimeError, TypeError, ValueError):
            return False  # with switches: the state at hand tells
        if abs(a - b) > ENTRY_TOLERANCE * (abs(a) + abs(b)):
            return True
    return False


def _shown(e: se.Expr) -> str:
    """Return a number as text; nothing for an expression, whose symbols mean nothing to users."""
    return "" if e.free_symbols else number(float(e), 6)


def _asymmetry(
    mechanism: mechanisms.MatrixMechanism,
    row: str,
    column: str,
    name: str,
    other: str,
    where: str = "",
) -> str:
    """Return what is wrong with two entries that should be equal."""
    first, second = (f" ({value})" if value else "" for value in (name, other))
    return (
        f"{type(mechanism).__name__}.mass_matrix must be symmetric{where}, but the entry of row"
        f" {row!r} and column {column!r}{first} is not that of row {column!r} and column"
        f" {row!r}{second}."
    )


def mass_fault(mechanism: mechanisms.MatrixMechanism, places: Sequence[float]) -> str:
    """Return what is wrong with a mass matrix at a place: nothing, or a sentence."""
    names, owner = mechanism.coordinates, type(mechanism).__name__
    n, mass = len(names), _mass_at(mechanism, places)
    q = dict(zip(names, map(float, places), strict=True))
    at = ", ".join(f"{name} = {number(value, 4)} {unit}" for (name, value), unit in zip(
        q.items(), mechanism.units, strict=True
    ))  # fmt: skip
    for i, j in itertools.combinations(range(n), 2):
        if abs(mass[i, j] - mass[j, i]) > ENTRY_TOLERANCE * (abs(mass[i, j]) + abs(mass[j, i])):
            values = number(mass[i, j], 6), number(mass[j, i], 6)
            return _asymmetry(mechanism, names[i], names[j], *values, f" at {at}")
    moving = [i for i in range(n) if names[i] not in mechanism.guided()]
    for i in moving:
        if not mass[i, i] > 0.0:
            return (
                f"{owner}.mass_matrix must have masses above 0 on its diagonal, but the entry of"
                f" row and column {names[i]!r} is {number(mass[i, i], 6)} at {at}."
            )
    # Scaled to a diagonal of 1, as units of coordinates would else decide what is small.
    left = mass[np.ix_(moving, moving)]
    left = left / np.sqrt(np.outer(left.diagonal(), left.diagonal()))
    # Elimination: what is left of each row once those before it move freely. The first row
    # without mass names the motion that has none.
    for k, i in enumerate(moving):
        if not left[k, k] > SINGULAR:
            return (
                f"{owner}.mass_matrix must be positive definite, but at {at} some motion of"
                f" {', '.join(repr(names[j]) for j in moving[: k + 1])} has no mass or a negative"
                f" one: the entries of row and column {names[i]!r} are too large for it. {LINKS}"
            )
        left[k + 1 :, k + 1 :] -= np.outer(left[k + 1 :, k], left[k, k + 1 :]) / left[k, k]
    return ""


def matrix_supply(
    given: Any,
    energy: se.Expr,
    force: Mapping[str, se.Expr],
    places: Mapping[str, se.Symbol],
    speeds: Mapping[str, se.Symbol],
) -> se.Expr:
    """Return the power supplied [W]: what is given, or what the forces do beyond the energies."""
    if given is not None:
        return trace.expression(given)
    # Pairs of force and change of energy that cancel are those of the potential: no power is
    # supplied.
    pairs = [(f * speeds[i], energy.diff(places[i]) * speeds[i]) for i, f in force.items()]
    left = [pair for pair in pairs if not trace.is_zero(sum(pair))]
    total = sum((sum(part, se.Integer(0)) for part in zip(*left, strict=True)), se.Integer(0))
    return se.Integer(0) if trace.is_zero(total) else total


def mass_vanishes(
    mechanism: mechanisms.MatrixMechanism, start: Sequence[float], end: Sequence[float]
) -> bool:
    """Whether some motion has next to no mass any more at the end of a run."""
    before, after = (_mass_at(mechanism, places) for places in (start, end))
    # Scaled by the masses at the start, so that motions of different units are compared.
    scale = 1.0 / np.sqrt(before.diagonal())
    least = [np.linalg.eigvalsh(m * np.outer(scale, scale))[0] for m in (before, after)]
    return bool(least[1] <= VANISHED * least[0])


def _mass_at(mechanism: mechanisms.MatrixMechanism, places: Sequence[float]) -> NDArray[np.float64]:
    """Return the mass matrix of the moving coordinates (n, n) at a place (n,)."""
    names = mechanism.coordinates
    held = [
        *mechanism.held(),
        *(name for contact in mechanism.contacts() for name in contact.normals),
    ]
    q = dict(zip(names, map(float, places), strict=True))
    rows = mechanism.mass_matrix({**dict.fromkeys(held, 0.0), **q})
    return np.array([[float(entry) for entry in row] for row in rows[: len(names)]])


# Lagrange's equations of a mechanism, with the force of one contact left open.

SIDES = {"lower": -1, "upper": 1}


@dataclass(frozen=True)
class Wall:
    """A hard stop of one coordinate."""

    coordinate: int
    """Index of the coordinate."""
    side: int
    """1 above, -1 below."""
    position: se.Expr
    """Place of the stop, in the unit of the coordinate."""
    restitution: se.Expr
    """Speed after an impact over that before [1]."""
    margin: se.Expr
    """Distance that is left."""


def derive_walls(mechanism: mechanisms.Mechanism, q: Mapping[str, se.Symbol]) -> tuple[Wall, ...]:
    """Return the stops of a mechanism whose parameters are symbols."""
    names = list(q)
    result = []
    for stop in mechanisms.stops_of(mechanism):
        side = SIDES[stop.side]
        position = trace.expression(stop.position)
        result.append(
            Wall(
                coordinate=names.index(stop.coordinate),
                side=side,
                position=position,
                restitution=trace.expression(stop.restitution),
                margin=side * (position - q[stop.coordinate]),
            )
        )
    return tuple(result)


def impact_events(
    walls: Sequence[Wall], coordinates: Sequence[str], slip: int | None
) -> tuple[str | None, ...]:
    """Return what an impact of each coordinate is called, None where it has no stop."""
    names = ["hits stop" if i == slip else f"{q} hits stop" for i, q in enumerate(coordinates)]
    stopped = {wall.coordinate for wall in walls}
    return tuple(name if i in stopped else None for i, name in enumerate(names))


def wall_guards(walls: Sequence[Wall], mode: int) -> list[se.Expr]:
    """Return the margins that a mode watches.

    A body that slips one way meets the stop on that side only, and one that is held meets none.
    """
    return [wall.margin if wall.side == mode else se.Integer(0) for wall in walls]


@dataclass(frozen=True)
class Motion:
    """What follows from a friction force: how all coordinates accelerate, and what that takes."""

    accelerations: list[se.Expr]
    """Of all coordinates."""
    normal: se.Expr
    """Normal force."""
    pivot: se.Expr
    """What the equation for the normal force was divided by; 0 or less is Painleve's paradox."""


@dataclass(frozen=True)
class Mechanics:
    """Equations of motion ``M q'' = h - W F``, and the contact's normal force.

    Guided coordinates move as they are told: the equations are those of the others.
    """

    coordinates: tuple[str, ...]
    """Names of the moving coordinates."""
    contact: mechanisms.Contact
    """The contact at which the mechanism rubs."""
    slip: int
    """Index of the slip coordinate."""
    mass: se.DenseMatrix
    """Mass matrix of all moving coordinates, and below it the rows of those that are held."""
    forces: list[se.Expr]
    """Forces h on all coordinates, then on those that are held, friction left out."""
    guides: Mapping[int, se.Expr]
    """Accelerations of guided coordinates by their index."""
    efforts: Mapping[int, str]
    """What the effort of each guided coordinate is called."""
    held: tuple[str, ...]
    """Held coordinates, the contact's normal one first if it has one."""
    load: se.Expr | None
    """The prescribed load, where nothing is held."""
    energy: se.Expr
    """Kinetic and potential energy [J]."""
    supplied: se.Expr
    """Power that drives, dampers and moved supports put in; that of guides is left out."""
    walls: tuple[Wall, ...]
    """Hard stops."""
    mechanism: mechanisms.Mechanism
    """What it is derived from; its parameters are symbols."""

    @property
    def free(self) -> list[int]:
        """Indices of the coordinates that no guide moves."""
        return [i for i in range(len(self.coordinates)) if i not in self.guides]

    def reduced(self, indices: Sequence[int]) -> se.DenseMatrix:
        """Return the mass matrix of some coordinates."""
        n = len(indices)
        return se.DenseMatrix(n, n, [self.mass[i, j] for i in indices for j in indices])

    def _solved(self, indices: Sequence[int], friction: se.Expr) -> list[se.Expr]:
        """Return all accelerations where only some coordinates are free to move."""
        result = [self.guides.get(i, se.Integer(0)) for i in range(len(self.coordinates))]
        if indices:
            right = [
                # What guided coordinates do by themselves is force on the others.
                self.forces[i]
                - sum((self.mass[i, j] * a for j, a in self.guides.items()), se.Integer(0))
                - int(i == self.slip) * friction
                for i in indices
            ]
            column = self.reduced(indices).LUsolve(se.DenseMatrix(len(indices), 1, right))
            for k, i in enumerate(indices):
                result[i] = column[k, 0]
        return result

    def _pushed(self, size: se.Expr) -> list[se.Expr]:
        """Return how a friction force changes the accelerations."""
        indices = self.free
        unit = [int(i == self.slip) * size for i in indices]
        # guided coordinates do not yield to a force
        column = self.reduced(indices).LUsolve(se.DenseMatrix(len(indices), 1, unit))
        result = [se.Integer(0)] * len(self.coordinates)
        for k, i in enumerate(indices):
            result[i] = column[k, 0]
        return result

    def surplus(self, row: int, accelerations: Sequence[se.Expr]) -> se.Expr:
        """Return the force that a coordinate needs beside those that act on it."""
        inertia = [self.mass[row, j] * a for j, a in enumerate(accelerations)]
        return sum(inertia, se.Integer(0)) - self.forces[row]

    def _normal(self, accelerations: Sequence[se.Expr]) -> se.Expr:
        if self.load is not None:
            return self.load
        return self.surplus(len(self.coordinates), accelerations)

    def slipping(self, constant: se.Expr, factor: se.Expr) -> Motion:
        """Return what follows from friction ``constant + factor * N``.

        The mass matrix is solved first; what remains is one scalar equation for N, whose pivot
        1 + (row M^-1 W) factor vanishes only where the physics does (Painleve).
        """
        n = len(self.coordinates)
        free = self._solved(self.free, constant)
        pivot: se.Expr = se.Integer(1)
        normal = self._normal(free)
        if self.load is None:
            # The normal force changes friction, and friction the accelerations that give the normal
            # force: one linear equation.
            reaction = self._pushed(factor)
            pivot = 1 + sum((self.mass[n, j] * reaction[j] for j in range(n)), se.Integer(0))
            normal = normal / pivot
        push = self._pushed(factor * normal)
        return Motion([a - b for a, b in zip(free, push, strict=True)], normal, pivot)

    def sticking(self) -> tuple[Motion, se.Expr]:
        """Return what happens while the slip coordinate is held, and the needed friction."""
        accelerations = self._solved([i for i in self.free if i != self.slip], se.Integer(0))
        normal = self._normal(accelerations)
        # The reaction of the slip coordinate is what friction has to give: minus its surplus.
        needed = -self.surplus(self.slip, accelerations)
        return Motion(accelerations, normal, se.Integer(1)), needed

    def reactions(self, motion: Motion) -> dict[str, se.Expr]:
        """Return the reactions of held coordinates and the efforts of guided ones, by coordinate.

        Friction is taken to act along the slip coordinate only, so that it has no part in them but
        by the accelerations.
        """
        n = len(self.coordinates)
        result = {self.coordinates[i]: self.surplus(i, motion.accelerations) for i in self.guides}
        first = 0 if self.load is not None else 1
        if first:
            result[self.held[0]] = motion.normal
        for k, name in enumerate(self.held[first:], n + first):
            result[name] = self.surplus(k, motion.accelerations)
        return result

    def power(self, motion: Motion, rates: Sequence[se.Expr]) -> se.Expr:
        """Return the power supplied, that of the guides included."""
        guiding = [self.surplus(i, motion.accelerations) * rates[i] for i in self.guides]
        return self.supplied + sum(guiding, se.Integer(0))

    def wall_rows(self) -> list[se.Expr]:
        """Return the rows of the stops that kernels read, by the columns of their layout.

        An impulse P on the slip coordinate i, whose stops they are, changes the rates by
        P M^-1 e_i, and rate i by P (M^-1)_ii; those of guided coordinates do not change.
        """
        # Friction is bounded and has no part in an impulse: the unit is along the slip alone.
        changes = self._pushed(se.Integer(1)) if self.walls else []
        shares = [e / changes[self.slip] for e in (se.Integer(1), *changes)] if self.walls else []
        return [e for wall in self.walls for e in (wall.position, wall.restitution, *shares)]

    def rates_after(self, rates: Sequence[se.Expr]) -> list[list[se.Expr]]:
        """Return the rates after an impact at each stop, then those without a bounce."""
        wide = 3 + len(rates)
        rows = self.wall_rows()
        walls = [rows[i : i + wide] for i in range(0, len(rows), wide)]
        return [
            [
                rate - (1 + bounces * row[1]) * rates[wall.coordinate] * change
                for rate, change in zip(rates, row[3:], strict=True)
            ]
            for bounces in (1, 0)
            for wall, row in zip(self.walls, walls, strict=True)
        ]


def _traced(symbols: Mapping[str, se.Expr], board: trace.Switchboard) -> dict[str, trace.Traced]:
    return {name: trace.Traced(symbol, board) for name, symbol in symbols.items()}


def _checked(
    mechanism: mechanisms.Mechanism, forces: Mapping[str, Any], places: Mapping[str, se.Symbol]
) -> dict[str, se.Expr]:
    """Return the force on every coordinate, held ones included; 0 where none is given."""
    for name in forces:
        if name not in places:
            raise UnknownNameError(f"coordinate in {type(mechanism).__name__}.forces", name, places)
    return {name: trace.expression(forces.get(name, 0.0)) for name in places}


def _lagrange(
    kinetic: se.Expr,
    potential: se.Expr,
    other: Mapping[str, se.Expr],
    places: Mapping[str, se.Symbol],
    speeds: Mapping[str, se.Symbol],
    moving: Sequence[str],
) -> tuple[list[se.Expr], list[se.Expr]]:
    """Return the mass matrix, row by row, its columns those that move, and the forces."""
    momentum = {name: kinetic.diff(speeds[name]) for name in places}
    forces = []
    for name, p in momentum.items():
        # d/dt of the momentum along the motion: its second part, with rates of places, goes to the
        # forces.
        drift = sum((p.diff(places[j]) * speeds[j] for j in places), se.Integer(0))
        own = (kinetic - potential).diff(places[name]) + other[name]
        forces.append(own - drift)
    return [p.diff(speeds[j]) for p in momentum.values() for j in moving], forces


def _uncancelled(potential: se.Expr, places: Mapping[str, se.Symbol]) -> se.Expr:
    """Return a potential that is 0 at the origin without differences such as 1 - cos q.

    These are half a square of q, and lost in the rounding of 1 where swings are small: the
    certificate of a run compares energies with each other.
    """
    moving = set(places.values())
    cosines = [e for e in potential.atoms(se.cos) if e.free_symbols & moving]
    if not cosines or not trace.is_zero(potential.subs(dict.fromkeys(moving, 0))):
        return potential
    halves = {e: 1 - 2 * se.sin(e.args[0] / 2) ** 2 for e in cosines}
    return se.expand(potential.xreplace(halves))


@dataclass(frozen=True)
class Rows:
    """Equations of motion ``M q'' = h``, friction left out, of moving and of held coordinates."""

    mass: list[list[se.Expr]]
    """Rows of the mass matrix, those of held coordinates last; a column a moving coordinate."""
    forces: list[se.Expr]
    """Forces h."""
    energy: se.Expr
    """Kinetic and potential energy [J]."""
    supplied: se.Expr
    """Power that drives, dampers and moved supports put in [W]."""


def lagrange_rows(
    mechanism: mechanisms.Mechanism,
    t: se.Symbol,
    q: Mapping[str, se.Symbol],
    q_dot: Mapping[str, se.Symbol],
    drives: Mapping[str, se.Symbol],
    held: Sequence[str],
    board: trace.Switchboard,
    directions: SlipDirections | None = None,
) -> Rows:
    """Trace the energies and forces of a mechanism whose parameters are symbols."""
    places = {**q, **{name: se.Symbol(f"h_{name}") for name in held}}
    speeds = {**q_dot, **{name: se.Symbol(f"hd_{name}") for name in held}}
    traced = functools.partial(_traced, board=board)
    seen, seen_speeds = traced(places), traced(speeds)
    # Energies are given in coordinates of the mechanism; traced are those of the equations.
    if directions is not None:
        seen |= traced(dict(zip(q, directions.seen(list(q.values())), strict=True)))
        seen_speeds |= traced(dict(zip(q, directions.seen(list(q_dot.values())), strict=True)))
    kinetic = trace.expression(mechanism.kinetic_energy(seen, seen_speeds))
    potential = trace.expression(mechanism.potential_energy(trace.Traced(t, board), seen))
    now = trace.Traced(t, board), seen, seen_speeds, traced(drives)
    other = _checked(mechanism, mechanism.forces(*now), places)
    if directions is not None:
        moving = directions.along([other[name] for name in q])
        other |= dict(zip(q, moving, strict=True))
    # Only now: derivatives along held coordinates give the rows of their reactions.
    at_rest = {symbols[name]: 0 for symbols in (places, speeds) for name in held}
    no_energy = {speeds[i]: 0 for i in mechanism.computed}  # numbers of a controller
    supplied = sum((other[i] * speeds[i] for i in other if speeds[i] not in no_energy), 0 * t)
    if isinstance(mechanism, mechanisms.MatrixMechanism):
        mass, forces = matrix_rows(mechanism, seen, held), [other[name] for name in places]
        if directions is not None:
            rows = [mass[i : i + len(q)] for i in range(0, len(mass), len(q))]
            mass = [entry for row in directions.congruent(rows) for entry in row]
        supplied = matrix_supply(mechanism.power(*now), kinetic + potential, other, places, speeds)
    else:
        mass, forces = _lagrange(kinetic, potential, other, places, speeds, list(q))
    n = len(q)
    return Rows(
        mass=[[e.subs(at_rest) for e in mass[n * i : n * (i + 1)]] for i in range(len(places))],
        forces=[trace.collapsed(e.subs(at_rest)) for e in forces],
        energy=(kinetic + _uncancelled(potential, places)).subs(at_rest | no_energy),
        supplied=trace.collapsed((potential.diff(t) + supplied).subs(at_rest)),
    )


def derive_mechanics(
    mechanism: mechanisms.Mechanism,
    t: se.Symbol,
    q: Mapping[str, se.Symbol],
    q_dot: Mapping[str, se.Symbol],
    drives: Mapping[str, se.Symbol],
    board: trace.Switchboard,
) -> Mechanics:
    """Trace the energies and forces of a mechanism whose parameters are symbols."""
    contact = mechanisms.only_contact(mechanism)
    held = trace.held_of(mechanism)
    rows = lagrange_rows(mechanism, t, q, q_dot, drives, held, board)
    return Mechanics(
        coordinates=tuple(q),
        contact=contact,
        slip=list(q).index(mechanisms.slip_of(mechanism)),
        mass=se.DenseMatrix(len(rows.mass), len(q), [e for row in rows.mass for e in row]),
        forces=rows.forces,
        guides=trace.guides_of(mechanism, contact.slips, drives),
        efforts={list(q).index(name): g.effort for name, g in mechanism.guided().items()},
        held=held,
        load=None if contact.normal is not None else trace.expression(contact.load),
        energy=rows.energy,
        supplied=rows.supplied,
        walls=derive_walls(mechanism, q),
        mechanism=mechanism,
    )


# The forces that a motion takes: the equations of a mechanism, solved for what drives it.

Array = NDArray[np.float64]


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
        mechanism: mechanisms.Mechanism,
        linear: Sequence[str],
        *,
        by_position: bool = False,
    ) -> Self:
        """Derive the forces, and find whether they are linear in some parameters.

        Where they are not, slopes are those at the values of the mechanism.
        """
        board = trace.Switchboard()
        known = [path for path, _, _ in parameters(mechanism, "mechanism")]
        # Parameters, motion and drives as symbols: the forces become one function of all.
        symbol = {path: se.Symbol(f"p{i}") for i, path in enumerate(known)}
        twin = shadow(mechanism, "mechanism", lambda path: trace.Traced(symbol[path], board))
        t = se.Symbol("t")
        q, rates, accelerations = (
            {name: se.Symbol(f"{letter}{i}") for i, name in enumerate(mechanism.coordinates)}
            for letter in ("q", "u", "a")
        )
        drives = {name: se.Symbol(f"d{i}") for i, name in enumerate(mechanism.drives())}
        rows = lagrange_rows(twin, t, q, rates, drives, mechanism.held(), board)
        # What drives the motion is what is looked for.
        undriven = dict.fromkeys(drives.values(), 0)
        if any(switch.hold is not None for switch in board.switches.values()):
            raise InputError(
                f"{type(mechanism).__name__} has latched switches, which a measured motion does not"
                " tell of: use stickslip.maths.where."
            )
        # A measured motion tells the sides of all switches: margins stand in their places.
        shown = {switch.symbol: switch.margin for switch in board.switches.values()}
        count = len(q)
        forces = []
        for row, force in zip(rows.mass[:count], rows.forces[:count], strict=True):
            taken = sum(
                (entry * a for entry, a in zip(row, accelerations.values(), strict=True)),
                se.Integer(0),
            )
            forces.append((taken - force).subs(undriven).subs(shown))
        # Linear in each parameter alone is not enough: products of two of them bend the fit.
        slopes = [
            [trace.collapsed(force.diff(symbol[path])) for path in linear] for force in forces
        ]
        bent = _are_bent(slopes, [symbol[path] for path in linear])
        if by_position:
            for row, force in zip(slopes, forces, strict=True):
                row += [trace.collapsed(force.diff(place)) for place in q.values()]
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
        self, mechanism: mechanisms.Mechanism, time: Array, q: Array, q_dot: Array, q_ddot: Array
    ) -> tuple[Array, Array]:
        """Return the forces along a motion, and their slopes."""
        values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
        fixed = np.broadcast_to([values[path] for path in self.paths], (len(time), len(self.paths)))
        table = np.column_stack([time, q, q_dot, q_ddot, fixed])
        result = np.asarray(self._function(table), dtype=float).reshape(len(time), -1)
        count = len(self.coordinates)
        return result[:, :count], result[:, count:].reshape(len(time), count, -1)

    def inertias(self, mechanism: mechanisms.Mechanism, q: Array) -> Array:
        """Return what moves as each coordinate does (m,), all else at rest."""
        count = len(self.coordinates)
        places, none = np.tile(q, (count, 1)), np.zeros((count, count))
        time = np.zeros(count)
        # By differences of unit accelerations: the function has no mass matrix by itself.
        still, _ = self.along(mechanism, time, places, none, none)
        moving, _ = self.along(mechanism, time, places, none, np.eye(count))
        return np.diagonal(moving - still).copy()


def _are_bent(slopes: Sequence[Sequence[se.Expr]], symbols: Sequence[se.Symbol]) -> bool:
    """Whether any slope by a parameter depends on one of them."""
    return any(
        se.expand(trace.collapsed(slope.diff(symbol))) != 0
        for row in slopes
        for slope in row
        for symbol in symbols
    )
