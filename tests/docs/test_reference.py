"""The reference names everything public."""

import importlib
import re
from functools import reduce
from pathlib import Path

from tests.support import for_all

import stickslip
from stickslip.friction.notation import PARTS
from stickslip.identify.kinds.registry import kinds
from stickslip.lazy import Door

PAGE = Path(__file__).parents[2] / "docs/reference/api.md"
TEXT = PAGE.read_text(encoding="utf-8")
REFERENCE = TEXT.split()
ENTRIES = [
    (module, name)
    for module, block in re.findall(
        r"^\.\. currentmodule:: (\S+)\n(.*?)(?=^\.\. currentmodule|^```|\Z)", TEXT, re.M | re.S
    )
    for name in re.findall(r"^   ([A-Za-z][\w.]*)$", block, re.M)
]


ROOMS = ("engine", "exports", "identify", "mechanisms.drives", "study.control")
WITHIN = {
    "identify.FixedStepRow", "identify.Interval", "identify.LawFit",
    "exports.Applied", "exports.AppliedJoint", "exports.Export", "exports.TARGETS",
    "exports.Target", "exports.export",
}  # fmt: skip
"""What a verdict or an export is made of: users meet them there; `export` is at the top."""
NAMES = [name for name in stickslip.__all__ if name != "__version__"]
NAMES += [
    f"{room}.{name}"
    for room in ROOMS
    for name in importlib.import_module(f"stickslip.{room}").__all__
    if f"{room}.{name}" not in WITHIN and name in Door(f"stickslip.{room}").homes
]


@for_all(NAMES)
def test_a_public_name_stands_in_the_reference(name: str) -> None:
    assert name in REFERENCE, f"{name} is missing in docs/reference/api.md"


@for_all(PARTS)
def test_a_part_of_laws_stands_in_the_table_of_how_to_compose_them(name):
    page = (PAGE.parents[1] / "howto/compose-law.md").read_text(encoding="utf-8")
    rows = [row for row in page.splitlines() if row.startswith("|")]
    assert any(re.search(rf"`{name}[`\[(]", row) for row in rows), name


def test_every_route_stands_in_the_table_with_its_options(monkeypatch):
    monkeypatch.syspath_prepend(PAGE.parents[1] / "_ext")
    rows = [*importlib.import_module("generated").route_table()][2:-1]
    assert len(rows) == len(kinds())
    for row, kind in zip(rows, kinds(), strict=True):
        measured, names, about, options, _ = (cell.strip() for cell in row.strip("|").split("|"))
        assert measured == kind.measured
        assert names == ", ".join(f"`{name}`" for name in kind.routes)
        assert set(options.replace("`", "").split(", ")) == kind.uses | kind.settings
        assert about.endswith(".")


def test_every_name_in_the_reference_exists() -> None:
    def missing(module: str, name: str) -> bool:
        *rooms, last = name.split(".")
        home = reduce(lambda above, room: f"{above}.{room}", rooms, module)
        return not hasattr(importlib.import_module(home), last)

    assert len(ENTRIES) > 100
    assert [entry for entry in ENTRIES if missing(*entry)] == []
