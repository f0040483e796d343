"""Ensembles: parameters as arrays in, arrays of outputs out."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.errors import InputError, ParameterError, check_size
from stickslip.formulation import Model, formulate
from stickslip.friction import FrictionLaw, Laws
from stickslip.kernels import enums
from stickslip.kernels.batch import EVIDENCE
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, full_path, parameters, vary
from stickslip.solver.base import path_units
from stickslip.solver.certify import passes
from stickslip.solver.chunks import Chunk, Job, run_chunks
from stickslip.solver.drive_schedule import refuse_turned
from stickslip.solver.event_driven import EventDriven, status_of
from stickslip.solver.initial_states import (
    narrowest,
    refuse_masses,
    starts_as_told,
    starts_within_stops,
)
from stickslip.solver.reducers import Final, Output, asked, is_gradient, output_unit, value_of
from stickslip.trajectory import Ensemble

Array = NDArray[np.float64]
RESERVED = ("status", "certified")
"""Columns that a table of an ensemble has of itself."""
FEWER = "make several smaller ensembles"


def run_ensemble(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    varied: Mapping[str, ArrayLike],
    *,
    y0: Sequence[float],
    told: Sequence[str],
    t_end: float,
    outputs: Sequence[str] | Mapping[str, Output] | None,
    solver: EventDriven,
    executor: Executor | None,
    progress: Callable[[int, int], object] | None,
) -> Ensemble:
    """Run an ensemble; see `stickslip.ensemble`, and `told` in `Solver.run`."""
    model = formulate(mechanism, law)
    columns, count = check_columns(mechanism, law, varied)
    wanted = _outputs(mechanism, law, model, outputs)
    told = tuple(state for state in told if f"initial.{state}" not in columns)
    kinds, arguments, places = asked(wanted, model, t_end, count)
    gradients = tuple(sorted({one.parameter for one in wanted.values() if is_gradient(one)}))
    job = Job(mechanism, law, tuple(y0), t_end, kinds, gradients, solver, told)
    parts = _Parts(job, model, wanted, places, count)

    def keep(chunk: Chunk) -> bool:
        parts.add(chunk)
        answer = None if progress is None else progress(parts.done, count)
        return answer is None or bool(answer)

    begun = starts_as_told(mechanism, columns, told)
    begun = starts_within_stops(mechanism, begun, y0)
    for row in _extreme(columns):
        state = [
            float(begun.get(f"initial.{name}", np.full(count, value))[row])
            for name, value in zip(mechanism.coordinates, y0, strict=False)
        ]
        refuse_masses(_varied(mechanism, "mechanism", columns, row), state)
    run_chunks(job, begun, arguments, executor, keep)
    bristles = model.states[2 * len(mechanism.coordinates) :]
    units = path_units(mechanism, law, bristles)
    units |= {state: units[f"initial.{state}"] for state in model.states}
    return parts.joined(columns, units)


class _Parts:
    """What came of the chunks so far."""

    def __init__(
        self,
        job: Job,
        model: Model,
        wanted: Mapping[str, Output],
        places: Mapping[str, slice],
        count: int,
    ) -> None:
        self.job, self.model, self.wanted, self.places = job, model, wanted, places
        columns, slopes = len(job.kinds) // 2, len(model.states) * len(job.gradients)
        check_size("ensemble", count * (columns + EVIDENCE + slopes), FEWER)
        self.results = np.full((count, columns), np.nan)
        self.codes = np.zeros(count, dtype=np.int8)
        self.evidence = np.full((count, EVIDENCE), np.nan)
        self.gradients = np.full((count, len(model.states), len(job.gradients)), np.nan)
        self.done = 0

    def add(self, chunk: Chunk) -> None:
        """Keep what came of a chunk."""
        rows = slice(chunk.start, chunk.start + len(chunk.statuses))
        self.results[rows], self.codes[rows] = chunk.results, chunk.statuses
        self.evidence[rows], self.gradients[rows] = chunk.evidence, chunk.gradients
        self.done += len(chunk.statuses)

    def joined(self, columns: Mapping[str, Array], units: Mapping[str, str]) -> Ensemble:
        """Return all of it."""
        wanted, evidence = self.wanted, self.evidence
        for name, output in wanted.items():
            if is_gradient(output):
                state = self.model.states.index(output.state)
                direction = self.job.gradients.index(output.parameter)
                self.results[:, self.places[name]] = self.gradients[:, state, direction, None]
        most = enums.LIMITED + len(self.model.limits)
        table = np.array([status_of(code, self.model) for code in range(most)])
        return Ensemble(
            outputs={
                name: value_of(self.results, place, wanted[name])
                for name, place in self.places.items()
            },
            parameters=columns,
            status=table[self.codes],
            certified=passes(evidence, self.job.solver.tolerance_for(self.job.law)),
            energy_error=evidence[:, 0],
            guard_violation=evidence[:, 1],
            event_residual=evidence[:, 2],
            steps=np.nan_to_num(evidence[:, 3]).astype(np.int64),
            units={
                **{path: units[path] for path in columns},
                **{name: output_unit(one, units) for name, one in wanted.items()},
            },
        )


def _outputs(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    model: Model,
    outputs: Sequence[str] | Mapping[str, Output] | None,
) -> Mapping[str, Output]:
    if isinstance(outputs, (str, Output)):
        raise InputError(f"outputs must be a sequence of names or a mapping, got {outputs!r}.")
    for name in outputs or ():
        if not _is_name(name):
            raise InputError(
                "outputs must be names of states, or a mapping from names other than"
                f" {', '.join(RESERVED)} to Final, Max, ...; got {name!r}."
            )
    if outputs is None or not isinstance(outputs, Mapping):
        return {name: Final(name) for name in (model.states if outputs is None else outputs)}
    for name, output in outputs.items():
        if not isinstance(output, Output):
            raise InputError(
                f"outputs[{name!r}] must be Final, Max, Min, Mean, Samples, EventTimes,"
                f" EventCount or Sensitivity, got {output!r}."
            )
    paths = list(_quantities(mechanism, law, model))
    return {
        name: replace(o, parameter=full_path(o.parameter, paths)) if is_gradient(o) else o
        for name, o in outputs.items()
    }


def _is_name(name: object) -> bool:
    return isinstance(name, str) and name not in RESERVED


def check_columns(
    mechanism: Mechanism, law: FrictionLaw | Laws, varied: Mapping[str, ArrayLike]
) -> tuple[dict[str, Array], int]:
    """Return what varies by full path, checked, and the number of runs."""
    model = formulate(mechanism, law)
    if not isinstance(varied, Mapping):
        raise InputError(f"parameters must be a mapping from paths to arrays, got {varied!r}.")
    known = _quantities(mechanism, law, model)
    check_size("ensemble", sum(map(np.size, varied.values())), FEWER)
    given = {
        full_path(path, list(known)): _numbers(path, values) for path, values in varied.items()
    }
    if len(given) < len(varied):
        raise InputError("parameters must name each parameter only once, got: " + ", ".join(varied))
    lengths = {len(values) for values in given.values() if values.ndim}
    if len(lengths) != 1:
        sizes = ", ".join(f"{path} {np.size(values)}" for path, values in given.items()) or "none"
        raise InputError(
            "parameters must contain at least one array, and arrays of equal length, got: " + sizes
        )
    (count,) = lengths
    if count == 0:
        raise InputError("parameters must contain at least one value each, got empty arrays.")
    columns = {path: np.broadcast_to(values, count).copy() for path, values in given.items()}
    _check(mechanism, law, model, columns, known)
    return columns, count


def _quantities(mechanism: Mechanism, law: FrictionLaw | Laws, model: Model) -> dict[str, Quantity]:
    """Return what can vary by full path."""
    known = {f"initial.{state}": Quantity(state) for state in model.states}
    for root, prefix in ((mechanism, "mechanism"), (law, "friction")):
        known |= {path: quantity for path, quantity, _ in parameters(root, prefix)}
    return known


def as_numbers(path: str, values: ArrayLike) -> Array:
    """Return values of a parameter as an array."""
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{path} must be an array of numbers, got {values!r}.") from None


def _numbers(path: str, values: ArrayLike) -> Array:
    array = as_numbers(path, values)
    if array.ndim > 1:
        raise InputError(f"{path} must be an array (n,), got one of {array.shape}.")
    return array


def _check(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    model: Model,
    columns: Mapping[str, Array],
    known: Mapping[str, Quantity],
) -> None:
    """Check ranges of all numbers, and the objects that the extreme ones make."""
    for path, values in columns.items():
        owner, _, name = path.rpartition(".")
        if not np.isfinite(values).all():
            raise ParameterError(f"{path} must be finite in all runs, got {_odd(values)}.")
        for value in (values.min(), values.max()):
            known[path].check(owner, name, float(value))
    for row in sorted(_extreme(columns) | narrowest(mechanism, columns)):
        own = _varied(mechanism, "mechanism", columns, row)
        try:
            refuse_turned(own, model)
        except InputError as error:
            raise InputError(f"run {row}: {error}") from None
        _varied(law, "friction", columns, row)
    _check_order(law, "friction", columns)


def _extreme(columns: Mapping[str, Array]) -> set[int]:
    """Return the runs with the least and the largest value of anything."""
    return {int(f(values)) for values in columns.values() for f in (np.argmin, np.argmax)}


def _odd(values: Array) -> str:
    where = int(np.flatnonzero(~np.isfinite(values))[0])
    return f"{values[where]} in run {where}"


def _varied(root: Any, prefix: str, columns: Mapping[str, Array], row: int) -> Any:
    own = {p: float(v[row]) for p, v in columns.items() if p.startswith(prefix + ".")}
    try:
        return vary(root, prefix, own) if own else root
    except ParameterError as error:
        raise ParameterError(f"run {row}: {error}") from None


def _check_order(law: FrictionLaw | Laws, prefix: str, columns: Mapping[str, Array]) -> None:
    """Check the order of parameters that must not fall below others, in all runs."""
    values = {path: value for path, _, value in parameters(law, prefix)}
    for path, quantity, value in parameters(law, prefix):
        if quantity.at_least is None:
            continue
        floor = f"{path.rpartition('.')[0]}.{quantity.at_least}"
        low = columns.get(floor, np.array(values[floor]))
        below = np.atleast_1d(columns.get(path, np.array(value)) < low)
        if below.any():
            _varied(law, prefix, columns, int(np.argmax(below)))
