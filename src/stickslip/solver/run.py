"""Runs a model in one of the two tiers: plain Python at once, or compiled by numba."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from stickslip.formulation import Model, formulate
from stickslip.friction import FrictionLaw, Laws
from stickslip.kernels.state_layout import EVENT_COLUMNS, ROW_COLUMNS, Y
from stickslip.mechanisms import Mechanism
from stickslip.solver.backend import Runner, runner_of
from stickslip.solver.compile.modules import is_loaded, load_compiled
from stickslip.solver.drive_schedule import Inputs

__all__ = ["Record", "Tier", "execute", "prepare"]

Tier: TypeAlias = Literal["auto", "python", "compiled"]

FIRST_ROWS = 64
"""Rows of steps and of events that a run begins with room for."""


@dataclass(frozen=True)
class Record:
    """What the kernels wrote down of a run."""

    runner: Runner
    """What ran it, for what is asked of the run later."""
    log: Sequence[float]
    """Rows of steps one after the other, laid out as in `kernels.state_layout`."""
    events: Sequence[float]
    """Rows of events one after the other."""
    w: Sequence[float]
    """The vector of the run at its end."""
    whole: list[int]
    """(WHOLES,): the whole numbers of the run at its end."""


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
    """Run a model from time 0 to `t_end`.

    Parameters
    ----------
    model : Model
        Equations of a mechanism with a law.
    inputs : Inputs
        Parameters and drives.
    y0 : sequence of float (n,)
        State at time 0: coordinates, rates, bristles [SI].
    t_end : float
        Last time [s].
    tolerance : float
        Relative tolerance of a step.
    limit : int
        Most steps.
    tier : Tier
        ``"compiled"``, ``"python"``, or ``"auto"``: machine code if this process has it already.

    Returns
    -------
    Record
        Steps, events and the vectors of the run at its end.
    """
    runner = runner_of(model, compiled=tier == "compiled" or (tier == "auto" and is_loaded(model)))
    header = runner.header
    w, whole = runner.working(inputs.p), runner.whole()
    for i, value in enumerate(y0, header[Y]):
        w[i] = float(value)
    log, events = runner.kernels.enter_run(
        w,
        whole,
        runner.flat(inputs.table),
        runner.flat(inputs.bounds if len(inputs.bounds) else [0.0]),
        t_end,
        tolerance,
        inputs.time_scale / 6.0,
        limit,
        runner.zeros(FIRST_ROWS * header[ROW_COLUMNS]),
        runner.zeros(FIRST_ROWS * EVENT_COLUMNS),
    )
    return Record(runner, log, events, w, [int(x) for x in whole])


def prepare(mechanism: Mechanism, law: FrictionLaw | Laws) -> None:
    """Compile the equations of a pair, or load the machine code that an earlier process left.

    Afterwards runs of the same equations in this process are compiled ones, whatever their
    parameters.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw
        Friction of its contact.
    """
    load_compiled(formulate(mechanism, law))
