"""Switches that stand exactly at their thresholds as a run begins."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
import pytest
from tests.contact_cases import Plain, coulomb
from tests.support import quick

from stickslip import Dahl, EventDriven, Stribeck, simulate
from stickslip.engine import Status
from stickslip.maths import sin, where
from stickslip.mechanisms import Contact
from stickslip.mechanisms.drives import Drive, Pulse, Sine, Square
from stickslip.quantities import Quantity

PUSH, PULL = 1.3, -0.7


@dataclass(frozen=True, kw_only=True)
class Slider(Plain):
    """A body on a spring; it is pushed while a signal is positive, and pulled otherwise."""

    name: ClassVar[str] = "slider"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)
    signal: Drive | None = None
    force: Drive | None = None
    form: Annotated[int, Quantity("i", structural=True)] = 0

    def kinetic_energy(self, q, q_dot):
        return 0.5 * q_dot["x"] * q_dot["x"]

    def potential_energy(self, t, q):
        return 2.5 * q["x"] * q["x"]

    def pushed(self, t, drives):
        if "force" in drives:
            return drives["force"]
        seen = drives["signal"] if "signal" in drives else t if self.form == 0 else sin(3.0 * t)
        return where(seen > 0.0, PUSH, PULL)

    def forces(self, t, q, q_dot, drives):
        return {"x": self.pushed(t, drives)}

    def drives(self):
        given = {"signal": self.signal, "force": self.force}
        return {name: drive for name, drive in given.items() if drive is not None}

    def contacts(self):
        return (Contact(name="pad", slip="x", load=1.0),)


@dataclass(frozen=True, kw_only=True)
class Two(Slider):
    """Another body, which the first one pulls along by a spring."""

    name: ClassVar[str] = "two"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "y")
    rates: ClassVar[tuple[str, ...]] = ("v", "w")
    units: ClassVar[tuple[str, ...]] = ("m", "m")

    def kinetic_energy(self, q, q_dot):
        return 0.5 * (q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"])

    def potential_energy(self, t, q):
        return 2.5 * q["x"] * q["x"] + (q["y"] - q["x"]) * (q["y"] - q["x"])

    def contacts(self):
        return tuple(
            Contact(name=name, slip=q, load=1.0) for name, q in (("pad", "x"), ("pin", "y"))
        )


ONE_LAWS = {
    "coulomb": coulomb(0.1, 0.2),
    "none": coulomb(0.0),
    "stribeck": Stribeck(kinetic_coefficient=0.1, static_coefficient=0.2, stribeck_velocity=0.1),
    "dahl": Dahl(kinetic_coefficient=0.1, bristle_stiffness=100.0),
}
TWO_LAWS = {name: {"pad": law, "pin": coulomb(0.05, 0.1)} for name, law in ONE_LAWS.items()}
CASES = [(Slider, name, law) for name, law in ONE_LAWS.items()]
CASES += [(Two, name, law) for name, law in TWO_LAWS.items()]
STARTS = [{}, {"x": -0.2}, {"x": 0.2}]
SIGNALS = {
    "a drive": (
        {"signal": Sine(amplitude=1.0, frequency=0.5)},
        Square(high=PUSH, low=PULL, period=2.0),
    ),
    "the time": ({}, Pulse(level=PUSH, duration=9.0)),
    "a function of time": ({"form": 1}, Square(high=PUSH, low=PULL, period=2.0 * np.pi / 3.0)),
}


@pytest.mark.parametrize("signal", quick(SIGNALS, "a drive", "the time"))
@pytest.mark.parametrize(("kind", "name", "law"), CASES, ids=lambda one: getattr(one, "name", None))
def test_a_force_that_switches_as_the_run_begins_is_that_of_what_follows(kind, name, law, signal):
    """A force that is given as a drive has no threshold: its first value holds from time 0 on."""
    switched, force = SIGNALS[signal]
    # steps of bristles tolerate 1e-8; those of a falling law 1e-12, which grows as it falls
    tolerance = {"dahl": 1e-6, "stribeck": 1e-8}.get(name, 1e-10)
    for start in STARTS[: 1 if name == "dahl" else 3]:
        found, known = (
            simulate(kind(**own), law, t_end=2.3, y0=start, solver=EventDriven(tier="python"))
            for own in (switched, {"force": force})
        )
        changes = [
            [(e.contact, e.from_mode, e.to_mode) for e in run.events] for run in (found, known)
        ]
        assert changes[0] == changes[1]
        times = np.linspace(0.0, 2.3, 24)
        for q in (*kind.coordinates, *kind.rates):
            np.testing.assert_allclose(
                found.at(times)[q], known.at(times)[q], rtol=0, atol=tolerance, err_msg=f"{start}"
            )


class Trapped(Slider):
    """A body that is pushed back to a place from either side."""

    def forces(self, t, q, q_dot, drives):
        return {"x": where(q["x"] > 0.1, -5.0, 5.0)}


class BothTrapped(Two):
    """The same with a second body."""

    def forces(self, t, q, q_dot, drives):
        return {"x": where(q["x"] > 0.1, -5.0, 5.0)}


@pytest.mark.parametrize("kind", [Trapped, BothTrapped])
def test_a_threshold_to_which_forces_lead_back_from_both_sides_ends_the_run_in_words(kind):
    law = coulomb(0.1)
    run = simulate(kind(), law, t_end=1.0, y0={"x": 0.1}, throw=False)
    assert run.status is Status.ZENO
    assert "At 0 s these follow one another without end" in run.cause
    assert "On each side of such a threshold the forces lead back to it" in run.cause
