"""The tasks: what they name exists, and what judges was not fitted."""

import numpy as np
import pytest
from benchmarks.friction.peers import PEERS
from benchmarks.friction.runs import task, tasks

from stickslip.errors import InputError, UnknownNameError

TASKS = list(tasks().values())


def name_of(value):
    return value.name


def test_there_are_ten_records_and_more():
    assert len({one.record for one in TASKS}) >= 10


@pytest.mark.parametrize("one", TASKS, ids=name_of)
def test_a_task_names_what_there_is(one):
    assert {*one.files} <= {*one.dataset.files}
    assert {*one.left_out} <= {*PEERS}
    assert all(one.left_out.values())
    assert one.cutoff > 0.0 or one.left_out
    assert one.selects or one.laws


@pytest.mark.parametrize("one", TASKS, ids=name_of)
def test_no_sample_that_judges_was_fitted(one, data_dir):
    fitted, judged = one.split()
    since = getattr(one.metric, "since", -np.inf)
    seen = {_mark(record, since=-np.inf) for record in fitted.records()}
    for record in judged.records():
        mark = _mark(record, since=since)
        assert all(
            mark[0] != other[0] or mark[1] > other[2] or mark[2] < other[1] for other in seen
        )


def _mark(record, since):
    """Return what tells a record: a name, and from when to when it is judged."""
    time = np.asarray(record.time)
    return record.name, max(float(time[0]), since), float(time[-1])


def test_a_task_of_another_package_is_found(other_package):
    assert task("made-up") is other_package


def test_two_tasks_of_one_name_are_refused(other_package, monkeypatch):
    from types import SimpleNamespace

    entry = SimpleNamespace(load=lambda: [other_package, other_package])
    monkeypatch.setattr("benchmarks.friction.runs.entry_points", lambda group: [entry])
    tasks.cache_clear()
    with pytest.raises(InputError, match="two tasks of the benchmark are called 'made-up'"):
        tasks()


def test_an_unknown_task_lists_the_nearest():
    with pytest.raises(UnknownNameError, match="Did you mean 'emps'"):
        task("emsp")
