"""Laws of friction that are run on a mechanism: what is looked for of them, with its prior.

A parameter has a coordinate whose prior is normal, by what it is:

    level, surplus over another level, speed, other:  logarithm, about a size of the measurement
    slope:                                            max(z, 0) of a slope, with z about 0
    parameters of the mechanism:                      logarithm, about what is stated

with the deviations `SPREADS`, and of the mechanism those that are stated of it.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.bands import Array
from stickslip.identify.fits import LAW, Estimate, Parameters, with_known
from stickslip.identify.simulated import UNTOLD, FamilyPosterior, Simulated, Unknowns
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, fields_of, full_path, parameters
from stickslip.quantities import vary as with_values

UNKNOWN = math.log(10.0)
"""Prior deviation of the logarithm of a parameter that is looked for: what is given is a guess."""
SPREADS = {"level": 0.5, "surplus": 1.2, "speed": 1.5, "slope": 0.5, "other": 1.5}
"""Prior deviations of coordinates of laws: see above."""
SCALES = ("level", "force", "speed", "slope")
"""Scales of the parameters that are looked for if nothing else is asked for."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RunLaw:
    """A law that is compared: with values of what is held, and what is looked for."""

    law: FrictionLaw
    free: tuple[str, ...]
    """Paths of its parameters that are looked for."""
    given: bool = False
    """Whether its values were given: a search begins there, too."""

    @property
    def quantities(self) -> Mapping[str, Quantity]:
        """What its parameters are, by path."""
        return {f"friction.{name}": item for name, item in fields_of(type(self.law)).items()}

    def above(self, path: str) -> str:
        """Return the path of the parameter that one does not fall below; empty without one."""
        base = self.quantities[path].at_least
        return "" if base is None else f"friction.{base}"

    def kind(self, path: str) -> str:
        """Return what the prior of a parameter goes by."""
        one = self.quantities[path]
        if one.at_least is not None:
            return "surplus"
        scale = "level" if one.scale == "force" else one.scale.rstrip("+-")
        return scale if scale in SPREADS else "other"

    def held(self, path: str) -> float:
        """Return the value of a parameter that is held."""
        return float(getattr(self.law, path.partition(".")[2]) or 0.0)


def usual_of(law: FrictionLaw | type[FrictionLaw]) -> list[str]:
    """Return the names of the parameters that are looked for: levels, speeds and slopes.

    Examples
    --------
    >>> from stickslip import Coulomb, Viscous
    >>> usual_of(Coulomb), usual_of(Viscous)
    (['kinetic_coefficient', 'static_coefficient'], ['viscous_coefficient'])
    """
    known = fields_of(law if isinstance(law, type) else type(law))
    return [name for name, item in known.items()
            if item.scale in SCALES and not stands_on_top(known, item)]  # fmt: skip


def stands_on_top(known: Mapping[str, Quantity], quantity: Quantity) -> bool:
    """Return whether a level must not fall below one that itself stands above another."""
    return quantity.at_least is not None and known[quantity.at_least].at_least is not None


def laws_to_run(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw | type[FrictionLaw]],
    measurement: Measurement,
    vary: str | Sequence[str] | None,
    fixed: Mapping[str, float] | None,
    *,
    start: Callable[[Any, FrictionLaw | type[FrictionLaw]], FrictionLaw],
    doubts: Mapping[str, float],
) -> tuple[Any, dict[str, RunLaw], dict[str, float]]:
    """Return the mechanism, what is looked for of laws, and how surely the mechanism is known.

    Values of a law that is to `start` are those of a function of the mechanism and the law.
    Parameters of the mechanism have prior `doubts` if nothing is stated of them.
    """
    result, block, surely = dict[str, RunLaw](), mechanism, dict[str, float]()
    for name, law in laws.items():
        chosen = Parameters.of(mechanism, law, vary, fixed, measurement=measurement)
        block, surely = chosen.mechanism, _doubts(chosen, measurement, doubts)
        begun = with_known(start(block, chosen.law), chosen.known)
        free = (LAW,) if chosen.free is None else chosen.free
        usual = [f"friction.{item}" for item in usual_of(begun) if item not in chosen.known]
        named = [path for path in free if path != LAW]
        paths = dict.fromkeys([*(usual if LAW in free else ()), *named])
        if not paths:
            raise InputError(
                f"there is nothing to fit: all friction levels and speeds of {begun.title} are"
                " fixed; name at least one parameter in vary."
            )
        one = RunLaw(law=begun, free=tuple(paths), given=not isinstance(law, type))
        for path in named:
            if one.quantities[path].scale not in SCALES:
                _check_above_zero(path, one.held(path))
        result[name] = one
    return block, result, surely


def _check_above_zero(path: str, value: float) -> None:
    if not value > 0.0:
        raise InputError(f"a fit by runs needs a start value above 0 for {path}, got 0.")


def _doubts(
    chosen: "Parameters[Any]", measurement: Measurement, usual: Mapping[str, float]
) -> dict[str, float]:
    """Return prior deviations of logarithms of parameters of the mechanism."""
    known = {path: value for path, _, value in parameters(chosen.mechanism, "mechanism")}
    stated = {full_path(name, known): error
              for name, error in measurement.parameter_uncertainties.items()}  # fmt: skip
    own = [path for trial in measurement.trials for path in trial.parameter_uncertainties]
    if own:
        raise InputError(
            f"fits by runs take the uncertainty of {own[0]} beside the trials, alike for all:"
            " state it there."
        )
    result = {path: doubt for path, doubt in usual.items() if path not in chosen.held}
    result |= {path: math.log1p(error / known[path]) for path, error in stated.items()
              if known[path] > 0.0}  # fmt: skip
    for path in chosen.unknown:
        _check_above_zero(path, known[path])
        result[path] = UNKNOWN
    return result


class LawRuns(Simulated):
    """Laws of friction on a mechanism, about sizes of what was measured.

    Parameters
    ----------
    mechanism : Mechanism
        As it is stated.
    laws : mapping of str to RunLaw
        What is compared.
    doubts : mapping of str to float
        Prior deviations of logarithms of parameters of the mechanism, by path.
    sizes : mapping of str to float
        Prior medians of a ``"level"``, a ``"surplus"`` over it and a ``"speed"``, and the unit of a
        ``"slope"``, all SI.
    load : float
        Normal force [N] over which levels are.
    """

    alike: str = "other values give the same readings"
    """Why a parameter is not bounded of which rows tell nothing."""

    def __init__(
        self,
        mechanism: Any,
        laws: Mapping[str, RunLaw],
        doubts: Mapping[str, float],
        *,
        sizes: Mapping[str, float],
        load: float,
    ) -> None:
        self.mechanism, self.laws, self.sizes, self.load = mechanism, laws, sizes, load
        self.doubts = {path: doubt for path, doubt in doubts.items() if doubt > 0.0}
        self.given = {path: value for path, _, value in parameters(mechanism, "mechanism")}
        least = min(len(law.free) for law in laws.values())
        simple = [name for name, law in laws.items() if len(law.free) == least]
        stages = simple, [name for name in laws if name not in simple]
        self.stages = tuple(stage for stage in stages if stage)

    def prior(self, family: str) -> float:
        return 0.0

    def _coordinate(self, family: str, path: str) -> tuple[float, float]:
        """Return the prior mean and the deviation of a coordinate."""
        if path in self.doubts:
            return math.log(self.given[path]), self.doubts[path]
        law = self.laws[family]
        kind = law.kind(path)
        if kind == "slope":
            return 0.0, SPREADS[kind]
        unit = self.load if law.quantities[path].scale == "force" else 1.0
        middle = abs(law.held(path)) if kind == "other" else self.sizes[kind] * unit
        return math.log(middle), SPREADS[kind]

    def paths(self, family: str) -> tuple[str, ...]:
        """Return the paths of what is unknown of a family: those of the law, then the others."""
        return (*self.laws[family].free, *self.doubts)

    def vary(self, family: str) -> Unknowns:
        numbers = np.array([self._coordinate(family, path) for path in self.paths(family)])
        numbers = numbers.reshape(-1, 2)
        return Unknowns(names=self.paths(family), mean=numbers[:, 0], deviation=numbers[:, 1])

    def values(self, family: str, points: Array) -> dict[str, Array]:
        """Return values (k,) by path, SI, at points (k, p); of the mechanism those as stated."""
        law, results = self.laws[family], dict[str, Array]()
        steep = self.sizes["slope"]
        for path, x in zip(self.paths(family), points.T, strict=True):
            slope = path not in self.doubts and law.kind(path) == "slope"
            results[path] = steep * np.maximum(x, 0.0) if slope else np.exp(np.minimum(x, 50.0))
        for path in law.free:
            if above := law.above(path):
                results[path] = results[path] + results.get(above, law.held(above))
        return results

    def _point(self, family: str, values: Mapping[str, float]) -> Array:
        """Return the point (p,) with some values, and the prior's for the others."""
        law, point = self.laws[family], []
        for path in self.paths(family):
            x = values.get(path)
            kind = "log" if path in self.doubts else law.kind(path)
            if x is not None and kind == "surplus":
                x = x - values.get(law.above(path), law.held(law.above(path)))
            if kind == "slope":
                point.append(0.01 if x is None else max(x / self.sizes["slope"], 0.01))
            elif x is None or x <= 0.0:
                point.append(self._coordinate(family, path)[0])
            else:
                point.append(math.log(x))
        return np.array(point)

    def tried(self, family: str) -> list[dict[str, float]]:
        """Return values by path at which searches begin."""
        return [{}]

    def starts(self, family: str, ends: Mapping[str, Array]) -> Array:
        law, tried = self.laws[family], self.tried(family)
        for name, end in ends.items():
            values = {path: float(x[0]) for path, x in self.values(name, end[None]).items()}
            tried.append({path: x for path, x in values.items() if path in self.paths(family)})
        if law.given:
            tried.append({path: law.held(path) for path in law.free})
        return np.unique([self._point(family, item) for item in tried], axis=0)

    # ------------------------------------------------------------------ results
    def title(self, family: str) -> str:
        return self.laws[family].law.title

    def quantities(self, family: str) -> Mapping[str, Quantity]:
        own = {path: item for path, item, _ in parameters(self.mechanism, "mechanism")}
        return {**own, **self.laws[family].quantities}

    def read(self, family: str, points: Array, coefficients: Array) -> dict[str, Array]:
        return self.values(family, points)

    def result(self, family: str, values: Mapping[str, float]) -> tuple[FrictionLaw, Mechanism]:
        own = {path: x for path, x in values.items() if path.startswith("mechanism.")}
        others = {path: x for path, x in values.items() if path not in own}
        law = with_values(self.laws[family].law, "friction", others)
        return law, with_values(self.mechanism, "mechanism", own)

    def told(
        self, family: FamilyPosterior, name: str, estimates: Sequence[Estimate]
    ) -> list[Estimate]:
        return [
            replace(item, low=-math.inf, high=math.inf, reason=self.alike)
            if item.path not in self.doubts and self._is_prior(family, name, item.path)
            else item
            for item in estimates
        ]

    def _is_prior(self, family: FamilyPosterior, name: str, path: str) -> bool:
        """Whether draws are as wide as the prior; of a level above another, as that of levels."""
        if self.laws[name].kind(path) != "surplus":
            return family.is_prior(path)
        draws = np.log(self.values(name, family.points)[path])
        return float(np.std(draws)) > UNTOLD * SPREADS["level"]
