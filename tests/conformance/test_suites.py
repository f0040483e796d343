"""The suites that other packages run on their laws and mechanisms hold for ours."""

import pytest
from tests.support import EXAMPLES, SEVERAL, SHOWN, example_of, quick

from stickslip import Coulomb
from stickslip.friction import LAWS
from stickslip.study.testing import check_friction, check_mechanism

CHECKED = ("block-chain", "disc-brake", "two-feet")
"""Friction between bodies, on a turning body, and under an uneven load."""


@pytest.mark.parametrize("kind", LAWS.values(), ids=lambda kind: kind.name)
def test_every_law_passes_the_suite_for_laws(kind):
    report = check_friction(example_of(kind), compiled=False)
    assert report.ok, report


@pytest.mark.parametrize("name", quick(SHOWN, *EXAMPLES))
def test_every_mechanism_passes_the_suite_for_mechanisms(name):
    report = check_mechanism(SHOWN[name], t_end=0.8, compiled=False)
    assert report.ok, report


@pytest.mark.parametrize("draws", [2, pytest.param(5, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", quick(SEVERAL, *CHECKED))
def test_mechanisms_with_several_contacts_pass_the_suite_too(name, draws):
    law = Coulomb(kinetic_coefficient=0.3, static_coefficient=0.4)
    report = check_mechanism(SEVERAL[name], law, compiled=False, draws=draws)
    assert report.ok, report
    assert "contacts name coordinates" in report.checks


@pytest.mark.slow
@pytest.mark.parametrize("name", SHOWN)
def test_every_mechanism_is_the_same_in_both_tiers(name):
    report = check_mechanism(SHOWN[name], t_end=0.8)
    assert report.ok, report
