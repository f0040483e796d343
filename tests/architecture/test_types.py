"""What a type checker knows of the package: a user's script is checked with mypy, strictly."""

import ast
import doctest
import functools
import importlib
import inspect
import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import get_args

import pytest
from tests.support import for_all
from tools import stubs
from tools.lowest import lowest

import stickslip
import stickslip.show.plots
from stickslip.friction import LAWS
from stickslip.identify.kinds.registry import OWN
from stickslip.identify.kinds.verbs import OwnRouteName
from stickslip.lazy import Door
from stickslip.mechanisms import MECHANISMS
from stickslip.study.optimisation import GOALS, GoalName

ROOT = Path(__file__).parents[2]
Reported = Mapping[str, Sequence[str]]

CORRECT = """
from dataclasses import replace
from pathlib import Path

import numpy as np

import stickslip as st
from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    CoulombViscous,
    Dahl,
    FixedStep,
    LuGre,
    Measurement,
    Pendulum,
    PendulumCart,
    SerialArm,
    SpringBlock,
    Stribeck,
    TowedBlock,
    TwoMassAxis,
    ensemble,
    fit,
    load_measurement,
    load_rig,
    select,
    simulate,
)
from stickslip.study.control import PID, closed_loop
from stickslip.mechanisms.drives import Pulse, Sampled, SineSwing
from stickslip.friction import LAWS
from stickslip.mechanisms import Link, Torque
from stickslip.engine import EventTimes, Max
from stickslip.identify import LawFit, TravelVerdict
from stickslip.study.sweep import average_velocity
from stickslip.show.plots import draw_run, plot_run, save

block = SpringBlock(mass=1, stiffness=100.0, drive=Pulse(level=10.0, duration=0.1))
law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
run = simulate(block, law, t_end=1.0, y0={"x": 0.0}, solver=FixedStep(dt=1e-4))
last = float(run["x"][-1]) + run.events[0].t + run.certificate.energy_error
t = np.linspace(0.0, 1.0, 11)
signals = Sampled(times=t, values=t.tolist(), hold="first") + Pulse(level=1.0, duration=0.5)
reveal_type(run)
reveal_type(run["x"])
reveal_type(run.status)
reveal_type(run.to_dataframe())

one = Measurement(travel="200 mm", uncertainty="5 mm", uncertainty_kind="rounding")
both = Measurement(trials=[one, Measurement(travel=[0.1, 0.2], overrides={"mechanism.mass": 2})])
table = Measurement(velocity=t, friction=[float(x) for x in t], uncertainty={"friction": 0.1})
record = load_measurement(Path("run.csv"), columns={"position": ["x", "y"]}, repair="sort")
reveal_type(one.travel)
reveal_type(one.uncertainty)
reveal_type(record)
reveal_type(load_rig().measurement)

result = fit(block, Coulomb, one)
reveal_type(result)
print(result.law.kinetic_coefficient, result.estimates[0].low, result.law.name)
reveal_type(fit(block, law, one).law)
reveal_type(fit(block, "lugre", one).law)
found = fit(Axis(inertia=1.0), CoulombViscous, table, route="table",
            vary=["friction.*", "mechanism.inertia"], fixed={"mechanism.offset": 0})
print(found.law.viscous_coefficient)
if isinstance(found, LawFit):
    reveal_type(found.predict(record))

verdict = select(block, [Coulomb, "lugre", Stribeck], record, validate=record)
reveal_type(verdict)
reveal_type(verdict.sentence)
if verdict.best is not None:
    print(verdict.best.name, verdict.best.title, verdict.best.fit)
if isinstance(verdict, TravelVerdict):
    reveal_type(verdict.best)
foreign = select(block, None, record, route="route-of-another-package")
for candidate in foreign.candidates:
    print(candidate.name, candidate.score, foreign.score_unit)
reveal_type(st.check(record, mechanism=block))

runs = ensemble(block, law, {"friction.kinetic_coefficient": t}, t_end=1.0,
                outputs={"fastest": Max("v"), "rest": EventTimes("stop")})
reveal_type(runs)
reveal_type(runs["fastest"])
motor = Torque(drive=Pulse(level=1.0, duration=1.0))
capsule = Capsule(capsule_mass=1.0, inner_mass=0.5, drive=motor)
swing = SineSwing(amplitude=0.1, frequency=2.0)
reveal_type(swing.period)
reveal_type(average_velocity(capsule, law, {"mechanism.inner_mass": [0.1, 0.2]}))
reveal_type(closed_loop(block, law, PID(proportional=1.0), period=0.001, t_end=1.0))
reveal_type(LAWS["coulomb"])
reveal_type(st.__version__)
reveal_type(run.plot())
reveal_type(result.plot())
reveal_type(verdict.plot())
reveal_type(runs.plot())
reveal_type(plot_run(run, run.plot(), normal_force=True))
reveal_type(result.to_dataframe())
reveal_type(verdict.to_dataframe())
reveal_type(runs.to_xarray())
if isinstance(verdict, TravelVerdict):
    reveal_type(verdict.band([0.1]).low)

sprung = SpringBlock(mass="1 kg", stiffness="100 N/m", lower_stop="-10 mm", upper_stop=None)
cold = Stribeck(kinetic_coefficient="0.2", static_coefficient=0.3, stribeck_velocity="20 mm/s")
pushed = Pulse(level="10 N", duration="100 ms")
reveal_type(sprung.mass)
reveal_type(sprung.upper_stop)
reveal_type(replace(cold, static_coefficient=0.4))
reveal_type(Dahl.from_forces(load=1.0, kinetic_force=0.2, bristle_stiffness=1e4))
reveal_type(SerialArm(links=(Link(mass="1 kg", length="0.5 m", centre=0.2, inertia=0.1),)).links[0])
warm: Coulomb = replace(law, kinetic_coefficient=0.2)
reveal_type(draw_run(run))
"""
REVEALED = (
    "Trajectory",
    "ndarray[tuple[Any, ...], dtype[float64]]",
    "Status",
    "DataFrame",
    "ndarray[tuple[Any, ...], dtype[float64]] | float | None",
    "Mapping[str, ndarray[tuple[Any, ...], dtype[float64]] | float]",
    "Measurement",
    "Measurement | None",
    "Fit[Coulomb]",
    "Coulomb",
    "FrictionLaw",
    "Foreseen",
    "Verdict[Candidate[Fit[Any]]]",
    "str",
    "TravelCandidate | None",
    "Checks",
    "Ensemble",
    "ndarray[tuple[Any, ...], dtype[float64]]",
    "float",
    "VelocityMap",
    "ClosedLoop",
    "type[FrictionLaw]",
    "str",
    "ndarray[tuple[Any, ...], dtype[object_]]",
    "Axes",
    "Axes",
    "Axes",
    "ndarray[tuple[Any, ...], dtype[object_]]",
    "DataFrame",
    "DataFrame",
    "Dataset",
    "ndarray[tuple[Any, ...], dtype[float64]]",
    "float",
    "float | None",
    "Stribeck",
    "Dahl",
    "Link",
)

MISTAKES = """
from stickslip import *
from stickslip import Coloumb  # !
import stickslip
import stickslip.show.plots

block = SpringBlock(mass=1.0)
law = Coulomb(kinetic_coefficient=0.25)
reading = Measurement(travel=0.2)
x: int = simulate("nonsense", 3)  # !
simulate(block, law)  # !
simulate(block, 0.25, t_end=1.0)  # !
simulate(block, law, t_end=1.0, tolerance=1e-3)  # !
simulate(block, law, t_end=1.0, solver="rk4")  # !
simulate(block, law, t_end=1.0).energy  # !
simulate(block, law, t_end=1.0)["x"].nonsense  # !
SpringBlock(mass=["1 kg"])  # !
SpringBlock(mass=b"1 kg")  # !
SpringBlock(mass="1 kg", drive="10 N")  # !
SpringBlock(mass="1 kg", attached="yes")  # !
SpringBlock(mass="1 kg").mass.upper()  # !
SpringBlock(mas="1 kg")  # !
SpringBlock("1 kg")  # !
BlockChain(blocks="3", mass=1.0, coupling=1.0, stiffness=1.0, speed=0.1)  # !
SpringBlock(stiffness=1.0)  # !
Coulomb(kinetic_coeficient=0.25)  # !
Coulomb(0.25)  # !
law.kinetic_coefficient = 0.3  # !
law.viscous_coefficient  # !
EventDriven(tier="fast")  # !
FixedStep(dt=1e-3, method="leapfrog")  # !
Measurement(travel={"x": 0.2})  # !
Measurement(travell=0.2)  # !
Measurement(travel=0.2, uncertainty_kind="guessed")  # !
reading.travel + 1.0  # !
Sampled(times="now", values=[1.0])  # !
load_measurement("a.csv", repair="all")  # !
load_measurement("a.csv", colums={})  # !
fit(block, reading, law)  # !
fit(block, Coulomb, reading).law.viscous_coefficient  # !
fit(block, Coulomb, reading, route=3)  # !
select(block, None, reading).experiments  # !
fit(block, Coulomb, reading).residuals  # !
select(block, [Coulomb, SpringBlock], reading)  # !
select(block, None, reading, routes="balance")  # !
select(block, None, reading, unknown=["mass"])  # !
select(block, reading, [Coulomb])  # !
select(block, None, reading).best.name  # !
ensemble(block, law, {"friction.kinetic_coefficient": [0.1, 0.2]})  # !
ensemble(block, law, {}, t_end=1.0, outputs={"fastest": "v"})  # !
average_velocity(block, law, [1.0])  # !
closed_loop(block, law, 3.0, period=0.001, t_end=1.0)  # !
optimise(block, law, {"mass": (1.0, 2.0)}, goals="beauty")  # !
animate(simulate(block, law, t_end=1.0), law, "a.gif")  # !
simulate(block, law, t_end=1.0).plot("axes")  # !
simulate(block, law, t_end=1.0).plot().set_title("panels")  # !
fit(block, Coulomb, reading).plot(color="red")  # !
stickslip.show.plots.plot_run(law)  # !
y: int = load_rig()  # !
stickslip.simulte  # !
stickslip.__version__ + 1  # !
"""

FROM_A_FILE = {"examples.load_rig", "examples.write_report"}
"""Examples that ask what a file held for what only one law or mechanism has."""


NAMESPACES = ["stickslip"]
NAMESPACES += [
    f"stickslip.{name}"
    for name in ("engine", "identify", "mechanisms.drives", "study.control", "study.sweep")
]
PUBLIC = {
    name: getattr(module, name)
    for module in map(importlib.import_module, NAMESPACES)
    for name in module.__all__
    if not isinstance(getattr(module, name), ModuleType)
}


@functools.cache
def imports_of(name: str) -> list[str]:
    """Return the imports at the top of a module, which is read once for all its examples."""
    return [
        ast.unparse(node)
        for node in ast.parse(inspect.getsource(importlib.import_module(name))).body
        if isinstance(node, (ast.Import, ast.ImportFrom))
    ]


def example_of(value: object) -> str:
    """Return the example of a docstring as a function below the imports of its module."""
    imports = imports_of(value.__module__)
    lines = [
        f"    {line}"
        for example in doctest.DocTestParser().get_examples(inspect.getdoc(value) or "")
        for line in example.source.splitlines()
    ]
    # fields of composed laws stand in the stub of the package alone
    home = "stickslip.friction" if getattr(value, "made_of", None) else value.__module__
    head = [*imports, f"from {home} import *", "def example() -> None:"]
    return "\n".join([*head, *lines, ""])


EXAMPLES = {
    f"examples.{name}": example_of(value)
    for name, value in PUBLIC.items()
    if ">>>" in (inspect.getdoc(value) or "")
}

CONFIG = """
[[tool.mypy.overrides]]
module = ["examples.*"]
# an example may use a name for two things, needs no types of its own, and finds what it looks for
allow_redefinition = true
disallow_untyped_defs = false
disallow_incomplete_defs = false
disallow_untyped_calls = false
strict_optional = false
warn_unreachable = false
ignore_missing_imports = true
disable_error_code = ["assignment"]
"""
"""What examples need beside the options of the project, whose results mypy may then use again."""


@pytest.fixture(scope="module")
def reported(
    tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest
) -> Mapping[str, Sequence[str]]:
    """What mypy says of each script, checked as a user of the package would; one run for all."""
    scripts = {"correct": CORRECT, "mistakes": MISTAKES, **EXAMPLES}
    for module in (stickslip, stickslip.show.plots):
        name = module.__name__
        lines = [f"import {name}", *(f"reveal_type({name}.{one})" for one in module.__all__)]
        scripts[f"names_{name.replace('.', '_')}"] = "\n".join(lines)
    folder = tmp_path_factory.mktemp("scripts")
    scripts["examples.__init__"] = ""
    known = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    options = known[known.index("[tool.mypy]") : known.index("[tool.pytest")]
    (folder / "pyproject.toml").write_text(options + CONFIG, encoding="utf-8")
    for name, text in scripts.items():
        path = folder / f"{name.replace('.', '/')}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text.lstrip("\n"), encoding="utf-8")
    cache = request.config.cache.mkdir("mypy-of-users")
    if (ROOT / ".mypy_cache").is_dir():
        shutil.copytree(ROOT / ".mypy_cache", cache, dirs_exist_ok=True)
    done = subprocess.run(
        [*(sys.executable, "-m", "mypy", f"--cache-dir={cache}", "--no-error-summary"), "."],
        cwd=folder,
        env={**os.environ, "MYPYPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1, done.stdout + done.stderr  # 2 is a failure of mypy itself
    found: dict[str, list[str]] = {name: [] for name in scripts}
    for line in done.stdout.splitlines():
        found[line.partition(".py:")[0].replace("/", ".")].append(line)
    return found


def short(revealed: str) -> str:
    """Return a type without the modules of its parts."""
    return re.sub(r"(?<![\w.])(?:\w+\.)+(?=\w)", "", revealed)


def errors(lines: Sequence[str]) -> list[str]:
    return [line for line in lines if ": error:" in line]


def test_a_correct_script_passes_mypy_strict_and_has_types_everywhere(reported: Reported) -> None:
    assert errors(reported["correct"]) == []
    notes = [line.partition('Revealed type is "')[2].rstrip('"') for line in reported["correct"]]
    types = [short(note) for note in notes if note]
    assert types[:-1] == list(REVEALED)
    assert types[-1].startswith("def (")


def test_each_mistake_in_a_script_is_reported_and_nothing_else(reported: Reported) -> None:
    code = MISTAKES.lstrip("\n").splitlines()
    wrong = {i for i, line in enumerate(code, 1) if line.endswith("# !")}
    found = {int(line.split(":")[1]) for line in errors(reported["mistakes"])}
    assert {code[i - 1] for i in wrong ^ found} == set()


@pytest.mark.parametrize("module", [stickslip, stickslip.show.plots])
def test_every_public_name_is_known_to_a_type_checker(
    reported: Reported, module: ModuleType
) -> None:
    lines = reported[f"names_{module.__name__.replace('.', '_')}"]
    assert len(lines) == len(module.__all__)
    for name, line in zip(module.__all__, lines, strict=True):
        assert "Revealed type is" in line, line
        assert '"Any"' not in line, line
        value = getattr(module, name)
        if inspect.isclass(value):
            homes = value.__module__, module.__name__, value.__module__.rpartition(".")[0]
            assert any(f" -> {home}.{value.__qualname__}" in line for home in homes), line


def test_the_examples_of_public_names_pass_the_type_checker(reported: Reported) -> None:
    for name in sorted(FROM_A_FILE):
        (line,) = errors(reported[name])
        assert "[attr-defined]" in line
    wrong = [line for name in EXAMPLES.keys() - FROM_A_FILE for line in errors(reported[name])]
    assert wrong == []


@for_all(stubs.PACKAGES)
def test_the_stub_of_a_package_is_in_order_and_has_what_is_registered(package: str) -> None:
    path = stubs.folder(package) / "__init__.pyi"
    assert path.read_text(encoding="utf-8") == stubs.stub(package), "run `make stubs`"


def test_a_law_that_is_registered_no_more_leaves_the_stub(monkeypatch: pytest.MonkeyPatch) -> None:
    known = Door("stickslip.friction")
    known.homes["Gone"], known.public = "stickslip.friction.named", [*known.public, "Gone"]
    monkeypatch.setattr("stickslip.lazy.Door", lambda _: known)
    found = stubs.door("stickslip.friction")
    assert "Gone" not in found.homes
    assert "Gone" not in found.public
    assert "Stribeck" in found.homes


def test_every_package_that_loads_lazily_has_a_stub() -> None:
    lazy = {
        ".".join(path.parent.relative_to(stubs.SOURCE).parts)
        for path in stubs.SOURCE.rglob("__init__.py")
        if "__getattr__" in path.read_text(encoding="utf-8")
    }
    assert lazy == set(stubs.PACKAGES)


@pytest.mark.parametrize(
    ("type_", "names"),
    [
        (OwnRouteName, {name for kind in OWN for name in kind.routes if "route" in kind.uses}),
        (GoalName, tuple(GOALS)),
    ],
)
def test_a_type_of_names_lists_the_names_that_are_taken(
    type_: object, names: Collection[str]
) -> None:
    assert sorted(get_args(type_)) == sorted(names)


def test_the_wheel_has_the_stubs_and_the_mark_of_a_typed_package(tmp_path: Path) -> None:
    build = pytest.importorskip("hatchling.builders.wheel")
    (path,) = build.WheelBuilder(str(ROOT)).build(directory=str(tmp_path), versions=["standard"])
    names = set(zipfile.ZipFile(path).namelist())
    stubbed = {f"{package.replace('.', '/')}/__init__.pyi" for package in stubs.PACKAGES}
    assert {"stickslip/py.typed", *stubbed} <= names


def test_every_dependency_of_the_package_and_its_extras_names_its_lowest_version() -> None:
    extras = "dask logs mdf parquet sensitivity xarray bench docs"
    assert all(re.match(r"[\w.\[\]-]+==\d", line) for line in lowest(extras.split()))
    with pytest.raises(SystemExit, match=r"must be NAME>=VERSION"):
        lowest(["dev"])  # names the package itself


def test_registered_laws_and_mechanisms_are_public() -> None:
    registered = [*LAWS.values(), *MECHANISMS.values()]
    assert {kind.__name__ for kind in registered} <= set(stickslip.__all__)
