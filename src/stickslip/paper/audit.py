"""The audit of the paper as numbers."""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from stickslip.experiments import Published, Rig, load_rig
from stickslip.friction import PRINTED_FORMS, FrictionLaw
from stickslip.paper.cart import CartStudy, study_cart
from stickslip.paper.excitations import Excitation, excitations, rigs
from stickslip.paper.misprints import Consequence, consequences
from stickslip.paper.springback import Springback, springbacks
from stickslip.paper.stick_slip import StickSlip, stick_slip
from stickslip.paper.unpublished import (
    BristleRow,
    Requirement,
    StepTravel,
    bristle_rows,
    requirements,
    step_travels,
)
from stickslip.paper.values import PaperValues
from stickslip.quantities import fields_of, vary
from stickslip.report import published_dict
from stickslip.selection import FixedStepRow, TravelVerdict, compare_fixed_steps, select_travels
from stickslip.simulation import simulate

__all__ = ["PaperAudit", "TableRow", "audit"]


@dataclass(frozen=True, kw_only=True)
class TableRow:
    """One row of the paper's Table II with ours beside it."""

    law: FrictionLaw
    """The row's law, with the paper's values."""
    published: Published
    """What the paper prints in the row."""
    readings: tuple[Excitation, ...]
    """The row's law in the readings A, B and C."""

    def reading(self, key: str) -> Excitation:
        """Return the reading A, B or C."""
        return next(one for one in self.readings if one.key == key)


@dataclass(frozen=True, kw_only=True)
class PaperAudit:
    """Everything recomputed, beside what was printed."""

    rig: Rig
    """The bundled rig."""
    values: PaperValues
    """The rig's numbers in the paper's terms."""
    measured: float
    """Measured travel [m]."""
    table: tuple[TableRow, ...]
    """Table II."""
    requirements: tuple[Requirement, ...]
    """What the unpublished parameters would have to be."""
    step_travels: tuple[StepTravel, ...]
    """What steps of 10 ms make of the push."""
    viscous_travels: Mapping[str, float]
    """Travel in reading B [m] of the laws whose viscous part was left out, with that of (10)."""
    consequences: tuple[Consequence, ...]
    """What the printed equations do where they are wrong."""
    fixed_steps: tuple[FixedStepRow, ...]
    """The released spring with fixed steps and exactly."""
    bristles: tuple[BristleRow, ...]
    """Travels by the stiffness of the bristles."""
    springbacks: tuple[Springback, ...]
    """How bristle laws spring back where nothing holds the block."""
    stick_slip: StickSlip
    """The block pulled slowly by its spring."""
    cart: CartStudy
    """The pendulum-driven cart."""
    verdict: TravelVerdict
    """What our selection says of the rig."""

    def requirement(self, law: str) -> Requirement | None:
        """Return what would give the published travel of a law; None if nothing does.

        That of reading A, in which the other values are nearest; that of B if A has none.
        """
        found = (need for need in self.requirements if need.law == law and need.value is not None)
        return next(found, None)

    def ranking(self, key: str) -> Mapping[str, int]:
        """Return the ranks of the laws of Table II by the paper's own criteria.

        A law whose velocity becomes negative or whose displacement decreases has none; the least
        relative error is first, and equal errors share a rank.

        Parameters
        ----------
        key : str
            ``"published"`` for the printed table, A, B or C for ours.
        """
        judged: dict[str, float] = {}
        for row in self.table:
            if key == "published":
                holds, error = row.published.velocity_positive, row.published.relative_error
            else:
                seen = row.reading(key).criteria
                holds = seen.velocity_never_negative and seen.displacement_never_decreases
                error = seen.relative_error
            if holds and error is not None:
                judged[row.law.name] = abs(error)
        return {
            name: 1 + sum(other < error for other in judged.values())
            for name, error in judged.items()
        }

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
            "ranking_by_the_criteria_of_the_paper": {
                key: self.ranking(key) for key in ("published", "A", "B")
            },
            "unpublished_parameters": [need.to_dict() for need in self.requirements],
            "steps_of_10_ms": [
                {
                    "law": one.law.name,
                    "viscous_coefficient": getattr(one.law, "viscous_coefficient", 0.0),
                    "published": one.published,
                    "travel": one.travel,
                }
                for one in self.step_travels
            ],
            "travel_with_a_viscous_part": dict(self.viscous_travels),
            "misprints": [_consequence_dict(c) for c in self.consequences],
            "bristles": [asdict(row) for row in self.bristles],
            "springbacks": [
                {"law": back.law.name, **asdict(back.criteria)} for back in self.springbacks
            ],
            "fixed_steps": [
                {
                    "dt": row.dt,
                    "stick_rule": row.stick_rule,
                    "criteria": _finite(asdict(row.criteria)),
                    "reversals": row.reversals,
                    "diverged": row.diverged,
                }
                for row in self.fixed_steps
            ],
            "stick_slip": {
                "speed": self.stick_slip.mechanism.speed,
                "stick_time": self.stick_slip.stick_time,
                "slip_time": self.stick_slip.slip_time,
                "closed_form": {
                    "stick_time": self.stick_slip.stick_formula,
                    "slip_time": self.stick_slip.slip_formula,
                },
            },
            "cart": self.cart.to_dict(),
            "selection": self.verdict.to_dict(),
        }


def _consequence_dict(consequence: Consequence) -> dict[str, Any]:
    return {
        **published_dict(consequence.form),
        "tests": {
            one.test: {
                "printed": _finite(asdict(one.printed)),
                "corrected": _finite(asdict(one.corrected)),
                "differs": one.differs,
                "diverged": one.diverged,
                "lasted": one.lasted,
            }
            for one in consequence.outcomes
        },
    }


def _finite(values: dict[str, Any]) -> dict[str, Any]:
    """Replace numbers that JSON does not have by None."""
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in values.items()
    }


def audit(
    *, verdict: TravelVerdict | None = None, progress: Callable[[str, float], object] | None = None
) -> PaperAudit:
    """Recompute the paper: Table II, its unpublished parameters, its printed equations.

    Parameters
    ----------
    verdict : TravelVerdict, optional
        The selection on the bundled rig, if it was already made.
    progress : callable, optional
        Called with the name of a law and the number of its runs so far.

    Returns
    -------
    PaperAudit
        The numbers of the paper, recomputed.

    Examples
    --------
    >>> from stickslip.paper import audit
    >>> found = audit()  # doctest: +SKIP
    """
    rig = load_rig()
    values = PaperValues.of(rig)
    if verdict is None and rig.measurement is not None:
        verdict = select_travels(
            rig.mechanism, rig.laws, rig.measurement, t_end=rig.t_end, progress=progress
        )
    assert verdict is not None
    published = {row.law: row for row in rig.published}
    travels = {name: row.travel for name, row in published.items() if row.travel is not None}
    return PaperAudit(
        rig=rig,
        values=values,
        measured=values.measured,
        table=tuple(_row(rig, values, row) for row in published.values()),
        requirements=requirements(values, travels, t_end=rig.t_end),
        step_travels=step_travels(values, travels, t_end=rig.t_end),
        viscous_travels=_viscous_travels(rig, values),
        consequences=consequences(values),
        fixed_steps=compare_fixed_steps(values.rig, rig.laws["coulomb"], t_end=1.0),
        bristles=bristle_rows(values, t_end=rig.t_end),
        springbacks=springbacks(values),
        stick_slip=stick_slip(values),
        cart=study_cart(
            _named(verdict), rig.laws["coulomb-viscous"], levels=(values.mu_k, values.mu_s)
        ),
        verdict=verdict,
    )


def _named(verdict: TravelVerdict) -> FrictionLaw | None:
    """Return the law that a selection names, with the parameters that it fitted."""
    best = verdict.best
    return None if best is None or best.fit is None else best.fit.law


def _viscous_travels(rig: Rig, values: PaperValues) -> dict[str, float]:
    """Return the travels in reading B with the viscous part that (5) and (9) have as (10) has."""
    _, _, spring = rigs(values.rig)["B"]
    viscous = {
        form.corrected.name
        for form in PRINTED_FORMS.values()
        if "viscous_coefficient" in fields_of(form)
    }
    found = {}
    for name in (row.law for row in rig.published):
        law = rig.laws[name]
        if name in viscous and getattr(law, "viscous_coefficient", None) == 0.0:
            full = vary(law, "friction", {"friction.viscous_coefficient": values.viscous})
            found[name] = float(simulate(spring, full, t_end=rig.t_end).at(rig.t_end)["x"][0])
    return found


def _row(rig: Rig, values: PaperValues, published: Published) -> TableRow:
    law = rig.laws[published.law]
    readings = excitations(values.rig, law, measured=values.measured, t_end=rig.t_end)
    return TableRow(law=law, published=published, readings=readings)
