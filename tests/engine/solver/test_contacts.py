"""Mechanisms with several contacts against closed forms and independent references."""

import dataclasses
import itertools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from benchmarks.several.brakes import ClutchTrain, DiscBrake, Lining, Rotor
from tests.contact_cases import (
    FEET,
    Arm,
    Disc,
    Plain,
    RubbingCart,
    belt,
    chain,
    clutches,
    coulomb,
    decay,
    plates,
)
from tests.support import UNAIDED, example_of

from stickslip import (
    EventDriven,
    LuGre,
    PowerViscous,
    Stribeck,
    TwoFeet,
    ensemble,
    simulate,
)
from stickslip.engine import EventCount, EventTimes, Status
from stickslip.engine.kernels import driver
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.contacts import assembly
from stickslip.engine.kernels.contacts.assembly import determinant, refresh
from stickslip.engine.kernels.guard_roots import NO_GUARD
from stickslip.errors import InputError, UnknownNameError
from stickslip.maths import where
from stickslip.mechanisms import Contact
from stickslip.mechanisms.drives import Drive, Pulse, Ramp, Sampled

ARM = {"shoulder": coulomb(0.3, 0.45), "elbow": coulomb(0.12, 0.2)}
BENT = {"shoulder": 1.2, "elbow": 0.8}
PLAIN = EventDriven(tier="python")
ROUNDING = 5e-13
"""Ten times the differences between the references and the study that they were made for."""


def run_of(mechanism, laws, t_end, y0=None, **settings):
    """Simulate in plain Python; every run must be certified."""
    run = simulate(
        mechanism, laws, t_end=t_end, y0=y0, solver=EventDriven(tier="compiled", **settings)
    )
    assert run.certificate.stick_drift == 0.0
    return run


def changes(run):
    return [(e.t, e.contact, e.from_mode, e.to_mode) for e in run.events]


def assert_changes(run, expected, tolerance=ROUNDING):
    """Compare the first changes with expected ones (time, contact, before, after)."""
    for found, (t, *what) in zip(changes(run), expected, strict=False):
        assert found[1:] == tuple(what)
        assert found[0] == pytest.approx(t, abs=tolerance)


def test_two_blocks_on_a_belt():
    mechanism = chain(2)(coupling=1.2, stiffness=1.0, speed=0.1)
    run = run_of(mechanism, {"x1": coulomb(0.8, 1.2), "x2": coulomb(1.0, 1.6)}, 100.0)
    expected = [
        (12.0, "x1", 0, -1),
        (13.173165382902, "x2", 0, -1),
        (15.824802347452, "x2", -1, 0),
        (16.899887745347, "x1", -1, 0),
        (24.156583805901, "x2", 0, -1),
        (24.713701291792, "x1", 0, -1),
        (27.715601104454, "x1", -1, 0),
        (28.424900150430, "x2", -1, 0),
        (37.258265873467, "x1", 0, -1),
        (37.474747473004, "x2", 0, -1),
        (40.830444053253, "x2", -1, 0),
        (40.993806784030, "x1", -1, 0),
    ]
    assert len(run.events) == 28
    assert_changes(run, expected, 1e-12)
    assert run["x1"][-1] == pytest.approx(-9.156578295256672, abs=4e-14)
    assert run["x2"][-1] == pytest.approx(-9.038212618484783, abs=4e-14)
    # what friction took at each contact is its kinetic level times the slip, to rounding
    assert run.certificate.work["x1"] == pytest.approx(-0.8 * run["x1"][-1], rel=1e-14)
    assert run.certificate.work["x2"] == pytest.approx(-1.0 * run["x2"][-1], rel=1e-14)


def test_coupled_clutches_open_close_and_lock_as_in_closed_form():
    mechanism, laws, start = clutches()
    run = run_of(mechanism, laws, 1.5, start, tolerance=1e-12)
    moving = [change for change in changes(run) if change[2] != 3]
    times = {round(t, 9): (name, after) for t, name, _, after in moving}
    expected = {
        0.70962147469374666: ("clutch-2", 0),
        0.79166235915481601: ("clutch-1", 0),
        0.83110850613765324: ("clutch-1", None),
        0.90685019279787972: ("clutch-1", 0),
        1.0002958598946387: ("clutch-1", None),
        1.1439674924731660: ("clutch-3", 0),
        1.25: ("clutch-1", 3),
    }
    for t, (name, after) in expected.items():
        assert round(t, 9) in times, (t, times)
        assert times[round(t, 9)][0] == name
        assert after is None or times[round(t, 9)][1] == after
    speeds = np.cumsum([run[name][-1] for name in ("w", "u1", "u2", "u3")])
    angles = np.cumsum([run[name][-1] for name in ("phi", "r1", "r2", "r3")])
    locked = 2.463187166649595445
    np.testing.assert_allclose(speeds, [3.2470582724187950, locked, locked, locked], rtol=1e-10)
    np.testing.assert_allclose(
        angles,
        [7.4861190991143100, 4.1071374163294776, 2.7104644362313807, 1.1737438776005176],
        rtol=1e-10,
    )


def test_ten_blocks_on_a_belt():
    mechanism, laws = belt(10)
    run = run_of(mechanism, laws, 40.0)
    assert len(run.events) == 84
    assert_changes(run, [(10.1804, "x5", 0, -1)])
    assert run.events[-1].t == pytest.approx(39.9248065060, abs=1e-10)
    for name, value in (("x1", -3.427310976699), ("x10", -3.267046770092)):
        assert run[name][-1] == pytest.approx(value, abs=1e-12)
    assert run["v1"][-1] == pytest.approx(-0.216300001243, abs=1e-12)
    total = sum(abs(run[f"x{i}"][-1]) for i in range(1, 11))
    assert total == pytest.approx(33.2967458706, abs=1e-10)


@pytest.mark.parametrize(
    ("n", "events", "rest"), [(2, 34, 3.4006953165259), (10, 160, 3.6272709839596)]
)
def test_coupled_blocks_come_to_rest(n, events, rest):
    mechanism, laws, start = decay(n)
    run = run_of(mechanism, laws, 10.0, start)
    assert len(run.events) == events
    assert run.events[-1].t == pytest.approx(rest, abs=ROUNDING)
    if n == 10:
        assert run["x1"][-1] == pytest.approx(0.018857517895138, abs=3e-15)
        assert run["x10"][-1] == pytest.approx(-0.015876996463554, abs=3e-15)


def test_an_arm_whose_shoulder_turns_and_held_elbow_breaks_in_one_instant():
    run = run_of(Arm(), ARM, 7.2, BENT)
    expected = [
        (0.180631115300, "elbow", 1, -1),
        (0.600560195691, "elbow", -1, 1),
        (0.844137703384, "elbow", 1, -1),
        (0.879135477095, "shoulder", -1, 1),
        (1.118850690991, "elbow", -1, 1),
        (1.536241927959, "elbow", 1, -1),
        (1.653221625362, "elbow", -1, 0),
        (1.655020218989, "elbow", 0, 1),
        (1.749618177860, "shoulder", 1, -1),
    ]
    assert_changes(run, expected, 1e-11)
    end = run_of(Arm(), ARM, 6.0, BENT)
    assert end["shoulder"][-1] == pytest.approx(-0.5660082511329, abs=3e-12)
    assert end["elbow"][-1] == pytest.approx(-0.4030025089844, abs=3e-12)
    assert end["shoulder_dot"][-1] == pytest.approx(0.2564940308014, abs=3e-12)
    assert end["elbow_dot"][-1] == 0.0
    together = [e.contact for e in run.events if abs(e.t - 6.7939804445575) < 1e-11]
    assert together == ["shoulder", "elbow"]
    # another decision was possible there, and the certificate says so
    assert run.certificate.ambiguous >= 1
    assert any("another decision" in warning for warning in run.certificate.warnings)


def test_a_cart_whose_wheels_rub_under_their_reaction():
    laws = {"wheels": coulomb(0.05, 0.08), "pivot": coulomb(0.01, 0.015)}
    run = run_of(RubbingCart(), laws, 6.0, {"theta": 1.5})
    expected = [
        (0.053605432583, "wheels", 0, 1),
        (0.444874008545, "wheels", 1, -1),
        (0.593498034586, "pivot", -1, 1),
        (1.097431573088, "wheels", -1, 1),
        (1.161067038664, "pivot", 1, -1),
    ]
    assert len(run.events) == 21
    assert_changes(run, expected, 1e-11)
    last = [e.t for e in run.events if e.contact == "wheels"][-1]
    assert last == pytest.approx(4.612765334804, abs=1e-11)
    for name, value in (("x", -0.0748188604520), ("theta", -0.1592091101027)):
        assert run[name][-1] == pytest.approx(value, abs=6e-12)
    # the reaction carries the weight and what the pendulum pulls
    assert run["normal_force:wheels"].min() > 0.0


def test_two_feet_share_their_friction_by_what_they_carry():
    laws = {"front": coulomb(0.6, 0.7), "rear": coulomb(0.2, 0.3)}
    run = run_of(TwoFeet(**FEET), laws, 3.0, {"x": 0.9})
    times = sorted({round(e.t, 12) for e in run.events})
    quarter = math.pi / 5.0  # half a period of a mass on a spring, whatever the friction
    np.testing.assert_allclose(times[-3:], [quarter, 2 * quarter, 3 * quarter], atol=1e-12)
    at = run.at([quarter, 2 * quarter, 3 * quarter])
    turns = [-0.64774285714286, 0.32668831168831, -0.07443116883117]
    np.testing.assert_allclose(at["x"], turns, atol=2e-13)
    end = run.at([2.5])
    assert end["normal_force:front"][0] == pytest.approx(8.96446753246753, abs=1e-11)
    assert end["normal_force:rear"][0] == pytest.approx(10.65553246753247, abs=1e-11)
    assert abs(end["friction:front"][0]) == pytest.approx(2.4655593, abs=1e-6)
    assert abs(end["friction:rear"][0]) == pytest.approx(1.2559991, abs=1e-6)


def test_pads_at_two_radii_share_what_holds_the_disc():
    laws = {"inner": coulomb(0.4, 0.5), "outer": coulomb(0.3, 0.4)}
    run = run_of(Disc(), laws, 8.0, {"omega": 20.0})
    kinetic = 0.1 * 40.0 + 0.12 * 24.0
    # momentum 0.5 * 20 = kinetic * t - 1.5 t^2 / 2
    stop = (kinetic - math.sqrt(kinetic**2 - 2.0 * 1.5 * 10.0)) / 1.5
    leave = (0.1 * 50.0 + 0.12 * 32.0) / 1.5
    assert [e.t for e in run.events] == pytest.approx([stop, stop, leave, leave], abs=1e-13)
    held = run.at([4.0])
    share = 6.0 / (0.1 * 50.0 + 0.12 * 32.0)
    assert held["friction:inner"][0] == pytest.approx(50.0 * share, rel=1e-13)
    assert held["friction:outer"][0] == pytest.approx(32.0 * share, rel=1e-13)
    assert run["phi"][-1] == pytest.approx(29.998614147705, abs=1e-12)
    assert run["omega"][-1] == pytest.approx(14.9152, abs=1e-12)


def test_four_plates_change_in_one_instant():
    mechanism, laws, start = plates(5)
    run = run_of(mechanism, laws, 10.0, start)
    assert run.status is Status.AT_REST
    assert len(run.events) == 19
    for moment in (1.035602997230, 1.738084470335):
        assert len([e for e in run.events if abs(e.t - moment) < 1e-11]) == 4
    assert run.events[-1].t == pytest.approx(3.143047416543, abs=1e-11)
    places = [0.3250229735843, -0.4023756675690, 0.0802731019416, 0.0431602535399, -0.0522982800728]
    found = [run[f"r{i}"][-1] for i in range(1, 6)]
    np.testing.assert_allclose(found, places, atol=3e-12)


# Invariants


def test_uncoupled_copies_move_as_one_alone():
    alone = run_of(chain(1)(stiffness=4.0), coulomb(0.5, 0.6), 5.0, {"x1": 1.0})
    laws = {f"x{i}": coulomb(0.5, 0.6) for i in (1, 2, 3)}
    run = run_of(chain(3)(stiffness=4.0), laws, 5.0, {f"x{i}": 1.0 for i in (1, 2, 3)})
    for i in (1, 2, 3):
        own = [e.t for e in run.events if e.contact == f"x{i}"]
        assert own == pytest.approx([e.t for e in alone.events], abs=1e-14)
        assert run[f"x{i}"][-1] == pytest.approx(alone["x1"][-1], abs=1e-14)


def test_a_mirrored_chain_moves_as_its_mirror_image():
    mechanism, laws, start = decay(4)
    names = [f"x{i}" for i in range(1, 5)]
    turned = {name: laws[other] for name, other in zip(names, names[::-1], strict=True)}
    back = {f"v{i}": start[f"v{5 - i}"] for i in range(1, 5)}
    run, other = run_of(mechanism, laws, 10.0, start), run_of(mechanism, turned, 10.0, back)
    assert len(run.events) == len(other.events)
    for name, mirror in zip(names, names[::-1], strict=True):
        assert run[name][-1] == pytest.approx(other[mirror][-1], abs=1e-12)


def test_friction_stays_within_its_levels_and_never_drives():
    run = run_of(Arm(), ARM, 6.0, BENT).sampled(2000)
    for name, law in ARM.items():
        friction, rate = run[f"friction:{name}"], run[f"{name}_dot"]
        assert np.all(np.abs(friction) <= law.static_coefficient * (1.0 + 1e-12))
        assert np.all(friction * rate >= 0.0)
        held = run[f"mode:{name}"] == 0
        assert np.all(rate[held] == 0.0)


# Tiers and ensembles


@pytest.mark.parametrize("case", ["arm", "plates", "clutches", "cart"])
def test_both_tiers_agree_to_the_last_bit(case):
    mechanism, laws, start, t_end = {
        "arm": (Arm(), ARM, BENT, 3.0),
        "plates": (*plates(5), 4.0),
        "clutches": (*clutches(), 1.5),
        "cart": (
            RubbingCart(), {"wheels": coulomb(0.05, 0.08), "pivot": coulomb(0.01, 0.015)},
            {"theta": 1.5}, 3.0,
        ),
    }[case]  # fmt: skip
    runs = [
        simulate(mechanism, laws, t_end=t_end, y0=start, solver=EventDriven(tier=tier))
        for tier in ("python", "compiled")
    ]
    assert changes(runs[0]) == changes(runs[1])
    for name in runs[0].names:
        np.testing.assert_array_equal(runs[0][name], runs[1][name])


@pytest.mark.parametrize("case", ["decay", "belt", "arm", "plates", "clutches", "feet", "mixed"])
def test_laws_that_are_kept_within_a_decision_are_those_that_would_be_asked_again(
    case, monkeypatch
):
    mechanism, laws, start, t_end = {
        "decay": (*decay(5), 4.0),
        "belt": (*belt(4), None, 20.0),
        "arm": (Arm(), ARM, BENT, 3.0),
        "plates": (*plates(5), 4.0),
        "clutches": (*clutches(), 1.5),
        "feet": (TwoFeet(**FEET), coulomb(0.3, 0.4), {"v": 1.0}, 0.2),
        "mixed": (Arm(), MIXED, BENT, 0.1),
    }[case]

    def run():
        return simulate(mechanism, laws, t_end=t_end, y0=start, solver=PLAIN)

    kept = run()
    monkeypatch.setattr(
        assembly, "reconsider",
        lambda w, iw: refresh(w[layout.TIME], w, iw, iw[layout.Y]),
    )  # fmt: skip
    afresh = run()
    assert changes(kept) == changes(afresh)
    for name in kept.names:
        np.testing.assert_array_equal(kept[name], afresh[name])


def test_series_reach_a_few_events_ahead(monkeypatch):
    """Far beyond the next event their terms, and the search for guards, would be wasted."""
    mechanism, laws, start = decay(40)
    lengths, attempt = [], driver.attempt

    def noted(h, *rest):
        lengths.append(h)
        return attempt(h, *rest)

    monkeypatch.setattr(driver, "attempt", noted)
    run = simulate(mechanism, laws, t_end=1.0, y0=start, solver=PLAIN)
    assert len(run.events) > 50
    assert sum(lengths) < 10.0  # 7.3; 14.3 where the time between events is not followed


@pytest.mark.parametrize("first", [0.5, 2.0])
def test_the_mean_time_between_events_is_followed(first):
    w = [math.inf] * 20
    driver.note_rhythm(NO_GUARD, 7.0, w)
    assert w[layout.RHYTHM] == math.inf
    driver.note_rhythm(0, first, w)
    assert w[layout.RHYTHM] == first
    for _ in range(100):
        driver.note_rhythm(0, 1.0, w)
    assert w[layout.RHYTHM] == pytest.approx(1.0, abs=0.9**100)
    driver.note_rhythm(NO_GUARD, 3.0, w)  # a whole series without an event
    assert w[layout.RHYTHM] == 3.0


def test_an_ensemble_varies_the_law_of_one_contact():
    levels = np.array([0.15, 0.2, 0.25])
    runs = ensemble(
        Arm(), ARM, {"friction.elbow.static_coefficient": levels}, t_end=2.0, y0=BENT,
        solver=EventDriven(tier="python"),
    )  # fmt: skip
    assert runs.certified.all()
    for value, found in zip(levels, runs["shoulder"], strict=True):
        laws = ARM | {"elbow": coulomb(0.12, float(value))}
        assert found == run_of(Arm(), laws, 2.0, BENT)["shoulder"][-1]


@pytest.mark.parametrize("tier", ["python", "compiled"])
def test_an_ensemble_keeps_the_events_of_one_contact(tier):
    outputs = {
        "away": EventTimes("break-away", count=3, contact="elbow"),
        "last": EventTimes("reversal", count=-2, contact="shoulder"),
        "turns": EventCount("reversal", contact="elbow"),
        "all": EventCount("reversal"),
    }
    runs = ensemble(
        Arm(), ARM, {"friction.elbow.kinetic_coefficient": [0.12]}, t_end=3.0, y0=BENT,
        outputs=outputs, solver=EventDriven(tier=tier),
    )  # fmt: skip
    run = run_of(Arm(), ARM, 3.0, BENT)
    times = {
        (contact, reason): [e.t for e in run.contact(contact).events if e.reason == reason]
        for contact in run.contacts
        for reason in ("break-away", "reversal")
    }
    away, turns = times["elbow", "break-away"], times["elbow", "reversal"]
    assert 0 < len(away) < 3
    assert runs["away"][0, : len(away)].tolist() == away
    assert np.isnan(runs["away"][0, len(away) :]).all()
    assert runs["last"][0].tolist() == times["shoulder", "reversal"][:-3:-1]
    assert runs["turns"][0] == len(turns)
    assert runs["all"][0] == len(turns) + len(times["shoulder", "reversal"])
    with pytest.raises(UnknownNameError, match=r"contact of events 'elbo'.*'elbow'"):
        ensemble(
            Arm(), ARM, {"friction.elbow.kinetic_coefficient": [0.12]}, t_end=1.0,
            outputs={"away": EventTimes("break-away", contact="elbo")},
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Row(Plain):
    """Sixty blocks of 1 kg side by side, which one drive pushes."""

    name: ClassVar[str] = "row"
    coordinates: ClassVar[tuple[str, ...]] = tuple(f"q{i}" for i in range(60))
    rates: ClassVar[tuple[str, ...]] = tuple(f"v{i}" for i in range(60))
    units: ClassVar[tuple[str, ...]] = ("m",) * 60
    push: Drive

    def kinetic_energy(self, q, q_dot):
        return sum((0.5 * q_dot[i] * q_dot[i] for i in self.coordinates), 0.0)

    def forces(self, t, q, q_dot, drives):
        return dict.fromkeys(self.coordinates, drives["push"])

    def drives(self):
        return {"push": self.push}

    def contacts(self):
        return tuple(Contact(name=f"pad-{i}", slip=i, load=1.0) for i in self.coordinates)


@pytest.mark.parametrize("tier", ["python", "compiled"])
@pytest.mark.parametrize("late", [-1, 0, 1])
def test_many_contacts_stop_and_break_away_where_a_drive_jumps(tier, late):
    """Blocks at 0.5 m/s stop under 0.5 m/s^2 after a second, give or take a rounding."""
    speed = 0.5 + late * math.ulp(0.4)
    row = Row(push=Pulse(level=-2.0, duration=1.0, start=1.0))
    run = simulate(
        row, coulomb(0.5), t_end=1.5, y0=dict.fromkeys(row.rates, speed),
        solver=EventDriven(tier=tier),
    )  # fmt: skip
    assert [e.t for e in run.events] == pytest.approx([1.0] * len(run.events), abs=1e-15)
    assert {e.contact for e in run.events} == set(run.contacts)
    for i in row.coordinates:  # 1.5 m/s^2 backwards from a second on
        assert run[i][-1] == pytest.approx(0.25 - 0.75 * 0.5**2, abs=1e-14)


# What cannot be done is said


def test_a_contact_without_a_name_or_law_is_named():
    with pytest.raises(InputError, match="no law is given for the contact 'elbow'"):
        simulate(Arm(), {"shoulder": coulomb(0.1)}, t_end=1.0)
    with pytest.raises(UnknownNameError, match="elbow"):
        simulate(Arm(), ARM | {"elbo": coulomb(0.1)}, t_end=1.0)


def test_loads_that_two_feet_do_not_determine_are_refused():
    @dataclasses.dataclass(frozen=True, kw_only=True)
    class OneSupport(TwoFeet):
        def held(self):
            return ("y",)

        def contacts(self):
            return tuple(
                dataclasses.replace(contact, slip="x", normal="y") for contact in super().contacts()
            )

    laws = {"front": coulomb(0.6), "rear": coulomb(0.2)}
    with pytest.raises(InputError, match="loads of front, rear are not determined"):
        simulate(OneSupport(**FEET), laws, t_end=1.0)


# Faults that were found by attack


def two(force, load=None):
    """Return two unit masses with a contact each, and a force on the first."""

    @dataclasses.dataclass(frozen=True, kw_only=True)
    class Two(Plain):
        name = "two"
        coordinates, rates, units = ("x1", "x2"), ("v1", "v2"), ("m", "m")

        def kinetic_energy(self, q, q_dot):
            return 0.5 * (q_dot["x1"] * q_dot["x1"] + q_dot["x2"] * q_dot["x2"])

        def forces(self, t, q, q_dot, drives):
            return {"x1": force(t, q_dot)}

        def contacts(self):
            return (Contact(slip="x1", load=1.0, name="a"), Contact(slip="x2", load=1.0, name="b"))

        def loads(self, t, q, q_dot, drives):
            return {} if load is None else {"a": load(t)}

    return Two()


HALF = {"a": coulomb(0.5), "b": coulomb(0.5)}


def test_a_coordinate_that_leaves_at_once_stops_no_other():
    run = run_of(two(lambda t, v: 0.5 + 0.1 * t), HALF, 3.0, {"v2": 10.0})
    assert run["x2"][-1] == pytest.approx(10.0 * 3.0 - 0.25 * 9.0, rel=1e-14)
    assert run["x1"][-1] == pytest.approx(0.1 * 27.0 / 6.0, rel=1e-12)


@pytest.mark.parametrize("kind", UNAIDED.values(), ids=lambda kind: kind.name)
def test_each_law_moves_a_block_as_it_does_alone(kind):
    law = example_of(kind)
    alone = run_of(chain(1)(stiffness=4.0), law, 1.0, {"x1": 0.5, "v1": 0.3})
    run = run_of(chain(2)(stiffness=4.0), {"x1": law, "x2": None}, 1.0, {"x1": 0.5, "v1": 0.3})
    assert run["x1"][-1] == pytest.approx(alone["x1"][-1], abs=1e-7)


def test_drag_that_sets_in_with_the_motion_is_that_of_the_closed_form():
    law = PowerViscous(kinetic_coefficient=0.3, viscous_coefficient=2.0, viscous_exponent=2.0)
    pad = Lining(radius=0.1, load=10.0)
    brake = DiscBrake(inertia=0.5, pads=(pad,), drive=Pulse(level=1.0, duration=9.0))
    run = run_of(brake, law, 5.0)
    # of v = r omega: v' = r / J (T - r (3 N + 2 v^2)) = 0.14 - 0.04 v^2; below 1e-6 m/s drag is a
    # straight line, which changes the speed by less than 1e-12 of it
    speed = math.sqrt(3.5) * math.tanh(math.sqrt(0.14 * 0.04) * 5.0)
    assert run["omega"][-1] == pytest.approx(10.0 * speed, rel=1e-9)


def test_a_torque_that_sets_in_while_all_clutches_are_open_moves_its_rotor():
    train = ClutchTrain(
        rotors=(Rotor(inertia=0.2), Rotor(inertia=0.3, torque=Ramp(rate=6.0))),
        clutches=(Lining(radius=0.1, press=Ramp(rate=-1.0)),),
    )
    law = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.9, stribeck_velocity=0.01)
    run = run_of(train, law, 2.0)
    assert run["psi1"][-1] == pytest.approx(20.0 * 2.0**3 / 6.0, rel=1e-12)
    assert run["phi"][-1] == pytest.approx(0.0, abs=1e-12)


def test_a_foot_that_breaks_away_and_lifts_off_in_one_instant_has_its_events_in_order():
    push = Pulse(level=90.0, duration=1.0, start=0.5)
    body = TwoFeet(mass=2.0, front=0.1, rear=0.3, height=0.09, drive=push)
    # friction lifts the rear foot where mu h > a
    run = simulate(body, coulomb(1.5), t_end=1.0, throw=False, solver=PLAIN)
    assert run.status is Status.LIFT_OFF
    for name in ("front", "rear"):
        own = run.contact(name).events
        assert all(a.to_mode == b.from_mode for a, b in itertools.pairwise(own))
    assert run.events[-1].reason == "lift-off"


def test_a_force_that_is_switched_on_in_time_moves_what_rested():
    run = run_of(two(lambda t, v: where(t > 1.0, 2.0, 0.0)), HALF, 3.0)
    assert run["x1"][-1] == pytest.approx(0.5 * 1.5 * 4.0, rel=1e-12)


def test_a_load_that_is_switched_off_in_time_lets_go():
    run = run_of(two(lambda t, v: 0.3, lambda t: where(t > 1.0, 0.0, 1.0)), HALF, 3.0)
    assert [e.reason for e in run.events] == ["opens"]
    assert run["x1"][-1] == pytest.approx(0.5 * 0.3 * 4.0, rel=1e-12)


def test_a_load_that_falls_to_zero_and_stays_there_opens_the_contact():
    mechanism, laws, start = clutches()
    falling = Sampled(times=(0.0, 0.4, 0.6), values=(0.0, 20.0, 0.0))
    run = run_of(dataclasses.replace(mechanism, second=falling), laws, 0.8, start)
    assert [e.reason for e in run.events if e.contact == "clutch-2"] == ["closes", "opens"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Gated(Plain):
    """Two unit masses with a contact each: a gate gives the first its force, or its load."""

    name = "gated"
    coordinates, rates, units = ("x1", "x2"), ("v1", "v2"), ("m", "m")

    gate: Drive
    nested: bool = False
    on_load: bool = False
    weak: bool = False

    def drives(self):
        return {"gate": self.gate}

    def kinetic_energy(self, q, q_dot):
        return 0.5 * (q_dot["x1"] * q_dot["x1"] + q_dot["x2"] * q_dot["x2"])

    def forces(self, t, q, q_dot, drives):
        if self.on_load:
            return {"x1": 0.3}
        gate = drives["gate"]
        if self.weak:
            return {"x1": where(gate > 0.5, 0.1 * gate, gate, ("gate opens", "gate shuts"))}
        most = where(gate > 2.5, 3.0, 2.0, ("most", "less")) if self.nested else 2.0
        return {"x1": where(gate > 0.5, most, 0.0, ("gate opens", "gate shuts"))}

    def contacts(self):
        return (Contact(slip="x1", load=1.0, name="a"), Contact(slip="x2", load=1.0, name="b"))

    def loads(self, t, q, q_dot, drives):
        return {"a": where(drives["gate"] > 0.5, 0.0, 1.0)} if self.on_load else {}


@pytest.mark.parametrize("tier", ["python", "compiled"])
def test_a_switch_of_the_mechanism_turns_where_a_drive_jumps(tier):
    solver = EventDriven(tier=tier)
    gate = Pulse(level=1.0, duration=0.5, start=1.0)
    run = simulate(Gated(gate=gate), HALF, t_end=3.0, solver=solver)
    # 2 N against 0.5 N for 0.5 s, then friction alone: 0.75 m/s is lost in 1.5 s
    assert [(e.t, e.reason) for e in run.events if e.reason.startswith("gate")] == [
        (1.0, "gate opens"), (1.5, "gate shuts"),
    ]  # fmt: skip
    assert run["x1"][-1] == pytest.approx(0.75**2 / 3.0 + 0.75**2, rel=1e-12)
    both = Gated(gate=dataclasses.replace(gate, level=3.0), nested=True)
    run = simulate(both, HALF, t_end=4.5, solver=solver)
    named = {e.reason: e.t for e in run.events if e.reason in {"most", "gate opens", "gate shuts"}}
    assert named == {"most": 1.0, "gate opens": 1.0, "gate shuts": 1.5}
    assert run["x1"][-1] == pytest.approx(1.25**2 / 5.0 + 1.25**2, rel=1e-12)
    run = simulate(Gated(gate=gate, on_load=True), HALF, t_end=2.5, solver=solver)
    # without its load 0.3 N move it for 0.5 s, which friction less that takes away in 0.75 s
    assert [(e.t, e.reason) for e in run.events if e.contact == "a" and e.reason][:2] == [
        (1.0, "opens"), (1.5, "closes"),
    ]  # fmt: skip
    assert run["x1"][-1] == pytest.approx(0.15**2 / 0.6 + 0.15**2 / 0.4, rel=1e-12)


def test_the_force_before_a_switch_moves_nothing_where_drive_and_switch_jump_at_once():
    gate = Pulse(level=3.0, duration=0.5, start=1.0)
    run = run_of(Gated(gate=gate, weak=True), HALF, 3.0)
    # 0.3 N are held; 3 N, had the gate not opened, would break away
    assert [(e.t, e.reason) for e in run.events] == [(1.0, "gate opens"), (1.5, "gate shuts")]
    assert np.all(run["x1"] == 0.0)


def test_a_switch_of_the_mechanism_follows_a_rate_that_stops():
    run = run_of(two(lambda t, v: where(v["x2"] > 0.0, 1.0, 0.0)), HALF, 2.0, {"v2": 0.25})
    # the first is pushed until the second rests, at 0.5 s
    assert run["v1"][-1] == 0.0
    assert run["x1"][-1] == pytest.approx(0.5 * 0.5 * 0.25 + 0.25**2 / (2 * 0.5), rel=1e-12)


RESTING = LuGre(
    kinetic_coefficient=0.5, static_coefficient=0.7, stribeck_velocity=0.05,
    bristle_stiffness=1e3, bristle_damping=20.0, static_switch=True,
)  # fmt: skip


@pytest.mark.parametrize(
    ("start", "t_end", "rig", "expected"),
    [
        ({"v1": 1.0}, 3.0, {"stiffness": 4.0}, ["reversal", "stop"]),
        ({}, 12.0, {"stiffness": 1.0, "speed": 0.1}, ["break-away", "stop"]),
    ],
    ids=["comes to rest", "stick-slip"],
)
def test_a_rule_for_rest_beside_bristles_holds_as_it_does_alone(start, t_end, rig, expected):
    settings = {"t_end": t_end, "y0": start, "solver": EventDriven(tier="python")}
    alone = simulate(chain(1)(**rig), RESTING, **settings)
    laws = {"x1": RESTING, "x2": coulomb(0.5, 0.7)}
    run = simulate(chain(2)(**rig), laws, **settings)
    own = [e for e in run.events if e.contact == "x1"]
    assert [e.reason for e in own] == [e.reason for e in alone.events] == expected
    times = [e.t for e in own], [e.t for e in alone.events]
    np.testing.assert_allclose(*times, rtol=1e-8)
    assert run["x1"][-1] == pytest.approx(alone["x1"][-1], abs=1e-8)
    assert run["z:x1"][-1] == pytest.approx(alone["z"][-1], abs=1e-8)
    assert run.certificate.stick_drift == 0.0


def test_feet_at_different_heights_are_refused():
    @dataclass(frozen=True, kw_only=True)
    class Uneven(TwoFeet):
        def contacts(self):
            front, rear = super().contacts()
            return (front, dataclasses.replace(rear, slip={"x": 1.0, "phi": 0.05}))

    with pytest.raises(InputError, match="same height"):
        simulate(Uneven(**FEET), {"front": coulomb(0.6), "rear": coulomb(0.2)}, t_end=1.0)


LUGRE_ELBOW = LuGre(
    kinetic_coefficient=0.12, static_coefficient=0.2, stribeck_velocity=0.05,
    bristle_stiffness=2e3, bristle_damping=5.0, viscous_coefficient=0.01,
)  # fmt: skip
MIXED = {"shoulder": coulomb(0.3, 0.45), "elbow": LUGRE_ELBOW}
TURNS = (0.8768957186, 1.7489498347, 2.6127205821, 3.4661826336)
MIXED_END = (-0.23711148370, -0.25252786446, -2.3627837060, -2.3245753654)


def assert_mixed(run, until, rel):
    """Compare with SciPy's Radau at 1e-13."""
    turns = [e.t for e in run.events if e.contact == "shoulder"]
    np.testing.assert_allclose(turns, [t for t in TURNS if t < until], rtol=rel)


@pytest.mark.slow
def test_mixed_joints_to_the_digits_of_the_reference():
    solver = EventDriven(tier="compiled", stiff_tolerance=1e-12)
    run = simulate(Arm(), MIXED, t_end=4.0, y0=BENT, solver=solver)
    assert_mixed(run, 4.0, 5e-11)  # half a unit of the last digit printed
    end = [run[name][-1] for name in ("shoulder", "elbow", "shoulder_dot", "elbow_dot")]
    np.testing.assert_allclose(end, MIXED_END, atol=6e-11)


def test_rates_of_bristles_see_the_reaction_of_the_same_instant():
    """With loads that are reactions, the run must not depend on what was asked before."""
    feet = TwoFeet(**FEET)
    law = dataclasses.replace(LUGRE_ELBOW, bristle_damping=0.1)
    start = {feet.rates[0]: 0.8}
    iw = simulate(feet, law, t_end=0.2, y0=start, solver=EventDriven(tier="python"))
    half = simulate(feet, law, t_end=0.1, y0=start, solver=EventDriven(tier="python"))
    state = {name: half[name][-1] for name in (*feet.coordinates, *feet.rates, "z:front", "z:rear")}
    rest = simulate(feet, law, t_end=0.1, y0=state, solver=EventDriven(tier="python"))
    for name in state:
        assert rest[name][-1] == pytest.approx(iw[name][-1], rel=1e-6, abs=1e-12)


def test_needed_friction_that_is_just_the_level_holds():
    """With equal rotors, what holds one clutch while the next slips is just its level."""
    train = ClutchTrain(
        rotors=[Rotor(inertia=1.0)] * 5,
        clutches=[Lining(radius=1.0, press=Pulse(level=20.0, duration=1.0, start=0.1 * i))
                  for i in range(4)],
    )  # fmt: skip
    start = {"omega": 10.0, "psi1_dot": -10.0}
    for static in (0.5, 0.55):
        run = run_of(train, coulomb(0.5, static), 1.2, start)
        assert [e.contact for e in run.events if e.reason == "stop"] == [
            f"clutch-{i}" for i in (2, 3, 4, 1)
        ]


def test_a_cart_that_starts_off_the_ground_ends_there():
    cart = RubbingCart(ball_mass=2.0, cart_mass=0.1)
    laws = {"wheels": coulomb(0.05), "pivot": coulomb(0.01)}
    # at the top the ball pulls with m (l omega^2 - g)
    run = simulate(
        cart, laws, t_end=1.0, y0={"theta": math.pi, "omega": 20.0}, throw=False, solver=PLAIN
    )
    assert run.status is Status.LIFT_OFF
    assert run.span == (0.0, 0.0)
    assert [event.reason for event in run.events] == ["lift-off"]
    assert run["normal_force:wheels"][-1] < 0.0


def test_reactions_that_nothing_determines_have_no_determinant():
    rows = [1.0, 1.0, 3.0, 1.0, 1.0, 4.0]
    assert determinant(rows, 0, 2) == 0.0
