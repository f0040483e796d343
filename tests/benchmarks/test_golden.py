"""Golden files: what is compared, what is left out of it, and what a failure does."""

import json
import re
from dataclasses import replace

import pytest
from benchmarks import golden
from benchmarks.golden_cases import PYTHON, Case, Command
from hypothesis import given
from hypothesis import strategies as st
from tests.support import examples

VERDICT = {
    "stickslip": "0.1.0",
    "best": "coulomb",
    "candidates": [{"law": "coulomb", "score": 0.123456789, "held_out": [1.0, 2.0, 3.0]}],
}
TEXT = "Held-out error: 0.60 mm\nUse Coulomb friction.\nstderr:\nmu_s was given."
FILES = {"select.txt": TEXT, "verdict.json": golden.json_text(json.dumps(VERDICT))}
SCRIPT = """
import json, os, sys, time
from pathlib import Path
Path("page.html").write_text(f"<h1>Run</h1><p>Written on {time.strftime('%Y-%m-%d')}.</p>")
Path("run.csv").write_text("t,x\\n" + "".join(f"{k},{k / 7}\\n" for k in range(500)))
Path("law.toml").write_text("mu_k = 0.25484199796151420\\n")
print(json.dumps({"version": sys.version.split()[0], "folder": os.getcwd(), "mu_k": 1 / 3}))
print("Searching ...", file=sys.stderr)
print("mu_s was given.", file=sys.stderr)
"""


def edited(name, old, new):
    assert FILES[name].count(old) == 1
    return {**FILES, name: FILES[name].replace(old, new)}


def own(name, script, *codes):
    """Return a case whose only command is a script."""

    def prepare(folder):
        (folder / "script.py").write_text(script)

    command = Command(name="script", line=(PYTHON, "script.py"), codes=codes or (0,))
    return Case(name=name, seconds=1, prepare=prepare, commands=(command,))


def test_a_digit_that_changed_is_found_with_its_place_and_size():
    found = golden.compare(FILES, edited("verdict.json", "0.123456789", "0.123456780"))
    assert found.lines == 1
    # 9e-9 of 0.123456789, up to rounding of two numbers of 9 digits
    assert found.largest == pytest.approx(9e-9 / 0.123456789, rel=1e-6)
    assert found.where == "verdict.json: candidates[0].score"
    assert any(line.startswith("-") and "0.123456789" in line for line in found.diff)


def test_a_tolerance_is_for_numbers_only():
    digit = edited("verdict.json", "0.123456789", "0.123456780")
    assert str(golden.compare(FILES, digit, rtol=1e-6)) == "equal"
    assert golden.compare(FILES, digit, rtol=1e-9).lines == 1
    word = edited("select.txt", "Use Coulomb", "Use Dahl")
    assert golden.compare(FILES, word, rtol=1e3).lines == 1
    # a line that came does not hide one with a number
    more = {**digit, "select.txt": "New.\n" + TEXT}
    assert golden.compare(FILES, more, rtol=1e-6).lines == 1


@examples(100)
@given(st.floats(allow_nan=False, allow_infinity=False), st.integers(0, 10**20))
def test_real_numbers_are_no_noise(x, n):
    for text in (f"mu_k = {x!r}, {n} rows.", f"{x:.3g} to {x:.6f}", f"{n:,}", f"[{x!r}]"):
        if len(f"{abs(x):.0f}") < 40:  # as many digits as a hash has; nobody prints those
            assert golden.plain(text, {"/tmp/golden-1": "<folder>"}) == text


def test_versions_hashes_dates_and_folders_are_noise():
    said = f"stickslip 0.1.0, numpy 2.4.6rc1 {'0a' * 32} 2025-11-21T12:38:17+00:00 /tmp/g-1/a.csv"
    assert golden.plain(said, {"/tmp/g-1": "<folder>"}) == (
        "stickslip <version>, numpy <version> <hash> <date> <folder>/a.csv"
    )


def test_what_a_command_prints_and_writes_is_kept_without_noise():
    found = golden.run(own("made-up", SCRIPT))
    assert not found.failure
    assert sorted(found.files) == ["law.toml", "page.txt", "run.csv", "script.json", "script.txt"]
    told = json.loads(found.files["script.json"])
    assert told == {"version": "<version>", "folder": "<folder>", "mu_k": 0.333333333}
    assert found.files["page.txt"] == "# Run\nWritten on <date>."
    assert found.files["law.toml"].strip() == "mu_k = 0.254841998"
    assert found.files["script.txt"].splitlines() == [
        "$ python script.py", "exit code 0", "stderr:", "mu_s was given.",
    ]  # fmt: skip
    assert golden.run(own("made-up", SCRIPT)).files == found.files


def test_a_case_that_fails_does_not_stop_the_others(tmp_path, monkeypatch, capsys):
    cases = own("broken", "raise SystemExit('no such law')"), own("sound", SCRIPT)
    monkeypatch.setattr(golden, "CASES", cases)
    assert golden.main(["record", str(tmp_path), "--jobs", "2"]) == 1
    assert "no such law" in capsys.readouterr().out
    assert [path.name for path in tmp_path.iterdir()] == ["sound"]
    assert golden.main(["compare", str(tmp_path)]) == 1
    *_, broken, sound, _ = capsys.readouterr().out.splitlines()
    assert re.fullmatch(r"broken +failed: .*exit code 1 / no such law", broken)
    assert re.fullmatch(r"sound +equal", sound)


def test_the_exit_code_says_whether_anything_differs(tmp_path, monkeypatch, capsys):
    case = own("made-up", SCRIPT)
    monkeypatch.setattr(golden, "CASES", (case,))
    here = str(tmp_path)
    assert golden.main(["compare", here]) == 1
    assert "no golden files" in capsys.readouterr().out
    assert golden.main(["record", here]) == 0
    assert golden.main(["compare", here]) == 0
    other = replace(case, prepare=own("", SCRIPT.replace("1 / 3", "1 / 4")).prepare)
    monkeypatch.setattr(golden, "CASES", (other,))
    capsys.readouterr()
    assert golden.main(["compare", here, "--keep", str(tmp_path / "new")]) == 1
    told = capsys.readouterr().out
    assert '+ "mu_k": 0.25' in told
    assert "1 line differs; numbers by up to 0.25 (script.json: mu_k)" in told
    # what was kept is what a record of the new code would be
    assert golden.main(["compare", str(tmp_path / "new")]) == 0
    with pytest.raises(SystemExit, match="there are made-up"):
        golden.main(["compare", here, "--only", "made"])
