"""Intervals where residuals are correlated."""

import math

import numpy as np
import pytest
from scipy import stats
from scipy.signal import lfilter

from stickslip import Axis, Measurement, fit
from stickslip.identify.fits.levenberg_marquardt import ResidualJacobian
from stickslip.identify.fits.shooting.estimates import block_sums, effective_size, infer


def autoregression(count, decay, random):
    """Return a first-order autoregression of unit variance."""
    shocks = math.sqrt(1.0 - decay**2) * random.standard_normal(count)
    shocks[0] /= math.sqrt(1.0 - decay**2)
    return lfilter([1.0], [1.0, -decay], shocks)


def mean_of(rows):
    """Return a mean as a problem of least squares, at its estimate."""
    return ResidualJacobian(
        values=np.array([rows.mean()]),
        residual=rows - rows.mean(),
        slopes=np.ones((len(rows), 1)),
        segment=np.zeros(len(rows), dtype=int),
    )


def line_of(rows, columns):
    """Return a linear regression at its estimate."""
    values = np.linalg.lstsq(columns, rows, rcond=None)[0]
    return ResidualJacobian(
        values=values,
        residual=rows - columns @ values,
        slopes=columns,
        segment=np.zeros(len(rows), dtype=int),
    )


def test_the_error_of_a_mean_is_that_of_the_means_of_blocks():
    rows = autoregression(400, 0.9, np.random.default_rng(1))
    found = infer(mean_of(rows), np.eye(1))
    # leaving one of b equal blocks out of a mean gives the textbook s / sqrt(b) of block means
    means = rows.reshape(8, 50).mean(axis=1)
    assert found.errors[0] == pytest.approx(means.std(ddof=1) / math.sqrt(8.0), rel=1e-12)
    assert found.freedom[0] == pytest.approx(7.0)
    assert found.half_widths[0] == pytest.approx(stats.t.ppf(0.975, 7) * found.errors[0])


def test_rows_that_a_fit_follows_exactly_leave_no_division_by_zero():
    # of four rows of a half, two leave 1e-10 of their variance to three parameters
    v = np.linspace(-1.0, 1.0, 10)
    friction = 2.0 * np.sign(v) + 0.05 * np.random.default_rng(3).normal(size=10)
    found = fit(Axis(inertia=1.0), "power-viscous", Measurement(velocity=v, friction=friction))
    assert all(np.isfinite(one.value) for one in found.estimates)


def test_intervals_keep_what_they_say_where_few_blocks_tell():
    random, hits, plain = np.random.default_rng(14), 0, 0
    column = np.where(np.arange(400) // 50 < 3, 1.0, 0.02)[:, None]
    for _ in range(600):
        seen = line_of(autoregression(400, 0.5, random), column)
        found = infer(seen, np.eye(1))
        hits += abs(seen.values[0]) <= found.half_widths[0]
        plain += abs(seen.values[0]) <= stats.t.ppf(0.975, 7) * found.errors[0]
    # 600 draws know 95 % to .9; blocks of 50 rows, 17 correlation lengths, are nearly independent
    assert 0.925 <= hits / 600 <= 0.985
    assert plain / 600 < 0.92  # Student's t with as many degrees as blocks less one is too sure


def test_leaving_blocks_out_is_exact_for_a_linear_problem():
    random = np.random.default_rng(2)
    columns = np.column_stack([np.ones(200), np.linspace(-1.0, 3.0, 200)])
    rows = columns @ [2.0, -1.0] + autoregression(200, 0.8, random)
    found = infer(line_of(rows, columns), np.eye(2))
    without = []
    for k in range(8):
        kept = np.arange(200) // 25 != k
        without.append(np.linalg.lstsq(columns[kept], rows[kept], rcond=None)[0])
    whole = np.linalg.lstsq(columns, rows, rcond=None)[0]
    table = np.array(without) - whole
    np.testing.assert_allclose(found.covariance, 0.875 * table.T @ table, rtol=1e-9)


def test_naive_errors_are_those_of_white_noise():
    rows = np.random.default_rng(3).normal(size=50)
    found = infer(mean_of(rows), np.eye(1))
    assert math.sqrt(found.naive[0, 0]) == pytest.approx(rows.std(ddof=1) / math.sqrt(50.0))


def test_intervals_of_a_mean_cover_where_naive_ones_do_not():
    random, hits, naive = np.random.default_rng(4), 0, 0
    for _ in range(400):
        seen = mean_of(autoregression(400, 0.9, random))
        found = infer(seen, np.eye(1))
        hits += abs(seen.values[0]) <= found.half_widths[0]
        naive += abs(seen.values[0]) <= 1.96 * math.sqrt(found.naive[0, 0])
    # 400 draws know 95 % to 1.1; blocks of 50 rows, 2.5 correlation lengths, lose 2 of them
    assert 0.89 <= hits / 400 <= 0.99
    assert naive / 400 < 0.6  # an autoregression of 0.9 has 19 times the variance of white noise


def test_errors_are_of_the_values_and_not_of_what_the_optimiser_sees():
    rows = np.random.default_rng(5).normal(size=100)
    one, other = (infer(mean_of(rows), np.array([[scale]])) for scale in (1.0, 7.0))
    assert one.errors[0] == pytest.approx(other.errors[0], rel=1e-12)


def test_what_the_record_does_not_depend_on_has_no_bounded_error():
    rows = np.random.default_rng(6).normal(size=100)
    columns = np.column_stack([np.ones(100), np.zeros(100)])
    found = infer(line_of(rows, columns), np.eye(2))
    assert math.isinf(found.errors[1])
    assert found.errors[0] == pytest.approx(infer(mean_of(rows), np.eye(1)).errors[0])
    np.testing.assert_allclose(found.correlation, np.eye(2))


def test_sums_of_blocks_add_up_to_the_whole():
    random = np.random.default_rng(8)
    seen = line_of(random.normal(size=57), random.normal(size=(57, 3)))
    squares, slopes = block_sums(seen, seen.slopes, blocks=7)
    assert squares.shape == (7, 3, 3)
    np.testing.assert_allclose(squares.sum(axis=0), seen.slopes.T @ seen.slopes)
    np.testing.assert_allclose(slopes.sum(axis=0), 0.0, atol=1e-12)


def test_an_autoregression_has_the_effective_size_of_the_textbook():
    decay, count = 0.8, 20_000
    seen = mean_of(autoregression(count, decay, np.random.default_rng(9)))
    # n (1 - a) / (1 + a); the sum up to the first zero adds the noise of a few lags to it
    assert effective_size(seen.residual) == pytest.approx(
        count * (1 - decay) / (1 + decay), rel=0.15
    )
    white = mean_of(np.random.default_rng(9).normal(size=2000))
    assert effective_size(white.residual) == pytest.approx(2000.0, rel=0.1)
    assert effective_size(mean_of(np.ones(30)).residual) == 30.0


def left_out_errors(rows, columns, blocks=8):
    """Return jackknife errors by fits to the rows that are left, columns scaled by hand."""
    size = np.linalg.norm(columns, axis=0)
    scaled = columns / size
    whole = np.linalg.lstsq(scaled, rows, rcond=None)[0]
    squares = np.zeros(len(size))
    for part in np.array_split(np.arange(len(rows)), blocks):
        kept = np.setdiff1d(np.arange(len(rows)), part)
        squares += (np.linalg.lstsq(scaled[kept], rows[kept], rcond=None)[0] - whole) ** 2
    return np.sqrt((blocks - 1) / blocks * squares) / size


@pytest.mark.parametrize("seed", range(12))
def test_units_and_a_nearly_collinear_pair_leave_errors_as_they_are(seed):
    random = np.random.default_rng(seed)
    count = int(random.integers(3, 7))
    columns = random.normal(size=(160, count))
    angle = 10.0 ** random.uniform(-5, -1)
    columns[:, 1] = columns[:, 0] + angle * random.normal(size=160)
    rows = columns @ random.normal(size=count) + autoregression(160, 0.5, random)
    sizes = 10.0 ** random.uniform(-9, 9, size=count)
    sizes[[0, -1]] = 1e-9, 1e9
    exact = left_out_errors(rows, columns)
    seen = line_of(rows, columns)
    scaled = ResidualJacobian(
        values=seen.values / sizes,
        residual=seen.residual,
        slopes=seen.slopes * sizes,
        segment=seen.segment,
    )
    found = infer(scaled, np.eye(count))
    assert found.reasons == ("",) * count
    # the pair costs ten of sixteen digits at most
    np.testing.assert_allclose(found.errors * sizes, exact, rtol=1e-5)
    plain = infer(seen, np.eye(count))
    np.testing.assert_allclose(found.freedom, plain.freedom, rtol=1e-5)
    assert found.condition == pytest.approx(plain.condition, rel=1e-5)


@pytest.mark.parametrize("seed", range(6))
def test_what_only_a_sum_of_two_shows_is_infinite_for_these_two_alone(seed):
    random = np.random.default_rng(seed)
    sizes = 10.0 ** random.uniform(-9, 9, size=4)
    columns = random.normal(size=(120, 4))
    columns[:, 1] = 1e6 * columns[:, 0]
    line = line_of(random.normal(size=120), columns[:, [0, 2, 3]])
    known = infer(line, np.eye(3))
    seen = ResidualJacobian(
        values=np.zeros(4), residual=line.residual, slopes=columns * sizes, segment=line.segment
    )
    found = infer(seen, np.eye(4))
    assert np.isinf(found.errors).tolist() == [True, True, False, False]
    assert [bool(why) for why in found.reasons] == [True, True, False, False]
    np.testing.assert_allclose((found.errors * sizes)[2:], known.errors[1:], rtol=1e-6)


def test_a_value_is_known_if_it_is_the_sum_that_the_record_shows():
    # the second value stands above the first, and the record depends on the second alone
    rows = np.random.default_rng(16).normal(size=100)
    columns = np.column_stack([np.zeros(100), np.ones(100)])
    found = infer(line_of(rows, columns), np.array([[1.0, 0.0], [1.0, 1.0]]))
    assert np.isinf(found.errors).tolist() == [True, False]
    assert found.errors[1] == pytest.approx(infer(mean_of(rows), np.eye(1)).errors[0])


def test_what_one_block_alone_shows_has_no_bounded_error():
    random = np.random.default_rng(15)
    rows = random.normal(size=160)
    columns = np.column_stack([np.ones(160), np.zeros(160), np.linspace(-1.0, 1.0, 160)])
    columns[45:55, 1] = 1.0  # rows of the third of eight blocks
    found = infer(line_of(rows, columns), np.eye(3))
    assert np.isinf(found.errors).tolist() == [False, True, False]
    assert found.reasons == ("", "only one segment of the record depends on it", "")
    # as much is known of the others as if those rows were not there
    kept = columns[:, 1] == 0.0
    rest = infer(line_of(rows[kept], columns[kept][:, [0, 2]]), np.eye(2))
    # whose blocks have other limits
    np.testing.assert_allclose(found.errors[[0, 2]], rest.errors, rtol=0.5)
    # one more row elsewhere, and the error is bounded and large
    columns[120, 1] = 1e-3
    wide = infer(line_of(rows, columns), np.eye(3))
    assert 3.0 < wide.errors[1] < math.inf
