"""Start values and bounds of the laws of the package, of sizes that a measurement told."""

from dataclasses import replace

import pytest
from tests.support import UNAIDED

from stickslip.errors import ParameterError
from stickslip.identify.fits import starting_law
from stickslip.quantities import Quantity, fields_of

TRAVELS = {
    "kinetic_coefficient": 0.25,
    "forward_kinetic_coefficient": 0.25,
    "backward_kinetic_coefficient": 0.25,
    "static_coefficient": 0.35,
    "viscous_coefficient": 0.5,
    "stribeck_velocity": 0.05,
    "bristle_stiffness": 1e3,
    "bristle_damping": 10.0,
}
FIXED = (
    "quadratic_coefficient",
    "fading_exponent",
    "yield_exponent",
    "viscous_exponent",
    "break_away_coefficient",
)
OLD = {
    name: kind
    for name, kind in UNAIDED.items()
    if {*fields_of(kind)} <= {*TRAVELS, *FIXED} and name != "power-viscous"
}
"""Laws whose parameters all have names of this list, and so the ranges above.

Left out is a law that gives one of these names another range.
"""
assert {"coulomb", "stribeck", "lugre"} <= OLD.keys()


@pytest.mark.parametrize("kind", OLD.values(), ids=OLD)
def test_ordinary_laws_are_what_they_were(kind):
    law = starting_law(kind, load=9.81)
    for name, field in kind.__dataclass_fields__.items():
        if name in fields_of(kind):
            needed = not isinstance(field.default, int | float | None)
            expected = TRAVELS[name] if needed else field.default
            if expected is None:
                assert getattr(law, name) is None
            else:
                assert getattr(law, name) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"scale": "speed"}, r"'v_s': a fit needs scale, bounds and start together"),
        ({"start": 0.1, "bounds": (0.0, 1.0)}, r"'v_s': a fit needs scale"),
        (
            {"scale": "velocity", "start": 0.1, "bounds": (0.0, 1.0)},
            r"scale='velocity' contains the unknown size 'velocity'; known sizes are none, level,",
        ),
        ({"scale": "speed", "start": 2.0, "bounds": (0.1, 1.0)}, r"with start between them"),
        ({"scale": "speed", "start": 0.1, "bounds": (1.0, 0.1)}, r"two finite numbers"),
        ({"scale": "none", "start": 0.0, "bounds": (0.0, 1.0)}, r"must be above 0 m/s, got 0"),
    ],
)
def test_a_range_that_contradicts_itself_is_refused(values, said):
    with pytest.raises(ParameterError, match=said):
        Quantity("v_s", "m/s", above=0, **values)


@pytest.mark.parametrize("scale", ["slope", "force/speed^0.5"])
def test_broken_powers_are_refused_beside_a_scale(scale):
    drag = Quantity("b", "N s^0.5/m^0.5", scale=scale, bounds=(0.0, 1.0), start=0.1)
    with pytest.raises(ParameterError, match=r"Law\.drag \(b\): .* powers must be whole"):
        drag.check_scale("Law", "drag")
    replace(drag, scale="none").check_scale("Law", "drag")


def test_a_scale_is_a_product_of_sizes():
    lag = Quantity("tau", "s", above=0, scale="displacement/speed", bounds=(0.1, 10.0), start=1.0)
    assert lag.scaled_by({"displacement": 1e-3, "speed": 0.5}) == 2e-3
    drag = Quantity("c", "N s^2/m^2", scale="force/speed^2", bounds=(0.0, 1.0), start=0.1)
    assert drag.scaled_by({"force": 8.0, "speed": 2.0}) == 2.0
