"""Several trials: each travel beside its prediction."""

from collections.abc import Mapping

import numpy as np

from stickslip import formatting
from stickslip.experiments import QUANTITIES
from stickslip.formatting import Scale, fixed, scale_of
from stickslip.kinds.travels.verdict import TravelVerdict
from stickslip.quantities import parameters, vary
from stickslip.report import Column, Row, Section, Table


def trials_section(verdict: TravelVerdict) -> Section | None:
    """Return the section that compares measured and predicted travels, None with one trial."""
    best = verdict.closest
    records = verdict.measurement.records()
    if best is None or best.fit is None or len(records) < 2:
        return None
    held_out = best.held_out or (None,) * len(best.fit.measured)
    columns = [
        Column(head="trial"),
        Column(head="measured\nm", numeric=True),
        Column(head="fitted to all\nm", numeric=True, phone="label"),
        Column(head="residual\nmm", numeric=True, phone="label"),
        Column(head="held-out residual\nmm", numeric=True, phone="label"),
    ]
    rows = []
    readings = [
        (record, float(value))
        for record in records
        for value in np.atleast_1d(record.values(record.travelled))
    ]
    for (record, reading), measured, predicted, error in zip(
        readings, best.fit.measured, best.fit.predicted, held_out, strict=True
    ):
        name = record.name or _setting(verdict, record.overrides)
        if record.travelled != "travel":
            given = formatting.quantity(reading, QUANTITIES[record.travelled].unit)
            name += f", {record.travelled.replace('_', ' ')} {given}"
        rows.append(
            Row(
                cells=(
                    name,
                    fixed(measured, 3),
                    fixed(predicted, 4),
                    fixed(1e3 * (measured - predicted), 2),
                    "not scored" if error is None else fixed(1e3 * error, 2),
                )
            )
        )
    table = Table(columns=tuple(columns), rows=tuple(rows))
    worst = max(abs(residual) for residual in best.fit.residuals)
    heading = f"Largest residual of {best.title} friction: {formatting.quantity(worst, 'm', 2)}"
    return Section(id="trials", nav="Trials", heading=heading, blocks=(table,))


def _scale(verdict: TravelVerdict, path: str, unit: str) -> Scale:
    """Return what the settings of a parameter are shown in: one unit for all trials."""
    trials = verdict.measurement.records()
    return scale_of([trial.overrides.get(path, 0.0) for trial in trials], unit)


def _setting(verdict: TravelVerdict, overrides: Mapping[str, float]) -> str:
    """Return what was different in a trial, in words."""
    varied = vary(verdict.mechanism, "mechanism", overrides)
    known = {path: quantity for path, quantity, _ in parameters(varied, "mechanism")}
    parts = [
        f"${known[path].symbol}$ = {_scale(verdict, path, known[path].unit).quantity(value)}"
        if path in known
        else f"{path} = {formatting.number(value, 6)}"
        for path, value in overrides.items()
    ]
    return ", ".join(parts) or "rig as described"
