"""Laws and mechanisms of installed packages: found by entry point; one message if they break."""

import os
import subprocess
import sys

import pytest

MODULE = """
from dataclasses import dataclass
from typing import Annotated, ClassVar

from stickslip import Axis, Coulomb, Mechanism
from stickslip.friction import SetValuedLaw
from stickslip.mechanisms import Contact
from stickslip.quantities import Quantity


@dataclass(frozen=True, kw_only=True)
class Sledge(Mechanism):
    name: ClassVar[str] = "sledge"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)

    mass: Annotated[float, Quantity("m", "kg", above=0)]

    def kinetic_energy(self, q, q_dot):
        return 0.5 * self.mass * q_dot["x"] * q_dot["x"]

    def potential_energy(self, t, q):
        return 0.0

    def forces(self, t, q, q_dot, drives):
        return {}

    def contacts(self):
        return (Contact(slip="x", load=9.81 * self.mass),)

    def drives(self):
        return {}


@dataclass(frozen=True, kw_only=True)
class Twofold(SetValuedLaw):
    name: ClassVar[str] = "twofold"
    title: ClassVar[str] = "Twofold"
    formula: ClassVar[str] = r"F = 2 \\mu N"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ("kinetic_coefficient",)

    kinetic_coefficient: Annotated[float, Quantity("mu", low=0)]

    def sliding(self, speed, load):
        return 2.0 * self.kinetic_coefficient * load + 0.0 * speed

    def break_away(self, load):
        return 2.0 * self.kinetic_coefficient * load


class Namesake(Axis.__base__):
    name = "axis"


number = 5
"""
SOUND = """
[stickslip.mechanisms]
sledge = made_elsewhere:Sledge

[stickslip.friction]
twofold = made_elsewhere:Twofold
"""
RIG = """
[mechanism]
type = "sledge"
mass = "2 kg"

[friction]
kinetic_coefficient = 0.1

[[trial]]
travel = 0
initial = { v = 3.0 }
"""


@pytest.fixture
def stickslip(tmp_path):
    """Run the command line where a package with these entry points is installed."""

    def run(entry_points, *arguments):
        info = tmp_path / "made_elsewhere-1.0.dist-info"
        info.mkdir()
        about = "Metadata-Version: 2.1\nName: made-elsewhere\nVersion: 1.0\n"
        (info / "METADATA").write_text(about, encoding="utf-8")
        (info / "entry_points.txt").write_text(entry_points, encoding="utf-8")
        (tmp_path / "made_elsewhere.py").write_text(MODULE, encoding="utf-8")
        (tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")
        path = os.pathsep.join([str(tmp_path), *sys.path])
        code = "from stickslip.cli import main; main()"
        return subprocess.run(
            [sys.executable, "-c", code, *arguments],
            env={**os.environ, "PYTHONPATH": path},
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )

    return run


@pytest.mark.slow
def test_an_installed_mechanism_and_law_work_by_name_in_rig_files(stickslip):
    task = ("simulate", "rig.toml", "--law", "twofold", "--t-end", "5", "--json")
    run = stickslip(SOUND, *task)
    assert run.returncode == 0, run.stderr
    assert f'"x": {9.0 / (2 * 0.2 * 9.81):.6f}'[:10] in run.stdout  # v^2 / (2 mu g)


def test_an_installed_law_is_listed(stickslip):
    run = stickslip(SOUND, "models")
    assert run.returncode == 0, run.stderr
    assert "twofold" in run.stdout


@pytest.mark.slow
@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("sledge = nowhere_at_all:Sledge", "cannot be imported: ModuleNotFoundError"),
        pytest.param(
            "sledge = made_elsewhere:number",
            "must be a class derived from Mechanism",
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "sledge = made_elsewhere:Namesake",
            "is named 'axis', which is taken: rename it",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_an_entry_point_that_cannot_be_used_is_one_message_with_its_package(
    stickslip, entry, message
):
    run = stickslip(f"[stickslip.mechanisms]\n{entry}\n", "simulate", "rig.toml")
    assert run.returncode == 3
    assert "of the installed package made-elsewhere" in run.stderr
    assert message in run.stderr
    assert "Traceback" not in run.stderr
