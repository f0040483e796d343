"""Designs of campaigns, and sensitivity indices: how much of an output each factor explains.

A design gives points of the unit cube, which each factor turns into values by the inverse of its
distribution. Any rows are made without those before them: of a grid by division with remainder, of
random numbers and of a scrambled Sobol sequence by going ahead to the first. Samples for indices
are made as wholes.

Indices of Sobol split the variance of y = f(x_1, ..., x_k):

    S_i = Var(E[y | x_i]) / Var(y),      S_Ti = 1 - Var(E[y | all but x_i]) / Var(y),

from the sample of Saltelli, k + 2 runs for each of n base points (Saltelli et al., Comput. Phys.
Commun. 181, 2010). Those of Morris are means and spreads of elementary effects along trajectories
of k + 1 runs (Morris, Technometrics 33, 1991; Campolongo et al., Environ. Model. Softw. 22, 2007).
Shares of drawn parameters, of a band, are first-order indices from the runs as they are, by
RBD-FAST (Tarantola et al., Reliab. Eng. Syst. Saf. 91, 2006), where no two of the parameters vary
together. Indices are computed by SALib.
"""

import functools
import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import special
from scipy.stats import qmc

from stickslip.errors import InputError, ParameterError, check_size, not_whole
from stickslip.show.described import Described
from stickslip.show.display import OnAxes, Summary, Tabular, require_library
from stickslip.show.formatting import number

if TYPE_CHECKING:
    import pandas as pd


Array: TypeAlias = NDArray[np.float64]
DesignName: TypeAlias = Literal["grid", "random", "sobol", "saltelli", "morris"]
DESIGNS: Final = ("grid", "random", "sobol", "saltelli", "morris")
OF_INDICES: Final = ("saltelli", "morris")
"""Designs from whose runs sensitivity indices are computed."""
MOST_RUNS: Final = 1 << 30
"""Runs of a design: points that a Sobol sequence of 30 bits has."""
MORRIS_LEVELS: Final = 4


@dataclass(frozen=True, kw_only=True)
class Factor(ABC, metaclass=Described):
    """What a parameter is varied over."""

    times: str = ""
    """Path of another factor that the values are multiplied by; none if empty."""

    @abstractmethod
    def at(self, share: Array) -> Array:
        """Return the values (n,) below which these shares (n,) of the distribution lie."""

    def levels(self) -> Array:
        """Return the values (m,) of a grid."""
        raise InputError(f"a grid needs the values, or how many between two ends, got {self!r}.")


@dataclass(frozen=True, kw_only=True)
class Levels(Factor):
    """Values that are given; other designs than grids take each as often as the others.

    Examples
    --------
    >>> Levels(values=(1.0, 2.0)).at(np.array([0.1, 0.6])).tolist()
    [1.0, 2.0]
    """

    values: Sequence[float]
    """The values [SI]."""

    def __post_init__(self) -> None:
        """Check that they are numbers."""
        given = np.asarray(self.values, dtype=np.float64)
        if given.ndim != 1 or not given.size or not np.isfinite(given).all():
            raise ParameterError(f"values must be finite numbers, at least one, got {self.values}.")
        object.__setattr__(self, "values", tuple(given.tolist()))

    def at(self, share: Array) -> Array:
        count = len(self.values)
        # A share of exactly 1 belongs to the last value.
        places = np.minimum((share * count).astype(np.intp), count - 1)
        result: Array = self.levels()[places]
        return result

    def levels(self) -> Array:
        return np.array(self.values)


@dataclass(frozen=True, kw_only=True)
class Uniform(Factor):
    """Values between two ends, evenly spread, or their logarithms.

    Examples
    --------
    >>> Uniform(low=0.01, high=1.0, number=3, log=True).levels().round(6).tolist()
    [0.01, 0.1, 1.0]
    """

    low: float
    """Lower end [SI]."""
    high: float
    """Upper end [SI]."""
    number: int | None = None
    """Values of a grid, both ends included."""
    log: bool = False
    """Whether the logarithms are evenly spread."""

    def __post_init__(self) -> None:
        """Check the ends."""
        if not -math.inf < self.low < self.high < math.inf:
            raise ParameterError(f"low must be below high, got {self.low} and {self.high}.")
        if self.log and self.low <= 0.0:
            raise ParameterError(f"low must be above 0 on a logarithmic scale, got {self.low}.")
        if self.number is not None and (type(self.number) is not int or self.number < 2):
            raise ParameterError(not_whole("number", 2, self.number))

    def at(self, share: Array) -> Array:
        ends = (self.low, self.high)
        if self.log:
            low, high = np.log(ends)
            result = np.exp(low + share * (high - low))
        else:
            result = self.low + share * (self.high - self.low)
        # Rounding must not put a value beyond an end that a parameter may not exceed.
        inside: Array = np.clip(result, *ends)
        return inside

    def levels(self) -> Array:
        if self.number is None:
            return super().levels()
        return self.at(np.linspace(0.0, 1.0, self.number))


@dataclass(frozen=True, kw_only=True)
class Normal(Factor):
    """Values of a normal distribution, cut off at two ends if they are given.

    Examples
    --------
    >>> Normal(mean=2.0, sd=0.1).at(np.array([0.025, 0.5])).round(3).tolist()
    [1.804, 2.0]
    """

    mean: float
    """Mean of the distribution before it is cut off [SI]."""
    sd: float
    """Its standard deviation [SI]."""
    low: float = -math.inf
    """Lower end [SI]."""
    high: float = math.inf
    """Upper end [SI]."""

    def __post_init__(self) -> None:
        """Check that there is a distribution."""
        if not (math.isfinite(self.mean) and 0.0 < self.sd < math.inf):
            raise ParameterError(f"sd must be above 0, got {self.sd} about {self.mean}.")
        below, above = special.ndtr((np.array([self.low, self.high]) - self.mean) / self.sd)
        if not above > below:
            raise ParameterError(
                f"low to high must hold a part of the distribution, got {self.low} to {self.high}"
                f" about {self.mean} with sd {self.sd}."
            )

    def at(self, share: Array) -> Array:
        # Cut off: shares are of what lies between the ends.
        below, above = special.ndtr((np.array([self.low, self.high]) - self.mean) / self.sd)
        least = np.finfo(float).tiny  # the end of a distribution without one
        inside = np.clip(below + share * (above - below), least, 1.0 - np.finfo(float).eps)
        result: Array = np.clip(self.mean + self.sd * special.ndtri(inside), self.low, self.high)
        return result


@dataclass(frozen=True, kw_only=True)
class Design(metaclass=Described):
    """Values of all factors in each run, made when they are asked for.

    Examples
    --------
    >>> design = Design(factors={"a": Levels(values=(1, 2)), "b": Levels(values=(5, 6, 7))})
    >>> len(design), design.rows(2, 4)
    (6, {'a': array([1., 2.]), 'b': array([7., 5.])})
    """

    factors: Mapping[str, Factor]
    """By path."""
    kind: DesignName = "grid"
    """All combinations, random numbers, a scrambled Sobol sequence, or what sensitivity indices
    need: the sample of Saltelli for those of Sobol, trajectories for those of Morris."""
    runs: int | None = None
    """Runs at most; a grid has as many as there are combinations."""
    seed: int = 0
    """Of the random numbers, and of the scrambling."""

    def __post_init__(self) -> None:
        """Check that the design has runs, and can have so many."""
        if self.kind not in DESIGNS:
            raise InputError(f"design must be one of {', '.join(DESIGNS)}, got {self.kind!r}.")
        if not self.factors:
            raise InputError("a campaign varies at least one parameter, got none.")
        if self.kind == "grid" and self.runs is not None:
            raise InputError("a grid has as many runs as combinations: leave runs out.")
        if self.kind != "grid" and (type(self.runs) is not int or self.runs < 1):
            raise InputError(f"a {self.kind} design needs runs. {not_whole('runs', 1, self.runs)}")
        if type(self.seed) is not int or self.seed < 0:
            raise InputError(not_whole("seed", 0, self.seed))
        for path, factor in self.factors.items():
            # One step only: no chains of multiples, which might be circles.
            other = self.factors.get(factor.times)
            if factor.times and (other is None or other.times):
                raise InputError(
                    f"{path} is {factor.times!r} times a factor, which must be another factor of"
                    " the campaign that is no multiple itself."
                )
            endless = isinstance(factor, Normal) and not factor.high - factor.low < math.inf
            if self.kind == "morris" and endless:
                raise InputError(f"Morris trajectories need low and high of {path}.")
        least = self.block
        if self.runs is not None and self.runs < least:
            raise InputError(f"a {self.kind} design of these factors has at least {least} runs.")
        check_size("campaign", len(self), "vary fewer values", unit="runs", most=MOST_RUNS)

    @property
    def block(self) -> int:
        """Runs that sensitivity indices take together: a base point, or a trajectory."""
        return {"saltelli": len(self.factors) + 2, "morris": len(self.factors) + 1}.get(
            self.kind, 1
        )

    def __len__(self) -> int:
        """Return the number of runs."""
        if self.kind == "grid":
            return math.prod(len(factor.levels()) for factor in self.factors.values())
        assert self.runs is not None
        blocks = self.runs // self.block
        if self.kind == "saltelli":  # a Sobol sequence is balanced at powers of two only
            blocks = 1 << (blocks.bit_length() - 1)
        return blocks * self.block

    def shares(self, start: int, stop: int) -> Array:
        """Return points of the unit cube.

        Parameters
        ----------
        start, stop : int
            First run, and the one after the last.

        Returns
        -------
        array (runs, factors)
            Shares of the distributions of the factors.
        """
        many = len(self.factors)
        if self.kind == "random":  # a number each, so that no run depends on where a part begins
            random = np.random.PCG64(self.seed)
            random.advance(start * many)
            return np.random.Generator(random).random((stop - start, many))
        if self.kind == "sobol":
            sequence = qmc.Sobol(many, rng=np.random.default_rng(self.seed))
            if start:
                sequence.fast_forward(start)
                points: Array = sequence.random(stop - start)
            else:  # that many first points are balanced
                points = sequence.random_base2((stop - 1).bit_length())[:stop]
            return points
        return _sampled(self.kind, many, len(self) // self.block, self.seed)[start:stop]

    def rows(self, start: int, stop: int) -> dict[str, Array]:
        """Return the values that runs take.

        Parameters
        ----------
        start, stop : int
            First run, and the one after the last.

        Returns
        -------
        dict of str to array (runs,)
            Values of each factor [SI].
        """
        # The last part of a campaign may be shorter.
        stop = min(stop, len(self))
        if self.kind == "grid":
            levels = [factor.levels() for factor in self.factors.values()]
            at = np.unravel_index(np.arange(start, stop), [len(level) for level in levels])
            result = dict(
                zip(self.factors, (x[i] for x, i in zip(levels, at, strict=True)), strict=True)
            )
        else:
            columns = zip(self.factors.items(), self.shares(start, stop).T, strict=True)
            result = {path: range_.at(share) for (path, range_), share in columns}
        # Multiples last, once all other factors have their values.
        for path, factor in self.factors.items():
            if factor.times:
                result[path] = result[path] * result[factor.times]
        return result


@functools.lru_cache(maxsize=4)
def _sampled(kind: str, many: int, blocks: int, seed: int) -> Array:
    """Return the points of a design for sensitivity indices (runs, factors)."""
    check_size("sample for sensitivity indices", blocks * (many + 2) * many, "ask for fewer runs")
    problem = unit_cube(many)
    if kind == "saltelli":
        library: Any = salib("sample.sobol")
        result = library.sample(problem, blocks, calc_second_order=False, seed=seed)
    else:
        library = salib("sample.morris")
        result = library.sample(problem, blocks, num_levels=MORRIS_LEVELS, seed=seed)
    return np.asarray(result, dtype=np.float64)


def salib(module: str, instead: str = 'use the design "sobol"') -> Any:
    """Return a module of SALib."""
    return require_library(f"SALib.{module}", "sensitivity", instead)


def unit_cube(many: int) -> dict[str, Any]:
    """Return the problem of SALib whose factors are shares."""
    names = [f"x{i}" for i in range(many)]
    return {"num_vars": many, "names": names, "bounds": [[0.0, 1.0]] * many}


# Sensitivity indices of a campaign: how much of an output each factor explains.

RESAMPLES = 1000
"""Resamples of an interval."""
LEVEL = 0.95
FEWEST_DRAWS = 100
"""Draws without which harmonics of RBD-FAST are noise."""
FALSE_ALARMS = 1e-3
"""Share of independent draws that are taken for correlated ones."""
NEARLY_INDEPENDENT = 0.05
"""Correlation of estimates up to which each has a share of its own: its square goes from one to the
other."""
FEWEST_POINTS = 8
"""Base points or trajectories without which an interval says nothing."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SensitivityIndices(OnAxes, Tabular):
    """How much of an output each factor of a campaign explains, with 95 % intervals."""

    output: str
    """Column of the runs."""
    method: str
    """``"sobol"``, ``"morris"``, or ``"rbd-fast"`` for draws that were there anyway."""
    unit: str
    """SI unit of the output."""
    factors: tuple[str, ...]
    """Paths of what was varied."""
    indices: Mapping[str, Array]
    """By name, an index of each factor. Of Sobol: ``first``, its share of the variance alone, and
    ``total``, with all that it does together with others; RBD-FAST has the first alone. Of
    Morris, in the unit of the output: ``mu_star``, the mean size of the change while it goes
    through its range, ``mu``, the mean change, and ``sigma``, how much the change depends on where
    the others are."""
    half_widths: Mapping[str, Array]
    """Half widths of the intervals of those that have one, bootstrapped over base points."""
    used: int
    """Base points, or trajectories, all of whose runs have a value."""
    left_out: int
    """Those with a run that has none."""
    reasons: tuple[str, ...] = ()
    """Why runs have none: a sentence for each reason."""

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each factor: indices and half widths of their intervals."""
        import pandas as pd

        columns: dict[str, object] = {"factor": list(self.factors)}
        for name, values in self.indices.items():
            columns[name] = values
            if name in self.half_widths:
                columns[f"{name}_half_width"] = self.half_widths[name]
        return pd.DataFrame(columns)

    def _over(self) -> str:
        return "factor"

    def _summary(self) -> Summary:
        rows = [
            (factor, *(self.text_of(name, place) for name in self.indices))
            for place, factor in enumerate(self.factors)
        ]
        return Summary(sentence=self.sentence, head=("factor", *self.indices), rows=rows)

    @property
    def sentence(self) -> str:
        """What it is, and of how many runs."""
        what = {"sobol": "base points", "morris": "trajectories"}.get(self.method, "runs")
        left = f"; {self.left_out} left out, with runs that have no value" if self.left_out else ""
        names = {"sobol": "Sobol indices", "morris": "Morris indices"}
        name = names.get(self.method, "Sobol indices of first order (RBD-FAST)")
        return " ".join([f"{name} of {self.output} from {self.used} {what}{left}.", *self.reasons])

    def text_of(self, name: str, place: int) -> str:
        """Return an index of a factor with its interval.

        Parameters
        ----------
        name : str
            Which index, a key of `indices`.
        place : int
            Which factor.

        Returns
        -------
        str
            Such as ``"0.86 ± 0.09"``.
        """
        value = number(float(self.indices[name][place]))
        if name not in self.half_widths:
            return value
        return f"{value} ± {number(float(self.half_widths[name][place]), 2)}"


def indices_of(
    design: Design, output: str, unit: str, values: Array, reasons: tuple[str, ...] = ()
) -> SensitivityIndices:
    """Return the indices of an output (runs,) of a campaign.

    Source: A. Saltelli et al., Comput. Phys. Commun. 181, 2010; M. D. Morris, Technometrics 33,
    1991; F. Campolongo et al., Environ. Model. Softw. 22, 2007; computed by SALib.
    """
    blocks = values.reshape(-1, design.block)
    good = np.array([bool(np.isfinite(block).all()) for block in blocks])
    if good.sum() < FEWEST_POINTS:
        raise InputError(
            f"{output}: {int(good.sum())} of {len(good)} base points or trajectories have a value"
            f" in all their runs, {FEWEST_POINTS} are needed: ask for more runs, or narrow the"
            " factors." + "".join(f" {reason}" for reason in reasons)
        )
    # All runs of a base point, or none: indices are differences within it.
    left = blocks[good].ravel()
    _refuse_constant(output, left)
    many = len(design.factors)
    options = {"num_resamples": RESAMPLES, "conf_level": LEVEL, "seed": design.seed}
    if design.kind == "saltelli":
        result = salib("analyze.sobol").analyze(
            unit_cube(many), left, calc_second_order=False, **options
        )
        names = {"first": "S1", "total": "ST"}
    else:
        points = design.shares(0, len(design)).reshape(-1, design.block, many)[good]
        result = salib("analyze.morris").analyze(
            unit_cube(many), points.reshape(-1, many), left, num_levels=MORRIS_LEVELS, **options
        )
        names = {"mu_star": "mu_star", "mu": "mu", "sigma": "sigma"}
    return SensitivityIndices(
        output=output,
        method={"saltelli": "sobol"}.get(design.kind, design.kind),
        unit=unit,
        factors=tuple(design.factors),
        indices={own: np.asarray(result[key], dtype=np.float64) for own, key in names.items()},
        half_widths={
            own: np.asarray(result[f"{key}_conf"], dtype=np.float64)
            for own, key in names.items()
            if f"{key}_conf" in result
        },
        used=int(good.sum()),
        left_out=int((~good).sum()),
        reasons=reasons,
    )


def first_order_of(
    draws: Mapping[str, Array], output: str, unit: str, values: Array, seed: int
) -> SensitivityIndices:
    """Return the share of the variance of an output (runs,) that each drawn parameter explains.

    Source: S. Tarantola, D. Gatelli, T. Mara, Reliab. Eng. Syst. Saf. 91, 2006; E. Plischke, ibid.
    95, 2010; computed by SALib.
    """
    table = np.column_stack(list(draws.values()))
    count, many = table.shape
    if count < FEWEST_DRAWS:
        raise InputError(f"shares of the spread need {FEWEST_DRAWS} runs, got {count}.")
    _refuse_constant(output, values)
    names = list(draws)
    for combination, other in itertools.combinations(range(many), 2):
        # Ranges of the law may tie draws whose estimates are independent. Of many pairs one may
        # seem correlated by chance: the level is shared among all of them.
        pairs = many * (many - 1) / 2
        limit = NormalDist().inv_cdf(1.0 - 0.5 * FALSE_ALARMS / pairs) / math.sqrt(count)
        with np.errstate(all="ignore"):
            correlation = float(np.corrcoef(table[:, combination], table[:, other])[0, 1])
        refuse_correlated(names[combination], names[other], correlation, limit)
    result = salib("analyze.rbd_fast", "leave shares of the spread out").analyze(
        unit_cube(many), table, values, num_resamples=RESAMPLES, conf_level=LEVEL, seed=seed
    )
    return SensitivityIndices(
        output=output,
        method="rbd-fast",
        unit=unit,
        factors=tuple(draws),
        indices={"first": np.asarray(result["S1"], dtype=np.float64)},
        half_widths={"first": np.asarray(result["S1_conf"], dtype=np.float64)},
        used=count,
        left_out=0,
    )


def refuse_correlated(name: str, other: str, correlation: float, limit: float) -> None:
    """Refuse shares of single parameters where two of them vary together."""
    if abs(correlation) > limit:
        raise InputError(
            f"{name} and {other} are correlated (by {number(correlation, 2)}): the spread has no"
            " share of each alone."
        )


def _refuse_constant(output: str, values: Array) -> None:
    if not np.ptp(values):
        raise InputError(f"{output} is the same in all runs: there is nothing to explain.")
