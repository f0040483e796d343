"""What a suite found, and how its checks are run."""

import html
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import TypeVar

from stickslip.errors import ConformanceError

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
