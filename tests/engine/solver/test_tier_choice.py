"""Which tier ``auto`` takes: machine code that files hold, or else that has paid for itself."""

import io
import itertools
import math
import pickle
from dataclasses import replace
from types import SimpleNamespace

import pytest

from stickslip import Coulomb, EventDriven, SpringBlock, simulate
from stickslip.engine.formulation import formulate
from stickslip.engine.solver import certify, run
from stickslip.engine.solver.compile import modules
from stickslip.engine.solver.compile.programs import EquationsCode, KernelsCode, code_of

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)


WAIT_FOR_EQUATIONS = run.PATIENCE * run.EQUATIONS
"""What plain runs have to take before equations are compiled [s]."""
WAIT = run.PATIENCE * run.LOADING + WAIT_FOR_EQUATIONS
"""The same where kernels are loaded too."""


@pytest.fixture
def tiers(monkeypatch):
    """Collect which tier each run asks for, and run all of them in plain Python."""
    asked, runner_of = [], run.runner_of

    def noted(model, *, compiled):
        asked.append(compiled)
        return runner_of(model, compiled=False)

    run.work_of.cache_clear()
    monkeypatch.setattr(run.Work, "all_seconds", 0.0)
    monkeypatch.setattr(run, "runner_of", noted)
    monkeypatch.setattr(run, "compile_in_background", lambda code: False)
    monkeypatch.setattr(KernelsCode, "is_ready", lambda kernels: False)
    monkeypatch.setattr(EquationsCode, "is_ready", lambda code: False)
    monkeypatch.setattr(EquationsCode, "is_kept", lambda code: False)
    yield asked
    run.work_of.cache_clear()


def lasting(monkeypatch, seconds):
    """Let each stretch of a run take a time [s]."""
    clock = itertools.count()  # read before and after
    monkeypatch.setattr(run, "thread_time", lambda: seconds * next(clock))


def test_what_files_hold_is_taken_by_the_first_run(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    monkeypatch.setattr(EquationsCode, "is_kept", lambda code: True)
    simulate(RIG, LAW, t_end=1.0)
    assert tiers == [True]


def test_files_are_looked_at_again_after_some_time_in_plain_python(monkeypatch, tiers):
    looks = []
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: bool(looks.append(1)))
    lasting(monkeypatch, 0.3 * run.LOOKS)
    for _ in range(9):
        simulate(RIG, LAW, t_end=1.0)
    assert len(looks) == 3
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    monkeypatch.setattr(EquationsCode, "is_kept", lambda code: True)
    for _ in range(4):
        simulate(RIG, LAW, t_end=1.0)
    assert tiers == [False] * 12 + [True]


@pytest.mark.parametrize(("kept", "wait"), [(True, WAIT), (False, 3.0 * run.PATIENCE)])
def test_auto_compiles_once_plain_runs_have_taken_twice_as_long(monkeypatch, tiers, kept, wait):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: kept)
    monkeypatch.setattr(EquationsCode, "is_kept", lambda code: not kept)
    monkeypatch.setattr(KernelsCode, "seconds", 3.0)
    lasting(monkeypatch, 0.4 * wait)
    for _ in range(4):
        simulate(RIG, LAW, t_end=1.0)
    assert tiers == [False, False, False, True]


def test_runs_in_plain_python_stay_there_and_count(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    lasting(monkeypatch, 1.1 * WAIT)
    for _ in range(2):
        simulate(RIG, LAW, t_end=1.0, solver=EventDriven(tier="python"))
    assert tiers == [False, False]
    assert run.work_of(formulate(RIG, LAW)).is_enough()


def test_other_equations_are_counted_by_themselves(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    lasting(monkeypatch, 1.1 * WAIT)
    simulate(RIG, LAW, t_end=1.0)
    tiers.clear()
    simulate(SpringBlock(mass=2.0), Coulomb(kinetic_coefficient=0.1), t_end=1.0)
    simulate(SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True), LAW, t_end=1.0)
    assert tiers == [True, False]


def test_where_kernels_are_loaded_plain_runs_pay_for_the_equations_alone(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_ready", lambda kernels: True)
    lasting(monkeypatch, 0.4 * WAIT_FOR_EQUATIONS)
    for _ in range(4):
        simulate(RIG, LAW, t_end=1.0)
    assert tiers == [False, False, False, True]


def test_equations_in_a_file_are_taken_at_once_where_kernels_are_loaded(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_ready", lambda kernels: True)
    monkeypatch.setattr(EquationsCode, "is_kept", lambda code: True)
    simulate(RIG, LAW, t_end=1.0)
    assert tiers == [True]


def test_plain_runs_of_all_models_pay_for_the_kernels_that_they_share(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: False)
    monkeypatch.setattr(EquationsCode, "is_kept", lambda code: True)
    lasting(monkeypatch, 0.6 * run.PATIENCE * run.KERNELS.seconds)
    held = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True)
    for rig in (RIG, held, RIG, held):
        simulate(rig, LAW, t_end=1.0)
    assert tiers == [False, False, True, True]


def test_a_long_run_goes_on_in_machine_code_once_it_has_taken_twice_as_long(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    monkeypatch.setattr(run, "STRETCH", 4)
    lasting(monkeypatch, 1.1 * WAIT)
    begun = simulate(RIG, LAW, t_end=1.0)
    assert tiers == [False, True]
    plain = simulate(RIG, LAW, t_end=1.0, solver=EventDriven(tier="python"))
    assert begun.events == plain.events
    assert begun.certificate == plain.certificate


@pytest.mark.parametrize("stretch", [0.01, 0.03, 0.11, 0.5])
@pytest.mark.parametrize(
    ("kernels_kept", "equations_kept"), [(True, False), (False, True), (False, False)]
)
def test_no_run_takes_more_than_one_and_a_half_times_as_long_as_in_plain_python(
    monkeypatch, tiers, stretch, kernels_kept, equations_kept
):
    # Whatever number of stretches a run has. Machine code takes no time at all here but for
    # getting it, so that a run pays most if it ends as soon as it has paid.
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: kernels_kept)
    monkeypatch.setattr(EquationsCode, "is_kept", lambda code: equations_kept)
    monkeypatch.setattr(KernelsCode, "seconds", 0.6)
    getting = run.LOADING if kernels_kept else KernelsCode().seconds
    getting += 0.0 if equations_kept else run.EQUATIONS
    work = run.work_of(formulate(RIG, LAW))
    for stretches in range(1, math.ceil(3.0 * getting / stretch) + 1):
        plain = stretches * stretch
        for before in range(4):  # runs of this length, the first of a process and later ones
            monkeypatch.setattr(run.Work, "all_seconds", before * plain)
            work.seconds, auto = before * plain, 0.0
            if work.is_enough():
                auto, together = getting, before * plain + getting
                assert together <= 1.5 * before * plain + 1e-9
                if plain < getting / 1.5:  # getting it takes longer than the run by itself
                    continue
            else:
                while auto < plain - 1e-9:
                    work.add(stretch)
                    auto += stretch
                    if auto < plain - 1e-9 and work.is_enough(auto):
                        auto += getting
                        break
            assert auto <= 1.5 * plain + 1e-9


def test_what_nobody_has_compiled_is_compiled_in_the_background(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: False)
    begun = []
    monkeypatch.setattr(run, "compile_in_background", lambda code: not begun.append(code))
    lasting(monkeypatch, 1e3)
    for _ in range(3):
        simulate(RIG, LAW, t_end=1.0)
    assert tiers == [False, False, False]
    assert set(begun) == {code_of(formulate(RIG, LAW))}


def test_the_background_process_is_begun_once_and_compiles_what_it_is_told(monkeypatch, tmp_path):
    calls, loaded = [], []
    equations = code_of(formulate(RIG, LAW))
    process = SimpleNamespace(returncode=None, poll=lambda: process.returncode)

    def popen(args, *, stdin, **settings):
        calls.append((args, stdin.read()))
        return process

    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path))
    monkeypatch.setattr(modules, "_begun", [])
    monkeypatch.setattr(modules.subprocess, "Popen", popen)
    assert not modules.compile_in_background(equations)  # tests forbid it
    monkeypatch.setenv(modules.SWITCH, "1")
    assert modules.compile_in_background(equations)
    assert modules.compile_in_background(equations)
    (((_, _, code), told),) = calls
    monkeypatch.setattr(modules.os, "nice", lambda increment: increment)
    monkeypatch.setattr(modules.sys, "stdin", io.StringIO(told.decode()))
    for kind in (KernelsCode, EquationsCode):
        monkeypatch.setattr(kind, "load", lambda code: not loaded.append(code))
    exec(code)
    assert loaded == [equations, modules.KERNELS]
    assert loaded[0].name == equations.name
    process.returncode = 1  # killed, or out of memory: somebody else has to compile
    assert not modules.compile_in_background(equations)


@pytest.mark.parametrize("tier", ["auto", "python"])
def test_sensitivities_take_machine_code_once_the_run_has_paid_for_it(monkeypatch, tiers, tier):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    monkeypatch.setattr(certify, "runner_of", run.runner_of)
    lasting(monkeypatch, 1.1 * WAIT)
    moved = simulate(RIG, LAW, t_end=1.0, solver=EventDriven(tier=tier)).at(1.0)
    copied = pickle.loads(pickle.dumps(moved))
    tiers.clear()
    for one in (moved, copied):
        one.sensitivity("x", "kinetic_coefficient")
    assert tiers == [tier == "auto"] * 2


def test_sensitivities_in_plain_python_count(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    monkeypatch.setattr(certify, "runner_of", run.runner_of)
    lasting(monkeypatch, 0.0)
    moved = simulate(RIG, LAW, t_end=1.0).at(1.0)
    tiers.clear()
    clock = itertools.count()
    monkeypatch.setattr(certify, "thread_time", lambda: 0.6 * WAIT * next(clock))
    for _ in range(3):
        moved.sensitivity("x", "kinetic_coefficient")
    assert tiers == [False, False, True]


def test_sensitivities_of_a_plain_run_have_the_same_bits_in_machine_code():
    solver = EventDriven(tier="auto")
    moved = simulate(RIG, LAW, t_end=1.0, solver=solver).at([0.1, 1.0])
    sensing = moved.differentiate
    found = []
    for spent in (None, math.inf):  # as the run, and machine code
        record = replace(sensing.record, spent=spent)
        found.append(replace(sensing, record=record)(moved.t, ["friction.kinetic_coefficient"]))
    assert found[0].tolist() == found[1].tolist()
