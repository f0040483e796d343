"""Friction by inverse dynamics along the motion: exact motions, held forces, loads, rests."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks import rigs
from scipy import signal

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    Measurement,
    RecordSettings,
    SpringBlock,
    fit,
    select,
    simulate,
)
from stickslip.errors import InputError
from stickslip.identify.fits.motions import mean_force
from stickslip.mechanisms.drives import Sampled

J, LEVEL, VISCOUS = 5.0, 10.0, 30.0
TRUTH = CoulombViscous(kinetic_coefficient=LEVEL, viscous_coefficient=VISCOUS)
JOINED = RecordSettings(hold="first")
HELD = RecordSettings(hold="zero")
T = np.arange(0.0, 20.0, 1e-3)
WAVES = ((0.3, 0.8, 0.2), (0.1, 2.3, 1.0))
X = sum(a * np.sin(w * T + p) for a, w, p in WAVES)
V = sum(a * w * np.cos(w * T + p) for a, w, p in WAVES)
A = sum(-a * w**2 * np.sin(w * T + p) for a, w, p in WAVES)


def record_of(*, load=1.0, mass=J, noise=0.0):
    """Return a motion in closed form, and the force that it takes."""
    force = mass * A + VISCOUS * V + LEVEL * load * np.sign(V)
    return Measurement(
        time=T, position=X, force=force + noise * np.random.default_rng(0).normal(size=len(T))
    )


def derived(mechanism, law, record, *, unknown=("inertia",), settings=JOINED, free=("friction.*",)):
    return fit(mechanism, law, record, vary=[*free, *unknown], route="balance", settings=settings)


def pushed(seed, *, rate=1000):
    """Return a record of an axis under a force that is held from sample to sample."""
    t = np.arange(8 * rate) / rate
    force = 40 * np.sin(2 * math.pi * t) + 15 * np.sin(2.3 * t)
    force += 5 * np.sin(2 * math.pi * (0.3 + 0.1 * seed) * t + seed)
    drive = Sampled(times=t.tolist(), values=force.tolist())
    run = simulate(Axis(inertia=J, drive=drive), TRUTH, t_end=float(t[-1]))
    noise = np.random.default_rng(seed).normal(0.0, 1e-5, len(t))
    return Measurement(time=t, position=run.at(t)["x"] + noise, force=force)


def half_widths_off(found, name, true):
    estimate = found.estimate(name)
    return (estimate.value - true) / (0.5 * (estimate.high - estimate.low))


@pytest.mark.parametrize("joined", [False, True])
def test_the_mean_force_is_mass_times_second_difference_of_a_free_body(joined):
    dt, force = 0.01, np.random.default_rng(1).normal(size=200)
    rise = np.diff(force, append=force[-1]) if joined else 0.0 * force
    v = np.concatenate([[0.0], np.cumsum(force + 0.5 * rise)[:-1]]) * dt / J
    steps = v * dt + (force / 2.0 + rise / 6.0) * dt**2 / J
    x = np.concatenate([[0.0], np.cumsum(steps)[:-1]])
    second = J * np.diff(x, 2) / dt**2
    # rounding of positions of size 1 over the square of the step
    np.testing.assert_allclose(mean_force(force, joined=joined)[1:-1], second, atol=1e-9)


@pytest.mark.slow
def test_an_exact_motion_gives_friction_and_mass_back():
    found = derived(Axis(inertia=1.0), CoulombViscous, record_of())
    # the sign of slip is known to a sample of some hundreds between reversals
    assert found.law.kinetic_coefficient == pytest.approx(LEVEL, rel=2e-3)
    assert found.law.viscous_coefficient == pytest.approx(VISCOUS, rel=2e-3)
    assert found.mechanism.inertia == pytest.approx(J, rel=2e-3)


@pytest.mark.slow
def test_intervals_cover_level_slope_and_mass_under_noise_that_lasts():
    clean, covered = record_of(), []
    for seed in range(10):
        # 50 ms of memory, so that naive deviations would be several times too small
        white = np.random.default_rng(seed).normal(size=len(T))
        noise = signal.lfilter([0.1], [1.0, -0.98], white)
        found = derived(
            Axis(inertia=1.0), CoulombViscous, replace(clean, force=clean.force + noise)
        )
        for name, true in (
            ("inertia", J),
            ("kinetic_coefficient", LEVEL),
            ("viscous_coefficient", VISCOUS),
        ):
            covered.append(abs(half_widths_off(found, name, true)) <= 1.0)
    # of 30 intervals of 95 %, fewer than 24 hold with a probability of 0.03 %
    assert sum(covered) >= 24


@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 2))])
def test_a_held_force_acts_half_a_sample_late(seed):
    record = pushed(seed)
    held = derived(Axis(inertia=4.0), CoulombViscous, record, settings=HELD)
    # no disturbance: intervals are a thousandth wide, and end where sampling of signs begins
    assert abs(half_widths_off(held, "inertia", J)) < 1.5
    assert abs(half_widths_off(held, "kinetic_coefficient", LEVEL)) < 2.0
    assert held.mechanism.inertia == pytest.approx(J, rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("load", [5.0, 5.0 + 2.0 * np.sin(0.7 * T)], ids=["number", "array"])
def test_a_measured_load_divides_levels(load):
    record = replace(record_of(load=load), load=load)
    found = derived(Axis(inertia=J), CoulombViscous, record, unknown=())
    assert found.law.kinetic_coefficient == pytest.approx(LEVEL, rel=2e-3)
    assert found.law.viscous_coefficient == pytest.approx(VISCOUS, rel=5e-3)


def test_a_load_that_some_trials_only_have_is_refused():
    one = record_of()
    both = Measurement(trials=(one, replace(one, load=5.0)))
    with pytest.raises(InputError, match="give load for each trial"):
        derived(Axis(inertia=J), CoulombViscous, both)


@pytest.mark.slow
def test_the_weight_of_a_mass_that_is_looked_for_loads_the_contact():
    block, mu = SpringBlock(mass=1.0), 0.25
    weight = mu * 3.0 * block.gravity
    record = Measurement(time=T, position=X, force=3.0 * A + weight * np.sign(V))
    found = derived(block, Coulomb, record, unknown=("mass",))
    assert found.mechanism.mass == pytest.approx(3.0, rel=2e-3)
    assert found.law.kinetic_coefficient == pytest.approx(mu, rel=3e-3)


def dwelling():
    """Return a record of an axis that rests for 1.5 s after every 2.5 s, and its run."""
    t = np.arange(0.0, 16.0, 2e-3)
    on = np.sin(2 * math.pi * 0.5 * t) * (np.mod(t, 4.0) < 2.5)
    force = 25.0 * on + 6.0 * np.sin(2.0 * t) * (np.mod(t, 4.0) > 2.5)
    run = simulate(
        Axis(inertia=2.0, drive=Sampled(times=t.tolist(), values=force.tolist())),
        Coulomb(kinetic_coefficient=LEVEL),
        t_end=float(t[-1]),
    )
    return Measurement(time=t, position=run.at(t)["x"], force=force), np.asarray(run.at(t)["v"])


def test_rows_at_rest_shift_no_level():
    record, v = dwelling()
    assert np.mean(np.abs(v) < 1e-9) > 0.3
    found = derived(Axis(inertia=1.0), Coulomb, record, settings=HELD)
    assert found.law.kinetic_coefficient == pytest.approx(LEVEL, rel=0.01)
    assert found.mechanism.inertia == pytest.approx(2.0, rel=0.01)


def swayed(law, seed, *, step=2e-6):
    """Return a record by encoder of strokes, and of slow forces below the level between them."""
    t = np.arange(0.0, 12.0, 2e-3)
    random = np.random.default_rng(seed)
    stroke = 44.0 * np.sin(2 * math.pi * 0.7 * t) + 16.0 * np.sin(2 * math.pi * 1.9 * t + seed)
    force = np.where(np.mod(t, 4.0) < 2.0, stroke, 9.0 * np.sin(2 * math.pi * t))
    drive = Sampled(times=t.tolist(), values=force.tolist())
    run = simulate(Axis(inertia=J, drive=drive), law, t_end=float(t[-1]))
    position = step * np.round(run.at(t)["x"] / step)
    return Measurement(time=t, position=position, force=force + random.normal(0.0, 0.2, len(t)))


PLAIN = ("kinetic_coefficient", "bristle_stiffness", "viscous_coefficient")
BRISTLES = Dahl(kinetic_coefficient=LEVEL, bristle_stiffness=LEVEL / 8e-5, viscous_coefficient=30.0)


def along(record, kind, free=("friction.*",)):
    return derived(Axis(inertia=J), kind, record, unknown=(), settings=HELD, free=free)


def told(record):
    """Return the laws that are left of a cone and bristles."""
    laws = ["coulomb-viscous", "dahl"]
    verdict = select(
        Axis(inertia=J), laws, record, vary=["friction.*"], route="balance", settings=HELD
    )
    return [candidate.law.name for candidate in verdict.ladder]


@pytest.mark.slow  # `tests/identify/test_force_map.py` has bristles
def test_presliding_that_an_encoder_resolves_tells_bristles_from_a_cone():
    record = swayed(BRISTLES, 1)
    assert told(record) == ["dahl(level) + viscous"]
    bristles = along(record, Dahl, PLAIN)
    found = bristles.estimate("bristle_stiffness")
    # 3 % of its way to yield are as fine as the encoder
    assert found.value == pytest.approx(BRISTLES.bristle_stiffness, rel=0.05)
    assert found.low < BRISTLES.bristle_stiffness < found.high
    assert bristles.law.kinetic_coefficient == pytest.approx(LEVEL, rel=0.01)


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2)])
def test_where_a_body_rests_a_cone_is_told_and_bristles_are_refused(seed):
    record = swayed(TRUTH, seed)
    assert told(record) == ["coulomb-viscous"]
    found = along(record, CoulombViscous)
    assert found.law.kinetic_coefficient == pytest.approx(LEVEL, rel=0.01)
    assert found.law.viscous_coefficient == pytest.approx(VISCOUS, rel=0.01)
    # a stiffness would be what the encoder makes of a body at rest
    with pytest.raises(InputError, match="has states that this measurement does not show"):
        along(record, Dahl, PLAIN)


def test_an_encoder_that_stands_still_most_of_the_time_can_be_differentiated():
    record, _ = dwelling()
    step = 2.0**-14  # in steps whose differences have no rounding
    coarse = replace(record, position=step * np.round(record.position / step))
    assert np.median(np.abs(np.diff(coarse.position, 3))) == 0.0
    found = derived(Axis(inertia=2.0), Coulomb, coarse, unknown=(), settings=HELD)
    assert found.law.kinetic_coefficient == pytest.approx(LEVEL, rel=0.05)


def test_a_trial_with_a_mass_of_its_own_is_refused_where_one_is_looked_for():
    one = record_of()
    other = replace(one, overrides={"mechanism.inertia": 7.0})
    with pytest.raises(InputError, match=r"overrides mechanism\.inertia"):
        derived(Axis(inertia=J), CoulombViscous, Measurement(trials=(one, other)))


@pytest.mark.parametrize(
    ("rows", "position", "message"),
    [
        (slice(0, 25), X, "at least 60 samples without a gap"),
        (slice(0, 2000), np.zeros_like(X), "Position is constant"),
    ],
)
def test_a_record_that_is_too_short_or_never_moves_is_refused(rows, position, message):
    record = Measurement(time=T[rows], position=position[rows], force=record_of().force[rows])
    with pytest.raises(InputError, match=message):
        fit(Axis(inertia=J), Coulomb, record)


@pytest.mark.slow
def test_reversals_of_slowly_sampled_records_are_no_rests():
    """Slow samples at a reversal are not held by what balances forces without acceleration.

    When they were, the levels of these three simulated axes were 2.4 to 7 half widths too low.
    """
    errors = []
    for number, name in ((10, "quadratic-drag"), (19, "power-viscous"), (22, "quadratic-drag")):
        random = np.random.default_rng([77, number])
        rig = replace(rigs.draw(random, name), rate=100.0, disturbance=0.0)
        found = fit(
            Axis(inertia=1.0), type(rig.law), rigs.record(rig, random)[0],
            vary=["friction.*", "mechanism.inertia"], route="balance",
        )  # fmt: skip
        level = found.estimate("friction.kinetic_coefficient")
        errors.append((level.value - rig.law.kinetic_coefficient) / level.half_width)
    assert np.sqrt(np.mean(np.square(errors))) < 1.5


def one_sided(back):
    """Return an axis under a constant force that goes forward, and back for a share of the time."""
    v = 0.1 + 0.05 * np.sin(2.0 * T) + 0.02 * np.sin(7.3 * T)
    v = np.where(np.abs(T - 11.3) < 0.5 * back * T[-1], -v, v)
    b, a = signal.butter(2, 0.02)
    v = signal.filtfilt(b, a, v)
    force = J * np.gradient(v, T) + VISCOUS * v + LEVEL * np.sign(v) - 2.0
    force += 0.1 * np.random.default_rng(2).normal(size=len(T))
    return Measurement(time=T, position=np.cumsum(v) * 1e-3, force=force)


@pytest.mark.slow
def test_a_motion_one_way_says_that_its_level_includes_a_constant_force():
    found = derived(Axis(inertia=J), CoulombViscous, one_sided(0.0))
    said = (
        "a constant force (gravity, a cable, the zero of a sensor) cannot be distinguished from the"
    )
    assert any(said in sentence for sentence in found.sentences)
    known = derived(Axis(inertia=J, offset=-2.0), CoulombViscous, one_sided(0.0))
    assert known.estimate("kinetic_coefficient").value == pytest.approx(LEVEL, rel=0.01)


@pytest.mark.slow
def test_a_short_way_back_tells_a_constant_force_from_a_level():
    found = derived(Axis(inertia=J), CoulombViscous, one_sided(0.1))
    offset, level = found.estimate("offset"), found.estimate("kinetic_coefficient")
    assert offset.value == pytest.approx(-2.0, rel=0.05)
    assert level.value == pytest.approx(LEVEL, rel=0.01)  # without the way back, it would be 8 N
