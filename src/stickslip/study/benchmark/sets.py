"""The tasks of the benchmark, and those of other packages."""

import functools
from collections.abc import Mapping
from importlib.metadata import entry_points
from types import MappingProxyType

from stickslip.errors import InputError, UnknownNameError
from stickslip.study.benchmark.definition import Task

GROUP = "stickslip.benchmark"
"""Entry points of other packages: a `Task`, or a sequence of them."""


@functools.cache
def tasks() -> Mapping[str, Task]:
    """Return the tasks by name.

    Examples
    --------
    >>> list(tasks())[:2]
    ['emps', 'pendulum']
    """
    from stickslip.study.benchmark.records import TASKS

    found = list(TASKS)
    for entry in entry_points(group=GROUP):
        own = entry.load()
        found += [own] if isinstance(own, Task) else own
    names = [one.name for one in found]
    if twice := {name for name in names if names.count(name) > 1}:
        raise InputError(f"two tasks of the benchmark are called {min(twice)!r}.")
    return MappingProxyType({one.name: one for one in found})


def task(name: str) -> Task:
    """Return a task.

    Examples
    --------
    >>> task("rock").record
    'rock_velocity_step'
    """
    if name not in tasks():
        raise UnknownNameError("task of the benchmark", name, tasks())
    return tasks()[name]
