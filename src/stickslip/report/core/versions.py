"""What a result may depend on beside its input."""

import platform
from collections.abc import Mapping
from importlib.metadata import version

LIBRARIES = ("stickslip", "numpy", "scipy", "symengine")


def versions() -> Mapping[str, str]:
    """Return the versions that a result may depend on."""
    return {"python": platform.python_version(), **{name: version(name) for name in LIBRARIES}}


def colophon(versions: Mapping[str, str]) -> str:
    """Return the last line of a page: what wrote it, and that it needs nothing else.

    Examples
    --------
    >>> colophon({"stickslip": "1.0"})
    'Written by stickslip 1.0. This file is self-contained: it loads nothing and runs no scripts.'
    """
    writer = f"stickslip {versions.get('stickslip', '')}".strip()
    return (
        f"Written by {writer}. This file is self-contained: it loads nothing and runs no scripts."
    )
