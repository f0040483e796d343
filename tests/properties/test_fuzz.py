"""Random cases of every mechanism with every law, over many decades, held against what must hold.

``make fuzz`` runs the many and says what became of each; ``tests/properties/fuzzing`` draws them.
"""

import pytest
from tests.properties.fuzzing.campaign import Campaign
from tests.properties.fuzzing.reports import reproducer
from tests.properties.fuzzing.workers import outcomes

from stickslip import EventDriven

SEED = 5
FEW = Campaign(seed=SEED, solver=EventDriven(max_steps=400, tier="python"))
MANY = Campaign(seed=1, solver=EventDriven(max_steps=1000, tier="python"))
SEVERAL = Campaign(
    seed=2, solver=EventDriven(max_steps=300, tier="compiled"), seconds=60.0, several=True, tiers=20
)
BATCHES, BATCH, QUICK = 20, 15, 2


def trouble(campaign, outcome):
    """Say what is wrong with a run, and how to run it again."""
    words = "\n".join(f"not a run that {name}: {what}" for name, what in outcome.violations)
    return f"{words}\n{reproducer(campaign.case(outcome.index), campaign.solver)}"


@pytest.mark.parametrize(
    "batch", [pytest.param(i, marks=[pytest.mark.slow] * (i >= QUICK)) for i in range(BATCHES)]
)
def test_a_random_case_is_solved_or_says_why_not(batch):
    for index in range(batch * BATCH, (batch + 1) * BATCH):
        outcome = FEW.outcome(index)
        assert not outcome.violations, trouble(FEW, outcome)


@pytest.mark.parametrize(
    "batch", [pytest.param(i, marks=[pytest.mark.slow] * (i >= QUICK)) for i in range(2 * QUICK)]
)
def test_a_random_case_with_one_to_six_contacts_is_solved_or_says_why_not(batch):
    for index in range(batch * 10, (batch + 1) * 10):
        outcome = SEVERAL.outcome(index)
        assert not outcome.violations, trouble(SEVERAL, outcome)


def test_the_cases_of_a_seed_are_the_same_each_time():
    assert [FEW.case(i) for i in range(20)] == [FEW.case(i) for i in range(20)]


def test_cases_of_few_structures_share_their_equations():
    campaign = Campaign(seed=SEED, structures=3, solver=FEW.solver)
    assert [campaign.order(7)] == [[0, 3, 6, 1, 4, 2, 5]]
    kinds = {(type(case.mechanism), type(case.law)) for case in map(campaign.case, range(9))}
    assert len(kinds) <= 3


@pytest.mark.slow
def test_twenty_thousand_random_cases_are_solved_or_say_why_not():
    wrong = [one for one in outcomes(MANY, MANY.order(20_000)) if one.violations]
    assert not wrong, "\n\n".join(trouble(MANY, one) for one in wrong[:5])
