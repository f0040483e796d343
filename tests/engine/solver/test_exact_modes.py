"""Runs of linear modes, which are exact but for rounding, against closed forms and exponentials."""

import dataclasses
import itertools
import math
import random
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.optimize import brentq
from tests.support import decade, examples, nearly

from stickslip import Axis, Coulomb, CoulombViscous, SpringBlock, TowedBlock, simulate
from stickslip.engine import Status
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse, Sampled

SOME = examples(40)
TINY = 3e-14
"""Some hundred roundings: those of tens of steps, or of hundreds where they mostly cancel. SciPy's
exponentials err as much: compared with 40 digits by 2e-14 of the largest speed, the run by 7e-15.
"""


def times_of(run, *reasons):
    return np.array([event.t for event in run.events if event.reason in reasons])


# Closed forms


@pytest.mark.parametrize(
    ("mass", "stiffness", "level", "start", "stops"),
    [
        (0.3, 50.0, 1.0, 0.4, 10),
        (7.0, 50.0, 1.0, -0.4, 10),
        (1.0, 1.0, 1e-3, 1.0, 500),
        (1e-4, 3e6, 2.0, 1e-3, 750),
    ],
)
def test_every_stop_of_a_decaying_swing_has_its_time_and_its_place(
    mass, stiffness, level, start, stops
):
    half = math.pi * math.sqrt(mass / stiffness)
    axis = Axis(inertia=mass, stiffness=stiffness)
    law = Coulomb(kinetic_coefficient=level)
    run = simulate(axis, law, t_end=(stops + 2) * half, y0={"x": start})
    turns = times_of(run, "reversal", "stop")
    assert abs(len(turns) - stops) <= 1  # where the last swing ends at the level itself
    n = np.arange(1, len(turns) + 1)
    np.testing.assert_allclose(turns, n * half, rtol=TINY)
    size = abs(start)
    places = (-1.0) ** n * (size - 2 * n * level / stiffness) * np.sign(start)
    np.testing.assert_allclose(run.at(turns)["x"], places, rtol=0, atol=TINY * size)
    assert run.status is Status.AT_REST
    assert run.certificate.steps <= 3 * len(turns) + 1  # of more than a radian, and the rest


def test_a_stop_and_a_break_away_within_one_straight_piece_are_those_of_the_polynomials():
    J, r, f_k, f_s, v_0 = 2.0, 0.1, 1.0, 1.5, 1.0
    axis = Axis(inertia=J, drive=PiecewiseLinear(times=(0.0, 40.0), values=(0.0, 40.0 * r)))
    law = Coulomb(kinetic_coefficient=f_k, static_coefficient=f_s)
    run = simulate(axis, law, t_end=30.0, y0={"v": v_0})
    stop, leave = (f_k - math.sqrt(f_k**2 - 2 * r * J * v_0)) / r, f_s / r
    assert [event.reason for event in run.events] == ["stop", "break-away"]
    np.testing.assert_allclose([event.t for event in run.events], [stop, leave], rtol=TINY)
    x_stop = v_0 * stop + (r * stop**3 / 6 - f_k * stop**2 / 2) / J
    tau = np.linspace(0.0, 30.0 - leave, 50)
    x = x_stop + ((f_s - f_k) * tau**2 / 2 + r * tau**3 / 6) / J
    np.testing.assert_allclose(run.at(leave + tau)["x"], x, rtol=TINY)


def test_a_body_leaves_from_rest_without_a_jump_of_its_acceleration():
    r, f = 0.25, 1.0  # as long as the ramp is below the level it stays, then x = r tau^3 / 6
    axis = Axis(inertia=1.0, drive=PiecewiseLinear(times=(0.0, 40.0), values=(0.0, 40.0 * r)))
    run = simulate(axis, Coulomb(kinetic_coefficient=f), t_end=30.0)
    (event,) = run.events
    assert math.isclose(event.t, f / r, rel_tol=TINY)
    tau = np.linspace(0.0, 26.0, 50)
    # the start is known to a rounding of the time, which counts where tau is small
    np.testing.assert_allclose(run.at(4.0 + tau)["x"], r * tau**3 / 6, rtol=TINY, atol=1e-28)


@pytest.mark.parametrize("seed", range(20))
def test_a_towed_block_with_one_level_of_friction_breaks_away_and_touches_rest_each_period(seed):
    dice = random.Random(seed)
    k, V, f = dice.uniform(0.5, 50.0), 10.0 ** dice.uniform(-4.0, 0.0), dice.uniform(0.5, 2.0)
    leave, w = f / (k * V), math.sqrt(k)
    period = 2 * math.pi / w
    block = TowedBlock(mass=1.0, stiffness=k, speed=V, load=1.0)
    run = simulate(block, Coulomb(kinetic_coefficient=f), t_end=leave + 5.5 * period)
    assert [e.reason for e in run.events if e.t < leave + 0.99 * period] == ["break-away"]
    assert math.isclose(run.events[0].t, leave, abs_tol=TINY * run.span[1])
    tau = np.linspace(0.0, 5.5 * period, 101)
    x = V * (tau - np.sin(w * tau) / w)  # v touches zero, where a rounding may make it a short rest
    np.testing.assert_allclose(run.at(leave + tau)["x"], x, rtol=0, atol=1e-13 * V * run.span[1])


def bounces(m, k, x_0, push, f, count):
    """Yield times and places at which a pushed block leaves its spring, turns, touches, turns."""
    w = math.sqrt(k / m)
    t, x = 0.0, 0.0
    for _ in range(count):
        middle = x_0 - (push + f) / k
        angle = math.acos((middle - x_0) / (middle - x))
        v = (middle - x) * w * math.sin(angle)
        t += angle / w
        yield "block leaves the spring", t, x_0
        t += v * m / (push + f)
        far = v**2 * m / (2 * (push + f))
        yield "reversal", t, x_0 + far
        v = math.sqrt(2 * (push - f) / m * far)
        t += v * m / (push - f)
        yield "spring touches", t, x_0
        d = (push - f) / k
        t += (math.pi - math.atan2(v / w, d)) / w
        x = x_0 - d - math.hypot(d, v / w)
        yield "reversal", t, x


@pytest.mark.parametrize("friction", [0.001, 0.02])
def test_a_block_that_is_pushed_back_leaves_its_spring_and_touches_it_again(friction):
    m, k, x_0, push = 1.0, 100.0, 0.1, 2.0
    rig = SpringBlock(
        mass=m, stiffness=k, compression=x_0, drive=Pulse(level=-push, duration=1e3, start=-1.0)
    )
    exact = list(bounces(m, k, x_0, push, friction * m * 9.81, 4))
    law = Coulomb(kinetic_coefficient=friction)
    run = simulate(rig, law, t_end=exact[-1][1] * 1.001)
    assert [event.reason for event in run.events] == [reason for reason, _, _ in exact]
    times, places = zip(*[(t, x) for _, t, x in exact], strict=True)
    np.testing.assert_allclose([event.t for event in run.events], times, rtol=TINY)
    x = run.at([event.t for event in run.events])["x"]
    np.testing.assert_allclose(x, places, rtol=0, atol=TINY * x_0)


@pytest.mark.parametrize("excess", [1e-2, 1e-6, 1e-10])
def test_a_velocity_that_dips_below_zero_for_a_moment_is_a_stop(excess):
    k, V, f = 4.0, 0.1, 1.0
    w = math.sqrt(k)
    block = TowedBlock(mass=1.0, stiffness=k, speed=V, load=1.0)
    law = Coulomb(kinetic_coefficient=f)
    # v = V + W cos(w t): about the steady stretch, with a swing as large as the speed
    swing = V * (1 + excess)
    run = simulate(block, law, t_end=2.0, y0={"x": -f / k, "v": V + swing})
    stop = math.acos(-V / swing) / w
    assert [event.reason for event in run.events] == ["stop", "break-away"]
    # the fall is as slow as its depth is small
    doubt = TINY / math.sqrt(2 * excess)
    assert abs(run.events[0].t - stop) <= doubt
    x = V * stop - f / k + swing / w * math.sin(w * stop)
    assert abs(run.events[1].t - (f / k + x) / V) <= doubt / math.sqrt(excess)
    calm = simulate(block, law, t_end=2.0, y0={"x": -f / k, "v": V + V * (1 - excess)})
    assert calm.events == ()


# Sampled inputs against exponentials


@dataclass
class Reference:
    """A mass with spring, damper and Coulomb friction, propagated piece by piece."""

    m: float
    c: float
    k: float
    f_k: float
    f_s: float
    x: float = 0.0
    v: float = 0.0
    held: bool = True

    def flow(self, sign, u, g, start, tau):
        """Return the state after sliding for a time, the force being u + g times the time."""
        A = np.zeros((4, 4))
        A[0, 1] = 1.0
        A[1] = -self.k / self.m, -self.c / self.m, (u + g * start - sign * self.f_k) / self.m, 0
        A[1, 3] = g / self.m
        A[3, 2] = 1.0
        return (expm(A * tau) @ np.array([self.x, self.v, 1.0, 0.0]))[:2]

    def turn(self, sign, u, g, start, rest):
        """Return how long a slide lasts, or None if it outlasts the rest of the piece."""

        def speed(tau):
            return sign * self.flow(sign, u, g, start, tau)[1]

        first = 0.0 if self.v else 1e-9 * rest  # from rest it rises before it falls
        grid = np.linspace(first, rest, max(20, int(40 * rest)))
        for low, high in itertools.pairwise(grid):
            if speed(low) > 0 > speed(high):
                return brentq(speed, low, high, xtol=1e-17, rtol=1e-15)
        return None

    def piece(self, u, g, length):
        """Go through a piece; yield reason and time of each event."""
        start = 0.0
        while start < length:
            pull = u + g * start - self.k * self.x
            if self.held and abs(pull) <= self.f_s:
                level = math.copysign(self.f_s, g)
                start += (level - pull) / g if g else math.inf
                if not start < length:
                    return
            if self.held:
                self.held = False
                yield "break-away", start
                pull = u + g * start - self.k * self.x
            sign = math.copysign(1.0, self.v if self.v else pull)
            tau = self.turn(sign, u, g, start, length - start)
            step = length - start if tau is None else tau
            self.x, self.v = self.flow(sign, u, g, start, step)
            start += step
            if tau is None:
                return
            self.v = 0.0
            self.held = abs(u + g * start - self.k * self.x) <= self.f_s
            yield ("stop" if self.held else "reversal"), start


def followed(reference, times, values, hold):
    """Return reasons and times of the events, and the states at the samples."""
    reasons, instants, states = [], [], [(reference.x, reference.v)]
    for i, (begin, end) in enumerate(itertools.pairwise(times)):
        growth = (values[i + 1] - values[i]) / (end - begin) if hold == "first" else 0.0
        for reason, since in reference.piece(values[i], growth, end - begin):
            reasons.append(reason)
            instants.append(begin + since)
        states.append((reference.x, reference.v))
    return reasons, instants, np.array(states)


@pytest.mark.parametrize("hold", ["zero", "first"])
@pytest.mark.parametrize("f_s", [1.0, 1.4])
@pytest.mark.parametrize(
    ("step", "count", "damping"), [(0.0625, 80, 0.5), (0.4, 40, 0.5), (3.0, 8, 0.1), (3.0, 8, 9.0)]
)
def test_sampled_input_is_followed_as_by_exponentials(hold, f_s, step, count, damping):
    dice = random.Random(count)
    times = [step * i for i in range(count)]
    values = [0.0, *[dice.gauss(0.0, 4.0) for _ in times[1:]]]
    m, k, f_k = 1.5, 20.0, 1.0
    axis = Axis(
        inertia=m,
        stiffness=k,
        damping=damping,
        drive=Sampled(times=tuple(times), values=tuple(values), hold=hold),
    )
    law = Coulomb(kinetic_coefficient=f_k, static_coefficient=f_s)
    run = simulate(axis, law, t_end=times[-1])
    reference = Reference(m, damping, k, f_k, f_s)
    reasons, instants, states = followed(reference, times, values, hold)
    assert [event.reason for event in run.events if event.t < times[-1]] == reasons
    assert len(reasons) > 5
    # both sides round at every sample and event; slow stops magnify it
    np.testing.assert_allclose([e.t for e in run.events][: len(reasons)], instants, rtol=1e-12)
    size = np.abs(states).max(axis=0)
    np.testing.assert_allclose(run.at(times)["x"], states[:, 0], rtol=0, atol=TINY * size[0])
    np.testing.assert_allclose(run.at(times)["v"], states[:, 1], rtol=0, atol=TINY * size[1])
    if step == 3.0 and damping < 1.0:  # several events within one sample
        most = max(sum(a <= t < b for t in instants) for a, b in itertools.pairwise(times))
        assert most >= 2


# Invariants

samples = st.lists(nearly(-8, 8), min_size=16, max_size=16).map(tuple)
sampled_axes = st.builds(
    lambda values, hold, **rig: Axis(
        drive=Sampled(times=tuple(0.25 * i for i in range(16)), values=values, hold=hold), **rig
    ),
    values=samples,
    hold=st.sampled_from(["zero", "first"]),
    inertia=decade(-0.5, 0.5),
    stiffness=st.just(0.0) | decade(0, 2),
    damping=st.just(0.0) | decade(-1, 2),
)
linear_laws = st.builds(
    lambda kinetic, surplus, viscous: CoulombViscous(
        kinetic_coefficient=kinetic,
        static_coefficient=kinetic + surplus,
        viscous_coefficient=viscous,
    ),
    decade(-1, 0.5),
    st.just(0.0) | decade(-2, 0),
    st.just(0.0) | decade(-1, 1),
)
starts = st.fixed_dictionaries({"x": nearly(-0.2, 0.2), "v": nearly(-0.5, 0.5)})


def with_drive(axis, times, values):
    drive = dataclasses.replace(axis.drive, times=tuple(times), values=tuple(values))
    return dataclasses.replace(axis, drive=drive)


@SOME
@given(
    axis=sampled_axes,
    law=linear_laws,
    y0=starts,
    powers=st.tuples(*[st.integers(-12, 12)] * 3),
    side=st.sampled_from([1.0, -1.0]),
)
def test_mirrored_and_in_other_units_a_run_is_the_same_to_the_last_bit(axis, law, y0, powers, side):
    M, L, T = (2.0**power for power in powers)
    force, x = M * L / T**2, side * L
    drive = axis.drive
    other = dataclasses.replace(
        with_drive(axis, [t * T for t in drive.times], [u * side * force for u in drive.values]),
        inertia=axis.inertia * M,
        stiffness=axis.stiffness * M / T**2,
        damping=axis.damping * M / T,
        load=axis.load * force,
    )
    thicker = dataclasses.replace(law, viscous_coefficient=law.viscous_coefficient * M / T)
    run = simulate(axis, law, t_end=4.0, y0=y0)
    image = simulate(other, thicker, t_end=4.0 * T, y0={"x": y0["x"] * x, "v": y0["v"] * x / T})
    np.testing.assert_array_equal(image.t, run.t * T)
    instants = run.t[-1] * np.array([0.0, 0.2, 0.61, 0.9])
    for name, factor in (("x", x), ("v", x / T)):
        np.testing.assert_array_equal(image[name], run[name] * factor)
        here, there = image.at(instants * T), run.at(instants)
        np.testing.assert_array_equal(here[name], there[name] * factor)
    changes = [[(e.t * s, e.reason) for e in r.events] for r, s in ((image, 1.0), (run, T))]
    assert changes[0] == changes[1]


# Long runs


@pytest.mark.parametrize("t_end", [1.0, 1e4, 1e8])
def test_an_early_event_of_a_long_step_is_located_to_rounding_of_its_own_time(t_end):
    ramp = PiecewiseLinear(times=(0.0, 1e9), values=(0.0, 3e9))
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.1)
    run = simulate(Axis(inertia=1.0, drive=ramp), law, t_end=t_end)
    assert math.isclose(run.events[0].t, 1.1 / 3.0, rel_tol=TINY)
    thrown = simulate(
        Axis(inertia=1.0), Coulomb(kinetic_coefficient=3.0), t_end=t_end, y0={"v": 0.7}
    )
    assert math.isclose(thrown.events[0].t, 0.7 / 3.0, rel_tol=TINY)


def swing_for(periods):
    run = simulate(
        Axis(inertia=1.0, stiffness=1.0),
        Coulomb(kinetic_coefficient=0.0),
        t_end=2 * math.pi * periods,
        y0={"x": 0.3},
    )
    assert run.certificate.steps <= 6 * periods + 2
    books = run.certificate
    # each step adds a rounding or so, most of which cancel
    assert math.isclose(books.energy_end, books.energy_start, rel_tol=1e-11)
    # every turn is on the half period, but for a rounding of the time a step
    turns = times_of(run, "reversal", "stop")
    exact = math.pi * np.arange(1, len(turns) + 1)
    doubt = 3 * np.arange(1, len(turns) + 1) * np.spacing(exact) / 2
    assert np.all(np.abs(turns - exact) <= doubt)


def test_a_hundred_undamped_swings_keep_their_energy():
    swing_for(100)


@pytest.mark.slow
def test_ten_thousand_undamped_swings_keep_their_energy():
    swing_for(10_000)
