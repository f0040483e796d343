"""The README is pasted by newcomers: what it shows must be what happens."""

import contextlib
import io
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tests.support import for_all, module_at, sketched

from stickslip import load_rig
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
(CHAIN,) = (text for kind, text in BLOCKS if kind == "sh" and text.startswith("stickslip "))


@pytest.fixture(autouse=True)
def figures_are_not_laid_out() -> Iterator[None]:
    with sketched():
        yield


def words(text: str) -> list[list[str]]:
    """Lines as words: widths of columns depend on the terminal."""
    return [line.split() for line in text.splitlines() if line.strip()]


def test_the_first_screen_has_a_line_to_install_to_see_a_verdict_and_to_test() -> None:
    screen = README.splitlines()[:24]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for command in ("pip install -c constraints.txt -e .", "stickslip demo", "stickslip doctor"):
        assert any(line.startswith(f"{command} ") for line in screen)
    for target in ("select", "test"):
        assert any(line.startswith(f"make {target} ") for line in screen)
        assert re.search(rf"^{target}: \$\((RUN|DEV)\)", makefile, re.MULTILINE)
    (report,) = re.findall(r"the report goes to (\S+)/", makefile)
    assert f"{report}/index.html" in "\n".join(screen)


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
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    for arguments, shown in session:
        with pytest.raises(SystemExit) as left:
            main(shlex.split(arguments))
        assert not left.value.code
        printed = capsys.readouterr().out
        assert words(printed)[: len(words(shown))] == words(shown)
    (estimates,) = re.findall(r"^The estimates are .*$", README, re.MULTILINE)
    for number in re.findall(r"\d+\.\d+", estimates):
        assert number in printed


@pytest.mark.slow
def test_the_chain_leads_from_three_travels_to_the_page_of_a_cart(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    for line in CHAIN.splitlines():
        with pytest.raises(SystemExit) as left:
            main(shlex.split(line.removeprefix("stickslip ")))
        assert not left.value.code, line
    assert load_rig("stickslip-report/law.toml").estimates.covariance_of
    moves = r"moves (\S+) mm per cycle once the motion has settled, and roughly (\S+) to (\S+) mm"
    said = re.search(moves, README)
    assert said is not None
    printed = capsys.readouterr().out
    row = re.findall(r"cycle \d+ +(\S+) +(\S+) to (\S+) +mm", printed)[-1]
    # the interval's ends move by 2 % with the rounding of a processor, the cart by ten times that
    ends = [float(one) for one in row[1:]]
    assert ends == pytest.approx([float(said[2]), float(said[3])], rel=0.3)
    assert printed.count(f"Travel per cycle, once the motion has settled: {said[1]} mm; mean") == 2
    for folder in ("stickslip-report", "stickslip-run"):
        page = (tmp_path / folder / "index.html").read_text(encoding="utf-8")
        assert "This section could not be produced" not in page
    assert f"The cart moves {said[1]}" in page.replace("\N{NO-BREAK SPACE}", " ")


def test_what_the_demonstration_says_is_quoted() -> None:
    quoted = re.search(r'`stickslip demo -o demo-report` says "(.*?)"', " ".join(README.split()))
    assert quoted is not None
    said = (ROOT / "tests" / "golden" / "paper" / "select.txt").read_text(encoding="utf-8")
    assert quoted[1] in " ".join(said.split())


def test_the_record_is_the_one_that_the_script_of_the_figures_makes() -> None:
    made = module_at(ROOT / "docs/make_figures.py")
    expected = made.record()
    stored = pd.read_csv(made.RECORD)
    assert list(stored) == list(expected)
    # rounded to 0.001; the last digit may differ on other processors
    np.testing.assert_allclose(stored, expected, rtol=0, atol=1.5e-3)


@for_all(sorted(set(LINK.findall(README))))
def test_a_link_of_the_readme_leads_to_a_file(target: str) -> None:
    assert (ROOT / target).is_file()
