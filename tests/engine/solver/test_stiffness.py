"""Runs take the stepper for stiff modes where a motion has died away that keeps steps short."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
import pytest
from tests.contact_cases import Plain

from stickslip import Coulomb, EventDriven, Stribeck, simulate
from stickslip.maths import sin
from stickslip.mechanisms import Contact
from stickslip.quantities import Quantity

STEADY, SWING = 3.0, 1.0
"""Torque of the motor, and amplitude of its ripple of 1 rad/s [N m]."""


@dataclass(frozen=True, kw_only=True)
class Damped(Plain):
    """A rotor in thick oil, turned by a motor; another one beside it rests."""

    name: ClassVar[str] = "damped"
    coordinates: ClassVar[tuple[str, ...]] = ("a", "b")
    rates: ClassVar[tuple[str, ...]] = ("a_dot", "b_dot")
    units: ClassVar[tuple[str, ...]] = ("rad", "rad")
    damping: Annotated[float, Quantity("c", "N m s/rad", low=0)] = 1e5
    ripple: bool = True
    """Whether the torque has one; else all modes are linear."""

    def kinetic_energy(self, q, q_dot):
        return 0.5 * sum(q_dot[i] * q_dot[i] for i in self.coordinates)

    def forces(self, t, q, q_dot, drives):
        torque = STEADY + SWING * sin(t) if self.ripple else STEADY
        return {"a": torque - self.damping * q_dot["a"]}

    def contacts(self):
        return tuple(Contact(name=i, slip=i, load=1.0) for i in self.coordinates)


class Alone(Damped):
    coordinates = ("a",)
    rates = ("a_dot",)
    units = ("rad",)


def rate_of(t, c, level, swing):
    """Return the rate from rest, of unit inertia."""
    fading = np.exp(-c * t)
    wave = (c * np.sin(t) - np.cos(t) + fading) / (c * c + 1.0)
    return (STEADY - level) / c * (1.0 - fading) + swing * wave


@pytest.mark.parametrize("ripple", [True, False])
@pytest.mark.parametrize("kind", [Alone, Damped])
def test_a_rotor_in_thick_oil_takes_few_steps(kind, ripple):
    rotor, level = kind(ripple=ripple), 0.5
    solver = EventDriven(tier="python", max_steps=2000)
    run = simulate(rotor, Coulomb(kinetic_coefficient=level), t_end=10.0, solver=solver)
    t = np.concatenate([np.geomspace(1e-7, 1e-3, 20), np.linspace(0.01, 10.0, 50)])
    expected = rate_of(t, rotor.damping, level, SWING * ripple)
    np.testing.assert_allclose(run.at(t)["a_dot"], expected, atol=1e-9 * expected.max())
    assert run.certificate.certified
    # its time is 1e-5 s: an explicit method takes 160,000 steps at the least, and a series 50,000
    assert run.certificate.steps < 1000


def test_a_stiff_rotor_stops_and_goes_on_as_it_does_alone():
    law = Stribeck(
        kinetic_coefficient=2.5, static_coefficient=3.2, stribeck_velocity=1e-3,
        viscous_coefficient=0.1,
    )  # fmt: skip
    runs = [simulate(kind(damping=1e4), law, t_end=20.0) for kind in (Alone, Damped)]
    alone, beside = runs
    first = [(e.reason, e.t) for e in alone.events]
    other = [(e.reason, e.t) for e in beside.contact("a").events]
    assert [reason for reason, _ in first] == [reason for reason, _ in other]
    assert {"stop", "break-away"} <= {reason for reason, _ in first}
    times = ([t for _, t in events] for events in (first, other))
    np.testing.assert_allclose(*times, atol=1e-8)
    assert math.isclose(alone["a"][-1], beside["a"][-1], rel_tol=1e-8)
    assert beside.certificate.steps < 2 * alone.certificate.steps
