"""Random cases of every mechanism with every law, over many decades, held against what must hold.

``make fuzz`` runs the many and says what became of each; ``tests/properties/fuzzing`` draws them.
"""

from dataclasses import replace

import pytest
from benchmarks.several.brakes import DiscBrake, Lining
from tests.properties.fuzzing.campaign import Campaign
from tests.properties.fuzzing.cases import Case, run_case
from tests.properties.fuzzing.checks import Evidence, holds_no_more_than_break_away, keeps_its_books
from tests.properties.fuzzing.reports import reproducer

from stickslip import Coulomb, Dahl, EventDriven, Pendulum, Viscous
from stickslip.friction import Laws

SEED = 5
FEW = Campaign(seed=SEED, solver=EventDriven(max_steps=400, tier="python"))
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


@pytest.mark.parametrize("angle", [1e-9, 1e-3])
def test_energies_of_small_angles_may_differ_by_the_rounding_of_the_cosine_and_no_more(angle):
    swinging = Case(
        mechanism=Pendulum(mass=0.2, length=0.5),
        law=Viscous(viscous_coefficient=0.01),
        t_end=1.0,
        y0={"theta": angle},
    )
    run = run_case(swinging, FEW.solver)
    assert not list(keeps_its_books(Evidence(swinging, run, FEW.solver)))
    beyond = run.certificate.energy_start + 1e-14 * 0.2 * 9.81 * 0.5 + 1e-6 * angle**2
    wrong = replace(run, certificate=replace(run.certificate, energy_start=beyond))
    assert list(keeps_its_books(Evidence(swinging, wrong, FEW.solver)))


def test_bristles_that_another_pad_holds_bent_beyond_their_level_are_no_fault():
    pads = tuple(Lining(radius=0.1, load=load) for load in (100.0, 1.0))
    dahl = Dahl(kinetic_coefficient=0.5, bristle_stiffness=1e3)
    held = Case(
        mechanism=DiscBrake(inertia=1.0, pads=pads),
        law=Laws(members=(("pad-1", Coulomb(kinetic_coefficient=1.0)), ("pad-2", dahl))),
        t_end=1.0,
        y0={"z:pad-2": 1e-3},
    )
    run = run_case(held, FEW.solver)
    assert run.contact("pad-2")["friction"][-1] == pytest.approx(1.0)  # its level is 0.5 N
    views = Evidence(held, run, FEW.solver).each
    assert not [words for view in views for words in holds_no_more_than_break_away(view)]
    other = replace(dahl, bristle_stiffness=900.0)
    wrong = replace(held, law=Laws(members=(held.law.members[0], ("pad-2", other))))
    views = Evidence(wrong, run, FEW.solver).each
    assert [words for view in views for words in holds_no_more_than_break_away(view)]
