"""Selection by features of stick-slip: laws weighed by one posterior, the most probable named.

What to measure next is what tells most of what is asked. That is which law holds, where some are
not told apart: draws of each, as many of one as of another, are run at other settings, and by
linear regression of which law a draw is of on logarithms of its features, with what differs from
run to run, a share 1 - R^2 of the variance is left. Else it is the parameters of the law.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from stickslip.data import Checks, Measurement
from stickslip.errors import ConvergenceError, InputError
from stickslip.friction import Coulomb, CoulombViscous, FrictionLaw, Stribeck
from stickslip.identify.bands import Array
from stickslip.identify.candidates import Watch, specifications
from stickslip.identify.fits import LAW, Parameters, RecordSettings
from stickslip.identify.judgement import RIVAL
from stickslip.identify.kinds.features.fit import asked_of, has_level, problem_of
from stickslip.identify.kinds.features.result import FeatureFit, result_of
from stickslip.identify.kinds.features.verdict import (
    FeatureCandidate,
    FeatureVerdict,
    OtherSetting,
)
from stickslip.identify.kinds.features.wording import feature_wording, outcomes
from stickslip.identify.problems.slip_features import COMPARED, READ
from stickslip.identify.problems.stick_slip import StickSlip
from stickslip.identify.selection import checked
from stickslip.identify.simulated import ENOUGH, SimulatedPosterior
from stickslip.mechanisms import Mechanism, TowedBlock
from stickslip.quantities import vary as with_values

USUAL: tuple[type[FrictionLaw], ...] = (Coulomb, CoulombViscous, Stribeck)
"""Laws that are compared where none is named. Features hardly tell bristles, whose stiffness nobody
knows: laws with them are judged where they are named."""
NO_LEVEL = "it has no friction level that these features could determine"
OTHERS = {
    "speed": (0.03, 0.1, 0.3, 0.5, 2.0, 3.0, 10.0),
    "stiffness": (0.3, 3.0),
    "load": (0.5, 2.0),
}
"""Settings that are looked at as the next, over those of the first record."""


def feature_laws(
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
) -> Mapping[str, FrictionLaw | type[FrictionLaw]]:
    """Return the candidates by name: those given, or Coulomb, Coulomb + viscous and Stribeck.

    Examples
    --------
    >>> [*feature_laws(None)]
    ['coulomb', 'coulomb-viscous', 'stribeck']
    """
    return {one.name: one.law for one in specifications(USUAL if laws is None else laws)}


def select_features(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    validate: Measurement | None = None,
    settings: RecordSettings | None = None,
    progress: Watch | None = None,
) -> FeatureVerdict:
    """Select a law for the force of a spring that pulls a block; arguments as in `select`.

    Parameters
    ----------
    mechanism : Mechanism
        A `TowedBlock` with nominal mass, stiffness and speed.
    laws : mapping of str to FrictionLaw or sequence of FrictionLaw or type or str or None
        The candidates; Coulomb, Coulomb + viscous and Stribeck if None.
    measurement : Measurement
        Records with time and spring_force [N], such as trials at several speeds.
    vary : str or sequence of str, optional
        Parameters of the mechanism to fit too, by path or last name.
    fixed : mapping of str to float, optional
        Values of parameters of the mechanism that are held [SI].
    validate : Measurement, optional
        A second record, which no fit sees.
    settings : RecordSettings, optional
        Gives the seed of the draws.
    progress : callable, optional
        Called with the name of a law and the least residual so far; False ends the search with the
        best so far.

    Returns
    -------
    FeatureVerdict
        Candidates, the law to use, what to measure next, and sentences.

    Raises
    ------
    InputError
        If no law has a level, or a record or the mechanism will not do.
    """
    chosen = feature_laws(laws)
    checks = checked(mechanism, measurement, validate)
    tried = {name: law for name, law in chosen.items() if has_level(law)}
    if not tried:
        raise InputError(f"no candidate can be judged on this record: {NO_LEVEL}.")
    unknown = Parameters.of(mechanism, None, vary, fixed, measurement=measurement).unknown
    asked = asked_of(mechanism, tried, measurement, [LAW, *unknown], fixed)
    problem = problem_of(asked, measurement)
    seed = 0 if settings is None else settings.seed
    posterior = SimulatedPosterior(problem, seed=seed, watch=progress)
    every = [
        _candidate(name, measurement, problem, posterior, validate)
        if name in tried
        else FeatureCandidate(name=name, title=chosen[name].title, fit=None, dropped=NO_LEVEL)
        for name in chosen
    ]
    return _verdict(mechanism, measurement, every, problem, checks)


def _candidate(
    name: str,
    measurement: Measurement,
    problem: StickSlip,
    posterior: SimulatedPosterior,
    validate: Measurement | None,
) -> FeatureCandidate:
    """Return a candidate with its fit; one that cannot be fitted is kept with the reason."""
    title = problem.laws[name].law.title
    try:
        fit = result_of(name, measurement, problem, posterior)
    except ConvergenceError as error:
        return FeatureCandidate(name=name, title=title, fit=None, dropped=str(error))
    second = {} if validate is None else fit.judged(validate)
    return FeatureCandidate(
        name=name, title=title, fit=fit, share=posterior.shares[name], second=second
    )


def _verdict(
    mechanism: Mechanism,
    measurement: Measurement,
    every: Sequence[FeatureCandidate],
    problem: StickSlip,
    checks: Checks,
) -> FeatureVerdict:
    if all(one.fit is None for one in every):
        raise ConvergenceError(
            "no candidate has a limit cycle that can be compared with this record: "
            + "; ".join(f"{one.title}: {one.dropped}" for one in every)
        )
    ordered = sorted(every, key=lambda one: (one.fit is None, -one.share))
    closest = ordered[0]
    rivals = [one for one in ordered[1:] if one.fit and one.share * RIVAL > closest.share]
    assert closest.fit is not None
    told = outcomes(ordered, rivals)
    others = other_settings([closest.fit, *(one.fit for one in rivals if one.fit)])
    return FeatureVerdict(
        mechanism=mechanism,
        measurement=measurement,
        words=feature_wording(told, rivals, checks, others),
        candidates=tuple(told),
        best=None if closest.fit.missed else told[0],
        ranked=len(told) > 1 and not rivals,
        features=problem.first.features,
        checks=checks,
        rivals=tuple(one.name for one in rivals),
        settings=others,
    )


def other_settings(fits: Sequence[FeatureFit]) -> tuple[OtherSetting, ...]:
    """Return what the closest law and its rivals predict elsewhere, the most telling first."""
    first = fits[0].problem.first
    asked, blocks = [], []
    for name, factors in OTHERS.items():
        for factor in factors:
            value = factor * float(getattr(first.block, name))
            block: TowedBlock = with_values(first.block, "mechanism", {f"mechanism.{name}": value})
            if all(block != one.block for one in fits[0].problem.settings):
                asked.append((name, value))
                blocks.append(block)
    drawn = [one.foreseen(blocks, int(ENOUGH)) for one in fits]
    chosen = np.linspace(0, len(fits[0].family.points) - 1, int(ENOUGH)).astype(np.intp)
    own = fits[0].family.points[chosen, : len(fits[0].problem.laws[fits[0].name].free)]
    found = []
    for k, (name, value) in enumerate(asked):
        rows = [features[:, k] for features in drawn]
        works = [np.isfinite(one).all(axis=1) for one in rows]
        if not min(float(np.mean(one[:, 0] > 0.0)) for one in rows) > 0.8:  # NaN is no cycle
            continue  # a record of steady sliding has no features
        predicted = {
            fit.name: dict(zip(COMPARED, np.median(one[ok], axis=0).tolist(), strict=True))
            for fit, one, ok in zip(fits, rows, works, strict=True)
        }
        seen = np.concatenate([one[ok] for one, ok in zip(rows, works, strict=True)])
        label = np.repeat(np.arange(len(fits)), [int(ok.sum()) for ok in works])
        of = (label[:, None] == np.arange(1, len(fits))).astype(float)
        q = of if len(fits) > 1 else own[works[0]]
        left = _left(q, np.log(np.maximum(seen, READ * first.features.compared)))
        found.append(OtherSetting(name=name, value=value, predicted=predicted, left=left))
    return tuple(sorted(found, key=lambda one: one.left))


def _left(q: Array, seen: Array) -> float:
    """Return the width of what is asked (k, m) over that of now, by regression on what is seen."""
    z = np.column_stack([np.ones(len(seen)), seen, seen**2])
    off = z - z.mean(axis=0)
    scale = off.std(axis=0)
    z = np.column_stack([np.ones(len(seen)), off[:, scale > 0.0] / scale[scale > 0.0]])
    rest = q - z @ np.linalg.lstsq(z, q, rcond=1e-9)[0]
    free = max(len(seen) - z.shape[1], 1) / len(seen)
    parts = rest.var(axis=0) / np.maximum(free * q.var(axis=0), 1e-300)
    return math.sqrt(min(float(parts.mean()), 1.0))
