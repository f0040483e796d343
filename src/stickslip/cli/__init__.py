"""The command line: reads input, calls one public function, shows the result."""

import sys
from collections.abc import Sequence

__all__ = ["main"]

BAD_INPUT = 2
NO_CONVERGENCE = 3
CANCELLED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and exit; errors are one message, never a traceback."""
    from stickslip.errors import InputError, StickslipError

    try:
        from stickslip.cli.app import app

        app(args=arguments, prog_name="stickslip")
    except InputError as error:
        return _leave(str(error), BAD_INPUT)
    except StickslipError as error:
        return _leave(str(error), NO_CONVERGENCE)
    except SystemExit as leaving:
        if leaving.code == CANCELLED:  # how typer passes an interrupt on
            return _leave("Cancelled; nothing was written.", CANCELLED)
        raise
    return 0


def _leave(message: str, code: int) -> int:
    print(f"stickslip: {message}", file=sys.stderr)
    sys.exit(code)
