"""Classes by import path in rig files: nothing runs before it is allowed, and then all works."""

import importlib
import sys
from pathlib import Path

import pytest

from stickslip import load_rig, simulate
from stickslip.cli import main
from stickslip.data import rig_schema
from stickslip.data.rigs.rig_writer import rig_toml
from stickslip.errors import InputError

MODULE = '''
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

from stickslip import Mechanism
from stickslip.friction import SetValuedLaw
from stickslip.mechanisms import Contact
from stickslip.quantities import Quantity

(Path(__file__).parent / "was-imported").touch()


@dataclass(frozen=True, kw_only=True)
class Sledge(Mechanism):
    """A mass on the ground."""

    name: ClassVar[str] = "sledge"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    speed: Annotated[float, Quantity("v_0", "m/s")] = 1.0

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

    def start(self):
        return {"v": self.speed}




@dataclass(frozen=True, kw_only=True)
class Twofold(SetValuedLaw):
    """Twice what Coulomb says."""

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


class Nameless(SetValuedLaw):
    def sliding(self, speed, load):
        return load

    def break_away(self, load):
        return load


@dataclass(frozen=True, kw_only=True)
class Namesake(Twofold):
    name: ClassVar[str] = "coulomb"


number = 5
'''

RIG = """
[mechanism]
type = "{module}:Sledge"
mass = "2 kg"
speed = 3.0

[friction]
kinetic_coefficient = 0.1

[friction.twofold]
type = "{module}:Twofold"

[run]
t_end = 5.0
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a rig file and a module beside it, which is not on Python's path."""
    module = f"own_{tmp_path.name.replace('-', '_')}"
    (tmp_path / f"{module}.py").write_text(MODULE, encoding="utf-8")
    (tmp_path / "rig.toml").write_text(RIG.format(module=module), encoding="utf-8")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    monkeypatch.setattr(sys, "path", list(sys.path))
    yield tmp_path
    sys.modules.pop(module, None)


def name_of(folder):
    return next(folder.glob("own_*.py")).stem


def was_imported(folder):
    return (folder / "was-imported").exists()


def rewritten(folder, old, new):
    rig = folder / "rig.toml"
    text = rig.read_text(encoding="utf-8")
    assert old in text
    rig.write_text(text.replace(old, new), encoding="utf-8")
    return rig


def test_without_permission_nothing_is_imported_and_the_message_says_how_to_allow_it(folder):
    path = list(sys.path)
    with pytest.raises(InputError) as raised:
        load_rig(folder / "rig.toml")
    text = str(raised.value)
    assert f"requests the import of Sledge from the Python module {name_of(folder)}" in text
    assert "--allow-import" in text
    assert "allow_import=True" in text
    assert not was_imported(folder)
    assert name_of(folder) not in sys.modules
    assert sys.path == path


def test_without_permission_no_law_is_imported_either(folder):
    rig = rewritten(folder, f"{name_of(folder)}:Sledge", "axis")
    text = rig.read_text(encoding="utf-8").replace("mass =", "inertia =").replace("speed = 3.0", "")
    rig.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"friction\.twofold\.type requests the import of Twofold"):
        load_rig(rig)
    assert not was_imported(folder)
    law = load_rig(rig, allow_import=True).laws["twofold"]
    assert law.break_away(10.0) == 2.0


@pytest.mark.parametrize(
    "command",
    [
        ["simulate", "RIG", "--law", "twofold"],
        ["simulate", "demo", "--set", "mechanism.type=MODULE:Sledge"],
        ["fit", "RIG"],
        ["select", "RIG"],
        ["animate", "RIG"],
        ["sweep", "RIG", "--vary", "mechanism.mass=1:2:2"],
        ["warmup", "--rig", "RIG"],
        ["check", "RIG"],
    ],
    ids=" ".join,
)
def test_no_command_imports_without_the_option(command, folder, capsys):
    words = {"RIG": str(folder / "rig.toml")}
    task = [words.get(word, word).replace("MODULE", name_of(folder)) for word in command]
    sys.path.append(str(folder))  # even where Python would find it
    with pytest.raises(SystemExit) as left:
        main(task)
    assert left.value.code == 2
    assert not was_imported(folder)
    assert "Traceback" not in capsys.readouterr().err


def test_the_schema_imports_nothing(folder, capsys):
    sys.path.append(str(folder))
    with pytest.raises(SystemExit) as left:
        main(["schema"])
    assert not left.value.code
    assert not was_imported(folder)
    assert "Sledge" not in capsys.readouterr().out
    assert "Sledge" not in str(rig_schema())


def test_with_permission_the_rig_runs_with_the_users_mechanism_and_law(folder):
    rig = load_rig(folder / "rig.toml", allow_import=True)
    assert was_imported(folder)
    assert (rig.mechanism.name, rig.mechanism.mass) == ("sledge", 2.0)
    run = simulate(rig.mechanism, rig.laws["twofold"], t_end=rig.t_end)
    # v^2 / (2 mu g) with the doubled coefficient
    assert run["x"][-1] == pytest.approx(9.0 / (2 * 0.2 * 9.81), rel=1e-12)
    run = simulate(rig.mechanism, rig.laws["coulomb"], t_end=rig.t_end)
    assert run["x"][-1] == pytest.approx(9.0 / (2 * 0.1 * 9.81), rel=1e-12)


def test_with_the_option_the_command_simulates_the_users_law(folder, capsys):
    task = ["simulate", str(folder / "rig.toml"), "--law", "twofold", "--allow-import", "--json"]
    with pytest.raises(SystemExit) as left:
        main(task)
    assert not left.value.code
    assert '"twofold"' in capsys.readouterr().out


def test_what_was_imported_is_not_in_the_registries_afterwards(folder):
    load_rig(folder / "rig.toml", allow_import=True)
    rig = rewritten(folder, f'type = "{name_of(folder)}:Twofold"', "")
    with pytest.raises(InputError, match=r"friction.twofold"):
        load_rig(rig, allow_import=True)


def test_a_rig_file_that_was_written_names_the_import_path(folder):
    rig = load_rig(folder / "rig.toml", allow_import=True)
    again = folder / "again.toml"
    again.write_text(rig_toml(rig.mechanism, rig.laws["twofold"]), encoding="utf-8")
    read = load_rig(again, allow_import=True)
    assert read.mechanism == rig.mechanism
    assert read.laws["twofold"] == rig.laws["twofold"]


BAD = {
    "no such module": (":Sledge", "nowhere:Sledge", r"module own\w*nowhere cannot be imported"),
    "no such class": (":Sledge", ":Slege", "has no Slege"),
    "not a class": (":Sledge", ":number", "must be a class derived from stickslip.Mechanism"),
    "a law for a mechanism": (":Sledge", ":Twofold", "derived from stickslip.Mechanism"),
    "a mechanism for a law": (":Twofold", ":Sledge", "derived from stickslip.FrictionLaw"),
    "incomplete": (":Sledge", ":Mechanism", "is abstract: implement contacts, drives"),
    "says nothing of itself": (":Twofold", ":Nameless", "implement name, title, formula, sources"),
    "two colons": (":Sledge", "::Sledge", "must be a name, or module:Class"),
    "other name": ("friction.twofold", "friction.double", r"write \[friction.twofold\]"),
    "a parameter": ("speed = 3.0", "sped = 3.0", "'sped'. Did you mean 'speed'"),
    "a range": ("2 kg", "-2 kg", r"mechanism.mass \(m\) must be above 0 kg, got '-2 kg'"),
}


@pytest.mark.parametrize(("old", "new", "message"), BAD.values(), ids=BAD)
def test_what_cannot_be_used_is_one_message_and_exit_code_2(folder, capsys, old, new, message):
    rig = rewritten(folder, old, new)
    with pytest.raises(InputError, match=message):
        load_rig(rig, allow_import=True)
    with pytest.raises(SystemExit) as left:
        main(["simulate", str(rig), "--allow-import"])
    assert left.value.code == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("import sys; sys.exit(0)", "SystemExit: 0"),
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("def f(:", "SyntaxError"),
        ("import there_is_no_such_module", "No module named 'there_is_no_such_module'"),
    ],
)
def test_a_module_that_fails_to_import_is_one_message(folder, capsys, code, message):
    (folder / f"{name_of(folder)}.py").write_text(code, encoding="utf-8")
    with pytest.raises(SystemExit) as left:
        main(["simulate", str(folder / "rig.toml"), "--allow-import"])
    assert left.value.code == 2
    error = capsys.readouterr().err
    assert "cannot be imported" in error
    assert message in error
    assert "Traceback" not in error


def test_a_law_may_not_take_the_name_of_one_that_is_there(folder):
    rig = rewritten(folder, "[friction.twofold]", "[friction.coulomb]")
    rewritten(folder, ":Twofold", ":Namesake")
    with pytest.raises(InputError, match="'coulomb' is already the name of another law"):
        load_rig(rig, allow_import=True)


def test_a_module_of_the_same_name_elsewhere_is_not_taken_for_the_one_beside_the_file(folder):
    other = folder / "elsewhere" / f"{name_of(folder)}.py"
    other.write_text(MODULE, encoding="utf-8")
    sys.path.insert(0, str(other.parent))
    importlib.invalidate_caches()
    with pytest.raises(InputError, match=r"is shadowed by a module of the same name, .*elsewhere"):
        load_rig(folder / "rig.toml", allow_import=True)
    assert Path(sys.modules[name_of(folder)].__file__) == other
