"""How many places a contribution touches: a law 2 or 3, a mechanism and a plot 3, a kind 4.

Toys are put into a copy of the package by the edits that CONTRIBUTING.md lists. The last place of
each is its test, which stands here for all: the toy is used as a user would use it. A kind that
another package registers is used likewise.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TOYS = Path(__file__).parent / "toys"
TEST = 1
"""The test of a contribution is one of its places."""

Tree = Path
Edit = tuple[str, str, str]
"""A file below src/stickslip, a line in it, and what is put below that line."""


@pytest.fixture
def tree(tmp_path: Path) -> Tree:
    """A copy of what a contributor has: the package and its tools."""
    for folder in ("src", "tools"):  # with what is compiled of it, which keeps its times
        shutil.copytree(ROOT / folder, tmp_path / folder)
    return tmp_path


def contributed(tree: Tree, toy: str, to: str, *edits: Edit) -> int:
    """Add a file, make edits, renew the stubs; return the number of places."""
    copied = shutil.copytree if (TOYS / toy).is_dir() else shutil.copy
    copied(TOYS / toy, tree / "src/stickslip" / to)
    for file, line, below in edits:
        path = tree / "src/stickslip" / file
        text = path.read_text(encoding="utf-8")
        assert text.count(line) == 1, f"{file} has no single line {line!r}"
        path.write_text(text.replace(line, f"{line}\n{below}"), encoding="utf-8")
    run(tree, "tools/stubs.py")
    return 1 + len({file for file, _, _ in edits}) + TEST


def run(tree: Tree, *arguments: str, expected: int = 0) -> str:
    """Run Python with the copy in place of the package; return what it prints."""
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=tree,
        env={**os.environ, "PYTHONPATH": str(tree / "src"), "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == expected, done.stdout + done.stderr
    return done.stdout


MODELS = """
from stickslip.cli import main
main(["models"])
"""
RUNS = """
from stickslip.cli import main
for command in (["schema"], ["simulate", "slab.toml", "--json"]):
    try:
        main(command)
    except SystemExit as leaving:
        assert not leaving.code, leaving.code
"""


@pytest.mark.slow
def test_a_law_touches_three_places(tree: Tree) -> None:
    line = '    **dict.fromkeys(NAMED, "registry"),'
    places = contributed(
        tree,
        "toy_law.py",
        "friction/toy_law.py",
        ("friction/__init__.py", line, '    "ToyLaw": "toy_law",'),
    )
    use = """
import numpy as np
from stickslip import Axis, Measurement, SpringBlock, ToyLaw, fit, select, simulate
from stickslip.friction import LAWS
from stickslip.study import check_law
assert LAWS["toy-law"] is ToyLaw
check_law(ToyLaw(level=0.3, knee=0.05))
truth = ToyLaw(level=2.0, knee=0.05)
v = np.linspace(-1.0, 1.0, 400)
noise = np.random.default_rng(0).normal(0.0, 0.02, v.size)
table = Measurement(velocity=v, friction=[truth.force(x, load=1.0) for x in v] + noise)
found = fit(Axis(inertia=1.0), "toy-law", table)
assert all(e.low < getattr(truth, e.path.rpartition(".")[2], 0.0) < e.high for e in found.estimates)
time = np.linspace(0.0, 12.0, 400)
v = np.sin(2.0 * time)
friction = [truth.force(x, load=1.0) for x in v] + noise
record = Measurement(time=time, velocity=v, friction=friction)
for measured in (table, record):
    try:
        select(Axis(inertia=1.0), ["coulomb", "toy-law"], measured)
    except ValueError as error:
        assert "no sum of parts" in str(error)
    else:
        raise AssertionError("a law in equations has no terms to compare")
truth = ToyLaw(level=0.25, knee=0.05)
trials = []
for x in (0.05, 0.07, 0.09, 0.11):
    block = SpringBlock(mass=0.8, stiffness=145.0, compression=x)
    travel = round(float(simulate(block, truth, t_end=3.0)["x"][-1]), 4)
    set_ = {"mechanism.compression": x}
    trials.append(Measurement(travel=travel, uncertainty=1e-3, overrides=set_))
verdict = select(block, ["coulomb", "toy-law"], Measurement(trials=trials))
assert verdict.best.name == "toy-law", verdict
"""
    assert "toy-law" in run(tree, "-c", use + MODELS)
    assert "class ToyLaw" not in (tree / "src/stickslip/__init__.pyi").read_text(encoding="utf-8")
    assert "ToyLaw as ToyLaw" in (tree / "src/stickslip/__init__.pyi").read_text(encoding="utf-8")
    assert places == 3


ENTRY = """

@composed("level + lorentz + power")
class ToyEntry:
    \"\"\"A surplus that fades with the square of the speed, beside a power of it.\"\"\"

    name = "toy-entry"
    title = "Toy entry"
    sources = ("coulomb1785",)
"""


@pytest.mark.slow
def test_a_composed_law_touches_one_place_beside_its_test(tree: Tree) -> None:
    path = tree / "src/stickslip/friction/named.py"
    path.write_text(path.read_text(encoding="utf-8") + ENTRY, encoding="utf-8")
    run(tree, "tools/stubs.py")
    use = """
from stickslip import ToyEntry
from stickslip.friction import LAWS, law
assert LAWS["toy-entry"] is ToyEntry is law("level + power + lorentz")
toy = ToyEntry(kinetic_coefficient=1.0, static_coefficient=1.5, stribeck_velocity=0.1,
               viscous_coefficient=2.0, viscous_exponent=0.5)
assert toy.force(0.25, load=0.0) == 1.0
"""
    assert "toy-entry" in run(tree, "-c", use + MODELS)
    stub = (tree / "src/stickslip/friction/__init__.pyi").read_text(encoding="utf-8")
    assert "class ToyEntry(" in stub


def test_an_entry_with_an_unknown_source_is_one_message_and_nothing_is_written(tree: Tree) -> None:
    folder = tree / "src/stickslip/friction"
    path, tables = folder / "named.py", [folder / "__init__.py", folder / "__init__.pyi"]
    entry = ENTRY.replace("coulomb1785", "coulomb1875")
    path.write_text(path.read_text(encoding="utf-8") + entry, encoding="utf-8")
    before = [table.read_text(encoding="utf-8") for table in tables]
    done = subprocess.run(
        [sys.executable, "tools/stubs.py"],
        cwd=tree,
        env={**os.environ, "PYTHONPATH": str(tree / "src")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert "toy-entry" in line
    assert "'coulomb1875', which friction/references.bib does not have: write 'coulomb1785'" in line
    assert [table.read_text(encoding="utf-8") for table in tables] == before


@pytest.mark.slow
def test_a_mechanism_touches_three_places(tree: Tree) -> None:
    line = '    "Capsule": "capsules",'
    places = contributed(
        tree,
        "toy_mechanism.py",
        "mechanisms/toy_mechanism.py",
        ("mechanisms/__init__.py", line, '    "ToySlab": "toy_mechanism",'),
    )
    use = """
import math
from stickslip import Coulomb, ToySlab, simulate
from stickslip.mechanisms import MECHANISMS
assert MECHANISMS["toy-slab"] is ToySlab
slab, law = ToySlab(mass=2.0, weight=1.0), Coulomb(kinetic_coefficient=0.2)
run = simulate(slab, law, t_end=1.0)
a = 9.81 * (1.0 - 0.2 * 2.0) / 3.0  # Newton's law of both masses
assert math.isclose(run["x"][-1], 0.5 * a, rel_tol=1e-9), run["x"][-1]
"""
    rig = tree / "slab.toml"
    rig.write_text(
        '[mechanism]\ntype = "toy-slab"\nmass = "2 kg"\nweight = "1 kg"\n'
        "[friction.coulomb]\nkinetic_coefficient = 0.2\n[run]\nt_end = 1.0\n"
    )
    assert "toy-slab" in run(tree, "-c", use + RUNS)
    assert places == 3


@pytest.mark.slow
def test_a_plot_touches_three_places(tree: Tree) -> None:
    line = "from stickslip.show.plots.axes import Array as Array"
    module = "stickslip.show.plots.toy_plot"
    places = contributed(
        tree,
        "toy_plot.py",
        "show/plots/toy_plot.py",
        ("show/plots/__init__.pyi", line, f"from {module} import plot_toy as plot_toy"),
        ("show/plots/__init__.pyi", "__all__ = [", '    "plot_toy",'),
    )
    use = """
from stickslip import Coulomb, SpringBlock, simulate
from stickslip.show.plots import plot_toy
rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
axes = plot_toy(simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0))
assert axes.get_xlabel() == "time since the start, s"
"""
    run(tree, "-c", use)
    stub = (tree / "src/stickslip/show/plots/__init__.pyi").read_text(encoding="utf-8")
    assert "plot_toy as plot_toy" in stub
    assert places == 3


KIND_USED = """
import math
import numpy as np
from stickslip import Coulomb, Measurement, SpringBlock, check, fit, select, write_report
from stickslip.identify.kinds import kind_of
random = np.random.default_rng(0)
level, block = 0.25, SpringBlock(mass=0.5)
slides = Measurement(
    trials=[
        Measurement(
            # half of the acceleration times the time squared, read to a millimetre
            travel=0.5 * 9.81 * (math.sin(a) - level * math.cos(a)) * t**2 + 1e-3 * random.normal(),
            uncertainty=1e-3,
            overrides={"mechanism.incline": -a},
            conditions={"duration [ms]": 1e3 * t},
        )
        for a in (0.35, 0.45, 0.55) for t in (0.4, 0.8, 1.2) for _ in range(2)
    ]
)
kind = kind_of(slides)
assert kind.measured == "slides" and kind_of(Measurement(travel=0.1)).measured == "travels"
(said, *_) = check(slides, conditions=kind.conditions).sentences
assert said == "18 readings at 9 settings, 9 repeats.", said
found = fit(block, Coulomb, slides)
assert found.kind is kind
one, *_ = found.estimates
assert one.low < level < one.high and one.high - one.low < 0.02, str(found)
verdict = select(block, None, slides)
assert verdict.best.name == "coulomb", verdict
assert not any("are not used" in one for one in verdict.checks.sentences), verdict.checks
assert set(verdict.to_dataframe()["law"]) == {"coulomb", "viscous", "coulomb-viscous"}
assert next(c for c in verdict.candidates if c.name == "viscous").score > 5.0 * verdict.best.score
page = write_report(verdict, "report").read_text()
assert "Use Coulomb friction." in page
from stickslip.cli.judge import show_verdict
show_verdict(verdict)
assert found.plot().get_ylabel() == "way, m"
assert verdict.plot().get_xlabel()
assert "<svg" in found._repr_html_() and "<svg" in verdict._repr_html_()
from pathlib import Path
from stickslip.cli import main
rows = [
    f"{one.travel},0.001,{one.overrides['mechanism.incline']},{one.condition('duration', 'ms')}"
    for one in slides.records()
]
head = "travel [m],uncertainty [m],incline [rad],duration [ms]"
Path("slides.csv").write_text("\\n".join([head, *rows]))
Path("rig.toml").write_text(
    '[mechanism]\\ntype = "spring-block"\\nmass = "0.5 kg"\\nstiffness = "0 N/m"\\n'
    '[data]\\nfile = "slides.csv"\\nconditions = ["duration"]\\n'
)
assert main(["select", "rig.toml", "-o", "page"]) == 0
assert main(["fit", "rig.toml", "--law", "stribeck", "-o", "law.toml"]) == 0
"""


@pytest.mark.slow  # a kind of another package is used in the same way
def test_a_kind_is_a_file_and_touches_two_other_places(tree: Tree) -> None:
    registry = "identify/kinds/registry.py"
    places = contributed(
        tree,
        "toy_kind.py",
        "identify/kinds/toy.py",
        (registry, "OWN: tuple[AnyKind, ...] = (", "    SlideKind(),"),
        (
            registry,
            "from stickslip.identify.kinds.travels import TravelKind",
            "from stickslip.identify.kinds.toy import SlideKind",
        ),
    )
    run(tree, "-c", KIND_USED)
    assert places == 3


@pytest.mark.slow
def test_a_kind_of_another_package_is_used_like_ours(tree: Tree) -> None:
    package = tree / "src" / "toys"
    package.mkdir()
    (package / "__init__.py").touch()
    shutil.copy(TOYS / "toy_kind.py", package / "kind.py")
    about = tree / "src" / "toys-0.1.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: toys\nVersion: 0.1\n")
    (about / "entry_points.txt").write_text("[stickslip.kinds]\ntoy = toys.kind:SlideKind\n")
    assert "Coulomb + viscous" in run(tree, "-c", KIND_USED)


def test_what_is_registered_as_a_kind_and_is_none_is_said(tree: Tree) -> None:
    about = tree / "src" / "toys-0.1.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: toys\nVersion: 0.1\n")
    (about / "entry_points.txt").write_text("[stickslip.kinds]\ntoy = json:dumps\n")
    use = """
from stickslip.errors import StickslipError
from stickslip.identify.kinds import kinds
try:
    kinds()
except StickslipError as error:
    print(error)
"""
    assert "toys must be a class derived from Kind" in run(tree, "-c", use)
