"""Processes that fit laws at the same time: how they end, and what they print."""

import os
import signal
import subprocess
import sys
import time

import pytest

from stickslip.cli.progress import workers
from stickslip.errors import SimulationError

SCRIPT = """
import os, signal, sys, time
from stickslip.cli.progress import workers

def work(seconds):
    print("printed by a worker", flush=True)
    time.sleep(seconds)
    return os.getpid()

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have turned it off
    seconds = float(sys.argv[1])
    with workers(2) as executor:
        print(executor.submit(work, 0.0).result(), flush=True)
        executor.submit(work, seconds).result()
"""


@pytest.fixture
def start(tmp_path):
    """Start a program with two workers, one of which is soon at work for some seconds."""
    started = []
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")

    def begin(seconds):
        process = subprocess.Popen(
            [sys.executable, str(tmp_path / "script.py"), str(seconds)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            restore_signals=True,
            start_new_session=True,
        )
        started.append(process)
        return process

    yield begin
    for process in started:
        process.kill()
        process.communicate()


def ended(pid):
    """Whether a process ends within half a minute."""
    for _ in range(300):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.1)
    return False


def test_a_worker_that_dies_is_a_clear_error():
    with (
        pytest.raises(SimulationError, match="one of the 2 processes ended unexpectedly"),
        workers(2) as executor,
    ):
        executor.submit(os.abort).result()


def test_what_workers_print_is_no_part_of_the_output(start):
    out, err = start(0.0).communicate()
    assert out.strip().isdigit()
    assert err.count("printed by a worker") == 2


@pytest.mark.parametrize("cause", [signal.SIGKILL, signal.SIGINT])
def test_workers_end_with_the_process_that_waits_for_them(start, cause):
    process = start(600.0)
    worker = int(process.stdout.readline())
    if cause == signal.SIGKILL:
        process.kill()
    else:
        os.killpg(process.pid, signal.SIGINT)
    process.wait()
    assert ended(worker)
