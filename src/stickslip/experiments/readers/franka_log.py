"""Logs of libfranka as text: states of a robot and its commands, once a millisecond."""

import io
from typing import Final

import pandas as pd

from stickslip.experiments.readers.table import unequal_rows

HEAD: Final = "time, success_rate, state.q[0]"
"""How such a text begins: times are in milliseconds and say so nowhere."""


def is_franka(text: str) -> bool:
    """Whether a text is a log of libfranka.

    Examples
    --------
    >>> is_franka("time, success_rate, state.q[0], state.q[1]"), is_franka("time, q")
    (True, False)
    """
    return text.lstrip("\ufeff")[: len(HEAD) + 8].replace(" ", "").startswith(HEAD.replace(" ", ""))


def read_franka(text: str) -> tuple[pd.DataFrame, int]:
    r"""Return the columns of a log with their units, and the line of its first row.

    Examples
    --------
    >>> table, line = read_franka("time, success_rate, state.q[0], state.tau_J[0]\n7,1,0.5,2.5\n")
    >>> table.to_dict("list"), line
    ({'time [ms]': [7], 'success_rate': [1], 'state.q[0]': [0.5], 'state.tau_J[0]': [2.5]}, 2)
    """
    try:
        table = pd.read_csv(
            io.StringIO(text.lstrip("\ufeff")), skipinitialspace=True, index_col=False
        )
    except (pd.errors.ParserError, ValueError) as error:
        raise unequal_rows(error) from None
    return table.rename(columns={"time": "time [ms]"}), 2
