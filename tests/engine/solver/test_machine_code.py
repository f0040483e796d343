"""Files of machine code: what is loaded of them, and what is not."""

import ctypes
import os
import stat
import subprocess
import sys
import warnings
from types import SimpleNamespace

import pytest

from stickslip.engine.solver.compile import object_code, programs
from stickslip.engine.solver.compile.object_code import _linked
from stickslip.engine.solver.compile.programs import EquationsCode
from stickslip.errors import CompilationError

TEXT = "def f(mode, flags, t, w, at, to):\n    w[to] = w[at] + math.exp(t)\n    return\n"
CODE = EquationsCode("a test", TEXT, (("f", 0),))
AT_ONCE = """
import sys
from stickslip.engine.solver.compile.programs import EquationsCode
sys.stdin.readline()
for i in range(20):
    text = f"def f(mode, flags, t, w, at, to):\\n    w[to] = t + {i}.0\\n    return\\n"
    code = EquationsCode("a test", text, (("f", 0),))
    assert code.load() in (True, False)
    assert code.is_kept()
print("done")
"""
posix = pytest.mark.skipif(os.name == "nt", reason="Windows has access lists, not mode bits")


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """Give each test a cache of its own, and forget what is in memory."""
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(object_code, "_loaded", {})
    object_code._warn.cache_clear()
    yield tmp_path / "cache"
    object_code._warn.cache_clear()


@pytest.fixture
def file(cache):
    """Return the file of the code, which was compiled and is forgotten."""
    assert CODE.load()
    (path,) = cache.iterdir()
    object_code._loaded.clear()
    return path


def value():
    """Return what the loaded code makes of 2.0 at time 0."""
    iw, real = ctypes.c_int64, ctypes.c_double
    vector = ctypes.POINTER(real), iw
    kind = ctypes.CFUNCTYPE(None, iw, iw, iw, real, *vector, iw, iw)
    w = (real * 2)(2.0, 0.0)
    kind(CODE.address)(0, 0, 0, 0.0, w, 2, 0, 1)
    return w[1]


def never(*_):
    raise AssertionError("it was asked for")


def test_a_second_process_loads_what_the_first_has_compiled(file, monkeypatch):
    monkeypatch.setattr(object_code, "_compiled", never)
    assert CODE.is_kept()
    assert not CODE.is_ready()
    assert not CODE.load()
    assert value() == 3.0


def test_what_is_loaded_stays_where_it_is(file):
    CODE.load()
    address = CODE.address
    assert not CODE.load()
    file.unlink()
    assert CODE.load()  # and keeps it again
    assert file.exists()
    assert CODE.address == address


DAMAGE = {
    "nothing left": lambda content: b"",
    "only the seal": lambda content: content[: object_code.SEAL],
    "cut short": lambda content: content[: len(content) // 2],
    "one byte short": lambda content: content[:-1],
    "one byte more": lambda content: content + b"\x00",
    "one bit of the code": lambda content: (
        content[:200] + bytes([content[200] ^ 1]) + content[201:]
    ),
    "one bit of the seal": lambda content: bytes([content[0] ^ 1]) + content[1:],
    "zeros, as after a crash": lambda content: bytes(len(content)),
    "something else": lambda content: b"#!/bin/sh\n" * 100,
}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_file_is_never_linked_but_written_anew(file, damage, monkeypatch):
    iw = file.read_bytes()
    file.write_bytes(damage(iw))
    linked, seen = object_code._linked, []
    monkeypatch.setattr(
        object_code,
        "_linked",
        lambda name, image, symbols: seen.append(image) or linked(name, image, symbols),
    )
    assert CODE.load()
    assert seen == [iw[object_code.SEAL :]]
    assert file.read_bytes() == iw
    assert value() == 3.0


def test_the_code_of_other_equations_is_damage_too(file):
    other = EquationsCode("another", TEXT.replace("w[at] +", "w[at] -"), CODE.numbers)
    other.load()
    (path,) = (path for path in file.parent.iterdir() if path != file)
    iw = file.read_bytes()
    file.write_bytes(path.read_bytes())
    assert CODE.load()
    assert file.read_bytes() == iw


@pytest.mark.parametrize("image", [b"", b"no code", b"\x7fELF" + bytes(200)])
def test_what_llvm_cannot_link_is_a_clear_error(image):
    with pytest.raises(CompilationError, match="cannot be loaded"):
        _linked("a test", image, ["equations"])


def test_a_function_that_nothing_defines_is_a_clear_error():
    text = "define void @equations() {\n  call void @stickslip_nowhere()\n  ret void\n}\n"
    image = object_code._compiled(text + "declare void @stickslip_nowhere()\n")
    with pytest.raises(CompilationError, match="cannot be loaded"):
        _linked("a test", image, ["equations"])


def test_another_processor_or_another_maker_has_files_of_its_own(file, monkeypatch):
    monkeypatch.setattr(object_code, "_processor", lambda: "another")
    assert not CODE.is_kept()
    monkeypatch.undo()
    monkeypatch.setenv("STICKSLIP_CACHE", str(file.parent))
    assert CODE.is_kept()
    monkeypatch.setattr(programs, "maker", lambda: "a later version")
    assert not CODE.is_kept()


def test_numbers_are_part_of_the_name():
    assert EquationsCode("a test", TEXT, (("f", 1),)).name != CODE.name
    assert EquationsCode("another title", TEXT, (("f", 0),)) == CODE


def test_a_cache_that_cannot_be_made_is_no_obstacle(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "file" / "cache"))
    with pytest.warns(UserWarning, match="cannot be used"):
        assert CODE.load()
    assert not CODE.is_kept()
    assert value() == 3.0


@posix
def test_a_folder_that_others_may_write_to_is_neither_read_nor_written(file, monkeypatch):
    file.parent.chmod(0o777)
    before = file.read_bytes(), file.stat().st_mtime_ns
    assert not CODE.is_kept()
    with pytest.warns(UserWarning, match=r"others may write .*chmod -R go-w"):
        assert CODE.load()
    assert (file.read_bytes(), file.stat().st_mtime_ns) == before
    assert value() == 3.0


@posix
@pytest.mark.parametrize("forged", ["owner", "mode", "link"])
def test_a_file_that_may_be_anothers_is_not_loaded(file, monkeypatch, tmp_path, forged):
    file.parent.chmod(0o755)
    if forged == "mode":
        file.chmod(0o666)
    elif forged == "link":
        file.rename(tmp_path / "elsewhere")
        file.symlink_to(tmp_path / "elsewhere")
    else:
        lstat = os.lstat

        def owned(path, *arguments, **settings):
            found = lstat(path, *arguments, **settings)
            if str(path) != str(file):
                return found
            return os.stat_result((*found[:4], os.geteuid() + 1234, *found[5:10]))

        monkeypatch.setattr(os, "lstat", owned)
        monkeypatch.setattr("pathlib.Path.lstat", owned)
    with pytest.warns(UserWarning, match="image"):
        assert CODE.load()
    assert value() == 3.0


@posix
def test_files_are_closed_to_the_writing_of_others_whatever_the_umask(cache):
    old = os.umask(0o000)
    try:
        CODE.load()
    finally:
        os.umask(old)
    (path,) = cache.iterdir()
    assert stat.S_IMODE(cache.stat().st_mode) == 0o700
    assert stat.S_IMODE(path.stat().st_mode) == 0o644


def test_a_disk_that_is_full_leaves_nothing_behind_and_is_no_obstacle(cache, monkeypatch):
    def refuse(*_):
        raise OSError("disk full")

    monkeypatch.setattr("pathlib.Path.replace", refuse)
    assert CODE.load()
    assert not list(cache.iterdir())
    assert value() == 3.0


@pytest.mark.slow
def test_two_processes_at_once_leave_one_whole_file_each(cache):
    runs = [
        subprocess.Popen(
            [sys.executable, "-c", AT_ONCE],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )
        for _ in range(2)
    ]  # fmt: skip
    outputs = [run.communicate("go\n") for run in runs]
    assert outputs == [("done\n", "")] * 2
    assert [run.returncode for run in runs] == [0, 0]
    assert len(list(cache.iterdir())) == 20
    assert all(path.suffix == ".image" for path in cache.iterdir())


def test_the_same_equations_give_the_same_code_every_time(file):
    image = object_code._compiled(CODE.text())
    assert file.read_bytes()[object_code.SEAL :] == image


@posix
def test_a_folder_within_one_that_others_may_write_to_is_not_trusted(tmp_path, monkeypatch):
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "open" / "cache"))
    (tmp_path / "open" / "cache").mkdir(parents=True, mode=0o700)
    (tmp_path / "open").chmod(0o777)
    with pytest.warns(UserWarning, match=r"others may write to .*open: "):
        CODE.load()
    assert not CODE.is_kept()
    assert not object_code.is_writable()
    (tmp_path / "open").chmod(0o1777)  # as /tmp: nobody may rename what is another's
    assert CODE.load()
    assert CODE.is_kept()
    assert object_code.is_writable()


@posix
def test_a_read_only_folder_of_root_is_trusted_by_all_users(file, monkeypatch):
    if os.geteuid() != 0:
        pytest.skip("only root can make what belongs to root")
    file.parent.chmod(0o755)
    monkeypatch.setattr(os, "geteuid", lambda: 1234)
    assert not CODE.load()  # and nothing warns
    assert value() == 3.0


@posix
def test_a_link_to_a_folder_of_ones_own_is_followed_and_its_target_is_judged(tmp_path, monkeypatch):
    (tmp_path / "real").mkdir(mode=0o700)
    (tmp_path / "link").symlink_to(tmp_path / "real")
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "link"))
    CODE.load()
    assert [path.suffix for path in (tmp_path / "real").iterdir()] == [".image"]
    (tmp_path / "real").chmod(0o777)
    object_code._loaded.clear()
    with pytest.warns(UserWarning, match="others may write"):
        CODE.load()


@posix
def test_folders_that_are_made_are_closed_to_others(tmp_path, monkeypatch):
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "a" / "b"))
    old = os.umask(0o000)
    try:
        CODE.load()
    finally:
        os.umask(old)
    made = [tmp_path / "a", tmp_path / "a" / "b"]
    assert [stat.S_IMODE(folder.stat().st_mode) for folder in made] == [0o700] * 2


@posix
def test_a_warning_is_given_once(file):
    file.parent.chmod(0o777)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for _ in range(3):
            object_code._loaded.clear()
            CODE.load()
    assert len(caught) == 1


def test_nothing_is_judged_where_there_are_no_mode_bits(file, monkeypatch):
    file.parent.chmod(0o777)
    monkeypatch.setattr(object_code, "sys", SimpleNamespace(platform="win32"))
    assert not CODE.load()


@posix
def test_links_that_go_round_in_circles_are_no_obstacle(tmp_path, monkeypatch):
    (tmp_path / "a").symlink_to(tmp_path / "b")
    (tmp_path / "b").symlink_to(tmp_path / "a")
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "a"))
    assert not CODE.is_kept()
    assert not object_code.is_writable()
    with pytest.warns(UserWarning, match="cannot be used"):
        CODE.load()
    assert value() == 3.0


@posix
def test_the_command_in_a_warning_can_be_pasted(tmp_path, monkeypatch):
    folder = tmp_path / "my cache; rm"
    folder.mkdir()
    folder.chmod(0o777)
    monkeypatch.setenv("STICKSLIP_CACHE", str(folder))
    with pytest.warns(UserWarning, match="chmod") as caught:
        CODE.load()
    command = str(caught[0].message).partition("run ")[2].partition("):")[0]
    subprocess.run(command, shell=True, check=True)
    CODE.load()
    assert CODE.is_kept()


@pytest.mark.parametrize(("seconds", "warned"), [(0.1, 0), (10.0, 1)])
def test_who_compiles_for_long_in_vain_is_told(file, monkeypatch, seconds, warned):
    def refuse(*_):
        raise OSError("read-only file system")

    file.unlink()
    monkeypatch.setattr("pathlib.Path.replace", refuse)
    monkeypatch.setattr(EquationsCode, "seconds", seconds)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert CODE.load()
    assert len(caught) == warned


def test_the_cache_is_where_the_environment_says(cache, monkeypatch):
    assert object_code.cache_directory() == cache
    monkeypatch.delenv("STICKSLIP_CACHE")
    assert object_code.cache_directory().name == "code"
    assert "stickslip" in str(object_code.cache_directory())


@pytest.mark.parametrize("named", ["generic", "no-such-processor"])
def test_code_for_a_named_processor_has_files_of_its_own(monkeypatch, named):
    own = object_code.processor.__wrapped__()
    monkeypatch.setenv("STICKSLIP_CPU", named)
    kind = object_code.processor.__wrapped__()
    assert kind[:2] == (own[0], named)
    assert kind != own
    # LLVM compiles for a processor that it does not know, and does not end the process
    assert object_code._compiled("define i64 @one() {\n ret i64 1\n}", kind)
