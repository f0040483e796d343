"""Sections of the page of a selection on records."""

from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.kinds.joints.joint_verdict import RecordVerdict
from stickslip.kinds.joints.sections.texts import symbols_of
from stickslip.report import Paragraph, Section, typeset

Array: TypeAlias = NDArray[np.float64]

SHOWN: Final = 3
"""Loops drawn at most."""
POINTS: Final = 150
"""Points of a loop drawn, about."""
REACH: Final = 0.2
"""Way back, over the stroke, that makes a turn: what is less is noise or a small wiggle."""


def trials_section(verdict: RecordVerdict) -> Section | None:
    """Return the section on the trials, None where there was nothing to compare."""
    found = verdict.trials
    if found is None:
        return None
    symbols = symbols_of(verdict.candidates)
    heading = "The trials share one law" if found.shared else "The trials do not share one law"
    return Section(
        id="trials",
        nav="Trials",
        heading=heading,
        blocks=tuple(Paragraph(text=typeset(line, symbols)) for line in found.sentences),
    )
