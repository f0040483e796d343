"""The audit of the paper as numbers."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from stickslip.data import Published, Rig, load_rig
from stickslip.engine.simulation import simulate
from stickslip.engine.solver import BreakAway, FixedStep
from stickslip.friction import PRINTED_FORMS, FrictionLaw, PrintedForm
from stickslip.identify import FixedStepRow, compare_fixed_steps, largest_step
from stickslip.identify.kinds import TravelVerdict, select
from stickslip.mechanisms import PendulumCart, SpringBlock
from stickslip.paper import printed, rigs
from stickslip.quantities import fields_of, parameters, vary
from stickslip.show.documents import json_value
from stickslip.show.report import published_dict


@dataclass(frozen=True, kw_only=True)
class TableRow:
    """One row of the paper's Table II with ours beside it."""

    law: FrictionLaw
    """The row's law, with the paper's values."""
    published: Published
    """What the paper prints in the row."""
    readings: tuple[rigs.Excitation, ...]
    """The row's law in the readings A, B and C."""
    coarse: Mapping[BreakAway, float]
    """Travel of the push by forward Euler in steps of 10 ms, with the stick rule [m], by the
    friction in the first step out of rest; empty where the step makes bristles unstable."""
    largest_step: float | None
    """Step above which they do so [s]; None for laws without bristles."""

    def reading(self, key: str) -> rigs.Excitation:
        """Return the reading A, B or C."""
        return next(reading for reading in self.readings if reading.key == key)

    def travel(self, key: str) -> float:
        """Return the travel in the reading A, B or C [m]."""
        return self.reading(key).criteria.travel

    def holds(self, key: str) -> bool:
        """Return whether the run of a reading meets both criteria of the paper."""
        seen = self.reading(key).criteria
        return seen.velocity_never_negative and seen.displacement_never_decreases


@dataclass(frozen=True, kw_only=True)
class TrialTravels:
    """A measured travel, and what each law makes of its setting."""

    compression: float
    """Of the spring [m]."""
    measured: float
    """Measured travel [m]."""
    travels: Mapping[str, float]
    """Travel by name of the law [m]."""


@dataclass(frozen=True, kw_only=True)
class PaperAudit:
    """Everything recomputed, beside what was printed."""

    rig: Rig
    """The rig, with a law for each row."""
    values: rigs.PaperValues
    """The rig's numbers in the paper's terms."""
    measured: float
    """Measured travel [m]."""
    table: tuple[TableRow, ...]
    """Table II."""
    requirements: tuple[printed.Requirement, ...]
    """What the unpublished parameters would have to be."""
    step_travels: tuple[printed.StepTravel, ...]
    """What steps of 10 ms make of the push."""
    viscous_travels: Mapping[str, float]
    """Travel in reading B [m] of the laws whose viscous part was left out, with that of (10)."""
    consequences: tuple[printed.Consequence, ...]
    """What the printed equations do where they are wrong."""
    fixed_steps: tuple[FixedStepRow, ...]
    """The released spring with fixed steps and exactly."""
    bristles: tuple[printed.BristleRow, ...]
    """Travels by the stiffness of the bristles."""
    springbacks: tuple[printed.Springback, ...]
    """How bristle laws spring back where nothing holds the block."""
    creeps: tuple[printed.Creep, ...]
    """What (5) makes of the push in steps of 10 ms, with the sgn that it lacks."""
    rest_rules: tuple[rigs.RestRule, ...]
    """Zero-velocity bands and other rules for rest, beside the exact switch."""
    trials: tuple[TrialTravels, ...]
    """Each trial with the travels of all laws."""
    stick_slip: rigs.StickSlip | None
    """The block pulled slowly by its spring; None of another rig."""
    cart: rigs.CartStudy
    """The pendulum-driven cart."""
    verdict: TravelVerdict
    """What our selection says of the rig."""

    def requirement(self, law: str) -> printed.Requirement | None:
        """Return what would give the published travel of a law; None if nothing does.

        That of reading A, in which the other values are nearest; that of B if A has none.
        """
        result = (need for need in self.requirements if need.law == law and need.value is not None)
        return next(result, None)

    def reached(self, reading: str) -> int:
        """Return how many travels of Table II a value in a reading gives, Table I kept."""
        needs = (need for need in self.requirements if need.reading == reading)
        return sum(need.value is not None and need.kept for need in needs)

    @property
    def without_rule(self) -> FixedStepRow:
        """The released spring in fixed steps without a rule for rest."""
        return next(row for row in self.fixed_steps if row.dt is not None and not row.stick_rule)

    def ranking(self, key: str) -> Mapping[str, int]:
        """Return the ranks of the laws of Table II by the paper's own criteria.

        A law whose velocity becomes negative or whose displacement decreases has none; the least
        relative error is first, and equal errors share a rank.
        """
        judged: dict[str, float] = {}
        for row in self.table:
            if key == "published":
                holds, error = row.published.velocity_positive, row.published.relative_error
            else:
                holds, error = row.holds(key), row.reading(key).criteria.relative_error
            if holds and error is not None:
                judged[row.law.name] = round(abs(error), 9)  # rows that are one law share a rank
        return {
            name: 1 + sum(other < error for other in judged.values())
            for name, error in judged.items()
        }

    def to_dict(self) -> Mapping[str, Any]:
        """Return the audit as plain numbers and strings, ready for JSON."""
        result: dict[str, Any] = json_value(
            {
                "measured_travel": self.measured,
                "table_2": [
                    {
                        "law": row.law.name,
                        "published": row.published,
                        "ours": {r.key: r.criteria for r in row.readings},
                        "closed_form": {r.key: r.closed_form for r in row.readings},
                        "in_steps_of_10_ms": row.coarse,
                        "largest_step": row.largest_step,
                    }
                    for row in self.table
                ],
                "ranking_by_the_criteria_of_the_paper": {
                    key: self.ranking(key) for key in ("published", "A", "B")
                },
                "unpublished_parameters": self.requirements,
                "steps_of_10_ms": [
                    {
                        "row": travel.row,
                        "law": travel.law.name,
                        "values": _values(travel.law),
                        "published": travel.published,
                        "travel": {"zero": travel.travel, "static": travel.static},
                        "scatter": travel.scatter,
                        "reached": travel.reached,
                    }
                    for travel in self.step_travels
                ],
                "equation_5_in_steps_of_10_ms": [
                    {
                        "stribeck_velocity": creep.stribeck_velocity,
                        "travels": creep.travels,
                        "mean_travel": creep.mean,
                        "least_velocity": creep.least_velocity,
                        "with_rule_for_rest": creep.held,
                        "in_a_tenth_of_the_step": creep.fine,
                    }
                    for creep in self.creeps
                ],
                "rules_for_rest": self.rest_rules,
                "trials": self.trials,
                "travel_with_a_viscous_part": self.viscous_travels,
                "misprints": [_misprint(consequence) for consequence in self.consequences],
                "bristles": self.bristles,
                "springbacks": [
                    {"law": back.law.name, **asdict(back.criteria)} for back in self.springbacks
                ],
                "fixed_steps": [
                    {
                        name: getattr(row, name)
                        for name in ("dt", "stick_rule", "criteria", "reversals", "diverged")
                    }
                    for row in self.fixed_steps
                ],
                "stick_slip": self.stick_slip
                and {
                    "speed": self.stick_slip.mechanism.speed,
                    "stick_time": self.stick_slip.stick_time,
                    "slip_time": self.stick_slip.slip_time,
                    "closed_form": {
                        "stick_time": self.stick_slip.stick_formula,
                        "slip_time": self.stick_slip.slip_formula,
                    },
                },
                "cart": self.cart,
                "selection": self.verdict,
            }
        )
        return result


def _values(law: FrictionLaw | PrintedForm, root: str = "law") -> dict[str, float]:
    return {path: value for path, _, value in parameters(law, root)}


def _misprint(consequence: printed.Consequence) -> dict[str, Any]:
    names = ("printed", "corrected", "differs")
    return {
        **published_dict(consequence.form),
        "values": _values(consequence.printed, "printed"),
        "values_corrected": _values(consequence.corrected, "corrected"),
        "tests": {
            outcome.test: {
                **{name: getattr(outcome, name) for name in names},
                "with_stick_rule": outcome.with_rule,
            }
            for outcome in consequence.outcomes
        },
    }


def audit(
    *,
    verdict: TravelVerdict | None = None,
    cart: PendulumCart = rigs.CART,
    progress: Callable[[str, float], object] | None = None,
) -> PaperAudit:
    """Recompute the paper: Table II, its unpublished parameters, its printed equations.

    Examples
    --------
    >>> from stickslip.paper import audit
    >>> found = audit()  # doctest: +SKIP
    """
    rig = load_rig()
    if verdict is None and rig.measurement is not None:
        result = select(
            rig.mechanism, rig.laws, rig.measurement, t_end=rig.t_end, progress=progress
        )
        assert isinstance(result, TravelVerdict)
        verdict = result
    assert verdict is not None
    values = rigs.PaperValues.of(rig)
    published = {row.law: row for row in rig.published}
    travels = {name: row.travel for name, row in published.items() if row.travel is not None}
    rows = tuple(_row(rig, values, published.get(name) or Published(law=name)) for name in MODELS)
    creeps = printed.stribeck_creeps(values, t_end=rig.t_end)
    return PaperAudit(
        rig=rig,
        values=values,
        measured=values.measured,
        table=rows,
        requirements=printed.requirements(values, travels, t_end=rig.t_end),
        step_travels=printed.step_travels(values, travels, creeps, t_end=rig.t_end),
        viscous_travels=_viscous_travels(rig, values),
        consequences=printed.consequences(values),
        fixed_steps=compare_fixed_steps(values.rig, rig.laws["coulomb"], t_end=1.0),
        bristles=printed.bristle_rows(values, t_end=rig.t_end),
        springbacks=printed.springbacks(values),
        creeps=creeps,
        rest_rules=rigs.rest_rules(values, cart),
        trials=_trials(rig),
        stick_slip=rigs.stick_slip(values),
        cart=rigs.study_cart(
            _named(verdict),
            rig.laws["coulomb-viscous"],
            levels=(values.mu_k, values.mu_s),
            bristles=printed.lugre_row(values, printed.STIFFNESS),
            cart=cart,
        ),
        verdict=verdict,
    )


MODELS = (
    "coulomb",
    "dahl",
    "lugre",
    "stribeck",
    "coulomb-viscous",
    "coulomb-viscous-static",
)
"""The rows of Table II in its order, and the one of the paper's six models that it leaves out."""


def _trials(rig: Rig) -> tuple[TrialTravels, ...]:
    """Return each measured travel with what every law makes of its compression."""
    assert isinstance(rig.mechanism, SpringBlock)
    assert rig.measurement is not None
    result = []
    for record in rig.measurement.records():
        block = vary(rig.mechanism, "mechanism", record.overrides)
        runs = {name: simulate(block, rig.laws[name], t_end=rig.t_end) for name in MODELS}
        result.append(
            TrialTravels(
                compression=block.compression,
                measured=float(record.travel or 0.0),
                travels={name: float(run.at(rig.t_end)["x"][0]) for name, run in runs.items()},
            )
        )
    return tuple(result)


def _named(verdict: TravelVerdict) -> FrictionLaw | None:
    """Return the law that a selection names, with the parameters that it fitted."""
    best = verdict.best
    return None if best is None or best.fit is None else best.fit.law


def _viscous_travels(rig: Rig, values: rigs.PaperValues) -> dict[str, float]:
    """Return the travels in reading B with the viscous part that (5) and (9) have as (10) has."""
    _, _, spring = rigs.rigs(values.rig)["B"]
    viscous = {
        form.corrected.name
        for form in PRINTED_FORMS.values()
        if "viscous_coefficient" in fields_of(form)
    }
    result = {}
    for name in MODELS:
        law = rig.laws[name]
        if name in viscous and getattr(law, "viscous_coefficient", None) == 0.0:
            full = vary(law, "friction", {"friction.viscous_coefficient": values.viscous})
            result[name] = float(simulate(spring, full, t_end=rig.t_end).at(rig.t_end)["x"][0])
    return result


def _row(rig: Rig, values: rigs.PaperValues, published: Published) -> TableRow:
    law = rig.laws[published.law]
    readings = rigs.excitations(values.rig, law, measured=values.measured, t_end=rig.t_end)
    push = readings[0]
    largest = largest_step(push.mechanism, law, push.run)
    coarse: dict[BreakAway, float] = {}
    for rule in printed.BREAK_AWAY_RULES if largest is None or largest >= printed.CART_STEP else ():
        solver = FixedStep(dt=printed.CART_STEP, break_away=None if law.states else rule)
        run = simulate(push.mechanism, law, t_end=rig.t_end, solver=solver)
        coarse[rule] = float(run["x"][-1])
    return TableRow(
        law=law, published=published, readings=readings, coarse=coarse, largest_step=largest
    )
