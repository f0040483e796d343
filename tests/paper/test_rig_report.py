"""The report of a rig: the paper's sections for its own rig alone, steps that fit the run."""

import re

import pytest
from tests.support import sketched

from stickslip import load_rig, select
from stickslip.identify.kinds.report import verdict_page
from stickslip.paper import beside
from stickslip.show.report import render
from stickslip.show.report.blocks import Origin

TEXT = """
title = "Thrown"
[run]
t_end = 2.0
[mechanism]
type = "spring-block"
mass = {mass}
stiffness = 100.0
compression = {compression}
[friction]
kinetic_coefficient = 0.25
[[trial]]
travel = {travel}
uncertainty = 0.01
initial = {{ v = "{v} m/s" }}
"""


def report(rig, laws=("coulomb",)):
    verdict = select(
        rig.mechanism, {n: rig.laws[n] for n in laws}, rig.measurement, t_end=rig.t_end
    )
    return page_of(rig, verdict), verdict


def page_of(rig, verdict):
    remark, lead, extra = beside(rig, verdict)
    origin = Origin(title=rig.title, data=rig.subject)
    return render(verdict_page(verdict, origin, remark=remark, lead=lead, extra=extra))


@pytest.fixture(autouse=True, scope="module")
def figures_are_not_laid_out():
    """Leave out what makes text of a drawing, which other tests have of the same sections."""
    with sketched():
        yield


def ids(page):
    return re.findall(r'<section[^>]* id="([^"]+)"', page)


@pytest.mark.slow
def test_the_bundled_rig_is_reported_beside_its_paper():
    page, _ = report(load_rig())
    assert {"excitation", "table2", "equations", "misprints"} <= set(ids(page))


def test_a_changed_rig_is_not_mixed_with_the_rig_of_the_paper():
    page, _ = report(load_rig(overrides={"mechanism.mass": "2"}))
    assert "verdict" in ids(page)
    assert "excitation" not in ids(page)
    assert "Table II" not in page


def test_another_measurement_on_the_bundled_rig_is_not_mixed_with_the_paper():
    rig = load_rig()
    other = load_rig(overrides={"mechanism.mass": "2"}).measurement
    verdict = select(rig.mechanism, {"coulomb": rig.laws["coulomb"]}, other, t_end=rig.t_end)
    assert "excitation" not in ids(page_of(rig, verdict))


@pytest.mark.parametrize(("v", "compression", "travel"), [(3, 0.1, 1.8), (0, -0.1, -0.2)])
def test_a_rig_that_is_thrown_or_shot_backwards_has_a_report(tmp_path, v, compression, travel):
    path = tmp_path / "rig.toml"
    path.write_text(TEXT.format(mass=1.0, v=v, compression=compression, travel=travel))
    page, verdict = report(load_rig(path))
    assert page.startswith("<!doctype html>")
    assert verdict.best is not None
    assert {"verdict", "models"} <= {*ids(page)}
