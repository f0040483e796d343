"""What was checked of a record, as lines of a page."""

from collections.abc import Mapping
from typing import Final, Literal

from stickslip.experiments import Checks
from stickslip.report.core.blocks import KeyValue

MARKS: Final[Mapping[str, Literal["none", "warn", "bad"]]] = {"warning": "warn", "error": "bad"}


def check_items(checks: Checks) -> tuple[KeyValue, ...]:
    """Return a line for each finding of the checks of a record, warnings and errors marked.

    Examples
    --------
    >>> from stickslip import Measurement, check
    >>> [one.mark for one in check_items(check(Measurement(travel=0.2, uncertainty=0.005)))]
    ['warn']
    """
    return tuple(
        KeyValue(
            key=finding.kind.replace("-", " ").replace("_", " ").capitalize(),
            value=str(finding),
            mark=MARKS.get(finding.severity, "none"),
        )
        for finding in checks.findings
    )
