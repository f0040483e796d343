"""Without an extra, what needs it says what to install, and all else works."""

import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

import pytest
from tests.commands import commands
from tests.support import BLOCK_RIG

from stickslip import Coulomb, SpringBlock, simulate
from stickslip.data.catalogue import datasets as records
from stickslip.errors import InputError

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS: dict[str, list[str]] = PROJECT["optional-dependencies"]
FOR_CONTRIBUTORS = {"bench", "dev", "docs"}
IMPORTED = {"mcap-ros2-support": "mcap_ros2"}
"""What a package is imported as, where that is not its name in small letters."""

CAMPAIGN = """
rigs = "block.toml"
t_end = "1 s"
design = "{design}"
runs = 8
[factors]
friction.kinetic_coefficient = {{low = 0.1, high = 0.3}}
[outputs]
travel = {{final = "x"}}
"""
ARM = """
[mechanism]
type = "urdf"
file = "arm.urdf"
[friction.turret]
kinetic_coefficient = 0.3
[friction.shoulder]
kinetic_coefficient = 0.5
[friction.elbow]
kinetic_coefficient = 0.2
"""

COMMANDS: dict[str, tuple[tuple[str, ...], ...]] = {
    "dask": (("sweep", "sobol.toml", "--executor", "dask://127.0.0.1:1"),),
    "logs": (("init", "log.mcap"), ("init", "log.bag"), ("check", "log.mcap")),
    "mdf": (("init", "record.mf4"), ("check", "record.mf4")),
    "parquet": (
        ("init", "record.parquet"),
        ("check", "record.parquet"),
        ("simulate", "block.toml", "-o", "run.parquet"),
        ("sweep", "sobol.toml"),
        ("data", "path", "emps"),
    ),
    "optimise": (
        (
            "optimise",
            "block.toml",
            "--vary",
            "mass=1kg..2kg",
            "--goal",
            "speed",
            "--goal",
            "energy",
        ),
    ),
    "sensitivity": (("sweep", "saltelli.toml"),),
    "tdms": (("init", "record.tdms"), ("check", "record.tdms")),
    "xlsx": (("init", "record.xlsx"), ("check", "record.xlsx")),
}
"""Commands that end without an extra."""


def to_xarray() -> None:
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=0.1).to_xarray()


IN_PYTHON = {"xarray": to_xarray}


def packages(extra: str) -> list[str]:
    """Return what the packages of an extra are imported as."""
    names = [re.split(r"[\[>]", line)[0].lower() for line in EXTRAS[extra]]
    return [IMPORTED.get(name, name.replace("-", "_")) for name in names]


@pytest.fixture
def without(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Hide the packages of an extra, as if they were not installed."""

    def hide(extra: str) -> None:
        hidden = {name.lower(): name for name in packages(extra)}
        for name in [*sys.modules]:
            if name.partition(".")[0].lower() in hidden:
                monkeypatch.setitem(sys.modules, name, None)
        for name in hidden.values():
            monkeypatch.setitem(sys.modules, "SALib" if name == "salib" else name, None)

    return hide


@pytest.fixture
def called(tmp_path, monkeypatch, capsys):
    """Run commands in a folder of files that extras are for."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("STICKSLIP_DATA", raising=False)
    monkeypatch.setattr(records, "cache_folder", lambda: tmp_path / "cache")
    (tmp_path / "block.toml").write_text(BLOCK_RIG)
    (tmp_path / "arm.toml").write_text(ARM)
    (tmp_path / "arm.urdf").write_bytes(
        (files("stickslip.mechanisms") / "desk_arm.urdf").read_bytes()
    )
    for design in ("sobol", "saltelli"):
        (tmp_path / f"{design}.toml").write_text(CAMPAIGN.format(design=design))
    for ending in ("mcap", "bag", "mf4", "parquet", "tdms", "xlsx"):
        name = "log" if ending in ("mcap", "bag") else "record"
        (tmp_path / f"{name}.{ending}").write_bytes(b"PAR1")
    return commands(capsys, one_line=True)


def test_every_extra_for_users_is_met_here() -> None:
    assert {*COMMANDS, *IN_PYTHON} == EXTRAS.keys() - FOR_CONTRIBUTORS


@pytest.mark.parametrize(
    ("extra", "arguments"),
    [(extra, one) for extra, many in COMMANDS.items() for one in many],
    ids=lambda value: value if isinstance(value, str) else " ".join(value[:2]),
)
def test_a_command_names_the_extra_that_it_needs(called, without, extra, arguments):
    without(extra)
    before = {*Path().iterdir()}
    code, out, err = called(*arguments)
    assert (code, out) == (2, ""), err
    assert f"pip install 'stickslip[{extra}]'" in err
    assert "Traceback" not in err
    written = {*Path().iterdir()} - before
    assert not [path for path in written if path.is_file()]


@pytest.mark.parametrize("extra", IN_PYTHON)
def test_a_function_names_the_extra_that_it_needs(without, extra):
    without(extra)
    with pytest.raises(InputError, match=re.escape(f"pip install 'stickslip[{extra}]'")):
        IN_PYTHON[extra]()


PAGES = ROOT / "docs/howto/files"


def slow(*arguments: str) -> object:
    return pytest.param(arguments, marks=pytest.mark.slow)


HIDDEN = """
import sys
sys.modules.update(dict.fromkeys({names!r}))
from stickslip.cli import main
main({arguments!r})
"""


@pytest.mark.parametrize(
    "arguments",
    [
        ("simulate", "block.toml", "-o", "run.csv"),
        slow("init", str(PAGES / "axis.csv"), "-o", "axis.toml"),
        slow("select", str(PAGES / "own-block.toml"), "-o", "report"),
    ],
    ids=lambda entry: entry[0],
)
@pytest.mark.usefixtures("called")
def test_the_main_job_needs_no_extra(arguments):
    # a process of its own: libraries ask for each other when they are imported
    names = [name for extra in EXTRAS.keys() - FOR_CONTRIBUTORS for name in packages(extra)]
    code = HIDDEN.format(names=[*names, "SALib", "dask"], arguments=[*arguments])
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
