"""Tables of laws of measured servos: how much less a law errs, and what is left out."""

import numpy as np
import pytest
from benchmarks.friction.definition import error_of_segments
from benchmarks.servos import SERVO, SETS, SWING, SWINGS, swing, table

from stickslip import CoulombViscous, Measurement, Pendulum, fit


def row(place, law, errors, **more):
    found = [
        ["friction.kinetic_coefficient", "mu_k", 0.1, 0.05, 0.15, ""],
        ["mechanism.drive.resistance", "R", 4.0, 3.0, 5.0, ""],
        ["mechanism.drive.torque_constant", "k_t", 0.4, 0.0, 0.0, "not identified"],
    ]
    held_out = {str(i): error for i, error in enumerate(errors)}
    return {"set": place, "law": law, "held_out": held_out, "loop": [0.05], "found": found} | more


def test_the_ratio_of_errors_is_taken_part_by_part_with_its_interval():
    rows = [row(SERVO, "bam-m1", [0.02, 0.04, 0.16]), row(SERVO, "bam-m3", [0.01, 0.02, 0.04])]
    lines = [*table(rows)]
    assert lines[0] == "bam_xl330:"
    plain, gear = (line.split(" | ") for line in lines[3:])
    # logarithms log 2, log 2 and log 4: their mean, and Student's t for two degrees of freedom
    half = 4.302653 * np.log(2.0) / 3.0
    low, high = 2.0 ** (4.0 / 3.0) * np.exp([-half, half])
    assert gear[2] == f"{2.0 ** (4.0 / 3.0):.2f} ({low:.2f} to {high:.2f})"
    assert plain[2] == gear[3] == "-"
    # over the law of M3, the plain one errs as much more
    assert plain[3] == f"{2.0 ** (-4.0 / 3.0):.2f} ({1.0 / high:.2f} to {1.0 / low:.2f})"
    assert gear[-2:] == ["4 (3 to 5)", "0.4 (no interval) |"]


def test_each_set_has_a_table_and_a_law_that_failed_says_why():
    rows = [row(SWING, "coulomb", [0.01, 0.02]), {"set": SERVO, "law": "bam-m6", "error": "no."}]
    lines = [*table(rows)]
    assert [line for line in lines if not line.startswith("|")] == [f"{place}:" for place in SETS]
    # without the law that others are compared with, there is no ratio
    assert lines[-1].startswith("| coulomb | 15.8 ± 5.0 | - | 0.1 (0.05 to 0.15) |")
    assert all(line.count("|") == lines[2].count("|") for line in lines[1:4])
    assert "no." in lines[3]


@pytest.mark.slow
def test_records_of_the_pendulum_end_before_anybody_pushes_it(data_dir):
    records = [swing(name) for name in SWINGS]
    for record in records:
        assert record.time[-1] <= SWINGS[record.name.partition(" ")[2]]
    found = fit(
        Pendulum(mass=0.74, length=0.5, rest_angle=0.0),
        CoulombViscous,
        Measurement(trials=tuple(records), name="pendulum"),
        vary=["friction.*", "mechanism.mass", "mechanism.inertia", "mechanism.rest_angle"],
    )
    # one law has every segment; who is pushed is 120 mrad away from it
    errors = [error_of_segments(found, record, 0.5).value for record in records]
    assert max(errors) < 0.01
