"""Records of one coordinate by the posterior: rows, memory, laws, inertia, readings."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import nnls

from stickslip import Axis, Measurement, fit, select
from stickslip.errors import InputError
from stickslip.identify.forces import Unknown
from stickslip.identify.judgement import Judgement
from stickslip.identify.posterior import Column, Model, Node, Posterior, Scale, System
from stickslip.identify.problems.record_columns import OTHERS, Balance, Memory, relaxed
from stickslip.identify.problems.record_rows import continued, cutoff_of
from stickslip.identify.problems.record_signals import Record, bristle
from stickslip.identify.problems.records import RecordProblem

INERTIA, LEVEL, VISCOUS = 5.0, 8.0, 20.0


def driven(
    seed: int = 1, *, duration: float = 10.0, level: float = LEVEL, inertia: float = INERTIA
) -> Record:
    """Return a record at 500 Hz of an axis with level and viscous friction."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, duration, 0.002)
    x, v, a = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    for size, f in zip((0.04, 0.012, 0.003), (0.35, 1.3, 3.1), strict=True):
        w, phase = 2.0 * math.pi * f, rng.uniform(0.0, 6.0)
        x += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w * w * np.sin(w * t + phase)
    force = inertia * a + level * np.sign(v) + VISCOUS * v
    return Record(
        time=t,
        position=x + 1e-6 * rng.normal(size=len(t)),
        force=force + 0.02 * level * rng.normal(size=len(t)),
    )


@functools.cache
def judged() -> Judgement:
    return Judgement(RecordProblem([driven()]))


def test_a_counter_that_is_reset_goes_on() -> None:
    x = np.cumsum(np.full(200, 0.01))
    np.testing.assert_allclose(continued(np.mod(x, 0.5)), x, atol=1e-12)


def test_a_level_lags_along_the_way_as_in_a_first_order_equation() -> None:
    way = np.linspace(0.0, 3.0, 400)
    level = relaxed(way, 0.5, np.full((400, 1), 2.0))[:, 0]
    np.testing.assert_allclose(level, 2.0 * (1.0 - np.exp(-way / 0.5)), rtol=1e-12, atol=1e-14)


def test_a_level_stays_at_rest_and_turns_with_the_way() -> None:
    way = np.array([0.0, 50.0, 50.0, 0.0])
    level = relaxed(way, 1.0, np.ones((4, 1)))[:, 0]
    np.testing.assert_allclose(level, [0.0, 1.0, 1.0, -1.0], atol=1e-12)


def test_the_cutoff_is_above_the_frequency_of_the_motion() -> None:
    t = np.arange(0.0, 10.0, 0.002)
    fast = Record(time=t, position=0.01 * np.sin(2.0 * math.pi * 8.0 * t), force=np.cos(50.0 * t))
    assert cutoff_of(fast) > 5.0 * 8.0


def test_level_viscous_friction_and_inertia_of_an_axis_are_in_their_intervals() -> None:
    judgement = judged()
    assert judgement.named.family == ("level", "viscous")
    found = {one.path: one for one in judgement.intervals}
    level = found["friction.kinetic_coefficient"]
    viscous = found["friction.viscous_coefficient"]
    # intervals of 95 %: twice their half width leaves room for the one seed
    for one, true in ((level, LEVEL), (viscous, VISCOUS)):
        assert abs(one.value - true) < 2.0 * (one.high - one.low)
        assert one.high - one.low < 0.05 * true
    problem = judgement.problem
    assert isinstance(problem, RecordProblem)
    low, high = np.quantile(problem.rig(judgement.draws)["inertia"], (0.005, 0.995))
    assert low < INERTIA < high
    assert judgement.is_told


@pytest.mark.parametrize("place", [True, False])
def test_speeds_at_which_an_encoder_steps_too_seldom_are_not_resolved(place: bool) -> None:
    rate, step = 100.0, 0.004  # .4 rad/s for one step from sample to sample
    t = np.arange(0.0, 60.0, 1.0 / rate)
    v = 2.0 ** np.interp(t % 15.0, [0.0, 7.5, 15.0], [-7.0, 1.5, -7.0])
    x = np.round(np.cumsum(np.where(t % 30.0 < 15.0, v, -v)) / rate / step) * step
    speed = None if place else np.append(np.diff(x), 0.0) * rate
    record = Record(
        time=t, position=x, velocity=speed, force=np.sign(np.gradient(x)), located=place
    )
    balance = Balance([record])
    (piece,) = balance.pieces
    # three steps within the filter of the velocity, whose cutoff is twice that of the rows
    assert piece.resolution == pytest.approx(6.0 * step * piece.cutoff, rel=1e-6)
    assert balance.frame.low >= piece.resolution > 0.05
    noise = step * np.random.default_rng(1).normal(size=len(t))
    read = np.round((x + noise) / step) * step
    finer = Balance([replace(record, position=read, velocity=None, located=True)])
    assert finer.pieces[0].resolution == 0.0


@pytest.mark.slow
def test_an_inertia_that_the_motion_does_not_show_is_at_most_so_much_and_never_below_zero() -> None:
    for seed in (1, 2, 3):  # errors of the balance have either sign
        seen = driven(seed, duration=6.0, inertia=0.002)
        record = Measurement(time=seen.time, position=seen.position, force=seen.force)
        vary = ["friction.*", "mechanism.inertia"]
        found = fit(Axis(inertia=1.0), "coulomb-viscous", record, vary=vary)
        inertia = found.estimate("mechanism.inertia")
        assert inertia.value >= 0.0
        assert inertia.range.startswith("at most")
        assert 0.002 < inertia.high < 0.1
        assert inertia.reason == "not identified: it may be as small as 0 kg"


def test_readings_of_another_run_with_a_level_of_its_own_are_in_their_band() -> None:
    judgement = judged()
    problem = judgement.problem
    assert isinstance(problem, RecordProblem)
    other = problem.like([driven(seed=2, duration=6.0, level=1.03 * LEVEL)])
    band = judgement.reading_band(other)
    inside = np.mean((band.low <= other.response) & (other.response <= band.high))
    assert inside > 0.9


def test_friction_is_not_told_where_force_and_motion_are_noise() -> None:
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 8.0, 0.004)
    x = 1e-5 * np.sin(6.0 * t) + 1e-6 * rng.normal(size=len(t))
    noise = Record(time=t, position=x, force=rng.normal(size=len(t)))
    with pytest.raises(InputError, match="moves by no more than the noise"):
        Judgement(RecordProblem([noise]))


def test_in_one_direction_a_level_is_no_offset() -> None:
    rng = np.random.default_rng(4)
    t = np.arange(0.0, 12.0, 0.004)
    v = 0.05 + 0.03 * np.sin(2.5 * t) + 0.01 * np.sin(9.0 * t)
    x = 0.004 * np.cumsum(v)
    force = 2.0 * np.gradient(v, t) + 4.0 + 20.0 * v + 0.02 * rng.normal(size=len(t))
    one_way = Record(time=t, position=x + 1e-6 * rng.normal(size=len(t)), force=force)
    problem = RecordProblem([one_way])
    judgement = Judgement(problem)
    assert problem.model.frame.sides == (1.0,)
    assert judgement.named.family == ("level", "viscous")
    values = {one.path: one.value for one in judgement.intervals}
    assert values["friction.kinetic_coefficient"] == pytest.approx(4.0, rel=0.02)


def test_a_bristle_without_length_has_the_direction() -> None:
    problem = judged().problem
    assert isinstance(problem, RecordProblem)
    balance = problem.model.balance
    for state, piece in zip(balance.states(Memory()), balance.pieces, strict=True):
        assert np.array_equal(state, piece.direction)


class Two(Model):
    """A level measured twice, as two cutoffs do: the second time with less noise."""

    scales = (
        Scale(name="size", values=(0.1, 1.0), prior=(0.5, 0.5)),
        Scale(name="cutoff", values=(1.0, 2.0), prior=(0.25, 0.75), ordered=False, judged=False),
    )

    def system(self, node: Node, columns: object) -> System:
        x = np.ones((40, 1))
        y = (3.0 + np.sin(np.arange(40.0)))[:, None]
        every = np.hstack([x, x, y]) * (1.0, 30.0)[node[1]]
        size = np.array([self.scales[0].values[node[0]]])
        return System(gram=every.T @ every, deviations=size, volume=0.0, sizes=np.ones(1))


def test_sums_of_further_bristles_follow_a_surface_that_yields_as_none_of_them() -> None:
    t = np.linspace(0.0, 20.0, 4001)
    waves = ((2.0, 0.2, 0.0), (1.0, 0.6, 1.0), (0.6, 1.5, 2.0))
    way = sum(a * np.sin(2.0 * math.pi * f * t + p) for a, f, p in waves)
    length, parts = 0.4, 20
    state = np.zeros(len(way))  # of Bouc and Wen
    for k, step in enumerate(np.diff(way)):
        z = state[k]
        for _ in range(parts):
            towards = math.copysign(1.0, step * z)
            z += step / parts / length * (1.0 - abs(z) ** 1.6 * (0.45 + 0.55 * towards))
        state[k + 1] = z
    x = np.column_stack([bristle(way, length * k, n) for k in OTHERS for n in (0.0, 1.0)])[500:]
    left = state[500:] - x @ np.linalg.lstsq(x, state[500:], rcond=1e-9)[0]
    assert np.sqrt(np.mean(left**2)) < 0.016  # .021 with lengths 2.5 times as long as the next


def test_a_scale_that_is_not_judged_keeps_its_prior() -> None:
    law: tuple[Column, ...] = (("level", ()),)
    model = Two()
    posterior = Posterior(model, [law], np.zeros(1), begin=[(0, 0), (0, 1)], most=10)
    np.testing.assert_allclose(posterior.scale("cutoff"), (0.25, 0.75), rtol=1e-9)


class Opposed(Model):
    """Two columns that are nearly the same, of which the first would be below 0."""

    scales = (Scale(name="size", values=(1e-3,), prior=(1.0,)),)

    def system(self, node: Node, columns: object) -> System:
        t = np.linspace(-1.0, 1.0, 50)
        x = np.column_stack([0.0 * t, 1.0 + 0.01 * t, np.ones(50), 1.0 - 0.05 * t])
        x *= 300.0
        return System(gram=x.T @ x, deviations=np.ones(1), volume=0.0, sizes=np.ones(2))


def test_where_a_coefficient_is_bounded_the_others_follow() -> None:
    law: tuple[Column, ...] = (("level", ()), ("viscous", ()))
    posterior = Posterior(Opposed(), [law], np.zeros(1), begin=[(0,)], most=1)
    (draws,) = posterior.draws(50)
    assert np.all(draws.law >= 0.0)
    # the sum stays what was measured, 1, whatever is at its bound
    np.testing.assert_allclose(draws.law.sum(axis=0), 1.0, atol=0.02)


@pytest.mark.slow
def test_a_pressure_that_pushes_is_no_friction():
    """A constant force follows the pressure, as on a rod, and the level does as well."""
    random, trials = np.random.default_rng(4), []
    t = np.arange(0.0, 12.0, 0.004)
    for pressure in (1.0, 3.0, 5.0, 7.0):
        v = 0.03 * np.cos(1.3 * t + pressure)
        x = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
        level, push = 3.4 + 0.65 * pressure, 0.4 * pressure
        read = level * np.sign(v) + push + 0.1 * random.normal(size=len(t))
        trials.append(
            Measurement(time=t, position=x, friction=read, inputs={"pressure": 0.0 * t + pressure})
        )
    verdict = select(Axis(inertia=1.0), None, Measurement(trials=tuple(trials)))
    at = 0.02 * np.array([-1.0, 1.0])
    for pressure in (1.0, 7.0):
        rows = verdict.judgement.problem.at(at, inputs={"pressure": pressure})
        curves = verdict.judgement.curves(rows)
        low, high = np.quantile(0.5 * (curves[:, 1] - curves[:, 0]), (0.025, 0.975))
        assert low <= 3.4 + 0.65 * pressure <= high
        assert high - low < 0.5 * (3.4 + 0.65 * pressure)
    said = [one.sentence for one in verdict.findings if one.asserted]
    assert any(x.startswith("A force other than friction changes by") for x in said)


class Crossed(Model):
    """A parabola of which three columns, one of them negative, say more than any that are not.

    The columns are 1, t and t + t^2, and what is measured is 1 + 1.5 t - (t + t^2).
    """

    scales = (Scale(name="size", values=(1e-3,), prior=(1.0,)),)

    def system(self, node: Node, columns: object) -> System:
        t = np.linspace(0.0, 1.0, 60)
        x = np.column_stack([0.0 * t, np.ones(60), t, t + t * t, 1.0 + 0.5 * t - t * t])
        x *= 200.0
        return System(gram=x.T @ x, deviations=np.ones(1), volume=0.0, sizes=np.ones(3))


def test_draws_at_several_bounds_are_those_that_fit_best() -> None:
    law: tuple[Column, ...] = (("level", ()), ("stribeck", ()), ("viscous", ()))
    posterior = Posterior(Crossed(), [law], np.zeros(1), begin=[(0,)], most=1)
    (draws,) = posterior.draws(40)
    t = np.linspace(0.0, 1.0, 60)
    x, y = np.column_stack([np.ones(60), t, t + t * t]), 1.0 + 0.5 * t - t * t
    expected = nnls(x, y)[0]
    assert np.sum(expected > 0.0) == 1  # two of them are at their bounds
    np.testing.assert_allclose(draws.law, np.tile(expected[:, None], 40), atol=0.02)


def test_a_law_that_fits_with_a_negative_coefficient_alone_has_no_weight() -> None:
    plain: tuple[Column, ...] = (("level", ()),)
    three: tuple[Column, ...] = (*plain, ("stribeck", ()), ("viscous", ()))
    posterior = Posterior(Crossed(), [plain, three], np.zeros(2), begin=[(0,)], most=1)
    assert posterior.shares[0] > 0.5


def unsteady(seed: int, begin: float) -> Record:
    """Return a record beside which a force acts that is no friction and of no place."""
    record = driven(seed, duration=8.0)
    t = record.time
    force = 0.5 * LEVEL * np.sin(2.0 * math.pi * t / 6.0 + 1.7 * seed)
    return replace(record, time=t + begin, force=record.force + force)


@pytest.mark.slow
@pytest.mark.parametrize("begin", [0.0, 8.0])
def test_another_record_has_another_course_of_a_force_in_time(begin: float) -> None:
    problem = RecordProblem([unsteady(1, 0.0)])
    rows = problem.like([unsteady(2, begin)])
    band = Judgement(problem).reading_band(rows)
    inside = np.mean((band.low <= rows.response) & (rows.response <= band.high))
    assert inside > 0.9
    assert np.median(band.high - band.low) / 2.0 < 5.0 * 0.5 * LEVEL  # .5 and .95 of four times


@pytest.mark.slow
def test_a_bristle_of_another_exponent_is_found_with_the_inertia() -> None:
    record, length = driven(3), 0.006
    t, x = record.time, record.position
    v = np.gradient(x, t)
    sliding = record.force - LEVEL * np.sign(v)
    force = sliding + LEVEL * bristle(x, length, 2.0)
    problem = RecordProblem([replace(record, force=force)])
    model = problem.model
    best = model.memories[int(np.argmax(problem.posterior.scale("bristle")))]
    assert best.exponent == 2.0
    assert best.length == pytest.approx(length, rel=0.2)
    judgement = Judgement(problem)
    (inertia,) = (one for one in judgement.intervals if one.path == "inertia")
    assert inertia.value == pytest.approx(INERTIA, rel=0.01)


def test_a_level_with_a_part_that_no_load_changes_is_in_its_band() -> None:
    record = driven(5)
    load = 1.0 + 0.5 * np.sin(2.0 * math.pi * record.time / 2.3)
    own = LEVEL * (0.4 + 0.6 * load - 1.0) * np.sign(np.gradient(record.position))
    problem = RecordProblem([replace(record, force=record.force + own, load=load)])
    judgement = Judgement(problem)
    rows = problem.at(np.array([0.05, 0.05, 0.05]), load=np.array([0.6, 1.0, 1.4]))
    band, v = judgement.band(rows), 0.05
    true = LEVEL * (0.4 + 0.6 * rows.load) + VISCOUS * v
    assert np.all((band.low <= true) & (true <= band.high))
    assert np.max(band.high - band.low) < 0.1 * LEVEL


def test_a_course_as_large_as_friction_does_not_go_on() -> None:
    record = driven(4, duration=8.0)
    course = 0.8 * LEVEL * (record.time / 8.0 - 0.5) * np.sign(np.gradient(record.position))
    problem = RecordProblem([replace(record, force=record.force - course)])
    rest = driven(5, duration=6.0)  # whose level is that in the mean
    rows = problem.like([replace(rest, time=rest.time + 8.0)])
    band = Judgement(problem).reading_band(rows)
    assert np.sqrt(np.mean((rows.response - band.median) ** 2)) < 0.1 * LEVEL


def test_a_record_without_what_was_estimated_has_readings() -> None:
    record = driven()
    column = LEVEL * np.cos(1.7 * record.time)
    unknown = {"links.0": Unknown(force=column, inertia=0.0, doubt=1.0)}
    problem = RecordProblem([replace(record, unknown=unknown)])
    rows = problem.like([driven(2)])
    band = Judgement(problem).reading_band(rows)
    assert np.mean((band.low <= rows.response) & (rows.response <= band.high)) > 0.9
