"""Pages on why something is done, and the archive of decision records that they rest on."""

import contextlib
import importlib
import io
import re
from pathlib import Path

from tests.support import for_all

ROOT = Path(__file__).parents[2]
FORMS = "0006-printed-forms-run-with-fixed-steps-only.md"
ARCHIVE = ROOT / "docs" / "decisions"
RECORDS = {path.name[:4]: path for path in sorted(ARCHIVE.glob("[0-9]*.md"))}
PAGES = {
    path.stem: path.read_text(encoding="utf-8")
    for path in sorted((ROOT / "docs/explanation/why").glob("*.md"))
    if path.stem != "index"
}
RECORD = re.compile(r"\[(\d{4})\]\((?:\.\./\.\./decisions/)?(\S+?\.md)\)")
REPLACES = re.compile(r"[Rr]eplaces ((?:\[?\d{4}\]?(?: \([^)]*\))?(?:, | and )?)+)")
PLACE = re.compile(r"`((?:[\w.]+/)*\w+\.(?:pyi?|toml|h|c))`")


def linked(text: str) -> dict[str, str]:
    """Return the files of records that a text links to, by number."""
    return dict(RECORD.findall(text))


@for_all(PAGES)
def test_a_page_on_why_names_code_and_records_that_exist(page: str) -> None:
    code, _, records = PAGES[page].partition("## Where in the code")[2].partition("## Records")
    places = PLACE.findall(code)
    assert places
    for place in places:
        homes = (ROOT / "src/stickslip" / place, ROOT / place)
        assert any(home.is_file() for home in homes), f"{place} is not there"
    files = linked(records)
    assert files
    for number, file in files.items():
        assert RECORDS[number].name == file
    cited = re.findall(r"\b0[01]\d\d\b", PAGES[page].partition("## Where in the code")[0])
    assert set(cited) <= files.keys()


@for_all(RECORDS)
def test_a_record_is_in_the_index_of_the_archive_with_the_pages_that_rest_on_it(
    number: str,
) -> None:
    index = (ARCHIVE / "README.md").read_text(encoding="utf-8")
    (row,) = (line for line in index.splitlines() if line.startswith(f"| [{number}]("))
    assert linked(row)[number] == RECORDS[number].name
    pages = {page for page, text in PAGES.items() if number in linked(text)}
    assert pages
    assert set(re.findall(r"\[([\w-]+)\]\(\.\./explanation/why/\1\.md\)", row)) == pages


@for_all(RECORDS)
def test_records_that_a_record_replaces_say_so(number: str) -> None:
    head = RECORDS[number].read_text(encoding="utf-8").partition("\n## ")[0]
    for numbers in REPLACES.findall(re.sub(r"\]\(\S*\)", "]", head)):
        for other in re.findall(r"\d{4}", numbers):
            text = RECORDS[other].read_text(encoding="utf-8").partition("\n## ")[0]
            assert "replaced by" in text, other
            assert f"[{number}](" in text, other


@for_all([*sorted((ROOT / "docs").rglob("*.md")), ROOT / "README.md", ROOT / "CONTRIBUTING.md"])
def test_no_page_of_the_site_links_to_a_record_as_a_page(path: Path) -> None:
    if ARCHIVE in path.parents or "_build" in path.parts:
        return
    text = path.read_text(encoding="utf-8")
    assert "{doc}`/decisions" not in text
    for target in re.findall(r"\]\(([^)\s]*decisions/[^)\s]*)\)", text):
        assert (path.parent / target).exists(), f"{target} is not there"


def test_numbers_of_records_are_no_links_in_pages_that_are_built(monkeypatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "docs/_ext"))
    without_links = importlib.import_module("archive").without_links
    for text in PAGES.values():
        built = without_links(text)
        assert "decisions/" not in built
        assert [*linked(text)] == re.findall(r"\b0[01]\d\d\b", built.partition("## Records")[2])


def test_the_example_of_printed_forms_prints_what_it_says_and_blames_no_form_unfairly():
    text = (ARCHIVE / FORMS).read_text(encoding="utf-8")
    code = re.search(r"```python\n(.*?)```", text, re.DOTALL)[1]
    printed = re.search(r"```text\n(.*?)```", text, re.DOTALL)[1]
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(code, {})
    assert out.getvalue() == printed
    # (1) has no static level: a push above kinetic friction rightly moves it
    pushes = [float(level) for level in re.findall(r"level=([\d.]+)", code)]
    assert pushes == [10.0, 1.2]
    assert pushes[1] < 0.25 * 9.81 < 0.35 * 9.81 < pushes[0]


def test_the_page_of_printed_forms_lists_all_equations_with_typeset_symbols(monkeypatch):
    folder = Path(__file__).parents[2] / "docs" / "_ext"
    monkeypatch.syspath_prepend(str(folder))
    page = "\n".join(importlib.import_module("generated").printed_forms())
    heads = re.findall(r"^## Eq\. \((\d+)\): (.+)$", page, re.MULTILINE)
    assert [int(number) for number, _ in heads] == list(range(1, 12))
    assert page.count("\nRight as printed\n") == 2
    assert page.count("\nDefect\n") == 9
    # Greek names are commands in formulas, and no small markup of the reports is left
    assert re.findall(r"\$(?:mu|sigma|alpha)\b|(?<!\{\})\^\{n\}", page) == []
