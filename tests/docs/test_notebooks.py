"""Tutorials can be downloaded as notebooks, which hold their cells and no markup of Sphinx."""

import re
from pathlib import Path
from types import ModuleType

import pytest
from tests.support import module_at

DOCS = Path(__file__).parents[2] / "docs"
PAGES = [
    page
    for page in sorted((DOCS / "tutorials").glob("*.md"))
    if "```{code-cell}" in page.read_text("utf-8")
]
CELL = re.compile(r"^```\{code-cell\}\n((?::[^\n]*\n)*)(.*?)^```$", re.DOTALL | re.MULTILINE)


@pytest.fixture(scope="module")
def notebooks() -> ModuleType:
    pytest.importorskip("myst_nb", reason="documentation is built with the extra dev")
    return module_at(DOCS / "_ext/notebooks.py")


def title(name: str) -> str:
    """Return the title of a page; a page that does not exist fails."""
    text = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    found = re.search(r"^# (.*)$", text, re.MULTILINE)
    assert found is not None
    return found[1]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_notebook_has_the_cells_of_its_page_and_plain_markdown(
    page: Path, notebooks: ModuleType
) -> None:
    text = page.read_text(encoding="utf-8")
    made = notebooks.notebook(text, f"tutorials/{page.stem}", DOCS, title)
    code = [cell["source"].strip() for cell in made.cells if cell["cell_type"] == "code"]
    assert code == [one.strip() for _, one in CELL.findall(text)]
    prose = "\n".join(cell["source"] for cell in made.cells if cell["cell_type"] == "markdown")
    assert not re.search(r"\{[a-z:-]+\}", re.sub(r"```.*?```|\$.*?\$", "", prose, flags=re.DOTALL))


def test_a_role_without_a_counterpart_is_refused(notebooks: ModuleType) -> None:
    with pytest.raises(ValueError, match="role 'term' has no counterpart"):
        notebooks.notebook("{term}`rest`\n", "tutorials/one", DOCS, title)
