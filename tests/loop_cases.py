"""Inertias between which clutches close loops, and their motion by enumeration of all modes."""

import itertools
from dataclasses import dataclass, make_dataclass
from typing import Annotated, ClassVar

import numpy as np
from scipy.optimize import linprog
from tests.contact_cases import Plain

from stickslip import Coulomb
from stickslip.mechanisms import Contact
from stickslip.quantities import Quantity


@dataclass(frozen=True, kw_only=True)
class Rotors(Plain):
    """Inertias with a torque on each, of which pairs rub on each other."""

    name: ClassVar[str] = "rotors"
    edges: ClassVar[tuple[tuple[int, int], ...]] = ()

    def kinetic_energy(self, q, q_dot):
        own = enumerate(self.coordinates)
        return sum((0.5 * getattr(self, f"J{i}") * q_dot[x] * q_dot[x] for i, x in own), 0.0)

    def potential_energy(self, t, q):
        x = self.coordinates[0]
        return 0.5 * self.spring * q[x] * q[x]

    def forces(self, t, q, q_dot, drives):
        return {x: getattr(self, f"T{i}") + getattr(self, f"R{i}") * t
                for i, x in enumerate(self.coordinates)}  # fmt: skip

    def contacts(self):
        return tuple(
            Contact(
                name=f"c{k}", slip={f"x{i}": 1.0, f"x{j}": -1.0} if j >= 0 else f"x{i}", load=1.0
            )
            for k, (i, j) in enumerate(self.edges)
        )


def rotors(n, edges):
    """Return the class of n inertias that rub along some pairs; j is -1 for the ground."""
    fields = [
        (f"J{i}", Annotated[float, Quantity(f"J_{i}", "kg m^2", above=0)], 1.0) for i in range(n)
    ]
    fields += [(f"T{i}", Annotated[float, Quantity(f"T_{i}", "N m")], 0.0) for i in range(n)]
    fields += [(f"R{i}", Annotated[float, Quantity(f"R_{i}", "N m/s")], 0.0) for i in range(n)]
    fields.append(("spring", Annotated[float, Quantity("k", "N m/rad", low=0)], 0.0))
    own = {
        "name": f"rotors-{n}-{len(edges)}",
        "coordinates": tuple(f"x{i}" for i in range(n)),
        "rates": tuple(f"v{i}" for i in range(n)),
        "units": ("rad",) * n,
        "edges": tuple(edges),
        "__module__": __name__,
    }
    return make_dataclass(
        f"Rotors{n}x{len(edges)}", fields, bases=(Rotors,), namespace=own, frozen=True, kw_only=True
    )


Triangle = rotors(3, ((0, 1), (1, 2), (0, 2)))
TRIANGLE = Triangle
SQUARE = rotors(4, ((0, 1), (1, 2), (2, 3), (0, 3)))
BRACED = rotors(4, ((0, 1), (1, 2), (2, 3), (0, 3), (0, 2)))
Grounded = rotors(3, ((0, -1), (1, -1), (0, 1), (1, 2)))
GROUNDED = Grounded


def rows_of(one):
    """Return the factors of the coordinates in each slip."""
    n = len(one.coordinates)
    rows = np.zeros((len(one.edges), n))
    for row, (i, j) in zip(rows, one.edges, strict=True):
        row[i] = 1.0
        if j >= 0:
            row[j] = -1.0
    return rows


def boxed(mass, h, rows, levels):
    """Return the accelerations that make the least of a'Ma/2 - h'a + sum of levels |w a|.

    All signs of slip accelerations are tried; the answer is the one whose signs agree, and whose
    held slips have forces within their levels.
    """
    for signs in itertools.product((0, 1, -1), repeat=len(rows)):
        sign = np.array(signs, float)
        held = rows[sign == 0.0]
        force = h - rows.T @ (levels * sign)
        null = np.eye(len(h))
        if len(held):
            _, sizes, right = np.linalg.svd(held)
            null = right[(sizes > 1e-9).sum() :].T
        a = null @ np.linalg.solve(null.T @ mass @ null, null.T @ force) if null.size else 0.0 * h
        along = rows @ a
        if np.any(along * sign < -1e-12) or np.any((np.abs(along) < 1e-12) & (sign != 0.0)):
            continue
        left = force - mass @ a
        if not len(held):
            return a
        box = [(-x, x) for x in levels[sign == 0.0]]
        found = linprog(np.zeros(len(held)), A_eq=held.T, b_eq=left, bounds=box, method="highs")
        if found.status == 0:
            return a
    raise AssertionError("no mode fits")


def decided(mass, h, rows, v, kinetic, static):
    """Return the accelerations: who passes its static level goes on with its kinetic one."""
    slip = rows @ v
    sign = np.where(np.abs(slip) < 1e-12, 0.0, np.sign(slip))
    waits = sign == 0.0
    for _ in range(len(rows) + 1):
        force = h - rows.T @ (kinetic * sign)
        a = boxed(mass, force, rows[waits], static[waits])
        along = rows @ a
        moves = waits & (np.abs(along) > 1e-10)
        if not moves.any():
            break
        sign[moves], waits = np.sign(along[moves]), waits & ~moves
    along = rows @ a
    begins = np.abs(slip) < 1e-12
    if np.any(begins & (sign * along < -1e-9)) or np.any(begins & (sign != 0) & (along == 0.0)):
        sliding = np.where(begins, 0.0, np.sign(slip))
        a = boxed(mass, h - rows.T @ (kinetic * sliding), rows[begins], kinetic[begins])
    return a


TIGHT = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
"""Options of linear programming."""


def utilisation(force, rows, levels):
    """Return the least share of their levels with which held slips balance a force."""
    n = len(rows)
    bounds = np.vstack([np.hstack([s * np.eye(n), -levels[:, None]]) for s in (1.0, -1.0)])
    found = linprog(
        [*np.zeros(n), 1.0], A_ub=bounds, b_ub=np.zeros(2 * n),
        A_eq=np.column_stack([rows.T, np.zeros(rows.shape[1])]), b_eq=force,
        bounds=[*[(None, None)] * n, (0.0, None)], method="highs",
        options=TIGHT,
    )  # fmt: skip
    return found.x[-1]


NUDGE = 1e-7
"""Time [s] by which forces are ahead when it is decided who moves: all that moves begins to."""


def motion(mass, force, ramp, rows, v, kinetic, static, t_end):
    """Return the events (t, slips that change), and the rates at the end, of forces h + ramp t.

    Between events rates are quadratic in time: slips end at roots, and hold for as long as forces
    within the levels are found by linear programming.
    """
    t, events = 0.0, []
    sign = None
    for _ in range(100):
        a = decided(mass, force + ramp * (t + NUDGE), rows, v, kinetic, static)
        slip, along = rows @ v, rows @ a
        before = sign
        sign = np.where(np.abs(slip) > 1e-9, np.sign(slip), 0.0)
        begins = (sign == 0.0) & (np.abs(along) > 1e-9)
        sign[begins] = np.sign(along[begins])
        if before is not None:
            events.append((t, tuple(np.flatnonzero(sign != before))))
        held = rows[sign == 0.0]
        null = np.eye(len(v))
        if len(held):
            _, sizes, right = np.linalg.svd(held)
            null = right[(sizes > 1e-9).sum() :].T
        project = null @ np.linalg.inv(null.T @ mass @ null) @ null.T
        friction = rows.T @ (kinetic * sign)
        rate, bend = project @ (force + ramp * t - friction), project @ ramp
        length = t_end - t
        for row, s in zip(rows, sign, strict=True):
            if s != 0.0:
                c = row @ bend / 2, row @ rate, row @ v
                roots = np.roots(np.array(c) * s)
                length = min(
                    [length, *(x.real for x in roots if abs(x.imag) < 1e-12 and x.real > 1e-6)]
                )
        if len(held):
            rest = force + ramp * t - friction - mass @ rate
            box = [(0.0, length), *((-x, x) for x in static[sign == 0.0])]
            slope = -(ramp - mass @ bend)
            found = linprog(
                [-1.0, *np.zeros(len(held))], A_eq=np.column_stack([slope, held.T]), b_eq=rest,
                bounds=box, method="highs",
                options=TIGHT,
            )  # fmt: skip
            assert found.status == 0, found
            length = min(length, found.x[0])
        v = v + rate * length + bend * length**2 / 2
        t += length
        if t >= t_end - 1e-12:
            return events, v
    return None, v


def random_case(one, random):
    """Return a mechanism, its laws and a start at which some slips are at rest."""
    n, rows = len(one.coordinates), rows_of(one)
    values = {f"J{i}": float(x) for i, x in enumerate(10.0 ** random.uniform(-1.0, 1.0, n))}
    values |= {f"T{i}": float(x) for i, x in enumerate(random.uniform(-6.0, 6.0, n))}
    kinetic = random.uniform(0.1, 2.5, len(rows))
    static = kinetic * np.where(
        random.random(len(rows)) < 0.4, 1.0, random.uniform(1.0, 2.0, len(rows))
    )
    groups = random.integers(0, 3, n) if random.random() < 0.7 else np.zeros(n, int)
    speeds = random.integers(-3, 4, 3) / 2.0
    v = speeds[groups]
    laws = {
        f"c{k}": Coulomb(kinetic_coefficient=float(a), static_coefficient=float(b))
        for k, (a, b) in enumerate(zip(kinetic, static, strict=True))
    }
    return one(**values), laws, v, kinetic, static


@dataclass(frozen=True, kw_only=True)
class Geared(Plain):
    """Three inertias on the ground, and two clutches whose slips follow: factors are parameters."""

    name: ClassVar[str] = "geared"
    coordinates: ClassVar[tuple[str, ...]] = ("x0", "x1", "x2")
    rates: ClassVar[tuple[str, ...]] = ("v0", "v1", "v2")
    units: ClassVar[tuple[str, ...]] = ("rad",) * 3
    r: Annotated[float, Quantity("r", "1")] = 1.0
    s: Annotated[float, Quantity("s", "1")] = 2.0
    T0: Annotated[float, Quantity("T_0", "N m")] = 0.0
    T1: Annotated[float, Quantity("T_1", "N m")] = 0.0
    T2: Annotated[float, Quantity("T_2", "N m")] = 0.0
    R0: Annotated[float, Quantity("R_0", "N m/s")] = 0.0
    R1: Annotated[float, Quantity("R_1", "N m/s")] = 0.0
    R2: Annotated[float, Quantity("R_2", "N m/s")] = 0.0

    def kinetic_energy(self, q, q_dot):
        return sum((0.5 * (1 + i) * q_dot[f"x{i}"] * q_dot[f"x{i}"] for i in range(3)), 0.0)

    def potential_energy(self, t, q):
        return 0.0

    def forces(self, t, q, q_dot, drives):
        return {f"x{i}": getattr(self, f"T{i}") + getattr(self, f"R{i}") * t for i in range(3)}

    def contacts(self):
        return (
            *(Contact(name=f"c{i}", slip=f"x{i}", load=1.0) for i in range(3)),
            Contact(name="c3", slip={"x0": 1.0, "x1": -1.0, "x2": 1.0}, load=1.0),
            Contact(name="c4", slip={"x0": 1.0, "x1": -self.r, "x2": self.s}, load=1.0),
        )

    def rows(self):
        """Return the factors of the coordinates in each slip."""
        return np.array([*np.eye(3), [1.0, -1.0, 1.0], [1.0, -self.r, self.s]])
