"""Folders and files that commands write are the old ones or the new ones, and never a user's."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from stickslip.errors import InputError
from stickslip.show import documents
from stickslip.show.documents import LIST, is_earlier, write_file, write_files, write_folder

OLD = {"index.html": "old", "verdict.json": "old", "law.toml": "old"}
NEW = {"index.html": "new", "verdict.json": "new"}
CHILD = """
import ctypes, os, pathlib, signal, sys
from stickslip.show import documents

folder, where, can_exchange = sys.argv[1:]
last = calls = 0

def deadly(real):
    def call(*arguments, **settings):
        global calls
        calls += 1
        number = calls
        if number == last and where == "before":
            os.kill(os.getpid(), signal.SIGKILL)
        try:
            return real(*arguments, **settings)
        finally:
            if number == last:
                os.kill(os.getpid(), signal.SIGKILL)
    return call

for name in ("replace", "rename", "unlink", "mkdir", "link", "open", "rmdir", "fsync"):
    setattr(os, name, deadly(getattr(os, name)))
def refused(*_):
    raise OSError("no such call")
documents._exchange = deadly(documents._exchange) if can_exchange == "True" else refused
new = {"index.html": "new", "verdict.json": "new"}
end = None
while end in (None, -signal.SIGKILL):  # each time one step farther, in a copy of this process
    last += 1
    if not (copy := os.fork()):
        documents.write_folder(
            pathlib.Path(folder.format(last)), new, stale=["law.toml", "index.html"]
        )
        os._exit(0)
    end = os.waitstatus_to_exitcode(os.waitpid(copy, 0)[1])
    print(end)
"""
MOST_STEPS = 60
"""More than any folder of these takes."""
linux = pytest.mark.skipif(sys.platform != "linux", reason="exchanges folders in one step")
OTHER_STARTS = (
    ("absent", "after"), ("old", "before"), ("old", "after"), ("old with a user's files", "before"),
)  # fmt: skip
posix = pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGKILL")


def seen(folder):
    """Return what stands in a folder, by name, but for the list of files."""
    return {
        path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8")
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != LIST and ".tmp-" not in path.name
    }


def killed(folders, where, can_exchange):
    """Write a folder for each step after which the process is killed; return how each one ended."""
    command = [sys.executable, "-c", CHILD, str(folders), where, str(can_exchange)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    ends = [int(end) for end in done.stdout.split()]
    assert ends == [-signal.SIGKILL] * (len(ends) - 1) + [0], done.stderr
    return range(1, len(ends))


@posix
@pytest.mark.parametrize(
    ("start", "where"),
    [
        ("absent", "before"),
        ("old with a user's files", "after"),
        *(pytest.param(*one, marks=pytest.mark.slow) for one in OTHER_STARTS),
    ],
)
@linux
def test_a_process_killed_at_any_step_leaves_the_old_folder_or_the_new_one(tmp_path, start, where):
    before, user, states = {}, {}, []
    for last in range(1, MOST_STEPS):
        folder = tmp_path / str(last) / "report"
        folder.parent.mkdir()
        if start != "absent":
            write_folder(folder, OLD)
            before = dict(OLD)
        if start == "old with a user's files":
            (folder / "mine" / "deep").mkdir(parents=True)
            (folder / "notes.txt").write_text("mine")
            (folder / "mine" / "deep" / "law.toml").write_text("mine")
            user = {"notes.txt": "mine", "mine/deep/law.toml": "mine"}
    for last in killed(tmp_path / "{}" / "report", where, can_exchange=True):
        folder = tmp_path / str(last) / "report"
        now = seen(folder) if folder.exists() else {}
        assert now in ({**before, **user}, {**NEW, **user})
        states.append(now == {**NEW, **user})
        write_folder(folder, NEW, stale=["law.toml"])  # and the next one goes through
        assert seen(folder) == {**NEW, **user}
    assert 3 < len(states) < MOST_STEPS - 1
    assert states == sorted(states)  # once new, it stays new
    assert not states[0]


@posix
@pytest.mark.parametrize("where", ["before", pytest.param("after", marks=pytest.mark.slow)])
def test_without_an_exchange_old_files_never_stand_beside_new_ones(tmp_path, where):
    for last in range(1, MOST_STEPS):
        folder = tmp_path / str(last)
        write_folder(folder, OLD)
        (folder / "notes.txt").write_text("mine")
    steps = killed(tmp_path / "{}", where, can_exchange=False)
    for last in steps:
        folder = tmp_path / str(last)
        now = seen(folder)
        assert now.pop("notes.txt") == "mine"
        assert now.items() <= OLD.items() or now.items() <= NEW.items()
        assert "index.html" in now
        write_folder(folder, NEW, stale=["law.toml"])  # what is left is known as ours
        assert seen(folder) == {**NEW, "notes.txt": "mine"}
    assert 5 < len(steps) + 1 < MOST_STEPS


@linux
def test_what_a_killed_process_left_is_removed_when_it_is_old(tmp_path, monkeypatch):
    left = tmp_path / ".report.tmp-0123abcd"
    left.mkdir()
    write_folder(tmp_path / "report", NEW)
    assert left.exists()  # another process may be at work
    monkeypatch.setattr(documents, "ABANDONED", -1.0)
    write_folder(tmp_path / "report", NEW)
    assert not left.exists()


@pytest.mark.parametrize("name", ["index.html", "law.toml", "verdict.json"])
def test_a_file_of_the_user_is_never_replaced(tmp_path, name):
    (tmp_path / name).write_text("mine")
    with pytest.raises(InputError, match=f"{name} was not written by stickslip.*move or delete it"):
        write_folder(tmp_path, OLD)
    assert seen(tmp_path) == {name: "mine"}


def test_a_file_that_the_user_has_edited_is_not_replaced(tmp_path):
    write_folder(tmp_path, OLD)
    (tmp_path / "law.toml").write_text("edited")
    with pytest.raises(InputError, match=r"law\.toml was changed since"):
        write_folder(tmp_path, OLD | {"index.html": "new"})
    assert seen(tmp_path) == OLD | {"law.toml": "edited"}
    write_folder(tmp_path, NEW, stale=["law.toml"])  # which does not need it: it stays
    assert seen(tmp_path) == NEW | {"law.toml": "edited"}


@posix
@pytest.mark.parametrize("can_exchange", [pytest.param(True, marks=linux), False])
def test_a_killed_process_leaves_a_folder_that_is_known_as_an_earlier_report(
    tmp_path, can_exchange
):
    for last in range(1, MOST_STEPS):
        write_folder(tmp_path / str(last), OLD)
    for last in killed(tmp_path / "{}", "before", can_exchange=can_exchange):
        folder = tmp_path / str(last)
        assert is_earlier(folder, {*OLD, *NEW})
        (folder / "notes.txt").write_text("mine")
        assert not is_earlier(folder, {*OLD, *NEW, "notes.txt"})


def test_what_a_user_made_of_a_report_is_no_earlier_report(tmp_path):
    assert not is_earlier(tmp_path, OLD)  # an empty folder may be meant for something
    write_folder(tmp_path, OLD)
    assert is_earlier(tmp_path, OLD)
    assert not is_earlier(tmp_path, {"index.html"})  # another command's report
    (tmp_path / "law.toml").write_text("edited")
    assert not is_earlier(tmp_path, OLD)
    (tmp_path / "law.toml").unlink()
    assert is_earlier(tmp_path, OLD)
    (tmp_path / ".index.html.tmp-0123abcd").symlink_to("elsewhere")
    assert not is_earlier(tmp_path, OLD)


def test_a_link_and_a_folder_of_the_user_are_never_replaced(tmp_path):
    write_folder(tmp_path / "report", OLD)
    (tmp_path / "kept").write_text("old")
    (tmp_path / "report" / "law.toml").unlink()
    (tmp_path / "report" / "law.toml").symlink_to(tmp_path / "kept")
    with pytest.raises(InputError, match=r"law\.toml"):
        write_folder(tmp_path / "report", OLD)
    (tmp_path / "report" / "law.toml").unlink()
    (tmp_path / "report" / "law.toml").mkdir()
    with pytest.raises(InputError, match=r"law\.toml"):
        write_folder(tmp_path / "report", OLD)


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"schema": 1}', '{"files": {"law.toml": 1}}'])
def test_a_list_that_is_not_ours_is_not_replaced(tmp_path, content):
    (tmp_path / LIST).write_text(content)
    with pytest.raises(InputError, match="was not written by stickslip"):
        write_folder(tmp_path, NEW)
    assert (tmp_path / LIST).read_text() == content


def test_a_list_cannot_name_files_elsewhere(tmp_path):
    write_folder(tmp_path / "report", NEW)
    (tmp_path / "mine").write_text("mine")
    path = tmp_path / "report" / LIST
    content = json.loads(path.read_text())
    content["files"] = {f"../{'mine'}": ["0"], **content["files"]}
    path.write_text(json.dumps(content))
    write_folder(tmp_path / "report", OLD, stale=["../mine"])
    assert (tmp_path / "mine").read_text() == "mine"


@linux
def test_links_modes_and_open_files_of_the_user_survive(tmp_path):
    folder = tmp_path / "report"
    write_folder(folder, OLD)
    folder.chmod(0o750)
    (folder / "link").symlink_to("nowhere")
    with (folder / "log").open("w") as log:
        log.write("one\n")
        log.flush()
        write_folder(folder, NEW, stale=["law.toml"])
        log.write("two\n")
    assert (folder / "log").read_text() == "one\ntwo\n"
    assert (folder / "link").readlink() == Path("nowhere")
    assert folder.stat().st_mode & 0o777 == 0o750


@linux
def test_a_file_that_appears_at_the_last_moment_survives(tmp_path, monkeypatch):
    folder = tmp_path / "report"
    write_folder(folder, OLD)
    exchange = documents._exchange

    def late(new, old):
        (old / "notes.txt").write_text("mine")
        exchange(new, old)

    monkeypatch.setattr(documents, "_exchange", late)
    write_folder(folder, NEW, stale=["law.toml"])
    assert seen(folder) == NEW | {"notes.txt": "mine"}


def test_the_working_directory_keeps_its_place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_folder(Path(), OLD)
    write_folder(Path(), NEW, stale=["law.toml"])
    (tmp_path / "inside").mkdir()
    assert Path("inside").is_dir()
    assert seen(Path()) == NEW


def test_a_link_to_a_folder_is_followed(tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "report").symlink_to(tmp_path / "real")
    write_folder(tmp_path / "report", OLD)
    write_folder(tmp_path / "report", NEW, stale=["law.toml"])
    assert (tmp_path / "report").is_symlink()
    assert seen(tmp_path / "real") == NEW


@posix
def test_files_have_the_modes_that_the_user_wants(tmp_path):
    old = os.umask(0o077)
    try:
        write_file(tmp_path / "a", "a")
        write_folder(tmp_path / "b", {"c": "c"})
    finally:
        os.umask(old)
    modes = [path.stat().st_mode & 0o777 for path in (tmp_path / "a", tmp_path / "b" / "c")]
    assert modes == [0o600, 0o600]


def test_files_that_belong_together_are_never_of_two_times(tmp_path, monkeypatch):
    table, figure = tmp_path / "a.csv", tmp_path / "a.svg"
    write_files({table: "old", figure: "old"})
    replace, states = os.replace, []

    def watched(*arguments):
        states.append(seen(tmp_path))
        replace(*arguments)
        states.append(seen(tmp_path))

    monkeypatch.setattr(os, "replace", watched)
    write_files({table: "new", figure: "new"})
    assert all(len(set(state.values())) == 1 for state in states)
    assert states[-1] == {"a.csv": "new", "a.svg": "new"}


def test_a_full_disk_changes_nothing(tmp_path, monkeypatch):
    write_folder(tmp_path / "report", OLD)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(InputError, match="cannot be written: No space left on device"):
        write_folder(tmp_path / "report", NEW)
    assert seen(tmp_path / "report") == OLD
    assert [path.name for path in tmp_path.iterdir()] == ["report"]
    assert len(list((tmp_path / "report").iterdir())) == 4
