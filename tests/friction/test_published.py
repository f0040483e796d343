"""The printed equations: each fails just where it is said to, and agrees elsewhere."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stickslip import PRINTED_FORMS, Coulomb, CoulombViscous, Dahl, LuGre, Stribeck
from stickslip.quantities import fields_of

MU_K, MU_S, V_S, S0, S1, S2, N = 0.25, 0.35, 0.01, 1e3, 30.0, 0.4, 9.81
TYPICAL = {
    "kinetic_coefficient": MU_K,
    "static_coefficient": MU_S,
    "stribeck_velocity": V_S,
    "bristle_stiffness": S0,
    "bristle_damping": S1,
    "viscous_coefficient": S2,
}


def printed(name):
    form = PRINTED_FORMS[name]
    return form(**{field: TYPICAL[field] for field in fields_of(form)})


COULOMB = Coulomb(kinetic_coefficient=MU_K)
VISCOUS = CoulombViscous(kinetic_coefficient=MU_K, viscous_coefficient=S2)
STRIBECK = Stribeck(
    kinetic_coefficient=MU_K,
    static_coefficient=MU_S,
    stribeck_velocity=V_S,
    viscous_coefficient=S2,
    exponent=1,
)
DAHL = Dahl.from_forces(load=N, kinetic_force=MU_K * N, bristle_stiffness=S0)
LUGRE = LuGre.from_forces(
    load=N,
    kinetic_force=MU_K * N,
    static_force=MU_S * N,
    stribeck_velocity=V_S,
    bristle_stiffness=S0,
    bristle_damping=S1,
    viscous_coefficient=S2,
    exponent=1,
)
RIGHT = {
    "printed-1": COULOMB,
    "printed-3-4": VISCOUS,
    "printed-5": STRIBECK,
    "printed-6": DAHL,
    "printed-7": COULOMB,
    "printed-8": VISCOUS,
    "printed-9": LUGRE,
    "printed-10": STRIBECK,
}
SWITCHED = ("printed-6", "printed-7", "printed-8", "printed-9", "printed-10")
WRONG_BACKWARDS = ("printed-3-4", "printed-5", "printed-6", "printed-8", "printed-9", "printed-10")
forward = st.floats(1e-6, 10.0)
deflection = st.floats(-2.0 * MU_K * N / S0, 2.0 * MU_K * N / S0)


def force(form, v, z, applied=0.0):
    return form.force(v, (z,) if form.bristles else (), N, applied)


def true_force(law, v, z):
    return law.force(v, (z,), N) if hasattr(law, "bristles") else law.force(v, N)


def test_there_is_a_right_form_for_every_printed_one():
    assert set(RIGHT) == set(PRINTED_FORMS)
    assert all(PRINTED_FORMS[name].corrected is type(law) for name, law in RIGHT.items())


@pytest.mark.parametrize("name", PRINTED_FORMS)
@settings(max_examples=30)
@given(v=forward, z=deflection)
def test_moving_forward_every_printed_form_is_right(name, v, z):
    form, law = printed(name), RIGHT[name]
    expected = true_force(law, v, z)
    # the damping of bristles is a difference of parts a few hundred times its size
    assert math.isclose(force(form, v, z), expected, rel_tol=1e-12, abs_tol=1e-12 * S1 * v)
    if form.bristles:
        (rate,), (true,) = form.bristle_rates(v, (z,), N), law.bristle_rates(v, (z,), N)
        assert math.isclose(rate, true, rel_tol=1e-12, abs_tol=1e-12 * v)


@pytest.mark.parametrize("name", ["printed-1", "printed-7"])
@given(v=forward)
def test_moving_backwards_the_coulomb_forms_are_right(name, v):
    assert force(printed(name), -v, 0.0) == COULOMB.force(-v, N)


@pytest.mark.parametrize("name", WRONG_BACKWARDS)
def test_moving_backwards_every_other_form_is_wrong(name):
    z = -0.5 * MU_K * N / S0
    right = true_force(RIGHT[name], -0.1, z)
    assert abs(force(printed(name), -0.1, z) - right) > 0.01 * abs(right)


@pytest.mark.parametrize("name", SWITCHED)
@given(applied=st.floats(-1e6, 1e6))
def test_at_rest_the_switched_forms_hold_any_force_however_large(name, applied):
    assert force(printed(name), 0.0, 0.0, applied) == applied


@given(applied=st.floats(-1e6, 1e6))
def test_equation_1_holds_nothing_at_rest(applied):
    assert force(printed("printed-1"), 0.0, 0.0, applied) == 0


@given(v=forward)
def test_equations_3_and_4_push_a_body_that_moves_backwards(v):
    dry = PRINTED_FORMS["printed-3-4"](kinetic_coefficient=MU_K)
    assert force(dry, -v, 0.0) == MU_K * N
    assert force(dry, -v, 0.0) * -v < 0


@given(applied=st.floats(-100, 100))
def test_equations_3_and_4_give_full_friction_at_rest_whatever_is_needed(applied):
    assert force(printed("printed-3-4"), 0.0, 0.0, applied) == MU_K * N


def test_equation_5_has_the_wrong_sign_for_backward_motion():
    assert force(printed("printed-5"), -V_S, 0.0) > 0


def test_equation_5_grows_without_limit_for_backward_motion():
    growth = force(printed("printed-5"), -30 * V_S, 0.0)
    surplus = (MU_S - MU_K) * N
    assert growth > surplus * math.exp(29)


def test_equation_6_pushes_the_wrong_way_after_a_reversal():
    z = 0.5 * MU_K * N / S0  # the bristle still points forward just after the reversal
    assert force(printed("printed-6"), 1e-9, z) == S0 * z
    assert force(printed("printed-6"), -1e-9, z) == -S0 * z


@pytest.mark.parametrize("name", ["printed-8", "printed-10"])
@given(v=st.floats(1.0, 10.0))
def test_equations_8_and_10_have_a_viscous_part_that_pushes_backwards(name, v):
    form = printed(name)
    dry = force(type(form)(**{**form_values(form), "viscous_coefficient": 0.0}), -v, 0.0)
    viscous = force(form, -v, 0.0) - dry
    assert viscous * -v < 0
    # a difference of two sums of the size of the level
    assert math.isclose(viscous, -S2 * -v, rel_tol=1e-12)


def form_values(form):
    return {name: getattr(form, name) for name in fields_of(type(form))}


def test_equation_9_changes_all_signs_for_backward_motion():
    form = printed("printed-9")
    z = -0.5 * MU_K * N / S0
    (rate,) = form.bristle_rates(-0.1, (z,), N)
    assert force(form, -0.1, z) == -(S0 * z + S1 * rate - S2 * 0.1)


def test_equation_9_never_lets_the_bristle_yield_when_moving_backwards():
    form = printed("printed-9")
    far = -100 * MU_S * N / S0  # a hundred times what break-away allows
    (rate,) = form.bristle_rates(-0.5, (far,), N)
    assert math.isclose(rate, -0.5, rel_tol=1e-9)  # e^-50 of yielding is left
    (true,) = LUGRE.bristle_rates(-0.5, (far,), N)
    assert true > 0
