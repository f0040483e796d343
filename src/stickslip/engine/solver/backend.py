"""The kernels of a tier and their vectors, equations in plain numbers, and runs played back."""

import functools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.engine.formulation import Model
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.driver import events_are_full, log_is_full, piece_at
from stickslip.engine.kernels.equations import load_piece, put_constants
from stickslip.engine.kernels.mode_transitions import set_flags
from stickslip.engine.solver.compile.modules import is_loaded, load, load_compiled, plain_equations
from stickslip.engine.solver.starts import Inputs

# The kernels of a tier, and the vectors they take.


@dataclass(frozen=True)
class Runner:
    """Calls the kernels of one tier for one model."""

    kernels: Any
    """The kernels that are called."""
    equations: Any
    """Address of the compiled equations, or their functions."""
    contacts: Any
    """Address of what works out the equations of several contacts, or the function."""
    compiled: bool
    """Whether kernels and equations are machine code."""
    sizes: layout.Sizes
    """How much of everything the model has."""
    places: tuple[int, ...]
    """Place of each parameter in the vector of a run."""
    model: Model
    """The equations."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the equations: code is a process's own, and both tiers give the same bits."""
        return _again, (self.model, self.compiled)

    @functools.cached_property
    def header(self) -> tuple[int, ...]:
        """Whole numbers of a run that begins: sizes, and places in its vector."""
        return self.sizes.header

    def vector(self, numbers: Iterable[float]) -> Any:
        """Return numbers as the tier takes them: a list, or an array."""
        values = [float(number) for number in numbers]
        return np.array(values) if self.compiled else values

    def flat(self, numbers: ArrayLike) -> Any:
        """Return an array's numbers one after the other, as the tier takes them."""
        values = np.array(numbers, dtype=np.float64, order="C").ravel()  # one that can be written
        return values if self.compiled else values.tolist()

    def zeros(self, size: int) -> Any:
        """Return a vector of zeros."""
        return np.zeros(size) if self.compiled else [0.0] * size

    def iw(self) -> Any:
        """Return the whole numbers of a run that begins, which books its work."""
        return self._beginning.copy()

    @functools.cached_property
    def _beginning(self) -> Any:
        """Those whole numbers, to copy."""
        iw = self.int_vectors(self.header)
        iw[layout.BOOKS] = 1
        return iw

    def int_vectors(self, numbers: Iterable[int]) -> Any:
        """Return whole numbers as the tier takes them: a list, or an array."""
        values = [int(number) for number in numbers]
        return np.array(values, dtype=np.int64) if self.compiled else values

    def working(self, numbers: Sequence[float]) -> Any:
        """Return the vector of a run, with the parameters in it."""
        w = self._blank.copy()
        for place, number in zip(self.places, numbers, strict=True):
            w[place] = number
        return w

    @functools.cached_property
    def _blank(self) -> Any:
        """A vector without parameters, to copy."""
        return self._addressed(self.zeros(self.header[layout.SIZE]))

    def taken_over(self, w: Sequence[Any]) -> Any:
        """Return the vector of a run that the other tier has begun."""
        numbers = list(w)
        # functions in one tier and bits of addresses in the other: neither is a number to convert
        numbers[layout.ADDRESS] = numbers[layout.SEVERAL] = 0.0
        return self._addressed(self.vector(numbers))

    def run(
        self,
        w: Any,
        iw: Any,
        table: Any,
        bounds: Any,
        t_end: float,
        rtol: float,
        cap: float,
        limit: int,
        log: Any,
        events: Any,
    ) -> tuple[Any, Any]:
        """Run on to a time, as `kernels.driver.run` does, with as much room as it takes."""
        while True:
            # Before the call, too: a run that goes on may write an event before its first step.
            log, events = self.with_room(iw, log, events)
            self.kernels.enter_run(w, iw, table, bounds, t_end, rtol, cap, limit, log, events)
            if iw[layout.STATUS] != layout.FULL:
                return log, events

    def with_room(self, iw: Any, log: Any, events: Any) -> tuple[Any, Any]:
        """Return rows of steps and of events with room for a further step."""
        while log_is_full(iw, log):
            log = self._longer(log)
        while events_are_full(iw, events):
            events = self._longer(events)
        return log, events

    def _longer(self, rows: Any) -> Any:
        """Return a vector of twice the length that begins with the same numbers."""
        longer = self.zeros(2 * len(rows))
        longer[: len(rows)] = rows
        return longer

    def _addressed(self, w: Any) -> Any:
        """Put in where the equations are."""
        if self.compiled:
            # the bits of an address, which compiled code reads as a whole number
            w[layout.ADDRESS : layout.SEVERAL + 1].view(np.int64)[:] = self.equations, self.contacts
        else:
            w[layout.ADDRESS], w[layout.SEVERAL] = self.equations, self.contacts
        return w


@functools.lru_cache(maxsize=256)
def runner_of(model: Model, *, compiled: bool) -> Runner:
    """Return the runner of a tier; the compiled one compiles what is not there yet."""
    tier = load_compiled(model) if compiled else load(model)
    return Runner(
        tier.kernels, tier.equations, tier.contacts, compiled, model.sizes, model.places, model
    )


def _again(model: Model, compiled: bool) -> Runner:
    """Return the runner of a pickle; machine code only where this process has it already."""
    return runner_of(model, compiled=compiled and is_loaded(model))


# The equations of a model, called with plain numbers.


@functools.lru_cache(maxsize=8)  # the vectors of many contacts are long
def _beginning_of(
    model: Model, p: tuple[float, ...]
) -> tuple[Mapping[str, int], list[Any], list[int]]:
    """Return how many numbers each function writes, and vectors with the parameters, to copy."""
    runner, lengths = runner_of(model, compiled=False), model.sizes.lengths()
    w, iw = [*runner.working(p), *[0.0] * max(lengths.values())], runner.iw()
    put_constants(w, iw)
    return MappingProxyType(lengths), w, iw


class Equations:
    """Evaluates the equations of one mechanism with one law at any state."""

    def __init__(self, model: Model, inputs: Inputs) -> None:
        """Take the equations, and the parameters."""
        self.sizes = model.sizes
        self.functions = plain_equations(model)
        self.table: Any = inputs.table.data  # gives plain numbers, and only those asked for
        self.lengths, w, iw = _beginning_of(model, tuple(inputs.p))
        self.w, self.iw = w.copy(), iw.copy()  # states and drives are written into them
        self._first, self._last = iw[layout.Y], iw[layout.Y] + model.sizes.states
        self.width = 1 + 3 * self.iw[layout.N_DRIVES]
        self.load(0)

    def load(self, piece: int) -> None:
        """Load a piece of the drives."""
        self.piece = piece
        load_piece(self.table, piece, self.w, self.iw)

    def load_at(self, t: float) -> None:
        """Load the piece of the drives that holds at a time; times mostly go forwards."""
        begun = self.piece * self.width
        # From the first piece again only where time has gone back.
        first = self.piece if begun < len(self.table) and self.table[begun] <= t else 0
        self.load(piece_at(self.table, first, t, self.iw))  # whose numbers a loop may change

    def linear(self, t: float) -> list[float]:
        """Return the linear part of each drive at a time, in the piece that is loaded."""
        first = self.piece * self.width + 1
        row = self.table[first : first + self.width - 1]
        return [row[k] + row[k + 1] * (t - row[k + 2]) for k in range(0, len(row), 3)]

    def _put(self, y: Sequence[Any]) -> None:
        self.w[self._first : self._last] = y[: self._last - self._first]

    def flags(self, t: float, y: Sequence[Any]) -> int:
        """Return the flags of the switches that a state asks for."""
        self._put(y)
        return set_flags(t, self.w, self.iw, self.iw[layout.Y], 0, 0)

    def __call__(
        self,
        name: str,
        mode: int,
        flags: int,
        t: float,
        y: Sequence[Any],
        given: Sequence[Any] = (),
    ) -> list[Any]:
        """Return what a function of the module gives, `given` in place of its drives."""
        self._put(y)
        return self.here(name, mode, flags, t, given)

    def here(
        self, name: str, mode: int, flags: int, t: float, given: Sequence[Any] = ()
    ) -> list[Any]:
        """Return what a function gives at the state that flags were last asked for."""
        w, to = self.w, self.iw[layout.SIZE]
        if len(given):
            place = self.iw[layout.GIVEN]
            w[place : place + len(given)] = given
        self.functions[name](mode, flags, t, w, self._first, to)
        return w[to : to + self.lengths[name]]


# Plays a recorded run back at any times.

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Playback:
    """The rows of a run: start, end, length, mode, flags, piece, states, dense output."""

    model: Model
    """The equations that were run."""
    runner: Runner
    """The kernels that ran them."""
    inputs: Inputs
    """Parameters and drives of the run."""
    log: Any
    """The rows one after the other, as the tier keeps them: a list or an array."""
    rows: Array
    """The same, a row a step."""

    @classmethod
    def from_log(
        cls, model: Model, runner: Runner, inputs: Inputs, log: Sequence[float], count: int
    ) -> Self:
        """Take the recorded part of a log."""
        width = runner.header[layout.ROW_COLUMNS]
        log = log[: count * width]  # behind them is room that no step needed
        return cls(
            model, runner, inputs, log, np.asarray(log, dtype=np.float64).reshape(count, width)
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the rows; the log is made of them, as the tier takes it."""
        return _restored, (self.model, self.runner, self.inputs, self.rows)

    def span(self) -> tuple[float, float]:
        """Return the first and the last time."""
        return float(self.rows[0, 0]), float(self.rows[-1, 1])

    def times(self) -> Array:
        """Return the ends of the steps."""
        return self.column(0, self.rows[-1, 1])

    def column(self, index: int, last: float) -> Array:
        """Return a number of each row, and one more behind them."""
        result = np.empty(len(self.rows) + 1)
        result[:-1] = self.rows[:, index]
        result[-1] = last
        return result

    def played(self, t: Array) -> tuple[Array, Array, NDArray[np.intp]]:
        """Return states (n, states), forces (n, 2 + channels) and rows (n,) at times."""
        n, size, wide = len(self.model.states), len(t), self.model.sizes.columns
        states, forces, rows = (self.runner.zeros(size * width) for width in (n, wide, 1))
        self.runner.kernels.enter_play(
            self.log,
            len(self.rows),
            self.runner.flat(t),
            self.runner.flat(self.inputs.table),
            self.runner.working(self.inputs.p),
            self.runner.iw(),
            states,
            forces,
            rows,
        )
        return (
            np.reshape(states, (size, n)),
            np.reshape(forces, (size, wide)),
            np.asarray(rows, dtype=np.intp),
        )

    def __call__(self, t: Array) -> Mapping[str, Array]:
        """Return all columns at an array of times."""
        states, forces, rows = self.played(t)
        columns: dict[str, Any] = dict(zip(self.model.states, states.T, strict=True))
        columns |= dict(zip(self.model.columns, forces.T, strict=True))
        if self.model.contacts:
            for name in self.model.contacts:
                mode = self.model.column("mode", name)
                columns[mode] = columns[mode].astype(np.int8)
            return columns
        return columns | {"mode": self.rows[rows, 3].astype(np.int8)}


def _restored(model: Model, runner: Runner, inputs: Inputs, rows: Array) -> Playback:
    """Return the playback of a pickle."""
    return Playback(model, runner, inputs, runner.flat(rows), rows)
