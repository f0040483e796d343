"""Workers that fit laws or make runs at the same time: processes here, or a cluster."""

import logging
import multiprocessing
import os
import signal
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor
from contextlib import contextmanager
from threading import Thread
from typing import Any, Final

from stickslip.display import require_library
from stickslip.errors import InputError, SimulationError

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
