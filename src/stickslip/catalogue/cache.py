"""Where data lie: a folder of the user's own, the cache, and upstream; downloads."""

import contextlib
import enum
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

import platformdirs

from stickslip.documents import sha256_of
from stickslip.errors import InputError
from stickslip.formatting import number

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


PATIENCE = 30.0
"""How long a server may say nothing [s]."""


@contextlib.contextmanager
def fresh(target: Path) -> Iterator[Path]:
    """Give a temporary file beside a path, which takes its place if all goes well."""
    temporary = _beside(target)
    try:
        yield temporary
        temporary.chmod(0o644)  # a cache may be shared; temporary files are for one user
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


def _beside(target: Path) -> Path:
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=target.parent, suffix=".part", delete=False) as file:
            return Path(file.name)
    except OSError as error:
        raise InputError(
            f"{target.parent} cannot be written: {error.strerror}. Downloaded data are kept there;"
            " set STICKSLIP_DATA to use another folder."
        ) from None


def download(url: str, target: Path, sha256: str, *, page: str) -> None:
    """Download a file."""
    from pooch import HTTPDownloader

    with fresh(target) as temporary:
        try:
            # Read at once: a stream that breaks off would leave its socket open.
            HTTPDownloader(timeout=PATIENCE, stream=False)(url, str(temporary), None)
        except (OSError, ValueError) as error:  # those of requests are one or the other
            raise InputError(
                f"{target.name} could not be downloaded from {url}: {_reason(error)}. Download it"
                f" by hand from {page} and put it into {target.parent}, or set STICKSLIP_DATA to a"
                " folder that contains its table."
            ) from None
        found = sha256_of(temporary)
        if found != sha256:
            raise InputError(
                f"{target.name} from {url} differs from the file in the catalogue: its sha256 is"
                f" {found}, expected {sha256}. The download was discarded. Try again, or download"
                f" it by hand from {page} and put it into {target.parent}."
            )


def _reason(error: Exception) -> str:
    """Say in a few words what the chain of exceptions of a connection says in many."""
    response = getattr(error, "response", None)
    if response is not None:
        return f"the server answered {response.status_code} {response.reason}"
    kind = type(error).__name__
    if "Timeout" in kind:
        return f"the server did not respond for {number(PATIENCE)} s"
    if "Chunked" in kind or "Content" in kind:
        return "the connection was interrupted"
    if "Connection" in kind or "SSL" in kind or "Proxy" in kind:
        return f"no connection ({kind})"
    return str(getattr(error, "strerror", None) or error).rstrip(".")
