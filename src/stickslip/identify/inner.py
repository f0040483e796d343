r"""What inner bodies do to the measured coordinate: a pendulum on a cart, a mass in a capsule.

Of a mechanism of several coordinates only the one that slips, :math:`x(t)`, was measured. The
others follow from it, as nothing of them rubs:

.. math:: M_{hh}\,\ddot q_h = h_h(t, q, \dot q) - M_{hx}\,\ddot x ,

from the start that the mechanism, or the record, says; those whose acceleration is prescribed take
it. They push the measured one by :math:`h_x - M_{xh}\,\ddot q_h`, and press it to the ground by the
reaction of its normal coordinate. Mass matrix and forces are differences of the energies,
:math:`M_{ij} = T(e_i + e_j) - T(e_i) - T(e_j)`, :math:`h = Q + \partial_q T - \partial_q V - \dot M
\dot q`; steps are those of Runge and Kutta, one from sample to sample.
"""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.identify.fits import applied_force, drives_itself
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import Mechanism, normal_of, slip_of
from stickslip.show.formatting import number

Array = NDArray[np.float64]

SMALL = float(np.cbrt(np.finfo(float).eps))
"""Difference of a coordinate for slopes of energies [m or rad]: rounding and bend weigh alike."""
ROUGHEST = 100.0
"""Friction over the load beyond which the motion of inner bodies was not followed: no coefficient
is so large, and steps that are too long for a stiff stop make forces of any size."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Pushed:
    """What inner bodies do to the coordinate that was measured."""

    force: Array
    """Force on it without inertia and friction (n,) [N]."""
    inertia: float
    """What moves with it [kg]."""
    load: Array | None
    """Normal force (n,) [N]; None where the contact has a constant one."""


def pushed(mechanism: Mechanism, record: Measurement, x: Array, v: Array) -> Pushed:
    """Return what inner bodies do along a record of the coordinate that slips.

    Examples
    --------
    >>> from stickslip import PendulumCart
    >>> cart = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3)
    >>> rest = np.zeros(50)
    >>> record = Measurement(time=np.arange(50) * 0.01, position=rest)
    >>> found = pushed(cart, record, rest, rest)
    >>> round(found.inertia, 6), round(float(found.load[-1]), 6), float(np.ptp(found.force))
    (0.6, 5.886, 0.0)
    """
    time = np.asarray(record.time, dtype=float)
    body = _Body.of(mechanism, record)
    a = np.gradient(v, time)
    q, q_dot, q_ddot = body.moved(time, x, v, a)
    mass, forces = body.equations(time, q, q_dot, body.drives(time))
    at = body.names.index(slip_of(mechanism))
    inertia = mass[at][at] + 0.0 * time
    if np.ptp(inertia) > THRESHOLDS.rounding * np.max(inertia):
        raise InputError(
            f"the force balance of {type(mechanism).__name__} has an inertia that changes along the"
            " motion, and serves none: record the travel to rest instead, which runs of laws tell."
        )
    others = [j for j in range(body.moving) if j != at]
    force = forces[at] - sum(mass[at][j] * q_ddot[j] for j in others)
    load = None
    if normal_of(mechanism) is not None:
        k = body.moving
        load = sum(mass[k][j] * q_ddot[j] for j in range(body.moving)) - forces[k]
    mean, left = float(np.mean(inertia)), force - inertia * a
    weight = math.inf if load is None else float(np.median(np.abs(load)))
    if not (np.isfinite(left).all() and np.median(np.abs(left)) <= ROUGHEST * weight):
        raise InputError(
            f"what moves inside {type(mechanism).__name__} cannot be followed from sample to sample"
            f" of {number(float(np.median(np.diff(time))), 2)} s: it is faster than that. Of films"
            ' of the position, ask for travels: --route travel, or route="travel".'
        )
    return Pushed(force=force + 0.0 * time, inertia=mean, load=load)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Body:
    """The equations of a mechanism at numbers or arrays, and how its drives are driven."""

    mechanism: Mechanism
    names: tuple[str, ...]
    """Coordinates, then those that are held at 0."""
    moving: int
    applied: tuple[Array, Array] | None
    """Times and values (n,) of what was recorded as the drive."""
    start: Mapping[str, float]

    @classmethod
    def of(cls, mechanism: Mechanism, record: Measurement) -> "_Body":
        normal = normal_of(mechanism)
        held = [*([] if normal is None else [normal]), *mechanism.held()]
        time = np.asarray(record.time, dtype=float)
        applied = None if drives_itself(mechanism, record) else applied_force(mechanism, record)
        return cls(
            mechanism=mechanism,
            names=(*mechanism.coordinates, *dict.fromkeys(held)),
            moving=len(mechanism.coordinates),
            applied=None if applied is None else (time, np.asarray(applied, dtype=float)),
            start={name: float(x) for name, x in {**mechanism.start(), **record.initial}.items()},
        )

    def drives(self, time: Any) -> dict[str, Any]:
        """Return the values of the drives at a time, or at times (n,)."""
        result: dict[str, Any] = {
            name: np.vectorize(drive.value, otypes=[float])(time)
            for name, drive in self.mechanism.drives().items()
        }
        if self.applied is not None:
            result["drive"] = np.interp(time, *self.applied)
        return result

    def equations(
        self, time: Any, q: Sequence[Any], q_dot: Sequence[Any], drives: Mapping[str, Any]
    ) -> tuple[list[list[Any]], list[Any]]:
        """Return rows of the mass matrix, and forces, of all names."""
        count = len(self.names)
        places, rates = [*q, *[0.0] * (count - len(q))], [*q_dot, *[0.0] * (count - len(q))]

        def energy(at: Sequence[Any], moving: Mapping[int, Any]) -> Any:
            rate = defaultdict(float, {self.names[i]: x for i, x in moving.items()})
            return self.mechanism.kinetic_energy(dict(zip(self.names, at, strict=True)), rate)

        def shifted(i: int, by: float) -> list[Any]:
            return [x + by * (j == i) for j, x in enumerate(places)]

        def momentum(at: Sequence[Any], i: int) -> Any:
            up, down = ({**dict(enumerate(rates)), i: rates[i] + side} for side in (0.5, -0.5))
            return energy(at, up) - energy(at, down)

        single = [energy(places, {i: 1.0}) for i in range(count)]
        mass = [
            [
                2.0 * single[i]
                if i == j
                else energy(places, {i: 1.0, j: 1.0}) - single[i] - single[j]
                for j in range(self.moving)
            ]
            for i in range(count)
        ]
        q_of, q_dot_of = (dict(zip(self.names, item, strict=True)) for item in (places, rates))
        other = self.mechanism.forces(time, q_of, q_dot_of, drives)
        ahead, behind = (
            [x + side * SMALL * rate for x, rate in zip(places, rates, strict=True)]
            for side in (1.0, -1.0)
        )
        forces = []
        for i, name in enumerate(self.names):
            up, down = shifted(i, SMALL), shifted(i, -SMALL)
            kinetic = energy(up, dict(enumerate(rates))) - energy(down, dict(enumerate(rates)))
            potential = self.mechanism.potential_energy(
                time, dict(zip(self.names, up, strict=True))
            ) - self.mechanism.potential_energy(time, dict(zip(self.names, down, strict=True)))
            changing = momentum(ahead, i) - momentum(behind, i)
            forces.append(other.get(name, 0.0) + (kinetic - potential - changing) / (2.0 * SMALL))
        return mass, forces

    def moved(
        self, time: Array, x: Array, v: Array, a: Array
    ) -> tuple[list[Array], list[Array], list[Array]]:
        """Return places, rates and accelerations (n,) of all coordinates along a record."""
        mechanism = self.mechanism
        slip = self.names.index(slip_of(mechanism))
        inner = [j for j in range(self.moving) if j != slip]
        guides = {self.names.index(name): item.drive for name, item in mechanism.guided().items()}

        def rates_of(t: float, state: Array) -> tuple[Array, Array]:
            q, q_dot = np.zeros(self.moving), np.zeros(self.moving)
            q[inner], q_dot[inner] = np.split(state, 2)
            q[slip], q_dot[slip] = np.interp(t, time, x), np.interp(t, time, v)
            drives = {name: float(drive) for name, drive in self.drives(t).items()}
            known = {slip: float(np.interp(t, time, a))}
            known |= {j: drives[name] for j, name in guides.items()}
            free = [j for j in inner if j not in known]
            q_ddot = np.zeros(self.moving)
            q_ddot[[*known]] = [*known.values()]
            if free:
                mass, forces = self.equations(t, q.tolist(), q_dot.tolist(), drives)
                m = np.array(mass[: self.moving], dtype=float)
                right = np.array(forces[: self.moving], dtype=float)[free]
                right -= m[np.ix_(free, [*known])] @ np.array([*known.values()])
                q_ddot[free] = np.linalg.solve(m[np.ix_(free, free)], right)
            return np.concatenate([q_dot[inner], q_ddot[inner]]), q_ddot

        begun = [self.start.get(mechanism.coordinates[j], 0.0) for j in inner]
        begun += [self.start.get(mechanism.rates[j], 0.0) for j in inner]
        state, states, accelerations = np.array(begun), [], []
        before = self._before(time, all_guided={*inner} <= {*guides})
        grid = np.concatenate([before, time])
        for k, t in enumerate(grid.tolist()):
            slope, q_ddot = rates_of(t, state)
            states.append(state)
            accelerations.append(q_ddot)
            if k + 1 == len(grid):
                break
            h = float(grid[k + 1]) - t
            second, _ = rates_of(t + 0.5 * h, state + 0.5 * h * slope)
            third, _ = rates_of(t + 0.5 * h, state + 0.5 * h * second)
            fourth, _ = rates_of(t + h, state + h * third)
            state = state + h / 6.0 * (slope + 2.0 * second + 2.0 * third + fourth)
        table, q_ddots = np.array(states)[len(before) :], np.array(accelerations)[len(before) :]
        q, q_dot = [x] * self.moving, [v] * self.moving
        for i, j in enumerate(inner):
            q[j], q_dot[j] = table[:, i], table[:, len(inner) + i]
        return q, q_dot, [q_ddots[:, j] for j in range(self.moving)]

    def _before(self, time: Array, *, all_guided: bool) -> Array:
        """Return times (m,) from the start of a drive to that of a record which begins later."""
        first, step = float(time[0]), float(np.median(np.diff(time)))
        if self.applied is not None or not self.mechanism.drives() or first <= step:
            return np.zeros(0)
        if not all_guided:
            raise InputError(
                f"the record begins {number(first, 3)} s after the drive of"
                f" {type(self.mechanism).__name__}, and what moves inside is only known from its"
                " start: record from there."
            )
        return np.linspace(0.0, first, math.ceil(first / step), endpoint=False)
