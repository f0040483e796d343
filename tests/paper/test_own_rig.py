"""The questions of the paper, asked of another rig."""

import json
import re

import pytest
from tests.support import sketched

from stickslip import load_rig
from stickslip.errors import InputError
from stickslip.identify.kinds import select_travels
from stickslip.paper import PaperValues, audit, paper_report
from stickslip.paper.rigs import adopted, viscous_fit
from stickslip.paper.sections.equations import assumption_section

TEXT = """
title = "Own block"
[mechanism]
type = "spring-block"
mass = 0.82
stiffness = 145.0
compression = 0.06
{more}
[[trial]]
travel = {travel}
uncertainty = 0.001
set = {{ compression = {compression} }}
"""
M, K, G = 0.82, 145.0, 9.81


def rig_of(folder, travel, more="", compression=0.08):
    path = folder / "own.toml"
    path.write_text(TEXT.format(travel=travel, more=more, compression=compression))
    return load_rig(path)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    # the travel of mu_k = 0.3 by (11), at the compression of the trial
    travel = 0.5 * K * 0.08**2 / (0.3 * M * G)
    with pytest.MonkeyPatch.context() as patch:
        # coarse steps: nothing here looks at what printed forms do, only that they stay finite
        patch.setattr("stickslip.paper.printed.FINE_STEP", 5e-3)
        patch.setattr("stickslip.paper.printed.BRISTLE_STEP", 5e-4)
        return audit(rig_of(tmp_path_factory.mktemp("rig"), round(travel, 6)))


@pytest.mark.slow
def test_levels_that_the_file_does_not_give_are_fitted_to_the_travel(found):
    assert found.own
    assert found.values.rig.compression == 0.08
    # the travel was rounded to 1e-6 m of .19 m
    assert found.values.mu_k == pytest.approx(0.3, rel=1e-5)
    assert {row.published.travel for row in found.table} == {None}


def test_the_push_of_the_paper_is_made_with_the_force_of_the_own_spring(found):
    force, f = K * 0.08, found.values.mu_k * M * G
    push = found.table[0].reading("A")
    assert push.criteria.travel == pytest.approx((force - f) * 0.01 * force / (2.0 * M * f))


def test_the_page_of_another_rig_says_nothing_of_printed_values(found):
    with sketched():
        page = paper_report(found)
    text = " ".join(re.sub(r"<[^>]+>", " ", page).replace("\N{NO-BREAK SPACE}", " ").split())
    assert "Own block" in text
    assert "0.193 m" in text  # measured, the first trial
    for printed in ("published", "Published", "beside ours", "0.20 m", " 1 kg", " 10 N "):
        assert printed not in text.replace("--published", "")
    assert "not at hand: the numbers" not in page
    json.dumps(found.to_dict(), allow_nan=False)


@pytest.mark.slow
def test_levels_of_the_file_stay_and_a_fastened_block_may_turn_back(tmp_path):
    more = "attached = true\n[friction]\nkinetic_coefficient = 0.1\nstatic_coefficient = 0.15"
    found = audit(rig_of(tmp_path, 0.05, more))
    assert (found.values.mu_k, found.values.mu_s) == (0.1, 0.15)
    assert found.values.own_reading == "C"
    # the spring pulls it back harder than friction holds: 11.6 N against 1.2 N
    assert found.ranking("C") == {}
    with sketched():
        assert "reject every model" in paper_report(found)


@pytest.mark.slow
def test_assumed_bristles_are_not_said_to_stand_in_the_file(tmp_path):
    more = "[friction]\nkinetic_coefficient = 0.3\nstatic_coefficient = 0.35"
    section = assumption_section(audit(rig_of(tmp_path, 0.19, more)))
    origins = {row.cells[0]: row.cells[2] for row in section.blocks[1].rows}
    assert origins["models, Coulomb"] == "rig file"
    assert origins["models, Dahl"] == (
        "kinetic coefficient of the rig file, the rest as for the rig of the paper"
    )


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("incline = 0.1", "neither an incline nor stops"),
        ('drive = { type = "pulse", level = 10.0, duration = 0.1 }', "as the only drive"),
        ("upper_stop = 0.5", "neither an incline nor stops"),
    ],
)
def test_a_rig_of_another_form_is_refused_before_anything_is_run(tmp_path, more, message):
    with pytest.raises(InputError, match=message):
        audit(rig_of(tmp_path, 0.19, more))


THREE = """
title = "Own block"
[mechanism]
type = "spring-block"
mass = 0.82
stiffness = 145.0
compression = 0.06
""" + "".join(
    f"[[trial]]\ntravel = {travel}\nuncertainty = 0.001\nset = {{ compression = {way} }}\n"
    for travel, way in ((0.108, 0.06), (0.191, 0.08), (0.299, 0.10))
)


@pytest.mark.slow
def test_a_viscous_part_that_the_travels_bound_is_not_assumed(tmp_path):
    (tmp_path / "own.toml").write_text(THREE)
    rig = load_rig(tmp_path / "own.toml")
    verdict = select_travels(rig.mechanism, rig.laws, rig.measurement, t_end=rig.t_end)
    (viscous,) = [e for e in viscous_fit(verdict) if e.path.endswith("viscous_coefficient")]
    # .3 of the weight takes some 2.4 N: .5 N s/m at half a metre per second would show in 1 mm
    assert 0.0 <= viscous.low < viscous.high < 0.2
    rigs = adopted(rig, verdict)
    assert PaperValues.of(rigs).viscous == viscous.value < 0.2
    assert rigs.laws["coulomb-viscous-static"].viscous_coefficient == viscous.value
