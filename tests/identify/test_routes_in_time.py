import dataclasses
import math

import numpy as np
import pytest

from stickslip import (
    Axis,
    CoulombViscous,
    DirectionDependent,
    Measurement,
    RecordSettings,
    SpringBlock,
    Viscous,
    fit,
    load_rig,
    simulate,
)
from stickslip.errors import InputError, UnknownNameError
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse

TRUTH = CoulombViscous(kinetic_coefficient=6.0, viscous_coefficient=4.0)


def tracked():
    """Return a record of an axis under a controller that follows a reference, without noise."""
    axis = Axis(inertia=2.0, stiffness=800.0, damping=60.0)
    t = np.arange(0.0, 12.0, 0.01)
    asked = 0.05 * np.sin(2 * math.pi * 0.4 * t) + 0.03 * np.sin(2 * math.pi * 0.9 * t + 1.0)
    force = axis.stiffness * asked + axis.damping * np.gradient(asked, t)
    drive = PiecewiseLinear(times=t.tolist(), values=force.tolist())
    run = simulate(dataclasses.replace(axis, drive=drive), TRUTH, t_end=float(t[-1]))
    return axis, Measurement(time=t, position=run.at(t)["x"], reference=asked)


@pytest.mark.slow
def test_a_record_in_closed_loop_gives_the_friction_that_made_it():
    axis, record = tracked()
    found = fit(axis, CoulombViscous, record)
    # reversals are known to a sample of 10 ms, some fifty between them
    assert found.law.kinetic_coefficient == pytest.approx(6.0, rel=0.02)
    assert found.law.viscous_coefficient == pytest.approx(4.0, rel=0.25)


def test_a_closed_loop_needs_the_gains_of_its_controller():
    _, record = tracked()
    with pytest.raises(InputError, match=r"gains as stiffness \[N/m\] and damping \[N s/m\]"):
        fit(Axis(inertia=2.0), CoulombViscous, record)
    turning = dataclasses.replace(record, turning=True)
    with pytest.raises(InputError, match=r"stiffness \[N m/rad\] .* \[N m s/rad\] .* the torque"):
        fit(Axis(inertia=2.0), CoulombViscous, turning)


def decay():
    rig = SpringBlock(mass=1.0, stiffness=400.0, compression=0.1, attached=True)
    law = CoulombViscous(kinetic_coefficient=0.02, viscous_coefficient=0.3)
    t = np.arange(0.0, 6.0, 0.005)
    return rig, law, Measurement(time=t, position=simulate(rig, law, t_end=6.0).at(t)["x"])


def test_a_fit_is_written_as_a_rig_file_that_simulates(tmp_path):
    rig, _, record = decay()
    found = fit(rig, Viscous, record)
    found.save(tmp_path / "law.toml")
    read = load_rig(tmp_path / "law.toml")
    assert read.laws["viscous"] == found.law
    assert read.mechanism == found.mechanism


def test_a_route_that_is_not_known_is_refused():
    rig, _, record = decay()
    with pytest.raises(UnknownNameError, match="balance"):
        fit(rig, Viscous, record, route="balanc")


def test_a_recorded_force_of_zero_leaves_a_free_decay_what_it_is():
    rig, _, record = decay()
    pushed = dataclasses.replace(rig, drive=Pulse(level=50.0, duration=1.0))  # not in the record
    at_rest = dataclasses.replace(record, force=np.zeros_like(record.time))
    found = fit(pushed, CoulombViscous, at_rest)
    assert found.estimates == fit(rig, CoulombViscous, record).estimates


def test_a_free_decay_with_a_gap_is_fitted_on_both_sides_of_it():
    rig, law, record = decay()
    seen = (record.time < 2.0) | (record.time > 2.4)
    holed = Measurement(time=record.time[seen], position=record.position[seen])
    found = fit(rig, CoulombViscous, holed)
    assert found.law.kinetic_coefficient == pytest.approx(law.kinetic_coefficient, rel=0.02)
    assert found.law.viscous_coefficient == pytest.approx(law.viscous_coefficient, rel=0.02)


def test_a_free_decay_gives_its_law_back_by_its_balance():
    rig, law, record = decay()
    found = fit(rig, CoulombViscous, record)
    assert found.verdict.route == "balance"
    assert found.law.kinetic_coefficient == pytest.approx(law.kinetic_coefficient, rel=0.02)
    assert found.law.viscous_coefficient == pytest.approx(law.viscous_coefficient, rel=0.02)


def test_what_a_record_does_not_tell_has_no_interval():
    v = np.linspace(0.05, 0.5, 200)
    friction = 3.0 + 4.0 * v + 0.1 * np.random.default_rng(3).normal(size=v.size)
    found = fit(Axis(inertia=1.0), DirectionDependent, Measurement(velocity=v, friction=friction))
    bounded = {one.path for one in found.estimates if one.bounded}
    assert bounded == {  # nothing slips backward
        "friction.forward_kinetic_coefficient", "friction.forward_viscous_coefficient",
    }  # fmt: skip


def test_an_order_of_hold_that_is_not_known_is_refused():
    with pytest.raises(UnknownNameError, match="hold in RecordSettings 'second'"):
        RecordSettings(hold="second")


def test_measured_friction_tells_no_inertia():
    table = Measurement(
        velocity=np.linspace(-1.0, 1.0, 40), friction=np.sign(np.linspace(-1, 1, 40))
    )
    with pytest.raises(InputError, match=r"tells nothing of mechanism\.inertia"):
        fit(
            Axis(inertia=1.0, load=5.0),
            CoulombViscous,
            table,
            vary=["friction.*", "mechanism.inertia"],
        )


def test_a_record_under_a_load_that_changes_is_fitted_by_a_balance_unasked():
    t = np.arange(0.0, 12.0, 0.004)
    v = 0.1 * (np.sin(2.5 * t) + 0.6 * np.sin(4.3 * t + 1.0))
    x = np.concatenate([[0.0], np.cumsum(0.002 * (v[1:] + v[:-1]))])
    load = 50.0 * 2.0 ** np.sin(1.3 * t)
    force = 2.0 * np.gradient(v, t) + 0.3 * load * np.sign(v) + 40.0 * v
    force += 0.1 * np.random.default_rng(2).normal(size=len(t))
    found = fit(
        Axis(inertia=2.0), CoulombViscous, Measurement(time=t, position=x, force=force, load=load)
    )
    assert found.verdict.route == "balance"
    assert found.law.kinetic_coefficient == pytest.approx(0.3, rel=0.01)
