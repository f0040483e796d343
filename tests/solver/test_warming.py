"""Compiling ahead of time, in processes of their own."""

import os
import signal
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import pytest

from stickslip import Coulomb, CoulombViscous, EventDriven, SpringBlock, simulate
from stickslip.drives import Pulse
from stickslip.errors import CompilationError, InputError
from stickslip.formulation import formulate
from stickslip.solver import prepare, warm_up
from stickslip.solver.compile import compile_pool, compile_units, messages, module_cache, precompile
from stickslip.solver.compile.modules import load_compiled

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)
OTHER = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.4)
PAIRS = [(RIG, LAW), (RIG, OTHER), (SpringBlock(mass=2.0), LAW)]
"""Two laws, and a pair that differs from the first in numbers only."""
WARM = """
from stickslip import Coulomb, SpringBlock
from stickslip.solver import warm_up
rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
done = warm_up([(rig, Coulomb(kinetic_coefficient=0.25))], ensembles=False, jobs=1)
print(done.kernels_compiled, done.kernels_found)
"""


@pytest.fixture(scope="module")
def warmed(tmp_path_factory):
    """Compile the kernels and the pairs once, from two processes at a time, one of them killed."""
    folder = tmp_path_factory.mktemp("warm")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STICKSLIP_CACHE", str(folder))
        runs = [start(folder) for _ in range(2)]
        doomed = start(folder)
        while not list(folder.glob("*.py")):
            threading.Event().wait(0.05)
        os.killpg(doomed.pid, signal.SIGKILL)  # with the process that compiles for it
        doomed.communicate()
        outputs = [run.communicate(timeout=600) for run in runs]
        assert [run.returncode for run in runs] == [0, 0], outputs
        told = []
        done = warm_up(PAIRS, ensembles=False, progress=lambda *news: told.append(news))
        return folder, sorted(out.split() for out, _ in outputs), done, told


@pytest.fixture
def cache(warmed, monkeypatch):
    monkeypatch.setenv("STICKSLIP_CACHE", str(warmed[0]))
    return warmed[0]


@pytest.fixture
def empty(tmp_path, monkeypatch):
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def fresh(monkeypatch):
    """Forget what this process has in memory."""
    forgotten = {n: m for n, m in sys.modules.items() if n.startswith("stickslip_")}
    for name in forgotten:
        del sys.modules[name]
    monkeypatch.setattr(compile_units, "_ready", set())
    load_compiled.cache_clear()
    yield
    load_compiled.cache_clear()
    sys.modules.update(forgotten)


def start(folder):
    return subprocess.Popen(
        [sys.executable, "-c", WARM],
        env={**os.environ, "STICKSLIP_CACHE": str(folder)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def never(*_arguments, **_settings):
    raise AssertionError("a process was started")


def test_two_processes_at_once_compile_the_kernels_once(warmed):
    _, counts, *_ = warmed
    assert [int(compiled) + int(found) for compiled, found in counts] == [1, 1]
    assert sum(int(compiled) for compiled, _ in counts) <= 1  # none if the killed one was through


def test_laws_share_the_kernels(warmed):
    folder, _, done, _ = warmed
    assert (done.kernels_compiled, done.kernels_found) == (0, 1)
    assert (done.equations_compiled, done.equations_found) == (1, 1)
    assert done.folder == folder
    assert len(list((folder / "__pycache__").glob("*.enter_run-*.nbc"))) == 1
    assert len(list((folder / "__pycache__").glob("*.equations-*.nbc"))) == 2


def test_progress_tells_when_something_begins_and_when_it_is_done(warmed):
    *_, told = warmed
    assert told == [(0, 1, "SpringBlock with CoulombViscous"), (1, 1, told[0][2])]


def test_what_is_there_starts_no_process(cache, monkeypatch):
    monkeypatch.setattr(compile_pool.subprocess, "Popen", never)
    done = warm_up(PAIRS, ensembles=False)
    assert (done.kernels_compiled, done.equations_compiled) == (0, 0)
    assert (done.kernels_found, done.equations_found) == (1, 2)


def test_what_is_there_needs_no_folder_that_can_be_written(cache, monkeypatch):
    monkeypatch.setattr(precompile, "is_writable", lambda: False)
    assert warm_up(PAIRS, ensembles=False).kernels_found == 1


def test_afterwards_the_equations_are_loaded_and_nothing_is_said(cache, fresh, capsys, monkeypatch):
    monkeypatch.setattr(messages, "_watched", lambda: True)
    monkeypatch.setattr(messages.LOG, "hasHandlers", lambda: False)
    prepare(RIG, OTHER)
    kernels = load_compiled(formulate(RIG, OTHER)).kernels
    assert not kernels.enter_run.stats.cache_misses
    assert capsys.readouterr().err == ""


def test_runs_call_the_kernels_as_they_were_compiled(cache, fresh):
    run = simulate(RIG, LAW, t_end=1.0, solver=EventDriven(tier="compiled"))
    run.at([0.5])
    kernels = load_compiled(formulate(RIG, LAW)).kernels
    assert len(kernels.enter_run.signatures) == 1
    assert len(kernels.enter_play.signatures) == 1
    assert not kernels.enter_run.stats.cache_misses


def test_a_read_only_cache_is_used_through_a_copy(cache, fresh, monkeypatch, tmp_path):
    monkeypatch.setattr(module_cache, "_takes_machine_code", lambda folder: False)
    monkeypatch.setattr(module_cache, "_temporary_folder", lambda: tmp_path)
    kernels = load_compiled(formulate(RIG, LAW)).kernels
    assert Path(kernels.__file__).parent == tmp_path
    assert not kernels.enter_run.stats.cache_misses


def test_machine_code_that_was_deleted_counts_as_absent(cache, tmp_path, monkeypatch):
    model = formulate(RIG, LAW)
    part = compile_units.parts_of(model, ensembles=False)[0]
    assert part.is_kept()
    assert not compile_units.parts_of(model, ensembles=True)[0].is_kept()
    monkeypatch.setattr(module_cache, "_processor", lambda: "another")
    assert not part.is_kept()
    monkeypatch.undo()
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path))
    for stamp in cache.glob("*.ready"):
        (tmp_path / stamp.name).write_bytes(stamp.read_bytes())
    assert not part.is_kept()


def test_a_process_that_dies_is_a_clear_error(empty, monkeypatch):
    monkeypatch.setattr(compile_pool, "_python", lambda: "false")  # a program that fails at once
    with pytest.raises(CompilationError, match="ended with code 1 while compiling SpringBlock"):
        warm_up(PAIRS)


def test_a_process_that_is_killed_is_a_clear_error(empty, monkeypatch):
    def told(done, total, what):
        for process in started:
            os.kill(process.pid, signal.SIGKILL)

    started = watched(monkeypatch)
    with pytest.raises(CompilationError, match=r"ended by signal 9 \(out of memory\?\)"):
        warm_up(PAIRS, progress=told)


def test_an_interrupt_ends_the_processes(empty, monkeypatch):
    def interrupted(done, total, what):
        raise KeyboardInterrupt

    started = watched(monkeypatch)
    with pytest.raises(KeyboardInterrupt):
        warm_up(PAIRS, progress=interrupted)
    assert started
    assert all(process.poll() is not None for process in started)
    assert not list(empty.glob("*.ready"))


def watched(monkeypatch):
    """Return a list of the processes that are started from now on."""
    started, begin = [], subprocess.Popen

    def remembered(*arguments, **settings):
        started.append(begin(*arguments, **settings))
        return started[-1]

    monkeypatch.setattr(compile_pool.subprocess, "Popen", remembered)
    return started


def test_a_cache_that_cannot_be_written_to_is_refused(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "file" / "cache"))
    monkeypatch.setattr(compile_pool.subprocess, "Popen", never)
    with pytest.raises(InputError, match="STICKSLIP_CACHE"):
        warm_up(PAIRS)


@pytest.mark.parametrize("jobs", [0, -1, 1.5, True])
def test_a_number_of_processes_is_checked(jobs):
    with pytest.raises(InputError, match="whole number above 0"):
        warm_up(PAIRS, jobs=jobs)


@pytest.mark.parametrize("pair", [RIG, (RIG,), (LAW, RIG), (RIG, Coulomb)])
def test_what_is_no_pair_is_named(pair):
    with pytest.raises(InputError, match=r"must hold \(mechanism, law\)"):
        warm_up([pair])


def test_the_kernels_come_first_and_once_for_all(empty, monkeypatch):
    seen = []
    monkeypatch.setattr(precompile, "compile_all", lambda parts, *_: seen.extend(parts))
    driven = SpringBlock(mass=1.0, drive=Pulse(level=1.0, duration=1.0))
    warm_up([*PAIRS, (driven, LAW), (driven, OTHER)])
    assert [part.is_shared for part in seen] == [True] + [False] * 4
    assert len({part.text for part in seen}) == len(seen)


@pytest.mark.parametrize(
    ("watched", "handled", "level", "shown"),
    [
        (True, False, "NOTSET", True),
        (False, False, "NOTSET", False),
        (True, True, "NOTSET", False),
        (True, False, "WARNING", False),
    ],
)
def test_a_message_is_shown_where_somebody_watches_and_no_log_takes_it(
    capsys, monkeypatch, watched, handled, level, shown
):
    monkeypatch.setattr(messages, "_watched", lambda: watched)
    monkeypatch.setattr(messages.LOG, "hasHandlers", lambda: handled)
    before = messages.LOG.level
    messages.LOG.setLevel(level)
    try:
        messages.notice("Compiling ...")
    finally:
        messages.LOG.setLevel(before)
    assert (capsys.readouterr().err == "Compiling ...\n") is shown


def test_files_and_pipes_are_nobody_who_watches():
    with tempfile.TemporaryFile() as file:
        code = "from stickslip.solver.compile.messages import notice; notice('Compiling ...')"
        subprocess.run([sys.executable, "-c", code], stderr=file, check=True)
        file.seek(0)
        assert file.read() == b""


def test_a_message_names_pair_and_seconds_once(empty, monkeypatch, caplog):
    monkeypatch.setattr(precompile, "compile_all", lambda *_: None)
    monkeypatch.setattr(compile_units, "_ready", set())  # what other tests left in this process
    with caplog.at_level("INFO", "stickslip"):
        warm_up(PAIRS, jobs=1)
    assert caplog.messages == [
        "Compiling the equations of SpringBlock with Coulomb and 1 more (about 17 s, once) ..."
    ]
