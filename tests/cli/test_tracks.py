"""``stickslip check`` and ``stickslip fit`` on what a video gave."""

import json
import re

import numpy as np
import pytest
from tests.commands import commands

from stickslip import Axis, Coulomb, Measurement, load_rig, select
from stickslip.identify.kinds import write_verdict

MU = 0.21
SPEED = 1.4
TIME = np.arange(72) / 60


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run a command beside a coasting block that was filmed at 3 degrees, and its rig."""
    monkeypatch.chdir(tmp_path)
    slowing = MU * 9.81
    time = np.minimum(TIME, SPEED / slowing)
    way = SPEED * time - slowing * time**2 / 2
    noise = np.random.default_rng(1).normal(0.0, 3e-4, (2, way.size))
    tilt = np.radians(3.0)
    x, y = np.array([[np.cos(tilt)], [np.sin(tilt)]]) * way + noise
    rows = ["\t".join(f"{cell:.6E}" for cell in row) for row in zip(TIME, x, y, strict=True)]
    (tmp_path / "track.txt").write_text("\n".join(["mass_A", "t\tx\ty", *rows, ""]))
    twice = "\n".join(f"{row}\t{row.split(chr(9), 1)[1]}" for row in rows)
    (tmp_path / "two.txt").write_text("\tmass A\t\tmass B\nt\tx\ty\tx\ty\n" + twice)
    (tmp_path / "block.toml").write_text('[mechanism]\ntype = "spring-block"\nmass = 0.82\n')
    return commands(capsys, one_line=True)


def test_check_says_how_the_motion_lies_in_the_picture(run):
    code, out, _ = run("check", "track.txt", "--columns", "position=x,y", "--json")
    assert code == 0
    (line,) = [found for found in json.loads(out)["findings"] if found["kind"] == "line"]
    # Jitter over spread and root of n is 0.02 degrees.
    assert np.degrees(line["numbers"]["tilt"]) == pytest.approx(3.0, abs=0.08)


def test_of_two_tracks_the_option_is_told_that_names_one(run):
    code, _, err = run("check", "two.txt", "--columns", "position=x,y")
    assert code == 2
    assert 'Choose one, as --columns "position=mass A/x,mass A/y".' in err
    assert run("check", "two.txt", "--columns", "position=mass A/x,mass A/y")[0] == 0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("x,y", "--columns takes NAME=VALUE such as position=q_m, got 'x'"),
        ("time=t,q", "columns.time must be the name of one column, got ['t', 'q']"),
        ("position=x,y,t", "or two different names, for the two coordinates"),
        ("position=x,", "--columns takes NAME=VALUE such as position=q_m, got ''"),
        ("position=x=,y", "unknown column of track.txt: 'x='"),
    ],
)
def test_columns_that_cannot_be_meant_are_refused(run, given, message):
    code, _, err = run("check", "track.txt", "--columns", given)
    assert code == 2
    assert message in err


def test_the_friction_of_a_filmed_block_is_found(run):
    code, out, _ = run(
        *("fit", "block.toml", "--data", "track.txt", "--columns", "position=x,y", "--json"),
        *("--law", "coulomb", "-o", "law.toml"),
    )
    assert code == 0
    (mu,) = json.loads(out)["estimates"]
    assert mu["parameter"] == "friction.kinetic_coefficient"
    assert mu["value"] == pytest.approx(MU, rel=0.005)


FREQUENCIES = (3.0, 4.5, 6.0)


def with_values(text):
    """Return the text of a rig file with something in place of each question mark."""
    return text.replace("? g", "20 g").replace('"?"', '"inner mass"').replace("?", "2")


@pytest.fixture
def filmed(run, tmp_path):
    """Films of a body that moves to and fro and travels, named by the frequency of its drive."""
    time = np.arange(150) / 60
    random = np.random.default_rng(2)
    for number, frequency in enumerate(FREQUENCIES):
        phase = 2 * np.pi * frequency * time
        x = 20.0 + 4.0 * time - number * time + 0.8 * np.sin(phase) + 0.3 * np.sin(2 * phase)
        x += random.normal(0.0, 0.05, time.size)
        rows = [f"{t:.5f}\t{a:.4f}\t5.0" for t, a in zip(time, x, strict=True)]
        text = "\n".join(["capsule", "t\tx (mm)\ty (mm)", *rows, ""])
        (tmp_path / f"capsule_{frequency:g}Hz.txt").write_text(text)
    return run


def test_films_become_a_rig_file_with_a_question_mark_for_what_they_do_not_show(filmed, tmp_path):
    names = [f"capsule_{frequency:g}Hz.txt" for frequency in reversed(FREQUENCIES)]
    code, out, _ = filmed("init", *names, "--json")
    assert code == 0
    told = json.loads(out)
    assert [entry["frequency"] for entry in told["films"]] == [*FREQUENCIES]
    text = (tmp_path / "capsule.toml").read_text()
    assert text.count("[[trial]]") == 3
    assert 'file = "capsule_4.5Hz.txt"' in text
    code, _, err = filmed("check", "capsule.toml")
    assert code == 2
    assert "mechanism.capsule_mass = '? g', mechanism.inner_mass = '? g'" in err
    assert "mechanism.drive_on = '?'" in err  # with the other one the force would be wrong
    (tmp_path / "capsule.toml").write_text(with_values(text))
    assert filmed("check", "capsule.toml")[0] == 0


def test_films_of_a_capsule_with_a_hard_stop_need_but_the_signs_of_a_comment_removed(
    filmed, tmp_path
):
    assert filmed("init", *[f"capsule_{f:g}Hz.txt" for f in FREQUENCIES])[0] == 0
    path = tmp_path / "capsule.toml"
    text = re.sub(r"# (upper_stop|restitution) =", r"\1 =", path.read_text())
    soft, drive = text.index("[mechanism.upper_soft_stop]"), text.index("[mechanism.drive]")
    path.write_text(with_values(text[:soft] + text[drive:]))
    rig = load_rig(path)
    assert (rig.mechanism.upper_stop, rig.mechanism.restitution) == (0.002, 0.5)
    assert rig.mechanism.upper_soft_stop is None


def test_what_init_says_comes_next_leads_from_films_to_the_band_of_the_speed(filmed, tmp_path):
    code, out, _ = filmed("init", *[f"capsule_{frequency:g}Hz.txt" for frequency in FREQUENCIES])
    assert code == 0
    check, choose, sweep = " ".join(out.split()).partition("Next: ")[2].split("; ")
    assert choose == "stickslip select capsule.toml --route travel"
    text = (tmp_path / "capsule.toml").read_text()
    (tmp_path / "capsule.toml").write_text(with_values(text))
    assert filmed(*check.split()[1:])[0] == 0
    speed = np.linspace(0.02, 0.6, 8)
    noise = 0.01 * np.random.default_rng(1).normal(size=8)
    table = Measurement(velocity=speed, friction=0.5 + noise)
    verdict = select(Axis(inertia=1.0, load=2.0), [Coulomb], table)
    write_verdict(tmp_path / "capsule-report", verdict, {})
    short = sweep.replace(":45", ":3").replace("--ensemble 24", "--ensemble 2").split()[1:]
    code, out, err = filmed(*short, "--settle", "2", "--cycles", "2", "--json")
    assert code == 0, err
    told = json.loads(out)
    assert [at for at, _ in told["measured"]] == [*FREQUENCIES]
    assert told["values"] == pytest.approx([2.7, 3.0, 4.5, 4.65, 6.0, 6.6])


def test_a_file_that_is_no_film_is_refused_among_films(filmed, tmp_path):
    (tmp_path / "axis.csv").write_text("time,x,force\n0,1,2\n1,2,3\n2,3,4\n3,4,5\n")
    code, _, err = filmed("init", "capsule_3Hz.txt", "axis.csv")
    assert code == 2
    assert "axis.csv" in err
