"""Laws fitted to features of stick-slip: the posterior with one law."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits import LAW, Parameters, Watch, starting_law, with_known
from stickslip.identify.kinds.features.result import FeatureFit, result_of
from stickslip.identify.problems.slip_features import features_of, towed
from stickslip.identify.problems.stick_slip import DOUBTS, PulledLaw, Setting, StickSlip
from stickslip.identify.problems.velocity_steps import UNKNOWN
from stickslip.identify.simulated import SimulatedPosterior
from stickslip.mechanisms import Mechanism, TowedBlock
from stickslip.quantities import Quantity, fields_of, full_path, parameters
from stickslip.quantities import vary as with_values
from stickslip.show.formatting import number, percent, quantity


def fit_features(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    seed: int = 0,
    progress: Watch | None = None,
) -> FeatureFit:
    """Fit a law on a towed block to frequency, mean and scatter of the spring's force.

    Limit cycles are simulated; intervals are those of the posterior
    (`stickslip.identify.problems.stick_slip` has the priors). Mass and stiffness are known as is
    stated of them, and what no law has is always in it.

    Parameters
    ----------
    mechanism : TowedBlock
        Nominal mass, stiffness and speed. The load stays the nominal one, whatever the mass.
    law : FrictionLaw or type
        An instance, whose values hold for what is not varied; or a type, for ordinary values.
    measurement : Measurement
        Records with ``time`` and ``spring_force`` [N]; trials with the settings that they override.
        It may state the uncertainty of parameters of the block.
    vary : str or sequence of str, optional
        Parameters to fit, as for `fit`; all others of the law are held. ``"friction.*"``, which is
        all if not given, stands for its levels, speeds and slopes. Mass and stiffness are known to
        5 and 10 % unless an uncertainty is stated; named here, to a factor of ten.
    fixed : mapping of str to float, optional
        Values of parameters that are held, of law and mechanism: mass and stiffness too.
    seed : int
        Seed of the draws.
    progress : callable, optional
        Called with the least root mean square of the rows so far; False ends the search with the
        best so far.

    Returns
    -------
    FeatureFit
        Law, mechanism, estimates with intervals, errors of the features, and sentences.

    Raises
    ------
    InputError
        If the record, the mechanism or a name will not do.
    ConvergenceError
        If no run has a limit cycle.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Coulomb, simulate
    >>> block = TowedBlock(mass=0.03, stiffness=1000.0, speed=4e-3)
    >>> truth = Coulomb(kinetic_coefficient=0.28, static_coefficient=0.32)
    >>> t = np.linspace(0.5, 4.5, 8001)
    >>> run = simulate(block, truth, t_end=4.5).at(t)
    >>> record = Measurement(time=t, spring_force=1000.0 * (4e-3 * t - run["x"]))
    >>> found = fit_features(block, Coulomb, record, vary=["friction.*", "mechanism.mass"])
    >>> abs(found.mechanism.mass / 0.03 - 1.0) < 0.05
    True
    """
    name = law.name
    asked = asked_of(mechanism, {name: law}, measurement, vary, fixed)
    problem = problem_of(asked, measurement)
    posterior = SimulatedPosterior(
        problem, seed=seed, watch=None if progress is None else lambda _, rms: progress(rms)
    )
    return result_of(name, measurement, problem, posterior)


def free_of(law: FrictionLaw | type[FrictionLaw]) -> list[str]:
    """Return the names of the parameters of a law that features are fitted by.

    They are levels, speeds and slopes.

    Examples
    --------
    >>> from stickslip import Coulomb, Viscous
    >>> free_of(Coulomb), free_of(Viscous)
    (['kinetic_coefficient', 'static_coefficient'], ['viscous_coefficient'])
    """
    known = fields_of(law if isinstance(law, type) else type(law))
    return [
        name
        for name, quantity in known.items()
        if quantity.scale in ("level", "force", "speed", "slope")
        and not _stands_on_top(known, quantity)
    ]


def has_level(law: FrictionLaw | type[FrictionLaw]) -> bool:
    """Return whether a law has a level that features may tell."""
    known = fields_of(law if isinstance(law, type) else type(law))
    return any(known[name].scale in ("level", "force") for name in free_of(law))


def _stands_on_top(known: Mapping[str, Quantity], quantity: Quantity) -> bool:
    """Whether a level must not fall below one that itself stands above another."""
    return quantity.at_least is not None and known[quantity.at_least].at_least is not None


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What is looked for: of the laws, and of the block."""

    block: TowedBlock
    laws: Mapping[str, PulledLaw]
    doubts: Mapping[str, float]
    """Prior deviations of logarithms of parameters of the block, by path."""


def asked_of(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw | type[FrictionLaw]],
    measurement: Measurement,
    vary: str | Sequence[str] | None,
    fixed: Mapping[str, float] | None,
) -> Asked:
    """Return what is looked for of laws and block."""
    towed(mechanism)
    found, block, doubts = dict[str, PulledLaw](), towed(mechanism), dict[str, float]()
    for name, law in laws.items():
        chosen = Parameters.of(mechanism, law, vary, fixed, measurement=measurement)
        block = towed(chosen.mechanism)
        doubts = _doubts(block, chosen, measurement)
        start = with_known(_start(block, chosen.law), chosen.known)
        free = (LAW,) if chosen.free is None else chosen.free
        usual = [f"friction.{one}" for one in free_of(start) if one not in chosen.known]
        named = [path for path in free if path != LAW]
        paths = dict.fromkeys([*(usual if LAW in free else ()), *named])
        if not paths:
            raise InputError(
                f"there is nothing to fit: all friction levels and speeds of {start.title} are"
                " fixed; name at least one parameter in vary."
            )
        for path in named:
            _check_start(path, start)
        found[name] = PulledLaw(law=start, free=tuple(paths), given=not isinstance(law, type))
    return Asked(block=block, laws=found, doubts=doubts)


def _check_start(path: str, law: FrictionLaw) -> None:
    name = path.partition(".")[2]
    one = fields_of(type(law))[name]
    if one.scale not in ("level", "force", "speed", "slope"):
        _check_above_zero(path, getattr(law, name) or 0.0)


def _check_above_zero(path: str, value: float) -> None:
    if not value > 0.0:
        raise InputError(f"a fit to features needs a start value above 0 for {path}, got 0.")


def _doubts(
    block: TowedBlock, chosen: "Parameters[Any]", measurement: Measurement
) -> dict[str, float]:
    """Return prior deviations of logarithms of parameters of the block."""
    known = {path: value for path, _, value in parameters(block, "mechanism")}
    stated = {full_path(name, known): error
              for name, error in measurement.parameter_uncertainties.items()}  # fmt: skip
    own = [path for one in measurement.trials for path in one.parameter_uncertainties]
    if own:
        raise InputError(
            f"fits to features take the uncertainty of {own[0]} beside the trials, alike for all:"
            " state it there."
        )
    found = {path: doubt for path, doubt in DOUBTS.items() if path not in chosen.held}
    found |= {path: math.log1p(error / known[path]) for path, error in stated.items()
              if known[path] > 0.0}  # fmt: skip
    for path in chosen.unknown:
        _check_above_zero(path, known[path])
        found[path] = UNKNOWN
    return found


def problem_of(asked: Asked, measurement: Measurement) -> StickSlip:
    """Return records as features with the laws that they are compared with."""
    return StickSlip(asked.block, settings_of(asked.block, measurement), asked.laws, asked.doubts)


def settings_of(block: TowedBlock, measurement: Measurement) -> list[Setting]:
    """Return the records with the block as it was set."""
    found = []
    for record in measurement.records():
        own = replace(block, load=block.steady_load)
        if record.overrides:
            own = towed(with_values(own, "mechanism", record.overrides))
        features = features_of(record, mechanism=own)
        if not features.mean > 0.0:
            raise InputError(
                f"the mean spring force over the load is {number(features.mean)} and must be above"
                " 0: count force and speed positive in the direction of the pull, with a gain such"
                ' as gain={"spring_force": -1}, or correct the offset of the force.'
            )
        found.append(Setting(block=own, features=features))
    if all(one.slides for one in found):
        features = found[0].features
        raise InputError(
            "the force is that of steady sliding: its standard deviation is"
            f" {percent(features.standard_deviation / features.mean)} of its mean, so there is"
            f" no stick-slip to compare. Its mean is friction at {quantity(block.speed, 'm/s')}:"
            " pull at several speeds, and give velocity and friction as a table."
        )
    return found


def _start(block: TowedBlock, law: FrictionLaw | type[FrictionLaw]) -> FrictionLaw:
    """Return a law with a static level and, of a type, bristles stiffer than the spring."""
    load = block.steady_load
    start = starting_law(law, float(load)) if isinstance(law, type) else law
    changes: dict[str, float] = {}
    stiffness = 30.0 * block.stiffness / load  # softer bristles would swing instead of the spring
    sizes = {
        "stiffness": stiffness,
        "damping": math.sqrt(stiffness * block.mass / load),
        "slope": 0.0,
    }
    known = fields_of(type(start))
    for name, one in known.items():
        base, size = one.at_least, sizes.get(one.scale)
        if base is not None and not _stands_on_top(known, one):
            if getattr(start, name) is None:
                changes[f"friction.{name}"] = 1.2 * getattr(start, base)
        elif isinstance(law, type) and size is not None and one.allows(size):
            changes[f"friction.{name}"] = size
    return with_values(start, "friction", changes) if changes else start
