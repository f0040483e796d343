"""Closed loops around several contacts and drives, and their dynamics as numbers."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from tests.contact_cases import Plain
from tests.pair_cases import LAW, LAWS, OTHER, Pair, axis

from stickslip import Coulomb, EventDriven, SerialArm, TwoFeet, TwoLinkArm, simulate
from stickslip.engine.formulation import JointTorques
from stickslip.errors import InputError, ParameterError
from stickslip.mechanisms import Contact, Link
from stickslip.mechanisms.drives import Drive
from stickslip.study.control import closed_loop, dynamics_at, limit_cycle

PLAIN = EventDriven(tier="python")
HOW = {"period": 0.02, "t_end": 0.5, "delay": 0.007, "solver": PLAIN}
BOTH = ("left_drive", "right_drive")
ARM = TwoLinkArm(
    upper_mass=1.0, upper_length=0.4, upper_centre=0.2, upper_inertia=0.06,
    lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03,
)  # fmt: skip


def push(place, rate):
    return 80.0 * (0.1 - place) - 8.0 * rate


def of_both(t, seen):
    return {name: push(seen[q], seen[f"{q}_dot"]) for name, q in zip(BOTH, "ab", strict=True)}


def test_loops_around_two_axes_are_those_around_each():
    both = closed_loop(Pair(), LAWS, of_both, drive=BOTH, **HOW)
    for i, (q, law) in enumerate((("a", LAW), ("b", OTHER))):
        alone = closed_loop(axis(), law, lambda t, seen: push(seen["x"], seen["v"]), **HOW)
        # series in both cases, of steps that end at other times
        np.testing.assert_allclose(both.measured[q], alone.measured["x"], rtol=0, atol=1e-14)
        np.testing.assert_allclose(both.commands[:, i], alone.commands, rtol=0, atol=1e-12)
    again = simulate(both.mechanism, LAWS, t_end=0.5, solver=PLAIN)
    assert [e.t for e in again.events] == [e.t for e in both.run.events]
    assert list(both.to_dataframe())[-2:] == ["requested:right_drive", "command:right_drive"]


def test_one_of_several_drives_may_be_commanded_alone():
    loop = closed_loop(Pair(), LAWS, lambda t, seen: 5.0, drive="right_drive", **HOW)
    assert loop.commands.shape == (25,)
    assert loop.drives == ()
    assert not np.any(loop.run["a"])
    assert loop.run["b"][-1] > 0.0


def test_drives_of_parts_are_commanded_by_their_paths():
    arm = SerialArm(links=(Link(mass=0.5, length=0.3, centre=0.15, inertia=0.015),) * 2)
    names = ("links.0.torque", "links.1.torque")
    hold = closed_loop(
        arm, Coulomb(kinetic_coefficient=0.2), lambda t, seen: dict.fromkeys(names, 1.0),
        drive=names, **HOW,
    )  # fmt: skip
    assert [link.torque is not None for link in hold.mechanism.links] == [True, True]
    assert hold.drives == names


@dataclass(frozen=True, kw_only=True)
class Clutch(Plain):
    """Two rotors of 1 kg m^2 whose clutch slips by the difference of their angles."""

    name: ClassVar[str] = "clutch"
    coordinates: ClassVar[tuple[str, ...]] = ("phi1", "phi2")
    rates: ClassVar[tuple[str, ...]] = ("w1", "w2")
    units: ClassVar[tuple[str, ...]] = ("rad", "rad")
    torque: Drive | None = None

    def kinetic_energy(self, q, q_dot):
        return 0.5 * (q_dot["phi1"] * q_dot["phi1"] + q_dot["phi2"] * q_dot["phi2"])

    def forces(self, t, q, q_dot, drives):
        return {"phi1": drives.get("torque", 0.0)}

    def drives(self):
        return {} if self.torque is None else {"torque": self.torque}

    def contacts(self):
        return (
            Contact(name="clutch", slip={"phi1": 1.0, "phi2": -1.0}, load=1.0),
            Contact(name="bearing", slip="phi2", load=1.0),
        )


def test_a_controller_sees_the_coordinates_of_the_mechanism_where_slips_are_sums():
    laws = {"clutch": Coulomb(kinetic_coefficient=1.0), "bearing": Coulomb(kinetic_coefficient=0.2)}
    loop = closed_loop(
        Clutch(), laws, lambda t, seen: 5.0 * (3.0 - seen["w1"]), y0={"w1": 2.0, "w2": 1.0}, **HOW
    )
    own = loop.run.at(loop.t)
    for name in ("phi1", "phi2", "w1", "w2"):
        np.testing.assert_allclose(loop.measured[name], own[name], rtol=0, atol=1e-13)
    here = dynamics_at(Clutch(), q_dot={"w1": 2.0})
    np.testing.assert_allclose(here.mass, np.eye(2), atol=1e-14)
    np.testing.assert_allclose(here.friction_direction, [[1.0, 0.0], [-1.0, 1.0]], atol=1e-14)


def test_accelerations_of_an_arm_are_those_that_inverse_dynamics_takes_forces_for():
    q, v = {"shoulder": 0.7, "elbow": -0.4}, {"shoulder_dot": 1.1, "elbow_dot": -2.0}
    here = dynamics_at(ARM, q=q, q_dot=v)
    assert here.drives == ("shoulder_drive", "elbow_drive")
    assert here.contacts == ("shoulder", "elbow")
    a = here.accelerations(friction=[0.3, -0.12], command=[1.0, 2.0])
    rows = (np.array([list(x.values())]) for x in (q, v))
    taken, _ = JointTorques.of(ARM, []).along(ARM, np.zeros(1), *rows, a[None])
    np.testing.assert_allclose(taken[0], [1.0 - 0.3, 2.0 + 0.12], rtol=1e-12)
    one = dynamics_at(ARM, q=q, q_dot=v, drive="elbow_drive")
    np.testing.assert_array_equal(one.command_direction, [0.0, 1.0])
    np.testing.assert_array_equal(one.accelerations(command=[2.0]), one.accelerations(command=2.0))
    np.testing.assert_array_equal(one.normal_force(command=[2.0]), one.normal)


def test_friction_of_feet_moves_load_from_one_to_the_other():
    body = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15)
    here = dynamics_at(body)
    # moments about the front foot: of the weight, and of friction at the ground, 0.15 m below
    np.testing.assert_allclose(here.normal, [19.62 * 0.4, 19.62 * 0.6], rtol=1e-12)
    np.testing.assert_allclose(here.normal_force([1.0, 2.0]) - here.normal, [0.9, -0.9], rtol=1e-12)


def test_limit_cycles_are_asked_of_one_contact():
    run = simulate(Pair(stiffness=40.0), LAWS, t_end=1.0, y0={"a": 1.0}, solver=PLAIN)
    with pytest.raises(
        InputError, match=r"several contacts \(left, right\).*run.contact\('left'\)"
    ):
        limit_cycle(run, "a")
    assert limit_cycle(run.contact("left"), "a", since=0.0).kind in ("decaying", "none")


BAD = {
    "a number for two drives": (BOTH, lambda t, seen: 1.0, "commands by drive, {'left_drive', 'r"),
    "no drive": ((), of_both, "drive must name different drives"),
    "a drive twice": (("left_drive",) * 2, of_both, "drive must name different drives"),
    "none named": (None, of_both, "several drives: name one"),
    "not finite": (BOTH, lambda t, seen: dict.fromkeys(BOTH, np.nan), "finite number, got nan"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_wrong_command_is_refused_in_words(case):
    drive, controller, message = BAD[case]
    with pytest.raises(InputError, match=message):
        closed_loop(Pair(), LAWS, controller, drive=drive, **HOW)


@pytest.mark.parametrize("rig", [ARM, axis()], ids=["several", "one"])
def test_dynamics_at_what_is_no_time_are_refused(rig):
    with pytest.raises(ParameterError, match=r"dynamics_at.t \(t\) must be a"):
        dynamics_at(rig, {"x": 0.1})
