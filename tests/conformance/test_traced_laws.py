"""A law is written once: its floats, its arrays and its generated equations must agree."""

import math
import random

import numpy as np
import pytest
from tests.support import Generated, example_of

from stickslip import Axis
from stickslip.friction import LAWS, bound
from stickslip.maths import Latches
from stickslip.mechanisms import given_inputs
from stickslip.quantities import fields_of
from stickslip.study.testing import ORDINARY

FRACTIONAL = 1.5
SPEEDS = [10.0 ** (i / 4) for i in range(-24, 5)]
LOAD = 7.0


def variants():
    """Yield each law with its own shape and with a fractional exponent where it has one."""
    for kind in LAWS.values():
        law = bound(example_of(kind), ORDINARY)
        yield pytest.param(law, id=law.name)
        shapes = [name for name, quantity in fields_of(kind).items() if quantity.structural]
        if shapes:
            values = {name: getattr(law, name) for name in fields_of(kind)}
            bent = bound(kind(**(values | dict.fromkeys(shapes, FRACTIONAL))), ORDINARY)
            yield pytest.param(bent, id=f"{law.name}, fractional exponent")


each_law = pytest.mark.parametrize("law", list(variants()))
# a solver knows which latched switches are on: see tests/friction/test_memories.py
each_without_latches = pytest.mark.parametrize(
    "law", [variant for variant in variants() if variant.values[0].name != "gms"]
)


def generated_with(law, **rig):
    """Return the equations of an axis that tells a law what it is bound to."""
    axis = given_inputs(Axis(inertia=2.0, load=LOAD, **rig), {n: ORDINARY[n] for n in law.inputs})
    return Generated(axis, law)


def deflections(law, v, share):
    """Return a share of the deflections of steady sliding: yielding has a corner at the whole."""
    if not law.states:
        return ()
    level = abs(law.steady(v, 1.0) - law.steady(v, 0.0))
    reach = level / law.force(0.0, 1.0, (1.0,) * len(law.states))
    return (reach * share,) * len(law.states)


def friction(law, v, z, load):
    with Latches():  # margins tell which latched switches are on
        return _friction(law, v, z, load)


def rates_of(law, v, z):
    with Latches():
        return law.rates(v, LOAD, z)


def _friction(law, v, z, load):
    return law.force(v, load, z) if law.states else law.force(v, load)


def states(law):
    """Yield speeds of both senses with deflections of both senses."""
    dice = random.Random(1)
    for v in SPEEDS:
        for sense in (1.0, -1.0):
            yield sense * v, deflections(law, sense * v, dice.uniform(-0.7, 0.7))


def size_of(law, v, z):
    """Return the size of the largest part of the friction force."""
    mirrored = tuple(-state for state in z)
    return abs(friction(law, v, z, LOAD)) + abs(friction(law, v, mirrored, LOAD))


# The generated text orders sums and products anew: a few roundings of the largest part.
ROUNDING = 1e-13


@each_without_latches
def test_generated_equations_agree_with_the_law_in_floats(law):
    generated = generated_with(law)
    for v, z in states(law):
        mode = 1 if v > 0 else -1
        y = [0.3, v, *z]
        expected = friction(law, v, z, LOAD)
        allowed = ROUNDING * size_of(law, v, z)
        speed, acceleration, *rates = generated.moving("field", mode, y)
        force, normal, needed, level = generated.moving("contact", mode, y)
        assert speed == v
        assert abs(acceleration + expected / 2.0) <= allowed
        assert abs(force - expected) <= allowed
        assert needed == force
        assert normal == LOAD
        assert math.isclose(level, law.break_away(LOAD), rel_tol=ROUNDING)
        if z:
            for rate, true in zip(rates, rates_of(law, v, z), strict=True):
                assert abs(rate - true) <= ROUNDING * max(abs(v), abs(true))


@each_law
def test_arrays_give_what_floats_give(law):
    cases = list(states(law))
    v = np.array([v for v, _ in cases])
    z = tuple(np.array(column) for column in zip(*[z for _, z in cases], strict=True))
    force = friction(law, v, z, LOAD)
    expected = [friction(law, one, each, LOAD) for one, each in cases]
    # exp and pow of NumPy may differ from those of math in the last digit
    sizes = np.array([size_of(law, one, each) for one, each in cases])
    assert np.all(np.abs(force - expected) <= 1e-14 * sizes)
    if z:
        rates = rates_of(law, v, z)
        true = np.array([rates_of(law, one, each) for one, each in cases]).T
        assert np.all(np.abs(np.array(rates) - true) <= 1e-14 * (np.abs(v) + np.abs(true)))


@each_law
def test_arrays_of_loads_give_what_floats_give(law):
    loads = np.array([0.0, 0.5, 3.0])
    np.testing.assert_array_equal(
        law.break_away(loads), [law.break_away(float(load)) for load in loads]
    )


def slope(evaluate, x, h):
    """Return a central difference of order four."""
    ends = [np.array(evaluate(x + i * h)) for i in (-2, -1, 1, 2)]
    return (ends[0] - 8 * ends[1] + 8 * ends[2] - ends[3]) / (12 * h)


@each_law
def test_the_generated_jacobian_is_the_slope_of_the_generated_field(law):
    generated = generated_with(law, stiffness=30.0, damping=0.2)
    for v, z in states(law):
        y = [0.3, v, *z]
        mode, flags = (1 if v > 0 else -1), generated.flags(y)
        n = len(y)
        field = generated.moving("field", mode, y)
        jacobian = np.array(generated.moving("jacobian", mode, y)).reshape(n, n)
        for i in range(n):

            def along(x, i=i, mode=mode, flags=flags, y=y):
                point = [*y[:i], x, *y[i + 1 :]]
                return generated.moving("field", mode, point, flags=flags)

            # h = 1e-3 |y|: the rule errs by h^4 = 1e-12 and rounding by 1e-16 / 1e-3, both
            # relative to |f / y|, in which (v / v_s)^n may add two digits
            numeric = slope(along, y[i], 1e-3 * abs(y[i]) if y[i] else 1e-6)
            size = np.abs(jacobian[:, i]) + np.abs(field) / abs(y[i] or 1.0) + 1.0
            assert np.all(np.abs(jacobian[:, i] - numeric) <= 1e-9 * size)


@each_law
@pytest.mark.parametrize("v", [0.0, -1e-4, -1e-12])
def test_equations_stay_finite_where_stages_overshoot_zero_velocity(law, v):
    generated = generated_with(law)
    for mode, sense in ((1, 1.0), (-1, -1.0)):
        for share in (-1.0, 0.0, 0.5, 1.0):
            y = [0.0, sense * v, *deflections(law, sense, share)]
            for name in ("field", "jacobian", "time_slope", "contact", "guards", "power"):
                assert np.all(np.isfinite(generated.moving(name, mode, y))), name
