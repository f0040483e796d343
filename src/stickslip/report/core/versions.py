"""What a result may depend on beside its input."""

import platform
from collections.abc import Mapping
from importlib.metadata import version

__all__ = ["versions"]

LIBRARIES = ("stickslip", "numpy", "scipy", "symengine")


def versions() -> Mapping[str, str]:
    """Return the versions that a result may depend on."""
    return {"python": platform.python_version(), **{name: version(name) for name in LIBRARIES}}
