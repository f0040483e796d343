"""The certificate: how the computation behind the verdict went."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from stickslip.formatting import (
    in_words,
    number,
    parameter_words,
    percent,
    quantity,
    ratio,
    residue,
    significant,
)
from stickslip.identification import SEPARABLE, RecordFit
from stickslip.kinds.joints.joint_verdict import BlockwiseVerdict
from stickslip.kinds.joints.sections.scores import picks_text
from stickslip.kinds.records import restarts_text
from stickslip.report import KeyValue, Section, certificate

TWICE: Final = 2.0
"""Residuals below this many times the least are said to be so many percent higher."""


def certificate_section(verdict: BlockwiseVerdict) -> Section | None:
    """Return the section on the computation behind the verdict."""
    best = verdict.closest
    if best.fit is None:
        return None
    items = [*_search(best.fit), *_runs(best.fit), *_information(best.fit)]
    settings = verdict.settings
    items.append(
        KeyValue(key="Seed", value=f"{settings.seed}, for the starts after the first of each law")
    )
    plan = verdict.plan
    items.append(
        KeyValue(
            key="Held-out blocks",
            value=f"{verdict.blocks_scored} blocks, {quantity(plan.gap, 's', 2)} left out on"
            " both sides,"
            f" predicted over {quantity(plan.horizon, 's', 2)}",
        )
    )
    agree = all(name in ("", best.name) for name in verdict.picks.values())
    text = picks_text(verdict)
    if text:
        items.append(KeyValue(key="Criteria", value=text, mark="ok" if agree else "warn"))
    return certificate(items)


def _search(fit: RecordFit) -> list[KeyValue]:
    """Return how the least residual was found."""
    found, restarts = fit.optimum, fit.restarts
    agreeing = restarts.agreeing
    text = restarts_text(fit)
    if agreeing < len(restarts.costs):
        text += f"; {_worst(restarts.costs)}"
    text += "; the search was stopped early" if found.cancelled else ""
    certain = agreeing > 1 and not found.cancelled
    how = {
        "shooting": "segments simulated exactly, each from a fitted state",
        "force-map": "friction along the measured motion",
        "inverse-dynamics": "friction from filtered motion and force",
        "joints": "balances of all joints together, from filtered motion and forces",
    }.get(fit.route, fit.route)
    return [
        KeyValue(key="Route", value=how),
        KeyValue(key="Restarts", value=text, mark="ok" if certain else "warn"),
        KeyValue(key="Evaluations", value=f"{found.evaluations:,} predictions of the record"),
    ]


def _worst(costs: Sequence[float]) -> str:
    """Return what became of the start that ended farthest from the least residual."""
    failed = sum(not math.isfinite(cost) for cost in costs)
    if failed:
        return f"{in_words(failed)} could not be simulated"
    times = math.sqrt(max(costs) / max(min(costs), 1e-300))
    if times < TWICE:
        return f"the worst ended {percent(times - 1.0)} higher"
    return f"the worst ended at {ratio(times)} that residual"


def _runs(fit: RecordFit) -> list[KeyValue]:
    """Return what the runs of the segments say of themselves; nothing where none are simulated."""
    runs = fit.problem.runs(fit.optimum.best)
    known = [run.certificate for run in runs]
    if not known:
        return []
    sure = sum(one.certified for one in known)
    turns = sum(len(run.events) for run in runs)
    rest = sum(run.stick_time() for run in runs)
    energy = residue(max(one.energy_error for one in known))
    drift = max(one.stick_drift for one in known)
    still = f"; drift at rest {quantity(drift, 'm', 1) if drift else 'exactly 0'}" if rest else ""
    located = residue(max(one.event_residual for one in known))
    return [
        KeyValue(
            key="Simulation",
            value=f"{sure} of {len(known)} segments certified with the fitted law",
            mark="ok" if sure == len(known) else "warn",
        ),
        KeyValue(
            key="Energy balance",
            value=f"relative mismatch of energy and work at most {energy}",
        ),
        KeyValue(
            key="Stops and reversals",
            value=f"{turns:,} events, located to a relative {located}; {quantity(rest, 's', 2)} at"
            f" rest{still}",
        ),
    ]


def _information(fit: RecordFit) -> list[KeyValue]:
    """Return how much the record says."""
    rows, effective = len(fit.residual), fit.inference.effective
    condition = fit.inference.condition
    segments = fit.problem.spans
    lengths = segments[:, 2] - segments[:, 1]
    text = f"{len(segments):,}"
    if all(record.time is not None for record in fit.measurement.records()):
        text += f" of {quantity(float(np.median(lengths)), 's', 2)} each"
    ended = ", ".join(parameter_words(path) for path in fit.at_bounds)
    return [
        KeyValue(key="Segments", value=text),
        KeyValue(
            key="Effective samples",
            value=f"about {significant(effective, 2)} of {rows:,} rows compared, by the residuals"
            " of the fit",
        ),
        KeyValue(
            key="Condition",
            value=f"{significant(condition, 2)}, limit {number(SEPARABLE)}",
            mark="ok" if condition <= SEPARABLE else "warn",
        ),
        KeyValue(
            key="Bounds",
            value=f"reached by {ended}" if ended else "none reached",
            mark="warn" if ended else "ok",
        ),
    ]
