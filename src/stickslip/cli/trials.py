"""What the commands say of several trials: whether they share one law."""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.cli.console import plain, show_table, stdout
from stickslip.experiments import condition_name
from stickslip.formatting import significant
from stickslip.identification import TrialComparison


def content_of(comparison: TrialComparison | None) -> Mapping[str, Any]:
    """Return the comparison as a part of what a command writes as JSON."""
    return {} if comparison is None else {"trials": comparison.to_dict()}


def show_trials(comparison: TrialComparison | None) -> None:
    """Print whether the trials share one law, and by trial what was fitted where they do not."""
    if comparison is None:
        return
    console = stdout()
    console.print("\nTrials", markup=False, style="bold")
    for line in comparison.sentences:
        console.print(f"  {plain(line)}", markup=False)
    if not comparison.trials or (comparison.shared and not comparison.conditions):
        return
    symbols = [one.quantity.symbol for one in comparison.trials[0].estimates]
    heads = ["trial", *map(condition_name, comparison.conditions)]
    heads += [head for symbol in symbols for head in (symbol, "95 %")]
    rows = []
    for trial in comparison.trials:
        row = [trial.name]
        for name in comparison.conditions:
            value = trial.conditions.get(name)
            row.append(significant(value, 4) if isinstance(value, float) else value or "")
        for one, error in zip(trial.estimates, trial.errors, strict=True):
            known = math.isfinite(error)
            row += [significant(one.value, 4), one.range if known else "open"]
        rows.append([plain(cell) for cell in row])
    show_table("", heads, rows, whole=heads)
