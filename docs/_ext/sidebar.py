"""The sidebar leaves pages of single Python names to the pages that list them.

The theme writes the whole sidebar into every page. With some 240 names it was most of a page, and
putting it together took most of the time in which pages are written.
"""

from collections.abc import Sequence

from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment

LISTED = ("reference/generated/",)
"""Pages that stay reachable by links, by search and by previous and next."""


def shorten(_: Sphinx, env: BuildEnvironment) -> Sequence[str]:
    for contents in env.tocs.values():
        for tree in contents.findall(addnodes.toctree):
            tree["entries"] = [one for one in tree["entries"] if not str(one[1]).startswith(LISTED)]
    return ()


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("env-updated", shorten)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
