"""Levels of an axis that has no load are forces, and are said in N wherever they stand."""

import math

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    Dahl,
    DirectionDependent,
    Measurement,
    Pendulum,
    TwoMassAxis,
    fit,
)
from stickslip.identify.fits import unit_of as unit_of_path
from stickslip.quantities import fields_of


def table(**more):
    v = np.linspace(-0.2, 0.2, 80)
    noise = 0.02 * np.random.default_rng(0).normal(size=len(v))
    return Measurement(velocity=v, friction=np.where(v > 0, 2.0, -3.0) + noise, **more)


def unit_of(found, name="kinetic_coefficient"):
    return found.estimate(name).quantity.unit


def test_a_level_where_no_load_is_known_is_in_newtons():
    found = fit(Axis(inertia=1.0), Coulomb, table())
    assert unit_of(found) == "N"
    assert found.to_dict()["estimates"][0]["unit"] == "N"
    assert " N (" in str(found.estimate("kinetic_coefficient"))


def test_a_level_beside_a_load_is_a_pure_number():
    assert unit_of(fit(Axis(inertia=1.0, load=5.0), Coulomb, table())) == "1"
    loaded = table(load=np.full(80, 5.0))
    assert unit_of(fit(Axis(inertia=1.0), Coulomb, loaded)) == "1"


def test_stiffness_of_bristles_is_in_newtons_a_metre_and_an_exponent_has_no_unit():
    t = np.linspace(0.0, 6.0, 3000)
    x = 1e-3 * np.sin(2.0 * np.pi * t) + 4e-4 * np.sin(14.0 * t)
    friction = [0.0]
    for step in np.diff(x):  # closed form of bristles that yield over 0.1 mm
        end = math.copysign(2.0, step)
        friction.append(end + (friction[-1] - end) * math.exp(-abs(step) / 1e-4))
    record = Measurement(time=t, position=x, friction=np.array(friction))
    found = fit(Axis(inertia=1.0), Dahl, record)
    assert unit_of(found, "bristle_stiffness") == "N/m"
    power = fit(Axis(inertia=1.0), "power-viscous", table())
    assert unit_of(power, "viscous_exponent") == "1"


@pytest.mark.parametrize(
    ("mechanism", "units"),
    [
        (Pendulum(mass=0.7, length=0.43), {"mass": "kg", "length": "m", "inertia": "kg m^2"}),
        (Axis(inertia=0.02, rotary=True), {"inertia": "kg m^2", "stiffness": "N m/rad"}),
        (TwoMassAxis(motor_inertia=1.0, load_inertia=1.0, stiffness=1.0, rotary=True),
         {"load_inertia": "kg m^2", "damping": "N m s/rad"}),
    ],
)  # fmt: skip
def test_parameters_of_what_turns_keep_units_of_their_own(mechanism, units):
    known = fields_of(type(mechanism))
    shown = [
        unit_of_path(f"mechanism.{name}", known[name], per_load=True, turning=True)
        for name in units
    ]
    assert shown == [*units.values()]


def test_an_offset_that_levels_by_direction_stand_for_is_not_dropped_in_silence():
    found = fit(Axis(inertia=1.0, offset=0.25), DirectionDependent, table())
    said = [line for line in found.remarks if "constant force" in line]
    assert len(said) == 1
    assert "cannot be separated" in said[0]
    assert "fixed at 0.25 N" in said[0]


def test_nothing_is_said_of_an_offset_that_was_looked_for():
    found = fit(Axis(inertia=1.0), Coulomb, table())
    assert "offset" in {one.path for one in found.estimates}
    assert not any("constant force" in line for line in (*found.sentences, *found.remarks))
