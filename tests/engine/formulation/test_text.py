"""The generated text: the same everywhere, and nothing but arithmetic and math."""

import ast
import hashlib
import os
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

import pytest
import symengine as se
from tests.support import EXAMPLES, UNAIDED, Generated, example_of, pairs
from typing_extensions import override

from stickslip import Axis, Coulomb, Dahl, SpringBlock, simulate
from stickslip.engine.formulation import formulate
from stickslip.engine.formulation.model import program
from stickslip.errors import InputError, TracingError
from stickslip.friction import LAWS, SetValuedLaw
from stickslip.maths import exp, where
from stickslip.mechanisms import Contact, Mechanism
from stickslip.mechanisms.drives import Drive, Pulse
from stickslip.quantities import Quantity

PRINT_TEXTS = """
import hashlib
from tests.support import UNAIDED
from stickslip.engine.formulation import formulate
from tests.support import EXAMPLES, example_of
laws = [example_of(kind) for kind in UNAIDED.values()]
texts = [formulate(rig, law).text for rig in EXAMPLES.values() for law in laws]
print(hashlib.sha256("".join(texts).encode()).hexdigest())
"""
LOCAL = re.compile(r"[cyp]\d+|flags|mode|t|w|at|to|i|range|math")


def printed_with(seed):
    run = subprocess.run(
        [sys.executable, "-c", PRINT_TEXTS],
        env={**os.environ, "PYTHONHASHSEED": seed},
        capture_output=True,
        text=True,
        check=True,
    )
    return run.stdout.strip()


@pytest.mark.slow
@pytest.mark.parametrize("seed", ["1", "4711"])
def test_the_text_is_the_same_in_every_process(seed):
    texts = [
        formulate(rig, example_of(law)).text
        for rig in EXAMPLES.values()
        for law in UNAIDED.values()
    ]
    assert printed_with(seed) == hashlib.sha256("".join(texts).encode()).hexdigest()


@pytest.mark.parametrize(("rig", "kind"), list(pairs(UNAIDED, EXAMPLES)))
def test_generated_functions_know_only_their_arguments_and_math(rig, kind):
    tree = ast.parse(formulate(rig, example_of(kind)).text)
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    assert len(functions) >= 12
    for function in functions:
        for node in ast.walk(function):
            if isinstance(node, ast.Name):
                assert LOCAL.fullmatch(node.id), node.id
            if isinstance(node, ast.Call):
                called = ast.unparse(node.func)
                assert called == "range" or called.startswith("math.")


def test_a_number_changes_no_text_and_an_exponent_does():
    first = formulate(SpringBlock(mass=1.0), Coulomb(kinetic_coefficient=0.1)).text
    assert formulate(SpringBlock(mass=2.0), Coulomb(kinetic_coefficient=0.2)).text == first
    plain = Dahl(kinetic_coefficient=0.2, bristle_stiffness=100.0)
    square = Dahl(kinetic_coefficient=0.2, bristle_stiffness=100.0, yield_exponent=2.0)
    assert formulate(SpringBlock(mass=1.0), plain) != formulate(SpringBlock(mass=1.0), square)


def test_what_parameters_alone_decide_is_worked_out_once():
    model = formulate(SpringBlock(mass=1.0), Coulomb(kinetic_coefficient=0.1))
    assert "math" not in model.text.partition("def constants")[0]
    found = re.findall(r"math\.\w+", model.text.partition("def constants")[2])
    assert sorted(found) == ["math.cos", "math.sin"]
    assert model.sizes.constants == 2
    # that of a law's speed is not
    law = example_of(LAWS["stribeck"])
    assert "math.exp" in formulate(Axis(inertia=1.0), law).text
    assert formulate(Axis(inertia=1.0), law).sizes.constants == 0


def test_a_side_of_a_switch_that_is_not_taken_is_not_worked_out_beforehand():
    p, y = se.Symbol("p1"), se.Symbol("y0")
    sides = se.Piecewise((se.sqrt(p), y < p), (y, True))
    text, constants = program({"f": {None: [se.sin(p) * y, sides]}}, [1], 2)
    assert constants == 1
    assert "math.sqrt" in text.partition("def constants")[0]
    assert text.partition("def constants")[2].count("math.") == 1


Plain = Annotated[float, Quantity("q", above=0)]


@final
@dataclass(frozen=True, kw_only=True)
class Awkward(Mechanism):
    """A mass whose parameters, states and drive have the names of the generated text."""

    name: ClassVar[str] = "awkward"
    coordinates: ClassVar[tuple[str, ...]] = ("y0",)
    rates: ClassVar[tuple[str, ...]] = ("out",)
    units: ClassVar[tuple[str, ...]] = ("m",)

    t: Plain
    g: Plain
    p: Plain
    y: Plain
    out: Plain
    math: Plain
    flags: Plain
    p0: Plain
    c1: Plain
    N: Plain
    F: Plain
    d0: Drive

    @override
    def kinetic_energy(self, q: Mapping, q_dot: Mapping):
        return 0.5 * self.t * q_dot["y0"] * q_dot["y0"]

    @override
    def potential_energy(self, t, q: Mapping):
        return 0.5 * self.p * q["y0"] * q["y0"]

    @override
    def forces(self, t, q: Mapping, q_dot: Mapping, drives: Mapping):
        constants = self.g + self.y + self.out + self.math + self.flags + self.p0 + self.c1
        return {"y0": constants + self.F + drives["d0"] + t}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="y0", load=self.N),)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {"d0": self.d0}


def test_names_of_parameters_states_and_drives_collide_with_nothing():
    rig = Awkward(
        t=2.0, g=1.0, p=3.0, y=1.5, out=0.5, math=0.25, flags=0.125, p0=0.75, c1=2.5, N=10.0, F=4.0,
        d0=Pulse(level=7.0, duration=100.0, start=-1.0),
    )  # fmt: skip
    law = Coulomb(kinetic_coefficient=0.3)
    generated = Generated(rig, law)
    generated.equations.load_at(5.0)
    (speed, acceleration) = generated.moving("field", 1, [0.4, 0.2], t=5.0)
    constants = 1.0 + 1.5 + 0.5 + 0.25 + 0.125 + 0.75 + 2.5 + 4.0
    force = constants + 7.0 + 5.0 - 3.0 * 0.4 - 0.3 * 10.0
    assert speed == 0.2
    assert abs(acceleration - force / 2.0) <= 1e-14 * force  # a few roundings
    assert simulate(rig, law, t_end=1.0, y0={"y0": 0.1}).certificate.certified


@final
@dataclass(frozen=True, kw_only=True)
class Stepped(SetValuedLaw):
    """A law of a user: a higher level below a speed, with a named switch."""

    name: ClassVar[str] = "stepped"
    title: ClassVar[str] = "stepped"
    formula: ClassVar[str] = "F"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ("level",)

    level: Annotated[float, Quantity("mu", above=0)]
    border: Annotated[float, Quantity("v_b", "m/s", above=0)]

    @override
    def sliding(self, speed, load):
        return where(
            speed < self.border, 2.0 * self.level, self.level, ("slow", "fast")
        ) * load + 0.0 * exp(-speed)

    @override
    def break_away(self, load):
        return 2.0 * self.level * load


def test_a_law_of_a_user_runs_exactly_with_its_switch_as_an_event():
    law = Stepped(level=0.2, border=0.5)
    run = simulate(Axis(inertia=1.0, load=10.0), law, t_end=2.0, y0={"v": 1.5})
    assert [event.reason for event in run.events] == ["slow", "stop"]
    # 1 m/s lost at 2 m/s^2, then 0.5 m/s at 4 m/s^2; located to rounding
    assert abs(run.events[0].t - 0.5) <= 1e-14
    assert abs(run.events[1].t - 0.625) <= 1e-14
    travel = (1.5**2 - 0.5**2) / (2 * 2) + 0.5**2 / (2 * 4)
    assert abs(run["x"][-1] - travel) <= 1e-13  # dense output at two events


@final
@dataclass(frozen=True, kw_only=True)
class Quadratic(SetValuedLaw):
    """A law that is not affine in the load."""

    name: ClassVar[str] = "quadratic"
    title: ClassVar[str] = "quadratic"
    formula: ClassVar[str] = "F"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ()

    @override
    def sliding(self, speed, load):
        return 0.1 * load * load

    @override
    def break_away(self, load):
        return 0.1 * load


def test_a_law_that_is_not_affine_in_the_load_is_refused():
    with pytest.raises(TracingError, match=r"Quadratic: friction must be affine in the load"):
        simulate(SpringBlock(mass=1.0), Quadratic(), t_end=1.0)


@final
@dataclass(frozen=True, kw_only=True)
class Choosing(SetValuedLaw):
    """A law that uses ``if`` on a symbol."""

    name: ClassVar[str] = "choosing"
    title: ClassVar[str] = "choosing"
    formula: ClassVar[str] = "F"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ()

    @override
    def sliding(self, speed, load):
        return load if speed < 1.0 else 2.0 * load

    @override
    def break_away(self, load):
        return load


def test_a_law_with_an_if_on_the_speed_is_refused_and_told_of_where():
    with pytest.raises(TracingError, match=r"where\(condition, yes, no\)"):
        simulate(SpringBlock(mass=1.0), Choosing(), t_end=1.0)


@final
@dataclass(frozen=True, kw_only=True)
class Footed(Mechanism):
    """A mass on several feet."""

    name: ClassVar[str] = "footed"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)

    feet: int = 2

    @override
    def kinetic_energy(self, q: Mapping, q_dot: Mapping):
        return 0.5 * q_dot["x"] * q_dot["x"]

    @override
    def potential_energy(self, t, q: Mapping):
        return 0.0

    @override
    def forces(self, t, q: Mapping, q_dot: Mapping, drives: Mapping):
        return {}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", load=1.0),) * self.feet

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {}


@pytest.mark.parametrize(
    ("feet", "said"), [(0, "has no contacts"), (2, "2 contacts, which need different names")]
)
def test_contacts_that_are_missing_or_have_no_names_are_refused_in_words(feet, said):
    with pytest.raises(InputError, match=said):
        simulate(Footed(feet=feet), Coulomb(kinetic_coefficient=0.1), t_end=1.0)


def test_a_mechanism_without_potential_or_forces_runs():
    run = simulate(Footed(feet=1), Coulomb(kinetic_coefficient=0.5), t_end=5.0, y0={"v": 1.0})
    assert abs(run["x"][-1] - 1.0) <= 1e-12  # v^2 / (2 mu), within the solver's tolerance
