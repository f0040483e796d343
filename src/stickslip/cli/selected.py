"""What ``stickslip select`` does with a verdict, whatever laws are compared by."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import typer

from stickslip.cli import CANCELLED
from stickslip.cli.output import note, print_json, stdout, write_folder
from stickslip.experiments import Rig
from stickslip.friction import FrictionLaw
from stickslip.report.verdicts import DOCUMENT, PAGE, write_verdict
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
    if output is None:
        print_json(content)
    else:
        write_verdict(output, verdict, content)
        show()
        _draw(output, page)
    if ended:
        note(f"Searches that were ended early may not have converged: {', '.join(ended)}.")
    if verdict.best is None or getattr(verdict.best, "dropped", False):
        note("No law is recommended; the verdict gives the reason.")
        raise typer.Exit(NO_LAW)


def _draw(output: Path, page: Callable[[], str]) -> None:
    """Write the page; if it cannot be drawn, say so and where the verdict is."""
    note("Drawing the page ...")
    try:
        text = page()
    except KeyboardInterrupt:
        note(f"Cancelled while the page was drawn. The verdict is in {output / DOCUMENT}.")
        raise typer.Exit(CANCELLED) from None
    except Exception as error:  # whatever a page fails with, the verdict stands
        note(
            f"The page could not be drawn ({type(error).__name__}: {error}). The verdict is in"
            f" {output / DOCUMENT}."
        )
        return
    write_folder(output, {PAGE: text})
    stdout().print(f"\nReport: {output / PAGE}", markup=False)
