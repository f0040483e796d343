"""The cache of generated modules."""

import errno
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from stickslip import Coulomb, SpringBlock, simulate
from stickslip.formulation import formulate
from stickslip.kernels.equations import FIELD
from stickslip.solver.compile import module_cache
from stickslip.solver.compile.codegen import plain_text
from stickslip.solver.compile.modules import cache_directory, load, plain_equations

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)
RUN = """
from stickslip import Coulomb, SpringBlock, simulate
rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
print(repr(float(simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)["x"][-1])))
"""

OWN = """
import sys
sys.modules.update(dict.fromkeys(sys.argv[1:]))  # modules that this platform lacks
from stickslip.solver.compile.module_cache import locked
print("asks", flush=True)
with locked("text"), open("diary", "a", 1) as diary:
    print("in", file=diary)
    print("in", flush=True)
    sys.stdin.readline()
    print("out", file=diary)
"""
PLATFORMS = {"with flock": [], "without fcntl, as on Windows": ["fcntl"]}


@pytest.fixture
def model():
    return formulate(RIG, LAW)


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch, model):
    """Give each test a cache of its own, and forget what is in memory."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("STICKSLIP_CACHE", str(folder))
    forgotten = dict(sys.modules)
    for name in [name for name in sys.modules if name.startswith("stickslip_")]:
        del sys.modules[name]
    load.cache_clear()
    plain_equations.cache_clear()
    yield folder
    load.cache_clear()
    plain_equations.cache_clear()
    sys.modules.update({k: v for k, v in forgotten.items() if k.startswith("stickslip_")})


def files(folder):
    return sorted(path for path in folder.iterdir() if path.suffix == ".py")


def start(folder):
    return subprocess.Popen(
        [sys.executable, "-c", RUN],
        env={**os.environ, "STICKSLIP_CACHE": str(folder)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.fixture
def owner(cache, tmp_path):
    """Start processes that take the lock and keep it until their input ends."""
    started = []

    def begin(*absent):
        process = subprocess.Popen(
            [sys.executable, "-W", "ignore", "-c", OWN, *absent],
            cwd=tmp_path,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        assert process.stdout.readline() == "asks\n"
        return process

    yield begin
    for process in started:
        process.kill()
        process.communicate()


def forget():
    load.cache_clear()
    plain_equations.cache_clear()
    for name in [name for name in sys.modules if name.startswith("stickslip_")]:
        del sys.modules[name]


def test_the_cache_is_where_the_environment_says(cache, monkeypatch):
    assert cache_directory() == cache
    monkeypatch.delenv("STICKSLIP_CACHE")
    assert cache_directory().name == "modules"
    assert "stickslip" in str(cache_directory())


def test_a_module_is_one_file_with_its_whole_text_and_no_leftovers(cache, model):
    load(model)
    (path,) = files(cache)
    assert path.read_text(encoding="utf-8") == plain_text(model)
    assert not list(cache.glob("*.tmp"))


def test_the_same_equations_are_loaded_once(model):
    assert load(model) is load(formulate(RIG, Coulomb(kinetic_coefficient=0.4)))


def test_a_second_load_leaves_the_file_alone(cache, model):
    load(model)
    (path,) = files(cache)
    before = path.stat().st_mtime_ns
    forget()
    load(model)
    assert path.stat().st_mtime_ns == before


@pytest.mark.parametrize("damage", ["", "raise SystemExit", "def field(:", "\x00"])
def test_a_damaged_file_is_written_anew(cache, model, damage):
    load(model)
    (path,) = files(cache)
    path.write_text(damage, encoding="utf-8")
    forget()
    assert callable(load(model).equations[FIELD])
    assert path.read_text(encoding="utf-8") == plain_text(model)


def test_a_file_of_undecodable_bytes_is_written_anew(cache, model):
    load(model)
    (path,) = files(cache)
    path.write_bytes(b"\xff\xfe\xff")
    forget()
    assert callable(load(model).equations[FIELD])
    assert path.read_text(encoding="utf-8") == plain_text(model)


def test_a_cache_that_cannot_be_made_is_no_obstacle(tmp_path, monkeypatch, model):
    blocked = tmp_path / "file"
    blocked.write_text("in the way", encoding="utf-8")
    monkeypatch.setenv("STICKSLIP_CACHE", str(blocked / "cache"))
    assert callable(load(model).equations[FIELD])
    assert simulate(RIG, LAW, t_end=1.0)["x"][-1] > 0.2


def test_a_cache_that_cannot_be_written_to_is_no_obstacle(cache, model, monkeypatch):
    make = tempfile.mkstemp

    def guarded(*arguments, **settings):
        if settings.get("dir") == cache:
            raise PermissionError("read-only")  # what a folder without write access answers
        return make(*arguments, **settings)

    monkeypatch.setattr(tempfile, "mkstemp", guarded)
    assert callable(load(model).equations[FIELD])
    assert not list(cache.iterdir())


def test_a_write_that_fails_half_way_leaves_nothing_behind(cache, monkeypatch, model):
    def refuse(*_):
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", refuse)
    monkeypatch.setattr(Path, "replace", refuse)
    with pytest.raises(OSError, match="disk full"):
        load(model)
    assert not list(cache.iterdir())


def test_two_processes_may_make_the_same_module_at_once(cache):
    runs = [start(cache) for _ in range(2)]
    outputs = [run.communicate(timeout=120) for run in runs]
    assert [run.returncode for run in runs] == [0, 0], outputs
    assert outputs[0][0] == outputs[1][0]
    assert len(files(cache)) == 1
    assert not list(cache.glob("*.tmp"))


@pytest.mark.parametrize("absent", PLATFORMS.values(), ids=PLATFORMS)
def test_a_second_process_waits_until_the_first_has_compiled(owner, tmp_path, absent):
    first = owner(*absent)
    assert first.stdout.readline() == "in\n"
    second = owner(*absent)
    time.sleep(1.0)  # without a lock, the second is in at once
    first.communicate(timeout=60)
    second.communicate(timeout=60)
    assert (tmp_path / "diary").read_text().split() == ["in", "out", "in", "out"]


@pytest.mark.parametrize("absent", PLATFORMS.values(), ids=PLATFORMS)
def test_a_process_that_dies_with_the_lock_blocks_nobody(owner, absent):
    first = owner(*absent)
    assert first.stdout.readline() == "in\n"
    first.kill()
    first.wait()
    assert owner(*absent).stdout.readline() == "in\n"


def test_a_process_that_hangs_with_the_lock_is_not_waited_for_for_ever(owner, monkeypatch):
    monkeypatch.setattr(module_cache, "LONGEST_WAIT", 0.1)
    first = owner()
    assert first.stdout.readline() == "in\n"
    with module_cache.locked("text"):
        assert first.poll() is None


def test_a_folder_that_cannot_be_made_needs_no_lock(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "file" / "cache"))
    with module_cache.locked("text"):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.skipif(os.name == "nt", reason="Windows has no flock")
@pytest.mark.parametrize("code", [errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP])
def test_a_file_system_without_locks_is_no_obstacle(cache, monkeypatch, code):
    def refuse(*_):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr("fcntl.flock", refuse)
    with module_cache.locked("text"):
        pass


def test_a_generated_module_needs_nothing_but_math(model):
    text = plain_text(model)
    imports = [line for line in text.splitlines() if line.lstrip().startswith(("import", "from "))]
    assert imports == ["import math"]
