"""The page "My CSV in five commands" quotes messages that spoilt files bring about."""

import shutil
from pathlib import Path

import pandas as pd
import pytest

from stickslip.cli import main

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/howto/five-commands.md").read_text(encoding="utf-8")
FORCE = "force [N]"
SPOILT = {
    "its first line holds numbers, not names": lambda table: table.T.reset_index(drop=True).T,
    "no column seems to hold a position": lambda table: table.rename(
        columns={"position [mm]": "Kanal2", FORCE: "Kanal3"}
    ),
    "! The column 'pos' has no unit: m is assumed": lambda table: table.rename(
        columns={"position [mm]": "pos"}
    ),
    "a question mark for the motor constant": lambda table: table.rename(
        columns={FORCE: "current [A]"}
    ),
    "The file has no force": lambda table: table.drop(columns=FORCE),
    "friction would drive the motion: turn the sign": lambda table: table.assign(
        **{FORCE: -table[FORCE]}
    ),
}


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return pd.read_csv(ROOT / "docs/howto/files/axis.csv")


@pytest.mark.parametrize("message", SPOILT)
def test_a_spoilt_file_brings_about_the_message_that_the_page_quotes(
    message: str,
    table: pd.DataFrame,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "1000")
    assert message in PAGE
    named = message != "its first line holds numbers, not names"
    SPOILT[message](table).to_csv("axis.csv", index=False, header=named)
    for command in ("init axis.csv --force", "select axis.toml"):
        with pytest.raises(SystemExit):
            main(command.split())
        printed = "".join(capsys.readouterr())
        if message in printed:
            return
    raise AssertionError(f"nobody said {message!r}")


def test_what_exists_is_not_replaced(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "docs/howto/files/axis.csv", tmp_path)
    for _ in range(2):
        with pytest.raises(SystemExit):
            main(["init", "axis.csv"])
    assert "axis.toml already exists" in "".join(capsys.readouterr())
    assert "axis.toml already exists" in PAGE
