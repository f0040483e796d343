"""Commands as users run them, in the process of a test."""

from collections.abc import Callable

import pytest

from stickslip.cli import main


def commands(
    capsys: pytest.CaptureFixture[str], *first: str, one_line: bool = False
) -> Callable[..., tuple[object, str, str]]:
    """Return what runs a command, and gives its exit code, stdout and stderr, or that on one line.

    All commands begin with the words `first`.
    """

    def call(*arguments: object) -> tuple[object, str, str]:
        try:
            code: object = main([*first, *map(str, arguments)])
        except SystemExit as leaving:
            code = leaving.code or 0
        seen = capsys.readouterr()
        return code, seen.out, " ".join(seen.err.split()) if one_line else seen.err

    return call
