r"""What only runs tell of a mechanism, found before its force balance is judged.

A balance is blind where forces are not linear in what is looked for, as in the resistance of a
motor that a voltage drives: noise of the velocity, the steps of an encoder and friction that the
plain balance lacks all move it. Runs are not. With the parameters :math:`\theta` of a wide law and
of the mechanism, readings :math:`y` and what segments with free starts :math:`s` predict of them,

.. math::
    \min_{\theta, s}\ \frac{\kappa}{\sigma^2} \lVert y - f(\theta, s) \rVert^2
        + \sum_i \frac{(\log \theta_i - \log \theta_{0i})^2}{\tau^2} ,

where :math:`\theta_0` is what was given and :math:`\tau` is `PRIOR`.

1. Steps of Levenberg and Marquardt along the sensitivities of the engine lead there, until one
   would raise the logarithm of the posterior by less than `SETTLED`.
2. The deviation :math:`\sigma` of a reading, and the share :math:`\kappa` of readings that count as
   independent (`problems.free_runs.worth`), are taken again from what is left, `ROUNDS` times.
3. The curvature there is the precision of :math:`\theta`, about which the balance is then judged.

Where this leaves a parameter nearly as open as it was, runs tell no more than a balance does.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip.data import Measurement
from stickslip.friction import BamM4
from stickslip.identify.fits import (
    FreeParameters,
    Hold,
    Parameters,
    RecordSettings,
    ResidualJacobian,
    RouteChoice,
    Shooting,
    Wanted,
    improve,
    simulated,
)
from stickslip.identify.posterior import Array
from stickslip.identify.problems.free_runs import ROUNDED, worth
from stickslip.identify.problems.record_model import KAPPA
from stickslip.identify.problems.record_signals import Record, records_of
from stickslip.identify.simulated import SETTLED
from stickslip.mechanisms import Mechanism, motor_of
from stickslip.quantities import parameters, vary
from stickslip.show.formatting import joined

PRIOR = 0.5
"""Standard deviation of the logarithm of a parameter about the value that was given of it."""
TOLD = 0.5
"""Deviation after the runs over that before, beyond which they tell next to nothing."""
ROUNDS = 3
"""Times that the deviation of readings is taken again."""
STEPS = 10
"""Steps of an initial state at each: where a body sticks and slips there are many, and long."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Refined:
    """Parameters of a mechanism by runs."""

    values: Mapping[str, float]
    """By path."""
    covariance: Array
    """Of the values, in their order (p, p)."""

    @property
    def sentence(self) -> str:
        """What is said of the values."""
        names = joined([path.removeprefix("mechanism.") for path in self.values])
        return (
            f"Runs of the mechanism with friction of a gear determine {names}; the force balance"
            " determines friction with these values."
        )

    def on(self, mechanism: Mechanism) -> Mechanism:
        """Return a mechanism with the values."""
        return vary(mechanism, "mechanism", self.values)

    def known(self, records: Sequence[Record]) -> list[Record]:
        """Return records whose parameters count from the values, with the covariance as prior.

        Of its root :math:`L` each column is what one of them, and others with it, changes by.
        """
        paths, root = [*self.values], np.linalg.cholesky(self.covariance)
        result = []
        for record in records:
            own = dict(record.unknown)
            for j, path in enumerate(paths):
                parts = [(root[i, j], record.unknown[other]) for i, other in enumerate(paths)]
                own[path] = replace(
                    record.unknown[path],
                    force=np.sum([share * item.force for share, item in parts], axis=0),
                    inertia=float(sum(share * item.inertia for share, item in parts)),
                    along=dict(zip(paths, root[:, j].tolist(), strict=True)),
                )
            result.append(replace(record, unknown=own))
        return result


@dataclass(frozen=True, kw_only=True, eq=False)
class _WithPrior:
    """Residuals of runs, and rows of what is known before."""

    runs: Shooting
    given: Array
    """Values that were given (p,)."""
    sizes: Array
    """Deviations of their logarithms (p,); infinite of those without."""
    deviation: float
    """Deviation of a reading that would be independent of others."""

    @property
    def free_parameters(self) -> FreeParameters:
        """What is looked for."""
        return self.runs.free_parameters

    def _slopes(self, values: Array) -> Array:
        """Return how many deviations a unit of each value is, of those that were given (k, p)."""
        told = np.isfinite(self.sizes)
        scale = np.ones(len(values))
        scale[told] = self.sizes[told] * values[told]
        return np.asarray(np.eye(len(values))[told] / scale)

    def precision(self, values: Array) -> Array:
        """Return what is known before, as a precision about values (p, p)."""
        slopes = self._slopes(values)
        return np.asarray(slopes.T @ slopes)

    def linearise(self, values: Array, near: ResidualJacobian | None = None) -> ResidualJacobian:
        """Return residuals at values (p,), with one row for each that was given."""
        seen = self.runs.linearise(values, near)
        slopes, told = self._slopes(values), np.isfinite(self.sizes)
        off = np.log(self.given[told] / values[told]) / self.sizes[told]
        return ResidualJacobian(
            values=values,
            residual=np.concatenate([seen.residual, self.deviation * off]),
            slopes=lambda: np.vstack([seen.slopes, self.deviation * slopes]),
            segment=np.concatenate([seen.segment, np.full(len(off), -1)]),
            memory=seen.memory,
        )


def refined(
    mechanism: Mechanism,
    measurement: Measurement,
    unknown: Sequence[str],
    *,
    hold: Hold | None = None,
) -> Refined | None:
    """Return what runs tell of a motor and what it turns; None where a balance tells as much.

    That is so where there is no motor, where forces are linear in what is looked for, and where
    runs do not tell parameters apart either, as resistance and torque constant are not under
    friction that is the same at any torque.
    """
    if not unknown or motor_of(mechanism) is None:
        return None
    columns = records_of(mechanism, measurement, unknown=unknown)[0].unknown
    if not any(column.bent for column in columns.values()):
        return None
    unknown = [path for path in unknown if path in columns]  # a constant force is always sought
    wanted: Wanted = Parameters(
        mechanism=mechanism, law=BamM4, known={"fading_exponent": 1.0}, unknown=tuple(unknown)
    )
    choice = RouteChoice.of(mechanism, measurement, RecordSettings(hold=hold))
    problem = replace(simulated(choice, wanted, measurement, {}).problem, steps=STEPS)
    free = problem.free_parameters
    known = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    looked = [k for k, item in enumerate(free.items) if item.path in unknown]
    given = np.array([known.get(path, 1.0) for path in free.paths])
    sizes = np.full(len(free), math.inf)
    sizes[[k for k in looked if free.items[k].log]] = PRIOR
    best, share = problem.linearise(free.start), 1.0
    for _ in range(ROUNDS):
        deviation = best.rms / math.sqrt(share)
        prior = _WithPrior(runs=problem, given=given, sizes=sizes, deviation=deviation)
        end, _ = improve(prior, best.values, least=2.0 * SETTLED * deviation**2)
        best = problem.linearise(end.values, end)
        share = min(
            worth(best.slopes / best.rms, best.residual, prior.precision(end.values)), KAPPA
        )
    table = end.slopes / deviation
    every: Array = np.linalg.pinv(table.T @ table, hermitian=True).astype(float)
    covariance = every[np.ix_(looked, looked)]
    left = np.sqrt(np.diag(prior.precision(end.values)) * np.diag(every))
    if np.any(left > TOLD) or not is_positive(covariance):
        return None
    values = {free.paths[k]: float(end.values[k]) for k in looked}
    return Refined(values=values, covariance=covariance)


def is_positive(covariance: Array) -> bool:
    """Return whether a covariance (p, p) is one of values that all are open."""
    size = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    return bool(np.linalg.eigvalsh(covariance / np.outer(size, size))[0] > ROUNDED)
