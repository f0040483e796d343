"""The suites for third parties: each check finds what is deliberately wrong, and nothing else."""

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
import pytest

from stickslip import Coulomb, MatrixMechanism, Mechanism
from stickslip.errors import ConformanceError
from stickslip.friction import BristleLaw, SetValuedLaw
from stickslip.mechanisms import Contact
from stickslip.quantities import Quantity
from stickslip.study.testing import check_friction, check_mechanism, suites

Mass = Annotated[float, Quantity("m", "kg", above=0)]


@dataclass(frozen=True, kw_only=True)
class Sound(Mechanism):
    """A mass on a spring; `mass` and `speed` are what they say."""

    name: ClassVar[Any] = "sound"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)

    mass: Mass = 1.0
    speed: Annotated[float, Quantity("v_0", "m/s")] = 1.0

    def kinetic_energy(self, q, q_dot):
        return 0.5 * self.mass * q_dot["x"] * q_dot["x"]

    def potential_energy(self, t, q):
        return 5.0 * q["x"] * q["x"]

    def forces(self, t, q, q_dot, drives):
        return {}

    def contacts(self):
        return (Contact(slip="x", load=self.mass),)

    def drives(self):
        return {}

    def start(self):
        return {"v": self.speed}


@dataclass(frozen=True, kw_only=True)
class ByMatrices(MatrixMechanism):
    """A turning arm with a bead of that `mass`: x along the arm, turn of the arm."""

    name: ClassVar[str] = "by-matrices"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "turn")
    rates: ClassVar[tuple[str, ...]] = ("v", "turn_dot")
    units: ClassVar[tuple[str, ...]] = ("m", "rad")

    mass: Mass = 1.0

    def mass_matrix(self, q):
        return [[self.mass, 0.0], [0.0, self.mass * (1.0 + q["x"] * q["x"])]]

    def forces(self, t, q, q_dot, drives):
        turn = q_dot["turn"]
        return {
            "x": self.mass * q["x"] * turn * turn,
            "turn": -2.0 * self.mass * q["x"] * q_dot["x"] * turn,
        }

    def potential_energy(self, t, q):
        return 0.0

    def contacts(self):
        return (Contact(slip="x", load=1.0),)

    def drives(self):
        return {}


def changed(base, undecorated=False, **members):
    """Return an object of a class that differs from a sound one in some members."""
    kind = type("Changed", (base,), {"__doc__": base.__doc__, "__module__": __name__, **members})
    return (kind if undecorated else dataclass(frozen=True, kw_only=True)(kind))()


WRONG_MECHANISMS = {
    "contacts name coordinates": changed(
        Sound, contacts=lambda self: (Contact(slip="y", load=1.0),)
    ),
    "its kinetic energy is positive and quadratic in the rates": changed(
        Sound, kinetic_energy=lambda self, q, q_dot: self.mass * abs(q_dot["x"]) * q_dot["x"] ** 2
    ),
    "its mass matrix is symmetric and positive definite": changed(
        ByMatrices, mass_matrix=lambda self, q: [[2.0, 1.0], [0.0, 2.0]]
    ),
    "its equations can be derived": changed(
        Sound, potential_energy=lambda self, t, q: q["x"] if q["x"] > 0.0 else 0.0
    ),
    "centrifugal and Coriolis forces do no work": changed(
        ByMatrices,
        forces=lambda self, t, q, q_dot, drives: {"x": self.mass * q["x"] * q_dot["turn"] ** 2},
    ),
    "runs satisfy the energy balance": changed(
        ByMatrices,
        forces=lambda self, t, q, q_dot, drives: {"x": -5.0 * q["x"]},
        mass_matrix=lambda self, q: [[self.mass, 0.0], [0.0, 1.0]],
        power=lambda self, t, q, q_dot, drives: 0.0 * t,
    ),
}


def failed(report):
    return {finding.check for finding in report.findings}


@pytest.mark.parametrize("sound", [Sound(), ByMatrices()], ids=lambda one: one.name)
def test_a_sound_mechanism_passes_every_check(sound):
    report = check_mechanism(sound)
    assert report.ok, report
    assert len(report.checks) == len(suites.FIRST) + len(suites.THEN) == 6


@pytest.mark.parametrize(("check", "wrong"), WRONG_MECHANISMS.items(), ids=WRONG_MECHANISMS)
def test_each_check_of_mechanisms_finds_what_it_is_there_for(check, wrong):
    assert check in failed(check_mechanism(wrong))


# --- laws


@dataclass(frozen=True, kw_only=True)
class Plain(SetValuedLaw):
    """Coulomb's law with `mu`."""

    name: ClassVar[str] = "plain"
    title: ClassVar[str] = "Plain"
    formula: ClassVar[str] = "F = mu N"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ("mu",)

    mu: Annotated[float, Quantity("mu", low=0, scale="level", bounds=(0, 9), start=1)] = 0.2

    def sliding(self, speed, load):
        return self.mu * load + 0.0 * speed

    def break_away(self, load):
        return self.mu * load


@dataclass(frozen=True, kw_only=True)
class Brush(BristleLaw):
    """Bristles with `mu` and `stiffness`."""

    name: ClassVar[str] = "brush"
    title: ClassVar[str] = "Brush"
    formula: ClassVar[str] = "F = sigma z N"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ("mu",)

    mu: Annotated[float, Quantity("mu", above=0, scale="level", bounds=(0, 9), start=1)] = 0.2
    stiffness: Annotated[float, Quantity("sigma", "1/m", above=0)] = 1e3

    def force(self, velocity, load, states=()):
        return self.stiffness * states[0] * load

    def rates(self, velocity, load, states):
        return (velocity - self.stiffness * abs(velocity) / self.mu * states[0],)

    def steady(self, velocity, load):
        return self.mu * load * np.sign(velocity)

    def break_away(self, load):
        return self.mu * load


def of_floats(self, speed, load):
    """Say one thing to numbers and another to symbols."""
    return (0.1 if isinstance(load, float) else self.mu) * load + 0.0 * speed


WRONG_LAWS = {
    "friction opposes slip": changed(
        Plain, sliding=lambda self, speed, load: self.mu * load - 0.5 * speed
    ),
    "friction is affine in the load": changed(
        Plain, sliding=lambda self, speed, load: 0.01 * load * load + 0.0 * speed
    ),
    "break-away and sliding agree": changed(Plain, break_away=lambda self, load: 0.1 * load),
    "its equations can be derived": changed(
        Plain, sliding=lambda self, speed, load: load if speed < 1.0 else 0.5 * load
    ),
    "the generated equations agree with the law": changed(Plain, sliding=of_floats),
    "friction never increases the energy": changed(
        Brush,
        force=lambda self, velocity, load, states=(): (
            (self.stiffness * states[0] - 0.5 * velocity) * load
        ),
    ),
}  # fmt: skip


@pytest.mark.parametrize("sound", [Plain(), Brush()], ids=lambda one: one.name)
def test_a_sound_law_passes_every_check(sound):
    report = check_friction(sound)
    assert report.ok, report
    assert len(report.checks) == len(suites.LAW_FIRST) + len(suites.LAW_THEN) == 6


STRONGER = {
    "in proportion to speed": changed(
        Plain, sliding=lambda self, speed, load: (self.mu + 2.0 * speed) * load
    ),
    "within micrometres per second": changed(
        Plain, sliding=lambda self, speed, load: self.mu * (1.0 + speed / (speed + 1e-6)) * load
    ),
    "from a lower level": changed(
        Plain, sliding=lambda self, speed, load: (0.5 * self.mu + speed) * load
    ),
    "as bristles": changed(
        Brush,
        rates=lambda self, velocity, load, states: (
            velocity
            - self.stiffness * abs(velocity) / (self.mu * (1.0 + abs(velocity))) * states[0],
        ),
        steady=lambda self, velocity, load: (
            self.mu * (1.0 + abs(velocity)) * load * np.sign(velocity)
        ),
    ),
}


@pytest.mark.parametrize("law", STRONGER.values(), ids=STRONGER)
def test_friction_may_grow_with_speed_beyond_the_break_away_level(law):
    # runs, energy and sensitivities are those of the law: nothing needs a level that bounds sliding
    assert check_friction(law).ok


@pytest.mark.parametrize("share", [1.5, 1.001, 1.0001])
def test_sliding_must_not_begin_above_the_break_away_level(share):
    jump = changed(Plain, sliding=lambda self, speed, load: (share * self.mu + speed) * load)
    assert "break-away and sliding agree" in failed(check_friction(jump))


@pytest.mark.parametrize(("check", "wrong"), WRONG_LAWS.items(), ids=WRONG_LAWS)
def test_each_check_of_laws_finds_what_it_is_there_for(check, wrong):
    assert check in failed(check_friction(wrong))


@pytest.mark.parametrize(
    "wrong",
    [
        changed(Plain, break_away=lambda self, load: self.mu * load + 1.0),
        changed(Plain, break_away=lambda self, load: -self.mu * load),
        changed(Brush, rates=lambda self, velocity, load, states: (1.0 + velocity,)),
        changed(Brush, rates=lambda self, velocity, load, states: (velocity,)),
    ],
    ids=["level without load", "negative level", "bristles creep at rest", "bristles know no end"],
)
def test_what_a_law_holds_at_rest_must_go_with_its_sliding(wrong):
    assert "break-away and sliding agree" in failed(check_friction(wrong))


def test_a_report_reads_as_text_and_raises_only_if_asked_to():
    wrong = WRONG_LAWS["friction opposes slip"]
    report = check_friction(wrong)
    assert not report.ok
    text = repr(report)
    assert text.startswith("<Changed: ")
    assert "- friction opposes slip\n" in text
    assert "     the force of −3 N at 10 m/s drives" in text
    assert "<pre>" in report._repr_html_()
    with pytest.raises(ConformanceError, match="friction opposes slip"):
        check_friction(wrong, throw=True)
    assert check_friction(Coulomb(kinetic_coefficient=0.2), throw=True).ok


def test_without_equations_the_checks_that_need_them_are_skipped():
    report = check_mechanism(WRONG_MECHANISMS["its equations can be derived"])
    assert report.skipped == tuple(suites.THEN)
    assert "Not checked until these are corrected" in repr(report)
