"""Which tier ``auto`` takes: plain Python until machine code would have paid for itself."""

from types import SimpleNamespace

import pytest

from stickslip import Coulomb, EventDriven, SpringBlock, simulate
from stickslip.formulation import formulate
from stickslip.solver import run
from stickslip.solver.compile import background
from stickslip.solver.compile.equations_code import EquationsCode
from stickslip.solver.compile.kernels_code import KernelsCode

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)


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
    monkeypatch.setattr(run, "compile_in_background", lambda: False)
    monkeypatch.setattr(KernelsCode, "is_ready", lambda kernels: False)
    monkeypatch.setattr(EquationsCode, "is_ready", lambda code: False)
    monkeypatch.setattr(EquationsCode, "is_kept", lambda code: False)
    yield asked
    run.work_of.cache_clear()


def steps(monkeypatch, seconds):
    """Let the steps of one run stand for a time [s]."""
    taken = simulate(RIG, LAW, t_end=1.0, solver=EventDriven(tier="python")).certificate
    monkeypatch.setattr(run, "PLAIN_STEP", seconds / (taken.steps + taken.rejected))
    monkeypatch.setattr(run.Work, "all_seconds", 0.0)
    run.work_of.cache_clear()


@pytest.mark.parametrize(("kept", "wait"), [(True, run.LOADING), (False, 3.0)])
def test_auto_compiles_once_plain_runs_have_taken_as_long(monkeypatch, tiers, kept, wait):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: kept)
    monkeypatch.setattr(KernelsCode, "seconds", 3.0)
    steps(monkeypatch, 0.4 * wait)
    tiers.clear()
    for _ in range(4):
        simulate(RIG, LAW, t_end=1.0)
    assert tiers == [False, False, False, True]


def test_runs_in_plain_python_stay_there_and_count(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    steps(monkeypatch, 2.0 * run.LOADING)
    tiers.clear()
    for _ in range(2):
        simulate(RIG, LAW, t_end=1.0, solver=EventDriven(tier="python"))
    assert tiers == [False, False]
    assert run.work_of(formulate(RIG, LAW)).is_enough()


def test_other_equations_are_counted_by_themselves(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    steps(monkeypatch, 2.0 * run.LOADING)
    simulate(RIG, LAW, t_end=1.0)
    tiers.clear()
    simulate(SpringBlock(mass=2.0), Coulomb(kinetic_coefficient=0.1), t_end=1.0)
    simulate(SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True), LAW, t_end=1.0)
    assert tiers == [True, False]


def test_where_kernels_are_loaded_plain_runs_pay_for_the_equations_alone(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_ready", lambda kernels: True)
    steps(monkeypatch, 0.4 * run.EQUATIONS)
    tiers.clear()
    for _ in range(4):
        simulate(RIG, LAW, t_end=1.0)
    assert tiers == [False, False, False, True]


def test_equations_in_a_file_are_taken_at_once_where_kernels_are_loaded(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_ready", lambda kernels: True)
    monkeypatch.setattr(EquationsCode, "is_kept", lambda code: True)
    simulate(RIG, LAW, t_end=1.0)
    assert tiers == [True]


def test_plain_runs_of_all_models_pay_for_the_kernels_that_they_share(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    monkeypatch.setattr(EquationsCode, "is_kept", lambda code: True)
    steps(monkeypatch, 0.6 * run.LOADING)
    tiers.clear()
    held = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True)
    for rig in (RIG, held, RIG, held):
        simulate(rig, LAW, t_end=1.0)
    assert tiers == [False, False, True, True]


def test_a_long_run_goes_on_in_machine_code_once_it_has_taken_as_long(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: True)
    monkeypatch.setattr(run, "STRETCH", 4)
    steps(monkeypatch, 2.0 * run.LOADING)
    plain = simulate(RIG, LAW, t_end=1.0, solver=EventDriven(tier="python"))
    monkeypatch.setattr(run.Work, "all_seconds", 0.0)
    run.work_of.cache_clear()
    tiers.clear()
    begun = simulate(RIG, LAW, t_end=1.0)
    assert tiers == [False, True]
    assert begun.events == plain.events
    assert begun.certificate == plain.certificate


def test_what_nobody_has_compiled_is_compiled_in_the_background(monkeypatch, tiers):
    monkeypatch.setattr(KernelsCode, "is_kept", lambda kernels: False)
    begun = []
    monkeypatch.setattr(run, "compile_in_background", lambda: not begun.append("once"))
    steps(monkeypatch, 1e3)
    tiers.clear()
    for _ in range(3):
        simulate(RIG, LAW, t_end=1.0)
    assert tiers == [False, False, False]
    assert begun


def test_the_background_process_is_begun_once_and_compiles_what_it_is_told(monkeypatch, tmp_path):
    calls, loaded = [], []
    process = SimpleNamespace(returncode=None, poll=lambda: process.returncode)
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path))
    monkeypatch.setattr(background, "_begun", [])
    monkeypatch.setattr(
        background.subprocess, "Popen", lambda args, **settings: calls.append(args) or process
    )
    assert not background.compile_in_background()  # tests forbid it
    monkeypatch.setenv(background.SWITCH, "1")
    assert background.compile_in_background()
    assert background.compile_in_background()
    ((_, _, code),) = calls
    monkeypatch.setattr(background.os, "nice", lambda increment: increment)
    monkeypatch.setattr(KernelsCode, "load", lambda kernels: not loaded.append(kernels))
    exec(code)
    assert loaded == [background.KERNELS]
    process.returncode = 1  # killed, or out of memory: somebody else has to compile
    assert not background.compile_in_background()
