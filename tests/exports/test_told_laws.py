"""Laws with contact inputs in other programs: one more argument each, or one value."""

import json
import math
import random
import re
import shutil
import subprocess

import numpy as np
import pytest
from benchmarks.several.brakes import DiscBrake, Lining
from tests.exports.compiled import library, number, numbers
from tests.exports.fmus import need_tools

from stickslip import Axis, export, simulate
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.exports import export_fmu
from stickslip.friction import bound, law
from stickslip.mechanisms import given_inputs
from stickslip.mechanisms.drives import Sine
from stickslip.study.control import compensation

GEAR = law("level + stribeck + weight[transmitted] + viscous * exponential[temperature]")(
    kinetic_coefficient=0.04,
    static_coefficient=0.07,
    stribeck_velocity=0.15,
    transmitted_coefficient=0.12,
    viscous_coefficient=0.06,
    viscous_temperature_decay=0.03,
)
MEMORY = law("dahl(both_ways[levels](level * linear[gravity] + stribeck)) + power")(
    forward_kinetic_coefficient=0.2,
    backward_kinetic_coefficient=0.25,
    level_gravity_slope=0.1,
    forward_static_coefficient=0.3,
    backward_static_coefficient=0.35,
    stribeck_velocity=0.1,
    bristle_stiffness=50.0,
    viscous_coefficient=0.3,
    viscous_exponent=1.0,
)
WARM = law("level + viscous * exponential[temperature]")(
    kinetic_coefficient=0.1, viscous_coefficient=0.12, viscous_temperature_decay=0.03
)
DRIVEN = Axis(inertia=1.0, drive=Sine(amplitude=2.0, frequency=1.0))
RELATIVE = 1e-12
"""Sums in another order differ by a few roundings of their largest part."""


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    files = {**export(GEAR, "c", name="gear").files, **export(MEMORY, "c", name="memory").files}
    return library(tmp_path_factory.mktemp("told"), files)


def test_compiled_functions_take_the_inputs_behind_the_load_and_agree_with_the_law(compiled):
    force, level, push = (
        number(compiled, f"gear_{name}") for name in ("friction", "break_away", "compensation")
    )
    dice = random.Random(3)
    for _ in range(200):
        v, n, t, temperature = dice.gauss(0, 0.3), dice.expovariate(1), dice.gauss(0, 1), 40.0
        told = {"transmitted": t, "temperature": temperature}
        here = bound(GEAR, told)
        assert math.isclose(force(v, n, t, temperature), here.force(v, n), rel_tol=RELATIVE)
        assert math.isclose(level(1, n, t, temperature), here.break_away(n), rel_tol=RELATIVE)
        wanted = compensation(GEAR, width=0.01, load=n, inputs=told)(0.0, {"v": v})
        assert math.isclose(push(v, n, t, temperature, 0.01, 1.0), wanted, rel_tol=RELATIVE)


def test_a_compiled_step_with_an_input_is_that_of_a_law_with_its_level(compiled, tmp_path):
    plain = law("level + stribeck + viscous")(
        kinetic_coefficient=0.04 + 0.12 * 0.5,
        static_coefficient=0.07 + 0.12 * 0.5,
        stribeck_velocity=0.15,
        viscous_coefficient=0.06 * math.exp(-0.03 * 20.0),
    )
    results = ("velocity_end", "displacement", "friction", "sticks")
    told = numbers(compiled, "gear_step", results)
    other = numbers(
        library(tmp_path, export(plain, "c", name="plain").files), "plain_step", results
    )
    for v in (-0.4, 0.0, 0.003, 0.3):
        found, wanted = told(0.3, v, 2.0, -0.5, 20.0, 1.5, 0.01), other(0.3, v, 2.0, 1.5, 0.01)
        assert found == pytest.approx(wanted, rel=1e-9, abs=1e-15)


def test_compiled_memory_with_an_input_agrees_with_the_law(compiled):
    force, rates = number(compiled, "memory_friction"), number(compiled, "memory_rates")
    dice = random.Random(4)
    for _ in range(100):
        v, z, gravity = dice.gauss(0, 0.3), dice.gauss(0, 2e-3), dice.gauss(0, 1)
        here = bound(MEMORY, {"gravity": gravity})
        assert math.isclose(force(v, z, 2.0, gravity), here.force(v, 2.0, (z,)), rel_tol=RELATIVE)
        (rate,) = here.rates(v, 2.0, (z,))
        assert math.isclose(rates(v, z, 2.0, gravity), rate, rel_tol=1e-10)


def test_matlab_passes_the_inputs_on_wherever_it_passes_the_load():
    files = export(GEAR, "matlab", name="gear").files
    text = "\n".join(line.split("%")[0] for t in files.values() for line in t.splitlines())
    calls = re.findall(
        r"(?<!function )\b(?:gear_)?(?:friction|break_away|slip|slide)\(([^()]*)", text
    )
    with_load = [call for call in calls if re.search(r"\bload\b", call)]
    assert with_load
    for call in with_load:
        assert re.search(r"load( \+ each)?, transmitted( \+ each)?, temperature", call), call


def test_json_names_the_inputs_of_a_law():
    (text,) = export(GEAR, "json").files.values()
    assert json.loads(text)["inputs"] == ["transmitted", "temperature"]


@pytest.mark.parametrize("target", ["mjcf", "urdf", "csv"])
def test_what_has_one_friction_asks_for_one_value_of_each_input(target):
    with pytest.raises(InputError, match=r"depends on transmitted: give it, as --at transmitted"):
        export(GEAR, target, largest_speed=1.0, load=2.0)
    at = {"transmitted": 0.5, "temperature": "293.15 K"}
    found = export(GEAR, target, largest_speed=1.0, load=2.0, at=at)
    (text,) = found.files.values()
    assert "transmitted 0.5 N and temperature 20 °C" in " ".join(text.split())


def test_a_table_at_stated_inputs_has_the_friction_there():
    (text,) = export(
        WARM, "csv", largest_speed=1.0, load=1.0, at={"temperature": 20.0}
    ).files.values()
    rows = [line.split(",") for line in text.splitlines() if line[0] in "-0123456789"]
    v, force = np.array(rows, dtype=float).T
    np.testing.assert_allclose(force, bound(WARM, {"temperature": 20.0}).force(v, 1.0), rtol=1e-12)


def test_values_of_inputs_that_do_not_fit_are_refused():
    with pytest.raises(UnknownNameError, match="contact input of"):
        export(WARM, "csv", largest_speed=1.0, load=1.0, at={"temp": 1.0})
    with pytest.raises(ParameterError, match="degC"):
        export(WARM, "csv", largest_speed=1.0, load=1.0, at={"temperature": "3 mm"})
    with pytest.raises(InputError, match="argument for each contact input"):
        export(WARM, "c", at={"temperature": 1.0})


def test_octave_reads_the_functions_with_inputs(tmp_path):
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        pytest.skip("GNU Octave is not installed (Debian: apt-get install octave)")
    export(GEAR, "matlab", name="gear").save(tmp_path)
    (tmp_path / "run_all.m").write_text('printf("%.17g\\n", gear_friction(0.1, 2.0, -0.5, 30));\n')
    done = subprocess.run(
        [octave, "--quiet", "--no-history", "--no-init-file", "run_all.m"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    here = bound(GEAR, {"transmitted": -0.5, "temperature": 30.0})
    assert float(done.stdout.split()[0]) == pytest.approx(here.force(0.1, 2.0), rel=1e-12)


@pytest.mark.parametrize("given", [False, True])
def test_an_input_that_nothing_tells_is_one_of_the_fmu(given, tmp_path):
    need_tools()
    from fmpy import read_model_description, simulate_fmu
    from fmpy.validation import validate_fmu

    warm = given_inputs(DRIVEN, {"temperature": 30.0})
    file = export_fmu(warm if given else DRIVEN, WARM, tmp_path / "axis.fmu", t_end=1.0)
    assert not validate_fmu(str(file))
    told = [v for v in read_model_description(str(file)).modelVariables if v.causality == "input"]
    assert [(sentence.name, sentence.unit) for sentence in told] == (
        [] if given else [("temperature", "degC")]
    )
    signal = np.array([(0.0, 30.0), (1.0, 30.0)], dtype=[("time", float), ("temperature", float)])
    run = simulate_fmu(
        str(file), stop_time=1.0, output_interval=0.25, input=None if given else signal
    )
    wanted = simulate(warm, WARM, t_end=1.0)
    assert run["x"][-1] == pytest.approx(wanted["x"][-1], rel=1e-9)


def test_an_input_that_was_given_may_become_one_of_the_fmu(tmp_path):
    need_tools()
    from fmpy import read_model_description

    warm = given_inputs(DRIVEN, {"temperature": 30.0})
    file = export_fmu(warm, WARM, tmp_path / "axis.fmu", t_end=1.0, inputs=["temperature"])
    (told,) = [
        v for v in read_model_description(str(file)).modelVariables if v.causality == "input"
    ]
    assert (told.name, float(told.start)) == ("temperature", 30.0)
    gear = law("level + weight[transmitted]")(kinetic_coefficient=0.1, transmitted_coefficient=0.1)
    with pytest.raises(InputError, match="follows from the motion"):
        export_fmu(DRIVEN, gear, tmp_path / "b.fmu", t_end=1.0, inputs=["transmitted"])


def test_contact_inputs_of_several_contacts_are_inputs_of_the_fmu_by_contact(tmp_path):
    need_tools()
    from fmpy import read_model_description, simulate_fmu

    pads = (Lining(radius=0.1, load=60.0), Lining(radius=0.12, load=40.0))
    brake = DiscBrake(inertia=0.5, pads=pads)
    fading = law("level * exponential[temperature]")
    hot = fading(kinetic_coefficient=0.4, level_temperature_decay=0.001)
    apart = given_inputs(brake, {"temperature": 20.0, "pad-2": {"temperature": 90.0}})
    start = {"omega": 2.0}
    path = export_fmu(
        apart, {"pad-1": hot, "pad-2": hot}, tmp_path / "one.fmu", t_end=0.2, y0=start,
        inputs=["pad-2.temperature"],
    )  # fmt: skip
    both = export_fmu(brake, hot, tmp_path / "both.fmu", t_end=0.2, y0=start)
    for file, name in ((path, "pad-2.temperature"), (both, "temperature")):
        variables = read_model_description(str(file)).modelVariables
        (told,) = [v for v in variables if v.causality == "input"]
        assert (told.name, told.unit) == (name, "degC")
        signal = np.array([(0.0, 300.0), (1.0, 300.0)], dtype=[("time", float), (name, float)])
        run = simulate_fmu(str(file), stop_time=0.2, output_interval=0.05, input=signal)
        warm = (
            given_inputs(apart, {"pad-2": {"temperature": 300.0}})
            if file == path
            else given_inputs(brake, {"temperature": 300.0})
        )
        wanted = simulate(warm, hot, t_end=0.2, y0=start)
        assert run["phi"][-1] == pytest.approx(wanted["phi"][-1], rel=1e-9)
    rough = law("level + weight[motor]")(kinetic_coefficient=0.4, motor_coefficient=0.1)
    with pytest.raises(InputError, match=r"'pad-1.motor' follows from the motion"):
        export_fmu(brake, rough, tmp_path / "c.fmu", t_end=0.2, inputs=["pad-1.motor"])
