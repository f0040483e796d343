# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from dataclasses import dataclass

from collections.abc import Mapping as _Mapping
from stickslip.friction import FrictionLaw as _FrictionLaw
from stickslip.quantities import Given as _Given
from stickslip.study.characterization.battery import Bench as _Bench
from stickslip.study.characterization.battery import BreakAway as BreakAway
from stickslip.study.characterization.battery import Characteristic as Characteristic
from stickslip.study.characterization.battery import Characterization as Characterization
from stickslip.study.characterization.battery import Drift as Drift
from stickslip.study.characterization.battery import Passivity as Passivity
from stickslip.study.characterization.battery import Presliding as Presliding
from stickslip.study.characterization.battery import PreslidingLoop as PreslidingLoop
from stickslip.study.characterization.battery import SteadyCurve as SteadyCurve
from stickslip.study.characterization.battery import TESTS as TESTS
from stickslip.study.characterization.battery import characterize as characterize
from stickslip.study.characterization.battery import cycle_energy as cycle_energy
from stickslip.study.characterization.battery import presliding_length as presliding_length
from stickslip.study.characterization.battery import presliding_loop as presliding_loop

@dataclass(frozen=True, kw_only=True, init=False)
class Bench(_Bench):
    def __init__(
        self,
        *,
        law: _FrictionLaw,
        load: _Given = ...,
        mass: _Given = ...,
        inputs: _Mapping[str, float] = ...,
        scales: tuple[float, float] | None = ...,
    ) -> None: ...

__all__ = [
    "Bench",
    "BreakAway",
    "Characteristic",
    "Characterization",
    "Drift",
    "Passivity",
    "Presliding",
    "PreslidingLoop",
    "SteadyCurve",
    "TESTS",
    "characterize",
    "cycle_energy",
    "presliding_length",
    "presliding_loop",
]
