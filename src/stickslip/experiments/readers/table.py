"""What a reader of a file format returns, and errors of files that are damaged."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import pandas as pd

from stickslip.errors import InputError


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


def unequal_rows(error: Exception) -> InputError:
    """Return the error of a text whose rows have not as many cells each, from that of pandas."""
    # What stands before it names the parser's language and nothing in the file.
    reason = str(error).strip().splitlines()[0].rpartition("error: ")[2].rstrip(".")
    return InputError(f"has rows of different lengths ({reason}).")


def read_json(path: Path) -> Any:
    """Return what a file holds, or say that it is damaged."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: is not JSON, or is damaged: {error}.") from None
