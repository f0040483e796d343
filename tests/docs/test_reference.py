"""The reference names everything public."""

from pathlib import Path

import pytest

import stickslip
import stickslip.control
import stickslip.drives
import stickslip.outputs
import stickslip.results

PAGE = Path(__file__).parents[2] / "docs/reference/api.md"
REFERENCE = PAGE.read_text(encoding="utf-8").split()


NAMES = [name for name in stickslip.__all__ if name != "__version__"]
NAMES += [
    f"{room}.{name}"
    for room in ("control", "drives", "outputs", "results")
    for name in getattr(stickslip, room).__all__
]


@pytest.mark.parametrize("name", NAMES)
def test_a_public_name_stands_in_the_reference(name: str) -> None:
    assert name in REFERENCE
