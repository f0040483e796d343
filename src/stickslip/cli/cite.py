"""``stickslip cite``."""

from collections.abc import Sequence

from stickslip.cli.console import document, print_json, stdout
from stickslip.friction import SOURCES, law_type, laws

__all__ = ["run"]


def run(names: Sequence[str], *, as_json: bool) -> None:
    """Print citations.

    Parameters
    ----------
    names : sequence of str
        Names of laws whose sources are printed; all laws if empty.
    as_json : bool
        Whether one JSON document is printed on stdout instead of text.
    """
    from stickslip import __version__

    own = f"stickslip {__version__}. The stickslip authors, 2026. BSD-3-Clause."
    chosen = [law_type(name) for name in names] if names else list(laws().values())
    found = {law.name: [SOURCES[key] for key in law.sources] for law in chosen}
    if as_json:
        content = {"software": own, "rig": SOURCES["paper"], "laws": found}
        print_json(document("cite", content))
        return
    console = stdout()
    console.print(f"Software\n  {own}", markup=False)
    console.print(f"Bundled rig\n  {SOURCES['paper']}", markup=False)
    for law in chosen:
        console.print(law.title, markup=False)
        for source in found[law.name]:
            console.print(f"  {source}", markup=False)
