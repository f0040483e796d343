"""Mechanisms by matrices: the same equations as by energies, and what is wrong is said."""

import dataclasses
import random
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
import pytest
import symengine as se
from tests.support import UNAIDED, Generated, each_of, example_of

from stickslip import Coulomb, EventDriven, MatrixMechanism, PendulumCart, ensemble, simulate
from stickslip.engine import Status
from stickslip.engine.formulation.mechanics import matrix_supply
from stickslip.engine.formulation.trace import Switchboard, Traced, expression
from stickslip.errors import InputError, UnknownNameError
from stickslip.maths import cos, sin
from stickslip.mechanisms import Contact, Mechanism, Torque
from stickslip.mechanisms.drives import Drive, Sine
from stickslip.quantities import Quantity

Mass = Annotated[float, Quantity("M", "kg", above=0)]


@dataclass(frozen=True, kw_only=True)
class MatrixCart(MatrixMechanism):
    """The cart under a pendulum by the equations of motion as they are printed."""

    name: ClassVar[str] = "matrix-cart"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "theta")
    rates: ClassVar[tuple[str, ...]] = ("v", "omega")
    units: ClassVar[tuple[str, ...]] = ("m", "rad")

    cart_mass: Mass
    ball_mass: Annotated[float, Quantity("m", "kg", above=0)]
    length: Annotated[float, Quantity("l", "m", above=0)]
    torque: Drive | None = None
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81

    def mass_matrix(self, q):
        M, m, l = self.cart_mass, self.ball_mass, self.length  # noqa: E741
        c, s = cos(q["theta"]), sin(q["theta"])
        return [[M + m, -m * l * c], [-m * l * c, m * l * l], [0.0, -m * l * s]]

    def forces(self, t, q, q_dot, drives):
        M, m, l, g = self.cart_mass, self.ball_mass, self.length, self.gravity  # noqa: E741
        c, s, omega = cos(q["theta"]), sin(q["theta"]), q_dot["theta"]
        return {
            "x": -m * l * s * omega * omega,
            "theta": m * g * l * s + drives.get("torque", 0.0),
            "y": m * l * c * omega * omega - (M + m) * g,
        }

    def potential_energy(self, t, q):
        weight = (self.cart_mass + self.ball_mass) * self.gravity
        return weight * q["y"] + self.ball_mass * self.gravity * self.length * cos(q["theta"])

    def contacts(self):
        return (Contact(slip="x", normal="y"),)

    def drives(self):
        return {} if self.torque is None else {"torque": self.torque}


@dataclass(frozen=True, kw_only=True)
class CountedCart(MatrixCart):
    """The same, with the power that its drive puts in."""

    def power(self, t, q, q_dot, drives):
        return drives.get("torque", 0.0) * q_dot["theta"]


@dataclass(frozen=True, kw_only=True)
class MistypedCart(CountedCart):
    """The same, with the sign of the centrifugal force wrong."""

    def forces(self, t, q, q_dot, drives):
        found = super().forces(t, q, q_dot, drives)
        return {**found, "x": -1.0 * found["x"]}


SIZES = {"cart_mass": 0.5, "ball_mass": 0.1, "length": 0.3}
PUSH = Sine(amplitude=0.1, frequency=1.3)
BY_ENERGIES = PendulumCart(**SIZES, pendulum=Torque(drive=PUSH))
BY_MATRICES = MatrixCart(**SIZES, torque=PUSH)
ROUNDING = 1e-12
"""A few hundred roundings: the terms of the equations stand in another order."""


@pytest.mark.parametrize("kind", each_of(UNAIDED.values()))
@pytest.mark.parametrize(
    "matrix_cart", [MatrixCart, pytest.param(CountedCart, marks=pytest.mark.slow)]
)
def test_matrices_and_energies_give_the_same_equations(matrix_cart, kind):
    law = example_of(kind)
    generated = Generated(matrix_cart(**SIZES, torque=PUSH), law)
    other = Generated(BY_ENERGIES, law)
    dice = random.Random(5)
    bristles = [1e-5] * (generated.sizes.states - 4)
    for _ in range(20):
        y = [dice.uniform(-2.0, 2.0) for _ in range(4)] + bristles
        t = dice.uniform(0.0, 2.0)
        for mode in (1, -1) if y[2] else (0,):
            y[2] = mode * abs(y[2])
            for name in ("field", "jacobian", "contact", "guards", "power"):
                expected = np.array(other.moving(name, mode, y, t=t))
                size = np.abs(expected).max() + 1.0
                # what is absent in one has no value: Painleve's pivot is 1 in both
                np.testing.assert_allclose(
                    generated.moving(name, mode, y, t=t), expected, rtol=0, atol=ROUNDING * size
                )
        assert generated.energy(y, t=t) == pytest.approx(other.energy(y, t=t), rel=ROUNDING)


def test_a_held_contact_needs_the_same_friction_by_matrices_and_energies():
    law = Coulomb(kinetic_coefficient=0.3)
    one, other = Generated(BY_MATRICES, law), Generated(BY_ENERGIES, law)
    for theta, omega in ((0.3, 1.0), (-1.2, 3.0), (2.5, -0.2)):
        y = [0.1, theta, 0.0, omega]
        for name in ("field", "contact"):
            np.testing.assert_allclose(
                one.moving(name, 0, y, t=0.4), other.moving(name, 0, y, t=0.4), atol=ROUNDING
            )


@pytest.mark.parametrize("tier", ["python", pytest.param("compiled", marks=pytest.mark.slow)])
def test_a_run_by_matrices_has_sensitivities_and_a_certificate(tier):
    law, solver = Coulomb(kinetic_coefficient=0.05), EventDriven(tier=tier)
    start = {"theta": 1.5}
    runs = [
        simulate(rig, law, t_end=1.0, y0=start, solver=solver) for rig in (BY_ENERGIES, BY_MATRICES)
    ]
    energies, matrices = runs
    assert matrices.certificate.certified
    # two texts of the same equations take the same steps, and differ by what those amplify
    np.testing.assert_allclose(matrices["x"][-1], energies["x"][-1], rtol=1e-9)
    slopes = [run.sensitivity("x", "ball_mass")[-1] for run in runs]
    np.testing.assert_allclose(slopes[1], slopes[0], rtol=1e-7)


def test_forces_that_do_not_fit_the_energies_are_found_where_the_power_is_given():
    law, start = Coulomb(kinetic_coefficient=0.05), {"theta": 1.5}
    right = simulate(CountedCart(**SIZES), law, t_end=0.5, y0=start)
    wrong = simulate(MistypedCart(**SIZES), law, t_end=0.5, y0=start, throw=False)
    assert right.certificate.certified
    assert not wrong.certificate.certified
    assert wrong.certificate.energy_error > 1e-3


def test_forces_that_the_energies_give_supply_no_power():
    q = {name: se.Symbol(name) for name in ("x", "theta", "y")}
    rates = {name: se.Symbol(f"{name}_dot") for name in q}
    places, speeds = ({i: Traced(s, Switchboard()) for i, s in at.items()} for at in (q, rates))
    free, push = MatrixCart(**SIZES), se.Symbol("F")
    energy = expression(free.kinetic_energy(places, speeds) + free.potential_energy(0.0, places))
    given = {i: expression(f) for i, f in free.forces(0.0, places, speeds, {}).items()}
    # the held coordinate's own force does work only where it moves
    still = {rates["y"]: 0}
    assert matrix_supply(None, energy.subs(still), given, q, {**rates, "y": se.Integer(0)}) == 0
    pushed = {**given, "x": given["x"] + push}
    supplied = matrix_supply(None, energy, pushed, q, rates).subs(still)
    assert se.expand(supplied - push * rates["x"]) == 0


@dataclass(frozen=True, kw_only=True)
class ShortCart(MatrixCart):
    """The row of the coordinate that is held was forgotten."""

    def mass_matrix(self, q):
        return super().mass_matrix(q)[:2]


def test_a_mass_matrix_of_another_size_says_which_rows_are_expected():
    with pytest.raises(InputError, match=r"must return 3 rows \(x, theta, y\) of 2 .* got 2 rows"):
        simulate(ShortCart(**SIZES), Coulomb(kinetic_coefficient=0.1), t_end=0.1)


@pytest.mark.parametrize("base", [PendulumCart, MatrixCart])
def test_a_force_on_a_coordinate_that_is_not_there_is_an_error(base):
    rig = base(**SIZES)
    plain = type(rig).forces

    def forces(self, t, q, q_dot, drives):
        return {**plain(self, t, q, q_dot, drives), "thetta": 1.0}

    kind = type("Mistyped", (base,), {"forces": forces, "__module__": __name__})
    assert issubclass(kind, Mechanism)
    values = {f.name: getattr(rig, f.name) for f in dataclasses.fields(rig)}
    with pytest.raises(UnknownNameError, match=r"coordinate in Mistyped.forces 'thetta'"):
        simulate(kind(**values), Coulomb(kinetic_coefficient=0.1), t_end=0.1)


def given(entries, contacts=("x",)):
    """Return a mechanism with two coordinates and a mass matrix that is given."""

    class Given(MatrixMechanism):
        name, coordinates, rates, units = "given", ("x", "z"), ("v", "w"), ("m", "m")

        def mass_matrix(self, q):
            return entries(q)

        def forces(self, t, q, q_dot, drives):
            return {"x": 3.0, "z": -1.0 * q["z"]}

        def potential_energy(self, t, q):
            return -3.0 * q["x"] + 0.5 * q["z"] * q["z"]

        def contacts(self):
            several = len(contacts) > 1
            return tuple(Contact(name=i if several else "", slip=i, load=1.0) for i in contacts)

        def drives(self):
            return {}

    return Given()


ROUGH = Coulomb(kinetic_coefficient=0.5)


@pytest.mark.parametrize("contacts", [("x",), ("x", "z")])
@pytest.mark.parametrize(
    ("entries", "match"),
    [
        (lambda q: [[1.0, 0.5], [0.2, 1.0]], r"row 'x' and column 'z' \(0\.5\) is not .* \(0\.2\)"),
        (lambda q: [[1.0, 0.5 * q["x"]], [0.2 * q["x"], 1.0]], "must be symmetric"),
        (lambda q: [[-1.0, 0.0], [0.0, 1.0]], "row and column 'x' is −1"),
        (lambda q: [[1.0, 0.0], [0.0, -2.0 + q["x"]]], "row and column 'z' is −2 at x = 0 m"),
        (lambda q: [[1.0, 2.0], [2.0, 1.0]], "entries of row and column 'z' are too large"),
        (lambda q: [[1.0, 1.0], [1.0, 1.0]], "must be positive definite"),
        (lambda q: [[0.0, 0.0], [0.0, 1.0]], "must be positive definite|masses above 0"),
    ],
)
def test_a_matrix_that_is_no_mass_is_refused_by_row_and_column(entries, match, contacts):
    with pytest.raises(InputError, match=match):
        simulate(given(entries, contacts), ROUGH, t_end=1.0)


@pytest.mark.parametrize(
    "entries",
    [
        lambda q: [[1e6, 0.5], [0.5, 1e-6]],
        lambda q: [[1.0, 1.0 - 1e-9], [1.0 - 1e-9, 1.0]],
        lambda q: [
            [1.0, 0.3 * sin(q["x"] + q["z"])],
            [0.3 * (sin(q["x"]) * cos(q["z"]) + cos(q["x"]) * sin(q["z"])), 1.0],
        ],
    ],
    ids=["units", "nearly singular", "two forms"],
)
def test_a_mass_matrix_of_any_units_conditions_and_forms_is_taken(entries):
    run = simulate(given(entries), ROUGH, t_end=0.5, y0={"z": 0.1})
    assert not run.certificate.problems


def test_masses_that_vanish_on_the_way_are_the_cause_of_steps_that_do():
    fading = given(lambda q: [[1.0, q["x"]], [q["x"], 1.0]])
    run = simulate(fading, ROUGH, t_end=2.0, y0={"z": 0.1}, throw=False)
    assert run.status is Status.STEP_TOO_SMALL
    assert "mass_matrix tends to a singular one there, at x = 1 m" in run.cause


def test_an_ensemble_with_a_matrix_that_is_no_mass_is_refused():
    class Weighed(MatrixCart):
        def mass_matrix(self, q):
            return [[self.cart_mass - 1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]

    with pytest.raises(InputError, match=r"row and column 'x' is −0\.5"):
        ensemble(
            Weighed(cart_mass=2.0, ball_mass=1.0, length=1.0), ROUGH, {"cart_mass": [2.0, 0.5]},
            t_end=1.0,
        )  # fmt: skip
