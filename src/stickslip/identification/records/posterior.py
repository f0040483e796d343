"""Draws from the posterior of a fit, by emcee or dynesty, where one of them is installed."""

import math
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, final

import numpy as np
from numpy.typing import NDArray

from stickslip.described import Described
from stickslip.display import require_library
from stickslip.errors import InputError, check_size, not_whole
from stickslip.executors import check_executor, workers_of
from stickslip.identification.records.fit import RecordFit
from stickslip.identification.results import Fit
from stickslip.quantities import full_path

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

Array = NDArray[np.float64]

WIDE = 20.0
"""Half width of the flat prior, in standard errors, where no bound is nearer."""
BURN_IN = 0.3
"""Share of a chain that is left out."""
STEPS = 400
"""Steps of each walker, if not given."""
LIVE_POINTS = 100
"""Live points, if not given: predictions go with them, and so do the draws, about 15 each."""
ENOUGH = 0.1
"""Nested sampling ends where the live points would change the logarithm of the evidence by less."""
Watch = Callable[[int], object]
"""Called with the predictions so far; answers False to end with the draws there are."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Posterior(metaclass=Described):
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
    runs: int = 0
    """How often the record was predicted."""
    cancelled: bool = False
    """Whether drawing was ended before its end."""

    def interval(self, path: str, level: float = 0.95) -> tuple[float, float]:
        """Return the central interval of a parameter.

        Parameters
        ----------
        path : str
            Path or last name of an unknown.
        level : float
            Probability that it holds.

        Returns
        -------
        (float, float)
            Lower and upper end [SI].

        Raises
        ------
        UnknownNameError
            If it was not drawn.
        """
        column = self.draws[:, self.paths.index(full_path(path, self.paths))]
        low, high = np.quantile(column, [0.5 * (1.0 - level), 0.5 * (1.0 + level)])
        return float(low), float(high)

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the draws as a pandas DataFrame, a column a path."""
        import pandas as pd

        return pd.DataFrame(self.draws, columns=list(self.paths))

    def to_xarray(self) -> "xr.Dataset":
        """Return the draws as an xarray Dataset over ``draw``, a variable a path.

        Raises
        ------
        InputError
            If xarray is not installed.
        """
        require_library("xarray", "xarray", "use to_dataframe")
        import xarray as xr

        columns = {path: ("draw", own) for path, own in zip(self.paths, self.draws.T, strict=True)}
        return xr.Dataset(columns, attrs={"cancelled": int(self.cancelled), "runs": self.runs})


def sample_posterior(
    fit: Fit,
    *,
    sampler: Literal["emcee", "dynesty"] = "emcee",
    steps: int | None = None,
    live_points: int | None = None,
    seed: int = 0,
    executor: Executor | None = None,
    progress: Watch | None = None,
) -> Posterior:
    """Draw from the posterior of a fit with a flat prior within its bounds.

    Residuals are correlated: the likelihood is raised to the share of them that is independent,
    and their size is that at the best values. Unknowns that a bound holds stay there. Stated
    uncertainties of the mechanism move each draw as they move the estimates, to first order.

    Parameters
    ----------
    fit : Fit
        A `RecordFit`, which is drawn around; each draw predicts the whole record once.
    sampler : {"emcee", "dynesty"}
        An ensemble of walkers, or nested sampling, which also finds further modes.
    steps : int, optional
        Steps of each of emcee's walkers, 400 if not given. There are two walkers more than twice
        the unknowns, and each step predicts the record once.
    live_points : int, optional
        Points that dynesty moves inwards, 100 if not given. Predictions go with them: some tens
        for each live point, more where unknowns trade off.
    seed : int
        Of the random numbers.
    executor : concurrent.futures.Executor, optional
        Where emcee's walkers are evaluated at the same time; here if not given. The draws do not
        depend on it. dynesty moves one point after the other and takes none.
    progress : callable, optional
        Called with the number of predictions so far; False ends drawing with the draws so far.

    Returns
    -------
    Posterior
        Draws of all unknowns, and whether the watcher ended them.

    Raises
    ------
    InputError
        If the fit is one of travels or features, or the sampler is not installed, not known, or
        takes no such number.

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
    if not isinstance(fit, RecordFit):
        raise InputError(
            "sample_posterior takes a fit to a record of motion or friction (a RecordFit), got a"
            f" {type(fit).__name__}."
        )
    if sampler not in ("emcee", "dynesty"):
        raise InputError(f"sampler must be 'emcee' or 'dynesty', got {sampler!r}.")
    check_executor(executor)
    if executor is not None and sampler == "dynesty":
        raise InputError("dynesty moves one point after the other: leave executor out.")
    target = _Target(fit)
    chain = _Chain(target, progress, executor)
    count = _count(sampler, steps, live_points, len(target.free))
    library = require_library(sampler, "bayes", "use RecordFit.bootstrap, which needs nothing")
    draw = _walked if sampler == "emcee" else _nested
    random = np.random.default_rng(seed)
    draws = np.array([target.values(row) for row in draw(library, chain, count, random)])
    for moved in fit.inference.held.values():
        draws += random.standard_normal((len(draws), len(moved))) @ moved
    return Posterior(
        paths=fit.free_parameters.paths,
        draws=draws,
        runs=chain.runs,
        cancelled=chain.cancelled,
    )


def _count(sampler: str, steps: int | None, live_points: int | None, free: int) -> int:
    """Return steps or live points; refuse what the sampler has none of, or too few of."""
    given: dict[str, Any] = {"steps": steps, "live_points": live_points}
    name, least, usual = ("steps", 1, STEPS)
    if sampler == "dynesty":  # fewer do not span ellipsoids
        name, least, usual = ("live_points", 2 * free + 2, LIVE_POINTS)
    (other,) = set(given) - {name}
    if given[other] is not None:
        raise InputError(f"{sampler} takes {name}, not {other}: leave {other} out.")
    count = given[name]
    if count is None:
        return max(usual, least)
    whole = isinstance(count, int | np.integer) and not isinstance(count, bool)
    if not whole or count < least:
        raise InputError(not_whole(name, least, count))
    check_size(name, count * (2 * free + 2) * free, "ask for fewer")
    return int(count)


class _Target:
    """The logarithm of the posterior over the coordinates that no bound holds."""

    def __init__(self, fit: RecordFit) -> None:
        self.fit = fit
        self.best = fit.free_parameters.coordinates(fit.values)
        self.free = [
            i for i, path in enumerate(fit.free_parameters.paths) if path not in fit.at_bounds
        ]
        size = np.linalg.norm(fit.scale, axis=0)
        size[size == 0.0] = 1.0  # a logarithm that ran to a bound
        scale = np.linalg.pinv(fit.scale / size) / size[:, None]
        known = np.where(np.isfinite(fit.inference.covariance), fit.inference.covariance, 0.0)
        spread = np.sqrt(np.maximum(np.diag(scale @ known @ scale.T), 0.0))[self.free]
        low, high = (edge[self.free] for edge in fit.free_parameters.limits())
        middle = self.best[self.free]
        # what the record does not depend on may be anywhere within its bounds
        room = np.where(np.isfinite(high - low), (high - low) / (2.0 * WIDE), 1.0)
        self.spread = np.where(spread > 0.0, spread, room)
        self.low = np.maximum(low, middle - WIDE * self.spread)
        self.high = np.minimum(high, middle + WIDE * self.spread)
        rows = len(fit.residual)
        share = min(fit.inference.effective / rows, 1.0)
        self.weight = 0.5 * share * rows / fit.optimum.best.cost

    def values(self, free: Array) -> Array:
        """Return values (p,) for the free coordinates."""
        at = self.best.copy()
        at[self.free] = free
        return self.fit.free_parameters.values(at)

    def within(self, free: Array) -> bool:
        """Whether the prior is not 0 there."""
        return not (np.any(free < self.low) or np.any(free > self.high))

    def __call__(self, rows: Iterable[Array]) -> list[float]:
        """Return the logarithm of the posterior at points within the prior, less its largest."""
        return [self._at(free) for free in rows]

    def _at(self, free: Array) -> float:
        best = self.fit.optimum.best
        seen = self.fit.problem.linearise(self.values(free), best, slopes=False)
        return -self.weight * (seen.cost - best.cost) if math.isfinite(seen.cost) else -1e300


class _Chain:
    """Asks the target here or elsewhere, counts predictions, and tells who watches."""

    def __init__(self, target: _Target, watch: Watch | None, executor: Executor | None) -> None:
        self.target, self.watch, self.executor = target, watch, executor
        self.runs, self.cancelled = 0, False

    def __call__(self, points: Array) -> Any:
        """Return the logarithm of the posterior at a point (p,) or at several (n, p)."""
        rows = np.atleast_2d(points)
        found = np.full(len(rows), -math.inf)
        inside = [place for place, row in enumerate(rows) if self.target.within(row)]
        self.runs += len(inside)
        if self.executor is None:
            found[inside] = self.target(rows[inside])
        else:  # few tasks: the record travels with each
            parts = np.array_split(inside, min(len(inside), workers_of(self.executor)) or 1)
            seen = self.executor.map(self.target, [rows[part] for part in parts if len(part)])
            found[inside] = [value for values in seen for value in values]
        return found if points.ndim == 2 else float(found[0])

    def goes_on(self) -> bool:
        """Tell the watcher how many predictions there were; return whether it wants more."""
        self.cancelled = self.watch is not None and self.watch(self.runs) is False
        return not self.cancelled


def _walked(library: Any, chain: _Chain, steps: int, random: np.random.Generator) -> Array:
    target = chain.target
    size = len(target.free)
    walkers = 2 * size + 2
    start = target.best[target.free] + target.spread * random.normal(size=(walkers, size))
    start = np.clip(start, target.low, target.high)
    sampler = library.EnsembleSampler(walkers, size, chain, vectorize=True)
    sampler.random_state = np.random.RandomState(int(random.integers(2**31))).get_state()
    for _ in sampler.sample(start, iterations=steps):
        if not chain.goes_on():
            break
    found: Array = sampler.get_chain(discard=int(BURN_IN * sampler.iteration), flat=True)
    return found


def _nested(library: Any, chain: _Chain, points: int, random: np.random.Generator) -> Array:
    target = chain.target
    nested = library.NestedSampler(
        chain,
        lambda cube: target.low + cube * (target.high - target.low),
        len(target.free),
        nlive=points,
        rstate=random,
    )
    for _ in nested.sample(dlogz=ENOUGH):
        if not chain.goes_on():
            break
    for _ in nested.add_live_points():  # what the volume that is left consists of
        pass
    found: Array = nested.results.samples_equal(rstate=random)
    return found
