"""Sensitivities of runs with several contacts, against differences of neighbouring runs."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import pytest
from tests.contact_cases import (
    FEET,
    Arm,
    Disc,
    Plain,
    RubbingCart,
    chain,
    clutches,
    coulomb,
    decay,
)

from stickslip import EventDriven, LuGre, Stribeck, TwoFeet, ensemble, simulate
from stickslip.engine import Final, Sensitivity
from stickslip.friction import Laws, SetValuedLaw
from stickslip.maths import where
from stickslip.mechanisms import Contact
from stickslip.mechanisms.drives import Sampled
from stickslip.quantities import Quantity, parameters, vary

PLAIN = EventDriven(tier="compiled")
ARM = {"shoulder": coulomb(0.3, 0.45), "elbow": coulomb(0.12, 0.2)}
BENT = {"shoulder": 1.2, "elbow": 0.8}
FALLING = Stribeck(
    kinetic_coefficient=0.3, static_coefficient=0.45, stribeck_velocity=0.3,
    viscous_coefficient=0.2,
)  # fmt: skip
BRISTLES = LuGre(
    kinetic_coefficient=0.12, static_coefficient=0.2, stribeck_velocity=0.05,
    bristle_stiffness=2e3, bristle_damping=5.0, viscous_coefficient=0.01,
)  # fmt: skip


def changed(mechanism, laws, y0, path, by):
    """Return mechanism, laws and start with one number changed."""
    root, _, name = path.partition(".")
    if root == "initial":
        return mechanism, laws, {**(y0 or {}), name: (y0 or {}).get(name, 0.0) + by}
    holder = mechanism if root == "mechanism" else laws
    value = next(v for p, _, v in parameters(holder, root) if p == path)
    other = vary(holder, root, {path: value + by})
    return (other, laws, y0) if root == "mechanism" else (mechanism, other, y0)


def assert_slopes(mechanism, laws, t_end, y0, paths, by=1e-6, rel=1e-6):
    """Compare with central differences, whose own error is far below `rel`."""
    laws = Laws(members=tuple(laws.items())) if isinstance(laws, dict) else laws
    run = simulate(mechanism, laws, t_end=t_end, y0=y0, solver=PLAIN)
    names = [*mechanism.coordinates, *mechanism.rates]
    along = run.differentiate(run.t[-1:], list(paths))[0]
    for column, path in enumerate(paths):
        found = along[: len(names), column]
        ends = []
        for step in (by, -by):
            where = changed(mechanism, laws, y0, path, step)
            near = simulate(*where[:2], t_end=t_end, y0=where[2], solver=PLAIN)
            assert len(near.events) == len(run.events)
            ends.append(np.array([near[name][-1] for name in names]))
        slope = (ends[0] - ends[1]) / (2.0 * by)
        np.testing.assert_allclose(found, slope, atol=rel * np.abs(slope).max(), err_msg=path)
    return run


def test_an_arm_through_an_instant_in_which_two_joints_change():
    paths = ("mechanism.upper_mass", "friction.elbow.static_coefficient", "initial.shoulder")
    run = assert_slopes(Arm(), ARM, 6.9, BENT, paths)
    times = [e.t for e in run.events]
    assert len(times) > len(set(times))  # the shoulder turns and the held elbow breaks away


def test_exact_series_of_coupled_blocks():
    mechanism, laws, start = decay(3)
    assert_slopes(mechanism, laws, 1.5, start, ("mechanism.coupling", "mechanism.mass"))
    pulled = chain(2)(coupling=4.0, stiffness=1.0, speed=0.1)
    own = {"x1": coulomb(0.7, 1.0), "x2": coulomb(0.7, 1.1)}
    paths = ("mechanism.speed", "friction.x2.kinetic_coefficient", "friction.x1.static_coefficient")
    assert_slopes(pulled, own, 16.0, None, paths)


def test_clutches_whose_pressing_forces_are_drives():
    mechanism, laws, start = clutches()
    paths = ("mechanism.press", "friction.clutch-2.kinetic_coefficient")
    assert_slopes(mechanism, laws, 0.95, start, paths)


def test_a_law_that_joints_share():
    paths = ("friction.stribeck_velocity", "friction.kinetic_coefficient")
    assert_slopes(Arm(), FALLING, 1.0, BENT, paths)


@pytest.mark.parametrize(
    ("mechanism", "contacts"),
    [
        pytest.param(TwoFeet(**FEET), ("front", "rear"), id="loads that are reactions"),
        pytest.param(RubbingCart(), ("wheels", "pivot"), id="one load is a reaction"),
        pytest.param(Disc(), ("inner", "outer"), id="two contacts of one coordinate"),
    ],
)
def test_loads_and_groups(mechanism, contacts):
    laws = dict.fromkeys(contacts, FALLING)
    start = {mechanism.rates[0]: 0.8}
    paths = [
        f"friction.{contacts[0]}.kinetic_coefficient",
        f"friction.{contacts[1]}.stribeck_velocity",
    ]
    assert_slopes(mechanism, laws, 0.6, start, paths)


@pytest.mark.slow
def test_bristles_with_a_rule_for_rest():
    law = replace(
        BRISTLES, static_switch=True, bristle_stiffness=1e3, bristle_damping=20.0,
        viscous_coefficient=0.0,
    )  # fmt: skip
    pulled = chain(2)(coupling=0.2, stiffness=1.0, speed=0.1)
    laws = {"x1": law, "x2": coulomb(0.3, 0.5)}
    paths = ("mechanism.speed", "friction.x1.static_coefficient", "friction.x2.kinetic_coefficient")
    run = assert_slopes(pulled, laws, 7.3, None, paths, by=1e-4, rel=1e-4)
    assert {"break-away", "stop"} <= {e.reason for e in run.events if e.contact == "x1"}


def test_two_that_break_away_by_chance_at_once_have_no_derivative():
    """Either may be the first for parameters nearby, and the motion after it differs."""
    twins = chain(2)(coupling=4.0, stiffness=1.0, speed=0.1)
    laws = {"x1": coulomb(0.7, 1.0), "x2": coulomb(0.7, 1.0)}
    run = simulate(twins, laws, t_end=12.0, solver=PLAIN)
    assert [e.t for e in run.events[:2]] == [pytest.approx(10.0)] * 2
    assert math.isnan(run.sensitivity("x1", "friction.x1.static_coefficient")[-1])
    # what moves both alike is known: they go on together
    assert run.sensitivity("x1", "mechanism.speed")[-1] == pytest.approx(
        run.sensitivity("x2", "mechanism.speed")[-1], rel=1e-9
    )


def test_a_drive_that_jumps_is_followed():
    class Pushed(Plain):
        name = "pushed"
        coordinates = ("a", "b")
        rates = ("a_dot", "b_dot")
        units = ("m", "m")

        def kinetic_energy(self, q, q_dot):
            return 0.5 * (q_dot["a"] * q_dot["a"] + 2.0 * q_dot["b"] * q_dot["b"])

        def potential_energy(self, t, q):
            return 5.0 * (q["a"] - q["b"]) * (q["a"] - q["b"])

        def forces(self, t, q, q_dot, drives):
            return {"a": drives["push"]}

        def drives(self):
            return {"push": Sampled(times=(0.0, 0.4, 0.9), values=(6.0, 1.0, -4.0))}

        def contacts(self):
            return tuple(Contact(name=i, slip=i, load=1.0) for i in ("a", "b"))

    laws = {"a": coulomb(0.5, 0.7), "b": coulomb(0.6, 0.8)}
    paths = ("friction.a.kinetic_coefficient", "friction.b.static_coefficient")
    assert_slopes(Pushed(), laws, 1.5, None, paths)


@dataclass(frozen=True, kw_only=True)
class Stepped(SetValuedLaw):
    """A law with a switch: a higher level below a speed."""

    name: ClassVar[str] = "stepped"
    title: ClassVar[str] = "stepped"
    formula: ClassVar[str] = "F"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ("level",)
    level: Annotated[float, Quantity("mu", above=0)]
    border: Annotated[float, Quantity("v_b", "m/s", above=0)]

    def sliding(self, speed, load):
        return where(speed < self.border, 2.0 * self.level, self.level) * load

    def break_away(self, load):
        return 2.0 * self.level * load


def test_the_moment_at_which_the_switch_of_a_law_turns():
    law = {"shoulder": Stepped(level=0.15, border=0.4), "elbow": Stepped(level=0.1, border=0.6)}
    paths = ("friction.shoulder.border", "friction.elbow.level", "mechanism.gravity")
    assert_slopes(Arm(), law, 0.8, BENT, paths)


@pytest.mark.slow
def test_ensembles_have_the_sensitivities_of_single_runs():
    levels = np.array([0.25, 0.3, 0.35])
    path = "friction.shoulder.kinetic_coefficient"
    runs = ensemble(
        Arm(), ARM, {path: levels}, t_end=3.0, y0=BENT,
        outputs={"end": Final("elbow"), "slope": Sensitivity("elbow", path)},
    )  # fmt: skip
    for level, end, slope in zip(levels, runs["end"], runs["slope"], strict=True):
        laws = {**ARM, "shoulder": coulomb(float(level), 0.45)}
        run = simulate(Arm(), laws, t_end=3.0, y0=BENT, solver=PLAIN)
        assert end == pytest.approx(run["elbow"][-1], rel=1e-12)
        assert slope == pytest.approx(run.sensitivity("elbow", path)[-1], rel=1e-9)
