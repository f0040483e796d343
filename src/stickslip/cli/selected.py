"""What ``stickslip select`` does with a verdict, whatever laws are compared by."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import typer

from stickslip.cli.console import note, print_json
from stickslip.cli.pages import draw_page, leave_unless_drawn
from stickslip.experiments import Rig
from stickslip.friction import FrictionLaw
from stickslip.report.writing import DOCUMENT, write_verdict
from stickslip.selection import FeatureVerdict, RecordVerdict, TravelVerdict

__all__ = ["NO_LAW", "deliver", "laws_of"]

NO_LAW = 3
"""Exit code where no law is recommended."""


def laws_of(
    rig: Rig, names: str | None
) -> Mapping[str, FrictionLaw] | Sequence[FrictionLaw | str] | None:
    """Return the laws to try: those of the rig, or those asked for; None for the usual ones."""
    if names is None:
        return rig.laws or None
    asked = dict.fromkeys(part.strip() for part in names.split(","))
    return [rig.laws.get(name) or name for name in asked]


def deliver(
    verdict: RecordVerdict | FeatureVerdict | TravelVerdict,
    content: Mapping[str, Any],
    output: Path | None,
    *,
    page: Callable[[], str],
    show: Callable[[], None],
    ended: Sequence[str] = (),
) -> None:
    """Write what was found into a folder and print it; without a folder print JSON only.

    The verdict is written and printed before its page is drawn. `ended` are laws whose search was
    ended early.
    """
    page_code = 0
    if output is None:
        print_json(content)
    else:
        write_verdict(output, verdict, content)
        show()
        kept = f"The verdict is in {output / DOCUMENT}."
        page_code = draw_page(output, page, kept=kept)
    if ended:
        note(f"Searches that were ended early may not have converged: {', '.join(ended)}.")
    if verdict.best is None or getattr(verdict.best, "dropped", False):
        note("No law is recommended; the verdict gives the reason.")
        raise typer.Exit(NO_LAW)
    leave_unless_drawn(page_code)
