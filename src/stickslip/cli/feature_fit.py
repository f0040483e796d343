"""``stickslip fit`` on the force of a spring that pulls a block: what its features are."""

from collections.abc import Mapping

from stickslip.cli.console import note, plain, show_table, stdout
from stickslip.formatting import quantity, signed_percent
from stickslip.identification import FeatureFit
from stickslip.identification.features.features import COMPARED

__all__ = ["show_feature_fit"]

UNITS = {"frequency": "Hz"}
"""Of features that have one."""


def show_feature_fit(fit: FeatureFit, second: Mapping[str, float]) -> None:
    """Print what the features of a fit are, and what it says."""
    console = stdout()
    heads = ["feature of F/N", "first half", "fitted", "second half", "off by"]
    heads += ["second record off by"] if second else []
    rows = []
    for name in COMPARED:
        cells = [_sized(name, getattr(fit.observed, name)), _sized(name, fit.predicted[name])]
        cells += ["" if fit.held_out is None else _sized(name, getattr(fit.held_out, name))]
        cells += [signed_percent(fit.held_out_errors[name]) if fit.held_out_errors else ""]
        cells += [signed_percent(second[name])] if second else []
        rows.append([name.replace("_", " "), *cells])
    show_table("", heads, rows, whole=heads)
    if fit.cancelled:
        note("The search was ended early; this is the best so far.")
    if fit.sentences:
        console.print("\nWhat the features say", markup=False, style="bold")
    for line in fit.sentences:
        console.print(f"  {plain(line)}", markup=False)


def _sized(name: str, value: float) -> str:
    return quantity(value, UNITS.get(name, "1"))
