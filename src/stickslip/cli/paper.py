"""``stickslip paper``."""

from functools import partial
from pathlib import Path

from stickslip.cli.console import (
    command_line,
    document,
    json_text,
    print_json,
    refuse_overwriting,
    show_table,
    stdout,
    write_folder,
)
from stickslip.cli.pages import PAGE, draw_page, leave_unless_drawn
from stickslip.cli.progress import Watching
from stickslip.experiments import load_rig
from stickslip.formatting import fixed, significant
from stickslip.paper import CartStudy, PaperAudit, Requirement, audit, paper_report
from stickslip.paper.cart import CYCLES

__all__ = ["run"]

DOCUMENT = "paper.json"


def run(output: Path, *, force: bool, as_json: bool) -> None:
    """Recompute the paper, write the page, print Table II.

    Parameters
    ----------
    output : Path
        Folder of the page and the numbers.
    force : bool
        Whether files that exist are replaced.
    as_json : bool
        Whether one JSON document is printed on stdout instead of text.
    """
    if not as_json:
        refuse_overwriting(output, output, force=force, files=(PAGE, DOCUMENT))
    with Watching(list(load_rig().laws), "Recomputing the paper:") as watch:
        found = audit(progress=watch)
    content = document("paper", found.to_dict())
    if as_json:
        print_json(content)
        return
    _show(found)
    files = {DOCUMENT: json_text(content)}
    kept = f"The numbers are in {output / DOCUMENT}."
    page = partial(paper_report, found, command=command_line())

    def write(text: str | None) -> None:
        write_folder(output, files if text is None else {PAGE: text} | files, stale=[PAGE])

    leave_unless_drawn(draw_page(output, page, write, kept=kept))


def _show(found: PaperAudit) -> None:
    """Print Table II beside ours, and what the unpublished parameters would have to be."""
    heads = ["model", "published, m", "A push, m", "B spring, m", "C fixed, m"]
    rows = [
        [
            row.law.title,
            fixed(row.published.travel, 2) if row.published.travel is not None else "",
            *[fixed(reading.criteria.travel, 4) for reading in row.readings],
        ]
        for row in found.table
    ]
    show_table(f"Table II; measured {fixed(found.measured, 2)} m", heads, rows)
    ranks = [found.ranking(key) for key in ("published", "A", "B")]
    rows = [
        [row.law.title, *(str(one.get(row.law.name, "rejected")) for one in ranks)]
        for row in found.table
    ]
    stdout().print()
    heads = ["model", "published", "A push", "B spring"]
    show_table("Ranks by the paper's criteria; select ranks no law on a single travel", heads, rows)
    rows = [_need(need) for need in found.requirements]
    stdout().print()
    heads = ["row", "m", "interpreted as", "needs", "range"]
    show_table("Parameter values that would reproduce the published rows", heads, rows)
    rows = [
        [
            row.law,
            significant(row.stiffness, 1),
            "held" if row.held else "free",
            fixed(row.criteria.travel, 4),
            significant(1e3 * row.criteria.least_velocity, 2),
        ]
        for row in found.bristles
    ]
    heads = ["law", "bristles, N/m", "at the stop", "A push, m", "lowest velocity, mm/s"]
    stdout().print()
    show_table("Softer bristles in the same push", heads, rows)
    stdout().print()
    _show_cart(found.cart)


def _show_cart(study: CartStudy) -> None:
    """Print what the cart does with the printed equations, and with the chosen laws."""
    heads = ["fig.", "run", "travel, m", "last, mm", "back-slip, mm", "lowest, mm/s"]
    rows = [
        [
            figure,
            one.title,
            significant(one.travel, 3),
            significant(1e3 * one.travels[-1], 3),
            significant(1e3 * one.mean_return, 2),
            significant(1e3 * one.least_velocity, 2),
        ]
        for figure, runs in (("2", study.runs), ("11", study.choices))
        for one in runs
    ]
    title = (
        f"The cart (masses, length and swing are our assumptions): travel in {CYCLES} cycles and"
        " in the last one, back-slip per cycle, lowest velocity"
    )
    show_table(title, heads, rows)


def _need(need: Requirement) -> list[str]:
    if need.value is None or need.low is None or need.high is None:
        none = f"no value of {need.symbol}"
        return [need.law, fixed(need.published, 2), need.reading, none, ""]
    unit = "" if need.unit == "1" else f" {need.unit}"
    value = f"{need.symbol} = {significant(need.value, 3)}{unit}"
    return [
        need.law,
        fixed(need.published, 2),
        need.reading,
        value,
        f"{significant(need.low, 3)} to {significant(need.high, 3)}",
    ]
