"""MATLAB: run by GNU Octave, and compared with the law and with the compiled C."""

import math
import random
import shutil
import subprocess

import numpy as np
import pytest
from tests.exports.compiled import library, numbers
from tests.exports.laws import LAWS_EXPORTED, bristle_states

from stickslip import Coulomb, export
from stickslip.exports.program import equations_of
from stickslip.study.control import compensation

LOAD, MASS, PERIOD = 7.0, 2.0, 0.01
VELOCITIES = (0.0, 1e-7, 3e-3, 0.04, 2.0, -1e-7, -3e-3, -0.04, -2.0)
NAMES = ("direction_dependent", "dahl_bent", "hostile", "two_bristles", "lugre_held")
"""Laws of every kind: what the languages share is tested in C for all laws."""


def arguments(name):
    """Yield velocities with bristle states that carry a part of the level."""
    dice = random.Random(2)
    for v in VELOCITIES:
        yield v, bristle_states(LAWS_EXPORTED[name], dice.uniform(-0.8, 0.8))


def calls(name):
    """Return what Octave prints of a law, a call a line."""
    states = equations_of(LAWS_EXPORTED[name]).bristles
    results = ", ".join(f"r{i}" for i in range(4 + len(states)))
    for v, z in arguments(name):
        given = ", ".join(map(repr, (v, *z)))
        yield f"printf('%.17g\\n', {name}_friction({given}, {LOAD}));"
        yield f"printf('%.17g\\n', {name}_compensation({v!r}, {LOAD}, 0.01, 0.9));"
        yield f"[{results}] = {name}_step(3.0, {given}, {LOAD}, {MASS}, {PERIOD});"
        yield f"printf('%.17g\\n', {results});"
    yield f"printf('%.17g\\n', {name}_break_away(1, {LOAD}), {name}_break_away(-1, {LOAD}));"
    nan = ", ".join(["NaN", *("0" for _ in states)])
    yield f"printf('%.17g\\n', {name}_friction({nan}, 1), {name}_step(0, 0, {nan[5:]}{',' if states else ''} 1, -1, 1));"  # noqa: E501  # one call


BLOCK = """
for n = 1:3
    [v, x, f, s] = coulomb_block(20.0, 7.0, 2.0, 0.01);
    printf('%.17g\\n', v);
end
"""


ARRAYS = """
disp('---');
v = [-0.2 0 0.04; 3 -1 1e-7];
f = direction_dependent_friction(v, 7.0);
[e, d, m, s] = direction_dependent_step(3.0, v, 7.0, 2.0, 0.01);
printf('%d\\n', size(f), size(s), size(direction_dependent_friction([], 1)));
for n = 1:numel(v)
    [e1, d1, m1, s1] = direction_dependent_step(3.0, v(n), 7.0, 2.0, 0.01);
    f1 = direction_dependent_friction(v(n), 7.0);
    printf('%.17g\\n', f(n) - f1, e(n) - e1, d(n) - d1, s(n) - s1);
end
column_by_row = direction_dependent_friction(v(:, 1), [1 7]);
printf('%.17g\\n', size(column_by_row), column_by_row(2, 2) - direction_dependent_friction(3, 7));
"""
"""Functions of arrays, each element of which is to be that of a call of its own."""


@pytest.fixture(scope="module")
def printed(tmp_path_factory):
    """What Octave prints, as numbers by law."""
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        pytest.skip("GNU Octave is not installed (Debian: apt-get install octave)")
    folder = tmp_path_factory.mktemp("m")
    script = []
    for name in NAMES:
        for file, text in export(LAWS_EXPORTED[name], "matlab", name=name).files.items():
            (folder / file).write_text(text, encoding="utf-8")
        script += [*calls(name), "disp('---');"]
    block = export(Coulomb(kinetic_coefficient=0.25), "matlab").files["coulomb_block.m"]
    (folder / "coulomb_block.m").write_text(block, encoding="utf-8")
    (folder / "run_all.m").write_text("\n".join([*script, BLOCK, ARRAYS]), encoding="utf-8")
    done = subprocess.run(
        [octave, "--quiet", "--no-history", "--no-init-file", "run_all.m"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    parts = [list(map(float, part.split())) for part in done.stdout.split("---")]
    return dict(zip((*NAMES, "block", "arrays"), parts, strict=True))


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    files = {}
    for name in NAMES:
        files |= export(LAWS_EXPORTED[name], "c", name=name).files
    return library(tmp_path_factory.mktemp("c"), files)


@pytest.mark.parametrize("name", NAMES)
def test_octave_gives_what_the_law_and_the_compiled_step_give(printed, compiled, name):
    law, found = LAWS_EXPORTED[name], iter(printed[name])
    ends = [f"{bristle}_end" for bristle in equations_of(law).bristles]
    results = ["velocity_end", *ends, "displacement", "friction", "sticks"]
    step = numbers(compiled, f"{name}_step", results)
    push = compensation(law, width=0.01, factor=0.9, load=LOAD)
    for v, z in arguments(name):
        bristles = law.states
        true = law.force(v, LOAD, z) if bristles else law.force(v, LOAD)
        assert math.isclose(next(found), true, rel_tol=1e-12, abs_tol=1e-12)
        assert math.isclose(next(found), push(0.0, {"v": v}), rel_tol=1e-12, abs_tol=1e-12)
        moved = list(step(3.0, v, *z, LOAD, MASS, PERIOD).values())
        # roots in brackets end at slightly different roundings of exp and power
        np.testing.assert_allclose([next(found) for _ in moved], moved, rtol=1e-9, atol=1e-10)
    for side in (1, -1):
        assert math.isclose(next(found), law.towards(side).break_away(LOAD), rel_tol=1e-12)
    assert math.isnan(next(found))
    assert math.isnan(next(found))
    assert list(found) == []


def test_the_block_for_simulink_keeps_its_velocity_between_calls(printed):
    gained = (20.0 - 0.25 * 7.0) / 2.0 * 0.01
    np.testing.assert_allclose(printed["block"], gained * np.array([1, 2, 3]), rtol=1e-13)


def test_functions_of_arrays_give_arrays(printed):
    shapes, apart = printed["arrays"][:6], printed["arrays"][6:]
    assert shapes == [2, 3, 2, 3, 0, 0]
    assert apart[:-3] == [0.0] * 24
    assert apart[-3:] == [2, 2, 0.0]


def test_the_text_of_the_block_needs_no_other_file():
    text = export(Coulomb(kinetic_coefficient=0.25), "matlab").files["coulomb_block.m"]
    defined = {line.split("=")[-1].split("(")[0].split()[-1] for line in text.splitlines()
               if line.startswith("function")}  # fmt: skip
    assert defined == {
        "coulomb_block", "coulomb_friction", "coulomb_break_away", "coulomb_slip", "coulomb_slide",
        "coulomb_departure", "coulomb_step", "coulomb_compensation",
    }  # fmt: skip
