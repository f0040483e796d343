"""``stickslip paper``: published results, computed again."""

from collections.abc import Sequence
from functools import partial

from stickslip.cli import console
from stickslip.cli.options import PaperOptions
from stickslip.cli.progress import Watching
from stickslip.data import load_rig
from stickslip.errors import concerning
from stickslip.identify.kinds import PAGE
from stickslip.mechanisms import PendulumCart
from stickslip.paper import CartStudy, PaperAudit, Requirement, audit, paper_report
from stickslip.paper.rigs import CART, CYCLES
from stickslip.paper.sections.claims import step_cells
from stickslip.paper.sections.common import values_of
from stickslip.paper.sections.table import RULES
from stickslip.quantities import full_path, parameters, vary
from stickslip.show.documents import document, json_text, write_folder
from stickslip.show.formatting import fixed, significant

# ``stickslip paper``.

DOCUMENT = "paper.json"


def run_paper(options: PaperOptions) -> None:
    """Recompute the paper, write the page, print Table II."""
    folder = console.folder_of(options.output, "stickslip-paper", as_json=options.as_json)
    if folder is not None:
        console.refuse_overwriting(folder, folder, force=options.force, files=(PAGE, DOCUMENT))
    cart = _cart(options.changes)
    with Watching(list(load_rig().laws), "Recomputing the paper:") as watch:
        found = audit(cart=cart, progress=watch)
    content = document("paper", found.to_dict())
    if options.as_json:
        console.print_json(content)
    else:
        _show(found)
    if folder is None:
        return
    files = {DOCUMENT: json_text(content)}
    kept = f"The numbers are in {folder / DOCUMENT}."
    page = partial(paper_report, found, command=console.command_line())

    def write(text: str | None) -> None:
        write_folder(folder, files if text is None else {PAGE: text} | files, stale=[PAGE])

    console.leave_unless_drawn(
        console.draw_page(folder, page, write, kept=kept, quiet=options.as_json)
    )


def _cart(changes: Sequence[str]) -> PendulumCart:
    """Return the cart with masses and swing from the command line."""
    quantities = {path: quantity for path, quantity, _ in parameters(CART, "cart")}
    values = {}
    for given, text in console.overrides(changes).items():
        path = full_path(given, quantities)
        with concerning(f"--set {given}"):
            values[path] = console.number_of(text, quantities[path])
    return vary(CART, "cart", values)


def _show(found: PaperAudit) -> None:
    """Print Table II beside ours, and what the unpublished parameters would have to be."""
    steps = [f"A, 10 ms, {what.replace('$', '')}" for what in RULES.values()]
    heads = ["model", "A push, m", *steps, "B spring, m", "C fixed, m"]
    rows = [
        [
            row.law.title,
            fixed(row.readings[0].criteria.travel, 4),
            *[fixed(row.coarse[rule], 4) if row.coarse else "unstable" for rule in RULES],
            *[fixed(reading.criteria.travel, 4) for reading in row.readings[1:]],
        ]
        for row in found.table
    ]
    heads.insert(1, "published, m")
    for row, cells in zip(found.table, rows, strict=True):
        travel = row.published.travel
        cells.insert(1, "" if travel is None else fixed(travel, 2))
    console.show_table(f"Table II; measured {fixed(found.measured, 2)} m", heads, rows)
    console.stdout().print()
    _show_ranks(found)
    _show_needs(found)
    console.stdout().print()
    _show_cart(found.cart)


def _show_ranks(found: PaperAudit) -> None:
    """Print the ranks by the criteria of the paper."""
    keys = ("published", "A", "B")
    names = {"published": "published", "A": "A push", "B": "B spring"}
    ranks = [(key, found.ranking(key)) for key in keys]
    rows = [
        [
            row.law.title,
            *(
                ""
                if key == "published" and row.published.travel is None
                else str(rank.get(row.law.name, "rejected"))
                for key, rank in ranks
            ),
        ]
        for row in found.table
    ]
    said = "" if found.verdict.ranked else "; select ranks no law on a single travel"
    heads = ["model", *(names[key] for key in keys)]
    console.show_table(f"Ranks by the paper's criteria{said}", heads, rows)


def _show_needs(found: PaperAudit) -> None:
    """Print what would give the published rows."""
    rows = [_need(need) for need in found.requirements]
    console.stdout().print()
    heads = ["row", "m", "interpreted as", "needs", "range"]
    console.show_table("Parameter values that would reproduce the published rows", heads, rows)
    rows = [
        [
            step_travel.row,
            fixed(step_travel.published, 2),
            *map(console.plain, step_cells(step_travel)),
            console.plain(values_of(step_travel.law, found.values.load)),
        ]
        for step_travel in found.step_travels
    ]
    heads = ["row", "m", *(f"{what}, m" for what in map(console.plain, RULES.values())), "with"]
    console.stdout().print()
    console.show_table("The push in steps of 10 ms, by the friction out of rest", heads, rows)
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
    console.stdout().print()
    console.show_table("Softer bristles in the same push", heads, rows)
    rows = [
        [
            significant(1e3 * creep.stribeck_velocity, 4),
            fixed(creep.mean, 2),
            f"{fixed(min(creep.travels), 2)} to {fixed(max(creep.travels), 2)}",
            fixed(creep.held, 4),
            fixed(creep.fine, 4),
        ]
        for creep in found.creeps
    ]
    heads = ["v_s, mm/s", "10 ms, no rule, m", "scatter, m", "10 ms, rule, m", "1 ms, no rule, m"]
    console.stdout().print()
    console.show_table(
        "(5) with sgn v added, its exponent as printed, push in fixed steps", heads, rows
    )


def _show_cart(study: CartStudy) -> None:
    """Print what the cart does with the printed equations, and with the chosen laws."""
    heads = ["fig.", "run", "travel, m", "last, mm", "back-slip, mm", "lowest, mm/s"]
    rows = [
        [
            figure,
            run.title,
            significant(run.travel, 3),
            significant(1e3 * run.travels[-1], 3),
            significant(1e3 * run.mean_return, 2),
            significant(1e3 * run.least_velocity, 2),
        ]
        for figure, runs in (("2", study.runs), ("11", study.choices))
        for run in runs
    ]
    origin = "as given" if study.given else "our assumptions"
    title = (
        f"The cart (masses, length and swing are {origin}): travel in {CYCLES} cycles and"
        " in the last one, back-slip per cycle, lowest velocity"
    )
    console.show_table(title, heads, rows)


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
