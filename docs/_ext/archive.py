"""Numbers of decision records on pages: links for readers of the repository, text in what is built.

Records are an archive outside of the built pages (`docs/decisions`), so links to them would lead
nowhere there.
"""

import re
from typing import Any

from sphinx.application import Sphinx

RECORD = re.compile(r"\[(\d{4})\]\((?:\.\./)+decisions/\1-[a-z0-9-]+\.md\)")


def without_links(text: str) -> str:
    """Return a page whose links to records are their numbers.

    Examples
    --------
    >>> without_links("see [0001](../../decisions/0001-where-becomes-switches.md).")
    'see 0001.'
    """
    return RECORD.sub(r"\1", text)


def read(_: Sphinx, __: str, source: list[str]) -> None:
    source[0] = without_links(source[0])


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("source-read", read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
