"""Pages on public records are run where the records are, and say so elsewhere."""

from pathlib import Path
from types import ModuleType

import pytest
from tests.support import module_at

DOCS = Path(__file__).parents[2] / "docs"
PAGES = [page for page in sorted(DOCS.glob("*/*.md")) if "\nrecords: " in page.read_text("utf-8")]


@pytest.fixture(scope="module")
def records() -> ModuleType:
    pytest.importorskip("sphinx", reason="documentation is built with the extra dev")
    return module_at(DOCS / "_ext/records.py")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_whose_record_is_missing_is_not_run_and_says_so(
    page: Path, records: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(records, "is_here", lambda _: False)
    text = page.read_text(encoding="utf-8")
    built = records.without_results(text)
    assert 'execution_mode: "off"' in built.partition("\n---\n")[0]
    assert built.count("This page is shown without results") == 1
    assert built.count("{code-cell}") == text.count("{code-cell}")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_whose_records_are_there_is_built_as_it_is(
    page: Path, records: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    monkeypatch.setattr(records, "is_here", lambda record: not asked.append(record))
    text = page.read_text(encoding="utf-8")
    assert records.without_results(text) == text
    assert asked


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_records_of_a_page_are_in_the_catalogue(
    page: Path, records: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("STICKSLIP_DATA", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    asked: list[str] = []
    known = records.is_here
    monkeypatch.setattr(records, "is_here", lambda record: asked.append(record) or known(record))
    records.without_results(page.read_text(encoding="utf-8"))  # raises for unknown names
    assert asked
