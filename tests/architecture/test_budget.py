"""The sizes of rooms are counted, and no change lets one grow."""

import ast
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from tools.budget import BUDGET, constants, room_of
from tools.structure import TABLE, watched

ROOT = Path(__file__).parents[2]


def test_every_room_is_within_its_budget():
    done = subprocess.run(
        [sys.executable, "-m", "tools.budget"], cwd=ROOT, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[:3] == ["today", "budget", "target"]


def test_targets_are_below_budgets_or_met():
    told = tomllib.loads(BUDGET.read_text(encoding="utf-8"))
    assert told["target"].keys() == told["budget"].keys()


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("A = 1", 1),
        ("A, B = 1, 2.5", 2),
        ("A: Final = (1, 2)", 1),
        ("a = 1", 0),
        ("A = 'text'", 0),
        ("A = True", 0),
        ("class Thresholds:\n    tie: float = 2.0\n    name: str = ''", 1),
        ("class Other:\n    tie: float = 2.0", 0),
    ],
)
def test_numeric_constants_are_named_numbers(text, count):
    assert constants(ast.parse(text)) == count


def test_the_room_of_a_module_is_that_of_its_folder():
    rooms = tomllib.loads(BUDGET.read_text(encoding="utf-8"))["rooms"]
    assert room_of("identify/laws.py", rooms) == "judge"
    assert room_of("units.py", rooms) == ""


def test_a_table_of_friction_is_judged_by_few_modules():
    assert watched(TABLE)["modules"] <= 43  # with laws of any form, fits and trials
