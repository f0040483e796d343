"""Experiments: rigs, measurements and trials, from files or arrays, and what is wrong with them."""

from stickslip.experiments.carrying import (
    CarriedLaw,
    bristle_remark,
    carried,
    extrapolations,
    unfitted_bristles,
)
from stickslip.experiments.checking.data_quality import Checks, Finding, check
from stickslip.experiments.estimates import LawEstimates
from stickslip.experiments.line import Line
from stickslip.experiments.measurement import QUANTITIES, Measurement
from stickslip.experiments.records import load_measurement
from stickslip.experiments.rig import Published, Rig
from stickslip.experiments.rigs.load import load_rig, rig_schema

__all__ = [
    "QUANTITIES",
    "CarriedLaw",
    "Checks",
    "Finding",
    "LawEstimates",
    "Line",
    "Measurement",
    "Published",
    "Rig",
    "bristle_remark",
    "carried",
    "check",
    "extrapolations",
    "load_measurement",
    "load_rig",
    "rig_schema",
    "unfitted_bristles",
]
