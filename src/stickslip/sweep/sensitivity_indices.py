"""Sensitivity indices of a campaign: how much of an output each factor explains."""

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.display import OnAxes, Summary
from stickslip.errors import InputError
from stickslip.formatting import number
from stickslip.sweep.design import MORRIS_LEVELS, Design, salib, unit_cube
from stickslip.tables import Tabular

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
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
FEWEST = 8
"""Base points or trajectories without which an interval says nothing."""


@final
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

    @override
    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each factor: indices and half widths of their intervals."""
        import pandas as pd

        columns: dict[str, object] = {"factor": list(self.factors)}
        for name, values in self.indices.items():
            columns[name] = values
            if name in self.half_widths:
                columns[f"{name}_half_width"] = self.half_widths[name]
        return pd.DataFrame(columns)

    @override
    def _over(self) -> str:
        return "factor"

    @override
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
    if good.sum() < FEWEST:
        raise InputError(
            f"{output}: {int(good.sum())} of {len(good)} base points or trajectories have a value"
            f" in all their runs, {FEWEST} are needed: ask for more runs, or narrow the factors."
            + "".join(f" {reason}" for reason in reasons)
        )
    left = blocks[good].ravel()
    _refuse_constant(output, left)
    many = len(design.factors)
    options = {"num_resamples": RESAMPLES, "conf_level": LEVEL, "seed": design.seed}
    if design.kind == "saltelli":
        found = salib("analyze.sobol").analyze(
            unit_cube(many), left, calc_second_order=False, **options
        )
        names = {"first": "S1", "total": "ST"}
    else:
        points = design.shares(0, len(design)).reshape(-1, design.block, many)[good]
        found = salib("analyze.morris").analyze(
            unit_cube(many), points.reshape(-1, many), left, num_levels=MORRIS_LEVELS, **options
        )
        names = {"mu_star": "mu_star", "mu": "mu", "sigma": "sigma"}
    return SensitivityIndices(
        output=output,
        method={"saltelli": "sobol"}.get(design.kind, design.kind),
        unit=unit,
        factors=tuple(design.factors),
        indices={own: np.asarray(found[key], dtype=np.float64) for own, key in names.items()},
        half_widths={
            own: np.asarray(found[f"{key}_conf"], dtype=np.float64)
            for own, key in names.items()
            if f"{key}_conf" in found
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
    for one, other in itertools.combinations(range(many), 2):
        # ranges of the law may tie draws whose estimates are independent
        pairs = many * (many - 1) / 2
        limit = NormalDist().inv_cdf(1.0 - 0.5 * FALSE_ALARMS / pairs) / math.sqrt(count)
        with np.errstate(all="ignore"):
            correlation = float(np.corrcoef(table[:, one], table[:, other])[0, 1])
        refuse_correlated(names[one], names[other], correlation, limit)
    found = salib("analyze.rbd_fast", "leave shares of the spread out").analyze(
        unit_cube(many), table, values, num_resamples=RESAMPLES, conf_level=LEVEL, seed=seed
    )
    return SensitivityIndices(
        output=output,
        method="rbd-fast",
        unit=unit,
        factors=tuple(draws),
        indices={"first": np.asarray(found["S1"], dtype=np.float64)},
        half_widths={"first": np.asarray(found["S1_conf"], dtype=np.float64)},
        used=count,
        left_out=0,
    )


def refuse_correlated(one: str, other: str, correlation: float, limit: float) -> None:
    """Refuse shares of single parameters where two of them vary together."""
    if abs(correlation) > limit:
        raise InputError(
            f"{one} and {other} are correlated (by {number(correlation, 2)}): the spread has no"
            " share of each alone."
        )


def _refuse_constant(output: str, values: Array) -> None:
    if not np.ptp(values):
        raise InputError(f"{output} is the same in all runs: there is nothing to explain.")
