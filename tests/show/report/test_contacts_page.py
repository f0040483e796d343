"""The page of a run with several contacts."""

import re

import pytest
from tests.contact_cases import coulomb

from stickslip import BlockChain, EventDriven, TwoFeet, simulate
from stickslip.data import Rig
from stickslip.friction import Laws
from stickslip.show.report import RunReport, run_page

PLAIN = EventDriven(tier="python")


def page_of(mechanism, friction, t_end, y0):
    run = simulate(mechanism, friction, t_end=t_end, y0=y0, solver=PLAIN)
    rig = Rig(title="Rig", mechanism=mechanism)
    return run_page(RunReport(rig=rig, law=friction, run=run))


@pytest.fixture(scope="module")
def many():
    """A page of more contacts than have panels of their own."""
    chain = BlockChain(blocks=8, mass=1.0, coupling=4.0, stiffness=1.0)
    return page_of(chain, coulomb(0.3), 3.0, {"v1": 2.0})


def test_the_page_of_many_contacts_has_a_raster_and_every_section(many):
    assert "could not be produced" not in many
    assert "What each contact does" in many
    assert "All contacts share one law." in many
    assert "block-8" in many


def test_a_contact_at_which_nothing_rubs_is_named():
    laws = Laws(members=(("block-1", coulomb(0.3)),))
    chain = BlockChain(blocks=2, mass=1.0, coupling=4.0)
    page = page_of(chain, laws, 1.0, {"v1": 2.0})
    assert "Nothing rubs at block-2." in page
    assert "could not be produced" not in page


def test_a_run_without_events_is_not_said_to_rest():
    chain = BlockChain(blocks=2, mass=1.0, coupling=4.0)
    page = page_of(chain, coulomb(0.3), 0.1, {"v1": 2.0, "v2": 2.0})
    assert re.search(r"No event at 2.contacts in 0\.1.s", page)


def test_a_run_that_ends_early_says_so():
    body = TwoFeet(mass=2.0, front=0.1, rear=0.3, height=0.5)
    run = simulate(body, coulomb(0.8), t_end=1.0, y0={"v": 1.0}, solver=PLAIN, throw=False)
    rig = Rig(title="Rig", mechanism=body)
    page = run_page(RunReport(rig=rig, law=coulomb(0.8), run=run))
    assert "The run ends early" in page
