"""Rigid bodies joined in a tree: their mass matrix and forces by recursion.

Written out from energies, the equations of a robot have a hundred thousand characters. Recursions
along the tree give the same ones with what bodies have in common worked out once. What lies beyond
a joint counts as one body, whose mass, first moment and inertia both matrix and forces need; then
what a joint adds to the motion of all beyond it acts on that body.

Source: R. Featherstone, "Rigid Body Dynamics Algorithms", 2008, sections 5.3 and 6.2.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, final

from typing_extensions import override

from stickslip.maths import Scalar, cos, sin
from stickslip.mechanisms.base import ContactInputs, MatrixMechanism, gear_inputs

Vector: TypeAlias = Sequence[Scalar]
"""Three numbers or symbols."""
Matrix: TypeAlias = Sequence[Vector]
"""Three rows of them."""

BASE = -1
"""Index of the parent of a body that is joined to the ground."""
NONE: Vector = (0.0, 0.0, 0.0)
UNIT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
"""Axes along the parent's."""


@dataclass(frozen=True)
class Body:
    """A rigid body and the joint that carries it, which is its origin; its z-axis is the joint's.

    Quantities are numbers or symbols. Those that are 0 drop out of the equations.
    """

    parent: int
    """Index of the body that it is joined to, which stands before it; or `BASE`."""
    frame: Matrix
    """Axes of the body while the joint is at 0, row by row, in those of the parent."""
    offset: Vector
    """Place of the joint at 0 in axes of the parent [m]."""
    mass: Scalar
    """Mass [kg]."""
    moment: Vector
    """Mass times the place of the centre of mass [kg m]."""
    inertia: Matrix
    """Inertia about the origin [kg m^2]."""
    slides: bool = False
    """Whether the joint slides along its axis; otherwise it turns about it."""
    rotor: Scalar = 0.0
    """Inertia of the motor's rotor, which sits on the parent and turns about the same axis."""
    gear: Scalar = 1.0
    """Speed of the rotor on the parent over that of the joint."""
    armature: Scalar = 0.0
    """Inertia that acts on the joint alone."""

    @property
    def axis(self) -> Vector:
        """Axis of the joint in axes of the parent."""
        return self.frame[2]


def _cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def times(rows: Matrix, a: Vector) -> Vector:
    """Return a matrix times a vector."""
    return (_dot(rows[0], a), _dot(rows[1], a), _dot(rows[2], a))


def turned(rows: Matrix, tensor: Matrix) -> Matrix:
    """Return a symmetric tensor in other axes.

    Examples
    --------
    >>> turned(((0, 1, 0), (0, 0, 1), (1, 0, 0)), ((1, 0, 0), (0, 2, 0), (0, 0, 3)))
    ((2, 0, 0), (0, 3, 0), (0, 0, 1))
    """
    half = [times(rows, row) for row in tensor]
    return tuple(times(rows, column) for column in transposed(half))


def symmetric(xx: Scalar, yy: Scalar, zz: Scalar, xy: Scalar, xz: Scalar, yz: Scalar) -> Matrix:
    """Return a symmetric tensor of its entries."""
    return (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)


def about(mass: Scalar, moment: Vector, place: Vector) -> Matrix:
    """Return what moving the origin of an inertia by minus `place` adds to it.

    Examples
    --------
    >>> about(2.0, (0.0, 0.0, 0.0), (0.0, 3.0, 0.0))[2][2]
    18.0
    """
    # (p . r) 1 - (p r^T + r p^T) / 2, with p the place, h the moment, and r = m p + 2 h.
    twice = plus(moment, moment)
    reach = tuple(mass * place[i] + twice[i] for i in range(3))
    shared = [[0.5 * (place[i] * reach[j] + reach[i] * place[j]) for j in range(3)]
              for i in range(3)]  # fmt: skip
    trace = _dot(place, reach)
    rows = [tuple((trace if i == j else 0.0) - shared[i][j] for j in range(3)) for i in range(3)]
    return tuple(rows)


def _dot(a: Vector, b: Vector) -> Scalar:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def plus(a: Vector, b: Vector) -> Vector:
    """Return the sum of two vectors."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _scaled(factor: Scalar, a: Vector) -> Vector:
    return (factor * a[0], factor * a[1], factor * a[2])


def transposed(rows: Matrix) -> Matrix:
    """Return the columns of a matrix as rows."""
    return tuple(zip(*rows, strict=True))


def both(matrix: Matrix, other: Matrix) -> Matrix:
    """Return the sum of two matrices."""
    return tuple(map(plus, matrix, other))


def _mixed(factors: Sequence[Scalar], values: Sequence[Scalar]) -> Scalar:
    """Return a sum of multiples, of which those by 0 and 1 leave nothing in the equations."""
    terms = (x if k == 1.0 else k * x for k, x in zip(factors, values, strict=True) if k != 0.0)
    return sum(terms, 0.0)


class _Place:
    """Where a joint has brought its body: how vectors pass between the body and its parent."""

    def __init__(self, body: Body, q: Scalar) -> None:
        self.body = body
        self.back = transposed(body.frame)
        along = q if body.slides else 0.0
        self.offset = plus(body.offset, _scaled(along, body.axis))
        self.c: Scalar = 1.0 if body.slides else cos(q)
        self.s: Scalar = 0.0 if body.slides else sin(q)

    def outward(self, a: Vector) -> Vector:
        """Return a vector of the parent's in axes of the body."""
        x, y, z = times(self.body.frame, a)
        return (self.c * x + self.s * y, self.c * y - self.s * x, z)  # back by the angle about z

    def inward(self, a: Vector) -> Vector:
        """Return a vector of the body's in axes of the parent."""
        x, y, z = a
        return times(self.back, (self.c * x - self.s * y, self.s * x + self.c * y, z))

    def inertia(self, rows: Matrix) -> Matrix:
        """Return an inertia of the body's in axes of the parent."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = rows
        if not self.body.slides:
            c, s = self.c, self.s
            # yy - xx and not both: where they are equal nothing turns with the joint
            wide, mixed = s * (yy - xx), s * (xy + xy)
            add = s * wide - c * mixed
            xx, yy, xy = xx + add, yy - add, xy - s * mixed - c * wide
            xz, yz = c * xz - s * yz, s * xz + c * yz
        at_joint = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
        return turned(self.back, at_joint)


def joint_places(bodies: Sequence[Body], q: Sequence[Scalar]) -> list[tuple[Vector, Matrix]]:
    """Return where joints are and how their bodies stand."""
    result: list[tuple[Vector, Matrix]] = []
    for body, coordinate in zip(bodies, q, strict=True):
        place = _Place(body, coordinate)
        at, axes = (NONE, UNIT) if body.parent == BASE else result[body.parent]
        own = [times(axes, place.inward(row)) for row in UNIT]
        result.append((plus(at, times(axes, place.offset)), transposed(own)))
    return result


@dataclass
class _Beyond:
    """What a joint carries, its own body and all that is joined to it, about the joint."""

    mass: Scalar
    moment: Vector
    inertia: Matrix


def _carried(bodies: Sequence[Body], places: Sequence[_Place]) -> tuple[list[_Beyond], Vector]:
    """Return what each joint carries, and mass times place of all bodies in axes of the base."""
    result = [_Beyond(body.mass, body.moment, body.inertia) for body in bodies]
    base: Vector = NONE
    # Bodies stand behind what carries them: from the last one inwards all beyond is known.
    for i, body in reversed(list(enumerate(bodies))):
        own, place = result[i], places[i]
        moment = place.inward(own.moment)
        reached = plus(moment, _scaled(own.mass, place.offset))
        if body.parent == BASE:
            base = plus(base, reached)
            continue
        more = about(own.mass, moment, place.offset)
        more = both(more, place.inertia(own.inertia))
        # The rotor takes part in the motion of the link on which it sits, about its axis.
        more = both(more, tuple(_scaled(body.rotor * k, body.axis) for k in body.axis))
        parent = result[body.parent]
        parent.mass = parent.mass + own.mass
        parent.moment = plus(parent.moment, reached)
        parent.inertia = both(parent.inertia, more)
    return result, base


def mass_matrix_of(bodies: Sequence[Body], q: Sequence[Scalar]) -> list[list[Scalar]]:
    """Return the mass matrix: what each joint takes for an acceleration of one of them."""
    places = [_Place(body, coordinate) for body, coordinate in zip(bodies, q, strict=True)]
    carried, _ = _carried(bodies, places)
    rows: list[list[Scalar]] = [[0.0] * len(bodies) for _ in bodies]
    for i, (body, own) in enumerate(zip(bodies, carried, strict=True)):
        # Force and torque about joint i that a unit acceleration of it takes, then passed on to the
        # base.
        x, y, _ = own.moment
        force: Vector
        torque: Vector
        if body.slides:
            force, torque = (0.0, 0.0, own.mass), (y, -x, 0.0)
        else:
            force, torque = (-y, x, 0.0), tuple(row[2] for row in own.inertia)
        at = i
        motor = body.armature + body.gear * body.gear * body.rotor
        rows[i][i] = (force if body.slides else torque)[2] + motor
        while bodies[at].parent != BASE:
            force = places[at].inward(force)
            torque = plus(places[at].inward(torque), _cross(places[at].offset, force))
            # The rotor turns with its link and by its gear, J (w + n q'): n J couples both.
            if at == i:
                torque = plus(torque, _scaled(body.gear * body.rotor, body.axis))
            at = bodies[at].parent
            rows[i][at] = rows[at][i] = (force if bodies[at].slides else torque)[2]
    return rows


def taken_by(
    bodies: Sequence[Body], q: Sequence[Scalar], q_dot: Sequence[Scalar], gravity: Vector
) -> list[Scalar]:
    """Return what each joint takes so that no rate changes: weight, Coriolis and the like.

    A body's points accelerate by ``a + alpha x r + omega x (omega x r)``, with that of free fall
    taken off a.
    """
    places = [_Place(body, coordinate) for body, coordinate in zip(bodies, q, strict=True)]
    carried, _ = _carried(bodies, places)
    motions: list[tuple[Vector, Vector, Vector]] = []
    taken: list[Scalar] = []
    forces: list[Vector] = [NONE] * len(bodies)
    torques: list[Vector] = [NONE] * len(bodies)
    pushed: list[tuple[Vector, Vector]] = []
    for body, place, own, rate in zip(bodies, places, carried, q_dot, strict=True):
        # Free fall as an acceleration of the base against it: weight needs no terms of its own.
        held = (NONE, NONE, _scaled(-1.0, gravity))
        before, spin, fall = held if body.parent == BASE else motions[body.parent]
        p = place.offset
        fall = plus(fall, plus(_cross(spin, p), _cross(before, _cross(before, p))))
        w, alpha, a = place.outward(before), place.outward(spin), place.outward(fall)
        # what this joint adds to the motion of all beyond it, and what that takes
        swept = (w[1] * rate, -(w[0] * rate), 0.0)  # w x z rate
        if body.slides:
            omega = w
            extra = _scaled(2.0, swept)
            a = plus(a, extra)
            push, twist = _scaled(own.mass, extra), _cross(own.moment, extra)
        else:
            omega = (w[0], w[1], w[2] + rate)
            alpha = plus(alpha, swept)
            x, y, _ = own.moment
            push = _cross(_scaled(rate, plus(w, omega)), (-y, x, 0.0))
            u = times(own.inertia, w)
            column = (own.inertia[0][2], own.inertia[1][2], own.inertia[2][2])
            twist = plus(
                times(own.inertia, swept),
                _scaled(rate, plus((-u[1], u[0], 0.0), _cross(omega, column))),
            )
        motions.append((omega, alpha, a))
        pushed.append((push, twist))
        # By its gear the joint also feels the rotor's part in the link's angular acceleration.
        taken.append(body.gear * body.rotor * _dot(spin, body.axis))
        if body.parent != BASE:
            # The gyroscopic torque of the spinning rotor on its link.
            swung = _scaled(body.gear * body.rotor * rate, _cross(before, body.axis))
            torques[body.parent] = plus(torques[body.parent], swung)
    # Inwards: each joint takes what acts along its axis and passes all of it on.
    for i, body in reversed(list(enumerate(bodies))):
        own, place, (omega, alpha, a) = carried[i], places[i], motions[i]
        if body.slides:
            whole = plus(_cross(alpha, own.moment), _cross(omega, _cross(omega, own.moment)))
            taken[i] = taken[i] + own.mass * a[2] + whole[2] + forces[i][2]
        else:
            whole = plus(times(own.inertia, alpha), _cross(omega, times(own.inertia, omega)))
            taken[i] = taken[i] + _cross(own.moment, a)[2] + whole[2] + torques[i][2]
        if body.parent == BASE:
            continue
        push = place.inward(plus(pushed[i][0], forces[i]))
        twist = place.inward(plus(pushed[i][1], torques[i]))
        forces[body.parent] = plus(forces[body.parent], push)
        lever = _cross(place.offset, push)
        torques[body.parent] = plus(torques[body.parent], plus(twist, lever))
    return taken


@dataclass(frozen=True, kw_only=True)
class JointedMechanism(MatrixMechanism, ABC):
    """Rigid bodies joined in a tree, a coordinate to each joint: arms and robots.

    Mass matrix and forces come from recursions along the tree.
    """

    @abstractmethod
    def bodies(self) -> Sequence[Body]:
        """Return the bodies by coordinate, each behind the one that carries it."""

    @abstractmethod
    def free_fall(self) -> Vector:
        """Return the acceleration of free fall in axes of the base [m/s^2]."""

    @abstractmethod
    def motors(
        self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar], drives: Mapping[str, Scalar]
    ) -> Mapping[str, Scalar]:
        """Return the torques [N m] and forces [N] of drives and motors, by coordinate.

        Parameters
        ----------
        q : mapping of str to float or array
            Coordinates by name.
        q_dot : mapping of str to float or array
            Rates by name of the coordinate.
        drives : mapping of str to float or array
            Present values of the drives by name.

        Returns
        -------
        mapping of str to float or array
            One for each coordinate.
        """

    def damped(self, q_dot: Mapping[str, Scalar]) -> Mapping[str, Scalar]:
        """Return the torques [N m] and forces [N] of dampers, by coordinate; none if not given."""
        return dict.fromkeys(q_dot, 0.0)

    def transmission(self) -> Sequence[Sequence[float]] | None:
        """Return the rows of what angles of the joints are of the coordinates; None if the same."""
        return None

    @final
    def joint_values(self, values: Mapping[str, Scalar]) -> list[Scalar]:
        """Return angles of the joints from coordinates, or their rates from rates.

        Parameters
        ----------
        values : mapping of str to float or array
            Coordinates or rates by name of the coordinate.

        Returns
        -------
        list
            One for each joint.
        """
        own, rows = [values[name] for name in self.coordinates], self.transmission()
        return own if rows is None else [_mixed(row, own) for row in rows]

    def _taken(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Mapping[str, Scalar]:
        """Return what each coordinate takes so that no rate changes."""
        at, rates = self.joint_values(q), self.joint_values(q_dot)
        needed = taken_by(self.bodies(), at, rates, self.free_fall())
        rows = self.transmission()
        if rows is not None:
            needed = [_mixed(column, needed) for column in transposed(rows)]
        return dict(zip(self.coordinates, needed, strict=True))

    @final
    @override
    def mass_matrix(self, q: Mapping[str, Scalar]) -> Sequence[Sequence[Scalar]]:
        bodies, rows = self.bodies(), self.transmission()
        if rows is None:
            return mass_matrix_of(bodies, self.joint_values(q))
        still = [replace(body, armature=0.0) for body in bodies]
        half = [
            [_mixed(column, row) for column in transposed(rows)]
            for row in mass_matrix_of(still, self.joint_values(q))
        ]
        result = [
            [_mixed(column, other) for other in transposed(half)] for column in transposed(rows)
        ]
        for i, body in enumerate(bodies):  # motors turn with the coordinates
            result[i][i] = result[i][i] + body.armature
        return result

    @final
    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        motors, damped = self.motors(q, q_dot, drives), self.damped(q_dot)
        taken = self._taken(q, q_dot)
        return {name: motors[name] + damped[name] - taken[name] for name in self.coordinates}

    @final
    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        still = dict.fromkeys(self.coordinates, 0.0)
        gravity = {name: -1.0 * force for name, force in self._taken(q, still).items()}
        motors, damped = self.motors(q, q_dot, drives), self.damped(q_dot)
        result = {}
        for contact in self.contacts():
            (x,) = contact.slips
            result[contact.name] = gear_inputs(
                motors[x], gravity[x] + damped[x], gravity=gravity[x], position=q[x]
            )
        return result

    @final
    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        bodies = self.bodies()
        joints = zip(bodies, self.joint_values(q), strict=True)
        _, place = _carried(bodies, [_Place(body, joint) for body, joint in joints])
        return -1.0 * _dot(self.free_fall(), place)

    @final
    @override
    def power(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Scalar:
        motors, damped = self.motors(q, q_dot, drives), self.damped(q_dot)
        return sum(((motors[x] + damped[x]) * q_dot[x] for x in self.coordinates), 0.0)
