"""The sidebar has no entry for each Python name: another page lists them."""

from pathlib import Path
from types import SimpleNamespace

import pytest
from tests.support import module_at

EXTENSION = Path(__file__).parents[2] / "docs/_ext/sidebar.py"


def test_names_are_left_to_the_page_that_lists_them() -> None:
    addnodes = pytest.importorskip(
        "sphinx.addnodes", reason="documentation is built with the extra dev"
    )
    tree = addnodes.toctree()
    pages = ("howto/plan", "explanation/why/index", "reference/generated/stickslip.fit")
    tree["entries"] = [(None, page) for page in pages]
    module_at(EXTENSION).shorten(None, SimpleNamespace(tocs={"index": tree}))
    assert [page for _, page in tree["entries"]] == ["howto/plan", "explanation/why/index"]
