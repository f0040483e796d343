"""What a reader of a file format returns."""

from dataclasses import dataclass
from typing import final

import pandas as pd


@final
@dataclass(frozen=True, kw_only=True)
class Table:
    """The columns of a file, their names as they stand there."""

    data: pd.DataFrame
    """One row per sample or trial; a header may carry its unit in brackets."""
    first_row: int = 1
    """Line of the first row in the file, or 1 where there are no lines."""
    remarks: tuple[str, ...] = ()
    """What was decided in reading and a user should know, one sentence each."""
