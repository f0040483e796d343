"""Experiments: rigs, measurements and trials, read from files or built from arrays."""

from stickslip.experiments.load import load_rig, rig_schema
from stickslip.experiments.measurement import QUANTITIES, Measurement
from stickslip.experiments.records import load_measurement
from stickslip.experiments.rig import Published, Rig

__all__ = [
    "QUANTITIES",
    "Measurement",
    "Published",
    "Rig",
    "load_measurement",
    "load_rig",
    "rig_schema",
]
