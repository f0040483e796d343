"""Compiling ahead of time."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from dataclasses import replace

import numpy as np
import pytest

from stickslip import Coulomb, CoulombViscous, SpringBlock
from stickslip.engine.formulation import formulate
from stickslip.engine.solver import prepare, warm_up
from stickslip.engine.solver.compile import modules, object_code
from stickslip.engine.solver.compile.modules import load_compiled
from stickslip.engine.solver.compile.programs import KERNELS, KernelsCode
from stickslip.errors import CompilationError, InputError

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)
OTHER = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.4)
PAIRS = [(RIG, LAW), (RIG, OTHER), (SpringBlock(mass=2.0), LAW)]
"""Two laws, and a mechanism that differs from the first in numbers only."""
WARM = """
from stickslip import Coulomb, SpringBlock
from stickslip.engine.solver import warm_up
rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
done = warm_up([(rig, Coulomb(kinetic_coefficient=0.25))])
print(done.kernels_compiled)
"""


@pytest.fixture(scope="module")
def warmed(tmp_path_factory):
    """Warm up a folder with a copy of the kernels that all tests share, one pair first."""
    folder = tmp_path_factory.mktemp("warm")
    KERNELS.load()
    (file,) = object_code.cache_directory().glob(f"{KERNELS.name}.{object_code._processor()}.*")
    shutil.copy2(file, folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STICKSLIP_CACHE", str(folder))
        warm_up(PAIRS[:1])
        told = []
        done = warm_up(PAIRS, progress=lambda *news: told.append(news))
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
    monkeypatch.setattr(object_code, "_loaded", {})
    load_compiled.cache_clear()
    modules._entries.cache_clear()
    yield
    load_compiled.cache_clear()
    modules._entries.cache_clear()


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

    monkeypatch.setattr(object_code.ObjectCode, "load", never)


@pytest.mark.slow
def test_two_processes_at_once_leave_the_kernels_once(tmp_path):
    """Beside a third process that is killed."""
    runs = [start(tmp_path) for _ in range(2)]
    doomed = start(tmp_path)
    threading.Event().wait(3.0)
    os.killpg(doomed.pid, signal.SIGKILL)
    doomed.communicate()
    outputs = [run.communicate() for run in runs]
    assert [run.returncode for run in runs] == [0, 0], outputs
    assert len(list(tmp_path.glob("*.image"))) == 2
    again = start(tmp_path).communicate()
    assert again == ("False\n", "")


def test_laws_share_the_kernels_and_have_a_file_each(warmed):
    folder, done, _ = warmed
    assert not done.kernels_compiled
    assert (done.equations_compiled, done.equations_found) == (1, 1)
    assert done.folder == folder
    assert len(list(folder.glob("*.image"))) == 3


def test_progress_tells_when_something_begins_and_when_it_is_done(warmed):
    *_, told = warmed
    assert told == [(0, 1, "SpringBlock with CoulombViscous"), (1, 1, told[0][2])]


def test_what_is_there_is_not_even_loaded(cache, monkeypatch):
    nothing_is_loaded(monkeypatch)
    done = warm_up(PAIRS)
    assert not done.kernels_compiled
    assert (done.equations_compiled, done.equations_found) == (0, 2)


def test_what_is_there_needs_no_folder_that_can_be_written(cache, monkeypatch):
    monkeypatch.setattr(modules, "is_writable", lambda: False)
    assert not warm_up(PAIRS).kernels_compiled


def test_afterwards_the_equations_are_loaded_and_nothing_is_said(cache, fresh, capsys, monkeypatch):
    monkeypatch.setattr(modules, "_watched", lambda: True)
    monkeypatch.setattr(modules.LOG, "hasHandlers", lambda: False)
    monkeypatch.setattr(object_code, "_compiled", None)
    prepare(RIG, OTHER)
    assert capsys.readouterr().err == ""


def test_the_kernels_refuse_arrays_of_another_kind(cache, fresh):
    kernels = load_compiled(formulate(RIG, LAW)).kernels
    good = [np.zeros(4), np.zeros(4, dtype=np.int64), *[np.zeros(4)] * 2, 1.0, 1.0, 1.0, 1]
    fixed = np.zeros(4)
    fixed.flags.writeable = False
    others = ((0, np.zeros(4, dtype=int)), (1, np.zeros(4)), (2, np.zeros(8)[::2]), (3, fixed))
    for place, wrong in others:
        given = [*good, np.zeros(4), np.zeros(4)]
        given[place] = wrong
        with pytest.raises(TypeError, match=r"driver\.run: \w+ must be a writable array of"):
            kernels.enter_run(*given)


def test_machine_code_that_was_deleted_counts_as_absent(cache, tmp_path, monkeypatch):
    assert KERNELS.is_kept()
    monkeypatch.setattr(object_code, "_processor", lambda: "another")
    assert not KERNELS.is_kept()
    monkeypatch.undo()
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path))
    assert not KERNELS.is_kept()


def test_a_cache_that_cannot_be_written_to_is_refused(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "file" / "cache"))
    nothing_is_loaded(monkeypatch)
    with pytest.raises(InputError, match="STICKSLIP_CACHE"):
        warm_up(PAIRS)


def test_what_the_cache_does_not_keep_is_a_clear_error(cache, tmp_path, monkeypatch):
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path))
    monkeypatch.setattr(KernelsCode, "load", lambda kernels: True)
    with pytest.raises(CompilationError, match="did not keep the solver"):
        warm_up(PAIRS)


@pytest.mark.parametrize("pair", [RIG, (RIG,), (LAW, RIG), (RIG, Coulomb)])
def test_what_is_no_pair_is_named(pair):
    with pytest.raises(InputError, match=r"must hold \(mechanism, law\)"):
        warm_up([pair])


def test_the_kernels_come_first_and_once_for_all(empty, monkeypatch):
    seen = []
    monkeypatch.setattr(modules, "_compiled", lambda parts, _: set(seen.extend(parts) or []))
    warm_up([*PAIRS, (replace(RIG, attached=True), LAW), (replace(RIG, attached=True), OTHER)])
    assert [isinstance(part, KernelsCode) for part in seen] == [True] + [False] * 4
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
    monkeypatch.setattr(modules, "_watched", lambda: watched)
    monkeypatch.setattr(modules.LOG, "hasHandlers", lambda: handled)
    before = modules.LOG.level
    modules.LOG.setLevel(level)
    try:
        modules.notice("Compiling ...")
    finally:
        modules.LOG.setLevel(before)
    assert (capsys.readouterr().err == "Compiling ...\n") is shown


def test_files_and_pipes_are_nobody_who_watches():
    with tempfile.TemporaryFile() as file:
        code = "from stickslip.engine.solver.compile.modules import notice; notice('Compiling ...')"
        subprocess.run([sys.executable, "-c", code], stderr=file, check=True)
        file.seek(0)
        assert file.read() == b""


def test_a_message_says_what_is_compiled_and_how_long_it_takes(empty, monkeypatch, caplog):
    monkeypatch.setattr(object_code, "_loaded", {})  # what other tests left in this process
    with caplog.at_level("INFO", "stickslip"):
        modules.waiting()
    assert caplog.messages == ["Compiling the solver (about 6 s, once) ..."]
