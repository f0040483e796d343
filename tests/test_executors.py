"""Work on threads: the order of results, errors, and the number of threads."""

import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

from stickslip.engine.executors import on_threads, threads
from stickslip.errors import InputError


def slowly(i):
    time.sleep(0.01)
    return i * i


@pytest.mark.parametrize("count", ["1", "3", "40"])
def test_results_come_in_the_order_of_the_items(count, monkeypatch):
    monkeypatch.setenv("STICKSLIP_THREADS", count)
    assert on_threads(slowly, range(12)) == [i * i for i in range(12)]
    assert on_threads(abs, []) == []


def test_an_error_ends_the_work_of_all_threads(monkeypatch):
    monkeypatch.setenv("STICKSLIP_THREADS", "3")
    done = []

    def work(i):
        if i == 4:
            raise KeyError(i)
        done.append(slowly(i))

    with pytest.raises(KeyError):
        on_threads(work, range(200))
    assert len(done) < 20


def test_a_worker_process_takes_one_thread(monkeypatch):
    monkeypatch.delenv("STICKSLIP_THREADS", raising=False)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        assert pool.submit(threads).result() == 1
    assert 1 <= threads(2) <= 2


@pytest.mark.parametrize("said", ["0", "-2", "many"])
def test_a_number_of_threads_that_is_none_is_refused(said, monkeypatch):
    monkeypatch.setenv("STICKSLIP_THREADS", said)
    with pytest.raises(InputError, match=f"STICKSLIP_THREADS must be .* got '{said}'"):
        threads()
