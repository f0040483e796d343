"""The file formats that are read, each by one function: a new one is a file and an entry here."""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from stickslip.experiments.readers.csv_reader import read_text
from stickslip.experiments.readers.lerobot import EPISODES, INFO, read_lerobot
from stickslip.experiments.readers.matlab import read_mat
from stickslip.experiments.readers.mcap_log import MCAP, read_mcap
from stickslip.experiments.readers.mdf import MDF, read_mdf
from stickslip.experiments.readers.parquet import PARQUET, read_parquet
from stickslip.experiments.readers.ros_bags import BAGS, METADATA, PARTS, read_bag
from stickslip.experiments.readers.servo_json import read_servo
from stickslip.experiments.readers.spreadsheet import SPREADSHEET, read_spreadsheet
from stickslip.experiments.readers.table import Table
from stickslip.experiments.readers.tdms import TDMS, read_tdms

TEXT: Final = (".csv", ".tsv", ".txt", ".dat", ".asc", ".lvm")
"""Endings of text files."""


@final
@dataclass(frozen=True, kw_only=True)
class Format:
    """A format of data files."""

    endings: tuple[str, ...]
    """Endings of its files, in lower case, or the ends of their names."""
    read: Callable[[Path, Collection[str]], Table]
    """Reads a file; what it is told are the columns that are wanted by name."""
    streamed: bool = False
    """Whether a file may be of any size, because only parts of it are kept."""
    within: str = ""
    """Path of such a file in a folder that may be given instead."""
    beside: tuple[str, ...] = ()
    """Patterns of the files in that folder that hold the data."""


FORMATS: Final = (
    Format(endings=TEXT, read=lambda path, _: read_text(path)),
    Format(endings=PARQUET, read=read_parquet),
    Format(endings=(".mat",), read=read_mat),
    Format(endings=MDF, read=read_mdf),
    Format(endings=TDMS, read=read_tdms),
    Format(endings=SPREADSHEET, read=read_spreadsheet),
    Format(endings=MCAP, read=read_mcap, streamed=True),
    Format(endings=BAGS, read=read_bag, streamed=True),
    Format(endings=(METADATA,), read=read_bag, within=METADATA, beside=PARTS),
    Format(endings=("info.json",), read=read_lerobot, within=INFO, beside=(EPISODES,)),
    Format(endings=(".json",), read=read_servo),
)
"""Formats by the ends of the names of their files."""


def format_of(path: Path) -> Format | None:
    """Return the format of a file by its name; None if it is read by no function.

    Examples
    --------
    >>> format_of(Path("run.CSV")) is FORMATS[0], format_of(Path("rig.toml"))
    (True, None)
    """
    name = path.name.lower()
    return next((one for one in FORMATS if name.endswith(one.endings)), None)


def data_file(path: Path) -> Path:
    """Return the file to read of a folder that holds a log; a file as it is."""
    inside = (path / one.within for one in FORMATS if one.within)
    return next((file for file in inside if file.is_file()), path)


def log_name(path: Path) -> str:
    """Return what a file is called without its ending; a log in a folder is called like that.

    Examples
    --------
    >>> log_name(Path("run.csv")), log_name(Path("monday/metadata.yaml"))
    ('run', 'monday')
    """
    known = format_of(path)
    if known is None or not known.within:
        return path.stem
    return path.absolute().parents[len(Path(known.within).parts) - 1].name


def log_files(path: Path) -> list[Path]:
    """Return the files that hold what one stands for: several of a log in a folder."""
    file = data_file(path)
    known = format_of(file)
    if known is None or not known.within:
        return [file]
    folder = file.parents[len(Path(known.within).parts) - 1]
    return [file, *(one for pattern in known.beside for one in sorted(folder.glob(pattern)))]
