"""What every law with bristles must do."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from tests.support import BRISTLE, decade, examples, laws

loads = decade(-2, 3)
either_way = st.sampled_from([1.0, -1.0])
speeds = st.builds(lambda size, sense: size * sense, decade(-5, 1), either_way)
shares = st.floats(-1, 1)
"""Deflections over the one at break-away."""
each_law = pytest.mark.parametrize("kind", BRISTLE, ids=lambda kind: kind.name)
EVERY = examples(30)
ROUNDING = 1e-12
"""Roundings of the largest part; the parts are up to 1e3 times their sum."""


def reach(law):
    """Return the deflection that carries the break-away level, from the stiffness at rest."""
    return law.break_away(1.0) / law.force(0.0, 1.0, (1.0,) * len(law.states))


def deflections(law, share):
    return (reach(law) * share,) * len(law.states)


@each_law
@EVERY
@given(data=st.data(), v=speeds, share=shares, load=loads)
def test_bristles_and_force_are_odd(kind, data, v, share, load):
    law = data.draw(laws(kind))
    z = deflections(law, share)
    mirrored = tuple(-one for one in z)
    assert law.force(-v, load, mirrored) == -law.force(v, load, z)
    assert law.rates(-v, load, mirrored) == tuple(-rate for rate in law.rates(v, load, z))


@each_law
@examples(12)
@given(data=st.data(), v=speeds, load=loads)
def test_long_sliding_gives_the_steady_force(kind, data, v, load):
    law = data.draw(laws(kind, plain=True))
    distance = 50.0 * reach(law)  # the approach is exponential in the distance: e^-50 is left
    run = solve_ivp(
        lambda _, z: [rate / v for rate in law.rates(v, load, tuple(z))],
        (0.0, distance if v > 0 else -distance),
        [0.0] * len(law.states),
        method="LSODA",
        rtol=1e-10,
        atol=1e-12 * reach(law),
    )
    force = law.force(v, load, tuple(run.y[:, -1]))
    steady = law.steady(v, load)
    # damping multiplies what is left of the bristle rate, hence the speed in the size
    size = abs(steady) + abs(law.force(v, load, (0.0,) * len(law.states)))
    assert abs(force - steady) <= 1e-8 * size  # the oracle's tolerance, a hundredfold


@each_law
@EVERY
@given(data=st.data(), v=speeds, load=loads)
def test_steady_friction_opposes_motion_within_break_away_and_viscous_part(kind, data, v, load):
    law = data.draw(laws(kind))
    viscous = abs(law.steady(v, 0.0))
    assert law.steady(v, load) * v > 0
    assert abs(law.steady(v, load)) <= (law.break_away(load) + viscous) * (1 + ROUNDING)


@each_law
@EVERY
@given(data=st.data(), v=speeds, beyond=st.floats(1e-9, 1.0), load=loads)
def test_bristles_beyond_the_reach_of_break_away_are_not_stretched_further(
    kind, data, v, beyond, load
):
    law = data.draw(laws(kind))
    z = deflections(law, (1.0 + beyond) if v > 0 else -(1.0 + beyond))
    for rate in law.rates(v, load, z):
        assert rate * v <= 0


@each_law
@EVERY
@given(data=st.data(), share=shares, load=loads)
def test_at_rest_bristles_stay_and_hold_within_break_away(kind, data, share, load):
    law = data.draw(laws(kind))
    z = deflections(law, share)
    assert all(rate == 0 for rate in law.rates(0.0, load, z))
    assert abs(law.force(0.0, load, z)) <= law.break_away(load) * (1 + ROUNDING)


@each_law
@EVERY
@given(data=st.data(), v=speeds, share=shares, light=loads, more=loads)
def test_friction_is_affine_in_the_load(kind, data, v, share, light, more):
    law = data.draw(laws(kind))
    z = deflections(law, share)
    parts = [law.force(v, load, z) for load in (light + more, light, more, 0.0)]
    together, one, other, free = parts
    assert abs(together + free - one - other) <= ROUNDING * max(map(abs, parts))


@each_law
@EVERY
@given(data=st.data(), v=speeds, share=shares)
def test_without_load_only_viscous_friction_is_left(kind, data, v, share):
    law = data.draw(laws(kind))
    exponent = getattr(law, "viscous_exponent", 1.0)
    expected = getattr(law, "viscous_coefficient", 0.0) * abs(v) ** (exponent - 1.0) * v
    assert law.force(v, 0.0, deflections(law, share)) == expected
