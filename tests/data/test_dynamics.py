"""What a check says of forces that are missing or cannot have caused the motion."""

import dataclasses
import os
from pathlib import Path

import numpy as np
import pytest

from stickslip import (
    Axis,
    CoulombViscous,
    MatrixMechanism,
    Measurement,
    SpringBlock,
    TowedBlock,
    check,
    simulate,
)
from stickslip.data import guess_data, read_data, refuse_faults, swing_of
from stickslip.data.checking.data_quality import faults
from stickslip.mechanisms import Contact
from stickslip.mechanisms.drives import Drive, Sampled

AXIS = Axis(inertia=5.0)
SPRUNG = Axis(inertia=1.0, stiffness=40.0)
LAW = CoulombViscous(kinetic_coefficient=10.0, viscous_coefficient=30.0)
TIME = np.arange(3000) / 500


@pytest.fixture(scope="module")
def driven():
    """Position and force of an axis, with the noise of an encoder."""
    force = 40 * np.sin(2 * np.pi * TIME) + 15 * np.sin(2.3 * TIME)
    drive = Sampled(times=TIME.tolist(), values=force.tolist())
    run = simulate(dataclasses.replace(AXIS, drive=drive), LAW, t_end=float(TIME[-1]))
    noise = np.random.default_rng(1).normal(0, 1e-5, TIME.size)
    return {"time": TIME, "position": run.at(TIME)["x"] + noise, "force": force}


def decay(axis, start, law=None, *, noise=1e-5):
    law = CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=0.1) if law is None else law
    run = simulate(axis, law, t_end=float(TIME[-1]), y0=start)
    steps = np.random.default_rng(2).normal(0, noise, TIME.size)
    return Measurement(time=TIME, position=run.at(TIME)["x"] + steps)


def doubts(measurement, mechanism=None):
    found = check(measurement, mechanism=mechanism).findings
    return [f for f in found if f.kind in ("drive", "units", "trials") and f.severity != "info"]


# --- a force that is missing


def test_a_force_that_is_missing_is_said_to_be(driven):
    (said, *_) = check(Measurement(time=TIME, position=driven["position"])).of("drive")
    assert said.severity == "info"
    assert said.sentence.startswith("Neither force nor reference is given")
    assert check(Measurement(**driven)).of("drive") == ()


def test_friction_that_was_measured_needs_no_force(driven):
    measured = Measurement(time=TIME, position=driven["position"], friction=driven["force"])
    assert check(measured).of("drive") == ()


@pytest.mark.parametrize("force", [None, 0.0, 12.0])
def test_energy_from_nowhere_is_an_error_where_nothing_drives_the_mechanism(driven, force):
    parts = {**driven, "force": None if force is None else np.full(TIME.size, force)}
    (sentence,) = doubts(Measurement(**parts), AXIS)
    assert sentence.severity == "error"
    assert "gains energy" in sentence.sentence
    assert "whether the force is missing" in sentence.sentence
    # what moves it is not known without a mechanism
    (sentence,) = doubts(Measurement(**parts))
    assert sentence.severity == "warning"


@pytest.mark.parametrize(
    ("axis", "start"),
    [
        (SPRUNG, {"x": 0.3}),
        (Axis(inertia=1.0, stiffness=40.0, offset=2.0), {"x": 0.3}),
        (Axis(inertia=1.0), {"v": 0.7}),
        (Axis(inertia=1.0, offset=0.4), {"v": 0.7}),
        (Axis(inertia=1.0, lower_stop=-0.2, upper_stop=0.2, restitution=0.8), {"v": 1.7}),
        (SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True), {}),
    ],
)
@pytest.mark.parametrize("noise", [1e-6, 1e-3])
def test_a_free_decay_gains_no_energy(axis, start, noise):
    law = CoulombViscous(kinetic_coefficient=0.05, viscous_coefficient=0.1)
    record = decay(axis, start, law, noise=noise)
    assert doubts(record, axis) == []
    assert doubts(record) == []


@pytest.mark.parametrize("rate", [12.0, 14.0])
@pytest.mark.parametrize("seed", range(3))
def test_a_decay_with_few_samples_of_each_swing_gains_no_energy(rate, seed):
    # the filter of the position takes off the speed that it has when it is let go
    time = np.arange(0.0, 20.0, 1.0 / rate)
    position = np.exp(-time / 30.0) * np.cos(2.0 * np.pi * time)
    position += 0.004 * np.random.default_rng(seed).normal(size=len(time))
    swing = Axis(inertia=1.0, stiffness=(2.0 * np.pi) ** 2)
    assert doubts(Measurement(time=time, position=position), swing) == []


def test_a_swing_without_a_spring_that_could_bring_it_back_is_an_error():
    record = decay(SPRUNG, {"x": 0.3})
    assert doubts(record, Axis(inertia=1.0)) == []  # no force is missing
    (sentence,) = check(record, mechanism=Axis(inertia=1.0)).of("mechanism")
    assert sentence.severity == "error"
    # accelerations of a decay with Coulomb friction, through the low pass of both sides
    assert sentence.numbers["stiffness"] == pytest.approx(40.0, rel=0.02)


def test_a_swing_that_never_gets_less_is_a_warning():
    position = 0.1 * np.sin(np.sqrt(40.0) * TIME)
    (sentence,) = doubts(Measurement(time=TIME, position=position), SPRUNG)
    assert sentence.severity == "warning"
    assert sentence.numbers["kept"] == pytest.approx(
        1.0, abs=0.01
    )  # filters take less than a percent


def test_a_record_in_closed_loop_or_of_a_towed_block_may_gain_energy(driven):
    position = driven["position"]
    loop = Measurement(time=TIME, position=position, reference=position)
    assert doubts(loop, AXIS) == []
    towed = TowedBlock(mass=1.0, stiffness=10.0, speed=0.1)
    assert doubts(Measurement(time=TIME, position=position), towed) == []


@dataclasses.dataclass(frozen=True, kw_only=True)
class Sprung(MatrixMechanism):
    """A mass on a spring, by its forces."""

    name, coordinates, rates, units = "sprung", ("x",), ("v",), ("m",)
    drive: Drive | None = None
    speed: float = 0.0

    def mass_matrix(self, q):
        return [[1.0]]

    def forces(self, t, q, q_dot, drives):
        return {"x": drives["drive"] - 40.0 * (q["x"] - self.speed * t)}

    def potential_energy(self, t, q):
        return 20.0 * (q["x"] - self.speed * t) ** 2

    def contacts(self):
        return (Contact(slip="x", load=1.0),)

    def drives(self):
        return {} if self.drive is None else {"drive": self.drive}


def test_mechanisms_by_their_matrices_are_checked_alike(driven):
    assert doubts(decay(SPRUNG, {"x": 0.3}), Sprung()) == []
    bare = Measurement(time=TIME, position=driven["position"])
    assert [f.severity for f in doubts(bare, Sprung())] == ["error"]
    # the far end of its spring is a drive as well
    assert doubts(bare, Sprung(speed=0.1)) == []


# --- factors of units


def test_a_force_that_fits_its_motion_is_not_doubted(driven):
    assert doubts(Measurement(**driven), AXIS) == []
    # nobody knows a mass so badly; fits look for it from there
    assert doubts(Measurement(**driven), Axis(inertia=1.0)) == []


@pytest.mark.parametrize(
    ("name", "factor", "seen", "cure"),
    [
        ("position", 350.0, 1 / 350.0, "not mm"),  # a thousand would be faster than a bullet
        ("force", 1e-3, 1e-3, "not kN"),
        ("time", 1e3, 1e6, "not ms"),
        ("force", 1e3, 1e3, "not mN"),
    ],
)
def test_a_factor_of_a_thousand_is_an_error_with_its_cure(driven, name, factor, seen, cure):
    parts = {**driven, name: factor * driven[name]}
    wrong = [f for f in doubts(Measurement(**parts), AXIS) if f.severity == "error"]
    assert len(wrong) == 1
    assert cure in wrong[0].sentence
    # friction, noise and the filter leave the regression a few percent of the inertia
    assert wrong[0].numbers["factor"] == pytest.approx(seen, rel=0.05)


@pytest.mark.parametrize("factor", [1e-3, 0.05, 1e3])
@pytest.mark.parametrize("vary", ["inertia", ["mechanism.inertia"]])
def test_a_mass_that_is_fitted_is_compared_with_nothing(driven, factor, vary):
    measured = Measurement(**{**driven, "force": factor * driven["force"]})
    assert doubts(measured, AXIS)
    assert not check(measured, mechanism=AXIS, vary=vary).of("units")
    refuse_faults(measured, AXIS, vary)


def test_the_unit_of_the_inertia_is_that_of_an_axis_that_turns(driven):
    parts = {**driven, "force": 20.0 * driven["force"]}
    assert "5 kg m^2" in doubts(Measurement(**parts, turning=True), AXIS)[0].sentence


def test_a_factor_of_a_spring_is_seen_as_that_of_a_mass():
    force = 40 * np.sin(2 * np.pi * 0.2 * TIME) + 20 * np.sin(9 * TIME)
    drive = Sampled(times=TIME.tolist(), values=force.tolist())
    run = simulate(dataclasses.replace(SPRUNG, drive=drive), LAW, t_end=float(TIME[-1]))
    position = run.at(TIME)["x"]
    good = Measurement(time=TIME, position=position, force=force)
    wrong = Measurement(time=TIME, position=1e3 * position, force=force)
    assert doubts(good, SPRUNG) == []
    assert "error" in {f.severity for f in doubts(wrong, SPRUNG)}


def test_a_force_that_has_nothing_to_do_with_the_motion_has_no_factor(driven):
    other = np.random.default_rng(4).normal(0, 20, TIME.size)
    assert doubts(Measurement(**{**driven, "force": other}), AXIS) == []


def test_times_that_no_controller_keeps_are_questioned_without_a_mechanism(driven):
    (sentence,) = doubts(Measurement(**{**driven, "time": 1e3 * TIME}))
    assert "check that times are in seconds." in sentence.sentence
    slow = Measurement(time=1e3 * TIME, position=driven["position"], friction=driven["force"])
    assert doubts(slow) == []  # rock is sampled once a second


# --- trials, and errors alone


def test_trials_must_have_the_same_drive(driven):
    whole = Measurement(**driven, name="a")
    bare = Measurement(time=TIME, position=driven["position"], name="b")
    first, *_ = doubts(Measurement(trials=(whole, bare)))
    assert (first.kind, first.severity) == ("trials", "error")
    assert first.sentence.startswith("Force was measured in 'a' but not in 'b'")
    assert (
        check(Measurement(trials=(whole, dataclasses.replace(whole, name="c")))).of("trials") == ()
    )


def test_faults_are_the_errors_of_a_check(driven):
    t, x, force = TIME, driven["position"], driven["force"]
    v = np.gradient(x, t)
    records = [
        Measurement(**driven),
        Measurement(time=t, position=x),
        Measurement(time=t, position=0 * x, force=force),
        Measurement(time=t, position=np.random.default_rng(0).normal(size=t.size), force=force),
        Measurement(time=t, position=1e3 * x, force=force),
        Measurement(time=t, position=x, velocity=1e3 * v, force=force),
        Measurement(time=t, velocity=v, friction=-v),
        Measurement(velocity=[-2.0, -1.0, 1.0, 2.0], friction=[2.0, 1.2, -1.2, -2.0]),
        Measurement(time=t[:5], position=x[:5]),
        Measurement(time=t, position=x, force=1e70 * force),
        Measurement(time=t, position=x, overrides={"mechanism.mas": 1.0}),
        Measurement(travel=0.0),
    ]
    errors = 0
    for record in [*records, Measurement(trials=tuple(records[:2]))]:
        whole = check(record, mechanism=AXIS).findings
        assert faults(record, mechanism=AXIS) == tuple(f for f in whole if f.severity == "error")
        errors += bool(faults(record, mechanism=AXIS))
    assert errors == len(records)  # all but the first, and the trials


@pytest.mark.parametrize(
    ("dataset", "record"),
    [("simple_pendulum_drive", "energy_shaping_1kg"), ("two_link_arm", "143339")],
)
def test_a_torque_that_does_not_tell_the_inertia_tells_no_weight(dataset, record):
    # of the pendulum of 1 kg the torque would tell 19 kg, of the arm that of both links
    folder = Path(os.environ.get("STICKSLIP_DATA", "missing"), dataset)
    if not folder.exists():
        pytest.skip("needs STICKSLIP_DATA")
    file = folder / f"{record}.parquet"
    guess = guess_data(file)
    read = read_data([file], dataclasses.replace(guess.reading, by="options"))
    assert guess.turning
    assert swing_of(read) is None


def test_a_torque_that_holds_a_weight_still_tells_it():
    t = np.arange(0.0, 20.0, 0.01)
    angle = 0.8 * np.sin(3.0 * t) + 0.3 * np.sin(1.1 * t)
    torque = 0.5 * np.gradient(np.gradient(angle, t), t) + 4.0 * np.sin(angle)
    found = swing_of(Measurement(time=t, position=angle, force=torque, turning=True))
    assert found.inertia == pytest.approx(0.5, rel=0.01)  # of a second difference
    assert found.stiffness == pytest.approx(8.0, rel=0.01)
