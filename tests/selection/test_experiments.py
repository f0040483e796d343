"""Measurements that are proposed next: predictions against closed forms, and their doubt."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    DirectionDependent,
    Measurement,
    SpringBlock,
    TowedBlock,
    Viscous,
)
from stickslip.kinds.records.design.experiments import design
from stickslip.kinds.records.design.predictors import Predictor
from stickslip.kinds.records.next_measurements import reach_of


def designed(candidates, *, speed=0.5, force=0.01, length=1e-4, driven=True, **more):
    """Return proposed measurements by the start of what is to be done."""
    found = design(
        candidates,
        best=next(iter(candidates)),
        speed=speed,
        force_doubt=lambda seconds: force,
        length_doubt=length,
        driven=driven,
        **more,
    )
    return {" ".join(one.what.replace(",", "").split()[:2]): one for one in found}, found


def at(law, mechanism, load=1.0, **told):
    return Predictor(law=law, mechanism=mechanism, load=load, **told)


def test_a_constant_speed_takes_friction_damper_and_offset_of_each_candidate():
    first = at(Coulomb(kinetic_coefficient=2.0), Axis(inertia=1.0, damping=3.0, offset=0.5))
    second = at(Viscous(viscous_coefficient=4.0), Axis(inertia=1.0))
    _, found = designed({"first": first, "second": second})
    steady = {one.what.split(", ")[1]: one for one in found if one.what.startswith("Constant")}
    # the slowest speed tells most: 2 + .005 * 3 +- .5 against .02
    assert steady["forwards"].what == "Constant speed of 5 mm/s, forwards, 10 s."
    assert steady["forwards"].predicted == pytest.approx({"first": 2.515, "second": 0.02})
    assert steady["backwards"].predicted == pytest.approx({"first": 1.515, "second": 0.02})
    assert steady["forwards"].separation == pytest.approx((2.515 - 0.02) / 0.01)


def test_a_coasting_body_goes_as_far_as_its_own_mass_and_offset_let_it():
    law = Coulomb(kinetic_coefficient=2.0)
    candidates = {
        "light": at(law, Axis(inertia=1.0, offset=0.5)),
        "heavy": at(law, Axis(inertia=3.0, offset=-0.5)),
    }
    _, found = designed(candidates)
    coast = {one.what.split()[1]: one for one in found if one.what.startswith("Coast")}
    # m v^2 / 2 (F + o) with v = .5 m/s
    assert coast["forwards"].predicted == pytest.approx({"light": 0.05, "heavy": 0.25})
    assert coast["backwards"].predicted == pytest.approx({"light": 0.125 / 1.5, "heavy": 0.15})
    assert coast["backwards"].separation == pytest.approx((0.15 - 0.125 / 1.5) / 1e-4)


def test_what_is_the_same_with_offsets_counted_is_not_told_apart():
    levels = DirectionDependent(
        forward_kinetic_coefficient=2.5,
        backward_kinetic_coefficient=1.5,
        forward_viscous_coefficient=1.0,
        backward_viscous_coefficient=1.0,
    )
    middle = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=1.0)
    candidates = {
        "levels": at(levels, Axis(inertia=1.0)),
        "offset": at(middle, Axis(inertia=1.0, offset=0.5)),
    }
    assert designed(candidates)[1] == ()


def test_the_doubt_of_a_prediction_is_that_of_its_parameters():
    told = {
        "estimates": {"friction.kinetic_coefficient": 2.0, "friction.viscous_coefficient": 4.0},
        "errors": np.array([0.1, 0.4]),
    }
    law, axis = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=4.0), Axis(inertia=1.0)
    rival = at(Coulomb(kinetic_coefficient=0.1), axis)
    for together in (0.0, -1.0):
        correlation = np.array([[1.0, together], [together, 1.0]])
        chosen = at(law, axis, **told, correlation=correlation)
        _, found = designed({"chosen": chosen, "rival": rival}, speed=0.25, driven=False)
        first = found[0]
        v = float(first.what.split()[3]) / 1e3
        doubt = np.sqrt(0.1**2 + (0.4 * v) ** 2 + 2.0 * together * 0.1 * 0.4 * v)
        assert first.doubts == pytest.approx({"chosen": doubt, "rival": 0.0}, abs=1e-12)
        assert first.separation == pytest.approx((1.9 + 4.0 * v) / np.hypot(0.01, doubt))
        # where both errors cancel, at 250 mm/s, is where to measure
        assert together == 0.0 or v == 0.25


def test_what_a_record_left_open_tells_nothing_apart():
    law, axis = Coulomb(kinetic_coefficient=2.0), Axis(inertia=1.0)
    other = at(Coulomb(kinetic_coefficient=1.0), axis)
    told = {"estimates": {"friction.kinetic_coefficient": 2.0}, "correlation": np.eye(1)}
    known = at(law, axis, **told, errors=np.array([0.1]))
    assert designed({"chosen": known, "other": other}, driven=False)[1]
    unknown = at(law, axis, **told, errors=np.array([np.inf]))  # then known to its own size
    assert designed({"chosen": unknown, "other": other}, driven=False)[1] == ()


def test_measured_friction_is_predicted_under_its_load():
    axis = Axis(inertia=1.0)
    low, high = Coulomb(kinetic_coefficient=0.4), Coulomb(kinetic_coefficient=0.5)
    found = designed({"low": at(low, axis, 5.0), "high": at(high, axis, 5.0)}, driven=False)[1]
    assert {one.observed for one in found} == {"friction, N"}
    assert found[0].predicted == pytest.approx({"low": 2.0, "high": 2.5})


def test_what_a_spring_holds_is_not_left_to_coast():
    laws = {"slow": Viscous(viscous_coefficient=4.0), "fast": Viscous(viscous_coefficient=1.0)}
    for mechanism, coasts in ((Axis(inertia=1.0), True), (Axis(inertia=1.0, stiffness=9.0), False)):
        found = designed({name: at(law, mechanism) for name, law in laws.items()})[1]
        assert found
        assert any(one.what.startswith("Coast") for one in found) is coasts


@pytest.mark.slow
def test_below_break_away_only_bristles_give_way():
    axis = Axis(inertia=0.1)
    stiff, level = 1e4, 2.0
    bristles = at(Dahl(kinetic_coefficient=level, bristle_stiffness=stiff), axis)
    rigid = at(Coulomb(kinetic_coefficient=level), axis)
    _, found = designed({"bristles": bristles, "rigid": rigid}, force=10.0, length=1e-6)
    (push,) = [one for one in found if "alternating" in one.what]
    assert push.what.startswith("An alternating force of amplitude 1.6 N")
    assert push.predicted["rigid"] == pytest.approx(0.0, abs=1e-12)
    # from one reversal to the next, df/dx = (sigma / F_c) (1 - f) from f = -.8 to .8
    expected = level / stiff * np.log(1.8 / 0.2)
    # read at 200 instants, of a body that rings on its bristles by 1e-3 of the deflection
    assert push.predicted["bristles"] == pytest.approx(expected, rel=2e-3)


def test_mechanisms_without_a_drive_are_not_asked_to_move():
    laws = {"slow": Viscous(viscous_coefficient=4.0), "fast": Viscous(viscous_coefficient=1.0)}
    towed = TowedBlock(mass=1.0, stiffness=100.0, speed=0.1)
    found = designed({name: at(law, towed, 9.81) for name, law in laws.items()})[1]
    assert found
    assert all(one.what.startswith("Constant") for one in found)


def test_what_turns_is_told_in_angles_and_torques():
    laws = {"level": Coulomb(kinetic_coefficient=2.0), "slope": Viscous(viscous_coefficient=4.0)}
    found = design(
        {name: at(law, Axis(inertia=1.0)) for name, law in laws.items()},
        best="level",
        speed=3.0,
        force_doubt=lambda seconds: 0.01,
        length_doubt=1e-3,
        driven=True,
        turning=True,
    )
    said = {one.what.split()[0]: one for one in found}
    assert "rad/s" in said["Constant"].what
    assert said["Constant"].observed == "drive torque, N m"
    assert said["Coast"].observed == "angle to the stop, rad"
    assert "mm" not in " ".join(one.what for one in found)


def test_one_law_alone_needs_no_measurement():
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    assert designed({"coulomb": at(Coulomb(kinetic_coefficient=0.2), block, 9.81)})[1] == ()


LEVELS = {"low": Coulomb(kinetic_coefficient=2.0), "high": CoulombViscous(
    kinetic_coefficient=2.0, viscous_coefficient=4.0
)}  # fmt: skip


def of_axis(laws, **axis):
    return {name: at(law, Axis(inertia=1.0, **axis)) for name, law in laws.items()}


@pytest.mark.parametrize("stroke", [0.03, 0.2, 0.9, 4.0])
def test_a_constant_speed_is_kept_no_longer_than_the_stroke_allows(stroke):
    # the laws differ by 4 v, so that the highest speed tells most: that of the record
    _, found = designed(of_axis(LEVELS), speed=0.5, reach=(1.0, 1.0 + stroke))
    steady = [one.what for one in found if one.what.startswith("Constant speed of 500 mm/s")]
    assert len(steady) == 2
    for what in steady:
        seconds = float(re.search(r"([\d.]+) s( within .*)?[,.]", what)[1])
        # a sine of that speed and stroke takes half of it to gain the speed and to lose it
        room = stroke / 2.0
        # two digits of the time, rounded down
        assert 0.89 * room < 0.5 * seconds <= room * (1.0 + 1e-12)
        assert f"within the stroke of {1e3 * stroke:g} mm." in what


def test_a_speed_that_fits_the_stroke_is_run_as_it_is_without_one():
    free = designed(of_axis(LEVELS), speed=0.05)[1]
    held = designed(of_axis(LEVELS), speed=0.05, reach=(0.0, 10.0))[1]
    assert [one.what for one in held if one.what.startswith("Constant")] == [
        one.what for one in free if one.what.startswith("Constant")
    ]


def test_passes_in_a_small_stroke_are_worth_their_time_in_all():
    asked = []

    def doubt(seconds):
        asked.append(seconds)
        return 0.01

    laws = {name: at(law, Axis(inertia=1.0)) for name, law in LEVELS.items()}
    told = {"best": "low", "length_doubt": 1e-4, "driven": False, "force_doubt": doubt}
    design(laws, speed=0.5, reach=(0.0, 0.01), **told)
    # 5 mm at 0.5 m/s is 10 ms; twenty of them are asked for at most
    assert min(asked) == pytest.approx(0.2)


def test_where_no_position_was_measured_it_is_said_what_stroke_a_speed_takes():
    _, found = designed(of_axis(LEVELS), speed=0.5, reach=None)
    steady = [one.what for one in found if one.what.startswith("Constant")]
    assert "Constant speed of 500 mm/s, forwards, 10 s, over 5000 mm." in steady


def test_a_coast_that_leaves_the_stroke_begins_slower():
    candidates = {
        "light": at(LEVELS["low"], Axis(inertia=1.0)),
        "heavy": at(LEVELS["low"], Axis(inertia=3.0)),
    }
    # m v^2 / 2 F is 0.1875 m for the heavy one from 0.5 m/s, 0.0169 m from 0.15 m/s
    for stroke, speeds in ((0.3, {"500"}), (0.2, {"150"}), (0.0005, set())):
        _, found = designed(candidates, length=1e-5, force=10.0, reach=(0.0, stroke))
        coasts = [one for one in found if one.what.startswith("Coast")]
        assert {one.what.split()[3] for one in coasts} == speeds
        assert all(max(one.predicted.values()) <= stroke for one in coasts)


def test_between_stops_a_coast_goes_as_far_as_without_them():
    free = {"low": (0.0, 1.0), "high": (0.0, 3.0)}
    found = []
    for stops in ({}, {"lower_stop": -0.05, "upper_stop": 0.55}):
        candidates = {
            name: at(LEVELS["low"], Axis(inertia=mass, **stops)) for name, (_, mass) in free.items()
        }
        made = designed(candidates, force=10.0, reach=(-0.05, 0.55))[1]
        found.append({one.what: one.predicted for one in made if one.what.startswith("Coast")})
    assert found[0].keys() == found[1].keys() != set()
    for what, predicted in found[0].items():
        assert predicted == pytest.approx(found[1][what])


def test_no_coast_into_a_stop_is_proposed():
    stops = {"lower_stop": -0.12, "upper_stop": 0.12}
    candidates = {
        "low": at(LEVELS["low"], Axis(inertia=1.0, **stops)),
        "heavy": at(LEVELS["low"], Axis(inertia=9.0, **stops)),
    }
    _, found = designed(candidates, length=1e-5, force=10.0, reach=(-0.12, 0.12))
    coasts = [one for one in found if one.what.startswith("Coast")]
    # 9 kg go 0.56 m from 500 mm/s, .05 m from 150 mm/s
    assert {one.what.split()[3] for one in coasts} == {"150"}
    assert all(max(one.predicted.values()) < 0.12 for one in coasts)


def test_a_stroke_in_which_bristles_do_not_settle_is_not_run_at_constant_speed():
    axis = Axis(inertia=1.0)
    laws = {
        "soft": Dahl(kinetic_coefficient=2.0, bristle_stiffness=1e3),  # gives way by 2 mm
        "rigid": Coulomb(kinetic_coefficient=1.0),
    }
    candidates = {name: at(law, axis) for name, law in laws.items()}
    for stroke, some in ((0.1, True), (0.005, False)):
        found = designed(candidates, driven=False, reach=(0.0, stroke))[1]
        assert bool(found) is some


def moved(position, *, mechanism=None, turning=False):
    """What of a fit says where its body moves."""
    time = np.arange(len(position))
    record = Measurement(time=time, position=position, turning=turning)
    return SimpleNamespace(measurement=record, mechanism=mechanism or Axis(inertia=1.0))


def test_a_body_moves_between_its_stops_or_where_it_was_measured():
    assert reach_of(moved([0.1, 0.4, 0.2])) == (0.1, 0.4)
    stopped = Axis(inertia=1.0, lower_stop=-0.5, upper_stop=1.0)
    assert reach_of(moved([0.1, 0.4], mechanism=stopped)) == (-0.5, 1.0)
    one_stop = Axis(inertia=1.0, lower_stop=-0.5)
    assert reach_of(moved([0.1, 0.4], mechanism=one_stop)) == (-0.5, 0.4)
    speeds = Measurement(time=[0.0, 1.0], velocity=[0.1, 0.2])
    blind = SimpleNamespace(measurement=speeds, mechanism=Axis(inertia=1.0))
    assert reach_of(blind) is None


def test_what_turned_by_more_than_a_full_turn_may_turn_on():
    assert reach_of(moved([0.0, 6.0], turning=True)) == (0.0, 6.0)
    assert reach_of(moved([0.0, 6.5], turning=True)) == (-np.inf, np.inf)
    assert reach_of(moved([0.0, 6.5])) == (0.0, 6.5)


def test_records_with_zeros_of_their_own_do_not_make_a_longer_stroke():
    trials = tuple(
        Measurement(time=[0.0, 1.0], position=[start, start + length])
        for start, length in ((0.0, 0.2), (5.0, 0.3))
    )
    fit = SimpleNamespace(measurement=Measurement(trials=trials), mechanism=Axis(inertia=1.0))
    assert reach_of(fit) == (5.0, 5.3)
