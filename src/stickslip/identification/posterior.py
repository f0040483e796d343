"""Draws from the posterior of a fit, by emcee or dynesty, where one of them is installed."""

import importlib
import math
from dataclasses import dataclass
from typing import Any, Literal, final

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.identification.record_fit import RecordFit
from stickslip.quantities import full_path

__all__ = ["Posterior", "sample_posterior"]

Array = NDArray[np.float64]

WIDE = 20.0
"""Half width of the flat prior, in standard errors, where no bound is nearer."""
BURN_IN = 0.3
"""Share of a chain that is left out."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Posterior:
    """Draws of the unknowns of a fit.

    Examples
    --------
    >>> drawn = Posterior(paths=("friction.kinetic_coefficient",), draws=np.ones((100, 1)))
    >>> drawn.interval("kinetic_coefficient")
    (1.0, 1.0)
    """

    paths: tuple[str, ...]
    """Parameter paths (p,)."""
    draws: Array
    """Values (draws, p)."""

    def interval(self, path: str, level: float = 0.95) -> tuple[float, float]:
        """Return the central interval of a parameter.

        Parameters
        ----------
        path : str
            Path or last name of an unknown.
        level : float
            Probability that it holds.

        Raises
        ------
        UnknownNameError
            If it was not drawn.
        """
        column = self.draws[:, self.paths.index(full_path(path, self.paths))]
        low, high = np.quantile(column, [0.5 * (1.0 - level), 0.5 * (1.0 + level)])
        return float(low), float(high)


def sample_posterior(
    fit: RecordFit,
    *,
    sampler: Literal["emcee", "dynesty"] = "emcee",
    steps: int = 400,
    seed: int = 0,
) -> Posterior:
    """Draw from the posterior of a fit with a flat prior within its bounds.

    Residuals are correlated: the likelihood is raised to the share of them that is independent,
    and their size is that at the best values. Unknowns that a bound holds stay there.

    Parameters
    ----------
    fit : RecordFit
        What is drawn around; each draw predicts the whole record once.
    sampler : {"emcee", "dynesty"}
        An ensemble of walkers, or nested sampling, which also finds further modes.
    steps : int
        Steps of each walker, or live points.
    seed : int
        Of the random numbers.

    Returns
    -------
    Posterior
        Draws of all unknowns.

    Raises
    ------
    InputError
        If the sampler is not installed, or not known.

    Examples
    --------
    >>> from stickslip import Axis, CoulombViscous, Measurement, fit
    >>> v = np.linspace(-1.0, 1.0, 201)
    >>> friction = np.sign(v) * 2.0 + 3.0 * v + 0.1 * np.random.default_rng(0).normal(size=201)
    >>> table = Measurement(velocity=v, friction=friction)
    >>> found = fit(Axis(inertia=1.0), CoulombViscous, table)
    >>> drawn = sample_posterior(found, steps=100)
    >>> low, high = drawn.interval("viscous_coefficient")
    >>> low < 3.0 < high
    True

    Source: D. Foreman-Mackey et al., "emcee: The MCMC Hammer", PASP 125, 2013; J. Speagle,
    "dynesty", MNRAS 493, 2020.
    """
    if sampler not in ("emcee", "dynesty"):
        raise InputError(f"sampler must be 'emcee' or 'dynesty', got {sampler!r}.")
    try:
        library = importlib.import_module(sampler)
    except ImportError:
        raise InputError(
            f"{sampler} is not installed: pip install 'stickslip[bayes]', or use"
            " RecordFit.bootstrap, which needs nothing."
        ) from None
    target = _Target(fit)
    draw = _walked if sampler == "emcee" else _nested
    found = draw(library, target, steps, np.random.default_rng(seed))
    values = np.array([target.values(row) for row in found])
    return Posterior(paths=fit.unknowns.paths, draws=values)


class _Target:
    """The logarithm of the posterior over the coordinates that no bound holds."""

    def __init__(self, fit: RecordFit) -> None:
        self.fit = fit
        self.best = fit.unknowns.coordinates(fit.values)
        self.free = [i for i, path in enumerate(fit.unknowns.paths) if path not in fit.at_bounds]
        scale = np.linalg.pinv(fit.scale)
        known = np.where(np.isfinite(fit.inference.covariance), fit.inference.covariance, 0.0)
        spread = np.sqrt(np.maximum(np.diag(scale @ known @ scale.T), 0.0))[self.free]
        low, high = (edge[self.free] for edge in fit.unknowns.limits())
        middle = self.best[self.free]
        # what the record does not depend on may be anywhere within its bounds
        room = np.where(np.isfinite(high - low), (high - low) / (2.0 * WIDE), 1.0)
        self.spread = np.where(spread > 0.0, spread, room)
        self.low = np.maximum(low, middle - WIDE * self.spread)
        self.high = np.minimum(high, middle + WIDE * self.spread)
        rows = len(fit.residual)
        share = min(fit.inference.effective / rows, 1.0)
        self.weight = 0.5 * share * rows / fit.found.best.cost

    def values(self, free: Array) -> Array:
        """Return values (p,) for the free coordinates."""
        at = self.best.copy()
        at[self.free] = free
        return self.fit.unknowns.values(at)

    def __call__(self, free: Array) -> float:
        """Return the logarithm of the posterior, less its largest value."""
        if np.any(free < self.low) or np.any(free > self.high):
            return -math.inf
        best = self.fit.found.best
        seen = self.fit.problem.linearise(self.values(free), best, slopes=False)
        return -self.weight * (seen.cost - best.cost) if math.isfinite(seen.cost) else -1e300


def _walked(library: Any, target: _Target, steps: int, random: np.random.Generator) -> Array:
    size = len(target.free)
    walkers = 2 * size + 2
    start = target.best[target.free] + target.spread * random.normal(size=(walkers, size))
    start = np.clip(start, target.low, target.high)
    chain = library.EnsembleSampler(walkers, size, target)
    chain.random_state = np.random.RandomState(int(random.integers(2**31))).get_state()
    chain.run_mcmc(start, steps)
    found: Array = chain.get_chain(discard=int(BURN_IN * steps), flat=True)
    return found


def _nested(library: Any, target: _Target, steps: int, random: np.random.Generator) -> Array:
    nested = library.NestedSampler(
        target,
        lambda cube: target.low + cube * (target.high - target.low),
        len(target.free),
        nlive=steps,
        rstate=random,
    )
    nested.run_nested(print_progress=False)
    found: Array = nested.results.samples_equal(rstate=random)
    return found
