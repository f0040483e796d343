"""Six laws of servo motors against the formulas of their source, with its published values."""

import math
import random

import pytest

from stickslip.friction import LAWS, bound

PUBLISHED = {
    "bam-m1": {"friction_base": 0.01821167858833861, "friction_viscous": 0.005902005392322235},
    "bam-m2": {
        "friction_base": 0.018601492795417476,
        "friction_stribeck": 0.0011012778060184916,
        "dtheta_stribeck": 0.2612676462986131,
        "alpha": 3.9999999983129455,
        "friction_viscous": 0.004047971379756858,
    },
    "bam-m3": {
        "friction_base": 0.002319691753871906,
        "load_friction_base": 0.26407734798146426,
        "friction_viscous": 0.016903883836368913,
    },
    "bam-m4": {
        "friction_base": 0.0021521768302085447,
        "friction_stribeck": 0.0004142783877571575,
        "load_friction_base": 0.25158745242367064,
        "load_friction_stribeck": 0.052028475872390546,
        "dtheta_stribeck": 0.11780576795939068,
        "alpha": 1.0000158406484074,
        "friction_viscous": 0.017819710915700462,
    },
    "bam-m5": {
        "friction_base": 0.0020391814934009656,
        "friction_stribeck": 5.468352862616111e-09,
        "load_friction_motor": 0.23007570268448654,
        "load_friction_external": 0.25825760438071466,
        "load_friction_motor_stribeck": 5.004477566346946e-07,
        "load_friction_external_stribeck": 0.11700810706121324,
        "dtheta_stribeck": 0.22258733082429977,
        "alpha": 2.3288381456131346,
        "friction_viscous": 0.018686549517152658,
    },
    "bam-m6": {
        "friction_base": 0.0023258418670152347,
        "friction_stribeck": 0.0001856264715700908,
        "load_friction_motor": 0.23063000784446322,
        "load_friction_external": 0.26077932692372613,
        "load_friction_motor_stribeck": 1.9157733081388423e-06,
        "load_friction_external_stribeck": 0.15158776983752117,
        "load_friction_motor_quad": 0.005595958708218643,
        "load_friction_external_quad": 0.0037747149629857673,
        "dtheta_stribeck": 0.11532863880939243,
        "alpha": 1.000022697315946,
        "friction_viscous": 0.0185448141303962,
    },
}
"""Values of a Dynamixel XL330 by the names of their files (github.com/Rhoban/bam, bam/params/xl330,
commit 11bb7ec and, of M2, 0186bd0; Apache-2.0)."""

FIELDS = {
    "friction_base": "kinetic_coefficient",
    "load_friction_base": "transmitted_coefficient",
    "load_friction_stribeck": "transmitted_static_surplus",
    "load_friction_motor": "motor_friction",
    "load_friction_external": "external_friction",
    "load_friction_motor_stribeck": "motor_static_friction",
    "load_friction_external_stribeck": "external_static_friction",
    "load_friction_motor_quad": "motor_quadratic",
    "load_friction_external_quad": "external_quadratic",
    "dtheta_stribeck": "stribeck_velocity",
    "alpha": "fading_exponent",
    "friction_viscous": "viscous_coefficient",
}


def published(p, motor, external, speed):
    """Return Coulomb-like and viscous friction as the source prints them."""
    left = math.exp(-(abs(speed / p.get("dtheta_stribeck", 1.0)) ** p.get("alpha", 1.0)))
    found = p["friction_base"] + left * p.get("friction_stribeck", 0.0)
    found += p.get("load_friction_base", 0.0) * abs(external - motor)
    found += left * p.get("load_friction_stribeck", 0.0) * abs(external - motor)
    for end, share in (("", 1.0), ("_stribeck", left)):
        of_external = external * p.get(f"load_friction_external{end}", 0.0)
        of_motor = motor * p.get(f"load_friction_motor{end}", 0.0)
        found += share * abs(of_external - of_motor)
    if motor * external < 0.0:
        smaller, side = min((abs(external), "external"), (abs(motor), "motor"))
        found += left * p.get(f"load_friction_{side}_quad", 0.0) * smaller**2
    return found, p["friction_viscous"]


def made(name):
    """Return the law with the published values, and these."""
    p = PUBLISHED[name]
    values = {FIELDS[key]: value for key, value in p.items() if key in FIELDS}
    if "friction_stribeck" in p:
        values["static_coefficient"] = p["friction_base"] + p["friction_stribeck"]
    return LAWS[name](**values), p


@pytest.mark.parametrize("name", PUBLISHED)
def test_friction_and_damping_are_those_of_the_source_at_50_random_states(name):
    one, p = made(name)
    rng = random.Random(0)
    for _ in range(50):
        motor, external = rng.gauss(0.0, 0.5), rng.gauss(0.0, 0.5)
        v = rng.choice((-1.0, 1.0)) * 10.0 ** rng.uniform(-3.0, 1.0)
        told = bound(one, {"motor": motor, "external": external, "transmitted": motor - external})
        level, damping = published(p, motor, external, v)
        assert told.force(v, 1.0) - damping * v == pytest.approx(math.copysign(level, v), rel=1e-13)
        held, _ = published(p, motor, external, 0.0)
        assert told.break_away(1.0) == pytest.approx(held, rel=1e-13)


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_values_that_a_law_calls_typical_are_the_published_ones(name):
    one, _ = made(name)
    assert one.typical.source == "duclusaud2025"
    for field, value in one.typical.values.items():
        # six digits stand in the entry
        assert getattr(one, field) == pytest.approx(value, rel=1e-4, abs=1e-9)


def test_each_of_the_six_contains_those_before_it():
    chain = {
        "bam-m6": ["bam-m5"],
        "bam-m5": ["bam-m4"],
        "bam-m4": ["stribeck", "bam-m3"],
        "bam-m3": ["coulomb-viscous"],
    }
    for name, inner in chain.items():
        assert {*inner} <= {one.law for one in LAWS[name].contained}
