"""The page of the house names the rooms there are, and modules that calls pass through."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import stickslip

ROOT = Path(stickslip.__file__).parent
PAGE = (Path(__file__).parents[2] / "docs/explanation/the-house.md").read_text(encoding="utf-8")
CALLS = {
    "simulate": """
block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
law = Coulomb(kinetic_coefficient=0.25)
plain = EventDriven(tier="python")  # machine code of kernels runs no module
call = lambda: simulate(block, law, t_end=1.0, solver=plain)
""",
    "select": """
speed = np.linspace(0.1, 1.0, 10)
noise = 0.02 * np.random.default_rng(1).normal(size=10)
table = Measurement(velocity=speed, friction=2.0 + 3.0 * speed + noise)
call = lambda: select(Axis(inertia=1.0), ["coulomb", "coulomb-viscous"], table)
""",
}
WATCHED = """
import sys
import numpy as np
from stickslip import Axis, Coulomb, EventDriven, Measurement, SpringBlock, select, simulate
{}
files = set()
def watch(frame, event, _):
    if event == "call":
        files.add(frame.f_code.co_filename)
sys.setprofile(watch)
call()
sys.setprofile(None)
print(*files, sep="\\n")
"""
"""In a process of its own: what another test has run is kept, and would not run again."""


def test_the_page_has_a_row_for_each_room_and_names_each_module_beside_them() -> None:
    rooms = {path.parent.name for path in ROOT.glob("*/__init__.py")}
    assert set(re.findall(r"^\| `(\w+)` \|", PAGE, re.M)) == rooms
    modules = {path.stem for path in ROOT.glob("*.py")} - {"__init__"}
    beside = PAGE.partition("Beside them stand")[2].partition("\n\n")[0]
    assert set(re.findall(r"`(\w+)`", beside)) == modules


@pytest.mark.parametrize("name", CALLS)
def test_a_call_passes_through_the_modules_that_the_page_lists(name: str) -> None:
    section = PAGE.partition(f"## What a call of `{name}` passes through")[2].partition("\n## ")[0]
    listed = re.findall(r"^\d+\. `([\w.]+)`", section, re.M)
    done = subprocess.run(
        [sys.executable, "-c", WATCHED.format(CALLS[name])],
        capture_output=True,
        text=True,
        check=True,
    )
    ran = set(done.stdout.splitlines())
    assert len(listed) > 10
    assert [text for text in listed if f"{ROOT.joinpath(*text.split('.'))}.py" not in ran] == []
