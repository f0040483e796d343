"""Progress of work on several laws, on stderr."""

from collections.abc import Sequence
from types import TracebackType
from typing import Self, final

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from stickslip.cli.output import stderr

__all__ = ["Watching"]


@final
class Watching:
    """A bar that counts laws and names the one in work; callable as ``watch(name, runs)``."""

    def __init__(self, names: Sequence[str], verb: str) -> None:
        self._names = list(names)
        self._progress = Progress(
            TextColumn(f"{verb} {{task.fields[law]}}", markup=False),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[runs]} runs"),
            TimeElapsedColumn(),
            console=stderr(),
            transient=True,
        )
        self._task = self._progress.add_task("", total=len(self._names), law="", runs=0)

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._progress.stop()

    def __call__(self, name: str, runs: int) -> None:
        """Note that a law has had so many runs."""
        done = self._names.index(name) if name in self._names else 0
        self._progress.update(self._task, completed=done, law=name, runs=runs)
