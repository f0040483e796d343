"""What a verdict hands over slides as its structure says, in both directions, beside the offset."""

import functools
from dataclasses import replace

import numpy as np
import pytest
from tests.support import acting

from stickslip import Axis, Measurement, SpringBlock, load_rig, select, simulate
from stickslip.friction import bound
from stickslip.identify.judgement import Judgement
from stickslip.identify.laws import compose
from stickslip.identify.problems.record_signals import Record
from stickslip.identify.problems.records import RecordProblem
from stickslip.identify.problems.tables import TableProblem
from stickslip.identify.projection import is_signed, names_of

SPEEDS = np.geomspace(0.01, 1.0, 12)
BOTH = np.concatenate([-SPEEDS[::-1], SPEEDS])
FINE = np.geomspace(0.01, 1.0, 61)
AXIS = Axis(inertia=1.0)


def mixed(**columns):
    """Return a table of both directions in random order, so that a drift could be told."""
    random = np.random.default_rng(5)
    v = np.tile(BOTH, 3)[random.permutation(3 * len(BOTH))]
    heat = random.uniform(10.0, 40.0, len(v))
    read = 5.0 * np.sign(v) + v + 0.01 * random.normal(size=len(v))
    given = {name: of(v) for name, of in columns.items()}
    return Measurement(velocity=v, friction=read, inputs={"temperature": heat}, **given)


def recorded(*, friction=True, **more):
    """Return a record of a sum of sines, with inputs and a load that vary."""
    t, (x, v, a) = np.arange(0.0, 8.0, 0.004), np.zeros((3, 2000))
    for f, size in ((0.31, 0.4), (0.73, 0.3), (1.1, 0.25)):
        w = 2.0 * np.pi * f
        x += size * np.sin(w * t + f)
        v += size * w * np.cos(w * t + f)
        a -= size * w**2 * np.sin(w * t + f)
    noise = np.random.default_rng(1).normal(size=(2, len(t)))
    force = np.sign(v) + 0.3 * v + (not friction) * 0.02 * a + 0.01 * noise[0]
    given = {name: of(t) for name, of in more.items()}
    inputs = given.pop("inputs", {})
    return Record(
        time=t, position=x + 3e-5 * noise[1], force=force, friction=friction, inputs=inputs, **given
    )


def varying(t):
    return 4.0 * (1.0 + 0.3 * np.sin(2.3 * t))


TABLES = {
    "table": Measurement(velocity=BOTH, friction=5.0 * np.sign(BOTH) + BOTH),
    "one direction": Measurement(velocity=SPEEDS, friction=5.0 + SPEEDS),
    "backwards only": Measurement(velocity=-SPEEDS, friction=-5.0 - SPEEDS),
    "one load": mixed(load=lambda v: np.full(len(v), 4.0)),
    "loads": mixed(load=lambda v: np.random.default_rng(2).choice([3.0, 5.0, 9.0], len(v))),
}
RECORDS = {
    "record": lambda: RecordProblem([recorded()]),
    "driven": lambda: RecordProblem([recorded(friction=False)]),
    "gear": lambda: RecordProblem(
        [
            recorded(
                load=varying,
                transmitted=lambda t: 2.0 * np.sin(1.7 * t),
                inputs=lambda t: {"transmitted": np.abs(2.0 * np.sin(1.7 * t))},
            )
        ],
        normal=4.0,
    ),
    "warm": lambda: RecordProblem(
        [recorded(load=varying, inputs=lambda t: {"temperature": 20.0 + 5.0 * np.sin(0.9 * t)})],
        normal=4.0,
    ),
}
PROBLEMS = RECORDS | {
    name: functools.partial(TableProblem.of, AXIS, table) for name, table in TABLES.items()
}


def error(law, composed, velocity, curve):
    """Return how far a law is off a curve, over the largest friction of it."""
    own = bound(law, composed.inputs)
    force = np.array([float(own.steady(v, composed.normal())) for v in velocity.tolist()])
    return np.max(np.abs(force - curve)) / np.max(np.abs(curve))


@functools.cache
def judged(name):
    return Judgement(PROBLEMS[name]())


@pytest.mark.slow
@pytest.mark.parametrize("within", [False, True], ids=["beside", "within"])
@pytest.mark.parametrize("name", PROBLEMS)
def test_every_law_slides_as_its_structure_in_both_directions(name, within):
    judgement = replace(judged(name), offset=within)
    problem, random = judgement.problem, np.random.default_rng(8)
    speeds = np.abs(problem.curve_rows().velocity)
    speeds = np.geomspace(speeds.min(), speeds.max(), 31)
    velocity = np.concatenate([-speeds[::-1], speeds])
    rows, families = problem.at(velocity), set()
    for candidates in problem.candidates():
        structure = candidates.structures[random.integers(len(candidates.structures))]
        x = problem.design(structure, rows)
        size = np.max(np.abs(x), axis=0)
        values = random.uniform(0.1, 1.0, len(size)) / np.where(size > 0.0, size, 1.0)
        for k, one in enumerate(names_of(structure)):
            values[k] *= 4.0 if one == "level" else 1.0
            if is_signed(one):  # what differs is less than what it differs from
                values[k] *= random.choice([-0.1, 0.1]) * (0.1 if "*" in one else 1.0)
        rung = replace(judgement.named, structure=structure, coefficients=values)
        composed, sliding, law = judgement.handed_over(rung)
        offset = 0.0 if within else float(composed.rig.get("offset", np.zeros(1))[0])
        curve = judgement.curve_of(rung, rows) - offset
        composition = composed.law()
        if composition is not None:
            assert error(composition, composed, velocity, curve) < 1e-12, (structure, values)
            families.add(candidates.family)
        if law is None and not np.any(sliding.friction * sliding.velocity < 0.0):
            table = composed.through(sliding)
            assert error(table, composed, velocity, curve) < 1e-2, structure
    # a level that is smooth in the velocity does not differ by direction
    assert len(families) > 0.4 * len({one.family for one in problem.candidates()})


def test_beside_a_power_what_is_linear_and_differs_by_direction_stays_linear():
    terms = {
        "level": ((), np.array([[10.0]])),
        "power": ((0.5,), np.array([[150.0]])),
        "viscous_direction": ((), np.array([[-40.0]])),
    }
    law = compose(terms, {}, 1).law()
    v = np.array([-0.2, -0.01, 0.01, 0.2])
    true = np.sign(v) * (10.0 + 150.0 * np.abs(v) ** 0.5) - 40.0 * np.abs(v)
    np.testing.assert_allclose(law.force(v, 1.0), true, rtol=1e-14)
    assert law.viscous_coefficient == 150.0


def test_a_viscous_part_that_falls_in_one_direction_is_no_table():
    terms = {
        "level": ((), np.array([[10.0]])),
        "viscous": ((), np.array([[1.0]])),
        "viscous_direction": ((), np.array([[3.0]])),
    }
    found = compose(terms, {}, 1)
    assert found.text == ""  # titles are those of the terms
    v = np.array([-1.0, 1.0])
    np.testing.assert_allclose(found.law().force(v, 1.0), [-8.0, 14.0], rtol=1e-14)
    assert found.paths()["friction.backward_viscous_coefficient"][0] == -2.0


def test_a_level_that_changes_with_two_inputs_is_right_at_their_means():
    terms = {
        "level": ((), np.array([[10.0]])),
        "level*temperature": ((), np.array([[-0.05]])),
        "level*pressure": ((), np.array([[0.03]])),
    }
    law = compose(terms, {"temperature": 40.0, "pressure": 55.0}, 1).law()

    def at(heat, pressure):
        return bound(law, {"temperature": heat, "pressure": pressure}).force(0.1, 1.0)

    assert at(40.0, 55.0) == pytest.approx(10.0, rel=1e-14)
    # a product has the slopes of the sum there
    assert at(41.0, 55.0) - at(40.0, 55.0) == pytest.approx(-0.05, rel=1e-12)
    assert at(40.0, 56.0) - at(40.0, 55.0) == pytest.approx(0.03, rel=1e-12)


def asymmetric(v):
    """Return friction of a power that differs by direction."""
    u = np.abs(v) ** 0.66
    return np.where(v > 0.0, 14.0 + 80.0 * u, -18.0 - 120.0 * u)


@pytest.fixture(scope="module")
def verdict():
    u = np.geomspace(0.005, 0.13, 14)
    v = np.concatenate([-u[::-1], u])
    noise = 0.1 * np.random.default_rng(3).normal(size=len(v))
    return select(AXIS, None, Measurement(velocity=v, friction=asymmetric(v) + noise))


def test_law_and_mechanism_of_a_verdict_predict_its_curve(verdict, tmp_path):
    u = np.geomspace(0.005, 0.13, 101)
    v = np.concatenate([-u[::-1], u])
    curve = acting(verdict, v)
    assert np.max(np.abs(curve - asymmetric(v))) < 0.5  # five times the noise
    verdict.closest.fit.save(tmp_path / "law.toml")
    rig = load_rig(tmp_path / "law.toml")
    (saved,) = rig.laws.values()
    for law, mechanism in ((verdict.law, verdict.mechanism), (saved, rig.mechanism)):
        force = law.force(v, mechanism.load) + mechanism.offset
        # cubics between 24 levels of a curve without corners
        assert np.max(np.abs(force - curve)) < 2e-4 * np.max(np.abs(curve))
    offset = next(one.value for one in verdict.parameters if one.path == "offset")
    assert verdict.mechanism.offset == offset


def test_every_candidate_of_a_verdict_predicts_its_own_curve(verdict):
    judgement, v = verdict.judgement, np.array([-0.12, -0.03, -0.006, 0.006, 0.03, 0.12])
    rungs = {one.family: one for one in (*judgement.ladder, *judgement.set)}
    assert len(verdict.candidates) > 3
    for one in verdict.candidates:
        curve = judgement.curve_of(rungs[one.family], judgement.problem.at(v))
        force = one.fit.law.force(v, 1.0) + one.fit.mechanism.offset
        np.testing.assert_allclose(force, curve, rtol=1e-3)


def test_a_power_that_differs_by_direction_is_a_law(verdict):
    assert verdict.law.name == "both_ways[levels](level + power)"
    found = {one.path: one for one in verdict.parameters}
    for name, true in (("forward", 80.0), ("backward", 120.0)):
        one = found[f"friction.{name}_viscous_coefficient"]
        assert one.low_any <= true <= one.high_any


def test_a_run_with_what_is_handed_over_slows_by_the_force_of_each_direction(verdict):
    heavy = replace(verdict.mechanism, inertia=1e6)  # so that its speed hardly changes
    for speed in (-0.1, 0.1):
        run = simulate(heavy, verdict.law, t_end=1.0, y0={"v": speed})
        force = -1e6 * (run["v"][-1] - speed)
        assert force == pytest.approx(float(acting(verdict, [speed])[0]), rel=1e-3)


def test_samples_are_asymmetric_as_the_band_is(verdict):
    laws = verdict.sample(40, seed=1)
    v = np.array([-0.1, 0.1])
    drawn = np.array([one.force(v, 1.0) for one in laws])
    # the difference between the directions is the offset, and what the laws differ by
    middle = np.median(drawn, axis=0) + verdict.mechanism.offset
    np.testing.assert_allclose(middle, verdict.band(v).median, rtol=0.2)


def test_a_mechanism_without_a_constant_force_has_the_offset_in_the_law():
    block = SpringBlock(mass=1.0)
    random = np.random.default_rng(1)
    read = 3.0 * np.sign(BOTH) + BOTH + 0.4 + 0.01 * random.normal(size=len(BOTH))
    verdict = select(block, None, Measurement(velocity=BOTH, friction=read))
    assert "offset" in verdict.family
    assert verdict.law.directional
    curve = acting(verdict, BOTH)
    load = verdict.judgement.composition.normal()
    np.testing.assert_allclose(verdict.law.force(BOTH, load), curve, rtol=1e-12)
    ahead, back = (
        next(one.value for one in verdict.closest.fit.estimates if one.path == f"friction.{name}")
        for name in ("forward_kinetic_coefficient", "backward_kinetic_coefficient")
    )
    assert (ahead - back) * load == pytest.approx(2.0 * 0.4, abs=0.03)
    assert any("is in the levels of the law" in text for text in verdict.words.cannot_tell)
