"""The route of measured friction: parameters from force against the motion measured with it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray
from typing_extensions import override

import stickslip
from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    DirectionDependent,
    LuGre,
    Measurement,
    PowerViscous,
    QuadraticDrag,
    SpringBlock,
    Stribeck,
    Viscous,
    load_measurement,
)
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import LAWS, BristleLaw, FrictionLaw
from stickslip.identify.fits.estimation.bristle_integration import Path as Motion
from stickslip.identify.fits.estimation.bristle_integration import follow
from stickslip.identify.fits.estimation.levenberg_marquardt import OptimizeResult, search
from stickslip.identify.fits.force_map.data import stretches_of
from stickslip.identify.fits.force_map.model import ForceMap
from stickslip.identify.fits.force_map.problem import force_map
from stickslip.identify.fits.settings import SensorResponse
from stickslip.maths import Scalar
from stickslip.quantities import Quantity

Array = NDArray[np.float64]

AXIS = Axis(inertia=1.0)
OFFSET = 0.3

TRUE: Mapping[str, FrictionLaw] = {
    law.name: law
    for law in (
        Coulomb(kinetic_coefficient=0.3),
        Viscous(viscous_coefficient=12.0),
        CoulombViscous(kinetic_coefficient=0.3, viscous_coefficient=8.0),
        DirectionDependent(
            forward_kinetic_coefficient=0.3,
            backward_kinetic_coefficient=0.4,
            forward_viscous_coefficient=5.0,
            backward_viscous_coefficient=9.0,
        ),
        PowerViscous(kinetic_coefficient=0.2, viscous_coefficient=6.0, viscous_exponent=0.4),
        QuadraticDrag(kinetic_coefficient=0.3, viscous_coefficient=4.0, quadratic_coefficient=20.0),
        Stribeck(
            kinetic_coefficient=0.25,
            static_coefficient=0.4,
            stribeck_velocity=0.02,
            viscous_coefficient=6.0,
        ),
        Dahl(
            kinetic_coefficient=0.4,
            bristle_stiffness=4e3,
            yield_exponent=0.6,
            viscous_coefficient=3.0,
        ),
        LuGre(
            kinetic_coefficient=0.3,
            static_coefficient=0.4,
            stribeck_velocity=0.02,
            bristle_stiffness=3e3,
            bristle_damping=0.5,
            viscous_coefficient=3.0,
        ),
    )
}


def motion(t: Array) -> tuple[Array, Array]:
    """Return position and velocity of a motion of many amplitudes that reverses often."""
    parts = ((1e-3, 3.0, 0.0), (6e-4, 7.1, 1.0), (1.2e-2, 0.9, 0.5))
    x = sum(a * np.sin(w * t + p) for a, w, p in parts)
    v = sum(a * w * np.cos(w * t + p) for a, w, p in parts)
    return np.asarray(x), np.asarray(v)


def yielding(x: Array, law: Dahl) -> Array:
    """Return Dahl's deflections in closed form: a power of displacement between turns."""
    k, n = law.bristle_stiffness / law.kinetic_coefficient, law.yield_exponent
    share = [0.0]
    for step in np.diff(x):
        r = 1.0 - share[-1] * np.sign(step)
        left = max(abs(r) ** (1.0 - n) - (1.0 - n) * k * abs(step), 0.0) ** (1.0 / (1.0 - n))
        share.append(np.sign(step) * (1.0 - math.copysign(left, r)))
    return np.array(share) / k


def solved(t: Array, law: BristleLaw) -> Array:
    """Return deflections by a solver that this package has no part in."""
    from scipy.integrate import solve_ivp

    def slope(time: float, z: Array) -> list[float]:
        now = float(motion(np.array([time]))[1][0])
        return [float(law.rates(now, 10.0, (float(z[0]),))[0])]

    # short steps, since it does not know where the motion turns
    return solve_ivp(
        slope, (0.0, t[-1]), [0.0], "LSODA", t_eval=t, rtol=1e-8, atol=1e-12, max_step=5e-3
    ).y[0]


def record_of(law: FrictionLaw, *, end: float = 12.0, rate: float = 500.0) -> Measurement:
    """Return friction of a law without noise, and an offset."""
    t = np.arange(0.0, end, 1.0 / rate)
    x, v = motion(t)
    load = 10.0 + 2.0 * np.sin(0.5 * t)
    if law.states:
        z = yielding(x, law) if isinstance(law, Dahl) else solved(t, law)
        force = law.force(v, load, (z,))
    else:
        force = law.force(v, load)  # type: ignore[attr-defined]
    offset = 0.0 if isinstance(law, DirectionDependent) else OFFSET
    return Measurement(time=t, position=x, velocity=v, friction=force + offset, load=load)


def fitted(problem: ForceMap, *, starts: int = 2) -> tuple[OptimizeResult, dict[str, float]]:
    found = search(problem, starts=starts)
    return found, dict(zip(problem.free_parameters.paths, found.best.values, strict=True))


@pytest.mark.parametrize("name", [name for name in TRUE if name not in ("dahl", "lugre")])
def test_a_law_of_speed_alone_gives_its_parameters_back(name):
    record = record_of(TRUE[name], rate=200.0)
    found, values = fitted(force_map(LAWS[name], AXIS, record))
    if name != "direction-dependent":
        # the fit ends when a step takes less than 1e-4 off a cost that is near 0 already
        assert values.pop("mechanism.offset") == pytest.approx(OFFSET, rel=1e-3)
    assert set(values) == {f"friction.{field}" for field in LAWS[name].fit_order}
    for path, value in values.items():
        true = getattr(TRUE[name], path.removeprefix("friction."))
        assert value == pytest.approx(true, rel=2e-3), path
    assert found.best.rms < 1e-3


@pytest.mark.parametrize(
    ("name", "tolerance"), [pytest.param("dahl", 0.01, marks=pytest.mark.slow), ("lugre", 0.03)]
)
def test_a_law_of_bristles_gives_its_parameters_back(name, tolerance):
    # the velocity is constant within a step here and not in the truth: an error of second order,
    # most of it in the damping, which shows for some samples after each reversal only
    _, values = fitted(force_map(LAWS[name], AXIS, record_of(TRUE[name])))
    assert values.pop("mechanism.offset") == pytest.approx(OFFSET, rel=tolerance)
    for path, value in values.items():
        true = getattr(TRUE[name], path.removeprefix("friction."))
        assert value == pytest.approx(true, rel=tolerance), path


def loops(amplitudes: Array, samples: int = 60) -> Array:
    """Return positions that turn at plus and minus each amplitude, evenly in between."""
    turns = np.concatenate([[0.0], np.column_stack([amplitudes, -amplitudes]).ravel()])
    pieces = [np.linspace(a, b, samples, endpoint=False) for a, b in pairwise(turns)]
    return np.append(np.concatenate(pieces), turns[-1])


def dahl_force(x: Array, level: float, stiffness: float, first: float) -> Array:
    """Return Dahl's force in closed form: an exponential in displacement between turns."""
    force = [first]
    for step in np.diff(x):
        end = level * np.sign(step)
        force.append(end + (force[-1] - end) * math.exp(-stiffness / level * abs(step)))
    return np.array(force)


def test_presliding_loops_of_dahl_follow_their_closed_form_and_give_it_back():
    x = loops(1e-5 * np.arange(1.0, 9.0))
    t = 0.01 * np.arange(len(x))
    record = Measurement(time=t, position=x, friction=dahl_force(x, 4.0, 2e5, 0.0), load=10.0)
    law = Dahl(kinetic_coefficient=0.4, bristle_stiffness=2e4)
    exact = force_map(law, AXIS, record, held=["viscous_coefficient"])
    # the scheme is exact for Dahl's plain law and motion at constant velocity between samples
    assert np.max(np.abs(exact.predicted(np.array([0.4, 2e4, 0.0])) - exact.measured)) < 1e-9
    wrong = Dahl(kinetic_coefficient=0.6, bristle_stiffness=1e4)
    _, values = fitted(force_map(wrong, AXIS, record, held=["viscous_coefficient"]))
    assert values["friction.kinetic_coefficient"] == pytest.approx(0.4, rel=1e-4)
    assert values["friction.bristle_stiffness"] == pytest.approx(2e4, rel=1e-4)


def test_an_unknown_first_state_is_eliminated():
    x = loops(np.full(3, 2e-5))
    t = 0.01 * np.arange(len(x))
    law = Dahl(kinetic_coefficient=0.4, bristle_stiffness=2e4)
    force = dahl_force(x, 4.0, 2e5, -1.5)
    force[0] = -1.0  # the sample that the first guess is made from is wrong by 0.5 N
    problem = force_map(law, AXIS, Measurement(time=t, position=x, friction=force, load=10.0))
    at = np.array([0.4, 2e4, 0.0, 0.0])
    here = problem.linearise(at)
    for _ in range(3):
        here = problem.linearise(at, here)
    assert here.memory[0].start[0] * 2e5 == pytest.approx(-1.5, abs=0.05)
    assert np.max(np.abs(here.residual[5:])) < 0.05
    assert np.max(np.abs(problem.measured - problem.predicted(at))[5:]) > 0.3


def test_bristles_remember_through_rests_and_from_one_segment_to_the_next():
    there, back = np.linspace(0.0, 5e-4, 60), np.linspace(5e-4, 4.8e-4, 40)
    x = np.concatenate([there, back, np.full(900, 4.8e-4)])
    t = 0.01 * np.arange(len(x))
    force = dahl_force(x, 4.0, 2e5, 0.0)
    law = Dahl(kinetic_coefficient=0.4, bristle_stiffness=2e4)
    record = Measurement(time=t, position=x, friction=force, load=10.0)
    problem = force_map(law, AXIS, record, segment=1.0)
    values = np.array([0.4, 2e4, 0.0, 0.0])[: len(problem.free_parameters)]
    assert len(problem.spans) == 10
    last = problem.linearise(values, only=[9])
    # nine segments of rest lie between the motion and these rows; no state of their own is fitted
    np.testing.assert_allclose(last.residual + 0.0, np.zeros(100), atol=1e-9)
    whole = problem.linearise(values)
    stiffer = problem.linearise(values * np.array([1.0, 1.1, *values[2:]]), only=[9])
    assert np.all(stiffer.residual > 0.01)
    assert set(last.segment) == {9}
    assert set(whole.segment) == set(range(10))


def test_slopes_are_those_of_the_prediction():
    record = record_of(TRUE["lugre"], end=3.0)
    problem = force_map(TRUE["lugre"], AXIS, record)
    at = problem.free_parameters.start
    here = problem.linearise(at, only=range(5, 40))
    for i, value in enumerate(at):
        step = np.zeros(len(at))
        step[i] = 1e-3 * max(abs(value), 0.1)
        ends = [problem.linearise(at + s * step, only=range(5, 40)).residual for s in (1, -1)]
        central = (ends[1] - ends[0]) / (2.0 * step[i])
        # differences of 1e-3 and of 1e-5 agree to the curvature between them
        scale = np.max(np.abs(central))
        np.testing.assert_allclose(here.slopes[:, i], central, atol=0.02 * scale)


@dataclass(frozen=True, kw_only=True)
class TwoDahls(BristleLaw):
    """Two of Dahl's elements side by side, as a third party may write it."""

    name: ClassVar[str] = "two-dahls"
    title: ClassVar[str] = "Two elements"
    formula: ClassVar[str] = ""
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ("kinetic_coefficient", "soft_coefficient")
    states: ClassVar[tuple[str, ...]] = ("z", "w")

    kinetic_coefficient: Annotated[float, Quantity("mu_k", above=0)]
    soft_coefficient: Annotated[float, Quantity("mu_w", above=0)]

    @override
    def force(self, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...] = ()) -> Scalar:
        z, w = states
        return (1e4 * z + 1e3 * w) * load

    @override
    def rates(
        self, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...]
    ) -> tuple[Scalar, ...]:
        z, w = states
        return (
            velocity - 1e4 / self.kinetic_coefficient * abs(velocity) * z,
            velocity - 1e3 / self.soft_coefficient * abs(velocity) * w,
        )

    @override
    def steady(self, velocity: Scalar, load: Scalar) -> Scalar:
        return (self.kinetic_coefficient + self.soft_coefficient) * load * np.sign(velocity)

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return (self.kinetic_coefficient + self.soft_coefficient) * load


@pytest.mark.slow
def test_a_law_of_several_bristles_needs_nothing_but_its_equations():
    x = loops(2e-4 * np.arange(1.0, 9.0))
    force = dahl_force(x, 2.0, 1e5, 0.0) + dahl_force(x, 3.0, 1e4, 0.0)
    record = Measurement(time=0.01 * np.arange(len(x)), position=x, friction=force, load=10.0)
    start = TwoDahls(kinetic_coefficient=0.3, soft_coefficient=0.2)
    _, values = fitted(force_map(start, AXIS, record))
    assert values["friction.kinetic_coefficient"] == pytest.approx(0.2, rel=1e-3)
    assert values["friction.soft_coefficient"] == pytest.approx(0.3, rel=1e-3)


@pytest.mark.parametrize("exponent", [0.05, 0.5, 1.0, 1.5])
def test_steps_across_many_presliding_lengths_stay_stable(exponent):
    law = Dahl(kinetic_coefficient=0.5, bristle_stiffness=1e6, yield_exponent=exponent)
    x = loops(np.full(4, 1e-2), samples=20)  # a step is 2000 presliding lengths
    path = Motion(
        time=1.0 * np.arange(len(x)),
        velocity=np.gradient(x),
        load=np.ones(len(x)),
        travel=np.diff(x),
    )
    z = follow(law, path, np.zeros((1, 1)))[0, 2:, 0]
    reversals = np.flatnonzero(np.diff(np.sign(np.diff(x)))) + 1
    settled = np.ones(len(x), dtype=bool)
    settled[reversals + 1] = False
    # long slip in one direction: the level, with its sign; no overshoot on the way there
    level = 0.5e-6 * np.sign(np.append(0.0, np.diff(x)))
    rounded = 1e-3 if exponent <= 1.0 else 0.05  # above 1 the level is approached as a power
    np.testing.assert_allclose(z[settled[2:]], level[2:][settled[2:]], rtol=rounded)
    assert np.max(np.abs(z)) <= 0.5e-6 * (1.0 + 1e-6)


def test_a_sudden_yield_is_met_where_the_closed_form_has_it():
    # r = (1 - (1 - n) k x)^(1 / (1 - n)), and 0 from x = 1 / ((1 - n) k) on
    n, k = 0.3, 1e4
    x = np.linspace(0.0, 3e-4, 301)
    law = Dahl(kinetic_coefficient=0.5, bristle_stiffness=0.5 * k, yield_exponent=n)
    path = Motion(time=x, velocity=np.ones(301), load=np.ones(301), travel=np.diff(x))
    z = follow(law, path, np.zeros((1, 1)))[0, :, 0]
    r = np.maximum(1.0 - (1.0 - n) * k * x, 0.0) ** (1.0 / (1.0 - n))
    # within what a step is allowed to be wrong by
    np.testing.assert_allclose(z * k, 1.0 - r, atol=2e-3)


def test_a_table_without_time_is_compared_with_steady_friction():
    v = np.concatenate([-np.geomspace(1e-3, 0.3, 40), np.geomspace(1e-3, 0.3, 40)])
    truth = TRUE["stribeck"]
    table = Measurement(velocity=v, friction=truth.force(v, 10.0) + OFFSET, load=10.0)
    problem = force_map(Stribeck, AXIS, table)
    _, values = fitted(problem)
    for name in ("kinetic", "static"):
        path = f"{name}_coefficient"
        assert values[f"friction.{path}"] == pytest.approx(getattr(truth, path), rel=2e-3)
    assert values["friction.stribeck_velocity"] == pytest.approx(0.02, rel=5e-3)
    assert values["mechanism.offset"] == pytest.approx(OFFSET, rel=2e-3)
    assert problem.quantity == "friction"
    np.testing.assert_array_equal(problem.times, np.arange(80.0))


def test_slip_in_one_direction_has_no_offset_of_its_own():
    v = np.geomspace(1e-3, 0.3, 40)
    table = Measurement(velocity=v, friction=2.0 + 8.0 * v)
    problem = force_map(CoulombViscous, replace(AXIS, offset=0.5), table)
    _, values = fitted(problem)
    assert "mechanism.offset" not in values
    assert values["friction.kinetic_coefficient"] == pytest.approx(1.5, rel=1e-3)


def test_the_load_is_the_weight_where_none_was_measured():
    v = np.sin(np.linspace(0.0, 20.0, 200))
    table = Measurement(velocity=v, friction=0.25 * 2.0 * 9.81 * np.sign(v))
    problem = force_map(Coulomb, SpringBlock(mass=2.0), table)
    _, values = fitted(problem)
    assert values["friction.kinetic_coefficient"] == pytest.approx(0.25, rel=1e-6)
    # a block has no constant force: the sensor's is looked for
    assert values["measurement.offset.friction"] == pytest.approx(0.0, abs=1e-6)


def test_velocity_comes_from_positions_where_it_was_not_measured():
    truth = TRUE["coulomb-viscous"]
    record = record_of(truth)
    without = replace(record, velocity=None)
    _, values = fitted(force_map(CoulombViscous, AXIS, without))
    # parabolas over 16 ms of a motion whose fastest part takes 0.9 s
    assert values["friction.kinetic_coefficient"] == pytest.approx(0.3, rel=1e-2)
    assert values["friction.viscous_coefficient"] == pytest.approx(8.0, rel=1e-2)


def test_a_gap_begins_a_stretch_with_a_state_of_its_own():
    record = record_of(TRUE["dahl"], end=4.0)
    kept = (record.time < 1.5) | (record.time > 2.2)
    cut = Measurement(
        time=record.time[kept],
        position=record.position[kept],
        velocity=record.velocity[kept],
        friction=record.friction[kept],
        load=record.load[kept],
    )
    problem = force_map(TRUE["dahl"], AXIS, cut)
    assert len(problem.stretches) == 2
    start = problem.free_parameters.start.copy()
    start[-1] = OFFSET
    here = problem.linearise(start)
    assert here.rms < 5e-3 * np.std(record.friction)


def test_held_parameters_stay():
    record = record_of(TRUE["coulomb-viscous"], rate=100.0)
    problem = force_map(CoulombViscous, AXIS, record, held=["viscous_coefficient"])
    assert problem.free_parameters.paths == ("friction.kinetic_coefficient", "mechanism.offset")
    both = force_map(CoulombViscous, AXIS, record, held=["viscous_coefficient", "offset"])
    assert both.free_parameters.paths == ("friction.kinetic_coefficient",)
    with pytest.raises(UnknownNameError, match="stiffness"):
        force_map(CoulombViscous, AXIS, record, held=["stiffness"])
    with pytest.raises(InputError, match="there is nothing to fit: all parameters"):
        force_map(Coulomb, AXIS, record, held=["kinetic_coefficient", "mechanism.offset"])


@pytest.mark.parametrize(
    ("record", "mechanism", "message"),
    [
        (
            Measurement(time=np.arange(20.0), velocity=np.ones(20)),
            AXIS,
            r"needs friction \(F\) \[N\], and the record has only velocity",
        ),
        (
            Measurement(time=np.arange(20.0), friction=np.ones(20), name="run 3"),
            AXIS,
            r"needs velocity \(v\) \[m/s\] or position .* 'run 3' has only friction",
        ),
        (Measurement(velocity=1.0, friction=2.0), AXIS, "needs arrays"),
        (
            Measurement(velocity=np.ones(4), friction=np.ones(4)),
            AXIS,
            "at least 5 rows, and the record has 4: measure friction at more speeds",
        ),
        (
            Measurement(velocity=np.ones(20), friction=np.ones(20)),
            replace(AXIS, load=0.0),
            r"the load of Axis \(N\) of the record must be above 0 N, got 0",
        ),
        (
            Measurement(velocity=np.ones(20), friction=np.ones(20), load=-5.0),
            AXIS,
            r"Measurement.load \(N\) of the record must be above 0 N, got −5",
        ),
        (
            Measurement(
                trials=(
                    Measurement(velocity=np.ones(20), friction=np.ones(20), load=5.0),
                    Measurement(velocity=np.ones(20), friction=np.ones(20)),
                )
            ),
            AXIS,
            "in only some of the trials",
        ),
    ],
)
def test_what_is_missing_is_said(record, mechanism, message):
    with pytest.raises(InputError, match=message):
        force_map(Coulomb, mechanism, record)


def test_a_parameter_out_of_range_gives_infinite_residuals_not_an_error():
    problem = force_map(TRUE["dahl"], AXIS, record_of(TRUE["dahl"], end=1.0))
    values = problem.free_parameters.start.copy()
    values[0] = -1.0
    assert problem.linearise(values).cost == math.inf


@pytest.fixture(scope="module")
def tribometer(data_dir: Path) -> Measurement:
    return load_measurement(
        data_dir / "reciprocating_tribometer/train.parquet",
        columns={"time": "t_s", "position": "x_m", "friction": "friction_N", "load": "normal_N"},
        gain={"friction": -1},
    )


def between(record: Measurement, first: float, last: float) -> Measurement:
    kept = (record.time >= first) & (record.time < last)
    return Measurement(
        **{name: getattr(record, name)[kept] for name in ("time", *record.quantities())}
    )


def relative_error(record: Measurement, problem: ForceMap, values: Array) -> float:
    """Return rms(measured - law - offset) / rms(measured) of all samples from 75 s to 110 s."""
    judged = force_map(problem.law, AXIS, between(record, 12.0, 110.0), samples=math.inf)
    judged = replace(judged, free_parameters=problem.free_parameters)
    late = judged.times >= 75.0
    residual = judged.measured - judged.predicted(values)
    return float(np.sqrt(np.mean(residual[late] ** 2) / np.mean(judged.measured[late] ** 2)))


@pytest.mark.parametrize(
    ("law", "least", "most"),
    [
        # published 94.5 %, with an error at rest, where any force is allowed
        (Coulomb, 0.58, 0.65),
        (Dahl(kinetic_coefficient=0.4, bristle_stiffness=4e3), 0.10, 0.116),  # published 11.6 %
        # 4.8 % was reached by others; the bar is 5.5 %
        pytest.param(Dahl, 0.04, 0.05, marks=pytest.mark.slow),
    ],
)
def test_the_tribometer_record_is_predicted_as_well_as_published(tribometer, law, least, most):
    problem = force_map(law, AXIS, between(tribometer, 12.0, 75.0))
    found, _ = fitted(problem, starts=1)
    assert least < relative_error(tribometer, problem, found.best.values) < most


def strokes_and_rests(rate: float, noise: float) -> tuple[Array, Array, Array]:
    """Return times, noisy positions and velocities of strokes of 1 s with rests of 1 s between."""
    t = np.arange(0.0, 16.0, 1.0 / rate)
    v = np.where(np.floor(t) % 2, 0.0, 0.1 * np.sin(np.pi * t) * np.sign(np.sin(0.5 * np.pi * t)))
    v = np.where(np.floor(t / 4) % 2, -v, v)
    x = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) / rate)])
    return t, x + np.random.default_rng(1).normal(0.0, noise, len(t)), v


@pytest.mark.parametrize(("rate", "noise"), [(100.0, 0.0), (1000.0, 5e-6)])
def test_friction_at_rest_may_take_any_value_that_the_law_allows(rate, noise):
    # closed form: the table while it slips; at rest anything, here half of the level
    t, x, v = strokes_and_rests(rate, noise)
    friction = np.where(v == 0.0, 1.0, 2.0 * np.sign(v) + 14.0 * v)
    friction += np.random.default_rng(2).normal(0.0, 0.02, len(t))
    found = stickslip.fit(
        AXIS, CoulombViscous, Measurement(time=t, position=x, friction=friction)
    ).estimates
    for estimate, true in zip(found, (2.0, 14.0, 0.0), strict=True):
        # each is off by less than its interval, or by 1 % where noise hides the slowest slip
        assert abs(estimate.value - true) < max(estimate.high - estimate.value, 0.01 * true)


def test_a_table_may_have_rows_at_rest():
    v = np.concatenate([np.linspace(-1.0, 1.0, 40), np.zeros(20)])
    friction = 2.0 * np.sign(v) + v + np.where(v == 0.0, np.linspace(-1.9, 1.9, 60), 0.0)
    found = stickslip.fit(AXIS, CoulombViscous, Measurement(velocity=v, friction=friction))
    assert [e.value for e in found.estimates] == pytest.approx([2.0, 1.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("delay", [0.0, 0.5e-3, 0.7e-3])
def test_an_encoder_that_flickers_at_rest_is_at_rest_for_a_delayed_force_too(delay):
    t, x, v = strokes_and_rests(1000.0, 0.0)
    count = 1e-5
    flicker = (v == 0.0) & (np.random.default_rng(3).random(len(t)) < 0.3)
    position = count * (np.rint(x / count) + flicker)
    record = Measurement(time=t, position=position, friction=2.0 * np.sign(v))
    response = SensorResponse(delay=delay)
    (own,) = stretches_of(AXIS, record, response=response)
    resting = np.interp(own.path.time - delay, t, v == 0.0) == 1.0
    assert np.mean(own.path.velocity[resting] == 0.0) > 0.99


@pytest.mark.slow
def test_noise_of_positions_does_not_relax_bristles_at_rest():
    t, x, v = strokes_and_rests(1000.0, 5e-6)
    true = Dahl(kinetic_coefficient=2.0, bristle_stiffness=4e3)
    way = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) / 1000.0)])
    z = [0.0]
    for step in np.diff(way):  # closed form of Dahl's deflection along a displacement
        end = math.copysign(5e-4, step)
        z.append(end + (z[-1] - end) * math.exp(-abs(step) / 5e-4))
    friction = 4e3 * np.array(z) + np.random.default_rng(2).normal(0.0, 0.02, len(t))
    record = Measurement(time=t, position=x, friction=friction)
    found = stickslip.fit(AXIS, true, record, vary=["kinetic_coefficient", "bristle_stiffness"])
    # noise of friction and nothing else is left; without the rests it was several times as much
    assert found.rms < 0.025
    assert [e.value for e in found.estimates[:2]] == pytest.approx([2.0, 4e3], rel=0.01)


@pytest.mark.parametrize(
    "law",
    [Dahl, LuGre, Dahl(kinetic_coefficient=0.4, bristle_stiffness=1e3)],
    ids=["dahl", "lugre", "an instance"],
)
def test_bristles_are_refused_where_friction_has_no_time(law):
    v = np.linspace(-1.0, 1.0, 40)
    table = Measurement(velocity=v, friction=2.0 * np.sign(v) + v)
    with pytest.raises(InputError, match="cannot be fitted to friction against velocity: bristles"):
        stickslip.fit(Axis(inertia=1.0), law, table)


def test_velocities_within_their_noise_have_no_direction():
    t = np.arange(0.0, 12.0, 0.01)
    v = 0.1 * np.sin(1.3 * t)
    random = np.random.default_rng(2)
    friction = 2.0 * np.sign(v) + 14.0 * v + random.normal(0.0, 0.04, len(t))
    noisy = v + random.normal(0.0, 0.002, len(t))
    record = Measurement(time=t, velocity=noisy, friction=friction)
    plain, rich = (stickslip.fit(AXIS, law, record) for law in (CoulombViscous, Stribeck))
    # the noise of friction, and 14 N s/m times that of the velocity; wrong signs would cost 4 N
    assert plain.rms < 1.1 * math.hypot(0.04, 14.0 * 0.002)
    assert plain.estimates[0].value == pytest.approx(2.0, rel=0.01)
    # a static level that nothing tells gains nothing at rest
    assert rich.rms > 0.99 * plain.rms


@pytest.mark.parametrize(("samples", "said"), [(3000, 0), (9000, 1)])
def test_a_record_that_is_thinned_is_said_to_be(samples, said):
    time = np.linspace(0.0, 6.0, samples)
    velocity = 0.1 * np.cos(3.0 * time)
    friction = 2.0 * np.sign(velocity) + 5.0 * velocity
    record = Measurement(time=time, velocity=velocity, friction=friction)
    found = stickslip.fit(Axis(inertia=1.0), CoulombViscous, record)
    thinned = [remark for remark in found.remarks if "thinned" in remark]
    assert len(thinned) == said
    assert all("from 9,000 to 3,000 rows" in text for text in thinned)
