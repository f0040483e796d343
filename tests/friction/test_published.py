"""The printed equations: each fails just where it is said to, and agrees elsewhere."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support import examples

from stickslip import Coulomb, CoulombViscous, Dahl, LuGre, Stribeck, Viscous
from stickslip.friction import PRINTED_FORMS
from stickslip.quantities import fields_of

MU_K, MU_S, V_S, S0, S1, S2, N = 0.25, 0.35, 0.01, 1e3, 30.0, 0.4, 9.81
TYPICAL = {
    "kinetic_coefficient": MU_K,
    "static_coefficient": MU_S,
    "stribeck_velocity": V_S,
    "bristle_stiffness": S0,
    "bristle_damping": S1,
    "viscous_coefficient": S2,
    "exponent": 2.0,
    "weight": N,
}


def printed(name):
    form = PRINTED_FORMS[name]
    return form(**{field: TYPICAL[field] for field in fields_of(form)})


COULOMB = Coulomb(kinetic_coefficient=MU_K)
VISCOUS = Viscous(viscous_coefficient=S2)
COULOMB_VISCOUS = CoulombViscous(kinetic_coefficient=MU_K, viscous_coefficient=S2)
STRIBECK = Stribeck(
    kinetic_coefficient=MU_K,
    static_coefficient=MU_S,
    stribeck_velocity=V_S,
    viscous_coefficient=S2,
    fading_exponent=1,
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
)
RIGHT = {
    "printed-1": COULOMB,
    "printed-3": COULOMB,
    "printed-4": COULOMB,
    "printed-5": STRIBECK,
    "printed-6": DAHL,
    "printed-7": COULOMB,
    "printed-8": VISCOUS,
    "printed-9": LUGRE,
    "printed-10": COULOMB_VISCOUS,
}
SWITCHED = ("printed-6", "printed-7", "printed-8", "printed-9", "printed-10")
WRONG_BACKWARDS = (
    "printed-3",
    "printed-4",
    "printed-5",
    "printed-6",
    "printed-8",
    "printed-9",
    "printed-10",
)
forward = st.floats(1e-6, 10.0)
deflection = st.floats(-2.0 * MU_K * N / S0, 2.0 * MU_K * N / S0)


def force(form, v, z, applied=0.0):
    return form.force(v, N, (z,) if form.states else (), applied)


def true_force(law, v, z):
    return law.force(v, N, (z,)) if law.states else law.force(v, N)


def test_there_is_a_right_form_for_every_printed_one():
    assert set(RIGHT) == set(PRINTED_FORMS)
    assert all(PRINTED_FORMS[name].corrected is type(law) for name, law in RIGHT.items())


@pytest.mark.parametrize("name", PRINTED_FORMS)
@examples(30)
@given(v=forward, z=deflection)
def test_moving_forward_every_printed_form_is_right(name, v, z):
    form, law = printed(name), RIGHT[name]
    expected = true_force(law, v, z)
    # the damping of bristles is a difference of parts a few hundred times its size
    assert math.isclose(force(form, v, z), expected, rel_tol=1e-12, abs_tol=1e-12 * S1 * v)
    if form.states:
        (rate,), (true,) = form.rates(v, N, (z,)), law.rates(v, N, (z,))
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


@pytest.mark.parametrize("name", ["printed-3", "printed-4"])
@given(v=forward)
def test_equations_3_and_4_push_a_body_that_moves_backwards(name, v):
    assert math.isclose(force(printed(name), -v, 0.0), MU_K * N, rel_tol=1e-15)


@pytest.mark.parametrize("name", ["printed-3", "printed-4"])
@given(applied=st.floats(-100, 100))
def test_equations_3_and_4_give_no_friction_at_rest_whatever_mu_is(name, applied):
    # sgn 0 = 0 multiplies mu, and the load of a block is its weight
    assert force(printed(name), 0.0, 0.0, applied) == 0


@given(v=st.floats(0.01, 10.0), load=st.floats(1.0, 20.0))
def test_equation_4_has_one_sign_for_the_pendulum_and_two_for_the_weight(v, load):
    # by its terms: mu (N - W) with mu = mu_k sgn v, and mu_k W sgn v sgn v
    form = printed("printed-4")
    for speed, sense in ((v, 1.0), (-v, -1.0)):
        expected = sense * MU_K * (load - N) + MU_K * N
        assert math.isclose(form.force(speed, load, (), 0.0), expected, rel_tol=1e-12)


@given(applied=st.floats(-100, 100))
def test_equation_5_has_the_right_rule_for_rest(applied):
    # F_x while it is below F_s, and F_s in its direction beyond
    found = force(printed("printed-5"), 0.0, 0.0, applied)
    assert found == max(-MU_S * N, min(applied, MU_S * N))


@given(v=forward)
def test_equation_8_is_purely_viscous_and_drives_backward_motion(v):
    form = printed("printed-8")
    assert force(form, v, 0.0) == S2 * v
    assert force(form, -v, 0.0) == S2 * v
    assert list(fields_of(type(form))) == ["viscous_coefficient"]


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


@given(v=st.floats(1.0, 10.0))
def test_equation_10_has_a_viscous_part_that_pushes_backwards(v):
    form = printed("printed-10")
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
    (rate,) = form.rates(-0.1, N, (z,))
    assert force(form, -0.1, z) == -(S0 * z + S1 * rate - S2 * 0.1)


def test_equation_9_yields_as_lugre_does_under_the_reading_that_favours_it():
    # its exponent cannot be read: it is taken as in LuGre 1995, in which nothing is wrong
    form = printed("printed-9")
    for v in (-0.5, -0.01, 0.02):
        assert form.rates(v, N, (1e-3,)) == pytest.approx(LUGRE.rates(v, N, (1e-3,)), rel=1e-12)


@pytest.mark.parametrize("name", PRINTED_FORMS)
def test_formulas_are_in_the_symbols_of_the_paper(name):
    symbols = {
        "printed-1": [r"F_f = -\mu N", r"N = M g + F_y"],
        "printed-3": [r"\operatorname{sign}(F_x) \mu_k", r"\operatorname{sign}(\dot x) \mu_k"],
        "printed-4": [r"\mu (M+m) g \operatorname{sgn} \dot x = 0"],
        "printed-5": [
            r"F_e = F_x",
            r"F_s \operatorname{sgn}(F_e)",
            r"e^{-\frac{\dot x}{\dot x_s}}",
        ],
        "printed-6": [r"F_d = \sigma_0 Z \operatorname{sgn}(\dot x)"],
        "printed-7": [r"F_c = \mu N \operatorname{sgn}(\dot x)"],
        "printed-8": [r"F_v = \mu_v \dot x \operatorname{sgn}(\dot x)"],
        "printed-9": [r"\sigma_1 Z + \sigma_2 \frac{dz}{dt} + \sigma_3 \dot x"],
        "printed-10": [r"F_c \operatorname{sgn}(\dot x) + \mu \dot x \operatorname{sgn}(\dot x)"],
    }
    form = PRINTED_FORMS[name]
    assert form.equation == f"({name.removeprefix('printed-')})"
    for part in symbols[name]:
        assert part in form.formula.replace(r" \quad {}", "")


def test_equation_5_with_the_sign_it_lacks_opposes_motion_both_ways_and_grows_backwards():
    values = {
        "kinetic_coefficient": 0.25,
        "static_coefficient": 0.35,
        "stribeck_velocity": 0.01,
        "viscous_coefficient": 0.5,
    }
    bare, signed = (PRINTED_FORMS["printed-5"](**values, signed=s) for s in (False, True))
    # forwards the two are one; backwards only the dry part changes its sign
    assert signed.force(0.02, 9.81, (), 0.0) == bare.force(0.02, 9.81, (), 0.0)
    back = 0.25 * 9.81 + 0.1 * 9.81 * math.exp(2.0)
    assert signed.force(-0.02, 9.81, (), 0.0) == pytest.approx(-back - 0.01, rel=1e-14)
    assert bare.force(-0.02, 9.81, (), 0.0) == pytest.approx(back - 0.01, rel=1e-14)


def test_the_dry_part_of_10_with_the_force_of_7_in_it_is_even():
    """As the defect of (10) says: F_c of (7) is mu N sgn v, and (10) multiplies it by sgn v."""
    seven = PRINTED_FORMS["printed-7"](kinetic_coefficient=0.25)
    ten = PRINTED_FORMS["printed-10"](kinetic_coefficient=0.25, viscous_coefficient=0.0)
    for v in (-0.3, 0.3):
        literal = seven.force(v, 9.81, (), 0.0) * math.copysign(1.0, v)
        assert literal == 0.25 * 9.81
        assert ten.force(v, 9.81, (), 0.0) == math.copysign(literal, v)
    assert "even in $v$" in PRINTED_FORMS["printed-10"].defect
