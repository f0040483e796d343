"""Records of one coordinate as a problem of the judge: truths in closed form, and invariances."""

import functools

import numpy as np
import pytest

from stickslip import Axis, Measurement, Pendulum
from stickslip.errors import InputError
from stickslip.identify.comparison import Comparison, compare
from stickslip.identify.ensemble import Ensemble
from stickslip.identify.forces import forces_along
from stickslip.identify.judge import Judgement
from stickslip.identify.posterior import family_of
from stickslip.identify.problems.record_signals import (
    Filter,
    Record,
    bristle,
    coasting,
    followed,
    noise_of,
    records_of,
)
from stickslip.identify.problems.records import RecordsProblem, unseen_length
from stickslip.identify.regression import same_span
from stickslip.identify.search import Search

LEVEL, VISCOUS, INERTIA = 1.0, 0.3, 0.02


def axis(seed=0, *, seconds=8.0, scale=1.0, mirrored=False, later=0.0, spring=0.0, memory=0.0):
    """Return a record of an axis whose motion is known in closed form: a sum of sines."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 0.002)
    x, v, a = np.zeros((3, len(t)))
    for f in (0.31, 0.73, 1.1):
        w, phase, size = 2.0 * np.pi * f, random.uniform(0.0, 6.0), random.uniform(0.2, 0.5)
        x += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w**2 * np.sin(w * t + phase)
    z = bristle(x, memory, 1.0) if memory else np.sign(v)
    force = INERTIA * a + LEVEL * z + VISCOUS * v + spring * x
    force = force + 0.02 * random.normal(size=len(t))
    x = x + 3e-5 * random.normal(size=len(t))
    side = -1.0 if mirrored else 1.0
    return Record(time=t + later, position=side * scale * x, force=side * force / scale)


@functools.cache
def judged(**options) -> tuple[RecordsProblem, Search, Comparison, Ensemble]:
    problem = RecordsProblem([axis(**options)])
    search = Search(problem).run()
    comparison = compare(search)
    return problem, search, comparison, Ensemble(search.regression, comparison)


def coefficients(problem, search, structure):
    fit, found = search.regression.fit(structure), {}
    for (name, _), value in zip(structure, fit.coefficients, strict=True):
        found[name] = value
    return found


def test_inertia_level_and_viscosity_are_those_of_the_axis():
    problem, search, comparison, _ = judged()
    assert problem.family(comparison.named) == ("inertia", "level", "viscous")
    found = coefficients(problem, search, comparison.named)
    # noise of .02 N over 4000 samples; the filter leaves some 800 independent rows
    assert found["inertia"] == pytest.approx(INERTIA, rel=0.02)
    assert found["level"] == pytest.approx(LEVEL, rel=0.01)
    assert found["viscous"] == pytest.approx(VISCOUS, rel=0.02)


def test_the_band_holds_the_steady_curve():
    problem, _, _, ensemble = judged()
    v = np.concatenate([-np.geomspace(0.1, 3.0, 9)[::-1], np.geomspace(0.1, 3.0, 9)])
    band = ensemble.band(problem.at(v), all_along=True)
    true = LEVEL * np.sign(v) + VISCOUS * v
    assert np.all((band.low <= true) & (true <= band.high))
    assert np.median(band.high - band.low) < 0.2 * LEVEL


def test_the_band_holds_readings_of_a_second_record():
    problem, search, comparison, ensemble = judged()
    judgement = Judgement(problem, search.regression, comparison, ensemble)
    other = problem.of([axis(seed=1)])
    for level, within in ((0.95, 0.05), (0.8, 0.1), (0.5, 0.12)):  # of some 300 rows that are alike
        band = judgement.reading_band(other.rows, level)
        inside = np.mean((band.low <= other.response) & (other.response <= band.high))
        assert inside == pytest.approx(level, abs=within)


def test_a_memory_is_named_with_its_length():
    problem, _, comparison, _ = judged(memory=0.02)
    assert "memory" in problem.family(comparison.named)
    length, exponent = dict(comparison.named)["level"][:2]
    assert length == pytest.approx(0.02, rel=0.1)
    assert exponent == 1.0


def test_a_spring_is_found_by_its_stiffness():
    problem, search, comparison, _ = judged(spring=0.4)
    found = coefficients(problem, search, comparison.named)
    # the force of a spring and that of the inertia are alike in a motion of few waves
    assert found["spring"] == pytest.approx(0.4, rel=0.1)


def test_a_mirrored_record_has_the_same_law():
    _, one, first, _ = judged()
    _, two, second, _ = judged(mirrored=True)
    assert first.named == second.named
    values = [x.regression.fit(c.named).coefficients for x, c in ((one, first), (two, second))]
    np.testing.assert_allclose(*values, rtol=1e-6)


def test_the_time_of_the_first_sample_changes_nothing():
    _, one, first, _ = judged()
    _, two, second, _ = judged(later=1e4)
    assert problem_names(first) == problem_names(second)
    values = [x.regression.fit(c.named).coefficients for x, c in ((one, first), (two, second))]
    np.testing.assert_allclose(*values, rtol=1e-5)


def test_other_units_scale_the_coefficients():
    # lengths in millimetres keep power: forces are thousandths, and so the inertia is a millionth
    _, one, first, _ = judged()
    _, two, second, _ = judged(scale=1e3)
    assert problem_names(first) == problem_names(second)
    inertia, level, viscous = one.regression.fit(first.named).coefficients
    found = two.regression.fit(second.named).coefficients
    np.testing.assert_allclose(found, [inertia * 1e-6, level * 1e-3, viscous * 1e-6], rtol=1e-6)


def problem_names(comparison):
    return [name for name, _ in comparison.named]


def test_slow_sampling_of_a_coast_down_finds_level_and_drag():
    t = np.arange(0.0, 330.0)
    mass, level, drag = 76.0, 1.2, 0.03
    # m v' = -F - c v^2 has the solution v = sqrt(F / c) tan(phi - sqrt(F c) t / m)
    ratio = np.sqrt(level / drag)
    v = ratio * np.tan(np.arctan(8.0 / ratio) - np.sqrt(level * drag) * t / mass)
    v = v + 0.02 * np.random.default_rng(4).normal(size=len(t))
    records = records_of(Axis(inertia=mass), Measurement(time=t, velocity=v))
    problem = RecordsProblem(records)
    search = Search(problem).run()
    comparison = compare(search)
    found = coefficients(problem, search, comparison.named)
    assert set(found) == {"level", "drag"}
    assert found["level"] == pytest.approx(level, rel=0.1)
    assert found["drag"] == pytest.approx(drag, rel=0.1)


def test_weight_of_a_pendulum_is_no_friction():
    arm = Pendulum(mass=0.2, length=0.5)
    t = np.arange(0.0, 4.0, 0.01)
    still = Measurement(time=t, position=0.5 + 0.3 * np.sin(t), force=0.0 * t + 1.0)
    (record,) = records_of(arm, still)
    np.testing.assert_allclose(record.mechanism, -0.2 * 9.81 * 0.5 * np.sin(record.position))
    assert record.inertia == pytest.approx(0.2 * 0.5**2)


def test_gain_of_the_force_and_inertia_are_one_group_where_the_inertia_is_given():
    axis_ = axis()
    problem = RecordsProblem([axis_.__class__(**{**axis_.__dict__, "inertia": INERTIA})])
    search = Search(problem).run()
    comparison = compare(search)
    assert set(problem_names(comparison)) == {"level", "viscous"}


def sines(seed: int, *, inertia: float = INERTIA, relaxation: float = 1.0):
    """Return times, positions, forces of a plain axis, and the stretch of a relaxing spring."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, 8.0, 0.002)
    x, v, a, hose = np.zeros((4, len(t)))
    for f in (0.31, 0.73, 1.1):
        w, phase, size = 2.0 * np.pi * f, random.uniform(0.0, 6.0), random.uniform(0.2, 0.5)
        x += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w**2 * np.sin(w * t + phase)
        late, gain = np.arctan(w * relaxation), w * relaxation / np.hypot(1.0, w * relaxation)
        hose += size * gain * np.cos(w * t + phase - late)
    hose -= hose[0] * np.exp(-t / relaxation)
    force = inertia * a + LEVEL * np.sign(v) + VISCOUS * v
    return t, x + 3e-5 * random.normal(size=len(t)), force, hose


def noisy(force, seed=5):
    return force + 0.02 * np.random.default_rng(seed).normal(size=len(force))


def test_a_dead_zone_is_told_from_a_level_only_where_the_inertia_turns_the_force():
    t, x, force, _ = sines(1)
    problem = RecordsProblem([Record(time=t, position=x, force=noisy(force))])
    assert problem.instead["level"] == "dead zone of the driver"
    t, x, force, _ = sines(1, inertia=0.15)
    command = force + 0.3 * np.sign(force)
    judgement = Judgement.of(RecordsProblem([Record(time=t, position=x, force=noisy(command))]))
    assert family_of(judgement.named) == ("dead_zone", "inertia", "level", "viscous")
    shape = dict(judgement.named)["dead_zone"]
    assert shape[0] == pytest.approx(0.3, rel=0.2)


def test_gain_of_the_force_scale_of_the_position_and_inertia_are_one_group():
    t, x, force, _ = sines(2)
    record = Record(time=t, position=x, force=noisy(1.3 * force), inertia=INERTIA)
    (cause,) = Judgement.of(RecordsProblem([record])).causes
    assert cause.term == "inertia_error"
    assert {*cause.instead} == {"force_gain", "position_scale"}
    assert cause.needed


def test_a_relaxing_spring_stands_alone_though_its_time_is_between_those_tried_first():
    relaxation = 0.4
    t, x, force, hose = sines(3, relaxation=relaxation)
    judgement = Judgement.of(
        RecordsProblem([Record(time=t, position=x, force=noisy(force + 2.0 * hose))])
    )
    assert family_of(judgement.named) == ("hose", "inertia", "level", "viscous")
    assert dict(judgement.named)["hose"][0] == pytest.approx(relaxation, rel=0.05)
    (cause,) = judgement.causes
    assert cause.asserted
    steady = judgement.problem.asked()
    band = judgement.ensemble.band(steady)
    # curves beside it have its time constant, too: else they are no friction of this axis
    assert np.median(band.high - band.low) < 0.2 * LEVEL


def test_a_gear_takes_another_share_where_it_is_driven():
    t, x, _, _ = sines(4)
    v, torque = np.gradient(x, t), 20.0 * np.sin(1.7 * t)
    friction = 0.12 * np.abs(torque) * np.sign(v) + 0.04 * torque + 0.8 * v
    record = Record(
        time=t, position=x, force=noisy(friction), friction=True, transmitted=torque,
        inputs={"transmitted": np.abs(torque)},
    )  # fmt: skip
    judgement = Judgement.of(RecordsProblem([record]))
    found = coefficients(judgement.problem, judgement, judgement.named)
    assert found["gear"] == pytest.approx(0.12, rel=0.05)
    assert found["gear_direction"] == pytest.approx(0.04, rel=0.1)


def test_how_long_a_bristle_may_be_is_said_of_laws_without_one():
    t, x, force, _ = sines(6)
    slow = slice(None, None, 10)  # sampled so slowly that a turn is over between two rows
    loud = force + 0.5 * np.random.default_rng(6).normal(size=len(t))
    record = Record(time=t[slow], position=x[slow], force=loud[slow])
    regression = Search(RecordsProblem([record])).run().regression
    plain = (("inertia", ()), ("level", (0.0, 0.0)), ("viscous", ()))
    longest = unseen_length(regression, plain)
    assert 1e-4 < longest < 0.1
    _, search, comparison, _ = judged(memory=0.03)
    assert unseen_length(search.regression, comparison.named) == 0.0


def test_forces_beside_a_large_inertia_are_no_rounding():
    record = Measurement(time=[0.0, 1.0], position=[0.0, 0.5], force=[0.0, 2.0])
    x, v = np.array([0.0, 0.5]), np.array([0.5, 0.5])
    heavy = Axis(inertia=1e7, stiffness=4.0, damping=1.0)
    found = forces_along(heavy, record, x, v, ["mechanism.damping"])
    np.testing.assert_allclose(found.still, -4.0 * x)


def test_terms_with_the_same_columns_are_named_together():
    t = np.arange(0.0, 10.0, 0.005)
    v = 0.5 + 0.0 * t + 0.2 * np.sin(2.0 * t)  # never turns: the level is an offset
    x = 0.5 * t - 0.1 * np.cos(2.0 * t)
    force = 1.0 + 0.3 * v + 0.01 * np.random.default_rng(0).normal(size=len(t))
    problem = RecordsProblem([Record(time=t, position=x, force=force, friction=True)])
    search = Search(problem).run()
    found = same_span(search.regression, (("level", (0.0, 0.0)), ("viscous", ())))
    assert "offset" in [name for name, _ in found.instead["level"]]
    assert "viscous_direction" in [name for name, _ in found.instead["viscous"]]


def test_the_filter_passes_slow_waves_and_their_slopes():
    h, n = 0.001, 6000
    low = Filter(count=n, step=h, band=20.0, every=8)
    t = h * np.arange(n)
    middle = slice(100, -100)
    rows = t[:: low.every]
    np.testing.assert_allclose(low(np.sin(6.0 * t))[middle], np.sin(6.0 * rows)[middle], atol=1e-6)
    np.testing.assert_allclose(
        low(np.sin(6.0 * t), slope=2)[middle], -36.0 * np.sin(6.0 * rows)[middle], atol=1e-3
    )
    late = low(np.sin(6.0 * t), late=0.003)[middle]
    np.testing.assert_allclose(late, np.sin(6.0 * (rows - 0.003))[middle], atol=1e-6)
    assert np.abs(low(np.sin(600.0 * t))[middle]).max() < 1e-4


def test_a_bristle_of_each_exponent_follows_its_equation():
    path = np.concatenate([np.linspace(0.0, 1.0, 4001), np.linspace(1.0, 0.5, 2001)])
    for exponent in (0.0, 1.0, 2.0):
        z, length = 0.0, 0.3
        for step in np.diff(path):  # du/d|x| = -u^n / r by small steps
            side = np.sign(step)
            left = 1.0 - side * z
            z += step / length * left**exponent if left > 0.0 else 0.0
        assert bristle(path, length, exponent)[-1] == pytest.approx(z, abs=2e-3)


def test_a_load_in_a_gap_moves_on_until_it_is_pushed():
    x = np.concatenate([np.linspace(0.0, 1.0, 101), np.full(100, 1.0)])
    v = np.gradient(x, 0.01)
    load = coasting(x, v, 0.05, 0.01)
    assert load[-1] == pytest.approx(1.05)  # it stops at the far side
    np.testing.assert_allclose(followed(x, 0.05)[100], 0.95)


def test_noise_is_that_of_the_quiet_parts_or_the_step_of_the_encoder():
    random = np.random.default_rng(0)
    x = np.sin(0.002 * np.arange(5000.0))
    assert noise_of(x + 1e-4 * random.normal(size=5000)) == pytest.approx(1e-4, rel=0.2)
    assert noise_of(np.round(x, 2)) == pytest.approx(0.01 / np.sqrt(12.0), rel=0.01)


@pytest.mark.parametrize(
    ("measurement", "find", "said"),
    [
        (Measurement(time=np.arange(100.0), force=np.ones(100)), False, "position"),
        (Measurement(velocity=np.ones(50), friction=np.ones(50)), False, "in time"),
        (
            Measurement(time=np.arange(20.0), position=np.arange(20.0), force=np.ones(20)),
            False,
            "at least 60 samples",
        ),
        (Measurement(time=np.arange(100.0), position=np.arange(100.0)), True, "inertia"),
        (
            Measurement(
                time=np.arange(100.0), position=np.arange(100.0), friction=np.ones(100), load=0.0
            ),
            False,
            "above 0 N, got 0",
        ),
    ],
)
def test_bad_records_are_refused_with_their_cure(measurement, find, said):
    with pytest.raises(InputError, match=said):
        records_of(Axis(inertia=1.0), measurement, unknown=["mechanism.inertia"] * find)
