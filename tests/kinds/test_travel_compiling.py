"""What is compiled before laws are fitted."""

import pytest

from stickslip import Coulomb, Dahl, LuGre, Measurement, SpringBlock
from stickslip.identification import starting_law
from stickslip.identification.travel_model import trials_of
from stickslip.kinds.travels import fit as travels_fit

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
ONE = Measurement(travel=0.2, uncertainty=0.01)
SEVERAL = Measurement(
    trials=[
        Measurement(travel=0.2, uncertainty=0.01),
        Measurement(travel=0.07, uncertainty=0.01, overrides={"mechanism.compression": 0.06}),
    ]
)
LAWS = [starting_law(law) for law in (Coulomb, Dahl, LuGre)]


@pytest.fixture
def asked(monkeypatch):
    """Compile nothing; return what was asked for."""
    seen = []
    monkeypatch.setattr(travels_fit, "prepare", lambda rig, law: seen.append(law.name))
    return seen


def test_laws_with_bristles_are_compiled_if_there_are_several_trials(asked):
    travels_fit.compile_for(trials_of(RIG, SEVERAL, 10.0), LAWS)
    assert set(asked) == {"dahl", "lugre"}


def test_a_single_trial_is_not_worth_compiling(asked):
    travels_fit.compile_for(trials_of(RIG, ONE, 10.0), LAWS)
    assert asked == []
