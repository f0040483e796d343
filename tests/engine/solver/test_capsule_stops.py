"""A mass that strikes the stops of its capsule and rests there, against SciPy.

The reference knows nothing of the solver: each mode is integrated by DOP853 at 1e-11, its guards
are bracketed on the dense output and bisected, and who slips and rests is read off the forces.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import Capsule, Coulomb, EventDriven, ensemble, simulate
from stickslip.mechanisms import SoftStop, Torque
from stickslip.mechanisms.drives import Sine

SLOWEST = 1e-6
"""Share of the fastest impact below which the reference bounces no more: what is left of a fading
bounce moves the capsule by the square of it."""


@dataclass(frozen=True)
class Setting:
    """A capsule that a sine drives."""

    capsule: Capsule
    law: Coulomb
    frequency: float

    def force(self, t: float) -> float:
        return float(self.capsule.drive.drive.value(t))


def setting(seed: int) -> Setting:
    """Return a random one: e = 0 and .6, one stop and two, static levels at and above kinetic."""
    random = np.random.default_rng([7, seed])
    kinetic, body, mass = (
        random.uniform(*ends) for ends in ((0.05, 0.3), (0.04, 0.15), (0.01, 0.08))
    )
    frequency = random.uniform(2.0, 20.0)
    amplitude = random.uniform(0.3, 2.5) * kinetic * (body + mass) * 9.81
    capsule = Capsule(
        capsule_mass=body,
        inner_mass=mass,
        stiffness=random.uniform(20.0, 120.0),
        damping=random.uniform(0.01, 0.2),
        upper_stop=random.uniform(0.0005, 0.003),
        lower_stop=-random.uniform(0.0005, 0.003) if seed % 2 else None,
        restitution=0.6 if seed // 2 % 2 else 0.0,
        drive=Torque(drive=Sine(amplitude=amplitude, frequency=frequency)),
    )
    static = kinetic * (random.uniform(1.0, 1.5) if seed % 4 else 1.0)
    law = Coulomb(kinetic_coefficient=kinetic, static_coefficient=static)
    return Setting(capsule, law, frequency)


class Reference:
    """State x, v of the capsule, s, u of the mass in it; slip is -1, 0, 1, stop too."""

    def __init__(self, one: Setting) -> None:
        c = one.capsule
        self.one, self.body, self.mass = one, c.capsule_mass, c.inner_mass
        self.both = self.body + self.mass
        self.kinetic = one.law.kinetic_coefficient * self.both * c.gravity
        self.static = one.law.static_coefficient * self.both * c.gravity
        self.places = {1: c.upper_stop, -1: c.lower_stop}
        self.t, self.y, self.fastest = 0.0, np.zeros(4), 0.0
        self.hits: list[float] = []
        self.slip, self.stop = self.decide(0)

    def push(self, t: float, y: Any) -> float:
        c = self.one.capsule
        return self.one.force(t) - c.stiffness * y[2] - c.damping * y[3]

    def rates(self, t: float, y: Any, slip: int, stop: int) -> list[float]:
        push, friction = self.push(t, y), slip * self.kinetic
        if stop:
            return [y[1], -friction / self.both, 0.0, 0.0]
        a = (-friction - push) / self.body if slip else 0.0
        return [y[1], a, y[3], push / self.mass - a]

    def pressure(self, t: float, y: Any, slip: int, side: int) -> float:
        return side * (self.push(t, y) + self.mass * slip * self.kinetic / self.both)

    def decide(self, side: int) -> tuple[int, int]:
        """Return who slips and rests, where the mass stands at the stop `side` or at none, 0."""
        v = self.y[1]
        for slip in (int(math.copysign(1, v)),) if v else (0, 1, -1):
            stop = side if side and self.pressure(self.t, self.y, slip, side) >= 0.0 else 0
            if v:
                return slip, stop
            if not slip and (stop or abs(self.push(self.t, self.y)) <= self.static):
                return slip, stop
            if slip and slip * self.rates(self.t, self.y, slip, stop)[1] > 0.0:
                return slip, stop
        raise AssertionError("no mode is consistent")

    def guards(self) -> dict[Any, Any]:
        slip, stop = self.slip, self.stop
        found: dict[Any, Any] = {}
        if slip:
            found["rest"] = lambda t, y: slip * y[1]
        elif not stop:
            found["forward"] = lambda t, y: self.static + self.push(t, y)
            found["backward"] = lambda t, y: self.static - self.push(t, y)
        if stop:
            found["leave"] = lambda t, y: self.pressure(t, y, slip, stop)
        else:
            for side, place in self.places.items():
                if place is not None:
                    found[side] = lambda t, y, s=side, p=place: s * (p - y[2])
        return found

    def first(self, solution: Any) -> tuple[float, Any]:
        """Return when the first guard falls below 0, and which."""
        found: tuple[float, Any] = (math.inf, None)
        grid = np.unique(
            [np.linspace(a, b, 5) for a, b in zip(solution.t, solution.t[1:], strict=False)]
        )
        for name, guard in self.guards().items():
            before, last = guard(grid[0], solution.sol(grid[0])), grid[0]
            begun = before > 1e-13
            for t in grid[1:]:
                now = guard(t, solution.sol(t))
                if now < 0.0:
                    low, high = (last, t) if before > 0.0 or begun else (last, last)
                    while low < 0.5 * (low + high) < high:
                        middle = 0.5 * (low + high)
                        if guard(middle, solution.sol(middle)) >= 0.0:
                            low = middle
                        else:
                            high = middle
                    found = min(found, (high, name), key=lambda pair: pair[0])
                    break
                before, last = now, t
        return found

    def advance(self, end: float) -> None:
        """Go on to a time."""
        cycle = 1.0 / self.one.frequency
        while self.t < end:
            slip, stop, y = self.slip, self.stop, self.y
            until, longest = end, cycle / 200.0
            a = abs(self.rates(self.t, y, slip, stop)[3])
            if not stop and y[3] and a:  # a short hop must not be stepped over
                gap = min(abs(y[2] - place) for place in self.places.values() if place is not None)
                hop = 2.0 * abs(y[3]) / a + gap / abs(y[3])
                if hop < cycle / 20.0:
                    until, longest = min(end, self.t + 3.0 * hop), hop / 8.0
            solution = solve_ivp(
                lambda t, z, m=(slip, stop): self.rates(t, z, *m), (self.t, until), y, "DOP853",
                rtol=1e-11, atol=1e-13, dense_output=True, max_step=longest,
            )  # fmt: skip
            self.fastest = max(self.fastest, np.abs(solution.y[3]).max())
            t, guard = self.first(solution)
            if guard is None:
                self.t, self.y = until, solution.y[:, -1].copy()
                continue
            self.t, self.y = t, np.array(solution.sol(t))
            if guard == "rest":
                self.y[1] = 0.0
                self.slip, self.stop = self.decide(stop)
            elif guard == "leave":
                self.stop = 0
            elif guard in ("forward", "backward"):
                self.slip = -1 if guard == "forward" else 1
            else:
                self.strike(guard)

    def strike(self, side: int) -> None:
        u = self.y[3]
        self.hits.append(self.t)
        a = self.rates(self.t, self.y, self.slip, 0)[3]
        fades = abs(u) <= SLOWEST * self.fastest and side * a > 0.0
        after = 0.0 if fades else -self.one.capsule.restitution * u
        self.y[1] -= self.mass * (after - u) / self.both
        self.y[2:] = self.places[side], after
        self.slip, self.stop = self.decide(0 if after else side)


def apart(times: list[float], least: float) -> list[float]:
    """Return impacts that are no part of a bounce that fades."""
    return [b for a, b in zip([-1.0, *times], times, strict=False) if b - a > least]


def compare(one: Setting, cycles: int) -> None:
    period = 1.0 / one.frequency
    run = simulate(one.capsule, one.law, t_end=cycles * period)
    assert run.certificate.certified
    reference = Reference(one)
    travel = max(np.ptp(run["x"]) / cycles, 1e-5)
    for k in range(1, cycles + 1):
        reference.advance(k * period)
        assert run.at(min(k * period, run.span[1]))["x"][0] == pytest.approx(
            reference.y[0], abs=1e-6 * travel
        )
    hits = [event.t for event in run.events if event.reason == "xi hits stop"]
    np.testing.assert_allclose(
        apart(hits, 1e-3 * period), apart(reference.hits, 1e-3 * period), atol=1e-5 * period
    )


@pytest.mark.parametrize("seed", range(4))
def test_a_capsule_moves_as_scipy_says(seed):
    compare(setting(seed), 2)


@pytest.mark.parametrize("ratio", [1.5, math.sqrt(2.0)])
def test_a_capsule_that_two_sines_drive_moves_as_scipy_says(ratio):
    one = setting(1)
    sine = one.capsule.drive.drive
    both = sine + Sine(amplitude=0.6 * sine.amplitude, frequency=ratio * sine.frequency, phase=0.3)
    compare(replace(one, capsule=replace(one.capsule, drive=Torque(drive=both))), 4)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(60))
def test_sixty_capsules_move_as_scipy_says(seed):
    compare(setting(seed), 5)


def robot(frequency, restitution=0.6, lower=None):
    drive = Torque(drive=Sine(amplitude=0.2, frequency=frequency))
    return Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, lower_stop=lower,
        upper_stop=0.002, restitution=restitution, drive=drive,
    )  # fmt: skip


LAW = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)


@pytest.mark.parametrize(("frequency", "known"), [(13.0, 16.679), (8.0, 1.2314), (6.0, 10.588)])
def test_the_mean_speed_is_that_of_two_other_codes(frequency, known):
    run = simulate(robot(frequency), LAW, t_end=100.0 / frequency)
    x = run.at([80.0 / frequency, 100.0 / frequency])["x"]
    assert 1e3 * (x[1] - x[0]) * frequency / 20.0 == pytest.approx(known, rel=2e-4)


@pytest.mark.parametrize("restitution", [0.0, 0.6])
def test_no_frequency_ends_a_sweep_early(restitution):
    frequencies = np.linspace(2.0, 20.0, 91)
    for lower in (None, -0.0015):
        rig = robot(5.0, restitution, lower)
        runs = ensemble(rig, LAW, {"frequency": frequencies}, t_end=2.0)
        assert all(status.complete for status in runs.status)


def test_a_mirrored_capsule_moves_back_and_a_run_may_be_cut_in_two():
    rig = robot(6.0, 0.0, -0.0015)
    run = simulate(rig, LAW, t_end=1.0)
    turned = replace(
        rig,
        lower_stop=-0.002,
        upper_stop=0.0015,
        drive=Torque(drive=Sine(amplitude=-0.2, frequency=6.0)),
    )
    np.testing.assert_allclose(
        simulate(turned, LAW, t_end=1.0).at(1.0)["x"], -run.at(1.0)["x"], rtol=1e-9
    )
    leaves = [event.t for event in run.events if event.reason == "xi leaves stop"]
    assert len(leaves) > 5
    cut = 3.0 / 6.0
    half = run.at(cut)
    start = {name: float(half[name][0]) for name in ("x", "xi", "v", "xi_dot")}
    rest = simulate(rig, LAW, t_end=1.0 - cut, y0=start)
    assert rest["x"][-1] == pytest.approx(run["x"][-1], abs=1e-12)
    assert run.certificate.work_stops > 0.0
    assert run.certificate.work_friction > 0.0


@pytest.mark.parametrize(
    "name",
    [
        "capsule_mass",
        "stiffness",
        "upper_stop",
        "amplitude",
        "kinetic_coefficient",
        "static_coefficient",
    ],
)
@pytest.mark.parametrize("restitution", [0.0, 0.6])
def test_derivatives_pass_rest_at_a_stop(name, restitution):
    rig = replace(
        robot(6.0, restitution, -0.0015), drive=Torque(drive=Sine(amplitude=0.4, frequency=6.0))
    )
    exact = EventDriven(tolerance=1e-12)
    run = simulate(rig, LAW, t_end=0.3, solver=exact)
    value = {
        **vars(rig), **vars(rig.drive.drive), "kinetic_coefficient": 0.2, "static_coefficient": 0.25
    }[name]  # fmt: skip
    step = 1e-6 * value
    near = ensemble(
        rig, LAW, {name: np.array([value - step, value + step])}, t_end=0.3, solver=exact
    )["x"]
    difference = (near[1] - near[0]) / (2.0 * step)
    assert run.sensitivity("x", name)[-1] == pytest.approx(difference, rel=1e-5)


def test_an_impact_in_a_very_short_step_late_in_a_run_sets_nothing_else():
    # the step up to the 154th impact lasts .03 ps, less than the time is rounded to
    run = simulate(robot(15.0), LAW, t_end=158.0 / 15.0)
    hits = [event.t * 15.0 % 1.0 for event in run.events if event.reason == "xi hits stop"]
    assert np.ptp(hits[-20:]) < 1e-9


SOFT = SoftStop(place=-0.0015, stiffness=3000.0, damping=0.1)


@pytest.mark.parametrize("frequency", [2.5, 6.0, 13.0])
@pytest.mark.parametrize(
    "changed",
    [
        {"upper_stop": None, "upper_soft_stop": replace(SOFT, place=0.002)},
        {
            "upper_stop": None,
            "upper_soft_stop": replace(SOFT, place=0.002),
            "lower_soft_stop": SOFT,
        },
        {"restitution": 0.0, "lower_soft_stop": SOFT},
        {"restitution": 0.6, "lower_soft_stop": replace(SOFT, sticks=True)},
    ],
    ids=["soft", "two soft", "hard and soft", "hard and soft that sticks"],
)
def test_exact_pieces_between_stops_agree_with_steps_of_a_tolerance(frequency, changed):
    rig = replace(robot(frequency), **changed)
    drive = rig.drive.drive + Sine(amplitude=0.0, frequency=1.7 * frequency)  # two frequencies
    period = 1.0 / frequency
    exact, stepped = (
        simulate(one, LAW, t_end=6.0 * period, solver=EventDriven(tier="compiled"))
        for one in (rig, replace(rig, drive=Torque(drive=drive)))
    )
    assert exact.certificate.steps < 0.6 * stepped.certificate.steps
    assert [e.reason for e in exact.events] == [e.reason for e in stepped.events]
    times = np.linspace(0.0, 6.0 * period, 200)
    for name in ("x", "xi"):
        size = np.ptp(exact[name])
        np.testing.assert_allclose(
            exact.at(times)[name], stepped.at(times)[name], rtol=0, atol=1e-8 * size
        )
