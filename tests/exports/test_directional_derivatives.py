"""Directional derivatives of FMUs, against central differences that the importer takes."""

import ctypes
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.exports.fmus import BLOCK, CAPSULE, COULOMB, LUGRE, STRIBECK, Slave, made, need_tools
from tests.loop_cases import TRIANGLE, rotors
from tests.support import SEVERAL

from stickslip import Axis, Stribeck

AGREES = 1e-6
"""Difference over the largest derivative of one unknown: the error of the importer's differences.
"""
STEP = 1e-4
"""Distance of the differences over the size of what is varied."""
PAIR = rotors(2, ((0, -1), (1, -1), (0, 1)))(spring=1.0)
PAIRS: dict[str, Any] = {
    "slip": ((BLOCK, COULOMB), {"x": 0.03, "v": 0.2}, {}),
    "rest": ((BLOCK, STRIBECK), {"x": 0.0999, "v": 0.0}, {}),
    "bristles": ((CAPSULE, LUGRE), {"v": 0.01, "xi_dot": 0.05, "z": 1e-5}, {"fmi": 2}),
    "slips that are sums": (
        (SEVERAL["clutch-train"], STRIBECK), {"omega": 3.0, "psi1_dot": 1.0}, {"fmi": 2},
    ),
    "reactions and an input": (
        (SEVERAL["two-feet"], STRIBECK), {"v": -0.03}, {"inputs": ["drive"]},
    ),
    "held shafts": ((SEVERAL["clutch-train"], COULOMB), {}, {}),
    # of two that slip on the ground, one follows the other: they hold each other
    "a follower": (
        (PAIR, dict.fromkeys(("c0", "c1", "c2"), STRIBECK)), {"v0": 0.1, "v1": 0.1}, {},
    ),
    "held shafts in a loop": (
        (TRIANGLE(T0=0.3), dict.fromkeys(("c0", "c1", "c2"), STRIBECK)), {}, {},
    ),
}  # fmt: skip
FEW = ("bristles", "reactions and an input")
"""Each FMU takes a second to make; these have all kinds of unknowns and both versions."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need_tools()
    return tmp_path_factory.mktemp("derivatives")


class Exchanged:
    """An instance in model exchange, of either version of FMI."""

    def __init__(self, path: Path, folder: Path, start: dict[str, float]) -> None:
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Model
        from fmpy.fmi3 import FMU3Model

        self.description: Any = read_model_description(str(path))
        self.is_2 = self.description.fmiVersion == "2.0"
        place = folder / f"{path.stem}-exchange"
        extract(str(path), str(place))
        kind: Any = FMU2Model if self.is_2 else FMU3Model
        self.fmu: Any = kind(
            guid=self.description.guid,
            unzipDirectory=str(place),
            modelIdentifier=self.description.modelExchange.modelIdentifier,
            instanceName="one",
        )
        self.fmu.instantiate()
        variables = self.description.modelVariables
        self.references = {variable.name: variable.valueReference for variable in variables}
        self.states = [
            derivative.variable.derivative.name for derivative in self.description.derivatives
        ]
        self.inputs = [variable.name for variable in variables if variable.causality == "input"]
        for name, value in start.items():
            self.put(name, value)
        if self.is_2:
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()
        (self.fmu.newDiscreteStates if self.is_2 else self.fmu.updateDiscreteStates)()
        self.fmu.enterContinuousTimeMode()

    def put(self, name: str, value: float) -> None:
        """Set a variable, a state in continuous time too."""
        call = self.fmu.setReal if self.is_2 else self.fmu.setFloat64
        call([self.references[name]], [value])

    def got(self, names: Sequence[str]) -> Any:
        call = self.fmu.getReal if self.is_2 else self.fmu.getFloat64
        return np.array(call([self.references[name] for name in names]))

    def vary(self, name: str, values: dict[str, float], value: float) -> None:
        """Give one state or input another value."""
        if name in self.inputs:
            self.put(name, value)
            return
        states = [value if state == name else values[state] for state in self.states]
        self.fmu.setContinuousStates((ctypes.c_double * len(states))(*states), len(states))

    def along(self, unknowns: Sequence[str], knowns: Sequence[str], seed: Sequence[float]) -> Any:
        found = self.fmu.getDirectionalDerivative(
            [self.references[unknown] for unknown in unknowns],
            [self.references[known] for known in knowns],
            list(seed),
        )
        return np.array(found)


@pytest.mark.parametrize(
    "case", [pytest.param(c, marks=[pytest.mark.slow] * (c not in FEW)) for c in PAIRS]
)
def test_derivatives_are_those_of_central_differences(folder, case):
    pair, start, settings = PAIRS[case]
    path = made(folder, case.replace(" ", "-"), *pair, **settings)
    model = Exchanged(path, folder, start)
    real = [v for v in model.description.modelVariables if v.type in ("Real", "Float64")]
    unknowns = [
        v.name for v in real
        if v.causality == "output" or v.name.startswith(("der(", "indicator."))
    ]  # fmt: skip
    knowns = [*model.states, *model.inputs]
    at = dict(zip(knowns, model.got(knowns).tolist(), strict=True))
    sizes = {v.name: float(v.nominal or 1.0) for v in real}
    columns = []
    for known in knowns:

        def difference(h: float, known: str = known) -> Any:
            ends = []
            for side in (1.0, -1.0):
                model.vary(known, at, at[known] + side * h)
                ends.append(model.got(unknowns))
            model.vary(known, at, at[known])
            return (ends[0] - ends[1]) / (2.0 * h)

        h = STEP * max(abs(at[known]), sizes[known])
        columns.append((4.0 * difference(h / 2.0) - difference(h)) / 3.0)
    differences = np.array(columns).T
    found = np.array([model.along(unknowns, [known], [1.0]) for known in knowns]).T
    scale = np.array([sizes[known] for known in knowns])  # what each may change
    largest = np.abs(differences * scale).max(axis=1, keepdims=True)
    # differences of values of some size, of forces of some newtons, lose 1e-16 of it over the step
    rounding = 1e-15 / STEP * (1.0 + np.abs(model.got(unknowns)))[:, None]
    assert (np.abs((found - differences) * scale) <= AGREES * largest + rounding).all()
    seed = np.linspace(-1.0, 2.0, len(knowns)) * scale
    np.testing.assert_allclose(
        model.along(unknowns, knowns, seed), found @ seed, atol=1e-9 * float(np.abs(largest).max())
    )
    model.fmu.freeInstance()


def test_what_is_promised_is_declared_and_what_depends_on_what(folder):
    for fmi in (2, 3):
        path = made(folder, f"declared-{fmi}", BLOCK, COULOMB, fmi=fmi)
        model = Exchanged(path, folder, {"x": 0.03, "v": 0.2})
        text = zipfile.ZipFile(path).read("modelDescription.xml").decode()
        promise = f'providesDirectionalDerivative{"s" * (fmi == 3)}="true"'
        assert text.count(promise) == 2  # FMPy knows that of FMI 2.0 only
        known = {
            unknown.variable.name: [dependency.name for dependency in unknown.dependencies or []]
            for unknown in (*model.description.outputs, *model.description.derivatives)
        }
        assert known["x"] == ["x"]
        assert known["der(x)"] == ["v"]
        assert known["der(v)"] == known["friction"] == ["x", "v"]
        # closed form: m a = -k (x - x_0) - F while it slips and the spring is pressed
        found = model.along(["der(v)", "friction", "normal_force"], ["x"], [1.0])
        np.testing.assert_allclose(found, [-BLOCK.stiffness / BLOCK.mass, 0.0, 0.0], atol=1e-9)
        model.fmu.freeInstance()
        slave = Slave(path, folder).begin()
        slave.step(0.1)
        references = [slave.variables[name].valueReference for name in ("der(v)", "x", "v")]
        rate = slave.fmu.getDirectionalDerivative(references[:1], references[1:], [1.0, 1.0])
        assert rate[0] == pytest.approx(-BLOCK.stiffness / BLOCK.mass, abs=1e-9)
        state = slave.fmu.getFMUState() if fmi == 3 else slave.fmu.getFMUstate()
        slave.step(0.5)  # where it rests
        assert slave.whole("mode") == 0
        assert slave.fmu.getDirectionalDerivative(references[:1], references[1:], [1.0, 1.0]) == [0]
        (slave.fmu.setFMUState if fmi == 3 else slave.fmu.setFMUstate)(state)
        again = slave.fmu.getDirectionalDerivative(references[:1], references[1:], [1.0, 1.0])
        assert again == rate
        mass = slave.variables["mechanism.mass"].valueReference
        with pytest.raises(Exception, match="failed"):
            slave.fmu.getDirectionalDerivative(references[:1], [mass], [1.0])
        assert "mechanism.mass is neither a state nor an input;" in slave.messages[-1]
        for unknowns, knowns in (([references[0]], [4321]), ([4321], [references[1]])):
            with pytest.raises(Exception, match="failed"):
                slave.fmu.getDirectionalDerivative(unknowns, knowns, [1.0])
            assert slave.messages[-1].endswith("variable has the value reference 4321.")
        slave.fmu.terminate()
        with pytest.raises(Exception, match="failed"):
            slave.fmu.getDirectionalDerivative(references[:1], references[1:], [1.0, 1.0])
        assert "terminated: directional derivatives" in slave.messages[-1]
        slave.close()


def test_a_steep_fall_of_friction_is_followed(folder):
    law = Stribeck(kinetic_coefficient=1.0, static_coefficient=1.5, stribeck_velocity=1e-4)
    axis = Axis(inertia=2.0)
    path = made(folder, "steep", axis, law, inputs=["drive"])
    model = Exchanged(path, folder, {"v": 1e-4, "drive": 2.0})
    at = dict.fromkeys(model.states, 0.0)
    for share in (0.1, 0.5, 1.0, 2.0, 3.0):
        model.vary("v", at, share * 1e-4)
        # of 0.5 exp(-(v / v_s)^2), whose largest is 0.43 / v_s; extrapolation leaves 1e-10 of it
        slope = -share * np.exp(-(share**2)) / 1e-4
        found = model.along(["friction", "der(v)"], ["v"], [1.0])
        np.testing.assert_allclose(found, [slope, -slope / 2.0], atol=1e-9 * 0.43 / 1e-4)
    np.testing.assert_allclose(model.along(["der(v)"], ["drive"], [1.0]), [0.5], rtol=1e-10)
    model.fmu.freeInstance()
