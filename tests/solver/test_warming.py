"""Compiling ahead of time."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from stickslip import Coulomb, CoulombViscous, EventDriven, SpringBlock, simulate
from stickslip.errors import CompilationError, InputError
from stickslip.formulation import formulate
from stickslip.solver import prepare, warm_up
from stickslip.solver.compile import (
    compile_units,
    equations_code,
    messages,
    module_cache,
    modules,
    precompile,
)
from stickslip.solver.compile.compile_units import CompileUnit
from stickslip.solver.compile.equations_code import EquationsCode
from stickslip.solver.compile.modules import load_compiled

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)
OTHER = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.4)
PAIRS = [(RIG, LAW), (RIG, OTHER), (SpringBlock(mass=2.0), LAW)]
"""Two laws, and a mechanism that differs from the first in numbers only."""
WARM = """
from stickslip import Coulomb, SpringBlock
from stickslip.solver import warm_up
rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
done = warm_up([(rig, Coulomb(kinetic_coefficient=0.25))], ensembles=False)
print(done.kernels_compiled, done.kernels_found)
"""


@pytest.fixture(scope="module")
def warmed(tmp_path_factory):
    """Warm up a folder with a copy of the kernels that all tests share, one pair first."""
    folder = tmp_path_factory.mktemp("warm")
    (kernels,) = compile_units.units_of(formulate(RIG, LAW), ensembles=False)
    kernels.load()
    source = Path(module_cache.module_of(kernels.text, compiled=True).__file__)
    (folder / "__pycache__").mkdir()
    files = [source]
    for entry in kernels.entries:
        files += source.parent.glob(f"{source.stem}.{entry}.*.ready")
        files += source.parent.glob(f"__pycache__/{source.stem}.{entry}-*.nb[ic]")
    for file in files:  # with their times, by which numba knows the source of machine code
        shutil.copy2(file, folder / file.relative_to(source.parent))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STICKSLIP_CACHE", str(folder))
        warm_up(PAIRS[:1], ensembles=False)
        told = []
        done = warm_up(PAIRS, ensembles=False, progress=lambda *news: told.append(news))
        return folder, done, told


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
    monkeypatch.setattr(equations_code, "_loaded", {})
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


def nothing_is_loaded(monkeypatch):
    def never(_part):
        raise AssertionError("something was loaded or compiled")

    monkeypatch.setattr(CompileUnit, "load", never)
    monkeypatch.setattr(EquationsCode, "load", never)


@pytest.mark.slow
def test_two_processes_at_once_compile_the_kernels_once(tmp_path):
    """Beside a third process that is killed."""
    runs = [start(tmp_path) for _ in range(2)]
    doomed = start(tmp_path)
    while not list(tmp_path.glob("*.py")):
        threading.Event().wait(0.05)
    os.killpg(doomed.pid, signal.SIGKILL)
    doomed.communicate()
    outputs = [run.communicate(timeout=600) for run in runs]
    assert [run.returncode for run in runs] == [0, 0], outputs
    counts = [[int(count) for count in out.split()] for out, _ in outputs]
    assert [compiled + found for compiled, found in counts] == [1, 1]
    assert sum(compiled for compiled, _ in counts) <= 1  # none if the killed one was through


def test_laws_share_the_kernels_and_have_a_file_each(warmed):
    folder, done, _ = warmed
    assert (done.kernels_compiled, done.kernels_found) == (0, 1)
    assert (done.equations_compiled, done.equations_found) == (1, 1)
    assert done.folder == folder
    assert len(list((folder / "__pycache__").glob("*.enter_run-*.nbc"))) == 1
    assert len(list(folder.glob("*.image"))) == 2


def test_progress_tells_when_something_begins_and_when_it_is_done(warmed):
    *_, told = warmed
    assert told == [(0, 1, "SpringBlock with CoulombViscous"), (1, 1, told[0][2])]


def test_what_is_there_is_not_even_loaded(cache, monkeypatch):
    nothing_is_loaded(monkeypatch)
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
    part = compile_units.units_of(model, ensembles=False)[0]
    assert part.is_kept()
    assert not compile_units.units_of(model, ensembles=True)[0].is_kept()
    monkeypatch.setattr(module_cache, "_processor", lambda: "another")
    assert not part.is_kept()
    monkeypatch.undo()
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path))
    for stamp in cache.glob("*.ready"):
        (tmp_path / stamp.name).write_bytes(stamp.read_bytes())
    assert not part.is_kept()


def test_a_cache_that_cannot_be_written_to_is_refused(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "file" / "cache"))
    nothing_is_loaded(monkeypatch)
    with pytest.raises(InputError, match="STICKSLIP_CACHE"):
        warm_up(PAIRS)


def test_what_the_cache_does_not_keep_is_a_clear_error(cache, tmp_path, monkeypatch):
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path))
    monkeypatch.setattr(CompileUnit, "load", lambda unit: True)
    with pytest.raises(CompilationError, match="did not keep the solver"):
        warm_up(PAIRS, ensembles=False)


@pytest.mark.parametrize("pair", [RIG, (RIG,), (LAW, RIG), (RIG, Coulomb)])
def test_what_is_no_pair_is_named(pair):
    with pytest.raises(InputError, match=r"must hold \(mechanism, law\)"):
        warm_up([pair])


def test_the_kernels_come_first_and_once_for_all(empty, monkeypatch):
    seen = []
    monkeypatch.setattr(precompile, "_compiled", lambda parts, _: set(seen.extend(parts) or []))
    warm_up([*PAIRS, (replace(RIG, attached=True), LAW), (replace(RIG, attached=True), OTHER)])
    assert [isinstance(part, CompileUnit) for part in seen] == [True] + [False] * 4
    assert len(set(seen)) == len(seen)


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


def test_a_message_says_what_is_compiled_and_how_long_it_takes(empty, monkeypatch, caplog):
    monkeypatch.setattr(compile_units, "_ready", set())  # what other tests left in this process
    units = compile_units.units_of(formulate(RIG, LAW), ensembles=False)
    with caplog.at_level("INFO", "stickslip"):
        modules.waiting(units)
    assert caplog.messages == ["Compiling the solver (about 27 s, once) ..."]
