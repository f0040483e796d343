"""Words to whoever waits: in the log, and on a terminal where nobody reads the log."""

import builtins
import logging
import sys

LOG = logging.getLogger("stickslip")


def notice(text: str) -> None:
    """Log a message at level INFO; show it if nobody set logging up and somebody is watching.

    Watching is a terminal or IPython; nothing is printed into files and pipes. A program that has
    handlers for its log gets the message there alone, and
    ``logging.getLogger("stickslip").setLevel("WARNING")`` turns it off.
    """
    LOG.info(text)
    if not LOG.hasHandlers() and LOG.level <= logging.INFO and not LOG.disabled and _watched():
        print(text, file=sys.stderr, flush=True)


def _watched() -> bool:
    try:
        return hasattr(builtins, "__IPYTHON__") or sys.stderr.isatty()
    except (AttributeError, ValueError):  # there is no stderr, or it is closed
        return False
