"""FMUs, made and run by FMPy."""

import shutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.support import SEVERAL, SHOWN

from stickslip import Coulomb, LuGre, SpringBlock, Stribeck
from stickslip.exports import export_fmu
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.drives import PiecewiseAffine

WAITS = 0.05
"""Communication step of tests with inputs [s]."""


def need_tools() -> None:
    """Skip tests where an FMU cannot be made or run."""
    if sys.platform != "linux":
        pytest.skip("FMUs are made on Linux")
    if not any(map(shutil.which, ("cc", "gcc", "clang"))):
        pytest.skip("no C compiler (cc, gcc, clang) is installed")
    pytest.importorskip("fmpy", reason="FMPy is not installed")


COULOMB = Coulomb(kinetic_coefficient=0.25)
STRIBECK = Stribeck(
    kinetic_coefficient=0.2, static_coefficient=0.35, stribeck_velocity=0.02, fading_exponent=2
)
LUGRE = LuGre(
    kinetic_coefficient=0.2,
    static_coefficient=0.3,
    stribeck_velocity=0.02,
    bristle_stiffness=1e3,
    bristle_damping=1.0,
)
BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
CAPSULE = SHOWN["capsule, stops"]
END = 2.0

TWELVE: list[tuple[str, Mechanism, FrictionLaw]] = [
    ("spring-block", BLOCK, STRIBECK),
    ("towed-block", SHOWN["towed-block"], LUGRE),
    ("towed-block, stribeck", SHOWN["towed-block"], STRIBECK),
    ("axis", SHOWN["axis"], STRIBECK),
    ("pendulum-cart", SHOWN["pendulum-cart"], COULOMB),
    ("pendulum-cart, prescribed", SHOWN["pendulum-cart, prescribed"], LUGRE),
    ("capsule, stops", CAPSULE, STRIBECK),
    ("two-mass-axis", SEVERAL["two-mass-axis"], COULOMB),
    ("block-chain", SEVERAL["block-chain"], LUGRE),
    ("clutch-train", SEVERAL["clutch-train"], STRIBECK),
    ("disc-brake, one", SEVERAL["disc-brake, one"], COULOMB),
    ("serial-arm", SEVERAL["serial-arm"], LUGRE),
]


def made(folder: Path, stem: str, *pair: Any, **settings: Any) -> Path:
    """Export for this processor, whose kernels other tests have compiled."""
    path = folder / f"{stem}.fmu"
    return export_fmu(*pair, path, **{"t_end": END, "portable": False, **settings})


class Slave:
    """An instance of an FMU."""

    def __init__(self, path: Path, folder: Path) -> None:
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        self.description: Any = read_model_description(str(path))
        place = folder / path.stem
        if not place.exists():
            extract(str(path), str(place))
        self.is_2 = self.description.fmiVersion == "2.0"
        kind: Any = FMU2Slave if self.is_2 else FMU3Slave
        self.fmu: Any = kind(
            guid=self.description.guid,
            unzipDirectory=str(place),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.messages: list[str] = []
        self._instantiate()
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.t = 0.0

    def _instantiate(self) -> None:
        from fmpy import fmi2

        def log(*arguments: Any) -> None:
            self.messages.append(arguments[-1].decode())

        if self.is_2:
            functions = fmi2.fmi2CallbackFunctions()
            functions.logger = fmi2.fmi2CallbackLoggerTYPE(log)
            self.fmu.instantiate(callbacks=functions)
        else:
            self.fmu.instantiate(logMessage=log)

    def begin(self, values: Mapping[str, float] | None = None, **settings: float) -> "Slave":
        """Initialize with some values; `settings` are start and stop time."""
        self.t = settings.get("startTime", 0.0)
        for name, value in (values or {}).items():
            self.put(name, value)
        if self.is_2:
            self.fmu.setupExperiment(startTime=self.t, stopTime=settings.get("stopTime"))
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=self.t, stopTime=settings.get("stopTime"))
        self.fmu.exitInitializationMode()
        return self

    def put(self, name: str, value: float) -> None:
        """Set a real variable."""
        call = self.fmu.setReal if self.is_2 else self.fmu.setFloat64
        call([self.variables[name].valueReference], [value])

    def got(self, *names: str) -> list[float]:
        """Return real variables."""
        call = self.fmu.getReal if self.is_2 else self.fmu.getFloat64
        return list(call([self.variables[name].valueReference for name in names]))

    def whole(self, name: str) -> int:
        """Return an integer variable."""
        call = self.fmu.getInteger if self.is_2 else self.fmu.getInt32
        return int(call([self.variables[name].valueReference])[0])

    def step(self, until: float) -> Any:
        """Take a step to a time; return what the FMU says."""
        found = self.fmu.doStep(self.t, until - self.t)
        self.t = until
        return found

    def played(self, times: Sequence[float], names: Sequence[str]) -> Any:
        """Return real variables (times, names) at times, of which the first is the present one."""
        rows = [self.got(*names)]
        for t in times[1:]:
            self.step(t)
            rows.append(self.got(*names))
        return np.array(rows)

    def close(self) -> None:
        """Free it."""
        self.fmu.freeInstance()


def column_names(slave: Slave) -> list[str]:
    """Return the real outputs."""
    real = ("Real", "Float64")
    variables = slave.description.modelVariables
    return [
        variable.name
        for variable in variables
        if variable.causality == "output" and variable.type in real
    ]


def held(values: Iterable[float]) -> PiecewiseAffine:
    """Return a drive that has each value for a communication step."""
    numbers = list(values)
    times = [*(WAITS * i for i in range(len(numbers))), WAITS * len(numbers) + 1.0]
    levels = [*numbers, numbers[-1]]
    return PiecewiseAffine(times=times, values=levels, slopes=[0.0] * len(levels))


SCRIPT = """\
import ctypes, sys
library, token, reference, stop, steps = sys.argv[1:]
fmu = ctypes.CDLL(library)
double, flag = ctypes.c_double, ctypes.c_bool
made = fmu.fmi3InstantiateCoSimulation
made.restype = ctypes.c_void_p
none, no = ctypes.c_void_p(), flag(False)
one = ctypes.c_void_p(
    made(b"one", token.encode(), None, no, no, no, no, None, ctypes.c_size_t(0), none, none, none)
)
assert one.value, "not instantiated"
begin, end = double(0.0), double(float(stop))
assert fmu.fmi3EnterInitializationMode(one, no, double(0.0), begin, flag(True), end) == 0
assert fmu.fmi3ExitInitializationMode(one) == 0
h = float(stop) / int(steps)
flags, last = [flag() for _ in range(3)], double()
for i in range(int(steps)):
    given = double(i * h), double((i + 1) * h - i * h)
    assert fmu.fmi3DoStep(one, *given, no, *map(ctypes.byref, flags), ctypes.byref(last)) == 0
vr, value = (ctypes.c_uint32 * 1)(int(reference)), (double * 1)()
assert fmu.fmi3GetFloat64(one, vr, ctypes.c_size_t(1), value, ctypes.c_size_t(1)) == 0
fmu.fmi3FreeInstance(one)
assert not any(name.startswith(("stickslip", "numpy")) for name in sys.modules)
print(value[0].hex())
"""
"""Runs an FMU of FMI 3.0 without any package, and prints a real variable at the end."""
