"""Processes that fit laws at the same time."""

import logging
import multiprocessing
import signal
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager

__all__ = ["workers"]


@contextmanager
def workers(jobs: int) -> Iterator[Executor | None]:
    """Yield so many processes, or nothing for one; what cancels the work ends them at once."""
    if jobs == 1:
        yield None
        return
    # Not forked: compiled code and the threads of progress bars do not survive a fork.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, initializer=_deaf) as executor:
        before = set(multiprocessing.active_children())
        try:
            yield executor
        except BaseException:
            for process in set(multiprocessing.active_children()) - before:
                process.kill()
            raise


def _deaf() -> None:
    """Leave interrupts from the terminal to the process that waits; say what is compiled."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    log = logging.getLogger("stickslip")
    log.addHandler(logging.StreamHandler())
    log.setLevel(logging.INFO)
