import dataclasses
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
from tests.selection.test_held_out_fits import AXIS, QUICK, TRUTH, recorded

import stickslip
from stickslip import CoulombViscous, Measurement, SpringBlock, Viscous
from stickslip.errors import InputError
from stickslip.executors import Inline
from stickslip.identification.estimation.problem import ResidualJacobian
from stickslip.identification.records import posterior
from stickslip.identification.records.fitting import fit_record
from stickslip.identification.records.posterior import sample_posterior


@pytest.fixture(scope="module")
def fit():
    return fit_record(AXIS, CoulombViscous, recorded(TRUTH), unknown=["inertia"], settings=QUICK)


class _Linear:
    """The fit's problem as it is at its best values: its posterior is known in closed form."""

    def __init__(self, whole):
        self.whole, self.best = whole.problem, whole.optimum.best

    def linearise(self, values, near=None, *, slopes=True):
        residual = self.best.residual - self.best.slopes @ (values - self.best.values)
        return ResidualJacobian(
            values=values,
            residual=residual,
            slopes=self.best.slopes,
            segment=self.best.segment,
        )


@pytest.fixture(scope="module")
def linear(fit):
    """The fit with that problem in place of its own."""
    stand_in = dataclasses.replace(fit, problem=fit.problem)
    object.__setattr__(stand_in, "problem", _WithUnknowns(_Linear(fit), fit.free_parameters))
    return stand_in


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sampler", "counts"),
    [
        ("emcee", {"steps": 3000}),
        pytest.param("dynesty", {"live_points": 300}, marks=pytest.mark.slow),
        ("dynesty", {}),
    ],
)
def test_draws_of_a_linear_problem_have_its_mean_and_covariance(fit, linear, sampler, counts):
    pytest.importorskip(sampler)
    found = sample_posterior(linear, sampler=sampler, seed=1, **counts)
    assert not found.cancelled
    best = fit.optimum.best
    weight = fit.inference.effective / best.cost  # independent residuals over their variance
    expected = np.linalg.inv(weight * best.slopes.T @ best.slopes)
    deviation = np.sqrt(np.diag(expected))
    center = best.values + np.linalg.lstsq(best.slopes, best.residual, rcond=None)[0]
    # a hundred independent draws: means to a tenth of a deviation and 2.5 times that, deviations to
    # 7 % and three times that
    assert np.all(np.abs(found.draws.mean(axis=0) - center) < 0.25 * deviation)
    np.testing.assert_allclose(found.draws.std(axis=0), deviation, rtol=0.2)


class _WithUnknowns:
    def __init__(self, inner, free_parameters):
        self.inner, self.free_parameters = inner, free_parameters

    def linearise(self, values, near=None, *, slopes=True):
        return self.inner.linearise(values, near, slopes=slopes)


def test_an_interval_lies_between_the_quantiles_of_its_own_column():
    draws = np.column_stack([np.zeros(101), np.linspace(0.0, 1.0, 101)])
    found = posterior.Posterior(paths=("mechanism.offset", "mechanism.inertia"), draws=draws)
    assert found.interval("mechanism.inertia", 0.5) == pytest.approx((0.25, 0.75))
    assert found.interval("mechanism.offset") == (0.0, 0.0)


def test_draws_are_tables_with_a_column_for_each_path():
    draws = np.arange(6.0).reshape(3, 2)
    found = posterior.Posterior(paths=("mechanism.offset", "friction.level"), draws=draws, runs=7)
    assert found.to_dataframe()["friction.level"].tolist() == [1.0, 3.0, 5.0]
    data = found.to_xarray()
    assert data["mechanism.offset"].values.tolist() == [0.0, 2.0, 4.0]
    assert data.attrs == {"cancelled": 0, "runs": 7}


@pytest.mark.parametrize("sampler", ["emcee", pytest.param("dynesty", marks=pytest.mark.slow)])
def test_a_watcher_hears_of_predictions_and_ends_drawing_with_what_there_is(linear, sampler):
    pytest.importorskip(sampler)
    heard = []

    def watch(runs):
        heard.append(runs)
        return len(heard) < 60

    found = sample_posterior(linear, sampler=sampler, seed=1, progress=watch)
    assert found.cancelled
    assert len(heard) == 60
    assert heard == sorted(heard)
    assert found.runs == heard[-1]
    assert len(found.draws) > 60
    assert np.all(np.isfinite(found.draws))
    # whoever only looks on ends nothing
    looked_on = sample_posterior(linear, sampler=sampler, seed=1, progress=lambda runs: None)
    assert not looked_on.cancelled
    assert looked_on.runs > found.runs


@pytest.mark.slow
def test_draws_do_not_depend_on_where_walkers_are_evaluated(linear):
    here = sample_posterior(linear, steps=20, seed=1)
    with ThreadPoolExecutor(3) as threads:
        there = sample_posterior(linear, steps=20, seed=1, executor=threads)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
        far = sample_posterior(linear, steps=20, seed=1, executor=processes)
    np.testing.assert_array_equal(there.draws, here.draws)
    np.testing.assert_array_equal(far.draws, here.draws)
    assert there.runs == far.runs == here.runs
    with pytest.raises(InputError, match="leave executor out"):
        sample_posterior(linear, sampler="dynesty", executor=Inline())


@pytest.mark.slow
def test_live_points_say_how_often_nested_sampling_predicts(linear):
    pytest.importorskip("dynesty")
    few, many = (sample_posterior(linear, sampler="dynesty", live_points=n) for n in (40, 160))
    # iterations go with live points: a factor of 4, less what the first bounds cost
    assert many.runs > 2.0 * few.runs
    assert len(many.draws) > 2.0 * len(few.draws)


@pytest.mark.parametrize(
    ("counts", "said"),
    [
        ({"sampler": "emcee", "live_points": 100}, "emcee takes steps, not live_points"),
        ({"sampler": "dynesty", "steps": 100}, "dynesty takes live_points, not steps"),
        ({"sampler": "emcee", "steps": 0}, "steps must be a whole number of at least 1, got 0"),
        ({"sampler": "emcee", "steps": 2.5}, "steps must be a whole number"),
        # of four unknowns: less than 2 p + 2 points do not span an ellipsoid
        ({"sampler": "dynesty", "live_points": 7}, "live_points must be a whole number"),
    ],
)
def test_counts_that_a_sampler_has_no_use_for_are_refused(fit, counts, said):
    with pytest.raises(InputError, match=said):
        sample_posterior(fit, **counts)


def test_a_fit_to_travels_is_refused_in_one_message():
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    travels = stickslip.fit(rig, Viscous, Measurement(travel=0.2))
    with pytest.raises(InputError, match=r"a fit to a record .* got a TravelFit"):
        sample_posterior(travels)


def test_an_unknown_sampler_is_refused(fit):
    with pytest.raises(InputError, match="'emcee' or 'dynesty'"):
        sample_posterior(fit, sampler="gibbs")


def test_a_sampler_that_is_not_installed_names_what_to_install(fit, monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr("stickslip.display.importlib.import_module", missing)
    with pytest.raises(InputError, match=r"pip install 'stickslip\[bayes\]'"):
        sample_posterior(fit)
