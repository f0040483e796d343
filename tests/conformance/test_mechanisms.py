"""What every registered mechanism must do, with every registered law."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.support import EXAMPLES, RIGS, Generated, example_of

from stickslip import LAWS, simulate
from stickslip.drives import Drive
from stickslip.friction import BristleLaw
from stickslip.mechanisms import MECHANISMS

each_mechanism = pytest.mark.parametrize("name", MECHANISMS)
each_law = pytest.mark.parametrize("kind", LAWS.values(), ids=lambda kind: kind.name)


# squares of speeds below 1e-100 m/s are subnormal, and have no 14 digits
SPEEDS = st.floats(-10, 10).filter(lambda v: v == 0 or abs(v) > 1e-100)


@each_mechanism
@settings(max_examples=20)
@given(data=st.data(), v=SPEEDS, x=st.floats(-10, 10))
def test_kinetic_energy_is_positive_and_quadratic_in_the_rates(name, data, v, x):
    rig = data.draw(RIGS[name])
    places = dict.fromkeys((*rig.coordinates, "y"), x)
    rates = dict.fromkeys(places, v)
    twice = dict.fromkeys(places, 2.0 * v)
    energy = rig.kinetic_energy(places, rates)
    assert energy >= 0
    assert math.isclose(rig.kinetic_energy(places, twice), 4.0 * energy, rel_tol=1e-14)


@each_mechanism
def test_drives_are_named_after_the_fields_that_hold_them(name):
    rig = EXAMPLES[name]
    for field, drive in rig.drives().items():
        assert getattr(rig, field) is drive
        assert isinstance(drive, Drive)


@each_mechanism
def test_a_mechanism_names_what_it_rubs_on(name):
    for contact in EXAMPLES[name].contacts():
        assert contact.slip in EXAMPLES[name].coordinates
        assert (contact.normal is None) != (contact.load is None)


@each_mechanism
@each_law
def test_energy_changes_by_the_power_supplied_less_the_power_taken(name, kind):
    generated = Generated(EXAMPLES[name], example_of(kind))
    bristles = [1e-5] * (generated.module.N_STATES - 2)
    for x, v in ((0.02, 0.3), (0.05, -0.7), (-0.4, 0.01)):
        y, t = [x, v, *bristles], 0.7
        flags, mode = generated.flags(y, t), (1 if v > 0 else -1)
        rates = generated.moving("field", mode, y, t=t)
        supplied, taken = generated.moving("power", mode, y, t=t)

        def along(s, y=y, rates=rates, flags=flags, t=t):
            point = [value + s * rate for value, rate in zip(y, rates, strict=True)]
            return generated.energy(point, t=t + s, flags=flags)

        # energies are quadratic, so a central difference is exact but for rounding
        h = 1e-3
        change = (along(h) - along(-h)) / (2 * h)
        size = abs(supplied) + abs(taken) + along(0.0) / h
        assert abs(change - supplied + taken) <= 1e-12 * size


@each_mechanism
@each_law
def test_a_run_has_every_column_and_a_certificate(name, kind):
    law = example_of(kind)
    run = simulate(EXAMPLES[name], law, t_end=1.5)
    bristles = law.bristles if isinstance(law, BristleLaw) else ()
    rig = EXAMPLES[name]
    assert run.names == (
        *rig.coordinates, *rig.rates, *bristles, "friction", "normal_force", "mode",
    )  # fmt: skip
    assert set(run.units) == set(run.names)
    assert all(np.all(np.isfinite(run[column])) for column in run.names)
    assert run.certificate.certified
    assert run.status.complete
    assert run.span == (0.0, 1.5)
