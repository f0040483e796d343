"""Where work is executed: here, on threads, or by any executor of `concurrent.futures`."""

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextvars import copy_context
from multiprocessing import parent_process
from time import perf_counter
from typing import Any, TypeVar

from stickslip.errors import InputError

S = TypeVar("S")
T = TypeVar("T")

FAR = 128
"""Workers of an executor that does not say how many it has."""
THREADS = "STICKSLIP_THREADS"
"""Variable of the environment: how many threads work is spread over."""
MOST_THREADS = 4
"""Threads at most for short pieces of work: more only wait for the interpreter's lock."""
LEAST_WORK = 5e-3
"""Time [s] of all pieces from which threads are worth what it takes to begin them."""


class Inline(Executor):
    """Executes each task at once, where it is submitted.

    Examples
    --------
    >>> Inline().submit(max, 2, 3).result()
    3
    """

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        done: Future[T] = Future()
        try:
            done.set_result(fn(*args, **kwargs))
        except Exception as error:  # told to who asks for the result
            done.set_exception(error)
        return done


def check_executor(executor: object) -> None:
    """Refuse what takes no tasks.

    Examples
    --------
    >>> check_executor(4)
    Traceback (most recent call last):
    ...
    stickslip.errors.InputError: executor must be a concurrent.futures.Executor, got 4.
    """
    if not (executor is None or hasattr(executor, "submit")):
        raise InputError(f"executor must be a concurrent.futures.Executor, got {executor!r}.")


def workers_of(executor: Executor) -> int:
    """Return how many tasks an executor can have in work: as it says, or as many as may be.

    Examples
    --------
    >>> workers_of(ThreadPoolExecutor(3))
    3
    """
    known = getattr(executor, "_max_workers", None)
    return known if isinstance(known, int) else FAR


def threads(most: int | None = None) -> int:
    """Return how many threads work is spread over: what the environment says, or one per core.

    At most so many of these; one in the worker processes of an executor, which take the cores
    themselves. An environment that says something else than a number is refused.

    Examples
    --------
    >>> threads(1) >= 1  # exactly 1, unless STICKSLIP_THREADS says more
    True
    """
    said = os.environ.get(THREADS, "")
    if said:
        if not (said.isdecimal() and int(said) > 0):
            raise InputError(f"{THREADS} must be a number of threads from 1 on, got {said!r}.")
        return int(said)
    cores = 1 if parent_process() else os.cpu_count() or 1
    return cores if most is None else min(cores, most)


def on_threads(work: Callable[[S], T], items: Sequence[S]) -> list[T]:
    """Return what short work gives for each item, in their order, on threads if that is worth it.

    Examples
    --------
    >>> on_threads(abs, [-1, 2, -3])
    [1, 2, 3]
    """
    count = min(threads(MOST_THREADS), len(items))
    if count <= 1:
        return [work(item) for item in items]
    begun = perf_counter()
    result: list[Any] = [work(items[0]), *items[1:]]
    rest = iter(range(1, len(items)))

    def take() -> None:
        for i in rest:
            try:
                result[i] = work(items[i])
            except BaseException:
                for _ in rest:  # which ends the work of the other threads
                    pass
                raise

    if (perf_counter() - begun) * (len(items) - 1) < LEAST_WORK:
        take()
        return result
    # for this call only: a forked copy of the process would have none of its threads
    with ThreadPoolExecutor(count - 1) as pool:
        # errors of floating point are handled as they are here
        others = [pool.submit(copy_context().run, take) for _ in range(count - 1)]
        take()
    for other in others:
        other.result()
    return result


def spread(
    work: Callable[..., T],
    tasks: Iterable[Sequence[Any]],
    keep: Callable[[T], bool],
    executor: Executor | None,
) -> bool:
    """Execute tasks and hand over each result as it comes; return whether all were executed.

    Only a few tasks more than there are workers are in flight, so that memory does not grow with
    their number. Without an executor they run on threads, one per core. When `keep` answers False,
    no further tasks begin.

    Examples
    --------
    >>> found = []
    >>> spread(max, [(1, 2), (4, 3)], lambda one: found.append(one) is None, Inline()), found
    (True, [2, 4])
    """
    check_executor(executor)
    own = ThreadPoolExecutor(threads()) if executor is None else None
    pool = executor or own
    assert pool is not None
    most = 2 * workers_of(pool) + 2
    pending: set[Future[T]] = set()
    try:
        for task in tasks:
            pending.add(pool.submit(work, *task))
            while len(pending) >= most or any(future.done() for future in pending):
                pending, going = _collected(pending, keep)
                if not going:
                    return False
        while pending:
            pending, going = _collected(pending, keep)
            if not going:
                return False
    finally:
        for future in pending:
            future.cancel()
        if own is not None:
            own.shutdown(cancel_futures=True)
    return True


def _collected(pending: set[Future[T]], keep: Callable[[T], bool]) -> tuple[set[Future[T]], bool]:
    """Wait for the next results; return what is still pending, and whether to go on."""
    done, waiting = wait(pending, return_when=FIRST_COMPLETED)
    going = True
    for future in done:
        going = keep(future.result()) and going
    return waiting, going
