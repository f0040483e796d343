"""What every law with states must do; many laws at once, as one whose parameters are arrays."""

import dataclasses
import functools
import math

import numpy as np
import pytest
from tests.support import BRISTLE, DECADES

from stickslip.quantities import fields_of, unchecked
from stickslip.study import presliding_length

MEETS_ITS_CONDITION = ("lugre", "directional-lugre", "elasto-plastic")
"""Laws whose condition of passivity is needed at their typical values, and not only enough."""
MANY = 48
LOAD = 7.0
ROUNDING = 1e-12
"""Roundings of the largest part; the parts are up to 1e3 times their sum."""
STEPPED = ("gms",)
"""Laws with latched switches, which are turned from step to step: see tests/friction/memories."""
SUDDEN = ("maxwell-slip", "haessig-friedland")
"""Laws that yield at once where a spring has its level: steps pass it by their length."""
DISTANT = {"bliman-sorine": 40.0}
"""Lengths over which laws forget, where they are longer than the reach."""
each_law = pytest.mark.parametrize(
    "kind", [one for one in BRISTLE if one.name not in STEPPED], ids=lambda kind: kind.name
)


def drawn(kind, *, plain=False):
    """Return laws of a kind as one: parameters over decades, exponents unless they stay `plain`."""
    dice = np.random.default_rng(7)
    values = {}
    for field in dataclasses.fields(kind):
        quantity = fields_of(kind).get(field.name)
        if quantity is None or (plain and quantity.structural):
            values[field.name] = field.default
        elif quantity.structural:
            values[field.name] = dice.choice([1.0, 2.0, 0.7, 1.5], MANY)
        else:
            size = 10.0 ** dice.uniform(*DECADES[quantity.unit], MANY)
            values[field.name] = size + values.get(quantity.at_least, 0.0)
    return unchecked(kind, **values)


def reach(law):
    """Return the deflection that carries the break-away level, from the stiffness at rest."""
    levels = [law.towards(side).break_away(1.0) for side in (1, -1)]
    return np.maximum(*levels) / law.force(0.0, 1.0, (1.0,) * len(law.states))


@functools.cache
def moved(kind, *, plain=False, parts=12):
    """Return laws, and their states after slip there and back, drawn in speed and length."""
    law = drawn(kind, plain=plain)
    dice, length = np.random.default_rng(3), reach(law)
    # levels of both directions may be far apart, and with them the lengths over which these yield
    steps = 1000 if law.directional else 60
    z = (np.zeros(MANY),) * len(law.states)
    for _ in range(parts):
        v = 10.0 ** dice.uniform(-4, 0, MANY) * dice.choice([-1.0, 1.0], MANY)
        z = slid(law, v, z, length * dice.uniform(0.1, 3.0, MANY), steps)
    return law, z


def slid(law, v, z, length, steps):
    """Return states after slip at a constant velocity, by the midpoint rule."""
    h = length / np.abs(v) / steps
    for _ in range(steps):
        half = law.rates(v, 1.0, z)
        middle = tuple(a + 0.5 * h * b for a, b in zip(z, half, strict=True))
        z = tuple(a + h * b for a, b in zip(z, law.rates(v, 1.0, middle), strict=True))
    return z


def exchanged(law):
    """Return the laws with the parameters of both directions exchanged; most have none."""
    swap = {"forward": "backward", "backward": "forward"}
    values = {}
    for field in dataclasses.fields(law):
        side, _, rest = field.name.partition("_")
        name = f"{swap[side]}_{rest}" if side in swap else field.name
        values[field.name] = getattr(law, name)
    return unchecked(type(law), **values)


def velocities():
    dice = np.random.default_rng(5)
    return 10.0 ** dice.uniform(-5, 1, MANY) * dice.choice([-1.0, 1.0], MANY)


@each_law
def test_states_and_force_are_odd_with_the_directions_exchanged(kind):
    law, z = moved(kind, plain=True)
    other, v = exchanged(law), velocities()
    back = tuple(-state for state in z)
    np.testing.assert_array_equal(other.force(-v, LOAD, back), -law.force(v, LOAD, z))
    np.testing.assert_array_equal(other.rates(-v, LOAD, back), -np.array(law.rates(v, LOAD, z)))


@each_law
def test_long_sliding_gives_the_steady_force(kind):
    law, v = drawn(kind, plain=True), velocities()
    # the approach is exponential over at most the reach: exp(-25) is left
    length = 25.0 * reach(law) * DISTANT.get(kind.name, 1.0)
    z = slid(law, v, (np.zeros(MANY),) * len(law.states), length, 2000)
    # the midpoint rule stops just before a spring that yields at once: one plain step passes it
    h = length / 2000 / np.abs(v)
    z = tuple(a + h * b for a, b in zip(z, law.rates(v, LOAD, z), strict=True))
    steady = law.steady(v, LOAD)
    size = np.abs(steady) + np.abs(law.force(v, LOAD, (0.0,) * len(law.states)))
    allowed = 2.0 * 25.0 / 2000 if kind.name in SUDDEN else 1e-8
    assert np.all(np.abs(law.force(v, LOAD, z) - steady) <= allowed * size)


@each_law
def test_steady_friction_opposes_motion_within_break_away_and_viscous_part(kind):
    law, v = drawn(kind), velocities()
    level = np.where(v > 0, *(law.towards(side).break_away(LOAD) for side in (1, -1)))
    assert np.all(law.steady(v, LOAD) * v > 0)
    assert np.all(
        np.abs(law.steady(v, LOAD)) <= (level + np.abs(law.steady(v, 0.0))) * (1 + ROUNDING)
    )


@each_law
def test_states_stay_at_rest_and_within_what_break_away_holds(kind):
    law, z = moved(kind, plain=kind.directional)
    assert all(np.all(rate == 0) for rate in law.rates(0.0, LOAD, z))
    most = np.maximum(*(law.towards(side).break_away(LOAD) for side in (1, -1)))
    # steps of a twentieth of the reach may pass the end of yielding by as much
    assert np.all(np.abs(law.force(0.0, LOAD, z)) <= most * 1.06)


@each_law
def test_friction_is_affine_in_the_load_and_without_load_only_flow_is_left(kind):
    law, z = moved(kind, plain=kind.directional)
    v = velocities()
    parts = [law.force(v, load, z) for load in (3.5, 2.0, 1.5, 0.0)]
    together, part, other, free = parts
    assert np.all(
        np.abs(together + free - part - other) <= ROUNDING * np.max(np.abs(parts), axis=0)
    )
    np.testing.assert_array_equal(free, law.force(v, 0.0, tuple(0.0 * state for state in z)))


def cycles(law):
    """Return energies of cycles that are drawn [J], of one that loads slowly and lets go fast."""
    dice, reach = np.random.default_rng(11), presliding_length(law)
    speeds = [
        getattr(law, name) for name, one in fields_of(type(law)).items() if one.scale == "speed"
    ]
    speed = min(filter(None, speeds), default=1e-3)
    v = speed * 10.0 ** dice.uniform(-2, 2, (3, 40)) * dice.choice([1.0, 1.0, -1.0], (3, 40))
    way = reach * 10.0 ** dice.uniform(-1.0, 0.3, (3, 40))
    v[:, 0], way[:, 0] = speed * np.array([0.1, 100.0, 100.0]), reach * 1.2
    z = np.zeros((len(law.states), 40))
    for _ in range(3):
        energy = np.zeros(40)
        for one, length in zip(v, way, strict=True):
            z, work = worked(law, one, z, length)
            energy += work
    return energy / (law.break_away(1.0) * reach)


def worked(law, v, z, length):
    """Return states and the work of friction after slip, by the classical Runge-Kutta method."""
    steps = max(64, math.ceil(32 * length.max() / presliding_length(law)))
    h, work = length / np.abs(v) / steps, np.zeros_like(v)

    def slopes(z):
        return np.array([0.0 * v + rate for rate in law.rates(v, 1.0, tuple(z))])

    for _ in range(steps):
        first = slopes(z)
        second = slopes(z + 0.5 * h * first)
        third = slopes(z + 0.5 * h * second)
        last = slopes(z + h * third)
        half = z + 0.5 * h * second
        after = z + h / 6.0 * (first + 2.0 * (second + third) + last)
        force = [law.force(v, 1.0, tuple(at)) for at in (z, half, half, after)]
        work += h * v / 6.0 * (force[0] + 2.0 * (force[1] + force[2]) + force[3])
        z = after
    return z, work


@each_law
def test_cycles_return_energy_only_where_the_entry_does_not_exclude_it(kind):
    law = kind(**kind.typical.values)
    if kind.passivity is None:
        return
    if kind.passivity.holds(law, 1.0):
        assert cycles(law).min() >= -1e-6  # of break-away times presliding length
    elif kind.name in MEETS_ITS_CONDITION:
        assert cycles(law).min() < -0.01
        viscous = {name: 200.0 for name in fields_of(kind) if name.endswith("viscous_coefficient")}
        calm = dataclasses.replace(law, **viscous)
        assert kind.passivity.holds(calm, 1.0)
        assert cycles(calm).min() >= -1e-6
