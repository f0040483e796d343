"""What is asked of laws and mechanisms holds for ours."""

import pytest
from tests.conformance.engine_checks import same_in_both_tiers, sensitivities_hold
from tests.conformance.mechanism_checks import faults_of, slip_rates
from tests.support import EXAMPLES, SEVERAL, SHOWN, example_of, quick

from stickslip import Axis, Coulomb
from stickslip.friction import LAWS
from stickslip.mechanisms import given_inputs
from stickslip.study import check_law
from stickslip.study.testing import ORDINARY

CHECKED = ("block-chain", "disc-brake", "two-feet")
"""Friction between bodies, on a turning body, and under an uneven load."""


@pytest.mark.parametrize("kind", LAWS.values(), ids=lambda kind: kind.name)
def test_every_law_passes_the_suite_for_laws(kind):
    check_law(example_of(kind))


@pytest.mark.parametrize("name", quick(SHOWN, *EXAMPLES))
def test_every_mechanism_passes_the_suite_for_mechanisms(name):
    assert faults_of(SHOWN[name], t_end=0.8) == {}


@pytest.mark.parametrize("draws", [2, pytest.param(5, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", quick(SEVERAL, *CHECKED))
def test_mechanisms_with_several_contacts_pass_the_suite_too(name, draws):
    law = Coulomb(kinetic_coefficient=0.3, static_coefficient=0.4)
    assert faults_of(SEVERAL[name], law, draws=draws) == {}


@pytest.mark.parametrize("kind", LAWS.values(), ids=lambda kind: kind.name)
def test_sensitivities_to_every_parameter_of_a_law_are_those_of_differences(kind):
    law = example_of(kind)
    axis = Axis(inertia=1.0, stiffness=11.0, load=10.0)
    axis = given_inputs(axis, {name: ORDINARY[name] for name in law.inputs})
    assert [*sensitivities_hold(axis, law, law, {"v": 1.0}, 2.0)] == []


@pytest.mark.parametrize("name", quick({**SHOWN, **SEVERAL}, *EXAMPLES, *CHECKED))
def test_sensitivities_to_every_parameter_of_a_mechanism_are_those_of_differences(name):
    mechanism, law = {**SHOWN, **SEVERAL}[name], Coulomb(kinetic_coefficient=0.2)
    for start in ({}, dict.fromkeys(slip_rates(mechanism), 0.5)):
        assert [*sensitivities_hold(mechanism, law, mechanism, start, 0.8)] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", SHOWN)
def test_every_mechanism_is_the_same_in_both_tiers(name):
    mechanism, law = SHOWN[name], Coulomb(kinetic_coefficient=0.2)
    start = dict.fromkeys(slip_rates(mechanism), 0.5)
    assert [*same_in_both_tiers(mechanism, law, start, 0.8)] == []
