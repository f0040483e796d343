"""Text files whose tables only their own reader knows: a new one is a file and an entry here."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import pandas as pd

from stickslip.experiments.readers.franka_log import is_franka, read_franka
from stickslip.experiments.readers.scope_channels import SCOPE, is_scope, read_scope
from stickslip.experiments.readers.video_tracks import is_blocks, read_blocks


@final
@dataclass(frozen=True, kw_only=True)
class Dialect:
    """A kind of text files."""

    title: str
    is_text: Callable[[str], bool]
    """Whether a text, or the top of one, is of this kind."""
    read: Callable[[str], tuple[pd.DataFrame, int]]
    """Returns the table of a text, and the line of its first row."""


DIALECTS: Final = (
    Dialect(title="tracks of a video", is_text=is_blocks, read=read_blocks),
    Dialect(title=SCOPE, is_text=is_scope, read=read_scope),
    Dialect(title="log of libfranka", is_text=is_franka, read=read_franka),
)


def dialect_of(text: str) -> Dialect | None:
    """Return the kind of a text, or None for a table like others.

    Examples
    --------
    >>> dialect_of("time, success_rate, state.q[0]").title, dialect_of("t,x")
    ('log of libfranka', None)
    """
    return next((one for one in DIALECTS if one.is_text(text)), None)
