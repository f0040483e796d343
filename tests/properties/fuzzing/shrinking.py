"""Makes a case simpler as long as it keeps what is wrong with it."""

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

from tests.properties.fuzzing.cases import Case

from stickslip.errors import InputError
from stickslip.mechanisms.drives import Drive, Sum
from stickslip.quantities import Parametrised, fields_of

DIGITS = (1, 2, 4)


def _rounded(value: float, digits: int) -> float:
    return float(f"{value:.{digits - 1}e}")


def _numbers(value: float) -> Iterator[float]:
    """Return simpler numbers than one, the simplest first."""
    for simple in (0.0, 1.0, -1.0):
        if abs(value) not in (0.0, 1.0):
            yield simple
    for digits in DIGITS:
        if _rounded(value, digits) != value:
            yield _rounded(value, digits)


def _series(drive: Any) -> Iterator[Any]:
    """Return a drive given by points with fewer of them."""
    count = len(drive.times)
    for keep in (slice(0, count // 2), slice(count // 2, count), slice(0, -1), slice(1, count)):
        if 0 < len(drive.times[keep]) < count:
            yield dataclasses.replace(drive, times=drive.times[keep], values=drive.values[keep])
    for digits in DIGITS:
        times = tuple(_rounded(t, digits) for t in drive.times)
        values = tuple(_rounded(u, digits) for u in drive.values)
        if len(set(times)) == count and (times, values) != (drive.times, drive.values):
            yield dataclasses.replace(drive, times=times, values=values)


def _simpler(root: Any) -> Iterator[Any]:
    """Return an object with one part simpler."""
    if isinstance(root, Sum):
        yield from root.parts
    if hasattr(root, "times"):
        yield from _series(root)
    for field in dataclasses.fields(root):
        value = getattr(root, field.name)
        candidates: list[Any] = []
        if field.name in fields_of(type(root)) and value is not None:
            default = [] if field.default is dataclasses.MISSING else [field.default]
            candidates = [x for x in [*default, *_numbers(value)] if x != value]
        elif isinstance(value, Parametrised):
            candidates = [*([None] if isinstance(value, Drive) else []), *_simpler(value)]
        for candidate in candidates:
            try:
                yield dataclasses.replace(root, **{field.name: candidate})
            except InputError:
                continue


def _candidates(case: Case) -> Iterator[Case]:
    for number in _numbers(case.t_end):
        if number > 0:
            yield dataclasses.replace(case, t_end=number)
    for name, value in case.y0.items():
        rest = {other: x for other, x in case.y0.items() if other != name}
        yield dataclasses.replace(case, y0=rest)
        for number in _numbers(value):
            yield dataclasses.replace(case, y0={**case.y0, name: number})
    for law in _simpler(case.law):
        yield dataclasses.replace(case, law=law)
    for mechanism in _simpler(case.mechanism):
        yield dataclasses.replace(case, mechanism=mechanism)


def _distance(case: Case) -> int:
    """Return how many characters it takes to write a case."""
    return len(f"{case.mechanism}{case.law}{case.t_end}{case.y0}")


def shrunk(case: Case, is_wrong: Callable[[Case], bool], tries: int = 250) -> Case:
    """Return the simplest case found of which `is_wrong` still holds."""
    known: set[str] = set()
    while True:
        for candidate in _candidates(case):
            if str(candidate) in known or _distance(candidate) > _distance(case):
                continue
            known.add(str(candidate))
            if len(known) > tries:
                return case
            if is_wrong(candidate):
                case = candidate
                break
        else:
            return case
