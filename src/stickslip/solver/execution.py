"""Runs a model in one of the two tiers: plain Python at once, or compiled by numba."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Literal, TypeAlias

import numpy as np

from stickslip.formulation import Model, formulate
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.solver.modules import is_loaded, load
from stickslip.solver.tables import Inputs, gather

__all__ = ["Record", "Tier", "execute", "prepare"]

Tier: TypeAlias = Literal["auto", "python", "compiled"]

LOG = logging.getLogger("stickslip")


@dataclass(frozen=True)
class Record:
    """What the kernels wrote down of a run."""

    module: ModuleType
    """The plain module, for what is asked of the run later."""
    log: Sequence[float]
    events: Sequence[float]
    real: Sequence[float]
    whole: Sequence[int]


def execute(
    model: Model,
    inputs: Inputs,
    y0: Sequence[float],
    *,
    t_end: float,
    tolerance: float,
    limit: int,
    tier: Tier,
) -> Record:
    """Run a model from time 0 to `t_end`."""
    module = load(model)
    compiled = tier == "compiled" or (tier == "auto" and is_loaded(model, compiled=True))
    runner = load(model, compiled=True) if compiled else module
    vector: Any = np.array if compiled else list
    real, whole = vector([0.0] * 6), vector([0] * 8)
    log, events = runner.run(
        vector([float(number) for number in inputs.p]),
        vector(inputs.table),
        vector(inputs.bounds) if inputs.bounds else vector([0.0]),
        vector([float(number) for number in y0]),
        t_end,
        tolerance,
        inputs.time_scale / 6.0,
        limit,
        real,
        whole,
    )
    return Record(module, log, events, [float(x) for x in real], [int(x) for x in whole])


def prepare(mechanism: Mechanism, law: FrictionLaw) -> None:
    """Compile the equations of a pair, or load the machine code that an earlier process left.

    Afterwards runs of the same equations in this process are compiled ones, whatever their
    parameters.
    """
    model = formulate(mechanism, law)
    if is_loaded(model, compiled=True):
        return
    LOG.info("compiling the equations once; later processes load them")
    execute(
        model,
        gather(mechanism, law, model),
        [0.0] * len(model.states),
        t_end=1e-9,
        tolerance=1e-6,
        limit=10,
        tier="compiled",
    )
