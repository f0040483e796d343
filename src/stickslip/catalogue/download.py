"""Downloads upstream files; one is there whole and with its known checksum, or not at all."""

import contextlib
import hashlib
import tempfile
from collections.abc import Iterator
from pathlib import Path

from stickslip.errors import InputError
from stickslip.formatting import number

PATIENCE = 30.0
"""How long a server may say nothing [s]."""


def sha256_of(path: Path) -> str:
    """Return the checksum of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


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
