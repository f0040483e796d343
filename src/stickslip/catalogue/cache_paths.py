"""Where data lie: a folder of the user's own, the cache, and upstream."""

import enum
import os
from pathlib import Path
from urllib.parse import quote

import platformdirs

from stickslip.errors import InputError

UPSTREAM = "https://raw.githubusercontent.com"


class CacheLocation(enum.Enum):
    """Where a file of the catalogue is."""

    LOCAL = "local"
    """In the folder that ``STICKSLIP_DATA`` names."""
    CACHED = "cached"
    """In the cache, or there as it came from upstream and converted when it is asked for."""
    UPSTREAM = "to download"
    """Nowhere here; it is downloaded when it is asked for."""
    ELSEWHERE = "by hand"
    """Nowhere here, and the catalogue cannot download it."""


def named_folder() -> Path | None:
    """Return the folder that ``STICKSLIP_DATA`` names, if it names one."""
    named = os.environ.get("STICKSLIP_DATA", "")
    return Path(named) if named else None


def cache_folder() -> Path:
    """Return the folder of downloaded and converted files in the user's cache.

    Returns
    -------
    Path
        It need not exist.

    Examples
    --------
    >>> cache_folder().name
    'data'
    """
    return Path(platformdirs.user_cache_dir("stickslip")) / "data"


def base_address() -> str:
    """Return where repositories are downloaded from: ``STICKSLIP_DATA_URL``, or GitHub."""
    base = os.environ.get("STICKSLIP_DATA_URL") or UPSTREAM
    if not base.startswith(("https://", "http://")):
        raise InputError(
            f"STICKSLIP_DATA_URL must begin with https:// or http://, got {base!r}. For a local"
            " folder of data, set STICKSLIP_DATA instead."
        )
    return base.rstrip("/")


def web_address(repository: str, commit: str, source: str) -> str:
    """Return the address that an upstream file is downloaded from."""
    return f"{base_address()}/{repository}/{commit}/{quote(source)}"


def by_hand(repository: str, commit: str, source: str) -> str:
    """Return the address at which a browser gets an upstream file."""
    return f"https://github.com/{repository}/raw/{commit}/{quote(source)}"
