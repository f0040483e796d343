"""Laws of a user's own, whose parameter names the package has never heard of, on every route."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
import pytest

from stickslip import (
    Axis,
    CoulombViscous,
    Measurement,
    SpringBlock,
    TowedBlock,
    fit,
    select,
    simulate,
)
from stickslip.errors import InputError, UndeclaredError
from stickslip.friction import SetValuedLaw
from stickslip.identify.fits import starting_law
from stickslip.maths import exp
from stickslip.mechanisms.drives import Sampled
from stickslip.quantities import Quantity, fields_of

RATE = 200.0


@dataclass(frozen=True, kw_only=True)
class Weakening(SetValuedLaw):
    """Friction that falls by a share of its level around a speed."""

    name: ClassVar[str] = "weakening"
    title: ClassVar[str] = "Weakening"
    formula: ClassVar[str] = r"F = c N [1 - s (1 - e^{-v/v_0})]"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ("grip", "fall", "knee_speed")

    grip: Annotated[float, Quantity("c", low=0, scale="level", bounds=(0.0, 50.0), start=1.0)]
    fall: Annotated[
        float, Quantity("s", low=0, high=0.95, scale="none", bounds=(0.0, 0.95), start=0.2)
    ]
    knee_speed: Annotated[
        float, Quantity("v_0", "m/s", above=0, scale="speed", bounds=(1e-3, 3.0), start=0.2)
    ]

    def sliding(self, speed, load):
        return self.grip * load * (1.0 - self.fall * (1.0 - exp(-speed / self.knee_speed)))

    def break_away(self, load):
        return self.grip * load


@dataclass(frozen=True, kw_only=True)
class Unranged(Weakening):
    """The same, but nothing says where its knee is to be looked for."""

    name: ClassVar[str] = "unranged"
    knee_speed: Annotated[float, Quantity("v_0", "m/s", above=0)]


TRUTH = Weakening(grip=4.0, fall=0.5, knee_speed=0.15)
PATHS = tuple(f"friction.{name}" for name in fields_of(Weakening))


def noisy(values, size, seed=7):
    return values + size * np.random.default_rng(seed).normal(size=len(values))


@pytest.fixture(scope="module")
def driven():
    """A record of an axis whose force is held between samples, with white noise of position."""
    t = np.arange(0.0, 8.0, 1.0 / RATE)
    force = 9.0 * np.sin(2.0 * math.pi * 0.5 * t) + 5.0 * np.sin(2.0 * math.pi * 1.3 * t)
    axis = Axis(inertia=4.0, drive=Sampled(times=t.tolist(), values=force.tolist()))
    run = simulate(axis, TRUTH, t_end=float(t[-1]))
    return Measurement(time=t, position=noisy(run.at(t)["x"], 1e-6), force=force)


@pytest.fixture(scope="module")
def table():
    """Friction against velocity, with noise."""
    v = np.linspace(-0.8, 0.8, 801)
    return Measurement(velocity=v, friction=noisy(TRUTH.force(v, 1.0), 0.05))


def contains(found, path, true, widen=1.0):
    """Whether an interval, widened about its value, holds the truth, and tells something."""
    (estimate,) = (e for e in found.estimates if e.path == path)
    assert estimate.low < estimate.high
    assert estimate.high - estimate.low < true
    return (
        estimate.value - widen * (estimate.value - estimate.low)
        <= true
        <= (estimate.value + widen * (estimate.high - estimate.value))
    )


# Of three intervals of 95 % one misses in one test of seven: they are held at one and a half times
# their width, which three standard errors are.
WIDEN = 1.5


RAW = Unranged(grip=3.0, fall=0.3, knee_speed=0.3)


@pytest.mark.slow
@pytest.mark.parametrize("law", [RAW, pytest.param(Weakening, marks=pytest.mark.slow)])
def test_a_driven_record_gives_a_law_of_ones_own_back(driven, law):
    found = fit(Axis(inertia=4.0), law, driven)
    assert type(found.law) is (law if isinstance(law, type) else type(law))
    for path in PATHS:
        assert contains(found, path, getattr(TRUTH, path.partition(".")[2]), WIDEN), found


def test_a_force_map_gives_a_law_of_ones_own_back(table):
    found = fit(Axis(inertia=1.0), Weakening, table)
    for path in PATHS:
        assert contains(found, path, getattr(TRUTH, path.partition(".")[2]), 1.1 * WIDEN), found


@dataclass(frozen=True, kw_only=True)
class TwoPlateaus(SetValuedLaw):
    """Friction that falls twice: the second speed is at least the first."""

    name: ClassVar[str] = "two-plateaus"
    title: ClassVar[str] = "Two plateaus"
    formula: ClassVar[str] = r"F = N [a + b e^{-v/v_1} + c e^{-v/v_2}]"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = (
        "floor", "first", "second", "first_speed", "second_speed",
    )  # fmt: skip

    floor: Annotated[float, Quantity("a", low=0, scale="level", bounds=(0.0, 50.0), start=1.0)]
    first: Annotated[float, Quantity("b", low=0, scale="level", bounds=(0.0, 50.0), start=0.3)]
    second: Annotated[float, Quantity("c", low=0, scale="level", bounds=(0.0, 50.0), start=0.3)]
    first_speed: Annotated[
        float, Quantity("v_1", "m/s", above=0, scale="speed", bounds=(1e-3, 3.0), start=0.02)
    ]
    second_speed: Annotated[
        float,
        Quantity(
            "v_2", "m/s", above=0, at_least="first_speed", scale="speed", bounds=(1e-3, 3.0),
            start=0.2,
        ),
    ]  # fmt: skip

    def sliding(self, speed, load):
        fast = self.second * exp(-speed / self.second_speed)
        return load * (self.floor + self.first * exp(-speed / self.first_speed) + fast)

    def break_away(self, load):
        return load * (self.floor + self.first + self.second)


def test_a_force_map_takes_a_speed_that_is_at_least_another():
    truth = TwoPlateaus(floor=3.0, first=2.0, second=1.5, first_speed=0.01, second_speed=0.2)
    v = np.concatenate([-np.geomspace(1.0, 1e-3, 300), np.geomspace(1e-3, 1.0, 300)])
    seen = Measurement(velocity=v, friction=noisy(truth.force(v, 1.0), 0.01))
    found = fit(Axis(inertia=1.0), TwoPlateaus, seen)
    for name in fields_of(TwoPlateaus):
        assert contains(found, f"friction.{name}", getattr(truth, name), WIDEN)


def test_several_travels_give_a_law_of_ones_own_back():
    truth = Weakening(grip=0.3, fall=0.4, knee_speed=0.2)
    rig = SpringBlock(mass=1.0, stiffness=100.0)
    trials = []
    for compression in (0.05, 0.08, 0.1, 0.13, 0.16, 0.2):
        run = simulate(
            SpringBlock(mass=1.0, stiffness=100.0, compression=compression), truth, t_end=10.0
        )
        changes = {"mechanism.compression": compression}
        travel = float(run["x"][-1] - run["x"][0])
        trials.append(Measurement(travel=travel, uncertainty=1e-4, overrides=changes))
    vary, fixed = ["grip", "fall"], {"knee_speed": 0.2}
    found = fit(rig, Weakening, Measurement(trials=tuple(trials)), vary=vary, fixed=fixed)
    for name in vary:
        assert contains(found, f"friction.{name}", getattr(truth, name), WIDEN), found
        # travels are exact here: what is left is where the search ends
        assert getattr(found.law, name) == pytest.approx(getattr(truth, name), rel=0.02)


def test_a_law_of_ones_own_that_is_no_sum_of_parts_is_selected(table):
    verdict = select(Axis(inertia=1.0), [CoulombViscous, Weakening], table)
    assert verdict.best is not None
    assert verdict.best.name == "weakening"


def test_features_of_a_law_of_ones_own_are_levels_and_speeds():
    block = TowedBlock(mass=0.03, stiffness=1000.0, speed=4e-3)
    truth = Weakening(grip=0.32, fall=0.2, knee_speed=0.02)
    t = np.linspace(0.5, 4.5, 8001)
    run = simulate(block, truth, t_end=4.5).at(t)
    record = Measurement(time=t, spring_force=1000.0 * (4e-3 * t - run["x"]))
    found = fit(block, Weakening, record, vary=["grip", "fall"], fixed={"knee_speed": 0.02})
    assert found.law.grip == pytest.approx(0.32, rel=0.03)
    assert found.law.fall == pytest.approx(0.2, rel=0.1)


def test_a_parameter_without_a_range_says_which_quantity_to_complete_and_how(table, driven):
    said = (
        r"^Unranged\.knee_speed \(v_0\) has no search range: complete its Quantity,"
        r' such as Quantity\("v_0", "m/s", above=0, scale="speed", bounds=\(1e-3, 1\.0\),'
        r" start=0\.1\)"
    )
    for rig, record in ((Axis(inertia=1.0), table), (Axis(inertia=4.0), driven)):
        with pytest.raises(InputError, match=said):
            fit(rig, Unranged, record)
    with pytest.raises(InputError, match=said):
        starting_law(Unranged)
    found = fit(Axis(inertia=1.0), Unranged, table, vary=["grip", "fall"],
                fixed={"knee_speed": 0.15})  # fmt: skip
    assert contains(found, "friction.grip", 4.0, WIDEN)


@dataclass(frozen=True, kw_only=True)
class Ordered(SetValuedLaw):
    """A level, an exponent without effect, and a mark that no fit looks for."""

    name: ClassVar[str] = "ordered"
    title: ClassVar[str] = "Ordered"
    formula: ClassVar[str] = "F = c N"
    sources: ClassVar[tuple[str, ...]] = ()

    exponent: Annotated[
        float, Quantity("n", above=0, scale="none", bounds=(0.5, 2.0), start=1.0, structural=True)
    ] = 1.0
    grip: Annotated[float, Quantity("c", low=0, scale="level", bounds=(0.0, 50.0), start=1.0)] = 0.3
    mark: Annotated[float, Quantity("m", low=0)] = 0.0

    def sliding(self, speed, load):
        return self.grip * load

    def break_away(self, load):
        return self.grip * load


class Derived(Ordered):
    """A class that @dataclass has not made."""


@dataclass(frozen=True, kw_only=True)
class Slope(SetValuedLaw):
    """Says nothing of itself, and cannot be fitted."""

    slope: Annotated[float, Quantity("a", "N s/m", low=0)] = 3.0

    def sliding(self, speed, load):
        return self.slope * speed + 0.0 * load

    def break_away(self, load):
        return 0.0 * load


TRAVEL = Measurement(travel=0.20, uncertainty=0.005)
PUSH = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)


@pytest.mark.parametrize("law", [Ordered, Ordered(), Derived()])
def test_a_law_without_an_order_is_fitted_in_the_parameters_that_have_a_range(law):
    # at rest without overshoot at x = E / (mu N): 0.5 J of the spring over 9.81 N
    (estimate,) = fit(PUSH, law, TRAVEL).estimates
    assert estimate.path == "friction.grip"
    assert estimate.value == pytest.approx(0.5 / (0.20 * 9.81), rel=1e-3)


@pytest.mark.parametrize("name", ["name", "title", "formula", "sources"])
def test_what_a_law_does_not_say_of_itself_is_told_once_and_clearly(name):
    with pytest.raises(UndeclaredError, match=f"the law Slope has no {name}: declare it in the"):
        getattr(Slope(), name)
    assert not hasattr(Slope, name)


def test_a_selection_names_what_a_law_does_not_say_of_itself():
    with pytest.raises(InputError, match=r'the law Slope has no name: declare .* name = "my-law"'):
        select(PUSH, [Slope()], TRAVEL)


def test_a_selection_says_that_a_law_has_nothing_to_fit():
    names = {"name": "slope", "title": "Slope", "formula": "F = a v", "sources": ()}
    told = dataclass(frozen=True, kw_only=True)(type("Told", (Slope,), names))
    assert told.fit_order == ()
    with pytest.raises(InputError, match="nothing to fit: name a parameter of Slope in vary"):
        select(PUSH, [told()], TRAVEL)
