"""A verdict from Python is written as the command writes it."""

import json
import re
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
import pytest

import stickslip
from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    CoulombViscous,
    Measurement,
    SpringBlock,
    load_rig,
    select,
    simulate,
    write_report,
)
from stickslip.cli import main
from stickslip.errors import InputError
from stickslip.friction import SetValuedLaw
from stickslip.identify.kinds import drawn_laws, write_verdict
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import Square
from stickslip.quantities import Quantity

SPEED = np.concatenate([np.linspace(-1.0, -0.01, 60), np.linspace(0.01, 1.0, 60)])
FRICTION = 2.0 * np.sign(SPEED) + 0.5 * SPEED
FRICTION += 0.02 * np.random.default_rng(0).normal(size=SPEED.size)
TABLE = Measurement(velocity=SPEED, friction=FRICTION, load=4.0)
FILES = ["draws.json", "index.html", "law.toml", "verdict.json"]
pytestmark = pytest.mark.usefixtures("sketches")


@pytest.fixture(scope="module")
def verdict():
    return select(Axis(inertia=1.0), [Coulomb, CoulombViscous], TABLE)


def names(folder):
    return sorted(path.name for path in folder.glob("[!.]*"))


def test_page_document_and_law_say_what_the_verdict_says(verdict, tmp_path):
    page = write_report(verdict, tmp_path / "new" / "report", title="Slide", subject="made up")
    folder = tmp_path / "new" / "report"
    assert page == folder / "index.html"
    assert names(folder) == FILES
    text = page.read_text(encoding="utf-8")
    assert "<title>Friction model selection: Slide<" in text
    assert "made up" in text
    content = json.loads((folder / "verdict.json").read_text(encoding="utf-8"))
    assert content["schema"] == "stickslip/select/1"
    assert content["stickslip"] == stickslip.__version__
    assert content["verdict"] == verdict.sentence
    assert content["best"] == verdict.best.name == "coulomb-viscous"
    rig = load_rig(folder / "law.toml")
    assert rig.laws["coulomb-viscous"] == verdict.best.fit.law
    assert rig.mechanism.load == 4.0


def test_without_a_title_page_and_document_are_named_after_the_mechanism(verdict, tmp_path):
    page = write_report(verdict, tmp_path / "report")
    assert "<title>Friction model selection: Axis<" in page.read_text(encoding="utf-8")
    content = json.loads(page.with_name("verdict.json").read_text(encoding="utf-8"))
    assert content["rig"] == "Axis"
    block = SpringBlock(mass=1.0)
    assert block.title == stickslip.Rig(mechanism=block).heading == "Spring block"
    assert stickslip.Rig(mechanism=block, title="Slide").heading == "Slide"


@pytest.mark.slow
def test_the_command_writes_the_same_files_but_for_its_own_name_and_hash(verdict, tmp_path):
    lines = [f"{v!r},{f!r}" for v, f in zip(SPEED.tolist(), FRICTION.tolist(), strict=True)]
    data = tmp_path / "table.csv"
    data.write_text("\n".join(["v [m/s],F [N]", *lines]) + "\n", encoding="utf-8")
    rig = tmp_path / "rig.toml"
    rig.write_text(
        'title = "Slide"\n[mechanism]\ntype = "axis"\ninertia = "1 kg"\nload = "4 N"\n'
        '[data]\nfile = "table.csv"\ncolumns = { velocity = "v [m/s]", friction = "F [N]" }\n',
        encoding="utf-8",
    )
    with pytest.raises(SystemExit) as leaving:
        main(["select", str(rig), "--laws", "coulomb,coulomb-viscous", "-o", str(tmp_path / "cli")])
    assert not leaving.value.code
    seen = load_rig(rig)
    own = select(seen.mechanism, ["coulomb", "coulomb-viscous"], seen.measurement)
    write_report(own, tmp_path / "python", title="Slide")
    assert names(tmp_path / "cli") == names(tmp_path / "python") == FILES
    pages = [(tmp_path / side / "index.html").read_text("utf-8") for side in ("cli", "python")]
    heads = [re.findall(r"<title>.*?</title>|<section[^>]*>|<h2.*?</h2>", page) for page in pages]
    assert heads[0] == heads[1]
    law = [(tmp_path / side / "law.toml").read_text("utf-8") for side in ("cli", "python")]
    assert law[0] == law[1]
    both = [
        json.loads((tmp_path / side / "verdict.json").read_text("utf-8"))
        for side in ("cli", "python")
    ]
    assert both[0].pop("digest")
    assert both[1].pop("digest") == ""
    assert both[0] == both[1]


def test_an_earlier_report_is_only_replaced_if_that_is_asked_for(verdict, tmp_path):
    write_report(verdict, tmp_path, title="First")
    with pytest.raises(InputError, match=r"index\.html already exists: give overwrite=True"):
        write_report(verdict, tmp_path, title="Second")
    assert "First" in (tmp_path / "index.html").read_text(encoding="utf-8")
    write_report(verdict, tmp_path, title="Second", overwrite=True)
    assert "First" not in (tmp_path / "index.html").read_text(encoding="utf-8")


def test_a_verdict_without_a_law_leaves_none_of_an_earlier_one(verdict, tmp_path):
    write_report(verdict, tmp_path)
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    # travels that fall where the spring is pressed farther: no law explains them
    trials = [
        Measurement(travel=s, uncertainty=1e-4, overrides={"mechanism.compression": x})
        for x, s in ((0.06, 0.2), (0.08, 0.15), (0.1, 0.1))
    ]
    nothing = select(block, [Coulomb], Measurement(trials=trials), t_end=2.0)
    assert nothing.best is None
    write_report(nothing, tmp_path, overwrite=True)
    assert names(tmp_path) == ["index.html", "verdict.json"]


def test_only_verdicts_are_reported(tmp_path):
    with pytest.raises(InputError, match="a report is of a verdict of `select`, got dict"):
        write_report({}, tmp_path / "none")
    assert not (tmp_path / "none").exists()


@pytest.mark.slow
def test_travels_per_cycle_have_a_page(tmp_path):
    push = Torque(drive=Square(high=6.0, low=-1.0, period=0.4, duty=0.3))
    capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, stiffness=80.0, damping=0.8, drive=push)
    law = Coulomb(kinetic_coefficient=0.18)
    way = float(simulate(capsule, law, t_end=2.0).at(2.0)["x"][0])
    reading = Measurement(travel_per_cycle=way / 5.0, uncertainty=5e-4)
    verdict = select(capsule, ["coulomb"], reading, t_end=2.0)
    page = write_report(verdict, tmp_path, title="Capsule").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>")


@dataclass(frozen=True, kw_only=True)
class Own(SetValuedLaw):
    """A level, as somebody may write it."""

    name: ClassVar[str] = "own"
    title: ClassVar[str] = "Own"
    formula: ClassVar[str] = r"F = \mu N"
    sources: ClassVar[tuple[str, ...]] = ()
    level: Annotated[float, Quantity("mu", low=0, scale="level", bounds=(0.0, 10.0), start=0.3)]

    def sliding(self, speed, load):
        return self.level * load + 0.0 * speed

    def break_away(self, load):
        return self.level * load


@pytest.mark.parametrize(("law", "kept"), [(Own, False), ("level + drag", True)])
def test_laws_are_drawn_for_runs_elsewhere_where_a_file_can_name_them(law, kept, tmp_path):
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    trials = [
        Measurement(travel=s, uncertainty=1e-3, overrides={"mechanism.compression": x})
        for x, s in ((0.08, 0.13), (0.1, 0.204))
    ]
    found = select(block, [law], Measurement(trials=trials), t_end=2.0)
    write_verdict(tmp_path, found, {})
    drawn = drawn_laws(tmp_path / "law.toml")
    assert (tmp_path / "draws.json").exists() == kept
    assert (drawn is not None) == kept
    if drawn is not None:
        assert drawn == (found.sample(100), 0.0)  # of travels that are no cycles of a drive
