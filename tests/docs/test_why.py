"""Pages on why something is done, and the page of equations as printed."""

import importlib
import re
from pathlib import Path

from tests.support import for_all

ROOT = Path(__file__).parents[2]
PAGES = {
    path.stem: path.read_text(encoding="utf-8")
    for path in sorted((ROOT / "docs/explanation/why").glob("*.md"))
    if path.stem != "index"
}
PLACE = re.compile(r"`((?:[\w.]+/)*\w+\.(?:pyi?|toml|h|c))`")


@for_all(PAGES)
def test_a_page_on_why_names_code_that_exists(page: str) -> None:
    places = PLACE.findall(PAGES[page].partition("## Where in the code")[2])
    assert places
    for place in places:
        homes = (ROOT / "src/stickslip" / place, ROOT / place)
        assert any(home.is_file() for home in homes), f"{place} is not there"


def test_the_page_of_printed_forms_lists_all_equations_with_typeset_symbols(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "docs/_ext"))
    page = "\n".join(importlib.import_module("generated").printed_forms())
    heads = re.findall(r"^## Eq\. \((\d+)\): (.+)$", page, re.MULTILINE)
    assert [int(number) for number, _ in heads] == list(range(1, 12))
    assert page.count("\nRight as printed\n") == 2
    assert page.count("\nDefect\n") == 9
    # Greek names are commands in formulas, and no small markup of the reports is left
    assert re.findall(r"\$(?:mu|sigma|alpha)\b|(?<!\{\})\^\{n\}", page) == []
