"""Stops of coordinates that do not slip, and the impulse that an impact is.

A capsule on rough ground with a mass inside that hits its walls: the first coordinate is the
capsule's place, the second that of the mass within it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

import numpy as np
import pytest
from typing_extensions import override

from stickslip import Coulomb, EventDriven, simulate
from stickslip.engine import Status
from stickslip.errors import ParameterError
from stickslip.mechanisms import BoundedMechanism, Contact, Guide, Stop, stops_between
from stickslip.mechanisms.drives import Drive, Pulse
from stickslip.quantities import Quantity


@dataclass(frozen=True, kw_only=True)
class Capsule(BoundedMechanism):
    """A shell with a mass inside, which a constant force between them moves."""

    name: ClassVar[str] = "capsule"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "xi")
    rates: ClassVar[tuple[str, ...]] = ("v", "xi_dot")
    units: ClassVar[tuple[str, ...]] = ("m", "m")

    shell: Annotated[float, Quantity("M", "kg", above=0)] = 2.0
    inner: Annotated[float, Quantity("m", "kg", above=0)] = 1.0
    force: Annotated[float, Quantity("f", "N")] = 0.0
    room: Annotated[float, Quantity("r", "m", above=0)] = 0.5
    restitution: Annotated[float, Quantity("e", low=0, high=1)] = 0.5
    end: Annotated[float, Quantity("x_u", "m")] | None = None

    @override
    def kinetic_energy(self, q: Mapping, q_dot: Mapping):
        u = q_dot["x"] + q_dot["xi"]
        return 0.5 * self.shell * q_dot["x"] * q_dot["x"] + 0.5 * self.inner * u * u

    @override
    def potential_energy(self, t, q: Mapping):
        return 0.0

    @override
    def forces(self, t, q: Mapping, q_dot: Mapping, drives: Mapping):
        return {"xi": self.force}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", load=1.0),)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {}

    @override
    def stops(self) -> tuple[Stop, ...]:
        walls = stops_between("xi", -self.room, self.room, self.restitution)
        return walls + stops_between("x", None, self.end, 0.0)


@final
@dataclass(frozen=True, kw_only=True)
class Pushed(Capsule):
    """The force between the two fades and turns after 5 s."""

    @override
    def forces(self, t, q: Mapping, q_dot: Mapping, drives: Mapping):
        return {"xi": self.force * (1.0 - t / 5.0)}


def test_impacts_inside_keep_the_momentum_and_turn_the_relative_speed():
    run = simulate(
        Capsule(), Coulomb(kinetic_coefficient=0.0), t_end=10.0, y0={"v": 0.1, "xi_dot": 1.0}
    )
    assert [event.reason for event in run.events] == ["xi hits stop"] * len(run.events)
    seen = run.sampled(501)
    momentum = 2.0 * seen["v"] + (seen["v"] + seen["xi_dot"])
    np.testing.assert_allclose(momentum, 2.0 * 0.1 + 1.1, rtol=1e-12)
    crossings = 1.0 / 0.5 ** np.arange(1, 4)
    expected = 0.5 + np.concatenate(([0.0], np.cumsum(crossings)))
    np.testing.assert_allclose([event.t for event in run.events], expected[:3], rtol=1e-12)
    # relative speed 1 between 2 kg and 1 kg, three times halved
    assert run.certificate.work_stops == pytest.approx(0.5 * 2 / 3 * (1 - 0.5**6), rel=1e-12)


def test_an_impact_inside_starts_a_shell_that_friction_held():
    run = simulate(Capsule(), Coulomb(kinetic_coefficient=0.5), t_end=10.0, y0={"xi_dot": 1.0})
    hit, first, second = run.events[:3]
    assert (hit.reason, hit.t) == ("xi hits stop", first.t)
    assert (first.reason, first.from_mode, first.to_mode) == ("break-away", 0, 1)
    # m (1 + e) / (M + m) of the relative speed, then braked
    after = run.at(first.t)
    assert after["v"][0] == pytest.approx(1.5 / 3, rel=1e-12)
    assert (second.reason, second.to_mode) == ("stop", 0)
    assert second.t - first.t == pytest.approx(2.0 * 0.5 / 0.5, rel=1e-11)
    assert run.certificate.certified


def test_a_shell_pressed_to_its_own_stop_is_pushed_off_by_impacts_inside():
    run = simulate(
        Capsule(end=0.0), Coulomb(kinetic_coefficient=0.1), t_end=3.0, y0={"xi_dot": -1.0}
    )
    hit, leaves = run.events[:2]
    assert (hit.reason, leaves.reason) == ("xi hits stop", "leaves stop")
    assert (leaves.from_mode, leaves.to_mode, leaves.t) == (2, -1, hit.t)
    assert hit.t == pytest.approx(0.5, rel=1e-12)
    assert run["x"].max() == 0


def test_an_impact_through_a_shell_at_its_stop_finds_it_immovable():
    rig = Capsule(end=0.0, restitution=0.5)
    run = simulate(rig, Coulomb(kinetic_coefficient=0.1), t_end=3.0, y0={"xi_dot": 1.0})
    hit = run.events[0]
    assert (hit.t, hit.reason) == (pytest.approx(0.5, rel=1e-12), "xi hits stop")
    after = run.at(hit.t)
    assert after["v"][0] == 0
    assert after["xi_dot"][0] == pytest.approx(-0.5, rel=1e-12)
    assert run["x"].max() == 0
    assert run.certificate.certified


@final
@dataclass(frozen=True, kw_only=True)
class Tray(BoundedMechanism):
    """A tray that a guide carries at a constant speed, and a block that hits its rim."""

    name: ClassVar[str] = "tray"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "s", "z")
    rates: ClassVar[tuple[str, ...]] = ("v", "u", "w")
    units: ClassVar[tuple[str, ...]] = ("m", "m", "m")
    mass: ClassVar[float] = 3.0
    contact_names: ClassVar[tuple[str, ...]] = ("block",)
    idle: bool = False
    """Whether a second block, at rest beside the tray, rubs too."""

    @override
    def kinetic_energy(self, q: Mapping, q_dot: Mapping):
        along = q_dot["x"] + q_dot["s"]
        return 0.5 * (self.mass * along * along + q_dot["z"] * q_dot["z"])

    @override
    def potential_energy(self, t, q: Mapping):
        return 0.0

    @override
    def forces(self, t, q: Mapping, q_dot: Mapping, drives: Mapping):
        return {}

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {"carry": Pulse(level=0.0, duration=1.0)}

    @override
    def guided(self) -> Mapping[str, Guide]:
        return {"s": Guide(drive="carry", effort="push", unit="N")}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        beside = (Contact(slip="z", load=1.0, name="beside"),) if self.idle else ()
        return (Contact(slip="x", load=1.0, name="block"), *beside)

    @override
    def stops(self) -> tuple[Stop, ...]:
        return (Stop(coordinate="x", position=0.5, side="upper", restitution=0.6),)


@pytest.mark.parametrize("idle", [False, True], ids=["one contact", "two contacts"])
def test_what_a_guide_does_in_an_impact_is_work_that_it_supplies(idle):
    carry, level = -2.0, 0.1
    start = {"v": 1.0, "u": carry}
    run = simulate(Tray(idle=idle), Coulomb(kinetic_coefficient=level), t_end=1.0, y0=start)
    assert run.certificate.certified
    [hit] = [event for event in run.events if "stop" in event.reason]
    before = (1.0 - 2.0 * (level / 3.0) * 0.5) ** 0.5
    impact = carry * 3.0 * -1.6 * before  # what turns the block round, it gives to the tray
    rubbing = carry * -level * (hit.t - (1.0 - hit.t))  # the other way after the impact
    trust = run.certificate
    assert trust.work_supplied == pytest.approx(impact + rubbing, rel=1e-12)
    assert trust.work_stops == pytest.approx(0.5 * 3.0 * (1 - 0.36) * before**2, rel=1e-12)
    assert trust.energy_error < 1e-14


@pytest.mark.parametrize("restitution", [0.0, 0.6])
def test_a_coordinate_that_does_not_slip_comes_to_rest_at_its_stop(restitution):
    rig = Capsule(force=0.3, restitution=restitution)
    run = simulate(rig, Coulomb(kinetic_coefficient=1.0), t_end=50.0)
    assert run.status is Status.AT_REST
    assert run.certificate.certified
    impact = (2 * 0.5 / 0.3) ** 0.5  # friction holds the shell: 1 kg under 0.3 N over 0.5 m
    assert run.events[0].t == pytest.approx(impact, rel=1e-11)
    if restitution == 0:  # m / (M + m) of the speed is left, and all three kg are braked together
        speed = 0.3 * impact / 3.0
        assert run.events[-1].t == pytest.approx(impact + 3.0 * speed, rel=1e-11)
        assert run["x"][-1] == pytest.approx(3.0 * speed**2 / 2.0, rel=1e-11)
    assert run["xi"][-1] == 0.5
    assert run["xi_dot"][-1] == run["v"][-1] == 0


def test_a_mass_leaves_the_stop_it_is_pressed_on_when_its_force_turns():
    rig = Pushed(force=0.3, restitution=0.0)
    run = simulate(rig, Coulomb(kinetic_coefficient=1.0), t_end=6.0)
    *_, leaves = (event for event in run.events if event.reason == "xi leaves stop")
    assert leaves.t == pytest.approx(5.0, rel=1e-12)
    # f (1 - t / 5 s) pulls it back through the room while friction holds the shell
    assert run["xi"][-1] == pytest.approx(0.5 - 0.3 / 5.0 / 6.0, rel=1e-9)
    assert run.certificate.certified


@pytest.mark.slow
def test_stops_of_several_coordinates_run_alike_in_both_tiers():
    rig = Capsule(force=0.05, end=0.2)
    law = Coulomb(kinetic_coefficient=0.04)
    runs = [
        simulate(
            rig, law, t_end=12.0, y0={"xi_dot": 1.0}, throw=False, solver=EventDriven(tier=tier)
        )
        for tier in ("python", "compiled")
    ]
    for name in runs[0].names:
        np.testing.assert_array_equal(runs[0][name], runs[1][name])
    assert runs[0].events == runs[1].events
    assert runs[0].certificate == runs[1].certificate


@dataclass(frozen=True, kw_only=True)
class Declared:
    """Stops that cannot be."""

    stops: tuple[Stop, ...]
    match: str


BAD = {
    "unknown coordinate": Declared(
        stops=(Stop(coordinate="y", position=1.0, side="upper"),), match="one of the coordinates x"
    ),
    "twice": Declared(
        stops=(Stop(coordinate="x", position=1.0, side="upper"),) * 2, match="given twice"
    ),
    "unknown side": Declared(
        stops=(Stop(coordinate="x", position=1.0, side="left"),), match="'lower' or 'upper'"
    ),
    "restitution": Declared(
        stops=(Stop(coordinate="x", position=1.0, side="upper", restitution=2.0),), match="0 to 1"
    ),
}


@pytest.mark.parametrize("case", BAD.values(), ids=BAD)
def test_stops_that_cannot_be_are_refused(case):
    @dataclass(frozen=True, kw_only=True)
    class Sled(BoundedMechanism):
        name: ClassVar[str] = "sled"
        coordinates: ClassVar[tuple[str, ...]] = ("x",)
        rates: ClassVar[tuple[str, ...]] = ("v",)
        units: ClassVar[tuple[str, ...]] = ("m",)

        kinetic_energy = potential_energy = forces = contacts = drives = None

        def stops(self):
            return case.stops

    with pytest.raises(ParameterError, match=case.match):
        Sled()
