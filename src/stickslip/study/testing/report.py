"""What a suite found, how its checks are run, and checks of what a class says of itself."""

import dataclasses
import html
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any, TypeVar

from stickslip.errors import ConformanceError, ParameterError
from stickslip.quantities import Parametrised, Quantity, fields_of
from stickslip.show.described import texts_below
from stickslip.show.formatting import number

# What a suite found, and how its checks are run.

Case = TypeVar("Case")
Suite = Mapping[str, Callable[[Case], Iterable[str]]]
"""Checks by what should be; each yields what is not so."""

MOST_PROBLEMS = 3
"""Problems that are told of one check."""


@dataclass(frozen=True, kw_only=True)
class ConformanceFinding:
    """Something that should be and is not.

    Parameters
    ----------
    check : str
        What should be.
    problem : str
        What was met instead.
    """

    check: str
    problem: str


@dataclass(frozen=True, kw_only=True, repr=False)
class Report:
    """What a suite found.

    Parameters
    ----------
    subject : str
        What was checked.
    checks : tuple of str
        What was looked at, in order.
    findings : tuple of ConformanceFinding
        What is not as it should be.
    skipped : tuple of str
        What could not be looked at because of an earlier finding.

    Examples
    --------
    >>> report = Report(subject="Mine", checks=("a is b",), findings=())
    >>> report.ok, report
    (True, <Mine: 1 check passed>)
    """

    subject: str
    checks: tuple[str, ...]
    findings: tuple[ConformanceFinding, ...]
    skipped: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether all is as it should be."""
        return not self.findings

    def _lines(self) -> list[str]:
        failed = dict.fromkeys(finding.check for finding in self.findings)
        n = len(self.checks)
        made = f"{n} check{'' if n == 1 else 's'}"
        head = f"{made} passed" if self.ok else f"{len(failed)} of {made} failed"
        lines = [f"{self.subject}: {head}"]
        for check in failed:
            lines.append(f"- {check}")
            lines += [
                f"    {finding.problem}" for finding in self.findings if finding.check == check
            ]
        if self.skipped:
            lines.append(f"Not checked until these are corrected: {'; '.join(self.skipped)}")
        return lines

    def __repr__(self) -> str:
        return "<" + "\n ".join(self._lines()) + ">"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(chr(10).join(self._lines()))}</pre>"


def examine(
    subject: str, case: Case, first: "Suite[Case]", then: "Suite[Case]", *, throw: bool
) -> Report:
    """Make the first checks, and the others if these found nothing that stands in their way."""
    findings = _found(case, first)
    skipped: tuple[str, ...] = ()
    if any(finding.check == list(first)[-1] for finding in findings):
        skipped = tuple(then)
    else:
        findings += _found(case, then)
    made = (*first, *(() if skipped else then))
    report = Report(subject=subject, checks=made, findings=tuple(findings), skipped=skipped)
    if throw and not report.ok:
        raise ConformanceError(repr(report)[1:-1])
    return report


def _found(case: Case, suite: "Suite[Case]") -> list[ConformanceFinding]:
    """Return what checks find; one that cannot be made has found something, too."""
    found = []
    for name, check in suite.items():
        try:
            problems = list(islice(check(case), MOST_PROBLEMS))
        except Exception as error:  # code of somebody else may raise anything
            problems = [f"{type(error).__name__}: {error}"]
        found += [ConformanceFinding(check=name, problem=problem) for problem in problems]
    return found


# Checks of what a class says of itself.


_KEBAB = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")


def suite(of: Callable[[Case], Parametrised], declares: str, names: Sequence[str]) -> Suite[Case]:
    """Return the checks of this module, of the law or mechanism of a case."""
    return {
        "its name is in kebab case": lambda case: kebab_case(of(case)),
        declares: lambda case: declared(of(case), names),
        "it is a frozen, keyword-only dataclass": lambda case: frozen(of(case)),
        "every number is a declared quantity": lambda case: quantities_declared(of(case)),
        "every quantity is documented": lambda case: explained(of(case)),
        "parameters are checked": lambda case: parameters_checked(of(case)),
    }


def kebab_case(model: Any) -> Iterator[str]:
    """Yield a name that rig files and registries cannot use."""
    name = getattr(model, "name", None)
    if not isinstance(name, str) or not _KEBAB.fullmatch(name):
        yield (
            f"{type(model).__name__}.name is {name!r}; expected a kebab-case name such as"
            " 'two-mass-axis'"
        )


def declared(model: Any, names: Sequence[str]) -> Iterator[str]:
    """Yield class attributes that are missing."""
    for name in names:
        if not hasattr(type(model), name):
            yield f"{type(model).__name__}.{name} is missing"


def frozen(model: Any) -> Iterator[str]:
    """Yield what keeps objects from being values: they are compared, varied and cached as such."""
    kind = type(model)
    settings = kind.__dict__.get("__dataclass_params__")
    if settings is None:
        yield f"{kind.__name__} lacks its own @dataclass(frozen=True, kw_only=True)"
        return
    if not settings.frozen:
        yield f"{kind.__name__} is not frozen"
    if not all(field.kw_only for field in dataclasses.fields(kind)):
        yield f"{kind.__name__} is not keyword-only"
    hash(model)
    if dataclasses.replace(model) != model:
        yield "a copy does not equal the original"


def quantities_declared(model: Parametrised) -> Iterator[str]:
    """Yield numbers without a quantity, and symbols that are there twice."""
    quantities = fields_of(type(model))
    for field in dataclasses.fields(model):
        value = getattr(model, field.name)
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if number and field.name not in quantities:
            yield f"{field.name} is a number without a Quantity, so it has no derivatives"
    symbols: dict[str, str] = {}
    for name, quantity in quantities.items():
        if not quantity.symbol or not quantity.unit:
            yield f"{name} has no symbol or no unit"
        elif quantity.symbol in symbols:
            yield f"{name} and {symbols[quantity.symbol]} have the same symbol {quantity.symbol}"
        symbols[quantity.symbol] = name


def explained(model: Parametrised) -> Iterator[str]:
    """Yield what nothing explains: docstring of the class, text below the field, `Doc`."""
    kind = type(model)
    text = vars(kind).get("__doc__") or ""
    if not text.strip() or text.startswith(f"{kind.__name__}("):  # written by dataclass itself
        yield f"{kind.__name__} has no docstring"
        text = ""
    below = texts_below(kind)
    for name in fields_of(kind):
        if name not in below and not re.search(rf"\b{name}\b", text):
            yield f"{name} is documented neither below its field nor in the docstring of the class"


def parameters_checked(model: Parametrised) -> Iterator[str]:
    """Yield values outside their range that are taken all the same."""
    for name, quantity in fields_of(type(model)).items():
        for value in _outside(quantity):
            try:
                dataclasses.replace(model, **{name: value})
            except ParameterError:
                continue
            yield f"{name} = {number(value, 6)} is accepted, but must be {quantity.range}"


def _outside(quantity: Quantity) -> Iterator[float]:
    yield float("nan")
    if quantity.above is not None:
        yield quantity.above
    if quantity.low > float("-inf"):
        yield quantity.low - 1.0
    if quantity.high < float("inf"):
        yield quantity.high + 1.0
