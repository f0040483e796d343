"""The force balance: rows, folds, cones, held-out errors and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.axis_records import TRUTHS, record

from stickslip.errors import InputError
from stickslip.evidence import Balance, Series, Structure, Term, begin, explain, fit
from stickslip.evidence.fits import CHANCE, design, estimated, solved
from stickslip.evidence.moves import moves
from stickslip.evidence.values import free_values, logarithms
from stickslip.evidence.vocabulary import vocabulary

RANDOM = np.random.default_rng(5)


@pytest.fixture(scope="module")
def coulomb():
    """A record of level 1 N m with rests, whose force has noise of 0.03 N m."""
    truth = next(one for one in TRUTHS if one.name == "c1")
    return record(truth, 5, seconds=12.0)


@pytest.fixture(scope="module")
def balance(coulomb):
    return Balance([coulomb.series])


def rows_of(series, rows):
    return replace(series, t=series.t[rows], q=series.q[rows], force=series.force[rows])


def test_a_coulomb_axis_with_rests_leaves_the_noise_of_its_force(coulomb, balance):
    """Through open rows: before they were, 3.8 % were left and called backlash and delay."""
    found = fit(balance, begin(balance))
    noise = 0.03 * np.sqrt(2.0 * balance.fc / 1000.0)
    assert found.of("level")[0] == pytest.approx(1.0, rel=0.01)
    assert balance.at_rest.mean() > 0.1
    assert found.rms < 1.5 * noise


def test_a_row_in_the_cone_counts_for_nothing_and_one_outside_by_its_distance(balance):
    made = design(balance, begin(balance))
    level = next(i for i, one in enumerate(made.owners) if one.kind == "level")
    at = np.flatnonzero(balance.at_rest & balance.use)
    values = np.zeros(len(made.owners))
    values[level] = 10.0
    assert not made.residual(values)[at].any()
    values[level] = 0.0
    np.testing.assert_allclose(made.residual(values)[at], made.force[at])
    values[level] = 0.1
    expected = np.sign(made.force) * np.maximum(np.abs(made.force) - 0.1, 0.0)
    at = at[np.abs(made.columns[at, level]) <= 1.0]  # elsewhere the filter overshoots
    np.testing.assert_allclose(made.residual(values)[at], expected[at], atol=1e-12)


def test_a_slip_that_the_filter_makes_overshoot_is_no_error_of_the_law():
    t = 2e-3 * np.arange(5000)
    series = Series(t, np.sin(3.0 * t), 2.0 * np.sign(np.cos(3.0 * t)), inertia=False)
    there = Balance([series])
    made = design(there, begin(there))
    left = made.residual(np.array([2.0]))
    assert np.abs(made.force).max() > 2.1
    # a reversal between two samples is seen at one of them
    assert np.sqrt(np.mean(left[there.use] ** 2)) < 0.01


def test_the_difference_of_directions_shifts_the_cone(balance):
    step = Term("stribeck_dir", (1e9, 1.0))
    made = design(balance, begin(balance).having(step))
    kinds = [one.kind for one in made.owners]
    values = np.zeros(len(kinds))
    values[kinds.index("level")], values[kinds.index("stribeck_dir")] = 0.3, 0.1
    at = np.flatnonzero(balance.at_rest & balance.use)
    contact = made.columns[at] @ values
    at = at[(contact > -0.2) & (contact < 0.4)]
    force = made.force[at]
    expected = force - np.clip(force, -0.2, 0.4)
    np.testing.assert_allclose(made.residual(values)[at], expected, atol=1e-6)


def test_a_memory_that_the_path_resolves_is_charged_at_rest(balance):
    short, long = (begin(balance).shaped("", (length, 1.0)) for length in (1e-5, 1e-2))
    assert balance.open(short).any()
    assert not balance.open(long).any()


def test_held_out_errors_by_gram_matrices_are_those_of_direct_fits(balance):
    structure = begin(balance).having(Term("viscous"), Term("offset"))
    made, found = design(balance, structure), fit(balance, structure)
    first = made.residual(found.coef)
    # open rows outside the cone, by more than noise, stand on its border
    columns, rows = made.columns.copy(), made.slipping.copy()
    simple = solved(columns[rows].T @ columns[rows], columns[rows].T @ made.force[rows])
    left = made.residual(simple)
    noise = np.sqrt(np.mean(left[rows] ** 2))
    out = balance.use & made.open & (np.abs(left) > CHANCE * noise)
    level = [one.kind for one in made.owners].index("level")
    columns[out, level] = np.sign(left[out]) * made.multipliers[out, level]
    rows |= out
    for k in (0, 4, 9):
        kept = rows & ~balance.near[k]
        values = np.linalg.lstsq(columns[kept], made.force[kept], rcond=None)[0]
        held = np.flatnonzero((balance.fold == k) & balance.use)
        # the ridge of scaled normal equations is 1e-9
        assert np.sum(made.residual(values, held) ** 2) == pytest.approx(found.sse[k], rel=1e-5)
    np.testing.assert_allclose(found.residual, first)


def test_the_errors_of_many_moves_at_once_are_those_of_their_fits(balance):
    """Away from rests, where both judge the same rows."""
    structure = begin(balance)
    candidates = [Term("viscous"), Term("stribeck", (0.1, 1.0)), Term("ripple", (6.0,))]
    for move in moves(balance, structure, candidates):
        made = design(balance, move.applied(structure))
        errors = 0.0
        for k in range(balance.folds):
            kept = made.slipping & ~balance.near[k]
            values = np.linalg.lstsq(made.columns[kept], made.force[kept], rcond=None)[0]
            held = (balance.fold == k) & made.slipping
            errors += float(np.sum((made.force - made.columns @ values)[held] ** 2))
        assert move.error == pytest.approx(errors / made.slipping.sum(), rel=1e-5)


def test_gaps_keep_what_the_filter_mixes_out_of_both_sides_of_a_fold(balance):
    part = balance.parts[0]
    width = 3.0 / balance.fc / (part.h * part.every)
    for k in range(balance.folds):
        gap = np.sum(balance.near[k] & (balance.fold != k))
        assert gap >= width * (1 if k in (0, balance.folds - 1) else 2) - 2


def test_a_held_force_acts_half_a_sample_later(coulomb):
    late = Balance([coulomb.series], 40.0)
    prompt = Balance([replace(coulomb.series, hold=False)], 40.0)
    moved = np.interp(prompt.parts[0].t - 0.5e-3, prompt.parts[0].t, prompt.parts[0].force)
    inside = slice(500, -500)
    np.testing.assert_allclose(late.parts[0].force[inside], moved[inside], atol=0.01)


@pytest.mark.parametrize("shift", [("delay", 0.01), ("skew", 4e-4)], ids=["delay", "clock drift"])
def test_a_bristle_that_no_path_resolves_is_not_seen_beside_a_shift(balance, shift):
    """Stribeck friction shown 10 ms late was called Maxwell slip with a clock that drifts."""
    kind, value = shift
    late = begin(balance).having(Term(kind, (value,), "*"))
    short, long = (late.shaped("", (length, 1.0)) for length in (1e-7, 1e-2))
    assert not balance.resolves(1e-7)
    assert not fit(balance, short).ok
    assert fit(balance, long).ok
    assert fit(balance, late).ok


def breaking_away(sides=(1.0, -1.0)):
    """Slips after rests whose force rises to a static level of 20 N; slow rows are few."""
    h, count, rests = 1e-3, 2000, 1200
    t = h * np.arange(count - rests)
    v, force = [], []
    for k in range(8):
        side, top = sides[k % len(sides)], 0.05 * (k + 1)
        speed = np.minimum(np.minimum(2.0 * t, top), 0.5 * (t[-1] - t))
        v += [np.zeros(rests), side * speed]
        sliding = 10.0 + 10.0 * np.exp(-((speed / 0.002) ** 2)) + 8.0 * speed
        force += [side * np.linspace(0.0, 20.0, rests), side * sliding]
    speed = np.concatenate(v)
    q = h * np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))])
    noise = 0.05 * np.random.default_rng(3).normal(size=len(q))
    return Series(h * np.arange(len(q)), q, np.concatenate(force) + noise, inertia=False)


STRIBECK = (Term("stribeck", (0.002, 2.0)), Term("viscous"))


@pytest.mark.slow
def test_rests_tell_the_static_level():
    """The way up to break-away was fitted as if all of it were that level: a step of .3 N."""
    there = Balance([breaking_away()])
    found = fit(there, begin(there).having(*STRIBECK))
    # the filter cuts the peak of the force
    assert found.of("stribeck")[0] == pytest.approx(10.0, rel=0.05)
    assert found.of("level")[0] == pytest.approx(10.0, rel=0.005)
    assert found.of("viscous")[0] == pytest.approx(8.0, rel=0.02)
    best = explain(there).best
    assert {one.kind for one in best.structure.terms} == {"level", "stribeck", "viscous"}
    assert best.rms < 0.25


@pytest.mark.parametrize("sides", [(1.0, -1.0), (-1.0,)])
@pytest.mark.parametrize("more", [(), ("offset",), ("offset", "stribeck_dir")])
def test_rows_outside_the_cone_are_fitted_as_long_as_that_lowers_the_error(sides, more):
    """In one direction a level and a constant force are one, and rows go to and fro."""
    there = Balance([breaking_away(sides)])
    further = [Term(one, (0.002, 2.0) if "_" in one else ()) for one in more]
    made = design(there, begin(there).having(*STRIBECK, *further))
    known, rows = estimated(made), made.slipping
    columns, force = made.columns[rows], made.force[rows]
    first = made.residual(solved(columns.T @ columns, columns.T @ force))[there.use]
    left = made.residual(known.values)
    assert known.error == pytest.approx(np.sum(left[there.use] ** 2))
    assert known.error < np.sum(first**2)
    np.testing.assert_allclose(made.outside(known.values), left[made.free])


@pytest.mark.slow
def test_pieces_between_gaps_are_explained_as_a_whole_record_is(coulomb):
    kept = np.ones(len(coulomb.t), dtype=bool)
    for first in (3000, 4500, 8000):
        kept[first : first + 300] = False
    found = explain([rows_of(coulomb.series, kept)])
    assert len(found.balance.parts) == 4
    assert str(found.best.structure) == "inertia + level"


@pytest.mark.slow
def test_uneven_times_are_put_on_a_grid(coulomb):
    kept = RANDOM.random(len(coulomb.t)) > 0.1
    found = explain([rows_of(coulomb.series, kept)])
    assert str(found.best.structure) == "inertia + level"
    assert found.intervals["-/level"][0] == pytest.approx(1.0, rel=0.01)


def test_a_table_has_a_row_for_each_point_and_no_memory():
    v = np.array([-2.0, -1.0, -0.5, -0.2, 0.1, 0.3, 0.6, 1.0, 1.5, 2.0])
    f = np.sign(v) * (1.0 + 0.5 * np.abs(v)) + 0.01 * RANDOM.normal(size=len(v))
    found = explain(Balance.points(v, f))
    assert str(found.best.structure) == "level + viscous"
    level, low, high = found.intervals["-/level"]
    assert low < 1.0 < high
    assert high - low < 0.1
    assert level == pytest.approx(1.0, abs=0.03)


@pytest.mark.slow
def test_a_level_in_load_stands_for_the_level_where_the_load_is_measured():
    t = 2e-3 * np.arange(6000)
    load = 2.0 + np.sin(0.7 * t)
    force = 0.4 * load * np.sign(np.cos(3.0 * t)) + 0.02 * RANDOM.normal(size=len(t))
    series = Series(t, np.sin(3.0 * t), force, inertia=False, covariates={"load": load})
    found = explain([series])
    assert str(found.best.structure) == "level in load load"
    assert found.intervals["-/load"][0] == pytest.approx(0.4, rel=0.01)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (lambda s: rows_of(s, slice(0, 40)), "at least 64 samples"),
        (lambda s: rows_of(s, slice(3000, 3300)), "too short for its noise"),
        (lambda s: replace(s, force=np.ones_like(s.force)), "the force is constant"),
        (lambda s: replace(s, q=np.zeros_like(s.q)), "moves for 0 s only"),
        (lambda s: replace(s, q=1e-5 * RANDOM.normal(size=len(s.q))), "of motion between rests"),
        (lambda s: replace(s, force=-s.force), "Check the sign of the force"),
        (lambda s: replace(s, force=s.force[:-1]), "as many values as there are times"),
        (
            lambda s: replace(s, q=np.where(np.arange(len(s.q)) == 7, np.nan, s.q)),
            "q has 1 value that is not finite",
        ),
    ],
)
def test_what_cannot_be_judged_is_refused_in_one_sentence(coulomb, changed, message):
    with pytest.raises(InputError, match=message):
        explain([changed(coulomb.series)])


@pytest.mark.parametrize("v", [np.array([1.0, 2.0]), np.array([1.0, 2.0, np.nan, 3.0])])
def test_a_table_of_few_points_or_of_missing_values_is_refused(v):
    with pytest.raises(InputError, match="at least 4 points"):
        Balance.points(v, np.ones_like(v))


@pytest.mark.slow
def test_motion_in_one_direction_has_a_level_and_no_fault():
    t = 1e-3 * np.arange(12_000)
    v, a = 0.5 + 0.2 * np.cos(t), -0.2 * np.sin(t)
    x = np.round((0.5 * t + 0.2 * np.sin(t)) / 1e-4) * 1e-4
    force = 0.02 * a + 1.0 + 0.3 * v + 0.03 * RANDOM.normal(size=len(t))
    found = explain([Series(t, x, force)])
    assert not found.faults
    assert all(np.isfinite(one).all() for one in found.intervals.values())


def test_candidates_cover_decades_of_every_parameter(balance):
    kinds = {one.kind for one in vocabulary(balance)}
    assert {"power", "stribeck", "delay", "flexible", "loose", "saturation"} <= kinds
    assert "known" not in kinds
    assert Structure((Term("level"),)).having(Term("offset")).has("offset")


@pytest.mark.slow
def test_a_late_force_is_found_where_the_inertia_and_forces_of_other_joints_are_known():
    """The motion takes its force on time: only what the channel shows is late."""
    t = 2e-3 * np.arange(10_000)
    q = np.sin(5.0 * t) + 0.4 * np.sin(11.3 * t)
    v = 5.0 * np.cos(5.0 * t) + 0.4 * 11.3 * np.cos(11.3 * t)
    a = -25.0 * np.sin(5.0 * t) - 0.4 * 11.3**2 * np.sin(11.3 * t)
    taken = 0.3 * np.sin(7.7 * t)
    applied = 0.05 * a + taken + 0.3 * np.sign(v)
    late = np.interp(t - 0.008, t, applied) + 0.01 * RANDOM.normal(size=len(t))
    noisy = q + 1e-5 * RANDOM.normal(size=len(t))
    found = explain([Series(t, noisy, late, mass=0.05, taken=taken)])
    assert found.best.structure.late[0] == pytest.approx(0.008, abs=5e-4)
    assert found.best.of("level")[0] == pytest.approx(0.3, rel=0.02)


def test_no_mass_is_accused_beside_columns_of_a_mechanism_that_are_free():
    """They hold the inertia: its error would be theirs."""
    t = 2e-3 * np.arange(5000)
    series = Series(t, np.sin(3.0 * t), np.sign(np.cos(3.0 * t)), mass=0.1)
    free = replace(series, extra={"inertia": np.sin(3.0 * t)})
    kinds = [{term.kind for term in vocabulary(Balance([one]))} for one in (series, free)]
    assert ["mass" in one for one in kinds] == [True, False]


def test_a_value_of_0_stays_where_it_is_as_it_has_no_logarithm():
    law = Structure((Term("delay", (0.0,)), Term("level")), (("", (1e-3, 1.0, 0.1, 0.0, 2.0)),))
    free = free_values(law)
    assert [one.name for one in free] == ["-/r0", "-/vs"]
    np.testing.assert_allclose(logarithms(law, free), np.log([1e-3, 0.1]))
