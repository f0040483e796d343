"""Names and texts of files reach terminals and pages as text, of bounded length."""

import json
import os
import re
import signal
import subprocess
import sys
import unicodedata
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.commands import commands

from stickslip import load_rig
from stickslip.data.rigs import rig_builder
from stickslip.errors import InputError
from stickslip.friction import LAWS
from stickslip.show.formatting import printable
from stickslip.show.plots import standalone_svg

RED, BACKWARDS, NUL, C1 = "\x1b[31m", "\u202e", "\x00", "\x9b31m"
HOSTILE = f"evil{RED}{BACKWARDS}{C1}\x07\x7f\u2028name"
RIG = """
title = {title}
[mechanism]
type = "spring-block"
mass = 1.0
stiffness = 100.0
compression = 0.1
[friction]
kinetic_coefficient = 0.25
"""
STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\u2028\u2029]")


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run a command in an empty folder; return exit code, stdout and stderr as they are."""
    monkeypatch.chdir(tmp_path)
    return commands(capsys)


def is_clean(*texts):
    return not any(STEERING.search(text) for text in texts)


def test_what_steers_a_terminal_is_escaped_and_all_else_is_kept():
    ours = "158 ± 4 N s/m, 2.5 × 10⁻⁷\N{NO-BREAK SPACE}m, µ → λ, 摩擦, \N{INVISIBLE TIMES}"
    assert printable(ours) == ours
    assert printable(f"{RED}{NUL}{BACKWARDS}\n\t") == r"\u001b[31m\u0000\u202e\n\t"
    assert printable("a\n\tb", lines=True) == "a\n\tb"
    assert printable("\udcff") == r"\udcff"  # a byte of a file name that is not UTF-8


def test_no_control_character_of_unicode_gets_through():
    every = "".join(map(chr, range(sys.maxunicode + 1)))
    left = {unicodedata.category(character) for character in printable(every)}
    assert not left & {"Cc", "Cs", "Zl", "Zp"}
    turned = [c for c in printable(every) if unicodedata.bidirectional(c) in BIDI]
    assert turned == []


BIDI = {"LRE", "RLE", "PDF", "LRO", "RLO", "LRI", "RLI", "FSI", "PDI"}


def test_a_title_cannot_steer_the_terminal(run):
    Path("rig.toml").write_text(RIG.format(title=json.dumps(HOSTILE)))
    code, out, err = run("simulate", "rig.toml", "--law", "coulomb")
    assert (code, is_clean(out, err)) == (0, True)
    assert r"evil\u001b[31m\u202e" in out
    code, out, err = run("simulate", "rig.toml", "--law", "coulomb", "--json")
    assert (code, is_clean(out, err)) == (0, True)
    assert json.loads(out)["rig"] == load_rig("rig.toml").title


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("kinetic_coefficient", json.dumps(HOSTILE)),
        ("mass", json.dumps(HOSTILE)),
        ("[friction]", f"[friction.{json.dumps(HOSTILE)}]"),
        ('"spring-block"', json.dumps(HOSTILE)),
    ],
)
def test_unknown_keys_and_laws_are_named_as_text(run, old, new):
    Path("rig.toml").write_text(RIG.format(title='"T"').replace(old, new))
    code, out, err = run("simulate", "rig.toml")
    assert (code, out, is_clean(err), err.count("\n")) == (2, "", True, 1)


@pytest.mark.parametrize("column", [HOSTILE, f"a\n{RED}b"])
def test_a_column_cannot_steer_the_terminal(run, column):
    header = '"' + column.replace(NUL, "") + '"'
    Path("record.csv").write_text(f"time,{header}\n0,0\n1,1\n")
    for arguments in (
        ["check", "record.csv"],
        ["fit", "demo", "--data", "record.csv", "--law", "coulomb"],
    ):
        code, out, err = run(*arguments)
        assert (code, is_clean(out, err)) == (2, True), (out, err)


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such names")
@pytest.mark.parametrize("name", [f"{RED}{BACKWARDS}rig\n.toml", "\udcffrig.toml"])
def test_a_path_cannot_steer_the_terminal(run, name):
    code, _, err = run("simulate", name)
    assert (code, is_clean(err), err.count("\n")) == (2, True, 1)
    Path(name).write_text(RIG.format(title='""'))
    code, out, err = run("simulate", name, "--law", "coulomb", "-o", f"{name}.csv")
    assert (code, is_clean(out, err)) == (0, True), (out, err)


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Windows has no such names")
def test_a_name_that_is_no_text_can_be_printed_in_any_locale(tmp_path):
    """What no encoding can write would end in a traceback on the way out."""
    for locale in ("C.UTF-8", "C"):
        done = subprocess.run(
            [sys.executable, "-m", "stickslip", "check", b"\xff\x1b[31m.csv"],
            cwd=tmp_path,
            env={**os.environ, "LC_ALL": locale, "PYTHONUTF8": "0"},
            capture_output=True,
            check=False,
        )
        assert (done.returncode, b"Traceback" in done.stderr) == (2, False), done.stderr
        assert b"\x1b" not in done.stderr


LONG = "a" * 400_000
DOTTED = ".".join(["a"] * 200_000)


@pytest.mark.parametrize(
    "text",
    [
        f"{LONG} = 1\n" + RIG,
        RIG + f"{LONG} = 1\n",
        RIG + f"[friction.{LONG}]\nx = 1\n",
        RIG + f"[[trial]]\ntravel = 0.2\nset = {{ {LONG} = 1 }}\n",
        RIG + f"[[trial]]\ntravel = 0.2\nset = {{ {DOTTED} = 1 }}\n",
        RIG + f"[[trial]]\ntravel = 0.2\nset.{DOTTED} = 1\n",
        RIG + f"{DOTTED} = 1\n",
        RIG + f"[{DOTTED}]\nx = 1\n",
        RIG + "'a' . " * 50_000 + "a = 1\n",
        RIG + '"a\\"" . ' * 50_000 + "a = 1\n",
        RIG + "[[trial]]\ntravel = 0.2\nset = " + "{a.b.c.d.e.f.g.h = " * 60 + "1" + "}" * 60,
        RIG + "x = " + "[" * 5000 + "]" * 5000,
        RIG + "".join(f"k{i} = 1\n" for i in range(20_000)),
        RIG.replace('"spring-block"', f'"{LONG}"'),
        RIG.replace("mass = 1.0", f'mass = "{"1" * 400_000} kg"'),
        RIG + f'[data]\nfile = "{LONG}"\n',
        RIG + f'[data]\nfile = "rig.toml"\ncolumns = {{ time = "{LONG}" }}\n',
    ],
    ids=lambda text: re.sub(r"(.)\1{9,}", r"\1..", text)[-40:],
)
def test_hostile_tables_end_in_one_short_message_in_no_time(run, text):
    Path("rig.toml").write_text(text.replace("{title}", '"T"'))
    code, out, err = run("simulate", "rig.toml")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert len(err) < 5000


def test_the_fields_of_a_law_are_listed_once_however_many_keys_a_table_has(tmp_path, monkeypatch):
    listed = []
    fields = rig_builder._fields
    monkeypatch.setattr(rig_builder, "_fields", lambda kind: listed.append(kind) or fields(kind))
    (tmp_path / "rig.toml").write_text(
        RIG.replace("{title}", '"T"') + "".join(f"k{i} = 1\n" for i in range(50))
    )
    with pytest.raises(InputError, match="unknown key"):
        load_rig(tmp_path / "rig.toml")
    assert len(listed) <= 2 * len(LAWS)  # known laws, and those that may be asked for


def test_an_override_of_many_steps_is_refused():
    with pytest.raises(InputError, match="must be a dotted path"):
        load_rig(None, overrides={"a." * 100_000 + "b": 1})


def test_a_figure_with_hostile_labels_is_valid_xml():
    def draw(figure, narrow):
        figure.add_subplot().plot([0, 1], label="a")
        figure.axes[0].set_gid(HOSTILE.replace(NUL, ""))

    text = standalone_svg(draw, title=HOSTILE)
    assert is_clean(text)
    ElementTree.fromstring(text)


PIPES = {
    "select rig.p": "not a regular file",
    "simulate rig.toml --law law.p.toml": "not a regular file",
    "export rig.p --to c -o new": "not a regular file",
    "demo -o made --force": "was not written by stickslip",
}


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes by name")
@pytest.mark.parametrize("line", PIPES)
def test_no_command_waits_for_a_pipe_that_nobody_writes(run, line):
    Path("rig.toml").write_text(RIG.format(title='"rig"'))
    Path("made").mkdir()
    for name in ("rig.p", "law.p.toml", "sheet.csv", "made/.stickslip"):
        os.mkfifo(name)

    def wake(*_):
        raise TimeoutError(line)

    before = signal.signal(signal.SIGALRM, wake)
    signal.alarm(60)  # which what works never sees
    try:
        code, _, err = run(*line.split())
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
    assert (code, PIPES[line] in err) == (2, True), err


@pytest.mark.parametrize("key", ["{}", "mechanism.{}"])
def test_a_setting_whose_name_is_no_text_is_refused(run, key):
    Path("rig.toml").write_text(RIG.format(title='"rig"'))
    setting = f"{key.format('x' + chr(0xDCFF))}=1"
    code, _, err = run("simulate", "rig.toml", "--law", "coulomb", "--set", setting)
    assert (code, r"x\udcff" in err, "dotted path" in err) == (2, True, True), err


def test_a_rig_file_for_a_file_whose_name_is_not_utf8_is_refused_with_the_cure(run):
    name = f"a{chr(0xDCFF)}.csv"
    rows = "".join(f"{t / 100},{np.sin(t / 10)}\n" for t in range(200))
    try:
        Path(name).write_text(f"time [s],position [mm]\n{rows}")
    except OSError:
        pytest.skip("names of files are UTF-8")
    code, _, err = run("init", name)
    assert (code, "rename the file" in err, Path(name).with_suffix(".toml").exists()) == (
        2,
        True,
        False,
    ), err
