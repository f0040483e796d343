"""The page of a command: what was found stands, whether its page can be drawn or not."""

from collections.abc import Callable
from pathlib import Path

from stickslip.cli import CANCELLED, ToldExit
from stickslip.cli.console import note, stdout
from stickslip.kinds import PAGE

PAGE_FAILED = 1
"""Exit code where the result stands and its page could not be drawn."""
DRAWN = 0


def draw_page(
    folder: Path,
    page: Callable[[], str],
    write: Callable[[str | None], None],
    *,
    kept: str,
    quiet: bool = False,
) -> int:
    """Draw a page and write it; return 0, or the exit code where it failed or was cancelled.

    What goes with it is written in either case. An older page does not stay where a new one fails:
    it would be read as that of this result. `kept` says where the result is.
    """
    note("Drawing the report ...")
    code, text, failed = DRAWN, None, ""
    try:
        text = page()
    except KeyboardInterrupt:
        code, failed = CANCELLED, "Cancelled while the report was drawn."
    except Exception as error:  # whatever a page fails with, the result stands
        code, failed = (
            PAGE_FAILED,
            f"The report could not be drawn ({type(error).__name__}: {error}).",
        )
    write(text)
    if failed:
        note(f"{failed} {kept}")
    elif not quiet:
        stdout().print(f"\nReport: {folder / PAGE}", markup=False)
    return code


def leave_unless_drawn(code: int) -> None:
    """Leave with the exit code of a page that was not drawn."""
    if code != DRAWN:
        raise ToldExit(code)
