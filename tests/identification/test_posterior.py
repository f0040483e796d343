import dataclasses

import numpy as np
import pytest
from tests.selection.test_records import AXIS, QUICK, TRUTH, recorded

from stickslip import CoulombViscous
from stickslip.errors import InputError
from stickslip.identification import posterior
from stickslip.identification.posterior import sample_posterior
from stickslip.identification.problem import Linearised
from stickslip.identification.record_fitting import fit_record


@pytest.fixture(scope="module")
def fit():
    return fit_record(AXIS, CoulombViscous, recorded(TRUTH), unknown=["inertia"], settings=QUICK)


class _Linear:
    """The fit's problem as it is at its best values: its posterior is known in closed form."""

    def __init__(self, whole):
        self.whole, self.best = whole.problem, whole.found.best

    def linearise(self, values, near=None, *, slopes=True):
        residual = self.best.residual - self.best.slopes @ (values - self.best.values)
        return Linearised(
            values=values,
            residual=residual,
            slopes=self.best.slopes,
            segment=self.best.segment,
        )


@pytest.mark.parametrize(("sampler", "steps"), [("emcee", 3000), ("dynesty", 300)])
def test_draws_of_a_linear_problem_have_its_mean_and_covariance(fit, sampler, steps):
    pytest.importorskip(sampler)
    linear = dataclasses.replace(fit, problem=fit.problem)
    stand_in = _Linear(fit)
    object.__setattr__(linear, "problem", _WithUnknowns(stand_in, fit.unknowns))
    found = sample_posterior(linear, sampler=sampler, steps=steps, seed=1)
    best = fit.found.best
    weight = fit.inference.effective / best.cost  # independent residuals over their variance
    expected = np.linalg.inv(weight * best.slopes.T @ best.slopes)
    deviation = np.sqrt(np.diag(expected))
    center = best.values + np.linalg.lstsq(best.slopes, best.residual, rcond=None)[0]
    # a hundred independent draws: means to a tenth of a deviation and 2.5 times that, deviations to
    # 7 % and three times that
    assert np.all(np.abs(found.draws.mean(axis=0) - center) < 0.25 * deviation)
    np.testing.assert_allclose(found.draws.std(axis=0), deviation, rtol=0.2)


class _WithUnknowns:
    def __init__(self, inner, unknowns):
        self.inner, self.unknowns = inner, unknowns

    def linearise(self, values, near=None, *, slopes=True):
        return self.inner.linearise(values, near, slopes=slopes)


def test_an_interval_lies_between_the_quantiles_of_its_own_column():
    draws = np.column_stack([np.zeros(101), np.linspace(0.0, 1.0, 101)])
    found = posterior.Posterior(paths=("mechanism.offset", "mechanism.inertia"), draws=draws)
    assert found.interval("mechanism.inertia", 0.5) == pytest.approx((0.25, 0.75))
    assert found.interval("mechanism.offset") == (0.0, 0.0)


def test_an_unknown_sampler_is_refused(fit):
    with pytest.raises(InputError, match="'emcee' or 'dynesty'"):
        sample_posterior(fit, sampler="gibbs")


def test_a_sampler_that_is_not_installed_names_what_to_install(fit, monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(posterior.importlib, "import_module", missing)
    with pytest.raises(InputError, match=r"pip install 'stickslip\[bayes\]'"):
        sample_posterior(fit)
