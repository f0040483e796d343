"""The compiled tier: the same text by LLVM, and so the same bits."""

import numpy as np
import pytest
from tests.contact_cases import Arm, coulomb

from stickslip import Axis, Coulomb, Dahl, EventDriven, SpringBlock, Stribeck, TowedBlock, simulate
from stickslip.engine.formulation import formulate
from stickslip.engine.solver import run
from stickslip.engine.solver.run import prepare, work_of
from stickslip.errors import ParameterError
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse, Sine

PYTHON, COMPILED = EventDriven(tier="python"), EventDriven(tier="compiled")
# one case for each stepper and each kind of drive; more would cost seconds of compiling apiece
CASES = {
    "released spring, layer": (
        SpringBlock(mass=1.0, stiffness=100.0, compression=0.1),
        Stribeck(kinetic_coefficient=0.25, static_coefficient=0.35, stribeck_velocity=0.01),
        1.0,
    ),
    "pieces and a sine, bristles": (
        Axis(
            inertia=1.0,
            drive=Pulse(level=2.0, duration=0.3)
            + Sine(amplitude=0.5, frequency=2.0)
            + PiecewiseLinear(times=(0.0, 0.5, 1.0), values=(0.0, 1.0, -1.0)),
        ),
        Dahl(kinetic_coefficient=0.5, bristle_stiffness=1e3, static_switch=True),
        1.5,
    ),
    "bounces, then pressed": (
        Axis(
            inertia=1.0,
            drive=Sine(amplitude=3.0, frequency=0.5),
            lower_stop=0.0,
            upper_stop=0.1,
            restitution=0.5,
        ),
        Stribeck(
            kinetic_coefficient=0.5,
            static_coefficient=0.7,
            stribeck_velocity=0.1,
            break_away_coefficient=0.8,
        ),
        3.0,
    ),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_both_tiers_give_the_same_bits(case):
    rig, law, t_end = case
    plain = simulate(rig, law, t_end=t_end, solver=PYTHON)
    fast = simulate(rig, law, t_end=t_end, solver=COMPILED)
    np.testing.assert_array_equal(fast.t, plain.t)
    for name in plain.names:
        np.testing.assert_array_equal(fast[name], plain[name])
    assert fast.events == plain.events
    assert fast.certificate == plain.certificate
    assert fast.status is plain.status


def test_a_prepared_model_runs_compiled_from_then_on_whatever_its_parameters():
    rig, law = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1), Coulomb(kinetic_coefficient=0.2)
    model = formulate(rig, law)
    prepare(rig, law)
    other = formulate(TowedBlock(mass=3.0, stiffness=1.0, speed=0.2), law)
    assert work_of(model).is_enough()
    assert work_of(other).is_enough()


def test_an_unknown_tier_is_refused():
    with pytest.raises(ParameterError, match="'auto', 'python' or 'compiled', got 'fast'"):
        EventDriven(tier="fast")


@pytest.mark.parametrize(
    ("rig", "law", "y0"),
    [(*CASES["pieces and a sine, bristles"][:2], {}), (Arm(), coulomb(0.2, 0.3), {"elbow": 0.8})],
    ids=["one contact", "two contacts"],
)
def test_a_run_that_goes_on_compiled_keeps_its_bits(monkeypatch, rig, law, y0):
    asked = iter([False, False, True])
    monkeypatch.setattr(run.Work, "is_enough", lambda work, own=None: next(asked))
    monkeypatch.setattr(run, "STRETCH", 9)
    begun = simulate(rig, law, t_end=1.5, y0=y0, throw=False)
    plain = simulate(rig, law, t_end=1.5, y0=y0, throw=False, solver=PYTHON)
    assert next(asked, None) is None  # it went on
    assert begun.certificate == plain.certificate
    assert begun.events == plain.events
    np.testing.assert_array_equal(begun.t, plain.t)
    for name in plain.names:
        np.testing.assert_array_equal(begun[name], plain[name])
