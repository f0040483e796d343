"""Processes that fit laws at the same time."""

import logging
import multiprocessing
import os
import signal
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor
from contextlib import contextmanager
from threading import Thread

from stickslip.errors import SimulationError


@contextmanager
def workers(jobs: int) -> Iterator[Executor | None]:
    """Yield so many processes, or nothing for one; what cancels the work ends them at once."""
    if jobs == 1:
        yield None
        return
    # Not forked: compiled code and the threads of progress bars do not survive a fork.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, initializer=_subordinate) as executor:
        before = set(multiprocessing.active_children())
        try:
            yield executor
        except BaseException as error:
            for process in set(multiprocessing.active_children()) - before:
                process.kill()
            if isinstance(error, BrokenExecutor):
                raise SimulationError(
                    f"one of the {jobs} processes ended unexpectedly, possibly for lack of memory;"
                    " try fewer (--jobs 1 needs the least memory)."
                ) from error
            raise


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
