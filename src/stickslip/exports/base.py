"""What a target is, and what an export gives back."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, final

from typing_extensions import override

from stickslip.documents import unwritable, write_files
from stickslip.errors import InputError
from stickslip.exports.subject import Subject


@final
@dataclass(frozen=True, kw_only=True)
class Export:
    """A law as files of another program.

    Examples
    --------
    >>> from stickslip import Coulomb, export
    >>> export(Coulomb(kinetic_coefficient=0.25), "c")
    <Export c: coulomb.h, coulomb.c>
    """

    target: str
    """Name of the target."""
    files: Mapping[str, str]
    """Texts by file name."""
    remarks: tuple[str, ...] = ()
    """What does not carry over, in sentences."""

    def save(self, folder: str | Path, *, force: bool = False) -> tuple[Path, ...]:
        """Write the files into a folder, all or none."""
        place = Path(folder)
        paths = {place / name: text for name, text in self.files.items()}
        for path in paths:
            try:
                there = path.exists() or path.is_symlink()
            except OSError as error:
                raise unwritable(path, error) from error
            if there and not force:
                raise InputError(
                    f"{path} already exists; give --force (in Python force=True) to replace it, or"
                    " another folder."
                )
        write_files(paths)
        return tuple(paths)

    @override
    def __repr__(self) -> str:
        return f"<Export {self.target}: {', '.join(self.files)}>"


class Target(ABC):
    """A program or format that a law is exported to."""

    name: ClassVar[str]
    """Name of the target on the command line."""
    title: ClassVar[str]
    """What it is, in running text."""
    evaluates: ClassVar[bool] = False
    """Whether the law is evaluated: at one normal force and one value of each contact input."""

    @abstractmethod
    def export(self, subject: Subject) -> Export:
        """Return the files of a law; the same for the same law, whenever they are made."""
