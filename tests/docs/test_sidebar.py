"""The sidebar has no entry for each Python name and each decision: other pages list them."""

from pathlib import Path
from types import SimpleNamespace

import pytest
from tests.support import module_at

EXTENSION = Path(__file__).parents[2] / "docs/_ext/sidebar.py"


def test_names_and_decisions_are_left_to_the_pages_that_list_them() -> None:
    addnodes = pytest.importorskip(
        "sphinx.addnodes", reason="documentation is built with the extra dev"
    )
    tree = addnodes.toctree()
    pages = (
        "howto/plan",
        "decisions/README",
        "decisions/0001-a",
        "reference/generated/stickslip.fit",
    )
    tree["entries"] = [(None, page) for page in pages]
    module_at(EXTENSION).shorten(None, SimpleNamespace(tocs={"index": tree}))
    assert [page for _, page in tree["entries"]] == ["howto/plan", "decisions/README"]
