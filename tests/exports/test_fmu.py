"""FMUs give what the solver gives, at any communication step, and need no Python."""

import ctypes
import dataclasses
import itertools
import platform
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.exports.fmus import (
    BLOCK,
    CAPSULE,
    COULOMB,
    END,
    LUGRE,
    SCRIPT,
    STRIBECK,
    TWELVE,
    WAITS,
    Slave,
    column_names,
    held,
    made,
    need_tools,
)
from tests.support import RIGS, SHOWN, examples, laws

from stickslip import (
    Axis,
    BlockChain,
    Capsule,
    Coulomb,
    PendulumCart,
    SpringBlock,
    export,
    simulate,
)
from stickslip.cli import main
from stickslip.engine.formulation import formulate
from stickslip.errors import InputError, UnknownNameError
from stickslip.exports import export_fmu
from stickslip.exports.fmu.export import BASES, base_units, variables_of, with_inputs
from stickslip.friction import LAWS
from stickslip.maths import sqrt
from stickslip.mechanisms import (
    MECHANISMS,
    BoundedMechanism,
    Contact,
    Link,
    Mechanism,
    Prescribed,
    SerialArm,
    Stop,
    Torque,
    input_names,
)
from stickslip.mechanisms.drives import Pulse, Sine, Square, ThreePhase
from stickslip.quantities import Quantity, fields_of, turned
from stickslip.units import per_second

CHAIN = BlockChain(blocks=2, mass=1.0, coupling=4.0, stiffness=1.0, speed=0.1)
CART = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3)
PUSHES = np.round(0.12 * np.sin(3.0 * WAITS * np.arange(41)), 3).tolist()
NUMBERS = itertools.count()
"""Of libraries, which a process loads by their names."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need_tools()
    return tmp_path_factory.mktemp("fmu")


@pytest.fixture(scope="module")
def block(folder: Path) -> Path:
    return made(folder, "block", BLOCK, COULOMB)


@pytest.fixture(scope="module")
def capsule(folder: Path) -> Path:
    return made(folder, "capsule", CAPSULE, LUGRE, fmi=2)


@pytest.fixture(scope="module")
def chain(folder: Path) -> Path:
    return made(folder, "chain", CHAIN, STRIBECK, y0={"v1": 0.4}, title="A <chain> & its law")


@pytest.fixture(scope="module")
def cart(folder: Path) -> Path:
    """With the torque at its pivot as an input; the pendulum has no drive of its own."""
    return made(folder, "cart", CART, COULOMB, inputs=["pendulum.drive"])


def compare(path: Path, folder: Path, mechanism: Mechanism, law: Any, **settings: Any) -> None:
    """Compare all outputs with a run of the engine, at two communication steps.

    They are the same machine code, and the FMU reads its values off the same steps.
    """
    run = simulate(mechanism, law, t_end=END, throw=False, **settings)
    for count in (20, 147):
        slave = Slave(path, folder).begin(stopTime=END)
        times = np.linspace(0.0, END, count + 1)
        names = column_names(slave)
        seen = slave.played(times.tolist(), names)
        for name, column in zip(names, seen.T, strict=True):
            np.testing.assert_array_equal(column, run.at(times)[name], err_msg=name)
        assert slave.whole("event_count") == len(run.events)
        slave.close()


def test_outputs_are_those_of_the_engine_whatever_the_communication_step(
    block, capsule, chain, folder
):
    compare(block, folder, BLOCK, COULOMB)
    compare(capsule, folder, CAPSULE, LUGRE)
    compare(chain, folder, CHAIN, STRIBECK, y0={"v1": 0.4})


def test_the_travel_is_that_of_the_closed_form(block, folder):
    slave = Slave(block, folder).begin()
    slave.step(END)
    # the spring's energy less that taken on its way: v^2/2 = k X^2/2 - mu g X, then v^2 / (2 mu g)
    travel = 0.1 + (100.0 * 0.1**2 / 2 - 0.25 * 9.81 * 0.1) / (0.25 * 9.81)
    np.testing.assert_allclose(slave.got("x"), travel, rtol=1e-12)
    assert slave.whole("mode") == 0
    slave.close()


def test_descriptions_are_valid_and_say_units(block, capsule, chain, cart):
    from fmpy import read_model_description
    from fmpy.validation import validate_fmu

    for path in (block, capsule, chain, cart):
        assert validate_fmu(str(path)) == []
    known = {
        variable.name: variable for variable in read_model_description(str(cart)).modelVariables
    }
    assert (known["pendulum.drive"].causality, known["pendulum.drive"].unit) == ("input", "N m")
    assert known["mechanism.cart_mass"].unit == "kg"
    assert known["omega"].unit == "rad/s"
    assert known["friction.kinetic_coefficient"].variability == "tunable"
    assert read_model_description(str(chain)).description == "A <chain> & its law"


def test_an_input_is_held_over_each_step(cart, folder):
    run = simulate(
        PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Torque(drive=held(PUSHES))),
        COULOMB,
        t_end=END,
    )
    slave = Slave(cart, folder)
    slave.put("pendulum.drive", PUSHES[0])
    slave.begin()
    for i, push in enumerate(PUSHES[:-1]):
        slave.put("pendulum.drive", push)
        slave.step(WAITS * (i + 1))
        states = [run.at(np.array([slave.t]))[name][0] for name in run.states]
        # the run that knows all pushes beforehand takes other steps before some of them
        np.testing.assert_allclose(slave.got(*run.states), states, rtol=1e-9, atol=1e-11)
    assert slave.whole("event_count") == len(run.events) > 3
    slave.close()


def test_outputs_at_the_start_are_those_of_the_inputs_there(cart, folder):
    slave = Slave(cart, folder)
    slave.put("pendulum.drive", 0.1)
    slave.begin()
    pushed = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Torque(drive=held([0.1, 0.1]))
    )
    run = simulate(pushed, COULOMB, t_end=0.1)
    friction = [run.at(np.zeros(1))[name][0] for name in ("friction", "normal_force")]
    np.testing.assert_allclose(slave.got("friction", "normal_force"), friction, rtol=1e-12)
    slave.close()


def test_a_state_is_brought_back_into_its_own_or_another_instance(capsule, chain, folder):
    for path in (capsule, chain):
        first, second = Slave(path, folder).begin(), Slave(path, folder).begin()
        names, times = column_names(first), np.linspace(0.7, END, 9).tolist()
        first.step(times[0])
        save = first.fmu.getFMUState if not first.is_2 else first.fmu.getFMUstate
        state = save()
        wanted = first.played(times, names)
        back = first.fmu.setFMUState if not first.is_2 else first.fmu.setFMUstate
        back(state)
        first.t = times[0]
        np.testing.assert_array_equal(first.played(times, names), wanted)
        both = ("serializeFMUState", "deserializeFMUState", "setFMUState")
        if first.is_2:
            both = ("serializeFMUstate", "deSerializeFMUstate", "setFMUstate")
        stored = getattr(first.fmu, both[0])(state)
        getattr(second.fmu, both[2])(getattr(second.fmu, both[1])(stored))
        second.t = times[0]
        np.testing.assert_array_equal(second.played(times, names), wanted)
        first.close()
        second.close()


def test_a_state_of_another_fmu_is_refused(chain, block, folder):
    one, other = Slave(chain, folder).begin(), Slave(block, folder).begin()
    stored = one.fmu.serializeFMUState(one.fmu.getFMUState())
    with pytest.raises(Exception, match="failed"):
        other.fmu.deserializeFMUState(stored)
    assert other.messages == ["The serialized state is not one of this FMU."]
    one.close()
    other.close()


def test_two_instances_do_not_touch_each_other_and_reset_begins_anew(block, folder):
    one = Slave(block, folder).begin({"friction.kinetic_coefficient": 0.5})
    two = Slave(block, folder).begin()
    for t in (0.1, 0.2, 0.5, 1.0):
        one.step(t)
        two.step(t)
    for slave, mu in ((one, 0.5), (two, 0.25)):
        law = Coulomb(kinetic_coefficient=mu)
        assert slave.got("x")[0] == simulate(BLOCK, law, t_end=END)["x"][-1]
    one.fmu.reset()
    one.begin()
    one.step(1.0)
    assert one.got("x") == two.got("x")
    one.close()
    two.close()


def test_states_and_parameters_can_be_set_before_the_simulation(block, folder):
    values = {"v": 0.3, "mechanism.mass": 2.0, "mechanism.incline": 0.2}
    slave = Slave(block, folder).begin(values)
    other = SpringBlock(mass=2.0, stiffness=100.0, compression=0.1, incline=0.2)
    run = simulate(other, COULOMB, t_end=END, y0={"v": 0.3})
    assert slave.got("normal_force")[0] == run["normal_force"][0]
    slave.step(0.15)
    assert slave.got("x")[0] == run.at(np.array([0.15]))["x"][0]
    slave.close()


@final
@dataclass(frozen=True, kw_only=True)
class Box(BoundedMechanism):
    """A body whose upper stop is a function of a parameter."""

    name: ClassVar[str] = "box"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)
    area: Annotated[float, Quantity("A", "m^2", above=0)] = 4.0

    def kinetic_energy(self, q, q_dot):
        return 0.5 * q_dot["x"] * q_dot["x"]

    def potential_energy(self, t, q):
        return 0.5 * q["x"] * q["x"]

    def forces(self, t, q, q_dot, drives):
        return {}

    def drives(self):
        return {}

    def contacts(self):
        return (Contact(name="pad", slip="x", load=1.0),)

    def stops(self):
        return (Stop(coordinate="x", position=sqrt(self.area), side="upper", restitution=0.5),)


def test_stops_that_are_functions_of_parameters_are_where_they_belong_from_the_start(folder):
    law = Coulomb(kinetic_coefficient=0.01)
    path = made(folder, "box", Box(), law, y0={"x": 1.0})
    for area in (4.0, 1.44):
        slave = Slave(path, folder).begin({"mechanism.area": area, "v": 3.0})
        run = simulate(Box(area=area), law, t_end=END, y0={"x": 1.0, "v": 3.0})
        assert run["x"].max() == pytest.approx(area**0.5, rel=1e-12)  # it reaches the stop
        slave.step(END)
        assert slave.got("x")[0] == run["x"][-1]
        slave.close()
    slave = Slave(path, folder)
    with pytest.raises(Exception, match="failed"):
        slave.begin({"mechanism.area": 0.81})
    assert "x begins at 1, beyond its upper stop at 0.9." in slave.messages[-1]
    slave.close()


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"mechanism.mass": 0.0}, "mechanism.mass must be above 0 kg, got 0."),
        ({"friction.kinetic_coefficient": -0.1}, "must be at least 0, got -0.1"),
        ({"x": float("nan")}, "x must be a finite number, got nan"),
    ],
)
def test_values_out_of_range_are_refused_in_words(block, folder, values, words):
    slave = Slave(block, folder)
    with pytest.raises(Exception, match="failed"):
        slave.begin(values)
    assert words in slave.messages[-1]
    slave.close()


def test_what_is_too_late_or_out_of_order_is_refused_in_words(block, folder):
    slave = Slave(block, folder).begin()
    for action, words in (
        (lambda: slave.put("v", 2.0), "v cannot be set after initialization."),
        (lambda: slave.put("friction", 1.0), "friction cannot be set: it is computed."),
        (lambda: slave.fmu.doStep(0.5, 0.1), "does not follow t = 0 s"),
        (lambda: slave.fmu.doStep(0.0, -0.1), "A step of -0.1 s"),
        (lambda: slave.fmu.getFloat64([999]), "No real variable has the value reference 999."),
    ):
        with pytest.raises(Exception, match="failed"):
            action()
        assert words in slave.messages[-1]
    slave.step(0.1)  # none of it did any harm
    assert slave.got("x")[0] == simulate(BLOCK, COULOMB, t_end=END).at(np.array([0.1]))["x"][0]
    slave.close()


def test_a_start_beyond_a_stop_is_refused_in_words(capsule, folder):
    slave = Slave(capsule, folder)
    with pytest.raises(Exception, match="failed"):
        slave.begin({"xi": 0.05})
    assert slave.messages[-1] == "xi begins at 0.05, beyond its upper stop at 0.04."
    slave.close()


def test_the_simulation_may_go_on_after_the_default_stop_time(block, folder):
    spring = Slave(block, folder).begin()
    spring.step(3.7 * END)
    np.testing.assert_allclose(spring.got("x", "v"), [0.2038735984, 0.0], atol=1e-9)
    spring.close()


def test_a_simulation_may_start_at_another_time(block, chain, folder):
    # nothing depends on time here: the same motion, later, but for the rounding of later times
    late, early = Slave(block, folder).begin(startTime=4.0), Slave(block, folder).begin()
    late.step(4.125)
    early.step(0.125)
    np.testing.assert_allclose(late.got("x", "v"), early.got("x", "v"), rtol=1e-14)
    assert late.got("v")[0] > 0.5
    late.close()
    early.close()
    # the tow has come farther by then
    late, early = Slave(chain, folder).begin(startTime=50.0), Slave(chain, folder).begin()
    late.step(51.0)
    early.step(1.0)
    assert abs(late.got("x1")[0] - early.got("x1")[0]) > 0.1
    late.close()
    early.close()


def test_a_run_that_ends_says_so_and_keeps_its_last_values(folder):
    cart = SHOWN["pendulum-cart"]
    run = simulate(cart, COULOMB, t_end=4.0, throw=False)
    end = run.span[1]
    assert "Lift-off" in run.ending
    for fmi in (2, 3):
        slave = Slave(made(folder, f"lift{fmi}", cart, COULOMB, fmi=fmi, t_end=4.0), folder).begin()
        if fmi == 2:
            with pytest.raises(Exception, match=r"discard|failed") as caught:
                slave.step(4.0)
            assert caught.value.status == 2
            assert slave.fmu.getBooleanStatus(3)
            assert slave.fmu.getRealStatus(2) == end
        else:
            assert slave.step(4.0) == (False, True, False, end)
        assert slave.got("x")[0] == run["x"][-1]
        assert slave.messages[-1].endswith("s: Lift-off: the normal force fell to zero.")
        slave.close()


def test_drives_that_repeat_are_known_up_to_the_end_and_no_farther(folder):
    axis = Axis(inertia=2.0, drive=Square(high=4.0, low=-1.0, period=0.3, duty=0.3))
    slave = Slave(made(folder, "square", axis, COULOMB), folder).begin()
    slave.step(END)
    run = simulate(axis, COULOMB, t_end=END)
    assert slave.got("x")[0] == run["x"][-1]
    with pytest.raises(Exception, match="failed"):
        slave.step(END + 0.1)
    assert "known up to t = 2 s" in slave.messages[-1]
    slave.close()


def test_what_tables_are_made_with_is_constant():
    axis = Axis(inertia=2.0, drive=Sine(amplitude=4.0, frequency=0.5), offset=0.1)
    model = formulate(axis, COULOMB)
    found = variables_of(axis, COULOMB, model, y0=[0.0, 0.0], nominals=[1.0] * 4, inputs={})
    roles = {one.name.rpartition(".")[2]: one.role for one in found}
    assert roles["frequency"] == "constant"  # the largest step follows from it
    assert {roles[name] for name in ("amplitude", "phase", "inertia", "offset")} == {"parameter"}
    chirp = Capsule(
        capsule_mass=0.8,
        inner_mass=0.2,
        drive=Prescribed(profile=ThreePhase(amplitude=0.01, fast=50.0, slow=9.0)),
    )
    model = formulate(chirp, COULOMB)
    found = variables_of(chirp, COULOMB, model, y0=[0.0] * 4, nominals=[1.0] * 4, inputs={})
    fixed = {one.name.rpartition(".")[2] for one in found if one.role == "constant"}
    assert fixed == {"amplitude", "fast", "slow"}


def test_the_same_model_gives_the_same_file(block, folder):
    again = made(folder, "again", BLOCK, COULOMB, name="block")
    assert again.read_bytes() == block.read_bytes()
    other = made(folder, "other", BLOCK, Coulomb(kinetic_coefficient=0.3), name="block")
    with zipfile.ZipFile(other) as one, zipfile.ZipFile(block) as two:
        assert one.namelist() == two.namelist()
        assert one.read("modelDescription.xml") != two.read("modelDescription.xml")


def test_a_description_of_another_model_is_refused(block, folder):
    from fmpy import extract
    from fmpy.fmi3 import FMU3Slave

    place = extract(str(block), str(folder / "torn"))
    # "block" is a word of Modelica, which no name of a program is
    slave = FMU3Slave(
        guid="{0}", unzipDirectory=place, modelIdentifier="block_", instanceName="one"
    )
    said: list[str] = []
    with pytest.raises(Exception, match="Failed to instantiate"):
        slave.instantiate(logMessage=lambda *given: said.append(given[-1].decode()))
    assert said[0].startswith("The token {0} is not that of this FMU")


def test_only_functions_of_the_standard_are_seen_from_outside(block, folder):
    Slave(block, folder).close()
    (library,) = (folder / "block").rglob("*.so")
    seen = ctypes.CDLL(str(library))
    assert hasattr(seen, "fmi3DoStep")
    assert not any(hasattr(seen, name) for name in ("enter_run", "equations", "fmi2DoStep"))


def test_an_fmu_runs_without_any_package(block, folder):
    assert run_alone(block, folder) == simulate(BLOCK, COULOMB, t_end=END)["x"][-1]


def run_alone(path: Path, folder: Path, column: str = "x") -> float:
    """Run an FMU by a Python that finds no package and no file of this one; return a column."""
    slave = Slave(path, folder)
    (library,) = (folder / path.stem).rglob("*.so")
    reference = slave.variables[column].valueReference
    arguments = (str(library), slave.description.guid, str(reference), str(END), "40")
    slave.close()
    command = [sys.executable, "-I", "-S", "-c", SCRIPT, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env={})
    assert done.returncode == 0, done.stderr
    return float.fromhex(done.stdout)


# --- inputs, units and messages, without making an FMU


def test_inputs_are_found_by_name_or_by_place():
    axis = Axis(inertia=2.0, drive=Pulse(level=5.0, duration=1.0))
    driven, found = with_inputs(axis, ["drive"])
    assert found == {"drive": ("drive", 5.0)}
    assert driven.drives()["drive"].value(0.5) == 0.0
    drive = Sine(amplitude=1.0, frequency=1.0)
    link = Link(mass=1.0, length=0.5, centre=0.2, inertia=0.1, torque=drive)
    arm = SerialArm(links=[link, link])
    driven, found = with_inputs(arm, ["torque-2"])  # though both have one object
    assert driven.drives()["torque-1"] is drive
    assert driven.drives()["torque-2"].value(0.25) == 0.0
    idle = SerialArm(links=[dataclasses.replace(link, torque=None), link])
    driven, found = with_inputs(idle, ["links.0.torque", "torque-2"])
    assert found == {"links.0.torque": ("torque-1", 0.0), "torque-2": ("torque-2", 0.0)}
    assert list(driven.drives()) == ["torque-1", "torque-2"]


@pytest.mark.parametrize(
    ("mechanism", "names", "error", "words"),
    [
        (SHOWN["capsule, prescribed"], ["motor"], InputError, "prescribed motion"),
        (SHOWN["capsule, prescribed"], ["drive.profile"], UnknownNameError, "drive.profile"),
        (BLOCK, ["push"], UnknownNameError, "unknown drive 'push'"),
        (BLOCK, ["drive", "drive"], InputError, "named twice"),
        (CART, ["motor", "pendulum.drive"], InputError, "named twice"),
    ],
)
def test_what_cannot_be_an_input_is_refused(mechanism, names, error, words):
    with pytest.raises(error, match=words):
        with_inputs(mechanism, names)


def test_each_unit_of_the_package_is_one_of_the_description():
    kinds: list[Any] = [*LAWS.values(), *MECHANISMS.values(), Pulse, Sine, Square, ThreePhase]
    quantities = itertools.chain.from_iterable(fields_of(kind).values() for kind in kinds)
    for unit in {one for q in quantities for one in (q.unit, q.or_unit) if one}:
        base_units(unit)
        base_units(turned(unit))
        for one in (unit, turned(unit)):
            powers = dict.fromkeys(BASES, 0) | base_units(one)
            powers["s"] -= 1
            rate = per_second(one)
            assert base_units(rate) == {base: power for base, power in powers.items() if power}
            assert " " not in rate.partition("/")[2].strip("()") or rate.endswith(")")  # clear
    assert per_second("") == ""
    assert per_second("s") == "1"
    assert per_second("Hz") == "Hz/s"
    with pytest.raises(InputError, match="'furlong'"):
        base_units("furlong/s")


def test_refusals_leave_no_file(folder, monkeypatch):
    def refused(words: str, *pair: Any, file: str = "no.fmu", **settings: Any) -> None:
        with pytest.raises(InputError, match=words):
            export_fmu(*pair, folder / file, **{"t_end": 1.0, **settings})
        assert not (folder / "no.fmu").exists()

    refused("must be 2 or 3, got 4", BLOCK, COULOMB, fmi=4)
    refused("ending .fmu", BLOCK, COULOMB, file="no.zip")
    refused("already exists", BLOCK, COULOMB, file="block.fmu")
    monkeypatch.setenv("PATH", str(folder / "nowhere"))
    refused("there is none .cc, gcc or clang.: install one", BLOCK, COULOMB)
    monkeypatch.setattr(platform, "system", lambda: "Darwin")
    refused("is made on Linux", BLOCK, COULOMB)
    with pytest.raises(InputError, match="export_fmu"):
        export(COULOMB, "fmu")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--to", "fmu", "--load", "3 N"], "--to fmu does not take --load"),
        (["--to", "c", "--input", "drive"], "--to c does not take --input"),
        (["--to", "fmu", "--input", "nothing"], "unknown drive 'nothing'"),
    ],
)
def test_options_that_do_not_belong_together_are_refused(rig, tmp_path, capsys, options, words):
    with pytest.raises(SystemExit) as ended:
        main(["export", str(rig), *options, "-o", str(tmp_path / "out")])
    assert ended.value.code == 2
    assert words in capsys.readouterr().err
    assert not list(tmp_path.glob("out/*"))


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    file = tmp_path / "rig.toml"
    file.write_text(
        '[mechanism]\ntype = "spring-block"\nmass = 1.0\nstiffness = 100.0\ncompression = 0.1\n'
        "[friction]\nkinetic_coefficient = 0.25\n[run]\nt_end = 2.0\n"
    )
    return file


# --- portable FMUs, for which the kernels are compiled anew


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(("name", "mechanism", "law"), TWELVE, ids=[name for name, _, _ in TWELVE])
def test_portable_fmus_of_twelve_rigs_are_the_engine(folder, fmi, name, mechanism, law):
    from fmpy.validation import validate_fmu

    label = f"{name.replace(', ', '-')}-{fmi}"
    path = made(folder, label, mechanism, law, fmi=fmi, portable=True)
    assert validate_fmu(str(path)) == []
    compare(path, folder, mechanism, law)
    if fmi == 3:
        run = simulate(mechanism, law, t_end=END, throw=False)
        if run.status.complete:
            assert run_alone(path, folder, run.states[0]) == run[run.states[0]][-1]


@pytest.mark.slow
def test_the_command_writes_an_fmu_of_a_rig_file(rig, folder, capsys):
    need_tools()
    target = folder / "by-command"
    with pytest.raises(SystemExit) as ended:
        main(["export", str(rig), "--to", "fmu", "--fmi", "2", "-o", str(target), "--json"])
    assert not ended.value.code
    assert '"target": "fmu"' in capsys.readouterr().out
    slave = Slave(target / "rig.fmu", folder).begin()
    slave.step(END)
    assert slave.got("x")[0] == simulate(BLOCK, COULOMB, t_end=END)["x"][-1]
    slave.close()


def can_rub(mechanism, law):
    """Whether every contact tells what a law asks of it, such as the torque through a gear."""
    told = [input_names(mechanism, contact.name) for contact in mechanism.contacts()]
    return all(set(law.inputs) <= set(names) for names in told)


@pytest.mark.slow
@examples(40)
@given(data=st.data())
def test_random_rigs_give_the_bits_of_the_engine(folder, data):
    mechanism = data.draw(RIGS[data.draw(st.sampled_from(sorted(RIGS)))])
    known = [name for name, kind in LAWS.items() if can_rub(mechanism, kind)]
    law = data.draw(laws(LAWS[data.draw(st.sampled_from(sorted(known)))]))
    run = simulate(mechanism, law, t_end=END, throw=False)
    path = made(folder, f"random-{next(NUMBERS)}", mechanism, law, force=True)
    slave = Slave(path, folder).begin(stopTime=END)
    names = column_names(slave)
    for t in np.linspace(0.0, END, data.draw(st.integers(2, 60)))[1:]:
        if t > run.span[1]:
            break
        slave.step(float(t))
        seen = run.at(np.array([t]))
        assert slave.got(*names) == [seen[name][0] for name in names]
    slave.close()
