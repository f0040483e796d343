"""The report of a selection on features of stick-slip."""

import numpy as np
import pytest

from stickslip import Coulomb, Measurement, Stribeck, TowedBlock, Viscous, select, simulate
from stickslip.identify.kinds.features import cycles_of
from stickslip.identify.kinds.report import verdict_page
from stickslip.identify.problems.limit_cycles import WATCHED
from stickslip.show.report import render
from stickslip.show.report.blocks import Origin

LAW = Coulomb(kinetic_coefficient=0.28, static_coefficient=0.32)
REAL = TowedBlock(mass=0.021, stiffness=1000.0, speed=4e-3, load=0.3)

ORIGIN = Origin(title="Slider", data="made up")


@pytest.fixture(scope="module")
def verdict():
    t = np.arange(0.5, 4.5, 5e-4)
    run = simulate(REAL, LAW, t_end=4.5).at(t)
    record = Measurement(time=t, spring_force=1000.0 * (4e-3 * t - run["x"]))
    stated = TowedBlock(mass=0.03, stiffness=1000.0, speed=4e-3, load=0.3)
    return select(stated, [Coulomb, Stribeck], record, vary=["friction.*", "mechanism.mass"])


@pytest.fixture(scope="module")
def page(verdict):
    origin = Origin(
        title="Slider", data="made up", commands=("stickslip select slider.toml",), digest="abc"
    )
    return render(verdict_page(verdict, origin))


@pytest.mark.slow
def test_sections_stand_in_the_order_in_which_a_reader_decides(verdict):
    document = verdict_page(verdict, ORIGIN)
    wanted = ["verdict", "runs", "models", "parameters", "open", "record", "reproduce"]
    assert [section.id for section in document.sections] == wanted


def test_the_page_says_the_verdict_and_how_to_get_it_again(verdict, page):
    assert "these features cannot rule out" in page
    assert "The effective mass is" in page
    assert "stickslip select slider.toml" in page
    assert "abc" in page
    assert "give both records as trials" in page


@pytest.mark.slow
def test_a_law_that_cannot_be_fitted_stands_on_the_page_with_the_reason(verdict):
    found = select(
        verdict.mechanism, [Coulomb, Viscous], verdict.measurement, vary=["friction.*", "mass"]
    )
    page = render(verdict_page(found, ORIGIN))
    assert "no friction level that these features could determine" in page


def test_a_page_on_a_law_that_misses_the_features_settles_nothing_of_it(verdict):
    held = {"mass": 0.03, "stiffness": 1000.0}
    found = select(verdict.mechanism, [Coulomb], verdict.measurement, fixed=held)
    opening = verdict_page(found, ORIGIN).sections[0]
    (block,) = opening.blocks
    assert "No law compared explains these features" in block.verdict
    assert not any("mu" in line for line in block.settles)


def test_the_page_runs_no_script_and_loads_nothing(page):
    assert "<script" not in page
    assert 'src="http' not in page


def test_cycles_lie_beside_the_limit_cycle_in_its_nearest_phase(verdict):
    fit = verdict.best.fit
    _, time, measured, predicted = cycles_of(fit)
    frequency = fit.problem.first.features.frequency
    assert np.ptp(time) == pytest.approx(WATCHED / frequency, rel=0.02)
    left = float(np.std(predicted[fit.law.title] - measured))
    # one of 64 phases is at most 0.05 rad off, and 0.3 % of frequency are 0.15 rad in 8 cycles
    assert left < 0.2 * float(np.std(measured))
