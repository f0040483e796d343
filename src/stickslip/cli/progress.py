"""Progress of work on stderr, and the workers that do it: processes here, or a cluster."""

import logging
import math
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor
from contextlib import contextmanager
from threading import Thread
from types import FrameType
from typing import Any, ClassVar, Final, Self

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from stickslip.cli import QUIET
from stickslip.cli.console import note, stderr
from stickslip.errors import InputError, SimulationError
from stickslip.show.display import require_library

# Progress of work on several laws, and of compiling ahead of time, on stderr.

BEST = "Stopping with the best fit so far; press Ctrl-C again to cancel."
"""What is said where the first interrupt ends a search."""


class Interrupts:
    """Within a `with`, the first interrupt is only noted; the second is an interrupt as ever."""

    def __init__(self) -> None:
        self.stopped = False
        """Whether the search is to end with what it has."""
        self.promise = BEST
        """What is said at the first interrupt."""
        self._before: Any = None

    def __enter__(self) -> Self:
        # Only the main thread may say what an interrupt does; elsewhere it stays as it is.
        if threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGINT, self._met)
        return self

    def __exit__(self, *_: object) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)

    def _met(self, _number: int, _frame: FrameType | None) -> None:
        if self.stopped:
            raise KeyboardInterrupt
        self.stopped = True
        note(self.promise)


SILENCE: Final = 20.0
"""Time after which a line says how far work is where no bar can be seen [s]."""
LONG: Final = 5.0
"""Time from which on lines give times [s]."""
NO_SHORTER = "Held-out blocks are evaluated to the end; press Ctrl-C again to cancel."


def _time_text(seconds: float) -> str:
    """Return a time as one says it.

    Examples
    --------
    >>> _time_text(32.4), _time_text(95.0), _time_text(4000.0)
    ('32 s', '1 min 35 s', '1 h 7 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {round(whole % 3600 / 60)} min"


def _bars(*, steady: bool = False, counted: bool = True) -> Progress:
    """Return bars; with the time left where parts are `steady`, with numbers where `counted`."""
    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        *([MofNCompleteColumn()] if counted else []),
        TextColumn("{task.fields[runs]}"),
        TimeElapsedColumn(),
        *([TimeRemainingColumn()] if steady else []),
        console=stderr(),
        transient=True,
    )


class _Shown:
    """Bars that are there within a `with`; in a file or a pipe, a line now and then.

    There is one for each step, and in a long one, one after each `SILENCE`, with the time so far
    and, where it can be estimated, the time left.
    """

    steady: ClassVar[bool] = False
    """Whether parts take about as long as each other, so that the time left can be estimated."""
    counted: ClassVar[bool] = True
    """Whether a bar has numbers beside it."""

    def __init__(self) -> None:
        bars = self._bars = _bars(steady=self.steady, counted=self.counted)
        self._first: tuple[float, float] | None = None
        self._said: set[str] = set()
        # FORCE_COLOR, as notebooks set it, makes a file a terminal, but draws nothing over there
        self._seen = bars.console.is_terminal and bars.console.file.isatty()
        self._quiet = QUIET.get()
        self._start = self._last = time.monotonic()

    def _say(self, step: str, done: float = 0.0, total: float = 0.0) -> None:
        """Write what is in work, and how far it is, where no bar can be seen."""
        now = time.monotonic()
        if self._first is None and done > 0.0:
            self._first = now, done
        new = step not in self._said
        self._said.add(step)
        if self._seen or self._quiet or not (new or now - self._last >= SILENCE):
            return
        self._last = now
        far = self._far(now - self._start, done, total)
        self._bars.console.print(f"{step}{far} ...", soft_wrap=True)

    def _far(self, elapsed: float, done: float, total: float) -> str:
        """Return how far work is, once it takes long."""
        if elapsed < LONG:
            return ""
        share = f"{done:.0f} of {total:.0f} done, " if total else ""
        return f" ({share}{_time_text(elapsed)}{self._left(elapsed, done, total)})"

    def _left(self, elapsed: float, done: float, total: float) -> str:
        """Return the time left, by the pace since the first part, which may have compiled."""
        if not (self.steady and self._first and total):
            return ""
        since, before = self._first[0] - self._start, self._first[1]
        if done <= before:
            return ""
        left = (elapsed - since) * (total - done) / (done - before)
        return f", about {_time_text(left)} left" if left else ""

    def __enter__(self) -> Self:
        if self._seen and not self._quiet:
            self._bars.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._seen and not self._quiet:
            self._bars.stop()
        self._quiet = True  # results keep whom to tell of runs, and figures make a few more


class Compiling(_Shown):
    """A bar that is there while code is compiled; callable as ``report(done, total, what)``."""

    def __init__(self) -> None:
        super().__init__()
        self._task: TaskID | None = None

    def __call__(self, done: int, total: int, what: str) -> None:
        """Note how many parts are done, and which one is in work."""
        if self._task is None:
            self._task = self._bars.add_task("", total=total, runs="")
        description = f"Compiling, once: {what}"
        self._bars.update(self._task, completed=done, description=description)
        self._say("Compiling, once: equations" if done else description, done, total)
        if done == total:
            self._bars.remove_task(self._task)
            self._task = None


class Drawing(_Shown):
    """A bar that counts what is drawn or run; callable as ``report(done, total)``.

    Parameters
    ----------
    verb : str
        Word before the bar.
    unit : str
        What is counted, whose number a second is shown; no rate if empty.
    """

    steady = True

    def __init__(self, verb: str = "Drawing", unit: str = "") -> None:
        super().__init__()
        self._verb, self._unit = verb, unit
        self._said.add(verb)  # short work is done in silence
        self._task = self._bars.add_task(verb, total=None, runs="")

    def __call__(self, done: int, total: int) -> None:
        """Note how many are done."""
        self._say(self._verb, done, total)
        self._bars.update(self._task, completed=done, total=total, runs=self._rate(done))

    def _rate(self, done: int) -> str:
        """Return how many a second, since the first ones, which may have been there."""
        if not self._unit or self._first is None:
            return ""
        since, before = self._first
        elapsed = time.monotonic() - since
        return f"{(done - before) / elapsed:.0f} {self._unit}/s" if elapsed > 1.0 else ""


class _ByLaw(_Shown):
    """A bar that counts laws in the order in which they come; some take 100 times as long."""

    counted = False

    def __init__(self, names: Sequence[str]) -> None:
        super().__init__()
        self._names = set(names)
        self._met: list[str] = []
        self._task = self._bars.add_task("", total=len(self._names), runs="")

    def _law(self, verb: str, name: str, reached: str) -> None:
        """Show which law is in work, and which of how many it is."""
        if name not in self._met:
            self._met.append(name)
        place, total = self._met.index(name) + 1, max(len(self._names), len(self._met))
        step = f"{verb} {name}"
        self._say(step, place, total)
        text = f"{step} (law {place} of {total})"
        self._bars.update(self._task, completed=len(self._met) - 1, description=text, runs=reached)

    def _far(self, elapsed: float, done: float, total: float) -> str:
        place = [f"law {done:.0f} of {total:.0f}"] if total else []
        parts = [*place, *([_time_text(elapsed)] if elapsed >= LONG else [])]
        return f" ({', '.join(parts)})" if parts else ""


class Watching(_ByLaw):
    """A bar that counts laws and names the one in work; callable as ``watch(name, runs)``.

    Parameters
    ----------
    names : sequence of str
        Laws in the order of the work.
    verb : str
        Word before the name of the law in work.
    """

    def __init__(self, names: Sequence[str], verb: str) -> None:
        super().__init__(names)
        self._verb = verb

    def __call__(self, name: str, runs: float) -> None:
        """Note that a law has had so many runs; after the next one they are those of bands."""
        verb = "Simulating" if name in self._met[:-1] else self._verb
        self._law(verb, name, f"{runs:.0f} runs")


class Searching(_ByLaw):
    """A bar that counts laws, with the least residual of the one in work.

    Callable as ``watch(name, residual)``; the answer is whether to go on. Residuals are put into
    words by `wording`.

    Parameters
    ----------
    names : sequence of str
        Laws in the order of the work.
    wording : callable
        Returns the text of a residual [SI].
    interrupts : Interrupts
        Counts Ctrl-C, which ends the search.
    """

    def __init__(
        self,
        names: Sequence[str],
        wording: Callable[[float], str],
        interrupts: Interrupts,
    ) -> None:
        super().__init__(names)
        self._told, self._interrupts = wording, interrupts

    def __call__(self, name: str, residual: float) -> bool:
        """Note how close a law has come; what is no law is validation."""
        reached = self._told(residual) if math.isfinite(residual) else ""
        if name in self._names:
            self._interrupts.promise = BEST
            self._law("Fitting", name, reached)
            return not self._interrupts.stopped
        held_out = name.startswith("held-out")
        verb = "Validating on" if held_out else "Fitting"
        self._interrupts.promise = NO_SHORTER if held_out else BEST
        self._say(f"{verb} {name}")
        self._bars.update(self._task, description=f"{verb} {name}", runs=reached)
        return not self._interrupts.stopped


class Improving(_Shown):
    """A bar that counts what a search tries, with the best so far.

    Callable as ``watch(done, total, best)``; the answer is whether to go on.

    Parameters
    ----------
    wording : callable
        Returns the text of the best value so far [SI].
    interrupts : Interrupts
        Counts Ctrl-C, which ends the search.
    """

    def __init__(self, wording: Callable[[float], str], interrupts: Interrupts) -> None:
        super().__init__()
        self._told, self._interrupts = wording, interrupts
        self._task = self._bars.add_task("Searching ", total=None, runs="")

    def __call__(self, done: int, total: int, best: float) -> bool:
        """Note how far a search is."""
        reached = self._told(best) if math.isfinite(best) else "no feasible motion yet"
        self._say("Searching", done, total)
        self._bars.update(self._task, completed=min(done, total), total=total, runs=reached)
        return not self._interrupts.stopped


# Workers that fit laws or make runs at the same time: processes here, or a cluster.

DASK: Final = "dask://"
PATIENCE: Final = "10 s"
"""How long a scheduler may take to answer."""


@contextmanager
def workers(count: int, address: str | None = None) -> Iterator[Executor | None]:
    """Yield so many processes, or nothing for one; or the executor of a cluster at an address."""
    if address is not None:
        with _cluster(address) as executor:
            yield executor
        return
    if count == 1:
        yield None
        return
    # Not forked: compiled code and the threads of progress bars do not survive a fork.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(count, mp_context=context, initializer=_subordinate) as executor:
        before = set(multiprocessing.active_children())
        try:
            yield executor
        except BaseException as error:
            for process in set(multiprocessing.active_children()) - before:
                process.kill()
            if isinstance(error, BrokenExecutor):
                raise SimulationError(
                    f"one of the {count} processes ended unexpectedly, possibly for lack of memory;"
                    " try fewer (--workers 1 needs the least memory)."
                ) from error
            raise


@contextmanager
def _cluster(address: str) -> Iterator[Executor]:
    """Yield the executor of a Dask scheduler."""
    place = address.removeprefix(DASK)
    host, _, port = place.rpartition(":")
    if not address.startswith(DASK) or not host or not port.isdecimal():
        raise InputError(f"--executor takes {DASK}HOST:PORT, got {address!r}.")
    library: Any = require_library("distributed", "dask", "use --workers")
    logging.getLogger("distributed").setLevel(logging.ERROR)  # what fails is told by an error
    try:
        client = library.Client(f"tcp://{place}", timeout=PATIENCE, set_as_default=False)
    except (OSError, TimeoutError) as error:
        raise InputError(
            f"--executor {address}: no Dask scheduler answers there: start one with `dask"
            " scheduler`, and workers with `dask worker`."
        ) from error
    with client:
        if not client.nthreads():
            raise InputError(f"--executor {address} has no workers: start one with `dask worker`.")
        try:
            yield client.get_executor()
        except library.scheduler.KilledWorker as error:
            raise SimulationError(
                f"workers at {address} end again and again, possibly for lack of memory."
            ) from error


def _subordinate() -> None:
    """Leave interrupts and standard output to the process that waits, and end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.dup2(2, 1)  # what libraries print is no part of a JSON document
    Thread(target=_end_with_parent, daemon=True).start()
    log = logging.getLogger("stickslip")
    log.addHandler(logging.StreamHandler())
    log.setLevel(logging.INFO)


def _end_with_parent() -> None:
    """End this process when the one that waits is killed, which otherwise nobody would tell it."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
