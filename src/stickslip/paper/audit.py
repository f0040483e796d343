"""The audit of the paper as numbers."""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from stickslip.experiments import Published, Rig, load_rig
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import SpringBlock
from stickslip.paper.excitations import Excitation, excitations
from stickslip.paper.misprints import Consequence, consequences
from stickslip.paper.unpublished import Requirement, requirements
from stickslip.selection import FixedStepRow, Verdict, compare_fixed_steps, select

__all__ = ["PaperAudit", "TableRow", "audit"]


@dataclass(frozen=True, kw_only=True)
class TableRow:
    """One row of the paper's Table II with ours beside it."""

    law: FrictionLaw
    published: Published
    readings: tuple[Excitation, ...]
    """The row's law in the readings A, B and C."""


@dataclass(frozen=True, kw_only=True)
class PaperAudit:
    """Everything recomputed, beside what was printed."""

    rig: Rig
    measured: float
    """Measured travel [m]."""
    table: tuple[TableRow, ...]
    """Table II."""
    requirements: tuple[Requirement, ...]
    """What the unpublished parameters would have to be."""
    consequences: tuple[Consequence, ...]
    """What the printed equations do where they are wrong."""
    fixed_steps: tuple[FixedStepRow, ...]
    """The released spring with fixed steps and exactly."""
    verdict: Verdict
    """What our selection says of the rig."""

    def reading(self, law: str, key: str) -> Excitation:
        """Return one cell of the table."""
        (row,) = (row for row in self.table if row.law.name == law)
        (found,) = (reading for reading in row.readings if reading.key == key)
        return found

    def to_dict(self) -> Mapping[str, Any]:
        """Return the audit as plain numbers and strings, ready for JSON."""
        return {
            "measured_travel": self.measured,
            "table_2": [
                {
                    "law": row.law.name,
                    "published": asdict(row.published),
                    "ours": {r.key: asdict(r.criteria) for r in row.readings},
                    "closed_form": {r.key: r.closed_form for r in row.readings},
                }
                for row in self.table
            ],
            "unpublished_parameters": [asdict(r) for r in self.requirements],
            "misprints": [_consequence_dict(c) for c in self.consequences],
            "fixed_steps": [asdict(row) for row in self.fixed_steps],
            "selection": self.verdict.to_dict(),
        }


def _consequence_dict(consequence: Consequence) -> dict[str, Any]:
    form = consequence.form
    return {
        "equation": form.equation,
        "as_printed": form.formula,
        "defect": form.defect,
        "cure": form.cure,
        "corrected_law": form.corrected.name,
        "test": consequence.test,
        "printed": _finite(asdict(consequence.printed)),
        "corrected": _finite(asdict(consequence.corrected)),
        "diverged": consequence.diverged,
        "lasted": consequence.lasted,
    }


def _finite(values: dict[str, Any]) -> dict[str, Any]:
    """Replace numbers that JSON does not have by None."""
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in values.items()
    }


def audit(
    *, verdict: Verdict | None = None, watch: Callable[[str, int], None] | None = None
) -> PaperAudit:
    """Recompute the paper: Table II, its unpublished parameters, its printed equations.

    Parameters
    ----------
    verdict : Verdict, optional
        The selection on the bundled rig, if it was already made.
    watch : callable, optional
        Called with the name of a law and the number of its runs so far.

    Examples
    --------
    >>> from stickslip.paper import audit
    >>> found = audit()  # doctest: +SKIP
    """
    rig = load_rig()
    if verdict is None:
        assert rig.measurement is not None
        verdict = select(rig.mechanism, rig.measurement, rig.laws, t_end=rig.t_end, watch=watch)
    mechanism, measurement = rig.mechanism, rig.measurement
    assert isinstance(mechanism, SpringBlock)
    assert measurement is not None
    measured = float(measurement.records()[0].travel or 0.0)
    coulomb = rig.laws["coulomb"]
    mu_k, mu_s = (
        float(getattr(coulomb, name)) for name in ("kinetic_coefficient", "static_coefficient")
    )
    published = {row.law: row for row in rig.published}
    lugre = rig.laws["lugre"]
    load = mechanism.mass * mechanism.gravity
    return PaperAudit(
        rig=rig,
        measured=measured,
        table=tuple(
            TableRow(
                law=rig.laws[name],
                published=row,
                readings=excitations(mechanism, rig.laws[name], measured=measured, t_end=rig.t_end),
            )
            for name, row in published.items()
        ),
        requirements=requirements(
            mechanism,
            {name: row.travel for name, row in published.items() if row.travel is not None},
            mu_k=mu_k,
            mu_s=mu_s,
            t_end=rig.t_end,
        ),
        consequences=consequences(
            mechanism,
            mu_k=mu_k,
            mu_s=mu_s,
            viscous=float(rig.laws["coulomb-viscous"].viscous_coefficient),
            stribeck_velocity=float(lugre.stribeck_velocity),
            stiffness=float(lugre.bristle_stiffness) * load,
            damping=float(lugre.bristle_damping) * load,
        ),
        fixed_steps=compare_fixed_steps(mechanism, coulomb, t_end=1.0),
        verdict=verdict,
    )
