"""The command line: reads input, calls one public function, shows the result."""

import contextlib
import io
import logging
import os
import sys
from collections.abc import Iterator, Sequence
from contextvars import ContextVar
from typing import Any

__all__ = ["ToldExit", "main"]

BAD_INPUT = 2
NO_CONVERGENCE = 3
CANCELLED = 130
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Set to 1 if not set: matrices are thin, and threads of linear algebra wait for each other."""
QUIET: ContextVar[bool] = ContextVar("quiet", default=False)
"""Whether the command in work prints its result only, without progress and remarks."""
LONGEST_MESSAGE = 4000
"""Characters of a message that are printed: files may hold names of any length."""


class ToldExit(SystemExit):
    """Leaves with a code whose reason the user has been told."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and exit; errors are one message, never a traceback."""
    from stickslip.errors import InputError, StickslipError

    for name in ONE_THREAD:  # before NumPy is imported, and for worker processes
        os.environ.setdefault(name, "1")
    for name in ("stdout", "stderr"):
        if isinstance(stream := getattr(sys, name), io.TextIOWrapper):
            # the encoding may have neither µ nor ± nor halves
            stream.reconfigure(errors="backslashreplace")
            setattr(sys, name, _outlasting(stream))
    try:
        from stickslip.cli.app import app

        try:
            with _notices():
                app(args=arguments, prog_name="stickslip")
        finally:
            sys.stdout.flush()  # not at exit, where nobody could say that it failed
    except InputError as error:
        return _leave(str(error), BAD_INPUT)
    except StickslipError as error:
        return _leave(str(error), NO_CONVERGENCE)
    except MemoryError as error:
        said = f"not enough memory ({error}): " if str(error) else "not enough memory: "
        return _leave(f"{said}give fewer rows or trials, or a shorter record.", BAD_INPUT)
    except OSError as error:
        _abandon_stdout()
        what = f"{error.filename}: " if error.filename else "cannot write: "
        return _leave(f"{what}{error.strerror or error}.", BAD_INPUT)
    except SystemExit as leaving:
        # how typer passes an interrupt on
        if leaving.code == CANCELLED and not isinstance(leaving, ToldExit):
            return _leave("Cancelled; no result was written.", CANCELLED)
        raise
    return 0


class _Outlasting(io.FileIO):
    """A stream whose reader may leave, as `head` does: files of the command are for later."""

    def write(self, data: Any, /) -> int:
        try:
            return super().write(data)
        except BrokenPipeError:
            return memoryview(data).nbytes


def _outlasting(stream: io.TextIOWrapper) -> io.TextIOWrapper:
    """Return a stream that writes where another does, as long as somebody reads."""
    raw = getattr(stream.buffer, "raw", stream.buffer)  # PYTHONUNBUFFERED leaves no buffer
    # consoles of Windows and what tests put in place of a stream are no such files
    if type(raw) is not io.FileIO:
        return stream
    stream.flush()
    file: Any = _Outlasting(stream.fileno(), "w", closefd=False)
    return io.TextIOWrapper(
        file if raw is stream.buffer else io.BufferedWriter(file),
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )


class _Stderr(logging.Handler):
    """Writes to what stderr is at that moment: progress bars take its place while they are up."""

    def emit(self, record: logging.LogRecord) -> None:
        from stickslip.show.formatting import printable

        if not QUIET.get():
            print(printable(self.format(record), lines=True), file=sys.stderr, flush=True)


@contextlib.contextmanager
def _notices() -> Iterator[None]:
    """Report slow steps, such as compiling, on stderr, even where it is not a terminal."""
    log, handler = logging.getLogger("stickslip"), _Stderr()
    level = log.level
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    try:
        yield
    finally:
        log.removeHandler(handler)
        log.setLevel(level)


def _abandon_stdout() -> None:
    """Drop what could not be written, or the interpreter would try again at exit."""
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def _leave(message: str, code: int) -> int:
    from stickslip.show.formatting import printable

    text = message if len(message) <= LONGEST_MESSAGE else f"{message[:LONGEST_MESSAGE]} ..."
    print(f"stickslip: {printable(text, lines=code != BAD_INPUT)}", file=sys.stderr)
    sys.exit(code)
