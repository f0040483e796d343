"""The reference names everything public."""

from pathlib import Path

import pytest

import stickslip

PAGE = Path(__file__).parents[2] / "docs/reference/api.md"
REFERENCE = PAGE.read_text(encoding="utf-8").split()


@pytest.mark.parametrize("name", [name for name in stickslip.__all__ if name != "__version__"])
def test_a_public_name_stands_in_the_reference(name: str) -> None:
    assert name in REFERENCE
