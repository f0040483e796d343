"""A record of the catalogue: what is known of it, and its files where they are wanted."""

import contextlib
import dataclasses
import enum
import functools
import os
import tempfile
import tomllib
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal
from urllib.parse import quote

import numpy as np
import platformdirs

from stickslip.data import Measurement, load_measurement
from stickslip.errors import InputError, UnknownNameError
from stickslip.show.described import Described
from stickslip.show.display import require_library
from stickslip.show.documents import sha256_of
from stickslip.show.formatting import number

UPSTREAM = "https://raw.githubusercontent.com"
PATIENCE = 30.0
"""How long a server may say nothing [s]."""
Known = Mapping[str, float | str]
"""What is known of an experiment: numbers, whose names carry their units, and words."""


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


def by_hand(repository: str, commit: str, source: str) -> str:
    """Return the address at which a browser gets an upstream file."""
    return f"https://github.com/{repository}/raw/{commit}/{quote(source)}"


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
        result = sha256_of(temporary)
        if result != sha256:
            raise InputError(
                f"{target.name} from {url} differs from the file in the catalogue: its sha256 is"
                f" {result}, expected {sha256}. The download was discarded. Try again, or download"
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


@dataclass(frozen=True, kw_only=True)
class Column(metaclass=Described):
    """A column of a tidy table, and where its numbers come from.

    Examples
    --------
    >>> Column(name="x_m", unit="m", meaning="position", source="3", factor=1e-3).factor
    0.001
    """

    name: str
    """Name in the table, which ends with the unit: ``"x_m"``."""
    unit: str
    """Unit of the column."""
    meaning: str
    """What the column holds, in words."""
    quantity: str = ""
    """What it is in a `stickslip.Measurement`; empty where a measurement does without it."""
    gain: float = 1.0
    """Factor from the column to the quantity in SI."""
    source: str = ""
    """Variable of the upstream file, or number of its column in a text, from 1."""
    factor: float = 1.0
    """Factor from the upstream number to the column."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DataFile(metaclass=Described):
    """A table of a record, and the upstream file it is converted from.

    Examples
    --------
    >>> DataFile(name="train", about="The first minute.", rows=12_000, part=True).file_name
    'train.parquet'
    """

    name: str
    """Name of the table among the files of its record."""
    about: str
    """What this table holds, in a sentence."""
    rows: int | None = None
    """Rows of the table; None where the catalogue does not know."""
    part: bool = False
    """Whether the table is the first `rows` rows of the upstream file, and not all of it."""
    sha256: str = ""
    """Checksum of the table that the catalogue was written for; empty where there is none."""
    source: str = ""
    """Path of the upstream file in its repository; empty where the catalogue cannot fetch it."""
    source_sha256: str = ""
    """Checksum of the upstream file."""
    ending: str = ".parquet"
    """Ending of the file that the table is kept in."""
    known: Known = field(default_factory=lambda: MappingProxyType({}))
    """What is known of this file alone."""

    @property
    def file_name(self) -> str:
        """Name of the table in a folder of data."""
        return self.name + self.ending


def convert(
    raw: Path, target: Path, *, form: str, columns: Sequence[Column], file: DataFile
) -> None:
    """Write the table of an upstream file; it is there whole or not at all."""
    import pandas as pd

    try:
        series = _READERS[form](raw)
        table = pd.DataFrame({column.name: _taken(series, column) for column in columns})
    except (TypeError, ValueError) as error:
        raise InputError(
            f"{raw}: cannot be read as {form}: {str(error).rstrip('.')}. Its checksum is correct,"
            " so the catalogue entry is wrong: please report this."
        ) from None
    if file.part:
        table = table.iloc[: file.rows]
    if file.rows is not None and len(table) != file.rows:
        warnings.warn(
            f"{raw.name} gives a table of {len(table)} rows, but the catalogue lists {file.rows}:"
            f" results for {file.name} may differ from published ones.",
            stacklevel=2,
        )
    with fresh(target) as temporary:
        table.to_parquet(temporary, index=False, compression="zstd")


def _taken(series: Mapping[str, Any], column: Column) -> Any:
    if column.source not in series:
        raise ValueError(f"{column.source!r} is missing; the file contains {', '.join(series)}")
    # One product, and none where nothing is to be scaled, keeps bits and precision as they were.
    values = series[column.source]
    return values if column.factor == 1.0 else values * column.factor


def _matlab(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat

    try:
        result = loadmat(path)
    except Exception as error:  # of any kind: the reader trusts the file
        raise ValueError(f"{type(error).__name__}: {error}") from None
    return {name: result[name].ravel() for name in result if not name.startswith("__")}


def _text(path: Path) -> dict[str, Any]:
    table = np.loadtxt(path, delimiter="\t", skiprows=1, ndmin=2)
    return {str(number): column for number, column in enumerate(table.T, 1)}


_READERS = {"mat": _matlab, "tsv": _text}


@dataclass(frozen=True, kw_only=True, eq=False)
class Dataset(metaclass=Described):
    """A record of the catalogue.

    Examples
    --------
    >>> from stickslip.data import catalogue
    >>> axis = catalogue.dataset("emps")
    >>> axis.kind, list(axis.files), axis.licence
    ('measured', ['train'], 'none stated: read, never copy')
    """

    name: str
    """Name in the catalogue, such as ``"emps"``."""
    title: str
    """One line that says what was recorded."""
    kind: Literal["measured", "reference simulation"]
    """Whether an instrument or a program made the numbers."""
    citation: str
    """Publication that the record belongs to."""
    licence: str
    """As stated upstream; "none stated: read, never copy" where nothing is."""
    repository: str
    """Owner and name on GitHub."""
    commit: str = ""
    """Commit of the upstream files; empty where the catalogue cannot fetch them."""
    format: str = ""
    """Of the upstream files: ``"mat"`` or ``"tsv"``."""
    sampling: str = ""
    """How often and how long was sampled, in words."""
    columns: tuple[Column, ...]
    """Columns of its tables, in their order."""
    files: Mapping[str, DataFile]
    """By name; the first is taken where none is named."""
    load: float | None = None
    """Normal force of a measurement [N] where no column has it."""
    known: Known = field(default_factory=lambda: MappingProxyType({}))
    """What is known of the experiment."""
    published: Mapping[str, Known] = field(default_factory=lambda: MappingProxyType({}))
    """Results that others printed, by method."""
    notes: str = ""
    """What a user should know beside; may be empty."""

    def file(self, name: str | None = None) -> DataFile:
        """Return what is known of a file, of the first if none is named.

        Raises
        ------
        UnknownNameError
            If there is no such file.

        Examples
        --------
        >>> from stickslip.data import catalogue
        >>> catalogue.dataset("spring_pulled_slider").file("k168_v4300").rows
        7521
        """
        name = next(iter(self.files)) if name is None else name
        if name not in self.files:
            raise UnknownNameError(f"file of {self.name}", name, self.files)
        return self.files[name]

    def folder(self) -> Path:
        """Return the folder of the cache where files of this record are kept.

        A file fetched by hand is put there; it is converted when it is asked for.

        Examples
        --------
        >>> from stickslip.data import catalogue
        >>> catalogue.dataset("emps").folder().parts[-2:]
        ('emps', '956aa7ecd730')
        """
        # A later catalogue may point to a later commit, whose tables are others.
        return cache_folder() / self.name / self.commit[:12]

    def place(self, file: str | None = None) -> CacheLocation:
        """Return where a file is, without fetching it.

        Examples
        --------
        >>> from stickslip.data import catalogue
        >>> catalogue.dataset("emps").place() in catalogue.CacheLocation
        True
        """
        wanted = self.file(file)
        if self._own(wanted) is not None:
            return CacheLocation.LOCAL
        if not wanted.source:
            return CacheLocation.ELSEWHERE
        there = (self.folder() / wanted.file_name, self._raw(wanted))
        return (
            CacheLocation.CACHED
            if any(path.is_file() for path in there)
            else CacheLocation.UPSTREAM
        )

    def path(self, file: str | None = None, *, report: Callable[[str], None] | None = None) -> Path:
        """Return a file of this record, after downloading and converting it if necessary.

        The folder named by ``STICKSLIP_DATA`` comes first, as ``<folder>/<name>/<file>.parquet``;
        then the user's cache; then the upstream repository, or the server that
        ``STICKSLIP_DATA_URL`` names in its place.

        Parameters
        ----------
        file : str, optional
            One of `files`; the first if not given.
        report : callable, optional
            Is told before something is downloaded.

        Returns
        -------
        Path
            A table with the columns of `columns`.

        Raises
        ------
        InputError
            If the file can neither be found nor downloaded; the message says where to get it and
            where to put it.

        Warns
        -----
        UserWarning
            If a file under ``STICKSLIP_DATA`` is not the one that the catalogue knows.

        Examples
        --------
        >>> from tempfile import TemporaryDirectory
        >>> from unittest.mock import patch
        >>> from stickslip.data import catalogue
        >>> record = catalogue.dataset("rate_and_state_reference")
        >>> with TemporaryDirectory() as own, patch.dict("os.environ", STICKSLIP_DATA=own):
        ...     Path(own, record.name).mkdir()
        ...     Path(own, record.name, "truth.json").touch()
        ...     record.path().name
        'truth.json'
        """
        wanted = self.file(file)
        own = self._own(wanted)
        if own is not None:
            _compare(own, wanted)
            return own
        target = self.folder() / wanted.file_name
        if wanted.source and target.is_file():
            return target
        require_library("pyarrow", "parquet")
        raw = self._upstream(wanted, report)
        convert(raw, target, form=self.format, columns=self.columns, file=wanted)
        return target

    def measurement(self, file: str | None = None) -> Measurement:
        """Return a file as a measurement in SI; it is downloaded if necessary.

        Parameters
        ----------
        file : str, optional
            One of `files`; the first if not given.

        Returns
        -------
        Measurement
            With the quantities that `columns` names, each by its gain.

        Raises
        ------
        InputError
            If this is a reference simulation, or the file cannot be had.

        Examples
        --------
        >>> from tempfile import TemporaryDirectory
        >>> from unittest.mock import patch
        >>> import pandas as pd
        >>> from stickslip.data import catalogue
        >>> record = catalogue.dataset("reciprocating_tribometer")
        >>> table = {"t_s": [0.0, 0.1], "normal_N": [5.0, 5.0], "x_m": [0.0, 1e-3]}
        >>> with TemporaryDirectory() as own, patch.dict("os.environ", STICKSLIP_DATA=own):
        ...     file = Path(own, record.name, "record.parquet")
        ...     file.parent.mkdir()
        ...     pd.DataFrame({**table, "friction_N": [-2.0, -2.5]}).to_parquet(file)
        ...     record.measurement("record").friction
        array([2. , 2.5])
        """
        wanted = self.file(file)
        if self.kind != "measured":
            raise InputError(
                f"{self.name} is a reference simulation, not a measurement: read its table"
                f" directly, at catalogue.dataset({self.name!r}).path()."
            )
        used = [column for column in self.columns if column.quantity]
        measurement = load_measurement(
            self.path(file),
            columns={column.quantity: column.name for column in used},
            gain={column.quantity: column.gain for column in used if column.gain != 1.0},
            name=f"{self.name} {wanted.name}",
        )
        return (
            measurement if self.load is None else dataclasses.replace(measurement, load=self.load)
        )

    def _own(self, file: DataFile) -> Path | None:
        """Return the file under ``STICKSLIP_DATA``, if it is there."""
        folder = named_folder()
        path = folder / self.name / file.file_name if folder else None
        return path if path is not None and path.is_file() else None

    def _raw(self, file: DataFile) -> Path:
        return self.folder() / Path(file.source).name

    def _upstream(self, file: DataFile, report: Callable[[str], None] | None) -> Path:
        """Return the upstream file, downloaded unless it is there with its checksum."""
        if not file.source:
            raise InputError(
                f"{self.name}: {file.file_name} is not in the folder of STICKSLIP_DATA"
                f" ({named_folder() or 'not set'}), and the catalogue cannot download it. It was"
                f" prepared by hand from {self.repository}: put it into the subfolder {self.name}"
                " of the folder that STICKSLIP_DATA names."
            )
        raw = self._raw(file)
        if raw.is_file() and sha256_of(raw) == file.source_sha256:
            return raw
        url = f"{base_address()}/{self.repository}/{self.commit}/{quote(file.source)}"
        if report is not None:
            report(f"Downloading {raw.name} from {url}")
        page = by_hand(self.repository, self.commit, file.source)
        download(url, raw, file.source_sha256, page=page)
        return raw


def _compare(path: Path, file: DataFile) -> None:
    """Warn of a file that is not the one whose results are known."""
    result = sha256_of(path) if file.sha256 else ""
    if result != file.sha256:
        warnings.warn(
            f"{path} differs from the file in the catalogue: its sha256 is {result}, expected"
            f" {file.sha256}. It is used as it is; published results may not be reproduced.",
            stacklevel=3,
        )


def names() -> tuple[str, ...]:
    """Return the names of all records.

    Returns
    -------
    tuple of str
        In alphabetical order.

    Examples
    --------
    >>> names()[:2]
    ('bam_xl330', 'emps')
    """
    return tuple(_texts())


def dataset(name: str) -> Dataset:
    """Return a record of the catalogue; nothing is downloaded yet.

    Examples
    --------
    >>> dataset("rock_velocity_step").licence
    'MIT'
    >>> dataset("emsp")
    Traceback (most recent call last):
    stickslip.errors.UnknownNameError: unknown record of the catalogue 'emsp'. Did you mean 'emps'?
    """
    if name not in _texts():
        raise UnknownNameError("record of the catalogue", name, names())
    return _read(name)


@functools.cache
def _texts() -> Mapping[str, str]:
    """Return the text of each entry by its name."""
    folder = files("stickslip.data.catalogue").joinpath("records")
    result = {
        entry.name.removesuffix(".toml"): entry.read_text(encoding="utf-8")
        for entry in folder.iterdir()
        if entry.name.endswith(".toml")
    }
    return MappingProxyType(dict(sorted(result.items())))


@functools.cache
def _read(name: str) -> Dataset:
    tables: dict[str, Any] = tomllib.loads(_texts()[name])
    columns = tuple(Column(**table) for table in tables.pop("columns"))
    known = {key: DataFile(name=key, **table) for key, table in tables.pop("files").items()}
    tables["notes"] = " ".join(tables.get("notes", "").split())
    return Dataset(name=name, columns=columns, files=MappingProxyType(known), **tables)
