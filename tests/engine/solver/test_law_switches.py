"""Switches of laws at their thresholds where drives jump, with one contact and with several."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import pytest
from benchmarks.several.brakes import DiscBrake, Lining

from stickslip import (
    Axis,
    Capsule,
    EventDriven,
    MaxwellSlip,
    TowedBlock,
    TwoFeet,
    simulate,
)
from stickslip.engine import Status
from stickslip.errors import InputError, TracingError
from stickslip.friction import HaessigFriedland, SetValuedLaw
from stickslip.maths import where
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import Sampled, Sine
from stickslip.quantities import Quantity

JUMP, END = 0.3, 0.4
"""Times at which the drive jumps, and at which a run ends [s]."""


@dataclass(frozen=True, kw_only=True)
class Below(SetValuedLaw):
    """One level below a speed, another one from there on."""

    name: ClassVar[str] = "below"
    title: ClassVar[str] = "Below"
    formula: ClassVar[str] = "F = a, b"
    sources: ClassVar[tuple[str, ...]] = ()

    slow: Annotated[float, Quantity("a", "N", low=0)]
    fast: Annotated[float, Quantity("b", "N", low=0)]
    speed: Annotated[float, Quantity("v_1", "m/s", above=0)]

    def sliding(self, speed, load):
        return where(speed < self.speed, self.slow, self.fast) + 0.0 * load

    def break_away(self, load):
        return self.slow + 0.0 * load


@dataclass(frozen=True, kw_only=True)
class Above(Below):
    """The same, asked the other way round."""

    def sliding(self, speed, load):
        return where(speed > self.speed, self.fast, self.slow) + 0.0 * load


def one_contact(drive):
    return Axis(inertia=1.0, load=1.0, drive=drive)


def several_contacts(drive):
    pads = (Lining(radius=1.0, load=1.0), Lining(radius=1.0, load=0.0))
    return DiscBrake(inertia=1.0, drive=drive, pads=pads)


@pytest.mark.parametrize("mechanism", [one_contact, several_contacts])
@pytest.mark.parametrize("kind", [Below, Above])
@pytest.mark.parametrize("begin", [0.0, 2.0, 1.0])
@pytest.mark.parametrize(
    ("slow", "fast"), [pytest.param(0.5, 1.0, marks=pytest.mark.slow), (1.3, 0.4)]
)
def test_a_speed_that_meets_the_threshold_where_the_drive_jumps_goes_on(
    mechanism, kind, begin, slow, fast
):
    threshold = 0.7
    law = kind(slow=slow, fast=fast, speed=threshold)
    # it gets there, or has been there all along, but for rounding
    held = slow if begin < 1.0 or (begin == 1.0 and kind is Above) else fast
    push = (1.0 - begin) * threshold / JUMP + held
    for after in (-3.0, 0.0, 3.0, 5.0):
        made = mechanism(Sampled(times=(0.0, JUMP), values=(push, after)))
        start = {made.rates[0]: begin * threshold}
        run = simulate(made, law, t_end=END, y0=start, solver=EventDriven(tier="python"))
        assert run.status is Status.END_TIME
        gained = (after - (fast if after > 2.0 else slow)) * (END - JUMP)
        rate = run[made.rates[0]][-1]
        assert rate == pytest.approx(threshold + gained, abs=1e-12), after


YIELDED = {
    "elements": MaxwellSlip(
        kinetic_coefficient=0.25, bristle_stiffness=1e3, viscous_coefficient=0.4, static_switch=True
    ),
    "a spring": HaessigFriedland(
        kinetic_coefficient=0.25,
        bristle_stiffness=1e3,
        bristle_damping=0.5,
        sticking_surplus=0.0,
        static_switch=True,
    ),
}


@pytest.mark.parametrize("tier", ["python", "compiled"])
@pytest.mark.parametrize(("mass", "pace"), [(0.5, 0.3), (0.8, 0.3), (1.5, 0.2)])
@pytest.mark.parametrize("law", YIELDED.values(), ids=YIELDED)
def test_a_body_on_yielded_springs_breaks_away_where_it_is_pulled(law, mass, pace, tier):
    # the springs stand at their level when it is reached, so forces balance but for rounding
    for way in (1, -1):
        speed, stiffness, damping = pace * way, 40.0, 0.4
        block = TowedBlock(mass=mass, stiffness=stiffness, speed=speed, damping=damping)
        solver = EventDriven(tier=tier)
        run = simulate(block, law, t_end=1.0, y0={"v": 0.5 * way}, solver=solver)
        modes = [(event.from_mode, event.to_mode, event.reason) for event in run.events[:2]]
        assert modes == [(way, 0, "stop"), (0, way, "break-away")]
        # held, the tow's spring winds up from what it was at the stop to the level
        stop, start = (event.t for event in run.events[:2])
        place = run.at([stop])["x"][0]
        pull = stiffness * (speed * stop - place) + damping * speed
        level = way * 0.25 * mass * block.gravity
        assert start == pytest.approx(stop + (level - pull) / (stiffness * speed), rel=1e-9)


@dataclass(frozen=True, kw_only=True)
class Pressed(SetValuedLaw):
    """A level at rest that is above that of sliding from a load on."""

    name: ClassVar[str] = "pressed"
    title: ClassVar[str] = "Pressed"
    formula: ClassVar[str] = "F = a N"
    sources: ClassVar[tuple[str, ...]] = ()

    kinetic: Annotated[float, Quantity("a", low=0)]
    static: Annotated[float, Quantity("b", low=0)]
    load: Annotated[float, Quantity("N_1", "N", above=0)]

    def sliding(self, speed, load):
        return self.kinetic * load + 0.0 * speed

    def break_away(self, load):
        return where(load > self.load, self.static * load, self.kinetic * load)


@dataclass(frozen=True, kw_only=True)
class PressedAlways(Pressed):
    """The same level in slip."""

    def sliding(self, speed, load):
        return self.break_away(load) + 0.0 * speed


CAPSULE = Capsule(
    capsule_mass=0.8, inner_mass=0.2, stiffness=40.0, damping=0.2,
    drive=Torque(drive=Sine(amplitude=3.0, frequency=4.0)),
)  # fmt: skip


@pytest.mark.parametrize("tier", ["python", "compiled"])
@pytest.mark.parametrize("threshold", [5.0, 20.0])
def test_a_switch_that_depends_on_the_load_has_the_load_where_there_are_hard_stops(tier, threshold):
    law = Pressed(kinetic=0.1, static=0.13, load=threshold)
    stopped = replace(CAPSULE, lower_stop=-1.0, upper_stop=1.0)  # which nothing reaches
    solver, t = EventDriven(tier=tier), np.linspace(0.0, 1.0, 11)
    free, run = (simulate(made, law, t_end=1.0, solver=solver) for made in (CAPSULE, stopped))
    assert len(run.events) > 4
    np.testing.assert_allclose(run.at(t)["x"], free.at(t)["x"], rtol=0.0, atol=1e-9)
    paths = ["friction.kinetic", "friction.static"]
    slopes = run.differentiate(t, paths)
    np.testing.assert_allclose(slopes, free.differentiate(t, paths), rtol=0.0, atol=1e-6)
    assert np.abs(slopes[:, 0, 0]).max() > 1e-3


def test_a_switch_that_depends_on_a_load_that_friction_must_know_first_is_refused():
    body = TwoFeet(mass=1.0, front=0.1, rear=0.1, drive=Sine(amplitude=20.0, frequency=0.5))
    values = {"kinetic": 0.1, "static": 0.13, "load": 5.0}
    with pytest.raises(InputError, match="pressed has a switch that depends on the load, which is"):
        simulate(body, Pressed(**values), t_end=1.0)
    with pytest.raises(TracingError, match="PressedAlways: a switch of sliding friction must not"):
        simulate(CAPSULE, PressedAlways(**values), t_end=1.0)
