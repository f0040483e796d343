"""The changelog names the new home of every name that was moved."""

import re
from pathlib import Path

from stickslip import MOVED

TEXT = (Path(__file__).parents[2] / "CHANGELOG.md").read_text(encoding="utf-8")


def test_every_name_that_left_the_top_is_listed_with_its_namespace() -> None:
    rows = re.findall(r"^\| `stickslip\.(\w+)` \| (.*) \|$", TEXT, re.MULTILINE)
    listed = {name: home for home, names in rows for name in re.findall(r"`(\w+)`", names)}
    assert listed == MOVED
