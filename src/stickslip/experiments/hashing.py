"""What tells one set of inputs from another: the hash of their contents."""

import hashlib
from collections.abc import Sequence
from pathlib import Path


def with_files(digest: str, files: Sequence[Path]) -> str:
    """Return the SHA-256 of a digest and the contents of files; the digest as it is without any.

    Names do not count: a file that was moved is the same input.

    Examples
    --------
    >>> with_files("0123", [])
    '0123'
    """
    if not files:
        return digest
    whole = hashlib.sha256(digest.encode())
    for path in files:
        with path.open("rb") as file:
            whole.update(hashlib.file_digest(file, "sha256").digest())
    return whole.hexdigest()


def of_files(files: Sequence[Path]) -> dict[str, str]:
    """Return the SHA-256 of each file by its name, as ``sha256sum`` prints it.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "record.csv")
    ...     _ = file.write_text("")
    ...     of_files([file])["record.csv"][:8]
    'e3b0c442'
    """
    found = {}
    for path in files:
        with path.open("rb") as file:
            found[path.name] = hashlib.file_digest(file, "sha256").hexdigest()
    return found
