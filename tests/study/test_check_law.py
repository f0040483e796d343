"""The check of a law: each part finds what is deliberately wrong, and nothing else."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
import pytest

from stickslip.errors import ConformanceError
from stickslip.friction import BristleLaw, SetValuedLaw
from stickslip.quantities import Quantity
from stickslip.study import check_law


def changed(base, undecorated=False, **members):
    """Return an object of a class that differs from a sound one in some members."""
    kind = type("Changed", (base,), {"__doc__": base.__doc__, "__module__": __name__, **members})
    return (kind if undecorated else dataclass(frozen=True, kw_only=True)(kind))()


def failed(law):
    """Return what is said of a law, empty if nothing is wrong."""
    try:
        check_law(law)
    except ConformanceError as error:
        return str(error)
    return ""


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
    assert failed(sound) == ""


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
    assert failed(law) == ""


@pytest.mark.parametrize("share", [1.5, 1.001, 1.0001])
def test_sliding_must_not_begin_above_the_break_away_level(share):
    jump = changed(Plain, sliding=lambda self, speed, load: (share * self.mu + speed) * load)
    assert "break-away and sliding agree" in failed(jump)


@pytest.mark.parametrize(("check", "wrong"), WRONG_LAWS.items(), ids=WRONG_LAWS)
def test_each_check_of_laws_finds_what_it_is_there_for(check, wrong):
    assert check in failed(wrong)


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
    assert "break-away and sliding agree" in failed(wrong)


def test_the_error_lists_checks_and_their_problems():
    found = failed(WRONG_LAWS["friction opposes slip"])
    assert found.startswith("Changed fails these checks:\n- friction opposes slip\n")
    assert "    the force of −3 N at 10 m/s drives" in found


def test_without_equations_the_checks_that_need_them_are_left_out():
    found = failed(WRONG_LAWS["its equations can be derived"])
    assert found.endswith("Not checked until this is corrected: what needs generated equations.")
