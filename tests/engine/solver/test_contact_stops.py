"""Hard stops of mechanisms with several contacts, against closed forms and SciPy."""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.contact_cases import FEET, Arm, Plain, RubbingCart, coulomb

from stickslip import Axis, EventDriven, LuGre, TwoFeet, ensemble, simulate
from stickslip.engine import EventCount, EventTimes, Final, Status
from stickslip.errors import InputError
from stickslip.mechanisms import BoundedMechanism, Contact, Stop

PLAIN = EventDriven(tier="python")


def run_of(mechanism, laws, t_end, y0=None):
    """Simulate in plain Python; every run must be certified."""
    run = simulate(mechanism, laws, t_end=t_end, y0=y0, solver=PLAIN)
    assert run.certificate.stick_drift == 0.0
    return run


@dataclass(frozen=True, kw_only=True)
class Walled(BoundedMechanism, Plain):
    """Two blocks of 1 kg and 2 kg between walls, with a spring between them and a pull."""

    name: ClassVar[str] = "walled"
    coordinates: ClassVar[tuple[str, ...]] = ("x1", "x2")
    rates: ClassVar[tuple[str, ...]] = ("v1", "v2")
    units: ClassVar[tuple[str, ...]] = ("m", "m")
    spring: float = 0.0
    pull: float = 0.0
    growth: float = 0.0
    restitution: float = 0.5

    def kinetic_energy(self, q, q_dot):
        return 0.5 * (q_dot["x1"] * q_dot["x1"] + 2.0 * q_dot["x2"] * q_dot["x2"])

    def potential_energy(self, t, q):
        return 0.5 * self.spring * (q["x1"] - q["x2"]) * (q["x1"] - q["x2"])

    def forces(self, t, q, q_dot, drives):
        return {"x1": self.pull + self.growth * t}

    def contacts(self):
        return tuple(Contact(name=i, slip=i, load=1.0) for i in self.coordinates)

    def stops(self):
        sides = (("x1", 1.0, "upper"), ("x2", -1.0, "lower"))
        return tuple(
            Stop(coordinate=i, position=place, side=side, restitution=self.restitution)
            for i, place, side in sides
        )


LEVELS = {"x1": coulomb(0.5, 0.7), "x2": coulomb(0.4, 0.7)}
MOVING = {"v1": 2.0, "v2": -1.0}


def test_two_blocks_between_walls():
    run = run_of(Walled(), LEVELS, 5.0, MOVING)
    # x = 2 t - t^2 / 4 to the wall at 1 m, then back at half the speed
    hits = 4.0 - math.sqrt(12.0), (1.0 - math.sqrt(0.6)) / 0.2
    speeds = 0.5 * (2.0 - 0.5 * hits[0]), 0.5 * (1.0 - 0.2 * hits[1])
    stops = hits[0] + speeds[0] / 0.5, hits[1] + speeds[1] / 0.2
    found = [(e.contact, e.reason, e.from_mode, e.to_mode) for e in run.events]
    assert found == [
        ("x1", "x1 hits stop", 1, -1),
        ("x2", "x2 hits stop", -1, 1),
        ("x1", "stop", -1, 0),
        ("x2", "stop", 1, 0),
    ]
    assert [e.t for e in run.events] == pytest.approx([*hits, *stops], rel=1e-14)
    assert run["x1"][-1] == pytest.approx(1.0 - speeds[0] ** 2, rel=1e-14)
    assert run["x2"][-1] == pytest.approx(-1.0 + speeds[1] ** 2 / 0.4, rel=1e-14)
    # three quarters of the energies before the impacts
    lost = 0.75 * (0.5 * (2.0 * speeds[0]) ** 2 + (2.0 * speeds[1]) ** 2)
    assert run.certificate.work_stops == pytest.approx(lost, rel=1e-13)
    assert run.status is Status.AT_REST


def test_bounces_end_at_rest_under_pressure_and_the_pull_may_end_that():
    run = run_of(Walled(pull=3.0, growth=-0.5), LEVELS, 8.0, MOVING)
    rest = next(e for e in run.events if e.to_mode == 2)
    leave = next(e for e in run.events if e.from_mode == 2)
    assert rest.reason == "x1 hits stop"
    assert leave.reason == "leaves stop"
    assert leave.t == pytest.approx(7.4, rel=1e-14)  # when -0.7 N are reached
    pressed = run.at([rest.t + 0.5, 6.6])
    assert np.all(pressed["x1"] == 1.0)
    # friction takes its level of what presses while that is more, then all of it
    np.testing.assert_allclose(pressed["friction:x1"], [0.7, -0.3], rtol=1e-12)
    assert np.all(pressed["mode:x1"] == 2)


def test_copies_bounce_as_a_block_with_one_contact_does():
    axis = Axis(
        inertia=1.0, stiffness=4.0, offset=-2.0, lower_stop=-0.2, upper_stop=0.6, restitution=0.7
    )
    law = coulomb(0.05, 0.06)
    alone = simulate(axis, law, t_end=6.0, y0={"v": -0.5}, solver=PLAIN)

    @dataclass(frozen=True, kw_only=True)
    class Twice(BoundedMechanism, Plain):
        name: ClassVar[str] = "twice"
        coordinates: ClassVar[tuple[str, ...]] = ("x1", "x2")
        rates: ClassVar[tuple[str, ...]] = ("v1", "v2")
        units: ClassVar[tuple[str, ...]] = ("m", "m")

        def kinetic_energy(self, q, q_dot):
            return sum((0.5 * q_dot[i] * q_dot[i] for i in self.coordinates), 0.0)

        def potential_energy(self, t, q):
            return sum((2.0 * q[i] * q[i] - 2.0 * q[i] for i in self.coordinates), 0.0)

        def contacts(self):
            return tuple(Contact(name=i, slip=i, load=1.0) for i in self.coordinates)

        def stops(self):
            return tuple(
                Stop(coordinate=i, position=place, side=side, restitution=0.7)
                for i in self.coordinates
                for place, side in ((0.6, "upper"), (-0.2, "lower"))
            )

    run = run_of(Twice(), law, 6.0, {"v1": -0.5, "v2": -0.5})
    for name in ("x1", "x2"):
        own = [(e.t, e.from_mode, e.to_mode) for e in run.events if e.contact == name]
        assert len(own) == len(alone.events)
        for (t, *modes), event in zip(own, alone.events, strict=True):
            assert modes == [event.from_mode, event.to_mode]
            assert t == pytest.approx(event.t, rel=1e-9)
        assert run[name][-1] == pytest.approx(alone["x"][-1], abs=1e-9)


@dataclass(frozen=True, kw_only=True)
class Knee(BoundedMechanism, Arm):
    """An arm whose elbow does not bend backwards, with a stop at the shoulder."""

    name: ClassVar[str] = "knee"
    low: float = -0.1
    restitution: float = 0.6

    def stops(self):
        e = self.restitution
        return (
            Stop(coordinate="elbow", position=self.low, side="lower", restitution=e),
            Stop(coordinate="shoulder", position=0.9, side="upper", restitution=e),
        )


JOINTS = {"shoulder": coulomb(0.3), "elbow": coulomb(0.12)}


@dataclass
class ArmByHand:
    """The arm by SciPy: every mode is tried at rest, and the mass matrix inverted at impacts.

    With equal levels at most one answer is consistent.
    """

    state: np.ndarray
    t_end: float
    low: float
    restitution: float
    high: float = 0.9
    levels: tuple[float, float] = (0.3, 0.12)
    begin: float = 0.0

    def parts(self, y):
        s, b, u, v = y
        m1, m2, length, g = 1.0, 0.5, 0.4, 9.81
        bend = m2 * length**2 * math.sin(b)
        coupled = m2 * length**2 * (1.0 + math.cos(b))
        mass = np.array([[m1 * length**2 + 2.0 * coupled, coupled], [coupled, m2 * length**2]])
        lower = m2 * g * length * math.sin(s + b)
        upper = (m1 + m2) * g * length * math.sin(s) + lower
        return mass, np.array([bend * (2.0 * u * v + v * v) - upper, -bend * u * u - lower])

    def motion(self, y, modes):
        """Return accelerations and what friction has to do at held joints."""
        mass, force = self.parts(y)
        free = [i for i in range(2) if modes[i]]
        a = np.zeros(2)
        if free:
            right = (force - np.array(self.levels) * modes)[free]
            a[free] = np.linalg.solve(mass[np.ix_(free, free)], right)
        return a, force - mass @ a

    def chosen(self, y, broken=-1, side=0):
        """Return the modes; of a joint that breaks away the side is known."""
        rest = [i for i in range(2) if y[2 + i] == 0.0]
        for trial in np.ndindex(*(3,) * len(rest)):
            own = np.sign(y[2:])
            own[rest] = [(0, 1, -1)[k] for k in trial]
            if broken >= 0 and own[broken] != side:
                continue
            a, needed = self.motion(y, own)
            held = all(abs(needed[i]) <= self.levels[i] for i in rest if own[i] == 0)
            if held and all(own[i] * a[i] > 0 for i in rest if own[i] and i != broken):
                return own
        raise AssertionError("no mode is consistent")

    def slows(self, t, y, i):
        return self.modes[i] * y[2 + i] + (1e-14 if t == self.begin else 0.0)

    def holds(self, t, y, i, side):
        return self.levels[i] - side * self.motion(y, self.modes)[1][i]

    def clears(self, t, y, i):
        margins = (self.high - y[0], y[1] - self.low)
        return margins[i] if self.modes[i] == (1, -1)[i] else 1.0

    def guards(self):
        """Return what ends a step: kind, joint, side, and the function that falls."""
        found = [("hit", i, 0, lambda t, y, i=i: self.clears(t, y, i)) for i in range(2)]
        for i in range(2):
            if self.modes[i]:
                found.append(("stop", i, 0, lambda t, y, i=i: self.slows(t, y, i)))
                continue
            for side in (1, -1):
                hold = lambda t, y, i=i, side=side: self.holds(t, y, i, side)  # noqa: E731
                found.append(("break", i, side, hold))
        for *_, function in found:
            function.terminal, function.direction = True, -1
        return found

    def run(self):
        """Return the times of impacts and the last state."""
        y, hits = self.state, []
        self.modes = self.chosen(y)
        while self.begin < self.t_end:
            guards = self.guards()
            found = solve_ivp(
                lambda t, y: [*y[2:], *self.motion(y, self.modes)[0]], (self.begin, self.t_end), y,
                "DOP853", events=[guard[3] for guard in guards], rtol=1e-13, atol=1e-15,
            )  # fmt: skip
            self.begin, y = found.t[-1], found.y[:, -1]
            if found.status == 0:
                break
            kind, i, side, _ = guards[[len(times) > 0 for times in found.t_events].index(True)]
            if kind == "hit":
                hits.append(self.begin)
                inverse = np.linalg.inv(self.parts(y)[0])
                y[2:] -= (1.0 + self.restitution) * y[2 + i] * inverse[:, i] / inverse[i, i]
                self.modes = np.sign(y[2:])
            else:
                if kind == "stop":
                    y[2 + i] = 0.0
                self.modes = self.chosen(y, i if kind == "break" else -1, side)
        return hits, y


def test_impacts_of_an_arm_change_both_rates_as_scipy_finds():
    start = {"shoulder": 0.8, "elbow": 0.8}
    run = run_of(Knee(), JOINTS, 1.1, start)
    hits, end = ArmByHand(np.array([0.8, 0.8, 0.0, 0.0]), 1.1, -0.1, 0.6).run()
    own = [e.t for e in run.events if e.reason.endswith("hits stop")]
    assert len(own) >= 3
    np.testing.assert_allclose(own, hits, rtol=1e-9)
    names = ("shoulder", "elbow", "shoulder_dot", "elbow_dot")
    np.testing.assert_allclose([run[name][-1] for name in names], end, atol=2e-9)


def test_a_joint_at_rest_at_its_stop_takes_its_part_of_an_impact():
    """A straight arm at both stops, which its shoulder reaches: momentum goes by two impulses."""
    mechanism = Knee(low=0.0, restitution=0.0)
    run = run_of(mechanism, JOINTS, 1.0, {"shoulder": 0.8, "shoulder_dot": 3.0})
    hit = next(e for e in run.events if e.reason == "shoulder hits stop")
    after = run.at([hit.t + 1e-9])
    # the lower link would swing on; its own stop holds only the other way
    assert after["shoulder_dot"][0] == pytest.approx(0.0, abs=1e-6)
    assert after["elbow_dot"][0] > 1.0
    back = run_of(replace(mechanism, low=0.0), JOINTS, 0.3, {"elbow": 0.0, "shoulder_dot": -1.0})
    assert back["elbow"].min() >= 0.0


def test_a_coordinate_without_contacts_bounces_and_rests_too():
    @dataclass(frozen=True, kw_only=True)
    class Ball(Walled):
        def contacts(self):
            return (Contact(name="x2", slip="x2", load=1.0),)

        def loads(self, t, q, q_dot, drives):
            return {"x2": 1.0}

    run = run_of(Ball(pull=1.0), {"x2": coulomb(0.4, 0.7)}, 8.0, {"v2": -0.1})
    # a fall of 1 m in sqrt(2) s at 1 m/s^2, then bounces at half the speed each: 3 sqrt(2) s in
    # all, but for those slower than 7e-8 m/s, which are lost in the rounding of the place
    bounces = [e.t for e in run.events if e.reason == "x1 hits stop"]
    assert bounces[0] == pytest.approx(math.sqrt(2.0), rel=1e-14)
    assert bounces[-1] == pytest.approx(3.0 * math.sqrt(2.0), rel=1e-7)
    assert run["v1"][-1] == 0.0
    assert run["x1"][-1] == 1.0


def test_bristles_at_a_stop_leave_it_as_they_do_alone():
    law = LuGre(
        kinetic_coefficient=0.4, static_coefficient=0.6, stribeck_velocity=0.05,
        bristle_stiffness=1e3, bristle_damping=10.0,
    )  # fmt: skip
    run = run_of(Walled(pull=3.0, growth=-0.5), {"x1": law, "x2": None}, 8.0, {"v1": 1.0})
    leave = next(e for e in run.events if e.reason == "leaves stop")
    before = run.at([leave.t - 1e-9])
    assert before["x1"][0] == 1.0
    # bristles keep the force of their deflection until what presses is as small
    assert 3.0 - 0.5 * leave.t == pytest.approx(before["friction:x1"][0], abs=1e-6)


def test_both_tiers_agree_to_the_last_bit_and_ensembles_with_single_runs():
    settings = {"t_end": 2.0, "y0": {"shoulder": 0.8, "elbow": 0.8}}
    run, other = (
        simulate(Knee(), JOINTS, solver=EventDriven(tier=tier), **settings)
        for tier in ("python", "compiled")
    )
    for name in run.names:
        np.testing.assert_array_equal(run[name], other[name])
    outputs = {
        "hits": EventCount("elbow hits stop"),
        "first": EventTimes("elbow hits stop"),
        "end": Final("shoulder"),
    }
    path = "friction.elbow.kinetic_coefficient"
    runs = ensemble(
        Knee(), {**JOINTS, "elbow": coulomb(0.12, 0.2)}, {path: np.array([0.1, 0.12])},
        outputs=outputs, solver=EventDriven(tier="compiled"), **settings,
    )  # fmt: skip
    single = simulate(
        Knee(), {**JOINTS, "elbow": coulomb(0.1, 0.2)}, solver=EventDriven(tier="compiled"),
        **settings,
    )  # fmt: skip
    hits = [e.t for e in single.events if e.reason == "elbow hits stop"]
    assert runs["hits"][0] == len(hits)
    assert runs["first"][0, 0] == hits[0]
    assert runs["end"][0] == single["shoulder"][-1]


def test_an_impact_passes_its_moment_and_its_speed_on():
    run = run_of(Walled(), LEVELS, 1.0, MOVING)
    path = "friction.x1.kinetic_coefficient"
    slopes = run.differentiate(np.array([0.4, 0.8]), [path])[:, :, 0]
    assert slopes[0, 0] == pytest.approx(-0.5 * 0.4**2, rel=1e-12)
    # x = 2 t - F t^2 / 2 meets 1 m at t1; v1 is the speed then, half of it is left
    level = 0.5
    v1 = math.sqrt(4.0 - 2.0 * level)
    t1 = (2.0 - v1) / level
    late, slow = 0.5 * t1**2 / v1, -1.0 / v1
    since = 0.8 - t1
    expected = -0.5 * slow * since + 0.5 * v1 * late + 0.5 * since**2 - level * since * late
    assert slopes[1, 0] == pytest.approx(expected, rel=1e-12)
    assert np.all(slopes[1, [1, 3]] == 0.0)  # the other block knows nothing of it


def test_a_run_that_begins_at_its_stop():
    resting = run_of(Walled(pull=3.0), LEVELS, 1.0, {"x1": 1.0})
    assert np.all(resting["x1"] == 1.0)
    assert resting["mode:x1"][0] == 2
    struck = run_of(Walled(), LEVELS, 0.5, {"x1": 1.0, "v1": 2.0})
    assert struck.events[0].reason == "x1 hits stop"
    assert struck["v1"][-1] == pytest.approx(-1.0 + 0.25, rel=1e-14)


def test_a_stop_whose_force_would_share_in_the_loads_is_refused():
    @dataclass(frozen=True, kw_only=True)
    class Stopped(BoundedMechanism, TwoFeet):
        def stops(self):
            return (Stop(coordinate="x", position=1.0, side="upper"),)

    with pytest.raises(InputError, match=r"front.*acts on held coordinates"):
        simulate(Stopped(**FEET), {"front": coulomb(0.6), "rear": coulomb(0.2)}, t_end=1.0)

    @dataclass(frozen=True, kw_only=True)
    class StoppedCart(BoundedMechanism, RubbingCart):
        def stops(self):
            return (Stop(coordinate="x", position=0.05, side="upper", restitution=0.5),)

    laws = {"wheels": coulomb(0.05, 0.08), "pivot": coulomb(0.01, 0.015)}
    run = run_of(StoppedCart(), laws, 2.0, {"theta": -1.5})
    assert run["x"].max() == 0.05
    assert any(e.reason == "x hits stop" for e in run.events)
