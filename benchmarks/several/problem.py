"""Mechanisms with several contacts, and where they end."""

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from benchmarks.several.brakes import ClutchTrain, Lining, Rotor
from stickslip.friction import Coulomb, Laws
from stickslip.mechanisms import Contact, MatrixMechanism, Mechanism, TwoLinkArm
from stickslip.mechanisms.drives import Sampled, Sine

Run: TypeAlias = Callable[[], np.ndarray]
"""Returns the last places: of blocks [m], angles of links to each other and of rotors [rad]."""

COUPLING, GROUND = 100.0, 10.0
"""Springs between neighbours and to the ground [N/m]."""
UPPER, LOWER, LENGTH, G = 1.0, 0.5, 0.4, 9.81
"""Masses at the ends of the two links [kg], length of each [m], gravity [m/s^2]."""
BENT = (1.2, 0.8)
"""Angles from which the arm falls [rad]."""
SPEED, TORQUE, PRESS, MU = 10.0, 10.0, 20.0, 0.5
"""Speed of the first rotor [rad/s], its torque [N m], force on the linings [N], friction."""
SECOND, THIRD = 0.4, 0.9
"""Times at which the second and the third clutch close [s]."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One mechanism, and where it ends."""

    title: str
    mechanism: Mechanism
    kinetic: np.ndarray
    """Kinetic levels by contact, over the loads."""
    static: np.ndarray
    start: Mapping[str, float]
    t_end: float
    exact: Mapping[int, float]
    """Last places by index."""

    @property
    def laws(self) -> Laws:
        """Friction of each contact."""
        names = [contact.name for contact in self.mechanism.contacts()]
        levels = zip(names, self.kinetic.tolist(), self.static.tolist(), strict=True)
        return Laws(
            members=tuple(
                (name, Coulomb(kinetic_coefficient=k, static_coefficient=s))
                for name, k, s in levels
            )
        )

    def error(self, places: np.ndarray) -> float:
        """Return the largest difference from where it ends."""
        return max(abs(float(places[i]) - place) for i, place in self.exact.items())


def levels(n: int) -> np.ndarray:
    """Return the levels of friction of the blocks [N]."""
    return np.array([1.0 + 0.2 * round((0.6180339887498949 * i) % 1, 4) for i in range(1, n + 1)])


def speeds(n: int) -> np.ndarray:
    """Return the velocities of the blocks at time 0 [m/s]."""
    return np.array([round(3 * math.sin(1.7 * i), 4) for i in range(1, n + 1)])


def stiffness(n: int) -> np.ndarray:
    """Return the stiffness matrix of the blocks [N/m]."""
    matrix = np.diag(np.full(n, GROUND))
    for i in range(n - 1):
        matrix[i : i + 2, i : i + 2] += COUPLING * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return matrix


ENDS = {
    10: {0: 0.018857517895138, 9: -0.015876996463554},
    100: {0: -0.006682498644870, 99: -0.002817755329667},
}
"""Last places of chains, from Taylor series of order 26 with numbers of 80 bits [m]."""


class Chain(MatrixMechanism):
    """Blocks of 1 kg on the ground without damping, each rubbing with a load of 1 N."""

    name = "chain"

    def mass_matrix(self, q):
        return np.eye(len(self.coordinates)).tolist()

    def forces(self, t, q, q_dot, drives):
        x, result = [q[name] for name in self.coordinates], {}
        for i, name in enumerate(self.coordinates):
            total = -GROUND * x[i]
            for j in (i - 1, i + 1):
                if 0 <= j < len(x):
                    total = total + COUPLING * (x[j] - x[i])
            result[name] = total
        return result

    def potential_energy(self, t, q):
        x = [q[name] for name in self.coordinates]
        total = sum((0.5 * GROUND * a * a for a in x), 0.0)
        for a, b in itertools.pairwise(x):
            total = total + 0.5 * COUPLING * (b - a) * (b - a)
        return total

    def contacts(self):
        return tuple(Contact(slip=name, load=1.0, name=name) for name in self.coordinates)

    def drives(self):
        return {}


def blocks(n: int) -> Chain:
    """Return a chain of n blocks."""
    names = {
        "coordinates": tuple(f"x{i}" for i in range(1, n + 1)),
        "rates": tuple(f"v{i}" for i in range(1, n + 1)),
        "units": ("m",) * n,
    }
    return type(f"Chain{n}", (Chain,), names)()


def chain(n: int) -> Case:
    """Return n coupled blocks that come to rest."""
    mechanism = blocks(n)
    return Case(
        title=f"{n} blocks",
        mechanism=mechanism,
        kinetic=levels(n),
        static=levels(n),
        start=dict(zip(mechanism.rates, speeds(n).tolist(), strict=True)),
        t_end=10.0,
        exact=ENDS.get(n, {}),
    )


def arm() -> Case:
    """Return a falling arm; its end is SciPy's at 1e-13 with bordered matrices."""
    square = LENGTH * LENGTH
    links = TwoLinkArm(
        upper_mass=UPPER, upper_length=LENGTH, upper_centre=LENGTH, upper_inertia=UPPER * square,
        lower_mass=LOWER, lower_centre=LENGTH, lower_inertia=LOWER * square, gravity=G,
    )  # fmt: skip
    return Case(
        title="arm",
        mechanism=links,
        kinetic=np.array([0.3, 0.12]),
        static=np.array([0.45, 0.2]),
        start=dict(zip(links.coordinates, BENT, strict=True)),
        t_end=6.0,
        exact={0: -0.5660082511329, 1: -0.4030025089844},
    )


TURNED = (7.486119099114310, 4.107137416329478, 2.710464436231381, 1.173743877600518)
"""Last angles of the rotors [rad]."""


def clutches() -> Case:
    """Return four rotors and three clutches (Modelica's CoupledClutches); its end by 40 digits."""
    closing = (
        Sine(amplitude=PRESS, frequency=0.2, phase=math.pi / 2),
        Sampled(times=(0.0, SECOND), values=(0.0, PRESS)),
        Sampled(times=(0.0, THIRD), values=(0.0, PRESS)),
    )
    torque = Sine(amplitude=TORQUE, frequency=5.0)
    train = ClutchTrain(
        rotors=[Rotor(inertia=1.0, torque=torque), *[Rotor(inertia=1.0)] * 3],
        clutches=[Lining(radius=1.0, press=press) for press in closing],
    )
    return Case(
        title="clutches",
        mechanism=train,
        kinetic=np.full(3, MU),
        static=np.full(3, 1.1 * MU),
        start={"omega": SPEED, "psi1_dot": -SPEED},
        t_end=1.5,
        exact={
            0: 7.4861190991143101,
            1: 4.1071374163294776,
            2: 2.7104644362313807,
            3: 1.1737438776005176,
        },
    )


def loads(t: float) -> np.ndarray:
    """Return the forces on the linings at a time [N]."""
    first = PRESS * math.cos(0.4 * math.pi * t)
    return np.array([max(first, 0.0), PRESS * (t >= SECOND), PRESS * (t >= THIRD)])


def torque(t: float) -> float:
    """Return the torque on the first rotor at a time [N m]."""
    return TORQUE * math.sin(10.0 * math.pi * t)


CASES = {"chain": lambda: chain(10), "arm": arm, "clutches": clutches}
