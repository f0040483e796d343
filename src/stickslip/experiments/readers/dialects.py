"""Text files whose tables only their own reader knows: a new one is a file and an entry here."""

import io
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import pandas as pd

from stickslip.experiments.readers.labview import LABVIEW, is_labview, read_labview
from stickslip.experiments.readers.motion_capture import MOTION_CAPTURE, is_capture, read_capture
from stickslip.experiments.readers.scope_channels import SCOPE, is_scope, read_scope
from stickslip.experiments.readers.serial_monitor import SERIAL, is_serial, read_serial
from stickslip.experiments.readers.table import Table, further_cells, unequal_rows
from stickslip.experiments.readers.tribometers import TRIBOMETER, is_tribometer, read_tribometer
from stickslip.experiments.readers.video_tracks import is_blocks, read_blocks

FRANKA: Final = "time, success_rate, state.q[0]"
"""How such a text begins: times are in milliseconds and say so nowhere."""


def is_franka(text: str) -> bool:
    """Whether a text is a log of libfranka.

    Examples
    --------
    >>> is_franka("time, success_rate, state.q[0], state.q[1]"), is_franka("time, q")
    (True, False)
    """
    return (
        text.lstrip("\ufeff")[: len(FRANKA) + 8]
        .replace(" ", "")
        .startswith(FRANKA.replace(" ", ""))
    )


def read_franka(text: str) -> Table:
    r"""Return the columns of a log with their units.

    Examples
    --------
    >>> table = read_franka("time, success_rate, state.q[0], state.tau_J[0]\n7,1,0.5,2.5\n")
    >>> table.data.to_dict("list"), table.first_row
    ({'time [ms]': [7], 'success_rate': [1], 'state.q[0]': [0.5], 'state.tau_J[0]': [2.5]}, 2)
    """
    text = text.lstrip("\ufeff")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pd.errors.ParserWarning)  # of further cells: see below
            table = pd.read_csv(io.StringIO(text), skipinitialspace=True, index_col=False)
    except (pd.errors.ParserError, ValueError) as error:
        raise unequal_rows(error) from None
    width = len(table.columns)
    more = sum(any(map(str.strip, line.split(",")[width:])) for line in text.splitlines())
    return Table(
        data=table.rename(columns={"time": "time [ms]"}),
        first_row=2,
        lost=(*further_cells(more, width),),
    )


@final
@dataclass(frozen=True, kw_only=True)
class Dialect:
    """A kind of text files."""

    title: str
    is_text: Callable[[str], bool]
    """Whether a text, or the top of one, is of this kind."""
    read: Callable[[str], Table]
    """Returns the table of a text."""


DIALECTS: Final = (
    Dialect(title="tracks of a video", is_text=is_blocks, read=read_blocks),
    Dialect(title=SCOPE, is_text=is_scope, read=read_scope),
    Dialect(title=LABVIEW, is_text=is_labview, read=read_labview),
    Dialect(title=TRIBOMETER, is_text=is_tribometer, read=read_tribometer),
    Dialect(title=MOTION_CAPTURE, is_text=is_capture, read=read_capture),
    Dialect(title=SERIAL, is_text=is_serial, read=read_serial),
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
