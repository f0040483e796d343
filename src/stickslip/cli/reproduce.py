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
from stickslip.paper import PaperAudit, audit, paper_report, result_sections
from stickslip.paper.rigs import CART
from stickslip.quantities import full_path, parameters, vary
from stickslip.show import report as page
from stickslip.show.documents import document, json_text, write_folder

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
    drawn = partial(paper_report, found, command=console.command_line())

    def write(text: str | None) -> None:
        write_folder(folder, files if text is None else {PAGE: text} | files, stale=[PAGE])

    console.leave_unless_drawn(
        console.draw_page(folder, drawn, write, kept=kept, quiet=options.as_json)
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
    """Print the tables of the page that have the results of the paper, ours beside."""
    shown = (page.Table, page.Subheading)
    for section in result_sections(found):
        console.stdout().print(f"\n{page.plain(section.heading)}", style="bold")
        console.show_blocks(block for block in section.blocks if isinstance(block, shown))
