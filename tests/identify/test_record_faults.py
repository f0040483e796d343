"""Records of one coordinate that are exact, broken, or of which something is given wrong."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

from stickslip import (
    Axis,
    CoulombViscous,
    DirectionDependent,
    FrictionLaw,
    LuGre,
    Measurement,
    Pendulum,
    simulate,
)
from stickslip.errors import InputError
from stickslip.identify.bands import Array
from stickslip.identify.judgement import Judgement
from stickslip.identify.problems.record_columns import Balance, Memory
from stickslip.identify.problems.record_rows import (
    MIDDLE,
    BalanceRows,
    by_best_sensor,
    cutoff_of,
    pieces_of,
)
from stickslip.identify.problems.record_signals import Record, records_of
from stickslip.identify.problems.records import RecordProblem
from stickslip.mechanisms.drives import PiecewiseLinear, Sampled, Sine
from stickslip.show.formatting import quantity

INERTIA, LEVEL, VISCOUS = 5.0, 8.0, 20.0


def driven(
    *, level: float = LEVEL, noise: float = 1.0, seconds: float = 8.0, inertia: float = INERTIA,
) -> Record:  # fmt: skip
    """Return a record at 500 Hz of an axis with level and viscous friction."""
    rng = np.random.default_rng(1)
    t = np.arange(0.0, seconds, 0.002)
    x, v, a = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    for size, f in zip((0.04, 0.012, 0.003), (0.35, 1.3, 3.1), strict=True):
        w, phase = 2.0 * math.pi * f, rng.uniform(0.0, 6.0)
        x += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w * w * np.sin(w * t + phase)
    force = inertia * a + level * np.sign(v) + VISCOUS * v
    return Record(
        time=t,
        position=x + noise * 1e-6 * rng.normal(size=len(t)),
        force=force + noise * 0.02 * LEVEL * rng.normal(size=len(t)),
    )


def judged(*records: Record) -> Judgement:
    return Judgement(RecordProblem([*records]))


def values(judgement: Judgement) -> dict[str, float]:
    return {one.path.rpartition(".")[2]: one.value for one in judgement.intervals}


# ---- numbers without noise


def exact_friction() -> Record:
    t = np.linspace(0.0, 12.0, 240, endpoint=False)
    v = np.sin(2.0 * t + 0.3)
    return Record(
        time=t, position=-0.5 * np.cos(2.0 * t + 0.3), velocity=v,
        force=10.0 * np.sign(v) + 30.0 * v, friction=True,
    )  # fmt: skip


def test_numbers_that_a_law_made_are_judged_without_noise() -> None:
    judgement = judged(exact_friction())
    assert judgement.named.family == ("level", "viscous")
    found = values(judgement)
    # a filter of 2.6 Hz over 20 samples a second leaves a thousandth
    assert found["kinetic_coefficient"] == pytest.approx(10.0, rel=2e-3)
    assert found["viscous_coefficient"] == pytest.approx(30.0, rel=2e-3)


def test_no_row_is_told_more_closely_than_numbers_are_rounded() -> None:
    model = RecordProblem([driven(noise=0.0)]).model
    for (which, _), weights in model.weights.items():
        size = float(np.sqrt(np.mean(model.balance.rows(which).response ** 2)))
        assert np.all(weights * size <= 1e6)


def test_an_exact_record_of_a_few_rows_is_judged() -> None:
    t = np.arange(0.0, 0.6, 0.01)
    short = Record(time=t, position=np.sin(3.0 * t), force=np.cos(3.0 * t))
    assert np.all(np.isfinite(judged(short).curves(judged(short).problem.asked())))


# ---- channels of which no balance can be made


@pytest.mark.parametrize(
    ("broken", "cure"),
    [
        ({"position": np.full(4000, 0.3)}, "does not change"),
        ({"force": np.zeros(4000)}, "the force .* is 0 throughout"),
        ({"force": np.zeros(4000), "friction": True}, "the force .* is 0 throughout"),
        ({"velocity": np.zeros(4000)}, "the velocity .* is 0 throughout"),
        ({"load": np.where(np.arange(4000) == 7, np.nan, 1.0)}, "load .* at sample 7"),
    ],
)
def test_a_channel_of_which_no_balance_can_be_made_is_named(
    broken: dict[str, Any], cure: str
) -> None:
    with pytest.raises(InputError, match=cure):
        RecordProblem([replace(driven(), **broken)])


@pytest.mark.parametrize("place", [0.0, 0.3])
def test_the_cutoff_of_a_record_at_rest_is_finite(place: float) -> None:
    t = np.arange(0.0, 4.0, 0.01)
    still = Record(time=t, position=np.full(400, place), force=np.sin(t))
    for one in (still, replace(still, friction=True), replace(still, inertia=1.0)):
        assert 0.0 < cutoff_of(one) < 100.0


def test_a_record_at_rest_beside_one_that_moves_is_no_error() -> None:
    record = driven()
    t = record.time[:1000] + 20.0
    still = Record(time=t, position=np.full(1000, 0.01), force=np.zeros(1000))
    assert judged(record, still).named.family == ("level", "viscous")


# ---- sensors


def test_positions_are_taken_where_velocities_are_coarse_at_the_lowest_cutoff() -> None:
    record, rng = driven(), np.random.default_rng(3)
    velocity = np.gradient(record.position, record.time)
    coarse = replace(record, velocity=velocity + 0.05 * rng.normal(size=len(velocity)))
    noisy = replace(coarse, position=record.position + 1e-2 * rng.normal(size=len(velocity)))
    assert by_best_sensor([coarse])[0].velocity is None
    assert by_best_sensor([noisy])[0].velocity is not None


def test_noise_of_rows_is_that_of_the_force_where_it_stands() -> None:
    record, rng = driven(level=0.0, noise=0.0), np.random.default_rng(4)
    count, deviation = len(record.time), 0.5
    noise = deviation * rng.normal(size=count) * (np.arange(count) > count // 2)
    pieces, every = pieces_of([replace(record, force=record.force + noise)], cutoff=15.0)
    rows = BalanceRows(pieces, MIDDLE, every)
    own, late = rows.sensed(INERTIA), rows.time > 4.5
    # white noise of deviation s in samples of h has s sqrt(2 h f) below f
    expected = deviation * math.sqrt(2.0 * pieces[0].step * 15.0)
    assert np.median(own[late]) == pytest.approx(expected, rel=0.15)
    assert np.median(own[rows.time < 3.5]) < 0.2 * expected


# ---- what is given wrong


@pytest.mark.parametrize(
    ("inertia", "length"), [(1.2 * INERTIA, 1.0), (INERTIA, 0.1), (INERTIA, 10.0)]
)
def test_an_inertia_that_is_not_as_given_is_named_and_changes_no_law(
    inertia: float, length: float
) -> None:
    record = driven()
    judgement = judged(replace(record, position=length * record.position, inertia=inertia))
    assert judgement.named.family == ("level", "viscous")
    assert values(judgement)["kinetic_coefficient"] == pytest.approx(LEVEL, rel=0.02)
    assert values(judgement)["viscous_coefficient"] == pytest.approx(VISCOUS / length, rel=0.02)
    (found,) = [one for one in judgement.findings if one.term == "inertia_given"]
    assert found.asserted
    assert 1.0 + found.size == pytest.approx(INERTIA / length / inertia, rel=0.02)
    assert "times as given" in found.sentence


def swung(frequency: float, heavier: float = 1.2) -> Record:
    """Return a driven pendulum whose inertia is so many times that of its mass at its length."""
    rng, t = np.random.default_rng(2), np.arange(0.0, 12.0, 0.004)
    w, x, v, a = 2.0 * math.pi * frequency, *np.zeros((3, len(t)))
    for size, k in ((1.1, 1.0), (0.35, 2.7), (0.1, 6.1)):
        x += size * np.sin(k * w * t)
        v += size * k * w * np.cos(k * w * t)
        a -= size * (k * w) ** 2 * np.sin(k * w * t)
    arm = Pendulum(mass=2.0, length=0.5)
    inertia, weight = arm.mass * arm.length**2, arm.mass * 9.80665 * arm.length
    torque = heavier * inertia * a + weight * np.sin(x) + 0.4 * np.sign(v) + 0.05 * v
    measured = Measurement(
        time=t, position=x + 1e-5 * rng.normal(size=len(t)),
        force=torque + 0.05 * rng.normal(size=len(t)), turning=True,
    )  # fmt: skip
    return records_of(replace(arm, mass=1.0), measured, unknown=["mechanism.mass"])[0]


@pytest.mark.slow
def test_a_wrong_length_is_let_in_and_named_where_the_mass_is_looked_for() -> None:
    judgement = judged(swung(0.25))
    (found,) = [one for one in judgement.findings if one.term == "inertia_given"]
    assert found.asserted
    assert found.size == pytest.approx(0.2, abs=0.02)
    assert "Beside the forces of the mechanism, the inertia is 1.2" in found.sentence
    rows = judgement.problem.like([swung(0.4)])
    band = judgement.reading_band(rows)
    inside = np.mean((band.low <= rows.response) & (rows.response <= band.high))
    assert inside > 0.93


@pytest.mark.slow
def test_a_mass_at_its_length_is_found_and_nothing_is_named() -> None:
    judgement = judged(swung(0.25, heavier=1.0))
    assert not [one for one in judgement.findings if one.term.endswith("_given") and one.asserted]
    (mass,) = [one for one in judgement.intervals if one.path == "mechanism.mass"]
    assert mass.low <= 2.0 <= mass.high


def test_an_inertia_as_given_is_no_finding() -> None:
    judgement = judged(replace(driven(), inertia=INERTIA))
    assert not [one for one in judgement.findings if one.term == "inertia_given"]


# ---- what a gear transmits


def geared(share: float, noise: float = 0.0) -> Record:
    """Return a record whose level grows with a share of what a gear transmits."""
    record = driven()
    t = record.time
    through = 30.0 * np.sin(2.0 * t + 1.0) + 12.0 * np.sin(5.3 * t)
    side = np.sign(np.gradient(np.convolve(record.position, np.full(9, 1.0 / 9.0), "same")))
    read = through + noise * np.random.default_rng(2).normal(size=len(t))
    return replace(record, force=record.force + share * side * np.abs(through), transmitted=read)


@pytest.mark.slow
def test_friction_that_grows_with_the_torque_of_a_gear_is_named() -> None:
    judgement = judged(geared(0.2, noise=3.0))
    assert judgement.named.family == ("gear", "level", "viscous")
    assert judgement.composition.text == "level + weight[transmitted] + viscous"
    found = values(judgement)
    assert found["transmitted_coefficient"] == pytest.approx(0.2, rel=0.05)
    assert found["kinetic_coefficient"] == pytest.approx(LEVEL, rel=0.05)


def test_readings_of_another_record_have_the_friction_of_its_gear() -> None:
    judgement = judged(geared(0.2))
    problem = judgement.problem
    assert isinstance(problem, RecordProblem)
    other = problem.like([geared(0.2)])
    band = judgement.reading_band(other)
    assert np.mean((band.low <= other.response) & (other.response <= band.high)) > 0.9
    curves = [problem.at([0.05], inputs={"transmitted": x}) for x in (0.0, 40.0)]
    low, high = (float(judgement.band(one).median[0]) for one in curves)
    assert high - low == pytest.approx(0.2 * 40.0, rel=0.1)


def test_a_gear_that_rubs_no_more_with_its_torque_is_not_named() -> None:
    assert judged(geared(0.0)).named.family == ("level", "viscous")


# ---- friction that differs by direction, and the moments of turns

SIDES = DirectionDependent(
    forward_kinetic_coefficient=4.0, backward_kinetic_coefficient=5.0,
    forward_viscous_coefficient=3.0, backward_viscous_coefficient=9.0,
)  # fmt: skip


def moved(friction: FrictionLaw, seed: int, size: float = 1.0) -> Record:
    """Return a record at 200 Hz under a force of five sines that is held between samples."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, 8.0, 0.005)
    phases, sizes = random.uniform(0.0, 2.0 * np.pi, 5), random.uniform(4.0, 9.0, 5)
    force = sum(
        size * a * np.sin(2.0 * np.pi * f * t + p)
        for f, a, p in zip((0.23, 0.41, 0.67, 1.1, 1.7), sizes, phases, strict=True)
    )
    axis = Axis(inertia=2.0, drive=Sampled(times=t, values=np.asarray(force)))
    x = simulate(axis, friction, t_end=float(t[-1])).at(t)["x"]
    read = x + random.normal(0.0, 1e-5, len(t))
    return Record(time=t, position=read, force=np.asarray(force), inertia=2.0, held=True)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 3, 8])
def test_friction_that_differs_by_direction_is_named_without_bristles(seed: int) -> None:
    """One turn between samples shows no bristle; few rows show slopes of a factor of 3."""
    judgement = judged(moved(SIDES, seed))
    assert judgement.named.family == ("level", "offset", "viscous", "viscous_direction")
    problem = judgement.problem
    assert isinstance(problem, RecordProblem)
    assert problem.memory == ""
    found = values(judgement)
    assert found["forward_viscous_coefficient"] == pytest.approx(3.0, rel=0.05)
    assert found["backward_viscous_coefficient"] == pytest.approx(9.0, rel=0.05)
    assert found["offset"] == pytest.approx(-0.5, abs=0.05)


def test_rows_that_are_few_are_taken_before_those_at_rest() -> None:
    """An axis that moves for 4 % of the time has no rows of friction while it rests."""
    slow = moved(CoulombViscous(kinetic_coefficient=12.0, viscous_coefficient=6.0), 2, 0.7)
    (piece,), _ = pieces_of([slow])
    usable = piece.usable(40.0)
    assert usable.any()
    assert not np.any(usable & piece.still)


# ---- bristles


@pytest.mark.slow
def test_stiffness_and_damping_of_bristles_are_in_their_intervals() -> None:
    t = np.arange(0.0, 12.0, 0.002)
    phases = np.random.default_rng(4).uniform(0.0, 2.0 * np.pi, 4)
    force = sum(
        a * np.sin(2.0 * np.pi * f * t + p)
        for a, f, p in zip((1.2, 0.8, 0.6, 0.4), (0.4, 0.9, 1.7, 3.1), phases, strict=True)
    )
    truth = LuGre(
        kinetic_coefficient=0.8, static_coefficient=1.0, stribeck_velocity=0.3,
        viscous_coefficient=0.2, bristle_stiffness=200.0, bristle_damping=1.0,
    )  # fmt: skip
    axis = Axis(inertia=0.02, drive=PiecewiseLinear(times=t, values=force))
    x = simulate(axis, truth, t_end=float(t[-1])).at(t)["x"]
    judgement = judged(Record(time=t, position=x, force=np.asarray(force), inertia=0.02))
    problem = judgement.problem
    assert isinstance(problem, RecordProblem)
    assert problem.memory == "lugre"
    found = {one.path.rpartition(".")[2]: one for one in judgement.intervals}
    for name, true in (("bristle_stiffness", 200.0), ("bristle_damping", 1.0)):
        assert found[name].low_any < true < found[name].high_any
        assert found[name].value == pytest.approx(true, rel=0.1)
    # each draw has its own length
    stiffness = judgement.values["friction.bristle_stiffness"]
    assert len(np.unique(stiffness.round(9))) > 0.9 * len(stiffness)


# ---- forces that are recorded late


@pytest.mark.slow
@pytest.mark.parametrize("delay", [0.02, 0.008])
def test_friction_that_is_recorded_late_is_a_delay_with_its_size(delay: float) -> None:
    t = np.arange(0.0, 8.0, 0.004)
    x = 0.03 * np.sin(4.0 * t) + 0.01 * np.sin(11.3 * t)
    v = 0.12 * np.cos(4.0 * t) + 0.113 * np.cos(11.3 * t)
    friction = np.interp(t - delay, t, 2.0 * np.sign(v) + 3.0 * v)
    friction += 0.02 * np.random.default_rng(1).normal(size=t.size)
    judgement = judged(Record(time=t, position=x, force=friction, friction=True))
    assert judgement.named.family == ("level", "viscous")
    problem = judgement.problem
    assert isinstance(problem, RecordProblem)
    assert problem.memory == ""
    (found,) = [one for one in judgement.findings if one.term == "delay"]
    assert found.asserted
    assert abs(found.size) == pytest.approx(delay, rel=0.02)
    other = problem.like([Record(time=t, position=x, force=friction, friction=True)])
    band = judgement.reading_band(other)
    assert np.mean((band.low <= other.response) & (other.response <= band.high)) > 0.9


@pytest.mark.slow
def test_a_low_pass_of_the_recorded_force_is_told_from_a_delay() -> None:
    """A pure delay alone makes the inertia behind such a channel too small."""
    record = driven(noise=0.0)
    kept = math.exp(-0.002 / 0.012)
    force = lfilter([1.0 - kept], [1.0, -kept], record.force)
    noise = np.random.default_rng(3).normal(size=(2, len(force)))
    late = replace(
        record, force=force + 0.02 * noise[0], position=record.position + 1e-6 * noise[1]
    )
    problem = judged(late).problem
    assert problem.model.acting(problem.posterior.best).order == 1
    inertia = problem.rig(problem.posterior.draws(200))["inertia"]
    assert np.median(inertia) == pytest.approx(INERTIA, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("delay", [0.012, -0.012, 0.03])
def test_a_delay_of_the_force_changes_no_law_and_no_inertia(delay: float) -> None:
    """Beyond a part of 1/cutoff it is not linear."""
    record = driven()
    late = np.interp(record.time - delay, record.time, record.force)
    judgement = judged(replace(record, force=late))
    found = values(judgement)
    assert judgement.named.family == ("level", "viscous")
    assert found["kinetic_coefficient"] == pytest.approx(LEVEL, rel=0.01)
    assert found["inertia"] == pytest.approx(INERTIA, rel=0.01)
    (one,) = [one for one in judgement.findings if one.term == "delay"]
    assert one.size == pytest.approx(-delay, rel=0.02)


# ---- readings at rest


def test_at_rest_friction_is_anywhere_up_to_its_level() -> None:
    law = CoulombViscous(kinetic_coefficient=8.0, viscous_coefficient=6.0)
    judgement = judged(moved(law, 2))
    problem = judgement.problem
    assert isinstance(problem, RecordProblem)
    rests = problem.at_rest([moved(law, 6)])
    assert len(rests.response) > 20
    band = judgement.reading_band(rests)
    assert np.mean((band.low <= rests.response) & (rests.response <= band.high)) > 0.95
    # the applied force is all that acts, so that nothing but the level bounds it
    np.testing.assert_allclose(band.high, 8.0, rtol=0.15)
    np.testing.assert_allclose(band.low, -8.0, rtol=0.15)


def test_a_record_that_never_rests_has_no_rows_at_rest() -> None:
    problem = RecordProblem([driven()])
    judgement = Judgement(problem)
    assert judgement.reading_band(problem.at_rest([driven()])).low.shape == (0,)


# ---- drives and loads


def test_jumps_of_a_command_are_no_noise() -> None:
    command = np.repeat(np.random.default_rng(4).uniform(-12.0, 12.0, 120), 40)
    t = 1e-3 * np.arange(len(command))
    record = Record(time=t, position=np.sin(3.0 * t), force=command)
    assert Balance([record])._force_noise == 0.0
    noise = np.random.default_rng(5).normal(scale=0.3, size=len(t))
    noisy = replace(record, force=command + noise)
    # jumps are in three of forty differences
    assert Balance([noisy])._force_noise == pytest.approx(0.3, rel=0.15)


def test_a_part_of_the_level_that_no_load_changes_is_told() -> None:
    record = driven()
    load = 10.0 + 6.0 * np.sin(0.9 * record.time)
    loaded = replace(
        record,
        force=record.force + (0.4 * (load - 10.0)) * np.sign(np.gradient(record.position)),
        load=load,
    )
    problem = RecordProblem([loaded], normal=10.0)
    judgement = Judgement(problem)
    assert judgement.named.family == ("adhesion", "level", "viscous")
    # 8 N at 10 N, of which 4 N change with the load
    rows = problem.at(np.full(2, 0.05), load=np.array([5.0, 15.0]))
    expected = LEVEL + 0.4 * np.array([-5.0, 5.0]) + VISCOUS * 0.05
    assert judgement.acting(rows) == pytest.approx(expected, rel=0.02)
    band = judgement.band(rows)
    assert np.all((band.low - 0.02 < expected) & (expected < band.high + 0.02))


# ---- a sine of one frequency


@pytest.mark.slow
@pytest.mark.parametrize(("level", "viscous"), [(0.11, 0.26), (0.3, 0.1)])
def test_friction_takes_the_work_of_a_force_of_one_frequency(level: float, viscous: float) -> None:
    rng = np.random.default_rng(11)
    t = np.cumsum(rng.uniform(0.0014, 0.0023, 2400))
    t -= t[0]
    axis = Axis(inertia=0.0073, drive=Sine(amplitude=2.0, frequency=1.0))
    law = CoulombViscous(kinetic_coefficient=level, viscous_coefficient=viscous)
    x = np.round(simulate(axis, law, t_end=float(t[-1])).at(t)["x"] / 2.4e-5) * 2.4e-5
    force = 2.0 * np.sin(2.0 * np.pi * t)
    judgement = judged(Record(time=t, position=x, force=force))
    rows = judgement.problem.asked()
    v = rows.velocity
    true = level * np.sign(v) + viscous * v
    fast = np.abs(v) > 0.3 * np.max(np.abs(v))
    assert judgement.acting(rows)[fast] == pytest.approx(true[fast], rel=0.02)


# ---- delays, and bristles of any length


def stretched(x: Array, length: float, exponent: float) -> Array:
    """Return how far a bristle is stretched along a way (n,): |dz/dx| = (1 - z sgn dx)^n/length."""
    z, found = 0.0, np.zeros_like(x)
    for k, dx in enumerate(np.diff(x, prepend=x[0])):
        side, parts = math.copysign(1.0, dx), max(1, math.ceil(abs(dx) / (0.02 * length)))
        for _ in range(parts):
            z += dx / parts / length * max(1.0 - z * side, 0.0) ** exponent
            z = min(max(z, -1.0), 1.0)
        found[k] = z
    return found


def preslid(friction: Callable[[Array, Array], Array], seed: int = 1, **further: Any) -> Record:
    """Return the record of `driven` with friction (way, time) in place of its level."""
    plain = driven(level=0.0, noise=0.0)
    x, rng = plain.position, np.random.default_rng(seed)
    force = plain.force + friction(x, plain.time) + 0.02 * rng.normal(size=len(x))
    return replace(plain, position=x + 1e-6 * rng.normal(size=len(x)), force=force, **further)


def test_noise_of_the_force_is_no_delay() -> None:
    """The derivative of the recorded force has its noise, which makes every delay seem less."""
    columns = []
    for noise in (0.0, 100.0):
        record = driven(seconds=12.0)
        force = record.force + noise * 0.02 * np.random.default_rng(2).normal(size=4000 + 2000)
        balance = Balance([replace(record, force=force)], highest=20.0)
        columns.append(balance.delayed(MIDDLE, Memory()))
    quiet, noisy = columns
    assert noisy @ quiet / (noisy @ noisy) == pytest.approx(1.0, abs=0.02)
    assert noisy @ quiet / (quiet @ quiet) == pytest.approx(1.0, abs=0.02)


@pytest.mark.slow
def test_a_force_that_is_recorded_late_is_said_to_be_and_changes_no_inertia() -> None:
    record = driven(noise=3.0, seconds=12.0)
    late = replace(record, force=np.interp(record.time - 0.004, record.time, record.force))
    judgement = judged(late)
    inertia = next(one for one in judgement.intervals if one.path.endswith("inertia"))
    assert inertia.low < INERTIA < inertia.high
    delay = {one.term: one for one in judgement.findings}["delay"]
    assert delay.asserted
    assert delay.low < -0.004 < delay.high


@pytest.mark.slow
@pytest.mark.parametrize(("length", "exponent"), [(1e-3, 1.0), (1.3e-3, 2.0), (1.3e-3, 0.0)])
def test_the_length_of_a_bristle_is_found_between_those_of_the_grid(
    length: float, exponent: float
) -> None:
    record = preslid(lambda x, _: LEVEL * stretched(x, length, exponent))
    judgement = judged(record)
    problem = judgement.problem
    assert isinstance(problem, RecordProblem)
    memory = problem.model.memory(problem.posterior.best)
    assert memory.length == pytest.approx(length, rel=0.02)
    assert values(judgement)["kinetic_coefficient"] == pytest.approx(LEVEL, rel=0.005)


@pytest.mark.slow
def test_friction_of_two_memories_is_in_its_band() -> None:
    record = preslid(lambda x, _: 5.0 * stretched(x, 4e-4, 1.0) + 4.0 * stretched(x, 6e-3, 1.0))
    judgement = judged(record)
    rows = judgement.problem.at(np.array([-0.1, 0.05, 0.1]))
    band, v = judgement.band(rows), np.array([-0.1, 0.05, 0.1])
    true = 9.0 * np.sign(v) + VISCOUS * v
    assert np.all((band.low < true) & (true < band.high))


@pytest.mark.slow
def test_a_bristle_carries_the_load_of_the_moment() -> None:
    def loads(t: Array) -> Array:
        return 10.0 + 6.0 * np.sin(4.0 * t)

    record = preslid(lambda x, t: 0.8 * loads(t) * stretched(x, 1.5e-3, 1.0))
    problem = RecordProblem([replace(record, load=loads(record.time))], normal=10.0)
    judgement = Judgement(problem)
    assert judgement.named.family == ("level", "viscous")
    rows = problem.at(np.full(2, 0.05), load=np.array([5.0, 15.0]))
    expected = 0.8 * np.array([5.0, 15.0]) + VISCOUS * 0.05
    assert judgement.acting(rows) == pytest.approx(expected, rel=0.005)


# ---- a sensor of the force that clips


def clipped(share: float) -> Record:
    record = driven()
    most = share * float(np.max(np.abs(record.force)))
    return replace(record, force=np.clip(record.force, -most, most))


@pytest.mark.slow
def test_forces_that_a_sensor_clips_are_hidden_and_not_data() -> None:
    judgement = judged(clipped(0.6))
    assert judgement.named.family == ("level", "viscous")
    known = {one.path.rpartition(".")[2]: one for one in judgement.intervals}
    truth = {"inertia": INERTIA, "kinetic_coefficient": LEVEL, "viscous_coefficient": VISCOUS}
    for name, value in truth.items():
        assert known[name].low < value < known[name].high, name
    assert known["inertia"].high - known["inertia"].low < 0.04 * INERTIA
    clips = next(item for item in judgement.findings if item.term == "clipping")
    assert clips.probability > 0.99
    at = 0.6 * float(np.max(np.abs(driven().force)))
    assert f"no more than {quantity(at, 'N', 3)}, " in clips.sentence


@pytest.mark.slow
def test_limits_of_a_sensor_are_of_forces_that_are_clipped() -> None:
    record = driven()
    low, high = (share * float(np.max(np.abs(record.force))) for share in (0.5, 0.7))
    record = replace(record, force=np.clip(record.force, -high, low))
    judgement = judged(record, driven(seconds=3.0))  # none of the second
    (clips,) = [item for item in judgement.findings if item.term == "clipping"]
    assert f"no more than {quantity(low, 'N', 3)} to {quantity(high, 'N', 3)}," in clips.sentence
    share = float(np.mean((record.force == low) | (record.force == -high)))
    assert clips.size == pytest.approx(share, abs=0.02)


@pytest.mark.slow
def test_noise_of_a_record_is_that_of_forces_its_sensor_shows() -> None:
    free = driven(seconds=3.0)
    most = 0.4 * float(np.max(np.abs(free.force)))
    clips = replace(free, force=np.clip(free.force, -most, most))
    model = RecordProblem([clips, free]).model
    rows = model.balance.rows(MIDDLE)
    left = np.where(rows.hidden < 0.5, 1.0, math.nan)
    assert np.mean(np.isnan(left[rows.piece == 0])) > 0.2
    first, second = model._noise(MIDDLE, left, None).pieces
    assert first == pytest.approx(second)


def pushed(force: Array) -> Record:
    """Return a record at 500 Hz of an axis that a force pushes: it holds, or friction brakes it."""
    x, v = np.zeros_like(force), 0.0
    for k in range(1, len(force)):
        for _ in range(50):  # steps for each sample
            free = v + 4e-5 * (force[k - 1] - VISCOUS * v) / INERTIA
            v = math.copysign(max(abs(free) - 4e-5 * LEVEL / INERTIA, 0.0), free)
            x[k] += 4e-5 * v
        x[k] += x[k - 1]
    noise = 1e-6 * np.random.default_rng(2).normal(size=len(x))
    return Record(time=0.002 * np.arange(len(x)), position=x + noise, force=force)


@pytest.mark.slow
def test_a_command_that_is_limited_before_it_is_recorded_is_no_sensor_that_clips() -> None:
    t = np.arange(0.0, 8.0, 0.002)
    force = 30.0 * np.sin(2.0 * math.pi * 0.7 * t) + 15.0 * np.sin(2.0 * math.pi * 1.9 * t + 1.0)
    judgement = judged(pushed(np.clip(force, -20.0, 20.0)))
    assert not [item for item in judgement.findings if item.term == "clipping"]
    inertia = next(one for one in judgement.intervals if one.path.endswith("inertia"))
    assert inertia.low < INERTIA < inertia.high


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_a_force_that_only_changes_its_sign_is_no_sensor_that_clips(noise: float) -> None:
    rng = np.random.default_rng(2)
    turns = np.cumsum(rng.uniform(0.15, 0.85, size=20))
    t = np.arange(0.0, 8.0, 0.002)
    force = np.where(np.searchsorted(turns, t) % 2 == 0, 20.0, -20.0)
    record = pushed(force)
    problem = RecordProblem([replace(record, force=force + noise * rng.normal(size=len(t)))])
    assert problem.model.balance._plainly(Memory(length=0.0))[0] == pytest.approx(INERTIA, rel=0.1)
    judgement = Judgement(problem)
    known = {one.path.rpartition(".")[2]: one for one in judgement.intervals}
    for name, value in {"inertia": INERTIA, "kinetic_coefficient": LEVEL}.items():
        assert known[name].value == pytest.approx(value, rel=0.1)
        assert known[name].low < value < known[name].high
    assert not [item for item in judgement.findings if item.asserted]
