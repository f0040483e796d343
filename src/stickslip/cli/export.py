"""``stickslip export``."""

from dataclasses import dataclass
from pathlib import Path

from stickslip.cli.console import document, print_json, refuse_overwriting, stdout
from stickslip.cli.law_choice import check_named
from stickslip.errors import InputError, ParameterError
from stickslip.experiments import LOAD, load_rig, read_number
from stickslip.exports import TARGETS, export
from stickslip.quantities import Quantity, named

__all__ = ["Wanted", "run"]

SPEED = Quantity("v_max", "m/s", above=0, or_unit="rad/s")
BESIDE = (".json", ".html", ".csv")
"""Of a report, none of which is a rig file."""


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """What the options say of the law and its use."""

    law: str | None
    """Which of the laws of the file."""
    contact: str | None
    """Whose law, where contacts have their own."""
    name: str | None
    """Name of the program."""
    rig: Path | None
    """Rig on which the law is used."""
    load: str | None
    """Normal force at which tables and joints have their friction."""
    law_load: str | None
    """Normal force at which levels that are forces were fitted."""
    largest_speed: str | None
    """End of the range of speeds."""


def run(
    path: Path,
    to: str,
    wanted: Wanted,
    output: Path,
    *,
    allow_import: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Export the law of a file, and write what its target takes.

    Parameters
    ----------
    path : Path
        Rig file (TOML) with the law.
    to : str
        Name of the target.
    wanted : Wanted
        The law and its use.
    output : Path
        Folder of the files.
    allow_import : bool
        Whether rig files may import classes, which runs their code.
    force : bool
        Whether files that exist are replaced.
    as_json : bool
        Whether one JSON document is printed on stdout instead of text.

    Raises
    ------
    InputError
        If the file has no law, or the target needs what is not known.
    """
    target = named(TARGETS, to, "target")
    if path.suffix.lower() in BESIDE:
        raise InputError(
            f"export takes a TOML file with a law, got {path}: give the law.toml that `stickslip"
            f" select` writes beside its report, as {path.with_name('law.toml')}."
        )
    check_named(path)
    refuse_overwriting(output, output, force=True)
    found = export(
        load_rig(path, allow_import=allow_import),
        to,
        name=wanted.name,
        law=wanted.law,
        contact=wanted.contact,
        load=_number("--load", wanted.load, LOAD),
        law_load=_number("--law-load", wanted.law_load, LOAD),
        largest_speed=_number("--largest-speed", wanted.largest_speed, SPEED),
        rig=None if wanted.rig is None else load_rig(wanted.rig, allow_import=allow_import),
    )
    files = found.save(output, force=force)
    if as_json:
        content = {"target": to, "files": list(map(str, files)), "remarks": list(found.remarks)}
        print_json(document("export", content))
        return
    console = stdout()
    console.print(f"{target.title}: {', '.join(map(str, files))}", markup=False)
    for remark in found.remarks:
        console.print(f"  {remark}", markup=False)


def _number(option: str, text: str | None, quantity: Quantity) -> float | None:
    if text is None:
        return None
    try:
        return read_number(text, quantity)
    except ParameterError as error:
        raise ParameterError(f"{option} {error}") from None
