"""A robot's arm with six joints that rub, against Pinocchio's dynamics and SciPy.

The reference is the study that preceded this design: equations by Pinocchio, integrated by DOP853
at 1e-13 with the modes of six joints tried one after the other. Both agreed to 1e-11 s up to 2 s;
later the motion is chaotic and errors grow a hundredfold a second.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
import pytest
from tests.contact_cases import Plain, coulomb

from stickslip import EventDriven, simulate
from stickslip.maths import cos, sin
from stickslip.mechanisms import Contact
from stickslip.quantities import Quantity

# along each link's axis and to its side [m], cosine and sine of its twist, mass [kg], centre [m],
# inertia about the centre [kg m^2]: those of a UR5
LINKS = (
    (0.089159, 0.0, 0.0, 1.0, 3.7, (0.0, -0.02561, 0.00193), (0.0084, 0.0064, 0.0084)),
    (0.0, -0.425, 1.0, 0.0, 8.393, (0.2125, 0.0, 0.11336), (0.0078, 0.21, 0.21)),
    (0.0, -0.39225, 1.0, 0.0, 2.33, (0.15, 0.0, 0.0265), (0.0016, 0.0462, 0.0462)),
    (0.10915, 0.0, 0.0, 1.0, 1.219, (0.0, -0.0018, 0.01634), (0.0016, 0.0016, 0.0009)),
    (0.09465, 0.0, 0.0, -1.0, 1.219, (0.0, 0.0018, 0.01634), (0.0016, 0.0016, 0.0009)),
    (0.0823, 0.0, 1.0, 0.0, 0.1879, (0.0, 0.0, -0.001159), (0.0001, 0.0001, 0.0001)),
)


def cross(a, b):
    """Return the vector product."""
    pairs = ((1, 2), (2, 0), (0, 1))
    return tuple(a[i] * b[j] - a[j] * b[i] for i, j in pairs)


def plus(a, b):
    return tuple(x + y for x, y in zip(a, b, strict=True))


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@dataclass(frozen=True, kw_only=True)
class SixJoints(Plain):
    """A serial arm, link by link from its base; the torque of a motor shakes its shoulder."""

    name: ClassVar[str] = "six-joints"
    coordinates: ClassVar[tuple[str, ...]] = tuple(f"q{i}" for i in range(1, 7))
    rates: ClassVar[tuple[str, ...]] = tuple(f"w{i}" for i in range(1, 7))
    units: ClassVar[tuple[str, ...]] = ("rad",) * 6
    payload: Annotated[float, Quantity("m_p", "kg")] = 1.0
    rotor: Annotated[float, Quantity("J_r", "kg m^2")] = 0.1
    level: Annotated[float, Quantity("A", "N m")] = 8.0

    def links(self, q, q_dot):
        """Yield mass, inertia, velocity of the centre, rate of turn and height of each link."""
        turn, velocity, up, height = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0
        for name, (along, aside, ct, st, mass, centre, inertia) in zip(
            self.coordinates, LINKS, strict=True
        ):
            c, s = cos(q[name]), sin(q[name])

            def turned(x, c=c, s=s, ct=ct, st=st):
                first, second = c * x[0] + s * x[1], c * x[1] - s * x[0]
                return first, ct * second + st * x[2], ct * x[2] - st * second

            turn = turned((turn[0], turn[1], turn[2] + q_dot[name]))
            up, arm = turned(up), (aside, st * along, ct * along)
            velocity = plus(turned(velocity), cross(turn, arm))
            height = height + dot(arm, up)
            yield mass, inertia, plus(velocity, cross(turn, centre)), turn, height + dot(centre, up)
        yield self.payload, (0.0, 0.0, 0.0), velocity, turn, height

    def kinetic_energy(self, q, q_dot):
        total = 0.0
        for mass, inertia, v, turn, _ in self.links(q, q_dot):
            own = sum((i * x * x for i, x in zip(inertia, turn, strict=True)), 0.0)
            total = total + 0.5 * (mass * dot(v, v) + own)
        for i in self.coordinates:
            total = total + 0.5 * self.rotor * q_dot[i] * q_dot[i]
        return total

    def potential_energy(self, t, q):
        still = dict.fromkeys(self.coordinates, 0.0)
        return sum((mass * 9.81 * z for mass, _, _, _, z in self.links(q, still)), 0.0)

    def forces(self, t, q, q_dot, drives):
        return {"q2": self.level * sin(np.pi * t)}

    def contacts(self):
        return tuple(Contact(name=i, slip=i, load=1.0) for i in self.coordinates)


LEVELS = ((1.0, 1.4), (1.2, 1.6), (0.8, 1.1), (0.3, 0.45), (0.3, 0.45), (0.2, 0.3))
START = (0.3, -1.2, 0.9, -0.6, 0.4, 0.2)
CHANGES = (
    (0.18560758999, "q4"),
    (0.25463098791, "q4"),
    (0.30489569365, "q3"),
    (0.38660392405, "q1"),
    (0.40809748085, "q5"),
    (0.64656012793, "q3"),
    (0.75717633250, "q4"),
    (0.76432625748, "q2"),
    (0.84203125209, "q1"),
    (0.85276347079, "q2"),
)
STOP = 1.39664965401
"""When the first joint stops [s]."""
END = (-1.283338505, 7.982650928, 3.062804467, -7.831914021, 3.872642595, 0.2)


@pytest.mark.slow
def test_changes_of_six_joints():
    arm = SixJoints()
    laws = {f"q{i}": coulomb(*level) for i, level in enumerate(LEVELS, 1)}
    y0 = {f"q{i}": q for i, q in enumerate(START, 1)}
    solver = EventDriven(tier="compiled", tolerance=1e-12)
    run = simulate(arm, laws, t_end=2.0, y0=y0, solver=solver)
    assert run.certificate.certified
    assert run.certificate.stick_drift == 0.0
    assert len(run.events) == 16
    assert [e.contact for e in run.events[: len(CHANGES)]] == [name for _, name in CHANGES]
    times = [e.t for e in run.events[: len(CHANGES)]]
    # half a unit of the last printed digit, and ten times what reference and study differ by
    np.testing.assert_allclose(times, [t for t, _ in CHANGES], atol=1e-10)
    stops = [e.t for e in run.events if e.contact == "q1" and e.reason == "stop"]
    assert stops == pytest.approx([STOP], abs=1e-10)
    np.testing.assert_allclose([run[f"q{i}"][-1] for i in range(1, 7)], END, atol=6e-9)
    assert np.all(run["q6"] == 0.2)
