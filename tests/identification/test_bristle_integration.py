"""Bristle states along a motion: machine code against arrays, and laws without machine code."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
import pytest
from typing_extensions import override

from stickslip import Dahl, ElastoPlastic, LuGre
from stickslip.friction import BristleLaw, law
from stickslip.identify.fits.parameters import with_arrays
from stickslip.identify.fits.shooting import initial_states
from stickslip.identify.fits.shooting.initial_states import Path, follow
from stickslip.maths import Scalar
from stickslip.quantities import Quantity

LEVELS = {"kinetic_coefficient": 10.0, "bristle_stiffness": 1e5}
STEP = {"static_coefficient": 14.0, "stribeck_velocity": 0.01, "viscous_coefficient": 2.0}
BY_WAY = {"forward_kinetic_coefficient": 9.0, "backward_kinetic_coefficient": 11.0}
CASES = {
    # both are exact where the rate is linear in the deflection, but for slopes by differences
    "lugre": (LuGre(**LEVELS, **STEP, bristle_damping=300.0), 1e-6),
    "dahl": (Dahl(**LEVELS), 1e-6),
    "dahl by direction": (
        law("dahl(both_ways[levels](level))")(**BY_WAY, bristle_stiffness=1e5),
        1e-6,
    ),
    # exponential Euler steps are of the second order
    "elasto-plastic": (
        ElastoPlastic(**LEVELS, **STEP, bristle_damping=3e2, elastic_share=0.5),
        1e-2,
    ),
}


def motion(count: int) -> Path:
    """Return a motion that turns often, in steps of up to two lengths of a bristle."""
    t = 1e-3 * np.arange(count)
    v = 0.1 * np.sin(4.4 * t) * np.sin(0.8 * t) + 1e-4 * np.cos(700.0 * t)
    travel = 0.5e-3 * (v[1:] + v[:-1])
    return Path(time=t, velocity=v, load=1.0 + 0.1 * np.sin(t), travel=travel)


@pytest.mark.parametrize("name", CASES)
def test_machine_code_moves_bristles_as_arrays_do(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, tolerance = CASES[name]
    field = "bristle_stiffness"
    copies = with_arrays(whole, {f"friction.{field}": np.array([1e5, 1.001e5])})
    start = np.full((len(whole.states), 2), 1e-5)
    found = follow(copies, motion(3000), start)
    monkeypatch.setattr(initial_states, "states_along", lambda *_: None)
    plain = follow(copies, motion(3000), start)
    np.testing.assert_allclose(found, plain, atol=tolerance * np.max(np.abs(plain)), rtol=0.0)


@dataclass(frozen=True, kw_only=True)
class NumPyDahl(BristleLaw):
    """A bristle whose equation is written for arrays alone."""

    name: ClassVar[str] = "numpy-dahl"
    title: ClassVar[str] = "Dahl for arrays"
    formula: ClassVar[str] = ""
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ("kinetic_coefficient",)
    states: ClassVar[tuple[str, ...]] = ("z",)

    kinetic_coefficient: Annotated[float, Quantity("mu_k", above=0)]

    @override
    def force(self, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...] = ()) -> Scalar:
        return 1e5 * states[0] * load

    @override
    def rates(
        self, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...]
    ) -> tuple[Scalar, ...]:
        return (velocity - 1e5 / self.kinetic_coefficient * np.abs(velocity) * states[0],)

    @override
    def steady(self, velocity: Scalar, load: Scalar) -> Scalar:
        return self.kinetic_coefficient * load * np.sign(velocity)

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return self.kinetic_coefficient * load


def test_a_law_written_for_arrays_alone_needs_no_machine_code() -> None:
    found = follow(NumPyDahl(kinetic_coefficient=10.0), motion(3000), np.zeros((1, 1)))
    known = follow(Dahl(**LEVELS), motion(3000), np.zeros((1, 1)))
    np.testing.assert_allclose(found, known, atol=1e-6 * np.max(np.abs(known)), rtol=0.0)
