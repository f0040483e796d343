"""Memories with switches in programs: steps that keep flags, FMUs, what is refused by name."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.exports.compiled import library, numbers
from tests.exports.fmus import made, need_tools
from tests.exports.test_fmu import compare
from tests.friction.test_memories import GMS, MAXWELL, PUSH, RESET, axis
from tests.friction.test_tissue import OWN

from stickslip import export, simulate

LAWS = {"gms": GMS, "maxwell": MAXWELL, "reset": RESET, "relaxing": OWN}


@pytest.mark.parametrize("name", LAWS)
def test_compiled_steps_come_near_the_run_at_short_periods_and_at_long_ones(name, tmp_path):
    own = LAWS[name]
    compiled = library(tmp_path, export(own, "c", name=name).files)
    flags = [f"slips{i + 1}" for i in range(4)] if name == "gms" else []
    states = ["velocity", *own.states, *flags]
    step = numbers(
        compiled,
        f"{name}_step",
        [*(f"{state}_end" for state in states), "moved", "friction", "sticks"],
    )
    expected = simulate(axis(PUSH), own, t_end=1.0)["x"][-1]
    for period, within in ((2e-3, 5e-4), (2e-4, 1e-4)):  # of 0.24 m; presliding is over in 0.15 mm
        x, now = 0.0, [0.0] * len(states)
        for i in range(round(1.0 / period)):
            found = step(PUSH.smooth((i + 0.5) * period), *now, 1.0, 1.0, period)
            now = [found[f"{state}_end"] for state in states]
            x += found["moved"]
        assert x == pytest.approx(expected, abs=within)
        assert {found[f"{flag}_end"] for flag in flags} <= {0.0, 1.0}


def test_programs_say_what_a_step_errs_by_where_friction_falls_at_once():
    said = "may then err by that fall times"
    assert said in " ".join(export(RESET, "c", name="reset").files["reset.h"].split())
    assert said not in " ".join(export(MAXWELL, "c", name="maxwell").files["maxwell.h"].split())


def test_elements_far_stiffer_than_the_period_resolves_cost_no_accuracy(tmp_path):
    own = replace(GMS, bristle_stiffness=1e6)  # 1.5 um of deflection, crossed in 1 ms at 1.5 mm/s
    compiled = library(tmp_path, export(own, "c", name="gms").files)
    states = ["velocity", *own.states, *(f"slips{i + 1}" for i in range(4))]
    step = numbers(
        compiled, "gms_step", [*(f"{state}_end" for state in states), "moved", "friction", "sticks"]
    )
    expected = simulate(axis(PUSH), own, t_end=1.0).at(np.arange(1, 1001) * 1e-3)["x"]
    x, now, found = 0.0, [0.0] * len(states), []
    for i in range(1000):
        moved = step(PUSH.smooth((i + 0.5) * 1e-3), *now, 1.0, 1.0, 1e-3)
        now = [moved[f"{state}_end"] for state in states]
        found.append(x := x + moved["moved"])
    # of 0.36 m; states that are led on in a straight line pass their limits and are 4 mm off
    np.testing.assert_allclose(found, expected, atol=1e-4)


def test_latches_step_in_c():
    assert "maxwell_step" in export(MAXWELL, "c", name="maxwell").files["maxwell.h"]


@pytest.mark.parametrize("name", ["gms", "relaxing"])
def test_an_fmu_has_the_bits_of_the_engine(name: str, tmp_path: Path):
    need_tools()
    own = LAWS[name]
    compare(made(tmp_path, name, axis(PUSH), own), tmp_path, axis(PUSH), own)
