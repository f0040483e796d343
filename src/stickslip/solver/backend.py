"""The kernels of a tier, and the vectors they take."""

import functools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import override

from stickslip.formulation import Model
from stickslip.kernels.driver import events_are_full, log_is_full
from stickslip.kernels.state_layout import ADDRESS, BOOKS, FULL, SEVERAL, SIZE, STATUS, Sizes
from stickslip.solver.compile.modules import is_loaded, load, load_compiled


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
    sizes: Sizes
    """How much of everything the model has."""
    places: tuple[int, ...]
    """Place of each parameter in the vector of a run."""
    model: Model
    """The equations."""

    @override
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

    def whole(self) -> Any:
        """Return the whole numbers of a run that begins, which books its work."""
        if self.compiled:
            return _beginning(self.header).copy()
        whole = list(self.header)
        whole[BOOKS] = 1
        return whole

    def wholes(self, numbers: Iterable[int]) -> Any:
        """Return whole numbers as the tier takes them: a list, or an array."""
        values = [int(number) for number in numbers]
        return np.array(values, dtype=np.int64) if self.compiled else values

    def working(self, numbers: Sequence[float]) -> Any:
        """Return the vector of a run, with the parameters in it."""
        w = self.zeros(self.header[SIZE])
        for place, number in zip(self.places, numbers, strict=True):
            w[place] = number
        return self._addressed(w)

    def taken_over(self, w: Sequence[Any]) -> Any:
        """Return the vector of a run that the other tier has begun."""
        numbers = list(w)
        numbers[ADDRESS] = numbers[SEVERAL] = 0.0
        return self._addressed(self.vector(numbers))

    def run(
        self,
        w: Any,
        whole: Any,
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
            log, events = self.with_room(whole, log, events)
            self.kernels.enter_run(w, whole, table, bounds, t_end, rtol, cap, limit, log, events)
            if whole[STATUS] != FULL:
                return log, events

    def with_room(self, whole: Any, log: Any, events: Any) -> tuple[Any, Any]:
        """Return rows of steps and of events with room for a further step."""
        while log_is_full(whole, log):
            log = self._longer(log)
        while events_are_full(whole, events):
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
            w[ADDRESS : SEVERAL + 1].view(np.int64)[:] = self.equations, self.contacts
        else:
            w[ADDRESS], w[SEVERAL] = self.equations, self.contacts
        return w


@functools.lru_cache(maxsize=256)
def _beginning(header: tuple[int, ...]) -> NDArray[np.int64]:
    """Return the whole numbers of a run that begins, as an array to copy."""
    whole = np.array(header, dtype=np.int64)
    whole[BOOKS] = 1
    return whole


def runner_of(model: Model, *, compiled: bool) -> Runner:
    """Return the runner of a tier; the compiled one compiles what is not there yet."""
    tier = load_compiled(model) if compiled else load(model)
    return Runner(
        tier.kernels, tier.equations, tier.contacts, compiled, model.sizes, model.places, model
    )


def _again(model: Model, compiled: bool) -> Runner:
    """Return the runner of a pickle; machine code only where this process has it already."""
    return runner_of(model, compiled=compiled and is_loaded(model))
