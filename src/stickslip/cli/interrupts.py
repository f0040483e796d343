"""Ctrl-C while something is searched for: once to keep the best so far, twice to cancel."""

import signal
import threading
from types import FrameType, TracebackType
from typing import Any, Self, final

from stickslip.cli.console import note

BEST = "Stopping with the best fit so far; press Ctrl-C again to cancel."
"""What is said where the first interrupt ends a search."""


@final
class Interrupts:
    """Within a `with`, the first interrupt is only noted; the second is an interrupt as ever."""

    def __init__(self) -> None:
        self.stopped = False
        """Whether the search is to end with what it has."""
        self.promise = BEST
        """What is said at the first interrupt."""
        self._before: Any = None

    def __enter__(self) -> Self:
        # Only the main thread may say what an interrupt does; elsewhere it stays as it is.
        if threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGINT, self._met)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)

    def _met(self, _number: int, _frame: FrameType | None) -> None:
        if self.stopped:
            raise KeyboardInterrupt
        self.stopped = True
        note(self.promise)
