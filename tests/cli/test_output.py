"""Tables and commands as the command line writes them."""

import io
import os
import subprocess
import sys

import pytest
from rich.console import Console

from stickslip.cli import console as output
from stickslip.cli.console import show_table

ROW = ["friction.kinetic_coefficient", "mu_k", "3.859 × 10⁻⁶", "N s/m", "−0.00029 to 0.00026"]
HEADS = ["parameter", "", "value", "unit", "range (95 %)"]


def shown(monkeypatch, *, terminal, width):
    file = io.StringIO()
    console = Console(
        file=file, width=width, force_terminal=terminal, color_system=None, soft_wrap=True
    )
    monkeypatch.setattr(output, "stdout", lambda: console)
    show_table("", HEADS, [ROW], whole=HEADS[1:])
    return file.getvalue()


@pytest.mark.parametrize("width", [20, 40, 60, 80, 200])
@pytest.mark.parametrize("terminal", [True, False])
def test_no_number_is_ever_cut(monkeypatch, terminal, width):
    text = shown(monkeypatch, terminal=terminal, width=width)
    for cell in ROW[1:]:
        assert cell in text


def test_a_pipe_gets_whole_rows_however_wide_a_terminal_would_be(monkeypatch):
    lines = shown(monkeypatch, terminal=False, width=80).rstrip().splitlines()
    assert len(lines) == 2
    assert lines[1].split("  ")[0] == ROW[0]


def test_output_is_written_in_the_poorest_encoding(tmp_path):
    rows = [f"{k / 100},{k % 7 * 1e-6}" for k in range(100)]
    (tmp_path / "a.csv").write_text("\n".join(["time,position", *rows]) + "\n")
    command = [sys.executable, "-m", "stickslip", "check", str(tmp_path / "a.csv")]
    poorest = os.environ | {"PYTHONIOENCODING": "ascii"}
    done = subprocess.run(command, capture_output=True, env=poorest, check=False, timeout=120)
    assert b"Traceback" not in done.stderr
    assert b"100 samples" in done.stdout
