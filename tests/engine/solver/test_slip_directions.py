"""Slips that are sums over several coordinates, against the same mechanisms in relative ones."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import pytest
from tests.contact_cases import Clutches, Plain, clutches, coulomb, plates

from stickslip import EventDriven, ensemble, simulate
from stickslip.engine import Final, Max, Samples
from stickslip.engine.trajectory import Status
from stickslip.errors import InputError
from stickslip.maths import sin
from stickslip.mechanisms import BoundedMechanism, Contact, Guide, MatrixMechanism, Stop
from stickslip.mechanisms.drives import Sampled
from stickslip.quantities import Quantity

PLAIN = EventDriven(tier="python")


@dataclass(frozen=True, kw_only=True)
class Shafts(Clutches):
    """Four inertias in a row, coupled by three clutches, each with its own angle."""

    name: ClassVar[str] = "shafts"
    coordinates: ClassVar[tuple[str, ...]] = ("phi1", "phi2", "phi3", "phi4")
    rates: ClassVar[tuple[str, ...]] = ("w1", "w2", "w3", "w4")

    def kinetic_energy(self, q, q_dot):
        return 0.5 * self.inertia * sum((q_dot[i] * q_dot[i] for i in self.coordinates), 0.0)

    def forces(self, t, q, q_dot, drives):
        return {"phi1": self.level * sin(10.0 * np.pi * t)}

    def contacts(self):
        return tuple(
            Contact(name=f"clutch-{i}", slip={f"phi{i}": -1.0, f"phi{i + 1}": 1.0})
            for i in (1, 2, 3)
        )


def shafts():
    relative, laws, start = clutches()
    return Shafts(second=relative.second, third=relative.third), relative, laws, start


def test_angles_of_shafts_are_those_of_relative_angles():
    absolute, relative, laws, start = shafts()
    tight = replace(PLAIN, tolerance=1e-12)
    run = simulate(absolute, laws, t_end=1.5, y0={"w1": 10.0}, solver=tight)
    other = simulate(relative, laws, t_end=1.5, y0=start, solver=tight)
    assert run.events == other.events
    assert run.certificate.certified
    assert run.certificate.stick_drift == 0.0
    at, seen = run.at(run.t), other.at(run.t)
    np.testing.assert_allclose(at["phi2"], seen["phi"] + seen["r1"], atol=1e-14)
    for name in ("friction:clutch-2", "normal_force:clutch-3", "mode:clutch-1"):
        np.testing.assert_array_equal(at[name], seen[name])
    assert run.units["friction:clutch-1"] == "N m"
    # closed form, see test_contacts
    assert run["w4"][-1] == pytest.approx(2.463187166649595445, abs=1e-12)
    assert run["phi3"][-1] == pytest.approx(2.7104644362313807195, abs=1e-12)


def test_ensembles_give_and_keep_the_same_coordinates():
    absolute, _, laws, _ = shafts()
    outputs = {"end": Final("phi3"), "top": Max("w2"), "some": Samples("phi2", (0.3, 0.8))}
    runs = ensemble(
        absolute, laws, {"initial.w1": np.array([10.0, 12.0])}, t_end=1.0, outputs=outputs,
        solver=PLAIN,
    )  # fmt: skip
    run = simulate(absolute, laws, t_end=1.0, y0={"w1": 12.0}, solver=PLAIN)
    assert runs["end"][1] == run["phi3"][-1]
    np.testing.assert_array_equal(runs["some"][1], run.at([0.3, 0.8])["phi2"])
    assert runs["top"][1] == pytest.approx(run.at(np.linspace(0, 1, 4001))["w2"].max(), abs=1e-5)


class Stack(MatrixMechanism):
    """Plates on each other by their places on the ground: the mass matrix is diagonal."""

    name = "stack"
    coordinates = tuple(f"x{i}" for i in range(1, 6))
    rates = tuple(f"v{i}" for i in range(1, 6))
    units = ("m",) * 5

    def mass_matrix(self, q):
        return np.eye(5).tolist()

    def kinetic_energy(self, q, q_dot):
        return sum((0.5 * q_dot[i] * q_dot[i] for i in self.coordinates), 0.0)

    def potential_energy(self, t, q):
        return sum((10.0 * q[i] * q[i] for i in self.coordinates), 0.0)

    def forces(self, t, q, q_dot, drives):
        return {i: -20.0 * q[i] for i in self.coordinates}

    def drives(self):
        return {}

    def contacts(self):
        found = [Contact(name="r1", slip="x1", load=9.81 * 5)]
        for i in range(2, 6):
            slip = {f"x{i}": 1.0, f"x{i - 1}": -1.0}
            found.append(Contact(name=f"r{i}", slip=slip, load=9.81 * (6 - i)))
        return tuple(found)


def test_plates_by_their_places_change_as_they_do_in_relative_ones():
    relative, laws, start = plates(5)
    places = np.cumsum([start[f"u{i}"] for i in range(1, 6)])
    y0 = {f"v{i}": float(v) for i, v in enumerate(places, 1)}
    run = simulate(Stack(), laws, t_end=10.0, y0=y0, solver=PLAIN)
    other = simulate(relative, laws, t_end=10.0, y0=start, solver=PLAIN)
    found = [(e.contact, e.from_mode, e.to_mode) for e in run.events]
    assert found == [(e.contact, e.from_mode, e.to_mode) for e in other.events]
    assert run.certificate.stick_drift == 0.0
    times = [e.t for e in run.events], [e.t for e in other.events]
    np.testing.assert_allclose(*times, rtol=1e-12)
    sums = np.cumsum([other[f"r{i}"][-1] for i in range(1, 6)])
    np.testing.assert_allclose([run[f"x{i}"][-1] for i in range(1, 6)], sums, atol=1e-12)


@dataclass(frozen=True, kw_only=True)
class Driven(Plain):
    """A shaft that turns as it is told, a clutch, a gear of friction wheels."""

    name: ClassVar[str] = "driven"
    coordinates: ClassVar[tuple[str, ...]] = ("motor", "shaft", "wheel")
    rates: ClassVar[tuple[str, ...]] = ("u", "v", "w")
    units: ClassVar[tuple[str, ...]] = ("rad", "rad", "rad")
    small: Annotated[float, Quantity("r", "m", above=0)] = 0.1
    large: Annotated[float, Quantity("R", "m", above=0)] = 0.3

    def kinetic_energy(self, q, q_dot):
        own = 0.01 * q_dot["motor"] * q_dot["motor"]
        return 0.5 * (own + q_dot["shaft"] * q_dot["shaft"] + 2.0 * q_dot["wheel"] * q_dot["wheel"])

    def drives(self):
        return {"turn": Sampled(times=(0.0, 1.0), values=(2.0, 0.0))}

    def guided(self):
        return {"motor": Guide(drive="turn", effort="torque", unit="N m")}

    def contacts(self):
        return (
            Contact(name="clutch", slip={"motor": 1.0, "shaft": -1.0}, load=1.0),
            Contact(name="gear", slip={"shaft": self.small, "wheel": -self.large}, load=1.0),
        )


GEARED = {"clutch": coulomb(0.5, 0.6), "gear": coulomb(2.0, 2.5)}


def test_a_clutch_to_a_shaft_that_is_driven_and_a_gear_by_its_radii():
    run = simulate(Driven(), GEARED, t_end=6.0, solver=PLAIN)
    # shaft and wheel, whose gear holds, speed up under the clutch's torque
    inertia = 1.0 + 2.0 / 9.0
    locked = 2.0 / (0.5 / inertia)
    event = run.events[0]
    assert (event.contact, event.reason) == ("clutch", "break-away") or event.t > 0.0
    stop = next(e for e in run.events if e.contact == "clutch" and e.reason == "stop")
    assert stop.t == pytest.approx(locked, rel=1e-12)
    assert run["v"][-1] == pytest.approx(2.0, rel=1e-13)
    assert run["w"][-1] == pytest.approx(2.0 / 3.0, rel=1e-13)
    assert run.at([0.5])["torque"][0] == pytest.approx(0.01 * 2.0 + 0.5, rel=1e-12)
    assert run.certificate.energy_error < 1e-13


def test_parameters_that_change_the_coordinates_have_no_sensitivities():
    run = simulate(Driven(), GEARED, t_end=1.0, solver=PLAIN)
    assert np.isfinite(run.sensitivity("w", "friction.clutch.kinetic_coefficient")[-1])
    with pytest.raises(InputError, match=r"large has no sensitivity.*relative coordinates"):
        run.sensitivity("w", "mechanism.large")


def test_stops_stay_with_their_coordinates():
    @dataclass(frozen=True, kw_only=True)
    class Ended(BoundedMechanism, Shafts):
        def stops(self):
            return (Stop(coordinate="phi4", position=1.0, side="upper", restitution=0.5),)

    base, _, laws, _ = shafts()
    run = simulate(
        Ended(second=base.second, third=base.third), laws, t_end=3.0, y0={"w1": 10.0}, solver=PLAIN
    )
    hit = next(e for e in run.events if e.reason == "phi4 hits stop")
    assert run.at([hit.t])["phi4"][0] == pytest.approx(1.0, rel=1e-14)
    assert run["phi4"].max() == pytest.approx(1.0, rel=1e-14)
    assert run.certificate.certified


def closing(coordinates, slips):
    """Return masses of 1 kg with contacts that slip along sums."""

    class Loop(Plain):
        name = "loop"
        rates, units = tuple(f"{i}_dot" for i in coordinates), ("m",) * len(coordinates)

        def kinetic_energy(self, q, q_dot):
            return sum((0.5 * q_dot[i] * q_dot[i] for i in coordinates), 0.0)

        def contacts(self):
            return tuple(Contact(name=n, slip=s, load=1.0) for n, s in slips.items())

    Loop.coordinates = coordinates
    return Loop()


def test_a_contact_beside_a_loop_has_no_part_in_it():
    loop = closing(
        ("a", "b", "c", "d"),
        {
            "one": {"a": 1.0, "b": -1.0},
            "two": {"b": 1.0, "c": -1.0},
            "beside": {"c": 1.0, "d": -1.0},
            "ground": "d",
            "three": {"a": 2.0, "c": -2.0},  # by a factor
            "four": {"a": -1.0, "c": 1.0},  # along the same closing slip
        },
    )
    laws = dict.fromkeys(("one", "two", "beside", "ground", "four"), coulomb(0.5))
    laws |= {"three": coulomb(0.25)}
    run = simulate(loop, laws, t_end=10.0, y0={"a_dot": 1.0}, solver=PLAIN)
    # a turns against 0.5 N of "one", and 1 N of "three" and "four" together
    assert run.at([0.1])["a_dot"][0] == pytest.approx(0.85, rel=1e-14)
    assert run.at([0.1])["friction:three"][0] == 0.25
    assert run.at([0.1])["friction:four"][0] == -0.5
    assert run.status is Status.AT_REST
    assert run.certificate.certified
    shared = {name for names in run.certificate.indeterminate for name in names}
    assert shared == {"one", "two", "three", "four"}
    without = simulate(loop, laws | {"three": None, "four": None}, t_end=10.0, solver=PLAIN)
    assert without.certificate.indeterminate == ()


@pytest.mark.parametrize(("torque", "holds"), [(2.5, True), (4.1, True), (4.3, False)])
def test_a_loop_whose_support_yields_holds_what_its_clutches_can_carry(torque, holds):
    """Clutches between three shafts, of which the third is fixed to its shaft by a spring.

    The torque acts on the first shaft, of 1/6 of the inertia: 5/6 of it has to go through clutches
    of 2 and 1.5 N m, which can carry up to 4.2 N m so.
    """

    class Shafts(Plain):
        name = "shafts"
        coordinates = ("a", "b", "c", "ring")
        rates = ("a_dot", "b_dot", "c_dot", "ring_dot")
        units = ("rad",) * 4

        def kinetic_energy(self, q, q_dot):
            pairs = zip((1.0, 2.0, 3.0, 1e-3), self.coordinates, strict=True)
            return sum((0.5 * inertia * q_dot[i] * q_dot[i] for inertia, i in pairs), 0.0)

        def potential_energy(self, t, q):
            return 50.0 * (q["ring"] - q["c"]) * (q["ring"] - q["c"])

        def forces(self, t, q, q_dot, drives):
            damping = 0.5 * (q_dot["ring"] - q_dot["c"])
            return {"a": torque, "c": damping, "ring": -damping}

        def contacts(self):
            ways = {"one": ("a", "b"), "two": ("b", "c"), "three": ("a", "ring")}
            return tuple(
                Contact(name=name, slip={i: 1.0, j: -1.0}, load=1.0)
                for name, (i, j) in ways.items()
            )

    laws = {"one": coulomb(2.0), "two": coulomb(3.0), "three": coulomb(1.5)}
    run = simulate(Shafts(), laws, t_end=4.0, solver=PLAIN)
    assert run.certificate.certified
    assert all(run[f"mode:{name}"][-1] == 0 for name in laws) is holds
    if holds:
        # whatever slipped at first, the whole of 6 kg m^2 then gains speed as one
        last, before = run.at([4.0, 3.9])["a_dot"]
        assert (last - before) / 0.1 == pytest.approx(torque / 6.001, rel=2e-3)


@dataclass(frozen=True, kw_only=True)
class Offset(Plain):
    """Two unit masses, of which contacts rub by sums with factors that are parameters."""

    name: ClassVar[str] = "offset"
    coordinates: ClassVar[tuple[str, ...]] = ("a", "b")
    rates: ClassVar[tuple[str, ...]] = ("u", "v")
    units: ClassVar[tuple[str, ...]] = ("m", "m")
    r: Annotated[float, Quantity("r")]
    s: Annotated[float, Quantity("s")] = 0.5
    several: bool = False
    inverse: bool = False

    def kinetic_energy(self, q, q_dot):
        return 0.5 * (q_dot["a"] * q_dot["a"] + q_dot["b"] * q_dot["b"])

    def forces(self, t, q, q_dot, drives):
        return {"a": 0.5}

    def contacts(self):
        factor = 1.0 / self.r if self.inverse else self.r
        first = Contact(name="k", slip={"a": 1.0, "b": factor}, load=1.0)
        second = Contact(name="l", slip={"a": 1.0, "b": self.s}, load=1.0)
        return (first, second) if self.several else (first,)


def test_a_factor_that_may_vanish_leaves_its_coordinate_in_place():
    run = simulate(Offset(r=0.0), coulomb(0.1), t_end=1.0, y0={"u": 1.0}, solver=PLAIN)
    assert (run["a"][-1], run["b"][-1]) == pytest.approx((1.2, 0.0), rel=1e-12)  # 0.5 N less 0.1 N


def test_values_at_which_slips_take_no_places_of_coordinates_are_refused_by_name():
    laws = {"k": coulomb(0.1), "l": coulomb(0.2)}
    parallel = Offset(r=0.5, several=True)
    said = r"Offset: .* slips .* places of coordinates: k \(1 a and 0.5 b\); l \(1 a and 0.5 b\)"
    with pytest.raises(InputError, match=said):
        simulate(parallel, laws, t_end=1.0)
    with pytest.raises(InputError, match=f"run 1: {said}"):
        ensemble(replace(parallel, r=2.0), laws, {"r": [1.0, 0.5]}, t_end=1.0)
    near = simulate(replace(parallel, r=0.501), laws, t_end=0.1, y0={"u": 1.0}, solver=PLAIN)
    assert near.certificate.certified
    with pytest.raises(
        InputError, match=r"Offset: the contacts cannot be worked out .*division by"
    ):
        simulate(Offset(r=0.0, inverse=True), coulomb(0.1), t_end=1.0)
    with pytest.raises(InputError, match="slip of the contact 'k' has the factor inf for b"):
        simulate(Offset(r=1e-320, inverse=True), coulomb(0.1), t_end=1.0)
