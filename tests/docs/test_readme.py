"""The README is pasted by newcomers: what it shows must be what happens."""

import contextlib
import io
import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.support import for_all, sketched

from stickslip.cli import main

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"\]\(([^)#]+)\)")

BLOCKS = BLOCK.findall(README)
EXAMPLES = [
    (text, BLOCKS[i + 1][1])
    for i, (kind, text) in enumerate(BLOCKS[:-1])
    if kind == "python" and BLOCKS[i + 1][0] == "text"
]
SESSIONS = [
    re.findall(r"^\$ stickslip (.*)\n((?:(?!\$ ).*\n)*)", text, re.MULTILINE)
    for kind, text in BLOCKS
    if kind == "console"
]


@pytest.fixture(autouse=True)
def figures_are_not_laid_out() -> Iterator[None]:
    with sketched():
        yield


def test_the_first_screen_leads_from_six_lines_of_csv_to_the_printed_verdict() -> None:
    screen = "\n".join(README.splitlines()[:36])
    assert "\npip install -c constraints.txt -e . " in screen
    (table,) = (text for kind, text in BLOCKS if kind == "csv")
    assert table == (ROOT / "docs/howto/files/friction.csv").read_text(encoding="utf-8")
    assert table in screen
    assert len(table.splitlines()) == 6
    assert re.search(r"^\$ stickslip select friction.toml\n(?:! .*\n\n)?Use ", screen, re.MULTILINE)
    assert "](docs/figures/report.svg)" in screen


def test_the_readme_names_the_targets_that_select_and_test() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in ("select", "test"):
        assert re.search(rf"^make {target} +#", README, re.MULTILINE)
        assert re.search(rf"^{target}: \$\((RUN|DEV)\)", makefile, re.MULTILINE)


def test_the_readme_has_examples_for_python_and_the_terminal() -> None:
    assert len(EXAMPLES) == sum(kind == "python" for kind, _ in BLOCKS) >= 1
    assert all(SESSIONS)
    assert SESSIONS


@pytest.mark.parametrize(("code", "shown"), EXAMPLES)
def test_a_python_example_prints_what_is_shown_below_it(
    code: str, shown: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, "README.md", "exec"), {})
    assert printed.getvalue() == shown


@pytest.mark.parametrize("session", SESSIONS)
def test_commands_print_the_lines_that_are_shown(
    session: list[tuple[str, str]],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "130")
    shutil.copy(ROOT / "docs/howto/files/friction.csv", tmp_path)
    for arguments, shown in session:
        with pytest.raises(SystemExit) as left:
            main(shlex.split(arguments))
        assert not left.value.code
        printed = capsys.readouterr().out
        assert printed.split()[: len(shown.split())] == shown.split()  # lines are as wide as a page


@pytest.mark.slow
def test_the_commands_work_in_their_order_in_an_empty_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    commands = []
    for kind, text in BLOCKS:
        if kind == "csv":
            Path("friction.csv").write_text(text, encoding="utf-8")
        if kind in ("sh", "console"):
            commands += re.findall(r"^(?:\$ )?stickslip (.*?)(?: +#.*)?$", text, re.MULTILINE)
    assert {"demo", "select friction.toml"} <= {*commands}
    for arguments in commands:
        with pytest.raises(SystemExit) as left:
            main(shlex.split(arguments))
        assert not left.value.code, arguments
    assert Path("demo-report/index.html").is_file()
    assert Path("friction-report/index.html").is_file()


@for_all(sorted(set(LINK.findall(README))))
def test_a_link_of_the_readme_leads_to_a_file(target: str) -> None:
    assert (ROOT / target).is_file()
