# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from dataclasses import dataclass

from collections.abc import Mapping as _Mapping
from stickslip.characterization.battery import Characterization as Characterization
from stickslip.characterization.battery import TESTS as TESTS
from stickslip.characterization.battery import characterize as characterize
from stickslip.characterization.bench import Bench as _Bench
from stickslip.characterization.bench import Characteristic as Characteristic
from stickslip.characterization.bench import PreslidingLoop as PreslidingLoop
from stickslip.characterization.bench import presliding_length as presliding_length
from stickslip.characterization.bench import presliding_loop as presliding_loop
from stickslip.characterization.presliding_tests import BreakAway as BreakAway
from stickslip.characterization.presliding_tests import Creep as Creep
from stickslip.characterization.presliding_tests import Drift as Drift
from stickslip.characterization.presliding_tests import Presliding as Presliding
from stickslip.characterization.sliding_tests import Lag as Lag
from stickslip.characterization.sliding_tests import Passivity as Passivity
from stickslip.characterization.sliding_tests import SteadyCurve as SteadyCurve
from stickslip.characterization.sliding_tests import cycle_energy as cycle_energy
from stickslip.characterization.stick_slip_tests import Cost as Cost
from stickslip.characterization.stick_slip_tests import Hunting as Hunting
from stickslip.characterization.stick_slip_tests import StickSlipMap as StickSlipMap
from stickslip.friction import FrictionLaw as _FrictionLaw
from stickslip.quantities import Given as _Given

@dataclass(frozen=True, kw_only=True, init=False)
class Bench(_Bench):
    def __init__(
        self,
        *,
        law: _FrictionLaw,
        load: _Given = ...,
        mass: _Given = ...,
        stiffness: _Given = ...,
        inputs: _Mapping[str, float] = ...,
        scales: tuple[float, float] | None = ...,
    ) -> None: ...

__all__ = [
    "Bench",
    "BreakAway",
    "Characteristic",
    "Characterization",
    "Cost",
    "Creep",
    "Drift",
    "Hunting",
    "Lag",
    "Passivity",
    "Presliding",
    "PreslidingLoop",
    "SteadyCurve",
    "StickSlipMap",
    "TESTS",
    "characterize",
    "cycle_energy",
    "presliding_length",
    "presliding_loop",
]
