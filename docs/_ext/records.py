"""Pages on public records: run where the records are, and elsewhere shown without results.

Such a page names its records in its head, as ``records: [emps, spring_pulled_slider/k168_v42]``.
Nothing is downloaded while pages are built.
"""

import re
from typing import Any

import yaml
from sphinx.application import Sphinx
from sphinx.util import logging

from stickslip.data.catalogue import CacheLocation, dataset

logger = logging.getLogger(__name__)

HEAD = re.compile(r"\A---\n(.*?\n)---\n", re.DOTALL)
TITLE = re.compile(r"^# .*\n", re.MULTILINE)
OFF = """\
mystnb:
  execution_mode: "off"
language_info:
  name: python
  pygments_lexer: ipython3
"""
"""Not run; the kernel is not there then to say how its cells are coloured."""
NOTE = """
```{{note}}
This page is shown without results, because {records} could not be read when it was built. Its cells
run if `STICKSLIP_DATA` names a folder with the data, or after `stickslip data path {name}` has
downloaded them ({{doc}}`/howto/data`).
```
"""


def is_here(record: str) -> bool:
    """Whether a file of a record, such as ``"emps/train"``, can be read without a download."""
    name, _, file = record.partition("/")
    return dataset(name).place(file or None) in (CacheLocation.LOCAL, CacheLocation.CACHED)


def without_results(text: str) -> str:
    """Return a page as it is, or not to be run and saying so if a record of it is missing."""
    head = HEAD.match(text)
    named = (yaml.safe_load(head[1]) or {}).get("records", ()) if head else ()
    missing = [record for record in named if not is_here(record)]
    if head is None or not missing:
        return text
    note = NOTE.format(
        records=" and ".join(f"the record `{record}`" for record in missing),
        name=missing[0].replace("/", " --file "),
    )
    body = TITLE.sub(lambda title: title[0] + note, text[head.end() :], count=1)
    return f"---\n{head[1]}{OFF}---\n{body}"


def read(_: Sphinx, page: str, source: list[str]) -> None:
    there = without_results(source[0])
    if there != source[0]:
        logger.info("%s: built without its record, so without results", page)
    source[0] = there


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("source-read", read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
