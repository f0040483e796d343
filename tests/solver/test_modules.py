"""The cache of generated modules."""

import errno
import importlib.util
import marshal
import os
import pickle
import stat
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numba
import pytest

from stickslip import Coulomb, SpringBlock, simulate
from stickslip.formulation import formulate
from stickslip.kernels.equations import FIELD
from stickslip.solver.compile import module_cache
from stickslip.solver.compile.codegen import plain_text
from stickslip.solver.compile.compile_units import CompileUnit
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


# --- a cache that others may write to: what lies in it is run

posix = pytest.mark.skipif(os.name == "nt", reason="Windows has access lists, not mode bits")
FORGED = "open({!r}, 'w').close()"


class Forged:
    """A pickle that runs a program when it is loaded."""

    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return exec, (FORGED.format(self.mark),)


@pytest.fixture
def warned():
    """Forget which warnings were given."""
    module_cache._warn.cache_clear()
    yield
    module_cache._warn.cache_clear()


@pytest.fixture
def small():
    """Return a module for numba that compiles in a moment."""
    return (
        "from numba import njit\n\n"
        "@njit('int64(int64)', cache=True)\ndef entry(i):\n    return i + 1\n"
    )


def of_another_user(monkeypatch, *foreign):
    """Let files and folders belong to a user who is neither this one nor root."""
    foreign = {str(path) for path in foreign}
    stat, lstat = os.stat, os.lstat

    def owned(real):
        def status(path, *arguments, **settings):
            found = real(path, *arguments, **settings)
            if str(path) not in foreign:
                return found
            return os.stat_result((*found[:4], os.geteuid() + 1234, *found[5:10]))

        return status

    monkeypatch.setattr(os, "stat", owned(stat))
    monkeypatch.setattr(os, "lstat", owned(lstat))


def test_a_module_is_run_from_its_known_text_and_never_from_bytes_beside_it(cache, model, tmp_path):
    load(model)
    (path,) = files(cache)
    mark = tmp_path / "forged code ran"
    status = path.stat()
    code = compile(FORGED.format(str(mark)) + "\nN_STATES = 2\n", str(path), "exec")
    stamp = (0).to_bytes(4, "little")
    stamp += int(status.st_mtime).to_bytes(4, "little") + status.st_size.to_bytes(4, "little")
    forged = Path(importlib.util.cache_from_source(str(path)))
    forged.parent.mkdir(exist_ok=True)
    forged.write_bytes(importlib.util.MAGIC_NUMBER + stamp + marshal.dumps(code))
    forget()
    assert callable(load(model).equations[FIELD])
    assert not mark.exists()


def test_no_bytes_are_left_that_could_be_run_in_place_of_the_text(cache, model):
    load(model)
    assert not list(cache.rglob("*.pyc"))


@posix
@pytest.mark.parametrize("mode", [0o777, 0o775, 0o757, 0o1777])
def test_machine_code_in_a_folder_that_others_may_write_to_is_not_loaded(
    cache, tmp_path, small, warned, mode
):
    module_cache.module_of(small, compiled=True)
    mark = tmp_path / "forged pickle was loaded"
    inner = cache / "__pycache__"
    for index in inner.glob("*.nbi"):
        index.write_bytes(pickle.dumps(numba.__version__) + pickle.dumps(Forged(str(mark))))
    cache.chmod(mode)
    forget()
    with pytest.warns(UserWarning, match=r"others may write .*chmod -R go-w .*STICKSLIP_CACHE"):
        module = module_cache.module_of(small, compiled=True)
    assert module.entry(1) == 2
    assert cache not in Path(module.__file__).parents
    assert not mark.exists()


@posix
def test_a_folder_within_one_that_others_may_write_to_is_not_trusted(
    tmp_path, small, warned, monkeypatch
):
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "open" / "cache"))
    (tmp_path / "open" / "cache").mkdir(parents=True, mode=0o700)
    (tmp_path / "open").chmod(0o777)
    with pytest.warns(UserWarning, match=r"others may write to .*open: "):
        module_cache.module_of(small, compiled=True)
    assert not module_cache.is_writable()
    (tmp_path / "open").chmod(0o1777)  # as /tmp: nobody may rename what is another's
    forget()
    module = module_cache.module_of(small, compiled=True)
    assert Path(module.__file__).parent == tmp_path / "open" / "cache"
    assert module_cache.is_writable()


@posix
def test_a_folder_of_another_user_is_not_trusted(cache, small, warned, monkeypatch):
    cache.mkdir()
    of_another_user(monkeypatch, cache)
    with pytest.warns(UserWarning, match="belongs to another user"):
        module_cache.module_of(small, compiled=True)
    assert not list(cache.iterdir())


@posix
@pytest.mark.parametrize("forged", ["owner", "mode", "link"])
def test_one_file_that_may_be_anothers_is_enough_to_compile_anew(
    cache, small, warned, monkeypatch, tmp_path, forged
):
    cache.mkdir(mode=0o755)
    module_cache.module_of(small, compiled=True)
    (index,) = (cache / "__pycache__").glob("*.nbi")
    if forged == "owner":
        of_another_user(monkeypatch, index)
    elif forged == "mode":
        index.chmod(0o666)
    else:
        index.rename(tmp_path / "elsewhere")
        index.symlink_to(tmp_path / "elsewhere")
    forget()
    with pytest.warns(UserWarning, match=r"nbi"):
        module = module_cache.module_of(small, compiled=True)
    assert cache not in Path(module.__file__).parents
    assert module.entry(1) == 2


@posix
def test_a_read_only_folder_of_root_is_trusted_by_all_users(cache, small, warned, monkeypatch):
    if os.geteuid() != 0:
        pytest.skip("only root can make what belongs to root")
    cache.mkdir(mode=0o755)
    module_cache.module_of(small, compiled=True)
    forget()
    monkeypatch.setattr(os, "geteuid", lambda: 1234)
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK)
    module = module_cache.module_of(small, compiled=True)  # and nothing warns
    assert sum(module.entry.stats.cache_hits.values()) == 1


@posix
def test_a_link_to_a_folder_of_ones_own_is_followed_and_its_target_is_judged(
    tmp_path, small, warned, monkeypatch
):
    (tmp_path / "real").mkdir(mode=0o700)
    (tmp_path / "link").symlink_to(tmp_path / "real")
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "link"))
    module = module_cache.module_of(small, compiled=True)
    assert Path(module.__file__).parent == (tmp_path / "real").resolve()
    (tmp_path / "real").chmod(0o777)
    forget()
    with pytest.warns(UserWarning, match="others may write"):
        module_cache.module_of(small, compiled=True)


@posix
def test_folders_that_are_made_are_closed_to_others(tmp_path, small, monkeypatch):
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "a" / "b"))
    old = os.umask(0o000)
    try:
        module_cache.module_of(small, compiled=True)
    finally:
        os.umask(old)
    made = [tmp_path / "a", tmp_path / "a" / "b", tmp_path / "a" / "b" / "__pycache__"]
    assert [stat.S_IMODE(folder.stat().st_mode) for folder in made] == [0o700] * 3


@posix
def test_an_open_umask_leaves_no_machine_code_that_others_may_change(cache):
    text = "from numba import cfunc\n\n"
    text += "@cfunc('int64(int64)', cache=True)\ndef contacts(i):\n    return i + 1\n"
    cache.mkdir(mode=0o755)  # shared on purpose: others may read
    old = os.umask(0o000)
    try:
        unit = CompileUnit("a small one", text, ("contacts",))
        unit.load()
    finally:
        os.umask(old)
    assert unit.is_kept()
    inside = [cache / "__pycache__", *(cache / "__pycache__").iterdir()]
    assert len(inside) > 2
    assert not [path for path in inside if path.stat().st_mode & 0o022]
    assert all(path.stat().st_mode & 0o044 for path in inside)


@posix
def test_a_warning_is_given_once(cache, small, warned):
    cache.mkdir(mode=0o700)
    cache.chmod(0o777)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for _ in range(3):
            forget()
            module_cache.module_of(small, compiled=True)
    assert len(caught) == 1


@posix
def test_what_a_folder_of_others_says_of_machine_code_is_not_believed(cache, small):
    cache.mkdir(mode=0o700)
    module_cache.keep(small, "entry", [])
    (cache / "code").touch()
    module_cache.keep(small, "entry", [cache / "code"])
    assert module_cache.is_kept(small, "entry")
    cache.chmod(0o777)
    assert not module_cache.is_kept(small, "entry")
    before = sorted(cache.rglob("*"))
    module_cache.keep(small, "other", [cache / "code"])
    with module_cache.locked(small):
        pass
    assert sorted(cache.rglob("*")) == before


@posix
def test_the_folder_that_numba_was_given_is_judged_like_ours(
    cache, small, warned, tmp_path, monkeypatch
):
    folder = tmp_path / "numba"
    folder.mkdir()
    folder.chmod(0o777)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(folder))
    module_cache.module_of(small, compiled=True)
    assert not list(folder.iterdir())
    assert str(folder) == numba.config.CACHE_DIR
    folder.chmod(0o755)
    forget()
    module_cache.module_of(small, compiled=True)
    assert list(folder.rglob("*.nbi"))


def test_nothing_is_judged_where_there_are_no_mode_bits(cache, small, monkeypatch):
    cache.mkdir()
    cache.chmod(0o777)
    monkeypatch.setattr(module_cache, "HAS_MODES", False)
    module = module_cache.module_of(small, compiled=True)
    assert Path(module.__file__).parent == cache


@posix
def test_links_that_go_round_in_circles_are_no_obstacle(tmp_path, model, monkeypatch):
    (tmp_path / "a").symlink_to(tmp_path / "b")
    (tmp_path / "b").symlink_to(tmp_path / "a")
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "a"))
    assert callable(load(model).equations[FIELD])
    assert not module_cache.is_writable()
    assert not module_cache.is_kept(plain_text(model), "entry")


@posix
def test_the_command_in_a_warning_can_be_pasted(tmp_path, small, warned, monkeypatch):
    folder = tmp_path / "my cache; rm"
    folder.mkdir()
    folder.chmod(0o777)
    monkeypatch.setenv("STICKSLIP_CACHE", str(folder))
    with pytest.warns(UserWarning, match="chmod") as caught:
        module_cache.module_of(small, compiled=True)
    command = str(caught[0].message).partition("run ")[2].partition("):")[0]
    subprocess.run(command, shell=True, check=True)
    forget()
    module = module_cache.module_of(small, compiled=True)
    assert Path(module.__file__).parent == folder
