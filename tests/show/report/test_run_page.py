"""The report of a run, for any mechanism and any end."""

import contextlib
import dataclasses
import math
import re

import numpy as np
import pytest
from tests.support import quick, sketched, wide_only

from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    Dahl,
    FixedStep,
    LuGre,
    Pendulum,
    PendulumCart,
    Rig,
    SpringBlock,
    Stribeck,
    TowedBlock,
    Viscous,
    load_rig,
    simulate,
)
from stickslip.data import LawEstimates
from stickslip.errors import SimulationError
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import Pulse, Sine, ThreePhase
from stickslip.show.report import blocks, runs
from stickslip.show.report.runs import RunReport, run_page
from stickslip.study.sweep import Spread, band_of

EVERY = "test_every_section_can_be_made_of"
WHOLE = f"{EVERY}[a cart on bristles]"
STROKE = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
SWING = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
COULOMB = Coulomb(kinetic_coefficient=0.2)
LUGRE = LuGre(
    kinetic_coefficient=0.2,
    static_coefficient=0.3,
    stribeck_velocity=0.01,
    bristle_stiffness=1e3,
    bristle_damping=10.0,
    static_switch=True,
)
STRIBECK = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.02)
CART = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=SWING))
BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
RUNS = {
    "a block that comes to rest": (BLOCK, COULOMB, 2.0),
    "a block that springs back": (BLOCK, Dahl(kinetic_coefficient=0.2, bristle_stiffness=1e3), 2.0),
    "a block that never moves": (
        SpringBlock(mass=1.0, drive=Pulse(level=0.1, duration=0.1)),
        COULOMB,
        1.0,
    ),
    "a towed block": (TowedBlock(mass=1.0, stiffness=20.0, speed=0.1), STRIBECK, 5.0),
    "an axis under a sine": (
        Axis(inertia=1.0, drive=Sine(amplitude=2.0, frequency=2.0)),
        Coulomb(kinetic_coefficient=1.0),
        6.0,
    ),
    "a pendulum": (Pendulum(mass=0.2, length=0.5), Coulomb(kinetic_coefficient=0.02), 2.0),
    "a capsule": (
        Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=STROKE)),
        COULOMB,
        1.0,
    ),
    "a cart on bristles": (CART, LUGRE, 1.0),
    "a cart that only rocks": (CART, Viscous(viscous_coefficient=4.0), 4.0),
}


QUICK = (
    "a block that springs back",
    "a towed block",
    "a cart on bristles",
    "a cart that only rocks",
)
"""With and without bristles, and with and without a cycle."""


@pytest.fixture(autouse=True)
def figures_are_drawn_where_a_page_of_each_kind_is_made(request):
    """Leave figures empty in the other tests; for phones one page is drawn."""
    name = request.node.name
    whole = "for_phones" in name or WHOLE in name
    with (
        contextlib.nullcontext() if whole else wide_only() if name.startswith(EVERY) else sketched()
    ):
        yield


def texts(html):
    """Return what a reader reads, tags and no-break spaces taken out."""
    body = re.sub(r"<(style|svg)\b.*?</\1>", "", html, flags=re.DOTALL)
    return " ".join(re.sub(r"<[^>]+>", " ", body).replace("\N{NO-BREAK SPACE}", " ").split())


def about(mechanism, law, t_end, **more):
    start = {"theta": 0.5} if isinstance(mechanism, Pendulum) else None
    run = simulate(mechanism, law, t_end=t_end, y0=start, throw=False)
    return RunReport(rig=Rig(title="Rig", mechanism=mechanism), law=law, run=run, **more)


@pytest.mark.slow
@pytest.mark.parametrize("case", quick(RUNS, *QUICK))
def test_every_section_can_be_made_of(case):
    html = run_page(about(*RUNS[case]))
    assert "could not be produced" not in html
    assert "<script" not in html
    said = texts(html)
    assert "nan" not in said.split()
    assert "The run is certified" in said


@pytest.mark.slow
@pytest.mark.parametrize("case", RUNS)
def test_every_section_can_be_made_for_phones_too(case):
    test_every_section_can_be_made_of(case)


def test_the_page_of_the_reference_cart_says_its_numbers():
    said = texts(run_page(about(CART, COULOMB, 5 * SWING.period)))
    assert "The cart moves 63.5 mm in a cycle of 0.724 s" in said
    assert "The cart advances 0.2787 m in 5 whole cycles" in said
    assert "24.86" in said  # the first cycle
    assert "does not hold: lowest velocity −6.1" in said
    assert "0.314 mm back-slip in the last cycle" in said


def test_an_axis_that_is_held_does_not_move_in_any_cycle():
    held = Axis(inertia=1.0, drive=Sine(amplitude=0.5, frequency=2.0))
    said = texts(run_page(about(held, Coulomb(kinetic_coefficient=1.0), 2.0)))
    assert "The axis does not move" in said
    assert "does not move in any cycle" in said
    assert "advances" not in said


def test_a_swing_from_rest_to_rest_is_a_motion():
    swing = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True)
    subject = about(swing, Coulomb(kinetic_coefficient=0.4, static_coefficient=0.9), 1.0)
    assert not np.any(subject.run["v"][[0, -1]])
    assert subject.moves


def test_rounding_of_the_ways_to_and_fro_is_no_travel():
    driven = Axis(inertia=3.0, drive=Sine(amplitude=10.0, frequency=2.0))
    law = dataclasses.replace(
        LUGRE, kinetic_coefficient=20.0, static_coefficient=28.0, static_switch=False,
        stribeck_velocity=0.03, bristle_stiffness=1e5, bristle_damping=300.0,
    )  # fmt: skip
    subject = about(driven, law, 2.0)
    last = subject.cycles[-1]
    assert 0.0 < abs(last.travel) < 1e-6 * last.back_slip
    assert last.advance == 0.0
    said = texts(run_page(subject))
    assert "The last cycle ends where it began" in said
    assert not re.search(r"10 −\d\d (?:m|mm|m/s)\b", said)


def test_a_range_has_the_unit_and_the_last_digit_of_the_number_beside_it():
    subject = about(BLOCK, COULOMB, 2.0)
    assert subject.range_beside(Spread(0.0982, 0.0999, 0.1017), 0.0999) == "98.2 to 101.7 mm"
    assert subject.range_beside(Spread(0.0, 0.0, 0.2), 0.0) == "0.00 to 0.20 m"


def test_of_very_many_cycles_some_are_shown_and_the_others_are_said_to_be_left_out():
    said = texts(run_page(about(CART, COULOMB, 30 * SWING.period)))
    assert "Of 30 cycles the first 8 are shown" in said
    assert "Cycles 7 to 26 of 30 are left out" in said


def test_a_run_in_fixed_steps_has_no_certificate():
    run = simulate(BLOCK, COULOMB, t_end=1.0, solver=FixedStep(dt=0.01))
    subject = RunReport(
        rig=Rig(title="Rig", mechanism=BLOCK), law=COULOMB, run=run, fixed_step=0.01
    )
    said = texts(run_page(subject))
    assert "Fixed steps have no certificate" in said
    assert "could not be produced" not in said


def test_a_measured_travel_is_compared_with():
    rig = load_rig()
    law = rig.laws["coulomb"]
    run = simulate(rig.mechanism, law, t_end=rig.t_end)
    said = texts(run_page(RunReport(rig=rig, law=law, run=run)))
    assert "1.94 % of the measured one" in said  # 0.2038736 m of 0.20 m


def test_what_was_not_fitted_and_what_was_drawn_is_said():
    known = LawEstimates(
        law="stribeck",
        intervals={"kinetic_coefficient": (0.18, 0.22)},
        not_identified={"stribeck_velocity": "the record does not show it"},
        not_fitted=("static_coefficient",),
    )
    band = band_of(BLOCK, STRIBECK, known, t_end=2.0, count=40)
    said = texts(run_page(about(BLOCK, STRIBECK, 2.0, estimates=known, band=band)))
    assert "not identified: the record does not show it" in said
    assert "given or assumed" in said
    assert "40 draws (seed 0) of kinetic coefficient" in said
    assert "Fixed: static coefficient, stribeck velocity" in said


def test_a_band_of_runs_of_which_none_lasts_says_why():
    # so fast a swing lifts the cart off, whatever its friction is
    fast = dataclasses.replace(SWING, slow=300.0)
    cart = dataclasses.replace(CART, pendulum=Prescribed(profile=fast))
    known = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.19, 0.21)})
    with pytest.raises(SimulationError, match="none of 20 runs"):
        band_of(cart, COULOMB, known, t_end=1.0, count=20)


def test_a_section_that_fails_is_one_line(monkeypatch):
    def motion_section(_):
        raise ZeroDivisionError("no motion")

    monkeypatch.setattr(blocks, "CAUGHT", (Exception,))
    monkeypatch.setattr(runs, "SECTIONS", (motion_section, *runs.SECTIONS[4:]))
    said = texts(run_page(about(BLOCK, COULOMB, 1.0)))
    assert "This section could not be produced. ZeroDivisionError: no motion." in said
    assert "The run is certified" in said


@pytest.mark.parametrize(
    ("law", "sticks"), [(Viscous(viscous_coefficient=0.5), False), (STRIBECK, True)]
)
def test_captions_speak_of_sticking_where_the_cart_sticks(law, sticks):
    run = simulate(CART, law, t_end=2.0)
    assert bool(run.stick_spans()) is sticks
    text = run_page(RunReport(rig=Rig(mechanism=CART), law=law, run=run))
    assert ("the cart sticks" in text, "where it sticks" in text) == (sticks, sticks)


@pytest.mark.parametrize(
    ("doubts", "drawn", "said"),
    [
        ({}, False, "the law has no intervals."),
        ({"mass": 0.01}, False, "`--ensemble 200` computes it from the uncertainties of the mech"),
        ({"mass": 0.01}, True, "The uncertainty of the motion that the law adds: it has no"),
    ],
)
def test_what_a_band_of_the_mechanism_alone_leaves_out_is_said(doubts, drawn, said):
    rig = Rig(mechanism=BLOCK, parameter_uncertainties=doubts)
    run, known = simulate(BLOCK, COULOMB, t_end=1.0), rig.parameter_uncertainties
    band = drawn and band_of(
        BLOCK, COULOMB, None, t_end=1.0, parameter_uncertainties=known, count=10
    )
    about = RunReport(rig=rig, law=COULOMB, run=run, band=band or None)
    (opening,) = runs.opening_section(about).blocks
    assert any(said in line for line in opening.cannot_tell)
