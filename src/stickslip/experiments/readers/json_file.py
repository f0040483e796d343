"""JSON files."""

import json
from pathlib import Path
from typing import Any

from stickslip.errors import InputError


def read_json(path: Path) -> Any:
    """Return what a file holds, or say that it is damaged."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: is not JSON, or is damaged: {error}.") from None
