"""Contacts whose slips follow from those of others: loops of clutches, and what they hold."""

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.contact_cases import coulomb
from tests.loop_cases import (
    BRACED,
    GROUNDED,
    SQUARE,
    TRIANGLE,
    Geared,
    Grounded,
    Triangle,
    decided,
    motion,
    random_case,
    rotors,
    rows_of,
    utilisation,
)

from stickslip import EventDriven, FixedStep, LuGre, Stribeck, ensemble, simulate
from stickslip.engine import Final
from stickslip.engine.trajectory import Status
from stickslip.errors import InputError
from stickslip.maths import sin
from stickslip.mechanisms import BoundedMechanism, Contact, Stop
from stickslip.mechanisms.drives import Drive, PiecewiseLinear, Sampled
from stickslip.study.control import dynamics_at

PLAIN = EventDriven(tier="python")
COMPILED = EventDriven(tier="compiled")
LEVELS = {"c0": coulomb(2.0), "c1": coulomb(3.0), "c2": coulomb(1.5)}
R11 = TRIANGLE(J0=1.0, J1=2.0, J2=3.0, T0=2.5)


def frictions(run, t):
    at = run.at([t])
    return [at[f"friction:{name}"][0] for name in run.contacts]


def test_three_held_clutches_share_a_torque_in_proportion_to_their_levels():
    run = simulate(R11, LEVELS, t_end=1.0, solver=PLAIN)
    # least sum of squares over levels, by a weighted least-norm solution
    weighted = np.array([1.0, 0.25, 0.875]) / 0.9
    np.testing.assert_allclose(frictions(run, 0.5), weighted, rtol=1e-14)
    assert run["v0"][-1] == pytest.approx(2.5 / 6.0, rel=1e-15)
    assert run.certificate.indeterminate == (("c0", "c1", "c2"),)
    assert not run.events


@pytest.mark.parametrize(
    ("torque", "shares"),
    [
        (27.0 / 7.0, (12.0 / 7.0, 3.0 / 7.0, 1.5)),  # the third reaches its level
        (4.0, (11.0 / 6.0, 0.5, 1.5)),  # it is clamped, the others carry on
        (4.2, (2.0, 0.6, 1.5)),  # all that they can hold
    ],
)
def test_a_clutch_that_reaches_its_level_holds_as_long_as_others_do(torque, shares):
    run = simulate(replace(R11, T0=torque), LEVELS, t_end=1.0, solver=PLAIN)
    np.testing.assert_allclose(frictions(run, 0.5), shares, rtol=1e-12)
    assert run["v0"][-1] == pytest.approx(torque / 6.0, rel=1e-14)
    assert not run.events


@pytest.mark.parametrize("solver", [PLAIN, COMPILED])
def test_a_growing_torque_lets_two_of_three_clutches_go_together(solver):
    run = simulate(replace(R11, T0=0.0, R0=1.0), LEVELS, t_end=6.0, solver=solver)
    (first, second) = run.events
    assert [first.t, second.t] == pytest.approx([4.2, 4.2], rel=1e-14)
    assert [(e.contact, e.from_mode, e.to_mode) for e in run.events] == [("c0", 0, 1), ("c2", 0, 1)]
    # 3.5 N m go through them; the others stay together
    speed = 4.2**2 / 12.0
    assert run["v0"][-1] == pytest.approx(speed + (6.0**2 - 4.2**2) / 2 - 3.5 * 1.8, rel=1e-13)
    assert run["v1"][-1] == pytest.approx(speed + 3.5 / 5.0 * 1.8, rel=1e-13)
    assert run["v1"][-1] == run["v2"][-1]
    assert run.certificate.stick_drift == 0.0


def test_three_clutches_slip_and_stick_one_by_one():
    """Rotors at three speeds: the closing clutch sticks while both of its parts slip."""
    triangle = TRIANGLE(J0=1.0, J1=1.0, J2=1.0)
    laws = {"c0": coulomb(1.0), "c1": coulomb(1.0), "c2": coulomb(3.0)}
    run = simulate(triangle, laws, t_end=3.0, y0={"v0": 1.0, "v1": -2.0, "v2": 0.0}, solver=PLAIN)
    # c0 and c2 brake the first by 4 N m, c2 speeds the third up by 3 N m, less 1 N m of c1
    told = [(e.contact, e.from_mode, e.to_mode) for e in run.events]
    assert told == [("c2", 1, 0), ("c0", 1, 0), ("c1", -1, 0)]
    # first and third meet after 1/6 s at 1/3; each is braked by 1 N m then, the second sped up by 2
    np.testing.assert_allclose([e.t for e in run.events], [1 / 6, 5 / 6, 5 / 6], rtol=1e-13)
    assert run.certificate.stick_drift == 0.0
    between = run.at([1 / 6, 0.5, 0.83])
    np.testing.assert_allclose(between["v0"], between["v2"], rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(run["v0"][-1], -1.0 / 3.0, rtol=1e-13)
    assert run.status is Status.END_TIME


def check_instants(one, count, seed, solver):
    random, compared = np.random.default_rng(seed), 0
    for _ in range(count):
        case, laws, v, kinetic, static = random_case(one, random)
        n = len(v)
        mass = np.diag([getattr(case, f"J{i}") for i in range(n)])
        force = np.array([getattr(case, f"T{i}") for i in range(n)])
        known = decided(mass, force, rows_of(one), v, kinetic, static)
        y0 = {f"v{i}": float(x) for i, x in enumerate(v)}
        run = simulate(case, laws, t_end=1e-3, y0=y0, solver=solver)
        found = np.array([run[f"v{i}"][-1] - v[i] for i in range(n)]) / 1e-3
        if not run.events:  # rounding of a difference of speeds over 1e-3 s
            np.testing.assert_allclose(found, known, atol=2e-12 * max(1.0, np.abs(known).max()))
            left = force - rows_of(one).T @ frictions(run, 5e-4) - mass @ found
            np.testing.assert_allclose(left, 0.0, atol=1e-9)
            compared += 1
    assert compared > 0.8 * count  # in few does anything happen within a millisecond


@pytest.mark.parametrize("one", [TRIANGLE, SQUARE, BRACED, GROUNDED])
def test_who_slips_is_found_by_trying_all_modes(one):
    check_instants(one, 12, 1, PLAIN)


@pytest.mark.slow
@pytest.mark.parametrize("one", [TRIANGLE, SQUARE, BRACED, GROUNDED])
def test_who_slips_in_two_hundred_random_systems(one):
    check_instants(one, 200, 2, COMPILED)


def check_motions(one, count, seed, solver):
    random = np.random.default_rng(seed)
    compared = 0
    for _ in range(count):
        case, laws, v, kinetic, static = random_case(one, random)
        n, ramp = len(v), random.uniform(-6.0, 6.0, len(v))
        case = replace(case, **{f"R{i}": float(x) for i, x in enumerate(ramp)})
        mass = np.diag([getattr(case, f"J{i}") for i in range(n)])
        force = np.array([getattr(case, f"T{i}") for i in range(n)])
        events, end = motion(mass, force, ramp, rows_of(one), v, kinetic, static, 2.0)
        if events is None:  # changes too close for the reference
            continue
        y0 = {f"v{i}": float(x) for i, x in enumerate(v)}
        run = simulate(case, laws, t_end=2.0, y0=y0, solver=solver)
        found = [run[f"v{i}"][-1] for i in range(n)]
        np.testing.assert_allclose(found, end, rtol=0.0, atol=1e-12 * max(1.0, np.abs(end).max()))
        changed = {(round(t, 6), c) for t, own in events for c in own}
        assert {(round(e.t, 6), int(e.contact[1:])) for e in run.events} == changed
        assert run.certificate.certified
        assert run.certificate.stick_drift == 0.0
        compared += 1
    assert compared > 0.8 * count


@pytest.mark.parametrize("one", [TRIANGLE, BRACED])
def test_motions_under_growing_torques_are_those_of_enumerated_modes(one):
    check_motions(one, 6, 3, PLAIN)


@pytest.mark.slow
@pytest.mark.parametrize("one", [TRIANGLE, SQUARE, BRACED, GROUNDED])
def test_two_hundred_random_motions(one):
    check_motions(one, 200, 4, COMPILED)


def check_factors(r, s, count, seed):
    random, compared = np.random.default_rng(seed), 0
    for _ in range(count):
        force, ramp = random.uniform(-4.0, 4.0, (2, 3))
        kinetic = random.uniform(0.1, 1.2, 5)
        static = kinetic * random.choice([1.0, 1.5], 5)
        v = random.integers(-1, 2, 3) * float(random.random() < 0.6)
        torques = {f"T{i}": float(x) for i, x in enumerate(force)}
        torques |= {f"R{i}": float(x) for i, x in enumerate(ramp)}
        case = Geared(r=r, s=s, **torques)
        mass = np.diag([1.0, 2.0, 3.0])
        events, end = motion(mass, force, ramp, case.rows(), v, kinetic, static, 2.0)
        if events is None:  # changes too close for the reference
            continue
        laws = {
            f"c{i}": coulomb(float(a), float(b))
            for i, (a, b) in enumerate(zip(kinetic, static, strict=True))
        }
        y0 = {f"v{i}": float(x) for i, x in enumerate(v)}
        run = simulate(case, laws, t_end=2.0, y0=y0, solver=PLAIN)
        # rounding, of speeds of some rad/s over some events
        np.testing.assert_allclose([run[f"v{i}"][-1] for i in range(3)], end, atol=1e-11)
        changed = {(round(t, 6), c) for t, own in events for c in own}
        assert {(round(e.t, 6), int(e.contact[1:])) for e in run.events} == changed
        assert run.certificate.certified
        compared += 1
    assert compared > 0.8 * count


FACTORS = [(1.3, 2.0), (1.0, 2.0), (1.0, 1.0), (2.0, 2.0), (0.0, 1.5), (1.5, 0.0)]
"""In general, then where slips are parallel, or fewer coordinates than else have a part in one."""


@pytest.mark.parametrize(("r", "s"), FACTORS)
def test_loops_break_open_at_factors_at_which_slips_become_dependent(r, s):
    check_factors(r, s, 3, 1)


@pytest.mark.slow
@pytest.mark.parametrize(("r", "s"), FACTORS)
def test_forty_motions_at_factors_at_which_slips_become_dependent(r, s):
    check_factors(r, s, 40, 2)


def test_the_order_of_contacts_changes_nothing():
    turned = rotors(4, ((0, 2), (2, 3), (0, 3), (0, 1), (1, 2)))  # BRACED in another order
    order = {"c0": "c4", "c1": "c2", "c2": "c3", "c3": "c0", "c4": "c1"}
    random = np.random.default_rng(5)
    for _ in range(3):
        case, laws, v, _, _ = random_case(BRACED, random)
        ramp = {f"R{i}": float(x) for i, x in enumerate(random.uniform(-6.0, 6.0, 4))}
        case = replace(case, **ramp)
        own = {f"{k}{i}": getattr(case, f"{k}{i}") for k in "JTR" for i in range(4)}
        y0 = {f"v{i}": float(x) for i, x in enumerate(v)}
        run = simulate(case, laws, t_end=2.0, y0=y0, solver=PLAIN)
        other = {name: laws[old] for name, old in order.items()}
        again = simulate(turned(**own), other, t_end=2.0, y0=y0, solver=PLAIN)
        told = sorted((round(e.t, 10), order[e.contact]) for e in again.events)
        assert told == sorted((round(e.t, 10), e.contact) for e in run.events)
        for name in ("v0", "v1", "v2", "v3"):
            assert again[name][-1] == pytest.approx(run[name][-1], rel=1e-12, abs=1e-12)


@dataclass(frozen=True, kw_only=True)
class Bent(Triangle):
    """The first inertia on a spring that stiffens, a torque to and fro on the third."""

    name: ClassVar[str] = "bent"

    def forces(self, t, q, q_dot, drives):
        return {"x2": 4.0 * sin(2.0 * t)}

    def potential_energy(self, t, q):
        return 5.0 * q["x0"] ** 4


def test_nonlinear_motions_are_those_of_scipy_with_modes_by_enumeration():
    kinetic, static = np.array([0.6, 0.9, 0.4]), np.array([0.9, 1.2, 0.4])
    mass, rows = np.diag([1.0, 2.0, 3.0]), rows_of(Triangle)
    v, x, t, times = np.array([3.0, 0.0, 0.0]), np.zeros(3), 0.0, []

    def force(t, x):
        return np.array([-20.0 * x[0] ** 3, 0.0, 4.0 * np.sin(2.0 * t)])

    while t < 6.0:
        ahead = force(t + 1e-7, x + 1e-7 * v)
        a = decided(mass, ahead, rows, v, kinetic, static)
        slip, along = rows @ v, rows @ a
        sign = np.where(
            np.abs(slip) > 1e-8, np.sign(slip), np.where(np.abs(along) > 1e-8, np.sign(along), 0)
        )
        held = rows[sign == 0]
        null = np.eye(3)
        if len(held):
            _, sizes, right = np.linalg.svd(held)
            null = right[(sizes > 1e-9).sum() :].T
        project = null @ np.linalg.inv(null.T @ mass @ null) @ null.T

        def acceleration(t, x, project=project, sign=sign):
            return project @ (force(t, x) - rows.T @ (kinetic * sign))

        events = [
            lambda t, y, row=row, s=s, begun=t + 1e-6: (
                s * (row @ y[3:]) + (1e-9 if t < begun else 0.0)
            )
            for row, s in zip(rows, sign, strict=True)
            if s != 0
        ]
        if len(held):
            events.append(
                lambda t, y, held=held, sign=sign, acceleration=acceleration: 1.0 - utilisation(
                    force(t, y[:3]) - rows.T @ (kinetic * sign) - mass @ acceleration(t, y[:3]),
                    held, static[sign == 0],
                )
            )  # fmt: skip
        for event in events:
            event.terminal, event.direction = True, -1
        found = solve_ivp(
            lambda t, y, acceleration=acceleration: np.concatenate([y[3:], acceleration(t, y[:3])]),
            (t, 6.0), np.concatenate([x, v]), method="DOP853", rtol=1e-12, atol=1e-13,
            events=events,
        )  # fmt: skip
        t, x, v = found.t[-1], found.y[:3, -1], found.y[3:, -1]
        times.append(t)
    laws = {
        f"c{k}": coulomb(float(a), float(b))
        for k, (a, b) in enumerate(zip(kinetic, static, strict=True))
    }
    run = simulate(
        Bent(J0=1.0, J1=2.0, J2=3.0), laws, t_end=6.0, y0={"v0": 3.0},
        solver=replace(PLAIN, tolerance=1e-12),
    )  # fmt: skip
    assert len(times) > 5
    known = sorted({round(e.t, 6) for e in run.events})
    np.testing.assert_allclose(known, times[:-1], atol=2e-6)
    np.testing.assert_allclose([run[f"v{i}"][-1] for i in range(3)], v, atol=1e-8)
    assert run.certificate.certified


def test_bristles_in_a_loop_need_no_decision():
    """A closing contact with bristles is a spring for small slips: against SciPy's Radau."""
    lugre = LuGre(
        kinetic_coefficient=0.5, static_coefficient=0.7, stribeck_velocity=0.1,
        bristle_stiffness=50.0, bristle_damping=0.5, viscous_coefficient=0.1,
    )  # fmt: skip
    triangle = TRIANGLE(J0=1.0, J1=2.0, J2=3.0, T0=1.0)
    y0 = {"v0": 1.0, "v1": 0.0, "v2": -0.5}
    laws = {"c0": coulomb(0.2), "c1": coulomb(0.1), "c2": lugre}
    solver = replace(PLAIN, tolerance=1e-9)
    run = simulate(triangle, laws, t_end=0.5, y0=y0, solver=solver)
    assert not run.events

    def rates(t, y):
        v0, v1, v2, z = y
        u = v0 - v2
        g = 0.5 + 0.2 * np.exp(-((u / 0.1) ** 2))
        z_dot = u - 50.0 * abs(u) / g * z
        f = 50.0 * z + 0.5 * z_dot + 0.1 * u
        a, b = 0.2 * np.sign(v0 - v1), 0.1 * np.sign(v1 - v2)
        return [1.0 - a - f, (a - b) / 2.0, (b + f) / 3.0, z_dot]

    known = solve_ivp(
        rates, (0.0, 0.5), [1.0, 0.0, -0.5, 0.0], method="Radau", rtol=1e-11, atol=1e-13
    )
    found = [run[name][-1] for name in ("v0", "v1", "v2", "z:c2")]
    np.testing.assert_allclose(found, known.y[:, -1], atol=1e-8)


@dataclass(frozen=True, kw_only=True)
class Pressed(Triangle):
    """The closing clutch is pressed by a drive."""

    name: ClassVar[str] = "pressed"

    def drives(self):
        return {"press": Sampled(times=(0.0, 1.0, 2.0), values=(1.5, 0.0, 1.5), hold="zero")}

    def loads(self, t, q, q_dot, drives):
        return {"c2": drives["press"]}


def test_a_clutch_that_opens_leaves_its_force_to_the_others():
    laws = {"c0": coulomb(2.0), "c1": coulomb(3.0), "c2": coulomb(1.0)}
    run = simulate(Pressed(J0=1.0, J1=2.0, J2=3.0, T0=2.0), laws, t_end=3.0, solver=PLAIN)
    assert [(e.contact, e.t) for e in run.events] == [("c2", 1.0), ("c2", 2.0)]
    # alone, the others hold 10/6 and 1 N m; the rotors stay together throughout
    np.testing.assert_allclose(frictions(run, 1.5), [10.0 / 6.0, 1.0, 0.0], rtol=1e-13)
    np.testing.assert_allclose(frictions(run, 2.5), frictions(run, 0.5), rtol=1e-13)
    assert run["v0"][-1] == pytest.approx(1.0, rel=1e-13)
    assert run["v0"][-1] == run["v2"][-1]
    assert run.certificate.stick_drift == 0.0


@dataclass(frozen=True, kw_only=True)
class Blocks(Grounded):
    """Two blocks on the ground that rub on each other, and a third on the second."""

    name: ClassVar[str] = "blocks"

    def forces(self, t, q, q_dot, drives):
        return {}


def test_blocks_on_the_ground_that_rub_on_each_other_come_to_rest():
    laws = dict.fromkeys(("c0", "c1", "c2"), coulomb(0.3, 0.4)) | {"c3": coulomb(0.2)}
    run = simulate(Blocks(), laws, t_end=50.0, y0={"v0": 1.0, "v2": -1.0}, solver=PLAIN)
    assert run.status is Status.AT_REST
    assert run["v2"][-1] == 0.0
    # both tiers, bit by bit
    other = simulate(Blocks(), laws, t_end=50.0, y0={"v0": 1.0, "v2": -1.0}, solver=COMPILED)
    assert other.events == run.events
    np.testing.assert_array_equal(other["x2"], run["x2"])


def test_laws_that_fall_with_speed_and_ensembles_in_loops():
    case = TRIANGLE(J0=1.0, J1=2.0, J2=3.0, R0=6.0, spring=40.0)
    laws = {
        name: Stribeck(kinetic_coefficient=x, static_coefficient=1.4 * x, stribeck_velocity=0.1)
        for name, x in (("c0", 0.4), ("c1", 0.6), ("c2", 0.3))
    }
    y0 = {"v0": 2.0, "v1": -1.0}
    run = simulate(case, laws, t_end=4.0, y0=y0, solver=COMPILED)
    assert run.certificate.certified
    assert {e.contact for e in run.events} == {"c0", "c1", "c2"}
    runs = ensemble(
        case, laws, {"initial.v0": np.array([1.0, 2.0])}, t_end=4.0, outputs={"end": Final("v2")},
        y0={"v1": -1.0}, solver=COMPILED,
    )  # fmt: skip
    assert runs["end"][1] == run["v2"][-1]


TIGHT = replace(PLAIN, tolerance=1e-12)
GOING = (
    # all held, then two go along a cut, and stop together
    (
        TRIANGLE(J0=1.0, J1=2.0, J2=3.0, R0=3.0, T1=-0.5, spring=2.0),
        {"c0": (1.4, 2.0), "c1": (2.6, 3.0), "c2": (1.3, 1.5)},
        {},
    ),
    # the closing clutch holds while its parts slip
    (
        TRIANGLE(R1=0.4, spring=1.0),
        {"c0": (1.0, 1.2), "c1": (1.1, 1.3), "c2": (3.0, 3.3)},
        {"v0": 1.0, "v1": -2.0},
    ),
)


@pytest.mark.parametrize(("case", "levels", "y0"), GOING)
def test_sensitivities_are_those_of_differences_of_runs(case, levels, y0):
    def run_with(path, change):
        changed, own = case, {name: list(pair) for name, pair in levels.items()}
        if path.startswith("mechanism."):
            field_name = path.removeprefix("mechanism.")
            changed = replace(case, **{field_name: getattr(case, field_name) + change})
        else:
            own[path.split(".")[1]]["static" in path] += change
        laws = {name: coulomb(*pair) for name, pair in own.items()}
        return simulate(changed, laws, t_end=6.9, y0=y0, solver=TIGHT)

    paths = ("mechanism.J1", "mechanism.spring", "friction.c0.kinetic_coefficient",
             "friction.c0.static_coefficient")  # fmt: skip
    run, t = run_with(paths[0], 0.0), np.linspace(0.5, 6.8, 5)
    assert len(run.events) >= 4
    found = run.differentiate(t, list(paths))
    for c, path in enumerate(paths):
        above, below = (run_with(path, x).at(t) for x in (1e-6, -1e-6))
        known = np.array([(above[name] - below[name]) / 2e-6 for name in run.states]).T
        # the differences have errors of rounding over the change
        np.testing.assert_allclose(found[:, :, c], known, atol=2e-8)


def test_contacts_along_one_coordinate_are_told_to_be_indeterminate():
    pads = rotors(1, ((0, -1), (0, -1)))
    run = simulate(pads(T0=0.5), {"c0": coulomb(1.0), "c1": coulomb(0.5)}, t_end=1.0, solver=PLAIN)
    assert run.certificate.indeterminate == (("c0", "c1"),)
    np.testing.assert_allclose(frictions(run, 0.5), [1.0 / 3.0, 1.0 / 6.0], rtol=1e-15)
    single = rotors(1, ((0, -1),))
    run = simulate(single(T0=0.5), coulomb(1.0), t_end=1.0, solver=PLAIN)
    assert run.certificate.indeterminate == ()


@dataclass(frozen=True, kw_only=True)
class Turned(Triangle):
    """A drive turns the first inertia."""

    name: ClassVar[str] = "turned"
    torque: Drive = field(default_factory=lambda: Sampled(times=(0.0, 1.0), values=(0.0, 1.0)))

    def drives(self):
        return {"torque": self.torque}

    def forces(self, t, q, q_dot, drives):
        return {"x0": drives["torque"]}


@pytest.mark.parametrize("width", [1e-9, 1e-11, 1e-13])
def test_a_torque_that_rises_between_two_ticks_of_the_clock_lets_go_once(width):
    random = np.random.default_rng(1)
    for start, torque in zip(random.uniform(50, 100, 4), random.uniform(4.3, 9.0, 4), strict=True):
        step = PiecewiseLinear(
            times=(0.0, start, start + width, 200.0), values=(0.0, 0.0, torque, torque)
        )
        turned = Turned(J0=1.0, J1=2.0, J2=3.0, torque=step)
        run = simulate(turned, LEVELS, t_end=start + 1.0, solver=PLAIN)
        assert [(e.contact, e.to_mode) for e in run.events] == [("c0", 1), ("c2", 1)]
        assert run["v0"][-1] == pytest.approx(torque - 3.5, rel=1e-8)  # but for the ramp


def test_equations_of_motion_for_control_have_the_slips_of_loops():
    found = dynamics_at(Turned())
    np.testing.assert_allclose(found.friction_direction.T, rows_of(Turned), atol=1e-15)


def test_what_loops_are_not_combined_with_is_refused_by_name():
    class Stopped(BoundedMechanism, TRIANGLE):
        name = "stopped"

        def stops(self):
            return (Stop(coordinate="x0", position=1.0, side="upper", restitution=0.5),)

    class Standing(TRIANGLE):
        name = "standing"

        def held(self):
            return ("y",)

        def contacts(self):
            first, *others = super().contacts()
            return (Contact(name="c0", slip=dict(first.slip), normal="y"), *others)

    with pytest.raises(InputError, match=r"slips of c2 follow.*hard stops.*\(None\)"):
        simulate(Stopped(), LEVELS, t_end=1.0, solver=PLAIN)
    with pytest.raises(InputError, match=r"slips of c2 follow.*reactions"):
        simulate(Standing(), LEVELS, t_end=1.0, solver=PLAIN)
    with pytest.raises(InputError, match=r"slips of c2 follow.*EventDriven"):
        simulate(R11, LEVELS, t_end=1.0, solver=FixedStep(dt=1e-3))
    crowd = [(i, j) for i in range(7) for j in range(i)]
    beside = rotors(10, [*crowd, (7, 8), (8, 9), (7, 9)])
    laws = {f"c{k}": coulomb(1.0) for k in range(24)}
    # 15 closing slips of 6 coordinates: 5 of 21 are held at a time; the triangle is small enough
    with pytest.raises(
        InputError, match=r"in so many ways.*20,349 sets.*at most 1,500.*\(None\)"
    ) as caught:
        simulate(beside(), laws, t_end=1.0, solver=PLAIN)
    assert "c20" in str(caught.value)
    assert "c23" not in str(caught.value)
