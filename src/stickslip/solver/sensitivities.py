"""Sensitivities of a run, from its record."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import thread_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.formulation import Model, formulate
from stickslip.friction import FrictionLaw, Laws
from stickslip.kernels.sensitivities import columns_at, sense_size
from stickslip.kernels.state_layout import EVENTS, STEPS
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Parametrised, Quantity, parameters, standing_path
from stickslip.solver.backend import Runner, runner_of
from stickslip.solver.drive_schedule import Inputs, schedule_slopes
from stickslip.solver.initial_states import start_slopes
from stickslip.solver.run import Record, work_of

Array = NDArray[np.float64]


def roots_of(mechanism: Mechanism, law: FrictionLaw | Laws) -> Mapping[str, Parametrised]:
    """Return what has the parameters of a run, by the prefix of their paths."""
    return {"mechanism": mechanism, "friction": law}


def quantities_of(
    mechanism: Mechanism, law: FrictionLaw | Laws, model: Model
) -> Mapping[str, Quantity]:
    """Return what can vary by full path."""
    known = {f"initial.{state}": Quantity(state) for state in model.states}
    for prefix, root in roots_of(mechanism, law).items():
        known |= {path: quantity for path, quantity, _ in parameters(root, prefix)}
    return known


@dataclass(frozen=True)
class Directions:
    """What sensitivities are taken with respect to, as kernels take it."""

    own: Array
    """Quantity of each direction, -1 for an initial state."""
    start: Array
    """Sensitivities at the start (states, directions)."""
    table: Array
    """Derivatives of the drives' tables, a row a run; innermost a column a direction."""
    quantities: int
    """Number of quantities that the equations have."""


def directions_of(
    mechanism: Mechanism,
    model: Model,
    paths: Sequence[str],
    columns: Mapping[str, Array],
    tables: Array,
    t_end: float,
    told: Sequence[str] = (),
) -> Directions:
    """Return the directions of full paths, for runs of a model that differ by `columns`.

    `tables` has a row a run, or one where no drive varies; `told` are the states that begin where
    the mechanism says.
    """
    for path in paths:
        if path in model.turning:
            raise InputError(
                f"{path} has no sensitivity: a contact of {type(mechanism).__name__} slips along a"
                " sum of coordinates that depends on it. Choose relative coordinates, of which the"
                " slip is one, or take differences of runs."
            )
    numbers = 3 * len(model.drives)
    own = np.full(len(paths), -1.0)
    start = np.zeros((len(model.states), len(paths)))
    for c, path in enumerate(paths):
        if path in model.parameter_paths:
            own[c] = numbers + model.parameter_paths.index(path)
        else:
            start[model.states.index(path.removeprefix("initial.")), c] = 1.0
    for state, slope in start_slopes(mechanism, columns, paths, told).items():
        start[model.states.index(state)] += slope
    driven = {path: column for path, column in columns.items() if len(column) == len(tables)}
    slopes = schedule_slopes(mechanism, driven, paths, tables, t_end)
    return Directions(own, start, slopes, numbers + len(model.parameter_paths))


@dataclass(frozen=True)
class Sensing:
    """Answers how the states of a recorded run change with parameters and initial states."""

    mechanism: Mechanism
    """What moved."""
    law: FrictionLaw | Laws
    """Friction of its contact."""
    inputs: Inputs
    """Parameters and drives of the run."""
    record: Record
    """What the kernels recorded."""
    t_end: float
    """End that was asked for."""
    told: tuple[str, ...]
    """States that began where the mechanism says."""

    def __call__(self, t: Array, paths: Sequence[str]) -> Array:
        """Return sensitivities (n, states, paths) at times (n,)."""
        model = formulate(self.mechanism, self.law, slopes=True)
        full = list(paths)
        if not {*model.parameter_paths, *map("initial.{}".format, model.states)}.issuperset(paths):
            roots = roots_of(self.mechanism, self.law)
            known = quantities_of(self.mechanism, self.law, model)
            full = [standing_path(path, known, roots) for path in paths]
        record = self.record
        runner = runner_of(model, compiled=self._takes_code(model))
        table = self.inputs.table[None, :]
        along = directions_of(self.mechanism, model, full, {}, table, self.t_end, self.told)
        order = np.argsort(t, kind="stable")
        out = runner.zeros(len(t) * len(model.states) * len(full))
        log, events = record.log, record.events
        if runner.compiled is not record.runner.compiled:
            log, events = runner.flat(log), runner.flat(events)
        begun = 0.0 if runner.compiled else thread_time()
        runner.kernels.enter_sense(
            log,
            record.whole[STEPS],
            events,
            record.whole[EVENTS],
            runner.flat(t[order]),
            runner.flat(self.inputs.table),
            runner.flat(along.table),
            runner.flat(along.own),
            along.quantities,
            working(runner, runner.working(self.inputs.p), along),
            runner.whole(),
            out,
            0,
        )
        if not runner.compiled:
            work_of(model).add(thread_time() - begun)
        found = np.empty((len(t), len(model.states), len(full)))
        found[order] = np.reshape(out, found.shape)
        return found

    def _takes_code(self, model: Model) -> bool:
        """Whether machine code takes over from the tier of the run.

        It does as in runs: once plain Python has taken twice as long as getting it. The run itself
        counts, because its sensitivities take as long again at least.
        """
        spent, work = self.record.spent, work_of(model)
        if self.record.runner.compiled or spent is None:
            return self.record.runner.compiled
        return work.is_enough(spent + work.seconds)


def working(runner: Runner, w: Any, along: Directions) -> Any:
    """Return the vector of a run, made long enough, with the sensitivities at the start."""
    whole = runner.whole()
    longer = runner.zeros(sense_size(along.quantities, len(along.own), whole))
    longer[: len(w)] = w
    first = columns_at(0, along.quantities, len(along.own), whole)
    for i, value in enumerate(along.start.ravel().tolist(), first):
        longer[i] = value
    return longer
