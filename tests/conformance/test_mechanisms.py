"""What every registered mechanism must do, with every registered law."""

import dataclasses
import math
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support import RIGS, SHOWN, Generated, example_of, examples, informed, pairs

from stickslip import simulate
from stickslip.friction import LAWS
from stickslip.mechanisms import MECHANISMS, InnerMass, Motor, slip_of, stops_of
from stickslip.mechanisms.drives import Drive

each_mechanism = pytest.mark.parametrize("name", MECHANISMS)
each_example = pytest.mark.parametrize("rig", SHOWN.values(), ids=SHOWN)
ALONE = {
    name: rig
    for name, rig in SHOWN.items()
    if len(rig.contacts()) == 1 and {stop.coordinate for stop in stops_of(rig)} <= {slip_of(rig)}
}
"""Those whose equations are derived for each mode of their only contact."""
each_alone = pytest.mark.parametrize("rig", ALONE.values(), ids=ALONE)
each_pair = pytest.mark.parametrize(("rig", "kind"), list(pairs(LAWS, ALONE, 8)))


# squares of speeds below 1e-100 m/s are subnormal, and have no 14 digits
SPEEDS = st.floats(-10, 10).filter(lambda v: v == 0 or abs(v) > 1e-100)


@each_mechanism
@examples(20)
@given(data=st.data(), v=SPEEDS, x=st.floats(-10, 10))
def test_kinetic_energy_is_positive_and_quadratic_in_the_rates(name, data, v, x):
    rig = data.draw(RIGS[name])
    # where held coordinates move along, the terms of a sum may cancel but for a few roundings
    places = dict.fromkeys((*rig.coordinates, "y", "tilt"), x)
    rates = dict.fromkeys(places, v)
    twice = dict.fromkeys(places, 2.0 * v)
    energy = rig.kinetic_energy(places, rates)
    assert energy >= 0
    assert math.isclose(rig.kinetic_energy(places, twice), 4.0 * energy, rel_tol=1e-14)


def held_in(part):
    """Yield the drives in the fields of a mechanism and of its motors."""
    for field in dataclasses.fields(part):
        value = getattr(part, field.name)
        if isinstance(value, Drive):
            yield value
        elif isinstance(value, (InnerMass, Motor)):
            yield from held_in(value)


@each_example
def test_every_drive_stands_in_a_field_of_the_mechanism_or_of_its_motor(rig):
    assert list(rig.drives().values()) == list(held_in(rig))
    for name, drive in rig.drives().items():
        assert getattr(rig, name, drive) is drive or isinstance(getattr(rig, name), Motor)


@each_example
def test_a_mechanism_names_what_it_rubs_on(rig):
    for contact in rig.contacts():
        assert contact.slip in rig.coordinates
        assert (contact.normal is None) != (contact.load is None)


def states(rig, bristles):
    """Yield states in which the contact slips."""
    dice = random.Random(3)
    n = len(rig.coordinates)
    slip = n + rig.coordinates.index(rig.contacts()[0].slip)
    for v in (0.3, -0.7, 0.01):
        y = [dice.uniform(-0.4, 0.4) for _ in range(2 * n)] + [1e-5] * bristles
        y[slip] = v
        yield y, (1 if v > 0 else -1)


@each_pair
def test_energy_changes_by_the_power_supplied_less_the_power_taken(rig, kind):
    rig = informed(rig, kind)
    generated = Generated(rig, example_of(kind))
    bristles = generated.sizes.states - 2 * len(rig.coordinates)
    for y, mode in states(rig, bristles):
        t = 0.7
        flags = generated.flags(y, t)
        rates = generated.moving("field", mode, y, t=t)
        supplied, taken = generated.moving("power", mode, y, t=t)

        def along(s, y=y, rates=rates, flags=flags, t=t):
            point = [value + s * rate for value, rate in zip(y, rates, strict=True)]
            return generated.energy(point, t=t + s, flags=flags)

        # exact for quadratic energies; cosines leave h^4 times what angles of some radians a
        # second make of them, some 1e-12; rounding is that of the energy over h
        fastest = max(1.0, *map(abs, rates))
        h = 1e-3 / fastest
        inner, outer = along(h) - along(-h), along(2.0 * h) - along(-2.0 * h)
        change = (8.0 * inner - outer) / (12.0 * h)
        size = abs(supplied) + abs(taken) + fastest + abs(along(0.0)) / h
        assert abs(change - supplied + taken) <= 1e-12 * size


@each_pair
def test_a_run_has_every_column_and_a_certificate(rig, kind):
    law = example_of(kind)
    rig = informed(rig, law)
    run = simulate(rig, law, t_end=1.5)
    bristles = law.states if law.states else ()
    efforts = [guide.effort for guide in rig.guided().values()]
    assert sorted(run.names) == sorted(
        (*rig.coordinates, *rig.rates, *bristles, *efforts, "friction", "normal_force", "mode")
    )
    assert set(run.units) == set(run.names)
    assert all(np.all(np.isfinite(run[column])) for column in run.names)
    assert run.certificate.certified
    assert run.status.complete
    assert run.span == (0.0, 1.5)


@each_example
def test_a_run_begins_where_the_mechanism_says(rig):
    run = simulate(rig, example_of(LAWS["coulomb"]), t_end=0.1)
    for state in (*rig.coordinates, *rig.rates):
        assert run[state][0] == rig.start().get(state, 0.0)
