"""``stickslip characterize``: what users see of the battery."""

import json

import pytest

from stickslip.cli import main

LAW = """
[mechanism]
type = "axis"
inertia = "2 kg"
load = "20 N"
[friction.coulomb]
kinetic_coefficient = 0.25
static_coefficient = 0.35
"""


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Run a command in a folder with a law; return exit code, stdout and stderr."""
    (tmp_path / "law.toml").write_text(LAW)
    monkeypatch.chdir(tmp_path)

    def one(*arguments):
        with pytest.raises(SystemExit) as leaving:
            main(("characterize", *arguments))
        out, err = capsys.readouterr()
        # What goes into a file has no line that is filled up to the width of a terminal.
        assert not [line for line in out.splitlines() if line.endswith(" ")]
        return leaving.value.code, " ".join(out.split()), " ".join(err.split())

    return one


def test_laws_are_shown_by_test_and_written_as_a_page(run, tmp_path):
    code, out, _ = run(
        "coulomb", "dahl", "--tests", "steady,drift", "--load", "10N", "--report", "page.html"
    )
    assert code == 0
    assert "It does not drift" in out
    assert "It drifts:" in out
    assert "Kinetic coefficient as Coulomb." in out
    page = (tmp_path / "page.html").read_text()
    assert "Coulomb and Dahl" in page
    assert page.count("<svg") == 4  # two tests, each for wide and narrow screens
    again, _, err = run("coulomb", "--tests", "steady", "--report", "page.html")
    assert again == 2
    assert "--force" in err


def test_a_law_of_a_file_is_tested_on_its_rig(run):
    code, out, _ = run("law.toml", "--rig", "law.toml", "--tests", "break-away", "--json")
    found = json.loads(out)
    assert code == 0
    assert found["load"] == 20.0
    assert found["tests"]["break-away"]["force"] == pytest.approx([7.0] * 4, rel=1e-9)
    assert "2 kg" in found["tests"]["break-away"]["conditions"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("lugr",), "lugre"),
        (("coulomb", "--tests", "drfit"), "drift"),
        (("coulomb", "--load", "-3N"), "--load"),
        (("level + viscous * exponential[temperature]",), "--input temperature=VALUE"),
        (("coulomb", "--input", "temperature"), "NAME=VALUE"),
        (("coulomb", "--input", "temperature=20"), "no law here depends on 'temperature'"),
        (("coulomb", "--report", "page.pdf"), ".html"),
    ],
)
def test_what_cannot_be_used_is_one_message(run, arguments, said, tmp_path):
    code, out, err = run(*arguments)
    assert code == 2
    assert said in err
    assert "Traceback" not in out + err
    assert not (tmp_path / "page.pdf").exists()
