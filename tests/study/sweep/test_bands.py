"""Shares of the spread of a band: closed form, and no share where there is none."""

import dataclasses

import pytest

from stickslip import Coulomb, EventDriven, PendulumCart, SpringBlock
from stickslip.data import LawEstimates
from stickslip.errors import InputError, SimulationError
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import Rotation
from stickslip.show.report.runs import explained
from stickslip.study.sweep import band_of

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)


def band(count=1000, known=None, seed=0, **uncertain):
    return band_of(
        RIG, LAW, known, t_end=2.0, parameter_uncertainties=uncertain, count=count, seed=seed
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_shares_are_those_of_the_closed_form(seed):
    # k x0^2 / (2 mu m g): relative deviations of 1, 2 and 4 %, squared, over their sum
    pytest.importorskip("SALib")
    own = band(stiffness=1.0, mass=0.02, compression=0.002, seed=seed).shares()
    assert own.method == "rbd-fast"
    first, half = own.indices["first"], own.half_widths["first"]
    for found, wide, true in zip(first, half, (1 / 21, 4 / 21, 16 / 21), strict=True):
        # a tenth more than the interval, since one of nine may well leave a 95 % interval
        assert abs(found - true) < 1.5 * wide + 0.01
    assert max(half) < 0.12


def test_a_parameter_without_effect_has_no_share():
    pytest.importorskip("SALib")
    known = LawEstimates(law="coulomb", intervals={"static_coefficient": (0.28, 0.32)})
    law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.3)
    own = band_of(
        RIG, law, known, t_end=2.0, parameter_uncertainties={"mass": 0.02}, count=1000
    ).shares()
    # the block is already moving, and never sticks before it rests
    share = dict(zip(own.factors, own.indices["first"], strict=True))
    assert abs(share["friction.static_coefficient"]) < 0.03
    assert share["mechanism.mass"] > 0.95


def test_parameters_that_were_drawn_with_a_correlation_have_none():
    pytest.importorskip("SALib")
    known = LawEstimates(
        law="coulomb",
        intervals={"kinetic_coefficient": (0.24, 0.26), "static_coefficient": (0.28, 0.32)},
        covariance_of=("kinetic_coefficient", "static_coefficient"),
        covariance=((2.5e-5, 4.5e-5), (4.5e-5, 1e-4)),
    )
    law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.3)
    own = band_of(RIG, law, known, t_end=2.0, count=400)
    with pytest.raises(InputError, match="the spread has no share of each alone"):
        own.shares()
    (said,) = explained(own)
    assert "is not said" in said.text


@pytest.mark.parametrize("seed", range(5))
def test_a_known_correlation_is_heeded_however_few_runs_show_it(seed):
    known = LawEstimates(
        law="coulomb",
        intervals={"kinetic_coefficient": (0.24, 0.26), "static_coefficient": (0.38, 0.42)},
        covariance_of=("kinetic_coefficient", "static_coefficient"),
        covariance=((2.5e-5, -1e-5), (-1e-5, 1e-4)),
    )
    law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.4)
    own = band_of(RIG, law, known, t_end=2.0, count=100, seed=seed)
    with pytest.raises(InputError, match=r"correlated \(by −0.2\)"):
        own.shares()


def test_runs_that_lasted_do_not_stand_for_those_that_did_not():
    own = dataclasses.replace(
        band(mass=0.02, compression=0.002), ended_early=3, reasons=("3 of 1000 stopped: why.",)
    )
    with pytest.raises(InputError, match=r"3 of 1000 stopped: why\. The runs that lasted"):
        own.shares()
    assert "3 of 1000 stopped: why." in str(own)


def test_a_band_says_why_runs_stopped():
    # a rotor that lifts the body off where its arm is longer than 20.2 mm
    turning = Prescribed(profile=Rotation(rate=54.0))
    body = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.02, pendulum=turning)
    settings = {"t_end": 0.8, "count": 12, "solver": EventDriven(tier="python")}
    law = Coulomb(kinetic_coefficient=0.2)
    own = band_of(body, law, None, parameter_uncertainties={"length": 1e-3}, **settings)
    assert 0 < own.ended_early < 12
    (sentence,) = own.reasons
    assert sentence.startswith(f"At {own.ended_early} of 12 draws the run stopped: Lift-off")
    assert own.to_dict()["reasons"] == [sentence]
    longer = dataclasses.replace(body, length=0.03)
    with pytest.raises(SimulationError, match="At 12 of 12 draws the run stopped: Lift-off"):
        band_of(longer, law, None, parameter_uncertainties={"length": 1e-4}, **settings)


def test_few_runs_have_no_shares():
    with pytest.raises(InputError, match="need 100 runs, got 50"):
        band(count=50, mass=0.02, compression=0.002).shares()


@pytest.mark.slow
def test_the_page_says_which_parameter_to_measure_better():
    pytest.importorskip("SALib")
    table, caption = explained(band(mass=0.02, compression=0.002))
    assert [row.cells[0] for row in table.rows] == ["mass", "compression"]
    assert float(table.rows[1].cells[1].split(" ")[0]) > 0.7
    assert "measure the compression first" in caption.text
    _, open_ = explained(band(mass=0.02, stiffness=2.0, count=100))
    assert "100 runs do not settle" in open_.text
    assert explained(band(mass=0.02)) == []
