"""Fixed steps with several contacts: of axes without coupling, those of one axis."""

import numpy as np
import pytest
from tests.contact_cases import coulomb
from tests.pair_cases import LAW, LAWS, OTHER, PUSH, Pair, axis

from stickslip import EventDriven, FixedStep, TwoFeet, TwoLinkArm, simulate
from stickslip.errors import InputError
from stickslip.friction import PRINTED_FORMS
from stickslip.mechanisms.drives import Pulse
from stickslip.show import plots

PLAIN = EventDriven(tier="python")
ARM = TwoLinkArm(
    upper_mass=1.0, upper_length=0.4, upper_centre=0.2, upper_inertia=0.06,
    lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03,
)  # fmt: skip
JOINTS = {"shoulder": coulomb(0.3, 0.45), "elbow": coulomb(0.12, 0.2)}


@pytest.mark.parametrize("method", ["euler", "rk4"])
@pytest.mark.parametrize("rule", [True, False], ids=["stick rule", "none"])
def test_two_axes_move_as_each_does_alone(method, rule):
    solver = FixedStep(dt=2e-3, method=method, stick_rule=rule)
    start = {"t_end": 0.4, "solver": solver}
    both = simulate(
        Pair(stiffness=400.0, left_drive=PUSH), LAWS, y0={"a": 0.05, "b": 0.04}, **start
    )
    for q, name, law, drive in (("a", "left", LAW, PUSH), ("b", "right", OTHER, None)):
        x = 0.05 if q == "a" else 0.04
        alone = simulate(axis(drive, 400.0), law, y0={"x": x}, **start)
        # roundings of 200 steps, of which none may tip a decision
        np.testing.assert_allclose(both[q], alone["x"], rtol=0, atol=1e-14)
        np.testing.assert_array_equal(both[f"mode:{name}"], alone["mode"])
        np.testing.assert_allclose(both[f"friction:{name}"], alone["friction"], rtol=0, atol=1e-10)
        work = both.certificate.work[name]
        assert work == pytest.approx(alone.certificate.work_friction, rel=1e-9)


def test_smaller_steps_come_nearer_to_the_motion_of_an_arm():
    """The shoulder breaks away at once; whether the elbow does is decided with it."""
    y0 = {"shoulder": 1.2, "elbow": 0.8}
    exact = simulate(ARM, JOINTS, t_end=0.6, y0=y0, solver=PLAIN)
    errors = []
    for dt in (4e-3, 1e-3):
        run = simulate(ARM, JOINTS, t_end=0.6, y0=y0, solver=FixedStep(dt=dt, method="heun"))
        seen = exact.at(run.t)
        errors.append(max(np.abs(run[q] - seen[q]).max() for q in ("shoulder", "elbow")))
        assert not run.certificate.certified
    assert errors[1] < 0.5 * errors[0] < 5e-3
    assert run.contacts == ("shoulder", "elbow")
    assert len(plots.plot(run)) > 1


def test_feet_come_to_rest_where_the_closed_form_says_and_share_what_holds_them():
    """Closed form of reference R7: the loads are reactions that depend on friction."""
    body = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15, stiffness=50.0)
    laws = {"front": coulomb(0.6, 0.7), "rear": coulomb(0.2, 0.3)}
    run = simulate(body, laws, t_end=2.0, y0={"x": 0.9}, solver=FixedStep(dt=2e-3, method="heun"))
    last = {name: run[name][-1] for name in run.names}
    # a reversal is noticed up to a step late: 5 N / 2 kg over 2 ms is 5 mm/s, and 10 um
    assert last["x"] == pytest.approx(-0.07443116883117, abs=5e-5)
    assert last["mode:front"] == last["mode:rear"] == 0.0
    assert last["normal_force:front"] == pytest.approx(8.96446753246753, abs=2e-3)
    assert last["friction:front"] == pytest.approx(2.4655593, abs=2e-3)
    assert last["friction:rear"] == pytest.approx(1.2559991, abs=2e-3)


def test_printed_forms_take_one_contact():
    form = PRINTED_FORMS["printed-10"](kinetic_coefficient=0.2, viscous_coefficient=0.1)
    message = r"one contact.*has left, right: give CoulombViscous\(...\)"
    with pytest.raises(InputError, match=message):
        simulate(Pair(), form, t_end=0.1, solver=FixedStep(dt=1e-2))


@pytest.mark.parametrize(
    ("break_away", "front", "rear"), [("kinetic", 0.6, 0.2), ("static", 0.8, 0.3)]
)
def test_loads_react_to_the_friction_with_which_feet_break_away(break_away, front, rear):
    push = Pulse(level=30.0, duration=1.0)
    body = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15, drive=push)
    laws = {"front": coulomb(0.6, 0.8), "rear": coulomb(0.2, 0.3)}
    run = simulate(body, laws, t_end=0.01, solver=FixedStep(dt=0.01, break_away=break_away))
    ahead, behind = (float(run[f"normal_force:{foot}"][0]) for foot in ("front", "rear"))
    friction = front * ahead + rear * behind
    # the weight, and the moment about the centre of mass
    assert ahead + behind == pytest.approx(2.0 * 9.81, rel=1e-12)
    assert 0.3 * ahead - 0.2 * behind == pytest.approx(0.15 * friction, rel=1e-12)
    assert run["v"][-1] == pytest.approx(0.01 * (30.0 - friction) / 2.0, rel=1e-12)
