"""Start values and bounds of the laws of the package, of sizes that a measurement told."""

from dataclasses import replace

import pytest
from tests.support import UNAIDED

from stickslip.errors import ParameterError
from stickslip.identify.fits import starting_law
from stickslip.identify.fits.shooting.start_values import StartEstimate
from stickslip.quantities import Quantity, fields_of

SEEN = {
    "offset": 0.0, "force": 4.4, "load": 2.0, "speed": 0.5, "two_sided": True, "stiffness": 1e4,
}  # fmt: skip
ROUGH = StartEstimate(
    level=2.0,
    viscous=0.5,
    sides=(
        StartEstimate(level=2.5, viscous=0.6, **SEEN),
        StartEstimate(level=1.5, viscous=0.4, **SEEN),
    ),
    **SEEN,
)
# Start and bounds by hand: friction reaches 4.4 N / 2 N.
MAPPED = {
    "kinetic_coefficient": (2.0, 0.0, 220.0),
    "static_coefficient": (2.4, 0.0, 240.0),
    "forward_kinetic_coefficient": (1.5, 0.0, 220.0),
    "backward_kinetic_coefficient": (2.5, 0.0, 250.0),
    "viscous_coefficient": (0.5, 0.0, 880.0),
    "forward_viscous_coefficient": (0.4, 0.0, 880.0),
    "backward_viscous_coefficient": (0.6, 0.0, 880.0),
    "quadratic_coefficient": (0.176, 0.0, 1760.0),
    "stribeck_velocity": (0.05, 5e-5, 5.0),
    "bristle_stiffness": (1e4, 1.0, 1e8),
    "bristle_damping": (0.04, 0.0, 440.0),
    "fading_exponent": (None, 0.03, 50.0),
    "yield_exponent": (None, 0.02, 30.0),
    "viscous_exponent": (1.0, 0.2, 1.5),
}
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
OLD = {
    name: kind
    for name, kind in UNAIDED.items()
    if {*fields_of(kind)} <= {*MAPPED, "break_away_coefficient"} and name != "power-viscous"
}
"""Laws whose parameters all have names of this list, and so the ranges above.

Left out is a law that gives one of these names another range.
"""
assert {"coulomb", "stribeck", "lugre"} <= OLD.keys()


@pytest.mark.parametrize("kind", OLD.values(), ids=OLD)
def test_force_maps_look_where_they_did(kind):
    law = ROUGH.law(kind, {})
    items = ROUGH.free_parameters(law, [f"friction.{name}" for name in fields_of(kind)], None).items
    assert items
    for item in items:
        name = item.path.partition(".")[2]
        start, low, high = MAPPED[name]
        start = getattr(law, name) if start is None else start
        if item.quantity.above is not None and low == 0.0 and not item.above:
            low = 1e-9 * 2.2
        assert (item.start, item.low, item.high) == pytest.approx((start, low, high), rel=1e-12)
        decades = ("stribeck_velocity", "bristle_stiffness")
        assert item.log is (name in decades or name.endswith("_exponent"))


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
