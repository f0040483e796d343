"""Friction laws: compositions of parts, each with its source."""

import re
from pathlib import Path

from stickslip.lazy import attach

ENTRIES = Path(__file__).with_name("named.py").read_text(encoding="utf-8")
NAMED = re.findall(r"^class (\w+):$", ENTRIES, re.MULTILINE)
"""Classes of the laws that have an entry in `named`, in the order of listings."""
LAW_MODULES = {
    **dict.fromkeys(NAMED, "registry"),
}
"""The laws of the package in the order of listings, with what their classes are asked of."""

__getattr__, __dir__, __all__ = attach(__name__, LAW_MODULES)
